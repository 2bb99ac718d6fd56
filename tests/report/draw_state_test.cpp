// SPDX-License-Identifier: Apache-2.0
// Draw state in all engines: random streams with changes of state, and what each register does.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/engine_override.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/lockstep.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"
#include "tests/support/wrapped_engine.hpp"

namespace bitspan {
namespace {

using Engines = std::vector<std::unique_ptr<Engine>>;

RandomOptions stream_options() {
  RandomOptions options;
  options.width = 61;
  options.height = 47;
  options.triangles = 40;
  options.size_max = 60;
  options.depth_ratio_max = 8;
  options.uv_limit = 64;
  return options;
}
Scene stream(std::uint64_t seed, bool late_tests) {
  RandomOptions options = stream_options();
  options.command_probability = 0.4;
  options.late_tests = late_tests;
  return random_scene(seed, options);
}

StateSetting setting(std::string_view key, std::int64_t value) { return {*find_state_register(key), value}; }

Engines engines_of(const Config& config) {
  Engines out;
  out.push_back(make_golden(config, true));
  out.push_back(make_model(config));
  ModelOptions scalar;
  scalar.form = ModelForm::scalar;
  out.push_back(make_model(config, scalar));
  out.push_back(make_overridden_model(config, {}));
  SystemcOptions spans;
  spans.mode = TimedMode::span;
  out.push_back(make_systemc(config));
  out.push_back(make_systemc(config, spans));
  return out;
}

class States : public testing::TestWithParam<bool> {};
TEST_P(States, EnginesAgreeOnRandomStreams) {
  const bool late_tests = GetParam();
  Counters all;
  std::array<std::uint64_t, record_types> non_trivial{};
  for (const char* name : {"depth16", "depth20", "narrow"}) {
    const Config config = shipped_config(name);
    const Engines engines = engines_of(config);
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

// The second texture unit with all functions, without mip chains and with, all that the engines keep of it.
TEST(States, EnginesAgreeOnTheSecondTexture) {
  std::uint64_t combined = 0;
  std::uint64_t killed = 0;
  for (const char* name : {"depth16", "narrow"}) {
    for (const MipMode mip : {MipMode::none, MipMode::linear}) {
      Config config = shipped_config(name);
      config.mip = mip;
      config.lod = LodMode::gradient;
      config.filter = mip == MipMode::none ? TextureFilter::nearest : TextureFilter::bilinear;
      config.transparent = {255, 0, 255};
      const Engines engines = engines_of(config);
      for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        RandomOptions options = stream_options();
        options.mip_chains = true;
        options.command_probability = 0.2;
        options.late_tests = seed % 2 == 0;
        Scene scene = random_scene(300 + seed, options);
        if (scene.textures.empty()) continue;
        for (DrawCommand& command : scene.commands) {
          const auto at = static_cast<std::int64_t>(command.before);
          auto* change = std::get_if<StateChange>(&command.what);
          if (change == nullptr) continue;
          std::erase_if(change->settings, [](const StateSetting& s) {
            return state_registers()[s.index].key.starts_with("texture1");
          });
          change->settings.push_back(
              setting("texture1", at % static_cast<std::int64_t>(scene.textures.size())));
          change->settings.push_back(setting("texture1.op", at % 6));
          change->settings.push_back(setting("texture1.scale", at % 3));
        }
        const LockStepResult result = run_lock_step(engines, scene, {});
        for (const Comparison& pair : result.pairs) {
          EXPECT_TRUE(pair.held()) << name << ", seed " << seed << ", " << pair.other << ": " << pair.fault;
          combined += pair.stages[static_cast<std::size_t>(RecordType::texture_second)].non_trivial;
        }
        killed += engines[0]->counters().killed;
      }
    }
  }
  EXPECT_GT(combined, 20000U);
  EXPECT_GT(killed, 200U);  // alpha.zero = keep leaves the others
}

// Every engine refuses a texture that the scene does not have.
TEST(States, TheSecondTextureIsOneOfTheScene) {
  Scene scene = stream(1, false);
  scene.textures.clear();
  for (Triangle& t : scene.triangles) t.texture = -1;
  const Config config = shipped_config("depth16");
  Engines engines = engines_of(config);
  engines.push_back(make_ideal(config));
  for (const auto& engine : engines) {
    engine->begin(scene);
    EXPECT_THROW(engine->execute({0, StateChange{false, {setting("texture1", 0)}}}, 0, nullptr), InputError);
    engine->execute({0, StateChange{false, {setting("texture1", -1)}}}, 0, nullptr);
  }
}

// With stencil off, either order of the tests gives the same picture.
TEST(States, EarlyAndLateDrawTheSamePicture) {
  for (std::uint64_t seed = 100; seed < 110; ++seed) {
    Scene scene = stream(seed, false);
    const Config config = shipped_config("depth16");
    const auto early = make_model(config);
    early->begin(scene);
    draw_scene(*early, scene, 0, scene.triangles.size(), nullptr);
    for (DrawCommand& command : scene.commands) {
      if (auto* change = std::get_if<StateChange>(&command.what)) {
        change->settings.push_back(setting("depth.when", static_cast<std::int64_t>(DepthWhen::late)));
      }
    }
    scene.commands.insert(
        scene.commands.begin(),
        {0, StateChange{false, {setting("depth.when", static_cast<std::int64_t>(DepthWhen::late))}}});
    const auto late = make_golden(config);
    late->begin(scene);
    draw_scene(*late, scene, 0, scene.triangles.size(), nullptr);
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_same_frame(early->frame(), late->frame());
    EXPECT_EQ(early->counters().written, late->counters().written);
  }
}

// Triangles, clears and states of a stream without the target lines, those of one target alone: what draws on
// a target is drawn as in a stream of its own, whatever is drawn on others between.
TEST(Targets, EachIsDrawnAsAlone) {
  std::uint64_t others = 0;
  for (const char* name : {"depth16", "depth20", "narrow"}) {
    const Config config = shipped_config(name);
    Engines engines = engines_of(config);
    engines.push_back(make_ideal(config));
    for (std::uint64_t seed = 700; seed < 706; ++seed) {
      Scene scene = stream(seed, true);
      std::erase_if(scene.commands,
                    [](const DrawCommand& command) { return std::holds_alternative<Target>(command.what); });
      std::vector<DrawCommand> commands;
      std::array<Scene, 3> alone{scene, scene, scene};
      for (Scene& s : alone) {
        s.triangles.clear();
        s.commands.clear();
      }
      // Triangle i goes to target i / 2 mod 3, whose number is another one.
      constexpr std::array<int, 3> numbers{0, 5, 7};
      auto command = scene.commands.begin();
      for (std::size_t i = 0; i <= scene.triangles.size(); ++i) {
        const std::size_t t = i / 2 % 3;
        if (i % 2 == 0) commands.push_back({.before = i, .what = Target{numbers.at(t)}});
        for (; command != scene.commands.end() && command->before == i; ++command) {
          commands.push_back(*command);
          for (std::size_t k = 0; k < 3; ++k) {
            if (k != t && std::holds_alternative<Clear>(command->what))
              continue;  // a change of state is for all
            alone.at(k).commands.push_back(*command);
            alone.at(k).commands.back().before = alone.at(k).triangles.size();
          }
        }
        if (i < scene.triangles.size()) alone.at(t).triangles.push_back(scene.triangles[i]);
      }
      scene.commands = commands;
      for (const auto& engine : engines) {
        SCOPED_TRACE(std::string(name) + ", seed " + std::to_string(seed) + ", " +
                     std::string(engine->name()));
        std::vector<Frame> expected;
        for (const Scene& s : alone) {
          engine->begin(s);
          draw_scene(*engine, s, 0, s.triangles.size(), nullptr);
          expected.push_back(engine->frame());
        }
        engine->begin(scene);
        draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
        for (std::size_t k = 0; k < 3; ++k) {
          engine->execute({0, Target{numbers.at(k)}}, 0, nullptr);
          Frame shown = engine->frame();
          // Indices count all triangles of a stream.
          std::ranges::fill(shown.triangle, 0);
          std::ranges::fill(expected.at(k).triangle, 0);
          shown.stencil.resize(expected.at(k).stencil.size());
          expect_same_frame(shown, expected.at(k));
        }
        engine->execute({0, Target{3}}, 0, nullptr);  // not drawn on
        others += static_cast<std::uint64_t>(std::ranges::count(engine->frame().triangle, -1));
        EXPECT_EQ(error_of([&] {
                    engine->execute({0, Target{8}}, 0, nullptr);
                  }),
                  "target: 8 does not exist; expected 0..7");
        EXPECT_EQ(error_of([&] {
                    engine->execute({0, Target{-1}}, 0, nullptr);
                  }),
                  "target: -1 does not exist; expected 0..7");
        engine->begin(scene);  // target 0 again, and nothing is kept
        others += static_cast<std::uint64_t>(std::ranges::count(engine->frame().triangle, -1));
        engine->execute({0, Target{5}}, 0, nullptr);
        others += static_cast<std::uint64_t>(std::ranges::count(engine->frame().triangle, -1));
      }
    }
  }
  EXPECT_EQ(others, 3U * 6 * 7 * 3 * 61 * 47);
}

// Clears the stencil plane to another value than it is told.
class OtherClear final : public WrappedEngine {
 public:
  using WrappedEngine::WrappedEngine;
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    DrawCommand other = command;
    auto* clear = std::get_if<Clear>(&other.what);
    if (clear != nullptr && clear->stencil) *clear->stencil ^= 1;
    WrappedEngine::execute(other, next_index, trace);
  }
};

// A target that is not shown is compared, too.
TEST(Targets, ADifferenceInOneThatIsNotShownIsSeen) {
  const Config config = shipped_config("depth16");
  Scene scene = stream(3, false);
  scene.commands = {{0, Target{1}},
                    {0, StateChange{true, {setting("depth.when", 1), setting("stencil.test", 1)}}},
                    {10, Clear{{}, {}, false, 7}},
                    {10, Target{0}}};
  Engines engines;
  engines.push_back(make_golden(config, true));
  engines.push_back(make_model(config));
  EXPECT_TRUE(run_lock_step(engines, scene, {}).pairs.at(0).held());
  EXPECT_EQ(engines[0]->frame().stencil, engines[1]->frame().stencil);
  EXPECT_EQ(engines[0]->frame().stencil.at(0), 0);
  engines[1] = std::make_unique<OtherClear>(std::move(engines[1]));
  EXPECT_FALSE(run_lock_step(engines, scene, {}).pairs.at(0).held());
}

// Scissor, stipple and masks do not hold a clear back, and the target narrows it: 100 of 6 bits is 101, 3 of
// 5 is 0, and there is no alpha.
TEST(States, AClearFillsWholePlanes) {
  const Config config = shipped_config("depth16");
  const Scene scene = parse_tri(
      R"({"bitspan":2,"width":4,"height":4,"s_min":1,"s_max":10,"focal":4,"color_max":255,"background":[9,9,9]})"
      "\n"
      R"({"state":{"target.format":"rgb565","color.write":false,"depth.write":false,"scissor.right":2,)"
      R"("stipple":0,"depth.when":"late","stencil.test":true,"stencil.write":0}})"
      "\n"
      R"({"clear":{"color":[255,100,3],"alpha":7,"depth":true,"stencil":77}})"
      "\n",
      "x.tri");
  for (const auto& engine : engines_of(config)) {
    engine->begin(scene);
    draw_scene(*engine, scene, 0, 0, nullptr);
    const Frame& frame = engine->frame();
    for (std::size_t i = 0; i < 16; ++i) {
      const std::vector<int> color(frame.color.begin() + static_cast<std::ptrdiff_t>(4 * i),
                                   frame.color.begin() + static_cast<std::ptrdiff_t>(4 * i + 4));
      EXPECT_EQ(color, (std::vector<int>{255, 101, 0, 255})) << engine->name() << " pixel " << i;
      EXPECT_EQ(frame.stencil.at(i), 77) << engine->name() << " pixel " << i;
    }
  }
}

// The same clear inside the scissor, by what the masks let through; the stipple does not hold it back.
TEST(States, AMaskedClearObeysScissorAndMasks) {
  const Config config = shipped_config("depth16");
  constexpr std::string_view head =
      R"({"bitspan":2,"width":4,"height":4,"s_min":1,"s_max":10,"focal":4,"color_max":255,"background":[9,9,9]})"
      "\n"
      // Drawn by a triangle over all pixels: stencil 0x0f, a depth in front of the farthest.
      R"({"state":{"depth.when":"late","stencil.test":true,"stencil.ref":15,"stencil.pass":"replace"}})"
      "\n"
      R"({"v":[[0,0,5,0,0],[12,0,5,0,0],[0,12,5,0,0]]})"
      "\n";
  struct Case {
    const char* registers;
    bool color, depth;
    int stencil;  // where the pixel is inside
  };
  for (const Case& c :
       {Case{R"("color.write":true)", true, true, 0xaa},
        Case{R"("color.write":false,"stencil.write":240)", false, true, 0xaf},
        Case{R"("depth.write":false,"stencil.write":1,"stencil.back.write":255)", true, false, 0x0e},
        Case{R"("color.write":false,"depth.write":false,"stencil.write":0)", false, false, 0x0f}}) {
    const Scene drawn = parse_tri(std::string(head), "x.tri");
    const Scene scene = parse_tri(
        std::string(head) +
            R"({"state":{"target.format":"argb4444","scissor.left":1,"scissor.right":3,"scissor.top":2,"stipple":0,)" +
            c.registers + "}}\n" +
            R"({"clear":{"color":[255,100,3],"alpha":128,"depth":true,"stencil":170,"masked":true}})" + "\n",
        "x.tri");
    for (const auto& engine : engines_of(config)) {
      engine->begin(drawn);
      draw_scene(*engine, drawn, 0, 1, nullptr);
      const Frame before = engine->frame();
      engine->begin(scene);
      draw_scene(*engine, scene, 0, 1, nullptr);
      const Frame& frame = engine->frame();
      const auto color_of = [](const Frame& f, std::size_t i) {
        return std::vector<int>(f.color.begin() + static_cast<std::ptrdiff_t>(4 * i),
                                f.color.begin() + static_cast<std::ptrdiff_t>(4 * i + 4));
      };
      for (std::size_t i = 0; i < 16; ++i) {
        SCOPED_TRACE(fmt::format("{}, {}, pixel {}", engine->name(), c.registers, i));
        const bool inside = (i % 4 == 1 || i % 4 == 2) && i / 4 >= 2;
        EXPECT_EQ(before.triangle[i], 0);
        EXPECT_EQ(before.stencil[i], 15);
        // 255 100 3 and 128 of four bits each: 15, 6, 0 and 8, 17 times.
        const bool colored = inside && c.color;
        EXPECT_EQ(color_of(frame, i), colored ? (std::vector<int>{255, 102, 0, 136}) : color_of(before, i));
        EXPECT_EQ(frame.triangle[i], colored ? -1 : 0);
        EXPECT_EQ(std::isnan(frame.u[i]), colored);
        EXPECT_EQ(frame.depth[i] != before.depth[i], inside && c.depth);
        EXPECT_EQ(frame.stencil[i], inside ? c.stencil : 15);
      }
    }
  }
}

// A fragment over the background, and a masked clear behind it, channel by channel.
TEST(States, AColorMaskKeepsChannels) {
  const Config config = shipped_config("depth16");
  constexpr std::string_view head =
      R"({"bitspan":2,"width":4,"height":4,"s_min":1,"s_max":10,"focal":4,"color_max":255,"background":[10,20,30]})"
      "\n";
  constexpr std::array<int, 4> before{10, 20, 30, 255}, drawn{200, 100, 50, 64}, cleared{255, 254, 253, 7};
  for (int mask = 0; mask < 16; ++mask) {
    const std::string state = fmt::format(
        R"({{"state":{{"depth.when":"late","blend.src":"one","blend.dst":"zero","blend.alpha.src":"one",)"
        R"("blend.alpha.dst":"zero","color.mask":{}}}}})"
        "\n",
        mask);
    constexpr std::string_view triangle =
        R"({"v":[[0,0,2,0,0],[12,0,2,0,0],[0,12,2,0,0]],"c":[[200,100,50,64],[200,100,50,64],[200,100,50,64]]})"
        "\n";
    const std::string text = std::string(head) + state + std::string(triangle);
    const Scene draws = parse_tri(text, "x.tri");
    const Scene clears =
        parse_tri(text + R"({"clear":{"color":[255,254,253],"alpha":7,"masked":true}})" + "\n", "x.tri");
    for (const auto& engine : engines_of(config)) {
      for (const bool clear : {false, true}) {
        const Scene& scene = clear ? clears : draws;
        engine->begin(scene);
        draw_scene(*engine, scene, 0, 1, nullptr);
        const Frame& frame = engine->frame();
        for (std::size_t c = 0; c < 4; ++c) {
          const bool stored = (mask >> c & 1) != 0;
          EXPECT_EQ(frame.color[4 * 5 + c], !stored ? before[c]
                                            : clear ? cleared[c]
                                                    : drawn[c])
              << engine->name() << " mask " << mask << " channel " << c << (clear ? " cleared" : "");
        }
        EXPECT_EQ(frame.triangle[5], clear ? -1 : 0) << engine->name() << " mask " << mask;
      }
    }
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

// Golden's combined colours lie by the unquantised ones, for every function.
TEST(States, IdealCombinesTextures) {
  Config config = shipped_config("depth20");
  config.filter = TextureFilter::bilinear;
  for (const MipMode mip : {MipMode::none, MipMode::linear}) {
    config.mip = mip;
    config.lod = LodMode::gradient;
    // Lg lies up to 0.0861 below the logarithm, and so does the share of a level.
    const int most = mip == MipMode::none ? 4 : 16;
    for (std::int64_t op = 0; op < 6; ++op) {
      RandomOptions options = stream_options();
      options.triangles = 20;
      options.size_min = 20;
      options.depth_ratio_max = 4;
      options.uv_limit = 32;
      options.mip_chains = true;
      options.fog_probability = 0;
      Scene scene = random_scene(500 + static_cast<std::uint64_t>(op), options);
      if (scene.textures.empty()) scene = random_scene(520, options);
      ASSERT_FALSE(scene.textures.empty());
      scene.commands = {{0, StateChange{false,
                                        {setting("texture1", 0), setting("texture1.op", op),
                                         setting("texture1.scale", 1), setting("texture1.red", 255)}}}};
      const auto ideal = make_ideal(config);
      const auto golden = make_golden(config, true);
      for (Engine* engine : {ideal.get(), golden.get()}) {
        engine->begin(scene);
        draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
      }
      std::uint64_t drawn = 0, far = 0;
      for (std::size_t i = 0; i < golden->frame().triangle.size(); ++i) {
        if (golden->frame().triangle[i] < 0 || golden->frame().triangle[i] != ideal->frame().triangle[i])
          continue;
        ++drawn;
        for (std::size_t c = 0; c < 3; ++c) {
          far += std::abs(golden->frame().color[4 * i + c] - ideal->frame().color[4 * i + c]) > most ? 1 : 0;
        }
      }
      EXPECT_GT(drawn, 600U);
      EXPECT_LT(far, drawn / 25) << "op " << op << ", " << to_string(mip);
    }
  }
}

}  // namespace
}  // namespace bitspan
