// SPDX-License-Identifier: Apache-2.0
// The dump of a run: the planes of the picture as NumPy arrays and a JSON of what made them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/engine.hpp"
#include "report/position.hpp"

namespace bitspan {

struct DumpInfo {
  std::string version;
  std::string scene;
  std::string engine;
  double wall_seconds = 0;  // of the engine, without what reads the scene
  // How the engine model computed; none of the other engines.
  struct Model {
    std::string form;    // scalar, vector or specialised
    std::string target;  // of the vectors, empty for scalar
    int threads = 1;
  };
  std::optional<Model> model = std::nullopt;
  // Samples per pixel, each way, and the RGBA of their mean where there are several; the planes are those of
  // the samples.
  int supersample = 1;
  std::vector<std::uint8_t> resolved{};
  std::optional<Positions> positions = std::nullopt;
};

// color.npy (H, W, 4) uint8, depth.npy (H, W) uint32, u.npy and v.npy (H, W) float64, triangle.npy (H, W)
// int32, run.json; stencil.npy (H, W) uint8, resolved.npy (H / K, W / K, 4) uint8, s.npy (H, W) and
// position.npy (H, W, 3) float64 where there are any. All files are made in a folder beside `directory` and
// take their names when every one is complete; files of an existing folder that are no part of a dump stay.
// InputError where it cannot be written.
void write_dump(const std::string& directory, const Frame& frame, const Counters& counters,
                const Config& config, const DumpInfo& info);

// The text of run.json.
std::string run_json(const Frame& frame, const Counters& counters, const Config& config,
                     const DumpInfo& info);

}  // namespace bitspan
