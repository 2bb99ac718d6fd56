// SPDX-License-Identifier: Apache-2.0
#include "study/area_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <functional>
#include <sstream>
#include <string_view>
#include <tuple>
#include <utility>

#include "config/grid.hpp"
#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {
namespace {

constexpr int exponent_bits = 8;  // of the RTL's ports
constexpr int block_width = 18;   // operands of a multiplier block

int ceil_div(int n, int d) { return (n + d - 1) / d; }
int bits_of(int n) { return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(0, n)))); }

// Returns the grid of the difference of two values of a register.
Grid difference_of(const Format& f) { return grid_of(f) - grid_of(f); }

// Counts the modules of rtl/ one by one.
class Counter {
 public:
  explicit Counter(const Config& config) : c_(config), timing_(rtl_timing(config)) {}
  AreaShape count() {
    if (has_plane_rows(c_.perspective)) {
      const_depth_setup();
      const_depth_span();
    } else {
      delta_f_setup();
      delta_f_span();
    }
    return shape_;
  }

 private:
  const Format& format(FormatId id) const { return c_.format(id); }
  int word(FormatId id) const { return format(id).word; }

  void add_registers(int bits, int times = 1) { shape_.registers += double(bits) * times; }

  // Counts rtl/quantize.sv, whose input has `integer` bits left of the point.
  void quantize(int fraction, int integer, const Format& to) {
    const int width = std::max(integer + to.fraction(), to.word);
    const bool rounds = to.rounding != Rounding::trn && fraction > to.fraction();
    if (rounds) shape_.sums += width;
    if (to.overflow != Overflow::wrap) shape_.selects += to.word;
  }

  void multiply(int a, int b) {
    shape_.products += double(a) * b;
    // Yosys cuts both operands into pieces of 18 bits; a last piece of a single bit becomes LUTs.
    const auto pieces = [](int bits) { return bits / block_width + (bits % block_width > 1 ? 1 : 0); };
    const int of_a = pieces(a);
    const int of_b = pieces(b);
    shape_.blocks += double(of_a) * of_b;
    // Each piece's product is added above the bits that the pieces before it settled. The pieces of the
    // longer operand come last.
    const auto [longer, shorter] = std::minmax(a, b, std::greater<>());
    const int outer = ceil_div(longer, block_width);
    const int inner = ceil_div(shorter, block_width);
    for (int i = 1; i < outer; ++i) shape_.block_sums += longer + shorter - i * block_width;
    for (int i = 1; i < inner; ++i)
      shape_.block_sums += double(outer) * (shorter + block_width - i * block_width);
  }

  // Counts rtl/multiply_add.sv.
  void multiply_add(Grid a, Grid b, Exponents e, bool adds, const Format& to) {
    multiply(a.bits(), b.bits());
    const Grid product = a * b;
    const int integer = product.bits() - product.fraction - e.low;
    const int fraction = product.fraction + e.high;
    // No bit is needed below the last place that decides a rounding.
    const int kept = integer + std::min(fraction, to.fraction() + 1);
    shape_.selects += double(bits_of(e.high - e.low)) * std::max(kept, to.word);
    if (adds) shape_.sums += std::max(kept, to.word);
    quantize(fraction, integer, to);
  }
  void accumulate(const Format& step, const Format& to) {
    shape_.sums += std::max(to.word, step.word);
    if (to.overflow != Overflow::wrap) shape_.selects += to.word;
    shape_.selects += to.word;  // chooses the start value or the next
  }

  // Counts rtl/restoring_core.sv. The divisor may be that of another core.
  void restoring(int divisor, int iterations, int bits_per_cycle, bool pipelined, bool constant_numerator,
                 bool own_divisor) {
    const int bits = iterations * bits_per_cycle;
    // A step behind another one of the same clock chooses among what both may leave. Where the numerator is a
    // constant, half of that is known.
    const int chained = divisor * (bits_per_cycle - 1) * (constant_numerator ? 1 : 2);
    if (pipelined) {
      shape_.steps += double(bits) * divisor;
      shape_.chained += double(chained) * iterations;
      for (int i = 1; i <= iterations; ++i) {
        const int made = i * bits_per_cycle;
        add_registers(constant_numerator ? divisor + made : std::min(divisor, made) + bits);
      }
      if (own_divisor) add_registers(divisor, iterations - 1);
    } else {
      shape_.steps += double(bits_per_cycle) * divisor;
      shape_.chained += chained;
      shape_.selects += divisor + bits;
      add_registers(divisor + bits);
      if (own_divisor) add_registers(divisor + bits_of(iterations));
    }
  }

  // Counts rtl/reciprocal.sv.
  Exponents reciprocal(const Reciprocal& unit, Grid operand) {
    const int op = operand.bits();
    const int shift = bits_of(op);
    // The core takes the clocks between the operand's normalisation and Q.
    const int core = reciprocal_latency(unit, operand) - 2;
    const bool lut = has_table(unit.kind);

    if (lut || unit.normalize) {
      shape_.sums += op;  // leading zeros
      shape_.selects += double(shift) * (lut ? std::min(op, (op + unit.operand_bits) / 2) : op);
      add_registers(shift, lut || unit.pipelined ? 1 + core : 1);
    }
    add_registers(lut ? std::min(op - 1, unit.operand_bits) : op);

    Grid y = reciprocal_core(unit, operand);
    if (lut && !unit.normalize) {
      shape_.selects += double(shift) * (y.bits() + op - 1);
      y = {y.integer + operand.fraction, y.fraction + op - 1 - operand.fraction, false};
    }
    quantize(y.fraction, y.integer, unit.output);
    add_registers(unit.output.word + (unit.normalize ? exponent_bits : 0));
    return exponents_of(unit, operand);
  }

  // Counts the core of each kind. Returns the grid of its result.
  Grid reciprocal_core(const Reciprocal& unit, Grid operand) {
    const int entry = unit.table_bits + 1;
    const int nq_fraction = std::max(unit.operand_bits, unit.index_bits);
    const double segments = std::ldexp(1.0, unit.index_bits);
    const Grid y{1, unit.internal_bits, false};
    switch (unit.kind) {
      case ReciprocalKind::restoring: {
        const RestoringShape shape = restoring_shape(unit, operand);
        const int per_cycle = std::max(1, unit.bits_per_cycle);
        restoring(operand.bits(), shape.iterations, per_cycle, unit.pipelined, true, true);
        return {shape.iterations * per_cycle - shape.fraction, shape.fraction, false};
      }
      case ReciprocalKind::lut_linear: {
        const int t = nq_fraction - unit.index_bits;
        shape_.table += 2 * segments * entry;
        add_registers(2 * entry + t + y.bits());
        shape_.sums += entry + entry + t;
        multiply(entry, t + 1);
        return y;
      }
      case ReciprocalKind::lut_quadratic: {
        const int t = nq_fraction - unit.index_bits;
        const int c1 = std::max(1, entry - unit.index_bits);
        const int c2 = std::max(1, entry - 2 * unit.index_bits);
        const int g = std::max(1, y.bits() - unit.index_bits);
        shape_.table += segments * (entry + c1 + c2);
        add_registers(entry + c1 + c2 + t);
        add_registers(entry + g + t);
        add_registers(y.bits());
        multiply(c2, t);
        multiply(g, t);
        shape_.sums += c1 + t + std::max(entry, unit.internal_bits + t + 1);
        return y;
      }
      case ReciprocalKind::lut_newton:
        shape_.table += segments * entry;
        add_registers(entry + nq_fraction);
        for (int s = 0; s < unit.steps; ++s) {
          const int in = (s == 0 ? unit.table_bits : unit.internal_bits) + 1;
          const bool last = s + 1 == unit.steps;
          add_registers(unit.internal_bits + 2 + in + unit.internal_bits + 1);
          add_registers(nq_fraction, last ? 0 : 2);
          multiply(nq_fraction + 1, in);
          multiply(in, unit.internal_bits + 2);
          shape_.sums += unit.internal_bits + 2;
        }
        return unit.steps > 0 ? y : Grid{1, unit.table_bits, false};
    }
    return y;
  }

  // Counts the adder of h + B, and returns the grid of the sum.
  Grid depth_operand(FormatId h) {
    const Grid sum = depth_sum(c_, h);
    shape_.sums += sum.bits();
    return sum;
  }

  int wait_clocks() const { return timing_.row_unit_pipelined ? timing_.row_unit : 0; }

  void delta_f_setup() {
    const int index = pixel_index_bits(c_);
    const Format& x = format(FormatId::edge_x);
    const Format& h = format(FormatId::edge_h);
    const Format& uv = format(FormatId::edge_uv);
    const Format& f_diff = format(FormatId::span_f_diff);
    const Format& h_step = format(FormatId::span_h_step);
    const Format& f_step = format(FormatId::span_f_step);
    const int p_fraction = std::max(1, x.fraction());
    const Grid p = {std::max(index, x.integer) + 1, p_fraction, true};  // x_first + 1/2 - x_l
    const bool divides = !shares_reciprocal(c_.row_slope);
    add_registers(timing_.span_setup);

    // The first part takes the differences.
    const Grid h_difference = difference_of(h);
    const Grid uv_difference = difference_of(uv);
    shape_.sums += difference_of(x).bits() + p.bits() + h_difference.bits() + 2 * uv_difference.bits();
    const Grid sum = depth_operand(FormatId::edge_h);
    for (int i = 0; i < 2; ++i) multiply_add(uv_difference, as_signed(sum), {}, false, f_diff);
    const int kept = 2 * index + p.bits() + h.word + 2 * uv.word + 1;  // includes what the start values need
    const int numerators = h_difference.bits() + 2 * f_diff.word;
    add_registers(kept + numerators + x.word);
    add_registers(kept + (divides ? 0 : numerators), wait_clocks());

    // The second part has the row unit and the slopes.
    if (divides) {
      const RowDivideShape divide = row_divide_shape(c_);
      const int per_cycle = std::max(1, c_.row_reciprocal.bits_per_cycle);
      const int bits = divide.iterations * per_cycle;
      bool first = true;
      for (const auto& [numerator, fraction, to] :
           {std::tuple{h_difference.bits(), divide.h_fraction, h_step},
            std::tuple{signed_grid(f_diff).bits(), divide.f_fraction, f_step},
            std::tuple{signed_grid(f_diff).bits(), divide.f_fraction, f_step}}) {
        add_registers(numerator + 1 + (first ? x.word + 1 : 0));
        shape_.sums += numerator + bits;  // for the magnitude and the quotient's sign
        restoring(x.word, divide.iterations, per_cycle, timing_.row_unit_pipelined, false, first);
        if (timing_.row_unit_pipelined) add_registers(divide.iterations);
        quantize(fraction + 1, bits - fraction, to);
        first = false;
      }
    } else {
      const Exponents e = reciprocal(c_.row_reciprocal, row_operand(c_));
      const Grid m = signed_grid(c_.row_reciprocal.output);
      multiply_add(h_difference, m, e, false, h_step);
      for (int i = 0; i < 2; ++i) multiply_add(signed_grid(f_diff), m, e, false, f_step);
    }
    shape_.selects += h_step.word + 2 * f_step.word;
    const int steps = h_step.word + 2 * f_step.word;
    add_registers(2 * index + p.bits() + h.word + 2 * uv.word + steps);

    // The third part has the start values.
    multiply_add(signed_grid(h_step), p, {}, true, format(FormatId::span_h));
    const bool offset = c_.start_offset.span_f.half_ulp || c_.start_offset.span_f.value != 0;
    for (int i = 0; i < 2; ++i) multiply_add(signed_grid(f_step), p, {}, offset, format(FormatId::span_f));
    add_registers(2 * index + word(FormatId::span_h) + 2 * uv.word + 2 * word(FormatId::span_f) + steps);
  }

  // Counts the counters, accumulators and their registers, which both modes have.
  void walk(const Format& f, const Format& f_step, int steps) {
    const int index = pixel_index_bits(c_);
    add_registers(1 + 2 * index + timing_.span);
    shape_.sums += 2 * index;
    shape_.selects += 2 * index;
    add_registers(word(FormatId::span_h) + 2 * f.word + 2 * steps * f_step.word);
    for (int i = 0; i < 2; ++i) accumulate(f_step, f);
    // The pixel's registers at the output.
    add_registers(index + 1 + word(FormatId::span_h) + 2 * word(FormatId::span_uv));
  }

  void delta_f_span() {
    const Format& f = format(FormatId::span_f);
    const Format& uv = format(FormatId::edge_uv);
    const Format& h_step = format(FormatId::span_h_step);
    walk(f, format(FormatId::span_f_step), 1);
    accumulate(h_step, format(FormatId::span_h));
    add_registers(h_step.word + 2 * uv.word);
    const Grid sum = depth_operand(FormatId::span_h);
    add_registers(sum.bits());
    const Exponents e = reciprocal(c_.pixel_reciprocal, pixel_operand(c_));
    const int waits = pixel_index_bits(c_) + 1 + word(FormatId::span_h) + 2 * f.word + 2 * uv.word;
    add_registers(waits, 1 + timing_.pixel_unit);
    for (int i = 0; i < 2; ++i)
      multiply_add(signed_grid(f), signed_grid(c_.pixel_reciprocal.output), e, true,
                   format(FormatId::span_uv));
  }

  void const_depth_setup() {
    const int index = pixel_index_bits(c_);
    const Format& f = format(FormatId::span_f);
    const Format& f_step = format(FormatId::span_f_step);
    const Format& acc = format(FormatId::span_uv_acc);
    const Format& step = format(FormatId::span_uv_step);
    const int line = std::max(1, format(FormatId::plane_k).fraction()) + word(FormatId::plane_k);
    add_registers(timing_.span_setup);
    const Grid sum = depth_operand(FormatId::span_h);
    const int kept = 2 * index + line + word(FormatId::span_h);
    const int first = kept + 2 * f.word + 4 * f_step.word;
    add_registers(sum.bits() + first * (1 + wait_clocks()));
    const Exponents e = reciprocal(c_.row_reciprocal, row_operand(c_));
    const Grid m = signed_grid(c_.row_reciprocal.output);
    const bool offset = c_.start_offset.span_f.half_ulp || c_.start_offset.span_f.value != 0;
    for (int i = 0; i < 2; ++i) multiply_add(signed_grid(f), m, e, offset, acc);
    for (int i = 0; i < 4; ++i) multiply_add(signed_grid(f_step), m, e, false, step);
    add_registers(kept + 2 * acc.word + 4 * step.word, 2);
  }

  void const_depth_span() {
    const Format& acc = format(FormatId::span_uv_acc);
    const Format& step = format(FormatId::span_uv_step);
    const Format& uv = format(FormatId::span_uv);
    const int phase = std::max(1, format(FormatId::plane_k).fraction());
    walk(acc, step, 2);
    add_registers(phase + word(FormatId::plane_k) + 1);
    shape_.sums += phase + word(FormatId::plane_k);
    shape_.selects += 2 * step.word + phase;
    for (int i = 0; i < 2; ++i) quantize(acc.fraction(), acc.integer, uv);
  }

  const Config& c_;
  RtlTiming timing_;
  AreaShape shape_;
};

// Returns what LUTs are made of. iCE40's division steps cost the same behind one another; ECP5's wide
// multiplexers do not.
std::vector<double> lut_terms_of(const AreaShape& s, Family family) {
  if (family == Family::ice40) return {s.products, s.sums, s.selects, s.steps};
  return {s.block_sums, s.sums, s.selects, s.steps, s.chained};
}

using Matrix = std::vector<std::vector<double>>;

// Solves the normal equations of least squares, A x = b, by elimination with pivots.
std::vector<double> solve(Matrix a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < n; ++row) {
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    }
    if (a[pivot][column] == 0) throw InputError("area fit: the runs do not determine every coefficient");
    std::swap(a[pivot], a[column]);
    std::swap(b[pivot], b[column]);
    for (std::size_t row = column + 1; row < n; ++row) {
      const double factor = a[row][column] / a[column][column];
      for (std::size_t k = column; k < n; ++k) a[row][k] -= factor * a[column][k];
      b[row] -= factor * b[column];
    }
  }
  std::vector<double> x(n);
  for (std::size_t row = n; row-- > 0;) {
    x[row] = b[row];
    for (std::size_t k = row + 1; k < n; ++k) x[row] -= a[row][k] * x[k];
    x[row] /= a[row][row];
  }
  return x;
}

struct Sample {
  AreaShape shape;
  AreaCounts counts;
};

std::vector<Sample> samples_of(std::span<const AreaRun> runs, Family family) {
  std::vector<Sample> samples;
  for (const AreaRun& run : runs) {
    if (run.family == family) samples.push_back({area_shape(config_of(run)), run.counts});
  }
  return samples;
}

// The relative error counts, so a large run weighs no more than a small one.
AreaFit fit_samples(std::span<const Sample> samples, Family family) {
  const std::size_t n = lut_terms_of({}, family).size();
  Matrix a(n, std::vector<double>(n));
  std::vector<double> b(n);
  double ff_square = 0;
  double ff_sum = 0;
  for (const Sample& s : samples) {
    const std::vector<double> terms = lut_terms_of(s.shape, family);
    const auto luts = static_cast<double>(s.counts.luts);
    for (std::size_t i = 0; i < n; ++i) {
      b[i] += terms[i] / luts;
      for (std::size_t k = 0; k < n; ++k) a[i][k] += terms[i] / luts * terms[k] / luts;
    }
    const double ratio = s.shape.registers / static_cast<double>(s.counts.ffs);
    ff_square += ratio * ratio;
    ff_sum += ratio;
  }
  if (samples.empty()) throw InputError(fmt::format("area fit: no runs of {}", to_string(family)));
  return {solve(a, b), ff_sum / ff_square};
}

class ErrorSum {
 public:
  void add(double estimated, double measured) {
    const double percent = measured == 0 ? (estimated == 0 ? 0 : 100) : 100 * (estimated / measured - 1);
    max_ = std::max(max_, std::abs(percent));
    squares_ += percent * percent;
    ++count_;
  }
  AreaFitError error() const { return {max_, std::sqrt(squares_ / std::max(1, count_))}; }

 private:
  double max_ = 0;
  double squares_ = 0;
  int count_ = 0;
};

constexpr std::string_view csv_header = "base,settings,family,luts,ffs,multipliers,memory_bits,tools";

KeyValue value_in(std::string_view text) {
  if (text == "true" || text == "false") return text == "true";
  std::int64_t integer = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), integer);
  if (error == std::errc() && end == text.data() + text.size()) return integer;
  return std::string(text);
}

std::int64_t count_in(const std::string& text) {
  std::int64_t value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0)
    throw InputError(fmt::format("'{}' is no count", text));
  return value;
}

AreaRun run_in(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  if (cells.size() != 8) throw InputError(fmt::format("expected the 8 columns {}", csv_header));
  AreaRun run;
  run.base = cells[0];
  std::istringstream settings(cells[1]);
  for (std::string setting; settings >> setting;) {
    const std::size_t equal = setting.find('=');
    if (equal == std::string::npos) throw InputError(fmt::format("'{}' sets no key", setting));
    run.settings.push_back({setting.substr(0, equal), value_in(std::string_view(setting).substr(equal + 1))});
  }
  run.family = family_named(cells[2]);
  run.counts = {count_in(cells[3]), count_in(cells[4]), count_in(cells[5]), count_in(cells[6])};
  run.tools = cells[7];
  return run;
}

}  // namespace

AreaShape area_shape(const Config& config) { return Counter(config).count(); }

const AreaFit& area_fit(Family family) {
  // Least squares over config/studies/area_fit.csv give these. tests/study/area_estimate_test.cpp fits again
  // and compares.
  static const AreaFit ice40 = {{2.8114, 1.3656, 0.7313, 3.5935}, 0.9966};
  static const AreaFit ecp5 = {{1.0831, 1.4210, 1.2637, 3.6186, 3.7858}, 0.9937};
  return family == Family::ice40 ? ice40 : ecp5;
}

AreaEstimate estimate_area(const AreaShape& shape, Family family, const AreaFit& fit) {
  AreaEstimate estimate;
  const std::vector<double> terms = lut_terms_of(shape, family);
  for (std::size_t i = 0; i < terms.size(); ++i) estimate.luts += fit.luts[i] * terms[i];
  estimate.ffs = fit.ffs * shape.registers;
  estimate.multipliers = family == Family::ice40 ? 0 : shape.blocks;
  return estimate;
}

AreaEstimate estimate_area(const Config& config, Family family) {
  return estimate_area(area_shape(config), family, area_fit(family));
}

AreaFit fit_area(std::span<const AreaRun> runs, Family family) {
  return fit_samples(samples_of(runs, family), family);
}

AreaFitErrors area_fit_errors(std::span<const AreaRun> runs, Family family) {
  const std::vector<Sample> samples = samples_of(runs, family);
  const AreaFit whole = fit_samples(samples, family);
  ErrorSum luts;
  ErrorSum luts_left_out;
  ErrorSum ffs;
  ErrorSum ffs_left_out;
  ErrorSum multipliers;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::vector<Sample> others = samples;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const AreaEstimate in = estimate_area(samples[i].shape, family, whole);
    const AreaEstimate out = estimate_area(samples[i].shape, family, fit_samples(others, family));
    const AreaCounts& measured = samples[i].counts;
    luts.add(in.luts, static_cast<double>(measured.luts));
    luts_left_out.add(out.luts, static_cast<double>(measured.luts));
    ffs.add(in.ffs, static_cast<double>(measured.ffs));
    ffs_left_out.add(out.ffs, static_cast<double>(measured.ffs));
    multipliers.add(in.multipliers, static_cast<double>(measured.multipliers));
  }
  return {luts.error(), luts_left_out.error(), ffs.error(), ffs_left_out.error(), multipliers.error()};
}

Config config_of(const AreaRun& run) {
  const std::filesystem::path file = rtl_root() / "config" / (run.base + ".toml");
  return with_keys(load_config(file.string()), run.settings);
}

std::vector<AreaRun> load_area_runs(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::string line;
  if (!in || !std::getline(in, line) || line != csv_header)
    throw InputError(fmt::format("{}: cannot be read, or does not begin with {}", csv.string(), csv_header));
  std::vector<AreaRun> runs;
  for (int number = 2; std::getline(in, line); ++number) {
    try {
      runs.push_back(run_in(line));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}:{}: {}", csv.string(), number, error.what()));
    }
  }
  return runs;
}

void write_area_runs(const std::filesystem::path& csv, std::span<const AreaRun> runs) {
  std::ofstream out(csv);
  out << csv_header << '\n';
  for (const AreaRun& run : runs) {
    std::string settings;
    for (const KeySetting& setting : run.settings)
      settings += fmt::format("{}{}={}", settings.empty() ? "" : " ", setting.path, to_string(setting.value));
    out << fmt::format("{},{},{},{},{},{},{},{}\n", run.base, settings, to_string(run.family),
                       run.counts.luts, run.counts.ffs, run.counts.multipliers, run.counts.memory_bits,
                       run.tools);
  }
  out.close();
  if (!out) throw InputError(fmt::format("{}: cannot be written", csv.string()));
}

void measure_area_runs(std::span<AreaRun> runs, const AreaLimits& limits) {
  for (AreaRun& run : runs) {
    const AreaResult result = measure_area(config_of(run), run.family, false, limits);
    if (result.status != AreaStatus::ok)
      throw InputError(fmt::format("{} in {}: {}", run.base, to_string(run.family), result.message));
    run.counts = result.counts;
    run.tools = result.tools;
  }
}

}  // namespace bitspan
