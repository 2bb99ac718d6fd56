// SPDX-License-Identifier: Apache-2.0
// The truth that errors are measured from; docs/numeric-spec.md, "ideal". It is a closed form at each point,
// not incremental. Only the vertices' positions are quantised, since they are the hardware's input.
//
// The configuration decides only the snap (raster), the fill rule, the depth code, the texture's filter,
// wrap, mip chain and transparent colour, the level of detail, and the fog's mode. Perspective is always
// correct, whatever mode the hardware has. The values are computed in long double (64 significant bits) from
// exact integer areas, and delivered as double.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "golden/ideal_point.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// The light of a surface; the vectors have length 1, or are 0.
struct IdealLight {
  std::array<double, 3> normal{}, direction{};
  double cosine = 0;    // of normal and direction
  double mirrored = 0;  // of the direction to the viewer and the mirrored light
  double specular = 0;  // the highlight
  double value = 1;     // brightness
};

// The fragment of pixel (x, y), through texture and fog.
struct IdealFragment {
  IdealPoint point;                      // at the pixel's centre
  double z = 0;                          // the configured depth code, in front of bias and packing
  int dz = 0;                            // float_dz: log2 of dz, as the word holds it
  double lambda = 0;                     // level of detail, where textures have mip chains
  std::array<double, 4> texel{};         // V: colour codes 0..255, and alpha 0..1
  std::array<double, 3> color{};         // V times shade, colour codes
  double alpha = 1;                      // of texel and shade
  std::array<double, 3> second_texel{};  // of the second unit, colour codes
  IdealLight light;                      // in a view with one
  std::array<double, 3> lit{};           // the colour, times the light
  double fog_factor = 1;                 // share of the object's own colour
  std::array<double, 3> fogged{};        // colour codes
  bool killed = false;                   // by the transparent code or alpha 0
};

// Returns the values of the triangle's plane at pixel (x, y), whether the triangle covers it or not. levels:
// the scene's golden::scene_levels; null: the chain is formed for this call alone.
IdealFragment ideal_at(const Config& config, const Scene& scene, const IdealTriangle& triangle,
                       std::int64_t x, std::int64_t y,
                       const std::vector<std::vector<Texture>>* levels = nullptr);

// Returns the unquantised depth code as it is stored: with the bias, and packed where the code is.
double ideal_stored_code(const Config& config, const IdealFragment& fragment, std::int64_t bias);

// Makes an engine that draws with the functions above. It has no registers, so it appends nothing to a trace.
// It fills these counters: triangles, degenerate, fragments, covered, depth_passed, killed and written.
std::unique_ptr<Engine> make_ideal(const Config& config);

}  // namespace bitspan
