// SPDX-License-Identifier: Apache-2.0
// bitspan make patches
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "cli/make_commands.hpp"
#include "config/config.hpp"
#include "io/atomic_file.hpp"
#include "scene/bez.hpp"

namespace bitspan {
namespace {

struct PatchesArguments {
  std::string patches, output;
  int k = patch_k_default;
  std::optional<int> guard;
};

// Each patch has vertices of its own, so that a crack shows.
std::string obj_of(const PatchSet& set, int k, int guard) {
  std::string vertices, faces;
  const std::size_t side = patch_side(k);
  std::size_t first = 1;
  for (const Patch& patch : set.patches) {
    std::array<std::vector<std::int64_t>, 3> points;
    for (std::size_t axis = 0; axis < 3; ++axis) points[axis] = patch_points(patch.axis[axis], k, guard);
    const auto value = [&](std::size_t axis, std::size_t at) {
      return std::ldexp(static_cast<double>(points[axis][at]), -(set.fraction + 2 * guard));
    };
    for (std::size_t at = 0; at < points[0].size(); ++at) {
      vertices += fmt::format("v {} {} {}\n", value(0, at), value(1, at), value(2, at));
    }
    for (std::size_t row = 0; row + 1 < side; ++row) {
      for (std::size_t column = 0; column + 1 < side; ++column) {
        const std::size_t at = first + row * side + column;
        faces += fmt::format("f {} {} {} {}\n", at, at + 1, at + side + 1, at + side);
      }
    }
    first += side * side;
  }
  return vertices + faces;
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
  if (!o.output.empty()) write_file(o.output, obj_of(set, o.k, guard));
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
