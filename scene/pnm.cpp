// SPDX-License-Identifier: Apache-2.0
#include "scene/pnm.hpp"

namespace bitspan {
namespace {

bool is_space(unsigned c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_digit(unsigned c) { return c >= '0' && c <= '9'; }

void skip_comment(ImageBytes& file) {
  while (file.left() > 0) {
    const unsigned c = file.u8();
    if (c == '\n' || c == '\r') return;
  }
}

// Skips white space and comments.
void skip_blanks(ImageBytes& file) {
  while (file.left() > 0 && (is_space(file.data[file.at]) || file.data[file.at] == '#')) {
    if (file.u8() == '#') skip_comment(file);
  }
}

unsigned read_number(ImageBytes& file, unsigned maximum, const char* what) {
  skip_blanks(file);
  unsigned value = file.u8() - '0';
  if (value > 9) file.corrupt(std::string(what) + " is no whole number");
  while (file.left() > 0 && is_digit(file.data[file.at])) {
    value = value * 10 + (file.u8() - '0');
    if (value > maximum) break;
  }
  if (value > maximum) file.corrupt(std::string(what) + " is above " + std::to_string(maximum));
  if (file.left() > 0 && !is_space(file.data[file.at]) && file.data[file.at] != '#') {
    file.corrupt(std::string(what) + " is no whole number");
  }
  return value;
}

struct PnmHeader {
  bool text = false;  // numbers in decimal, else bytes
  unsigned channels = 1;
  unsigned maximum = 1;  // the code of white
  bool bits = false;     // 1 is black
  unsigned width = 0, height = 0;
};

PnmHeader read_pnm_header(ImageBytes& file) {
  PnmHeader h;
  const unsigned digit = file.take(2)[1] - '0';
  h.text = digit <= 3;
  h.bits = digit % 3 == 1;
  h.channels = digit % 3 == 0 ? 3 : 1;
  constexpr unsigned any_size = 99'999'999;
  h.width = read_number(file, any_size, "the width");
  h.height = read_number(file, any_size, "the height");
  if (!h.bits) h.maximum = read_number(file, 65535, "the largest code");
  if (h.maximum == 0) file.corrupt("the largest code is 0");
  // One white space ends the header of bytes; a comment ends with one.
  if (!h.text && file.u8() == '#') skip_comment(file);
  return h;
}

unsigned read_code(ImageBytes& file, const PnmHeader& h) {
  if (h.text && h.bits) {  // digits need no space between
    skip_blanks(file);
    const unsigned bit = file.u8() - '0';
    if (bit > 1) file.corrupt("a bit is neither 0 nor 1");
    return bit;
  }
  if (h.text) return read_number(file, h.maximum, "a code");
  unsigned code = file.u8();
  if (h.maximum > 255) code = code << 8 | file.u8();
  if (code > h.maximum) file.corrupt("a code is above " + std::to_string(h.maximum));
  return code;
}

void read_bits(ImageBytes& file, Texture& out) {
  const auto width = static_cast<std::size_t>(out.width);
  for (int y = 0; y < out.height; ++y) {
    const ByteSpan bytes = file.take((width + 7) / 8);
    std::uint8_t* texel = texel_at(out, 0, y);
    for (std::size_t x = 0; x < width; ++x, texel += 4) {
      const bool black = (bytes[x / 8] >> (7 - x % 8) & 1) != 0;
      store(texel, black ? opaque_black : Rgba{255, 255, 255, 255});
    }
  }
}

}  // namespace

bool is_pnm(ByteSpan file) {
  return file.size() >= 3 && file[0] == 'P' && file[1] >= '1' && file[1] <= '6' &&
         (is_space(file[2]) || file[2] == '#');
}

Texture decode_pnm(ByteSpan data, const std::string& origin) {
  ImageBytes file{data, "PNM", origin};
  const PnmHeader h = read_pnm_header(file);
  const std::size_t texels = std::size_t{h.width} * h.height, codes = texels * h.channels;
  // The least: a digit per bit, or a digit and a space per code.
  const std::size_t bytes = h.text             ? (h.bits ? codes : 2 * codes - (codes > 0 ? 1 : 0))
                            : h.bits           ? (std::size_t{h.width} + 7) / 8 * h.height
                            : h.maximum <= 255 ? codes
                                               : 2 * codes;
  Texture out = file.texture(h.width, h.height, bytes);
  if (h.bits && !h.text) {
    read_bits(file, out);
    return out;
  }
  for (std::size_t k = 0; k < out.rgba.size(); k += 4) {
    std::uint8_t* texel = &out.rgba[k];
    for (std::size_t c = 0; c < h.channels; ++c) {
      const unsigned code = read_code(file, h);
      texel[c] = to_code(h.bits ? 1 - code : code, h.maximum);
    }
    if (h.channels == 1) texel[1] = texel[2] = texel[0];
    texel[3] = 255;
  }
  return out;
}

}  // namespace bitspan
