#include "golden/merge.hpp"

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
        q_(config.format(FormatId::merge_color)) {}

  MergeRecord operator()(const FogRecord& fog, const TextureRecord& texture, const DepthRecord& depth,
                         const std::array<std::uint8_t, 3>& stored) const {
    const Real alpha = q_alpha_.value(texture.a);
    const auto blend = [&](std::int64_t raw, std::uint8_t code) {
      const Real source = q_in_.value(raw);
      if (alpha >= 1) return q_.raw(q_(source));
      const Real below = Real(code);
      return q_.raw(q_.sum(below, (source - below) * alpha));
    };
    MergeRecord out;
    out.triangle = fog.triangle;
    out.x = fog.x;
    out.y = fog.y;
    out.z = depth.z;
    out.r = blend(fog.r, stored[0]);
    out.g = blend(fog.g, stored[1]);
    out.b = blend(fog.b, stored[2]);
    return out;
  }

 private:
  Quantizer<Real> q_in_, q_alpha_, q_;
};

}  // namespace

MergeStage make_merge(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> MergeStage { return Merging<Real>(config); });
}

}  // namespace bitspan::golden
