// SPDX-License-Identifier: Apache-2.0
// bitspan make lod: a height field in many resolutions, by ranks of its points.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <vector>

#include "cli/make_commands.hpp"
#include "cli/make_options.hpp"
#include "config/config.hpp"
#include "io/atomic_file.hpp"
#include "io/npy.hpp"
#include "report/table.hpp"
#include "scene/generate/lod.hpp"

namespace bitspan {
namespace {

struct LodArguments {
  FieldOptions field;
  std::string output;
  std::string ranks_file;
  LodOptions lod;
  std::string cost = "error";
  int rank = -1;  // -1: the last one
};

int make_lod_command(const LodArguments& o) {
  if (o.output.empty() && o.ranks_file.empty()) {
    throw InputError("make lod: nothing to write; give -o MESH.obj or --rank-of RANKS.npy");
  }
  check_writable(o.output);
  check_writable(o.ranks_file);
  if (o.lod.ranks < 1 || o.lod.ranks > 64) {
    throw InputError(fmt::format("--ranks: {} is not legal; expected 1 to 64", o.lod.ranks));
  }
  if (!(o.lod.keep > 0 && o.lod.keep < 1)) {
    throw InputError(fmt::format("--keep: {} is not legal; expected a part between 0 and 1", o.lod.keep));
  }
  if (o.rank >= o.lod.ranks) {
    throw InputError(fmt::format("--rank: {} is not legal; expected 0 to {}", o.rank, o.lod.ranks - 1));
  }
  const HeightField field = load_field(o.field);
  LodOptions options = o.lod;
  options.cost = o.cost == "normal" ? LodCost::normal : LodCost::error;
  options.steepness = o.field.place.vertical / o.field.place.spacing;
  Lod lod;
  {
    Progress progress("ranks");
    lod = make_lod(field, options, shown(progress));
  }
  if (!o.output.empty()) {
    const int rank = o.rank < 0 ? o.lod.ranks - 1 : o.rank;
    const Delaunay surface = lod_surface(field, lod.rank, rank + 1);
    ObjWriter out(o.output, fmt::format("bitspan make lod: {} of {} x {} samples", surface.size(),
                                        field.columns, field.rows));
    write_surface(field, o.field.place, surface, out);
    out.commit();
  }
  if (!o.ranks_file.empty()) {
    write_npy(o.ranks_file, {static_cast<std::size_t>(field.rows), static_cast<std::size_t>(field.columns)},
              std::span<const std::int32_t>(lod.rank));
  }
  std::vector<std::vector<std::string>> rows{
      {"rank", "points", "triangles", "largest error", "so far", "RMS", "RMS of a grid"}};
  for (std::size_t r = 0; r < lod.ranks.size(); ++r) {
    const LodRank& rank = lod.ranks[r];
    rows.push_back({fmt::format("{}", r), fmt::format("{}", rank.points), fmt::format("{}", rank.triangles),
                    fmt::format("{:.6g}", rank.error.largest), fmt::format("{:.6g}", rank.bound),
                    fmt::format("{:.6g}", rank.error.rms),
                    fmt::format("{:.6g}", grid_error(field, rank.points).rms)});
  }
  fmt::print("{}errors are those of the heights as the field has them; a grid is one of as many points\n",
             text_table(rows));
  return exit_held;
}

}  // namespace

void add_make_lod(CLI::App& make, Action& action) {
  CLI::App* sub = make.add_subcommand("lod", "a height field in many resolutions, by ranks of its points");
  const auto o = std::make_shared<LodArguments>();
  add_field_options(*sub, o->field);
  sub->add_option("-o,--output", o->output, "the mesh without the points up to a rank, an OBJ file");
  sub->add_option("--rank", o->rank,
                  "the last rank whose points the mesh does not have (default: the last one)");
  sub->add_option("--rank-of", o->ranks_file, "the rank of each sample, an NPY file of int32");
  sub->add_option("--ranks", o->lod.ranks, "how many ranks")->capture_default_str();
  sub->add_option("--keep", o->lod.keep, "part of the points that stays behind the last rank")
      ->capture_default_str();
  sub->add_option(
         "--cost", o->cost,
         "of a point. error: how errors grow without it; normal: how its neighbours lie to its normal")
      ->check(CLI::IsMember({"error", "normal"}))
      ->capture_default_str();
  sub->footer(
      help_footer("the mesh is written", "",
                  "bitspan make lod dem.npz -o dem.obj --vertical 0.01\n"
                  "  bitspan make lod dem.npz --rank-of ranks.npy --ranks 5 --keep 0.02 --vertical 0.01"));
  sub->callback([o, &action] { action = [o] { return make_lod_command(*o); }; });
}

}  // namespace bitspan
