// SPDX-License-Identifier: Apache-2.0
#include "engine/rows.hpp"

#include <string>

#include "config/modes.hpp"

namespace bitspan {

void check_draws_rows(const Config& config, const AnyRow& row) {
  if (has_setup_plane(config) && std::holds_alternative<RowRecord>(row)) {
    throw InputError(
        "slope.row = plane starts a row from the plane of a triangle, and a row of edge_walk has none; "
        "legal: draw triangles or rows of span_setup, or slope.row divide, reciprocal");
  }
  if (has_dz(config.depth_code)) {
    throw InputError("depth.code = " + std::string(to_string(config.depth_code)) +
                     " takes gradients of a whole triangle, and a row has none; "
                     "legal: draw triangles, or another depth.code");
  }
  if (!has_lod_gradients(config)) return;
  throw InputError("lod.mode = " + std::string(to_string(config.lod)) +
                   " takes gradients of a whole triangle, and a row has none; "
                   "legal: draw triangles, or lod.mode none, zone_s, zone_d");
}

}  // namespace bitspan
