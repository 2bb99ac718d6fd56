// SPDX-License-Identifier: Apache-2.0
#include "io/data_folder.hpp"

#include <dlfcn.h>
#include <link.h>

#include <cstdlib>
#include <string>
#include <system_error>

#include "config/config.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

// Returns the path `below` one of the folders around a file, where `exists` holds; empty where there is none.
template <class Exists>
fs::path found_near(const fs::path& file, const char* below, const Exists& exists) {
  // lib/x86_64-linux-gnu/ and tests/rtl/ of a build tree stand one level below bin/.
  constexpr int levels = 3;
  fs::path folder = file.parent_path();
  // A plug-in stands one below the library.
  if (file.filename().string().starts_with("libbitspan-")) folder = folder.parent_path();
  for (int level = 0; level < levels; ++level, folder = folder.parent_path()) {
    fs::path found = folder / below;
    if (exists(found)) return found;
  }
  return {};
}

fs::path data_folder_near(const fs::path& file) {
  fs::path found = found_near(file, "share/bitspan", [](const fs::path& data) {
    std::error_code ignored;
    return fs::is_directory(data / "rtl", ignored);
  });
  if (!found.empty()) return found;
  throw InputError(file.string() + ": has no share/bitspan beside its folder; " + data_folder_hint);
}

}  // namespace

fs::path own_file() {
  Dl_info info{};
  link_map* object = nullptr;
  ::dladdr1(reinterpret_cast<void*>(&own_file), &info, reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP);
  // The dynamic linker does not name the program itself.
  const bool library = object != nullptr && *object->l_name != '\0';
  return fs::canonical(library ? object->l_name : "/proc/self/exe");
}

fs::path data_folder() {
  const char* const named = std::getenv("BITSPAN_ROOT");
  if (named != nullptr && *named != '\0') return named;
  static const fs::path found = data_folder_near(own_file());
  return found;
}

fs::path assimp_program() {
  const char* const named = std::getenv("BITSPAN_ASSIMP");
  if (named != nullptr && *named != '\0') return named;
  fs::path found = found_near(own_file(), "libexec/bitspan/bitspan-assimp", [](const fs::path& program) {
    std::error_code ignored;
    return fs::is_regular_file(program, ignored);
  });
  if (!found.empty()) return found;
  throw InputError("there is no libexec/bitspan/bitspan-assimp beside the folder of " + own_file().string() +
                   ", and BITSPAN_ASSIMP names none");
}

}  // namespace bitspan
