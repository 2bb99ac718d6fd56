// SPDX-License-Identifier: Apache-2.0
#include "lib/engines.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <system_error>

#include "io/data_folder.hpp"
#include "lib/plugin.hpp"
#include "lib/status.hpp"

namespace bitspan::capi {
namespace {

namespace fs = std::filesystem;

// lib/CMakeLists.txt makes one of each.
constexpr std::array<std::string_view, 2> plugin_names{"systemc", "rtl"};

fs::path plugin_file(std::string_view name) {
  const char* const named = std::getenv("BITSPAN_PLUGINS");
  const fs::path folder =
      named != nullptr && *named != '\0' ? fs::path(named) : own_file().parent_path() / "bitspan";
  return folder / ("libbitspan-" + std::string(name) + ".so");
}

[[noreturn]] void refuse(std::string_view name, const std::string& why) {
  fail(BS_UNSUPPORTED, "bs_open: engine: " + std::string(name) + ": " + why);
}

const Plugin& load(std::string_view name, const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    refuse(name, file.string() +
                     ": no such file; expected the plug-in in the folder that BITSPAN_PLUGINS names, "
                     "or in bitspan/ beside the library");
  }
  // Its names stay its own: it has a copy of what it shares with the library.
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse(name, std::string(::dlerror()) + "; expected a plug-in");
  void* const symbol = ::dlsym(library, plugin_symbol);
  if (symbol == nullptr) {
    ::dlclose(library);
    refuse(name, file.string() + ": has no " + plugin_symbol + "; expected a plug-in");
  }
  const Plugin* const plugin = reinterpret_cast<PluginFunction>(symbol)();
  if (std::string_view(plugin->build) != build_hash()) {
    const std::string other = plugin->build;
    ::dlclose(library);
    refuse(name, file.string() + ": is of build " + other + "; expected the library's, " + build_hash());
  }
  return *plugin;
}

}  // namespace

std::vector<std::string_view> engine_list() {
  std::vector<std::string_view> names = engine_names();
  for (const std::string_view name : plugin_names) {
    std::error_code ignored;
    if (fs::exists(plugin_file(name), ignored)) names.push_back(name);
  }
  return names;
}

const EngineEntry& engine_entry(std::string_view name) {
  const auto inside = engines();
  const auto own = std::ranges::find(inside, name, &EngineEntry::name);
  if (own != inside.end()) return *own;
  if (std::ranges::find(plugin_names, name) == plugin_names.end()) {
    std::string legal;
    for (const std::string_view one : engine_list()) legal.append(legal.empty() ? "" : ", ").append(one);
    fail(BS_BAD_INPUT, "bs_open: engine: '" + std::string(name) + "' is no engine; expected " + legal);
  }
  // Never destroyed: functions may be called while the program ends.
  static auto* const loaded = new std::map<fs::path, const Plugin*>;
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const fs::path file = plugin_file(name);
  const auto at = loaded->find(file);
  if (at != loaded->end()) return at->second->engine;
  const Plugin& plugin = load(name, file);
  loaded->emplace(file, &plugin);
  return plugin.engine;
}

}  // namespace bitspan::capi
