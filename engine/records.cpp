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

}  // namespace bitspan
