// SPDX-License-Identifier: Apache-2.0
#include "model/timed/engine_timed.hpp"

#include <span>
#include <stdexcept>
#include <utility>

#include "model/timed/span_interpolator_timing.hpp"

namespace bitspan::timed {
namespace {

class MachineEngine final : public TimedEngine {
 public:
  MachineEngine(std::string_view name, const Config& config, SystemcOptions options, MakeMachine make)
      : name_(name), config_(config), options_(std::move(options)), make_(make) {
    interpolator_latency(config_);  // throws where there is none
  }
  std::string_view name() const override { return name_; }
  void begin(const Scene& scene) override {
    machine_.reset();  // completes the last run's waveform before the next one's begins
    machine_ = make_(config_, scene, options_);
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    machine().draw(triangles, first_index, trace);
  }
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    machine().execute(command, next_index, trace);
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
    if (!machine_) throw std::logic_error(std::string(name_) + " engine: begin() has not been called");
    return *machine_;
  }
  std::string_view name_;
  Config config_;
  SystemcOptions options_;
  MakeMachine make_;
  std::unique_ptr<Machine> machine_;
};

}  // namespace

std::unique_ptr<TimedEngine> make_timed_engine(std::string_view name, const Config& config,
                                               const SystemcOptions& options, MakeMachine make) {
  return std::make_unique<MachineEngine>(name, config, options, make);
}

}  // namespace bitspan::timed
