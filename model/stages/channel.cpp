// SPDX-License-Identifier: Apache-2.0
#include "model/stages/channel.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/gradient.hpp"
#include "model/numeric/from_double.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/fog.hpp"

namespace bitspan::model {
namespace {

ChannelForm form_of_channel(const Config& config, int number, const LengthForm& row_length) {
  const bitspan::Line line = line_of(channel_line(number), config.perspective);
  const auto reg = [&](FormatId id) { return make_register(config, id); };
  ChannelForm f;
  f.number = number;
  f.line = line.id;
  f.homogeneous = line.is_homogeneous();
  f.span_divides = line.span_divides;
  f.vertex = reg(line.vertex);
  f.walked = reg(line.walked());
  f.edge_step = reg(line.edge.step);
  f.edge_acc = reg(line.edge.acc);
  f.edge = reg(line.edge.kept);
  f.gradient = reg(line.gradient);
  f.step = reg(line.row.step);
  f.acc = reg(line.row.acc);
  f.value = reg(line.row.kept);
  f.edge_offset = offset_value(config, line.edge);
  f.row_offset = offset_value(config, line.row);
  f.along_edge = make_adder(f.edge_acc, f.edge_step);
  f.along_row = make_adder(f.acc, f.step);
  f.at_edge = make_narrowing(f.edge, magnitude_of(f.edge_acc));
  f.row = make_row_line(config, line, row_length);
  f.fits_int64 = f.along_row.fits_int64 &&
                 fits_int64(aligned(signed_grid(config.format(line.row.acc)), f.value.fraction + 1));
  return f;
}

// Bits that a product of the accumulator and a fragment's m takes beyond the accumulator, on every grid on
// the way to the value.
int growth_of_product(const Config& config, const InverseDepth& q, const ChannelForm& form) {
  const Format& m = config.pixel_reciprocal.output;
  const int least = form.acc.fraction + m.fraction() + pixel_exponents(config, q).low;
  return m.word + std::max(0, form.value.fraction + 1 - least);
}

bool asks_for(const Scene& scene, LineId channel) {
  if (channel == LineId::fog) return scene.fog.has_value();
  using enum LineId;
  const bool is_of_light = channel == nx || channel == ny || channel == nz || channel == light ||
                           channel == lx || channel == ly || channel == lz;
  if (is_of_light) return scene.light.has_value();
  const bool is_projected =
      channel == LineId::project_x || channel == LineId::project_y || channel == LineId::project_w;
  return !is_projected || scene.projector.has_value();  // the configuration asks for the others
}

// The places in the input of the sorted vertices.
std::array<std::size_t, 3> sorted_places(const ChannelStage& stage, const Triangle& triangle) {
  std::array<std::array<std::int64_t, 2>, 3> at{};
  for (std::size_t i = 0; i < 3; ++i) {
    at[i] = {quantize(exact_of(triangle.v[i].y), stage.coordinate, NoObserve{}),
             quantize(exact_of(triangle.v[i].x), stage.coordinate, NoObserve{})};
  }
  std::array<std::size_t, 3> places{0, 1, 2};
  std::ranges::stable_sort(places, {}, [&](std::size_t i) { return at[i]; });
  return places;
}

// set_up: the vertex as setup has it.
template <class Watch>
std::int64_t vertex_value(const ChannelStage& stage, const ChannelForm& form, const Vertex& v,
                          const SetupVertex& set_up, Watch watch) {
  switch (form.line) {
    case LineId::fog:
      return v.fog < 0 ? fog_at(v.s, stage.fog_distance, form.vertex, watch)
                       : quantize(exact_of(v.fog), form.vertex, watch);
    case LineId::project_x:
      return quantize(scaled(exact_of(v.project_x), stage.projector_exponent), form.vertex, watch);
    case LineId::project_y:
      return quantize(scaled(exact_of(v.project_y), stage.projector_exponent), form.vertex, watch);
    case LineId::project_w:
      return quantize(scaled(exact_of(v.project_w), stage.projector_exponent), form.vertex, watch);
    case LineId::shade_r:
      return set_up.c[0];
    case LineId::shade_g:
      return set_up.c[1];
    case LineId::shade_b:
      return set_up.c[2];
    case LineId::shade_a:
      return set_up.c[3];
    case LineId::z: {
      if (v.z < 0) return set_up.h;
      const std::int64_t z = quantize(exact_of(v.z) * stage.zmax, form.vertex, watch);
      return quantize(stage.zmax - value_of(z, form.vertex), form.vertex, watch);
    }
    case LineId::u2:
      return quantize(exact_of(v.u2), form.vertex, watch);
    case LineId::v2:
      return quantize(exact_of(v.v2), form.vertex, watch);
    case LineId::lx:
      return quantize(exact_of(v.lx), form.vertex, watch);
    case LineId::ly:
      return quantize(exact_of(v.ly), form.vertex, watch);
    case LineId::lz:
      return quantize(exact_of(v.lz), form.vertex, watch);
    case LineId::nx:
      return quantize(exact_of(v.nx), form.vertex, watch);
    case LineId::ny:
      return quantize(exact_of(v.ny), form.vertex, watch);
    case LineId::nz:
      return quantize(exact_of(v.nz), form.vertex, watch);
    case LineId::light:
      return light_at(stage.light, v, form.vertex, watch);
    case LineId::h:
    case LineId::fu:
    case LineId::fv:
    case LineId::r:
    case LineId::g:
    case LineId::b:
    case LineId::a:
    case LineId::count:
      break;
  }
  unreachable();
}

// Slope(n, d, form, R, r) with R's m and e of this length.
template <class Watch>
std::int64_t slope_over(SlopeForm form, const ReciprocalUnit& unit, Exact n, Exact d, std::int64_t m,
                        std::int64_t e, const Register& r, Watch watch) {
  return shares_reciprocal(form) ? quantize(n * unit.value({m, static_cast<int>(e)}), r, watch)
                                 : quantize_ratio(n, d, r, watch);
}

// The accumulator of an edge on a row, at or below the one that it stands on.
template <class Watch>
std::int64_t acc_on(const ChannelStage& stage, const ChannelForm& form, TriangleChannels& triangle,
                    std::size_t channel, std::int64_t edge, std::int64_t y, Watch watch) {
  ChannelEdge& e = triangle.edges[channel][static_cast<std::size_t>(edge)];
  if (!e.started) e = start_edge(stage, triangle, channel, edge, watch);
  const Exact step = value_of(edge_step(triangle.record[channel], edge), form.edge_step);
  for (; e.y < y; ++e.y) e.acc = quantize(value_of(e.acc, form.edge_acc) + step, form.edge_acc, watch);
  return e.acc;
}

// The value of a fragment's accumulator.
template <class Watch>
std::int64_t value_at(const ChannelStage& stage, const ChannelForm& form, const FragmentRecord& fragment,
                      std::int64_t raw, Watch watch) {
  const Exact acc = value_of(raw, form.acc);
  if (!form.span_divides) return quantize(acc, form.value, watch);
  if (stage.by_reciprocal) {
    const Exact inverse = stage.pixel_unit.value({fragment.recip_m, static_cast<int>(fragment.recip_e)});
    return quantize(acc * inverse, form.value, watch);
  }
  const int128 q = std::max<int128>((int128{fragment.h} << stage.q.h_up) + stage.q.b, 1);
  return quantize_ratio(acc, {q, stage.q.fraction}, form.value, watch);
}

}  // namespace

ChannelStage prepare_channels(const Config& config, const Constants& constants, const Scene& scene) {
  ChannelStage s;
  const LengthForm row_length = make_row_length(config);
  for (const int channel : ChannelList(config)) {
    if (!asks_for(scene, channel_line(channel))) continue;
    s.in_use.push_back(form_of_channel(config, channel, row_length));
  }
  s.const_depth_rows = has_plane_rows(config.perspective);
  s.by_plane = has_setup_plane(config);
  s.edge_form = config.edge_slope;
  s.row_form = form_of(config.row_slope);
  s.edge_unit = ReciprocalUnit(config.edge_reciprocal, RegisterId::edge_reciprocal);
  s.row_unit = ReciprocalUnit(config.row_reciprocal, RegisterId::row_reciprocal);
  s.subpixel_bits = config.subpixel_bits;
  s.coordinate = make_register(config.coordinate_format(), RegisterId::coordinate);
  s.vertex_h = make_register(config, FormatId::setup_h);
  s.x = make_register(config, FormatId::edge_x);
  s.b = b_of(config, constants.record);
  s.zmax = {(int128{1} << config.depth_bits) - 1, 0};
  s.pixel_unit = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.q = make_inverse_depth(config, constants);
  s.by_reciprocal = has_pixel_reciprocal(config.perspective);
  s.depth_at = s.place_of(LineId::z);
  s.shades_at = s.place_of(LineId::shade_r);
  s.second_at = s.place_of(LineId::u2);
  s.normal_at = s.place_of(LineId::nx);
  s.light_at = s.place_of(LineId::light);
  s.relief_at = s.place_of(LineId::lx);
  if (s.light_at >= 0) s.light = prepare_light(config, constants, scene);
  for (ChannelForm& form : s.in_use) form.product_growth = growth_of_product(config, s.q, form);
  if (scene.fog) s.fog_distance = scene.fog->distance;
  if (scene.projector && has_project(config.project)) {
    s.projector_exponent = projector_constants(config, scene).exponent;
  }
  return s;
}

std::uint64_t divides_of_edge(const ChannelStage& stage) {
  return shares_reciprocal(stage.edge_form) ? 0 : stage.in_use.size();
}
std::uint64_t divides_of_row(const ChannelStage& stage) {
  return shares_reciprocal(stage.row_form) ? 0 : stage.in_use.size();
}

template <class Watch>
TriangleChannels setup_channels(const ChannelStage& stage, const Triangle& triangle, const SetupRecord& setup,
                                const Edges* edges, const TrianglePlane* plane, Watch watch) {
  TriangleChannels out{};
  out.setup = setup;
  const std::array<SetupVertex, 3> v{vertex_of(setup, 0), vertex_of(setup, 1), vertex_of(setup, 2)};
  const std::array<std::size_t, 3> places = sorted_places(stage, triangle);
  const TriangleShape shape = shape_of(v, stage.subpixel_bits);
  for (std::size_t c = 0; c < stage.in_use.size(); ++c) {
    const ChannelForm& form = stage.in_use[c];
    std::array<std::int64_t, 3> w{};
    std::array<std::int64_t, 3> f{};
    VertexTriple g;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool by_first = form.line == LineId::light && stage.light.at_faces;
      w[i] = vertex_value(stage, form, triangle.v[by_first ? 0 : places[i]], v[i], watch);
      g[i] = value_of(w[i], form.vertex);
      if (form.homogeneous) {
        f[i] = quantize(g[i] * (value_of(v[i].h, stage.vertex_h) + stage.b), form.walked, watch);
        g[i] = value_of(f[i], form.walked);
      }
    }
    SetupChannelRecord& r = out.record[c];
    r = {.triangle = setup.triangle,
         .channel = form.number,
         .w0 = w[0],
         .w1 = w[1],
         .w2 = w[2],
         .f0 = f[0],
         .f1 = f[1],
         .f2 = f[2]};
    if (stage.const_depth_rows || stage.by_plane) {
      const bool divides = stage.const_depth_rows || !shares_reciprocal(stage.edge_form);
      const bool turned = shape.area.raw < 0;
      const auto gradient = [&](Exact n) {
        return divides ? quantize_ratio(n, shape.area, form.gradient, watch)
                       : quantize((turned ? -n : n) *
                                      stage.edge_unit.value(
                                          {plane->record.recip_m, static_cast<int>(plane->record.recip_e)}),
                                  form.gradient, watch);
      };
      const Rises n = rises(shape, g);
      r.w_x = gradient(n.nx);
      r.w_y = gradient(n.ny);
      out.divides += divides ? 2 : 0;
      continue;
    }
    constexpr std::array<std::array<std::size_t, 2>, 3> ends{{{0, 2}, {0, 1}, {1, 2}}};
    const std::array<std::int64_t*, 3> steps{&r.step0, &r.step1, &r.step2};
    for (int i = 0; i < edges->count; ++i) {
      const EdgeRecord& edge = edges->edge[static_cast<std::size_t>(i)];
      const auto k = static_cast<std::size_t>(edge.edge);
      const auto [from, to] = ends[k];
      *steps[k] = slope_over(stage.edge_form, stage.edge_unit, g[to] - g[from], shape.y[to] - shape.y[from],
                             edge.recip_m, edge.recip_e, form.edge_step, watch);
      out.divides += shares_reciprocal(stage.edge_form) ? 0 : 1;
    }
  }
  return out;
}

template <class Watch>
ChannelEdge start_edge(const ChannelStage& stage, const TriangleChannels& triangle, std::size_t channel,
                       std::int64_t edge, Watch watch) {
  const ChannelForm& form = stage.in_use[channel];
  const SetupChannelRecord& record = triangle.record[channel];
  const bool second = edge == 2;  // from vertex 1 on
  const Exact step = value_of(edge_step(record, edge), form.edge_step);
  const Exact half{1, 1};
  const Exact top{second ? triangle.setup.y1 : triangle.setup.y0, stage.subpixel_bits};
  const std::int64_t y = std::max<std::int64_t>(0, static_cast<std::int64_t>(ceil_of(top - half)));
  const std::int64_t first =
      form.homogeneous ? (second ? record.f1 : record.f0) : (second ? record.w1 : record.w0);
  const Exact t = Exact{y, 0} + half - top;
  return {true, y,
          quantize(value_of(first, form.walked) + step * t + form.edge_offset, form.edge_acc, watch)};
}

template <class Watch>
RowChannels row_channels(const ChannelStage& stage, TriangleChannels& triangle, const RowRecord& row,
                         Watch watch) {
  RowChannels out{};
  for (std::size_t c = 0; c < stage.in_use.size(); ++c) {
    const ChannelForm& form = stage.in_use[c];
    const auto kept = [&](std::int64_t acc) {
      return quantize(value_of(acc, form.edge_acc), form.edge, watch);
    };
    const std::int64_t l = acc_on(stage, form, triangle, c, row.l_edge, row.y, watch);
    const std::int64_t r = acc_on(stage, form, triangle, c, row.r_edge, row.y, watch);
    out[c] = {row.triangle, row.y, form.number, l, kept(l), r, kept(r)};
  }
  return out;
}

template <class Watch>
SpanChannels span_channels(const ChannelStage& stage, const TriangleChannels& triangle,
                           const SpanRecord& span, const RowRecord* row, const RowChannels* ends,
                           const PlaneGeometry* geometry, Watch watch) {
  SpanChannels out{};
  const Exact half{1, 1};
  for (std::size_t c = 0; c < stage.in_use.size(); ++c) {
    const ChannelForm& form = stage.in_use[c];
    SpanChannelRecord& r = out.record[c];
    r = {.triangle = span.triangle, .x = span.x, .y = span.y, .channel = form.number};
    if (ends != nullptr) {
      const Exact left = value_of((*ends)[c].l, form.edge);
      const Exact length = value_of(row->r_x, stage.x) - value_of(row->l_x, stage.x);
      if (length.raw > 0) {
        r.w_step0 = slope_over(stage.row_form, stage.row_unit, value_of((*ends)[c].r, form.edge) - left,
                               length, span.recip_m, span.recip_e, form.step, watch);
        out.divides += shares_reciprocal(stage.row_form) ? 0 : 1;
      }
      r.w_step1 = r.w_step0;
      const Exact p = Exact{span.x, 0} + half - value_of(row->l_x, stage.x);
      r.w = quantize(left + value_of(r.w_step0, form.step) * p + form.row_offset, form.acc, watch);
      continue;
    }
    const SetupChannelRecord& plane = triangle.record[c];
    const Exact w_x = value_of(plane.w_x, form.gradient);
    const Exact w_y = value_of(plane.w_y, form.gradient);
    const Exact right = Exact{span.x, 0} + half - Exact{triangle.setup.x0, stage.subpixel_bits};
    const Exact down = Exact{span.y, 0} + half - Exact{triangle.setup.y0, stage.subpixel_bits};
    const Exact first = value_of(form.homogeneous ? plane.f0 : plane.w0, form.walked);
    r.w = quantize(first + w_x * right + w_y * down + form.row_offset, form.acc, watch);
    const bool along_y = geometry != nullptr && geometry->along_y;
    const Exact along = along_y ? w_y : w_x;
    const Exact across = along_y ? w_x : w_y;
    r.w_step0 = r.w_step1 = quantize(along, form.step, watch);
    if (geometry != nullptr) {
      r.w_step1 = quantize(along + (geometry->k < 0 ? -across : across), form.step, watch);
    }
  }
  return out;
}

template <class Watch>
FragmentChannels fragment_channels(const ChannelStage& stage, ChannelWalk& walk,
                                   const FragmentRecord& fragment, Watch watch) {
  FragmentChannels out{};
  const bool along_y = walk.geometry != nullptr && walk.geometry->along_y;
  const bool across = along_y ? fragment.x != walk.x : fragment.y != walk.y;
  for (std::size_t c = 0; c < stage.in_use.size(); ++c) {
    const ChannelForm& form = stage.in_use[c];
    SpanChannelRecord& span = walk.span[c];
    if (walk.started) {
      const std::int64_t step = across ? span.w_step1 : span.w_step0;
      span.w = quantize(value_of(span.w, form.acc) + value_of(step, form.step), form.acc, watch);
    }
    out[c] = {fragment.triangle, fragment.x, fragment.y, form.number,
              value_at(stage, form, fragment, span.w, watch)};
  }
  walk.started = true;
  walk.x = fragment.x;
  walk.y = fragment.y;
  return out;
}

std::int64_t channel_value(const FragmentChannels& channels, LineId line) {
  return std::ranges::find_if(channels, [line](const auto& c) { return channel_line(c.channel) == line; })->w;
}

template TriangleChannels setup_channels(const ChannelStage&, const Triangle&, const SetupRecord&,
                                         const Edges*, const TrianglePlane*, NoObserve);
template TriangleChannels setup_channels(const ChannelStage&, const Triangle&, const SetupRecord&,
                                         const Edges*, const TrianglePlane*, Observe);
template ChannelEdge start_edge(const ChannelStage&, const TriangleChannels&, std::size_t, std::int64_t,
                                NoObserve);
template RowChannels row_channels(const ChannelStage&, TriangleChannels&, const RowRecord&, NoObserve);
template RowChannels row_channels(const ChannelStage&, TriangleChannels&, const RowRecord&, Observe);
template SpanChannels span_channels(const ChannelStage&, const TriangleChannels&, const SpanRecord&,
                                    const RowRecord*, const RowChannels*, const PlaneGeometry*, NoObserve);
template SpanChannels span_channels(const ChannelStage&, const TriangleChannels&, const SpanRecord&,
                                    const RowRecord*, const RowChannels*, const PlaneGeometry*, Observe);
template FragmentChannels fragment_channels(const ChannelStage&, ChannelWalk&, const FragmentRecord&,
                                            NoObserve);
template FragmentChannels fragment_channels(const ChannelStage&, ChannelWalk&, const FragmentRecord&,
                                            Observe);

}  // namespace bitspan::model
