// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_sv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "config/row_products.hpp"
#include "config/rtl_timing.hpp"
#include "engine/sv_writer.hpp"

namespace bitspan {
namespace {

// A list with an entry per line of the RTL, 32 bits each: NAME[32 * i +: 32] is that of line i. places: how
// many entries there are.
void list(SvWriter& w, const std::string& name, const std::vector<int>& values,
          const std::string& places = "Lines") {
  std::string text;
  for (const int value : values)
    text = fmt::format("32'd{}{}{}", static_cast<std::uint32_t>(value), text.empty() ? "" : ", ", text);
  w.line(fmt::format("  localparam logic [32*{}-1:0] {} = {{{}}};", places, name, text));
}

// The formats of one register of every line; NAMEAt is where it begins where all stand side by side, which
// take LinesNAMEW bits. behind: formats that follow those of the lines.
void formats(SvWriter& w, const std::string& name, std::vector<Format> lines,
             const std::vector<Format>& behind = {}) {
  int lines_bits = 0;
  for (const Format& line : lines) lines_bits += line.word;
  lines.insert(lines.end(), behind.begin(), behind.end());
  const std::string places = behind.empty() ? "Lines" : fmt::format("(Lines+{})", behind.size());
  const auto each = [&](const char* what, const auto& value) {
    std::vector<int> values;
    for (const Format& line : lines) values.push_back(static_cast<int>(value(line)));
    list(w, "Line" + name + what, values, places);
  };
  each("W", [](const Format& f) { return f.word; });
  each("Frac", [](const Format& f) { return f.fraction(); });
  each("Signed", [](const Format& f) { return f.is_signed; });
  each("Rnd", [](const Format& f) { return f.rounding; });
  each("Ovf", [](const Format& f) { return f.overflow; });
  int bits = 0;
  each("At", [&](const Format& f) { return std::exchange(bits, bits + f.word); });
  w.integer("Lines" + name + "W", lines_bits);
}

// The lines, behind the multipliers, whose products they take.
void lines_section(SvWriter& w, const Config& config, const RowSchedule& schedule) {
  const RtlLines lines(config);
  const RowMultipliers m = row_multipliers(config, schedule);
  w.line("");
  w.line(
      "  // Lines: h, u, v, and the shades where there are some. A list has 32 bits per line, line 0 "
      "lowest.");
  w.integer("Lines", static_cast<std::int64_t>(lines.size()));
  w.integer("LineFu", static_cast<int>(LineId::fu));
  const auto registers_of = [&](const auto& ids, const auto& id_of) {
    std::vector<Format> all;
    for (const LineId line : ids) all.push_back(config.format(id_of(line_of(line, config.perspective))));
    return all;
  };
  const auto registers = [&](const std::string& name, const auto& id_of) {
    formats(w, name, registers_of(lines, id_of));
  };
  w.line("  // At a row's ends; the slope along the row; the register that adds it up.");
  registers("End", [](const Line& line) { return line.edge.kept; });
  registers("Step", [](const Line& line) { return line.row.step; });
  std::vector<int> divided;
  for (const LineId line : lines) {
    const bool divides = line_of(line, config.perspective).span_divides;
    divided.push_back(!divides ? 0 : divided.back() == 1 ? 2 : 1);
  }
  w.line(
      "  // Channels that span divides: 1 and 2 are the first and the second one of a pair. 0: the others.");
  list(w, "LineDivided", divided);
  std::vector<LineId> channels;
  for (const int channel : ChannelList(config)) channels.push_back(channel_line(channel));
  if (!channels.empty())
    w.line("  // The last lines are channels; behind the registers stands what a pixel has of these.");
  formats(w, "Acc", registers_of(lines, [](const Line& line) { return line.row.acc; }),
          registers_of(channels, [](const Line& line) { return line.row.kept; }));
  // Slopes have a place even where dividers form them.
  w.line("  // The places of a line's products; those with h + B are -1 where there is none.");
  const auto products = [&](const std::string& name, int LineProducts::*product, bool always) {
    std::vector<int> places;
    for (const LineId line : lines) {
      const int place = products_of(line).*product;
      places.push_back(always || (place >= 0 && schedule.slot(place).tick >= 0) ? place : -1);
    }
    list(w, name, places);
  };
  products("LineDiff", &LineProducts::diff, false);
  products("LineLeft", &LineProducts::left, false);
  products("LineSlope", &LineProducts::slope, true);
  products("LineStart", &LineProducts::start, true);
  products("LineSlope1", &LineProducts::slope1, true);
  w.line("  // Fraction bits of a divider's quotient, for slope form divide.");
  const RowDivideShape divide = row_divide_shape(config);
  std::vector<int> fractions;
  for (const LineId line : lines) fractions.push_back(divide.fractions[static_cast<std::size_t>(line)]);
  list(w, "LineDivFrac", fractions);
  // Bit by bit: Yosys 0.23 takes part of a list of shifted numbers for 0.
  w.line("  // What is added to a start, on the grid of its sum, RowCW bits per line.");
  std::string offsets;
  int last_start = 1;
  for (const LineId id : lines) {
    const Line line = line_of(id, config.perspective);
    const ExactOffset offset = start_offset(config, line);
    const int up = config.format(line.row.acc).fraction() + m.below - offset.fraction;
    std::string bits;
    for (int bit = m.c - 1; bit >= 0; --bit)
      bits += bit >= up && (offset.raw >> std::min(bit - up, 63)) % 2 != 0 ? '1' : '0';
    offsets = fmt::format("{}'b{}{}{}", m.c, bits, offsets.empty() ? "" : ", ", offsets);
    last_start = std::max(last_start, schedule.slot(products_of(id).start).tick);
  }
  w.line("  localparam logic [RowCW*Lines-1:0] LineOffset = {" + offsets + "};");
  w.line("  // The tick of the last start.");
  w.integer("RowLastStartTick", last_start);
}

// The multipliers' widths, and what each product needs of them: the tick and the multiplier of its slot, and
// how far to the right its exact value is shifted, an exponent not counted.
void multipliers(SvWriter& w, const Config& config, const RowSchedule& schedule) {
  const RowMultipliers m = row_multipliers(config, schedule);
  w.line("");
  w.line("  // Multipliers of span_setup; docs/rtl.md, \"Clocks\".");
  w.integer("RowInterval", schedule.interval);
  w.line("  localparam int RowPhaseW = (RowInterval > 1) ? $clog2(RowInterval) : 1;");
  w.integer("RowMultipliers", m.count);
  w.integer("RowProductTicks", schedule.product);
  w.integer("RowRecipTick", schedule.reciprocal);
  w.integer("RowDivideTick", schedule.divide);
  w.integer("RowAW", m.a);
  w.integer("RowBW", m.b);
  w.integer("RowCW", m.c);
  w.integer("RowSumBelow", m.below);
  w.integer("RowSumW", m.sum);
  w.integer("RowShiftBase", m.shift_base);
  w.integer("RowShiftMax", m.shift_max);
  // Product k stands at place k, 16 bits each; a multiplier of 65535 means that there is no such product.
  // Behind them stand those of the row's Newton unit that take turns with them.
  std::string ticks;
  std::string shifts;
  std::string multiplier;
  const auto add = [](std::string& text, int value) {
    text = fmt::format("16'd{}{}{}", value, text.empty() ? "" : ", ", text);
  };
  const auto place = [&](const RowSchedule::Slot& slot, int shift) {
    add(ticks, std::max(0, slot.tick));
    add(shifts, shift);
    add(multiplier, slot.tick < 0 ? 65535 : slot.multiplier);
  };
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.products); ++i)
    place(schedule.slots[i], m.shifts[i]);
  for (std::size_t k = 0; k < static_cast<std::size_t>(schedule.newton_products); ++k)
    place(schedule.newton[k], 0);
  w.integer("RowProducts", m.products);
  w.integer("RowNewtonProducts", schedule.newton_products);
  w.line("  localparam int RowPlaces = RowProducts + RowNewtonProducts;");
  for (const auto& [name, text] :
       {std::pair{"RowTicks", &ticks}, {"RowShifts", &shifts}, {"RowMultiplierOf", &multiplier}}) {
    w.line(fmt::format("  localparam logic [16*RowPlaces-1:0] {} = {{{}}};", name, *text));
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
  if (has_digital_line(config) && config.format(FormatId::plane_k).fraction() < 1) {
    throw InputError("formats.plane.k: needs at least 1 fraction bit in the RTL");
  }

  SvWriter w;
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
  w.line("  // Pixels follow a digital line: rows of constant depth, or those of lines.");
  w.integer("DigitalLine", has_digital_line(config) ? 1 : 0);
  w.line("  // u and v are linear along a row; or quotients per pixel; or else products with a reciprocal.");
  w.integer("LinearTexture", has_linear_texture(config.perspective) ? 1 : 0);
  w.integer("PixelQuotients", has_pixel_quotients(config.perspective) ? 1 : 0);
  w.line("  // Colour and alpha; where 0, their ports are there, and nothing is behind them.");
  w.integer("Shades", config.rtl.shades ? 1 : 0);
  w.integer("RowSlopeDivide", !const_rows && !shares_reciprocal(form_of(config.row_slope)) ? 1 : 0);
  w.integer("PixelIndexW", pixel_index_bits(config));
  w.integer("ExponentW", exponent_bits);

  w.line("");
  for (const auto& [name, id] :
       std::initializer_list<std::pair<const char*, FormatId>>{{"SetupB", FormatId::setup_b},
                                                               {"EdgeX", FormatId::edge_x},
                                                               {"EdgeH", FormatId::edge_h},
                                                               {"EdgeUv", FormatId::edge_uv},
                                                               {"EdgeShade", FormatId::edge_shade},
                                                               {"PlaneK", FormatId::plane_k},
                                                               {"SpanHStep", FormatId::span_h_step},
                                                               {"SpanH", FormatId::span_h},
                                                               {"SpanFDiff", FormatId::span_f_diff},
                                                               {"SpanFStep", FormatId::span_f_step},
                                                               {"SpanF", FormatId::span_f},
                                                               {"SpanUv", FormatId::span_uv},
                                                               {"SpanShadeStep", FormatId::span_shade_step},
                                                               {"SpanShadeAcc", FormatId::span_shade_acc},
                                                               {"SpanShade", FormatId::span_shade}}) {
    w.format(name, config.format(id));
  }
  w.line(
      "  // The registers that texture coordinates are made of: span.f, or span.uv_acc where they are "
      "linear.");
  w.format("TexAcc", config.format(texture_acc(config)));
  w.format("TexStep", config.format(texture_step(config)));
  w.line("  // Phase of the digital line: unsigned, fraction only.");
  w.integer("PhaseW", std::max(1, config.format(FormatId::plane_k).fraction()));

  w.line("  // h + B as a signed number, h an edge's or a span's.");
  const Grid edge_sum = depth_sum(config, FormatId::edge_h);
  w.integer("EdgeSumW", as_signed(edge_sum).bits());
  w.integer("EdgeSumFrac", edge_sum.fraction);
  w.integer("SpanSumW", as_signed(pixel).bits());
  w.integer("SpanSumFrac", pixel.fraction);

  w.line("");
  w.line("  // Reciprocal units. Kind: " + numbered_names<ReciprocalKind>() +
         ". Operands are unsigned, OpW bits.");
  w.reciprocal("RowRecip", config.row_reciprocal, row);
  w.reciprocal("PixelRecip", config.pixel_reciprocal, pixel);

  w.line("");
  w.line("  // Row dividers, for slope form divide.");
  w.integer("RowDivIterations", row_divide_shape(config).iterations);
  const RestoringShape pixel_divide = pixel_divide_shape(config);
  w.line("  // A pixel's dividers, in hyperbolic.");
  w.integer("PixelDivIterations", pixel_divide.iterations);
  w.integer("PixelDivFrac", pixel_divide.fraction);

  w.line("");
  w.line("  // p = x_first + 1/2 - x_l, signed.");
  w.integer("PreStepW", pre_step(config).bits());
  w.integer("PreStepFrac", pre_step(config).fraction);
  multipliers(w, config, timing.row);
  lines_section(w, config, timing.row);

  w.line("");
  w.line(
      "  // The span record, all fields side by side; above them the lines: their starts, then step0, then "
      "step1");
  w.line("  // of all but h, which has one step.");
  w.line("  localparam int LinesStep1W = LinesStepW - SpanHStepW;");
  w.line(
      "  localparam int SpanRecordW = 2 * PixelIndexW + RowRecipOutW + ExponentW + PhaseW + PlaneKW + 2 * "
      "SpanFDiffW +");
  w.line("      2 * EdgeUvW + LinesAccW + LinesStepW + LinesStep1W;");

  w.line("");
  w.line(
      "  // The ports of shades: four, which are there also where Shades is 0, and above them the channels.");
  w.line("  localparam int NoShades = (Shades != 0) ? 0 : 4;");
  w.line("  localparam int SidesEndW = LinesEndW - EdgeHW - 2 * EdgeUvW + NoShades * EdgeShadeW;");
  w.line("  localparam int SidesAccW = LinesAccW - SpanHW - 2 * TexAccW + NoShades * SpanShadeAccW;");
  w.line("  localparam int SidesStepW = LinesStepW - SpanHStepW - 2 * TexStepW + NoShades * SpanShadeStepW;");
  w.line("  // A pixel has of the channels what stands behind the registers of all lines.");
  w.line("  localparam int LastValue = 2 * Lines - 8 + NoShades;");
  w.line(
      "  localparam int SidesW = 4 * SpanShadeW + LineAccAt[32*LastValue+:32] + LineAccW[32*LastValue+:32] - "
      "LinesAccW;");

  w.line("");
  w.line("  // Clocks; docs/rtl.md.");
  w.integer("ProductClocks", config.rtl.product_clocks);
  w.integer("SharedProductClocks", shared_product_clocks(config.rtl));
  w.integer("ProductDigits", config.rtl.product_digits);
  w.integer("PixelInterval", timing.pixel_interval);
  w.integer("NormaliseClocks", config.rtl.normalise_clocks);
  w.integer("RowUnitClocks", timing.row.unit);
  w.integer("PixelUnitClocks", timing.pixel_unit);
  w.integer("SpanSetupClocks", timing.row.latency);
  w.integer("SpanClocks", timing.span);
  w.integer("SpanFifo", config.rtl.fifo);
  w.line("endpackage");
  w.line("/* verilator lint_on UNUSED */");
  return w.text;
}

}  // namespace bitspan
