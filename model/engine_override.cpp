// SPDX-License-Identifier: Apache-2.0
#include "model/engine_override.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/rows.hpp"
#include "model/pipeline.hpp"
#include "model/scene_run.hpp"

namespace bitspan {
namespace {

class OverriddenModel final : public Engine, public RowEngine {
 public:
  OverriddenModel(const Config& config, StageHooks hooks) : config_(config), hooks_(std::move(hooks)) {}
  std::string_view name() const override { return "model"; }
  const Frame& frame() const override { return run_.frame; }
  const Counters& counters() const override { return run_.counters; }

  void begin(const Scene& scene) override {
    run_.pipeline = model::make_pipeline(config_, scene);
    run_.begin(scene, true);
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.need_begun("draw");
    trace_ = trace;
    run_.deliver_constants(trace);
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) {
      model::check_triangle(*run_.scene, triangle, index);
      texture_ = model::texture_of(*run_.scene, triangle.texture);
      back_ = model::surface_of(run_.pipeline, triangle).back;
      draw_one(triangle, index++);
    }
  }

  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    run_.execute(config_, command, next_index, trace);
  }

  PlaneOfRows set_plane(const SetupRecord& setup) override {
    plane_rows_ = model::plane_rows(run_.pipeline, setup, walk_);
    return {walk_.geometry.along_y, plane_rows_};
  }
  // The row comes from elsewhere, so its own stage has no hook.
  void draw_row(const AnyRow& any, std::size_t /*plane_row*/, int texture, Trace* trace) override {
    trace_ = trace;
    texture_ = model::texture_of(*run_.scene, texture);
    back_ = false;
    check_draws_rows(config_, any);
    run_.deliver_constants(trace);
    ++run_.counters.rows;
    if (run_.pipeline.const_depth_rows) --run_.counters.divides_saved;
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

  // The hooks and the records of the channels in use; in: the records that feed them.
  template <class In, class Record>
  void finish_channels(const model::PerChannel<In>& in, model::PerChannel<Record>& out) const {
    for (std::size_t c = 0; c < run_.pipeline.channels.in_use.size(); ++c) finish(in[c], out[c]);
  }
  void set_up_channels(const Triangle& triangle, const SetupRecord& vertices, const model::Edges* edges) {
    if (!run_.pipeline.channels.any()) return;
    channels_ = model::setup_channels(run_.pipeline.channels, triangle, vertices, edges, &plane_);
    run_.counters.divides_edge += static_cast<std::uint64_t>(channels_.divides);
    model::PerChannel<SetupRecord> in;
    in.fill(vertices);
    finish_channels(in, channels_.record);
  }

  void draw_one(const Triangle& triangle, std::int64_t index) {
    if (triangle.is_line) {
      throw InputError("triangle " + std::to_string(index) +
                       " is a line, and an engine whose records may be changed has none; legal: triangles");
    }
    ++run_.counters.triangles;
    SetupRecord vertices;
    if (!model::setup(run_.pipeline.setup, triangle, index, vertices)) {
      ++run_.counters.degenerate;
      return;
    }
    finish(run_.pipeline.constants.record, vertices);
    if (run_.pipeline.has_gradients) {
      gradient_ = model::setup_gradients(run_.pipeline.plane_walk, vertices);
      finish(vertices, gradient_);
      if (!run_.pipeline.const_depth_rows) run_.counters.divides_edge += model::divides_per_gradients;
    }
    if (run_.pipeline.const_depth_rows) {
      draw_planes(triangle, vertices);
    } else {
      draw_rows(triangle, vertices);
    }
  }

  void draw_planes(const Triangle& triangle, const SetupRecord& vertices) {
    set_up_channels(triangle, vertices, nullptr);
    model::start_plane_walk(run_.pipeline.plane_walk, vertices, walk_);
    deliver(trace_, walk_.record);
    run_.counters.divides_edge += model::divides_per_plane;
    PlaneRowRecord row;
    while (!finished(walk_)) {
      if (!model::plane_walk(run_.pipeline.plane_walk, walk_, row)) continue;
      ++run_.counters.rows;
      --run_.counters.divides_saved;
      finish(walk_.record, row);
      draw_span(row);
    }
  }

  void draw_rows(const Triangle& triangle, const SetupRecord& vertices) {
    model::Edges edges = model::setup_edges(run_.pipeline.setup, vertices);
    const auto with_height = std::span(edges.edge).first(static_cast<std::size_t>(edges.count));
    run_.counters.divides_edge +=
        with_height.size() * static_cast<std::size_t>(run_.pipeline.setup.divides_per_edge);
    for (EdgeRecord& edge : with_height) finish(vertices, edge);
    if (run_.pipeline.by_plane) {
      plane_ = model::setup_plane(run_.pipeline.setup_plane, vertices);
      finish(vertices, plane_.record);
      run_.counters.divides_edge += static_cast<std::uint64_t>(run_.pipeline.setup_plane.divides_per_plane);
    }
    set_up_channels(triangle, vertices, &edges);
    model::EdgeWalkState state = model::start_edge_walk(run_.pipeline.edge_walk, vertices, edges);
    RowRecord row;
    while (!finished(state)) {
      if (!model::edge_walk(run_.pipeline.edge_walk, state, row)) continue;
      ++run_.counters.rows;
      run_.counters.divides_edge += static_cast<std::uint64_t>(run_.pipeline.edge_walk.divides_per_row);
      finish(*std::ranges::find(with_height, row.l_edge, &EdgeRecord::edge), row);
      if (run_.pipeline.channels.any() && !run_.pipeline.by_plane) {
        row_channels_ = model::row_channels(run_.pipeline.channels, channels_, row);
        finish_channels(channels_.record, row_channels_);
      }
      draw_span(row);
    }
  }

  void draw_span(const RowRecord& row) {
    SpanRecord span;
    run_.counters.divides_row += static_cast<std::uint64_t>(
        run_.pipeline.by_plane ? model::span_setup(run_.pipeline.span_setup, row, plane_, span)
                               : model::span_setup(run_.pipeline.span_setup, row, span));
    finish(row, span);
    const bool has_ends = !run_.pipeline.by_plane;
    start_channels(span, has_ends ? &row : nullptr, has_ends ? &row_channels_ : nullptr);
    draw_fragments(span);
  }
  void draw_span(const PlaneRowRecord& row) {
    SpanRecord span;
    run_.counters.divides_row +=
        static_cast<std::uint64_t>(model::span_setup(run_.pipeline.span_setup, row, walk_.geometry, span));
    finish(row, span);
    start_channels(span, nullptr, nullptr);
    draw_fragments(span);
  }

  void start_channels(const SpanRecord& span, const RowRecord* row, const model::RowChannels* ends) {
    if (!run_.pipeline.channels.any()) return;
    const model::PlaneGeometry* geometry = run_.pipeline.const_depth_rows ? &walk_.geometry : nullptr;
    model::SpanChannels start =
        model::span_channels(run_.pipeline.channels, channels_, span, row, ends, geometry);
    run_.counters.divides_row += static_cast<std::uint64_t>(start.divides);
    finish_channels(channels_.record, start.record);
    channel_walk_ = {.geometry = geometry, .span = start.record};
  }

  void draw_fragments(const SpanRecord& span) {
    fragments_.clear();
    model::span_to_fragments(run_.pipeline, span, run_.pipeline.const_depth_rows ? &walk_.geometry : nullptr,
                             fragments_, run_.counters);
    const auto finish_fragment = [this](const auto& in, auto& out) { finish(in, out); };
    model::FragmentDrawing<decltype(finish_fragment)> drawing{
        run_.pipeline, texture_, &gradient_, back_, run_.frame, run_.counters, finish_fragment};
    for (FragmentRecord& fragment : fragments_) {
      const std::int64_t covered = fragment.covered;
      finish(span, fragment);
      count_covered(fragment.covered - covered);
      model::FragmentChannels channels;
      if (run_.pipeline.channels.any()) {
        const auto of_span = channel_walk_.span;
        channels = model::fragment_channels(run_.pipeline.channels, channel_walk_, fragment);
        finish_channels(of_span, channels);
      }
      if (fragment.covered == 1) drawing.draw(fragment, &channels);
    }
  }
  void count_covered(std::int64_t more) {
    run_.counters.covered += static_cast<std::uint64_t>(more);
    if (run_.pipeline.const_depth_rows) run_.counters.divides_saved += more;
  }

  Config config_;
  StageHooks hooks_;
  model::SceneRun run_;
  // Of the draw under way.
  Trace* trace_ = nullptr;
  const Texture* texture_ = nullptr;
  bool back_ = false;  // a back face
  // Of the triangle under way.
  GradientRecord gradient_;
  model::TrianglePlane plane_;
  model::TriangleChannels channels_;
  model::RowChannels row_channels_;
  model::ChannelWalk channel_walk_;
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
