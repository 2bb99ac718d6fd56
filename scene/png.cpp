// SPDX-License-Identifier: Apache-2.0
#include "scene/png.hpp"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <new>
#include <utility>
#include <vector>

#include "scene/texture.hpp"

namespace bitspan {
namespace {

// What libpng's callbacks need. libpng leaves through longjmp, so nothing with a destructor may live in
// the frame that calls it: all of that is here, owned by the caller.
struct PngDecoder {
  ByteSpan data;
  std::size_t position = 0;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;
  Texture texture;
  GreyCodes grey;
  std::vector<std::uint8_t> bytes;  // codes of up to 8 bits, before they are widened
  std::vector<png_bytep> rows;

  ~PngDecoder() { png_destroy_read_struct(&png, &info, nullptr); }
};

void read_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto* decoder = static_cast<PngDecoder*>(png_get_io_ptr(png));
  if (count > decoder->data.size() - decoder->position) png_error(png, "the file ends too early (truncated)");
  std::copy_n(decoder->data.begin() + static_cast<std::ptrdiff_t>(decoder->position), count, out);
  decoder->position += count;
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  static_cast<PngDecoder*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

// Reads what stands in front of the picture, and refuses what cannot be whole.
void read_head(PngDecoder& decoder) {
  png_structp png = decoder.png;
  png_infop info = decoder.info;
  png_set_read_fn(png, &decoder, read_bytes);
  png_set_user_limits(png, texture_size_limit, texture_size_limit);
  // Only what makes the picture. Texts and profiles may swell to thousands of times their size.
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(png, info);
  // Deflate shrinks to 1/1032 at best: a header that promises more is refused before the memory is taken.
  if (png_get_rowbytes(png, info) / 1032 * png_get_image_height(png, info) > decoder.data.size()) {
    png_error(png, "the file is far too short for its size (truncated)");
  }
}

// Reads the picture into rows of `pitch` bytes from `first`.
void read_rows(PngDecoder& decoder, png_bytep first, std::size_t pitch) {
  decoder.rows.resize(png_get_image_height(decoder.png, decoder.info));
  for (std::size_t y = 0; y < decoder.rows.size(); ++y) decoder.rows[y] = first + y * pitch;
  png_read_image(decoder.png, decoder.rows.data());
  png_read_end(decoder.png, nullptr);
}

// Each returns false where it failed; decoder.error says why.
bool decode_texels(PngDecoder& decoder) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  png_structp png = decoder.png;
  png_infop info = decoder.info;
  read_head(decoder);
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);

  decoder.texture.width = static_cast<int>(png_get_image_width(png, info));
  decoder.texture.height = static_cast<int>(png_get_image_height(png, info));
  const std::size_t pitch = png_get_rowbytes(png, info);
  if (pitch != static_cast<std::size_t>(decoder.texture.width) * 4) png_error(png, "unexpected pixel layout");
  decoder.texture.rgba.resize(pitch * static_cast<std::size_t>(decoder.texture.height));
  read_rows(decoder, decoder.texture.rgba.data(), pitch);
  return true;
}

bool decode_codes(PngDecoder& decoder) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  png_structp png = decoder.png;
  png_infop info = decoder.info;
  read_head(decoder);
  if (png_get_color_type(png, info) != PNG_COLOR_TYPE_GRAY) {
    png_error(png, "it has colours or alpha, and not grey levels alone");
  }
  const bool is_wide = png_get_bit_depth(png, info) == 16;
  if (is_wide) {
    png_set_swap(png);  // little-endian
  } else {
    png_set_packing(png);  // a byte per code
  }
  png_set_interlace_handling(png);
  png_read_update_info(png, info);

  decoder.grey.width = static_cast<int>(png_get_image_width(png, info));
  decoder.grey.height = static_cast<int>(png_get_image_height(png, info));
  const std::size_t width = png_get_image_width(png, info);
  const std::size_t pitch = png_get_rowbytes(png, info);
  if (pitch != width * (is_wide ? 2 : 1)) png_error(png, "unexpected pixel layout");
  decoder.grey.codes.resize(width * png_get_image_height(png, info));
  if (is_wide) {
    read_rows(decoder, reinterpret_cast<png_bytep>(decoder.grey.codes.data()), pitch);
    return true;
  }
  decoder.bytes.resize(decoder.grey.codes.size());
  read_rows(decoder, decoder.bytes.data(), pitch);
  std::copy(decoder.bytes.begin(), decoder.bytes.end(), decoder.grey.codes.begin());
  return true;
}

void run(PngDecoder& decoder, bool (*decode)(PngDecoder&), const std::string& origin) {
  decoder.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoder, on_error, on_warning);
  if (decoder.png) decoder.info = png_create_info_struct(decoder.png);
  if (!decoder.info) throw std::bad_alloc();
  if (!decode(decoder)) ImageBytes{decoder.data, "PNG", origin}.corrupt(decoder.error);
}

}  // namespace

bool is_png(ByteSpan file) { return file.size() >= 8 && png_sig_cmp(file.data(), 0, 8) == 0; }

Texture decode_png(ByteSpan file, const std::string& origin) {
  PngDecoder decoder;
  decoder.data = file;
  decoder.texture.name = origin;
  run(decoder, decode_texels, origin);
  return std::move(decoder.texture);
}

GreyCodes decode_grey_png(ByteSpan file, const std::string& origin) {
  PngDecoder decoder;
  decoder.data = file;
  run(decoder, decode_codes, origin);
  return std::move(decoder.grey);
}

}  // namespace bitspan
