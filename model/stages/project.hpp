// SPDX-License-Identifier: Apache-2.0
// project: where a fragment lies in the picture of a projector, and how far from it. docs/numeric-spec.md,
// "project" (T14, SH2).
#pragma once

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/channel.hpp"
#include "model/stages/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct ProjectStage {
  ReciprocalUnit reciprocal;
  Register xyw, h, uv, ratio, far_h, z;  // far_h: h as the projector sees it
  bool is_complement = false;            // the code is zmax - h
  Exact zmax;
  Exact b;                     // of the view
  Exact a, projector_b;        // of the projector
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
