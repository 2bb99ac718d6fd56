// SPDX-License-Identifier: Apache-2.0
#include "io/png.hpp"

#include <png.h>

#include <csetjmp>
#include <new>
#include <stdexcept>

#include "io/atomic_file.hpp"

namespace bitspan {
namespace {

// libpng leaves through longjmp; everything with a destructor is here, owned by the caller of encode().
struct Encoder {
  std::vector<std::uint8_t> bytes;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;

  ~Encoder() { png_destroy_write_struct(&png, &info); }
};

void append(png_structp png, png_bytep data, std::size_t count) {
  auto& bytes = static_cast<Encoder*>(png_get_io_ptr(png))->bytes;
  bytes.insert(bytes.end(), data, data + count);
}

void no_flush(png_structp) {}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  static_cast<Encoder*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

int color_type(int channels) {
  constexpr int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                           PNG_COLOR_TYPE_RGBA};
  return types[channels - 1];
}

bool encode(Encoder& encoder, int width, int height, int channels, const std::uint8_t* pixels) {
  if (setjmp(png_jmpbuf(encoder.png))) return false;
  png_set_write_fn(encoder.png, &encoder, append, no_flush);
  png_set_IHDR(encoder.png, encoder.info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height),
               8, color_type(channels), PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(encoder.png, encoder.info);
  const std::size_t pitch = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  for (int y = 0; y < height; ++y) {
    png_write_row(encoder.png, pixels + static_cast<std::size_t>(y) * pitch);
  }
  png_write_end(encoder.png, nullptr);
  return true;
}

}  // namespace

std::vector<std::uint8_t> encode_png(int width, int height, int channels,
                                     std::span<const std::uint8_t> pixels) {
  if (width < 1 || height < 1 || channels < 1 || channels > 4 ||
      pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                           static_cast<std::size_t>(channels)) {
    throw std::invalid_argument("encode_png: the size does not match the pixels");
  }
  Encoder encoder;
  encoder.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &encoder, on_error, on_warning);
  if (encoder.png) encoder.info = png_create_info_struct(encoder.png);
  if (!encoder.info) throw std::bad_alloc();
  if (!encode(encoder, width, height, channels, pixels.data())) {
    throw std::runtime_error("encode_png: " + encoder.error);
  }
  return std::move(encoder.bytes);
}

void write_png(const std::string& path, int width, int height, int channels,
               std::span<const std::uint8_t> pixels) {
  AtomicFile file(path);  // an unwritable place shows before the work of encoding
  file.write(encode_png(width, height, channels, pixels));
  file.commit();
}

}  // namespace bitspan
