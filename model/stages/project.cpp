// SPDX-License-Identifier: Apache-2.0
#include "model/stages/project.hpp"

#include <algorithm>

#include "config/grid.hpp"
#include "config/modes.hpp"
#include "model/stages/distance.hpp"
#include "model/stages/project-inl.hpp"

namespace bitspan::model {

namespace {

// The widths of what lanes form.
void measure(ProjectStage& s, const Config& config) {
  using F = FormatId;
  const auto of = [&](F id) { return signed_grid(config.format(id)); };
  const Exponents e = exponents_of(config.pixel_reciprocal, positive(of(F::project_value)));
  const Grid m = signed_grid(config.pixel_reciprocal.output);
  // One place below the register's grid, too.
  const auto growth = [&](int fraction, F to) {
    return std::max(0, config.format(to).fraction() + 1 - (fraction + m.fraction + e.low));
  };
  s.place_growth = m.bits() + growth(of(F::project_value).fraction, F::span_uv);
  const Grid q = of(F::span_h) + of(F::setup_b);
  s.sum_bits = q.bits();
  s.ratio_growth = m.bits() + growth(q.fraction, F::project_ratio);
  const Grid h = of(F::distance_a) * of(F::project_ratio) - of(F::setup_b);
  s.h_bits = aligned(h, config.format(F::project_h).fraction()).bits();
  s.z_bits = aligned(Grid{config.depth_bits, 0, true} - of(F::project_h), 0).bits();
}

}  // namespace

ProjectStage prepare_project(const Config& config, const Constants& constants, const Scene& scene) {
  ProjectStage s;
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.xyw = make_register(config, FormatId::project_value);
  s.uv = make_register(config, FormatId::span_uv);
  s.ratio = make_register(config, FormatId::project_ratio);
  s.far_h = make_register(config, FormatId::project_h);
  s.z = make_register(config.depth_format(), RegisterId::depth_z);
  s.is_complement = is_complement_of_h(config.depth_code);
  s.zmax = Exact{s.z.max, 0};
  s.q = make_inverse_depth(config, constants);
  measure(s, config);
  s.has_projector = scene.projector.has_value() && has_project(config.project);
  if (!s.has_projector) return s;
  const Constants of_projector = projector_constants(config, scene);
  s.a = distance_constant(config, of_projector, NoObserve{});
  s.projector_b = b_of(config, of_projector.record);
  return s;
}

void set_project(ProjectStage& stage, const DrawState& state, const Texture* image) {
  stage.is_on = is_projected(state);
  stage.width = image == nullptr ? 0 : image->width;
  stage.height = image == nullptr ? 0 : image->height;
}

template <class Watch>
void project(const ProjectStage& stage, const FragmentRecord& fragment, const FragmentChannels* channels,
             ProjectRecord& out, Watch watch) {
  out = {};
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  if (!stage.has_projector) return;
  const auto channel = [&](LineId line) { return channel_value(*channels, line); };
  const std::int64_t w = channel(LineId::project_w);
  if (w <= 0) return;
  namespace text = HWY_NAMESPACE;
  const text::InverseOfW<std::int64_t> by = text::inverse_of_w<int128>(stage, w, watch);
  out.recip_m = by.m;
  out.recip_e = by.e;
  out.s = text::place_of<int128>(stage, channel(LineId::project_x), by, watch);
  out.t = text::place_of<int128>(stage, channel(LineId::project_y), by, watch);
  out.ratio = text::ratio_of<int128>(stage, text::depth_sum<int128>(stage, fragment.h), by, watch);
  out.h = text::far_h_of<int128>(stage, out.ratio, watch);
  out.z = text::code_of<int128>(stage, out.h, watch);
  out.inside = text::lies_within<int128>(stage, out.s, stage.width) &&
                       text::lies_within<int128>(stage, out.t, stage.height)
                   ? 1
                   : 0;
}

template void project(const ProjectStage&, const FragmentRecord&, const FragmentChannels*, ProjectRecord&,
                      NoObserve);
template void project(const ProjectStage&, const FragmentRecord&, const FragmentChannels*, ProjectRecord&,
                      Observe);

}  // namespace bitspan::model
