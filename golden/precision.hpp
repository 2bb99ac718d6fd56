// How many significant bits every exact intermediate value of golden needs, and the floating-point type that
// each stage therefore computes in. From the configuration alone: every register may take any value of its
// format.
//
// Two counts decide. `bits` is what the exact value needs; 113 of them, quadruple precision, are legal.
// `held` is what one number of the stage's type must hold for it: as much, where the stage writes the value
// with plain sums and products; the bits of the wider factor, where products and their sums are carried as
// pairs of numbers whose rounding errors are checked, and taken anew in quadruple precision where a pair
// loses one (golden/quantize.hpp). So a stage's type is the narrowest with every `held`, and no value is ever
// rounded in front of its Q.
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
  Width edge_setup = Width::quad;  // modes with horizontal rows
  Width edge_walk = Width::quad;   // modes with horizontal rows
  Width plane_walk = Width::quad;  // const_depth_rows
  Width span_setup = Width::quad;
  Width span = Width::quad;
  Width depth = Width::quad;
  Width texture = Width::quad;
  Width fog = Width::quad;
  Width merge = Width::quad;
};

// Throws InputError naming stage and expression where 113 bits do not do.
Precision choose_precision(const Config& config);

}  // namespace bitspan::golden
