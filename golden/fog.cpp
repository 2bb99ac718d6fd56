// SPDX-License-Identifier: Apache-2.0
#include "golden/fog.hpp"

#include <algorithm>
#include <limits>

#include "config/modes.hpp"
#include "golden/channel.hpp"
#include "golden/distance.hpp"
#include "golden/lanes.hpp"
#include "golden/log2.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// The exponent of the least power of two, 1 or more, that no G exceeds.
int fog_range(const Config& config, const Scene& scene) {
  const std::vector<std::int64_t> factors = zone_factors(config, scene);
  const Quad most = Quantizer<Quad>(config.format(FormatId::distance_g)).value(std::ranges::max(factors));
  int exponent = 0;
  while (pow2<Quad>(exponent) < most) ++exponent;
  return exponent;
}

constexpr double never = std::numeric_limits<double>::infinity();  // a share that takes the colour as it is

template <class Real>
class Fogging {
 public:
  Fogging(const Config& config, const Constants& constants, const Scene& scene)
      : mode_(scene.fog ? config.fog : FogMode::none),
        q_h_(config.format(FormatId::span_h)),
        q_s_(config.format(FormatId::distance_s)),
        q_d_(config.format(FormatId::distance_d)),
        q_in_(config.format(FormatId::texture_color)),
        q_factor_(config.format(FormatId::fog_factor)),
        q_color_(config.format(FormatId::fog_color)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        scale_(Quantizer<Real>(config.format(FormatId::fog_scale)).value(constants.record.fog_scale)),
        zone_(config, scene),
        depth_steps_(1 << config.fog_depth_bits),
        zones_(1 << config.fog_zone_bits),
        depth_step_(pow2<Real>(-(config.depth_bits - config.fog_depth_bits))),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)),
        quick_color_(config.format(FormatId::fog_color)) {
    no_fog_ = q_factor_.raw(q_factor_(Real(1)));
    channel_ = place_of(constants, LineId::fog);
    if (scene.fog) {
      for (std::size_t i = 0; i < 3; ++i) fog_[i] = Real(scene.fog->color[i]);
    }
    if (!has_fog(mode_) || fog_entries(config) == 0) return;
    table_ = fog_table(config, constants, scene);
    if (takes_true_distance(mode_)) {
      distance_step_ = pow2<Real>(config.fog_depth_bits - fog_range(config, scene));
    }
    log_step_ = pow2<Real>(config.fog_depth_bits - 4);
  }

  void operator()(std::span<const FragmentRecord* const> fragments,
                  std::span<const TextureRecord* const> textures,
                  std::span<const DistanceRecord* const> distances,
                  std::span<const FragmentChannelRecord* const> channels, std::vector<FogRecord>& out) const {
    const std::size_t first = out.size();
    out.resize(first + fragments.size());
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      FogRecord& record = out[first + i];
      record.triangle = fragments[i]->triangle;
      record.x = fragments[i]->x;
      record.y = fragments[i]->y;
      set_factor(*fragments[i], distances.empty() ? nullptr : distances[i],
                 channels.empty() ? nullptr : channels[i], record);
    }
    for (std::size_t at = 0; at < textures.size(); at += lanes) {
      const std::span part = textures.subspan(at, std::min(lanes, textures.size() - at));
      const std::span records = std::span(out).subspan(first + at, part.size());
      if (quick(part, records)) continue;
      for (std::size_t i = 0; i < part.size(); ++i) set_color(*part[i], records[i]);
    }
  }

 private:
  // The step of a table that a number of steps lies in.
  std::int64_t step_of(Real steps) const {
    const Real whole = floor_of(steps);
    return whole < 0 ? 0 : whole >= depth_steps_ ? depth_steps_ - 1 : to_integer(whole);
  }

  void set_factor(const FragmentRecord& fragment, const DistanceRecord* distance,
                  const FragmentChannelRecord* channels, FogRecord& out) const {
    out.index = -1;
    const Real h = q_h_.value(fragment.h);
    switch (mode_) {
      case FogMode::none:
        out.factor = no_fog_;
        break;
      case FogMode::linear: {
        const Inverse<Real> inverse = unit_(h + b_);
        out.recip_m = unit_.raw(inverse.m);
        out.recip_e = inverse.e;
        out.factor = q_factor_.raw(q_factor_.sum(-inverse.times(scale_), Real(1)));
        break;
      }
      case FogMode::table: {
        out.index = step_of(h * depth_step_) * zones_ + zone_(fragment.x, fragment.y);
        out.factor = table_[static_cast<std::size_t>(out.index)];
        break;
      }
      case FogMode::distance:
        out.index = step_of(q_d_.value(distance->d) * distance_step_);
        out.factor = table_[static_cast<std::size_t>(out.index)];
        break;
      case FogMode::log: {
        const Real s = std::max(q_s_.value(distance->s), q_s_.ulp());
        const Real place = std::clamp((linear_log2(s) + Real(16)) * log_step_, Real(0), Real(depth_steps_));
        out.index = step_of(place);
        const auto at = static_cast<std::size_t>(out.index);
        const Real from = q_factor_.value(table_[at]);
        const Real to = q_factor_.value(table_[at + 1]);
        out.factor = q_factor_.raw(q_factor_.sum(exact_product(to - from, place - Real(out.index)), from));
        break;
      }
      case FogMode::vertex:
        out.factor = channels[channel_].w;
        break;
    }
  }

  void set_color(const TextureRecord& texture, FogRecord& out) const {
    const std::array<Real, 3> in{q_in_.value(texture.r), q_in_.value(texture.g), q_in_.value(texture.b)};
    const Real factor = q_factor_.value(out.factor);
    const auto toward = [&](std::size_t i) {
      if (!has_fog(mode_)) return q_color_.raw(q_color_(in[i]));
      return q_color_.raw(q_color_.sum(fog_[i], (in[i] - fog_[i]) * factor));
    };
    out.r = toward(0);
    out.g = toward(1);
    out.b = toward(2);
  }

  // The colours of all, or false.
  bool quick(std::span<const TextureRecord* const> textures, std::span<FogRecord> out) const {
    if constexpr (std::same_as<Real, double>) {
      if (!quick_color_.usable) return false;
      const std::size_t n = out.size();
      constexpr std::array in{&TextureRecord::r, &TextureRecord::g, &TextureRecord::b};
      constexpr std::array result{&FogRecord::r, &FogRecord::g, &FogRecord::b};
      const double scale = 1 / q_color_.ulp();
      std::array<Column, 3> color;  // NOLINT(cppcoreguidelines-pro-type-member-init): n lanes are set
      Column base, factor;          // NOLINT(cppcoreguidelines-pro-type-member-init): n lanes are set
      for (std::size_t i = 0; i < n; ++i) factor.at[i] = static_cast<double>(out[i].factor);
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < n; ++i) color[c].at[i] = q_in_.value(textures[i]->*in[c]);
        std::fill_n(static_cast<double*>(base.at), n, fog_[c]);
        const std::int64_t bad = has_fog(mode_) ? lanes_narrow_toward(base, color[c], factor, q_factor_.ulp(),
                                                                      never, scale, quick_color_, n, color[c])
                                                : lanes_narrow(color[c], scale, quick_color_, n, color[c]);
        if (bad != 0) return false;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < n; ++i) out[i].*result[c] = static_cast<std::int64_t>(color[c].at[i]);
      }
      return true;
    }
    return false;
  }

  FogMode mode_;
  Quantizer<Real> q_h_, q_s_, q_d_, q_in_, q_factor_, q_color_;
  Real b_, scale_;
  std::array<Real, 3> fog_{};
  Zoning<Real> zone_;
  int depth_steps_, zones_;
  Real depth_step_, distance_step_ = 0, log_step_ = 0;  // steps per unit of what the index is made of
  ReciprocalUnit<Real> unit_;
  std::vector<std::int64_t> table_;
  std::int64_t no_fog_ = 0;
  std::ptrdiff_t channel_ = 0;  // which of those in use is fog's
  LaneFormat quick_color_;
};

}  // namespace

FogStage make_fog(Arithmetic arithmetic, const Config& config, const Constants& constants,
                  const Scene& scene) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> FogStage { return Fogging<Real>(config, constants, scene); });
}

std::int64_t faded(const Quantizer<Quad>& q, Quad d, Quad distance) {
  // The exponential is never on a rounding boundary (it is transcendental), so an enclosure by the error of
  // the quadruple-precision result decides the rounding; the margin is far above that error for every d that
  // does not underflow. The result is below 1, however small d is.
  const Quad margin = pow2<Quad>(-96);
  const Quad factor = expq(-d / distance);
  const std::int64_t low = q.raw(q(factor * (1 - margin)));
  const std::int64_t high = q.raw(q(std::min(factor * (1 + margin), 1 - pow2<Quad>(-112))));
  if (low != high) throw std::logic_error("golden: a factor of the fog is too near a rounding boundary");
  return low;
}

std::vector<std::int64_t> fog_table(const Config& config, const Constants& constants, const Scene& scene) {
  const Quantizer<Quad> q(config.format(FormatId::fog_factor));
  const Quad b = Quantizer<Quad>(config.format(FormatId::setup_b)).value(constants.record.b);
  const Quad a = b * Quad(scene.s_max);
  const Quad diagonal2 = Quad(scene.width) * Quad(scene.width) + Quad(scene.height) * Quad(scene.height);
  const Quad focal2 = Quad(scene.focal) * Quad(scene.focal);
  const int depth_steps = 1 << config.fog_depth_bits;
  const int zones = 1 << config.fog_zone_bits;
  const Quad depth_step = pow2<Quad>(config.depth_bits) / depth_steps;
  std::vector<std::int64_t> table;
  table.reserve(static_cast<std::size_t>(fog_entries(config)));
  const auto add = [&](Quad d) { table.push_back(faded(q, d, Quad(scene.fog->distance))); };
  const Quad normal = pow2<Quad>(constants.s_exponent);
  if (takes_true_distance(config.fog)) {
    const Quad step = pow2<Quad>(fog_range(config, scene) - config.fog_depth_bits) * normal;
    for (int i = 0; i < depth_steps; ++i) add((Quad(i) + Quad(0.5)) * step);
    return table;
  }
  if (takes_distance(config.fog)) {
    for (int i = 0; i <= depth_steps; ++i) {
      const Quad octaves = Quad(i) * 16 / depth_steps - 16;
      const Quad octave = floorq(octaves);
      add(pow2<Quad>(static_cast<int>(octave)) * (1 + octaves - octave) * normal);
    }
    return table;
  }
  for (int hi = 0; hi < depth_steps; ++hi) {
    const Quad s = a / ((Quad(hi) + Quad(0.5)) * depth_step + b);
    for (int zone = 0; zone < zones; ++zone) {
      add(s * sqrtq(1 + middle_of_zone(config, zone) * diagonal2 / focal2));
    }
  }
  return table;
}

}  // namespace bitspan::golden
