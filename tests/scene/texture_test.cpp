// SPDX-License-Identifier: Apache-2.0
#include "scene/texture.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <zlib.h>

#include <array>
#include <filesystem>

#include "io/png.hpp"
#include "tests/scene/image_samples.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

TEST(Texture, EveryColourTypeBecomesRgba8) {
  EXPECT_EQ(decode_texture(make_png(3, 1, PNG_COLOR_TYPE_GRAY, {{0xa0}}), "t").rgba,
            (Bytes{255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255}));
  EXPECT_EQ(decode_texture(make_png(2, 4, PNG_COLOR_TYPE_GRAY, {{0x3f}}), "t").rgba,
            (Bytes{51, 51, 51, 255, 255, 255, 255, 255}));
  EXPECT_EQ(decode_texture(make_png(1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {{7, 9}}), "t").rgba,
            (Bytes{7, 7, 7, 9}));
  EXPECT_EQ(decode_texture(make_png(1, 8, PNG_COLOR_TYPE_RGB, {{1, 2, 3}}), "t").rgba, (Bytes{1, 2, 3, 255}));
  EXPECT_EQ(decode_texture(make_png(1, 8, PNG_COLOR_TYPE_RGBA, {{1, 2, 3, 0}}), "t").rgba,
            (Bytes{1, 2, 3, 0}));
  // 16 bits: 0x0180 = 384 -> 384 / 257 = 1.49 -> 1; 0x0181 -> 1.498 -> 1; 0x8080 -> 128; 0xffff -> 255
  EXPECT_EQ(decode_texture(
                make_png(1, 16, PNG_COLOR_TYPE_RGBA, {{0x01, 0x80, 0x80, 0x80, 0xff, 0xff, 0x02, 0x02}}), "t")
                .rgba,
            (Bytes{1, 128, 255, 2}));
}

TEST(Texture, PalettesKeepTheirTransparency) {
  png_color palette[3] = {{10, 20, 30}, {40, 50, 60}, {255, 0, 255}};
  png_byte alpha[2] = {0, 77};
  const Bytes png =
      make_png(3, 2, PNG_COLOR_TYPE_PALETTE, {{0x18}}, false, [&](png_structp p, png_infop info) {
        png_set_PLTE(p, info, palette, 3);
        png_set_tRNS(p, info, alpha, 2, nullptr);
      });
  EXPECT_EQ(decode_texture(png, "t").rgba, (Bytes{10, 20, 30, 0, 40, 50, 60, 77, 255, 0, 255, 255}));
}

TEST(Texture, GammaIsNotApplied) {
  const Bytes png = make_png(1, 8, PNG_COLOR_TYPE_RGB, {{100, 150, 200}}, false,
                             [](png_structp p, png_infop info) { png_set_gAMA(p, info, 1.0); });
  EXPECT_EQ(decode_texture(png, "t").rgba, (Bytes{100, 150, 200, 255}));
}

TEST(Texture, InterlacedIsTheSamePicture) {
  std::vector<Bytes> rows;
  for (int y = 0; y < 13; ++y) {
    Bytes row;
    for (int x = 0; x < 11 * 3; ++x) row.push_back(static_cast<std::uint8_t>(x * 7 + y * 19));
    rows.push_back(row);
  }
  const Texture plain = decode_texture(make_png(11, 8, PNG_COLOR_TYPE_RGB, rows), "t");
  const Texture interlaced = decode_texture(make_png(11, 8, PNG_COLOR_TYPE_RGB, rows, true), "t");
  EXPECT_EQ(plain.width, 11);
  EXPECT_EQ(plain.height, 13);
  EXPECT_EQ(plain.rgba, interlaced.rgba);
}

TEST(Texture, WrittenPicturesReadBack) {
  const TemporaryFolder folder;
  Bytes pixels;
  for (int i = 0; i < 7 * 5 * 4; ++i) pixels.push_back(static_cast<std::uint8_t>(i * 37));
  write_png(folder.path("t.png"), 7, 5, 4, pixels);
  const Texture texture = read_texture(folder.path("t.png"));
  EXPECT_EQ(texture.width, 7);
  EXPECT_EQ(texture.height, 5);
  EXPECT_EQ(texture.rgba, pixels);
}

TEST(Texture, RefusesMissingAndForeignFiles) {
  const TemporaryFolder folder;
  EXPECT_NE(input_error([&] {
              read_texture(folder.path("none.png"));
            }).find("none.png: cannot read the texture: No such file"),
            std::string::npos);
  EXPECT_NE(input_error([&] { read_texture(folder.path()); }).find("is a folder"), std::string::npos);
  folder.write("e.png", "");
  EXPECT_NE(input_error([&] { read_texture(folder.path("e.png")); }).find("e.png: not an image that can"),
            std::string::npos);
  folder.write("j.png", "\xff\xd8\xff\xe0 JFIF");
  EXPECT_NE(input_error([&] { read_texture(folder.path("j.png")); }).find("j.png: corrupt JPEG: "),
            std::string::npos);
}

// What follows the head takes no place on the disk, and would take all memory.
TEST(Texture, RefusesHugeFiles) {
  const TemporaryFolder folder;
  const Bytes png = encode_png(1, 1, 1, Bytes{3});
  folder.write("huge.png", std::string(png.begin(), png.end()));
  std::filesystem::resize_file(folder.path("huge.png"), std::uintmax_t{5} << 30 | 1);
  expect_refusal([&] { read_texture(folder.path("huge.png")); },
                 "it has 5368709121 bytes; expected at most 5368709120");
}

TEST(Texture, RefusesEveryTruncationSilently) {
  Bytes pixels;
  for (int i = 0; i < 20 * 20 * 4; ++i) pixels.push_back(static_cast<std::uint8_t>(i * i));
  const Bytes png = encode_png(20, 20, 4, pixels);
  testing::internal::CaptureStderr();
  for (std::size_t length = 0; length < png.size(); ++length) {
    EXPECT_THROW(decode_texture(std::span(png).first(length), "t.png"), InputError) << length;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Texture, RefusesFlippedBytesOrReadsThemWithoutAWord) {
  Bytes pixels(16 * 16 * 3, 90);
  const Bytes png = encode_png(16, 16, 3, pixels);
  int refused = 0;
  testing::internal::CaptureStderr();
  for (std::size_t at = 0; at < png.size(); ++at) {
    Bytes broken = png;
    broken[at] = static_cast<std::uint8_t>(broken[at] ^ 0x5a);
    try {
      decode_texture(broken, "t.png");
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(refused, static_cast<int>(png.size()) * 9 / 10);
}

TEST(Texture, RefusesSizesBeyondTheLimitAndHollowOnes) {
  const Bytes wide = encode_png(16385, 1, 1, Bytes(16385, 3));
  EXPECT_NE(input_error([&] { decode_texture(wide, "t.png"); }).find("t.png: corrupt PNG: "),
            std::string::npos);
  EXPECT_EQ(decode_texture(encode_png(16384, 1, 1, Bytes(16384, 3)), "t.png").width, 16384);
  // A small file whose header, checksum and all, promises a gigabyte.
  Bytes hollow = make_png(1, 8, PNG_COLOR_TYPE_RGBA, {{0, 0, 0, 0}});
  hollow[18] = hollow[22] = 0x40;
  hollow[19] = hollow[23] = 0;
  const auto check = static_cast<std::uint32_t>(crc32(0, hollow.data() + 12, 17));
  for (std::size_t i = 0; i < 4; ++i) hollow[29 + i] = static_cast<std::uint8_t>(check >> (24 - 8 * i));
  EXPECT_NE(input_error([&] { decode_texture(hollow, "t.png"); }).find("far too short"), std::string::npos);
}

TEST(Texture, AnIndexThatThePaletteDoesNotHaveIsBlack) {
  const Bytes png =
      make_png(4, 8, PNG_COLOR_TYPE_PALETTE, {{0, 1, 2, 255}}, false, [](png_structp p, png_infop info) {
        const std::array<png_color, 2> palette{{{10, 20, 30}, {40, 50, 60}}};
        png_set_PLTE(p, info, palette.data(), 2);
        png_set_check_for_invalid_index(p, 0);
      });
  EXPECT_EQ(decode_texture(png, "t").rgba,
            (Bytes{10, 20, 30, 255, 40, 50, 60, 255, 0, 0, 0, 255, 0, 0, 0, 255}));
}

// Texts and profiles swell to a thousand times their size; none of them is part of the picture.
TEST(Texture, TakesNoMemoryForTextsAndProfiles) {
  Bytes packed(100000);
  uLongf size = packed.size();
  const Bytes text(4 << 20, 'a');
  ASSERT_EQ(compress(packed.data(), &size, text.data(), text.size()), Z_OK);
  packed.resize(size);
  Bytes chunk{'z', 'T', 'X', 't', 'k', 0, 0};
  chunk.insert(chunk.end(), packed.begin(), packed.end());
  const auto big_endian = [](std::size_t v) {
    return Bytes{static_cast<std::uint8_t>(v >> 24), static_cast<std::uint8_t>(v >> 16),
                 static_cast<std::uint8_t>(v >> 8), static_cast<std::uint8_t>(v)};
  };
  const Bytes png = make_png(1, 8, PNG_COLOR_TYPE_RGBA, {{1, 2, 3, 4}});
  Bytes file(png.begin(), png.begin() + 33);  // the signature and the header
  for (int k = 0; k < 100; ++k) {
    for (const Bytes& part : {big_endian(chunk.size() - 4), chunk,
                              big_endian(crc32(0, chunk.data(), static_cast<uInt>(chunk.size())))}) {
      file.insert(file.end(), part.begin(), part.end());
    }
  }
  file.insert(file.end(), png.begin() + 33, png.end());
  const auto peak = [] {  // KiB
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const long before = peak();
  EXPECT_EQ(decode_texture(file, "t").rgba, (Bytes{1, 2, 3, 4}));
  EXPECT_LT(peak() - before, 100 << 10);
}

}  // namespace
}  // namespace bitspan
