// SPDX-License-Identifier: Apache-2.0
// A scene as every engine gets it: screen-space triangles in the order of drawing, and their textures.
// Readers (.tri streams, meshes, the embedded demo) make it; docs/formats.md describes the stream.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/attributes.hpp"
#include "scene/draw_state.hpp"
#include "scene/quadric.hpp"
#include "scene/texel_format.hpp"
#include "scene/view.hpp"

namespace bitspan {

// Rows from the top; alpha is the L-buffer of T5 (0 clear, 255 opaque). A texture of the format rgba8888 has
// 4 bytes per texel in `rgba`, and the last two empty. One of another format has `rgba` empty.
struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
  TexelFormat format = TexelFormat::rgba8888;
  std::vector<std::uint8_t> raw{};  // as in the memory of the hardware; scene/texel_format.hpp has the layout
  std::vector<std::int16_t> table{};  // the palette, or what YIQ codes stand for; empty for the others
};

// x, y in pixels (origin top left, pixel centres at .5); s distance along the view axis.
struct ScreenPoint {
  double x = 0, y = 0, s = 1;
};
struct Vertex : ScreenPoint, Attributes {};

// A line [B1] stands among the triangles: from v[0] to v[1], which v[2] repeats.
struct Triangle {
  std::array<Vertex, 3> v;
  int texture = -1;  // index into Scene::textures, -1 for none
  bool is_line = false;
};

// The view is that of its first triangles, and of target 0, until a command changes it.
struct Scene : View {
  std::string name;
  std::vector<Texture> textures;
  std::vector<Triangle> triangles;
  std::vector<DrawCommand> commands;  // by `before`; none: every triangle is drawn with the first state
  std::vector<Quadric> quadrics{};  // that ranges of the triangles stand for, in the space of the first view
};

// Nothing but a view.
inline Scene with_view(const View& view) { return {view, {}, {}, {}, {}, {}}; }
// The view that triangle `index` is drawn with; that of the number of triangles is the last one.
View view_at(const Scene& scene, std::size_t index);
// Throws InputError where there is no such texture, the target has not been drawn on, or their sizes differ.
void check_copy(const Scene& scene, const Views& views, const Copy& copy);
// Throws InputError where a change of state or view, or a copy, would not be legal.
void check_commands(const Config& config, const Scene& scene);
// Takes triangles out; commands that stood in front of them stand in front of the next one. A quadric stays
// while one of its triangles does.
void erase_triangles(Scene& scene, std::size_t first, std::size_t count);

}  // namespace bitspan
