// SPDX-License-Identifier: Apache-2.0
#include "golden/texel.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "config/modes.hpp"

namespace bitspan::golden {

double expanded(std::uint64_t c, double values) {
  return std::min(255.0, std::floor(256.0 * static_cast<double>(c) / (values - 1)));
}

namespace {

// All values are small rationals. A quotient that is not whole lies 1/255 or more from a whole number, so
// that doubles find its floor.
using Rgb = std::array<double, 3>;

// Takes fields off a number, from its low end.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> low_byte_first) {
    std::uint64_t weight = 1;
    for (const std::uint8_t byte : low_byte_first) {
      value_ += byte * weight;
      weight *= 256;
    }
  }
  std::uint64_t take(std::uint64_t count_of_values) {
    const std::uint64_t out = value_ % count_of_values;
    value_ /= count_of_values;
    return out;
  }
  // The field with that number where all have as many values.
  std::uint64_t nth(std::uint64_t number, std::uint64_t count_of_values) const {
    std::uint64_t rest = value_;
    for (; number > 0; --number) rest /= count_of_values;
    return rest % count_of_values;
  }

 private:
  std::uint64_t value_ = 0;
};

double clamped(double x) { return std::min(255.0, std::max(0.0, x)); }

Rgb from_565(std::uint64_t word) {
  const std::uint64_t blue = word % 32;
  const std::uint64_t green = word / 32 % 64;
  const std::uint64_t red = word / 2048;
  return {expanded(red, 32), expanded(green, 64), expanded(blue, 32)};
}
Rgb from_332(Fields& f) {
  const double blue = expanded(f.take(4), 4);
  const double green = expanded(f.take(8), 8);
  return {expanded(f.take(8), 8), green, blue};
}
Rgb from_yiq(Fields& f, const std::vector<std::int16_t>& table) {
  const auto q = static_cast<std::size_t>(f.take(4));
  const auto i = static_cast<std::size_t>(f.take(4));
  const auto y = static_cast<std::size_t>(f.take(16));
  const std::span values(table);
  const auto of_i = values.subspan(16, 12).subspan(3 * i, 3);
  const auto of_q = values.subspan(28, 12).subspan(3 * q, 3);
  const auto sum = [&](std::size_t c) { return clamped(double(values[y]) + of_i[c] + of_q[c]); };
  return {sum(0), sum(1), sum(2)};
}
std::array<double, 4> from_palette(std::uint64_t entry, const std::vector<std::int16_t>& table) {
  const auto at = static_cast<std::size_t>(4 * entry);
  return {double(table.at(at)), double(table.at(at + 1)), double(table.at(at + 2)), double(table.at(at + 3))};
}
Rgb from_yuv(double y, double u, double v) {
  const auto rounded = [](double sum) { return clamped(std::floor(sum + 0.5)); };
  const double luma = 298.0 / 256 * (y - 16);
  const double blue = u - 128;
  const double red = v - 128;
  return {rounded(luma + 409.0 / 256 * red), rounded(luma - 100.0 / 256 * blue - 208.0 / 256 * red),
          rounded(luma + 516.0 / 256 * blue)};
}

// The mean with whole weights, down to a whole number.
double mean(double a, double weight_a, double b, double weight_b) {
  return std::floor((a * weight_a + b * weight_b) / (weight_a + weight_b));
}

struct Block {
  Rgb color{};
  bool clear = false;
};
Block from_dxt_colors(std::span<const std::uint8_t> bytes, std::uint64_t place, bool always_four) {
  Fields words(bytes.first(4));
  const std::uint64_t c0 = words.take(65536);
  const std::uint64_t c1 = words.take(65536);
  const std::uint64_t code = Fields(bytes.subspan(4, 4)).nth(place, 4);
  const bool four = always_four || c0 > c1;
  const Rgb a = from_565(c0);
  const Rgb b = from_565(c1);
  Block out;
  // Weights of the two words, by the code.
  double of_a = 0;
  double of_b = 0;
  switch (code) {
    case 0:
      of_a = 1;
      break;
    case 1:
      of_b = 1;
      break;
    case 2:
      of_a = four ? 2 : 1;
      of_b = 1;
      break;
    default:
      if (!four) return {{0, 0, 0}, true};
      of_a = 1;
      of_b = 2;
      break;
  }
  for (std::size_t c = 0; c < 3; ++c) out.color[c] = mean(a[c], of_a, b[c], of_b);
  return out;
}
double from_dxt5_alphas(std::span<const std::uint8_t> bytes, std::uint64_t place) {
  const double a0 = bytes[0];
  const double a1 = bytes[1];
  const auto k = static_cast<double>(Fields(bytes.subspan(2, 6)).nth(place, 8));
  if (k == 0) return a0;
  if (k == 1) return a1;
  const double steps = a0 > a1 ? 7 : 5;
  if (k > steps) return k == 6 ? 0 : 255;
  return mean(a0, steps + 1 - k, a1, k - 1);
}

TexelCodes codes(const Rgb& c, double alpha) {
  const auto code = [](double x) { return static_cast<std::uint8_t>(x); };
  return {code(c[0]), code(c[1]), code(c[2]), code(alpha)};
}

// ---- Procedural textures, of whole numbers below 2^53

double whole_part(double n, double d) { return std::floor(n / d); }
double rest_of(double n, double d) { return n - d * std::floor(n / d); }

// hash(x, y, seed)
double hash_of(double x, double y, double seed) {
  constexpr double word = 4294967296;
  double n = rest_of(1640531 * x + 1274127 * y + 1013901 * seed + 668265, word);
  for (const double factor : {1597335.0, 2018697.0, 1394573.0}) {
    const auto mixed = static_cast<std::uint64_t>(n) ^ static_cast<std::uint64_t>(whole_part(n, 32768));
    n = rest_of(factor * static_cast<double>(mixed), word);
  }
  return whole_part(n, 16777216);
}

class Pattern {
 public:
  Pattern(const Texture& texture, double i, double j) : t_(texture), i_(i), j_(j) {}

  TexelCodes checker() const {
    const double cells = whole_part(i_, value(checker_width)) + whole_part(j_, value(checker_height));
    return rest_of(cells, 2) == 0 ? mixed(0) : mixed(255);
  }
  TexelCodes brick() const {
    const double width = value(brick_width);
    const double height = value(brick_height);
    const double row = whole_part(j_, height);
    const double along = i_ + value(brick_shift) * rest_of(row, 2);
    if (rest_of(along, width) < value(brick_mortar) || rest_of(j_, height) < value(brick_mortar))
      return mixed(255);
    const double column = rest_of(whole_part(along, width), std::ceil(t_.width / width));
    const double share = value(brick_vary) * hash_of(column, row, value(brick_seed)) / 65536;
    TexelCodes out = mixed(0);
    for (std::size_t c = 0; c < 3; ++c) {
      out[c] = static_cast<std::uint8_t>(out[c] - std::floor(out[c] * share));
    }
    return out;
  }
  TexelCodes noise() const {
    double sum = 0;
    double weights = 0;
    for (double octave = 0; octave < value(noise_octaves); ++octave) {
      const double weight = std::exp2(value(noise_octaves) - 1 - octave);
      sum += weight * std::floor(smooth(std::exp2(value(noise_cell) - octave), octave));
      weights += weight;
    }
    return mixed(whole_part(sum, weights));
  }

 private:
  double value(std::size_t index) const { return t_.table.at(index); }
  // The first colour where t is 0, the second where it is 255.
  TexelCodes mixed(double t) const {
    TexelCodes out{};
    for (std::size_t c = 0; c < 4; ++c) {
      out[c] = static_cast<std::uint8_t>(whole_part(value(c) * (255 - t) + value(4 + c) * t + 127, 255));
    }
    return out;
  }
  // Between the corners of the cell that holds the texel.
  double smooth(double cell, double octave) const {
    const double columns = std::ceil(t_.width / cell);
    const double rows = std::ceil(t_.height / cell);
    const double left = whole_part(i_, cell);
    const double top = whole_part(j_, cell);
    const double across = i_ / cell - left;
    const double down = j_ / cell - top;
    const auto corner = [&](double x, double y) {
      return hash_of(rest_of(x, columns), rest_of(y, rows), value(noise_seed) + octave);
    };
    const double above = corner(left, top) * (1 - across) + corner(left + 1, top) * across;
    const double below = corner(left, top + 1) * (1 - across) + corner(left + 1, top + 1) * across;
    return above * (1 - down) + below * down;
  }

  const Texture& t_;
  double i_, j_;
};

}  // namespace

std::uint64_t depth_word(const Texture& t, std::int64_t i, std::int64_t j) {
  const auto bytes = static_cast<std::size_t>(texel_layout(t.format).block_bytes);
  return Fields(std::span(t.raw).subspan(block_at(t.format, t.width, i, j), bytes)).take(1ULL << 32);
}

TexelCodes fetch_texel(const Texture& t, std::int64_t i, std::int64_t j) {
  if (t.format == TexelFormat::rgba8888) {
    const std::uint8_t* at = &t.rgba[static_cast<std::size_t>(4 * (j * t.width + i))];
    return {at[0], at[1], at[2], at[3]};
  }
  const TexelLayout layout = texel_layout(t.format);
  const std::span bytes = std::span(t.raw).subspan(block_at(t.format, t.width, i, j),
                                                   static_cast<std::size_t>(layout.block_bytes));
  const auto place = static_cast<std::uint64_t>(4 * (j % 4) + i % 4);  // in a block of 4 x 4
  const bool second = i % 2 == 1;                                      // of a pair
  Fields f(bytes.size() <= 2 ? bytes : bytes.first(0));
  const Pattern pattern(t, static_cast<double>(i), static_cast<double>(j));
  switch (t.format) {
    case TexelFormat::rgba8888:
      break;
    case TexelFormat::rgb332:
      return codes(from_332(f), 255);
    case TexelFormat::yiq422:
      return codes(from_yiq(f, t.table), 255);
    case TexelFormat::a8: {
      const double a = bytes[0];
      return codes({a, a, a}, a);
    }
    case TexelFormat::i8: {
      const double light = bytes[0];
      return codes({light, light, light}, 255);
    }
    case TexelFormat::ai44: {
      const double light = expanded(f.take(16), 16);
      return codes({light, light, light}, expanded(f.take(16), 16));
    }
    case TexelFormat::p8: {
      const auto [r, g, b, a] = from_palette(f.take(256), t.table);
      return codes({r, g, b}, a);
    }
    case TexelFormat::argb8332: {
      const Rgb c = from_332(f);
      return codes(c, static_cast<double>(f.take(256)));
    }
    case TexelFormat::rgb565:
      return codes(from_565(f.take(65536)), 255);
    case TexelFormat::argb1555: {
      const double b = expanded(f.take(32), 32);
      const double g = expanded(f.take(32), 32);
      const double r = expanded(f.take(32), 32);
      return codes({r, g, b}, expanded(f.take(2), 2));
    }
    case TexelFormat::argb4444: {
      const double b = expanded(f.take(16), 16);
      const double g = expanded(f.take(16), 16);
      const double r = expanded(f.take(16), 16);
      return codes({r, g, b}, expanded(f.take(16), 16));
    }
    case TexelFormat::ai88: {
      const auto light = static_cast<double>(f.take(256));
      return codes({light, light, light}, static_cast<double>(f.take(256)));
    }
    case TexelFormat::ap88: {
      const auto [r, g, b, a] = from_palette(f.take(256), t.table);
      return codes({r, g, b}, static_cast<double>(f.take(256)));
    }
    case TexelFormat::ayiq8422: {
      const Rgb c = from_yiq(f, t.table);
      return codes(c, static_cast<double>(f.take(256)));
    }
    case TexelFormat::dxt1: {
      const Block block = from_dxt_colors(bytes, place, false);
      return codes(block.color, block.clear ? 0 : 255);
    }
    case TexelFormat::dxt3:
      return codes(from_dxt_colors(bytes.subspan(8), place, true).color,
                   expanded(Fields(bytes.first(8)).nth(place, 16), 16));
    case TexelFormat::dxt5:
      return codes(from_dxt_colors(bytes.subspan(8), place, true).color,
                   from_dxt5_alphas(bytes.first(8), place));
    case TexelFormat::uyvy:
      return codes(from_yuv(bytes[second ? 3 : 1], bytes[0], bytes[2]), 255);
    case TexelFormat::yuyv:
      return codes(from_yuv(bytes[second ? 2 : 0], bytes[1], bytes[3]), 255);
    case TexelFormat::depth: {
      const double light = bytes[3];  // the word's top eight bits
      return codes({light, light, light}, 255);
    }
    case TexelFormat::checker:
      return pattern.checker();
    case TexelFormat::brick:
      return pattern.brick();
    case TexelFormat::noise:
      return pattern.noise();
  }
  unreachable();
}

}  // namespace bitspan::golden
