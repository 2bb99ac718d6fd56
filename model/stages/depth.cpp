#include "model/stages/depth.hpp"

namespace bitspan::model {

DepthStage prepare_depth(const Config& config, const Constants& constants) {
  DepthStage s;
  s.code = config.depth_code;
  s.zmax = (std::int64_t{1} << config.depth_bits) - 1;
  s.clear = config.depth_code == DepthCode::inverse ? 0 : s.zmax;
  s.h = make_register(config, FormatId::span_h);
  s.z = make_register(config.depth_format(), RegisterId::depth_z);
  s.q = make_inverse_depth(config, constants);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.c1 = {constants.record.c1, config.format(FormatId::depth_c1).fraction()};
  s.c0 = {constants.record.c0, config.format(FormatId::depth_c0).fraction()};
  return s;
}

template <class Watch>
bool depth(const DepthStage& stage, const FragmentRecord& fragment, std::int64_t stored, DepthRecord& out,
           Watch watch) {
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  out.recip_m = 0;
  out.recip_e = 0;
  switch (stage.code) {
    case DepthCode::inverse:
      out.z = quantize(fragment.h, stage.h.fraction, stage.z, watch);
      break;
    case DepthCode::opengl:
      out.z = quantize(Exact{stage.zmax, 0} - value_of(fragment.h, stage.h), stage.z, watch);
      break;
    case DepthCode::linear: {
      const Inverse inverse =
          stage.reciprocal((int128{fragment.h} << stage.q.h_up) + stage.q.b, stage.q.fraction, watch);
      out.recip_m = inverse.m;
      out.recip_e = inverse.e;
      out.z = quantize(stage.c1 * stage.reciprocal.value(inverse) - stage.c0, stage.z, watch);
      break;
    }
  }
  out.stored = stored;
  const bool pass = stage.code == DepthCode::inverse ? out.z > stored : out.z < stored;
  out.pass = pass ? 1 : 0;
  return pass;
}

template bool depth(const DepthStage&, const FragmentRecord&, std::int64_t, DepthRecord&, NoObserve);
template bool depth(const DepthStage&, const FragmentRecord&, std::int64_t, DepthRecord&, Observe);

}  // namespace bitspan::model
