// SPDX-License-Identifier: Apache-2.0
// Fragments for rtl/pixel_pipe.sv with the records that the model makes of them, and their run through the
// Verilated pipe.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/mip_chain.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/fog.hpp"
#include "model/stages/lod.hpp"
#include "model/stages/merge.hpp"
#include "tb/rtl_pixels.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/stage_bench.hpp"

namespace bitspan {

// Fragments with one draw state.
struct PipeBatch {
  StageValues draw;
  std::vector<StageValues> fragments;
};

struct PipeCase {
  Config config;
  DepthWhen when = DepthWhen::early;  // the order of tests of the pipe
  Scene scene;                        // its textures, its background and its size
  std::vector<TexelPlace> places;
  std::vector<model::MipChain> chains;  // of the textures, where they have levels
  model::Constants constants;
  model::LodStage lod;
  model::FogStage fog;
  std::vector<PipeBatch> batches;
  std::map<std::string, std::vector<StageValues>> records;  // by tap
  Frame frame;
  std::uint64_t reads = 0;  // of colours
};

// What a colour memory holds behind a write of r, g, b, a, has_a and, of pixel_pipe, mask: alpha is kept
// where has_a is 0, and what mask does not name.
StageValues merged_color(const StageValues& held, const StageValues& written);

// Any equations, factors, operations and logic operations; often some of the first state's.
model::Blend random_blend(Random& random);

// The fragments of a scene. Late: with a stencil test that counts front faces up and back faces down, and an
// alpha test that passes most fragments.
PipeCase make_pipe_case(const Config& c, const Scene& given, DepthWhen when = DepthWhen::early);

// The picture, the textures, and an address in front of theirs.
struct PipeExtent {
  int width = 12, height = 7;
  std::vector<std::pair<int, int>> textures{{1, 2}, {4, 8}, {16, 32}};
  std::uint64_t address = 0;
};

// Raw fragments, a new draw state for every few of them, through the model's stages one after another.
PipeCase random_pipe_case(Random& random, const Config& c, int batches, const PipeExtent& extent = {},
                          DepthWhen when = DepthWhen::early);

struct PipeWay {
  double in_gap = 0;
  StageStalls stalls;
  StageMemory::Latency latency;
  std::uint64_t seed = 1;
  int reset_after = 0;       // clocks of the same fragments in front, then a reset
  bool sweeps_first = true;  // nothing is sent before the places are cleared
  double write_stall = 0;    // of colours, in place of that in `stalls`
  double z_write_stall = 0;  // of depth codes
};

struct PipeRun {
  std::size_t compared = 0;
  std::uint64_t clocks = 0;  // from the first draw state's offer to the last record
};

// Throws std::logic_error where anything differs.
PipeRun run_pipe(const PipeCase& p, const PipeWay& way, StageTrace* trace = nullptr);

}  // namespace bitspan
