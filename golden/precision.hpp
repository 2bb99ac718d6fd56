// How many significant bits every exact intermediate value of golden needs, and the floating-point type that
// each stage therefore computes in. From the configuration alone: every register may take any value of its
// format.
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
