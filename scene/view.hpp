// SPDX-License-Identifier: Apache-2.0
// What a picture is drawn with besides triangles, textures and draw state; each target has such a view of its
// own. docs/formats.md describes the commands that change it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace bitspan {

struct Fog {
  std::array<std::uint8_t, 3> color{};
  double distance = 1;  // DT, in the unit of s
  bool operator==(const Fog&) const = default;
};

// What a texture is projected from [T14], or a shadow is cast from [SH2]: the range of its depth codes.
struct Projector {
  double s_min = 1;
  double s_max = 1000;
  bool operator==(const Projector&) const = default;
};

// What shines on a scene, in the viewer's space: x to the right, y downward, z along the view axis.
struct Light {
  bool is_point = false;                  // stands at `place`; else far away in that direction
  std::array<double, 3> place{0, 0, -1};  // in the unit of s
  double ambient = 0.2;                   // share of what reaches every surface, 0 to 1
  double specular = 0;                    // share of the highlight; the rest of 1 goes by the cosine [L1]
  int exponent = 32;                      // of the highlight [L2]
  // k of the lunar law: what scatters is divided by 1 + k times the viewer's cosine [L3].
  double lunar = 0;
  // Where brightness falls with the distance d: all but the ambient share is divided by (d / reach)^a +
  // offset [B9]. 0: it does not fall. In the unit of s.
  double reach = 0;
  double offset = 0;
  bool operator==(const Light&) const = default;
};
inline constexpr int light_exponent_limit = 200;
inline constexpr double light_lunar_limit = 16, light_offset_limit = 64;
inline constexpr int reach_octaves = 16;  // the reach is s_max 2^-16 to s_max 2^16

struct View {
  int width = 640;
  int height = 480;
  double s_min = 1;
  double s_max = 1000;
  double focal = 500;  // F, in pixels
  std::array<std::uint8_t, 3> background{};
  std::optional<Fog> fog{};
  std::optional<Projector> projector{};
  std::optional<Light> light{};
  bool operator==(const View&) const = default;
};

// What of a view takes new values; all else stays.
struct ViewChange {
  std::optional<int> width{}, height{};
  std::optional<double> s_min{}, s_max{}, focal{};
  std::optional<std::array<std::uint8_t, 3>> background{};
  std::optional<std::optional<Fog>> fog{};  // the inner one is none for a view without fog
  std::optional<std::optional<Projector>> projector{};
  std::optional<std::optional<Light>> light{};
  bool operator==(const ViewChange&) const = default;
};
// What is wrong with a light, behind its name: ".ambient: is not legal; expected ..."; empty where it is
// legal. s_max: of its view, or 0 where the view is not known yet.
std::string light_fault(const Light& light, double s_max = 0);
// Throws InputError, whose text begins with the key, where the new view is not legal.
View changed_view(View view, const ViewChange& change);

}  // namespace bitspan
