// SPDX-License-Identifier: Apache-2.0
#include "model/timed/engine_systemc.hpp"

#include "model/timed/engine_timed.hpp"

namespace bitspan {
namespace timed {
namespace {

std::unique_ptr<Machine> make_machine(const Config& config, const Scene& scene,
                                      const SystemcOptions& options) {
  if (options.memory == TimedMemory::ports) return make_ports_machine(config, scene, options);
  return options.mode == TimedMode::span ? make_span_machine(config, scene, options)
                                         : make_cycle_machine(config, scene, options);
}

}  // namespace
}  // namespace timed

std::unique_ptr<TimedEngine> make_systemc(const Config& config, const SystemcOptions& options) {
  auto engine = timed::make_timed_engine("systemc", config, options, timed::make_machine);
  if (options.memory == TimedMemory::ports) check_ports(options.ports);
  const bool clocked = !options.vcd.empty() || options.record_handshake;
  if (options.mode == TimedMode::span && clocked) {
    throw InputError("timed model: mode span has no waveform and no handshake log; these need mode cycle");
  }
  return engine;
}

}  // namespace bitspan
