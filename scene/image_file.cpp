// SPDX-License-Identifier: Apache-2.0
#include "scene/image_file.hpp"

#include <algorithm>
#include <array>

#include "config/config.hpp"
#include "scene/bmp.hpp"
#include "scene/gif.hpp"
#include "scene/jpeg.hpp"
#include "scene/png.hpp"
#include "scene/pnm.hpp"
#include "scene/texture.hpp"
#include "scene/tga.hpp"

namespace bitspan {
namespace {

using namespace std::string_view_literals;

struct Reader {
  bool (*is)(ByteSpan);
  Texture (*decode)(ByteSpan, const std::string&);
};
// A TGA has no signature, so it is asked for last.
constexpr std::array<Reader, 6> readers{{{is_png, decode_png},
                                         {is_jpeg, decode_jpeg},
                                         {is_bmp, decode_bmp},
                                         {is_gif, decode_gif},
                                         {is_pnm, decode_pnm},
                                         {is_tga, decode_tga}}};

// Formats that textures of meshes come in, and that are not read.
struct Foreign {
  std::string_view name;
  std::size_t at;
  std::string_view signature;
};
constexpr std::array<Foreign, 18> foreign{{{"KTX 2", 0, "\xabKTX 20\xbb"sv},
                                           {"KTX", 0, "\xabKTX"sv},
                                           {"DDS", 0, "DDS "sv},
                                           {"WebP", 8, "WEBP"sv},
                                           {"AVIF", 4, "ftypavif"sv},
                                           {"HEIF", 4, "ftyphei"sv},
                                           {"HEIF", 4, "ftypmif1"sv},
                                           {"JPEG 2000", 4, "jP  \r\n"sv},
                                           {"JPEG 2000", 0, "\xff\x4f\xff\x51"sv},
                                           {"JPEG XL", 0, "\xff\x0a"sv},
                                           {"JPEG XL", 4, "JXL \r\n"sv},
                                           {"TIFF", 0, "II*\0"sv},
                                           {"TIFF", 0, "MM\0*"sv},
                                           {"Photoshop", 0, "8BPS"sv},
                                           {"OpenEXR", 0, "v/1\x01"sv},
                                           {"Radiance HDR", 0, "#?"sv},
                                           {"PAM", 0, "P7\n"sv},
                                           {"a pointer of Git LFS", 0, "version https://git-lfs"sv}}};

bool is_foreign(ByteSpan head, const Foreign& format) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  return text.size() >= format.at && text.substr(format.at).starts_with(format.signature);
}

// Null where the format is none that is read.
const Reader* reader_of(ByteSpan head) {
  const auto* found = std::ranges::find_if(readers, [&](const Reader& reader) { return reader.is(head); });
  return found == readers.end() ? nullptr : found;
}

[[noreturn]] void refuse_format(ByteSpan head, const std::string& origin) {
  std::string what = "not an image that can be read";
  if (head.empty()) what += ": it is empty";
  const auto* found =
      std::ranges::find_if(foreign, [&](const Foreign& format) { return is_foreign(head, format); });
  if (found != foreign.end()) what += ": its format is " + std::string(found->name);
  const std::string limit = std::to_string(texture_size_limit);
  throw InputError(origin + ": " + what + "; expected a whole " + std::string(image_formats) +
                   " file of at most " + limit + " x " + limit + " texels");
}

}  // namespace

void check_image_format(ByteSpan head, const std::string& origin) {
  if (reader_of(head) == nullptr) refuse_format(head, origin);
}

Texture decode_image(ByteSpan file, const std::string& origin) {
  const Reader* reader = reader_of(file);
  if (reader == nullptr) refuse_format(file, origin);
  return reader->decode(file, origin);
}

}  // namespace bitspan
