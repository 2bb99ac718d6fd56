// SPDX-License-Identifier: Apache-2.0
// The vector form's last half: texture, fog, merge and the frame, for blocks of fragments that passed the
// depth test. The arithmetic is the stages' own text (model/stages/*-inl.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "engine/records.hpp"
#include "model/engine_model.hpp"
#include "model/numeric/observe.hpp"
#include "model/pipeline.hpp"
#include "model/simd/fragment_block.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

// What the three stages compute by, known from the configuration alone.
struct ShadeFormats {
  TextureStage texture;
  FogFormats fog;
  MergeStage merge;
  bool operator==(const ShadeFormats&) const = default;
};
constexpr ShadeFormats shade_formats(const Config& config) {
  return {prepare_texture(config), fog_formats(config), prepare_merge(config)};
}

// In what the three stages compute, every intermediate exact.
enum class ShadeLanes : std::uint8_t { int32, int64, scalar };
// By the formats; scenes with a texture of 2^28 texels and more are scalar. fog: none in a scene without fog.
ShadeLanes lanes_for_shading(const Config& config, FogMode fog);
// Whether shade_any can be held in the same lanes, and the second texture unit with it.
bool holds_any_shading(const Config& config, ShadeLanes lanes);
bool holds_second_texture(const Config& config, ShadeLanes lanes);
// And light.
bool holds_light(const Config& config, ShadeLanes lanes);

// A texture as the kernels read it: words, red in the lowest byte, with a border that repeats what the
// wrapping gives there, so that the four texels of the bilinear filter are two pairs side by side.
struct ShadeTexture {
  TexelLookup by;  // that it is made for
  std::int32_t width = 0, height = 0;
  std::int32_t border_u = 0, border_v = 0;  // columns before column 0, rows before row 0
  std::int32_t stride = 0;                  // words per row
  bool is_ready = false;                    // what follows is of the source as it is now
  bool has_reserved = false;                // some texel has the reserved colour
  bool opaque = false;                      // every texel's alpha is 255
  bool never_killed = false;         // no texel has the reserved colour or an alpha of 0 on texture.alpha
  const Texture* source = nullptr;   // of the scene
  std::vector<std::uint32_t> words;  // padded by two words
};

// The textures of a scene for one way of looking texels up. compared: depth words for those of the format
// depth, in the place of colours.
struct ShadeTextures {
  TexelLookup by;
  bool compared = false;
  std::vector<ShadeTexture> whole;                // by the scene's numbers
  std::vector<std::vector<ShadeTexture>> levels;  // of each, from level 1 on; empty without mip chains
};

// Prepared once per scene, which must outlive it. Its textures are made ready when they are drawn with.
struct ShadePlan {
  ShadeLanes held_in = ShadeLanes::scalar;
  bool holds_any = false;     // what shade_any computes besides fits the same lanes
  bool holds_second = false;  // and what the second texture unit does
  bool holds_lit = false;     // and light
  bool holds_brightness = false,
       normals_fit_int64 = false;  // of a light at pixels, and the squares of theirs
  bool branch_free = false;        // every register rounds by adding a constant, and saturates
  ShadeFormats formats;
  std::vector<ShadeTextures> textures;  // in every way that a draw state asked for
  // Those that each texture unit takes, and those where the level of detail is at most 0.
  std::array<std::size_t, 2> of_unit{}, magnified_of_unit{};
  const ShadeTextures& textures_of(std::size_t unit) const { return textures[of_unit[unit]]; }
  const ShadeTextures& magnified_of(std::size_t unit) const { return textures[magnified_of_unit[unit]]; }
  std::vector<std::int32_t> alpha32;  // Q[texture.alpha](a / 255); empty where int32 does not hold it
  std::vector<std::int64_t> alpha64;
  // Q[texture.alpha](v / 255) of every raw v of texture.mix from its smallest on: prepare_second_texture().
  std::vector<std::int32_t> shares32;
  std::vector<std::int64_t> shares64;
  template <class T>
  const std::vector<T>& shares() const {
    if constexpr (sizeof(T) == 4) {
      return shares32;
    } else {
      return shares64;
    }
  }
  std::vector<std::uint8_t> zones;        // of the fog table, one per pixel; padded
  std::vector<std::int32_t> fog_table32;  // raw, fog.factor, padded; empty where int32 does not hold it

  // What gives the fragments' value of a channel that is the same at all three vertices.
  struct ShadeChain {
    bool edges = false;  // through the edge walk, which carries no value where rows start from a plane
    Exact edge_offset, span_offset;
    Register vertex, edge_acc, edge, span_acc, span;
  } chain;
};
// Whether the pipeline's draw state is in lanes, as far as the plan says it.
bool holds_state(const ShadePlan& plan, const Pipeline& pipeline);
// Whether every register of the three stages rounds by adding a constant, and saturates.
bool branch_free_shade(const ShadeFormats& formats);
ShadePlan prepare_shade(const Pipeline& pipeline, const Config& config, const Scene& scene);
// Brings the plan to what the scene has become since that version of it; the pipeline is there already.
void update_shade(ShadePlan& plan, const Pipeline& pipeline, const Config& config, const DrawnScene& scene,
                  std::uint64_t since);
// To be called before blocks are shaded in a draw state, which the pipeline has. The second unit's texture is
// ready then; those of the first are so by need_texture.
void select_textures(ShadePlan& plan, const Pipeline& pipeline, const Scene& scene);
// Makes a texture ready for a unit of the state that was selected, if it is not; its number may be anything.
void need_texture(ShadePlan& plan, const Pipeline& pipeline, const Scene& scene, std::size_t unit,
                  int texture);
// The same of a state with a second texture, where plan.holds_second.
void prepare_second_texture(ShadePlan& plan);

// The value of a colour or alpha channel on every fragment of a triangle whose vertices all have it as
// `vertex` (raw, setup.shade): raw, span.shade.
std::int64_t constant_shade(const ShadePlan& plan, std::int64_t vertex);

// The alpha of a fragment whose texels are opaque, where its own is `shade`: raw, texture.alpha and
// span.shade.
std::int64_t alpha_of(const ShadePlan& plan, std::int64_t shade);

// False only where every fragment of a triangle is opaque and none can be killed, at any level. a0, a1, a2:
// the vertices' alphas, raw, setup.shade; texture: -1 for none.
bool may_show_through(const ShadePlan& plan, int texture, std::int64_t a0, std::int64_t a1, std::int64_t a2);

// Whether nothing but a texel's alpha, or the fragment's own, can kill a fragment in this draw state.
bool kills_by_alpha_alone(const Pipeline& pipeline);
// Whether every opaque fragment in this draw state takes its pixel over, whatever was there: its depth, too.
bool replaces_pixels(const ShadePlan& plan, const Pipeline& pipeline);

// The gradients of triangles, by their input indices from `first_index` on.
struct TriangleGradients {
  std::int64_t first_index = 0;
  std::vector<GradientRecord> of;
};

// T: of the block; std::int32_t only where plan.held_in is int32, std::int64_t with any plan.
template <class T>
struct ShadeKernels {
  // Computes texture, fog and merge of a block's fragments, and writes the frame's colour. Where a fragment
  // is not killed it also writes the frame's depth if draw.store_depth, and u, v and the triangle if the
  // frame keeps them (u is not empty). Pixels may repeat in a block only where none of its fragments can be
  // killed and all are opaque: the later one stays. Counts killed and written. With a trace it appends the
  // records of texture, fog and merge; then no pixel may repeat.
  void (*shade)(const Pipeline&, const ShadePlan&, const BlockDraw&, const FragmentBlock<T>&, Frame&,
                Counters&, Trace*) = nullptr;
  // The same with observers; null for std::int32_t.
  void (*shade_observed)(const Pipeline&, const ShadePlan&, const BlockDraw&, const FragmentBlock<T>&, Frame&,
                         Counters&, Trace*, Statistics&) = nullptr;
  // The same in any draw state that lanes take, and with levels of textures; plan.holds_any. No pixel
  // repeats. Where the state's tests are late, they come behind the texture, and count as PixelTests does.
  // gradients: read where lod takes them.
  void (*shade_any)(const Pipeline&, const ShadePlan&, const BlockDraw&, const FragmentBlock<T>&,
                    const TriangleGradients& gradients, Frame&, Counters&) = nullptr;
};
// Throws InputError where the processor lacks the target. T: std::int32_t or std::int64_t.
template <class T>
ShadeKernels<T> shade_kernels(VectorTarget target);

}  // namespace bitspan::model
