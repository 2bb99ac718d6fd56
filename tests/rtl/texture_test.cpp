// SPDX-License-Identifier: Apache-2.0
// rtl/texture.sv against the model's stage: shipped and random configurations, every draw state, gaps, stalls
// and latencies of the texels.
#include "model/stages/texture.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <deque>
#include <optional>
#include <vector>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "model/mip_chain.hpp"
#include "model/numeric/compare.hpp"
#include "model/timed/pixel_chain_timing.hpp"
#include "tb/rtl_pixels.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

const std::vector<std::string> inputs = {"u",     "v",        "r",           "g",        "b",      "a",
                                         "rest",  "textured", "bilinear",    "clamp",    "last_i", "last_j",
                                         "pitch", "base",     "transparent", "reserved", "level",  "f"};
const std::vector<std::string> outputs = {"i",       "j", "ex", "ey", "texel_r", "texel_g", "texel_b",
                                          "texel_a", "r", "g",  "b",  "a",       "killed",  "rest"};

StageDesign design(const Config& config) {
  StageDesign d{config.name, "texture", emit_pixel_sv(config), {}, {}, {}};
  d.channels.push_back({ChannelKind::in, "in", inputs});
  for (int port = 0; port < texel_ports; ++port) {
    d.channels.push_back({ChannelKind::out, fmt::format("request{}", port), {"address"}});
    d.channels.push_back({ChannelKind::in, fmt::format("answer{}", port), {"texel"}});
  }
  d.channels.push_back({ChannelKind::out, "out", outputs});
  d.constants = {"alpha_func", "alpha_ref", "alpha_keeps_zero"};
  return d;
}

int between(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}
bool chance(Random& random, double p) { return std::bernoulli_distribution(p)(random); }

// A texture as the stage's memory holds it; with levels, its chain.
struct Placed {
  Texture texture;
  std::uint64_t pitch = 0, base = 0;
  model::MipChain chain{};

  // Behind the base and the last texel.
  std::uint64_t end() const {
    return base + ((chain.empty() ? 1U : 2U) * static_cast<std::uint64_t>(texture.height) << pitch);
  }
};

bool is_cyclic(const Texture& t) {
  return std::has_single_bit(static_cast<unsigned>(t.width)) &&
         std::has_single_bit(static_cast<unsigned>(t.height));
}

// Half the texels are of few colours, among them the reserved one.
Placed random_texture(Random& random, int width, int height, std::uint64_t after,
                      const std::array<std::uint8_t, 3>& reserved, bool has_levels) {
  Placed p{{"t", width, height, {}}, 0, 0};
  for (int texel = 0; texel < width * height; ++texel) {
    const bool hole = chance(random, 0.2);
    const bool plain = chance(random, 0.3);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto any = static_cast<std::uint8_t>(random());
      p.texture.rgba.push_back(hole ? reserved[c] : plain ? static_cast<std::uint8_t>(any % 2 * 255) : any);
    }
    // A texel that misses the reserved colour by one bit.
    if (hole && chance(random, 0.3)) {
      std::uint8_t& channel = p.texture.rgba[p.texture.rgba.size() - 3 + random() % 3];
      channel = static_cast<std::uint8_t>(channel ^ 1U << random() % 8);
    }
    const int kind = between(random, 0, 3);
    p.texture.rgba.push_back(kind == 0 ? 255 : kind == 1 ? 0 : static_cast<std::uint8_t>(random()));
  }
  p.pitch = static_cast<std::uint64_t>(std::bit_width(static_cast<unsigned>(width - 1)));
  if (has_levels) {
    // Levels that are no means of each other, with reserved texels in each.
    p.chain = model::make_mip_chain(p.texture);
    for (std::size_t l = 1; l < p.chain.size(); ++l) {
      p.chain[l] = random_texture(random, p.chain[l].width, p.chain[l].height, 0, reserved, false).texture;
    }
  } else {
    p.pitch += random() % 2;
  }
  p.base = ((after >> p.pitch) + 1 + random() % 5) << p.pitch;
  return p;
}

std::vector<Placed> random_textures(Random& random, const std::array<std::uint8_t, 3>& reserved,
                                    bool has_levels) {
  std::vector<Placed> all;
  std::uint64_t after = 0;
  const std::pair<int, int> sizes[] = {
      {1, 1},   {2, 1},   {1, 8},    {4, 4},    {16, 8},
      {64, 32}, {3, 5},   {7, 1},    {1, 3},    {33, 9},
      {100, 3}, {256, 2}, {1000, 1}, {1, 1024}, {between(random, 1, 40), between(random, 1, 40)}};
  for (const auto& [width, height] : sizes) {
    if (has_levels && !is_cyclic({"", width, height, {}})) continue;
    all.push_back(random_texture(random, width, height, after, reserved, has_levels));
    after = all.back().end();
  }
  return all;
}

// What lies at an address; anything but a texel is an error.
std::uint64_t texel_at(const std::vector<Placed>& textures, std::uint64_t address) {
  for (const Placed& p : textures) {
    if (address < p.base || address >= p.end()) continue;
    for (const Texture& level : p.chain) {
      const auto width = static_cast<std::uint64_t>(level.width);
      const std::uint64_t begin = p.base + width * static_cast<std::uint64_t>(level.height);
      if (address < begin || address - begin >= begin - p.base) continue;
      return texel_word(level, static_cast<std::int64_t>((address - begin) % width),
                        static_cast<std::int64_t>((address - begin) / width));
    }
    if (!p.chain.empty()) break;
    const std::uint64_t i = (address - p.base) & ((std::uint64_t{1} << p.pitch) - 1);
    const std::uint64_t j = (address - p.base) >> p.pitch;
    if (i >= static_cast<std::uint64_t>(p.texture.width) || j >= static_cast<std::uint64_t>(p.texture.height))
      continue;
    const std::uint8_t* t = p.texture.rgba.data() + 4 * (j * static_cast<std::uint64_t>(p.texture.width) + i);
    return t[0] | std::uint64_t{t[1]} << 8 | std::uint64_t{t[2]} << 16 | std::uint64_t{t[3]} << 24;
  }
  throw std::logic_error(fmt::format("address {} holds no texel", address));
}

// Anywhere in the format, or in and around the texture, on borders between texels and halfway.
std::int64_t random_coordinate(Random& random, const Format& f, int size) {
  if (chance(random, 0.2)) return random_raw(random, f);
  double texels = std::uniform_real_distribution<double>(-2.0 * size - 2, 3.0 * size + 2)(random);
  if (chance(random, 0.3)) texels = std::floor(texels * 2) / 2;
  const double lowest = f.is_signed ? -std::ldexp(1.0, f.word - 1) : 0;
  const double highest = std::ldexp(1.0, std::min(f.is_signed ? f.word - 1 : f.word, 62)) - 1;
  return static_cast<std::int64_t>(std::clamp(std::floor(std::ldexp(texels, f.fraction())), lowest, highest));
}

struct Case {
  Config config;
  model::TextureStage stage;
  std::vector<Placed> textures;
  std::array<std::uint8_t, 3> reserved{};

  Case(const Config& c, Random& random) : config(c), stage(model::prepare_texture(c)) {
    for (auto& channel : reserved) channel = static_cast<std::uint8_t>(random());
    textures = random_textures(random, reserved, has_levels_in_rtl(c));
  }
};

std::uint64_t port(std::int64_t raw, const Format& f) { return Rtl::to_port(raw, f.word); }

// A fragment in, and the record that must come out.
struct Given {
  StageValues in, out;
};

// `plain`: nearest texels of a cyclic texture alone.
Given random_fragment(Random& random, Case& t, std::uint64_t number, bool plain) {
  const Config& c = t.config;
  const Format& uv = c.format(FormatId::span_uv);
  const Format& shade = c.format(shade_factor(c));
  const Placed& placed = t.textures[plain ? 5 : random() % t.textures.size()];
  const bool textured = plain || chance(random, 0.9);
  const auto wrap = [&] {
    return plain || (is_cyclic(placed.texture) && chance(random, 0.5)) ? TextureWrap::cyclic
                                                                       : TextureWrap::clamp;
  };
  t.stage.lookup.filter = !plain && chance(random, 0.6) ? TextureFilter::bilinear : TextureFilter::nearest;
  t.stage.lookup.wrap_u = wrap();
  t.stage.lookup.wrap_v = wrap();
  t.stage.magnified = t.stage.lookup;
  t.stage.transparent = chance(random, 0.7) ? Color(t.reserved) : std::nullopt;
  FragmentRecord f;
  f.u = random_coordinate(random, uv, placed.texture.width);
  f.v = random_coordinate(random, uv, placed.texture.height);
  for (std::int64_t* s : {&f.r, &f.g, &f.b, &f.a}) *s = random_raw(random, shade);
  // Without a texture, alpha is then halfway between the codes 127 and 128, and takes the upper one.
  if (chance(random, 0.3)) f.a = half_of(shade).value_or(f.a);
  TextureRecord r;
  LodRecord lod;
  if (textured && !placed.chain.empty()) {
    const auto last = static_cast<std::int64_t>(placed.chain.size()) - 1;
    lod.level = between(random, 0, static_cast<int>(last));
    if (mixes_levels(c.mip) && lod.level < last && chance(random, 0.7)) {
      lod.f = random_raw(random, c.format(FormatId::lod_frac));
    }
  }
  if (has_levels_in_rtl(c)) {
    model::texture(t.stage, textured ? &placed.chain : nullptr, f, lod, r);
  } else {
    model::texture(t.stage, textured ? &placed.texture : nullptr, f, r);
  }
  const auto bit = [](bool b) { return std::uint64_t{b}; };
  Given g;
  g.in = {port(f.u, uv),
          port(f.v, uv),
          port(f.r, shade),
          port(f.g, shade),
          port(f.b, shade),
          port(f.a, shade),
          number,
          bit(textured),
          bit(t.stage.lookup.filter == TextureFilter::bilinear),
          bit(t.stage.lookup.wrap_u == TextureWrap::clamp) | bit(t.stage.lookup.wrap_v == TextureWrap::clamp)
                                                                 << 1,
          static_cast<std::uint64_t>(placed.texture.width - 1),
          static_cast<std::uint64_t>(placed.texture.height - 1),
          placed.pitch,
          placed.base,
          bit(t.stage.transparent.has_value()),
          t.reserved[0] | std::uint64_t{t.reserved[1]} << 8 | std::uint64_t{t.reserved[2]} << 16,
          static_cast<std::uint64_t>(lod.level),
          static_cast<std::uint64_t>(lod.f)};
  const auto out = [&](std::int64_t raw, FormatId id) { g.out.push_back(port(raw, c.format(id))); };
  g.out = {static_cast<std::uint64_t>(r.i), static_cast<std::uint64_t>(r.j)};
  out(r.ex, FormatId::texture_frac);
  out(r.ey, FormatId::texture_frac);
  out(r.texel_r, FormatId::texture_mix);
  out(r.texel_g, FormatId::texture_mix);
  out(r.texel_b, FormatId::texture_mix);
  out(r.texel_a, FormatId::texture_alpha);
  out(r.r, FormatId::texture_color);
  out(r.g, FormatId::texture_color);
  out(r.b, FormatId::texture_color);
  out(r.a, FormatId::texture_alpha);
  g.out.push_back(static_cast<std::uint64_t>(r.killed));
  g.out.push_back(number);
  return g;
}

struct Conditions {
  StageStalls stalls;
  StageMemory::Latency latency;
  bool plain = false;
  int reset_after = 0;  // clocks of other fragments in front, then a reset
  CompareFunc alpha_func = CompareFunc::always;
  int alpha_ref = 0;
  bool keeps_zero = false;
};

struct Outcome {
  std::size_t fragments = 0, values = 0, killed = 0;
  std::uint64_t clocks = 0;  // from the first fragment's offer to the last one's delivery
  std::size_t most_in_flight = 0;
};

// Sends `count` fragments and compares what comes out; throws where something is lost, doubled or after the
// last.
Outcome run(Case& t, Random& random, int count, const Conditions& conditions) {
  StageBench bench(design(t.config), random());
  bench.set_stalls(conditions.stalls);
  t.stage.alpha_test = model::alpha_test_of(conditions.alpha_func, conditions.alpha_ref, t.stage.alpha);
  // Bits: less, equal, greater.
  const auto passes = [&](int code) {
    return std::uint64_t{model::compares(conditions.alpha_func, code, 1)};
  };
  bench.set_constant("alpha_func", passes(0) | passes(1) << 1 | passes(2) << 2);
  bench.set_constant("alpha_ref", static_cast<std::uint64_t>(conditions.alpha_ref));
  t.stage.kills_zero = !conditions.keeps_zero;
  bench.set_constant("alpha_keeps_zero", conditions.keeps_zero ? 1 : 0);
  std::deque<StageMemory> memories;
  for (int p = 0; p < texel_ports; ++p) {
    memories.emplace_back(
        bench, fmt::format("request{}", p), fmt::format("answer{}", p), "", 1, conditions.latency, random(),
        [&t](const StageMemory::Address& a) { return StageValues{texel_at(t.textures, a[0])}; });
  }
  if (conditions.reset_after > 0) {
    for (int n = 0; n < conditions.reset_after; ++n)
      bench.send("in", random_fragment(random, t, 0, false).in);
    for (int n = 0; n < conditions.reset_after; ++n) bench.clock();
    bench.reset();
  }
  std::vector<Given> given;
  for (int n = 0; n < count; ++n) {
    given.push_back(random_fragment(random, t, static_cast<std::uint64_t>(n) * 0x9e3779b1 & 0xffffffff,
                                    conditions.plain));
    bench.send("in", given.back().in);
  }
  Outcome r;
  bench.on_transfer("out", [&](const StageValues& v) {
    if (r.fragments == given.size()) throw std::logic_error("a fragment after the last");
    const Given& g = given[r.fragments];
    for (std::size_t k = 0; k < v.size(); ++k) {
      if (v[k] == g.out[k]) continue;
      std::string text;
      for (std::size_t m = 0; m < inputs.size(); ++m) text += fmt::format(" {} {:#x}", inputs[m], g.in[m]);
      throw std::logic_error(fmt::format("fragment {}: {} is {:#x}, expected {:#x};{}\n{}", r.fragments,
                                         outputs[k], v[k], g.out[k], text, to_toml(t.config)));
    }
    ++r.fragments;
    r.values += v.size();
    r.killed += v[12];
    r.clocks = bench.clocks();
  });
  bench.run_until([&] { return r.fragments == given.size(); });
  for (const StageMemory& m : memories) r.most_in_flight = std::max(r.most_in_flight, m.most_in_flight());
  return r;
}

// may_kill_all: the alphas of a random configuration may round to 0.
void check(const Config& config, std::uint64_t seed, int count, bool may_kill_all = false) {
  SCOPED_TRACE(fmt::format("{}, seed {}", config.name, seed));
  Random random(seed);
  Case t(config, random);
  const Conditions conditions[] = {
      {{0, 0}, {1, 1}},
      {{0.3, 0}, {1, 4}, false, 0, CompareFunc::greater_equal, 128},
      {{0, 0.4}, {20, 20}, false, 0, CompareFunc::less, 200},
      {{0.2, 0.2}, {1, 40}, false, 0, CompareFunc::not_equal, 255},
      {{0.1, 0.1}, {1, 10}, false, 0, CompareFunc::less, 200, true},
  };
  for (const Conditions& c : conditions) {
    const Outcome r = run(t, random, count, c);
    EXPECT_GT(r.killed, static_cast<std::size_t>(count) / 50);
    // An alpha test may kill all of them.
    const int living = c.alpha_func == CompareFunc::always && !may_kill_all ? count / 50 : 0;
    EXPECT_LE(r.killed, static_cast<std::size_t>(count - living));
    EXPECT_GE(r.most_in_flight, c.latency.least >= 20 ? 8U : 1U);
  }
}

TEST(Texture, Shipped) {
  for (const Config& config : shipped_configs()) check(config, 11, 4000);
}

Config levels_config(const std::string& name, MipMode mip) {
  Config c = shipped_config(name);
  c.mip = mip;
  c.lod = LodMode::none;
  return c;
}

TEST(Texture, Levels) {
  for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
    for (const std::string& name : shipped_names) {
      SCOPED_TRACE(to_string(mip));
      check(levels_config(name, mip), 11, 4000);
    }
  }
}

TEST(Texture, Random) {
  for (const std::uint64_t seed : stage_seeds(6)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check(random_stage_config(seed), seed, 1500, true);
  }
}

// One fragment per clock, and the latency that config/pixel_timing says.
TEST(Texture, Clocks) {
  const auto clocks = [](const Config& config, bool plain) {
    const TextureTiming timing = pixel_timing(config).texture;
    Random random(5);
    Case t(config, random);
    const Outcome one = run(t, random, 1, {{0, 0}, {1, 1}, plain});
    EXPECT_EQ(one.clocks, static_cast<std::uint64_t>(timing.total) + 1);
    for (const int latency : {1, 20}) {
      const Outcome many = run(t, random, 2000, {{0, 0}, {latency, latency}, plain});
      EXPECT_EQ(many.clocks, static_cast<std::uint64_t>(timing.total + latency - 1) + 2000) << latency;
    }
  };
  for (const bool plain : {true, false}) {
    clocks(shipped_config("depth16"), plain);
    for (const MipMode mip : {MipMode::nearest, MipMode::linear})
      clocks(levels_config("depth16", mip), plain);
  }
}

TEST(Texture, ResetAmidFragments) {
  Random random(7);
  Case t(shipped_config("narrow"), random);
  for (const int clocks : {3, 12, 40, 200}) {
    EXPECT_EQ(run(t, random, 300, {{0.2, 0.3}, {1, 9}, false, clocks}).fragments, 300U) << clocks;
  }
}

TEST(Texture, RefusesCyclicSizesThatAreNoPowersOfTwo) {
  Random random(3);
  Case t(shipped_config("narrow"), random);
  for (const char* axis : {"last_i", "last_j"}) {
    StageBench bench(design(t.config), 1);
    bench.set_constant("alpha_func", 7);
    Given g = random_fragment(random, t, 0, true);
    g.in[static_cast<std::size_t>(std::ranges::find(inputs, axis) - inputs.begin())] = 4;
    bench.send("in", g.in);
    try {
      for (int i = 0; i < 10; ++i) bench.clock();
      ADD_FAILURE() << "a cyclic texture of 5 texels was taken";
    } catch (const std::logic_error& e) {
      EXPECT_NE(std::string(e.what()).find("cyclic"), std::string::npos) << e.what();
    }
  }
}

TEST(Texture, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/texture_address.sv", "clamp_1[axis] && whole >= ", "clamp_1[axis] && whole > 1 + "},
      {"rtl/texture_address.sv", "cyclic_2 <= !clamp_1[axis];", "cyclic_2 <= !clamp_1[0];"},
      {"rtl/texture_address.sv", "quad_1 && low_1[Grid-1]", "quad_1 && !low_1[Grid-1]"},
      {"rtl/texture.sv", "asked_q | (request_valid & request_ready)",
       "request_valid & request_ready & ~wanted"},
      {"rtl/texture.sv", "assign skid_taken = {Ports{join_taken}} & awaited;",
       "assign skid_taken = {Ports{join_valid}} & awaited;"},
      {"rtl/texture_words.sv", "hole_o <= reserved_2[upper_2];", "hole_o <= reserved_2[0];"},
      {"rtl/texture_words.sv", "reserved_2[p] ? alpha_2[4] : alpha_2[p]",
       "reserved_2[p] ? alpha_2[p] : alpha_2[p]"},
      {"rtl/texture.sv", "assign in_ready_o = address_en && held_ready;", "assign in_ready_o = address_en;"},
      {"rtl/texture_filter.sv", ".a_i(row[0+:OutW]),", ".a_i(row[OutW+:OutW]),"},
      {"rtl/blend.sv", "DiffW'(b) - DiffW'(a)", "DiffW'(b) - DiffW'(a) + 1"},
      {"rtl/ring_line.sv", "localparam int Places = Depth - 1;", "localparam int Places = Depth;"},
  };
  Random random(5);
  Case t(shipped_config("depth16"), random);
  const Conditions conditions{{0.2, 0.4}, {1, 60}};
  run(t, random, 1000, conditions);
  expect_seen(bugs, [&] { run(t, random, 1000, conditions); });

  constexpr PlantedBug alpha_bugs[] = {
      {"rtl/texture.sv", "assign reaches_ref = alpha_wide >= alpha_least_q[0];",
       "assign reaches_ref = alpha_wide > alpha_least_q[0];"},
      {"rtl/texture.sv", "assign odd_1 = {alpha_ref_1, 1'b0} - 9'd1;", "assign odd_1 = {alpha_ref_1, 1'b0};"},
      {"rtl/texture.sv", "assign byte_1 = odd_1[7:0] + {7'd0, whole_1};", "assign byte_1 = odd_1[7:0];"},
      {"rtl/texture.sv", "<= ref_is_zero_2 ? -below_wide : least_2;", "<= 1'b0 ? -below_wide : least_2;"},
      {"rtl/texture.sv", "(alpha_q == '0 && !keeps_zero_3)", "(alpha_q == '0 && keeps_zero_3)"},
  };
  const auto test_alpha = [&] {
    for (const int ref : {128, 200, 0}) {
      run(t, random, 1000, {{0.2, 0.4}, {1, 60}, false, 0, CompareFunc::greater_equal, ref});
    }
  };
  test_alpha();
  expect_seen(alpha_bugs, test_alpha);
}

TEST(Texture, PlantedBugsOfLevelsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/texture_address.sv", "<<< {~halved[LevelW-1:2], 2'b00};", "<<< {2'b11, 2'b00};"},
      {"rtl/texture_address.sv", "low_a <<< ~halved_a;", "low_a <<< halved_a;"},
      {"rtl/texture_address.sv", "last_b <= last_a >> halved_a;", "last_b <= last_a >> (halved_a & 2'b01);"},
      {"rtl/texture_address.sv", "Deep'(own_last) & ~", "Deep'({IndexW{1'b1}}) & ~"},
      {"rtl/texture_address.sv", "Deep'(own_last) & ~", "Deep'((axis == 0) ? last_j_i : last_i_i) & ~"},
      {"rtl/texture_address.sv", "(k + 1) % (1 << b)", "k % (1 << b)"},
      {"rtl/texture_address.sv", "pitch_i - PitchW'(level_i) : '0;", "pitch_i - PitchW'(level_i) : pitch_i;"},
      {"rtl/texture_address.sv", "rows_3 | {1'b0, second_3[IndexW+:IndexW]}",
       "{1'b0, second_3[IndexW+:IndexW] + IndexW'(0)}"},
      {"rtl/texture.sv", ".level_i(in_level_i + LevelW'(1))", ".level_i(in_level_i + LevelW'(0))"},
      {"rtl/texture.sv", "assign next_6 = mixed_in && next_textured;",
       "assign next_6 = mixed_in && next_quad;"},
      {"rtl/texture.sv", "{{3{next && quad}}, next, {3{quad}}, textured}", "{4'b0000, {3{quad}}, textured}"},
      {"rtl/texture.sv", ".in_f_i(share_at_filter)", ".in_f_i(~share_at_filter)"},
      {"rtl/texture.sv", ".upper_i(next_upper)", ".upper_i(upper & 2'b11)"},
      {"rtl/texture.sv", ".in_next_ey_i(next_ey_at_filter)", ".in_next_ey_i(ey_at_filter)"},
      {"rtl/texture.sv", "if (shade_en) shades_mixed <= shades_levels;", "shades_mixed <= shades_levels;"},
  };
  Random random(5);
  Case t(levels_config("depth16", MipMode::linear), random);
  const Conditions conditions{{0.2, 0.4}, {1, 60}};
  run(t, random, 1500, conditions);
  expect_seen(bugs, [&] { run(t, random, 1500, conditions); });
}

}  // namespace
}  // namespace bitspan
