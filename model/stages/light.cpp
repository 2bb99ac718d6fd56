// SPDX-License-Identifier: Apache-2.0
#include "model/stages/light.hpp"

#include <algorithm>
#include <cmath>

#include "config/modes.hpp"
#include "model/numeric/big_integer.hpp"
#include "model/numeric/from_double.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/light-inl.hpp"

namespace bitspan::model {
namespace {

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

// X / |X|; 0 where X is.
template <class Watch>
std::array<std::int64_t, 3> of_length_1(const ReciprocalRoot& root, const std::array<Exact, 3>& x,
                                        const Register& r, Watch watch) {
  const Exact d = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
  if (d.raw == 0) return {};
  const auto [m, e] = reciprocal_root(root, d, watch);
  const Exact by = scaled(value_of(m, root.output), e);
  return {quantize(x[0] * by, r, watch), quantize(x[1] * by, r, watch), quantize(x[2] * by, r, watch)};
}

// The direction from a point of the view to the light; x, y: pixels from the left and from the top.
template <class Watch>
std::array<std::int64_t, 3> direction_from(const LightStage& stage, Exact x, Exact y, Exact s, Watch watch) {
  if (!stage.is_point) return stage.far_direction;
  const Exact per_pixel = s * stage.scale;
  const auto from_here = [&](Exact to, Exact here) {
    return to - value_of(quantize(here, stage.position, watch), stage.position);
  };
  return of_length_1(
      stage.root,
      {from_here(stage.place[0], (x - stage.middle_x) * per_pixel),
       from_here(stage.place[1], (y - stage.middle_y) * per_pixel), from_here(stage.place[2], s)},
      stage.direction, watch);
}

// The power of a cosine, which is above 0.
template <class Watch>
std::int64_t highlight_of(const LightStage& stage, std::int64_t mirrored, Watch watch) {
  const Exact one{1, 0};
  const Exact cosine = value_of(mirrored, stage.cosine);
  const Exact g = sign_of(cosine - one) > 0 ? one : cosine;
  const Exact place = scaled(g, -stage.index_bits);
  const std::int64_t last = (std::int64_t{1} << stage.index_bits) - 1;
  const std::int64_t j = std::min(last, static_cast<std::int64_t>(floor_of(place)));
  const auto at = stage.table.begin() + j;
  const Exact low = value_of(at[0], stage.specular);
  const Exact rise = value_of(at[1], stage.specular) - low;
  return quantize(low + rise * (place - Exact{j, 0}), stage.specular, watch);
}

struct Shine {
  std::array<std::int64_t, 3> normal{}, direction{};
  std::int64_t cosine = 0, mirrored = 0, specular = 0, value = 0;
};
// n: raw, normal.value.
template <class Watch>
Shine shine(const LightStage& stage, const std::array<std::int64_t, 3>& n,
            const std::array<std::int64_t, 3>& direction, Watch watch) {
  Shine out;
  out.direction = direction;
  const auto given = [&](std::size_t i) { return value_of(n[i], stage.given_normal); };
  out.normal = of_length_1(stage.root, {given(0), given(1), given(2)}, stage.normal, watch);
  const auto normal = [&](std::size_t i) { return value_of(out.normal[i], stage.normal); };
  const auto to_light = [&](std::size_t i) { return value_of(direction[i], stage.direction); };
  out.cosine = quantize(normal(0) * to_light(0) + normal(1) * to_light(1) + normal(2) * to_light(2),
                        stage.cosine, watch);
  const Exact cosine = value_of(out.cosine, stage.cosine);
  // The viewer is at (0, 0, -1).
  out.mirrored = quantize(to_light(2) - scaled(cosine * normal(2), -1), stage.cosine, watch);
  const auto share = [&](std::int64_t raw) { return value_of(raw, stage.value); };
  Exact sum = share(stage.ambient);
  if (out.cosine > 0) {
    if (out.mirrored > 0) out.specular = highlight_of(stage, out.mirrored, watch);
    sum =
        sum + share(stage.diffuse) * cosine + share(stage.highlight) * value_of(out.specular, stage.specular);
  }
  out.value = quantize(sum, stage.value, watch);
  return out;
}

}  // namespace

template <class Watch>
LightStage prepare_light(const Config& config, const Constants& constants, const Scene& scene, Watch watch) {
  LightStage s;
  s.at_pixels = lights_pixels(config.light);
  s.at_faces = lights_faces(config.light);
  s.value = make_register(config, FormatId::light_value);
  s.color = make_register(config, FormatId::texture_color);
  if (!has_light(config.light) || !scene.light) return s;
  const Light& light = *scene.light;
  if (light.is_point && !has_points(config.light_source)) {
    throw InputError("scene '" + scene.name +
                     "': its light stands at a point, and light.source is parallel; expected point, or a "
                     "light with a direction");
  }
  s.is_on = true;
  s.is_point = light.is_point;
  s.root = ReciprocalRoot(config);
  s.given_normal = make_register(config, FormatId::normal_value);
  s.position = make_register(config, FormatId::light_position);
  s.normal = make_register(config, FormatId::light_normal);
  s.direction = make_register(config, FormatId::light_direction);
  s.cosine = make_register(config, FormatId::light_cosine);
  s.specular = make_register(config, FormatId::light_specular);
  s.coordinate = make_register(config.coordinate_format(), RegisterId::coordinate);
  s.vertex_s = make_register(config, FormatId::setup_s);
  s.pixel_s = make_register(config, FormatId::distance_s);
  s.exponent = constants.exponent;
  s.middle_x = {scene.width, 1};
  s.middle_y = {scene.height, 1};
  int down = s.exponent;
  if (light.is_point) {
    const int octaves = ceil_log2(scene.focal);
    const Register r = make_register(config, FormatId::light_scale);
    s.scale = scaled(value_of(quantize_ratio({1, -octaves}, exact_of(scene.focal), r, watch), r), octaves);
  } else {
    const auto size = [](double x) { return std::abs(x); };
    down = ceil_log2(size(*std::ranges::max_element(light.place, {}, size)));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    s.place[i] = value_of(quantize(scaled(exact_of(light.place[i]), down), s.position, watch), s.position);
  }
  if (!light.is_point) s.far_direction = of_length_1(s.root, s.place, s.direction, watch);
  s.ambient = quantize(exact_of(light.ambient), s.value, watch);
  s.highlight = quantize(exact_of(light.specular), s.value, watch);
  s.diffuse =
      quantize(Exact{1, 0} - value_of(s.ambient, s.value) - value_of(s.highlight, s.value), s.value, watch);
  s.index_bits = config.light_index_bits;
  for (std::int64_t j = 0; j <= std::int64_t{1} << s.index_bits; ++j) {
    s.table.push_back(power_of(j, s.index_bits, light.exponent, s.specular, watch));
  }
  return s;
}

template <class Watch>
std::int64_t light_at(const LightStage& stage, const Vertex& v, const Register& vertex, Watch watch) {
  const auto at = [&](double w, const Register& r) { return value_of(quantize(exact_of(w), r, watch), r); };
  const Exact s =
      value_of(quantize(scaled(exact_of(v.s), stage.exponent), stage.vertex_s, watch), stage.vertex_s);
  const auto direction =
      direction_from(stage, at(v.x, stage.coordinate), at(v.y, stage.coordinate), s, watch);
  const auto normal = [&](double w) { return quantize(exact_of(w), stage.given_normal, watch); };
  const Shine shone = shine(stage, {normal(v.nx), normal(v.ny), normal(v.nz)}, direction, watch);
  return quantize(value_of(shone.value, stage.value), vertex, watch);
}

template <class Watch>
void brighten(const LightStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
              const LightChannels& channels, LightRecord& out, Watch watch) {
  out = {};
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  if (stage.at_pixels) {
    const Exact half{1, 1};
    const auto direction = direction_from(stage, Exact{fragment.x, 0} + half, Exact{fragment.y, 0} + half,
                                          value_of(distance.s, stage.pixel_s), watch);
    const Shine shone = shine(stage, channels.normal, direction, watch);
    out.nx = shone.normal[0];
    out.ny = shone.normal[1];
    out.nz = shone.normal[2];
    out.lx = shone.direction[0];
    out.ly = shone.direction[1];
    out.lz = shone.direction[2];
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
  brighten(stage, fragment, distance, channels, out, watch);
  const auto times = [&](std::int64_t c) { return HWY_NAMESPACE::lit<int128>(stage, c, out.value, watch); };
  out.r = times(texture.r);
  out.g = times(texture.g);
  out.b = times(texture.b);
}

template LightStage prepare_light(const Config&, const Constants&, const Scene&, NoObserve);
template LightStage prepare_light(const Config&, const Constants&, const Scene&, Observe);
template std::int64_t light_at(const LightStage&, const Vertex&, const Register&, NoObserve);
template std::int64_t light_at(const LightStage&, const Vertex&, const Register&, Observe);
template void brighten(const LightStage&, const FragmentRecord&, const DistanceRecord&, const LightChannels&,
                       LightRecord&, NoObserve);
template void light(const LightStage&, const FragmentRecord&, const DistanceRecord&, const LightChannels&,
                    const TextureRecord&, LightRecord&, NoObserve);
template void light(const LightStage&, const FragmentRecord&, const DistanceRecord&, const LightChannels&,
                    const TextureRecord&, LightRecord&, Observe);

}  // namespace bitspan::model
