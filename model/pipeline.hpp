// SPDX-License-Identifier: Apache-2.0
// The stages in their order, prepared for one scene, and a draw in three steps that other engines can take
// apart: triangles to rows, rows to fragments, fragments to the frame.
//
// make_model (engine_model.hpp) runs the three after one another. The RTL engine puts its own span unit in
// place of the second; the timed model calls the stage functions of model/stages/ itself.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "config/config.hpp"
#include "engine/bands.hpp"
#include "engine/drawn_scene.hpp"
#include "engine/engine.hpp"
#include "engine/frame.hpp"
#include "engine/records.hpp"
#include "engine/rows.hpp"
#include "model/mip_chain.hpp"
#include "model/stages/candidate.hpp"
#include "model/stages/channel.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/depth.hpp"
#include "model/stages/distance.hpp"
#include "model/stages/edge_walk.hpp"
#include "model/stages/fog.hpp"
#include "model/stages/light.hpp"
#include "model/stages/line_walk.hpp"
#include "model/stages/lod.hpp"
#include "model/stages/merge.hpp"
#include "model/stages/plane_walk.hpp"
#include "model/stages/project.hpp"
#include "model/stages/setup.hpp"
#include "model/stages/setup_plane.hpp"
#include "model/stages/span.hpp"
#include "model/stages/span_setup.hpp"
#include "model/stages/stencil.hpp"
#include "model/stages/texture.hpp"
#include "model/stages/texture_second.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct Pipeline {
  bool const_depth_rows = false;
  Constants constants;
  SetupStage setup;
  bool by_plane = false;  // slope.row = plane
  SetupPlaneStage setup_plane;
  EdgeWalkStage edge_walk;
  PlaneWalkStage plane_walk;
  LineWalkStage line_walk;
  SpanSetupStage span_setup;
  SpanStage span;
  ChannelStage channels;
  DepthStage depth;
  bool has_distance = false, has_lod = false, has_gradients = false;  // as in config/modes.hpp
  DistanceStage distance;
  LodStage lod;
  MipChains mip_chains;
  TextureStage texture;
  ProjectStage project;
  TextureSecondStage texture_second;
  LightStage light;
  FogStage fog;
  MergeStage merge;
  StencilStage stencil;
  DrawState state;            // in force; set_state has told the stages
  DrawState first;            // of the scene's start
  bool masks_pixels = false;  // scissor or stipple may keep a pixel of `state` from being drawn
  RowRange rows;              // of the picture that are drawn; of a band, else all
  // `state` differs from the first one in registers at most that it does not look at.
  bool acts_as_first = true;

  // Without levels of textures, distances, gradients and light.
  bool is_plain() const { return !has_lod && !has_distance && !has_gradients && !light.is_on; }
  // Whether the vector form draws its short way: in a state that acts as the first one does, to pixels whose
  // alpha is 255, in a plain pipeline.
  bool draws_in_lanes(const Frame& frame) const { return acts_as_first && frame.full_alpha && is_plain(); }
  // Whether lanes have the stages up to depth; else they begin with texture.
  bool spans_in_lanes() const { return !const_depth_rows && !channels.any(); }
  // Whether a row of a triangle may leave the rows drawn: one of const_depth_rows has pixels of several.
  bool cuts_rows() const { return const_depth_rows && rows != RowRange{}; }
};

// Gives the stages the registers of a draw state; scene: whose textures it names.
void set_state(Pipeline& pipeline, const Scene& scene, const DrawState& state);
// Gives the frame the planes that the draw state asks for.
void make_ready(const Pipeline& pipeline, Frame& frame);
// Gives the stages the registers, makes the frame ready for them, and delivers their record.
void change_state(Pipeline& pipeline, const Scene& scene, Frame& frame, const DrawState& state,
                  std::int64_t next_index, Trace* trace);
// As Engine::clear.
void clear_planes(const Pipeline& pipeline, Frame& frame, const Clear& clear);
// Whether scissor and stipple let a pixel be drawn.
bool is_drawn(const DrawState& state, std::int64_t x, std::int64_t y);
inline bool is_drawn(const Pipeline& pipeline, const FragmentRecord& fragment) {
  return !pipeline.masks_pixels || is_drawn(pipeline.state, fragment.x, fragment.y);
}
// What the fragments of a triangle have in common behind span.
struct Surface {
  int texture = -1;   // index into Scene::textures, -1 for none
  bool back = false;  // a back face; told only where the stencil test asks
};
Surface surface_of(const Pipeline& pipeline, const Triangle& triangle);

// Throws InputError where the scene does not fit the configuration, has no size, or has a texture whose
// pixels do not match its size.
template <class Watch = NoObserve>
Pipeline make_pipeline(const Config& config, const Scene& scene, Watch watch = {});

// Brings the pipeline to what a scene has become since that version of it, with the draw state as it is.
// Throws InputError where a new view does not fit the configuration.
template <class Watch = NoObserve>
void update_pipeline(Pipeline& pipeline, const Config& config, const DrawnScene& scene, std::uint64_t since,
                     Watch watch = {});

// Throws InputError where the picture has no size or a texture's pixels do not match its size.
void check_scene(const Scene& scene);

// Throws InputError, naming the triangle's input index and the vertex, where a number is not finite, s is
// outside [s_min, s_max], a colour is outside 0..1, or the texture does not exist.
void check_triangle(const View& view, std::size_t textures, const Triangle& triangle, std::int64_t index);
inline void check_triangle(const Scene& scene, const Triangle& triangle, std::int64_t index) {
  check_triangle(scene, scene.textures.size(), triangle, index);
}

// Rows of one or more triangles with what span_setup and span need of them; one of rows and plane_rows is
// empty.
struct Rows {
  std::vector<RowRecord> rows;
  std::vector<PlaneRowRecord> plane_rows;
  std::vector<PlaneGeometry> planes;      // const_depth_rows: one per triangle that has an area
  std::vector<std::int32_t> plane_of;     // index into planes, one a plane row
  std::vector<WalkedLine> lines;          // those of `rows` that are lines, by their index
  std::vector<GradientRecord> gradients;  // where depth or lod takes them: one per triangle that has an area
  std::vector<TrianglePlane> triangle_planes;  // slope.row = plane: one per triangle that has an area
  // Where channels are in use: one per triangle that has an area, and one per row whose ends carry values.
  std::vector<TriangleChannels> triangle_channels;
  std::vector<RowChannels> row_channels;
  std::uint64_t above = 0;  // rows above the band that edges were walked over
  std::size_t size() const { return rows.size() + plane_rows.size(); }
  void clear();
};

// Takes what is made once per triangle or edge, and in const_depth_rows once per row. A band that makes it
// again gives other counters here, and no trace.
struct OncePerTriangle {
  Counters& counters;
  Trace* trace;
};
// Step one: setup and edge_walk or plane_walk of one triangle, or line_walk of a line. Appends its rows that
// are drawn; walk is a buffer to reuse. With a trace, appends records of setup, setup.edge, edge_walk,
// plane_walk, line_walk. False where degenerate. Counts triangles, degenerate, rows, divides of edges.
template <class Watch = NoObserve>
bool triangle_to_rows(const Pipeline& pipeline, const Triangle& triangle, std::int64_t index,
                      PlaneWalkState& walk, Rows& out, const OncePerTriangle& once, Counters& counters,
                      Trace* trace, Watch watch = {});
template <class Watch = NoObserve>
bool triangle_to_rows(const Pipeline& pipeline, const Triangle& triangle, std::int64_t index,
                      PlaneWalkState& walk, Rows& out, Counters& counters, Trace* trace, Watch watch = {}) {
  return triangle_to_rows(pipeline, triangle, index, walk, out, {counters, trace}, counters, trace, watch);
}

// Step two, first half: span_setup of row i. Counts divides_row.
template <class Watch = NoObserve>
SpanRecord row_to_span(const Pipeline& pipeline, const Rows& rows, std::size_t i, Counters& counters,
                       Watch watch = {});
// The gradients of a triangle by its index; null where nothing takes them.
const GradientRecord* gradient_of(const Rows& rows, std::int64_t triangle);
// The plane of a triangle by its index, where slope.row = plane.
const TrianglePlane& triangle_plane_of(const Rows& rows, std::int64_t triangle);
// The channels of a triangle by its index, where some are in use.
TriangleChannels& triangle_channels_of(Rows& rows, std::int64_t triangle);
// The line that row i is; null where it is of a triangle.
const WalkedLine* line_of(const Rows& rows, std::size_t i);
// The digital line of row i for start_span: of a line, and in const_depth_rows; else null.
const PlaneGeometry* geometry_of(const Rows& rows, std::size_t i);
// Step two, second half: appends the span's fragments. Counts fragments, covered, divides_pixel,
// divides_saved.
template <class Watch = NoObserve>
void span_to_fragments(const Pipeline& pipeline, const SpanRecord& span, const PlaneGeometry* geometry,
                       std::vector<FragmentRecord>& out, Counters& counters, Watch watch = {});

// Step two, first half, for the channels in use: of row i and its span. Counts divides_row. With a trace,
// appends span_setup.channel.
template <class Watch = NoObserve>
SpanChannels row_to_channels(const Pipeline& pipeline, Rows& rows, std::size_t i, const SpanRecord& span,
                             Counters& counters, Trace* trace, Watch watch = {});
// Both halves, with the span's fragments, which `out` then has one entry per. With a trace, appends
// span.channel, too.
template <class Watch = NoObserve>
void channels_of_row(const Pipeline& pipeline, Rows& rows, std::size_t i, const SpanRecord& span,
                     std::span<const FragmentRecord> fragments, std::vector<FragmentChannels>& out,
                     Counters& counters, Trace* trace, Watch watch = {});
// Appends the records of the channels in use to a trace.
template <class Record>
void deliver_channels(Trace* trace, const ChannelStage& stage, const PerChannel<Record>& records) {
  deliver_all(trace, std::span(records).first(stage.in_use.size()));
}

// lod and texture of a fragment; texture null for none, gradient and distance as for lod. There is lod only
// where textures have mip chains.
template <class Watch = NoObserve>
void fragment_lod(const Pipeline& pipeline, const FragmentRecord& fragment, const Texture* texture,
                  const GradientRecord* gradient, const DistanceRecord& distance, LodRecord& out,
                  Watch watch = {});
template <class Watch = NoObserve>
bool fragment_texture(const Pipeline& pipeline, const FragmentRecord& fragment, const Texture* texture,
                      const LodRecord& lod, TextureRecord& out, Watch watch = {});
// texture.second of a fragment that the first unit does not kill, while the second one is on; projected: of
// project, where that is on, else null.
template <class Watch = NoObserve>
bool fragment_texture_second(const Pipeline& pipeline, const FragmentRecord& fragment, const LodRecord& lod,
                             const TextureRecord& first, const ProjectRecord* projected,
                             TextureSecondRecord& out, Watch watch = {});

// Which planes fragments are written to.
inline WriteMask write_mask(const DrawState& state) {
  return {state.color_write, state.depth_write, state.color_mask};
}

// From depth to the frame, in the order of the draw state: the fragments of one triangle, one after another.
// finish(in, out) is called with each record when it is made, and the one that it was made from; it may
// change it. Counts masked, stencil_failed, depth_passed, killed, written.
template <class Finish, class Watch = NoObserve>
struct FragmentDrawing {
  const Pipeline& pipeline;
  const Texture* image;            // null for none
  const GradientRecord* gradient;  // as for depth and lod
  bool back;                       // a back face
  Frame& frame;
  Counters& counters;
  Finish finish;
  Watch watch{};

  const double uv_ulp = std::ldexp(1.0, -pipeline.texture.uv.fraction);
  const WriteMask mask = write_mask(pipeline.state);
  const bool tests_late = is_late(pipeline.state.depth_when);
  DepthRecord z{};
  StencilRecord stencilled{};
  DistanceRecord far{};
  LodRecord level{};
  TextureRecord texel{};  // behind both units, and light
  ProjectRecord projected{};
  TextureSecondRecord second{};
  LightRecord shone{};
  FogRecord fogged{};
  MergeRecord merged{};
  FragmentRecord own{}, own_second{};  // where channels stand for fields

  // drawn: the fragment as_drawn; the records are told to be made from the fragment itself.
  bool passes(const FragmentRecord& fragment, const FragmentRecord& drawn, std::size_t at) {
    depth(pipeline.depth, drawn, gradient, frame.depth[at], z, watch);
    finish(fragment, z);
    bool passed = z.pass == 1;
    if (pipeline.stencil.test) {
      stencil(pipeline.stencil, back, z, frame.stencil[at], stencilled);
      finish(z, stencilled);
      frame.stencil[at] = static_cast<std::uint8_t>(stencilled.value);
      if (stencilled.pass == 0) ++counters.stencil_failed;
      passed = passed && stencilled.pass == 1;
    }
    if (passed) ++counters.depth_passed;
    return passed;
  }
  bool lives(const FragmentRecord& fragment, const FragmentRecord& drawn, const FragmentChannels* channels) {
    if (pipeline.has_distance) {
      distance(pipeline.distance, fragment, far, watch);
      finish(fragment, far);
    }
    if (pipeline.has_lod) {
      fragment_lod(pipeline, fragment, image, gradient, far, level, watch);
      finish(fragment, level);
    }
    fragment_texture(pipeline, drawn, image, level, texel, watch);
    finish(fragment, texel);
    if (pipeline.texture_second.is_on() && texel.killed == 0) {
      if (pipeline.project.is_on) {
        project(pipeline.project, fragment, channels, projected, watch);
        finish(fragment, projected);
      }
      fragment_texture_second(pipeline, as_second(pipeline.channels, fragment, channels, own_second), level,
                              texel, pipeline.project.is_on ? &projected : nullptr, second, watch);
      finish(fragment, second);
      texel = combined(texel, second);
    }
    if (texel.killed == 1) ++counters.killed;
    return texel.killed == 0;
  }
  // A fragment that covers its pixel; channels: where some are in use.
  void draw(const FragmentRecord& fragment, const FragmentChannels* channels = nullptr) {
    if (!is_drawn(pipeline, fragment)) {
      ++counters.masked;
      return;
    }
    const std::size_t at = pixel_of(frame, fragment);
    const FragmentRecord& drawn = as_drawn(pipeline.channels, fragment, channels, own);
    if (tests_late) {
      if (!lives(fragment, drawn, channels) || !passes(fragment, drawn, at)) return;
    } else {
      if (!passes(fragment, drawn, at) || !lives(fragment, drawn, channels)) return;
    }
    if (pipeline.light.is_on) {
      light(pipeline.light, fragment, far, light_channels(pipeline.channels, fragment, channels), texel,
            shone, watch);
      finish(fragment, shone);
      texel = lit(texel, shone);
    }
    fog(pipeline.fog, fragment, far, texel, fogged, watch, channels);
    finish(fragment, fogged);
    if (holds_candidates(pipeline.state.translucency_pass)) {
      CandidateRecord taken;
      candidate(pipeline.depth.formats, fragment, z, texel, fogged, frame.candidates[at], taken);
      finish(z, taken);
      ++counters.candidates;
      return;
    }
    write(fragment, at);
  }
  // What merge makes of z, texel and fogged.
  void write(const FragmentRecord& fragment, std::size_t at) {
    std::uint8_t* const color = frame.color.data() + 4 * at;
    merge(pipeline.merge, z, texel, fogged, {color[0], color[1], color[2], color[3]}, merged, watch);
    finish(z, merged);
    if (pipeline.merge.changes_alpha) {
      MergeAlphaRecord alpha = merged_alpha(pipeline.merge, texel, color[3]);
      finish(merged, alpha);
      if (mask.stores(3)) color[3] = static_cast<std::uint8_t>(alpha.a);
    }
    ++counters.written;
    write_fragment(frame, fragment, merged, uv_ulp, mask);
  }
};

// Merges the candidates of the frame, row by row, and leaves none. With a trace, appends the records of
// merge. Counts written.
template <class Watch = NoObserve>
void resolve(const Pipeline& pipeline, Frame& frame, Counters& counters, Trace* trace, Watch watch = {});

// Step three: depth to merge of fragments of one triangle, in the order of the draw state; gradient as
// gradient_of gives it; channels: of each fragment, where some are in use. With a trace, appends the records
// of these stages. Counts masked, stencil_failed, depth_passed, killed, written.
template <class Watch = NoObserve>
void fragments_to_frame(const Pipeline& pipeline, const Scene& scene,
                        std::span<const FragmentRecord> fragments, const Surface& surface,
                        const GradientRecord* gradient, Frame& frame, Counters& counters, Trace* trace,
                        Watch watch = {}, std::span<const FragmentChannels> channels = {});

// Buffers to reuse from triangle to triangle.
struct DrawBuffers {
  Rows rows;
  PlaneWalkState walk;
  std::vector<FragmentRecord> fragments;
  std::vector<FragmentChannels> channels;
  std::uint64_t rows_above = 0;  // BandEngine::rows_above
};
// The three steps for triangles in order, one fragment after another, in any draw state. again: as
// BandEngine::draw_again. Throws InputError as check_triangle does.
template <class Watch = NoObserve>
void draw_triangles(const Pipeline& pipeline, const Scene& scene, std::span<const Triangle> triangles,
                    std::int64_t first_index, bool again, DrawBuffers& buffers, Frame& frame,
                    Counters& counters, Trace* trace, Watch watch = {});

// A row that was made elsewhere, from behind its stage to the frame; geometry: const_depth_rows only, else
// null. With a trace, appends its record and those behind it. Counts rows, divides_saved, divides_row and
// what the steps above count.
void row_to_frame(const Pipeline& pipeline, const Scene& scene, const AnyRow& row,
                  const PlaneGeometry* geometry, const Surface& surface, Frame& frame, Counters& counters,
                  Trace* trace);
// The walk of a triangle in const_depth_rows; returns its rows.
std::vector<PlaneRowRecord> plane_rows(const Pipeline& pipeline, const SetupRecord& setup,
                                       PlaneWalkState& walk);

// Gives the frame the rows of the scene's size that are drawn: background, cleared depth buffer, no triangle.
// winners: with the planes u, v and triangle; else they are empty.
void clear_frame(const Pipeline& pipeline, const Scene& scene, bool winners, Frame& frame);
Frame cleared_frame(const Pipeline& pipeline, const Scene& scene);
// Clears the frame of the target drawn on, in the size of the scene's view, which has become another one.
void resize_frame(const Pipeline& pipeline, const Scene& scene, Frame& frame);
// Takes target k in the frame's place, cleared where it has not been drawn on, and with a stencil plane where
// that is tested. Throws InputError where k is not below target_limit.
void select_target(const Pipeline& pipeline, const Scene& scene, Targets<Frame>& targets, int k,
                   Frame& frame);
// The texture by its index, null for none.
const Texture* texture_of(const Scene& scene, int texture);

}  // namespace bitspan::model
