// SPDX-License-Identifier: Apache-2.0
#include "scene/texels.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "config/config.hpp"
#include "scene/procedural.hpp"

namespace bitspan {
namespace {

using Codes = std::array<int, 4>;

// The code of n bits nearest to an 8-bit code.
int narrowed(int c, int bits) {
  const int top = (1 << bits) - 1;
  return (2 * c * top + 255) / 510;
}
int repeated(int c, int bits) { return bits == 5 ? c << 3 | c >> 2 : c << 2 | c >> 4; }

int intensity(const Codes& c) { return (77 * c[0] + 150 * c[1] + 29 * c[2] + 128) >> 8; }

int distance(const Codes& a, const Codes& b, std::size_t channels) {
  int sum = 0;
  for (std::size_t c = 0; c < channels; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

// The first of the candidates that lie nearest.
int nearest(const Codes& color, std::span<const Codes> candidates, std::size_t channels) {
  const auto best = std::ranges::min_element(
      candidates, {}, [&](const Codes& candidate) { return distance(color, candidate, channels); });
  return static_cast<int>(best - candidates.begin());
}

// What each 8-bit code of a format with a table stands for.
std::vector<Codes> colors_of(TexelFormat format, std::span<const std::int16_t> table) {
  std::vector<Codes> out;
  for (std::size_t code = 0; code < 256; ++code) {
    Codes c{0, 0, 0, 255};
    if (texel_layout(format).table_size == palette_size) {
      for (std::size_t k = 0; k < 4; ++k) c[k] = table[4 * code + k];
    } else {
      for (std::size_t k = 0; k < 3; ++k) {
        const int sum =
            table[code >> 4] + table[16 + 3 * (code >> 2 & 3) + k] + table[28 + 3 * (code & 3) + k];
        c[k] = std::clamp(sum, 0, 255);
      }
    }
    out.push_back(c);
  }
  return out;
}

class Converter {
 public:
  Converter(const Texture& image, Texture& out) : image_(image), out_(out) {}

  void run() {
    switch (out_.format) {
      case TexelFormat::rgba8888:
        out_.rgba = image_.rgba;
        break;
      case TexelFormat::rgb332:
      case TexelFormat::yiq422:
      case TexelFormat::a8:
      case TexelFormat::i8:
      case TexelFormat::ai44:
      case TexelFormat::p8:
      case TexelFormat::argb8332:
      case TexelFormat::rgb565:
      case TexelFormat::argb1555:
      case TexelFormat::argb4444:
      case TexelFormat::ai88:
      case TexelFormat::ap88:
      case TexelFormat::ayiq8422:
      case TexelFormat::depth:
        words();
        break;
      case TexelFormat::dxt1:
      case TexelFormat::dxt3:
      case TexelFormat::dxt5:
        for (int j = 0; j < image_.height; j += 4) {
          for (int i = 0; i < image_.width; i += 4) block(i, j);
        }
        break;
      case TexelFormat::uyvy:
      case TexelFormat::yuyv:
        for (int j = 0; j < image_.height; ++j) {
          for (int i = 0; i < image_.width; i += 2) pair(i, j);
        }
        break;
      case TexelFormat::checker:
      case TexelFormat::brick:
      case TexelFormat::noise:
        throw InputError(std::string(to_string(out_.format)) +
                         ": is computed and takes no image; expected a format with texels in memory");
    }
  }

 private:
  // The edge's texel goes on.
  Codes at(int i, int j) const {
    const auto column = static_cast<std::size_t>(std::min(i, image_.width - 1));
    const auto row = static_cast<std::size_t>(std::min(j, image_.height - 1));
    const std::uint8_t* p = &image_.rgba[4 * (row * static_cast<std::size_t>(image_.width) + column)];
    return {p[0], p[1], p[2], p[3]};
  }
  void put(unsigned value, int bytes) {
    for (int i = 0; i < bytes; ++i) out_.raw.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }

  void words() {
    const TexelLayout layout = texel_layout(out_.format);
    const bool by_table = layout.table_size != 0;
    const std::vector<Codes> colors = by_table ? colors_of(out_.format, out_.table) : std::vector<Codes>{};
    const std::size_t channels = out_.format == TexelFormat::p8 ? 4 : 3;
    std::map<Codes, int> known;
    for (int j = 0; j < image_.height; ++j) {
      for (int i = 0; i < image_.width; ++i) {
        const Codes c = at(i, j);
        int entry = 0;
        if (by_table) {
          const auto [found, is_new] = known.try_emplace(c, 0);
          if (is_new) found->second = nearest(c, colors, channels);
          entry = found->second;
        }
        put(static_cast<unsigned>(word(c, entry)), layout.block_bytes);
      }
    }
  }
  int word(const Codes& c, int entry) const {
    const auto n = [&](std::size_t channel, int bits) { return narrowed(c[channel], bits); };
    const int rgb332 = n(0, 3) << 5 | n(1, 3) << 2 | n(2, 2);
    switch (out_.format) {
      case TexelFormat::rgb332:
        return rgb332;
      case TexelFormat::yiq422:
      case TexelFormat::p8:
        return entry;
      case TexelFormat::a8:
        return c[3];
      case TexelFormat::i8:
        return intensity(c);
      case TexelFormat::ai44:
        return n(3, 4) << 4 | narrowed(intensity(c), 4);
      case TexelFormat::argb8332:
        return c[3] << 8 | rgb332;
      case TexelFormat::rgb565:
        return n(0, 5) << 11 | n(1, 6) << 5 | n(2, 5);
      case TexelFormat::argb1555:
        return n(3, 1) << 15 | n(0, 5) << 10 | n(1, 5) << 5 | n(2, 5);
      case TexelFormat::argb4444:
        return n(3, 4) << 12 | n(0, 4) << 8 | n(1, 4) << 4 | n(2, 4);
      case TexelFormat::ai88:
        return c[3] << 8 | intensity(c);
      case TexelFormat::ap88:
      case TexelFormat::ayiq8422:
        return c[3] << 8 | entry;
      case TexelFormat::depth:
        return intensity(c) << 24;
      case TexelFormat::rgba8888:
      case TexelFormat::dxt1:
      case TexelFormat::dxt3:
      case TexelFormat::dxt5:
      case TexelFormat::uyvy:
      case TexelFormat::yuyv:
      case TexelFormat::checker:
      case TexelFormat::brick:
      case TexelFormat::noise:
        break;
    }
    unreachable();
  }

  void pair(int i, int j) {
    const Codes a = at(i, j);
    const Codes b = at(i + 1, j);
    const auto y = [](const Codes& c) { return ((66 * c[0] + 129 * c[1] + 25 * c[2] + 128) >> 8) + 16; };
    const int r = a[0] + b[0];
    const int g = a[1] + b[1];
    const int blue = a[2] + b[2];
    const int u = ((-38 * r - 74 * g + 112 * blue + 256) >> 9) + 128;
    const int v = ((112 * r - 94 * g - 18 * blue + 256) >> 9) + 128;
    const bool u_first = out_.format == TexelFormat::uyvy;
    for (const int code : {u_first ? u : y(a), u_first ? y(a) : u, u_first ? v : y(b), u_first ? y(b) : v}) {
      put(static_cast<unsigned>(code), 1);
    }
  }

  void block(int i, int j) {
    std::array<Codes, 16> texels;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    for (int k = 0; k < 16; ++k) texels[static_cast<std::size_t>(k)] = at(i + k % 4, j + k / 4);
    const bool own_alpha = out_.format != TexelFormat::dxt1;
    const auto is_clear = [&](const Codes& c) { return !own_alpha && c[3] < 128; };
    if (out_.format == TexelFormat::dxt3) {
      for (std::size_t k = 0; k < 16; k += 2) {
        put(static_cast<unsigned>(narrowed(texels[k][3], 4) | narrowed(texels[k + 1][3], 4) << 4), 1);
      }
    }
    if (out_.format == TexelFormat::dxt5) alphas(texels);
    Codes low{255, 255, 255, 0};
    Codes high{0, 0, 0, 0};
    for (const Codes& c : texels) {
      if (is_clear(c)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], c[k]);
        high[k] = std::max(high[k], c[k]);
      }
    }
    const bool holes = std::ranges::any_of(texels, is_clear);
    const auto word565 = [](const Codes& c) {
      return narrowed(c[0], 5) << 11 | narrowed(c[1], 6) << 5 | narrowed(c[2], 5);
    };
    int first = word565(high);
    int second = word565(low);
    // The order of the two says whether a block has holes.
    if (holes ? first > second : first < second) std::swap(first, second);
    const auto expanded = [](int word) {
      return Codes{repeated(word >> 11, 5), repeated(word >> 5 & 63, 6), repeated(word & 31, 5), 0};
    };
    const Codes a = expanded(first);
    const Codes b = expanded(second);
    std::vector<Codes> colors{a, b};
    if (own_alpha || first > second) {
      colors.push_back(between(a, b, 2, 1));
      colors.push_back(between(a, b, 1, 2));
    } else {
      colors.push_back(between(a, b, 1, 1));
    }
    put(static_cast<unsigned>(first) | static_cast<unsigned>(second) << 16, 4);
    unsigned codes = 0;
    for (std::size_t k = 0; k < 16; ++k) {
      const int code = is_clear(texels[k]) ? 3 : nearest(texels[k], colors, 3);
      codes |= static_cast<unsigned>(code) << (2 * k);
    }
    put(codes, 4);
  }
  static Codes between(const Codes& a, const Codes& b, int of_a, int of_b) {
    Codes out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = (of_a * a[k] + of_b * b[k]) / (of_a + of_b);
    return out;
  }
  void alphas(const std::array<Codes, 16>& texels) {
    int low = 255;
    int high = 0;
    for (const Codes& c : texels) {
      low = std::min(low, c[3]);
      high = std::max(high, c[3]);
    }
    std::vector<Codes> levels{{high, 0, 0, 0}, {low, 0, 0, 0}};
    if (high > low) {
      for (int k = 1; k < 7; ++k) levels.push_back({((7 - k) * high + k * low) / 7, 0, 0, 0});
    }
    put(static_cast<unsigned>(high | low << 8), 2);
    std::uint64_t codes = 0;
    for (std::size_t k = 0; k < 16; ++k) {
      codes |= static_cast<std::uint64_t>(nearest({texels[k][3], 0, 0, 0}, levels, 1)) << (3 * k);
    }
    put(static_cast<unsigned>(codes), 4);
    put(static_cast<unsigned>(codes >> 32), 2);
  }

  const Texture& image_;
  Texture& out_;
};

std::vector<std::int16_t> own_palette(const Texture& image, TexelFormat format) {
  std::map<Codes, bool> known;
  std::vector<std::int16_t> out;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const std::uint8_t* p = &image.rgba[i];
    const Codes c{p[0], p[1], p[2], format == TexelFormat::p8 ? p[3] : 255};
    if (!known.try_emplace(c, true).second) continue;
    if (known.size() > 256) {
      throw InputError(image.name + ": has more than 256 colours; expected a palette, or fewer colours");
    }
    for (const int code : c) out.push_back(static_cast<std::int16_t>(code));
  }
  // The rest repeats the first, which is found before it.
  while (out.size() < palette_size) out.push_back(out[out.size() % 4]);
  return out;
}

}  // namespace

bool is_whole(const Texture& t) {
  if (t.width < 1 || t.height < 1) return false;
  const std::size_t size = raw_size(t.format, t.width, t.height);
  const auto table = static_cast<std::size_t>(texel_layout(t.format).table_size);
  const bool plain = t.format == TexelFormat::rgba8888;
  return (plain ? t.rgba : t.raw).size() == size && (plain ? t.raw : t.rgba).empty() &&
         t.table.size() == table && (!is_procedural(t.format) || procedural_fault(t).empty());
}

std::size_t byte_count(const Texture& texture) {
  return raw_size(texture.format, texture.width, texture.height);
}

Texture converted(const Texture& image, TexelFormat format, std::vector<std::int16_t> table) {
  Texture out;
  out.name = image.name;
  out.width = image.width;
  out.height = image.height;
  out.format = format;
  const auto size = static_cast<std::size_t>(texel_layout(format).table_size);
  if (size == palette_size && table.empty()) table = own_palette(image, format);
  if (table.size() != size) {
    throw InputError(image.name + ": the table of " + std::string(to_string(format)) + " has " +
                     std::to_string(table.size()) + " values; expected " + std::to_string(size));
  }
  out.table = std::move(table);
  Converter(image, out).run();
  return out;
}

}  // namespace bitspan
