// SPDX-License-Identifier: Apache-2.0
#include "report/quadrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "golden/quadric.hpp"

namespace bitspan {
namespace {

constexpr int no_body = -1;

// What the ray sees first, with nothing between it and the surfaces themselves.
struct FirstSeen {
  golden::Interval t{HUGE_VAL, HUGE_VAL};
  int body = no_body;
  std::int32_t triangle = -1;  // where it is of no body
  bool is_open = false;        // another one may be as near
  bool is_nothing() const { return body == no_body && triangle < 0; }
};

class QuadricJudge {
 public:
  QuadricJudge(const Visibility& visibility, const Oracle& oracle)
      : visibility_(visibility),
        oracle_(oracle.name),
        scene_(visibility.scene()),
        body_of_(scene_.triangles.size(), no_body),
        others_(visibility.picture_without_quadrics(oracle)) {
    for (const Quadric& q : scene_.quadrics) {
      shells_.push_back(golden::shell_of(visibility.config(), scene_, q));
      double bound = 0;
      for (std::size_t i = 0; i < q.count; ++i) {
        body_of_[q.first + i] = static_cast<int>(bounds_.size());
        bound = std::max(bound, visibility.bound_of(static_cast<std::int32_t>(q.first + i)));
      }
      bounds_.push_back(bound);
    }
  }

  PixelFinding at(const Frame& frame, std::string_view engine, std::int64_t x, std::int64_t y) {
    const auto unexplained = [&](const std::string& why) {
      return PixelFinding{PixelVerdict::unexplained, fmt::format("pixel ({}, {}): {}", x, y, why)};
    };
    std::string why;
    const std::optional<Visible> shown = visibility_.shown(frame, engine, x, y, why);
    if (!shown) return unexplained(why);
    const golden::QuadricRay ray = golden::ray_through(scene_, x, y);
    const Visible& other = others_[static_cast<std::size_t>(y * frame.width + x)];
    const int body = shown->triangle < 0 ? no_body : body_of_[static_cast<std::size_t>(shown->triangle)];
    const double h = visibility_.depth_of(*shown);
    const double bound = visibility_.bound_of(shown->triangle);
    const double t = shown->triangle < 0 ? HUGE_VAL : t_of(*shown, ray);
    const auto what = [&] {
      return shown->triangle < 0 ? std::string("nothing") : fmt::format("triangle {}", shown->triangle);
    };
    near_.clear();
    for (std::size_t k = 0; k < shells_.size(); ++k) {
      if (!golden::is_always_above(shells_[k].quadric, ray, shells_[k].high)) near_.push_back(k);
    }
    const golden::Interval range = window(ray);
    const FirstSeen seen = first_seen(ray, other, range);
    bool is_there = body == no_body;  // the triangle lies in its body's shell
    bool meets = false;               // and the ray meets the body in that part of the shell
    for (const std::size_t k : near_) {
      for (const golden::QuadricCrossing& c : golden::crossings_of(shells_[k], ray, range)) {
        if (static_cast<int>(k) == body && t >= c.t.low * (1 - same) && t <= c.t.high * (1 + same)) {
          is_there = true;
          meets = meets || (seen.t.low <= c.t.high && seen.t.high >= c.t.low);
          continue;
        }
        const double least = visibility_.depth_at(c.t.high * ray.z);
        if (!c.is_certain || least - h <= bounds_[k] + bound) continue;
        return unexplained(
            fmt::format("{} sees quadric {} at h = {:.10g} at least, and {} shows {} at "
                        "{:.10g}; the bounds are {:.4g} and {:.4g}",
                        oracle_, k, least, engine, what(), h, bounds_[k], bound));
      }
    }
    if (!is_there) {
      const golden::QuadricShell& shell = shells_[static_cast<std::size_t>(body)];
      return unexplained(
          fmt::format("{} shows triangle {}, where f of quadric {} is {:.4g}; its triangles are "
                      "within {:.4g}..{:.4g}, and between its planes",
                      engine, shown->triangle, body, f_at(shell, ray, t), shell.low, shell.high));
    }
    if (other.triangle >= 0 && other.triangle != shown->triangle) {
      const double other_h = visibility_.depth_of(other);
      const double other_bound = visibility_.bound_of(other.triangle);
      if (other_h - h > other_bound + bound) {
        return unexplained(
            fmt::format("{} sees triangle {} at h = {:.10g}, and {} shows {} at {:.10g}; the bounds are "
                        "{:.4g} and {:.4g}",
                        oracle_, other.triangle, other_h, engine, what(), h, other_bound, bound));
      }
    }
    if (shown->triangle < 0 && seen.is_nothing()) return {PixelVerdict::background};
    if (body != no_body && seen.body == body && meets) {
      note(shells_[static_cast<std::size_t>(body)], ray, t, seen);
      return {PixelVerdict::equal};
    }
    if (body == no_body && seen.body == no_body && shown->triangle == seen.triangle) {
      return {PixelVerdict::equal};
    }
    if (seen.is_open || (body == no_body && seen.body == no_body)) return {PixelVerdict::tie};
    return {PixelVerdict::edge,
            seen.is_nothing()      ? fmt::format("at the silhouette of quadric {}", body)
            : seen.body == no_body ? fmt::format("triangle {} is seen beside quadric {}", seen.triangle, body)
                                   : fmt::format("quadric {} is seen, within its shell", seen.body)};
  }

  // How far the triangles are from the bodies where both are seen.
  std::vector<OracleCount> counts() const {
    const double rms = compared_ == 0 ? 0 : std::sqrt(squares_ / static_cast<double>(compared_));
    return {{"of the shell's width at most", worst_share_}, {"codes RMS from the quadrics", rms}};
  }

 private:
  static constexpr double same = 0x1p-40;  // of t: the triangle's is a double

  // Of t; what is cut at the range's ends lies on them.
  golden::Interval window(const golden::QuadricRay& ray) const {
    return {scene_.s_min * (1 - same) / ray.z, scene_.s_max * (1 + same) / ray.z};
  }
  static double t_of(const Visible& seen, const golden::QuadricRay& ray) {
    return static_cast<double>(1 / (seen.q.value * static_cast<long double>(ray.z)));
  }
  static double f_at(const golden::QuadricShell& shell, const golden::QuadricRay& ray, double t) {
    return golden::along(shell.quadric, ray).at(t).value;
  }

  FirstSeen first_seen(const golden::QuadricRay& ray, const Visible& other,
                       const golden::Interval& range) const {
    FirstSeen out;
    if (other.triangle >= 0) {
      const double t = t_of(other, ray);
      out = {.t = {t * (1 - same), t * (1 + same)}, .triangle = other.triangle};
    }
    for (const std::size_t k : near_) {
      const auto hit = golden::first_hit(shells_[k].quadric, ray, range);
      if (!hit || hit->t.low > out.t.high) continue;
      const bool is_as_near = hit->t.high >= out.t.low;
      if (is_as_near && hit->t.high >= out.t.high) {
        out.is_open = true;
        continue;
      }
      out = {.t = hit->t, .body = static_cast<int>(k), .is_open = hit->is_open || is_as_near};
    }
    return out;
  }

  void note(const golden::QuadricShell& shell, const golden::QuadricRay& ray, double t,
            const FirstSeen& seen) {
    const double f = f_at(shell, ray, t);
    const double width = f < 0 ? -shell.low : shell.high;
    // A cap's triangles are inside of the body.
    if (width > 0 && std::fabs(f) <= width) worst_share_ = std::max(worst_share_, std::fabs(f) / width);
    const double middle = 0.5 * (seen.t.low + seen.t.high);
    const double off = visibility_.depth_at(t * ray.z) - visibility_.depth_at(middle * ray.z);
    squares_ += off * off;
    ++compared_;
  }

  const Visibility& visibility_;
  std::string_view oracle_;
  const Scene& scene_;
  std::vector<int> body_of_;     // per triangle
  std::vector<Visible> others_;  // the picture of the triangles that stand for no quadric
  std::vector<golden::QuadricShell> shells_;
  std::vector<double> bounds_;     // per quadric, of its triangles
  std::vector<std::size_t> near_;  // the quadrics in whose shells the ray may come
  double worst_share_ = 0, squares_ = 0;
  std::uint64_t compared_ = 0;
};

}  // namespace

bool judges_quadrics(const Oracle& oracle, const Visibility& visibility) {
  const Scene& scene = visibility.scene();
  return oracle.has_quadrics && !scene.quadrics.empty() && !goes_by_given_depth(visibility.config(), scene);
}

VisibilityReport quadric_report(const Visibility& visibility, const Oracle& oracle,
                                std::span<const Visible> picture, const Frame& frame,
                                std::string_view engine) {
  QuadricJudge judge(visibility, oracle);
  VisibilityReport out =
      visibility.report_of(oracle, picture, frame, engine,
                           [&](std::int64_t x, std::int64_t y) { return judge.at(frame, engine, x, y); });
  out.oracle += "_quadrics";
  out.edges_as = "at a silhouette, or where surfaces meet";
  out.counts = judge.counts();
  return out;
}

PixelFinding quadric_finding(const Visibility& visibility, const Oracle& oracle,
                             std::span<const Visible> picture, const Frame& frame, std::string_view engine,
                             std::int64_t x, std::int64_t y) {
  if (visibility.is_doubtful(picture, x, y)) return {PixelVerdict::left_out};
  return QuadricJudge(visibility, oracle).at(frame, engine, x, y);
}

}  // namespace bitspan
