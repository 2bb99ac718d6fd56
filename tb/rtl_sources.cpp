// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_sources.hpp"

#include <sstream>

#include "config/fnv.hpp"
#include "io/data_folder.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

// Below rtl/, in the order of reading.
std::vector<fs::path> listed_sources(const std::string& list_name) {
  const fs::path folder = data_folder() / "rtl";
  std::istringstream list(read_text(folder / list_name, data_folder_hint));
  std::vector<fs::path> sources;
  for (std::string name; std::getline(list, name);) {
    if (!name.empty()) sources.push_back(folder / name);
  }
  return sources;
}

}  // namespace

std::vector<fs::path> rtl_sources() { return listed_sources("span_interpolator.f"); }
std::vector<fs::path> pixel_sources() { return listed_sources("pixel_pipe.f"); }
std::vector<fs::path> project_sources() { return listed_sources("project.f"); }
std::vector<fs::path> light_sources() { return listed_sources("light.f"); }
std::vector<fs::path> curve_sources() { return listed_sources("forward_difference.f"); }
std::vector<fs::path> rotate_sources() { return listed_sources("rotate.f"); }

std::string rtl_sources_hash() {
  Fnv128 hash;
  for (const std::vector<fs::path>& sources : {rtl_sources(), pixel_sources()}) {
    for (const fs::path& source : sources) {
      hash.text(source.filename().string());
      hash.text(read_text(source, data_folder_hint));
    }
  }
  return hash.hex();
}

std::string without_comments(const std::string& package) {
  std::istringstream in(package);
  std::string kept;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("//")) kept += line + '\n';
  }
  return kept;
}

}  // namespace bitspan
