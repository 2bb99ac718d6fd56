// SPDX-License-Identifier: Apache-2.0
// edge_walk and plane_walk as clocked stages: a triangle in, its rows out.
//
// Walk is the stage function's adapter: start(TriangleItem&) takes a triangle (the walk may keep the
// reference until it is finished), finished() tells that no row is left, row(RowItem&) walks one row and is
// false where it has no record.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "model/timed/items.hpp"
#include "model/timed/stage.hpp"

namespace bitspan::timed {

template <class Walk>
class WalkStage : public TimedStage {
 public:
  WalkStage(std::string_view name, const StageTiming& timing, Fifo<TriangleItem*>& in, Fifo<RowItem*>& out,
            Pool<TriangleItem>& triangles, Pool<RowItem>& rows, Walk walk)
      : in_(in), out_(out), triangles_(triangles), rows_(rows), walk_(std::move(walk)), line_(timing, 0) {
    meter_.report.name = name;
    meter_.report.fifo_capacity = in.capacity();
  }

  void clock(std::uint64_t now) override {
    StageSignals& s = meter_.signals;
    meter_.see_fifo(in_.occupancy(now));
    s.in_valid = in_.can_pop(now);
    s.out_ready = out_.can_push(now);
    s.out_valid = line_.has_due(now);
    bool moved = false;

    if (s.out_valid && s.out_ready) {
      out_.push(now) = line_.head().item;
      line_.pop();
      ++meter_.report.records_out;
      moved = true;
    }

    // A walked row takes an interval, and so does the acceptance of a triangle that has none.
    const bool in_interval = line_.in_interval(now);
    const bool can_walk = line_.can_enter(now);
    s.in_ready = current_ == nullptr && can_walk;
    if (s.in_ready && s.in_valid) {
      current_ = in_.front();
      in_.pop(now);
      ++meter_.report.records_in;
      walk_.start(*current_);
    }
    const bool walked = current_ != nullptr && can_walk;
    if (walked) {
      line_.take_interval(now);
      if (!walk_.finished()) {
        if (spare_ == nullptr) spare_ = rows_.get();
        if (walk_.row(*spare_)) {
          line_.enter(spare_, now);
          spare_ = nullptr;
        }
      }
      if (walk_.finished()) {
        triangles_.put(current_);
        current_ = nullptr;
      }
    }

    if (moved || walked) ++meter_.moves;
    const bool has_work = current_ != nullptr || s.in_valid;
    meter_.count(walked || in_interval         ? StageState::busy
                 : s.out_valid && !s.out_ready ? StageState::blocked
                 : has_work                    ? StageState::busy
                                               : StageState::starved);
  }

  bool idle() const override { return line_.empty() && current_ == nullptr; }
  std::vector<StageMeter*> meters() override { return {&meter_}; }

 private:
  Fifo<TriangleItem*>& in_;
  Fifo<RowItem*>& out_;
  Pool<TriangleItem>& triangles_;
  Pool<RowItem>& rows_;
  Walk walk_;
  DelayLine<RowItem> line_;
  TriangleItem* current_ = nullptr;
  RowItem* spare_ = nullptr;  // for the next row that has a record
  StageMeter meter_;
};

}  // namespace bitspan::timed
