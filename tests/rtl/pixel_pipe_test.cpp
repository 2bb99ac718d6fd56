// SPDX-License-Identifier: Apache-2.0
// rtl/pixel_pipe.sv against the model: the fragments of a scene from depth to the picture, every field of
// every stage, with gaps, stalls and memory latencies.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <deque>
#include <ostream>
#include <span>
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
#include "tests/support/long_run.hpp"
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

// The same with late tests: texture first, then depth and stencil.
TEST(PixelPipe, TheDemoWithLateTests) {
  for (const Config& c : shipped_configs()) {
    const PipeCase p = make_pipe_case(c, demo_scene(128, 96), DepthWhen::late);
    SCOPED_TRACE(c.name);
    const auto records = [&](const char* tap) { return p.records.at(tap).size(); };
    ASSERT_GT(records("texture_record"), records("depth_record"));
    ASSERT_EQ(records("depth_record"), records("stencil_record"));
    ASSERT_GT(records("stencil_record"), records("merge_record") + 1000);
    ASSERT_GT(records("merge_record"), 1000U);
    EXPECT_GT(run_pipe(p, {0, {}, {1, 1}, 1}).compared, 300000U);
    run_pipe(p, {0.2, {0.2, 0.3}, {1, 25}, 2});
  }
}

TEST(PixelPipe, TheDemoWithLevels) {
  const std::vector<Config> configs = level_configs();
  for (const Config& c : in_gate(configs)) {
    SCOPED_TRACE(fmt::format("mip {}, lod {}", to_string(c.mip), to_string(c.lod)));
    const PipeCase p = make_pipe_case(c, demo_scene(128, 96));
    ASSERT_EQ(p.records.at("lod_record").size(), p.records.at("texture_record").size());
    EXPECT_GT(run_pipe(p, {0, {}, {1, 1}, 1}).compared, 400000U);
    run_pipe(p, {0.2, {0.2, 0.3}, {1, 25}, 2});
    run_pipe(make_pipe_case(c, demo_scene(128, 96), DepthWhen::late), {0.2, {0.2, 0.3}, {1, 25}, 3});
  }
}

// A factor of the fog and a line for depth with every fragment, beside what lod takes of it.
Config channel_config() {
  Config c = level_configs()[2];
  c.fog = FogMode::vertex;
  c.depth_line = DepthLine::z;
  return c;
}

TEST(PixelPipe, WhatComesWithFragments) {
  const Config c = channel_config();
  Scene scene = demo_scene(96, 72);
  Random depths(11);
  for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
    for (Vertex& v : scene.triangles[i].v) v.z = std::uniform_real_distribution<double>(0, 1)(depths);
  }
  for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
    SCOPED_TRACE(to_string(when));
    const PipeCase demo = make_pipe_case(c, scene, when);
    EXPECT_EQ(demo.fog.mode, FogMode::vertex);
    EXPECT_GT(run_pipe(demo, {0, {0.1, 0.2}, {1, 12}, 3}).compared, 100000U);
    Random random(9);
    const PipeCase any = random_pipe_case(random, c, 400, {}, when);
    run_pipe(any, {0, {}, {1, 1}, 9});
    run_pipe(any, {0.2, {0.2, 0.3}, {1, 25}, 9});
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
    for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
      SCOPED_TRACE(to_string(when));
      Random random(seed);
      const PipeCase p = random_pipe_case(random, c, 400, {}, when);
      ASSERT_GT(p.records.at(is_late(when) ? "texture_record" : "depth_record").size(), 500U);
      if (is_late(when)) {
        ASSERT_GT(p.records.at("stencil_record").size(), 30U);
      }
      EXPECT_GT(run_pipe(p, {0, {}, {1, 1}, seed}).compared, 4000U);
      run_pipe(p, {0.2, {0.2, 0.3}, {1, 25}, seed});
      run_pipe(p, {0, {}, {15, 30}, seed});
    }
  };
  const std::vector<Config> shipped = shipped_configs();
  for (const Config& c : in_gate(shipped)) check(c, 9);
  for (Config c : in_gate(shipped)) {
    c.rtl.blend = RtlBlend::equation;
    check(c, 10);
  }
  const std::vector<Config> with_levels = level_configs();
  for (const Config& c : in_gate(with_levels)) {
    SCOPED_TRACE(fmt::format("mip {}, lod {}", to_string(c.mip), to_string(c.lod)));
    check(c, 9);
  }
  for (const std::uint64_t seed : stage_seeds(is_gate_run() ? 1 : 4)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check(random_stage_config(seed), seed);
    if (HasFailure()) return;
  }
}

// All equations behind one another, on few pixels, whose alpha they change.
TEST(PixelPipe, EveryEquation) {
  Config c = shipped_config("narrow");
  c.rtl.blend = RtlBlend::equation;
  Random random(12);
  const PipeCase p = random_pipe_case(random, c, 6000, {.width = 5, .height = 3});
  const std::size_t merged = p.records.at("merge_record").size();
  const std::size_t alphas = p.records.at("merge_alpha_record").size();
  EXPECT_GT(merged, 2000U);
  EXPECT_GT(alphas, merged / 4);
  EXPECT_LT(alphas, merged);
  EXPECT_GT(p.reads, merged / 3);
  EXPECT_LT(p.reads, merged);
  run_pipe(p, {0, {}, {1, 1}, 2});
  run_pipe(p, {0.1, {0.2, 0.2}, {1, 12}, 3});
}

// Pictures and textures that need every bit of a coordinate, of a texel's index and of an address.
TEST(PixelPipe, LargePicturesAndTextures) {
  std::vector<Config> configs(3, shipped_config("depth16"));
  configs[1].depth_code = DepthCode::linear;
  configs[1].fog = FogMode::linear;
  configs[2].depth_code = DepthCode::opengl;
  configs.push_back(level_configs()[2]);
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
  for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
    Random random(31);
    const PipeCase p = random_pipe_case(random, shipped_config("depth16"), 100, {}, when);
    for (const int clocks : {2, 20, 60, 150}) {
      SCOPED_TRACE(clocks);
      EXPECT_GT(run_pipe(p, {0.1, {0.2, 0.2}, {1, 20}, 7, clocks}).compared, 1000U);
    }
  }
}

// The last depth codes wait long behind the last colours: the pipe is idle no clock before they are written.
TEST(PixelPipe, IsIdleBehindTheLastWrite) {
  const RtlCopy copy;
  for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
    SCOPED_TRACE(to_string(when));
    const RtlModuleDesign module = module_of(pixel_pipe_design(shipped_config("depth16"), when));
    const std::size_t idle = port_place(module.outputs, "idle_o");
    const std::size_t write = port_place(module.outputs, "z_write_valid_o");
    const auto idle_before_a_write = [&] {
      std::size_t clocks = 0;
      for (const std::uint64_t seed : {1, 2, 3, 4}) {
        Random random(seed);
        const PipeCase p = random_pipe_case(random, shipped_config("depth16"), 20, {}, when);
        StageTrace trace;
        run_pipe(p, {.in_gap = 0.98, .stalls = {}, .latency = {1, 1}, .seed = seed, .z_write_stall = 0.985},
                 &trace);
        for (const auto& outputs : trace.outputs) clocks += outputs[idle] & outputs[write];
      }
      return clocks;
    };
    EXPECT_EQ(idle_before_a_write(), 0U);
    const char* line = "idle_o <= (&none) && !in_q && !in_taken && !fate_waits;";
    const char* bug = "idle_o <= (&none) && !in_q && !in_taken;";
    copy.replace("rtl/pixel_pipe.sv", line, bug);
    EXPECT_GT(idle_before_a_write(), 0U);
    copy.replace("rtl/pixel_pipe.sv", bug, line);
  }
}

// Rows of pixels, none of them twice: one per clock, with the memories' latency added once.
TEST(PixelPipe, OneFragmentPerClock) {
  std::vector<Config> configs = shipped_configs();
  for (const Config& c : level_configs()) configs.push_back(c);
  for (const Config& c : configs) {
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
    const auto latency = static_cast<std::uint64_t>(t.depth.total + (t.has_lod ? t.lod.total : 0) +
                                                    t.texture.total + t.fog.total + t.merge.total_blending);
    // Four clocks: the draw state's transfer and what the last record and its count take.
    EXPECT_LE(run_pipe(p, {0, {}, {1, 1}, 1}).clocks, fragments + latency + 4) << c.name;
    // Three memories answer twelve clocks later.
    EXPECT_LE(run_pipe(p, {0, {}, {12, 12}, 1}).clocks, fragments + latency + 4 + 3 * 11) << c.name;
  }
}

// What the tools read, one after another: each takes Icarus some 40 seconds.
struct ToolCase {
  const char* name;
  Config (*config)();
  DepthWhen when = DepthWhen::early;

  friend void PrintTo(const ToolCase& c, std::ostream* out) { *out << c.name; }
};
const ToolCase tool_cases[] = {
    {"Equation",
     [] {
       Config c = shipped_config("narrow");
       c.rtl.blend = RtlBlend::equation;
       return c;
     }},
    {"Linear",
     [] {
       Config c = shipped_config("depth16");
       c.depth_code = DepthCode::linear;
       c.fog = FogMode::linear;
       return c;
     }},
    {"Levels",
     [] {
       Config c = level_configs()[1];
       c.fog = FogMode::vertex;
       c.depth_line = DepthLine::z;
       return c;
     }},
    {"Random", [] { return random_stage_config(100 + stage_seeds(1)[0]); }},
    {"Late", [] { return shipped_config("narrow"); }, DepthWhen::late},
};

TEST(PixelPipe, VerilatorLintIsSilent) {
  for (const ToolCase& tool_case : tool_cases) {
    const Config c = tool_case.config();
    for (const char* top :
         {"depth", "texture_address", "texture_words", "texture", "fog", "merge", "pixel_pipe", "late"}) {
      const bool late = std::string_view(top) == "late";
      if (late) top = "pixel_pipe";
      const TemporaryFolder folder;
      std::vector<std::string> command = {"verilator",       "--lint-only", "-Wall",        "--assert",
                                          "--max-num-width", "1048576",     "--top-module", top};
      command.push_back(
          folder.write("bitspan_pixel_pkg.sv", emit_pixel_sv(c, late ? DepthWhen::late : DepthWhen::early)));
      for (const auto& source : pixel_sources()) command.push_back(source.string());
      const auto log = folder.path("lint.log");
      EXPECT_EQ(run_program(command, log, "this test"), 0) << to_toml(c);
      EXPECT_EQ(read_file(log), "") << to_toml(c);
    }
  }
}

class PixelPipeIn : public ::testing::TestWithParam<ToolCase> {};

// What Icarus makes of the sources, and of the netlist that Yosys understood, is what Verilator made of them.
TEST_P(PixelPipeIn, IcarusAndYosysAgree) {
  const Config c = GetParam().config();
  Random random(21);
  const PipeCase p = random_pipe_case(random, c, 40, {}, GetParam().when);
  StageTrace trace;
  run_pipe(p, {0.2, {0.2, 0.3}, {1, 9}, 4}, &trace);
  expect_tools_agree(pixel_pipe_design(c, GetParam().when), trace);
}

INSTANTIATE_TEST_SUITE_P(Cases, PixelPipeIn, ::testing::ValuesIn(tool_cases),
                         [](const auto& info) { return info.param.name; });

TEST(PixelPipe, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/pixel_pipe.sv", "assign fate_write[0] = lives && fate_state[judged_slot];",
       "assign fate_write[0] = fate_state[judged_slot];"},
      {"rtl/pixel_pipe.sv", "draw_ready_o <= none[next_slot] && settled_q && !draw_taken;",
       "draw_ready_o <= 1'b1;"},
      {"rtl/pixel_pipe.sv", ".in_valid_i(judged_valid && lives && fate_ready)",
       ".in_valid_i(judged_valid && lives)"},
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

TEST(PixelPipe, PlantedBugsAreSeenWithLateTests) {
  constexpr PlantedBug bugs[] = {
      {"rtl/pixel_pipe.sv", "assign depth_valid = textured_valid && !killed;",
       "assign depth_valid = textured_valid;"},
      {"rtl/pixel_pipe.sv",
       "assign {func, fail, zfail, pass, ref_value, mask, write} = back ? back_side : front_side;",
       "assign {func, fail, zfail, pass, ref_value, mask, write} = {back ? back_side[SideW-1-:12] : "
       "front_side[SideW-1-:12], front_side[23:0]};"},
      {"rtl/pixel_pipe.sv", ".in_func_i(test ? func : 3'b111),", ".in_func_i(func),"},
      {"rtl/pixel_pipe.sv", ".in_write_i(write & {8{test}}),", ".in_write_i(write),"},
      {"rtl/pixel_pipe.sv", "assign fate_write[1] = judged_stencil != stencil_record_stored_o;",
       "assign fate_write[1] = lives;"},
      {"rtl/pixel_pipe.sv", "assign left[3] = judged_valid && judged_ready && !lives;",
       "assign left[3] = judged_valid && judged_ready && 1'b0;"},
      {"rtl/pixel_pipe.sv",
       "assign {alpha_func, alpha_ref, alpha_keeps_zero} = alpha_state[alpha_rest[TextureRestW-1-:SlotW]];",
       "assign {alpha_func, alpha_ref, alpha_keeps_zero} = alpha_state[slot_q];"},
      {"rtl/depth.sv", "assign comes_out = pass || record_keep_o;", "assign comes_out = pass;"},
      {"rtl/depth.sv", "assign {write_mask_o[1], write_stencil_o} = fate[FateW-1-:9];",
       "assign {write_mask_o[1], write_stencil_o} = {write_mask_o[0], fate[FateW-2-:8]};"},
      {"rtl/texture.sv", "alpha_wide >= alpha_least_q[1] && !ref_is_last_3",
       "alpha_wide >= alpha_least_q[1]"},
  };
  Random random(5);
  const PipeCase p = random_pipe_case(random, shipped_config("depth16"), 600, {}, DepthWhen::late);
  expect_seen(bugs, [&] {
    run_pipe(p, {0.1, {0.2, 0.3}, {1, 25}, 5});
    run_pipe(p, {0, {0, 0.8}, {1, 3}, 5});
  });
}

TEST(PixelPipe, PlantedBugsOfWhatComesWithFragmentsAreSeen) {
  constexpr PlantedBug early[] = {
      {"rtl/pixel_pipe.sv", ".in_factor_i(FactorW'(judged_tag))", ".in_factor_i(FactorW'(in_tag))"},
      {"rtl/pixel_pipe.sv", ".in_factor_i(FactorW'(judged_tag))",
       ".in_factor_i(judged_tag[TagW-1-:FactorW])"},
      {"rtl/pixel_pipe.sv", "in_tag[FactorW-1:0] = in_factor_i;", "in_tag[FactorW-1:0] = in_factor_i >> 1;"},
      {"rtl/pixel_pipe.sv", "assign in_line = in_line_i;", "assign in_line = {in_h_i};"},
      {"rtl/pixel_pipe.sv", "assign in_tag[TagW-SlotW-1-:HW] = in_h_i;",
       "assign in_tag[TagW-SlotW-1-:HW] = in_line_i;"},
      {"rtl/pixel_pipe.sv", "((HasLine != 0) ? SlotW : TagW+2*CoordW)", "(TagW+2*CoordW)"},
  };
  constexpr PlantedBug late[] = {
      {"rtl/pixel_pipe.sv", "      textured_tag, textured_rest[0],", "      in_tag, textured_rest[0],"},
      {"rtl/pixel_pipe.sv", "assign back = tested_rest[DepthRestW-TagW-1];",
       "assign back = tested_rest[DepthRestW-SlotW-1];"},
  };
  const auto seen = [](std::span<const PlantedBug> bugs, DepthWhen when) {
    Random random(5);
    const PipeCase p = random_pipe_case(random, channel_config(), 400, {}, when);
    const auto run = [&] { run_pipe(p, {0.1, {0.2, 0.3}, {1, 25}, 5}); };
    run();
    expect_seen(bugs, run);
  };
  seen(early, DepthWhen::early);
  seen(late, DepthWhen::late);
}

TEST(PixelPipe, PlantedBugsOfEquationsAreSeen) {
  constexpr PlantedBug bugs[] = {
      // Where nothing is read, although the result depends on what is stored, 0 stands for it.
      {"rtl/blend_needs.sv", "bitspan_pixel_pkg::BlendOpMin ||", "bitspan_pixel_pkg::BlendOpMin + 8 ||"},
      {"rtl/blend_needs.sv", "BlendFactorDstAlpha ||", "BlendFactorDstAlpha + 16 ||"},
      {"rtl/blend_needs.sv", "BlendFactorSrcAlphaSaturate;", "BlendFactorSrcAlphaSaturate + 16;"},
      {"rtl/blend_needs.sv", "truth[0] != truth[1] ||", "truth[1] != truth[1] ||"},
      {"rtl/blend_needs.sv", "!keeps_alpha && equation_reads(alpha_src_i",
       "(mixes && !mixes) && equation_reads(alpha_src_i"},
      // What reads, although it need not, is a read too many.
      {"rtl/blend_needs.sv", "(!mixes || !keeps_alpha) && equation_reads",
       "(mixes || !mixes) && equation_reads"},
      {"rtl/blend_needs.sv", "!keeps_alpha && equation_reads(alpha_src_i",
       "(mixes || !mixes) && equation_reads(alpha_src_i"},
      {"rtl/blend_needs.sv", "logic_i == '0 && 32'(alpha_src_i)",
       "(logic_i == '0 || mixes) && 32'(alpha_src_i)"},
      {"rtl/pixel_pipe.sv", "equation_state[joined_rest[ZW+:SlotW]];", "equation_state[fogged_slot];"},
      {"rtl/pixel_pipe.sv", "color_mask_state[left_slot[2]];", "color_mask_state[fogged_slot];"},
      {"rtl/pixel_pipe.sv", "= merge_record_valid_o && color_write_has_a_o;",
       "= merge_record_valid_o && (color_write_has_a_o || !color_write_has_a_o);"},
  };
  Config c = shipped_config("depth16");
  c.rtl.blend = RtlBlend::equation;
  Random random(5);
  const PipeCase p = random_pipe_case(random, c, 1500, {.width = 5, .height = 3});
  const auto run = [&] { run_pipe(p, {0.1, {0.2, 0.3}, {1, 25}, 5}); };
  run();
  expect_seen(bugs, run);
}

TEST(PixelPipe, PlantedBugsOfLevelsAreSeen) {
  constexpr PlantedBug of_gradients[] = {
      {"rtl/pixel_pipe.sv", "= lod_state[texture_slot];", "= lod_state[slot_q];"},
      {"rtl/pixel_pipe.sv", "texture_state[levelled_slot]", "texture_state[texture_slot]"},
      {"rtl/pixel_pipe.sv", ".in_h_x_i(h_x),", ".in_h_x_i(h_y),"},
      {"rtl/pixel_pipe.sv", ".in_f_i(share),", ".in_f_i(share >> 1),"},
      {"rtl/pixel_pipe.sv", ".in_level_i(level),", ".in_level_i(level & LevelW'(7)),"},
  };
  constexpr PlantedBug of_zones[] = {
      {"rtl/pixel_pipe.sv", ".a_i(lod_a_i),", ".a_i(~lod_a_i),"},
      {"rtl/pixel_pipe.sv", ".load_place_i(load_k_place_i),", ".load_place_i(~load_k_place_i),"},
  };
  const auto seen = [](std::span<const PlantedBug> bugs, const Config& c, std::uint64_t seed) {
    Random random(seed);
    const PipeCase p = random_pipe_case(random, c, 600, {.textures = {{1, 2}, {4, 8}, {16, 512}}});
    const auto run = [&] { run_pipe(p, {0.1, {0.2, 0.3}, {1, 25}, 5}); };
    run();
    expect_seen(bugs, run);
  };
  seen(of_gradients, level_configs()[2], 5);
  // Scenes whose A' is so small that s is.
  seen(of_zones, level_configs()[1], 6);
}

}  // namespace
}  // namespace bitspan
