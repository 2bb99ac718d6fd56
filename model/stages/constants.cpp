// SPDX-License-Identifier: Apache-2.0
#include "model/stages/constants.hpp"

#include <sstream>

#include "config/modes.hpp"
#include "model/numeric/from_double.hpp"
#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

[[noreturn]] void refuse(const Config& config, const Scene& scene, const char* what) {
  std::ostringstream text;
  text << "scene '" << scene.name << "': s_min " << scene.s_min << ", s_max " << scene.s_max
       << " do not fit configuration '" << config.name << "': " << what;
  throw InputError(text.str());
}

}  // namespace

template <class Watch>
Constants make_constants(const Config& config, const Scene& scene, Watch watch) {
  if (!(scene.s_min > 0 && scene.s_min < scene.s_max && scene.s_max <= 1e300)) {
    refuse(config, scene, "0 < s_min < s_max is needed, both finite");
  }
  const auto register_of = [&](FormatId id) { return make_register(config, id); };
  Constants c;
  c.exponent = ceil_log2(scene.s_max);
  ConstantsRecord& r = c.record;
  const Register s = register_of(FormatId::setup_s);
  r.s_min = quantize(scaled(exact_of(scene.s_min), c.exponent), s, watch);
  r.s_max = quantize(scaled(exact_of(scene.s_max), c.exponent), s, watch);
  if (r.s_min <= 0) {
    refuse(config, scene, "s_min / 2^E is 0 in setup.s; it needs more fraction bits");
  }
  if (r.s_min >= r.s_max) {
    refuse(config, scene, "s_min and s_max are not apart in setup.s; it needs more bits");
  }
  const Exact s_min = value_of(r.s_min, s);
  const Exact s_max = value_of(r.s_max, s);
  const Exact range = s_max - s_min;
  const Exact hmax{(int128{1} << config.depth_bits) - 1, 0};
  const Register b = register_of(FormatId::setup_b);
  r.b = quantize_ratio(hmax * s_min, range, b, watch);
  if (r.b <= 0) {
    refuse(config, scene, "B is 0 in setup.b; it needs more fraction bits");
  }
  const Exact b_exact = value_of(r.b, b);
  if (is_linear_in_distance(config.depth_code)) {
    r.c1 = quantize_ratio(hmax * b_exact * s_max, range, register_of(FormatId::depth_c1), watch);
    r.c0 = quantize_ratio(hmax * s_min, range, register_of(FormatId::depth_c0), watch);
  }
  if (is_linear_in_distance(config.fog) && scene.fog) {
    if (!(scene.fog->distance > 0 && scene.fog->distance <= 1e300)) {
      throw InputError("scene '" + scene.name + "': the fog's distance must be positive and finite");
    }
    const Exact distance = scaled(exact_of(scene.fog->distance), c.exponent);
    r.fog_scale = quantize_ratio(b_exact * s_max, distance, register_of(FormatId::fog_scale), watch);
  }
  return c;
}

Constants projector_constants(const Config& config, const Scene& scene) {
  Scene view = with_view({.s_min = scene.projector->s_min, .s_max = scene.projector->s_max});
  view.name = scene.name + "', its projector '";
  return make_constants(config, view);
}

Exact offset_value(const StartOffset& offset, const Format& kept) {
  return offset.half_ulp ? Exact{1, kept.fraction() + 1} : exact_of(offset.value);
}

Exact offset_value(const Config& config, const LineWalk& walk) {
  if (walk.offset == nullptr) return {};
  const Format kept = walk.half_ulp_of ? config.format(*walk.half_ulp_of) : config.depth_format();
  return offset_value(config.start_offset.*walk.offset, kept);
}

Exact b_of(const Config& config, const ConstantsRecord& constants) {
  return {constants.b, config.format(FormatId::setup_b).fraction()};
}

template Constants make_constants(const Config&, const Scene&, NoObserve);
template Constants make_constants(const Config&, const Scene&, Observe);

}  // namespace bitspan::model
