// SPDX-License-Identifier: Apache-2.0
#include "model/timed/pixel_chain_timing.hpp"

#include <algorithm>

namespace bitspan {
namespace {

// As place_of in rtl/scoreboard.sv.
std::uint16_t place_of(std::uint32_t x, std::uint32_t y, int bits) {
  std::uint32_t place = 0;
  for (int i = 0; i < bits; ++i) place |= ((x >> i ^ y >> (bits - 1 - i)) & 1) << i;
  return static_cast<std::uint16_t>(place);
}

bool has(PortSet set, int port) { return (set >> port & 1) != 0; }
PortSet only(int port, bool is_in) { return static_cast<PortSet>(is_in ? 1U << port : 0U); }

}  // namespace

int read_ports_of(const PixelTiming& timing) {
  return timing.texture.shade > 0 ? read_ports : first_texel_port + level_texel_ports;
}

PixelChainTiming::PixelChainTiming(const PixelTiming& timing, DepthWhen when)
    : timing_(timing),
      late_(is_late(when)),
      in_slot_(std::size_t{1} << timing.slot_bits),
      depth_board_(timing.place_bits),
      z_rest_{static_cast<std::size_t>(timing.in_flight)},
      stencil_(timing.stencil.clocks),
      lod_(timing.lod.clocks),
      held_{static_cast<std::size_t>(timing.in_flight)},
      address_(timing.texture.address),
      texels_{static_cast<std::size_t>(timing.in_flight)},
      color_(timing.texture.color),
      shade_(timing.texture.shade),
      fog_(timing.fog.clocks),
      merge_board_(timing.place_bits),
      color_rest_{static_cast<std::size_t>(timing.in_flight)},
      blend_(timing.merge.clocks) {}

void PixelChainTiming::Pipe::shift(bool enters, const Entry& entry, Queue& out) {
  if (arrives()) {
    out.ring.push(ring.front().entry);
    ring.pop();
  }
  if (enters) ring.push({shifts + clocks, entry});
  ++shifts;
}

void PixelChainTiming::Scoreboard::clock(bool enters, bool cleared) {
  const bool hold = enters || !held.valid;
  const bool know = hold || !known.valid;
  const bool look = know || !looked.valid;
  if (enters) taken[held.entry.place] = 1;
  if (hold) held = known;
  if (know) known = looked;
  if (!look) return;
  looked.valid = cleared && entry.valid();
  if (!looked.valid) return;
  looked.entry = entry.ring.front();
  entry.ring.pop();
}

PixelChainTiming::Entry PixelChainTiming::entry_of(const PixelFragment& offered) const {
  return {.place = place_of(offered.x, offered.y, timing_.place_bits),
          .slot = slot_,
          .texels = offered.texels,
          .passes = offered.passes,
          .lives = offered.lives,
          .is_stencilled = offered.is_stencilled,
          .goes_on = late_ ? offered.goes_on : offered.lives,
          .writes_word =
              ((late_ ? offered.goes_on : offered.lives) && offered.writes_z) || offered.writes_stencil,
          .reads_color = offered.reads_color,
          .writes_color = offered.writes_color};
}

// The registers of the draw state: rtl/pixel_pipe.sv, "draw state".
void PixelChainTiming::count(bool in_taken, bool draw_taken, bool fate_waits,
                             const std::array<const Entry*, ways>& left) {
  const auto next_slot = static_cast<std::uint8_t>((slot_ + 1U) % in_slot_.size());
  const bool none_next = in_slot_[next_slot] == 0;
  const bool none = std::ranges::all_of(in_slot_, [](int n) { return n == 0; });
  draw_ready_ = none_next && settled_ && !draw_taken;
  idle_ = none && entered_ < 0 && !in_taken && !fate_waits;
  settled_ = !draw_taken;
  if (entered_ >= 0) ++in_slot_[static_cast<std::size_t>(entered_)];
  for (const int slot : left_) {
    if (slot >= 0) --in_slot_[static_cast<std::size_t>(slot)];
  }
  entered_ = in_taken ? slot_ : -1;
  for (std::size_t i = 0; i < left.size(); ++i) left_[i] = left[i] == nullptr ? -1 : left[i]->slot;
  if (draw_taken) slot_ = next_slot;
}

PixelChainClock PixelChainTiming::clock(const PixelChainDrive& drive, const PixelFragment& offered) {
  // What stands in the registers in front of the edge, from the output upstream. Every name of an action is a
  // transfer on this clock.
  const bool is_cleared = cleared();
  // merge.
  const bool done_valid = done_.valid();
  const bool writes_color = done_valid && done_.ring.front().writes_color;
  const bool leaves = done_valid && (!writes_color || has(drive.write_ready, color_port));
  const bool blend_en = done_.ready();
  const bool color_joins =
      color_rest_.valid() && (!color_rest_.ring.front().reads_color || color_answer_.valid()) && blend_en;
  const bool merge_enters = merge_board_.valid() && color_request_.ready() && color_rest_.ready();
  const bool merge_takes = fogged_.valid() && merge_board_.entry.ready();
  // fog, and the fate behind the later one of texture and depth.
  Queue& judged = late_ ? judged_ : textured_;
  const bool fog_en = fogged_.ready();
  const bool judged_valid = judged.valid();
  const bool goes_on = judged_valid && judged.ring.front().goes_on;
  const bool judged_ready = fate_.ready() && (fog_en || !goes_on);
  const bool is_judged = judged_valid && judged_ready;
  const bool fog_takes = is_judged && goes_on;
  const bool fate_waits = fate_.valid();
  const bool writes_z = fate_.valid() && fate_.ring.front().writes_word;
  const bool fate_done = fate_.valid() && (!writes_z || has(drive.write_ready, z_port));
  // The fragments between texture and depth: `textured` in one order, `tested` in the other.
  const bool textured_valid = textured_.valid();
  const bool lives = textured_valid && textured_.ring.front().lives;
  const bool textured_ready = late_ ? depth_board_.entry.ready() || !lives : judged_ready;
  const bool is_textured = textured_valid && textured_ready;
  const bool stencil_en = judged_.ready();
  const bool stencil_takes = late_ && tested_.valid() && stencil_en;
  // texture.
  const bool mixes_levels = timing_.texture.shade > 0;
  const bool shade_en = textured_.ready();
  const bool filtered = mixes_levels && filtered_.valid() && shade_en;
  Queue& colored = mixes_levels ? filtered_ : textured_;
  const bool color_en = colored.ready();
  bool texels_join = awaiting_.valid() && color_en;
  for (int p = 0; p < texel_ports; ++p) {
    if (texels_join && has(awaiting_.ring.front().texels, p)) {
      texels_join = texel_answer_[static_cast<std::size_t>(p)].valid();
    }
  }
  const bool texels_move = texels_.valid() && awaiting_.ready();
  const PortSet wanted = ask_.valid() ? ask_.ring.front().texels : PortSet{0};
  const auto texel_requests = static_cast<PortSet>(wanted & ~asked_);
  const auto texel_ready = static_cast<PortSet>(drive.request_ready >> first_texel_port);
  const bool ask_taken = ask_.valid() && (texel_requests & ~texel_ready) == 0;
  const bool address_en = ask_.ready();
  const bool texture_ready = address_en && held_.ready();
  // What comes to lod, or to texture where there is none.
  const bool offered_first = late_ ? drive.in_valid : tested_.valid();
  const bool texture_offered = timing_.has_lod ? levelled_.valid() : offered_first;
  const bool texture_takes = texture_offered && texture_ready;
  // lod.
  const bool lod_en = levelled_.ready();
  const bool lod_takes = timing_.has_lod && offered_first && lod_en;
  const bool first_ready = timing_.has_lod ? lod_en : texture_ready;
  // depth.
  const bool tested_en = tested_.ready();
  const bool compares = compared_.valid && tested_en;
  const bool z_joins = z_rest_.valid() && z_due_.front() <= clocks_ && z_answer_.valid() && tested_en;
  const bool depth_enters = depth_board_.valid() && z_request_.ready() && z_rest_.ready();
  const bool in_taken = drive.in_valid && in_ready();
  const bool draw_taken = drive.draw_valid && draw_ready_;
  const Entry entered = in_taken ? entry_of(offered) : Entry{};

  PixelChainClock now;
  PixelChainPorts& ports = now.ports;
  ports.draw_ready = draw_ready_;
  ports.in_ready = in_ready();
  ports.idle = idle_;
  ports.request_valid =
      static_cast<PortSet>(only(z_port, z_request_.valid()) | only(color_port, color_request_.valid()) |
                           texel_requests << first_texel_port);
  ports.answer_ready =
      static_cast<PortSet>(only(z_port, z_answer_.ready()) | only(color_port, color_answer_.ready()));
  for (int p = 0; p < read_ports_of(timing_) - first_texel_port; ++p) {
    ports.answer_ready |= only(first_texel_port + p, texel_answer_[static_cast<std::size_t>(p)].ready());
  }
  ports.write_valid = static_cast<PortSet>(only(z_port, writes_z) | only(color_port, writes_color));
  const bool is_stencilled = late_ && is_judged && judged.ring.front().is_stencilled;
  ports.records = static_cast<std::uint8_t>(only(0, compares) | only(1, is_textured) | only(2, merge_takes) |
                                            only(3, leaves) | only(4, is_stencilled) |
                                            only(5, timing_.has_lod && texture_takes));
  const PixelStageClock depth_clock{drive.in_valid, ports.in_ready, tested_.valid(), first_ready};
  const PixelStageClock late_depth_clock{lives, depth_board_.entry.ready(), judged_valid, judged_ready};
  now.stages = {{late_ ? late_depth_clock : depth_clock,
                 {offered_first, first_ready, textured_valid, textured_ready},
                 {goes_on && fate_.ready(), fog_en, fogged_.valid(), merge_board_.entry.ready()},
                 {fogged_.valid(), merge_board_.entry.ready(), done_valid, leaves}}};

  // The edge, in the same order. A queue that is popped on this clock has its front copied first.
  const PortSet asks = static_cast<PortSet>(ports.request_valid & drive.request_ready);
  const PortSet answers = static_cast<PortSet>(ports.answer_ready & drive.answer_valid);
  std::array<const Entry*, ways> left{};
  Entry failed, killed, merged, rejected;
  if (leaves) {
    merged = done_.ring.front();
    left[2] = &merged;
    merge_board_.taken[merged.place] = 0;
    done_.ring.pop();
    --inside_;
  }
  if (blend_en) {
    const Entry joins = color_joins ? color_rest_.ring.front() : Entry{};
    blend_.shift(color_joins, joins, done_);
    if (color_joins) {
      color_rest_.ring.pop();
      if (joins.reads_color) --color_answer_.held;
    }
  }
  if (has(answers, color_port)) ++color_answer_.held;
  if (has(asks, color_port)) --color_request_.held;
  if (merge_enters) {
    const Entry& entry = merge_board_.held.entry;
    color_rest_.ring.push(entry);
    if (entry.reads_color) ++color_request_.held;
  }
  merge_board_.clock(merge_enters, is_cleared);
  if (merge_takes) {
    merge_board_.entry.ring.push(fogged_.ring.front());
    fogged_.ring.pop();
  }

  if (fog_en) fog_.shift(fog_takes, fog_takes ? judged.ring.front() : Entry{}, fogged_);
  if (fate_done) {
    depth_board_.taken[fate_.ring.front().place] = 0;
    fate_.ring.pop();
    --inside_;
  }
  if (fog_takes) ++inside_;
  if (is_judged) {
    const Entry& entry = judged.ring.front();
    fate_.ring.push(entry);
    if (late_ && !entry.goes_on) {
      rejected = entry;
      left[3] = &rejected;
    }
    if (late_) judged_.ring.pop();
  }
  Entry textured;
  if (is_textured) {
    textured = textured_.ring.front();
    if (!textured.lives) {
      killed = textured;
      left[1] = &killed;
      if (late_) --inside_;
    }
    textured_.ring.pop();
  }
  if (late_ && stencil_en) {
    stencil_.shift(stencil_takes, stencil_takes ? tested_.ring.front() : Entry{}, judged_);
    if (stencil_takes) tested_.ring.pop();
  }

  if (mixes_levels && shade_en) {
    shade_.shift(filtered, filtered ? filtered_.ring.front() : Entry{}, textured_);
    if (filtered) filtered_.ring.pop();
  }
  if (color_en) {
    const Entry joins = texels_join ? awaiting_.ring.front() : Entry{};
    color_.shift(texels_join, texels_join ? held_.ring.front() : joins, colored);
    if (texels_join) {
      for (int p = 0; p < texel_ports; ++p) {
        if (has(joins.texels, p)) --texel_answer_[static_cast<std::size_t>(p)].held;
      }
      held_.ring.pop();
      awaiting_.ring.pop();
    }
  }
  for (int p = 0; p < texel_ports; ++p) {
    if (has(answers, first_texel_port + p)) ++texel_answer_[static_cast<std::size_t>(p)].held;
  }
  if (texels_move) {
    awaiting_.ring.push(texels_.ring.front());
    texels_.ring.pop();
  }
  if (ask_taken) {
    texels_.ring.push(ask_.ring.front());
    ask_.ring.pop();
    asked_ = 0;
  } else {
    asked_ = static_cast<PortSet>(asked_ | (texel_requests & texel_ready));
  }
  // What lod and texture take: the fragment that is offered, or depth's.
  Entry first;
  const bool first_takes = timing_.has_lod ? lod_takes : texture_takes;
  if (first_takes) first = late_ ? entered : tested_.ring.front();
  const Entry shaded = !timing_.has_lod ? first : texture_takes ? levelled_.ring.front() : Entry{};
  if (texture_takes) held_.ring.push(shaded);
  if (address_en) address_.shift(texture_takes, shaded, ask_);
  if (timing_.has_lod && texture_takes) levelled_.ring.pop();
  if (timing_.has_lod && lod_en) lod_.shift(lod_takes, first, levelled_);
  if (first_takes && !late_) tested_.ring.pop();

  if (tested_en) {
    if (compares && compared_.entry.leaves_depth()) tested_.ring.push(compared_.entry);
    if (compares && !compared_.entry.leaves_depth()) {
      failed = compared_.entry;
      left[0] = &failed;
      depth_board_.taken[failed.place] = 0;
      --inside_;
    }
    compared_ = joined_;
    joined_.valid = z_joins;
    if (z_joins) {
      joined_.entry = z_rest_.ring.front();
      z_rest_.ring.pop();
      z_due_.pop();
      --z_answer_.held;
    }
  }
  if (has(answers, z_port)) ++z_answer_.held;
  if (has(asks, z_port)) --z_request_.held;
  if (depth_enters) {
    z_rest_.ring.push(depth_board_.held.entry);
    // In its FIFO on the clock after the last of its clocks.
    z_due_.push(clocks_ + static_cast<Clock>(timing_.depth.code) + 1);
    ++z_request_.held;
  }
  depth_board_.clock(depth_enters, is_cleared);
  if (late_ ? is_textured && lives : in_taken) depth_board_.entry.ring.push(late_ ? textured : entered);
  if (in_taken) ++inside_;
  count(in_taken, draw_taken, fate_waits, left);
  ++clocks_;
  return now;
}

}  // namespace bitspan
