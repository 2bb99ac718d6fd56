#include "golden/texture.hpp"

#include <algorithm>
#include <array>

#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

using Texel = std::array<std::uint8_t, channels>;

template <class Real>
class Texturing {
 public:
  explicit Texturing(const Config& config)
      : bilinear_(config.filter == TextureFilter::bilinear),
        wrap_(config.wrap),
        transparent_(config.transparent),
        q_uv_(config.format(FormatId::span_uv)),
        q_shade_(config.format(FormatId::span_shade)),
        q_frac_(config.format(FormatId::texture_frac)),
        q_mix_(config.format(FormatId::texture_mix)),
        q_color_(config.format(FormatId::texture_color)),
        q_alpha_(config.format(FormatId::texture_alpha)) {
    for (std::size_t code = 0; code < alpha_.size(); ++code) {
      alpha_[code] = q_alpha_.quotient(Real(static_cast<int>(code)), Real(255));
    }
    no_texture_ = {q_mix_(Real(255)), q_mix_(Real(255)), q_mix_(Real(255)), q_alpha_(Real(1))};
  }

  TextureRecord operator()(const FragmentRecord& fragment, const Texture* texture) const {
    TextureRecord out;
    out.triangle = fragment.triangle;
    out.x = fragment.x;
    out.y = fragment.y;
    Shades<Real> texel = no_texture_;
    bool killed = false;
    if (texture != nullptr) {
      texel = sample(*texture, q_uv_.value(fragment.u), q_uv_.value(fragment.v), out, killed);
    }
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
    return out;
  }

 private:
  std::int64_t wrapped(std::int64_t i, std::int64_t size) const {
    if (wrap_ == TextureWrap::clamp) return std::clamp<std::int64_t>(i, 0, size - 1);
    const std::int64_t rest = i % size;
    return rest < 0 ? rest + size : rest;
  }
  Texel fetch(const Texture& texture, std::int64_t i, std::int64_t j) const {
    const std::int64_t at = wrapped(j, texture.height) * texture.width + wrapped(i, texture.width);
    Texel out;
    std::copy_n(texture.rgba.begin() + channels * at, channels, out.begin());
    return out;
  }
  bool reserved(const Texel& texel) const {
    return transparent_ && std::equal(transparent_->begin(), transparent_->end(), texel.begin());
  }

  Shades<Real> sample(const Texture& texture, Real u, Real v, TextureRecord& out, bool& killed) const {
    const std::int64_t nearest_i = to_integer(floor_of(u));
    const std::int64_t nearest_j = to_integer(floor_of(v));
    const Texel nearest = fetch(texture, nearest_i, nearest_j);
    killed = reserved(nearest);
    if (!bilinear_) {
      out.i = wrapped(nearest_i, texture.width);
      out.j = wrapped(nearest_j, texture.height);
      return {q_mix_(Real(nearest[0])), q_mix_(Real(nearest[1])), q_mix_(Real(nearest[2])),
              alpha_[nearest[3]]};
    }
    const Real left = floor_of(u - Real(0.5));
    const Real top = floor_of(v - Real(0.5));
    const Real ex = q_frac_(u - Real(0.5) - left);
    const Real ey = q_frac_(v - Real(0.5) - top);
    const std::int64_t i = to_integer(left);
    const std::int64_t j = to_integer(top);
    out.i = wrapped(i, texture.width);
    out.j = wrapped(j, texture.height);
    out.ex = q_frac_.raw(ex);
    out.ey = q_frac_.raw(ey);
    const auto texel = [&](std::int64_t column, std::int64_t row) {
      const Texel own = fetch(texture, column, row);
      return reserved(own) ? nearest : own;
    };
    const Texel v1 = texel(i, j);
    const Texel v2 = texel(i, j + 1);
    const Texel v3 = texel(i + 1, j + 1);
    const Texel v4 = texel(i + 1, j);
    const auto mix = [](const Quantizer<Real>& q, Real from, Real to, Real share) {
      return q.sum(from * (1 - share), to * share);
    };
    Shades<Real> mixed;
    for (std::size_t c = 0; c < channels; ++c) {
      const bool is_alpha = c == channels - 1;
      const Quantizer<Real>& q = is_alpha ? q_alpha_ : q_mix_;
      const auto value = [&](const Texel& t) { return is_alpha ? alpha_[t[c]] : Real(t[c]); };
      const Real v5 = mix(q, value(v1), value(v4), ex);
      const Real v6 = mix(q, value(v2), value(v3), ex);
      mixed[c] = mix(q, v5, v6, ey);
    }
    return mixed;
  }

  bool bilinear_;
  TextureWrap wrap_;
  std::optional<std::array<std::uint8_t, 3>> transparent_;
  Quantizer<Real> q_uv_, q_shade_, q_frac_, q_mix_, q_color_, q_alpha_;
  std::array<Real, 256> alpha_{};
  Shades<Real> no_texture_;
};

}  // namespace

TextureStage make_texture(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> TextureStage { return Texturing<Real>(config); });
}

}  // namespace bitspan::golden
