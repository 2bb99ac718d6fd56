#include "config/names.hpp"

namespace bitspan {

std::string_view to_string(Rounding mode) { return enum_name(mode); }
std::string_view to_string(Overflow mode) { return enum_name(mode); }
std::string_view to_string(FillRule v) { return enum_name(v); }
std::string_view to_string(EdgeWalk v) { return enum_name(v); }
std::string_view to_string(DdaUpdate v) { return enum_name(v); }
std::string_view to_string(Perspective v) { return enum_name(v); }
std::string_view to_string(Numerator v) { return enum_name(v); }
std::string_view to_string(SlopeForm v) { return enum_name(v); }
std::string_view to_string(ReciprocalKind v) { return enum_name(v); }
std::string_view to_string(DepthCode v) { return enum_name(v); }
std::string_view to_string(TextureFilter v) { return enum_name(v); }
std::string_view to_string(TextureWrap v) { return enum_name(v); }
std::string_view to_string(FogMode v) { return enum_name(v); }
std::string_view to_string(Stage stage) { return enum_name(stage); }

namespace {

#define BITSPAN_FORMAT_KEY(id, key, unit, text) key,
#define BITSPAN_FORMAT_UNIT(id, key, unit, text) unit,
#define BITSPAN_FORMAT_TEXT(id, key, unit, text) text,
constexpr std::array<std::string_view, format_count> kFormatKeys{BITSPAN_FORMATS(BITSPAN_FORMAT_KEY)};
constexpr std::array<std::string_view, format_count> kFormatUnits{BITSPAN_FORMATS(BITSPAN_FORMAT_UNIT)};
constexpr std::array<std::string_view, format_count> kFormatTexts{BITSPAN_FORMATS(BITSPAN_FORMAT_TEXT)};
#undef BITSPAN_FORMAT_KEY
#undef BITSPAN_FORMAT_UNIT
#undef BITSPAN_FORMAT_TEXT

std::string_view of(const std::array<std::string_view, format_count>& list, FormatId id) {
  const auto i = static_cast<std::size_t>(id);
  return i < list.size() ? list[i] : "?";
}

}  // namespace

std::string_view key_of(FormatId id) { return of(kFormatKeys, id); }
std::string_view unit_of(FormatId id) { return of(kFormatUnits, id); }
std::string_view text_of(FormatId id) { return of(kFormatTexts, id); }

}  // namespace bitspan
