// SPDX-License-Identifier: Apache-2.0
// The column `affects` of the table of keys (config/key_table.cpp) is true: a key changes what it names, and
// nothing that it does not name.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "config/check.hpp"
#include "config/keys.hpp"
#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/random.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Scene small_scene(bool mip_chains = false) {
  RandomOptions options;
  options.width = 40;
  options.height = 30;
  options.triangles = 14;
  options.size_max = 30;
  options.depth_ratio_max = 50;
  options.uv_limit = 60;
  options.fog_probability = 1;
  options.mip_chains = mip_chains;
  Scene scene = random_scene(4, options);
  for (Triangle& t : scene.triangles) t.texture = 0;
  // Edges through pixel centres, of which the fill rule decides.
  scene.triangles[0].v[0].x = scene.triangles[0].v[1].x = 4.5;
  scene.triangles[0].v[0].y = scene.triangles[0].v[2].y = 3.5;
  scene.triangles[0].v[1].y = scene.triangles[0].v[2].x = 20.5;
  for (Vertex& v : scene.triangles[1].v) v.x -= 12;  // edges left of the picture
  scene.triangles[3].v[0].s = scene.s_min;
  scene.triangles[3].v[1].s = scene.s_max;
  for (std::size_t i = 0; i < scene.triangles.size(); i += 2) scene.triangles[i].v[1].c[3] = 0.05;
  // A depth and coordinates of their own, for configurations that take them.
  for (std::size_t i = 0; i < scene.triangles.size(); i += 3) {
    for (Vertex& v : scene.triangles[i].v) v.z = std::fmod(0.37 * (v.x + v.y + 40), 1);
  }
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) {
      v.u2 = -v.v;
      v.v2 = 2 * v.u;
    }
  }
  for (std::size_t i = 0; i < scene.textures[0].rgba.size(); i += 12) {  // holes, where they are configured
    scene.textures[0].rgba[i] = scene.textures[0].rgba[i + 2] = 255;
    scene.textures[0].rgba[i + 1] = 0;
  }
  return scene;
}

// Triangles that cover no pixel centre: no stage is slower than setup.
Scene specks() {
  Scene scene = small_scene();
  for (Triangle& t : scene.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      t.v[k].x = 7.625 + (k == 1 ? 0.25 : 0);
      t.v[k].y = 9.625 + (k == 2 ? 0.25 : 0);
    }
  }
  return scene;
}

// What the columns speak of, as text or numbers that compare.
struct Outcome {
  Frame frame;
  Trace trace;
  std::uint64_t cycles = 0;
};
bool same_frame(const Frame& a, const Frame& b) {
  const auto same = [](const std::vector<double>& x, const std::vector<double>& y) {
    return std::ranges::equal(x, y, [](double p, double q) { return p == q || (p != p && q != q); });
  };
  return a.color == b.color && a.depth == b.depth && a.triangle == b.triangle && same(a.u, b.u) &&
         same(a.v, b.v);
}
bool same_trace(const Trace& a, const Trace& b) {
#define BITSPAN_SAME(Record, LIST, stage, member) a.member == b.member&&
  return BITSPAN_RECORDS(BITSPAN_SAME) true;
#undef BITSPAN_SAME
}

// none: the scene's range does not fit.
std::optional<Outcome> outcome(Engine& engine, const Scene& scene, bool records) {
  Outcome out;
  try {
    engine.begin(scene);
    engine.draw(scene.triangles, 0, records ? &out.trace : nullptr);
  } catch (const InputError&) {
    return std::nullopt;
  }
  out.frame = engine.frame();
  out.cycles = engine.counters().cycles;
  return out;
}
// A scene that is refused shows nothing.
bool differ(const std::optional<Outcome>& a, const std::optional<Outcome>& b) {
  return a && b &&
         !(same_frame(a->frame, b->frame) && same_trace(a->trace, b->trace) && a->cycles == b->cycles);
}

using Measure = std::function<std::optional<Outcome>(const Config&)>;

// Textures that a chain wants, where there are chains.
const Scene& scene_for(const Config& c) {
  static const Scene plain = small_scene();
  static const Scene chains = small_scene(true);
  return has_lod(c) ? chains : plain;
}

std::optional<Outcome> ideal_of(const Config& c) { return outcome(*make_ideal(c), scene_for(c), true); }
std::optional<Outcome> values_of(const Config& c) {
  return outcome(*make_model(c, {.form = ModelForm::scalar}), scene_for(c), true);
}
// The clocks alone, of two scenes.
std::optional<Outcome> clocks_of(const Config& c) {
  static const Scene none_covered = specks();
  Outcome out;
  for (const Scene* scene : {&scene_for(c), has_lod(c) ? &scene_for(c) : &none_covered}) {
    const auto found = outcome(*make_systemc(c, {.mode = TimedMode::span}), *scene, false);
    if (!found) return std::nullopt;
    out.cycles = (out.cycles << 32) + found->cycles;
  }
  return out;
}

// Values of a key beside the one that it has, legal with all others.
std::vector<Config> changed(const Config& base, const Key& key) {
  std::vector<Config> out;
  const auto add = [&](const KeyValue& value) {
    Config c = base;
    if (set_value(c, key, value)) return;
    if (!first_violation(c) && !same_value(c, base, key)) out.push_back(c);
  };
  const Place at = place(base, key);
  if (const auto* truth = std::get_if<bool*>(&at)) {
    add(!**truth);
  } else if (const auto* choice = std::get_if<Choice>(&at)) {
    for (const std::string_view name : choice->names) add(std::string(name));
  } else if (std::holds_alternative<StartOffset*>(at)) {
    for (const double value : {0.0, 0.25, 2.0, -0.125}) add(value);
    add(std::string("half_ulp"));
  } else if (std::holds_alternative<Color*>(at)) {
    add(std::string("none"));
    add(std::string("[255, 0, 255]"));
  } else if (std::holds_alternative<Rgba*>(at)) {
    add(std::string("[255, 90, 10, 200]"));
  } else {
    const int value = **std::get_if<int*>(&at);
    for (const int v : {value - 8, value - 4, value - 1, value + 1, value / 2, value * 2, 1, 2, 4, 300}) {
      add(std::int64_t{v});
    }
  }
  return out;
}

// Configurations in which, between them, every key is used.
std::vector<Config> bases() {
  std::vector<Config> out;
  const Config narrow = shipped_config("narrow");
  for (std::size_t k = 0; k < enum_names<ReciprocalKind>.size(); ++k) {
    const auto kind = static_cast<ReciprocalKind>(k);
    for (const auto& [perspective, code, fog, walk] :
         {std::tuple(Perspective::delta_f, DepthCode::inverse, FogMode::table, EdgeWalk::dda),
          {Perspective::const_depth_rows, DepthCode::linear, FogMode::linear, EdgeWalk::exact},
          {Perspective::hyperbolic, DepthCode::opengl, FogMode::table, EdgeWalk::exact},
          {Perspective::delta_f, DepthCode::inverse, FogMode::linear, EdgeWalk::exact},
          {Perspective::affine, DepthCode::inverse, FogMode::none, EdgeWalk::dda}}) {
      Config c = narrow;
      c.perspective = perspective;
      c.depth_code = code;
      c.fog = fog;
      c.edge_walk = walk;
      c.dda_update = DdaUpdate::accumulate;
      c.filter = TextureFilter::bilinear;
      c.edge_slope = SlopeForm::reciprocal;
      c.row_slope = RowSlope::reciprocal;
      c.coordinate_bits = 12;  // fewer than edge.x_acc has
      if (kind == ReciprocalKind::lut_linear) c.row_slope = RowSlope::divide;
      for (Reciprocal* unit : {&c.edge_reciprocal, &c.row_reciprocal, &c.pixel_reciprocal}) {
        unit->kind = kind;
        unit->operand_bits = 12;
        unit->index_bits = 3;
        unit->table_bits = 10;
        unit->internal_bits = 14;
        unit->steps = 1;
        unit->bits_per_cycle = 2;
      }
      for (Format& f : c.formats) f.overflow_expected = true;
      EXPECT_FALSE(first_violation(c).has_value()) << first_violation(c)->key << first_violation(c)->text;
      out.push_back(c);
    }
  }
  // Levels of textures, at the end: what the others show stays theirs.
  for (const LodMode lod :
       {LodMode::none, LodMode::zone_s, LodMode::gradient, LodMode::zone_d, LodMode::finite}) {
    Config c = out.front();
    c.mip = MipMode::linear;
    c.lod = lod;
    c.lod_first = 9000;
    EXPECT_FALSE(first_violation(c).has_value()) << first_violation(c)->key << first_violation(c)->text;
    out.push_back(c);
  }
  // Fog by distance.
  for (const FogMode fog : {FogMode::distance, FogMode::log}) {
    Config c = out.front();
    c.fog = fog;
    EXPECT_FALSE(first_violation(c).has_value()) << first_violation(c)->key << first_violation(c)->text;
    out.push_back(c);
  }
  // Fog between the vertices: along edges, and on the triangle's plane.
  for (const std::size_t base : {0, 1}) {
    Config c = out[base];
    c.fog = FogMode::vertex;
    EXPECT_FALSE(first_violation(c).has_value()) << first_violation(c)->key << first_violation(c)->text;
    out.push_back(c);
  }
  // Lines of their own.
  for (const std::size_t base : {0, 2}) {
    Config c = out[base];
    c.shade_lines = ShadeLines::perspective;
    c.depth_line = DepthLine::z;
    c.second_coordinates = SecondCoordinates::own;
    if (base == 2) c.row_slope = RowSlope::plane;  // which has gradients
    EXPECT_FALSE(first_violation(c).has_value()) << first_violation(c)->key << first_violation(c)->text;
    out.push_back(c);
  }
  // Caches that hold part of the buffers, in front of a memory so slow that every miss shows.
  Config c = out.front();
  c.memory.width_bytes = 1;
  c.memory.depth_cache = {BufferCacheMode::write_back, 16, 64, 1, SetHash::none};
  c.memory.color_cache = {BufferCacheMode::write_back, 16, 128, 1, SetHash::none};
  EXPECT_FALSE(first_violation(c).has_value()) << first_violation(c)->key << first_violation(c)->text;
  out.push_back(c);
  return out;
}

// Settings with which a key has an effect that it has not in bases(), nor in a register of fewer bits.
struct Setting {
  std::string_view path;
  KeyValue value;
};
struct Directed {
  std::string_view key;
  std::vector<Setting> settings;
};
const std::vector<Directed>& directed() {
  const auto integer = [](std::int64_t v) { return KeyValue(v); };
  static const std::vector<Directed> all{
      // An accumulator that drops bits of the step in each row.
      {"raster.dda_update", {{"formats.edge.x_acc.word", integer(20)}}},
      // 1 / (h + B) beyond 2^-14.
      {"reciprocal.pixel.output.overflow",
       {{"reciprocal.pixel.normalize", false},
        {"reciprocal.pixel.output.word", integer(8)},
        {"reciprocal.pixel.output.int", integer(-14)}}},
      // A code without most of its offset.
      {"depth.overflow", {{"formats.depth.c0.word", integer(6)}, {"formats.depth.c0.int", integer(2)}}},
      // Texels outside.
      {"texture.border", {{"texture.wrap", std::string("border")}}},
      // Colours from 128 on become negative.
      {"formats.merge.color.overflow",
       {{"formats.fog.color.signed", true}, {"formats.fog.color.overflow", std::string("SC_WRAP")}}},
      // Rows that wait for setup in turns; rows that come slower than short spans are drawn.
      {"timing.edge_walk.fifo",
       {{"timing.setup.interval", integer(12)},
        {"memory.width_bytes", integer(64)},
        {"rtl.setup_multipliers", integer(16)},
        {"reciprocal.row.pipelined", true}}},
      {"timing.span_setup.fifo", {{"timing.edge_walk.interval", integer(9)}}},
      {"timing.setup.fifo",
       {{"timing.setup.interval", integer(1)}, {"timing.edge_walk.interval", integer(1)}}},
      // Fragments that come as fast as merge takes them.
      {"timing.merge.fifo", {{"memory.width_bytes", integer(64)}}},
      // What was left of the picture is far to its right.
      {"formats.edge.x_acc.signed", {{"formats.edge.x_acc.overflow", std::string("SC_WRAP")}}},
      {"formats.edge.x.signed", {{"formats.edge.x.overflow", std::string("SC_WRAP")}}},
  };
  return all;
}

// The base; and the base with the settings for the key, and where it is a field of a register, with this
// register narrower at its high or at its low end.
std::vector<Config> with_effect(const Config& base, const Key& key) {
  std::vector<Config> out{base};
  const auto add = [&](const Config& c) {
    if (!first_violation(c)) out.push_back(c);
  };
  for (const Directed& d : directed()) {
    if (d.key != key.path) continue;
    Config c = base;
    for (const Setting& s : d.settings) {
      EXPECT_FALSE(set_value(c, *find_key(s.path), s.value).has_value()) << s.path;
    }
    add(c);
  }
  if (key.field == nullptr) return out;
  Key whole = key;
  whole.field = nullptr;
  const auto narrower = [&](int high, int low) {
    Config c = base;
    Format& f = *std::get<Format*>(place(c, whole));
    f.word -= high + low;
    f.integer -= high;
    if (low > 0) f.rounding = Rounding::rnd;  // up to what the register does not hold
    const std::string unit = key.path.substr(0, key.path.find(".output"));
    if (const Key* normalize = find_key(unit + ".normalize")) *std::get<bool*>(place(c, *normalize)) = false;
    add(c);
  };
  for (const int bits : {12, 8, 16, 4, 20, 24, 28, 2}) narrower(bits, 0);
  for (const int bits : {3, 6, 12, 20}) narrower(0, bits);
  return out;
}

bool affects_it(const Key& key, unsigned what) { return (affected(key) & what) != 0; }

// A key whose effect on a column nobody can see, and why.
struct Unseen {
  std::string_view key, why;
};

// Every key that `asked` names against one column.
void expect_column(unsigned what, const Measure& measure, const std::vector<Unseen>& unseen,
                   const std::function<bool(const Key&)>& asked) {
  const std::vector<Config> all = bases();
  std::vector<std::optional<Outcome>> of_bases;
  for (const Config& base : all) of_bases.push_back(measure(base));
  int seen = 0;
  for (const Key& key : keys()) {
    if (!asked(key)) continue;
    bool visible = false;
    bool tried = false;  // some rules leave a key one value
    const bool says_so = affects_it(key, what) &&
                         std::ranges::any_of(all, [&key](const Config& c) { return is_used(c, key); });
    for (std::size_t i = 0; i < all.size() && !visible; ++i) {
      const std::vector<Config> tries = says_so ? with_effect(all[i], key) : std::vector{all[i]};
      for (const Config& base : tries) {
        const auto before = &base == tries.data() ? of_bases[i] : measure(base);
        for (const Config& c : changed(base, key)) {
          tried = true;
          visible = visible || differ(measure(c), before);
        }
        if (visible) break;
      }
    }
    const auto cannot = std::ranges::find(unseen, key.path, &Unseen::key);
    EXPECT_EQ(visible, says_so && tried && cannot == unseen.end())
        << key.path << (cannot == unseen.end() ? "" : ": ") << (cannot == unseen.end() ? "" : cannot->why);
    seen += visible ? 1 : 0;
  }
  EXPECT_GT(seen, is_gate_run() ? 1 : 5);
}
bool every_key(const Key& /*key*/) { return true; }
std::size_t index_of(const Key& key) { return static_cast<std::size_t>(&key - keys().data()); }
constexpr std::size_t parts_of_values = 8;  // as all of them take minutes
// The gate tries an eighth of the keys.
bool is_tried(const Key& key) { return in_gate(index_of(key) / parts_of_values, 8); }

TEST(KeyEffects, Ideal) {
  expect_column(affects::ideal, ideal_of,
                {{"texture.second", "no scene here has a second texture; OwnLines of stages_test does"},
                 {"light.at", "no scene here has a light; Light of stages_test does"}},
                every_key);
}

TEST(KeyEffects, Rtl) {
  std::vector<Config> all = bases();
  std::erase_if(all, [](const Config& c) { return !has_rtl(c); });
  all.push_back(all.front());
  all.back().rtl.shades = true;  // without them the RTL has no start of theirs
  all.push_back(shipped_config("depth16"));
  all.back().project = ProjectUnit::reciprocal;
  for (const LightAt at : {LightAt::pixel, LightAt::vertex}) {
    all.push_back(shipped_config("depth16"));
    all.back().light = at;
    if (lights_pixels(at)) all.back().light_normal = LightNormal::map;
  }
  const auto package = [](const Config& c) -> std::string {
    if (!has_rtl(c)) return "";
    try {
      const std::string text = emit_sv(c);
      return text.substr(text.find('\n'));  // the first line has the hash
    } catch (const InputError& error) {
      return error.what();
    }
  };
  int seen = 0;
  for (const Key& key : keys()) {
    if (!is_tried(key)) continue;
    bool visible = false;
    bool tried = false;
    for (const Config& base : all) {
      for (const Config& c : changed(base, key)) {
        tried = true;
        visible = visible || package(c) != package(base);
      }
      if (visible) break;
    }
    const bool only_its_int = key.path.starts_with("formats.edge.x_acc.") && key.name() != "int";
    EXPECT_EQ(visible, affects_it(key, affects::rtl) && tried && !only_its_int) << key.path;
    seen += visible ? 1 : 0;
  }
  EXPECT_GT(seen, is_gate_run() ? 10 : 60);
}

// No scene here has lines, a projector, a light or a curve: tests/stages/line_walk_test.cpp,
// project_test.cpp, light_test.cpp, forward_difference_test.cpp, rotate_test.cpp and golden_project_test.cpp
// move these registers.
bool needs_more(const Key& key) {
  return key.path == "line.walk" || key.path == "project.unit" || key.path.starts_with("formats.project.") ||
         key.path.starts_with("light.") || key.path.starts_with("formats.light.") ||
         key.path.starts_with("formats.normal.") || key.path.starts_with("formats.relief.") ||
         key.path.starts_with("formats.curve.") || key.path.starts_with("formats.rotate.");
}

class KeyEffectsOnValues : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(KeyEffects, KeyEffectsOnValues, testing::Range(std::size_t{0}, parts_of_values));

TEST_P(KeyEffectsOnValues, AreWhatTheTableSays) {
  expect_column(
      affects::values, values_of,
      {{"formats.distance.g.overflow",
        "no picture here is so wide, and check.cpp wants a format that holds 1"},
       {"formats.plane.k.overflow", "its values are -1..1, and check.cpp wants a format that holds them"},
       {"formats.texture.alpha.overflow",
        "its values are 0..1, and check.cpp wants a format that holds them"}},
      [](const Key& key) {
        return index_of(key) % parts_of_values == GetParam() && is_tried(key) && !needs_more(key);
      });
}

// A key of values moves pixels, and so clocks: those of the other keys must stay.
TEST(KeyEffects, Clocks) {
  constexpr const char* wider = "other lines of a row are wider here, and take as long";
  expect_column(affects::clocks, clocks_of,
                {{"formats.span.shade_acc.word", "no product and no quotient takes longer with it"},
                 {"formats.fog.factor.word", wider},
                 {"formats.fog.factor.int", wider},
                 {"formats.fog.step.signed", wider},
                 {"formats.fog.step.word", wider},
                 {"formats.fog.step.int", wider},
                 {"formats.fog.acc.signed", wider},
                 {"formats.fog.acc.word", wider},
                 {"formats.fog.acc.int", wider},
                 {"formats.shade.step.signed", wider},
                 {"formats.shade.step.word", wider},
                 {"formats.shade.step.int", wider}},
                [](const Key& key) {
                  return is_tried(key) && !needs_more(key) &&
                         (affects_it(key, affects::clocks) || !affects_it(key, affects::values));
                });
}

}  // namespace
}  // namespace bitspan
