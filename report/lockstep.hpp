// SPDX-License-Identifier: Apache-2.0
// Several engines over one scene, in step: a batch of triangles through each, compared, then the next batch,
// so that memory stays bounded whatever the scene's size.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/engine.hpp"
#include "report/compare.hpp"

namespace bitspan {

// Triangles of a scene, or of a piece of one, that go through the engines together.
struct Batch {
  const Scene& piece;
  std::size_t first, count;  // of the piece's triangles
  std::int64_t first_index;  // of the first one in the scene

  std::span<const Triangle> triangles() const { return std::span(piece.triangles).subspan(first, count); }
};
// Draws them with their commands.
inline void draw_batch(Engine& engine, const Batch& batch, Trace* trace) {
  draw_scene(engine, batch.piece, batch.first, batch.count, batch.first_index, trace);
}

struct LockStepOptions {
  // A batch ends when it has this many triangles, or when their bounding boxes reach this many pixels. A
  // trace takes about half a kilobyte per fragment and two per triangle, and two traces are held at a time:
  // small enough for the processor's caches, where they are made, counted and compared.
  std::size_t batch_triangles = 512;
  std::size_t batch_pixels = 1 << 13;
  // Called after each batch with the triangles done; may be empty.
  std::function<void(std::size_t)> progress;
  // Called with every batch and the records of the first engine; may be empty.
  std::function<void(const Batch&, const Trace&)> observe;
};

struct LockStepResult {
  std::vector<Comparison> pairs;     // of engine 1, 2 ... with engine 0
  std::uint64_t records = 0;         // delivered by engine 0
  std::uint64_t triangles_done = 0;  // fewer than the scene's where a divergence ended the run
  bool stopped = false;
  double seconds = 0;
};

// Number of triangles, from `from` on, that make the next batch: at least one.
std::size_t next_batch(const Scene& scene, std::size_t from, const LockStepOptions& options);

// Gives the next piece of a scene: triangles with their commands, whose `before` counts from the piece's
// first triangle. Null at the end. A piece lives until the next one is asked for; there is one at least.
using NextPiece = std::function<const Scene*()>;

// Runs all engines to the end, or to the end of the batch with the first divergence. Frames and counters are
// compared at the end. Throws InputError where the scene does not fit the configuration.
LockStepResult run_lock_step(std::span<const std::unique_ptr<Engine>> engines, const Scene& scene,
                             const LockStepOptions& options);
// The same of a scene in pieces; of `scene` the view, the name and the textures count.
LockStepResult run_lock_step(std::span<const std::unique_ptr<Engine>> engines, const Scene& scene,
                             const NextPiece& next, const LockStepOptions& options);

}  // namespace bitspan
