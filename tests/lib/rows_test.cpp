// SPDX-License-Identifier: Apache-2.0
// Rows that come from elsewhere: those of a drawn scene make the same picture as its triangles, and rows of
// random registers are equal in golden and model.
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "config/modes.hpp"
#include "engine/records.hpp"
#include "lib/stages.hpp"
#include "scene/random.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using capi::stage_types;

constexpr std::array behind_rows{BS_STAGE_SPAN, BS_STAGE_DEPTH, BS_STAGE_TEXTURE, BS_STAGE_FOG,
                                 BS_STAGE_MERGE};

Scene scene_of(std::uint64_t seed) {
  RandomOptions options;
  options.triangles = 20;
  options.size_max = 50;
  options.width = 96;
  options.height = 64;
  return random_scene(seed, options);
}

std::size_t column(bs_stage stage, std::string_view name) {
  return static_cast<std::size_t>(field_index(stage_types[static_cast<std::size_t>(stage)], name));
}

// Rows of `stage` by their triangle, as (first value, number of rows).
void feed(bs_model* model, const Described& scene, bs_model* from, bs_stage stage, bool planes) {
  const bs_view rows = records_view(from, stage);
  const bs_view setups = records_view(from, BS_STAGE_SETUP);
  const auto* row = static_cast<const std::int64_t*>(rows.base);
  std::map<std::int64_t, const std::int64_t*> setup_of;
  for (std::size_t i = 0; i < setups.rows; ++i) {
    const auto* const s = static_cast<const std::int64_t*>(setups.base) + i * setups.columns;
    setup_of[s[column(BS_STAGE_SETUP, "triangle")]] = s;
  }
  std::int64_t last = -1;
  for (std::size_t i = 0; i < rows.rows; ++i, row += rows.columns) {
    const std::int64_t triangle = row[column(stage, "triangle")];
    if (planes && triangle != last) {
      ASSERT_EQ(bs_row(model, BS_STAGE_SETUP, setup_of.at(triangle), setups.columns, -1), BS_OK)
          << bs_last_error();
    }
    last = triangle;
    ASSERT_EQ(bs_row(model, stage, row, rows.columns, scene.texture_of[static_cast<std::size_t>(triangle)]),
              BS_OK)
        << bs_last_error();
  }
}

TEST(LibRows, RowsOfADrawnSceneMakeItsPicture) {
  std::uint64_t seed = 1;
  for (const Perspective mode : all_perspectives) {
    const bool planes = has_plane_rows(mode);
    const Scene scene = scene_of(seed++);
    const Described described(scene);
    const ConfigHandle config = config_handle("depth16", std::string(to_string(mode)));
    const ModelHandle drawn = open_model(config.get(), "golden");
    draw(drawn.get(), described);
    for (const std::string engine : {"golden", "model"}) {
      for (const bs_stage stage :
           {planes ? BS_STAGE_PLANE_WALK_ROW : BS_STAGE_EDGE_WALK, BS_STAGE_SPAN_SETUP}) {
        SCOPED_TRACE(std::string(to_string(mode)) + " " + engine + " " + bs_stage_name(stage));
        const ModelHandle fed = open_model(config.get(), engine);
        ASSERT_EQ(bs_begin(fed.get(), &described.desc), BS_OK) << bs_last_error();
        feed(fed.get(), described, drawn.get(), stage, planes);
        EXPECT_TRUE(records(fed.get(), stage) == records(drawn.get(), stage));
        EXPECT_TRUE(records(fed.get(), BS_STAGE_SPAN_SETUP) == records(drawn.get(), BS_STAGE_SPAN_SETUP));
        for (const bs_stage behind : behind_rows) {
          EXPECT_TRUE(records(fed.get(), behind) == records(drawn.get(), behind)) << bs_stage_name(behind);
        }
        EXPECT_EQ(plane<std::uint8_t>(fed.get(), BS_PLANE_COLOR),
                  plane<std::uint8_t>(drawn.get(), BS_PLANE_COLOR));
        EXPECT_EQ(plane<std::uint32_t>(fed.get(), BS_PLANE_DEPTH),
                  plane<std::uint32_t>(drawn.get(), BS_PLANE_DEPTH));
        for (const char* const name : {"rows", "fragments", "covered", "written", "divides_pixel"}) {
          std::int64_t a = -1;
          std::int64_t b = -2;
          EXPECT_EQ(bs_counter(fed.get(), name, &a), BS_OK);
          EXPECT_EQ(bs_counter(drawn.get(), name, &b), BS_OK);
          EXPECT_EQ(a, b) << name;
        }
      }
    }
  }
}

// Every register anywhere in its format; half of them at an end of it.
std::vector<std::int64_t> random_row(Random& random, bs_config* config, bs_stage stage, const Scene& scene) {
  const RecordType type = stage_types[static_cast<std::size_t>(stage)];
  std::vector<std::int64_t> row(fields_of(type).size());
  for (std::size_t i = 0; i < row.size(); ++i) {
    bs_field_info info{};
    info.size = sizeof info;
    EXPECT_EQ(bs_field(config, stage, static_cast<int>(i), &info), BS_OK);
    if (info.word == 0) continue;
    const int magnitude = info.word - info.is_signed;
    const std::int64_t high = magnitude >= 63 ? INT64_MAX : (std::int64_t{1} << magnitude) - 1;
    const std::int64_t low = info.is_signed != 0 ? -high - 1 : 0;
    row[i] = random.chance(0.25)  ? low
             : random.chance(0.3) ? high
             : random.chance(0.5) ? random.integer(low / 4096, high / 4096)
                                  : random.integer(low, high);
  }
  const auto set = [&](std::string_view name, std::int64_t value) { row[column(stage, name)] = value; };
  const std::int64_t x = random.integer(0, scene.width - 1);
  set("y", random.integer(0, scene.height - 1));
  if (stage == BS_STAGE_EDGE_WALK) {
    set("x_first", x);
    set("x_last", random.integer(x, scene.width - 1));
  } else {
    set("x", x);
    set("count", random.integer(1, scene.width - x));
    set("phase", 0);
  }
  return row;
}

TEST(LibRows, RandomRegistersAreEqualInGoldenAndModel) {
  Random random(7);
  for (const std::string name : {"depth16", "depth20", "narrow"}) {
    for (const Perspective mode : all_perspectives) {
      if (has_plane_rows(mode)) continue;
      const Scene scene = scene_of(9);
      const Described described(scene);
      const ConfigHandle config = config_handle(name, std::string(to_string(mode)));
      const ModelHandle golden = open_model(config.get(), "golden");
      const ModelHandle model = open_model(config.get(), "model");
      ASSERT_EQ(bs_begin(golden.get(), &described.desc), BS_OK);
      ASSERT_EQ(bs_begin(model.get(), &described.desc), BS_OK);
      for (int i = 0; i < 100; ++i) {
        const bs_stage stage = i % 2 == 0 ? BS_STAGE_EDGE_WALK : BS_STAGE_SPAN_SETUP;
        const auto row = random_row(random, config.get(), stage, scene);
        const auto texture = static_cast<std::int32_t>(
            random.integer(-1, static_cast<std::int64_t>(scene.textures.size()) - 1));
        ASSERT_EQ(bs_row(golden.get(), stage, row.data(), row.size(), texture), BS_OK) << bs_last_error();
        ASSERT_EQ(bs_row(model.get(), stage, row.data(), row.size(), texture), BS_OK) << bs_last_error();
      }
      for (const bs_stage behind : behind_rows) {
        const bs_view view = records_view(golden.get(), behind);
        bs_divergence first{};
        first.size = sizeof first;
        EXPECT_EQ(
            bs_check(model.get(), behind, static_cast<const std::int64_t*>(view.base), view.rows, &first),
            BS_OK)
            << name << " " << to_string(mode) << ": " << bs_last_error();
      }
      EXPECT_GT(bs_nontrivial(model.get()), 1000U);
    }
  }
}

TEST(LibRows, WhatIsNoRowIsRefused) {
  const Scene scene = scene_of(2);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle model = open_model(config.get(), "model");
  draw(model.get(), described);
  const std::vector<std::int64_t> rows = records(model.get(), BS_STAGE_EDGE_WALK);
  const std::size_t n = records_view(model.get(), BS_STAGE_EDGE_WALK).columns;
  const auto refused = [&](std::string_view field, std::int64_t value) {
    std::vector<std::int64_t> row(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(n));
    row[column(BS_STAGE_EDGE_WALK, field)] = value;
    EXPECT_EQ(bs_row(model.get(), BS_STAGE_EDGE_WALK, row.data(), n, -1), BS_BAD_INPUT) << field;
    EXPECT_NE(std::string(bs_last_error()).find(": " + std::string(field) + ": "), std::string::npos)
        << bs_last_error();
  };
  refused("y", -1);
  refused("y", scene.height);
  refused("x_first", -1);
  refused("x_last", scene.width);
  refused("l_edge", 3);
  refused("triangle", -1);
  refused("l_h", INT64_MAX);
  refused("r_fu", INT64_MIN);
  EXPECT_EQ(bs_row(model.get(), BS_STAGE_EDGE_WALK, rows.data(), n - 1, -1), BS_BAD_INPUT);
  EXPECT_EQ(bs_row(model.get(), BS_STAGE_EDGE_WALK, rows.data(), n, 99), BS_BAD_INPUT);
  EXPECT_EQ(bs_row(model.get(), BS_STAGE_DEPTH, rows.data(), n, -1), BS_BAD_INPUT);
  EXPECT_EQ(bs_row(model.get(), BS_STAGE_PLANE_WALK_ROW, rows.data(), n, -1), BS_BAD_INPUT);
  EXPECT_EQ(bs_row(model.get(), BS_STAGE_EDGE_WALK, rows.data(), n, -1), BS_OK) << bs_last_error();

  for (const char* const engine : {"timed", "ideal"}) {
    const ModelHandle other = open_model(config.get(), engine);
    ASSERT_EQ(bs_begin(other.get(), &described.desc), BS_OK);
    EXPECT_EQ(bs_row(other.get(), BS_STAGE_EDGE_WALK, rows.data(), n, -1), BS_UNSUPPORTED);
  }
}

TEST(LibRows, APlaneRowIsOneOfItsTriangle) {
  const Scene scene = scene_of(4);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16", "const_depth_rows");
  for (const char* const engine : {"golden", "model"}) {
    const ModelHandle model = open_model(config.get(), engine);
    draw(model.get(), described);
    std::vector<std::int64_t> row = records(model.get(), BS_STAGE_PLANE_WALK_ROW);
    std::vector<std::int64_t> setup = records(model.get(), BS_STAGE_SETUP);
    row.resize(records_view(model.get(), BS_STAGE_PLANE_WALK_ROW).columns);
    setup.resize(records_view(model.get(), BS_STAGE_SETUP).columns);
    const auto feed = [&](bs_stage stage, const std::vector<std::int64_t>& record) {
      return bs_row(model.get(), stage, record.data(), record.size(), -1);
    };
    EXPECT_EQ(feed(BS_STAGE_PLANE_WALK_ROW, row), BS_BAD_ORDER);
    ASSERT_EQ(feed(BS_STAGE_SETUP, setup), BS_OK) << bs_last_error();
    EXPECT_EQ(feed(BS_STAGE_PLANE_WALK_ROW, row), BS_OK) << bs_last_error();
    ++row[column(BS_STAGE_PLANE_WALK_ROW, "count")];
    EXPECT_EQ(feed(BS_STAGE_PLANE_WALK_ROW, row), BS_BAD_INPUT);
    std::vector<std::int64_t> flat = setup;
    flat[column(BS_STAGE_SETUP, "x1")] = flat[column(BS_STAGE_SETUP, "x0")];
    flat[column(BS_STAGE_SETUP, "y1")] = flat[column(BS_STAGE_SETUP, "y0")];
    EXPECT_EQ(feed(BS_STAGE_SETUP, flat), BS_BAD_INPUT);
    std::vector<std::int64_t> turned = setup;
    turned[column(BS_STAGE_SETUP, "mid_right")] ^= 1;
    EXPECT_EQ(feed(BS_STAGE_SETUP, turned), BS_BAD_INPUT);
  }
}

}  // namespace
}  // namespace bitspan
