// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_rotate_sv.hpp"

#include "config/rotate.hpp"
#include "engine/sv_writer.hpp"

namespace bitspan {
namespace {

// The product and its rounding (rtl/multiply_round.sv), and the sum.
int lift_clocks(const Config& config) { return config.rtl.product_clocks + 4 + 1; }

}  // namespace

// A register in front, one behind, and the skid.
int rotate_clocks(const Config& config) { return 3 * lift_clocks(config) + 3; }

std::string emit_rotate_sv(const Config& config) {
  const RotateFormats formats = rotate_formats(config);
  check_rotate(formats, 8);
  SvWriter w;
  w.line("// Generated from configuration " + config_hash(config) + "; do not edit.");
  w.line("// Formats are named as in bitspan_cfg_pkg.");
  w.line("/* verilator lint_off UNUSED */");
  w.line("package bitspan_rotate_pkg;");
  w.format("RotateT", formats.t);
  w.format("RotateS", formats.s);
  w.format("RotateXy", formats.xy);
  w.integer("ProductClocks", config.rtl.product_clocks);
  w.integer("RotateLiftClocks", lift_clocks(config));
  w.line("endpackage");
  w.line("/* verilator lint_on UNUSED */");
  return w.text;
}

}  // namespace bitspan
