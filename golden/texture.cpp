// SPDX-License-Identifier: Apache-2.0
#include "golden/texture.hpp"

#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "golden/lanes.hpp"
#include "golden/sampling.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Texturing : Sampling<Real> {
  using Place = typename Sampling<Real>::Place;
  using Sampling<Real>::alpha_;
  using Sampling<Real>::look_up;
  using Sampling<Real>::q_alpha_;
  using Sampling<Real>::q_frac_;
  using Sampling<Real>::q_mix_;
  using Sampling<Real>::q_uv_;
  using Sampling<Real>::sample;
  using Sampling<Real>::tell;

 public:
  explicit Texturing(const Config& config)
      : Sampling<Real>(config),
        q_shade_(config.format(shade_factor(config))),
        q_color_(config.format(FormatId::texture_color)),
        alpha_format_(config.format(FormatId::texture_alpha)),
        mixes_levels_(mixes_levels(config.mip)),
        quick_mix_(config.format(FormatId::texture_mix)),
        quick_color_(config.format(FormatId::texture_color)),
        quick_alpha_(config.format(FormatId::texture_alpha)) {
    no_texture_ = {q_mix_(Real(255)), q_mix_(Real(255)), q_mix_(Real(255)), q_alpha_(Real(1))};
  }

  void operator()(std::span<const FragmentRecord* const> fragments, const Texture* texture,
                  const DrawState& state, std::vector<TextureRecord>& out) const {
    const std::size_t first = out.size();
    out.resize(first + fragments.size());
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      TextureRecord& record = out[first + i];
      record.triangle = fragments[i]->triangle;
      record.x = fragments[i]->x;
      record.y = fragments[i]->y;
    }
    for (std::size_t at = 0; at < fragments.size(); at += lanes) {
      const std::span part = fragments.subspan(at, std::min(lanes, fragments.size() - at));
      const std::span records = std::span(out).subspan(first + at, part.size());
      if (quick(state, part, texture, records)) continue;
      for (std::size_t i = 0; i < part.size(); ++i) one(state, *part[i], texture, records[i]);
    }
    test_alpha(state, std::span(out).subspan(first));
  }

  void operator()(std::span<const FragmentRecord* const> fragments, std::span<const LodRecord> lods,
                  const std::vector<Texture>* levels, const DrawState& state,
                  std::vector<TextureRecord>& out) const {
    const std::size_t first = out.size();
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      TextureRecord& record = out.emplace_back();
      record.triangle = fragments[i]->triangle;
      record.x = fragments[i]->x;
      record.y = fragments[i]->y;
      if (levels == nullptr) {
        one(state, *fragments[i], nullptr, record);
      } else {
        one_of_levels(state, *fragments[i], *levels, lods[i], record);
      }
    }
    test_alpha(state, std::span(out).subspan(first));
  }

 private:
  void test_alpha(const DrawState& state, std::span<TextureRecord> records) const {
    // Behind a second unit it is the combined alpha that is tested.
    if (has_second_texture(state)) return;
    for (TextureRecord& record : records) {
      if (!passes_alpha_test(state, alpha_format_, record.a)) record.killed = 1;
    }
  }

  void one(const DrawState& state, const FragmentRecord& fragment, const Texture* texture,
           TextureRecord& out) const {
    const TexelLookup by = first_lookup(state);
    Shades<Real> texel = no_texture_;
    bool killed = false;
    if (texture != nullptr) {
      const Place place = look_up(state, by, *texture, q_uv_.value(fragment.u), q_uv_.value(fragment.v));
      tell(place, out);
      killed = place.killed;
      texel = sample(by.filter, place);
    }
    finish(state, fragment, texel, killed, out);
  }

  void one_of_levels(const DrawState& state, const FragmentRecord& fragment,
                     const std::vector<Texture>& levels, const LodRecord& lod, TextureRecord& out) const {
    const TexelLookup by =
        this->lookup_at(lod.lambda, first_levels(state), first_lookup(state), first_magnified(state));
    const Place place = this->look_up_level(state, by, levels, lod.level, fragment);
    tell(place, out);
    Shades<Real> texel = sample(by.filter, place);
    if (mixes_levels_) this->mix_levels(state, by, levels, lod.level, lod.f, fragment, texel);
    finish(state, fragment, texel, place.killed, out);
  }

  void finish(const DrawState& state, const FragmentRecord& fragment, const Shades<Real>& texel, bool killed,
              TextureRecord& out) const {
    const Shades<Real> shade = load_shades(q_shade_, fragment.r, fragment.g, fragment.b, fragment.a);
    const Real alpha = q_alpha_(texel[3] * shade[3]);
    out.texel_r = q_mix_.raw(texel[0]);
    out.texel_g = q_mix_.raw(texel[1]);
    out.texel_b = q_mix_.raw(texel[2]);
    out.texel_a = q_alpha_.raw(texel[3]);
    out.r = q_color_.raw(q_color_(texel[0] * shade[0]));
    out.g = q_color_.raw(q_color_(texel[1] * shade[1]));
    out.b = q_color_.raw(q_color_(texel[2] * shade[2]));
    out.a = q_alpha_.raw(alpha);
    out.killed = killed || (kills_zero(state) && alpha == 0 && !has_second_texture(state)) ? 1 : 0;
  }

  // All of them over columns, or false; what it has written by then, one() writes again.
  bool quick(const DrawState& state, std::span<const FragmentRecord* const> fragments, const Texture* texture,
             std::span<TextureRecord> out) const {
    if constexpr (std::same_as<Real, double>) {
      if (!quick_mix_.usable || !quick_color_.usable || !quick_alpha_.usable) return false;
      const std::size_t n = fragments.size();
      // V, and the texels it is mixed from, a channel each.
      std::array<Column, channels> v;  // NOLINT(cppcoreguidelines-pro-type-member-init): n lanes are set
      std::array<std::uint8_t, lanes> dead{};
      if (texture == nullptr) {
        for (std::size_t c = 0; c < channels; ++c) {
          const double raw = no_texture_[c] / (c == 3 ? q_alpha_.ulp() : q_mix_.ulp());
          for (std::size_t i = 0; i < n; ++i) v[c].at[i] = raw;
        }
      } else if (!quick_sample(state, fragments, *texture, out, dead, v)) {
        return false;
      }
      constexpr std::array shades{&FragmentRecord::r, &FragmentRecord::g, &FragmentRecord::b,
                                  &FragmentRecord::a};
      constexpr std::array texels{&TextureRecord::texel_r, &TextureRecord::texel_g, &TextureRecord::texel_b,
                                  &TextureRecord::texel_a};
      constexpr std::array results{&TextureRecord::r, &TextureRecord::g, &TextureRecord::b,
                                   &TextureRecord::a};
      for (std::size_t c = 0; c < channels; ++c) {
        Column shade, result;  // NOLINT(cppcoreguidelines-pro-type-member-init): n lanes are set
        for (std::size_t i = 0; i < n; ++i) shade.at[i] = static_cast<double>(fragments[i]->*shades[c]);
        const double in_ulp = c == 3 ? q_alpha_.ulp() : q_mix_.ulp();
        const double scale = in_ulp * q_shade_.ulp() / (c == 3 ? q_alpha_.ulp() : q_color_.ulp());
        if (lanes_narrow_short(v[c], shade, scale, c == 3 ? quick_alpha_ : quick_color_, n, result) != 0) {
          return false;
        }
        for (std::size_t i = 0; i < n; ++i) out[i].*texels[c] = static_cast<std::int64_t>(v[c].at[i]);
        for (std::size_t i = 0; i < n; ++i) out[i].*results[c] = static_cast<std::int64_t>(result.at[i]);
      }
      const bool kills = kills_zero(state) && !has_second_texture(state);
      for (std::size_t i = 0; i < n; ++i) {
        out[i].killed = dead[i] != 0 || (kills && out[i].a == 0) ? 1 : 0;
      }
      return true;
    }
    return false;
  }

  // V of each fragment, in ulps of texture.mix and texture.alpha.
  bool quick_sample(const DrawState& state, std::span<const FragmentRecord* const> fragments,
                    const Texture& texture, std::span<TextureRecord> out,
                    std::array<std::uint8_t, lanes>& dead,
                    std::array<Column, channels>& v) const requires std::same_as<Real, double> {
    switch (state.texture_filter) {
      case TextureFilter::nearest:
        return quick_nearest(state, fragments, texture, out, dead, v);
      case TextureFilter::bilinear:
        return quick_bilinear(state, fragments, texture, out, dead, v);
    }
    unreachable();
  }
  bool quick_nearest(const DrawState& state, std::span<const FragmentRecord* const> fragments,
                     const Texture& texture, std::span<TextureRecord> out,
                     std::array<std::uint8_t, lanes>& dead,
                     std::array<Column, channels>& v) const requires std::same_as<Real, double> {
    const std::size_t n = fragments.size();
    const TexelLookup by = first_lookup(state);
    const double alpha_scale = 1 / q_alpha_.ulp();
    const double mix_scale = 1 / q_mix_.ulp();
    for (std::size_t i = 0; i < n; ++i) {
      const Place place =
          look_up(state, by, texture, q_uv_.value(fragments[i]->u), q_uv_.value(fragments[i]->v));
      out[i].i = place.i;
      out[i].j = place.j;
      dead[i] = place.killed ? 1 : 0;
      for (std::size_t c = 0; c < 3; ++c) v[c].at[i] = place.texel[0][c];
      v[3].at[i] = alpha_[place.texel[0][3]];
    }
    for (std::size_t c = 0; c < 3; ++c) {
      if (lanes_narrow(v[c], mix_scale, quick_mix_, n, v[c]) != 0) return false;
    }
    return lanes_narrow(v[3], alpha_scale, quick_alpha_, n, v[3]) == 0;
  }
  bool quick_bilinear(const DrawState& state, std::span<const FragmentRecord* const> fragments,
                      const Texture& texture, std::span<TextureRecord> out,
                      std::array<std::uint8_t, lanes>& dead,
                      std::array<Column, channels>& v) const requires std::same_as<Real, double> {
    const std::size_t n = fragments.size();
    const TexelLookup by = first_lookup(state);
    const double alpha_scale = 1 / q_alpha_.ulp();
    const double mix_scale = 1 / q_mix_.ulp();
    // The texels in units of 1; V5 and V6 come out in ulps.
    std::array<std::array<Column, channels>, 4> texel;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    Column ex, ey;                                      // NOLINT(cppcoreguidelines-pro-type-member-init)
    for (std::size_t i = 0; i < n; ++i) {
      const Place place =
          look_up(state, by, texture, q_uv_.value(fragments[i]->u), q_uv_.value(fragments[i]->v));
      out[i].i = place.i;
      out[i].j = place.j;
      out[i].ex = q_frac_.raw(place.ex);
      out[i].ey = q_frac_.raw(place.ey);
      ex.at[i] = place.ex;
      ey.at[i] = place.ey;
      dead[i] = place.killed ? 1 : 0;
      for (std::size_t t = 0; t < 4; ++t) {
        for (std::size_t c = 0; c < 3; ++c) texel[t][c].at[i] = place.texel[t][c];
        texel[t][3].at[i] = alpha_[place.texel[t][3]];
      }
    }
    for (std::size_t c = 0; c < channels; ++c) {
      const LaneFormat& q = c == 3 ? quick_alpha_ : quick_mix_;
      const double scale = c == 3 ? alpha_scale : mix_scale;
      Column& v5 = texel[0][c];
      Column& v6 = texel[1][c];
      if (lanes_narrow_mix(texel[0][c], texel[3][c], ex, scale, q, n, v5) != 0) return false;
      if (lanes_narrow_mix(texel[1][c], texel[2][c], ex, scale, q, n, v6) != 0) return false;
      if (lanes_narrow_mix(v5, v6, ey, 1.0, q, n, v[c]) != 0) return false;
    }
    return true;
  }

  Quantizer<Real> q_shade_, q_color_;
  Format alpha_format_;
  Shades<Real> no_texture_;
  bool mixes_levels_;
  LaneFormat quick_mix_, quick_color_, quick_alpha_;
};

}  // namespace

TextureStage make_texture(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> TextureStage { return Texturing<Real>(config); });
}

MipTextureStage make_mip_texture(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> MipTextureStage { return Texturing<Real>(config); });
}

}  // namespace bitspan::golden
