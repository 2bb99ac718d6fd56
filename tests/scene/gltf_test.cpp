// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "io/png.hpp"
#include "scene/mesh.hpp"
#include "tests/scene/gltf_builder.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using namespace testing_gltf;

class GltfTest : public testing::Test {
 protected:
  MeshFile read(Gltf gltf) { return read_gltf(folder.write("a.gltf", gltf.text())); }
  Mesh mesh(Gltf gltf) { return read_mesh(folder.write("a.gltf", gltf.text())); }
  void refused(Gltf gltf, std::string_view part) {
    const std::string path = folder.write("a.gltf", gltf.text());
    const std::string message = input_error([&] { read_gltf(path); });
    EXPECT_TRUE(message.starts_with(path + ": ")) << message;
    EXPECT_TRUE(names(message, part)) << message;
    EXPECT_TRUE(names(message, "; expected ")) << message;
  }
  TemporaryFolder folder;
};

// The corner of a mesh whose position is p.
const MeshCorner& corner_at(const MeshFile& mesh, const Vec3& p) {
  for (const MeshTriangle& t : mesh.triangles) {
    for (const MeshCorner& c : t.corner) {
      if (length(c.position - p) < 1e-6) return c;
    }
  }
  ADD_FAILURE() << "no corner at " << p.x << ", " << p.y << ", " << p.z;
  return mesh.triangles.at(0).corner[0];
}

// Twice the area of a triangle that lies in z = 0, above 0 where it runs counterclockwise seen from +z.
double turn(const MeshTriangle& t) {
  return cross(t.corner[1].position - t.corner[0].position, t.corner[2].position - t.corner[0].position).z;
}

TEST_F(GltfTest, AQuadInTextAndInGlb) {
  const std::string glb = folder.write("a.glb", quad().glb());
  const std::string marked = folder.write("m.gltf", "\xef\xbb\xbf" + quad().text());
  for (const MeshFile& mesh : {read(quad()), read_gltf(glb), read_gltf(marked)}) {
    ASSERT_EQ(mesh.triangles.size(), 2U);
    EXPECT_EQ(mesh.triangles[0].corner[1].position, (Vec3{1, -1, 0}));
    EXPECT_EQ(mesh.triangles[1].corner[2].position, (Vec3{-1, 1, 0}));
    EXPECT_EQ(mesh.triangles[0].material, -1);
    EXPECT_FALSE(mesh.triangles[0].has_uv);
    EXPECT_EQ(mesh.triangles[0].corner[0].color, (std::array<double, 4>{1, 1, 1, 1}));
    EXPECT_TRUE(mesh.notes.empty());
  }
  // Known by its contents, whatever its name is.
  EXPECT_EQ(read_mesh(folder.write("a.bin", quad().text())).faces.size(), 2U);
  EXPECT_EQ(read_mesh(folder.write("b.bin", quad().glb())).faces.size(), 2U);
}

TEST_F(GltfTest, ColoursOfThreeComponentsAreOpaque) {
  const auto color_of = [&](auto values, const char* type, bool normalized) {
    Gltf gltf = quad();
    gltf.attributes()["COLOR_0"] = gltf.add(type, values, normalized);
    return corner_at(read(gltf), {1, -1, 0}).color;
  };
  using Color = std::array<double, 4>;
  EXPECT_EQ(color_of(std::vector<float>{0, 0, 0, .5, 0, 1, 0, 0, 0, 0, 0, 0}, "VEC3", false),
            (Color{.5, 0, 1, 1}));
  EXPECT_EQ(color_of(std::vector<float>{0, 0, 0, 0, .5, 0, 1, .25, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", false),
            (Color{.5, 0, 1, .25}));
  std::vector<std::uint8_t> bytes{0, 0, 0, 51, 255, 1, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(color_of(bytes, "VEC3", true), (Color{51 / 255.0, 1, 1 / 255.0, 1}));
  bytes = {0, 0, 0, 0, 51, 255, 1, 128, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(color_of(bytes, "VEC4", true), (Color{51 / 255.0, 1, 1 / 255.0, 128 / 255.0}));
  const std::vector<std::uint16_t> words{0, 0, 0, 257, 65535, 1, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(color_of(words, "VEC3", true), (Color{257 / 65535.0, 1, 1 / 65535.0, 1}));
  Gltf whole = quad();
  whole.attributes()["COLOR_0"] = whole.add("VEC3", std::vector<std::uint8_t>(12), false);
  refused(whole, "expected normalized");
}

TEST_F(GltfTest, CoordinatesOfEveryComponentType) {
  const auto coordinates = [&](auto values, bool normalized) {
    Gltf gltf = quad();
    gltf.attributes()["TEXCOORD_0"] = gltf.add("VEC2", values, normalized);
    const MeshCorner c = corner_at(read(gltf), {1, -1, 0});
    return std::array<double, 2>{c.u, 1 - c.v};
  };
  using Uv = std::array<double, 2>;
  EXPECT_EQ(coordinates(std::vector<std::uint8_t>{0, 0, 255, 51, 0, 0, 0, 0}, true),
            (Uv{1, 1 - (1 - 51 / 255.0)}));
  EXPECT_EQ(coordinates(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 0, 0, 0}, true), (Uv{1, 0}));
  EXPECT_EQ(coordinates(std::vector<std::int8_t>{0, 0, -128, 127, 0, 0, 0, 0}, true), (Uv{-1, 1}));
  EXPECT_EQ(coordinates(std::vector<std::int16_t>{0, 0, -32768, 32767, 0, 0, 0, 0}, true), (Uv{-1, 1}));
  EXPECT_EQ(coordinates(std::vector<std::uint16_t>{0, 0, 3, 2, 0, 0, 0, 0}, false), (Uv{3, 2}));
  EXPECT_EQ(coordinates(std::vector<float>{0, 0, .25, -2, 0, 0, 0, 0}, false), (Uv{.25, -2}));
}

TEST_F(GltfTest, QuantizedPositionsAndEveryIndexType) {
  Gltf gltf = quad();
  const std::vector<std::int16_t> codes{-32768, -32767, 0, 32767,  -32767, 0,
                                        32767,  32767,  0, -32767, 32767,  0};
  gltf.attributes()["POSITION"] = gltf.add("VEC3", codes, true);
  gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(read(gltf).triangles[0].corner[0].position, (Vec3{-1, -1, 0}));
  Gltf bytes = quad(), words = quad();
  bytes.primitive()["indices"] = bytes.add("SCALAR", std::vector<std::uint8_t>{3, 1, 2});
  words.primitive()["indices"] = words.add("SCALAR", std::vector<std::uint32_t>{3, 1, 2});
  for (const Gltf& each : {bytes, words})
    EXPECT_EQ(read(each).triangles[0].corner[0].position, (Vec3{-1, 1, 0}));
  Gltf bare = quad();
  bare.primitive().erase("indices");
  refused(bare, "4 vertices in a row");
  bare.attributes()["POSITION"] = bare.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(read(bare).triangles.size(), 1U);
}

TEST_F(GltfTest, SparseElementsTakeThePlaceOfOthers) {
  for (const bool has_base : {true, false}) {
    Gltf gltf = quad();
    const int indices = gltf.add_view(std::vector<std::uint8_t>{1, 3});
    const int values = gltf.add_view(std::vector<float>{5, 6, 7, 8, 9, 10});
    Json& position = gltf.accessor(0);
    position["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                          {"values", {{"bufferView", values}}}};
    if (!has_base) position.erase("bufferView");
    const MeshFile mesh = read(gltf);
    EXPECT_EQ(mesh.triangles[0].corner[0].position, has_base ? (Vec3{-1, -1, 0}) : (Vec3{0, 0, 0}));
    EXPECT_EQ(mesh.triangles[0].corner[1].position, (Vec3{5, 6, 7}));
    EXPECT_EQ(mesh.triangles[1].corner[2].position, (Vec3{8, 9, 10}));
    for (const auto& [name, bad] : {std::pair{"does not grow", std::vector<std::uint8_t>{3, 1}},
                                    {"past the end", std::vector<std::uint8_t>{1, 4}}}) {
      Gltf other = gltf;
      other.accessor(0)["sparse"]["indices"]["bufferView"] = other.add_view(bad);
      refused(other, name);
    }
    gltf.accessor(0)["sparse"]["count"] = 3;
    refused(gltf, "end of its buffer view");
    gltf.accessor(0)["sparse"]["count"] = 5;
    refused(gltf, "expected at most 4");
  }
}

TEST_F(GltfTest, StridesAndOffsets) {
  Gltf gltf = quad();
  std::vector<float> rows{9, 9};
  for (std::size_t i = 0; i < 4; ++i) {
    rows.insert(rows.end(), {quad_positions[3 * i], quad_positions[3 * i + 1], 0, 77});
  }
  const int position = gltf.add("VEC3", rows);
  gltf.view(gltf.accessor(position)["bufferView"])["byteStride"] = 16;
  gltf.accessor(position)["byteOffset"] = 8;
  gltf.accessor(position)["count"] = 4;
  gltf.attributes()["POSITION"] = position;
  EXPECT_EQ(read(gltf).triangles[1].corner[2].position, (Vec3{-1, 1, 0}));
  gltf.accessor(position)["byteOffset"] = 12;  // the last row still fits, without what follows its element
  EXPECT_EQ(read(gltf).triangles.size(), 2U);
  gltf.accessor(position)["byteOffset"] = 16;
  refused(gltf, "end of its buffer view");
  gltf.accessor(position)["byteOffset"] = 8;
  gltf.view(gltf.accessor(position)["bufferView"])["byteStride"] = 8;
  refused(gltf, "byteStride");
}

TEST_F(GltfTest, StripsFansPointsAndLines) {
  Gltf strip = quad();
  strip.primitive()["mode"] = 5;
  strip.primitive()["indices"] = strip.add("SCALAR", std::vector<std::uint16_t>{0, 1, 3, 2});
  Gltf fan = quad();
  fan.primitive()["mode"] = 6;
  fan.primitive()["indices"] = fan.add("SCALAR", std::vector<std::uint16_t>{0, 1, 2, 3});
  for (const Gltf& each : {strip, fan}) {
    const MeshFile mesh = read(each);
    ASSERT_EQ(mesh.triangles.size(), 2U);
    for (const MeshTriangle& t : mesh.triangles) EXPECT_EQ(turn(t), 4);
  }
  Gltf mixed = quad();
  const Json triangles = mixed.primitive();
  const auto mode = [&](int number) {
    Json primitive = triangles;
    primitive["mode"] = number;
    primitive.erase("indices");
    return primitive;
  };
  mixed.json["meshes"][0]["primitives"] = {triangles, mode(0), mode(1), mode(2), mode(3)};
  const MeshFile mesh = read(mixed);
  EXPECT_EQ(mesh.triangles.size(), 2U);
  ASSERT_EQ(mesh.notes.size(), 1U);
  EXPECT_EQ(mesh.notes[0], "4 points and 9 lines are left out");
  mixed.json["meshes"][0]["primitives"] = {mode(1)};
  const std::string path = folder.write("l.gltf", mixed.text());
  expect_refusal([&] { read_mesh(path); }, "0 points and 2 lines are left out; expected at least one face");
  strip.primitive()["mode"] = 7;
  refused(strip, "has mode 7");
}

TEST_F(GltfTest, AMirroredNodeKeepsItsFront) {
  const auto turn_with = [&](const Json& scale) {
    Gltf gltf = quad();
    gltf.json["nodes"][0]["scale"] = scale;
    return turn(read(gltf).triangles[0]);
  };
  EXPECT_EQ(turn_with({1, 1, 1}), 4);
  EXPECT_EQ(turn_with({-1, 1, 1}), 4);
  EXPECT_EQ(turn_with({1, -2, 1}), 8);
  EXPECT_EQ(turn_with({-1, -1, 1}), 4) << "two mirrors turn it";
  EXPECT_EQ(turn_with({1, 1, -1}), -4) << "it is seen from behind now";
  // A mirror below a mirror, by a matrix.
  Gltf gltf = quad();
  gltf.json["nodes"] = {{{"scale", {-1, 1, 1}}, {"children", {1}}},
                        {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}};
  const MeshFile mesh = read(gltf);
  EXPECT_EQ(turn(mesh.triangles[0]), 4);
  EXPECT_EQ(mesh.triangles[0].corner[0].position, (Vec3{-1, -1, 0}));
}

TEST_F(GltfTest, NodesPlaceTheirChildren) {
  const double half = std::numbers::sqrt2 / 2;
  Gltf gltf = quad();
  // A quarter turn about z and a scale, then a step; the child steps first.
  gltf.json["nodes"] = {{{"translation", {10, 0, 0}},
                         {"rotation", {0, 0, half, half}},
                         {"scale", {2, 3, 1}},
                         {"children", {1, 2}}},
                        {{"mesh", 0}, {"translation", {0, 1, 5}}},
                        {{"mesh", 0}}};
  const MeshFile mesh = read(gltf);
  ASSERT_EQ(mesh.triangles.size(), 4U);
  // (1, -1, 0) steps to (1, 0, 5), grows to (2, 0, 5), turns to (0, 2, 5).
  EXPECT_LT(length(mesh.triangles[0].corner[1].position - Vec3{10, 2, 5}), 1e-12);
  EXPECT_LT(length(mesh.triangles[2].corner[1].position - Vec3{13, 2, 0}), 1e-12);
  Gltf matrix = quad();
  matrix.json["nodes"][0]["matrix"] = {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1};
  EXPECT_LT(length(read(matrix).triangles[0].corner[1].position - mesh.triangles[2].corner[1].position),
            1e-12);
  matrix.json["nodes"][0]["scale"] = {1, 1, 1};
  refused(matrix, "a matrix beside its parts");
  matrix.json["nodes"][0] = {{"mesh", 0}, {"matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}};
  refused(matrix, "last row");
  matrix.json["nodes"][0] = {{"mesh", 0}, {"rotation", {0, 0, 0, 0}}};
  refused(matrix, "unit quaternion");
}

TEST_F(GltfTest, ScenesAndTrees) {
  Gltf gltf = quad();
  const auto count = [&](const Gltf& each) { return read(each).triangles.size(); };
  gltf.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"children", {2}}}, {{"mesh", 0}}};
  gltf.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {0, 1}}}};
  EXPECT_EQ(count(gltf), 2U);
  EXPECT_EQ(read(gltf).notes, std::vector<std::string>{"scene 0 of 2 is shown"});
  gltf.json["scene"] = 1;
  EXPECT_EQ(count(gltf), 6U) << "three nodes with one mesh";
  gltf.json.erase("scene");
  gltf.json.erase("scenes");
  EXPECT_EQ(count(gltf), 6U) << "every root";
  gltf.json["nodes"][2]["children"] = {0, 1};
  refused(gltf, "below itself");
  gltf.json["nodes"][0]["children"] = {1};
  gltf.json["nodes"][2]["children"] = Json::array();
  gltf.json["nodes"].push_back({{"children", {0, 1}}});
  refused(gltf, "reached twice");
  gltf.json["scenes"] = {{{"nodes", {0}}}};
  gltf.json["nodes"] = {{{"children", {0}}}};
  refused(gltf, "reached twice");
  gltf.json["nodes"] = {{{"children", {7}}}};
  refused(gltf, "expected an index below the 1 nodes");
  gltf.json["scenes"] = {{{"nodes", {4}}}};
  refused(gltf, "expected an index below the 1 nodes");
}

TEST_F(GltfTest, AChainOfNodesMayBeLong) {
  constexpr std::size_t length = 100000;
  Gltf gltf = quad();
  Json::array_t nodes(length);
  for (std::size_t i = 0; i + 1 < length; ++i) nodes[i] = {{"translation", {0, 0, 1}}, {"children", {i + 1}}};
  nodes[length - 1] = {{"mesh", 0}};
  gltf.json["nodes"] = nodes;
  EXPECT_EQ(read(gltf).triangles[0].corner[0].position.z, static_cast<double>(length - 1));
}

// 2 x 2 texels of alpha 0, 127, 128, 255.
void write_alphas(const TemporaryFolder& folder, const char* name) {
  write_png(folder.path(name), 2, 2, 4, Bytes{255, 0, 0, 0, 255, 0, 0, 127, 255, 0, 0, 128, 255, 0, 0, 255});
}

TEST_F(GltfTest, AlphaModes) {
  write_alphas(folder, "a.png");
  const auto alphas = [&](const Json& changes) {
    Gltf gltf = textured_quad("a.png");
    gltf.json["materials"][0].merge_patch(changes);
    const Mesh read = mesh(gltf);
    EXPECT_EQ(read.textures.size(), 1U);
    const auto& t = read.textures.at(0).rgba;
    return std::array<double, 5>{static_cast<double>(t[3]), static_cast<double>(t[7]),
                                 static_cast<double>(t[11]), static_cast<double>(t[15]),
                                 read.faces[0].corner[0].c[3]};
  };
  using Alphas = std::array<double, 5>;
  const Json half = {{"baseColorFactor", {1, 1, 1, 0.5}}};
  EXPECT_EQ(alphas(Json::object()), (Alphas{255, 255, 255, 255, 1}));
  EXPECT_EQ(alphas({{"pbrMetallicRoughness", half}}), (Alphas{255, 255, 255, 255, 1}));
  EXPECT_EQ(alphas({{"alphaMode", "BLEND"}}), (Alphas{0, 127, 128, 255, 1}));
  EXPECT_EQ(alphas({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", half}}), (Alphas{0, 127, 128, 255, .5}));
  EXPECT_EQ(alphas({{"alphaMode", "MASK"}}), (Alphas{0, 0, 255, 255, 1})) << "127 / 255 < 0.5 < 128 / 255";
  EXPECT_EQ(alphas({{"alphaMode", "MASK"}, {"alphaCutoff", 0}}), (Alphas{255, 255, 255, 255, 1}));
  EXPECT_EQ(alphas({{"alphaMode", "MASK"}, {"alphaCutoff", 1.5}}), (Alphas{0, 0, 0, 0, 1}));
  EXPECT_EQ(alphas({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", half}}), (Alphas{0, 0, 0, 255, 1}))
      << "255 / 255 * 0.5 is at least 0.5";
  Gltf bad = textured_quad("a.png");
  bad.json["materials"][0]["alphaMode"] = "DITHER";
  refused(bad, "expected OPAQUE, MASK or BLEND");
}

TEST_F(GltfTest, OneImageWithTwoModesIsTwoTextures) {
  write_alphas(folder, "a.png");
  Gltf gltf = textured_quad("a.png");
  gltf.json["materials"].push_back(gltf.json["materials"][0]);
  gltf.json["materials"][1]["alphaMode"] = "BLEND";
  Json second = gltf.primitive();
  second["material"] = 1;
  gltf.json["meshes"][0]["primitives"].push_back(second);
  const Mesh two = mesh(gltf);
  ASSERT_EQ(two.textures.size(), 2U);
  EXPECT_EQ(two.textures[0].rgba[3], 255);
  EXPECT_EQ(two.textures[1].rgba[3], 0);
  EXPECT_EQ(two.faces[0].texture, 0);
  EXPECT_EQ(two.faces[2].texture, 1);
  write_png(folder.path("a.png"), 1, 1, 3, Bytes{1, 2, 3});
  EXPECT_EQ(mesh(gltf).textures.size(), 1U) << "of an opaque image both are the same";
}

TEST_F(GltfTest, MaskWithoutATextureCutsTheCorners) {
  Gltf gltf = quad();
  gltf.primitive()["material"] = 0;
  gltf.json["materials"] = {{{"alphaMode", "MASK"}, {"alphaCutoff", 0.5}}};
  const auto alphas = [&](const std::vector<float>& of_vertex) {
    std::vector<float> colors;
    for (const float a : of_vertex) colors.insert(colors.end(), {1, 1, 1, a});
    Gltf each = gltf;
    each.attributes()["COLOR_0"] = each.add("VEC4", colors);
    return mesh(each);
  };
  EXPECT_EQ(alphas({.5, .5, .5, .5}).faces[0].corner[0].c[3], 1);
  EXPECT_EQ(alphas({.25, .25, .25, .25}).faces[0].corner[0].c[3], 0);
  EXPECT_TRUE(alphas({.25, .25, .25, .25}).notes.empty());
  const Mesh mixed = alphas({.75, .25, .75, .75});
  EXPECT_EQ(mixed.faces[0].corner[0].c[3], 1);
  EXPECT_EQ(mixed.faces[0].corner[1].c[3], 0);
  ASSERT_EQ(mixed.notes.size(), 1U);
  EXPECT_TRUE(names(mixed.notes[0], "1 faces with alphaMode MASK")) << mixed.notes[0];
}

TEST_F(GltfTest, MaterialsAndTheirTextures) {
  write_png(folder.path("my skin.png"), 2, 1, 3, Bytes{1, 2, 3, 4, 5, 6});
  Gltf gltf = textured_quad("my%20skin.png");
  Json& material = gltf.json["materials"][0];
  material["doubleSided"] = true;
  material["pbrMetallicRoughness"]["baseColorFactor"] = {.5, .25, 1, .75};
  material["alphaMode"] = "BLEND";
  const Mesh read = mesh(gltf);
  ASSERT_EQ(read.textures.size(), 1U);
  EXPECT_EQ(read.textures[0].rgba, (Bytes{1, 2, 3, 255, 4, 5, 6, 255}));
  EXPECT_TRUE(read.faces[0].two_sided);
  EXPECT_EQ(read.faces[0].corner[0].c, (std::array<double, 4>{.5, .25, 1, .75}));
  EXPECT_EQ(read.faces[0].corner[1].u, 2);
  EXPECT_EQ(read.faces[0].corner[1].v, 1);
  const Bytes png = encode_png(1, 1, 3, Bytes{7, 8, 9});
  gltf.json["images"] = {{{"uri", "data:image/png;base64," + base64(png)}}};
  EXPECT_EQ(mesh(gltf).textures[0].rgba, (Bytes{7, 8, 9, 255}));
  gltf.json["images"] = {{{"bufferView", gltf.add_view(png)}, {"mimeType", "image/png"}}};
  EXPECT_EQ(mesh(gltf).textures[0].rgba, (Bytes{7, 8, 9, 255}));
  EXPECT_EQ(read_mesh(folder.write("a.glb", gltf.glb())).textures[0].rgba, (Bytes{7, 8, 9, 255}));
  gltf.json["images"] = {{{"uri", "data:image/png;base64,&&&&"}}};
  refused(gltf, "images[0].uri: is broken");
  gltf.json["images"] = {{{"uri", "a%2.png"}}};
  refused(gltf, "illegal escape");
  gltf.json["images"] = {{{"uri", "none.png"}}};
  const std::string path = folder.write("n.gltf", gltf.text());
  expect_refusal([&] { read_mesh(path); }, "none.png: cannot read the texture");
  std::vector<std::string> bad;
  EXPECT_EQ(read_mesh(path, std::nullopt, &bad).faces[1].texture, -1);
  EXPECT_EQ(bad.size(), 1U);
  Gltf glossy = textured_quad("my%20skin.png");
  glossy.json["materials"] = {
      {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {.5, 0, 0, 1}}}}}}}};
  EXPECT_EQ(mesh(glossy).faces[0].corner[0].c[0], .5);
}

TEST_F(GltfTest, TheSetOfCoordinatesThatTheTextureNames) {
  Gltf gltf = textured_quad("a.png");
  gltf.attributes()["TEXCOORD_1"] = gltf.add("VEC2", std::vector<float>(8, .25F));
  Json& info = gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  const auto u = [&] { return corner_at(read(gltf), {1, -1, 0}).u; };
  EXPECT_EQ(u(), 1);
  info["texCoord"] = 1;
  EXPECT_EQ(u(), .25);
  info["extensions"]["KHR_texture_transform"] = {{"texCoord", 0}};
  EXPECT_EQ(u(), 1);
  info["extensions"]["KHR_texture_transform"] = Json::object();
  EXPECT_EQ(u(), .25);
  info["texCoord"] = 2;
  const MeshFile none = read(gltf);
  EXPECT_FALSE(none.triangles[0].has_uv);
  ASSERT_EQ(none.notes.size(), 1U);
  EXPECT_TRUE(names(none.notes[0], "2 faces without the texture coordinates")) << none.notes[0];
}

// The second texture unit's image, at the occlusion's coordinates or at those of TEXCOORD_1.
TEST_F(GltfTest, SecondCoordinates) {
  write_png(folder.path("a.png"), 2, 1, 3, Bytes{1, 2, 3, 4, 5, 6});
  const std::string light = folder.path("light.png");
  write_png(light, 4, 2, 3, Bytes(24, 9));
  Gltf gltf = textured_quad("a.png");
  const auto with_light = [&] {
    return read_mesh(folder.write("a.gltf", gltf.text()), std::nullopt, nullptr, light);
  };
  const auto second = [&] {
    const Corner corner = with_light().faces.at(0).corner[1];  // of vertex 1
    return std::array<double, 2>{corner.u2, corner.v2};
  };
  using Uv = std::array<double, 2>;
  const std::string message = input_error([&] { with_light(); });
  EXPECT_TRUE(names(message, "the mesh has no second texture coordinates; expected them for " + light))
      << message;
  gltf.attributes()["TEXCOORD_1"] = gltf.add("VEC2", std::vector<float>{0, 0, .5, .25, 1, 1, 0, 1});
  EXPECT_EQ(second(), (Uv{2, .5}));
  gltf.json["materials"][0]["occlusionTexture"] = {{"index", 0}};
  EXPECT_EQ(second(), (Uv{4, 2}));  // TEXCOORD_0
  gltf.json["materials"][0]["occlusionTexture"] = {
      {"index", 0}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", {{"offset", {.25, .5}}}}}}};
  EXPECT_EQ(second(), (Uv{3, 1.5}));
  const Mesh lit = with_light();
  ASSERT_EQ(lit.textures.size(), 2U);
  EXPECT_EQ(lit.texture1, 1);
  EXPECT_EQ(lit.faces[0].corner[1].u, 2);  // of the base colour, as it was
  ProjectReport report;
  const Scene scene = mesh_scene(lit, {}, report);
  ASSERT_EQ(scene.commands.size(), 1U);
  EXPECT_EQ(std::get<StateChange>(scene.commands[0].what).settings.at(0).value, 1);
  // What is not asked for is not read, however it is.
  gltf.attributes()["TEXCOORD_1"] = gltf.attributes()["POSITION"];
  EXPECT_EQ(mesh(gltf).texture1, -1);
  EXPECT_EQ(mesh(gltf).faces[0].corner[1].u2, 0);
  EXPECT_TRUE(names(input_error([&] { with_light(); }), "TEXCOORD_1 has 3 components"));
}

TEST_F(GltfTest, TextureTransform) {
  Gltf gltf = textured_quad("a.png");
  gltf.json["extensionsRequired"] = {"KHR_texture_transform"};
  Json& change = gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
                          ["KHR_texture_transform"];
  // Of the corner whose coordinates are (1, 1), with v downward.
  const auto uv = [&] {
    const MeshCorner c = corner_at(read(gltf), {1, -1, 0});
    return std::array<double, 2>{c.u, 1 - c.v};
  };
  change = {{"offset", {.5, 0}}, {"scale", {.5, .25}}};
  EXPECT_EQ(uv(), (std::array<double, 2>{1, .25}));
  change = {{"rotation", std::numbers::pi / 2}};  // counterclockwise as one sees it: (1, 1) to (1, -1)
  EXPECT_NEAR(uv()[0], 1, 1e-12);
  EXPECT_NEAR(uv()[1], -1, 1e-12);
  change = {{"rotation", std::numbers::pi / 2}, {"scale", {2, 3}}, {"offset", {.5, 0}}};
  EXPECT_NEAR(uv()[0], 3.5, 1e-12);
  EXPECT_NEAR(uv()[1], -2, 1e-12);
  change = {{"offset", {1}}};
  refused(gltf, "has 1 numbers; expected 2");
}

TEST_F(GltfTest, ExtensionsThatAreRequired) {
  for (const char* name :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu", "a\nb"}) {
    Gltf gltf = quad();
    gltf.json["extensionsRequired"] = {name};
    refused(gltf, name[0] == 'a' ? "\"a?b\"" : name);
  }
  Gltf gltf = quad();
  gltf.json["extensionsRequired"] = {"KHR_materials_unlit"};
  EXPECT_TRUE(read(gltf).notes.empty());
  gltf.json["extensionsUsed"] = {"KHR_materials_unlit", "KHR_lights_punctual", "KHR_texture_basisu"};
  EXPECT_EQ(read(gltf).notes,
            std::vector<std::string>{"extensions that are not known are left out: \"KHR_texture_basisu\""});
}

TEST_F(GltfTest, SaysWhatIsLeftOut) {
  Gltf gltf = quad();
  gltf.json["cameras"] = Json::array({Json::object()});
  gltf.json["animations"] = Json::array({Json::object(), Json::object()});
  gltf.json["nodes"][0]["skin"] = 0;
  gltf.json["meshes"][0]["weights"] = {0, 0.5};
  const MeshFile mesh = read(gltf);
  ASSERT_EQ(mesh.notes.size(), 4U);
  EXPECT_TRUE(names(mesh.notes[0], "1 skin left out"));
  EXPECT_TRUE(names(mesh.notes[1], "morph targets are left out, of 1 node"));
  EXPECT_TRUE(names(mesh.notes[2], "2 animations left out"));
  EXPECT_TRUE(names(mesh.notes[3], "1 camera left out"));
  gltf.json["nodes"][0]["weights"] = {0, 0};
  EXPECT_EQ(read(gltf).notes.size(), 3U) << "the node's weights take the place of the mesh's";
}

TEST_F(GltfTest, RefusesWhatIsDamaged) {
  struct Case {
    const char* patch;
    const char* message;
  };
  // A patch of the JSON of a quad: RFC 7396.
  const std::vector<Case> cases{
      {R"({"asset":null})", "has no \"asset\""},
      {R"({"asset":{"version":"1.0"}})", "is glTF \"1.0\""},
      {R"({"asset":{"minVersion":"2.1"}})", "asks for glTF \"2.1\""},
      {R"({"scene":3})", "scene: is 3"},
      {R"({"scenes":{}})", "scenes: is no list"},
      {R"({"nodes":[5]})", "nodes[0]: is no object"},
      {R"({"nodes":[{"mesh":1}]})", "nodes[0].mesh: is 1; expected an index below the 1 meshes"},
      {R"({"nodes":[{"mesh":-1}]})", "is no whole number"},
      {R"({"nodes":[{"mesh":0.5}]})", "is no whole number"},
      {R"({"nodes":[{"mesh":1e300}]})", "is no whole number"},
      {R"({"nodes":[{"mesh":"0"}]})", "is no number"},
      {R"({"nodes":[{"mesh":0,"scale":[1,1]}]})", "has 2 numbers; expected 3"},
      {R"({"meshes":[{}]})", "has no \"primitives\""},
      {R"({"meshes":[{"primitives":[{}]}]})", "has no \"attributes\""},
      {R"({"meshes":[{"primitives":[{"attributes":{"POSITION":9}}]}]})", "POSITION: is 9"},
      {R"({"meshes":[{"primitives":[{"attributes":{"POSITION":1}}]}]})", "POSITION has 1 component"},
      {R"({"bufferViews":[{"buffer":0,"byteLength":47},{"buffer":0,"byteOffset":48,"byteLength":12}]})",
       "accessors[0]: ends at byte 48; expected at most 47"},
      {R"({"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":49,"byteLength":12}]})",
       "bufferViews[1]: ends at byte 61; expected at most 60"},
      {R"({"bufferViews":[{"buffer":0,"byteLength":281474976710656}]})", "expected at most 60"},
      {R"({"bufferViews":[{"buffer":0,"byteOffset":18446744073709551615,"byteLength":48}]})",
       "is no whole number"},
      {R"({"bufferViews":[{"buffer":1,"byteLength":48}]})", "buffer: is 1"},
      {R"({"bufferViews":[{"byteLength":48}]})", "has no \"buffer\""},
  };
  for (const Case& c : cases) {
    Gltf gltf = quad();
    gltf.json.merge_patch(Json::parse(c.patch));
    SCOPED_TRACE(c.patch);
    refused(gltf, c.message);
  }
  const std::vector<Case> accessors{
      {R"({"count":5})", "ends at byte 60; expected at most 48"},
      {R"({"count":281474976710656})", "expected at most 48"},
      {R"({"byteOffset":281474976710656})", "expected at most 48"},
      {R"({"componentType":5124})", "there is no component type 5124"},
      {R"({"componentType":5125})", "integers of 32 bits"},
      {R"({"type":"MAT2"})", "is of type \"MAT2\""},
      {R"({"type":"VEC2"})", "POSITION has 2 components"},
      {R"({"bufferView":7})", "bufferView: is 7"},
      {R"({"count":3})", "is the index 3; expected one below the 3 vertices"},
      {R"({"normalized":1})", "neither true nor false"},
  };
  for (const Case& c : accessors) {
    Gltf gltf = quad();
    gltf.accessor(0).merge_patch(Json::parse(c.patch));
    SCOPED_TRACE(c.patch);
    refused(gltf, c.message);
  }
  Gltf signed_indices = quad();
  signed_indices.accessor(1)["componentType"] = 5122;
  refused(signed_indices, "indices of a wrong type");
  Gltf huge = quad();  // no bytes stand behind it
  huge.accessor(0).erase("bufferView");
  huge.accessor(0)["count"] = std::uint64_t{3} << 40;
  huge.primitive().erase("indices");
  refused(huge, "makes more triangles than are read");
  Gltf short_color = quad();
  short_color.attributes()["COLOR_0"] = short_color.add("VEC3", std::vector<float>(9));
  refused(short_color, "has 3 elements; expected 4");
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Gltf gltf = quad();
    std::vector<float> positions = quad_positions;
    positions[7] = bad;
    gltf.attributes()["POSITION"] = gltf.add("VEC3", positions);
    refused(gltf, "accessors[2]: element 2 is not finite");
  }
}

TEST_F(GltfTest, RefusesBrokenContainers) {
  const auto broken = [&](const std::string& text, std::string_view part) {
    const std::string path = folder.write("b.gltf", text);
    const std::string message = input_error([&] { read_mesh(path); });
    EXPECT_TRUE(names(message, ": ") && names(message, part)) << message;
  };
  broken("", "the JSON is broken");
  broken("\xef\xbb\xbf", "the JSON is broken");
  broken("{", "the JSON is broken");
  broken("[1]", "is no object");
  broken(R"({"asset":{"version":"2.0"},"extras":1e999})", "the JSON is broken");
  const std::string deep(300000, '[');
  broken(R"({"asset":{"version":"2.0"},"extras":)" + deep + std::string(300000, ']') + "}",
         "nested too deep");
  broken(deep, "");
  std::string objects;
  for (int i = 0; i < 300000; ++i) objects += R"({"a":)";
  broken(objects + "1" + std::string(300000, '}'), "nested too deep");
  const std::string glb = quad().glb();
  for (std::size_t length = 4; length < glb.size(); ++length) broken(glb.substr(0, length), "; expected ");
  std::string other = glb;
  other[4] = 1;
  broken(other, "is GLB version 1");
  other = glb;
  other[16] = 'X';
  broken(other, "of a wrong type");
  other = glb;
  other[15] = 0x7f;
  broken(other, "are left");
  Gltf outside = quad();
  outside.finish(true);
  broken(outside.json.dump(), "has no \"uri\"");
  outside.json["buffers"][0]["uri"] = "none.bin";
  broken(outside.json.dump(), "none.bin: cannot read: No such file");
  outside.json["buffers"][0]["uri"] = "/dev/zero";
  broken(outside.json.dump(), "is no file");
  folder.write("short bytes", "1234");
  outside.json["buffers"][0]["uri"] = "short%20bytes";
  broken(outside.json.dump(), "has 4 bytes (truncated?); expected 60");
  outside.json["buffers"][0]["byteLength"] = std::uint64_t{1} << 40;
  broken(outside.json.dump(), "too large");
}

TEST_F(GltfTest, BuffersMayBeFilesBesideIt) {
  Gltf gltf = quad();
  gltf.finish(true);
  folder.write("my bytes", std::string(gltf.buffer.begin(), gltf.buffer.end()));
  gltf.json["buffers"][0]["uri"] = "my%20bytes";
  EXPECT_EQ(read_gltf(folder.write("f.gltf", gltf.json.dump())).triangles.size(), 2U);
}

// A file with most of what the reader knows.
Gltf rich() {
  Gltf gltf = textured_quad("data:image/png;base64," + base64(encode_png(1, 1, 4, Bytes{1, 2, 3, 4})));
  gltf.attributes()["COLOR_0"] = gltf.add("VEC3", std::vector<std::uint8_t>(12, 200), true);
  gltf.attributes()["TEXCOORD_1"] = gltf.attributes()["TEXCOORD_0"];
  gltf.json["materials"][0]["occlusionTexture"] = {{"index", 0}, {"texCoord", 1}};
  gltf.json["materials"][0].merge_patch(
      {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}, {"doubleSided", true}});
  gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
           ["KHR_texture_transform"] = {{"offset", {.5, 0}}, {"scale", {.5, .5}}, {"rotation", 1}};
  gltf.accessor(0)["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", gltf.add_view(std::vector<std::uint16_t>{2})}, {"componentType", 5123}}},
      {"values", {{"bufferView", gltf.add_view(std::vector<float>{1, 2, 3})}}}};
  Json strip = gltf.primitive();
  strip["mode"] = 5;
  gltf.json["meshes"][0]["primitives"].push_back(strip);
  gltf.json["nodes"] = {{{"children", {1, 2}}, {"scale", {-1, 1, 1}}},
                        {{"mesh", 0}, {"translation", {1, 2, 3}}},
                        {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1}}}};
  return gltf;
}

// Changes a few places: numbers become others, bytes change, pieces vanish or come twice.
std::string mutated(std::string text, std::mt19937_64& random) {
  constexpr std::array<std::string_view, 14> numbers{
      "0", "1", "2", "3", "4", "255", "65535", "-1", "1e38", "0.5", "4294967295", "7e9", "1e18", "5126"};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(text.size());
    switch (below(10)) {  // mostly numbers: other damage seldom goes past the JSON
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 2:
        text.erase(at, 1 + below(16));
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), 1 + below(32)));
        break;
      default: {
        const std::size_t first = text.find_first_of("0123456789", at);
        if (first == std::string::npos) break;
        const std::size_t last = std::min(text.find_first_not_of("0123456789.", first), text.size());
        if (last - first < 12) text.replace(first, last - first, numbers[below(numbers.size())]);
      }
    }
    if (text.empty()) text = "{";
  }
  return text;
}

TEST_F(GltfTest, FuzzMutatedFiles) {
  const std::size_t files = is_long_run() ? 100000 : is_gate_run() ? 2000 : 10000;
  const std::array<std::string, 2> whole{rich().text(), rich().glb()};
  EXPECT_EQ(read_mesh(folder.write("w.gltf", whole[0])).faces.size(), 12U);
  std::size_t read = 0, refusals = 0;
  for (std::size_t i = 0; i < files; ++i) {
    for (std::size_t kind = 0; kind < whole.size(); ++kind) {
      std::mt19937_64 random(2 * i + kind);
      try {
        parse_gltf(mutated(whole[kind], random), "m.gltf", random() % 2 == 0);
        ++read;
      } catch (const InputError& error) {
        ++refusals;
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
  EXPECT_GT(read, files / 20);
  EXPECT_GT(refusals, files / 20);
  RecordProperty("read", static_cast<int>(read));
  RecordProperty("refused", static_cast<int>(refusals));
}

}  // namespace
}  // namespace bitspan
