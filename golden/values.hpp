// SPDX-License-Identifier: Apache-2.0
// Records as values: the vertices of a SetupRecord and the groups of four shades, read and written by
// position.
#pragma once

#include <array>
#include <span>

#include "engine/records.hpp"
#include "golden/quantize.hpp"

namespace bitspan::golden {

inline constexpr int channels = 4;  // red, green, blue, alpha

template <class Real>
using Shades = std::array<Real, channels>;

template <class Real>
struct VertexValues {
  Real x = 0, y = 0, h = 0, u = 0, v = 0;
  Shades<Real> c{};
};

inline constexpr std::size_t vertex_fields = 9;
inline constexpr std::size_t first_vertex_field = 2;
static_assert(fields<SetupRecord>[first_vertex_field].name == "x0");
static_assert(fields<SetupRecord>[first_vertex_field + vertex_fields].name == "x1");
static_assert(fields<SetupRecord>[first_vertex_field + vertex_fields + 8].name == "a1");

template <class R>
std::span<std::int64_t> mutable_raw_values(R& record) {
  return {reinterpret_cast<std::int64_t*>(&record), fields<R>.size()};
}

// The formats of a vertex.
template <class Real>
struct VertexFormats {
  Quantizer<Real> xy, h, uv, shade;
  explicit VertexFormats(const Config& config)
      : xy(config.coordinate_format()),
        h(config.format(FormatId::setup_h)),
        uv(config.format(FormatId::setup_uv)),
        shade(config.format(FormatId::setup_shade)) {}

  VertexValues<Real> load(const SetupRecord& record, int vertex) const {
    const auto raw =
        raw_values(record).subspan(first_vertex_field + vertex_fields * static_cast<std::size_t>(vertex));
    VertexValues<Real> out{xy.value(raw[0]), xy.value(raw[1]), h.value(raw[2]),
                           uv.value(raw[3]), uv.value(raw[4]), {}};
    for (std::size_t i = 0; i < channels; ++i) out.c[i] = shade.value(raw[5 + i]);
    return out;
  }
  void store(const VertexValues<Real>& v, SetupRecord& record, int vertex) const {
    const auto raw = mutable_raw_values(record).subspan(first_vertex_field +
                                                        vertex_fields * static_cast<std::size_t>(vertex));
    raw[0] = xy.raw(v.x);
    raw[1] = xy.raw(v.y);
    raw[2] = h.raw(v.h);
    raw[3] = uv.raw(v.u);
    raw[4] = uv.raw(v.v);
    for (std::size_t i = 0; i < channels; ++i) raw[5 + i] = shade.raw(v.c[i]);
  }
};

template <class Real>
Shades<Real> load_shades(const Quantizer<Real>& q, std::int64_t r, std::int64_t g, std::int64_t b,
                         std::int64_t a) {
  return {q.value(r), q.value(g), q.value(b), q.value(a)};
}

template <class Real>
void store_shades(const Quantizer<Real>& q, const Shades<Real>& c, std::int64_t& r, std::int64_t& g,
                  std::int64_t& b, std::int64_t& a) {
  r = q.raw(c[0]);
  g = q.raw(c[1]);
  b = q.raw(c[2]);
  a = q.raw(c[3]);
}

// Returns a start offset as a value; `kept` is the format whose half ulp it may be.
template <class Real>
Real start_offset(const StartOffset& offset, const Format& kept) {
  return offset.half_ulp ? pow2<Real>(-kept.fraction() - 1) : Real(offset.value);
}

// Returns the start value of an accumulator, Q(from + step distance + offset); all of them are formed by this
// class.
template <class Real>
class PreStep {
 public:
  PreStep() = default;
  PreStep(const StartOffset& offset, const Format& kept) : offset_(start_offset<Real>(offset, kept)) {}
  Real operator()(const Quantizer<Real>& q, Real from, Real step, Real distance) const {
    const auto product = exact_product(step, distance);
    return offset_ == 0 ? q.sum(product, from) : q.sum(product, from, offset_);
  }

 private:
  Real offset_ = 0;
};

}  // namespace bitspan::golden
