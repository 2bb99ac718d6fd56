// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/root.hpp"

namespace bitspan::model {
namespace {

// The largest t with (2 t - 1)^2 x <= 4^(bits + 1) 2^fraction: 2^bits / sqrt(x 2^-fraction), rounded.
std::int64_t entry(std::int64_t x, int fraction, int bits) {
  std::int64_t t = 0;
  for (int place = bits; place >= 0; --place) {
    const std::int64_t more = t | std::int64_t{1} << place;
    const int128 odd = 2 * more - 1;
    if (odd * odd * x <= int128{1} << (2 * bits + 2 + fraction)) t = more;
  }
  return t;
}

}  // namespace

ReciprocalRoot::ReciprocalRoot(const Config& config)
    : unit(config.light_root), output(make_register(config, FormatId::light_root)) {
  const std::int64_t entries = std::int64_t{1} << unit.index_bits;
  for (int octave = 0; octave < 2; ++octave) {
    for (std::int64_t j = 0; j < entries; ++j) {
      // The middle of the interval, in 2^-(index_bits + 1).
      table.push_back(entry((2 * (entries + j) + 1) << octave, unit.index_bits + 1, unit.table_bits));
    }
  }
}

template <class Watch>
Root reciprocal_root(const ReciprocalRoot& root, Exact d, Watch watch) {
  const RootUnit& unit = root.unit;
  const int top = bit_length(static_cast<uint128>(d.raw)) - 1 - d.fraction;  // 2^top <= d
  const int e = top >> 1;
  const auto cut = [](Exact x, int fraction) { return floor_of(scaled(x, -fraction)); };
  const auto n = static_cast<std::int64_t>(cut(scaled(d, 2 * e), unit.operand_bits));
  const int octave = static_cast<int>(n >> (unit.operand_bits + 1));
  const std::int64_t place = n >> (unit.operand_bits + octave - unit.index_bits);  // with its highest bit
  const std::int64_t entries = std::int64_t{1} << unit.index_bits;
  Exact y{root.table[static_cast<std::size_t>((octave - 1) * entries + place)], unit.table_bits};
  const Exact operand{n, unit.operand_bits};
  for (int step = 0; step < unit.steps; ++step) {
    const Exact a{cut(operand * y, unit.internal_bits), unit.internal_bits};
    const Exact c{cut(a * y, unit.internal_bits), unit.internal_bits};
    y = {cut(scaled(y * (Exact{3, 0} - c), 1), unit.internal_bits), unit.internal_bits};
  }
  return {quantize(y, root.output, watch), e};
}

template Root reciprocal_root(const ReciprocalRoot&, Exact, NoObserve);
template Root reciprocal_root(const ReciprocalRoot&, Exact, Observe);

}  // namespace bitspan::model
