// SPDX-License-Identifier: Apache-2.0
#include "tb/dut_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include "config/store.hpp"
#include "config/toml_section.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view folder_hint = "BITSPAN_DUTS names the folder of designs";
// Of a design's folder.
constexpr std::string_view map_file = "map.toml", design_file = "dut.toml", config_file = "config.toml",
                           wrapper_file = "wrapper.sv";

void check_name(const std::string& name) {
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  const bool good = !name.empty() && name.size() <= 64 && letter(name.front()) &&
                    std::ranges::all_of(name, [&](char c) { return letter(c) || c == '_' || c == '-'; });
  if (!good) {
    throw InputError(
        fmt::format("dut: \"{}\" is no name of a design; legal: at most 64 letters, digits, _ and -, a "
                    "letter or a digit first",
                    name));
  }
}

fs::path whole_path(const fs::path& path) { return fs::absolute(path).lexically_normal(); }

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", c);
    } else {
      out += c;
    }
  }
  return out + '"';
}

fs::path folder_of(const std::string& name) {
  check_name(name);
  fs::path folder = duts_folder() / name;
  std::error_code ignored;
  if (fs::is_directory(folder, ignored)) return folder;
  std::string known;
  for (const std::string& other : dut_names()) known += (known.empty() ? "" : ", ") + other;
  throw InputError(fmt::format("dut:{}: no design of this name in {}; {}", name, duts_folder().string(),
                               known.empty() ? "`bitspan dut add MAP.toml` makes one" : "there: " + known));
}

}  // namespace

StoredDut read_dut(const DutRequest& request) {
  StoredDut out;
  DutDesign& design = out.design;
  design.map = parse_dut_map(read_toml_file(request.map, "map"), request.map);
  DutMap& map = design.map;
  if (!request.top.empty()) map.top = request.top;
  design.name = request.name.empty() ? fs::path(request.map).stem().string() : request.name;
  check_name(design.name);
  const fs::path folder = whole_path(request.map).parent_path();
  const bool given = !request.sources.empty();
  for (const std::string& source : given ? request.sources : map.sources) {
    design.sources.push_back(given ? whole_path(source) : (folder / source).lexically_normal());
  }
  if (!request.config.empty()) {
    out.config = find_config(request.config);
  } else if (!map.config.empty()) {
    const auto shipped = config_texts();
    const bool known = std::ranges::count(shipped, map.config, &ShippedConfig::name) != 0;
    const fs::path file = folder / map.config;
    std::error_code ignored;
    if (!known && !fs::exists(file, ignored)) {
      throw InputError(fmt::format("{}:{}: config: {}: no such configuration file; shipped names: {}",
                                   map.origin, map.config_line, file.string(), names_of_shipped()));
    }
    out.config = find_config(known ? map.config : file.string());
  }
  if (out.config) {
    if (const std::string text = refusal(map, *out.config); !text.empty()) {
      throw InputError(
          fmt::format("{}:{}: config: {}: {}", map.origin, map.config_line, out.config->name, text));
    }
  }
  return out;
}

fs::path duts_folder() {
  if (const std::string named = environment("BITSPAN_DUTS"); !named.empty()) return fs::absolute(named);
  if (const std::string data = environment("XDG_DATA_HOME"); !data.empty())
    return fs::path(data) / "bitspan/duts";
  if (const std::string home = environment("HOME"); !home.empty())
    return fs::path(home) / ".local/share/bitspan/duts";
  throw InputError(fmt::format("no folder for designs; {}", folder_hint));
}

void store_dut(const StoredDut& dut, const DutRequest& request, const std::string& wrapper, bool replace) {
  const std::string& name = dut.design.name;
  const fs::path parent = duts_folder();
  const fs::path folder = parent / name;
  const ScratchFolder made(parent, ".new", folder_hint);
  std::string text = fmt::format("# Written by `bitspan dut add`.\nmap = {}\ntop = {}\n",
                                 quoted(whole_path(request.map).string()), quoted(dut.design.map.top));
  text += "sources = [";
  for (const fs::path& source : dut.design.sources) {
    text += fmt::format("{}{}", text.ends_with('[') ? "" : ", ", quoted(source.string()));
  }
  text += "]\n";
  if (dut.config) {
    text += fmt::format("config_name = {}\n", quoted(dut.config->name));
    write_text(made / config_file, to_toml(*dut.config), folder_hint);
  }
  write_text(made / design_file, text, folder_hint);
  write_text(made / map_file, read_toml_file(request.map, "map"), folder_hint);
  write_text(made / wrapper_file, wrapper, folder_hint);
  // A folder with files in it is never replaced by a rename: of two additions at a time one is refused.
  if (::renameat2(AT_FDCWD, made.path().c_str(), AT_FDCWD, folder.c_str(), RENAME_NOREPLACE) == 0) return;
  int error = errno;
  if (error == EEXIST && replace) {
    // The old one goes with the scratch folder.
    if (::renameat2(AT_FDCWD, made.path().c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) return;
    error = errno;
  }
  if (error == EEXIST) {
    throw InputError(
        fmt::format("dut:{}: is there already; expected another --name, --replace, or `bitspan "
                    "dut remove {}`",
                    name, name));
  }
  throw InputError(
      fmt::format("{}: cannot be written ({}); {}", folder.string(), std::strerror(error), folder_hint));
}

StoredDut load_dut(const std::string& name) {
  const fs::path folder = folder_of(name);
  const std::string origin = (folder / design_file).string();
  const std::string text = read_toml_file(origin, "design");
  const toml::table table = parse_toml(text, origin, "is empty; `bitspan dut add` writes it");
  const Section root(table, "", 1, origin, {"map", "top", "sources", "config_name"});
  StoredDut out;
  out.design.name = name;
  const std::string map = root.text("map", "the file of the map");
  out.design.map = parse_dut_map(read_toml_file((folder / map_file).string(), "map"), map);
  out.design.map.top = root.text("top", "the name of a module");
  for (const std::string& source : root.texts("sources", "names of files"))
    out.design.sources.emplace_back(source);
  if (root.has("config_name")) {
    out.config = load_config((folder / config_file).string());
    out.config->name = root.text("config_name", "a name");
  }
  return out;
}

std::string stored_wrapper(const std::string& name) { return read_text(folder_of(name) / wrapper_file); }

void remove_dut(const std::string& name) {
  const fs::path folder = folder_of(name);
  // Out of sight at once, whatever becomes of its files.
  const ScratchFolder gone(duts_folder(), ".old", folder_hint);
  std::error_code error;
  fs::rename(folder, gone / name, error);
  if (error) {
    throw InputError(
        fmt::format("{}: cannot be removed ({}); {}", folder.string(), error.message(), folder_hint));
  }
}

std::vector<std::string> dut_names() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(duts_folder(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') && entry.is_directory(ignored)) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace bitspan
