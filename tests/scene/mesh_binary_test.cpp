// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh_binary.hpp"

#include <gtest/gtest.h>

#include <span>
#include <stdexcept>

namespace bitspan {
namespace {

MeshAnswer whole_answer() {
  MeshAnswer answer;
  answer.mesh.images = {{"a.png", "dir/a.png", {}}, {"embedded", "", {1, 2, 3}}};
  answer.mesh.materials = {{"skin", 1, {.1, .2, .3, .4}, AlphaMode::mask, .25, true}};
  MeshTriangle triangle{{}, 0, true};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto x = static_cast<double>(i);
    triangle.corner[i] = {{x, x + .1, x + .2}, x + .3, x + .4, {x + .5, x + .6, x + .7, x + .8}};
  }
  answer.mesh.triangles = {triangle, MeshTriangle{}};
  answer.mesh.notes = {"2 points are left out"};
  return answer;
}

MeshAnswer decoded(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < mesh_header_bytes) throw std::runtime_error("short");
  return decode_mesh(bytes.first(mesh_header_bytes), bytes.subspan(mesh_header_bytes));
}

TEST(MeshBinary, ComesBackWhole) {
  const MeshAnswer in = whole_answer();
  const MeshAnswer out = decoded(encode_mesh(in));
  EXPECT_TRUE(out.error.empty());
  ASSERT_EQ(out.mesh.images.size(), 2U);
  EXPECT_EQ(out.mesh.images[0].name, "a.png");
  EXPECT_EQ(out.mesh.images[0].path, "dir/a.png");
  EXPECT_EQ(out.mesh.images[1].bytes, in.mesh.images[1].bytes);
  ASSERT_EQ(out.mesh.materials.size(), 1U);
  const MeshMaterial& m = out.mesh.materials[0];
  EXPECT_EQ(m.name, "skin");
  EXPECT_EQ(m.image, 1);
  EXPECT_EQ(m.color, in.mesh.materials[0].color);
  EXPECT_EQ(m.alpha, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, .25);
  EXPECT_TRUE(m.two_sided);
  ASSERT_EQ(out.mesh.triangles.size(), 2U);
  for (std::size_t i = 0; i < 3; ++i) {
    const MeshCorner& a = in.mesh.triangles[0].corner[i];
    const MeshCorner& b = out.mesh.triangles[0].corner[i];
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.u, b.u);
    EXPECT_EQ(a.v, b.v);
    EXPECT_EQ(a.color, b.color);
  }
  EXPECT_EQ(out.mesh.triangles[0].material, 0);
  EXPECT_TRUE(out.mesh.triangles[0].has_uv);
  EXPECT_EQ(out.mesh.triangles[1].material, -1);
  EXPECT_EQ(out.mesh.notes, in.mesh.notes);
  EXPECT_EQ(decoded(encode_mesh({{}, "no"})).error, "no");
}

TEST(MeshBinary, EveryCutAndEveryChangedByteIsSeen) {
  const std::vector<std::uint8_t> whole = encode_mesh(whole_answer());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THROW(decoded(std::span(whole).first(length)), std::runtime_error) << length;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::vector<std::uint8_t> other = whole;
    other[at] ^= 0x40;
    EXPECT_THROW(decoded(other), std::runtime_error) << at;
  }
}

TEST(MeshBinary, IndicesPastTheEndAreSeen) {
  MeshAnswer answer = whole_answer();
  answer.mesh.triangles[1].material = 1;
  EXPECT_THROW(decoded(encode_mesh(answer)), std::runtime_error);
  answer = whole_answer();
  answer.mesh.materials[0].image = 2;
  EXPECT_THROW(decoded(encode_mesh(answer)), std::runtime_error);
  answer = whole_answer();
  answer.mesh.triangles[1].material = -2;
  EXPECT_THROW(decoded(encode_mesh(answer)), std::runtime_error);
}

}  // namespace
}  // namespace bitspan
