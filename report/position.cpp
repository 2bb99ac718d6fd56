// SPDX-License-Identifier: Apache-2.0
#include "report/position.hpp"

#include <cmath>
#include <limits>

#include "config/modes.hpp"
#include "engine/records.hpp"
#include "golden/constants.hpp"
#include "golden/packed_depth.hpp"

namespace bitspan {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

}  // namespace

DistanceOfCode::DistanceOfCode(const Config& config, const Scene& scene)
    : depth_code_(config.depth_code), largest_(std::exp2(config.depth_bits) - 1), bits_(config.depth_bits) {
  const golden::Constants constants = golden::make_constants(config, scene);
  const ConstantsRecord& record = constants.record;
  const auto value = [&](std::int64_t raw, FormatId id) {
    return std::ldexp(static_cast<double>(raw), -config.format(id).fraction());
  };
  b_ = value(record.b, FormatId::setup_b);
  a_ = std::ldexp(b_ * value(record.s_max, FormatId::setup_s), constants.s_exponent);
  c1_ = value(record.c1, FormatId::depth_c1);
  c0_ = value(record.c0, FormatId::depth_c0);
  w_step_ = std::exp2(config.depth_bits - w_float_exponent_bits);
  if (std::frexp(largest_ + b_, &w_top_) == 0.5) --w_top_;
}

double DistanceOfCode::operator()(std::uint32_t code) const {
  const double z = code;
  switch (depth_code_) {
    case DepthCode::inverse:
      return z == 0 ? none : a_ / (z + b_);
    case DepthCode::opengl:
      return z == largest_ ? none : a_ / (largest_ - z + b_);
    case DepthCode::linear:
      return z == largest_ || c1_ == 0 ? none : a_ * (z + c0_) / c1_;
    case DepthCode::w_float: {
      if (z == largest_) return none;
      const double octave = std::floor(z / w_step_);
      return a_ / std::ldexp(octave + 2 - z / w_step_, w_top_ - 1 - static_cast<int>(octave));
    }
    case DepthCode::float_dz: {
      if (z == largest_ - largest_dz) return none;
      return a_ / (largest_ - static_cast<double>(golden::unpacked(code, bits_).z) + b_);
    }
  }
  unreachable();
}

Positions positions_of(const Config& config, const Scene& scene, const Frame& frame) {
  const DistanceOfCode distance(config, scene);
  Positions out;
  out.s.reserve(frame.depth.size());
  out.points.reserve(3 * frame.depth.size());
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const double s = distance(frame.depth[out.s.size()]);
      const double across = x + 0.5 - frame.width / 2.0;
      const double down = y + 0.5 - frame.height / 2.0;
      out.s.push_back(s);
      out.points.insert(out.points.end(), {across * s / scene.focal, down * s / scene.focal, s});
    }
  }
  return out;
}

}  // namespace bitspan
