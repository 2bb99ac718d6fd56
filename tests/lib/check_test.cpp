// SPDX-License-Identifier: Apache-2.0
// bs_check: counts, the first difference, and pieces of a stream.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/registry.hpp"
#include "report/compare.hpp"
#include "scene/random.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Scene scene_of(std::uint64_t seed) {
  RandomOptions options;
  options.triangles = 20;
  options.size_max = 50;
  return random_scene(seed, options);
}

struct Pair {
  Pair() : scene(scene_of(1)), described(scene), config(config_handle("depth16")) {
    golden = open_model(config.get(), "golden");
    model = open_model(config.get(), "model");
    draw(golden.get(), described);
    draw(model.get(), described);
  }
  Scene scene;
  Described described;
  ConfigHandle config;
  ModelHandle golden, model;
};

TEST(LibCheck, PiecesOfAllStagesMatch) {
  Pair p;
  std::uint64_t values = 0;
  for (bs_stage stage = 0; bs_stage_name(stage) != nullptr; ++stage) {
    const bs_view view = records_view(p.golden.get(), stage);
    const auto* const base = static_cast<const std::int64_t*>(view.base);
    EXPECT_EQ(bs_unchecked(p.model.get(), stage), view.rows);
    for (std::size_t i = 0; i < view.rows; i += 17) {
      const std::size_t n = std::min<std::size_t>(17, view.rows - i);
      ASSERT_EQ(bs_check(p.model.get(), stage, base + i * view.columns, n, nullptr), BS_OK)
          << bs_last_error();
    }
    EXPECT_EQ(bs_unchecked(p.model.get(), stage), 0U);
    values += view.rows * view.columns;
  }
  EXPECT_EQ(bs_matched(p.model.get()), values);
  // As the command line counts them.
  const auto engine = make_engine("golden", shipped_config("depth16"));
  Trace trace;
  engine->begin(p.scene);
  engine->draw(p.scene.triangles, 0, &trace);
  std::uint64_t nontrivial = 0;
  for (const std::uint64_t of_stage : NonTrivial().count(trace)) nontrivial += of_stage;
  EXPECT_EQ(bs_nontrivial(p.model.get()), nontrivial);
  EXPECT_GT(nontrivial, values / 10);
}

TEST(LibCheck, EveryFlippedValueIsFoundAndNamed) {
  Pair p;
  const std::vector<std::int64_t> span = records(p.golden.get(), BS_STAGE_SPAN);
  const std::size_t columns = records_view(p.golden.get(), BS_STAGE_SPAN).columns;
  for (std::size_t f = 0; f < columns; ++f) {
    std::vector<std::int64_t> record(span.begin() + static_cast<std::ptrdiff_t>(f * columns),
                                     span.begin() + static_cast<std::ptrdiff_t>((f + 1) * columns));
    const std::int64_t right = record[f];
    record[f] += 3;
    bs_divergence first{};
    first.size = sizeof first;
    EXPECT_EQ(bs_check(p.model.get(), BS_STAGE_SPAN, record.data(), 1, &first), BS_DIFFERENT);
    bs_field_info info{};
    info.size = sizeof info;
    ASSERT_EQ(bs_field(p.config.get(), BS_STAGE_SPAN, static_cast<int>(f), &info), BS_OK);
    EXPECT_EQ(first.kind, BS_DIVERGENCE_VALUE);
    EXPECT_EQ(first.stage, BS_STAGE_SPAN);
    EXPECT_EQ(first.record, f);
    EXPECT_EQ(first.field, static_cast<std::int32_t>(f));
    EXPECT_STREQ(first.field_name, info.name);
    EXPECT_EQ(first.expected, right);
    EXPECT_EQ(first.actual, right + 3);
    EXPECT_EQ(first.differences, 1U);
    EXPECT_EQ(first.triangle, span[f * columns]);
    EXPECT_EQ(first.x, span[f * columns + 1]);
    EXPECT_EQ(first.y, span[f * columns + 2]);
    EXPECT_EQ(first.actual_value - first.expected_value, std::ldexp(3.0, -info.fraction)) << info.name;
    EXPECT_NE(std::string(bs_last_error()).find(std::string(": ") + info.name + ": "), std::string::npos);
  }
  EXPECT_EQ(bs_matched(p.model.get()), columns * (columns - 1));
}

TEST(LibCheck, NothingComparedShows) {
  Pair p;
  EXPECT_EQ(bs_check(p.model.get(), BS_STAGE_SPAN, nullptr, 0, nullptr), BS_OK);
  EXPECT_EQ(bs_matched(p.model.get()), 0U);
  EXPECT_EQ(bs_nontrivial(p.model.get()), 0U);
  // Records of zeros match nothing that is non-trivial.
  const std::vector<std::int64_t> zeros(16);
  EXPECT_EQ(bs_check(p.model.get(), BS_STAGE_SPAN, zeros.data(), 1, nullptr), BS_DIFFERENT);
  EXPECT_EQ(bs_nontrivial(p.model.get()), 0U);
}

TEST(LibCheck, NumbersOfTheDrawAreTold) {
  const Scene scene = scene_of(2);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle model = open_model(config.get(), "model");
  ASSERT_EQ(bs_begin(model.get(), &described.desc), BS_OK);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    ASSERT_EQ(bs_triangle(model.get(), &described.vertices[3 * i], described.texture_of[i], 100 + i / 4, i),
              BS_OK);
  }
  const std::vector<std::int64_t> setup = records(model.get(), BS_STAGE_SETUP);
  const std::size_t columns = records_view(model.get(), BS_STAGE_SETUP).columns;
  for (std::size_t i = 0; i < setup.size() / columns; ++i) {
    std::vector<std::int64_t> record(setup.begin() + static_cast<std::ptrdiff_t>(i * columns),
                                     setup.begin() + static_cast<std::ptrdiff_t>((i + 1) * columns));
    record.back() += 1;
    bs_divergence first{};
    first.size = sizeof first;
    EXPECT_EQ(bs_check(model.get(), BS_STAGE_SETUP, record.data(), 1, &first), BS_DIFFERENT);
    const auto triangle = static_cast<std::uint64_t>(record[0]);
    EXPECT_EQ(first.draw, triangle);
    EXPECT_EQ(first.frame, 100 + triangle / 4);
  }
}

TEST(LibCheck, GoesOnBehindClearedRecords) {
  Pair p;
  const bs_view view = records_view(p.golden.get(), BS_STAGE_SPAN);
  ASSERT_EQ(bs_check(p.model.get(), BS_STAGE_SPAN, static_cast<const std::int64_t*>(view.base), 5, nullptr),
            BS_OK);
  ASSERT_EQ(bs_clear_records(p.model.get()), BS_OK);
  ASSERT_EQ(bs_clear_records(p.golden.get()), BS_OK);
  EXPECT_EQ(bs_unchecked(p.model.get(), BS_STAGE_SPAN), 0U);
  for (bs_model* const each : {p.model.get(), p.golden.get()}) {
    ASSERT_EQ(bs_draw(each, p.described.vertices.data(), nullptr, p.scene.triangles.size(), 0, 0), BS_OK);
  }
  const bs_view more = records_view(p.golden.get(), BS_STAGE_SPAN);
  EXPECT_EQ(more.rows, view.rows);
  EXPECT_EQ(
      bs_check(p.model.get(), BS_STAGE_SPAN, static_cast<const std::int64_t*>(more.base), more.rows, nullptr),
      BS_OK)
      << bs_last_error();
  bs_divergence first{};
  first.size = sizeof first;
  const std::vector<std::int64_t> extra(more.columns);
  EXPECT_EQ(bs_check(p.model.get(), BS_STAGE_SPAN, extra.data(), 1, &first), BS_DIFFERENT);
  EXPECT_EQ(first.kind, BS_DIVERGENCE_EXTRA);
  EXPECT_EQ(first.record, view.rows + more.rows);
}

}  // namespace
}  // namespace bitspan
