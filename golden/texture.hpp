// Stage `texture`: a fragment's texel, its colour and alpha. [T3, T4, T5]
#pragma once

#include <functional>

#include "config/records.hpp"
#include "golden/arithmetic.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// (fragment, its texture or null)
using TextureStage = std::function<TextureRecord(const FragmentRecord&, const Texture*)>;
TextureStage make_texture(Arithmetic arithmetic, const Config& config);

}  // namespace bitspan::golden
