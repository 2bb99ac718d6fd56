// SPDX-License-Identifier: Apache-2.0
// Files with random damage: each is read as something whole, or refused in one line. The sanitizers watch.
#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "scene/mtl.hpp"
#include "scene/obj.hpp"
#include "scene/ply.hpp"
#include "scene/random.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

std::size_t pick(Random& random, std::size_t size) {
  return static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(size) - 1));
}

// Damages the text in a few places.
std::string mutant(Random& random, std::span<const std::string> seeds, std::span<const std::string> words) {
  std::string text = seeds[pick(random, seeds.size())];
  for (std::int64_t change = random.integer(1, 6); change > 0 && !text.empty(); --change) {
    const std::size_t at = pick(random, text.size());
    const std::size_t length = std::min(text.size() - at, pick(random, 24) + 1);
    switch (random.integer(0, 8)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ (1 << random.integer(0, 7)));
        break;
      case 1:
        text[at] = static_cast<char>(random.integer(0, 255));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(pick(random, text.size()), length));
        break;
      case 4:
        if (random.chance(0.2)) text.resize(at);
        break;
      case 5: {
        const std::string& other = seeds[pick(random, seeds.size())];
        if (random.chance(0.2)) text = text.substr(0, at) + other.substr(pick(random, other.size()));
        break;
      }
      case 6:
        text.replace(at, std::min<std::size_t>(length, 4), words[pick(random, words.size())]);
        break;
      default:
        text.insert(at, words[pick(random, words.size())]);
    }
  }
  return text;
}

void expect_whole(const MeshFile& file) {
  for (const MeshMaterial& m : file.materials) {
    ASSERT_LT(m.image, static_cast<int>(file.images.size()));
    for (const double c : m.color) ASSERT_TRUE(std::isfinite(c));
  }
  for (const MeshTriangle& t : file.triangles) {
    ASSERT_LT(t.material, static_cast<int>(file.materials.size()));
    for (const MeshCorner& c : t.corner) {
      ASSERT_TRUE(std::isfinite(c.position.x + c.u * 0 + c.v * 0 + c.color[0] * 0 + c.color[3] * 0) ||
                  std::fabs(c.position.x) > 1e300);
    }
  }
  for (const std::string& note : file.notes) ASSERT_EQ(note.find('\n'), std::string::npos);
}

// Calls read(text) for each damaged file.
template <class Read>
void fuzz(std::uint64_t seed, std::span<const std::string> seeds, std::span<const std::string> words,
          const Read& read) {
  Random random(seed);
  const int files = is_long_run() ? 1000000 : 100000;
  int refused = 0;
  for (const std::string& text : seeds) ASSERT_EQ(error_of([&] { read(text); }), "") << text;
  for (int i = 0; i < files; ++i) {
    const std::string text = mutant(random, seeds, words);
    refused += error_of([&] { read(text); }).empty() ? 0 : 1;
    ASSERT_FALSE(testing::Test::HasFailure()) << "file " << i << ":\n" << text;
  }
  EXPECT_GT(refused, files / 20);
  EXPECT_LT(refused, files - files / 20);
}

const std::vector<std::string> numbers{
    "0",           "-1",   "1e400", "1.#IND", "nan",   "4294967295", "2147483648",
    "1e-400",      "-0.0", "65536", "0,5",    "1e300", "1e-300",     "99999999999999999999",
    " ",           "\n",   "\r",    "\\\n",   "\t",    "#",          std::string(1, '\0'),
    "\xEF\xBB\xBF"};

std::vector<std::string> with_numbers(std::vector<std::string> words) {
  words.insert(words.end(), numbers.begin(), numbers.end());
  return words;
}

TEST(MeshFuzz, Obj) {
  const std::vector<std::string> seeds{
      "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nusemtl skin\nf "
      "1/1/1 2/2/1 3/3/1 4/4/1\n",
      "# c\r\no a\r\nv 0 0 0 1 0 0\r\nv 1 0 0\r\nv 1 1 0 0 0 1\r\nf -3 -2 -1\r\n",
      "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 1 3 1\nv 2 2 2\nf 1 2 3 4 5\nf 1 2 3 4 5 6 7\nf 1 2 "
      "\\\n3\np 1 2\nl 1 2 3\n",
      "mtllib none.mtl\nv 1e10 0 0\nv 1 1e-10 0\nv 0 0 1\nv 0.1 0.2 0.3\nusemtl a b\nf 1//1 2//1 3//1\nf "
      "4//1 2//1 1//1\nvn 0 0 1\n"};
  const std::vector<std::string> words = with_numbers(
      {"f ", "v ", "vt ", "usemtl ", "mtllib ", "/", "//", "-", "curv ", "\nf 1 2 3 4 5 6 1 2 3\n"});
  std::size_t triangles = 0;
  fuzz(1, seeds, words, [&](const std::string& text) {
    const MeshFile file = parse_obj(text, "fuzz.obj");
    triangles += file.triangles.size();
    expect_whole(file);
  });
  EXPECT_GT(triangles, 10000U);
}

TEST(MeshFuzz, Mtl) {
  const std::vector<std::string> seeds{
      "newmtl skin\nKa 1 1 1\nKd 1 0.5 0.25\nd 0.5\nmap_Kd -s 2 2 1 -o 0.5 skin.png\nillum 2\n",
      "newmtl a b\r\nKd 0.5\r\nTr 0.25\r\nmap_Kd -blendu on -clamp on -mm 0 1 -t 1 1 maps\\my "
      "skin.png\r\nnewmtl c\r\nKd xyz 1 1 1\r\n",
      "newmtl x\nmap_d a.png\nmap_Kd -bm 1 -imfchan r -texres 64 x.png\nd -halo 0.5\nmap_bump -bm 2 b.png\n"};
  const std::vector<std::string> words =
      with_numbers({"newmtl ", "Kd ", "map_Kd ", "-s ", "-o ", "-mm ", "-clamp ", "d ", "Tr ", "spectral "});
  fuzz(2, seeds, words, [](const std::string& text) {
    MtlLibrary library;
    MeshFile file;
    parse_mtl(text, "fuzz.mtl", "folder", library, file.notes);
    ASSERT_EQ(library.placements.size(), library.materials.size());
    file.materials = library.materials;
    file.images = library.images;
    expect_whole(file);
  });
}

std::string big_endian(std::uint32_t value, int bytes = 4) {
  std::string out;
  while (--bytes >= 0) out += static_cast<char>(value >> (8 * bytes) & 255);
  return out;
}
std::string little_endian(std::uint32_t value, int bytes = 4) {
  const std::string big = big_endian(value, bytes);
  return {big.rbegin(), big.rend()};
}

std::string binary_ply(bool is_big) {
  const auto bits = [&](std::uint32_t value, int bytes = 4) {
    return is_big ? big_endian(value, bytes) : little_endian(value, bytes);
  };
  std::string out =
      std::string("ply\nformat binary_") + (is_big ? "big" : "little") +
      "_endian 1.0\ncomment TextureFile t.png\nelement vertex 5\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  for (std::uint32_t i = 0; i < 5; ++i) {
    out +=
        bits(0x3F800000 + (i << 20)) + bits(i % 2 == 0 ? 0 : 0x40000000) + bits(i << 21 | 0x3F000000) + "abc";
  }
  out += bits(5, 1);
  for (std::uint32_t i = 0; i < 5; ++i) out += bits(i);
  out += bits(0, 1) + bits(3, 1) + bits(0) + bits(1) + bits(4) + bits(6, 1);
  for (int i = 0; i < 6; ++i) out += bits(0x3F000000);
  out += bits(7);
  for (const std::uint32_t i : {0U, 1U, 2U, 0xFFFFFFFFU, 2U, 3U, 4U}) out += bits(i);
  return out;
}

void fuzz_ply(std::uint64_t seed, const std::vector<std::string>& seeds) {
  const std::vector<std::string> words = with_numbers(
      {"element vertex 3\n", "element face ", "property list uchar int vertex_indices\n",
       "property float x\n", "end_header\n", "list ", "double ", "uchar ", "comment TextureFile a\n",
       "element edge 2\n", "\xff\xff\xff\xff", std::string(4, '\0'), "\x80", "format ascii 1.0\n"});
  std::size_t triangles = 0;
  fuzz(seed, seeds, words, [&](const std::string& text) {
    const MeshFile file = parse_ply(text, "fuzz.ply");
    triangles += file.triangles.size();
    expect_whole(file);
  });
  EXPECT_GT(triangles, 10000U);
}

TEST(MeshFuzz, PlyAscii) {
  fuzz_ply(
      3, {"ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
          "property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n4 0 0 0 255 0\n4 4 0 0 0 255\n"
          "2 1 0 1 2 3\n0 4 0 9 9 9\n5 0 1 2 3 4\n3 0 1 2\n",
          "ply\r\nformat ascii 1.0\r\ncomment TextureFile a.png\r\nelement vertex 3\r\nproperty double x\r\n"
          "property double y\r\nproperty double z\r\nproperty float s\r\nproperty float t\r\nelement "
          "tristrips 1\r\n"
          "property list int int vertex_indices\r\nelement edge 1\r\nproperty int a\r\nend_header\r\n"
          "0 0 0 0 0\r\n1 0 0 1 0\r\n0 1 0 0 1\r\n7 0 1 2 -1 2 1 0\r\n5\r\n"});
}
TEST(MeshFuzz, PlyLittleEndian) { fuzz_ply(4, {binary_ply(false)}); }
TEST(MeshFuzz, PlyBigEndian) { fuzz_ply(5, {binary_ply(true)}); }

}  // namespace
}  // namespace bitspan
