// SPDX-License-Identifier: Apache-2.0
#include "tests/frozen/cases.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "config/keys.hpp"
#include "config/modes.hpp"
#include "engine/range.hpp"
#include "golden/precision.hpp"
#include "model/engine_model.hpp"
#include "report/random_config.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "scene/random.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::frozen {
namespace {

using Change = std::function<void(Config&)>;

// Collects legal variants of depth16, or of another shipped configuration.
class Variants {
 public:
  Variants() = default;
  explicit Variants(const std::string& base) : base_(shipped_config(base)) {}
  void add(const std::string& name, const Change& change) {
    Config config = base_;
    change(config);
    config.name = name;
    check_config(config, name);
    list_.push_back(std::move(config));
  }
  std::vector<Config> take() { return std::move(list_); }

 private:
  Config base_ = shipped_config("depth16");
  std::vector<Config> list_;
};

template <class T>
std::string text(T value) {
  return std::string(to_string(value));
}

constexpr std::array fill_rules{FillRule::top_left, FillRule::inclusive};
constexpr std::array numerators{Numerator::pixel_centre, Numerator::ideal_line};
constexpr std::array slope_forms{SlopeForm::divide, SlopeForm::reciprocal};
constexpr std::array row_slopes{RowSlope::divide, RowSlope::reciprocal};
constexpr std::array reciprocal_kinds{ReciprocalKind::restoring, ReciprocalKind::lut_linear,
                                      ReciprocalKind::lut_newton};
constexpr std::array depth_codes{DepthCode::inverse, DepthCode::linear, DepthCode::opengl};

struct Walk {
  EdgeWalk edge_walk;
  DdaUpdate dda_update;
};
constexpr std::array walks{Walk{EdgeWalk::exact, DdaUpdate::accumulate},
                           Walk{EdgeWalk::dda, DdaUpdate::accumulate},
                           Walk{EdgeWalk::dda, DdaUpdate::multiply}};

void set_kind(Reciprocal& unit, ReciprocalKind kind) {
  unit.kind = kind;
  unit.operand_bits = 22;
  unit.index_bits = kind == ReciprocalKind::lut_linear ? 9 : 7;
  unit.table_bits = 20;
  unit.internal_bits = 26;
  unit.steps = kind == ReciprocalKind::lut_newton ? 2 : 0;
}

void set_fixed_point(Reciprocal& unit, int integer_bits) {
  unit.normalize = false;
  unit.output.integer = integer_bits;
  unit.output.word = integer_bits + 27;
  unit.output.overflow_expected = true;
}

// Adds variants of one reciprocal unit; `use` makes the configuration use the unit. integer_bits hold the
// largest value that it delivers where it is not normalised.
class UnitVariants {
 public:
  UnitVariants(std::string name, Reciprocal Config::*unit, int integer_bits, Change use)
      : name_(std::move(name)), unit_(unit), integer_bits_(integer_bits), use_(std::move(use)) {}

  void add_kinds(Variants& to) const {
    for (const ReciprocalKind kind : reciprocal_kinds) {
      add(to, text(kind) + " normalised", kind, [](Reciprocal&) {});
      add(to, text(kind) + " fixed point", kind, [&](Reciprocal& r) { set_fixed_point(r, integer_bits_); });
    }
    for (const int steps : {0, 1, 3}) {
      add(to, "lut_newton steps " + std::to_string(steps), ReciprocalKind::lut_newton,
          [&](Reciprocal& r) { r.steps = steps; });
    }
  }
  void add_bits_per_cycle(Variants& to) const {
    for (const int bits : {3, 8}) {
      add(to, "restoring bits_per_cycle " + std::to_string(bits), ReciprocalKind::restoring,
          [&](Reciprocal& r) { r.bits_per_cycle = bits; });
    }
  }
  void add_pipelined(Variants& to) const {
    for (const ReciprocalKind kind : reciprocal_kinds)
      add(to, text(kind) + " pipelined", kind, [](Reciprocal& r) { r.pipelined = true; });
  }

 private:
  void add(Variants& to, const std::string& what, ReciprocalKind kind,
           const std::function<void(Reciprocal&)>& change) const {
    to.add(name_ + ", " + what, [&](Config& c) {
      use_(c);
      set_kind(c.*unit_, kind);
      change(c.*unit_);
    });
  }

  std::string name_;
  Reciprocal Config::*unit_;
  int integer_bits_;
  Change use_;
};

}  // namespace

std::vector<Config> coverage_variants() {
  Variants variants;
  for (const Perspective perspective : all_perspectives) {
    for (const Numerator numerator : numerators) {
      if (perspective != Perspective::const_depth_rows && numerator != Numerator::pixel_centre) continue;
      for (const FillRule fill_rule : fill_rules) {
        for (const Walk& walk : walks) {
          if (perspective == Perspective::const_depth_rows && walk.edge_walk != EdgeWalk::exact) continue;
          variants.add(text(perspective) + " " + text(numerator) + " " + text(fill_rule) + " " +
                           text(walk.edge_walk) + " " + text(walk.dda_update),
                       [&](Config& c) {
                         c.perspective = perspective;
                         c.numerator = numerator;
                         c.fill_rule = fill_rule;
                         c.edge_walk = walk.edge_walk;
                         c.dda_update = walk.dda_update;
                       });
        }
      }
    }
  }
  return variants.take();
}

std::vector<Config> offset_variants() {
  Variants variants;
  for (const int bits : {0, 1, 8, 12}) {
    variants.add("subpixel_bits " + std::to_string(bits), [&](Config& c) { c.subpixel_bits = bits; });
  }
  for (const Perspective perspective : all_perspectives) {
    for (const bool half_ulp : {false, true}) {
      variants.add(text(perspective) + " dda, start offsets " + (half_ulp ? "half_ulp" : "0"),
                   [&](Config& c) {
                     c.perspective = perspective;
                     c.edge_walk = EdgeWalk::dda;
                     const StartOffset offset{half_ulp, 0.0};
                     c.start_offset = {offset, offset, offset, offset, offset, offset, offset};
                   });
    }
  }
  return variants.take();
}

std::vector<Config> slope_variants() {
  Variants variants;
  for (const Perspective perspective : all_perspectives) {
    for (const SlopeForm edge : slope_forms) {
      for (const RowSlope row : row_slopes) {
        const bool has_slopes = perspective != Perspective::const_depth_rows;
        if (!has_slopes && (edge != SlopeForm::divide || row != RowSlope::divide)) continue;
        variants.add(text(perspective) + ", edge " + text(edge) + ", row " + text(row), [&](Config& c) {
          c.perspective = perspective;
          c.edge_slope = edge;
          c.row_slope = row;
        });
      }
    }
  }
  return variants.take();
}

std::vector<Config> edge_reciprocal_variants() {
  Variants variants;
  UnitVariants("edge unit", &Config::edge_reciprocal, 5, [](Config& c) {
    c.edge_slope = SlopeForm::reciprocal;
  }).add_kinds(variants);
  return variants.take();
}

std::vector<Config> row_reciprocal_variants() {
  Variants variants;
  for (const Perspective perspective : {Perspective::delta_f, Perspective::const_depth_rows}) {
    const UnitVariants unit("row unit in " + text(perspective), &Config::row_reciprocal, 13,
                            [&](Config& c) { c.perspective = perspective; });
    unit.add_kinds(variants);
    unit.add_bits_per_cycle(variants);
    unit.add_pipelined(variants);
  }
  return variants.take();
}

std::vector<Config> pixel_reciprocal_variants() {
  Variants variants;
  const UnitVariants unit("pixel unit", &Config::pixel_reciprocal, 2, [](Config&) {});
  unit.add_kinds(variants);
  unit.add_bits_per_cycle(variants);
  const UnitVariants everywhere("pixel unit of spans, depth and fog", &Config::pixel_reciprocal, 2,
                                [](Config& c) {
                                  c.depth_code = DepthCode::linear;
                                  c.fog = FogMode::linear;
                                });
  everywhere.add_kinds(variants);
  return variants.take();
}

std::vector<Config> depth_variants() {
  Variants variants;
  for (const Perspective perspective : all_perspectives) {
    for (const DepthCode code : depth_codes) {
      variants.add(text(perspective) + ", depth code " + text(code), [&](Config& c) {
        c.perspective = perspective;
        c.depth_code = code;
      });
    }
  }
  for (const int bits : {8, 12}) {
    variants.add("depth bits " + std::to_string(bits), [&](Config& c) { c.depth_bits = bits; });
  }
  return variants.take();
}

std::vector<Config> depth_rounding_variants() {
  Variants variants;
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    for (int i = 0; i < rounding_modes; ++i) {
      const auto rounding = static_cast<Rounding>(i);
      variants.add("depth code " + text(code) + " " + text(rounding), [&](Config& c) {
        c.depth_code = code;
        c.depth_rounding = rounding;
        c.format(FormatId::span_h) = {17, 16, false, Rounding::trn, Overflow::sat, true};  // ties are common
      });
    }
  }
  for (const DepthCode code : depth_codes) {
    for (const Overflow overflow : {Overflow::wrap, Overflow::sat, Overflow::sat_zero, Overflow::sat_sym}) {
      variants.add("depth code " + text(code) + " " + text(overflow), [&](Config& c) {
        c.depth_code = code;
        c.depth_overflow = overflow;
        c.format(FormatId::span_h).word += 1;  // h passes hmax
        c.format(FormatId::span_h).integer += 1;
        c.start_offset.span_h = {false, 9000.0};
      });
    }
  }
  return variants.take();
}

std::vector<Config> depth_dz_variants() {
  Variants variants;
  for (const Perspective perspective : all_perspectives) {
    for (const DepthFunc func : {DepthFunc::less, DepthFunc::lequal}) {
      variants.add(text(perspective) + ", " + text(func), [&](Config& c) {
        c.perspective = perspective;
        c.depth_code = DepthCode::float_dz;
        c.depth_func = func;
      });
    }
  }
  variants.add("row plane", [](Config& c) {
    c.depth_code = DepthCode::float_dz;
    c.row_slope = RowSlope::plane;
  });
  variants.add("lod gradient", [](Config& c) {
    c.depth_code = DepthCode::float_dz;
    c.mip = MipMode::linear;
    c.lod = LodMode::gradient;
  });
  Variants wide("depth20");
  wide.add("18 bits", [](Config& c) {
    c.depth_code = DepthCode::float_dz;
    c.depth_bits = 18;
    c.depth_func = DepthFunc::lequal;
  });
  std::vector<Config> out = variants.take();
  for (Config& config : wide.take()) out.push_back(std::move(config));
  return out;
}

std::vector<Config> shading_variants() {
  Variants variants;
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
    for (const TextureWrap wrap : {TextureWrap::cyclic, TextureWrap::clamp}) {
      for (const bool transparent : {false, true}) {
        variants.add(text(filter) + " " + text(wrap) + (transparent ? " transparent" : " opaque"),
                     [&](Config& c) {
                       c.filter = filter;
                       c.wrap = wrap;
                       if (!transparent) c.transparent.reset();
                     });
      }
    }
  }
  for (const FogMode fog : {FogMode::none, FogMode::linear, FogMode::table}) {
    for (const DepthCode code : depth_codes) {
      variants.add("fog " + text(fog) + ", depth code " + text(code), [&](Config& c) {
        c.fog = fog;
        c.depth_code = code;
      });
    }
  }
  for (const auto& [depth_bits, zone_bits] : {std::pair{1, 0}, {4, 8}, {12, 0}}) {
    variants.add("fog table " + std::to_string(depth_bits) + "+" + std::to_string(zone_bits) + " bits",
                 [&](Config& c) {
                   c.fog_depth_bits = depth_bits;
                   c.fog_zone_bits = zone_bits;
                 });
  }
  return variants.take();
}

namespace {

// Changes the registers that every file gives. One with a default keeps it, and so stays out of texts and
// hashes.
void change_formats(Config& c, const std::function<void(Format&)>& change) {
  for (std::size_t i = 0; i < c.formats.size(); ++i) {
    const auto by_default = default_format(c.formats, static_cast<FormatId>(i));
    if (by_default) {
      c.formats[i] = *by_default;
    } else {
      change(c.formats[i]);
    }
  }
}

}  // namespace

std::vector<Config> mip_variants() {
  Variants variants;
  for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
    for (const LodMode lod : {LodMode::none, LodMode::zone_s, LodMode::gradient}) {
      for (const Perspective perspective : {Perspective::delta_f, Perspective::const_depth_rows}) {
        variants.add("mip " + text(mip) + ", lod " + text(lod) + ", " + text(perspective), [&](Config& c) {
          c.mip = mip;
          c.lod = lod;
          c.lod_bias = 5;
          c.lod_first = 900;
          c.perspective = perspective;
          c.filter = TextureFilter::bilinear;
          c.transparent.reset();
        });
      }
    }
  }
  return variants.take();
}

std::vector<Config> distance_variants() {
  Variants variants;
  for (const Perspective perspective : {Perspective::delta_f, Perspective::const_depth_rows}) {
    for (const LodMode lod : {LodMode::zone_d, LodMode::finite}) {
      variants.add("lod " + text(lod) + ", " + text(perspective), [&](Config& c) {
        c.mip = MipMode::linear;
        c.lod = lod;
        c.lod_first = 900;
        c.perspective = perspective;
        c.filter = TextureFilter::bilinear;
      });
    }
    for (const FogMode fog : {FogMode::table, FogMode::distance, FogMode::log}) {
      variants.add("fog " + text(fog) + " by zones of r, " + text(perspective), [&](Config& c) {
        c.fog = fog;
        if (has_pixel_zones(c)) c.fog_zone = FogZone::r;
        c.perspective = perspective;
      });
    }
  }
  return variants.take();
}

std::vector<Config> plane_variants() {
  Variants variants;
  for (const Perspective perspective : {Perspective::delta_f, Perspective::hyperbolic, Perspective::affine}) {
    for (const SlopeForm edge : slope_forms) {
      variants.add(text(perspective) + ", edge " + text(edge) + ", row plane", [&](Config& c) {
        c.perspective = perspective;
        c.edge_slope = edge;
        c.edge_walk = edge == SlopeForm::divide ? EdgeWalk::exact : EdgeWalk::dda;
        c.row_slope = RowSlope::plane;
      });
    }
  }
  return variants.take();
}

std::vector<Config> channel_variants() {
  Variants variants;
  for (const Perspective perspective : {Perspective::delta_f, Perspective::const_depth_rows}) {
    variants.add("fog vertex, " + text(perspective), [&](Config& c) {
      c.fog = FogMode::vertex;
      c.perspective = perspective;
    });
  }
  variants.add("fog vertex, rows from the plane, all slopes by division", [](Config& c) {
    c.fog = FogMode::vertex;
    c.row_slope = RowSlope::plane;
    c.edge_slope = SlopeForm::divide;
  });
  return variants.take();
}

std::vector<Config> cache_variants() {
  Variants variants;
  for (const BufferCacheMode mode : {BufferCacheMode::write_through, BufferCacheMode::write_back}) {
    for (const SetHash hash : {SetHash::none, SetHash::xor_upper}) {
      for (const int ways : {1, 4}) {
        variants.add("caches " + text(mode) + ", hash " + text(hash) + ", ways " + std::to_string(ways),
                     [&](Config& c) {
                       c.memory.cache_sets = 16;
                       c.memory.cache_ways = ways;
                       c.memory.cache_hash = hash;
                       c.memory.depth_cache = {mode, 32, 16 / ways, ways, hash};
                       c.memory.color_cache = {mode, 64, 16 / ways, ways, hash};
                     });
      }
    }
  }
  return variants.take();
}

std::vector<Config> format_variants() {
  Variants variants;
  for (const Perspective perspective : {Perspective::delta_f, Perspective::const_depth_rows}) {
    const std::string prefix = text(perspective) + ", all formats ";
    for (int i = 0; i < rounding_modes; ++i) {
      const auto rounding = static_cast<Rounding>(i);
      variants.add(prefix + text(rounding), [&](Config& c) {
        c.perspective = perspective;
        change_formats(c, [&](Format& f) { f.rounding = rounding; });
      });
    }
    // A bit less than depth16 has, so that some values overflow.
    for (int i = 0; i < overflow_modes; ++i) {
      const auto overflow = static_cast<Overflow>(i);
      variants.add(prefix + text(overflow), [&](Config& c) {
        c.perspective = perspective;
        for (const FormatId id : {FormatId::span_h, FormatId::span_f, FormatId::span_uv_acc,
                                  FormatId::span_uv, FormatId::edge_f, FormatId::setup_uv}) {
          c.format(id).word -= 8;
          c.format(id).integer -= 8;
        }
        change_formats(c, [&](Format& f) {
          f.overflow = overflow == Overflow::wrap_sm && !f.is_signed ? Overflow::wrap : overflow;
          f.overflow_expected = true;
        });
      });
    }
  }
  return variants.take();
}

std::vector<Config> timing_variants() {
  Variants variants;
  for (int i = 0; i < stage_count; ++i) {
    const auto stage = static_cast<Stage>(i);
    if (stage == Stage::span_setup || stage == Stage::span) continue;
    variants.add("slow " + text(stage), [&](Config& c) {
      c.timing[static_cast<std::size_t>(i)] = {.latency = 30, .interval = 7, .fifo = 3};
    });
  }
  variants.add("all FIFOs 1", [](Config& c) {
    for (StageTiming& timing : c.timing) timing.fifo = 1;
  });
  variants.add("all FIFOs 1000", [](Config& c) {
    for (StageTiming& timing : c.timing) timing.fifo = 1000;
  });
  variants.add("all stages fast", [](Config& c) { c.timing.fill({.latency = 1, .interval = 1, .fifo = 4}); });
  variants.add("row unit pipelined", [](Config& c) { c.row_reciprocal.pipelined = true; });
  variants.add("memory latency 200", [](Config& c) { c.memory.latency = 200; });
  variants.add("memory latency 1", [](Config& c) { c.memory.latency = 1; });
  variants.add("memory 1 byte wide", [](Config& c) { c.memory.width_bytes = 1; });
  variants.add("memory 64 bytes wide", [](Config& c) { c.memory.width_bytes = 64; });
  variants.add("cache lines of 16 bytes", [](Config& c) { c.memory.cache_line_bytes = 16; });
  variants.add("cache of one set", [](Config& c) { c.memory.cache_sets = 1; });
  variants.add("cache of 1024 sets of 4 ways", [](Config& c) {
    c.memory.cache_sets = 1024;
    c.memory.cache_ways = 4;
  });
  variants.add("bilinear, cache of 4 sets of 1 way", [](Config& c) {
    c.filter = TextureFilter::bilinear;
    c.memory.cache_sets = 4;
    c.memory.cache_ways = 1;
  });
  for (const Perspective perspective : all_perspectives) {
    variants.add(text(perspective) + ", fast memory", [&](Config& c) {
      c.perspective = perspective;
      c.memory = {.latency = 4, .width_bytes = 64};
    });
  }
  return variants.take();
}

namespace {

using Json = nlohmann::ordered_json;

const std::string& random_configs_path() {
  static const std::string path = source_path("tests/frozen/random_configs.jsonl");
  return path;
}

// Returns visit(key, config) over all keys; `config` has at a key what it is where a line does not name it.
Config config_by(const std::function<void(const Key&, Config&)>& visit) {
  Config config = shipped_config("depth16");
  for (const Key& entry : entries()) {
    if (entry.presence() == Presence::later) set_default(config, entry);  // may hang on the keys before
    for (const Key& key : keys()) {
      if (key.row == entry.row && key.i == entry.i) visit(key, config);
    }
  }
  return config;
}

// "/formats/span/h/word" of "formats.span.h.word".
std::string pointer_of(std::string path) {
  std::ranges::replace(path, '.', '/');
  return "/" + path;
}

KeyValue value_in(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  return json.get<std::string>();
}

}  // namespace

std::string line_of(const Config& config) {
  Json flat{{"/name", config.name}};
  config_by([&](const Key& key, Config& named) {
    if (same_value(config, named, key)) return;
    std::visit([&](const auto& value) { flat[pointer_of(key.path)] = value; }, value_of(config, key));
    copy_value(config, named, key);
  });
  return flat.unflatten().dump();
}

Config config_of(const std::string& line) {
  Json flat = Json::parse(line).flatten();
  const auto take = [&](const std::string& pointer, const auto& to) {
    if (const auto found = flat.find(pointer); found != flat.end()) {
      to(*found);
      flat.erase(pointer);
    }
  };
  std::string name;
  take("/name", [&](const Json& json) { name = json; });
  Config config = config_by([&](const Key& key, Config& named) {
    take(pointer_of(key.path), [&](const Json& json) {
      if (const auto wrong = set_value(named, key, value_in(json)))
        throw std::runtime_error(name + ": " + key.path + ": " + *wrong);
    });
  });
  if (!flat.empty()) throw std::runtime_error(name + ": unknown keys: " + flat.dump());
  config.name = name;
  check_config(config, name);
  return config;
}

std::vector<std::string> random_config_lines() {
  std::vector<std::string> out;
  std::ifstream file(random_configs_path());
  for (std::string line; std::getline(file, line);) out.push_back(line);
  return out;
}

void draw_random_configs() {
  constexpr int count = 200;
  const std::vector<Config> bases = shipped_configs();
  RandomConfigOptions options;
  options.check = [](const Config& config) { static_cast<void>(golden::choose_precision(config)); };
  std::ofstream file(random_configs_path(), std::ios::binary);
  for (int number = 0; number < count; ++number) {
    Config config = random_config(static_cast<std::uint64_t>(number) + 1, bases, options);
    config.name = std::to_string(1000 + number).substr(1);
    file << line_of(config) << "\n";
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + random_configs_path());
}

// The digests are of a reader whose numbers were floating-point numbers of 32 bits.
void round_to_floats(Mesh& mesh) {
  const auto round = [](double value) { return static_cast<double>(static_cast<float>(value)); };
  const Texture& texture = mesh.textures.at(0);
  for (Face& face : mesh.faces) {
    for (Corner& corner : face.corner) {
      Vec3& p = corner.position;
      p = {round(p.x), round(p.y), round(p.z)};
      corner.u = round(corner.u / texture.width) * texture.width;
      corner.v = (1 - round(1 - corner.v / texture.height)) * texture.height;
    }
  }
}

Scene spot_scene(int width, int height) {
  const std::string folder = source_path("tests/data/");
  MeshOptions options;
  options.width = width;
  options.height = height;
  // No angles: sines need not have the same last bit on every machine.
  options.camera.position = Vec3{1.5, 1.25, -2.5};
  options.camera.target = Vec3{0, 0.125, 0.25};
  options.camera.focal = 1.375 * height;
  options.camera.s_min = 2;
  options.camera.s_max = 5;
  options.background = {30, 40, 60};
  options.fog = Fog{{120, 130, 140}, 6};
  ProjectReport report;
  Mesh mesh = read_mesh(folder + "spot.obj", folder + "spot.png");
  round_to_floats(mesh);
  Scene scene = mesh_scene(std::move(mesh), options, report);
  scene.name = "spot";
  return scene;
}

Scene small_extreme_scene() {
  constexpr std::size_t kept = 30;  // at either end of a scene
  Scene all;
  for (const Scene& scene : extreme_scenes()) {
    if (scene.width > 1000) continue;
    std::vector<Triangle> triangles = std::move(all.triangles);
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      if (i < kept || i + kept >= scene.triangles.size()) triangles.push_back(scene.triangles[i]);
    }
    all = scene;
    all.triangles = std::move(triangles);
  }
  all.name = "extreme";
  all.width = 96;
  all.height = 72;
  all.fog = Fog{{200, 180, 160}, 40};
  return all;
}

Scene random_stream(const Config& config, int number) {
  constexpr int draws = 8;
  RandomOptions options{.width = 96, .height = 72, .triangles = 40, .size_max = 120};
  for (int i = 0; i < draws; ++i) {
    Scene scene = random_scene(static_cast<std::uint64_t>(number), options);
    try {
      check_scene_range(config, scene);
      make_model(config)->begin(scene);
      scene.name = "stream";
      return scene;
    } catch (const InputError&) {
      options.depth_ratio_max = 1.5 + (options.depth_ratio_max - 1.5) / 4;
      options.uv_limit /= 2;
    }
  }
  throw std::runtime_error(config.name + " takes none of its random streams");
}

}  // namespace bitspan::frozen
