// SPDX-License-Identifier: Apache-2.0
#include "model/stages/project.hpp"

#include "config/modes.hpp"
#include "model/stages/distance.hpp"

namespace bitspan::model {

ProjectStage prepare_project(const Config& config, const Constants& constants, const Scene& scene) {
  ProjectStage s;
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.xyw = make_register(config, FormatId::project_value);
  s.h = make_register(config, FormatId::span_h);
  s.uv = make_register(config, FormatId::span_uv);
  s.ratio = make_register(config, FormatId::project_ratio);
  s.far_h = make_register(config, FormatId::project_h);
  s.z = make_register(config.depth_format(), RegisterId::depth_z);
  s.is_complement = is_complement_of_h(config.depth_code);
  s.zmax = Exact{s.z.max, 0};
  s.b = b_of(config, constants.record);
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
  const auto channel = [&](LineId line) { return value_of(channel_value(*channels, line), stage.xyw); };
  const Exact w = channel(LineId::project_w);
  if (w.raw <= 0) return;
  const Inverse r = stage.reciprocal(w, watch);
  const Exact by_w = stage.reciprocal.value(r);
  out.recip_m = r.m;
  out.recip_e = r.e;
  out.s = quantize(channel(LineId::project_x) * by_w, stage.uv, watch);
  out.t = quantize(channel(LineId::project_y) * by_w, stage.uv, watch);
  out.ratio = quantize((value_of(fragment.h, stage.h) + stage.b) * by_w, stage.ratio, watch);
  out.h = quantize(stage.a * value_of(out.ratio, stage.ratio) - stage.projector_b, stage.far_h, watch);
  const Exact h = value_of(out.h, stage.far_h);
  out.z = quantize(stage.is_complement ? stage.zmax - h : h, stage.z, watch);
  const auto within = [&](std::int64_t raw, int size) {
    const int128 place = floor_of(value_of(raw, stage.uv));
    return place >= 0 && place < size;
  };
  out.inside = within(out.s, stage.width) && within(out.t, stage.height) ? 1 : 0;
}

template void project(const ProjectStage&, const FragmentRecord&, const FragmentChannels*, ProjectRecord&,
                      NoObserve);
template void project(const ProjectStage&, const FragmentRecord&, const FragmentChannels*, ProjectRecord&,
                      Observe);

}  // namespace bitspan::model
