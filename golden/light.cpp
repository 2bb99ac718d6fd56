// SPDX-License-Identifier: Apache-2.0
#include "golden/light.hpp"

#include <cmath>
#include <memory>
#include <optional>

#include "config/modes.hpp"
#include "golden/channel.hpp"
#include "golden/root.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// The smallest e with x <= 2^e.
int octaves(double x) {
  int e = 0;
  return std::frexp(x, &e) == 0.5 ? e - 1 : e;
}

// Q of (j 2^-bits)^power.
std::int64_t power_of(const Quantizer<Quad>& q, int j, int bits, int power) {
  if (j == 0) return q.raw(q(Quad(0)));
  int odd = j;
  while (odd % 2 == 0) {
    odd /= 2;
    --bits;
  }
  Quad value = 1;
  for (int i = 0; i < power; ++i) value *= odd;
  value = scalbnq(value, -bits * power);
  if (power * std::log2(odd) <= 112) return q.raw(q(value));  // exact
  // An odd number of more than 113 bits is on no boundary of the rounding.
  const Quad margin = pow2<Quad>(-100);
  const std::int64_t low = q.raw(q(value * (1 - margin)));
  if (low != q.raw(q(value * (1 + margin)))) {
    throw std::logic_error("golden: an entry of the highlight's table is too near a rounding boundary");
  }
  return low;
}

template <class Real>
using Vector = std::array<Real, 3>;

template <class Real>
struct Shine {
  Vector<Real> normal{}, direction{};
  Real cosine = 0, mirrored = 0, specular = 0, value = 0;
};

template <class Real>
class Lighting {
 public:
  Lighting(const Config& config, int s_exponent, const Scene& scene)
      : root_(config),
        q_position_(config.format(FormatId::light_position)),
        q_normal_(config.format(FormatId::light_normal)),
        q_direction_(config.format(FormatId::light_direction)),
        q_cosine_(config.format(FormatId::light_cosine)),
        q_specular_(config.format(FormatId::light_specular)),
        q_value_(config.format(FormatId::light_value)),
        q_inverse_(config.format(FormatId::light_inverse)),
        q_lunar_(config.format(FormatId::light_lunar)),
        q_distance_(config.format(FormatId::light_distance)),
        q_fall_(config.format(FormatId::light_fall)),
        to_viewer_(falls_to_viewer(config.light_fall_to)),
        by_square_(falls_by_square(config.light_fall)),
        is_point_(scene.light->is_point),
        middle_{Real(scene.width) * Real(0.5), Real(scene.height) * Real(0.5)},
        intervals_(1 << config.light_index_bits) {
    const Light& light = *scene.light;
    if (is_point_ && !has_points(config.light_source)) {
      throw InputError("light: stands at a point, and light.source is parallel");
    }
    if (light.lunar > 0 && !has_lunar(config)) {
      throw InputError("light: has the lunar law, and light.law is lambert");
    }
    if (light.reach > 0 && !has_light_fall(config)) {
      throw InputError("light: falls with the distance, and light.fall is none");
    }
    falls_ = light.reach > 0 && (is_point_ || to_viewer_);
    is_lunar_ = light.lunar > 0;
    const auto constant = [&](FormatId id, double x) {
      const Quantizer<Quad> q(config.format(id));
      return Quantizer<Real>(config.format(id)).value(q.raw(q(Quad(x))));
    };
    // 1 / x by a mantissa.
    const auto inverse = [&](double x) {
      const int e = octaves(x);
      const Quantizer<Quad> q(config.format(FormatId::light_scale));
      return Quantizer<Real>(config.format(FormatId::light_scale))
                 .value(q.raw(q.quotient(scalbnq(1, e), Quad(x)))) *
             pow2<Real>(-e);
    };
    if (is_point_ || falls_) per_pixel_ = inverse(scene.focal);
    if (falls_) {
      per_reach_ = inverse(light.reach) * pow2<Real>(s_exponent);
      offset_ = constant(FormatId::light_distance, light.offset);
    }
    if (is_lunar_) lunar_ = constant(FormatId::light_lunar, light.lunar);
    int down = s_exponent;
    if (!is_point_) {
      double largest = 0;
      for (const double part : light.place) largest = std::max(largest, std::fabs(part));
      down = octaves(largest);
    }
    const Quantizer<Quad> q_place(config.format(FormatId::light_position));
    Vector<Quad> place;
    for (std::size_t i = 0; i < 3; ++i) {
      place[i] = q_place(Quad(light.place[i]) * scalbnq(1, -down));
      place_[i] = q_position_.value(q_place.raw(place[i]));
    }
    if (!is_point_) {
      // Once, and its squares are longer than those of a pixel.
      const Quantizer<Quad> q(config.format(FormatId::light_direction));
      const Vector<Quad> far = unit(InverseRootUnit<Quad>(config), q, place);
      for (std::size_t i = 0; i < 3; ++i) far_[i] = q_direction_.value(q.raw(far[i]));
    }
    const Quantizer<Quad> q_share(config.format(FormatId::light_value));
    const Quad ambient = q_share(Quad(light.ambient));
    const Quad highlight = q_share(Quad(light.specular));
    const auto share = [&](Quad x) { return q_value_.value(q_share.raw(x)); };
    ambient_ = share(ambient);
    highlight_ = share(highlight);
    diffuse_ = share(q_share(1 - ambient - highlight));
    const Quantizer<Quad> q_entry(config.format(FormatId::light_specular));
    for (int j = 0; j <= intervals_; ++j) {
      table_.push_back(q_specular_.value(power_of(q_entry, j, config.light_index_bits, light.exponent)));
    }
  }

  // n: the normal, of any length; field: toward the light, where both are those of a map; x, y: pixels from
  // the left and from the top; share: what a shadow leaves, where there may be one.
  Shine<Real> operator()(const Vector<Real>& n, const std::optional<Vector<Real>>& field, Real x, Real y,
                         Real s, const std::optional<Real>& share = std::nullopt) const {
    Shine<Real> out;
    out.normal = unit(root_, q_normal_, n);
    Real fall = 1;
    out.direction = is_point_ || falls_ ? to_light(x, y, s, fall) : far_;
    if (field) out.direction = unit(root_, q_direction_, *field);
    const Vector<Real>& l = out.direction;
    out.cosine = q_cosine_(out.normal[0] * l[0] + out.normal[1] * l[1] + out.normal[2] * l[2]);
    if (!field) out.mirrored = q_cosine_(l[2] - 2 * (out.cosine * out.normal[2]));
    Real sum = 0;
    if (out.cosine > 0) {
      if (out.mirrored > 0) out.specular = power(out.mirrored);
      sum = diffuse_ * (is_lunar_ && !field ? lunar(out.cosine, out.normal[2]) : out.cosine) +
            highlight_ * out.specular;
    }
    if (share) sum = q_value_(q_value_(sum) * *share);
    out.value = falls_ ? q_value_(fall * q_value_(sum) + ambient_) : q_value_(sum + ambient_);
    return out;
  }

  const Quantizer<Real>& normal() const { return q_normal_; }
  const Quantizer<Real>& direction() const { return q_direction_; }
  const Quantizer<Real>& cosine() const { return q_cosine_; }
  const Quantizer<Real>& specular() const { return q_specular_; }
  const Quantizer<Real>& value() const { return q_value_; }

 private:
  template <class T>
  static Vector<T> unit(const InverseRootUnit<T>& root, const Quantizer<T>& q, const Vector<T>& x) {
    const T d = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    if (d == 0) return {};
    const InverseRoot<T> inverse = root(d);
    Vector<T> out;
    for (std::size_t i = 0; i < 3; ++i) {
      out[i] =
          q.product(exact_product(x[i], inverse.m).scaled(pow2<typename RealTraits<T>::Base>(-inverse.e)));
    }
    return out;
  }
  // fall: what the distance leaves of the brightness.
  Vector<Real> to_light(Real x, Real y, Real s, Real& fall) const {
    const Vector<Real> here{q_position_((x - middle_[0]) * s * per_pixel_),
                            q_position_((y - middle_[1]) * s * per_pixel_), q_position_(s)};
    const Vector<Real> from_here{place_[0] - here[0], place_[1] - here[1], place_[2] - here[2]};
    const Vector<Real> direction = is_point_ ? unit(root_, q_direction_, from_here) : far_;
    if (falls_) {
      fall =
          to_viewer_ ? fall_along(here, unit(root_, q_direction_, here)) : fall_along(from_here, direction);
    }
    return direction;
  }
  Real fall_along(const Vector<Real>& x, const Vector<Real>& unit) const {
    const Real d = q_position_(x[0] * unit[0] + x[1] * unit[1] + x[2] * unit[2]);
    const Real reached = q_distance_(d * per_reach_);
    return over(q_distance_((by_square_ ? reached * reached : reached) + offset_), Real(1), q_distance_,
                q_fall_);
  }
  Real lunar(Real cosine, Real normal_z) const {
    const Real away = normal_z < 0 ? -normal_z : Real(0);
    return over(q_lunar_(1 + lunar_ * away), cosine, q_lunar_, q_cosine_);
  }
  // x / t, on q; t a value of q_t.
  Real over(Real t, Real x, const Quantizer<Real>& q_t, const Quantizer<Real>& q) const {
    const InverseRoot<Real> root = root_(t > 0 ? t : q_t.value(1));
    return q(x * q_inverse_(root.m * root.m) * pow2<Real>(-2 * root.e));
  }
  Real power(Real cosine) const {
    const Real place = (cosine > 1 ? Real(1) : cosine) * Real(intervals_);
    Real j = floor_of(place);
    if (j > intervals_ - 1) j = intervals_ - 1;
    const auto at = static_cast<std::size_t>(to_integer(j));
    return q_specular_(table_[at] + (table_[at + 1] - table_[at]) * (place - j));
  }

  InverseRootUnit<Real> root_;
  Quantizer<Real> q_position_, q_normal_, q_direction_, q_cosine_, q_specular_, q_value_;
  Quantizer<Real> q_inverse_, q_lunar_, q_distance_, q_fall_;
  bool to_viewer_, by_square_;
  bool is_point_;
  bool falls_ = false, is_lunar_ = false;
  std::array<Real, 2> middle_;
  int intervals_;
  Real per_pixel_ = 0, per_reach_ = 0, offset_ = 0, lunar_ = 0;
  Vector<Real> place_{}, far_{};
  Real ambient_ = 0, highlight_ = 0, diffuse_ = 0;
  std::vector<Real> table_;
};

// Of fragments.
template <class Real>
class FragmentLight {
 public:
  FragmentLight(const Config& config, const Constants& constants, const Scene& scene)
      : at_pixels_(lights_pixels(config.light)),
        light_(config, constants.s_exponent, scene),
        takes_map_(has_relief(config)),
        takes_shadow_(has_light_shadow(config)),
        has_second_(has_second_coordinates(config.second_coordinates)),
        q_given_(config.format(FormatId::normal_value)),
        q_s_(config.format(FormatId::distance_s)),
        q_color_(config.format(FormatId::texture_color)),
        q_mix_(config.format(FormatId::texture_mix)),
        q_share_(config.format(FormatId::texture_alpha)),
        q_uv_(config.format(FormatId::span_uv)),
        q_relief_(config.format(FormatId::relief_value)),
        normal_(place_of(constants, LineId::nx)),
        value_(place_of(constants, LineId::light)),
        relief_(place_of(constants, LineId::lx)),
        second_(place_of(constants, LineId::u2)) {}

  void operator()(std::span<const FragmentRecord* const> fragments,
                  std::span<const TextureRecord* const> textures,
                  std::span<const DistanceRecord* const> distances,
                  std::span<const FragmentChannelRecord* const> channels, const DrawState& state,
                  std::vector<LightRecord>& out) const {
    const bool by_map = takes_map_ && has_relief(state);
    const bool in_shadow = takes_shadow_ && shades_light(state);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      LightRecord& record = out.emplace_back();
      record.triangle = fragments[i]->triangle;
      record.x = fragments[i]->x;
      record.y = fragments[i]->y;
      if (at_pixels_) {
        const Real s = distances.empty() ? Real(0) : q_s_.value(distances[i]->s);
        std::optional<Real> share;
        if (in_shadow) share = q_share_.quotient(q_mix_.value(textures[i]->texel_r), Real(255));
        set_brightness(by_map ? of_map(*fragments[i], *textures[i], channels[i]) : of_channels(channels[i]),
                       s, share, record);
      } else {
        record.value = channels[i][value_].w;
      }
      const Real brightness = light_.value().value(record.value);
      const auto times = [&](std::int64_t c) {
        return q_color_.raw(q_color_.product(q_color_.value(c), brightness));
      };
      record.r = times(textures[i]->r);
      record.g = times(textures[i]->g);
      record.b = times(textures[i]->b);
    }
  }

 private:
  // What faces what.
  struct Faced {
    Vector<Real> normal;
    std::optional<Vector<Real>> to_light;  // in a map's field; none: as the view has it
  };
  Faced of_channels(const FragmentChannelRecord* channels) const {
    const FragmentChannelRecord* const n = channels + normal_;
    return {{q_given_.value(n[0].w), q_given_.value(n[1].w), q_given_.value(n[2].w)}, std::nullopt};
  }
  Faced of_map(const FragmentRecord& fragment, const TextureRecord& texture,
               const FragmentChannelRecord* channels) const {
    const auto part = [&](std::int64_t code) { return 2 * q_mix_.value(code) - 255; };
    const FragmentChannelRecord* const l = channels + relief_;
    const Real u = q_uv_.value(has_second_ ? channels[second_].w : fragment.u);
    const Real v = q_uv_.value(has_second_ ? channels[second_ + 1].w : fragment.v);
    return {{part(texture.texel_r), part(texture.texel_g), part(texture.texel_b)},
            Vector<Real>{q_relief_.value(l[0].w) - u, q_relief_.value(l[1].w) - v, q_relief_.value(l[2].w)}};
  }

  void set_brightness(const Faced& faced, Real s, const std::optional<Real>& share, LightRecord& out) const {
    const Real half(0.5);
    const Shine<Real> shine =
        light_(faced.normal, faced.to_light, Real(out.x) + half, Real(out.y) + half, s, share);
    out.nx = light_.normal().raw(shine.normal[0]);
    out.ny = light_.normal().raw(shine.normal[1]);
    out.nz = light_.normal().raw(shine.normal[2]);
    out.lx = light_.direction().raw(shine.direction[0]);
    out.ly = light_.direction().raw(shine.direction[1]);
    out.lz = light_.direction().raw(shine.direction[2]);
    out.cosine = light_.cosine().raw(shine.cosine);
    out.mirrored = light_.cosine().raw(shine.mirrored);
    out.specular = light_.specular().raw(shine.specular);
    out.value = light_.value().raw(shine.value);
  }

  bool at_pixels_;
  Lighting<Real> light_;
  bool takes_map_, takes_shadow_, has_second_;
  Quantizer<Real> q_given_, q_s_, q_color_, q_mix_, q_share_, q_uv_, q_relief_;
  // In front of which channels those of light stand.
  std::ptrdiff_t normal_, value_, relief_, second_;
};

}  // namespace

LightStage make_light(Arithmetic arithmetic, const Config& config, const Constants& constants,
                      const Scene& scene) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> LightStage { return FragmentLight<Real>(config, constants, scene); });
}

VertexLight make_vertex_light(const Config& config, int s_exponent, const Scene& scene) {
  const auto light = std::make_shared<const Lighting<Quad>>(config, s_exponent, scene);
  const Quantizer<Quad> q_xy(config.coordinate_format()), q_s(config.format(FormatId::setup_s)),
      q_n(config.format(FormatId::normal_value));
  return [=](const Vertex& v, const Quantizer<Quad>& q) {
    const Vector<Quad> n{q_n(Quad(v.nx)), q_n(Quad(v.ny)), q_n(Quad(v.nz))};
    const Quad s = q_s(Quad(v.s) * scalbnq(1, -s_exponent));
    return q.raw(q((*light)(n, std::nullopt, q_xy(Quad(v.x)), q_xy(Quad(v.y)), s).value));
  };
}

}  // namespace bitspan::golden
