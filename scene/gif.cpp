// SPDX-License-Identifier: Apache-2.0
#include "scene/gif.hpp"

#include <gif_lib.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <vector>

namespace bitspan {
namespace {

int read_bytes(GifFileType* gif, GifByteType* out, int size) {
  auto& file = *static_cast<ImageBytes*>(gif->UserData);
  const ByteSpan bytes = file.take(std::min(file.left(), static_cast<std::size_t>(size)));
  std::ranges::copy(bytes, out);
  return static_cast<int>(bytes.size());
}

struct Closer {
  void operator()(GifFileType* gif) const { DGifCloseFile(gif, nullptr); }
};
using Gif = std::unique_ptr<GifFileType, Closer>;

[[noreturn]] void fail(const ImageBytes& file, int error) {
  if (error == D_GIF_ERR_NOT_ENOUGH_MEM) throw std::bad_alloc();
  const bool ends = file.left() == 0 || error == D_GIF_ERR_EOF_TOO_SOON || error == D_GIF_ERR_READ_FAILED;
  const char* text = GifErrorString(error);
  file.corrupt(ends ? "the file ends too early (truncated)" : text == nullptr ? "its data is damaged" : text);
}
void check(const ImageBytes& file, const Gif& gif, int status) {
  if (status != GIF_OK) fail(file, gif->Error);
}

// Goes to the first frame. Returns its transparent index, NO_TRANSPARENT_COLOR where it has none.
int find_frame(const ImageBytes& file, const Gif& gif) {
  int transparent = NO_TRANSPARENT_COLOR;
  for (;;) {
    GifRecordType record = UNDEFINED_RECORD_TYPE;
    check(file, gif, DGifGetRecordType(gif.get(), &record));
    switch (record) {
      case IMAGE_DESC_RECORD_TYPE:
        return transparent;
      case EXTENSION_RECORD_TYPE:
        break;
      case UNDEFINED_RECORD_TYPE:
      case SCREEN_DESC_RECORD_TYPE:
      case TERMINATE_RECORD_TYPE:
        file.corrupt("it has no frame");
    }
    int function = 0;
    GifByteType* block = nullptr;  // its size, and as many bytes
    check(file, gif, DGifGetExtension(gif.get(), &function, &block));
    if (function == GRAPHICS_EXT_FUNC_CODE && block != nullptr) {
      GraphicsControlBlock control{};
      if (DGifExtensionToGCB(block[0], block + 1, &control) == GIF_OK) transparent = control.TransparentColor;
    }
    while (block != nullptr) check(file, gif, DGifGetExtensionNext(gif.get(), &block));
  }
}

// An index that the palette does not have is black.
Rgba color_of(const ColorMapObject& palette, int index, int transparent) {
  Rgba out = opaque_black;
  if (index < palette.ColorCount) {
    const GifColorType& c = palette.Colors[index];
    out = {c.Red, c.Green, c.Blue, 255};
  }
  if (index == transparent) out[3] = 0;
  return out;
}

// What stands where the frame does not.
Rgba background(const GifFileType& gif, const ColorMapObject& palette, int transparent) {
  if (transparent != NO_TRANSPARENT_COLOR) return color_of(palette, transparent, transparent);
  if (gif.SColorMap == nullptr) return {0, 0, 0, 0};
  return color_of(*gif.SColorMap, gif.SBackGroundColor, NO_TRANSPARENT_COLOR);
}

struct RowPass {
  int first, step;
};
constexpr std::array<RowPass, 1> in_order{{{0, 1}}};
constexpr std::array<RowPass, 4> interlaced{{{0, 8}, {4, 8}, {2, 4}, {1, 2}}};

}  // namespace

bool is_gif(ByteSpan file) { return file.size() >= 3 && file[0] == 'G' && file[1] == 'I' && file[2] == 'F'; }

Texture decode_gif(ByteSpan data, const std::string& origin) {
  ImageBytes file{data, "GIF", origin};
  int error = 0;
  const Gif gif(DGifOpen(&file, read_bytes, &error));
  if (!gif) fail(file, error);
  const int transparent = find_frame(file, gif);
  check(file, gif, DGifGetImageDesc(gif.get()));
  const GifImageDesc frame = gif->Image;
  const ColorMapObject* palette = frame.ColorMap != nullptr ? frame.ColorMap : gif->SColorMap;
  if (palette == nullptr) file.corrupt("it has no palette");
  if (frame.Width < 1 || frame.Height < 1) file.corrupt("its frame has no texels");

  // A frame that leaves the canvas makes it larger.
  const int width = std::max(gif->SWidth, frame.Left + frame.Width);
  const int height = std::max(gif->SHeight, frame.Top + frame.Height);
  // A code stands for at most 4,096 texels and takes at least three bits. The canvas may be larger than its
  // frame; of a file that stands for more than this, the size is at fault.
  constexpr std::size_t most_texels_per_byte = 4096;
  Texture out =
      file.texture(width, height,
                   static_cast<std::size_t>(width) * static_cast<std::size_t>(height) / most_texels_per_byte);
  const Rgba outside = background(*gif, *palette, transparent);
  for (std::size_t k = 0; k < out.rgba.size(); k += 4) store(&out.rgba[k], outside);

  std::vector<GifPixelType> row(static_cast<std::size_t>(frame.Width));
  const std::span<const RowPass> passes = frame.Interlace ? std::span<const RowPass>(interlaced) : in_order;
  for (const RowPass& pass : passes) {
    for (int y = pass.first; y < frame.Height; y += pass.step) {
      check(file, gif, DGifGetLine(gif.get(), row.data(), frame.Width));
      std::uint8_t* texel = texel_at(out, frame.Left, frame.Top + y);
      for (const GifPixelType index : row) {
        store(texel, color_of(*palette, index, transparent));
        texel += 4;
      }
    }
  }
  return out;
}

}  // namespace bitspan
