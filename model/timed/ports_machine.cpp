// SPDX-License-Identifier: Apache-2.0
// The timed model with the RTL's ports: clock by clock in both modes, span mode without SystemC.
#include "engine/emit_pixel_sv.hpp"
#include "model/timed/clocked_machine.hpp"
#include "model/timed/pixel_chain.hpp"

namespace bitspan::timed {
namespace {

class PortsMachine final : public ClockedMachine {
 public:
  PortsMachine(const Config& config, const Scene& scene, const SystemcOptions& options)
      : ClockedMachine(config, scene, options), chain_(run_, to_span_setup_, options, recorded_handshake_) {
    assemble({&chain_}, {}, options);
  }

 private:
  void fill(TimedReport& report) const override {
    ClockedMachine::fill(report);
    report.ports.assign(chain_.ports().begin(), chain_.ports().end());
  }
  void scene_changed(std::uint64_t /*since*/) override {
    throw InputError(
        "view: the RTL's pixel stages are loaded once per scene; expected no view line with their ports");
  }
  bool rests() const override { return true; }
  void state_changed() override {
    if (!pixel_rtl_takes(run_.config, run_.pipeline.state)) {
      throw InputError(
          "draw state: the RTL's pixel stages do not have it; expected a blend by alpha or none, or any with "
          "rtl.blend = equation");
    }
    chain_.draw_state_changed();
  }

  PixelChain chain_;
};

}  // namespace

std::unique_ptr<Machine> make_ports_machine(const Config& config, const Scene& scene,
                                            const SystemcOptions& options) {
  return std::make_unique<PortsMachine>(config, scene, options);
}

}  // namespace bitspan::timed
