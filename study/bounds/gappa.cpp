// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/gappa.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "config/modes.hpp"
#include "study/bounds/bounds.hpp"
#include "study/bounds/format_range.hpp"
#include "study/bounds/unit_error.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

using F = FormatId;
using bounds::TablePart;
using bounds::Unit;

// Returns a double exactly, as Gappa reads it.
std::string number(double x) { return x == 0 ? "0" : fmt::format("{:a}", x); }
std::string in(Interval i) { return fmt::format("in [{},{}]", number(i.lo), number(i.hi)); }

// Returns Gappa's name of a rounding.
std::string_view direction(Rounding r) {
  switch (r) {
    case Rounding::rnd:
      return "nu";
    case Rounding::rnd_zero:
      return "nz";
    case Rounding::rnd_min_inf:
      return "nd";
    case Rounding::rnd_inf:
      return "na";
    case Rounding::rnd_conv:
      return "ne";
    case Rounding::trn:
      return "dn";
    case Rounding::trn_zero:
      break;
  }
  return "zr";
}
std::string operator_of(std::string_view name, const Format& f) {
  return fmt::format("@{} = fixed<{},{}>;  # {} bits, {}\n", name, -f.fraction(), direction(f.rounding),
                     f.word, to_string(f.rounding));
}

// The formats of a stage that accumulates along a line.
struct StageFormats {
  F near_h, h_step, h_acc, near_uv, f_diff, f_step, f_acc, uv;
};
constexpr StageFormats edge_formats{F::setup_h,     F::edge_h_step, F::edge_h_acc, F::setup_uv,
                                    F::edge_f_diff, F::edge_f_step, F::edge_f,     F::edge_uv};
constexpr StageFormats span_formats{F::edge_h,      F::span_h_step, F::span_h, F::edge_uv,
                                    F::span_f_diff, F::span_f_step, F::span_f, F::span_uv};

struct Script {
  const Config& config;
  const StageHypotheses& stage;
  const StageFormats& formats;
  bool is_edge;
  std::string text;

  const Format& format(F id) const { return config.format(id); }
  int position_fraction() const {
    return std::max(1, is_edge ? config.coordinate_format().fraction() : format(F::edge_x).fraction());
  }
  std::string fixed(std::string_view name, int fraction) const {
    return fmt::format("@FIX({},{})", name, -fraction);
  }
};

// Returns the hypotheses that all accumulators share: p to the first pixel or row, n additions, and a line of
// length L.
std::string walk_hypotheses(const Script& s) {
  return fmt::format("  L {} /\\ n {} /\\ p + n {} /\\ way {} /\\ {} /\\ r {}\n",
                     in({s.stage.shortest, s.stage.longest}), in({0, static_cast<double>(s.stage.additions)}),
                     in({0, s.stage.distance}), in({0, 1}), s.fixed("p", s.position_fraction()),
                     in(s.stage.slope_error));
}

// Gappa proves the rounding of one addition. The rest of the script assumes n times that rounding.
struct Additions {
  std::string definition, hypothesis, goal;
};
Additions additions(const Script& s, F step, F acc) {
  const Interval each =
      bounds::rounding(s.format(acc), std::max(s.format(acc).fraction(), s.format(step).fraction()));
  return {"once = acc(before + h_step);  # before: the accumulator on its way\n",
          fmt::format("  lost {} /\\ {}\n", in(each * Interval(0, s.stage.additions)),
                      s.fixed("before", s.format(acc).fraction())),
          fmt::format("once - (before + h_step) {}", in(each))};
}

void h_script(Script& s, double claim, bool narrowed) {
  const Format& acc = s.format(s.formats.h_acc);
  const Additions one = additions(s, s.formats.h_step, s.formats.h_acc);
  s.text += operator_of("step", s.format(s.formats.h_step)) + operator_of("acc", acc);
  if (narrowed) s.text += operator_of("kept", s.format(F::edge_h));
  s.text += fmt::format(
      "# d: far end's h minus the near end's, h1; r: error of 1/L; lost: by n additions; carried: error of "
      "the\n"
      "# line through the ends, and what the place adds beside its registers.\n"
      "slope = d * (1 + r) / L;\nh_step = step(slope);\nh_first = acc(h1 + h_step * p + {0});\n"
      "h_n = h_first + n * h_step + lost;\nway = (p + n) / L;\nline = h1 + d * way;\ntruth = line - "
      "carried;\n{1}{2}",
      number(s.stage.h_offset), one.definition, narrowed ? "h = kept(h_n);\n" : "");
  s.text += fmt::format(
      "{{\n  d {} /\\ carried {} /\\ {} /\\\n{} /\\\n{}{}  ->\n  {} - truth {} /\\ {}\n}}\n",
      in(s.stage.h_change), in(s.stage.h_carried), s.fixed("h1", s.format(s.formats.near_h).fraction()),
      walk_hypotheses(s), one.hypothesis, narrowed ? " /\\ " + s.fixed("h_n", acc.fraction()) + "\n" : "",
      narrowed ? "h" : "h_n", in(Interval::plus_minus(claim)), one.goal);
  const std::string from = narrowed ? "h" : "h_n";
  const std::string own = narrowed ? "(h - h_n) + " : "";
  s.text += fmt::format(
      "{} - truth -> {}(h_first - (h1 + h_step * p + {})) + {} + (h_step - slope) * (p + n) + r * (d * way) "
      "+ lost +\n"
      "  carried {{ L <> 0 }};\n",
      from, own, number(s.stage.h_offset), number(s.stage.h_offset));
}

void f_script(Script& s, double claim, std::size_t k) {
  const Additions one = additions(s, s.formats.f_step, s.formats.f_acc);
  const int q_fraction = std::max(s.format(s.formats.near_h).fraction(), s.format(F::setup_b).fraction());
  s.text += operator_of("diff", s.format(s.formats.f_diff)) +
            operator_of("step", s.format(s.formats.f_step)) + operator_of("acc", s.format(s.formats.f_acc));
  s.text += fmt::format(
      "# x: (u2 - u1)(h2 + B) of the registers.\n"
      "f_diff = diff(x);\nslope = f_diff * (1 + r) / L;\nh_step = step(slope);\nf_first = acc(h_step * p + "
      "{0});\n"
      "f_n = f_first + n * h_step + lost;\nway = (p + n) / L;\nline = x * (1 + r) * way;\n{1}",
      number(s.stage.f_offset), one.definition);
  s.text +=
      fmt::format("{{\n  x {} /\\ {} /\\\n{} /\\\n{}  ->\n  f_n - line {} /\\ {}\n}}\n",
                  in(s.stage.f_change[k]), s.fixed("x", q_fraction + s.format(s.formats.near_uv).fraction()),
                  walk_hypotheses(s), one.hypothesis, in(Interval::plus_minus(claim)), one.goal);
  s.text += fmt::format(
      "f_n - line -> (f_first - (h_step * p + {0})) + {0} + (h_step - slope) * (p + n) +\n"
      "  (f_diff - x) * (1 + r) * way + lost {{ L <> 0 }};\n",
      number(s.stage.f_offset));
}

void uv_script(Script& s, double claim, std::size_t k) {
  s.text += operator_of("uv", s.format(s.formats.uv));
  s.text += fmt::format(
      "# change: u2 - u1 of the registers, w: weight of the far end, so that change w q is f without errors; "
      "eh, ef:\n"
      "# errors of the accumulators; rs, rp: of the slope's and the pixel's reciprocal; carried: error of "
      "the\n"
      "# surface through the ends.\n"
      "q1 = q + eh;\nm = (1 + rp) / q1;\nf = change * w * q * (1 + rs) + ef;\nu = uv(u1 + f * m);\n"
      "truth = u1 + change * w - carried;\n"
      "{{\n  change {} /\\ w {} /\\ carried {} /\\ q {} /\\ q1 {} /\\ eh {} /\\ ef {} /\\ rs {} /\\ rp {}\n  "
      "->\n"
      "  u - truth {}\n}}\n"
      "u - truth -> (u - (u1 + f * m)) + change * w * ((1 + rp) * (1 + rs) * (q / q1) - 1) + ef * m + "
      "carried\n"
      "  {{ q1 <> 0 }};\n"
      "q / q1 -> 1 / (1 + eh / q) {{ q <> 0, q1 <> 0 }};\n",
      in(s.stage.uv_change[k]), in({0, 1}), in(s.stage.uv_carried[k]), in(s.stage.q), in(s.stage.q_register),
      in(s.stage.h_walk), in(s.stage.f_walk[k]), in(s.stage.slope_error), in(s.stage.pixel_error),
      in(Interval::plus_minus(claim)));
}

// Returns the script that claims the bound for one run of table entries.
std::string reciprocal_script(const Reciprocal& unit, const TablePart& part, double claim) {
  const std::string goal = fmt::format("m * n - 1 {}", in(Interval::plus_minus(claim)));
  std::string text = operator_of("out", unit.output);
  if (!has_table(unit.kind)) {
    return text +
           fmt::format("m = out(1 / n);\n{{\n  n {} -> {}\n}}\nm * n - 1 -> (m - 1 / n) * n {{ n <> 0 }};\n",
                       in({1, 2}), goal);
  }
  std::string what;  // the part of the table that y0 comes from
  std::string grid;  // the grid of y0
  std::string steps;
  std::string hints;
  int last = 0;
  if (has_newton_steps(unit.kind)) {
    what = "entry";
    grid = fmt::format(" /\\ @FIX(y0,{})", -unit.table_bits);
    for (; last < unit.steps; ++last) {
      steps += fmt::format("a{0} = cut(nq * y{0});\ny{1} = cut(y{0} * (2 - a{0}));\ne{1} = nq * y{1} - 1;\n",
                           last, last + 1);
      hints += fmt::format(
          "e{1} -> -(e{0} * e{0}) - (1 + e{0}) * (a{0} - nq * y{0}) + nq * (y{1} - y{0} * (2 - a{0}));\n",
          last, last + 1);
    }
  } else {
    what = "curve through entries";
    last = 1;
    steps = "y1 = cut(y0);\ne1 = nq * y1 - 1;\n";
    hints = "e1 -> e0 + nq * (y1 - y0);\n";
  }
  text += fmt::format(
      "@cut = fixed<{},dn>;\n"
      "# n: the operand, nq: its leading bits, y0: the table's {}, e0: its error times nq, enumerated.\n"
      "e0 = nq * y0 - 1;\nt = (n - nq) / nq;\n",
      -unit.internal_bits, what);
  text += steps;
  text += fmt::format("m = out(y{});\n{{\n", last);
  hints += fmt::format("m * n - 1 -> (m - y{0}) * n + (e{0} + (1 + e{0}) * t) {{ nq <> 0 }};\n", last);
  const Interval rest(0, std::ldexp(1.0, -unit.operand_bits));
  text += fmt::format("  nq {} /\\ e0 {} /\\ t {} /\\ n {}{} -> {}", in(part.operand), in(part.table),
                      in(rest), in(part.operand), grid, goal);
  return text + "\n}\n" + hints;
}

const StageHypotheses& stage_of(const Hypotheses& all, std::string_view place) {
  return place.starts_with("edge") ? all.edge : all.span;
}

const Bound& bound_at(const std::vector<Bound>& bounds, std::string_view place) {
  const Bound* found = nullptr;
  for (const Bound& b : bounds) {
    if (b.place == place && (found == nullptr || b.bound > found->bound)) found = &b;
  }
  return *found;
}

void check_place(const Config& config, std::string_view place) {
  const auto& all = gappa_places();
  if (std::find(all.begin(), all.end(), place) == all.end()) {
    std::string legal;
    for (const std::string_view p : all) legal += (legal.empty() ? "" : ", ") + std::string(p);
    throw InputError(fmt::format("gappa: no script for {}; legal: {}", place, legal));
  }
  if (place == "reciprocal.pixel" && !config.pixel_reciprocal.normalize) {
    throw InputError(
        "gappa: reciprocal.pixel.normalize is false; a script is written for normalised units only");
  }
}

// Returns which of u and v the claim is about.
std::size_t coordinate_of(const StageHypotheses& stage, const std::vector<Bound>& bounds,
                          std::string_view place) {
  if (place.ends_with(".f")) return stage.f_walk[0].mag() >= stage.f_walk[1].mag() ? 0 : 1;
  return place.ends_with(".uv") && bound_at(bounds, place).quantity == "v" ? 1 : 0;
}

[[noreturn]] void fail(const std::string& what) { throw ToolError("gappa: " + what); }

// The lines that gappa prints where it cannot prove a claim.
constexpr std::array<std::string_view, 3> refusals{"some properties were not satisfied",
                                                   "no contradiction was found", "no path was found"};

}  // namespace

const std::vector<std::string_view>& gappa_places() {
  static const std::vector<std::string_view> places{"reciprocal.pixel", "edge.h_acc", "edge.h", "edge.f",
                                                    "edge.uv",          "span.h",     "span.f", "span.uv"};
  return places;
}

double gappa_claim(const Config& config, const InputRange& range, std::string_view place) {
  check_place(config, place);
  if (place == "reciprocal.pixel") return next_up(Unit(config.pixel_reciprocal).error({1, 2}).relative.mag());
  const Hypotheses all = bound_hypotheses(config, range);
  const StageHypotheses& stage = stage_of(all, place);
  if (place.ends_with(".f")) return next_up(std::max(stage.f_walk[0].mag(), stage.f_walk[1].mag()));
  return bound_at(error_bounds(config, range), place).bound;
}

std::vector<std::string> gappa_scripts(const Config& config, const InputRange& range, std::string_view place,
                                       std::optional<double> claim) {
  const double bound = claim ? *claim : gappa_claim(config, range, place);
  check_place(config, place);
  const std::string head = fmt::format("# bitspan, configuration {}, {}: the error is at most {}.\n",
                                       config.name.empty() ? "(unnamed)" : config.name, place, bound);
  if (place == "reciprocal.pixel") {
    std::vector<std::string> scripts;
    const Unit unit(config.pixel_reciprocal);
    for (const TablePart& part : unit.parts()) {
      scripts.push_back(head + reciprocal_script(config.pixel_reciprocal, part, bound));
    }
    return scripts;
  }
  const Hypotheses all = bound_hypotheses(config, range);
  const bool is_edge = place.starts_with("edge");
  const StageHypotheses& stage = is_edge ? all.edge : all.span;
  if (!stage.adds_up) {
    throw InputError(
        fmt::format("gappa: {}: in this range a register may saturate or wrap, or the ends of a line are so "
                    "near each other that "
                    "its slope may be rounded to 0; the bound is then no sum of roundings",
                    place));
  }
  Script script{config, stage, is_edge ? edge_formats : span_formats, is_edge, head};
  const std::size_t k = coordinate_of(stage, error_bounds(config, range), place);
  if (place.ends_with(".uv")) {
    uv_script(script, bound, k);
  } else if (place.ends_with(".f")) {
    f_script(script, bound, k);
  } else {
    h_script(script, bound, place == "edge.h");
  }
  return {script.text};
}

GappaVerdict prove_with_gappa(const Config& config, const InputRange& range, std::string_view place,
                              std::optional<double> claim) {
  GappaVerdict all{true, {}};
  for (const std::string& script : gappa_scripts(config, range, place, claim)) {
    const GappaVerdict one = check_with_gappa(script);
    all.proved = all.proved && one.proved;
    all.output += one.output;
    if (!all.proved) break;
  }
  return all;
}

GappaVerdict check_with_gappa(const std::string& script) {
  const ScratchFolder folder = temporary_scratch_folder("bitspan-gappa");
  write_text(folder / "script", script, temporary_hint);
  ProgramOptions options;
  options.input = folder / "script";
  options.log = folder / "log";
  options.seconds = 60;
  const ProgramEnd end = run_program({"gappa"}, options);
  if (end.how == ProgramEnd::How::missing) {
    fail("is not installed, or not in PATH (Debian's package is gappa)");
  }
  if (end.how == ProgramEnd::How::late) fail("no answer within a minute");
  GappaVerdict verdict{end.code == 0, read_text(options.log)};
  const bool refused = std::ranges::any_of(
      refusals, [&](std::string_view text) { return verdict.output.find(text) != std::string::npos; });
  if (!verdict.proved && !refused) {
    fail("does not accept the script: " + verdict.output.substr(0, verdict.output.find('\n')));
  }
  return verdict;
}

}  // namespace bitspan
