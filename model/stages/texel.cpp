// SPDX-License-Identifier: Apache-2.0
#include "model/stages/texel.hpp"

#include <algorithm>

namespace bitspan::model {
namespace {

using Color = std::array<int, 3>;

// The bits repeated from the top.
constexpr int repeat1(int c) { return -c & 255; }
constexpr int repeat2(int c) { return c << 6 | c << 4 | c << 2 | c; }
constexpr int repeat3(int c) { return c << 5 | c << 2 | c >> 1; }
constexpr int repeat4(int c) { return c << 4 | c; }
constexpr int repeat5(int c) { return c << 3 | c >> 2; }
constexpr int repeat6(int c) { return c << 2 | c >> 4; }

TexelCodes codes(const Color& c, int alpha) {
  const auto byte = [](int x) { return static_cast<std::uint8_t>(x); };
  return {byte(c[0]), byte(c[1]), byte(c[2]), byte(alpha)};
}
TexelCodes grey(int i, int alpha) { return codes({i, i, i}, alpha); }

Color rgb332(int w) { return {repeat3(w >> 5 & 7), repeat3(w >> 2 & 7), repeat2(w & 3)}; }
Color rgb565(int w) { return {repeat5(w >> 11 & 31), repeat6(w >> 5 & 63), repeat5(w & 31)}; }

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

}  // namespace

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
      return grey(repeat4(block[0] & 15), repeat4(block[0] >> 4));
    case TexelFormat::p8:
      return codes(of_palette(block[0], table), table[4 * std::size_t{block[0]} + 3]);
    case TexelFormat::argb8332:
      return codes(rgb332(block[0]), block[1]);
    case TexelFormat::rgb565:
      return codes(rgb565(word()), 255);
    case TexelFormat::argb1555: {
      const int w = word();
      return codes({repeat5(w >> 10 & 31), repeat5(w >> 5 & 31), repeat5(w & 31)}, repeat1(w >> 15));
    }
    case TexelFormat::argb4444: {
      const int w = word();
      return codes({repeat4(w >> 8 & 15), repeat4(w >> 4 & 15), repeat4(w & 15)}, repeat4(w >> 12));
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
      return codes(dxt_color(block + 8, place, true, clear), repeat4(nibble));
    }
    case TexelFormat::dxt5:
      return codes(dxt_color(block + 8, place, true, clear), dxt5_alpha(block, place));
    case TexelFormat::uyvy:
      return codes(yuv(block[i == 0 ? 1 : 3], block[0], block[2]), 255);
    case TexelFormat::yuyv:
      return codes(yuv(block[i == 0 ? 0 : 2], block[1], block[3]), 255);
  }
  unreachable();
}

}  // namespace bitspan::model
