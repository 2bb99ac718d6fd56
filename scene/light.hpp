// SPDX-License-Identifier: Apache-2.0
// Meshes under a light: their normals, and the brightness of their corners where the configuration has no
// unit that forms it. docs/light.md.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "scene/geometry.hpp"
#include "scene/scene.hpp"
#include "scene/transform.hpp"

namespace bitspan {

// Faces that meet at a smaller angle share their normals.
inline constexpr double crease_degrees = 45;

struct LightOptions {
  // In the coordinates of the mesh; one that is no point is far away in the direction of its place, seen from
  // what the viewer looks at.
  Light light;
  bool by_unit = false;  // the view has the light, and the configuration forms brightness of it
};
// Throws InputError, whose text begins with `name`, where one is not legal.
void check_light(const LightOptions& options, const std::string& name = "light");

Vec3 place_of(const Light& light);
// Normal to the face, outward, of a length that is twice its area.
Vec3 area_vector(const Face& face);
// Gives the corners without a normal one: the mean of the area vectors of the faces that meet there, of those
// that the crease does not divide from the corner's own face.
void give_normals(std::span<Face> faces, double crease = crease_degrees);
// Turns the normals of faces that are drawn from behind round to the viewer; all: also those of one side.
void turn_to_viewer(std::span<Face> faces, const Viewpoint& view, bool all);

// The light as the viewer sees it; target: what the viewer looks at.
Light light_of(const LightOptions& options, const Viewpoint& view, const Vec3& target);
// One at the viewer's left shoulder, for a mesh without a texture.
Light shoulder_light();

// Multiplies the colours of the corners by their brightness, in double precision [L5].
void light_corners(std::span<Face> faces, const Light& light, const Viewpoint& view);

}  // namespace bitspan
