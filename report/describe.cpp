// SPDX-License-Identifier: Apache-2.0
#include "report/describe.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace bitspan {

double decode(std::int64_t raw, const Field& field, const Config& config, std::int64_t channel) {
  const auto format = format_of(field, config, channel);
  return format ? std::ldexp(static_cast<double>(raw), -format->fraction()) : static_cast<double>(raw);
}

std::string hex_of(std::int64_t raw, const Field& field, const Config& config, std::int64_t channel) {
  const auto format = format_of(field, config, channel);
  const int word = format ? format->word : 64;
  auto bits = static_cast<std::uint64_t>(raw);
  if (word < 64) {
    bits &= (std::uint64_t{1} << word) - 1;
  }
  return format ? fmt::format("0x{:0{}x}", bits, (word + 3) / 4) : fmt::format("{:#x}", bits);
}

std::string_view unit_of(const Field& field, const Config& config, std::int64_t channel) {
  if (const auto id = register_of(field, config, channel)) return unit_of(*id);
  switch (field.kind) {
    case FieldKind::coordinate:
    case FieldKind::phase:
      return "pixel";
    case FieldKind::depth_code:
      return "depth code";
    case FieldKind::edge_mantissa:
    case FieldKind::row_mantissa:
    case FieldKind::pixel_mantissa:
      return "1/operand, times 2^e";
    default:  // an integer
      return "";
  }
}

std::string describe_record(const RecordCopy& record, const Config& config, int indent) {
  std::string out;
  const auto all = fields_of(record.type);
  const std::int64_t channel = channel_of(record.type, record.values);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::int64_t raw = record.values[i];
    out += fmt::format("{:{}}{:<12} ", "", indent, all[i].name);
    if (all[i].kind == FieldKind::integer) {
      out += fmt::format("{}\n", raw);
    } else {
      out += fmt::format("{} = {:.10g} {}\n", hex_of(raw, all[i], config, channel),
                         decode(raw, all[i], config, channel), unit_of(all[i], config, channel));
    }
  }
  return out;
}

namespace {

std::string place_of(const Divergence& d) {
  std::string out;
  if (d.triangle) {
    out += fmt::format("triangle {}, ", *d.triangle);
  }
  if (d.x && d.y) {
    out += fmt::format("pixel ({}, {}), ", *d.x, *d.y);
  } else if (d.y) {
    out += fmt::format("row {}, ", *d.y);
  }
  out += fmt::format("stage {}", d.stage);
  if (!d.field.empty()) {
    out += fmt::format(", field {}", d.field);
  }
  return out;
}

std::uint64_t distance(std::int64_t a, std::int64_t b) {
  const auto ua = static_cast<std::uint64_t>(a);
  const auto ub = static_cast<std::uint64_t>(b);
  return a > b ? ua - ub : ub - ua;
}

std::string value_text(const Divergence& d, std::int64_t raw, const Config& config) {
  if (d.kind == DivergenceKind::value) {
    const Field& field = fields_of(d.type)[static_cast<std::size_t>(d.field_number)];
    if (field.kind == FieldKind::integer) {
      return fmt::format("{}", raw);
    }
    const std::int64_t channel = channel_of(d.type, d.reference_record->values);
    return fmt::format("{} = {:.12g} {}", hex_of(raw, field, config, channel),
                       decode(raw, field, config, channel), unit_of(field, config, channel));
  }
  if (d.kind == DivergenceKind::frame && (d.field == "u" || d.field == "v")) {
    return fmt::format("{:.12g} texel", std::bit_cast<double>(raw));
  }
  return fmt::format("{}", raw);
}

}  // namespace

std::string summary(const Divergence& d, const Config& config) {
  switch (d.kind) {
    case DivergenceKind::missing:
      return fmt::format("{}: a record of {} that {} did not deliver", place_of(d), d.reference_engine,
                         d.other_engine);
    case DivergenceKind::extra:
      return fmt::format("{}: a record of {} that {} did not deliver", place_of(d), d.other_engine,
                         d.reference_engine);
    default:
      return fmt::format("{}: {} {}, {} {}", place_of(d), d.reference_engine,
                         value_text(d, d.reference, config), d.other_engine, value_text(d, d.other, config));
  }
}

std::string describe(const Divergence& d, const Config& config, const RunLabel& label) {
  std::string out = fmt::format("first divergence: {} against {}\n", d.reference_engine, d.other_engine);
  out += fmt::format("  configuration  {} ({})\n", config.name.empty() ? "unnamed" : config.name,
                     config_hash(config));
  out += fmt::format("  scene          {}\n", label.scene);
  out += fmt::format("  at             {}\n", place_of(d));
  if (d.kind == DivergenceKind::missing || d.kind == DivergenceKind::extra) {
    const bool missing = d.kind == DivergenceKind::missing;
    out +=
        fmt::format("  record         delivered by {} only\n", missing ? d.reference_engine : d.other_engine);
  } else {
    out += fmt::format("  {:<14} {}\n", d.reference_engine, value_text(d, d.reference, config));
    out += fmt::format("  {:<14} {}\n", d.other_engine, value_text(d, d.other, config));
  }
  if (d.kind == DivergenceKind::value) {
    const Field& field = fields_of(d.type)[static_cast<std::size_t>(d.field_number)];
    const auto format = format_of(field, config, channel_of(d.type, d.reference_record->values));
    out += format ? fmt::format("  distance       {} ULP (1 ULP = 2^{})\n", distance(d.reference, d.other),
                                -format->fraction())
                  : fmt::format("  distance       {}\n", distance(d.reference, d.other));
  }
  if (d.reference_record && d.other_record) {
    const auto all = fields_of(d.type);
    const std::int64_t channel = channel_of(d.type, d.reference_record->values);
    out +=
        fmt::format("  record of {}, both sides ({} | {}):\n", d.stage, d.reference_engine, d.other_engine);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::int64_t a = d.reference_record->values[i];
      const std::int64_t b = d.other_record->values[i];
      const auto text = [&](std::int64_t raw) {
        return all[i].kind == FieldKind::integer
                   ? fmt::format("{}", raw)
                   : fmt::format("{} ({:.10g})", hex_of(raw, all[i], config, channel),
                                 decode(raw, all[i], config, channel));
      };
      const std::string_view unit = unit_of(all[i], config, channel);
      const bool has_b = d.has_other.empty() || d.has_other[i];
      out += fmt::format("  {} {:<12} {} | {}{}{}\n", a == b ? ' ' : '*', all[i].name, text(a),
                         has_b ? text(b) : "-", unit.empty() ? "" : "  ", unit);
    }
  } else if (d.reference_record || d.other_record) {
    const RecordCopy& only = d.reference_record ? *d.reference_record : *d.other_record;
    out += fmt::format("  record of {} in {}:\n{}", d.stage, only.engine, describe_record(only, config, 4));
  }
  for (const RecordCopy& record : d.upstream) {
    out += fmt::format("  fed by {} in {}:\n{}", stage_of(record.type), record.engine,
                       describe_record(record, config, 4));
  }
  if (!d.read.empty()) out += fmt::format("  read by {}:\n", d.stage);
  for (const Read& read : d.read) out += fmt::format("    {:<20} {}\n", read.name, read.value);
  out += fmt::format("  reproduce      {}\n", label.command);
  return out;
}

}  // namespace bitspan
