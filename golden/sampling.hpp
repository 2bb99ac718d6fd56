// SPDX-License-Identifier: Apache-2.0
// What both texture units share: where a fragment looks, the texels that it finds there, their filter, and
// the alpha test. [T3, T4, T10, T11]
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "config/modes.hpp"
#include "engine/records.hpp"
#include "golden/compare.hpp"
#include "golden/lod.hpp"
#include "golden/texel.hpp"
#include "golden/values.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Whether the translucency pass and the alpha test take a fragment's alpha, raw on the format.
inline bool passes_alpha_test(const DrawState& state, const Format& format, std::int64_t a) {
  if (state.alpha_func == CompareFunc::always && state.translucency_pass == TranslucencyPass::all)
    return true;
  const Quad alpha = Quantizer<Quad>(format).value(a);
  if (!takes_alpha(state.translucency_pass, alpha)) return false;
  const Quad code = floor_of((alpha > 1 ? Quad(1) : alpha) * 255 + Quad(0.5));
  return holds(state.alpha_func, code, Quad(state.alpha_ref));
}

template <class Real>
class Sampling {
 protected:
  using Texel = std::array<std::uint8_t, channels>;

  explicit Sampling(const Config& config)
      : border_(config.border),
        transparent_(config.transparent),
        q_uv_(config.format(FormatId::span_uv)),
        q_frac_(config.format(FormatId::texture_frac)),
        q_mix_(config.format(FormatId::texture_mix)),
        q_alpha_(config.format(FormatId::texture_alpha)),
        q_level_(config.format(FormatId::lod_frac)),
        q_lambda_(config.format(FormatId::lod_lambda)) {
    for (std::size_t code = 0; code < alpha_.size(); ++code) {
      alpha_[code] = q_alpha_.quotient(Real(static_cast<int>(code)), Real(255));
    }
  }

  // Where a fragment looks, and what it finds there.
  struct Place {
    std::int64_t i = 0, j = 0;   // wrapped
    Real ex = 0, ey = 0;         // bilinear
    std::array<Texel, 4> texel;  // nearest: [0]; bilinear: V1..V4
    bool killed = false;
  };

  // Into the record of texture or texture.second.
  template <class Record>
  void tell(const Place& place, Record& out) const {
    out.i = place.i;
    out.j = place.j;
    out.ex = q_frac_.raw(place.ex);
    out.ey = q_frac_.raw(place.ey);
  }

  static std::int64_t wrapped(std::int64_t i, std::int64_t size, TextureWrap wrap) {
    if (i >= 0 && i < size) return i;
    switch (wrap) {
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
  // i and j are wrapped in both of these.
  static bool in_border(const Texture& texture, std::int64_t i, std::int64_t j) {
    return i < 0 || j < 0 || i == texture.width || j == texture.height;
  }
  Texel fetch(const Texture& texture, std::int64_t i, std::int64_t j) const {
    if (in_border(texture, i, j)) return border_;
    return fetch_texel(texture, i, j);
  }
  // The reserved colour, or one that the chroma test takes for it.
  bool reserved(const DrawState& s, const Texel& texel) const {
    const bool in_range = texel[0] >= s.chroma_low_red && texel[0] <= s.chroma_high_red &&
                          texel[1] >= s.chroma_low_green && texel[1] <= s.chroma_high_green &&
                          texel[2] >= s.chroma_low_blue && texel[2] <= s.chroma_high_blue;
    if (s.chroma_test == ChromaTest::inside && in_range) return true;
    if (s.chroma_test == ChromaTest::outside && !in_range) return true;
    return transparent_ && texel[0] == (*transparent_)[0] && texel[1] == (*transparent_)[1] &&
           texel[2] == (*transparent_)[2];
  }

  // state: for its chroma range.
  Place look_up(const DrawState& state, const TexelLookup& by, const Texture& texture, Real u, Real v) const {
    return look_up(state, by, texture, u, v,
                   [&](std::int64_t i, std::int64_t j) { return fetch(texture, i, j); });
  }
  // fetched: gives the texel of a wrapped column and row.
  template <class Fetched>
  Place look_up(const DrawState& state, const TexelLookup& by, const Texture& texture, Real u, Real v,
                const Fetched& fetched) const {
    Place out;
    const auto column = [&](std::int64_t i) { return wrapped(i, texture.width, by.wrap_u); };
    const auto row = [&](std::int64_t j) { return wrapped(j, texture.height, by.wrap_v); };
    const std::int64_t nearest_i = column(to_integer(floor_of(u)));
    const std::int64_t nearest_j = row(to_integer(floor_of(v)));
    const Texel nearest = fetched(nearest_i, nearest_j);
    out.killed = reserved(state, nearest);
    switch (by.filter) {
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
        out.i = column(i);
        out.j = row(j);
        const std::int64_t right = column(i + 1);
        const std::int64_t below = row(j + 1);
        const auto texel = [&](std::int64_t at_i, std::int64_t at_j) {
          const Texel own = fetched(at_i, at_j);
          return reserved(state, own) ? nearest : own;
        };
        out.texel = {texel(out.i, out.j), texel(out.i, below), texel(right, below), texel(right, out.j)};
        break;
      }
    }
    return out;
  }

  Shades<Real> sample(TextureFilter filter, const Place& place) const {
    switch (filter) {
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

  // How a unit looks texels up at a level of detail, raw.
  TexelLookup lookup_at(std::int64_t lambda, const LevelRange& range, const TexelLookup& minified,
                        const TexelLookup& magnified) const {
    return within(range, q_lambda_.value(lambda)) > 0 ? minified : magnified;
  }

  // The same in a level of a chain.
  Place look_up_level(const DrawState& state, const TexelLookup& by, std::span<const Texture> levels,
                      std::int64_t level, const FragmentRecord& fragment) const {
    const Texture& whole = levels.front();
    const Texture& image = levels[static_cast<std::size_t>(level)];
    // Quotients of powers of two; 1 without a chain.
    const Real across = Real(image.width) / Real(whole.width);
    const Real down = Real(image.height) / Real(whole.height);
    return look_up(state, by, image, q_uv_.value(fragment.u) * across, q_uv_.value(fragment.v) * down);
  }
  // Mixes the texel of a level with that of the next one; f: raw, lod.frac.
  void mix_levels(const DrawState& state, const TexelLookup& by, std::span<const Texture> levels,
                  std::int64_t level, std::int64_t f, const FragmentRecord& fragment,
                  Shades<Real>& texel) const {
    const std::int64_t coarser = std::min(level + 1, static_cast<std::int64_t>(levels.size()) - 1);
    const Shades<Real> other = sample(by.filter, look_up_level(state, by, levels, coarser, fragment));
    const Real share = q_level_.value(f);
    for (std::size_t c = 0; c < channels; ++c) {
      const Quantizer<Real>& q = c == channels - 1 ? q_alpha_ : q_mix_;
      texel[c] = q.sum(texel[c] * (1 - share), other[c] * share);
    }
  }

  Texel border_;
  std::optional<std::array<std::uint8_t, 3>> transparent_;
  Quantizer<Real> q_uv_, q_frac_, q_mix_, q_alpha_, q_level_, q_lambda_;
  std::array<Real, 256> alpha_{};
};

}  // namespace bitspan::golden
