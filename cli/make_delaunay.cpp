// SPDX-License-Identifier: Apache-2.0
// bitspan make delaunay: points of a height field as a Delaunay triangulation, and Voronoi's cells.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <vector>

#include "cli/make_commands.hpp"
#include "cli/make_options.hpp"
#include "config/config.hpp"
#include "io/atomic_file.hpp"
#include "scene/generate/delaunay.hpp"
#include "scene/generate/lod.hpp"

namespace bitspan {
namespace {

struct DelaunayArguments {
  FieldOptions field;
  std::string output;
  std::string voronoi;
  std::uint64_t points = 0;  // 0: all
  std::uint64_t seed = 1;
};

// The corners, and others drawn from all samples, the same on every machine.
std::vector<GridPoint> drawn_points(const HeightField& field, std::uint64_t points, std::uint64_t seed) {
  std::vector<GridPoint> all = chosen_points(field, [](int, int) { return true; });
  if (points == 0) return all;
  if (points < 4 || points > all.size()) {
    throw InputError(fmt::format("--points: {} is not legal; expected 4 to {}, the number of samples", points,
                                 all.size()));
  }
  std::mt19937_64 random(seed);
  for (std::size_t i = 4; i < points; ++i) std::swap(all[i], all[i + random() % (all.size() - i)]);
  all.resize(points);
  return all;
}

void write_cells(const DelaunayArguments& o, const HeightField& field, const Delaunay& surface) {
  ObjWriter out(o.voronoi, fmt::format("bitspan make delaunay: {} cells of Voronoi", surface.size()));
  const PlacedField placed(field, o.field.place);
  std::vector<std::array<double, 2>> cell;
  std::vector<std::uint32_t> corners;
  std::uint32_t next = 0;
  for (std::uint32_t p = 0; p < surface.points().size(); ++p) {
    voronoi_cell(surface, p, cell);
    const GridPoint& at = surface.points()[p];
    corners.clear();
    for (const auto& corner : cell) {
      placed.write(out, corner[0], field.at(at.x, at.y), corner[1]);
      corners.push_back(next++);
    }
    // Seen from above, z runs downward.
    std::ranges::reverse(corners);
    out.face(corners);
  }
  out.commit();
}

int make_delaunay(const DelaunayArguments& o) {
  check_output(o.output);
  check_writable(o.voronoi);
  const HeightField field = load_field(o.field);
  Delaunay surface(drawn_points(field, o.points, o.seed));
  {
    Progress progress("points");
    surface.insert_all(shown(progress));
  }
  ObjWriter out(o.output, fmt::format("bitspan make delaunay: {} of {} x {} samples", surface.size(),
                                      field.columns, field.rows));
  const MeshCounts counts = write_surface(field, o.field.place, surface, out);
  if (!o.voronoi.empty()) write_cells(o, field, surface);
  out.commit();
  std::size_t on_edge = 0;
  for (std::uint32_t p = 0; p < surface.points().size(); ++p) on_edge += surface.is_on_edge(p) ? 1 : 0;
  fmt::print("{}: {} points, {} of them on the edge, {} triangles, {} edges\n", o.output, counts.vertices,
             on_edge, counts.triangles, 3 * counts.vertices - on_edge - 3);
  return exit_held;
}

}  // namespace

void add_make_delaunay(CLI::App& make, Action& action) {
  CLI::App* sub = make.add_subcommand("delaunay", "points of a height field as a Delaunay triangulation");
  const auto o = std::make_shared<DelaunayArguments>();
  add_field_options(*sub, o->field);
  sub->add_option("-o,--output", o->output, "the mesh, an OBJ file");
  sub->add_option("--points", o->points,
                  "how many samples, drawn at random; the corners are among them (default: all)");
  sub->add_option("--seed", o->seed, "of the draw")->capture_default_str();
  sub->add_option("--voronoi", o->voronoi,
                  "write Voronoi's cells too: an OBJ file with a flat polygon per point");
  sub->footer(help_footer("the mesh is written", "",
                          "bitspan make delaunay dem.npz -o dem.obj --points 5000 --vertical 0.01\n"
                          "  bitspan make delaunay hills.png -o hills.obj --points 300 --voronoi cells.obj"));
  sub->callback([o, &action] { action = [o] { return make_delaunay(*o); }; });
}

}  // namespace bitspan
