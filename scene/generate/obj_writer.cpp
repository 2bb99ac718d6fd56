// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/obj_writer.hpp"

#include <fmt/format.h>

#include <iterator>

namespace bitspan {

ObjWriter::ObjWriter(const std::string& path, const std::string& comment) : file_(path) {
  if (!comment.empty()) file_.write(fmt::format("# {}\n", comment));
}

void ObjWriter::vertex(const Vec3& position, std::optional<double> shade) {
  line_.clear();
  fmt::format_to(std::back_inserter(line_), "v {} {} {}", position.x, position.y, position.z);
  if (shade) fmt::format_to(std::back_inserter(line_), " {0} {0} {0}", *shade);
  line_ += '\n';
  file_.write(line_);
}

void ObjWriter::normal(const Vec3& direction) {
  line_.clear();
  fmt::format_to(std::back_inserter(line_), "vn {} {} {}\n", direction.x, direction.y, direction.z);
  file_.write(line_);
}

void ObjWriter::face(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals) {
  line_.clear();
  line_ += 'f';
  for (std::size_t i = 0; i < corners.size(); ++i) {
    fmt::format_to(std::back_inserter(line_), " {}//{}", std::uint64_t{corners[i]} + 1,
                   std::uint64_t{normals[i]} + 1);
  }
  line_ += '\n';
  file_.write(line_);
}

void ObjWriter::face(std::span<const std::uint32_t> corners) {
  line_.clear();
  line_ += 'f';
  for (const std::uint32_t corner : corners) {
    fmt::format_to(std::back_inserter(line_), " {}", std::uint64_t{corner} + 1);
  }
  line_ += '\n';
  file_.write(line_);
}

}  // namespace bitspan
