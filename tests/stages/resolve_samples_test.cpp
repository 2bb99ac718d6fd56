// SPDX-License-Identifier: Apache-2.0
#include "model/stages/resolve_samples.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <tuple>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "golden/resolve_samples.hpp"

namespace bitspan {
namespace {

using Bytes = std::vector<std::uint8_t>;

Format codes(Rounding rounding) { return {8, 8, false, rounding, Overflow::sat, false}; }

// One pixel, of four samples that are equal in every channel.
int mean_of_four(std::array<int, 4> samples, Rounding rounding) {
  Bytes rgba;
  for (const int code : samples) rgba.insert(rgba.end(), 4, static_cast<std::uint8_t>(code));
  const Bytes of_model = model::resolve_samples(rgba, 1, 1, 2, codes(rounding));
  EXPECT_EQ(of_model, golden::resolve_samples(rgba, 1, 1, 2, codes(rounding)));
  EXPECT_EQ(of_model, Bytes(4, of_model[0]));
  return of_model[0];
}

TEST(ResolveSamples, ByHand) {
  using enum Rounding;
  EXPECT_EQ(mean_of_four({10, 20, 30, 40}, trn), 25);
  EXPECT_EQ(mean_of_four({1, 0, 0, 0}, rnd), 0);  // 1/4
  EXPECT_EQ(mean_of_four({1, 1, 0, 0}, rnd), 1);  // 1/2
  EXPECT_EQ(mean_of_four({1, 1, 0, 0}, trn), 0);
  EXPECT_EQ(mean_of_four({1, 1, 0, 0}, rnd_conv), 0);
  EXPECT_EQ(mean_of_four({2, 2, 1, 1}, rnd_conv), 2);  // 3/2
  EXPECT_EQ(mean_of_four({1, 1, 0, 0}, rnd_zero), 0);
  EXPECT_EQ(mean_of_four({1, 1, 1, 0}, rnd_zero), 1);  // 3/4
  EXPECT_EQ(mean_of_four({255, 255, 255, 255}, rnd), 255);
  EXPECT_EQ(mean_of_four({255, 255, 255, 254}, rnd), 255);
  EXPECT_EQ(mean_of_four({255, 255, 255, 254}, trn), 254);
}

// Two by one pixels of two by two samples: each pixel takes its own.
TEST(ResolveSamples, APixelTakesItsOwnSamples) {
  const auto sample = [](int r, int a) {
    return Bytes{static_cast<std::uint8_t>(r), 7, 0, static_cast<std::uint8_t>(a)};
  };
  Bytes rgba;
  for (const auto& [r, a] :
       {std::pair{0, 255}, {4, 255}, {100, 0}, {104, 0}, {8, 255}, {12, 255}, {108, 0}, {112, 4}}) {
    const Bytes one = sample(r, a);
    rgba.insert(rgba.end(), one.begin(), one.end());
  }
  const Bytes expected{6, 7, 0, 255, 106, 7, 0, 1};
  EXPECT_EQ(model::resolve_samples(rgba, 2, 1, 2, codes(Rounding::rnd)), expected);
  EXPECT_EQ(golden::resolve_samples(rgba, 2, 1, 2, codes(Rounding::rnd)), expected);
}

TEST(ResolveSamples, OneSampleIsThePixel) {
  Bytes rgba;
  for (int i = 0; i < 256; ++i) rgba.push_back(static_cast<std::uint8_t>(i * 37));
  EXPECT_EQ(model::resolve_samples(rgba, 8, 8, 1, codes(Rounding::trn)), rgba);
  EXPECT_EQ(golden::resolve_samples(rgba, 8, 8, 1, codes(Rounding::trn)), rgba);
}

// The rule of each mode, on the exact remainder.
int rounded(int sum, int n, Rounding mode) {
  const int floor = sum / n;
  const int twice = 2 * (sum % n);
  switch (mode) {
    case Rounding::trn:
    case Rounding::trn_zero:
      return floor;
    case Rounding::rnd:
    case Rounding::rnd_inf:
      return floor + (twice >= n ? 1 : 0);
    case Rounding::rnd_zero:
    case Rounding::rnd_min_inf:
      return floor + (twice > n ? 1 : 0);
    case Rounding::rnd_conv:
      return floor + (twice > n || (twice == n && floor % 2 == 1) ? 1 : 0);
  }
  unreachable();
}

// Every sum of the samples of a pixel, in every mode.
TEST(ResolveSamples, EverySum) {
  std::uint64_t ties = 0;
  for (const int k : {2, 3, 4, 5, 8, 16}) {
    const int n = k * k;
    // Pixel x has the sum x.
    const int width = 255 * n + 1;
    Bytes rgba(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(n));
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < n; ++s) {
        const int code = x / n + (s < x % n ? 1 : 0);
        const auto at = static_cast<std::size_t>((s / k * width + x) * k + s % k);
        for (std::size_t c = 0; c < 4; ++c) rgba[4 * at + c] = static_cast<std::uint8_t>(code);
      }
    }
    for (int mode = 0; mode < rounding_modes; ++mode) {
      const auto rounding = static_cast<Rounding>(mode);
      const Bytes of_model = model::resolve_samples(rgba, width, 1, k, codes(rounding));
      ASSERT_EQ(of_model, golden::resolve_samples(rgba, width, 1, k, codes(rounding)))
          << k << " " << to_string(rounding);
      for (int x = 0; x < width; ++x) {
        ASSERT_EQ(of_model[4 * static_cast<std::size_t>(x)], rounded(x, n, rounding))
            << k << " " << to_string(rounding) << " " << x;
        ties += 2 * (x % n) == n ? 1 : 0;
      }
    }
  }
  EXPECT_GT(ties, 1000U);
}

TEST(ResolveSamples, RandomPictures) {
  const std::uint64_t seed = 20;
  std::mt19937_64 random(seed);
  for (int n = 0; n < 60; ++n) {
    const int k = static_cast<int>(1 + random() % 8);
    const int width = static_cast<int>(1 + random() % 20);
    const int height = static_cast<int>(1 + random() % 20);
    Bytes rgba(4 * static_cast<std::size_t>(width * k) * static_cast<std::size_t>(height * k));
    for (std::uint8_t& code : rgba) code = static_cast<std::uint8_t>(random());
    const Format format = codes(static_cast<Rounding>(random() % rounding_modes));
    const Bytes of_model = model::resolve_samples(rgba, width, height, k, format);
    ASSERT_EQ(of_model.size(), 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    ASSERT_EQ(of_model, golden::resolve_samples(rgba, width, height, k, format))
        << "seed " << seed << ", picture " << n;
  }
}

}  // namespace
}  // namespace bitspan
