// SPDX-License-Identifier: Apache-2.0
#include "model/engine_model.hpp"

#include <stdexcept>
#include <vector>

#include "model/pipeline.hpp"
#include "model/scene_run.hpp"
#include "model/simd/engine_vector.hpp"

namespace bitspan {
namespace {

using model::NoObserve;
using model::Observe;
using model::Statistics;

// What make_model and make_observed_model share: everything but the observer.
struct Run : model::SceneRun {
  Run(const Config& c, bool keep_winners) : config(c), winners(keep_winners) {}

  template <class Watch>
  void begin(const Scene& s, Watch watch) {
    pipeline = model::make_pipeline(config, s, watch);
    buffers.rows_above = 0;
    SceneRun::begin(s, winners);
  }

  template <class Watch>
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, bool again, Trace* trace,
            Watch watch) {
    need_begun("draw");
    deliver_constants(trace);
    model::draw_triangles(pipeline, *scene, triangles, first_index, again, buffers, frame, counters, trace,
                          watch);
  }

  Config config;
  bool winners;
  model::DrawBuffers buffers;
};

class Model final : public Engine, public RowEngine, public BandEngine {
 public:
  Model(const Config& config, bool winners) : run_(config, winners) {}
  std::string_view name() const override { return "model"; }
  void begin(const Scene& scene) override {
    run_.band.reset();
    run_.begin(scene, NoObserve{});
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.draw(triangles, first_index, false, trace, NoObserve{});
  }
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    run_.execute(run_.config, command, next_index, trace);
  }
  const Frame& frame() const override { return run_.frame; }
  const Counters& counters() const override { return run_.counters; }
  void begin_band(const Scene& scene, const Band& band) override {
    run_.band = band;
    run_.begin(scene, NoObserve{});
  }
  void draw_again(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.draw(triangles, first_index, true, trace, NoObserve{});
  }
  std::uint64_t rows_above() const override { return run_.buffers.rows_above; }
  PlaneOfRows set_plane(const SetupRecord& setup) override {
    plane_rows_ = model::plane_rows(run_.pipeline, setup, run_.buffers.walk);
    return {run_.buffers.walk.geometry.along_y, plane_rows_};
  }
  void draw_row(const AnyRow& row, std::size_t /*plane_row*/, int texture, Trace* trace) override {
    check_draws_rows(run_.config, row);
    run_.deliver_constants(trace);
    model::row_to_frame(run_.pipeline, *run_.scene, row,
                        run_.pipeline.const_depth_rows ? &run_.buffers.walk.geometry : nullptr,
                        {.texture = texture}, run_.frame, run_.counters, trace);
  }

 private:
  Run run_;
  std::vector<PlaneRowRecord> plane_rows_;
};

class ObservedModel final : public ObservedEngine {
 public:
  explicit ObservedModel(const Config& config) : run_(config, true) {}
  std::string_view name() const override { return "model"; }
  void begin(const Scene& scene) override {
    statistics_ = {};
    run_.statistics = &statistics_;
    run_.begin(scene, Observe{&statistics_});
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.draw(triangles, first_index, false, trace, Observe{&statistics_});
  }
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    run_.execute(run_.config, command, next_index, trace);
  }
  const Frame& frame() const override { return run_.frame; }
  const Counters& counters() const override { return run_.counters; }
  const Statistics& statistics() const override { return statistics_; }

 private:
  Run run_;
  Statistics statistics_;
};

}  // namespace

std::unique_ptr<Engine> make_model(const Config& config, const ModelOptions& options) {
  if (options.threads < 1) {
    throw InputError("the model needs one thread at least");
  }
  const char* refusal = model::vector_refusal(config);
  const bool in_lanes = options.form != ModelForm::scalar && refusal == nullptr;
  if (!in_lanes && options.form != ModelForm::scalar && options.form != ModelForm::automatic) {
    throw InputError("configuration '" + config.name + "' has no vector form: " + refusal);
  }
  if (in_lanes) {
    return model::make_vector_model(config, options);
  }
  return std::make_unique<Model>(config, options.winners);
}

std::unique_ptr<ObservedEngine> make_observed_model(const Config& config, ModelForm form) {
  if (form != ModelForm::scalar && model::vector_refusal(config) == nullptr) {
    return model::make_observed_vector_model(config, VectorTarget::best);
  }
  return std::make_unique<ObservedModel>(config);
}

}  // namespace bitspan
