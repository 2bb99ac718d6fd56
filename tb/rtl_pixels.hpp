// SPDX-License-Identifier: Apache-2.0
// The Verilated pixel stages (rtl/pixel_pipe.sv) of a configuration: how their ports are fed, and fragments
// through them into a picture that is their depth and colour memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "config/config.hpp"
#include "engine/counters.hpp"
#include "engine/frame.hpp"
#include "engine/records.hpp"
#include "model/mip_chain.hpp"
#include "model/pipeline.hpp"
#include "model/stages/lod.hpp"
#include "model/timed/pixel_chain_timing.hpp"
#include "scene/scene.hpp"
#include "tb/rtl_channels.hpp"

namespace bitspan {

// The channels of rtl/pixel_pipe.sv, built for an order of tests. A tap has the fields of its record, without
// the triangle. Throws InputError where the configuration has no pixel stages in RTL.
StageDesign pixel_pipe_design(const Config& config, DepthWhen when = DepthWhen::early);

// How the bits of a pixel record's field stand at its port.
Format port_format(const Field& field, const Config& config);

// Where a texture lies in the texel memory, and its last column and row: a row takes 2^pitch texels. A
// texture with a mip chain has `last_level` above 0 or a single texel; its levels lie as
// rtl/texture_address.sv says.
struct TexelPlace {
  std::uint64_t last_i = 0, last_j = 0, pitch = 0, base = 0, last_level = 0;
  bool has_levels = false;
};
// One per texture, behind the address `end`.
std::vector<TexelPlace> place_textures(const Config& config, const Scene& scene, std::uint64_t end = 0);
// Whether the RTL's indices and addresses are wide enough for all textures.
bool holds_textures(const Config& config, const Scene& scene);
// Whether the RTL finds a texture's texels by itself: it repeats only textures whose sizes are powers of two.
bool addresses_texels(const TexelLookup& by, const Texture& texture);
// A texel's word, red in the lowest byte.
std::uint32_t texel_word(const Texture& texture, std::int64_t i, std::int64_t j);
// None where the address holds no texel. chains: of the scene's textures, read where their places have
// levels.
std::optional<std::uint32_t> texel_at(const Scene& scene, std::span<const model::MipChain> chains,
                                      std::span<const TexelPlace> places, std::uint64_t address);

// The registers of the stencil test as the ports have them: both sides are there, whether they differ or not.
struct RtlStencilSide {
  CompareFunc func = CompareFunc::always;
  StencilOp fail = StencilOp::keep, zfail = StencilOp::keep, pass = StencilOp::keep;
  std::int32_t ref = 0, mask = 255, write = 255;
};
struct RtlStencil {
  bool test = false;
  RtlStencilSide front, back;
};
RtlStencil rtl_stencil(const DrawState& state);

// What the stages take from a triangle.
struct RtlDraw {
  DepthFunc func = DepthFunc::less;
  bool textured = false;
  TexelLookup lookup{};
  TexelPlace place{};
  Color transparent{};
  FogMode fog = FogMode::none;
  std::array<std::uint8_t, 3> fog_color{};
  bool write_z = true, blend = true, write_color = true;
  std::int32_t color_mask = 15;
  std::int64_t bias = 0;    // any: what is beyond the port's range does no more than its ends
  model::Blend equation{};  // with rtl.blend = equation, in place of `blend`
  CompareFunc alpha_func = CompareFunc::always;
  std::int32_t alpha_ref = 0;
  AlphaZero alpha_zero = AlphaZero::kill;
  RtlStencil stencil{};       // read where the tests are late
  GradientRecord gradient{};  // of the triangle, where lod takes it
};
// The number of a mode of fog at the port. A design has linear fog or that of the vertices, by one number.
std::uint64_t fog_number(FogMode mode);
// On the channels `draw` and `in`; factor: of the fog, where it comes with a fragment.
StageValues draw_values(const Config& config, const RtlDraw& state);
// line: what depth takes in the place of h, where it comes with a fragment.
StageValues fragment_values(const Config& config, const FragmentRecord& fragment, bool back = false,
                            std::int64_t factor = 0, std::optional<std::int64_t> line = {});

// What the constants of the design hold, in its order, while nothing is loaded.
StageValues frame_values(const Config& config, const ConstantsRecord& constants, const Scene& scene,
                         const model::LodStage& lod);
// One clock of the port `load`: the fields load_threshold, load_place and load_data.
struct FogLoad {
  bool threshold = false;
  std::uint64_t place = 0, data = 0;
};
std::vector<FogLoad> fog_loads(const Config& config, const model::FogStage& fog);
// What the port `load_k` gets, by level; empty where lod has no zones.
std::vector<std::uint64_t> zone_loads(const Config& config, const model::LodStage& lod);

// Fragments through the Verilated stages. In run() memories answer on the clock after a request, and nothing
// stalls.
class RtlPixels {
 public:
  // Builds or finds the library, loads it and resets. Throws as RtlModule does.
  explicit RtlPixels(const Config& config, DepthWhen when = DepthWhen::early);
  ~RtlPixels();
  RtlPixels(const RtlPixels&) = delete;
  RtlPixels& operator=(const RtlPixels&) = delete;

  // Resets and loads what stays for a scene whose textures it holds. The pipeline, the scene and the frame,
  // which is cleared already, must outlive the runs. Of a texture whose texels the RTL does not find by
  // itself, the model says which a fragment reads, and gives i and j of its texture record.
  void begin(const model::Pipeline& pipeline, const Scene& scene, Frame& frame);

  // The draw state of the fragments that follow, one that pixel_rtl_takes, with the order of tests that the
  // stages are built for. The frame has a stencil plane where it is tested. Not while fragments are inside.
  void set(const DrawState& state);

  struct Fragment {
    FragmentRecord record;                     // covered, inside the frame, and not masked
    int texture = -1;                          // index into Scene::textures, -1 for none
    bool back = false;                         // of a back face
    const GradientRecord* gradient = nullptr;  // of its triangle, where lod takes it
    std::int64_t factor = 0;                   // of the fog, where it comes with the fragment
    std::optional<std::int64_t> line{};        // what depth takes in the place of h
  };
  // Sends the fragments, in order, until all have left, and runs on until the stages must be empty. Appends
  // the records of the stages to the trace, where there is one, also those that no fragment asked for.
  // Counts stencil_failed, depth_passed, killed, written. Throws std::logic_error where an assertion in the
  // RTL fails, or where nothing moves although it should.
  void run(std::span<const Fragment> fragments, Counters& counters, Trace* trace);

  // One clock whose handshakes are driven from outside, for the comparison of clocks: `offered` stands at the
  // input, where it is not null, and its draw state with it. Returns the outputs. Not between calls of run.
  // Throws std::logic_error as run, and where an answer is driven that was not asked for.
  PixelChainPorts clock(const PixelChainDrive& drive, const Fragment* offered, Counters& counters);

 private:
  struct Pipe;
  std::unique_ptr<Pipe> pipe_;
};

}  // namespace bitspan
