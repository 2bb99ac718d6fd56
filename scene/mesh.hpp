// Meshes: everything Assimp reads (OBJ, PLY, glTF, ...), with a camera.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/geometry.hpp"
#include "scene/project.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct Mesh {
  std::string name;
  std::vector<Face> faces;
  std::vector<Texture> textures;
};

// Where the viewer is. Everything left out is chosen so that the whole model is in the picture.
struct Camera {
  // Orbit around the target: yaw 0 looks along -z, growing yaw carries the viewer toward +x, growing pitch
  // upward.
  double yaw_degrees = 150;
  double pitch_degrees = 20;       // -89..89
  std::optional<double> distance;  // from the target
  std::optional<Vec3> position;    // takes the place of yaw, pitch and distance
  std::optional<Vec3> target;      // the centre of the model's bounding box
  Vec3 up{0, 1, 0};
  std::optional<double>
      fov_degrees;              // of the picture's height, 1..170; 40 where neither this nor focal is given
  std::optional<double> focal;  // pixels
  std::optional<double> s_min, s_max;  // just around the model, s_min at least s_max / 1000
};

struct MeshOptions {
  int width = 640, height = 480;
  Camera camera;
  std::optional<std::string>
      texture;  // a PNG for every face, in place of the materials' textures and colours
  ProjectOptions project;
  std::array<std::uint8_t, 3> background{};
  std::optional<Fog> fog;
};

// Reads a mesh: nodes flattened, polygons triangulated, points and lines left out. Colour is vertex colour
// times the material's diffuse colour and opacity; a material the file does not define counts as white.
// Texture files are relative to the mesh; embedded PNGs work too. u, v become texels of the face's texture, v
// turned to run downward. Throws InputError, one line: unreadable, no triangles, numbers that are not finite,
// a bad texture.
Mesh read_mesh(const std::string& path, const std::optional<std::string>& texture = std::nullopt);

// Places the viewer. Throws InputError for an impossible camera.
View make_view(const Mesh& mesh, const Camera& camera, int width, int height);

// The picture's scene; `report` says what became of the faces.
Scene mesh_scene(Mesh mesh, const MeshOptions& options, ProjectReport& report);

}  // namespace bitspan
