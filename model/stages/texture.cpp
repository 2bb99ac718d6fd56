#include "model/stages/texture.hpp"

#include <algorithm>

#include "model/channels.hpp"
#include "model/numeric/extent.hpp"
#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

std::int64_t wrapped(std::int64_t i, std::int64_t size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) {
    return std::clamp<std::int64_t>(i, 0, size - 1);
  }
  if (static_cast<std::uint64_t>(i) < static_cast<std::uint64_t>(size)) {
    return i;
  }
  const std::int64_t rest = i % size;
  return rest < 0 ? rest + size : rest;
}

const std::uint8_t* texel(const Texture& image, std::int64_t i, std::int64_t j) {
  return image.rgba.data() + 4 * (j * image.width + i);
}

bool is_reserved(const TextureStage& stage, const std::uint8_t* p) {
  return stage.transparent && std::equal(stage.transparent->begin(), stage.transparent->end(), p);
}

// floor(raw 2^-fraction)
std::int64_t floor_coordinate(int128 raw, int fraction) {
  return static_cast<std::int64_t>(floor_of({raw, fraction}));
}

using Filtered = std::array<std::int64_t, 4>;  // on texture.mix, alpha on texture.alpha

template <class Watch>
std::int64_t texel_alpha(const TextureStage& stage, std::uint8_t a, Watch watch) {
  return quantize_ratio(a, 255, 0, stage.alpha, watch);
}

// Q(a (1 - e) + b e) on r; a and b have fraction bits of their own.
template <class Int, class Watch>
std::int64_t blend(std::int64_t a, std::int64_t b, std::int64_t e, int e_fraction, int fraction,
                   const Register& r, Watch watch) {
  const Int one = Int{1} << e_fraction;
  const Int sum = static_cast<Int>(a) * (one - e) + static_cast<Int>(b) * e;
  return quantize(sum, fraction + e_fraction, r, watch);
}

template <class Int, class Watch>
Filtered bilinear(const TextureStage& stage, const std::array<const std::uint8_t*, 4>& texels,
                  const TextureRecord& out, Watch watch) {
  const auto& [v1, v4, v2, v3] = texels;
  const int e_fraction = std::max(0, stage.frac.fraction);
  const std::int64_t ex = out.ex << (e_fraction - stage.frac.fraction);
  const std::int64_t ey = out.ey << (e_fraction - stage.frac.fraction);
  Filtered v{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::int64_t v5 = blend<Int>(v1[c], v4[c], ex, e_fraction, 0, stage.mix, watch);
    const std::int64_t v6 = blend<Int>(v2[c], v3[c], ex, e_fraction, 0, stage.mix, watch);
    v[c] = blend<Int>(v5, v6, ey, e_fraction, stage.mix.fraction, stage.mix, watch);
  }
  const auto alpha = [&](const std::uint8_t* p) { return texel_alpha(stage, p[3], watch); };
  const int a_fraction = stage.alpha.fraction;
  const std::int64_t v5 = blend<Int>(alpha(v1), alpha(v4), ex, e_fraction, a_fraction, stage.alpha, watch);
  const std::int64_t v6 = blend<Int>(alpha(v2), alpha(v3), ex, e_fraction, a_fraction, stage.alpha, watch);
  v[3] = blend<Int>(v5, v6, ey, e_fraction, a_fraction, stage.alpha, watch);
  return v;
}

template <class Int, class Watch>
bool texture_on(const TextureStage& stage, const Texture* image, const FragmentRecord& fragment,
                TextureRecord& out, Watch watch) {
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  out.i = out.j = out.ex = out.ey = 0;
  bool killed = false;
  Filtered v{};
  if (image == nullptr) {
    const std::int64_t full = quantize(std::int64_t{255}, 0, stage.mix, watch);
    v = {full, full, full, quantize(std::int64_t{1}, 0, stage.alpha, watch)};
  } else {
    const int fraction = stage.uv.fraction;
    const std::int64_t near_i = wrapped(floor_coordinate(fragment.u, fraction), image->width, stage.wrap);
    const std::int64_t near_j = wrapped(floor_coordinate(fragment.v, fraction), image->height, stage.wrap);
    const std::uint8_t* nearest = texel(*image, near_i, near_j);
    killed = is_reserved(stage, nearest);
    if (stage.filter == TextureFilter::nearest) {
      out.i = near_i;
      out.j = near_j;
      for (std::size_t c = 0; c < 3; ++c) {
        v[c] = quantize(std::int64_t{nearest[c]}, 0, stage.mix, watch);
      }
      v[3] = texel_alpha(stage, nearest[3], watch);
    } else {
      // u - 1/2 on a grid that has the half.
      const int grid = std::max(1, fraction);
      const int128 half = int128{1} << (grid - 1);
      const int128 u = (int128{fragment.u} << (grid - fraction)) - half;
      const int128 w = (int128{fragment.v} << (grid - fraction)) - half;
      const std::int64_t i = floor_coordinate(u, grid);
      const std::int64_t j = floor_coordinate(w, grid);
      const int128 mask = (int128{1} << grid) - 1;
      out.ex = quantize(u & mask, grid, stage.frac, watch);
      out.ey = quantize(w & mask, grid, stage.frac, watch);
      out.i = wrapped(i, image->width, stage.wrap);
      out.j = wrapped(j, image->height, stage.wrap);
      const std::int64_t i1 = wrapped(i + 1, image->width, stage.wrap);
      const std::int64_t j1 = wrapped(j + 1, image->height, stage.wrap);
      std::array texels{texel(*image, out.i, out.j), texel(*image, i1, out.j), texel(*image, out.i, j1),
                        texel(*image, i1, j1)};
      if (stage.transparent) {
        for (const std::uint8_t*& p : texels) {
          p = is_reserved(stage, p) ? nearest : p;
        }
      }
      v = bilinear<Int>(stage, texels, out, watch);
    }
  }
  out.texel_r = v[0];
  out.texel_g = v[1];
  out.texel_b = v[2];
  out.texel_a = v[3];
  const auto shaded = [&](std::int64_t value, int fraction, std::int64_t shade, const Register& r) {
    return quantize(static_cast<Int>(value) * static_cast<Int>(shade), fraction + stage.shade.fraction, r,
                    watch);
  };
  out.r = shaded(v[0], stage.mix.fraction, fragment.r, stage.color);
  out.g = shaded(v[1], stage.mix.fraction, fragment.g, stage.color);
  out.b = shaded(v[2], stage.mix.fraction, fragment.b, stage.color);
  out.a = shaded(v[3], stage.alpha.fraction, fragment.a, stage.alpha);
  killed = killed || out.a == 0;
  out.killed = killed ? 1 : 0;
  return !killed;
}

}  // namespace

TextureStage prepare_texture(const Config& config) {
  TextureStage s;
  s.filter = config.filter;
  s.wrap = config.wrap;
  s.transparent = config.transparent;
  s.uv = make_register(config, FormatId::span_uv);
  s.shade = make_register(config, FormatId::span_shade);
  s.frac = make_register(config, FormatId::texture_frac);
  s.mix = make_register(config, FormatId::texture_mix);
  s.color = make_register(config, FormatId::texture_color);
  s.alpha = make_register(config, FormatId::texture_alpha);
  // 1 - Ex has a bit more than Ex; either times a colour, and the sum of two such.
  const Extent share = sum(extent_of_integer(1), extent(config.format(FormatId::texture_frac)));
  const auto mixes = [&](Extent v) { return fits_int64(sum(product(v, share), product(v, share))); };
  const Extent mix = extent(config.format(FormatId::texture_mix));
  const Extent alpha = extent(config.format(FormatId::texture_alpha));
  const Extent shade = extent(config.format(FormatId::span_shade));
  s.narrow = mixes(extent_of_integer(8)) && mixes(mix) && mixes(alpha) && fits_int64(product(mix, shade)) &&
             fits_int64(product(alpha, shade));
  return s;
}

template <class Watch>
bool texture(const TextureStage& stage, const Texture* image, const FragmentRecord& fragment,
             TextureRecord& out, Watch watch) {
  return stage.narrow ? texture_on<std::int64_t>(stage, image, fragment, out, watch)
                      : texture_on<int128>(stage, image, fragment, out, watch);
}

template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, NoObserve);
template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, Observe);

}  // namespace bitspan::model
