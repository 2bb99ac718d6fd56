// SPDX-License-Identifier: Apache-2.0
// bitspan make patches
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "cli/make_commands.hpp"
#include "config/config.hpp"
#include "scene/bez.hpp"
#include "scene/generate/obj_writer.hpp"

namespace bitspan {
namespace {

struct PatchesArguments {
  std::string patches, output;
  int k = patch_k_default;
  std::optional<int> guard;
};

// Each patch has vertices of its own, so that a crack shows.
void write_patches(const PatchSet& set, int k, int guard, ObjWriter& out) {
  for (const Patch& patch : set.patches) {
    const PatchPoints points = patch_points(patch, k, guard);
    for (std::size_t at = 0; at < points[0].size(); ++at) out.vertex(place_in(set, points, at, guard));
  }
  const auto side = static_cast<std::uint32_t>(patch_side(k));
  std::uint32_t first = 0;
  for (std::size_t patch = 0; patch < set.patches.size(); ++patch, first += side * side) {
    for (std::uint32_t row = 0; row + 1 < side; ++row) {
      for (std::uint32_t column = 0; column + 1 < side; ++column) {
        const std::uint32_t at = first + row * side + column;
        out.face(std::array{at, at + 1, at + side + 1, at + side});
      }
    }
  }
}

int make_patches(const PatchesArguments& o) {
  const int enough = 3 * o.k;
  const int guard = o.guard.value_or(enough);
  if (guard > enough) {
    throw InputError(
        fmt::format("make patches: --guard-bits {}: 2^{} steps need no more than {}; expected 0..{}", guard,
                    o.k, enough, enough));
  }
  const PatchSet set = read_bez(o.patches);
  check_patch_count(set, o.k);
  const PatchCracks found = count_cracks(set, o.k, guard);
  if (!o.output.empty()) {
    ObjWriter out(o.output);
    write_patches(set, o.k, guard, out);
    out.commit();
  }
  fmt::print("{}: {} patches of 2^{} steps each way, {} guard bits of {}\n", o.patches, set.patches.size(),
             o.k, guard, enough);
  fmt::print("cracks: {} of {} points on {} shared boundaries\n", found.cracks, found.points,
             found.boundaries);
  fmt::print("corners: {} of {} beside their control point\n", found.corners_off, found.corners);
  return exit_held;
}

}  // namespace

void add_make_patches(CLI::App& make, Action& action) {
  CLI::App* sub = make.add_subcommand("patches", "bicubic patches by adders, and the cracks between them");
  const auto o = std::make_shared<PatchesArguments>();
  sub->add_option("patches", o->patches, "file of patches (.bez)")->required();
  sub->add_option("-o,--output", o->output, "OBJ to write; without it only cracks are counted");
  sub->add_option("-k,--halvings", o->k, "2^k steps each way per patch")
      ->check(CLI::Range(patch_k_least, patch_k_limit))
      ->capture_default_str();
  sub->add_option("--guard-bits", o->guard,
                  "fraction bits beyond the control points', each way (default: 3 k, with which nothing is "
                  "rounded)")
      ->check(CLI::Range(0, 3 * patch_k_limit));
  sub->footer(
      help_footer("the cracks are counted", "", "bitspan make patches teapot.bez -k 5 --guard-bits 14"));
  sub->callback([o, &action] { action = [o] { return make_patches(*o); }; });
}

}  // namespace bitspan
