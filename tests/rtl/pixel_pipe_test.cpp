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
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/rtl/stage_replay.hpp"
#include "tests/support/files.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// Fragments with one draw state.
struct Batch {
  StageValues draw;
  std::vector<StageValues> fragments;
};

struct PipeCase {
  Config config;
  Scene scene;  // its textures, its background and its size
  std::vector<TexelPlace> places;
  model::Constants constants;
  model::FogStage fog;
  std::vector<Batch> batches;
  std::map<std::string, std::vector<StageValues>> records;  // by tap
  Frame frame;
};

// The ports that a record's fields have, but for `triangle`.
template <class R>
StageValues record_ports(const Config& c, const R& record) {
  StageValues values;
  const auto raw = raw_values(record);
  for (std::size_t i = 1; i < raw.size(); ++i) {
    values.push_back(Rtl::to_port(raw[i], port_format(fields<R>[i], c).word));
  }
  return values;
}

std::uint32_t clear_code(const Config& c) {
  return nearer_is_larger(c.depth_code) ? 0 : (std::uint32_t{1} << c.depth_bits) - 1;
}

// The RTL repeats textures whose sizes are powers of two: others are continued up to one.
void continue_textures(Scene& scene) {
  for (Texture& t : scene.textures) {
    const auto up = [](int size) { return static_cast<int>(std::bit_ceil(static_cast<unsigned>(size))); };
    Texture made{t.name, up(t.width), up(t.height), {}};
    for (int row = 0; row < made.height; ++row) {
      for (int column = 0; column < made.width; ++column) {
        const auto from = t.rgba.begin() + 4 * (row % t.height * t.width + column % t.width);
        made.rgba.insert(made.rgba.end(), from, from + 4);
      }
    }
    t = std::move(made);
  }
}

PipeCase make_case(const Config& c, const Scene& given) {
  PipeCase p;
  p.config = c;
  p.scene = given;
  if (!clamps_to_border(c.wrap)) continue_textures(p.scene);
  const Scene& scene = p.scene;
  p.places = place_textures(p.scene);
  p.constants = model::make_constants(c, scene);
  p.fog = model::prepare_fog(c, p.constants, scene);
  const auto model = make_model(c);
  Trace trace;
  model->begin(scene);
  model->draw(scene.triangles, 0, &trace);
  p.frame = model->frame();
  std::int64_t before = -1;
  for (const FragmentRecord& f : trace.fragment) {
    if (f.covered == 0) continue;
    if (f.triangle != before) {
      const int texture = scene.triangles[static_cast<std::size_t>(f.triangle)].texture;
      const DrawState state{.func = c.depth_func,
                            .textured = texture >= 0,
                            .filter = c.filter,
                            .wrap = c.wrap,
                            .place = texture < 0 ? TexelPlace{} : p.places[static_cast<std::size_t>(texture)],
                            .transparent = c.transparent,
                            .fog = p.fog.mode,
                            .fog_color = p.fog.fog_color};
      const StageValues draw = draw_values(state);
      if (p.batches.empty() || p.batches.back().draw != draw) p.batches.push_back({draw, {}});
      before = f.triangle;
    }
    p.batches.back().fragments.push_back(fragment_values(c, f));
  }
  const auto add = [&](const char* tap, const auto& records) {
    for (const auto& r : records) p.records[tap].push_back(record_ports(c, r));
  };
  add("depth_record", trace.depth);
  add("texture_record", trace.texture);
  add("fog_record", trace.fog);
  add("merge_record", trace.merge);
  return p;
}

// With a texture's number, or -1.
std::pair<DrawState, int> random_state(Random& random, const PipeCase& p) {
  const auto chance = [&](int percent) { return static_cast<int>(random() % 100) < percent; };
  DrawState s;
  s.func = static_cast<DepthFunc>(random() % enum_names<DepthFunc>.size());
  const int texture = static_cast<int>(random() % (p.scene.textures.size() + 1)) - 1;
  s.textured = texture >= 0;
  if (s.textured) s.place = p.places[static_cast<std::size_t>(texture)];
  s.filter = chance(50) ? TextureFilter::nearest : TextureFilter::bilinear;
  s.wrap = chance(50) ? TextureWrap::cyclic : TextureWrap::clamp;
  if (chance(50)) s.transparent = std::array<std::uint8_t, 3>{255, 0, 255};
  s.fog = chance(30)                                          ? FogMode::none
          : is_linear_in_distance(p.config.fog) && chance(50) ? FogMode::linear
                                                              : FogMode::table;
  for (auto& channel : s.fog_color) channel = static_cast<std::uint8_t>(random());
  s.write_z = chance(80);
  s.blend = chance(70);
  s.write_color = chance(90);
  return {s, texture};
}

// The picture, the textures, and an address in front of theirs.
struct Extent {
  int width = 12, height = 7;
  std::vector<std::pair<int, int>> textures{{1, 2}, {4, 8}, {16, 32}};
  std::uint64_t address = 0;
};

// Raw fragments, a new draw state for every few of them, through the model's stages one after another.
PipeCase random_case(Random& random, const Config& c, int batches, const Extent& extent = {}) {
  PipeCase p;
  p.config = c;
  p.scene.width = extent.width;
  p.scene.height = extent.height;
  p.scene.background = {10, 20, 30};
  for (const auto& [width, height] : extent.textures) {
    Texture t{"t", width, height, {}};
    for (int i = 0; i < width * height; ++i) {
      const bool hole = random() % 8 == 0;
      for (int channel = 0; channel < 4; ++channel) {
        t.rgba.push_back(hole && channel < 3 ? (channel == 1 ? 0 : 255)
                                             : static_cast<std::uint8_t>(random()));
      }
    }
    p.scene.textures.push_back(t);
  }
  p.places = place_textures(p.scene, extent.address);
  ConstantsRecord& k = p.constants.record;
  k.b = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_b)));
  k.c1 = is_linear_in_distance(c.depth_code) ? random_raw(random, c.format(FormatId::depth_c1)) : 0;
  k.c0 = is_linear_in_distance(c.depth_code) ? random_raw(random, c.format(FormatId::depth_c0)) : 0;
  k.fog_scale = random_raw(random, c.format(FormatId::fog_scale));
  model::DepthStage depth = model::prepare_depth(c, p.constants);
  model::TextureStage texture = model::prepare_texture(c);
  p.fog = model::prepare_fog(c, p.constants, p.scene);
  p.fog.scale.raw = k.fog_scale;
  p.fog.table.resize(std::size_t{1} << c.fog_index_bits());
  for (std::int64_t& entry : p.fog.table) entry = random_raw(random, c.format(FormatId::fog_factor));
  const model::MergeStage merge = model::prepare_merge(c);
  clear_frame(p.frame, p.scene.width, p.scene.height, p.scene.background, clear_code(c), false);
  const std::int64_t one = std::int64_t{1} << c.format(FormatId::texture_alpha).fraction();
  for (int batch = 0; batch < batches; ++batch) {
    const auto [s, number] = random_state(random, p);
    p.batches.push_back({draw_values(s), {}});
    depth.func = s.func;
    texture.filter = s.filter;
    texture.wrap = s.wrap;
    texture.transparent = s.transparent;
    p.fog.mode = s.fog;
    p.fog.fog_color = s.fog_color;
    for (std::uint64_t n = random() % 6; n > 0; --n) {
      FragmentRecord f;
      f.x = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(p.scene.width));
      f.y = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(p.scene.height));
      f.h = random_raw(random, c.format(FormatId::span_h));
      for (std::int64_t* uv : {&f.u, &f.v}) *uv = random_raw(random, c.format(FormatId::span_uv));
      for (std::int64_t* v : {&f.r, &f.g, &f.b, &f.a})
        *v = random_raw(random, c.format(FormatId::span_shade));
      p.batches.back().fragments.push_back(fragment_values(c, f));
      const std::size_t at = pixel_of(p.frame, f);
      DepthRecord d;
      TextureRecord t;
      FogRecord mist;
      MergeRecord m;
      const bool pass = model::depth(depth, f, p.frame.depth[at], d);
      p.records["depth_record"].push_back(record_ports(c, d));
      if (!pass) continue;
      const Texture* image = number < 0 ? nullptr : &p.scene.textures[static_cast<std::size_t>(number)];
      const bool lives = model::texture(texture, image, f, t);
      p.records["texture_record"].push_back(record_ports(c, t));
      if (!lives) continue;
      model::fog(p.fog, f, t, mist);
      p.records["fog_record"].push_back(record_ports(c, mist));
      if (!s.blend) t.a = one;
      std::uint8_t* color = p.frame.color.data() + 4 * at;
      model::merge(merge, d, t, mist, {color[0], color[1], color[2]}, m);
      p.records["merge_record"].push_back(record_ports(c, m));
      if (s.write_z) p.frame.depth[at] = static_cast<std::uint32_t>(d.z);
      if (!s.write_color) continue;
      color[0] = static_cast<std::uint8_t>(m.r);
      color[1] = static_cast<std::uint8_t>(m.g);
      color[2] = static_cast<std::uint8_t>(m.b);
    }
  }
  return p;
}

void load_frame_state(StageBench& bench, const PipeCase& p) {
  const StageDesign design = pixel_pipe_design(p.config);
  const StageValues values = frame_values(p.config, p.constants.record, p.scene);
  for (std::size_t i = 0; i < values.size(); ++i) bench.set_constant(design.constants[i], values[i]);
  for (const FogLoad& load : fog_loads(p.config, p.fog)) {
    bench.set_constant("load", 1);
    bench.set_constant("load_threshold", load.threshold ? 1 : 0);
    bench.set_constant("load_place", load.place);
    bench.set_constant("load_data", load.data);
    bench.clock();
  }
  bench.set_constant("load", 0);
}

std::uint64_t texel_of(const PipeCase& p, std::uint64_t address) {
  const std::optional<std::uint32_t> texel = texel_at(p.scene, p.places, address);
  if (!texel) throw std::logic_error(fmt::format("address {} holds no texel", address));
  return *texel;
}

struct Way {
  double in_gap = 0;
  StageStalls stalls;
  StageMemory::Latency latency;
  std::uint64_t seed = 1;
  int reset_after = 0;  // clocks of the same fragments in front, then a reset
};

struct PipeRun {
  std::size_t compared = 0;
  std::uint64_t clocks = 0;  // from the first draw state's offer to the last record
};

// Throws std::logic_error where anything differs.
PipeRun run_pipe(const PipeCase& p, const Way& way, StageTrace* trace = nullptr) {
  const Config& c = p.config;
  StageBench bench(pixel_pipe_design(c), way.seed);
  if (trace != nullptr) bench.keep_trace(*trace);
  await_sweep(bench, c);
  load_frame_state(bench, p);
  bench.set_stalls(way.stalls);
  bench.set_stalls("in", {way.in_gap, 0});
  StageMemory z(bench, "z_request", "z_answer", "z_write", 2, way.latency, way.seed,
                [&](const StageMemory::Address&) { return StageValues{clear_code(c)}; });
  StageMemory color(bench, "color_request", "color_answer", "color_write", 2, way.latency, way.seed,
                    [&](const StageMemory::Address&) {
                      const auto& b = p.scene.background;
                      return StageValues{b[0], b[1], b[2]};
                    });
  std::deque<StageMemory> texels;
  for (int port = 0; port < 4; ++port) {
    texels.emplace_back(bench, fmt::format("texel{}_request", port), fmt::format("texel{}_answer", port), "",
                        1, way.latency, way.seed + static_cast<std::uint64_t>(port),
                        [&](const StageMemory::Address& at) { return StageValues{texel_of(p, at[0])}; });
  }
  if (way.reset_after > 0) {
    bench.send("draw", p.batches.front().draw);
    while (bench.waiting("draw") > 0) bench.clock();
    for (const Batch& batch : p.batches) {
      for (const StageValues& fragment : batch.fragments) bench.send("in", fragment);
    }
    for (int i = 0; i < way.reset_after; ++i) bench.clock();
    bench.reset();
    for (StageMemory* memory : {&z, &color}) memory->forget();
    await_sweep(bench, c);
  }
  PipeRun run;
  std::size_t expected = 0;
  std::size_t arrived = 0;
  std::map<std::string, std::size_t> next;
  for (const auto& [tap, records] : p.records) {
    expected += records.size();
    bench.on_transfer(tap, [&, name = tap, &wanted = records](const StageValues& v) {
      const std::size_t i = next[name]++;
      if (i >= wanted.size()) throw std::logic_error(name + ": a record after the last");
      if (v != wanted[i]) {
        throw std::logic_error(
            fmt::format("{} {} is {}, expected {}", name, i, fmt::join(v, " "), fmt::join(wanted[i], " ")));
      }
      ++arrived;
      run.compared += v.size();
    });
  }
  const std::uint64_t begin = bench.clocks();
  std::size_t batch = 0;
  bool drawn = false;  // the batch's draw state is under way or taken
  bench.run_until([&] {
    run.clocks = bench.clocks() - begin;
    if (batch < p.batches.size() && bench.waiting("in") == 0) {
      if (!drawn) {
        bench.send("draw", p.batches[batch].draw);
        drawn = true;
      } else if (bench.waiting("draw") == 0) {
        for (const StageValues& fragment : p.batches[batch].fragments) bench.send("in", fragment);
        ++batch;
        drawn = false;
      }
    }
    return batch == p.batches.size() && arrived == expected;
  });
  if (arrived != expected) throw std::logic_error("a record after the last");
  if (bench.level("idle") != 1) throw std::logic_error("the pipe is not idle");
  for (int y = 0; y < p.frame.height; ++y) {
    for (int x = 0; x < p.frame.width; ++x) {
      const auto at = static_cast<std::size_t>(y * p.frame.width + x);
      const StageMemory::Address address{static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)};
      const std::uint8_t* wanted = p.frame.color.data() + 4 * at;
      if (z.at(address) != StageValues{p.frame.depth[at]} ||
          color.at(address) != StageValues{wanted[0], wanted[1], wanted[2]}) {
        throw std::logic_error(fmt::format("pixel {}, {} differs", x, y));
      }
      run.compared += 4;
    }
  }
  return run;
}

TEST(PixelPipe, TheDemo) {
  for (Config c : shipped_configs()) {
    const PipeCase p = make_case(c, demo_scene(128, 96));
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
    const PipeCase p = make_case(c, scene);
    SCOPED_TRACE(seed);
    EXPECT_GT(run_pipe(p, {0, {0.1, 0.2}, {1, 12}, seed++}).compared, 100000U);
  }
}

// A new draw state for every few fragments, any raw values, any configuration.
TEST(PixelPipe, RandomDrawStates) {
  const auto check = [](const Config& c, std::uint64_t seed) {
    Random random(seed);
    const PipeCase p = random_case(random, c, 400);
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
      const PipeCase p = random_case(
          random, c, 100, {width, height, {{1, 1}, {16384, 2}, {2, 16384}, {128, 64}}, random() >> 33});
      run_pipe(p, {0.1, {0.1, 0.1}, {1, 9}, 5});
    }
  }
}

TEST(PixelPipe, ResetAmidFragments) {
  Random random(31);
  const PipeCase p = random_case(random, shipped_config("depth16"), 100);
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
    const PipeCase p = make_case(c, scene);
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
    const PipeCase p = random_case(random, c, 40);
    StageTrace trace;
    run_pipe(p, {0.2, {0.2, 0.3}, {1, 9}, 4}, &trace);
    const StageDesign design = pixel_pipe_design(c);
    const std::size_t compared = replay_under_icarus(design, trace, pixel_sources(), true);
    EXPECT_GT(compared, trace.outputs.size() * 10);
    const TemporaryFolder folder;
    std::string script = "read_verilog -sv -DSYNTHESIS " + folder.write("package.sv", design.package);
    for (const auto& source : pixel_sources()) script += " " + source.string();
    const std::string netlist = folder.path("netlist.v");
    script +=
        "; hierarchy -check -top pixel_pipe; prep -flatten -top pixel_pipe; check -assert; memory_map; "
        "write_verilog -noattr " +
        netlist;
    const auto log = folder.path("yosys.log");
    ASSERT_EQ(run_program({"yosys", "-q", "-p", script}, log, "this test"), 0)
        << read_file(log) << to_toml(c);
    EXPECT_EQ(replay_under_icarus(design, trace, {netlist}, false), compared);
    // The replay can fail.
    auto& clock = trace.outputs[5];
    clock.back() ^= 1;
    EXPECT_THROW(replay_under_icarus(design, trace, {netlist}, false), std::runtime_error);
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
  const PipeCase p = random_case(random, shipped_config("depth16"), 400);
  run_pipe(p, {0.1, {0.2, 0.3}, {1, 25}, 5});
  expect_seen(bugs, [&] { run_pipe(p, {0.1, {0.2, 0.3}, {1, 25}, 5}); });
}

}  // namespace
}  // namespace bitspan
