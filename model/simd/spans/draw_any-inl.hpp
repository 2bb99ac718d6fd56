// SPDX-License-Identifier: Apache-2.0
// Spans to blocks in any draw state that lanes take, a triangle's fragments at a time. Where the tests are
// early, those of a pixel come before its u, v and shades; where they are late, with what shades the block.
#include <algorithm>
#include <cstring>

#include "config/modes.hpp"
#include "model/simd/pixel_tests.hpp"
#include "model/simd/spans/blocks-inl.hpp"
#include "model/simd/spans/depth_test-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_DRAW_ANY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_DRAW_ANY_INL
#undef BITSPAN_MODEL_SIMD_SPANS_DRAW_ANY_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_DRAW_ANY_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

// The depth buffer's words of pixels from .. to of a span, with the draw state's bias; log2_dz: of the
// triangle.
template <class Watch>
HWY_NOINLINE void depth_words(const DepthStage& stage, const Sequence& h, int log2_dz, std::size_t from,
                              std::size_t to, std::int32_t* codes) {
  const DepthFormats f = stage.formats;
  for (std::size_t k = from; k < to; k += Lanes::count) {
    const Lanes place = Lanes::iota(static_cast<std::int64_t>(k));
    store_as(codes + (k - from), biased(stage, depth_code_of(stage, f, at(h, place), Watch{}).z));
  }
  for (std::size_t k = 0; has_dz(f.code) && k < to - from; ++k) {
    const std::int64_t z = static_cast<std::uint32_t>(codes[k]);
    codes[k] = static_cast<std::int32_t>(packed_depth({z, log2_dz}, f.z.word));
  }
}

// As test_depth, by the draw state's comparison and bias.
template <bool store, class Watch>
HWY_NOINLINE std::size_t test_by_state(const DepthStage& stage, const Sequence& h, std::uint32_t* stored,
                                       std::size_t from, std::size_t to, std::int32_t* passing,
                                       std::int32_t* codes) {
  const DepthFormats f = stage.formats;  // a copy: no store can change it
  if (is_ramp(h)) {
    return test_depth<store, Test::many, Watch, Bias::of_state>(stage, f, stage.func, h, stored, from, to,
                                                                passing, codes);
  }
  const std::size_t n = test_depth<false, Test::walked, Watch, Bias::of_state>(
      stage, f, stage.func, h, stored, from, to, passing, codes);
  for (std::size_t k = 0; store && k < n; ++k) stored[passing[k]] = static_cast<std::uint32_t>(codes[k]);
  return n;
}

template <class T>
void draw_any(const Pipeline& pipeline, const Columns<SpanRecord>& spans, const ChannelColumns& channels,
              std::span<const SpanDraw> draws, std::int64_t first_index, SpanWork<T>& work, Frame& frame,
              Counters& counters, BlockSink<T>& sink) {
  using Watch = std::conditional_t<sizeof(T) == 4, BranchFree, NoObserve>;
  find_ramps<nullptr>(pipeline.span.formats, spans, work.ramps);
  Filler<T, Watch, nullptr> filler(pipeline, work, sink);
  PixelTests tests{pipeline, false, frame, counters};
  const bool late = is_late(pipeline.state.depth_when);
  const bool tests_depth_alone = !late && tests.depth_alone();
  std::uint64_t fragments = 0;
  const int depth_at = pipeline.channels.depth_at;
  Sequences s;
  PerChannel<Sequence> of_channels;
  HWY_ALIGN std::int32_t places[block_size + column_slack];
  HWY_ALIGN std::int32_t codes[block_size + column_slack];
  for (std::size_t i = 0; i < spans.size; ++i) {
    const std::int64_t triangle = spans[&SpanRecord::triangle][i];
    const SpanDraw& draw = draws[static_cast<std::size_t>(triangle - first_index)];
    const std::int64_t x = spans[&SpanRecord::x][i];
    const std::int64_t y = spans[&SpanRecord::y][i];
    const std::int64_t first_pixel = y * frame.width + x;
    const auto count = static_cast<std::size_t>(spans[&SpanRecord::count][i]);
    tests.back = draw.back;
    fragments += count;
    if (const std::size_t ahead = i + spans_ahead; ahead < spans.size) {
      fetch_depth(frame, spans[&SpanRecord::y][ahead] * frame.width + spans[&SpanRecord::x][ahead],
                  spans[&SpanRecord::count][ahead]);
    }
    // Gives another triangle's block away: from here on a pixel may repeat.
    filler.join(draw, triangle);
    registers_of(pipeline.span, spans, i, work, s);
    channels_of(pipeline.channels, channels, i, count, work.channel_values, of_channels);
    for (std::size_t from = 0; from < count; from += block_size) {
      const std::size_t to = std::min(count, from + block_size);
      // The channel z has the registers of h.
      const Sequence& line = depth_at < 0 ? s[0] : of_channels[static_cast<std::size_t>(depth_at)];
      std::uint32_t* const stored = frame.depth.data() + first_pixel;
      std::size_t n = 0;
      if (tests_depth_alone && draw.is_unseen) {
        n = test_by_state<true, Watch>(pipeline.depth, line, stored, from, to, places, codes);
        counters.depth_passed += n;
        counters.written += n;
        continue;
      }
      if (tests_depth_alone) {
        n = test_by_state<false, Watch>(pipeline.depth, line, stored, from, to, places, codes);
        counters.depth_passed += n;
      } else {
        depth_words<Watch>(pipeline.depth, line, draw.log2_dz, from, to, codes);
        for (std::size_t k = from; k < to; ++k) {
          const auto at = static_cast<std::int64_t>(k);
          const std::int32_t z = codes[k - from];
          if (!tests.is_drawn(x + at, y)) continue;
          if (!late &&
              !tests.passes(static_cast<std::uint32_t>(z), static_cast<std::size_t>(first_pixel + at))) {
            continue;
          }
          places[n] = static_cast<std::int32_t>(at);
          codes[n++] = z;
        }
      }
      if (n == 0) continue;
      Lanes32(0).store(places + n);  // vectors look past the end
      filler.need(n);
      std::memcpy(filler.block().z + filler.block().size, codes, n * sizeof(std::int32_t));
      filler.put_channels(of_channels, places, n);
      filler.put(s, spans[&SpanRecord::u1][i], spans[&SpanRecord::v1][i], first_pixel, places, n);
    }
  }
  filler.flush();
  counters.fragments += fragments;
  counters.covered += fragments;
  counters.divides_pixel += fragments * static_cast<std::uint64_t>(pipeline.span.divides_per_fragment);
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
