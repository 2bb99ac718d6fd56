// SPDX-License-Identifier: Apache-2.0
#include "scene/bmp.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

namespace bitspan {
namespace {

// Compressions, as the header counts them.
constexpr std::uint32_t plain = 0, rle8 = 1, rle4 = 2, bit_fields = 3, alpha_bit_fields = 6;

struct BmpHeader {
  std::size_t pixels_at = 0;  // 0: right behind the palette
  std::uint32_t size = 0;     // of the second header
  std::int64_t width = 0, height = 0;
  bool top_down = false;
  unsigned bits = 0;  // per texel
  std::uint32_t compression = plain;
  std::uint32_t colors = 0;              // of the palette; 0: all that the bits can name
  std::array<std::uint32_t, 4> masks{};  // red, green, blue, alpha
};

void check_kind(const ImageBytes& file, const BmpHeader& h) {
  constexpr std::array<const char*, 14> names{
      "", "", "", "", "an embedded JPEG", "an embedded PNG", "", "", "", "", "", "CMYK", "CMYK", "CMYK"};
  if (h.size == 64 && h.compression > rle4) file.refuse("a BMP with the compressions of OS/2 is not read");
  if (h.compression < names.size() && *names[h.compression] != 0) {
    file.refuse("a BMP with " + std::string(names[h.compression]) + " is not read");
  }
  if (h.compression > alpha_bit_fields) {
    file.corrupt("it has the compression " + std::to_string(h.compression));
  }
  const bool legal = h.compression == plain
                         ? std::ranges::count(std::array{1, 2, 4, 8, 16, 24, 32}, h.bits) == 1
                     : h.compression == rle8 ? h.bits == 8
                     : h.compression == rle4 ? h.bits == 4
                                             : h.bits == 16 || h.bits == 24 || h.bits == 32;
  if (!legal) {
    file.corrupt("it has " + std::to_string(h.bits) + " bits per texel with the compression " +
                 std::to_string(h.compression));
  }
  if (h.top_down && (h.compression == rle8 || h.compression == rle4)) {
    file.corrupt("it has run lengths from the top down");
  }
}

// Reads both headers; `file` then stands at the palette.
BmpHeader read_bmp_header(ImageBytes& file) {
  BmpHeader h;
  file.seek(10);
  h.pixels_at = file.u32();
  h.size = file.u32();
  if (std::ranges::count(std::array{12U, 40U, 52U, 56U, 64U, 108U, 124U}, h.size) == 0) {
    file.refuse("a BMP with a header of " + std::to_string(h.size) + " bytes is not read");
  }
  if (h.size == 12) {
    h.width = file.u16();
    h.height = file.u16();
  } else {
    h.width = static_cast<std::int32_t>(file.u32());
    h.height = static_cast<std::int32_t>(file.u32());
    h.top_down = h.height < 0;
    if (h.top_down) h.height = -h.height;
  }
  file.u16();  // planes
  h.bits = file.u16();
  if (h.size > 12) {
    h.compression = file.u32();
    file.take(12);  // bytes of the picture, and its resolution
    h.colors = file.u32();
    file.take(4);
  }
  check_kind(file, h);
  if (h.compression == bit_fields || h.compression == alpha_bit_fields) {
    // In or behind the header.
    const bool has_alpha = h.size >= 56 || h.compression == alpha_bit_fields;
    for (std::size_t k = 0; k < (has_alpha ? 4 : 3); ++k) h.masks[k] = file.u32();
    if ((h.masks[0] | h.masks[1] | h.masks[2]) == 0) file.corrupt("its masks are 0");
  } else if (h.bits == 16) {
    h.masks = {0x7c00, 0x3e0, 0x1f, 0};
  } else {
    h.masks = {0xff0000, 0xff00, 0xff, 0};
  }
  if (h.size > 40) file.seek(std::max(file.at, std::size_t{14} + h.size));
  return h;
}

// The colours of all indices that the bits can name: those that the file does not have are black.
std::vector<Rgba> read_palette(ImageBytes& file, const BmpHeader& h) {
  const std::size_t entry = h.size == 12 ? 3 : 4;
  std::vector<Rgba> palette(std::size_t{1} << h.bits, opaque_black);
  std::size_t count = h.colors == 0 ? palette.size() : h.colors;
  // Some writers store fewer than they say, and the texels follow at once.
  if (h.pixels_at > file.at) count = std::min(count, (h.pixels_at - file.at) / entry);
  const ByteSpan bytes = file.take(entry * std::min(count, palette.size()));
  for (std::size_t k = 0; k < bytes.size() / entry; ++k) {
    const std::uint8_t* c = &bytes[k * entry];
    palette[k] = {c[2], c[1], c[0], 255};
  }
  if (h.pixels_at == 0) file.seek(file.at + entry * (count - bytes.size() / entry));
  return palette;
}

// Texels of 16, 24 or 32 bits: where a channel lies in them.
struct Channel {
  int shift = 0;
  std::uint32_t maximum = 0;  // 0: the texel does not have it
};

Channel channel_of(const ImageBytes& file, std::uint32_t mask, unsigned bits) {
  if (mask == 0) return {};
  const int shift = std::countr_zero(mask);
  const std::uint32_t maximum = mask >> shift;
  if ((maximum & (maximum + 1)) != 0)
    file.refuse("a BMP whose channels have holes in their masks is not read");
  if (bits < 32 && mask >> bits != 0) file.corrupt("a channel's mask is wider than a texel");
  return {shift, maximum};
}

std::uint8_t code_of(std::uint32_t texel, const Channel& channel, std::uint8_t otherwise) {
  if (channel.maximum == 0) return otherwise;
  return to_code(texel >> channel.shift & channel.maximum, channel.maximum);
}

// Row `row` of the file, counted from its first one.
int row_of(const Texture& out, const BmpHeader& h, int row) {
  return h.top_down ? row : out.height - 1 - row;
}

void read_rows(ImageBytes& file, const BmpHeader& h, const std::vector<Rgba>& palette, Texture& out) {
  std::array<Channel, 4> channels;
  for (std::size_t k = 0; h.bits > 8 && k < 4; ++k) channels[k] = channel_of(file, h.masks[k], h.bits);
  const std::size_t pitch = (static_cast<std::size_t>(h.width) * h.bits + 31) / 32 * 4;
  const std::size_t step = h.bits / 8;
  for (int row = 0; row < out.height; ++row) {
    const ByteSpan bytes = file.take(pitch);
    std::uint8_t* texel = texel_at(out, 0, row_of(out, h, row));
    for (std::size_t x = 0; x < static_cast<std::size_t>(out.width); ++x, texel += 4) {
      if (h.bits <= 8) {
        const std::size_t bit = x * h.bits;
        store(texel, palette[bytes[bit / 8] >> (8 - h.bits - bit % 8) & (palette.size() - 1)]);
        continue;
      }
      std::uint32_t value = 0;
      for (std::size_t k = 0; k < step; ++k) value |= std::uint32_t{bytes[x * step + k]} << (8 * k);
      store(texel, {code_of(value, channels[0], 0), code_of(value, channels[1], 0),
                    code_of(value, channels[2], 0), code_of(value, channels[3], 255)});
    }
  }
}

// Run lengths, of 4 or 8 bits per index. What they leave out has index 0.
void read_runs(ImageBytes& file, const BmpHeader& h, const std::vector<Rgba>& palette, Texture& out) {
  for (std::size_t k = 0; k < out.rgba.size(); k += 4) store(&out.rgba[k], palette[0]);
  int x = 0, row = 0;
  const auto check = [&](unsigned count) {
    if (row >= out.height || static_cast<int>(count) > out.width - x)
      file.corrupt("a run leaves the picture");
  };
  const auto put = [&](unsigned index) { store(texel_at(out, x++, row_of(out, h, row)), palette[index]); };
  const bool nibbles = h.bits == 4;
  const auto is_full = [&] { return row >= out.height || (row == out.height - 1 && x == out.width); };
  while (file.left() > 0 || !is_full()) {
    const unsigned count = file.u8(), code = file.u8();
    if (count > 0) {
      check(count);
      for (unsigned k = 0; k < count; ++k) put(!nibbles ? code : k % 2 == 0 ? code >> 4 : code & 15);
    } else if (code == 0) {  // end of the row
      x = 0;
      row = std::min(row + 1, out.height);
    } else if (code == 1) {  // end of the picture
      return;
    } else if (code == 2) {  // onward
      const unsigned right = file.u8(), up = file.u8();
      if (static_cast<int>(right) > out.width - x || static_cast<int>(up) > out.height - row) {
        file.corrupt("a run leaves the picture");
      }
      x += static_cast<int>(right);
      row += static_cast<int>(up);
    } else {  // `code` indices one by one, filled to a whole number of words
      check(code);
      const ByteSpan bytes = file.take(nibbles ? (code + 3) / 4 * 2 : (code + 1) / 2 * 2);
      for (unsigned k = 0; k < code; ++k) {
        put(!nibbles ? bytes[k] : k % 2 == 0 ? bytes[k / 2] >> 4 : bytes[k / 2] & 15U);
      }
    }
  }
}

}  // namespace

bool is_bmp(ByteSpan file) { return file.size() >= 2 && file[0] == 'B' && file[1] == 'M'; }

Texture decode_bmp(ByteSpan data, const std::string& origin) {
  ImageBytes file{data, "BMP", origin};
  const BmpHeader h = read_bmp_header(file);
  const std::vector<Rgba> palette = h.bits <= 8 ? read_palette(file, h) : std::vector<Rgba>{};
  if (h.pixels_at != 0) {
    if (h.pixels_at < file.at) file.corrupt("its texels begin inside of its header");
    file.seek(h.pixels_at);
  }
  const bool runs = h.compression == rle8 || h.compression == rle4;
  const auto width = static_cast<std::size_t>(h.width), height = static_cast<std::size_t>(h.height);
  // Runs may leave out most of a picture. Of a file that stands for more than this, the size is at fault.
  constexpr std::size_t most_texels_per_byte = 4096;
  Texture out =
      file.texture(h.width, h.height,
                   runs ? width * height / most_texels_per_byte : (width * h.bits + 31) / 32 * 4 * height);
  (runs ? read_runs : read_rows)(file, h, palette, out);
  return out;
}

}  // namespace bitspan
