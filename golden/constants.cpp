// SPDX-License-Identifier: Apache-2.0
#include "golden/constants.hpp"

#include <cmath>

#include "config/modes.hpp"
#include "golden/channel.hpp"
#include "golden/quantize.hpp"

namespace bitspan::golden {

namespace {

using Real = Checked<Quad>;

// The smallest E with x <= 2^E.
int exponent_above(double x) {
  int e = 0;
  return std::frexp(x, &e) == 0.5 ? e - 1 : e;
}

}  // namespace

Constants make_constants(const Config& config, const Scene& scene) {
  const Quantizer<Real> q_s(config.format(FormatId::setup_s));
  const Quantizer<Real> q_b(config.format(FormatId::setup_b));
  const Quantizer<Real> q_c1(config.format(FormatId::depth_c1));
  const Quantizer<Real> q_c0(config.format(FormatId::depth_c0));
  const Quantizer<Real> q_fog(config.format(FormatId::fog_scale));

  if (!std::isfinite(scene.s_max) || scene.s_max <= 0) throw InputError("s_max: must be positive and finite");
  Constants out;
  out.s_exponent = exponent_above(scene.s_max);
  const Real normalise = Real(scalbnq(1, -out.s_exponent));
  const Real s_min = q_s(Real(Quad(scene.s_min)) * normalise);
  const Real s_max = q_s(Real(Quad(scene.s_max)) * normalise);
  if (!(s_min > 0 && s_min < s_max)) {
    throw InputError("setup.s: s_min and s_max of the scene are not apart, or s_min is 0, in this format");
  }
  const Real hmax = pow2<Real>(config.depth_bits) - 1;
  const Real range = s_max - s_min;
  const Real b = q_b.quotient(hmax * s_min, range);
  if (!(b > 0)) throw InputError("setup.b: the constant B of this scene is not above 0 in this format");

  Real c1 = 0;
  Real c0 = 0;
  Real fog_scale = 0;
  if (is_linear_in_distance(config.depth_code)) {
    c1 = q_c1.quotient(hmax * b * s_max, range);
    c0 = q_c0.quotient(hmax * s_min, range);
  }
  if (is_linear_in_distance(config.fog) && scene.fog) {
    try {
      fog_scale = q_fog.quotient(b * s_max, Real(Quad(scene.fog->distance)) * normalise);
    } catch (const InexactError&) {
      throw InputError("fog.scale: the fog distance of the scene is too small for this format");
    }
  }
  out.record = {.s_min = q_s.raw(s_min),
                .s_max = q_s.raw(s_max),
                .b = q_b.raw(b),
                .c1 = q_c1.raw(c1),
                .c0 = q_c0.raw(c0),
                .fog_scale = q_fog.raw(fog_scale)};
  out.channels = channels_in_use(config, scene);
  if (scene.fog) out.fog_distance = scene.fog->distance;
  return out;
}

}  // namespace bitspan::golden
