// SPDX-License-Identifier: Apache-2.0
#include "lib/records.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "lib/status.hpp"

namespace bitspan::capi {
namespace {

// Where a value stands. Its text is made for a fault alone: records are checked field by field.
struct Place {
  std::string_view function;
  RecordType type;
  std::string_view field;
};
std::string text_of(const Place& at) {
  return std::string(at.function) + ": " + std::string(stage_of(at.type)) + ": " + std::string(at.field) +
         ": ";
}

void check_range(std::int64_t value, std::int64_t low, std::int64_t high, const Place& at) {
  if (value >= low && value <= high) return;
  fail(BS_BAD_INPUT, text_of(at) + std::to_string(value) + " is out of range; expected " +
                         std::to_string(low) + " to " + std::to_string(high));
}

constexpr std::int64_t triangle_limit = std::numeric_limits<std::int32_t>::max();

// What a stage decides of a fragment, and the caller's may decide otherwise.
bool is_flag(std::string_view name) { return name == "covered" || name == "pass" || name == "killed"; }

}  // namespace

void check_registers(const Config& config, RecordType type, std::span<const std::int64_t> record,
                     std::string_view function) {
  const auto all = fields_of(type);
  const std::int64_t channel = channel_of(type, record);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Place where{function, type, all[i].name};
    const std::optional<Format> format = format_of(all[i], config, channel);
    if (!format) {
      if (is_flag(all[i].name)) check_range(record[i], 0, 1, where);
      if (all[i].name == "triangle") check_range(record[i], 0, triangle_limit, where);
      continue;
    }
    const int magnitude = format->word - (format->is_signed ? 1 : 0);
    const std::int64_t high =
        magnitude >= 63 ? std::numeric_limits<std::int64_t>::max() : (std::int64_t{1} << magnitude) - 1;
    check_range(record[i], format->is_signed ? -high - 1 : 0, high, where);
  }
}

void check_identity(RecordType type, std::span<const std::int64_t> before,
                    std::span<const std::int64_t> record, std::string_view function) {
  const auto all = fields_of(type);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool stays =
        (all[i].kind == FieldKind::integer && !is_flag(all[i].name)) || all[i].kind == FieldKind::phase;
    if (!stays || record[i] == before[i]) continue;
    fail(BS_BAD_INPUT, text_of({function, type, all[i].name}) + "was changed to " +
                           std::to_string(record[i]) + "; expected " + std::to_string(before[i]) +
                           ", since it is no value of the stage");
  }
}

void check_setup(const SetupRecord& r, std::string_view function) {
  const auto comes_before = [](std::int64_t ay, std::int64_t ax, std::int64_t by, std::int64_t bx) {
    return ay < by || (ay == by && ax <= bx);
  };
  if (!comes_before(r.y0, r.x0, r.y1, r.x1) || !comes_before(r.y1, r.x1, r.y2, r.x2)) {
    fail(BS_BAD_INPUT, text_of({function, RecordType::setup, "y0, y1, y2"}) +
                           "are not in order; expected vertices from the top, and from the left in a row");
  }
  __extension__ using Wide = __int128;
  const Wide turn =
      static_cast<Wide>(r.x1 - r.x0) * (r.y2 - r.y0) - static_cast<Wide>(r.x2 - r.x0) * (r.y1 - r.y0);
  if (turn == 0 || r.mid_right != (turn > 0 ? 1 : 0)) {
    fail(BS_BAD_INPUT, text_of({function, RecordType::setup, "mid_right"}) + std::to_string(r.mid_right) +
                           " does not fit the vertices; expected " +
                           (turn == 0  ? "a triangle with an area"
                            : turn > 0 ? "1"
                                       : "0"));
  }
}

void check_pixels(const RowRecord& row, const View& view, std::string_view function) {
  const auto where = [&](std::string_view field) { return Place{function, RecordType::row, field}; };
  check_range(row.y, 0, view.height - 1, where("y"));
  check_range(row.x_first, 0, view.width - 1, where("x_first"));
  check_range(row.x_last, row.x_first, view.width - 1, where("x_last"));
  check_range(row.l_edge, 0, 2, where("l_edge"));
  check_range(row.r_edge, 0, 2, where("r_edge"));
}

void check_pixels(const SpanRecord& span, const View& view, std::string_view function) {
  const auto where = [&](std::string_view field) { return Place{function, RecordType::span, field}; };
  check_range(span.y, 0, view.height - 1, where("y"));
  check_range(span.x, 0, view.width - 1, where("x"));
  check_range(span.count, 1, view.width - span.x, where("count"));
  check_range(span.phase, 0, 0, where("phase"));
}

std::size_t row_of_plane(const AnyRow& any, const PlaneOfRows& plane, std::string_view function) {
  const auto same_pixels = [&](const PlaneRowRecord& of_plane) {
    if (const auto* row = std::get_if<PlaneRowRecord>(&any)) {
      return row->row == of_plane.row && row->major_first == of_plane.major_first &&
             row->minor_first == of_plane.minor_first && row->count == of_plane.count &&
             row->phase == of_plane.phase;
    }
    const auto& span = std::get<SpanRecord>(any);
    const std::int64_t major = plane.along_y ? span.y : span.x;
    const std::int64_t minor = plane.along_y ? span.x : span.y;
    return major == of_plane.major_first && minor == of_plane.minor_first && span.count == of_plane.count &&
           span.phase == of_plane.phase;
  };
  const auto at = std::ranges::find_if(plane.rows, same_pixels);
  if (at == plane.rows.end()) {
    const bool is_span = std::holds_alternative<SpanRecord>(any);
    fail(BS_BAD_INPUT, text_of({function, is_span ? RecordType::span : RecordType::plane_row, "count"}) +
                           "the pixels are no row of the triangle; expected one of its " +
                           std::to_string(plane.rows.size()) + " rows");
  }
  return static_cast<std::size_t>(at - plane.rows.begin());
}

}  // namespace bitspan::capi
