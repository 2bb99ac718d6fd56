// SPDX-License-Identifier: Apache-2.0
// How many significant bits every exact intermediate value of golden needs, and the floating-point type that
// each stage therefore computes in. Both follow from the configuration alone: every register may take any
// value of its format.
//
// Two counts decide. `bits` is what the exact value needs; at most 113, which quadruple precision has, are
// legal. `held` is what one number of the stage's type must hold of it. Where the stage writes the value with
// plain sums and products, `held` is as much as `bits`. Where products and their sums are carried as pairs of
// numbers, it is the bits of the wider factor: the rounding errors of a pair are checked, and a pair that
// loses a bit is taken anew in quadruple precision (golden/quantize.hpp). So a stage's type is the narrowest
// with every `held`, and no value is ever rounded in front of its Q.
#pragma once

#include <string>
#include <vector>

#include "config/config.hpp"
#include "golden/arithmetic.hpp"

namespace bitspan::golden {

// One intermediate value (or one group of the same shape) of one stage.
struct PrecisionRow {
  std::string stage;          // as in docs/numeric-spec.md
  std::string expression;     // what is held exactly
  int bits = 0;               // significant bits it needs, at most
  int held = 0;               // of them, in one number of the stage's type
  Width width = Width::quad;  // what its stage computes in
};

struct Precision {
  std::vector<PrecisionRow> rows;
  Width setup = Width::quad;
  Width edge_setup = Width::quad;   // modes with horizontal rows
  Width setup_plane = Width::quad;  // slope.row = plane
  Width edge_walk = Width::quad;    // modes with horizontal rows
  Width plane_walk = Width::quad;   // const_depth_rows
  Width span_setup = Width::quad;
  Width span = Width::quad;
  Width depth = Width::quad;
  Width gradient = Width::quad;  // where lod takes gradients
  Width distance = Width::quad;  // where lod or fog takes it
  Width lod = Width::quad;       // where textures have mip chains
  Width texture = Width::quad;
  Width project = Width::quad;  // where the second unit takes a projector's coordinates
  Width light = Width::quad;    // where a view has a light
  Width texture_second = Width::quad;
  Width fog = Width::quad;
  Width merge = Width::quad;
};

// Throws InputError that names stage and expression where 113 bits are not enough.
Precision choose_precision(const Config& config);

}  // namespace bitspan::golden
