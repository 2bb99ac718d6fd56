// SPDX-License-Identifier: Apache-2.0
#include "golden/distance.hpp"

#include <stdexcept>

#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Distancing {
 public:
  Distancing(const Config& config, const Constants& constants, const Scene& scene)
      : true_distance_(has_true_distance(config)),
        q_h_(config.format(FormatId::span_h)),
        q_s_(config.format(FormatId::distance_s)),
        q_g_(config.format(FormatId::distance_g)),
        q_d_(config.format(FormatId::distance_d)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        a_(Quantizer<Real>(config.format(FormatId::distance_a))
               .product(b_, Quantizer<Real>(config.format(FormatId::setup_s)).value(constants.record.s_max))),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)),
        zone_(config, scene) {
    if (true_distance_) factors_ = zone_factors(config, scene);
  }

  void operator()(std::span<const FragmentRecord* const> fragments, std::vector<DistanceRecord>& out) const {
    for (const FragmentRecord* fragment : fragments) {
      DistanceRecord& record = out.emplace_back();
      record.triangle = fragment->triangle;
      record.x = fragment->x;
      record.y = fragment->y;
      const Inverse<Real> inverse = unit_(q_h_.value(fragment->h) + b_);
      record.recip_m = unit_.raw(inverse.m);
      record.recip_e = inverse.e;
      const Real s = q_s_.product(inverse.times(a_));
      record.s = q_s_.raw(s);
      if (!true_distance_) continue;
      record.zone = zone_(fragment->x, fragment->y);
      const Real g = q_g_.value(factors_[static_cast<std::size_t>(record.zone)]);
      record.d = q_d_.raw(q_d_.product(s, g));
    }
  }

 private:
  bool true_distance_;
  Quantizer<Real> q_h_, q_s_, q_g_, q_d_;
  Real b_, a_;
  ReciprocalUnit<Real> unit_;
  Zoning<Real> zone_;
  std::vector<std::int64_t> factors_;
};

// The sign of (x F)^2 - (F^2 + r2): whether x is below, at or above sqrt(1 + r2/F^2). x F fits one number. A
// sum that is not exact has lost what is far below it, and so has its sign all the same.
int compare_root(Quad x, Quad focal, Quad r2) {
  ExactSum<Quad> difference(exact_product(x * focal, x * focal));
  difference.add(-focal * focal).add(-r2);
  const Quad sum = difference.get().high;
  if (sum == 0 && !difference.exact())
    throw std::logic_error("golden: the square of a distance is not exact");
  return sum < 0 ? -1 : sum > 0 ? 1 : 0;
}

}  // namespace

DistanceStage make_distance(Arithmetic arithmetic, const Config& config, const Constants& constants,
                            const Scene& scene) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> DistanceStage { return Distancing<Real>(config, constants, scene); });
}

Quad middle_of_zone(const Config& config, int zone) {
  const Quad middle = (Quad(zone) + Quad(0.5)) * pow2<Quad>(-config.fog_zone_bits);
  switch (config.fog_zone) {
    case FogZone::r2:
      return middle / 4;
    case FogZone::r:
      return middle * middle / 4;
  }
  unreachable();
}

std::vector<std::int64_t> zone_factors(const Config& config, const Scene& scene) {
  const Quad diagonal2 = Quad(scene.width) * Quad(scene.width) + Quad(scene.height) * Quad(scene.height);
  const Quad focal = Quad(scene.focal);
  if (!(scene.focal > 0 && scene.focal <= 1e300) || diagonal2 > pow2<Quad>(34) * focal * focal) {
    throw InputError(
        "scene '" + scene.name +
        "': the focal length must be positive and finite, and the picture's half diagonal at most "
        "2^16 times as long");
  }
  const Quantizer<Quad> q(config.format(FormatId::distance_g));
  const Quad halves = pow2<Quad>(config.format(FormatId::distance_g).fraction() + 1);  // of an ulp
  std::vector<std::int64_t> factors;
  for (int zone = 0; zone < 1 << config.fog_zone_bits; ++zone) {
    const Quad r2 = middle_of_zone(config, zone) * diagonal2;
    Quad count = floorq(sqrtq(1 + r2 / (focal * focal)) * halves);
    while (compare_root(count / halves, focal, r2) > 0) count -= 1;
    while (compare_root((count + 1) / halves, focal, r2) <= 0) count += 1;
    const bool rest = compare_root(count / halves, focal, r2) < 0;
    const Quad whole = floorq(count / 2);
    const bool half = count != 2 * whole;
    const Quad rounded = q.narrow_whole({whole, !half && !rest, half, half && rest});
    factors.push_back(to_integer(rounded));
  }
  return factors;
}

}  // namespace bitspan::golden
