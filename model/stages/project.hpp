// SPDX-License-Identifier: Apache-2.0
// project: where a fragment lies in the picture of a projector, and how far from it. docs/numeric-spec.md,
// "project" (T14, SH2).
#pragma once

#include <algorithm>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/channel.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/span.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct ProjectStage {
  ReciprocalUnit reciprocal;
  Register xyw, uv, ratio, far_h, z;  // far_h: h as the projector sees it
  bool is_complement = false;         // the code is zmax - h
  Exact zmax;
  InverseDepth q;        // of the view
  Exact a, projector_b;  // of the projector
  // Bits that products with m take beyond the other factor, on every grid on the way to s and t, and to
  // ratio; and those of h and z before they are narrowed, signs included.
  int place_growth = 0, ratio_growth = 0, h_bits = 0, z_bits = 0;
  int sum_bits = 0;  // of h + B
  // 128 bits do; past that a fragment at a time.
  bool fits_lanes() const {
    return std::max({xyw.word + place_growth, sum_bits + ratio_growth, h_bits, z_bits}) <= 125;
  }
  // The grid of A_p ratio - B_p, and by how much the product is shifted onto it.
  int h_grid() const { return std::max(a.fraction + ratio.fraction, projector_b.fraction); }
  int product_up() const { return h_grid() - a.fraction - ratio.fraction; }
  int width = 0, height = 0;   // of its texture
  bool has_projector = false;  // of the view
  bool is_on = false;          // of the draw state
};
// Throws InputError where the projector's range does not fit the configuration. A view without a projector
// gives a stage that finds every fragment outside.
ProjectStage prepare_project(const Config& config, const Constants& constants, const Scene& scene);
// image: of the second texture unit, null where it is off.
void set_project(ProjectStage& stage, const DrawState& state, const Texture* image);

// A fragment that the second texture unit takes; channels: those of a view with a projector, else any.
template <class Watch = NoObserve>
void project(const ProjectStage& stage, const FragmentRecord& fragment, const FragmentChannels* channels,
             ProjectRecord& out, Watch watch = {});

}  // namespace bitspan::model
