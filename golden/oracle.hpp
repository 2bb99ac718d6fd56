// SPDX-License-Identifier: Apache-2.0
// Oracles: pictures by another algorithm. An oracle says which triangle is seen at each pixel, and how far
// it is there. It has no registers and no records; report/visibility.hpp compares it with an engine.
//
// Each file of golden/oracles makes one oracle or several known. It ends with the function NAME_oracle, for
// NAME.cpp, which the linker is told to look for.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "golden/eye_space.hpp"
#include "golden/surface.hpp"

namespace bitspan {

// A triangle of a scene, as an oracle gets it.
struct OracleFace {
  std::int32_t index = 0;  // of the scene's triangles
  IdealTriangle shape;
};

// What an oracle counts besides, over a whole scene: "gaps".
struct OracleCount {
  std::string_view name;
  double value = 0;
};

struct OracleInput {
  const Config& config;               // for the fill rule, and what a triangle is after the snap
  const Scene& scene;                 // for its size, and its range of S
  std::span<const OracleFace> faces;  // by their index; those that a pixel may show
  // Where an oracle that counts something puts it; null: nowhere.
  std::vector<OracleCount>* counts = nullptr;
};

// What is seen at a pixel.
struct Visible {
  std::int32_t triangle = -1;  // input index; -1 where none
  golden::InverseDistance q;   // at the pixel's centre
};

// An edge, from end 0 to end 1.
struct SeenEdge {
  std::array<golden::EyePoint, 2> end{};
  std::vector<std::int32_t> on;  // input indices of the triangles in whose planes it lies, ascending
  // Its visible parts, as shares of the way to end 1: ascending, and apart.
  std::vector<std::array<double, 2>> visible;
};

struct Oracle {
  std::string_view name;
  std::string_view meaning;  // a line of help
  // False: its wrong pixels are counted, and no such pixel is a failure.
  bool is_truth = true;
  // Its pictures of scenes with a shadow map are compared with rays from the light as well.
  bool has_shadows = false;
  // Where triangles stand for quadrics, what is seen is compared with rays against these as well.
  bool has_quadrics = false;
  // It judges the colours of scenes that are drawn in translucency passes, by the layers of each pixel.
  bool has_layers = false;
  // It draws lines alone, for a look: it judges no picture, and what it sees has no q.
  bool draws_lines = false;
  // Why it does not draw a scene, beside what no oracle draws; empty where it does. Null: it draws all.
  std::string (*refuses)(const Config& config, const Scene& scene) = nullptr;
  // Returns height * width pixels, rows from the top. Of faces that are exactly as far, the one of the least
  // index is seen.
  std::vector<Visible> (*visible)(const OracleInput& input) = nullptr;
  // It judges edges and no pixels: `visible` is null then, and rays to points of the edges are compared with
  // it. triangles: input indices, ascending, of those that are drawn. counts: as of OracleInput.
  std::vector<SeenEdge> (*edges)(const Scene& scene, std::span<const std::int32_t> triangles,
                                 std::vector<OracleCount>* counts) = nullptr;

  // Whether its picture can be compared with an engine's.
  bool judges_pixels() const { return visible != nullptr && !draws_lines; }
};

// An object of this type at namespace scope makes an oracle known before main(). Throws std::logic_error
// where the name is known already.
struct RegisterOracle {
  explicit RegisterOracle(const Oracle& oracle);
};

// By their names.
std::span<const Oracle> oracles();
// The one of that name; null where there is none.
const Oracle* find_oracle(std::string_view name);
// Their names, with `between` between two: of those that judge something, or of all.
std::string oracle_names(std::string_view between, bool with_lines = false);
// "half_planes,simplex" -> the oracles, each known and named once; "all" stands for every one that judges
// something. Throws InputError, which names --oracles, otherwise.
std::vector<const Oracle*> parse_oracles(const std::string& list);

namespace golden {

// The triangles of a scene that have an area after the snap.
std::vector<OracleFace> faces_of_scene(const Config& config, const Scene& scene);

// Whether a point belongs to a triangle, its edges as the fill rule says.
using CoverageTest = std::function<bool(const IdealTriangle& t, Point p)>;
// The nearest face at each pixel: the test is asked at every centre of a face's bounding box.
std::vector<Visible> nearest_faces(const OracleInput& input, const CoverageTest& covers);

}  // namespace golden
}  // namespace bitspan
