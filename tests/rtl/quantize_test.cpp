// SPDX-License-Identifier: Apache-2.0
// rtl/quantize.sv, exhaustively at small widths: every rounding, overflow, sign, input and sticky bit, under
// Verilator and Icarus, against exact rational numbers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/rtl/reference.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

struct Shape {
  int in_word, in_fraction, out_word, out_fraction;
};
constexpr Shape shapes[] = {
    {9, 4, 4, 1},    // the usual: bits dropped on both sides
    {8, 1, 5, 0},    // one bit dropped: no rest
    {8, 3, 12, 1},   // room to spare on the left
    {6, 2, 7, 5},    // bits appended on the right
    {7, 3, 3, 3},    // same place
    {5, 4, 4, -3},   // more bits dropped than there are
    {7, 5, 1, 0},    // a single bit
    {6, -2, 6, -3},  // fractions below 0
};

Format format_of(const Shape& s, int rounding, int overflow, bool is_signed) {
  return {s.out_word,
          s.out_word - s.out_fraction,
          is_signed,
          static_cast<Rounding>(rounding),
          static_cast<Overflow>(overflow),
          false};
}

std::vector<Format> formats_of(const Shape& s) {
  std::vector<Format> formats;
  for (int rounding = 0; rounding < rounding_modes; ++rounding) {
    for (int overflow = 0; overflow < overflow_modes; ++overflow) {
      for (const bool is_signed : {false, true}) {
        if (is_signed || static_cast<Overflow>(overflow) != Overflow::wrap_sm) {
          formats.push_back(format_of(s, rounding, overflow, is_signed));
        }
      }
    }
  }
  return formats;
}

// One line an input: shape, x, sticky, and the outputs of all formats as bits, the first one last.
std::string bench() {
  std::string text = "module bench;\n";
  std::string main = "  initial begin\n";
  for (std::size_t s = 0; s < std::size(shapes); ++s) {
    const Shape& shape = shapes[s];
    const std::vector<Format> formats = formats_of(shape);
    text += fmt::format("  logic signed [{0}:0] x{1};\n  logic sticky{1};\n  logic [{2}:0] q{1};\n",
                        shape.in_word - 1, s, static_cast<int>(formats.size()) * shape.out_word - 1);
    for (std::size_t i = 0; i < formats.size(); ++i) {
      const Format& f = formats[i];
      text += fmt::format(
          "  quantize #(.InW({}), .InFrac({}), .OutW({}), .OutFrac({}), .OutSigned({}), .Rounding({}), "
          ".Overflow({}))"
          " u_{}_{} (.x_i(x{}), .sticky_i(sticky{}), .q_o(q{}[{}+:{}]));\n",
          shape.in_word, shape.in_fraction, f.word, f.fraction(), f.is_signed ? 1 : 0,
          static_cast<int>(f.rounding), static_cast<int>(f.overflow), s, i, s, s, s,
          i * static_cast<std::size_t>(f.word), f.word);
    }
    main += fmt::format(
        "    for (int i = 0; i < {0}; i++) begin\n      {{x{1}, sticky{1}}} = i;\n      #1;\n"
        "      $display(\"{1} %0d %0d %b\", x{1}, sticky{1}, q{1});\n    end\n",
        2 << shape.in_word, s);
  }
  return text + main + "  end\nendmodule\n";
}

void check(const std::string& printed) {
  std::istringstream in(printed);
  std::size_t compared = 0;
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    std::size_t s = 0;
    std::int64_t x = 0;
    int sticky = 0;
    std::string bits;
    if (!(fields >> s >> x >> sticky >> bits)) continue;  // a simulator's own line
    const Shape& shape = shapes[s];
    if (sticky != 0 && shape.in_fraction <= shape.out_fraction) continue;
    // sticky: anywhere strictly between x and x + 1
    const reference::Rational value = (reference::Rational(x) + reference::Rational(sticky, 3)) *
                                      reference::power_of_two(-shape.in_fraction);
    const std::vector<Format> formats = formats_of(shape);
    ASSERT_EQ(bits.size(), formats.size() * static_cast<std::size_t>(shape.out_word));
    for (std::size_t i = 0; i < formats.size(); ++i) {
      const Format& f = formats[i];
      const auto width = static_cast<std::size_t>(f.word);
      const std::string got = bits.substr(bits.size() - (i + 1) * width, width);
      const std::int64_t expected = reference::quantize(value, f);
      const std::string want =
          fmt::format("{:0{}b}", static_cast<std::uint64_t>(expected) & ((1U << width) - 1), width);
      ASSERT_EQ(got, want) << "shape " << s << ", x = " << x << ", sticky " << sticky << ", "
                           << to_string(f.rounding) << ", " << to_string(f.overflow)
                           << (f.is_signed ? ", signed" : ", unsigned");
      ++compared;
    }
  }
  std::size_t all = 0;
  for (const Shape& s : shapes) {
    all += formats_of(s).size() * (std::size_t{1} << s.in_word) * (s.in_fraction > s.out_fraction ? 2 : 1);
  }
  EXPECT_EQ(compared, all);
}

std::string simulate(std::string (*run)(const TemporaryFolder&)) {
  const TemporaryFolder folder;
  return run(folder);
}

TEST(Quantize, Icarus) {
  check(simulate([](const TemporaryFolder& folder) {
    return run_icarus({folder.write("bench.sv", bench()), source_path("rtl/quantize.sv"),
                       source_path("rtl/quantize_far.sv")},
                      "bench");
  }));
}

TEST(Quantize, Verilator) {
  check(simulate([](const TemporaryFolder& folder) {
    return run_verilator({folder.write("bench.sv", bench()), source_path("rtl/quantize.sv"),
                          source_path("rtl/quantize_far.sv")},
                         "bench");
  }));
}

}  // namespace
}  // namespace bitspan
