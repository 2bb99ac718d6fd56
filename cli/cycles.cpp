// SPDX-License-Identifier: Apache-2.0
#include "cli/cycles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include "config/lines.hpp"
#include "config/modes.hpp"
#include "model/timed/engine_systemc.hpp"
#include "tb/engine_rtl.hpp"
#include "tb/rtl_pixels.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan {
namespace {

// The records that the span interpolator was fed, at the RTL's ports.
std::vector<RtlInputs> inputs_of(const Config& config, const Trace& trace, std::int64_t b) {
  std::vector<RtlInputs> out;
  std::size_t line = 0;
  for (const RowRecord& row : trace.row) {
    for (; line < trace.line_walk.size() && trace.line_walk[line].triangle < row.triangle; ++line) {
      out.push_back(rtl_inputs(config, trace.line_walk[line], b));
    }
    out.push_back(rtl_inputs(config, row, b));
  }
  for (; line < trace.line_walk.size(); ++line) out.push_back(rtl_inputs(config, trace.line_walk[line], b));
  std::size_t plane = 0;
  for (const PlaneRowRecord& row : trace.plane_row) {
    while (trace.plane.at(plane).triangle != row.triangle) {
      ++plane;
    }
    out.push_back(rtl_inputs(config, row, trace.plane[plane].k, b));
  }
  return out;
}

struct NamedField {
  const char* name;
  std::int64_t FragmentRecord::*member;
};
constexpr std::array<NamedField, 8> pixel_fields{{{"last", &FragmentRecord::last},
                                                  {"h", &FragmentRecord::h},
                                                  {"fu", &FragmentRecord::fu},
                                                  {"fv", &FragmentRecord::fv},
                                                  {"recip_m", &FragmentRecord::recip_m},
                                                  {"recip_e", &FragmentRecord::recip_e},
                                                  {"u", &FragmentRecord::u},
                                                  {"v", &FragmentRecord::v}}};

// What the two sides say of one clock, where they differ.
std::string port_differences(const ChainClock& model, const RtlSample& rows, const PixelChainPorts& rtl) {
  std::string text;
  const auto bit = [&](std::string_view what, bool of_model, bool of_rtl) {
    if (of_model == of_rtl) return;
    text += fmt::format("{}{} is {} in systemc, {} in rtl", text.empty() ? "" : "; ", what, int{of_model},
                        int{of_rtl});
  };
  bit("in_ready of span_setup", model.rows.in_ready, rows.in_ready != 0);
  bit("out_valid of span", model.rows.out_valid, rows.out_valid != 0);
  bit("draw_ready", model.ports.draw_ready, rtl.draw_ready);
  bit("in_ready of depth", model.ports.in_ready, rtl.in_ready);
  bit("idle", model.ports.idle, rtl.idle);
  constexpr std::array<std::string_view, read_ports> names{"z",      "color",  "texel0", "texel1", "texel2",
                                                           "texel3", "texel4", "texel5", "texel6", "texel7"};
  constexpr std::array<std::string_view, 6> taps{"depth", "texture", "fog", "merge", "stencil", "lod"};
  const auto each = [&](auto list, std::size_t count, const char* what, unsigned of_model, unsigned of_rtl) {
    for (std::size_t p = 0; p < count; ++p) {
      bit(fmt::format("{}{}", list[p], what), (of_model >> p & 1) != 0, (of_rtl >> p & 1) != 0);
    }
  };
  each(names, read_ports, "_request_valid", model.ports.request_valid, rtl.request_valid);
  each(names, read_ports, "_answer_ready", model.ports.answer_ready, rtl.answer_ready);
  each(names, write_ports, "_write_valid", model.ports.write_valid, rtl.write_valid);
  each(taps, taps.size(), "_record_valid", model.ports.records, rtl.records);
  return text;
}

bool transfers(const PixelChainDrive& drive, const PixelChainPorts& ports) {
  return ports.records != 0 || (drive.in_valid && ports.in_ready) || (drive.draw_valid && ports.draw_ready) ||
         (drive.request_ready & ports.request_valid) != 0 || (drive.answer_valid & ports.answer_ready) != 0 ||
         (drive.write_ready & ports.write_valid) != 0;
}

// The two designs in RTL beside the timed model, which drives both with what its own clock had. The readiness
// of the pixel stages reaches the interpolator as the model's; that the RTL's is the same is what is
// compared.
class ChainBeside {
 public:
  // chains: the pixel stages for early tests, and for late ones where the scene has them.
  ChainBeside(const Config& config, const Scene& scene, Rtl& rtl, std::span<RtlPixels* const> chains,
              ChainVerdict& verdict)
      : config_(config),
        scene_(scene),
        rtl_(rtl),
        chains_(chains),
        pixels_(chains.front()),
        verdict_(verdict),
        pipeline_(model::make_pipeline(config, scene)),
        frame_(model::cleared_frame(pipeline_, scene)),
        state_(pipeline_.first) {
    rtl_.reset();
    // The scoreboards' places are cleared; the timed model's frame begins behind that.
    const int sweep = (1 << pixel_timing(config).place_bits) + 4;
    for (RtlPixels* chain : chains_) {
      chain->begin(pipeline_, scene, frame_);
      for (int i = 0; i < sweep; ++i) chain->clock({}, nullptr, counters_);
    }
  }

  Trace& trace() { return trace_; }
  // Behind the last of `triangles` triangles.
  const Frame& finished_frame(std::size_t triangles) {
    execute_before(triangles == scene_.triangles.size() ? triangles + 1 : triangles);
    return frame_;
  }

  void clock(const ChainClock& model) {
    if (verdict_.differences != 0) return;
    rows_.in_valid = model.rows.in_valid;
    rows_.out_ready = model.rows.out_ready;
    if (model.rows.in_valid && !row_stands_) offer_row();
    RtlSample sample{};
    rtl_.clock(rows_, sample);
    const bool has_pixel = model.rows.out_valid && sample.out_valid != 0;
    if (has_pixel) stand(sample.pixel);
    const bool offers = has_pixel && (model.drive.draw_valid || model.drive.in_valid);
    const PixelChainPorts ports = pixels_->clock(model.drive, offers ? &pixel_ : nullptr, counters_);
    const std::string text = port_differences(model, sample, ports);
    if (!text.empty()) {
      verdict_.differences = 1;
      verdict_.first = fmt::format("clock {}: {}", clock_, text);
    }
    if (model.rows.in_valid && model.rows.in_ready) take_row();
    if (model.rows.out_valid && model.rows.out_ready) take_pixel();
    verdict_.fragments += model.drive.in_valid && ports.in_ready ? 1 : 0;
    ++clock_;
    const bool pixel_moves = model.rows.out_valid && model.rows.out_ready;
    if (pixel_moves || transfers(model.drive, model.ports)) verdict_.model_cycles = clock_;
    if (pixel_moves || transfers(model.drive, ports)) verdict_.rtl_cycles = clock_;
  }

 private:
  // The scene's commands in front of a triangle. When its first pixel comes, all pixels before it have left.
  void execute_before(std::size_t triangle) {
    for (; next_command_ < scene_.commands.size() && scene_.commands[next_command_].before < triangle;
         ++next_command_) {
      std::visit([&](const auto& what) { run(what); }, scene_.commands[next_command_].what);
    }
  }
  void run(const StateChange& change) {
    state_ = changed_state(state_, change, config_);
    pipeline_.state = state_;  // a masked clear obeys it
    if (state_.stencil_test) need_stencil(frame_);
    // The chain that the state asks for; nothing is inside the other one, which rests.
    RtlPixels* const chain = chains_[is_late(state_.depth_when) ? 1 : 0];
    for (int i = 0; i < rest_clocks && chain != pixels_; ++i) chain->clock({}, nullptr, counters_);
    pixels_ = chain;
    pixels_->set(state_);
  }
  template <class Other>
  void run(const Other& /*what*/) {}  // of scenes that are not compared
  void run(const Clear& clear) { model::clear_planes(pipeline_, frame_, clear); }
  void run(const Target& target) {
    model::select_target(pipeline_, scene_, targets_, target.k, frame_);
    if (state_.stencil_test) need_stencil(frame_);
  }
  // Records are there in the order of their triangles.
  bool is_line_next() const {
    if (next_line_ == trace_.line_walk.size()) return false;
    return next_row_ == trace_.row.size() ||
           trace_.line_walk[next_line_].triangle < trace_.row[next_row_].triangle;
  }
  // The next row, at the RTL's ports, where it stays: B may not change while a row is inside.
  void offer_row() {
    const std::int64_t b = pipeline_.constants.record.b;
    if (is_line_next()) {
      rows_.in = rtl_inputs(config_, trace_.line_walk[next_line_], b);
    } else if (!pipeline_.const_depth_rows) {
      const std::span ends = std::span(trace_.row_channel).subspan(next_end_, channels());
      rows_.in = rtl_inputs(config_, trace_.row[next_row_], b, ends);
    } else {
      const PlaneRowRecord& record = trace_.plane_row[next_row_];
      while (trace_.plane[next_plane_].triangle != record.triangle) ++next_plane_;
      rows_.in = rtl_inputs(config_, record, trace_.plane[next_plane_].k, b);
    }
    row_stands_ = true;
  }
  // The pixel at the output: the RTL's values that the pixel stages take, and what it does not have.
  void stand(const RtlPixel& rtl) {
    if (pixel_stands_) return;
    execute_before(static_cast<std::size_t>(trace_.fragment[next_pixel_].triangle) + 1);
    const FragmentRecord values = fragment_record(config_, rtl);
    pixel_.record = trace_.fragment[next_pixel_];
    pixel_.record.h = values.h;
    pixel_.record.u = values.u;
    pixel_.record.v = values.v;
    if (config_.rtl.shades) {
      pixel_.record.r = values.r;
      pixel_.record.g = values.g;
      pixel_.record.b = values.b;
      pixel_.record.a = values.a;
    }
    if (has_lod_gradients(config_)) {
      gradient_ = gradient_of(pixel_.record.triangle);
      pixel_.gradient = &gradient_;
    }
    const Triangle& triangle = scene_.triangles[static_cast<std::size_t>(pixel_.record.triangle)];
    pixel_.texture = std::max(triangle.texture, -1);
    model::FragmentChannels own{};
    for (std::size_t c = 0; c < channels(); ++c) {
      own[c] = trace_.fragment_channel[next_channel_ + c];
      // A row of constant depth is offered before the record with a channel's start is there.
      if (!pipeline_.const_depth_rows) take_channel(config_, rtl, own[c]);
    }
    FragmentRecord drawn;
    const std::int64_t h = pixel_.record.h;
    pixel_.record = model::as_drawn(pipeline_.channels, pixel_.record, &own, drawn);
    pixel_.line = std::exchange(pixel_.record.h, h);
    if (has_vertex_fog(pipeline_.fog.mode)) pixel_.factor = model::channel_value(own, LineId::fog);
    pixel_.back = state_.stencil_test && model::is_back_face(pipeline_.setup, triangle);
    pixel_stands_ = true;
  }
  // The gradients of a triangle; setup has delivered them. Pixels come in the order of their triangles.
  const GradientRecord& gradient_of(std::int64_t triangle) {
    while (trace_.gradient[next_gradient_].triangle != triangle) ++next_gradient_;
    return trace_.gradient[next_gradient_];
  }
  // Records of channels per row, and per pixel.
  std::size_t channels() const { return pipeline_.channels.in_use.size(); }
  // What has been read of the trace is forgotten, so that one draw call may have any number of triangles.
  static constexpr std::size_t kept_records = 1 << 14;
  template <class R>
  static void forget(std::vector<R>& records, std::size_t& next) {
    if (next < kept_records) return;
    records.erase(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(next));
    next = 0;
  }
  void take_row() {
    row_stands_ = false;
    if (is_line_next()) {
      ++next_line_;
      forget(trace_.line_walk, next_line_);
    } else {
      ++next_row_;
    }
    if (pipeline_.const_depth_rows) {
      forget(trace_.plane_row, next_row_);
      forget(trace_.plane, next_plane_);
    } else {
      forget(trace_.row, next_row_);
      next_end_ += channels();
      forget(trace_.row_channel, next_end_);
    }
    trace_.setup.clear();
    trace_.setup_channel.clear();
    trace_.span.clear();
    trace_.span_channel.clear();
  }
  void take_pixel() {
    pixel_stands_ = false;
    ++next_pixel_;
    forget(trace_.fragment, next_pixel_);
    next_channel_ += channels();
    forget(trace_.fragment_channel, next_channel_);
    forget(trace_.gradient, next_gradient_);
    trace_.depth.clear();
    trace_.stencil.clear();
    trace_.lod.clear();
    trace_.texture.clear();
    trace_.fog.clear();
    trace_.merge.clear();
  }

  const Config& config_;
  const Scene& scene_;
  Rtl& rtl_;
  std::span<RtlPixels* const> chains_;
  RtlPixels* pixels_;
  static constexpr int rest_clocks = 8;  // until an empty chain says so
  ChainVerdict& verdict_;
  model::Pipeline pipeline_;
  Frame frame_;
  Targets<Frame> targets_;
  Counters counters_;
  Trace trace_;
  DrawState state_;
  std::size_t next_row_ = 0, next_line_ = 0, next_plane_ = 0, next_pixel_ = 0, next_gradient_ = 0,
              next_command_ = 0;
  std::size_t next_end_ = 0, next_channel_ = 0;  // of channels
  bool row_stands_ = false, pixel_stands_ = false;
  RtlDrive rows_{};
  RtlPixels::Fragment pixel_;
  GradientRecord gradient_;  // of its triangle
  std::uint64_t clock_ = 0;
};

}  // namespace

CycleVerdict compare_cycles(const Config& config, const Scene& scene, std::size_t triangles) {
  // Triangles a call: bounds the records held; the pipelines drain in between, and the clock goes on.
  constexpr std::size_t slice_triangles = 512;
  CycleVerdict out;
  const auto note = [&](std::string text) {
    ++out.differences;
    if (out.first.empty()) {
      out.first = std::move(text);
    }
  };
  SystemcOptions options;
  options.record_handshake = true;
  const auto systemc = make_systemc(config, options);
  Rtl rtl(config);
  rtl.reset();
  systemc->begin(scene);
  Trace trace;
  const std::size_t all = std::min(triangles, scene.triangles.size());
  for (std::size_t first = 0, count = 0; first < all; first += count) {
    count = std::min(slice_triangles, all - first);
    // B is that of the view, which may not change inside a slice.
    for (const DrawCommand& command : scene.commands) {
      const bool inside = command.before > first && command.before < first + count;
      if (inside && may_change_view(command)) count = command.before - first;
    }
    const std::int64_t b = model::make_constants(config, with_view(view_at(scene, first))).record.b;
    trace.clear();
    const std::size_t recorded = systemc->handshake().size();
    draw_scene(*systemc, scene, first, count, &trace);
    std::vector<RtlHandshake> driven;
    driven.reserve(systemc->handshake().size() - recorded);
    for (std::size_t i = recorded; i < systemc->handshake().size(); ++i) {
      const HandshakeClock& clock = systemc->handshake()[i];
      driven.push_back({clock.in_valid, clock.in_ready, clock.out_valid, clock.out_ready});
    }
    RtlRun run;
    try {
      run = replay_rtl(rtl, inputs_of(config, trace, b), driven);
    } catch (const std::logic_error& error) {
      note(error.what());
      return out;
    }
    const std::size_t clocks = std::min(driven.size(), run.handshakes.size());
    if (clocks != driven.size()) {
      note(fmt::format("the RTL answered on {} of {} clocks", out.clocks + clocks,
                       out.clocks + driven.size()));
    }
    for (std::size_t i = 0; i < clocks; ++i) {
      const RtlHandshake& model = driven[i];
      const RtlHandshake& answer = run.handshakes[i];
      const std::uint64_t clock = out.clocks + i;
      if (model != answer) {
        note(fmt::format("clock {}: systemc in_ready {}, out_valid {}; rtl in_ready {}, out_valid {}", clock,
                         int{model.in_ready}, int{model.out_valid}, int{answer.in_ready},
                         int{answer.out_valid}));
      }
      // The last transfer of a pixel ends the run of either side.
      out.model_cycles = model.out_valid && model.out_ready ? clock + 1 : out.model_cycles;
      out.rtl_cycles = answer.out_valid && answer.out_ready ? clock + 1 : out.rtl_cycles;
      out.spans += static_cast<std::uint64_t>(answer.in_valid && answer.in_ready);
    }
    out.clocks += driven.size();
    if (run.pixels.size() != trace.fragment.size()) {
      note(fmt::format("systemc delivered {} pixels, rtl {}", trace.fragment.size(), run.pixels.size()));
    }
    const std::size_t pixels = std::min(run.pixels.size(), trace.fragment.size());
    for (std::size_t i = 0; i < pixels; ++i) {
      const FragmentRecord rtl_record = fragment_record(config, run.pixels[i]);
      const FragmentRecord& record = trace.fragment[i];
      for (const NamedField& field : pixel_fields) {
        if (rtl_record.*field.member != record.*field.member) {
          note(fmt::format("pixel {} (triangle {}, x {}, y {}): {} is {} in systemc, {} in rtl",
                           out.pixels + i, record.triangle, record.x, record.y, field.name,
                           record.*field.member, rtl_record.*field.member));
        }
      }
    }
    out.pixels += pixels;
  }
  return out;
}

std::vector<ChainVerdict> compare_chain(const Config& config, const Scene& scene, std::uint64_t seed,
                                        std::size_t triangles) {
  if (!rtl_draws_pixels(config, scene) || changes_scene(scene.commands)) return {};
  const PortTiming random{.least = 1, .most = 25, .stall = 0.1, .seed = seed};
  const std::pair<std::string, PortTiming> memories[] = {
      {"ideal memory", {}}, {fmt::format("1 to 25 clocks, stalls, seed {}", seed), random}};
  std::vector<ChainVerdict> out;
  Rtl rtl(config);
  RtlPixels early(config);
  std::unique_ptr<RtlPixels> late;
  std::vector<RtlPixels*> chains{&early};
  if (std::ranges::any_of(states_of(config, scene.commands),
                          [](const DrawState& state) { return is_late(state.depth_when); })) {
    late = std::make_unique<RtlPixels>(config, DepthWhen::late);
    chains.push_back(late.get());
  }
  for (const auto& [name, ports] : memories) {
    ChainVerdict& verdict = out.emplace_back();
    verdict.memory = name;
    try {
      ChainBeside beside(config, scene, rtl, chains, verdict);
      SystemcOptions options;
      options.memory = TimedMemory::ports;
      options.ports = ports;
      options.watch_chain = [&beside](const ChainClock& clock) { beside.clock(clock); };
      const auto systemc = make_systemc(config, options);
      systemc->begin(scene);
      const std::size_t count = std::min(triangles, scene.triangles.size());
      draw_scene(*systemc, scene, 0, count, &beside.trace());
      const Frame& frame = systemc->frame();
      const Frame& rtl_frame = beside.finished_frame(count);
      if (verdict.differences == 0 && (frame.depth != rtl_frame.depth || frame.color != rtl_frame.color ||
                                       frame.stencil != rtl_frame.stencil)) {
        verdict.differences = 1;
        verdict.first = "the pictures of systemc and rtl differ";
      }
    } catch (const std::logic_error& error) {
      verdict.differences = 1;
      verdict.first = error.what();
    }
  }
  return out;
}

ClockCheck check_clocks(const Config& config, const Scene& scene, std::uint64_t seed) {
  constexpr std::size_t few_triangles = 16;
  ClockCheck out;
  const CycleVerdict interpolator = compare_cycles(config, scene, few_triangles);
  out.interpolator_clocks = interpolator.clocks;
  if (interpolator.differences > 0) {
    out.failure = "cycles of the span interpolator, systemc against rtl: " + interpolator.first;
    return out;
  }
  for (const ChainVerdict& chain : compare_chain(config, scene, seed, few_triangles)) {
    out.chain_clocks += chain.rtl_cycles;
    if (chain.differences == 0) continue;
    out.failure = fmt::format("cycles of the chain, systemc against rtl, {}: {}", chain.memory, chain.first);
    return out;
  }
  return out;
}

}  // namespace bitspan
