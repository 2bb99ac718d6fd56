// SPDX-License-Identifier: Apache-2.0
#include "golden/oracle.hpp"

#include <algorithm>
#include <stdexcept>

namespace bitspan {

namespace {

std::vector<Oracle>& known_oracles() {
  static std::vector<Oracle> list;  // filled before main()
  return list;
}

}  // namespace

RegisterOracle::RegisterOracle(const Oracle& oracle) {
  auto& list = known_oracles();
  const auto at = std::ranges::lower_bound(list, oracle.name, {}, &Oracle::name);
  if (at != list.end() && at->name == oracle.name) {
    throw std::logic_error("two oracles are named '" + std::string(oracle.name) + "'");
  }
  list.insert(at, oracle);
}

std::span<const Oracle> oracles() { return known_oracles(); }

const Oracle* find_oracle(std::string_view name) {
  const auto at = std::ranges::find(known_oracles(), name, &Oracle::name);
  return at == known_oracles().end() ? nullptr : &*at;
}

std::string oracle_names(std::string_view between, bool with_lines) {
  std::string out;
  for (const Oracle& oracle : known_oracles()) {
    if (oracle.draws_lines && !with_lines) continue;
    out.append(out.empty() ? "" : between).append(oracle.name);
  }
  return out;
}

std::vector<const Oracle*> parse_oracles(const std::string& list) {
  std::vector<const Oracle*> out;
  if (list == "all") {
    for (const Oracle& oracle : known_oracles()) {
      if (!oracle.draws_lines) out.push_back(&oracle);
    }
    return out;
  }
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    const std::string name = list.substr(from, comma - from);
    const Oracle* const at = find_oracle(name);
    if (at == nullptr) {
      throw InputError("--oracles: '" + name + "' is no oracle; legal: all, " + oracle_names(", "));
    }
    if (at->draws_lines) {
      throw InputError("--oracles: '" + name + "' draws lines, and judges no picture; legal: all, " +
                       oracle_names(", ") + "; render --engine oracle:" + name + " shows it");
    }
    if (std::ranges::find(out, at) != out.end()) {
      throw InputError("--oracles: '" + name + "' is named twice");
    }
    out.push_back(at);
    from = comma + 1;
  }
  return out;
}

std::vector<OracleFace> golden::faces_of_scene(const Config& config, const Scene& scene) {
  std::vector<OracleFace> out;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (const auto shape = ideal_triangle(config, scene.triangles[i])) {
      out.push_back({static_cast<std::int32_t>(i), *shape});
    }
  }
  return out;
}

std::vector<Visible> golden::nearest_faces(const OracleInput& input, const CoverageTest& covers) {
  const Scene& scene = input.scene;
  const auto width = static_cast<std::size_t>(scene.width);
  std::vector<Visible> out(width * static_cast<std::size_t>(scene.height));
  for (const OracleFace& face : input.faces) {
    const PixelBox box = pixel_box(face.shape, scene.width, scene.height);
    for (std::int64_t y = box.y_first; y <= box.y_last; ++y) {
      for (std::int64_t x = box.x_first; x <= box.x_last; ++x) {
        const Point centre = centre_of(face.shape, x, y);
        if (!covers(face.shape, centre)) continue;
        Visible& seen = out[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
        const InverseDistance q = inverse_distance(face.shape, areas_at(face.shape, centre));
        if (seen.triangle < 0 || q > seen.q) seen = {face.index, q};
      }
    }
  }
  return out;
}

}  // namespace bitspan
