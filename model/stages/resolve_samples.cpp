// SPDX-License-Identifier: Apache-2.0
#include "model/stages/resolve_samples.hpp"

#include "model/numeric/ratio.hpp"

namespace bitspan::model {

std::vector<std::uint8_t> resolve_samples(std::span<const std::uint8_t> samples, int width, int height, int k,
                                          const Format& format) {
  const Register r = make_register(format);
  const auto columns = static_cast<std::size_t>(width);
  const auto side = static_cast<std::size_t>(k);
  std::vector<std::uint8_t> out(4 * columns * static_cast<std::size_t>(height));
  // As hardware does it: one row of accumulators, to which each row of samples is added.
  std::vector<std::uint32_t> sums(4 * columns);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    sums.assign(sums.size(), 0);
    for (std::size_t row = side * y; row < side * (y + 1); ++row) {
      const std::uint8_t* sample = samples.data() + 4 * row * columns * side;
      for (std::size_t i = 0; i < columns * side; ++i) {
        for (std::size_t c = 0; c < 4; ++c) sums[4 * (i / side) + c] += *sample++;
      }
    }
    for (std::size_t at = 0; at < sums.size(); ++at) {
      out[4 * columns * y + at] =
          static_cast<std::uint8_t>(quantize_ratio(sums[at], int128{k} * k, 0, r, NoObserve{}));
    }
  }
  return out;
}

}  // namespace bitspan::model
