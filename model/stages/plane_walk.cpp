// SPDX-License-Identifier: Apache-2.0
#include "model/stages/plane_walk.hpp"

#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/gradient.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/setup.hpp"

namespace bitspan::model {
namespace {

template <class Watch>
void put(const TriangleShape& g, const VertexTriple& w, const Register& r, Watch watch, std::int64_t& x,
         std::int64_t& y) {
  const Rises n = rises(g, w);
  x = quantize_ratio(n.nx, g.area, r, watch);
  y = quantize_ratio(n.ny, g.area, r, watch);
}

template <class Watch>
GradientRecord gradients_of(const PlaneWalkStage& stage, const SetupRecord& setup,
                            const std::array<SetupVertex, 3>& v, const TriangleShape& g, Watch watch) {
  GradientRecord out;
  out.triangle = setup.triangle;
  VertexTriple h;
  std::array<std::array<std::int64_t, 2>, 3> numerators{};  // gu, gv of each vertex, raw
  for (std::size_t i = 0; i < 3; ++i) {
    h[i] = value_of(v[i].h, stage.vertex_h);
    const Exact q = h[i] + stage.b;
    numerators[i] = {quantize(value_of(v[i].u, stage.vertex_uv) * q, stage.g, watch),
                     quantize(value_of(v[i].v, stage.vertex_uv) * q, stage.g, watch)};
  }
  out.gu0 = numerators[0][0];
  out.gv0 = numerators[0][1];
  out.gu1 = numerators[1][0];
  out.gv1 = numerators[1][1];
  out.gu2 = numerators[2][0];
  out.gv2 = numerators[2][1];
  const auto numerator = [&](std::size_t i) {
    return VertexTriple{value_of(numerators[0][i], stage.g), value_of(numerators[1][i], stage.g),
                        value_of(numerators[2][i], stage.g)};
  };
  put(g, h, stage.h_grad, watch, out.h_x, out.h_y);
  put(g, numerator(0), stage.g_grad, watch, out.gu_x, out.gu_y);
  put(g, numerator(1), stage.g_grad, watch, out.gv_x, out.gv_y);
  return out;
}

Exact magnitude(Exact a) { return a.raw < 0 ? -a : a; }

// Pixels n of column m for which (m, n) is covered and in the viewport: first..last, empty where first >
// last.
struct Interval {
  int128 first, last;
};
Interval covered_minor(const Coverage& coverage, bool along_y, std::int64_t m, std::int64_t minor_size) {
  Interval n{0, minor_size - 1};
  for (const Coverage::Side& s : coverage.sides) {
    const int128 at = (along_y ? s.b : s.a) * m + s.c;  // the side's value at n = 0
    const int128 slope = along_y ? s.a : s.b;
    if (slope > 0) {
      n.first = std::max(n.first, -floor_divide(at, slope).floor);
    } else if (slope < 0) {
      n.last = std::min(n.last, floor_divide(at, -slope).floor);
    } else if (at < 0) {
      n.last = -1;
    }
  }
  return n;
}

// D(m) = floor(k (m - m0) + 1/2)
std::int64_t line_at(const PlaneGeometry& g, std::int64_t from_anchor) {
  const int128 twice = 2 * int128{g.k} * from_anchor + g.one;
  return static_cast<std::int64_t>(floor_divide(twice, 2 * int128{g.one}).floor);
}

void find_runs(const PlaneWalkStage& stage, const TriangleShape& g, PlaneWalkState& state) {
  const bool along_y = state.geometry.along_y;
  const auto& major = along_y ? g.y : g.x;
  const std::int64_t major_size = along_y ? stage.height : stage.width;
  const std::int64_t minor_size = along_y ? stage.width : stage.height;
  const Exact half{1, 1};
  // One column more on each side than the centres need: the exact test decides.
  const auto by_raw = [](Exact a, Exact b) { return a.raw < b.raw; };
  const auto low = floor_of(*std::min_element(major.begin(), major.end(), by_raw) - half);
  const auto high = ceil_of(*std::max_element(major.begin(), major.end(), by_raw) - half);
  const auto m_first = static_cast<std::int64_t>(std::max<int128>(0, low));
  const auto m_last = static_cast<std::int64_t>(std::min<int128>(major_size - 1, high));

  struct Column {
    std::int64_t m, first_row, last_row;
  };
  state.runs.clear();
  state.row = state.row_end = state.row_begin = 0;
  bool any = false;
  const auto rows_of = [&](std::int64_t m, Column& c) {
    const Interval n = covered_minor(state.geometry.coverage, along_y, m, minor_size);
    const std::int64_t line = line_at(state.geometry, m - state.record.major_first);
    c = {m, static_cast<std::int64_t>(n.first) - line, static_cast<std::int64_t>(n.last) - line};
    return n.first <= n.last;
  };
  Column c{};
  std::int64_t begin = 0;
  std::int64_t end = 0;
  for (std::int64_t m = m_first; m <= m_last; ++m) {
    if (rows_of(m, c)) {
      begin = any ? std::min(begin, c.first_row) : c.first_row;
      end = any ? std::max(end, c.last_row + 1) : c.last_row + 1;
      any = true;
    }
  }
  state.row = state.row_begin = begin;
  state.row_end = end;
  state.runs.assign(static_cast<std::size_t>(end - begin), {1, 0});
  for (std::int64_t m = m_first; m <= m_last; ++m) {
    if (!rows_of(m, c)) {
      continue;
    }
    for (std::int64_t r = c.first_row; r <= c.last_row; ++r) {
      PlaneWalkState::Run& run = state.runs[static_cast<std::size_t>(r - begin)];
      run.first = run.first > run.last ? m : run.first;
      run.last = m;
    }
  }
}

}  // namespace

Coverage make_coverage(const SetupRecord& setup, int subpixel_bits, FillRule fill_rule) {
  const std::array<SetupVertex, 3> v{vertex_of(setup, 0), vertex_of(setup, 1), vertex_of(setup, 2)};
  constexpr std::array<std::array<std::size_t, 2>, 3> ends{{{0, 1}, {1, 2}, {2, 0}}};
  Coverage coverage{};
  for (std::size_t i = 0; i < 3; ++i) {
    const SetupVertex& from = v[ends[i][0]];
    const SetupVertex& to = v[ends[i][1]];
    // (a, b) is normal to the edge; with area > 0 vertex 1 is right of edge 0-2 and this order keeps the
    // inside on the positive side.
    const int128 sign = setup.mid_right != 0 ? 1 : -1;
    const int128 a = -sign * (to.y - from.y);
    const int128 b = sign * (to.x - from.x);
    const int128 c = -(a * from.x + b * from.y);
    // The centre (x + 1/2, y + 1/2) in half units of the snapped grid: (2x + 1) 2^subpixel_bits.
    const bool owns = owns_every_edge(fill_rule) || a > 0 || (a == 0 && b > 0);
    coverage.sides[i] = {a << (subpixel_bits + 1), b << (subpixel_bits + 1),
                         2 * c + ((a + b) << subpixel_bits) - (owns ? 0 : 1)};
  }
  return coverage;
}

PlaneWalkStage prepare_plane_walk(const Config& config, const Constants& constants, int width, int height) {
  PlaneWalkStage s;
  s.width = width;
  s.height = height;
  s.fill_rule = config.fill_rule;
  s.ideal_line = is_on_ideal_line(config.numerator);
  s.subpixel_bits = config.subpixel_bits;
  s.b = b_of(config, constants.record);
  s.shade_offset = offset_value(config, line_of(LineId::r, config.perspective).row);
  s.vertex_h = make_register(config, FormatId::setup_h);
  s.vertex_uv = make_register(config, FormatId::setup_uv);
  s.vertex_shade = make_register(config, FormatId::setup_shade);
  s.g = make_register(config, FormatId::plane_g);
  s.h_grad = make_register(config, FormatId::plane_h_grad);
  s.g_grad = make_register(config, FormatId::plane_g_grad);
  s.shade_grad = make_register(config, FormatId::plane_shade_grad);
  s.k = make_register(config, FormatId::plane_k);
  s.h = make_register(config, FormatId::span_h);
  s.f = make_register(config, FormatId::span_f);
  s.f_step = make_register(config, FormatId::span_f_step);
  s.shade_acc = make_register(config, FormatId::span_shade_acc);
  s.shade_step = make_register(config, FormatId::span_shade_step);
  return s;
}

template <class Watch>
GradientRecord setup_gradients(const PlaneWalkStage& stage, const SetupRecord& setup, Watch watch) {
  const std::array<SetupVertex, 3> v{vertex_of(setup, 0), vertex_of(setup, 1), vertex_of(setup, 2)};
  return gradients_of(stage, setup, v, shape_of(v, stage.subpixel_bits), watch);
}

template <class Watch>
void start_plane_walk(const PlaneWalkStage& stage, const SetupRecord& setup, PlaneWalkState& state,
                      Watch watch) {
  const std::array<SetupVertex, 3> v{vertex_of(setup, 0), vertex_of(setup, 1), vertex_of(setup, 2)};
  const TriangleShape g = shape_of(v, stage.subpixel_bits);
  state.setup = setup;
  PlaneRecord& out = state.record;
  out = {};
  out.triangle = setup.triangle;

  const GradientRecord of_texture = gradients_of(stage, setup, v, g, watch);
  out.gu0 = of_texture.gu0;
  out.gv0 = of_texture.gv0;
  out.gu1 = of_texture.gu1;
  out.gv1 = of_texture.gv1;
  out.gu2 = of_texture.gu2;
  out.gv2 = of_texture.gv2;
  out.h_x = of_texture.h_x;
  out.h_y = of_texture.h_y;
  out.gu_x = of_texture.gu_x;
  out.gu_y = of_texture.gu_y;
  out.gv_x = of_texture.gv_x;
  out.gv_y = of_texture.gv_y;
  for (std::size_t c = 0; c < channel_count; ++c) {
    const auto at = [&](std::size_t i) { return value_of(v[i].c[c], stage.vertex_shade); };
    put(g, {at(0), at(1), at(2)}, stage.shade_grad, watch, out.*plane_x[c], out.*plane_y[c]);
  }

  const Rises n = rises(g, {value_of(v[0].h, stage.vertex_h), value_of(v[1].h, stage.vertex_h),
                            value_of(v[2].h, stage.vertex_h)});
  const bool along_y = sign_of(magnitude(n.nx) - magnitude(n.ny)) > 0;
  const Exact over = along_y ? n.nx : n.ny;
  out.major = along_y ? 1 : 0;
  out.k = over.raw == 0 ? 0 : quantize_ratio(along_y ? -n.ny : -n.nx, over, stage.k, watch);
  const auto& major = along_y ? g.y : g.x;
  const Exact lowest =
      *std::min_element(major.begin(), major.end(), [](Exact a, Exact b) { return a.raw < b.raw; });
  out.major_first = static_cast<std::int64_t>(ceil_of(lowest - Exact{1, 1}));

  state.geometry.k = out.k;
  state.geometry.one = std::int64_t{1} << stage.k.fraction;
  state.geometry.along_y = along_y;
  state.geometry.coverage = make_coverage(setup, stage.subpixel_bits, stage.fill_rule);
  state.row_step = out.k < 0 ? -1 : 1;
  find_runs(stage, g, state);
}

template <class Watch>
bool plane_walk(const PlaneWalkStage& stage, PlaneWalkState& state, PlaneRowRecord& out, Watch watch) {
  const std::int64_t row = state.row++;
  const PlaneWalkState::Run run = state.runs[static_cast<std::size_t>(row - state.row_begin)];
  if (run.first > run.last) {
    return false;
  }
  const PlaneRecord& p = state.record;
  const SetupVertex v0 = vertex_of(state.setup, 0);
  const bool along_y = state.geometry.along_y;
  const std::int64_t from_anchor = run.first - p.major_first;
  const std::int64_t line = line_at(state.geometry, from_anchor);
  out.triangle = p.triangle;
  out.row = row;
  out.major_first = run.first;
  out.minor_first = row + line;
  out.count = run.last - run.first + 1;

  const Exact half{1, 1};
  const Exact k = value_of(p.k, stage.k);
  const Exact ahead = k * Exact{from_anchor, 0};
  const Exact phase = ahead + half - Exact{line, 0};
  // In [0, 1) on the grid of k and of the half.
  out.phase = static_cast<std::int64_t>(phase.raw >> (phase.fraction - std::max(0, stage.k.fraction)));

  const Exact x0{v0.x, stage.subpixel_bits};
  const Exact y0{v0.y, stage.subpixel_bits};
  const Exact major = Exact{run.first, 0} + half - (along_y ? y0 : x0);
  const Exact minor_line = Exact{row, 0} + half + ahead - (along_y ? x0 : y0);
  const Exact minor_pixel = Exact{out.minor_first, 0} + half - (along_y ? x0 : y0);
  const auto along = [&](std::int64_t gx, std::int64_t gy, const Register& r) {
    return value_of(along_y ? gy : gx, r);
  };
  const auto across = [&](std::int64_t gx, std::int64_t gy, const Register& r) {
    return value_of(along_y ? gx : gy, r);
  };

  out.h = quantize(value_of(v0.h, stage.vertex_h) + along(p.h_x, p.h_y, stage.h_grad) * major +
                       across(p.h_x, p.h_y, stage.h_grad) * minor_line,
                   stage.h, watch);
  const Exact direction{state.row_step, 0};
  const auto numerator = [&](std::int64_t g0, std::int64_t gx, std::int64_t gy, std::int64_t& start,
                             std::int64_t& step0, std::int64_t& step1) {
    const Exact g_major = along(gx, gy, stage.g_grad);
    const Exact g_minor = across(gx, gy, stage.g_grad);
    const Exact minor = stage.ideal_line ? minor_line : minor_pixel;
    start = quantize(value_of(g0, stage.g) + g_major * major + g_minor * minor, stage.f, watch);
    if (stage.ideal_line) {
      step0 = step1 = quantize(g_major + k * g_minor, stage.f_step, watch);
    } else {
      step0 = quantize(g_major, stage.f_step, watch);
      step1 = quantize(g_major + direction * g_minor, stage.f_step, watch);
    }
  };
  numerator(p.gu0, p.gu_x, p.gu_y, out.gu, out.gu_step0, out.gu_step1);
  numerator(p.gv0, p.gv_x, p.gv_y, out.gv, out.gv_step0, out.gv_step1);
  for (std::size_t c = 0; c < channel_count; ++c) {
    const Exact c_major = along(p.*plane_x[c], p.*plane_y[c], stage.shade_grad);
    const Exact c_minor = across(p.*plane_x[c], p.*plane_y[c], stage.shade_grad);
    out.*plane_row_starts[c] = quantize(
        value_of(v0.c[c], stage.vertex_shade) + c_major * major + c_minor * minor_pixel + stage.shade_offset,
        stage.shade_acc, watch);
    out.*plane_row_steps0[c] = quantize(c_major, stage.shade_step, watch);
    out.*plane_row_steps1[c] = quantize(c_major + direction * c_minor, stage.shade_step, watch);
  }
  return true;
}

template GradientRecord setup_gradients(const PlaneWalkStage&, const SetupRecord&, NoObserve);
template GradientRecord setup_gradients(const PlaneWalkStage&, const SetupRecord&, Observe);
template void start_plane_walk(const PlaneWalkStage&, const SetupRecord&, PlaneWalkState&, NoObserve);
template void start_plane_walk(const PlaneWalkStage&, const SetupRecord&, PlaneWalkState&, Observe);
template bool plane_walk(const PlaneWalkStage&, PlaneWalkState&, PlaneRowRecord&, NoObserve);
template bool plane_walk(const PlaneWalkStage&, PlaneWalkState&, PlaneRowRecord&, Observe);

}  // namespace bitspan::model
