// SPDX-License-Identifier: Apache-2.0
#include "golden/span_setup.hpp"

#include "config/modes.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

void append_channel(std::vector<SpanChannelRecord>& channels, const SpanRecord& span, LineId id,
                    std::int64_t w, std::int64_t step) {
  channels.push_back({.triangle = span.triangle,
                      .x = span.x,
                      .y = span.y,
                      .channel = channel_of(id),
                      .w = w,
                      .w_step0 = step,
                      .w_step1 = step});
}

template <class Real>
class SpanSetup {
 public:
  SpanSetup(const Config& config, const Constants& constants)
      : perspective_(config.perspective),
        q_x_(config.format(FormatId::edge_x)),
        q_edge_h_(config.format(FormatId::edge_h)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        form_(form_of(config.row_slope)),
        unit_(config.row_reciprocal, config.format(FormatId::edge_x).fraction()) {
    for (const Line& line : lines_of(config, constants.channels)) {
      RowLine& of = lines_.emplace_back();
      of.id = line.id;
      of.divides = is_divided(line);
      of.q_end = Quantizer<Real>(config.format(line.edge.kept));
      of.q_step = Quantizer<Real>(config.format(line.row.step));
      of.q_start = Quantizer<Real>(config.format(line.row.acc));
      if (line.row.difference) of.q_difference = Quantizer<Real>(config.format(*line.row.difference));
      of.start = PreStep<Real>(start_offset<Real>(config, line.row));
    }
  }

  SpanRecord operator()(const RowRecord& row, std::span<const RowChannelRecord> row_channels,
                        std::vector<SpanChannelRecord>& channels) const {
    const Real x_l = q_x_.value(row.l_x);
    const Real length = q_x_.value(row.r_x) - x_l;
    const Real pre = Real(row.x_first) + Real(0.5) - x_l;
    const bool sloped = length > 0;
    const Divisor<Real> pixels = sloped ? Divisor<Real>(length, form_, unit_) : Divisor<Real>();

    SpanRecord out;
    out.triangle = row.triangle;
    out.x = row.x_first;
    out.y = row.y;
    out.count = row.x_last - row.x_first + 1;
    if (pixels.reciprocal) {
      out.recip_m = unit_.raw(pixels.inverse.m);
      out.recip_e = pixels.inverse.e;
    }
    const Real q_l = q_edge_h_.value(row.l_h) + b_;
    const Real q_r = q_edge_h_.value(row.r_h) + b_;
    for (const RowLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      if (is_channel(line.id)) {
        const Real from = line.q_end.value(row_channels.front().l);
        const Real step =
            sloped ? pixels.slope(line.q_end.value(row_channels.front().r) - from, line.q_step) : Real(0);
        row_channels = row_channels.subspan(1);
        append_channel(channels, out, line.id, line.q_start.raw(line.start(line.q_start, from, step, pre)),
                       line.q_step.raw(step));
        continue;
      }
      const SpanFields& field = span_fields[i];
      const std::int64_t raw_l = row.*row_fields[i].l;
      Real from = line.q_end.value(raw_l);
      const Real to = line.q_end.value(row.*row_fields[i].r);
      Real difference = to - from;
      if (line.divides) {
        switch (perspective_) {
          case Perspective::delta_f:
            difference = line.q_difference.product(difference, q_r);
            out.*field.difference = line.q_difference.raw(difference);
            out.*field.base = raw_l;
            from = 0;
            break;
          case Perspective::hyperbolic: {
            const Real end = line.q_difference.product(to, q_r);
            out.*field.difference = line.q_difference.raw(end);
            from = line.q_difference.product(from, q_l);
            difference = end - from;
            break;
          }
          case Perspective::affine:
          case Perspective::const_depth_rows:  // one divides nothing, the other has no horizontal rows
            unreachable();
        }
      }
      const Real step = sloped ? pixels.slope(difference, line.q_step) : Real(0);
      out.*field.start = line.q_start.raw(line.start(line.q_start, from, step, pre));
      out.*field.step0 = out.*field.step1 = line.q_step.raw(step);
    }
    return out;
  }

 private:
  struct RowLine {
    LineId id{};
    bool divides = false;  // pixels divide it by h + B
    Quantizer<Real> q_end, q_step, q_start, q_difference;
    PreStep<Real> start;
  };

  Perspective perspective_;
  Quantizer<Real> q_x_, q_edge_h_;
  Real b_;
  SlopeForm form_;
  ReciprocalUnit<Real> unit_;
  std::vector<RowLine> lines_;
};

// slope.row = plane.
template <class Real>
class TriangleSpanSetup {
 public:
  TriangleSpanSetup(const Config& config, const Constants& constants) : vertex_(config, constants.channels) {
    for (const Line& line : lines_of(config, constants.channels)) {
      RisenLine& of = lines_.emplace_back();
      of.id = line.id;
      of.q_vertex = Quantizer<Real>(config.format(line.product.value_or(line.vertex)));
      of.q_gradient = Quantizer<Real>(config.format(line.gradient));
      of.q_step = Quantizer<Real>(config.format(line.row.step));
      of.q_start = Quantizer<Real>(config.format(line.row.acc));
      of.offset = start_offset<Real>(config, line.row);
    }
  }

  SpanRecord operator()(const RowRecord& row, const SetupRecord& triangle, const SetupPlaneRecord& plane,
                        std::span<const SetupChannelRecord> of_triangle,
                        std::vector<SpanChannelRecord>& channels) const {
    const VertexValues<Real> origin = vertex_.load(triangle, 0, of_triangle);
    const Real right = Real(row.x_first) + Real(0.5) - origin.x;
    const Real down = Real(row.y) + Real(0.5) - origin.y;
    SpanRecord out;
    out.triangle = row.triangle;
    out.x = row.x_first;
    out.y = row.y;
    out.count = row.x_last - row.x_first + 1;
    out.u1 = plane.u1;
    out.v1 = plane.v1;
    for (const RisenLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      const auto start = [&](Real at, Real x, Real y) {
        return line.q_start.raw(
            line.q_start.sum(exact_product(x, right), exact_product(y, down), at, line.offset));
      };
      if (is_channel(line.id)) {
        const Real x = line.q_gradient.value(of_triangle.front().w_x);
        const Real y = line.q_gradient.value(of_triangle.front().w_y);
        of_triangle = of_triangle.subspan(1);
        append_channel(channels, out, line.id, start(origin.line[i], x, y), line.q_step.raw(line.q_step(x)));
        continue;
      }
      const PlaneFields<SetupPlaneRecord>& from = setup_plane_fields[i];
      const Real at =
          from.at_vertex[0] == nullptr ? origin.line[i] : line.q_vertex.value(plane.*from.at_vertex[0]);
      const Real x = line.q_gradient.value(plane.*from.x);
      out.*span_fields[i].start = start(at, x, line.q_gradient.value(plane.*from.y));
      out.*span_fields[i].step0 = out.*span_fields[i].step1 = line.q_step.raw(line.q_step(x));
    }
    return out;
  }

 private:
  struct RisenLine {
    LineId id{};
    Quantizer<Real> q_vertex, q_gradient, q_step, q_start;
    Real offset = 0;
  };

  VertexFormats<Real> vertex_;
  std::vector<RisenLine> lines_;
};

template <class Real>
class PlaneSpanSetup {
 public:
  PlaneSpanSetup(const Config& config, const Constants& constants)
      : q_h_(config.format(FormatId::span_h)),
        q_f_(config.format(FormatId::span_f)),
        q_f_step_(config.format(FormatId::span_f_step)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        unit_(config.row_reciprocal, depth_sum_fraction(config, FormatId::span_h)) {
    for (const Line& line : lines_of(config)) {
      DividedLine& of = lines_.emplace_back();
      of.id = line.id;
      of.divides = is_divided(line);
      of.q_start = Quantizer<Real>(config.format(line.row.acc));
      of.q_step = Quantizer<Real>(config.format(line.row.step));
      of.offset = start_offset<Real>(config, line.row);
    }
  }

  SpanRecord operator()(const PlaneRecord& plane, const PlaneRowRecord& row) const {
    SpanRecord out;
    out.triangle = row.triangle;
    out.x = plane.major == 0 ? row.major_first : row.minor_first;
    out.y = plane.major == 0 ? row.minor_first : row.major_first;
    out.count = row.count;
    const Inverse<Real> inverse = unit_(q_h_.value(row.h) + b_);
    out.recip_m = unit_.raw(inverse.m);
    out.recip_e = inverse.e;
    out.phase = row.phase;
    for (const DividedLine& line : lines_) {
      const SpanFields& to = span_fields[index_of(line.id)];
      const PlaneRowFields& from = plane_row_fields[index_of(line.id)];
      const auto step = [&](std::int64_t raw) {
        return line.divides ? line.q_step.raw(line.q_step.product(inverse.times(q_f_step_.value(raw)))) : raw;
      };
      const std::int64_t start = row.*from.start;
      out.*to.start = line.divides
                          ? line.q_start.raw(line.q_start.sum(inverse.times(q_f_.value(start)), line.offset))
                          : start;
      if (from.step0 == nullptr) continue;
      out.*to.step0 = step(row.*from.step0);
      out.*to.step1 = step(row.*from.step1);
    }
    return out;
  }

 private:
  struct DividedLine {
    LineId id{};
    bool divides = false;  // by the row's h + B; else the plane row's values are taken as they are
    Quantizer<Real> q_start, q_step;
    Real offset = 0;
  };

  Quantizer<Real> q_h_, q_f_, q_f_step_;
  Real b_;
  ReciprocalUnit<Real> unit_;
  std::vector<DividedLine> lines_;
};

}  // namespace

SpanSetupStage make_span_setup(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> SpanSetupStage { return SpanSetup<Real>(config, constants); });
}

TriangleSpanSetupStage make_triangle_span_setup(Arithmetic arithmetic, const Config& config,
                                                const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> TriangleSpanSetupStage {
    return TriangleSpanSetup<Real>(config, constants);
  });
}

PlaneSpanSetupStage make_plane_span_setup(Arithmetic arithmetic, const Config& config,
                                          const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> PlaneSpanSetupStage {
    return PlaneSpanSetup<Real>(config, constants);
  });
}

}  // namespace bitspan::golden
