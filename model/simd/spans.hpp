// SPDX-License-Identifier: Apache-2.0
// The vector form's second half up to the depth test: spans to fragments that passed, in blocks.
//
// Depth comes first. A span's h is a ramp, so its depth codes are compared with the buffer a vector at a
// time, and only fragments that pass get a reciprocal, u, v and shades. Nothing of that changes a bit: a
// stage's records do not depend on the others' order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/engine.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "model/simd/columns.hpp"
#include "model/simd/fragment_block.hpp"

namespace bitspan::model {

// One a triangle of a batch.
struct SpanDraw {
  std::int32_t texture = -1;
  // None of its fragments can be killed and all are opaque: they may share a block with other triangles', and
  // their depth is stored when it is tested. In draw states other than the first, depth alone decides, too.
  bool shared = false;
  bool back = false;       // a back face; told only where the stencil test asks
  bool is_unseen = false;  // none of its fragments can be killed, and the draw state writes depth alone
  int log2_dz = 0;         // for depth.code = float_dz
};

// Spans' channels in use, by their place: only the columns w and w_step0 are written.
using ChannelColumns = PerChannel<Columns<SpanChannelRecord>>;

// Where blocks go: texture, fog and merge.
template <class T>
struct BlockSink {
  virtual ~BlockSink() = default;
  virtual void operator()(const FragmentBlock<T>& block, const BlockDraw& draw) = 0;
};

// A span's registers in closed form: value i of a register is start + i increment where every linear[span]
// says so. In the order h, fu, fv, r, g, b, a.
struct Ramps {
  std::array<std::vector<std::int64_t>, 7> increment;
  std::vector<std::int64_t> linear;  // 0 or 1
};

// What drawing spans needs from call to call.
template <class T>
struct SpanWork {
  FragmentBlock<T> block;
  // Registers of the block's fragments, until it is given away.
  alignas(64) std::int64_t fu[FragmentBlock<T>::padded];
  alignas(64) std::int64_t fv[FragmentBlock<T>::padded];
  alignas(64) std::int64_t u1[FragmentBlock<T>::padded];
  alignas(64) std::int64_t v1[FragmentBlock<T>::padded];
  Ramps ramps;
  std::array<std::vector<std::int64_t>, 7> values;  // registers of a span that are no ramp, one per pixel
  PerChannel<std::vector<std::int64_t>> channel_values;  // the same of channels
  Columns<FragmentRecord> fragments{0};
  Columns<DepthRecord> depths{0};

  // Who had a pixel of some rows last, by numbers of spans, and the pieces of shared spans that wait until
  // that is known.
  std::vector<std::int32_t> owners;
  struct Piece {
    std::size_t span, from, to;
  };
  std::vector<Piece> owning;
  // Returns the number of the first of n spans of so many pixels, which no pixel has yet.
  std::int32_t number_spans(std::size_t pixels, std::size_t n) {
    if (numbered + n > std::numeric_limits<std::int32_t>::max()) {
      owners.clear();
      numbered = 0;
    }
    if (owners.size() < pixels) owners.resize(pixels, -1);
    const auto first = static_cast<std::int32_t>(numbered);
    numbered += n;
    return first;
  }
  std::size_t numbered = 0;
};

template <class T>
struct SpanKernels {
  // Draws spans in order into frame.depth and blocks; all modes but const_depth_rows. triangle column: input
  // index, first_index the one of draws[0]. Counts fragments, covered, depth_passed, divides_pixel.
  void (*draw)(const Pipeline&, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
               std::int64_t first_index, SpanWork<T>&, Frame&, Counters&, BlockSink<T>&) = nullptr;
  // The same in any draw state, of formats read at run time, and with channels. Of shared draws only the last
  // one per pixel comes into a block; one that is unseen gives no block. Counts masked, stencil_failed and
  // what of unseen draws is written, too; where the tests are late, they are the sink's.
  void (*draw_any)(const Pipeline&, const Columns<SpanRecord>& spans, const ChannelColumns& channels,
                   std::span<const SpanDraw> draws, std::int64_t first_index, SpanWork<T>&, Frame&, Counters&,
                   BlockSink<T>&) = nullptr;
  // The first one for every fragment, passed or not, with its records, or with observers at every register.
  void (*draw_traced)(const Pipeline&, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
                      std::int64_t first_index, SpanWork<T>&, Frame&, Counters&, BlockSink<T>&, Trace*,
                      Statistics*) = nullptr;
  // The span stage alone: fragments of span i into columns h, u, v (and the shades where `shades`).
  void (*evaluate)(const SpanStage&, const Columns<SpanRecord>& spans, std::size_t i, bool shades,
                   SpanWork<T>&, Columns<FragmentRecord>&) = nullptr;
  // The same with statistics of every register.
  void (*evaluate_observed)(const SpanStage&, const Columns<SpanRecord>& spans, std::size_t i, bool shades,
                            SpanWork<T>&, Columns<FragmentRecord>&, Statistics&) = nullptr;
};

// Appends a fragment that passed; pixel: y width + x; fog_factor: fog of the vertices only. There is room.
template <class T>
void append(FragmentBlock<T>& block, const FragmentRecord& fragment, const DepthRecord& depth,
            std::size_t pixel, const FogStage& fog, std::int64_t fog_factor = 0) {
  const std::size_t to = block.size++;
  block.pixel[to] = static_cast<std::int32_t>(pixel);
  block.z[to] = static_cast<std::int32_t>(static_cast<std::uint32_t>(depth.z));
  block.u[to] = static_cast<T>(fragment.u);
  block.v[to] = static_cast<T>(fragment.v);
  block.r[to] = static_cast<T>(fragment.r);
  block.g[to] = static_cast<T>(fragment.g);
  block.b[to] = static_cast<T>(fragment.b);
  block.a[to] = static_cast<T>(fragment.a);
  block.h[to] = fragment.h;
  block.fog_step[to] = static_cast<std::int32_t>(fog_step(fog, fragment.h));
  block.fog_factor[to] = static_cast<T>(fog_factor);
  block.triangle[to] = static_cast<std::int32_t>(fragment.triangle);
}

// Formats read at run time. T = std::int32_t where u, v and shades fit it and every register of a fragment
// rounds by adding a constant and saturates. Throws InputError where the processor lacks the target.
template <class T>
SpanKernels<T> span_kernels(VectorTarget target);

// Whether every register that a fragment passes in the span stage rounds by adding a constant, and saturates,
// and no shift on the way takes more than a lane has.
constexpr bool branch_free_span(const SpanFormats& f) {
  const int reciprocal_fraction = std::max(f.reciprocal.config.table_bits, f.reciprocal.config.internal_bits);
  return is_branch_free(f.uv) && is_branch_free(f.shade) && is_branch_free(f.reciprocal.output) &&
         reciprocal_fraction - f.reciprocal.output.fraction <= 62 && f.f.acc.fraction - f.uv.fraction <= 62 &&
         f.shade_acc.acc.fraction - f.shade.fraction <= 62;
}
// Whether u, v and shades fit blocks of std::int32_t, shades through 32-bit lanes with a bit to round by.
constexpr bool spans_fit_int32(const SpanFormats& f) {
  return branch_free_span(f) && f.uv.word <= 31 && f.shade.word <= 30 && f.shade_acc.acc.word <= 30 &&
         f.shade_acc.acc.fraction - f.shade.fraction <= 30 &&
         f.shade_acc.acc.word + std::max(0, f.shade.fraction - f.shade_acc.acc.fraction) <= 30;
}

// Why this configuration's spans cannot be drawn in lanes; null where they can.
const char* spans_refusal(const Config& config);

}  // namespace bitspan::model
