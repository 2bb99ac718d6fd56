// depth: the fragment's depth code and its test against the buffer. docs/numeric-spec.md, "depth" (D1, H6).
#pragma once

#include <cstdint>

#include "config/config.hpp"
#include "config/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/span.hpp"

namespace bitspan::model {

struct DepthStage {
  DepthCode code = DepthCode::inverse;
  std::int64_t zmax = 0;
  std::int64_t clear = 0;  // what the buffer holds before the first triangle
  Register h, z;
  InverseDepth q;
  ReciprocalUnit reciprocal;  // R_pixel
  Exact c1, c0;
};
DepthStage prepare_depth(const Config& config, const Constants& constants);

// A covered fragment against the buffer's code at its pixel. True where it passes (out.pass).
template <class Watch = NoObserve>
bool depth(const DepthStage& stage, const FragmentRecord& fragment, std::int64_t stored, DepthRecord& out,
           Watch watch = {});

}  // namespace bitspan::model
