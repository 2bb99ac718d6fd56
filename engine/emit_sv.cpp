// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_sv.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>
#include <vector>

#include "config/modes.hpp"
#include "config/names.hpp"
#include "config/reciprocal.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {
namespace {

// Width of the exponent ports, signed; reciprocal exponents are asserted to fit.
constexpr int exponent_bits = 8;

// "0 restoring, 1 lut_linear ...": what the numbers of an enumeration stand for.
template <class E>
std::string numbered_names() {
  std::string text;
  for (std::size_t i = 0; i < enum_names<E>.size(); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(i) + " " + std::string(enum_names<E>[i]);
  return text;
}

struct Writer {
  std::string text;

  void line(std::string_view s) {
    text += s;
    text += '\n';
  }
  void integer(const std::string& name, std::int64_t value) {
    line("  localparam int " + name + " = " + std::to_string(value) + ";");
  }
  void format(const std::string& name, const Format& f) {
    integer(name + "W", f.word);
    integer(name + "Frac", f.fraction());
    integer(name + "Signed", f.is_signed ? 1 : 0);
    integer(name + "Rnd", static_cast<int>(f.rounding));
    integer(name + "Ovf", static_cast<int>(f.overflow));
  }
};

void reciprocal(Writer& w, const std::string& name, const Reciprocal& unit, Grid operand) {
  w.line("");
  w.integer(name + "Kind", static_cast<int>(unit.kind));
  w.integer(name + "Normalize", unit.normalize ? 1 : 0);
  w.integer(name + "OpW", operand.bits());
  w.integer(name + "OpFrac", operand.fraction);
  w.integer(name + "OperandBits", unit.operand_bits);
  w.integer(name + "IndexBits", unit.index_bits);
  w.integer(name + "TableBits", unit.table_bits);
  w.integer(name + "InternalBits", unit.internal_bits);
  w.integer(name + "Steps", unit.steps);
  w.integer(name + "BitsPerCycle", std::max(1, unit.bits_per_cycle));
  w.integer(name + "Pipelined", unit.pipelined ? 1 : 0);
  w.format(name + "Out", unit.output);
  const RestoringShape shape = restoring_shape(unit, operand);
  w.integer(name + "Iterations", shape.iterations);
  w.integer(name + "QuotientFrac", shape.fraction);
  // The exponent's range as it is delivered.
  const Exponents exponents = exponents_of(unit, operand);
  w.integer(name + "EMin", exponents.low);
  w.integer(name + "EMax", exponents.high);
  const std::vector<std::int64_t> table = reciprocal_table(unit);
  const int entries = std::max<int>(1, static_cast<int>(table.size()));
  const int bits = unit.table_bits + 1;
  w.integer(name + "TableEntries", entries);
  w.line("  localparam logic [" + std::to_string(entries * bits - 1) + ":0] " + name + "Table =");
  if (table.empty()) {
    w.line("      " + std::to_string(bits) + "'d0;");
    return;
  }
  // Entry 0 in the low bits.
  std::string row = "      {";
  for (std::size_t i = table.size(); i-- > 0;) {
    row += std::to_string(bits) + "'d" + std::to_string(table[i]) + (i == 0 ? "};" : ",");
    if (row.size() > 96) {
      w.line(row);
      row = "       ";
    }
  }
  w.line(row);
}

// A start offset as raw 2^-fraction, exactly: at most the 53 bits of a double's significand, in W bits.
void offset(Writer& w, const std::string& name, const StartOffset& offset, int kept_fraction) {
  std::int64_t raw = 0;
  int fraction = 0;
  if (offset.half_ulp) {
    raw = 1;
    fraction = kept_fraction + 1;
  } else if (offset.value != 0) {
    int exponent = 0;
    raw = static_cast<std::int64_t>(std::ldexp(std::frexp(offset.value, &exponent), 53));
    fraction = 53 - exponent;
    while (raw % 2 == 0) {
      raw /= 2;
      --fraction;
    }
  }
  const auto magnitude = static_cast<std::uint64_t>(std::abs(raw));
  const std::string width = std::to_string(std::bit_width(magnitude) + 1);
  w.line("  localparam int " + name + "W = " + width + ";");
  w.line("  localparam logic signed [" + name + "W-1:0] " + name + "Raw = " + (raw < 0 ? "-" : "") + width +
         "'sd" + std::to_string(magnitude) + ";");
  w.integer(name + "Frac", fraction);
}

void check_operand(Grid g, std::string_view what) {
  constexpr int limit = 1 << (exponent_bits - 1);
  if (g.fraction >= limit || exponents_on(g).high >= limit || g.bits() > limit) {
    throw InputError(std::string(what) + ": the operand needs " + std::to_string(g.bits()) + " bits, " +
                     std::to_string(g.fraction) + " of them fraction bits; the RTL holds fewer than " +
                     std::to_string(limit));
  }
}

}  // namespace

std::string emit_sv(const Config& config) {
  const RtlTiming timing = rtl_timing(config);
  const Grid pixel = pixel_operand(config);
  const Grid row = row_operand(config);
  check_operand(pixel, "reciprocal.pixel");
  check_operand(row, "reciprocal.row");
  const bool const_rows = has_plane_rows(config.perspective);
  if (const_rows && config.format(FormatId::plane_k).fraction() < 1) {
    throw InputError("formats.plane.k: needs at least 1 fraction bit in the RTL");
  }

  Writer w;
  w.line("// Generated by `bitspan config emit-sv` from configuration " + config_hash(config) +
         "; do not edit.");
  w.line("// A format NAME of W bits in all, Frac of them right of the point, has");
  w.line(
      "// NAMEW, NAMEFrac, NAMESigned, NAMERnd (0 RND, 1 RND_ZERO, 2 RND_MIN_INF, 3 RND_INF, 4 RND_CONV, 5 "
      "TRN,");
  w.line("// 6 TRN_ZERO) and NAMEOvf (0 WRAP, 1 SAT, 2 SAT_ZERO, 3 SAT_SYM, 4 WRAP_SM).");
  w.line("/* verilator lint_off UNUSED */");
  w.line("package bitspan_cfg_pkg;");
  w.integer("ConstDepthRows", const_rows ? 1 : 0);
  w.integer("RowSlopeDivide", !const_rows && !shares_reciprocal(config.row_slope) ? 1 : 0);
  w.integer("PixelIndexW", pixel_index_bits(config));
  w.integer("ExponentW", exponent_bits);

  w.line("");
  for (const auto& [name, id] :
       std::initializer_list<std::pair<const char*, FormatId>>{{"SetupB", FormatId::setup_b},
                                                               {"EdgeX", FormatId::edge_x},
                                                               {"EdgeH", FormatId::edge_h},
                                                               {"EdgeUv", FormatId::edge_uv},
                                                               {"PlaneK", FormatId::plane_k},
                                                               {"SpanHStep", FormatId::span_h_step},
                                                               {"SpanH", FormatId::span_h},
                                                               {"SpanFDiff", FormatId::span_f_diff},
                                                               {"SpanFStep", FormatId::span_f_step},
                                                               {"SpanF", FormatId::span_f},
                                                               {"SpanUv", FormatId::span_uv}}) {
    w.format(name, config.format(id));
  }
  w.line(
      "  // The registers that texture coordinates are made of: span.f, or span.uv_acc where they are "
      "linear.");
  w.format("TexAcc", config.format(const_rows ? FormatId::span_uv_acc : FormatId::span_f));
  w.format("TexStep", config.format(const_rows ? FormatId::span_uv_step : FormatId::span_f_step));
  w.line("  // Phase of the digital line: unsigned, fraction only.");
  w.integer("PhaseW", std::max(1, config.format(FormatId::plane_k).fraction()));

  w.line("  // h + B as a signed number, h an edge's or a span's.");
  const Grid edge_sum = depth_sum(config, FormatId::edge_h);
  w.integer("EdgeSumW", as_signed(edge_sum).bits());
  w.integer("EdgeSumFrac", edge_sum.fraction);
  w.integer("SpanSumW", as_signed(pixel).bits());
  w.integer("SpanSumFrac", pixel.fraction);

  w.line("");
  w.line("  // Start offsets: Raw 2^-Frac.");
  offset(w, "OffsetH", config.start_offset.span_h, 0);
  const FormatId kept = const_rows ? FormatId::span_uv : FormatId::span_f;
  offset(w, "OffsetF", config.start_offset.span_f, config.format(kept).fraction());

  w.line("");
  w.line("  // Reciprocal units. Kind: " + numbered_names<ReciprocalKind>() +
         ". Operands are unsigned, OpW bits.");
  reciprocal(w, "RowRecip", config.row_reciprocal, row);
  reciprocal(w, "PixelRecip", config.pixel_reciprocal, pixel);

  const RowDivideShape divide = row_divide_shape(config);
  w.line("");
  w.line("  // Row dividers, for slope form divide.");
  w.integer("RowDivIterations", divide.iterations);
  w.integer("RowDivHFrac", divide.h_fraction);
  w.integer("RowDivFFrac", divide.f_fraction);

  w.line("");
  w.line("  // Clocks; docs/rtl.md.");
  w.integer("RowUnitClocks", timing.row_unit);
  w.integer("PixelUnitClocks", timing.pixel_unit);
  w.integer("SpanSetupClocks", timing.span_setup);
  w.integer("SpanClocks", timing.span);
  w.line("endpackage");
  w.line("/* verilator lint_on UNUSED */");
  return w.text;
}

}  // namespace bitspan
