// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_project_sv.hpp"

#include <utility>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/rtl_timing.hpp"
#include "engine/sv_writer.hpp"

namespace bitspan {

std::string emit_project_sv(const Config& config) {
  if (!has_project(config.project)) {
    throw InputError(config.name + ": project.unit is none; the RTL of project needs reciprocal");
  }
  const ProjectTiming timing = project_timing(config);
  const Grid operand = project_operand(config);
  check_operand(operand, "reciprocal.pixel, as project has it");
  SvWriter w;
  w.line("// Generated from configuration " + config_hash(config) + "; do not edit.");
  w.line("// Formats are named as in bitspan_cfg_pkg.");
  w.line("/* verilator lint_off UNUSED */");
  w.line("package bitspan_project_pkg;");
  for (const auto& [name, id] : {std::pair{"SetupB", FormatId::setup_b},
                                 {"SpanH", FormatId::span_h},
                                 {"SpanUv", FormatId::span_uv},
                                 {"DistanceA", FormatId::distance_a},
                                 {"ProjectValue", FormatId::project_value},
                                 {"ProjectRatio", FormatId::project_ratio},
                                 {"ProjectH", FormatId::project_h}}) {
    w.format(name, config.format(id));
  }
  w.format("DepthZ", config.depth_format());
  w.line("  // The code is that of zmax - h_p.");
  w.integer("DepthIsComplement", is_complement_of_h(config.depth_code) ? 1 : 0);
  w.integer("TextureSideW", texture_side_bits);
  w.integer("ExponentW", exponent_bits);
  const Grid sum = as_signed(pixel_operand(config));
  w.line("");
  w.line("  // h + B as a signed number, and R_project of W.");
  w.integer("DepthSumW", sum.bits());
  w.integer("DepthSumFrac", sum.fraction);
  w.reciprocal("ProjectRecip", config.pixel_reciprocal, operand);
  w.integer("ProductClocks", config.rtl.product_clocks);
  w.integer("NormaliseClocks", config.rtl.normalise_clocks);
  w.integer("ProjectUnitClocks", timing.unit);
  w.integer("ProjectPlaceProductClocks", timing.place_product);
  w.integer("ProjectRatioProductClocks", timing.ratio_product);
  w.integer("ProjectCodeProductClocks", timing.code_product);
  w.integer("ProjectClocks", timing.clocks);
  w.line("endpackage");
  w.line("/* verilator lint_on UNUSED */");
  return w.text;
}

}  // namespace bitspan
