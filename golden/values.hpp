// SPDX-License-Identifier: Apache-2.0
// Records as values: the vertices of a SetupRecord, read and written by position, and four shades.
#pragma once

#include <array>
#include <span>

#include "engine/records.hpp"
#include "golden/lines.hpp"
#include "golden/quantize.hpp"

namespace bitspan::golden {

inline constexpr int channels = 4;  // red, green, blue, alpha

template <class Real>
using Shades = std::array<Real, channels>;

template <class Real>
struct VertexValues {
  Real x = 0, y = 0;
  std::array<Real, line_count> line{};

  Real operator[](LineId id) const { return line[index_of(id)]; }
};

inline constexpr std::size_t vertex_fields = 2 + fixed_lines;
inline constexpr std::size_t first_vertex_field = 2;
static_assert(fields<SetupRecord>[first_vertex_field].name == "x0");
static_assert(fields<SetupRecord>[first_vertex_field + 2].name == "h0");
static_assert(fields<SetupRecord>[first_vertex_field + vertex_fields].name == "x1");
static_assert(fields<SetupRecord>[first_vertex_field + vertex_fields + 8].name == "a1");

template <class R>
std::span<std::int64_t> mutable_raw_values(R& record) {
  return {reinterpret_cast<std::int64_t*>(&record), fields<R>.size()};
}

// The formats of a vertex.
template <class Real>
struct VertexFormats {
  Quantizer<Real> xy;
  std::array<Quantizer<Real>, line_count> line;
  std::array<Quantizer<Real>, line_count> product;  // of homogeneous channels
  explicit VertexFormats(const Config& config, const std::vector<LineId>& channels = {})
      : xy(config.coordinate_format()) {
    for (const Line& of : lines_of(config, channels)) {
      line[index_of(of.id)] = Quantizer<Real>(config.format(of.vertex));
      if (of.product) product[index_of(of.id)] = Quantizer<Real>(config.format(*of.product));
    }
  }
  const Quantizer<Real>& operator[](LineId id) const { return line[index_of(id)]; }

  // channels: the triangle's records of them; a homogeneous one is what is interpolated, w (h + B).
  VertexValues<Real> load(const SetupRecord& record, std::size_t vertex,
                          std::span<const SetupChannelRecord> channels = {}) const {
    const auto raw = raw_values(record).subspan(first_vertex_field + vertex_fields * vertex);
    VertexValues<Real> out{xy.value(raw[0]), xy.value(raw[1]), {}};
    for (std::size_t i = 0; i < fixed_lines; ++i) out.line[i] = line[i].value(raw[2 + i]);
    for (const SetupChannelRecord& channel : channels) {
      const std::size_t i = index_of(channel_line(channel.channel));
      const bool homogeneous = line_of(channel_line(channel.channel), {}).is_homogeneous();
      out.line[i] = homogeneous ? product[i].value(channel.*channel_products[vertex])
                                : line[i].value(channel.*channel_vertices[vertex]);
    }
    return out;
  }
  std::array<VertexValues<Real>, 3> load(const SetupRecord& record,
                                         std::span<const SetupChannelRecord> channels = {}) const {
    return {load(record, 0, channels), load(record, 1, channels), load(record, 2, channels)};
  }
  void store(const VertexValues<Real>& v, SetupRecord& record, std::size_t vertex) const {
    const auto raw = mutable_raw_values(record).subspan(first_vertex_field + vertex_fields * vertex);
    raw[0] = xy.raw(v.x);
    raw[1] = xy.raw(v.y);
    for (std::size_t i = 0; i < fixed_lines; ++i) raw[2 + i] = line[i].raw(v.line[i]);
  }
};

template <class Real>
Shades<Real> load_shades(const Quantizer<Real>& q, std::int64_t r, std::int64_t g, std::int64_t b,
                         std::int64_t a) {
  return {q.value(r), q.value(g), q.value(b), q.value(a)};
}

// Returns a start offset as a value; `kept` is the format whose half ulp it may be.
template <class Real>
Real start_offset(const StartOffset& offset, const Format& kept) {
  return offset.half_ulp ? pow2<Real>(-kept.fraction() - 1) : Real(offset.value);
}

// Returns the offset that a line's accumulator starts with, on a walk of config/lines.hpp.
template <class Real>
Real start_offset(const Config& config, const LineWalk& walk) {
  if (walk.offset == nullptr) return 0;
  return start_offset<Real>(config.start_offset.*walk.offset,
                            walk.half_ulp_of ? config.format(*walk.half_ulp_of) : config.depth_format());
}

// Returns the start value of an accumulator, Q(from + step distance + offset); all of them are formed by this
// class.
template <class Real>
class PreStep {
 public:
  PreStep() = default;
  explicit PreStep(Real offset) : offset_(offset) {}
  Real operator()(const Quantizer<Real>& q, Real from, Real step, Real distance) const {
    const auto product = exact_product(step, distance);
    return offset_ == 0 ? q.sum(product, from) : q.sum(product, from, offset_);
  }

 private:
  Real offset_ = 0;
};

}  // namespace bitspan::golden
