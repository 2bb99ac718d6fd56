// SPDX-License-Identifier: Apache-2.0
// The engines by name. An engine's own folder makes it known (its registration.cpp); whoever links the
// folder's library can make the engine here, and includes nothing of it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/engine.hpp"

namespace bitspan {

// What may be asked of an engine beside its configuration. An engine reads what concerns it; no value of
// these changes a record.
struct EngineOptions {
  std::uint64_t stall_seed = 1;  // rtl: of the random stalls at its input and output
  // model: how it computes; model/engine_model.hpp says what the names mean. Empty: the engine's choice.
  std::string form, target;
  int threads = 1;
  // model: keep u, v and the triangle of the fragment that won. Without them these planes are empty.
  bool winners = true;
};

struct EngineEntry {
  std::string_view name;
  int order = 0;          // among the names: from the most trusted on
  bool compared = false;  // it delivers records and pictures that equal the others'; ideal's do not
  // Whether the engine runs this configuration.
  bool (*runs)(const Config&) = nullptr;
  // What configurations it needs, for messages; empty where it runs all.
  std::string_view needs{};
  // Throws InputError where an option that it reads has a value that it does not know; null: it cannot have.
  void (*check)(const EngineOptions&) = nullptr;
  // Throws InputError as check does, and where the configuration is not one of the engine's.
  std::unique_ptr<Engine> (*make)(const Config&, const EngineOptions&) = nullptr;
};

// An object of this type at namespace scope makes an engine known before main(). Throws std::logic_error
// where the name is known already.
struct RegisterEngine {
  explicit RegisterEngine(const EngineEntry& entry);
};

// Those linked into this program, in their order.
std::span<const EngineEntry> engines();
std::vector<std::string_view> engine_names();
// Throws InputError with the names that are known.
const EngineEntry& find_engine(std::string_view name);

// "golden,model" -> names, each known and named once. Throws InputError, which names --engines, otherwise.
std::vector<std::string> parse_engines(const std::string& list);
bool engine_runs(std::string_view name, const Config& config);
// "rtl needs reciprocal.pixel.pipelined = true in delta_f", for an engine that does not run a configuration.
std::string engine_needs(std::string_view name);
std::unique_ptr<Engine> make_engine(std::string_view name, const Config& config,
                                    const EngineOptions& options = {});

}  // namespace bitspan
