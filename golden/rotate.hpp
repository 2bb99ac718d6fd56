// SPDX-License-Identifier: Apache-2.0
// Stage `rotate`: a vector turned by three products. [B10]
#pragma once

#include <vector>

#include "config/rotate.hpp"

namespace bitspan::golden {

class Rotation {
 public:
  // Throws InputError as check_rotate.
  Rotation(const RotateFormats& formats, int turn);

  // |angle| <= turn / 2.
  PlaneVector operator()(PlaneVector vector, int angle) const;

  // Raw values of rotate.t and rotate.s for 0 to turn / 8 steps.
  const std::vector<std::int64_t>& tangents() const { return tangents_; }
  const std::vector<std::int64_t>& sines() const { return sines_; }

 private:
  RotateFormats formats_;
  int turn_;
  std::vector<std::int64_t> tangents_, sines_;
};

}  // namespace bitspan::golden
