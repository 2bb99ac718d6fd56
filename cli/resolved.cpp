// SPDX-License-Identifier: Apache-2.0
#include "cli/resolved.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "engine/registry.hpp"
#include "golden/resolve_samples.hpp"
#include "model/stages/resolve_samples.hpp"

namespace bitspan {

std::vector<std::uint8_t> resolved_picture(const Engine& engine, const Config& config, int k) {
  return resolved_picture(engine.name(), engine.frame(), config, k);
}

std::vector<std::uint8_t> resolved_picture(std::string_view engine, const Frame& frame, const Config& config,
                                           int k) {
  const int width = frame.width / k;
  const int height = frame.height / k;
  if (!find_engine(engine).compared) {
    const Format nearest{8, 8, false, Rounding::rnd, Overflow::sat, false};
    return golden::resolve_samples(frame.color, width, height, k, nearest);
  }
  const Format& format = config.format(FormatId::merge_color);
  if (engine == "golden") return golden::resolve_samples(frame.color, width, height, k, format);
  return model::resolve_samples(frame.color, width, height, k, format);
}

double resolved_psnr_db(const Engine& engine, const Engine& ideal, const Config& config, int k) {
  const std::vector<std::uint8_t> a = resolved_picture(engine, config, k);
  const std::vector<std::uint8_t> b = resolved_picture(ideal, config, k);
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i % 4 != 3) squares += (a[i] - b[i]) * (a[i] - b[i]);
  }
  const double values = static_cast<double>(a.size()) * 3 / 4;
  return squares == 0 ? std::numeric_limits<double>::infinity()
                      : 10 * std::log10(255.0 * 255.0 * values / squares);
}

ResolvedComparison compare_resolved(const Engine& reference, const Engine& other, const Config& config,
                                    int k) {
  const std::vector<std::uint8_t> a = resolved_picture(reference, config, k);
  const std::vector<std::uint8_t> b = resolved_picture(other, config, k);
  const auto width = static_cast<std::size_t>(reference.frame().width / k);
  ResolvedComparison out;
  out.count.records = a.size() / 4;
  out.count.values = a.size();
  if (other.name() == "golden" || other.name() == "model") out.own = out.count.values;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != 0 && (i < 4 || a[i] != a[i - 4])) ++out.count.non_trivial;
    if (a[i] == b[i]) continue;
    ++out.count.differences;
    if (!out.first.empty()) continue;
    out.first = fmt::format("pixel ({}, {}), stage resolve_samples, {}: {} against {}", i / 4 % width,
                            i / 4 / width, "rgba"[i % 4], a[i], b[i]);
  }
  return out;
}

}  // namespace bitspan
