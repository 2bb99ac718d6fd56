// SPDX-License-Identifier: Apache-2.0
// A stream in pieces is the stream: triangles, commands and their places, whatever the size of a piece.
#include "scene/pieces.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "scene/random.hpp"
#include "tests/config/support.hpp"

namespace bitspan {
namespace {

std::string text_of(const Scene& scene) {
  std::ostringstream out;
  write_tri(out, scene);
  return out.str();
}

Scene scene_of(std::uint64_t seed, int triangles, double command_probability = 0) {
  RandomOptions options;
  options.triangles = triangles;
  options.textures = 0;
  options.command_probability = command_probability;
  return random_scene(seed, options);
}

// The pieces put together again; `sizes` gets their numbers of triangles.
Scene joined(std::istream& in, std::size_t size, std::vector<std::size_t>& sizes) {
  StreamPieces pieces(std::make_unique<TriReader>(in, "test"), size);
  Scene out = pieces.scene();
  Scene piece;
  while (pieces.next(piece)) {
    sizes.push_back(piece.triangles.size());
    for (const DrawCommand& command : piece.commands) EXPECT_LE(command.before, piece.triangles.size());
    append_piece(out, piece);
  }
  EXPECT_FALSE(pieces.next(piece));
  return out;
}

TEST(Pieces, TogetherTheyAreTheStream) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scene scene = scene_of(seed, 24, 0.5);
    // Behind the last triangle, too.
    if (seed % 2 == 0) scene.commands.push_back({scene.triangles.size(), Target{2}});
    const std::string text = text_of(scene);
    for (const std::size_t size : {1, 5, 24, 100}) {
      std::istringstream in(text);
      std::vector<std::size_t> sizes;
      EXPECT_EQ(text_of(joined(in, size, sizes)), text) << "seed " << seed << ", pieces of " << size;
      for (std::size_t i = 0; i + 1 < sizes.size(); ++i) EXPECT_EQ(sizes[i], std::min<std::size_t>(size, 24));
    }
  }
}

TEST(Pieces, AnEmptyStreamIsOneEmptyPiece) {
  Scene scene;
  scene.commands.push_back({0, Target{1}});
  for (int commands = 0; commands < 2; ++commands) {
    std::istringstream in(text_of(scene));
    std::vector<std::size_t> sizes;
    EXPECT_EQ(joined(in, 8, sizes).commands.size(), scene.commands.size());
    EXPECT_EQ(sizes, std::vector<std::size_t>{0});
    scene.commands.clear();
  }
}

TEST(Pieces, AFaultIsThrownWhereItsPieceIsAskedFor) {
  std::istringstream in(text_of(scene_of(3, 20)) + "{}\n");
  StreamPieces pieces(std::make_unique<TriReader>(in, "test"), 10);
  Scene piece;
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(pieces.next(piece));
    EXPECT_EQ(piece.triangles.size(), 10U);
  }
  EXPECT_EQ(error_of([&] { pieces.next(piece); }).substr(0, 11), "test:22: v:");
}

TEST(Pieces, MayBeLeftBeforeTheEnd) {
  std::istringstream in(text_of(scene_of(4, 20)));
  StreamPieces pieces(std::make_unique<TriReader>(in, "test"), 3);
  Scene piece;
  EXPECT_TRUE(pieces.next(piece));
}

}  // namespace
}  // namespace bitspan
