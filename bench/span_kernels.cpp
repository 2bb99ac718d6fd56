// SPDX-License-Identifier: Apache-2.0
#include "bench/span_kernels.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "bench/plain_kernel.hpp"
#include "bench/systemc_kernel.hpp"
#include "bench/vector_kernels.hpp"
#include "model/pipeline.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan::bench {
namespace {

// The model's stage functions, one record at a time.
template <class Watch>
void run_scalar(const SpanCase& c, std::vector<FragmentRecord>& fragments, Watch watch) {
  Counters counters;
  fragments.clear();
  for (const SpanRecord& span : c.spans) {
    model::span_to_fragments(c.pipeline, span, nullptr, fragments, counters, watch);
  }
}

void keep_fragments(const std::vector<FragmentRecord>& fragments, SpanOutput* keep) {
  for (std::size_t i = 0; keep != nullptr && i < fragments.size(); ++i) {
    keep->h[i] = fragments[i].h;
    keep->u[i] = fragments[i].u;
    keep->v[i] = fragments[i].v;
  }
}

SpanKernel make_scalar(const SpanCase& c) {
  return [&c, fragments = std::vector<FragmentRecord>()](SpanOutput* keep) mutable {
    run_scalar(c, fragments, model::NoObserve{});
    keep_fragments(fragments, keep);
  };
}

SpanKernel make_scalar_observed(const SpanCase& c) {
  return [&c, fragments = std::vector<FragmentRecord>(),
          statistics = std::make_shared<model::Statistics>()](SpanOutput* keep) mutable {
    run_scalar(c, fragments, model::Observe{statistics.get()});
    keep_fragments(fragments, keep);
  };
}

// The RTL's own span setup runs ahead of its pixels, as it is built; no gaps, no stalls.
SpanKernel make_verilated(const SpanCase& c) {
  struct Simulation {
    Rtl rtl;
    std::vector<RtlInputs> inputs;
  };
  auto s = std::make_shared<Simulation>(Simulation{Rtl(c.config), {}});
  for (const RowRecord& row : c.rows) {
    s->inputs.push_back(rtl_inputs(c.config, row, c.pipeline.constants.record.b));
  }
  return [&c, s](SpanOutput* keep) {
    const RtlRun run = run_rtl(s->rtl, s->inputs, {}, false);
    const Format& h = c.config.format(FormatId::span_h);
    const Format& uv = c.config.format(FormatId::span_uv);
    for (std::size_t i = 0; keep != nullptr && i < run.pixels.size(); ++i) {
      keep->h[i] = Rtl::from_port(run.pixels[i].h, h);
      keep->u[i] = Rtl::from_port(run.pixels[i].u, uv);
      keep->v[i] = Rtl::from_port(run.pixels[i].v, uv);
    }
  };
}

}  // namespace

std::vector<NamedKernel> span_kernels() {
  return {{"plain int64, constants", make_plain},
          {"model, scalar", make_scalar},
          {"model, scalar, statistics", make_scalar_observed},
          {"model, vector", make_vector},
          {"model, vector, statistics", make_vector_observed},
          {"model, specialised", make_specialised},
          {"sc_fix", make_sc_fix},
          {"sc_fix_fast", make_sc_fix_fast, false},
          {"sc_fixed_fast", make_sc_fixed_fast, false},
          {"RTL, Verilator", make_verilated}};
}

}  // namespace bitspan::bench
