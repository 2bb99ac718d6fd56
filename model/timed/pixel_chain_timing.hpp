// SPDX-License-Identifier: Apache-2.0
// The clocks of the pixel stages (rtl/pixel_pipe.sv), one call per clock, without values.
//
// docs/rtl.md, "depth, merge and the chain", is the contract: given the same inputs of all handshakes, and
// per fragment what its values decide, every handshake's output equals the RTL's on every clock. Every skid
// and FIFO of the RTL is a queue here, every part that shifts as one a pipe. With late tests texture stands
// in front of depth, and stencil between depth and fog.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "config/pixel_timing.hpp"
#include "model/timed/ring.hpp"
#include "scene/draw_state.hpp"

namespace bitspan {

// The ports that read: depth, colour, four of texels, and four more of texels of the next level. The first
// two write, too. A set of ports has bit p for port p.
inline constexpr int z_port = 0, color_port = 1, first_texel_port = 2, level_texel_ports = 4, texel_ports = 8;
inline constexpr int write_ports = 2, read_ports = first_texel_port + texel_ports;
using PortSet = std::uint16_t;
// Those of them that a configuration has: the last four only where two levels are mixed.
int read_ports_of(const PixelTiming& timing);

// What a fragment's values and its draw state decide.
struct PixelFragment {
  std::uint32_t x = 0, y = 0;
  bool passes = false;          // the depth test
  bool lives = false;           // texture does not kill it
  bool is_stencilled = false;   // late: there is a stencil test, which takes it whether it passes or not
  bool goes_on = false;         // late: both tests pass
  PortSet texels = 0;           // asked for: bit 0 for the first texel port
  bool writes_z = false;        // where it goes to fog
  bool writes_stencil = false;  // late: the stencil test changes the plane
  bool reads_color = false;     // it is mixed
  bool writes_color = false;    // where it lives
};

// The inputs of the handshakes on one clock.
struct PixelChainDrive {
  bool draw_valid = false;
  bool in_valid = false;
  PortSet request_ready = 0;
  PortSet answer_valid = 0;
  PortSet write_ready = 0;
};
// Their outputs.
struct PixelChainPorts {
  bool draw_ready = false;
  bool in_ready = false;
  bool idle = false;
  PortSet request_valid = 0;
  PortSet answer_ready = 0;
  PortSet write_valid = 0;
  std::uint8_t records = 0;  // taps that are valid: bits 0 to 5 for depth, texture, fog, merge, stencil, lod
  bool operator==(const PixelChainPorts&) const = default;
};

// A stage's handshakes with its neighbours.
struct PixelStageClock {
  bool in_valid = false, in_ready = false, out_valid = false, out_ready = false;
};
struct PixelChainClock {
  PixelChainPorts ports;
  // depth, and stencil behind it; texture, and lod in front of it; fog; merge
  std::array<PixelStageClock, 4> stages;
};

class PixelChainTiming {
 public:
  // As the RTL is after a reset.
  explicit PixelChainTiming(const PixelTiming& timing, DepthWhen when = DepthWhen::early);

  // One rising edge. `offered` is read where it is accepted.
  PixelChainClock clock(const PixelChainDrive& drive, const PixelFragment& offered);
  // What the next clock will see of them.
  bool draw_ready() const { return draw_ready_; }
  bool in_ready() const {
    return !late_            ? depth_board_.entry.ready()
           : timing_.has_lod ? levelled_.ready()
                             : ask_.ready() && held_.ready();
  }

  // No fragment is inside, and all that they write was accepted.
  bool empty() const { return inside_ == 0; }
  // Whether the scoreboards' places are cleared; no fragment leaves them before.
  bool cleared() const { return clocks_ >= depth_board_.taken.size(); }

 private:
  using Clock = std::uint64_t;
  struct Entry {
    std::uint16_t place = 0;
    std::uint8_t slot = 0;  // of its draw state
    PortSet texels = 0;
    bool passes = false, lives = false, is_stencilled = false, goes_on = false, writes_word = false;
    bool reads_color = false, writes_color = false;

    bool leaves_depth() const { return passes || is_stencilled; }
  };
  // rtl/fifo.sv; rtl/skid.sv has two places.
  struct Queue {
    std::size_t places = 2;
    timed::Ring<Entry> ring{};

    bool valid() const { return !ring.empty(); }
    bool ready() const { return ring.size() < places; }
  };
  // A skid whose records' order is known elsewhere.
  struct Count {
    int held = 0;

    bool valid() const { return held > 0; }
    bool ready() const { return held < 2; }
  };
  // Shifts as one: what enters arrives behind it after so many shifts.
  struct Pipe {
    explicit Pipe(int n) : clocks(static_cast<Clock>(n)) {}
    struct Inside {
      Clock due = 0;
      Entry entry;
    };
    Clock clocks;
    Clock shifts = 0;
    timed::Ring<Inside> ring{};

    bool arrives() const { return !ring.empty() && ring.front().due == shifts; }
    void shift(bool enters, const Entry& entry, Queue& out);
  };
  struct Register {
    bool valid = false;
    Entry entry;
  };
  // rtl/scoreboard.sv.
  struct Scoreboard {
    explicit Scoreboard(int place_bits) : taken(std::size_t{1} << place_bits) {}
    Queue entry{};
    Register looked{}, known{}, held{};
    std::vector<std::uint8_t> taken;

    bool valid() const { return held.valid && taken[held.entry.place] == 0; }
    void clock(bool enters, bool cleared);
  };

  Entry entry_of(const PixelFragment& offered) const;
  // The ways out of the chain: depth, texture, merge, stencil.
  static constexpr std::size_t ways = 4;
  void count(bool in_taken, bool draw_taken, bool fate_waits, const std::array<const Entry*, ways>& left);

  PixelTiming timing_;
  bool late_;
  Clock clocks_ = 0;
  std::size_t inside_ = 0;  // fates and colours to come

  // Draw state.
  std::uint8_t slot_ = 0;
  bool draw_ready_ = false, idle_ = false, settled_ = false;
  int entered_ = -1;  // the slot of the fragment accepted on the clock before; -1: none
  std::array<int, ways> left_{-1, -1, -1, -1};  // the same of those that left
  std::vector<int> in_slot_;                    // fragments per slot, a clock late
  // depth.
  Scoreboard depth_board_;
  Count z_request_, z_answer_;
  Queue z_rest_;
  timed::Ring<Clock> z_due_;  // of those in z_rest_: the first clock that sees their code
  Register joined_, compared_;
  Queue tested_, fate_;
  // stencil, where the tests are late.
  Pipe stencil_;
  Queue judged_;
  // lod, where it is there.
  Pipe lod_;
  Queue levelled_;
  // texture.
  Queue held_;
  Pipe address_;
  Queue ask_;
  PortSet asked_ = 0;  // of the front of ask_: requests that were taken
  Queue texels_;
  Queue awaiting_;
  std::array<Count, texel_ports> texel_answer_;
  Pipe color_;
  Queue filtered_;  // where two levels are mixed, as the next
  Pipe shade_;
  Queue textured_;
  // fog.
  Pipe fog_;
  Queue fogged_;
  // merge.
  Scoreboard merge_board_;
  Count color_request_, color_answer_;
  Queue color_rest_;
  Pipe blend_;
  Queue done_;
};

}  // namespace bitspan
