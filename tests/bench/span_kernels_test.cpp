// SPDX-License-Identifier: Apache-2.0
// The baselines of the kernel benchmark do the model's work: each value of each pixel.
#include "bench/span_kernels.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "bench/plain_kernel.hpp"
#include "model/simd/shipped.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::bench {
namespace {

constexpr int spans = 60;

SpanOutput by_stage_functions(const SpanCase& c) {
  SpanOutput out;
  Counters counters;
  std::vector<FragmentRecord> fragments;
  for (const SpanRecord& span : c.spans) {
    model::span_to_fragments(c.pipeline, span, nullptr, fragments, counters);
  }
  for (const FragmentRecord& f : fragments) {
    out.h.push_back(f.h);
    out.u.push_back(f.u);
    out.v.push_back(f.v);
  }
  return out;
}

std::size_t differences(const std::vector<std::int64_t>& a, const std::vector<std::int64_t>& b) {
  std::size_t n = a.size() == b.size() ? 0 : a.size() + b.size();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    n += a[i] != b[i] ? 1U : 0U;
  }
  return n;
}

void compare_all(const Config& config) {
  const SpanCase c = make_span_case(config, spans, 1, 300);
  const SpanOutput expected = by_stage_functions(c);
  ASSERT_EQ(expected.u.size(), static_cast<std::size_t>(c.pixels));
  ASSERT_GT(c.pixels, 5000);
  EXPECT_GT(differences(expected.u, std::vector<std::int64_t>(expected.u.size(), expected.u[0])), 4000U);
  for (const NamedKernel& named : span_kernels()) {
    SCOPED_TRACE(std::string(named.name) + " of " + config.name);
    SpanOutput out;
    resize(out, c);
    if (named.name == "model, specialised" && model::shipped_index(config).spans < 0) {
      EXPECT_THROW(named.make(c), InputError);
      continue;
    }
    const SpanKernel kernel = named.make(c);
    kernel(nullptr);  // as it is timed; it leaves nothing behind
    kernel(&out);
    EXPECT_EQ(differences(out.h, expected.h), 0U);
    // Doubles underneath may round a product of 61 bits early: one texel place, seldom.
    const std::size_t allowed = named.exact ? 0U : static_cast<std::size_t>(c.pixels / 100);
    EXPECT_LE(differences(out.u, expected.u), allowed);
    EXPECT_LE(differences(out.v, expected.v), allowed);
  }
}

TEST(SpanKernels, Depth16) { compare_all(shipped_config("depth16")); }
TEST(SpanKernels, Depth16Restoring) { compare_all(restoring_of(shipped_config("depth16"))); }

TEST(SpanKernels, PlainRefusesOtherWidths) {
  Config config = shipped_config("depth16");
  config.format(FormatId::span_uv).word = 24;
  const SpanCase c = make_span_case(config, 1, 8, 8);
  EXPECT_THROW(make_plain(c), InputError);
}

}  // namespace
}  // namespace bitspan::bench

extern "C" int sc_main(int /*argc*/, char** /*argv*/) { return 0; }

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
