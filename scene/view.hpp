// SPDX-License-Identifier: Apache-2.0
// What a picture is drawn with besides triangles, textures and draw state; each target has such a view of its
// own. docs/formats.md describes the commands that change it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

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

struct View {
  int width = 640;
  int height = 480;
  double s_min = 1;
  double s_max = 1000;
  double focal = 500;  // F, in pixels
  std::array<std::uint8_t, 3> background{};
  std::optional<Fog> fog{};
  std::optional<Projector> projector{};
  bool operator==(const View&) const = default;
};

// What of a view takes new values; all else stays.
struct ViewChange {
  std::optional<int> width{}, height{};
  std::optional<double> s_min{}, s_max{}, focal{};
  std::optional<std::array<std::uint8_t, 3>> background{};
  std::optional<std::optional<Fog>> fog{};  // the inner one is none for a view without fog
  std::optional<std::optional<Projector>> projector{};
  bool operator==(const ViewChange&) const = default;
};
// Throws InputError, whose text begins with the key, where the new view is not legal.
View changed_view(View view, const ViewChange& change);

}  // namespace bitspan
