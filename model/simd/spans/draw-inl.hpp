// SPDX-License-Identifier: Apache-2.0
// Spans to blocks, the depth test first: only what passes gets u, v and shades.
#include <algorithm>
#include <cstring>

#include "model/simd/spans/blocks-inl.hpp"
#include "model/simd/spans/depth_test-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_DRAW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_DRAW_INL
#undef BITSPAN_MODEL_SIMD_SPANS_DRAW_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_DRAW_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

// Pixels of spans that passed, until they are put into blocks.
struct Passed {
  static constexpr std::size_t capacity = 4 * block_size;
  struct Piece {
    std::int32_t span, n;
  };
  std::size_t pieces = 0, size = 0;
  Piece piece[capacity];
  HWY_ALIGN std::int32_t place[capacity + column_slack];  // in the span
  HWY_ALIGN std::int32_t code[capacity + column_slack];
};

// First all depth tests of some spans, then what passed: each half is a short loop whose branches are as
// a span's, not a pixel's.
template <class T, const SpanFormats* fixed, const DepthFormats* fixed_depth>
void draw(const Pipeline& pipeline, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
          std::int64_t first_index, SpanWork<T>& work, Frame& frame, Counters& counters, BlockSink<T>& sink) {
  // Blocks of int32 go with registers that are all branch-free.
  using Watch = std::conditional_t<sizeof(T) == 4, BranchFree, NoObserve>;
  const DepthStage& stage = pipeline.depth;
  const FormatsOf<DepthFormats, fixed_depth> depth_formats(stage.formats);
  const DepthFormats& df = *depth_formats;
  constexpr DepthFunc less = DepthFunc::less;
  const PixelGrid grid = frame.grid();
  const bool only_nearer = passes_only_nearer(stage.func);
  find_ramps<fixed>(pipeline.span.formats, spans, work.ramps);
  Filler<T, Watch, fixed> filler(pipeline, work, sink);
  const std::int64_t* rows = spans[&SpanRecord::y];
  const std::int64_t* columns = spans[&SpanRecord::x];
  const std::int64_t* counts = spans[&SpanRecord::count];
  const std::int64_t* triangles = spans[&SpanRecord::triangle];
  const std::int64_t* u1 = spans[&SpanRecord::u1];
  const std::int64_t* v1 = spans[&SpanRecord::v1];
  const std::int64_t* h_starts = spans[starts[0]];
  const std::int64_t* h_increments = work.ramps.increment[0].data();
  const std::int64_t* linear = work.ramps.linear.data();
  Passed passed;
  std::uint64_t tested = 0;
  std::uint64_t fragments = 0;
  Sequences s;
  const auto put = [&]() HWY_ATTR {
    fragments += passed.size;
    std::size_t at = 0;
    for (std::size_t p = 0; p < passed.pieces; ++p) {
      const auto i = static_cast<std::size_t>(passed.piece[p].span);
      const auto n = static_cast<std::size_t>(passed.piece[p].n);
      const std::int64_t first_pixel = grid.place(columns[i], rows[i]);
      // Vectors look past the end, where the next span's places are: those of this one are taken there.
      HWY_ALIGN std::int32_t place[block_size + column_slack];
      for (std::size_t k = 0; k < n; k += Lanes32::count) {
        Lanes32::load(passed.place + at + k).store(place + k);
        __builtin_prefetch(frame.color.data() + 4 * (first_pixel + place[k]), 1);
      }
      Lanes32(0).store(place + n);
      filler.join(draws[static_cast<std::size_t>(triangles[i] - first_index)], triangles[i]);
      filler.need(n);
      registers_of(pipeline.span, spans, i, work, s);
      if (!filler.shared()) {
        std::memcpy(filler.block().z + filler.block().size, passed.code + at, n * sizeof(std::int32_t));
      }
      filler.put(s, u1[i], v1[i], first_pixel, place, n);
      at += n;
    }
    passed.pieces = passed.size = 0;
  };
  std::int64_t last_triangle = -1;
  bool last_shared = true;
  for (std::size_t i = 0; i < spans.size; ++i) {
    const std::size_t ahead = i + spans_ahead;
    if (ahead < spans.size) {
      fetch_depth(frame, grid.place(columns[ahead], rows[ahead]), counts[ahead]);
      __builtin_prefetch(&draws[static_cast<std::size_t>(triangles[ahead] - first_index)]);
    }
    const bool shared = draws[static_cast<std::size_t>(triangles[i] - first_index)].shared;
    // What is not shared stores its depth when its block is shaded.
    if (!(shared && last_shared) && triangles[i] != last_triangle) {
      put();
      filler.flush();
    }
    last_triangle = triangles[i];
    last_shared = shared;
    const auto count = static_cast<std::size_t>(counts[i]);
    std::uint32_t* const stored = frame.depth.data() + grid.place(columns[i], rows[i]);
    tested += count;
    const Sequence ramp{h_starts[i], h_increments[i], nullptr};
    for (std::size_t from = 0; from < count; from += block_size) {
      if (passed.size + block_size > Passed::capacity) put();
      const std::size_t to = std::min(count, from + block_size);
      std::int32_t* const place = passed.place + passed.size;
      std::int32_t* const code = passed.code + passed.size;
      std::size_t n = 0;
      if (linear[i] == 0) [[unlikely]] {
        registers_of(pipeline.span, spans, i, work, s);
        n = test_depth<false, Test::walked, Watch>(stage, df, stage.func, s[0], stored, from, to, place,
                                                   code);
        for (std::size_t k = 0; shared && k < n; ++k) stored[place[k]] = static_cast<std::uint32_t>(code[k]);
      } else if (!only_nearer) [[unlikely]] {
        n = shared ? test_depth_by_func<true, Watch>(stage, df, ramp, stored, from, to, place, code)
                   : test_depth_by_func<false, Watch>(stage, df, ramp, stored, from, to, place, code);
      } else if (!shared) {
        n = test_depth<false, Test::many, Watch>(stage, df, less, ramp, stored, from, to, place, code);
      } else if (count > few_pixels) {
        n = test_depth<true, Test::many, Watch>(stage, df, less, ramp, stored, from, to, place, code);
      } else {
        n = test_depth<true, Test::few, Watch>(stage, df, less, ramp, stored, from, to, place, code);
      }
      passed.piece[passed.pieces] = {static_cast<std::int32_t>(i), static_cast<std::int32_t>(n)};
      passed.pieces += n != 0 ? 1 : 0;
      passed.size += n;
    }
  }
  put();
  filler.flush();
  counters.fragments += tested;
  counters.covered += tested;
  counters.depth_passed += fragments;
  counters.divides_pixel += tested * static_cast<std::uint64_t>(pipeline.span.divides_per_fragment);
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
