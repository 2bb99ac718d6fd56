// SPDX-License-Identifier: Apache-2.0
#include "config/format.hpp"

namespace bitspan {

namespace {

#define BITSPAN_FORMAT_KEY(id, key, unit, text, ...) key,
#define BITSPAN_FORMAT_UNIT(id, key, unit, text, ...) unit,
#define BITSPAN_FORMAT_TEXT(id, key, unit, text, ...) text,
constexpr std::array<std::string_view, format_count> kFormatKeys{BITSPAN_FORMATS(BITSPAN_FORMAT_KEY)};
constexpr std::array<std::string_view, format_count> kFormatUnits{BITSPAN_FORMATS(BITSPAN_FORMAT_UNIT)};
constexpr std::array<std::string_view, format_count> kFormatTexts{BITSPAN_FORMATS(BITSPAN_FORMAT_TEXT)};
#undef BITSPAN_FORMAT_KEY
#undef BITSPAN_FORMAT_UNIT
#undef BITSPAN_FORMAT_TEXT

// A default is resolved in the table's order.
constexpr bool each_default_stands_before() {
  for (std::size_t i = 0; i < format_defaults.size(); ++i) {
    // Not std::get_if: an address is no constant for GCC's sanitizers.
    if (!std::holds_alternative<FormatId>(format_defaults[i])) continue;
    if (static_cast<std::size_t>(std::get<FormatId>(format_defaults[i])) >= i) return false;
  }
  return true;
}
static_assert(each_default_stands_before());

std::string_view of(const std::array<std::string_view, format_count>& list, FormatId id) {
  const auto i = static_cast<std::size_t>(id);
  return i < list.size() ? list[i] : "?";
}

}  // namespace

std::string_view key_of(FormatId id) { return of(kFormatKeys, id); }
std::string_view unit_of(FormatId id) { return of(kFormatUnits, id); }
std::string_view text_of(FormatId id) { return of(kFormatTexts, id); }

}  // namespace bitspan
