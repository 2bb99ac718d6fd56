// SPDX-License-Identifier: Apache-2.0
// Images that are not PNG. The expected texels of BMP, TGA, GIF and PNM are worked by hand from the formats'
// descriptions; JPEGs are written by libjpeg, and read again near what was written.
#include "scene/image_file.hpp"

#include <gtest/gtest.h>
#include <jpeglib.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "scene/texture.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Two texels red and a dark colour above two texels green and blue.
const Bytes four_texels{255, 0, 0, 255, 1, 2, 3, 255, 0, 255, 0, 255, 0, 0, 255, 255};

const Bytes bmp =
    bytes_of("BM") + Bytes{70, 0,   0,   0,   0,  0, 0, 0, 54, 0, 0, 0,               //
                           40, 0,   0,   0,   2,  0, 0, 0, 2,  0, 0, 0, 1, 0, 24, 0,  // 2 x 2, 24 bits
                           0,  0,   0,   0,   16, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0,  0, 0, 0, 0, 0,  //
                           0,  0,   0,   0,                                                       //
                           0,  255, 0,   255, 0,  0, 0, 0,  // the last row first
                           0,  0,   255, 3,   2,  1, 0, 0};

// 2 x 2, true colour with 8 bits of alpha, from the top left; plain and with run lengths.
Bytes tga(int type, const Bytes& data) {
  return Bytes{0, 0, static_cast<std::uint8_t>(type), 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 32, 0x28} + data;
}
const Bytes plain_tga = tga(2, {0, 0, 255, 255, 3, 2, 1, 255, 0, 255, 0, 255, 255, 0, 0, 77});
const Bytes packed_tga = tga(10, {0x82, 9, 8, 7, 6, 0x00, 3, 2, 1, 0});

const Bytes ppm = bytes_of("P6 # a comment\n2 2\n255\n") + Bytes{255, 0, 0, 1, 2, 3, 0, 255, 0, 0, 0, 255};
const Bytes pgm = bytes_of("P5\n3 1\n255\n") + Bytes{0, 7, 255};

// 2 x 2 with a palette of four colours; the codes 4, 0, 1, 2, 3, 5 as 3 bits each.
const Bytes gif = bytes_of("GIF89a") + Bytes{2,    0,    2,    0,    0x91, 0,   0, 255, 0, 0, 1,
                                             2,    3,    0,    255,  0,    0,   0, 255,           //
                                             0x2c, 0,    0,    0,    0,    2,   0, 2,   0, 0, 2,  //
                                             3,    0x44, 0x34, 0x05, 0,    0x3b};

TEST(ImageFile, ReadsFormatsWithoutLoss) {
  EXPECT_EQ(decode_texture(bmp, "t").rgba, four_texels);
  EXPECT_EQ(decode_texture(ppm, "t").rgba, four_texels);
  EXPECT_EQ(decode_texture(pgm, "t").rgba, (Bytes{0, 0, 0, 255, 7, 7, 7, 255, 255, 255, 255, 255}));
  EXPECT_EQ(decode_texture(plain_tga, "t").rgba,
            (Bytes{255, 0, 0, 255, 1, 2, 3, 255, 0, 255, 0, 255, 0, 0, 255, 77}));
  EXPECT_EQ(decode_texture(packed_tga, "t").rgba, (Bytes{7, 8, 9, 6, 7, 8, 9, 6, 7, 8, 9, 6, 1, 2, 3, 0}));
  EXPECT_EQ(decode_texture(gif, "t").rgba, four_texels);
  const Texture texture = decode_texture(pgm, "p.pgm");
  EXPECT_EQ(texture.name, "p.pgm");
  EXPECT_EQ(texture.width, 3);
  EXPECT_EQ(texture.height, 1);
}

// Through libjpeg: 32 x 24 texels, either way; of red, green and blue, or of four inks.
Bytes jpeg_of(const Bytes& pixels, bool progressive, int channels = 3) {
  jpeg_compress_struct c;
  jpeg_error_mgr errors;
  c.err = jpeg_std_error(&errors);
  jpeg_create_compress(&c);
  unsigned char* out = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&c, &out, &size);
  c.image_width = 32;
  c.image_height = 24;
  c.input_components = channels;
  c.in_color_space = channels == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&c);
  jpeg_set_quality(&c, 95, TRUE);
  if (progressive) jpeg_simple_progression(&c);
  jpeg_start_compress(&c, TRUE);
  const std::size_t pitch = 32 * static_cast<std::size_t>(channels);
  for (std::size_t y = 0; y < 24; ++y) {
    Bytes row(pixels.begin() + static_cast<std::ptrdiff_t>(pitch * y),
              pixels.begin() + static_cast<std::ptrdiff_t>(pitch * (y + 1)));
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&c, rows, 1);
  }
  jpeg_finish_compress(&c);
  Bytes file(out, out + size);
  std::free(out);
  jpeg_destroy_compress(&c);
  return file;
}

Bytes smooth_picture() {
  Bytes rgb;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      for (const int c : {8 * x, 10 * y, 255 - 4 * x - 5 * y}) rgb.push_back(static_cast<std::uint8_t>(c));
    }
  }
  return rgb;
}

TEST(ImageFile, ReadsJpegsNearWhatWasWritten) {
  const Bytes rgb = smooth_picture();
  for (const bool progressive : {false, true}) {
    const Texture t = decode_texture(jpeg_of(rgb, progressive), "t.jpg");
    ASSERT_EQ(t.width, 32);
    ASSERT_EQ(t.height, 24);
    for (std::size_t i = 0; i < 32 * 24; ++i) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(t.rgba[4 * i + c], rgb[3 * i + c], 16) << i;
      EXPECT_EQ(t.rgba[4 * i + 3], 255);
    }
  }
}

// Inks as Adobe stores them: 255 is no ink.
TEST(ImageFile, ReadsJpegsForPrint) {
  Bytes inks;
  for (int i = 0; i < 32 * 24; ++i) inks.insert(inks.end(), {200, 100, 50, 128});
  const Texture t = decode_texture(jpeg_of(inks, false, 4), "t.jpg");
  for (std::size_t i = 0; i < 32 * 24; ++i) {
    EXPECT_NEAR(t.rgba[4 * i], 100, 2);
    EXPECT_NEAR(t.rgba[4 * i + 1], 50, 2);
    EXPECT_NEAR(t.rgba[4 * i + 2], 25, 2);
    EXPECT_EQ(t.rgba[4 * i + 3], 255);
  }
}

TEST(ImageFile, RefusesEveryTruncation) {
  const Bytes jpeg = jpeg_of(smooth_picture(), false);
  for (const Bytes& whole : {bmp, ppm, pgm, plain_tga, packed_tga, jpeg}) {
    EXPECT_NO_THROW(decode_texture(whole, "t"));
    for (std::size_t length = 0; length < whole.size(); ++length) {
      EXPECT_THROW(decode_texture(std::span(whole).first(length), "t"), InputError)
          << length << " of " << whole.size();
    }
  }
}

TEST(ImageFile, ReadsOrRefusesFlippedBytes) {
  int refused = 0;
  for (const Bytes& whole : {bmp, ppm, pgm, plain_tga, packed_tga, gif, jpeg_of(smooth_picture(), true)}) {
    for (std::size_t at = 0; at < whole.size(); ++at) {
      for (const int flip : {0x01, 0x5a, 0x80, 0xff}) {
        Bytes broken = whole;
        broken[at] = static_cast<std::uint8_t>(broken[at] ^ flip);
        try {
          const Texture t = decode_texture(broken, "t");
          EXPECT_EQ(t.rgba.size(),
                    4 * static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height));
        } catch (const InputError&) {
          ++refused;
        }
      }
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(ImageFile, RefusesSizesBeyondTheLimitAndHollowOnes) {
  const auto error = [](const Bytes& file) { return input_error([&] { decode_texture(file, "t"); }); };
  EXPECT_NE(error(bytes_of("P5\n16385 1\n255\n") + Bytes(16385)).find("it has 16385 x 1 texels"),
            std::string::npos);
  EXPECT_EQ(decode_texture(bytes_of("P5\n16384 1\n255\n") + Bytes(16384), "t").width, 16384);
  EXPECT_NE(error(bytes_of("P5\n16384 16384\n255\n") + Bytes(100)).find("far too short"), std::string::npos);
  // The size in the frame header of a JPEG: behind the marker 0xc0, its length and the precision.
  Bytes jpeg = jpeg_of(smooth_picture(), false);
  const Bytes frame{0xff, 0xc0};
  const auto size = std::ranges::search(jpeg, frame).begin() + 5;
  for (const auto& [high, what] : {std::pair{0x40, "far too short"}, {0x41, "too large"}}) {
    size[0] = size[2] = static_cast<std::uint8_t>(high);
    size[1] = size[3] = 0;
    EXPECT_NE(error(jpeg).find(what), std::string::npos) << error(jpeg);
  }
  EXPECT_NE(error(bytes_of("P5\n1 1\n65535\n") + Bytes(2)).find("largest number is not 255"),
            std::string::npos);
}

}  // namespace
}  // namespace bitspan
