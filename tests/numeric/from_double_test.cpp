// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/from_double.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "model/numeric/quantize.hpp"
#include "tests/numeric/modes.hpp"
#include "tests/numeric/rational.hpp"

namespace bitspan {
namespace {

using model::exact_of;

TEST(FromDouble, KnownValues) {
  EXPECT_EQ(exact_of(0.0).raw, 0);
  EXPECT_EQ(exact_of(-0.0).raw, 0);
  EXPECT_EQ(exact_of(1.0).raw, 1);
  EXPECT_EQ(exact_of(1.0).fraction, 0);
  EXPECT_EQ(exact_of(-0.375).raw, -3);
  EXPECT_EQ(exact_of(-0.375).fraction, 3);
  EXPECT_EQ(exact_of(4096.0).raw, 1);
  EXPECT_EQ(exact_of(4096.0).fraction, -12);
}

// Back through ldexp, which is exact; denormals and the largest numbers too.
TEST(FromDouble, LosesNothing) {
  using limits = std::numeric_limits<double>;
  std::vector<double> values{limits::min(), limits::denorm_min(), limits::max(), -limits::max(), 0.1, 1e-310};
  std::mt19937_64 random(3);
  while (values.size() < 20000) {
    const auto v = std::bit_cast<double>(random());
    if (std::isfinite(v)) {
      values.push_back(v);
    }
  }
  for (const double v : values) {
    const model::Exact e = exact_of(v);
    ASSERT_EQ(std::ldexp(static_cast<double>(static_cast<std::int64_t>(e.raw)), -e.fraction), v);
    ASSERT_TRUE(e.raw == 0 || (e.raw & 1) != 0);
  }
}

TEST(FromDouble, QuantisesAsTheRationalDoes) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 50000; ++i) {
    const Format f = random_format(random);
    const double v =
        std::ldexp(static_cast<double>(static_cast<std::int64_t>(random())), random_int(random, -110, 20));
    const model::Exact e = exact_of(v);
    const reference::Rational exact{v};
    ASSERT_EQ(model::quantize(e, model::make_register(f), model::NoObserve{}), reference::quantize(exact, f))
        << v;
  }
}

TEST(FromDouble, CeilLog2) {
  EXPECT_EQ(model::ceil_log2(1.0), 0);
  EXPECT_EQ(model::ceil_log2(1000.0), 10);
  EXPECT_EQ(model::ceil_log2(1024.0), 10);
  EXPECT_EQ(model::ceil_log2(std::nextafter(1024.0, 2000.0)), 11);
  EXPECT_EQ(model::ceil_log2(0.5), -1);
  EXPECT_EQ(model::ceil_log2(0.3), -1);
  EXPECT_EQ(model::ceil_log2(std::numeric_limits<double>::denorm_min()), -1074);
}

}  // namespace
}  // namespace bitspan
