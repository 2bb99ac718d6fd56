// SPDX-License-Identifier: Apache-2.0
// OBJ files as generators write them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "io/atomic_file.hpp"
#include "scene/geometry.hpp"

namespace bitspan {

// What long work calls now and then with what is done and what there is in all.
using WorkProgress = std::function<void(std::size_t done, std::size_t total)>;

// Writes vertices and faces as they come, so that a mesh of any size takes no memory. A number is written
// with the fewest digits that read back as the same double. The file appears with commit().
class ObjWriter {
 public:
  // `comment` becomes the first line, where there is one.
  explicit ObjWriter(const std::string& path, const std::string& comment = {});

  // shade: a grey of 0..1 as the vertex' colour.
  void vertex(const Vec3& position, std::optional<double> shade = {});
  // Vertices count from 0, counterclockwise seen from the front. A face has three or more.
  void face(std::span<const std::uint32_t> corners);
  void normal(const Vec3& direction);
  // The same with a normal per corner; normals count from 0, too.
  void face(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals);
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
  std::string line_;
};

}  // namespace bitspan
