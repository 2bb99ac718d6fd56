// SPDX-License-Identifier: Apache-2.0
#include "cli/turntable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "model/stages/rotate.hpp"

namespace bitspan {
namespace {

// A vector of the plane through the unit, its largest length scaled to 2^(int - 2) at most.
class TurnedBy {
 public:
  TurnedBy(const RotateFormats& formats, const Turn& turn, double longest)
      : stage_(model::prepare_rotate(formats, 8 * turn.count)) {
    const int steps = 8 * turn.number;
    by_ = model::rotate_operands(stage_, steps > 4 * turn.count ? steps - 8 * turn.count : steps);
    int exponent = 0;  // longest < 2^exponent
    std::frexp(longest, &exponent);
    scale_ = formats.xy.integer - 2 - exponent + formats.xy.fraction();
  }
  void operator()(double& x, double& y) const {
    const auto raw = [&](double value) {
      return static_cast<std::int64_t>(std::floor(std::ldexp(value, scale_) + 0.5));
    };
    const PlaneVector out = model::rotate(stage_, {raw(x), raw(y)}, by_);
    x = std::ldexp(static_cast<double>(out.x), -scale_);
    y = std::ldexp(static_cast<double>(out.y), -scale_);
  }

 private:
  model::RotateStage stage_;
  model::RotateOperands by_;
  int scale_ = 0;
};

}  // namespace

void turn_mesh(Mesh& mesh, Camera& camera, const Turn& turn, const RotateFormats& formats) {
  camera.target = camera.target.value_or(middle_of(mesh));
  const Vec3 middle = *camera.target;
  double longest = 0;
  for (const Face& face : mesh.faces) {
    for (const Corner& corner : face.corner) {
      const Vec3 p = corner.position - middle;
      longest = std::max(longest, std::hypot(p.x, p.z));
    }
  }
  const TurnedBy turned(formats, turn, longest);
  const TurnedBy turned_normal(formats, turn, 1);
  for (Face& face : mesh.faces) {
    for (Corner& corner : face.corner) {
      Vec3 p = corner.position - middle;
      turned(p.z, p.x);
      corner.position = middle + p;
      Vec3 n = normal_of(corner);
      turned_normal(n.z, n.x);
      set_normal(corner, of_length_1(n));
    }
  }
  mesh.quadrics.clear();  // they would stand where their triangles were
}

std::string numbered_output(const std::string& path, const Turn& turn) {
  std::filesystem::path out(path);
  const std::size_t digits = std::to_string(turn.count - 1).size();
  out.replace_filename(
      fmt::format("{}-{:0{}}{}", out.stem().string(), turn.number, digits, out.extension().string()));
  return out.string();
}

}  // namespace bitspan
