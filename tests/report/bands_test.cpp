// SPDX-License-Identifier: Apache-2.0
// Bands of rows against the whole picture: records, picture, counters, and the work that is repeated.
#include "report/bands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "golden/engine_golden.hpp"
#include "model/engine_model.hpp"
#include "model/simd/engine_vector.hpp"
#include "report/random_config.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"
#include "tests/support/wrapped_engine.hpp"

namespace bitspan {
namespace {

using Engines = std::vector<std::unique_ptr<Engine>>;

// Golden, and the model one record at a time and in lanes.
Engines engines_of(const Config& config) {
  Engines out;
  out.push_back(make_golden(config));
  out.push_back(make_model(config, {.form = ModelForm::scalar}));
  if (model::vector_refusal(config) == nullptr) {
    out.push_back(make_model(config, {.form = ModelForm::vector}));
  }
  return out;
}

// A whole run of golden.
struct Whole {
  Whole(const Config& config, const Scene& scene) : engine(make_golden(config)) {
    engine->begin(scene);
    draw_scene(*engine, scene, 0, scene.triangles.size(), &trace);
    digest.add(trace);
  }
  WholeRun run() const { return {engine->frame(), engine->counters(), digest}; }

  std::unique_ptr<Engine> engine;
  Trace trace;
  RecordDigest digest;
};

void expect_same_bands(const Config& config, const Scene& scene, const Whole& whole, int rows,
                       const std::string& where) {
  const BandReport report = compare_bands(engines_of(config), config, scene, rows, whole.run(), [](int) {});
  for (const std::string& failure : report.failures) ADD_FAILURE() << where << ": " << failure;
  EXPECT_EQ(report.records, whole.digest.records()) << where;
  EXPECT_EQ(report.hash, whole.digest.hash()) << where;
}

RandomOptions small_scenes(std::uint64_t seed) {
  RandomOptions o;
  o.width = 53;
  o.height = 37;
  o.triangles = 14;
  o.size_max = 60;
  o.texture_size_max = 16;
  o.mip_chains = seed % 2 == 0;
  o.command_probability = seed % 3 == 0 ? 0 : 0.3;
  return o;
}

// A configuration and a scene of a seed, with channels, other targets, slides, light or layers by turns.
// False where a band does not suffice, or the scene does not fit.
bool draw_case(std::uint64_t seed, Config& config, Scene& scene) {
  static const std::vector<Config> bases = shipped_configs();
  Random random(seed);
  config = seed % 2 == 0 ? random_config(seed, bases) : bases[seed / 2 % bases.size()];
  if (seed % 2 == 1) {
    config.perspective = all_perspectives[seed / 2 % all_perspectives.size()];
    config.fog = seed % 4 == 1 ? FogMode::table : FogMode::distance;
    if (first_violation(config)) return false;
  }
  scene = random_scene(seed, small_scenes(seed));
  if (seed % 5 == 0) draw_pass(random, scene);
  if (seed % 7 == 0 && has_project(config.project)) draw_projection(random, scene);
  if (seed % 4 == 0) draw_translucency(random, scene);
  if (has_light(config.light)) draw_light(random, scene, light_taken(config));
  if (seed % 3 == 1) draw_given_attributes(random, scene, 0.5);
  try {
    static_cast<void>(banded_plan(scene));
    make_golden(config)->begin(scene);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

TEST(Bands, HaveTheRecordsAndBitsOfTheWhole) {
  const std::uint64_t seeds = is_long_run() ? 400 : 40;
  int compared = 0, with_commands = 0;
  std::uint64_t written = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Config config;
    Scene scene;
    if (!draw_case(seed, config, scene)) continue;
    std::unique_ptr<Whole> whole;
    try {
      whole = std::make_unique<Whole>(config, scene);
    } catch (const InputError&) {
      continue;
    }
    Random random(seed);
    const int height = banded_plan(scene).height;
    std::vector<int> heights{static_cast<int>(random.integer(1, height))};
    if (seed % 4 == 0) heights.push_back(1);
    if (seed % 4 == 1) heights.push_back(std::min(2, height));
    if (seed % 4 == 2) heights.push_back(std::min(16, height));
    if (seed % 4 == 3) heights.push_back(height);
    for (const int rows : heights) {
      expect_same_bands(config, scene, *whole, rows,
                        "seed " + std::to_string(seed) + ", bands of " + std::to_string(rows) + " rows");
    }
    if (HasFailure()) return;
    ++compared;
    with_commands += scene.commands.empty() ? 0 : 1;
    written += whole->engine->counters().written;
  }
  EXPECT_GT(compared, 20);
  EXPECT_GT(with_commands, 10);
  EXPECT_GT(written, 5000U);
}

// Every fill rule, walk and plane of a shipped configuration, in bands of a line.
TEST(Bands, OfOneLineInEveryMode) {
  std::uint64_t seed = 100;
  std::uint64_t written = 0;
  for (const Perspective perspective : all_perspectives) {
    for (const FillRule fill : {FillRule::top_left, FillRule::inclusive}) {
      for (const EdgeX edge : {EdgeX::quotient, EdgeX::summed, EdgeX::multiplied}) {
        Config c = shipped_config("depth16");
        c.perspective = perspective;
        c.fill_rule = fill;
        c.edge_walk = edge == EdgeX::quotient ? EdgeWalk::exact : EdgeWalk::dda;
        if (edge == EdgeX::multiplied) c.dda_update = DdaUpdate::multiply;
        RandomOptions options = small_scenes(++seed);
        options.triangles = 6;
        options.height = 19;
        options.command_probability = 0.2;
        options.several_targets = false;
        const Scene scene = random_scene(seed, options);
        const Whole whole(c, scene);
        expect_same_bands(c, scene, whole, 1, "seed " + std::to_string(seed));
        if (HasFailure()) return;
        written += whole.engine->counters().written;
      }
    }
  }
  EXPECT_GT(written, 1000U);
}

// Without a trace the lanes go other ways, and several threads have bands of their own inside of one.
TEST(Bands, FormsWithoutRecords) {
  int drawn = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Config config;
    Scene scene;
    if (!draw_case(seed, config, scene) || model::vector_refusal(config) != nullptr) continue;
    const std::unique_ptr<Engine> whole = make_model(config, {.form = ModelForm::scalar});
    try {
      whole->begin(scene);
      draw_scene(*whole, scene, 0, scene.triangles.size(), nullptr);
    } catch (const InputError&) {
      continue;
    }
    const int rows = static_cast<int>(Random(seed).integer(1, banded_plan(scene).height));
    std::vector<BandWork> works;
    for (const ModelOptions& options :
         {ModelOptions{.form = ModelForm::scalar}, ModelOptions{.form = ModelForm::vector},
          ModelOptions{.form = ModelForm::vector, .target = VectorTarget::baseline, .threads = 3}}) {
      BandedEngine engine(make_model(config, options), config);
      const BandedRun run = run_in_bands(engine, scene, rows, [](int) {});
      SCOPED_TRACE("seed " + std::to_string(seed) + ", bands of " + std::to_string(rows) + " rows, form " +
                   std::to_string(static_cast<int>(options.form)) + ", threads " +
                   std::to_string(options.threads));
      expect_same_frame(run.picture, whole->frame());
      EXPECT_EQ(run.counters, whole->counters());
      works.push_back(run.work);
      if (HasFailure()) return;
    }
    EXPECT_EQ(works[0], works[1]) << "seed " << seed;
    EXPECT_EQ(works[0], works[2]) << "seed " << seed;
    ++drawn;
  }
  EXPECT_GT(drawn, 25);
}

StateSetting setting(const char* key, std::int64_t value) { return {*find_state_register(key), value}; }

template <class Record>
std::vector<std::vector<std::int64_t>> sorted_values(const std::vector<Record>& records) {
  std::vector<std::vector<std::int64_t>> out;
  for (const Record& record : records) {
    const auto values = raw_values(record);
    out.emplace_back(values.begin(), values.end());
  }
  std::ranges::sort(out);
  return out;
}

// The digest says what the sorted records do.
TEST(Bands, SortedRecordsAreThoseOfTheWhole) {
  const Config config = shipped_config("depth20");
  Scene scene = demo_scene(48, 36);
  Clear depth;
  depth.depth = true;
  scene.commands = {{3, StateChange{false, {setting("depth.bias", 5)}}}, {9, depth}};
  const Whole whole(config, scene);
  BandedEngine engine(make_model(config, {.form = ModelForm::scalar}), config);
  const BandedPlan plan = banded_plan(scene);
  Trace all;
  for (int b = 0; b < number_of_bands(plan.height, 5); ++b) {
    engine.set_band(plan, band_of(plan.height, 5, b));
    engine.begin(scene);
    draw_scene(engine, scene, 0, scene.triangles.size(), &all);
  }
  RecordDigest digest;
  digest.add(all);
  EXPECT_EQ(digest, whole.digest);
#define BITSPAN_SAME(Record, LIST, name, member) \
  EXPECT_EQ(sorted_values(all.member), sorted_values(whole.trace.member)) << (name);
  BITSPAN_RECORDS(BITSPAN_SAME)
#undef BITSPAN_SAME
  EXPECT_GT(all.merge.size(), 100U);

  const auto differs = [&](auto change) {
    Trace changed = all;
    change(changed);
    RecordDigest other;
    other.add(changed);
    EXPECT_NE(other, digest);
    EXPECT_NE(other.hash(), digest.hash());
    EXPECT_FALSE(other.difference(digest).empty());
  };
  differs([](Trace& t) { t.merge.pop_back(); });
  differs([](Trace& t) { ++t.fragment[7].u; });
  differs([](Trace& t) { std::swap(t.span[3].x, t.span[3].y); });
  differs([](Trace& t) { t.edge.push_back(t.edge[0]); });
}

// An engine whose window of rows is off by one.
class ShiftedBands final : public WrappedEngine, public BandEngine {
 public:
  ShiftedBands(std::unique_ptr<Engine> inner, BandEngine& bands, int first, int end)
      : WrappedEngine(std::move(inner)), bands_(bands), first_(first), end_(end) {}
  void begin_band(const Scene& scene, const Band& band) override {
    Band shifted = band;
    shifted.rows.first = std::max<std::int64_t>(0, band.rows.first + first_);
    shifted.rows.end = std::min<std::int64_t>(scene.height, band.rows.end + end_);
    bands_.begin_band(scene, shifted);
  }
  void draw_again(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    bands_.draw_again(triangles, first_index, trace);
  }
  std::uint64_t rows_above() const override { return bands_.rows_above(); }

 private:
  BandEngine& bands_;  // the same engine
  int first_, end_;
};

TEST(Bands, WindowsOffByOneRowAreFound) {
  const Config config = shipped_config("depth16");
  const Scene scene = demo_scene(64, 48);
  const Whole whole(config, scene);
  const auto report = [&](Engines engines) {
    return compare_bands(std::move(engines), config, scene, 8, whole.run(), [](int) {});
  };
  const auto shifted = [&](int first, int end) {
    Engines out;
    std::unique_ptr<Engine> golden = make_golden(config);
    auto& bands = dynamic_cast<BandEngine&>(*golden);
    out.push_back(std::make_unique<ShiftedBands>(std::move(golden), bands, first, end));
    return out;
  };
  EXPECT_TRUE(report(shifted(0, 0)).held());
  for (const auto& [first, end] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}}) {
    EXPECT_FALSE(report(shifted(first, end)).held()) << first << " " << end;
    Engines pair = shifted(first, end);
    pair.push_back(make_model(config));
    EXPECT_FALSE(report(std::move(pair)).held()) << first << " " << end;
  }
}

TEST(Bands, WorkOfTwoTriangles) {
  const Config config = shipped_config("depth16");
  Scene scene;
  scene.name = "two";
  scene.width = 16;
  scene.height = 12;
  scene.s_min = 1;
  scene.s_max = 4;
  scene.focal = 16;
  // Rows 0 to 9, and rows 4 and 5: centres at y + 1/2.
  const auto triangle = [](double x, double y, double right, double bottom) {
    Triangle t;
    for (Vertex& v : t.v) v.x = x;
    for (Vertex& v : t.v) v.y = y;
    t.v[1].x = right;
    t.v[2].y = bottom;
    return t;
  };
  const Triangle high = triangle(0, 0, 12, 10);
  const Triangle low = triangle(2, 4, 14, 6);
  scene.triangles = {high, low};
  const auto work_of = [&](int rows) {
    BandedEngine engine(make_golden(config), config);
    return run_in_bands(engine, scene, rows, [](int) {}).work;
  };
  EXPECT_EQ(work_of(12), (BandWork{.set_up = 2, .unsorted = 2}));
  // Sorted by their vertices, they reach rows 0 to 11 and 1 to 8.
  const BandWork lines = work_of(1);
  EXPECT_EQ(lines.unsorted, 24U);
  EXPECT_EQ(lines.set_up, 12U + 8U);
  EXPECT_EQ(lines.set_up_again, lines.set_up - 2);
  EXPECT_EQ(lines.rows_above, 45U + 1U);
  const BandWork halves = work_of(6);
  EXPECT_EQ(halves.set_up, 4U);
  EXPECT_EQ(halves.rows_above, 6U);
}

// The source's sum: 24 bits of colour and 20 of depth at each of 512 x 512 pixels.
TEST(Bands, BytesOfBuffers) {
  const Config config = shipped_config("depth20");
  RandomOptions options;
  options.width = options.height = 512;
  options.triangles = 2;
  options.textures = 0;
  Scene scene = random_scene(5, options);
  BandedEngine engine(make_model(config), config);
  const auto figures = [&](int rows) {
    return figures_of_bands(config, rows, run_in_bands(engine, scene, rows, [](int) {}));
  };
  EXPECT_EQ(figures(512).bytes, 1441792U);
  EXPECT_EQ(figures(16).bytes, 45056U);
  EXPECT_EQ(figures(1).bytes, 2816U);
  EXPECT_EQ(figures(1).bands, 512);
  const auto late = static_cast<std::int64_t>(DepthWhen::late);
  scene.commands = {{0, StateChange{false, {setting("depth.when", late), setting("stencil.test", 1)}}}};
  EXPECT_EQ(figures(64).bits.stencil, 8);
  EXPECT_EQ(figures(64).bytes, 64U * 512 * 52 / 8);
}

TEST(Bands, RefusesPlansThatReadTheWholePicture) {
  const Config config = shipped_config("depth16");
  Scene scene = demo_scene(53, 37);
  scene.commands = {{2, Copy{.target = 0}}};
  const auto plan = [&] { static_cast<void>(banded_plan(scene)); };
  expect_refusal(plan, "copies target 0, the picture itself");
  ViewChange smaller;
  smaller.width = 20;
  smaller.height = 10;
  scene.commands = {{2, smaller}};
  expect_refusal(plan, "the picture has triangles in two sizes");
  scene.commands = {{0, smaller}};
  EXPECT_EQ(banded_plan(scene).height, 10);
  // Another target is drawn whole.
  smaller.width = scene.textures[0].width;
  smaller.height = scene.textures[0].height;
  scene.commands = {{2, Target{1}}, {2, smaller}, {5, Copy{.target = 1}}, {5, Target{0}}};
  EXPECT_EQ(banded_plan(scene).height, scene.height);
  const Whole whole(config, scene);
  const BandReport report = compare_bands(engines_of(config), config, scene, 3, whole.run(), [](int) {});
  EXPECT_TRUE(report.held()) << report.failures.front();
  expect_refusal([&] { BandedEngine(std::make_unique<WrappedEngine>(make_golden(config)), config); },
                 "draws whole pictures");
}

}  // namespace
}  // namespace bitspan
