// SPDX-License-Identifier: Apache-2.0
// RTL that delivers more than it was asked for is seen, by Verilator's bench and by Icarus', even where the
// surplus comes after the last pixel expected.
#include <gtest/gtest.h>

#include "model/engine_model.hpp"
#include "report/lockstep.hpp"
#include "tb/engine_rtl.hpp"
#include "tb/rtl_stream.hpp"
#include "tests/rtl/icarus_case.hpp"
#include "tests/rtl/interpolator_case.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// One record: nothing comes after its last pixel but the surplus.
InterpolatorCase one_record(const Config& config) {
  Random random(3);
  return make_interpolator_case(random, config, 1, 6);
}

TEST(Surplus, NoneWithTheRtlAsItIs) {
  const Config config = shipped_config("depth16");
  const InterpolatorCase given = one_record(config);
  Rtl rtl(config);
  const RtlRun run = run_rtl(rtl, given.inputs, {}, true);
  EXPECT_EQ(run.spans.size(), 1U);
  EXPECT_EQ(run.pixels.size(), given.pixels.size());
  // The clocks end with the last pixel's transfer, not with the last one looked at.
  EXPECT_EQ(run.clocks, run.delivered_at.back() + 1);
  EXPECT_EQ(run.handshakes.size(), run.clocks);
}

TEST(Surplus, APixelAfterTheLastIsSeen) {
  const Config config = shipped_config("depth16");
  const InterpolatorCase given = one_record(config);
  const RtlCopy copy;
  copy.plant_doubled_pixel();

  Rtl rtl(config);
  const RtlRun run = run_rtl(rtl, given.inputs, {}, true);
  ASSERT_EQ(run.pixels.size(), given.pixels.size() + 1);
  // The handshakes alone end too early to show it; the replay of them runs on as well.
  const std::vector<RtlHandshake> driven = run.handshakes;
  rtl.reset();
  EXPECT_EQ(replay_rtl(rtl, given.inputs, driven).pixels.size(), given.pixels.size() + 1);

  const TemporaryFolder folder;
  const IcarusRun icarus = prepare_icarus(folder, config, given);
  try {
    run_icarus(icarus.sources, "icarus_tb", icarus.arguments);
    FAIL() << "Icarus saw nothing";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("a pixel after the last of"), std::string::npos) << error.what();
  }
}

// A triangle of one row: one span.
Scene one_row() {
  Scene scene;
  scene.width = 16;
  scene.height = 8;
  scene.s_min = 1;
  scene.s_max = 100;
  Triangle triangle;
  triangle.v[0] = {2, 2.2, 4, 0, 0, {1, 1, 1, 1}};
  triangle.v[1] = {12, 2.4, 9, 8, 0, {1, 1, 1, 1}};
  triangle.v[2] = {7, 2.9, 6, 4, 4, {1, 1, 1, 1}};
  scene.triangles = {triangle};
  return scene;
}

TEST(Surplus, TheEngineShowsItAsARecordOfItsOwn) {
  const Config config = shipped_config("depth16");
  const Scene scene = one_row();
  const RtlCopy copy;
  copy.plant_doubled_pixel();
  std::vector<std::unique_ptr<Engine>> engines;
  engines.push_back(make_model(config));
  engines.push_back(make_rtl(config, {1, 0, 0}));
  const LockStepResult run = run_lock_step(engines, scene, {});
  ASSERT_EQ(engines[0]->counters().rows, 1U);
  const Comparison& pair = run.pairs.at(0);
  ASSERT_TRUE(pair.first);
  EXPECT_EQ(pair.first->kind, DivergenceKind::extra);
  EXPECT_EQ(pair.first->stage, "span");
  EXPECT_EQ(pair.first->triangle, 0);
  EXPECT_EQ(pair.stages[static_cast<std::size_t>(RecordType::fragment)].unmatched, 1U);
  // Without a trace there is no record to show it by.
  engines[1]->begin(scene);
  EXPECT_THROW(engines[1]->draw(scene.triangles, 0, nullptr), std::logic_error);
}

}  // namespace
}  // namespace bitspan
