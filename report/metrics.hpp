// SPDX-License-Identifier: Apache-2.0
// The metrics of the picture and of a field, each declared once: name, unit, meaning, and how it is computed.
// The verdict's lines and JSON, the metrics of studies, their database, the report and the table in
// docs/study.md follow from these two tables.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/engine.hpp"
#include "report/error.hpp"
#include "scene/scene.hpp"

namespace bitspan {

enum class Better : std::uint8_t { low, high };

// Texels are divided into 2 to 2^subtexel_bits parts each way.
inline constexpr int subtexel_bits = 8;

// The finished pictures of an engine and of `ideal`, of equal size.
struct PicturePair {
  PicturePair(const Frame& of_engine, const Frame& of_ideal, const Scene& of, TextureFilter with);
  std::size_t pixels() const;
  const Frame& engine;
  const Frame& ideal;
  const Scene& scene;
  TextureFilter filter;
  // Of the pixels on which the same textured triangle won, [k] counts those whose u or v lies in another part
  // of 1/2^k texel.
  std::array<std::size_t, subtexel_bits + 1> wrong_subtexel{};
  std::size_t same_texture = 0;  // those pixels
};

enum class OverScenes : std::uint8_t { sum, largest };  // how `counted` of several scenes become one

struct PictureMetric {
  std::string_view name;  // "picture.psnr_db"
  std::string_view unit;
  std::string_view meaning;
  Better better;
  OverScenes over_scenes;
  PictureTally (*tally)(const PicturePair&);
  double (*value)(const PictureTally&, const ErrorReport&);
  std::string (*words)(const PictureTally&);  // of the verdict's line; null: not in that line
};
std::span<const PictureMetric> picture_metrics();

// No value without pictures, and where the tally's base is 0 (no texture, nothing drawn).
std::optional<double> value_of(const PictureMetric& metric, const ErrorReport& report);
// Looks the metric up by its name. Throws InputError where no metric has it.
std::optional<double> picture_value(const ErrorReport& report, std::string_view name);
// "PSNR 41.20 dB, colour off by 3 at most, ...": the metrics that have words.
std::string picture_words(const ErrorReport& report);

// A statistic of the error of a field: the metric STAGE.QUANTITY.NAME.
struct FieldStatistic {
  std::string_view name;       // "p999"
  std::string_view label;      // the head of its column
  std::string_view ulp_label;  // of its column in units of the last place; empty: no such column
  std::string_view unit;       // empty: the quantity's, and there is STAGE.QUANTITY.NAME_ulp beside it
  std::string_view meaning;
  Better better;
  bool squares_add;  // for independent causes, the squares of this statistic add up
  bool in_verdict;   // a column of `verify`, and a key of its JSON
  double (*value)(const ErrorStat&);
};
std::span<const FieldStatistic> field_statistics();

}  // namespace bitspan
