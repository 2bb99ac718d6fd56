// SPDX-License-Identifier: Apache-2.0
#include "model/simd/engine_vector.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>
#include <vector>

#include "config/modes.hpp"
#include "model/numeric/from_double.hpp"
#include "model/pipeline.hpp"
#include "model/scene_run.hpp"
#include "model/simd/shade.hpp"
#include "model/simd/shipped.hpp"
#include "model/simd/spans.hpp"
#include "model/simd/triangles.hpp"

namespace bitspan::model {
namespace {

// So many triangles are sorted into bands of rows at once: memory does not grow with the scene.
constexpr std::size_t chunk_triangles = 65536;
// Bytes of a band's pixels, which stay in the second-level cache while its triangles are drawn.
constexpr std::int64_t band_bytes = std::int64_t{384} * 1024;
constexpr std::int64_t pixel_bytes = 8;  // depth code and colour
constexpr std::int64_t band_rows_min = 8;

// True where nothing is wrong with a triangle; false: check_triangle finds what, or nothing.
bool plainly_good(const Scene& scene, const Triangle& triangle) {
  double sum = 0;
  bool good = triangle.texture < static_cast<int>(scene.textures.size());
  for (const Vertex& v : triangle.v) {
    sum += std::abs(v.x) + std::abs(v.y) + std::abs(v.u) + std::abs(v.v);
    good = good && v.s >= scene.s_min && v.s <= scene.s_max;
    for (const double c : v.c) good = good && c >= 0 && c <= 1;
  }
  for (const GivenAttribute& given : given_attributes) {
    if (!given.is_given(triangle.v)) continue;
    for (const Vertex& v : triangle.v) good = good && given.is_legal(v.*given.member);
  }
  return good && std::isfinite(sum);
}

// Bands of the rows that are drawn, from top to bottom, and which triangles of a chunk touch which. They keep
// the pixels of a band in a cache; the frame has those of all.
class Bands {
 public:
  // coordinate: of the vertices; rows: of the picture that are drawn, `each` to a band.
  Bands(const Register& coordinate, std::int64_t height, const RowRange& rows, std::int64_t each)
      : rows_(rows.within(height)),
        each_(each),
        reach_(coordinate.min, coordinate.max, coordinate.fraction, height),
        triangles_(std::max<std::size_t>(
            1, static_cast<std::size_t>((rows_.end - rows_.first + each - 1) / each))) {}

  std::size_t size() const { return triangles_.size(); }
  void clear() {
    for (auto& band : triangles_) band.clear();
  }
  void add(const Triangle& t, std::size_t place) {
    const RowRange reached = reach_.of(t);
    std::size_t band = band_of(reached.first);
    const std::size_t last = band_of(reached.end - 1);
    auto which = static_cast<std::uint32_t>(place);
    for (; band <= last; ++band) {
      triangles_[band].push_back(which);
      which |= TriangleRows::counted;
    }
  }
  // Returns the rows of band i; `triangles` and `first_index` describe the chunk, again is as of
  // TriangleRows.
  TriangleRows rows(std::size_t i, std::span<const Triangle> triangles, std::int64_t first_index,
                    bool again) const {
    const std::int64_t first = rows_.first + static_cast<std::int64_t>(i) * each_;
    return {triangles.data(), first_index, triangles_[i], first, std::min(first + each_, rows_.end), again};
  }

 private:
  std::size_t band_of(std::int64_t y) const {
    return static_cast<std::size_t>(std::clamp(y, rows_.first, std::max(rows_.first, rows_.end - 1)) -
                                    rows_.first) /
           static_cast<std::size_t>(each_);
  }
  RowRange rows_;
  std::int64_t each_;
  RowReach reach_;
  std::vector<std::vector<std::uint32_t>> triangles_;
};

// How triangles are drawn.
enum class Way : std::uint8_t {
  plain,   // in lanes, in the state and the planes of the scene's start
  any,     // in lanes, in any state that they have, and with channels
  singly,  // as `plain`, and scalar up to depth
  scalar,  // by the scalar stages
};

// What one thread draws with.
template <class T>
struct Worker final : BlockSink<T> {
  TriangleBatch triangles;
  Columns<SpanRecord> spans{0};
  SpanWork<T> work;
  Counters counters;
  // Where the stages up to depth are scalar.
  Rows rows;
  PlaneWalkState walk;
  std::vector<FragmentRecord> fragments;
  std::vector<FragmentChannels> channels;

  // What the draw under way was given.
  const Pipeline* pipeline = nullptr;
  const ShadePlan* plan = nullptr;
  const ShadeKernels<T>* shade = nullptr;
  Frame* frame = nullptr;
  Trace* trace = nullptr;
  Statistics* statistics = nullptr;
  const TriangleGradients* gradients = nullptr;  // of draws in any state; null in the short way

  void operator()(const FragmentBlock<T>& block, const BlockDraw& draw) override {
    if (gradients != nullptr) {
      shade->shade_any(*pipeline, *plan, draw, block, *gradients, *frame, counters);
    } else if (statistics != nullptr) {
      shade->shade_observed(*pipeline, *plan, draw, block, *frame, counters, trace, *statistics);
    } else {
      shade->shade(*pipeline, *plan, draw, block, *frame, counters, trace);
    }
  }
};

std::int64_t band_rows(const Pipeline& pipeline, int threads) {
  const RowRange drawn = pipeline.rows.within(pipeline.edge_walk.height);
  const std::int64_t height = std::max<std::int64_t>(1, drawn.end - drawn.first);
  // The scalar stages walk an edge from its start in every band.
  std::int64_t bands = threads;
  if (triangles_in_lanes(pipeline)) {
    bands = (pipeline.edge_walk.width * height * pixel_bytes + band_bytes - 1) / band_bytes;
    // Enough for every thread to have some at its end.
    if (threads > 1) bands = std::max(bands, std::int64_t{4} * threads);
  }
  const std::int64_t rows = (height + bands - 1) / bands;
  return std::min(height, std::max(rows, band_rows_min));
}

// A configuration prepared for a scene, with blocks of T.
template <class T>
class Drawing {
 public:
  Drawing(const Pipeline& pipeline, const ShadePlan& plan, const ModelOptions& options, ShippedIndex shipped)
      : pipeline_(pipeline),
        plan_(plan),
        triangles_(triangle_kernels(options.target)),
        spans_(span_kernels<T>(options.target)),
        shade_(shade_kernels<T>(options.target)),
        workers_(static_cast<std::size_t>(options.threads)),
        bands_(pipeline.setup.coordinate, pipeline.edge_walk.height, pipeline.rows,
               band_rows(pipeline, options.threads)),
        whole_(pipeline.setup.coordinate, pipeline.edge_walk.height, pipeline.rows,
               pipeline.edge_walk.height),
        arena_(options.threads) {
    if constexpr (sizeof(T) == sizeof(std::int32_t)) {
      if (specialises && shipped.spans >= 0) {
        const SpanKernels<T> spans = shipped_span_kernels(options.target, shipped.spans);
        spans_.draw = spans.draw;
        spans_.evaluate = spans.evaluate;
      }
      if (specialises && shipped.shades >= 0) {
        shade_.shade = shipped_shade_kernels(options.target, shipped.shades).shade;
      }
    }
    for (auto& worker : workers_) worker = std::make_unique<Worker<T>>();
  }

  // Triangles that check_triangle accepts, in order; their number is not larger than a chunk. again: as
  // BandEngine::draw_again. Returns its rows_above of these triangles.
  std::uint64_t draw(Way way, std::span<const Triangle> triangles, std::int64_t first_index, bool again,
                     Frame& frame, Counters& counters, Trace* trace, Statistics* statistics) {
    way_ = way;
    again_ = again;
    for (auto& worker : workers_) {
      worker->triangles.rows_above = 0;
      worker->gradients = way == Way::any ? &gradients_ : nullptr;
      worker->counters = {};
      worker->pipeline = &pipeline_;
      worker->plan = &plan_;
      worker->shade = &shade_;
      worker->frame = &frame;
      worker->trace = trace;
      worker->statistics = statistics;
    }
    if (way == Way::singly) {
      draw_singly(*workers_[0], triangles, first_index, trace, statistics);
    } else {
      if (way == Way::any && pipeline_.has_gradients) find_gradients(triangles, first_index, counters);
      find_draws(triangles);
      // Records and statistics come in the order of the triangles.
      const bool watched = trace != nullptr || statistics != nullptr;
      Bands& bands = watched ? whole_ : bands_;
      bands.clear();
      for (std::size_t i = 0; i < triangles.size(); ++i) bands.add(triangles[i], i);
      in_parallel(bands.size(), [&](Worker<T>& worker, std::size_t i) {
        draw_rows(worker, bands.rows(i, triangles, first_index, again));
      });
    }
    std::uint64_t rows_above = 0;
    for (const auto& worker : workers_) {
      counters += worker->counters;
      rows_above += worker->triangles.rows_above;
    }
    return rows_above;
  }

 private:
  template <class Body>
  void in_parallel(std::size_t n, Body body) {
    if (workers_.size() == 1 || n == 1) {
      for (std::size_t i = 0; i < n; ++i) body(*workers_[0], i);
      return;
    }
    arena_.execute([&] {
      tbb::parallel_for(
          std::size_t{0}, n,
          [&](std::size_t i) {
            body(*workers_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())], i);
          },
          tbb::simple_partitioner());
    });
  }

  void draw_rows(Worker<T>& worker, TriangleRows rest) {
    Trace* const trace = worker.trace;
    while (!rest.which.empty()) {
      worker.spans.size = 0;
      std::size_t done = 0;
      if (worker.statistics != nullptr) {
        done = triangles_.to_spans_observed(pipeline_, rest, worker.triangles, worker.spans, worker.counters,
                                            trace, *worker.statistics);
      } else {
        done = triangles_.to_spans(pipeline_, rest, worker.triangles, worker.spans, worker.counters, trace);
      }
      rest.which = rest.which.subspan(done);
      if (trace != nullptr || worker.statistics != nullptr) {
        spans_.draw_traced(pipeline_, worker.spans, draws_, rest.first_index, worker.work, *worker.frame,
                           worker.counters, worker, trace, worker.statistics);
      } else if (way_ == Way::any) {
        spans_.draw_any(pipeline_, worker.spans, worker.triangles.channels, draws_, rest.first_index,
                        worker.work, *worker.frame, worker.counters, worker);
      } else {
        spans_.draw(pipeline_, worker.spans, draws_, rest.first_index, worker.work, *worker.frame,
                    worker.counters, worker);
      }
    }
  }

  void find_gradients(std::span<const Triangle> triangles, std::int64_t first_index, Counters& counters) {
    gradients_.first_index = first_index;
    gradients_.of.resize(triangles.size());
    SetupRecord vertices;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (!setup(pipeline_.setup, triangles[i], first_index + static_cast<std::int64_t>(i), vertices))
        continue;
      gradients_.of[i] = setup_gradients(pipeline_.plane_walk, vertices);
      // Where triangles are done one by one, they count their own.
      if (triangles_in_lanes(pipeline_) && !again_) counters.divides_edge += divides_per_gradients;
    }
  }

  void find_draws(std::span<const Triangle> triangles) {
    draws_.resize(triangles.size());
    const Register& shade = pipeline_.setup.shade;
    const auto alpha = [&](double a) { return quantize(exact_of(a), shade, NoObserve{}); };
    const std::int64_t full = alpha(1.0);
    std::optional<int> last_texture;
    bool last = false;
    const auto is_opaque = [&](const Triangle& t, int texture) {
      if (t.v[0].c[3] != 1.0 || t.v[1].c[3] != 1.0 || t.v[2].c[3] != 1.0) {
        return !may_show_through(plan_, texture, alpha(t.v[0].c[3]), alpha(t.v[1].c[3]), alpha(t.v[2].c[3]));
      }
      if (last_texture != texture) {
        last = !may_show_through(plan_, texture, full, full, full);
        last_texture = texture;
      }
      return last;
    };
    if (way_ == Way::any) {
      const WriteMask mask = write_mask(pipeline_.state);
      const bool writes_depth_alone = mask.depth && !mask.color && kills_by_alpha_alone(pipeline_) &&
                                      pipeline_.channels.shades_at < 0;  // a quotient may differ
      const bool replaces = mask.color && replaces_pixels(plan_, pipeline_);
      for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Surface surface = surface_of(pipeline_, triangles[i]);
        const int texture = surface.texture < 0 ? -1 : surface.texture;
        const bool opaque = (writes_depth_alone || replaces) && is_opaque(triangles[i], texture);
        draws_[i] = {.texture = texture,
                     .shared = replaces && opaque,
                     .back = surface.back,
                     .is_unseen = writes_depth_alone && opaque};
        if (has_dz(pipeline_.depth.formats.code)) {
          draws_[i].log2_dz = log2_of_dz(pipeline_.depth.formats, gradients_.of[i]);
        }
      }
      return;
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const int texture = triangles[i].texture < 0 ? -1 : triangles[i].texture;
      draws_[i] = {.texture = texture, .shared = is_opaque(triangles[i], texture)};
    }
  }

  // The scalar stages up to depth, one triangle after the other.
  void draw_singly(Worker<T>& worker, std::span<const Triangle> triangles, std::int64_t index, Trace* trace,
                   Statistics* statistics) {
    for (const Triangle& triangle : triangles) {
      if (statistics != nullptr) {
        draw_one(worker, triangle, index, trace, Observe{statistics});
      } else {
        draw_one(worker, triangle, index, trace, NoObserve{});
      }
      ++index;
    }
  }
  template <class Watch>
  void draw_one(Worker<T>& worker, const Triangle& triangle, std::int64_t index, Trace* trace, Watch watch) {
    Counters& counters = worker.counters;
    FragmentBlock<T>& block = worker.work.block;
    block.size = 0;
    worker.rows.clear();
    Counters elsewhere;
    triangle_to_rows(pipeline_, triangle, index, worker.walk, worker.rows,
                     again_ ? OncePerTriangle{elsewhere, nullptr} : OncePerTriangle{counters, trace},
                     counters, trace, watch);
    worker.triangles.rows_above += worker.rows.above;
    const int texture = triangle.texture < 0 ? -1 : triangle.texture;
    const auto flush = [&] {
      if (block.size != 0) worker(block, {texture});
      block.size = 0;
    };
    DepthRecord z;
    FragmentRecord own;
    for (std::size_t i = 0; i < worker.rows.size(); ++i) {
      const SpanRecord span = row_to_span(pipeline_, worker.rows, i, counters, watch);
      worker.fragments.clear();
      span_to_fragments(pipeline_, span, geometry_of(worker.rows, i), worker.fragments, counters, watch);
      deliver(trace, span);
      deliver_all(trace, worker.fragments);
      if (pipeline_.channels.any()) {
        channels_of_row(pipeline_, worker.rows, i, span, worker.fragments, worker.channels, counters, trace,
                        watch);
      }
      for (std::size_t k = 0; k < worker.fragments.size(); ++k) {
        const FragmentRecord& fragment = worker.fragments[k];
        if (fragment.covered == 0) continue;
        const FragmentRecord& drawn = as_drawn(pipeline_.channels, fragment,
                                               worker.channels.empty() ? nullptr : &worker.channels[k], own);
        const std::size_t pixel = pixel_of(*worker.frame, fragment);
        const bool passed = depth(pipeline_.depth, drawn, nullptr, worker.frame->depth[pixel], z, watch);
        deliver(trace, z);
        if (!passed) continue;
        ++counters.depth_passed;
        if (block.size == block_size) flush();
        own.h = fragment.h;  // of which fog is
        append(block, drawn, z, pixel, pipeline_.fog,
               has_vertex_fog(pipeline_.fog.mode) ? channel_value(worker.channels[k], LineId::fog) : 0);
      }
    }
    flush();
  }

  const Pipeline& pipeline_;
  const ShadePlan& plan_;
  TriangleKernels triangles_;
  SpanKernels<T> spans_;
  ShadeKernels<T> shade_;
  std::vector<std::unique_ptr<Worker<T>>> workers_;
  Way way_ = Way::plain;         // of the draw under way
  bool again_ = false;           // the same
  std::vector<SpanDraw> draws_;  // of the chunk
  TriangleGradients gradients_;  // of the chunk, where depth or lod takes them
  Bands bands_;
  Bands whole_;
  tbb::task_arena arena_;
};

class VectorModel {
 public:
  VectorModel(const Config& config, const ModelOptions& options)
      : config_(config),
        options_(options),
        shipped_(options.form == ModelForm::vector ? ShippedIndex{} : shipped_index(config)) {
    if (options.form == ModelForm::specialised && !shipped_.any()) {
      throw InputError(
          "configuration '" + config.name +
          "': the specialised form is compiled for the formats of the shipped configurations, and these are "
          "none of them");
    }
  }

  void begin(const Scene& scene, Statistics* statistics) {
    // A new pipeline only where it would be another one: the fog table alone costs milliseconds.
    run_.statistics = statistics;
    // Levels of textures are the scene's own.
    if (statistics != nullptr || run_.pipeline.has_lod || key_ != static_cast<const View&>(scene)) {
      key_.reset();
      run_.pipeline = statistics != nullptr ? make_pipeline(config_, scene, Observe{statistics})
                                            : make_pipeline(config_, scene);
      key_ = scene;
    } else {
      check_scene(scene);
    }
    plan_ = prepare_shade(run_.pipeline, config_, scene);
    buffers_.rows_above = 0;
    run_.begin(scene, options_.winners);
    prepare_drawing();
  }
  // Of the next begin(); none: whole pictures.
  void set_band(const std::optional<Band>& band) { run_.band = band; }
  std::uint64_t rows_above() const { return buffers_.rows_above; }

  // again: as BandEngine::draw_again.
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, bool again, Trace* trace,
            Statistics* statistics) {
    run_.need_begun("draw");
    run_.deliver_constants(trace);
    const Way way = find_way(trace != nullptr || statistics != nullptr);
    if (way == Way::scalar) return draw_scalar(triangles, first_index, again, trace, statistics);
    select_textures(plan_, run_.pipeline, *run_.scene);
    if (run_.pipeline.texture_second.is_on()) prepare_second_texture(plan_);
    const auto draw_chunk = [&](std::size_t at, std::size_t n) {
      std::visit(
          [&](auto& drawing) {
            buffers_.rows_above +=
                drawing->draw(way, triangles.subspan(at, n), first_index + static_cast<std::int64_t>(at),
                              again, run_.frame, run_.counters, trace, statistics);
          },
          drawing_);
    };
    int last_texture = -1;
    const auto take_texture = [&](const Triangle& t) {
      if (t.texture == last_texture) return;
      last_texture = t.texture;
      need_texture(plan_, run_.pipeline, *run_.scene, 0, last_texture);
    };
    const auto is_good = [&](const Triangle& t) {
      if (t.is_line || !plainly_good(*run_.scene, t)) return false;
      take_texture(t);
      return true;
    };
    std::size_t at = 0;
    while (at < triangles.size()) {
      const std::size_t most = std::min(triangles.size() - at, chunk_triangles);
      std::size_t good = 0;
      while (good < most && is_good(triangles[at + good])) ++good;
      draw_chunk(at, good);
      at += good;
      if (good == most) continue;
      if (triangles[at].is_line) {
        const auto lines_end = std::ranges::find(triangles.subspan(at), false, &Triangle::is_line);
        const auto lines = static_cast<std::size_t>(lines_end - triangles.subspan(at).begin());
        draw_scalar(triangles.subspan(at, lines), first_index + static_cast<std::int64_t>(at), again, trace,
                    statistics);
        at += lines;
        continue;
      }
      check_triangle(*run_.scene, triangles[at], first_index + static_cast<std::int64_t>(at));
      // Only large numbers, whose sum was not finite: drawn on its own.
      take_texture(triangles[at]);
      draw_chunk(at, 1);
      ++at;
    }
  }

  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) {
    const std::uint64_t before = run_.scene.version();
    const RowRange rows = run_.pipeline.rows;
    run_.execute(config_, command, next_index, trace);
    if (run_.scene.version() == before) {
      if (run_.pipeline.rows != rows) prepare_drawing();
      return;
    }
    key_.reset();  // the pipeline is that of another view
    update_shade(plan_, run_.pipeline, config_, run_.scene, before);
    prepare_drawing();
  }

  PlaneOfRows set_plane(const SetupRecord& setup) {
    plane_rows_ = plane_rows(run_.pipeline, setup, buffers_.walk);
    return {buffers_.walk.geometry.along_y, plane_rows_};
  }
  void draw_row(const AnyRow& row, int texture, Trace* trace) {
    check_draws_rows(config_, row);
    run_.deliver_constants(trace);
    row_to_frame(run_.pipeline, *run_.scene, row,
                 run_.pipeline.const_depth_rows ? &buffers_.walk.geometry : nullptr, {.texture = texture},
                 run_.frame, run_.counters, trace);
  }

  const Frame& frame() const { return run_.frame; }
  const Counters& counters() const { return run_.counters; }

 private:
  void draw_scalar(std::span<const Triangle> triangles, std::int64_t first_index, bool again, Trace* trace,
                   Statistics* statistics) {
    if (statistics != nullptr) {
      draw_triangles(run_.pipeline, *run_.scene, triangles, first_index, again, buffers_, run_.frame,
                     run_.counters, trace, Observe{statistics});
    } else {
      draw_triangles(run_.pipeline, *run_.scene, triangles, first_index, again, buffers_, run_.frame,
                     run_.counters, trace);
    }
  }
  // watched: with a trace or observers.
  Way find_way(bool watched) const {
    const Pipeline& p = run_.pipeline;
    const bool plain = p.draws_in_lanes(run_.frame) && !p.cuts_rows();
    if (plain && p.spans_in_lanes()) return Way::plain;
    if (!watched && !p.const_depth_rows && holds_state(plan_, p)) return Way::any;
    return plain ? Way::singly : Way::scalar;
  }
  // In the lanes that hold the plan.
  void prepare_drawing() {
    const bool small = plan_.held_in == ShadeLanes::int32 && plan_.branch_free &&
                       spans_fit_int32(run_.pipeline.span.formats) &&
                       is_branch_free(run_.pipeline.depth.formats.z) && run_.statistics == nullptr;
    if (small) {
      drawing_.template emplace<std::unique_ptr<Drawing<std::int32_t>>>(
          std::make_unique<Drawing<std::int32_t>>(run_.pipeline, plan_, options_, shipped_));
    } else {
      drawing_.template emplace<std::unique_ptr<Drawing<std::int64_t>>>(
          std::make_unique<Drawing<std::int64_t>>(run_.pipeline, plan_, options_, ShippedIndex{}));
    }
  }

  Config config_;
  ModelOptions options_;
  ShippedIndex shipped_;
  std::optional<View> key_;  // the pipeline is made for it
  SceneRun run_;
  ShadePlan plan_;
  DrawBuffers buffers_;  // of states without a vector form; its walk also of rows that were made elsewhere
  std::vector<PlaneRowRecord> plane_rows_;
  std::variant<std::unique_ptr<Drawing<std::int32_t>>, std::unique_ptr<Drawing<std::int64_t>>> drawing_;
};

class VectorEngine final : public Engine, public RowEngine, public BandEngine {
 public:
  VectorEngine(const Config& config, const ModelOptions& options) : model_(config, options) {}
  std::string_view name() const override { return "model"; }
  void begin(const Scene& scene) override {
    model_.set_band({});
    model_.begin(scene, nullptr);
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    model_.draw(triangles, first_index, false, trace, nullptr);
  }
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    model_.execute(command, next_index, trace);
  }
  const Frame& frame() const override { return model_.frame(); }
  const Counters& counters() const override { return model_.counters(); }
  void begin_band(const Scene& scene, const Band& band) override {
    model_.set_band(band);
    model_.begin(scene, nullptr);
  }
  void draw_again(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    model_.draw(triangles, first_index, true, trace, nullptr);
  }
  std::uint64_t rows_above() const override { return model_.rows_above(); }
  PlaneOfRows set_plane(const SetupRecord& setup) override { return model_.set_plane(setup); }
  void draw_row(const AnyRow& row, std::size_t /*plane_row*/, int texture, Trace* trace) override {
    model_.draw_row(row, texture, trace);
  }

 private:
  VectorModel model_;
};

class ObservedVectorEngine final : public ObservedEngine {
 public:
  ObservedVectorEngine(const Config& config, const ModelOptions& options) : model_(config, options) {}
  std::string_view name() const override { return "model"; }
  void begin(const Scene& scene) override {
    statistics_ = {};
    model_.begin(scene, &statistics_);
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    model_.draw(triangles, first_index, false, trace, &statistics_);
  }
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    model_.execute(command, next_index, trace);
  }
  const Frame& frame() const override { return model_.frame(); }
  const Counters& counters() const override { return model_.counters(); }
  const Statistics& statistics() const override { return statistics_; }

 private:
  VectorModel model_;
  Statistics statistics_;
};

}  // namespace

std::unique_ptr<Engine> make_vector_model(const Config& config, const ModelOptions& options) {
  return std::make_unique<VectorEngine>(config, options);
}

std::unique_ptr<ObservedEngine> make_observed_vector_model(const Config& config, VectorTarget target) {
  ModelOptions options;
  options.target = target;
  return std::make_unique<ObservedVectorEngine>(config, options);
}

const char* vector_refusal(const Config& config) {
  if (const char* refusal = spans_refusal(config)) return refusal;
  // Without lanes that hold levels, nothing of a draw is in lanes.
  const bool holds = !has_lod(config) || holds_any_shading(config, lanes_for_shading(config, config.fog));
  return holds ? nullptr : "texture.mip with texels or shares this wide is not in lanes";
}

}  // namespace bitspan::model
