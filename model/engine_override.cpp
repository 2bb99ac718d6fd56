// SPDX-License-Identifier: Apache-2.0
#include "model/engine_override.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "engine/rows.hpp"
#include "model/pipeline.hpp"

namespace bitspan {
namespace {

class OverriddenModel final : public Engine, public RowEngine {
 public:
  OverriddenModel(const Config& config, StageHooks hooks) : config_(config), hooks_(std::move(hooks)) {}
  std::string_view name() const override { return "model"; }
  const Frame& frame() const override { return frame_; }
  const Counters& counters() const override { return counters_; }

  void begin(const Scene& scene) override {
    pipeline_ = model::make_pipeline(config_, scene);
    scene_ = &scene;
    counters_ = {};
    constants_delivered_ = false;
    uv_ulp_ = std::ldexp(1.0, -pipeline_.texture.uv.fraction);
    model::clear_frame(pipeline_, scene, true, frame_);
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    if (scene_ == nullptr) throw std::logic_error("Engine::draw before begin");
    trace_ = trace;
    deliver_constants();
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) {
      model::check_triangle(*scene_, triangle, index);
      texture_ = model::texture_of(*scene_, triangle.texture);
      back_ = model::surface_of(pipeline_, triangle).back;
      draw_one(triangle, index++);
    }
  }

  void set(const StateChange& change, std::int64_t next_index, Trace* trace) override {
    if (scene_ == nullptr) throw std::logic_error("Engine::set before begin");
    trace_ = trace;
    deliver_constants();
    deliver(trace_, model::change_state(pipeline_, config_, change, next_index));
    model::prepare_frame(pipeline_, frame_);
  }
  void clear(const Clear& clear) override {
    clear_planes(frame_, clear, static_cast<std::uint32_t>(pipeline_.depth.clear));
  }

  PlaneOfRows set_plane(const SetupRecord& setup) override {
    plane_rows_ = model::plane_rows(pipeline_, setup, walk_);
    return {walk_.geometry.along_y, plane_rows_};
  }
  // The row comes from elsewhere, so its own stage has no hook.
  void draw_row(const AnyRow& any, std::size_t /*plane_row*/, int texture, Trace* trace) override {
    trace_ = trace;
    texture_ = model::texture_of(*scene_, texture);
    back_ = false;
    model::check_draws_rows(pipeline_);
    deliver_constants();
    ++counters_.rows;
    if (pipeline_.const_depth_rows) --counters_.divides_saved;
    if (const auto* row = std::get_if<RowRecord>(&any)) {
      deliver(trace_, *row);
      draw_span(*row);
    } else if (const auto* plane_row = std::get_if<PlaneRowRecord>(&any)) {
      deliver(trace_, *plane_row);
      draw_span(*plane_row);
    } else {
      deliver(trace_, std::get<SpanRecord>(any));
      draw_fragments(std::get<SpanRecord>(any));
    }
  }

 private:
  void deliver_constants() {
    if (trace_ == nullptr || constants_delivered_) return;
    trace_->constants.push_back(pipeline_.constants.record);
    constants_delivered_ = true;
  }
  template <class In, class Record>
  void hook(const In& in, Record& out) const {
    const StageHook& function = hooks_[static_cast<std::size_t>(record_type<Record>)];
    if (function == nullptr) return;
    function(raw_values(in), {reinterpret_cast<std::int64_t*>(&out), fields<Record>.size()});
  }
  // The hook, and the record to the trace.
  template <class In, class Record>
  void finish(const In& in, Record& out) const {
    hook(in, out);
    deliver(trace_, out);
  }

  void draw_one(const Triangle& triangle, std::int64_t index) {
    ++counters_.triangles;
    SetupRecord vertices;
    if (!model::setup(pipeline_.setup, triangle, index, vertices)) {
      ++counters_.degenerate;
      return;
    }
    finish(pipeline_.constants.record, vertices);
    if (pipeline_.has_gradients) {
      gradient_ = model::setup_gradients(pipeline_.plane_walk, vertices);
      finish(vertices, gradient_);
      if (!pipeline_.const_depth_rows) counters_.divides_edge += model::divides_per_gradients;
    }
    if (pipeline_.const_depth_rows) {
      draw_planes(vertices);
    } else {
      draw_rows(vertices);
    }
  }

  void draw_planes(const SetupRecord& vertices) {
    model::start_plane_walk(pipeline_.plane_walk, vertices, walk_);
    deliver(trace_, walk_.record);
    counters_.divides_edge += model::divides_per_plane;
    PlaneRowRecord row;
    while (!finished(walk_)) {
      if (!model::plane_walk(pipeline_.plane_walk, walk_, row)) continue;
      ++counters_.rows;
      --counters_.divides_saved;
      finish(walk_.record, row);
      draw_span(row);
    }
  }

  void draw_rows(const SetupRecord& vertices) {
    model::Edges edges = model::setup_edges(pipeline_.setup, vertices);
    const auto with_height = std::span(edges.edge).first(static_cast<std::size_t>(edges.count));
    counters_.divides_edge += with_height.size() * static_cast<std::size_t>(pipeline_.setup.divides_per_edge);
    for (EdgeRecord& edge : with_height) finish(vertices, edge);
    model::EdgeWalkState state = model::start_edge_walk(pipeline_.edge_walk, vertices, edges);
    RowRecord row;
    while (!finished(state)) {
      if (!model::edge_walk(pipeline_.edge_walk, state, row)) continue;
      ++counters_.rows;
      counters_.divides_edge += static_cast<std::uint64_t>(pipeline_.edge_walk.divides_per_row);
      finish(*std::ranges::find(with_height, row.l_edge, &EdgeRecord::edge), row);
      draw_span(row);
    }
  }

  void draw_span(const RowRecord& row) {
    SpanRecord span;
    counters_.divides_row += static_cast<std::uint64_t>(model::span_setup(pipeline_.span_setup, row, span));
    finish(row, span);
    draw_fragments(span);
  }
  void draw_span(const PlaneRowRecord& row) {
    SpanRecord span;
    counters_.divides_row +=
        static_cast<std::uint64_t>(model::span_setup(pipeline_.span_setup, row, walk_.geometry, span));
    finish(row, span);
    draw_fragments(span);
  }

  void draw_fragments(const SpanRecord& span) {
    fragments_.clear();
    model::span_to_fragments(pipeline_, span, pipeline_.const_depth_rows ? &walk_.geometry : nullptr,
                             fragments_, counters_);
    for (FragmentRecord& fragment : fragments_) {
      const std::int64_t covered = fragment.covered;
      finish(span, fragment);
      count_covered(fragment.covered - covered);
      if (fragment.covered == 1) draw_fragment(fragment);
    }
  }
  void count_covered(std::int64_t more) {
    counters_.covered += static_cast<std::uint64_t>(more);
    if (pipeline_.const_depth_rows) counters_.divides_saved += more;
  }

  bool passes(const FragmentRecord& fragment, std::size_t at, DepthRecord& z) {
    model::depth(pipeline_.depth, fragment, frame_.depth[at], z);
    finish(fragment, z);
    bool passed = z.pass == 1;
    if (pipeline_.stencil.test) {
      StencilRecord out;
      model::stencil(pipeline_.stencil, back_, z, frame_.stencil[at], out);
      finish(z, out);
      frame_.stencil[at] = static_cast<std::uint8_t>(out.value);
      if (out.pass == 0) ++counters_.stencil_failed;
      passed = passed && out.pass == 1;
    }
    if (passed) ++counters_.depth_passed;
    return passed;
  }
  bool lives(const FragmentRecord& fragment, TextureRecord& texel) {
    LodRecord level;
    if (pipeline_.has_lod) {
      model::fragment_lod(pipeline_, fragment, texture_, &gradient_, level, nullptr);
      finish(fragment, level);
    }
    model::fragment_texture(pipeline_, fragment, texture_, level, texel);
    finish(fragment, texel);
    if (texel.killed == 1) ++counters_.killed;
    return texel.killed == 0;
  }
  void draw_fragment(const FragmentRecord& fragment) {
    if (!model::is_drawn(pipeline_.state, fragment.x, fragment.y)) {
      ++counters_.masked;
      return;
    }
    const std::size_t at = pixel_of(frame_, fragment);
    DepthRecord z;
    TextureRecord texel;
    if (is_late(pipeline_.state.depth_when)) {
      if (!lives(fragment, texel) || !passes(fragment, at, z)) return;
    } else {
      if (!passes(fragment, at, z) || !lives(fragment, texel)) return;
    }
    FogRecord fogged;
    model::fog(pipeline_.fog, fragment, texel, fogged);
    finish(fragment, fogged);
    std::uint8_t* const color = frame_.color.data() + 4 * at;
    MergeRecord merged;
    model::merge(pipeline_.merge, z, texel, fogged, {color[0], color[1], color[2], color[3]}, merged);
    finish(z, merged);
    const WriteMask mask = model::write_mask(pipeline_.state);
    if (pipeline_.merge.changes_alpha) {
      MergeAlphaRecord alpha = model::merged_alpha(pipeline_.merge, texel, color[3]);
      finish(merged, alpha);
      if (mask.color) color[3] = static_cast<std::uint8_t>(alpha.a);
    }
    ++counters_.written;
    write_fragment(frame_, fragment, merged, uv_ulp_, mask);
  }

  Config config_;
  StageHooks hooks_;
  const Scene* scene_ = nullptr;
  model::Pipeline pipeline_;
  double uv_ulp_ = 1;
  Frame frame_;
  Counters counters_;
  bool constants_delivered_ = false;  // once per scene
  // Of the draw under way.
  Trace* trace_ = nullptr;
  const Texture* texture_ = nullptr;
  bool back_ = false;        // a back face
  GradientRecord gradient_;  // of the triangle under way
  // Reused from triangle to triangle.
  model::PlaneWalkState walk_;
  std::vector<PlaneRowRecord> plane_rows_;
  std::vector<FragmentRecord> fragments_;
};

}  // namespace

bool may_be_hooked(RecordType type) {
  return type != RecordType::constants && type != RecordType::state && type != RecordType::plane &&
         type != RecordType::count;
}

std::unique_ptr<Engine> make_overridden_model(const Config& config, StageHooks hooks) {
  for (std::size_t t = 0; t < hooks.size(); ++t) {
    if (hooks[t] != nullptr && !may_be_hooked(static_cast<RecordType>(t))) {
      throw std::logic_error("stage " + std::string(stage_of(static_cast<RecordType>(t))) + " has no hook");
    }
  }
  return std::make_unique<OverriddenModel>(config, std::move(hooks));
}

}  // namespace bitspan
