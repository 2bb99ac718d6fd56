// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/root.hpp"

#include "model/numeric/root-inl.hpp"

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
  const auto out = HWY_NAMESPACE::reciprocal_root<int128>(root, d.raw, d.fraction, watch);
  return {out.m, static_cast<int>(out.e)};
}

template Root reciprocal_root(const ReciprocalRoot&, Exact, NoObserve);
template Root reciprocal_root(const ReciprocalRoot&, Exact, Observe);

}  // namespace bitspan::model
