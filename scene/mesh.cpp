// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh.hpp"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
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

#include "config/config.hpp"
#include "config/one_line.hpp"
#include "scene/ply_check.hpp"
#include "scene/texture.hpp"

namespace bitspan {
namespace {

constexpr double default_fov_degrees = 40;
constexpr double depth_ratio_max = 1000;  // s_max / s_min that a default camera goes up to

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

// A material, as far as the pipeline knows materials.
struct Surface {
  int texture = -1;
  std::array<double, 4> color{1, 1, 1, 1};
  bool two_sided = false;
};

// Textures of one import: each file or embedded picture once.
class TextureSet {
 public:
  TextureSet(const aiScene& scene, std::string path, std::vector<Texture>& textures,
             std::vector<std::string>* bad)
      : scene_(scene), path_(std::move(path)), textures_(textures), bad_(bad) {}

  // Returns -1 for a bad texture, where bad ones are gathered.
  int find_or_load(const std::string& name) {
    const auto [entry, is_new] = known_.try_emplace(name, static_cast<int>(textures_.size()));
    if (!is_new) return entry->second;
    try {
      textures_.push_back(load(name));
    } catch (const InputError& error) {
      if (bad_ == nullptr) throw;
      bad_->emplace_back(error.what());
      entry->second = -1;
    }
    return entry->second;
  }

 private:
  Texture load(std::string name) const {
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) {
      const std::string origin = path_ + ": embedded texture " + name;
      if (embedded->mHeight == 0) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(embedded->pcData);
        return decode_texture({bytes, embedded->mWidth}, origin);
      }
      return from_texels(*embedded, origin);
    }
    std::replace(name.begin(), name.end(), '\\', '/');
    return read_texture((std::filesystem::path(path_).parent_path() / name).string());
  }

  static Texture from_texels(const aiTexture& embedded, const std::string& origin) {
    if (embedded.mWidth > texture_size_limit || embedded.mHeight > texture_size_limit) {
      throw InputError(origin + ": too large; expected at most " + std::to_string(texture_size_limit) +
                       " texels");
    }
    Texture texture{origin, static_cast<int>(embedded.mWidth), static_cast<int>(embedded.mHeight), {}};
    const std::size_t count = std::size_t{embedded.mWidth} * embedded.mHeight;
    for (const aiTexel& t : std::span(embedded.pcData, count)) {
      texture.rgba.insert(texture.rgba.end(), {t.r, t.g, t.b, t.a});
    }
    return texture;
  }

  const aiScene& scene_;
  std::string path_;
  std::vector<Texture>& textures_;
  std::vector<std::string>* bad_;
  std::map<std::string, int> known_;
};

Surface read_surface(const aiMaterial& material, TextureSet& textures) {
  Surface surface;
  aiString name;
  material.Get(AI_MATKEY_NAME, name);
  aiColor4D color(1, 1, 1, 1);
  // Assimp invents a grey material for files without one.
  if (std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME) != 0 &&
      material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) {
    float opacity = 1;
    material.Get(AI_MATKEY_OPACITY, opacity);
    surface.color = {color.r, color.g, color.b, std::min(color.a, opacity)};
  }
  int two_sided = 0;
  if (material.Get(AI_MATKEY_TWOSIDED, two_sided) == AI_SUCCESS) surface.two_sided = two_sided != 0;
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString file;
    if (material.GetTexture(type, 0, &file) != AI_SUCCESS || file.length == 0) continue;
    surface.texture = textures.find_or_load(file.C_Str());
    break;
  }
  return surface;
}

bool finite(const Corner& corner) {
  return std::isfinite(corner.position.x) && std::isfinite(corner.position.y) &&
         std::isfinite(corner.position.z) && is_finite(corner);
}

void append_faces(const aiMesh& part, const Surface& surface, const std::string& path, Mesh& mesh) {
  const bool has_uv = surface.texture >= 0 && part.HasTextureCoords(0);
  const double texels_u = has_uv ? mesh.textures[static_cast<std::size_t>(surface.texture)].width : 0;
  const double texels_v = has_uv ? mesh.textures[static_cast<std::size_t>(surface.texture)].height : 0;
  const auto corner_at = [&](unsigned index) {
    const aiVector3D& p = part.mVertices[index];
    Corner corner{{{p.x, p.y, p.z}}, {0, 0, surface.color}};
    if (has_uv) {
      const aiVector3D& t = part.mTextureCoords[0][index];
      corner.u = t.x * texels_u;
      corner.v = (1.0 - t.y) * texels_v;
    }
    if (part.HasVertexColors(0)) {
      const aiColor4D& c = part.mColors[0][index];
      const std::array<double, 4> color{c.r, c.g, c.b, c.a};
      for (std::size_t i = 0; i < 4; ++i) corner.c[i] *= color[i];
    }
    if (!finite(corner)) {
      throw InputError(path + ": vertex " + std::to_string(index) + " of mesh \"" +
                       one_line(part.mName.C_Str()) +
                       "\" is not finite; expected finite positions, texture coordinates and colours");
    }
    return Corner{{corner.position}, clamped(corner)};
  };
  for (const aiFace& face : std::span(part.mFaces, part.mNumFaces)) {
    if (face.mNumIndices != 3) continue;
    mesh.faces.push_back(
        {{corner_at(face.mIndices[0]), corner_at(face.mIndices[1]), corner_at(face.mIndices[2])},
         surface.texture,
         surface.two_sided});
  }
}

// What Assimp's later steps take for granted, and abort on where it does not hold.
void check_faces(const aiScene& scene, const std::string& path) {
  for (const aiMesh* part : std::span(scene.mMeshes, scene.mNumMeshes)) {
    for (const aiFace& face : std::span(part->mFaces, part->mNumFaces)) {
      const auto indices = std::span(face.mIndices, face.mNumIndices);
      if (indices.empty() ||
          std::any_of(indices.begin(), indices.end(), [&](unsigned i) { return i >= part->mNumVertices; })) {
        throw InputError(
            path +
            ": a face has no vertices or names one that is not there (truncated?); expected indices below " +
            std::to_string(part->mNumVertices));
      }
    }
  }
}

void check_readable(const std::string& path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    throw InputError(path + ": cannot read: is a folder; expected a mesh file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot read: " + std::strerror(errno) + "; expected a mesh file");
  std::array<char, 3> start{};
  file.read(start.data(), start.size());
  const auto is_letter = [](char a, char b) { return (a | 0x20) == b; };
  if (std::equal(start.begin(), start.end(), "ply", is_letter)) {
    file.seekg(0);
    check_ply(file, path);
  }
}

}  // namespace

Mesh read_mesh(const std::string& path, const std::optional<std::string>& texture,
               std::vector<std::string>* bad_textures) {
  check_readable(path);
  Mesh mesh;
  mesh.name = std::filesystem::path(path).stem().string();
  if (texture) mesh.textures.push_back(read_texture(*texture));

  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = nullptr;
  std::string reason;
  try {
    scene = importer.ReadFile(path, aiProcess_ValidateDataStructure);
    if (scene) {
      check_faces(*scene, path);
      scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType |
                                           aiProcess_PreTransformVertices);
    }
    reason = importer.GetErrorString();
    if (reason.ends_with('.')) reason.pop_back();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    reason = error.what();
  }
  if (!scene || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
    throw InputError(path +
                     ": cannot read the mesh: " + (reason.empty() ? "it is incomplete" : one_line(reason)) +
                     "; expected OBJ, PLY, glTF or another format that Assimp reads");
  }

  TextureSet textures(*scene, path, mesh.textures, bad_textures);
  std::vector<Surface> surfaces;
  bool has_uv = false;
  for (const aiMaterial* material : std::span(scene->mMaterials, scene->mNumMaterials)) {
    surfaces.push_back(texture ? Surface{0, {1, 1, 1, 1}, false} : read_surface(*material, textures));
  }
  for (const aiMesh* part : std::span(scene->mMeshes, scene->mNumMeshes)) {
    append_faces(*part, surfaces.at(part->mMaterialIndex), path, mesh);
    has_uv = has_uv || part->HasTextureCoords(0);
  }
  if (mesh.faces.empty()) throw InputError(path + ": the mesh has no triangles; expected at least one face");
  if (texture && !has_uv) {
    throw InputError(path + ": the mesh has no texture coordinates; expected them for the texture " +
                     *texture);
  }
  return mesh;
}

Viewpoint make_view(const Mesh& mesh, const Camera& camera, int width, int height) {
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
  const Vec3 target = camera.target.value_or((low + high) * 0.5);
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
  const double half_angle = std::atan(std::min(width, height) / 2.0 / view.focal);
  const double distance = camera.distance.value_or(1.02 * radius / std::sin(half_angle));
  if (!(distance > 0) || !std::isfinite(distance)) {
    throw InputError("camera: distance " + std::to_string(distance) +
                     " is not legal; expected a number above 0");
  }
  const double yaw = radians(camera.yaw_degrees), pitch = radians(camera.pitch_degrees);
  const Vec3 orbit{std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
  look_at(view, camera.position.value_or(target + orbit * distance), target, camera.up);

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
  view.s_min = camera.s_min.value_or(std::max(0.99 * nearest, view.s_max / depth_ratio_max));
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
  project(mesh.faces, view, options.project, scene.triangles, report);
  scene.textures = std::move(mesh.textures);
  return scene;
}

}  // namespace bitspan
