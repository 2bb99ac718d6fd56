// SPDX-License-Identifier: Apache-2.0
// texture: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "texture".
//
// Int: std::int64_t, int128, Lanes32 or Lanes, what products are formed in; every intermediate fits it.
// Image: how texels are fetched; texels are words, red in the lowest byte, alpha in the fourth:
//   present()                 false: no texture
//   filter()                  how texels are weighed
//   may_be_reserved()         false: no texel has the reserved colour
//   is_grey()                 true: red, green and blue of every texel are equal
//   nearest(i, j)             wraps both (they come out wrapped) and gives the texel
//   quad(i, j)                the texels (i, j), (i+1, j), (i, j+1), (i+1, j+1), each wrapped; i, j come out
//   wrapped alpha(stage, word, watch) Q[texture.alpha](a / 255) of a word
#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "model/numeric/ratio-inl.hpp"
#include "model/stages/depth-inl.hpp"
#include "model/stages/texel.hpp"
#include "model/stages/texture.hpp"

#if defined(BITSPAN_MODEL_STAGES_TEXTURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_TEXTURE_INL
#undef BITSPAN_MODEL_STAGES_TEXTURE_INL
#else
#define BITSPAN_MODEL_STAGES_TEXTURE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

template <class V>
using Truth = decltype(std::declval<V>() == std::declval<V>());

// An intermediate that fits a register.
template <class Int>
HWY_INLINE ValueOf<Int> as_value(Int x) {
  return static_cast<ValueOf<Int>>(x);
}

template <class V>
struct Textured {
  V i, j, ex, ey;
  std::array<V, 4> texel;  // on texture.mix, alpha on texture.alpha
  std::array<V, 4> color;  // on texture.color, alpha on texture.alpha
  Truth<V> killed;
};

template <class V>
struct Quad {
  V v1, v4, v2, v3;
};

template <class V>
HWY_INLINE V channel_of(V word, std::size_t channel) {
  return (word >> static_cast<int>(8 * channel)) & V(255);
}

// Q of a code 0..255.
template <class V, class Watch>
HWY_INLINE V quantize_code(V code, const Register& r, Watch watch) {
  if constexpr (std::is_same_v<Watch, BranchFree>) {
    return code << r.fraction;
  } else {
    return quantize(code, 0, r, watch);
  }
}

// A texel that the chroma test takes for a transparent one.
template <class V>
HWY_INLINE Truth<V> is_keyed(const ChromaRange& chroma, V word) {
  Truth<V> in_range = V(0) == V(0);
  for (std::size_t c = 0; c < 3; ++c) {
    const V code = channel_of(word, c);
    const Truth<V> reaches_low = code >= V(static_cast<ElementOf<V>>(chroma.low[c]));
    const Truth<V> within_high = code <= V(static_cast<ElementOf<V>>(chroma.high[c]));
    in_range = in_range & reaches_low & within_high;
  }
  return chroma.test == ChromaTest::inside ? in_range : !in_range;
}

// A texel of the reserved colour, or a keyed one.
template <class V>
HWY_INLINE Truth<V> is_reserved(const TextureStage& stage, V word) {
  Truth<V> found = V(0) != V(0);
  if (stage.chroma.test != ChromaTest::none) found = is_keyed(stage.chroma, word);
  if (stage.transparent) {
    const auto& c = *stage.transparent;
    found = found | ((word & V(0xffffff)) == V(c[0] | c[1] << 8 | c[2] << 16));
  }
  return found;
}

inline std::int64_t wrapped(std::int64_t i, std::int64_t size, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::clamp:
      return std::clamp<std::int64_t>(i, 0, size - 1);
    case TextureWrap::cyclic: {
      if (static_cast<std::uint64_t>(i) < static_cast<std::uint64_t>(size)) {
        return i;
      }
      const std::int64_t rest = i % size;
      return rest < 0 ? rest + size : rest;
    }
    case TextureWrap::mirror: {
      const std::int64_t turned = 2 * size - 1;  // the last place of a copy and the copy turned round
      const std::int64_t rest = i % (2 * size);
      const std::int64_t at = rest < 0 ? rest + 2 * size : rest;
      return at < size ? at : turned - at;
    }
    case TextureWrap::border:
      return std::clamp<std::int64_t>(i, -1, size);
  }
  unreachable();
}

// A texel as a word, red in the lowest byte.
inline std::int64_t word_of(const std::array<std::uint8_t, 4>& c) {
  return c[0] | c[1] << 8 | c[2] << 16 | std::int64_t{c[3]} << 24;
}

// A texture, or none, for one integer.
struct TextureImage {
  const Texture* texture;
  TexelLookup by;
  std::int64_t border;  // the word of what is outside, where the mode has such texels
  TexelTest test{};

  bool present() const { return texture != nullptr; }
  TextureFilter filter() const { return by.filter; }
  static bool may_be_reserved() { return true; }
  static bool is_grey() { return false; }
  std::int64_t word(std::int64_t i, std::int64_t j) const {
    if (i < 0 || j < 0 || i >= texture->width || j >= texture->height) return border;
    if (test.depth == nullptr) return word_of(texel_of(*texture, i, j));
    const std::int64_t stored = depth_word(*texture, i, j) >> (32 - test.depth->z.word);
    return depth_passes(*test.depth, test.func, test.z, stored) ? 0xffffffff : test.failed;
  }
  std::int64_t nearest(std::int64_t& i, std::int64_t& j) const {
    i = wrapped(i, texture->width, by.wrap_u);
    j = wrapped(j, texture->height, by.wrap_v);
    return word(i, j);
  }
  Quad<std::int64_t> quad(std::int64_t& i, std::int64_t& j) const {
    const std::int64_t i1 = wrapped(i + 1, texture->width, by.wrap_u);
    const std::int64_t j1 = wrapped(j + 1, texture->height, by.wrap_v);
    const std::int64_t first = nearest(i, j);
    return {first, word(i1, j), word(i, j1), word(i1, j1)};
  }
  template <class Watch>
  static std::int64_t alpha(const TextureStage& stage, std::int64_t word, Watch watch) {
    return quantize_ratio(word >> 24, 255, 0, stage.alpha, watch);
  }
};

// Q(a (1 - e) + b e) on r; a and b have fraction bits of their own.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> blend(ValueOf<Int> a, ValueOf<Int> b, ValueOf<Int> e, int e_fraction, int fraction,
                              const Register& r, Watch watch) {
  const Int one = Int(1) << e_fraction;
  return quantize(Int(a) * (one - Int(e)) + Int(b) * Int(e), fraction + e_fraction, r, watch);
}

// AS: floor(255 a + 1/2) of an alpha of at most 1, a 2^-fraction.
template <class Int>
HWY_INLINE ValueOf<Int> code_of_alpha(Int a, int fraction) {
  return as_value<Int>((Int(510) * a + (Int(1) << fraction)) >> (fraction + 1));
}

// a: on the format texture.alpha, which `alpha` is.
template <class V>
HWY_INLINE Truth<V> passes_alpha_test(const Register& alpha, const AlphaTest& test, V a) {
  const auto reaches = [&](std::int64_t least) HWY_ATTR {
    // In range, a lane holds it.
    if (least > alpha.max) return V(0) != V(0);
    return a >= V(static_cast<ElementOf<V>>(least < alpha.min ? alpha.min : least));
  };
  const Truth<V> below = !reaches(test.least);
  const Truth<V> above = reaches(test.least_above);
  switch (test.func) {
    case CompareFunc::never:
      return V(0) != V(0);
    case CompareFunc::less:
      return below;
    case CompareFunc::equal:
      return !(below | above);
    case CompareFunc::less_equal:
      return !above;
    case CompareFunc::greater:
      return above;
    case CompareFunc::not_equal:
      return below | above;
    case CompareFunc::greater_equal:
      return !below;
    case CompareFunc::always:
      return V(0) == V(0);
  }
  unreachable();
}

// The fraction bits of u and v.
struct UvFraction {
  int u, v;
};

// Where a fragment looks and what it finds there, its colour apart.
template <class Int, class Image, class Watch>
HWY_INLINE Textured<ValueOf<Int>> sampled(const TextureStage& stage, const Image& image, ValueOf<Int> u,
                                          ValueOf<Int> v, UvFraction fraction, Watch watch) {
  using V = ValueOf<Int>;
  Textured<V> out;
  out.i = out.j = out.ex = out.ey = V(0);
  out.killed = V(0) != V(0);
  if (!image.present()) {
    const V full = as_value<Int>(quantize(V(255), 0, stage.mix, watch));
    out.texel = {full, full, full, as_value<Int>(quantize(V(1), 0, stage.alpha, watch))};
  } else {
    const bool reserved =
        (stage.transparent && image.may_be_reserved()) || stage.chroma.test != ChromaTest::none;
    const TextureFilter filter = image.filter();
    V nearest_word(0);
    if (!weighs_texels(filter) || reserved) {
      const auto floor = [](V x, int f)
                             HWY_ATTR { return as_value<Int>(f >= 0 ? Int(x) >> f : Int(x) << -f); };
      out.i = floor(u, fraction.u);
      out.j = floor(v, fraction.v);
      nearest_word = image.nearest(out.i, out.j);
      if (reserved) {
        out.killed = is_reserved(stage, nearest_word);
      }
    }
    switch (filter) {
      case TextureFilter::nearest:
        for (std::size_t c = 0; c < 3; ++c) {
          out.texel[c] = quantize_code(channel_of(nearest_word, c), stage.mix, watch);
        }
        out.texel[3] = image.alpha(stage, nearest_word, watch);
        break;
      case TextureFilter::bilinear: {
        // u - 1/2 on a grid that has the half.
        const auto split = [&](V x, int f, V& whole, V& e) HWY_ATTR {
          const int grid = f > 1 ? f : 1;
          const Int low = (Int(x) << (grid - f)) - (Int(1) << (grid - 1));
          e = quantize(low & ((Int(1) << grid) - Int(1)), grid, stage.frac, watch);
          whole = as_value<Int>(low >> grid);
        };
        split(u, fraction.u, out.i, out.ex);
        split(v, fraction.v, out.j, out.ey);
        Quad<V> quad = image.quad(out.i, out.j);
        if (reserved) {
          for (V* word : {&quad.v1, &quad.v4, &quad.v2, &quad.v3}) {
            *word = select(is_reserved(stage, *word), nearest_word, *word);
          }
        }
        // texture.frac has no integer bits: its fraction is its word, at least 1.
        const int e_fraction = stage.frac.fraction;
        const auto mixed = [&](V v1, V v4, V v2, V v3, int f, const Register& r) HWY_ATTR {
          const V v5 = blend<Int>(v1, v4, out.ex, e_fraction, f, r, watch);
          const V v6 = blend<Int>(v2, v3, out.ex, e_fraction, f, r, watch);
          return blend<Int>(v5, v6, out.ey, e_fraction, r.fraction, r, watch);
        };
        for (std::size_t c = 0; c < 3; ++c) {
          if (c > 0 && image.is_grey()) {
            out.texel[c] = out.texel[0];
            continue;
          }
          out.texel[c] = mixed(channel_of(quad.v1, c), channel_of(quad.v4, c), channel_of(quad.v2, c),
                               channel_of(quad.v3, c), 0, stage.mix);
        }
        out.texel[3] = mixed(image.alpha(stage, quad.v1, watch), image.alpha(stage, quad.v4, watch),
                             image.alpha(stage, quad.v2, watch), image.alpha(stage, quad.v3, watch),
                             stage.alpha.fraction, stage.alpha);
        break;
      }
    }
  }
  return out;
}

// The mix with what the next coarser level has there; f: its share.
template <class Int, class Watch>
HWY_INLINE void mix_level(const TextureStage& stage, const Textured<ValueOf<Int>>& coarser, ValueOf<Int> f,
                          Textured<ValueOf<Int>>& out, Watch watch) {
  for (std::size_t c = 0; c < 4; ++c) {
    const Register& r = c < 3 ? stage.mix : stage.alpha;
    out.texel[c] = blend<Int>(out.texel[c], coarser.texel[c], f, stage.share.fraction, r.fraction, r, watch);
  }
}

// The product with the fragment's colour.
template <class Int, class Watch>
HWY_INLINE void colour(const TextureStage& stage, const std::array<ValueOf<Int>, 4>& shade,
                       Textured<ValueOf<Int>>& out, Watch watch) {
  using V = ValueOf<Int>;
  for (std::size_t c = 0; c < 4; ++c) {
    const Register& from = c < 3 ? stage.mix : stage.alpha;
    const Register& to = c < 3 ? stage.color : stage.alpha;
    out.color[c] =
        quantize(Int(out.texel[c]) * Int(shade[c]), from.fraction + stage.shade.fraction, to, watch);
  }
  if (stage.kills_zero) out.killed = out.killed | (out.color[3] == V(0));
}

template <class Int, class Image, class Watch>
HWY_INLINE Textured<ValueOf<Int>> textured(const TextureStage& stage, const Image& image, ValueOf<Int> u,
                                           ValueOf<Int> v, const std::array<ValueOf<Int>, 4>& shade,
                                           Watch watch) {
  Textured<ValueOf<Int>> out =
      sampled<Int>(stage, image, u, v, {stage.uv.fraction, stage.uv.fraction}, watch);
  colour<Int>(stage, shade, out, watch);
  return out;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
