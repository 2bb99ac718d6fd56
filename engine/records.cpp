// SPDX-License-Identifier: Apache-2.0
#include "engine/records.hpp"

#include "config/lines.hpp"

namespace bitspan {

std::optional<FormatId> register_of(const Field& field, const Config& config, std::int64_t channel) {
  const Line texture = line_of(LineId::fu, config.perspective);
  // A record from outside may name a channel that there is not.
  const bool known = channel >= 0 && channel < channel_limit;
  const Line own = line_of(channel_line(known ? channel : 0), config.perspective);
  const auto of_channel = [known](FormatId id) { return known ? std::optional(id) : std::nullopt; };
  switch (field.kind) {
    case FieldKind::integer:
    case FieldKind::coordinate:
    case FieldKind::depth_code:
    case FieldKind::edge_mantissa:
    case FieldKind::row_mantissa:
    case FieldKind::pixel_mantissa:
    case FieldKind::phase:
      return std::nullopt;
    case FieldKind::format:
      return field.format;
    case FieldKind::texture_acc:
      return texture.row.acc;
    case FieldKind::texture_step:
      return texture.row.step;
    case FieldKind::channel_vertex:
      return of_channel(own.vertex);
    case FieldKind::channel_product:
      return of_channel(own.product.value_or(own.vertex));
    case FieldKind::channel_edge_step:
      return of_channel(own.edge.step);
    case FieldKind::channel_edge_acc:
      return of_channel(own.edge.acc);
    case FieldKind::channel_edge:
      return of_channel(own.edge.kept);
    case FieldKind::channel_gradient:
      return of_channel(own.gradient);
    case FieldKind::channel_step:
      return of_channel(own.row.step);
    case FieldKind::channel_acc:
      return of_channel(own.row.acc);
    case FieldKind::channel_value:
      return of_channel(own.row.kept);
  }
  return std::nullopt;
}

std::optional<Format> format_of(const Field& field, const Config& config, std::int64_t channel) {
  if (const auto id = register_of(field, config, channel)) return config.format(*id);
  switch (field.kind) {
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
    default:  // an integer
      return std::nullopt;
  }
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

std::int64_t channel_of(RecordType type, std::span<const std::int64_t> record) {
  const int at = field_index(type, "channel");
  return at < 0 ? 0 : record[static_cast<std::size_t>(at)];
}

StateRecord state_record(const DrawState& state, std::int64_t next_index) {
#define BITSPAN_STATE_VALUE(A, type, member, ...) static_cast<std::int64_t>(state.member),
  return {next_index, BITSPAN_DRAW_STATE(BITSPAN_STATE_VALUE, )};
#undef BITSPAN_STATE_VALUE
}

}  // namespace bitspan
