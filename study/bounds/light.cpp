// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "config/modes.hpp"
#include "study/bounds/error_analysis.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {

using F = FormatId;

namespace {

// The error of a register that takes x.
Interval taken(double x, const Format& f) {
  if (!saturates(f) && !(Interval(x) + rounding(f)).inside(values(f))) return values(f) - x;
  return Interval(quantised(x, f)) - x;
}

// How much a value with these at the corners changes per pixel to the right.
double gradient_of(const LitTriangle& t, const std::array<Interval, 3>& corners) {
  return (t.weight[1] * (corners[1] - corners[0]) + t.weight[2] * (corners[2] - corners[0])).mag();
}

// Replaces what is held at a place where the new error is larger.
void raise(PlaceError& at, const ErrorSum& e, double resolution) {
  if (!at.used || e.total().mag() > at.error.total().mag()) at.error = e;
  at.used = true;
  at.resolution = std::max(at.resolution, resolution);
}

}  // namespace

void raise_light(const LightError& unit, const LightErrors& e, std::array<PlaceError, place_count>& places) {
  for (std::size_t i = 0; i < 3; ++i) {
    raise(places[light_normal], e.normal[i], e.vector_resolution);
    raise(places[light_direction], e.direction[i], e.vector_resolution);
  }
  raise(places[light_cosine], e.cosine, e.cosine_resolution);
  raise(places[light_mirrored], e.mirrored, 3 * e.cosine_resolution);
  raise(places[light_specular], e.specular, e.specular_resolution);
  raise(places[light_value], e.value, e.value_resolution);
  raise(places[light_color], unit.color(e, Interval(0, 255)), 255 * e.value_resolution);
  places[light_value].unbounded = places[light_value].unbounded || e.value_unbounded;
  places[light_color].unbounded = places[light_value].unbounded;
}

LightErrors light_at(const Config& config, const PlaceErrors& triangle, const IdealPoint& centre) {
  const CarriedLight& l = triangle.light;
  const LitView& view = triangle.light_unit->view();
  LitPoint p;
  const std::array normal{centre.given.nx, centre.given.ny, centre.given.nz};
  for (std::size_t i = 0; i < 3; ++i) {
    p.normal[i] = normal[i];
    p.normal_error[i] = l.normal[i].total();
  }
  p.largest = l.largest;
  p.x = centre.x - view.width / 2.0;
  p.y = centre.y - view.height / 2.0;
  p.s = std::ldexp(centre.s, -l.exponent);
  const Format& f = config.format(F::distance_s);
  const Interval off = l.h / (l.q_times_s / centre.s) + l.vertex_s;  // of h + B, relative
  if (l.s_any || !(centre.s > 0) || !(off.lo > -1)) {
    p.s_error = values(f) - p.s;
  } else {
    ErrorSum e;
    e.add("distance.s", p.s * (l.by_constants / (1 + off) - 1) + rounding(f));
    settle(e, f, p.s);
    p.s_error = e.total();
  }
  return triangle.light_unit->at(p);
}

ErrorSum ErrorAnalysis::linear_line(const LinearLine& line) {
  const Format& vertex = format(line.vertex);
  const Format& acc = format(line.acc);
  const Format& value = format(line.value);
  ErrorSum e = line.at_vertex;
  // Equal ends have slopes of 0, however they are formed.
  if (line.change == 0) {
    e.add(key_of(line.acc), rounding(acc, vertex.fraction()));
    // Where it saturates, its last value has all of its places.
    const bool fits = (line.exact + e.total()).inside(values(acc));
    settle(e, acc, line.exact);
    e.add(key_of(line.value),
          rounding(value, fits ? std::min(vertex.fraction(), acc.fraction()) : acc.fraction()));
    if (has_x_step(c_))
      e.add("edge.x", Interval::plus_minus((Interval(line.gradient) * position_.total().mag()).hi));
    settle(e, value, line.exact);
    return e;
  }
  const auto walk = [&](const Way& way, int start_grid, double change, double gradient, double slack,
                        std::string_view unit) {
    WalkError w = walk_error(c_,
                             {line.step, line.acc, start_grid, way.position_grid, "", 0, way.distance,
                              way.additions, change, gradient, slack},
                             way.slopes);
    w.any = w.any || (x_any_ && &way == &row_way_);
    e.add(line_error(w, change, unit));
    overflow(e, w, line.acc, line.exact, way.additions + 1);
  };
  walk(edge_way_, vertex.fraction(), line.change, std::numeric_limits<double>::infinity(), 0,
       "reciprocal.edge");
  const double end_width = e.total().width();
  const double chord = std::min(line.exact.width(), (Interval(line.gradient) * row_width_).hi);
  walk(row_way_, acc.fraction(), next_up(chord + end_width), line.gradient,
       (Interval(line.gradient) * position_.total().width() + end_width).hi, "reciprocal.row");
  double moved = (Interval(line.gradient) * position_.total().mag()).hi;
  if (!has_x_step(c_)) moved = std::min(moved, chord);
  e.add("edge.x", Interval::plus_minus(moved));
  e.add(key_of(line.value), rounding(value, acc.fraction()));
  settle(e, value, has_x_step(c_) ? line.exact + Interval::plus_minus(moved) : line.exact);
  return e;
}

void ErrorAnalysis::light() {
  if (!in_.lit) {
    for (std::size_t p = light_normal; p <= light_color; ++p) deliver(static_cast<Place>(p), {}, 1, true);
    return;
  }
  if (light_unit_ == nullptr || !(light_unit_->view() == in_.lit->view)) {
    light_unit_ = std::make_shared<const LightError>(c_, in_.lit->view);
  }
  out_.light_unit = light_unit_;
  if (lights_pixels(c_.light)) {
    pixel_light(*in_.lit);
  } else {
    vertex_light(*in_.lit);
  }
}

void ErrorAnalysis::pixel_light(const LitTriangle& t) {
  CarriedLight& out = out_.light;
  out.per_pixel = true;
  const Format& vertex = format(F::normal_vertex);
  for (std::size_t j = 0; j < 3; ++j) {
    std::array<Interval, 3> exact;
    Interval off;
    Interval held;
    for (std::size_t i = 0; i < 3; ++i) {
      exact[i] = t.v[i].normal[j];
      const Interval own = taken(t.v[i].normal[j], vertex);
      off = i == 0 ? own : hull(off, own);
      held = i == 0 ? exact[i] + own : hull(held, exact[i] + own);
      out.largest = std::max(out.largest, exact[i].mag());
    }
    LinearLine line{F::normal_vertex,
                    F::normal_step,
                    F::normal_acc,
                    F::normal_value,
                    hull(hull(exact[0], exact[1]), exact[2]),
                    {},
                    held.width(),
                    0};
    const auto quantised_at = [&](std::size_t i) { return quantised(t.v[i].normal[j], vertex); };
    if (quantised_at(0) == quantised_at(1) && quantised_at(0) == quantised_at(2) &&
        line.exact.inside(values(vertex))) {
      line.change = 0;
    }
    line.gradient = gradient_of(t, exact);
    line.at_vertex.add(key_of(F::normal_vertex), off);
    out.normal[j] = linear_line(line);
  }
  out.exponent = view_.exponent;
  out.q_times_s = scale_ * view_.ideal_b * in_.s_max;
  Interval rest = 0;
  bool has_s = false;
  for (const auto& term : centre_h_.terms()) {
    if (term.first == "setup.s") {
      has_s = true;
    } else {
      rest += term.second;
    }
  }
  out.h = rest;
  out.vertex_s = has_s ? s_error_ : Interval(0);
  const Format& a_format = format(F::distance_a);
  const Interval exact_a = view_.b * view_.far;
  const bool wraps = !saturates(a_format) && !(exact_a + rounding(a_format)).inside(values(a_format));
  out.s_any = !pixel_divides_ || pixel_unit_.any || wraps;
  if (!out.s_any) out.by_constants = quantised(exact_a, a_format) / exact_a * (1 + pixel_unit_.relative);
}

void ErrorAnalysis::vertex_light(const LitTriangle& t) {
  const Format& normal = format(F::normal_value);
  LinearLine line{F::light_vertex, F::light_step, F::light_acc, F::light_value, {}, {}, 0, 0};
  std::array<Interval, 3> exact;
  Interval off;
  double resolution = 0;
  bool unbounded = false;
  const bool face = lights_faces(c_.light);
  for (std::size_t i = 0; i < 3; ++i) {
    const LitTriangle::Corner& v = t.v[face ? t.first : i];
    LitPoint p;
    for (std::size_t j = 0; j < 3; ++j) {
      p.normal[j] = v.normal[j];
      p.normal_error[j] = taken(v.normal[j], normal);
      p.largest = std::max(p.largest, std::fabs(v.normal[j]));
    }
    p.x = Interval(v.x) - t.view.width / 2.0;
    p.y = Interval(v.y) - t.view.height / 2.0;
    const double s = std::ldexp(v.s, -view_.exponent);
    p.s = s;
    p.s_error = taken(s, format(F::setup_s));
    const LightErrors e = light_unit_->at(p);
    raise_light(*light_unit_, e, out_.places);
    resolution = std::max(resolution, e.value_resolution);
    unbounded = unbounded || e.value_unbounded;
    exact[i] = e.exact_value;
    ErrorSum own = e.value;
    own.add(key_of(F::light_vertex), rounding(format(F::light_vertex), format(F::light_value).fraction()));
    settle(own, format(F::light_vertex), exact[i]);
    if (i == 0 || own.total().mag() > line.at_vertex.total().mag()) line.at_vertex = own;
    off = i == 0 ? own.total() : hull(off, own.total());
  }
  // The terms are those of the worst vertex, and the rest belongs to the others.
  const Interval worst = line.at_vertex.total();
  line.at_vertex.add("other vertices", {std::min(0.0, next_down(off.lo - worst.lo)),
                                        std::max(0.0, next_up(off.hi - worst.hi))});
  line.exact = hull(hull(exact[0], exact[1]), exact[2]);
  line.change = face ? 0 : next_up(line.exact.width() + off.width());
  line.gradient = face ? 0 : gradient_of(t, exact);
  out_.light.brightness = line.exact;
  const ErrorSum value = linear_line(line);
  LightErrors at_pixel;
  at_pixel.value = value;
  at_pixel.exact_value = line.exact;
  deliver(light_value, value, 0, unbounded);
  deliver(light_color, light_unit_->color(at_pixel, Interval(0, 255)), 0, unbounded);
  place(light_value).resolution = resolution;
  place(light_color).resolution = 255 * resolution;
}

}  // namespace bitspan::bounds
