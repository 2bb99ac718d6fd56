// SPDX-License-Identifier: Apache-2.0
#include "bench/plain_kernel.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace bitspan::bench {
namespace {

// span.h: 34 bits unsigned, 18 of fraction, as span.h_step; SC_TRN, SC_SAT.
constexpr std::int64_t h_max = (std::int64_t{1} << 34) - 1;
// span.f: 42 bits signed, 8 of fraction, as span.f_step; SC_TRN, SC_SAT.
constexpr std::int64_t f_max = (std::int64_t{1} << 41) - 1;
// span.uv: 25 bits signed, 8 of fraction, as edge.uv; SC_RND, SC_SAT.
constexpr std::int64_t uv_max = (std::int64_t{1} << 24) - 1;
// setup.b has 20 bits of fraction.
constexpr int q_fraction = 20;
// reciprocal.pixel.output: 19 bits, 18 of fraction, SC_RND, SC_SAT.
constexpr int m_fraction = 18;
constexpr std::int64_t m_max = (std::int64_t{1} << 19) - 1;

// lut_newton: 512 entries of 12 bits.
constexpr int index_bits = 9, table_bits = 12, operand_bits = 22, internal_bits = 24;
constexpr auto table = [] {
  std::array<std::int64_t, 1 << index_bits> out{};
  constexpr std::int64_t size = 1 << index_bits;
  for (std::int64_t j = 0; j < size; ++j) {
    const std::int64_t d = 2 * size + 2 * j + 1;
    out[static_cast<std::size_t>(j)] = ((2 * size << (table_bits + 1)) + d) / (2 * d);
  }
  return out;
}();

template <bool restoring>
std::int64_t mantissa(std::int64_t q, int top) {
  if constexpr (restoring) {
    return std::min(((std::int64_t{1} << (top + m_fraction + 1)) + q) / (2 * q), m_max);
  } else {
    const std::int64_t nq = (q << (62 - top)) >> (62 - operand_bits);
    const std::int64_t rest = nq - (std::int64_t{1} << operand_bits);
    const std::int64_t y0 = table[static_cast<std::size_t>(rest >> (operand_bits - index_bits))];
    const std::int64_t a = (nq * y0) >> (operand_bits + table_bits - internal_bits);
    const std::int64_t y = (y0 * ((std::int64_t{2} << internal_bits) - a)) >> table_bits;
    constexpr int dropped = internal_bits - m_fraction;
    return std::min((y + (1 << (dropped - 1))) >> dropped, m_max);
  }
}

std::int64_t coordinate(std::int64_t u1, std::int64_t f, std::int64_t m, int shift) {
  const std::int64_t sum = (u1 << shift) + f * m;
  return std::clamp((sum + (std::int64_t{1} << (shift - 1))) >> shift, -uv_max - 1, uv_max);
}

template <bool restoring>
void run(const SpanCase& c, SpanOutput& out) {
  const std::int64_t b = c.pipeline.constants.record.b;
  // The compiler cannot know that the outputs are not among the inputs: everything read is copied first.
  std::int64_t* out_h = out.h.data();
  std::int64_t* out_u = out.u.data();
  std::int64_t* out_v = out.v.data();
  for (const SpanRecord& record : c.spans) {
    const SpanRecord span = record;
    std::int64_t h = span.h, fu = span.fu, fv = span.fv;
    for (std::int64_t i = 0; i < span.count; ++i) {
      const std::int64_t q = (h << 2) + b;
      const int top = 63 - std::countl_zero(static_cast<std::uint64_t>(q));
      const std::int64_t m = mantissa<restoring>(q, top);
      const int shift = m_fraction + top - q_fraction;
      *out_h++ = h;
      *out_u++ = coordinate(span.u1, fu, m, shift);
      *out_v++ = coordinate(span.v1, fv, m, shift);
      h = std::clamp<std::int64_t>(h + span.h_step, 0, h_max);
      fu = std::clamp(fu + span.fu_step0, -f_max - 1, f_max);
      fv = std::clamp(fv + span.fv_step0, -f_max - 1, f_max);
    }
  }
}

template <bool restoring>
SpanKernel kernel_of(const SpanCase& c) {
  SpanOutput out;
  resize(out, c);
  return [&c, out](SpanOutput* keep) mutable {
    run<restoring>(c, out);
    if (keep != nullptr) {
      *keep = out;
    }
  };
}

// What the constants above were taken from.
bool is_written_for(const Config& c) {
  const auto is = [&](FormatId id, const Format& f) { return c.format(id) == f; };
  const Reciprocal& r = c.pixel_reciprocal;
  const Format uv{25, 17, true, Rounding::rnd, Overflow::sat, false};
  const Format f_step{42, 34, true, Rounding::rnd, Overflow::sat, false};
  const bool newton = r.kind == ReciprocalKind::lut_newton && r.index_bits == index_bits &&
                      r.table_bits == table_bits && r.operand_bits == operand_bits &&
                      r.internal_bits == internal_bits && r.steps == 1;
  return c.perspective == Perspective::delta_f && (newton || r.kind == ReciprocalKind::restoring) &&
         r.normalize && r.output == Format{19, 1, false, Rounding::rnd, Overflow::sat, false} &&
         c.format(FormatId::setup_b).fraction() == q_fraction &&
         is(FormatId::span_h, {34, 16, false, Rounding::trn, Overflow::sat, false}) &&
         is(FormatId::span_h_step, {38, 20, true, Rounding::rnd, Overflow::sat, false}) &&
         is(FormatId::span_f, {42, 34, true, Rounding::trn, Overflow::sat, false}) &&
         is(FormatId::span_f_step, f_step) && is(FormatId::edge_uv, uv) && is(FormatId::span_uv, uv);
}

}  // namespace

SpanKernel make_plain(const SpanCase& c) {
  if (!is_written_for(c.config)) {
    throw InputError("the plain span kernel is written for depth16 alone");
  }
  if (c.config.pixel_reciprocal.kind == ReciprocalKind::restoring) {
    return kernel_of<true>(c);
  }
  return kernel_of<false>(c);
}

Config restoring_of(Config depth16) {
  depth16.name = "depth16-restoring";
  Reciprocal& r = depth16.pixel_reciprocal;
  r.kind = ReciprocalKind::restoring;
  r.operand_bits = r.index_bits = r.table_bits = r.internal_bits = r.steps = 0;
  check_config(depth16, depth16.name);
  return depth16;
}

}  // namespace bitspan::bench
