// SPDX-License-Identifier: Apache-2.0
// Spans to every one of their fragments, for traces, statistics and the timed model.
#include <algorithm>

#include "model/simd/spans/blocks-inl.hpp"
#include "model/simd/spans/depth_test-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_EVERY_FRAGMENT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_EVERY_FRAGMENT_INL
#undef BITSPAN_MODEL_SIMD_SPANS_EVERY_FRAGMENT_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_EVERY_FRAGMENT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

// All fragments of span i into columns: h, u, v; the shades where `shades`; the other registers where `all`.
template <class Int, const SpanFormats* fixed, class Watch>
HWY_NOINLINE void fragments_in(const SpanStage& stage, const Sequences& s, const Columns<SpanRecord>& spans,
                               std::size_t i, bool shades, bool all, Columns<FragmentRecord>& out,
                               LaneStatistics* statistics) {
  const FormatsOf<SpanFormats, fixed> formats(stage.formats);
  const SpanFormats& f = *formats;
  const bool aligned = stage.aligned;
  const std::int64_t* table = stage.reciprocal.table().data();
  const Lanes b(static_cast<std::int64_t>(stage.q.b));
  const auto count = static_cast<std::size_t>(spans[&SpanRecord::count][i]);
  const Lanes u1(spans[&SpanRecord::u1][i]);
  const Lanes v1(spans[&SpanRecord::v1][i]);
  out.reserve(count);
  std::int64_t* const hs = out[&FragmentRecord::h];
  std::int64_t* const us = out[&FragmentRecord::u];
  std::int64_t* const vs = out[&FragmentRecord::v];
  const bool ramps = is_ramp(s[0]) && is_ramp(s[1]) && is_ramp(s[2]);
  const auto advance = [&](std::size_t r) HWY_ATTR {
    return Lanes(s[r].increment * static_cast<std::int64_t>(Lanes::count));
  };
  const Lanes h_advance = advance(0);
  const Lanes fu_advance = advance(1);
  const Lanes fv_advance = advance(2);
  Lanes h = at(s[0], Lanes::iota(0));
  Lanes fu = at(s[1], Lanes::iota(0));
  Lanes fv = at(s[2], Lanes::iota(0));
  for (std::size_t k = 0; k < count; k += Lanes::count) {
    const Lanes index = Lanes::iota(static_cast<std::int64_t>(k));
    const auto watch = [&]() HWY_ATTR {
      if constexpr (std::is_same_v<Watch, ObserveLanes>) {
        return ObserveLanes{statistics, first_lanes<std::int64_t>(std::min(count - k, Lanes::count)),
                            count - k >= Lanes::count};
      } else {
        return Watch{};
      }
    }();
    if (!ramps) [[unlikely]] {
      h = at(s[0], index);
      fu = at(s[1], index);
      fv = at(s[2], index);
    }
    const auto point = texture_point<Int>(f, b, table, h, fu, fv, u1, v1, aligned, watch);
    h.store(hs + k);
    point.u.store(us + k);
    point.v.store(vs + k);
    if (all) {
      fu.store(out[&FragmentRecord::fu] + k);
      fv.store(out[&FragmentRecord::fv] + k);
      point.recip_m.store(out[&FragmentRecord::recip_m] + k);
      point.recip_e.store(out[&FragmentRecord::recip_e] + k);
    }
    if (shades) {
      for (std::size_t c = 0; c < channel_count; ++c) {
        shade_of(stage, f, at(s[3 + c], index), watch).store(out[fragment_shades[c]] + k);
      }
    }
    h = h + h_advance;
    fu = fu + fu_advance;
    fv = fv + fv_advance;
  }
  out.size = count;
}

// fits_lanes of a whole span: its numerators are largest at an end.
HWY_INLINE bool span_fits_lanes(const SpanStage& stage, const Sequences& s, const Columns<SpanRecord>& spans,
                                std::size_t i) {
  if (stage.fits_int64 || s[1].values != nullptr || s[2].values != nullptr) return stage.fits_int64;
  const Lanes last(spans[&SpanRecord::count][i] - 1);
  const Lanes ends = magnitude(Lanes(s[1].start)) | magnitude(at(s[1], last)) | magnitude(Lanes(s[2].start)) |
                     magnitude(at(s[2], last));
  return fits_lanes(
      stage, ends, magnitude(Lanes(spans[&SpanRecord::u1][i])) | magnitude(Lanes(spans[&SpanRecord::v1][i])));
}

template <const SpanFormats* fixed, class Watch>
HWY_INLINE void fragments_of(const SpanStage& stage, const Sequences& s, const Columns<SpanRecord>& spans,
                             std::size_t i, bool shades, bool all, Columns<FragmentRecord>& out,
                             LaneStatistics* statistics) {
  if (span_fits_lanes(stage, s, spans, i)) {
    fragments_in<Lanes, fixed, Watch>(stage, s, spans, i, shades, all, out, statistics);
  } else {
    fragments_in<WideLanes, fixed, Watch>(stage, s, spans, i, shades, all, out, statistics);
  }
}

// Observers of the adders, and the registers.
template <class T>
void observed_registers(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                        SpanWork<T>& work, Sequences& s, Statistics& statistics) {
  if (work.ramps.linear[i] == 0) {
    walk_registers(stage, spans, i, work, s, Observe{&statistics});
    return;
  }
  registers_of(stage, spans, i, work, s);
  for (std::size_t k = 0; k < registers; ++k) {
    note_ramp(adder_of(stage.formats, k), s[k].start, spans[steps[k]][i], s[k].increment,
              spans[&SpanRecord::count][i] - 1, statistics);
  }
}

template <class T, const SpanFormats* fixed>
void evaluate_span(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i, bool shades,
                   SpanWork<T>& work, Columns<FragmentRecord>& out) {
  if (i == 0) find_ramps<fixed>(stage.formats, spans, work.ramps);
  Sequences s;
  registers_of(stage, spans, i, work, s);
  if (fixed != nullptr || branch_free_span(stage.formats)) {
    fragments_of<fixed, BranchFree>(stage, s, spans, i, shades, false, out, nullptr);
  } else {
    fragments_of<nullptr, NoObserve>(stage, s, spans, i, shades, false, out, nullptr);
  }
}

template <class T>
void evaluate_span_observed(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                            bool shades, SpanWork<T>& work, Columns<FragmentRecord>& out,
                            Statistics& statistics) {
  if (i == 0) find_ramps<nullptr>(stage.formats, spans, work.ramps);
  Sequences s;
  LaneStatistics seen;
  observed_registers(stage, spans, i, work, s, statistics);
  fragments_of<nullptr, ObserveLanes>(stage, s, spans, i, shades, false, out, &seen);
  seen.fold(statistics);
}

// Depth codes of all fragments.
template <class Watch>
HWY_NOINLINE void depth_codes_of(const DepthStage& stage, const Columns<FragmentRecord>& fragments,
                                 Columns<DepthRecord>& out, LaneStatistics* statistics) {
  out.reserve(fragments.size);
  for (std::size_t k = 0; k < fragments.size; k += Lanes::count) {
    const auto watch = [&]() HWY_ATTR {
      if constexpr (std::is_same_v<Watch, ObserveLanes>) {
        return ObserveLanes{statistics, first_lanes<std::int64_t>(std::min(fragments.size - k, Lanes::count)),
                            fragments.size - k >= Lanes::count};
      } else {
        return Watch{};
      }
    }();
    const auto point =
        depth_code_of(stage, stage.formats, Lanes::load(fragments[&FragmentRecord::h] + k), watch);
    point.z.store(out[&DepthRecord::z] + k);
    point.recip_m.store(out[&DepthRecord::recip_m] + k);
    point.recip_e.store(out[&DepthRecord::recip_e] + k);
  }
  out.size = fragments.size;
}

// statistics and seen: both or none.
template <class T>
void draw_every(const Pipeline& pipeline, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
                std::int64_t first_index, SpanWork<T>& work, Frame& frame, Counters& counters,
                BlockSink<T>& sink, Trace* trace, Statistics* statistics, LaneStatistics* seen) {
  find_ramps<nullptr>(pipeline.span.formats, spans, work.ramps);
  FragmentBlock<T>& block = work.block;
  block.size = 0;
  std::int32_t texture = -1;
  std::int64_t last_triangle = -1;
  const auto flush = [&] {
    if (block.size != 0) sink(block, {texture});
    block.size = 0;
  };
  Sequences s;
  Columns<FragmentRecord>& fragments = work.fragments;
  Columns<DepthRecord>& depths = work.depths;
  for (std::size_t i = 0; i < spans.size; ++i) {
    const std::int64_t triangle = spans[&SpanRecord::triangle][i];
    if (triangle != last_triangle) flush();  // a pixel may repeat from here on
    last_triangle = triangle;
    texture = draws[static_cast<std::size_t>(triangle - first_index)].texture;
    if (statistics != nullptr) {
      observed_registers(pipeline.span, spans, i, work, s, *statistics);
      fragments_of<nullptr, ObserveLanes>(pipeline.span, s, spans, i, true, true, fragments, seen);
      depth_codes_of<ObserveLanes>(pipeline.depth, fragments, depths, seen);
    } else {
      registers_of(pipeline.span, spans, i, work, s);
      fragments_of<nullptr, NoObserve>(pipeline.span, s, spans, i, true, true, fragments, nullptr);
      depth_codes_of<NoObserve>(pipeline.depth, fragments, depths, nullptr);
    }
    const std::int64_t x = spans[&SpanRecord::x][i];
    const std::int64_t y = spans[&SpanRecord::y][i];
    for (std::size_t k = 0; k < fragments.size; ++k) {
      FragmentRecord fragment = fragments.record(k);
      fragment.triangle = triangle;
      fragment.x = x + static_cast<std::int64_t>(k);
      fragment.y = y;
      fragment.covered = 1;
      fragment.last = k + 1 == fragments.size ? 1 : 0;
      DepthRecord depth = depths.record(k);
      depth.triangle = triangle;
      depth.x = fragment.x;
      depth.y = y;
      const auto pixel = pixel_of(frame, fragment);
      depth.stored = frame.depth[pixel];
      depth.pass = depth_passes(pipeline.depth.formats, pipeline.depth.func, depth.z, depth.stored) ? 1 : 0;
      if (trace != nullptr) {
        trace->fragment.push_back(fragment);
        trace->depth.push_back(depth);
      }
      if (depth.pass == 0) continue;
      ++counters.depth_passed;
      if (block.size == block_size) flush();
      append(block, fragment, depth, pixel, pipeline.fog);
    }
    const auto count = static_cast<std::uint64_t>(fragments.size);
    counters.fragments += count;
    counters.covered += count;
    counters.divides_pixel += count * static_cast<std::uint64_t>(pipeline.span.divides_per_fragment);
  }
  flush();
}

template <class T>
void draw_traced(const Pipeline& pipeline, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
                 std::int64_t first_index, SpanWork<T>& work, Frame& frame, Counters& counters,
                 BlockSink<T>& sink, Trace* trace, Statistics* statistics) {
  LaneStatistics seen;
  draw_every(pipeline, spans, draws, first_index, work, frame, counters, sink, trace, statistics, &seen);
  if (statistics != nullptr) seen.fold(*statistics);
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
