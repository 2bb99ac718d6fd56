// SPDX-License-Identifier: Apache-2.0
// DXT blocks against Mesa's decoder of S3TC.
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string_view>
#include <vector>

#include "model/stages/texel.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

constexpr int blocks_a_row = 256;
constexpr int block_rows = 64;

struct Destroy {
  void operator()(OSMesaContext context) const { OSMesaDestroyContext(context); }
};

Texture random_blocks(TexelFormat format, std::mt19937_64& random) {
  Texture t;
  t.format = format;
  t.width = 4 * blocks_a_row;
  t.height = 4 * block_rows;
  t.raw.resize(raw_size(format, t.width, t.height));
  for (std::uint8_t& byte : t.raw) byte = static_cast<std::uint8_t>(random());
  // Blocks with two words alike, and with two alphas alike.
  const auto bytes = static_cast<std::size_t>(texel_layout(format).block_bytes);
  for (std::size_t block = 0; block < t.raw.size(); block += 8 * bytes) {
    std::uint8_t* colors = &t.raw[block + bytes - 8];
    colors[2] = colors[0];
    colors[3] = colors[1];
    t.raw[block + 1] = t.raw[block];
  }
  return t;
}

TEST(TexelFormats, DxtBlocksAreMesas) {
  // The driver that decodes by S3TC's rule; llvmpipe mixes the colours of a block by another one.
  ASSERT_EQ(setenv("GALLIUM_DRIVER", "softpipe", 1), 0);
  const std::unique_ptr<std::remove_pointer_t<OSMesaContext>, Destroy> context(
      OSMesaCreateContextExt(OSMESA_RGBA, 0, 0, 0, nullptr));
  std::vector<std::uint8_t> picture(std::size_t{4} * 16 * 16);
  ASSERT_NE(context, nullptr);
  ASSERT_TRUE(OSMesaMakeCurrent(context.get(), picture.data(), GL_UNSIGNED_BYTE, 16, 16));
  const std::string_view extensions(reinterpret_cast<const char*>(glGetString(GL_EXTENSIONS)));
  ASSERT_NE(extensions.find("GL_EXT_texture_compression_s3tc"), std::string_view::npos);
  const int rounds = is_long_run() ? 62 : 2;  // of 16,384 blocks
  std::mt19937_64 random(1);
  std::vector<std::uint8_t> decoded(std::size_t{4} * 4 * blocks_a_row * 4 * block_rows);
  std::size_t compared = 0;
  for (const auto& [format, name] : {std::pair{TexelFormat::dxt1, GL_COMPRESSED_RGBA_S3TC_DXT1_EXT},
                                     {TexelFormat::dxt3, GL_COMPRESSED_RGBA_S3TC_DXT3_EXT},
                                     {TexelFormat::dxt5, GL_COMPRESSED_RGBA_S3TC_DXT5_EXT}}) {
    for (int round = 0; round < rounds; ++round) {
      const Texture t = random_blocks(format, random);
      GLuint id = 0;
      glGenTextures(1, &id);
      glBindTexture(GL_TEXTURE_2D, id);
      glCompressedTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLenum>(name), t.width, t.height, 0,
                             static_cast<GLsizei>(t.raw.size()), t.raw.data());
      glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, decoded.data());
      ASSERT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
      glDeleteTextures(1, &id);
      const std::uint8_t* mesa = decoded.data();
      for (int j = 0; j < t.height; ++j) {
        for (int i = 0; i < t.width; ++i, mesa += 4, ++compared) {
          const model::TexelCodes texel = model::texel_of(t, i, j);
          ASSERT_EQ(texel, (model::TexelCodes{mesa[0], mesa[1], mesa[2], mesa[3]}))
              << to_string(format) << " " << i << ", " << j;
        }
      }
    }
  }
  EXPECT_GE(compared, std::size_t{3} * 2 * 16384 * 16);
}

}  // namespace
}  // namespace bitspan
