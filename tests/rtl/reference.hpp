// SPDX-License-Identifier: Apache-2.0
// span_setup and span of docs/numeric-spec.md in exact rational numbers: slow, written from the page alone,
// and sharing nothing with the engines. Fields that the RTL does not have stay 0.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/records.hpp"

namespace bitspan::reference {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

Rational power_of_two(int exponent);
Integer floor(const Rational& x);
Rational value(std::int64_t raw, const Format& format);
// Q[format](x), as a raw integer.
std::int64_t quantize(const Rational& x, const Format& format);

struct MantissaExponent {
  std::int64_t m = 0;  // raw
  int e = 0;
};
// R(d); ulp is the operand's grid, for d <= 0.
MantissaExponent reciprocal(const Rational& d, const Rational& ulp, const Reciprocal& unit);

SpanRecord span_setup(const Config& config, const RowRecord& row, std::int64_t b);
SpanRecord span_setup(const Config& config, const PlaneRowRecord& row, std::int64_t b);

// Of a channel: from its values at the row's ends and from the row's span record.
SpanChannelRecord span_setup(const Config& config, const RowRecord& row, const SpanRecord& span,
                             const RowChannelRecord& ends);

struct Pixel {
  FragmentRecord fragment;
  bool step = false;
};
std::vector<Pixel> span(const Config& config, const SpanRecord& record, std::int64_t k, std::int64_t b);
// Of a channel, one per pixel of its span.
std::vector<FragmentChannelRecord> span(const Config& config, const SpanChannelRecord& record,
                                        std::span<const Pixel> pixels);

}  // namespace bitspan::reference
