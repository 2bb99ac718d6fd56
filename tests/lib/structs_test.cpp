// SPDX-License-Identifier: Apache-2.0
// Structs of callers that were compiled with another version of the header: shorter and longer than the
// library's.
#include <gtest/gtest.h>

#include <array>
#include <cctype>
#include <cstddef>
#include <cstring>
#include <string>

#include "model/stages/texel.hpp"
#include "scene/procedural.hpp"
#include "scene/tri_stream.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

// A struct with more behind it.
template <class T>
struct Longer {
  T known;
  std::array<std::uint64_t, 3> more;
};

constexpr std::size_t through_s = offsetof(bs_vertex, s) + sizeof(double);

Scene one_texture() {
  Scene scene;
  scene.name = "one";
  scene.width = 32;
  scene.height = 24;
  scene.textures.push_back({"checker", 2, 2, {9, 8, 7, 255, 1, 2, 3, 255, 4, 5, 6, 255, 99, 98, 97, 255}});
  Triangle t;
  t.v[0] = {1, 1, 2, 0, 0, {1, 1, 1, 1}};
  t.v[1] = {30, 2, 2, 0, 0, {1, 1, 1, 1}};
  t.v[2] = {3, 22, 2, 0, 0, {1, 1, 1, 1}};
  t.texture = 0;
  scene.triangles.push_back(t);
  t.v[0].y = 5;
  t.v[2].s = 1.5;
  scene.triangles.push_back(t);
  return scene;
}

std::vector<std::uint8_t> picture(bs_model* model) { return plane<std::uint8_t>(model, BS_PLANE_COLOR); }

// Elements of an array, each cut or grown to `stride` bytes.
template <class T>
std::vector<std::uint64_t> restrided(const std::vector<T>& array, std::size_t stride,
                                     std::uint8_t filler = 0) {
  std::vector<std::uint64_t> out(array.size() * stride / sizeof(std::uint64_t));
  auto* at = reinterpret_cast<unsigned char*>(out.data());
  for (T element : array) {
    element.size = stride;
    std::memset(at, filler, stride);
    std::memcpy(at, &element, std::min(stride, sizeof element));
    at += stride;
  }
  return out;
}

struct Bench {
  Bench() : scene(one_texture()), described(scene), config(config_handle("depth16")) {
    model = open_model(config.get(), "model");
    draw(model.get(), described);
    expected = picture(model.get());
  }
  Scene scene;
  Described described;
  ConfigHandle config;
  ModelHandle model;
  std::vector<std::uint8_t> expected;
};

TEST(LibStructs, VerticesOfEverySize) {
  Bench b;
  const auto drawn = [&](const void* vertices) {
    EXPECT_EQ(bs_begin(b.model.get(), &b.described.desc), BS_OK);
    return bs_draw(b.model.get(), static_cast<const bs_vertex*>(vertices), b.described.texture_of.data(),
                   b.scene.triangles.size(), 0, 0);
  };
  // The vertices have the defaults of u, v and the colour.
  for (const std::size_t size : {through_s, sizeof(bs_vertex), sizeof(bs_vertex) + 24, std::size_t{4096}}) {
    const auto array = restrided(b.described.vertices, size);
    EXPECT_EQ(drawn(array.data()), BS_OK) << bs_last_error();
    EXPECT_EQ(picture(b.model.get()), b.expected) << size;
  }
  for (const std::size_t size : {through_s - 8, through_s + 4, std::size_t{4104}}) {
    const auto array = restrided(b.described.vertices, size);
    EXPECT_EQ(drawn(array.data()), BS_BAD_INPUT) << size;
  }
  const auto newer = restrided(b.described.vertices, sizeof(bs_vertex) + 24, 1);
  EXPECT_EQ(drawn(newer.data()), BS_UNSUPPORTED);
  auto mixed = b.described.vertices;
  mixed[4].size = through_s;
  EXPECT_EQ(drawn(mixed.data()), BS_BAD_INPUT);
  EXPECT_NE(std::string(bs_last_error()).find("v[4].size: "), std::string::npos) << bs_last_error();
}

TEST(LibStructs, TexturesOfEverySize) {
  Bench b;
  const auto begun = [&](const void* textures) {
    b.described.desc.textures = static_cast<const bs_texture*>(textures);
    return bs_begin(b.model.get(), &b.described.desc);
  };
  b.described.textures.push_back(b.described.textures[0]);
  b.described.desc.texture_count = 2;
  const std::size_t through_rgba = offsetof(bs_texture, rgba) + sizeof(void*);
  for (const std::size_t size : {through_rgba, sizeof(bs_texture), sizeof(bs_texture) + 8}) {
    const auto array = restrided(b.described.textures, size);
    ASSERT_EQ(begun(array.data()), BS_OK) << bs_last_error();
    ASSERT_EQ(bs_draw(b.model.get(), b.described.vertices.data(), b.described.texture_of.data(), 2, 0, 0),
              BS_OK);
    EXPECT_EQ(picture(b.model.get()), b.expected) << size;
  }
  EXPECT_EQ(begun(restrided(b.described.textures, through_rgba - 8).data()), BS_BAD_INPUT);
  EXPECT_EQ(begun(restrided(b.described.textures, sizeof(bs_texture) + 8, 1).data()), BS_UNSUPPORTED);
}

// What a description with a texel format draws, and what bs_scene_get gives of such a texture.
TEST(LibStructs, TexelFormatsOfTextures) {
  Bench b;
  const Texture image = b.scene.textures[0];
  for (std::size_t f = 1; f < enum_names<TexelFormat>.size(); ++f) {
    const auto format = static_cast<TexelFormat>(f);
    Texture t{"t", image.width, image.height, {}};
    t.format = format;
    for (std::size_t k = 0; k < raw_size(format, t.width, t.height); ++k) {
      t.raw.push_back(static_cast<std::uint8_t>(200 - k * 3));
    }
    for (int k = 0; k < texel_layout(format).table_size && !is_procedural(format); ++k)
      t.table.push_back(static_cast<std::int16_t>(90 + k % 60));
    if (is_procedural(format)) {
      Random random(f);
      t.table = random_procedural(random, format, t.width, t.height).table;
    }
    Scene plain = b.scene;
    plain.textures[0].rgba.clear();
    for (int j = 0; j < t.height; ++j) {
      for (int i = 0; i < t.width; ++i) {
        const model::TexelCodes c = model::texel_of(t, i, j);
        plain.textures[0].rgba.insert(plain.textures[0].rgba.end(), c.begin(), c.end());
      }
    }
    Scene formatted = b.scene;
    formatted.textures[0] = t;
    const Described want(plain), have(formatted);
    draw(b.model.get(), want);
    const auto expected = picture(b.model.get());
    draw(b.model.get(), have);
    EXPECT_EQ(picture(b.model.get()), expected) << to_string(format);

    const TemporaryFolder folder;
    write_tri_file(folder.path("t.tri"), formatted);
    bs_scene* loaded = nullptr;
    ASSERT_EQ(bs_scene_load(folder.path("t.tri").c_str(), 0, 0, &loaded), BS_OK) << bs_last_error();
    const std::unique_ptr<bs_scene, CloseHandle> scene(loaded);
    bs_scene_desc desc = BS_SCENE_DESC_INIT;
    ASSERT_EQ(bs_scene_get(scene.get(), &desc), BS_OK);
    const bs_texture& got = desc.textures[0];
    EXPECT_EQ(got.format, static_cast<bs_texel_format>(format));
    EXPECT_EQ(std::vector(got.raw, got.raw + got.raw_size), t.raw);
    EXPECT_EQ(std::vector(got.table, got.table + got.table_size), t.table);
    EXPECT_EQ(std::vector(got.rgba, got.rgba + plain.textures[0].rgba.size()), plain.textures[0].rgba);
  }
}

TEST(LibStructs, ARowStrideOfATexture) {
  Bench b;
  std::vector<std::uint8_t> padded;
  for (std::size_t y = 0; y < 2; ++y) {
    const auto row = b.scene.textures[0].rgba.begin() + static_cast<std::ptrdiff_t>(8 * y);
    padded.insert(padded.end(), row, row + 8);
    padded.insert(padded.end(), 5, 0xee);
  }
  // The second row of texels.
  for (bs_vertex& v : b.described.vertices) v.v = 1.5;
  draw(b.model.get(), b.described);
  const auto expected = picture(b.model.get());
  EXPECT_NE(expected, b.expected);
  b.described.textures[0].rgba = padded.data();
  b.described.textures[0].stride = 13;
  draw(b.model.get(), b.described);
  EXPECT_EQ(picture(b.model.get()), expected);
}

TEST(LibStructs, SceneDescriptionsOfEverySize) {
  Bench b;
  Longer<bs_scene_desc> longer{b.described.desc, {}};
  longer.known.size = sizeof longer;
  ASSERT_EQ(bs_begin(b.model.get(), &longer.known), BS_OK) << bs_last_error();
  ASSERT_EQ(bs_draw(b.model.get(), b.described.vertices.data(), b.described.texture_of.data(), 2, 0, 0),
            BS_OK);
  EXPECT_EQ(picture(b.model.get()), b.expected);
  longer.more[2] = 1;
  EXPECT_EQ(bs_begin(b.model.get(), &longer.known), BS_UNSUPPORTED);
  // Width and height alone: the rest is the default, so there is no texture.
  bs_scene_desc least = BS_SCENE_DESC_INIT;
  least.size = offsetof(bs_scene_desc, s_min);
  least.width = 32;
  least.height = 24;
  least.s_min = -1;  // not read
  least.texture_count = 77;
  ASSERT_EQ(bs_begin(b.model.get(), &least), BS_OK) << bs_last_error();
  EXPECT_EQ(bs_triangle(b.model.get(), b.described.vertices.data(), -1, 0, 0), BS_OK) << bs_last_error();
  EXPECT_EQ(bs_triangle(b.model.get(), b.described.vertices.data(), 0, 0, 0), BS_BAD_INPUT);
  for (const std::size_t size : {std::size_t{0}, std::size_t{8}, least.size + 1, std::size_t{5000}}) {
    least.size = size;
    EXPECT_EQ(bs_begin(b.model.get(), &least), BS_BAD_INPUT) << size;
  }
}

// Fills structs of three sizes and compares what both have.
template <class T, class Fill>
void expect_filled(std::size_t least, const Fill& fill) {
  T known{};
  known.size = sizeof known;
  ASSERT_EQ(fill(&known), BS_OK) << bs_last_error();
  Longer<T> longer;
  std::memset(&longer, 0xee, sizeof longer);
  longer.known.size = sizeof longer;
  ASSERT_EQ(fill(&longer.known), BS_OK) << bs_last_error();
  EXPECT_EQ(longer.more, (std::array<std::uint64_t, 3>{}));
  EXPECT_EQ(longer.known.size, sizeof longer);
  longer.known.size = sizeof known;
  EXPECT_EQ(std::memcmp(&longer.known, &known, sizeof known), 0);
  T cut;
  std::memset(&cut, 0xee, sizeof cut);
  cut.size = least;
  ASSERT_EQ(fill(&cut), BS_OK) << bs_last_error();
  EXPECT_EQ(cut.size, least);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(&cut);
  EXPECT_EQ(std::memcmp(bytes + sizeof(std::size_t),
                        reinterpret_cast<const unsigned char*>(&known) + sizeof(std::size_t),
                        least - sizeof(std::size_t)),
            0);
  for (std::size_t i = least; i < sizeof cut; ++i)
    EXPECT_EQ(bytes[i], 0xee) << "byte " << i << " was written";
  for (const std::size_t size : {std::size_t{0}, least - 8, least + 1, std::size_t{1} << 40}) {
    cut.size = size;
    EXPECT_EQ(fill(&cut), BS_BAD_INPUT) << size;
  }
}

TEST(LibStructs, FilledByTheCallersSize) {
  Bench b;
  expect_filled<bs_field_info>(offsetof(bs_field_info, unit), [&](bs_field_info* to) {
    return bs_field(b.config.get(), BS_STAGE_SPAN, 6, to);
  });
  expect_filled<bs_view>(sizeof(bs_view),
                         [&](bs_view* to) { return bs_records(b.model.get(), BS_STAGE_SPAN, to); });
  expect_filled<bs_view>(sizeof(bs_view),
                         [&](bs_view* to) { return bs_frame_view(b.model.get(), BS_PLANE_DEPTH, to); });
  expect_filled<bs_divergence>(sizeof(bs_divergence), [&](bs_divergence* to) {
    return bs_check(b.model.get(), BS_STAGE_SPAN, nullptr, 0, to);
  });
  bs_scene* scene = nullptr;
  ASSERT_EQ(bs_scene_load("demo", 64, 48, &scene), BS_OK);
  expect_filled<bs_scene_desc>(offsetof(bs_scene_desc, s_min),
                               [&](bs_scene_desc* to) { return bs_scene_get(scene, to); });
  bs_scene_free(scene);
}

// The package of SystemVerilog names the stages by the same numbers.
TEST(DpiPackage, NumbersEveryStage) {
  const std::string package = read_file(source_path("dv/dpi/bitspan_pkg.sv"));
  for (bs_stage stage = 0; bs_stage_name(stage) != nullptr; ++stage) {
    std::string name = "Stage";  // StageSetupEdge of setup.edge
    bool begins = true;
    for (const char* c = bs_stage_name(stage); *c != '\0'; ++c) {
      const bool is_letter = *c != '.' && *c != '_';
      if (is_letter) name += begins ? static_cast<char>(std::toupper(*c)) : *c;
      begins = !is_letter;
    }
    EXPECT_NE(package.find("localparam int " + name + " = " + std::to_string(stage) + ";"), std::string::npos)
        << name;
  }
}

}  // namespace
}  // namespace bitspan
