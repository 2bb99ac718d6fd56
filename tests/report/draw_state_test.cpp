// SPDX-License-Identifier: Apache-2.0
// Draw state in all engines: random streams with changes of state, and what each register does.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "golden/merge.hpp"
#include "golden/stencil.hpp"
#include "model/engine_model.hpp"
#include "model/engine_override.hpp"
#include "model/stages/merge.hpp"
#include "model/stages/stencil.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/lockstep.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using Engines = std::vector<std::unique_ptr<Engine>>;

Scene stream(std::uint64_t seed, bool late_tests) {
  RandomOptions options;
  options.width = 61;
  options.height = 47;
  options.triangles = 40;
  options.size_max = 60;
  options.depth_ratio_max = 8;
  options.uv_limit = 64;
  options.command_probability = 0.4;
  options.late_tests = late_tests;
  return random_scene(seed, options);
}

Engines engines_of(const Config& config, bool late_tests) {
  Engines out;
  out.push_back(make_golden(config, true));
  out.push_back(make_model(config));
  ModelOptions scalar;
  scalar.form = ModelForm::scalar;
  out.push_back(make_model(config, scalar));
  out.push_back(make_overridden_model(config, {}));
  if (!late_tests) {
    SystemcOptions spans;
    spans.mode = TimedMode::span;
    out.push_back(make_systemc(config));
    out.push_back(make_systemc(config, spans));
  }
  return out;
}

class States : public testing::TestWithParam<bool> {};
TEST_P(States, EnginesAgreeOnRandomStreams) {
  const bool late_tests = GetParam();
  Counters all;
  std::array<std::uint64_t, record_types> non_trivial{};
  for (const char* name : {"depth16", "depth20", "narrow"}) {
    const Config config = shipped_config(name);
    const Engines engines = engines_of(config, late_tests);
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const Scene scene = stream(seed, late_tests);
      const LockStepResult result = run_lock_step(engines, scene, {});
      for (const Comparison& pair : result.pairs) {
        EXPECT_TRUE(pair.held()) << name << ", seed " << seed << ", " << pair.other << ": " << pair.fault;
        for (std::size_t t = 0; t < record_types; ++t) non_trivial[t] += pair.stages[t].non_trivial;
      }
      all += engines[0]->counters();
    }
  }
  EXPECT_GT(all.masked, 1000U);
  EXPECT_GT(all.killed, 1000U);
  EXPECT_GT(all.written, 1000U);
  const auto count = [&](RecordType type) { return non_trivial[static_cast<std::size_t>(type)]; };
  EXPECT_GT(count(RecordType::state), 100U);
  EXPECT_GT(count(RecordType::merge_alpha), 1000U);
  if (late_tests) {
    EXPECT_GT(all.stencil_failed, 1000U);
    EXPECT_GT(count(RecordType::stencil), 1000U);
  }
}
INSTANTIATE_TEST_SUITE_P(Tests, States, testing::Bool(),
                         [](const auto& info) { return info.param ? "late" : "early"; });

StateSetting setting(std::string_view key, std::int64_t value) { return {*find_state_register(key), value}; }

// With stencil off, either order of the tests gives the same picture.
TEST(States, EarlyAndLateDrawTheSamePicture) {
  for (std::uint64_t seed = 100; seed < 110; ++seed) {
    Scene scene = stream(seed, false);
    const Config config = shipped_config("depth16");
    const auto early = make_model(config);
    early->begin(scene);
    draw_scene(*early, scene, 0, scene.triangles.size(), nullptr);
    for (DrawCommand& command : scene.commands) {
      if (!command.clear) {
        command.state.settings.push_back(setting("depth.when", static_cast<std::int64_t>(DepthWhen::late)));
      }
    }
    scene.commands.insert(
        scene.commands.begin(),
        {0, {false, {setting("depth.when", static_cast<std::int64_t>(DepthWhen::late))}}, {}});
    const auto late = make_golden(config);
    late->begin(scene);
    draw_scene(*late, scene, 0, scene.triangles.size(), nullptr);
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_same_frame(early->frame(), late->frame());
    EXPECT_EQ(early->counters().written, late->counters().written);
  }
}

// ---------------------------------------------------------------- blending

struct Merged {
  MergeRecord color;
  std::int64_t alpha = -1;
};
struct Fragment {
  std::int64_t color = 0, alpha = 0;  // raw
};

Merged by_model(const Config& config, const DrawState& state, Fragment f,
                std::array<std::uint8_t, 4> stored) {
  model::MergeStage stage = model::prepare_merge(config);
  model::set_blend(stage, model::blend_of(state));
  TextureRecord texture{};
  texture.a = f.alpha;
  FogRecord fog{};
  fog.r = fog.g = fog.b = f.color;
  Merged out;
  model::merge(stage, DepthRecord{}, texture, fog, stored, out.color);
  if (stage.changes_alpha) out.alpha = model::merged_alpha(stage, texture, stored[3]).a;
  return out;
}
Merged by_golden(const golden::MergeStage& stage, const DrawState& state, Fragment f,
                 std::array<std::uint8_t, 4> stored) {
  TextureRecord texture{};
  texture.a = f.alpha;
  FogRecord fog{};
  fog.r = fog.g = fog.b = f.color;
  const DepthRecord depth{};
  const std::array<const TextureRecord*, 1> textures{&texture};
  const std::array<const DepthRecord*, 1> depths{&depth};
  std::vector<MergeRecord> out;
  std::vector<MergeAlphaRecord> alphas;
  stage({&fog, 1}, textures, depths, state, stored, 1, out, alphas);
  return {out.at(0), alphas.empty() ? -1 : alphas.at(0).a};
}

TEST(States, BlendsByHand) {
  const Config config = shipped_config("depth16");
  const int fraction = config.format(FormatId::fog_color).fraction();
  const int a_fraction = config.format(FormatId::texture_alpha).fraction();
  const auto golden = golden::make_merge({}, config);
  const auto check = [&](BlendFactor src, BlendFactor dst, BlendOp op, std::int64_t expected) {
    DrawState state = first_state(config);
    state.blend_src = src;
    state.blend_dst = dst;
    state.blend_op = op;
    state.blend_red = 128;
    const Fragment f{std::int64_t{100} << fraction, (std::int64_t{1} << a_fraction) / 4};
    EXPECT_EQ(by_model(config, state, f, {200, 0, 0, 64}).color.r, expected);
    EXPECT_EQ(by_golden(golden, state, f, {200, 0, 0, 64}).color.r, expected);
  };
  using enum BlendFactor;
  check(one, one, BlendOp::add, 255);  // 300, saturated
  check(one, zero, BlendOp::add, 100);
  check(zero, one, BlendOp::add, 200);
  check(one, one, BlendOp::subtract, 0);
  check(one, one, BlendOp::reverse_subtract, 100);
  check(zero, zero, BlendOp::min, 100);
  check(zero, zero, BlendOp::max, 200);
  check(src_alpha, zero, BlendOp::add, 25);
  check(zero, one_minus_src_alpha, BlendOp::add, 150);
  check(zero, dst_alpha, BlendOp::add, 50);           // c(64) = 1/4
  check(constant_color, zero, BlendOp::add, 50);      // c(128) = 129/256: 50.39
  check(zero, src_color, BlendOp::add, 78);           // 200 * 100/256 = 78.1
  check(src_alpha_saturate, zero, BlendOp::add, 25);  // a < 1 - 1/4
}

// Every pair of factors and every operation on both channels, over a lattice of operands.
TEST(States, GoldenEqualsModelInEveryBlend) {
  const Config config = shipped_config("depth16");
  const int a_fraction = config.format(FormatId::texture_alpha).fraction();
  const auto golden = golden::make_merge({}, config);
  Random random(7);
  const auto factors = static_cast<std::int64_t>(enum_names<BlendFactor>.size());
  std::uint64_t compared = 0;
  for (std::int64_t src = 0; src < factors; ++src) {
    for (std::int64_t dst = 0; dst < factors; ++dst) {
      for (int i = 0; i < 120; ++i) {
        DrawState state = first_state(config);
        state.blend_src = static_cast<BlendFactor>(src);
        state.blend_dst = static_cast<BlendFactor>(dst);
        state.blend_op = static_cast<BlendOp>(i % 5);
        state.blend_alpha_src = static_cast<BlendFactor>(dst);
        state.blend_alpha_dst = static_cast<BlendFactor>(src);
        state.blend_alpha_op = static_cast<BlendOp>(i / 5 % 5);
        state.blend_red = static_cast<std::int32_t>(random.integer(0, 255));
        state.blend_alpha = static_cast<std::int32_t>(random.integer(0, 255));
        const auto byte = [&] { return static_cast<std::uint8_t>(random.integer(0, 255)); };
        const std::array<std::uint8_t, 4> stored{byte(), byte(), byte(), byte()};
        const Fragment f{random.integer(0, (1 << config.format(FormatId::fog_color).word) - 1),
                         random.integer(0, std::int64_t{1} << a_fraction)};
        const Merged a = by_model(config, state, f, stored);
        const Merged b = by_golden(golden, state, f, stored);
        ASSERT_EQ(a.color, b.color) << src << " " << dst << " " << i;
        ASSERT_EQ(a.alpha, b.alpha) << src << " " << dst << " " << i;
        compared += a.color.r != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(compared, 10000U);
}

TEST(States, GoldenEqualsModelInEveryLogicOperation) {
  const Config config = shipped_config("depth16");
  const int fraction = config.format(FormatId::fog_color).fraction();
  const auto golden = golden::make_merge({}, config);
  for (std::size_t op = 1; op < enum_names<LogicOp>.size(); ++op) {
    DrawState state = first_state(config);
    state.logic_op = static_cast<LogicOp>(op);
    for (int src = 0; src < 256; src += 3) {
      for (int dst = 0; dst < 256; dst += 5) {
        const auto d = static_cast<std::uint8_t>(dst);
        const Fragment f{std::int64_t{src} << fraction, 1};
        const Merged a = by_model(config, state, f, {d, d, d, d});
        ASSERT_EQ(a.color, by_golden(golden, state, f, {d, d, d, d}).color) << to_string(state.logic_op);
      }
    }
  }
  DrawState state = first_state(config);
  state.logic_op = LogicOp::exclusive_or;
  EXPECT_EQ(by_model(config, state, {std::int64_t{0xf0} << fraction, 0}, {0x3c, 0, 0, 0}).color.r, 0xcc);
  state.logic_op = LogicOp::and_reverse;
  EXPECT_EQ(by_model(config, state, {std::int64_t{0xf0} << fraction, 0}, {0x3c, 0, 0, 0}).color.r, 0xc0);
}

// ---------------------------------------------------------------- stencil

// 8 functions x 8 operations on every pair of four-bit values, in each of the three cases.
TEST(States, StencilExhaustively) {
  DrawState state = first_state({});
  state.stencil_test = true;
  std::uint64_t failed = 0;
  for (int func = 0; func < 8; ++func) {
    for (int op = 0; op < 8; ++op) {
      state.stencil_func = static_cast<CompareFunc>(func);
      state.stencil_fail = static_cast<StencilOp>(op);
      state.stencil_zfail = static_cast<StencilOp>((op + 3) % 8);
      state.stencil_pass = static_cast<StencilOp>((op + 5) % 8);
      for (const int mask : {255, 15, 5}) {
        state.stencil_mask = mask;
        state.stencil_write = 255 - 16 * (mask & 5);
        for (int ref = 0; ref < 256; ref += ref == 15 ? 225 : 1) {
          state.stencil_ref = ref;
          for (int value = 0; value < 256; value += value == 15 ? 225 : 1) {
            for (const int z : {0, 1}) {
              const DepthRecord depth{.triangle = 1, .x = 2, .y = 3, .pass = z};
              StencilRecord out;
              const auto stored = static_cast<std::uint8_t>(value);
              const bool passes = model::stencil(model::prepare_stencil(state), false, depth, stored, out);
              const StencilRecord expected = golden::stencil(state, false, depth, stored);
              ASSERT_EQ(out, expected) << func << " " << op << " " << ref << " " << value;
              ASSERT_EQ(passes, expected.pass == 1 && z == 1);
              failed += out.pass == 0 ? 1 : 0;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(failed, 10000U);
}

TEST(States, StencilByHand) {
  DrawState state = first_state({});
  state.stencil_ref = 0x0f;
  state.stencil_mask = 0x3c;
  state.stencil_write = 0xf0;
  state.stencil_func = CompareFunc::less;  // 0x0c < stored & 0x3c
  state.stencil_fail = StencilOp::invert;
  state.stencil_pass = StencilOp::increment;
  const DepthRecord depth{.pass = 1};
  EXPECT_EQ(golden::stencil(state, false, depth, 0x1f).pass, 1);
  EXPECT_EQ(golden::stencil(state, false, depth, 0x1f).value,
            0x2f);  // 0x20, of which the upper four bits are written
  EXPECT_EQ(golden::stencil(state, false, depth, 0xcd).pass, 0);
  EXPECT_EQ(golden::stencil(state, false, depth, 0xcd).value, 0x3d);
  state.stencil_two_sided = true;
  state.stencil_back_func = CompareFunc::never;
  state.stencil_back_fail = StencilOp::replace;
  state.stencil_write = 0xff;
  EXPECT_EQ(golden::stencil(state, true, depth, 0x1f).value, 0x0f);
}

TEST(States, FacingFollowsTheOrderOfInput) {
  const Config config = shipped_config("depth16");
  Triangle t;
  t.v[0].x = 1;
  t.v[0].y = 1;
  t.v[1].x = 9;
  t.v[1].y = 1;
  t.v[2].x = 1;
  t.v[2].y = 9;
  EXPECT_TRUE(golden::runs_clockwise(config, t));
  std::swap(t.v[0], t.v[2]);
  EXPECT_FALSE(golden::runs_clockwise(config, t));
  std::swap(t.v[1], t.v[2]);
  EXPECT_TRUE(golden::runs_clockwise(config, t));
}

TEST(States, TimedModelsRefuseLateTests) {
  Scene scene = stream(3, false);
  scene.commands = {{0, {false, {setting("depth.when", 1)}}, {}}};
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    SystemcOptions options;
    options.mode = mode;
    const auto engine = make_systemc(shipped_config("depth16"), options);
    engine->begin(scene);
    EXPECT_THROW(draw_scene(*engine, scene, 0, 1, nullptr), InputError);
  }
}

// A state register that does nothing in a scene leaves every record as it is; bias and scissor by hand.
TEST(States, IdealFollowsTheState) {
  const Config config = shipped_config("depth16");
  const auto ideal = make_ideal(config);
  const auto model = make_model(config);
  for (std::uint64_t seed = 200; seed < 206; ++seed) {
    const Scene scene = stream(seed, true);
    std::array<Engine*, 2> both{ideal.get(), model.get()};
    for (Engine* engine : both) {
      engine->begin(scene);
      draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
    }
    // The same pixels are drawn but for those where a rounding decides a test.
    std::uint64_t other = 0;
    const Frame& a = ideal->frame();
    const Frame& b = model->frame();
    for (std::size_t i = 0; i < a.triangle.size(); ++i) other += a.triangle[i] != b.triangle[i] ? 1 : 0;
    EXPECT_LT(other, a.triangle.size() / 20) << "seed " << seed;
    EXPECT_EQ(ideal->counters().masked, model->counters().masked) << "seed " << seed;
  }
}

}  // namespace
}  // namespace bitspan
