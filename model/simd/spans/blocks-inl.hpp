// SPDX-License-Identifier: Apache-2.0
// Fragments put into blocks: h, fu, fv and shades span by span; u and v densely, when the block is given
// away.
#include <array>
#include <cstdint>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/simd/spans/halves-inl.hpp"
#include "model/simd/spans/ramps-inl.hpp"
#include "model/stages/fog-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_BLOCKS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_BLOCKS_INL
#undef BITSPAN_MODEL_SIMD_SPANS_BLOCKS_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_BLOCKS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

// Bits of the largest magnitude among the lanes of x, of which each is an or of x ^ (x >> 63).
HWY_INLINE int bits_of(Lanes x) {
  HWY_ALIGN std::int64_t raw[Lanes::count];
  x.store(raw);
  std::uint64_t all = 0;
  for (const std::int64_t v : raw) all |= static_cast<std::uint64_t>(v);
  return bit_length(all);
}
HWY_INLINE Lanes magnitude(Lanes x) { return x ^ (x >> 63); }

// Whether u and v of fragments with such numerators and bases can be formed in 64 bits, whatever the formats
// would allow.
bool fits_lanes(const SpanStage& stage, Lanes numerators, Lanes bases) {
  return stage.fits_int64 ||
         (has_pixel_reciprocal(stage.formats.perspective) &&
          bits_of(numerators) + stage.product_growth <= 61 && bits_of(bases) + stage.base_growth <= 61);
}

// A shade of the fragments whose accumulators these are.
template <class Watch>
HWY_INLINE Lanes shade_of(const SpanStage& stage, const SpanFormats& f, Lanes acc, Watch watch) {
  if (stage.shade_fits_int64) [[likely]] {
    return quantize(acc, f.shade_acc.acc.fraction, f.shade, watch);
  }
  return quantize(WideLanes(acc), f.shade_acc.acc.fraction, f.shade, watch);
}

// Fills blocks: ramps first, span by span; u and v when the block is given away, densely.
template <class T, class Watch, const SpanFormats* fixed>
class Filler {
 public:
  Filler(const Pipeline& pipeline, SpanWork<T>& work, BlockSink<T>& sink)
      : pipeline_(pipeline), work_(work), block_(work.block), sink_(sink) {
    block_.size = 0;
  }
  // Before the fragments of a triangle.
  HWY_INLINE void join(const SpanDraw& draw, std::int64_t triangle) {
    const bool may =
        draw.texture == draw_.texture && ((draw.shared && draw_.shared) || triangle == triangle_);
    if (!may) {
      if (block_.size != 0) flush();
      draw_ = draw;
    }
    triangle_ = triangle;
  }
  // Room for n more, at most block_size.
  HWY_INLINE void need(std::size_t n) {
    if (block_.size + n > block_size) flush();
  }
  HWY_NOINLINE void flush() {
    if (block_.size == 0) return;
    Lanes numerators(0);
    Lanes bases(0);
    if (!pipeline_.span.fits_int64) {
      for (std::size_t k = 0; k < block_.size; k += Lanes::count) {
        numerators = numerators | magnitude(Lanes::load(work_.fu + k)) | magnitude(Lanes::load(work_.fv + k));
        bases = bases | magnitude(Lanes::load(work_.u1 + k)) | magnitude(Lanes::load(work_.v1 + k));
      }
    }
    divided_ = 0;
    for (std::size_t c = 0; c < pipeline_.channels.in_use.size(); ++c) take_divided(c);
    if (fits_lanes(pipeline_.span, numerators, bases)) {
      evaluate<Lanes>();
    } else {
      evaluate<WideLanes>();
    }
    sink_(block_, {draw_.texture, !draw_.shared, draw_.back});
    block_.size = 0;
  }
  // Fragments at index[0 .. n) of a span. There is room.
  HWY_INLINE void put(const Sequences& s, std::int64_t u1, std::int64_t v1, std::int64_t first_pixel,
                      const std::int32_t* index, std::size_t n) {
    const FormatsOf<SpanFormats, fixed> f(pipeline_.span.formats);
    const std::array<T*, 4> shades{block_.r, block_.g, block_.b, block_.a};
    const auto triangle = static_cast<std::int32_t>(triangle_);
    const std::size_t linear_shades = pipeline_.channels.shades_at < 0 ? channel_count : 0;
    for (std::size_t k = 0; k < n; k += Lanes::count) {
      const std::size_t to = block_.size + k;
      const HalfVector half = hn::LoadU(Half(), index + k);
      const Lanes place = widened(half);
      at(s[0], place).store(block_.h + to);
      at(s[1], place).store(work_.fu + to);
      at(s[2], place).store(work_.fv + to);
      Lanes(u1).store(work_.u1 + to);
      Lanes(v1).store(work_.v1 + to);
      hn::StoreU(hn::Add(half, hn::Set(Half(), static_cast<std::int32_t>(first_pixel))), Half(),
                 block_.pixel + to);
      hn::StoreU(hn::Set(Half(), triangle), Half(), block_.triangle + to);
      if constexpr (sizeof(T) == sizeof(std::int64_t)) {
        for (std::size_t c = 0; c < linear_shades; ++c) {
          shade_of(pipeline_.span, *f, at(s[3 + c], place), Watch{}).store(shades[c] + to);
        }
      }
    }
    if constexpr (sizeof(T) == sizeof(std::int32_t)) {
      for (std::size_t k = 0; k < n; k += Lanes32::count) {
        const Lanes32 place = Lanes32::load(index + k);
        for (std::size_t c = 0; c < linear_shades; ++c) {
          quantize(at32(s[3 + c], place), (*f).shade_acc.acc.fraction, (*f).shade, Watch{})
              .store(shades[c] + block_.size + k);
        }
      }
    }
    block_.size += n;
  }
  // The channels of the same fragments, in front of put.
  HWY_INLINE void put_channels(const PerChannel<Sequence>& s, const std::int32_t* index, std::size_t n) {
    for (std::size_t c = 0; c < pipeline_.channels.in_use.size(); ++c) {
      const ChannelForm& form = pipeline_.channels.in_use[c];
      for (std::size_t k = 0; k < n; k += Lanes::count) {
        const Lanes place = widened(hn::LoadU(Half(), index + k));
        const Lanes acc = at(s[c], place);
        const Lanes value =
            form.span_divides ? acc : quantize(acc, form.acc.fraction, form.value, NoObserve{});
        value.store(block_.channel[c] + block_.size + k);
        if (form.line == LineId::fog) store_as(block_.fog_factor + block_.size + k, value);
      }
    }
  }
  FragmentBlock<T>& block() { return block_; }
  bool shared() const { return draw_.shared; }

 private:
  // A channel that the span divides: where it goes, and whether its products need 128 bits.
  struct Divided {
    const ChannelForm* form;
    const std::int64_t* acc;
    T* to;
    bool is_wide;
  };
  void take_divided(std::size_t c) {
    const ChannelStage& stage = pipeline_.channels;
    const ChannelForm& form = stage.in_use[c];
    if (!form.span_divides) return;
    const std::int64_t* acc = block_.channel[c];
    Lanes all(0);
    for (std::size_t k = 0; k < block_.size; k += Lanes::count) all = all | magnitude(Lanes::load(acc + k));
    const std::array<T*, 4> shades{block_.r, block_.g, block_.b, block_.a};
    const int place = static_cast<int>(c);
    T* const to = stage.second_at >= 0 && place >= stage.second_at
                      ? (place == stage.second_at ? block_.u2 : block_.v2)
                      : shades[static_cast<std::size_t>(place - stage.shades_at)];
    of_divided_[divided_++] = {&form, acc, to, bits_of(all) + form.product_growth > 61};
  }
  // q: h + B; recip_m, recip_e: of it, where the mode takes it.
  HWY_INLINE void divide(const SpanFormats& f, Lanes q, Lanes recip_m, Lanes recip_e, std::size_t k) {
    constexpr NoObserve watch;
    for (std::size_t i = 0; i < divided_; ++i) {
      const auto& [form, column, to, is_wide] = of_divided_[i];
      const Lanes acc = Lanes::load(column + k);
      if (!pipeline_.channels.by_reciprocal) {
        const Lanes d = at_least_one(q);
        store_as(to + k, quantize_ratio(acc, d, f.q_fraction - form->acc.fraction, form->value, watch));
        continue;
      }
      const Lanes fraction = recip_e + Lanes(form->acc.fraction + f.reciprocal.output.fraction);
      store_as(to + k, is_wide ? quantize(times<WideLanes>(acc, recip_m), fraction, form->value, watch)
                               : quantize(times<Lanes>(acc, recip_m), fraction, form->value, watch));
    }
  }

  // A ramp of a register of at most 31 bits, in whose range all its values are.
  HWY_INLINE Lanes32 at32(const Sequence& s, Lanes32 index) {
    if (s.values != nullptr) [[unlikely]] {
      HWY_ALIGN std::int32_t places[Lanes32::count];
      HWY_ALIGN std::int32_t out[Lanes32::count];
      index.store(places);
      for (std::size_t i = 0; i < Lanes32::count; ++i) {
        out[i] = static_cast<std::int32_t>(s.values[static_cast<std::size_t>(places[i])]);
      }
      return Lanes32::load(out);
    }
    return Lanes32(static_cast<std::int32_t>(s.start)) +
           index * Lanes32(static_cast<std::int32_t>(s.increment));
  }
  template <class Int>
  HWY_INLINE void evaluate() {
    const SpanStage& stage = pipeline_.span;
    const FormatsOf<SpanFormats, fixed> formats(stage.formats);
    const SpanFormats& f = *formats;
    const bool aligned = stage.aligned;
    const std::int64_t* table = stage.reciprocal.table().data();
    const Lanes b(static_cast<std::int64_t>(stage.q.b));
    for (std::size_t k = 0; k < block_.size; k += Lanes::count) {
      const auto point = texture_point<Int>(f, b, table, Lanes::load(block_.h + k), Lanes::load(work_.fu + k),
                                            Lanes::load(work_.fv + k), Lanes::load(work_.u1 + k),
                                            Lanes::load(work_.v1 + k), aligned, Watch{});
      store_as(block_.u + k, point.u);
      store_as(block_.v + k, point.v);
      if (divided_ != 0) {
        divide(f, (Lanes::load(block_.h + k) << f.h_up) + b, point.recip_m, point.recip_e, k);
      }
    }
    if (has_fog_table(pipeline_.fog.mode)) {
      for (std::size_t k = 0; k < block_.size; k += Lanes::count) {
        store_as(block_.fog_step + k, fog_step(pipeline_.fog, Lanes::load(block_.h + k)));
      }
    }
  }

  const Pipeline& pipeline_;
  SpanWork<T>& work_;
  FragmentBlock<T>& block_;
  BlockSink<T>& sink_;
  SpanDraw draw_;
  std::int64_t triangle_ = -1;
  std::array<Divided, channel_limit> of_divided_;  // the first `divided_` of them
  std::size_t divided_ = 0;
};

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
