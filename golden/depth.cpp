// SPDX-License-Identifier: Apache-2.0
#include "golden/depth.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "golden/lanes.hpp"
#include "golden/packed_depth.hpp"
#include "golden/reciprocal.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// Whether the code z belongs to a nearer point than `other`.
bool nearer(DepthCode code, std::int64_t z, std::int64_t other) {
  switch (code) {
    case DepthCode::inverse:
      return z > other;
    case DepthCode::linear:
    case DepthCode::opengl:
    case DepthCode::w_float:
    case DepthCode::float_dz:
      return z < other;
  }
  unreachable();
}

template <class Real>
class Depth {
 public:
  Depth(const Config& config, const Constants& constants)
      : code_(config.depth_code),
        q_h_(config.format(FormatId::span_h)),
        q_z_(config.depth_format()),
        q_grad_(config.format(FormatId::plane_h_grad)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        c1_(Quantizer<Real>(config.format(FormatId::depth_c1)).value(constants.record.c1)),
        c0_(Quantizer<Real>(config.format(FormatId::depth_c0)).value(constants.record.c0)),
        z_max_(pow2<Real>(config.depth_bits) - 1),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)),
        quick_z_(config.depth_format()),
        bits_(config.depth_bits),
        mantissa_bits_(config.depth_bits - w_float_exponent_bits) {
    const Real largest = z_max_ + b_;
    w_top_ = exponent_of(largest);
    if (pow2<Real>(w_top_) < largest) ++w_top_;
  }

  void operator()(std::span<const FragmentRecord> fragments, const GradientRecord& gradient,
                  const DrawState& state, std::span<const std::uint32_t> stored, PixelGrid grid,
                  std::vector<DepthRecord>& out) const {
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
      record.stored = stored[static_cast<std::size_t>(grid.place(fragment.x, fragment.y))];
      record.z = fragment.h;  // until it is narrowed
    }
    for (std::size_t at = first; at < out.size(); at += lanes) {
      const std::span records = std::span(out).subspan(at, std::min(lanes, out.size() - at));
      if (!quick(records)) {
        for (DepthRecord& record : records) code(record);
      }
      if (state.depth_bias != 0) {
        for (DepthRecord& record : records) record.z = biased_code(record.z, state.depth_bias, bits_);
      }
      if (has_dz(code_)) {
        const int dz = log2_of_dz(gradient);
        for (DepthRecord& record : records) {
          record.z = packed({record.z, dz}, bits_);
          record.pass = passes_within(state.depth_func, record.z, record.stored) ? 1 : 0;
        }
        continue;
      }
      for (DepthRecord& record : records) {
        record.pass = passes_depth(code_, state.depth_func, record.z, record.stored) ? 1 : 0;
      }
    }
  }

 private:
  // The depth comparison of two words of float_dz, each taken apart.
  bool passes_within(DepthFunc func, std::int64_t word, std::int64_t stored) const {
    const auto [z, dz] = unpacked(word, bits_);
    const auto [other, other_dz] = unpacked(stored, bits_);
    const std::int64_t tolerance = std::int64_t{1} << std::max(dz, other_dz);
    const std::int64_t farther_by = z - other;
    switch (func) {
      case DepthFunc::never:
        return false;
      case DepthFunc::less:
        return farther_by < 0;
      case DepthFunc::equal:
        return -tolerance <= farther_by && farther_by <= tolerance;
      case DepthFunc::lequal:
        return farther_by <= tolerance;
      case DepthFunc::greater:
        return farther_by > 0;
      case DepthFunc::notequal:
        return farther_by < -tolerance || tolerance < farther_by;
      case DepthFunc::gequal:
        return farther_by >= -tolerance;
      case DepthFunc::always:
        return true;
    }
    unreachable();
  }
  // The logarithm of |dz/dx| + |dz/dy| rounded up to a power of two, as the word holds it.
  int log2_of_dz(const GradientRecord& gradient) const {
    const auto size = [&](std::int64_t raw) {
      const Real value = q_grad_.value(raw);
      return value < 0 ? -value : value;
    };
    const Real d = size(gradient.h_x) + size(gradient.h_y);
    int log2 = 0;
    while (log2 < largest_dz && pow2<Real>(log2) < d) ++log2;
    return log2;
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
        case DepthCode::float_dz:
          bad = lanes_narrow_less(z_max_ / q_z_.ulp(), h, scale, quick_z_, n, h);
          break;
        case DepthCode::linear:
        case DepthCode::w_float:
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
      case DepthCode::float_dz:  // packed when it has its bias
        out.z = q_z_.raw(q_z_.sum(z_max_, -h));
        return;
      case DepthCode::linear: {
        const Inverse<Real> inverse = unit_(h + b_);
        out.recip_m = unit_.raw(inverse.m);
        out.recip_e = inverse.e;
        out.z = q_z_.raw(q_z_.sum(inverse.times(c1_), -c0_));
        return;
      }
      case DepthCode::w_float:
        out.z = code_of_w(h + b_);
        return;
    }
  }

  // The octaves below 2^K that q lies under, and the place in its octave, counted from the upper end.
  std::int64_t code_of_w(Real q) const {
    const auto farthest = static_cast<std::int64_t>(base_of(z_max_));
    if (!(q > 0)) return farthest;
    if (q >= pow2<Real>(w_top_)) return 0;
    const int octave = w_top_ - 1 - exponent_of(q);
    if (octave >= 1 << w_float_exponent_bits) return farthest;
    const Real step = pow2<Real>(mantissa_bits_);
    const Real place = q * pow2<Real>(mantissa_bits_ + 1 + octave - w_top_);  // step .. 2 step
    const Real upper = Real(octave + 2) * step;
    if (upper - place > z_max_) return farthest;
    return q_z_.raw(q_z_.sum(upper, -place));
  }

  DepthCode code_;
  Quantizer<Real> q_h_, q_z_, q_grad_;
  Real b_, c1_, c0_, z_max_;
  ReciprocalUnit<Real> unit_;
  LaneFormat quick_z_;
  int bits_;           // of the code
  int mantissa_bits_;  // of w_float
  int w_top_;          // K
};

}  // namespace

std::int64_t biased_code(std::int64_t z, std::int64_t bias, int depth_bits) {
  return std::clamp<std::int64_t>(z + bias, 0, (std::int64_t{1} << depth_bits) - 1);
}

bool passes_depth(DepthCode code, DepthFunc func, std::int64_t z, std::int64_t stored) {
  switch (func) {
    case DepthFunc::never:
      return false;
    case DepthFunc::less:
      return nearer(code, z, stored);
    case DepthFunc::equal:
      return z == stored;
    case DepthFunc::lequal:
      return z == stored || nearer(code, z, stored);
    case DepthFunc::greater:
      return nearer(code, stored, z);
    case DepthFunc::notequal:
      return z != stored;
    case DepthFunc::gequal:
      return z == stored || nearer(code, stored, z);
    case DepthFunc::always:
      return true;
  }
  unreachable();
}

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
    case DepthCode::w_float:
      return (std::int64_t{1} << config.depth_bits) - 1;
    case DepthCode::float_dz:
      return packed({(std::int64_t{1} << config.depth_bits) - 1, 0}, config.depth_bits);
  }
  unreachable();
}

}  // namespace bitspan::golden
