// SPDX-License-Identifier: Apache-2.0
#include "report/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "config/modes.hpp"

namespace bitspan {
namespace {

// Whether a pixel holds a triangle in either picture.
bool drawn(const PicturePair& p, std::size_t i) {
  return p.engine.triangle[i] >= 0 || p.ideal.triangle[i] >= 0;
}

bool wrong_order(const PicturePair& p, std::size_t i) { return p.engine.triangle[i] != p.ideal.triangle[i]; }

// Whether the same textured triangle won.
bool same_texture(const PicturePair& p, std::size_t i) {
  return p.engine.triangle[i] >= 0 && !wrong_order(p, i) &&
         p.scene.triangles[static_cast<std::size_t>(p.engine.triangle[i])].texture >= 0;
}

// Returns the finest part of a texel, 2^-subtexel_bits wide, that holds the coordinate.
std::int64_t subtexel(double coordinate) {
  constexpr double limit = 1e15;  // for what no format holds
  const double scaled = std::clamp(coordinate * (1 << subtexel_bits), -limit, limit);
  const auto towards_zero = static_cast<std::int64_t>(scaled);
  return towards_zero - static_cast<std::int64_t>(scaled < static_cast<double>(towards_zero));
}

// engine - ideal of a channel (0 to 2: R, G, B) of a pixel, codes.
int colour_difference(const PicturePair& p, std::size_t i, std::size_t channel) {
  return static_cast<int>(p.engine.color[4 * i + channel]) - static_cast<int>(p.ideal.color[4 * i + channel]);
}

template <class Test>
double pixels_where(const PicturePair& p, Test test) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < p.pixels(); ++i) count += static_cast<std::size_t>(test(p, i));
  return static_cast<double>(count);
}

PictureTally tally_squares(const PicturePair& p) {
  std::int64_t squares = 0;
  for (std::size_t i = 0; i < p.pixels(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t d = colour_difference(p, i, c);
      squares += d * d;
    }
  }
  return {static_cast<double>(squares), 3 * static_cast<double>(p.pixels())};
}

PictureTally tally_largest_difference(const PicturePair& p) {
  int largest = 0;
  for (std::size_t i = 0; i < p.pixels(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(colour_difference(p, i, c)));
  }
  return {static_cast<double>(largest), static_cast<double>(p.pixels())};
}

PictureTally tally_drawn(const PicturePair& p) {
  return {pixels_where(p, drawn), static_cast<double>(p.pixels())};
}

PictureTally tally_wrong_order(const PicturePair& p) {
  return {pixels_where(p, wrong_order), pixels_where(p, drawn)};
}

template <int bits>
PictureTally tally_wrong_subtexel(const PicturePair& p) {
  return {static_cast<double>(p.wrong_subtexel[bits]), static_cast<double>(p.same_texture)};
}

// A filter that weighs texels shows several of them.
PictureTally tally_wrong_texel(const PicturePair& p) {
  return weighs_texels(p.filter) ? PictureTally{} : tally_wrong_subtexel<0>(p);
}

PictureTally tally_changed(const PicturePair& p) {
  const auto changed = [](const PicturePair& q, std::size_t i) {
    return colour_difference(q, i, 0) != 0 || colour_difference(q, i, 1) != 0 ||
           colour_difference(q, i, 2) != 0;
  };
  return {pixels_where(p, changed), static_cast<double>(p.pixels())};
}

PictureTally tally_nothing(const PicturePair& p) { return {0, static_cast<double>(p.pixels())}; }

double counted(const PictureTally& t, const ErrorReport& /*report*/) { return t.counted; }
double share(const PictureTally& t, const ErrorReport& /*report*/) { return t.counted / t.base; }

double psnr(const PictureTally& t) {
  return t.counted == 0 ? std::numeric_limits<double>::infinity()
                        : 10 * std::log10(255.0 * 255.0 * t.base / t.counted);
}

// One row for so many bits, which divide a texel into `parts`. The table keeps views of literals.
#define BITSPAN_SUBTEXEL_RATE(bits, parts)                                          \
  {                                                                                 \
    "picture.wrong_subtexel_rate_" #bits, "of the pixels",                          \
        "pixels whose u or v lies in another 1/" #parts                             \
        " of a texel, as a share of those on which the same textured triangle won", \
        Better::low, OverScenes::sum, tally_wrong_subtexel<bits>, share, nullptr    \
  }

constexpr auto pictures = std::to_array<PictureMetric>({
    {"picture.psnr_db", "dB",
     "peak signal to noise over R, G, B of all pixels; infinite where the pictures are equal", Better::high,
     OverScenes::sum, tally_squares,
     [](const PictureTally& t, const ErrorReport& /*report*/) { return psnr(t); },
     [](const PictureTally& t) { return "PSNR " + psnr_text(psnr(t)); }},
    {"picture.color_max", "colour code", "the largest difference of a channel", Better::low,
     OverScenes::largest, tally_largest_difference, counted,
     [](const PictureTally& t) { return fmt::format("colour off by {:.0f} at most", t.counted); }},
    {"picture.drawn", "pixels", "pixels that hold a triangle in either picture", Better::low, OverScenes::sum,
     tally_drawn, counted, nullptr},
    {"picture.wrong_order", "pixels", "drawn pixels on which another triangle won", Better::low,
     OverScenes::sum, tally_wrong_order, counted,
     [](const PictureTally& t) {
       return fmt::format("another triangle won {:.0f} of {:.0f} drawn pixels", t.counted, t.base);
     }},
    {"picture.wrong_order_rate", "of the pixels", "their share of the drawn pixels", Better::low,
     OverScenes::sum, tally_wrong_order, share, nullptr},
    {"picture.wrong_texel", "pixels",
     "pixels that show another texel, of those on which the same textured triangle won, with the nearest "
     "filter",
     Better::low, OverScenes::sum, tally_wrong_texel, counted, nullptr},
    {"picture.wrong_texel_rate", "of the pixels", "their share of those pixels", Better::low, OverScenes::sum,
     tally_wrong_texel, share, nullptr},
    BITSPAN_SUBTEXEL_RATE(1, 2),
    BITSPAN_SUBTEXEL_RATE(2, 4),
    BITSPAN_SUBTEXEL_RATE(3, 8),
    BITSPAN_SUBTEXEL_RATE(4, 16),
    BITSPAN_SUBTEXEL_RATE(5, 32),
    BITSPAN_SUBTEXEL_RATE(6, 64),
    BITSPAN_SUBTEXEL_RATE(7, 128),
    BITSPAN_SUBTEXEL_RATE(8, 256),
    {"picture.changed_rate", "of the pixels", "pixels whose colour differs, as a share of all pixels",
     Better::low, OverScenes::sum, tally_changed, share, nullptr},
    {"picture.coverage_differences", "pixels",
     "pixels of all triangles whose coverage differs from the exact test of the pixel's centre", Better::low,
     OverScenes::sum, tally_nothing,
     [](const PictureTally& /*tally*/, const ErrorReport& r) {
       return static_cast<double>(r.coverage_differences());
     },
     nullptr},
});

#undef BITSPAN_SUBTEXEL_RATE

constexpr auto statistics = std::to_array<FieldStatistic>({
    {"bias", "bias", "", "", "mean of engine - ideal, with its sign", Better::low, false, true,
     [](const ErrorStat& s) { return s.mean(); }},
    {"max", "maximum", "maximum [ULP]", "", "largest magnitude", Better::low, false, true,
     [](const ErrorStat& s) { return s.max; }},
    {"mean", "mean", "", "", "mean of the magnitude", Better::low, false, false,
     [](const ErrorStat& s) { return s.mean_magnitude(); }},
    {"median", "median", "", "", "half of the magnitudes are not above it; the upper edge of 1/8 octave",
     Better::low, false, false, [](const ErrorStat& s) { return s.quantile(0.5); }},
    {"rms", "RMS", "", "", "root of the mean square", Better::low, true, true,
     [](const ErrorStat& s) { return s.rms(); }},
    {"p999", "99.9 %", "", "", "99.9 % of the magnitudes are not above it; the upper edge of 1/8 octave",
     Better::low, false, false, [](const ErrorStat& s) { return s.quantile(0.999); }},
    {"sqnr_db", "SQNR [dB]", "", "dB",
     "power of the ideal values over the power of the error; infinite without error", Better::high, false,
     false, [](const ErrorStat& s) { return s.sqnr_db(); }},
});

}  // namespace

PicturePair::PicturePair(const Frame& of_engine, const Frame& of_ideal, const Scene& of, TextureFilter with)
    : engine(of_engine), ideal(of_ideal), scene(of), filter(with) {
  for (std::size_t i = 0; i < pixels(); ++i) {
    if (!bitspan::same_texture(*this, i)) continue;
    ++same_texture;
    const auto differing = static_cast<std::uint64_t>((subtexel(engine.u[i]) ^ subtexel(ideal.u[i])) |
                                                      (subtexel(engine.v[i]) ^ subtexel(ideal.v[i])));
    // With k bits, the lowest subtexel_bits - k of the part's number are left out.
    const auto width = static_cast<int>(std::bit_width(differing));
    for (int k = std::max(0, subtexel_bits - width + 1); k <= subtexel_bits; ++k) {
      ++wrong_subtexel[static_cast<std::size_t>(k)];
    }
  }
}

std::size_t PicturePair::pixels() const { return std::min(engine.depth.size(), ideal.depth.size()); }

std::span<const PictureMetric> picture_metrics() { return pictures; }

std::span<const FieldStatistic> field_statistics() { return statistics; }

std::optional<double> value_of(const PictureMetric& metric, const ErrorReport& report) {
  if (!report.has_picture()) return std::nullopt;
  const PictureTally& tally = report.picture[static_cast<std::size_t>(&metric - pictures.data())];
  if (tally.base == 0) return std::nullopt;
  return metric.value(tally, report);
}

std::optional<double> picture_value(const ErrorReport& report, std::string_view name) {
  const auto found = std::ranges::find(pictures, name, &PictureMetric::name);
  if (found == pictures.end()) throw InputError(fmt::format("{}: is no metric of the picture", name));
  return value_of(*found, report);
}

std::string picture_words(const ErrorReport& report) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < report.picture.size(); ++i) {
    if (pictures[i].words != nullptr) parts.push_back(pictures[i].words(report.picture[i]));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace bitspan
