// The tables of the reciprocal units, docs/numeric-spec.md, "Reciprocal", as the RTL's ROM holds them and the
// bounds enumerate them. model/ and golden/ each compute their own.
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"

namespace bitspan {

// Raw on table_bits fraction bits. lut_linear: c(0) .. c(2^index_bits); lut_newton: y(0) per j; restoring:
// none.
std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit);

}  // namespace bitspan
