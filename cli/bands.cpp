// SPDX-License-Identifier: Apache-2.0
#include "cli/bands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "engine/bands.hpp"
#include "engine/registry.hpp"
#include "scene/picture_size.hpp"

namespace bitspan {

std::vector<int> parse_bands(const std::string& list) {
  std::vector<int> out;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t end = std::min(list.find(',', from), list.size());
    int rows = 0;
    const auto [behind, error] = std::from_chars(list.data() + from, list.data() + end, rows);
    const bool is_number = error == std::errc() && behind == list.data() + end;
    if (!is_number || rows < 1 || rows > picture_size_limit) {
      throw InputError(
          fmt::format("--bands: '{}' is no height of bands; expected rows, 1 to {}, as 16 or 480,16,1",
                      list.substr(from, end - from), picture_size_limit));
    }
    if (std::ranges::find(out, rows) != out.end()) {
      throw InputError(fmt::format("--bands: {} is given twice", rows));
    }
    out.push_back(rows);
    from = end + 1;
  }
  return out;
}

void check_bands(int rows, const Scene& scene) {
  const BandedPlan plan = banded_plan(scene);
  if (rows > plan.height) {
    throw InputError(fmt::format("--bands: {} rows are more than the picture's; expected 1 to {} for {}",
                                 rows, plan.height, scene.name));
  }
}

void check_band_engine(const std::string& engine) {
  if (find_engine(engine).has_bands) return;
  throw InputError(
      fmt::format("--bands: the engine {} draws whole pictures; expected golden or model", engine));
}

}  // namespace bitspan
