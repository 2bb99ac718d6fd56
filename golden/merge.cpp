// SPDX-License-Identifier: Apache-2.0
#include "golden/merge.hpp"

#include <algorithm>

#include "golden/lanes.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Merging {
 public:
  explicit Merging(const Config& config)
      : q_in_(config.format(FormatId::fog_color)),
        q_alpha_(config.format(FormatId::texture_alpha)),
        q_(config.format(FormatId::merge_color)),
        quick_(config.format(FormatId::merge_color)) {}

  void operator()(std::span<const FogRecord> fogs, std::span<const TextureRecord* const> textures,
                  std::span<const DepthRecord* const> depths, std::span<const std::uint8_t> stored, int width,
                  std::vector<MergeRecord>& out) const {
    const std::size_t first = out.size();
    out.resize(first + fogs.size());
    for (std::size_t i = 0; i < fogs.size(); ++i) {
      MergeRecord& record = out[first + i];
      record.triangle = fogs[i].triangle;
      record.x = fogs[i].x;
      record.y = fogs[i].y;
      record.z = depths[i]->z;
    }
    for (std::size_t at = 0; at < fogs.size(); at += lanes) {
      const std::size_t n = std::min(lanes, fogs.size() - at);
      const std::span records = std::span(out).subspan(first + at, n);
      const std::span in = fogs.subspan(at, n);
      const std::span alphas = textures.subspan(at, n);
      if (quick(in, alphas, stored, width, records)) continue;
      for (std::size_t i = 0; i < n; ++i) {
        blend(in[i], *alphas[i], stored.subspan(color_at(in[i], width), 3), records[i]);
      }
    }
  }

 private:
  static std::size_t color_at(const FogRecord& fog, int width) {
    return 4 * static_cast<std::size_t>(fog.y * width + fog.x);
  }

  void blend(const FogRecord& fog, const TextureRecord& texture, std::span<const std::uint8_t> stored,
             MergeRecord& out) const {
    const Real alpha = q_alpha_.value(texture.a);
    const auto channel = [&](std::int64_t raw, std::uint8_t code) {
      const Real source = q_in_.value(raw);
      if (alpha >= 1) return q_.raw(q_(source));
      const Real below = Real(code);
      return q_.raw(q_.sum(below, (source - below) * alpha));
    };
    out.r = channel(fog.r, stored[0]);
    out.g = channel(fog.g, stored[1]);
    out.b = channel(fog.b, stored[2]);
  }

  // The colours of all, or false.
  bool quick(std::span<const FogRecord> fogs, std::span<const TextureRecord* const> textures,
             std::span<const std::uint8_t> stored, int width, std::span<MergeRecord> out) const {
    if constexpr (std::same_as<Real, double>) {
      if (!quick_.usable) return false;
      const std::size_t n = fogs.size();
      constexpr std::array in{&FogRecord::r, &FogRecord::g, &FogRecord::b};
      constexpr std::array result{&MergeRecord::r, &MergeRecord::g, &MergeRecord::b};
      const double scale = 1 / q_.ulp();
      std::array<Column, 3> color;  // NOLINT(cppcoreguidelines-pro-type-member-init): n lanes are set
      Column below, alpha;          // NOLINT(cppcoreguidelines-pro-type-member-init): n lanes are set
      for (std::size_t i = 0; i < n; ++i) alpha.at[i] = static_cast<double>(textures[i]->a);
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < n; ++i) {
          color[c].at[i] = q_in_.value(fogs[i].*in[c]);
          below.at[i] = stored[color_at(fogs[i], width) + c];
        }
        if (lanes_narrow_toward(below, color[c], alpha, q_alpha_.ulp(), 1 / q_alpha_.ulp(), scale, quick_, n,
                                color[c]) != 0) {
          return false;
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < n; ++i) out[i].*result[c] = static_cast<std::int64_t>(color[c].at[i]);
      }
      return true;
    }
    return false;
  }

  Quantizer<Real> q_in_, q_alpha_, q_;
  LaneFormat quick_;
};

}  // namespace

MergeStage make_merge(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> MergeStage { return Merging<Real>(config); });
}

}  // namespace bitspan::golden
