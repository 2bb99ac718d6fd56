// SPDX-License-Identifier: Apache-2.0
// light: the brightness of a surface by the light of its view (L1, L2), at a face (L4), a vertex (L5) or a
// pixel (L6), and a fragment's colour times it. docs/numeric-spec.md, "light".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/root.hpp"
#include "model/stages/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct LightStage {
  bool is_on = false;  // the configuration has the stage, and the view a light
  bool at_pixels = false, at_faces = false;
  bool is_point = false;
  bool takes_map = false;  // of normals, where the draw state has one:
  bool has_map = false;
  bool takes_shadow = false;  // of a shadow map, where the draw state has one:
  bool has_shadow = false;
  bool is_lunar = false;
  bool falls = false, by_square = false, to_viewer = false;  // with a distance, to that
  bool takes_place = false;                                  // of what is lit
  ReciprocalRoot root;
  Register given_normal, position, normal, direction, cosine, specular, value, color;
  Register inverse, lunar, distance, fall;
  Register relief, uv, texel;  // of a map of normals
  Register share;              // that a shadow leaves of the light
  Register coordinate, vertex_s, pixel_s;
  int exponent = 0;                                      // E: distances are divided by 2^E
  Exact scale;                                           // 1 / F
  Exact per_reach;                                       // 1 / reach
  std::int64_t offset = 0, lunar_k = 0;                  // raw, light.distance and light.lunar
  std::int64_t width = 0, height = 0;                    // of the picture
  std::array<std::int64_t, 3> place{};                   // raw, light.position: of a point
  bool places_fit_int64 = false;                         // of pixels: the products that they are rounded from
  std::array<std::int64_t, 3> far_direction{};           // of length 1
  std::int64_t ambient = 0, highlight = 0, diffuse = 0;  // their shares, raw, light.value
  int index_bits = 0;
  std::vector<std::int64_t> table;  // raw, light.specular; at both ends of 2^index_bits intervals
};
// Throws InputError where the view's light is not one that the configuration takes.
template <class Watch = NoObserve>
LightStage prepare_light(const Config& config, const Constants& constants, const Scene& scene,
                         Watch watch = {});

void set_light(LightStage& stage, const DrawState& state);
// Whether the second unit's texel is for light alone.
inline bool takes_texel(const LightStage& stage) { return stage.has_map || stage.has_shadow; }

// The channel light at a vertex, raw in `vertex`.
template <class Watch = NoObserve>
std::int64_t light_at(const LightStage& stage, const Vertex& v, const Register& vertex, Watch watch = {});

// What light takes of a fragment's channels.
struct LightChannels {
  std::array<std::int64_t, 3> normal{};  // raw, normal.value; at pixels
  std::int64_t value = 0;                // raw, light.value; else
  // Over a map of normals: where the light is in it, raw, relief.value, and the fragment, span.uv.
  std::array<std::int64_t, 3> place{};
  std::array<std::int64_t, 2> at{};
};
// The brightness of a fragment, and at pixels what it is made of; distance: where a light stands at a point;
// texture: behind both units, of a map.
template <class Watch = NoObserve>
void brighten(const LightStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
              const LightChannels& channels, const TextureRecord& texture, LightRecord& out,
              Watch watch = {});
// The same, and the colour of a fragment that is drawn.
template <class Watch = NoObserve>
void light(const LightStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
           const LightChannels& channels, const TextureRecord& texture, LightRecord& out, Watch watch = {});

// The texture's record as the stages behind light read it.
inline TextureRecord lit(TextureRecord texture, const LightRecord& light) {
  texture.r = light.r;
  texture.g = light.g;
  texture.b = light.b;
  return texture;
}

}  // namespace bitspan::model
