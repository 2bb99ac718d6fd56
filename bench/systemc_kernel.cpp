// SPDX-License-Identifier: Apache-2.0
#include "bench/systemc_kernel.hpp"

#include <cmath>
#include <memory>
#include <systemc>

#include "config/modes.hpp"

namespace bitspan::bench {
namespace {

sc_dt::sc_q_mode mode_of(Rounding mode) {
  switch (mode) {
    case Rounding::rnd:
      return sc_dt::SC_RND;
    case Rounding::rnd_zero:
      return sc_dt::SC_RND_ZERO;
    case Rounding::rnd_min_inf:
      return sc_dt::SC_RND_MIN_INF;
    case Rounding::rnd_inf:
      return sc_dt::SC_RND_INF;
    case Rounding::rnd_conv:
      return sc_dt::SC_RND_CONV;
    case Rounding::trn:
      return sc_dt::SC_TRN;
    case Rounding::trn_zero:
      return sc_dt::SC_TRN_ZERO;
  }
  return sc_dt::SC_TRN;
}

sc_dt::sc_o_mode mode_of(Overflow mode) {
  switch (mode) {
    case Overflow::wrap:
      return sc_dt::SC_WRAP;
    case Overflow::sat:
      return sc_dt::SC_SAT;
    case Overflow::sat_zero:
      return sc_dt::SC_SAT_ZERO;
    case Overflow::sat_sym:
      return sc_dt::SC_SAT_SYM;
    case Overflow::wrap_sm:
      return sc_dt::SC_WRAP_SM;
  }
  return sc_dt::SC_WRAP;
}

// The kernel's registers with widths read at run time. span.h is unsigned in every shipped configuration.
template <class Signed, class Unsigned, class AnyValue>
struct RunTimeRegisters {
  using Value = AnyValue;
  explicit RunTimeRegisters(const Config& c) : config(c) {}

  template <class Fix>
  static Fix make(const Format& f) {
    return Fix(f.word, f.integer, mode_of(f.rounding), mode_of(f.overflow));
  }
  Signed signed_of(FormatId id) const { return make<Signed>(config.format(id)); }
  Unsigned unsigned_of(FormatId id) const { return make<Unsigned>(config.format(id)); }

  const Config& config;
  const Reciprocal& unit = config.pixel_reciprocal;
  Unsigned h = unsigned_of(FormatId::span_h), b = unsigned_of(FormatId::setup_b);
  Signed h_step = signed_of(FormatId::span_h_step);
  Signed fu = signed_of(FormatId::span_f), fv = fu;
  Signed fu_step = signed_of(FormatId::span_f_step), fv_step = fu_step;
  Signed u1 = signed_of(FormatId::edge_uv), v1 = u1;
  Signed u = signed_of(FormatId::span_uv), v = u;
  Unsigned m = make<Unsigned>(unit.output);
  // Intermediates of lut_newton.
  Unsigned nq = Unsigned(unit.operand_bits + 1, 1), a = Unsigned(unit.internal_bits + 2, 2);
  Unsigned y = Unsigned(unit.internal_bits + 1, 1);
};
using ScFix = RunTimeRegisters<sc_dt::sc_fix, sc_dt::sc_ufix, sc_dt::sc_fxval>;
using ScFixFast = RunTimeRegisters<sc_dt::sc_fix_fast, sc_dt::sc_ufix_fast, sc_dt::sc_fxval_fast>;

// The same for depth16, as templates.
struct ScFixedFast {
  using Value = sc_dt::sc_fxval_fast;
  explicit ScFixedFast(const Config& c) : unit(c.pixel_reciprocal) {}

  const Reciprocal& unit;
  sc_dt::sc_ufixed_fast<34, 16, sc_dt::SC_TRN, sc_dt::SC_SAT> h;
  sc_dt::sc_ufixed_fast<38, 18, sc_dt::SC_RND, sc_dt::SC_SAT> b;
  sc_dt::sc_fixed_fast<38, 20, sc_dt::SC_RND, sc_dt::SC_SAT> h_step;
  sc_dt::sc_fixed_fast<42, 34, sc_dt::SC_TRN, sc_dt::SC_SAT> fu, fv;
  sc_dt::sc_fixed_fast<42, 34, sc_dt::SC_RND, sc_dt::SC_SAT> fu_step, fv_step;
  sc_dt::sc_fixed_fast<25, 17, sc_dt::SC_RND, sc_dt::SC_SAT> u1, v1, u, v;
  sc_dt::sc_ufixed_fast<19, 1, sc_dt::SC_RND, sc_dt::SC_SAT> m;
  sc_dt::sc_ufixed_fast<23, 1> nq;
  sc_dt::sc_ufixed_fast<26, 2> a;
  sc_dt::sc_ufixed_fast<25, 1> y;
};

template <class Registers>
struct Kernel {
  using Value = typename Registers::Value;

  explicit Kernel(const SpanCase& c) : span_case(c), r(c.config) {
    resize(out, c);
    r.b = value(c.pipeline.constants.record.b, FormatId::setup_b);
    for (const std::int64_t entry : c.pipeline.span.reciprocal.table()) {
      table.push_back(Value(entry) >> c.config.pixel_reciprocal.table_bits);
    }
  }

  Value value(std::int64_t raw, FormatId id) const {
    return Value(raw) >> span_case.config.format(id).fraction();
  }
  static std::int64_t raw(double x, int fraction) {
    return static_cast<std::int64_t>(std::ldexp(x, fraction));
  }

  void reciprocal(const Value& q, int e) {
    if (r.unit.kind == ReciprocalKind::restoring) {
      r.m = Value(1) / (q >> e);
      return;
    }
    r.nq = q >> e;
    const Value y0 = table[static_cast<std::size_t>(((r.nq - 1) << r.unit.index_bits).to_int())];
    r.a = r.nq * y0;
    r.y = y0 * (2 - r.a);
    for (int i = 1; i < r.unit.steps; ++i) {
      r.a = r.nq * r.y;
      r.y = r.y * (2 - r.a);
    }
    r.m = r.y;
  }

  void operator()() {
    const int h_fraction = span_case.config.format(FormatId::span_h).fraction();
    const int uv_fraction = span_case.config.format(FormatId::span_uv).fraction();
    std::size_t at = 0;
    for (const SpanRecord& span : span_case.spans) {
      r.h = value(span.h, FormatId::span_h);
      r.h_step = value(span.h_step, FormatId::span_h_step);
      r.fu = value(span.fu, FormatId::span_f);
      r.fv = value(span.fv, FormatId::span_f);
      r.fu_step = value(span.fu_step0, FormatId::span_f_step);
      r.fv_step = value(span.fv_step0, FormatId::span_f_step);
      r.u1 = value(span.u1, FormatId::edge_uv);
      r.v1 = value(span.v1, FormatId::edge_uv);
      for (std::int64_t i = 0; i < span.count; ++i, ++at) {
        const Value q = r.h + r.b;
        const int e = std::ilogb(q.to_double());
        reciprocal(q, e);
        r.u = r.u1 + ((r.fu * r.m) >> e);
        r.v = r.v1 + ((r.fv * r.m) >> e);
        out.h[at] = raw(r.h.to_double(), h_fraction);
        out.u[at] = raw(r.u.to_double(), uv_fraction);
        out.v[at] = raw(r.v.to_double(), uv_fraction);
        r.h = r.h + r.h_step;
        r.fu = r.fu + r.fu_step;
        r.fv = r.fv + r.fv_step;
      }
    }
  }

  const SpanCase& span_case;
  Registers r;
  std::vector<Value> table;
  SpanOutput out;
};

template <class Registers>
SpanKernel make(const SpanCase& c) {
  const Reciprocal& unit = c.config.pixel_reciprocal;
  if (c.config.perspective != Perspective::delta_f || !unit.normalize ||
      (has_table(unit.kind) && !has_newton_steps(unit.kind))) {
    throw InputError(
        "the SystemC span kernel is delta_f with a normalised reciprocal, restoring or lut_newton");
  }
  return [kernel = std::make_shared<Kernel<Registers>>(c)](SpanOutput* keep) {
    (*kernel)();
    if (keep != nullptr) {
      *keep = kernel->out;
    }
  };
}

}  // namespace

SpanKernel make_sc_fix(const SpanCase& c) { return make<ScFix>(c); }
SpanKernel make_sc_fix_fast(const SpanCase& c) { return make<ScFixFast>(c); }

SpanKernel make_sc_fixed_fast(const SpanCase& c) {
  if (c.config.format(FormatId::span_h).word != 34 || c.config.format(FormatId::span_f).word != 42) {
    throw InputError("the sc_fixed_fast span kernel is written for depth16 alone");
  }
  return make<ScFixedFast>(c);
}

}  // namespace bitspan::bench
