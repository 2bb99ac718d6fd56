// SPDX-License-Identifier: Apache-2.0
// The work of the kernel benchmark: spans of delta_f, from their start values to h, u, v at each pixel.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/pipeline.hpp"
#include "scene/scene.hpp"

namespace bitspan::bench {

struct SpanCase {
  Config config;
  Scene scene;
  model::Pipeline pipeline;
  std::vector<RowRecord> rows;    // the RTL takes these
  std::vector<SpanRecord> spans;  // every other kernel takes these
  std::int64_t pixels = 0;        // of all spans
};

// Makes spans of random triangles, cut to shortest..longest pixels.
SpanCase make_span_case(const Config& config, int spans, int shortest, int longest);

// Raw values on span.h and span.uv, span after span.
struct SpanOutput {
  std::vector<std::int64_t> h, u, v;
};
inline void resize(SpanOutput& out, const SpanCase& c) {
  const auto size = static_cast<std::size_t>(c.pixels);
  out.h.resize(size);
  out.u.resize(size);
  out.v.resize(size);
}

// Computes every span of the case it was made for, which must outlive it. While it is timed, `keep` is null
// and the results stay in buffers of the kernel's own; otherwise they are copied there, to be compared.
using SpanKernel = std::function<void(SpanOutput* keep)>;

}  // namespace bitspan::bench
