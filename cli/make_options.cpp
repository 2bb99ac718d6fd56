// SPDX-License-Identifier: Apache-2.0
#include "cli/make_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "config/config.hpp"
#include "io/atomic_file.hpp"

namespace bitspan {
namespace {

// Products with heights and places stay doubles.
constexpr double scale_limit = 1e9;

void check_scale(double value, const char* flag) {
  if (value > 0 && value <= scale_limit) return;
  throw InputError(
      fmt::format("{}: {} is not legal; expected a number above 0 and at most {}", flag, value, scale_limit));
}

}  // namespace

void add_field_options(CLI::App& command, FieldOptions& o) {
  command
      .add_option("field", o.field, "height field: a PNG of grey levels, or an NPY or NPZ array of two axes")
      ->required();
  command.add_option("--array", o.array, "of an NPZ file: the array's name (default: the one of two axes)");
  command.add_option("--every", o.every, "take every n-th sample along both axes")->capture_default_str();
  command.add_option("--spacing", o.place.spacing, "between samples, in the mesh")->capture_default_str();
  command.add_option("--vertical", o.place.vertical, "times each height, in the mesh")->capture_default_str();
  command.add_flag("--shade", o.place.shade, "vertices have a grey that grows with the height");
}

HeightField load_field(const FieldOptions& o) {
  check_scale(o.place.spacing, "--spacing");
  check_scale(o.place.vertical, "--vertical");
  if (o.every < 1) throw InputError(fmt::format("--every: {} is not legal; expected 1 or more", o.every));
  HeightField field = read_height_field(o.field, o.array);
  return o.every > 1 ? every_nth(field, o.every) : field;
}

void check_output(const std::string& output) {
  if (output.empty()) throw InputError("make: nothing to write; give -o MESH.obj");
  check_writable(output);
}

WorkProgress shown(Progress& progress) {
  return [&progress](std::size_t done, std::size_t total) { progress.update(done, total); };
}

}  // namespace bitspan
