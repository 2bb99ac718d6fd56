// SPDX-License-Identifier: Apache-2.0
#include "study/pictures.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <utility>

#include "engine/registry.hpp"
#include "io/png.hpp"
#include "report/error.hpp"
#include "report/heatmap.hpp"
#include "study/engines.hpp"

namespace bitspan {
namespace {

std::vector<std::uint8_t> difference(const Frame& a, const Frame& b) {
  std::vector<int> all(a.color.size());
  int largest = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 4 == 3) continue;
    all[i] = std::abs(static_cast<int>(a.color[i]) - static_cast<int>(b.color[i]));
    largest = std::max(largest, all[i]);
  }
  std::vector<std::uint8_t> out(a.color.size(), 255);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 4 != 3) out[i] = static_cast<std::uint8_t>(largest == 0 ? 0 : all[i] * 255 / largest);
  }
  return out;
}

std::vector<std::uint8_t> heat(int width, int height, const std::vector<double>& values, std::string title) {
  HeatMapOptions options;
  options.title = std::move(title);
  const HeatMap map = draw_heat_map(width, height, values, options);
  return encode_png(map.width, map.height, 3, map.rgb);
}

// The most frequent causes have the colours that are easiest told apart (Okabe and Ito). The rest is grey.
constexpr std::array<std::array<std::uint8_t, 3>, 7> cause_colors{{{230, 159, 0},
                                                                   {86, 180, 233},
                                                                   {0, 158, 115},
                                                                   {240, 228, 66},
                                                                   {0, 114, 178},
                                                                   {213, 94, 0},
                                                                   {204, 121, 167}}};
constexpr std::array<std::uint8_t, 3> other_color{128, 128, 128};

}  // namespace

std::vector<CauseColor> cause_legend(const Budget& budget, const DominantMap& map) {
  std::map<std::int16_t, std::size_t> counts;
  for (const std::int16_t cause : map.cause) {
    if (cause >= 0) ++counts[cause];
  }
  std::vector<std::pair<std::int16_t, std::size_t>> order(counts.begin(), counts.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<CauseColor> out;
  for (std::size_t i = 0; i < order.size(); ++i) {
    out.push_back({order[i].first, budget.rows[static_cast<std::size_t>(order[i].first)].quantisation.name,
                   i < cause_colors.size() ? cause_colors[i] : other_color, order[i].second});
  }
  return out;
}

std::vector<PointPicture> pictures_of(const Config& config, const Scene& scene, const Frame& ideal,
                                      const Budget* budget, const DominantMap* dominant) {
  const Frame model = drawn("model", config, scene);
  const PictureErrors errors = picture_errors(model, ideal);
  const int w = scene.width;
  const int h = scene.height;
  std::vector<PointPicture> out;
  const auto add = [&](const char* name, std::vector<std::uint8_t> png) {
    out.push_back({scene.name, name, std::move(png)});
  };
  add("ideal", encode_png(w, h, 4, ideal.color));
  add("model", encode_png(w, h, 4, model.color));
  add("difference", encode_png(w, h, 4, difference(model, ideal)));
  add("u_error", heat(w, h, errors.texture, "error of u, v: texels"));
  add("depth_error", heat(w, h, errors.depth, "error of depth: codes"));
  if (budget != nullptr && dominant != nullptr) {
    std::vector<std::uint8_t> rgb(3 * dominant->cause.size());
    std::map<std::int16_t, std::array<std::uint8_t, 3>> colors;
    for (const CauseColor& c : cause_legend(*budget, *dominant)) colors[c.cause] = c.rgb;
    for (std::size_t i = 0; i < dominant->cause.size(); ++i) {
      if (dominant->cause[i] < 0) continue;
      const auto& c = colors[dominant->cause[i]];
      std::copy(c.begin(), c.end(), rgb.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    add("dominant", encode_png(w, h, 3, rgb));
  }
  return out;
}

}  // namespace bitspan
