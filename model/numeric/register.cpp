// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/register.hpp"

namespace bitspan::model {

std::string_view name_of(RegisterId id) {
  switch (id) {
    case RegisterId::coordinate:
      return "coordinate";
    case RegisterId::depth_z:
      return "depth.z";
    case RegisterId::edge_reciprocal:
      return "reciprocal.edge.output";
    case RegisterId::row_reciprocal:
      return "reciprocal.row.output";
    case RegisterId::pixel_reciprocal:
      return "reciprocal.pixel.output";
    default:
      return key_of(static_cast<FormatId>(id));
  }
}

}  // namespace bitspan::model
