// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh_binary.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "config/fnv.hpp"

namespace bitspan {
namespace {

constexpr std::string_view magic = "bitmesh1";

[[noreturn]] void refuse_bytes(const char* what) { throw std::runtime_error(what); }

class MeshWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    out_.insert(out_.end(), bytes, bytes + sizeof value);
  }
  template <class Bytes>
  void put_bytes(const Bytes& bytes) {
    put(std::uint64_t{bytes.size()});
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  void put_color(const std::array<double, 4>& color) {
    for (const double c : color) put(c);
  }
  std::vector<std::uint8_t>& bytes() { return out_; }

 private:
  std::vector<std::uint8_t> out_;
};

class MeshReader {
 public:
  explicit MeshReader(std::span<const std::uint8_t> left) : left_(left) {}

  template <class T>
  T take() {
    static_assert(std::is_arithmetic_v<T>);
    if (left_.size() < sizeof(T)) refuse_bytes("it ends too early");
    T value{};
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  // Of things that take at least `bytes` each.
  std::uint64_t take_count(std::uint64_t bytes) {
    const auto count = take<std::uint64_t>();
    if (count > left_.size() / bytes) refuse_bytes("it ends too early");
    return count;
  }
  template <class Bytes>
  Bytes take_bytes() {
    const std::uint64_t count = take_count(1);
    Bytes bytes(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(count));
    left_ = left_.subspan(count);
    return bytes;
  }
  std::array<double, 4> take_color() {
    return {take<double>(), take<double>(), take<double>(), take<double>()};
  }
  bool take_bool() {
    const auto code = take<std::uint8_t>();
    if (code > 1) refuse_bytes("it has an illegal code");
    return code == 1;
  }
  // -1, or below the count.
  int take_index(std::size_t count) {
    const auto index = take<std::int32_t>();
    if (index < -1 || (index >= 0 && static_cast<std::size_t>(index) >= count))
      refuse_bytes("an index is past the end");
    return index;
  }
  bool at_end() const { return left_.empty(); }

 private:
  std::span<const std::uint8_t> left_;
};

void put_corner(MeshWriter& out, const MeshCorner& corner) {
  for (const double x : {corner.position.x, corner.position.y, corner.position.z, corner.u, corner.v,
                         corner.normal.x, corner.normal.y, corner.normal.z})
    out.put(x);
  out.put_color(corner.color);
}

MeshCorner take_corner(MeshReader& in) {
  MeshCorner corner;
  for (double* x : {&corner.position.x, &corner.position.y, &corner.position.z, &corner.u, &corner.v,
                    &corner.normal.x, &corner.normal.y, &corner.normal.z}) {
    *x = in.take<double>();
  }
  corner.color = in.take_color();
  return corner;
}

constexpr std::uint64_t triangle_bytes = std::uint64_t{36} * sizeof(double) + 5;

}  // namespace

std::vector<std::uint8_t> encode_mesh(const MeshAnswer& answer) {
  const MeshFile& mesh = answer.mesh;
  MeshWriter out;
  out.bytes().resize(mesh_header_bytes);
  out.bytes().reserve(mesh_header_bytes + triangle_bytes * mesh.triangles.size());
  out.put_bytes(answer.error);
  out.put(std::uint64_t{mesh.images.size()});
  for (const MeshImage& image : mesh.images) {
    out.put_bytes(image.name);
    out.put_bytes(image.path);
    out.put_bytes(image.bytes);
  }
  out.put(std::uint64_t{mesh.materials.size()});
  for (const MeshMaterial& material : mesh.materials) {
    out.put_bytes(material.name);
    out.put(std::int32_t{material.image});
    out.put_color(material.color);
    out.put(static_cast<std::uint8_t>(material.alpha));
    out.put(material.alpha_cutoff);
    out.put(static_cast<std::uint8_t>(material.two_sided));
  }
  out.put(std::uint64_t{mesh.notes.size()});
  for (const std::string& note : mesh.notes) out.put_bytes(note);
  out.put(std::uint64_t{mesh.triangles.size()});
  for (const MeshTriangle& triangle : mesh.triangles) {
    for (const MeshCorner& corner : triangle.corner) put_corner(out, corner);
    out.put(std::int32_t{triangle.material});
    out.put(static_cast<std::uint8_t>(triangle.has_uv));
  }
  std::vector<std::uint8_t>& bytes = out.bytes();
  const std::uint64_t size = bytes.size() - mesh_header_bytes;
  const std::uint64_t hash = fnv64(std::span(bytes).subspan(mesh_header_bytes));
  std::copy(magic.begin(), magic.end(), bytes.begin());
  std::memcpy(&bytes[8], &size, sizeof size);
  std::memcpy(&bytes[16], &hash, sizeof hash);
  return std::move(bytes);
}

std::uint64_t mesh_payload_bytes(std::span<const std::uint8_t> header) {
  MeshReader in(header);
  for (const char c : magic) {
    if (in.take<char>() != c) refuse_bytes("it does not begin as a mesh does");
  }
  const auto size = in.take<std::uint64_t>();
  if (size > mesh_payload_limit) refuse_bytes("it is too large");
  return size;
}

MeshAnswer decode_mesh(std::span<const std::uint8_t> header, std::span<const std::uint8_t> payload) {
  if (mesh_payload_bytes(header) != payload.size()) refuse_bytes("it ends too early");
  if (MeshReader(header.subspan(16)).take<std::uint64_t>() != fnv64(payload))
    refuse_bytes("its checksum is another one");
  MeshAnswer answer;
  MeshFile& mesh = answer.mesh;
  MeshReader in(payload);
  answer.error = in.take_bytes<std::string>();
  mesh.images.resize(in.take_count(24));
  for (MeshImage& image : mesh.images) {
    image.name = in.take_bytes<std::string>();
    image.path = in.take_bytes<std::string>();
    image.bytes = in.take_bytes<std::vector<std::uint8_t>>();
  }
  mesh.materials.resize(in.take_count(54));
  for (MeshMaterial& material : mesh.materials) {
    material.name = in.take_bytes<std::string>();
    material.image = in.take_index(mesh.images.size());
    material.color = in.take_color();
    const auto alpha = in.take<std::uint8_t>();
    if (alpha > static_cast<std::uint8_t>(AlphaMode::blend)) refuse_bytes("it has an illegal code");
    material.alpha = static_cast<AlphaMode>(alpha);
    material.alpha_cutoff = in.take<double>();
    material.two_sided = in.take_bool();
  }
  mesh.notes.resize(in.take_count(8));
  for (std::string& note : mesh.notes) note = in.take_bytes<std::string>();
  mesh.triangles.resize(in.take_count(triangle_bytes));
  for (MeshTriangle& triangle : mesh.triangles) {
    for (MeshCorner& corner : triangle.corner) corner = take_corner(in);
    triangle.material = in.take_index(mesh.materials.size());
    triangle.has_uv = in.take_bool();
  }
  if (!in.at_end()) refuse_bytes("it goes on behind its end");
  return answer;
}

}  // namespace bitspan
