// SPDX-License-Identifier: Apache-2.0
#include "engine/registry.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>

namespace bitspan {
namespace {

std::vector<EngineEntry>& entries() {
  static std::vector<EngineEntry> list;  // filled before main()
  return list;
}

std::vector<EngineFamily>& families() {
  static std::vector<EngineFamily> list;  // filled before main()
  return list;
}

const EngineEntry& resolved(const EngineFamily& family, std::string_view name) {
  static std::mutex mutex;
  static std::map<std::string, EngineEntry, std::less<>> known;
  const std::lock_guard lock(mutex);
  const auto at = known.find(name);
  return at != known.end() ? at->second : known.emplace(name, family.resolve(name)).first->second;
}

}  // namespace

RegisterEngine::RegisterEngine(const EngineEntry& entry) {
  auto& list = entries();
  if (std::ranges::find(list, entry.name, &EngineEntry::name) != list.end()) {
    throw std::logic_error("two engines are named '" + entry.name + "'");
  }
  list.insert(std::ranges::upper_bound(list, entry.order, {}, &EngineEntry::order), entry);
}

RegisterEngineFamily::RegisterEngineFamily(const EngineFamily& family) { families().push_back(family); }

std::span<const EngineEntry> engines() { return entries(); }

std::vector<std::string_view> engine_names() {
  std::vector<std::string_view> names;
  for (const EngineEntry& entry : entries()) names.push_back(entry.name);
  return names;
}

std::string_view truth_name() {
  const auto at = std::ranges::find(entries(), false, &EngineEntry::compared);
  if (at == entries().end()) throw std::logic_error("no engine is the truth");
  return at->name;
}

const EngineEntry& find_engine(std::string_view name) {
  const auto at = std::ranges::find(entries(), name, &EngineEntry::name);
  if (at != entries().end()) return *at;
  for (const EngineFamily& family : families()) {
    if (name.starts_with(family.prefix)) return resolved(family, name);
  }
  std::string legal;
  for (const EngineEntry& entry : entries()) {
    legal += (legal.empty() ? "" : ", ") + entry.name;
  }
  for (const EngineFamily& family : families()) legal.append(", ").append(family.names);
  throw InputError("--engines: '" + std::string(name) + "' is no engine; legal: " + legal);
}

std::vector<std::string> parse_engines(const std::string& list) {
  std::vector<std::string> out;
  std::size_t from = 0;
  while (true) {
    const std::size_t comma = list.find(',', from);
    const std::string name = list.substr(from, comma == std::string::npos ? comma : comma - from);
    static_cast<void>(find_engine(name));
    if (std::ranges::find(out, name) != out.end()) {
      throw InputError("--engines: '" + name + "' is named twice");
    }
    out.push_back(name);
    if (comma == std::string::npos) return out;
    from = comma + 1;
  }
}

bool engine_runs(std::string_view name, const Config& config) { return find_engine(name).runs(config); }

std::string engine_needs(std::string_view name, const Config& config) {
  const EngineEntry& entry = find_engine(name);
  if (entry.only != nullptr && config_hash(*entry.only) != config_hash(config)) {
    const auto text = [](const Config& c) { return c.name + " (" + config_hash(c) + ")"; };
    return entry.name + " is for configuration " + text(*entry.only) + ", not for " + text(config);
  }
  return entry.name + " needs " + entry.needs;
}

std::unique_ptr<Engine> make_engine(std::string_view name, const Config& config,
                                    const EngineOptions& options) {
  return find_engine(name).make(config, options);
}

}  // namespace bitspan
