// SPDX-License-Identifier: Apache-2.0
// bs_check: the caller's records against the model's.
#include <algorithm>
#include <span>

#include "lib/model.hpp"
#include "lib/stages.hpp"
#include "report/describe.hpp"

namespace bitspan::capi {
namespace {

std::int64_t named(RecordType type, std::span<const std::int64_t> record,
                   std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    const int at = field_index(type, name);
    if (at >= 0) return record[static_cast<std::size_t>(at)];
  }
  return -1;
}

bs_divergence divergence_at(const ModelState& model, RecordType type, std::uint64_t record,
                            std::span<const std::int64_t> values) {
  bs_divergence d{};
  d.stage = static_cast<bs_stage>(std::ranges::find(stage_types, type) - stage_types.begin());
  d.record = record;
  d.triangle = named(type, values, {"triangle"});
  d.x = named(type, values, {"x", "x_first"});
  d.y = named(type, values, {"y"});
  d.field = -1;
  const auto after = std::ranges::upper_bound(model.numbers, d.triangle, {}, &DrawNumbers::first);
  if (d.triangle >= 0 && d.triangle < model.triangles && after != model.numbers.begin()) {
    d.frame = std::prev(after)->frame;
    d.draw = std::prev(after)->draw;
  }
  return d;
}

}  // namespace

bool check_records(ModelState& model, RecordType type, const std::int64_t* dut, std::size_t n,
                   bs_divergence& first) {
  const RecordView view = view_of(model.trace, type);
  const std::size_t columns = view.fields.size();
  CheckState& state = model.checks[static_cast<std::size_t>(type)];
  state.previous.resize(columns);
  std::uint64_t differences = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::span<const std::int64_t> actual(dut + i * columns, columns);
    const std::uint64_t at = state.checked - state.forgotten;
    if (at >= view.records) {
      if (differences == 0) {
        first = divergence_at(model, type, state.checked, actual);
        first.kind = BS_DIVERGENCE_EXTRA;
      }
      differences += (n - i) * columns;
      break;
    }
    const auto expected = view.record(static_cast<std::size_t>(at));
    for (std::size_t f = 0; f < columns; ++f) {
      if (actual[f] == expected[f]) {
        ++model.matched;
        if (expected[f] != 0 && expected[f] != state.previous[f]) ++model.nontrivial;
      } else if (differences++ == 0) {
        const Field& field = view.fields[f];
        first = divergence_at(model, type, state.checked, expected);
        first.kind = BS_DIVERGENCE_VALUE;
        first.field = static_cast<std::int32_t>(f);
        first.field_name = field.name.data();
        first.expected = expected[f];
        first.actual = actual[f];
        const std::int64_t channel = channel_of(type, expected);
        first.expected_value = decode(expected[f], field, model.config, channel);
        first.actual_value = decode(actual[f], field, model.config, channel);
      }
    }
    std::ranges::copy(expected, state.previous.begin());
    ++state.checked;
  }
  first.differences = differences;
  return differences == 0;
}

std::string text_of(const bs_divergence& d, const ModelState& model) {
  const RecordType type = stage_types[static_cast<std::size_t>(d.stage)];
  std::string out = "bs_check: " + std::string(stage_of(type)) + ": record " + std::to_string(d.record);
  if (d.triangle >= 0) out += ", triangle " + std::to_string(d.triangle);
  if (d.x >= 0) out += ", pixel " + std::to_string(d.x) + " " + std::to_string(d.y);
  if (d.kind == BS_DIVERGENCE_EXTRA) return out + ": the model has no such record; expected no more records";
  const Field& field = fields_of(type)[static_cast<std::size_t>(d.field)];
  const auto value = [&](std::int64_t raw) {
    return std::to_string(raw) + " (" + hex_of(raw, field, model.config) + ")";
  };
  out += ": " + std::string(field.name) + ": " + value(d.actual) + "; expected " + value(d.expected);
  return out + ", " + std::to_string(d.differences) + " values differ";
}

}  // namespace bitspan::capi
