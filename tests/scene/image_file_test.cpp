// SPDX-License-Identifier: Apache-2.0
// Images that are not PNG. The expected texels of BMP, TGA, GIF and PNM are worked by hand from the formats'
// descriptions; JPEGs are written by libjpeg, and read again near what was written.
#include "scene/image_file.hpp"

#include <gtest/gtest.h>
#include <jpeglib.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "scene/texture.hpp"
#include "tests/scene/image_samples.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

Bytes texels(const Bytes& file) { return decode_texture(file, "t").rgba; }

// The error of a file that must be refused.
std::string refusal(const Bytes& file) {
  return input_error([&] { decode_texture(file, "t"); });
}

// Two texels red and a dark colour above two texels green and blue.
const Bytes four_texels{255, 0, 0, 255, 1, 2, 3, 255, 0, 255, 0, 255, 0, 0, 255, 255};

// The last row first.
const Bytes bmp =
    Bmp{.width = 2, .height = 2, .data = {0, 255, 0, 255, 0, 0, 0, 0, 0, 0, 255, 3, 2, 1, 0, 0}};

// With 8 bits of alpha, from the top left; plain and with run lengths, of which one goes on in the second
// row.
const Bytes plain_tga = Tga{.bits = 32,
                            .height = 2,
                            .descriptor = 0x28,
                            .data = {0, 0, 255, 255, 3, 2, 1, 255, 0, 255, 0, 255, 255, 0, 0, 77}};
const Bytes packed_tga = Tga{
    .type = 10, .bits = 32, .height = 2, .descriptor = 0x28, .data = {0x82, 9, 8, 7, 6, 0x00, 3, 2, 1, 0}};

const Bytes ppm = bytes_of("P6 # a comment\n2 2\n255\n") + Bytes{255, 0, 0, 1, 2, 3, 0, 255, 0, 0, 0, 255};
const Bytes pgm = bytes_of("P5\n3 1\n255\n") + Bytes{0, 7, 255};

// Of the colours of four_texels.
const Bytes gif_palette{255, 0, 0, 1, 2, 3, 0, 255, 0, 0, 0, 255};
const Bytes gif = Gif{.palette = gif_palette, .indices = {0, 1, 2, 3}};

TEST(ImageFile, ReadsFormatsWithoutLoss) {
  EXPECT_EQ(texels(bmp), four_texels);
  EXPECT_EQ(texels(ppm), four_texels);
  EXPECT_EQ(texels(pgm), (Bytes{0, 0, 0, 255, 7, 7, 7, 255, 255, 255, 255, 255}));
  EXPECT_EQ(texels(plain_tga), (Bytes{255, 0, 0, 255, 1, 2, 3, 255, 0, 255, 0, 255, 0, 0, 255, 77}));
  EXPECT_EQ(texels(packed_tga), (Bytes{7, 8, 9, 6, 7, 8, 9, 6, 7, 8, 9, 6, 1, 2, 3, 0}));
  EXPECT_EQ(texels(gif), four_texels);
  const Texture texture = decode_texture(pgm, "p.pgm");
  EXPECT_EQ(texture.name, "p.pgm");
  EXPECT_EQ(texture.width, 3);
  EXPECT_EQ(texture.height, 1);
}

TEST(ImageFile, ReadsBmpsFromTheTopDown) {
  const Bytes file = Bmp{.height = -2, .data = {0, 0, 255, 0, 255, 0, 0, 0}};
  EXPECT_EQ(decode_texture(file, "t").height, 2);
  EXPECT_EQ(texels(file), (Bytes{255, 0, 0, 255, 0, 0, 255, 255}));
}

// Four runs of the program gave four pictures: the palette behind its end was memory that nobody wrote.
TEST(ImageFile, AnIndexThatThePaletteDoesNotHaveIsBlack) {
  const Bytes black{0, 0, 0, 255};
  EXPECT_EQ(texels(Bmp{.width = 4,
                       .bits = 8,
                       .colors = 2,
                       .palette = {10, 20, 30, 0, 40, 50, 60, 0},
                       .data = {0, 1, 2, 255}}),
            (Bytes{30, 20, 10, 255, 60, 50, 40, 255} + black + black));
  // Two colours, whatever the header says: the texels follow.
  EXPECT_EQ(
      texels(
          Bmp{.width = 4, .bits = 4, .palette = {10, 20, 30, 0, 40, 50, 60, 0}, .data = {0x1f, 0x20, 0, 0}}),
      (Bytes{60, 50, 40, 255} + black + black + Bytes{30, 20, 10, 255}));
  EXPECT_EQ(
      texels(Tga{
          .type = 1, .bits = 8, .width = 4, .first = 5, .palette = {3, 2, 1, 6, 5, 4}, .data = {4, 5, 6, 7}}),
      (black + Bytes{1, 2, 3, 255, 4, 5, 6, 255} + black));
  Bytes two_colors = Gif{.palette = gif_palette, .indices = {0, 1, 2, 3}};
  two_colors[10] = 0x90;
  two_colors.erase(two_colors.begin() + 13 + 6, two_colors.begin() + 13 + 12);
  EXPECT_EQ(texels(two_colors), (Bytes{255, 0, 0, 255, 1, 2, 3, 255} + black + black));
}

TEST(ImageFile, ReadsPalettesOfThreeBytes) {
  EXPECT_EQ(texels(Bmp{
                .header = 12, .width = 2, .bits = 1, .palette = {1, 2, 3, 4, 5, 6}, .data = {0x40, 0, 0, 0}}),
            (Bytes{3, 2, 1, 255, 6, 5, 4, 255}));
}

TEST(ImageFile, ReadsRunLengthsOfBmps) {
  Bmp file{.width = 4, .height = 3, .bits = 8, .compression = 1, .colors = 4};
  file.palette = {0, 0, 0, 0, 1, 1, 1, 0, 2, 2, 2, 0, 3, 3, 3, 0};
  // From below: 1 1 2 3 (a run, and two one by one); onward to column 2 of the top row: 3 3; the end.
  file.data = {2, 1, 1, 2, 1, 3, 0, 0, 0, 2, 2, 1, 2, 3, 0, 1};
  const auto greys = [](const Bytes& codes) {
    Bytes out;
    for (const std::uint8_t c : codes) out = out + Bytes{c, c, c, 255};
    return out;
  };
  EXPECT_EQ(texels(file), greys({0, 0, 3, 3, 0, 0, 0, 0, 1, 1, 2, 3}));
  file.data = {2, 1, 0, 3, 1, 2, 3, 0};  // a run leaves the row
  EXPECT_TRUE(names(refusal(file), "corrupt BMP: a run leaves the picture"));
  file.data = {4, 1, 0, 2, 0, 3, 0, 1};  // onward to behind the last row: nothing is drawn there
  EXPECT_EQ(texels(file), greys({0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1}));
  file.data = {0, 2, 0, 4, 0, 1};
  EXPECT_TRUE(names(refusal(file), "a run leaves the picture"));
  file.bits = 4;
  file.compression = 2;
  file.data = {3, 0x12, 0, 0, 0, 3, 0x12, 0x30, 0, 0, 4, 0x33, 0, 1};
  EXPECT_EQ(texels(file), greys({3, 3, 3, 3, 1, 2, 3, 0, 1, 2, 1, 0}));
  file.height = -3;
  EXPECT_TRUE(names(refusal(file), "from the top down"));
  // Codes one by one are filled to a whole number of words: five of 4 bits take four bytes.
  file.width = 5;
  file.height = 2;
  file.data = {0, 5, 0x12, 0x31, 0x20, 0x77, 0, 0, 5, 0x33, 0, 1};
  EXPECT_EQ(texels(file), greys({3, 3, 3, 3, 3, 1, 2, 3, 1, 2}));
}

TEST(ImageFile, ReadsBmpsOfAnyMasks) {
  // 10 bits of red, green and blue, 2 of alpha: 513/1023 and 1/1023 of 255 are 127.9 and 0.2.
  const Bytes masks = u32(0x3ff00000) + u32(0xffc00) + u32(0x3ff) + u32(0xc0000000);
  const Bytes texel = u32(2U << 30 | 513U << 20 | 1023U << 10 | 1);
  EXPECT_EQ(texels(Bmp{.header = 56, .bits = 32, .compression = 3, .masks = masks, .data = texel}),
            (Bytes{128, 255, 0, 170}));
  // Without an alpha mask alpha is 255, whatever the fourth byte is.
  EXPECT_EQ(texels(Bmp{.bits = 32,
                       .compression = 3,
                       .masks = u32(0xff) + u32(0xff00) + u32(0xff0000),
                       .data = {1, 2, 3, 4}}),
            (Bytes{1, 2, 3, 255}));
  EXPECT_EQ(texels(Bmp{.bits = 32, .data = {3, 2, 1, 9}}), (Bytes{1, 2, 3, 255}));
  // 5 bits each: 1/31 and 16/31 of 255 are 8.2 and 131.6.
  EXPECT_EQ(texels(Bmp{.bits = 16, .data = u16(1 << 10 | 16 << 5 | 31) + u16(0)}), (Bytes{8, 132, 255, 255}));
  EXPECT_TRUE(names(
      refusal(Bmp{
          .bits = 32, .compression = 3, .masks = u32(5) + u32(0xff00) + u32(0xff0000), .data = {1, 2, 3, 4}}),
      "holes in their masks"));
  EXPECT_TRUE(names(refusal(Bmp{.bits = 16,
                                .compression = 3,
                                .masks = u32(0x1f0000) + u32(0x3e0) + u32(0x1f),
                                .data = {1, 2, 3, 4}}),
                    "a channel's mask is wider than a texel"));
  EXPECT_TRUE(names(refusal(Bmp{.bits = 32, .compression = 3, .masks = Bytes(12), .data = {1, 2, 3, 4}}),
                    "its masks are 0"));
}

TEST(ImageFile, RefusesOtherBmpsByName) {
  const auto refused = [](std::uint32_t header, std::uint32_t compression, unsigned bits) {
    return refusal(Bmp{.header = header, .bits = bits, .compression = compression, .data = Bytes(64)});
  };
  EXPECT_TRUE(
      names(refused(40, 4, 0), "t: a BMP with an embedded JPEG is not read; expected a whole BMP file"));
  EXPECT_TRUE(names(refused(40, 5, 0), "an embedded PNG is not read"));
  EXPECT_TRUE(names(refused(124, 11, 32), "CMYK is not read"));
  EXPECT_TRUE(names(refused(64, 4, 24), "the compressions of OS/2"));
  EXPECT_TRUE(names(refused(16, 0, 24), "a header of 16 bytes is not read"));
  EXPECT_TRUE(names(refused(40, 1, 24), "24 bits per texel with the compression 1"));
  EXPECT_TRUE(names(refused(40, 77, 24), "the compression 77"));
  EXPECT_TRUE(names(refused(40, 0, 7), "7 bits per texel"));
}

TEST(ImageFile, ReadsTgasInEveryDirection) {
  // Rows of the file: a b, c d.
  const auto file = [](unsigned descriptor) {
    return Tga{.type = 3, .bits = 8, .height = 2, .descriptor = descriptor, .data = {1, 2, 3, 4}};
  };
  const auto greys = [](const Bytes& codes) {
    Bytes out;
    for (const std::uint8_t c : codes) out = out + Bytes{c, c, c, 255};
    return out;
  };
  EXPECT_EQ(texels(file(0)), greys({3, 4, 1, 2}));
  EXPECT_EQ(texels(file(0x10)), greys({4, 3, 2, 1}));
  EXPECT_EQ(texels(file(0x20)), greys({1, 2, 3, 4}));
  EXPECT_EQ(texels(file(0x30)), greys({2, 1, 4, 3}));
  EXPECT_EQ(texels(Tga{.descriptor = 0x30, .data = {0, 0, 255, 255, 0, 0}}),
            (Bytes{0, 0, 255, 255, 255, 0, 0, 255}));
  EXPECT_TRUE(names(refusal(file(0x40)), "a TGA with interleaved rows is not read"));
}

TEST(ImageFile, AlphaOfTgasIsWhatTheAttributeBitsSay) {
  const auto file = [](unsigned bits, unsigned descriptor, const Bytes& data) {
    return Tga{.bits = bits, .width = 1, .descriptor = descriptor, .data = data};
  };
  EXPECT_EQ(texels(file(32, 0, {3, 2, 1, 0})), (Bytes{1, 2, 3, 255}));
  EXPECT_EQ(texels(file(32, 8, {3, 2, 1, 0})), (Bytes{1, 2, 3, 0}));
  EXPECT_EQ(texels(file(16, 0, u16(31 << 10))), (Bytes{255, 0, 0, 255}));
  EXPECT_EQ(texels(file(16, 1, u16(31 << 10))), (Bytes{255, 0, 0, 0}));
  EXPECT_EQ(texels(file(16, 1, u16(1 << 15 | 31 << 10))), (Bytes{255, 0, 0, 255}));
  EXPECT_EQ(texels(file(15, 0, u16(16 << 5))), (Bytes{0, 132, 0, 255}));
  EXPECT_EQ(texels(Tga{.type = 11, .bits = 16, .width = 2, .descriptor = 8, .data = {0x81, 9, 4}}),
            (Bytes{9, 9, 9, 4, 9, 9, 9, 4}));
  EXPECT_TRUE(names(refusal(Tga{.type = 10, .bits = 24, .width = 2, .data = {0x82, 9, 8, 7}}),
                    "corrupt TGA: a run leaves the picture"));
}

TEST(ImageFile, PlacesTheFrameOfAGifOnItsCanvas) {
  const Bytes red{255, 0, 0, 255}, dark{1, 2, 3, 255}, green{0, 255, 0, 255}, blue{0, 0, 255, 255};
  Gif file{
      .canvas_width = 2, .canvas_height = 2, .background = 2, .left = 1, .top = 1, .width = 1, .height = 1};
  file.palette = gif_palette;
  file.indices = {3};
  EXPECT_EQ(texels(file), green + green + green + blue);
  // A file with transparency is clear where the frame is not.
  file.transparent = 1;
  const Bytes clear{1, 2, 3, 0};
  EXPECT_EQ(texels(file), clear + clear + clear + blue);
  file.indices = {1};
  EXPECT_EQ(texels(file), clear + clear + clear + clear);
  // Nothing says what the background is.
  file.transparent = -1;
  file.own_palette = gif_palette;
  file.palette.clear();
  EXPECT_EQ(texels(file), Bytes(12) + dark);
  // The frame's palette goes before the file's.
  file.palette = Bytes(12, 7);
  EXPECT_EQ(texels(file), (Bytes{7, 7, 7, 255, 7, 7, 7, 255, 7, 7, 7, 255} + dark));
  // A frame that leaves the canvas.
  file.canvas_width = file.canvas_height = 0;
  file.left = file.top = 0;
  EXPECT_EQ(texels(file), dark);
  file.palette.clear();
  file.own_palette.clear();
  EXPECT_TRUE(names(refusal(file), "corrupt GIF: it has no palette"));
  file.width = 0;
  file.palette = gif_palette;
  EXPECT_TRUE(names(refusal(file), "its frame has no texels"));
  EXPECT_TRUE(names(refusal(bytes_of("GIF89a") + u16(1) + u16(1) + Bytes{0, 0, 0} + bytes_of(";")),
                    "it has no frame"));
}

TEST(ImageFile, ReadsInterlacedGifs) {
  // Rows 0, 8 of nine; 4; 2, 6; 1, 3, 5, 7.
  Gif file{.canvas_width = 1,
           .canvas_height = 9,
           .width = 1,
           .height = 9,
           .palette = gif_palette,
           .interlaced = true};
  file.indices = {0, 0, 1, 2, 2, 3, 3, 3, 3};
  Bytes column;
  for (const std::size_t k : {0, 3, 2, 3, 1, 3, 2, 3, 0}) {
    column = column + Bytes{gif_palette[3 * k], gif_palette[3 * k + 1], gif_palette[3 * k + 2], 255};
  }
  EXPECT_EQ(texels(file), column);
}

TEST(ImageFile, ReadsEveryPnm) {
  const Bytes black{0, 0, 0, 255}, white{255, 255, 255, 255};
  EXPECT_EQ(texels(bytes_of("P1\n# bits\n3 1\n10 1")), black + white + black);
  EXPECT_EQ(texels(bytes_of("P4\n9 1\n") + Bytes{0x7f, 0x80}),
            white + black + black + black + black + black + black + black + black);
  // 1/4 and 3/4 of 255 are 63.75 and 191.25; 32768 and 128 of 65535 are 127.502 and 0.498.
  EXPECT_EQ(texels(bytes_of("P2 2 1 4 1#c\n3")), (Bytes{64, 64, 64, 255, 191, 191, 191, 255}));
  EXPECT_EQ(texels(bytes_of("P3\n1 1 65535\n32768 128 65535\n")), (Bytes{128, 0, 255, 255}));
  EXPECT_EQ(texels(bytes_of("P5 1 1 65535 ") + Bytes{0x80, 0x00}), (Bytes{128, 128, 128, 255}));
  EXPECT_EQ(texels(bytes_of("P6 1 1 256#c\n") + Bytes{0, 1, 0, 128, 1, 0}), (Bytes{1, 128, 255, 255}));
  EXPECT_TRUE(names(refusal(bytes_of("P2 1 1 4 5")), "corrupt PNM: a code is above 4"));
  EXPECT_TRUE(names(refusal(bytes_of("P5 1 1 4 \5")), "a code is above 4"));
  EXPECT_TRUE(names(refusal(bytes_of("P5 1 1 65536 \5\5")), "the largest code is above 65535"));
  EXPECT_TRUE(names(refusal(bytes_of("P5 1 1 0 ") + Bytes(1)), "the largest code is 0"));
  EXPECT_TRUE(names(refusal(bytes_of("P5 1x1 255 1")), "the width is no whole number"));
  EXPECT_TRUE(names(refusal(bytes_of("P1 1 1 2")), "a bit is neither 0 nor 1"));
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

// Each scan goes over the whole picture, so a small file of many takes long.
TEST(ImageFile, RefusesJpegsOfTooManyScans) {
  const auto scan = [](int coefficient, int high, int low) {
    return jpeg_scan_info{1, {0, 0, 0, 0}, coefficient, coefficient, high, low};
  };
  std::vector<jpeg_scan_info> scans{scan(0, 0, 0)};
  for (int coefficient = 1; coefficient < 64; ++coefficient) {
    scans.push_back(scan(coefficient, 0, 8));
    for (int low = 7; low >= 0; --low) scans.push_back(scan(coefficient, low + 1, low));
  }
  Bytes grey;
  for (int i = 0; i < 32 * 24; ++i) grey.push_back(static_cast<std::uint8_t>(i));
  EXPECT_TRUE(names(refusal(jpeg_of(grey, false, 1, scans)), "corrupt JPEG: it has too many scans"));
  scans.resize(1 + 9 * 55);
  EXPECT_EQ(decode_texture(jpeg_of(grey, false, 1, scans), "t").width, 32);
}

TEST(ImageFile, RefusesEveryTruncation) {
  const Bytes jpeg = jpeg_of(smooth_picture(), false);
  const Bytes rle = Bmp{.width = 4,
                        .height = 2,
                        .bits = 8,
                        .compression = 1,
                        .colors = 1,
                        .palette = {1, 2, 3, 0},
                        .data = {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 1}};
  const Bytes palette_tga = Tga{.type = 9, .bits = 8, .palette = {1, 2, 3, 4, 5, 6}, .data = {0x01, 0, 1}};
  Bytes gif_data = gif;
  gif_data.pop_back();  // the frame is whole without the mark of the end
  std::size_t count = 0;
  for (const Bytes& whole : {bmp, rle, ppm, pgm, bytes_of("P1 2 1 1 0"), bytes_of("P3 1 1 9 1 2 3"),
                             plain_tga, packed_tga, palette_tga, gif_data, jpeg}) {
    EXPECT_NO_THROW(decode_texture(whole, "t"));
    // Runs may leave out the mark of the end where the picture is full.
    const std::size_t end = whole.size() - (whole == rle ? 2 : 0);
    for (std::size_t length = 0; length < end; ++length, ++count) {
      EXPECT_THROW(decode_texture(std::span(whole).first(length), "t"), InputError)
          << length << " of " << whole.size();
    }
  }
  EXPECT_GT(count, 500U);
}

TEST(ImageFile, RefusesSizesBeyondTheLimitAndHollowOnes) {
  EXPECT_TRUE(names(refusal(bytes_of("P5\n16385 1\n255\n") + Bytes(16385)), "it has 16385 x 1 texels"));
  EXPECT_EQ(decode_texture(bytes_of("P5\n16384 1\n255\n") + Bytes(16384), "t").width, 16384);
  for (const Bytes& file :
       {bytes_of("P5\n16384 16384\n255\n") + Bytes(100), bytes_of("P1\n16384 16384\n") + Bytes(100),
        Bytes(Bmp{.width = 16384, .height = 16384, .data = Bytes(100)}),
        Bytes(Bmp{.width = 16384,
        .height = 16384,
        .bits = 8,
        .compression = 1,
        .colors = 1,
        .palette = Bytes(4),
        .data = Bytes(100)}),
        Bytes(Tga{.width = 16384, .height = 16384, .data = Bytes(100)}),
        Bytes(Tga{.type = 10, .width = 16384, .height = 16384, .data = Bytes(100)}),
        Bytes(Gif{.canvas_width = 16384,
        .canvas_height = 16384,
        .palette = gif_palette,
        .indices = {0, 0, 0, 0}})}) {
    EXPECT_TRUE(names(refusal(file), "too short for its size")) << refusal(file);
  }
  for (const auto& [width, height] :
       {std::pair{-1, 1}, {0, 1}, {1, 0}, {1, -2147483647 - 1}, {2147483647, 1}}) {
    EXPECT_TRUE(
        names(refusal(Bmp{.width = width, .height = height, .data = Bytes(100)}), "corrupt BMP: it has "));
  }
  EXPECT_TRUE(names(refusal(Tga{.width = 0, .data = Bytes(100)}), "corrupt TGA: it has 0 x 1 texels"));
  // The size in the frame header of a JPEG: behind the marker 0xc0, its length and the precision.
  Bytes jpeg = jpeg_of(smooth_picture(), false);
  const Bytes frame{0xff, 0xc0};
  const auto size = std::ranges::search(jpeg, frame).begin() + 5;
  for (const auto& [high, what] : {std::pair{0x40, "far too short"}, {0x41, "too large"}}) {
    size[0] = size[2] = static_cast<std::uint8_t>(high);
    size[1] = size[3] = 0;
    EXPECT_TRUE(names(refusal(jpeg), what)) << refusal(jpeg);
  }
}

TEST(ImageFile, NamesTheFormatsThatAreNotRead) {
  using namespace std::string_view_literals;
  for (const auto& [head, name] : {std::pair{"\xabKTX 11\xbb\r\n"sv, "KTX;"sv},
                                   {"\xabKTX 20\xbb\r\n"sv, "KTX 2;"sv},
                                   {"DDS |"sv, "DDS;"sv},
                                   {"RIFF\x10\0\0\0WEBPVP8 "sv, "WebP;"sv},
                                   {"II*\0\x08\0\0\0"sv, "TIFF;"sv},
                                   {"8BPS\0\1"sv, "Photoshop;"sv},
                                   {"#?RADIANCE\n"sv, "Radiance HDR;"sv},
                                   {"v/1\1\2"sv, "OpenEXR;"sv},
                                   {"P7\nWIDTH 1\n"sv, "PAM;"sv}}) {
    const std::string error = refusal(bytes_of(head));
    EXPECT_TRUE(names(
        error, "t: not an image that can be read: its format is " + std::string(name) + " expected a whole"))
        << error;
  }
  EXPECT_TRUE(names(refusal({}), "t: not an image that can be read: it is empty; expected"));
  EXPECT_TRUE(names(refusal(Bytes(1000)), "t: not an image that can be read; expected"));
}

}  // namespace
}  // namespace bitspan
