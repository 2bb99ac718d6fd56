// SPDX-License-Identifier: Apache-2.0
#include "model/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "config/modes.hpp"
#include "scene/texels.hpp"

namespace bitspan::model {

void check_scene(const Scene& scene) {
  const auto refuse = [&](const std::string& what) {
    throw InputError("scene '" + scene.name + "': " + what);
  };
  constexpr std::int64_t largest = 1 << 20;
  if (scene.width < 1 || scene.height < 1 || scene.width > largest || scene.height > largest) {
    refuse("the picture's size " + std::to_string(scene.width) + "x" + std::to_string(scene.height) +
           " is not within 1.." + std::to_string(largest));
  }
  for (const Texture& t : scene.textures) {
    if (!is_whole(t)) {
      refuse("texture '" + t.name + "' is empty, or its pixels do not match its size");
    }
  }
}

namespace {

[[noreturn]] void refuse_vertex(std::int64_t index, std::size_t vertex, const std::string& what) {
  throw InputError("triangle " + std::to_string(index) + ", vertex " + std::to_string(vertex) + ": " + what);
}

}  // namespace

template <class Watch>
Pipeline make_pipeline(const Config& config, const Scene& scene, Watch watch) {
  check_scene(scene);
  Pipeline p;
  p.const_depth_rows = has_plane_rows(config.perspective);
  p.constants = make_constants(config, scene, watch);
  p.setup = prepare_setup(config, p.constants);
  p.edge_walk = prepare_edge_walk(config, p.constants, scene.width, scene.height);
  p.plane_walk = prepare_plane_walk(config, p.constants, scene.width, scene.height);
  p.span_setup = prepare_span_setup(config, p.constants);
  p.span = prepare_span(config, p.constants);
  p.depth = prepare_depth(config, p.constants);
  p.has_lod = has_lod(config);
  p.has_gradients = has_lod_gradients(config);
  if (p.has_lod) {
    p.lod = prepare_lod(config, p.constants, watch);
    p.mip_chains = MipChains(config, scene);
  }
  p.texture = prepare_texture(config);
  p.fog = prepare_fog(config, p.constants, scene, watch);
  p.merge = prepare_merge(config);
  p.first = first_state(config);
  set_state(p, p.first);
  return p;
}

void set_state(Pipeline& pipeline, const DrawState& state) {
  pipeline.state = state;
  pipeline.depth.func = state.depth_func;
  pipeline.depth.bias = state.depth_bias;
  pipeline.texture.alpha_func = state.alpha_func;
  pipeline.texture.alpha_ref = state.alpha_ref;
  pipeline.stencil = prepare_stencil(state);
  set_blend(pipeline.merge, blend_of(state));
}

StateRecord change_state(Pipeline& pipeline, const Config& config, const StateChange& change,
                         std::int64_t next_index) {
  set_state(pipeline, changed_state(pipeline.state, change, config));
  return state_record(pipeline.state, next_index);
}

void prepare_frame(const Pipeline& pipeline, Frame& frame) {
  if (pipeline.stencil.test) need_stencil(frame);
  if (pipeline.merge.changes_alpha) frame.full_alpha = false;
}

bool is_drawn(const DrawState& s, std::int64_t x, std::int64_t y) {
  return x >= s.scissor_left && x < s.scissor_right && y >= s.scissor_top && y < s.scissor_bottom &&
         ((s.stipple >> (8 * (y & 3) + (x & 7))) & 1) != 0;
}

Surface surface_of(const Pipeline& pipeline, const Triangle& triangle) {
  return {triangle.texture, pipeline.stencil.test && is_back_face(pipeline.setup, triangle)};
}

void check_triangle(const Scene& scene, const Triangle& triangle, std::int64_t index) {
  const auto text = [](double v) {
    std::ostringstream out;
    out << v;
    return out.str();
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& v = triangle.v[i];
    for (const double number : {v.x, v.y, v.u, v.v}) {
      if (!std::isfinite(number)) {
        refuse_vertex(index, i, "a coordinate is " + text(number) + ", a finite number is needed");
      }
    }
    if (!(v.s >= scene.s_min && v.s <= scene.s_max)) {
      refuse_vertex(index, i,
                    "s " + text(v.s) + " is outside s_min.." + "s_max, " + text(scene.s_min) + ".." +
                        text(scene.s_max));
    }
    for (const double c : v.c) {
      if (!(c >= 0 && c <= 1)) {
        refuse_vertex(index, i, "colour or alpha " + text(c) + " is outside 0..1");
      }
    }
  }
  if (triangle.texture >= static_cast<int>(scene.textures.size())) {
    throw InputError("triangle " + std::to_string(index) + ": texture " + std::to_string(triangle.texture) +
                     " does not exist, the scene has " + std::to_string(scene.textures.size()));
  }
}

void Rows::clear() {
  rows.clear();
  plane_rows.clear();
  planes.clear();
  plane_of.clear();
  gradients.clear();
}

template <class Watch>
bool triangle_to_rows(const Pipeline& pipeline, const Triangle& triangle, std::int64_t index,
                      PlaneWalkState& walk, Rows& out, Counters& counters, Trace* trace, Watch watch) {
  ++counters.triangles;
  SetupRecord vertices;
  if (!setup(pipeline.setup, triangle, index, vertices, watch)) {
    ++counters.degenerate;
    return false;
  }
  deliver(trace, vertices);
  if (pipeline.has_gradients) {
    out.gradients.push_back(setup_gradients(pipeline.plane_walk, vertices, watch));
    deliver(trace, out.gradients.back());
    if (!pipeline.const_depth_rows) counters.divides_edge += divides_per_gradients;
  }
  if (pipeline.const_depth_rows) {
    start_plane_walk(pipeline.plane_walk, vertices, walk, watch);
    deliver(trace, walk.record);
    const auto plane = static_cast<std::int32_t>(out.planes.size());
    out.planes.push_back(walk.geometry);
    counters.divides_edge += divides_per_plane;
    PlaneRowRecord row;
    while (!finished(walk)) {
      if (plane_walk(pipeline.plane_walk, walk, row, watch)) {
        out.plane_rows.push_back(row);
        out.plane_of.push_back(plane);
        ++counters.rows;
        --counters.divides_saved;
        deliver(trace, row);
      }
    }
    return true;
  }
  const Edges edges = setup_edges(pipeline.setup, vertices, watch);
  const auto edge_count = static_cast<std::size_t>(edges.count);
  counters.divides_edge += edge_count * static_cast<std::size_t>(pipeline.setup.divides_per_edge);
  deliver_all(trace, std::span(edges.edge).first(edge_count));
  EdgeWalkState state = start_edge_walk(pipeline.edge_walk, vertices, edges);
  RowRecord row;
  while (!finished(state)) {
    if (edge_walk(pipeline.edge_walk, state, row, watch)) {
      out.rows.push_back(row);
      ++counters.rows;
      counters.divides_edge += static_cast<std::uint64_t>(pipeline.edge_walk.divides_per_row);
      deliver(trace, row);
    }
  }
  return true;
}

template <class Watch>
SpanRecord row_to_span(const Pipeline& pipeline, const Rows& rows, std::size_t i, Counters& counters,
                       Watch watch) {
  SpanRecord span;
  const int divides = pipeline.const_depth_rows ? span_setup(pipeline.span_setup, rows.plane_rows[i],
                                                             *geometry_of(rows, i), span, watch)
                                                : span_setup(pipeline.span_setup, rows.rows[i], span, watch);
  counters.divides_row += static_cast<std::uint64_t>(divides);
  return span;
}

const GradientRecord* gradient_of(const Rows& rows, std::int64_t triangle) {
  const auto found = std::ranges::lower_bound(rows.gradients, triangle, {}, &GradientRecord::triangle);
  return found == rows.gradients.end() || found->triangle != triangle ? nullptr : &*found;
}

const PlaneGeometry* geometry_of(const Rows& rows, std::size_t i) {
  return rows.plane_of.empty() ? nullptr : &rows.planes[static_cast<std::size_t>(rows.plane_of[i])];
}

template <class Watch>
void span_to_fragments(const Pipeline& pipeline, const SpanRecord& span, const PlaneGeometry* geometry,
                       std::vector<FragmentRecord>& out, Counters& counters, Watch watch) {
  SpanState state = start_span(span, geometry);
  auto at = out.size();
  out.resize(at + static_cast<std::size_t>(span.count));
  std::int64_t covered = 0;
  while (!finished(state)) {
    bitspan::model::span(pipeline.span, state, out[at], watch);
    covered += out[at].covered;
    ++at;
  }
  const auto count = static_cast<std::uint64_t>(span.count);
  counters.fragments += count;
  counters.covered += static_cast<std::uint64_t>(covered);
  counters.divides_pixel += count * static_cast<std::uint64_t>(pipeline.span.divides_per_fragment);
  counters.divides_saved += pipeline.const_depth_rows ? covered : 0;
}

template <class Watch>
void fragment_lod(const Pipeline& pipeline, const FragmentRecord& fragment, const Texture* texture,
                  const GradientRecord* gradient, LodRecord& out, Trace* trace, Watch watch) {
  if (!pipeline.has_lod) return;
  const MipChain* chain = pipeline.mip_chains.of(texture);
  lod(pipeline.lod, fragment, gradient, chain == nullptr ? 1 : static_cast<int>(chain->size()), out, watch);
  deliver(trace, out);
}

template <class Watch>
bool fragment_texture(const Pipeline& pipeline, const FragmentRecord& fragment, const Texture* image,
                      const LodRecord& lod, TextureRecord& out, Watch watch) {
  return pipeline.has_lod
             ? texture(pipeline.texture, pipeline.mip_chains.of(image), fragment, lod, out, watch)
             : texture(pipeline.texture, image, fragment, out, watch);
}

void check_draws_rows(const Pipeline& pipeline) {
  if (!pipeline.has_gradients) return;
  throw InputError(
      "lod.mode = gradient takes gradients of a whole triangle, and a row has none; legal: draw triangles, "
      "or "
      "lod.mode none, zone_s");
}

namespace {

// The fragments of one triangle through depth to merge.
template <class Watch>
struct FragmentDrawing {
  const Pipeline& pipeline;
  const Texture* image;
  const GradientRecord* gradient;
  bool back;
  Frame& frame;
  Counters& counters;
  Trace* trace;
  Watch watch;
  const double uv_ulp = std::ldexp(1.0, -pipeline.texture.uv.fraction);
  const WriteMask mask = write_mask(pipeline.state);
  const bool may_be_masked = masks_pixels(pipeline.state);
  const bool tests_late = is_late(pipeline.state.depth_when);
  DepthRecord z{};
  StencilRecord stencilled{};
  LodRecord level{};
  TextureRecord texel{};
  FogRecord fogged{};
  MergeRecord merged{};

  bool passes(const FragmentRecord& fragment, std::size_t at) {
    bool passed = depth(pipeline.depth, fragment, frame.depth[at], z, watch);
    deliver(trace, z);
    if (pipeline.stencil.test) {
      passed = stencil(pipeline.stencil, back, z, frame.stencil[at], stencilled);
      frame.stencil[at] = static_cast<std::uint8_t>(stencilled.value);
      deliver(trace, stencilled);
      if (stencilled.pass == 0) ++counters.stencil_failed;
    }
    if (passed) ++counters.depth_passed;
    return passed;
  }
  bool lives(const FragmentRecord& fragment) {
    fragment_lod(pipeline, fragment, image, gradient, level, trace, watch);
    const bool alive = fragment_texture(pipeline, fragment, image, level, texel, watch);
    deliver(trace, texel);
    if (!alive) ++counters.killed;
    return alive;
  }
  void draw(const FragmentRecord& fragment) {
    if (may_be_masked && !is_drawn(pipeline.state, fragment.x, fragment.y)) {
      ++counters.masked;
      return;
    }
    const std::size_t at = pixel_of(frame, fragment);
    if (tests_late) {
      if (!lives(fragment) || !passes(fragment, at)) return;
    } else {
      if (!passes(fragment, at) || !lives(fragment)) return;
    }
    fog(pipeline.fog, fragment, texel, fogged, watch);
    deliver(trace, fogged);
    std::uint8_t* color = frame.color.data() + 4 * at;
    merge(pipeline.merge, z, texel, fogged, {color[0], color[1], color[2], color[3]}, merged, watch);
    deliver(trace, merged);
    if (pipeline.merge.changes_alpha) {
      const MergeAlphaRecord alpha = merged_alpha(pipeline.merge, texel, color[3]);
      deliver(trace, alpha);
      if (mask.color) color[3] = static_cast<std::uint8_t>(alpha.a);
    }
    ++counters.written;
    write_fragment(frame, fragment, merged, uv_ulp, mask);
  }
};

}  // namespace

template <class Watch>
void fragments_to_frame(const Pipeline& pipeline, const Scene& scene,
                        std::span<const FragmentRecord> fragments, const Surface& surface,
                        const GradientRecord* gradient, Frame& frame, Counters& counters, Trace* trace,
                        Watch watch) {
  FragmentDrawing<Watch> drawing{
      pipeline, texture_of(scene, surface.texture), gradient, surface.back, frame, counters, trace, watch};
  for (const FragmentRecord& fragment : fragments) {
    if (fragment.covered != 0) drawing.draw(fragment);
  }
}

template <class Watch>
void draw_triangles(const Pipeline& pipeline, const Scene& scene, std::span<const Triangle> triangles,
                    std::int64_t first_index, DrawBuffers& buffers, Frame& frame, Counters& counters,
                    Trace* trace, Watch watch) {
  auto& [rows, walk, fragments] = buffers;
  std::int64_t index = first_index;
  for (const Triangle& triangle : triangles) {
    check_triangle(scene, triangle, index);
    rows.clear();
    triangle_to_rows(pipeline, triangle, index, walk, rows, counters, trace, watch);
    const Surface surface = surface_of(pipeline, triangle);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const SpanRecord span = row_to_span(pipeline, rows, i, counters, watch);
      fragments.clear();
      span_to_fragments(pipeline, span, geometry_of(rows, i), fragments, counters, watch);
      deliver(trace, span);
      deliver_all(trace, fragments);
      fragments_to_frame(pipeline, scene, fragments, surface, gradient_of(rows, index), frame, counters,
                         trace, watch);
    }
    ++index;
  }
}

void row_to_frame(const Pipeline& pipeline, const Scene& scene, const AnyRow& any,
                  const PlaneGeometry* geometry, const Surface& surface, Frame& frame, Counters& counters,
                  Trace* trace) {
  check_draws_rows(pipeline);
  ++counters.rows;
  if (pipeline.const_depth_rows) --counters.divides_saved;
  SpanRecord span;
  int divides = 0;
  if (const auto* row = std::get_if<RowRecord>(&any)) {
    deliver(trace, *row);
    divides = span_setup(pipeline.span_setup, *row, span);
  } else if (const auto* plane_row = std::get_if<PlaneRowRecord>(&any)) {
    deliver(trace, *plane_row);
    divides = span_setup(pipeline.span_setup, *plane_row, *geometry, span);
  } else {
    span = std::get<SpanRecord>(any);
  }
  counters.divides_row += static_cast<std::uint64_t>(divides);
  deliver(trace, span);
  std::vector<FragmentRecord> fragments;
  span_to_fragments(pipeline, span, geometry, fragments, counters);
  deliver_all(trace, fragments);
  fragments_to_frame(pipeline, scene, fragments, surface, nullptr, frame, counters, trace);
}

std::vector<PlaneRowRecord> plane_rows(const Pipeline& pipeline, const SetupRecord& vertices,
                                       PlaneWalkState& walk) {
  start_plane_walk(pipeline.plane_walk, vertices, walk);
  std::vector<PlaneRowRecord> rows;
  PlaneRowRecord row;
  while (!finished(walk)) {
    if (plane_walk(pipeline.plane_walk, walk, row)) rows.push_back(row);
  }
  return rows;
}

void clear_frame(const Pipeline& pipeline, const Scene& scene, bool winners, Frame& frame) {
  bitspan::clear_frame(frame, scene.width, scene.height, scene.background,
                       static_cast<std::uint32_t>(pipeline.depth.clear), winners);
}

Frame cleared_frame(const Pipeline& pipeline, const Scene& scene) {
  Frame frame;
  clear_frame(pipeline, scene, true, frame);
  return frame;
}

const Texture* texture_of(const Scene& scene, int texture) {
  return texture < 0 ? nullptr : &scene.textures[static_cast<std::size_t>(texture)];
}

template Pipeline make_pipeline(const Config&, const Scene&, NoObserve);
template Pipeline make_pipeline(const Config&, const Scene&, Observe);
template bool triangle_to_rows(const Pipeline&, const Triangle&, std::int64_t, PlaneWalkState&, Rows&,
                               Counters&, Trace*, NoObserve);
template bool triangle_to_rows(const Pipeline&, const Triangle&, std::int64_t, PlaneWalkState&, Rows&,
                               Counters&, Trace*, Observe);
template SpanRecord row_to_span(const Pipeline&, const Rows&, std::size_t, Counters&, NoObserve);
template SpanRecord row_to_span(const Pipeline&, const Rows&, std::size_t, Counters&, Observe);
template void span_to_fragments(const Pipeline&, const SpanRecord&, const PlaneGeometry*,
                                std::vector<FragmentRecord>&, Counters&, NoObserve);
template void span_to_fragments(const Pipeline&, const SpanRecord&, const PlaneGeometry*,
                                std::vector<FragmentRecord>&, Counters&, Observe);
template void fragment_lod(const Pipeline&, const FragmentRecord&, const Texture*, const GradientRecord*,
                           LodRecord&, Trace*, NoObserve);
template bool fragment_texture(const Pipeline&, const FragmentRecord&, const Texture*, const LodRecord&,
                               TextureRecord&, NoObserve);
template void fragments_to_frame(const Pipeline&, const Scene&, std::span<const FragmentRecord>,
                                 const Surface&, const GradientRecord*, Frame&, Counters&, Trace*, NoObserve);
template void draw_triangles(const Pipeline&, const Scene&, std::span<const Triangle>, std::int64_t,
                             DrawBuffers&, Frame&, Counters&, Trace*, NoObserve);
template void fragments_to_frame(const Pipeline&, const Scene&, std::span<const FragmentRecord>,
                                 const Surface&, const GradientRecord*, Frame&, Counters&, Trace*, Observe);
template void draw_triangles(const Pipeline&, const Scene&, std::span<const Triangle>, std::int64_t,
                             DrawBuffers&, Frame&, Counters&, Trace*, Observe);

}  // namespace bitspan::model
