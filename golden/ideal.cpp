// SPDX-License-Identifier: Apache-2.0
#include "golden/ideal.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include "config/modes.hpp"
#include "engine/drawn_scene.hpp"
#include "golden/blend.hpp"
#include "golden/compare.hpp"
#include "golden/lod.hpp"
#include "golden/mask.hpp"
#include "golden/merge.hpp"
#include "golden/mip_chain.hpp"
#include "golden/quantize.hpp"
#include "golden/stencil.hpp"
#include "golden/surface.hpp"
#include "golden/target.hpp"
#include "golden/texel.hpp"
#include "golden/texture_second.hpp"

namespace bitspan {

namespace {

using golden::Areas;
using golden::areas_at;
using golden::centre_of;
using golden::depth_code;
using golden::h_max;
using Corner = IdealTriangle::Corner;

// The line z at a vertex.
long double line_at(const Config& config, const Scene& scene, const Corner& corner) {
  if (corner.given.z >= 0) {
    return h_max(config) * (1 - static_cast<long double>(corner.given.z));
  }
  return depth_code(config, scene, 1 / corner.s);
}

std::array<double, 3> of_length_1(const std::array<double, 3>& x) {
  const double size = std::hypot(x[0], x[1], x[2]);
  if (size == 0) return x;
  return {x[0] / size, x[1] / size, x[2] / size};
}

// What a distance leaves of the brightness. [B9]
double fall_of(const Config& config, const Light& light, double to_light, double to_viewer) {
  const bool by_viewer = falls_to_viewer(config.light_fall_to);
  if (light.reach == 0 || (!light.is_point && !by_viewer)) return 1;
  const double d = (by_viewer ? to_viewer : to_light) / light.reach;
  return 1 / ((falls_by_square(config.light_fall) ? d * d : d) + light.offset);
}

// The light of a surface with that normal, seen at a place of the picture. [L1, L2, L3, B9, SH1]
struct Faced {
  std::array<double, 3> normal;
  std::optional<std::array<double, 3>> to_light;  // in the field of a map of normals [T15], with the normal
};
IdealLight light_on(const Config& config, const Scene& scene, const Faced& faced, double x, double y,
                    double s, double share = 1) {
  const Light& light = *scene.light;
  std::array<double, 3> to = light.place;
  const std::array here{(x - scene.width / 2.0) * s / scene.focal, (y - scene.height / 2.0) * s / scene.focal,
                        s};
  if (light.is_point) {
    for (std::size_t i = 0; i < 3; ++i) to[i] -= here[i];
  }
  IdealLight out;
  out.normal = of_length_1(faced.normal);
  out.direction = of_length_1(faced.to_light.value_or(to));
  for (std::size_t i = 0; i < 3; ++i) out.cosine += out.normal[i] * out.direction[i];
  if (!faced.to_light) out.mirrored = out.direction[2] - 2 * out.cosine * out.normal[2];
  out.value = light.ambient;
  if (out.cosine <= 0) return out;
  if (out.mirrored > 0) out.specular = std::pow(std::min(out.mirrored, 1.0), light.exponent);
  const double k = faced.to_light ? 0 : light.lunar;
  const double scattered = out.cosine / (1 + k * std::max(-out.normal[2], 0.0));
  out.value += ((1 - light.ambient - light.specular) * scattered + light.specular * out.specular) * share *
               fall_of(config, light, std::hypot(to[0], to[1], to[2]), std::hypot(here[0], here[1], s));
  return out;
}

// The brightness of a vertex, or of the first one for all.
double brightness_at(const Config& config, const Scene& scene, const IdealTriangle& t, std::size_t vertex) {
  const Corner* corner = &t.v[vertex];
  if (lights_faces(config.light)) corner = &*std::ranges::find(t.v, 0, &Corner::place);
  const auto pixels = [&](std::int64_t at) { return std::ldexp(static_cast<double>(at), -t.subpixel_bits); };
  return light_on(config, scene, {{corner->given.nx, corner->given.ny, corner->given.nz}, std::nullopt},
                  pixels(corner->x), pixels(corner->y), static_cast<double>(corner->s))
      .value;
}

IdealPoint blend(const Config& config, const Scene& scene, const IdealTriangle& t,
                 const std::array<long double, 3>& weight) {
  long double q = 0;
  long double u = 0;
  long double v = 0;
  std::array<long double, 4> c{};
  std::array<long double, 3> project{};
  std::array<long double, 2> second{};
  long double line = 0;
  const bool perspective = has_perspective_shades(config.shade_lines);
  const bool own_depth = has_own_depth(config.depth_line);
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner& corner = t.v[i];
    const long double share = weight[i] / corner.s;
    q += share;
    u += share * corner.u;
    v += share * corner.v;
    project[0] += share * corner.given.project_x;
    project[1] += share * corner.given.project_y;
    project[2] += share * corner.given.project_w;
    second[0] += share * corner.given.u2;
    second[1] += share * corner.given.v2;
    for (std::size_t j = 0; j < 4; ++j) c[j] += (perspective ? share : weight[i]) * corner.c[j];
    if (own_depth) line += weight[i] * line_at(config, scene, corner);
  }
  IdealPoint out;
  for (const GivenAttribute& attribute : given_attributes) {
    long double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += weight[i] * t.v[i].given.*attribute.member;
    out.given.*attribute.member = static_cast<double>(sum);
  }
  out.h = static_cast<double>(depth_code(config, scene, q));
  out.s = static_cast<double>(1 / q);
  out.u = static_cast<double>(u / q);
  out.v = static_cast<double>(v / q);
  for (std::size_t j = 0; j < 3; ++j) out.project[j] = static_cast<double>(project[j] / q);
  out.u2 = static_cast<double>(second[0] / q);
  out.v2 = static_cast<double>(second[1] / q);
  out.line = own_depth ? static_cast<double>(line) : out.h;
  if (scene.light && lights_vertices(config.light)) {
    out.brightness = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      out.brightness += static_cast<double>(weight[i]) * brightness_at(config, scene, t, i);
    }
  }
  for (std::size_t j = 0; j < 4; ++j) out.shade[j] = static_cast<double>(perspective ? c[j] / q : c[j]);
  return out;
}

IdealPoint point_at_centre(const Config& config, const Scene& scene, const IdealTriangle& t,
                           const Areas& areas, std::int64_t x, std::int64_t y) {
  std::array<long double, 3> weight{};
  for (std::size_t i = 0; i < 3; ++i) {
    weight[i] = static_cast<long double>(areas.part[i]) / static_cast<long double>(areas.whole);
  }
  IdealPoint out = blend(config, scene, t, weight);
  out.x = static_cast<double>(x) + 0.5;
  out.y = static_cast<double>(y) + 0.5;
  return out;
}

using Texel = std::array<double, 4>;  // colour codes, and alpha 0..1

// The depth comparison. h falls with distance, whatever the depth code is.
bool passes(DepthFunc func, double h, double stored_h) {
  const PassingDistances passing = passing_distances(func);
  if (h == stored_h) return passing.equal;
  return h > stored_h ? passing.nearer : passing.farther;
}

// A fragment's code in front of a shadow map, whose texels become white or the constant colour.
struct ShadowTest {
  DepthFunc func{};
  double z = 0;  // with its bias
  std::array<std::uint8_t, 4> constant{};
};

class Sampler {
 public:
  // state: for its chroma range; null for the second texture unit, which has no transparent texels. shadow:
  // null where texels are not compared.
  Sampler(const Config& config, const TexelLookup& by, const DrawState* state, const Texture& texture,
          const ShadowTest* shadow = nullptr)
      : config_(config), by_(by), state_(state), texture_(texture), shadow_(shadow) {}

  // Gives false where the transparent code kills the fragment.
  bool sample(double u, double v, Texel& out) const {
    const Codes nearest = at(std::floor(u), std::floor(v));
    switch (by_.filter) {
      case TextureFilter::nearest:
        out = texel(nearest);
        break;
      case TextureFilter::bilinear: {
        const double left = std::floor(u - 0.5);
        const double top = std::floor(v - 0.5);
        const double ex = u - 0.5 - left;
        const double ey = v - 0.5 - top;
        const auto visible = [&](double i, double j) {
          const Codes own = at(i, j);
          return texel(reserved(own) ? nearest : own);
        };
        const Texel v1 = visible(left, top);
        const Texel v2 = visible(left, top + 1);
        const Texel v3 = visible(left + 1, top + 1);
        const Texel v4 = visible(left + 1, top);
        for (std::size_t c = 0; c < out.size(); ++c) {
          const double v5 = v1[c] * (1 - ex) + v4[c] * ex;
          const double v6 = v2[c] * (1 - ex) + v3[c] * ex;
          out[c] = v5 * (1 - ey) + v6 * ey;
        }
        break;
      }
    }
    return !reserved(nearest);
  }

 private:
  using Codes = std::array<std::uint8_t, 4>;

  // A place below 0 or at `size` is outside.
  static double wrapped(double i, int size, TextureWrap wrap) {
    switch (wrap) {
      case TextureWrap::clamp:
        return std::clamp(i, 0.0, size - 1.0);
      case TextureWrap::border:
        return std::clamp(i, -1.0, double(size));
      case TextureWrap::mirror: {
        const double from_middle = std::fabs(std::remainder(i + 0.5, 2.0 * size));
        return std::floor(from_middle);
      }
      case TextureWrap::cyclic: {
        const double rest = std::fmod(i, size);
        return rest < 0 ? rest + size : rest;
      }
    }
    unreachable();
  }
  Codes at(double i, double j) const {
    const double column = wrapped(i, texture_.width, by_.wrap_u);
    const double row = wrapped(j, texture_.height, by_.wrap_v);
    if (column < 0 || row < 0 || column >= texture_.width || row >= texture_.height) return config_.border;
    const auto at_i = static_cast<std::int64_t>(column), at_j = static_cast<std::int64_t>(row);
    if (shadow_ == nullptr) return golden::fetch_texel(texture_, at_i, at_j);
    const double word = static_cast<double>(golden::depth_word(texture_, at_i, at_j));
    const double stored = std::floor(std::ldexp(word, config_.depth_bits - 32));
    const double sign = nearer_is_larger(config_.depth_code) ? 1 : -1;
    return passes(shadow_->func, sign * shadow_->z, sign * stored) ? Codes{255, 255, 255, 255}
                                                                   : shadow_->constant;
  }
  static Texel texel(const Codes& c) { return {double(c[0]), double(c[1]), double(c[2]), c[3] / 255.0}; }
  bool reserved(const Codes& c) const {
    if (state_ == nullptr) return false;
    if (config_.transparent &&
        std::equal(config_.transparent->begin(), config_.transparent->end(), c.begin())) {
      return true;
    }
    const std::array low{state_->chroma_low_red, state_->chroma_low_green, state_->chroma_low_blue};
    const std::array high{state_->chroma_high_red, state_->chroma_high_green, state_->chroma_high_blue};
    bool in_range = true;
    for (std::size_t i = 0; i < 3; ++i) in_range = in_range && c[i] >= low[i] && c[i] <= high[i];
    switch (state_->chroma_test) {
      case ChromaTest::none:
        return false;
      case ChromaTest::inside:
        return in_range;
      case ChromaTest::outside:
        return !in_range;
    }
    unreachable();
  }

  const Config& config_;
  TexelLookup by_;
  const DrawState* state_;
  const Texture& texture_;
  const ShadowTest* shadow_;
};

// The distance from the viewer.
double true_distance(const Scene& scene, const IdealPoint& p) {
  const double x = p.x - scene.width / 2.0;
  const double y = p.y - scene.height / 2.0;
  return p.s * std::sqrt(1 + (x * x + y * y) / (scene.focal * scene.focal));
}

double fog_factor(const Config& config, const Scene& scene, const IdealPoint& p) {
  if (!scene.fog) return 1;
  const double distance = scene.fog->distance;
  switch (config.fog) {
    case FogMode::none:
      return 1;
    case FogMode::linear:
      return std::clamp(1 - p.s / distance, 0.0, 1.0);
    case FogMode::table:
    case FogMode::distance:
      return std::exp(-true_distance(scene, p) / distance);
    case FogMode::vertex:
      if (p.given.fog >= 0) return p.given.fog;
      return std::exp(-p.s / distance);
    case FogMode::log:
      return std::exp(-p.s / distance);
  }
  unreachable();
}

// The code of h at distance s, before rounding.
double configured_code(const Config& config, const Scene& scene, double h, double s) {
  const auto z_max = static_cast<double>(h_max(config));
  switch (config.depth_code) {
    case DepthCode::inverse:
      return h;
    case DepthCode::opengl:
      return z_max - h;
    case DepthCode::float_dz:  // in front of bias and packing; h at s_max may round below 0
      return z_max - std::max(h, 0.0);
    case DepthCode::linear:
      return z_max * (s - scene.s_min) / (scene.s_max - scene.s_min);
    case DepthCode::w_float: {
      const double b = z_max * scene.s_min / (scene.s_max - scene.s_min);
      if (h + b <= 0) return z_max;
      const double place = std::ldexp(h + b, -std::ilogb(h + b));  // 1 .. 2
      int top = std::ilogb(z_max + b);
      if (std::ldexp(1, top) < z_max + b) ++top;
      const double octave = top - 1 - std::ilogb(h + b);
      return std::clamp(std::ldexp(octave + 2 - place, config.depth_bits - w_float_exponent_bits), 0.0,
                        z_max);
    }
  }
  unreachable();
}

// The code with the bias, within the register.
double biased(const Config& config, double z, std::int64_t bias) {
  if (bias == 0) return z;
  return std::clamp(z + static_cast<double>(bias), 0.0, static_cast<double>(h_max(config)));
}

// How much a value that is linear on the screen rises per pixel along x and along y, by the three vertices.
struct ScreenPlane {
  std::array<long double, 2> x, y;  // from vertex 0
  long double area;

  explicit ScreenPlane(const IdealTriangle& t) {
    const long double pixel = std::ldexp(1.0L, t.subpixel_bits);
    for (std::size_t i = 0; i < 2; ++i) {
      x[i] = static_cast<long double>(t.v[i + 1].x - t.v[0].x) / pixel;
      y[i] = static_cast<long double>(t.v[i + 1].y - t.v[0].y) / pixel;
    }
    area = x[0] * y[1] - x[1] * y[0];
  }
  std::array<long double, 2> gradient(long double w0, long double w1, long double w2) const {
    return {((w1 - w0) * y[1] - (w2 - w0) * y[0]) / area, ((w2 - w0) * x[0] - (w1 - w0) * x[1]) / area};
  }
};

// float_dz: the logarithm of |dz/dx| + |dz/dy|, rounded up; 0 for the other codes.
int log2_of_dz(const Config& config, const Scene& scene, const IdealTriangle& t) {
  if (!has_dz(config.depth_code)) return 0;
  const auto h = [&](std::size_t i) { return depth_code(config, scene, 1 / t.v[i].s); };
  const auto [along_x, along_y] = ScreenPlane(t).gradient(h(0), h(1), h(2));
  const long double d = std::abs(along_x) + std::abs(along_y);
  int log2 = 0;
  while (log2 < largest_dz && std::ldexp(1.0L, log2) < d) ++log2;
  return log2;
}

// float_dz: z as a number of 3 bits of exponent, without the mantissa's rounding.
double floating_z(const Config& config, double z) {
  const double whole = std::ldexp(1.0, config.depth_bits);
  const double mantissas = std::ldexp(1.0, config.depth_bits - dz_bits - float_dz_exponent_bits);
  double exponent = 0;
  double start = 0;
  double length = whole / 2;
  while (exponent < (1 << float_dz_exponent_bits) - 1 && z >= start + length) {
    start += length;
    ++exponent;
    if (exponent < (1 << float_dz_exponent_bits) - 1) length /= 2;
  }
  return mantissas * (exponent + (z - start) / length);
}

// The word of float_dz as the dump has it: z to the nearest code.
double rounded_word(const Config& config, double z, int dz) {
  const double largest = std::ldexp(1.0, config.depth_bits - dz_bits) - 1;
  const double code = std::clamp(std::floor(floating_z(config, z) + 0.5), 0.0, largest);
  return std::ldexp(code, dz_bits) + dz;
}

// The largest derivative of u and v along x and y, texels per pixel; or the largest difference to the pixels
// right and below.
double largest_derivative(const IdealTriangle& t, const IdealPoint& point, bool to_neighbours) {
  const auto& v = t.v;
  const ScreenPlane plane(t);
  const auto q = plane.gradient(1 / v[0].s, 1 / v[1].s, 1 / v[2].s);
  long double most = 0;
  for (const bool down : {false, true}) {
    const auto over_s = [down](const Corner& c) { return (down ? c.v : c.u) / c.s; };
    const auto g = plane.gradient(over_s(v[0]), over_s(v[1]), over_s(v[2]));
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const long double w = down ? point.v : point.u;
      // Beyond the horizon a neighbour has no distance.
      const long double next = 1 / static_cast<long double>(point.s) + (to_neighbours ? q[axis] : 0);
      most = std::max(most, std::abs((g[axis] - w * q[axis]) / std::max(next, 0x1p-60L)));
    }
  }
  return static_cast<double>(most);
}

double level_of_zone(const Config& config, const Scene& scene, double s, int levels) {
  int exponent = 0;
  if (std::frexp(scene.s_max, &exponent) == 0.5) --exponent;  // s_max <= 2^exponent
  const double first = std::ldexp(config.lod_first, exponent - 16);
  int zone = 0;
  while (zone < levels - 1 && s >= std::ldexp(first, zone + 1)) ++zone;
  if (zone == levels - 1) return zone;
  return zone + std::max(s / std::ldexp(first, zone) - 1, 0.0);
}

// Before it is held in the chain.
double level_of_detail(const Config& config, const DrawState& state, const Scene& scene,
                       const IdealTriangle& t, const IdealPoint& point, int levels) {
  double level = state.texture_lod_bias / 16.0;
  switch (config.lod) {
    case LodMode::none:
      break;
    case LodMode::zone_s:
      level += level_of_zone(config, scene, point.s, levels);
      break;
    case LodMode::zone_d:
      level += level_of_zone(config, scene, true_distance(scene, point), levels);
      break;
    case LodMode::gradient:
    case LodMode::finite:
      level += std::log2(std::max(largest_derivative(t, point, has_neighbours(config.lod)), 0x1p-60));
      break;
  }
  return level;
}

// From the levels of a chain; gives false where the transparent code kills the fragment.
bool sample_levels(const Config& config, const TexelLookup& by, const DrawState* state,
                   const std::vector<Texture>& levels, double level, double u, double v, Texel& out) {
  const auto sample = [&](double whole, Texel& to) {
    const Texture& image = levels[static_cast<std::size_t>(whole)];
    return Sampler(config, by, state, image)
        .sample(u * image.width / levels[0].width, v * image.height / levels[0].height, to);
  };
  if (!mixes_levels(config.mip)) return sample(std::floor(level + 0.5), out);
  const double whole = std::floor(level);
  const double f = level - whole;
  const bool lives = sample(whole, out);
  if (f == 0) return lives;
  Texel coarser{};
  sample(whole + 1, coarser);
  for (std::size_t c = 0; c < out.size(); ++c) out[c] = out[c] * (1 - f) + coarser[c] * f;
  return lives;
}

// How a texture unit looks texels up.
struct Unit {
  TexelLookup by, magnified;
  LevelRange range;
};
Unit first_unit(const DrawState& s) { return {first_lookup(s), first_magnified(s), first_levels(s)}; }
Unit second_unit(const DrawState& s) { return {second_lookup(s), second_magnified(s), second_levels(s)}; }

// From texture `index` of the scene, or from its chain, in which lambda is held; levels: null where they are
// not at hand. Gives false where the transparent code kills the fragment.
bool sample_texture(const Config& config, const Unit& unit, const DrawState* state, const Scene& scene,
                    std::size_t index, const golden::SceneLevels* levels, double lambda, double u, double v,
                    Texel& out) {
  const Texture& texture = scene.textures.at(index);
  if (!has_lod(config)) return Sampler(config, unit.by, state, texture).sample(u, v, out);
  const std::vector<Texture> own = levels == nullptr ? golden::mip_levels(texture) : std::vector<Texture>();
  const std::vector<Texture>& chain = levels == nullptr ? own : levels->at(index);
  const double last = static_cast<double>(chain.size()) - 1;
  const double held = golden::within(unit.range, lambda);
  return sample_levels(config, held > 0 ? unit.by : unit.magnified, state, chain, std::min(held, last), u, v,
                       out);
}

// The second texture unit, at its place in the projector's texture.
Texel projected_texel(const Config& config, const DrawState& state, const Scene& scene,
                      const IdealPoint& point) {
  const Texture& texture = scene.textures.at(static_cast<std::size_t>(state.texture1));
  const auto code = [](std::int32_t k) { return static_cast<std::uint8_t>(k); };
  ShadowTest shadow{
      .func = state.texture1_func,
      .constant = {code(state.texture1_red), code(state.texture1_green), code(state.texture1_blue), 255}};
  const auto place = ideal_projection(config, scene, point);
  if (!place || place->s < 0 || place->t < 0 || place->s >= texture.width || place->t >= texture.height) {
    if (state.texture1_outside == ProjectOutside::lit) return {255, 255, 255, 1};
    return {double(shadow.constant[0]), double(shadow.constant[1]), double(shadow.constant[2]), 1};
  }
  const auto z_max = static_cast<double>(h_max(config));
  shadow.z = std::clamp(place->z + state.texture1_bias, 0.0, z_max);
  const bool compares = state.texture1_compare && texture.format == TexelFormat::depth;
  Texel out{};
  Sampler(config, second_lookup(state), nullptr, texture, compares ? &shadow : nullptr)
      .sample(place->s, place->t, out);
  return out;
}

// The second texture unit.
void combine(const Config& config, const DrawState& state, const Scene& scene,
             const golden::SceneLevels* levels, IdealFragment& out) {
  Texel texel{};
  if (is_projected(state)) {
    texel = projected_texel(config, state, scene, out.point);
  } else {
    const double lambda = out.lambda + (state.texture1_lod_bias - state.texture_lod_bias) / 16.0;
    const IdealPoint& p = out.point;
    const bool own = has_second_coordinates(config.second_coordinates);
    sample_texture(config, second_unit(state), nullptr, scene, static_cast<std::size_t>(state.texture1),
                   levels, lambda, own ? p.u2 : p.u, own ? p.v2 : p.v, texel);
  }
  out.second_texel = {texel[0], texel[1], texel[2]};
  const std::array<int, 3> constants{state.texture1_red, state.texture1_green, state.texture1_blue};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto sum = golden::combined_color<double>(state.texture1_op, out.color[c], texel[c], texel[c] / 255,
                                                    texel[3], constants[c], 1 << state.texture1_scale);
    out.color[c] = sum.a * sum.by_a + sum.b * sum.by_b;
    if (sum.saturates) out.color[c] = std::min(out.color[c], 255.0);
  }
  if (golden::takes_texel_alpha(state.texture1_op)) {
    out.alpha = texel[3];
  } else if (!golden::keeps_first_alpha(state.texture1_op)) {
    out.alpha *= texel[3];
  }
}

// levels: null where they are not at hand.
IdealFragment shade(const Config& config, const DrawState& state, const Scene& scene, const IdealTriangle& t,
                    const IdealPoint& point, const golden::SceneLevels* levels) {
  IdealFragment out;
  out.point = point;
  out.z = configured_code(config, scene, point.line, point.s);
  out.texel = {255, 255, 255, 1};
  if (t.texture >= 0) {
    const auto index = static_cast<std::size_t>(t.texture);
    const Texture& texture = scene.textures.at(index);
    const auto side = static_cast<unsigned>(std::max(texture.width, texture.height));
    if (has_lod(config))
      out.lambda = level_of_detail(config, state, scene, t, point, static_cast<int>(std::bit_width(side)));
    out.killed = !sample_texture(config, first_unit(state), &state, scene, index, levels, out.lambda, point.u,
                                 point.v, out.texel);
  } else if (has_lod(config) && has_second_texture(state)) {
    out.lambda = level_of_detail(config, state, scene, t, point, 1);
  }
  out.alpha = out.texel[3] * point.shade[3];
  for (std::size_t c = 0; c < 3; ++c) out.color[c] = out.texel[c] * point.shade[c];
  if (has_second_texture(state)) combine(config, state, scene, levels, out);
  out.killed = out.killed || (golden::kills_zero(state) && out.alpha == 0);
  if (scene.light && lights_pixels(config.light)) {
    const Attributes& given = point.given;
    Faced faced{{given.nx, given.ny, given.nz}, std::nullopt};
    if (has_relief(config) && has_relief(state)) {
      const bool own = has_second_coordinates(config.second_coordinates);
      for (std::size_t i = 0; i < 3; ++i) faced.normal[i] = 2 * out.second_texel[i] - 255;
      faced.to_light = {given.lx - (own ? point.u2 : point.u), given.ly - (own ? point.v2 : point.v),
                        given.lz};
    }
    const bool in_shadow = has_light_shadow(config) && shades_light(state);
    out.light =
        light_on(config, scene, faced, point.x, point.y, point.s, in_shadow ? out.second_texel[0] / 255 : 1);
  } else {
    out.light.value = point.brightness;
  }
  for (std::size_t c = 0; c < 3; ++c) out.lit[c] = out.color[c] * out.light.value;
  out.fog_factor = fog_factor(config, scene, point);
  for (std::size_t c = 0; c < 3; ++c) {
    const double fog = scene.fog ? scene.fog->color[c] : 0;
    out.fogged[c] = fog + (out.lit[c] - fog) * out.fog_factor;
    if (out.fog_factor == 1) out.fogged[c] = out.lit[c];
  }
  return out;
}

std::uint8_t nearest_code(double x) {
  return static_cast<std::uint8_t>(std::clamp(std::floor(x + 0.5), 0.0, 255.0));
}

class IdealEngine final : public Engine {
 public:
  explicit IdealEngine(const Config& config) : config_(config) {}

  std::string_view name() const override { return "ideal"; }
  const Counters& counters() const override { return counters_; }

  void begin(const Scene& scene) override {
    scene_.begin(scene);
    levels_ = golden::scene_levels(config_, scene);
    counters_ = {};
    state_ = first_state(config_);
    biased_ = false;
    targets_ = {};
    clear_target();
  }

  void execute(const DrawCommand& command, std::int64_t /*next_index*/, Trace* /*trace*/) override {
    std::visit([&](const auto& what) { run(what); }, command.what);
  }
  void run(const StateChange& change) {
    state_ = changed_state(state_, change, config_, scene_->textures.size());
    biased_ = biased_ || state_.depth_bias != 0;
    make_ready();
  }
  void run(const Target& target) {
    scene_.run(target);
    if (!targets_.select(target.k, planes_)) clear_target();
    make_ready();
  }
  void run(const ViewChange& change) {
    scene_.run(change);
    if (planes_.frame.width == scene_->width && planes_.frame.height == scene_->height) return;
    clear_target();
    make_ready();
  }
  // The codes are those of the rounded picture.
  void run(const Copy& copy) {
    check_copy(*scene_, scene_.views(), copy);
    const int shown = targets_.current();
    run(Target{copy.target});
    scene_.run(copy, frame(), config_.depth_bits);
    run(Target{shown});
    const auto index = static_cast<std::size_t>(copy.texture);
    if (!levels_.empty()) levels_[index] = golden::mip_levels(scene_->textures[index]);
  }
  void run(const Resolve& /*resolve*/) {
    for (std::size_t i = 0; i < planes_.held.size(); ++i) {
      if (planes_.held[i].alpha > 0) store(planes_.held[i], i);
      planes_.held[i] = {};
    }
    planes_.stale = true;
  }
  void run(const Clear& clear) {
    if (clear.masked) {
      golden::clear_masked(planes_.frame, state_, clear, 0);
    } else {
      clear_planes(planes_.frame, clear, 0);
    }
    const auto stores = [&](std::size_t c) {
      return !clear.masked || (state_.color_write && has_channel(c));
    };
    const bool depth = clear.depth && (!clear.masked || state_.depth_write);
    for (std::size_t i = 0; i < planes_.color.size(); ++i) {
      const auto width = static_cast<std::size_t>(planes_.frame.width);
      const auto x = static_cast<std::int64_t>(i % width), y = static_cast<std::int64_t>(i / width);
      if (clear.masked && golden::is_outside_scissor(state_, x, y)) continue;
      for (std::size_t c = 0; clear.color && c < 3; ++c) {
        if (stores(c)) planes_.color[i][c] = (*clear.color)[c];
      }
      if (stores(3) && clear.alpha) planes_.alpha[i] = has_alpha() ? *clear.alpha : 255;
      if (!depth) continue;
      planes_.h[i] = 0;
      planes_.z[i] = configured_code(config_, *scene_, 0, scene_->s_max);
      if (!planes_.dz.empty()) planes_.dz[i] = 0;
    }
    planes_.stale = true;
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* /*trace*/) override {
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) {
      ++counters_.triangles;
      if (triangle.is_line) {
        draw_line(triangle, index);
      } else if (const auto t = ideal_triangle(config_, triangle)) {
        back_ = state_.stencil_test && golden::runs_clockwise(config_, triangle);
        triangle_dz_ = log2_of_dz(config_, *scene_, *t);
        golden::for_each_covered(
            *t, config_.fill_rule, planes_.frame.width, planes_.frame.height,
            [&](const Areas& areas, std::int64_t x, std::int64_t y) { pixel(*t, index, areas, x, y); });
      } else {
        ++counters_.degenerate;
      }
      ++index;
    }
    planes_.stale = true;
  }

  // The planes of 8-bit colour and of depth codes are rounded here, and nowhere else.
  const Frame& frame() const override {
    if (!planes_.stale) return planes_.frame;
    planes_.frame.color.resize(4 * planes_.color.size());
    planes_.frame.depth.resize(planes_.z.size());
    const auto z_max = static_cast<double>(h_max(config_));
    for (std::size_t i = 0; i < planes_.color.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) planes_.frame.color[4 * i + c] = nearest_code(planes_.color[i][c]);
      planes_.frame.color[4 * i + 3] = nearest_code(planes_.alpha[i]);
      const double code = planes_.dz.empty() ? std::clamp(std::floor(planes_.z[i] + 0.5), 0.0, z_max)
                                             : rounded_word(config_, planes_.z[i], planes_.dz[i]);
      planes_.frame.depth[i] = static_cast<std::uint32_t>(code);
    }
    planes_.stale = false;
    return planes_.frame;
  }

 private:
  // What a fragment leaves at its pixel.
  struct Drawn {
    double h = 0, z = 0;
    int dz = 0;
    std::array<double, 3> color{};
    double alpha = 0;
    double u = 0, v = 0;
    std::int32_t triangle = -1;
  };
  // Of a target. The frame's colour and depth codes are stale until they are asked for.
  struct Planes {
    std::vector<double> h, z;
    std::vector<int> dz;  // beside z, float_dz alone
    std::vector<std::array<double, 3>> color;
    std::vector<double> alpha;  // 0..255
    std::vector<Drawn> held;    // candidates; alpha 0 where a pixel holds none
    Frame frame;
    bool stale = true;
  };
  // Gives the target the planes that the draw state asks for.
  void make_ready() {
    if (state_.stencil_test) need_stencil(planes_.frame);
    if (holds_candidates(state_.translucency_pass)) planes_.held.resize(planes_.color.size());
  }
  void clear_target() {
    const Scene& scene = *scene_;
    const auto pixels = static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height);
    clear_frame(planes_.frame, scene.width, scene.height, scene.background, 0);
    planes_.h.assign(pixels, 0);
    planes_.z.assign(pixels, configured_code(config_, scene, 0, scene.s_max));
    planes_.dz.assign(has_dz(config_.depth_code) ? pixels : 0, 0);
    planes_.color.assign(
        pixels, {double(scene.background[0]), double(scene.background[1]), double(scene.background[2])});
    planes_.alpha.assign(pixels, 255);
    planes_.held.clear();
    planes_.stale = true;
  }

  void draw_line(const Triangle& triangle, std::int64_t index) {
    if (!has_lines(config_.line_walk)) {
      throw InputError("triangle " + std::to_string(index) +
                       " is a line, and line.walk = none draws no lines; legal: line.walk = exact, dda");
    }
    back_ = false;
    triangle_dz_ = 0;
    const IdealLine line = ideal_line(config_, triangle);
    for (const IdealLine::Pixel& p : line.pixels) {
      if (p.x < 0 || p.x >= planes_.frame.width || p.y < 0 || p.y >= planes_.frame.height) continue;
      pixel(line.shape, index, p.weight, p.x, p.y);
    }
  }

  void pixel(const IdealTriangle& t, std::int64_t index, const Areas& areas, std::int64_t x, std::int64_t y) {
    ++counters_.fragments;
    ++counters_.covered;
    if (golden::is_masked(state_, x, y)) {
      ++counters_.masked;
      return;
    }
    const auto i = static_cast<std::size_t>(y * planes_.frame.width + x);
    const IdealPoint point = point_at_centre(config_, *scene_, t, areas, x, y);
    const bool late = is_late(state_.depth_when);
    if (!late && !depth_passes(point, i, x, y)) return;
    const IdealFragment fragment = shade(config_, state_, *scene_, t, point, &levels_);
    if (fragment.killed || !golden::takes_alpha(state_.translucency_pass, fragment.alpha) ||
        !golden::holds<double>(state_.alpha_func, nearest_code(255 * fragment.alpha), state_.alpha_ref)) {
      ++counters_.killed;
      return;
    }
    if (late && !depth_passes(point, i, x, y)) return;
    // No distance is beyond s_max, the cleared buffer's, but h of one at s_max may round below 0.
    const Drawn drawn{.h = std::max(point.line, 0.0),
                      .z = code_of(point),
                      .dz = triangle_dz_,
                      .color = fragment.fogged,
                      .alpha = fragment.alpha,
                      .u = point.u,
                      .v = point.v,
                      .triangle = static_cast<std::int32_t>(index)};
    if (!holds_candidates(state_.translucency_pass)) return store(drawn, i);
    ++counters_.candidates;
    Drawn& held = planes_.held[i];
    if (held.alpha == 0 || nearness_of(drawn) < nearness_of(held)) held = drawn;
  }

  void store(const Drawn& drawn, std::size_t i) {
    ++counters_.written;
    if (state_.depth_write) {
      planes_.h[i] = drawn.h;
      planes_.z[i] = drawn.z;
      if (!planes_.dz.empty()) planes_.dz[i] = drawn.dz;
    }
    if (!state_.color_write) return;
    const std::array<double, 3> color = planes_.color[i];
    const double alpha = planes_.alpha[i];
    blend(drawn, i);
    for (std::size_t c = 0; c < 3; ++c) {
      if (!has_channel(c)) planes_.color[i][c] = color[c];
    }
    if (!has_channel(3)) planes_.alpha[i] = alpha;
    planes_.frame.u[i] = drawn.u;
    planes_.frame.v[i] = drawn.v;
    planes_.frame.triangle[i] = drawn.triangle;
  }

  // The unquantised code with the bias, within the register.
  double code_of(const IdealPoint& point) const {
    return biased(config_, configured_code(config_, *scene_, point.line, point.s), state_.depth_bias);
  }
  // Larger where the depth test calls it nearer.
  double nearness_of(const Drawn& drawn) const {
    if (planes_.dz.empty() && !biased_) return drawn.h;
    return nearer_is_larger(config_.depth_code) ? drawn.z : -drawn.z;
  }
  bool depth_passes(const IdealPoint& point, std::size_t i, std::int64_t x, std::int64_t y) {
    bool pass = false;
    if (!planes_.dz.empty()) {
      const double z = code_of(point);
      const double tolerance = std::ldexp(1.0, std::max(triangle_dz_, planes_.dz[i]));
      const bool as_far = takes_tolerance(state_.depth_func) && std::abs(z - planes_.z[i]) <= tolerance;
      pass = passes(state_.depth_func, as_far ? -planes_.z[i] : -z, -planes_.z[i]);
    } else if (biased_) {
      const double sign = nearer_is_larger(config_.depth_code) ? 1 : -1;
      pass = passes(state_.depth_func, sign * code_of(point), sign * planes_.z[i]);
    } else {
      pass = passes(state_.depth_func, std::max(point.line, 0.0), planes_.h[i]);
    }
    if (state_.stencil_test) {
      const StencilRecord tested =
          golden::stencil(state_, back_, {.x = x, .y = y, .pass = pass ? 1 : 0}, planes_.frame.stencil[i]);
      planes_.frame.stencil[i] = static_cast<std::uint8_t>(tested.value);
      if (tested.pass == 0) ++counters_.stencil_failed;
      pass = pass && tested.pass == 1;
    }
    if (pass) ++counters_.depth_passed;
    return pass;
  }
  // By color.mask.
  bool has_channel(std::size_t c) const { return (state_.color_mask >> c & 1) != 0; }
  bool has_alpha() const { return target_bits(state_.target_format)[3] > 0; }
  void blend(const Drawn& drawn, std::size_t i) {
    const double a = std::min(drawn.alpha, 1.0);
    const std::array<int, 3> constant{state_.blend_red, state_.blend_green, state_.blend_blue};
    const auto code = [](double x) { return static_cast<unsigned>(nearest_code(x)); };
    const double dst_a = planes_.alpha[i] / 255;
    const double ka = state_.blend_alpha / 255.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double src = drawn.color[c];
      double& dst = planes_.color[i][c];
      if (state_.logic_op != LogicOp::none) {
        dst = golden::logic(state_.logic_op, code(src), code(dst));
        continue;
      }
      const golden::BlendShares<double> shares{
          a, std::clamp(src / 255, 0.0, 1.0), dst / 255, dst_a, constant[c] / 255.0, ka};
      const double by_src = shares.of(state_.blend_src, false);
      const double by_dst = shares.of(state_.blend_dst, false);
      // As a mix where it is one, so that an opaque fragment's colour is its own.
      const bool mix = state_.blend_op == BlendOp::add && by_src + by_dst == 1;
      if (mix) {
        dst = by_src == 1 ? src : dst + (src - dst) * by_src;
      } else {
        dst = std::clamp(golden::combine(state_.blend_op, src, dst, by_src, by_dst), 0.0, 255.0);
      }
    }
    if (!has_alpha()) {
      planes_.alpha[i] = 255;
      return;
    }
    if (state_.logic_op != LogicOp::none) {
      planes_.alpha[i] = golden::logic(state_.logic_op, code(255 * a), code(planes_.alpha[i]));
      return;
    }
    const golden::BlendShares<double> shares{a, a, dst_a, dst_a, ka, ka};
    planes_.alpha[i] = std::clamp(
        golden::combine(state_.blend_alpha_op, 255 * a, planes_.alpha[i],
                        shares.of(state_.blend_alpha_src, true), shares.of(state_.blend_alpha_dst, true)),
        0.0, 255.0);
  }

  Config config_;
  DrawnScene scene_;
  golden::SceneLevels levels_;
  int triangle_dz_ = 0;  // of the triangle under way
  DrawState state_;
  bool biased_ = false;  // depth.bias was not 0 once: the depth test is on codes
  bool back_ = false;    // the triangle is a back face
  mutable Planes planes_;
  Targets<Planes> targets_;
  Counters counters_;
};

}  // namespace

std::optional<IdealProjection> ideal_projection(const Config& config, const Scene& scene,
                                                const IdealPoint& point) {
  const auto [x, y, w] = point.project;
  if (!scene.projector || !(w > 0)) return std::nullopt;
  const auto h = static_cast<double>(
      golden::depth_code(config, scene.projector->s_min, scene.projector->s_max, 1.0L / w));
  const auto z_max = static_cast<double>(h_max(config));
  return IdealProjection{x / w, y / w, w, h, is_complement_of_h(config.depth_code) ? z_max - h : h};
}

IdealPoint ideal_point(const Config& config, const Scene& scene, const IdealTriangle& triangle, double x,
                       double y) {
  using golden::Quad;
  // Exact in 113 bits for points on a grid of up to 2^-30 pixel.
  const Quad unit = golden::pow2<Quad>(-triangle.subpixel_bits);
  const auto part = [&](const Corner& a, const Corner& b) {
    return (Quad(b.x) - Quad(a.x)) * unit * (Quad(y) - Quad(a.y) * unit) -
           (Quad(b.y) - Quad(a.y)) * unit * (Quad(x) - Quad(a.x) * unit);
  };
  const auto& v = triangle.v;
  const std::array<Quad, 3> parts{part(v[1], v[2]), part(v[2], v[0]), part(v[0], v[1])};
  const Quad whole = parts[0] + parts[1] + parts[2];
  IdealPoint out =
      blend(config, scene, triangle,
            {static_cast<long double>(parts[0] / whole), static_cast<long double>(parts[1] / whole),
             static_cast<long double>(parts[2] / whole)});
  out.x = x;
  out.y = y;
  return out;
}

IdealPoint ideal_on_edge(const Config& config, const Scene& scene, const IdealTriangle& triangle, int edge,
                         std::int64_t y) {
  const std::size_t from = edge == 2 ? 1 : 0;
  const std::size_t to = edge == 1 ? 1 : 2;
  const Corner& a = triangle.v[from];
  const Corner& b = triangle.v[to];
  const long double unit = std::ldexp(1.0L, -triangle.subpixel_bits);
  const long double below = static_cast<long double>(y) + 0.5L - static_cast<long double>(a.y) * unit;
  const long double t = below / (static_cast<long double>(b.y - a.y) * unit);
  std::array<long double, 3> weight{};
  weight[from] = 1 - t;
  weight[to] = t;
  IdealPoint out = blend(config, scene, triangle, weight);
  out.x =
      static_cast<double>((static_cast<long double>(a.x) + static_cast<long double>(b.x - a.x) * t) * unit);
  out.y = static_cast<double>(y) + 0.5;
  return out;
}

IdealPoint ideal_at_vertex(const Config& config, const Scene& scene, const IdealTriangle& triangle,
                           int vertex) {
  const auto i = static_cast<std::size_t>(vertex);
  std::array<long double, 3> weight{};
  weight.at(i) = 1;
  IdealPoint out = blend(config, scene, triangle, weight);
  out.x = std::ldexp(static_cast<double>(triangle.v[i].x), -triangle.subpixel_bits);
  out.y = std::ldexp(static_cast<double>(triangle.v[i].y), -triangle.subpixel_bits);
  return out;
}

IdealFragment ideal_at(const Config& config, const Scene& scene, const IdealTriangle& triangle,
                       std::int64_t x, std::int64_t y, const golden::SceneLevels* levels) {
  const Areas areas = areas_at(triangle, centre_of(triangle, x, y));
  IdealFragment out = shade(config, first_state(config), scene, triangle,
                            point_at_centre(config, scene, triangle, areas, x, y), levels);
  out.dz = log2_of_dz(config, scene, triangle);
  return out;
}

double ideal_stored_code(const Config& config, const IdealFragment& fragment, std::int64_t bias) {
  const double z = biased(config, fragment.z, bias);
  return has_dz(config.depth_code) ? std::ldexp(floating_z(config, z), dz_bits) + fragment.dz : z;
}

std::unique_ptr<Engine> make_ideal(const Config& config) { return std::make_unique<IdealEngine>(config); }

}  // namespace bitspan
