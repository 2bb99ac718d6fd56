// SPDX-License-Identifier: Apache-2.0
#include "scene/ply.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "scene/random.hpp"
#include "tests/scene/mesh_notes.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

MeshFile parse(std::string_view bytes) { return parse_ply(bytes, "a.ply"); }
std::string refusal(const std::string& bytes) {
  return input_error([&] { parse(bytes); });
}
using Color = std::array<double, 4>;

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string faces = "property list uchar int vertex_indices\n";
const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string header(const std::string& rest) { return "ply\nformat ascii 1.0\n" + rest + "end_header\n"; }
// A square with a face per line of `data`.
std::string square_with(int face_count, const std::string& data) {
  return header("element vertex 4\n" + xyz + "element face " + std::to_string(face_count) + "\n" + faces) +
         square + data;
}

TEST(Ply, Ascii) {
  const MeshFile file = parse(square_with(2, "4 0 1 2 3\n3 0 1 2\n"));
  ASSERT_EQ(file.triangles.size(), 3U);
  EXPECT_EQ(file.triangles[1].corner[1].position, (Vec3{1, 1, 0}));
  EXPECT_EQ(file.triangles[1].corner[2].position, (Vec3{0, 1, 0}));
  EXPECT_EQ(file.triangles[1].corner[0].color, (Color{1, 1, 1, 1}));
  EXPECT_FALSE(file.triangles[0].has_uv);
  ASSERT_EQ(file.materials.size(), 1U);
  EXPECT_TRUE(file.materials[0].two_sided);
  EXPECT_EQ(file.triangles[0].material, 0);
  EXPECT_TRUE(file.notes.empty());
}

TEST(Ply, StartAndLines) {
  const std::string plain = square_with(1, "4 0 1 2 3\n");
  for (const std::string_view end : {"\n", "\r\n", "\r"}) {
    for (const std::string_view mark : {"", "\xEF\xBB\xBF"}) {
      std::string text(mark);
      for (const char letter : plain) text += letter == '\n' ? std::string(end) : std::string(1, letter);
      EXPECT_EQ(parse(text).triangles.size(), 2U);
      const std::size_t bad = text.rfind('3');
      text[bad] = '9';
      EXPECT_EQ(refusal(text), "a.ply:14: face 0: vertex 9 is not there; expected 0..3");
    }
  }
  EXPECT_EQ(parse("ply \nformat ascii 1.0 \n\ncomment a\nobj_info b\nelement  vertex  3\n" + xyz +
                  "element face 1\nproperty list uint8 int32 vertex_index\nend_header \n0 0 0 1 0\n0 0 1 "
                  "0\n\n3 0\n1 2")
                .triangles.size(),
            1U);
}

TEST(Ply, BadHeaders) {
  const std::string good = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + "element face 1\n" + faces;
  const std::string data = "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(parse(good + data).triangles.size(), 1U);
  EXPECT_TRUE(names(refusal(""), "a.ply:1: not a PLY file"));
  EXPECT_TRUE(names(refusal("plya\n"), "a.ply:1: not a PLY file"));
  EXPECT_TRUE(names(refusal(good), "the PLY header has no end"));
  EXPECT_TRUE(names(refusal(good + "end_header"), "the PLY header has no end"));
  EXPECT_TRUE(
      names(refusal("ply\nelement vertex 0\nend_header\n"), "a.ply:3: the header has no line format"));
  const auto line = [&](const std::string& text) { return refusal(good + text + "\n" + data); };
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"elxment vertex 3", "a.ply:9: not a PLY header line: \"elxment\""},
           {"format ascii 1.0", "a second format"},
           {"element face 1", "a.ply:9: a second element \"face\"; expected one"},
           {"element vertex 3", "a.ply:9: a second element \"vertex\"; expected one"},
           {"element thing", "an element without a number"},
           {"element thing -1", "an element without a number"},
           {"element thing 1.5", "an element without a number"},
           {"element thing 1 2", "an element without a number"},
           {"element thing 99999999999999999999", "an element without a number"},
           {"property quad a", "\"quad\" is no type"},
           {"property float", "not a property"},
           {"property float a b", "not a property"},
           {"property list float int a", "a list's length is no whole number"},
           {"property list uchar int", "not a property"},
           {"property list uchar int vertex_index", "two properties"},
           {"property uchar vertex_index", "two properties"},
           {"property list uchar uchar red", "is a list; expected one value"},
           {"property float texcoord", "is one value; expected a list"},
           {"property char red", "colour \"red\" has type char"}}) {
    EXPECT_TRUE(names(line(text), part)) << line(text);
  }
  EXPECT_TRUE(names(refusal("ply\nproperty float x\n"), "a property of no element"));
  EXPECT_TRUE(names(refusal("ply\nformat binary 1.0\n"), "the format \"binary\" is not known"));
  EXPECT_TRUE(names(refusal("ply\nformat ascii 2.0\n"), "version \"2.0\" of PLY is not known"));
  EXPECT_TRUE(names(refusal(header("element vertex 1\nproperty float x\nproperty float y\n") + "0 0\n"),
                    "element vertex has not all of x, y and z"));
  EXPECT_TRUE(names(refusal(header("element face 1\nproperty int a\n") + "0\n"),
                    "element face has no list vertex_indices"));
  EXPECT_NO_THROW(parse(header("element vertex 1\n" + xyz + "element face 0\n") + "0 0 0\n"))
      << "a cloud of points";
  EXPECT_TRUE(names(refusal(header("element face 1\nproperty list uchar float vertex_indices\n") + "0\n"),
                    "has type float; expected integers"));
}

TEST(Ply, TwoVertexElements) {
  EXPECT_EQ(refusal(header("element vertex 3\nproperty int x\nproperty int nx\nelement vertex 9\n" + xyz +
                           "element face 1\n" + faces) +
                    "1 1\n1 1\n1 1\n" + square + square + "0 0 0\n3 0 1 2\n"),
            "a.ply:6: a second element \"vertex\"; expected one");
}

TEST(Ply, BadData) {
  EXPECT_EQ(refusal(square_with(2, "3 0 1 2\n3 0 1 4\n")),
            "a.ply:15: face 1: vertex 4 is not there; expected 0..3");
  EXPECT_TRUE(names(refusal(square_with(1, "3 0 1 -1\n")), "a.ply:14: face 0: vertex -1 is not there"));
  EXPECT_TRUE(names(refusal(square_with(1, "3 0 1 2.0\n")), "\"2.0\" is no number of type int"));
  EXPECT_TRUE(names(refusal(square_with(1, "3 0 1 3000000000\n")), "is no number of type int"));
  for (const char* count : {"2 0 1", "1 0", "0"}) {
    EXPECT_TRUE(names(refusal(square_with(1, std::string(count) + "\n     ")), "corners; expected 3..32768"))
        << count;
  }
  EXPECT_TRUE(names(refusal(square_with(1, "200 0 1 2\n")), "a list of 200 values; expected at most the"));
  EXPECT_TRUE(names(refusal(square_with(1, "-3 0 1 2\n")), "is no number of type uchar"));
  EXPECT_TRUE(names(refusal(square_with(1, "300 0 1 2\n")), "is no number of type uchar"));
  EXPECT_TRUE(names(refusal(square_with(1, "3 0 1 2 0\n")), "a.ply:14: data behind the last element"));
  EXPECT_TRUE(names(refusal(square_with(1, "3 0 1 2\n\nx")), "a.ply:16: data behind the last element"));
  EXPECT_TRUE(names(refusal(header("element face 1\n" + faces) + "3 0 1 2\n"), "the file has no vertices"));
  for (const char* number : {"nan", "inf", "1.#IND", "0,5", "1e400", "x"}) {
    EXPECT_TRUE(
        names(refusal(header("element vertex 1\n" + xyz) + "0 0 " + number + "\n"), "a.ply:8: vertex 0: \""))
        << number;
  }
  // What is not read may be anything.
  EXPECT_EQ(parse(header("element vertex 3\n" + xyz + "property float nx\nelement face 1\n" + faces) +
                  "0 0 0 nan\n1 0 0 -nan(ind)\n0 1 0 x\n3 0 1 2\n")
                .triangles.size(),
            1U);
}

TEST(Ply, EveryTruncation) {
  const std::string whole = square_with(2, "3 0 1 2\n4 0 1 2 3\n");
  for (std::size_t length = 0; length + 1 < whole.size(); ++length) {
    refusal(whole.substr(0, length));
    ASSERT_FALSE(HasFailure()) << length;
  }
}

// Before anything is allocated.
TEST(Ply, CountsThatNoFileHolds) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const char* count : {"5", "4000000000", "18446744073709551615"}) {
      for (const std::string& element : {"element vertex " + std::string(count) + "\n" + xyz,
                                         "element other " + std::string(count) + "\nproperty double a\n",
                                         "element face " + std::string(count) + "\n" + faces}) {
        const std::string message =
            refusal("ply\nformat " + std::string(format) + " 1.0\n" + element + "end_header\n0 0\n");
        EXPECT_TRUE(names(message, "a.ply:3: element ") && names(message, "the file ends before")) << message;
      }
    }
  }
  // An element of nothing takes no time.
  EXPECT_TRUE(parse(header("element nothing 18446744073709551615\n")).triangles.empty());
  const std::string start =
      "ply\nformat binary_big_endian 1.0\nelement face 1\nproperty list uint int "
      "vertex_indices\nend_header\n";
  EXPECT_TRUE(names(refusal(start + std::string("\x80\0\0\1", 4) + "aaaaaaaaaaaa"),
                    "a.ply: offset 97, face 0: a list of 2147483649 values; expected at most"));
  EXPECT_TRUE(names(refusal(start + "\xff\xff\xff\xff"
                                    "aaaaaaaaaaaa"),
                    "a.ply: offset 97, face 0: a list of 4294967295 values; expected at most"));
}

TEST(Ply, Colours) {
  const auto color = [](const std::string& properties, const std::string& values) {
    const MeshFile file =
        parse(header("element vertex 3\n" + xyz + properties + "element face 1\n" + faces) + "0 0 0 " +
              values + "\n1 0 0 " + values + "\n0 1 0 " + values + "\n3 0 1 2\n");
    return file.triangles.at(0).corner[0].color;
  };
  EXPECT_EQ(color("property uchar red\nproperty uchar green\nproperty uchar blue\n", "255 51 0"),
            (Color{1, 0.2, 0, 1}));
  EXPECT_EQ(color("property uint8 alpha\nproperty uint8 blue\nproperty uint8 green\nproperty uint8 red\n",
                  "51 0 102 255"),
            (Color{1, 0.4, 0, 0.2}));
  EXPECT_EQ(color("property ushort red\nproperty ushort green\nproperty ushort blue\n", "65535 13107 0"),
            (Color{1, 0.2, 0, 1}));
  EXPECT_EQ(color("property uint red\nproperty uint green\nproperty uint blue\n", "4294967295 858993459 0"),
            (Color{1, 0.2, 0, 1}));
  EXPECT_EQ(color("property float red\nproperty double green\nproperty float blue\nproperty float alpha\n",
                  "1 0.3 0 0.5"),
            (Color{1, 0.3, 0, 0.5}));
  EXPECT_EQ(color("property uchar diffuse_red\nproperty uchar diffuse_green\nproperty uchar diffuse_blue\n",
                  "255 51 0"),
            (Color{1, 0.2, 0, 1}));
  EXPECT_EQ(
      color("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar diffuse_red\n",
            "255 51 0 9"),
      (Color{1, 0.2, 0, 1}));
  EXPECT_EQ(color("property uchar red\nproperty uchar green\n", "255 51"), (Color{1, 1, 1, 1}));
  EXPECT_TRUE(has_note(parse(header("element vertex 0\n" + xyz + "property uchar red\n")),
                       "the colour of element \"vertex\" is left out"));
  EXPECT_TRUE(has_note(parse(header("element vertex 1\n" + xyz +
                                    "property float red\nproperty float green\nproperty float blue\n") +
                             "0 0 0 255 0 0\n"),
                       "1 values of colours are beyond 0..1"));
}

TEST(Ply, ColoursOfFaces) {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const MeshFile file = parse(header("element vertex 4\n" + xyz + "element face 2\n" + faces + colors) +
                              square + "3 0 1 2 255 0 0\n3 0 2 3 0 51 0\n");
  EXPECT_EQ(file.triangles.at(0).corner[1].color, (Color{1, 0, 0, 1}));
  EXPECT_EQ(file.triangles.at(1).corner[1].color, (Color{0, 0.2, 0, 1}));
  const MeshFile both =
      parse(header("element vertex 3\n" + xyz + colors + "element face 1\n" + faces + colors) +
            "0 0 0 0 0 255\n1 0 0 0 0 255\n0 1 0 0 0 255\n3 0 1 2 255 0 0\n");
  EXPECT_EQ(both.triangles.at(0).corner[1].color, (Color{0, 0, 1, 1}));
  EXPECT_TRUE(has_note(both, "the colours of faces are left out"));
}

TEST(Ply, TextureCoordinates) {
  for (const auto& [u, v] : {std::pair("u", "v"), {"s", "t"}, {"texture_u", "texture_v"}}) {
    const MeshFile file =
        parse(header("comment TextureFile my image.png\nelement vertex 3\nproperty float " + std::string(v) +
                     "\n" + xyz + "property float " + u + "\nelement face 1\n" + faces) +
              "0.5 0 0 0 0.25\n0 1 0 0 1\n1 0 1 0 0\n3 0 1 2\n");
    const MeshTriangle& t = file.triangles.at(0);
    EXPECT_TRUE(t.has_uv);
    EXPECT_EQ(t.corner[0].u, 0.25);
    EXPECT_EQ(t.corner[0].v, 0.5);
    EXPECT_EQ(file.images.at(0).path, "my image.png");
    EXPECT_EQ(file.materials.at(static_cast<std::size_t>(t.material)).image, 0);
    EXPECT_TRUE(file.materials[0].two_sided);
  }
}

// As MeshLab writes them.
TEST(Ply, TextureCoordinatesOfFaces) {
  const std::string start =
      header("comment TextureFile a.png\ncomment TextureFile b.png\nelement vertex 4\n" + xyz +
             "element face 3\n" + faces + "property list uchar float texcoord\nproperty int texnumber\n") +
      square;
  const MeshFile file =
      parse(start + "4 0 1 2 3 8 0 0 1 0 1 1 0 0.5 1\n3 0 1 2 6 0 0 1 0 1 1 0\n3 0 1 2 0 -1\n");
  ASSERT_EQ(file.triangles.size(), 4U);
  EXPECT_EQ(file.triangles[1].corner[2].v, 0.5);
  EXPECT_EQ(file.materials.at(static_cast<std::size_t>(file.triangles[1].material)).image, 1);
  EXPECT_EQ(file.materials.at(static_cast<std::size_t>(file.triangles[2].material)).image, 0);
  EXPECT_EQ(file.materials.at(static_cast<std::size_t>(file.triangles[3].material)).image, -1);
  EXPECT_FALSE(file.triangles[3].has_uv);
  EXPECT_TRUE(names(refusal(start + "3 0 1 2 5 0 0 1 0 1 0\n3 0 1 2 0 0\n3 0 1 2 0 0\n"),
                    "a.ply:18: face 0: texcoord has 5 values; expected 6"));
  EXPECT_TRUE(names(refusal(start + "3 0 1 2 0 2\n3 0 1 2 0 0\n3 0 1 2 0 0\n"),
                    "texnumber 2 is not there; expected -1..1"));
}

TEST(Ply, TriangleStrips) {
  const auto strips = [](const std::string& data, const char* type = "int") {
    return parse(header("element vertex 4\n" + xyz + "element tristrips 1\nproperty list int " + type +
                        " vertex_indices\n") +
                 square + data);
  };
  const auto turns = [](const MeshFile& file) {
    std::string out;
    for (const MeshTriangle& t : file.triangles) {
      out +=
          cross(t.corner[1].position - t.corner[0].position, t.corner[2].position - t.corner[0].position).z >
                  0
              ? '+'
              : '-';
    }
    return out;
  };
  EXPECT_EQ(turns(strips("4 0 1 3 2\n")), "++");
  EXPECT_EQ(turns(strips("9 0 1 3 2 -1 1 0 2 3\n")), "++--");
  EXPECT_EQ(turns(strips("9 0 1 3 2 4294967295 1 0 2 3\n", "uint")), "++--");
  EXPECT_EQ(turns(strips("4 0 0 1 3\n")), "-") << "a triangle without area counts in the turns";
  EXPECT_EQ(turns(strips("6 -1 0 1 3 -1 -1\n")), "+");
  const MeshFile odd = strips("7 0 1 -1 0 1 3 -1\n");
  EXPECT_EQ(turns(odd), "+");
  EXPECT_TRUE(has_note(odd, "1 strips of 1 or 2 vertices are left out"));
  EXPECT_TRUE(
      names(input_error([&] { strips("3 0 1 4\n"); }), "a.ply:14: tristrips 0: vertex 4 is not there"));
  EXPECT_TRUE(names(input_error([&] { strips("3 0 1 -2\n"); }), "vertex -2 is not there"));
}

TEST(Ply, OtherElementsAreSkipped) {
  const MeshFile file =
      parse(header("element camera 1\nproperty float a\nproperty list uchar float b\nelement face 1\n"
                   "property uchar flags\n" +
                   faces + "property list int short c\nelement vertex 3\nproperty list uchar int d\n" + xyz +
                   "element edge 2\nproperty int vertex1\nproperty int vertex2\n") +
            "1 2 5 6\n7 3 0 1 2 1 9\n0 0 0 0\n2 8 8 1 0 0\n1 4 0 1 0\n0 1\n1 2\n");
  ASSERT_EQ(file.triangles.size(), 1U);
  EXPECT_EQ(file.triangles[0].corner[1].position, (Vec3{1, 0, 0}));
  EXPECT_TRUE(has_note(file, "2 instances of element \"edge\" are left out"));
  EXPECT_TRUE(has_note(file, "1 instances of element \"camera\" are left out"));
}

// A file of random elements in one of three encodings, and what it means.
class Writer {
 public:
  Writer(Random& random, int encoding) : random_(random), encoding_(encoding) {}

  // Returns the value as it comes back.
  double number(const std::string& type, double value) {
    const std::size_t begin = data.size();
    if (type == "float" || type == "float32") {
      const auto single = static_cast<float>(value);
      if (encoding_ == 0) {
        word(single);
      } else {
        bits(std::bit_cast<std::uint32_t>(single), 4);
      }
      if (encoding_ != 0) return single;
      // The nearest double of the shortest digits.
      double back = 0;
      std::from_chars(data.data() + begin, data.data() + data.size(), back);
      return back;
    }
    if (type == "double" || type == "float64") {
      if (encoding_ == 0) {
        word(value);
      } else {
        bits(std::bit_cast<std::uint64_t>(value), 8);
      }
      return value;
    }
    const auto whole = static_cast<std::int64_t>(value);
    const std::size_t size = names_one_of(type, {"char", "uchar", "int8", "uint8"})       ? 1
                             : names_one_of(type, {"short", "ushort", "int16", "uint16"}) ? 2
                                                                                          : 4;
    if (encoding_ == 0) {
      word(whole);
    } else {
      bits(static_cast<std::uint64_t>(whole), size);
    }
    return static_cast<double>(whole);
  }
  void end_line() {
    if (encoding_ == 0 && random_.chance(0.9)) data.back() = '\n';
  }

  std::string data = " ";

 private:
  static bool names_one_of(const std::string& type, std::initializer_list<const char*> types) {
    return std::ranges::any_of(types, [&](const char* t) { return type == t; });
  }
  void word(auto value) {
    std::array<char, 64> digits{};
    data.append(digits.data(), std::to_chars(digits.data(), digits.data() + 64, value).ptr);
    data += random_.chance(0.05) ? "  \t " : " ";
  }
  void bits(std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t byte = encoding_ == 1 ? i : size - 1 - i;
      data += static_cast<char>(value >> (8 * byte) & 255);
    }
  }
  Random& random_;
  int encoding_;
};

TEST(Ply, RandomFilesInEveryEncoding) {
  Random random(11);
  const auto pick = [&](const std::vector<std::string>& from) {
    return from[static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(from.size()) - 1))];
  };
  std::size_t corners = 0;
  for (int round = 0; round < 600; ++round) {
    const int encoding = round % 3;
    const std::string format = encoding == 0   ? "ascii"
                               : encoding == 1 ? "binary_little_endian"
                                               : "binary_big_endian";
    Writer writer(random, encoding);
    const std::int64_t vertex_count = random.integer(3, 40), face_count = random.integer(1, 40);
    struct Property {
      std::string name, type, length;
    };
    std::vector<Property> properties;
    for (const char* name : {"x", "y", "z"})
      properties.push_back({name, pick({"float", "float32", "double", "float64", "short"}), ""});
    const std::string color = pick({"uchar", "uint8", "ushort", "uint16"});
    for (const char* name : {"red", "green", "blue"}) properties.push_back({name, color, ""});
    for (int extra = 0; extra < 3; ++extra) {
      properties.push_back({"extra" + std::to_string(extra),
                            pick({"char", "uchar", "int", "double", "int16"}),
                            random.chance(0.3) ? pick({"uchar", "short", "int32"}) : ""});
    }
    for (std::size_t i = properties.size(); i > 1; --i) {
      std::swap(properties[i - 1],
                properties[static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(i) - 1))]);
    }
    std::string vertex_header = "element vertex " + std::to_string(vertex_count) + "\n";
    for (const Property& p : properties) {
      vertex_header +=
          "property " + (p.length.empty() ? "" : "list " + p.length + " ") + p.type + " " + p.name + "\n";
    }
    const std::string index_type = pick({"uchar", "char", "short", "uint16", "int", "uint32"});
    const std::string length_type = pick({"uchar", "int8", "short", "uint"});
    const std::string face_header = "element face " + std::to_string(face_count) + "\nproperty list " +
                                    length_type + " " + index_type + " " +
                                    pick({"vertex_indices", "vertex_index"}) + "\n";

    std::vector<Vec3> positions;
    std::vector<Color> colors;
    const auto write_vertices = [&] {
      for (std::int64_t i = 0; i < vertex_count; ++i) {
        Vec3& position = positions.emplace_back();
        Color& c = colors.emplace_back(Color{1, 1, 1, 1});
        for (const Property& p : properties) {
          if (!p.length.empty()) {
            const std::int64_t length = random.integer(0, 4);
            writer.number(p.length, static_cast<double>(length));
            for (std::int64_t k = 0; k < length; ++k) writer.number(p.type, 7);
          } else if (p.name.size() == 1) {
            (p.name == "x"   ? position.x
             : p.name == "y" ? position.y
                             : position.z) = writer.number(p.type, random.uniform(-1000, 1000));
          } else if (p.type == color && !p.name.starts_with("extra")) {
            const double max = color == "uchar" || color == "uint8" ? 255 : 65535;
            c[p.name == "red"     ? 0
              : p.name == "green" ? 1
                                  : 2] =
                writer.number(color, static_cast<double>(random.integer(0, static_cast<std::int64_t>(max)))) /
                max;
          } else {
            writer.number(p.type, static_cast<double>(random.integer(0, 100)));
          }
        }
        writer.end_line();
      }
    };
    std::vector<std::array<std::size_t, 3>> triangles;
    const auto write_faces = [&] {
      for (std::int64_t i = 0; i < face_count; ++i) {
        writer.number(length_type, 3);
        for (std::size_t& index : triangles.emplace_back()) {
          index = static_cast<std::size_t>(random.integer(0, vertex_count - 1));
          writer.number(index_type, static_cast<double>(index));
        }
        writer.end_line();
      }
    };
    std::string text = "ply\nformat " + format + " 1.0\n";
    const bool is_face_first = random.chance(0.2);
    if (is_face_first) {
      text += face_header + vertex_header;
      write_faces();
      write_vertices();
    } else {
      text += vertex_header + face_header;
      write_vertices();
      write_faces();
    }
    text += "end_header\n" + writer.data.substr(1);
    const MeshFile file = parse(text);
    ASSERT_EQ(file.triangles.size(), triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(file.triangles[t].corner[k].position, positions[triangles[t][k]]) << round;
        ASSERT_EQ(file.triangles[t].corner[k].color, colors[triangles[t][k]]) << round;
        ++corners;
      }
    }
    if (encoding != 0) {
      ASSERT_NE(refusal(text.substr(0, text.size() - 1)), "");
      ASSERT_TRUE(names(refusal(text + "abc"), "data behind the last element"));
    }
  }
  EXPECT_GT(corners, 20000U);
}

TEST(Ply, NumbersThatAreNotFinite) {
  const std::string start = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + xyz + "end_header\n";
  const float values[] = {0, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
  for (const float value : {values[1], values[2], -values[2]}) {
    std::string data(12, '\0');
    for (std::size_t i = 0; i < 4; ++i)
      data[4 + i] = static_cast<char>(std::bit_cast<std::uint32_t>(value) >> (8 * i));
    EXPECT_EQ(refusal(start + data),
              "a.ply: offset 119, vertex 0: a value is not finite; expected a finite number");
  }
  EXPECT_NO_THROW(parse(start + std::string(12, '\0') + "\r\n")) << "the end of a line behind binary data";
}

}  // namespace
}  // namespace bitspan
