// SPDX-License-Identifier: Apache-2.0
#include "tb/row_batch.hpp"

namespace bitspan {
namespace {

constexpr std::int64_t pixels_a_run = 1 << 16;

std::int64_t pixels_of(const model::Rows& rows, std::size_t from) {
  std::int64_t pixels = 0;
  for (std::size_t i = from; i < rows.rows.size(); ++i)
    pixels += rows.rows[i].x_last - rows.rows[i].x_first + 1;
  for (std::size_t i = from; i < rows.plane_rows.size(); ++i) pixels += rows.plane_rows[i].count;
  return pixels;
}

}  // namespace

void RowBatch::clear() {
  rows.clear();
  surfaces.clear();
}

void draw_in_batches(const model::Pipeline& pipeline, const Scene& scene, std::span<const Triangle> triangles,
                     std::int64_t first_index, RowBatch& batch, Counters& counters, Trace* trace,
                     const std::function<void()>& run) {
  batch.clear();
  std::int64_t pixels = 0;
  std::int64_t index = first_index;
  for (const Triangle& triangle : triangles) {
    model::check_triangle(scene, triangle, index);
    const std::size_t before = batch.rows.size();
    model::triangle_to_rows(pipeline, triangle, index, batch.walk, batch.rows, counters, trace);
    batch.surfaces.resize(batch.rows.size(), model::surface_of(pipeline, triangle));
    pixels += pixels_of(batch.rows, before);
    if (pixels >= pixels_a_run) {
      run();
      pixels = 0;
    }
    ++index;
  }
  run();
}

}  // namespace bitspan
