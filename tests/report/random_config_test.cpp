// Random configurations are legal, repeatable, and reach every mode.
#include "report/random_config.hpp"

#include <gtest/gtest.h>

#include <set>

#include "config/rtl_timing.hpp"
#include "golden/precision.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

RandomConfigOptions options() {
  RandomConfigOptions o;
  o.check = [](const Config& c) { static_cast<void>(golden::choose_precision(c)); };
  return o;
}

TEST(RandomConfig, IsLegalAndReadsBack) {
  const auto from = shipped_configs();
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Config c = random_config(seed, from, options());
    ASSERT_NO_THROW(check_config(c, "random")) << seed;
    ASSERT_EQ(config_hash(parse_config(to_toml(c), "random")), config_hash(c)) << seed;
  }
}

TEST(RandomConfig, TheSameSeedGivesTheSame) {
  const auto from = shipped_configs();
  EXPECT_EQ(random_config(5, from, options()), random_config(5, from, options()));
  EXPECT_NE(config_hash(random_config(5, from, options())), config_hash(random_config(6, from, options())));
}

TEST(RandomConfig, ReachesEveryMode) {
  const auto from = shipped_configs();
  std::set<int> perspective, pixel_kind, row_kind, edge_kind, depth, fog, rounding, overflow, fill, walk,
      filter, form;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Config c = random_config(seed, from, options());
    perspective.insert(static_cast<int>(c.perspective));
    pixel_kind.insert(static_cast<int>(c.pixel_reciprocal.kind));
    row_kind.insert(static_cast<int>(c.row_reciprocal.kind));
    edge_kind.insert(static_cast<int>(c.edge_reciprocal.kind));
    depth.insert(static_cast<int>(c.depth_code));
    fog.insert(static_cast<int>(c.fog));
    fill.insert(static_cast<int>(c.fill_rule));
    walk.insert(2 * static_cast<int>(c.edge_walk) + static_cast<int>(c.dda_update));
    filter.insert(2 * static_cast<int>(c.filter) + static_cast<int>(c.wrap));
    form.insert(2 * static_cast<int>(c.edge_slope) + static_cast<int>(c.row_slope));
    for (const Format& f : c.formats) {
      rounding.insert(static_cast<int>(f.rounding));
      overflow.insert(static_cast<int>(f.overflow));
    }
  }
  EXPECT_EQ(perspective.size(), 4U);
  EXPECT_EQ(pixel_kind.size(), 3U);
  EXPECT_EQ(row_kind.size(), 3U);
  EXPECT_EQ(edge_kind.size(), 3U);
  EXPECT_EQ(depth.size(), 3U);
  EXPECT_EQ(fog.size(), 3U);
  EXPECT_EQ(rounding.size(), 7U);
  EXPECT_EQ(overflow.size(), 5U);
  EXPECT_EQ(fill.size(), 2U);
  EXPECT_EQ(walk.size(), 4U);
  EXPECT_EQ(filter.size(), 4U);
  EXPECT_EQ(form.size(), 4U);
}

TEST(RandomConfig, RtlOnlyMeansThatTheRtlHasIt) {
  const auto from = shipped_configs();
  RandomConfigOptions o = options();
  o.rtl_only = true;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Config c = random_config(seed, from, o);
    ASSERT_TRUE(has_rtl(c));
    ASSERT_NO_THROW(static_cast<void>(rtl_timing(c)));
  }
}

}  // namespace
}  // namespace bitspan
