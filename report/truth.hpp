// SPDX-License-Identifier: Apache-2.0
// `ideal` of some triangles, computed once: what every engine and every width is measured against.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "config/config.hpp"
#include "golden/ideal.hpp"
#include "golden/mip_chain.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Returns a default Config with all that `ideal` reads of this one. Configurations with the same result have
// the same truth.
Config truth_config(const Config& config);

class Truth {
 public:
  // The scene must outlive it; triangles: of the scene. levels: of the scene, from golden::scene_levels, as
  // shared by several truths; null: its own.
  Truth(const Config& config, const Scene& scene, std::span<const Triangle> triangles,
        std::shared_ptr<const golden::SceneLevels> levels = nullptr);

  std::size_t size() const { return triangles_.size(); }
  // Returns triangle i of the span given; none where it has no area. The functions below need one with an
  // area.
  const std::optional<IdealTriangle>& triangle(std::size_t i) const { return triangles_[i].shape; }
  const IdealPoint& vertex(std::size_t i, int k) const {
    return triangles_[i].vertex[static_cast<std::size_t>(k)];
  }
  IdealPoint on_edge(std::size_t i, int edge, std::int64_t y) const;
  // Pixels first <= x < end of row y are covered; none where first >= end.
  struct Pixels {
    std::int64_t first = 0, end = 0;
  };
  Pixels covered(std::size_t i, std::int64_t y) const;
  // Rows that may have covered pixels.
  struct Rows {
    std::int64_t first = 0, end = 0;
  };
  Rows rows(std::size_t i) const { return {triangles_[i].y, triangles_[i].y + triangles_[i].count}; }
  // Covered or not.
  IdealFragment at(std::size_t i, std::int64_t x, std::int64_t y) const;

  std::size_t bytes() const;

 private:
  struct Row {
    std::int64_t first = 0, end = 0;
    std::size_t at = 0;  // of fragments_
  };
  struct Entry {
    std::optional<IdealTriangle> shape;
    std::array<IdealPoint, 3> vertex{};
    std::int64_t y = 0, count = 0;  // rows
    std::size_t row = 0;            // of rows_
    std::size_t edge = 0;           // of edges_: three points per row, edge 0, 1, 2
  };

  Config config_;
  const Scene* scene_;
  std::shared_ptr<const golden::SceneLevels> levels_;
  std::vector<Entry> triangles_;
  std::vector<Row> rows_;
  std::vector<IdealPoint> edges_;
  std::vector<IdealFragment> fragments_;  // of the covered pixels
};

}  // namespace bitspan
