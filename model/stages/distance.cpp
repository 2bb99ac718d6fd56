// SPDX-License-Identifier: Apache-2.0
#include "model/stages/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "config/modes.hpp"
#include "model/numeric/big_integer.hpp"
#include "model/stages/distance-inl.hpp"

namespace bitspan::model {
namespace {

std::int64_t root_of(std::int64_t x) {
  auto root = static_cast<std::int64_t>(std::sqrt(static_cast<double>(x)));
  while (root * root > x) --root;
  while ((root + 1) * (root + 1) <= x) ++root;
  return root;
}

// Q of sqrt(1 + share diagonal / F^2), where diagonal = W^2 + H^2 and F > 0.
template <class Watch>
std::int64_t factor_of(Exact share, std::int64_t diagonal, double focal, const Register& r, Watch watch) {
  // F = f 2^exponent, so the root is that of (f^2 4^exponent + share diagonal) / (f^2 4^exponent).
  int exponent = 0;
  const double f = std::ldexp(std::frexp(focal, &exponent), 53);
  exponent -= 53;
  BigInteger bottom, top, rest;
  mpz_set_d(bottom.get(), f);
  mpz_mul(bottom.get(), bottom.get(), bottom.get());
  mpz_set_ui(top.get(), static_cast<unsigned long>(diagonal));
  mpz_mul_ui(top.get(), top.get(), static_cast<unsigned long>(share.raw));
  // Both to integers.
  const int up = 2 * exponent + share.fraction;
  (up >= 0 ? bottom : top).shift_up(static_cast<mp_bitcnt_t>(std::abs(up)));
  mpz_add(top.get(), top.get(), bottom.get());
  const int fraction = r.fraction + 1;
  top.shift_up(2 * static_cast<mp_bitcnt_t>(fraction));
  mpz_fdiv_qr(top.get(), rest.get(), top.get(), bottom.get());
  bool sticky = mpz_sgn(rest.get()) != 0;
  mpz_sqrtrem(top.get(), rest.get(), top.get());
  sticky = sticky || mpz_sgn(rest.get()) != 0;
  const auto floor = static_cast<int128>(mpz_get_ui(top.get()));  // at most 2^16 and 31 places
  return quantize(floor << 1 | (sticky ? 1 : 0), fraction + 1, r, watch);
}

}  // namespace

ScreenZones screen_zones(const Config& config, const Scene& scene) {
  return {scene.width, scene.height, config.fog_zone_bits, config.fog_zone};
}

int zone_of(const ScreenZones& zones, std::int64_t x, std::int64_t y) {
  // In half pixels.
  const std::int64_t dx = 2 * x + 1 - zones.width;
  const std::int64_t dy = 2 * y + 1 - zones.height;
  const std::int64_t all = zones.width * zones.width + zones.height * zones.height;
  const std::int64_t r2 = dx * dx + dy * dy;
  const std::int64_t count = std::int64_t{1} << zones.bits;
  switch (zones.by) {
    case FogZone::r2:
      return static_cast<int>(std::min(count - 1, count * r2 / all));
    case FogZone::r:
      // k <= sqrt(x) holds for the same integers k as k <= sqrt(floor x).
      return static_cast<int>(std::min(count - 1, root_of(count * count * r2 / all)));
  }
  unreachable();
}

std::int64_t zone_start(const ScreenZones& zones, std::int64_t zone) {
  const std::int64_t all = zones.width * zones.width + zones.height * zones.height;
  const std::int64_t count = std::int64_t{1} << zones.bits;
  switch (zones.by) {
    case FogZone::r2:
      return (zone * all + count - 1) / count;
    case FogZone::r:
      return (zone * zone * all + count * count - 1) / (count * count);
  }
  unreachable();
}

Exact middle_of(const ScreenZones& zones, int zone) {
  const int128 odd = 2 * zone + 1;
  switch (zones.by) {
    case FogZone::r2:
      return {odd, zones.bits + 3};
    case FogZone::r:
      return {odd * odd, 2 * zones.bits + 4};
  }
  unreachable();
}

template <class Watch>
Exact distance_constant(const Config& config, const Constants& constants, Watch watch) {
  const Register a = make_register(config, FormatId::distance_a);
  const Exact s_max = value_of(constants.record.s_max, make_register(config, FormatId::setup_s));
  return value_of(quantize(b_of(config, constants.record) * s_max, a, watch), a);
}

template <class Watch>
std::vector<std::int64_t> zone_factors(const Config& config, const Scene& scene, Watch watch) {
  const double half_diagonal =
      std::hypot(static_cast<double>(scene.width), static_cast<double>(scene.height)) / 2;
  if (!(scene.focal > 0 && scene.focal <= 1e300) || half_diagonal > 0x1p16 * scene.focal) {
    throw InputError(
        "scene '" + scene.name +
        "': the focal length must be positive and finite, and the picture's half diagonal at most "
        "2^16 times as long");
  }
  const ScreenZones zones = screen_zones(config, scene);
  const Register g = make_register(config, FormatId::distance_g);
  const std::int64_t diagonal = zones.width * zones.width + zones.height * zones.height;
  std::vector<std::int64_t> factors;
  for (int zone = 0; zone < 1 << zones.bits; ++zone) {
    factors.push_back(factor_of(middle_of(zones, zone), diagonal, scene.focal, g, watch));
  }
  return factors;
}

template <class Watch>
DistanceStage prepare_distance(const Config& config, const Constants& constants, const Scene& scene,
                               Watch watch) {
  DistanceStage s;
  s.true_distance = has_true_distance(config);
  s.q = make_inverse_depth(config, constants);
  s.a = distance_constant(config, constants, watch);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.s = make_register(config, FormatId::distance_s);
  // No exponent is below that of one ulp of h + B, so that nothing is shifted up.
  const Register& m = s.reciprocal.output();
  s.fits_int64 = bit_length(static_cast<uint128>(s.a.raw)) + m.word <= 61 &&
                 s.a.fraction + m.fraction - std::max(s.q.fraction, 0) > s.s.fraction;
  s.g = make_register(config, FormatId::distance_g);
  s.d = make_register(config, FormatId::distance_d);
  if (!s.true_distance) return s;
  s.zones = screen_zones(config, scene);
  s.factors = zone_factors(config, scene, watch);
  return s;
}

template <class Watch>
void distance(const DistanceStage& stage, const FragmentRecord& fragment, DistanceRecord& out, Watch watch) {
  out = {};
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  const auto point = HWY_NAMESPACE::distance_point<int128>(stage, fragment.h, watch);
  out.recip_m = point.recip_m;
  out.recip_e = point.recip_e;
  out.s = point.s;
  if (!stage.true_distance) return;
  out.zone = zone_of(stage.zones, fragment.x, fragment.y);
  const Exact g = value_of(stage.factors[static_cast<std::size_t>(out.zone)], stage.g);
  out.d = quantize(value_of(out.s, stage.s) * g, stage.d, watch);
}

template Exact distance_constant(const Config&, const Constants&, NoObserve);
template Exact distance_constant(const Config&, const Constants&, Observe);
template std::vector<std::int64_t> zone_factors(const Config&, const Scene&, NoObserve);
template std::vector<std::int64_t> zone_factors(const Config&, const Scene&, Observe);
template DistanceStage prepare_distance(const Config&, const Constants&, const Scene&, NoObserve);
template DistanceStage prepare_distance(const Config&, const Constants&, const Scene&, Observe);
template void distance(const DistanceStage&, const FragmentRecord&, DistanceRecord&, NoObserve);
template void distance(const DistanceStage&, const FragmentRecord&, DistanceRecord&, Observe);

}  // namespace bitspan::model
