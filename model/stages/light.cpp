// SPDX-License-Identifier: Apache-2.0
#include "model/stages/light.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/modes.hpp"
#include "model/numeric/big_integer.hpp"
#include "model/numeric/from_double.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/light-inl.hpp"

namespace bitspan::model {
namespace {

namespace text = HWY_NAMESPACE;

// Q of (j 2^-bits)^power, 0 <= j <= 2^bits.
template <class Watch>
std::int64_t power_of(std::int64_t j, int bits, int power, const Register& r, Watch watch) {
  BigInteger x;
  mpz_ui_pow_ui(x.get(), static_cast<unsigned long>(j), static_cast<unsigned long>(power));
  // As many places as the rounding looks at, and whether there is more.
  const int fraction = std::max(r.fraction, 0) + 1;
  const int down = bits * power - fraction;
  bool sticky = false;
  if (down > 0) {
    sticky = mpz_divisible_2exp_p(x.get(), static_cast<mp_bitcnt_t>(down)) == 0;
    mpz_fdiv_q_2exp(x.get(), x.get(), static_cast<mp_bitcnt_t>(down));
  } else {
    x.shift_up(static_cast<mp_bitcnt_t>(-down));
  }
  BigInteger high;
  mpz_fdiv_q_2exp(high.get(), x.get(), 32);
  const int128 floor = int128{mpz_get_ui(high.get())} << 32 | (mpz_get_ui(x.get()) & 0xFFFFFFFF);
  return quantize(floor << 1 | (sticky ? 1 : 0), fraction + 1, r, watch);
}

}  // namespace

void set_light(LightStage& stage, const DrawState& state) {
  stage.has_map = stage.is_on && stage.takes_map && has_relief(state);
  stage.has_shadow = stage.is_on && stage.takes_shadow && shades_light(state);
}

template <class Watch>
LightStage prepare_light(const Config& config, const Constants& constants, const Scene& scene, Watch watch) {
  LightStage s;
  s.at_pixels = lights_pixels(config.light);
  s.at_faces = lights_faces(config.light);
  s.value = make_register(config, FormatId::light_value);
  s.color = make_register(config, FormatId::texture_color);
  if (!has_light(config.light) || !scene.light) return s;
  const Light& light = *scene.light;
  const auto refuse = [&](const char* what, const char* key, const char* has, const char* expected) {
    throw InputError(fmt::format("scene '{}': its light {}, and {} is {}; expected {}", scene.name, what, key,
                                 has, expected));
  };
  if (light.is_point && !has_points(config.light_source)) {
    refuse("stands at a point", "light.source", "parallel", "point, or a light with a direction");
  }
  if (light.lunar > 0 && !has_lunar(config)) {
    refuse("has the lunar law", "light.law", "lambert", "lunar, or a light without it");
  }
  if (light.reach > 0 && !has_light_fall(config)) {
    refuse("falls with the distance", "light.fall", "none", "first or second, or a light without a reach");
  }
  s.is_on = true;
  s.is_point = light.is_point;
  s.is_lunar = light.lunar > 0;
  s.to_viewer = falls_to_viewer(config.light_fall_to);
  s.falls = light.reach > 0 && (light.is_point || s.to_viewer);
  s.by_square = falls_by_square(config.light_fall);
  s.takes_place = light.is_point || s.falls;
  s.root = ReciprocalRoot(config);
  s.given_normal = make_register(config, FormatId::normal_value);
  s.position = make_register(config, FormatId::light_position);
  s.normal = make_register(config, FormatId::light_normal);
  s.direction = make_register(config, FormatId::light_direction);
  s.cosine = make_register(config, FormatId::light_cosine);
  s.specular = make_register(config, FormatId::light_specular);
  s.takes_map = has_relief(config);
  s.takes_shadow = has_light_shadow(config);
  s.share = make_register(config, FormatId::texture_alpha);
  s.relief = make_register(config, FormatId::relief_value);
  s.uv = make_register(config, FormatId::span_uv);
  s.texel = make_register(config, FormatId::texture_mix);
  s.inverse = make_register(config, FormatId::light_inverse);
  s.lunar = make_register(config, FormatId::light_lunar);
  s.distance = make_register(config, FormatId::light_distance);
  s.fall = make_register(config, FormatId::light_fall);
  s.coordinate = make_register(config.coordinate_format(), RegisterId::coordinate);
  s.vertex_s = make_register(config, FormatId::setup_s);
  s.pixel_s = make_register(config, FormatId::distance_s);
  s.exponent = constants.exponent;
  s.width = scene.width;
  s.height = scene.height;
  const Register scale = make_register(config, FormatId::light_scale);
  const auto inverse_of = [&](double x) {
    const int octaves = ceil_log2(x);
    return scaled(value_of(quantize_ratio({1, -octaves}, exact_of(x), scale, watch), scale), octaves);
  };
  int down = s.exponent;
  if (s.takes_place) {
    s.scale = inverse_of(scene.focal);
    // Halves of a pixel from the middle are fewer than the pixels of a side.
    const int across = bit_length(static_cast<std::uint64_t>(std::max(scene.width, scene.height)));
    const int bits = across + bit_length(static_cast<uint128>(s.scale.raw)) + s.pixel_s.word;
    const int up = s.position.fraction - (1 + s.scale.fraction + s.pixel_s.fraction);
    s.places_fit_int64 = bits + std::max(up, 0) <= 61;
  }
  if (!light.is_point) {
    const auto size = [](double x) { return std::abs(x); };
    down = ceil_log2(size(*std::ranges::max_element(light.place, {}, size)));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    s.place[i] = quantize(scaled(exact_of(light.place[i]), down), s.position, watch);
  }
  if (!light.is_point) {
    s.far_direction =
        text::of_length_1<int128, int128>(s.root, s.place, s.position.fraction, s.direction, watch);
  }
  s.ambient = quantize(exact_of(light.ambient), s.value, watch);
  s.highlight = quantize(exact_of(light.specular), s.value, watch);
  s.diffuse =
      quantize(Exact{1, 0} - value_of(s.ambient, s.value) - value_of(s.highlight, s.value), s.value, watch);
  if (s.is_lunar) s.lunar_k = quantize(exact_of(light.lunar), s.lunar, watch);
  if (s.falls) {
    s.per_reach = scaled(inverse_of(light.reach), -s.exponent);
    s.offset = quantize(exact_of(light.offset), s.distance, watch);
  }
  s.index_bits = config.light_index_bits;
  for (std::int64_t j = 0; j <= std::int64_t{1} << s.index_bits; ++j) {
    s.table.push_back(power_of(j, s.index_bits, light.exponent, s.specular, watch));
  }
  return s;
}

template <class Watch>
std::int64_t light_at(const LightStage& stage, const Vertex& v, const Register& vertex, Watch watch) {
  const auto at = [&](double w) { return quantize(exact_of(w), stage.coordinate, watch); };
  const std::int64_t s = quantize(scaled(exact_of(v.s), stage.exponent), stage.vertex_s, watch);
  const std::int64_t x = at(v.x);
  const std::int64_t y = at(v.y);
  const auto toward = text::toward_light<int128, int128, int128>(stage, x, y, stage.coordinate.fraction, s,
                                                                 stage.vertex_s.fraction, watch);
  const auto normal = [&](double w) { return quantize(exact_of(w), stage.given_normal, watch); };
  const auto shone = text::shine<int128, int128>(stage, {normal(v.nx), normal(v.ny), normal(v.nz)},
                                                 stage.given_normal.fraction, toward, watch);
  return quantize(value_of(shone.value, stage.value), vertex, watch);
}

template <class Watch>
void brighten(const LightStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
              const LightChannels& channels, const TextureRecord& texture, LightRecord& out, Watch watch) {
  out = {};
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  if (stage.at_pixels) {
    auto toward = text::toward_light<int128, int128, int128>(stage, 2 * fragment.x + 1, 2 * fragment.y + 1, 1,
                                                             distance.s, stage.pixel_s.fraction, watch);
    text::ShineOf<std::int64_t> shone;
    if (stage.has_shadow) {
      toward.share = quantize_ratio(texture.texel_r, 255, -stage.texel.fraction, stage.share, watch);
    }
    if (stage.has_map) {
      toward.direction = text::direction_in_field<int128, int128>(stage, channels.place, channels.at[0],
                                                                  channels.at[1], watch);
      const text::VectorOf<std::int64_t> texel{texture.texel_r, texture.texel_g, texture.texel_b};
      shone = text::shine<int128, int128>(stage, text::normal_of(stage, texel), stage.texel.fraction, toward,
                                          watch);
    } else {
      shone = text::shine<int128, int128>(stage, channels.normal, stage.given_normal.fraction, toward, watch);
    }
    out.nx = shone.normal[0];
    out.ny = shone.normal[1];
    out.nz = shone.normal[2];
    out.lx = toward.direction[0];
    out.ly = toward.direction[1];
    out.lz = toward.direction[2];
    out.cosine = shone.cosine;
    out.mirrored = shone.mirrored;
    out.specular = shone.specular;
    out.value = shone.value;
  } else {
    out.value = channels.value;
  }
}

template <class Watch>
void light(const LightStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
           const LightChannels& channels, const TextureRecord& texture, LightRecord& out, Watch watch) {
  brighten(stage, fragment, distance, channels, texture, out, watch);
  const auto times = [&](std::int64_t c) { return text::lit<int128>(stage, c, out.value, watch); };
  out.r = times(texture.r);
  out.g = times(texture.g);
  out.b = times(texture.b);
}

template LightStage prepare_light(const Config&, const Constants&, const Scene&, NoObserve);
template LightStage prepare_light(const Config&, const Constants&, const Scene&, Observe);
template std::int64_t light_at(const LightStage&, const Vertex&, const Register&, NoObserve);
template std::int64_t light_at(const LightStage&, const Vertex&, const Register&, Observe);
template void brighten(const LightStage&, const FragmentRecord&, const DistanceRecord&, const LightChannels&,
                       const TextureRecord&, LightRecord&, NoObserve);
template void light(const LightStage&, const FragmentRecord&, const DistanceRecord&, const LightChannels&,
                    const TextureRecord&, LightRecord&, NoObserve);
template void light(const LightStage&, const FragmentRecord&, const DistanceRecord&, const LightChannels&,
                    const TextureRecord&, LightRecord&, Observe);

}  // namespace bitspan::model
