// SPDX-License-Identifier: Apache-2.0
// The clocks of the pixel stages (model/timed/pixel_chain_timing) against the Verilated pixel_pipe: every
// output of every handshake, on every clock.
#include "model/timed/pixel_chain_timing.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "model/stages/merge.hpp"
#include "scene/demo.hpp"
#include "tests/rtl/pipe_case.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// The ports of a recorded clock, by their meaning.
class TracePorts {
 public:
  TracePorts(const Config& config, DepthWhen when, const StageTrace& trace)
      : design_(pixel_pipe_design(config, when)), module_(module_of(design_)), trace_(trace) {
    draw_ = find("draw");
    in_ = find("in");
    for (int p = 0; p < read_ports; ++p) {
      const std::string name = p == z_port       ? "z"
                               : p == color_port ? "color"
                                                 : fmt::format("texel{}", p - first_texel_port);
      request_.push_back(find(name + "_request"));
      answer_.push_back(find(name + "_answer"));
      if (p < write_ports) write_.push_back(find(name + "_write"));
    }
    for (const char* tap :
         {"depth_record", "texture_record", "fog_record", "merge_record", "stencil_record", "lod_record"}) {
      taps_.push_back(find(tap));
    }
    idle_ = port_place(module_.outputs, "idle_o");
  }

  PixelChainDrive drive(std::size_t t) const {
    const auto& in = trace_.inputs[t];
    PixelChainDrive d;
    d.draw_valid = in[draw_.valid] != 0;
    d.in_valid = in[in_.valid] != 0;
    d.request_ready = set(request_, in, &ChannelPorts::ready);
    d.answer_valid = set(answer_, in, &ChannelPorts::valid);
    d.write_ready = set(write_, in, &ChannelPorts::ready);
    return d;
  }
  PixelChainPorts ports(std::size_t t) const {
    const auto& out = trace_.outputs[t];
    PixelChainPorts p;
    p.draw_ready = out[draw_.ready] != 0;
    p.in_ready = out[in_.ready] != 0;
    p.idle = out[idle_] != 0;
    p.request_valid = set(request_, out, &ChannelPorts::valid);
    p.answer_ready = set(answer_, out, &ChannelPorts::ready);
    p.write_valid = set(write_, out, &ChannelPorts::valid);
    p.records = static_cast<std::uint8_t>(set(taps_, out, &ChannelPorts::valid));
    return p;
  }
  std::uint64_t in_field(std::size_t t, const char* channel, const char* field) const {
    return trace_.inputs[t][place(channel, field)];
  }
  std::uint64_t out_field(std::size_t t, const char* channel, const char* field) const {
    return trace_.outputs[t][place(channel, field)];
  }

 private:
  const StageChannel& shape(const std::string& name) const {
    return *std::ranges::find(design_.channels, name, &StageChannel::name);
  }
  ChannelPorts find(const std::string& name) const { return ports_of(module_, shape(name)); }
  std::size_t place(const char* channel, const char* field) const {
    const StageChannel& c = shape(channel);
    return ports_of(module_, c).first +
           static_cast<std::size_t>(std::ranges::find(c.fields, field) - c.fields.begin());
  }
  static PortSet set(const std::vector<ChannelPorts>& channels, const std::vector<std::uint64_t>& values,
                     std::size_t ChannelPorts::*port) {
    PortSet out = 0;
    for (std::size_t p = 0; p < channels.size(); ++p) {
      out = static_cast<PortSet>(out | (values[channels[p].*port] != 0 ? 1U << p : 0U));
    }
    return out;
  }

  StageDesign design_;
  RtlModuleDesign module_;
  const StageTrace& trace_;
  ChannelPorts draw_, in_;
  std::vector<ChannelPorts> request_, answer_, write_, taps_;
  std::size_t idle_ = 0;
};

// Whether a fragment reads the stored colour, where its alpha is below 1 and where it is not.
struct Reads {
  bool translucent = false, opaque = false;
};
// By the draw state that is taken on a clock.
Reads reads_of(const Config& config, const TracePorts& ports, std::size_t t) {
  const auto field = [&](const char* name) { return ports.in_field(t, "draw", name); };
  if (!has_blend_equation(config.rtl.blend)) return {field("blend") != 0, false};
  model::MergeStage stage = model::prepare_merge(config);
  const auto equation = [&](const char* src, const char* dst, const char* op) {
    return model::BlendEquation{static_cast<BlendFactor>(field(src)), static_cast<BlendFactor>(field(dst)),
                                static_cast<BlendOp>(field(op))};
  };
  model::Blend blend;
  blend.color = equation("src", "dst", "op");
  blend.alpha = equation("alpha_src", "alpha_dst", "alpha_op");
  blend.logic = static_cast<LogicOp>(field("logic"));
  model::set_blend(stage, blend);
  const std::int64_t one = std::int64_t{1} << config.format(FormatId::texture_alpha).fraction();
  return {model::reads_stored_color(stage, one - 1), model::reads_stored_color(stage, one)};
}

// What the values decide, as the trace itself shows it: the draw states and the taps do not depend on clocks.
std::vector<PixelFragment> fragments_of(const Config& config, DepthWhen when, const TracePorts& ports,
                                        std::size_t from, std::size_t to) {
  const std::int64_t one = std::int64_t{1} << config.format(FormatId::texture_alpha).fraction();
  std::vector<PixelFragment> all;
  std::vector<Reads> reads;
  // Those that come to the second of depth and texture, and to stencil.
  std::vector<std::size_t> second;
  std::vector<std::size_t> stencilled;
  PixelFragment drawn;
  Reads drawn_reads;
  std::size_t tested = 0;
  std::size_t levelled = 0;
  std::size_t textured = 0;
  std::size_t judged = 0;
  const bool late = is_late(when);
  for (std::size_t t = from; t < to; ++t) {
    const PixelChainDrive d = ports.drive(t);
    const PixelChainPorts p = ports.ports(t);
    if (d.in_valid && p.in_ready) {
      PixelFragment f = drawn;
      f.x = static_cast<std::uint32_t>(ports.in_field(t, "in", "x"));
      f.y = static_cast<std::uint32_t>(ports.in_field(t, "in", "y"));
      all.push_back(f);
      reads.push_back(drawn_reads);
    }
    if (d.draw_valid && p.draw_ready) {
      const bool quad = ports.in_field(t, "draw", "bilinear") != 0;
      drawn.texels = ports.in_field(t, "draw", "textured") == 0 ? 0 : quad ? 15 : 1;
      drawn.writes_z = ports.in_field(t, "draw", "write_z") != 0;
      drawn.writes_color = ports.in_field(t, "draw", "write_color") != 0;
      drawn_reads = reads_of(config, ports, t);
      drawn.is_stencilled = late && ports.in_field(t, "draw", "stencil_test") != 0;
    }
    if ((p.records & 1) != 0) {
      const std::size_t f = late ? second.at(tested++) : tested++;
      all.at(f).passes = ports.out_field(t, "depth_record", "pass") != 0;
      all[f].goes_on = all[f].passes;
      if (all[f].passes && !late) second.push_back(f);
      if (all[f].is_stencilled) stencilled.push_back(f);
    }
    if ((p.records & 16) != 0) {
      PixelFragment& f = all.at(stencilled.at(judged++));
      f.goes_on = f.passes && ports.out_field(t, "stencil_record", "pass") != 0;
      f.writes_stencil =
          ports.out_field(t, "stencil_record", "value") != ports.out_field(t, "stencil_record", "stored");
    }
    if ((p.records & 32) != 0) {
      PixelFragment& f = all.at(late ? levelled : second.at(levelled));
      ++levelled;
      // The texels of the next level.
      const bool mixed = ports.out_field(t, "lod_record", "f") != 0;
      if (mixed) f.texels = static_cast<PortSet>(f.texels | f.texels << level_texel_ports);
    }
    if ((p.records & 2) != 0) {
      const std::size_t f = late ? textured++ : second.at(textured++);
      all.at(f).lives = ports.out_field(t, "texture_record", "killed") == 0;
      const std::int64_t alpha =
          Rtl::from_port(ports.out_field(t, "texture_record", "a"), config.format(FormatId::texture_alpha));
      all[f].reads_color = alpha < one ? reads[f].translucent : reads[f].opaque;
      if (all[f].lives && late) second.push_back(f);
    }
  }
  return all;
}

struct Compared {
  std::size_t clocks = 0, fragments = 0;
  // Clocks on which a port was stalled, a fragment refused, an answer not taken, a draw state refused.
  std::size_t stalled = 0, refused = 0, answers_wait = 0, draws_wait = 0;
};

std::string text_of(const PixelChainPorts& p) {
  return fmt::format("draw {} in {} idle {} requests {:010b} answers {:010b} writes {:02b} records {:06b}",
                     int{p.draw_ready}, int{p.in_ready}, int{p.idle}, p.request_valid, p.answer_ready,
                     p.write_valid, p.records);
}

// Replays a recorded run through the timing; throws std::logic_error at the first clock that differs. A trace
// does not have what fragments come to that are in flight at a reset, so the clocks in front of it are left
// out.
Compared replay(const Config& config, DepthWhen when, const StageTrace& trace, const PixelTiming& timing) {
  const TracePorts ports(config, when, trace);
  Compared out;
  std::vector<std::size_t> ends = trace.resets;
  ends.push_back(trace.inputs.size());
  std::size_t from = 0;
  for (const std::size_t to : ends) {
    const std::vector<PixelFragment> fragments = fragments_of(config, when, ports, from, to);
    PixelChainTiming chain(timing, when);
    std::size_t next = 0;
    constexpr std::size_t in_flight = 64;
    const std::size_t known = to == ends.back() ? to : std::max(from, to - std::min(to, in_flight));
    for (std::size_t t = from; t < known; ++t) {
      const PixelChainDrive d = ports.drive(t);
      const PixelChainPorts expected = ports.ports(t);
      const bool in_ready = chain.in_ready();
      const bool draw_ready = chain.draw_ready();
      const PixelFragment none;
      const PixelChainPorts got = chain.clock(d, next < fragments.size() ? fragments[next] : none).ports;
      if (got != expected || in_ready != expected.in_ready || draw_ready != expected.draw_ready) {
        throw std::logic_error(
            fmt::format("clock {}: {}\n   expected: {}", t - from, text_of(got), text_of(expected)));
      }
      next += d.in_valid && got.in_ready ? 1 : 0;
      out.stalled += (got.request_valid & ~d.request_ready) != 0 || (got.write_valid & ~d.write_ready) != 0;
      out.refused += d.in_valid && !got.in_ready;
      out.answers_wait += (d.answer_valid & ~got.answer_ready) != 0;
      out.draws_wait += d.draw_valid && !got.draw_ready;
    }
    if (to == trace.inputs.size() && !chain.empty()) throw std::logic_error("fragments are left inside");
    out.clocks += to - from;
    out.fragments += next;
    from = to;
  }
  return out;
}

Compared run_and_replay(const PipeCase& p, const PipeWay& way) {
  StageTrace trace;
  run_pipe(p, way, &trace);
  return replay(p.config, p.when, trace, pixel_timing(p.config));
}

// An ideal memory, one of fixed latency, ones of random latency; with gaps and stalls.
std::vector<PipeWay> ways(std::uint64_t seed) {
  return {{0, {}, {1, 1}, seed},
          {0, {}, {7, 7}, seed},
          {0, {}, {40, 40}, seed},
          {0, {}, {1, 30}, seed},
          {0.3, {0.2, 0.3}, {1, 1}, seed},
          {0.1, {0.4, 0.6}, {1, 25}, seed},
          {0, {0, 0.9}, {1, 3}, seed},
          // Behind slow writes all queues are full: killed fragments meet a fog that takes none.
          {0, {}, {1, 1}, seed, 0, true, 0.8},
          // The same in front of the depth memory.
          {0, {}, {1, 1}, seed, 0, true, 0, 0.9}};
}

TEST(PixelChainTiming, EqualsTheRtlOnEveryClock) {
  Compared all;
  Compared late;
  const auto check = [&](const Config& c, std::uint64_t seed) {
    for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
      SCOPED_TRACE(to_string(when));
      Random random(seed);
      const PipeCase small = random_pipe_case(random, c, 300, {}, when);
      const PipeCase large =
          random_pipe_case(random, c, 200, {.width = 700, .height = 90, .textures = {{4, 4}}}, when);
      for (const PipeWay& way : ways(seed)) {
        for (const PipeCase* p : {&small, &large}) {
          const Compared r = run_and_replay(*p, way);
          Compared& sum = is_late(when) ? late : all;
          sum.clocks += r.clocks;
          sum.fragments += r.fragments;
          sum.stalled += r.stalled;
          sum.refused += r.refused;
          sum.answers_wait += r.answers_wait;
          sum.draws_wait += r.draws_wait;
        }
      }
    }
  };
  for (Config c : shipped_configs()) {
    SCOPED_TRACE(c.name);
    check(c, 9);
    c.rtl.blend = RtlBlend::equation;
    check(c, 9);
  }
  for (const Config& c : level_configs()) {
    SCOPED_TRACE(fmt::format("mip {}, lod {}", to_string(c.mip), to_string(c.lod)));
    check(c, 9);
  }
  for (const std::uint64_t seed : stage_seeds(4)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check(random_stage_config(seed), seed);
  }
  for (const Compared& sum : {all, late}) {
    EXPECT_GT(sum.clocks, 300000U);
    EXPECT_GT(sum.fragments, 30000U);
    EXPECT_GT(sum.stalled, 30000U);
    EXPECT_GT(sum.refused, 30000U);
    EXPECT_GT(sum.answers_wait, 1000U);
    EXPECT_GT(sum.draws_wait, 10000U);
  }
}

// The demo: one fragment per clock, and so many at once that the FIFOs fill.
TEST(PixelChainTiming, EqualsTheRtlWhereFragmentsFollowOneAnother) {
  std::vector<Config> configs = shipped_configs();
  configs.push_back(shipped_config("depth16"));
  configs.back().depth_code = DepthCode::linear;
  configs.back().fog = FogMode::linear;
  configs.back().filter = TextureFilter::bilinear;
  configs.push_back(shipped_config("depth16"));
  configs.back().memory.latency = 60;
  configs.push_back(shipped_config("depth16"));
  configs.back().rtl.blend = RtlBlend::equation;
  configs.push_back(level_configs()[2]);
  configs.push_back(shipped_config("depth16"));
  configs.back().fog = FogMode::vertex;
  for (const Config& c : configs) {
    for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
      const PipeCase p = make_pipe_case(c, demo_scene(96, 72), when);
      for (const PipeWay& way : ways(4)) {
        SCOPED_TRACE(fmt::format("{} {} latency {} to {}", c.name, to_string(when), way.latency.least,
                                 way.latency.most));
        EXPECT_GT(run_and_replay(p, way).fragments, 3000U);
      }
    }
  }
}

TEST(PixelChainTiming, EqualsTheRtlFromResetOnAndAfterAResetAmidFragments) {
  for (const auto& [when, blend] : {std::pair{DepthWhen::early, RtlBlend::alpha},
                                    {DepthWhen::early, RtlBlend::equation},
                                    {DepthWhen::late, RtlBlend::alpha}}) {
    Config c = shipped_config("depth16");
    c.rtl.blend = blend;
    Random random(31);
    const PipeCase p = random_pipe_case(random, c, 100, {}, when);
    for (const int clocks : {2, 20, 60, 150}) {
      SCOPED_TRACE(clocks);
      EXPECT_GT(run_and_replay(p, {0.1, {0.2, 0.2}, {1, 20}, 7, clocks}).fragments, 200U);
      // Fragments wait for the places to be cleared.
      const Compared r = run_and_replay(p, {0.1, {0.2, 0.2}, {1, 20}, 7, clocks, false});
      // Late, texture takes some, and the next draw state waits for them.
      EXPECT_GT(r.refused + (is_late(when) ? r.draws_wait : 0), 300U);
    }
  }
}

using Changes = std::vector<std::pair<const char*, std::function<void(PixelTiming&, int)>>>;

// A wrong number of the configuration's is seen on some clock.
void expect_every_number_seen(const Config& c, DepthWhen when, const Changes& changes) {
  Random random(5);
  // Draw states and places that change often; FIFOs that fill.
  const PipeCase changing = random_pipe_case(random, c, 400, {.width = 700, .height = 90}, when);
  const PipeCase rows = make_pipe_case(c, demo_scene(96, 72), when);
  std::array<StageTrace, 2> traces;
  run_pipe(changing, {0, {}, {1, 1}, 1}, traces.data());
  run_pipe(rows, {0, {}, {90, 90}, 1}, &traces[1]);
  const PixelTiming right = pixel_timing(c);
  for (const StageTrace& trace : traces) EXPECT_NO_THROW(replay(c, when, trace, right));
  for (const auto& [what, change] : changes) {
    for (const int by : {-1, 1}) {
      PixelTiming wrong = right;
      change(wrong, by);
      const auto differs = [&](const StageTrace& trace) {
        try {
          replay(c, when, trace, wrong);
          return false;
        } catch (const std::logic_error&) {
          return true;
        }
      };
      EXPECT_TRUE(std::ranges::any_of(traces, differs)) << what << " by " << by;
    }
  }
}

TEST(PixelChainTiming, EveryNumberIsSeen) {
  Config c = shipped_config("depth16");
  c.depth_code = DepthCode::linear;
  const Changes of_both{{"in_flight", [](PixelTiming& t, int by) { t.in_flight += by; }},
                        {"depth.code", [](PixelTiming& t, int by) { t.depth.code += by; }},
                        {"texture.address", [](PixelTiming& t, int by) { t.texture.address += by; }},
                        {"texture.color", [](PixelTiming& t, int by) { t.texture.color += by; }},
                        {"fog.clocks", [](PixelTiming& t, int by) { t.fog.clocks += by; }},
                        {"merge.clocks", [](PixelTiming& t, int by) { t.merge.clocks += by; }},
                        {"place_bits", [](PixelTiming& t, int by) { t.place_bits += by; }},
                        {"slot_bits", [](PixelTiming& t, int by) { t.slot_bits += by; }}};
  expect_every_number_seen(c, DepthWhen::early, of_both);
  Changes of_late = of_both;
  of_late.push_back({"stencil.clocks", [](PixelTiming& t, int by) { t.stencil.clocks += by; }});
  expect_every_number_seen(c, DepthWhen::late, of_late);
  for (const DepthWhen when : {DepthWhen::early, DepthWhen::late}) {
    expect_every_number_seen(level_configs()[2], when,
                             {{"lod.clocks", [](PixelTiming& t, int by) { t.lod.clocks += by; }},
                              {"texture.address", [](PixelTiming& t, int by) { t.texture.address += by; }},
                              {"texture.color", [](PixelTiming& t, int by) { t.texture.color += by; }},
                              {"texture.shade", [](PixelTiming& t, int by) { t.texture.shade += by; }},
                              {"slot_bits", [](PixelTiming& t, int by) { t.slot_bits += by; }}});
  }
}

// Bugs of the RTL that cost clocks and change no value: the records stay right, and the clocks show them.
TEST(PixelChainTiming, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/scoreboard.sv", "assign know = hold || !known_valid_q;", "assign know = hold;"},
      {"rtl/scoreboard.sv", "assign look = know || !looked_valid_q;", "assign look = know;"},
      {"rtl/pixel_pipe.sv", "draw_ready_o <= none[next_slot] && settled_q && !draw_taken;",
       "draw_ready_o <= (&none) && settled_q && !draw_taken;"},
      {"rtl/depth.sv", "assign join_valid = rest_valid && z_valid && answer_valid;",
       "assign join_valid = rest_valid && z_valid && answer_valid && !compared_q;"},
      {"rtl/texture.sv", "assign ask_taken = &(~wanted | asked_q | request_ready);",
       "assign ask_taken = &(~wanted | asked_q | request_ready) && asked_valid == join_taken;"},
      {"rtl/merge.sv", "assign join_valid = rest_valid && (answer_valid || !waited_reads);",
       "assign join_valid = rest_valid && (answer_valid || !waited_reads) && !gen_by_alpha.valid_q[0];"},
  };
  constexpr PlantedBug bugs_of_equations[] = {
      {"rtl/merge.sv", "assign join_valid = rest_valid && (answer_valid || !waited_reads);",
       "assign join_valid = rest_valid && (answer_valid || !waited_reads) && !gen_equation.valid_q;"},
  };
  constexpr PlantedBug late_bugs[] = {
      {"rtl/pixel_pipe.sv", "assign textured_ready = depth_ready || killed;",
       "assign textured_ready = depth_ready;"},
      {"rtl/pixel_pipe.sv", "assign fate_write[1] = judged_stencil != stencil_record_stored_o;",
       "assign fate_write[1] = judged_test;"},
  };
  constexpr PlantedBug of_levels[] = {
      {"rtl/texture.sv", "assign ask_taken = &(~wanted | asked_q | request_ready);",
       "assign ask_taken = &(~wanted | asked_q | request_ready) && (!ask_next || asked_q[0]);"},
      {"rtl/texture.sv", ".d_i(in_f_i != '0),",
       ".d_i(in_f_i != '0 || in_level_i == '0 && in_last_i_i != '0),"},
  };
  const RtlCopy copy;
  // Where memories are slow, and where depth codes alone are written late.
  const PipeWay slow{0.1, {0.2, 0.3}, {1, 25}, 5};
  const PipeWay late_writes{0, {}, {1, 1}, 5, 0, true, 0, 0.9};
  const auto see = [&](const PipeCase& p, const PipeWay& way, std::span<const PlantedBug> planted) {
    EXPECT_NO_THROW(run_and_replay(p, way));
    for (const PlantedBug& bug : in_gate(planted)) {
      SCOPED_TRACE(bug.to);
      copy.replace(bug.file, bug.from, bug.to);
      StageTrace trace;
      EXPECT_NO_THROW(run_pipe(p, way, &trace));
      EXPECT_THROW(replay(p.config, p.when, trace, pixel_timing(p.config)), std::logic_error);
      copy.replace(bug.file, bug.to, bug.from);
    }
  };
  Random random(5);
  see(random_pipe_case(random, shipped_config("depth16"), 1500), slow, bugs);
  see(random_pipe_case(random, shipped_config("depth16"), 1500, {}, DepthWhen::late), late_writes, late_bugs);
  Config by_equation = shipped_config("depth16");
  by_equation.rtl.blend = RtlBlend::equation;
  see(random_pipe_case(random, by_equation, 1500), slow, bugs_of_equations);
  see(random_pipe_case(random, level_configs()[2], 1500), slow, of_levels);
}

}  // namespace
}  // namespace bitspan
