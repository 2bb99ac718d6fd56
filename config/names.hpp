// The names of the enumerators, as the TOML file spells them; shared by reader, writer and messages.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "config/config.hpp"

namespace bitspan {

// In the order of the enumerators.
template <class E>
inline constexpr std::array<std::string_view, 0> enum_names{};

template <>
inline constexpr auto enum_names<Rounding> = std::to_array<std::string_view>(
    {"SC_RND", "SC_RND_ZERO", "SC_RND_MIN_INF", "SC_RND_INF", "SC_RND_CONV", "SC_TRN", "SC_TRN_ZERO"});
template <>
inline constexpr auto enum_names<Overflow> =
    std::to_array<std::string_view>({"SC_WRAP", "SC_SAT", "SC_SAT_ZERO", "SC_SAT_SYM", "SC_WRAP_SM"});
template <>
inline constexpr auto enum_names<FillRule> = std::to_array<std::string_view>({"top_left", "inclusive"});
template <>
inline constexpr auto enum_names<EdgeWalk> = std::to_array<std::string_view>({"exact", "dda"});
template <>
inline constexpr auto enum_names<DdaUpdate> = std::to_array<std::string_view>({"accumulate", "multiply"});
template <>
inline constexpr auto enum_names<Perspective> =
    std::to_array<std::string_view>({"delta_f", "const_depth_rows", "hyperbolic", "affine"});
template <>
inline constexpr auto enum_names<Numerator> = std::to_array<std::string_view>({"pixel_centre", "ideal_line"});
template <>
inline constexpr auto enum_names<SlopeForm> = std::to_array<std::string_view>({"divide", "reciprocal"});
template <>
inline constexpr auto enum_names<ReciprocalKind> = std::to_array<std::string_view>({"restoring", "lut_linear",
                                                                                    "lut_newton"});
template <>
inline constexpr auto enum_names<DepthCode> = std::to_array<std::string_view>({"inverse", "linear",
                                                                               "opengl"});
template <>
inline constexpr auto enum_names<TextureFilter> = std::to_array<std::string_view>({"nearest", "bilinear"});
template <>
inline constexpr auto enum_names<TextureWrap> = std::to_array<std::string_view>({"cyclic", "clamp"});
template <>
inline constexpr auto enum_names<FogMode> = std::to_array<std::string_view>({"none", "linear", "table"});
template <>
inline constexpr auto enum_names<Stage> = stage_names;

// "?" for a value that is no enumerator.
template <class E>
constexpr std::string_view enum_name(E value) {
  const auto i = static_cast<std::size_t>(value);
  return i < enum_names<E>.size() ? enum_names<E>[i] : "?";
}

}  // namespace bitspan
