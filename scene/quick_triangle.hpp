// SPDX-License-Identifier: Apache-2.0
// The quick way to read what almost every line of a stream is: a triangle of the usual form, through
// simdjson.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "scene/scene.hpp"

namespace bitspan {

// A triangle's line as it stands there. Only its form has been checked: no range, and no index.
struct TriangleLine {
  Triangle triangle;  // without colours and texture
  std::optional<std::array<double, 12>> colors;
  std::optional<std::int64_t> texture;
};

class QuickTriangles {
 public:
  QuickTriangles();
  ~QuickTriangles();
  QuickTriangles(const QuickTriangles&) = delete;
  QuickTriangles& operator=(const QuickTriangles&) = delete;

  // Reads a line of a stream of that version. Returns false where it is no triangle, where a key stands twice
  // or anything else is not as it should be; the reader of whole JSON finds out what that is. `line` keeps
  // its text.
  bool read(std::string& line, int version, TriangleLine& out);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace bitspan
