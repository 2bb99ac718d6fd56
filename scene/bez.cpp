// SPDX-License-Identifier: Apache-2.0
#include "scene/bez.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "config/byte_order_mark.hpp"
#include "config/config.hpp"
#include "scene/mesh_text.hpp"

namespace bitspan {
namespace {

constexpr int control_bits = 20;
constexpr std::size_t bez_patches_limit = 100'000;

// The numbers of a text, with the line of each.
class BezReader {
 public:
  BezReader(const std::string& path, std::string_view text) : path_(path), rest_(text) {}

  std::size_t whole(const char* what, std::size_t least, std::size_t most) {
    const std::string_view word = next(what);
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || value < least || value > most) {
      fail(in_quotes(word) + " is no " + what + "; expected " + std::to_string(least) + ".." +
           std::to_string(most));
    }
    return value;
  }
  double coordinate() {
    const std::string_view word = next("coordinate");
    const auto value = to_number(word);
    if (!value || !std::isfinite(*value) || std::fabs(*value) > 1e12) {
      fail(in_quotes(word) + " is no coordinate; expected a number of at most 1e12");
    }
    return *value;
  }
  void expect_end() {
    skip();
    if (!rest_.empty()) fail("there is more behind the last vertex; expected the end of the file");
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_ + ":" + std::to_string(line_) + ": " + what);
  }

 private:
  static bool divides(char c) { return is_blank(c) || c == ','; }
  void skip() {
    while (!rest_.empty() && divides(rest_.front())) {
      if (rest_.front() == '\n') ++line_;
      rest_.remove_prefix(1);
    }
  }
  std::string_view next(const char* what) {
    skip();
    if (rest_.empty()) fail(std::string("the file ends; expected a ") + what);
    std::size_t length = 0;
    while (length < rest_.size() && !divides(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }

  const std::string& path_;
  std::string_view rest_;
  std::size_t line_ = 1;
};

}  // namespace

PatchSet read_bez(const std::string& path) {
  const std::string text = read_whole(path, "expected patches (.bez)");
  BezReader in(path, without_mark(text));
  const std::size_t patches = in.whole("number of patches", 1, bez_patches_limit);
  std::vector<std::array<std::size_t, 16>> indices;
  std::size_t last = 1;
  for (std::size_t i = 0; i < patches; ++i) {
    auto& of_patch = indices.emplace_back();
    for (std::size_t& index : of_patch) {
      index = in.whole("number of a vertex", 1, 16 * bez_patches_limit);
      last = std::max(last, index);
    }
  }
  const std::size_t count = in.whole("number of vertices", last, 16 * bez_patches_limit);
  std::vector<Vec3> vertices;
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = in.coordinate();
    const double y = in.coordinate();
    const double z = in.coordinate();
    vertices.push_back({x, z, -y});
    largest = std::max({largest, std::fabs(x), std::fabs(y), std::fabs(z)});
  }
  in.expect_end();
  if (!(largest >= 1e-12)) in.fail("all vertices are at 0; expected patches with an extent");

  PatchSet out;
  out.name = std::filesystem::path(path).stem().string();
  int exponent = 0;  // largest <= 2^exponent
  if (std::frexp(largest, &exponent) == 0.5) --exponent;
  out.fraction = control_bits - exponent;
  const auto on_grid = [&](double x) {
    return static_cast<std::int64_t>(std::floor(std::ldexp(x, out.fraction) + 0.5));
  };
  for (const auto& of_patch : indices) {
    Patch& patch = out.patches.emplace_back();
    for (std::size_t i = 0; i < 16; ++i) {
      const Vec3& p = vertices[of_patch[i] - 1];
      patch.axis[0][i / 4][i % 4] = on_grid(p.x);
      patch.axis[1][i / 4][i % 4] = on_grid(p.y);
      patch.axis[2][i / 4][i % 4] = on_grid(p.z);
    }
  }
  return out;
}

MeshFile patch_mesh(const PatchSet& set, int k) {
  check_patch_count(set, k);
  const std::size_t steps = patch_side(k) - 1;
  MeshFile out;
  out.triangles.reserve(set.patches.size() * 2 * steps * steps);
  const int guard = 3 * k;
  for (const Patch& patch : set.patches) {
    const PatchPoints points = patch_points(patch, k, guard);
    std::vector<MeshCorner> corners;
    corners.reserve(points[0].size());
    for (std::size_t row = 0; row <= steps; ++row) {
      for (std::size_t column = 0; column <= steps; ++column) {
        const std::size_t at = row * (steps + 1) + column;
        MeshCorner& corner = corners.emplace_back();
        corner.position = place_in(set, points, at, guard);
        corner.u = static_cast<double>(column) / static_cast<double>(steps);
        corner.v = static_cast<double>(row) / static_cast<double>(steps);
        corner.normal = patch_normal(patch, corner.u, corner.v);
      }
    }
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      const Vec3& p = corners[a].position;
      const Vec3& q = corners[b].position;
      const Vec3& r = corners[c].position;
      if (p == q || q == r || r == p) return;
      MeshTriangle& triangle = out.triangles.emplace_back();
      triangle.corner = {corners[a], corners[b], corners[c]};
      triangle.has_uv = true;
    };
    for (std::size_t row = 0; row < steps; ++row) {
      for (std::size_t column = 0; column < steps; ++column) {
        const std::size_t at = row * (steps + 1) + column;
        add(at, at + 1, at + steps + 2);
        add(at, at + steps + 2, at + steps + 1);
      }
    }
  }
  return out;
}

}  // namespace bitspan
