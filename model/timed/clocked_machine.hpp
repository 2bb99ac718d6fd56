// SPDX-License-Identifier: Apache-2.0
// A machine that steps its parts on every clock, under the SystemC kernel or without it, and what all of them
// begin with: the source of triangles, setup and the walk. What stands behind the walk is the derived
// class's.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/timed/kernel.hpp"
#include "model/timed/machine.hpp"
#include "model/timed/setup.hpp"

namespace bitspan::timed {

// Offers a draw call's triangles, one per clock while setup's FIFO has room.
class Source : public Clocked {
 public:
  Source(Run& run, Fifo<TriangleItem*>& out) : run_(run), out_(out) {}
  void start(std::span<const Triangle> triangles, std::int64_t first_index) {
    triangles_ = triangles;
    index_ = first_index;
  }
  bool finished() const { return triangles_.empty(); }
  std::uint64_t offered() const { return offered_; }  // since begin()
  void clock(std::uint64_t now) override {
    if (triangles_.empty() || !out_.can_push(now)) return;
    TriangleItem* item = run_.triangles.get();
    item->triangle = &triangles_.front();
    item->index = index_++;
    ++offered_;
    triangles_ = triangles_.subspan(1);
    out_.push(now) = item;
  }

 private:
  Run& run_;
  Fifo<TriangleItem*>& out_;
  std::span<const Triangle> triangles_;
  std::int64_t index_ = 0;
  std::uint64_t offered_ = 0;
};

class ClockedMachine : public Machine {
 public:
  const std::vector<HandshakeClock>& handshake() const final { return handshake_; }
  void close_vcd() final {
    if (kernel_) kernel_->close_vcd();
  }

 protected:
  ClockedMachine(const Config& config, const Scene& scene, const SystemcOptions& options);

  // Ends the derived class's constructor. `behind`: the stages behind the walk, in the order of the pipeline;
  // `beside`: parts that are no stage.
  void assemble(const std::vector<TimedStage*>& behind, const std::vector<KernelPart>& beside,
                const SystemcOptions& options);
  // The stages' reports.
  void fill(TimedReport& report) const override;
  // Whether the parts that are no stage have nothing to do any more.
  virtual bool rests() const = 0;

  Fifo<TriangleItem*> to_setup_, to_walk_;
  Fifo<RowItem*> to_span_setup_;
  std::vector<HandshakeClock>* recorded_handshake_;  // null where it was not asked for

 private:
  void clock_until_drained(std::span<const Triangle> triangles, std::int64_t first_index) final;
  std::uint64_t cycles() const final { return kernel_ ? kernel_->cycles() : cycles_; }
  bool drained() const;
  // Throws where nothing has moved for too long.
  void watch();

  std::vector<HandshakeClock> handshake_;
  Source source_;
  SetupStage setup_;
  std::unique_ptr<TimedStage> walk_;
  std::vector<TimedStage*> stages_;
  std::vector<StageMeter*> meters_;
  std::vector<Clocked*> clocked_;
  std::uint64_t moves_ = 0;
  std::uint64_t cycles_ = 0;        // without the kernel
  std::unique_ptr<Kernel> kernel_;  // null: the parts are stepped without SystemC
};

}  // namespace bitspan::timed
