// SPDX-License-Identifier: Apache-2.0
#include "engine/draw_pass.hpp"

#include <optional>
#include <string>
#include <vector>

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
    std::vector<bool> added;
    std::uint64_t before = value_of(engine.counters(), counter);
    for (; done < scene.triangles.size(); ++done) {
      draw_scene(engine, scene, done, 1, nullptr);
      const std::uint64_t now = value_of(engine.counters(), counter);
      added.push_back(now != before);
      before = now;
    }
    return added;
  };
}

}  // namespace bitspan
