#include "tests/simd/lane_kernels.hpp"

#include <algorithm>
#include <memory>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/simd/lane_kernels.cpp"
#include "hwy/foreach_target.h"
#include "model/numeric/reciprocal-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

constexpr std::size_t width = Lanes::count;

// The n <= width values at p, the lanes past them repeating the last one.
Lanes load_some(const std::int64_t* p, std::size_t n) {
  return by_lane([&](std::size_t i) HWY_ATTR { return p[std::min(i, n - 1)]; });
}
void store_some(Lanes x, std::int64_t* p, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) p[i] = lane(x, i);
}
WideLanes load_some(const int128* p, std::size_t n) {
  return {
      by_lane([&](std::size_t i) HWY_ATTR { return static_cast<std::int64_t>(p[std::min(i, n - 1)] >> 64); }),
      by_lane([&](std::size_t i) HWY_ATTR { return static_cast<std::int64_t>(p[std::min(i, n - 1)]); })};
}
void store_some(WideLanes x, int128* p, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) p[i] = wide_lane(x, i);
}

// Calls f(index of the first element, how many, observer) for a register's width of elements at a time.
template <class F>
void observed(std::size_t n, Watching w, F f) {
  if (w.statistics == nullptr) {
    for (std::size_t i = 0; i < n; i += width) f(i, std::min(width, n - i), NoObserve{});
    return;
  }
  const auto seen = std::make_unique<LaneStatistics>();
  for (std::size_t i = 0; i < n; i += width) {
    const std::size_t some = std::min(width, n - i);
    const Lanes active = by_lane(
        [&](std::size_t l) HWY_ATTR { return std::int64_t{l < some && w.active[i + l] != 0 ? 1 : 0}; });
    f(i, some, ObserveLanes{seen.get(), active != Lanes(0)});
  }
  seen->fold(*w.statistics);
}

void quantize32(const std::int32_t* raw, std::size_t n, int fraction, const Register& r, std::int32_t* out) {
  for (std::size_t i = 0; i < n; i += Lanes32::count) {
    const std::size_t some = std::min(Lanes32::count, n - i);
    HWY_ALIGN std::int32_t buffer[Lanes32::count] = {};
    std::copy_n(raw + i, some, buffer);
    quantize(Lanes32::load(buffer), fraction, r, NoObserve{}).store(buffer);
    std::copy_n(buffer, some, out + i);
  }
}
template <class T>
void quantize_all(const T* raw, std::size_t n, int fraction, const Register& r, Watching w,
                  std::int64_t* out) {
  observed(n, w, [&](std::size_t i, std::size_t some, auto watch) HWY_ATTR {
    store_some(quantize(load_some(raw + i, some), fraction, r, watch), out + i, some);
  });
}
template <class T>
void quantize_each(const T* raw, const std::int64_t* fraction, std::size_t n, const Register& r, Watching w,
                   std::int64_t* out) {
  observed(n, w, [&](std::size_t i, std::size_t some, auto watch) HWY_ATTR {
    store_some(quantize(load_some(raw + i, some), load_some(fraction + i, some), r, watch), out + i, some);
  });
}
template <class T>
void ratio(const T* numerator, const std::int64_t* d, std::size_t n, int scale, const Register& r, Watching w,
           std::int64_t* out) {
  observed(n, w, [&](std::size_t i, std::size_t some, auto watch) HWY_ATTR {
    store_some(quantize_ratio(load_some(numerator + i, some), load_some(d + i, some), scale, r, watch),
               out + i, some);
  });
}
std::size_t ratio128_refused(const int128* n, const std::int64_t* d, std::size_t size, int scale) {
  std::size_t refused = 0;
  for (std::size_t i = 0; i < size; i += width) {
    const std::size_t some = std::min(width, size - i);
    const auto ok = quotient(numerator(load_some(n + i, some)), load_some(d + i, some), scale).ok;
    const auto refused_here = !ok;
    refused += set_in(refused_here & first_lanes<std::int64_t>(some));
  }
  return refused;
}
void reciprocal_all(const ReciprocalFormats& f, const std::int64_t* table, const std::int64_t* d,
                    std::size_t n, int fraction, Watching w, std::int64_t* m, std::int64_t* e) {
  observed(n, w, [&](std::size_t i, std::size_t some, auto watch) HWY_ATTR {
    const InverseOf<Lanes> out = reciprocal(f, table, load_some(d + i, some), fraction, watch);
    store_some(out.m, m + i, some);
    store_some(out.e, e + i, some);
  });
}

template <class T, class Out, class F>
void map(const T* a, std::size_t n, Out* out, F f) {
  for (std::size_t i = 0; i < n; i += width) {
    const std::size_t some = std::min(width, n - i);
    store_some(f(load_some(a + i, some), i, some), out + i, some);
  }
}
void product(const std::int64_t* a, const std::int64_t* b, std::size_t n, int128* out) {
  map(a, n, out, [&](Lanes x, std::size_t i, std::size_t some) HWY_ATTR {
    return product_of(x, load_some(b + i, some));
  });
}
void add(const int128* a, const int128* b, std::size_t n, int128* out) {
  map(a, n, out,
      [&](WideLanes x, std::size_t i, std::size_t some) HWY_ATTR { return x + load_some(b + i, some); });
}
void subtract(const int128* a, const int128* b, std::size_t n, int128* out) {
  map(a, n, out,
      [&](WideLanes x, std::size_t i, std::size_t some) HWY_ATTR { return x - load_some(b + i, some); });
}
void shift_left(const int128* a, std::size_t n, int by, int128* out) {
  map(a, n, out, [&](WideLanes x, std::size_t, std::size_t) HWY_ATTR { return x << by; });
}
void shift_right(const int128* a, std::size_t n, int by, int128* out) {
  map(a, n, out, [&](WideLanes x, std::size_t, std::size_t) HWY_ATTR { return x >> by; });
}
void shift_left_each(const int128* a, const std::int64_t* by, std::size_t n, int128* out) {
  map(a, n, out,
      [&](WideLanes x, std::size_t i, std::size_t some) HWY_ATTR { return x << load_some(by + i, some); });
}
void shift_right_each(const int128* a, const std::int64_t* by, std::size_t n, int128* out) {
  map(a, n, out,
      [&](WideLanes x, std::size_t i, std::size_t some) HWY_ATTR { return x >> load_some(by + i, some); });
}
void top_bits(const std::int64_t* a, std::size_t n, std::int64_t* out) {
  map(a, n, out, [&](Lanes x, std::size_t, std::size_t) HWY_ATTR { return top_bit(x); });
}

}  // namespace

const LaneKernels* target_lane_kernels() {
  static const LaneKernels all{width,
                               quantize32,
                               quantize_all<std::int64_t>,
                               quantize_all<int128>,
                               quantize_each<std::int64_t>,
                               quantize_each<int128>,
                               ratio<std::int64_t>,
                               ratio<int128>,
                               ratio128_refused,
                               reciprocal_all,
                               product,
                               add,
                               subtract,
                               shift_left,
                               shift_right,
                               shift_left_each,
                               shift_right_each,
                               top_bits};
  return &all;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bitspan::model {
HWY_EXPORT(target_lane_kernels);
const LaneKernels& lane_kernels() { return *HWY_DYNAMIC_DISPATCH(target_lane_kernels)(); }
}  // namespace bitspan::model
#endif
