// SPDX-License-Identifier: Apache-2.0
#include "scene/tga.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace bitspan {
namespace {

constexpr std::size_t header_bytes = 18;

enum class Kind { palette = 1, color = 2, grey = 3 };

struct TgaHeader {
  std::size_t id_bytes = 0;
  unsigned maps = 0;  // 1: there is a palette
  unsigned type = 0;
  Kind kind = Kind::color;
  bool runs = false;
  unsigned first = 0, colors = 0, color_bits = 0;  // of the palette
  unsigned width = 0, height = 0;
  unsigned bits = 0;  // per texel
  bool has_alpha = false, right_to_left = false, top_down = false;
  unsigned interleaved = 0;
};

TgaHeader read_tga_header(ImageBytes& file) {
  TgaHeader h;
  h.id_bytes = file.u8();
  h.maps = file.u8();
  h.type = file.u8();
  h.kind = static_cast<Kind>(h.type & 7);
  h.runs = (h.type & 8) != 0;
  h.first = file.u16();
  h.colors = file.u16();
  h.color_bits = file.u8();
  file.take(4);  // where the picture stands on a screen
  h.width = file.u16();
  h.height = file.u16();
  h.bits = file.u8();
  const unsigned descriptor = file.u8();
  h.has_alpha = (descriptor & 15) != 0;
  h.right_to_left = (descriptor & 16) != 0;
  h.top_down = (descriptor & 32) != 0;
  h.interleaved = descriptor >> 6;
  return h;
}

bool is_color_size(unsigned bits) { return bits == 15 || bits == 16 || bits == 24 || bits == 32; }

bool is_legal_tga(const TgaHeader& h) {
  if (h.maps > 1 || (h.type & ~8U) < 1 || (h.type & ~8U) > 3) return false;
  switch (h.kind) {
    case Kind::palette:
      return h.maps == 1 && (h.bits == 8 || h.bits == 16) && is_color_size(h.color_bits);
    case Kind::color:
      return is_color_size(h.bits);
    case Kind::grey:
      return h.bits == 8 || h.bits == 16;
  }
  return false;
}

// A colour of 15, 16, 24 or 32 bits. Without attribute bits it is opaque, whatever stands where alpha would
// be.
Rgba color_of(const std::uint8_t* c, unsigned bits, bool has_alpha) {
  if (bits > 16) return {c[2], c[1], c[0], bits == 32 && has_alpha ? c[3] : std::uint8_t{255}};
  const unsigned v = c[0] | static_cast<unsigned>(c[1]) << 8;
  const bool clear = bits == 16 && has_alpha && v >> 15 == 0;
  return {to_code(v >> 10 & 31, 31), to_code(v >> 5 & 31, 31), to_code(v & 31, 31),
          clear ? std::uint8_t{0} : std::uint8_t{255}};
}

std::vector<Rgba> read_palette(ImageBytes& file, const TgaHeader& h) {
  const std::size_t entry = (h.color_bits + 7) / 8;
  const ByteSpan bytes = file.take(entry * h.colors);
  std::vector<Rgba> palette;
  if (h.kind != Kind::palette) return palette;
  for (std::size_t k = 0; k < bytes.size(); k += entry) {
    palette.push_back(color_of(&bytes[k], h.color_bits, h.has_alpha));
  }
  return palette;
}

Rgba texel_of(const std::uint8_t* c, const TgaHeader& h, const std::vector<Rgba>& palette) {
  switch (h.kind) {
    case Kind::palette: {
      const unsigned index = h.bits == 8 ? c[0] : c[0] | static_cast<unsigned>(c[1]) << 8;
      // An index that the palette does not have is black.
      return index >= h.first && index - h.first < palette.size() ? palette[index - h.first] : opaque_black;
    }
    case Kind::color:
      return color_of(c, h.bits, h.has_alpha);
    case Kind::grey:
      break;
  }
  return {c[0], c[0], c[0], h.bits == 16 && h.has_alpha ? c[1] : std::uint8_t{255}};
}

}  // namespace

bool is_tga(ByteSpan data) {
  const std::string nobody;
  ImageBytes file{data, "TGA", nobody};
  return data.size() >= header_bytes && is_legal_tga(read_tga_header(file));
}

Texture decode_tga(ByteSpan data, const std::string& origin) {
  ImageBytes file{data, "TGA", origin};
  const TgaHeader h = read_tga_header(file);
  if (!is_legal_tga(h)) file.refuse("not a TGA");
  if (h.interleaved != 0) file.refuse("a TGA with interleaved rows is not read");
  file.take(h.id_bytes);
  const std::vector<Rgba> palette = h.maps == 1 ? read_palette(file, h) : std::vector<Rgba>{};
  const std::size_t size = (h.bits + 7) / 8, texels = std::size_t{h.width} * h.height;
  // A packet stands for at most 128 texels.
  Texture out = file.texture(h.width, h.height, h.runs ? (texels + 127) / 128 * (1 + size) : texels * size);

  // In the order of the file; packets go on from row to row.
  unsigned x = 0, row = 0;
  const auto put = [&](const Rgba& color) {
    store(texel_at(out, static_cast<int>(h.right_to_left ? h.width - 1 - x : x),
                   static_cast<int>(h.top_down ? row : h.height - 1 - row)),
          color);
    if (++x == h.width) x = 0, ++row;
  };
  for (std::size_t done = 0; done < texels;) {
    const unsigned packet = h.runs ? file.u8() : 0;
    const std::size_t count = h.runs ? (packet & 127) + 1 : texels;
    if (count > texels - done) file.corrupt("a run leaves the picture");
    const bool repeats = packet >= 128;
    const ByteSpan bytes = file.take(repeats ? size : count * size);
    for (std::size_t k = 0; k < count; ++k) put(texel_of(&bytes[repeats ? 0 : k * size], h, palette));
    done += count;
  }
  return out;
}

}  // namespace bitspan
