// SPDX-License-Identifier: Apache-2.0
// Stages of the caller's: one that changes nothing changes nothing, a change reaches all behind it, and what
// a stage cannot make is refused.
#include <gtest/gtest.h>

#include <array>
#include <string_view>

#include "engine/records.hpp"
#include "scene/random.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Scene scene_of(std::uint64_t seed) {
  RandomOptions options;
  options.triangles = 15;
  options.size_max = 50;
  options.width = 96;
  options.height = 64;
  return random_scene(seed, options);
}

bool may_be_overridden(bs_stage stage) {
  return stage != BS_STAGE_CONSTANTS && stage != BS_STAGE_STATE && stage != BS_STAGE_PLANE_WALK;
}

std::int32_t count_calls(void* user, const std::int64_t*, std::size_t n_in, std::int64_t*,
                         std::size_t n_out) {
  *static_cast<std::uint64_t*>(user) += n_in > 0 && n_out > 0 ? 1 : 0;
  return 0;
}

TEST(LibOverride, AStageThatChangesNothingChangesNothing) {
  std::uint64_t seed = 1;
  for (const Perspective mode : all_perspectives) {
    const Scene scene = scene_of(seed++);
    const Described described(scene);
    const ConfigHandle config = config_handle("depth20", std::string(to_string(mode)));
    const ModelHandle plain = open_model(config.get(), "model");
    const ModelHandle overridden = open_model(config.get(), "model");
    std::array<std::uint64_t, record_types> calls{};
    for (bs_stage stage = 0; stage < record_types; ++stage) {
      if (!may_be_overridden(stage)) continue;
      ASSERT_EQ(
          bs_stage_override(overridden.get(), stage, count_calls, &calls[static_cast<std::size_t>(stage)]),
          BS_OK);
    }
    draw(plain.get(), described);
    draw(overridden.get(), described);
    for (bs_stage stage = 0; stage < record_types; ++stage) {
      EXPECT_TRUE(records(overridden.get(), stage) == records(plain.get(), stage)) << bs_stage_name(stage);
      if (!may_be_overridden(stage)) continue;
      EXPECT_EQ(calls[static_cast<std::size_t>(stage)], records_view(plain.get(), stage).rows)
          << bs_stage_name(stage);
    }
    EXPECT_EQ(plane<std::uint8_t>(overridden.get(), BS_PLANE_COLOR),
              plane<std::uint8_t>(plain.get(), BS_PLANE_COLOR));
    for (int i = 0; bs_counter_name(i) != nullptr; ++i) {
      std::int64_t a = -1;
      std::int64_t b = -2;
      EXPECT_EQ(bs_counter(overridden.get(), bs_counter_name(i), &a), BS_OK);
      EXPECT_EQ(bs_counter(plain.get(), bs_counter_name(i), &b), BS_OK);
      EXPECT_EQ(a, b) << bs_counter_name(i);
    }
  }
}

// Makes every fragment fail the depth test in the left half of the picture.
std::int32_t hide_left(void*, const std::int64_t* in, std::size_t, std::int64_t* out, std::size_t n_out) {
  const auto z = [out](std::string_view field) -> std::int64_t& {
    return out[field_index(RecordType::depth, field)];
  };
  const std::int64_t x = in[field_index(RecordType::fragment, "x")];
  if (x != z("x") || n_out != fields<DepthRecord>.size()) return 1;
  if (x < 48) z("pass") = 0;
  return 0;
}

TEST(LibOverride, AChangeReachesAllBehindIt) {
  const Scene scene = scene_of(4);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle model = open_model(config.get(), "model");
  draw(model.get(), described);
  const auto whole = plane<std::uint8_t>(model.get(), BS_PLANE_COLOR);
  const std::string text = bs_run_text(model.get());
  EXPECT_EQ(text, "engine model, configuration depth16 (" + std::string(bs_config_hash(config.get())) + ")");

  ASSERT_EQ(bs_stage_override(model.get(), BS_STAGE_DEPTH, hide_left, nullptr), BS_OK);
  EXPECT_EQ(bs_run_text(model.get()), text) << "holds from the next bs_begin on";
  draw(model.get(), described);
  EXPECT_EQ(bs_run_text(model.get()), text + ", overridden stages: depth; not checked by golden");
  const auto hidden = plane<std::uint8_t>(model.get(), BS_PLANE_COLOR);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const std::size_t x = i / 4 % 96;
    const std::uint8_t background = i % 4 == 3 ? 255 : scene.background[i % 4];
    EXPECT_EQ(hidden[i], x < 48 ? background : whole[i]);
    changed += hidden[i] != whole[i] ? 1 : 0;
  }
  EXPECT_GT(changed, 100U);

  ASSERT_EQ(bs_stage_override(model.get(), BS_STAGE_DEPTH, nullptr, nullptr), BS_OK);
  EXPECT_NE(bs_run_text(model.get()), text) << "the records are still the overridden ones";
  draw(model.get(), described);
  EXPECT_EQ(plane<std::uint8_t>(model.get(), BS_PLANE_COLOR), whole);
  EXPECT_EQ(bs_run_text(model.get()), text);
}

struct Change {
  std::size_t field;
  std::int64_t value;
};
std::int32_t change(void* user, const std::int64_t*, std::size_t, std::int64_t* out, std::size_t) {
  const Change& what = *static_cast<const Change*>(user);
  out[what.field] = what.value;
  return 0;
}
std::int32_t refuse(void*, const std::int64_t*, std::size_t, std::int64_t*, std::size_t) { return 1; }

TEST(LibOverride, WhatAStageCannotMakeIsRefused) {
  const Scene scene = scene_of(5);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle model = open_model(config.get(), "model");
  const auto drawn = [&](bs_stage stage, bs_stage_fn function, void* user) {
    for (bs_stage s = 1; s < 4; ++s) EXPECT_EQ(bs_stage_override(model.get(), s, nullptr, nullptr), BS_OK);
    EXPECT_EQ(bs_stage_override(model.get(), BS_STAGE_SPAN, nullptr, nullptr), BS_OK);
    EXPECT_EQ(bs_stage_override(model.get(), stage, function, user), BS_OK);
    EXPECT_EQ(bs_begin(model.get(), &described.desc), BS_OK) << bs_last_error();
    return bs_draw(model.get(), described.vertices.data(), nullptr, 5, 0, 0);
  };
  const auto field = [](RecordType type, std::string_view name) {
    return static_cast<std::size_t>(field_index(type, name));
  };
  Change too_large{field(RecordType::fragment, "h"), INT64_MAX};
  Change elsewhere{field(RecordType::fragment, "x"), 5000};
  Change covered{field(RecordType::fragment, "covered"), 2};
  Change longer{field(RecordType::row, "x_last"), 90};
  Change turned{field(RecordType::setup, "y2"), -2000};
  Change fine{field(RecordType::fragment, "u"), 3};
  EXPECT_EQ(drawn(BS_STAGE_SPAN, refuse, nullptr), BS_BAD_INPUT);
  EXPECT_EQ(drawn(BS_STAGE_SPAN, change, &too_large), BS_BAD_INPUT);
  EXPECT_EQ(drawn(BS_STAGE_SPAN, change, &elsewhere), BS_BAD_INPUT);
  EXPECT_EQ(drawn(BS_STAGE_SPAN, change, &covered), BS_BAD_INPUT);
  EXPECT_EQ(drawn(BS_STAGE_EDGE_WALK, change, &longer), BS_BAD_INPUT);
  EXPECT_EQ(drawn(BS_STAGE_SETUP, change, &turned), BS_BAD_INPUT);
  EXPECT_NE(std::string(bs_last_error()).find("setup: y0, y1, y2"), std::string::npos) << bs_last_error();
  // A picture that broke off is no picture.
  bs_view view{};
  view.size = sizeof view;
  EXPECT_EQ(bs_frame_view(model.get(), BS_PLANE_COLOR, &view), BS_BAD_ORDER);
  EXPECT_EQ(drawn(BS_STAGE_SPAN, change, &fine), BS_OK) << bs_last_error();
}

// Registers of every stage, anywhere in their formats.
struct RandomStage {
  bs_config* config;
  bs_stage stage;
  Random random;
};
std::int32_t randomise(void* user, const std::int64_t*, std::size_t, std::int64_t* out, std::size_t n) {
  auto& r = *static_cast<RandomStage*>(user);
  for (std::size_t i = 0; i < n; ++i) {
    bs_field_info info{};
    info.size = sizeof info;
    bs_field(r.config, r.stage, static_cast<int>(i), &info);
    const std::string name = info.name;
    if (info.word == 0 || name == "phase" ||
        (r.stage == BS_STAGE_SETUP && (name[0] == 'x' || name[0] == 'y')))
      continue;
    const int magnitude = info.word - info.is_signed;
    const std::int64_t high = magnitude >= 63 ? INT64_MAX : (std::int64_t{1} << magnitude) - 1;
    out[i] = r.random.integer(info.is_signed != 0 ? -high - 1 : 0, high);
  }
  return 0;
}

TEST(LibOverride, RandomRegistersOfEveryStageCrashNothing) {
  const Scene scene = scene_of(6);
  const Described described(scene);
  for (const Perspective mode : all_perspectives) {
    const ConfigHandle config = config_handle("depth16", std::string(to_string(mode)));
    for (bs_stage stage = 0; stage < record_types; ++stage) {
      if (!may_be_overridden(stage)) continue;
      const ModelHandle model = open_model(config.get(), "model");
      RandomStage random{config.get(), stage, Random(static_cast<std::uint64_t>(stage))};
      ASSERT_EQ(bs_stage_override(model.get(), stage, randomise, &random), BS_OK);
      draw(model.get(), described);
    }
  }
}

}  // namespace
}  // namespace bitspan
