// SPDX-License-Identifier: Apache-2.0
// A bug in the RTL of a pixel stage is a difference of the engine `rtl` at that stage.
#include <gtest/gtest.h>

#include "model/engine_model.hpp"
#include "report/lockstep.hpp"
#include "scene/demo.hpp"
#include "tb/engine_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Comparison compare(const Config& config = shipped_config("depth16"),
                   const Scene& scene = demo_scene(128, 96)) {
  std::vector<std::unique_ptr<Engine>> engines;
  engines.push_back(make_model(config));
  engines.push_back(make_rtl(config));
  return run_lock_step(engines, scene, {}).pairs.at(0);
}

struct PixelBug {
  PlantedBug bug;
  RecordType type;
  const char* field;
};

TEST(PixelBugs, TheFirstDivergenceNamesTheStage) {
  constexpr PixelBug bugs[] = {
      {{"rtl/depth.sv", "less_q <= joined_z < joined_stored;",
        "less_q <= joined_z[ZW-1:4] < joined_stored[ZW-1:4];"},
       RecordType::depth,
       "pass"},
      // Seen by the next fragment at the pixel: the memory is the picture's.
      {{"rtl/depth.sv", "assign write_valid_o = fate_valid && fate_write;",
        "assign write_valid_o = fate_valid && fate_write && write_x_o != CoordW'(40);"},
       RecordType::depth,
       "stored"},
      {{"rtl/texture.sv", "request0_address_o = first_row | AddressW'(first_i);",
        "request0_address_o = first_row | AddressW'(first_i ^ IndexW'(1));"},
       RecordType::texture,
       "texel_r"},
      {{"rtl/fog.sv", "entry_q <= entries[index_entry];", "entry_q <= ~entries[index_entry];"},
       RecordType::fog,
       "factor"},
      {{"rtl/merge.sv",
        "share_q <= waited_reads ? waited_a :", "share_q <= waited_reads ? waited_a ^ 1'b1 :"},
       RecordType::merge,
       "r"},
  };
  const RtlCopy copy;
  EXPECT_TRUE(compare().held());
  for (const auto& [bug, type, field] : in_gate(bugs)) {
    SCOPED_TRACE(bug.to);
    copy.replace(bug.file, bug.from, bug.to);
    const Comparison pair = compare();
    copy.replace(bug.file, bug.to, bug.from);
    EXPECT_EQ(pair.fault, "");
    ASSERT_TRUE(pair.first);
    EXPECT_EQ(pair.first->stage, stage_of(type));
    EXPECT_EQ(pair.first->field, field);
    EXPECT_TRUE(pair.first->triangle);
    EXPECT_GT(pair.frame.differences, 0U);
    EXPECT_EQ(pair.stages[static_cast<std::size_t>(RecordType::fragment)].differences, 0U);
  }
}

TEST(PixelBugs, OfLevels) {
  constexpr PixelBug of_levels[] = {
      {{"rtl/lod.sv", "level_q <= held_q[HeldFrac+:LevelW];",
        "level_q <= held_q[HeldFrac+:LevelW] ^ LevelW'(8);"},
       RecordType::lod,
       "level"},
      {{"rtl/texture_address.sv", "rows_3 <= {1'b0, last_2", "rows_3 <= {1'b1, last_2"},
       RecordType::texture,
       "texel_r"},
      {{"rtl/texture.sv", ".in_f_i(share_at_filter)", ".in_f_i(share_at_filter >> 1)"},
       RecordType::texture,
       "texel_r"},
  };
  const RtlCopy copy;
  const Config levels = level_configs()[2];
  const Scene floor = floor_scene(64, 48);
  EXPECT_TRUE(compare(levels, floor).held());
  for (const auto& [bug, type, field] : in_gate(of_levels)) {
    SCOPED_TRACE(bug.to);
    copy.replace(bug.file, bug.from, bug.to);
    const Comparison pair = compare(levels, floor);
    copy.replace(bug.file, bug.to, bug.from);
    EXPECT_EQ(pair.fault, "");
    ASSERT_TRUE(pair.first);
    EXPECT_EQ(pair.first->stage, stage_of(type));
    EXPECT_EQ(pair.first->field, field);
  }
}

TEST(PixelBugs, APipeThatNeverEmptiesIsAFault) {
  const RtlCopy copy;
  copy.replace("rtl/pixel_pipe.sv", "assign lives = !killed;", "assign lives = 1'b1;");
  const std::string fault = compare().fault;
  EXPECT_NE(fault.find("the RTL's pixel stages stand still at clock"), std::string::npos) << fault;
}

TEST(PixelBugs, OfABlendByEquation) {
  constexpr PixelBug bugs[] = {
      {{"rtl/blend_equation.sv", "sum_q <= stored - own;", "sum_q <= stored + own;"}, RecordType::merge, "r"},
      {{"rtl/blend_unit.sv", "(c == 3) ? in_alpha_op_i : in_op_i", "(c == 3) ? in_op_i : in_op_i"},
       RecordType::merge_alpha,
       "a"},
      {{"rtl/blend_needs.sv", "BlendFactorZero ||", "BlendFactorZero && 1'b0 ||"}, RecordType::merge, "r"},
  };
  Config config = shipped_config("depth16");
  config.rtl.blend = RtlBlend::equation;
  Scene scene = demo_scene(128, 96);
  const auto set = [&](std::size_t before,
                       std::initializer_list<std::pair<const char*, std::int64_t>> registers) {
    StateChange change;
    for (const auto& [key, value] : registers) {
      change.settings.push_back({*find_state_register(key), value});
    }
    scene.commands.push_back({before, change});
  };
  const auto number = [](auto name) { return static_cast<std::int64_t>(name); };
  set(0, {{"blend.op", number(BlendOp::reverse_subtract)},
          {"blend.alpha.src", number(BlendFactor::one)},
          {"blend.alpha.op", number(BlendOp::add)}});
  set(scene.triangles.size() / 2,
      {{"blend.src", number(BlendFactor::one)}, {"blend.op", number(BlendOp::add)}});
  const RtlCopy copy;
  const Comparison right = compare(config, scene);
  EXPECT_TRUE(right.held());
  EXPECT_GT(right.stages[static_cast<std::size_t>(RecordType::merge_alpha)].records, 1000U);
  for (const auto& [bug, type, field] : in_gate(bugs)) {
    SCOPED_TRACE(bug.to);
    copy.replace(bug.file, bug.from, bug.to);
    const Comparison pair = compare(config, scene);
    copy.replace(bug.file, bug.to, bug.from);
    EXPECT_EQ(pair.fault, "");
    ASSERT_TRUE(pair.first);
    EXPECT_EQ(pair.first->stage, stage_of(type));
    EXPECT_EQ(pair.first->field, field);
    EXPECT_GT(pair.frame.differences, 0U);
  }
}

}  // namespace
}  // namespace bitspan
