// SPDX-License-Identifier: Apache-2.0
#include "golden/resolve_samples.hpp"

#include "golden/quantize.hpp"

namespace bitspan::golden {

std::vector<std::uint8_t> resolve_samples(std::span<const std::uint8_t> samples, int width, int height, int k,
                                          const Format& format) {
  const Quantizer<double> q(format);
  const double per_pixel = static_cast<double>(k) * k;
  const auto code = [&](int x, int y, int channel) -> double {
    const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width * k);
    return samples[4 * (row + static_cast<std::size_t>(x)) + static_cast<std::size_t>(channel)];
  };
  std::vector<std::uint8_t> out;
  out.reserve(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int channel = 0; channel < 4; ++channel) {
        double sum = 0;
        for (int j = k * y; j < k * (y + 1); ++j) {
          for (int i = k * x; i < k * (x + 1); ++i) sum += code(i, j, channel);
        }
        out.push_back(static_cast<std::uint8_t>(q.raw(q.quotient(sum, per_pixel))));
      }
    }
  }
  return out;
}

}  // namespace bitspan::golden
