// SPDX-License-Identifier: Apache-2.0
// Proves upper bounds for the error of h, 1/(h + B), u, v and a light's brightness against the unquantised
// truth ("ideal" of docs/numeric-spec.md). It needs a configuration and the ranges of the input alone.
// docs/bounds.md has the argument of each place.
//
// Every number is computed in intervals with outward rounding (study/bounds/interval.hpp). The formulas are
// their own: they use no arithmetic of model/ or golden/.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"
#include "study/bounds/input_range.hpp"
#include "study/bounds/interval.hpp"
#include "study/point.hpp"

namespace bitspan {

struct BoundTerm {
  std::string source;  // the quantisation: a format's key, a reciprocal unit, a start offset
  Interval error;      // what it adds, in the unit of the bound
};

struct Bound {
  std::string place;      // the register: "span.uv"; or "reciprocal.pixel (span)"
  std::string stage;      // as in FieldError: "span", "edge_walk" ...
  std::string quantity;   // "h", "1/(h+B)", "u", "v", "fu", "fv", "x", "z"
  std::string unit;       // 1/(h+B): "relative"
  double bound = 0;       // |register - truth| <= bound; infinite where nothing finite holds
  double resolution = 0;  // how exactly `ideal` itself is computed; an observed error may be above by this
  std::string dominant;   // the largest term and its share
  std::string why;        // the argument in words, with the worst legal case
  std::vector<BoundTerm> terms;
};

// Throws InputError where a range is empty or not finite, or where no bound is known for a mode; it then
// names the key. Only perspective.mode = delta_f with depth.code = inverse or opengl has a bound. The places
// and their order are those of the configuration, whatever the range.
std::vector<Bound> error_bounds(const Config& config, const InputRange& range);
// Returns, for each place, the largest of the bounds of a scene's triangles. It is narrower than error_bounds
// of the scene's hull, because a triangle that is large or steep or far is seldom all of them.
std::vector<Bound> error_bounds(const Config& config, const Scene& scene);
// Returns, for each triangle of a scene, how many codes the stored depth of its pixels in the picture may be
// off from the exact h, or from its complement where the code is that; the narrowing to whole codes is part
// of it. 0 where the triangle covers no centre. Throws as error_bounds does.
std::vector<double> stored_depth_bounds(const Config& config, const Scene& scene);
// Says which key of light has no bound, and which values have one; empty where light has a bound, or is not
// there. error_bounds then leaves light out.
std::string unbounded_light(const Config& config);
// Throws as error_bounds does.
void check_bounded(const Config& config, const Scene& scene);
// Whether error_bounds has an answer for the modes.
bool has_bounds(const Config& config);

// Returns the error of an edge's x at a row's centre in pixels, by which a dda's coverage may be off.
std::function<double(const InputRange&)> edge_position_error(const Config& config);

struct BoundCheck {
  std::string place, stage, quantity, unit;
  double bound = 0, observed = 0;
  double ratio = 0;  // observed / bound; 0 where both are 0
  bool holds = false;
};

// Pairs each observed maximum with the last place of its stage and quantity. Observed errors without a bound
// are left out.
std::vector<BoundCheck> check_bounds(std::span<const Bound> bounds, std::span<const FieldError> observed);
bool all_hold(std::span<const BoundCheck> checks);

// What the bounds of edge_walk or of span are made of, for study/bounds/gappa.hpp. The stage accumulates h
// and f along a line from one end to another, and divides u out.
struct StageHypotheses {
  int additions = 0;                   // at most
  double distance = 0;                 // walked, at most, pixels
  double shortest = 0, longest = 0;    // of the line
  Interval slope_error;                // relative, of the reciprocal in front of a slope; 0 where it divides
  Interval h_change;                   // far end's h minus near end's
  Interval h_carried;                  // error of the line through the ends, and of what follows the register
  Interval h_walk;                     // error that the registers of h add to that line
  Interval q;                          // h + B on the line
  Interval q_register;                 // and of the registers
  Interval pixel_error;                // relative, of reciprocal.pixel
  std::array<Interval, 2> uv_change;   // far end's u, v minus near end's
  std::array<Interval, 2> uv_carried;  // error of the surface through the ends
  std::array<Interval, 2> f_change;    // (u2 - u1) q2
  std::array<Interval, 2> f_walk;      // error that the registers of f add to its line
  double h_offset = 0, f_offset = 0;   // start offsets
  // True where nothing saturates or wraps on the way, and the ends may differ enough for a slope to be
  // rounded by its half ulp. Elsewhere the bounds are not the sums of the above.
  bool adds_up = true;
};
struct Hypotheses {
  StageHypotheses edge, span;
};
// Throws as error_bounds does.
Hypotheses bound_hypotheses(const Config& config, const InputRange& range);

}  // namespace bitspan
