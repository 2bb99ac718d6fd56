// SPDX-License-Identifier: Apache-2.0
#include "cli/failing_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "cli/verdict.hpp"
#include "engine/range.hpp"
#include "io/atomic_file.hpp"
#include "report/error.hpp"
#include "report/lockstep.hpp"
#include "report/reads.hpp"
#include "report/replay.hpp"

namespace bitspan {

Engines make_engines(const std::vector<std::string>& names, const Config& config, std::uint64_t stall_seed,
                     EngineOptions options) {
  options.stall_seed = stall_seed;
  Engines out;
  for (const std::string& name : names) {
    if (engine_runs(name, config)) {
      out.push_back(make_engine(name, config, options));
    }
  }
  return out;
}

void add_reads(LockStepResult& run, const Config& config, const Scene& scene) {
  for (Comparison& pair : run.pairs) {
    // In front of the divergence all engines agree; the model is the fastest.
    if (pair.first) add_reads(*pair.first, config, scene, *make_engine("model", config, {}));
  }
}

PairFailure failure_of(const Comparison& pair, const Config& config, const RunLabel& label) {
  if (!pair.first) {
    const std::string line = fmt::format("{} broke off: {}", pair.other, pair.fault);
    return {line, line + "\n"};
  }
  return {fmt::format("{} against {}: {}", pair.reference, pair.other, summary(*pair.first, config)),
          describe(*pair.first, config, label)};
}

std::vector<std::string> engines_to_compare(const ModelFlags& model, const std::string& list,
                                            std::string_view who, std::string_view one) {
  std::vector<std::string> names = parse_engines(list);
  refuse_without_model(model, std::ranges::count(names, "model") != 0);
  for (const std::string& name : names) {
    if (find_engine(name).compared) continue;
    throw InputError(
        fmt::format("--engines: {} is not quantised and equals no engine; leave it out of {}", name, who));
  }
  if (names.size() < 2) {
    throw InputError(fmt::format("--engines: {} compares at least two engines", one));
  }
  return names;
}

CaseResult check_case(const Engines& engines, const Config& config, const Scene& scene,
                      const RunLabel& label) {
  CaseResult out;
  ErrorMeter meter(config, scene);
  LockStepOptions steps;
  // The exact test knows one view.
  if (!changes_scene(scene.commands)) {
    steps.observe = [&](const Batch& batch, const Trace& trace) {
      meter.add(batch.triangles(), batch.first_index, trace);
    };
  }
  LockStepResult run;
  try {
    run = run_lock_step(engines, scene, steps);
  } catch (const InputError& error) {
    // The first engine takes this scene (see refusal), so all must.
    out.failure =
        fmt::format("another engine than {} refuses the scene: {}", engines[0]->name(), error.what());
    out.details = out.failure + "\n";
    return out;
  }
  out.fragments = engines[0]->counters().fragments;
  out.covered = engines[0]->counters().covered;
  add_reads(run, config, scene);
  for (const Comparison& pair : run.pairs) {
    const StageCount total = pair.total();
    out.values += total.values;
    out.non_trivial += total.non_trivial;
    if (total.non_trivial > 0) out.compared.push_back(pair.other);
    if (!pair.held() && out.failure.empty()) {
      const PairFailure failure = failure_of(pair, config, label);
      out.failure = failure.line;
      out.details = failure.details;
    }
  }
  const ErrorReport& errors = meter.report();
  if (out.failure.empty() && coverage_is_exact(config) && errors.coverage_differences() > 0) {
    out.failure =
        fmt::format("coverage of {} differs from the exact test: {} missed, {} surplus, {} drawn twice",
                    engines[0]->name(), errors.missed, errors.surplus, errors.doubled);
    out.details = out.failure + "\n";
  }
  return out;
}

std::string refusal(const Engines& engines, const Config& config, const Scene& scene) {
  try {
    check_scene_range(config, scene);
    check_commands(config, scene);
    engines[0]->begin(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Scene shrink(const Engines& engines, const Config& config, Scene scene, const RunLabel& label) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  const auto fails = [&](const Scene& candidate) {
    return std::chrono::steady_clock::now() < deadline && refusal(engines, config, candidate).empty() &&
           !check_case(engines, config, candidate, label).failure.empty();
  };
  for (std::size_t chunk = std::max<std::size_t>(1, scene.triangles.size() / 2); chunk >= 1; chunk /= 2) {
    for (std::size_t at = 0; at < scene.triangles.size();) {
      Scene smaller = scene;
      const std::size_t n = std::min(chunk, smaller.triangles.size() - at);
      erase_triangles(smaller, at, n);
      if (!smaller.triangles.empty() && fails(smaller)) {
        scene = std::move(smaller);
      } else {
        at += n;
      }
    }
  }
  for (std::size_t i = 0; i < scene.commands.size();) {
    Scene smaller = scene;
    smaller.commands.erase(smaller.commands.begin() + static_cast<std::ptrdiff_t>(i));
    if (fails(smaller)) {
      scene = std::move(smaller);
    } else {
      ++i;
    }
  }
  Scene without_fog = scene;
  without_fog.fog.reset();
  if (scene.fog && fails(without_fog)) {
    scene = std::move(without_fog);
  }
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    Scene bare = scene;
    bare.triangles[i].texture = -1;
    if (scene.triangles[i].texture >= 0 && fails(bare)) {
      scene = std::move(bare);
    }
  }
  // Textures that no triangle names any more; a command may name one, too, and then they stay.
  Scene bare = scene;
  std::vector<int> place(scene.textures.size(), -1);
  bare.textures.clear();
  for (Triangle& triangle : bare.triangles) {
    if (triangle.texture < 0) {
      continue;
    }
    int& at = place[static_cast<std::size_t>(triangle.texture)];
    if (at < 0) {
      at = static_cast<int>(bare.textures.size());
      bare.textures.push_back(scene.textures[static_cast<std::size_t>(triangle.texture)]);
    }
    triangle.texture = at;
  }
  return fails(bare) ? bare : scene;
}

void write_replay(const std::string& path, const Engines& engines, const Config& config, const Scene& scene,
                  std::uint64_t stall_seed, const std::string& found) {
  Replay replay;
  for (const auto& engine : engines) {
    replay.engines.emplace_back(engine->name());
  }
  replay.stall_seed = stall_seed;
  for (const std::string& name : replay.engines) {
    const EngineEntry& entry = find_engine(name);
    if (entry.design) replay.designs[name] = entry.design(config);
  }
  replay.config = config;
  replay.found = found;
  replay.scene = scene;
  write_file(path, replay_json(replay));
}

}  // namespace bitspan
