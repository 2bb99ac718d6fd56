// SPDX-License-Identifier: Apache-2.0
// Damaged image files: each is read or refused with one line, soon, and twice alike. Long: 10^5 of each
// format.
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "io/png.hpp"
#include "scene/texture.hpp"
#include "tests/scene/image_samples.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using Dice = std::mt19937_64;

std::size_t below(Dice& dice, std::size_t n) { return n == 0 ? 0 : dice() % n; }

Bytes noise(std::size_t size, unsigned codes) {
  Dice dice(size);
  Bytes out(size);
  for (std::uint8_t& c : out) c = static_cast<std::uint8_t>(dice() % codes);
  return out;
}

struct Seeds {
  std::string name;
  std::vector<Bytes> files;
};

Seeds pngs() {
  const std::array<png_color, 4> palette{{{10, 20, 30}, {40, 50, 60}, {1, 2, 3}, {4, 5, 6}}};
  const png_byte clear = 0;
  const auto colors = [&](png_structp png, png_infop info) {
    png_set_PLTE(png, info, palette.data(), 4);
    png_set_tRNS(png, info, &clear, 1, nullptr);
  };
  return {"PNG",
          {encode_png(9, 7, 4, noise(252, 256)), encode_png(40, 3, 1, noise(120, 9)),
           make_png(5, 16, PNG_COLOR_TYPE_RGB, {noise(30, 256), noise(30, 9), noise(30, 2)}, true),
           make_png(9, 2, PNG_COLOR_TYPE_PALETTE, {noise(3, 256), noise(3, 256)}, false, colors),
           make_png(19, 1, PNG_COLOR_TYPE_GRAY, {noise(3, 256), noise(3, 256), noise(3, 256)}, true)}};
}

Seeds jpegs() {
  Bytes inks = noise(32 * 24 * 4, 256);
  return {"JPEG",
          {jpeg_of(smooth_picture(), false), jpeg_of(smooth_picture(), true),
           jpeg_of(noise(32 * 24, 30), false, 1), jpeg_of(inks, false, 4)}};
}

Seeds bmps() {
  const Bytes palette = noise(64, 256);
  const Bytes masks = u32(0x7e00000) + u32(0x1ff800) + u32(0x7ff) + u32(0xf8000000);
  return {"BMP",
          {Bmp{.width = 5, .height = 4, .data = noise(64, 256)},
           Bmp{.width = 5, .height = -4, .bits = 16, .data = noise(48, 256)},
           Bmp{.header = 12,
               .width = 9,
               .height = 4,
               .bits = 4,
               .palette = noise(48, 256),
               .data = noise(32, 256)},
           Bmp{.width = 19,
               .height = 4,
               .bits = 1,
               .colors = 2,
               .palette = noise(8, 256),
               .data = noise(16, 256)},
           Bmp{.header = 108,
               .width = 3,
               .height = 3,
               .bits = 32,
               .compression = 3,
               .masks = masks,
               .data = noise(36, 256)},
           Bmp{.width = 8,
               .height = 4,
               .bits = 8,
               .compression = 1,
               .colors = 16,
               .palette = palette,
               .data = {8, 1, 0, 0, 0, 5, 1, 2, 3, 4, 5, 0, 0, 2, 1, 1, 2, 3, 0, 0, 8, 9, 0, 1}},
           Bmp{.width = 8,
               .height = 4,
               .bits = 4,
               .compression = 2,
               .colors = 16,
               .palette = palette,
               .data = {8, 0x12, 0, 0, 0, 5, 0x12, 0x34, 0x50, 0, 0, 2, 1, 1, 2, 0x30, 0, 0, 8, 9, 0, 1}}}};
}

Seeds tgas() {
  return {"TGA",
          {Tga{.width = 5, .height = 4, .descriptor = 0x10, .data = noise(60, 256)},
           Tga{.type = 10,
               .bits = 32,
               .width = 4,
               .height = 2,
               .descriptor = 0x28,
               .data = {0x82, 9, 8, 7, 6, 0x02, 3, 2, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 0x81, 1, 1, 1, 1}},
           Tga{.type = 9,
               .bits = 8,
               .width = 6,
               .height = 2,
               .first = 3,
               .palette = noise(30, 256),
               .data = {0x84, 3, 0x03, 4, 5, 6, 7, 0x82, 12}},
           Tga{.type = 3, .bits = 16, .width = 3, .height = 3, .descriptor = 8, .data = noise(18, 256)},
           Tga{.bits = 16, .width = 3, .height = 3, .descriptor = 0x31, .data = noise(18, 256)}}};
}

Seeds gifs() {
  return {"GIF",
          {Gif{.canvas_width = 9,
               .canvas_height = 9,
               .left = 1,
               .top = 2,
               .width = 7,
               .height = 6,
               .palette = noise(12, 256),
               .transparent = 2,
               .interlaced = true,
               .indices = noise(42, 4)},
           Gif{.canvas_width = 5,
               .canvas_height = 5,
               .background = 1,
               .width = 4,
               .height = 5,
               .palette = noise(12, 256),
               .own_palette = noise(12, 256),
               .indices = noise(20, 4)},
           bytes_of("GIF89a") + u16(8) + u16(8) + Bytes{0x91, 0, 0} + noise(12, 256) +
               // Longer codes: rows of one colour.
               bytes_of(",") + Bytes(4) + u16(8) + u16(8) +
               Bytes{0, 2, 9, 0x84, 0x8f, 0xa9, 0xcb, 0xed, 0x0f, 0xa3, 0x9c, 0xb4, 0} + bytes_of(";")}};
}

Seeds pnms() {
  return {"PNM",
          {bytes_of("P1\n# c\n5 2\n10110 0 1 1 0 1\n"), bytes_of("P2 4 2 15\n1 2 3 4 #c\n5 6 15 0\n"),
           bytes_of("P3\n2 1\n65535\n1 2 3 65535 40000 0\n"), bytes_of("P4 12 3\n") + noise(6, 256),
           bytes_of("P5\n4 4\n300 ") + noise(32, 2), bytes_of("P6\n4 4\n255\n") + noise(48, 256)}};
}

// One to eight changes; now and then the end of the file is another file's.
Bytes mutated(Dice& dice, const Seeds& seeds) {
  Bytes file = seeds.files[below(dice, seeds.files.size())];
  constexpr std::array<std::uint32_t, 12> edges{0,      1,      0x7f,   0x80,       0xff,       0x100,
                                                0x7fff, 0x8000, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff};
  for (std::size_t changes = 1 + below(dice, 8); changes > 0 && !file.empty(); --changes) {
    const std::size_t at = below(dice, file.size());
    const auto from = file.begin() + static_cast<std::ptrdiff_t>(at);
    const auto count = static_cast<std::ptrdiff_t>(below(dice, std::min<std::size_t>(file.size() - at, 32)));
    switch (below(dice, 9)) {
      case 0:
        file[at] = static_cast<std::uint8_t>(file[at] ^ 1U << below(dice, 8));
        break;
      case 1:
        file[at] = static_cast<std::uint8_t>(dice());
        break;
      case 2:
      case 3: {  // a number of one, two or four bytes; the header is worth more tries
        const std::size_t place =
            below(dice, std::min<std::size_t>(file.size(), dice() % 2 == 0 ? 64 : ~0UL));
        const Bytes value = u32(edges[below(dice, edges.size())]);
        const std::size_t size = std::min<std::size_t>(std::size_t{1} << below(dice, 3), file.size() - place);
        std::copy_n(value.begin(), size, file.begin() + static_cast<std::ptrdiff_t>(place));
        break;
      }
      case 4:
        file.erase(from, from + count);
        break;
      case 5:
        file.resize(at);
        break;
      case 6: {
        const Bytes part(from, from + count);
        const auto to = file.begin() + static_cast<std::ptrdiff_t>(below(dice, file.size()));
        file.insert(to, part.begin(), part.end());
        break;
      }
      case 7: {
        const Bytes fill = noise(1 + below(dice, 16), 256);
        file.insert(from, fill.begin(), fill.end());
        break;
      }
      default: {
        const Bytes& other = seeds.files[below(dice, seeds.files.size())];
        const auto tail = other.begin() + static_cast<std::ptrdiff_t>(std::min(at, other.size()));
        file.erase(from, file.end());
        file.insert(file.end(), tail, other.end());
      }
    }
  }
  return file;
}

// With the checksum of each chunk as it should be, so that what is behind it is read.
void repair_png(Bytes& file) {
  for (std::size_t at = 8; at + 12 <= file.size();) {
    const std::size_t size = std::size_t{file[at]} << 24 | std::size_t{file[at + 1]} << 16 |
                             std::size_t{file[at + 2]} << 8 | file[at + 3];
    if (size > file.size() - at - 12) return;
    const auto sum = static_cast<std::uint32_t>(crc32(0, &file[at + 4], static_cast<uInt>(size + 4)));
    for (std::size_t k = 0; k < 4; ++k)
      file[at + 8 + size + k] = static_cast<std::uint8_t>(sum >> (24 - 8 * k));
    at += 12 + size;
  }
}

class ImageFuzz : public testing::TestWithParam<Seeds (*)()> {};

TEST_P(ImageFuzz, IsReadOrRefused) {
  using Clock = std::chrono::steady_clock;
  const Seeds seeds = GetParam()();
  for (const Bytes& whole : seeds.files) EXPECT_NO_THROW(decode_texture(whole, "t")) << seeds.name;
  const int count = is_long_run() ? 1'000'000 : 100'000;
  int read = 0, refused = 0;
  double slowest = 0;
  const auto begin = Clock::now();
  for (int index = 0; index < count; ++index) {
    Dice dice(static_cast<std::uint64_t>(index) * 2654435761U + 1);
    Bytes file = mutated(dice, seeds);
    if (seeds.name == "PNG" && index % 4 != 0) repair_png(file);
    SCOPED_TRACE(seeds.name + " " + std::to_string(index));
    const auto start = Clock::now();
    Texture texture;
    const std::string error = error_of([&] { texture = decode_texture(file, "t"); });
    slowest = std::max(slowest, std::chrono::duration<double>(Clock::now() - start).count());
    if (!error.empty()) {
      EXPECT_TRUE(error.starts_with("t: ") && names(error, "; expected a whole ")) << error;
      ++refused;
      continue;
    }
    ++read;
    EXPECT_TRUE(texture.width >= 1 && texture.width <= texture_size_limit && texture.height >= 1 &&
                texture.height <= texture_size_limit);
    ASSERT_EQ(texture.rgba.size(),
              4 * static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height));
    // A picture is a function of the file.
    if (index % 8 == 0) {
      {  // leaves its bytes where the next picture may stand
        const Bytes used(texture.rgba.size(), static_cast<std::uint8_t>(index));
        ASSERT_EQ(used.back(), static_cast<std::uint8_t>(index));
      }
      ASSERT_EQ(decode_texture(file, "t").rgba, texture.rgba);
    }
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::printf("%s: %d files, %d read, %d refused, the slowest in %.0f ms, all in %.1f s\n",
              seeds.name.c_str(), count, read, refused, slowest * 1e3, seconds);
  EXPECT_GT(read, count / 100);
  EXPECT_GT(refused, count / 100);
  EXPECT_LT(slowest, 10) << "a hang";
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageFuzz, testing::Values(pngs, jpegs, bmps, tgas, gifs, pnms),
                         [](const auto& test) { return test.param().name; });

}  // namespace
}  // namespace bitspan
