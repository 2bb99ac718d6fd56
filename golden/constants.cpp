// SPDX-License-Identifier: Apache-2.0
#include "golden/constants.hpp"

#include <cmath>
#include <string>

#include "config/modes.hpp"
#include "golden/channel.hpp"
#include "golden/light.hpp"
#include "golden/quantize.hpp"

namespace bitspan::golden {

namespace {

using Real = Checked<Quad>;

// The smallest E with x <= 2^E.
int exponent_above(double x) {
  int e = 0;
  return std::frexp(x, &e) == 0.5 ? e - 1 : e;
}

// A range of distances, as the depth codes of an eye take it.
struct Range {
  int exponent = 0;  // E
  Real s_min = 0, s_max = 0, b = 0;
};
// whose: the eye, in the messages.
Range range_of(const Config& config, double s_min, double s_max, const std::string& whose) {
  const Quantizer<Real> q_s(config.format(FormatId::setup_s));
  if (!std::isfinite(s_max) || s_max <= 0) throw InputError("s_max: must be positive and finite");
  Range out;
  out.exponent = exponent_above(s_max);
  const Real normalise = Real(scalbnq(1, -out.exponent));
  out.s_min = q_s(Real(Quad(s_min)) * normalise);
  out.s_max = q_s(Real(Quad(s_max)) * normalise);
  if (!(out.s_min > 0 && out.s_min < out.s_max)) {
    throw InputError("setup.s: s_min and s_max of the " + whose +
                     " are not apart, or s_min is 0, in this format");
  }
  const Real hmax = pow2<Real>(config.depth_bits) - 1;
  out.b = Quantizer<Real>(config.format(FormatId::setup_b)).quotient(hmax * out.s_min, out.s_max - out.s_min);
  if (!(out.b > 0)) {
    throw InputError("setup.b: the constant B of this " + whose + " is not above 0 in this format");
  }
  return out;
}

}  // namespace

Constants make_constants(const Config& config, const Scene& scene) {
  const Quantizer<Real> q_s(config.format(FormatId::setup_s));
  const Quantizer<Real> q_b(config.format(FormatId::setup_b));
  const Quantizer<Real> q_c1(config.format(FormatId::depth_c1));
  const Quantizer<Real> q_c0(config.format(FormatId::depth_c0));
  const Quantizer<Real> q_fog(config.format(FormatId::fog_scale));

  const auto [exponent, s_min, s_max, b] = range_of(config, scene.s_min, scene.s_max, "scene");
  const Real hmax = pow2<Real>(config.depth_bits) - 1;
  const Real range = s_max - s_min;
  Constants out;
  out.s_exponent = exponent;
  out.z_max = std::exp2(config.depth_bits) - 1;

  Real c1 = 0;
  Real c0 = 0;
  Real fog_scale = 0;
  if (is_linear_in_distance(config.depth_code)) {
    c1 = q_c1.quotient(hmax * b * s_max, range);
    c0 = q_c0.quotient(hmax * s_min, range);
  }
  if (is_linear_in_distance(config.fog) && scene.fog) {
    try {
      fog_scale = q_fog.quotient(b * s_max, Real(Quad(scene.fog->distance)) * Real(scalbnq(1, -exponent)));
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
  if (scene.light && lights_vertices(config.light)) out.light = make_vertex_light(config, exponent, scene);
  if (scene.projector && has_project(config.project)) {
    const Range of = range_of(config, scene.projector->s_min, scene.projector->s_max, "projector");
    out.projector = {.s_exponent = of.exponent, .s_max = q_s.raw(of.s_max), .b = q_b.raw(of.b)};
  }
  return out;
}

}  // namespace bitspan::golden
