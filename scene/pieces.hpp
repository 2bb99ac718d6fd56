// SPDX-License-Identifier: Apache-2.0
// A triangle stream in pieces, so that what draws it needs no memory for the whole.
#pragma once

#include <cstddef>
#include <future>
#include <memory>

#include "scene/scene.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {

// Triangles of a piece: a vector engine sorts them into bands, so that many are better than few.
inline constexpr std::size_t piece_triangles = 16384;

// Puts a piece, whose commands count from its first triangle, behind what the scene has.
void append_piece(Scene& scene, const Scene& piece);

class StreamPieces {
 public:
  explicit StreamPieces(std::unique_ptr<TriReader> reader, std::size_t triangles = piece_triangles);
  // Waits for the piece that is being read.
  ~StreamPieces();
  StreamPieces(const StreamPieces&) = delete;
  StreamPieces& operator=(const StreamPieces&) = delete;

  // The scene without triangles and commands.
  const Scene& scene() const { return scene_; }
  // Gives the next triangles, as many as a piece has, with their commands, whose `before` counts from the
  // piece's first triangle. A piece has the stream's name and first view, and no textures. Returns
  // false behind the last one; the first call always gives one. Meanwhile a thread reads the piece after it,
  // into the memory that `piece` had. Throws InputError as the reader.
  bool next(Scene& piece);

 private:
  bool read();

  std::unique_ptr<TriReader> reader_;
  Scene scene_;
  const std::size_t most_;     // of a piece
  std::size_t triangles_ = 0;  // read
  bool is_first_ = true;
  Scene read_;  // the piece that is being read
  std::future<bool> ahead_;
};

}  // namespace bitspan
