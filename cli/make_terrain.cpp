// SPDX-License-Identifier: Apache-2.0
// bitspan make terrain: a height field as a mesh.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "cli/make_commands.hpp"
#include "cli/make_options.hpp"
#include "cli/scene_options.hpp"
#include "config/config.hpp"
#include "scene/mesh_text.hpp"

namespace bitspan {
namespace {

struct TerrainArguments {
  FieldOptions field;
  std::string output;
  std::string grid = "right";
  std::optional<int> columns;
  std::string rings;
};

constexpr int grid_side_limit = 1 << 20;  // vertices

GridOptions grid_of(const TerrainArguments& o) {
  GridOptions grid;
  grid.kind = o.grid == "equilateral" ? GridKind::equilateral : GridKind::right;
  if (o.columns && (*o.columns < 2 || *o.columns > grid_side_limit)) {
    throw InputError(
        fmt::format("--columns: {} is not legal; expected 2 to {}", *o.columns, grid_side_limit));
  }
  grid.columns = o.columns.value_or(0);
  return grid;
}

RingOptions rings_of(const TerrainArguments& o, const HeightField& field) {
  const auto numbers = numbers_between_commas(o.rings, 3);
  if (!numbers) {
    throw InputError(
        fmt::format("--rings: {} is not legal; expected x,z,near: the viewer's place, and a distance",
                    in_quotes(o.rings)));
  }
  const std::vector<double>& n = *numbers;
  const double spacing = o.field.place.spacing;
  const RingOptions rings{n[0] / spacing + (field.columns - 1) / 2.0, n[1] / spacing + (field.rows - 1) / 2.0,
                          n[2] / spacing};
  if (!(rings.near >= 2)) {
    throw InputError(fmt::format("--rings: a distance of {} is not legal; expected at least 2 samples, {}",
                                 n[2], 2 * spacing));
  }
  return rings;
}

int make_terrain(const TerrainArguments& o) {
  check_output(o.output);
  const GridOptions grid = grid_of(o);
  if (!o.rings.empty() && (o.columns || grid.kind != GridKind::right)) {
    throw InputError("--rings: are of the field's own samples; leave --columns and --grid out");
  }
  const HeightField field = load_field(o.field);
  Progress progress("terrain");
  ObjWriter out(o.output, fmt::format("bitspan make terrain: {} x {} samples", field.columns, field.rows));
  MeshCounts counts;
  std::string what = o.grid + " grid";
  if (o.rings.empty()) {
    counts = write_grid(field, o.field.place, grid, out, shown(progress));
  } else {
    const RingMesh rings = ring_mesh(field.columns, field.rows, rings_of(o, field));
    const PlacedField placed(field, o.field.place);
    for (const auto& v : rings.vertices) placed.write(out, v[0], v[1]);
    for (const auto& face : rings.triangles) out.face(face);
    counts = {rings.vertices.size(), rings.triangles.size()};
    what = fmt::format("rings of {} widths", rings.levels);
  }
  out.commit();
  fmt::print("{}: {} x {} samples, {}, {} vertices, {} triangles\n", o.output, field.columns, field.rows,
             what, counts.vertices, counts.triangles);
  return exit_held;
}

}  // namespace

void add_make_terrain(CLI::App& make, Action& action) {
  CLI::App* sub =
      make.add_subcommand("terrain", "a height field as a mesh, on a grid or in rings around a viewer");
  const auto o = std::make_shared<TerrainArguments>();
  add_field_options(*sub, o->field);
  sub->add_option("-o,--output", o->output, "the mesh, an OBJ file");
  sub->add_option("--grid", o->grid,
                  "right: squares with a diagonal; equilateral: rows shifted by half a step")
      ->check(CLI::IsMember({"right", "equilateral"}))
      ->capture_default_str();
  sub->add_option("--columns", o->columns,
                  "vertices per row, with interpolated heights; the rows follow (default: the samples)");
  sub->add_option(
      "--rings", o->rings,
      "x,z,near: full resolution up to this distance from the place, and half of it per doubling");
  sub->footer(help_footer("the mesh is written", "",
                          "bitspan make terrain hills.png -o hills.obj --vertical 0.01\n"
                          "  bitspan make terrain dem.npz -o dem.obj --grid equilateral --columns 200\n"
                          "  bitspan make terrain dem.npz -o dem.obj --rings 0,60,24"));
  sub->callback([o, &action] { action = [o] { return make_terrain(*o); }; });
}

}  // namespace bitspan
