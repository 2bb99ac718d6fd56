// SPDX-License-Identifier: Apache-2.0
#include "engine/rows.hpp"

#include <string>
#include <string_view>

#include "config/lines.hpp"
#include "config/modes.hpp"

namespace bitspan {

namespace {

[[noreturn]] void refuse_gradients(const std::string& setting, std::string_view legal) {
  throw InputError(setting +
                   " takes gradients of a whole triangle, and a row has none; legal: draw triangles, or " +
                   std::string(legal));
}

}  // namespace

void check_draws_rows(const Config& config, const AnyRow& row) {
  if (has_setup_plane(config) && std::holds_alternative<RowRecord>(row)) {
    throw InputError(
        "slope.row = plane starts a row from the plane of a triangle, and a row of edge_walk has none; "
        "legal: draw triangles or rows of span_setup, or slope.row divide, reciprocal");
  }
  if (ChannelList(config).size() > 0) {
    throw InputError(
        "the configuration has channels, which are interpolated over a triangle, and a row has none; "
        "legal: draw triangles, or a configuration without channels");
  }
  if (has_dz(config.depth_code)) {
    refuse_gradients("depth.code = " + std::string(to_string(config.depth_code)), "another depth.code");
  }
  if (has_lod_gradients(config)) {
    refuse_gradients("lod.mode = " + std::string(to_string(config.lod)), "lod.mode none, zone_s, zone_d");
  }
}

}  // namespace bitspan
