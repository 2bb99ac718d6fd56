// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/texts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "config/modes.hpp"

namespace bitspan::bounds {

namespace {

std::string number(double x) { return std::isinf(x) ? "infinite" : fmt::format("{:.4g}", x); }

std::string dominant_of(const PlaceError& place) {
  if (place.unbounded) return "no finite bound";
  double sum = 0;
  const std::pair<std::string_view, Interval>* largest = nullptr;
  for (const auto& term : place.error.terms()) {
    sum += term.second.mag();
    if (largest == nullptr || term.second.mag() > largest->second.mag()) largest = &term;
  }
  if (largest == nullptr) return "exact";
  return fmt::format("{}: {} ({:.0f} % of the sum)", largest->first, number(largest->second.mag()),
                     100 * largest->second.mag() / sum);
}

std::string why_of(std::size_t p, const Config& c, const WorstCase& f) {
  const auto walked = [&](const char* what, double distance, int additions) {
    return fmt::format(
        "{} ways of up to {} pixels, {} additions: a step's rounding counts by the way, an "
        "addition's where the accumulator is coarser than the step",
        what, number(distance), additions);
  };
  const bool divides = !shares_reciprocal(c.edge_slope);
  switch (p) {
    case setup_b:
      return "rounding of B and of s_min', s_max'; it scales the whole surface, and leaves u and v alone";
    case setup_h:
      return "rounding of s' counts by q (s / s' - 1), most at the nearest vertex; then the register's "
             "rounding";
    case setup_u:
    case setup_v:
      return "one rounding";
    case edge_x_acc:
    case edge_x:
      return !has_x_step(c) ? "x is exact before the rounding" : walked("edges are", f.edge_distance, f.rows);
    case edge_h_acc:
    case edge_h:
      return walked("edges are", f.edge_distance, f.rows) +
             "; an edge of height d is left after d rows at most, so the rounding of its " +
             (divides ? "slope" : "slope and the reciprocal's error") +
             " cannot add up further however steep it is" +
             (f.slope_saturates
                  ? "; a slope beyond its register stops short of the far end and adds what is missing"
                  : "");
    case edge_fu:
    case edge_fv:
    case span_fu:
    case span_fv:
      return "against (u - u1)(h + B) of the truth: errors of the ends times the largest q, and the walk's "
             "own";
    case edge_reciprocal:
    case span_reciprocal:
      return fmt::format(
          "relative; error of h over the least h + B, {}, and the unit's own error over its whole "
          "table",
          number(f.q_least));
    case edge_u:
    case edge_v:
      return fmt::format(
          "u is between the vertices' u by weights w = t q2 / q: their h errs relative to q >= {}; f "
          "and 1/(h + B) count on the change of u only",
          number(f.q_least));
    case span_h:
    case depth_z:
    case picture_depth:
      return walked("rows are", f.span_distance, f.pixels) +
             fmt::format("; x of the ends errs by {} pixel, times {} codes per pixel", number(f.x_error),
                         number(f.h_gradient)) +
             (f.position_capped
                  ? "; capped by the change between the ends, for a covered centre lies between them: "
                    "a sliver's chord may be shorter than an ulp of edge.x"
                  : "") +
             (f.slope_saturates ? "; a slope beyond its register stops short of the far end" : "");
    case project_s:
    case project_t:
    case project_ratio:
      return fmt::format(
          "a quotient by W (h + B) >= {}: errors of both lines, the vertices' h as weights, the unit's own "
          "error, and x of the ends, which errs by {} pixel",
          number(f.w_least), number(f.x_error));
    case project_h:
    case project_z:
      return "that of project.ratio times A of the projector, whose A and B are rounded";
    case light_normal:
      return "the error of the given normal turns it by the more the shorter it is; then the root's own "
             "error";
    case light_direction:
      return "the error of the place turns it by the more the nearer the light is; then the root's own error";
    case light_cosine:
      return "both vectors turn the angle, times its sine; then the root's own error, and three roundings";
    case light_mirrored:
      return "that of the direction's z, and twice those of the cosine and the normal's z";
    case light_specular:
      return "the power's slope times the error of its cosine; then the table's chord, its entries, and a "
             "rounding; all of it where the cosine's sign is open";
    case light_value:
      return lights_pixels(c.light) ? "the cosine's and the highlight's error by their shares, and a rounding"
                                    : "that of the worst vertex, and the walks of the channel light";
    case light_color:
      return "that of the brightness times the largest colour, and a rounding; the texture's error is apart";
    case span_u:
    case span_v:
    case picture_u:
    case picture_v:
    default:
      return fmt::format(
          "as edge.uv along a row: {} pixels, q >= {}, x of the ends errs by {} pixel, times {} texels "
          "per pixel, capped in exact coverage by the change between the ends",
          f.pixels, number(f.q_least), number(f.x_error),
          number(p == span_u || p == picture_u ? f.uv_gradient[0] : f.uv_gradient[1]));
  }
}

}  // namespace

std::vector<Bound> explained(const Config& config, const std::array<PlaceError, place_count>& places,
                             const std::array<WorstCase, place_count>& worst) {
  std::vector<Bound> out;
  for (std::size_t p = 0; p < place_count; ++p) {
    if (p == edge_x_acc && !has_x_step(config)) continue;
    if (is_projected(p) && !has_project(config.project)) continue;
    if (is_lit(p) && (!has_light(config.light) || !unbounded_light(config).empty())) continue;
    const PlaceName& name = place_names[p];
    Bound b{name.place,
            name.stage,
            name.quantity,
            name.unit,
            places[p].bound(),
            places[p].resolution,
            dominant_of(places[p]),
            places[p].used ? why_of(p, config, worst[p])
            : is_lit(p)    ? "never computed: no pixel's centre is covered, or there is no light"
                           : "never computed: no pixel's centre is covered",
            {}};
    for (const auto& term : places[p].error.terms())
      b.terms.push_back({std::string(term.first), term.second});
    out.push_back(std::move(b));
  }
  return out;
}

}  // namespace bitspan::bounds
