// SPDX-License-Identifier: Apache-2.0
#include "study/metrics.hpp"

#include <fmt/format.h>

#include <array>
#include <map>

#include "model/numeric/register.hpp"
#include "study/family.hpp"

namespace bitspan {
namespace {

// FAMILY in a name stands for each of family_names, and REGISTER for each register of the model.
struct MetricRow {
  std::string_view name, unit, meaning;
  Better better = Better::low;
  MetricRole role = MetricRole::result;
};

constexpr auto other_metrics = std::to_array<MetricRow>({
    {"registers.wraps", "values", "values that wrapped, over all registers"},
    {"registers.saturations", "values", "values that saturated, over all registers"},
    {"registers.overflows", "values", "values that wrapped or saturated, over all registers"},
    {"register.REGISTER.used_bits", "bits", "integer bits that the values need, the sign included",
     Better::low, MetricRole::detail},
    {"register.REGISTER.headroom", "bits", "integer bits of the format beyond those", Better::high,
     MetricRole::detail},
    {"register.REGISTER.wraps", "values", "values that wrapped", Better::low, MetricRole::detail},
    {"register.REGISTER.saturations", "values", "values that saturated", Better::low, MetricRole::detail},
    {"shadow.unexplained", "pixels",
     "in pictures with a shadow map: lit where a ray from the light says dark, or the other way"},
    {"shadow.edges", "pixels",
     "there at a shadow's edge, or as near to what shades them as registers tell: left open", Better::low,
     MetricRole::detail},
    {"shadow.judged", "pixels", "there, that rays judge", Better::high, MetricRole::detail},
    {"curve.error_max", "steps",
     "of the curves of a scene of patches: how far a point is from the cubic, in steps of the control "
     "points' "
     "grid"},
    {"curve.error_bound", "steps", "there, the proved bound of that", Better::low, MetricRole::detail},
    {"curve.missed_ends", "curves", "there, that do not end on their last control point"},
    {"curve.inexact", "curves", "there, of which some point is not the cubic's"},
    {"curve.curves", "curves", "there, each coordinate by itself", Better::high, MetricRole::detail},
    {"curve.register_bits", "bits", "of `curve.d0` to `curve.d3`, which no other cost counts", Better::low,
     MetricRole::cost},
    {"timing.pixel_unit", "clocks", "latency of the RTL's reciprocal unit per pixel"},
    {"timing.row_unit", "clocks", "latency of the RTL's reciprocal unit per row"},
    {"timing.span", "clocks", "latency of the RTL's span stage"},
    {"cost.register_bits", "bits", "bits of all registers", Better::low, MetricRole::cost},
    {"cost.product_bits", "bit × bit", "products of both operands' widths, over all multipliers", Better::low,
     MetricRole::cost},
    {"cost.table_bits", "bits", "bits of all tables", Better::low, MetricRole::cost},
    {"memory.depth_bits", "bits", "depth buffer of the largest picture", Better::low, MetricRole::cost},
    {"memory.stencil_bits", "bits", "its stencil plane, where a scene tests it", Better::low,
     MetricRole::cost},
    {"memory.color_bits", "bits", "its colours in `target.format`", Better::low, MetricRole::cost},
    {"memory.cache_bits", "bits", "data of the caches of texels, depth and colour", Better::low,
     MetricRole::cost},
    {"memory.texels_per_pixel", "texels", "that a textured pixel reads at most", Better::low,
     MetricRole::cost},
    {"area.FAMILY.luts", "LUTs",
     "synthesised, of a search's points on which the constraints without areas hold", Better::low,
     MetricRole::cost},
    {"area.FAMILY.ffs", "flip-flops", "synthesised", Better::low, MetricRole::cost},
    {"area.FAMILY.multipliers", "multipliers", "synthesised", Better::low, MetricRole::cost},
    {"area.FAMILY.memory_bits", "bits", "synthesised", Better::low, MetricRole::cost},
    {"area.FAMILY.fmax_mhz", "MHz", "clock rate after placing and routing", Better::high, MetricRole::cost},
    {"area.FAMILY.PART_luts", "LUTs",
     "synthesised, of the pixel stages: PART is pixel, or late_pixel with the depth test behind texture",
     Better::low, MetricRole::cost},
    {"area.FAMILY.PART_ffs", "flip-flops", "synthesised, of the pixel stages", Better::low, MetricRole::cost},
    {"area.FAMILY.PART_multipliers", "multipliers", "synthesised, of the pixel stages", Better::low,
     MetricRole::cost},
    {"area.FAMILY.PART_memory_bits", "bits", "synthesised, of the pixel stages", Better::low,
     MetricRole::cost},
    {"estimate.FAMILY.luts", "LUTs", "by the fitted estimate, where the mode has RTL", Better::low,
     MetricRole::cost},
    {"estimate.FAMILY.luts_error", "LUTs",
     "the ± of `estimate.FAMILY.luts`: it held for at least 68 % of the fitted runs, each left out of its "
     "fit",
     Better::low, MetricRole::cost},
    {"estimate.FAMILY.ffs", "flip-flops", "by the fitted estimate", Better::low, MetricRole::cost},
    {"estimate.FAMILY.ffs_error", "flip-flops", "the ± of `estimate.FAMILY.ffs`", Better::low,
     MetricRole::cost},
    {"estimate.FAMILY.multipliers", "multipliers", "by the fitted estimate", Better::low, MetricRole::cost},
    {"estimate.FAMILY.PART_luts", "LUTs",
     "by the fitted estimate, of the pixel stages, where the RTL has all of the configuration's", Better::low,
     MetricRole::cost},
    {"estimate.FAMILY.PART_luts_error", "LUTs", "the ± of `estimate.FAMILY.PART_luts`", Better::low,
     MetricRole::cost},
    {"estimate.FAMILY.PART_ffs", "flip-flops", "by the fitted estimate, of the pixel stages", Better::low,
     MetricRole::cost},
    {"estimate.FAMILY.PART_ffs_error", "flip-flops", "the ± of `estimate.FAMILY.PART_ffs`", Better::low,
     MetricRole::cost},
    {"estimate.FAMILY.PART_multipliers", "multipliers", "by the fitted estimate, of the pixel stages",
     Better::low, MetricRole::cost},
});

std::vector<std::string> values_of(std::string_view placeholder) {
  std::vector<std::string> out;
  if (placeholder == "FAMILY") {
    out.assign(family_names.begin(), family_names.end());
  } else if (placeholder == "PART_") {
    for (const AreaPart part : {AreaPart::pixels, AreaPart::late_pixels}) out.emplace_back(prefix_of(part));
  } else {
    for (int i = 0; i < model::register_count; ++i)
      out.emplace_back(name_of(static_cast<model::RegisterId>(i)));
  }
  return out;
}

void add_field_metrics(const FieldQuantity& q, std::vector<Metric>& out) {
  const std::string field = fmt::format("{}.{}", q.stage, q.quantity);
  for (const FieldStatistic& s : field_statistics()) {
    const std::string name = fmt::format("{}.{}", field, s.name);
    const std::string unit(s.unit.empty() ? q.unit : s.unit);
    out.push_back({name, field, std::string(s.label), unit, std::string(s.meaning), s.better,
                   MetricRole::result, s.squares_add});
    if (s.unit.empty()) {
      out.push_back({name + "_ulp", field, std::string(s.ulp_label), "ULP", std::string(s.meaning), s.better,
                     MetricRole::detail, s.squares_add});
    }
  }
}

std::vector<Metric> all_metrics() {
  std::vector<Metric> out;
  for (const FieldQuantity& q : field_quantities()) add_field_metrics(q, out);
  for (const PictureMetric& p : picture_metrics()) {
    out.push_back({std::string(p.name), "", "", std::string(p.unit), std::string(p.meaning), p.better});
  }
  const auto add = [&](const MetricRow& row, std::string name) {
    out.push_back(
        {std::move(name), "", "", std::string(row.unit), std::string(row.meaning), row.better, row.role});
  };
  for (const MetricRow& row : other_metrics) {
    std::vector<std::string> names = {std::string(row.name)};
    for (const std::string_view placeholder : {"FAMILY", "PART_", "REGISTER"}) {
      const auto at = names.front().find(placeholder);
      if (at == std::string::npos) continue;
      std::vector<std::string> expanded;
      for (const std::string& value : values_of(placeholder)) {
        for (const std::string& name : names) {
          expanded.push_back(name);
          expanded.back().replace(expanded.back().find(placeholder), placeholder.size(), value);
        }
      }
      names = std::move(expanded);
    }
    for (std::string& name : names) add(row, std::move(name));
  }
  return out;
}

}  // namespace

std::string_view to_string(MetricRole role) {
  switch (role) {
    case MetricRole::result:
      return "result";
    case MetricRole::cost:
      return "cost";
    case MetricRole::detail:
      return "detail";
  }
  return "?";
}

std::string_view to_string(Better better) { return better == Better::high ? "high" : "low"; }

const std::vector<Metric>& known_metrics() {
  static const std::vector<Metric> metrics = all_metrics();
  return metrics;
}

const Metric* find_metric(std::string_view name) {
  static const auto by_name = [] {
    std::map<std::string_view, const Metric*> out;
    for (const Metric& metric : known_metrics()) out.emplace(metric.name, &metric);
    return out;
  }();
  const auto found = by_name.find(name);
  return found == by_name.end() ? nullptr : found->second;
}

namespace {
constexpr std::string_view error_ending = "_error";
}  // namespace

std::string plus_minus_of(std::string_view metric) { return fmt::format("{}{}", metric, error_ending); }
bool is_plus_minus(std::string_view metric) { return metric.ends_with(error_ending); }

std::vector<StatisticColumn> statistic_columns() {
  std::vector<StatisticColumn> out;
  for (const FieldStatistic& s : field_statistics()) {
    out.push_back({std::string(s.label), std::string(s.name)});
    if (!s.ulp_label.empty()) out.push_back({std::string(s.ulp_label), std::string(s.name) + "_ulp"});
  }
  return out;
}

std::string metrics_markdown() {
  std::string out = "| metric | unit | better | meaning |\n|---|---|---|---|\n";
  const auto line = [&out](const std::string& name, std::string_view unit, Better better,
                           std::string_view meaning) {
    out += fmt::format("| `{}` | {} | {} | {} |\n", name, unit, to_string(better), meaning);
  };
  for (const FieldStatistic& s : field_statistics()) {
    const std::string name = fmt::format("STAGE.QUANTITY.{}", s.name);
    line(name + (s.unit.empty() ? "`, `..._ulp" : ""), s.unit.empty() ? "the quantity's, or ULP" : s.unit,
         s.better, s.meaning);
  }
  for (const PictureMetric& p : picture_metrics()) line(std::string(p.name), p.unit, p.better, p.meaning);
  for (const MetricRow& row : other_metrics) line(std::string(row.name), row.unit, row.better, row.meaning);
  return out;
}

}  // namespace bitspan
