// SPDX-License-Identifier: Apache-2.0
// rtl/pixel_pipe.sv against the model: the fragments of a scene from depth to the picture, every field of
// every stage, with gaps, stalls and memory latencies.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <deque>
#include <stdexcept>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "model/engine_model.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/depth.hpp"
#include "model/stages/fog.hpp"
#include "model/stages/merge.hpp"
#include "model/stages/texture.hpp"
#include "scene/demo.hpp"
#include "tb/programs.hpp"
#include "tb/rtl_pixels.hpp"
#include "tests/rtl/pipe_case.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/rtl/stage_replay.hpp"
#include "tests/support/files.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

TEST(PixelPipe, TheDemo) {
  for (Config c : shipped_configs()) {
    const PipeCase p = make_pipe_case(c, demo_scene(128, 96));
    ASSERT_GT(p.records.at("merge_record").size(), 5000U);
    ASSERT_GT(p.records.at("texture_record").size(), p.records.at("merge_record").size());
    SCOPED_TRACE(c.name);
    EXPECT_GT(run_pipe(p, {0, {}, {1, 1}, 1}).compared, 300000U);
    run_pipe(p, {0.2, {0.2, 0.3}, {1, 25}, 2});
  }
}

// Every mode of a stage, over depth16.
TEST(PixelPipe, Modes) {
  const Scene scene = demo_scene(96, 72);
  Config base = shipped_config("depth16");
  std::vector<Config> configs(4, base);
  configs[0].filter = TextureFilter::bilinear;
  configs[0].depth_code = DepthCode::linear;
  configs[0].fog = FogMode::linear;
  configs[1].depth_code = DepthCode::opengl;
  configs[1].depth_func = DepthFunc::lequal;
  configs[1].wrap = TextureWrap::clamp;
  configs[1].filter = TextureFilter::bilinear;
  configs[2].perspective = Perspective::const_depth_rows;
  configs[2].fog = FogMode::none;
  configs[3].perspective = Perspective::hyperbolic;
  configs[3].depth_func = DepthFunc::always;
  std::uint64_t seed = 3;
  for (const Config& c : configs) {
    const PipeCase p = make_pipe_case(c, scene);
    SCOPED_TRACE(seed);
    EXPECT_GT(run_pipe(p, {0, {0.1, 0.2}, {1, 12}, seed++}).compared, 100000U);
  }
}

// A new draw state for every few fragments, any raw values, any configuration.
TEST(PixelPipe, RandomDrawStates) {
  const auto check = [](const Config& c, std::uint64_t seed) {
    Random random(seed);
    const PipeCase p = random_pipe_case(random, c, 400);
    ASSERT_GT(p.records.at("depth_record").size(), 500U);
    EXPECT_GT(run_pipe(p, {0, {}, {1, 1}, seed}).compared, 4000U);
    run_pipe(p, {0.2, {0.2, 0.3}, {1, 25}, seed});
    run_pipe(p, {0, {}, {15, 30}, seed});
  };
  for (const Config& c : shipped_configs()) check(c, 9);
  for (const std::uint64_t seed : stage_seeds(4)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check(random_stage_config(seed), seed);
    if (HasFailure()) return;
  }
}

// Pictures and textures that need every bit of a coordinate, of a texel's index and of an address.
TEST(PixelPipe, LargePicturesAndTextures) {
  std::vector<Config> configs(3, shipped_config("depth16"));
  configs[1].depth_code = DepthCode::linear;
  configs[1].fog = FogMode::linear;
  configs[2].depth_code = DepthCode::opengl;
  Random random(41);
  for (const Config& c : configs) {
    const int most = (1 << c.coordinate_bits) - 1;
    for (const auto& [width, height] : {std::pair(most, 1), {1, most}, {43690, 1}, {2, 21845}, {300, 200}}) {
      SCOPED_TRACE(fmt::format("{} x {}", width, height));
      const PipeCase p = random_pipe_case(
          random, c, 100, {width, height, {{1, 1}, {16384, 2}, {2, 16384}, {128, 64}}, random() >> 33});
      run_pipe(p, {0.1, {0.1, 0.1}, {1, 9}, 5});
    }
  }
}

TEST(PixelPipe, ResetAmidFragments) {
  Random random(31);
  const PipeCase p = random_pipe_case(random, shipped_config("depth16"), 100);
  for (const int clocks : {2, 20, 60, 150}) {
    SCOPED_TRACE(clocks);
    EXPECT_GT(run_pipe(p, {0.1, {0.2, 0.2}, {1, 20}, 7, clocks}).compared, 1000U);
  }
}

// Rows of pixels, none of them twice: one per clock, with the memories' latency added once.
TEST(PixelPipe, OneFragmentPerClock) {
  for (const Config& c : shipped_configs()) {
    Scene scene;
    scene.width = 200;
    scene.height = 20;
    scene.s_min = 1;
    scene.s_max = 2;
    Triangle triangle;
    triangle.v[0] = {0, 0, 1, 0, 0, {1, 1, 1, 0.5}};
    triangle.v[1] = {400, 0, 2, 8, 0, {1, 0, 1, 0.5}};
    triangle.v[2] = {0, 40, 1.5, 0, 8, {1, 1, 0, 0.5}};
    scene.triangles = {triangle};
    const PipeCase p = make_pipe_case(c, scene);
    const auto fragments = static_cast<std::uint64_t>(p.records.at("merge_record").size());
    ASSERT_GT(fragments, 3500U);
    const PixelTiming t = pixel_timing(c);
    const auto latency =
        static_cast<std::uint64_t>(t.depth.total + t.texture.total + t.fog.total + t.merge.total_blending);
    // Four clocks: the draw state's transfer and what the last record and its count take.
    EXPECT_LE(run_pipe(p, {0, {}, {1, 1}, 1}).clocks, fragments + latency + 4) << c.name;
    // Three memories answer twelve clocks later.
    EXPECT_LE(run_pipe(p, {0, {}, {12, 12}, 1}).clocks, fragments + latency + 4 + 3 * 11) << c.name;
  }
}

std::vector<Config> tool_configs() {
  Config linear = shipped_config("depth16");
  linear.depth_code = DepthCode::linear;
  linear.fog = FogMode::linear;
  std::vector<Config> configs{shipped_config("narrow"), linear};
  for (const std::uint64_t seed : stage_seeds(1)) configs.push_back(random_stage_config(100 + seed));
  return configs;
}

TEST(PixelPipe, VerilatorLintIsSilent) {
  for (const Config& c : tool_configs()) {
    for (const char* top : {"depth", "texture", "fog", "merge", "pixel_pipe"}) {
      const TemporaryFolder folder;
      std::vector<std::string> command = {"verilator",       "--lint-only", "-Wall",        "--assert",
                                          "--max-num-width", "1048576",     "--top-module", top};
      command.push_back(folder.write("bitspan_pixel_pkg.sv", emit_pixel_sv(c)));
      for (const auto& source : pixel_sources()) command.push_back(source.string());
      const auto log = folder.path("lint.log");
      EXPECT_EQ(run_program(command, log, "this test"), 0) << to_toml(c);
      EXPECT_EQ(read_file(log), "") << to_toml(c);
    }
  }
}

// What Icarus makes of the sources, and of the netlist that Yosys understood, is what Verilator made of them.
TEST(PixelPipe, IcarusAndYosysAgree) {
  for (const Config& c : tool_configs()) {
    Random random(21);
    const PipeCase p = random_pipe_case(random, c, 40);
    StageTrace trace;
    run_pipe(p, {0.2, {0.2, 0.3}, {1, 9}, 4}, &trace);
    expect_tools_agree(pixel_pipe_design(c), trace);
  }
}

TEST(PixelPipe, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/pixel_pipe.sv", "assign fate_write = lives && fate_state[textured_slot];",
       "assign fate_write = fate_state[textured_slot];"},
      {"rtl/pixel_pipe.sv", "draw_ready_o <= none[next_slot] && settled_q && !draw_taken;",
       "draw_ready_o <= 1'b1;"},
      {"rtl/pixel_pipe.sv", ".in_valid_i(textured_valid && lives && fate_ready)",
       ".in_valid_i(textured_valid && lives)"},
      {"rtl/pixel_pipe.sv", "assign left[1] = textured_valid && textured_ready && killed;",
       "assign left[1] = textured_valid && killed;"},
  };
  Random random(5);
  const PipeCase p = random_pipe_case(random, shipped_config("depth16"), 400);
  const auto run = [&] {
    run_pipe(p, {0.1, {0.2, 0.3}, {1, 25}, 5});
    run_pipe(p, {0, {0, 0.8}, {1, 3}, 5});
  };
  run();
  expect_seen(bugs, run);
}

}  // namespace
}  // namespace bitspan
