// SPDX-License-Identifier: Apache-2.0
// rotate: a vector turned by three products (B10).
#pragma once

#include <cstdint>
#include <vector>

#include "config/rotate.hpp"
#include "model/numeric/register.hpp"

namespace bitspan::model {

struct RotateStage {
  int turn = 8;
  Register t, s, xy;
  std::vector<std::int64_t> tangents, sines;  // for 0 to turn / 8 steps
};
// Throws InputError as check_rotate.
RotateStage prepare_rotate(const RotateFormats& formats, int turn);

// What the three products take for an angle, |angle| <= turn / 2.
struct RotateOperands {
  int quarter = 0;       // -2..2
  bool is_first = true;  // the quarters stand in front of the products
  std::int64_t t = 0, s = 0;
};
RotateOperands rotate_operands(const RotateStage& stage, int angle);

PlaneVector rotate(const RotateStage& stage, PlaneVector vector, const RotateOperands& by);
inline PlaneVector rotate(const RotateStage& stage, PlaneVector vector, int angle) {
  return rotate(stage, vector, rotate_operands(stage, angle));
}

}  // namespace bitspan::model
