// SPDX-License-Identifier: Apache-2.0
#include "scene/pieces.hpp"

#include <utility>

namespace bitspan {

StreamPieces::StreamPieces(std::unique_ptr<TriReader> reader, std::size_t triangles)
    : reader_(std::move(reader)), scene_(reader_->scene()), most_(triangles) {}

StreamPieces::~StreamPieces() {
  if (ahead_.valid()) ahead_.wait();
}

std::optional<Scene> StreamPieces::next() {
  if (reader_ == nullptr) return std::nullopt;
  std::optional<Scene> piece = ahead_.valid() ? ahead_.get() : read();
  if (piece) {
    ahead_ = std::async(std::launch::async, [this] { return read(); });
  } else {
    reader_.reset();
  }
  return piece;
}

std::optional<Scene> StreamPieces::read() {
  Scene piece = with_view(scene_);
  piece.name = scene_.name;
  piece.triangles.resize(most_);
  std::size_t n = 0;
  while (n < most_ && reader_->next(piece.triangles[n])) ++n;
  piece.triangles.resize(n);
  piece.commands = reader_->take_commands();
  for (DrawCommand& command : piece.commands) command.before -= triangles_;
  triangles_ += n;
  const bool is_over = n == 0 && piece.commands.empty() && !is_first_;
  is_first_ = false;
  return is_over ? std::nullopt : std::optional(std::move(piece));
}

}  // namespace bitspan
