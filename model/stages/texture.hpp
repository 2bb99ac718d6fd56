// texture: the texel or four of them, the reserved colour, and the product with the fragment's colour.
// docs/numeric-spec.md, "texture" (T3, T4, T5).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "config/config.hpp"
#include "config/records.hpp"
#include "model/numeric/quantize.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct TextureStage {
  TextureFilter filter = TextureFilter::nearest;
  TextureWrap wrap = TextureWrap::cyclic;
  std::optional<std::array<std::uint8_t, 3>> transparent;
  bool narrow = false;  // every intermediate fits int64
  Register uv, shade;   // formats of the fragment
  Register frac, mix, color, alpha;
};
TextureStage prepare_texture(const Config& config);

// A fragment that passed the depth test; texture null for none. True where it lives (not out.killed).
template <class Watch = NoObserve>
bool texture(const TextureStage& stage, const Texture* image, const FragmentRecord& fragment,
             TextureRecord& out, Watch watch = {});

}  // namespace bitspan::model
