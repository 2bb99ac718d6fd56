// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/emit_curve_sv.hpp"
#include "engine/emit_light_sv.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "engine/emit_project_sv.hpp"
#include "engine/emit_rotate_sv.hpp"
#include "engine/emit_sv.hpp"
#include "engine/sv_names.hpp"
#include "tb/programs.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> package_texts(const Config& config, const RtlChoice& choice) {
  std::vector<std::string> texts;
  if (choice.interpolator) texts.push_back(emit_sv(config));
  if (choice.pixels) texts.push_back(emit_pixel_sv(config, choice.when));
  if (choice.project) texts.push_back(emit_project_sv(config));
  if (choice.light) texts.push_back(emit_light_sv(config));
  if (choice.curve) texts.push_back(emit_curve_sv(config));
  if (choice.rotate) texts.push_back(emit_rotate_sv(config));
  return texts;
}

// What the lists name, each source once; modules are read in any order.
std::vector<fs::path> sources_of(const RtlChoice& choice) {
  std::vector<fs::path> sources;
  const auto add = [&](const std::vector<fs::path>& more) {
    for (const fs::path& source : more) {
      if (std::ranges::find(sources, source) == sources.end()) sources.push_back(source);
    }
  };
  if (choice.interpolator) add(rtl_sources());
  if (choice.pixels) add(pixel_sources());
  if (choice.project) add(project_sources());
  if (choice.light) add(light_sources());
  if (choice.curve) add(curve_sources());
  if (choice.rotate) add(rotate_sources());
  return sources;
}

std::string prefixed(const std::string& text, const RtlChoice& choice, const SvNames& names) {
  return choice.prefix.empty() ? text : with_prefix(text, choice.prefix, names);
}

// The folder itself, past symbolic links.
fs::path folder_at(const std::string& path) {
  std::error_code error;
  fs::path folder = fs::weakly_canonical(fs::absolute(path, error), error);
  if (error) throw InputError(path + ": cannot write: " + error.message());
  if (!folder.has_filename()) folder = folder.parent_path();
  if (fs::exists(folder, error) && !(fs::is_directory(folder, error) && fs::is_empty(folder, error))) {
    throw InputError(path + ": is there already; expected a new or an empty folder");
  }
  return folder;
}

}  // namespace

std::string rtl_packages(const Config& config, const RtlChoice& choice) {
  std::string out;
  for (const std::string& text : package_texts(config, choice)) {
    out += prefixed(text, choice, declared_names(text));
  }
  return out;
}

int write_rtl_folder(const Config& config, const RtlChoice& choice, const std::string& path) {
  const fs::path folder = folder_at(path);
  // By the name in it.
  std::vector<std::pair<std::string, std::string>> files;
  SvNames names;
  const auto add = [&](const std::string& text) {
    SvNames own = declared_names(text);
    files.emplace_back(*(own.modules.empty() ? own.packages : own.modules).begin(), text);
    names.modules.merge(own.modules);
    names.packages.merge(own.packages);
  };
  for (const std::string& text : package_texts(config, choice)) add(text);
  for (const fs::path& source : sources_of(choice)) add(read_text(source));
  if (!choice.prefix.empty()) check_prefix(choice.prefix, names);

  const ScratchFolder made(folder.parent_path(), '.' + folder.filename().string(), "expected a folder");
  std::string list;
  for (const auto& [name, text] : files) {
    const std::string file = choice.prefix + name + ".sv";
    write_text(made / file, prefixed(text, choice, names));
    list += file + '\n';
  }
  write_text(made / (choice.prefix + "bitspan.f"), list);
  std::error_code error;
  fs::rename(made.path(), folder, error);
  if (error) throw InputError(path + ": cannot write: " + error.message());
  return static_cast<int>(files.size()) + 1;
}

}  // namespace bitspan
