// SPDX-License-Identifier: Apache-2.0
#include "model/timed/clocked_machine.hpp"

#include <algorithm>
#include <string>

#include "model/timed/edge_walk.hpp"
#include "model/timed/plane_walk.hpp"
#include "model/timed/walk.hpp"

namespace bitspan::timed {
namespace {

std::unique_ptr<TimedStage> make_walk(Run& run, Fifo<TriangleItem*>& in, Fifo<RowItem*>& out) {
  const StageTiming& timing = run.timing(Stage::edge_walk);
  if (run.pipeline.const_depth_rows) {
    return std::make_unique<WalkStage<PlaneWalk>>(run.walk_name(), timing, in, out, run.triangles, run.rows,
                                                  PlaneWalk(run));
  }
  return std::make_unique<WalkStage<EdgeWalk>>(run.walk_name(), timing, in, out, run.triangles, run.rows,
                                               EdgeWalk(run));
}

}  // namespace

ClockedMachine::ClockedMachine(const Config& config, const Scene& scene, const SystemcOptions& options)
    : Machine(config, scene, options),
      to_setup_(run_.timing(Stage::setup).fifo),
      to_walk_(run_.timing(Stage::edge_walk).fifo),
      to_span_setup_(run_.timing(Stage::span_setup).fifo),
      recorded_handshake_(options.record_handshake ? &handshake_ : nullptr),
      source_(run_, to_setup_),
      setup_(run_, to_setup_, to_walk_),
      walk_(make_walk(run_, to_walk_, to_span_setup_)) {}

void ClockedMachine::assemble(const std::vector<TimedStage*>& behind, const std::vector<KernelPart>& beside,
                              const SystemcOptions& options) {
  stages_ = {&setup_, walk_.get()};
  stages_.insert(stages_.end(), behind.begin(), behind.end());
  std::vector<KernelPart> parts{{"source", &source_, {}}};
  parts.insert(parts.end(), beside.begin(), beside.end());
  for (TimedStage* stage : stages_) {
    const std::vector<StageMeter*> meters = stage->meters();
    meters_.insert(meters_.end(), meters.begin(), meters.end());
    if (stage->module().empty()) {
      parts.push_back({meters[0]->report.name, stage, {{"", &meters[0]->signals}}});
      continue;
    }
    KernelPart part{std::string(stage->module()), stage, {}};
    for (const StageMeter* meter : meters) part.signals.emplace_back(meter->report.name, &meter->signals);
    parts.push_back(std::move(part));
  }
  for (const KernelPart& part : parts) clocked_.push_back(part.clocked);
  if (options.mode == TimedMode::cycle) kernel_ = std::make_unique<Kernel>(parts, options.vcd);
}

void ClockedMachine::clock_until_drained(std::span<const Triangle> triangles, std::int64_t first_index) {
  source_.start(triangles, first_index);
  const auto done = [this] {
    watch();
    if (progress_ && cycles() % progress_clocks == 0) progress_(source_.offered());
    return drained();
  };
  if (kernel_) {
    kernel_->run(done);
    return;
  }
  do {
    for (Clocked* part : clocked_) part->clock(cycles_);
    ++cycles_;
  } while (!done());
}

void ClockedMachine::fill(TimedReport& report) const {
  for (const StageMeter* meter : meters_) report.stages.push_back(meter->report);
}

bool ClockedMachine::drained() const {
  return source_.finished() && run_.triangles.in_use() == 0 && run_.fragments.in_use() == 0 &&
         to_span_setup_.empty() && rests() &&
         std::ranges::all_of(stages_, [](const TimedStage* stage) { return stage->idle(); });
}

void ClockedMachine::watch() {
  std::uint64_t moves = 0;
  for (const StageMeter* meter : meters_) moves += meter->moves;
  const std::uint64_t now = cycles();
  if (moves != moves_) {
    moves_ = moves;
    last_move_ = now;
  }
  if (now - last_move_ < watchdog_clocks_) return;
  std::string states;
  for (const StageMeter* meter : meters_) {
    const StageSignals& s = meter->signals;
    const std::string detail = std::string("in ") + (s.in_valid ? "valid" : "-") +
                               (s.in_ready ? " ready" : " -") + ", out " + (s.out_valid ? "valid" : "-") +
                               (s.out_ready ? " ready" : " -") + ", ";
    states += state_text(meter->report.name, static_cast<StageState>(s.state), s.occupancy,
                         meter->report.fifo_capacity, detail);
  }
  nothing_moved(now, std::move(states));
}

}  // namespace bitspan::timed
