// SPDX-License-Identifier: Apache-2.0
// The comparator finds what was corrupted by hand: each field of each record type, lost and extra records.
#include "report/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "report/describe.hpp"

namespace bitspan {
namespace {

constexpr std::int64_t triangles = 3;
constexpr std::int64_t per_triangle = 4;

// Records whose identities are those of a real run: in order of the triangles, rows below one another.
template <class R>
void fill(std::vector<R>& out, RecordType type) {
  for (std::int64_t t = 0; t < triangles; ++t) {
    for (std::int64_t i = 0; i < per_triangle; ++i) {
      R record;
      auto* raw = reinterpret_cast<std::int64_t*>(&record);
      const auto all = fields_of(type);
      for (std::size_t f = 0; f < all.size(); ++f) {
        raw[f] = 1000 * t + 100 * i + static_cast<std::int64_t>(f) + 1;
      }
      const auto set = [&](std::string_view name, std::int64_t value) {
        if (const int at = field_index(type, name); at >= 0) {
          raw[at] = value;
        }
      };
      const Per per = row_of(type).per;
      const bool one_a_triangle = per == Per::triangle || per == Per::change;
      set("triangle", one_a_triangle ? per_triangle * t + i : t);
      set("edge", i);
      set("row", i);
      set("x", 10 + i);
      set("y", type == RecordType::row ? 20 + i : 20 + t);
      set("count", 1);
      out.push_back(record);
    }
  }
}

Trace sample_trace() {
  Trace trace;
#define BITSPAN_FILL(Record, LIST, stage, member) fill(trace.member, RecordType::member);
  BITSPAN_RECORDS(BITSPAN_FILL)
#undef BITSPAN_FILL
  trace.constants.resize(1);
  return trace;
}

std::int64_t* record_at(Trace& trace, RecordType type, std::size_t i) {
  return const_cast<std::int64_t*>(view_of(trace, type).record(i).data());
}

Comparison compare(const Trace& a, const Trace& b) {
  Comparison out;
  out.reference = "golden";
  out.other = "model";
  NonTrivial non_trivial;
  compare_traces(a, b, non_trivial.count(a), out);
  return out;
}

Config config() {
  Config c;
  c.name = "hand";
  for (Format& f : c.formats) {
    f = {24, 16, true, Rounding::trn, Overflow::sat, false};
  }
  c.edge_reciprocal.output = c.row_reciprocal.output =
      c.pixel_reciprocal.output = {19, 1, false, Rounding::rnd, Overflow::sat, false};
  return c;
}

class EveryType : public ::testing::TestWithParam<int> {
 protected:
  RecordType type() const { return static_cast<RecordType>(GetParam()); }
};

TEST_P(EveryType, EachCorruptedFieldIsFoundAndNamed) {
  const Trace a = sample_trace();
  const RecordView view = view_of(a, type());
  const std::size_t at = view.records / 2;
  for (std::size_t f = 0; f < view.fields.size(); ++f) {
    Trace b = a;
    // Triangle is what records are grouped by; it changes to one that no record has.
    record_at(b, type(), at)[f] += 1 << 20;
    const Comparison pair = compare(a, b);
    ASSERT_TRUE(pair.first) << view.fields[f].name;
    EXPECT_EQ(pair.first->stage, view.stage);
    EXPECT_EQ(pair.first->kind, DivergenceKind::value);
    EXPECT_EQ(pair.first->field, view.fields[f].name);
    EXPECT_EQ(pair.first->other - pair.first->reference, 1 << 20);
    EXPECT_EQ(pair.differences(), 1U);
    EXPECT_EQ(pair.stages[static_cast<std::size_t>(GetParam())].values, view.records * view.fields.size());
    const std::string text = describe(*pair.first, config(), {"hand", "bitspan verify hand"});
    EXPECT_NE(text.find("bitspan verify hand"), std::string::npos);
    EXPECT_NE(text.find(std::string(view.fields[f].name)), std::string::npos);
    EXPECT_NE(text.find("distance       1048576"), std::string::npos) << text;
    EXPECT_EQ(summary(*pair.first, config()).find('\n'), std::string::npos);
  }
}

TEST_P(EveryType, OneLostRecordIsOneUnmatchedRecord) {
  if (type() == RecordType::constants) {
    GTEST_SKIP() << "one record only";
  }
  const Trace a = sample_trace();
  const std::size_t lost = per_triangle + 1;
  Trace b = a;
  switch (type()) {
#define BITSPAN_ERASE(Record, LIST, stage, member)                        \
  case RecordType::member:                                                \
    b.member.erase(b.member.begin() + static_cast<std::ptrdiff_t>(lost)); \
    break;
    BITSPAN_RECORDS(BITSPAN_ERASE)
#undef BITSPAN_ERASE
    case RecordType::count:
      break;
  }
  const Comparison missing = compare(a, b);
  ASSERT_TRUE(missing.first);
  EXPECT_EQ(missing.first->stage, stage_of(type()));
  EXPECT_EQ(missing.stages[static_cast<std::size_t>(GetParam())].unmatched, 1U);
  const Comparison extra = compare(b, a);
  ASSERT_TRUE(extra.first);
  EXPECT_EQ(extra.stages[static_cast<std::size_t>(GetParam())].unmatched, 1U);
  EXPECT_EQ(missing.first->kind, DivergenceKind::missing);
  EXPECT_EQ(missing.differences(), 1U);
  EXPECT_EQ(extra.first->kind, DivergenceKind::extra);
  EXPECT_EQ(extra.differences(), 1U);
  EXPECT_NE(describe(*extra.first, config(), {"s", "c"}).find("delivered by model only"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Records, EveryType, ::testing::Range(0, record_types), [](const auto& info) {
  std::string name(stage_of(static_cast<RecordType>(info.param)));
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(Compare, EqualTracesCountEverythingAndDifferNowhere) {
  const Trace a = sample_trace();
  const Comparison pair = compare(a, a);
  EXPECT_TRUE(pair.held());
  EXPECT_EQ(pair.differences(), 0U);
  std::uint64_t values = 0;
  for (int t = 0; t < record_types; ++t) {
    const RecordView view = view_of(a, static_cast<RecordType>(t));
    values += view.records * view.fields.size();
  }
  EXPECT_EQ(pair.total().values, values);
  EXPECT_GT(pair.total().non_trivial, 0U);
}

TEST(Compare, FirstIsTheEarliestTriangleThenTheEarliestStage) {
  const Trace a = sample_trace();
  Trace b = a;
  b.setup[2 * per_triangle].h0 ^= 1;     // triangle 2, an early stage
  b.merge[per_triangle].z ^= 1;          // triangle 1, the last stage
  b.fragment[per_triangle + 2].fu ^= 1;  // triangle 1, an earlier one
  const Comparison pair = compare(a, b);
  ASSERT_TRUE(pair.first);
  EXPECT_EQ(pair.first->stage, "span");
  EXPECT_EQ(pair.first->field, "fu");
  EXPECT_EQ(pair.first->triangle, 1);
  EXPECT_EQ(pair.differences(), 3U);
}

TEST(Compare, AFragmentIsReportedWithItsSpan) {
  const Trace a = sample_trace();
  Trace b = a;
  b.fragment[5].u += 3;
  const Comparison pair = compare(a, b);
  ASSERT_TRUE(pair.first);
  ASSERT_EQ(pair.first->upstream.size(), 1U);
  EXPECT_EQ(pair.first->upstream[0].type, RecordType::span);
  // Each span of the sample has one pixel, so the fragment's place is its span's.
  EXPECT_EQ(pair.first->upstream[0].values[0], a.span[5].triangle);
  EXPECT_EQ(pair.first->upstream[0].values[1], a.span[5].x);
  const std::string text = describe(*pair.first, config(), {"s", "c"});
  EXPECT_NE(text.find("3 ULP"), std::string::npos) << text;
  EXPECT_NE(text.find("fed by span_setup in golden"), std::string::npos) << text;
  EXPECT_NE(text.find("texel"), std::string::npos) << text;
}

TEST(Compare, NonTrivialIsNeitherZeroNorTheValueBefore) {
  Trace trace;
  trace.merge = {{0, 5, 5, 0, 7, 7, 0}, {0, 6, 5, 0, 7, 8, 0}};
  NonTrivial counter;
  const auto merge = static_cast<std::size_t>(RecordType::merge);
  EXPECT_EQ(counter.count(trace)[merge], 4U + 2U);
  // The next batch goes on from the last record of this one.
  Trace next;
  next.merge = {{0, 6, 5, 0, 7, 8, 0}};
  EXPECT_EQ(counter.count(next)[merge], 0U);
  next.merge = {{1, 6, 5, 0, 7, 8, 9}};
  EXPECT_EQ(counter.count(next)[merge], 2U);
}

Frame sample_frame() {
  Frame f;
  f.width = 2;
  f.height = 2;
  f.color.assign(16, 9);
  f.depth.assign(4, 7);
  f.u.assign(4, std::numeric_limits<double>::quiet_NaN());
  f.v.assign(4, 0.5);
  f.triangle.assign(4, 0);
  return f;
}

TEST(Compare, PicturesDifferInAnyPlane) {
  const Frame a = sample_frame();
  const auto differences = [&](const Frame& b) {
    Comparison pair;
    compare_frames(a, b, pair);
    EXPECT_EQ(pair.first.has_value(), pair.differences() > 0);
    if (pair.first) {
      EXPECT_EQ(pair.first->x, 1);
      EXPECT_EQ(pair.first->y, 1);
    }
    return pair.differences();
  };
  EXPECT_EQ(differences(a), 0U);
  Frame b = a;
  b.color[13] = 8;
  EXPECT_EQ(differences(b), 1U);
  b = a;
  b.depth[3] = 8;
  EXPECT_EQ(differences(b), 1U);
  b = a;
  b.u[3] = 1;
  EXPECT_EQ(differences(b), 1U);
  b = a;
  b.v[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(differences(b), 1U);
  b = a;
  b.triangle[3] = 1;
  EXPECT_EQ(differences(b), 1U);
}

TEST(Compare, EachCounterIsComparedButCycles) {
  int compared = 0;
  for_each_counter([&](const CounterInfo& info, auto member) {
    Counters a;
    a.rows = 5;
    Counters b = a;
    b.*member += 1;
    Comparison pair;
    compare_counters(a, b, pair);
    if (info.name == "cycles") {
      EXPECT_EQ(pair.differences(), 0U);
      return;
    }
    ++compared;
    EXPECT_EQ(pair.differences(), 1U) << info.name;
    ASSERT_TRUE(pair.first) << info.name;
    EXPECT_EQ(pair.first->field, info.name);
    EXPECT_EQ(pair.first->other - pair.first->reference, 1);
  });
  EXPECT_EQ(compared, 15);
}

}  // namespace
}  // namespace bitspan
