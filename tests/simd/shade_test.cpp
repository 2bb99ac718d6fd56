// SPDX-License-Identifier: Apache-2.0
// The block kernels of texture, fog and merge against the scalar stages, record by record, on every target.
#include "model/simd/shade.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "config/lines.hpp"
#include "model/simd/targets.hpp"
#include "report/random_config.hpp"
#include "scene/random.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::model {
namespace {

std::vector<VectorTarget> targets() {
  std::vector<VectorTarget> out;
  for (const VectorTarget t : {VectorTarget::avx512, VectorTarget::avx2, VectorTarget::baseline}) {
    if (supported(t)) out.push_back(t);
  }
  return out;
}
std::string name_of(VectorTarget t) {
  return t == VectorTarget::avx512 ? "avx512" : t == VectorTarget::avx2 ? "avx2" : "baseline";
}

// What texels may be.
enum class Texels { opaque, no_holes, any };

Texture random_texture(Random& random, int width, int height, Texels texels, const Config& config) {
  Texture t;
  t.name = "random";
  t.width = width;
  t.height = height;
  for (int i = 0; i < width * height; ++i) {
    std::array<std::uint8_t, 4> p{};
    for (std::uint8_t& c : p) c = static_cast<std::uint8_t>(random.integer(0, 255));
    if (texels == Texels::any && config.transparent && random.chance(0.3)) {
      std::copy(config.transparent->begin(), config.transparent->end(), p.begin());
      if (random.chance(0.3)) p[static_cast<std::size_t>(random.integer(0, 2))] ^= 1;  // nearly
    } else if (config.transparent &&
               std::equal(config.transparent->begin(), config.transparent->end(), p.begin())) {
      p[0] ^= 0x80;
    }
    if (texels == Texels::opaque) {
      p[3] = 255;
    } else if (random.chance(0.5)) {
      p[3] = texels == Texels::any && random.chance(0.5) ? 0 : 255;
    }
    t.rgba.insert(t.rgba.end(), p.begin(), p.end());
  }
  return t;
}

Scene random_shade_scene(Random& random, const Config& config) {
  Scene s;
  s.name = "shade";
  s.width = static_cast<int>(random.integer(1, 150));
  s.height = static_cast<int>(random.integer(1, 60));
  s.s_min = random.log_uniform(0.5, 4);
  s.s_max = s.s_min * random.log_uniform(2, 200);
  s.focal = random.log_uniform(1, 1000);
  for (std::uint8_t& c : s.background) c = static_cast<std::uint8_t>(random.integer(0, 255));
  if (random.chance(0.75)) {
    s.fog.emplace();
    for (std::uint8_t& c : s.fog->color) c = static_cast<std::uint8_t>(random.integer(0, 255));
    s.fog->distance = s.s_max * random.log_uniform(0.01, 2);
  }
  // 41, 47 and 83 in float, 49 in double: n (1 / n) rounds below 1.
  constexpr std::array<std::array<int, 2>, 11> sizes{
      {{1, 1}, {1, 3}, {3, 1}, {7, 5}, {8, 8}, {16, 4}, {13, 2}, {2, 1}, {41, 47}, {49, 83}, {64, 64}}};
  for (const Texels texels : {Texels::opaque, Texels::no_holes, Texels::any, Texels::any}) {
    const auto [w, h] = sizes[static_cast<std::size_t>(random.integer(0, sizes.size() - 1))];
    s.textures.push_back(random_texture(random, w, h, texels, config));
  }
  return s;
}

std::int64_t random_raw(Random& random, const Register& r) {
  const double kind = random.unit();
  const std::int64_t one = r.fraction >= 0 && r.fraction < 62 ? std::int64_t{1} << r.fraction : 1;
  if (kind < 0.15) return std::clamp<std::int64_t>(one, r.min, r.max);
  if (kind < 0.25) return r.min;
  if (kind < 0.35) return r.max;
  if (kind < 0.45) return 0;
  // Around 0, by an unlikely and by a likely size.
  const int bits = static_cast<int>(random.integer(1, 62));
  const std::int64_t size = std::int64_t{1} << bits;
  return std::clamp(random.integer(-size, size), r.min, r.max);
}

enum class Pixels { once, repeating };

struct Case {
  Config config;
  Scene scene;
  Pipeline pipeline;
  ShadePlan plan;
};

// With every texture ready for the first unit.
ShadePlan ready_plan(const Pipeline& pipeline, const Config& config, const Scene& scene) {
  ShadePlan plan = prepare_shade(pipeline, config, scene);
  select_textures(plan, pipeline, scene);
  for (int texture = 0; texture < std::ssize(scene.textures); ++texture) {
    need_texture(plan, pipeline, scene, 0, texture);
  }
  return plan;
}

// Fragments in runs of pixels side by side; colours all 1 where plain.
std::vector<FragmentRecord> random_fragments(Random& random, const Case& c, Pixels pixels, bool white) {
  const TextureStage& t = c.pipeline.texture;
  const std::int64_t area = std::int64_t{c.scene.width} * c.scene.height;
  std::vector<char> used(static_cast<std::size_t>(area));
  std::vector<FragmentRecord> out;
  const std::int64_t opaque = constant_shade(c.plan, quantize(1, 0, c.config.format(FormatId::setup_shade)));
  const std::int64_t wanted = random.integer(1, block_size);
  for (int tries = 0; tries < 400 && std::ssize(out) < wanted; ++tries) {
    std::int64_t at = random.integer(0, area - 1);
    const std::int64_t length = random.chance(0.3) ? random.integer(20, 90) : random.integer(1, 6);
    const bool down = random.chance(0.1);
    for (std::int64_t i = 0; i < length && std::ssize(out) < wanted; ++i, at += down ? c.scene.width : 1) {
      if (at >= area || (pixels == Pixels::once && used[static_cast<std::size_t>(at)])) break;
      used[static_cast<std::size_t>(at)] = 1;
      FragmentRecord f;
      f.triangle = random.integer(0, 1000000);
      f.x = at % c.scene.width;
      f.y = at / c.scene.width;
      f.covered = 1;
      f.h = random_raw(random, make_register(c.config, FormatId::span_h));
      f.u = random_raw(random, t.uv);
      f.v = random_raw(random, t.uv);
      for (const auto shade :
           {&FragmentRecord::r, &FragmentRecord::g, &FragmentRecord::b, &FragmentRecord::a}) {
        f.*shade = white ? opaque : random_raw(random, t.shade);
      }
      if (pixels == Pixels::repeating) f.a = opaque;
      out.push_back(f);
    }
  }
  return out;
}

// A factor of fog of the vertices, which hangs on the fragment alone.
FragmentChannels channels_of(const Case& c, const FragmentRecord& f) {
  Random random(static_cast<std::uint64_t>(f.triangle + f.x));
  FragmentChannels out{};
  out[0].channel = static_cast<std::int64_t>(LineId::fog) - fixed_lines;
  out[0].w = random_raw(random, make_register(c.config, FormatId::fog_factor));
  return out;
}

// Those that pass the depth test of `frame`, in order.
template <class T>
std::unique_ptr<FragmentBlock<T>> block_of(const Case& c, const std::vector<FragmentRecord>& fragments,
                                           const Frame& frame) {
  auto block = std::make_unique<FragmentBlock<T>>();
  std::memset(static_cast<void*>(block.get()), 0x7b, sizeof *block);  // what lies past the end is anything
  block->size = 0;
  std::vector<std::uint32_t> stored = frame.depth;
  for (const FragmentRecord& f : fragments) {
    const auto at = static_cast<std::size_t>(f.y * c.scene.width + f.x);
    DepthRecord z;
    if (!depth(c.pipeline.depth, f, nullptr, stored[at], z)) continue;
    stored[at] = static_cast<std::uint32_t>(z.z);
    const std::size_t i = block->size++;
    block->pixel[i] = static_cast<std::int32_t>(at);
    block->z[i] = static_cast<std::int32_t>(z.z);
    block->u[i] = static_cast<T>(f.u);
    block->v[i] = static_cast<T>(f.v);
    block->r[i] = static_cast<T>(f.r);
    block->g[i] = static_cast<T>(f.g);
    block->b[i] = static_cast<T>(f.b);
    block->a[i] = static_cast<T>(f.a);
    block->fog_step[i] = static_cast<std::int32_t>(fog_step(c.pipeline.fog, f.h));
    block->h[i] = f.h;
    block->fog_factor[i] = static_cast<T>(channels_of(c, f)[0].w);
    block->triangle[i] = static_cast<std::int32_t>(f.triangle);
  }
  return block;
}

::testing::AssertionResult same_frame(const Frame& a, const Frame& b) {
  if (!same_bits(a.color, b.color)) return ::testing::AssertionFailure() << "colour differs";
  if (!same_bits(a.depth, b.depth)) return ::testing::AssertionFailure() << "depth differs";
  if (!same_bits(a.u, b.u) || !same_bits(a.v, b.v)) return ::testing::AssertionFailure() << "u or v differs";
  if (a.triangle != b.triangle) return ::testing::AssertionFailure() << "triangle differs";
  return ::testing::AssertionSuccess();
}
template <class R>
::testing::AssertionResult same_records(const std::vector<R>& got, const std::vector<R>& want) {
  if (got.size() != want.size()) {
    return ::testing::AssertionFailure() << got.size() << " records for " << want.size();
  }
  for (std::size_t i = 0; i < got.size(); ++i) {
    for (std::size_t f = 0; f < fields<R>.size(); ++f) {
      const std::int64_t a = raw_values(got[i])[f];
      const std::int64_t b = raw_values(want[i])[f];
      if (a != b) {
        return ::testing::AssertionFailure()
               << stage_name<R> << " record " << i << ", " << fields<R>[f].name << ": " << a << " for " << b;
      }
    }
  }
  return ::testing::AssertionSuccess();
}

struct Tally {
  int int32 = 0, int64 = 0, scalar = 0, plain = 0, records = 0, killed = 0, blended = 0, linear = 0,
      vertex = 0;
};

struct Expected {
  Frame frame;
  Counters counters;
  Trace trace;
  Statistics statistics;
};

// One block in every form that the plan allows, on every target.
void check_block(const Case& c, const std::vector<FragmentRecord>& fragments, int texture, Pixels pixels,
                 Tally& tally) {
  const Frame cleared = cleared_frame(c.pipeline, c.scene);
  Frame start = cleared;
  for (std::size_t i = 0; i < start.color.size(); ++i) {
    if (i % 4 != 3) start.color[i] = static_cast<std::uint8_t>(i * 37 + 11);
  }
  const Texture* image = texture < 0 ? nullptr : &c.scene.textures[static_cast<std::size_t>(texture)];
  const auto block64 = block_of<std::int64_t>(c, fragments, start);

  // The scalar stages; statistics of texture, fog and merge alone.
  Expected want;
  want.frame = start;
  std::vector<FragmentChannels> channels;
  for (const FragmentRecord& f : fragments) channels.push_back(channels_of(c, f));
  fragments_to_frame(c.pipeline, c.scene, fragments, {.texture = texture}, nullptr, want.frame, want.counters,
                     &want.trace, NoObserve{}, channels);
  const Observe observe{&want.statistics};
  {
    Frame frame = start;
    for (std::size_t i = 0; i < block64->size; ++i) {
      const auto at = static_cast<std::size_t>(block64->pixel[i]);
      FragmentRecord f;
      f.triangle = block64->triangle[i];
      f.x = block64->pixel[i] % c.scene.width;
      f.y = block64->pixel[i] / c.scene.width;
      f.u = block64->u[i];
      f.v = block64->v[i];
      f.r = block64->r[i];
      f.g = block64->g[i];
      f.b = block64->b[i];
      f.a = block64->a[i];
      f.h = block64->h[i];
      TextureRecord texel;
      if (!model::texture(c.pipeline.texture, image, f, texel, observe)) continue;
      FogRecord fogged;
      const FragmentChannels own = channels_of(c, f);
      fog(c.pipeline.fog, f, DistanceRecord{}, texel, fogged, observe, &own);
      MergeRecord merged;
      std::uint8_t* color = frame.color.data() + 4 * at;
      merge(c.pipeline.merge, DepthRecord{}, texel, fogged, {color[0], color[1], color[2]}, merged, observe);
      tally.blended += texel.a < std::int64_t{1} << c.pipeline.merge.alpha.fraction ? 1 : 0;
    }
  }
  tally.records += static_cast<int>(want.trace.texture.size());
  tally.killed += static_cast<int>(want.counters.killed);

  const auto check = [&](const auto& run, bool traced, const std::string& form) {
    SCOPED_TRACE(form);
    Frame frame = start;
    Counters counters;
    Trace trace;
    run(frame, counters, traced ? &trace : nullptr);
    EXPECT_TRUE(same_frame(frame, want.frame));
    EXPECT_EQ(counters.killed, want.counters.killed);
    EXPECT_EQ(counters.written, want.counters.written);
    if (traced) {
      EXPECT_TRUE(same_records(trace.texture, want.trace.texture));
      EXPECT_TRUE(same_records(trace.fog, want.trace.fog));
      EXPECT_TRUE(same_records(trace.merge, want.trace.merge));
    }
  };
  for (const VectorTarget target : targets()) {
    SCOPED_TRACE(name_of(target));
    const auto kernels64 = shade_kernels<std::int64_t>(target);
    for (const bool traced : {false, true}) {
      if (traced && pixels == Pixels::repeating) continue;
      check([&](Frame& f, Counters& n,
                Trace* t) { kernels64.shade(c.pipeline, c.plan, {texture}, *block64, f, n, t); },
            traced, traced ? "int64 traced" : "int64");
      Statistics seen;
      check(
          [&](Frame& f, Counters& n, Trace* t) {
            kernels64.shade_observed(c.pipeline, c.plan, {texture}, *block64, f, n, t, seen);
          },
          traced, traced ? "int64 observed, traced" : "int64 observed");
      for (int id = 0; id < register_count; ++id) {
        const auto i = static_cast<std::size_t>(id);
        EXPECT_EQ(seen.fields[i], want.statistics.fields[i]) << name_of(static_cast<RegisterId>(id));
      }
      if (c.plan.held_in == ShadeLanes::int32) {
        const auto block32 = block_of<std::int32_t>(c, fragments, start);
        const auto kernels32 = shade_kernels<std::int32_t>(target);
        check([&](Frame& f, Counters& n,
                  Trace* t) { kernels32.shade(c.pipeline, c.plan, {texture}, *block32, f, n, t); },
              traced, traced ? "int32 traced" : "int32");
      }
    }
  }
}

std::vector<Config> bases() {
  std::vector<Config> out = shipped_configs();
  Config wide = plain_config();
  wide.fog = FogMode::table;
  out.push_back(wide);
  wide.fog = FogMode::linear;
  wide.filter = TextureFilter::bilinear;
  wide.wrap = TextureWrap::clamp;
  out.push_back(wide);
  return out;
}

void check_config_blocks(const Config& config, std::uint64_t seed, Tally& tally) {
  if (takes_distance(config.fog) || has_dz(config.depth_code)) return;  // not in lanes
  SCOPED_TRACE(config.name + ", scene seed " + std::to_string(seed));
  Random random(seed);
  Case c;
  c.config = config;
  // The blocks have no channel but fog's.
  c.config.shade_lines = ShadeLines::linear;
  c.config.depth_line = DepthLine::h;
  c.scene = random_shade_scene(random, c.config);
  try {
    c.pipeline = make_pipeline(c.config, c.scene);
  } catch (const InputError&) {
    return;  // the scene's range does not fit
  }
  c.plan = ready_plan(c.pipeline, c.config, c.scene);
  (c.plan.held_in == ShadeLanes::int32   ? tally.int32
   : c.plan.held_in == ShadeLanes::int64 ? tally.int64
                                         : tally.scalar)++;
  tally.plain += c.plan.branch_free ? 1 : 0;
  tally.linear += c.pipeline.fog.mode == FogMode::linear ? 1 : 0;
  tally.vertex += has_vertex_fog(c.pipeline.fog.mode) ? 1 : 0;
  for (int texture = -1; texture < std::ssize(c.scene.textures); ++texture) {
    SCOPED_TRACE("texture " + std::to_string(texture));
    const auto fragments = random_fragments(random, c, Pixels::once, random.chance(0.3));
    check_block(c, fragments, texture, Pixels::once, tally);
    const std::int64_t one = quantize(1, 0, c.config.format(FormatId::setup_shade));
    if (!may_show_through(c.plan, texture, one, one, one)) {
      check_block(c, random_fragments(random, c, Pixels::repeating, false), texture, Pixels::repeating,
                  tally);
    }
    if (::testing::Test::HasFailure()) return;
  }
}

// Random widths with the common rounding and overflow modes, which have a form of their own.
void make_plain(Config& config) {
  const Config before = config;
  for (const FormatId id : {FormatId::texture_frac, FormatId::texture_mix, FormatId::texture_color,
                            FormatId::texture_alpha, FormatId::fog_color, FormatId::merge_color}) {
    Format& f = config.format(id);
    f.rounding = f.word % 3 == 0 ? Rounding::trn : f.word % 3 == 1 ? Rounding::rnd : Rounding::rnd_min_inf;
    f.overflow = f.is_signed && f.word % 2 == 0 ? Overflow::sat_sym : Overflow::sat;
  }
  try {
    check_config(config, config.name);
  } catch (const InputError&) {
    config = before;
  }
}

TEST(Shade, ShippedConfigurationsEqualTheScalarStages) {
  Tally tally;
  std::uint64_t seed = 1;
  for (const Config& base : bases()) {
    for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
      for (const TextureWrap wrap :
           {TextureWrap::cyclic, TextureWrap::clamp, TextureWrap::mirror, TextureWrap::border}) {
        for (const FogMode fog : {FogMode::none, FogMode::table, FogMode::linear}) {
          Config config = base;
          config.filter = filter;
          config.wrap = wrap;
          config.border = {90, 160, 30, static_cast<std::uint8_t>(seed % 2 == 0 ? 255 : 120)};
          config.fog = fog;
          check_config(config, "test");
          check_config_blocks(config, ++seed, tally);
          ASSERT_FALSE(HasFailure());
        }
      }
    }
  }
  EXPECT_GT(tally.int32, 20);
  EXPECT_GT(tally.int64, 10);
  EXPECT_GT(tally.plain, 20);
  EXPECT_GT(tally.linear, 5);
  EXPECT_GT(tally.records, 15000);
  EXPECT_GT(tally.killed, 1000);
  EXPECT_GT(tally.blended, 1000);
}

TEST(Shade, RandomConfigurationsEqualTheScalarStages) {
  const std::vector<Config> from = bases();
  Tally tally;
  for (std::uint64_t seed = 100; seed < 280; ++seed) {
    Config config = random_config(seed, from);
    if (seed % 2 == 0) make_plain(config);
    check_config_blocks(config, seed, tally);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(tally.int32, 20);
  EXPECT_GT(tally.int64, 10);
  EXPECT_GT(tally.plain, 10);
  EXPECT_GT(tally.vertex, 5);
  EXPECT_GT(tally.records, 15000);
}

// Products that leave int64: the plan says so, and the kernels follow it.
TEST(Shade, WideFormatsAreDoneByTheScalarText) {
  Config config = plain_config();
  config.format(FormatId::span_shade) = {40, 2, true, Rounding::rnd, Overflow::sat, false};
  config.format(FormatId::texture_alpha) = {50, 2, true, Rounding::rnd_conv, Overflow::sat, false};
  config.format(FormatId::texture_color) = {60, 10, true, Rounding::trn_zero, Overflow::wrap, false};
  config.format(FormatId::fog_factor) = {55, 1, false, Rounding::rnd_inf, Overflow::sat, false};
  Tally tally;
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    config.filter = seed % 2 == 0 ? TextureFilter::nearest : TextureFilter::bilinear;
    config.fog = seed % 3 == 0 ? FogMode::none : FogMode::table;
    check_config(config, "test");
    check_config_blocks(config, seed, tally);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(tally.scalar, 8);
  EXPECT_GT(tally.blended, 100);
}

TEST(Shade, ConstantShadeIsWhatTheWalksDeliver) {
  int triangles = 0;
  for (std::uint64_t seed = 1; seed < 60; ++seed) {
    Case c;
    c.config = random_config(seed, bases());
    RandomOptions options;
    options.triangles = 4;
    options.size_max = 40;
    c.scene = random_scene(seed, options);
    try {
      c.pipeline = make_pipeline(c.config, c.scene);
    } catch (const InputError&) {
      continue;
    }
    c.plan = prepare_shade(c.pipeline, c.config, c.scene);
    PlaneWalkState walk;
    for (Triangle triangle : c.scene.triangles) {
      const double a = seed % 2 == 0 ? 1.0 : triangle.v[0].c[3];
      for (Vertex& v : triangle.v) v.c[3] = a;
      Rows rows;
      Counters counters;
      Trace trace;
      triangle_to_rows(c.pipeline, triangle, 0, walk, rows, counters, &trace);
      if (trace.setup.empty()) continue;
      ++triangles;
      const std::int64_t want = constant_shade(c.plan, trace.setup[0].a0);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        std::vector<FragmentRecord> fragments;
        span_to_fragments(c.pipeline, row_to_span(c.pipeline, rows, i, counters), geometry_of(rows, i),
                          fragments, counters);
        for (const FragmentRecord& f : fragments) ASSERT_EQ(f.a, want) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(triangles, 40);
}

TEST(Shade, ZonesAreThoseOfTheFogStage) {
  Config config = shipped_config("depth16");
  for (config.fog_zone_bits = 0; config.fog_zone_bits <= 6; config.fog_zone_bits += 2)
    for (const auto& [w, h] : std::initializer_list<std::pair<int, int>>{
             {1, 1}, {2, 1}, {1, 7}, {3, 2}, {64, 48}, {65, 49}, {100, 3}, {5, 90}}) {
      Scene scene;
      scene.width = w;
      scene.height = h;
      scene.fog.emplace();
      const Pipeline pipeline = make_pipeline(config, scene);
      const ShadePlan plan = prepare_shade(pipeline, config, scene);
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          ASSERT_EQ(plan.zones[static_cast<std::size_t>(y * w + x)], zone_of(pipeline.fog.zones, x, y))
              << w << "x" << h << ", " << x << ", " << y;
        }
      }
    }
}

TEST(Shade, WhatMayShowThrough) {
  const Config config = shipped_config("depth16");
  Random random(7);
  Scene scene;
  scene.textures = {random_texture(random, 4, 4, Texels::opaque, config),
                    random_texture(random, 4, 4, Texels::opaque, config)};
  std::copy_n(config.transparent->data(), 3, scene.textures[1].rgba.data() + 20);
  const Pipeline pipeline = make_pipeline(config, scene);
  const ShadePlan plan = ready_plan(pipeline, config, scene);
  const std::int64_t one = quantize(1, 0, config.format(FormatId::setup_shade));
  EXPECT_FALSE(may_show_through(plan, -1, one, one, one));
  EXPECT_FALSE(may_show_through(plan, 0, one, one, one));
  EXPECT_TRUE(may_show_through(plan, 1, one, one, one));
  EXPECT_TRUE(may_show_through(plan, 0, one, one, one - 1));
  EXPECT_TRUE(may_show_through(plan, 0, one / 2, one / 2, one / 2));
  EXPECT_TRUE(plan.textures_of(0).whole[0].never_killed);
  EXPECT_FALSE(plan.textures_of(0).whole[1].never_killed);
}

}  // namespace
}  // namespace bitspan::model
