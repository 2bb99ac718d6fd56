// SPDX-License-Identifier: Apache-2.0
// What the stage of a divergence read beside the records that fed it: the draw state, the pixel as it stood,
// the texels, the input.
#pragma once

#include <string_view>

#include "report/compare.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Fills divergence.read. `engine` is one of the configuration, of which nothing is wanted any more: it draws
// what stands in front of the divergence's triangle. The texels are those that golden finds.
void add_reads(Divergence& divergence, const Config& config, const Scene& scene, Engine& engine);

// Whether a stage reads a register of the draw state, named by its key. Some stage reads each.
bool reads_register(RecordType type, std::string_view key);

}  // namespace bitspan
