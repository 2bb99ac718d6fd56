// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "config/modes.hpp"
#include "golden/ideal_point.hpp"
#include "report/visibility.hpp"
#include "study/bounds/error_analysis.hpp"
#include "study/bounds/texts.hpp"

namespace bitspan {

using bounds::ErrorAnalysis;
using bounds::explained;
using bounds::place_count;
using bounds::PlaceError;
using bounds::PlaceErrors;
using bounds::WorstCase;

namespace {

bool is_bounded(Perspective p) {
  switch (p) {
    case Perspective::delta_f:
      return true;
    case Perspective::const_depth_rows:
    case Perspective::hyperbolic:
    case Perspective::affine:
      return false;
  }
  unreachable();
}
bool is_bounded(RowSlope slope) {
  switch (slope) {
    case RowSlope::divide:
    case RowSlope::reciprocal:
      return true;
    case RowSlope::plane:
      return false;
  }
  unreachable();
}
bool is_bounded(DepthCode code) {
  switch (code) {
    case DepthCode::inverse:
    case DepthCode::opengl:
      return true;
    case DepthCode::linear:
    case DepthCode::w_float:
    case DepthCode::float_dz:
      return false;
  }
  unreachable();
}
std::string no_bound(std::string_view key, std::string_view value, std::string_view legal) {
  return fmt::format("{}: no bound is known for {}; legal for bounds: {}", key, value, legal);
}
void check_modes(const Config& config) {
  const auto refuse = [](std::string_view key, std::string_view value, std::string_view legal) {
    throw InputError(no_bound(key, value, legal));
  };
  if (!is_bounded(config.perspective)) {
    refuse("perspective.mode", to_string(config.perspective), "delta_f");
  }
  if (has_subspans(config)) {
    refuse("perspective.subspan_bits", std::to_string(config.subspan_bits), "0");
  }
  if (!is_bounded(config.row_slope)) {
    refuse("slope.row", to_string(config.row_slope), "divide, reciprocal");
  }
  if (!is_bounded(config.depth_code)) refuse("depth.code", to_string(config.depth_code), "inverse, opengl");
}

// Calls f(point) at each centre in the picture that a triangle may cover. The edges of a dda may lie further
// out.
template <class F>
void each_centre(const Config& config, const Scene& scene, const Triangle& triangle, double x_error, F f) {
  const auto t = ideal_triangle(config, triangle);
  if (!t) return;
  const auto [least_x, most_x] = std::minmax({t->v[0].x, t->v[1].x, t->v[2].x});
  const auto pixel = [&](std::int64_t at) { return at >> t->subpixel_bits; };
  const auto outside =
      has_x_step(config) ? static_cast<std::int64_t>(std::ceil(std::min<double>(x_error, scene.width))) : 0;
  const std::int64_t first_y = std::max<std::int64_t>(0, pixel(t->v[0].y) - 1);
  const std::int64_t end_y = std::min<std::int64_t>(scene.height, pixel(t->v[2].y) + 2);
  for (std::int64_t y = first_y; y < end_y; ++y) {
    std::int64_t first = std::max<std::int64_t>(0, pixel(least_x) - 1);
    const std::int64_t end = std::min<std::int64_t>(scene.width, pixel(most_x) + 2);
    while (first < end && !ideal_covers(config, *t, first, y)) ++first;
    std::int64_t last = first;
    while (last < end && ideal_covers(config, *t, last, y)) ++last;
    if (has_x_step(config)) {
      // A row that covers no centre exactly may do so by its own error.
      if (first == last) {
        first = std::max<std::int64_t>(0, pixel(least_x) - 1);
        last = end;
      }
      first = std::max<std::int64_t>(0, first - outside);
      last = std::min<std::int64_t>(scene.width, last + outside);
    }
    for (std::int64_t x = first; x < last; ++x) {
      f(ideal_point(config, scene, *t, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
    }
  }
}

// The bounds are of one view, and of the line h.
void check_scene(const Config& config, const Scene& scene) {
  if (changes_scene(scene.commands)) {
    throw InputError(scene.name + ": no bound is known for a scene whose view a command changes");
  }
  if (std::ranges::any_of(scene.triangles, &Triangle::is_line)) {
    throw InputError(scene.name + ": no bound is known for a scene with lines");
  }
  if (goes_by_given_depth(config, scene)) {
    throw InputError(
        fmt::format("depth.line: no bound is known for {} where vertices give it; legal for bounds: {}",
                    to_string(DepthLine::z), to_string(DepthLine::h)));
  }
}

void check_range(const InputRange& r) {
  const auto refuse = [](const char* name, const std::string& text) {
    throw InputError(fmt::format("input range: {}: {}", name, text));
  };
  if (r.width < 1 || r.height < 1) refuse("width, height", "legal: 1 and more");
  if (!(std::isfinite(r.s_max) && r.s_min > 0 && r.s_min < r.s_max)) {
    refuse("s_min, s_max", "legal: finite, 0 < s_min < s_max");
  }
  const auto interval = [&](const char* name, Interval i) {
    if (!(std::isfinite(i.lo) && std::isfinite(i.hi) && i.lo <= i.hi))
      refuse(name, "legal: finite, lo <= hi");
  };
  interval("s", r.s);
  interval("x", r.x);
  interval("y", r.y);
  interval("u", r.u);
  interval("v", r.v);
  if (!(r.s_min <= r.s.lo && r.s.hi <= r.s_max)) refuse("s", "legal: within s_min..s_max");
  for (const double g :
       {r.shortest_edge, r.shortest_row, r.longest_row, r.inverse_s_gradient, r.u_gradient, r.v_gradient}) {
    if (!(g >= 0)) refuse("shortest_edge, gradients", "legal: 0 and more");
  }
  if (!r.projected) return;
  const ProjectedRange& p = *r.projected;
  if (!(std::isfinite(p.s_max) && p.s_min > 0 && p.s_min < p.s_max)) {
    refuse("projected.s_min, s_max", "legal: finite, 0 < s_min < s_max");
  }
  for (const auto* three : {&p.xyw, &p.over_s, &p.place}) {
    for (const Interval i : *three) interval("projected", i);
  }
  if (!(p.xyw[2].lo > 0 && p.over_s[2].lo > 0)) refuse("projected.xyw", "legal: W above 0");
  for (const auto* three : {&p.over_s_gradient, &p.place_gradient}) {
    for (const double g : *three) {
      if (!(g >= 0)) refuse("projected, gradients", "legal: 0 and more");
    }
  }
}

// Adds the places of light per pixel, whose bounds are of one pixel each, as the largest of a triangle's.
void add_light(const Config& config, const Scene& scene, std::size_t triangle, PlaceErrors& own) {
  if (!scene.light) {
    for (std::size_t p = 0; p < place_count; ++p) {
      if (bounds::is_lit(p)) own.places[p] = {};
    }
  }
  if (!own.light.per_pixel) return;
  each_centre(config, scene, scene.triangles[triangle], own.worst.x_error, [&](const IdealPoint& at) {
    bounds::raise_light(*own.light_unit, light_at(config, own, at), own.places);
  });
}

}  // namespace

std::string unbounded_light(const Config& config) {
  if (has_relief(config)) {
    return no_bound("light.normal", to_string(config.light_normal), to_string(LightNormal::channel));
  }
  if (has_light_shadow(config)) {
    return no_bound("light.shadow", to_string(config.light_shadow), to_string(LightShadow::none));
  }
  return {};
}

void check_bounded(const Config& config, const Scene& scene) {
  check_modes(config);
  check_scene(config, scene);
}

bool has_bounds(const Config& config) {
  return is_bounded(config.perspective) && !has_subspans(config) && is_bounded(config.row_slope) &&
         is_bounded(config.depth_code);
}

std::vector<Bound> error_bounds(const Config& config, const InputRange& range) {
  check_modes(config);
  check_range(range);
  const PlaceErrors analysis = ErrorAnalysis(config).run(range);
  std::array<WorstCase, place_count> worst;
  worst.fill(analysis.worst);
  return explained(config, analysis.places, worst);
}

std::function<double(const InputRange&)> edge_position_error(const Config& config) {
  check_modes(config);
  return [analyser = std::make_shared<ErrorAnalysis>(config)](const InputRange& range) {
    check_range(range);
    return analyser->run(range).places[bounds::edge_x].bound();
  };
}

std::vector<Bound> error_bounds(const Config& config, const Scene& scene) {
  check_modes(config);
  check_scene(config, scene);
  std::vector<std::optional<InputRange>> triangles = ranges_of_triangles(config, scene);
  if (std::ranges::none_of(triangles, [](const auto& r) { return r.has_value(); })) {
    triangles.emplace_back(input_range(config, scene));
  }
  ErrorAnalysis analysis(config);
  std::array<PlaceError, place_count> places;
  std::array<WorstCase, place_count> worst;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!triangles[i]) continue;
    check_range(*triangles[i]);
    PlaceErrors own = analysis.run(*triangles[i]);
    add_light(config, scene, i, own);
    for (std::size_t p = 0; p < place_count; ++p) {
      if (!own.places[p].used) continue;
      const double resolution = std::max(places[p].resolution, own.places[p].resolution);
      if (!places[p].used || own.places[p].bound() > places[p].bound()) {
        places[p] = std::move(own.places[p]);
        worst[p] = own.worst;
      }
      places[p].resolution = resolution;
    }
  }
  return explained(config, places, worst);
}

std::vector<double> stored_depth_bounds(const Config& config, const Scene& scene) {
  check_modes(config);
  check_scene(config, scene);
  ErrorAnalysis analysis(config);
  std::vector<double> out;
  for (const std::optional<InputRange>& range : ranges_of_triangles(config, scene)) {
    out.push_back(0);
    if (!range || !range->covers) continue;
    check_range(*range);
    const PlaceErrors own = analysis.run(*range);
    const PlaceError& z = own.places[bounds::depth_z];
    out.back() = z.bound() + z.resolution;
  }
  return out;
}

Hypotheses bound_hypotheses(const Config& config, const InputRange& range) {
  check_modes(config);
  check_range(range);
  return ErrorAnalysis(config).run(range).hypotheses;
}

std::vector<BoundCheck> check_bounds(std::span<const Bound> bounds, std::span<const FieldError> observed) {
  std::vector<BoundCheck> out;
  for (const FieldError& field : observed) {
    const Bound* found = nullptr;
    for (const Bound& b : bounds) {
      if (b.stage == field.stage && b.quantity == field.quantity) found = &b;
    }
    if (found == nullptr || field.count == 0) continue;
    BoundCheck check{found->place, field.stage, field.quantity, found->unit, found->bound,
                     field.max,    0,           false};
    check.ratio = field.max == 0 ? 0 : field.max / found->bound;
    check.holds = field.max <= found->bound + found->resolution;  // false for a NaN
    out.push_back(std::move(check));
  }
  return out;
}

bool all_hold(std::span<const BoundCheck> checks) {
  return std::all_of(checks.begin(), checks.end(), [](const BoundCheck& c) { return c.holds; });
}

}  // namespace bitspan
