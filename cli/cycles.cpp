// SPDX-License-Identifier: Apache-2.0
#include "cli/cycles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "model/timed/engine_systemc.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan {
namespace {

// The records that the span interpolator was fed, at the RTL's ports.
std::vector<RtlInputs> inputs_of(const Config& config, const Trace& trace, std::int64_t b) {
  std::vector<RtlInputs> out;
  for (const RowRecord& row : trace.row) {
    out.push_back(rtl_inputs(config, row, b));
  }
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
  systemc->draw({}, 0, &trace);  // delivers the constants
  const std::int64_t b = trace.constants.at(0).b;
  const std::size_t all = std::min(triangles, scene.triangles.size());
  for (std::size_t first = 0; first < all; first += slice_triangles) {
    trace.clear();
    const std::size_t recorded = systemc->handshake().size();
    const std::span<const Triangle> slice(scene.triangles.data() + first,
                                          std::min(slice_triangles, all - first));
    systemc->draw(slice, static_cast<std::int64_t>(first), &trace);
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

}  // namespace bitspan
