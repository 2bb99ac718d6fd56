// SPDX-License-Identifier: Apache-2.0
// The kernels of shade.hpp for one target. In three passes over a block: the fog's factors; texture, fog and
// merge to colour words; the words to the frame. Between them the values stay in columns of a block's length.
#include <bit>
#include <cstring>

#include "config/modes.hpp"
#include "model/simd/fixed.hpp"
#include "model/simd/levels-inl.hpp"
#include "model/simd/pixel_tests.hpp"
#include "model/simd/shade.hpp"
#include "model/stages/distance-inl.hpp"
#include "model/stages/fog-inl.hpp"
#include "model/stages/light-inl.hpp"
#include "model/stages/merge-inl.hpp"
#include "model/stages/project-inl.hpp"
#include "model/stages/texture-inl.hpp"
#include "model/stages/texture_second-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SHADE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SHADE_INL
#undef BITSPAN_MODEL_SIMD_SHADE_INL
#else
#define BITSPAN_MODEL_SIMD_SHADE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// ---------------------------------------------------------------- one integer and lanes, by the same names

template <class V>
inline constexpr std::size_t lanes_in = 1;
template <class T>
inline constexpr std::size_t lanes_in<LanesOf<T>> = LanesOf<T>::count;

template <class V>
HWY_INLINE V load_as(const std::int64_t* p) requires(std::is_same_v<V, std::int64_t>) {
  return *p;
}
template <class V, class T>
HWY_INLINE V load_as(const T* p) requires(std::is_same_v<V, LanesOf<T>>) {
  return V::load(p);
}
HWY_INLINE void store_to(std::int64_t x, std::int64_t* p) { *p = x; }
HWY_INLINE void store_to(Lanes x, std::int64_t* p) { x.store(p); }
HWY_INLINE void store_to(Lanes32 x, std::int64_t* p) {
  HWY_ALIGN std::int32_t raw[Lanes32::count];
  x.store(raw);
  for (std::size_t i = 0; i < Lanes32::count; ++i) p[i] = raw[i];
}
// Values of at most 31 bits, into a column of words.
HWY_INLINE void store_words(std::int64_t x, std::int32_t* p) { *p = static_cast<std::int32_t>(x); }
HWY_INLINE void store_words(Lanes x, std::int32_t* p) {
  HWY_ALIGN std::int64_t raw[Lanes::count];
  x.store(raw);
  for (std::size_t i = 0; i < Lanes::count; ++i) p[i] = static_cast<std::int32_t>(raw[i]);
}
HWY_INLINE void store_words(Lanes32 x, std::int32_t* p) { x.store(p); }
HWY_INLINE void load_words(const std::int32_t* p, std::int64_t& x) { x = *p; }
HWY_INLINE void load_words(const std::int32_t* p, Lanes& x) {
  x = Lanes::from(hn::PromoteTo(Lanes::Tag(), hn::LoadU(hn::Rebind<std::int32_t, Lanes::Tag>(), p)));
}
HWY_INLINE void load_words(const std::int32_t* p, Lanes32& x) { x = Lanes32::load(p); }

HWY_INLINE bool all_of(bool m) { return m; }
template <class T>
HWY_INLINE bool all_of(MaskOf<T> m) {
  return all(m);
}
HWY_INLINE std::size_t count_of(bool m) { return m ? 1 : 0; }
template <class T>
HWY_INLINE std::size_t count_of(MaskOf<T> m) {
  return set_in(m);
}
template <class V>
HWY_INLINE Truth<V> first(std::size_t n) {
  if constexpr (std::is_same_v<V, std::int64_t>) {
    return n != 0;
  } else {
    return first_lanes<typename V::Element>(n);
  }
}
// The observer on fewer lanes.
template <class V>
HWY_INLINE NoObserve on(NoObserve watch, const Truth<V>& /*m*/) {
  return watch;
}
template <class V>
HWY_INLINE BranchFree on(BranchFree watch, const Truth<V>& /*m*/) {
  return watch;
}
template <class V>
HWY_INLINE Observe on(Observe watch, const Truth<V>& /*m*/) {
  return watch;
}
template <class V>
HWY_INLINE ObserveLanes on(ObserveLanes watch, const Lanes::Mask& m) {
  return {watch.statistics, m};
}

// ---------------------------------------------------------------- texels

// i mod size, 0 <= result < size. Twice a quotient in floating point: the first errs by less than
// 2^10 / size + 1 (2^12 with 64 bits) and so leaves a rest below that many sizes, the second by at most 1.
HWY_INLINE Lanes32 modulo(Lanes32 i, std::int32_t size) {
  const Lanes32 n(size);
  if (!any((i < Lanes32(0)) | (i >= n))) return i;
  const hn::ScalableTag<float> d;
  const auto inverse = hn::Set(d, 1.0F / static_cast<float>(size));
  for (int pass = 0; pass < 2; ++pass) {
    const auto q = hn::Floor(hn::Mul(hn::ConvertTo(d, i.v), inverse));
    i = i - Lanes32::from(hn::ConvertTo(Lanes32::Tag(), q)) * n;
  }
  i = i + select(i < Lanes32(0), n, Lanes32(0));
  return i - select(i >= n, n, Lanes32(0));
}
HWY_INLINE Lanes modulo(Lanes i, std::int32_t size) {
  const Lanes n(size);
  if (!any((i < Lanes(0)) | (i >= n))) return i;
  const auto inverse = hn::Set(hn::ScalableTag<double>(), 1.0 / size);
  for (int pass = 0; pass < 2; ++pass) {
    i = i - to_int(hn::Floor(hn::Mul(to_double(i), inverse))) * n;
  }
  i = i + select(i < Lanes(0), n, Lanes(0));
  return i - select(i >= n, n, Lanes(0));
}

// Words at an index, as unsigned numbers where a lane has the room.
HWY_INLINE Lanes32 word_at(const std::uint32_t* words, Lanes32 index) {
  return lookup(reinterpret_cast<const std::int32_t*>(words), index);
}
HWY_INLINE Lanes pair_at(const std::uint32_t* words, Lanes index) {
  return Lanes::from(
      hn::GatherOffset(Lanes::Tag(), reinterpret_cast<const std::int64_t*>(words), (index << 2).v));
}
HWY_INLINE Lanes word_at(const std::uint32_t* words, Lanes index) {
  return pair_at(words, index) & Lanes(0xffffffffLL);
}
// The words at an index and behind it.
template <class V>
struct WordPair {
  V first, second;
};
HWY_INLINE WordPair<Lanes> words_at(const std::uint32_t* words, Lanes index) {
  const Lanes both = pair_at(words, index);
  return {both & Lanes(0xffffffffLL), (both >> 32) & Lanes(0xffffffffLL)};
}
HWY_INLINE WordPair<Lanes32> words_at(const std::uint32_t* words, Lanes32 index) {
#if HWY_TARGET == HWY_AVX2
  // A load per pair: gathers take several times as long on some processors.
  HWY_ALIGN std::int32_t at[Lanes32::count];
  index.store(at);
  const auto pairs_of = [&](std::size_t i, std::size_t k) HWY_ATTR {
    const auto pair = [&](std::size_t l) HWY_ATTR { return reinterpret_cast<const double*>(words + at[l]); };
    const auto both = [&](std::size_t l) HWY_ATTR {
      return _mm_loadh_pd(_mm_loadl_pd(_mm_setzero_pd(), pair(l)), pair(l + 1));
    };
    const auto low = both(i);
    const auto high = both(k);
    return _mm256_castpd_ps(_mm256_insertf128_pd(_mm256_castpd128_pd256(low), high, 1));
  };
  const auto a = pairs_of(0, 4);
  const auto b = pairs_of(2, 6);
  const auto as_words = [](auto x)
                            HWY_ATTR { return Lanes32::from(Lanes32::Vector{_mm256_castps_si256(x)}); };
  return {as_words(_mm256_shuffle_ps(a, b, 0x88)), as_words(_mm256_shuffle_ps(a, b, 0xdd))};
#else
  return {word_at(words, index), word_at(words, index + Lanes32(1))};
#endif
}

// A depth code of 32 bits for signed comparisons: in lanes that have no bit above it.
template <class V>
HWY_INLINE V flipped(V code) {
  if constexpr (sizeof(ElementOf<V>) == 4) {
    return code ^ V(INT32_MIN);
  } else {
    return code;
  }
}

enum class ImageKind : std::uint8_t { none, nearest, bilinear, any };

// A texture of the plan, or none, for the text of texture-inl.hpp; kind other than `any` says what it is.
template <class V, ImageKind kind>
struct PlanImage {
  using T = typename V::Element;
  const ShadeTexture* image;  // null: none
  const T* alphas;
  TextureWrap wrap_u, wrap_v;
  const std::uint32_t* words;
  std::int32_t width, height, border_u, border_v, stride;
  bool reserved, all_opaque;
  // A comparison in the place of texels, as TexelTest; only where the kind is `any`.
  const DepthFormats* depth = nullptr;
  DepthFunc func = DepthFunc::lequal;
  V z{0}, failed{0};
  bool grey = false;  // red, green and blue of every texel are equal

  PlanImage(const ShadePlan& plan, const ShadeTexture* texture) : image(texture) {
    if constexpr (sizeof(T) == 4) {
      alphas = plan.alpha32.data();
    } else {
      alphas = plan.alpha64.data();
    }
    if (image == nullptr) return;
    wrap_u = image->by.wrap_u;
    wrap_v = image->by.wrap_v;
    words = image->words.data();
    width = image->width;
    height = image->height;
    border_u = image->border_u;
    border_v = image->border_v;
    stride = image->stride;
    reserved = image->has_reserved;
    all_opaque = image->opaque;
  }

  HWY_INLINE bool present() const {
    return kind == ImageKind::any ? image != nullptr : kind != ImageKind::none;
  }
  HWY_INLINE TextureFilter filter() const {
    if constexpr (kind == ImageKind::any) {
      return image->by.filter;
    } else {
      return kind == ImageKind::bilinear ? TextureFilter::bilinear : TextureFilter::nearest;
    }
  }
  HWY_INLINE bool may_be_reserved() const { return reserved; }
  HWY_INLINE bool is_grey() const { return kind == ImageKind::any && grey; }

  HWY_INLINE V cyclic(V i, std::int32_t size) const {
    return (size & (size - 1)) == 0 ? i & V(size - 1) : modulo(i, size);
  }
  HWY_INLINE V index(V i, V j) const { return (j + V(border_v)) * V(stride) + i + V(border_u); }
  // Where the copy is the one that is turned round.
  HWY_INLINE V turned_back(V i, std::int32_t size) const {
    return select(i < V(size), i, V(2 * size - 1) - i);
  }
  HWY_INLINE V wrapped(V i, std::int32_t size, TextureWrap wrap) const {
    switch (wrap) {
      case TextureWrap::cyclic:
        return cyclic(i, size);
      case TextureWrap::mirror:
        return turned_back(cyclic(i, 2 * size), size);
      case TextureWrap::border:
        return min(max(i, V(-1)), V(size));
      case TextureWrap::clamp:
        return min(max(i, V(0)), V(size - 1));
    }
    unreachable();
  }
  // What a word stands for. z has the top bit of 32 turned over in lanes of 32 bits.
  HWY_INLINE V taken(V word) const {
    if constexpr (kind == ImageKind::any) {
      if (depth != nullptr) {
        const int bits = depth->z.word;
        const V stored = bits > 31 ? flipped<V>(word) : (word >> (32 - bits)) & V((T{1} << bits) - 1);
        return select(depth_passes(*depth, func, z, stored), V(static_cast<T>(0xffffffffLL)), failed);
      }
    }
    return word;
  }
  HWY_INLINE V nearest(V& i, V& j) const {
    i = wrapped(i, width, wrap_u);
    j = wrapped(j, height, wrap_v);
    return taken(word_at(words, index(i, j)));
  }
  // Where the pair of i stands; i becomes the texel's own.
  HWY_INLINE V pair(V& i, std::int32_t size, TextureWrap wrap) const {
    V at = i;
    switch (wrap) {
      case TextureWrap::cyclic:
        at = i = cyclic(i, size);
        break;
      case TextureWrap::clamp:
        at = min(max(i, V(-1)), V(size - 1));
        i = max(at, V(0));
        break;
      case TextureWrap::mirror:
        // The copy that is turned round stands behind the other one.
        at = cyclic(i, 2 * size);
        i = turned_back(at, size);
        break;
      case TextureWrap::border:
        // A pair that starts at -2 or at the size is outside as a whole.
        at = min(max(i, V(-2)), V(size));
        i = max(at, V(-1));
        break;
    }
    return at;
  }
  HWY_INLINE Quad<V> quad(V& i, V& j) const {
    const V column = pair(i, width, wrap_u);
    const V row = pair(j, height, wrap_v);
    const V at = index(column, row);
    const WordPair<V> upper = words_at(words, at);
    const WordPair<V> lower = words_at(words, at + V(stride));
    return {taken(upper.first), taken(upper.second), taken(lower.first), taken(lower.second)};
  }
  template <class Watch>
  HWY_INLINE V alpha(const TextureStage& stage, V word, Watch watch) const {
    if constexpr (Watch::enabled) {
      return quantize_ratio(channel_of(word, 3), V(255), 0, stage.alpha, watch);
    } else {
      return all_opaque ? V(alphas[255]) : lookup(alphas, channel_of(word, 3));
    }
  }
};

// The image that goes with Int.
template <class Int, ImageKind kind>
HWY_INLINE auto image_for(const ShadePlan& plan, const ShadeFormats& formats, const ShadeTexture* texture) {
  if constexpr (std::is_same_v<Int, int128>) {
    return TextureImage{texture == nullptr ? nullptr : texture->source,
                        texture == nullptr ? TexelLookup{} : texture->by, word_of(formats.texture.border)};
  } else {
    return PlanImage<Int, kind>(plan, texture);
  }
}

// ---------------------------------------------------------------- passes

// What passes between the passes of a block.
template <class T>
struct ShadeColumns {
  HWY_ALIGN T factor[FragmentBlock<T>::padded];
  HWY_ALIGN std::int32_t index[FragmentBlock<T>::padded];    // of the fog table
  HWY_ALIGN std::int64_t recip_m[FragmentBlock<T>::padded];  // linear fog, for records
  HWY_ALIGN std::int64_t recip_e[FragmentBlock<T>::padded];
  HWY_ALIGN std::int32_t word[FragmentBlock<T>::padded];   // r + 256 g + 65536 b; -1: not to be written
  HWY_ALIGN std::int32_t alpha[FragmentBlock<T>::padded];  // of the pixel, where the draw state changes it
};

// The images that a texture unit looks the fragments of a block up in.
struct BlockImages {
  const ShadeTexture* image = nullptr;  // null: none
  Halvings halved{};
  const ShadeTexture* coarser = nullptr;  // the next level, where it has a share
  Halvings coarser_halved{};
};
// What the stage project makes of a block.
template <class T>
struct ProjectColumns {
  HWY_ALIGN T s[FragmentBlock<T>::padded];
  HWY_ALIGN T t[FragmentBlock<T>::padded];
  HWY_ALIGN T z[FragmentBlock<T>::padded];       // with the bias, as PlanImage takes it
  HWY_ALIGN T inside[FragmentBlock<T>::padded];  // 0 or 1
};
// What the two units take of a block.
template <class T>
struct BlockUnits {
  std::array<BlockImages, 2> images;
  std::array<const T*, 2> shares{};              // of the coarser levels; read where there is one
  const ProjectColumns<T>* projected = nullptr;  // where the second unit takes a projector's coordinates
  const T* brightness = nullptr;                 // behind them, where there is a light
};
inline const ShadeTexture* image_of(const ShadeTextures& textures, int texture) {
  return texture < 0 ? nullptr : &textures.whole[static_cast<std::size_t>(texture)];
}
// level: or magnified_level.
inline BlockImages images_of(const ShadePlan& plan, std::size_t unit, int texture, int level, bool mixes) {
  if (texture < 0) return {};
  if (level == magnified_level) return {image_of(plan.magnified_of(unit), texture)};
  const ShadeTextures& textures = plan.textures_of(unit);
  const std::vector<ShadeTexture>& levels = textures.levels[static_cast<std::size_t>(texture)];
  const auto at = [&](int l) {
    return l == 0 ? image_of(textures, texture) : &levels[static_cast<std::size_t>(l - 1)];
  };
  const ShadeTexture& whole = *at(0);
  const auto halved = [&](int l) { return halvings(whole.width, whole.height, l); };
  if (!mixes || level == std::ssize(levels)) return {at(level), halved(level)};
  return {at(level), halved(level), at(level + 1), halved(level + 1)};
}

// Whether pixels i .. i + lanes - 1 of a column follow one another.
HWY_INLINE bool contiguous(const std::int32_t* pixel) {
  return all(Lanes32::load(pixel) == Lanes32::iota(pixel[0]));
}

// The zones of a vector's pixels; 0 past the n-th.
HWY_INLINE Lanes32 zones_at(const std::uint8_t* zones, const std::int32_t* pixel, std::size_t n) {
  const hn::Rebind<std::uint8_t, Lanes32::Tag> bytes;
  if (n >= Lanes32::count && contiguous(pixel)) {
    return Lanes32::from(hn::PromoteTo(Lanes32::Tag(), hn::LoadU(bytes, zones + pixel[0])));
  }
  // A word that starts with the zone's byte.
  const Lanes32 at = select(first_lanes<std::int32_t>(n), Lanes32::load(pixel), Lanes32(0));
  return Lanes32::from(hn::GatherOffset(Lanes32::Tag(), reinterpret_cast<const std::int32_t*>(zones), at.v)) &
         Lanes32(255);
}

template <class T>
HWY_INLINE void table_factors(const FogStage& stage, const ShadePlan& plan, const FragmentBlock<T>& block,
                              PixelGrid grid, ShadeColumns<T>& out) {
  // Of the whole picture, as seen from the grid's first pixel.
  const std::uint8_t* zones = plan.zones.data() + std::int64_t{grid.first_row} * grid.width;
  const std::int32_t* table = plan.fog_table32.data();
  const Lanes32 last(static_cast<std::int32_t>(stage.table.size() - 1));
  for (std::size_t i = 0; i < block.size; i += Lanes32::count) {
    // Lanes past the end hold anything.
    const Lanes32 step = Lanes32::load(block.fog_step + i);
    const Lanes32 zone = zones_at(zones, block.pixel + i, block.size - i);
    const Lanes32 index = fog_index(stage, step, zone) & last;
    index.store(out.index + i);
    if constexpr (sizeof(T) == 4) {
#if HWY_TARGET == HWY_AVX3
      // Neighbours mostly share the step: its entries are one register, where they are sixteen or fewer.
      static_assert(Lanes32::count == 16);
      const std::int32_t one = block.fog_step[i];
      if (stage.zones.bits <= 4 && all(step == Lanes32(one))) {
        const Lanes32 entries = Lanes32::load(table + (one << stage.zones.bits));
        const auto which = hn::IndicesFromVec(Lanes32::Tag(), zone.v);
        Lanes32::from(hn::TableLookupLanes(entries.v, which)).store(out.factor + i);
        continue;
      }
#endif
      lookup(table, index).store(out.factor + i);
    }
  }
  if constexpr (sizeof(T) == 8) {
    for (std::size_t i = 0; i < block.size; ++i) {
      out.factor[i] = stage.table[static_cast<std::size_t>(out.index[i])];
    }
  }
}

// Linear fog for a block of int32: h + B and its reciprocal need 64 bits.
template <bool traced>
HWY_INLINE void linear_factors(const FogStage& stage, const FogFormats& formats_in,
                               const FragmentBlock<std::int32_t>& block, ShadeColumns<std::int32_t>& out) {
  const FogFormats formats = formats_in;
  for (std::size_t i = 0; i < block.size; i += Lanes::count) {
    // Lanes past the end hold anything.
    const LinearFog<Lanes> linear = linear_fog<Lanes>(stage, formats, Lanes::load(block.h + i), NoObserve{});
    store_words(linear.factor, out.factor + i);
    if constexpr (traced) {
      linear.recip_m.store(out.recip_m + i);
      linear.recip_e.store(out.recip_e + i);
    }
  }
}

// Fields that only records hold, lane by lane.
struct ShadeFields {
  static constexpr std::size_t lanes = Lanes32::count;
  HWY_ALIGN std::int64_t i[lanes], j[lanes], ex[lanes], ey[lanes], texel[4][lanes], color[4][lanes],
      killed[lanes], recip_m[lanes], recip_e[lanes], factor[lanes], fogged[3][lanes], merged[3][lanes];
};

template <class T>
void append(const ShadeFields& f, const FragmentBlock<T>& block, std::size_t at, std::size_t lanes,
            const std::int32_t* index, PixelGrid grid, Trace& trace) {
  for (std::size_t l = 0; l < lanes && at + l < block.size; ++l) {
    const std::int64_t triangle = block.triangle[at + l];
    const std::int64_t x = grid.x_of(block.pixel[at + l]);
    const std::int64_t y = grid.y_of(block.pixel[at + l]);
    trace.texture.push_back({triangle, x, y, f.i[l], f.j[l], f.ex[l], f.ey[l], f.texel[0][l], f.texel[1][l],
                             f.texel[2][l], f.texel[3][l], f.color[0][l], f.color[1][l], f.color[2][l],
                             f.color[3][l], f.killed[l]});
    if (f.killed[l] != 0) continue;
    trace.fog.push_back({triangle, x, y, index == nullptr ? -1 : index[at + l], f.recip_m[l], f.recip_e[l],
                         f.factor[l], f.fogged[0][l], f.fogged[1][l], f.fogged[2][l]});
    trace.merge.push_back({triangle, x, y, static_cast<std::uint32_t>(block.z[at + l]), f.merged[0][l],
                           f.merged[1][l], f.merged[2][l]});
  }
}

// The stored colours of a vector's pixels, 32 bits each; 0 where not active.
template <class V>
HWY_INLINE V stored_words(const std::uint8_t* color, const std::int32_t* pixel, std::size_t n) {
  HWY_ALIGN std::int32_t each[lanes_in<V>] = {};
  for (std::size_t l = 0; l < lanes_in<V> && l < n; ++l) {
    std::memcpy(&each[l], color + 4 * static_cast<std::size_t>(pixel[l]), 4);
  }
  V out;
  load_words(each, out);
  return out;
}

// What a unit finds, with levels.
template <class Int, class Image, class Watch>
HWY_INLINE Textured<ValueOf<Int>> found(const TextureStage& stage, const BlockImages& images,
                                        const Image& image, const Image& coarser,
                                        const ElementOf<Int>* shares, ValueOf<Int> u, ValueOf<Int> v,
                                        Watch watch) {
  const auto fraction = [&stage](Halvings halved) {
    return UvFraction{stage.uv.fraction + halved.across, stage.uv.fraction + halved.down};
  };
  Textured<ValueOf<Int>> out = sampled<Int>(stage, image, u, v, fraction(images.halved), watch);
  if (images.coarser != nullptr) {
    mix_level<Int>(stage, sampled<Int>(stage, coarser, u, v, fraction(images.coarser_halved), watch),
                   load_as<ValueOf<Int>>(shares), out, watch);
  }
  return out;
}

// What takes the place of texels, but for the code that set_code gives.
HWY_INLINE void compare(const TextureSecondStage& unit, TextureImage& image) {
  image.test = comparison(unit, 0);
}
template <class V, ImageKind kind>
HWY_INLINE void compare(const TextureSecondStage& unit, PlanImage<V, kind>& image) {
  image.depth = unit.compares ? &unit.depth : nullptr;
  image.func = unit.func;
  image.failed = V(static_cast<ElementOf<V>>(comparison(unit, 0).failed));
  image.grey = unit.compares && unit.constant[0] == unit.constant[1] && unit.constant[1] == unit.constant[2];
}
// z: as ProjectColumns has it.
HWY_INLINE void set_code(std::int64_t z, TextureImage& image) { image.test.z = z; }
template <class V, ImageKind kind>
HWY_INLINE void set_code(V z, PlanImage<V, kind>& image) {
  image.z = z;
}
// What the second unit finds where its coordinates are a projector's.
template <class Int, class Image, class Watch>
HWY_INLINE Textured<ValueOf<Int>> found_projected(const TextureSecondStage& unit, Image& image,
                                                  const ProjectColumns<ElementOf<Int>>& at, std::size_t k,
                                                  Watch watch) {
  using V = ValueOf<Int>;
  const TextureStage& stage = unit.fetch;
  set_code(load_as<V>(at.z + k), image);
  Textured<V> out = sampled<Int>(stage, image, load_as<V>(at.s + k), load_as<V>(at.t + k),
                                 {stage.uv.fraction, stage.uv.fraction}, watch);
  const Truth<V> inside = load_as<V>(at.inside + k) != V(0);
  const std::array<std::int64_t, 3> codes = codes_outside(unit);
  for (std::size_t c = 0; c < 3; ++c) {
    const V code(static_cast<ElementOf<Int>>(codes[c]));
    out.texel[c] = select(inside, out.texel[c], quantize(code, 0, stage.mix, watch));
  }
  out.texel[3] = select(inside, out.texel[3], quantize(V(1), 0, stage.alpha, watch));
  return out;
}

// The second unit's own coordinates, or the first one's.
template <class T>
struct SecondPlaces {
  const T *u, *v;
};
template <class T>
SecondPlaces<T> second_places(const ChannelStage& channels, const FragmentBlock<T>& block) {
  if (channels.second_at >= 0) return {block.u2, block.v2};
  return {block.u, block.v};
}

// What the second unit finds, wherever its coordinates come from.
template <class Int, class Image, class Watch>
HWY_INLINE Textured<ValueOf<Int>> found_second(const TextureSecondStage& unit,
                                               const BlockUnits<ElementOf<Int>>& units,
                                               const FragmentBlock<ElementOf<Int>>& block,
                                               const ChannelStage& channels, Image& image,
                                               const Image& coarser, std::size_t k, Watch watch) {
  using V = ValueOf<Int>;
  if (units.projected != nullptr) return found_projected<Int>(unit, image, *units.projected, k, watch);
  const auto at = second_places(channels, block);
  return found<Int>(unit.fetch, units.images[1], image, coarser, units.shares[1] + k, load_as<V>(at.u + k),
                    load_as<V>(at.v + k), watch);
}

// Q[texture.alpha](v / 255) of a colour on texture.mix.
template <class Int>
struct ShareOfColor {
  using V = ValueOf<Int>;
  const ShadePlan& plan;
  const TextureStage& stage;
  HWY_INLINE V operator()(V v) const {
    if constexpr (std::is_same_v<Int, int128>) {
      return quantize_ratio(v, 255, -stage.mix.fraction, stage.alpha, NoObserve{});
    } else {
      const V index = v - V(static_cast<ElementOf<Int>>(stage.mix.min));
      return lookup(plan.template shares<ElementOf<Int>>().data(), index);
    }
  }
};

// Texture, fog and merge: from the block to out.word. Linear fog's factor comes from out.factor where Int is
// Lanes32, and is formed here elsewhere. any_state: in a draw state that is not the first one, or with
// levels.
template <class Int, ImageKind image_kind, const ShadeFormats* fixed, bool any_state, class Watch>
HWY_NOINLINE void shade_block(const Pipeline& pipeline, const ShadePlan& plan, const ShadeFormats& given,
                              FogMode fog, const BlockUnits<ElementOf<Int>>& units,
                              const FragmentBlock<ElementOf<Int>>& block, const Frame& frame,
                              ShadeColumns<ElementOf<Int>>& out, Counters& counters, Trace* trace,
                              Watch watch_all) {
  using V = ValueOf<Int>;
  constexpr std::size_t lanes = lanes_in<V>;
  const FormatsOf<ShadeFormats, fixed> local(given);
  const ShadeFormats& formats = *local;
  const auto image_of_unit = [&](const ShadeTexture* image)
                                 HWY_ATTR { return image_for<Int, image_kind>(plan, formats, image); };
  const auto image = image_of_unit(units.images[0].image);
  const auto coarser = image_of_unit(units.images[0].coarser);
  auto second = image_of_unit(units.images[1].image);
  const auto second_coarser = image_of_unit(units.images[1].coarser);
  const std::array<std::uint8_t, 3> fog_color = pipeline.fog.fog_color;
  const V opaque = V(static_cast<ElementOf<Int>>(opaque_alpha(formats.merge)));
  if (units.projected != nullptr) compare(pipeline.texture_second, second);
  std::size_t killed = 0;
  for (std::size_t at = 0; at < block.size; at += lanes) {
    const auto active = first<V>(block.size - at);
    const auto watch = on<V>(watch_all, active);
    const std::array<V, 4> shade{load_as<V>(block.r + at), load_as<V>(block.g + at), load_as<V>(block.b + at),
                                 load_as<V>(block.a + at)};
    const V u = load_as<V>(block.u + at);
    const V v = load_as<V>(block.v + at);
    const auto first_found = [&]() HWY_ATTR __attribute__((always_inline)) {
      if constexpr (any_state) {
        return found<Int>(formats.texture, units.images[0], image, coarser, units.shares[0] + at, u, v,
                          watch);
      } else {
        return textured<Int>(formats.texture, image, u, v, shade, watch);
      }
    };
    Textured<V> texel = first_found();
    if constexpr (any_state) {
      const TextureStage& stage = formats.texture;
      const Truth<V> killed_first = texel.killed;
      colour<Int>(stage, shade, texel, watch);
      if (!stage.is_last) {
        const TextureSecondStage& unit = pipeline.texture_second;
        // The colour passes texels that brightness has taken.
        if (!takes_texel(pipeline.light)) {
          const Textured<V> other =
              found_second<Int>(unit, units, block, pipeline.channels, second, second_coarser, at, watch);
          combine<Int>(unit, other.texel, second.is_grey(), ShareOfColor<Int>{plan, unit.fetch}, texel.color,
                       watch);
        }
        texel.killed = killed_first;
        if (unit.fetch.kills_zero) texel.killed = texel.killed | (texel.color[3] == V(0));
      }
      texel.killed = texel.killed | !passes_alpha_test(stage.alpha, stage.alpha_test, texel.color[3]);
    }
    const Truth<V> lives = active & !texel.killed;
    killed += count_of(active & texel.killed);
    const auto watch_lives = on<V>(watch_all, lives);

    std::array<V, 3> own{texel.color[0], texel.color[1], texel.color[2]};
    std::array<V, 3> merged = own;
    LinearFog<V> linear{V(0), V(0), V(0)};
    if (any(lives)) {
      if constexpr (any_state) {
        if (units.brightness != nullptr) {
          const V value = load_as<V>(units.brightness + at);
          for (V& c : own) c = lit<Int>(pipeline.light, c, value, watch_lives);
        }
      }
      if (!has_fog(fog)) {
        linear.factor = quantize(V(1), 0, formats.fog.factor, watch_lives);
        for (V& c : own) c = unfogged(formats.fog, c, watch_lives);
      } else {
        linear.factor = load_as<V>(out.factor + at);
        if constexpr (sizeof(ElementOf<Int>) == 8) {
          if (is_linear_in_distance(fog)) {
            linear = linear_fog<Int>(pipeline.fog, formats.fog, load_as<V>(block.h + at), watch_lives);
          }
        }
        for (std::size_t c = 0; c < 3; ++c) {
          own[c] = fogged<Int>(formats.fog, own[c], fog_color[c], linear.factor, watch_lives);
        }
      }
      if (any_state && !formats.merge.is_plain) {
        if constexpr (any_state) {
          const V stored = stored_words<V>(frame.color.data(), block.pixel + at, block.size - at);
          const V stored_alpha = channel_of(stored, 3);
          for (std::size_t c = 0; c < 3; ++c) {
            merged[c] = mixed<Int>(formats.merge, own[c], {channel_of(stored, c), stored_alpha}, c,
                                   texel.color[3], watch_lives);
          }
        }
      } else if (all_of((texel.color[3] >= opaque) | !lives)) {
        for (std::size_t c = 0; c < 3; ++c) merged[c] = replaced(formats.merge, own[c], watch_lives);
      } else {
        const V stored = stored_words<V>(frame.color.data(), block.pixel + at, block.size - at);
        for (std::size_t c = 0; c < 3; ++c) {
          merged[c] = blended<Int>(formats.merge, own[c], channel_of(stored, c), texel.color[3], watch_lives);
        }
      }
    }
    if constexpr (any_state) {
      if (formats.merge.changes_alpha) {
        const V stored = stored_words<V>(frame.color.data(), block.pixel + at, block.size - at);
        store_words(mixed_alpha<Int>(formats.merge, channel_of(stored, 3), texel.color[3], watch_lives),
                    out.alpha + at);
      }
    }
    store_words(select(lives, merged[0] | merged[1] << 8 | merged[2] << 16, V(-1)), out.word + at);

    // The forms for one kind of image are never traced.
    if (image_kind == ImageKind::any && trace != nullptr) {
      ShadeFields f;
      store_to(texel.i, f.i);
      store_to(texel.j, f.j);
      store_to(texel.ex, f.ex);
      store_to(texel.ey, f.ey);
      for (std::size_t c = 0; c < 4; ++c) {
        store_to(texel.texel[c], f.texel[c]);
        store_to(texel.color[c], f.color[c]);
      }
      store_to(select(texel.killed, V(1), V(0)), f.killed);
      if (sizeof(ElementOf<Int>) == 4 && is_linear_in_distance(fog)) {
        std::memcpy(f.recip_m, out.recip_m + at, lanes * sizeof(std::int64_t));
        std::memcpy(f.recip_e, out.recip_e + at, lanes * sizeof(std::int64_t));
      } else {
        store_to(linear.recip_m, f.recip_m);
        store_to(linear.recip_e, f.recip_e);
      }
      store_to(linear.factor, f.factor);
      for (std::size_t c = 0; c < 3; ++c) {
        store_to(own[c], f.fogged[c]);
        store_to(merged[c], f.merged[c]);
      }
      append(f, block, at, lanes, has_fog_table(fog) ? out.index : nullptr, frame.grid(), *trace);
    }
  }
  counters.killed += killed;
  counters.written += block.size - killed;
}

constexpr auto alpha_byte = static_cast<std::int32_t>(0xff000000U);  // of a colour word

// Words to a plane, where alive is not negative, in the order of the block; `high` is set in each, and the
// bits of `kept` are those that the plane has.
HWY_INLINE void store_pixels(const std::int32_t* words, const std::int32_t* pixel, std::size_t n,
                             std::int32_t high, std::int32_t kept, void* plane, const std::int32_t* alive) {
  auto* bytes = static_cast<std::uint8_t*>(plane);
  const auto place = [&](std::size_t i) { return bytes + 4 * static_cast<std::size_t>(pixel[i]); };
  constexpr std::size_t lanes = Lanes32::count;
  for (std::size_t i = 0; i < n; i += lanes) {
    const Lanes32 x = Lanes32::load(words + i) | Lanes32(high);
    if (i + lanes <= n && contiguous(pixel + i) && all(Lanes32::load(alive + i) >= Lanes32(0))) {
      auto* const to = reinterpret_cast<std::int32_t*>(place(i));
      (kept == 0 ? x : x | (Lanes32::load(to) & Lanes32(kept))).store(to);
      continue;
    }
#if HWY_TARGET == HWY_AVX3
    if (kept == 0) {
      const auto wanted =
          hn::And(first_lanes<std::int32_t>(n - i).m, (Lanes32::load(alive + i) >= Lanes32(0)).m);
      // Lane by lane, the later ones last.
      _mm512_mask_i32scatter_epi32(bytes, wanted.raw, Lanes32::load(pixel + i).v.raw, x.v.raw, 4);
      continue;
    }
#endif
    for (std::size_t l = i; l < i + lanes && l < n; ++l) {
      if (alive[l] < 0) continue;
      std::int32_t stored = 0;
      std::memcpy(&stored, place(l), 4);
      const std::int32_t one = words[l] | high | (stored & kept);
      std::memcpy(place(l), &one, 4);
    }
  }
}

template <class T>
void store_winners(const ShadeColumns<T>& columns, const FragmentBlock<T>& block, const Register& uv,
                   Frame& frame) {
  const double ulp = std::ldexp(1.0, -uv.fraction);
  for (std::size_t i = 0; i < block.size; ++i) {
    if (columns.word[i] < 0) continue;
    write_winner(frame, static_cast<std::size_t>(block.pixel[i]), block.u[i], block.v[i], block.triangle[i],
                 ulp);
  }
}

// ---------------------------------------------------------------- the kernels

template <class T, const ShadeFormats* fixed, class Watch>
void colours(const Pipeline& pipeline, const ShadePlan& plan, int texture, const FragmentBlock<T>& block,
             const Frame& frame, ShadeColumns<T>& columns, Counters& counters, Trace* trace, Watch watch) {
  const BlockUnits<T> units{{BlockImages{image_of(plan.textures_of(0), texture)}, BlockImages{}}};
  const FormatsOf<ShadeFormats, fixed> local(plan.formats);
  const ShadeFormats& formats = *local;
  const FogMode fog = pipeline.fog.mode;
  const auto run = [&]<class Int, ImageKind kind>(FogMode mode, auto w) HWY_ATTR {
    shade_block<Int, kind, fixed, false>(pipeline, plan, plan.formats, mode, units, block, frame, columns,
                                         counters, trace, w);
  };
  constexpr bool of_int32 = sizeof(T) == 4;
  if constexpr (sizeof(T) == 8 && !std::is_same_v<Watch, ObserveLanes>) {
    if (plan.held_in == ShadeLanes::scalar) {
      run.template operator()<int128, ImageKind::any>(fog, watch);
      return;
    }
  }
  if constexpr (std::is_same_v<Watch, Observe>) {
    LaneStatistics seen;
    run.template operator()<Lanes, ImageKind::any>(
        fog, ObserveLanes{&seen, first_lanes<std::int64_t>(Lanes::count)});
    seen.fold(*watch.statistics);
  } else if (of_int32 && plan.branch_free && trace == nullptr) {
    if constexpr (of_int32) {
      using L = LanesOf<T>;
      // Whatever forms the fog's factors, a form without a trace reads them from their column.
      const auto run_kind = [&]<ImageKind kind>() HWY_ATTR {
        has_fog(fog) ? run.template operator()<L, kind>(FogMode::table, BranchFree{})
                     : run.template operator()<L, kind>(FogMode::none, BranchFree{});
      };
      if (texture < 0) {
        run_kind.template operator()<ImageKind::none>();
        return;
      }
      switch (formats.texture.lookup.filter) {
        case TextureFilter::nearest:
          run_kind.template operator()<ImageKind::nearest>();
          break;
        case TextureFilter::bilinear:
          run_kind.template operator()<ImageKind::bilinear>();
          break;
      }
    }
  } else {
    run.template operator()<LanesOf<T>, ImageKind::any>(fog, watch);
  }
}

template <class T, const ShadeFormats* fixed>
void fog_factors(const Pipeline& pipeline, const ShadePlan& plan, const FragmentBlock<T>& block,
                 PixelGrid grid, bool traced, ShadeColumns<T>& columns) {
  const FogMode fog = pipeline.fog.mode;
  if (has_fog_table(fog)) {
    table_factors(pipeline.fog, plan, block, grid, columns);
  }
  if (has_vertex_fog(fog)) std::copy_n(block.fog_factor, block.size, columns.factor);
  if constexpr (sizeof(T) == 4) {
    if (is_linear_in_distance(fog)) {
      const FormatsOf<ShadeFormats, fixed> formats(plan.formats);
      traced ? linear_factors<true>(pipeline.fog, (*formats).fog, block, columns)
             : linear_factors<false>(pipeline.fog, (*formats).fog, block, columns);
    }
  }
}

template <class T, const ShadeFormats* fixed, class Watch>
void shade_watched(const Pipeline& pipeline, const ShadePlan& plan, const BlockDraw& draw,
                   const FragmentBlock<T>& block, Frame& frame, Counters& counters, Trace* trace,
                   Watch watch) {
  ShadeColumns<T> columns;
  fog_factors<T, fixed>(pipeline, plan, block, frame.grid(), trace != nullptr, columns);
  colours<T, fixed>(pipeline, plan, draw.texture, block, frame, columns, counters, trace, watch);
  store_pixels(columns.word, block.pixel, block.size, alpha_byte, 0, frame.color.data(), columns.word);
  if (draw.store_depth) {
    store_pixels(block.z, block.pixel, block.size, 0, 0, frame.depth.data(), columns.word);
  }
  if (!frame.u.empty()) {
    store_winners(columns, block, pipeline.texture.uv, frame);
  }
}

template <class T, const ShadeFormats* fixed>
void shade(const Pipeline& pipeline, const ShadePlan& plan, const BlockDraw& draw,
           const FragmentBlock<T>& block, Frame& frame, Counters& counters, Trace* trace) {
  shade_watched<T, fixed>(pipeline, plan, draw, block, frame, counters, trace, NoObserve{});
}
template <class T, const ShadeFormats* fixed>
void shade_observed(const Pipeline& pipeline, const ShadePlan& plan, const BlockDraw& draw,
                    const FragmentBlock<T>& block, Frame& frame, Counters& counters, Trace* trace,
                    Statistics& statistics) {
  shade_watched<T, fixed>(pipeline, plan, draw, block, frame, counters, trace, Observe{&statistics});
}

// ---------------------------------------------------------------- any draw state, and levels

// The coordinates and the depth code that the second unit takes.
template <class T>
void project_block(const Pipeline& pipeline, const FragmentBlock<T>& block, ProjectColumns<T>& out) {
  const ProjectStage& stage = pipeline.project;
  if (!stage.has_projector) {
    for (T* column : {out.s, out.t, out.z, out.inside}) std::fill_n(column, block.size, T{0});
    return;
  }
  const auto channel = [&](LineId line) { return block.channel[pipeline.channels.place_of(line)]; };
  const std::int64_t* const x = channel(LineId::project_x);
  const std::int64_t* const y = channel(LineId::project_y);
  const std::int64_t* const w = channel(LineId::project_w);
  const bool compares = pipeline.texture_second.compares;
  Lanes places(0);
  Lanes sums(0);
  for (std::size_t k = 0; k < block.size; k += Lanes::count) {
    const Lanes a = Lanes::load(x + k);
    const Lanes b = Lanes::load(y + k);
    const Lanes q = depth_sum<Lanes>(stage, Lanes::load(block.h + k));
    // Lanes past the end hold anything.
    const Lanes::Mask inside = first_lanes<std::int64_t>(block.size - k);
    places = places | select(inside, (a ^ (a >> 63)) | (b ^ (b >> 63)), Lanes(0));
    sums = sums | select(inside, q ^ (q >> 63), Lanes(0));
  }
  const auto fits = [](Lanes magnitudes, int growth) HWY_ATTR {
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < Lanes::count; ++i) all |= static_cast<std::uint64_t>(lane(magnitudes, i));
    return bit_length(all) + growth <= 61;
  };
  // The largest ratio whose product with A_p has 60 bits on the grid of h; B_p is no larger.
  const int128 limit = int128{1} << 60;
  const int128 b_p = on_grid(stage.projector_b, stage.h_grid());
  const int128 most_ratio =
      b_p > limit || b_p < -limit ? -1 : limit / std::max<int128>(1, stage.a.raw << stage.product_up());
  const Lanes most(static_cast<std::int64_t>(most_ratio));
  const Lanes bias(pipeline.texture_second.bias);
  const Lanes zmax(pipeline.texture_second.depth.zmax);
  const bool flips = sizeof(T) == 4 && stage.z.word > 31;
  constexpr NoObserve watch;
  const auto run = [&]<class Int>() HWY_ATTR {
    for (std::size_t k = 0; k < block.size; k += Lanes::count) {
      const Lanes of_w = Lanes::load(w + k);
      const InverseOfW<Lanes> by = inverse_of_w<Lanes>(stage, of_w, watch);
      const Lanes s = place_of<Int>(stage, Lanes::load(x + k), by, watch);
      const Lanes t = place_of<Int>(stage, Lanes::load(y + k), by, watch);
      store_as(out.s + k, s);
      store_as(out.t + k, t);
      store_as(out.inside + k, one_where((of_w > Lanes(0)) & lies_within<Lanes>(stage, s, stage.width) &
                                         lies_within<Lanes>(stage, t, stage.height)));
      if (!compares) continue;
      const Lanes ratio = ratio_of<Int>(stage, depth_sum<Lanes>(stage, Lanes::load(block.h + k)), by, watch);
      const bool is_small = stage.z_bits <= 61 && !any((ratio > most) | (ratio < -most));
      const Lanes code = is_small
                             ? code_of<Lanes>(stage, far_h_of<Lanes>(stage, ratio, watch), watch)
                             : code_of<WideLanes>(stage, far_h_of<WideLanes>(stage, ratio, watch), watch);
      const Lanes z = min(max(code + bias, Lanes(0)), zmax);
      store_as(out.z + k, flips ? z ^ Lanes(INT32_MIN) : z);
    }
  };
  if (fits(places, stage.place_growth) && fits(sums, stage.ratio_growth)) {
    run.template operator()<Lanes>();
  } else {
    run.template operator()<WideLanes>();
  }
}

// What light takes of the second unit: texels, and the red one's share.
struct SecondColumns {
  HWY_ALIGN std::int64_t texel[3][FragmentBlock<std::int64_t>::padded];
  HWY_ALIGN std::int64_t share[FragmentBlock<std::int64_t>::padded];
};
template <class Int, class Watch>
void find_texels(const Pipeline& pipeline, const ShadePlan& plan, const ShadeFormats& formats,
                 const BlockUnits<ElementOf<Int>>& units, const FragmentBlock<ElementOf<Int>>& block,
                 SecondColumns& out, Watch watch) {
  const auto image_of_unit = [&](const ShadeTexture* image)
                                 HWY_ATTR { return image_for<Int, ImageKind::any>(plan, formats, image); };
  const TextureSecondStage& unit = pipeline.texture_second;
  auto image = image_of_unit(units.images[1].image);
  const auto coarser = image_of_unit(units.images[1].coarser);
  if (units.projected != nullptr) compare(unit, image);
  for (std::size_t k = 0; k < block.size; k += lanes_in<ValueOf<Int>>) {
    const auto texel =
        found_second<Int>(unit, units, block, pipeline.channels, image, coarser, k, watch).texel;
    for (std::size_t c = 0; c < 3; ++c) store_to(texel[c], out.texel[c] + k);
    if (pipeline.light.has_shadow) store_to(ShareOfColor<Int>{plan, unit.fetch}(texel[0]), out.share + k);
  }
}

// The brightness per pixel in lanes; second: where light takes texels. Wide: what the square of a channel's
// normal fits.
template <class Wide, class T>
void brighten_block(const Pipeline& pipeline, const FragmentBlock<T>& block, PixelGrid grid,
                    const SecondColumns* second, T* out) {
  const LightStage& light = pipeline.light;
  const ChannelStage& channels = pipeline.channels;
  const auto second_at = second_places(channels, block);
  const auto wide = hn::Set(hn::ScalableTag<double>(), static_cast<double>(grid.width));
  constexpr NoObserve watch;
  for (std::size_t k = 0; k < block.size; k += Lanes::count) {
    const auto active = first<Lanes>(block.size - k);
    const auto at = [&](const auto* column)
                        HWY_ATTR { return select(active, load_wide(column + k), Lanes(0)); };
    const auto channel = [&](int first) HWY_ATTR {
      const auto* const of = block.channel + first;
      return VectorOf<Lanes>{at(of[0]), at(of[1]), at(of[2])};
    };
    Lanes x(0), y(0), s(0);
    TowardOf<Lanes> toward{{Lanes(0), Lanes(0), Lanes(0)}, Lanes(0), Lanes(0)};
    if (light.takes_place && (!light.has_map || light.falls)) {
      const Lanes pixel = at(block.pixel);
      y = to_int(hn::Div(to_double(pixel), wide));  // exact: both have 31 bits at most
      x = pixel - y * Lanes(grid.width);
      y = y + Lanes(grid.first_row);
      s = distance_point<Lanes>(pipeline.distance, at(block.h), watch).s;
    }
    const auto from_here = [&]<class Product>() HWY_ATTR {
      return toward_light<Lanes, WideLanes, Product>(light, (x << 1) + Lanes(1), (y << 1) + Lanes(1), 1, s,
                                                     light.pixel_s.fraction, watch);
    };
    if (!light.has_map || light.falls) {
      toward = light.places_fit_int64 ? from_here.template operator()<Lanes>()
                                      : from_here.template operator()<WideLanes>();
    }
    if (light.has_shadow) toward.share = at(second->share);
    if (!light.has_map) {
      store_as(out + k, shine<Lanes, Wide>(light, channel(channels.normal_at), light.given_normal.fraction,
                                           toward, watch)
                            .value);
      continue;
    }
    toward.direction = direction_in_field<Lanes, WideLanes>(light, channel(channels.relief_at),
                                                            at(second_at.u), at(second_at.v), watch);
    const VectorOf<Lanes> texel{at(second->texel[0]), at(second->texel[1]), at(second->texel[2])};
    store_as(
        out + k,
        shine<Lanes, WideLanes>(light, normal_of(light, texel), light.texel.fraction, toward, watch).value);
  }
}

// The brightness of a block's fragments; grid: of the frame; second: where light takes texels.
template <class T>
void light_block(const Pipeline& pipeline, const ShadePlan& plan, const FragmentBlock<T>& block,
                 PixelGrid grid, const SecondColumns* second, T* out) {
  const ChannelStage& channels = pipeline.channels;
  if (channels.light_at >= 0) {
    const std::int64_t* const values = block.channel[channels.light_at];
    for (std::size_t k = 0; k < block.size; ++k) out[k] = static_cast<T>(values[k]);
    return;
  }
  if (plan.holds_brightness) {
    plan.normals_fit_int64 ? brighten_block<Lanes>(pipeline, block, grid, second, out)
                           : brighten_block<WideLanes>(pipeline, block, grid, second, out);
    return;
  }
  LightRecord record;
  TextureRecord texel{};
  for (std::size_t k = 0; k < block.size; ++k) {
    const FragmentRecord fragment = fragment_of(block, k, grid);
    const auto channel = [&](int at) {
      const auto* const of = block.channel + at;
      return std::array{of[0][k], of[1][k], of[2][k]};
    };
    LightChannels given;
    if (!pipeline.light.has_map) {
      given.normal = channel(channels.normal_at);
    } else {
      const auto at = second_places(channels, block);
      given.place = channel(channels.relief_at);
      given.at = {at.u[k], at.v[k]};
    }
    if (second != nullptr) {
      texel.texel_r = second->texel[0][k];
      texel.texel_g = second->texel[1][k];
      texel.texel_b = second->texel[2][k];
    }
    brighten(pipeline.light, fragment, distance_of(pipeline, fragment), given, texel, record);
    out[k] = static_cast<T>(record.value);
  }
}

// What passes between the steps of a block, per texture unit where there are two.
template <class T>
struct AnyColumns {
  std::array<LevelColumns<T>, 2> levels;
  // The fragments that look up the same levels.
  FragmentBlock<T> part;
  ProjectColumns<T> part_projected;
  HWY_ALIGN T part_brightness[FragmentBlock<T>::padded];
  HWY_ALIGN T shares[2][FragmentBlock<T>::padded];
  HWY_ALIGN std::int32_t places[FragmentBlock<T>::padded];  // in the block
  ShadeColumns<T> of_part;
};

template <class T>
void colours_any(const Pipeline& pipeline, const ShadePlan& plan, const ShadeFormats& formats,
                 BlockUnits<T> units, const FragmentBlock<T>& block, const Frame& frame,
                 ShadeColumns<T>& columns, Counters& counters) {
  const FogMode fog = pipeline.fog.mode;
  fog_factors<T, nullptr>(pipeline, plan, block, frame.grid(), false, columns);
  for (std::size_t k = 0; takes_distance(fog) && k < block.size; ++k) {
    const FragmentRecord fragment = fragment_of(block, k, frame.grid());
    columns.factor[k] =
        static_cast<T>(fog_factor(pipeline.fog, fragment, distance_of(pipeline, fragment)).factor);
  }
  HWY_ALIGN T brightness[FragmentBlock<T>::padded];
  const auto run = [&]<class Int>(auto watch) HWY_ATTR {
    if (takes_texel(pipeline.light)) {
      SecondColumns second;
      find_texels<Int>(pipeline, plan, formats, units, block, second, watch);
      light_block(pipeline, plan, block, frame.grid(), &second, brightness);
      units.brightness = brightness;
    }
    shade_block<Int, ImageKind::any, nullptr, true>(pipeline, plan, formats, fog, units, block, frame,
                                                    columns, counters, nullptr, watch);
  };
  if constexpr (sizeof(T) == 4) {
    run.template operator()<Lanes32>(BranchFree{});
  } else if (plan.held_in == ShadeLanes::scalar) {
    run.template operator()<int128>(NoObserve{});
  } else {
    run.template operator()<Lanes>(NoObserve{});
  }
}

// The fragments among a block's that look up these levels. Returns whether there are some.
template <class T>
bool take_levels(const Pipeline& pipeline, const FragmentBlock<T>& from, const BlockUnits<T>& units,
                 const std::array<std::int32_t, 2>& levels, AnyColumns<T>& any) {
  const ChannelStage& channels = pipeline.channels;
  FragmentBlock<T>& to = any.part;
  std::size_t n = 0;
  for (std::size_t i = 0; i < from.size; ++i) {
    any.places[n] = static_cast<std::int32_t>(i);
    n += any.levels[0].level[i] == levels[0] && any.levels[1].level[i] == levels[1] ? 1 : 0;
  }
  to.size = n;
  const auto take = [&](const auto& column, auto& out) {
    for (std::size_t k = 0; k < n; ++k) out[k] = column[any.places[k]];
  };
  take(from.pixel, to.pixel);
  take(from.u, to.u);
  take(from.v, to.v);
  if (channels.second_at >= 0) {
    take(from.u2, to.u2);
    take(from.v2, to.v2);
  }
  take(from.r, to.r);
  take(from.g, to.g);
  take(from.b, to.b);
  take(from.a, to.a);
  take(from.fog_step, to.fog_step);
  take(from.fog_factor, to.fog_factor);
  take(from.h, to.h);
  // What light takes of the channels, where it takes texels besides.
  const int at = pipeline.light.has_map ? channels.relief_at : channels.normal_at;
  for (int c = at; takes_texel(pipeline.light) && c < at + 3; ++c) take(from.channel[c], to.channel[c]);
  for (std::size_t unit = 0; unit < 2; ++unit) take(any.levels[unit].share, any.shares[unit]);
  if (units.projected != nullptr) {
    take(units.projected->s, any.part_projected.s);
    take(units.projected->t, any.part_projected.t);
    take(units.projected->z, any.part_projected.z);
    take(units.projected->inside, any.part_projected.inside);
  }
  if (units.brightness != nullptr) take(units.brightness, any.part_brightness);
  return n != 0;
}

// Finds the levels, and shades the fragments of each on their own. textures: of the units, -1 for none;
// units: without images.
template <class T>
void colours_of_levels(const Pipeline& pipeline, const ShadePlan& plan, const ShadeFormats& formats,
                       const std::array<int, 2>& textures, const FragmentBlock<T>& block, BlockUnits<T> units,
                       const TriangleGradients& gradients, const Frame& frame, ShadeColumns<T>& columns,
                       Counters& counters) {
  AnyColumns<T> any;
  const auto levels_of = [&](int texture) {
    return texture < 0
               ? 1
               : static_cast<int>(pipeline.mip_chains.all()[static_cast<std::size_t>(texture)].size());
  };
  find_levels(pipeline, block, {levels_of(textures[0]), levels_of(textures[1])}, gradients, frame.grid(),
              any.levels);
  // A projector's coordinates have the texture itself.
  if (units.projected != nullptr) std::fill_n(any.levels[1].level, block.size, 0);
  std::array<std::int32_t, 2> least{}, most{};
  for (std::size_t unit = 0; unit < 2; ++unit) {
    const std::int32_t* of = any.levels[unit].level;
    const auto [low, high] = std::minmax_element(of, of + block.size);
    least[unit] = *low;
    most[unit] = *high;
  }
  const bool mixes = formats.texture.mixes_levels;
  const auto images = [&](const std::array<std::int32_t, 2>& levels) {
    return std::array{images_of(plan, 0, textures[0], levels[0], mixes),
                      images_of(plan, 1, textures[1], levels[1], mixes)};
  };
  if (least == most) {
    units.images = images(least);
    units.shares = {any.levels[0].share, any.levels[1].share};
    colours_any<T>(pipeline, plan, formats, units, block, frame, columns, counters);
    return;
  }
  for (std::array<std::int32_t, 2> levels = least; levels[0] <= most[0]; ++levels[0]) {
    for (levels[1] = least[1]; levels[1] <= most[1]; ++levels[1]) {
      if (!take_levels(pipeline, block, units, levels, any)) continue;
      colours_any<T>(pipeline, plan, formats,
                     {images(levels),
                      {any.shares[0], any.shares[1]},
                      units.projected == nullptr ? nullptr : &any.part_projected,
                      units.brightness == nullptr ? nullptr : any.part_brightness},
                     any.part, frame, any.of_part, counters);
      for (std::size_t k = 0; k < any.part.size; ++k) {
        columns.word[any.places[k]] = any.of_part.word[k];
        columns.alpha[any.places[k]] = any.of_part.alpha[k];
      }
    }
  }
}

// Texture, fog and merge, with projection, levels and light where the state has them.
template <class T>
void shade_units(const Pipeline& pipeline, const ShadePlan& plan, const ShadeFormats& formats,
                 const std::array<int, 2>& textures, const FragmentBlock<T>& block,
                 const TriangleGradients& gradients, const Frame& frame, ShadeColumns<T>& columns,
                 Counters& counters) {
  BlockUnits<T> units;
  ProjectColumns<T> projected;
  if (pipeline.project.is_on && pipeline.texture_second.is_on()) {
    project_block(pipeline, block, projected);
    units.projected = &projected;
  }
  HWY_ALIGN T brightness[FragmentBlock<T>::padded];
  if (pipeline.light.is_on && !takes_texel(pipeline.light)) {
    light_block(pipeline, plan, block, frame.grid(), nullptr, brightness);
    units.brightness = brightness;
  }
  if (pipeline.has_lod && (textures[0] >= 0 || textures[1] >= 0)) {
    colours_of_levels(pipeline, plan, formats, textures, block, units, gradients, frame, columns, counters);
  } else {
    for (std::size_t unit = 0; unit < 2; ++unit) {
      units.images[unit] = BlockImages{image_of(plan.textures_of(unit), textures[unit])};
    }
    colours_any(pipeline, plan, formats, units, block, frame, columns, counters);
  }
}

// Whether no fragment of a block can be killed, as far as that is seen at once: all have one alpha, and
// opaque texels.
template <class T>
bool kills_none(const Pipeline& pipeline, const ShadePlan& plan, const BlockDraw& draw,
                const FragmentBlock<T>& block) {
  if (!kills_by_alpha_alone(pipeline)) return false;
  const TextureStage& stage = pipeline.texture;
  if (draw.texture >= 0) {
    const ShadeTexture& image = *image_of(plan.textures_of(0), draw.texture);
    if (!image.opaque || !image.never_killed) return false;
  }
  const T a = block.a[0];
  const bool is_one_alpha = std::all_of(block.a, block.a + block.size, [a](T b) { return a == b; });
  return is_one_alpha && (!stage.kills_zero || alpha_of(plan, std::int64_t{a}) != 0);
}

template <class T>
void shade_any(const Pipeline& pipeline, const ShadePlan& plan, const BlockDraw& draw,
               const FragmentBlock<T>& block, const TriangleGradients& gradients, Frame& frame,
               Counters& counters) {
  ShadeColumns<T> columns;
  const WriteMask mask = write_mask(pipeline.state);
  const ShadeFormats formats{pipeline.texture, plan.formats.fog, pipeline.merge};
  const std::array<int, 2> textures{draw.texture, pipeline.state.texture1};
  if (!mask.color && kills_none(pipeline, plan, draw, block)) {
    // As of a shadow map: depth alone is written.
    std::fill_n(columns.word, block.size, 0);
    counters.written += block.size;
  } else {
    shade_units(pipeline, plan, formats, textures, block, gradients, frame, columns, counters);
  }
  if (is_late(pipeline.state.depth_when)) {
    const PixelTests tests{pipeline, draw.back, frame, counters};
    for (std::size_t i = 0; i < block.size; ++i) {
      if (columns.word[i] < 0 ||
          tests.passes(static_cast<std::uint32_t>(block.z[i]), static_cast<std::size_t>(block.pixel[i]))) {
        continue;
      }
      columns.word[i] = -1;
      --counters.written;
    }
  }
  const bool writes_every_channel = mask.channels == 15;
  if (mask.color && writes_every_channel && !pipeline.merge.changes_alpha) {
    store_pixels(columns.word, block.pixel, block.size, 0, alpha_byte, frame.color.data(), columns.word);
  } else if (mask.color) {
    for (std::size_t i = 0; i < block.size; ++i) {
      if (columns.word[i] < 0) continue;
      const std::int32_t pixel = block.pixel[i];
      std::uint8_t* color = frame.color.data() + 4 * static_cast<std::size_t>(pixel);
      std::array<std::uint8_t, 4> codes{0, 0, 0, color[3]};
      std::memcpy(codes.data(), &columns.word[i], 3);
      if (pipeline.merge.changes_alpha) {
        codes[3] = static_cast<std::uint8_t>(columns.alpha[i]);
        codes = held(pipeline.merge, codes, frame.grid().x_of(pixel), frame.grid().y_of(pixel));
      }
      if (writes_every_channel) {
        std::memcpy(color, codes.data(), codes.size());
        continue;
      }
      for (int c = 0; c < 4; ++c) {
        if (mask.stores(c)) color[c] = codes[static_cast<std::size_t>(c)];
      }
    }
  }
  if (mask.color && !frame.u.empty()) store_winners(columns, block, pipeline.texture.uv, frame);
  if (mask.depth && draw.store_depth) {
    store_pixels(block.z, block.pixel, block.size, 0, 0, frame.depth.data(), columns.word);
  }
}

// The kernels; fixed: a shipped configuration's formats, null for those of the plan.
template <class T, const ShadeFormats* fixed>
ShadeKernels<T> shade_table() {
  ShadeKernels<T> out;
  out.shade = &shade<T, fixed>;
  if constexpr (fixed == nullptr) out.shade_any = &shade_any<T>;
  if constexpr (sizeof(T) == 8) {
    out.shade_observed = &shade_observed<T, fixed>;
  }
  return out;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
