// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/interpolator_case.hpp"

#include <algorithm>

namespace bitspan {

InterpolatorCase make_interpolator_case(Random& random, const Config& c, int records, int longest) {
  InterpolatorCase made;
  const std::int64_t b = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_b)));
  const std::int64_t k = random_k(random, c);
  const auto add = [&](const RtlInputs& in, const SpanRecord& span,
                       const std::vector<SpanChannelRecord>& channels) {
    made.inputs.push_back(in);
    made.spans.push_back(span);
    const std::vector<reference::Pixel> pixels = reference::span(c, span, k, b);
    made.pixels.insert(made.pixels.end(), pixels.begin(), pixels.end());
    made.span_channels.insert(made.span_channels.end(), channels.begin(), channels.end());
    std::vector<std::vector<FragmentChannelRecord>> values;
    for (const SpanChannelRecord& channel : channels) values.push_back(reference::span(c, channel, pixels));
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      for (const auto& channel : values) made.pixel_channels.push_back(channel[i]);
    }
  };
  if (c.perspective != Perspective::const_depth_rows) {
    for (const RowRecord& row : random_rows(random, c, records, longest)) {
      const std::vector<RowChannelRecord> ends = random_ends(random, c);
      const SpanRecord span = reference::span_setup(c, row, b);
      std::vector<SpanChannelRecord> channels;
      for (const RowChannelRecord& end : ends) channels.push_back(reference::span_setup(c, row, span, end));
      add(rtl_inputs(c, row, b, ends), span, channels);
    }
  } else {
    for (const PlaneRowRecord& row : random_plane_rows(random, c, records, longest)) {
      std::vector<SpanChannelRecord> starts = random_starts(random, c);
      for (SpanChannelRecord& start : starts) start.x = row.major_first;
      add(rtl_inputs(c, row, k, b, starts), reference::span_setup(c, row, b), starts);
    }
  }
  return made;
}

}  // namespace bitspan
