// SPDX-License-Identifier: Apache-2.0
#include "model/timed/engine_systemc.hpp"

#include <span>
#include <stdexcept>

#include "model/timed/machine.hpp"
#include "model/timed/span_interpolator_timing.hpp"

namespace bitspan {
namespace timed {
namespace {

class Systemc final : public TimedEngine {
 public:
  Systemc(const Config& config, const SystemcOptions& options) : config_(config), options_(options) {
    interpolator_latency(config_);  // throws where there is none
    if (options_.memory == TimedMemory::ports) check_ports(options_.ports);
    const bool clocked = !options_.vcd.empty() || options_.record_handshake;
    if (options_.mode == TimedMode::span && clocked) {
      throw InputError("timed model: mode span has no waveform and no handshake log; these need mode cycle");
    }
  }
  std::string_view name() const override { return "systemc"; }
  void begin(const Scene& scene) override {
    machine_.reset();  // completes the last run's waveform before the next one's begins
    if (options_.memory == TimedMemory::ports) {
      machine_ = make_ports_machine(config_, scene, options_);
      return;
    }
    machine_ = options_.mode == TimedMode::span ? make_span_machine(config_, scene, options_)
                                                : make_cycle_machine(config_, scene, options_);
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
