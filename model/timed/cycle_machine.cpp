// SPDX-License-Identifier: Apache-2.0
// The timed model in cycle mode: every part clock by clock under the SystemC kernel.
#include <algorithm>
#include <span>
#include <string>

#include "model/timed/depth.hpp"
#include "model/timed/edge_walk.hpp"
#include "model/timed/fog.hpp"
#include "model/timed/kernel.hpp"
#include "model/timed/machine.hpp"
#include "model/timed/merge.hpp"
#include "model/timed/plane_walk.hpp"
#include "model/timed/setup.hpp"
#include "model/timed/span_interpolator.hpp"
#include "model/timed/texture.hpp"

namespace bitspan::timed {
namespace {

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

std::unique_ptr<TimedStage> make_walk(Run& run, Fifo<TriangleItem*>& in, Fifo<RowItem*>& out) {
  const StageTiming& timing = run.timing(Stage::edge_walk);
  if (run.pipeline.const_depth_rows) {
    return std::make_unique<WalkStage<PlaneWalk>>(run.walk_name(), timing, in, out, run.triangles, run.rows,
                                                  PlaneWalk(run));
  }
  return std::make_unique<WalkStage<EdgeWalk>>(run.walk_name(), timing, in, out, run.triangles, run.rows,
                                               EdgeWalk(run));
}

class CycleMachine final : public Machine {
 public:
  CycleMachine(const Config& config, const Scene& scene, const SystemcOptions& options)
      : Machine(config, scene, options),
        memory_(config.memory),
        to_setup_(run_.timing(Stage::setup).fifo),
        to_walk_(run_.timing(Stage::edge_walk).fifo),
        to_span_setup_(run_.timing(Stage::span_setup).fifo),
        to_depth_(run_.timing(Stage::depth).fifo),
        to_texture_(run_.timing(Stage::texture).fifo),
        to_fog_(run_.timing(Stage::fog).fifo),
        to_merge_(run_.timing(Stage::merge).fifo),
        source_(run_, to_setup_),
        setup_(run_, to_setup_, to_walk_),
        walk_(make_walk(run_, to_walk_, to_span_setup_)),
        interpolator_(run_, to_span_setup_, to_depth_, options.record_handshake ? &handshake_ : nullptr),
        depth_(run_, memory_, to_depth_, to_texture_),
        texture_(run_, memory_, to_texture_, to_fog_),
        fog_(run_, to_fog_, to_merge_),
        merge_(run_, memory_, to_merge_),
        stages_{&setup_, walk_.get(), &interpolator_, &depth_, &texture_, &fog_, &merge_} {
    for (TimedStage* stage : stages_) {
      for (StageMeter* meter : stage->meters()) meters_.push_back(meter);
    }
    run_.pixel_free.resize(run_.frame.depth.size());
    kernel_ = std::make_unique<Kernel>(parts(), options.vcd);
  }

  const std::vector<HandshakeClock>& handshake() const override { return handshake_; }
  void close_vcd() override { kernel_->close_vcd(); }

 private:
  void clock_until_drained(std::span<const Triangle> triangles, std::int64_t first_index) override {
    source_.start(triangles, first_index);
    kernel_->run([this] {
      watch();
      if (progress_ && kernel_->cycles() % progress_clocks == 0) progress_(source_.offered());
      return drained();
    });
  }
  std::uint64_t cycles() const override { return kernel_->cycles(); }
  void fill(TimedReport& report) const override {
    for (const StageMeter* meter : meters_) report.stages.push_back(meter->report);
    report.cache_hits = texture_.cache().hits();
    report.cache_misses = texture_.cache().misses();
    report.memory = memory_.report();
  }

  std::vector<KernelPart> parts() {
    std::vector<KernelPart> parts{{"source", &source_, {}}, {"memory", &memory_, {}}};
    for (TimedStage* stage : stages_) {
      const std::vector<StageMeter*> meters = stage->meters();
      if (meters.size() == 1) {
        parts.push_back({meters[0]->report.name, stage, {{"", &meters[0]->signals}}});
        continue;
      }
      KernelPart part{"span_interpolator", stage, {}};
      for (const StageMeter* meter : meters) part.signals.emplace_back(meter->report.name, &meter->signals);
      parts.push_back(std::move(part));
    }
    return parts;
  }

  bool drained() const {
    return source_.finished() && run_.triangles.in_use() == 0 && run_.fragments.in_use() == 0 &&
           to_span_setup_.empty() && memory_.idle() &&
           std::ranges::all_of(stages_, [](const TimedStage* stage) { return stage->idle(); });
  }

  // Throws where nothing has moved for too long.
  void watch() {
    std::uint64_t moves = 0;
    for (const StageMeter* meter : meters_) moves += meter->moves;
    const std::uint64_t cycles = kernel_->cycles();
    if (moves != moves_) {
      moves_ = moves;
      last_move_ = cycles;
    }
    if (cycles - last_move_ < watchdog_clocks_) return;
    std::string states;
    for (const StageMeter* meter : meters_) {
      const StageSignals& s = meter->signals;
      const std::string detail = std::string("in ") + (s.in_valid ? "valid" : "-") +
                                 (s.in_ready ? " ready" : " -") + ", out " + (s.out_valid ? "valid" : "-") +
                                 (s.out_ready ? " ready" : " -") + ", ";
      states += state_text(meter->report.name, static_cast<StageState>(s.state), s.occupancy,
                           meter->report.fifo_capacity, detail);
    }
    nothing_moved(cycles, std::move(states));
  }

  Memory memory_;
  Fifo<TriangleItem*> to_setup_, to_walk_;
  Fifo<RowItem*> to_span_setup_;
  Fifo<FragmentItem*> to_depth_, to_texture_, to_fog_, to_merge_;
  Source source_;
  SetupStage setup_;
  std::unique_ptr<TimedStage> walk_;
  std::vector<HandshakeClock> handshake_;
  SpanInterpolator interpolator_;
  DepthStage depth_;
  TextureStage texture_;
  FogStage fog_;
  MergeStage merge_;
  std::vector<TimedStage*> stages_;
  std::vector<StageMeter*> meters_;
  std::uint64_t moves_ = 0;
  std::unique_ptr<Kernel> kernel_;
};

}  // namespace

std::unique_ptr<Machine> make_cycle_machine(const Config& config, const Scene& scene,
                                            const SystemcOptions& options) {
  return std::make_unique<CycleMachine>(config, scene, options);
}

}  // namespace bitspan::timed
