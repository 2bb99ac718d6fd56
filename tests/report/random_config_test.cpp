// SPDX-License-Identifier: Apache-2.0
// Random configurations are legal, repeatable, and reach every mode.
#include "report/random_config.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "config/check.hpp"
#include "config/keys.hpp"
#include "config/rtl_timing.hpp"
#include "engine/range.hpp"
#include "golden/precision.hpp"
#include "scene/random.hpp"
#include "tests/support/cut.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

RandomConfigOptions options() {
  RandomConfigOptions o;
  o.check = [](const Config& c) { static_cast<void>(golden::choose_precision(c)); };
  return o;
}

TEST(RandomConfig, IsLegalAndReadsBack) {
  const auto from = shipped_configs();
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Config c = random_config(seed, from, options());
    ASSERT_NO_THROW(check_config(c, "random")) << seed;
    ASSERT_EQ(config_hash(parse_config(to_toml(c), "random")), config_hash(c)) << seed;
  }
}

TEST(RandomConfig, TheSameSeedGivesTheSame) {
  const auto from = shipped_configs();
  EXPECT_EQ(random_config(5, from, options()), random_config(5, from, options()));
  EXPECT_NE(config_hash(random_config(5, from, options())), config_hash(random_config(6, from, options())));
}

// Values that no legal configuration has, and the rule that says so (config/check.cpp).
struct Impossible {
  std::string key, value, rule;
};
const std::vector<Impossible>& impossible() {
  static const std::vector<Impossible> all{
      {"reciprocal.pixel.pipelined", "false", "the span takes one pixel per clock"},
      {"depth.overflow", "SC_WRAP_SM", "the code is unsigned"},
  };
  return all;
}

// The values of a key that a long run must draw: every name and integer, or the ends of a wide range.
std::vector<std::string> values_to_draw(const Key& key) {
  const Config any;
  const Place at = place(any, key);
  std::vector<std::string> out;
  if (std::holds_alternative<bool*>(at)) return {"true", "false"};
  if (std::holds_alternative<StartOffset*>(at)) return {"half_ulp", "0", "a number"};
  if (std::holds_alternative<Color*>(at)) return {"none", "a colour"};
  if (std::holds_alternative<Rgba*>(at)) return {"[0, 0, 0, 0]", "a colour"};
  if (const auto* choice = std::get_if<Choice>(&at)) {
    for (const std::string_view name : choice->names) out.emplace_back(name);
    return out;
  }
  const Limits& limits = key.row->limits;
  for (int v = limits.lowest; v <= limits.highest; v = limits.power_of_two ? 2 * v : v + 1) {
    const bool narrow = limits.power_of_two || limits.highest - limits.lowest <= 32;
    if (narrow || v == limits.lowest || v == limits.highest) out.push_back(std::to_string(v));
  }
  return out;
}

// A value as values_to_draw has it.
std::string drawn_value(const Config& c, const Key& key) {
  const Place at = place(c, key);
  const std::string value = to_string(value_of(c, key));
  if (std::holds_alternative<StartOffset*>(at))
    return value == "half_ulp" || value == "0" ? value : "a number";
  if (std::holds_alternative<Color*>(at)) return value == "none" ? value : "a colour";
  if (std::holds_alternative<Rgba*>(at)) return value == "[0, 0, 0, 0]" ? value : "a colour";
  return value;
}

// Every value of every key. A format's fields are asked for once for all registers, once for all units.
TEST(RandomConfig, ALongRunDrawsEveryValue) {
  const auto from = shipped_configs();
  RandomConfigOptions o;
  o.least_coordinate_bits = 2;
  const auto name_of = [](const Key& key) {
    return key.field == nullptr ? key.path : std::string(key.row->path) + "." + std::string(key.field->name);
  };
  std::map<std::string, std::set<std::string>> drawn;
  for (std::uint64_t seed = 0; seed < 8000; ++seed) {
    const Config c = random_config(seed, from, o);
    for (const Key& key : keys()) {
      // A key that may be left out is drawn whether another one uses it or not.
      if (is_used(c, key) || key.row->use.unused == Unused::value || key.presence() == Presence::later)
        drawn[name_of(key)].insert(drawn_value(c, key));
    }
  }
  std::map<std::string, std::vector<std::string>> expected;
  for (const Key& key : keys()) {
    if (key.field == nullptr) expected[key.path] = values_to_draw(key);
  }
  expected["formats.FORMAT.signed"] = {"true", "false"};
  expected["formats.FORMAT.word"] = {"1", "63", "64"};
  expected["formats.FORMAT.int"] = {"-32", "64"};
  for (const char* row : {"formats.FORMAT", "reciprocal.UNIT.output"}) {
    const std::string field(row);
    for (const std::string_view name : enum_names<Rounding>) expected[field + ".round"].emplace_back(name);
    for (const std::string_view name : enum_names<Overflow>) expected[field + ".overflow"].emplace_back(name);
  }
  std::erase(expected["reciprocal.UNIT.output.overflow"], "SC_WRAP_SM");  // the output is unsigned
  for (const Impossible& x : impossible()) {
    EXPECT_EQ(drawn[x.key].count(x.value), 0U) << x.key << " = " << x.value << " is drawn: " << x.rule;
    EXPECT_EQ(std::erase(expected[x.key], x.value), 1U) << x.key;
  }
  int values = 0;
  for (const auto& [key, all] : expected) {
    for (const std::string& value : all) {
      EXPECT_TRUE(drawn[key].contains(value)) << key << " = " << value << " is never drawn";
      ++values;
    }
  }
  EXPECT_GT(values, 350);
}

TEST(RandomConfig, RtlOnlyMeansThatTheRtlHasIt) {
  const auto from = shipped_configs();
  RandomConfigOptions o = options();
  o.rtl_only = true;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Config c = random_config(seed, from, o);
    ASSERT_TRUE(has_rtl(c));
    ASSERT_NO_THROW(static_cast<void>(rtl_timing(c)));
  }
}

// The bounds around all triangles may be in doubt where the triangles hold, never the other way round. One
// register at a time is made so narrow that it holds the scene just so, or just not.
TEST(RandomConfig, BoundsOfASceneJudgeAsItsTrianglesDo) {
  const std::vector<Config> bases = shipped_configs();
  std::mt19937_64 random(7);
  constexpr int configs = 60;
  int held = 0, refused = 0;
  for (int i = 0; i < configs; ++i) {
    Config config = random_config(random(), bases, options());
    RandomOptions few;
    few.triangles = 1 + static_cast<int>(random() % 6);
    const Scene scene = random_scene(random(), few);
    for (Format& f : config.formats) f.overflow_expected = random() % 4 == 0;
    for (Format& format : config.formats) {
      const Format before = format;
      while (format.word > 1 && format.integer > 1 - format.fraction()) {
        const std::string by_triangles =
            error_of([&] { check_scene_range(config, scene, RangeBy::triangles); });
        EXPECT_EQ(error_of([&] { check_scene_range(config, scene); }), by_triangles);
        ++(by_triangles.empty() ? held : refused);
        if (!by_triangles.empty()) break;
        --format.word;
        --format.integer;
      }
      format = before;
    }
  }
  EXPECT_GT(held, 20 * configs);
  EXPECT_GT(refused, 4 * configs);
}

// A piece in doubt is looked at closely; the verdict is that of the whole, and by triangles so is the text.
TEST(RandomConfig, PiecesOfASceneJudgeAsTheWhole) {
  const std::vector<Config> bases = shipped_configs();
  std::mt19937_64 random(11);
  constexpr int scenes = 150;
  int refused = 0;
  for (int i = 0; i < scenes; ++i) {
    Config config = random_config(random(), bases, options());
    RandomOptions some;
    some.triangles = 12;
    some.command_probability = i % 3 == 0 ? 0.3 : 0;
    Scene scene = random_scene(random(), some);
    if (i % 3 == 1) {
      ViewChange change;
      change.s_max = 2 * scene.s_max;
      scene.commands.push_back({5, change});
    }
    for (Format& f : config.formats) f.overflow_expected = false;
    constexpr std::array narrowed{FormatId::setup_s, FormatId::setup_uv, FormatId::edge_f,
                                  FormatId::edge_x,  FormatId::span_f,   FormatId::setup_shade,
                                  FormatId::edge_h,  FormatId::plane_g,  FormatId::setup_b};
    Format& format = config.format(narrowed[random() % narrowed.size()]);
    const auto in_pieces = [&](RangeBy by) {
      PiecewiseRange range(config, scene, by);
      bool held = true;
      Cut pieces(scene, 4);
      while (const Scene* piece = pieces()) held = range.add(*piece) && held;
      range.finish();
      EXPECT_TRUE(held) << "a doubt that nothing confirms";
    };
    std::string whole;
    while (whole.empty() && format.word > 1 && format.integer > 1 - format.fraction()) {
      whole = error_of([&] { check_scene_range(config, scene, RangeBy::triangles); });
      EXPECT_EQ(error_of([&] { check_scene_range(config, scene); }).empty(), whole.empty());
      EXPECT_EQ(error_of([&] { in_pieces(RangeBy::triangles); }), whole);
      EXPECT_EQ(error_of([&] { in_pieces(RangeBy::bounds); }).empty(), whole.empty());
      --format.word;
      --format.integer;
    }
    refused += whole.empty() ? 0 : 1;
  }
  EXPECT_GT(refused, scenes / 8);
  EXPECT_LT(refused, scenes);
}

}  // namespace
}  // namespace bitspan
