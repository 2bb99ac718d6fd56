// SPDX-License-Identifier: Apache-2.0
#include "bench/span_case.hpp"

#include <algorithm>

#include "bench/scenes.hpp"

namespace bitspan::bench {

SpanCase make_span_case(const Config& config, int spans, int shortest, int longest) {
  constexpr double triangle_pixels = 300000;
  constexpr std::size_t row_stride = 7;  // rows left out between those taken of a triangle
  SpanCase c;
  c.config = config;
  c.scene = empty_scene("spans", 4096, 1024);
  c.pipeline = model::make_pipeline(config, c.scene);
  CloudStream stream(3, c.scene, triangle_pixels);
  Random random(4);
  Counters counters;
  model::PlaneWalkState walk;
  while (c.spans.size() < static_cast<std::size_t>(spans)) {
    model::Rows rows;
    model::triangle_to_rows(c.pipeline, stream.next(), 0, walk, rows, counters, nullptr);
    for (std::size_t i = 0; i < rows.size() && c.spans.size() < static_cast<std::size_t>(spans);
         i += row_stride) {
      RowRecord& row = rows.rows[i];
      const std::int64_t length = random.integer(shortest, longest);
      if (row.x_last - row.x_first + 1 >= length) {
        row.x_last = row.x_first + length - 1;
        c.rows.push_back(row);
        c.spans.push_back(model::row_to_span(c.pipeline, rows, i, counters));
        c.pixels += length;
      }
    }
  }
  return c;
}

}  // namespace bitspan::bench
