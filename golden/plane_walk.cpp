// SPDX-License-Identifier: Apache-2.0
#include "golden/plane_walk.hpp"

#include <algorithm>
#include <array>
#include <limits>

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
        vertex_(config),
        q_g_(config.format(FormatId::plane_g)),
        q_h_grad_(config.format(FormatId::plane_h_grad)),
        q_g_grad_(config.format(FormatId::plane_g_grad)),
        q_shade_grad_(config.format(FormatId::plane_shade_grad)),
        q_k_(config.format(FormatId::plane_k)),
        q_h_(config.format(FormatId::span_h)),
        q_f_(config.format(FormatId::span_f)),
        q_f_step_(config.format(FormatId::span_f_step)),
        q_shade_acc_(config.format(FormatId::span_shade_acc)),
        q_shade_step_(config.format(FormatId::span_shade_step)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        phase_scale_(pow2<Real>(config.format(FormatId::plane_k).fraction())),
        offset_shade_(
            start_offset<Real>(config.start_offset.span_shade, config.format(FormatId::span_shade))),
        inclusive_(owns_every_edge(config.fill_rule)),
        ideal_line_(is_on_ideal_line(config.numerator)) {}

  void operator()(const SetupRecord& triangle, PlaneRows& out) const {
    out.rows.clear();
    out.covered.clear();
    const Plane plane = make_plane(triangle);
    out.plane = record_of(plane);
    walk(plane, out);
  }

 private:
  struct Plane {
    std::int64_t triangle = 0;
    std::array<VertexValues<Real>, 3> v;
    Real area = 0;
    std::array<Real, 3> gu, gv;
    Gradient<Real> h, gu_xy, gv_xy;
    std::array<Gradient<Real>, channels> c;
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

  Plane make_plane(const SetupRecord& triangle) const {
    Plane p;
    p.triangle = triangle.triangle;
    for (int i = 0; i < 3; ++i) p.v[static_cast<std::size_t>(i)] = vertex_.load(triangle, i);
    const auto& v = p.v;
    const PlaneShape<Real> shape(v);
    p.area = shape.area;
    const Numerators<Real> numerators(v, b_, q_g_);
    p.gu = numerators.gu;
    p.gv = numerators.gv;
    p.h = shape.gradient({v[0].h, v[1].h, v[2].h}, q_h_grad_);
    p.gu_xy = shape.gradient(p.gu, q_g_grad_);
    p.gv_xy = shape.gradient(p.gv, q_g_grad_);
    for (std::size_t i = 0; i < channels; ++i) {
      p.c[i] = shape.gradient({v[0].c[i], v[1].c[i], v[2].c[i]}, q_shade_grad_);
    }
    const PairOf<Real> h_nx = shape.nx(v[0].h, v[1].h, v[2].h);
    const PairOf<Real> h_ny = shape.ny(v[0].h, v[1].h, v[2].h);
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
    out.gu0 = q_g_.raw(p.gu[0]);
    out.gv0 = q_g_.raw(p.gv[0]);
    out.gu1 = q_g_.raw(p.gu[1]);
    out.gv1 = q_g_.raw(p.gv[1]);
    out.gu2 = q_g_.raw(p.gu[2]);
    out.gv2 = q_g_.raw(p.gv[2]);
    out.h_x = q_h_grad_.raw(p.h.x);
    out.h_y = q_h_grad_.raw(p.h.y);
    out.gu_x = q_g_grad_.raw(p.gu_xy.x);
    out.gu_y = q_g_grad_.raw(p.gu_xy.y);
    out.gv_x = q_g_grad_.raw(p.gv_xy.x);
    out.gv_y = q_g_grad_.raw(p.gv_xy.y);
    store_shades(q_shade_grad_, {p.c[0].x, p.c[1].x, p.c[2].x, p.c[3].x}, out.r_x, out.g_x, out.b_x, out.a_x);
    store_shades(q_shade_grad_, {p.c[0].y, p.c[1].y, p.c[2].y, p.c[3].y}, out.r_y, out.g_y, out.b_y, out.a_y);
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
      out.rows.push_back(make_row(p, row, extent.first, extent.last, row + line));
    }
  }

  PlaneRowRecord make_row(const Plane& p, std::int64_t row, std::int64_t m, std::int64_t m_last,
                          std::int64_t n) const {
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

    const Slopes<Real> h = p.along(p.h);
    out.h = q_h_.raw(q_h_.sum(exact_product(h.major, from_major), exact_product(h.minor, from_minor),
                              exact_product(h.minor, above), p.v[0].h));
    const auto numerator = [&](Real g0, const Slopes<Real>& g, std::int64_t& start, std::int64_t& step0,
                               std::int64_t& step1) {
      if (ideal_line_) {
        start = q_f_.raw(q_f_.sum(exact_product(g.major, from_major), exact_product(g.minor, from_minor),
                                  exact_product(g.minor, above), g0));
        step0 = step1 = q_f_step_.raw(q_f_step_.sum(exact_product(p.k, g.minor), g.major));
      } else {
        start =
            q_f_.raw(q_f_.sum(exact_product(g.major, from_major), exact_product(g.minor, from_minor), g0));
        step0 = q_f_step_.raw(q_f_step_(g.major));
        step1 = q_f_step_.raw(q_f_step_.sum(g.major, p.k < 0 ? -g.minor : g.minor));
      }
    };
    numerator(p.gu[0], p.along(p.gu_xy), out.gu, out.gu_step0, out.gu_step1);
    numerator(p.gv[0], p.along(p.gv_xy), out.gv, out.gv_step0, out.gv_step1);

    Shades<Real> start;
    Shades<Real> step0;
    Shades<Real> step1;
    for (std::size_t i = 0; i < channels; ++i) {
      const Slopes<Real> c = p.along(p.c[i]);
      start[i] = q_shade_acc_.sum(exact_product(c.major, from_major), exact_product(c.minor, from_minor),
                                  p.v[0].c[i], offset_shade_);
      step0[i] = q_shade_step_(c.major);
      step1[i] = q_shade_step_.sum(c.major, p.k < 0 ? -c.minor : c.minor);
    }
    store_shades(q_shade_acc_, start, out.r, out.g, out.b, out.a);
    store_shades(q_shade_step_, step0, out.r_step0, out.g_step0, out.b_step0, out.a_step0);
    store_shades(q_shade_step_, step1, out.r_step1, out.g_step1, out.b_step1, out.a_step1);
    return out;
  }

  std::int64_t width_, height_;
  VertexFormats<Real> vertex_;
  Quantizer<Real> q_g_, q_h_grad_, q_g_grad_, q_shade_grad_, q_k_, q_h_, q_f_, q_f_step_, q_shade_acc_,
      q_shade_step_;
  Real b_, phase_scale_, offset_shade_;
  bool inclusive_, ideal_line_;
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
