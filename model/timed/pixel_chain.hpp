// SPDX-License-Identifier: Apache-2.0
// span_setup to merge, timed, with the RTL's ports: the span interpolator and the pixel stages as they are
// connected in RTL, clock for clock, and a memory behind each port.
//
// A pixel at the interpolator's output that is not covered, or is masked, is taken at once. One whose texture
// is not that of the draw state, or that is the first one behind a change of state, waits until the next draw
// state was transferred. Any other is offered to the pixel stages.
//
// The pixel stages are built for one order of tests. There is a chain of them per order; the one that the
// draw state asks for takes the pixels, and the other one rests.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "model/timed/engine_systemc.hpp"
#include "model/timed/span_interpolator.hpp"

namespace bitspan::timed {

class PixelChain : public TimedStage {
 public:
  // Throws InputError where the configuration has no pixel stages in RTL. `handshake` null: not recorded.
  PixelChain(Run& run, Fifo<RowItem*>& in, const SystemcOptions& options,
             std::vector<HandshakeClock>* handshake);

  void clock(std::uint64_t now) override;
  // Nothing is inside. The next fragment waits for a draw state of its own.
  void draw_state_changed() { drawn_ = {}; }
  bool idle() const override { return interpolator_.idle() && timing_.empty(); }
  std::vector<StageMeter*> meters() override;
  std::string_view module() const override { return "pixel_chain"; }
  std::span<const PortReport> ports() const { return memory_.reports(); }

 private:
  // The values of the pixel that is accepted, from depth to the frame.
  PixelFragment values(FragmentItem& item);
  // The chain for the draw state in force takes the pixels from here on.
  void choose_chain();
  // Of depth and stencil.
  void test(FragmentItem& item, PixelFragment& f);
  // Behind lod.
  void ask_texels(const FragmentItem& item, PixelFragment& f) const;
  void count(const PixelChainDrive& drive, const PixelChainClock& c);

  Run& run_;
  SpanInterpolator interpolator_;
  DepthWhen when_ = DepthWhen::early;  // of the chain that takes the pixels
  PixelChainTiming timing_;
  MemoryPorts memory_;
  std::function<void(const ChainClock&)> watch_;
  // What the draw state was transferred for: a texture, and a triangle where it has the triangle's gradients.
  struct Drawn {
    int texture = -2;  // none
    std::int64_t triangle = -1;
    bool operator==(const Drawn&) const = default;
  };
  Drawn drawn_;
  bool draws_each_triangle_;
  std::array<StageMeter, 4> meters_;
  std::vector<StageMeter*> interpolator_meters_;
};

}  // namespace bitspan::timed
