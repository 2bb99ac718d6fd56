// SPDX-License-Identifier: Apache-2.0
#include "model/timed/pixel_chain.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "model/timed/depth.hpp"
#include "model/timed/fog.hpp"
#include "model/timed/merge.hpp"
#include "model/timed/texture.hpp"

namespace bitspan::timed {
namespace {

// A frame begins when its constants and its fog's table are loaded and the scoreboards' places are clear.
PixelChainTiming rested_chain(const Config& config, DepthWhen when) {
  if (!has_pixel_rtl(config)) {
    throw InputError(config.name +
                     ": no run with the RTL's ports: the configuration has no pixel stages in RTL");
  }
  PixelChainTiming chain(pixel_timing(config), when);
  while (!chain.cleared() || !chain.draw_ready()) chain.clock({}, {});
  return chain;
}

// The ports that a fragment asks, in its level.
PortSet texels(const Run& run, const FragmentItem& item) {
  if (item.surface.texture < 0) return 0;
  return weighs_texels(model::lookup_at(run.pipeline.texture, item.lod).filter) ? PortSet{15} : PortSet{1};
}

}  // namespace

PixelChain::PixelChain(Run& run, Fifo<RowItem*>& in, const SystemcOptions& options,
                       std::vector<HandshakeClock>* handshake)
    : run_(run),
      interpolator_(run, in, nullptr, handshake),
      timing_(rested_chain(run.config, when_)),
      memory_(options.ports, read_ports_of(pixel_timing(run.config))),
      watch_(options.watch_chain),
      draws_each_triangle_(has_lod_gradients(run.config)) {
  for (std::size_t i = 0; i < meters_.size(); ++i) {
    meters_[i].report.name = stage_names[static_cast<std::size_t>(Stage::depth) + i];
  }
  for (StageMeter* meter : interpolator_.meters()) interpolator_meters_.push_back(meter);
}

void PixelChain::choose_chain() {
  const DepthWhen when = run_.pipeline.state.depth_when;
  if (is_late(when) == is_late(when_)) return;
  when_ = when;
  timing_ = rested_chain(run_.config, when);
}

std::vector<StageMeter*> PixelChain::meters() {
  std::vector<StageMeter*> meters = interpolator_meters_;
  for (StageMeter& meter : meters_) meters.push_back(&meter);
  return meters;
}

void PixelChain::clock(std::uint64_t now) {
  const FragmentItem* pixel = interpolator_.waiting();
  if (pixel != nullptr) choose_chain();
  const bool covered = pixel != nullptr && run_.is_drawn(pixel->fragment);
  PixelChainDrive drive;
  Drawn wanted = drawn_;
  if (covered) {
    wanted.texture = std::max(pixel->surface.texture, -1);
    if (draws_each_triangle_) wanted.triangle = pixel->fragment.triangle;
  }
  drive.draw_valid = wanted != drawn_;
  drive.in_valid = covered && !drive.draw_valid;
  memory_.drive(now, drive);
  const bool accepted = drive.in_valid && timing_.in_ready();
  FragmentItem* delivered = interpolator_.step(now, accepted || !covered);
  const PixelChainClock c = timing_.clock(drive, accepted ? values(*delivered) : PixelFragment{});
  memory_.see(now, drive, c.ports);
  if (drive.draw_valid && c.ports.draw_ready) drawn_ = wanted;
  if (watch_) {
    const StageSignals& rows = interpolator_meters_.front()->signals;
    watch_({.rows = {rows.in_valid, accepted || !covered, rows.in_ready, pixel != nullptr},
            .drive = drive,
            .ports = c.ports});
  }
  if (delivered != nullptr && !covered && delivered->fragment.covered != 0) ++run_.counters.masked;
  if (delivered != nullptr) run_.fragments.put(delivered);
  count(drive, c);
}

PixelFragment PixelChain::values(FragmentItem& item) {
  PixelFragment f;
  f.x = static_cast<std::uint32_t>(item.fragment.x);
  f.y = static_cast<std::uint32_t>(item.fragment.y);
  f.texels = texels(run_, item);
  f.writes_z = run_.pipeline.state.depth_write;
  f.writes_color = run_.pipeline.state.color_write;
  if (run_.tests_late()) {
    f.lives = texture_values(run_, item);
    ask_texels(item, f);
    if (f.lives) test(item, f);
    if (!f.goes_on) return f;
  } else {
    test(item, f);
    if (f.goes_on) ask_texels(item, f);
    f.lives = f.goes_on && texture_values(run_, item);
    if (!f.lives) return f;
  }
  f.reads_color = model::reads_stored_color(run_.pipeline.merge, item.texel.a);
  fog_values(run_, item);
  merge_values(run_, item);
  return f;
}

// The next level is mixed in where f is not 0.
void PixelChain::ask_texels(const FragmentItem& item, PixelFragment& f) const {
  f.texels = texels(run_, item);
  if (run_.pipeline.has_lod && item.lod.f != 0) {
    f.texels = static_cast<PortSet>(f.texels | f.texels << level_texel_ports);
  }
}

void PixelChain::test(FragmentItem& item, PixelFragment& f) {
  f.goes_on = depth_values(run_, item);
  f.passes = item.depth.pass != 0;
  f.is_stencilled = run_.pipeline.stencil.test;
  f.writes_stencil = f.is_stencilled && item.stencil.value != item.stencil.stored;
}

// A stage is busy on the clocks on which it takes a fragment. One that is refused is blocked where what the
// stage has made stands at its output, or where nothing of it goes to memory.
void PixelChain::count(const PixelChainDrive& drive, const PixelChainClock& c) {
  const bool late = is_late(when_);
  const Stage first = late ? Stage::texture : Stage::depth;
  // What a test drops or texture kills goes nowhere: the stage behind says what it takes.
  const auto taken_by = [&](Stage stage) {
    const PixelStageClock& s =
        c.stages[static_cast<std::size_t>(stage) - static_cast<std::size_t>(Stage::depth)];
    return s.in_valid && s.in_ready;
  };
  for (std::size_t i = 0; i < meters_.size(); ++i) {
    const PixelStageClock& s = c.stages[i];
    StageMeter& meter = meters_[i];
    const auto stage = static_cast<Stage>(static_cast<std::size_t>(Stage::depth) + i);
    const bool accepts = s.in_valid && s.in_ready;
    const bool stands = s.out_valid && !s.out_ready;
    const bool waits_for_draw = stage == first && drive.draw_valid;
    meter.signals = {s.in_valid, s.in_ready, s.out_valid, s.out_ready, 0, 0};
    meter.count(accepts                                           ? StageState::busy
                : !s.in_valid && !waits_for_draw                  ? StageState::starved
                : stage == Stage::merge                           ? StageState::memory
                : stands || stage == Stage::fog || waits_for_draw ? StageState::blocked
                                                                  : StageState::memory);
    meter.report.records_in += accepts ? 1 : 0;
    const bool leaves = s.out_valid && s.out_ready;
    const bool delivers = stage == Stage::texture         ? taken_by(late ? Stage::depth : Stage::fog)
                          : stage == Stage::depth && late ? taken_by(Stage::fog)
                                                          : leaves;
    meter.report.records_out += delivers ? 1 : 0;
    meter.moves += accepts || leaves ? 1 : 0;
  }
  // Requests, answers and draw states go forward, too.
  const PixelChainPorts& p = c.ports;
  const bool moved = (drive.draw_valid && p.draw_ready) || (drive.request_ready & p.request_valid) != 0 ||
                     (drive.answer_valid & p.answer_ready) != 0 || (drive.write_ready & p.write_valid) != 0;
  if (moved) ++meters_.front().moves;
}

}  // namespace bitspan::timed
