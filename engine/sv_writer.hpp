// SPDX-License-Identifier: Apache-2.0
// Writes the SystemVerilog packages: formats and reciprocal units by name, as emit_sv and emit_pixel_sv have
// them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "config/grid.hpp"

namespace bitspan {

// Width of the exponent ports, signed; reciprocal exponents are asserted to fit.
inline constexpr int exponent_bits = 8;

// "0 restoring, 1 lut_linear ...": what the numbers of an enumeration stand for.
template <class E>
std::string numbered_names() {
  std::string text;
  for (std::size_t i = 0; i < enum_names<E>.size(); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(i) + " " + std::string(enum_names<E>[i]);
  return text;
}

struct SvWriter {
  std::string text;

  void line(std::string_view s);
  void integer(const std::string& name, std::int64_t value);
  // NAMEW, NAMEFrac, NAMESigned, NAMERnd and NAMEOvf.
  void format(const std::string& name, const Format& f);
  // The parameters of rtl/reciprocal.sv, NAME in front of each.
  void reciprocal(const std::string& name, const Reciprocal& unit, Grid operand);
  // The same of rtl/root.sv.
  void root(const std::string& name, const RootUnit& unit);

 private:
  // NAMETable, entry 0 in the low bits, each of so many.
  void table(const std::string& name, const std::vector<std::int64_t>& entries, int bits);
};

// Whether an operand fits the ports of rtl/reciprocal.sv.
bool fits_operand(Grid operand);
// Throws InputError where an operand does not fit the ports of rtl/reciprocal.sv; `what` begins the message.
void check_operand(Grid operand, std::string_view what);

}  // namespace bitspan
