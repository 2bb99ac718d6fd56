// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/simplify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "config/config.hpp"
#include "scene/mesh.hpp"

namespace bitspan {
namespace {

// The least cosine between a face's normals before and after a collapse.
constexpr double least_cosine = 0.2;

// The sum of (n . V + d)^2 over planes, as V' A V + 2 B . V + C.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0;

  void add_plane(const Vec3& n, double d) {
    xx += n.x * n.x;
    xy += n.x * n.y;
    xz += n.x * n.z;
    yy += n.y * n.y;
    yz += n.y * n.z;
    zz += n.z * n.z;
    b = b + n * d;
    c += d * d;
  }
  double at(const Vec3& v) const {
    const Vec3 av{xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                  xz * v.x + yz * v.y + zz * v.z};
    return std::max(0.0, dot(v, av) + 2 * dot(b, v) + c);
  }
  // -inv(A) B; nothing where A is close to singular.
  std::optional<Vec3> optimum() const {
    const Vec3 r0{xx, xy, xz}, r1{xy, yy, yz}, r2{xz, yz, zz};
    const Vec3 c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
    const double determinant = dot(r0, c0), size = (xx + yy + zz) / 3;
    if (!(determinant > 1e-6 * size * size * size)) return std::nullopt;
    const Vec3 sum = c0 * b.x + c1 * b.y + c2 * b.z;
    return sum * (-1 / determinant);
  }
};

Quadric operator+(const Quadric& p, const Quadric& q) {
  return {p.xx + q.xx, p.xy + q.xy, p.xz + q.xz, p.yy + q.yy, p.yz + q.yz, p.zz + q.zz, p.b + q.b, p.c + q.c};
}

Vec3 area_normal(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }

class Simplifier {
 public:
  explicit Simplifier(IndexedMesh mesh) {
    out_.face_count = mesh.faces.size();
    out_.has_vertex.assign(mesh.vertices.size(), true);
    out_.has_face.assign(mesh.faces.size(), true);
    out_.mesh = std::move(mesh);
    find_middle();
    faces_of_.resize(vertices().size());
    quadric_.resize(vertices().size());
    changes_.assign(vertices().size(), 0);
    for (std::uint32_t f = 0; f < faces().size(); ++f) {
      for (const std::uint32_t v : faces()[f]) faces_of_[v].push_back(f);
    }
    for (std::uint32_t f = 0; f < faces().size(); ++f) add_planes(f);
    for (std::uint32_t v = 0; v < vertices().size(); ++v) {
      for (const std::uint32_t w : neighbours(v)) {
        if (v < w) push(v, w);
      }
    }
  }

  SimplifiedMesh run(std::size_t triangles, const WorkProgress& progress) {
    const std::size_t all = out_.face_count;
    while (out_.face_count > triangles && !queue_.empty()) {
      const Candidate edge = queue_.top();
      queue_.pop();
      if (!out_.has_vertex[edge.v] || !out_.has_vertex[edge.w]) continue;
      if (edge.changes != changes_[edge.v] + changes_[edge.w]) continue;  // another cost has taken its place
      if (!is_legal(edge)) continue;
      collapse(edge);
      if (progress) progress(all - out_.face_count, all - std::min(all, triangles));
    }
    return std::move(out_);
  }

 private:
  struct Candidate {
    double cost;
    std::uint32_t v, w;
    std::uint64_t changes;  // of both ends, when the cost was formed
    Vec3 to;                // from the middle
    bool operator>(const Candidate& other) const {
      return std::tie(cost, v, w) > std::tie(other.cost, other.v, other.w);
    }
  };

  std::vector<Vec3>& vertices() { return out_.mesh.vertices; }
  std::vector<MeshFace>& faces() { return out_.mesh.faces; }
  // Quadrics count from the middle of the mesh, so that little cancels.
  Vec3 place(std::uint32_t v) { return vertices()[v] - middle_; }

  void find_middle() {
    constexpr double most = std::numeric_limits<double>::max();
    Vec3 low{most, most, most}, high{-most, -most, -most};
    for (const Vec3& v : vertices()) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    middle_ = low * 0.5 + high * 0.5;
  }

  std::vector<std::uint32_t> neighbours(std::uint32_t v) {
    std::vector<std::uint32_t> out;
    for (const std::uint32_t f : faces_of_[v]) {
      std::ranges::copy_if(faces()[f], std::back_inserter(out), [&](std::uint32_t w) { return w != v; });
    }
    std::ranges::sort(out);
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
  std::size_t faces_between(std::uint32_t v, std::uint32_t w) {
    return static_cast<std::size_t>(std::ranges::count_if(
        faces_of_[v], [&](std::uint32_t f) { return std::ranges::find(faces()[f], w) != faces()[f].end(); }));
  }
  bool is_on_border(std::uint32_t v) {
    return std::ranges::any_of(neighbours(v), [&](std::uint32_t w) { return faces_between(v, w) == 1; });
  }

  void add_planes(std::uint32_t f) {
    const MeshFace face = faces()[f];
    const Vec3 normal = of_length_1(area_normal(place(face[0]), place(face[1]), place(face[2])));
    for (const std::uint32_t v : face) quadric_[v].add_plane(normal, -dot(normal, place(face[0])));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = face[k], w = face[(k + 1) % 3];
      if (faces_between(v, w) != 1) continue;
      const Vec3 across = of_length_1(cross(place(w) - place(v), normal));
      for (const std::uint32_t end : {v, w}) quadric_[end].add_plane(across, -dot(across, place(v)));
    }
  }

  void push(std::uint32_t v, std::uint32_t w) {
    const Quadric sum = quadric_[v] + quadric_[w];
    Candidate best{std::numeric_limits<double>::infinity(), v, w, changes_[v] + changes_[w], {}};
    const auto look_at = [&](const Vec3& to) {
      const double cost = sum.at(to);
      if (cost < best.cost) {
        best.cost = cost;
        best.to = to;
      }
    };
    const std::optional<Vec3> optimum = sum.optimum();
    if (optimum) {
      look_at(*optimum);
    } else {
      look_at(place(v) * 0.5 + place(w) * 0.5);
      look_at(place(v));
      look_at(place(w));
    }
    if (std::isfinite(best.cost)) queue_.push(best);
  }

  bool turns_a_face(std::uint32_t v, std::uint32_t other, const Vec3& to) {
    return std::ranges::any_of(faces_of_[v], [&](std::uint32_t f) {
      const MeshFace& face = faces()[f];
      if (std::ranges::find(face, other) != face.end()) return false;
      std::array<Vec3, 3> before, after;
      for (std::size_t k = 0; k < 3; ++k) {
        before[k] = place(face[k]);
        after[k] = face[k] == v ? to : before[k];
      }
      const Vec3 n = of_length_1(area_normal(before[0], before[1], before[2]));
      const Vec3 m = of_length_1(area_normal(after[0], after[1], after[2]));
      return dot(n, n) > 0 && dot(n, m) < least_cosine;
    });
  }

  bool is_legal(const Candidate& edge) {
    const std::size_t between = faces_between(edge.v, edge.w);
    if (between == 0 || between > 2) return false;
    const std::vector<std::uint32_t> a = neighbours(edge.v), b = neighbours(edge.w);
    std::vector<std::uint32_t> common;
    std::ranges::set_intersection(a, b, std::back_inserter(common));
    // Another common neighbour would make an edge of more than two faces.
    if (common.size() != between) return false;
    // A tetrahedron would fall flat.
    if (between == 2 && a.size() == 3 && b.size() == 3) return false;
    if (between == 2 && is_on_border(edge.v) && is_on_border(edge.w)) return false;
    return !turns_a_face(edge.v, edge.w, edge.to) && !turns_a_face(edge.w, edge.v, edge.to);
  }

  void collapse(const Candidate& edge) {
    Collapse c{edge.v, edge.w, edge.cost, vertices()[edge.v], vertices()[edge.w], edge.to + middle_, {}, {}};
    for (const std::uint32_t f : faces_of_[c.gone]) {
      MeshFace& face = faces()[f];
      if (std::ranges::find(face, c.kept) != face.end()) {
        c.gone_faces.push_back({f, face});
        out_.has_face[f] = false;
        --out_.face_count;
        for (const std::uint32_t v : face) {
          if (v != c.gone) std::erase(faces_of_[v], f);
        }
      } else {
        c.moved_faces.push_back(f);
        std::ranges::replace(face, c.gone, c.kept);
        faces_of_[c.kept].push_back(f);
      }
    }
    faces_of_[c.gone].clear();
    out_.has_vertex[c.gone] = false;
    vertices()[c.kept] = c.to;
    quadric_[c.kept] = quadric_[c.kept] + quadric_[c.gone];
    ++changes_[c.kept];
    for (const std::uint32_t w : neighbours(c.kept)) push(std::min(c.kept, w), std::max(c.kept, w));
    out_.log.push_back(std::move(c));
  }

  SimplifiedMesh out_;
  Vec3 middle_;
  std::vector<std::vector<std::uint32_t>> faces_of_;
  std::vector<Quadric> quadric_;
  std::vector<std::uint64_t> changes_;  // of the quadric of a vertex
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

IndexedMesh read_indexed_mesh(const std::string& path, std::size_t& left_out) {
  std::vector<std::string> bad_textures;
  const Mesh mesh = read_mesh(path, std::nullopt, &bad_textures);
  IndexedMesh out;
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  left_out = 0;
  for (const Face& face : mesh.faces) {
    const auto place = [&](std::size_t k) {
      const Vec3& p = face.corner[k].position;
      return std::array{p.x, p.y, p.z};
    };
    if (place(0) == place(1) || place(1) == place(2) || place(2) == place(0)) {
      ++left_out;
      continue;
    }
    MeshFace corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [entry, is_new] =
          numbers.try_emplace(place(k), static_cast<std::uint32_t>(out.vertices.size()));
      if (is_new) out.vertices.push_back(face.corner[k].position);
      corners[k] = entry->second;
    }
    out.faces.push_back(corners);
  }
  if (out.faces.empty()) throw InputError(path + ": no face has three different corners; expected a mesh");
  return out;
}

SimplifiedMesh simplify(IndexedMesh mesh, std::size_t triangles, const WorkProgress& progress) {
  return Simplifier(std::move(mesh)).run(triangles, progress);
}

void undo(SimplifiedMesh& mesh, std::size_t triangles) {
  while (mesh.face_count < triangles && !mesh.log.empty()) {
    const Collapse& c = mesh.log.back();
    for (const std::uint32_t f : c.moved_faces) std::ranges::replace(mesh.mesh.faces[f], c.kept, c.gone);
    for (const Collapse::GoneFace& gone : c.gone_faces) {
      mesh.mesh.faces[gone.face] = gone.corners;
      mesh.has_face[gone.face] = true;
    }
    mesh.face_count += c.gone_faces.size();
    mesh.mesh.vertices[c.kept] = c.kept_before;
    mesh.mesh.vertices[c.gone] = c.gone_before;
    mesh.has_vertex[c.gone] = true;
    mesh.log.pop_back();
  }
}

MeshCounts write_mesh(const SimplifiedMesh& mesh, ObjWriter& out) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.mesh.vertices.size(), none);
  MeshCounts counts;
  const auto for_each_face = [&](const auto& call) {
    for (std::size_t f = 0; f < mesh.mesh.faces.size(); ++f) {
      if (mesh.has_face[f]) call(mesh.mesh.faces[f]);
    }
  };
  for_each_face([&](const MeshFace& face) {
    for (const std::uint32_t v : face) {
      if (number[v] != none) continue;
      number[v] = static_cast<std::uint32_t>(counts.vertices++);
      out.vertex(mesh.mesh.vertices[v]);
    }
  });
  for_each_face([&](const MeshFace& face) {
    out.face(std::array{number[face[0]], number[face[1]], number[face[2]]});
    ++counts.triangles;
  });
  return counts;
}

}  // namespace bitspan
