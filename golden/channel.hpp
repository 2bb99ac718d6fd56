// SPDX-License-Identifier: Apache-2.0
// The channels of a scene: which of them are in use, and what each is at a vertex. docs/numeric-spec.md,
// "Channels".
#pragma once

#include <cstddef>
#include <vector>

#include "config/lines.hpp"
#include "golden/constants.hpp"
#include "golden/quantize.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

std::vector<LineId> channels_in_use(const Config& config, const Scene& scene);
// Where a channel stands among those in use; behind them where it is not in use.
std::ptrdiff_t place_of(const Constants& constants, LineId channel);

// Returns Q of the value at a vertex as a raw value; q is that of the channel's register there, and h the
// vertex's as setup has it.
std::int64_t channel_at(LineId channel, const Vertex& vertex, Quad h, const Constants& constants,
                        const Quantizer<Quad>& q);

}  // namespace bitspan::golden
