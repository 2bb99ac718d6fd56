// SPDX-License-Identifier: Apache-2.0
#include "bench/likeness.hpp"

#include <algorithm>
#include <cmath>

namespace bitspan::bench {
namespace {

// Pixels that something was drawn on, as far as the picture shows.
std::vector<bool> drawn(const std::vector<std::uint8_t>& rgba, const Scene& scene) {
  std::vector<bool> out;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    out.push_back(!std::equal(scene.background.begin(), scene.background.end(),
                              rgba.begin() + static_cast<std::ptrdiff_t>(i)));
  }
  return out;
}

}  // namespace

Likeness compare(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b, const Scene& scene) {
  Likeness out;
  if (a.size() != b.size() || a.empty()) {
    return out;
  }
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = i % 4 == 3 ? 0 : static_cast<double>(a[i]) - static_cast<double>(b[i]);
    squares += d * d;
  }
  const double pixels = static_cast<double>(a.size()) / 4;
  out.psnr = 10 * std::log10(255 * 255 / std::max(squares / (3 * pixels), 1e-9));
  const std::vector<bool> in_a = drawn(a, scene);
  const std::vector<bool> in_b = drawn(b, scene);
  for (std::size_t i = 0; i < in_a.size(); ++i) {
    out.drawn += in_a[i] ? 1 : 0;
    out.outside += in_a[i] != in_b[i] ? 1 : 0;
  }
  out.drawn /= pixels;
  out.outside /= pixels;
  return out;
}

bool alike(const Likeness& likeness) {
  constexpr double least_psnr = 27, least_drawn = 0.05, most_outside = 0.01;
  return likeness.psnr >= least_psnr && likeness.drawn >= least_drawn && likeness.outside <= most_outside;
}

}  // namespace bitspan::bench
