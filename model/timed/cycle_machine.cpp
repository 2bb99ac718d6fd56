// SPDX-License-Identifier: Apache-2.0
// The timed model in cycle mode with cache and memory bus: every part clock by clock under the SystemC
// kernel.
#include "model/timed/clocked_machine.hpp"
#include "model/timed/depth.hpp"
#include "model/timed/fog.hpp"
#include "model/timed/merge.hpp"
#include "model/timed/span_interpolator.hpp"
#include "model/timed/texture.hpp"

namespace bitspan::timed {
namespace {

class CycleMachine final : public ClockedMachine {
 public:
  CycleMachine(const Config& config, const Scene& scene, const SystemcOptions& options)
      : ClockedMachine(config, scene, options),
        memory_(config.memory),
        to_depth_(run_.timing(Stage::depth).fifo),
        to_texture_(run_.timing(Stage::texture).fifo),
        to_fog_(run_.timing(Stage::fog).fifo),
        to_merge_(run_.timing(Stage::merge).fifo),
        interpolator_(run_, to_span_setup_, &to_depth_, recorded_handshake_),
        depth_(run_, memory_, to_depth_, to_texture_),
        texture_(run_, memory_, to_texture_, to_fog_),
        fog_(run_, to_fog_, to_merge_),
        merge_(run_, memory_, to_merge_) {
    run_.pixel_free.resize(run_.frame.depth.size());
    assemble({&interpolator_, &depth_, &texture_, &fog_, &merge_}, {{"memory", &memory_, {}}}, options);
  }

 private:
  void fill(TimedReport& report) const override {
    ClockedMachine::fill(report);
    report.cache_hits = texture_.cache().hits();
    report.cache_misses = texture_.cache().misses();
    add_reports(texture_.cache(), depth_.traffic(), merge_.traffic(), report);
    report.memory = memory_.report();
  }
  void cleared(const Clear& clear) override {
    depth_.traffic().cleared(clear);
    merge_.traffic().cleared(clear);
  }
  void target_changed() override {
    depth_.traffic().target_changed();
    merge_.traffic().target_changed();
  }
  void scene_changed(std::uint64_t since) override {
    texture_.traffic().scene_changed(run_, since);
    run_.pixel_free.resize(std::max(run_.pixel_free.size(), run_.frame.depth.size()));
  }
  bool rests() const override { return memory_.idle(); }
  // The FIFO in front of a stage stays there, whichever stage is in front of it.
  void state_changed() override {
    const bool late = run_.tests_late();
    interpolator_.set_out(late ? to_texture_ : to_depth_);
    depth_.set_out(late ? to_fog_ : to_texture_);
    texture_.set_out(late ? to_depth_ : to_fog_);
  }

  Memory memory_;
  Fifo<FragmentItem*> to_depth_, to_texture_, to_fog_, to_merge_;
  SpanInterpolator interpolator_;
  DepthStage depth_;
  TextureStage texture_;
  FogStage fog_;
  MergeStage merge_;
};

}  // namespace

std::unique_ptr<Machine> make_cycle_machine(const Config& config, const Scene& scene,
                                            const SystemcOptions& options) {
  return std::make_unique<CycleMachine>(config, scene, options);
}

}  // namespace bitspan::timed
