// SPDX-License-Identifier: Apache-2.0
#include "report/edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "golden/edge_rays.hpp"

namespace bitspan {
namespace {

using golden::EyePoint;

constexpr double beside_a_crossing = 1e-6;  // of an edge

EyePoint point_at(const SeenEdge& edge, double share) {
  return edge.end[0] + (edge.end[1] - edge.end[0]) * share;
}

bool is_visible(const SeenEdge& edge, double share) {
  return std::ranges::any_of(edge.visible,
                             [&](const auto& part) { return part[0] <= share && share <= part[1]; });
}

// Strictly between the ends. The golden ratio spreads them evenly, and not at the same places of each edge.
std::vector<double> shares_of(const SeenEdge& edge, std::size_t number, int samples) {
  std::vector<double> out;
  for (int i = 0; i < samples; ++i) {
    const double turns = std::numbers::phi * (static_cast<double>(number) * samples + i + 0.5);
    out.push_back((i + turns - std::floor(turns)) / samples);
  }
  for (const auto& part : edge.visible) {
    for (const double end : part) {
      if (end <= 0 || end >= 1) continue;
      for (const double share : {end - beside_a_crossing, end + beside_a_crossing}) out.push_back(share);
    }
  }
  std::erase_if(out, [](double share) { return share <= 0 || share >= 1; });
  return out;
}

std::string edge_name(const SeenEdge& edge) {
  std::string out = edge.on.size() == 1 ? "edge of triangle" : "edge of triangles";
  for (std::size_t i = 0; i < std::min<std::size_t>(edge.on.size(), 4); ++i) {
    out += fmt::format("{}{}", i == 0 ? " " : ", ", edge.on[i]);
  }
  return out + (edge.on.size() > 4 ? " and others" : "");
}

PixelFinding judge(const Oracle& oracle, const View& view, const golden::EdgeRays& rays, const SeenEdge& edge,
                   double share) {
  const EyePoint point = point_at(edge, share);
  const golden::Sight sight = rays.at(point, edge.on);
  if (sight == golden::Sight::near) return {PixelVerdict::tie, "near a crossing"};
  const bool is_seen = is_visible(edge, share);
  if (is_seen == (sight == golden::Sight::seen)) return {PixelVerdict::equal};
  const golden::SeenPlace at = golden::seen_place(point, view);
  return {PixelVerdict::unexplained,
          fmt::format("place ({:.6f}, {:.6f}), {:.9f} of an {}: {} has it {}, and a ray finds it {}", at.x,
                      at.y, share, edge_name(edge), oracle.name, is_seen ? "visible" : "hidden",
                      is_seen ? "hidden" : "visible")};
}

// Pixels are less grave than ties, and these than what is unexplained.
void raise(PixelVerdict& of_pixel, PixelVerdict found) {
  const auto gravity = [](PixelVerdict v) {
    return v == PixelVerdict::unexplained ? 3 : v == PixelVerdict::tie ? 2 : v == PixelVerdict::equal ? 1 : 0;
  };
  if (gravity(found) > gravity(of_pixel)) of_pixel = found;
}

}  // namespace

SeenEdges seen_edges(const Oracle& oracle, const Config& config, const Scene& scene) {
  SeenEdges out;
  const std::vector<bool> vanishes = vanishing_triangles(config, scene, scene.triangles);
  for (std::size_t i = 0; i < vanishes.size(); ++i) {
    if (!vanishes[i]) out.triangles.push_back(static_cast<std::int32_t>(i));
  }
  out.edges = oracle.edges(scene, out.triangles, &out.counts);
  const auto visible = std::ranges::count_if(out.edges, [](const SeenEdge& e) { return !e.visible.empty(); });
  out.counts.push_back({"visible, at least in part", static_cast<double>(visible)});
  return out;
}

VisibilityReport edge_report(const Oracle& oracle, const Scene& scene, const SeenEdges& seen, int samples) {
  VisibilityReport out = report_on(oracle, scene.width, scene.height, "rays");
  out.is_of_engine = false;
  out.unit = "points of edges";
  out.ties_as = "near a crossing";
  out.counts = seen.counts;
  const auto width = static_cast<std::size_t>(scene.width);
  std::vector<PixelVerdict> pixels(width * static_cast<std::size_t>(scene.height), PixelVerdict::background);
  const golden::EdgeRays rays(scene, seen.triangles);
  for (std::size_t e = 0; e < seen.edges.size(); ++e) {
    const SeenEdge& edge = seen.edges[e];
    for (const double share : shares_of(edge, e, samples)) {
      PixelFinding found = judge(oracle, scene, rays, edge, share);
      const auto [x, y] = golden::seen_place(point_at(edge, share), scene);
      if (x >= 0 && x < scene.width && y >= 0 && y < scene.height) {
        raise(pixels[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)], found.verdict);
      }
      out.add(std::move(found));
    }
  }
  out.pixels = std::move(pixels);
  return out;
}

std::vector<EdgeAt> edges_at(const Oracle& oracle, const Scene& scene, const SeenEdges& seen, std::int64_t x,
                             std::int64_t y) {
  const golden::EdgeRays rays(scene, seen.triangles);
  const long double left = (static_cast<long double>(x) - scene.width / 2.0L) / scene.focal;
  const long double top = (static_cast<long double>(y) - scene.height / 2.0L) / scene.focal;
  const long double pixel = 1 / static_cast<long double>(scene.focal);
  std::vector<EdgeAt> out;
  for (const SeenEdge& edge : seen.edges) {
    golden::SharePart part;
    const auto keep = [&](auto value) { return part.keep_positive(value(edge.end[0]), value(edge.end[1])); };
    const bool passes = keep([&](const EyePoint& p) { return p.x - left * p.z; }) &&
                        keep([&](const EyePoint& p) { return (left + pixel) * p.z - p.x; }) &&
                        keep([&](const EyePoint& p) { return p.y - top * p.z; }) &&
                        keep([&](const EyePoint& p) { return (top + pixel) * p.z - p.y; });
    if (!passes) continue;
    const auto middle = static_cast<double>((part.low + part.high) / 2);
    out.push_back({&edge, is_visible(edge, middle), judge(oracle, scene, rays, edge, middle)});
  }
  return out;
}

std::string edge_text(const EdgeAt& at) {
  return fmt::format("{}, {}", edge_name(*at.edge), at.is_visible ? "visible" : "hidden");
}

std::vector<std::uint8_t> edge_picture(const View& view, std::span<const SeenEdge> edges) {
  const auto width = static_cast<std::size_t>(view.width);
  std::vector<double> light(width * static_cast<std::size_t>(view.height));
  const auto add = [&](std::int64_t x, std::int64_t y, double amount) {
    if (x < 0 || x >= view.width || y < 0 || y >= view.height) return;
    double& here = light[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
    here = std::max(here, amount);
  };
  for (const SeenEdge& edge : edges) {
    for (const auto& part : edge.visible) {
      golden::SeenPlace a = golden::seen_place(point_at(edge, part[0]), view);
      golden::SeenPlace b = golden::seen_place(point_at(edge, part[1]), view);
      // One pixel wide: of the pixels beside it in each column, or row, each has a share.
      const bool is_steep = std::abs(b.y - a.y) > std::abs(b.x - a.x);
      if (is_steep) {
        std::swap(a.x, a.y);
        std::swap(b.x, b.y);
      }
      if (a.x > b.x) std::swap(a, b);
      const int columns = is_steep ? view.height : view.width;
      const double slope = b.x > a.x ? (b.y - a.y) / (b.x - a.x) : 0;
      const auto first = static_cast<std::int64_t>(std::floor(std::max(a.x, 0.0)));
      const auto last = static_cast<std::int64_t>(std::floor(std::min(b.x, columns - 1.0)));
      for (std::int64_t x = first; x <= last; ++x) {
        const double at = std::clamp(static_cast<double>(x) + 0.5, a.x, b.x);
        const double centre = a.y + (at - a.x) * slope - 0.5;
        if (!(std::abs(centre) < 1e9)) continue;
        const auto y = static_cast<std::int64_t>(std::floor(centre));
        const double below = centre - std::floor(centre);
        for (const auto& [row, amount] : {std::pair(y, 1 - below), std::pair(y + 1, below)}) {
          if (is_steep) {
            add(row, x, amount);
          } else {
            add(x, row, amount);
          }
        }
      }
    }
  }
  std::vector<std::uint8_t> out;
  out.reserve(4 * light.size());
  for (const double amount : light) {
    const auto code = static_cast<std::uint8_t>(std::lround(255 * std::min(amount, 1.0)));
    out.insert(out.end(), {code, code, code, 255});
  }
  return out;
}

}  // namespace bitspan
