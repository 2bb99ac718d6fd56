// SPDX-License-Identifier: Apache-2.0
// An oracle of edges over a scene: what rays to points of the edges say of it, and its picture.
// docs/verify.md, "Edges".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "golden/oracle.hpp"
#include "report/visibility.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// What an oracle sees of the edges of a scene.
struct SeenEdges {
  std::vector<std::int32_t> triangles;  // by input index: those whose fragments cannot be killed
  std::vector<SeenEdge> edges;          // between them
  std::vector<OracleCount> counts;      // of the oracle's own, and of how many edges a part is visible
};
SeenEdges seen_edges(const Oracle& oracle, const Config& config, const Scene& scene);

// Points per edge, spread along it; two more lie beside each end of a visible part.
inline constexpr int edge_samples = 16;

// Compares what an oracle sees with rays to points of the edges. A point is equal, unexplained, or a tie,
// which is one near a crossing. pixels: the gravest verdict in each pixel.
VisibilityReport edge_report(const Oracle& oracle, const Scene& scene, const SeenEdges& seen,
                             int samples = edge_samples);

// An edge that the eye sees pass through a pixel.
struct EdgeAt {
  const SeenEdge* edge = nullptr;
  bool is_visible = false;  // in the middle of its way through the pixel
  PixelFinding found;
};
std::vector<EdgeAt> edges_at(const Oracle& oracle, const Scene& scene, const SeenEdges& seen, std::int64_t x,
                             std::int64_t y);
// "edge of triangles 3 and 5, visible".
std::string edge_text(const EdgeAt& at);

// The visible parts as white lines on black, in RGBA.
std::vector<std::uint8_t> edge_picture(const View& view, std::span<const SeenEdge> edges);

}  // namespace bitspan
