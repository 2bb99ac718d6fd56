// SPDX-License-Identifier: Apache-2.0
// bitspan make simplify: a mesh with fewer triangles, and back.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "cli/make_commands.hpp"
#include "cli/make_options.hpp"
#include "config/config.hpp"
#include "io/atomic_file.hpp"
#include "scene/generate/simplify.hpp"

namespace bitspan {
namespace {

struct SimplifyArguments {
  std::string mesh, output, log;
  bool undo = false;
  std::optional<std::uint64_t> triangles;
};

int undo_collapses(const SimplifyArguments& o) {
  if (!o.log.empty()) throw InputError("--log: is what undo reads; leave it out");
  SimplifiedMesh mesh = read_collapse_log(o.mesh);
  const std::size_t before = mesh.face_count;
  undo(mesh, o.triangles.value_or(std::numeric_limits<std::size_t>::max()));
  ObjWriter out(o.output, "bitspan make simplify");
  const MeshCounts counts = write_mesh(mesh, out);
  out.commit();
  fmt::print("{}: {} triangles back to {}, {} collapses left\n", o.output, before, counts.triangles,
             mesh.log.size());
  return exit_held;
}

int make_simplify(const SimplifyArguments& o) {
  check_output(o.output);
  check_writable(o.log);
  if (o.undo) return undo_collapses(o);
  if (!o.triangles || *o.triangles < 1)
    throw InputError("--triangles: is missing; expected how many are to be left, 1 or more");
  std::size_t left_out = 0;
  IndexedMesh mesh = read_indexed_mesh(o.mesh, left_out);
  const std::size_t before = mesh.faces.size();
  SimplifiedMesh simple;
  {
    Progress progress("triangles");
    simple = simplify(std::move(mesh), *o.triangles, shown(progress));
  }
  ObjWriter out(o.output, "bitspan make simplify");
  const MeshCounts counts = write_mesh(simple, out);
  if (!o.log.empty()) write_collapse_log(simple, o.log);
  out.commit();
  double largest = 0;
  for (const Collapse& c : simple.log) largest = std::max(largest, c.cost);
  fmt::print("{}: {} triangles to {}, {} vertices, {} collapses, largest cost {:.6g}\n", o.output, before,
             counts.triangles, counts.vertices, simple.log.size(), largest);
  if (left_out > 0) fmt::print("note: {} faces with two corners at one place are left out\n", left_out);
  if (counts.triangles > *o.triangles)
    fmt::print("note: no other edge can go without a fold, a hole or an edge of three faces\n");
  return exit_held;
}

}  // namespace

void add_make_simplify(CLI::App& make, Action& action) {
  CLI::App* sub =
      make.add_subcommand("simplify", "a mesh with fewer triangles, by collapsing edges; and back");
  const auto o = std::make_shared<SimplifyArguments>();
  sub->add_option("mesh", o->mesh, "mesh (OBJ, PLY, glTF ...); with --undo the log")->required();
  sub->add_option("-o,--output", o->output, "the mesh without colours and textures, an OBJ file");
  sub->add_option("--triangles", o->triangles,
                  "how many are to be left; with --undo how many are wanted back (default: all)");
  sub->add_option("--log", o->log, "write what was done, as JSON Lines, so that it can be undone");
  sub->add_flag("--undo", o->undo, "undo the collapses of a log, from the last one");
  sub->footer(
      help_footer("the mesh is written", "",
                  "bitspan make simplify spot.obj -o small.obj --triangles 1000 --log spot.collapses\n"
                  "  bitspan make simplify --undo spot.collapses -o spot_again.obj\n"
                  "  bitspan make simplify --undo spot.collapses -o middle.obj --triangles 3000"));
  sub->callback([o, &action] { action = [o] { return make_simplify(*o); }; });
}

}  // namespace bitspan
