// SPDX-License-Identifier: Apache-2.0
// The painter's algorithm by the middle of z: all triangles from far to near by the mean distance of their
// vertices, each over what is there. It is wrong where that mean does not say which one is in front, and so
// it is no oracle of the truth: its wrong pixels are counted. [H3]
#include <algorithm>

#include "golden/oracle.hpp"

namespace bitspan {

namespace {

std::vector<Visible> paint_by_middle(const OracleInput& input) {
  const auto three_middles = [](const OracleFace* face) {
    return face->shape.v[0].s + face->shape.v[1].s + face->shape.v[2].s;
  };
  std::vector<const OracleFace*> far_to_near;
  for (const OracleFace& face : input.faces) far_to_near.push_back(&face);
  std::ranges::stable_sort(far_to_near, std::ranges::greater{}, three_middles);
  const Scene& scene = input.scene;
  std::vector<Visible> out(static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height));
  for (const OracleFace* face : far_to_near) {
    golden::for_each_covered(face->shape, input.config.fill_rule, scene.width, scene.height,
                             [&](const golden::Areas& areas, std::int64_t x, std::int64_t y) {
                               out[static_cast<std::size_t>(y * scene.width + x)] = {
                                   face->index, golden::inverse_distance(face->shape, areas)};
                             });
  }
  return out;
}

const RegisterOracle painter_mid_z{
    {.name = "painter_mid_z",
     .meaning = "painter's algorithm by the middle of z; counts its wrong pixels",
     .is_truth = false,
     .visible = paint_by_middle}};

}  // namespace

}  // namespace bitspan

extern "C" void painter_mid_z_oracle() {}
