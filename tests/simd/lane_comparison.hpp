// SPDX-License-Identifier: Apache-2.0
// Runs kernels of lanes, unobserved and observed, against the scalar routines.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "model/numeric/observe.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/register.hpp"
#include "tests/simd/lane_kernels.hpp"

namespace bitspan {

using model::int128;
using model::LaneKernels;
using model::NoObserve;
using model::Observe;
using model::Register;
using model::RegisterId;
using model::Statistics;

inline constexpr FormatId observed_format = FormatId::span_h;
inline constexpr RegisterId observed_register = model::id_of(observed_format);

inline int128 power(int exponent) { return int128{1} << exponent; }

// A third of the elements are masked: what they hold must not be noted.
inline std::vector<std::uint8_t> activity(std::size_t n) {
  std::vector<std::uint8_t> active(n);
  for (std::size_t i = 0; i < n; ++i) active[i] = (i * 7 + i / 11) % 3 != 0 ? 1 : 0;
  return active;
}

inline std::string text(const model::FieldStatistics& s) {
  return "count " + std::to_string(s.count) + ", wraps " + std::to_string(s.wraps) + ", saturations " +
         std::to_string(s.saturations) + ", min " + std::to_string(s.min) + ", max " + std::to_string(s.max) +
         ", bias " + std::to_string(s.bias);
}

inline std::string text(const Register& r) {
  return std::string(to_string(r.mode)) + " " + std::string(to_string(r.overflow)) + " word " +
         std::to_string(r.word) + " fraction " + std::to_string(r.fraction) +
         (r.is_signed ? " signed" : " unsigned");
}

inline std::string text(int128 x) {
  const auto magnitude = static_cast<model::uint128>(x < 0 ? -x : x);
  return std::string(x < 0 ? "-" : "") + std::to_string(static_cast<std::uint64_t>(magnitude >> 64)) +
         " 2^64 + " + std::to_string(static_cast<std::uint64_t>(magnitude));
}

// Runs a kernel unobserved and observed, and the scalar routine the same, on n elements.
// kernel(watching, out), scalar(i, watch), describe(i).
template <class Kernel, class Scalar, class Describe>
void compare(std::size_t n, const Format& format, Kernel kernel, Scalar scalar, Describe describe) {
  std::vector<std::int64_t> out(n), watched(n);
  kernel(model::Watching{}, out.data());
  Config config;
  config.format(observed_format) = format;
  const std::vector<std::uint8_t> active = activity(n);
  Statistics seen, expected;
  kernel(model::Watching{&seen, &config, active.data()}, watched.data());
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t value = active[i] != 0 ? scalar(i, Observe{&expected}) : scalar(i, NoObserve{});
    ASSERT_EQ(out[i], value) << describe(i);
    ASSERT_EQ(watched[i], value) << "observed: " << describe(i);
  }
  ASSERT_EQ(seen.of(observed_register), expected.of(observed_register))
      << text(seen.of(observed_register)) << " for " << text(expected.of(observed_register)) << ", "
      << describe(0);
  for (std::size_t i = 0; i < seen.fields.size(); ++i) {
    ASSERT_TRUE(i == static_cast<std::size_t>(observed_register) || seen.fields[i].count == 0);
  }
}

// Whether raw 2^-fraction may be given to lanes that hold sums of up to 2^bits.
inline bool fits(int128 raw, int fraction, const Register& r, int bits) {
  const int up = std::max(r.fraction - fraction, 0);
  return up <= bits && raw <= power(bits - up) && raw >= -power(bits - up);
}

struct Case {
  int128 raw;
  int fraction;
};

// How many values each kind of kernel has been given.
struct Ran {
  std::size_t narrow32 = 0, narrow64 = 0, wide = 0, each64 = 0, each128 = 0;
};

inline std::vector<std::int64_t> narrowed(const std::vector<int128>& raw) {
  std::vector<std::int64_t> out;
  for (const int128 x : raw) out.push_back(static_cast<std::int64_t>(x));
  return out;
}

// Every kernel with one fraction that may take the values.
inline void check_uniform(const LaneKernels& kernels, const Format& format, int fraction,
                          const std::vector<int128>& values, Ran& ran) {
  const Register r = model::make_register(format, observed_register);
  const auto chosen = [&](int bits) {
    std::vector<int128> some;
    for (const int128 raw : values) {
      if (fits(raw, fraction, r, bits)) some.push_back(raw);
    }
    return some;
  };
  const std::vector<int128> of128 = chosen(126);
  const std::vector<int128> of64 = chosen(62);
  const auto describe = [&](const std::vector<int128>& raw) {
    return [&](std::size_t i) { return text(r) + ", " + text(raw[i]) + " 2^-" + std::to_string(fraction); };
  };
  compare(
      of128.size(), format,
      [&](model::Watching w, std::int64_t* out) {
        kernels.quantize128(of128.data(), of128.size(), fraction, r, w, out);
      },
      [&](std::size_t i, auto watch) { return model::quantize(of128[i], fraction, r, watch); },
      describe(of128));
  const std::vector<std::int64_t> raw64 = narrowed(of64);
  compare(
      of64.size(), format,
      [&](model::Watching w, std::int64_t* out) {
        kernels.quantize64(raw64.data(), raw64.size(), fraction, r, w, out);
      },
      [&](std::size_t i, auto watch) { return model::quantize(of64[i], fraction, r, watch); },
      describe(of64));
  ran.wide += of128.size();
  ran.narrow64 += of64.size();
  if (format.word > (format.is_signed ? 32 : 31)) return;
  const std::vector<int128> of32 = chosen(30);
  std::vector<std::int32_t> raw32, out32(of32.size());
  for (const int128 raw : of32) raw32.push_back(static_cast<std::int32_t>(raw));
  kernels.quantize32(raw32.data(), raw32.size(), fraction, r, out32.data());
  for (std::size_t i = 0; i < raw32.size(); ++i) {
    ASSERT_EQ(out32[i], model::quantize(of32[i], fraction, r, NoObserve{})) << describe(of32)(i);
  }
  ran.narrow32 += of32.size();
}

// The kernels with a fraction per lane; these round on one place below the register's grid at least.
inline void check_each(const LaneKernels& kernels, const Format& format, const std::vector<Case>& cases,
                       Ran& ran) {
  const Register r = model::make_register(format, observed_register);
  const auto chosen = [&](int bits, std::vector<int128>& raw, std::vector<std::int64_t>& fraction) {
    Register finer = r;
    ++finer.fraction;
    for (const Case& c : cases) {
      if (!fits(c.raw, c.fraction, finer, bits)) continue;
      raw.push_back(c.raw);
      fraction.push_back(c.fraction);
    }
  };
  std::vector<int128> of128, of64;
  std::vector<std::int64_t> fraction128, fraction64;
  chosen(126, of128, fraction128);
  chosen(62, of64, fraction64);
  const auto check = [&](const std::vector<int128>& raw, const std::vector<std::int64_t>& fraction,
                         auto kernel) {
    compare(
        raw.size(), format, kernel,
        [&](std::size_t i, auto watch) {
          return model::quantize(raw[i], static_cast<int>(fraction[i]), r, watch);
        },
        [&](std::size_t i) { return text(r) + ", " + text(raw[i]) + " 2^-" + std::to_string(fraction[i]); });
  };
  const std::vector<std::int64_t> raw64 = narrowed(of64);
  check(of128, fraction128, [&](model::Watching w, std::int64_t* out) {
    kernels.quantize128_each(of128.data(), fraction128.data(), of128.size(), r, w, out);
  });
  check(of64, fraction64, [&](model::Watching w, std::int64_t* out) {
    kernels.quantize64_each(raw64.data(), fraction64.data(), raw64.size(), r, w, out);
  });
  ran.each128 += of128.size();
  ran.each64 += of64.size();
}

}  // namespace bitspan
