// SPDX-License-Identifier: Apache-2.0
// The options that say how the engine `model` computes: --form, --target, --threads.
#pragma once

#include <optional>
#include <string>

#include "engine/registry.hpp"

namespace CLI {
class App;
}

namespace bitspan {

// As typed; empty or none: the command's default.
struct ModelFlags {
  std::string form, target;
  std::optional<int> threads;
  bool given() const { return !form.empty() || !target.empty() || threads.has_value(); }
};

inline constexpr int threads_limit = 1024;

// default_threads: what the help says of --threads.
void add_model_options(CLI::App& command, ModelFlags& flags, const std::string& default_threads);

// Throws InputError, naming the flag, where a name is unknown, the processor lacks the target, or the number
// of threads is none. threads: where --threads is not given; 0, there and as a flag: one for each processor.
EngineOptions engine_options(const ModelFlags& flags, int threads);

// Throws InputError naming a flag given, where model is not among the engines.
void refuse_without_model(const ModelFlags& flags, bool model_takes_part);

// The flags as they would be typed, each with a space in front; for commands that reproduce.
std::string flags_text(const ModelFlags& flags);

}  // namespace bitspan
