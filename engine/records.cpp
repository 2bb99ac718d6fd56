// SPDX-License-Identifier: Apache-2.0
#include "engine/records.hpp"

#include "config/modes.hpp"

namespace bitspan {

std::optional<Format> format_of(const Field& field, const Config& config) {
  const bool linear_uv = has_linear_texture(config.perspective);
  switch (field.kind) {
    case FieldKind::integer:
      return std::nullopt;
    case FieldKind::format:
      return config.format(field.format);
    case FieldKind::coordinate:
      return config.coordinate_format();
    case FieldKind::depth_code:
      return config.depth_format();
    case FieldKind::edge_mantissa:
      return config.edge_reciprocal.output;
    case FieldKind::row_mantissa:
      return config.row_reciprocal.output;
    case FieldKind::pixel_mantissa:
      return config.pixel_reciprocal.output;
    case FieldKind::phase:
      return Format{
          config.format(FormatId::plane_k).fraction(), 0, false, Rounding::trn, Overflow::sat, false};
    case FieldKind::texture_acc:
      return config.format(linear_uv ? FormatId::span_uv_acc : FormatId::span_f);
    case FieldKind::texture_step:
      return config.format(linear_uv ? FormatId::span_uv_step : FormatId::span_f_step);
  }
  return std::nullopt;
}

std::string_view stage_of(RecordType type) {
  return type == RecordType::count ? std::string_view() : row_of(type).name;
}

std::span<const Field> fields_of(RecordType type) {
  switch (type) {
#define BITSPAN_CASE(Record, LIST, name, member) \
  case RecordType::member:                       \
    return fields<Record>;
    BITSPAN_RECORDS(BITSPAN_CASE)
#undef BITSPAN_CASE
    case RecordType::count:
      break;
  }
  return {};
}

RecordView view_of(const Trace& trace, RecordType type) {
  RecordView view;
  view.type = type;
  view.stage = stage_of(type);
  view.fields = fields_of(type);
  switch (type) {
#define BITSPAN_CASE(Record, LIST, name, member)                              \
  case RecordType::member:                                                    \
    view.values = reinterpret_cast<const std::int64_t*>(trace.member.data()); \
    view.records = trace.member.size();                                       \
    break;
    BITSPAN_RECORDS(BITSPAN_CASE)
#undef BITSPAN_CASE
    case RecordType::count:
      break;
  }
  return view;
}

int field_index(RecordType type, std::string_view field) {
  const auto all = fields_of(type);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == field) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

StateRecord state_record(const DrawState& state, std::int64_t next_index) {
#define BITSPAN_STATE_VALUE(A, type, member, ...) static_cast<std::int64_t>(state.member),
  return {next_index, BITSPAN_DRAW_STATE(BITSPAN_STATE_VALUE, )};
#undef BITSPAN_STATE_VALUE
}

}  // namespace bitspan
