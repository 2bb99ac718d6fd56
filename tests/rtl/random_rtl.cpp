#include "tests/rtl/random_rtl.hpp"

#include <algorithm>
#include <cmath>

#include "config/check.hpp"
#include "config/rtl_timing.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

int between(Random& random, int lowest, int highest) {
  return std::uniform_int_distribution<int>(lowest, highest)(random);
}
bool chance(Random& random, double p) { return std::bernoulli_distribution(p)(random); }

void randomize(Random& random, Format& f, bool keep_sign) {
  const int fraction = f.fraction() + between(random, -5, 3);
  f.integer += between(random, -3, 2);
  f.word = std::clamp(f.integer + fraction, 1, 50);
  if (!keep_sign && chance(random, 0.2)) f.is_signed = !f.is_signed;
  f.rounding = static_cast<Rounding>(between(random, 0, rounding_modes - 1));
  f.overflow = static_cast<Overflow>(between(random, 0, overflow_modes - (f.is_signed ? 1 : 2)));
}

void randomize(Random& random, Reciprocal& r) {
  r.kind = static_cast<ReciprocalKind>(between(random, 0, 2));
  r.normalize = chance(random, 0.7);
  const bool lut = r.kind != ReciprocalKind::restoring;
  r.operand_bits = lut ? between(random, 4, 24) : 0;
  r.index_bits = lut ? between(random, 1, std::min(8, r.operand_bits - 1)) : 0;
  r.table_bits = lut ? between(random, 3, 20) : 0;
  r.internal_bits = lut ? between(random, 4, 26) : 0;
  r.steps = r.kind == ReciprocalKind::lut_newton ? between(random, 0, 3) : 0;
  r.bits_per_cycle = lut ? between(random, 0, 2) : between(random, 1, 4);
  r.pipelined = chance(random, 0.5);
  randomize(random, r.output, true);
  if (r.normalize) r.output.integer = std::max(1, r.output.integer);
  r.output.word = std::max(r.output.word, r.output.integer + 1);
}

StartOffset random_offset(Random& random, const Format& accumulator) {
  StartOffset o;
  if (chance(random, 0.3)) {
    o.half_ulp = true;
  } else if (chance(random, 0.5)) {
    o.value = std::ldexp(between(random, -40, 40), -accumulator.fraction() - 1);
  }
  return o;
}

}  // namespace

Config random_rtl_config(Random& random) {
  const Config base = shipped_config("depth16");
  for (;;) {
    Config c = base;
    c.name = "random";
    c.perspective = chance(random, 0.6) ? Perspective::delta_f : Perspective::const_depth_rows;
    c.row_slope = chance(random, 0.4) ? SlopeForm::divide : SlopeForm::reciprocal;
    for (const FormatId id :
         {FormatId::setup_b, FormatId::edge_x, FormatId::edge_h, FormatId::edge_uv, FormatId::span_h_step,
          FormatId::span_h, FormatId::span_f_diff, FormatId::span_f_step, FormatId::span_f,
          FormatId::span_uv_step, FormatId::span_uv_acc, FormatId::span_uv}) {
      if (chance(random, 0.8)) randomize(random, c.format(id), id == FormatId::setup_b);
    }
    if (chance(random, 0.5)) randomize(random, c.format(FormatId::plane_k), true);
    if (chance(random, 0.9)) randomize(random, c.row_reciprocal);
    if (chance(random, 0.9)) randomize(random, c.pixel_reciprocal);
    c.pixel_reciprocal.pipelined = true;
    const bool rows = c.perspective == Perspective::const_depth_rows;
    c.start_offset.span_h = random_offset(random, c.format(FormatId::span_h));
    c.start_offset.span_f = random_offset(random, c.format(rows ? FormatId::span_uv_acc : FormatId::span_f));
    if (!first_violation(c)) return c;
  }
}

std::int64_t random_raw(Random& random, const Format& f) {
  const std::uint64_t mask = f.word == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << f.word) - 1;
  std::uint64_t bits = random() & mask;
  switch (between(random, 0, 9)) {
    case 0:
      bits = f.is_signed ? mask >> 1 : mask;  // highest
      break;
    case 1:
      bits = f.is_signed ? mask ^ (mask >> 1) : 0;  // lowest
      break;
    case 2:
      bits = 0;
      break;
    case 3:
    case 4:
    case 5:  // small, of either sign
      bits >>= between(random, 0, f.word - 1);
      if (f.is_signed && chance(random, 0.5)) bits = (~bits + 1) & mask;
      break;
    default:
      break;
  }
  if (!f.is_signed || f.word == 64) return static_cast<std::int64_t>(bits);
  const std::uint64_t sign = std::uint64_t{1} << (f.word - 1);
  return static_cast<std::int64_t>((bits ^ sign) - sign);
}

std::vector<RowRecord> random_rows(Random& random, const Config& c, int count, int longest) {
  std::vector<RowRecord> rows(static_cast<std::size_t>(count));
  const std::int64_t end = (std::int64_t{1} << pixel_index_bits(c)) - longest - 1;
  for (RowRecord& row : rows) {
    const Format& x = c.format(FormatId::edge_x);
    row.l_x = random_raw(random, x);
    row.r_x = random_raw(random, x);
    if (row.r_x < row.l_x && chance(random, 0.9)) std::swap(row.l_x, row.r_x);
    if (chance(random, 0.05)) row.r_x = row.l_x;
    row.x_first = chance(random, 0.5)
                      ? static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end))
                      : std::clamp<std::int64_t>(row.l_x >> std::clamp(x.fraction(), 0, 62), 0, end);
    row.x_last = row.x_first + between(random, 0, chance(random, 0.3) ? 1 : longest - 1);
    for (std::int64_t* h : {&row.l_h, &row.r_h}) *h = random_raw(random, c.format(FormatId::edge_h));
    for (std::int64_t* uv : {&row.l_u, &row.r_u, &row.l_v, &row.r_v}) {
      *uv = random_raw(random, c.format(FormatId::edge_uv));
    }
  }
  return rows;
}

std::vector<PlaneRowRecord> random_plane_rows(Random& random, const Config& c, int count, int longest) {
  std::vector<PlaneRowRecord> rows(static_cast<std::size_t>(count));
  const std::int64_t end = (std::int64_t{1} << pixel_index_bits(c)) - longest - 1;
  const int phase_bits = c.format(FormatId::plane_k).fraction();
  for (PlaneRowRecord& row : rows) {
    row.major_first = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end));
    row.count = between(random, 1, chance(random, 0.3) ? 2 : longest);
    row.phase = static_cast<std::int64_t>(random() >> (64 - phase_bits));
    row.h = random_raw(random, c.format(FormatId::span_h));
    row.gu = random_raw(random, c.format(FormatId::span_f));
    row.gv = random_raw(random, c.format(FormatId::span_f));
    for (std::int64_t* step : {&row.gu_step0, &row.gu_step1, &row.gv_step0, &row.gv_step1}) {
      *step = random_raw(random, c.format(FormatId::span_f_step));
    }
  }
  return rows;
}

std::int64_t random_k(Random& random, const Config& c) {
  const std::int64_t one = std::int64_t{1} << c.format(FormatId::plane_k).fraction();
  switch (between(random, 0, 5)) {
    case 0:
      return 0;
    case 1:
      return one;
    case 2:
      return -one;
    default:
      return std::uniform_int_distribution<std::int64_t>(-one, one)(random);
  }
}

}  // namespace bitspan
