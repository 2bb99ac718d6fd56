// SPDX-License-Identifier: Apache-2.0
#include "tb/engine_dut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/rtl_timing.hpp"
#include "model/pipeline.hpp"
#include "model/scene_run.hpp"
#include "tb/dut_store.hpp"
#include "tb/dut_wrapper.hpp"
#include "tb/row_batch.hpp"

namespace bitspan {
namespace {

// Far longer than any latency.
constexpr int patience_clocks = 10000;
// After a run, for what no record asked for; after a reset, for what a design does on its own then.
constexpr int quiet_clocks = 1000;
constexpr double in_gap = 0.1;     // probability per clock
constexpr double out_stall = 0.1;  // probability per clock

// What the wrapper says of a configuration. Found once per run of the program: another text of a source is
// then another design.
class Wrappers {
 public:
  explicit Wrappers(DutDesign design) : design_(std::move(design)) {}
  const DutDesign& design() const { return design_; }

  const DutWrapper& of(const Config& config) {
    const std::lock_guard lock(mutex_);
    const auto [at, fresh] = known_.try_emplace(config_hash(config));
    if (fresh) {
      try {
        at->second = wrap_dut(design_, config);
      } catch (...) {
        known_.erase(at);
        throw;
      }
      const std::string hash = dut_hash(design_, at->second.files);
      if (sources_.empty()) sources_ = hash;
      check(hash);
    }
    return at->second;
  }
  // Throws InputError where a source has changed since the program first read it: a replay would name another
  // design than the one that failed.
  void check_unchanged(const DutWrapper& wrapper) {
    const std::lock_guard lock(mutex_);
    check(dut_hash(design_, wrapper.files));
  }

 private:
  void check(const std::string& hash) const {
    if (hash != sources_) {
      throw InputError(
          fmt::format("dut:{}: a source has changed during the run; run it again", design_.name));
    }
  }

  DutDesign design_;
  std::mutex mutex_;
  std::map<std::string, DutWrapper> known_;
  std::string sources_;
};

class DutEngine final : public Engine {
 public:
  DutEngine(const Config& config, std::uint64_t stall_seed, Wrappers& wrappers)
      : config_(config),
        stall_seed_(stall_seed),
        name_(std::string(dut_prefix) + wrappers.design().name),
        map_(wrappers.design().map),
        wrapper_(wrappers.of(config)),
        module_(module_of(wrappers.design(), wrapper_, config.name)) {
    wrappers.check_unchanged(wrapper_);
    inputs_.resize(2 + wrapper_.inputs.size());
    outputs_.resize(2 + wrapper_.outputs.size());
  }

  std::string_view name() const override { return name_; }

  void begin(const Scene& scene) override {
    guarded([&] { start(scene); });
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.need_begun("draw");
    guarded([&] { draw_all(triangles, first_index, trace); });
  }

  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    run_.execute(config_, command, next_index, trace);
  }

  const Frame& frame() const override { return run_.frame; }
  const Counters& counters() const override { return run_.counters; }

 private:
  // What the design does wrong is no fault of the program's.
  template <class Work>
  void guarded(Work work) const {
    try {
      work();
    } catch (const std::logic_error& error) {
      throw DesignFault(name_, error.what());
    }
  }

  void start(const Scene& scene) {
    run_.pipeline = model::make_pipeline(config_, scene);
    run_.begin(scene, true);
    runs_ = 0;
    module_.reset();
    std::ranges::fill(inputs_, 0);
    for (int clock = 0; clock < quiet_clocks; ++clock) module_.clock(inputs_, outputs_);
  }

  void draw_all(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) {
    const auto line = std::ranges::find(triangles, true, &Triangle::is_line);
    if (line != triangles.end()) {
      throw InputError(
          fmt::format("triangle {} is a line, and a design under test has none; legal: triangles",
                      first_index + (line - triangles.begin())));
    }
    run_.deliver_constants(trace);
    draw_in_batches(run_.pipeline, *run_.scene, triangles, first_index, batch_, run_.counters, trace,
                    [&] { run(trace); });
  }

  bool delivers_pixels() const { return map_.output.stage == RecordType::fragment; }

  // All rows collected through the design, and what comes out to the frame.
  void run(Trace* trace) {
    if (batch_.rows.size() == 0) return;
    spans_.clear();
    fragments_.clear();
    channels_.clear();
    std::vector<std::size_t> ends;
    for (std::size_t i = 0; i < batch_.rows.size(); ++i) {
      spans_.push_back(model::row_to_span(run_.pipeline, batch_.rows, i, run_.counters));
      row_fragments_.clear();
      model::span_to_fragments(run_.pipeline, spans_.back(), model::geometry_of(batch_.rows, i),
                               row_fragments_, run_.counters);
      fragments_.insert(fragments_.end(), row_fragments_.begin(), row_fragments_.end());
      if (run_.pipeline.channels.any()) {
        model::channels_of_row(run_.pipeline, batch_.rows, i, spans_.back(), row_fragments_, row_channels_,
                               run_.counters, trace);
        channels_.insert(channels_.end(), row_channels_.begin(), row_channels_.end());
      }
      ends.push_back(fragments_.size());
    }
    const std::size_t expected = delivers_pixels() ? fragments_.size() : spans_.size();
    transfer(expected);
    const std::size_t lanes = wrapper_.outputs.size();
    const std::size_t delivered = lanes == 0 ? 0 : delivered_.size() / lanes;
    if (delivered != expected && trace == nullptr) {
      throw std::logic_error(fmt::format("delivers {} records, expected {}", delivered, expected));
    }
    std::size_t from = 0;
    for (std::size_t i = 0; i < batch_.rows.size(); ++i) {
      if (delivers_pixels()) {
        deliver(trace, spans_[i]);
      } else {
        deliver(trace, replaced(spans_[i], i, false));
      }
      row_fragments_.clear();
      row_channels_.clear();
      for (std::size_t p = from; p < ends[i]; ++p) {
        FragmentRecord f = fragments_[p];
        deliver(trace, delivers_pixels() ? replaced(f, p, false) : f);
        if (delivers_pixels()) f = replaced(f, p, true);
        // A wrong position is a difference of the record, not a write outside the frame.
        if (f.x < 0 || f.x >= run_.frame.width || f.y < 0 || f.y >= run_.frame.height) continue;
        row_fragments_.push_back(f);
        if (!channels_.empty()) row_channels_.push_back(channels_[p]);
      }
      from = ends[i];
      model::fragments_to_frame(run_.pipeline, *run_.scene, row_fragments_, batch_.surfaces[i],
                                model::gradient_of(batch_.rows, spans_[i].triangle), run_.frame,
                                run_.counters, trace, model::NoObserve{}, row_channels_);
    }
    // Records that no row asked for; no other engine has them.
    for (std::size_t i = expected; i < delivered; ++i) {
      if (delivers_pixels()) {
        deliver(trace,
                replaced(FragmentRecord{.triangle = spans_.back().triangle, .y = spans_.back().y}, i, false));
      } else {
        deliver(trace,
                replaced(SpanRecord{.triangle = spans_.back().triangle, .y = spans_.back().y}, i, false));
      }
    }
    batch_.clear();
  }

  // The record with what the design delivered in it. in_format: without the bits of a port beyond the field's
  // register, which the stages behind do not expect.
  template <class R>
  R replaced(R record, std::size_t i, bool in_format) const {
    auto* values = reinterpret_cast<std::int64_t*>(&record);
    for (std::size_t lane = 0; lane < wrapper_.outputs.size(); ++lane) {
      const PortWord& word = wrapper_.outputs[lane].word;
      std::int64_t value = delivered_[i * wrapper_.outputs.size() + lane];
      if (in_format && word.bits < 64) {
        const int shift = 64 - word.bits;
        const auto high = static_cast<std::uint64_t>(value) << shift;
        value = word.is_signed ? static_cast<std::int64_t>(high) >> shift
                               : static_cast<std::int64_t>(high >> shift);
      }
      values[static_cast<std::size_t>(wrapper_.outputs[lane].field.index)] = value;
    }
    return record;
  }

  std::int64_t input_value(const DutField& field, std::size_t row) const {
    const auto at = static_cast<std::size_t>(field.index);
    switch (field.type) {
      case RecordType::row: {
        const RowRecord& r = batch_.rows.rows[row];
        return field.index < 0 ? r.x_last - r.x_first + 1 : raw_values(r)[at];
      }
      case RecordType::plane_row:
        return raw_values(batch_.rows.plane_rows[row])[at];
      case RecordType::span:
        return raw_values(spans_[row])[at];
      case RecordType::constants:
        return raw_values(run_.pipeline.constants.record)[at];
      default: {
        const model::PlaneGeometry* geometry = model::geometry_of(batch_.rows, row);
        return field.name.ends_with(".k") ? geometry->k : std::int64_t{geometry->along_y};
      }
    }
  }

  void set_inputs(std::size_t row) {
    for (std::size_t i = 0; i < wrapper_.inputs.size(); ++i) {
      const DutLane& lane = wrapper_.inputs[i];
      const std::int64_t value = input_value(lane.field, row);
      if (lane.bits < lane.word.bits && (value < 0 || value >> lane.bits != 0)) {
        throw std::logic_error(fmt::format("{} = {} does not fit the {} bits of port {}", lane.field.name,
                                           value, lane.bits, lane.port));
      }
      inputs_[2 + i] = static_cast<std::uint64_t>(value);
    }
  }

  // One clock; returns whether the record offered was accepted. Appends what was delivered.
  bool clock(bool offered, bool ready) {
    inputs_[0] = offered ? 1 : 0;
    inputs_[1] = ready ? 1 : 0;
    module_.clock(inputs_, outputs_);
    if (outputs_[1] != 0 && ready) {
      for (std::size_t i = 2; i < outputs_.size(); ++i)
        delivered_.push_back(static_cast<std::int64_t>(outputs_[i]));
    }
    return offered && outputs_[0] != 0;
  }

  // Feeds the rows with random gaps and stalls until all are accepted and all that they ask for is there.
  void transfer(std::size_t expected) {
    delivered_.clear();
    std::mt19937_64 random(stall_seed_ + runs_++);
    const auto happens = [&](double probability) {
      return static_cast<double>(random() >> 11) * 0x1p-53 < probability;
    };
    const std::size_t values = expected * wrapper_.outputs.size();
    const bool stalls = !map_.output.ready.empty();
    std::size_t next = 0;
    bool offered = false;  // once offered, a record stays
    int idle = 0;
    while (next < batch_.rows.size() || delivered_.size() < values) {
      if (!offered && next < batch_.rows.size() && !happens(in_gap)) {
        offered = true;
        set_inputs(next);
      }
      const std::size_t before = delivered_.size();
      const bool accepted = clock(offered, !(stalls && happens(out_stall)));
      ++run_.counters.cycles;
      if (accepted) {
        ++next;
        offered = false;
      }
      idle = accepted || delivered_.size() != before ? 0 : idle + 1;
      if (idle == patience_clocks) {
        throw std::logic_error(fmt::format(
            "stands still: {} of {} records accepted, {} of {} delivered, then nothing for {} clocks", next,
            batch_.rows.size(), delivered_.size() / wrapper_.outputs.size(), expected, patience_clocks));
      }
    }
    for (int i = 0; i < quiet_clocks; ++i) clock(false, true);
  }

  Config config_;
  std::uint64_t stall_seed_;
  std::string name_;
  const DutMap& map_;
  const DutWrapper& wrapper_;
  RtlModule module_;
  model::SceneRun run_;
  std::uint64_t runs_ = 0;                       // since begin: each has its own stalls
  std::vector<std::uint64_t> inputs_, outputs_;  // of the module
  std::vector<std::int64_t> delivered_;          // a value per output lane and record
  // Reused from run to run.
  RowBatch batch_;
  std::vector<SpanRecord> spans_;
  std::vector<FragmentRecord> fragments_, row_fragments_;
  std::vector<model::FragmentChannels> channels_, row_channels_;  // of these, where channels are in use
};

}  // namespace

EngineEntry dut_entry(std::string_view name) {
  StoredDut stored = load_dut(std::string(name.substr(dut_prefix.size())));
  const std::shared_ptr<const Config> only =
      stored.config ? std::make_shared<const Config>(*stored.config) : nullptr;
  const auto wrappers = std::make_shared<Wrappers>(std::move(stored.design));
  const DutMap& map = wrappers->design().map;
  EngineEntry entry;
  entry.name = name;
  entry.compared = true;
  entry.runs = [only, wrappers](const Config& c) {
    if (only != nullptr) return config_hash(*only) == config_hash(c);
    return has_rtl(c) && refusal(wrappers->design().map, c).empty();
  };
  entry.needs = fmt::format("a configuration with RTL and with records of {}", stage_of(map.input.stage));
  entry.make = [wrappers](const Config& c, const EngineOptions& o) -> std::unique_ptr<Engine> {
    return std::make_unique<DutEngine>(c, o.stall_seed, *wrappers);
  };
  entry.own = [wrappers](const Config&, const Scene&) {
    EngineOwn own;
    const DutSide& out = wrappers->design().map.output;
    for (const DutPort& port : out.ports)
      own.fields[static_cast<std::size_t>(out.stage)] += port.fields.size();
    return own;
  };
  entry.design = [wrappers](const Config& c) { return wrappers->of(c).hash; };
  entry.users_design = true;
  entry.only = only;
  return entry;
}

}  // namespace bitspan
