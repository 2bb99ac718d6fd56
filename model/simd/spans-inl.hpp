// The kernels of spans.hpp, for formats read at run time (fixed null) or compiled in.
#include <algorithm>
#include <bit>
#include <cstring>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/numeric/ramp-inl.hpp"
#include "model/simd/fixed.hpp"
#include "model/simd/spans.hpp"
#include "model/stages/depth-inl.hpp"
#include "model/stages/fog-inl.hpp"
#include "model/stages/span-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_INL
#undef BITSPAN_MODEL_SIMD_SPANS_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

constexpr std::size_t registers = 7;
constexpr std::array<std::int64_t SpanRecord::*, registers> starts{
    &SpanRecord::h, &SpanRecord::fu, &SpanRecord::fv, &SpanRecord::r,
    &SpanRecord::g, &SpanRecord::b,  &SpanRecord::a};
constexpr std::array<std::int64_t SpanRecord::*, registers> steps{
    &SpanRecord::h_step,  &SpanRecord::fu_step0, &SpanRecord::fv_step0, &SpanRecord::r_step0,
    &SpanRecord::g_step0, &SpanRecord::b_step0,  &SpanRecord::a_step0};

const Adder& adder_of(const SpanFormats& f, std::size_t i) {
  return i == 0 ? f.h : i < 3 ? f.f : f.shade_acc;
}

// ---------------------------------------------------------------- ramps

// Every span's increments, and whether all of its registers are ramps.
template <const SpanFormats* fixed>
void find_ramps(const SpanFormats& given, const Columns<SpanRecord>& spans, Ramps& out) {
  const FormatsOf<SpanFormats, fixed> formats(given);
  const SpanFormats& f = *formats;
  const std::size_t padded = spans.size + column_slack;
  if (out.linear.size() < padded) {
    out.linear.resize(padded);
    for (auto& column : out.increment) column.resize(padded);
  }
  constexpr int steps_bits = 20;  // of a span's length
  for (std::size_t i = 0; i < spans.size; i += Lanes::count) {
    const Lanes last = Lanes::load(spans[&SpanRecord::count] + i) - Lanes(1);
    Lanes::Mask linear = last < Lanes(std::int64_t{1} << steps_bits);
    for (std::size_t k = 0; k < registers; ++k) {
      const RampLanes ramp = make_ramp(adder_of(f, k), Lanes::load(spans[starts[k]] + i),
                                       Lanes::load(spans[steps[k]] + i), last, steps_bits);
      linear = linear & ramp.linear;
      ramp.increment.store(out.increment[k].data() + i);
    }
    one_where(linear).store(out.linear.data() + i);
  }
}

// A register along its span: a ramp, or one value a pixel.
struct Sequence {
  std::int64_t start = 0, increment = 0;
  const std::int64_t* values = nullptr;
};
HWY_INLINE Lanes at(const Sequence& s, Lanes index) {
  if (s.values != nullptr) [[unlikely]] {
    return lookup(s.values, index);
  }
  return Lanes(s.start) + index * Lanes(s.increment);
}
using Sequences = std::array<Sequence, registers>;
HWY_INLINE bool is_ramp(const Sequence& s) { return s.values == nullptr; }

// One by one, as the scalar stage does it.
template <class T, class Watch>
HWY_NOINLINE void walk_registers(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                                 SpanWork<T>& work, Sequences& out, Watch watch) {
  const auto count = static_cast<std::size_t>(spans[&SpanRecord::count][i]);
  for (std::size_t k = 0; k < registers; ++k) {
    std::vector<std::int64_t>& values = work.values[k];
    if (values.size() < count + column_slack) values.resize(count + column_slack);
    const Adder& adder = adder_of(stage.formats, k);
    const std::int64_t step = spans[steps[k]][i];
    std::int64_t value = spans[starts[k]][i];
    for (std::size_t n = 0; n + 1 < count; ++n) {
      values[n] = value;
      value = stage.fits_int64 ? accumulated<std::int64_t>(value, step, adder, watch)
                               : accumulated<int128>(value, step, adder, watch);
    }
    // Past the end too, where vectors look.
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(count) - 1, column_slack + 1, value);
    out[k] = {0, 0, values.data()};
  }
}

template <class T>
HWY_INLINE void registers_of(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                             SpanWork<T>& work, Sequences& out) {
  if (work.ramps.linear[i] == 0) [[unlikely]] {
    walk_registers(stage, spans, i, work, out, NoObserve{});
    return;
  }
  for (std::size_t k = 0; k < registers; ++k)
    out[k] = {spans[starts[k]][i], work.ramps.increment[k][i], nullptr};
}

// ---------------------------------------------------------------- fragments

using Half = hn::Rebind<std::int32_t, Lanes::Tag>;  // as many as Lanes, 32 bits each
using HalfVector = hn::Vec<Half>;

// The low 32 bits.
HWY_INLINE HalfVector low_half(Lanes x) {
  const hn::Rebind<std::uint32_t, Lanes::Tag> d;
  return hn::BitCast(Half(), hn::TruncateTo(d, hn::BitCast(hn::ScalableTag<std::uint64_t>(), x.v)));
}
// The low 32 bits of both, a first.
HWY_INLINE Lanes32 low_halves(Lanes a, Lanes b) {
#if HWY_TARGET == HWY_SCALAR
  static_cast<void>(b);
  return Lanes32::from(low_half(a));
#else
  return Lanes32::from(hn::Combine(Lanes32::Tag(), low_half(b), low_half(a)));
#endif
}
// The lanes of a mask side by side. Highway 1.0's Compress copies its table to the stack each time.
#if HWY_TARGET == HWY_AVX3
HWY_INLINE Lanes32 packed(Lanes32 x, Lanes32::Mask mask) {
  return Lanes32::from(Lanes32::Vector{_mm512_maskz_compress_epi32(mask.m.raw, x.v.raw)});
}
#elif HWY_TARGET == HWY_SCALAR
HWY_INLINE Lanes32 packed(Lanes32 x, Lanes32::Mask /*mask*/) { return x; }
#else
constexpr auto make_orders32() {
  std::array<std::array<std::int32_t, Lanes32::count>, std::size_t{1} << Lanes32::count> orders{};
  for (std::size_t bits = 0; bits < orders.size(); ++bits) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < Lanes32::count; ++i) {
      if ((bits >> i & 1) != 0) orders[bits][to++] = static_cast<std::int32_t>(i);
    }
  }
  return orders;
}
constexpr auto orders32 = make_orders32();
HWY_INLINE Lanes32 packed(Lanes32 x, Lanes32::Mask mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Lanes32::Tag(), mask.m, bits);
  return Lanes32::from(
      hn::TableLookupLanes(x.v, hn::SetTableIndices(Lanes32::Tag(), orders32[bits[0]].data())));
}
#endif
HWY_INLINE Lanes widened(HalfVector x) { return Lanes::from(hn::PromoteTo(Lanes::Tag(), x)); }
HWY_INLINE void store_as(std::int64_t* at, Lanes x) { x.store(at); }
HWY_INLINE void store_as(std::int32_t* at, Lanes x) { hn::StoreU(low_half(x), Half(), at); }

template <class Watch>
HWY_NOINLINE DepthPoint<Lanes> code_by_reciprocal(const DepthFormats& f, const DepthScene& scene, Lanes h,
                                                  Watch watch) {
  return depth_point<WideLanes>(f, scene, h, watch);
}
template <class Watch>
HWY_INLINE DepthPoint<Lanes> depth_code_of(const DepthStage& stage, const DepthFormats& f, Lanes h,
                                           Watch watch) {
  if (!stage.fits_int64) [[unlikely]] {
    return code_by_reciprocal(f, stage.scene, h, watch);
  }
  return depth_point<Lanes>(f, stage.scene, h, watch);
}

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
    const bool may = draw.texture == texture_ && ((draw.shared && shared_) || triangle == triangle_);
    if (!may) {
      if (block_.size != 0) flush();
      texture_ = draw.texture;
      shared_ = draw.shared;
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
    if (fits_lanes(pipeline_.span, numerators, bases)) {
      evaluate<Lanes>();
    } else {
      evaluate<WideLanes>();
    }
    sink_(block_, texture_, !shared_);
    block_.size = 0;
  }
  // Fragments at index[0 .. n) of a span. There is room.
  HWY_INLINE void put(const Sequences& s, std::int64_t u1, std::int64_t v1, std::int64_t first_pixel,
                      const std::int32_t* index, std::size_t n) {
    const FormatsOf<SpanFormats, fixed> f(pipeline_.span.formats);
    const Register& shade = (*f).shade;
    const int shade_fraction = (*f).shade_acc.acc.fraction;
    const std::array<T*, 4> shades{block_.r, block_.g, block_.b, block_.a};
    const auto triangle = static_cast<std::int32_t>(triangle_);
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
        for (std::size_t c = 0; c < channel_count; ++c) {
          quantize(at(s[3 + c], place), shade_fraction, shade, Watch{}).store(shades[c] + to);
        }
      }
    }
    if constexpr (sizeof(T) == sizeof(std::int32_t)) {
      for (std::size_t k = 0; k < n; k += Lanes32::count) {
        const Lanes32 place = Lanes32::load(index + k);
        for (std::size_t c = 0; c < channel_count; ++c) {
          quantize(at32(s[3 + c], place), shade_fraction, shade, Watch{}).store(shades[c] + block_.size + k);
        }
      }
    }
    block_.size += n;
  }
  FragmentBlock<T>& block() { return block_; }
  bool shared() const { return shared_; }

 private:
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
  std::int32_t texture_ = -1;
  bool shared_ = false;
  std::int64_t triangle_ = -1;
};

constexpr std::int64_t pixels_a_line = 16;  // of the cache, depth codes or colours

// Small triangles lie anywhere in the buffers, and a span would wait for its depth codes longer than all else
// takes: they are fetched while earlier spans are drawn. All at once would be more than can be under way.
constexpr std::size_t spans_ahead = 16;
constexpr std::size_t few_pixels = 64;
HWY_INLINE void fetch_depth(const Frame& frame, std::int64_t pixel, std::int64_t count) {
  const std::uint32_t* const codes = frame.depth.data() + pixel;
  __builtin_prefetch(codes, 1);
  __builtin_prefetch(codes + count - 1, 1);
  for (std::int64_t k = pixels_a_line; k + pixels_a_line < count; k += pixels_a_line) {
    __builtin_prefetch(codes + k, 1);
  }
}

// How a span's pixels are tested.
enum class Test : std::uint8_t {
  few,    // without branches: what passes is as good as random where spans are short
  many,   // whole vectors pass, or none of their pixels
  walked  // h is no ramp
};

// Tests pixels from .. to of a span, writes the places of those that pass to `passing` and, unless they are
// stored right away, their codes. Returns how many passed. func: a constant where the test must be fast.
template <bool store, Test how, class Watch>
HWY_INLINE std::size_t test_depth(const DepthStage& stage, const DepthFormats& f, DepthFunc func,
                                  const Sequence& h, std::uint32_t* stored, std::size_t from, std::size_t to,
                                  std::int32_t* passing, std::int32_t* codes) {
  const Lanes32::Tag d;
  auto* const buffer = reinterpret_cast<std::int32_t*>(stored);
  // Unsigned order by signed comparison.
  const Lanes32 flip(f.z.word > 31 ? INT32_MIN : 0);
  const Lanes advance(h.increment * static_cast<std::int64_t>(Lanes32::count));
  Lanes first = at(h, Lanes::iota(static_cast<std::int64_t>(from)));
  Lanes second = first + Lanes(h.increment * static_cast<std::int64_t>(Lanes::count));
  std::size_t n = 0;
  for (std::size_t k = from; k < to; k += Lanes32::count) {
    if constexpr (how == Test::walked) {
      first = at(h, Lanes::iota(static_cast<std::int64_t>(k)));
      second = at(h, Lanes::iota(static_cast<std::int64_t>(std::min(k + Lanes::count, to))));
    }
    const Lanes32 z =
        low_halves(depth_code_of(stage, f, first, Watch{}).z, depth_code_of(stage, f, second, Watch{}).z);
    first = first + advance;
    second = second + advance;
    const bool whole = how != Test::few && k + Lanes32::count <= to;
    const auto inside = hn::FirstN(d, to - k);
    const auto old = Lanes32::from(whole ? hn::LoadU(d, buffer + k) : hn::MaskedLoad(inside, d, buffer + k));
    Lanes32::Mask pass = depth_passes(f, func, z ^ flip, old ^ flip);
    if (!whole) pass = pass & Lanes32::Mask{inside};
    if constexpr (how != Test::few) {
      if (!any(pass)) continue;
      if (whole && all(pass)) {  // most often where any does
        Lanes32::iota(static_cast<std::int32_t>(k)).store(passing + n);
        z.store(store ? buffer + k : codes + n);
        n += Lanes32::count;
        continue;
      }
    }
    packed(Lanes32::iota(static_cast<std::int32_t>(k)), pass).store(passing + n);
    if constexpr (store) {
      hn::BlendedStore(z.v, pass.m, d, buffer + k);
    } else {
      packed(z, pass).store(codes + n);
    }
    n += set_in(pass);
  }
  return n;
}

// The same for a ramp and the stage's own comparison, whatever it is.
template <bool store, class Watch>
HWY_NOINLINE std::size_t test_depth_by_func(const DepthStage& stage, const DepthFormats& f, const Sequence& h,
                                            std::uint32_t* stored, std::size_t from, std::size_t to,
                                            std::int32_t* passing, std::int32_t* codes) {
  return test_depth<store, Test::many, Watch>(stage, f, stage.func, h, stored, from, to, passing, codes);
}

// Pixels of spans that passed, until they are put into blocks.
struct Passed {
  static constexpr std::size_t capacity = 4 * block_size;
  struct Piece {
    std::int32_t span, n;
  };
  std::size_t pieces = 0, size = 0;
  Piece piece[capacity];
  HWY_ALIGN std::int32_t place[capacity + column_slack];  // in the span
  HWY_ALIGN std::int32_t code[capacity + column_slack];
};

// First all depth tests of some spans, then what passed: each half is a short loop whose branches are as
// a span's, not a pixel's.
template <class T, const SpanFormats* fixed, const DepthFormats* fixed_depth>
void draw(const Pipeline& pipeline, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
          std::int64_t first_index, SpanWork<T>& work, Frame& frame, Counters& counters, BlockSink<T>& sink) {
  // int32 blocks go with registers that are all plain.
  using Watch = std::conditional_t<sizeof(T) == 4, Plain, NoObserve>;
  const DepthStage& stage = pipeline.depth;
  const FormatsOf<DepthFormats, fixed_depth> depth_formats(stage.formats);
  const DepthFormats& df = *depth_formats;
  constexpr DepthFunc less = DepthFunc::less;
  const bool only_nearer = passes_only_nearer(stage.func);
  find_ramps<fixed>(pipeline.span.formats, spans, work.ramps);
  Filler<T, Watch, fixed> filler(pipeline, work, sink);
  const std::int64_t* rows = spans[&SpanRecord::y];
  const std::int64_t* columns = spans[&SpanRecord::x];
  const std::int64_t* counts = spans[&SpanRecord::count];
  const std::int64_t* triangles = spans[&SpanRecord::triangle];
  const std::int64_t* u1 = spans[&SpanRecord::u1];
  const std::int64_t* v1 = spans[&SpanRecord::v1];
  const std::int64_t* h_starts = spans[starts[0]];
  const std::int64_t* h_increments = work.ramps.increment[0].data();
  const std::int64_t* linear = work.ramps.linear.data();
  Passed passed;
  std::uint64_t tested = 0;
  std::uint64_t fragments = 0;
  Sequences s;
  const auto put = [&]() HWY_ATTR {
    fragments += passed.size;
    std::size_t at = 0;
    for (std::size_t p = 0; p < passed.pieces; ++p) {
      const auto i = static_cast<std::size_t>(passed.piece[p].span);
      const auto n = static_cast<std::size_t>(passed.piece[p].n);
      const std::int64_t first_pixel = rows[i] * frame.width + columns[i];
      // Vectors look past the end, where the next span's places are: those of this one are taken there.
      HWY_ALIGN std::int32_t place[block_size + column_slack];
      for (std::size_t k = 0; k < n; k += Lanes32::count) {
        Lanes32::load(passed.place + at + k).store(place + k);
        __builtin_prefetch(frame.color.data() + 4 * (first_pixel + place[k]), 1);
      }
      Lanes32(0).store(place + n);
      filler.join(draws[static_cast<std::size_t>(triangles[i] - first_index)], triangles[i]);
      filler.need(n);
      registers_of(pipeline.span, spans, i, work, s);
      if (!filler.shared()) {
        std::memcpy(filler.block().z + filler.block().size, passed.code + at, n * sizeof(std::int32_t));
      }
      filler.put(s, u1[i], v1[i], first_pixel, place, n);
      at += n;
    }
    passed.pieces = passed.size = 0;
  };
  std::int64_t last_triangle = -1;
  bool last_shared = true;
  for (std::size_t i = 0; i < spans.size; ++i) {
    const std::size_t ahead = i + spans_ahead;
    if (ahead < spans.size) {
      fetch_depth(frame, rows[ahead] * frame.width + columns[ahead], counts[ahead]);
      __builtin_prefetch(&draws[static_cast<std::size_t>(triangles[ahead] - first_index)]);
    }
    const bool shared = draws[static_cast<std::size_t>(triangles[i] - first_index)].shared;
    // What is not shared stores its depth when its block is shaded.
    if (!(shared && last_shared) && triangles[i] != last_triangle) {
      put();
      filler.flush();
    }
    last_triangle = triangles[i];
    last_shared = shared;
    const auto count = static_cast<std::size_t>(counts[i]);
    std::uint32_t* const stored = frame.depth.data() + rows[i] * frame.width + columns[i];
    tested += count;
    const Sequence ramp{h_starts[i], h_increments[i], nullptr};
    for (std::size_t from = 0; from < count; from += block_size) {
      if (passed.size + block_size > Passed::capacity) put();
      const std::size_t to = std::min(count, from + block_size);
      std::int32_t* const place = passed.place + passed.size;
      std::int32_t* const code = passed.code + passed.size;
      std::size_t n = 0;
      if (linear[i] == 0) [[unlikely]] {
        registers_of(pipeline.span, spans, i, work, s);
        n = test_depth<false, Test::walked, Watch>(stage, df, stage.func, s[0], stored, from, to, place,
                                                   code);
        for (std::size_t k = 0; shared && k < n; ++k) stored[place[k]] = static_cast<std::uint32_t>(code[k]);
      } else if (!only_nearer) [[unlikely]] {
        n = shared ? test_depth_by_func<true, Watch>(stage, df, ramp, stored, from, to, place, code)
                   : test_depth_by_func<false, Watch>(stage, df, ramp, stored, from, to, place, code);
      } else if (!shared) {
        n = test_depth<false, Test::many, Watch>(stage, df, less, ramp, stored, from, to, place, code);
      } else if (count > few_pixels) {
        n = test_depth<true, Test::many, Watch>(stage, df, less, ramp, stored, from, to, place, code);
      } else {
        n = test_depth<true, Test::few, Watch>(stage, df, less, ramp, stored, from, to, place, code);
      }
      passed.piece[passed.pieces] = {static_cast<std::int32_t>(i), static_cast<std::int32_t>(n)};
      passed.pieces += n != 0 ? 1 : 0;
      passed.size += n;
    }
  }
  put();
  filler.flush();
  counters.fragments += tested;
  counters.covered += tested;
  counters.depth_passed += fragments;
  counters.divides_pixel += tested * static_cast<std::uint64_t>(pipeline.span.divides_per_fragment);
}

// ---------------------------------------------------------------- every fragment

// All fragments of span i into columns: h, u, v; the shades where `shades`; the other registers where `all`.
template <class Int, const SpanFormats* fixed, class Watch>
HWY_NOINLINE void fragments_in(const SpanStage& stage, const Sequences& s, const Columns<SpanRecord>& spans,
                               std::size_t i, bool shades, bool all, Columns<FragmentRecord>& out,
                               LaneStatistics* statistics) {
  const FormatsOf<SpanFormats, fixed> formats(stage.formats);
  const SpanFormats& f = *formats;
  const bool aligned = stage.aligned;
  const std::int64_t* table = stage.reciprocal.table().data();
  const Lanes b(static_cast<std::int64_t>(stage.q.b));
  const auto count = static_cast<std::size_t>(spans[&SpanRecord::count][i]);
  const Lanes u1(spans[&SpanRecord::u1][i]);
  const Lanes v1(spans[&SpanRecord::v1][i]);
  out.reserve(count);
  std::int64_t* const hs = out[&FragmentRecord::h];
  std::int64_t* const us = out[&FragmentRecord::u];
  std::int64_t* const vs = out[&FragmentRecord::v];
  const bool ramps = is_ramp(s[0]) && is_ramp(s[1]) && is_ramp(s[2]);
  const auto advance = [&](std::size_t r) HWY_ATTR {
    return Lanes(s[r].increment * static_cast<std::int64_t>(Lanes::count));
  };
  const Lanes h_advance = advance(0);
  const Lanes fu_advance = advance(1);
  const Lanes fv_advance = advance(2);
  Lanes h = at(s[0], Lanes::iota(0));
  Lanes fu = at(s[1], Lanes::iota(0));
  Lanes fv = at(s[2], Lanes::iota(0));
  for (std::size_t k = 0; k < count; k += Lanes::count) {
    const Lanes index = Lanes::iota(static_cast<std::int64_t>(k));
    const auto watch = [&]() HWY_ATTR {
      if constexpr (std::is_same_v<Watch, ObserveLanes>) {
        return ObserveLanes{statistics, first_lanes<std::int64_t>(std::min(count - k, Lanes::count)),
                            count - k >= Lanes::count};
      } else {
        return Watch{};
      }
    }();
    if (!ramps) [[unlikely]] {
      h = at(s[0], index);
      fu = at(s[1], index);
      fv = at(s[2], index);
    }
    const auto point = texture_point<Int>(f, b, table, h, fu, fv, u1, v1, aligned, watch);
    h.store(hs + k);
    point.u.store(us + k);
    point.v.store(vs + k);
    if (all) {
      fu.store(out[&FragmentRecord::fu] + k);
      fv.store(out[&FragmentRecord::fv] + k);
      point.recip_m.store(out[&FragmentRecord::recip_m] + k);
      point.recip_e.store(out[&FragmentRecord::recip_e] + k);
    }
    if (shades) {
      for (std::size_t c = 0; c < channel_count; ++c) {
        quantize(at(s[3 + c], index), f.shade_acc.acc.fraction, f.shade, watch)
            .store(out[fragment_shades[c]] + k);
      }
    }
    h = h + h_advance;
    fu = fu + fu_advance;
    fv = fv + fv_advance;
  }
  out.size = count;
}

// fits_lanes of a whole span: its numerators are largest at an end.
HWY_INLINE bool span_fits_lanes(const SpanStage& stage, const Sequences& s, const Columns<SpanRecord>& spans,
                                std::size_t i) {
  if (stage.fits_int64 || s[1].values != nullptr || s[2].values != nullptr) return stage.fits_int64;
  const Lanes last(spans[&SpanRecord::count][i] - 1);
  const Lanes ends = magnitude(Lanes(s[1].start)) | magnitude(at(s[1], last)) | magnitude(Lanes(s[2].start)) |
                     magnitude(at(s[2], last));
  return fits_lanes(
      stage, ends, magnitude(Lanes(spans[&SpanRecord::u1][i])) | magnitude(Lanes(spans[&SpanRecord::v1][i])));
}

template <const SpanFormats* fixed, class Watch>
HWY_INLINE void fragments_of(const SpanStage& stage, const Sequences& s, const Columns<SpanRecord>& spans,
                             std::size_t i, bool shades, bool all, Columns<FragmentRecord>& out,
                             LaneStatistics* statistics) {
  if (span_fits_lanes(stage, s, spans, i)) {
    fragments_in<Lanes, fixed, Watch>(stage, s, spans, i, shades, all, out, statistics);
  } else {
    fragments_in<WideLanes, fixed, Watch>(stage, s, spans, i, shades, all, out, statistics);
  }
}

// Observers of the adders, and the registers.
template <class T>
void observed_registers(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                        SpanWork<T>& work, Sequences& s, Statistics& statistics) {
  if (work.ramps.linear[i] == 0) {
    walk_registers(stage, spans, i, work, s, Observe{&statistics});
    return;
  }
  registers_of(stage, spans, i, work, s);
  for (std::size_t k = 0; k < registers; ++k) {
    note_ramp(adder_of(stage.formats, k), s[k].start, spans[steps[k]][i], s[k].increment,
              spans[&SpanRecord::count][i] - 1, statistics);
  }
}

template <class T, const SpanFormats* fixed>
void evaluate_span(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i, bool shades,
                   SpanWork<T>& work, Columns<FragmentRecord>& out) {
  if (i == 0) find_ramps<fixed>(stage.formats, spans, work.ramps);
  Sequences s;
  registers_of(stage, spans, i, work, s);
  if (fixed != nullptr || plain_span(stage.formats)) {
    fragments_of<fixed, Plain>(stage, s, spans, i, shades, false, out, nullptr);
  } else {
    fragments_of<nullptr, NoObserve>(stage, s, spans, i, shades, false, out, nullptr);
  }
}

template <class T>
void evaluate_span_observed(const SpanStage& stage, const Columns<SpanRecord>& spans, std::size_t i,
                            bool shades, SpanWork<T>& work, Columns<FragmentRecord>& out,
                            Statistics& statistics) {
  if (i == 0) find_ramps<nullptr>(stage.formats, spans, work.ramps);
  Sequences s;
  LaneStatistics seen;
  observed_registers(stage, spans, i, work, s, statistics);
  fragments_of<nullptr, ObserveLanes>(stage, s, spans, i, shades, false, out, &seen);
  seen.fold(statistics);
}

// Depth codes of all fragments.
template <class Watch>
HWY_NOINLINE void depth_codes_of(const DepthStage& stage, const Columns<FragmentRecord>& fragments,
                                 Columns<DepthRecord>& out, LaneStatistics* statistics) {
  out.reserve(fragments.size);
  for (std::size_t k = 0; k < fragments.size; k += Lanes::count) {
    const auto watch = [&]() HWY_ATTR {
      if constexpr (std::is_same_v<Watch, ObserveLanes>) {
        return ObserveLanes{statistics, first_lanes<std::int64_t>(std::min(fragments.size - k, Lanes::count)),
                            fragments.size - k >= Lanes::count};
      } else {
        return Watch{};
      }
    }();
    const auto point =
        depth_code_of(stage, stage.formats, Lanes::load(fragments[&FragmentRecord::h] + k), watch);
    point.z.store(out[&DepthRecord::z] + k);
    point.recip_m.store(out[&DepthRecord::recip_m] + k);
    point.recip_e.store(out[&DepthRecord::recip_e] + k);
  }
  out.size = fragments.size;
}

// statistics and seen: both or none.
template <class T>
void draw_every(const Pipeline& pipeline, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
                std::int64_t first_index, SpanWork<T>& work, Frame& frame, Counters& counters,
                BlockSink<T>& sink, Trace* trace, Statistics* statistics, LaneStatistics* seen) {
  find_ramps<nullptr>(pipeline.span.formats, spans, work.ramps);
  FragmentBlock<T>& block = work.block;
  block.size = 0;
  std::int32_t texture = -1;
  std::int64_t last_triangle = -1;
  const auto flush = [&] {
    if (block.size != 0) sink(block, texture, true);
    block.size = 0;
  };
  Sequences s;
  Columns<FragmentRecord>& fragments = work.fragments;
  Columns<DepthRecord>& depths = work.depths;
  for (std::size_t i = 0; i < spans.size; ++i) {
    const std::int64_t triangle = spans[&SpanRecord::triangle][i];
    if (triangle != last_triangle) flush();  // a pixel may repeat from here on
    last_triangle = triangle;
    texture = draws[static_cast<std::size_t>(triangle - first_index)].texture;
    if (statistics != nullptr) {
      observed_registers(pipeline.span, spans, i, work, s, *statistics);
      fragments_of<nullptr, ObserveLanes>(pipeline.span, s, spans, i, true, true, fragments, seen);
      depth_codes_of<ObserveLanes>(pipeline.depth, fragments, depths, seen);
    } else {
      registers_of(pipeline.span, spans, i, work, s);
      fragments_of<nullptr, NoObserve>(pipeline.span, s, spans, i, true, true, fragments, nullptr);
      depth_codes_of<NoObserve>(pipeline.depth, fragments, depths, nullptr);
    }
    const std::int64_t x = spans[&SpanRecord::x][i];
    const std::int64_t y = spans[&SpanRecord::y][i];
    for (std::size_t k = 0; k < fragments.size; ++k) {
      FragmentRecord fragment = fragments.record(k);
      fragment.triangle = triangle;
      fragment.x = x + static_cast<std::int64_t>(k);
      fragment.y = y;
      fragment.covered = 1;
      fragment.last = k + 1 == fragments.size ? 1 : 0;
      DepthRecord depth = depths.record(k);
      depth.triangle = triangle;
      depth.x = fragment.x;
      depth.y = y;
      const auto pixel = static_cast<std::size_t>(y * frame.width + fragment.x);
      depth.stored = frame.depth[pixel];
      depth.pass = depth_passes(pipeline.depth.formats, pipeline.depth.func, depth.z, depth.stored) ? 1 : 0;
      if (trace != nullptr) {
        trace->fragment.push_back(fragment);
        trace->depth.push_back(depth);
      }
      if (depth.pass == 0) continue;
      ++counters.depth_passed;
      if (block.size == block_size) flush();
      append(block, fragment, depth, pixel, pipeline.fog);
    }
    const auto count = static_cast<std::uint64_t>(fragments.size);
    counters.fragments += count;
    counters.covered += count;
    counters.divides_pixel += count * static_cast<std::uint64_t>(pipeline.span.divides_per_fragment);
  }
  flush();
}

template <class T>
void draw_traced(const Pipeline& pipeline, const Columns<SpanRecord>& spans, std::span<const SpanDraw> draws,
                 std::int64_t first_index, SpanWork<T>& work, Frame& frame, Counters& counters,
                 BlockSink<T>& sink, Trace* trace, Statistics* statistics) {
  LaneStatistics seen;
  draw_every(pipeline, spans, draws, first_index, work, frame, counters, sink, trace, statistics, &seen);
  if (statistics != nullptr) seen.fold(*statistics);
}

template <class T, const SpanFormats* fixed, const DepthFormats* fixed_depth>
SpanKernels<T> table_of() {
  return {draw<T, fixed, fixed_depth>, draw_traced<T>, evaluate_span<T, fixed>, evaluate_span_observed<T>};
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
