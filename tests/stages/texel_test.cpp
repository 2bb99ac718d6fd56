// SPDX-License-Identifier: Apache-2.0
// Texel formats: values worked by hand, and golden against the model over every code.
#include "model/stages/texel.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <set>
#include <string>

#include "golden/texel.hpp"
#include "scene/procedural.hpp"
#include "scene/texels.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using Codes = std::array<std::uint8_t, 4>;
using Bytes = std::vector<std::uint8_t>;

constexpr std::array procedural_formats{TexelFormat::checker, TexelFormat::brick, TexelFormat::noise};

// Those whose texels lie in memory.
std::vector<TexelFormat> formats() {
  std::vector<TexelFormat> out;
  for (std::size_t f = 0; f < enum_names<TexelFormat>.size(); ++f) {
    if (!is_procedural(static_cast<TexelFormat>(f))) out.push_back(static_cast<TexelFormat>(f));
  }
  return out;
}

// Any table of the format.
std::vector<std::int16_t> random_table(TexelFormat format, std::mt19937_64& random) {
  std::vector<std::int16_t> out;
  const int size = texel_layout(format).table_size;
  for (int i = 0; i < size; ++i) {
    const bool is_signed = size == yiq_table_size && i >= 16;
    out.push_back(static_cast<std::int16_t>(static_cast<int>(random() % (is_signed ? 512 : 256)) -
                                            (is_signed ? 256 : 0)));
  }
  return out;
}

Texture texture_of(TexelFormat format, int width, int height, Bytes raw,
                   std::vector<std::int16_t> table = {}) {
  Texture t;
  t.name = "t";
  t.format = format;
  t.width = width;
  t.height = height;
  (format == TexelFormat::rgba8888 ? t.rgba : t.raw) = std::move(raw);
  t.table = std::move(table);
  EXPECT_TRUE(is_whole(t)) << to_string(format);
  return t;
}

// Texel (i, j) by both views.
Codes texel(const Texture& t, std::int64_t i = 0, std::int64_t j = 0) {
  const Codes by_model = model::texel_of(t, i, j);
  EXPECT_EQ(golden::fetch_texel(t, i, j), by_model) << to_string(t.format) << " at " << i << ", " << j;
  return by_model;
}
Codes texel(TexelFormat format, const Bytes& block, const std::vector<std::int16_t>& table = {}) {
  const TexelLayout layout = texel_layout(format);
  return texel(texture_of(format, layout.block_width, layout.block_height, block, table));
}

TEST(Texel, ByHand) {
  using F = TexelFormat;
  EXPECT_EQ(texel(F::rgba8888, {1, 2, 3, 4}), (Codes{1, 2, 3, 4}));
  EXPECT_EQ(texel(F::rgb332, {0b101'010'01}), (Codes{0b10110110, 0b01001001, 0b01010101, 255}));
  EXPECT_EQ(texel(F::a8, {77}), (Codes{77, 77, 77, 77}));
  EXPECT_EQ(texel(F::i8, {77}), (Codes{77, 77, 77, 255}));
  EXPECT_EQ(texel(F::depth, {1, 2, 3, 77}), (Codes{77, 77, 77, 255}));
  EXPECT_EQ(texel(F::ai44, {0x3c}), (Codes{0xcc, 0xcc, 0xcc, 0x33}));
  EXPECT_EQ(texel(F::argb8332, {0b101'010'01, 9}), (Codes{0b10110110, 0b01001001, 0b01010101, 9}));
  // The low byte first: 10011 100101 00110.
  EXPECT_EQ(texel(F::rgb565, {0b101'00110, 0b10011'100}), (Codes{0b10011100, 0b10010110, 0b00110001, 255}));
  EXPECT_EQ(texel(F::argb1555, {0b101'00110, 0b1'10011'10}),
            (Codes{0b10011100, 0b10101101, 0b00110001, 255}));
  EXPECT_EQ(texel(F::argb1555, {0, 0})[3], 0);
  EXPECT_EQ(texel(F::argb4444, {0x12, 0xfa}), (Codes{0xaa, 0x11, 0x22, 0xff}));
  EXPECT_EQ(texel(F::ai88, {5, 6}), (Codes{5, 5, 5, 6}));
  std::vector<std::int16_t> palette(palette_size, 1);
  palette[4 * 200] = 10;
  palette[4 * 200 + 1] = 20;
  palette[4 * 200 + 2] = 30;
  palette[4 * 200 + 3] = 40;
  EXPECT_EQ(texel(F::p8, {200}, palette), (Codes{10, 20, 30, 40}));
  EXPECT_EQ(texel(F::ap88, {200, 50}, palette), (Codes{10, 20, 30, 50}));
  std::vector<std::int16_t> yiq(yiq_table_size);
  yiq[9] = 100;
  yiq[16 + 3 * 2] = 30;
  yiq[16 + 3 * 2 + 1] = -120;
  yiq[28 + 3 * 3] = -5;
  yiq[28 + 3 * 3 + 2] = 200;
  EXPECT_EQ(texel(F::yiq422, {0x9b}, yiq), (Codes{125, 0, 255, 255}));
  EXPECT_EQ(texel(F::ayiq8422, {0x9b, 8}, yiq), (Codes{125, 0, 255, 8}));
  // White, black, and BT.601's red, of which blue is below 0.
  EXPECT_EQ(texel(F::yuyv, {235, 128, 16, 128}), (Codes{255, 255, 255, 255}));
  EXPECT_EQ(texel(texture_of(F::yuyv, 2, 1, {235, 128, 16, 128}), 1), (Codes{0, 0, 0, 255}));
  EXPECT_EQ(texel(F::uyvy, {90, 81, 240, 16}), (Codes{255, 0, 0, 255}));
}

// Mixes in blocks; colours 0b11111 = 255, 0b01000 = 66, 0b00100 = 33 of 5 bits.
TEST(Texel, DxtByHand) {
  using F = TexelFormat;
  const auto at = [](F format, const Bytes& block, std::int64_t i, std::int64_t j) {
    return texel(texture_of(format, 4, 4, block), i, j);
  };
  const std::uint16_t high = 31 << 11 | 4;
  const std::uint16_t low = 8 << 11 | 31;
  const auto colors = [](int first, int second) {
    return Bytes{static_cast<std::uint8_t>(first),
                 static_cast<std::uint8_t>(first >> 8),
                 static_cast<std::uint8_t>(second),
                 static_cast<std::uint8_t>(second >> 8),
                 0b11'10'01'00,
                 0b00'00'00'00,
                 0b11'11'11'11,
                 0b00'00'00'01};
  };
  EXPECT_EQ(at(F::dxt1, colors(high, low), 0, 0), (Codes{255, 0, 33, 255}));
  EXPECT_EQ(at(F::dxt1, colors(high, low), 1, 0), (Codes{66, 0, 255, 255}));
  EXPECT_EQ(at(F::dxt1, colors(high, low), 2, 0), (Codes{192, 0, 107, 255}));  // 576 / 3, 321 / 3
  EXPECT_EQ(at(F::dxt1, colors(high, low), 3, 0), (Codes{129, 0, 181, 255}));  // 387 / 3, 543 / 3
  EXPECT_EQ(at(F::dxt1, colors(high, low), 0, 3), (Codes{66, 0, 255, 255}));
  EXPECT_EQ(at(F::dxt1, colors(low, high), 2, 0), (Codes{160, 0, 144, 255}));  // 321 / 2, 288 / 2
  EXPECT_EQ(at(F::dxt1, colors(low, high), 3, 2), (Codes{0, 0, 0, 0}));
  Bytes block{0x10, 0x32, 0x54, 0x76, 0x98, 0xba, 0xdc, 0xfe};
  const Bytes with_colors = colors(low, high);
  block.insert(block.end(), with_colors.begin(), with_colors.end());
  EXPECT_EQ(at(F::dxt3, block, 3, 2), (Codes{192, 0, 107, 0xbb}));  // four colours all the same
  EXPECT_EQ(at(F::dxt3, block, 1, 0)[3], 0x11);
  // Codes of 3 bits from the low end: 0, 1, 2, 3, 4, 5, 6, 7, ...
  for (const bool falling : {true, false}) {
    block[0] = falling ? 240 : 30;
    block[1] = falling ? 30 : 240;
    const std::uint64_t codes = 0b111'110'101'100'011'010'001'000;
    for (std::size_t k = 0; k < 6; ++k) block[2 + k] = static_cast<std::uint8_t>(codes >> (8 * k));
    const std::array<int, 8> seven{240, 30, 210, 180, 150, 120, 90, 60};
    const std::array<int, 8> five{30, 240, 72, 114, 156, 198, 0, 255};
    for (std::int64_t k = 0; k < 8; ++k) {
      EXPECT_EQ(at(F::dxt5, block, k % 4, k / 4)[3], (falling ? seven : five)[static_cast<std::size_t>(k)]);
    }
  }
}

// All codes of the formats of at most 16 bits, with any tables.
TEST(Texel, GoldenEqualsTheModelOverEveryCode) {
  std::mt19937_64 random(1);
  std::size_t compared = 0;
  for (const TexelFormat format : formats()) {
    const TexelLayout layout = texel_layout(format);
    if (layout.block_bytes > 2) continue;
    const bool wide = layout.block_bytes == 2;
    Bytes raw;
    for (int code = 0; code < (wide ? 65536 : 256); ++code) {
      raw.push_back(static_cast<std::uint8_t>(code));
      if (wide) raw.push_back(static_cast<std::uint8_t>(code >> 8));
    }
    for (int round = 0; round < (layout.table_size == 0 ? 1 : 8); ++round) {
      const Texture t = texture_of(format, 256, wide ? 256 : 1, raw, random_table(format, random));
      for (int j = 0; j < t.height; ++j) {
        for (int i = 0; i < t.width; ++i, ++compared) {
          ASSERT_EQ(golden::fetch_texel(t, i, j), model::texel_of(t, i, j))
              << to_string(format) << " " << i << " " << j;
        }
      }
    }
  }
  EXPECT_EQ(compared, 256 * (4 + 2 * 8) + 65536 * (5 + 2 * 8));
}

TEST(Texel, GoldenEqualsTheModelOverRandomBlocks) {
  const int blocks = is_long_run() ? 1000000 : 20000;
  std::mt19937_64 random(2);
  for (const TexelFormat format :
       {TexelFormat::dxt1, TexelFormat::dxt3, TexelFormat::dxt5, TexelFormat::uyvy, TexelFormat::yuyv}) {
    const TexelLayout layout = texel_layout(format);
    int clear = 0;
    for (int n = 0; n < blocks; ++n) {
      Bytes block;
      for (int k = 0; k < layout.block_bytes; ++k) block.push_back(static_cast<std::uint8_t>(random()));
      const std::size_t colors = block.size() - 8;
      if (layout.block_width == 4 && n % 8 == 0) {  // both the same
        block[colors + 2] = block[colors];
        block[colors + 3] = block[colors + 1];
        block[1] = n % 16 == 0 ? block[0] : block[1];
      }
      const Texture t = texture_of(format, layout.block_width, layout.block_height, block);
      for (int j = 0; j < layout.block_height; ++j) {
        for (int i = 0; i < layout.block_width; ++i) {
          const Codes c = model::texel_of(t, i, j);
          ASSERT_EQ(golden::fetch_texel(t, i, j), c) << to_string(format) << " block " << n;
          clear += c[3] == 0 ? 1 : 0;
        }
      }
    }
    if (layout.block_width == 4) {
      EXPECT_GT(clear, blocks / 100) << to_string(format);
    }
  }
}

// Blocks and pairs that reach beyond the texture.
TEST(Texel, TexturesOfAnySizeAreFetchedFromTheirBlocks) {
  std::mt19937_64 random(3);
  for (const TexelFormat format : formats()) {
    for (const auto& [width, height] : {std::pair{1, 1}, {5, 3}, {7, 9}, {8, 4}}) {
      Bytes raw(raw_size(format, width, height));
      for (std::uint8_t& byte : raw) byte = static_cast<std::uint8_t>(random());
      const Texture t = texture_of(format, width, height, raw, random_table(format, random));
      for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) texel(t, i, j);
      }
    }
  }
  EXPECT_EQ(raw_size(TexelFormat::dxt1, 5, 3), 16U);
  EXPECT_EQ(raw_size(TexelFormat::dxt5, 5, 5), 64U);
  EXPECT_EQ(raw_size(TexelFormat::uyvy, 3, 2), 16U);
  EXPECT_EQ(raw_size(TexelFormat::rgb565, 3, 2), 12U);
}

Texture image(int width, int height, std::mt19937_64& random) {
  Bytes rgba(raw_size(TexelFormat::rgba8888, width, height));
  for (std::uint8_t& byte : rgba) byte = static_cast<std::uint8_t>(random());
  return texture_of(TexelFormat::rgba8888, width, height, rgba);
}

// By channels: half a step of the format, and what is representable comes back as it was.
TEST(Texel, ConvertedImagesAreTheNearest) {
  struct Steps {
    TexelFormat format;
    Codes bits;
  };
  std::mt19937_64 random(4);
  const Texture from = image(61, 7, random);
  for (const auto& [format, bits] : {Steps{TexelFormat::rgb332, {3, 3, 2, 0}},
                                     {TexelFormat::argb8332, {3, 3, 2, 8}},
                                     {TexelFormat::rgb565, {5, 6, 5, 0}},
                                     {TexelFormat::argb1555, {5, 5, 5, 1}},
                                     {TexelFormat::argb4444, {4, 4, 4, 4}}}) {
    const Texture t = converted(from, format, {});
    EXPECT_TRUE(is_whole(t));
    Texture back = from;
    for (int j = 0; j < t.height; ++j) {
      for (int i = 0; i < t.width; ++i) {
        const Codes want = model::texel_of(from, i, j);
        const Codes got = model::texel_of(t, i, j);
        for (std::size_t c = 0; c < 4; ++c) {
          if (bits[c] == 0) {
            EXPECT_EQ(got[c], 255);
          } else {
            EXPECT_LE(std::abs(want[c] - got[c]), 127.5 / ((1 << bits[c]) - 1) + 1) << to_string(format);
          }
          back.rgba[static_cast<std::size_t>(4 * (j * t.width + i)) + c] = got[c];
        }
      }
    }
    EXPECT_EQ(converted(back, format, {}).raw, t.raw) << to_string(format);
  }
}

TEST(Texel, ConvertedImagesWithTablesTakeTheNearestEntry) {
  std::mt19937_64 random(5);
  const Texture from = image(17, 5, random);
  for (const TexelFormat format :
       {TexelFormat::p8, TexelFormat::ap88, TexelFormat::yiq422, TexelFormat::ayiq8422}) {
    const std::vector<std::int16_t> table = random_table(format, random);
    const Texture t = converted(from, format, table);
    const std::size_t channels = format == TexelFormat::p8 ? 4 : 3;
    const auto distance = [&](const Codes& a, const Codes& b) {
      int sum = 0;
      for (std::size_t c = 0; c < channels; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
      return sum;
    };
    for (int i = 0; i < t.width; ++i) {
      const Codes want = model::texel_of(from, i, 2);
      const int got = distance(want, model::texel_of(t, i, 2));
      for (int code = 0; code < 256; ++code) {
        const std::array<std::uint8_t, 2> entry{static_cast<std::uint8_t>(code), want[3]};
        EXPECT_LE(got, distance(want, model::decode(format, entry.data(), 0, 0, table)));
      }
      if (channels == 3 && texel_layout(format).block_bytes == 2) {
        EXPECT_EQ(model::texel_of(t, i, 2)[3], want[3]);
      }
    }
  }
  // An image of few colours is its own palette, without loss.
  const Texture few = image(16, 16, random);
  const Texture exact = converted(few, TexelFormat::p8, {});
  for (int i = 0; i < 16; ++i) EXPECT_EQ(texel(exact, i, 9), texel(few, i, 9));
  EXPECT_NE(input_error([&] { converted(image(17, 16, random), TexelFormat::p8, {}); }).find("more than 256"),
            std::string::npos);
  EXPECT_NE(input_error([&] { converted(few, TexelFormat::yiq422, {}); }).find("has 0 values; expected 40"),
            std::string::npos);
}

TEST(Texel, ConvertedBlocksKeepWhatTheyCanHold) {
  using F = TexelFormat;
  // Two colours of rgb565, and a hole.
  Bytes rgba;
  for (int k = 0; k < 16; ++k) {
    const Codes c = k == 5       ? Codes{9, 9, 9, 0}
                    : k % 3 == 0 ? Codes{255, 130, 66, 255}
                                 : Codes{33, 65, 0, 255};
    rgba.insert(rgba.end(), c.begin(), c.end());
  }
  const Texture from = texture_of(F::rgba8888, 4, 4, rgba);
  for (const F format : {F::dxt1, F::dxt3, F::dxt5}) {
    const Texture t = converted(from, format, {});
    EXPECT_TRUE(is_whole(t));
    for (int k = 0; k < 16; ++k) {
      const Codes want = texel(from, k % 4, k / 4);
      const Codes got = texel(t, k % 4, k / 4);
      EXPECT_EQ(got[3], want[3]) << to_string(format) << k;
      if (k != 5 && format == F::dxt1) {
        EXPECT_EQ(got, want) << to_string(format) << k;
      }
    }
  }
  for (const F format : {F::uyvy, F::yuyv}) {
    const Texture grey = texture_of(F::rgba8888, 3, 1, {0, 0, 0, 255, 255, 255, 255, 255, 90, 90, 90, 255});
    const Texture t = converted(grey, format, {});
    EXPECT_TRUE(is_whole(t));
    for (int i = 0; i < 3; ++i) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(texel(t, i)[c], texel(grey, i)[c], 1) << i;
    }
  }
  for (const F format : {F::a8, F::i8, F::ai44, F::ai88}) {
    const Texture t = converted(texture_of(F::rgba8888, 1, 1, {100, 100, 100, 51}), format, {});
    const Codes c = texel(t);
    EXPECT_EQ(c[3], format == F::i8 ? 255 : 51) << to_string(format);
    EXPECT_EQ(c[0], format == F::a8 ? 51 : format == F::ai44 ? 102 : 100) << to_string(format);
  }
}

// ---- Procedural textures

// The specification's hash, in 64 bits with remainders.
int hash(std::uint64_t x, std::uint64_t y, std::uint64_t seed) {
  constexpr std::uint64_t word = std::uint64_t{1} << 32;
  std::uint64_t n = (x * 1640531 + y * 1274127 + seed * 1013901 + 668265) % word;
  for (const std::uint64_t factor : {1597335, 2018697, 1394573}) n = (n ^ n / 32768) * factor % word;
  return static_cast<int>(n / 16777216);
}

Texture pattern(TexelFormat format, int width, int height, const std::vector<int>& values) {
  std::vector<std::int16_t> table{10, 20, 30, 255, 110, 220, 130, 0};
  for (const int value : values) table.push_back(static_cast<std::int16_t>(value));
  return texture_of(format, width, height, {}, table);
}

TEST(Procedural, CheckerByHand) {
  const Texture t = pattern(TexelFormat::checker, 16, 16, {3, 5});
  const Codes first{10, 20, 30, 255}, second{110, 220, 130, 0};
  EXPECT_EQ(texel(t, 0, 0), first);
  EXPECT_EQ(texel(t, 2, 4), first);
  EXPECT_EQ(texel(t, 3, 4), second);
  EXPECT_EQ(texel(t, 3, 5), first);
  EXPECT_EQ(texel(t, 0, 5), second);
  EXPECT_EQ(texel(t, 15, 15), first);
}

TEST(Procedural, BricksByHand) {
  EXPECT_EQ(hash(0, 0, 0), 189);  // as another program has it
  EXPECT_EQ(hash(2, 3, 5), 112);
  EXPECT_EQ(hash(16383, 16383, 32767), 228);
  // Bricks of 8 x 4 texels, joints of one texel, each second row shifted by 3.
  const Texture plain = pattern(TexelFormat::brick, 16, 12, {8, 4, 1, 3, 0, 5});
  const Codes brick{10, 20, 30, 255}, mortar{110, 220, 130, 0};
  EXPECT_EQ(texel(plain, 1, 1), brick);
  EXPECT_EQ(texel(plain, 0, 1), mortar);
  EXPECT_EQ(texel(plain, 8, 1), mortar);
  EXPECT_EQ(texel(plain, 3, 0), mortar);
  EXPECT_EQ(texel(plain, 5, 5), mortar);  // 5 + 3 = 8
  EXPECT_EQ(texel(plain, 0, 5), brick);
  EXPECT_EQ(texel(plain, 8, 9), mortar);  // the third row is not shifted
  // Darker by floor(c vary hash / 65536), alpha as it is. Column 1 of row 2.
  const Texture varied = pattern(TexelFormat::brick, 16, 12, {8, 4, 1, 3, 255, 5});
  const int share = 255 * hash(1, 2, 5);
  const auto darker = [&](int c) { return static_cast<std::uint8_t>(c - c * share / 65536); };
  EXPECT_EQ(texel(varied, 9, 9), (Codes{darker(10), darker(20), darker(30), 255}));
  EXPECT_LT(darker(30), 30);
  // Row 1 is shifted out of the texture: its last brick is column 2 of two, which is 0.
  const int first = 255 * hash(0, 1, 5);
  EXPECT_EQ(texel(varied, 14, 5)[2], 30 - 30 * first / 65536);
}

TEST(Procedural, NoiseByHand) {
  const auto mixed = [](int from, int to, int t) {
    return static_cast<std::uint8_t>((from * (255 - t) + to * t + 127) / 255);
  };
  // Cells of one texel: the hash itself.
  const Texture dots = pattern(TexelFormat::noise, 4, 4, {0, 1, 9});
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(texel(dots, i, j)[1],
                mixed(20, 220, hash(static_cast<unsigned>(i), static_cast<unsigned>(j), 9)));
    }
  }
  // Cells of four texels; corners 244, 248 and 224, 73. Texel (1, 2): (3 244 + 248) / 4 = 245 above,
  // (3 224 + 73) / 4 = 186.25 below, 215.625 between.
  const Texture smooth = pattern(TexelFormat::noise, 8, 8, {2, 1, 9});
  EXPECT_EQ(texel(smooth, 0, 0)[1], mixed(20, 220, 244));
  EXPECT_EQ(texel(smooth, 1, 2)[1], mixed(20, 220, 215));
  // A lattice of one column and one row: each corner is the same, so that the texture repeats without a seam.
  const Texture flat = pattern(TexelFormat::noise, 4, 4, {2, 1, 9});
  EXPECT_EQ(texel(flat, 3, 3)[1], mixed(20, 220, 244));
  // Two octaves: twice the coarse one and once the fine one, of the next seed, over three.
  const Texture two = pattern(TexelFormat::noise, 8, 8, {2, 2, 9});
  const int above =
      (hash(0, 1, 10) + hash(1, 1, 10)) / 2;  // cells of two texels: (1, 2) lies between two corners
  EXPECT_EQ(texel(two, 1, 2)[1], mixed(20, 220, (2 * 215 + above) / 3));
}

// Any legal table, textures of any size: every texel.
TEST(Procedural, GoldenEqualsTheModel) {
  const std::uint64_t seed = 11;
  Random random(seed);
  std::size_t compared = 0, colors = 0;
  for (int n = 0; n < 300; ++n) {
    const TexelFormat format = procedural_formats[static_cast<std::size_t>(n % 3)];
    const Texture t = random_procedural(random, format, static_cast<int>(random.integer(1, 90)),
                                        static_cast<int>(random.integer(1, 90)));
    std::set<Codes> seen;
    for (int j = 0; j < t.height; ++j) {
      for (int i = 0; i < t.width; ++i, ++compared) {
        const Codes c = model::texel_of(t, i, j);
        ASSERT_EQ(golden::fetch_texel(t, i, j), c)
            << to_string(format) << " seed " << seed << " texture " << n << " at " << i << ", " << j;
        seen.insert(c);
      }
    }
    colors += seen.size();
  }
  EXPECT_GT(compared, 300000U);
  EXPECT_GT(colors, 5000U);
  // The largest of everything.
  for (const TexelFormat format : procedural_formats) {
    const std::vector<int> largest = format == TexelFormat::checker ? std::vector<int>{16384, 16384}
                                     : format == TexelFormat::brick
                                         ? std::vector<int>{16384, 16384, 1, 16384, 255, 32767}
                                         : std::vector<int>{14, 15, 32767};
    const Texture t = pattern(format, 16384, 16384, largest);
    for (int k = 0; k < 20000; ++k) texel(t, random.integer(0, 16383), random.integer(0, 16383));
  }
}

// Neighbours, and seeds, tell nothing of each other; every code comes about as often.
TEST(Procedural, TheHashScatters) {
  std::array<int, 256> count{};
  double same_row = 0, same_column = 0, seeds = 0, square = 0;
  for (unsigned y = 0; y < 256; ++y) {
    for (unsigned x = 0; x < 256; ++x) {
      const double here = hash(x, y, 0) - 127.5;
      ++count[static_cast<std::size_t>(hash(x, y, 0))];
      square += here * here;
      same_row += here * (hash(x + 1, y, 0) - 127.5);
      same_column += here * (hash(x, y + 1, 0) - 127.5);
      seeds += here * (hash(x, y, 1) - 127.5);
    }
  }
  for (const double sum : {same_row, same_column, seeds}) EXPECT_LT(std::fabs(sum), 0.02 * square);
  for (const int n : count) EXPECT_NEAR(n, 256, 80);  // five standard deviations
}

}  // namespace
}  // namespace bitspan
