// The tables of the reciprocal units, docs/numeric-spec.md, "Reciprocal": what the model looks up, the RTL's
// ROM holds, and the bounds enumerate. golden/ has its own.
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"

namespace bitspan {

// Raw on table_bits fraction bits. lut_linear: c(0) .. c(2^index_bits); lut_newton: y(0) per j; restoring:
// none.
std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit);

}  // namespace bitspan
