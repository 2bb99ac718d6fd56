// SPDX-License-Identifier: Apache-2.0
// Shadows by a depth buffer that the light sees [SH2], and slides [T14]: as pass plans over one projector.
// docs/shadow.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "scene/geometry.hpp"
#include "scene/scene.hpp"
#include "scene/transform.hpp"

namespace bitspan {

inline constexpr int shadow_map_limit = 8192;

struct ShadowOptions {
  Vec3 light;                // where it stands
  std::optional<Vec3> at{};  // what it looks at; the middle of the casters
  double degrees = 0;        // that it sees, below 160; 0: all casters, as far as they are not beside it
  int size = 1024;           // of its map, texels each way
  // How many texels of the map a lit surface may rise towards the light per texel. None: each triangle as
  // much as its slope asks for, as the light sees it.
  std::optional<double> bias{};
  // Of the map's codes, where there is no bias.
  int depth_bits = 16;
  DepthCode depth_code = DepthCode::inverse;
  // What the shadow falls on alone; then there is no map, and `at` to `bias` are not read. [SH3]
  std::optional<Plane> plane{};
  bool volumes = false;  // by shadow volumes; then there is no map, and `at` to `bias` are not read
  // By the configuration: a view's light takes the shadow of a map, all but its ambient share.
  bool light_takes = false;
  // What is left in the shadow, 0 to 1, of the colour, or of what light takes. None: 0.35, and 0 of a light.
  std::optional<double> dark{};
};
// What a message calls the options.
struct ShadowNames {
  std::string light = "shadow.light", at = "shadow.at", degrees = "shadow.degrees", size = "shadow.size",
              bias = "shadow.bias", dark = "shadow.dark", plane = "shadow.plane", volumes = "shadow.volumes";
};
// Throws InputError, whose text begins with the option's name, where one is not legal.
void check_shadow(const ShadowOptions& options, const ShadowNames& names = {});

// Codes that the registers of a shadow lose: the map's and the fragment's are rounded, and as many again are
// for the registers in front of them.
inline constexpr double codes_lost = 4;
// A depth code of a range, as 1 / W.
double code_step(const Projector& range, int depth_bits);
// All that they may lose of 1 / W at that W, reckoned: besides the codes, R_project and project.ratio err by
// a share of 1 / W, each by no more than a code is of the largest; and project.vertex by 2^-22 of the range's
// W.
double lost_by_registers(const Projector& range, int depth_bits, double w);

// What the light sees: a square picture around `at`, and the distances of the casters in it. Throws
// InputError where it stands at what it looks at.
Viewpoint view_of(std::span<const Face> casters, const ShadowOptions& options);
// How a triangle does not shade itself: it comes nearer to the light by a share of its distance, or by
// codes. Either is negative where the light is on the side that is not seen, so that it is dark.
struct ShadowBias {
  double nearer = 0;
  std::int64_t codes = 0;
};
// For a triangle of the viewer's space, as its slope asks for. Codes where its distances are far apart, since
// the farthest decides on the share.
ShadowBias bias_of(const Triangle& triangle, const View& view, const Viewpoint& light, int depth_bits);
// Gives X, Y and W of the projector to the vertices; nearer: the projector sees them nearer by this share.
void give_projection(std::span<Triangle> triangles, const View& view, const Viewpoint& projector,
                     double nearer = 0);

// The scene, drawn in the light of a lamp: a pass that draws the depth codes that the light sees of the
// casters, and one that draws the triangles with the map as texture1; or the passes of
// scene/planar_shadow.hpp or scene/shadow_volume.hpp. Light and casters are in the viewer's
// space. Where the light sees no caster, the scene stays as it is. Throws InputError for a scene with
// commands or a projector of its own.
Scene shadowed(Scene scene, std::span<const Face> casters, const ShadowOptions& options);
// The same with light and casters in the world that `view` looks at, whose picture the scene is.
Scene shadowed(Scene scene, std::span<const Face> casters, const ShadowOptions& options,
               const Viewpoint& view);

// A slide projector [T14].
struct SlideOptions {
  Texture image{};
  Vec3 projector, at;   // where it stands, and the point that the middle of the image falls on
  Vec3 up{0, -1, 0};    // in the image
  double degrees = 30;  // of the image's height, below 160
};
// The scene with an image thrown on it; what lies outside of the image is black. All is in the viewer's
// space. Throws InputError as shadowed() does.
Scene with_slide(Scene scene, const SlideOptions& slide);
// The same in the world that `view` looks at, whose picture the scene is.
Scene with_slide(Scene scene, const SlideOptions& slide, const Viewpoint& view);

}  // namespace bitspan
