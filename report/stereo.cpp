// SPDX-License-Identifier: Apache-2.0
#include "report/stereo.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/position.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

// h / hmax of a distance.
double share_of(const View& view, double s) {
  return view.s_min * (view.s_max - s) / (s * (view.s_max - view.s_min));
}
double shift_of(const View& view, double s, const StereoOptions& options, Eye eye) {
  const double p = options.parallax * (share_of(view, s) - (options.zero == StereoZero::near ? 1 : 0));
  return eye == Eye::left ? p : -p;
}

// A hole of a row is as its farther end: what stands in front of it has moved away.
void fill(std::vector<double>& s, std::uint8_t* rgba, std::int64_t width) {
  for (std::int64_t x = 0; x < width;) {
    if (!std::isnan(s[static_cast<std::size_t>(x)])) {
      ++x;
      continue;
    }
    std::int64_t end = x;
    while (end < width && std::isnan(s[static_cast<std::size_t>(end)])) ++end;
    const std::int64_t left = x - 1, right = end < width ? end : -1;
    const bool by_right =
        left < 0 || (right >= 0 && s[static_cast<std::size_t>(right)] > s[static_cast<std::size_t>(left)]);
    const std::int64_t from = by_right ? right : left;
    for (; x < end; ++x) {
      // A row without any pixel stays as it is.
      if (from >= 0) std::copy_n(rgba + 4 * from, 4, rgba + 4 * x);
    }
  }
}

}  // namespace

Warped warped(const Config& config, const Scene& scene, const Frame& frame, const StereoOptions& options,
              Eye eye) {
  const std::int64_t width = frame.width;
  Warped out;
  out.picture = {frame.width, frame.height, std::vector<std::uint8_t>(frame.color.size())};
  const std::vector<double> known = positions_of(config, scene, frame).s;
  std::vector<double> s(static_cast<std::size_t>(width));
  for (std::int64_t y = 0; y < frame.height; ++y) {
    std::ranges::fill(s, std::numeric_limits<double>::quiet_NaN());
    std::uint8_t* const row = out.picture.rgba.data() + 4 * y * width;
    for (std::int64_t x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y * width + x);
      // The background is as far as can be.
      const double own = std::isnan(known[i]) ? scene.s_max : known[i];
      const double at = std::floor(static_cast<double>(x) + 0.5 + shift_of(scene, own, options, eye));
      if (!(at >= 0 && at < static_cast<double>(width))) continue;
      double& there = s[static_cast<std::size_t>(at)];
      if (there <= own) continue;  // of two that are as near, the left one
      there = own;
      std::copy_n(frame.color.data() + 4 * i, 4, row + 4 * static_cast<std::int64_t>(at));
    }
    out.holes += static_cast<std::uint64_t>(std::ranges::count_if(s, [](double x) { return std::isnan(x); }));
    fill(s, row, width);
  }
  return out;
}

Scene seen_by(Scene scene, const StereoOptions& options, Eye eye) {
  if (changes_scene(scene.commands)) {
    throw InputError("--stereo: a scene in passes has more than one eye; expected --stereo-by depth");
  }
  for (Triangle& triangle : scene.triangles) {
    for (Vertex& v : triangle.v) v.x += shift_of(scene, v.s, options, eye);
  }
  check_scene(scene, scene.name);
  return scene;
}

EyePicture joined(const EyePicture& left, const EyePicture& right, StereoLayout layout) {
  const auto row = static_cast<std::size_t>(left.width) * 4;
  EyePicture out;
  out.height = left.height;
  out.width = left.width;
  switch (layout) {
    case StereoLayout::pair:
      out.width *= 2;
      for (std::size_t y = 0; y < static_cast<std::size_t>(left.height); ++y) {
        for (const EyePicture* of : {&left, &right}) {
          const auto from = of->rgba.begin() + static_cast<std::ptrdiff_t>(y * row);
          out.rgba.insert(out.rgba.end(), from, from + static_cast<std::ptrdiff_t>(row));
        }
      }
      break;
    case StereoLayout::anaglyph:
      out.rgba = right.rgba;
      for (std::size_t i = 0; i < left.rgba.size(); i += 4) out.rgba[i] = left.rgba[i];
      break;
  }
  return out;
}

}  // namespace bitspan
