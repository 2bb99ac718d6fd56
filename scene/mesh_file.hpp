// SPDX-License-Identifier: Apache-2.0
// What the reader of a mesh format returns: flat, whole and checked, whatever the format.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/geometry.hpp"
#include "scene/quadric_form.hpp"

namespace bitspan {

// An image that materials name: a file beside the mesh, or an image file that stands in the mesh.
struct MeshImage {
  std::string name;                 // what messages call it
  std::string path;                 // of a file; empty where `bytes` has it
  std::vector<std::uint8_t> bytes;  // an encoded image: PNG, JPEG, ...
};

// What becomes of the alpha of a material's texels and colours (glTF's alphaMode).
enum class AlphaMode : std::uint8_t {
  opaque,  // ignored: 1
  mask,    // 1 where it is at least the cutoff, else 0
  blend    // as it is
};

struct MeshMaterial {
  std::string name;
  int image = -1;                           // into MeshFile::images
  std::array<double, 4> color{1, 1, 1, 1};  // times the vertex's
  AlphaMode alpha = AlphaMode::blend;
  double alpha_cutoff = 0.5;
  bool two_sided = false;
};

struct MeshCorner {
  Vec3 position;
  double u = 0, v = 0;  // in textures, the origin at the bottom left; any transform of the material is done
  std::array<double, 4> color{1, 1, 1, 1};
  double u2 = 0, v2 = 0;  // the second coordinates, as u and v
  Vec3 normal{};          // outward, of any length; of length 0 or not finite: the file gives none
};

// Counterclockwise seen from its front.
struct MeshTriangle {
  std::array<MeshCorner, 3> corner;
  int material = -1;    // into MeshFile::materials; -1: white
  bool has_uv = false;  // false: the material's image is not drawn on it
  bool has_second_uv = false;
};

struct MeshFile {
  std::vector<MeshImage> images;
  std::vector<MeshMaterial> materials;
  std::vector<MeshTriangle> triangles;
  std::vector<std::string> notes;       // what the reader left out, one line each, without the file's name
  std::vector<MeshQuadric> quadrics{};  // that ranges of the triangles stand for
};

}  // namespace bitspan
