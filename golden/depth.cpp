// SPDX-License-Identifier: Apache-2.0
#include "golden/depth.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "golden/lanes.hpp"
#include "golden/reciprocal.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Depth {
 public:
  Depth(const Config& config, const Constants& constants)
      : code_(config.depth_code),
        q_h_(config.format(FormatId::span_h)),
        q_z_(config.depth_format()),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        c1_(Quantizer<Real>(config.format(FormatId::depth_c1)).value(constants.record.c1)),
        c0_(Quantizer<Real>(config.format(FormatId::depth_c0)).value(constants.record.c0)),
        z_max_(pow2<Real>(config.depth_bits) - 1),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)),
        quick_z_(config.depth_format()) {}

  void operator()(std::span<const FragmentRecord> fragments, const DrawState& state,
                  std::span<const std::uint32_t> stored, int width, std::vector<DepthRecord>& out) const {
    const std::size_t first = out.size();
    const auto covered = std::ranges::count(fragments, 1, &FragmentRecord::covered);
    out.resize(first + static_cast<std::size_t>(covered));
    std::size_t next = first;
    for (const FragmentRecord& fragment : fragments) {
      if (fragment.covered == 0) continue;
      DepthRecord& record = out[next++];
      record.triangle = fragment.triangle;
      record.x = fragment.x;
      record.y = fragment.y;
      record.stored = stored[static_cast<std::size_t>(fragment.y * width + fragment.x)];
      record.z = fragment.h;  // until it is narrowed
    }
    for (std::size_t at = first; at < out.size(); at += lanes) {
      const std::span records = std::span(out).subspan(at, std::min(lanes, out.size() - at));
      if (!quick(records)) {
        for (DepthRecord& record : records) code(record);
      }
      if (state.depth_bias != 0) {
        for (DepthRecord& record : records) record.z = biased(record.z, state.depth_bias);
      }
      for (DepthRecord& record : records) {
        record.pass = passes(state.depth_func, record.z, record.stored) ? 1 : 0;
      }
    }
  }

 private:
  // Whether the code z belongs to a nearer point than `other`.
  bool nearer(std::int64_t z, std::int64_t other) const {
    switch (code_) {
      case DepthCode::inverse:
        return z > other;
      case DepthCode::linear:
      case DepthCode::opengl:
        return z < other;
    }
    unreachable();
  }
  std::int64_t biased(std::int64_t z, std::int64_t bias) const {
    const auto largest = static_cast<std::int64_t>(base_of(z_max_));
    const std::int64_t moved = z + bias;
    return moved < 0 ? 0 : moved > largest ? largest : moved;
  }
  // The depth comparison.
  bool passes(DepthFunc func, std::int64_t z, std::int64_t stored) const {
    switch (func) {
      case DepthFunc::never:
        return false;
      case DepthFunc::less:
        return nearer(z, stored);
      case DepthFunc::equal:
        return z == stored;
      case DepthFunc::lequal:
        return z == stored || nearer(z, stored);
      case DepthFunc::greater:
        return nearer(stored, z);
      case DepthFunc::notequal:
        return z != stored;
      case DepthFunc::gequal:
        return z == stored || nearer(stored, z);
      case DepthFunc::always:
        return true;
    }
    unreachable();
  }

  // The codes of all, or false with the records as they were.
  bool quick(std::span<DepthRecord> records) const {
    if constexpr (std::same_as<Real, double>) {
      if (!quick_z_.usable) return false;
      Column h;  // NOLINT(cppcoreguidelines-pro-type-member-init): the lanes in use are set
      const std::size_t n = records.size();
      for (std::size_t i = 0; i < n; ++i) h.at[i] = static_cast<double>(records[i].z);
      const double scale = q_h_.ulp() / q_z_.ulp();
      std::int64_t bad = 0;
      switch (code_) {
        case DepthCode::inverse:
          bad = lanes_narrow(h, scale, quick_z_, n, h);
          break;
        case DepthCode::opengl:
          bad = lanes_narrow_less(z_max_ / q_z_.ulp(), h, scale, quick_z_, n, h);
          break;
        case DepthCode::linear:
          return false;
      }
      if (bad != 0) return false;
      for (std::size_t i = 0; i < n; ++i) records[i].z = static_cast<std::int64_t>(h.at[i]);
      return true;
    }
    return false;
  }

  // z, of the h that stands in its place.
  void code(DepthRecord& out) const {
    const Real h = q_h_.value(out.z);
    switch (code_) {
      case DepthCode::inverse:
        out.z = q_z_.raw(q_z_(h));
        return;
      case DepthCode::opengl:
        out.z = q_z_.raw(q_z_.sum(z_max_, -h));
        return;
      case DepthCode::linear: {
        const Inverse<Real> inverse = unit_(h + b_);
        out.recip_m = unit_.raw(inverse.m);
        out.recip_e = inverse.e;
        out.z = q_z_.raw(q_z_.sum(inverse.times(c1_), -c0_));
        return;
      }
    }
  }

  DepthCode code_;
  Quantizer<Real> q_h_, q_z_;
  Real b_, c1_, c0_, z_max_;
  ReciprocalUnit<Real> unit_;
  LaneFormat quick_z_;
};

}  // namespace

DepthStage make_depth(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> DepthStage { return Depth<Real>(config, constants); });
}

std::int64_t clear_depth(const Config& config) {
  switch (config.depth_code) {
    case DepthCode::inverse:
      return 0;
    case DepthCode::linear:
    case DepthCode::opengl:
      return (std::int64_t{1} << config.depth_bits) - 1;
  }
  unreachable();
}

}  // namespace bitspan::golden
