// SPDX-License-Identifier: Apache-2.0
#include "golden/texture.hpp"

#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "golden/compare.hpp"
#include "golden/lanes.hpp"
#include "golden/texel.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

using Texel = std::array<std::uint8_t, channels>;

template <class Real>
class Texturing {
 public:
  explicit Texturing(const Config& config)
      : filter_(config.filter),
        wrap_(config.wrap),
        border_(config.border),
        transparent_(config.transparent),
        q_uv_(config.format(FormatId::span_uv)),
        q_shade_(config.format(FormatId::span_shade)),
        q_frac_(config.format(FormatId::texture_frac)),
        q_mix_(config.format(FormatId::texture_mix)),
        q_color_(config.format(FormatId::texture_color)),
        q_alpha_(config.format(FormatId::texture_alpha)),
        alpha_format_(config.format(FormatId::texture_alpha)),
        mixes_levels_(mixes_levels(config.mip)),
        q_level_(config.format(FormatId::lod_frac)),
        quick_mix_(config.format(FormatId::texture_mix)),
        quick_color_(config.format(FormatId::texture_color)),
        quick_alpha_(config.format(FormatId::texture_alpha)) {
    for (std::size_t code = 0; code < alpha_.size(); ++code) {
      alpha_[code] = q_alpha_.quotient(Real(static_cast<int>(code)), Real(255));
    }
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
      if (quick(part, texture, records)) continue;
      for (std::size_t i = 0; i < part.size(); ++i) one(*part[i], texture, records[i]);
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
        one(*fragments[i], nullptr, record);
      } else {
        one_of_levels(*fragments[i], *levels, lods[i], record);
      }
    }
    test_alpha(state, std::span(out).subspan(first));
  }

 private:
  void test_alpha(const DrawState& state, std::span<TextureRecord> records) const {
    if (state.alpha_func == CompareFunc::always) return;
    const Quantizer<Quad> alpha(alpha_format_);
    for (TextureRecord& record : records) {
      const bool passes = holds(state.alpha_func, alpha.value(record.a) * 255, Quad(state.alpha_ref));
      if (!passes) record.killed = 1;
    }
  }

  // Where a fragment looks, and what it finds there.
  struct Place {
    std::int64_t i = 0, j = 0;   // wrapped
    Real ex = 0, ey = 0;         // bilinear
    std::array<Texel, 4> texel;  // nearest: [0]; bilinear: V1..V4
    bool killed = false;
  };

  void one(const FragmentRecord& fragment, const Texture* texture, TextureRecord& out) const {
    Shades<Real> texel = no_texture_;
    bool killed = false;
    if (texture != nullptr) {
      const Place place = look_up(*texture, q_uv_.value(fragment.u), q_uv_.value(fragment.v));
      out.i = place.i;
      out.j = place.j;
      if (weighs_texels(filter_)) {
        out.ex = q_frac_.raw(place.ex);
        out.ey = q_frac_.raw(place.ey);
      }
      killed = place.killed;
      texel = sample(place);
    }
    finish(fragment, texel, killed, out);
  }

  void one_of_levels(const FragmentRecord& fragment, const std::vector<Texture>& levels, const LodRecord& lod,
                     TextureRecord& out) const {
    const auto place_in = [&](std::int64_t level) {
      const Real size = pow2<Real>(static_cast<int>(-level));
      return look_up(levels[static_cast<std::size_t>(level)], q_uv_.value(fragment.u) * size,
                     q_uv_.value(fragment.v) * size);
    };
    const Place place = place_in(lod.level);
    out.i = place.i;
    out.j = place.j;
    if (weighs_texels(filter_)) {
      out.ex = q_frac_.raw(place.ex);
      out.ey = q_frac_.raw(place.ey);
    }
    Shades<Real> texel = sample(place);
    if (mixes_levels_) {
      const std::int64_t coarser = std::min(lod.level + 1, static_cast<std::int64_t>(levels.size()) - 1);
      const Shades<Real> other = sample(place_in(coarser));
      const Real f = q_level_.value(lod.f);
      for (std::size_t c = 0; c < channels; ++c) {
        const Quantizer<Real>& q = c == channels - 1 ? q_alpha_ : q_mix_;
        texel[c] = q.sum(texel[c] * (1 - f), other[c] * f);
      }
    }
    finish(fragment, texel, place.killed, out);
  }

  void finish(const FragmentRecord& fragment, const Shades<Real>& texel, bool killed,
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
    out.killed = killed || alpha == 0 ? 1 : 0;
  }

  // All of them over columns, or false; what it has written by then, one() writes again.
  bool quick(std::span<const FragmentRecord* const> fragments, const Texture* texture,
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
      } else if (!quick_sample(fragments, *texture, out, dead, v)) {
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
      for (std::size_t i = 0; i < n; ++i) out[i].killed = dead[i] != 0 || out[i].a == 0 ? 1 : 0;
      return true;
    }
    return false;
  }

  // V of each fragment, in ulps of texture.mix and texture.alpha.
  bool quick_sample(std::span<const FragmentRecord* const> fragments, const Texture& texture,
                    std::span<TextureRecord> out, std::array<std::uint8_t, lanes>& dead,
                    std::array<Column, channels>& v) const requires std::same_as<Real, double> {
    switch (filter_) {
      case TextureFilter::nearest:
        return quick_nearest(fragments, texture, out, dead, v);
      case TextureFilter::bilinear:
        return quick_bilinear(fragments, texture, out, dead, v);
    }
    unreachable();
  }
  bool quick_nearest(std::span<const FragmentRecord* const> fragments, const Texture& texture,
                     std::span<TextureRecord> out, std::array<std::uint8_t, lanes>& dead,
                     std::array<Column, channels>& v) const requires std::same_as<Real, double> {
    const std::size_t n = fragments.size();
    const double alpha_scale = 1 / q_alpha_.ulp();
    const double mix_scale = 1 / q_mix_.ulp();
    for (std::size_t i = 0; i < n; ++i) {
      const Place place = look_up(texture, q_uv_.value(fragments[i]->u), q_uv_.value(fragments[i]->v));
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
  bool quick_bilinear(std::span<const FragmentRecord* const> fragments, const Texture& texture,
                      std::span<TextureRecord> out, std::array<std::uint8_t, lanes>& dead,
                      std::array<Column, channels>& v) const requires std::same_as<Real, double> {
    const std::size_t n = fragments.size();
    const double alpha_scale = 1 / q_alpha_.ulp();
    const double mix_scale = 1 / q_mix_.ulp();
    // The texels in units of 1; V5 and V6 come out in ulps.
    std::array<std::array<Column, channels>, 4> texel;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    Column ex, ey;                                      // NOLINT(cppcoreguidelines-pro-type-member-init)
    for (std::size_t i = 0; i < n; ++i) {
      const Place place = look_up(texture, q_uv_.value(fragments[i]->u), q_uv_.value(fragments[i]->v));
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

  std::int64_t wrapped(std::int64_t i, std::int64_t size) const {
    if (i >= 0 && i < size) return i;
    switch (wrap_) {
      case TextureWrap::clamp:
        return std::clamp<std::int64_t>(i, 0, size - 1);
      case TextureWrap::cyclic: {
        if ((size & (size - 1)) == 0) return i & (size - 1);
        const std::int64_t rest = i % size;
        return rest < 0 ? rest + size : rest;
      }
      case TextureWrap::mirror: {
        // Copy number 0 lies at 0 .. size-1; those with odd numbers are turned round.
        const std::int64_t copy = i >= 0 ? i / size : -1 - (-1 - i) / size;
        const std::int64_t within = i - copy * size;
        return copy % 2 == 0 ? within : size - 1 - within;
      }
      case TextureWrap::border:
        return i < 0 ? -1 : size;
    }
    unreachable();
  }
  // i and j are wrapped.
  Texel fetch(const Texture& texture, std::int64_t i, std::int64_t j) const {
    if (i < 0 || j < 0 || i == texture.width || j == texture.height) return border_;
    return fetch_texel(texture, i, j);
  }
  bool reserved(const Texel& texel) const {
    return transparent_ && texel[0] == (*transparent_)[0] && texel[1] == (*transparent_)[1] &&
           texel[2] == (*transparent_)[2];
  }

  Place look_up(const Texture& texture, Real u, Real v) const {
    Place out;
    const std::int64_t nearest_i = wrapped(to_integer(floor_of(u)), texture.width);
    const std::int64_t nearest_j = wrapped(to_integer(floor_of(v)), texture.height);
    const Texel nearest = fetch(texture, nearest_i, nearest_j);
    out.killed = reserved(nearest);
    switch (filter_) {
      case TextureFilter::nearest:
        out.i = nearest_i;
        out.j = nearest_j;
        out.texel[0] = nearest;
        break;
      case TextureFilter::bilinear: {
        const Real left = floor_of(u - Real(0.5));
        const Real top = floor_of(v - Real(0.5));
        out.ex = q_frac_(u - Real(0.5) - left);
        out.ey = q_frac_(v - Real(0.5) - top);
        const std::int64_t i = to_integer(left);
        const std::int64_t j = to_integer(top);
        out.i = wrapped(i, texture.width);
        out.j = wrapped(j, texture.height);
        const std::int64_t right = wrapped(i + 1, texture.width);
        const std::int64_t below = wrapped(j + 1, texture.height);
        const auto texel = [&](std::int64_t column, std::int64_t row) {
          const Texel own = fetch(texture, column, row);
          return reserved(own) ? nearest : own;
        };
        out.texel = {texel(out.i, out.j), texel(out.i, below), texel(right, below), texel(right, out.j)};
        break;
      }
    }
    return out;
  }

  Shades<Real> sample(const Place& place) const {
    switch (filter_) {
      case TextureFilter::nearest: {
        const Texel& t = place.texel[0];
        return {q_mix_(Real(t[0])), q_mix_(Real(t[1])), q_mix_(Real(t[2])), alpha_[t[3]]};
      }
      case TextureFilter::bilinear:
        return mixed(place);
    }
    unreachable();
  }
  Shades<Real> mixed(const Place& place) const {
    const auto& [v1, v2, v3, v4] = place.texel;
    const auto mix = [](const Quantizer<Real>& q, Real from, Real to, Real share) {
      return q.sum(from * (1 - share), to * share);
    };
    Shades<Real> out;
    for (std::size_t c = 0; c < channels; ++c) {
      const bool is_alpha = c == channels - 1;
      const Quantizer<Real>& q = is_alpha ? q_alpha_ : q_mix_;
      const auto value = [&](const Texel& t) { return is_alpha ? alpha_[t[c]] : Real(t[c]); };
      const Real v5 = mix(q, value(v1), value(v4), place.ex);
      const Real v6 = mix(q, value(v2), value(v3), place.ex);
      out[c] = mix(q, v5, v6, place.ey);
    }
    return out;
  }

  TextureFilter filter_;
  TextureWrap wrap_;
  Texel border_;
  std::optional<std::array<std::uint8_t, 3>> transparent_;
  Quantizer<Real> q_uv_, q_shade_, q_frac_, q_mix_, q_color_, q_alpha_;
  Format alpha_format_;
  std::array<Real, 256> alpha_{};
  Shades<Real> no_texture_;
  bool mixes_levels_;
  Quantizer<Real> q_level_;
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
