// SPDX-License-Identifier: Apache-2.0
// Finds the errors of all registers for one range of the input, stage by stage: constants.cpp, setup.cpp,
// edge_walk.cpp, span.cpp. docs/bounds.md has the argument of each place.
#pragma once

#include <array>
#include <memory>
#include <string_view>

#include "config/config.hpp"
#include "golden/ideal_point.hpp"
#include "study/bounds/bounds.hpp"
#include "study/bounds/error_sum.hpp"
#include "study/bounds/input_range.hpp"
#include "study/bounds/interval.hpp"
#include "study/bounds/light_error.hpp"
#include "study/bounds/places.hpp"
#include "study/bounds/unit_error.hpp"
#include "study/bounds/walk.hpp"

namespace bitspan::bounds {

// What of a triangle the bounds of light at one of its pixels are made of.
struct CarriedLight {
  bool per_pixel = false;
  std::array<ErrorSum, 3> normal;  // of the channels nx, ny, nz
  double largest = 0;              // of the vertices' normals
  int exponent = 0;                // E
  Interval q_times_s;              // of the scaled surface, s in the scene's unit
  Interval h;                      // error of h, without that of setup.s
  Interval vertex_s;               // s / s' - 1 of the vertices
  Interval by_constants;           // A' and the reciprocal unit's error, over the exact A
  bool s_any = false;              // s may be anything that its register holds
  Interval brightness;             // per vertex: of the vertices, exactly
};

struct PlaceErrors {
  std::array<PlaceError, place_count> places;
  WorstCase worst;
  Hypotheses hypotheses;
  std::shared_ptr<const LightError> light_unit;  // of a triangle under a light
  CarriedLight light;
};

// Returns the errors at the centre of a pixel, where light is per pixel.
LightErrors light_at(const Config& config, const PlaceErrors& triangle, const IdealPoint& centre);
// Raises the bounds of light's places to those of one point.
void raise_light(const LightError& unit, const LightErrors& e, std::array<PlaceError, place_count>& places);

// The range and gradient of u or v on its way.
struct Coordinate {
  Interval range;
  double gradient;
};

// B of a view's or of a projector's range, and what its roundings do.
struct DepthRange {
  int exponent = 0;     // E
  double s_near = 0;    // s_min'
  Interval b, ideal_b;  // as the register may hold it, and exactly
  Interval far;         // s_max', in units of 2^E
  Interval far_scale;   // s_max' over the exact one
};

// Along an edge, or along a row.
struct Way {
  Slopes slopes;
  int position_grid = 0;  // fraction bits of what has been walked
  double distance = 0;    // walked, at most, pixels
  int additions = 0;      // at most
};

class ErrorAnalysis {
 public:
  explicit ErrorAnalysis(const Config& config)
      : c_(config),
        pixel_(config.pixel_reciprocal),
        row_(config.row_reciprocal),
        edge_(config.edge_reciprocal) {}
  PlaceErrors run(const InputRange& in);

 private:
  const Format& format(FormatId id) const { return c_.format(id); }
  static double offset(const StartOffset& o, const Format& kept);
  PlaceError& place(Place p);
  // `truth` is the range of what the register is compared with, and `id` is its format. Neither leaves its
  // range.
  void deliver(Place p, ErrorSum e, FormatId id, Interval truth);
  void deliver(Place p, ErrorSum e, double largest, bool unbounded = false);
  // Throws InputError where the formats are too narrow or too coarse for the range.
  DepthRange depth_range(double s_min, double s_max) const;
  // Finds B and scale_. scale_ is q, as the registers would hold it without further rounding, divided by
  // ideal's h + B.
  void constants();
  // Returns what the rounding of B and s_max' does to the surface's h, on the triangle and `beyond` outside
  // its h. It is linear in h, so the ends bound what is between.
  Interval drift_over(double beyond) const;
  // Finds the steepest surface of the range, in codes and texels per pixel.
  void gradients();
  // Errors of h up to the last step are against B' / B times ideal's h + B, minus B'. The rounding of B then
  // shifts the whole surface, and not u and v. with_drift adds that shift.
  ErrorSum with_drift(ErrorSum e) const;
  void setup();
  // Returns the relative error of the registers' q against the truth at the same place. `e` is the error of
  // h.
  Interval relative_error(const ErrorSum& e) const;
  // Returns by how much the weight w of the far end is off where the two ends' q err by `relative`. The odds
  // w / (1 - w) change by a factor e^d, and w by at most tanh(d / 4) <= d / 4 <= (e^d - 1) / 4.
  static double weight_error(Interval relative);
  // Has q / q' and 1 / q' for q' = q + walk, where q is on the line through registers, and walk is what the
  // accumulator adds. `range` is that of h: the lowest that it is held at, and the lowest that it may be
  // stopped at from above.
  struct Divided {
    Interval ratio, inverse, operand;
    bool none = false;  // q' may be 0
  };
  Divided divided(Interval q, const WalkError& walk, const ErrorSum& total, Interval range) const;
  // The quotient u1 + f (m 2^-e). f stands for change w q on the way.
  struct Quotient {
    std::string_view h_name, slope_unit;
    double change;  // |u2 - u1| of the registers
    const WalkError& f;
    const ErrorSum& f_error;  // of f, without the slope's relative error and what saturation loses
    const Divided& q;
    const UnitError& unit;
  };
  // Adds to e what the division and f add. Returns false where nothing finite holds.
  static bool add_quotient(ErrorSum& e, const Quotient& d);
  // Compares 1 / (h + B), as the unit gives it, with ideal's. `h` is the error of h on the scaled surface, at
  // a point that is `moved` in h away from where the truth is taken.
  void reciprocal_place(Place p, const ErrorSum& h, double moved, const Divided& d, const UnitError& unit,
                        std::string_view h_name);
  void edge();
  static Interval positive(Interval q);
  // Ends e. Where nothing finite is known before the register, the range of the register is the error.
  static void finish_quotient(ErrorSum& e, bool finite, const Format& f, Interval truth);
  void edge_position(int t_grid, double distance, int additions, const Slopes& slopes);
  // Returns the error of a walk along a line whose ends are `change` apart.
  ErrorSum line_error(const WalkError& w, double change, std::string_view unit);
  // Returns x clamped to the range of the format, because a register has no other values.
  Interval within(Interval x, FormatId id) const;
  // Does settle() for the accumulator of a walk.
  bool overflow(ErrorSum& e, const WalkError& w, FormatId acc, Interval truth, int times) const;
  // Returns the error of f's register against (1 + slope error) (the way made of the change): its own
  // roundings and that of the difference it starts from.
  ErrorSum f_walk_error(FormatId diff, FormatId acc, WalkError& w, double change, int additions, int grid);
  // Compares f's register with (u - u1) (h + B) of ideal. `position` is what the centre's distance from the
  // row's point adds.
  void f_place(Place p, const WalkError& w, const ErrorSum& f_error, double change, const ErrorSum& ends_uv,
               Interval ends_q, Interval uv, double position, std::string_view unit);
  void span();
  void span_coordinate(std::size_t i, const Slopes& slopes, const Divided& q, const UnitError& unit,
                       Interval ends, Interval line_q, double distance, int additions, int p_grid,
                       double away, double wide, Interval centre_q);
  // `beyond` is how far outside 0..hmax the truth may be.
  void depth_places(const ErrorSum& h, double beyond);
  // Returns the error of the stored code from that of h in the register `from`. truth: of h.
  ErrorSum stored_code(const ErrorSum& h, FormatId from, Interval truth) const;
  // A line of the projector: X, Y or W times h + B.
  struct ProjectedLine {
    Interval exact;       // of the surface
    double gradient = 0;  // of that, per pixel of a row
    Interval line;        // between the vertices, as their registers of h weigh it
    ErrorSum error;       // what the line's own registers add at a pixel
  };
  // j: X, Y or W. exponent: of the projector. ends: relative error of q at the vertices.
  ProjectedLine projected_line(std::size_t j, const ProjectedRange& p, int exponent, Interval ends);
  void project();
  // A linear channel: the vertices' registers, and the walks between them.
  struct LinearLine {
    FormatId vertex, step, acc, value;
    Interval exact;      // of the vertices
    ErrorSum at_vertex;  // of their registers
    double change;       // between registers; 0 where they are equal
    double gradient;     // of the exact value, per pixel of a row
  };
  ErrorSum linear_line(const LinearLine& line);
  void light();
  void pixel_light(const LitTriangle& t);
  void vertex_light(const LitTriangle& t);
  Config c_;
  Unit pixel_, row_, edge_;
  InputRange in_;
  PlaceErrors out_;
  double hmax_ = 0;
  DepthRange view_;
  Interval scale_, ideal_q_, q_, h_, drift_, s_error_;
  double h_gradient_ = 0;
  bool x_any_ = false;
  Way edge_way_, row_way_;
  double row_width_ = 0;  // of a covered row, at most, pixels
  std::array<Coordinate, 2> uv_{};
  ErrorSum vertex_h_, edge_h_, position_;
  ErrorSum centre_h_;          // of h in span at a pixel's centre, against the scaled surface
  UnitError pixel_unit_;       // of the reciprocal unit there
  bool pixel_divides_ = true;  // h + B is above 0 there
  std::shared_ptr<const LightError> light_unit_;  // of the last view
  ErrorSum walked_h_;  // of h in span, against the line through the vertices' registers
  std::array<ErrorSum, 2> vertex_uv_, edge_uv_;
};

}  // namespace bitspan::bounds
