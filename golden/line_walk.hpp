// SPDX-License-Identifier: Apache-2.0
// Stage `line_walk`: makes the digital line between a line's ends. [B1, B2]
#pragma once

#include <functional>
#include <optional>

#include "config/config.hpp"
#include "engine/records.hpp"

namespace bitspan::golden {

// Takes a line's setup record; none where no pixel lies inside the picture. Throws InputError where line.walk
// = none.
using LineWalkStage = std::function<std::optional<LineWalkRecord>(const SetupRecord&)>;
LineWalkStage make_line_walk(const Config& config, int width, int height);

// Minor coordinate of pixel i of a record's digital line, counted from its first.
std::int64_t minor_at(const LineWalkRecord& line, std::int64_t i);

// The line as a row of edge_walk along its major coordinate.
RowRecord row_of(const LineWalkRecord& line);

}  // namespace bitspan::golden
