// SPDX-License-Identifier: Apache-2.0
#include "scene/pieces.hpp"

#include <utility>

namespace bitspan {

void append_piece(Scene& scene, const Scene& piece) {
  for (DrawCommand command : piece.commands) {
    command.before += scene.triangles.size();
    scene.commands.push_back(std::move(command));
  }
  scene.triangles.insert(scene.triangles.end(), piece.triangles.begin(), piece.triangles.end());
}

StreamPieces::StreamPieces(std::unique_ptr<TriReader> reader, std::size_t triangles)
    : reader_(std::move(reader)), scene_(reader_->scene()), most_(triangles) {}

StreamPieces::~StreamPieces() {
  if (ahead_.valid()) ahead_.wait();
}

bool StreamPieces::next(Scene& piece) {
  if (reader_ == nullptr) return false;
  if (!(ahead_.valid() ? ahead_.get() : read())) {
    reader_.reset();
    return false;
  }
  std::swap(piece, read_);
  ahead_ = std::async(std::launch::async, [this] { return read(); });
  return true;
}

bool StreamPieces::read() {
  static_cast<View&>(read_) = scene_;
  read_.name = scene_.name;
  read_.triangles.resize(most_);
  std::size_t n = 0;
  while (n < most_ && reader_->next(read_.triangles[n])) ++n;
  read_.triangles.resize(n);
  read_.commands = reader_->take_commands();
  for (DrawCommand& command : read_.commands) command.before -= triangles_;
  triangles_ += n;
  const bool is_over = n == 0 && read_.commands.empty() && !is_first_;
  is_first_ = false;
  return !is_over;
}

}  // namespace bitspan
