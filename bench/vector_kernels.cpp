// SPDX-License-Identifier: Apache-2.0
// The model's vector forms of the span stage, as kernels of the benchmark.
#include "bench/vector_kernels.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>

#include "model/simd/shipped.hpp"
#include "model/simd/spans.hpp"

namespace bitspan::bench {
namespace {

using Lane = std::int32_t;

struct Forms {
  model::SpanKernels<Lane> kernels;
  model::Columns<SpanRecord> spans;
  model::SpanWork<Lane> work;
  model::Columns<FragmentRecord> fragments;
  model::Statistics statistics;
};

std::shared_ptr<Forms> forms_of(const SpanCase& c, bool specialised) {
  if (const char* refusal = model::spans_refusal(c.config); refusal != nullptr) {
    throw InputError(refusal);
  }
  auto f = std::make_shared<Forms>();
  f->kernels = model::span_kernels<Lane>(VectorTarget::best);
  if (specialised) {
    if (model::shipped_index(c.config).spans < 0) {
      throw InputError("specialised for the shipped configurations only");
    }
    f->kernels.evaluate =
        model::shipped_span_kernels(VectorTarget::best, model::shipped_index(c.config).spans).evaluate;
  }
  f->spans.reserve(c.spans.size());
  f->spans.size = c.spans.size();
  for (std::size_t i = 0; i < c.spans.size(); ++i) {
    using Raw = std::array<std::int64_t, fields<SpanRecord>.size()>;
    const auto raw = std::bit_cast<Raw>(c.spans[i]);
    for (std::size_t field = 0; field < raw.size(); ++field) {
      f->spans[std::bit_cast<std::int64_t SpanRecord::*>(field * sizeof(std::int64_t))][i] = raw[field];
    }
  }
  f->fragments.reserve(static_cast<std::size_t>(std::ranges::max(c.spans, {}, &SpanRecord::count).count));
  return f;
}

SpanKernel kernel_of(const SpanCase& c, bool specialised, bool observed) {
  return [&c, observed, f = forms_of(c, specialised)](SpanOutput* keep) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < f->spans.size; ++i) {
      if (observed) {
        f->kernels.evaluate_observed(c.pipeline.span, f->spans, i, false, f->work, f->fragments,
                                     f->statistics);
      } else {
        f->kernels.evaluate(c.pipeline.span, f->spans, i, false, f->work, f->fragments);
      }
      const auto count = static_cast<std::size_t>(c.spans[i].count);
      if (keep != nullptr) {
        const auto copy = [&](std::int64_t FragmentRecord::*from, std::vector<std::int64_t>& to) {
          std::copy_n(f->fragments[from], count, to.begin() + static_cast<std::ptrdiff_t>(at));
        };
        copy(&FragmentRecord::h, keep->h);
        copy(&FragmentRecord::u, keep->u);
        copy(&FragmentRecord::v, keep->v);
      }
      at += count;
    }
  };
}

}  // namespace

SpanKernel make_vector(const SpanCase& c) { return kernel_of(c, false, false); }
SpanKernel make_vector_observed(const SpanCase& c) { return kernel_of(c, false, true); }
SpanKernel make_specialised(const SpanCase& c) { return kernel_of(c, true, false); }

}  // namespace bitspan::bench
