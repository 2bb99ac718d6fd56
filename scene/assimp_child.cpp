// SPDX-License-Identifier: Apache-2.0
// The program bitspan-assimp FILE: reads a mesh by Assimp and writes the answer of scene/mesh_binary.hpp. It
// is a program of its own, so that no fault of a reader that is not ours, and no file, ends the one that
// waits.
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/affine.hpp"
#include "scene/mesh_binary.hpp"

namespace bitspan {
namespace {

constexpr rlim_t processor_seconds = 60;
constexpr rlim_t memory_bytes = rlim_t{8} << 30;

void set_limits() {
  const auto limit = [](auto resource, rlim_t value) {
    const rlimit both{value, value};
    ::setrlimit(resource, &both);
  };
  limit(RLIMIT_CORE, 0);
  // The first signal, SIGXCPU, ends the program and says why.
  const rlimit processor{processor_seconds, processor_seconds + 1};
  ::setrlimit(RLIMIT_CPU, &processor);
#ifndef __SANITIZE_ADDRESS__  // which reserves terabytes
  limit(RLIMIT_AS, memory_bytes);
#endif
}

// The texels of an embedded picture as a TGA of 32 bits, rows from the top.
std::vector<std::uint8_t> tga_of(const aiTexture& picture) {
  const auto low = [](unsigned n) { return static_cast<std::uint8_t>(n & 255); };
  const auto high = [](unsigned n) { return static_cast<std::uint8_t>(n >> 8 & 255); };
  std::vector<std::uint8_t> out{0,
                                0,
                                2,
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                0,
                                low(picture.mWidth),
                                high(picture.mWidth),
                                low(picture.mHeight),
                                high(picture.mHeight),
                                32,
                                0x28};
  if (picture.mWidth > 0xffff || picture.mHeight > 0xffff) return {};
  for (const aiTexel& t : std::span(picture.pcData, std::size_t{picture.mWidth} * picture.mHeight)) {
    out.insert(out.end(), {t.b, t.g, t.r, t.a});
  }
  return out;
}

// What is made of a scene of Assimp's.
class Conversion {
 public:
  Conversion(const aiScene& scene, std::filesystem::path path) : scene_(scene), path_(std::move(path)) {}

  MeshFile convert() {
    for (const aiMaterial* material : std::span(scene_.mMaterials, scene_.mNumMaterials)) append(*material);
    // A list takes the place of recursion over the nodes.
    std::vector<std::pair<const aiNode*, Affine>> open{{scene_.mRootNode, Affine{}}};
    while (!open.empty()) {
      const auto [node, parent] = open.back();
      open.pop_back();
      const Affine world = parent * affine_of(node->mTransformation);
      for (const unsigned index : std::span(node->mMeshes, node->mNumMeshes))
        append(*scene_.mMeshes[index], world);
      for (unsigned i = node->mNumChildren; i-- > 0;) open.emplace_back(node->mChildren[i], world);
    }
    const auto note = [&](std::uint64_t count, const std::string& what) {
      if (count > 0) out_.notes.push_back(std::to_string(count) + " " + what);
    };
    note(points_and_lines_, "points and lines are left out");
    note(bones_, "meshes with bones stand where their nodes are");
    note(scene_.mNumAnimations, "animations are left out: nodes stand where the file places them");
    note(scene_.mNumCameras, "cameras are left out: the picture has the viewer of the command");
    return std::move(out_);
  }

 private:
  static Affine affine_of(const aiMatrix4x4& m) {
    return {{Vec3{m.a1, m.b1, m.c1}, Vec3{m.a2, m.b2, m.c2}, Vec3{m.a3, m.b3, m.c3}}, {m.a4, m.b4, m.c4}};
  }

  int image(const std::string& name) {
    const auto [entry, is_new] = images_.try_emplace(name, static_cast<int>(out_.images.size()));
    if (!is_new) return entry->second;
    MeshImage& image = out_.images.emplace_back();
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) {
      image.name = path_.string() + ": embedded texture " + name;
      if (embedded->mHeight == 0) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(embedded->pcData);
        image.bytes.assign(bytes, bytes + embedded->mWidth);
      } else {
        image.bytes = tga_of(*embedded);
      }
      return entry->second;
    }
    std::string file = name;
    std::replace(file.begin(), file.end(), '\\', '/');
    image.path = (path_.parent_path() / file).string();
    image.name = image.path;
    return entry->second;
  }

  void append(const aiMaterial& material) {
    MeshMaterial& out = out_.materials.emplace_back();
    unsigned channel = 0;
    aiString name;
    material.Get(AI_MATKEY_NAME, name);
    out.name = name.C_Str();
    aiColor4D color(1, 1, 1, 1);
    // Assimp invents a grey material for files without one.
    if (std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME) != 0 &&
        material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) {
      float opacity = 1;
      material.Get(AI_MATKEY_OPACITY, opacity);
      out.color = {color.r, color.g, color.b, std::min(color.a, opacity)};
    }
    int two_sided = 0;
    if (material.Get(AI_MATKEY_TWOSIDED, two_sided) == AI_SUCCESS) out.two_sided = two_sided != 0;
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      aiString file;
      if (material.GetTexture(type, 0, &file) != AI_SUCCESS || file.length == 0) continue;
      out.image = image(file.C_Str());
      int set = 0;
      if (material.Get(AI_MATKEY_UVWSRC(type, 0), set) == AI_SUCCESS && set >= 0)
        channel = static_cast<unsigned>(set);
      break;
    }
    channels_.push_back(channel);
  }

  void append(const aiMesh& part, const Affine& world) {
    const unsigned channel = channels_.at(part.mMaterialIndex);
    const bool has_uv = channel < AI_MAX_NUMBER_OF_TEXTURECOORDS && part.HasTextureCoords(channel);
    const auto corner_at = [&](unsigned index) {
      const aiVector3D& p = part.mVertices[index];
      MeshCorner corner;
      corner.position = world.point({p.x, p.y, p.z});
      if (part.HasNormals()) {
        const aiVector3D& n = part.mNormals[index];
        corner.normal = world.normal({n.x, n.y, n.z});
      }
      if (has_uv) {
        corner.u = part.mTextureCoords[channel][index].x;
        corner.v = part.mTextureCoords[channel][index].y;
      }
      if (part.HasVertexColors(0)) {
        const aiColor4D& c = part.mColors[0][index];
        corner.color = {c.r, c.g, c.b, c.a};
      }
      return corner;
    };
    const bool mirrors = world.mirrors();
    if (part.HasBones()) ++bones_;
    for (const aiFace& face : std::span(part.mFaces, part.mNumFaces)) {
      if (face.mNumIndices != 3) {
        ++points_and_lines_;
        continue;
      }
      MeshTriangle triangle{
          {corner_at(face.mIndices[0]), corner_at(face.mIndices[1]), corner_at(face.mIndices[2])},
          static_cast<int>(part.mMaterialIndex),
          has_uv};
      if (mirrors) std::swap(triangle.corner[1], triangle.corner[2]);
      out_.triangles.push_back(triangle);
    }
  }

  const aiScene& scene_;
  std::filesystem::path path_;
  MeshFile out_;
  std::vector<unsigned> channels_;  // of texture coordinates, per material
  std::map<std::string, int> images_;
  std::uint64_t points_and_lines_ = 0, bones_ = 0;
};

// What Assimp's later steps take for granted.
bool faces_are_whole(const aiScene& scene) {
  for (const aiMesh* part : std::span(scene.mMeshes, scene.mNumMeshes)) {
    for (const aiFace& face : std::span(part->mFaces, part->mNumFaces)) {
      const auto indices = std::span(face.mIndices, face.mNumIndices);
      if (indices.empty() ||
          std::any_of(indices.begin(), indices.end(), [&](unsigned i) { return i >= part->mNumVertices; })) {
        return false;
      }
    }
  }
  return true;
}

MeshAnswer read(const char* path) {
  Assimp::Importer importer;
  // These have readers of their own, which do not invent what a file leaves out.
  for (const char* extension : {"obj", "ply", "gltf", "glb"}) {
    while (Assimp::BaseImporter* known = importer.GetImporter(extension)) importer.UnregisterLoader(known);
  }
  const auto refusal = [&] {
    std::string reason = importer.GetErrorString();
    if (reason.ends_with('.')) reason.pop_back();
    return MeshAnswer{{}, reason.empty() ? "it is incomplete" : reason};
  };
  const aiScene* scene = importer.ReadFile(path, aiProcess_ValidateDataStructure);
  if (scene == nullptr) return refusal();
  if (!faces_are_whole(*scene))
    return {{}, "a face has no vertices or names one that is not there (truncated?)"};
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_TransformUVCoords);
  if (scene == nullptr || scene->mRootNode == nullptr || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
    return refusal();
  }
  return {Conversion(*scene, path).convert(), {}};
}

MeshAnswer answer(const char* path) {
  try {
    return read(path);
  } catch (const std::bad_alloc&) {
    return {{}, "it takes more than 8 GiB"};
  } catch (const std::exception& error) {
    return {{}, error.what()};
  }
}

bool write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace
}  // namespace bitspan

int main(int count, char** arguments) {
  if (count != 2) return 2;
  bitspan::set_limits();
  // What a library prints is no part of the answer.
  const int out = ::dup(STDOUT_FILENO);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (out < 0 || nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0) return 1;
  try {
    // Assimp's destructors take their time.
    ::_exit(bitspan::write_all(out, bitspan::encode_mesh(bitspan::answer(arguments[1]))) ? 0 : 1);
  } catch (const std::exception&) {
    return 1;
  }
}
