// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_curve_sv.hpp"

#include "config/curve.hpp"
#include "engine/sv_writer.hpp"

namespace bitspan {

std::string emit_curve_sv(const Config& config) {
  SvWriter w;
  w.line("// Generated from configuration " + config_hash(config) + "; do not edit.");
  w.line("// Formats are named as in bitspan_cfg_pkg.");
  w.line("/* verilator lint_off UNUSED */");
  w.line("package bitspan_curve_pkg;");
  const CurveFormats formats = curve_formats(config);
  for (std::size_t i = 0; i < formats.size(); ++i) w.format("CurveD" + std::to_string(i), formats[i]);
  w.line("endpackage");
  w.line("/* verilator lint_on UNUSED */");
  return w.text;
}

}  // namespace bitspan
