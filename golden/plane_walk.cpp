// SPDX-License-Identifier: Apache-2.0
#include "golden/plane_walk.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "config/modes.hpp"
#include "golden/gradient.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// w(m, n) = w0 + along_major (m - M0) + along_minor (n - N0)
template <class Real>
struct Slopes {
  Real major = 0, minor = 0;
};

// |a| > |b|, of Pairs whose high is their sum rounded.
template <class T>
bool is_longer(Pair<T> a, Pair<T> b) {
  if (a.high < 0) a = -a;
  if (b.high < 0) b = -b;
  return a.high > b.high || (a.high == b.high && a.low > b.low);
}

template <class Real>
class PlaneWalker {
 public:
  PlaneWalker(const Config& config, const Constants& constants, int width, int height)
      : width_(width),
        height_(height),
        vertex_(config, constants.channels),
        q_g_(config.format(FormatId::plane_g)),
        q_k_(config.format(FormatId::plane_k)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        phase_scale_(pow2<Real>(config.format(FormatId::plane_k).fraction())),
        inclusive_(owns_every_edge(config.fill_rule)) {
    // u and v go along a row as the numerators do in a mode that divides per pixel; span_setup divides.
    const bool ideal_line = is_on_ideal_line(config.numerator);
    for (const Line& line : lines_of(config, constants.channels)) {
      PlaneLine& of = lines_.emplace_back();
      of.id = line.id;
      of.product = is_divided(line);
      of.on_ideal_line = line.id == LineId::h || (of.product && ideal_line);
      of.q_gradient = Quantizer<Real>(config.format(line.gradient));
      of.q_start = Quantizer<Real>(config.format(of.product ? FormatId::span_f : line.row.acc));
      of.q_step = Quantizer<Real>(config.format(of.product ? FormatId::span_f_step : line.row.step));
      if (!of.on_ideal_line && !of.product) of.offset = start_offset<Real>(config, line.row);
    }
  }

  void operator()(const SetupRecord& triangle, std::span<SetupChannelRecord> channels, PlaneRows& out) const {
    out.rows.clear();
    out.covered.clear();
    out.channels.clear();
    const Plane plane = make_plane(triangle, channels);
    out.plane = record_of(plane);
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const PlaneLine& line = lines_[fixed_lines + k];
      channels[k].w_x = line.q_gradient.raw(plane.rise[index_of(line.id)].x);
      channels[k].w_y = line.q_gradient.raw(plane.rise[index_of(line.id)].y);
    }
    walk(plane, out);
  }

 private:
  struct PlaneLine {
    LineId id{};
    bool product = false;        // Q[plane.g](w (h + B)) in place of w
    bool on_ideal_line = false;  // a row's values belong to it, else to the pixels' centres
    Quantizer<Real> q_gradient, q_start, q_step;
    Real offset = 0;
  };

  struct Plane {
    std::int64_t triangle = 0;
    std::array<VertexValues<Real>, 3> v;
    Real area = 0;
    std::array<std::array<Real, 3>, line_count> at{};  // the vertices
    std::array<Gradient<Real>, line_count> rise{};
    Real k = 0;
    bool major_is_y = false;
    std::int64_t major_first = 0;

    Real major_of(const VertexValues<Real>& p) const { return major_is_y ? p.y : p.x; }
    Real minor_of(const VertexValues<Real>& p) const { return major_is_y ? p.x : p.y; }
    Slopes<Real> along(const Gradient<Real>& g) const {
      return major_is_y ? Slopes<Real>{g.y, g.x} : Slopes<Real>{g.x, g.y};
    }
    // k (m - m0), the ideal line's height over its anchor.
    Real line(std::int64_t m) const { return k * Real(m - major_first); }
    std::int64_t digital_line(std::int64_t m) const { return to_integer(floor_of(line(m) + Real(0.5))); }
  };

  Plane make_plane(const SetupRecord& triangle, std::span<const SetupChannelRecord> channels) const {
    Plane p;
    p.triangle = triangle.triangle;
    p.v = vertex_.load(triangle, channels);
    const auto& v = p.v;
    const PlaneShape<Real> shape(v);
    p.area = shape.area;
    for (const PlaneLine& line : lines_) {
      std::array<Real, 3>& at = p.at[index_of(line.id)];
      at = line.product ? numerators_at(v, line.id, b_, q_g_) : at_vertices(v, line.id);
      p.rise[index_of(line.id)] = shape.gradient(at, line.q_gradient);
    }
    const auto& h = p.at[index_of(LineId::h)];
    const PairOf<Real> h_nx = shape.nx(h[0], h[1], h[2]);
    const PairOf<Real> h_ny = shape.ny(h[0], h[1], h[2]);
    p.major_is_y = is_longer(h_nx, h_ny);
    if (p.major_is_y) {
      p.k = q_k_.quotient(-h_ny, h_nx);
    } else if (h_ny.high != 0) {
      p.k = q_k_.quotient(-h_nx, h_ny);
    }
    const Real least = std::min({p.major_of(v[0]), p.major_of(v[1]), p.major_of(v[2])});
    p.major_first = to_integer(ceil_less_half(whole_of(least)));
    return p;
  }

  PlaneRecord record_of(const Plane& p) const {
    PlaneRecord out;
    out.triangle = p.triangle;
    out.major = p.major_is_y ? 1 : 0;
    out.major_first = p.major_first;
    for (const PlaneLine& line : lines_) {
      if (is_channel(line.id)) continue;
      const std::size_t i = index_of(line.id);
      const PlaneFields<PlaneRecord>& field = plane_fields[i];
      for (std::size_t k = 0; k < 3 && line.product; ++k) out.*field.at_vertex[k] = q_g_.raw(p.at[i][k]);
      out.*field.x = line.q_gradient.raw(p.rise[i].x);
      out.*field.y = line.q_gradient.raw(p.rise[i].y);
    }
    out.k = q_k_.raw(p.k);
    return out;
  }

  // An edge as the columns meet it: a centre at (m, n) is inside where
  // dist_m (m - M) + dist_n (n - N) > 0, or = 0 where the edge takes zero.
  struct Edge {
    Real dist_m = 0, dist_n = 0;
    Real major = 0;   // M
    Real offset = 0;  // N dist_n
    bool takes_zero = false;
  };
  Edge make_edge(const Plane& p, const VertexValues<Real>& a, const VertexValues<Real>& b) const {
    const bool positive = p.area > 0;
    const Real dist_x = positive ? a.y - b.y : b.y - a.y;
    const Real dist_y = positive ? b.x - a.x : a.x - b.x;
    Edge out;
    out.takes_zero = inclusive_ || dist_x > 0 || (dist_x == 0 && dist_y > 0);  // left or top edge
    out.dist_m = p.major_is_y ? dist_y : dist_x;
    out.dist_n = p.major_is_y ? dist_x : dist_y;
    out.major = p.major_of(a);
    out.offset = p.minor_of(a) * out.dist_n;
    return out;
  }

  // Keeps the pixels of the column whose centre is on the inner side of the edge.
  static void clip(const Edge& edge, std::int64_t m, PlaneRows::Column& column) {
    const Real here = edge.dist_m * (Real(m) + Real(0.5) - edge.major);
    if (edge.dist_n == 0) {
      if (here < 0 || (here == 0 && !edge.takes_zero)) column.last = column.first - 1;
      return;
    }
    const Whole<Real> crossing = whole_of_quotient(edge.offset - here, edge.dist_n);
    if (edge.dist_n > 0) {
      const Real first = edge.takes_zero ? ceil_less_half(crossing) : floor_less_half(crossing) + 1;
      column.first = std::max(column.first, to_integer(first));
    } else {
      const Real last = edge.takes_zero ? floor_less_half(crossing) : ceil_less_half(crossing) - 1;
      column.last = std::min(column.last, to_integer(last));
    }
  }

  void walk(const Plane& p, PlaneRows& out) const {
    const std::int64_t major_size = p.major_is_y ? height_ : width_;
    const std::int64_t minor_size = p.major_is_y ? width_ : height_;
    const Real greatest = std::max({p.major_of(p.v[0]), p.major_of(p.v[1]), p.major_of(p.v[2])});
    const std::int64_t m_begin = std::max<std::int64_t>(0, p.major_first);
    const std::int64_t m_end =
        std::min<std::int64_t>(major_size - 1, to_integer(floor_less_half(whole_of(greatest)))) + 1;
    if (m_begin >= m_end) return;

    const std::array<Edge, 3> edges{make_edge(p, p.v[0], p.v[1]), make_edge(p, p.v[1], p.v[2]),
                                    make_edge(p, p.v[2], p.v[0])};
    using Column = PlaneRows::Column;
    using Extent = PlaneRows::Extent;
    std::vector<Column>& columns = out.columns;
    columns.clear();
    std::int64_t row_begin = std::numeric_limits<std::int64_t>::max();
    std::int64_t row_last = std::numeric_limits<std::int64_t>::min();
    for (std::int64_t m = m_begin; m < m_end; ++m) {
      Column column{0, minor_size - 1, p.digital_line(m)};
      for (const Edge& edge : edges) clip(edge, m, column);
      if (column.first <= column.last) {
        row_begin = std::min(row_begin, column.first - column.line);
        row_last = std::max(row_last, column.last - column.line);
      }
      columns.push_back(column);
    }
    if (row_begin > row_last) return;

    // The first and last column of each row; columns come in order, so the last one seen is the last.
    std::vector<Extent>& extents = out.extents;
    extents.assign(static_cast<std::size_t>(row_last - row_begin + 1), {-1, -1});
    for (std::int64_t m = m_begin; m < m_end; ++m) {
      const Column& column = columns[static_cast<std::size_t>(m - m_begin)];
      for (std::int64_t n = column.first; n <= column.last; ++n) {
        Extent& extent = extents[static_cast<std::size_t>(n - column.line - row_begin)];
        if (extent.first < 0) extent.first = m;
        extent.last = m;
      }
    }
    for (std::size_t i = 0; i < extents.size(); ++i) {
      const Extent& extent = extents[i];
      if (extent.first < 0) continue;
      const std::int64_t row = row_begin + static_cast<std::int64_t>(i);
      for (std::int64_t m = extent.first; m <= extent.last; ++m) {
        const Column& column = columns[static_cast<std::size_t>(m - m_begin)];
        const std::int64_t n = row + column.line;
        out.covered.push_back(n >= column.first && n <= column.last ? 1 : 0);
      }
      const std::int64_t line = columns[static_cast<std::size_t>(extent.first - m_begin)].line;
      out.rows.push_back(make_row(p, row, extent.first, extent.last, row + line, out.channels));
    }
  }

  PlaneRowRecord make_row(const Plane& p, std::int64_t row, std::int64_t m, std::int64_t m_last,
                          std::int64_t n, std::vector<SpanChannelRecord>& channels) const {
    PlaneRowRecord out;
    out.triangle = p.triangle;
    out.row = row;
    out.major_first = m;
    out.minor_first = n;
    out.count = m_last - m + 1;
    // The ideal line's position above the pixel centre, -1/2 included to 1/2 excluded, is phase - 1/2.
    const Real above = p.line(m) - Real(n - row);
    const Real phase = above + Real(0.5);
    const Real from_major = Real(m) + Real(0.5) - p.major_of(p.v[0]);
    const Real from_minor = Real(n) + Real(0.5) - p.minor_of(p.v[0]);
    out.phase = to_integer(phase * phase_scale_);

    for (const PlaneLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      const Slopes<Real> w = p.along(p.rise[i]);
      const auto major = exact_product(w.major, from_major);
      const auto minor = exact_product(w.minor, from_minor);
      const std::int64_t start = line.q_start.raw(
          line.on_ideal_line ? line.q_start.sum(major, minor, exact_product(w.minor, above), p.at[i][0])
                             : line.q_start.sum(major, minor, p.at[i][0], line.offset));
      if (line.id == LineId::h) {  // is constant along the row
        out.h = start;
        continue;
      }
      const std::int64_t step0 = line.q_step.raw(
          line.on_ideal_line ? line.q_step.sum(exact_product(p.k, w.minor), w.major) : line.q_step(w.major));
      const std::int64_t step1 =
          line.on_ideal_line ? step0
                             : line.q_step.raw(line.q_step.sum(w.major, p.k < 0 ? -w.minor : w.minor));
      if (is_channel(line.id)) {
        channels.push_back({.triangle = p.triangle,
                            .x = p.major_is_y ? n : m,
                            .y = p.major_is_y ? m : n,
                            .channel = channel_of(line.id),
                            .w = start,
                            .w_step0 = step0,
                            .w_step1 = step1});
        continue;
      }
      const PlaneRowFields& field = plane_row_fields[i];
      out.*field.start = start;
      out.*field.step0 = step0;
      out.*field.step1 = step1;
    }
    return out;
  }

  std::int64_t width_, height_;
  VertexFormats<Real> vertex_;
  Quantizer<Real> q_g_, q_k_;
  Real b_, phase_scale_;
  bool inclusive_;
  std::vector<PlaneLine> lines_;
};

}  // namespace

PlaneWalkStage make_plane_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                               int width, int height) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> PlaneWalkStage {
    return PlaneWalker<Real>(config, constants, width, height);
  });
}

}  // namespace bitspan::golden
