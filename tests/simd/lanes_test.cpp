// SPDX-License-Identifier: Apache-2.0
// The lanes of model/numeric/*-inl.hpp against the scalar routines, value for value and history for history,
// on every target that this processor has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "model/numeric/ratio.hpp"
#include "model/simd/targets.hpp"
#include "tests/numeric/modes.hpp"
#include "tests/simd/lane_comparison.hpp"
#include "tests/simd/lane_kernels.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

class LanesTest : public testing::TestWithParam<VectorTarget> {
 protected:
  void SetUp() override {
    if (!model::supported(GetParam())) GTEST_SKIP() << "this processor lacks the target";
    kernels_ = model::on_target(GetParam(), [] { return &model::lane_kernels(); });
  }
  const LaneKernels& kernels() const { return *kernels_; }

 private:
  const LaneKernels* kernels_ = nullptr;
};

INSTANTIATE_TEST_SUITE_P(Targets, LanesTest,
                         testing::Values(VectorTarget::avx512, VectorTarget::avx2, VectorTarget::baseline),
                         [](const auto& target) {
                           return target.param == VectorTarget::avx512 ? "avx512"
                                  : target.param == VectorTarget::avx2 ? "avx2"
                                                                       : "baseline";
                         });

TEST_P(LanesTest, AsManyLanesAsTheTargetHas) {
  const std::size_t lanes = GetParam() == VectorTarget::avx512 ? 8 : GetParam() == VectorTarget::avx2 ? 4 : 1;
  EXPECT_EQ(kernels().lanes, lanes);
}

// ---------------------------------------------------------------- Q of a binary fraction

TEST_P(LanesTest, QuantizeExhaustive) {
  Ran ran;
  std::vector<int128> values;
  for (int raw = -128; raw < 128; ++raw) values.push_back(raw);
  for (int word = 1; word <= 4; ++word) {
    for (int integer = -2; integer <= 6; ++integer) {
      for (const bool is_signed : {false, true}) {
        for_all_modes(word, integer, is_signed, [&](const Format& f) {
          std::vector<Case> cases;
          for (const int shift : {-3, -1, 0, 1, 2, 4, 6, 7, 9}) {
            check_uniform(kernels(), f, f.fraction() + shift, values, ran);
            for (int raw = -40; raw < 40; ++raw) cases.push_back({raw, f.fraction() + shift});
          }
          std::ranges::stable_sort(cases, {}, &Case::raw);  // neighbouring lanes shift by different amounts
          check_each(kernels(), f, cases, ran);
          if (HasFatalFailure()) GTEST_FAIL();
        });
        if (HasFatalFailure()) return;
      }
    }
  }
  for (const std::size_t n : {ran.narrow32, ran.narrow64, ran.wide, ran.each64, ran.each128}) {
    EXPECT_GT(n, 1000000U);
  }
}

// Kept values around zero and around the ends of the range (and of the next wraps), and what lies below them:
// nothing, the least, one below, at and above the tie, all but one.
std::vector<int128> boundaries(const Register& r, int shift) {
  std::vector<int128> kept{0, 1, 2, -1, -2};
  for (const int128 end :
       {int128{r.min}, int128{r.max}, power(r.word), -power(r.word), 3 * power(r.word - 1)}) {
    for (int off = -2; off <= 2; ++off) kept.push_back(end + off);
  }
  std::vector<int128> out;
  for (const int128 floor : kept) {
    if (shift <= 0) {
      out.push_back(floor >> -shift);
      out.push_back((floor >> -shift) + 1);
    } else if (shift + r.word <= 124) {
      for (const int128 below : {int128{0}, int128{1}, power(shift - 1) - 1, power(shift - 1),
                                 power(shift - 1) + 1, power(shift) - 1}) {
        if (below < power(shift)) out.push_back((floor << shift) + below);
      }
    }
  }
  // The ends of what lanes hold.
  for (const int bits : {30, 62, 126}) {
    for (const int128 off : {-1, 0, 1}) {
      out.push_back(power(bits) - off);
      out.push_back(-power(bits) + off);
    }
  }
  return out;
}

TEST_P(LanesTest, QuantizeBoundaries) {
  Ran ran;
  for (const int word : {1, 2, 8, 30, 31, 32, 33, 47, 61, 62, 63, 64}) {
    for (const bool is_signed : {false, true}) {
      if (word == 64 && !is_signed) continue;
      for (const int integer : {word, word / 2, word + 32}) {
        for_all_modes(word, integer, is_signed, [&](const Format& f) {
          const Register r = model::make_register(f, observed_register);
          std::vector<Case> cases;
          for (const int shift : {-90, -62, -31, -30, -5, -1, 0,  1,  2,   7,   29,  30,  31,  32,  33, 34,
                                  60,  61,  62,  63,  64, 65, 94, 96, 124, 125, 126, 127, 128, 158, 254}) {
            const std::vector<int128> values = boundaries(r, shift);
            check_uniform(kernels(), f, f.fraction() + shift, values, ran);
            for (std::size_t i = 0; i < values.size(); i += 3)
              cases.push_back({values[i], f.fraction() + shift});
          }
          std::mt19937_64 random(static_cast<std::uint64_t>(word));
          std::ranges::shuffle(cases, random);
          check_each(kernels(), f, cases, ran);
          if (HasFatalFailure()) GTEST_FAIL();
        });
        if (HasFatalFailure()) return;
      }
    }
  }
  for (const std::size_t n : {ran.narrow32, ran.narrow64, ran.wide, ran.each64, ran.each128}) {
    EXPECT_GT(n, 100000U);
  }
}

TEST_P(LanesTest, QuantizeRandom) {
  std::mt19937_64 random(11);
  Ran ran;
  for (int i = 0; i < 4000; ++i) {
    const Format f = random_format(random);
    const int bits = random_int(random, 0, 1) == 0 ? 62 : 126;
    std::vector<int128> values;
    std::vector<Case> cases;
    for (int k = 0; k < 40; ++k) {
      values.push_back(random_value(random, bits));
      cases.push_back({values.back(), f.fraction() + random_int(random, -60, bits + 20)});
    }
    check_uniform(kernels(), f, f.fraction() + random_int(random, -60, bits + 40), values, ran);
    check_each(kernels(), f, cases, ran);
    if (HasFatalFailure()) return;
  }
  for (const std::size_t n : {ran.narrow32, ran.narrow64, ran.wide, ran.each64, ran.each128}) {
    EXPECT_GT(n, 10000U);
  }
}

// ---------------------------------------------------------------- 128 bits

std::vector<std::int64_t> corners64() {
  std::vector<std::int64_t> out{0, INT64_MAX, INT64_MIN};
  for (const int bits : {0, 1, 15, 31, 32, 33, 47, 62}) {
    for (const std::int64_t off : {-1, 0, 1}) {
      const std::int64_t x = (std::int64_t{1} << bits) + off;
      out.insert(out.end(), {x, -x});
    }
  }
  for (const std::uint64_t x : {0xffffffff00000000ULL, 0x80000000ffffffffULL, 0x7fffffff80000000ULL,
                                0x8000000080000000ULL, 0x00000000ffffffffULL, 0xaaaaaaaa55555555ULL}) {
    out.push_back(static_cast<std::int64_t>(x));
  }
  return out;
}

TEST_P(LanesTest, ProductIsWhole) {
  std::mt19937_64 random(12);
  std::vector<std::int64_t> values = corners64();
  for (int i = 0; i < 300; ++i) values.push_back(static_cast<std::int64_t>(random()));
  std::vector<std::int64_t> a, b;
  for (const std::int64_t x : values) {
    for (const std::int64_t y : values) {
      a.push_back(x);
      b.push_back(y);
    }
  }
  std::vector<int128> out(a.size());
  kernels().product(a.data(), b.data(), a.size(), out.data());
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_TRUE(out[i] == int128{a[i]} * b[i]) << a[i] << " * " << b[i];
}

std::vector<int128> corners128() {
  std::vector<int128> out;
  for (const std::int64_t high : {0L, 1L, -1L, INT64_MAX / 2, INT64_MIN / 2, 0x123456789abcdefL}) {
    for (const std::uint64_t low : {0UL, 1UL, ~0UL, ~0UL - 1, 1UL << 63, (1UL << 63) - 1, (1UL << 63) + 1}) {
      out.push_back(static_cast<int128>(static_cast<model::uint128>(high) << 64 | low));
    }
  }
  return out;
}

TEST_P(LanesTest, WideSumsAndShifts) {
  std::mt19937_64 random(13);
  std::vector<int128> values = corners128();
  for (int i = 0; i < 60; ++i) values.push_back(random_value(random, 125));
  std::vector<int128> a, b;
  for (const int128 x : values) {
    for (const int128 y : values) {
      a.push_back(x);
      b.push_back(y);
    }
  }
  std::vector<int128> sum(a.size()), difference(a.size());
  kernels().add(a.data(), b.data(), a.size(), sum.data());
  kernels().subtract(a.data(), b.data(), a.size(), difference.data());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_TRUE(sum[i] == a[i] + b[i]) << text(a[i]) << ", " << text(b[i]);
    ASSERT_TRUE(difference[i] == a[i] - b[i]) << text(a[i]) << ", " << text(b[i]);
  }
  std::vector<std::int64_t> by;
  a.clear();
  for (int shift = 0; shift < 128; ++shift) {
    std::vector<int128> left(values.size()), right(values.size());
    kernels().shift_left(values.data(), values.size(), shift, left.data());
    kernels().shift_right(values.data(), values.size(), shift, right.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      ASSERT_TRUE(left[i] == values[i] << shift) << text(values[i]) << " << " << shift;
      ASSERT_TRUE(right[i] == values[i] >> shift) << text(values[i]) << " >> " << shift;
    }
  }
  for (const int128 x : values) {
    for (int shift = 0; shift < 128; ++shift) {
      a.push_back(x);
      by.push_back(shift);
    }
  }
  std::vector<int128> left(a.size()), right(a.size());
  kernels().shift_left_each(a.data(), by.data(), a.size(), left.data());
  kernels().shift_right_each(a.data(), by.data(), a.size(), right.data());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_TRUE(left[i] == a[i] << by[i]) << text(a[i]) << " << " << by[i];
    ASSERT_TRUE(right[i] == a[i] >> by[i]) << text(a[i]) << " >> " << by[i];
  }
}

TEST_P(LanesTest, TopBit) {
  std::mt19937_64 random(14);
  std::vector<std::int64_t> values{1, INT64_MAX, INT64_MAX - 1};
  for (int bits = 1; bits <= 62; ++bits) {
    const std::int64_t x = std::int64_t{1} << bits;
    values.insert(values.end(), {x - 1, x, x + 1, x | (x - 1), x + (x >> 1)});
    for (int i = 0; i < 50; ++i) values.push_back(x | static_cast<std::int64_t>(random() >> (64 - bits)));
  }
  std::vector<std::int64_t> out(values.size());
  kernels().top_bit(values.data(), values.size(), out.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(out[i], 63 - std::countl_zero(static_cast<std::uint64_t>(values[i]))) << values[i];
  }
}

// ---------------------------------------------------------------- Q of a quotient

void check_ratio(const LaneKernels& kernels, const Format& format, int scale, const std::vector<int128>& n,
                 const std::vector<std::int64_t>& d) {
  const Register r = model::make_register(format, observed_register);
  const auto check = [&](const auto& numerators, const std::vector<std::int64_t>& divisors, auto kernel) {
    compare(
        numerators.size(), format, kernel,
        [&](std::size_t i, auto watch) {
          return model::quantize_ratio(int128{numerators[i]}, divisors[i], scale, r, watch);
        },
        [&](std::size_t i) {
          return text(r) + ", " + text(int128{numerators[i]}) + " / " + std::to_string(divisors[i]) + " 2^" +
                 std::to_string(scale);
        });
  };
  check(n, d, [&](model::Watching w, std::int64_t* out) {
    kernels.ratio128(n.data(), d.data(), n.size(), scale, r, w, out);
  });
  std::vector<std::int64_t> n64, d64;
  for (std::size_t i = 0; i < n.size(); ++i) {
    if (n[i] < INT64_MIN || n[i] > INT64_MAX) continue;
    n64.push_back(static_cast<std::int64_t>(n[i]));
    d64.push_back(d[i]);
  }
  check(n64, d64, [&](model::Watching w, std::int64_t* out) {
    kernels.ratio64(n64.data(), d64.data(), n64.size(), scale, r, w, out);
  });
}

// Quotients on a kept place, on a tie, and one unit of the numerator to either side, up to where lanes divide
// themselves and beyond: |quotient| around 2^49, divisors around 2^61.
TEST_P(LanesTest, RatioBoundaries) {
  std::mt19937_64 random(15);
  std::vector<std::int64_t> divisors{1, 2, 3, 5, 6, 7, 8, 255};
  for (const int bits : {20, 31, 32, 33, 52, 53, 54, 60, 61, 62}) {
    const std::int64_t x = std::int64_t{1} << bits;
    divisors.insert(divisors.end(), {x - 3, x - 1, x, x + 1, x + 3});
    divisors.push_back(x + static_cast<std::int64_t>(random() >> (64 - bits)));
  }
  divisors.push_back(INT64_MAX);
  std::vector<int128> floors{0, 1, 2, 3, 126, 127, 128, 129};
  for (const int bits : {24, 48, 49, 50, 53, 63}) {
    for (const int off : {-2, -1, 0, 1}) floors.push_back(power(bits) + off);
  }
  std::size_t divided = 0, refused = 0;
  for (const int shift : {0, 1, 13, 40, -1, -7, -20}) {
    std::vector<int128> n;
    std::vector<std::int64_t> d;
    std::vector<int128> inside_n;
    std::vector<std::int64_t> inside_d;
    for (const std::int64_t divisor : divisors) {
      for (const int128 magnitude : floors) {
        for (const int128 floor : {magnitude, -magnitude}) {
          // Halves of the kept place: 2 n 2^shift = halves d where that is whole, else the nearest n.
          for (const int128 halves : {2 * floor, 2 * floor + 1}) {
            const int half = shift + 1;
            const int down = half < 0 ? -half : 0;
            if (std::log2(std::abs(static_cast<double>(halves)) + 1) +
                    std::log2(static_cast<double>(divisor)) + down >=
                124) {
              continue;
            }
            const int128 product = (halves * divisor) << down;
            const int128 nearest = half > 0 ? product >> half : product;
            for (const int off : {-1, 0, 1}) {
              n.push_back(nearest + off);
              d.push_back(divisor);
              if (magnitude < power(49) - 2 &&
                  static_cast<double>(divisor) * std::exp2(std::max(-shift, 0)) < 0x1p61) {
                inside_n.push_back(n.back());
                inside_d.push_back(divisor);
              }
            }
          }
        }
      }
    }
    EXPECT_EQ(kernels().ratio128_refused(inside_n.data(), inside_d.data(), inside_n.size(), shift), 0U);
    divided += inside_n.size();
    refused += kernels().ratio128_refused(n.data(), d.data(), n.size(), shift);
    for (const int word : {12, 64}) {
      const int integer = word - 10;
      for_all_modes(word, integer, true, [&](const Format& f) {
        check_ratio(kernels(), f, shift - 10, n, d);
        if (HasFatalFailure()) GTEST_FAIL();
      });
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(divided, 10000U);
  EXPECT_GT(refused, 1000U);
}

TEST_P(LanesTest, RatioRandom) {
  std::mt19937_64 random(16);
  for (int i = 0; i < 1500; ++i) {
    const Format f = random_format(random);
    const int n_bits = random_int(random, 1, 120);
    const int d_bits = random_int(random, 1, 63);
    std::vector<int128> n;
    std::vector<std::int64_t> d;
    for (int k = 0; k < 40; ++k) {
      n.push_back(random_value(random, n_bits));
      d.push_back(std::max<std::int64_t>(
          1, static_cast<std::int64_t>(random() >> (64 - random_int(random, 1, d_bits)))));
    }
    check_ratio(kernels(), f, random_int(random, -130, 130), n, d);
    if (HasFatalFailure()) return;
  }
}

// The argument at quotient(), on a floating point of 9 bits with words of 11 in place of 53 with 64: below
// 2^(9 - 4) the floor is off by one at most, for every divisor of 16 bits and every numerator next to a
// multiple.
TEST(Quotient, FloorIsOffByOneAtMost) {
  constexpr int precision = 9, word = 11;
  const auto rounded = [](double x) {  // to nearest, ties to even
    if (x == 0) return x;
    const int exponent = std::ilogb(x) + 1 - precision;
    return std::ldexp(std::nearbyint(std::ldexp(x, -exponent)), exponent);
  };
  constexpr int half = 1 << (word - 1), modulus = 1 << word;
  int worst = 0, largest = 0;
  for (int d = 1; d < 1 << 16; ++d) {
    const double near_d = rounded(d);
    for (int k = -32; k <= 32; ++k) {
      for (const int off : {-1, 0, 1}) {
        const int n = k * d + off;
        const int low = ((n + half) & (modulus - 1)) - half;  // signed, the carry given to the high half
        const double high = rounded((n - low) / modulus);
        const double near = rounded(high * modulus + rounded(low));
        const double near_q = std::floor(rounded(near / near_d));
        if (std::abs(near_q) >= 1 << (precision - 4)) continue;
        const int floor = n >= 0 ? n / d : -((-n + d - 1) / d);
        worst = std::max(worst, std::abs(static_cast<int>(near_q) - floor));
        largest = std::max(largest, std::abs(n));
        ASSERT_LE(worst, 1) << n << " / " << d;
      }
    }
  }
  EXPECT_EQ(worst, 1);                          // the correction is needed
  EXPECT_GT(largest, 1 << (precision + word));  // and high halves that round were among them
}

// ---------------------------------------------------------------- reciprocal

// One unit over divisors that reach every segment of its table, and their boundaries, at many magnitudes.
void check_reciprocal(const LaneKernels& kernels, Reciprocal unit, int fraction) {
  std::mt19937_64 random(17);
  std::vector<std::int64_t> d{0, -1, -5, INT64_MIN, 1, 2, 3, INT64_MAX, INT64_MAX - 1};
  const int index_bits = unit.kind == ReciprocalKind::restoring ? 4 : unit.index_bits;
  for (const int top : {index_bits, 19, 31, 40, 52, 53, 60, 61, 62}) {
    if (top < index_bits) continue;
    const std::int64_t segment = std::int64_t{1} << (top - index_bits);
    const std::int64_t first = std::int64_t{1} << top;
    const std::int64_t step = std::max(1, (1 << index_bits) / 64);
    for (std::int64_t j = 0; j < 1 << index_bits; j += step) {
      for (const int off : {-1, 0, 1}) d.push_back(first + j * segment + off);
      d.push_back(first + j * segment +
                  static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(segment)));
    }
  }
  const model::ReciprocalUnit scalar(unit, observed_register);
  std::vector<std::int64_t> e(d.size());
  compare(
      d.size(), unit.output,
      [&](model::Watching w, std::int64_t* m) {
        kernels.reciprocal(scalar.formats(), scalar.table().data(), d.data(), d.size(), fraction, w, m,
                           e.data());
      },
      [&](std::size_t i, auto watch) {
        const model::Inverse inverse = scalar(d[i], fraction, watch);
        EXPECT_EQ(e[i], inverse.e) << d[i];
        return inverse.m;
      },
      [&](std::size_t i) {
        return std::string(to_string(unit.kind)) + (unit.normalize ? " normalised, " : " as it is, ") +
               text(model::make_register(unit.output)) + ", d " + std::to_string(d[i]) + " 2^-" +
               std::to_string(fraction);
      });
}

TEST_P(LanesTest, ReciprocalOfEveryKind) {
  int narrow = 0, wide = 0;
  for (std::size_t k = 0; k < enum_names<ReciprocalKind>.size(); ++k) {
    const auto kind = static_cast<ReciprocalKind>(k);
    for (const bool normalize : {true, false}) {
      // operand_bits, index_bits, table_bits, internal_bits: small, as shipped, and too wide for 64 bits
      for (const auto& [operand, index, table, internal] :
           {std::array{5, 1, 4, 3}, std::array{12, 5, 10, 12}, std::array{20, 7, 20, 24},
            std::array{27, 10, 24, 28}, std::array{40, 9, 30, 20}, std::array{60, 6, 40, 60},
            std::array{30, 4, 2, 40}}) {
        for (const int steps : {0, 1, 3}) {
          if (steps > 0 && kind != ReciprocalKind::lut_newton) continue;
          Reciprocal unit;
          unit.kind = kind;
          unit.normalize = normalize;
          if (kind != ReciprocalKind::restoring) {
            unit.operand_bits = operand;
            unit.index_bits = index;
            unit.table_bits = table;
            unit.internal_bits = internal;
            unit.steps = steps;
          }
          (model::reciprocal_formats(unit, observed_register).fits_int64 ? narrow : wide) += 1;
          for (const auto& [word, integer] : {std::array{18, 1}, std::array{9, 0}, std::array{63, 1},
                                              std::array{63, 0}, std::array{40, 20}, std::array{12, -20}}) {
            if (normalize && integer < 0) continue;
            for (const Rounding rounding : all_roundings) {
              for (const Overflow overflow : {Overflow::sat, Overflow::wrap}) {
                if (normalize && integer == 0 && overflow == Overflow::wrap) continue;
                unit.output = {word, integer, false, rounding, overflow, false};
                check_reciprocal(kernels(), unit, (word * 7 + steps) % 50 - 5);
                if (HasFailure()) return;
              }
            }
          }
        }
      }
    }
  }
  EXPECT_GT(narrow, 5);
  EXPECT_GT(wide, 5);
}

TEST_P(LanesTest, ReciprocalsAsShipped) {
  for (const std::string& name : shipped_names) {
    const Config config = shipped_config(name);
    for (const Reciprocal& unit : {config.edge_reciprocal, config.row_reciprocal, config.pixel_reciprocal}) {
      for (const int fraction : {0, 4, 8, 22, 41}) check_reciprocal(kernels(), unit, fraction);
      if (HasFailure()) return;
    }
  }
}

}  // namespace
}  // namespace bitspan
