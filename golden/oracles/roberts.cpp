// SPDX-License-Identifier: Apache-2.0
// Roberts' algorithm: which parts of the edges of convex bodies are seen. [H2]
//
// The eye is at 0. A body is where n p + d > 0 for all its planes; a point inside says which way each one is
// turned (B5). It hides a point p where some point between p and the eye is inside. In homogeneous
// coordinates that is (p, 1 + alpha), alpha > 0, and n p + d + alpha d > 0: along an edge a linear program in
// alpha and t. A plane of a face that is seen has d < 0 and bounds alpha from above, and any other one bounds
// alpha from below. So alpha drops out. Left are the planes of the seen faces, and of each pair of both kinds
// a plane through the eye. The pairs that meet along the contour of a convex body imply all others. So a
// body hides what is behind its seen faces and between its walls, the planes through the eye and the
// contour. They are known too where faces seen from behind have been removed (H1).
//
// The three stages:
// 1. An edge whose faces are all seen from behind is hidden by its own body.
// 2. Every other edge loses what the other bodies hide. The source sorts the bodies by their farthest
//    points, and asks of an edge only those that are then nearer. But a body that reaches farther may hide
//    others with its near end: here all bodies are asked.
// 3. Where faces of two bodies cut each other is a new edge, between the points at which the outline of each
//    pierces the other. It then is as the edges of stage 2. The source looks for such points on front, side
//    and top faces; here any seen face may have some.
//
// A body is made of triangles that are connected by their sides. Where they are no convex body seen from
// outside, they are cut where they make corners that are open to the eye. What is no convex body then falls
// apart into triangles, and each of them is a flat body.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "golden/box_tree.hpp"
#include "golden/oracle.hpp"

namespace bitspan {

namespace {

using golden::BoxTree;
using golden::EyePoint;
using golden::SharePart;
using Real = long double;

// What counts as one place, of the distance from the eye. Vertices of one plane are off from it by the
// rounding of doubles, a thousandth of this. golden::near_crossing is a hundred times as much.
constexpr Real same_place = 1e-11L;
// Two triangles whose planes meet at a smaller angle have no edge between them.
constexpr Real flat_angle = 1e-4L;

// Positive on the inner side.
struct HalfSpace {
  EyePoint normal;
  Real offset = 0;
  Real at(const EyePoint& p) const { return dot(normal, p) + offset; }
  void turn() { *this = {normal * -1, -offset}; }
};
bool is_on(const HalfSpace& plane, const EyePoint& p) {
  return std::abs(plane.at(p)) <= same_place * length(p);
}
bool contains(const HalfSpace& half, const EyePoint& p) { return half.at(p) >= -same_place * length(p); }

using Segment = std::array<EyePoint, 2>;

// Leaves of a part what lies inside by more than a hundredth of one place; false where that is nothing.
bool cut_to(const HalfSpace& half, const Segment& segment, SharePart& part) {
  const auto at = [&](const EyePoint& p) { return half.at(p) - same_place / 100 * length(p); };
  return part.keep_positive(at(segment[0]), at(segment[1]));
}

// The triangles with their vertices as indices.
struct Mesh {
  std::vector<std::int32_t> index;  // in the scene
  std::vector<std::array<std::uint32_t, 3>> corner;
  std::vector<EyePoint> place;    // per vertex
  std::vector<ScreenPoint> seen;  // the same
  const EyePoint& corner_at(std::uint32_t t, std::size_t i) const { return place[corner[t][i]]; }
};

Mesh mesh_of(const Scene& scene, std::span<const std::int32_t> triangles) {
  Mesh out;
  std::map<std::array<double, 3>, std::uint32_t> known;
  for (const std::int32_t index : triangles) {
    const Triangle& triangle = scene.triangles[static_cast<std::size_t>(index)];
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& v = triangle.v[i];
      const auto [at, is_new] = known.try_emplace({v.x, v.y, v.s}, static_cast<std::uint32_t>(known.size()));
      if (is_new) {
        out.place.push_back(golden::eye_point(v, scene));
        out.seen.push_back(v);
      }
      corner[i] = at->second;
    }
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
    out.index.push_back(index);
    out.corner.push_back(corner);
  }
  return out;
}

struct PartEdge {
  std::uint32_t a = 0, b = 0;            // vertices
  std::vector<std::uint32_t> triangles;  // of the part
};
struct Part {
  std::vector<std::uint32_t> triangles;  // ascending
  std::vector<PartEdge> edges;
};

// The sets that some numbers from 0 on are united to.
class Union {
 public:
  explicit Union(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) { parent_[root(i)] = root(j); }

 private:
  std::vector<std::uint32_t> parent_;
};

Part single_part(const Mesh& mesh, std::uint32_t t) {
  const auto& c = mesh.corner[t];
  return {{t}, {{c[0], c[1], {t}}, {c[1], c[2], {t}}, {c[2], c[0], {t}}}};
}

std::uint32_t place_in(const Part& part, std::uint32_t triangle) {
  return static_cast<std::uint32_t>(std::ranges::lower_bound(part.triangles, triangle) -
                                    part.triangles.begin());
}

// Splits some triangles with these edges between them into what is connected by edges that connect.
template <class Connects>
std::vector<Part> split(const Part& whole, Connects connects) {
  Union united(whole.triangles.size());
  for (const PartEdge& edge : whole.edges) {
    if (edge.triangles.size() == 2 && connects(edge)) {
      united.unite(place_in(whole, edge.triangles[0]), place_in(whole, edge.triangles[1]));
    }
  }
  std::vector<Part> out;
  std::vector<std::size_t> part_of_root(whole.triangles.size(), whole.triangles.size());
  const auto part_of = [&](std::uint32_t t) -> Part& {
    std::size_t& part = part_of_root[united.root(place_in(whole, t))];
    if (part == whole.triangles.size()) {
      part = out.size();
      out.emplace_back();
    }
    return out[part];
  };
  for (const std::uint32_t t : whole.triangles) part_of(t).triangles.push_back(t);
  for (const PartEdge& edge : whole.edges) {
    for (const std::uint32_t t : edge.triangles) {
      Part& part = part_of(t);
      if (part.edges.empty() || part.edges.back().a != edge.a || part.edges.back().b != edge.b) {
        part.edges.push_back({edge.a, edge.b, {}});
      }
      part.edges.back().triangles.push_back(t);
    }
  }
  return out;
}

// Edges of exactly two triangles connect these. So bodies that touch along an edge stay apart.
std::vector<Part> parts_of(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> sides;
  Part all;
  for (std::uint32_t t = 0; t < mesh.corner.size(); ++t) {
    all.triangles.push_back(t);
    for (std::size_t i = 0; i < 3; ++i) {
      sides[std::minmax(mesh.corner[t][i], mesh.corner[t][(i + 1) % 3])].push_back(t);
    }
  }
  for (auto& [ends, triangles] : sides) all.edges.push_back({ends.first, ends.second, std::move(triangles)});
  return split(all, [](const PartEdge&) { return true; });
}

std::uint32_t opposite(const Mesh& mesh, std::uint32_t t, const PartEdge& edge) {
  for (const std::uint32_t v : mesh.corner[t]) {
    if (v != edge.a && v != edge.b) return v;
  }
  return edge.a;
}

// Whether two triangles go on in one plane across their edge, but for an angle.
bool goes_on_flat(const Mesh& mesh, const PartEdge& edge) {
  const EyePoint& a = mesh.place[edge.a];
  const EyePoint along = mesh.place[edge.b] - a;
  const auto away = [&](std::uint32_t t) {
    const EyePoint to = mesh.place[opposite(mesh, t, edge)] - a;
    return to - along * (dot(to, along) / dot(along, along));
  };
  const EyePoint one = away(edge.triangles[0]);
  const EyePoint other = away(edge.triangles[1]);
  return dot(one, other) < 0 && length(cross(one, other)) <= flat_angle * length(one) * length(other);
}

// Cuts a part where two triangles make a corner that is open to the eye. Bodies that touch meet there, when
// the faces seen from behind that kept them apart have been removed.
std::vector<Part> pieces_of(const Mesh& mesh, const Part& part) {
  const auto rises = [&](std::uint32_t t, const EyePoint& p) {
    const EyePoint& a = mesh.corner_at(t, 0);
    const EyePoint normal = cross(mesh.corner_at(t, 1) - a, mesh.corner_at(t, 2) - a);
    const Real away = dot(normal, p - a) * (dot(normal, a) > 0 ? 1 : -1);  // from the eye
    return away < -same_place * length(normal) * length(p);
  };
  return split(part, [&](const PartEdge& edge) {
    const std::uint32_t t = edge.triangles[0];
    const std::uint32_t u = edge.triangles[1];
    return !rises(t, mesh.place[opposite(mesh, u, edge)]) || !rises(u, mesh.place[opposite(mesh, t, edge)]);
  });
}

// A face, of coplanar triangles.
struct BodyFace {
  HalfSpace plane;
  bool is_seen = false;  // from the front
  std::vector<std::uint32_t> triangles;
  std::vector<EyePoint> corners;
  std::vector<Segment> outline;
  std::vector<HalfSpace> sides;  // what lies within the outline, of the points of the plane
};

// What a body or an edge covers of the picture at distance 1, and of the distances.
struct Extent {
  BoxTree::Box box{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
  Real near = HUGE_VALL, far = 0;
  void add(const EyePoint& p) {
    const auto x = static_cast<double>(p.x / p.z);
    const auto y = static_cast<double>(p.y / p.z);
    box = {{std::min(box.min_corner().get<0>(), x), std::min(box.min_corner().get<1>(), y)},
           {std::max(box.max_corner().get<0>(), x), std::max(box.max_corner().get<1>(), y)}};
    near = std::min(near, p.z);
    far = std::max(far, p.z);
  }
};

struct Body {
  std::vector<BodyFace> faces;
  std::vector<std::size_t> face_of;  // per triangle of its part
  std::vector<HalfSpace> walls;
  Extent extent;
};

// Each once.
std::vector<EyePoint> corners_of(const Mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t t : triangles) {
    vertices.insert(vertices.end(), mesh.corner[t].begin(), mesh.corner[t].end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<EyePoint> out;
  for (const std::uint32_t v : vertices) out.push_back(mesh.place[v]);
  return out;
}

EyePoint middle_of(const std::vector<EyePoint>& points) {
  EyePoint sum;
  for (const EyePoint& p : points) sum = sum + p;
  return sum * (1 / static_cast<Real>(points.size()));
}

// The faces of a part, not turned yet; none where a triangle is folded back onto its neighbour's plane.
std::optional<Body> faces_of_part(const Mesh& mesh, const Part& part) {
  const std::size_t n = part.triangles.size();
  std::vector<HalfSpace> planes(n);
  std::vector<Real> area(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t t = part.triangles[i];
    const EyePoint& a = mesh.corner_at(t, 0);
    const EyePoint normal = cross(mesh.corner_at(t, 1) - a, mesh.corner_at(t, 2) - a);
    area[i] = length(normal);
    if (!(area[i] > 0)) return std::nullopt;
    planes[i].normal = normal * (1 / area[i]);
    planes[i].offset = -dot(planes[i].normal, a);
  }
  Union united(n);
  for (const PartEdge& edge : part.edges) {
    if (edge.triangles.size() > 2) return std::nullopt;
    if (edge.triangles.size() < 2) continue;
    std::uint32_t large = place_in(part, edge.triangles[0]);
    std::uint32_t small = place_in(part, edge.triangles[1]);
    if (area[large] < area[small]) std::swap(large, small);
    const EyePoint& end = mesh.place[opposite(mesh, part.triangles[small], edge)];
    if (!is_on(planes[large], end)) continue;
    const EyePoint& a = mesh.place[edge.a];
    const EyePoint across = cross(planes[large].normal, mesh.place[edge.b] - a);
    const EyePoint& other_end = mesh.place[opposite(mesh, part.triangles[large], edge)];
    if (dot(across, end - a) * dot(across, other_end - a) >= 0) return std::nullopt;
    united.unite(large, small);
  }
  Body out;
  std::vector<std::size_t> face_of_root(n, n);
  std::vector<Real> largest;
  for (std::uint32_t i = 0; i < n; ++i) {
    std::size_t& face = face_of_root[united.root(i)];
    if (face == n) {
      face = out.faces.size();
      out.faces.emplace_back();
      largest.push_back(0);
    }
    out.face_of.push_back(face);
    out.faces[face].triangles.push_back(part.triangles[i]);
    if (area[i] > largest[face]) out.faces[face].plane = planes[i];
    largest[face] = std::max(largest[face], area[i]);
  }
  for (BodyFace& face : out.faces) {
    face.corners = corners_of(mesh, face.triangles);
    const auto lies_on = [&](const EyePoint& p) { return is_on(face.plane, p); };
    if (!std::ranges::all_of(face.corners, lies_on)) return std::nullopt;
  }
  return out;
}

// The face of each triangle of an edge.
std::vector<std::size_t> faces_at(const Body& body, const Part& part, const PartEdge& edge) {
  std::vector<std::size_t> out;
  for (const std::uint32_t t : edge.triangles) out.push_back(body.face_of[place_in(part, t)]);
  return out;
}

// A side of a face: it ends there, on the side of `inner`.
void add_side(BodyFace& face, const Segment& side, const EyePoint& inner) {
  face.outline.push_back(side);
  const EyePoint across = cross(face.plane.normal, side[1] - side[0]);
  HalfSpace within{across * (1 / length(across)), 0};
  within.offset = -dot(within.normal, side[0]);
  if (within.at(inner) < 0) within.turn();
  face.sides.push_back(within);
}

// None where the part is no convex body seen from outside: closed, or open with each face seen from the
// front and none missing.
std::optional<Body> convex_body(const Mesh& mesh, const Part& part) {
  std::optional<Body> body = faces_of_part(mesh, part);
  if (!body) return std::nullopt;
  Body& out = *body;
  const std::vector<EyePoint> corners = corners_of(mesh, part.triangles);
  const EyePoint inner = middle_of(corners);
  for (const EyePoint& p : corners) out.extent.add(p);
  const auto contains_all = [&](const HalfSpace& half) {
    return std::ranges::all_of(corners, [&](const EyePoint& p) { return contains(half, p); });
  };
  const bool is_flat = out.faces.size() == 1;
  for (BodyFace& face : out.faces) {
    if (!is_flat && is_on(face.plane, inner)) return std::nullopt;
    // A flat body is behind its face.
    if (is_flat ? face.plane.offset > 0 : face.plane.at(inner) < 0) face.plane.turn();
    if (!contains_all(face.plane)) return std::nullopt;
    face.is_seen = face.plane.offset < -same_place * length(inner);
  }
  const bool is_open =
      std::ranges::any_of(part.edges, [](const PartEdge& edge) { return edge.triangles.size() == 1; });
  if (is_open ? !std::ranges::all_of(out.faces, &BodyFace::is_seen)
              : is_flat || std::ranges::none_of(out.faces, &BodyFace::is_seen)) {
    return std::nullopt;
  }
  std::vector<EyePoint> middles;
  for (const BodyFace& face : out.faces) middles.push_back(middle_of(face.corners));
  for (const PartEdge& edge : part.edges) {
    const std::vector<std::size_t> at = faces_at(out, part, edge);
    if (at.size() == 2 && at[0] == at[1]) continue;
    for (const std::size_t f : at) {
      add_side(out.faces[f], {mesh.place[edge.a], mesh.place[edge.b]}, middles[f]);
    }
    if (at.size() == 2 && out.faces[at[0]].is_seen == out.faces[at[1]].is_seen) continue;
    const EyePoint& a = mesh.place[edge.a];
    const EyePoint& b = mesh.place[edge.b];
    const EyePoint across = cross(a, b);
    const Real size = length(across);
    if (!(size > same_place * length(a) * length(b))) continue;  // the eye sees a point of it
    HalfSpace wall{across * (1 / size), 0};
    if (wall.at(inner) < 0) wall.turn();
    if (!contains_all(wall)) return std::nullopt;
    out.walls.push_back(wall);
  }
  return body;
}

// An edge, before it is known what hides it.
struct Candidate {
  Segment ends;
  std::vector<std::uint32_t> own;  // bodies that it is an edge of
  std::vector<std::int32_t> on;    // triangles of the scene
  bool is_hidden = false;          // by its own body
};

// Where a triangle is: in a face of a body, or in none, since the eye sees it from its side.
struct Home {
  std::optional<std::uint32_t> body;
  std::size_t face = 0;
};

struct Bodies {
  std::vector<Body> bodies;
  std::vector<Home> home;  // per triangle of the mesh
  std::vector<Candidate> edges;
  std::size_t apart = 0;  // triangles that are bodies of their own, as what they are part of is not convex
};

// Clipping has cut a face there, so that this is no edge of a body.
bool lies_along_the_border(const Mesh& mesh, const PartEdge& edge, const View& view) {
  const ScreenPoint& a = mesh.seen[edge.a];
  const ScreenPoint& b = mesh.seen[edge.b];
  return (a.x == b.x && (a.x == 0 || a.x == view.width)) || (a.y == b.y && (a.y == 0 || a.y == view.height));
}

// Adds a part as one body; false where it is none.
bool add_body(const Mesh& mesh, const Part& part, Bodies& to) {
  std::optional<Body> body = convex_body(mesh, part);
  if (!body) return false;
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    to.home[part.triangles[i]] = {static_cast<std::uint32_t>(to.bodies.size()), body->face_of[i]};
  }
  to.bodies.push_back(std::move(*body));
  return true;
}

// The edge of a part; none where its triangles are of one face, or nearly.
std::optional<Candidate> candidate_of(const Scene& scene, const Mesh& mesh, const Bodies& all,
                                      const PartEdge& edge) {
  if (edge.triangles.size() == 1 && lies_along_the_border(mesh, edge, scene)) return std::nullopt;
  Candidate out{{mesh.place[edge.a], mesh.place[edge.b]}, {}, {}};
  std::size_t seen = 0;
  for (const std::uint32_t t : edge.triangles) {
    const Home& home = all.home[t];
    out.on.push_back(mesh.index[t]);
    if (!home.body) continue;
    const BodyFace& face = all.bodies[*home.body].faces[home.face];
    seen += face.is_seen ? 1 : 0;
    out.own.push_back(*home.body);
    for (const std::uint32_t same : face.triangles) out.on.push_back(mesh.index[same]);
  }
  if (edge.triangles.size() == 2) {
    const Home& one = all.home[edge.triangles[0]];
    const Home& other = all.home[edge.triangles[1]];
    const bool is_one_body = one.body && one.body == other.body;
    if (is_one_body && one.face == other.face) return std::nullopt;
    if (!(is_one_body && seen == 1) && goes_on_flat(mesh, edge)) return std::nullopt;
    out.is_hidden = is_one_body && seen == 0;
  }
  return out;
}

Bodies bodies_of(const Scene& scene, const Mesh& mesh) {
  Bodies out;
  out.home.resize(mesh.corner.size());
  for (const Part& part : parts_of(mesh)) {
    if (!add_body(mesh, part, out)) {
      for (const Part& piece : pieces_of(mesh, part)) {
        if (add_body(mesh, piece, out)) continue;
        out.apart += piece.triangles.size();
        for (const std::uint32_t t : piece.triangles) add_body(mesh, single_part(mesh, t), out);
      }
    }
    for (const PartEdge& edge : part.edges) {
      if (auto candidate = candidate_of(scene, mesh, out, edge)) out.edges.push_back(std::move(*candidate));
    }
  }
  return out;
}

// Where two faces cut each other, by the points at which the outline of one pierces the plane of the other.
std::optional<Segment> cut_of(const BodyFace& face, const BodyFace& other) {
  const auto straddles = [](const BodyFace& one, const HalfSpace& plane) {
    const auto beyond = [&](Real sign) {
      return std::ranges::any_of(
          one.corners, [&](const EyePoint& p) { return sign * plane.at(p) > same_place * length(p); });
    };
    return beyond(1) && beyond(-1);
  };
  if (!straddles(face, other.plane) || !straddles(other, face.plane)) return std::nullopt;
  std::vector<EyePoint> pierced;
  for (const auto& [a, b] : face.outline) {
    const Real first = other.plane.at(a);
    const Real last = other.plane.at(b);
    if ((first >= 0) != (last >= 0)) pierced.push_back(a + (b - a) * (first / (first - last)));
  }
  if (pierced.size() != 2) return std::nullopt;
  const Segment whole{pierced[0], pierced[1]};
  SharePart part;
  for (const HalfSpace& side : other.sides) {
    if (!cut_to(side, whole, part)) return std::nullopt;
  }
  const EyePoint along = whole[1] - whole[0];
  const Segment out{whole[0] + along * part.low, whole[0] + along * part.high};
  if (length(out[1] - out[0]) <= 100 * same_place * length(out[0])) return std::nullopt;
  return out;
}

BoxTree tree_of(const std::vector<Body>& bodies) {
  std::vector<BoxTree::Entry> entries;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    entries.emplace_back(bodies[i].extent.box, static_cast<std::uint32_t>(i));
  }
  return BoxTree(entries);
}

// Stage 3: appends the new edges.
void add_cuts(const Mesh& mesh, Bodies& all, const BoxTree& tree) {
  for (std::uint32_t i = 0; i < all.bodies.size(); ++i) {
    const Body& body = all.bodies[i];
    for (const auto& [box, j] : tree.touching(body.extent.box)) {
      const Body& other = all.bodies[j];
      if (j <= i || body.extent.far < other.extent.near || other.extent.far < body.extent.near) continue;
      for (const BodyFace& face : body.faces) {
        for (const BodyFace& cut_by : other.faces) {
          if (!face.is_seen || !cut_by.is_seen) continue;
          const std::optional<Segment> cut = cut_of(face, cut_by);
          if (!cut) continue;
          Candidate c{*cut, {i, j}, {}};
          for (const BodyFace* of : {&face, &cut_by}) {
            for (const std::uint32_t t : of->triangles) c.on.push_back(mesh.index[t]);
          }
          all.edges.push_back(std::move(c));
        }
      }
    }
  }
}

// Stage 2, against one body.
std::optional<SharePart> hidden_part(const Segment& edge, const Body& body) {
  SharePart out;
  for (const BodyFace& face : body.faces) {
    if (face.is_seen && !cut_to(face.plane, edge, out)) return std::nullopt;
  }
  for (const HalfSpace& wall : body.walls) {
    if (!cut_to(wall, edge, out)) return std::nullopt;
  }
  return out;
}

std::vector<std::array<double, 2>> rest_of(std::vector<SharePart> hidden) {
  std::ranges::sort(hidden, {}, &SharePart::low);
  std::vector<std::array<double, 2>> out;
  Real from = 0;
  const auto add = [&](Real to) {
    const std::array<double, 2> part{static_cast<double>(from), static_cast<double>(to)};
    if (part[0] < part[1]) out.push_back(part);
  };
  for (const SharePart& part : hidden) {
    add(part.low);
    from = std::max(from, part.high);
  }
  add(1);
  return out;
}

std::vector<SeenEdge> by_bodies(const Scene& scene, std::span<const std::int32_t> triangles,
                                std::vector<OracleCount>* counts) {
  const Mesh mesh = mesh_of(scene, triangles);
  Bodies all = bodies_of(scene, mesh);
  const std::size_t edges = all.edges.size();
  const BoxTree tree = tree_of(all.bodies);
  add_cuts(mesh, all, tree);
  std::vector<SeenEdge> out;
  for (Candidate& edge : all.edges) {
    std::vector<SharePart> hidden;
    if (edge.is_hidden) {
      hidden.emplace_back();
    } else {
      Extent extent;
      for (const EyePoint& p : edge.ends) extent.add(p);
      for (const auto& [box, body] : tree.touching(extent.box)) {
        if (std::ranges::find(edge.own, body) != edge.own.end()) continue;
        if (all.bodies[body].extent.near > extent.far) continue;
        if (const auto part = hidden_part(edge.ends, all.bodies[body])) hidden.push_back(*part);
      }
    }
    std::ranges::sort(edge.on);
    edge.on.erase(std::unique(edge.on.begin(), edge.on.end()), edge.on.end());
    out.push_back({edge.ends, std::move(edge.on), rest_of(std::move(hidden))});
  }
  if (counts != nullptr) {
    const auto number = [](std::size_t n) { return static_cast<double>(n); };
    *counts = {{"bodies", number(all.bodies.size())},
               {"of them triangles of what is not convex", number(all.apart)},
               {"edges", number(edges)},
               {"new edges where bodies cut each other", number(all.edges.size() - edges)}};
  }
  return out;
}

const RegisterOracle roberts{
    {.name = "roberts",
     .meaning = "Roberts' algorithm for edges of convex bodies; rays to points of edges judge it",
     .edges = by_bodies}};

}  // namespace

}  // namespace bitspan

extern "C" void roberts_oracle() {}
