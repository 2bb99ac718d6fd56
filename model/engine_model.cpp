// SPDX-License-Identifier: Apache-2.0
#include "model/engine_model.hpp"

#include <stdexcept>
#include <vector>

#include "model/pipeline.hpp"
#include "model/simd/engine_vector.hpp"

namespace bitspan {
namespace {

using model::NoObserve;
using model::Observe;
using model::Statistics;

// What make_model and make_observed_model share: everything but the observer.
struct Run {
  Run(const Config& c, bool keep_winners) : config(c), winners(keep_winners) {}

  template <class Watch>
  void begin(const Scene& s, Watch watch) {
    pipeline = model::make_pipeline(config, s, watch);
    scene = &s;
    counters = {};
    constants_delivered = false;
    model::clear_frame(pipeline, s, winners, frame);
  }

  template <class Watch>
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace, Watch watch) {
    if (scene == nullptr) {
      throw std::logic_error("Engine::draw before begin");
    }
    deliver_constants(trace);
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) {
      model::check_triangle(*scene, triangle, index);
      rows.clear();
      model::triangle_to_rows(pipeline, triangle, index, walk, rows, counters, trace, watch);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const SpanRecord span = model::row_to_span(pipeline, rows, i, counters, watch);
        fragments.clear();
        model::span_to_fragments(pipeline, span, model::geometry_of(rows, i), fragments, counters, watch);
        deliver(trace, span);
        deliver_all(trace, fragments);
        model::fragments_to_frame(pipeline, fragments, model::texture_of(*scene, triangle.texture),
                                  model::gradient_of(rows, index), frame, counters, trace, watch);
      }
      ++index;
    }
  }

  void deliver_constants(Trace* trace) {
    if (trace == nullptr || constants_delivered) return;
    trace->constants.push_back(pipeline.constants.record);
    constants_delivered = true;
  }

  Config config;
  bool winners;
  const Scene* scene = nullptr;
  model::Pipeline pipeline;
  Frame frame;
  Counters counters;
  bool constants_delivered = false;  // once per scene
  // Reused from triangle to triangle.
  model::Rows rows;
  model::PlaneWalkState walk;
  std::vector<FragmentRecord> fragments;
};

class Model final : public Engine, public RowEngine {
 public:
  Model(const Config& config, bool winners) : run_(config, winners) {}
  std::string_view name() const override { return "model"; }
  void begin(const Scene& scene) override { run_.begin(scene, NoObserve{}); }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.draw(triangles, first_index, trace, NoObserve{});
  }
  const Frame& frame() const override { return run_.frame; }
  const Counters& counters() const override { return run_.counters; }
  PlaneOfRows set_plane(const SetupRecord& setup) override {
    plane_rows_ = model::plane_rows(run_.pipeline, setup, run_.walk);
    return {run_.walk.geometry.along_y, plane_rows_};
  }
  void draw_row(const AnyRow& row, std::size_t /*plane_row*/, int texture, Trace* trace) override {
    run_.deliver_constants(trace);
    model::row_to_frame(run_.pipeline, row, run_.pipeline.const_depth_rows ? &run_.walk.geometry : nullptr,
                        model::texture_of(*run_.scene, texture), run_.frame, run_.counters, trace);
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
    run_.begin(scene, Observe{&statistics_});
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.draw(triangles, first_index, trace, Observe{&statistics_});
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
