// SPDX-License-Identifier: Apache-2.0
// The engines by name. An engine's own folder makes it known (its registration.cpp); whoever links the
// folder's library can make the engine here, and includes nothing of it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
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

// How many values are an engine's own: fields per record of each type, values per pixel of the picture, and
// counters. The others it takes from the model, and so they cannot differ.
struct EngineOwn {
  std::array<std::uint64_t, record_types> fields{};
  std::uint64_t picture = 0, counters = 0;
};

// A design of the user's that breaks off: an assertion in it, or it stands still. The command line prints the
// text, and exits with 1.
struct DesignFault : std::logic_error {
  DesignFault(std::string_view name, const std::string& what) : std::logic_error(what), engine(name) {}
  std::string engine;
};

struct EngineEntry {
  std::string name;
  int order = 0;          // among the names: from the most trusted on
  bool compared = false;  // it delivers records and pictures that equal the others'; ideal's do not
  // Whether the engine runs this configuration.
  std::function<bool(const Config&)> runs;
  // What configurations it needs, for messages; empty where it runs all.
  std::string needs{};
  // Throws InputError where an option that it reads has a value that it does not know; null: it cannot have.
  void (*check)(const EngineOptions&) = nullptr;
  // Throws InputError as check does, and where the configuration is not one of the engine's.
  std::function<std::unique_ptr<Engine>(const Config&, const EngineOptions&)> make;
  // What it computes itself; null: everything.
  std::function<EngineOwn(const Config&, const Scene&)> own{};
  // Of an engine that runs RTL: a hash over its sources, which says what is under test. Null for the others.
  std::function<std::string(const Config&)> design{};
  // A design of the user's: nobody's clocks are compared with its own.
  bool users_design = false;
  // Whether it draws bands of a picture: it is a BandEngine (engine/bands.hpp).
  bool has_bands = false;
  // The one configuration that it is for; null: whatever `runs` says.
  std::shared_ptr<const Config> only{};
};

// An object of this type at namespace scope makes an engine known before main(). Throws std::logic_error
// where the name is known already.
struct RegisterEngine {
  explicit RegisterEngine(const EngineEntry& entry);
};

// Engines whose names begin alike and are known only when they are asked for.
struct EngineFamily {
  std::string_view prefix;  // "dut:"
  std::string_view names;   // for messages: "dut:NAME"
  // Makes the entry of a name with the prefix; throws InputError where there is none.
  EngineEntry (*resolve)(std::string_view name) = nullptr;
};
struct RegisterEngineFamily {
  explicit RegisterEngineFamily(const EngineFamily& family);
};

// Those linked into this program, in their order; none of a family.
std::span<const EngineEntry> engines();
std::vector<std::string_view> engine_names();
// The engine that errors are measured from: the one that is not compared. Throws std::logic_error where none
// is linked.
std::string_view truth_name();
// Throws InputError with the names that are known. An engine of a family is resolved once, and stays as it
// was then.
const EngineEntry& find_engine(std::string_view name);

// "golden,model" -> names, each known and named once. Throws InputError, which names --engines, otherwise.
std::vector<std::string> parse_engines(const std::string& list);
bool engine_runs(std::string_view name, const Config& config);
// "rtl needs reciprocal.pixel.pipelined = true in delta_f", for an engine that does not run a configuration.
std::string engine_needs(std::string_view name, const Config& config);
std::unique_ptr<Engine> make_engine(std::string_view name, const Config& config,
                                    const EngineOptions& options = {});

}  // namespace bitspan
