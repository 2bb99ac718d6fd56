#include "golden/engine_golden.hpp"

#include <cmath>
#include <limits>

#include "golden/depth.hpp"
#include "golden/edge_walk.hpp"
#include "golden/fog.hpp"
#include "golden/merge.hpp"
#include "golden/plane_walk.hpp"
#include "golden/precision.hpp"
#include "golden/setup.hpp"
#include "golden/span.hpp"
#include "golden/span_setup.hpp"
#include "golden/texture.hpp"

namespace bitspan {

namespace {

using namespace golden;

class GoldenEngine final : public Engine {
 public:
  GoldenEngine(const Config& config, Precision precision, bool checked)
      : config_(config), checked_(checked), precision_(std::move(precision)) {
    texture_ = make_texture(with(precision_.texture), config_);
    merge_ = make_merge(with(precision_.merge), config_);
  }

  std::string_view name() const override { return "golden"; }
  const Frame& frame() const override { return frame_; }
  const Counters& counters() const override { return counters_; }

  void begin(const Scene& scene) override {
    constants_ = make_constants(config_, scene);
    scene_ = &scene;
    setup_ = make_setup(with(precision_.setup), config_, constants_);
    if (by_planes()) {
      plane_walk_ =
          make_plane_walk(with(precision_.plane_walk), config_, constants_, scene.width, scene.height);
      plane_span_setup_ = make_plane_span_setup(with(precision_.span_setup), config_, constants_);
    } else {
      edge_setup_ = make_edge_setup(with(precision_.edge_setup), config_, constants_);
      edge_walk_ = make_edge_walk(with(precision_.edge_walk), config_, constants_, scene.width, scene.height);
      span_setup_ = make_span_setup(with(precision_.span_setup), config_, constants_);
    }
    span_ = make_span(with(precision_.span), config_, constants_);
    depth_ = make_depth(with(precision_.depth), config_, constants_);
    fog_ = make_fog(with(precision_.fog), config_, constants_, scene);
    uv_ulp_ = std::ldexp(1.0, -config_.format(FormatId::span_uv).fraction());

    constants_delivered_ = false;
    counters_ = {};
    const auto pixels = static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height);
    frame_.width = scene.width;
    frame_.height = scene.height;
    frame_.depth.assign(pixels, static_cast<std::uint32_t>(clear_depth(config_)));
    frame_.u.assign(pixels, std::numeric_limits<double>::quiet_NaN());
    frame_.v.assign(pixels, std::numeric_limits<double>::quiet_NaN());
    frame_.triangle.assign(pixels, -1);
    frame_.color.resize(4 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      for (std::size_t c = 0; c < 3; ++c) frame_.color[4 * i + c] = scene.background[c];
      frame_.color[4 * i + 3] = 255;
    }
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    if (trace != nullptr && !constants_delivered_) {
      trace->constants.push_back(constants_.record);
      constants_delivered_ = true;
    }
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) draw_one(triangle, index++, trace);
  }

 private:
  Arithmetic with(Width width) const { return {width, checked_}; }
  bool by_planes() const { return config_.perspective == Perspective::const_depth_rows; }

  void draw_one(const Triangle& triangle, std::int64_t index, Trace* trace) {
    ++counters_.triangles;
    const std::optional<SetupRecord> setup = setup_(triangle, index);
    if (!setup) {
      ++counters_.degenerate;
      return;
    }
    if (trace != nullptr) trace->setup.push_back(*setup);
    const Texture* texture =
        triangle.texture < 0 ? nullptr : &scene_->textures.at(static_cast<std::size_t>(triangle.texture));
    if (by_planes()) {
      draw_planes(*setup, texture, trace);
    } else {
      draw_rows(*setup, texture, trace);
    }
  }

  void draw_rows(const SetupRecord& setup, const Texture* texture, Trace* trace) {
    std::array<EdgeRecord, 3> edges;
    const int edge_count = edge_setup_(setup, edges);
    const std::span<const EdgeRecord> with_height(edges.data(), static_cast<std::size_t>(edge_count));
    const int slopes = config_.edge_walk == EdgeWalk::dda ? 8 : 7;
    counters_.divides_edge +=
        static_cast<std::uint64_t>(edge_count * (config_.edge_slope == SlopeForm::reciprocal ? 1 : slopes));
    if (trace != nullptr) trace->edge.insert(trace->edge.end(), with_height.begin(), with_height.end());

    rows_.clear();
    edge_walk_(setup, with_height, rows_);
    for (const RowRecord& row : rows_) {
      ++counters_.rows;
      if (config_.perspective != Perspective::affine) counters_.divides_edge += 2;
      if (row.r_x > row.l_x) counters_.divides_row += config_.row_slope == SlopeForm::reciprocal ? 1 : 7;
      if (trace != nullptr) trace->row.push_back(row);
      draw_span(span_setup_(row), nullptr, {}, texture, trace);
    }
  }

  void draw_planes(const SetupRecord& setup, const Texture* texture, Trace* trace) {
    plane_walk_(setup, planes_);
    counters_.divides_edge += 15;  // 14 gradients and k
    if (trace != nullptr) trace->plane.push_back(planes_.plane);
    std::span<const std::uint8_t> flags = planes_.covered;
    for (const PlaneRowRecord& row : planes_.rows) {
      const auto count = static_cast<std::size_t>(row.count);
      ++counters_.rows;
      ++counters_.divides_row;
      --counters_.divides_saved;
      if (trace != nullptr) trace->plane_row.push_back(row);
      draw_span(plane_span_setup_(planes_.plane, row), &planes_.plane, flags.first(count), texture, trace);
      flags = flags.subspan(count);
    }
  }

  void draw_span(const SpanRecord& span, const PlaneRecord* plane, std::span<const std::uint8_t> covered,
                 const Texture* texture, Trace* trace) {
    if (trace != nullptr) trace->span.push_back(span);
    fragments_.clear();
    span_(span, plane, covered, fragments_);
    if (trace != nullptr) trace->fragment.insert(trace->fragment.end(), fragments_.begin(), fragments_.end());
    counters_.fragments += fragments_.size();
    if (config_.perspective == Perspective::delta_f) counters_.divides_pixel += fragments_.size();
    if (config_.perspective == Perspective::hyperbolic) counters_.divides_pixel += 2 * fragments_.size();
    for (const FragmentRecord& fragment : fragments_) {
      if (fragment.covered == 1) draw_fragment(fragment, texture, trace);
    }
  }

  void draw_fragment(const FragmentRecord& fragment, const Texture* texture, Trace* trace) {
    ++counters_.covered;
    if (by_planes()) ++counters_.divides_saved;
    const auto at = static_cast<std::size_t>(fragment.y * frame_.width + fragment.x);
    const DepthRecord depth = depth_(fragment, frame_.depth[at]);
    if (trace != nullptr) trace->depth.push_back(depth);
    if (depth.pass == 0) return;
    ++counters_.depth_passed;
    const TextureRecord textured = texture_(fragment, texture);
    if (trace != nullptr) trace->texture.push_back(textured);
    if (textured.killed == 1) {
      ++counters_.killed;
      return;
    }
    const FogRecord fogged = fog_(fragment, textured);
    if (trace != nullptr) trace->fog.push_back(fogged);
    std::uint8_t* color = &frame_.color[4 * at];
    const MergeRecord merged = merge_(fogged, textured, depth, {color[0], color[1], color[2]});
    if (trace != nullptr) trace->merge.push_back(merged);
    ++counters_.written;
    color[0] = static_cast<std::uint8_t>(merged.r);
    color[1] = static_cast<std::uint8_t>(merged.g);
    color[2] = static_cast<std::uint8_t>(merged.b);
    frame_.depth[at] = static_cast<std::uint32_t>(merged.z);
    frame_.u[at] = static_cast<double>(fragment.u) * uv_ulp_;
    frame_.v[at] = static_cast<double>(fragment.v) * uv_ulp_;
    frame_.triangle[at] = static_cast<std::int32_t>(fragment.triangle);
  }

  Config config_;
  bool checked_;
  Precision precision_;
  const Scene* scene_ = nullptr;
  Constants constants_;
  bool constants_delivered_ = false;  // once a scene, in front of its first record
  double uv_ulp_ = 1;
  SetupStage setup_;
  EdgeSetupStage edge_setup_;
  EdgeWalkStage edge_walk_;
  PlaneWalkStage plane_walk_;
  SpanSetupStage span_setup_;
  PlaneSpanSetupStage plane_span_setup_;
  SpanStage span_;
  DepthStage depth_;
  TextureStage texture_;
  FogStage fog_;
  MergeStage merge_;
  // Reused from triangle to triangle.
  std::vector<RowRecord> rows_;
  PlaneRows planes_;
  std::vector<FragmentRecord> fragments_;
  Frame frame_;
  Counters counters_;
};

}  // namespace

bool golden_checks_by_default() {
#if !defined(NDEBUG) || defined(__SANITIZE_ADDRESS__)
  return true;
#else
  return false;
#endif
}

std::unique_ptr<Engine> make_golden(const Config& config, const golden::Precision& precision, bool checked) {
  return std::make_unique<GoldenEngine>(config, precision, checked);
}
std::unique_ptr<Engine> make_golden(const Config& config, bool checked) {
  return make_golden(config, choose_precision(config), checked);
}
std::unique_ptr<Engine> make_golden(const Config& config) {
  return make_golden(config, golden_checks_by_default());
}

}  // namespace bitspan
