// SPDX-License-Identifier: Apache-2.0
// Image files of the tests, written byte by byte from the formats' descriptions; PNGs and JPEGs by
// their libraries.
#pragma once

#include <jpeglib.h>
#include <png.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string_view>
#include <vector>

namespace bitspan {

using Bytes = std::vector<std::uint8_t>;

inline Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Little-endian.
inline Bytes u16(unsigned v) { return {static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v >> 8)}; }
inline Bytes u32(std::uint32_t v) { return u16(v & 0xffff) + u16(v >> 16); }

struct Bmp {
  std::uint32_t header = 40;
  int width = 1, height = 1;
  unsigned bits = 24;
  std::uint32_t compression = 0, colors = 0;
  Bytes masks{};    // or whatever else is behind the first 40 bytes of the header
  Bytes palette{};  // as in the file
  Bytes data{};

  operator Bytes() const {  // NOLINT(google-explicit-constructor): a Bmp is a file
    Bytes info = u32(header);
    if (header == 12) {
      info =
          info + u16(static_cast<unsigned>(width)) + u16(static_cast<unsigned>(height)) + u16(1) + u16(bits);
    } else {
      info = info + u32(static_cast<std::uint32_t>(width)) + u32(static_cast<std::uint32_t>(height)) +
             u16(1) + u16(bits) + u32(compression) + Bytes(12) + u32(colors) + Bytes(4) + masks;
    }
    info.resize(std::max<std::size_t>(info.size(), header));
    const auto at = static_cast<std::uint32_t>(14 + info.size() + palette.size());
    return bytes_of("BM") + u32(static_cast<std::uint32_t>(at + data.size())) + Bytes(4) + u32(at) + info +
           palette + data;
  }
};

struct Tga {
  unsigned type = 2, bits = 24;
  unsigned width = 2, height = 1;
  unsigned descriptor = 0;
  unsigned first = 0, color_bits = 24;
  Bytes palette{};
  Bytes data{};

  operator Bytes() const {  // NOLINT(google-explicit-constructor): a Tga is a file
    const unsigned entry = (color_bits + 7) / 8;
    const auto byte = [](unsigned v) { return static_cast<std::uint8_t>(v); };
    return Bytes{3, byte(palette.empty() ? 0 : 1), byte(type)} + u16(palette.empty() ? 0 : first) +
           u16(static_cast<unsigned>(palette.size()) / entry) +
           Bytes{byte(palette.empty() ? 0 : color_bits)} + Bytes(4) + u16(width) + u16(height) +
           Bytes{byte(bits), byte(descriptor)} + bytes_of("id!") + palette + data;
  }
};

// The codes of a frame, `bits` bits per index. A clear code often enough keeps all codes at one width.
inline Bytes gif_codes(const Bytes& indices, unsigned bits) {
  const unsigned clear = 1U << bits;
  Bytes codes;
  unsigned held = 0, count = 0;
  const auto put = [&](unsigned code) {
    held |= code << count;
    count += bits + 1;
    for (; count >= 8; count -= 8, held >>= 8) codes.push_back(static_cast<std::uint8_t>(held));
  };
  for (std::size_t k = 0; k < indices.size(); ++k) {
    if (k % (clear - 2) == 0) put(clear);
    put(indices[k]);
  }
  put(clear + 1);
  if (count > 0) codes.push_back(static_cast<std::uint8_t>(held));
  Bytes out{static_cast<std::uint8_t>(bits)};
  for (std::size_t at = 0; at < codes.size(); at += 255) {
    const std::size_t size = std::min<std::size_t>(255, codes.size() - at);
    out.push_back(static_cast<std::uint8_t>(size));
    out.insert(out.end(), codes.begin() + static_cast<std::ptrdiff_t>(at),
               codes.begin() + static_cast<std::ptrdiff_t>(at + size));
  }
  return out + Bytes{0};
}

struct Gif {
  unsigned canvas_width = 2, canvas_height = 2, background = 0;
  unsigned left = 0, top = 0, width = 2, height = 2;
  Bytes palette{}, own_palette{};  // of the file and of the frame: none, or four colours
  int transparent = -1;
  bool interlaced = false;
  Bytes indices{};  // in the order of the file

  operator Bytes() const {  // NOLINT(google-explicit-constructor): a Gif is a file
    const auto byte = [](unsigned v) { return static_cast<std::uint8_t>(v); };
    Bytes out = bytes_of("GIF89a") + u16(canvas_width) + u16(canvas_height) +
                Bytes{byte(palette.empty() ? 0x10 : 0x91), byte(background), 0} + palette;
    if (transparent >= 0)
      out = out + Bytes{0x21, 0xf9, 4, 1, 0, 0, byte(static_cast<unsigned>(transparent)), 0};
    return out + bytes_of(",") + u16(left) + u16(top) + u16(width) + u16(height) +
           Bytes{byte((own_palette.empty() ? 0 : 0x81) | (interlaced ? 0x40 : 0))} + own_palette +
           gif_codes(indices, 2) + bytes_of(";");
  }
};

// A PNG of any type; `rows` are packed as the format says.
inline Bytes make_png(unsigned width, int depth, int type, const std::vector<Bytes>& rows,
                      bool interlaced = false,
                      const std::function<void(png_structp, png_infop)>& extra = {}) {
  Bytes bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, png_size_t count) {
        auto* out = static_cast<Bytes*>(png_get_io_ptr(p));
        out->insert(out->end(), data, data + count);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, width, static_cast<png_uint_32>(rows.size()), depth, type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (extra) extra(png, info);
  png_write_info(png, info);
  const int passes = png_set_interlace_handling(png);
  for (int pass = 0; pass < passes; ++pass) {
    for (const Bytes& row : rows) png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

// 32 x 24 texels of red, green and blue.
inline Bytes smooth_picture() {
  Bytes rgb;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      for (const int c : {8 * x, 10 * y, 255 - 4 * x - 5 * y}) rgb.push_back(static_cast<std::uint8_t>(c));
    }
  }
  return rgb;
}

// Through libjpeg: 32 x 24 texels of grey, of red, green and blue, or of four inks; progressive if there are
// scans.
inline Bytes jpeg_of(const Bytes& pixels, bool progressive, int channels = 3,
                     const std::vector<jpeg_scan_info>& scans = {}) {
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
  c.in_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&c);
  jpeg_set_quality(&c, 95, TRUE);
  if (progressive) jpeg_simple_progression(&c);
  if (!scans.empty()) {
    c.scan_info = scans.data();
    c.num_scans = static_cast<int>(scans.size());
  }
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

}  // namespace bitspan
