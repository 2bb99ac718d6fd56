// SPDX-License-Identifier: Apache-2.0
// What a default run of `bitspan fuzz` reaches: every key, enumerator, register of the draw state, command
// and kind of texture. The tables say what there is, so that one more is missed here until it is drawn.
#include "report/fuzz_cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "config/keys.hpp"
#include "config/modes.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "engine/emit_sv.hpp"
#include "engine/range.hpp"
#include "golden/precision.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// By what there is: a key, a register, a command. Values of it.
using Values = std::map<std::string, std::set<std::string>>;

// Of a range of numbers so many must come, or all of them.
constexpr std::size_t numbers_to_reach = 4;

std::string text(std::string_view name) { return std::string(name); }

// ---------------------------------------------------------------- what there is

// The numbers of a range: each of a few, else enough of them.
void add_numbers(Values& out, const std::string& name, std::int64_t lowest, std::int64_t highest,
                 bool powers_of_two = false) {
  std::set<std::string> all;
  for (std::int64_t v = lowest; v <= highest && all.size() <= numbers_to_reach;
       v = powers_of_two ? 2 * v : v + 1) {
    all.insert(std::to_string(v));
  }
  if (all.size() > numbers_to_reach) all = {};
  out[name] = all;
}

// Values that no legal configuration has, and the rule (config/check.cpp).
bool is_impossible(const Key& key, const std::string& value) {
  if (key.path == "reciprocal.pixel.pipelined")
    return value == "false";                                       // the span takes one pixel per clock
  if (key.path == "depth.overflow") return value == "SC_WRAP_SM";  // the code is unsigned
  return false;
}

Values all_of_keys() {
  Values out;
  const Config any;
  for (const Key& key : keys()) {
    // Whether a clock counts hangs on its stage alone.
    if (key.path.starts_with("timing.") && !is_used(any, key)) continue;
    std::set<std::string>& to = out[key.path];
    const Place at = place(any, key);
    if (std::holds_alternative<bool*>(at)) to = {"true", "false"};
    if (std::holds_alternative<StartOffset*>(at)) to = {"half_ulp", "0", "a number"};
    if (std::holds_alternative<Color*>(at)) to = {"none", "a colour"};
    if (std::holds_alternative<Rgba*>(at)) to = {"a colour"};
    if (const auto* choice = std::get_if<Choice>(&at)) {
      for (const std::string_view name : choice->names) to.emplace(name);
    }
    if (std::holds_alternative<int*>(at) && key.field == nullptr) {
      const Limits& limits = key.row->limits;
      add_numbers(out, key.path, limits.lowest, limits.highest, limits.power_of_two);
    }
    std::erase_if(to, [&](const std::string& value) { return is_impossible(key, value); });
  }
  return out;
}

Values all_of_registers() {
  Values out;
  for (const StateRegister& r : state_registers()) {
    std::set<std::string>& to = out[text(r.key)];
    for (const std::string_view name : r.names) to.emplace(name);
    if (r.names.empty()) add_numbers(out, text(r.key), r.low, r.high);
  }
  return out;
}

// Of texels, sizes by their sides, and commands.
Values all_of_scenes() {
  Values out;
  for (const std::string_view name : enum_names<TexelFormat>) out["texel format"].emplace(name);
  for (const char* width : {"1", "2^n", "other"}) {
    for (const char* height : {"1", "2^n", "other"}) out["texture size"].insert(text(width) + " x " + height);
  }
  out["triangle"] = {"textured", "plain", "on the pixels of the one in front"};
  out["fog"] = {"true", "false"};
  return out;
}

// ---------------------------------------------------------------- what comes

std::string value_reached(const Config& c, const Key& key) {
  const Place at = place(c, key);
  std::string value = to_string(value_of(c, key));
  if (std::holds_alternative<StartOffset*>(at) && value != "half_ulp" && value != "0") return "a number";
  if (std::holds_alternative<Color*>(at) && value != "none") return "a colour";
  if (std::holds_alternative<Rgba*>(at)) return "a colour";
  return value;
}

std::string side(int texels) {
  return texels == 1 ? "1" : std::has_single_bit(static_cast<unsigned>(texels)) ? "2^n" : "other";
}

bool on_the_same_pixels(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < a.v.size(); ++i) {
    if (a.v[i].x != b.v[i].x || a.v[i].y != b.v[i].y) return false;
  }
  return true;
}

struct Reached {
  std::uint64_t cases = 0, refused = 0;
  Values keys, registers, scenes;
  std::set<std::size_t> commands;  // as indices of DrawCommand::what
  // Where the pixel stages in RTL draw.
  Values rtl_keys, rtl_registers;
  std::set<std::string> rtl_textures;  // as filter, wrap, whether sides are powers of two
};

void add_keys(const Config& config, Values& to) {
  for (const Key& key : keys()) {
    if (is_used(config, key)) to[key.path].insert(value_reached(config, key));
  }
}

// The registers as triangles find them.
void add_registers(const Config& config, const Scene& scene, bool with_rtl, Reached& to) {
  std::size_t begun = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    std::size_t end = begun;
    while (end < scene.commands.size() && scene.commands[end].before <= i) ++end;
    if (end == begun && i > 0) continue;
    begun = end;
    const DrawState state = all_states_of(config, std::span(scene.commands).first(end)).back();
    const std::vector<std::int64_t> values = state_values(state);
    for (std::size_t r = 0; r < values.size(); ++r) {
      const StateRegister& reg = state_registers()[r];
      const std::string value = reg.names.empty() ? std::to_string(values[r])
                                                  : text(reg.names[static_cast<std::size_t>(values[r])]);
      to.registers[text(reg.key)].insert(value);
      if (with_rtl && pixel_rtl_takes(config, state)) to.rtl_registers[text(reg.key)].insert(value);
    }
  }
}

void add_scene(const Config& config, const Scene& scene, bool with_rtl, Reached& to) {
  to.scenes["fog"].insert(scene.fog ? "true" : "false");
  for (const Texture& t : scene.textures) {
    to.scenes["texel format"].insert(text(to_string(t.format)));
    to.scenes["texture size"].insert(side(t.width) + " x " + side(t.height));
  }
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& t = scene.triangles[i];
    to.scenes["triangle"].insert(t.texture < 0 ? "plain" : "textured");
    if (i > 0 && on_the_same_pixels(t, scene.triangles[i - 1]))
      to.scenes["triangle"].insert("on the pixels of the one in front");
    if (!with_rtl || t.texture < 0) continue;
    const Texture& image = scene.textures[static_cast<std::size_t>(t.texture)];
    const bool powers = side(image.width) != "other" && side(image.height) != "other";
    to.rtl_textures.insert(text(to_string(config.filter)) + " " + text(to_string(config.wrap)) + " " +
                           (powers ? "2^n" : "other"));
  }
  for (const DrawCommand& command : scene.commands) {
    to.commands.insert(command.what.index());
    const auto* const copy = std::get_if<Copy>(&command.what);
    if (copy != nullptr && copy->plane == CopyPlane::depth)
      to.scenes["texel format"].insert(text(to_string(TexelFormat::depth)));
  }
  add_registers(config, scene, with_rtl, to);
}

// A default run, up to what the engines would draw.
Reached reached_by(const FuzzPlan& plan) {
  const std::vector<Config> bases = shipped_configs();
  Reached out;
  Config config;
  std::optional<std::uint64_t> group;
  for (std::uint64_t index = 0; index < plan.cases; ++index) {
    if (group != index / plan.streams_per_config) {
      group = index / plan.streams_per_config;
      config = fuzz_config(plan, *group, bases,
                           [](const Config& c) { static_cast<void>(golden::choose_precision(c)); });
    }
    const bool with_rtl = fuzz_takes_designs(plan, *group);
    bool taken = false;
    for (int draw = 0; draw < fuzz_draws && !taken; ++draw) {
      const Scene scene = fuzz_scene(plan, index, draw, config);
      try {
        check_scene_range(config, scene);
        check_commands(config, scene);
      } catch (const InputError&) {
        continue;
      }
      taken = true;
      add_keys(config, out.keys);
      if (with_rtl) add_keys(config, out.rtl_keys);
      add_scene(config, scene, with_rtl, out);
    }
    ++(taken ? out.cases : out.refused);
  }
  return out;
}

const Reached& of_default_run() {
  static const Reached reached = reached_by({});
  return reached;
}

// What is missing: a line per value, and one per range of which too few numbers came.
std::vector<std::string> missing(const Values& all, const Values& reached) {
  std::vector<std::string> out;
  for (const auto& [name, values] : all) {
    const auto found = reached.find(name);
    const std::set<std::string> none;
    const std::set<std::string>& come = found == reached.end() ? none : found->second;
    for (const std::string& value : values) {
      if (!come.contains(value)) out.push_back(name + " = " + value);
    }
    if (values.empty() && come.size() < numbers_to_reach)
      out.push_back(name + ": " + std::to_string(come.size()) + " values");
  }
  return out;
}

std::string lines(const std::vector<std::string>& all) {
  std::string out;
  for (const std::string& line : all) out += "\n  " + line;
  return out;
}

std::size_t count(const Values& all) {
  std::size_t out = 0;
  for (const auto& [name, values] : all) out += values.empty() ? numbers_to_reach : values.size();
  return out;
}

// ---------------------------------------------------------------- the tests

// Of the registers' fields, rounding and overflow of each; the widths of each change, and few of them vary in
// range or sign.
TEST(FuzzCases, ADefaultRunReachesEveryKey) {
  const Reached& reached = of_default_run();
  Values all = all_of_keys();
  for (const Key& key : keys()) {
    if (key.field == nullptr) continue;
    std::set<std::string>& values = all.at(key.path);
    const std::string_view field = key.field->name;
    const Key* sign = find_key(key.path.substr(0, key.path.size() - field.size()) + "signed");
    const bool is_signed = std::ranges::any_of(
        shipped_configs(), [&](const Config& c) { return value_of(c, *sign) == KeyValue(true); });
    if (field == "overflow" && !is_signed) values.erase("SC_WRAP_SM");
    if (field == "signed" || field == "word" || field == "int" || field == "overflow_expected" ||
        (key.path.starts_with("formats.merge.color") && field == "overflow")) {
      all.erase(key.path);
    }
  }
  EXPECT_EQ(lines(missing(all, reached.keys)), "");
  EXPECT_GT(count(all), 700U);
  EXPECT_GT(reached.cases, 15 * reached.refused);
  std::printf("%zu values of %zu keys\n", count(all), all.size());
}

TEST(FuzzCases, ADefaultRunReachesEveryRegisterOfTheDrawState) {
  Values all = all_of_registers();
  // Indices of a scene with three textures at most, and none.
  all["texture1"] = {"-1", "0", "1", "2"};
  EXPECT_EQ(lines(missing(all, of_default_run().registers)), "");
  std::printf("%zu values of %zu registers\n", count(all), all.size());
}

TEST(FuzzCases, ADefaultRunReachesEveryCommandAndTexture) {
  const Reached& reached = of_default_run();
  const Values all = all_of_scenes();
  EXPECT_EQ(lines(missing(all, reached.scenes)), "");
  EXPECT_EQ(reached.commands.size(), std::variant_size_v<decltype(DrawCommand::what)>);
  std::printf("%zu kinds of textures and triangles, %zu commands\n", count(all), reached.commands.size());
}

// What the pixel stages in RTL have: the modes that cost a build come by turns, the others by chance.
TEST(FuzzCases, ADefaultRunReachesThePixelStagesInRtl) {
  const Reached& reached = of_default_run();
  Values keys;
  for (const std::string_view name : enum_names<RtlBlend>) keys["rtl.blend"].emplace(name);
  for (const std::string_view name : enum_names<MipMode>) keys["texture.mip"].emplace(name);
  for (const std::string_view name : enum_names<TextureFilter>) keys["texture.filter"].emplace(name);
  keys["texture.transparent"] = {"none", "a colour"};
  for (std::size_t i = 0; i < enum_names<TextureWrap>.size(); ++i) {
    if (is_in_rtl(static_cast<TextureWrap>(i))) keys["texture.wrap"].emplace(enum_names<TextureWrap>[i]);
  }
  EXPECT_EQ(lines(missing(keys, reached.rtl_keys)), "");
  std::set<std::string> modes;
  for (const char* name : {"span.h_step", "span.shade_step", "span.uv"}) {
    for (const char* field : {".round", ".overflow"})
      modes.merge(Values(reached.rtl_keys).at("formats." + text(name) + field));
  }
  EXPECT_EQ(modes.size(), enum_names<Rounding>.size() + enum_names<Overflow>.size());
  for (const char* texture : {"nearest cyclic 2^n", "bilinear cyclic 2^n"})
    EXPECT_TRUE(reached.rtl_textures.contains(texture)) << texture;

  Config equation = shipped_config("depth16");
  equation.rtl.blend = RtlBlend::equation;
  Values registers = all_of_registers();
  for (std::size_t i = 0; i < state_registers().size(); ++i) {
    const StateRegister& r = state_registers()[i];
    // Units that the stages do not have change nothing while they are off.
    const bool is_left_out =
        r.key.starts_with("target.") || r.key.starts_with("chroma.") || r.key.starts_with("texture1");
    if (r.names.empty() || is_left_out) {
      registers.erase(text(r.key));
      continue;
    }
    std::erase_if(registers.at(text(r.key)), [&](const std::string& value) {
      const auto number = std::ranges::find(r.names, value) - r.names.begin();
      StateChange change{.reset = false, .settings = {{i, number}}};
      if (r.key == "stencil.test")
        change.settings.push_back({*find_state_register("depth.when"), static_cast<int>(DepthWhen::late)});
      return !pixel_rtl_takes(equation, changed_state(first_state(equation), change, equation));
    });
  }
  EXPECT_EQ(lines(missing(registers, reached.rtl_registers)), "");
}

// A case is made from the seed and its number alone.
TEST(FuzzCases, TheSameNumberGivesTheSame) {
  const auto bases = shipped_configs();
  for (const FuzzDesigns designs : {FuzzDesigns::none, FuzzDesigns::some, FuzzDesigns::all}) {
    const FuzzPlan plan{.seed = 5, .designs = designs};
    EXPECT_EQ(fuzz_config(plan, 4, bases, {}), fuzz_config(plan, 4, bases, {}));
    EXPECT_NE(config_hash(fuzz_config(plan, 4, bases, {})), config_hash(fuzz_config(plan, 8, bases, {})));
  }
}

// Configurations of one build differ, but not in what the RTL is built from.
TEST(FuzzCases, ConfigurationsShareABuild) {
  const auto bases = shipped_configs();
  const FuzzPlan plan;
  const auto package = [&](std::uint64_t group) {
    const Config config = fuzz_config(plan, group, bases, {});
    const std::string rows = emit_sv(config);
    const std::string pixels = emit_pixel_sv(config);
    return rows.substr(rows.find('\n')) + pixels.substr(pixels.find('\n'));
  };
  EXPECT_EQ(fuzz_build(plan, 0), fuzz_build(plan, 60));
  EXPECT_NE(fuzz_build(plan, 0), fuzz_build(plan, 64));
  EXPECT_EQ(package(0), package(60));
  EXPECT_NE(package(0), package(64));
}

}  // namespace
}  // namespace bitspan
