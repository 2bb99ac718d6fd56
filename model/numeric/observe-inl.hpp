// SPDX-License-Identifier: Apache-2.0
// Observers of lanes: histories of registers, a set per lane.
#include <algorithm>
#include <array>

#include "model/numeric/lanes-inl.hpp"
#include "model/numeric/observe.hpp"
#include "model/numeric/register.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_OBSERVE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_OBSERVE_INL
#undef BITSPAN_MODEL_NUMERIC_OBSERVE_INL
#else
#define BITSPAN_MODEL_NUMERIC_OBSERVE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// Histories of registers, a lane each; summed up by fold().
struct LaneHistory {
  HWY_ALIGN std::int64_t count[Lanes::count] = {};
  HWY_ALIGN std::int64_t outside[Lanes::count] = {};
  HWY_ALIGN std::int64_t min[Lanes::count];
  HWY_ALIGN std::int64_t max[Lanes::count];
  HWY_ALIGN std::int64_t bias[Lanes::count] = {};
  std::int64_t vectors = 0;           // seen with every lane active; count has the others
  Overflow overflow = Overflow::sat;  // the register's, known once something was outside
  LaneHistory() {
    for (std::size_t i = 0; i < Lanes::count; ++i) {
      min[i] = INT64_MAX;
      max[i] = INT64_MIN;
    }
  }
};
struct LaneStatistics {
  std::array<LaneHistory, register_count> of;
  // Adds what was seen since the last fold to `into`.
  void fold(Statistics& into) {
    for (std::size_t i = 0; i < of.size(); ++i) {
      FieldStatistics& to = into.fields[i];
      std::uint64_t outside = 0;
      for (std::size_t l = 0; l < Lanes::count; ++l) {
        const std::int64_t seen = of[i].count[l] + of[i].vectors;
        if (seen == 0) continue;
        to.min = to.count == 0 ? of[i].min[l] : std::min(to.min, of[i].min[l]);
        to.max = to.count == 0 ? of[i].max[l] : std::max(to.max, of[i].max[l]);
        to.count += static_cast<std::uint64_t>(seen);
        to.bias += of[i].bias[l];
        outside += static_cast<std::uint64_t>(of[i].outside[l]);
      }
      if (outside != 0) {
        const bool wraps = of[i].overflow == Overflow::wrap || of[i].overflow == Overflow::wrap_sm;
        (wraps ? to.wraps : to.saturations) += outside;
      }
      of[i] = LaneHistory();
    }
  }
};

// The observer of lanes: where to note, and which lanes hold something.
struct ObserveLanes {
  static constexpr bool enabled = true;
  LaneStatistics* statistics;
  Lanes::Mask active;
  bool whole = false;  // true: all lanes are active

  // rounded: before overflow, clamped to int64; error: rounded - exact in 2^-32 ulp.
  HWY_INLINE void note(const Register& r, Lanes rounded, Lanes::Mask outside, Lanes error) const {
    LaneHistory& h = statistics->of[static_cast<std::size_t>(r.id)];
    const auto add = [this](std::int64_t* at, Lanes x)
                         HWY_ATTR { (Lanes::load(at) + select(active, x, Lanes(0))).store(at); };
    if (whole) {
      ++h.vectors;
      (Lanes::load(h.bias) + error).store(h.bias);
      min(Lanes::load(h.min), rounded).store(h.min);
      max(Lanes::load(h.max), rounded).store(h.max);
    } else {
      add(h.count, Lanes(1));
      add(h.bias, error);
      min(Lanes::load(h.min), select(active, rounded, Lanes(INT64_MAX))).store(h.min);
      max(Lanes::load(h.max), select(active, rounded, Lanes(INT64_MIN))).store(h.max);
    }
    if (any(outside & active)) [[unlikely]] {
      add(h.outside, one_where(outside));
      h.overflow = r.overflow;
    }
  }
  // What was seen of lane i elsewhere.
  void add(const Register& r, std::size_t i, const FieldStatistics& seen) const {
    if (lane(one_where(active), i) == 0) return;
    LaneHistory& h = statistics->of[static_cast<std::size_t>(r.id)];
    h.count[i] += static_cast<std::int64_t>(seen.count);
    h.outside[i] += static_cast<std::int64_t>(seen.wraps + seen.saturations);
    h.overflow = r.overflow;
    h.min[i] = std::min(h.min[i], seen.min);
    h.max[i] = std::max(h.max[i], seen.max);
    h.bias[i] += seen.bias;
  }
};

// No observer, for registers of which is_branch_free() holds: it gives the same values without a branch per
// value.
struct BranchFree : NoObserve {};

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
