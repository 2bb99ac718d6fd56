// SPDX-License-Identifier: Apache-2.0
// Proves how far the registers of the unit `light` are from the unquantised truth, at one point of a surface.
#pragma once

#include <array>
#include <string_view>

#include "config/config.hpp"
#include "scene/view.hpp"
#include "study/bounds/error_sum.hpp"
#include "study/bounds/interval.hpp"
#include "study/bounds/unit_error.hpp"

namespace bitspan::bounds {

using Vector = std::array<Interval, 3>;

// What light takes of a view.
struct LitView {
  Light light;
  int width = 0, height = 0;
  double focal = 0, s_max = 0;
  bool operator==(const LitView&) const = default;
};

// What is known of a surface where its brightness is formed. An error is the register's value minus the exact
// one.
struct LitPoint {
  Vector normal;        // exactly
  Vector normal_error;  // of the registers that light takes
  double largest = 0;   // of the normal's parts and of those that it is a mean of
  Interval x, y;        // pixels from the picture's middle
  Interval s, s_error;  // in units of 2^E
};

struct LightErrors {
  std::array<ErrorSum, 3> normal, direction;
  ErrorSum cosine, mirrored, specular, value;
  Interval exact_cosine, exact_value;
  bool value_unbounded = false;
  // How exactly `ideal` computes them: the vectors, the cosines, the highlight and the brightness.
  double vector_resolution = 0, cosine_resolution = 0, specular_resolution = 0, value_resolution = 0;
};

class LightError {
 public:
  LightError(const Config& config, const LitView& view);
  const LitView& view() const { return view_; }
  LightErrors at(const LitPoint& point) const;
  // Returns what the unit adds to a colour by its product with the brightness; color: the one in front of it.
  ErrorSum color(const LightErrors& errors, Interval color) const;

 private:
  // The registers hold (1 + scale) u' plus the rounding, where u' has length 1, or is 0, and u is exact.
  struct Unit {
    Vector exact;     // u
    double turn = 0;  // |u' - u| at most
    Vector near;      // u'
    Interval scale = 1;
    Interval rounding = 0;          // per part
    std::array<ErrorSum, 3> error;  // of each part
    bool is_none = false;           // u and the registers are 0
    bool overflows = false;         // a part may; then `error` alone holds
    std::string_view source;
    Interval length;  // of what it is the direction of, exactly
  };
  Unit unit_of(const Vector& exact, const Vector& error, FormatId to, std::string_view source) const;
  ErrorSum dot(const Unit& normal, const Unit& direction, Interval exact) const;
  // x -> x^exponent as the table has it, of an exact and of a register's cosine that is not below 0.
  ErrorSum power(Interval exact, Interval held, double resolution) const;
  // Returns the error of 1 / t, relative to 1 / the register's t.
  Interval inverse_error() const;
  ErrorSum lunar(const ErrorSum& scattered, Interval exact, const Unit& normal) const;
  struct Fall {
    Interval exact = 1;
    ErrorSum error;
    bool none = false;  // nothing finite holds
  };
  Fall fall(const Vector& exact, const Vector& error, const Unit& unit) const;
  const Format& format(FormatId id) const { return c_.format(id); }
  // The register of a constant.
  Interval held(Interval exact, FormatId id) const;

  Config c_;
  LitView view_;
  UnitError root_;
  int exponent_ = 0;  // E
  bool falls_ = false;
  Vector place_, place_error_;    // of the light; of its direction where it is far away
  Interval scale_, exact_scale_;  // 1 / F
  Interval per_reach_, exact_per_reach_;
  Interval ambient_, highlight_, diffuse_, exact_diffuse_;
  Unit far_;
};

}  // namespace bitspan::bounds
