// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include "config/byte_order_mark.hpp"
#include "config/config.hpp"
#include "scene/assimp.hpp"
#include "scene/bez.hpp"
#include "scene/gltf.hpp"
#include "scene/mesh_file.hpp"
#include "scene/obj.hpp"
#include "scene/plan.hpp"
#include "scene/ply.hpp"
#include "scene/quad.hpp"
#include "scene/relief.hpp"
#include "scene/texture.hpp"

namespace bitspan {
namespace {

constexpr double default_fov_degrees = 40;
// s_max / s_min of a default camera: the shipped configurations hold the scene's B from 1.25 on.
constexpr double depth_ratio_min = 1.3, depth_ratio_max = 1000;

// The bytes that tell formats apart, and the name's extension in small letters.
struct FileStart {
  std::string bytes;
  std::string extension;

  bool begins_with(std::string_view text) const { return bytes.starts_with(text); }
};

FileStart start_of(const std::string& path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    throw InputError(path + ": cannot read: is a folder; expected a mesh file");
  }
  if (std::filesystem::exists(path, code) && !std::filesystem::is_regular_file(path, code)) {
    throw InputError(path + ": cannot read: is no file; expected a mesh file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot read: " + std::strerror(errno) + "; expected a mesh file");
  FileStart start;
  start.bytes.resize(256);
  file.read(start.bytes.data(), static_cast<std::streamsize>(start.bytes.size()));
  start.bytes.resize(static_cast<std::size_t>(file.gcount()));
  start.bytes = std::string(without_mark(start.bytes));
  start.extension = std::filesystem::path(path).extension().string();
  for (char& c : start.extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return start;
}

// The contents say what a file is; an OBJ, patches and quadrics have none that do.
MeshFile read_mesh_file(const std::string& path, bool second_coordinates, int patch_depth) {
  const FileStart start = start_of(path);
  if (start.begins_with("glTF")) return read_gltf(path, second_coordinates);
  const std::size_t first = start.bytes.find_first_not_of(" \t\r\n");
  if (start.extension == ".gltf" || (first != std::string::npos && start.bytes[first] == '{')) {
    return read_gltf(path, second_coordinates);
  }
  if (start.begins_with("ply")) return read_ply(path);
  if (start.extension == ".obj") return read_obj(path);
  if (start.extension == ".bez") return patch_mesh(read_bez(path), patch_depth);
  if (start.extension == ".quad") {
    return read_quad(
        path, [&](const std::string& mesh) { return read_mesh_file(mesh, second_coordinates, patch_depth); });
  }
  return read_by_assimp(path);
}

// The smallest code of a texel's alpha that is not cut: t / 255 * alpha >= cutoff; 256 where all are.
int first_kept_code(double cutoff, double alpha) {
  for (int code = 0; code < 256; ++code) {
    if (code / 255.0 * alpha >= cutoff) return code;
  }
  return 256;
}

// The textures of a mesh: each image as often as its alpha is used in another way.
class TextureSet {
 public:
  TextureSet(const std::vector<MeshImage>& images, std::vector<Texture>& textures,
             std::vector<std::string>* bad)
      : images_(images), read_(images.size()), textures_(textures), bad_(bad) {}

  static constexpr int as_it_is = -1;
  // Returns the texture of an image whose alpha codes become 255 from `first_kept` on, and 0 below; -1 for a
  // bad one, where bad ones are gathered.
  int find_or_make(int image, int first_kept) {
    Read& read = read_[static_cast<std::size_t>(image)];
    if (!read.tried) load(static_cast<std::size_t>(image), read);
    if (!read.texture) return -1;
    if (first_kept <= read.least_alpha && read.least_alpha == 255) first_kept = as_it_is;
    const auto [entry, is_new] = known_.try_emplace({image, first_kept}, static_cast<int>(textures_.size()));
    if (is_new) make(*read.texture, first_kept);
    return entry->second;
  }

 private:
  // Of the copies of one mesh's images. Cutoffs and factors may ask for hundreds of a large one.
  static constexpr std::uint64_t bytes_limit = std::uint64_t{1} << 32;

  struct Read {
    bool tried = false;
    std::optional<Texture> texture;
    int least_alpha = 255;
  };

  void load(std::size_t index, Read& read) {
    read.tried = true;
    const MeshImage& image = images_[index];
    try {
      read.texture = image.path.empty() ? decode_texture(image.bytes, image.name) : read_texture(image.path);
    } catch (const InputError& error) {
      if (bad_ == nullptr) throw;
      bad_->emplace_back(error.what());
      return;
    }
    const std::vector<std::uint8_t>& rgba = read.texture->rgba;
    for (std::size_t i = 3; i < rgba.size(); i += 4)
      read.least_alpha = std::min<int>(read.least_alpha, rgba[i]);
  }

  void make(const Texture& source, int first_kept) {
    bytes_ += source.rgba.size();
    if (bytes_ > bytes_limit) {
      throw InputError(source.name + ": the mesh uses too many images; expected at most 4 GiB of texels");
    }
    Texture& made = textures_.emplace_back(source);
    if (first_kept == as_it_is) return;
    for (std::size_t i = 3; i < made.rgba.size(); i += 4) made.rgba[i] = made.rgba[i] >= first_kept ? 255 : 0;
  }

  const std::vector<MeshImage>& images_;
  std::vector<Read> read_;
  std::vector<Texture>& textures_;
  std::vector<std::string>* bad_;
  std::map<std::pair<int, int>, int> known_;
  std::uint64_t bytes_ = 0;
};

// Carries out the alpha mode: the alpha of the corners in place, that of the texels in the texture returned.
// The product of texel, material and vertex is what a mask cuts; it is exact where the corners have one
// alpha. Else texels and corners are cut each for themselves, and `inexact` counts the face.
int apply_alpha(const MeshMaterial& material, int image, TextureSet& textures, std::array<Corner, 3>& corners,
                std::uint64_t& inexact) {
  switch (material.alpha) {
    case AlphaMode::blend:
      return image < 0 ? -1 : textures.find_or_make(image, TextureSet::as_it_is);
    case AlphaMode::opaque:
      for (Corner& corner : corners) corner.c[3] = 1;
      return image < 0 ? -1 : textures.find_or_make(image, 0);
    case AlphaMode::mask:
      break;
  }
  const double alpha = corners[0].c[3];
  const bool one_alpha = corners[1].c[3] == alpha && corners[2].c[3] == alpha;
  if (!one_alpha) ++inexact;
  if (image >= 0 && one_alpha) {
    for (Corner& corner : corners) corner.c[3] = 1;
    return textures.find_or_make(image, first_kept_code(material.alpha_cutoff, alpha));
  }
  for (Corner& corner : corners) corner.c[3] = corner.c[3] >= material.alpha_cutoff ? 1 : 0;
  return image < 0 ? -1 : textures.find_or_make(image, first_kept_code(material.alpha_cutoff, 1));
}

Corner corner_of(const MeshCorner& from, const std::array<double, 4>& color, const std::string& path,
                 std::size_t face) {
  Corner corner{{from.position}, {from.u, from.v, from.color}};
  corner.u2 = from.u2;
  corner.v2 = from.v2;
  set_normal(corner, of_length_1(from.normal));
  for (std::size_t i = 0; i < 4; ++i) corner.c[i] *= color[i];
  const Vec3& p = corner.position;
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z) || !is_finite(corner)) {
    throw InputError(path + ": a corner of face " + std::to_string(face) +
                     " is not finite; expected finite positions, texture coordinates and colours");
  }
  return {{corner.position}, clamped(corner)};
}

// Gives the faces of a mesh the image of the second texture unit, in whose texels their second coordinates
// are then: the file's second ones, or its first ones for a map of normals.
void give_texture1(const MeshFile& file, const std::string& path, const std::string& image, bool is_map,
                   Mesh& mesh) {
  std::size_t without = 0;
  mesh.texture1 = static_cast<int>(mesh.textures.size());
  const Texture& drawn = mesh.textures.emplace_back(read_texture(image));
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const MeshTriangle& from = file.triangles[f];
    if (!(is_map ? from.has_uv : from.has_second_uv)) {
      ++without;
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const MeshCorner& given = from.corner[i];
      Corner& corner = mesh.faces[f].corner[i];
      corner.u2 = (is_map ? given.u : given.u2) * drawn.width;
      corner.v2 = (1 - (is_map ? given.v : given.v2)) * drawn.height;
    }
  }
  const std::string which = is_map ? "" : "second ";
  if (without == mesh.faces.size()) {
    throw InputError(path + ": the mesh has no " + which + "texture coordinates; expected them for " + image +
                     (is_map ? "" : ", as a glTF has them"));
  }
  if (without > 0) {
    mesh.notes.push_back(std::to_string(without) + " faces have no " + which +
                         "texture coordinates; they take 0, 0");
  }
}

}  // namespace

Mesh read_mesh(const std::string& path, const std::optional<std::string>& texture,
               std::vector<std::string>* bad_textures, const std::optional<std::string>& texture1,
               const std::optional<std::string>& relief, int patch_depth) {
  MeshFile file = read_mesh_file(path, texture1.has_value(), patch_depth);
  Mesh mesh;
  mesh.name = std::filesystem::path(path).stem().string();
  mesh.notes = std::move(file.notes);
  mesh.quadrics = std::move(file.quadrics);
  if (file.triangles.empty()) {
    std::string notes;
    for (const std::string& note : mesh.notes) notes += note + "; ";
    throw InputError(path + ": the mesh has no triangles; " + notes + "expected at least one face");
  }
  if (texture) mesh.textures.push_back(read_texture(*texture));
  TextureSet textures(file.images, mesh.textures, bad_textures);
  mesh.faces.reserve(file.triangles.size());
  bool has_uv = false;
  std::uint64_t inexact = 0;
  static const MeshMaterial white;
  for (const MeshTriangle& triangle : file.triangles) {
    const MeshMaterial& own =
        triangle.material < 0 ? white : file.materials[static_cast<std::size_t>(triangle.material)];
    const MeshMaterial& material = texture ? white : own;
    Face face;
    face.two_sided = own.two_sided;
    for (std::size_t i = 0; i < 3; ++i) {
      face.corner[i] = corner_of(triangle.corner[i], material.color, path, mesh.faces.size());
    }
    const int image = triangle.has_uv ? material.image : -1;
    face.texture =
        texture ? (triangle.has_uv ? 0 : -1) : apply_alpha(material, image, textures, face.corner, inexact);
    for (Corner& corner : face.corner) {
      if (face.texture < 0) {
        corner.u = corner.v = 0;
        continue;
      }
      const Texture& drawn = mesh.textures[static_cast<std::size_t>(face.texture)];
      corner.u *= drawn.width;
      corner.v = (1 - corner.v) * drawn.height;
    }
    has_uv = has_uv || triangle.has_uv;
    mesh.faces.push_back(face);
  }
  for (const MeshQuadric& q : mesh.quadrics) {
    for (std::size_t i = 0; i < q.count; ++i) mesh.faces[q.first + i].two_sided = q.two_sided;
  }
  if (texture && !has_uv) {
    throw InputError(path + ": the mesh has no texture coordinates; expected them for the texture " +
                     *texture);
  }
  if (inexact > 0) {
    mesh.notes.push_back(
        std::to_string(inexact) +
        " faces with alphaMode MASK have corners of different alpha; each corner is cut alone");
  }
  if (texture1) give_texture1(file, path, *texture1, false, mesh);
  if (relief) give_texture1(file, path, *relief, true, mesh);
  return mesh;
}

Vec3 middle_of(const Mesh& mesh) {
  Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3 high = low * -1;
  for (const Face& face : mesh.faces) {
    for (const Corner& corner : face.corner) {
      const Vec3& p = corner.position;
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return (low + high) * 0.5;
}

namespace {

// Leaves the light that the view has, where the configuration forms brightness of it; else the corners have
// it. Only where the view has a light there are normals.
std::optional<Light> light_mesh(Mesh& mesh, const MeshOptions& options, const Viewpoint& view) {
  const bool has_texture =
      std::ranges::any_of(mesh.faces, [](const Face& face) { return face.texture >= 0; });
  const bool is_lit =
      options.light || (!options.unlit && !has_texture && mesh.texture1 < 0 && !options.light_map);
  if (is_lit) {
    give_normals(mesh.faces);
    turn_to_viewer(mesh.faces, view, !options.project.cull);
    if (options.light) check_light(*options.light);
    const Light light = options.light
                            ? light_of(*options.light, view, options.camera.target.value_or(middle_of(mesh)))
                            : shoulder_light();
    if (options.light && options.light->by_unit) return light;
    light_corners(mesh.faces, light, view);
  }
  for (Face& face : mesh.faces) {
    for (Corner& corner : face.corner) set_normal(corner, {});
  }
  return std::nullopt;
}

// Projects the faces, and returns the quadrics with the triangles that stand for them, in the viewer's space.
std::vector<Quadric> project_mesh(const Mesh& mesh, const Viewpoint& view, const ProjectOptions& options,
                                  std::vector<Triangle>& triangles, ProjectReport& report) {
  std::vector<Quadric> out;
  std::span<const Face> faces = mesh.faces;
  std::size_t done = 0;
  const auto project_up_to = [&](std::size_t end) {
    project(faces.subspan(done, end - done), view, options, triangles, report);
    done = end;
  };
  // A parallel projection has no distances from the viewer, which forms are of.
  if (!view.parallel) {
    for (const MeshQuadric& q : mesh.quadrics) {
      project_up_to(q.first);
      Quadric seen = seen_by(q, view);
      seen.first = triangles.size();
      project_up_to(q.first + q.count);
      seen.count = triangles.size() - seen.first;
      seen.two_sided = q.two_sided || !options.cull;
      if (seen.count > 0) out.push_back(seen);
    }
  }
  project_up_to(faces.size());
  return out;
}

}  // namespace

Viewpoint make_view(const Mesh& mesh, const Camera& camera, int width, int height) {
  const Vec3 target = camera.target.value_or(middle_of(mesh));
  double radius = 0;
  for (const Face& face : mesh.faces) {
    for (const Corner& corner : face.corner) radius = std::max(radius, length(corner.position - target));
  }
  if (!(radius > 0))
    throw InputError(mesh.name + ": the mesh has no extent; expected vertices at different places");

  Viewpoint view;
  view.width = width;
  view.height = height;
  const double fov = camera.fov_degrees.value_or(default_fov_degrees);
  if (!(fov >= 1 && fov <= 170))
    throw InputError("camera: fov " + std::to_string(fov) + " is not legal; expected 1..170 degrees");
  view.focal = camera.focal.value_or(height / 2.0 / std::tan(radians(fov) / 2));
  if (!(view.focal > 0) || !std::isfinite(view.focal)) {
    throw InputError("camera: focal " + std::to_string(view.focal) +
                     " is not legal; expected a number of pixels above 0");
  }
  if (!(std::fabs(camera.pitch_degrees) <= 89) || !std::isfinite(camera.yaw_degrees)) {
    throw InputError(
        "camera: yaw or pitch is not legal; expected a finite yaw and a pitch of -89..89 degrees");
  }
  const bool is_isometric = camera.projection == Projection::isometric;
  if (is_isometric && camera.position) {
    throw InputError("camera: the isometric projection has its own direction; expected no position");
  }
  const bool is_oblique = camera.projection == Projection::oblique;
  if (!(camera.receding > 0 && camera.receding <= 4) || !std::isfinite(camera.receding_degrees)) {
    throw InputError("camera: receding lines are " + std::to_string(camera.receding) +
                     " long; expected above 0 to 4, and a finite direction");
  }
  const double half_angle = std::atan(std::min(width, height) / 2.0 / view.focal);
  // Lines away from the viewer lead out of the circle that the model is seen in.
  const double reach = radius * (is_oblique ? 1 + camera.receding : 1);
  const double distance = camera.distance.value_or(camera.closeness * 1.02 * reach / std::sin(half_angle));
  if (!(distance > 0) || !std::isfinite(distance)) {
    throw InputError("camera: distance " + std::to_string(distance) +
                     " is not legal; expected a number above 0");
  }
  const double yaw = is_isometric ? std::numbers::pi / 4 : radians(camera.yaw_degrees);
  const double pitch =
      is_isometric ? std::asin(std::tan(std::numbers::pi / 6)) : radians(camera.pitch_degrees);
  const Vec3 orbit{std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
  look_at(view, camera.position.value_or(target + orbit * distance), target, camera.up);
  if (camera.projection != Projection::central) {
    view.parallel = Parallel{.distance = length(target - view.position)};
    if (is_oblique) {
      const double angle = radians(camera.receding_degrees);
      view.parallel->shear_x = camera.receding * std::cos(angle);
      view.parallel->shear_y = -camera.receding * std::sin(angle);
    }
  }

  double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
  for (const Face& face : mesh.faces) {
    for (const Corner& corner : face.corner) {
      const double s = dot(view.forward, corner.position - view.position);
      nearest = std::min(nearest, s);
      farthest = std::max(farthest, s);
    }
  }
  // A little room, so that rounding clips nothing away.
  if (!camera.s_max && !(farthest > 0)) {
    throw InputError("camera: the model lies behind the viewer; expected it in front, or s_min and s_max");
  }
  view.s_max = camera.s_max.value_or(1.01 * farthest);
  if (!camera.s_max && camera.s_min && *camera.s_min < view.s_max) {
    view.s_max = std::max(view.s_max, *camera.s_min * depth_ratio_min);
  }
  view.s_min = camera.s_min.value_or(
      std::max(std::min(0.99 * nearest, view.s_max / depth_ratio_min), view.s_max / depth_ratio_max));
  if (!(view.s_min > 0 && view.s_min < view.s_max) || !std::isfinite(view.s_max)) {
    throw InputError("camera: s_min " + std::to_string(view.s_min) + ", s_max " + std::to_string(view.s_max) +
                     " are not legal; expected 0 < s_min < s_max");
  }
  return view;
}

Scene mesh_scene(Mesh mesh, const MeshOptions& options, ProjectReport& report) {
  const Viewpoint view = make_view(mesh, options.camera, options.width, options.height);
  Scene scene;
  scene.name = mesh.name;
  scene.width = view.width;
  scene.height = view.height;
  scene.s_min = view.s_min;
  scene.s_max = view.s_max;
  scene.focal = view.focal;
  scene.background = options.background;
  scene.fog = options.fog;
  scene.light = light_mesh(mesh, options, view);
  StateChange second;
  if (options.relief) {
    give_relief(mesh.faces, place_of(options.light.value().light));
    second = relief_state();
  }
  if (options.light_map) {
    map_light(mesh.faces, *options.light_map);
    mesh.texture1 = static_cast<int>(mesh.textures.size());
    mesh.textures.push_back(light_texture(options.light_map->side));
    second = light_map_state();
  }
  scene.quadrics = project_mesh(mesh, view, options.project, scene.triangles, report);
  scene.textures = std::move(mesh.textures);
  if (mesh.texture1 >= 0) {
    second.settings.push_back(state_setting("texture1", mesh.texture1));
    scene.commands.push_back({.before = 0, .what = second});
  }
  if (options.shadow) scene = shadowed(std::move(scene), mesh.faces, *options.shadow, view);
  if (options.slide) scene = with_slide(std::move(scene), *options.slide, view);
  return scene;
}

}  // namespace bitspan
