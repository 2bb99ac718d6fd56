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

// The pieces put together again; `sizes` gets their numbers of triangles.
Scene joined(std::istream& in, std::size_t size, std::vector<std::size_t>& sizes) {
  StreamPieces pieces(std::make_unique<TriReader>(in, "test"), size);
  Scene out = pieces.scene();
  Scene piece;
  while (pieces.next(piece)) {
    sizes.push_back(piece.triangles.size());
    for (DrawCommand command : piece.commands) {
      EXPECT_LE(command.before, piece.triangles.size());
      command.before += out.triangles.size();
      out.commands.push_back(std::move(command));
    }
    out.triangles.insert(out.triangles.end(), piece.triangles.begin(), piece.triangles.end());
  }
  EXPECT_FALSE(pieces.next(piece));
  return out;
}

TEST(Pieces, TogetherTheyAreTheStream) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomOptions options;
    options.triangles = 24;
    options.textures = 0;
    options.command_probability = 0.5;
    Scene scene = random_scene(seed, options);
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
  RandomOptions options;
  options.triangles = 20;
  options.textures = 0;
  std::istringstream in(text_of(random_scene(3, options)) + "{}\n");
  StreamPieces pieces(std::make_unique<TriReader>(in, "test"), 10);
  Scene piece;
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(pieces.next(piece));
    EXPECT_EQ(piece.triangles.size(), 10U);
  }
  EXPECT_EQ(error_of([&] { pieces.next(piece); }).substr(0, 11), "test:22: v:");
}

TEST(Pieces, MayBeLeftBeforeTheEnd) {
  RandomOptions options;
  options.triangles = 20;
  options.textures = 0;
  std::istringstream in(text_of(random_scene(4, options)));
  StreamPieces pieces(std::make_unique<TriReader>(in, "test"), 3);
  Scene piece;
  EXPECT_TRUE(pieces.next(piece));
}

}  // namespace
}  // namespace bitspan
