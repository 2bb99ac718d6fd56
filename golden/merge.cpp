// SPDX-License-Identifier: Apache-2.0
#include "golden/merge.hpp"

#include <algorithm>

#include "golden/blend.hpp"
#include "golden/lanes.hpp"
#include "golden/target.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// Any blend and logic operation, in 113 bits.
class Blending {
 public:
  explicit Blending(const Config& config)
      : in_(config.format(FormatId::fog_color)),
        alpha_(config.format(FormatId::texture_alpha)),
        q_(config.format(FormatId::merge_color)) {}

  // r, g and b of the record; stored: the pixel's RGBA.
  void color(const DrawState& state, const FogRecord& fog, const TextureRecord& texture,
             std::span<const std::uint8_t> stored, MergeRecord& out) const {
    const std::array constant{state.blend_red, state.blend_green, state.blend_blue};
    const std::array source{fog.r, fog.g, fog.b};
    std::array<std::int64_t, 3> result{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Quad src = in_.value(source[c]);
      if (state.logic_op != LogicOp::none) {
        result[c] = logic(state.logic_op, static_cast<unsigned>(q_.raw(q_(src))), stored[c]);
        continue;
      }
      Quad code = floor_of(src + Quad(0.5));
      if (code < 0) code = 0;
      if (code > 255) code = 255;
      const BlendShares<Quad> shares{alpha(texture),   share(code),        share(stored[c]),
                                     share(stored[3]), share(constant[c]), share(state.blend_alpha)};
      const Quad dst = stored[c];
      result[c] = q_.raw(q_(combine(state.blend_op, src, dst, shares.of(state.blend_src, false),
                                    shares.of(state.blend_dst, false))));
    }
    out.r = result[0];
    out.g = result[1];
    out.b = result[2];
  }

  std::int64_t alpha(const DrawState& state, const TextureRecord& texture, std::uint8_t stored) const {
    const Quad a = alpha(texture);
    const Quad src = floor_of(255 * a + Quad(0.5));
    if (state.logic_op != LogicOp::none) return logic(state.logic_op, static_cast<unsigned>(src), stored);
    const BlendShares<Quad> shares{
        a, a, share(stored), share(stored), share(state.blend_alpha), share(state.blend_alpha)};
    return q_.raw(q_(combine<Quad>(state.blend_alpha_op, src, stored, shares.of(state.blend_alpha_src, true),
                                   shares.of(state.blend_alpha_dst, true))));
  }

 private:
  // c(n)
  static Quad share(Quad n) { return (n + floor_of(n / 128)) / 256; }
  Quad alpha(const TextureRecord& texture) const {
    const Quad a = alpha_.value(texture.a);
    return a > 1 ? Quad(1) : a;
  }
  Quantizer<Quad> in_, alpha_, q_;
};

bool keeps_alpha(const DrawState& s) {
  return s.logic_op == LogicOp::none && s.blend_alpha_src == BlendFactor::zero &&
         s.blend_alpha_dst == BlendFactor::one && s.blend_alpha_op == BlendOp::add;
}
// The blend is T5's: by the fragment's alpha.
bool mixes_by_alpha(const DrawState& s) {
  return keeps_alpha(s) && s.blend_src == BlendFactor::src_alpha &&
         s.blend_dst == BlendFactor::one_minus_src_alpha && s.blend_op == BlendOp::add;
}

template <class Real>
class Merging {
 public:
  explicit Merging(const Config& config)
      : q_in_(config.format(FormatId::fog_color)),
        q_alpha_(config.format(FormatId::texture_alpha)),
        q_(config.format(FormatId::merge_color)),
        quick_(config.format(FormatId::merge_color)),
        blending_(config) {}

  void operator()(std::span<const FogRecord> fogs, std::span<const TextureRecord* const> textures,
                  std::span<const DepthRecord* const> depths, const DrawState& state,
                  std::span<const std::uint8_t> stored, PixelGrid grid, std::vector<MergeRecord>& out,
                  std::vector<MergeAlphaRecord>& alphas) const {
    const std::size_t first = out.size();
    out.resize(first + fogs.size());
    for (std::size_t i = 0; i < fogs.size(); ++i) {
      MergeRecord& record = out[first + i];
      record.triangle = fogs[i].triangle;
      record.x = fogs[i].x;
      record.y = fogs[i].y;
      record.z = depths[i]->z;
    }
    const bool narrow = is_narrow(state.target_format);
    if (narrow || !mixes_by_alpha(state)) {
      for (std::size_t i = 0; i < fogs.size(); ++i) {
        const FogRecord& fog = fogs[i];
        MergeRecord& merged = out[first + i];
        const auto pixel = stored.subspan(color_at(fog, grid), 4);
        blending_.color(state, fog, *textures[i], pixel, merged);
        if (!narrow && keeps_alpha(state)) continue;
        const std::int64_t alpha = blending_.alpha(state, *textures[i], pixel[3]);
        merged.r = held(state, 0, merged.r, fog.x, fog.y);
        merged.g = held(state, 1, merged.g, fog.x, fog.y);
        merged.b = held(state, 2, merged.b, fog.x, fog.y);
        alphas.push_back({fog.triangle, fog.x, fog.y, held(state, 3, alpha, fog.x, fog.y)});
      }
      return;
    }
    for (std::size_t at = 0; at < fogs.size(); at += lanes) {
      const std::size_t n = std::min(lanes, fogs.size() - at);
      const std::span records = std::span(out).subspan(first + at, n);
      const std::span in = fogs.subspan(at, n);
      const std::span alphas = textures.subspan(at, n);
      if (quick(in, alphas, stored, grid, records)) continue;
      for (std::size_t i = 0; i < n; ++i) {
        blend(in[i], *alphas[i], stored.subspan(color_at(in[i], grid), 3), records[i]);
      }
    }
  }

 private:
  static std::size_t color_at(const FogRecord& fog, PixelGrid grid) {
    return 4 * static_cast<std::size_t>(grid.place(fog.x, fog.y));
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
             std::span<const std::uint8_t> stored, PixelGrid grid, std::span<MergeRecord> out) const {
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
          below.at[i] = stored[color_at(fogs[i], grid) + c];
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
  Blending blending_;
};

}  // namespace

int logic(LogicOp op, unsigned src, unsigned dst) {
  const auto s = static_cast<int>(src);
  const auto d = static_cast<int>(dst);
  const auto no = [](int code) { return 255 - code; };
  switch (op) {
    case LogicOp::none:
    case LogicOp::copy:
      return s;
    case LogicOp::clear:
      return 0;
    case LogicOp::conjunction:
      return s & d;
    case LogicOp::and_reverse:
      return s & no(d);
    case LogicOp::and_inverted:
      return no(s) & d;
    case LogicOp::noop:
      return d;
    case LogicOp::exclusive_or:
      return s ^ d;
    case LogicOp::disjunction:
      return s | d;
    case LogicOp::nor:
      return no(s | d);
    case LogicOp::equiv:
      return no(s ^ d);
    case LogicOp::invert:
      return no(d);
    case LogicOp::or_reverse:
      return s | no(d);
    case LogicOp::copy_inverted:
      return no(s);
    case LogicOp::or_inverted:
      return no(s) | d;
    case LogicOp::nand:
      return no(s & d);
    case LogicOp::set:
      return 255;
  }
  return s;
}

MergeStage make_merge(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> MergeStage { return Merging<Real>(config); });
}

}  // namespace bitspan::golden
