// SPDX-License-Identifier: Apache-2.0
// The A-buffer: every surface of each pixel in a list, of which the nearest is seen. Of scenes in
// translucency passes its lists of layers judge the colours, too. [H8]
#include <algorithm>

#include "golden/oracle.hpp"

namespace bitspan {

namespace {

std::vector<Visible> nearest_in_lists(const OracleInput& input) {
  const Scene& scene = input.scene;
  const auto pixels = static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height);
  std::vector<std::vector<Visible>> lists(pixels);
  for (const OracleFace& face : input.faces) {
    golden::for_each_covered(face.shape, input.config.fill_rule, scene.width, scene.height,
                             [&](const golden::Areas& areas, std::int64_t x, std::int64_t y) {
                               lists[static_cast<std::size_t>(y * scene.width + x)].push_back(
                                   {face.index, golden::inverse_distance(face.shape, areas)});
                             });
  }
  std::vector<Visible> out(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    // The first of those that are exactly as far.
    const auto nearest =
        std::ranges::max_element(lists[i], [](const Visible& a, const Visible& b) { return a.q < b.q; });
    if (nearest != lists[i].end()) out[i] = *nearest;
  }
  return out;
}

const RegisterOracle abuffer{
    {.name = "abuffer",
     .meaning = "lists of all surfaces per pixel; judges translucency by passes, too",
     .has_layers = true,
     .visible = nearest_in_lists}};

}  // namespace

}  // namespace bitspan

extern "C" void abuffer_oracle() {}
