// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "io/png.hpp"
#include "scene/tri_stream.hpp"
#include "tests/scene/gltf_builder.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

using Bytes = std::vector<std::uint8_t>;

// 4 x 2 texels: red, green / blue, white from the top left, each two wide.
const Bytes checker{255, 0, 0,   255, 0, 0,   0,   255, 0,   0,   255, 0,
                    0,   0, 255, 0,   0, 255, 255, 255, 255, 255, 255, 255};

using testing_gltf::base64;

const char* const quad_obj =
    "mtllib q.mtl\n"
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl skin\n"
    "f 1/1 2/2 3/3 4/4\n";

Camera front() {
  Camera camera;
  camera.position = Vec3{0, 0, 5};
  camera.target = Vec3{0, 0, 0};
  camera.focal = 100;
  camera.s_min = 1;
  camera.s_max = 10;
  return camera;
}

Scene load(const std::string& path, const MeshOptions& options, ProjectReport& report) {
  return mesh_scene(read_mesh(path, options.texture), options, report);
}

TEST(Mesh, ObjWithMaterialTexture) {
  const TemporaryFolder folder;
  const std::string path = folder.write("q.obj", quad_obj);
  folder.write("q.mtl", "newmtl skin\nKd 1 0.5 0.25\nd 0.5\nmap_Kd skin.png\n");
  write_png(folder.path("skin.png"), 4, 2, 3, checker);
  MeshOptions options;
  options.width = options.height = 100;
  options.camera = front();
  ProjectReport report;
  const Scene scene = load(path, options, report);
  EXPECT_EQ(report.faces, 2U);
  ASSERT_EQ(scene.triangles.size(), 2U);
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.textures[0].width, 4);
  EXPECT_NO_THROW(check_scene(scene, "q"));
  int corners = 0;
  for (const Triangle& t : scene.triangles) {
    EXPECT_EQ(t.texture, 0);
    for (const Vertex& v : t.v) {
      // 1 world unit at s = 5 is 20 pixels; the picture's top left shows the texture's top left.
      EXPECT_NEAR(v.s, 5, 1e-12);
      EXPECT_NEAR(v.u, (v.x - 30) / 40 * 4, 1e-9);
      EXPECT_NEAR(v.v, (v.y - 30) / 40 * 2, 1e-9);
      EXPECT_NEAR(v.c[0], 1, 1e-6);
      EXPECT_NEAR(v.c[1], 0.5, 1e-6);
      EXPECT_NEAR(v.c[2], 0.25, 1e-6);
      EXPECT_NEAR(v.c[3], 0.5, 1e-6);
      ++corners;
    }
  }
  EXPECT_EQ(corners, 6);
}

TEST(Mesh, TextureByFlagTakesThePlaceOfMaterials) {
  const TemporaryFolder folder;
  const std::string path = folder.write("q.obj", quad_obj);
  folder.write("q.mtl", "newmtl skin\nKd 0 0 0\nmap_Kd none.png\n");
  write_png(folder.path("other.png"), 4, 2, 3, checker);
  EXPECT_NE(input_error([&] { read_mesh(path); }).find("none.png: cannot read the texture"),
            std::string::npos);
  const Mesh mesh = read_mesh(path, folder.path("other.png"));
  ASSERT_EQ(mesh.textures.size(), 1U);
  EXPECT_EQ(mesh.faces[0].texture, 0);
  EXPECT_EQ(mesh.faces[0].corner[0].c, (std::array<double, 4>{1, 1, 1, 1}));
}

TEST(Mesh, BadTexturesAreGatheredAndTheirFacesAreWhite) {
  const TemporaryFolder folder;
  const std::string path = folder.write("q.obj", quad_obj);
  folder.write("q.mtl", "newmtl skin\nmap_Kd none.png\n");
  std::vector<std::string> bad;
  const Mesh mesh = read_mesh(path, std::nullopt, &bad);
  ASSERT_EQ(bad.size(), 1U);
  EXPECT_NE(bad[0].find("none.png: cannot read the texture"), std::string::npos);
  EXPECT_TRUE(mesh.textures.empty());
  for (const Face& face : mesh.faces) EXPECT_EQ(face.texture, -1);
}

TEST(Mesh, TextureWithoutCoordinatesIsRefused) {
  const TemporaryFolder folder;
  write_png(folder.path("t.png"), 4, 2, 3, checker);
  const std::string path = folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_NE(input_error([&] { read_mesh(path, folder.path("t.png")); }).find("no texture coordinates"),
            std::string::npos);
}

TEST(Mesh, PlyWithVertexColours) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "c.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 51\n3 0 1 2\n");
  const Mesh mesh = read_mesh(path);
  ASSERT_EQ(mesh.faces.size(), 1U);
  EXPECT_EQ(mesh.faces[0].texture, -1);
  const auto& corner = mesh.faces[0].corner;
  EXPECT_EQ(corner[0].c, (std::array<double, 4>{1, 0, 0, 1}));
  EXPECT_EQ(corner[1].c, (std::array<double, 4>{0, 1, 0, 1}));
  EXPECT_NEAR(corner[2].c[2], 0.2, 1e-6);
}

TEST(Mesh, GltfWithEmbeddedTextureAndNodeTransform) {
  const TemporaryFolder folder;
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const float coordinates[] = {0, 1, 1, 1, 0, 0};  // glTF counts v downward
  const std::uint16_t indices[] = {0, 1, 2};
  Bytes buffer(sizeof positions + sizeof coordinates + sizeof indices);
  std::memcpy(buffer.data(), positions, 36);
  std::memcpy(buffer.data() + 36, coordinates, 24);
  std::memcpy(buffer.data() + 60, indices, 6);
  const std::string text =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"mesh":0,"translation":[10,20,30]}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0}]}],)"
      R"("materials":[{"doubleSided":true,"pbrMetallicRoughness":{"baseColorTexture":{"index":0},)"
      R"("baseColorFactor":[1,0.5,1,1]}}],)"
      R"("textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,)" +
      base64(encode_png(4, 2, 3, checker)) +
      R"("}],"buffers":[{"byteLength":66,"uri":"data:application/octet-stream;base64,)" + base64(buffer) +
      R"("}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},)"
      R"({"buffer":0,"byteOffset":60,"byteLength":6}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
      R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},)"
      R"({"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}]})";
  const Mesh mesh = read_mesh(folder.write("g.gltf", text));
  ASSERT_EQ(mesh.faces.size(), 1U);
  ASSERT_EQ(mesh.textures.size(), 1U);
  EXPECT_EQ(mesh.textures[0].rgba.size(), 32U);
  EXPECT_EQ(mesh.textures[0].rgba[0], 255);
  EXPECT_EQ(mesh.faces[0].texture, 0);
  EXPECT_TRUE(mesh.faces[0].two_sided);
  bool found = false;
  for (const Corner& c : mesh.faces[0].corner) {
    if (c.position != Vec3{10, 21, 30}) continue;
    found = true;
    EXPECT_NEAR(c.u, 0, 1e-6);
    EXPECT_NEAR(c.v, 0, 1e-6) << "the upper corner shows the picture's top";
    EXPECT_NEAR(c.c[1], 0.5, 1e-6);
  }
  EXPECT_TRUE(found);
}

const char* const cube_obj =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 5 6 7 8\nf 2 1 4 3\nf 6 2 3 7\nf 1 5 8 4\nf 8 7 3 4\nf 1 2 6 5\n";

TEST(Mesh, DefaultCameraFramesTheModel) {
  const TemporaryFolder folder;
  const Mesh cube = read_mesh(folder.write("cube.obj", cube_obj));
  EXPECT_EQ(cube.faces.size(), 12U);
  for (const auto& [width, height] : {std::pair{640, 480}, {100, 300}, {900, 90}}) {
    for (double yaw = -180; yaw <= 180; yaw += 45) {
      MeshOptions options;
      options.width = width;
      options.height = height;
      options.camera.yaw_degrees = yaw;
      options.camera.pitch_degrees = yaw / 3;
      ProjectReport report;
      const Scene scene = mesh_scene(cube, options, report);
      EXPECT_EQ(report.clipped, 0U);
      EXPECT_EQ(report.outside, 0U);
      EXPECT_EQ(report.culled + report.triangles, 12U);
      EXPECT_LE(report.triangles, 6U);
      EXPECT_GE(report.triangles, 2U);
      double top = height, bottom = 0;
      for (const Triangle& t : scene.triangles) {
        for (const Vertex& v : t.v) {
          top = std::min(top, v.y);
          bottom = std::max(bottom, v.y);
        }
      }
      EXPECT_GT(bottom - top, std::min(width, height) * 0.35) << "not lost in the distance";
    }
  }
}

TEST(Mesh, DefaultCameraKeepsTheRatioOfDistances) {
  const TemporaryFolder folder;
  const Mesh quad = read_mesh(folder.write("q.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n"));
  Camera camera;
  camera.yaw_degrees = camera.pitch_degrees = 0;
  Viewpoint view = make_view(quad, camera, 64, 64);
  EXPECT_GE(view.s_max / view.s_min, 1.299999);
  camera.s_min = 2;
  view = make_view(quad, camera, 64, 64);
  EXPECT_EQ(view.s_min, 2);
  EXPECT_GE(view.s_max / view.s_min, 1.299999);
  camera.s_min = view.s_max / 1.05;  // still before the quad
  view = make_view(quad, camera, 64, 64);
  EXPECT_GE(view.s_max / view.s_min, 1.299999);
  camera.s_min = std::nullopt;
  camera.distance = 3;
  camera.yaw_degrees = 89;  // the near edge is close to the viewer
  view = make_view(quad, camera, 64, 64);
  EXPECT_GT(view.s_max / view.s_min, 1.5);
}

TEST(Mesh, NearPlaneCutsAndCounts) {
  const TemporaryFolder folder;
  MeshOptions options;
  options.camera.position = Vec3{0, 0, 1.5};
  options.camera.target = Vec3{0, 0, 0};
  options.camera.s_min = 1;
  options.camera.s_max = 2;
  ProjectReport report;
  const Scene scene = load(folder.write("cube.obj", cube_obj), options, report);
  EXPECT_EQ(report.culled, 10U) << "all but the near face";
  EXPECT_EQ(report.drawn, 0U);
  EXPECT_EQ(report.outside, 2U) << "that one is before s_min";
  EXPECT_TRUE(scene.triangles.empty());
  options.project.cull = false;
  options.camera.fov_degrees = 120;
  report = {};
  const Scene open = mesh_scene(read_mesh(folder.path("cube.obj")), options, report);
  EXPECT_GT(report.clipped, 0U);
  EXPECT_FALSE(open.triangles.empty());
}

TEST(Mesh, ImpossibleCameras) {
  const TemporaryFolder folder;
  const Mesh cube = read_mesh(folder.write("cube.obj", cube_obj));
  const auto refused = [&](auto&& change) {
    Camera camera;
    change(camera);
    return input_error([&] { make_view(cube, camera, 64, 64); });
  };
  EXPECT_NE(refused([](Camera& c) { c.fov_degrees = 0; }).find("fov"), std::string::npos);
  EXPECT_NE(refused([](Camera& c) { c.focal = -1; }).find("focal"), std::string::npos);
  EXPECT_NE(refused([](Camera& c) { c.distance = 0; }).find("distance"), std::string::npos);
  EXPECT_NE(refused([](Camera& c) { c.pitch_degrees = 90; }).find("pitch"), std::string::npos);
  EXPECT_NE(refused([](Camera& c) {
              c.position = c.target = Vec3{1, 2, 3};
            }).find("coincide"),
            std::string::npos);
  EXPECT_NE(refused([](Camera& c) { c.s_min = 5, c.s_max = 4; }).find("s_min"), std::string::npos);
  EXPECT_NE(refused([](Camera& c) {
              c.position = Vec3{0, 0, 9}, c.target = Vec3{0, 0, 20};
            }).find("behind"),
            std::string::npos);
}

// Assimp alone does not return from some of these, aborts on others, and reads yet others without a word.
TEST(Mesh, RefusesEveryTruncatedPly) {
  const TemporaryFolder folder;
  const std::string whole =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 1\n3 0 1 2\n3 1 3 2\n";
  EXPECT_EQ(read_mesh(folder.write("t.ply", whole)).faces.size(), 2U);
  for (std::size_t length = 0; length + 1 < whole.size(); ++length) {
    input_error([&] { read_mesh(folder.write("t.ply", std::string_view(whole).substr(0, length))); });
    ASSERT_FALSE(HasFailure()) << "cut to " << length << " bytes";
  }
}

TEST(Mesh, RefusesBadFilesInOneLine) {
  const TemporaryFolder folder;
  const auto refused = [&](const char* name, const char* text) {
    const std::string path = folder.write(name, text);
    const std::string message = input_error([&] { read_mesh(path); });
    EXPECT_EQ(message.rfind(path, 0), 0U) << message;
    return message;
  };
  EXPECT_NE(
      input_error([&] { read_mesh(folder.path("none.obj")); }).find("none.obj: cannot read: No such file"),
      std::string::npos);
  EXPECT_NE(input_error([&] { read_mesh(folder.path()); }).find("is a folder"), std::string::npos);
  EXPECT_NE(refused("a.obj", "").find("has no triangles"), std::string::npos);
  EXPECT_NE(refused("a.xyz", "hello").find("cannot read the mesh"), std::string::npos);
  EXPECT_NE(refused("a.ply", "ply\nformat ascii 1.0\nelxment vertex 3\nend_header\n")
                .find("a.ply:3: not a PLY header"),
            std::string::npos);
  EXPECT_NE(refused("a.gltf", "{").find("the JSON is broken"), std::string::npos);
  EXPECT_NE(refused("n.obj", "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").find("n.obj:1: "), std::string::npos);
  EXPECT_NE(refused("i.obj", "v 0 0 0\nv 1 0 0\nv 0 1e999 0\nf 1 2 3\n").find("i.obj:3: "),
            std::string::npos);
  refused("p.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n");
  const Mesh point = read_mesh(folder.write("o.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"));
  EXPECT_NE(input_error([&] { make_view(point, {}, 64, 64); }).find("no extent"), std::string::npos);
}

}  // namespace
}  // namespace bitspan
