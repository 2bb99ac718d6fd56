// SPDX-License-Identifier: Apache-2.0
#include "model/timed/workload.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "model/simd/shade.hpp"
#include "model/simd/spans.hpp"
#include "model/simd/triangles.hpp"
#include "model/timed/depth.hpp"
#include "model/timed/fog.hpp"
#include "model/timed/merge.hpp"
#include "model/timed/setup.hpp"
#include "model/timed/span_values.hpp"
#include "model/timed/texture.hpp"

namespace bitspan::timed {
namespace {

using SpanField = std::int64_t SpanRecord::*;
#define BITSPAN_SPAN_FIELD_F(name, id) &SpanRecord::name,
#define BITSPAN_SPAN_FIELD_I(name) &SpanRecord::name,
#define BITSPAN_SPAN_FIELD_K(name, kind) &SpanRecord::name,
constexpr auto span_fields = std::to_array<SpanField>(
    {BITSPAN_SPAN_RECORD(BITSPAN_SPAN_FIELD_F, BITSPAN_SPAN_FIELD_I, BITSPAN_SPAN_FIELD_K)});
#undef BITSPAN_SPAN_FIELD_F
#undef BITSPAN_SPAN_FIELD_I
#undef BITSPAN_SPAN_FIELD_K

// A batch of triangles ends after so many of them or of their rows; its fragments are made in slices of whole
// spans, so that the workload stays in the cache and does not grow with a triangle's size.
constexpr std::size_t batch_triangles = 256;
constexpr std::int64_t batch_rows = 2048;
constexpr std::int64_t slice_pixels = 4096;

}  // namespace

// Makes the values by the vector form's kernels, and the workload from what passes between these.
class Workload::Batch final : model::BlockSink<std::int64_t> {
 public:
  explicit Batch(Workload& workload)
      : workload_(workload),
        run_(workload.run_),
        plan_(model::prepare_shade(run_.pipeline, run_.config, *run_.scene)),
        triangle_kernels_(model::triangle_kernels(VectorTarget::best)),
        span_kernels_(model::span_kernels<std::int64_t>(VectorTarget::best)),
        shade_kernels_(model::shade_kernels<std::int64_t>(VectorTarget::best)) {}

  void scene_changed(std::uint64_t since) {
    model::update_shade(plan_, run_.pipeline, run_.config, run_.scene, since);
  }

  void start(std::span<const Triangle> triangles, std::int64_t first_index) {
    model::select_textures(plan_, run_.pipeline, *run_.scene);
    for (const Triangle& t : triangles) {
      model::need_texture(plan_, run_.pipeline, *run_.scene, 0, t.texture);
    }
    to_draw_ = triangles;
    first_index_ = first_index;
    draws_.clear();
  }

  // A triangle set up: whether it has an area, which rows are walked.
  void set_up(const Triangle& triangle, const SetupRecord& record, bool kept) {
    SetUpTriangle next;
    next.kept = kept;
    next.draw.texture = triangle.texture < 0 ? -1 : triangle.texture;
    if (kept) {
      next.draw.shared = !model::may_show_through(plan_, next.draw.texture, record.a0, record.a1, record.a2);
      const model::EdgeWalkState walk = model::start_edge_walk(run_.pipeline.edge_walk, record, {});
      next.y = walk.y;
      next.y_end = walk.y_end;
    }
    waiting_.push(next);
  }

  void make_rows() {
    if (next_step_ == steps_.size()) make_spans();
    std::int64_t pixels = 0;
    const std::size_t first = next_span_;
    while (next_step_ < steps_.size() && pixels < slice_pixels) {
      const WalkStep step = steps_[next_step_++];
      workload_.steps_.push(step);
      pixels += step.pixels;
      if (step.pixels > 0) ++next_span_;
    }
    if (next_span_ == first) return;
    if (first == 0 && next_span_ == spans_.size) {
      draw(spans_);
      return;
    }
    slice_.size = 0;
    slice_.reserve(next_span_ - first);
    slice_.size = next_span_ - first;
    for (const SpanField field : span_fields) {
      std::memcpy(slice_[field], spans_[field] + first, slice_.size * sizeof(std::int64_t));
    }
    draw(slice_);
  }

  void finish() {
    while (!to_draw_.empty()) {
      make_spans();
      if (!steps_.empty()) throw std::logic_error("span mode has left a triangle of a draw call unwalked");
    }
  }

 private:
  struct SetUpTriangle {
    model::SpanDraw draw;
    bool kept = false;
    std::int64_t y = 0, y_end = 0;  // as in EdgeWalkState
  };

  // The next triangles' spans and steps.
  void make_spans() {
    first_index_ += static_cast<std::int64_t>(draws_.size());
    draws_.clear();
    walks_.clear();
    std::int64_t rows = 0;
    while (draws_.size() < batch_triangles && rows < batch_rows && draws_.size() < to_draw_.size()) {
      if (waiting_.empty()) workload_.set_up();
      const SetUpTriangle& next = waiting_.front();
      draws_.push_back(next.draw);
      walks_.push_back(next);
      rows += next.y_end - next.y;
      waiting_.pop();
    }
    spans_.size = 0;
    which_.resize(draws_.size());
    std::iota(which_.begin(), which_.end(), 0U);
    model::TriangleRows rest{to_draw_.data(), first_index_, which_};
    while (!rest.which.empty()) {
      rest.which = rest.which.subspan(
          triangle_kernels_.to_spans(run_.pipeline, rest, triangles_, spans_, run_.counters, nullptr));
    }
    to_draw_ = to_draw_.subspan(draws_.size());

    steps_.clear();
    next_step_ = next_span_ = 0;
    std::size_t s = 0;
    for (std::size_t i = 0; i < walks_.size(); ++i) {
      const SetUpTriangle& walk = walks_[i];
      if (!walk.kept) continue;
      const std::int64_t triangle = first_index_ + static_cast<std::int64_t>(i);
      for (std::int64_t y = walk.y; y < walk.y_end; ++y) {
        std::uint32_t pixels = 0;
        if (s < spans_.size && spans_[&SpanRecord::triangle][s] == triangle &&
            spans_[&SpanRecord::y][s] == y) {
          pixels = static_cast<std::uint32_t>(spans_[&SpanRecord::count][s++]);
        }
        steps_.push_back({pixels, y + 1 == walk.y_end});
      }
      if (walk.y >= walk.y_end) steps_.push_back({0, true});
    }
    if (s != spans_.size) throw std::logic_error("the vector form has a span on a row that is not walked");
  }

  void draw(const model::Columns<SpanRecord>& spans) {
    drawn_ = &spans;
    at_span_ = 0;
    enter_span();
    span_kernels_.draw(run_.pipeline, spans, draws_, first_index_, work_, run_.frame, run_.counters, *this);
    while (at_span_ < spans.size) add_depth(false);
  }

  // at_span_ is another one.
  void enter_span() {
    const model::Columns<SpanRecord>& spans = *drawn_;
    if (at_span_ == spans.size) {
      at_triangle_ = -1;
      return;
    }
    at_triangle_ = spans[&SpanRecord::triangle][at_span_];
    at_pixel_ = spans[&SpanRecord::y][at_span_] * run_.frame.width + spans[&SpanRecord::x][at_span_];
    end_pixel_ = at_pixel_ + spans[&SpanRecord::count][at_span_];
  }
  // The next fragment of the spans drawn.
  void add_depth(bool passed) {
    FragmentWork work;
    work.pixel = static_cast<std::uint32_t>(at_pixel_);
    work.asks = workload_.depth_traffic_.ask(run_.pipeline, work.pixel, passed, {});
    work.covered = true;
    work.kept = work.holds_pixel = passed;
    workload_.of(Stage::depth).push(work);
    if (++at_pixel_ == end_pixel_) {
      ++at_span_;
      enter_span();
    }
  }
  // The fragments in front of the next one that passed.
  void add_failed_up_to(std::int64_t triangle, std::int64_t pixel) {
    while (at_pixel_ != pixel || at_triangle_ != triangle) {
      if (at_triangle_ < 0) throw std::logic_error("the vector form has a fragment that is in no span");
      add_depth(false);
    }
  }

  void operator()(const model::FragmentBlock<std::int64_t>& block, const model::BlockDraw& draw) override {
    const int texture = draw.texture;
    const Texture* image = texture < 0 ? nullptr : &run_.scene->textures[static_cast<std::size_t>(texture)];
    const auto first = static_cast<std::size_t>(block.triangle[0] - first_index_);
    const bool shared = block.size > 0 && draws_[first].shared;
    FragmentRecord fragment;
    TextureRecord texel;
    for (std::size_t k = 0; k < block.size; ++k) {
      add_failed_up_to(block.triangle[k], block.pixel[k]);
      add_depth(true);
      const auto pixel = static_cast<std::size_t>(block.pixel[k]);
      bool lives = true;
      MergeTraffic::Needs needs;
      if (!shared) {
        fragment.u = block.u[k];
        fragment.v = block.v[k];
        fragment.r = block.r[k];
        fragment.g = block.g[k];
        fragment.b = block.b[k];
        fragment.a = block.a[k];
        lives = model::texture(run_.pipeline.texture, image, fragment, texel);
        needs = workload_.merge_traffic_.needs(run_.pipeline, texel.a);
      }
      const Asks asks =
          workload_.texture_traffic_.ask(run_.pipeline.texture.lookup, texture, block.u[k], block.v[k], {});
      workload_.add_texture(pixel, asks, lives);
      if (lives) workload_.add_merge(pixel, needs);
    }
    shade_kernels_.shade(run_.pipeline, plan_, draw, block, run_.frame, run_.counters, nullptr);
  }

  Workload& workload_;
  Run& run_;
  model::ShadePlan plan_;
  model::TriangleKernels triangle_kernels_;
  model::SpanKernels<std::int64_t> span_kernels_;
  model::ShadeKernels<std::int64_t> shade_kernels_;
  std::span<const Triangle> to_draw_;
  Ring<SetUpTriangle> waiting_;  // of to_draw_
  // The batch under way.
  std::int64_t first_index_ = 0;
  std::vector<model::SpanDraw> draws_;
  std::vector<std::uint32_t> which_;  // 0, 1, ...
  std::vector<SetUpTriangle> walks_;
  std::vector<WalkStep> steps_;
  std::size_t next_step_ = 0, next_span_ = 0;
  model::TriangleBatch triangles_;
  model::Columns<SpanRecord> spans_{0}, slice_{0};
  model::SpanWork<std::int64_t> work_;
  // The next fragment of the spans being drawn.
  const model::Columns<SpanRecord>* drawn_ = nullptr;
  std::size_t at_span_ = 0;
  std::int64_t at_triangle_ = -1;  // that span's; -1: there is none any more
  std::int64_t at_pixel_ = 0, end_pixel_ = 0;
};

Workload::Workload(Run& run)
    : run_(run),
      edge_walk_(run),
      plane_walk_(run),
      depth_traffic_(run),
      texture_traffic_(run),
      merge_traffic_(run) {
  const bool small = run.frame.depth.size() <= std::numeric_limits<std::int32_t>::max();
  if (small && run.pipeline.spans_in_lanes() && run.pipeline.is_plain() &&
      model::spans_refusal(run.config) == nullptr) {
    batch_ = std::make_unique<Batch>(*this);
  }
}

Workload::~Workload() = default;

void Workload::scene_changed(std::uint64_t since) {
  if (batch_) batch_->scene_changed(since);
  texture_traffic_.scene_changed(run_, since);
}

void Workload::start(std::span<const Triangle> triangles, std::int64_t first_index) {
  to_set_up_ = triangles;
  index_ = first_index;
  batched_ = batch_ != nullptr && run_.trace == nullptr && run_.pipeline.draws_in_lanes(run_.frame) &&
             std::ranges::none_of(triangles, &Triangle::is_line);
  if (batched_) batch_->start(triangles, first_index);
}

void Workload::finish() {
  if (batched_) batch_->finish();
}

void Workload::set_up() {
  const Triangle& triangle = to_set_up_.front();
  triangle_.triangle = &triangle;
  triangle_.index = index_++;
  to_set_up_ = to_set_up_.subspan(1);
  bool kept = false;
  if (batched_) {
    // Counted where its spans are made.
    kept = model::setup(run_.pipeline.setup, triangle, triangle_.index, triangle_.setup);
    batch_->set_up(triangle, triangle_.setup, kept);
  } else {
    kept = setup_values(run_, triangle_);
    if (kept) to_walk_.push(triangle_);
  }
  triangles_.push(kept ? 1 : 0);
}

void Workload::make_rows() {
  if (batched_) {
    batch_->make_rows();
  } else if (run_.pipeline.const_depth_rows) {
    make_rows(plane_walk_);
  } else {
    make_rows(edge_walk_);
  }
}

// Some rows more: as many as keep the values' code and the clocks' code from evicting each other.
template <class Walk>
void Workload::make_rows(Walk& walk) {
  const std::uint64_t steps_end = steps_.end() + 64;
  const std::uint64_t depth_end = of(Stage::depth).end() + 512;
  while (steps_.end() < steps_end && of(Stage::depth).end() < depth_end) {
    if (!walking_) {
      while (to_walk_.empty()) {
        if (to_set_up_.empty()) return;
        set_up();
      }
      walk.start(to_walk_.front());
      to_walk_.pop();
      if (walk.finished()) {
        steps_.push({0, true});
        continue;
      }
    }
    const bool has_record = walk.row(row_);
    walking_ = !walk.finished();
    steps_.push({has_record ? static_cast<std::uint32_t>(row_.count) : 0, !walking_});
    if (has_record) make_fragments();
  }
}

void Workload::make_fragments() {
  span_setup_values(run_, row_);
  model::SpanState state = model::start_span(row_.span, geometry_of(run_, row_));
  while (!model::finished(state)) {
    span_values(run_, row_, state, fragment_);
    make_fragment(fragment_);
  }
}

void Workload::make_fragment(FragmentItem& item) {
  const bool drawn = drawn_values(run_, item);
  const bool goes_on = run_.tests_late() ? make_texture(item, drawn) && make_depth(item, true)
                                         : make_depth(item, drawn) && make_texture(item, true);
  if (!goes_on) return;
  fog_values(run_, item);
  add_merge(run_.pixel(item.fragment), merge_traffic_.needs(run_.pipeline, item.texel.a));
  merge_values(run_, item);
}

bool Workload::make_depth(FragmentItem& item, bool drawn) {
  FragmentWork work;
  work.pixel = static_cast<std::uint32_t>(run_.pixel(item.fragment));
  if (drawn) {
    work.covered = true;
    work.kept = depth_values(run_, item);
    work.holds_pixel = holds_pixel(run_, work.kept);
    work.asks = depth_traffic_.ask(run_.pipeline, work.pixel, work.kept, item.stencil);
  }
  of(Stage::depth).push(work);
  return work.kept;
}

bool Workload::make_texture(FragmentItem& item, bool drawn) {
  const std::size_t pixel = run_.pixel(item.fragment);
  if (!drawn) {
    of(Stage::texture).push({.pixel = static_cast<std::uint32_t>(pixel)});
    return false;
  }
  const bool lives = texture_values(run_, item);
  add_texture(pixel, texture_traffic_.ask(run_.pipeline, item), lives);
  return lives;
}

void Workload::add_texture(std::size_t pixel, Asks asks, bool lives) {
  FragmentWork work;
  work.pixel = static_cast<std::uint32_t>(pixel);
  work.asks = asks;
  work.kept = lives;
  work.holds_pixel = !run_.tests_late();
  of(Stage::texture).push(work);
}

void Workload::add_merge(std::size_t pixel, MergeTraffic::Needs needs) {
  FragmentWork work;
  work.pixel = static_cast<std::uint32_t>(pixel);
  work.asks = merge_traffic_.ask(needs, pixel);
  work.kept = work.holds_pixel = true;
  of(Stage::merge).push(work);
}

std::span<const Access> Workload::accesses(Stage stage) const {
  return stage == Stage::depth     ? std::span<const Access>(depth_traffic_.accesses())
         : stage == Stage::texture ? std::span<const Access>(texture_traffic_.accesses())
                                   : std::span<const Access>(merge_traffic_.accesses());
}

void Workload::forget(const Read& read) {
  triangles_.forget(read.triangles);
  steps_.forget(read.steps);
  for (std::size_t i = 0; i < fragments_.size(); ++i) {
    if (fragments_[i].end() > 0) fragments_[i].forget(read.fragments[i]);
  }
}

}  // namespace bitspan::timed
