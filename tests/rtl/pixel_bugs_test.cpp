// SPDX-License-Identifier: Apache-2.0
// A bug in the RTL of a pixel stage is a difference of the engine `rtl` at that stage.
#include <gtest/gtest.h>

#include "model/engine_model.hpp"
#include "report/lockstep.hpp"
#include "scene/demo.hpp"
#include "tb/engine_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Comparison compare() {
  const Config config = shipped_config("depth16");
  std::vector<std::unique_ptr<Engine>> engines;
  engines.push_back(make_model(config));
  engines.push_back(make_rtl(config));
  return run_lock_step(engines, demo_scene(128, 96), {}).pairs.at(0);
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
  for (const auto& [bug, type, field] : bugs) {
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
  // A pipe that never empties.
  copy.replace("rtl/pixel_pipe.sv", "assign lives = !killed;", "assign lives = 1'b1;");
  const std::string fault = compare().fault;
  EXPECT_NE(fault.find("the RTL's pixel stages stand still at clock"), std::string::npos) << fault;
}

}  // namespace
}  // namespace bitspan
