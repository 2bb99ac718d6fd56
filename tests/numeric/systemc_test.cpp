// SPDX-License-Identifier: Apache-2.0
// The narrowing routine against SystemC's sc_fix and sc_ufix: what the modes' names promise.
#include <gtest/gtest.h>
#include <systemc.h>

#include <cstdint>
#include <random>

#include "model/numeric/quantize.hpp"
#include "tests/numeric/modes.hpp"

namespace bitspan {
namespace {

sc_q_mode mode_of(Rounding mode) {
  switch (mode) {
    case Rounding::rnd:
      return SC_RND;
    case Rounding::rnd_zero:
      return SC_RND_ZERO;
    case Rounding::rnd_min_inf:
      return SC_RND_MIN_INF;
    case Rounding::rnd_inf:
      return SC_RND_INF;
    case Rounding::rnd_conv:
      return SC_RND_CONV;
    case Rounding::trn:
      return SC_TRN;
    case Rounding::trn_zero:
      return SC_TRN_ZERO;
  }
  return SC_TRN;
}

sc_o_mode mode_of(Overflow mode) {
  switch (mode) {
    case Overflow::wrap:
      return SC_WRAP;
    case Overflow::sat:
      return SC_SAT;
    case Overflow::sat_zero:
      return SC_SAT_ZERO;
    case Overflow::sat_sym:
      return SC_SAT_SYM;
    case Overflow::wrap_sm:
      return SC_WRAP_SM;
  }
  return SC_WRAP;
}

// raw 2^-fraction as SystemC narrows it; the source holds 64 integer and 128 fraction bits.
std::int64_t by_systemc(std::int64_t raw, int fraction, const Format& f) {
  sc_fix source(192, 64);
  source = static_cast<sc_dt::int64>(raw);
  source >>= fraction;
  if (f.is_signed) {
    sc_fix target(f.word, f.integer, mode_of(f.rounding), mode_of(f.overflow));
    target = source;
    const auto bits = static_cast<std::uint64_t>(target.range(f.word - 1, 0).to_uint64());
    return static_cast<std::int64_t>(bits << (64 - f.word)) >> (64 - f.word);
  }
  sc_ufix target(f.word, f.integer, mode_of(f.rounding), mode_of(f.overflow));
  target = source;
  return static_cast<std::int64_t>(target.range(f.word - 1, 0).to_uint64());
}

std::string describe(const Format& f, std::int64_t raw, int fraction) {
  return std::string(f.is_signed ? "signed " : "unsigned ") + std::to_string(f.word) + ", int " +
         std::to_string(f.integer) + ", rounding " + std::to_string(static_cast<int>(f.rounding)) +
         ", overflow " + std::to_string(static_cast<int>(f.overflow)) + ": raw " + std::to_string(raw) +
         " with " + std::to_string(fraction) + " fraction bits";
}

// All 8-bit inputs with 4 fraction bits, all words of 1 to 6 bits, all places of the binary point that keep
// some of them, all modes.
TEST(SystemC, ExhaustiveAtSmallWidths) {
  constexpr int fraction = 4;
  int compared = 0;
  for (int word = 1; word <= 6; ++word) {
    for (int integer = -2; integer <= 7; ++integer) {
      for (const bool is_signed : {false, true}) {
        for_all_modes(word, integer, is_signed, [&](const Format& f) {
          for (int raw = -128; raw < 128; ++raw) {
            ASSERT_EQ(model::quantize(raw, fraction, f), by_systemc(raw, fraction, f))
                << describe(f, raw, fraction);
            ++compared;
          }
        });
      }
    }
  }
  // 7 x 5 signed and 7 x 4 unsigned modes.
  EXPECT_EQ(compared, 6 * 10 * (35 + 28) * 256);
}

TEST(SystemC, RandomUpTo64Bits) {
  std::mt19937_64 random(20240701);
  for (int i = 0; i < 200000; ++i) {
    const Format f = random_format(random);
    const auto raw = static_cast<std::int64_t>(random_value(random, 63));
    const int fraction = random_int(random, 0, 64);
    ASSERT_EQ(model::quantize(raw, fraction, f), by_systemc(raw, fraction, f)) << describe(f, raw, fraction);
  }
}

}  // namespace
}  // namespace bitspan

// The SystemC library has a main of its own, and wants this one.
int sc_main(int /*argc*/, char** /*argv*/) { return 0; }

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
