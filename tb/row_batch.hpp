// SPDX-License-Identifier: Apache-2.0
// Rows of several triangles, which go through a simulated design in one run.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/counters.hpp"
#include "engine/records.hpp"
#include "model/pipeline.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct RowBatch {
  model::Rows rows;
  std::vector<model::Surface> surfaces;  // one per row
  model::PlaneWalkState walk;

  void clear();
};

// Collects the rows of triangles, and calls `run` where the batch has some 2^16 pixels, and at the end. `run`
// leaves the batch empty. Throws InputError for a triangle that is not legal.
void draw_in_batches(const model::Pipeline& pipeline, const Scene& scene, std::span<const Triangle> triangles,
                     std::int64_t first_index, RowBatch& batch, Counters& counters, Trace* trace,
                     const std::function<void()>& run);

}  // namespace bitspan
