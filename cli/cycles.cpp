#include "cli/cycles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "model/timed/engine_systemc.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan {
namespace {

// The records that the span interpolator was fed, at the RTL's ports.
std::vector<RtlInputs> inputs_of(const Config& config, const Trace& trace) {
  std::vector<RtlInputs> out;
  const std::int64_t b = trace.constants.at(0).b;
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
  Trace trace;
  systemc->begin(scene);
  systemc->draw({scene.triangles.data(), std::min(triangles, scene.triangles.size())}, 0, &trace);
  const std::vector<RtlInputs> inputs = inputs_of(config, trace);
  std::vector<RtlHandshake> driven;
  driven.reserve(systemc->handshake().size());
  for (const HandshakeClock& clock : systemc->handshake()) {
    driven.push_back({clock.in_valid, clock.in_ready, clock.out_valid, clock.out_ready});
  }
  if (inputs.empty()) {
    return out;
  }
  Rtl rtl(config);
  rtl.reset();
  RtlRun run;
  try {
    run = replay_rtl(rtl, inputs, driven);
  } catch (const std::logic_error& error) {
    note(error.what());
    return out;
  }
  out.clocks = driven.size();
  const std::size_t clocks = std::min(driven.size(), run.handshakes.size());
  if (clocks != driven.size()) {
    note(fmt::format("the RTL answered on {} of {} clocks", clocks, driven.size()));
  }
  for (std::size_t i = 0; i < clocks; ++i) {
    const RtlHandshake& a = driven[i];
    const RtlHandshake& b = run.handshakes[i];
    if (a != b) {
      note(fmt::format("clock {}: systemc in_ready {}, out_valid {}; rtl in_ready {}, out_valid {}", i,
                       int{a.in_ready}, int{a.out_valid}, int{b.in_ready}, int{b.out_valid}));
    }
    // The last transfer of a pixel ends the run of either side.
    out.model_cycles = a.out_valid && a.out_ready ? i + 1 : out.model_cycles;
    out.rtl_cycles = b.out_valid && b.out_ready ? i + 1 : out.rtl_cycles;
    out.spans += static_cast<std::uint64_t>(b.in_valid && b.in_ready);
  }
  out.pixels = std::min(run.pixels.size(), trace.fragment.size());
  if (run.pixels.size() != trace.fragment.size()) {
    note(fmt::format("systemc delivered {} pixels, rtl {}", trace.fragment.size(), run.pixels.size()));
  }
  for (std::size_t i = 0; i < out.pixels; ++i) {
    const FragmentRecord rtl_record = fragment_record(config, run.pixels[i]);
    const FragmentRecord& record = trace.fragment[i];
    for (const NamedField& field : pixel_fields) {
      if (rtl_record.*field.member != record.*field.member) {
        note(fmt::format("pixel {} (triangle {}, x {}, y {}): {} is {} in systemc, {} in rtl", i,
                         record.triangle, record.x, record.y, field.name, record.*field.member,
                         rtl_record.*field.member));
      }
    }
  }
  return out;
}

}  // namespace bitspan
