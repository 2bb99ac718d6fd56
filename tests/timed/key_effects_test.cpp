// SPDX-License-Identifier: Apache-2.0
// The column `affects` of the table of keys (config/key_table.cpp) is true: a key changes what it names, and
// nothing that it does not name.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <optional>
#include <set>

#include "config/check.hpp"
#include "config/keys.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Scene small_scene() {
  RandomOptions options;
  options.width = 40;
  options.height = 30;
  options.triangles = 14;
  options.size_max = 30;
  options.depth_ratio_max = 50;
  options.uv_limit = 60;
  options.fog_probability = 1;
  Scene scene = random_scene(4, options);
  for (Triangle& t : scene.triangles) t.texture = 0;
  // Edges through pixel centres, of which the fill rule decides.
  scene.triangles[0].v[0].x = scene.triangles[0].v[1].x = 4.5;
  scene.triangles[0].v[0].y = scene.triangles[0].v[2].y = 3.5;
  scene.triangles[0].v[1].y = scene.triangles[0].v[2].x = 20.5;
  for (std::size_t i = 0; i < scene.textures[0].rgba.size(); i += 12) {  // holes, where they are configured
    scene.textures[0].rgba[i] = scene.textures[0].rgba[i + 2] = 255;
    scene.textures[0].rgba[i + 1] = 0;
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
bool same(const std::optional<Outcome>& a, const std::optional<Outcome>& b) {
  if (!a || !b) return !a && !b;
  return same_frame(a->frame, b->frame) && same_trace(a->trace, b->trace) && a->cycles == b->cycles;
}

using Measure = std::function<std::optional<Outcome>(const Config&)>;

std::optional<Outcome> ideal_of(const Config& c) {
  static const Scene scene = small_scene();
  return outcome(*make_ideal(c), scene, true);
}
std::optional<Outcome> values_of(const Config& c) {
  static const Scene scene = small_scene();
  return outcome(*make_model(c, {.form = ModelForm::scalar}), scene, true);
}
// The clocks alone.
std::optional<Outcome> clocks_of(const Config& c) {
  static const Scene scene = small_scene();
  Outcome out;
  const auto found = outcome(*make_systemc(c, {.mode = TimedMode::span}), scene, false);
  if (!found) return std::nullopt;
  out.cycles = found->cycles;
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
  for (const auto& [perspective, code, fog, walk] :
       {std::tuple(Perspective::delta_f, DepthCode::inverse, FogMode::table, EdgeWalk::dda),
        {Perspective::const_depth_rows, DepthCode::linear, FogMode::linear, EdgeWalk::exact},
        {Perspective::hyperbolic, DepthCode::opengl, FogMode::table, EdgeWalk::exact},
        {Perspective::delta_f, DepthCode::inverse, FogMode::linear, EdgeWalk::exact},
        {Perspective::affine, DepthCode::inverse, FogMode::none, EdgeWalk::dda}}) {
    for (std::size_t k = 0; k < enum_names<ReciprocalKind>.size(); ++k) {
      const auto kind = static_cast<ReciprocalKind>(k);
      Config c = narrow;
      c.perspective = perspective;
      c.depth_code = code;
      c.fog = fog;
      c.edge_walk = walk;
      c.dda_update = DdaUpdate::accumulate;
      c.filter = TextureFilter::bilinear;
      c.edge_slope = c.row_slope = SlopeForm::reciprocal;
      c.coordinate_bits = 12;  // fewer than edge.x_acc has
      if (kind == ReciprocalKind::lut_linear) c.row_slope = SlopeForm::divide;
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
  return out;
}

// The same with registers of fewer bits, so that they overflow and steps are coarse.
std::vector<Config> tight_bases() {
  std::vector<Config> out;
  for (Config c : bases()) {
    for (const int bits : {-6, -4, 2}) {
      Config tight = c;
      for (int i = 0; i < format_count; ++i) {
        const auto id = static_cast<FormatId>(i);
        if (id == FormatId::setup_s || id == FormatId::setup_b) continue;
        const Config before = tight;
        Format& f = tight.format(id);
        f.word -= std::abs(bits);
        f.integer -= std::max(0, -bits);
        if (first_violation(tight)) tight = before;
      }
      out.push_back(tight);
    }
  }
  return out;
}

bool affects_it(const Key& key, unsigned what) { return (affected(key) & what) != 0; }

// Every key against one column. not_seen: keys whose effect is too rare for these scenes.
void expect_column(unsigned what, const std::vector<Config>& all, const Measure& measure,
                   const std::set<std::string>& not_seen) {
  std::vector<std::optional<Outcome>> before;
  for (const Config& base : all) before.push_back(measure(base));
  int seen = 0;
  for (const Key& key : keys()) {
    bool visible = false;
    bool tried = false;  // some rules leave a key one value
    const bool says_so = affects_it(key, what);
    for (std::size_t i = 0; i < all.size() && !visible; ++i) {
      if (!says_so && i % 4 != 0) continue;  // nothing to be found: some will do
      for (const Config& c : changed(all[i], key)) {
        tried = true;
        visible = !same(measure(c), before[i]);
        if (visible) break;
      }
    }
    // What a register does when it overflows shows only where it does.
    const bool rare = (key.field != nullptr && key.name() == "overflow") || not_seen.contains(key.path);
    if (visible || !rare) {
      EXPECT_EQ(visible, says_so && tried) << key.path;
    }
    seen += visible ? 1 : 0;
  }
  EXPECT_GT(seen, 5);
}

TEST(KeyEffects, Ideal) { expect_column(affects::ideal, bases(), ideal_of, {}); }

TEST(KeyEffects, Rtl) {
  std::vector<Config> all = bases();
  std::erase_if(all, [](const Config& c) { return !has_rtl(c); });
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
  EXPECT_GT(seen, 60);
}

TEST(KeyEffects, Values) {
  std::vector<Config> all = bases();
  for (const Config& c : tight_bases()) all.push_back(c);
  expect_column(
      affects::values, all, values_of,
      // One constant per scene, which may be the same; values that never reach the sign or the last bit.
      {"raster.dda_update", "depth.overflow", "formats.setup.s.signed", "formats.setup.b.signed",
       "formats.setup.b.round", "formats.edge.x_acc.signed", "formats.edge.x.signed",
       "formats.depth.c1.signed", "formats.texture.frac.round", "formats.texture.alpha.round",
       "formats.fog.scale.signed", "formats.fog.scale.round"});
}

// A key of values moves pixels, and so clocks: those of the other keys must stay.
TEST(KeyEffects, Clocks) {
  // Widths whose sign or integer bits leave the latencies as they are; FIFOs that never fill in this scene;
  // keys that are not used (docs/configuration.md).
  const std::set<std::string> not_seen{
      "formats.setup.b.signed",    "formats.edge.x_acc.signed",  "formats.edge.x.signed",
      "formats.plane.k.int",       "timing.setup.fifo",          "timing.edge_walk.fifo",
      "timing.span_setup.latency", "timing.span_setup.interval", "timing.span_setup.fifo",
      "timing.span.latency",       "timing.span.interval",       "timing.span.fifo"};
  const std::vector<Config> all = bases();
  std::vector<std::optional<Outcome>> before;
  for (const Config& base : all) before.push_back(clocks_of(base));
  for (const Key& key : keys()) {
    const bool says_so = affects_it(key, affects::clocks);
    if (affects_it(key, affects::values) && !says_so) continue;
    bool visible = false;
    bool tried = false;
    for (std::size_t i = 0; i < all.size() && !visible; ++i) {
      for (const Config& c : changed(all[i], key)) {
        tried = true;
        visible = visible || !same(clocks_of(c), before[i]);
      }
    }
    EXPECT_EQ(visible, says_so && tried && !not_seen.contains(key.path)) << key.path;
  }
}

}  // namespace
}  // namespace bitspan
