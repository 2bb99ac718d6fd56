// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/quadric.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "config/config.hpp"
#include "config/modes.hpp"

namespace bitspan {
namespace {

// r(y)^2 = -(square (y/b)^2 + linear y/b + constant).
struct Profile {
  double square, linear, constant;
  double radius(double t) const { return std::sqrt(std::max(0.0, -((square * t + linear) * t + constant))); }
};
Profile profile_of(QuadricShape shape) {
  switch (shape) {
    case QuadricShape::sphere:
    case QuadricShape::ellipsoid:
      return {1, 0, -1};
    case QuadricShape::cylinder:
      return {0, 0, -1};
    case QuadricShape::cone:
      return {-1, 0, 0};
    case QuadricShape::paraboloid:
      return {0, -1, 0};
    case QuadricShape::hyperboloid:
      return {-1, 0, -1};
    case QuadricShape::hyperboloid_two:
      return {-1, 0, 1};
  }
  unreachable();
}

bool is_straight(QuadricShape shape) {
  return shape == QuadricShape::cylinder || shape == QuadricShape::cone;
}
bool is_whole_without_cuts(QuadricShape shape) {
  return shape == QuadricShape::sphere || shape == QuadricShape::ellipsoid;
}

// A sheet of the body, between two of its heights in units of b.
struct Sheet {
  double from, to;
};
std::vector<Sheet> sheets_of(const QuadricBody& body) {
  const double b = body.radii[1];
  const double from = body.from ? *body.from / b : -HUGE_VAL;
  const double to = body.to ? *body.to / b : HUGE_VAL;
  std::vector<Sheet> out;
  const auto add = [&](double low, double high) {
    const Sheet sheet{std::max(from, low), std::min(to, high)};
    if (sheet.from < sheet.to) out.push_back(sheet);
  };
  switch (body.shape) {
    case QuadricShape::sphere:
    case QuadricShape::ellipsoid:
      add(-1, 1);
      break;
    case QuadricShape::cylinder:
    case QuadricShape::hyperboloid:
      add(-HUGE_VAL, HUGE_VAL);
      break;
    case QuadricShape::cone:
      add(-HUGE_VAL, 0);
      add(0, HUGE_VAL);
      break;
    case QuadricShape::paraboloid:
      add(0, HUGE_VAL);
      break;
    case QuadricShape::hyperboloid_two:
      add(-HUGE_VAL, -1);
      add(1, HUGE_VAL);
      break;
  }
  return out;
}

// Heights in units of b are equidistant in a parameter of the profile, in which it bends evenly.
double parameter_of(QuadricShape shape, double y) {
  switch (shape) {
    case QuadricShape::sphere:
    case QuadricShape::ellipsoid:
      return std::asin(std::clamp(y, -1.0, 1.0));
    case QuadricShape::cylinder:
    case QuadricShape::cone:
      return y;
    case QuadricShape::paraboloid:
      return std::sqrt(y);
    case QuadricShape::hyperboloid:
      return std::asinh(y);
    case QuadricShape::hyperboloid_two:
      return y < 0 ? -std::acosh(-y) : std::acosh(y);
  }
  unreachable();
}
double height_of(QuadricShape shape, double t, bool is_lower) {
  switch (shape) {
    case QuadricShape::sphere:
    case QuadricShape::ellipsoid:
      return std::sin(t);
    case QuadricShape::cylinder:
    case QuadricShape::cone:
      return t;
    case QuadricShape::paraboloid:
      return t * t;
    case QuadricShape::hyperboloid:
      return std::sinh(t);
    case QuadricShape::hyperboloid_two:
      return is_lower ? -std::cosh(t) : std::cosh(t);
  }
  unreachable();
}

int rows_of(const QuadricBody& body) {
  return body.rows.value_or(is_straight(body.shape) ? 1 : std::max(2, (body.steps + 1) / 2));
}

// Some direction across another one.
Vec3 side_of_axis(const Vec3& axis) {
  const Vec3 x{1, 0, 0};
  const Vec3 z{0, 0, 1};
  const Vec3 side = cross(axis, std::fabs(axis.z) < 0.9 ? z : x);
  return of_length_1(side);
}

class Tessellation {
 public:
  explicit Tessellation(const QuadricBody& body) : body_(body), profile_(profile_of(body.shape)) {
    y_ = of_length_1(body.axis);
    x_ = side_of_axis(y_);
    z_ = cross(x_, y_);
    set_forms();
  }

  QuadricMesh made() {
    bool is_closed = true;
    for (const Sheet& sheet : sheets_of(body_)) {
      add_wall(sheet);
      for (const bool at_end : {false, true}) {
        const double y = at_end ? sheet.to : sheet.from;
        if (profile_.radius(y) == 0) continue;
        if (body_.caps) {
          add_cap(y, at_end);
        } else {
          is_closed = false;
        }
      }
    }
    Quadric& q = out_.quadric;
    q.count = out_.triangles.size();
    q.two_sided = !is_closed;
    q.low = -largest_dent_ / 3 - rounding_;
    q.high = largest_bulge_ / 3 + rounding_;
    return std::move(out_);
  }

 private:
  // sum of weight (axis . p)^2, and the terms along y.
  void set_forms() {
    MeshQuadric& q = out_.quadric;
    q.origin = body_.centre;
    const auto& [a, b, c] = body_.radii;
    const std::array<double, 3> weight{1 / (a * a), profile_.square / (b * b), 1 / (c * c)};
    const std::array<Vec3, 3> axes{x_, y_, z_};
    const double half = profile_.linear / (2 * b);
    std::size_t at = 0;
    const std::array<double Vec3::*, 3> part{&Vec3::x, &Vec3::y, &Vec3::z};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i; j < 3; ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += weight[k] * (axes[k].*part[i] * axes[k].*part[j]);
        q.matrix[at++] = sum;
      }
      q.matrix[at++] = half * y_.*part[i];
    }
    q.matrix[at] = profile_.constant;
    squares_.matrix = q.matrix;
    for (const std::size_t i : std::array<std::size_t, 4>{3, 6, 8, 9}) squares_.matrix[i] = 0;
    // One sheet of two has planes on both sides, though only one of them cuts.
    if (is_whole_without_cuts(body_.shape) && !body_.from && !body_.to) return;
    const std::vector<Sheet> sheets = sheets_of(body_);
    QuadricClip& clip = q.clip.emplace();
    clip.axis = {y_.x, y_.y, y_.z, 0};
    // Beyond a pole that a plane does not reach, so that rounding cuts nothing off there.
    const double room = 0.5 * b;
    const double low = sheets.front().from * b;
    const double high = sheets.back().to * b;
    const bool ends_low = profile_.radius(sheets.front().from) == 0;
    const bool ends_high = profile_.radius(sheets.back().to) == 0;
    const bool is_cone = body_.shape == QuadricShape::cone;  // its other sheet begins at the apex
    clip.from = ends_low && !is_cone ? low - room : low;
    clip.to = ends_high && !is_cone ? high + room : high;
    clip.cap_from = body_.caps && !ends_low;
    clip.cap_to = body_.caps && !ends_high;
  }

  Vec3 place(double angle, double y) const {
    const double r = profile_.radius(y);
    return x_ * (body_.radii[0] * r * std::cos(angle)) + y_ * (body_.radii[1] * y) +
           z_ * (body_.radii[2] * r * std::sin(angle));
  }
  double angle_of(int i) const { return 2 * std::numbers::pi * i / body_.steps; }
  MeshCorner corner(double angle, double y) const {
    MeshCorner out;
    const Vec3 p = place(angle, y);
    out.position = body_.centre + p;
    out.color = body_.color;
    out.normal = normal(angle, y);
    return out;
  }
  // A cone's apex has the normal of the generator.
  Vec3 normal(double angle, double y) const {
    const bool is_apex = body_.shape == QuadricShape::cone && y == 0;
    return of_length_1(gradient_at(out_.quadric, place(angle, is_apex ? apex_side_ : y)));
  }

  // The corners of one height, the last one the first again.
  std::vector<MeshCorner> ring(double y, double v) const {
    std::vector<MeshCorner> out;
    const bool is_pole = profile_.radius(y) == 0;
    for (int i = 0; i <= body_.steps; ++i) {
      // All corners of a pole stand at one place; its triangles have their normals in their middles.
      MeshCorner& here = out.emplace_back(corner(i == body_.steps ? 0 : angle_of(i), y));
      if (is_pole) {
        here.position = body_.centre + y_ * (body_.radii[1] * y);
        here.normal = normal(angle_of(i) + std::numbers::pi / body_.steps, y);
      }
      here.u = static_cast<double>(i) / body_.steps;
      here.v = v;
    }
    return out;
  }

  void add_wall(const Sheet& sheet) {
    const int rows = rows_of(body_);
    const bool is_lower = sheet.to <= 0;
    apex_side_ = is_lower ? -1 : 1;
    const double t_from = parameter_of(body_.shape, sheet.from);
    const double t_to = parameter_of(body_.shape, sheet.to);
    const auto ring_at = [&](int row) {
      const double share = static_cast<double>(row) / rows;
      const double y = row == 0      ? sheet.from
                       : row == rows ? sheet.to
                                     : height_of(body_.shape, t_from + (t_to - t_from) * share, is_lower);
      std::vector<MeshCorner> out = ring(y, share);
      for (const MeshCorner& c : out) {
        const double off = value_at(out_.quadric, c.position - body_.centre);
        rounding_ = std::max(rounding_, 4 * std::fabs(off) + 1e-14);
      }
      return out;
    };
    std::vector<MeshCorner> below = ring_at(0);
    for (int row = 1; row <= rows; ++row) {
      std::vector<MeshCorner> above = ring_at(row);
      for (std::size_t i = 0; i + 1 < above.size(); ++i) {
        add(below[i], above[i], above[i + 1], true);
        // The corner of a pole that belongs to this step.
        const bool is_pole = above[i].position == above[i + 1].position;
        add(below[i], above[is_pole ? i : i + 1], below[i + 1], true);
      }
      below = std::move(above);
    }
  }

  void add_cap(double y, bool is_upper) {
    std::vector<MeshCorner> rim = ring(y, 0);
    MeshCorner middle = rim[0];
    middle.position = body_.centre + y_ * (body_.radii[1] * y);
    middle.u = middle.v = 0.5;
    const Vec3 outward = y_ * (is_upper ? 1 : -1);
    middle.normal = outward;
    for (int i = 0; i <= body_.steps; ++i) {
      MeshCorner& c = rim[static_cast<std::size_t>(i)];
      c.normal = outward;
      c.u = 0.5 + 0.5 * std::cos(angle_of(i));
      c.v = 0.5 + 0.5 * std::sin(angle_of(i));
    }
    for (std::size_t i = 0; i + 1 < rim.size(); ++i) {
      if (is_upper) {
        add(middle, rim[i + 1], rim[i], false);
      } else {
        add(middle, rim[i], rim[i + 1], false);
      }
    }
  }

  // Over a triangle with corners on the body f = -sum of b_i b_j d_ij, with d_ij the form of the side's
  // vector, and the sum of the b_i b_j is at most 1/3.
  void add(const MeshCorner& a, const MeshCorner& b, const MeshCorner& c, bool is_wall) {
    if (a.position == b.position || b.position == c.position || c.position == a.position) return;
    const MeshTriangle triangle{.corner = {a, b, c}, .has_uv = true};
    out_.triangles.push_back(triangle);
    if (!is_wall) return;
    const std::array at{&a, &b, &c};
    for (std::size_t i = 0; i < 3; ++i) {
      const double d = value_at(squares_, at[i]->position - at[(i + 1) % 3]->position);
      largest_dent_ = std::max(largest_dent_, d);
      largest_bulge_ = std::max(largest_bulge_, -d);
    }
  }

  const QuadricBody& body_;
  Profile profile_;
  Vec3 x_, y_, z_;
  double apex_side_ = 1;
  Quadric squares_;  // f without what is linear in the point
  double largest_dent_ = 0, largest_bulge_ = 0;
  double rounding_ = 0;  // of the corners' coordinates
  QuadricMesh out_;
};

}  // namespace

std::string body_fault(const QuadricBody& body) {
  const auto& [a, b, c] = body.radii;
  for (const double radius : body.radii) {
    if (!(radius >= 1e-6 && radius <= 1e6)) {
      return fmt::format("radii: {} is not legal; expected 1e-6..1e6", radius);
    }
  }
  if (body.shape == QuadricShape::sphere && !(a == b && b == c)) {
    return "radii: a sphere has one radius; expected the same number three times";
  }
  for (const double x : {body.centre.x, body.centre.y, body.centre.z}) {
    if (!(std::fabs(x) <= 1e9)) return fmt::format("centre: {} is not legal; expected at most 1e9", x);
  }
  if (of_length_1(body.axis) == Vec3{}) return "axis: is not legal; expected a finite vector that is not 0";
  for (const double x : body.color) {
    if (!(x >= 0 && x <= 1)) return fmt::format("color: {} is not legal; expected 0..1", x);
  }
  if (body.steps < quadric_steps_least || body.steps > quadric_steps_limit) {
    return fmt::format("steps: {} is not legal; expected {}..{}", body.steps, quadric_steps_least,
                       quadric_steps_limit);
  }
  if (body.rows && (*body.rows < 1 || *body.rows > quadric_steps_limit)) {
    return fmt::format("rows: {} is not legal; expected 1..{}", *body.rows, quadric_steps_limit);
  }
  for (const auto& height : {body.from, body.to}) {
    if (height && !(std::fabs(*height) <= 1e6 * b)) {
      return fmt::format("from, to: {} is not legal; expected at most 1e6 of the second radius", *height);
    }
  }
  const bool has_least = body.shape == QuadricShape::paraboloid || is_whole_without_cuts(body.shape);
  if ((!body.from && !has_least) || (!body.to && !is_whole_without_cuts(body.shape))) {
    return fmt::format("from, to: a {} goes on without end; expected both heights", to_string(body.shape));
  }
  if (body.from && body.to && !(*body.from < *body.to)) {
    return fmt::format("from: {} is not below to = {}; expected from < to", *body.from, *body.to);
  }
  if (sheets_of(body).empty()) return "from, to: nothing of the body is between them; expected other heights";
  if (most_triangles(body) > quadric_triangles_limit) {
    return fmt::format("steps: {} makes too many triangles; expected {} at most", body.steps,
                       quadric_triangles_limit);
  }
  return "";
}

std::size_t most_triangles(const QuadricBody& body) {
  const auto steps = static_cast<std::size_t>(body.steps);
  const auto rows = static_cast<std::size_t>(rows_of(body));
  return sheets_of(body).size() * 2 * steps * (rows + 1);  // two caps have as many as a row
}

QuadricMesh tessellated(const QuadricBody& body) {
  if (const std::string fault = body_fault(body); !fault.empty()) throw InputError(fault);
  return Tessellation(body).made();
}

}  // namespace bitspan
