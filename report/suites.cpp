// SPDX-License-Identifier: Apache-2.0
#include "report/suites.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "config/check.hpp"
#include "config/fnv.hpp"
#include "config/modes.hpp"
#include "config/store.hpp"
#include "engine/range.hpp"
#include "scene/exact.hpp"
#include "scene/plan.hpp"
#include "scene/procedural.hpp"
#include "scene/random.hpp"
#include "scene/shadow.hpp"
#include "scene/texels.hpp"

namespace bitspan {
namespace {

constexpr std::array<std::pair<int, int>, 3> sizes{{{32, 24}, {64, 48}, {97, 61}}};
constexpr std::array<std::uint8_t, 3> hole{255, 0, 255};

// ---- What the scenes of a feature have

// Depths that come up again: some triangles lie at s_max, where the cleared buffer is, and each third one is
// drawn once more in other colours.
void repeat_depths(Config&, Scene& scene) {
  const std::vector<Triangle> given = std::move(scene.triangles);
  scene.triangles.clear();
  for (std::size_t i = 0; i < given.size(); ++i) {
    Triangle triangle = given[i];
    if (i % 4 == 0) {
      for (Vertex& v : triangle.v) v.s = scene.s_max;
    }
    scene.triangles.push_back(triangle);
    if (i % 3 != 0) continue;
    for (Vertex& v : triangle.v) std::swap(v.c[0], v.c[2]);
    scene.triangles.push_back(triangle);
  }
}

// On each third triangle another one of its plane, over the middle of its sides: as far but for rounding.
void lay_decals(Config&, Scene& scene) {
  const std::vector<Triangle> given = std::move(scene.triangles);
  scene.triangles.clear();
  for (std::size_t i = 0; i < given.size(); ++i) {
    scene.triangles.push_back(given[i]);
    if (i % 3 != 0) continue;
    Triangle decal = given[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& a = given[i].v[k];
      const Vertex& b = given[i].v[(k + 1) % 3];
      decal.v[k].x = (a.x + b.x) / 2;
      decal.v[k].y = (a.y + b.y) / 2;
      decal.v[k].s = std::clamp(2 / (1 / a.s + 1 / b.s), scene.s_min, scene.s_max);
      std::swap(decal.v[k].c[0], decal.v[k].c[2]);
    }
    scene.triangles.push_back(decal);
  }
}

// A texture with holes and with alpha, on two of three triangles, whose coordinates leave it on every side.
void texture(Scene& scene) {
  Texture own;
  own.name = "suite.png";
  own.width = 16;
  own.height = 8;
  for (int i = 0; i < own.width * own.height; ++i) {
    const bool is_hole = i % 5 == 0;
    const auto step = static_cast<std::uint8_t>(i * 37);
    own.rgba.insert(own.rgba.end(),
                    {is_hole ? hole[0] : step, is_hole ? hole[1] : static_cast<std::uint8_t>(255 - i),
                     is_hole ? hole[2] : static_cast<std::uint8_t>(i * 91),
                     static_cast<std::uint8_t>(i % 3 == 0 ? 96 : 255)});
  }
  scene.textures.push_back(std::move(own));
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (i % 3 != 2) scene.triangles[i].texture = static_cast<int>(scene.textures.size()) - 1;
  }
}

// The same, where each seventh texel has alpha 0.
void clear_texels(Scene& scene) {
  texture(scene);
  std::vector<std::uint8_t>& rgba = scene.textures.back().rgba;
  for (std::size_t i = 3; i < rgba.size(); i += 28) rgba[i] = 0;
}

void opaque(Scene& scene) {
  for (Texture& t : scene.textures) {
    for (std::size_t i = 3; i < t.rgba.size(); i += 4) t.rgba[i] = 255;
  }
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) v.c[3] = 1;
  }
}

// Each second triangle has its corners on pixel centres, so that edges pass through others.
void on_centres(Scene& scene) {
  for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
    Triangle snapped = scene.triangles[i];
    for (Vertex& v : snapped.v) {
      v.x = std::floor(v.x) + 0.5;
      v.y = std::floor(v.y) + 0.5;
    }
    if (orientation(snapped) != 0) scene.triangles[i] = snapped;
  }
}

void fog(Scene& scene) { scene.fog = Fog{{40, 90, 200}, scene.s_max / 2}; }

// Every third triangle gives its factors.
void vertex_fog(Scene& scene) {
  fog(scene);
  for (std::size_t i = 0; i < scene.triangles.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k)
      scene.triangles[i].v[k].fog = static_cast<double>((i + 2 * k) % 5) / 4;
  }
}

// ---- The table

// A setting of the configuration alone.
template <class Set>
SuiteSetting config_only(Set set) {
  return [set](Config& config, Scene&) { set(config); };
}

// Another value: the first one, or the second one of the first.
template <class E>
E another(E value) {
  return static_cast<E>(static_cast<int>(value) == 0 ? 1 : 0);
}

// A value of a key whose values have names, against another value of it.
template <class E>
SuiteFeature choice(const char* group, E Config::*key, E value, RecordType stage, E other) {
  return {fmt::format("{}.{}", group, to_string(value)), stage, SuiteNeeds::effect,
          config_only([=](Config& c) { c.*key = value; }), config_only([=](Config& c) { c.*key = other; })};
}
template <class E>
SuiteFeature choice(const char* group, E Config::*key, E value, RecordType stage) {
  return choice(group, key, value, stage, another(value));
}

// The same where merge in RTL has every blend, so that the engine `rtl` takes part.
SuiteFeature in_rtl_by_equation(SuiteFeature feature) {
  for (SuiteSetting* setting : {&feature.with, &feature.without}) {
    *setting = [set = *setting](Config& c, Scene& s) {
      c.rtl.blend = RtlBlend::equation;
      set(c, s);
    };
  }
  return feature;
}

// The same with what the scene must have.
SuiteFeature in(SuiteFeature feature, void (*scene)(Scene&)) {
  for (SuiteSetting* setting : {&feature.with, &feature.without}) {
    *setting = [set = *setting, scene](Config& c, Scene& s) {
      scene(s);
      set(c, s);
    };
  }
  return feature;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

template <class E>
std::vector<E> all_of() {
  std::vector<E> out;
  for (std::size_t i = 0; i < enum_names<E>.size(); ++i) out.push_back(static_cast<E>(i));
  return out;
}

bool walks_edges(Perspective p) { return !has_plane_rows(p); }
bool walks_planes(Perspective p) { return has_plane_rows(p); }
bool divides_by_depth(Perspective p) { return !has_linear_edges(p); }

void add_raster(std::vector<SuiteFeature>& out) {
  using enum RecordType;
  for (const FillRule rule : all_of<FillRule>()) {
    out.push_back(in(choice("fill", &Config::fill_rule, rule, fragment), on_centres));
  }
  for (const DdaUpdate update : all_of<DdaUpdate>()) {
    out.push_back({fmt::format("dda.{}", to_string(update)), row, SuiteNeeds::effect,
                   config_only([=](Config& c) {
                     c.edge_walk = EdgeWalk::dda;
                     c.dda_update = update;
                   }),
                   config_only([](Config& c) { c.edge_walk = EdgeWalk::exact; }), walks_edges});
  }
  for (const int bits : {2, 6}) {
    out.push_back({fmt::format("subpixel.{}", bits), setup, SuiteNeeds::effect,
                   config_only([=](Config& c) { c.subpixel_bits = bits; }), config_only([](Config&) {})});
  }
  for (const Numerator numerator : all_of<Numerator>()) {
    out.push_back(choice("numerator", &Config::numerator, numerator, fragment));
    out.back().applies = walks_planes;
  }
}

void add_slopes(std::vector<SuiteFeature>& out) {
  for (const SlopeForm form : all_of<SlopeForm>()) {
    out.push_back(choice("edge_slope", &Config::edge_slope, form, RecordType::edge));
    out.back().applies = walks_edges;
  }
  for (const RowSlope form : all_of<RowSlope>()) {
    out.push_back(choice("row_slope", &Config::row_slope, form, RecordType::span));
    out.back().applies = walks_edges;
  }
  for (const ReciprocalKind kind : all_of<ReciprocalKind>()) {
    const auto set = [=](Reciprocal& unit) {
      unit.kind = kind;
      unit.normalize = true;
      unit.operand_bits = 14;
      unit.index_bits = 6;
      unit.table_bits = 14;
      unit.internal_bits = 18;
      unit.steps = 1;
    };
    // One bit less of the table, or of the quotient, gives other values.
    const auto coarser = [=](Reciprocal& unit) {
      set(unit);
      unit.index_bits = 3;
      --unit.output.word;
    };
    out.push_back({fmt::format("pixel_reciprocal.{}", to_string(kind)), RecordType::fragment,
                   SuiteNeeds::effect, config_only([=](Config& c) {
                     set(c.pixel_reciprocal);
                     c.pixel_reciprocal.pipelined = true;
                   }),
                   config_only([=](Config& c) {
                     coarser(c.pixel_reciprocal);
                     c.pixel_reciprocal.pipelined = true;
                   }),
                   has_pixel_reciprocal});
    out.push_back({fmt::format("row_reciprocal.{}", to_string(kind)), RecordType::span, SuiteNeeds::effect,
                   config_only([=](Config& c) {
                     set(c.row_reciprocal);
                     c.row_slope = RowSlope::reciprocal;
                   }),
                   config_only([=](Config& c) {
                     coarser(c.row_reciprocal);
                     c.row_slope = RowSlope::reciprocal;
                   })});
  }
}

void add_subspans(std::vector<SuiteFeature>& out) {
  for (const int bits : {1, 3, 4}) {
    out.push_back({fmt::format("subspan.{}", bits), RecordType::fragment, SuiteNeeds::effect,
                   config_only([=](Config& c) { c.subspan_bits = bits; }),
                   config_only([](Config& c) { c.subspan_bits = 0; }), has_pixel_reciprocal});
  }
}

// Every second triangle becomes a line.
void into_lines(Scene& s) {
  for (std::size_t i = 1; i < s.triangles.size(); i += 2) {
    s.triangles[i].is_line = true;
    s.triangles[i].v[2] = s.triangles[i].v[1];
  }
}

void add_lines(std::vector<SuiteFeature>& out) {
  // Three fraction bits of the slope, so that a dda's line is another one.
  const auto walked = [](LineForm walk) -> SuiteSetting {
    return [=](Config& c, Scene& s) {
      c.line_walk = walk;
      Format& k = c.format(FormatId::plane_k);
      k.word = k.integer + 3;
      into_lines(s);
    };
  };
  for (const auto& [walk, other] :
       {std::pair(LineForm::exact, LineForm::dda), std::pair(LineForm::dda, LineForm::exact)}) {
    out.push_back({fmt::format("line.{}", to_string(walk)), RecordType::fragment, SuiteNeeds::effect,
                   walked(walk), walked(other), walks_edges});
  }
  out.push_back({"line.drawn", RecordType::fragment, SuiteNeeds::effect, walked(LineForm::exact),
                 config_only([](Config& c) { c.line_walk = LineForm::exact; }), walks_edges});
}

void add_numbers(std::vector<SuiteFeature>& out) {
  // The register of u and v: five fraction bits, so that every mode has something to round.
  for (const Rounding rounding : all_of<Rounding>()) {
    const Rounding other = rounding == Rounding::trn ? Rounding::rnd : Rounding::trn;
    const auto set = [](Config& c, Rounding mode) {
      for (const FormatId id : {FormatId::span_uv, FormatId::edge_uv}) {
        Format& f = c.format(id);
        f.word = f.integer + 5;
        f.rounding = mode;
      }
    };
    out.push_back({fmt::format("rounding.{}", lower_case(to_string(rounding)).substr(3)),
                   RecordType::fragment, SuiteNeeds::effect,
                   config_only([=](Config& c) { set(c, rounding); }),
                   config_only([=](Config& c) { set(c, other); })});
  }
  // The same register with four integer bits, which u and v leave.
  for (const Overflow overflow : all_of<Overflow>()) {
    const Overflow other = overflow == Overflow::wrap ? Overflow::sat : Overflow::wrap;
    const auto set = [](Config& c, Overflow mode) {
      Format& f = c.format(FormatId::span_uv);
      f.word -= f.integer - 4;
      f.integer = 4;
      f.overflow = mode;
      f.overflow_expected = true;
    };
    out.push_back({fmt::format("overflow.{}", lower_case(to_string(overflow)).substr(3)),
                   RecordType::fragment, SuiteNeeds::effect,
                   config_only([=](Config& c) { set(c, overflow); }),
                   config_only([=](Config& c) { set(c, other); })});
  }
}

void add_depth(std::vector<SuiteFeature>& out) {
  using enum DepthFunc;
  for (const DepthFunc func : all_of<DepthFunc>()) {
    SuiteFeature feature =
        choice("depth", &Config::depth_func, func, RecordType::depth, func == always ? less : always);
    // What passes only what is farther has nothing to pass: the cleared buffer is the farthest.
    if (func != always && func != never && func != greater) feature.needs = SuiteNeeds::passing;
    for (SuiteSetting* setting : {&feature.with, &feature.without}) {
      *setting = [set = *setting](Config& c, Scene& s) {
        repeat_depths(c, s);
        set(c, s);
      };
    }
    out.push_back(std::move(feature));
  }
  for (const DepthCode code : all_of<DepthCode>()) {
    out.push_back(choice("depth_code", &Config::depth_code, code, RecordType::depth));
    out.back().needs = SuiteNeeds::passing;
  }
  for (const DepthFunc func : all_of<DepthFunc>()) {
    if (!takes_tolerance(func)) continue;
    const auto set = [=](DepthCode code) -> SuiteSetting {
      return [=](Config& c, Scene& s) {
        repeat_depths(c, s);
        lay_decals(c, s);
        c.depth_code = code;
        c.depth_func = func;
      };
    };
    out.push_back({fmt::format("depth_dz.{}", to_string(func)), RecordType::depth, SuiteNeeds::passing,
                   set(DepthCode::float_dz), set(DepthCode::opengl)});
  }
  for (const Rounding rounding : {Rounding::rnd, Rounding::rnd_conv, Rounding::trn}) {
    const Rounding other = rounding == Rounding::trn ? Rounding::rnd : Rounding::trn;
    out.push_back({fmt::format("depth_rounding.{}", lower_case(to_string(rounding)).substr(3)),
                   RecordType::depth, SuiteNeeds::effect,
                   config_only([=](Config& c) { c.depth_rounding = rounding; }),
                   config_only([=](Config& c) { c.depth_rounding = other; })});
  }
}

void add_texture(std::vector<SuiteFeature>& out) {
  for (const TextureFilter filter : all_of<TextureFilter>()) {
    out.push_back(in(choice("texture", &Config::filter, filter, RecordType::texture), texture));
  }
  for (const TextureWrap wrap : all_of<TextureWrap>()) {
    out.push_back(in(choice("wrap", &Config::wrap, wrap, RecordType::texture), texture));
  }
  out.push_back(in({"texel.transparent", RecordType::texture, SuiteNeeds::killing,
                    config_only([](Config& c) { c.transparent = hole; }),
                    config_only([](Config& c) { c.transparent = std::nullopt; })},
                   texture));
}

// The random scene's textures give way to one whose sides are powers of two.
void one_texture(Scene& scene) {
  scene.textures.clear();
  for (Triangle& t : scene.triangles) t.texture = -1;
  texture(scene);
}

// What the codes of a format stand for: a palette that has few of an image's colours.
std::vector<std::int16_t> texel_table(TexelFormat format) {
  std::vector<std::int16_t> out;
  const int size = texel_layout(format).table_size;
  if (size == yiq_table_size) {
    for (int y = 0; y < 16; ++y) out.push_back(static_cast<std::int16_t>(17 * y));
    for (int k = 0; k < 24; ++k) out.push_back(static_cast<std::int16_t>(k * 37 % 161 - 80));
  }
  for (int k = 0; size == palette_size && k < 256; ++k) {
    for (const int code : {36 * (k % 8), 36 * (k / 8 % 8), 85 * (k / 64), 255}) {
      out.push_back(static_cast<std::int16_t>(code));
    }
  }
  return out;
}

void add_levels(std::vector<SuiteFeature>& out) {
  for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
    out.push_back(in({fmt::format("mip.{}", to_string(mip)), RecordType::texture, SuiteNeeds::effect,
                      config_only([=](Config& c) {
                        c.mip = mip;
                        c.lod = LodMode::zone_s;
                      }),
                      config_only([](Config& c) { c.mip = MipMode::none; })},
                     one_texture));
  }
  for (const LodMode lod : {LodMode::zone_s, LodMode::gradient, LodMode::zone_d, LodMode::finite}) {
    const auto set = [](Config& c, LodMode mode) {
      c.mip = MipMode::linear;
      c.lod = mode;
    };
    out.push_back(in({fmt::format("lod.{}", to_string(lod)), RecordType::lod, SuiteNeeds::effect,
                      config_only([=](Config& c) { set(c, lod); }),
                      config_only([=](Config& c) { set(c, LodMode::none); })},
                     one_texture));
    if (has_gradients(lod)) out.back().applies = divides_by_depth;
  }
  for (const TexelFormat format : all_of<TexelFormat>()) {
    if (format == TexelFormat::rgba8888 || is_procedural(format)) continue;
    const auto converts = [=](Config&, Scene& s) {
      Random random(1);
      for (Texture& t : s.textures) {
        t = converted(t, format, texel_table(format));
        // Blocks of every code: those of a picture leave some out.
        if (texel_layout(format).block_height == 1) continue;
        for (std::uint8_t& byte : t.raw) byte = static_cast<std::uint8_t>(random.integer(0, 255));
      }
    };
    out.push_back(in({fmt::format("texel_format.{}", to_string(format)), RecordType::texture,
                      SuiteNeeds::effect, converts, [](Config&, Scene&) {}},
                     one_texture));
  }
}

void add_procedural(std::vector<SuiteFeature>& out) {
  for (const TexelFormat format : all_of<TexelFormat>()) {
    if (!is_procedural(format)) continue;
    const auto computes = [=](Config&, Scene& s) {
      // Several, as one alone may have a single colour.
      Random random(1);
      const Texture image = s.textures.at(0);
      s.textures.clear();
      for (int i = 0; i < 4; ++i)
        s.textures.push_back(random_procedural(random, format, image.width, image.height));
      for (std::size_t i = 0; i < s.triangles.size(); ++i) {
        if (s.triangles[i].texture >= 0) s.triangles[i].texture = static_cast<int>(i % 4);
      }
    };
    out.push_back(in({fmt::format("procedural.{}", to_string(format)), RecordType::texture,
                      SuiteNeeds::effect, computes, [](Config&, Scene&) {}},
                     one_texture));
  }
}

// A register of the draw state and what it holds.
using Register = std::pair<std::string_view, std::int64_t>;

// A picture whose alpha is not 1 anywhere, so that factors of it tell.
SuiteFeature on_alpha(SuiteFeature feature) {
  for (SuiteSetting* setting : {&feature.with, &feature.without}) {
    *setting = [set = *setting](Config& c, Scene& s) {
      set(c, s);
      Clear clear;
      clear.alpha = 100;
      s.commands.insert(s.commands.begin(), {0, clear});
    };
  }
  return feature;
}

// Draws everything in a state.
SuiteSetting in_state(std::vector<Register> registers) {
  return [registers = std::move(registers)](Config&, Scene& scene) {
    StateChange change;
    for (const auto& [key, value] : registers) change.settings.push_back(state_setting(key, value));
    scene.commands.insert(scene.commands.begin(), {0, std::move(change)});
  };
}
template <class E>
std::int64_t number(E value) {
  return static_cast<std::int64_t>(value);
}
// Each triangle on the next of n targets.
SuiteSetting on_targets(int n) {
  return [=](Config&, Scene& scene) {
    for (std::size_t i = 0; n > 1 && i < scene.triangles.size(); ++i) {
      scene.commands.push_back({.before = i, .what = Target{static_cast<int>(i) % n}});
    }
  };
}
// The scene's only texture and another one, of another size.
void two_textures(Scene& scene) {
  one_texture(scene);
  Texture own;
  own.name = "second.png";
  own.width = 7;
  own.height = 12;
  for (int i = 0; i < own.width * own.height; ++i) {
    own.rgba.insert(own.rgba.end(), {static_cast<std::uint8_t>(i * 53), static_cast<std::uint8_t>(i * 7 + 20),
                                     static_cast<std::uint8_t>(255 - i * 3),
                                     static_cast<std::uint8_t>(i % 4 == 0 ? 130 : 255)});
  }
  scene.textures.push_back(std::move(own));
}

// A register whose values have names: each of them against another one, with further registers.
template <class E>
void add_values(std::vector<SuiteFeature>& out, const char* group, std::string_view key, RecordType stage,
                E first, E second, const std::vector<Register>& further, void (*textures)(Scene&) = texture) {
  for (const E value : all_of<E>()) {
    const auto with = [&](E v) {
      std::vector<Register> all = further;
      all.emplace_back(key, number(v));
      return in_state(std::move(all));
    };
    out.push_back(in({fmt::format("{}.{}", group, to_string(value)), stage, SuiteNeeds::effect, with(value),
                      with(value == first ? second : first)},
                     textures));
  }
}

// How texels are found, as the draw state says.
void add_lookups(std::vector<SuiteFeature>& out) {
  const std::vector<Register> on{{"texture1", 1}, {"texture1.op", number(TextureOp::replace)}};
  const auto add = [&](const char* group, std::string_view key, auto first, auto second, bool of_second) {
    add_values(out, group, key, of_second ? RecordType::texture_second : RecordType::texture, first, second,
               of_second ? on : std::vector<Register>{}, of_second ? two_textures : texture);
  };
  constexpr auto nearest = TextureFilter::nearest, bilinear = TextureFilter::bilinear;
  constexpr auto cyclic = TextureWrap::cyclic, clamp = TextureWrap::clamp;
  add("filter", "texture.filter", nearest, bilinear, false);
  add("wrap_u", "texture.wrap.u", cyclic, clamp, false);
  add("wrap_v", "texture.wrap.v", cyclic, clamp, false);
  add("texture1_filter", "texture1.filter", nearest, bilinear, true);
  add("texture1_wrap_u", "texture1.wrap.u", cyclic, clamp, true);
  add("texture1_wrap_v", "texture1.wrap.v", cyclic, clamp, true);
}

// The scene's only texture and another one, whose chain is longer.
void two_chains(Scene& scene) {
  two_textures(scene);
  Texture& own = scene.textures.back();
  const std::vector<std::uint8_t> given = std::move(own.rgba);
  own.width = 8;
  own.height = 32;
  own.rgba.clear();
  for (std::size_t i = 0; i < std::size_t{4} * 8 * 32; ++i) own.rgba.push_back(given[i % given.size()]);
}

// Which level a unit takes and how it is magnified, as the draw state says.
void add_level_choices(std::vector<SuiteFeature>& out) {
  const auto add = [&](std::string name, bool of_second, const Register& changed,
                       const std::vector<Register>& further) {
    std::vector<Register> without = further;
    if (of_second)
      without.insert(without.end(), {{"texture1", 1}, {"texture1.op", number(TextureOp::replace)}});
    std::vector<Register> with = without;
    with.push_back(changed);
    const bool is_found = changed.first.ends_with(".magnify");
    SuiteFeature feature{std::move(name),
                         of_second  ? RecordType::texture_second
                         : is_found ? RecordType::texture
                                    : RecordType::lod,
                         SuiteNeeds::effect, in_state(std::move(with)), in_state(std::move(without))};
    for (SuiteSetting* setting : {&feature.with, &feature.without}) {
      *setting = [set = *setting](Config& c, Scene& s) {
        c.mip = MipMode::linear;
        c.lod = LodMode::zone_s;
        c.lod_first = 32768;  // what is nearer than half of s_max has a level of detail of just the bias
        set(c, s);
      };
    }
    out.push_back(in(std::move(feature), of_second ? two_chains : one_texture));
  };
  for (const bool of_second : {false, true}) {
    const std::string unit = of_second ? "texture1_" : "";
    const auto key = [&](std::string_view first, std::string_view second) {
      return of_second ? second : first;
    };
    const std::string_view bias = key("texture.lod.bias", "texture1.lod.bias");
    const std::string_view least = key("texture.level.least", "texture1.level.least");
    const std::string_view greatest = key("texture.level.greatest", "texture1.level.greatest");
    const std::string_view filter = key("texture.filter", "texture1.filter");
    const std::string_view magnify = key("texture.magnify", "texture1.magnify");
    const std::vector<Register> of_first{{"texture.lod.bias", 5}};  // which the second unit does not have
    for (const auto& [name, value] : {std::pair{"minus", -13}, {"plus", 21}})
      add(fmt::format("{}lod_bias.{}", unit, name), of_second, {bias, value},
          of_second ? of_first : std::vector<Register>{});
    for (const int level : {1, 3})
      add(fmt::format("{}level_least.{}", unit, level), of_second, {least, level}, {});
    for (const int level : {0, 1})
      add(fmt::format("{}level_greatest.{}", unit, level), of_second, {greatest, level}, {{bias, 25}});
    add(unit + "level_least.above", of_second, {least, 2}, {{greatest, 1}});
    for (const MagnifyFilter value : {MagnifyFilter::nearest, MagnifyFilter::bilinear}) {
      const TextureFilter other =
          value == MagnifyFilter::nearest ? TextureFilter::bilinear : TextureFilter::nearest;
      // One of them where the level of detail is 0, the other below.
      add(fmt::format("{}magnify.{}", unit, to_string(value)), of_second, {magnify, number(value)},
          {{filter, number(other)}, {bias, value == MagnifyFilter::nearest ? -12 : 0}});
    }
  }
}

void add_second_texture(std::vector<SuiteFeature>& out) {
  const auto with = [](TextureOp op, int scale) {
    return in_state({{"texture1", 1},
                     {"texture1.op", number(op)},
                     {"texture1.scale", scale},
                     {"texture1.red", 200},
                     {"texture1.green", 30},
                     {"texture1.blue", 90}});
  };
  for (const TextureOp op : all_of<TextureOp>()) {
    const TextureOp other = op == TextureOp::replace ? TextureOp::modulate : TextureOp::replace;
    out.push_back(in({fmt::format("texture1.{}", to_string(op)), RecordType::texture_second,
                      SuiteNeeds::effect, with(op, 1), with(other, 1)},
                     two_textures));
  }
  for (const int scale : {1, 2}) {
    out.push_back(in({fmt::format("texture1_scale.{}", scale), RecordType::texture_second, SuiteNeeds::effect,
                      with(TextureOp::modulate_scaled, scale), with(TextureOp::modulate_scaled, 0)},
                     two_textures));
  }
  out.push_back(in({"texture1_on.modulate", RecordType::fog, SuiteNeeds::effect, with(TextureOp::modulate, 0),
                    in_state({})},
                   two_textures));
}

// Three textures, the last one of depth codes; and a projector that stands beside the viewer and in front of
// him, so that some of the scene lies behind it, and some beside its texture.
void three_projected(Scene& scene) {
  two_textures(scene);
  Viewpoint view;
  view.width = 16;
  view.height = 12;
  view.focal = 12;
  const double middle = std::sqrt(scene.s_min * scene.s_max);
  view.position = {0.1 * middle, 0.05 * middle, 0.25 * middle};
  Texture map{"map.raw", view.width, view.height, {}, TexelFormat::depth};
  for (std::uint32_t i = 0; i < 16 * 12; ++i) {
    const std::uint32_t word = i * 0x9e3779b1U;
    for (int at = 0; at < 32; at += 8) map.raw.push_back(static_cast<std::uint8_t>(word >> at));
  }
  scene.textures.push_back(std::move(map));
  scene.projector = Projector{0.5 * middle, scene.s_max};
  give_projection(scene.triangles, scene, view);
}

void add_projection(std::vector<SuiteFeature>& out) {
  using enum RecordType;
  const auto add = [&](std::string name, RecordType stage, const std::vector<Register>& with,
                       const std::vector<Register>& without) {
    const auto set = [](const std::vector<Register>& further) {
      std::vector<Register> all{{"texture1", 2},
                                {"texture1.coordinates", 1},
                                {"texture1.red", 90},
                                {"texture1.green", 60},
                                {"texture1.blue", 70}};
      for (const Register& r : further) {
        std::erase_if(all, [&](const Register& other) { return other.first == r.first; });
        all.push_back(r);
      }
      return [state = in_state(all)](Config& c, Scene& s) {
        c.project = ProjectUnit::reciprocal;
        state(c, s);
      };
    };
    out.push_back(in({std::move(name), stage, SuiteNeeds::effect, set(with), set(without)}, three_projected));
  };
  const Register compares{"texture1.compare", 1}, bilinear{"texture1.filter", 1};
  add("project.slide", texture_second, {{"texture1", 1}}, {{"texture1", 1}, {"texture1.coordinates", 0}});
  add("project.smooth_slide", texture_second, {{"texture1", 1}, bilinear}, {{"texture1", 1}});
  add("project_place.map", project, {{"texture1", 2}}, {{"texture1", 0}});
  add("project.dark", texture_second, {{"texture1.outside", 1}}, {});
  add("project.dark_slide", texture_second, {{"texture1", 1}, {"texture1.outside", 1}}, {{"texture1", 1}});
  add("project.border", texture_second,
      {{"texture1", 1}, bilinear, {"texture1.wrap.u", number(TextureWrap::border)}},
      {{"texture1", 1}, bilinear, {"texture1.wrap.u", number(TextureWrap::clamp)}});
  add("project.compare", texture_second, {compares}, {});
  add("project.smooth_compare", texture_second, {compares, bilinear}, {compares});
  add("project.late", texture_second, {compares, {"depth.when", number(DepthWhen::late)}},
      {{"depth.when", number(DepthWhen::late)}});
  for (const std::int64_t bias : {-20000, 9000}) {
    add(fmt::format("project_bias.{}", bias), texture_second, {compares, {"texture1.bias", bias}},
        {compares});
  }
  // Against the one that passes what it does not, at the farther side of the list.
  const auto funcs = static_cast<std::int64_t>(enum_names<DepthFunc>.size());
  for (const DepthFunc func : all_of<DepthFunc>()) {
    add(fmt::format("project_func.{}", to_string(func)), texture_second,
        {compares, {"texture1.func", number(func)}},
        {compares, {"texture1.func", (number(func) + funcs / 2) % funcs}});
  }
  SuiteFeature opengl = *std::ranges::find(out, "project.compare", &SuiteFeature::name);
  opengl.name = "project.opengl_compare";
  for (SuiteSetting* setting : {&opengl.with, &opengl.without}) {
    *setting = [set = *setting](Config& c, Scene& s) {
      c.depth_code = DepthCode::opengl;
      set(c, s);
    };
  }
  out.push_back(std::move(opengl));
}

void add_states(std::vector<SuiteFeature>& out) {
  const auto add = [&](std::string name, RecordType stage, std::vector<Register> registers) {
    out.push_back(in(
        {std::move(name), stage, SuiteNeeds::effect, in_state(std::move(registers)), in_state({})}, texture));
  };
  add("depth_bias.plus", RecordType::depth, {{"depth.bias", 300}});
  add("depth_bias.minus", RecordType::depth, {{"depth.bias", -300}});
  add("depth_write.off", RecordType::depth, {{"depth.write", 0}});
  add("scissor.inside", RecordType::depth,
      {{"scissor.left", 5}, {"scissor.top", 3}, {"scissor.right", 27}, {"scissor.bottom", 20}});
  add("stipple.holes", RecordType::depth, {{"stipple", 0xa5c30f69}});
  add("color_write.off", RecordType::merge, {{"color.write", 0}, {"depth.func", number(DepthFunc::always)}});
  const Register always{"depth.func", number(DepthFunc::always)};
  out.push_back(in({"color_mask.green_alpha", RecordType::merge, SuiteNeeds::effect,
                    in_state({{"color.mask", 10}, always}), in_state({always})},
                   texture));
  for (const CompareFunc func : all_of<CompareFunc>()) {
    // The largest code is the one that fragments have exactly.
    const int ref = func == CompareFunc::equal || func == CompareFunc::not_equal ? 255 : 128;
    const auto with = [&](CompareFunc f) {
      return in_state({{"alpha.ref", ref}, {"alpha.func", number(f)}});
    };
    const CompareFunc other = func == CompareFunc::always ? CompareFunc::never : CompareFunc::always;
    out.push_back(in({fmt::format("alpha_test.{}", to_string(func)), RecordType::texture, SuiteNeeds::effect,
                      with(func), with(other)},
                     texture));
  }
  // What an additive effect needs: the colours of alpha 0 are added.
  const Register added{"blend.src", number(BlendFactor::one)};
  out.push_back(in({"alpha_zero.keep", RecordType::texture, SuiteNeeds::effect,
                    in_state({added, {"alpha.zero", number(AlphaZero::keep)}}), in_state({added})},
                   clear_texels));
  // The test needs late tests; each case changes the plane, so that values come up on either side.
  const std::vector<Register> counting{{"depth.when", number(DepthWhen::late)},
                                       {"stencil.test", 1},
                                       {"stencil.ref", 1},
                                       {"stencil.mask", 3},
                                       {"stencil.fail", number(StencilOp::increment_wrap)},
                                       {"stencil.zfail", number(StencilOp::increment_wrap)},
                                       {"stencil.pass", number(StencilOp::increment_wrap)}};
  add_values(out, "stencil_func", "stencil.func", RecordType::stencil, CompareFunc::always,
             CompareFunc::never, counting);
  const std::vector<Register> passing{{"depth.when", number(DepthWhen::late)},
                                      {"stencil.test", 1},
                                      {"stencil.ref", 9},
                                      {"stencil.write", 0x3f},
                                      {"stencil.zfail", number(StencilOp::invert)}};
  add_values(out, "stencil_op", "stencil.pass", RecordType::stencil, StencilOp::keep, StencilOp::increment,
             passing);
  std::vector<Register> sides = counting;
  sides.insert(sides.end(), {{"stencil.two_sided", 1},
                             {"stencil.back.func", number(CompareFunc::less_equal)},
                             {"stencil.back.fail", number(StencilOp::invert)},
                             {"stencil.back.zfail", number(StencilOp::increment_wrap)},
                             {"stencil.back.pass", number(StencilOp::increment_wrap)}});
  for (const Register& changed :
       {Register{"stencil.back.ref", 2}, {"stencil.back.mask", 1}, {"stencil.back.write", 0x55}}) {
    std::vector<Register> with = sides;
    with.push_back(changed);
    out.push_back(in({fmt::format("stencil_back.{}", changed.first.substr(changed.first.rfind('.') + 1)),
                      RecordType::stencil, SuiteNeeds::effect, in_state(with), in_state(sides)},
                     texture));
  }
  const std::vector<Register> constant{
      {"blend.red", 100}, {"blend.green", 150}, {"blend.blue", 200}, {"blend.alpha", 90}};
  const std::size_t first_blend = out.size();
  add_values(out, "blend_src", "blend.src", RecordType::merge, BlendFactor::zero, BlendFactor::one, constant);
  add_values(out, "blend_dst", "blend.dst", RecordType::merge, BlendFactor::zero, BlendFactor::one, constant);
  add_values(out, "blend_op", "blend.op", RecordType::merge, BlendOp::add, BlendOp::max, constant);
  for (std::size_t i = first_blend; i < out.size(); ++i) out[i] = on_alpha(std::move(out[i]));
  const std::size_t first_alpha = out.size();
  add_values(out, "blend_alpha_src", "blend.alpha.src", RecordType::merge_alpha, BlendFactor::zero,
             BlendFactor::one, constant);
  add_values(out, "blend_alpha_dst", "blend.alpha.dst", RecordType::merge_alpha, BlendFactor::zero,
             BlendFactor::one, constant);
  add_values(out, "blend_alpha_op", "blend.alpha.op", RecordType::merge_alpha, BlendOp::add, BlendOp::max,
             {{"blend.alpha.src", number(BlendFactor::one)}});
  for (std::size_t i = first_alpha; i < out.size(); ++i) out[i] = on_alpha(std::move(out[i]));
  for (const LogicOp op : all_of<LogicOp>()) {
    if (op != LogicOp::none)
      add(fmt::format("logic.{}", to_string(op)), RecordType::merge, {{"logic.op", number(op)}});
  }
  for (std::size_t i = first_blend; i < out.size(); ++i) out[i] = in_rtl_by_equation(std::move(out[i]));
  for (const TargetFormat format : all_of<TargetFormat>()) {
    if (!is_narrow(format)) continue;
    add(fmt::format("target.{}", to_string(format)), RecordType::merge, {{"target.format", number(format)}});
    const Register target{"target.format", number(format)};
    out.push_back(
        in({fmt::format("target_round.{}", to_string(format)), RecordType::merge, SuiteNeeds::effect,
            in_state({target, {"target.round", number(TargetRound::nearest)}}), in_state({target})},
           texture));
    for (const Dither dither : all_of<Dither>()) {
      if (dither == Dither::none) continue;
      out.push_back(
          in({fmt::format("dither_{}.{}", to_string(format), to_string(dither)), RecordType::merge,
              SuiteNeeds::effect, in_state({target, {"target.dither", number(dither)}}), in_state({target})},
             texture));
    }
  }
  out.push_back(
      in({"targets.three", RecordType::depth, SuiteNeeds::effect, on_targets(3), on_targets(1)}, texture));
  for (const ChromaTest test : {ChromaTest::inside, ChromaTest::outside}) {
    add(fmt::format("chroma.{}", to_string(test)), RecordType::texture,
        {{"chroma.test", number(test)}, {"chroma.high.red", 160}, {"chroma.low.green", 50}});
  }
}

// Every second triangle gives its depth, and all have coordinates for a second texture.
void own_lines(Scene& scene) {
  two_textures(scene);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vertex& v = scene.triangles[i].v[k];
      if (i % 2 == 0) v.z = static_cast<double>((3 * i + 5 * k) % 11) / 10;
      v.u2 = 0.5 * v.v - static_cast<double>(i % 4);
      v.v2 = 3 - 0.75 * v.u;
    }
  }
}

// Lines that take the places of a fragment's own: shades and coordinates divided per pixel, and a depth.
void add_own_lines(std::vector<SuiteFeature>& out) {
  using enum RecordType;
  const auto add = [&](std::string name, RecordType stage, const SuiteSetting& state, auto set, auto unset) {
    const auto with = [state](auto change) {
      return [=](Config& c, Scene& s) {
        if (!divides_each_pixel(c)) c.perspective = Perspective::delta_f;
        c.subspan_bits = 0;
        change(c);
        state(c, s);
      };
    };
    out.push_back(in({std::move(name), stage, SuiteNeeds::effect, with(set), with(unset)}, own_lines));
  };
  const auto shades = [](ShadeLines lines) { return [=](Config& c) { c.shade_lines = lines; }; };
  const auto second = [](SecondCoordinates of) { return [=](Config& c) { c.second_coordinates = of; }; };
  const auto depth_of = [](DepthLine line, DepthCode code) {
    return [=](Config& c) {
      c.depth_line = line;
      c.depth_code = code;
    };
  };
  const SuiteSetting plain = in_state({});
  const auto hyperbolic = [](auto set) {
    return [=](Config& c) {
      c.perspective = Perspective::hyperbolic;
      set(c);
    };
  };
  add("perspective_shades.texture", texture, plain, shades(ShadeLines::perspective),
      shades(ShadeLines::linear));
  add("perspective_shades.hyperbolic", texture, plain, hyperbolic(shades(ShadeLines::perspective)),
      hyperbolic(shades(ShadeLines::linear)));
  add("perspective_shades.lit", texture, in_state({{"alpha.func", number(CompareFunc::greater)}}),
      shades(ShadeLines::perspective), shades(ShadeLines::linear));
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
      add(fmt::format("depth_line.{}_{}", to_string(code), to_string(when)), RecordType::depth,
          in_state({{"depth.when", number(when)}}), depth_of(DepthLine::z, code),
          depth_of(DepthLine::h, code));
    }
    add(fmt::format("depth_line.{}_bias", to_string(code)), RecordType::depth,
        in_state({{"depth.bias", -40}}), depth_of(DepthLine::z, code), depth_of(DepthLine::h, code));
  }
  for (const TextureOp op : {TextureOp::modulate, TextureOp::decal, TextureOp::add}) {
    add(fmt::format("second_coordinates.{}", to_string(op)), texture_second,
        in_state({{"texture1", 1}, {"texture1.op", number(op)}}), second(SecondCoordinates::own),
        second(SecondCoordinates::first));
  }
  add("second_coordinates.hyperbolic", texture_second, in_state({{"texture1", 1}}),
      hyperbolic(second(SecondCoordinates::own)), hyperbolic(second(SecondCoordinates::first)));
  add("second_coordinates.smooth", texture_second, in_state({{"texture1", 1}, {"texture1.filter", 1}}),
      second(SecondCoordinates::own), second(SecondCoordinates::first));
}

// A light beside the viewer, and normals that turn from vertex to vertex; some triangles have none.
void under_light(Scene& scene) {
  two_textures(scene);
  const double middle = std::sqrt(scene.s_min * scene.s_max);
  scene.light = Light{.place = {-0.5 * middle, -0.75 * middle, -0.25 * middle},
                      .ambient = 0.125,
                      .specular = 0.375,
                      .exponent = 12};
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (i % 7 == 6) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto turn = static_cast<double>(3 * i + 5 * k);
      set_normal(scene.triangles[i].v[k],
                 of_length_1({std::sin(turn), std::cos(2 * turn), -0.5 - 0.25 * std::sin(3 * turn)}));
    }
  }
}
// The same light, at a point.
void under_lamp(Scene& scene) {
  under_light(scene);
  scene.light->is_point = true;
}

// The same, over maps of normals: the light's place turns from triangle to triangle.
void over_relief(Scene& scene) {
  under_light(scene);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vertex& v = scene.triangles[i].v[k];
      v.lx = v.u + 20 * std::sin(static_cast<double>(i));
      v.ly = 3 + 8 * static_cast<double>(i % 5) - static_cast<double>(k);
      v.lz = 6 + static_cast<double>(i % 3);
    }
  }
}

// A light beyond the surfaces. What they mirror of it at a grazing angle must not show.
void under_back_light(Scene& scene) {
  under_light(scene);
  scene.light->place[2] *= -6;
  scene.light->exponent = 2;
}

// The light beyond the surfaces, and half of them turned away from the viewer, toward it.
void under_turned_light(Scene& scene) {
  under_light(scene);
  scene.light->place[2] *= -4;
  for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
    for (Vertex& v : scene.triangles[i].v) v.nz = -v.nz;
  }
}

void add_light(std::vector<SuiteFeature>& out) {
  using enum RecordType;
  struct Unit {
    LightAt at = LightAt::pixel;
    LightSource source = LightSource::parallel;
    int index_bits = 9, steps = 2;
    LightLaw law = LightLaw::lambert;
    LightNormal normal = LightNormal::channel;
    LightShadow shadow = LightShadow::none;
    LightFall fall = LightFall::none;
    LightFallTo fall_to = LightFallTo::light;
    double reach = 1.25, offset = 0.375;  // the former of the middle of the distances
    std::vector<Register> state{};
  };
  const auto set = [](const Unit& unit) {
    return [unit, state = in_state(unit.state)](Config& c, Scene& s) {
      c.light = unit.at;
      c.light_source = unit.source;
      c.light_index_bits = unit.index_bits;
      c.light_root.steps = unit.steps;
      c.light_law = unit.law;
      c.light_normal = unit.normal;
      c.light_shadow = unit.shadow;
      c.light_fall = unit.fall;
      c.light_fall_to = unit.fall_to;
      if (s.light && is_lunar(unit.law)) s.light->lunar = 2.5;
      if (s.light && falls(unit.fall)) {
        s.light->reach = unit.reach * std::sqrt(s.s_min * s.s_max);
        s.light->offset = unit.offset;
      }
      state(c, s);
    };
  };
  const auto add = [&](std::string name, RecordType stage, const Unit& with, const Unit& without,
                       void (*scene)(Scene&)) {
    out.push_back(in({std::move(name), stage, SuiteNeeds::effect, set(with), set(without)}, scene));
  };
  const auto point = LightSource::point;
  for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
    const std::string_view name = to_string(at);
    add(fmt::format("light_at.{}", name), fog, {.at = at}, {.at = LightAt::none}, under_light);
    add(fmt::format("light_point.{}", name), fog, {.at = at, .source = point},
        {.at = LightAt::none, .source = point}, under_lamp);
  }
  add("light_at.pixel_from_behind", fog, {}, {.at = LightAt::none}, under_back_light);
  add("light_at.vertex_not_pixel", fog, {.at = LightAt::vertex}, {}, under_light);
  add("light_table.coarse", light, {.index_bits = 2}, {}, under_light);
  add("light_root.no_step", light, {.steps = 0}, {}, under_light);
  for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
    add(fmt::format("light_lunar.{}", to_string(at)), fog, {.at = at, .law = LightLaw::lunar}, {.at = at},
        under_light);
  }
  add("light_lunar.turned_away", fog, {.law = LightLaw::lunar}, {}, under_turned_light);
  for (const LightFall fall : {LightFall::first, LightFall::second}) {
    for (const LightFallTo to : {LightFallTo::light, LightFallTo::viewer}) {
      add(fmt::format("light_fall.{}_to_{}", to_string(fall), to_string(to)), fog,
          {.source = point, .fall = fall, .fall_to = to}, {.source = point}, under_lamp);
    }
    add(fmt::format("light_fall.{}_at_vertices", to_string(fall)), fog,
        {.at = LightAt::vertex, .source = point, .fall = fall, .fall_to = LightFallTo::viewer},
        {.at = LightAt::vertex, .source = point}, under_lamp);
  }
  add("light_fall.of_a_far_light", fog,
      {.source = point, .fall = LightFall::first, .fall_to = LightFallTo::viewer}, {.source = point},
      under_light);
  // So near that a register of the distance's square holds 0.
  add("light_fall.within_reach", fog,
      {.source = point, .fall = LightFall::second, .reach = 2000, .offset = 0}, {.source = point},
      under_lamp);
  const std::vector<Register> by_map{{"texture1", 1}, {"texture1.op", number(TextureOp::relief)}};
  for (const LightSource source : {LightSource::parallel, LightSource::point}) {
    add(fmt::format("light_relief.{}", to_string(source)), fog,
        {.source = source, .normal = LightNormal::map, .state = by_map}, {.source = source, .state = by_map},
        over_relief);
  }
  std::vector<Register> smooth = by_map;
  smooth.push_back({"texture1.filter", number(TextureFilter::bilinear)});
  add("light_relief.smooth", fog, {.normal = LightNormal::map, .state = smooth},
      {.normal = LightNormal::map, .state = by_map}, over_relief);
  add("light_relief.off", fog, {.normal = LightNormal::map, .state = {{"texture1", 1}}},
      {.normal = LightNormal::map, .state = by_map}, over_relief);
  const std::vector<Register> by_shadow{{"texture1", 1}, {"texture1.op", number(TextureOp::shadow)}};
  add("light_shadow.map", fog, {.shadow = LightShadow::map, .state = by_shadow}, {.state = by_shadow},
      under_light);
  std::vector<Register> soft = by_shadow;
  soft.push_back({"texture1.filter", number(TextureFilter::bilinear)});
  add("light_shadow.soft", fog, {.shadow = LightShadow::map, .state = soft},
      {.shadow = LightShadow::map, .state = by_shadow}, under_light);
  add("light_shadow.of_a_light_that_falls", fog,
      {.source = point, .shadow = LightShadow::map, .fall = LightFall::second, .state = by_shadow},
      {.source = point, .fall = LightFall::second, .state = by_shadow}, under_lamp);
  add("light_shadow.off", fog, {.shadow = LightShadow::map, .state = {{"texture1", 1}}},
      {.shadow = LightShadow::map, .state = by_shadow}, under_light);
  add("light_late.pixel", fog, {.state = {{"depth.when", number(DepthWhen::late)}}},
      {.at = LightAt::none, .state = {{"depth.when", number(DepthWhen::late)}}}, under_light);
  add("light_second.pixel", fog, {.state = {{"texture1", 1}}},
      {.at = LightAt::none, .state = {{"texture1", 1}}}, under_light);
}

// Every second triangle is translucent, and all are drawn in passes: the opaque fragments, and then so many
// layers of the others.
void in_layers(Scene& scene, int layers) {
  for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
    for (Vertex& v : scene.triangles[i].v) v.c[3] = 0.2 + 0.1 * static_cast<double>(i % 8);
  }
  std::vector<Pass> passes;
  for (int k = 0; k <= layers; ++k) {
    const TranslucencyPass pass = k == 0 ? TranslucencyPass::opaque : TranslucencyPass::candidate;
    passes.push_back({.name = "layer",
                      .resolves = k > 1,
                      .states = {{.settings = {state_setting("translucency.pass", pass)}}},
                      .triangles = scene.triangles});
  }
  scene.triangles.clear();
  flatten(passes, scene);
  scene.commands.push_back({scene.triangles.size(), Resolve{}});
}

void add_translucency(std::vector<SuiteFeature>& out) {
  const auto add = [&](std::string_view name, RecordType stage, auto set, const std::vector<Register>& state,
                       void (*textures)(Scene&) = texture) {
    const SuiteSetting in_force = in_state(state);
    const auto with = [=](int layers) {
      return [=](Config& c, Scene& s) {
        set(c);
        if (layers > 0) in_layers(s, layers);
        in_force(c, s);
      };
    };
    out.push_back(in({std::string(name), stage, SuiteNeeds::effect, with(2), with(0)}, textures));
  };
  const auto as_drawn = [](Config&) {};
  for (const TranslucencyPass pass : {TranslucencyPass::opaque, TranslucencyPass::candidate}) {
    const Register only{"translucency.pass", number(pass)};
    out.push_back(in({fmt::format("translucency_pass.{}", to_string(pass)), RecordType::texture,
                      SuiteNeeds::effect, in_state({only}), in_state({})},
                     texture));
  }
  for (const DepthCode code : all_of<DepthCode>()) {
    add(fmt::format("translucency.{}", to_string(code)), RecordType::candidate,
        [=](Config& c) {
          c.depth_code = code;
          // Few codes of z, so that fragments tie in z and differ in dz.
          if (has_dz(code)) c.depth_bits = dz_bits + float_dz_exponent_bits + 3;
        },
        {});
  }
  const Register late{"depth.when", number(DepthWhen::late)};
  add("translucency_state.late", RecordType::candidate, as_drawn, {late});
  add("translucency_state.second", RecordType::candidate, as_drawn, {{"texture1", 1}}, two_textures);
  add("translucency_state.stencil", RecordType::candidate, as_drawn,
      {late, {"stencil.test", 1}, {"stencil.pass", number(StencilOp::increment)}});
  add("resolve.blend", RecordType::merge, as_drawn, {{"blend.dst", number(BlendFactor::one)}});
  add("resolve.alpha", RecordType::merge, as_drawn, {{"blend.alpha.src", number(BlendFactor::one)}});
  add("resolve.rgb565", RecordType::merge, as_drawn,
      {{"target.format", number(TargetFormat::rgb565)}, {"target.dither", number(Dither::matrix4)}});
}

void add_fog_and_merge(std::vector<SuiteFeature>& out) {
  out.push_back(in(choice("fog", &Config::fog, FogMode::linear, RecordType::fog, FogMode::none), fog));
  for (const auto& split : {std::pair{6, 4}, {8, 2}, {5, 0}}) {
    const int depth_bits = split.first, zone_bits = split.second;
    out.push_back(in({fmt::format("fog.table_{}_{}", depth_bits, zone_bits), RecordType::fog,
                      SuiteNeeds::effect, config_only([=](Config& c) {
                        c.fog = FogMode::table;
                        c.fog_depth_bits = depth_bits;
                        c.fog_zone_bits = zone_bits;
                      }),
                      config_only([](Config& c) { c.fog = FogMode::none; })},
                     fog));
  }
  for (const FogMode mode : {FogMode::distance, FogMode::log}) {
    out.push_back(in(choice("fog", &Config::fog, mode, RecordType::fog, FogMode::none), fog));
  }
  out.push_back(in(choice("fog", &Config::fog, FogMode::vertex, RecordType::fog, FogMode::none), vertex_fog));
  out.push_back(
      in(choice("fog_channel", &Config::fog, FogMode::vertex, RecordType::fragment_channel, FogMode::log),
         vertex_fog));
  out.push_back(in({"fog_zone.r", RecordType::fog, SuiteNeeds::effect, config_only([](Config& c) {
                      c.fog = FogMode::table;
                      c.fog_zone = FogZone::r;
                    }),
                    config_only([](Config& c) {
                      c.fog = FogMode::table;
                      c.fog_zone = FogZone::r2;
                    })},
                   fog));
  out.push_back(in({"merge.blend", RecordType::merge, SuiteNeeds::effect,
                    [](Config&, Scene& s) {
                      for (Triangle& t : s.triangles) t.v[0].c[3] = 0.5;
                    },
                    [](Config&, Scene& s) { opaque(s); }},
                   texture));
}

std::vector<SuiteFeature> make_features() {
  std::vector<SuiteFeature> out;
  add_raster(out);
  add_slopes(out);
  add_subspans(out);
  add_lines(out);
  add_numbers(out);
  add_depth(out);
  add_texture(out);
  add_levels(out);
  add_procedural(out);
  add_states(out);
  add_second_texture(out);
  add_projection(out);
  add_own_lines(out);
  add_light(out);
  add_translucency(out);
  add_lookups(out);
  add_level_choices(out);
  add_fog_and_merge(out);
  return out;
}

// ---- Cases

struct Named {
  const SuiteFeature* feature;
  Perspective perspective;
  int width, height;
  std::string name;
};

const std::vector<Named>& all_suites() {
  static const std::vector<Named> all = [] {
    std::vector<Named> out;
    for (const SuiteFeature& feature : suite_features()) {
      for (const Perspective p : all_of<Perspective>()) {
        if (feature.applies != nullptr && !feature.applies(p)) continue;
        for (const auto& [width, height] : sizes) {
          out.push_back({&feature, p, width, height,
                         fmt::format("{}/{}/{}x{}", feature.name, to_string(p), width, height)});
        }
      }
    }
    return out;
  }();
  return all;
}

bool is_legal(const Config& config) {
  try {
    check_config(config, "suite");
  } catch (const InputError&) {
    return false;
  }
  return true;
}

std::uint64_t number_of(const Fnv128& hash) { return std::stoull(hash.hex().substr(16), nullptr, 16); }

// All records of the scene, and the picture in the engine.
Trace trace_of(Engine& engine, const Scene& scene) {
  Trace out;
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), &out);
  return out;
}

std::string trivial_of(const SuiteCase& suite, const SuiteResult& result) {
  const Counters& n = result.counters;
  if (n.covered == 0) return "the scene covers no pixel centre";
  if (result.run.pairs.empty()) return "there is one engine only";
  for (const Comparison& pair : result.run.pairs) {
    if (pair.total().non_trivial == 0) return pair.other + " was compared in nothing non-trivial";
  }
  if (result.effect == 0) {
    return fmt::format("every record of {} is the same without the feature", stage_of(suite.stage));
  }
  switch (suite.needs) {
    case SuiteNeeds::effect:
      break;
    case SuiteNeeds::passing:
      if (n.depth_passed == 0) return "no fragment passed the depth test";
      if (n.depth_passed == n.covered) return "no fragment failed the depth test";
      break;
    case SuiteNeeds::killing:
      if (n.killed == 0) return "no fragment was killed";
      if (n.written == 0) return "every fragment was killed";
      break;
  }
  return "";
}

}  // namespace

const std::vector<SuiteFeature>& suite_features() {
  static const std::vector<SuiteFeature> features = make_features();
  return features;
}

std::vector<std::string> suite_names() {
  std::vector<std::string> out;
  for (const Named& suite : all_suites()) out.push_back(suite.name);
  return out;
}

std::vector<std::string> matching_suites(const std::string& pattern) {
  std::vector<std::string> out;
  for (const Named& suite : all_suites()) {
    if (::fnmatch(pattern.c_str(), suite.name.c_str(), 0) == 0) out.push_back(suite.name);
  }
  return out;
}

SuiteCase make_suite(const std::string& name, std::uint64_t seed, int attempt) {
  const auto found = std::ranges::find(all_suites(), name, &Named::name);
  if (found == all_suites().end()) throw InputError(name + ": no such suite");
  Fnv128 hash;
  hash.text(name);
  hash.number(seed);
  hash.number(attempt);
  Random random(number_of(hash));

  RandomOptions options;
  options.width = found->width;
  options.height = found->height;
  options.triangles = 40;
  options.size_min = 4;
  options.size_max = 2.0 * found->width;
  options.depth_ratio_max = std::max(4.0, 100 / std::pow(2.0, attempt));
  options.uv_limit = std::max(24.0, 128 / std::pow(2.0, attempt));
  options.texture_size_max = 32;
  SuiteCase out;
  out.scene = random_scene(random.bits(), options);
  out.scene.name = name;
  out.scene_without = out.scene;
  out.name = name;
  out.stage = found->feature->stage;
  out.needs = found->feature->needs;
  // The first shipped configuration, from one at random on, with which the feature is legal.
  const auto bases = config_texts();
  const auto first = static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(bases.size()) - 1));
  for (std::size_t i = 0; i < bases.size(); ++i) {
    const Config base = find_config(std::string(bases[(first + i) % bases.size()].name));
    Scene scene = out.scene, scene_without = out.scene_without;
    out.config = out.config_without = base;
    out.config.perspective = out.config_without.perspective = found->perspective;
    found->feature->with(out.config, scene);
    found->feature->without(out.config_without, scene_without);
    out.config.name = out.config_without.name = name;
    if (!is_legal(out.config) || !is_legal(out.config_without)) continue;
    out.scene = std::move(scene);
    out.scene_without = std::move(scene_without);
    return out;
  }
  throw std::logic_error(name + ": no shipped configuration takes the feature");
}

std::uint64_t SuiteResult::values() const {
  std::uint64_t out = 0;
  for (const Comparison& pair : run.pairs) out += pair.total().values;
  return out;
}

std::uint64_t SuiteResult::non_trivial() const {
  std::uint64_t out = 0;
  for (const Comparison& pair : run.pairs) out += pair.total().non_trivial;
  return out;
}

std::uint64_t SuiteResult::differences() const {
  std::uint64_t out = 0;
  for (const Comparison& pair : run.pairs) out += pair.differences();
  return out;
}

bool SuiteResult::agree() const {
  return std::ranges::all_of(run.pairs, [](const Comparison& pair) { return pair.held(); });
}

SuiteResult run_suite(const SuiteCase& suite, const SuiteEngines& engines) {
  check_scene_range(suite.config, suite.scene);
  check_scene_range(suite.config_without, suite.scene_without);
  const auto with = engines.reference(suite.config);
  const auto without = engines.reference(suite.config_without);
  Comparison effect;
  const Trace records = trace_of(*with, suite.scene);
  compare_records(records, trace_of(*without, suite.scene_without), suite.stage, effect);

  SuiteResult out;
  const std::vector<std::unique_ptr<Engine>> compared = engines.all(suite.config);
  out.run = run_lock_step(compared, suite.scene, {});
  out.counters = compared[0]->counters();
  const StageCount& stage = effect.stages[static_cast<std::size_t>(suite.stage)];
  out.effect = stage.differences + stage.unmatched;
  Fnv128 hash;
  hash.text(config_hash(suite.config));
  const Frame& frame = compared[0]->frame();
  for (const std::uint8_t byte : frame.color) hash.byte(byte);
  for (const std::uint32_t code : frame.depth) hash.number(std::uint64_t{code});
  hash.number(out.counters.fragments);
  out.digest = hash.hex().substr(16);
  out.trivial = trivial_of(suite, out);
  return out;
}

SuiteRun run_named_suite(const std::string& name, std::uint64_t seed, const SuiteEngines& engines) {
  SuiteRun out;
  for (int attempt = 0; attempt < suite_attempts; ++attempt) {
    out.suite = make_suite(name, seed, attempt);
    try {
      out.result = run_suite(out.suite, engines);
    } catch (const InputError& error) {
      out.result = {};
      out.result.trivial = fmt::format("the scene is refused: {}", error.what());
      continue;
    }
    if (!out.result.agree() || out.result.trivial.empty()) break;
  }
  return out;
}

}  // namespace bitspan
