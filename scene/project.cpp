// SPDX-License-Identifier: Apache-2.0
#include "scene/project.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "scene/clip.hpp"
#include "scene/exact.hpp"

namespace bitspan {
namespace {

constexpr double guard_band_pixels = 16384;

// Seen from outside, the corners run counter-clockwise: the volume spanned with the viewer is positive.
bool faces_viewer(const Face& face, const Viewpoint& view) {
  const Vec3 a = face.corner[0].position - view.position;
  const Vec3 b = face.corner[1].position - view.position;
  const Vec3 c = face.corner[2].position - view.position;
  return dot(view.parallel ? line_of_sight({}, view) : a, cross(b - a, c - a)) < 0;
}

// In a parallel projection all vertices have one distance, so that the pipeline divides by nothing that
// changes, and their depths are a line of their own.
Vertex to_screen(const ClipVertex& p, const Viewpoint& view, const ClipVolume& volume) {
  const double w = bound(p, volume);
  Vertex out{{view.width / 2.0 * (1 + p.x / w), view.height / 2.0 * (1 + p.y / w),
              std::clamp(w, view.s_min, view.s_max)},
             clamped(p)};
  if (view.parallel) out.z = std::clamp((p.s - view.s_min) / (view.s_max - view.s_min), 0.0, 1.0);
  return out;
}

void project_one_by_one(std::span<const Face> faces, const Viewpoint& view, const ProjectOptions& options,
                        std::vector<Triangle>& triangles, ProjectReport& report) {
  ClipVolume volume{1, 1, view.s_min, view.s_max};
  if (view.parallel) volume.across = view.parallel->distance;
  if (!options.clip_sides) {
    volume.limit_x = std::max(1.0, 2 * guard_band_pixels / view.width);
    volume.limit_y = std::max(1.0, 2 * guard_band_pixels / view.height);
  }
  std::vector<ClipVertex> polygon;
  std::vector<Vertex> screen;
  for (const Face& face : faces) {
    ++report.faces;
    if (face.two_sided) ++report.two_sided;
    if (options.cull && !face.two_sided && !faces_viewer(face, view)) {
      ++report.culled;
      continue;
    }
    polygon.clear();
    unsigned any = 0;
    unsigned all = 63;
    for (const Corner& corner : face.corner) {
      polygon.push_back(to_normalised(corner, view));
      const unsigned code = outcode(polygon.back(), volume);
      any |= code;
      all &= code;
    }
    if (all != 0) {
      ++report.outside;
      continue;
    }
    if (any != 0) {
      clip_polygon(polygon, volume, static_cast<std::uint8_t>(any));
      if (polygon.size() < 3) {
        ++report.outside;
        continue;
      }
      ++report.clipped;
    }
    screen.clear();
    for (const ClipVertex& p : polygon) screen.push_back(to_screen(p, view, volume));
    const std::uint64_t before = report.triangles;
    for (std::size_t i = 2; i < screen.size(); ++i) {
      const Triangle triangle{{screen[0], screen[i - 1], screen[i]}, face.texture};
      if (orientation(triangle) == 0) {
        ++report.dropped;
        continue;
      }
      triangles.push_back(triangle);
      ++report.triangles;
    }
    if (report.triangles > before) ++report.drawn;
  }
}

}  // namespace

ProjectReport& ProjectReport::operator+=(const ProjectReport& more) {
  faces += more.faces;
  culled += more.culled;
  outside += more.outside;
  clipped += more.clipped;
  dropped += more.dropped;
  two_sided += more.two_sided;
  drawn += more.drawn;
  triangles += more.triangles;
  return *this;
}

void project(std::span<const Face> faces, const Viewpoint& view, const ProjectOptions& options,
             std::vector<Triangle>& triangles, ProjectReport& report) {
  constexpr std::size_t chunk_faces = 8192;
  if (faces.size() <= chunk_faces) {
    project_one_by_one(faces, view, options, triangles, report);
    return;
  }
  struct Chunk {
    std::vector<Triangle> triangles;
    ProjectReport report;
  };
  // As many at a time as threads, so that what is copied is still in the caches.
  std::vector<Chunk> chunks(static_cast<std::size_t>(tbb::info::default_concurrency()));
  while (!faces.empty()) {
    const std::size_t n = std::min(chunks.size(), (faces.size() + chunk_faces - 1) / chunk_faces);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      const auto rest = faces.subspan(i * chunk_faces);
      chunks[i].triangles.clear();
      chunks[i].report = {};
      project_one_by_one(rest.first(std::min(chunk_faces, rest.size())), view, options, chunks[i].triangles,
                         chunks[i].report);
    });
    for (const Chunk& chunk : std::span(chunks).first(n)) {
      triangles.insert(triangles.end(), chunk.triangles.begin(), chunk.triangles.end());
      report += chunk.report;
    }
    faces = faces.subspan(std::min(faces.size(), n * chunk_faces));
  }
}

Vec3 position_of(const Vertex& v, const View& view) {
  const double per_pixel = v.s / view.focal;
  return {(v.x - view.width / 2.0) * per_pixel, (v.y - view.height / 2.0) * per_pixel, v.s};
}

std::vector<Face> faces_of(const Scene& scene) {
  std::vector<Face> faces;
  faces.reserve(scene.triangles.size());
  for (const Triangle& triangle : scene.triangles) {
    Face& face = faces.emplace_back();
    face.texture = triangle.texture;
    face.two_sided = true;
    for (std::size_t i = 0; i < 3; ++i) {
      static_cast<Attributes&>(face.corner[i]) = triangle.v[i];
      face.corner[i].z = Attributes{}.z;  // a depth of one view is none of another
      face.corner[i].position = position_of(triangle.v[i], scene);
    }
  }
  return faces;
}

}  // namespace bitspan
