// SPDX-License-Identifier: Apache-2.0
#include "scene/jpeg.hpp"

#include <jpeglib.h>

#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <utility>
#include <vector>

#include "scene/texture.hpp"

namespace bitspan {
namespace {

// libjpeg leaves through longjmp: everything with a destructor is here, owned by the caller of decode().
struct Decoder {
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf leave{};
  jpeg_decompress_struct jpeg{};
  std::string error;
  Texture texture;
  std::vector<std::uint8_t> row;

  ~Decoder() { jpeg_destroy_decompress(&jpeg); }
};

Decoder& decoder_of(j_common_ptr jpeg) { return *static_cast<Decoder*>(jpeg->client_data); }

[[noreturn]] void fail(Decoder& decoder, const char* what) {
  decoder.error = what;
  std::longjmp(decoder.leave, 1);
}

[[noreturn]] void on_error(j_common_ptr jpeg) {
  std::array<char, JMSG_LENGTH_MAX> text{};
  jpeg->err->format_message(jpeg, text.data());
  fail(decoder_of(jpeg), text.data());
}

// A warning says that data was made up: the file is damaged.
void on_message(j_common_ptr jpeg, int level) {
  if (level < 0) on_error(jpeg);
}

// A scan may be a few bytes for the whole picture. Encoders write some tens of them at most.
constexpr int most_scans = 500;

void on_progress(j_common_ptr jpeg) {
  if (decoder_of(jpeg).jpeg.input_scan_number > most_scans) fail(decoder_of(jpeg), "it has too many scans");
}

// Colours of print; Adobe stores them inverted.
void from_cmyk(const std::uint8_t* c, bool inverted, std::uint8_t* rgba) {
  const auto ink = [&](std::size_t k) { return inverted ? c[k] : 255 - c[k]; };
  for (std::size_t k = 0; k < 3; ++k) rgba[k] = static_cast<std::uint8_t>((ink(k) * ink(3) + 127) / 255);
}

// Returns false where it failed; decoder.error says why.
bool decode(Decoder& decoder, ByteSpan file) {
  if (setjmp(decoder.leave)) return false;
  jpeg_decompress_struct& jpeg = decoder.jpeg;
  jpeg_create_decompress(&jpeg);
  jpeg.progress = &decoder.progress;
  jpeg_mem_src(&jpeg, file.data(), file.size());
  jpeg_read_header(&jpeg, TRUE);
  if (jpeg.image_width > texture_size_limit || jpeg.image_height > texture_size_limit) {
    fail(decoder, "it is too large");
  }
  // A block of 64 texels takes a bit at least, which a scan of its own may stand for.
  if (std::size_t{jpeg.image_width} * jpeg.image_height / 512 > file.size()) {
    fail(decoder, "the file is far too short for its size (truncated)");
  }
  const bool prints = jpeg.jpeg_color_space == JCS_CMYK || jpeg.jpeg_color_space == JCS_YCCK;
  jpeg.out_color_space = prints ? JCS_CMYK : JCS_EXT_RGBA;
  jpeg.dct_method = JDCT_ISLOW;
  jpeg_start_decompress(&jpeg);
  decoder.texture.width = static_cast<int>(jpeg.output_width);
  decoder.texture.height = static_cast<int>(jpeg.output_height);
  const std::size_t pitch = std::size_t{4} * jpeg.output_width;
  decoder.texture.rgba.assign(pitch * jpeg.output_height, 255);
  decoder.row.resize(pitch);
  while (jpeg.output_scanline < jpeg.output_height) {
    std::uint8_t* out = &decoder.texture.rgba[pitch * jpeg.output_scanline];
    JSAMPROW into = prints ? decoder.row.data() : out;
    jpeg_read_scanlines(&jpeg, &into, 1);
    for (std::size_t k = 0; prints && k < pitch; k += 4) {
      from_cmyk(&decoder.row[k], jpeg.saw_Adobe_marker != 0, out + k);
    }
  }
  jpeg_finish_decompress(&jpeg);
  return true;
}

}  // namespace

bool is_jpeg(ByteSpan file) {
  return file.size() >= 3 && file[0] == 0xff && file[1] == 0xd8 && file[2] == 0xff;
}

Texture decode_jpeg(ByteSpan file, const std::string& origin) {
  Decoder decoder;
  decoder.texture.name = origin;
  decoder.jpeg.err = jpeg_std_error(&decoder.errors);
  decoder.errors.error_exit = on_error;
  decoder.errors.emit_message = on_message;
  decoder.progress.progress_monitor = on_progress;
  decoder.jpeg.client_data = &decoder;
  if (!decode(decoder, file)) ImageBytes{file, "JPEG", origin}.corrupt(decoder.error);
  return std::move(decoder.texture);
}

}  // namespace bitspan
