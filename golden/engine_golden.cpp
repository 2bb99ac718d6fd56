// SPDX-License-Identifier: Apache-2.0
#include "golden/engine_golden.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "engine/bands.hpp"
#include "engine/drawn_scene.hpp"
#include "engine/rows.hpp"
#include "golden/candidate.hpp"
#include "golden/channel.hpp"
#include "golden/depth.hpp"
#include "golden/distance.hpp"
#include "golden/edge_walk.hpp"
#include "golden/fog.hpp"
#include "golden/lanes.hpp"
#include "golden/light.hpp"
#include "golden/line_walk.hpp"
#include "golden/lines.hpp"
#include "golden/lod.hpp"
#include "golden/mask.hpp"
#include "golden/merge.hpp"
#include "golden/mip_chain.hpp"
#include "golden/plane_walk.hpp"
#include "golden/precision.hpp"
#include "golden/project.hpp"
#include "golden/setup.hpp"
#include "golden/setup_plane.hpp"
#include "golden/span.hpp"
#include "golden/span_setup.hpp"
#include "golden/stencil.hpp"
#include "golden/target.hpp"
#include "golden/texture.hpp"
#include "golden/texture_second.hpp"

namespace bitspan {

namespace {

using namespace golden;

// Channels that depth and the first texture unit read in the place of a fragment's field.
constexpr std::array<std::pair<LineId, FieldOf<FragmentRecord>>, 5> replaced_fields{{
    {LineId::z, &FragmentRecord::h},
    {LineId::shade_r, &FragmentRecord::r},
    {LineId::shade_g, &FragmentRecord::g},
    {LineId::shade_b, &FragmentRecord::b},
    {LineId::shade_a, &FragmentRecord::a},
}};

class GoldenEngine final : public Engine, public RowEngine, public BandEngine {
 public:
  GoldenEngine(const Config& config, Precision precision, bool checked)
      : config_(config), checked_(checked), precision_(std::move(precision)) {
    texture_ = make_texture(with(precision_.texture), config_);
    if (has_lod(config_)) mip_texture_ = make_mip_texture(with(precision_.texture), config_);
    texture_second_ = make_texture_second(with(precision_.texture_second), config_);
    merge_ = make_merge(with(precision_.merge), config_);
  }

  std::string_view name() const override { return "golden"; }
  const Frame& frame() const override { return frame_; }
  const Counters& counters() const override { return counters_; }

  void begin(const Scene& scene) override {
    band_.reset();
    start(scene);
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    again_ = false;
    draw_all(triangles, first_index, trace);
  }

  void begin_band(const Scene& scene, const Band& band) override {
    band_ = band;
    start(scene);
  }
  void draw_again(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    again_ = true;
    draw_all(triangles, first_index, trace);
  }
  std::uint64_t rows_above() const override { return rows_above_; }

  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    std::visit([&](const auto& what) { run(what, next_index, trace); }, command.what);
  }

  PlaneOfRows set_plane(const SetupRecord& setup) override {
    plane_walk_(setup, {}, planes_);
    return {planes_.plane.major == 1, planes_.rows};
  }
  void draw_row(const AnyRow& any, std::size_t plane_row, int texture, Trace* trace) override {
    check_draws_rows(config_, any);
    again_ = false;
    Trace& out = begin_batch(trace);
    const std::size_t first_span = out.span.size();
    first_ = out.fragment.size();
    first_channel_ = out.fragment_channel.size();
    back_ = false;
    if (const auto* row = std::get_if<RowRecord>(&any)) {
      out.row.push_back(*row);
      out.span.push_back(span_of(*row, {}, out));
    } else if (const auto* of_plane = std::get_if<PlaneRowRecord>(&any)) {
      out.plane_row.push_back(*of_plane);
      out.span.push_back(span_of(*of_plane));
    } else {
      ++counters_.rows;
      if (by_planes()) --counters_.divides_saved;
      out.span.push_back(std::get<SpanRecord>(any));
    }
    std::span<const std::uint8_t> covered;
    if (by_planes()) {
      covered = planes_.covered;
      for (const PlaneRowRecord& before : std::span(planes_.rows).first(plane_row)) {
        covered = covered.subspan(static_cast<std::size_t>(before.count));
      }
    }
    draw_spans(first_span, {.plane = by_planes() ? &planes_.plane : nullptr, .covered = covered},
               image(texture), out);
    unkept_.clear();
  }

 private:
  void start(const Scene& scene) {
    scene_.begin(scene);
    prepare_view();
    levels_ = scene_levels(config_, scene);
    uv_ulp_ = std::ldexp(1.0, -config_.format(FormatId::span_uv).fraction());

    state_ = first_state(config_);
    back_ = false;
    counters_ = {};
    rows_above_ = 0;
    targets_ = {};
    take_rows(targets_.current());
    clear_target();
  }
  void draw_all(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) {
    Trace& out = begin_batch(trace);
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) {
      draw_one(triangle, index++, out);
      unkept_.clear();
    }
  }
  void run(const StateChange& change, std::int64_t next_index, Trace* trace) {
    state_ = changed_state(state_, change, config_, scene_->textures.size());
    make_ready();
    if (trace != nullptr) begin_batch(trace).state.push_back(state_record(state_, next_index));
  }
  void run(const Clear& clear, std::int64_t /*next_index*/, Trace* /*trace*/) {
    const auto farthest = static_cast<std::uint32_t>(clear_depth(config_));
    if (clear.masked) return clear_masked(frame_, state_, held(state_, clear), farthest);
    clear_planes(frame_, held(state_, clear), farthest);
  }
  void run(const Target& target, std::int64_t /*next_index*/, Trace* /*trace*/) {
    const std::uint64_t before = scene_.version();
    scene_.run(target);
    take_scene(before);
    take_rows(target.k);
    if (!targets_.select(target.k, frame_)) clear_target();
    make_ready();
  }
  void run(const ViewChange& change, std::int64_t /*next_index*/, Trace* /*trace*/) {
    const std::uint64_t before = scene_.version();
    const int width = scene_->width;
    const int height = scene_->height;
    scene_.run(change);
    take_scene(before);
    if (scene_->width == width && scene_->height == height) return;
    clear_target();
    make_ready();
  }
  void run(const Copy& copy, std::int64_t /*next_index*/, Trace* /*trace*/) {
    check_copy(*scene_, scene_.views(), copy);
    const std::uint64_t before = scene_.version();
    scene_.run(copy, targets_.of(copy.target, frame_), config_.depth_bits);
    take_scene(before);
  }
  void run(const Resolve& /*resolve*/, std::int64_t /*next_index*/, Trace* trace) {
    Trace& out = begin_batch(trace);
    std::vector<FragmentRecord> fragments;
    std::vector<DepthRecord> depths;
    std::vector<TextureRecord> textures;
    std::vector<FogRecord> fogs;
    for (std::int64_t y = frame_.first_row; y < frame_.first_row + frame_.height; ++y) {
      for (std::int64_t x = 0; x < frame_.width && !frame_.candidates.empty(); ++x) {
        Candidate& held = frame_.candidates[pixel_at(x, y)];
        if (held.a == 0) continue;
        fragments.push_back({.triangle = held.triangle, .x = x, .y = y, .u = held.u, .v = held.v});
        depths.push_back({.triangle = held.triangle, .x = x, .y = y, .z = held.z});
        textures.push_back({.triangle = held.triangle, .x = x, .y = y, .a = held.a});
        fogs.push_back({.triangle = held.triangle, .x = x, .y = y, .r = held.r, .g = held.g, .b = held.b});
        held = {};
      }
    }
    alive_.clear();
    depths_.clear();
    textures_.clear();
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      alive_.push_back(&fragments[i]);
      depths_.push_back(&depths[i]);
      textures_.push_back(&textures[i]);
    }
    run_merge(fogs, out);
    unkept_.clear();
  }
  // Gives the frame the planes that the draw state asks for.
  void make_ready() {
    if (state_.stencil_test) need_stencil(frame_);
    if (holds_candidates(state_.translucency_pass)) need_candidates(frame_);
  }
  // What depends on the view.
  void prepare_view() {
    const Scene& scene = *scene_;
    constants_ = make_constants(config_, scene);
    constants_delivered_ = false;
    setup_ = make_setup(with(precision_.setup), config_, constants_);
    if (by_planes()) {
      plane_walk_ =
          make_plane_walk(with(precision_.plane_walk), config_, constants_, scene.width, scene.height);
      plane_span_setup_ = make_plane_span_setup(with(precision_.span_setup), config_, constants_);
    } else {
      edge_setup_ = make_edge_setup(with(precision_.edge_setup), config_, constants_);
      edge_walk_ = make_edge_walk(with(precision_.edge_walk), config_, constants_, scene.width, scene.height);
      if (has_setup_plane(config_)) {
        setup_plane_ = make_setup_plane(with(precision_.setup_plane), config_, constants_);
        triangle_span_setup_ = make_triangle_span_setup(with(precision_.span_setup), config_, constants_);
      } else {
        span_setup_ = make_span_setup(with(precision_.span_setup), config_, constants_);
      }
    }
    line_walk_ = make_line_walk(config_, scene.width, scene.height);
    span_ = make_span(with(precision_.span), config_, constants_);
    if (has_setup_gradients(config_)) {
      gradients_ = make_gradients(with(precision_.gradient), config_, constants_);
    }
    if (has_distance(config_)) {
      distance_ = make_distance(with(precision_.distance), config_, constants_, scene);
    }
    if (has_lod(config_)) {
      lod_ = make_lod(with(precision_.lod), config_, constants_);
    }
    if (has_project(config_.project)) {
      project_ = make_project(with(precision_.project), config_, constants_);
    }
    depth_ = make_depth(with(precision_.depth), config_, constants_);
    light_ = has_light(config_.light) && scene.light
                 ? make_light(with(precision_.light), config_, constants_, scene)
                 : LightStage();
    fog_ = make_fog(with(precision_.fog), config_, constants_, scene);
  }
  // Prepares what the scene has become since that version.
  void take_scene(std::uint64_t since) {
    if (scene_.view_version() > since) prepare_view();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (scene_.texture_version(i) > since) levels_[i] = mip_levels(scene_->textures[i]);
    }
  }
  // The rows of target k that are drawn.
  void take_rows(int k) { rows_ = band_ && band_->target == k ? band_->rows : RowRange{}; }
  void clear_target() {
    const RowRange rows = rows_.within(scene_->height);
    clear_frame(frame_, scene_->width, static_cast<int>(rows.end - rows.first), scene_->background,
                static_cast<std::uint32_t>(clear_depth(config_)));
    frame_.first_row = static_cast<int>(rows.first);
  }
  // Of a pixel in the frame's planes.
  std::size_t pixel_at(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>(frame_.grid().place(x, y));
  }
  // Where events of the triangle under way are counted that it has once, however many bands draw it.
  Counters& of_triangle() { return again_ ? elsewhere_ : counters_; }
  // Returns where records go.
  Trace& begin_batch(Trace* trace) {
    if (trace != nullptr && !constants_delivered_) {
      trace->constants.push_back(constants_.record);
      constants_delivered_ = true;
    }
    return trace != nullptr ? *trace : unkept_;
  }
  const Texture* image(int texture) const {
    return texture < 0 ? nullptr : &scene_->textures.at(static_cast<std::size_t>(texture));
  }
  // channels: of the row.
  SpanRecord span_of(const RowRecord& row, std::span<const RowChannelRecord> channels, Trace& out) {
    ++counters_.rows;
    if (has_setup_plane(config_)) {
      return triangle_span_setup_(row, setup_record_, plane_, channels_, out.span_channel);
    }
    if (row.r_x > row.l_x) {
      counters_.divides_row += shares_reciprocal(form_of(config_.row_slope)) ? 1 : lines();
    }
    return span_setup_(row, channels, out.span_channel);
  }
  SpanRecord span_of(const PlaneRowRecord& row) {
    ++of_triangle().rows;
    ++of_triangle().divides_row;
    --of_triangle().divides_saved;
    return plane_span_setup_(planes_.plane, row);
  }

  Arithmetic with(Width width) const { return {width, checked_}; }
  bool by_planes() const { return has_plane_rows(config_.perspective); }
  // Of a triangle.
  std::size_t lines() const { return fixed_lines + constants_.channels.size(); }

  void draw_one(const Triangle& triangle, std::int64_t index, Trace& out) {
    Counters& once = of_triangle();
    ++once.triangles;
    channels_.clear();
    const std::optional<SetupRecord> setup = setup_(triangle, index, channels_);
    if (!setup) {
      ++once.degenerate;
      return;
    }
    if (!again_) out.setup.push_back(*setup);
    if (triangle.is_line) {
      back_ = false;
      first_ = out.fragment.size();
      first_channel_ = out.fragment_channel.size();
      draw_line(*setup, image(triangle.texture), out);
      return;
    }
    if (has_setup_gradients(config_)) {
      gradient_ = gradients_(*setup);
      if (!again_) out.gradient.push_back(gradient_);
      if (!by_planes()) once.divides_edge += 6;
    }
    const Texture* texture = image(triangle.texture);
    back_ = state_.stencil_test && runs_clockwise(config_, triangle);
    first_ = out.fragment.size();
    first_channel_ = out.fragment_channel.size();
    if (by_planes()) {
      draw_planes(*setup, texture, out);
    } else {
      draw_rows(*setup, texture, out);
    }
  }

  void draw_rows(const SetupRecord& setup, const Texture* texture, Trace& out) {
    std::array<EdgeRecord, 3> edges;
    const int edge_count = edge_setup_(setup, edges, channels_);
    const std::span<const EdgeRecord> with_height(edges.data(), static_cast<std::size_t>(edge_count));
    const bool by_plane = has_setup_plane(config_);
    const bool shared = shares_reciprocal(config_.edge_slope);
    const std::size_t slopes = (by_plane ? 0 : lines()) + (has_x_step(config_) ? 1 : 0);
    of_triangle().divides_edge += static_cast<std::size_t>(edge_count) * (shared && slopes > 0 ? 1 : slopes);
    if (by_plane) {
      setup_record_ = setup;
      plane_ = setup_plane_(setup, channels_);
      if (!again_) out.setup_plane.push_back(plane_);
      of_triangle().divides_edge += shared ? 1 : 2 * lines();
    }
    if (!again_) {
      out.setup_channel.insert(out.setup_channel.end(), channels_.begin(), channels_.end());
      out.edge.insert(out.edge.end(), with_height.begin(), with_height.end());
    }

    const std::size_t first_row = out.row.size();
    const std::size_t first_row_channel = out.row_channel.size();
    rows_above_ += static_cast<std::uint64_t>(
        edge_walk_(setup, with_height, channels_, rows_, out.row, out.row_channel));
    std::span<const RowChannelRecord> row_channels = std::span(out.row_channel).subspan(first_row_channel);
    const std::size_t of_row = by_plane ? 0 : channels_.size();
    const std::size_t first_span = out.span.size();
    for (std::size_t i = first_row; i < out.row.size(); ++i) {
      if (!by_plane && !has_linear_edges(config_.perspective)) counters_.divides_edge += 2;
      out.span.push_back(span_of(out.row[i], row_channels.first(of_row), out));
      row_channels = row_channels.subspan(of_row);
    }
    draw_spans(first_span, {}, texture, out);
  }

  void draw_planes(const SetupRecord& setup, const Texture* texture, Trace& out) {
    plane_walk_(setup, channels_, planes_);
    of_triangle().divides_edge += 2 * lines() + 1;  // gradients and k
    plane_spans_.clear();
    for (const PlaneRowRecord& row : planes_.rows) plane_spans_.push_back(span_of(row));
    if (!again_) {  // else another band has delivered what is once per row
      out.setup_channel.insert(out.setup_channel.end(), channels_.begin(), channels_.end());
      out.plane.push_back(planes_.plane);
      out.plane_row.insert(out.plane_row.end(), planes_.rows.begin(), planes_.rows.end());
      out.span.insert(out.span.end(), plane_spans_.begin(), plane_spans_.end());
      out.span_channel.insert(out.span_channel.end(), planes_.channels.begin(), planes_.channels.end());
    }
    draw_spans(plane_spans_, planes_.channels, {.plane = &planes_.plane, .covered = planes_.covered}, texture,
               out);
  }

  void draw_line(const SetupRecord& setup, const Texture* texture, Trace& out) {
    const std::optional<LineWalkRecord> line = line_walk_(setup);
    if (!line) return;
    out.line_walk.push_back(*line);
    if (has_line_slope(config_.line_walk)) ++counters_.divides_edge;
    SpanRecord span = span_of(row_of(*line), {}, out);
    if (line->major == 1) std::swap(span.x, span.y);
    if (has_line_slope(config_.line_walk)) span.phase = line->phase;
    const std::size_t first_span = out.span.size();
    out.span.push_back(span);
    draw_spans(first_span, {.line = &*line}, texture, out);
  }

  // The triangle's spans, those from first_span on, as many at a time as make a batch of fragments.
  void draw_spans(std::size_t first_span, SpanPath path, const Texture* texture, Trace& out) {
    const std::span spans = std::span<const SpanRecord>(out.span).subspan(first_span);
    const std::size_t of_spans = spans.size() * constants_.channels.size();
    draw_spans(spans, std::span<const SpanChannelRecord>(out.span_channel).last(of_spans), path, texture,
               out);
  }
  void draw_spans(std::span<const SpanRecord> spans, std::span<const SpanChannelRecord> channels,
                  SpanPath path, const Texture* texture, Trace& out) {
    const std::size_t of_span = constants_.channels.size();
    std::size_t begin = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < spans.size(); ++i) {
      count += static_cast<std::size_t>(spans[i].count);
      if (count < lanes && i + 1 < spans.size()) continue;
      SpanPath of_batch = path;
      if (path.plane != nullptr) of_batch.covered = path.covered.first(count);
      span_(spans.subspan(begin, i + 1 - begin), channels.subspan(begin * of_span, (i + 1 - begin) * of_span),
            of_batch, out.fragment, out.fragment_channel);
      if (path.plane != nullptr && rows_ != RowRange{}) keep_rows_drawn(out);
      counters_.fragments += out.fragment.size() - first_;
      if (has_pixel_reciprocal(config_.perspective)) counters_.divides_pixel += count;
      if (has_subspans(config_)) {
        // A subspan has one exact fragment; what is behind the last of them is exact.
        const std::int64_t length = std::int64_t{1} << config_.subspan_bits;
        for (const SpanRecord& span : spans.subspan(begin, i + 1 - begin)) {
          const std::int64_t subspans = (span.count - 1) / length;
          counters_.divides_pixel -= static_cast<std::uint64_t>(subspans * (length - 1));
        }
      }
      if (has_pixel_quotients(config_.perspective)) {
        const auto divided = std::ranges::count_if(
            constants_.channels, [&](LineId id) { return line_of(id, config_.perspective).span_divides; });
        counters_.divides_pixel += (2 + static_cast<std::size_t>(divided)) * count;
      }
      draw_fragments(texture, out);
      if (path.plane != nullptr) path.covered = path.covered.subspan(count);
      begin = i + 1;
      count = 0;
    }
  }

  // Of the fragments from first_ on those in the rows drawn: a row of const_depth_rows has pixels of several.
  void keep_rows_drawn(Trace& out) {
    const std::size_t each = constants_.channels.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; first_ + i < out.fragment.size(); ++i) {
      if (!rows_.has(out.fragment[first_ + i].y)) continue;
      out.fragment[first_ + kept] = out.fragment[first_ + i];
      for (std::size_t c = 0; c < each; ++c) {
        out.fragment_channel[first_channel_ + kept * each + c] =
            out.fragment_channel[first_channel_ + i * each + c];
      }
      ++kept;
    }
    out.fragment.resize(first_ + kept);
    out.fragment_channel.resize(first_channel_ + kept * each);
  }

  // Takes the fragments from first_ on to the frame, stage by stage: they are of one triangle, so each lies
  // at a pixel of its own and their order does not matter to the frame.
  void draw_fragments(const Texture* texture, Trace& out) {
    const std::span fragments = std::span<const FragmentRecord>(out.fragment).subspan(first_);
    alive_.clear();
    depths_.clear();
    textures_.clear();
    distances_.clear();
    put_channels(fragments, out);
    std::size_t covered = 0;
    for (const FragmentRecord& fragment : fragments) {
      if (fragment.covered == 0) continue;
      ++covered;
      if (is_masked(state_, fragment.x, fragment.y)) {
        ++counters_.masked;
      } else {
        alive_.push_back(&fragment);
      }
    }
    counters_.covered += covered;
    if (by_planes()) counters_.divides_saved += static_cast<std::int64_t>(covered);
    if (is_late(state_.depth_when)) {
      run_texture(texture, out);
      run_depth(fragments, covered, out);
    } else {
      run_depth(fragments, covered, out);
      run_texture(texture, out);
    }
    alive_channels_.clear();
    for (std::size_t i = 0; i < alive_.size() && !constants_.channels.empty(); ++i) {
      alive_channels_.push_back(channels_of(*alive_[i], out));
    }
    if (light_) run_light(out);
    const std::size_t first_fog = out.fog.size();
    fog_(alive_, textures_, distances_, alive_channels_, out.fog);
    const std::span<const FogRecord> fogs = std::span(out.fog).subspan(first_fog);
    if (holds_candidates(state_.translucency_pass)) {
      run_candidate(fogs, out);
    } else {
      run_merge(fogs, out);
    }
    if (&out == &unkept_) out.clear_pixels();
    first_ = out.fragment.size();
    first_channel_ = out.fragment_channel.size();
  }

  // Holds those alive that are the farthest ones of their pixels.
  void run_candidate(std::span<const FogRecord> fogs, Trace& out) {
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      Candidate& held = frame_.candidates[pixel_at(fogs[i].x, fogs[i].y)];
      out.candidate.push_back(candidate(config_, *alive_[i], *depths_[i], *textures_[i], fogs[i], held));
    }
    counters_.candidates += alive_.size();
  }

  // Merges those alive into the frame, of which each pixel has one at most.
  void run_merge(std::span<const FogRecord> fogs, Trace& out) {
    counters_.written += alive_.size();
    const std::size_t first_merge = out.merge.size();
    const std::size_t first_alpha = out.merge_alpha.size();
    merge_(fogs, textures_, depths_, state_, frame_.color, frame_.grid(), out.merge, out.merge_alpha);
    const WriteMask mask{state_.color_write, state_.depth_write, state_.color_mask};
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      write_fragment(frame_, *alive_[i], out.merge[first_merge + i], uv_ulp_, mask);
    }
    if (mask.stores(3)) {
      for (const MergeAlphaRecord& merged : std::span(out.merge_alpha).subspan(first_alpha)) {
        frame_.color[4 * pixel_at(merged.x, merged.y) + 3] = static_cast<std::uint8_t>(merged.a);
      }
    }
  }

  // Makes drawn_, the fragments as depth and texture read them, where channels stand for some of their
  // fields.
  void put_channels(std::span<const FragmentRecord> fragments, const Trace& out) {
    drawn_.clear();
    if (!has_own_depth(config_.depth_line) && !has_perspective_shades(config_.shade_lines)) return;
    drawn_.assign(fragments.begin(), fragments.end());
    for (const auto& [channel, field] : replaced_fields) {
      const std::ptrdiff_t place = place_of(constants_, channel);
      if (place == std::ssize(constants_.channels)) continue;
      for (std::size_t i = 0; i < fragments.size(); ++i) {
        drawn_[i].*field = channels_of(fragments[i], out)[place].w;
      }
    }
  }
  const FragmentRecord& drawn(const FragmentRecord& fragment, const Trace& out) const {
    return drawn_.empty() ? fragment : drawn_[static_cast<std::size_t>(&fragment - &out.fragment[first_])];
  }
  // Those alive, as the first texture unit reads them.
  std::span<const FragmentRecord* const> textured(const Trace& out) {
    if (drawn_.empty()) return alive_;
    drawn_alive_.clear();
    for (const FragmentRecord* fragment : alive_) drawn_alive_.push_back(&drawn(*fragment, out));
    return drawn_alive_;
  }

  // The first of the channels in use of a fragment in out.
  const FragmentChannelRecord* channels_of(const FragmentRecord& fragment, const Trace& out) const {
    const auto at = static_cast<std::size_t>(&fragment - &out.fragment[first_]);
    return &out.fragment_channel[first_channel_ + at * constants_.channels.size()];
  }

  // Leaves in alive_, depths_ and textures_ what passes the tests. `all`: the fragments of which `covered`
  // cover their pixel.
  void run_depth(std::span<const FragmentRecord> all, std::size_t covered, Trace& out) {
    const std::size_t first = out.depth.size();
    if (alive_.size() == covered) {
      depth_(drawn_.empty() ? all : std::span<const FragmentRecord>(drawn_), gradient_, state_, frame_.depth,
             frame_.grid(), out.depth);
    } else {
      tested_.clear();
      for (const FragmentRecord* fragment : alive_) tested_.push_back(drawn(*fragment, out));
      depth_(tested_, gradient_, state_, frame_.depth, frame_.grid(), out.depth);
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      const DepthRecord& depth = out.depth[first + i];
      bool passes = depth.pass == 1;
      if (state_.stencil_test) {
        std::uint8_t& plane = frame_.stencil[pixel_at(depth.x, depth.y)];
        out.stencil.push_back(stencil(state_, back_, depth, plane));
        plane = static_cast<std::uint8_t>(out.stencil.back().value);
        if (out.stencil.back().pass == 0) ++counters_.stencil_failed;
        passes = passes && out.stencil.back().pass == 1;
      }
      if (!passes) continue;
      alive_[kept++] = alive_[i];
      depths_.push_back(&depth);
      if (!textures_.empty()) textures_[kept - 1] = textures_[i];
      if (!distances_.empty()) distances_[kept - 1] = distances_[i];
    }
    alive_.resize(kept);
    if (!textures_.empty()) textures_.resize(kept);
    if (!distances_.empty()) distances_.resize(kept);
    counters_.depth_passed += kept;
  }
  // The same for what the texture does not kill.
  void run_texture(const Texture* texture, Trace& out) {
    const std::size_t first = out.texture.size();
    const std::size_t first_distance = out.distance.size();
    const std::size_t first_lod = out.lod.size();
    if (has_distance(config_)) distance_(alive_, out.distance);
    const std::span distances = std::span<const DistanceRecord>(out.distance).subspan(first_distance);
    if (has_lod(config_)) {
      const std::vector<Texture>* levels =
          texture == nullptr ? nullptr
                             : &levels_[static_cast<std::size_t>(texture - scene_->textures.data())];
      lod_(alive_, gradient_, distances, levels == nullptr ? 1 : static_cast<int>(levels->size()), state_,
           out.lod);
      mip_texture_(textured(out), std::span<const LodRecord>(out.lod).subspan(first_lod), levels, state_,
                   out.texture);
    } else {
      texture_(textured(out), texture, state_, out.texture);
    }
    std::span textured_all = std::span<const TextureRecord>(out.texture).subspan(first);
    if (has_second_texture(state_)) {
      run_texture_second(textured_all, std::span<const LodRecord>(out.lod).subspan(first_lod), out);
      textured_all = combined_;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      const TextureRecord& textured = textured_all[i];
      if (textured.killed == 1) {
        ++counters_.killed;
        continue;
      }
      alive_[kept++] = alive_[i];
      if (!depths_.empty()) depths_[kept - 1] = depths_[i];
      textures_.push_back(&textured);
      if (!distances.empty()) distances_.push_back(&distances[i]);
    }
    alive_.resize(kept);
    if (!depths_.empty()) depths_.resize(kept);
  }

  // Leaves in textures_ what fog reads.
  void run_light(Trace& out) {
    const std::size_t first = out.light.size();
    light_(alive_, textures_, distances_, alive_channels_, state_, out.light);
    lit_.clear();
    for (std::size_t i = 0; i < textures_.size(); ++i) {
      const LightRecord& light = out.light[first + i];
      TextureRecord& record = lit_.emplace_back(*textures_[i]);
      record.r = light.r;
      record.g = light.g;
      record.b = light.b;
    }
    for (std::size_t i = 0; i < textures_.size(); ++i) textures_[i] = &lit_[i];
  }

  // Leaves in combined_ what the first unit's records are behind the second one. lods: none without mip
  // chains.
  void run_texture_second(std::span<const TextureRecord> firsts, std::span<const LodRecord> lods,
                          Trace& out) {
    std::vector<const FragmentRecord*> fragments;
    std::vector<const TextureRecord*> before;
    std::vector<const LodRecord*> levels;
    std::vector<const FragmentChannelRecord*> channels;
    for (std::size_t i = 0; i < firsts.size(); ++i) {
      if (firsts[i].killed == 1) continue;
      fragments.push_back(alive_[i]);
      before.push_back(&firsts[i]);
      if (!lods.empty()) levels.push_back(&lods[i]);
      if (!constants_.channels.empty()) channels.push_back(channels_of(*alive_[i], out));
    }
    std::size_t next = out.texture_second.size();
    const auto index = static_cast<std::size_t>(state_.texture1);
    const std::span<const Texture> images =
        has_lod(config_) ? std::span<const Texture>(levels_[index]) : std::span(&scene_->textures[index], 1);
    const std::size_t first_project = out.project.size();
    if (is_projected(state_)) project_(fragments, channels, images.front(), out.project);
    std::vector<FragmentRecord> own;
    if (has_second_coordinates(config_.second_coordinates)) {
      const std::ptrdiff_t u2 = place_of(constants_, LineId::u2);
      const std::ptrdiff_t v2 = place_of(constants_, LineId::v2);
      for (std::size_t i = 0; i < fragments.size(); ++i) {
        own.push_back(*fragments[i]);
        own.back().u = channels[i][u2].w;
        own.back().v = channels[i][v2].w;
      }
      for (std::size_t i = 0; i < fragments.size(); ++i) fragments[i] = &own[i];
    }
    texture_second_(fragments, before, levels, std::span(out.project).subspan(first_project), images, state_,
                    out.texture_second);
    combined_.assign(firsts.begin(), firsts.end());
    for (TextureRecord& record : combined_) {
      if (record.killed == 1) continue;
      const TextureSecondRecord& second = out.texture_second[next++];
      record.r = second.r;
      record.g = second.g;
      record.b = second.b;
      record.a = second.a;
      record.killed = second.killed;
      record.texel_r = second.texel_r;
      record.texel_g = second.texel_g;
      record.texel_b = second.texel_b;
    }
  }

  Config config_;
  bool checked_;
  Precision precision_;
  DrawnScene scene_;
  Constants constants_;
  bool constants_delivered_ = false;  // once per view, in front of its first record
  double uv_ulp_ = 1;
  SetupStage setup_;
  EdgeSetupStage edge_setup_;
  SetupPlaneStage setup_plane_;
  EdgeWalkStage edge_walk_;
  PlaneWalkStage plane_walk_;
  LineWalkStage line_walk_;
  SpanSetupStage span_setup_;
  TriangleSpanSetupStage triangle_span_setup_;
  PlaneSpanSetupStage plane_span_setup_;
  SpanStage span_;
  DepthStage depth_;
  GradientStage gradients_;
  DistanceStage distance_;
  LodStage lod_;
  TextureStage texture_;
  MipTextureStage mip_texture_;
  ProjectStage project_;
  TextureSecondStage texture_second_;
  LightStage light_;  // where it is on
  FogStage fog_;
  MergeStage merge_;
  SceneLevels levels_;
  GradientRecord gradient_;  // of the triangle under way, where there is one
  // Of the triangle under way, where slope.row = plane.
  SetupRecord setup_record_;
  SetupPlaneRecord plane_;
  std::vector<SetupChannelRecord> channels_;  // of the triangle under way, those in use
  // Reused from triangle to triangle.
  PlaneRows planes_;
  Trace unkept_;                   // records of one triangle that nobody asked for
  std::size_t first_ = 0;          // of the fragments that are not yet in the frame
  std::size_t first_channel_ = 0;  // of their channels
  // The fragments of a batch that are alive, and their records.
  std::vector<const FragmentRecord*> alive_;
  std::vector<const DepthRecord*> depths_;
  std::vector<const TextureRecord*> textures_;  // behind both texture units, and light
  std::vector<TextureRecord> combined_, lit_;
  std::vector<const DistanceRecord*> distances_;              // where there are any
  std::vector<const FragmentChannelRecord*> alive_channels_;  // the first of each, where any are in use
  std::vector<FragmentRecord> tested_;
  // As depth and texture read them, where channels stand for fields: of all, and of those alive.
  std::vector<FragmentRecord> drawn_;
  std::vector<const FragmentRecord*> drawn_alive_;
  Frame frame_;
  Targets<Frame> targets_;
  Counters counters_;
  std::optional<Band> band_;  // none: whole pictures
  RowRange rows_;             // of the target drawn on that are drawn
  bool again_ = false;        // the triangle under way is another band's, too
  Counters elsewhere_;        // what that one counts
  std::uint64_t rows_above_ = 0;
  std::vector<SpanRecord> plane_spans_;  // of the triangle under way
  DrawState state_;
  bool back_ = false;  // the triangle is a back face
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
