// SPDX-License-Identifier: Apache-2.0
#include "model/stages/depth.hpp"

#include "config/modes.hpp"
#include "model/numeric/integers.hpp"
#include "model/stages/depth-inl.hpp"

namespace bitspan::model {

DepthStage prepare_depth(const Config& config, const Constants& constants) {
  DepthStage s;
  s.formats = depth_formats(config);
  s.func = config.depth_func;
  s.clear = s.formats.nearer_is_larger ? 0 : s.formats.zmax;  // the farthest
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.scene = {make_inverse_depth(config, constants).b, s.reciprocal.table().data(), constants.record.c1,
             constants.record.c0};
  const Grid difference = signed_grid(config.format(FormatId::span_h)) - signed_grid(config.depth_format());
  s.fits_int64 = !is_linear_in_distance(config.depth_code) && fits_int64(aligned(difference, 1));
  return s;
}

template <class Watch>
bool depth(const DepthStage& stage, const FragmentRecord& fragment, std::int64_t stored, DepthRecord& out,
           Watch watch) {
  const DepthFormats& f = stage.formats;
  const auto point = stage.fits_int64
                         ? HWY_NAMESPACE::depth_point<std::int64_t>(f, stage.scene, fragment.h, watch)
                         : HWY_NAMESPACE::depth_point<int128>(f, stage.scene, fragment.h, watch);
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  out.recip_m = point.recip_m;
  out.recip_e = point.recip_e;
  out.z = stage.bias == 0 ? point.z : std::clamp<std::int64_t>(point.z + stage.bias, 0, f.zmax);
  out.stored = stored;
  const bool pass = HWY_NAMESPACE::depth_passes(f, stage.func, out.z, stored);
  out.pass = pass ? 1 : 0;
  return pass;
}

template bool depth(const DepthStage&, const FragmentRecord&, std::int64_t, DepthRecord&, NoObserve);
template bool depth(const DepthStage&, const FragmentRecord&, std::int64_t, DepthRecord&, Observe);

}  // namespace bitspan::model
