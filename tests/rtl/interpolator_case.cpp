// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/interpolator_case.hpp"

#include <algorithm>

namespace bitspan {

InterpolatorCase make_interpolator_case(Random& random, const Config& c, int records, int longest) {
  InterpolatorCase made;
  const std::int64_t b = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_b)));
  const std::int64_t k = random_k(random, c);
  const auto add = [&](const auto& row, const RtlInputs& in) {
    made.inputs.push_back(in);
    made.spans.push_back(reference::span_setup(c, row, b));
    for (const reference::Pixel& p : reference::span(c, made.spans.back(), k, b)) made.pixels.push_back(p);
  };
  if (c.perspective != Perspective::const_depth_rows) {
    for (const RowRecord& row : random_rows(random, c, records, longest)) add(row, rtl_inputs(c, row, b));
  } else {
    for (const PlaneRowRecord& row : random_plane_rows(random, c, records, longest))
      add(row, rtl_inputs(c, row, k, b));
  }
  return made;
}

}  // namespace bitspan
