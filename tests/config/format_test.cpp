// SPDX-License-Identifier: Apache-2.0
// The names of formats and enumerators, and how record fields decode.
#include "config/format.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "config/names.hpp"
#include "engine/records.hpp"
#include "tests/config/support.hpp"

namespace bitspan {
namespace {

TEST(Format, KeysAreDistinctAndOfTheFormStageDotRegister) {
  std::set<std::string_view> keys;
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    const std::string_view key = key_of(id);
    EXPECT_TRUE(keys.insert(key).second) << key;
    EXPECT_EQ(std::ranges::count(key, '.'), 1) << key;
    EXPECT_FALSE(unit_of(id).empty()) << key;
    EXPECT_FALSE(text_of(id).empty()) << key;
  }
  EXPECT_EQ(key_of(FormatId::setup_s), "setup.s");
  EXPECT_EQ(key_of(FormatId::merge_color), "merge.color");
  EXPECT_EQ(unit_of(FormatId::span_f_step), "texel*depth code/pixel");
  EXPECT_EQ(key_of(FormatId::count), "?");
}

TEST(Format, ModeNamesAreSystemCs) {
  EXPECT_EQ(to_string(Rounding::rnd), "SC_RND");
  EXPECT_EQ(to_string(Rounding::rnd_zero), "SC_RND_ZERO");
  EXPECT_EQ(to_string(Rounding::rnd_min_inf), "SC_RND_MIN_INF");
  EXPECT_EQ(to_string(Rounding::rnd_inf), "SC_RND_INF");
  EXPECT_EQ(to_string(Rounding::rnd_conv), "SC_RND_CONV");
  EXPECT_EQ(to_string(Rounding::trn), "SC_TRN");
  EXPECT_EQ(to_string(Rounding::trn_zero), "SC_TRN_ZERO");
  EXPECT_EQ(to_string(Overflow::wrap), "SC_WRAP");
  EXPECT_EQ(to_string(Overflow::sat), "SC_SAT");
  EXPECT_EQ(to_string(Overflow::sat_zero), "SC_SAT_ZERO");
  EXPECT_EQ(to_string(Overflow::sat_sym), "SC_SAT_SYM");
  EXPECT_EQ(to_string(Overflow::wrap_sm), "SC_WRAP_SM");
  EXPECT_EQ(enum_names<Rounding>.size(), static_cast<std::size_t>(rounding_modes));
  EXPECT_EQ(enum_names<Overflow>.size(), static_cast<std::size_t>(overflow_modes));
  EXPECT_EQ(enum_names<Stage>.size(), static_cast<std::size_t>(stage_count));
  EXPECT_EQ(to_string(Stage::span_setup), "span_setup");
  EXPECT_EQ(to_string(Perspective::const_depth_rows), "const_depth_rows");
  EXPECT_EQ(to_string(static_cast<Perspective>(9)), "?");
}

template <class R>
const Field& field(std::string_view name) {
  for (const Field& f : fields<R>) {
    if (f.name == name) return f;
  }
  throw std::out_of_range(std::string(name));
}

TEST(Format, RecordFieldsDecodeOnTheirFormats) {
  Config c = shipped_config("depth16");
  EXPECT_EQ(format_of(field<SpanRecord>("count"), c), std::nullopt);
  EXPECT_EQ(format_of(field<SpanRecord>("h"), c), c.format(FormatId::span_h));
  EXPECT_EQ(format_of(field<SetupRecord>("x0"), c), c.coordinate_format());
  EXPECT_EQ(format_of(field<DepthRecord>("z"), c), c.depth_format());
  EXPECT_EQ(format_of(field<EdgeRecord>("recip_m"), c), c.edge_reciprocal.output);
  EXPECT_EQ(format_of(field<SpanRecord>("recip_m"), c), c.row_reciprocal.output);
  EXPECT_EQ(format_of(field<FragmentRecord>("recip_m"), c), c.pixel_reciprocal.output);
  const auto phase = format_of(field<SpanRecord>("phase"), c);
  ASSERT_TRUE(phase.has_value());
  EXPECT_EQ(phase->fraction(), c.format(FormatId::plane_k).fraction());
  EXPECT_EQ(phase->integer, 0);
  EXPECT_FALSE(phase->is_signed);
  for (const Perspective mode : all_perspectives) {
    c.perspective = mode;
    const bool linear = mode == Perspective::affine || mode == Perspective::const_depth_rows;
    EXPECT_EQ(format_of(field<SpanRecord>("fu"), c),
              c.format(linear ? FormatId::span_uv_acc : FormatId::span_f));
    EXPECT_EQ(format_of(field<SpanRecord>("fu_step0"), c),
              c.format(linear ? FormatId::span_uv_step : FormatId::span_f_step));
  }
}

}  // namespace
}  // namespace bitspan
