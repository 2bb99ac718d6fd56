// SPDX-License-Identifier: Apache-2.0
#include "golden/texture_second.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "config/modes.hpp"
#include "golden/depth.hpp"
#include "golden/sampling.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// The second unit has neither a reserved colour nor a chroma range.
Config without_transparency(Config config) {
  config.transparent.reset();
  return config;
}

template <class Real>
class SecondTexturing : Sampling<Real> {
  using Place = typename Sampling<Real>::Place;
  using Texel = typename Sampling<Real>::Texel;
  using Sampling<Real>::in_border;
  using Sampling<Real>::look_up;
  using Sampling<Real>::q_alpha_;
  using Sampling<Real>::q_lambda_;
  using Sampling<Real>::q_level_;
  using Sampling<Real>::q_mix_;
  using Sampling<Real>::q_uv_;
  using Sampling<Real>::sample;
  using Sampling<Real>::tell;

 public:
  explicit SecondTexturing(const Config& config)
      : Sampling<Real>(without_transparency(config)),
        mip_(config.mip),
        depth_code_(config.depth_code),
        depth_bits_(config.depth_bits),
        q_color_(config.format(FormatId::texture_color)),
        alpha_format_(config.format(FormatId::texture_alpha)) {}

  void operator()(std::span<const FragmentRecord* const> fragments,
                  std::span<const TextureRecord* const> firsts, std::span<const LodRecord* const> lods,
                  std::span<const ProjectRecord> projects, std::span<const Texture> levels,
                  const DrawState& state, std::vector<TextureSecondRecord>& out) const {
    const DrawState plain;  // without a chroma range
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const FragmentRecord& fragment = *fragments[i];
      TextureSecondRecord& record = out.emplace_back();
      record.triangle = fragment.triangle;
      record.x = fragment.x;
      record.y = fragment.y;
      if (is_projected(state)) {
        combine(state, *firsts[i], projected(state, projects[i], levels.front(), record), record);
        continue;
      }
      TexelLookup by = second_lookup(state);
      if (!lods.empty()) {
        const Real lambda = own_lambda(state, *lods[i]);
        choose_level(state, lambda, static_cast<int>(levels.size()), record);
        by = this->lookup_at(q_lambda_.raw(lambda), second_levels(state), by, second_magnified(state));
      }
      const Place place = this->look_up_level(plain, by, levels, record.level, fragment);
      tell(place, record);
      Shades<Real> texel = sample(by.filter, place);
      if (mixes_levels(mip_)) this->mix_levels(plain, by, levels, record.level, record.f, fragment, texel);
      combine(state, *firsts[i], texel, record);
    }
  }

 private:
  // V of a fragment in the projector's texture.
  Shades<Real> projected(const DrawState& state, const ProjectRecord& at, const Texture& texture,
                         TextureSecondRecord& out) const {
    const Texel constant{static_cast<std::uint8_t>(state.texture1_red),
                         static_cast<std::uint8_t>(state.texture1_green),
                         static_cast<std::uint8_t>(state.texture1_blue), 255};
    constexpr Texel white{255, 255, 255, 255};
    const TexelLookup by = second_lookup(state);
    if (at.inside == 0) {
      Place none;
      none.texel[0] = is_lit_outside(state.texture1_outside) ? white : constant;
      return sample(TextureFilter::nearest, none);
    }
    const bool compares = state.texture1_compare && texture.format == TexelFormat::depth;
    const std::int64_t z = biased_code(at.z, state.texture1_bias, depth_bits_);
    const auto texel = [&](std::int64_t i, std::int64_t j) {
      if (!compares || in_border(texture, i, j)) return this->fetch(texture, i, j);
      return passes_depth(depth_code_, state.texture1_func, z, stored_code(texture, i, j)) ? white : constant;
    };
    const Place place = look_up(DrawState{}, by, texture, q_uv_.value(at.s), q_uv_.value(at.t), texel);
    tell(place, out);
    return sample(by.filter, place);
  }
  static bool is_lit_outside(ProjectOutside outside) {
    switch (outside) {
      case ProjectOutside::lit:
        return true;
      case ProjectOutside::dark:
        return false;
    }
    unreachable();
  }
  // The code that the word of a texel stands for.
  std::int64_t stored_code(const Texture& texture, std::int64_t i, std::int64_t j) const {
    const double per_code = std::exp2(32 - depth_bits_);
    return static_cast<std::int64_t>(std::floor(static_cast<double>(depth_word(texture, i, j)) / per_code));
  }

  // lod's with this unit's bias in place of the first one's.
  Real own_lambda(const DrawState& state, const LodRecord& lod) const {
    const int more = state.texture1_lod_bias - state.texture_lod_bias;
    return q_lambda_.sum(q_lambda_.value(lod.lambda), Real(more) * pow2<Real>(-4));
  }
  void choose_level(const DrawState& state, Real lambda, int levels, TextureSecondRecord& out) const {
    const Real held = std::min(within(second_levels(state), lambda), Real(levels - 1));
    if (mixes_levels(mip_)) {
      const Real whole = floor_of(held);
      out.level = to_integer(whole);
      out.f = q_level_.raw(q_level_(held - whole));
    } else {
      out.level = to_integer(floor_of(held + Real(0.5)));
    }
  }

  void combine(const DrawState& state, const TextureRecord& first, const Shades<Real>& texel,
               TextureSecondRecord& out) const {
    const std::array<int, 3> constants{state.texture1_red, state.texture1_green, state.texture1_blue};
    const std::array<std::int64_t, 3> before{first.r, first.g, first.b};
    std::array<std::int64_t, 3> color{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Real share = q_alpha_.quotient(texel[c], Real(255));
      const CombinedColor<Real> sum =
          combined_color<Real>(state.texture1_op, q_color_.value(before[c]), texel[c], share, texel[3],
                               Real(constants[c]), Real(1 << state.texture1_scale));
      color[c] = q_color_.raw(narrowed(sum));
    }
    const Real a = q_alpha_.value(first.a);
    const Real alpha = keeps_first_alpha(state.texture1_op)   ? a
                       : takes_texel_alpha(state.texture1_op) ? texel[3]
                                                              : q_alpha_(a * texel[3]);
    out.texel_r = q_mix_.raw(texel[0]);
    out.texel_g = q_mix_.raw(texel[1]);
    out.texel_b = q_mix_.raw(texel[2]);
    out.texel_a = q_alpha_.raw(texel[3]);
    out.r = color[0];
    out.g = color[1];
    out.b = color[2];
    out.a = q_alpha_.raw(alpha);
    out.killed = (kills_zero(state) && alpha == 0) || !passes_alpha_test(state, alpha_format_, out.a) ? 1 : 0;
  }
  Real narrowed(const CombinedColor<Real>& sum) const {
    if (!sum.saturates) return q_color_.sum(sum.a * sum.by_a, sum.b * sum.by_b);
    return q_color_(std::min(sum.a * sum.by_a + sum.b * sum.by_b, Real(255)));
  }

  MipMode mip_;
  DepthCode depth_code_;
  int depth_bits_;
  Quantizer<Real> q_color_;
  Format alpha_format_;
};

}  // namespace

TextureSecondStage make_texture_second(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> TextureSecondStage { return SecondTexturing<Real>(config); });
}

}  // namespace bitspan::golden
