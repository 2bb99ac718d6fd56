#include "model/simd/engine_vector.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>
#include <vector>

#include "model/numeric/from_double.hpp"
#include "model/pipeline.hpp"
#include "model/simd/shade.hpp"
#include "model/simd/shipped.hpp"
#include "model/simd/spans.hpp"
#include "model/simd/triangles.hpp"

namespace bitspan::model {
namespace {

// A batch ends after so many triangles, or rows: its spans stay in the second level cache.
constexpr std::size_t batch_triangles = 64;
constexpr std::int64_t batch_rows = 512;

// True where nothing is wrong with a triangle; false: check_triangle finds what, or nothing.
bool plainly_good(const Scene& scene, const Triangle& triangle) {
  double sum = 0;
  bool good = triangle.texture < static_cast<int>(scene.textures.size());
  for (const Vertex& v : triangle.v) {
    sum += std::abs(v.x) + std::abs(v.y) + std::abs(v.u) + std::abs(v.v);
    good = good && v.s >= scene.s_min && v.s <= scene.s_max;
    for (const double c : v.c) good = good && c >= 0 && c <= 1;
  }
  return good && std::isfinite(sum);
}

// Rows that a triangle can have at most.
std::int64_t rows_at_most(const Triangle& t, int height) {
  const double low = std::min({t.v[0].y, t.v[1].y, t.v[2].y});
  const double high = std::max({t.v[0].y, t.v[1].y, t.v[2].y});
  const double rows = std::min(high, static_cast<double>(height)) - std::max(low, 0.0);
  return rows > 0 ? static_cast<std::int64_t>(rows) + 2 : 2;
}

// What one thread draws with.
template <class T>
struct Worker final : BlockSink<T> {
  TriangleBatch triangles;
  Columns<SpanRecord> spans{0};
  SpanWork<T> work;
  Counters counters;
  // Rows of constant depth.
  Rows rows;
  PlaneWalkState walk;
  std::vector<FragmentRecord> fragments;

  // Of the draw under way.
  const Pipeline* pipeline = nullptr;
  const ShadePlan* plan = nullptr;
  const ShadeKernels<T>* shade = nullptr;
  Frame* frame = nullptr;
  Trace* trace = nullptr;
  Statistics* statistics = nullptr;

  void operator()(const FragmentBlock<T>& block, int texture, bool store_depth) override {
    if (statistics != nullptr) {
      shade->shade_observed(*pipeline, *plan, texture, block, store_depth, *frame, counters, trace,
                            *statistics);
    } else {
      shade->shade(*pipeline, *plan, texture, block, store_depth, *frame, counters, trace);
    }
  }
};

void add(Counters& to, const Counters& c) {
  to.triangles += c.triangles;
  to.degenerate += c.degenerate;
  to.rows += c.rows;
  to.fragments += c.fragments;
  to.covered += c.covered;
  to.depth_passed += c.depth_passed;
  to.killed += c.killed;
  to.written += c.written;
  to.divides_edge += c.divides_edge;
  to.divides_row += c.divides_row;
  to.divides_pixel += c.divides_pixel;
  to.divides_saved += c.divides_saved;
}

// A configuration prepared for a scene, with blocks of T.
template <class T>
class Drawing {
 public:
  Drawing(const Pipeline& pipeline, const ShadePlan& plan, const ModelOptions& options, int shipped)
      : pipeline_(pipeline),
        plan_(plan),
        triangles_(triangle_kernels(options.target)),
        spans_(span_kernels<T>(options.target)),
        shade_(shade_kernels<T>(options.target)),
        workers_(static_cast<std::size_t>(options.threads)),
        arena_(options.threads) {
    if constexpr (sizeof(T) == sizeof(std::int32_t)) {
      if (specialises && shipped >= 0) {
        const SpanKernels<T> spans = shipped_span_kernels(options.target, shipped);
        spans_.draw = spans.draw;
        spans_.evaluate = spans.evaluate;
        shade_.shade = shipped_shade_kernels(options.target, shipped).shade;
      }
    }
    for (auto& worker : workers_) worker = std::make_unique<Worker<T>>();
  }

  // Triangles of one batch a worker, in order.
  void draw(const std::vector<std::span<const Triangle>>& batches, std::int64_t first_index, Frame& frame,
            Counters& counters, Trace* trace, Statistics* statistics) {
    for (auto& worker : workers_) {
      worker->counters = {};
      worker->pipeline = &pipeline_;
      worker->plan = &plan_;
      worker->shade = &shade_;
      worker->frame = &frame;
      worker->trace = trace;
      worker->statistics = statistics;
    }
    firsts_.clear();
    for (const auto& batch : batches) {
      firsts_.push_back(first_index);
      first_index += static_cast<std::int64_t>(batch.size());
    }
    if (pipeline_.const_depth_rows) {
      draws_.resize(1);
      Worker<T>& worker = *workers_[0];
      for (std::size_t i = 0; i < batches.size(); ++i) {
        draw_planes(worker, batches[i], firsts_[i], trace, statistics);
      }
    } else {
      draws_.resize(batches.size());
      in_parallel(batches.size(), [&](std::size_t i) {
        find_draws(batches[i], draws_[i]);
        Worker<T>& worker = *workers_[i];
        worker.spans.size = 0;
        if (statistics != nullptr) {
          triangles_.to_spans_observed(pipeline_, batches[i], firsts_[i], worker.triangles, worker.spans,
                                       worker.counters, trace, *statistics);
        } else {
          triangles_.to_spans(pipeline_, batches[i], firsts_[i], worker.triangles, worker.spans,
                              worker.counters, trace);
        }
      });
      // Records and statistics come from one worker, in order.
      const bool watched = trace != nullptr || statistics != nullptr;
      in_parallel(watched ? 1 : workers_.size(), [&](std::size_t thread) {
        Worker<T>& worker = *workers_[thread];
        for (std::size_t i = 0; i < batches.size(); ++i) {
          if (watched) {
            spans_.draw_traced(pipeline_, workers_[i]->spans, draws_[i], firsts_[i], worker.work, frame,
                               worker.counters, worker, trace, statistics);
          } else {
            spans_.draw(pipeline_, workers_[i]->spans, draws_[i], firsts_[i],
                        {static_cast<std::int64_t>(thread), static_cast<std::int64_t>(workers_.size())},
                        worker.work, frame, worker.counters, worker);
          }
        }
      });
    }
    for (const auto& worker : workers_) add(counters, worker->counters);
  }

 private:
  template <class Body>
  void in_parallel(std::size_t n, Body body) {
    if (n < 2) {
      if (n == 1) body(0);
      return;
    }
    arena_.execute([&] { tbb::parallel_for(std::size_t{0}, n, body, tbb::simple_partitioner()); });
  }

  void find_draws(std::span<const Triangle> triangles, std::vector<SpanDraw>& out) const {
    out.resize(triangles.size());
    const Register& shade = pipeline_.setup.shade;
    const auto alpha = [&](double a) { return quantize(exact_of(a), shade, NoObserve{}); };
    const std::int64_t full = alpha(1.0);
    std::optional<int> last_texture;
    bool last = false;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Triangle& t = triangles[i];
      const int texture = t.texture < 0 ? -1 : t.texture;
      if (t.v[0].c[3] == 1.0 && t.v[1].c[3] == 1.0 && t.v[2].c[3] == 1.0) {
        if (last_texture != texture) {
          last = !may_show_through(plan_, texture, full, full, full);
          last_texture = texture;
        }
        out[i] = {texture, last};
      } else {
        out[i] = {texture, !may_show_through(plan_, texture, alpha(t.v[0].c[3]), alpha(t.v[1].c[3]),
                                             alpha(t.v[2].c[3]))};
      }
    }
  }

  // const_depth_rows: the scalar stages up to the fragments.
  void draw_planes(Worker<T>& worker, std::span<const Triangle> triangles, std::int64_t index, Trace* trace,
                   Statistics* statistics) {
    for (const Triangle& triangle : triangles) {
      if (statistics != nullptr) {
        draw_plane(worker, triangle, index, trace, Observe{statistics});
      } else {
        draw_plane(worker, triangle, index, trace, NoObserve{});
      }
      ++index;
    }
  }
  template <class Watch>
  void draw_plane(Worker<T>& worker, const Triangle& triangle, std::int64_t index, Trace* trace,
                  Watch watch) {
    Counters& counters = worker.counters;
    FragmentBlock<T>& block = worker.work.block;
    block.size = 0;
    worker.rows.clear();
    triangle_to_rows(pipeline_, triangle, index, worker.walk, worker.rows, counters, trace, watch);
    const int texture = triangle.texture < 0 ? -1 : triangle.texture;
    const auto flush = [&] {
      if (block.size != 0) worker(block, texture, true);
      block.size = 0;
    };
    DepthRecord z;
    for (std::size_t i = 0; i < worker.rows.size(); ++i) {
      const SpanRecord span = row_to_span(pipeline_, worker.rows, i, counters, watch);
      worker.fragments.clear();
      span_to_fragments(pipeline_, span, geometry_of(worker.rows, i), worker.fragments, counters, watch);
      if (trace != nullptr) {
        trace->span.push_back(span);
        trace->fragment.insert(trace->fragment.end(), worker.fragments.begin(), worker.fragments.end());
      }
      for (const FragmentRecord& fragment : worker.fragments) {
        if (fragment.covered == 0) continue;
        const auto pixel = static_cast<std::size_t>(fragment.y * worker.frame->width + fragment.x);
        const bool passed = depth(pipeline_.depth, fragment, worker.frame->depth[pixel], z, watch);
        if (trace != nullptr) trace->depth.push_back(z);
        if (!passed) continue;
        ++counters.depth_passed;
        if (block.size == block_size) flush();
        append(block, fragment, z, pixel, pipeline_.fog);
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
  std::vector<std::vector<SpanDraw>> draws_;
  std::vector<std::int64_t> firsts_;
  tbb::task_arena arena_;
};

bool is_plain(const Register& r) {
  return (r.mode == Rounding::trn || r.mode == Rounding::rnd || r.mode == Rounding::rnd_min_inf) &&
         (r.overflow == Overflow::sat || r.overflow == Overflow::sat_sym);
}

class VectorModel {
 public:
  VectorModel(const Config& config, const ModelOptions& options)
      : config_(config),
        options_(options),
        shipped_(options.form == ModelForm::vector ? -1 : shipped_index(config)) {
    if (options.form == ModelForm::specialised && shipped_ < 0) {
      throw InputError(
          "configuration '" + config.name +
          "': only the shipped configurations have a specialised form, and this is none of them");
    }
  }

  void begin(const Scene& scene, Statistics* statistics) {
    // A new pipeline only where it would be another one: the fog table alone costs milliseconds.
    const Fog fog = scene.fog.value_or(Fog{});
    const SceneKey key{scene.width, scene.height,          scene.s_min, scene.s_max,
                       scene.focal, scene.fog.has_value(), fog.color,   fog.distance};
    if (statistics != nullptr || !(key_ == key)) {
      key_.reset();
      pipeline_ = statistics != nullptr ? make_pipeline(config_, scene, Observe{statistics})
                                        : make_pipeline(config_, scene);
      key_ = key;
    } else {
      check_scene(scene);
    }
    plan_ = prepare_shade(pipeline_, config_, scene);
    scene_ = &scene;
    counters_ = {};
    constants_delivered_ = false;
    clear_frame(pipeline_, scene, options_.winners, frame_);
    const bool small = plan_.lanes == ShadeLanes::int32 && plan_.plain &&
                       spans_fit_int32(pipeline_.span.formats) && is_plain(pipeline_.depth.formats.z) &&
                       statistics == nullptr;
    if (small) {
      drawing_.template emplace<std::unique_ptr<Drawing<std::int32_t>>>(
          std::make_unique<Drawing<std::int32_t>>(pipeline_, plan_, options_, shipped_));
    } else {
      drawing_.template emplace<std::unique_ptr<Drawing<std::int64_t>>>(
          std::make_unique<Drawing<std::int64_t>>(pipeline_, plan_, options_, -1));
    }
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace,
            Statistics* statistics) {
    if (scene_ == nullptr) {
      throw std::logic_error("Engine::draw before begin");
    }
    if (trace != nullptr && !constants_delivered_) {
      trace->constants.push_back(pipeline_.constants.record);
      constants_delivered_ = true;
    }
    const bool alone = trace != nullptr || statistics != nullptr || pipeline_.const_depth_rows;
    const std::size_t at_once = alone ? 1 : static_cast<std::size_t>(options_.threads);
    std::size_t at = 0;
    while (at < triangles.size()) {
      std::vector<std::span<const Triangle>>& batches = batches_;
      batches.clear();
      const std::size_t begin = at;
      std::size_t bad = triangles.size();
      while (batches.size() < at_once && at < triangles.size() && bad == triangles.size()) {
        const std::size_t from = at;
        std::int64_t rows = 0;
        while (at < triangles.size() && at - from < batch_triangles && rows < batch_rows) {
          if (!plainly_good(*scene_, triangles[at])) {
            bad = at;
            break;
          }
          rows += rows_at_most(triangles[at], scene_->height);
          ++at;
        }
        if (at > from) batches.push_back(triangles.subspan(from, at - from));
      }
      std::visit(
          [&](auto& drawing) {
            drawing->draw(batches, first_index + static_cast<std::int64_t>(begin), frame_, counters_, trace,
                          statistics);
          },
          drawing_);
      if (bad != triangles.size()) {
        check_triangle(*scene_, triangles[bad], first_index + static_cast<std::int64_t>(bad));
        // Only large numbers, whose sum was not finite: drawn on its own.
        batches.assign(1, triangles.subspan(bad, 1));
        std::visit(
            [&](auto& drawing) {
              drawing->draw(batches, first_index + static_cast<std::int64_t>(bad), frame_, counters_, trace,
                            statistics);
            },
            drawing_);
        at = bad + 1;
      }
    }
  }

  const Frame& frame() const { return frame_; }
  const Counters& counters() const { return counters_; }

 private:
  // All of a scene that a pipeline is made from.
  struct SceneKey {
    int width, height;
    double s_min, s_max, focal;
    bool has_fog;
    std::array<std::uint8_t, 3> fog_color;
    double fog_distance;
    bool operator==(const SceneKey&) const = default;
  };

  Config config_;
  ModelOptions options_;
  int shipped_;
  const Scene* scene_ = nullptr;
  std::optional<SceneKey> key_;
  Pipeline pipeline_;
  ShadePlan plan_;
  Frame frame_;
  Counters counters_;
  bool constants_delivered_ = false;
  std::vector<std::span<const Triangle>> batches_;
  std::variant<std::unique_ptr<Drawing<std::int32_t>>, std::unique_ptr<Drawing<std::int64_t>>> drawing_;
};

class VectorEngine final : public Engine {
 public:
  VectorEngine(const Config& config, const ModelOptions& options) : model_(config, options) {}
  std::string_view name() const override { return "model"; }
  void begin(const Scene& scene) override { model_.begin(scene, nullptr); }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    model_.draw(triangles, first_index, trace, nullptr);
  }
  const Frame& frame() const override { return model_.frame(); }
  const Counters& counters() const override { return model_.counters(); }

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
    model_.draw(triangles, first_index, trace, &statistics_);
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

const char* vector_refusal(const Config& config) { return spans_refusal(config); }

}  // namespace bitspan::model
