#include "model/timed/engine_systemc.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string>

#include "model/timed/depth.hpp"
#include "model/timed/edge_walk.hpp"
#include "model/timed/fog.hpp"
#include "model/timed/kernel.hpp"
#include "model/timed/merge.hpp"
#include "model/timed/plane_walk.hpp"
#include "model/timed/setup.hpp"
#include "model/timed/span_interpolator.hpp"
#include "model/timed/texture.hpp"

namespace bitspan {
namespace timed {
namespace {

// Offers a draw call's triangles, one a clock while setup's FIFO has room.
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
    return std::make_unique<WalkStage<PlaneWalk>>("plane_walk", timing, in, out, run.triangles, run.rows,
                                                  PlaneWalk(run));
  }
  return std::make_unique<WalkStage<EdgeWalk>>("edge_walk", timing, in, out, run.triangles, run.rows,
                                               EdgeWalk(run));
}

std::string_view to_string(StageState state) {
  constexpr std::array<std::string_view, stage_states> names{"starved", "busy", "blocked", "memory"};
  return names[static_cast<std::size_t>(state)];
}

// All that exists from one begin() to the next.
class Machine {
 public:
  Machine(const Config& config, const Scene& scene, const SystemcOptions& options)
      : run_(config, scene),
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
        stages_{&setup_, walk_.get(), &interpolator_, &depth_, &texture_, &fog_, &merge_},
        progress_(options.progress),
        watchdog_clocks_(options.watchdog_clocks != 0 ? options.watchdog_clocks : longest_rest()) {
    for (TimedStage* stage : stages_) {
      for (StageMeter* meter : stage->meters()) meters_.push_back(meter);
    }
    kernel_ = std::make_unique<Kernel>(parts(), options.vcd);
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) {
    if (trace != nullptr && run_.counters.triangles == 0) {
      trace->constants.push_back(run_.pipeline.constants.record);
    }
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) model::check_triangle(run_.scene, triangle, index++);
    if (triangles.empty()) return;
    if (failed_) throw std::logic_error("Engine::draw after a failed run");

    source_.start(triangles, first_index);
    run_.trace = trace;
    last_move_ = kernel_->cycles();
    failed_ = true;
    kernel_->run([this] {
      watch();
      if (progress_ && kernel_->cycles() % progress_clocks == 0) progress_(source_.offered());
      return drained();
    });
    failed_ = false;
    run_.trace = nullptr;
    run_.counters.cycles = kernel_->cycles();
  }

  TimedReport report() {
    TimedReport report;
    report.cycles = kernel_->cycles();
    for (const StageMeter* meter : meters_) report.stages.push_back(meter->report);
    report.cache_hits = texture_.cache().hits();
    report.cache_misses = texture_.cache().misses();
    report.memory = memory_.report();
    const InterpolatorLatency latency = interpolator_latency(run_.config);
    report.interpolator_exact = latency.exact;
    report.span_setup_latency = latency.span_setup;
    report.span_latency = latency.span;
    return report;
  }
  const Run& run() const { return run_; }
  const std::vector<HandshakeClock>& handshake() const { return handshake_; }
  void close_vcd() { kernel_->close_vcd(); }

 private:
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

  // More clocks than a legal configuration can go without a movement.
  std::uint64_t longest_rest() const {
    const auto wide = [](int n) { return static_cast<std::uint64_t>(n); };
    const InterpolatorLatency interpolator = interpolator_latency(run_.config);
    std::uint64_t clocks =
        wide(interpolator.span_setup) + wide(interpolator.span) + wide(interpolator.pixel_interval);
    for (const StageTiming& timing : run_.config.timing)
      clocks += wide(timing.latency) + wide(timing.interval);
    const MemoryTiming& memory = run_.config.memory;
    // Each port's requests may have to wait for those of the others.
    const std::uint64_t largest =
        std::max({wide(memory.cache_line_bytes), wide(memory.width_bytes), color_bytes});
    clocks += 8 * (wide(memory.latency) + largest / wide(memory.width_bytes) + 1);
    return 64 + 4 * clocks;
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
    std::string text = "timed model: nothing moved for " + std::to_string(watchdog_clocks_) +
                       " clocks, at clock " + std::to_string(cycles) + ":";
    for (const StageMeter* meter : meters_) {
      const StageSignals& s = meter->signals;
      text += " " + meter->report.name + " " + std::string(to_string(static_cast<StageState>(s.state))) +
              " (in " + (s.in_valid ? "valid" : "-") + (s.in_ready ? " ready" : " -") + ", out " +
              (s.out_valid ? "valid" : "-") + (s.out_ready ? " ready" : " -") + ", FIFO " +
              std::to_string(s.occupancy) + "/" + std::to_string(meter->report.fifo_capacity) + ");";
    }
    text.back() = '.';
    throw std::runtime_error(text);
  }

  Run run_;
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
  std::function<void(std::uint64_t)> progress_;
  static constexpr std::uint64_t progress_clocks = 65536;
  std::uint64_t watchdog_clocks_;
  std::uint64_t moves_ = 0;
  std::uint64_t last_move_ = 0;
  bool failed_ = false;
  std::unique_ptr<Kernel> kernel_;
};

class Systemc final : public TimedEngine {
 public:
  Systemc(const Config& config, const SystemcOptions& options) : config_(config), options_(options) {
    interpolator_latency(config_);  // throws where there is none
  }
  std::string_view name() const override { return "systemc"; }
  void begin(const Scene& scene) override {
    machine_.reset();  // completes the last run's waveform before the next one's begins
    machine_ = std::make_unique<Machine>(config_, scene, options_);
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    machine().draw(triangles, first_index, trace);
  }
  const Frame& frame() const override { return machine().run().frame; }
  const Counters& counters() const override { return machine().run().counters; }
  TimedReport report() const override { return machine().report(); }
  const std::vector<HandshakeClock>& handshake() const override { return machine().handshake(); }
  void close_vcd() override {
    if (machine_) machine_->close_vcd();
  }

 private:
  Machine& machine() const {
    if (!machine_) throw std::logic_error("systemc engine: begin() has not been called");
    return *machine_;
  }
  Config config_;
  SystemcOptions options_;
  std::unique_ptr<Machine> machine_;
};

}  // namespace
}  // namespace timed

std::unique_ptr<TimedEngine> make_systemc(const Config& config, const SystemcOptions& options) {
  return std::make_unique<timed::Systemc>(config, options);
}

}  // namespace bitspan
