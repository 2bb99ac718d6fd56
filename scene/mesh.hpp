// SPDX-License-Identifier: Apache-2.0
// Meshes: OBJ, PLY, glTF, patches, quadrics and, through a program of its own, what Assimp reads; with a
// camera.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/generate/patch.hpp"
#include "scene/geometry.hpp"
#include "scene/light.hpp"
#include "scene/light_map.hpp"
#include "scene/project.hpp"
#include "scene/quadric_form.hpp"
#include "scene/scene.hpp"
#include "scene/shadow.hpp"

namespace bitspan {

struct Mesh {
  std::string name;
  std::vector<Face> faces;
  std::vector<Texture> textures;
  int texture1 = -1;               // into textures: of the second texture unit, in whose texels u2 and v2 are
  std::vector<std::string> notes;  // what of the file is not shown, one line each, without the file's name
  std::vector<MeshQuadric> quadrics{};  // that ranges of the faces stand for
};

// How space becomes a picture [B6]: by lines of sight that meet in the viewer, or by parallel ones.
// isometric: orthographic, from where the three axes are equally short. oblique: the picture's plane is to
// scale, and what lies behind it goes to the upper right.
BITSPAN_ENUM(Projection, central, orthographic, isometric, oblique);

// Where the viewer is. The defaults put the whole model into the picture.
struct Camera {
  // Orbit around the target: yaw 0 looks along -z, growing yaw carries the viewer toward +x, growing pitch
  // upward.
  double yaw_degrees = 150;
  double pitch_degrees = 20;       // -89..89
  std::optional<double> distance;  // from the target
  double closeness = 1;            // of the distance, where none is given
  std::optional<Vec3> position;    // takes the place of yaw, pitch and distance
  std::optional<Vec3> target;      // the centre of the model's bounding box
  Vec3 up{0, 1, 0};
  // A parallel one is as large as the central one at the target, and needs depth.line = z. isometric takes
  // the place of yaw, pitch and position.
  Projection projection = Projection::central;
  double receding = 0.5,
         receding_degrees = 45;  // oblique: length and direction of lines away from the viewer
  std::optional<double>
      fov_degrees;              // of the picture's height, 1..170; 40 where neither this nor focal is given
  std::optional<double> focal;  // pixels
  std::optional<double> s_min, s_max;  // just around the model, s_max / s_min 1.3..1000
};

struct MeshOptions {
  int width = 640, height = 480;
  Camera camera;
  std::optional<std::string>
      texture;  // an image for every face, in place of the materials' textures and colours
  std::optional<std::string>
      texture1;  // an image for the second texture unit, at the second coordinates of a glTF
  ProjectOptions project;
  std::array<std::uint8_t, 3> background{};
  std::optional<Fog> fog;
  // In the coordinates of the mesh. Without one, a mesh without a texture has a light at the viewer's
  // shoulder, unless it is to be seen without light.
  std::optional<LightOptions> light;
  bool unlit = false;
  // An image of normals for the second texture unit, at the file's coordinates [T15]. Beside a light at a
  // point by the unit, and in place of `texture1`.
  std::optional<std::string> relief;
  // Light as a texture, by the second texture unit. In place of `light` and `texture1`.
  std::optional<LightMapOptions> light_map;
  // In the coordinates of the mesh; one of them at most.
  std::optional<ShadowOptions> shadow;
  std::optional<SlideOptions> slide;
};

// Reads a mesh, known by its contents, an OBJ, patches (.bez) and quadrics (.quad) by their names. Patches
// become triangles, 2^patch_depth steps each way. Nodes are flattened, polygons are triangulated, points and
// lines are left out. The colour is the vertex colour times the material's; a material that the file does not
// define counts as white. An alpha mode is carried out in the texels and the corners. Texture files are
// relative to the mesh; embedded images work too. u, v become texels of the face's texture, with v turned to
// run downward. Throws InputError with one line where the file is unreadable or has no triangles, a number is
// not finite, or a texture is bad. With `bad_textures`, a bad texture that the mesh names appends its line
// there instead, and its faces have no texture. texture1, relief: as in MeshOptions; a face without the
// coordinates has its texel at (0, 0), and a mesh without any throws. Corners have the file's normals, of
// length 1, where it has some.
Mesh read_mesh(const std::string& path, const std::optional<std::string>& texture = std::nullopt,
               std::vector<std::string>* bad_textures = nullptr,
               const std::optional<std::string>& texture1 = std::nullopt,
               const std::optional<std::string>& relief = std::nullopt, int patch_depth = patch_k_default);

// Of the box that holds all corners.
Vec3 middle_of(const Mesh& mesh);

// Returns the view of the camera. Throws InputError where the camera is impossible.
Viewpoint make_view(const Mesh& mesh, const Camera& camera, int width, int height);

// Returns the picture's scene; `report` says what became of the faces.
Scene mesh_scene(Mesh mesh, const MeshOptions& options, ProjectReport& report);

}  // namespace bitspan
