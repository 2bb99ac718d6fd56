// SPDX-License-Identifier: Apache-2.0
#include "model/stages/fog.hpp"

#include <mpfr.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "config/modes.hpp"
#include "model/numeric/log2.hpp"
#include "model/stages/fog-inl.hpp"

namespace bitspan::model {
namespace {

// MPFR's numbers with an owner; every operation rounds to nearest.
class Real {
 public:
  explicit Real(mpfr_prec_t precision) { mpfr_init2(value_, precision); }
  ~Real() { mpfr_clear(value_); }
  Real(const Real&) = delete;
  Real& operator=(const Real&) = delete;
  mpfr_ptr get() { return value_; }

 private:
  mpfr_t value_;
};

void set(Real& out, Exact x) {  // 0 <= x.raw < 2^64
  mpfr_set_ui(out.get(), static_cast<unsigned long>(x.raw), MPFR_RNDN);
  mpfr_mul_2si(out.get(), out.get(), -x.fraction, MPFR_RNDN);
}

double number_of(Exact x) { return std::ldexp(static_cast<double>(x.raw), -x.fraction); }

// out = exp(-D/DT); D is lost.
void fade(Real& out, Real& d, double distance) {
  mpfr_div_d(d.get(), d.get(), distance, MPFR_RNDN);
  mpfr_neg(d.get(), d.get(), MPFR_RNDN);
  mpfr_exp(out.get(), d.get(), MPFR_RNDN);
}

// The factor at a step of depth and a zone, at a working precision.
void factor_at_depth(Real& out, const Config& config, const Constants& constants, const Scene& scene, int hi,
                     int zone, mpfr_prec_t precision) {
  Real s(precision);
  Real t(precision);
  Real r(precision);
  // S = B s_max / (hc + B)
  set(s, b_of(config, constants.record));
  set(t, Exact{2 * hi + 1, 1});
  mpfr_mul_2si(t.get(), t.get(), config.depth_bits - config.fog_depth_bits, MPFR_RNDN);
  mpfr_add(t.get(), t.get(), s.get(), MPFR_RNDN);
  mpfr_mul_d(s.get(), s.get(), scene.s_max, MPFR_RNDN);
  mpfr_div(s.get(), s.get(), t.get(), MPFR_RNDN);
  const auto w = static_cast<unsigned long>(scene.width);
  const auto h = static_cast<unsigned long>(scene.height);
  set(r, middle_of(screen_zones(config, scene), zone));
  mpfr_mul_ui(r.get(), r.get(), w * w + h * h, MPFR_RNDN);
  // D = S sqrt(1 + r2/F^2)
  mpfr_div_d(r.get(), r.get(), scene.focal, MPFR_RNDN);
  mpfr_div_d(r.get(), r.get(), scene.focal, MPFR_RNDN);
  mpfr_add_ui(r.get(), r.get(), 1, MPFR_RNDN);
  mpfr_sqrt(r.get(), r.get(), MPFR_RNDN);
  mpfr_mul(s.get(), s.get(), r.get(), MPFR_RNDN);
  fade(out, s, scene.fog->distance);
}

// D/DT of the same, with a relative error below 2^-48: some twenty roundings.
double fade_at_depth(const Config& config, const Constants& constants, const Scene& scene, int hi, int zone) {
  const double b = number_of(b_of(config, constants.record));
  const double h = std::ldexp(hi + 0.5, config.depth_bits - config.fog_depth_bits);
  const double width = scene.width;
  const double height = scene.height;
  const double r = number_of(middle_of(screen_zones(config, scene), zone)) *
                   (width * width + height * height) / scene.focal / scene.focal;
  return b * scene.s_max / (h + b) * std::sqrt(1 + r) / scene.fog->distance;
}

// floor(x 2^fraction) where it fits 126 bits; 0 <= x.
int128 floor_at(Real& x, int fraction) {
  mpz_t z;
  mpz_init(z);
  mpfr_mul_2si(x.get(), x.get(), fraction, MPFR_RNDN);
  mpfr_get_z(z, x.get(), MPFR_RNDD);
  std::array<std::uint64_t, 2> words{};
  std::size_t count = 0;
  mpz_export(words.data(), &count, -1, sizeof(std::uint64_t), 0, 0, z);
  mpz_clear(z);
  return static_cast<int128>(uint128{words[1]} << 64 | words[0]);
}

// floor(exp(-fade) 2^fraction), and none where double precision cannot tell it. fade has a relative error
// below 2^-48, so that of exp is below 2^-40 while fade < 2^7.
std::optional<int128> quick_floor(double fade, int fraction) {
  const double x = std::ldexp(std::exp(-fade), fraction);
  if (!(fade >= 0 && fade < 128 && x < 0x1p52)) return std::nullopt;
  const double low = std::floor(x * (1 - 0x1p-40));
  if (low != std::floor(x * (1 + 0x1p-40))) return std::nullopt;
  return static_cast<std::int64_t>(low);
}

// Q[r] of what factor(out, precision) gives: exp(-D/DT) at a working precision. Its relative error
// is below 2^(16 - precision) while D/DT < 2^12, a few units of the last place times D/DT; beyond, the entry
// is far below any register's last place. `fade` is D/DT with a relative error below 2^-48.
template <class Factor, class Watch>
std::int64_t rounded_entry(const Register& r, double fade, Factor factor, Watch watch) {
  // The entry is irrational: kept bits, a guard bit, and something below. More precision until the bits down
  // to the guard are the same at both ends of the error interval.
  const int fraction = std::max(0, r.fraction + 1);
  if (const auto floor = quick_floor(fade, fraction)) {
    return quantize(*floor << 1 | 1, fraction + 1, r, watch);
  }
  for (mpfr_prec_t precision = 128;; precision *= 2) {
    Real x(precision);
    factor(x, precision);
    Real error(precision);
    mpfr_mul_2si(error.get(), x.get(), 16 - static_cast<long>(precision), MPFR_RNDU);
    Real low(precision);
    mpfr_sub(low.get(), x.get(), error.get(), MPFR_RNDD);
    mpfr_add(x.get(), x.get(), error.get(), MPFR_RNDU);
    const int128 floor = floor_at(low, fraction);
    if (floor == floor_at(x, fraction)) {
      return quantize(floor << 1 | 1, fraction + 1, r, watch);
    }
  }
}

// Q of exp(-D/DT) at D 2^-E.
template <class Watch>
std::int64_t entry_at(const Config& config, const Constants& constants, const Scene& scene, Exact distance,
                      Watch watch) {
  return rounded_entry(
      make_register(config, FormatId::fog_factor),
      number_of(scaled(distance, -constants.exponent)) / scene.fog->distance,
      [&](Real& out, mpfr_prec_t precision) {
        Real d(precision);
        set(d, scaled(distance, -constants.exponent));
        fade(out, d, scene.fog->distance);
      },
      watch);
}

// The distance at which entry k of mode log stands: Lg of it is k 2^(4 - n) - 16.
Exact log_distance(int k, int index_bits) {
  const Exact place = Exact{k, index_bits - log_octave_bits} - Exact{1 << log_octave_bits, 0};
  const int128 octave = floor_of(place);
  return scaled(Exact{1, 0} + (place - Exact{octave, 0}), -static_cast<int>(octave));
}

// The exponent of the least power of two, 1 or more, that no G exceeds.
template <class Watch>
int reach_of(const Config& config, const Scene& scene, Watch watch) {
  const Register g = make_register(config, FormatId::distance_g);
  const std::vector<std::int64_t> factors = zone_factors(config, scene, watch);
  const Exact most = value_of(std::ranges::max(factors), g);
  int exponent = 0;
  while (sign_of(most - scaled(Exact{1, 0}, -exponent)) > 0) ++exponent;
  return exponent;
}

struct Blend {
  std::int64_t index, factor;
};
// Mode log: the interval of s and the factor inside it.
template <class Watch>
Blend between_entries(const FogStage& stage, std::int64_t s, Watch watch) {
  const Exact octaves = linear_log2(static_cast<uint128>(std::max<std::int64_t>(s, 1)), stage.s.fraction) +
                        Exact{1 << log_octave_bits, 0};
  Exact place = scaled(octaves, log_octave_bits - stage.index_bits);
  const Exact end{stage.last_step + 1, 0};
  if (place.raw < 0) place = {0, 0};
  if (sign_of(place - end) > 0) place = end;
  const std::int64_t i = std::min(static_cast<std::int64_t>(floor_of(place)), stage.last_step);
  const Exact from = value_of(stage.table[static_cast<std::size_t>(i)], stage.factor);
  const Exact to = value_of(stage.table[static_cast<std::size_t>(i) + 1], stage.factor);
  return {i, quantize(from + (to - from) * (place - Exact{i, 0}), stage.factor, watch)};
}

// Mode distance: the entry of d.
std::int64_t distance_step(const FogStage& stage, std::int64_t d) {
  const Exact steps = scaled(value_of(d, stage.d), stage.range - stage.index_bits);
  return static_cast<std::int64_t>(std::clamp<int128>(floor_of(steps), 0, stage.last_step));
}

}  // namespace

std::int64_t fog_step(const FogStage& stage, std::int64_t h) { return HWY_NAMESPACE::fog_step(stage, h); }

template <class Watch>
std::int64_t fog_entry(const Config& config, const Constants& constants, const Scene& scene, int hi, int zone,
                       Watch watch) {
  return rounded_entry(
      make_register(config, FormatId::fog_factor), fade_at_depth(config, constants, scene, hi, zone),
      [&](Real& out, mpfr_prec_t precision) {
        factor_at_depth(out, config, constants, scene, hi, zone, precision);
      },
      watch);
}

template <class Watch>
FogStage prepare_fog(const Config& config, const Constants& constants, const Scene& scene, Watch watch) {
  FogStage s;
  s.mode = scene.fog ? config.fog : FogMode::none;
  s.zones = screen_zones(config, scene);
  s.index_bits = config.fog_depth_bits;
  s.last_step = (std::int64_t{1} << config.fog_depth_bits) - 1;
  // Farther, no bit of h is left, or every h but 0 is past the last step.
  s.step_shift = std::clamp(
      config.format(FormatId::span_h).fraction() + config.depth_bits - config.fog_depth_bits, -40, 63);
  static_cast<FogFormats&>(s) = fog_formats(config);
  s.q = make_inverse_depth(config, constants);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.scale = {constants.record.fog_scale, s.scale_fraction};
  if (scene.fog) {
    s.fog_color = scene.fog->color;
  }
  s.s = make_register(config, FormatId::distance_s);
  s.d = make_register(config, FormatId::distance_d);
  if (has_fog_table(s.mode) || takes_distance(s.mode) || has_vertex_fog(s.mode)) {
    if (!(scene.fog->distance > 0 && scene.fog->distance <= 1e300 && scene.focal > 0 &&
          scene.focal <= 1e300)) {
      throw InputError("scene '" + scene.name +
                       "': the fog's distance and the focal length must be positive and finite");
    }
    const int entries = static_cast<int>(fog_entries(config));
    s.table.reserve(static_cast<std::size_t>(entries));
    if (takes_true_distance(s.mode)) s.range = reach_of(config, scene, watch);
    for (int i = 0; i < entries; ++i) {
      if (has_fog_table(s.mode)) {
        s.table.push_back(
            fog_entry(config, constants, scene, i >> s.zones.bits, i & ((1 << s.zones.bits) - 1), watch));
      } else if (takes_true_distance(s.mode)) {
        s.table.push_back(
            entry_at(config, constants, scene, Exact{2 * i + 1, s.index_bits + 1 - s.range}, watch));
      } else {
        s.table.push_back(entry_at(config, constants, scene, log_distance(i, s.index_bits), watch));
      }
    }
    mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE);  // the thread may end after this
  }
  return s;
}

template <class Watch>
FogFactor fog_factor(const FogStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
                     Watch watch, const FragmentChannels* channels) {
  namespace text = HWY_NAMESPACE;
  const auto entry = [&](std::int64_t index) {
    return FogFactor{.index = index, .factor = stage.table[static_cast<std::size_t>(index)]};
  };
  switch (stage.mode) {
    case FogMode::none:
      return {.factor = quantize(std::int64_t{1}, 0, stage.factor, watch)};
    case FogMode::linear: {
      const auto linear = text::linear_fog<int128>(stage, stage, fragment.h, watch);
      return {.recip_m = linear.recip_m, .recip_e = linear.recip_e, .factor = linear.factor};
    }
    case FogMode::table:
      return entry(text::fog_index<std::int64_t>(stage, fog_step(stage, fragment.h),
                                                 zone_of(stage.zones, fragment.x, fragment.y)));
    case FogMode::distance:
      return entry(distance_step(stage, distance.d));
    case FogMode::log: {
      const Blend blend = between_entries(stage, distance.s, watch);
      return {.index = blend.index, .factor = blend.factor};
    }
    case FogMode::vertex:
      return {.factor = channel_value(*channels, LineId::fog)};
  }
  unreachable();
}

template <class Watch>
std::int64_t fog_at(double s, double distance, const Register& r, Watch watch) {
  const std::int64_t factor = rounded_entry(
      r, s / distance,
      [&](Real& out, mpfr_prec_t precision) {
        Real d(precision);
        mpfr_set_d(d.get(), s, MPFR_RNDN);
        fade(out, d, distance);
      },
      watch);
  mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE);  // the thread may end after this
  return factor;
}

template <class Watch>
void fog(const FogStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
         const TextureRecord& texture, FogRecord& out, Watch watch, const FragmentChannels* channels) {
  namespace text = HWY_NAMESPACE;
  const FogFormats& formats = stage;
  const FogFactor found = fog_factor(stage, fragment, distance, watch, channels);
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  out.index = found.index;
  out.recip_m = found.recip_m;
  out.recip_e = found.recip_e;
  out.factor = found.factor;
  std::array own{texture.r, texture.g, texture.b};
  for (std::size_t c = 0; c < own.size(); ++c) {
    if (!has_fog(stage.mode)) {
      own[c] = text::unfogged(formats, own[c], watch);
    } else if (formats.fits_int64) {
      own[c] = text::fogged<std::int64_t>(formats, own[c], stage.fog_color[c], out.factor, watch);
    } else {
      own[c] = text::fogged<int128>(formats, own[c], stage.fog_color[c], out.factor, watch);
    }
  }
  out.r = own[0];
  out.g = own[1];
  out.b = own[2];
}

template std::int64_t fog_entry(const Config&, const Constants&, const Scene&, int, int, NoObserve);
template std::int64_t fog_entry(const Config&, const Constants&, const Scene&, int, int, Observe);
template FogStage prepare_fog(const Config&, const Constants&, const Scene&, NoObserve);
template FogStage prepare_fog(const Config&, const Constants&, const Scene&, Observe);
template FogFactor fog_factor(const FogStage&, const FragmentRecord&, const DistanceRecord&, NoObserve,
                              const FragmentChannels*);
template FogFactor fog_factor(const FogStage&, const FragmentRecord&, const DistanceRecord&, Observe,
                              const FragmentChannels*);
template void fog(const FogStage&, const FragmentRecord&, const DistanceRecord&, const TextureRecord&,
                  FogRecord&, NoObserve, const FragmentChannels*);
template void fog(const FogStage&, const FragmentRecord&, const DistanceRecord&, const TextureRecord&,
                  FogRecord&, Observe, const FragmentChannels*);
template std::int64_t fog_at(double, double, const Register&, NoObserve);
template std::int64_t fog_at(double, double, const Register&, Observe);

}  // namespace bitspan::model
