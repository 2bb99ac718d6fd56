// SPDX-License-Identifier: Apache-2.0
#include "model/stages/texel.hpp"

#include <algorithm>

namespace bitspan::model {
namespace {

using Color = std::array<int, 3>;

TexelCodes codes(const Color& c, int alpha) {
  const auto byte = [](int x) { return static_cast<std::uint8_t>(x); };
  return {byte(c[0]), byte(c[1]), byte(c[2]), byte(alpha)};
}
TexelCodes grey(int i, int alpha) { return codes({i, i, i}, alpha); }

Color rgb332(int w) { return {repeated(w >> 5 & 7, 3), repeated(w >> 2 & 7, 3), repeated(w & 3, 2)}; }
Color rgb565(int w) { return {repeated(w >> 11 & 31, 5), repeated(w >> 5 & 63, 6), repeated(w & 31, 5)}; }

Color yiq(int w, std::span<const std::int16_t> table) {
  const int y = table[static_cast<std::size_t>(w >> 4 & 15)];
  const auto of_i = 16 + 3 * static_cast<std::size_t>(w >> 2 & 3);
  const auto of_q = 28 + 3 * static_cast<std::size_t>(w & 3);
  Color out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = std::clamp(y + table[of_i + c] + table[of_q + c], 0, 255);
  return out;
}

Color of_palette(int w, std::span<const std::int16_t> table) {
  const std::int16_t* entry = &table[4 * static_cast<std::size_t>(w & 255)];
  return {entry[0], entry[1], entry[2]};
}

Color yuv(int y, int u, int v) {
  const int light = 298 * (y - 16) + 128;
  u -= 128;
  v -= 128;
  const auto code = [](int x) { return std::clamp(x >> 8, 0, 255); };
  return {code(light + 409 * v), code(light - 100 * u - 208 * v), code(light + 516 * u)};
}

std::uint64_t low_first(const std::uint8_t* bytes, int count) {
  std::uint64_t out = 0;
  for (int k = count; k-- > 0;) out = out << 8 | bytes[k];
  return out;
}

// The colour of a code; keeps says that the block has four colours whatever the order of its two.
Color dxt_color(const std::uint8_t* p, int place, bool keeps, bool& clear) {
  const int first = p[0] | p[1] << 8;
  const int second = p[2] | p[3] << 8;
  const int code = static_cast<int>(low_first(p + 4, 4) >> (2 * place) & 3);
  const Color a = rgb565(first);
  const Color b = rgb565(second);
  clear = false;
  if (code < 2) return code == 0 ? a : b;
  const bool four = keeps || first > second;
  clear = !four && code == 3;
  if (clear) return {};
  Color out{};
  for (std::size_t c = 0; c < 3; ++c) {
    out[c] = !four ? (a[c] + b[c]) >> 1 : (code == 2 ? 2 * a[c] + b[c] : a[c] + 2 * b[c]) / 3;
  }
  return out;
}

int dxt5_alpha(const std::uint8_t* p, int place) {
  const int first = p[0];
  const int second = p[1];
  const int code = static_cast<int>(low_first(p + 2, 6) >> (3 * place) & 7);
  if (code < 2) return code == 0 ? first : second;
  if (first > second) return (first * (8 - code) + second * (code - 1)) / 7;
  if (code >= 6) return code == 6 ? 0 : 255;
  return (first * (6 - code) + second * (code - 1)) / 5;
}

// ---- Procedural textures

std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t n = 1640531U * x + 1274127U * y + 1013901U * seed + 668265U;
  for (const std::uint32_t factor : {1597335U, 2018697U, 1394573U}) n = (n ^ n >> 15) * factor;
  return n >> 24;
}

// t of 255 parts of the second colour.
TexelCodes mixed(std::span<const std::int16_t> table, int t) {
  TexelCodes out{};
  for (std::size_t c = 0; c < 4; ++c) {
    out[c] = static_cast<std::uint8_t>((table[c] * (255 - t) + table[4 + c] * t + 127) / 255);
  }
  return out;
}

TexelCodes brick(const Texture& texture, int i, int j) {
  const std::span<const std::int16_t> v(texture.table);
  const int row = j / v[brick_height];
  const int along = (row & 1) != 0 ? i + v[brick_shift] : i;
  if (along % v[brick_width] < v[brick_mortar] || j % v[brick_height] < v[brick_mortar]) return mixed(v, 255);
  const int columns = (texture.width + v[brick_width] - 1) / v[brick_width];
  const auto column = static_cast<std::uint32_t>(along / v[brick_width] % columns);
  const int darker = v[brick_vary] * static_cast<int>(hash(column, static_cast<std::uint32_t>(row),
                                                           static_cast<std::uint32_t>(v[brick_seed])));
  TexelCodes out = mixed(v, 0);
  for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(out[c] - (out[c] * darker >> 16));
  return out;
}

// Whole codes of one octave: its cells are 2^log2_cell texels wide.
int octave_of_noise(const Texture& texture, int i, int j, int log2_cell, std::uint32_t seed) {
  const int cell = 1 << log2_cell;
  const int columns = (texture.width + cell - 1) >> log2_cell;
  const int rows = (texture.height + cell - 1) >> log2_cell;
  const int x = i >> log2_cell;
  const int y = j >> log2_cell;
  const std::int64_t right = i & (cell - 1);
  const std::int64_t down = j & (cell - 1);
  const auto corner = [&](int dx, int dy) -> std::int64_t {
    return hash(static_cast<std::uint32_t>((x + dx) % columns), static_cast<std::uint32_t>((y + dy) % rows),
                seed);
  };
  const std::int64_t above = corner(0, 0) * (cell - right) + corner(1, 0) * right;
  const std::int64_t below = corner(0, 1) * (cell - right) + corner(1, 1) * right;
  return static_cast<int>((above * (cell - down) + below * down) >> (2 * log2_cell));
}

TexelCodes noise(const Texture& texture, int i, int j) {
  const std::span<const std::int16_t> v(texture.table);
  int sum = 0;
  for (int octave = 0; octave < v[noise_octaves]; ++octave) {
    const auto seed = static_cast<std::uint32_t>(v[noise_seed] + octave);
    sum = 2 * sum + octave_of_noise(texture, i, j, v[noise_cell] - octave, seed);
  }
  return mixed(v, sum / ((1 << v[noise_octaves]) - 1));
}

}  // namespace

TexelCodes computed_texel(const Texture& texture, std::int64_t i64, std::int64_t j64) {
  const auto i = static_cast<int>(i64);
  const auto j = static_cast<int>(j64);
  const std::vector<std::int16_t>& v = texture.table;
  if (texture.format == TexelFormat::brick) return brick(texture, i, j);
  if (texture.format == TexelFormat::noise) return noise(texture, i, j);
  return mixed(v, ((i / v[checker_width] + j / v[checker_height]) & 1) != 0 ? 255 : 0);
}

TexelCodes decode(TexelFormat format, const std::uint8_t* block, int i, int j,
                  std::span<const std::int16_t> table) {
  const auto word = [&] { return block[0] | block[1] << 8; };
  const int place = 4 * j + i;
  bool clear = false;
  switch (format) {
    case TexelFormat::rgba8888:
      return {block[0], block[1], block[2], block[3]};
    case TexelFormat::rgb332:
      return codes(rgb332(block[0]), 255);
    case TexelFormat::yiq422:
      return codes(yiq(block[0], table), 255);
    case TexelFormat::a8:
      return grey(block[0], block[0]);
    case TexelFormat::i8:
      return grey(block[0], 255);
    case TexelFormat::ai44:
      return grey(repeated(block[0] & 15, 4), repeated(block[0] >> 4, 4));
    case TexelFormat::p8:
      return codes(of_palette(block[0], table), table[4 * std::size_t{block[0]} + 3]);
    case TexelFormat::argb8332:
      return codes(rgb332(block[0]), block[1]);
    case TexelFormat::rgb565:
      return codes(rgb565(word()), 255);
    case TexelFormat::argb1555: {
      const int w = word();
      return codes({repeated(w >> 10 & 31, 5), repeated(w >> 5 & 31, 5), repeated(w & 31, 5)},
                   repeated(w >> 15, 1));
    }
    case TexelFormat::argb4444: {
      const int w = word();
      return codes({repeated(w >> 8 & 15, 4), repeated(w >> 4 & 15, 4), repeated(w & 15, 4)},
                   repeated(w >> 12, 4));
    }
    case TexelFormat::ai88:
      return grey(block[0], block[1]);
    case TexelFormat::ap88:
      return codes(of_palette(block[0], table), block[1]);
    case TexelFormat::ayiq8422:
      return codes(yiq(block[0], table), block[1]);
    case TexelFormat::dxt1: {
      const Color c = dxt_color(block, place, false, clear);
      return codes(c, clear ? 0 : 255);
    }
    case TexelFormat::dxt3: {
      const int nibble = static_cast<int>(low_first(block, 8) >> (4 * place) & 15);
      return codes(dxt_color(block + 8, place, true, clear), repeated(nibble, 4));
    }
    case TexelFormat::dxt5:
      return codes(dxt_color(block + 8, place, true, clear), dxt5_alpha(block, place));
    case TexelFormat::uyvy:
      return codes(yuv(block[i == 0 ? 1 : 3], block[0], block[2]), 255);
    case TexelFormat::yuyv:
      return codes(yuv(block[i == 0 ? 0 : 2], block[1], block[3]), 255);
    case TexelFormat::depth:
      return grey(static_cast<int>(low_first(block, 4) >> 24), 255);
    case TexelFormat::checker:
    case TexelFormat::brick:
    case TexelFormat::noise:
      break;
  }
  unreachable();
}

}  // namespace bitspan::model
