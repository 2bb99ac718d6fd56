// SPDX-License-Identifier: Apache-2.0
// Triangles to spans in lanes against the scalar stages: every record, counter and statistic, on every
// target.
#include "model/simd/triangles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "model/simd/targets.hpp"
#include "report/random_config.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::model {
namespace {

constexpr VectorTarget targets[] = {VectorTarget::avx512, VectorTarget::avx2, VectorTarget::baseline};

// What the kernels deliver, by the scalar stages; the channels in use of each span.
template <class Watch = NoObserve>
void by_stages(const Pipeline& pipeline, const Scene& scene, std::int64_t first, Trace& trace,
               std::vector<SpanChannels>& channels, Counters& counters, Watch watch = {}) {
  Rows rows;
  PlaneWalkState walk;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    rows.clear();
    triangle_to_rows(pipeline, scene.triangles[t], first + static_cast<std::int64_t>(t), walk, rows, counters,
                     &trace, watch);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      trace.span.push_back(row_to_span(pipeline, rows, i, counters, watch));
      channels.push_back(row_to_channels(pipeline, rows, i, trace.span.back(), counters, nullptr, watch));
    }
  }
}

std::string text_of(const Counters& c) {
  return "triangles " + std::to_string(c.triangles) + " degenerate " + std::to_string(c.degenerate) +
         " rows " + std::to_string(c.rows) + " edge " + std::to_string(c.divides_edge) + " row " +
         std::to_string(c.divides_row);
}

template <class R>
bool same(const std::vector<R>& got, const std::vector<R>& expected, const std::string& where) {
  for (std::size_t i = 0; i < std::min(got.size(), expected.size()); ++i) {
    const auto a = raw_values(got[i]);
    const auto b = raw_values(expected[i]);
    for (std::size_t f = 0; f < a.size(); ++f) {
      if (a[f] != b[f]) {
        ADD_FAILURE() << where << ": " << stage_name<R> << " record " << i << ", triangle " << b[0] << ", "
                      << fields<R>[f].name << " is " << a[f] << ", not " << b[f];
        return false;
      }
    }
  }
  EXPECT_EQ(got.size(), expected.size()) << where << ": " << stage_name<R>;
  return got.size() == expected.size();
}

// Everything that the span stage reads: all that is delivered without a trace.
SpanRecord as_read(SpanRecord s) {
  s.recip_m = s.recip_e = s.phase = s.fu_diff = s.fv_diff = 0;
  s.fu_step1 = s.fv_step1 = s.r_step1 = s.g_step1 = s.b_step1 = s.a_step1 = 0;
  return s;
}

bool same_statistics(const Statistics& got, const Statistics& expected, const std::string& where) {
  for (int i = 0; i < register_count; ++i) {
    const auto id = static_cast<RegisterId>(i);
    FieldStatistics a = got.of(id);
    FieldStatistics b = expected.of(id);
    if (b.count == 0) {
      a.min = a.max = b.min = b.max = 0;
    }
    if (a != b) {
      ADD_FAILURE() << where << ": " << name_of(id) << " saw " << a.count << " values in " << a.min << ".."
                    << a.max << ", wraps " << a.wraps << ", saturations " << a.saturations << ", bias "
                    << a.bias << ", not " << b.count << " in " << b.min << ".." << b.max << ", " << b.wraps
                    << ", " << b.saturations << ", " << b.bias;
      return false;
    }
  }
  return true;
}

// All of a list's triangles, or a part of them, and all of their rows.
struct Selection {
  std::vector<std::uint32_t> which;
  TriangleRows rows;
  Selection(std::span<const Triangle> triangles, std::int64_t first_index) : which(triangles.size()) {
    std::iota(which.begin(), which.end(), 0U);
    rows = {triangles.data(), first_index, which};
  }
};

// Until all is done.
void all_to_spans(const TriangleKernels& kernels, const Pipeline& pipeline, TriangleRows from,
                  TriangleBatch& batch, Columns<SpanRecord>& spans, Counters& counters, Trace* trace,
                  Statistics* statistics = nullptr) {
  while (!from.which.empty()) {
    const std::size_t done =
        statistics != nullptr
            ? kernels.to_spans_observed(pipeline, from, batch, spans, counters, trace, *statistics)
            : kernels.to_spans(pipeline, from, batch, spans, counters, trace);
    ASSERT_GT(done, 0U);
    from.which = from.which.subspan(done);
  }
}

// Spans as they are read, and their channels: places gives those that are expected, in order.
bool same_spans(const Pipeline& pipeline, const Columns<SpanRecord>& spans, const TriangleBatch& batch,
                const Trace& expected, const std::vector<SpanChannels>& channels,
                const std::vector<std::size_t>& places, const std::string& where) {
  std::vector<SpanRecord> got;
  std::vector<SpanRecord> wanted;
  for (std::size_t i = 0; i < spans.size; ++i) got.push_back(as_read(spans.record(i)));
  for (const std::size_t i : places) wanted.push_back(as_read(expected.span[i]));
  if (!same(got, wanted, where)) return false;
  for (std::size_t c = 0; c < pipeline.channels.in_use.size(); ++c) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const SpanChannelRecord& want = channels[places[i]].record[c];
      const std::int64_t w = batch.channels[c][&SpanChannelRecord::w][i];
      const std::int64_t step = batch.channels[c][&SpanChannelRecord::w_step0][i];
      if (w == want.w && step == want.w_step0) continue;
      ADD_FAILURE() << where << ": channel " << want.channel << " of triangle " << want.triangle << " at "
                    << want.x << ", " << want.y << " is " << w << " by " << step << ", not " << want.w
                    << " by " << want.w_step0;
      return false;
    }
  }
  return true;
}

// The same triangles by bands of rows, counted in the first one: every span once, and every count.
bool check_bands(const TriangleKernels& kernels, const Pipeline& pipeline, const Scene& scene,
                 std::int64_t first, std::int64_t band, const Trace& expected,
                 const std::vector<SpanChannels>& channels, const Counters& counted,
                 const std::string& where) {
  Selection all(scene.triangles, first);
  TriangleBatch batch;
  Counters counters;
  Columns<SpanRecord> spans;
  for (std::int64_t y = 0; y < scene.height; y += band) {
    all.rows.first_row = y;
    all.rows.end_row = y + band;
    all_to_spans(kernels, pipeline, all.rows, batch, spans, counters, nullptr);
    for (std::uint32_t& w : all.which) w |= TriangleRows::counted;
  }
  EXPECT_EQ(text_of(counters), text_of(counted)) << where;
  std::vector<std::size_t> places(expected.span.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::ranges::stable_sort(places, {}, [&](std::size_t i) { return expected.span[i].y / band; });
  return same_spans(pipeline, spans, batch, expected, channels, places, where) && counters == counted;
}

// True where everything agrees.
bool check(const Config& config, const Scene& scene, const std::string& name) {
  const Pipeline pipeline = make_pipeline(config, scene);
  constexpr std::int64_t first = 7;
  Trace expected;
  Counters counted;
  Statistics seen;
  std::vector<SpanChannels> channels;
  by_stages(pipeline, scene, first, expected, channels, counted, Observe{&seen});
  bool good = true;
  for (const VectorTarget target : targets) {
    if (!supported(target)) {
      continue;
    }
    const std::string where = name + ", target " + std::to_string(static_cast<int>(target));
    const TriangleKernels kernels = triangle_kernels(target);
    TriangleBatch batch;
    for (const bool observed : {false, true}) {
      Trace trace;
      Counters counters;
      Columns<SpanRecord> spans;
      Statistics statistics;
      all_to_spans(kernels, pipeline, Selection(scene.triangles, first).rows, batch, spans, counters, &trace,
                   observed ? &statistics : nullptr);
      if (observed) good = good && same_statistics(statistics, seen, where);
      good = good && same(trace.setup, expected.setup, where) && same(trace.edge, expected.edge, where) &&
             same(trace.row, expected.row, where) && same(trace.span, expected.span, where);
      EXPECT_EQ(text_of(counters), text_of(counted)) << where;
      good = good && counters == counted;
    }
    // In two parts, appended, without a trace.
    Counters counters;
    Columns<SpanRecord> spans;
    const std::span<const Triangle> all = scene.triangles;
    const std::size_t half = all.size() / 2;
    all_to_spans(kernels, pipeline, Selection(all.first(half), first).rows, batch, spans, counters, nullptr);
    all_to_spans(kernels, pipeline,
                 Selection(all.subspan(half), first + static_cast<std::int64_t>(half)).rows, batch, spans,
                 counters, nullptr);
    EXPECT_EQ(text_of(counters), text_of(counted)) << where;
    std::vector<std::size_t> places(expected.span.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    good = good && same_spans(pipeline, spans, batch, expected, channels, places, where);
    for (const std::int64_t band : {1, 7, 64}) {
      good = good && check_bands(kernels, pipeline, scene, first, band, expected, channels, counted,
                                 where + ", bands of " + std::to_string(band));
    }
    if (!good) {
      return false;
    }
  }
  return true;
}

RandomOptions small_scenes() {
  RandomOptions o;
  o.width = 200;
  o.height = 150;
  o.triangles = 48;
  o.size_max = 300;
  return o;
}

TEST(Triangles, DemoAndExtremeScenes) {
  for (const Config& config : shipped_configs()) {
    check(config, demo_scene(160, 120), config.name + ", demo");
    for (const Scene& scene : extreme_scenes()) {
      check(config, scene, config.name + ", " + scene.name);
    }
  }
}

TEST(Triangles, RandomScenesInEveryMode) {
  std::uint64_t seed = 100;
  for (const Config& base : shipped_configs()) {
    for (const Perspective perspective :
         {Perspective::delta_f, Perspective::hyperbolic, Perspective::affine}) {
      for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
        for (int walk = 0; walk < 3; ++walk) {
          for (const SlopeForm form : {SlopeForm::divide, SlopeForm::reciprocal}) {
            Config c = base;
            c.perspective = perspective;
            c.fill_rule = rule;
            c.edge_walk = walk == 0 ? EdgeWalk::exact : EdgeWalk::dda;
            c.dda_update = walk == 2 ? DdaUpdate::multiply : DdaUpdate::accumulate;
            c.edge_slope = form;
            c.row_slope = form == SlopeForm::divide ? RowSlope::reciprocal : RowSlope::divide;
            ++seed;
            if (!check(c, random_scene(seed, small_scenes()), "seed " + std::to_string(seed))) {
              return;
            }
          }
        }
      }
    }
  }
}

// Every other configuration has the channels of a projector, where that is legal.
Config with_projector(Config config, std::uint64_t seed) {
  Config with = config;
  with.project = ProjectUnit::reciprocal;
  return seed % 2 == 0 && !first_violation(with) ? with : config;
}
// A scene that asks for every channel that a configuration may have.
Scene scene_with_channels(std::uint64_t seed, const RandomOptions& options) {
  Scene scene = random_scene(seed, options);
  Random random(seed);
  draw_given_attributes(random, scene, 0.5);
  draw_projection(random, scene);
  return scene;
}

TEST(Triangles, RandomConfigurations) {
  const std::vector<Config> bases = shipped_configs();
  RandomConfigOptions options;
  options.check = [](const Config& c) {
    if (c.perspective == Perspective::const_depth_rows) {
      throw InputError("not walked by rows");
    }
    if (has_setup_gradients(c)) throw InputError("its gradients are not in lanes");
  };
  RandomOptions scenes = small_scenes();
  scenes.triangles = 24;
  int in_lanes = 0;
  int with_channels = 0;
  constexpr int runs = 180;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    const Config config = with_projector(random_config(seed, bases, options), seed);
    const Scene scene = scene_with_channels(seed, scenes);
    const std::string name = "configuration and scene of seed " + std::to_string(seed);
    try {
      const Pipeline pipeline = make_pipeline(config, scene);
      in_lanes += triangles_in_lanes(pipeline) ? 1 : 0;
      with_channels += triangles_in_lanes(pipeline) && pipeline.channels.any() ? 1 : 0;
    } catch (const InputError&) {
      continue;  // the scene's range does not fit
    }
    if (!check(config, scene, name)) {
      return;
    }
  }
  EXPECT_GT(with_channels, 20);
  // The test is of the lanes, so many must take them. Wide formats, which are drawn too, do not.
  EXPECT_GT(in_lanes, 60);  // levels of textures and rows by planes have no lanes
}

// Registers that all round by adding a constant and saturate: these have a text of their own.
TEST(Triangles, RandomConfigurationsOfBranchFreeRegisters) {
  const std::vector<Config> bases = shipped_configs();
  RandomConfigOptions options;
  options.check = [](const Config& c) {
    if (c.perspective == Perspective::const_depth_rows) {
      throw InputError("not walked by rows");
    }
    if (has_setup_gradients(c)) throw InputError("its gradients are not in lanes");
  };
  RandomOptions scenes = small_scenes();
  scenes.triangles = 24;
  constexpr Rounding modes[] = {Rounding::trn, Rounding::rnd, Rounding::rnd_min_inf};
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Config config = with_projector(random_config(seed, bases, options), seed);
    Random random(seed);
    const auto make_branch_free = [&](Format& f) {
      f.rounding = modes[random.integer(0, 2)];
      f.overflow = random.chance(0.5) ? Overflow::sat : Overflow::sat_sym;
    };
    for (Format& f : config.formats) make_branch_free(f);
    for (Reciprocal* r : {&config.edge_reciprocal, &config.row_reciprocal, &config.pixel_reciprocal}) {
      make_branch_free(r->output);
    }
    const Scene scene = scene_with_channels(seed, scenes);
    try {
      make_pipeline(config, scene);
    } catch (const InputError&) {
      continue;  // the scene's range does not fit
    }
    if (!check(config, scene, "branch-free registers, seed " + std::to_string(seed))) {
      return;
    }
  }
}

// Accumulators coarser than their steps, in every rounding mode, that saturate and wrap on the way.
TEST(Triangles, CoarseAccumulators) {
  for (int mode = 0; mode < rounding_modes; ++mode) {
    for (int overflow = 0; overflow < overflow_modes; ++overflow) {
      Config c = shipped_config("narrow");
      c.edge_walk = EdgeWalk::dda;
      for (const FormatId id :
           {FormatId::edge_x_acc, FormatId::edge_h_acc, FormatId::edge_f, FormatId::edge_shade_acc}) {
        Format& f = c.format(id);
        f.word -= 3;  // fraction bits
        f.is_signed = true;
        if (id != FormatId::edge_x_acc) {
          f.word -= 1;
          f.integer -= 1;
        }
        f.rounding = static_cast<Rounding>(mode);
        f.overflow = static_cast<Overflow>(overflow);
      }
      const auto seed = static_cast<std::uint64_t>(1000 + 10 * mode + overflow);
      if (!check(c, random_scene(seed, small_scenes()),
                 "rounding " + std::to_string(mode) + ", overflow " + std::to_string(overflow) + ", seed " +
                     std::to_string(seed))) {
        return;
      }
    }
  }
}

// Triangles of thousands of rows, more than the row buffer holds, and with steps beyond 64 bits of sums.
TEST(Triangles, TallPictures) {
  RandomOptions o = small_scenes();
  o.width = 60;
  o.height = 3000;
  o.triangles = 7;
  o.size_min = 1500;
  o.size_max = 3000;
  for (const Config& config : shipped_configs()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      check(config, random_scene(seed, o), config.name + ", tall, seed " + std::to_string(seed));
    }
  }
}

// Formats at the limits of 127 bits: lanes of 128 bits, and beyond their room the scalar stages.
TEST(Triangles, WidestFormats) {
  int in_lanes = 0;
  for (int extra = 0; extra <= 24; extra += 4) {
    Config c = shipped_config("depth20");
    for (const FormatId id :
         {FormatId::setup_uv, FormatId::edge_f_diff, FormatId::edge_f_step, FormatId::edge_f,
          FormatId::edge_uv, FormatId::edge_h_step, FormatId::edge_h_acc, FormatId::edge_h,
          FormatId::span_f_diff, FormatId::span_f_step, FormatId::span_f}) {
      Format& f = c.format(id);
      f.word = std::min(f.word + extra, f.is_signed ? 64 : 63);
    }
    try {
      check_config(c, "widest");
    } catch (const InputError&) {
      break;
    }
    const Scene scene = random_scene(static_cast<std::uint64_t>(40 + extra), small_scenes());
    in_lanes += triangles_in_lanes(make_pipeline(c, scene)) ? 1 : 0;
    check(c, scene, "extra " + std::to_string(extra));
  }
  EXPECT_GE(in_lanes, 3);
}

TEST(Triangles, NothingToDo) {
  const Scene scene = demo_scene(160, 120);
  const Pipeline pipeline = make_pipeline(shipped_config("depth16"), scene);
  TriangleBatch batch;
  Columns<SpanRecord> spans;
  Counters counters;
  const Triangle flat{};  // three vertices in one point
  const TriangleKernels kernels = triangle_kernels(VectorTarget::best);
  kernels.to_spans(pipeline, {}, batch, spans, counters, nullptr);
  EXPECT_EQ(counters, Counters{});
  kernels.to_spans(pipeline, Selection({&flat, 1}, 0).rows, batch, spans, counters, nullptr);
  EXPECT_EQ(counters.triangles, 1U);
  EXPECT_EQ(counters.degenerate, 1U);
  EXPECT_EQ(spans.size, 0U);
}

}  // namespace
}  // namespace bitspan::model
