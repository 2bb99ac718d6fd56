// SPDX-License-Identifier: Apache-2.0
// The work that the records of a run are to the stages: which triangles, rows and fragments there are, where
// they end, what they ask of the memory. Span mode's clocks know no more of the records. The workload follows
// from the values alone, in the order of the records; so it is made ahead of the clocks, a span at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "model/timed/edge_walk.hpp"
#include "model/timed/plane_walk.hpp"
#include "model/timed/ring.hpp"
#include "model/timed/traffic.hpp"

namespace bitspan::timed {

// An unending sequence of which a window is kept. Records are numbered from 0 on, since begin().
template <class T>
class Window {
 public:
  void push(const T& item) { kept_.push_back(item); }
  std::uint64_t end() const { return first_ + kept_.size(); }
  const T& operator[](std::uint64_t number) const { return kept_[number - first_]; }
  // Those before `number` are not asked for any more; amortised to nothing.
  void forget(std::uint64_t number) {
    const auto gone = static_cast<std::ptrdiff_t>(number - first_);
    if (2 * static_cast<std::size_t>(gone) < kept_.size()) return;
    kept_.erase(kept_.begin(), kept_.begin() + gone);
    first_ = number;
  }

 private:
  std::vector<T> kept_;
  std::uint64_t first_ = 0;
};

// A step of edge_walk or plane_walk: a row walked, or a triangle without any.
struct WalkStep {
  std::uint32_t pixels = 0;  // of the row's record; 0: it has none
  bool last = false;         // of the triangle
};

// A fragment in front of depth, texture or merge.
struct FragmentWork {
  std::uint32_t pixel = 0;  // index into the frame
  Asks asks = 0;
  bool covered : 1 = false;  // before depth: it is tested, and so may not enter while its pixel is held
  bool kept : 1 = false;     // goes on to the next stage
  // From depth on: later fragments of the pixel wait in front of depth until this one ends.
  bool holds_pixel : 1 = false;
};

class Workload {
 public:
  explicit Workload(Run& run);
  ~Workload();

  // The next draw call; the last one's triangles have all been walked. Without a trace the values come from
  // the vector form's kernels (model/simd/) where the configuration has them, else from the stage functions.
  void start(std::span<const Triangle> triangles, std::int64_t first_index);
  // Makes what is left of the draw call once its clocks have run: counts the triangles without an area behind
  // the last that was walked.
  void finish();
  // Whether triangle `number` goes on from setup; it has been offered.
  bool triangle_kept(std::uint64_t number) {
    while (number >= triangles_.end()) set_up();
    return triangles_[number] != 0;
  }
  // Step `number` has been made already.
  bool has_step(std::uint64_t number) const { return number < steps_.end(); }
  // Step `number` of all walks; the triangle it belongs to has been offered.
  const WalkStep& step(std::uint64_t number) {
    while (number >= steps_.end()) make_rows();
    return steps_[number];
  }
  // Fragment `number` in front of a stage behind span; it has been walked. Where a stage takes every fragment
  // and asks nothing of the memory (fog), nothing is kept, and there is no such number.
  const FragmentWork& fragment(Stage stage, std::uint64_t number) const { return of(stage)[number]; }

  struct Read {
    std::uint64_t triangles = 0, steps = 0;
    std::array<std::uint64_t, stage_count> fragments{};  // of each stage behind span
  };
  // Forgets the work in front of what each stage has read.
  void forget(const Read& read);

  // Of depth, texture or merge.
  std::span<const Access> accesses(Stage stage) const;
  const Cache& texture_cache() const { return texture_traffic_.cache(); }
  void add_reports(TimedReport& report) const {
    timed::add_reports(texture_cache(), depth_traffic_, merge_traffic_, report);
  }
  void cleared(const Clear& clear) {
    depth_traffic_.cleared(clear);
    merge_traffic_.cleared(clear);
  }
  void scene_changed(std::uint64_t since);
  void target_changed() {
    depth_traffic_.target_changed();
    merge_traffic_.target_changed();
  }

 private:
  class Batch;

  Window<FragmentWork>& of(Stage stage) { return fragments_[static_cast<std::size_t>(stage)]; }
  const Window<FragmentWork>& of(Stage stage) const { return fragments_[static_cast<std::size_t>(stage)]; }

  void set_up();
  void make_rows();
  template <class Walk>
  void make_rows(Walk& walk);
  void make_fragments();
  void make_fragment(FragmentItem& item);
  // Make the values of a fragment in front of the stage, and add its work; false where it ends there. drawn:
  // as drawn_values says.
  bool make_depth(FragmentItem& item, bool drawn);
  bool make_texture(FragmentItem& item, bool drawn);
  // Add the work of a fragment that is drawn.
  void add_texture(std::size_t pixel, Asks asks, bool lives);
  void add_merge(std::size_t pixel, MergeTraffic::Needs needs);

  Run& run_;
  std::span<const Triangle> to_set_up_;
  std::int64_t index_ = 0;        // of the next one
  std::unique_ptr<Batch> batch_;  // null where the configuration has no vector form
  bool batched_ = false;          // this draw call
  // A record at a time:
  TriangleItem triangle_;
  Ring<TriangleItem> to_walk_;  // set up
  bool walking_ = false;
  EdgeWalk edge_walk_;
  PlaneWalk plane_walk_;
  RowItem row_;
  FragmentItem fragment_;

  DepthTraffic depth_traffic_;
  TextureTraffic texture_traffic_;
  MergeTraffic merge_traffic_;
  Window<std::uint8_t> triangles_;  // kept
  Window<WalkStep> steps_;
  std::array<Window<FragmentWork>, stage_count> fragments_;  // of the stages behind span
};

}  // namespace bitspan::timed
