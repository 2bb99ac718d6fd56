// SPDX-License-Identifier: Apache-2.0
#include "model/pipeline.hpp"

#include <algorithm>
#include <array>
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

namespace {

// What depends on the view.
template <class Watch>
void prepare_view(Pipeline& p, const Config& config, const Scene& scene, Watch watch) {
  p.constants = make_constants(config, scene, watch);
  p.setup = prepare_setup(config, p.constants);
  if (p.by_plane) p.setup_plane = prepare_setup_plane(config, p.constants);
  p.edge_walk = prepare_edge_walk(config, p.constants, scene.width, scene.height);
  p.plane_walk = prepare_plane_walk(config, p.constants, scene.width, scene.height);
  p.line_walk = prepare_line_walk(config, scene.width, scene.height);
  p.span_setup = prepare_span_setup(config, p.constants);
  p.span = prepare_span(config, p.constants);
  p.channels = prepare_channels(config, p.constants, scene);
  if (has_pixel_quotients(config.perspective)) {
    p.span.divides_per_fragment += static_cast<int>(
        std::ranges::count_if(p.channels.in_use, [](const ChannelForm& form) { return form.span_divides; }));
  }
  p.depth = prepare_depth(config, p.constants);
  if (p.has_distance) p.distance = prepare_distance(config, p.constants, scene, watch);
  if (p.has_lod) p.lod = prepare_lod(config, p.constants, watch);
  p.project = prepare_project(config, p.constants, scene);
  p.light = prepare_light(config, p.constants, scene, watch);
  p.fog = prepare_fog(config, p.constants, scene, watch);
}

}  // namespace

template <class Watch>
Pipeline make_pipeline(const Config& config, const Scene& scene, Watch watch) {
  check_scene(scene);
  Pipeline p;
  p.const_depth_rows = has_plane_rows(config.perspective);
  p.by_plane = has_setup_plane(config);
  p.has_distance = has_distance(config);
  p.has_lod = has_lod(config);
  p.has_gradients = has_setup_gradients(config);
  prepare_view(p, config, scene, watch);
  p.mip_chains = MipChains(config, scene);
  p.texture = prepare_texture(config);
  p.texture_second = prepare_texture_second(config);
  p.merge = prepare_merge(config);
  p.first = first_state(config);
  set_state(p, scene, p.first);
  return p;
}

namespace {

bool is_constant(BlendFactor factor) {
  return factor >= BlendFactor::constant_color && factor <= BlendFactor::one_minus_constant_alpha;
}

// Whether two states draw alike because what they differ in is not looked at.
bool act_alike(DrawState s, const DrawState& other, bool has_lod) {
  if (s.alpha_func == CompareFunc::always) s.alpha_ref = other.alpha_ref;
  if (!is_constant(s.blend_src) && !is_constant(s.blend_dst) && !is_constant(s.blend_alpha_src) &&
      !is_constant(s.blend_alpha_dst)) {
    s.blend_red = other.blend_red;
    s.blend_green = other.blend_green;
    s.blend_blue = other.blend_blue;
    s.blend_alpha = other.blend_alpha;
  }
  if (!is_narrow(s.target_format)) {
    s.target_dither = other.target_dither;
    s.target_round = other.target_round;
  }
  if (s.chroma_test == ChromaTest::none) {
    s.chroma_low_red = other.chroma_low_red;
    s.chroma_low_green = other.chroma_low_green;
    s.chroma_low_blue = other.chroma_low_blue;
    s.chroma_high_red = other.chroma_high_red;
    s.chroma_high_green = other.chroma_high_green;
    s.chroma_high_blue = other.chroma_high_blue;
  }
  if (!has_lod) {
    s.texture_lod_bias = other.texture_lod_bias;
    s.texture_level_least = other.texture_level_least;
    s.texture_level_greatest = other.texture_level_greatest;
    s.texture_magnify = other.texture_magnify;
  }
  if (!has_second_texture(s) || !has_lod) {
    s.texture1_lod_bias = other.texture1_lod_bias;
    s.texture1_level_least = other.texture1_level_least;
    s.texture1_level_greatest = other.texture1_level_greatest;
    s.texture1_magnify = other.texture1_magnify;
  }
  if (!has_second_texture(s)) {
    s.texture1_op = other.texture1_op;
    s.texture1_scale = other.texture1_scale;
    s.texture1_red = other.texture1_red;
    s.texture1_green = other.texture1_green;
    s.texture1_blue = other.texture1_blue;
    s.texture1_filter = other.texture1_filter;
    s.texture1_wrap_u = other.texture1_wrap_u;
    s.texture1_wrap_v = other.texture1_wrap_v;
    s.texture1_coordinates = other.texture1_coordinates;
    s.texture1_outside = other.texture1_outside;
    s.texture1_compare = other.texture1_compare;
    s.texture1_func = other.texture1_func;
    s.texture1_bias = other.texture1_bias;
  }
  return s == other;
}

}  // namespace

void set_state(Pipeline& pipeline, const Scene& scene, const DrawState& state) {
  pipeline.state = state;
  pipeline.acts_as_first = act_alike(state, pipeline.first, pipeline.has_lod);
  pipeline.masks_pixels = masks_pixels(state);
  pipeline.depth.func = state.depth_func;
  pipeline.depth.bias = state.depth_bias;
  set_kill(pipeline.texture, state);
  set_lod(pipeline.lod, state);
  pipeline.texture.lookup = first_lookup(state);
  pipeline.texture.magnified = pipeline.has_lod ? first_magnified(state) : pipeline.texture.lookup;
  pipeline.texture.range = first_levels(state);
  pipeline.texture.chroma = chroma_of(state);
  pipeline.texture.is_last = !has_second_texture(state);
  set_texture_second(pipeline.texture_second, state, texture_of(scene, state.texture1));
  set_light(pipeline.light, state);
  set_project(pipeline.project, state, texture_of(scene, state.texture1));
  pipeline.stencil = prepare_stencil(state);
  set_blend(pipeline.merge, blend_of(state));
}

void make_ready(const Pipeline& pipeline, Frame& frame) {
  if (pipeline.stencil.test) need_stencil(frame);
  if (holds_candidates(pipeline.state.translucency_pass)) need_candidates(frame);
}

namespace {

// What is drawn from here on may leave other alphas in the frame.
void note_alpha(const Pipeline& pipeline, Frame& frame) {
  if (pipeline.merge.changes_alpha) frame.full_alpha = false;
}

}  // namespace

void change_state(Pipeline& pipeline, const Scene& scene, Frame& frame, const DrawState& state,
                  std::int64_t next_index, Trace* trace) {
  set_state(pipeline, scene, state);
  make_ready(pipeline, frame);
  note_alpha(pipeline, frame);
  if (trace != nullptr) deliver(trace, state_record(state, next_index));
}

template <class Watch>
void update_pipeline(Pipeline& pipeline, const Config& config, const DrawnScene& scene, std::uint64_t since,
                     Watch watch) {
  if (scene.version() == since) return;
  if (scene.view_version() > since) prepare_view(pipeline, config, *scene, watch);
  pipeline.mip_chains.update(scene, since);
  set_state(pipeline, *scene, pipeline.state);
}

namespace {

// What a masked clear stores of its codes, which the target holds: row by row of the scissor's rectangle.
void clear_rectangle(const DrawState& s, Frame& frame, const Clear& clear, std::uint32_t farthest) {
  const WriteMask mask = write_mask(s);
  const auto write = static_cast<std::uint8_t>(s.stencil_write);
  if (clear.stencil) need_stencil(frame);
  const int right = std::min(s.scissor_right, frame.width);
  const int bottom = std::min(s.scissor_bottom, frame.first_row + frame.height);
  for (int y = std::max(s.scissor_top, frame.first_row); y < bottom; ++y) {
    for (int x = s.scissor_left; x < right; ++x) {
      const auto at = static_cast<std::size_t>(frame.grid().place(x, y));
      std::uint8_t* const rgba = frame.color.data() + 4 * at;
      for (int c = 0; clear.color && c < 3; ++c) {
        if (mask.stores(c)) rgba[c] = (*clear.color)[static_cast<std::size_t>(c)];
      }
      if (clear.color && mask.color && !frame.u.empty()) clear_winner(frame, at);
      if (clear.alpha && mask.stores(3)) rgba[3] = *clear.alpha;
      if (clear.depth && s.depth_write) frame.depth[at] = farthest;
      if (clear.stencil) {
        std::uint8_t& value = frame.stencil[at];
        value = static_cast<std::uint8_t>(value ^ ((value ^ *clear.stencil) & write));
      }
    }
  }
  if (clear.alpha && *clear.alpha != 255) frame.full_alpha = false;
}

}  // namespace

void clear_planes(const Pipeline& pipeline, Frame& frame, const Clear& clear) {
  const Clear codes = held(pipeline.merge, clear);
  const auto farthest = static_cast<std::uint32_t>(pipeline.depth.clear);
  if (clear.masked) {
    clear_rectangle(pipeline.state, frame, codes, farthest);
  } else {
    bitspan::clear_planes(frame, codes, farthest);
  }
  note_alpha(pipeline, frame);
}

bool is_drawn(const DrawState& s, std::int64_t x, std::int64_t y) {
  return x >= s.scissor_left && x < s.scissor_right && y >= s.scissor_top && y < s.scissor_bottom &&
         ((s.stipple >> (8 * (y & 3) + (x & 7))) & 1) != 0;
}

Surface surface_of(const Pipeline& pipeline, const Triangle& triangle) {
  return {triangle.texture, pipeline.stencil.test && is_back_face(pipeline.setup, triangle)};
}

void check_triangle(const View& view, std::size_t textures, const Triangle& triangle, std::int64_t index) {
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
    if (!(v.s >= view.s_min && v.s <= view.s_max)) {
      refuse_vertex(
          index, i,
          "s " + text(v.s) + " is outside s_min.." + "s_max, " + text(view.s_min) + ".." + text(view.s_max));
    }
    for (const double c : v.c) {
      if (!(c >= 0 && c <= 1)) {
        refuse_vertex(index, i, "colour or alpha " + text(c) + " is outside 0..1");
      }
    }
    for (const GivenAttribute& given : given_attributes) {
      if (given.is_given(triangle.v) && !given.is_legal(v.*given.member)) {
        refuse_vertex(index, i,
                      std::string(given.key) + " " + text(v.*given.member) + " is not legal, " +
                          (given.range == AttributeRange::unit ? "0..1" : "a finite number") +
                          " is needed, or none at all three");
      }
    }
  }
  if (triangle.texture >= static_cast<std::int64_t>(textures)) {
    throw InputError("triangle " + std::to_string(index) + ": texture " + std::to_string(triangle.texture) +
                     " does not exist, the scene has " + std::to_string(textures));
  }
}

void Rows::clear() {
  rows.clear();
  plane_rows.clear();
  planes.clear();
  plane_of.clear();
  gradients.clear();
  triangle_planes.clear();
  triangle_channels.clear();
  row_channels.clear();
  above = 0;
  lines.clear();
}

namespace {

template <class Watch>
void add_line(const Pipeline& pipeline, const SetupRecord& vertices, Rows& out, Counters& counters,
              Trace* trace, Watch watch) {
  WalkedLine line;
  if (!line_walk(pipeline.line_walk, vertices, line, watch)) return;
  out.rows.push_back(row_of(line.record));
  out.lines.push_back(line);
  ++counters.rows;
  counters.divides_edge += pipeline.line_walk.divides_per_line;
  deliver(trace, line.record);
}

template <class Watch>
void add_channels(const Pipeline& pipeline, const Triangle& triangle, const SetupRecord& vertices,
                  const Edges* edges, Rows& out, const OncePerTriangle& once, Watch watch) {
  if (!pipeline.channels.any()) return;
  const TrianglePlane* plane = pipeline.by_plane ? &out.triangle_planes.back() : nullptr;
  out.triangle_channels.push_back(setup_channels(pipeline.channels, triangle, vertices, edges, plane, watch));
  const TriangleChannels& made = out.triangle_channels.back();
  once.counters.divides_edge += static_cast<std::uint64_t>(made.divides);
  deliver_channels(once.trace, pipeline.channels, made.record);
}

}  // namespace

template <class Watch>
bool triangle_to_rows(const Pipeline& pipeline, const Triangle& triangle, std::int64_t index,
                      PlaneWalkState& walk, Rows& out, const OncePerTriangle& once, Counters& counters,
                      Trace* trace, Watch watch) {
  ++once.counters.triangles;
  SetupRecord vertices;
  if (!setup(pipeline.setup, triangle, index, vertices, watch)) {
    ++once.counters.degenerate;
    return false;
  }
  deliver(once.trace, vertices);
  if (triangle.is_line) {
    add_line(pipeline, vertices, out, counters, trace, watch);
    return true;
  }
  if (pipeline.has_gradients) {
    out.gradients.push_back(setup_gradients(pipeline.plane_walk, vertices, watch));
    deliver(once.trace, out.gradients.back());
    if (!pipeline.const_depth_rows) once.counters.divides_edge += divides_per_gradients;
  }
  if (pipeline.const_depth_rows) {
    add_channels(pipeline, triangle, vertices, nullptr, out, once, watch);
    start_plane_walk(pipeline.plane_walk, vertices, walk, watch);
    deliver(once.trace, walk.record);
    const auto plane = static_cast<std::int32_t>(out.planes.size());
    out.planes.push_back(walk.geometry);
    once.counters.divides_edge += divides_per_plane;
    PlaneRowRecord row;
    while (!finished(walk)) {
      if (plane_walk(pipeline.plane_walk, walk, row, watch)) {
        out.plane_rows.push_back(row);
        out.plane_of.push_back(plane);
        ++once.counters.rows;
        --once.counters.divides_saved;
        deliver(once.trace, row);
      }
    }
    return true;
  }
  const Edges edges = setup_edges(pipeline.setup, vertices, watch);
  const auto edge_count = static_cast<std::size_t>(edges.count);
  once.counters.divides_edge += edge_count * static_cast<std::size_t>(pipeline.setup.divides_per_edge);
  deliver_all(once.trace, std::span(edges.edge).first(edge_count));
  if (pipeline.by_plane) {
    out.triangle_planes.push_back(setup_plane(pipeline.setup_plane, vertices, watch));
    once.counters.divides_edge += static_cast<std::uint64_t>(pipeline.setup_plane.divides_per_plane);
    deliver(once.trace, out.triangle_planes.back().record);
  }
  add_channels(pipeline, triangle, vertices, &edges, out, once, watch);
  const bool ends_have_channels = pipeline.channels.any() && !pipeline.by_plane;
  EdgeWalkState state = start_edge_walk(pipeline.edge_walk, vertices, edges);
  if (state.y_end <= pipeline.rows.first) return true;
  out.above += pass_rows(pipeline.edge_walk, state, pipeline.rows.first, watch);
  state.y_end = std::min(state.y_end, pipeline.rows.end);
  RowRecord row;
  while (!finished(state)) {
    if (edge_walk(pipeline.edge_walk, state, row, watch)) {
      out.rows.push_back(row);
      ++counters.rows;
      counters.divides_edge += static_cast<std::uint64_t>(pipeline.edge_walk.divides_per_row);
      deliver(trace, row);
      if (ends_have_channels) {
        out.row_channels.push_back(row_channels(pipeline.channels, out.triangle_channels.back(), row, watch));
        deliver_channels(trace, pipeline.channels, out.row_channels.back());
      }
    }
  }
  return true;
}

template <class Watch>
SpanRecord row_to_span(const Pipeline& pipeline, const Rows& rows, std::size_t i, Counters& counters,
                       Watch watch) {
  SpanRecord span;
  int divides = 0;
  if (pipeline.const_depth_rows) {
    divides = span_setup(pipeline.span_setup, rows.plane_rows[i], *geometry_of(rows, i), span, watch);
  } else if (pipeline.by_plane) {
    const RowRecord& row = rows.rows[i];
    divides = span_setup(pipeline.span_setup, row, triangle_plane_of(rows, row.triangle), span, watch);
  } else if (const WalkedLine* line = line_of(rows, i); line != nullptr) {
    divides = span_setup(pipeline.span_setup, line->record, span, watch);
  } else {
    divides = span_setup(pipeline.span_setup, rows.rows[i], span, watch);
  }
  counters.divides_row += static_cast<std::uint64_t>(divides);
  return span;
}

const GradientRecord* gradient_of(const Rows& rows, std::int64_t triangle) {
  const auto found = std::ranges::lower_bound(rows.gradients, triangle, {}, &GradientRecord::triangle);
  return found == rows.gradients.end() || found->triangle != triangle ? nullptr : &*found;
}

const TrianglePlane& triangle_plane_of(const Rows& rows, std::int64_t triangle) {
  return *std::ranges::lower_bound(rows.triangle_planes, triangle, {},
                                   [](const TrianglePlane& p) { return p.record.triangle; });
}

TriangleChannels& triangle_channels_of(Rows& rows, std::int64_t triangle) {
  return *std::ranges::lower_bound(rows.triangle_channels, triangle, {},
                                   [](const TriangleChannels& c) { return c.setup.triangle; });
}

template <class Watch>
SpanChannels row_to_channels(const Pipeline& pipeline, Rows& rows, std::size_t i, const SpanRecord& span,
                             Counters& counters, Trace* trace, Watch watch) {
  const bool has_ends = !rows.row_channels.empty();
  const SpanChannels start = span_channels(
      pipeline.channels, triangle_channels_of(rows, span.triangle), span, has_ends ? &rows.rows[i] : nullptr,
      has_ends ? &rows.row_channels[i] : nullptr, geometry_of(rows, i), watch);
  counters.divides_row += static_cast<std::uint64_t>(start.divides);
  deliver_channels(trace, pipeline.channels, start.record);
  return start;
}

template <class Watch>
void channels_of_row(const Pipeline& pipeline, Rows& rows, std::size_t i, const SpanRecord& span,
                     std::span<const FragmentRecord> fragments, std::vector<FragmentChannels>& out,
                     Counters& counters, Trace* trace, Watch watch) {
  const SpanChannels start = row_to_channels(pipeline, rows, i, span, counters, trace, watch);
  ChannelWalk walk{.geometry = geometry_of(rows, i), .span = start.record};
  out.clear();
  for (const FragmentRecord& fragment : fragments) {
    out.push_back(fragment_channels(pipeline.channels, walk, fragment, watch));
    deliver_channels(trace, pipeline.channels, out.back());
  }
}

const WalkedLine* line_of(const Rows& rows, std::size_t i) {
  if (rows.lines.empty()) return nullptr;
  const std::int64_t triangle = rows.rows[i].triangle;
  const auto found = std::ranges::lower_bound(rows.lines, triangle, {},
                                              [](const WalkedLine& l) { return l.record.triangle; });
  return found == rows.lines.end() || found->record.triangle != triangle ? nullptr : &*found;
}

const PlaneGeometry* geometry_of(const Rows& rows, std::size_t i) {
  if (const WalkedLine* line = line_of(rows, i); line != nullptr) return &line->geometry;
  return rows.plane_of.empty() ? nullptr : &rows.planes[static_cast<std::size_t>(rows.plane_of[i])];
}

template <class Watch>
void span_to_fragments(const Pipeline& pipeline, const SpanRecord& span, const PlaneGeometry* geometry,
                       std::vector<FragmentRecord>& out, Counters& counters, Watch watch) {
  SpanState state = start_span(span, geometry);
  auto at = out.size();
  out.resize(at + static_cast<std::size_t>(span.count));
  std::int64_t covered = 0;
  int divides = 0;
  while (!finished(state)) {
    bitspan::model::span(pipeline.span, state, out[at], watch);
    covered += out[at].covered;
    divides += state.divides;
    ++at;
  }
  const auto count = static_cast<std::uint64_t>(span.count);
  counters.fragments += count;
  counters.covered += static_cast<std::uint64_t>(covered);
  counters.divides_pixel += static_cast<std::uint64_t>(divides);
  counters.divides_saved += pipeline.const_depth_rows ? covered : 0;
}

template <class Watch>
void fragment_lod(const Pipeline& pipeline, const FragmentRecord& fragment, const Texture* texture,
                  const GradientRecord* gradient, const DistanceRecord& distance, LodRecord& out,
                  Watch watch) {
  const MipChain* chain = pipeline.mip_chains.of(texture);
  lod(pipeline.lod, fragment, gradient, distance, chain == nullptr ? 1 : static_cast<int>(chain->size()), out,
      watch);
}

template <class Watch>
bool fragment_texture(const Pipeline& pipeline, const FragmentRecord& fragment, const Texture* image,
                      const LodRecord& lod, TextureRecord& out, Watch watch) {
  return pipeline.has_lod
             ? texture(pipeline.texture, pipeline.mip_chains.of(image), fragment, lod, out, watch)
             : texture(pipeline.texture, image, fragment, out, watch);
}

template <class Watch>
bool fragment_texture_second(const Pipeline& pipeline, const FragmentRecord& fragment, const LodRecord& lod,
                             const TextureRecord& first, const ProjectRecord* projected,
                             TextureSecondRecord& out, Watch watch) {
  const TextureSecondStage& stage = pipeline.texture_second;
  return texture_second(stage, pipeline.has_lod ? pipeline.mip_chains.of(stage.image) : nullptr, fragment,
                        lod, first, projected, out, watch);
}

template <class Watch>
void fragments_to_frame(const Pipeline& pipeline, const Scene& scene,
                        std::span<const FragmentRecord> fragments, const Surface& surface,
                        const GradientRecord* gradient, Frame& frame, Counters& counters, Trace* trace,
                        Watch watch, std::span<const FragmentChannels> channels) {
  const auto finish = [trace](const auto& /*in*/, const auto& out) { deliver(trace, out); };
  FragmentDrawing<decltype(finish), Watch> drawing{
      pipeline, texture_of(scene, surface.texture), gradient, surface.back, frame, counters, finish, watch};
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (fragments[i].covered != 0) drawing.draw(fragments[i], channels.empty() ? nullptr : &channels[i]);
  }
}

template <class Watch>
void resolve(const Pipeline& pipeline, Frame& frame, Counters& counters, Trace* trace, Watch watch) {
  const auto finish = [trace](const auto& /*in*/, const auto& out) { deliver(trace, out); };
  FragmentDrawing<decltype(finish), Watch> drawing{pipeline, nullptr,  nullptr, false,
                                                   frame,    counters, finish,  watch};
  for (std::size_t at = 0; at < frame.candidates.size(); ++at) {
    if (frame.candidates[at].a == 0) continue;
    const auto place = static_cast<std::int64_t>(at);
    const HeldFragment held =
        held_fragment(frame.candidates[at], frame.grid().x_of(place), frame.grid().y_of(place));
    drawing.z = held.depth;
    drawing.texel = held.texture;
    drawing.fogged = held.fog;
    drawing.write(held.fragment, at);
    frame.candidates[at] = {};
  }
}

namespace {

// The rows of const_depth_rows in a band: what there is per row is the triangle's, and the fragments are
// those of the rows drawn.
template <class Watch>
void draw_cut_row(const Pipeline& pipeline, std::size_t i, const OncePerTriangle& once, DrawBuffers& buffers,
                  Counters& counters, Trace* trace, Watch watch) {
  auto& fragments = buffers.fragments;
  auto& channels = buffers.channels;
  const SpanRecord span = row_to_span(pipeline, buffers.rows, i, once.counters, watch);
  deliver(once.trace, span);
  Counters elsewhere;
  span_to_fragments(pipeline, span, geometry_of(buffers.rows, i), fragments, elsewhere, watch);
  const bool has_channels = pipeline.channels.any();
  if (has_channels) {
    Trace all;
    channels_of_row(pipeline, buffers.rows, i, span, fragments, channels, once.counters, &all, watch);
    deliver_all(once.trace, all.span_channel);
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < fragments.size(); ++k) {
    if (!pipeline.rows.has(fragments[k].y)) continue;
    fragments[kept] = fragments[k];
    if (has_channels) {
      channels[kept] = channels[k];
      deliver_channels(trace, pipeline.channels, channels[kept]);
    }
    deliver(trace, fragments[kept]);
    const auto covered = fragments[kept].covered;
    counters.covered += static_cast<std::uint64_t>(covered);
    counters.divides_saved += covered;
    ++kept;
  }
  counters.fragments += kept;
  fragments.resize(kept);
  if (has_channels) channels.resize(kept);
}

}  // namespace

template <class Watch>
void draw_triangles(const Pipeline& pipeline, const Scene& scene, std::span<const Triangle> triangles,
                    std::int64_t first_index, bool again, DrawBuffers& buffers, Frame& frame,
                    Counters& counters, Trace* trace, Watch watch) {
  auto& [rows, walk, fragments, channels, rows_above] = buffers;
  Counters elsewhere;
  const OncePerTriangle once{again ? elsewhere : counters, again ? nullptr : trace};
  const bool cuts_rows = pipeline.cuts_rows();
  std::int64_t index = first_index;
  for (const Triangle& triangle : triangles) {
    check_triangle(scene, triangle, index);
    rows.clear();
    triangle_to_rows(pipeline, triangle, index, walk, rows, once, counters, trace, watch);
    rows_above += rows.above;
    const Surface surface = surface_of(pipeline, triangle);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      fragments.clear();
      if (cuts_rows) {
        draw_cut_row(pipeline, i, once, buffers, counters, trace, watch);
      } else {
        const SpanRecord span = row_to_span(pipeline, rows, i, counters, watch);
        span_to_fragments(pipeline, span, geometry_of(rows, i), fragments, counters, watch);
        deliver(trace, span);
        deliver_all(trace, fragments);
        if (pipeline.channels.any()) {
          channels_of_row(pipeline, rows, i, span, fragments, channels, counters, trace, watch);
        }
      }
      fragments_to_frame(pipeline, scene, fragments, surface, gradient_of(rows, index), frame, counters,
                         trace, watch, channels);
    }
    ++index;
  }
}

void row_to_frame(const Pipeline& pipeline, const Scene& scene, const AnyRow& any,
                  const PlaneGeometry* geometry, const Surface& surface, Frame& frame, Counters& counters,
                  Trace* trace) {
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
  const RowRange rows = pipeline.rows.within(scene.height);
  bitspan::clear_frame(frame, scene.width, static_cast<int>(rows.end - rows.first), scene.background,
                       static_cast<std::uint32_t>(pipeline.depth.clear), winners);
  frame.first_row = static_cast<int>(rows.first);
}

Frame cleared_frame(const Pipeline& pipeline, const Scene& scene) {
  Frame frame;
  clear_frame(pipeline, scene, true, frame);
  return frame;
}

void resize_frame(const Pipeline& pipeline, const Scene& scene, Frame& frame) {
  clear_frame(pipeline, scene, !frame.u.empty(), frame);
  make_ready(pipeline, frame);
  note_alpha(pipeline, frame);
}

void select_target(const Pipeline& pipeline, const Scene& scene, Targets<Frame>& targets, int k,
                   Frame& frame) {
  const bool winners = !frame.u.empty();
  if (!targets.select(k, frame)) clear_frame(pipeline, scene, winners, frame);
  make_ready(pipeline, frame);
  note_alpha(pipeline, frame);
}

const Texture* texture_of(const Scene& scene, int texture) {
  return texture < 0 ? nullptr : &scene.textures[static_cast<std::size_t>(texture)];
}

template Pipeline make_pipeline(const Config&, const Scene&, NoObserve);
template Pipeline make_pipeline(const Config&, const Scene&, Observe);
template void update_pipeline(Pipeline&, const Config&, const DrawnScene&, std::uint64_t, NoObserve);
template void update_pipeline(Pipeline&, const Config&, const DrawnScene&, std::uint64_t, Observe);
template bool triangle_to_rows(const Pipeline&, const Triangle&, std::int64_t, PlaneWalkState&, Rows&,
                               const OncePerTriangle&, Counters&, Trace*, NoObserve);
template bool triangle_to_rows(const Pipeline&, const Triangle&, std::int64_t, PlaneWalkState&, Rows&,
                               const OncePerTriangle&, Counters&, Trace*, Observe);
template SpanRecord row_to_span(const Pipeline&, const Rows&, std::size_t, Counters&, NoObserve);
template SpanRecord row_to_span(const Pipeline&, const Rows&, std::size_t, Counters&, Observe);
template void span_to_fragments(const Pipeline&, const SpanRecord&, const PlaneGeometry*,
                                std::vector<FragmentRecord>&, Counters&, NoObserve);
template void span_to_fragments(const Pipeline&, const SpanRecord&, const PlaneGeometry*,
                                std::vector<FragmentRecord>&, Counters&, Observe);
template void fragment_lod(const Pipeline&, const FragmentRecord&, const Texture*, const GradientRecord*,
                           const DistanceRecord&, LodRecord&, NoObserve);
template bool fragment_texture(const Pipeline&, const FragmentRecord&, const Texture*, const LodRecord&,
                               TextureRecord&, NoObserve);
template bool fragment_texture_second(const Pipeline&, const FragmentRecord&, const LodRecord&,
                                      const TextureRecord&, const ProjectRecord*, TextureSecondRecord&,
                                      NoObserve);
template void resolve(const Pipeline&, Frame&, Counters&, Trace*, NoObserve);
template void resolve(const Pipeline&, Frame&, Counters&, Trace*, Observe);
template SpanChannels row_to_channels(const Pipeline&, Rows&, std::size_t, const SpanRecord&, Counters&,
                                      Trace*, NoObserve);
template SpanChannels row_to_channels(const Pipeline&, Rows&, std::size_t, const SpanRecord&, Counters&,
                                      Trace*, Observe);
template void channels_of_row(const Pipeline&, Rows&, std::size_t, const SpanRecord&,
                              std::span<const FragmentRecord>, std::vector<FragmentChannels>&, Counters&,
                              Trace*, NoObserve);
template void channels_of_row(const Pipeline&, Rows&, std::size_t, const SpanRecord&,
                              std::span<const FragmentRecord>, std::vector<FragmentChannels>&, Counters&,
                              Trace*, Observe);
template void fragments_to_frame(const Pipeline&, const Scene&, std::span<const FragmentRecord>,
                                 const Surface&, const GradientRecord*, Frame&, Counters&, Trace*, NoObserve,
                                 std::span<const FragmentChannels>);
template void draw_triangles(const Pipeline&, const Scene&, std::span<const Triangle>, std::int64_t, bool,
                             DrawBuffers&, Frame&, Counters&, Trace*, NoObserve);
template void fragments_to_frame(const Pipeline&, const Scene&, std::span<const FragmentRecord>,
                                 const Surface&, const GradientRecord*, Frame&, Counters&, Trace*, Observe,
                                 std::span<const FragmentChannels>);
template void draw_triangles(const Pipeline&, const Scene&, std::span<const Triangle>, std::int64_t, bool,
                             DrawBuffers&, Frame&, Counters&, Trace*, Observe);

}  // namespace bitspan::model
