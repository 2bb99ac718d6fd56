// SPDX-License-Identifier: Apache-2.0
// Spans to blocks in any draw state that lanes take, a triangle's fragments at a time. Where the tests are
// early, those of a pixel come before its u, v and shades; where they are late, with what shades the block.
// Of triangles that replace what a pixel has, all are tested first, and a pixel is shaded once: what a later
// one of the same spans hides is counted, and leaves nothing else.
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
                                       std::int32_t* codes, const Owners& owners = {}) {
  const DepthFormats f = stage.formats;  // a copy: no store can change it
  if (is_ramp(h)) {
    return test_depth<store, Test::many, Watch, Bias::of_state>(stage, f, stage.func, h, stored, from, to,
                                                                passing, codes, owners);
  }
  const std::size_t n = test_depth<false, Test::walked, Watch, Bias::of_state>(
      stage, f, stage.func, h, stored, from, to, passing, codes);
  for (std::size_t k = 0; store && k < n; ++k) stored[passing[k]] = static_cast<std::uint32_t>(codes[k]);
  for (std::size_t k = 0; owners.of != nullptr && k < n; ++k) owners.of[passing[k]] = owners.own;
  return n;
}

// The places from .. to of a span that it has last. Returns how many.
HWY_INLINE std::size_t owned(const Owners& owners, std::size_t from, std::size_t to, std::int32_t* places) {
  const Lanes32::Tag d;
  std::size_t n = 0;
  for (std::size_t k = from; k < to; k += Lanes32::count) {
    const Lanes32::Mask inside{hn::FirstN(d, to - k)};
    const Lanes32 of = Lanes32::from(hn::MaskedLoad(inside.m, d, owners.of + k));
    const Lanes32::Mask own = (of == Lanes32(owners.own)) & inside;
    if (!any(own)) continue;
    packed(Lanes32::iota(static_cast<std::int32_t>(k)), own).store(places + n);
    n += set_in(own);
  }
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
  const PixelGrid grid = frame.grid();
  const bool tests_depth_alone = !late && depth_decides_alone(pipeline);
  std::uint64_t fragments = 0;
  const int depth_at = pipeline.channels.depth_at;
  Sequences s;
  PerChannel<Sequence> of_channels;
  HWY_ALIGN std::int32_t places[block_size + column_slack];
  HWY_ALIGN std::int32_t codes[block_size + column_slack];
  const auto draw_of = [&](std::size_t i) -> const SpanDraw& {
    return draws[static_cast<std::size_t>(spans[&SpanRecord::triangle][i] - first_index)];
  };
  const auto pixel_of = [&](std::size_t i) {
    return grid.place(spans[&SpanRecord::x][i], spans[&SpanRecord::y][i]);
  };
  // Pixels of span i, whose registers and channels are there.
  const auto put = [&](std::size_t i, std::size_t n) HWY_ATTR {
    Lanes32(0).store(places + n);  // vectors look past the end
    filler.need(n);
    if (!filler.shared()) {
      std::memcpy(filler.block().z + filler.block().size, codes, n * sizeof(std::int32_t));
    }
    filler.put_channels(of_channels, places, n);
    filler.put(s, spans[&SpanRecord::u1][i], spans[&SpanRecord::v1][i], pixel_of(i), places, n);
  };
  const auto find_channels = [&](std::size_t i) HWY_ATTR {
    channels_of(pipeline.channels, channels, i, static_cast<std::size_t>(spans[&SpanRecord::count][i]),
                work.channel_values, of_channels);
  };
  // Spans are numbered on and on, so that what earlier calls left is nobody's.
  std::int32_t first_own = -1;
  std::int64_t first_owned = 0;  // the pixel that work.owners begins with
  const auto number_spans = [&] {
    const std::span<const std::int64_t> rows(spans[&SpanRecord::y], spans.size);
    const auto [top, bottom] = std::ranges::minmax(rows);
    first_owned = grid.place(0, top);
    first_own = work.number_spans(static_cast<std::size_t>((bottom - top + 1) * frame.width), spans.size);
  };
  const auto owners_of = [&](std::size_t i) -> Owners {
    return {work.owners.data() + (pixel_of(i) - first_owned), first_own + static_cast<std::int32_t>(i)};
  };
  std::uint64_t waiting = 0;  // fragments of `work.owning` that passed
  const auto shade_owned = [&]() HWY_ATTR {
    if (work.owning.empty()) return;
    for (const auto& piece : work.owning) {
      const std::size_t n = owned(owners_of(piece.span), piece.from, piece.to, places);
      if (n == 0) continue;
      filler.join(draw_of(piece.span), spans[&SpanRecord::triangle][piece.span]);
      registers_of(pipeline.span, spans, piece.span, work, s);
      find_channels(piece.span);
      put(piece.span, n);
      waiting -= n;
    }
    filler.flush();
    counters.written += waiting;  // and written over
    work.owning.clear();
    waiting = 0;
  };
  for (std::size_t i = 0; i < spans.size; ++i) {
    const std::int64_t triangle = spans[&SpanRecord::triangle][i];
    const SpanDraw& draw = draw_of(i);
    const std::int64_t x = spans[&SpanRecord::x][i];
    const std::int64_t y = spans[&SpanRecord::y][i];
    const std::int64_t first_pixel = pixel_of(i);
    const auto count = static_cast<std::size_t>(spans[&SpanRecord::count][i]);
    tests.back = draw.back;
    fragments += count;
    if (const std::size_t ahead = i + spans_ahead; ahead < spans.size) {
      fetch_depth(frame, pixel_of(ahead), spans[&SpanRecord::count][ahead]);
    }
    if (draw.shared) {
      filler.flush();  // what is not shared stores its depth with its block
      registers_of(pipeline.span, spans, i, work, s);
      if (depth_at >= 0) find_channels(i);
      if (first_own < 0) number_spans();
    } else {
      shade_owned();
      // Gives another triangle's block away: from here on a pixel may repeat.
      filler.join(draw, triangle);
      registers_of(pipeline.span, spans, i, work, s);
      find_channels(i);
    }
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
      if (draw.shared) {
        n = test_by_state<true, Watch>(pipeline.depth, line, stored, from, to, places, codes, owners_of(i));
        counters.depth_passed += n;
        waiting += n;
        if (n != 0) work.owning.push_back({i, from, to});
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
      if (n != 0) put(i, n);
    }
  }
  shade_owned();
  filler.flush();
  counters.fragments += fragments;
  counters.covered += fragments;
  counters.divides_pixel += fragments * static_cast<std::uint64_t>(pipeline.span.divides_per_fragment);
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
