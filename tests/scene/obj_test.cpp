// SPDX-License-Identifier: Apache-2.0
#include "scene/obj.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <assimp/Importer.hpp>
#include <bit>
#include <charconv>
#include <cmath>

#include "scene/mesh_text.hpp"
#include "scene/random.hpp"
#include "tests/scene/mesh_notes.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

const char* const triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

MeshFile parse(std::string_view text) { return parse_obj(text, "a.obj"); }
std::string refusal(const std::string& text) {
  return input_error([&] { parse(text); });
}
using Color = std::array<double, 4>;

TEST(Obj, PositionsAndTextureCoordinates) {
  const MeshFile file = parse(
      "# a comment\no thing\ng one two\ns 1\n"
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 6 7\n"
      "vt 0 0.25\nvt 1\nvt 0.5 0.75 0.125\nvn 0 0 1\n"
      "f 1/1/1 2/2/1 3/3/1\nf 1 2 4\nf 1//1 -2//-1 -1//-1 # the end\nf 1/ 2/ 3//\n");
  ASSERT_EQ(file.triangles.size(), 4U);
  EXPECT_TRUE(file.notes.empty());
  const MeshTriangle& first = file.triangles[0];
  EXPECT_TRUE(first.has_uv);
  EXPECT_EQ(first.material, -1);
  EXPECT_EQ(first.corner[1].position, (Vec3{1, 0, 0}));
  EXPECT_EQ(first.corner[0].v, 0.25);
  EXPECT_EQ(first.corner[1].u, 1);
  EXPECT_EQ(first.corner[1].v, 0);
  EXPECT_EQ(first.corner[2].u, 0.5);
  EXPECT_EQ(first.corner[2].v, 0.75);
  EXPECT_EQ(first.corner[2].color, (Color{1, 1, 1, 1}));
  EXPECT_FALSE(file.triangles[1].has_uv);
  EXPECT_EQ(file.triangles[2].corner[1].position, (Vec3{0, 1, 0}));
  EXPECT_EQ(file.triangles[2].corner[2].position, (Vec3{5, 6, 7}));
}

// Each way to end and to continue lines, and a byte order mark.
TEST(Obj, Lines) {
  const std::string plain = std::string(triangle) + "v 1 1 0\nf 1 2 4 3\n";
  const auto with_ends = [&](std::string_view end) {
    std::string text;
    for (const char letter : plain) text += letter == '\n' ? std::string(end) : std::string(1, letter);
    return text;
  };
  for (const std::string& text :
       {plain, with_ends("\r\n"), with_ends("\r"), "\xEF\xBB\xBF" + plain, plain.substr(0, plain.size() - 1),
        with_ends(" \t\n\n  "), std::string(triangle) + "v 1 \\\n1 0\nf 1 2\\\r\n 4 3",
        std::string(triangle) + "# C:\\\nv 1 1 0\nf 1 2 4 3\n"}) {
    const MeshFile file = parse(text);
    ASSERT_EQ(file.triangles.size(), 2U) << text;
    EXPECT_EQ(file.triangles[0].corner[2].position, (Vec3{1, 1, 0}));
    EXPECT_EQ(file.triangles[1].corner[2].position, (Vec3{0, 1, 0}));
  }
  EXPECT_EQ(refusal("v 0 0 0\nv 1 \\\n\\\n0 0\r\nv 1 1 x\n"),
            "a.obj:5: \"x\" is no number that a double holds; expected one")
      << "lines that are joined count";
  EXPECT_TRUE(names(refusal(std::string("\xFF\xFEv\0", 4)), "a.obj: is UTF-16"));
}

// A reader that lost the first line would draw another triangle.
TEST(Obj, ByteOrderMarkInFrontOfTheFirstVertex) {
  const std::string text = "v 5 5 5\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 2 3 4\n";
  for (const char* mark : {"", "\xEF\xBB\xBF"}) {
    const MeshFile file = parse(mark + text);
    ASSERT_EQ(file.triangles.size(), 1U);
    EXPECT_EQ(file.triangles[0].corner[0].position, (Vec3{-1, -1, 0}));
    EXPECT_EQ(file.triangles[0].corner[2].position, (Vec3{1, 1, 0}));
  }
}

TEST(Obj, ColoursOnSomeVertices) {
  const MeshFile file = parse("v 0 0 0\nv 1 0 0 0.5 0.25 1\nv 0 1 0\nv 1 1 0 0 0 0\nf 1 2 3\nf 2 4 3\n");
  EXPECT_EQ(file.triangles[0].corner[0].color, (Color{1, 1, 1, 1}));
  EXPECT_EQ(file.triangles[0].corner[1].color, (Color{0.5, 0.25, 1, 1}));
  EXPECT_EQ(file.triangles[0].corner[2].color, (Color{1, 1, 1, 1}));
  EXPECT_EQ(file.triangles[1].corner[1].color, (Color{0, 0, 0, 1}));
  EXPECT_TRUE(file.notes.empty());
  EXPECT_TRUE(has_note(parse("v 0 0 0 255 0 0\n"), "1 vertices have colours beyond 0..1"));
}

TEST(Obj, VerticesMayComeBehindFaces) {
  const MeshFile file = parse("f 1/1 2/2 3/3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0\nvt 1\nvt 0.5\n");
  EXPECT_EQ(file.triangles[0].corner[2].u, 0.5);
}

TEST(Obj, BadIndices) {
  const std::string start = std::string(triangle) + "vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n";
  EXPECT_EQ(refusal(start + "f 1 2 4\n"), "a.obj:8: v 4 is not there; expected at most 3");
  EXPECT_EQ(refusal(start + "f 1/1 2/2 3/9\nv 0 0 0\n"), "a.obj:8: vt 9 is not there; expected at most 3");
  EXPECT_EQ(refusal(start + "f 1//1 2//1 3//2\n"), "a.obj:8: vn 2 is not there; expected at most 1");
  EXPECT_EQ(refusal(start + "f 1 2 0\n"), "a.obj:8: v 0 is not there; expected 1.. or -3..-1");
  EXPECT_EQ(refusal(start + "f 1 2 -4\nv 0 0 0\n"), "a.obj:8: v -4 is not there; expected 1.. or -3..-1");
  for (const char* face : {"f 1 2 99999999999999999999", "f 1 2 -99999999999999999999", "f 1 2 4294967296",
                           "f 1 2 9223372036854775807", "f 1 2 -9223372036854775808", "f 1/1 2/2 3/-4",
                           "f 1//1 2//1 3//-2", "f 1/0 2/1 3/1"}) {
    EXPECT_TRUE(names(refusal(start + face), "is not there")) << face;
  }
  for (const char* face :
       {"f 1 2 x", "f 1 2 3.0", "f 1 2 /1", "f 1/1/1/1 2 3", "f 1 2 1,3", "f 1 2 +", "f 1 2 3\\"}) {
    EXPECT_TRUE(names(refusal(start + face), "is no index")) << face;
  }
  // Some faces are good.
  EXPECT_TRUE(names(refusal(start + "f 1 2 3\nf 1 2 3\nf 1 2 5\nf 1 2 3\n"), "a.obj:10: v 5"));
  EXPECT_TRUE(names(refusal(start + "f 1/1 2 3/3\n"), "some corners have texture coordinates"));
  for (const char* face : {"f", "f 1", "f 1 2", "f 1 2 # 3"}) {
    EXPECT_TRUE(names(refusal(start + face), "corners; expected at least 3")) << face;
  }
  std::string many = "f";
  for (int i = 0; i < 32769; ++i) many += " 1";
  EXPECT_TRUE(names(refusal(start + many), "a face of 32769 corners; expected at most 32768"));
}

TEST(Obj, NumbersAreTheNearestDoublesOrRefused) {
  const auto x = [](const std::string& word) {
    const MeshFile file = parse("v " + word + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    return file.triangles.at(0).corner[0].position.x;
  };
  EXPECT_EQ(x("1234567890123456789012e-21"), 1.234567890123456789012);
  EXPECT_EQ(x("0.1000000000000000055511151231257827021181583404541015625"), 0.1);
  EXPECT_EQ(x("9007199254740993"), 9007199254740992.0);
  EXPECT_EQ(x("9007199254740993.00000000000000000000000000001"), 9007199254740994.0);
  EXPECT_EQ(x("+1.5e+2"), 150);
  EXPECT_EQ(x("-.5"), -0.5);
  EXPECT_EQ(x("5."), 5);
  EXPECT_EQ(x("1E3"), 1000);
  EXPECT_EQ(x("4.9e-324"), 0x1p-1074);
  EXPECT_EQ(x("1e-400"), 0);
  EXPECT_EQ(x("0e99999999999999999999"), 0);
  EXPECT_EQ(x("0.000" + std::string(400, '0') + "1e400"), 1e-4);
  EXPECT_TRUE(std::signbit(x("-1e-99999999999999999999")));
  EXPECT_EQ(x("1" + std::string(1000, '0') + "e-1000"), 1);
  EXPECT_EQ(x("0." + std::string(400, '0') + "1e10"), 0);
  EXPECT_TRUE(names(refusal("v 1" + std::string(400, '0') + "e-10 0 0\n"), "a.obj:1: "));
  for (const char* word : {"1.#IND", "-1.#INF", "1.#QNAN",   "1,5",      "nan",   "inf",
                           "-inf",   "NaN",     "-nan(ind)", "infinity", "1e400", "-1e99999999999999999999",
                           "0x10",   "1e",      "e5",        "--1",      "+-1",   "-",
                           "+",      ".",       "1.0.0",     "1f",       "1d3",   "\xC2\xBD"}) {
    EXPECT_TRUE(names(refusal("\nv 0 0 0\nv 1 " + std::string(word) + " 0\n"), "a.obj:3: \"")) << word;
    EXPECT_TRUE(names(refusal("vt " + std::string(word) + "\n"), "a.obj:1: \"")) << word;
  }
  for (const char* line :
       {"v", "v 1 2", "v 1 2 3 4 5", "v 1 2 3 4 5 6 7", "v 1 2 3 4 5 6 7 8", "vt", "vt 1 2 3 4"}) {
    EXPECT_TRUE(names(refusal(line), "numbers; expected") || names(refusal(line), "7 numbers")) << line;
  }
  // Against printf's digits, which are right.
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::bit_cast<double>(random.bits());
    if (!std::isfinite(value)) continue;
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*e", static_cast<int>(17 + random.integer(0, 20)), value);
    EXPECT_EQ(to_number(text.data()), value) << text.data();
  }
}

TEST(Obj, WhatIsLeftOutIsCounted) {
  const MeshFile file =
      parse(std::string(triangle) +
            "v 1 1 1 0.5\np 1 2\np 3\nl 1 2 3\ncstype bezier\ndeg 3\nvp 0.1\ncurv 0 1 1 2 3\nsurf 0 1 0 1 1\n"
            "parm u 0 1\nend\ncall other.obj\nhello\nhello\nf 1 2 3\n");
  EXPECT_EQ(file.triangles.size(), 1U);
  for (const char* note :
       {"2 statements of points (p) are left out (first: line 5)", "1 lines (l) are left out (first: line 7)",
        "2 curves and surfaces are left out (first: line 11)", "1 vertices have a weight w that is not 1",
        "1 statements \"call\" are left out (first: line 15)",
        "2 statements \"hello\" are left out (first: line 16)"}) {
    EXPECT_TRUE(has_note(file, note)) << note;
  }
  EXPECT_EQ(file.notes.size(), 6U);
}

class ObjMaterials : public testing::Test {
 protected:
  // A triangle per material of the library.
  MeshFile read(const std::string& library, const std::vector<std::string>& materials = {"a"}) {
    folder_.write("m.mtl", library);
    std::string text = "mtllib m.mtl\n" + std::string(triangle) + "vt 0 0\nvt 1 0\nvt 0 1\n";
    for (const std::string& name : materials) text += "usemtl " + name + "\nf 1/1 2/2 3/3\n";
    return read_obj(folder_.write("m.obj", text));
  }
  Color color(const std::string& library) {
    const MeshFile file = read(library);
    return file.materials.at(static_cast<std::size_t>(file.triangles.at(0).material)).color;
  }
  std::string image(const std::string& library) {
    const MeshFile file = read(library);
    const int image = file.materials.at(static_cast<std::size_t>(file.triangles.at(0).material)).image;
    return image < 0 ? ""
                     : file.images.at(static_cast<std::size_t>(image)).path.substr(folder_.path().size());
  }
  std::string refused(const std::string& library) {
    std::string message = input_error([&] { read(library); });
    EXPECT_EQ(message.rfind(folder_.path("m.mtl:"), 0), 0U) << message;
    return message.substr(folder_.path().size());
  }
  TemporaryFolder folder_;
};

TEST_F(ObjMaterials, ColoursAndOpacity) {
  EXPECT_EQ(color("newmtl a\n"), (Color{1, 1, 1, 1})) << "white, not the 0.6 that a library invents";
  EXPECT_EQ(color("newmtl a\nKd 1 0.5 0.25\n"), (Color{1, 0.5, 0.25, 1}));
  EXPECT_EQ(color("newmtl a\nKd 0.5\n"), (Color{0.5, 0.5, 0.5, 1}));
  EXPECT_EQ(color("\xEF\xBB\xBFnewmtl a\r\n  Kd 0 0 1 # blue\r\nd 0.5\r\n"), (Color{0, 0, 1, 0.5}));
  EXPECT_EQ(color("newmtl a\nTr 0.25\n"), (Color{1, 1, 1, 0.75}));
  EXPECT_EQ(color("newmtl a\nd 1\nTr 1\n"), (Color{1, 1, 1, 1})) << "d counts";
  EXPECT_EQ(color("newmtl a\nTr 1\nd 1\n"), (Color{1, 1, 1, 1}));
  EXPECT_EQ(color("newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\nKa 1 1 1\nKs x\nillum 2\n"), (Color{1, 0, 0, 1}));
  EXPECT_EQ(color("newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n"), (Color{0, 1, 0, 1}));
  EXPECT_TRUE(has_note(read("newmtl a\nnewmtl a\n"), "m.mtl:2: material \"a\" is defined twice"));
  EXPECT_TRUE(has_note(read("newmtl a\nKd spectral f.rfl\n"), "m.mtl:2: Kd spectral is left out"));
  EXPECT_TRUE(has_note(read("newmtl a\nKd xyz 1 1 1\n"), "m.mtl:2: Kd xyz is left out"));
  EXPECT_TRUE(has_note(read("newmtl a\nKd 2 0 0\n"), "m.mtl:2: Kd is beyond 0..1"));
  EXPECT_TRUE(has_note(read("newmtl a\nd -halo 0.5\n"), "d -halo is read as d"));
  EXPECT_TRUE(has_note(read("Kd 1 0 0\nnewmtl a\n"), "m.mtl:1: kd stands before the first newmtl"));
  EXPECT_EQ(refused("newmtl a\nKd 1 0,5 0\n"),
            "m.mtl:2: \"0,5\" is no number that a double holds; expected one");
  for (const char* line : {"Kd", "Kd 1 1", "Kd 1.#IND 0 0", "Kd nan 0 0", "d", "d x", "Tr 1,0", "d -halo",
                           "map_Kd -o x a.png"}) {
    refused(std::string("newmtl a\n") + line + "\n");
  }
  const MeshFile file = read("newmtl a\n");
  EXPECT_FALSE(file.materials[0].two_sided);
  EXPECT_EQ(file.materials[0].alpha, AlphaMode::blend);
}

TEST_F(ObjMaterials, Names) {
  const MeshFile file = read("newmtl dark blue \nKd 0 0 0.5\nnewmtl a#1\nKd 0 0 0\n",
                             {"dark blue", "a#1", "none", "dark  blue", "a#1"});
  std::vector<int> materials;
  for (const MeshTriangle& t : file.triangles) materials.push_back(t.material);
  EXPECT_EQ(materials, (std::vector<int>{0, 1, -1, -1, 1}));
  EXPECT_TRUE(has_note(file, "the material \"none\" is not defined; its faces are white"));
  EXPECT_EQ(file.notes.size(), 2U);
}

TEST_F(ObjMaterials, Libraries) {
  folder_.write("one.mtl", "newmtl one\n");
  folder_.write("my two.mtl", "newmtl two\n");
  folder_.write("three.mtl", "newmtl three\n");
  std::filesystem::create_directory(folder_.path("sub"));
  folder_.write("sub/four.mtl", "newmtl four\nmap_Kd t.png\n");
  folder_.write("sub/t.png", "");
  const auto materials = [&](const std::string& line) {
    const MeshFile file = read_obj(folder_.write("m.obj", line + "\n" + triangle + "f 1 2 3\n"));
    std::string out;
    for (const MeshMaterial& m : file.materials) out += m.name + " ";
    for (const std::string& note : file.notes) out += note;
    return out;
  };
  EXPECT_EQ(materials("mtllib one.mtl"), "one ");
  EXPECT_EQ(materials("mtllib my two.mtl"), "two ");
  EXPECT_EQ(materials("mtllib one.mtl my two.mtl three.mtl"), "one two three ");
  EXPECT_EQ(materials("mtllib one.mtl none.mtl"),
            "one the material library \"none.mtl\" is no file that can be read");
  EXPECT_EQ(materials("mtllib sub\nmtllib one.mtl\nmtllib one.mtl"),
            "one the material library \"sub\" is no file that can be read");
  EXPECT_EQ(materials("mtllib .\\sub\\four.mtl"), "four ");
  const MeshFile file = read_obj(folder_.path("m.obj"));
  EXPECT_EQ(file.images.at(0).path, folder_.path("./sub/t.png")) << "beside its library";
  // The order of mtllib and usemtl is any.
  const MeshFile late =
      parse_obj(std::string(triangle) + "usemtl one\nf 1 2 3\nmtllib one.mtl\n", folder_.path("x.obj"));
  EXPECT_EQ(late.triangles.at(0).material, 0);
}

TEST_F(ObjMaterials, ImagesAndTheirOptions) {
  EXPECT_EQ(image("newmtl a\nmap_Kd t.png\n"), "t.png");
  EXPECT_EQ(image("newmtl a\nmap_Kd my texture.png \n"), "my texture.png");
  EXPECT_EQ(image("newmtl a\nmap_Kd maps\\sub\\t.png\n"), "maps/sub/t.png");
  EXPECT_EQ(
      image("newmtl a\nmap_kd -blendu on -blendv off -bm 0.5 -mm 0 1 -texres 64 -clamp off -cc off t.png\n"),
      "t.png");
  EXPECT_EQ(image("newmtl a\nmap_Kd -s 2 3\n"), "3") << "the last word is the name";
  EXPECT_EQ(image("newmtl a\nmap_Kd -odd name.png\n"), "-odd name.png");
  for (const char* option : {"-clamp on", "-cc on", "-mm 0.5 1", "-t 1 1 1", "-texres 64", "-imfchan r"}) {
    const MeshFile file = read("newmtl a\nmap_Kd " + std::string(option) + " t.png\n");
    EXPECT_EQ(file.notes.size(), 1U) << option;
    EXPECT_TRUE(names(file.images.at(0).path, "/t.png")) << file.images.at(0).path;
  }
  EXPECT_TRUE(has_note(read("newmtl a\nmap_d t.png\n"), "m.mtl:2: map_d is left out"));
  EXPECT_TRUE(has_note(read("newmtl a\nmap_Kd \n"), "m.mtl:2: map_Kd has no image, and is left out"));
  EXPECT_EQ(image("newmtl a\nmap_Kd\n"), "");
  EXPECT_EQ(read("newmtl a\nmap_Kd t.png\nnewmtl b\nmap_Kd t.png\nnewmtl c\nmap_Kd u.png\n").images.size(),
            2U);
  EXPECT_TRUE(read("newmtl a\nmap_Kd t.png\nmap_Bump b.png\nmap_Ks k.png\n").notes.empty());
}

TEST_F(ObjMaterials, ScaleAndOffset) {
  const MeshFile file = read(
      "newmtl a\nmap_Kd -s 2 3 1 -o 0.25 -0.5 t.png\nnewmtl b\nmap_Kd -s 2 t.png\nnewmtl c\nmap_Kd -o 0.5 "
      "t.png\n",
      {"a", "b", "c"});
  ASSERT_EQ(file.triangles.size(), 3U);
  const auto uv = [&](std::size_t triangle_index, std::size_t corner) {
    const MeshCorner& c = file.triangles[triangle_index].corner[corner];
    return std::pair(c.u, c.v);
  };
  EXPECT_EQ(uv(0, 0), std::pair(0.25, -0.5));
  EXPECT_EQ(uv(0, 1), std::pair(2.25, -0.5));
  EXPECT_EQ(uv(0, 2), std::pair(0.25, 2.5));
  EXPECT_EQ(uv(1, 1), std::pair(2.0, 0.0));
  EXPECT_EQ(uv(1, 2), std::pair(0.0, 1.0));
  EXPECT_EQ(uv(2, 0), std::pair(0.5, 0.0));
  EXPECT_TRUE(file.notes.empty());
  EXPECT_TRUE(names(input_error([&] { read("newmtl a\nmap_Kd -s 1e308 -o 1.7e308 t.png\n"); }),
                    "beyond the doubles"));
}

TEST(Obj, FilesThatCannotBeRead) {
  const TemporaryFolder folder;
  expect_refusal([&] { read_obj(folder.path("none.obj")); }, "none.obj: cannot read: No such file");
  expect_refusal([&] { read_obj(folder.path()); }, "is a folder");
  EXPECT_TRUE(parse("").triangles.empty());
  EXPECT_TRUE(parse("\xEF\xBB\xBF").triangles.empty());
}

// The generator knows what it wrote; spaces, forms of indices and of numbers vary.
TEST(Obj, RandomFiles) {
  Random random(7);
  std::size_t corners = 0;
  for (int round = 0; round < 300; ++round) {
    std::string text;
    std::vector<Vec3> positions;
    std::vector<std::array<double, 2>> textures;
    std::vector<std::array<std::pair<std::size_t, std::size_t>, 3>> faces;
    const auto number = [&](double value) {
      std::array<char, 64> digits{};
      const auto format =
          random.integer(0, 1) == 0 ? std::chars_format::scientific : std::chars_format::general;
      return std::string(digits.data(), std::to_chars(digits.data(), digits.data() + 64, value, format).ptr);
    };
    const auto blank = [&] { return random.integer(0, 9) == 0 ? " \t " : " "; };
    for (int line = 0; line < 100; ++line) {
      const auto kind = random.integer(0, 3);
      if (kind == 0 || positions.size() < 3) {
        positions.push_back({random.uniform(-9, 9), random.uniform(-1e-3, 1e-3), random.uniform(-1e9, 1e9)});
        const Vec3& p = positions.back();
        text +=
            "v" + std::string(blank()) + number(p.x) + blank() + number(p.y) + blank() + number(p.z) + "\n";
      } else if (kind == 1 || textures.empty()) {
        textures.push_back({random.uniform(-2, 2), random.uniform(0, 1)});
        text += "vt " + number(textures.back()[0]) + blank() + number(textures.back()[1]) + "\r\n";
      } else {
        auto& face = faces.emplace_back();
        text += "f";
        for (auto& [position, texture] : face) {
          position =
              static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(positions.size()) - 1));
          texture =
              static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(textures.size()) - 1));
          const auto index = [&](std::size_t i, std::size_t size) {
            return random.integer(0, 1) == 0 ? std::to_string(i + 1) : "-" + std::to_string(size - i);
          };
          text += blank() + index(position, positions.size()) + "/" + index(texture, textures.size());
        }
        text += "\n";
      }
    }
    const MeshFile file = parse(text);
    ASSERT_EQ(file.triangles.size(), faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const MeshCorner& corner = file.triangles[f].corner[k];
        const auto& [position, texture] = faces[f][k];
        ASSERT_EQ(corner.position, positions[position]);
        ASSERT_EQ((std::array{corner.u, corner.v}), textures[texture]);
        ++corners;
      }
    }
  }
  EXPECT_GT(corners, 20000U);
}

// A second reader, whose numbers are floats.
TEST(Obj, AgreesWithAssimp) {
  const std::string path = source_path("tests/data/spot.obj");
  const MeshFile file = read_obj(path);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  ASSERT_NE(scene, nullptr);
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_EQ(mesh.mNumFaces, file.triangles.size());
  for (std::size_t f = 0; f < file.triangles.size(); ++f) {
    ASSERT_EQ(mesh.mFaces[f].mNumIndices, 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      const MeshCorner& corner = file.triangles[f].corner[k];
      const unsigned index = mesh.mFaces[f].mIndices[k];
      ASSERT_FLOAT_EQ(mesh.mVertices[index].x, static_cast<float>(corner.position.x));
      ASSERT_FLOAT_EQ(mesh.mVertices[index].y, static_cast<float>(corner.position.y));
      ASSERT_FLOAT_EQ(mesh.mVertices[index].z, static_cast<float>(corner.position.z));
      ASSERT_FLOAT_EQ(mesh.mTextureCoords[0][index].x, static_cast<float>(corner.u));
      ASSERT_FLOAT_EQ(mesh.mTextureCoords[0][index].y, static_cast<float>(corner.v));
    }
  }
}

}  // namespace
}  // namespace bitspan
