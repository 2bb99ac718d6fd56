// SPDX-License-Identifier: Apache-2.0
// The registers of a span as ramps, start and increment, or as one value per pixel where an adder rounds.
#include <algorithm>
#include <array>

#include "model/numeric/ramp-inl.hpp"
#include "model/simd/fixed.hpp"
#include "model/simd/spans.hpp"
#include "model/stages/span-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_RAMPS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_RAMPS_INL
#undef BITSPAN_MODEL_SIMD_SPANS_RAMPS_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_RAMPS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

constexpr std::size_t registers = 7;
constexpr std::array<std::int64_t SpanRecord::*, registers> starts{
    &SpanRecord::h, &SpanRecord::fu, &SpanRecord::fv, &SpanRecord::r,
    &SpanRecord::g, &SpanRecord::b,  &SpanRecord::a};
constexpr std::array<std::int64_t SpanRecord::*, registers> steps{
    &SpanRecord::h_step,  &SpanRecord::fu_step0, &SpanRecord::fv_step0, &SpanRecord::r_step0,
    &SpanRecord::g_step0, &SpanRecord::b_step0,  &SpanRecord::a_step0};

const Adder& adder_of(const SpanFormats& f, std::size_t i) {
  return i == 0 ? f.h : i < 3 ? f.f : f.shade_acc;
}

constexpr int most_ramp_bits = 20;  // of a span's length

// Every span's increments, and whether all of its registers are ramps.
template <const SpanFormats* fixed>
void find_ramps(const SpanFormats& given, const Columns<SpanRecord>& spans, Ramps& out) {
  const FormatsOf<SpanFormats, fixed> formats(given);
  const SpanFormats& f = *formats;
  const std::size_t padded = spans.size + column_slack;
  if (out.linear.size() < padded) {
    out.linear.resize(padded);
    for (auto& column : out.increment) column.resize(padded);
  }
  for (std::size_t i = 0; i < spans.size; i += Lanes::count) {
    const Lanes last = Lanes::load(spans[&SpanRecord::count] + i) - Lanes(1);
    Lanes::Mask linear = last < Lanes(std::int64_t{1} << most_ramp_bits);
    for (std::size_t k = 0; k < registers; ++k) {
      const RampLanes ramp = make_ramp(adder_of(f, k), Lanes::load(spans[starts[k]] + i),
                                       Lanes::load(spans[steps[k]] + i), last, most_ramp_bits);
      linear = linear & ramp.linear;
      ramp.increment.store(out.increment[k].data() + i);
    }
    one_where(linear).store(out.linear.data() + i);
  }
}

// A register along its span: a ramp, or one value per pixel.
struct Sequence {
  std::int64_t start = 0, increment = 0;
  const std::int64_t* values = nullptr;
};
HWY_INLINE Lanes at(const Sequence& s, Lanes index) {
  if (s.values != nullptr) [[unlikely]] {
    return lookup(s.values, index);
  }
  return Lanes(s.start) + index * Lanes(s.increment);
}
using Sequences = std::array<Sequence, registers>;
HWY_INLINE bool is_ramp(const Sequence& s) { return s.values == nullptr; }

// One by one, as the scalar stage does it; the values lie in `values`, past the end too, where vectors look.
template <class Watch>
Sequence walked(const Adder& adder, bool fits_int64, std::int64_t start, std::int64_t step, std::size_t count,
                std::vector<std::int64_t>& values, Watch watch) {
  if (values.size() < count + column_slack) values.resize(count + column_slack);
  std::int64_t value = start;
  for (std::size_t n = 0; n + 1 < count; ++n) {
    values[n] = value;
    value = fits_int64 ? accumulated<std::int64_t>(value, step, adder, watch)
                       : accumulated<int128>(value, step, adder, watch);
  }
  std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(count) - 1, column_slack + 1, value);
  return {0, 0, values.data()};
}
template <class T, class Watch>
HWY_NOINLINE void walk_registers(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                                 SpanWork<T>& work, Sequences& out, Watch watch) {
  const auto count = static_cast<std::size_t>(spans[&SpanRecord::count][i]);
  for (std::size_t k = 0; k < registers; ++k) {
    out[k] = walked(adder_of(stage.formats, k), stage.fits_int64, spans[starts[k]][i], spans[steps[k]][i],
                    count, work.values[k], watch);
  }
}

template <class T>
HWY_INLINE void registers_of(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                             SpanWork<T>& work, Sequences& out) {
  if (work.ramps.linear[i] == 0) [[unlikely]] {
    walk_registers(stage, spans, i, work, out, NoObserve{});
    return;
  }
  for (std::size_t k = 0; k < registers; ++k)
    out[k] = {spans[starts[k]][i], work.ramps.increment[k][i], nullptr};
}

// The channels of span i, of so many fragments; their forms fit int64.
HWY_INLINE void channels_of(const ChannelStage& stage, const ChannelColumns& spans, std::size_t i,
                            std::size_t count, PerChannel<std::vector<std::int64_t>>& values,
                            PerChannel<Sequence>& out) {
  for (std::size_t c = 0; c < stage.in_use.size(); ++c) {
    const Adder& adder = stage.in_use[c].along_row;
    const std::int64_t start = spans[c][&SpanChannelRecord::w][i];
    const std::int64_t step = spans[c][&SpanChannelRecord::w_step0][i];
    const auto last = static_cast<std::int64_t>(count) - 1;
    const RampLanes ramp = make_ramp(adder, Lanes(start), Lanes(step), Lanes(last), most_ramp_bits);
    out[c] = last < std::int64_t{1} << most_ramp_bits && all(ramp.linear)
                 ? Sequence{start, lane(ramp.increment, 0), nullptr}
                 : walked(adder, true, start, step, count, values[c], NoObserve{});
  }
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
