// SPDX-License-Identifier: Apache-2.0
#include "engine/draw_pass.hpp"

#include <optional>
#include <string>

namespace bitspan {
namespace {

std::uint64_t value_of(const Counters& counters, const std::string& name) {
  std::optional<std::uint64_t> out;
  for_each_counter([&](const CounterInfo& info, auto member) {
    if (info.name == name) out = static_cast<std::uint64_t>(counters.*member);
  });
  if (!out) throw InputError("counter " + name + " does not exist; expected one of docs/numeric-spec.md");
  return *out;
}

}  // namespace

DrawPass draw_pass(Engine& engine) {
  // A pass leaves no command behind its last triangle, so what is appended begins there.
  return [&engine, done = std::size_t{0}](const Scene& scene, const std::string& counter) mutable {
    const std::uint64_t first = value_of(engine.counters(), counter);
    draw_scene(engine, scene, done, scene.triangles.size() - done, nullptr);
    done = scene.triangles.size();
    return value_of(engine.counters(), counter) - first;
  };
}

}  // namespace bitspan
