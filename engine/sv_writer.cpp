// SPDX-License-Identifier: Apache-2.0
#include "engine/sv_writer.hpp"

#include <algorithm>
#include <vector>

#include "config/reciprocal.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {

void SvWriter::line(std::string_view s) {
  text += s;
  text += '\n';
}
void SvWriter::integer(const std::string& name, std::int64_t value) {
  line("  localparam int " + name + " = " + std::to_string(value) + ";");
}
void SvWriter::format(const std::string& name, const Format& f) {
  integer(name + "W", f.word);
  integer(name + "Frac", f.fraction());
  integer(name + "Signed", f.is_signed ? 1 : 0);
  integer(name + "Rnd", static_cast<int>(f.rounding));
  integer(name + "Ovf", static_cast<int>(f.overflow));
}

void SvWriter::reciprocal(const std::string& name, const Reciprocal& unit, Grid operand) {
  line("");
  integer(name + "Kind", static_cast<int>(unit.kind));
  integer(name + "Normalize", unit.normalize ? 1 : 0);
  integer(name + "OpW", operand.bits());
  integer(name + "OpFrac", operand.fraction);
  integer(name + "OperandBits", unit.operand_bits);
  integer(name + "IndexBits", unit.index_bits);
  integer(name + "TableBits", unit.table_bits);
  integer(name + "InternalBits", unit.internal_bits);
  integer(name + "Steps", unit.steps);
  integer(name + "BitsPerCycle", std::max(1, unit.bits_per_cycle));
  integer(name + "Pipelined", unit.pipelined ? 1 : 0);
  format(name + "Out", unit.output);
  const RestoringShape shape = restoring_shape(unit, operand);
  integer(name + "Iterations", shape.iterations);
  integer(name + "QuotientFrac", shape.fraction);
  // The exponent's range as it is delivered.
  const Exponents exponents = exponents_of(unit, operand);
  integer(name + "EMin", exponents.low);
  integer(name + "EMax", exponents.high);
  const std::vector<std::int64_t> entries = reciprocal_table(unit);
  integer(name + "TableEntries", std::max<int>(1, static_cast<int>(entries.size())));
  table(name, entries, unit.table_bits + 1);
}

void SvWriter::root(const std::string& name, const RootUnit& unit) {
  integer(name + "OperandBits", unit.operand_bits);
  integer(name + "IndexBits", unit.index_bits);
  integer(name + "TableBits", unit.table_bits);
  integer(name + "InternalBits", unit.internal_bits);
  integer(name + "Steps", unit.steps);
  table(name, root_table(unit), unit.table_bits + 1);
}

void SvWriter::table(const std::string& name, const std::vector<std::int64_t>& entries, int bits) {
  const int count = std::max<int>(1, static_cast<int>(entries.size()));
  line("  localparam logic [" + std::to_string(count * bits - 1) + ":0] " + name + "Table =");
  if (entries.empty()) {
    line("      " + std::to_string(bits) + "'d0;");
    return;
  }
  std::string row = "      {";
  for (std::size_t i = entries.size(); i-- > 0;) {
    row += std::to_string(bits) + "'d" + std::to_string(entries[i]) + (i == 0 ? "};" : ",");
    if (row.size() > 96) {
      line(row);
      row = "       ";
    }
  }
  line(row);
}

constexpr int operand_limit = 1 << (exponent_bits - 1);

bool fits_operand(Grid g) {
  return g.fraction < operand_limit && exponents_on(g).high < operand_limit && g.bits() <= operand_limit;
}

void check_operand(Grid g, std::string_view what) {
  if (fits_operand(g)) return;
  throw InputError(std::string(what) + ": the operand needs " + std::to_string(g.bits()) + " bits, " +
                   std::to_string(g.fraction) + " of them fraction bits; the RTL holds fewer than " +
                   std::to_string(operand_limit));
}

}  // namespace bitspan
