// SPDX-License-Identifier: Apache-2.0
// rotate of docs/numeric-spec.md: its registers, and how an angle is taken apart.
#pragma once

#include <cstdint>

#include "config/config.hpp"

namespace bitspan {

struct RotateFormats {
  Format t, s, xy;  // rotate.t, rotate.s, rotate.xy
};
RotateFormats rotate_formats(const Config& config);

// A vector, raw values of rotate.xy.
struct PlaneVector {
  std::int64_t x = 0, y = 0;
  bool operator==(const PlaneVector&) const = default;
};

// Angles are whole numbers of steps, `turn` of them in a full turn: a multiple of 8, 8..65536.
inline constexpr int turn_limit = 65536;

// quarter * turn / 4 + rest; the rest is at most turn / 8 either way, of the angle's sign where both are as
// near. Those of -angle are the negatives.
struct AngleParts {
  int quarter = 0;  // -2..2
  int rest = 0;
};
// |angle| <= turn / 2.
constexpr AngleParts angle_parts(int angle, int turn) {
  const int size = angle < 0 ? -angle : angle;
  const int quarters = (8 * size + turn - 1) / (2 * turn);  // ceil(size / (turn / 4) - 1/2)
  const int rest = size - quarters * (turn / 4);
  return angle < 0 ? AngleParts{-quarters, -rest} : AngleParts{quarters, rest};
}

// Throws InputError where the turn is not legal, or a product may be wider than the views hold.
void check_rotate(const RotateFormats& formats, int turn);

// How far each coordinate of a turned vector of at most that length is from the truth at most, in
// coordinates, where nothing overflows.
double rotate_error_bound(const RotateFormats& formats, double length);

}  // namespace bitspan
