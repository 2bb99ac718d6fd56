// SPDX-License-Identifier: Apache-2.0
#include "scene/tri_stream.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <sstream>

#include "io/png.hpp"
#include "scene/demo.hpp"
#include "scene/procedural.hpp"
#include "scene/random.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

const std::string header =
    R"({"bitspan": 1, "width": 64, "height": 48, "s_min": 1, "s_max": 1000, "focal": 50.5, "background": [0, 0, 0]})"
    "\n";
const std::string triangle = R"({"v": [[1, 2, 3, 4, 5], [10.5, 2, 4, 5, 6], [1, 20, 1000, -7, 8e2]]})"
                             "\n";

std::string parse_error(const std::string& text) {
  return input_error([&] { parse_tri(text, "dir/x.tri"); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_TRUE(same_bits(a.s_min, b.s_min) && same_bits(a.s_max, b.s_max) && same_bits(a.focal, b.focal));
  EXPECT_EQ(a.background, b.background);
  ASSERT_EQ(a.fog.has_value(), b.fog.has_value());
  if (a.fog) {
    EXPECT_EQ(a.fog->color, b.fog->color);
    EXPECT_TRUE(same_bits(a.fog->distance, b.fog->distance));
  }
  EXPECT_EQ(a.projector, b.projector);
  EXPECT_EQ(a.light, b.light);
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (std::size_t i = 0; i < a.textures.size(); ++i) {
    EXPECT_EQ(a.textures[i].width, b.textures[i].width);
    EXPECT_EQ(a.textures[i].height, b.textures[i].height);
    EXPECT_EQ(a.textures[i].rgba, b.textures[i].rgba);
    EXPECT_EQ(a.textures[i].format, b.textures[i].format);
    EXPECT_EQ(a.textures[i].raw, b.textures[i].raw);
    EXPECT_EQ(a.textures[i].table, b.textures[i].table);
  }
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    ASSERT_EQ(a.triangles[i].texture, b.triangles[i].texture);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& p = a.triangles[i].v[k];
      const Vertex& q = b.triangles[i].v[k];
      ASSERT_TRUE(same_bits(p.x, q.x) && same_bits(p.y, q.y) && same_bits(p.s, q.s) && same_bits(p.u, q.u) &&
                  same_bits(p.v, q.v))
          << "triangle " << i << " vertex " << k;
      for (std::size_t c = 0; c < 4; ++c) ASSERT_TRUE(same_bits(p.c[c], q.c[c])) << "triangle " << i;
      for (const GivenAttribute& given : given_attributes) {
        ASSERT_TRUE(same_bits(p.*given.member, q.*given.member)) << given.key << " of triangle " << i;
      }
    }
  }
}

TEST(TriStream, ReadsHeaderAndTriangles) {
  const Scene scene = parse_tri(header + triangle + "\n" + triangle, "dir/x.tri");
  EXPECT_EQ(scene.name, "x");
  EXPECT_EQ(scene.width, 64);
  EXPECT_EQ(scene.height, 48);
  EXPECT_EQ(scene.focal, 50.5);
  EXPECT_FALSE(scene.fog);
  ASSERT_EQ(scene.triangles.size(), 2U);
  const Vertex& v = scene.triangles[1].v[2];
  EXPECT_EQ(v.x, 1);
  EXPECT_EQ(v.y, 20);
  EXPECT_EQ(v.s, 1000);
  EXPECT_EQ(v.u, -7);
  EXPECT_EQ(v.v, 800);
  EXPECT_EQ(v.c, (std::array<double, 4>{1, 1, 1, 1}));
  EXPECT_EQ(scene.triangles[1].texture, -1);
}

TEST(TriStream, HeaderAloneIsABackground) { EXPECT_TRUE(parse_tri(header, "x.tri").triangles.empty()); }

TEST(TriStream, LastLineNeedsNoNewlineAndCarriageReturnsAreSpace) {
  std::string text = header + triangle;
  text.pop_back();
  EXPECT_EQ(parse_tri(text, "x.tri").triangles.size(), 1U);
  text = replaced(header, "\n", "\r\n") + replaced(triangle, "\n", "\r\n");
  EXPECT_EQ(parse_tri(text, "x.tri").triangles.size(), 1U);
}

TEST(TriStream, ColoursWithoutScaleSpeakForThemselves) {
  const Scene codes = parse_tri(replaced(header, "[0, 0, 0]", "[255, 128, 0]"), "x.tri");
  EXPECT_EQ(codes.background, (std::array<std::uint8_t, 3>{255, 128, 0}));
  const Scene fractions = parse_tri(replaced(header, "[0, 0, 0]", "[1, 0.5, 0]"), "x.tri");
  EXPECT_EQ(fractions.background, (std::array<std::uint8_t, 3>{255, 128, 0}));
  const auto colored = [](const std::string& head, const std::string& c) {
    return parse_tri(head + replaced(triangle, "}", ", \"c\": " + c + "}"), "x.tri").triangles[0].v;
  };
  // One component above 1 makes codes of all twelve.
  const auto v = colored(header, "[[1, 0, 0, 1], [0, 255, 0, 1], [0, 0, 51, 1]]");
  EXPECT_EQ(v[0].c, (std::array<double, 4>{1 / 255.0, 0, 0, 1 / 255.0}));
  EXPECT_EQ(v[1].c[1], 1);
  EXPECT_EQ(v[2].c[2], 0.2);
  const auto w = colored(header, "[[1, 0, 0, 1], [0, 0.25, 0, 1], [0, 0, 1, 0.5]]");
  EXPECT_EQ(w[1].c[1], 0.25);
  EXPECT_EQ(w[2].c[3], 0.5);
  const auto x =
      colored(replaced(header, "}", ", \"color_max\": 255}"), "[[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1]]");
  EXPECT_EQ(x[0].c[3], 1 / 255.0);
}

TEST(TriStream, TrianglesGiveTheFogsFactor) {
  const std::string second = replaced(header, "\"bitspan\": 1", "\"bitspan\": 2");
  const auto line = [](const std::string& fog) { return replaced(triangle, "}", ", \"fog\": " + fog + "}"); };
  const Scene scene = parse_tri(second + line("[0, 0.25, 1]") + triangle, "x.tri");
  EXPECT_EQ(scene.triangles[0].v[0].fog, 0);
  EXPECT_EQ(scene.triangles[0].v[1].fog, 0.25);
  EXPECT_EQ(scene.triangles[0].v[2].fog, 1);
  EXPECT_EQ(scene.triangles[1].v[0].fog, -1);
  std::ostringstream out;
  write_tri(out, scene);
  EXPECT_NE(out.str().find("\"bitspan\":2"), std::string::npos);
  expect_same(scene, parse_tri(out.str(), "x.tri"));
  EXPECT_NE(parse_error(second + line("[0, 1]")).find("x.tri:2: fog: "), std::string::npos);
  EXPECT_NE(
      parse_error(second + line("[0, 1.5, 1]")).find("x.tri:2: fog[1]: 1.5 is out of range; expected 0..1"),
      std::string::npos);
  EXPECT_NE(parse_error(header + line("[0, 0, 1]")).find("unknown key; expected v, c, tex"),
            std::string::npos);
  Scene bad = scene;
  for (const double value : {-1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    bad.triangles[0].v[2].fog = value;
    EXPECT_NE(input_error([&] { check_scene(bad, "x"); }).find("x:2: fog[2]: "), std::string::npos);
  }
}

TEST(TriStream, TrianglesGiveTheProjection) {
  const std::string second = replaced(header, "\"bitspan\": 1", "\"bitspan\": 2");
  const std::string thrown = replaced(second, "}", R"(, "projector": {"s_min": 0.1, "s_max": 7}})");
  const auto line = [](const std::string& more) { return replaced(triangle, "}", ", " + more + "}"); };
  const std::string given =
      line(R"("project_x": [-1e30, 0, 2.5], "project_y": [1, 0.1, -0.0], "project_w": [3, -4, 1e-300])");
  const Scene scene = parse_tri(thrown + given + triangle + line("\"project_w\": [0, 0, 1]"), "x.tri");
  EXPECT_EQ(scene.projector, (Projector{0.1, 7}));
  EXPECT_EQ(scene.triangles[0].v[0].project_x, -1e30);
  EXPECT_EQ(scene.triangles[0].v[1].project_y, 0.1);
  EXPECT_TRUE(same_bits(scene.triangles[0].v[2].project_y, -0.0));
  EXPECT_EQ(scene.triangles[0].v[1].project_w, -4);
  for (const Vertex& v : scene.triangles[1].v) {
    EXPECT_TRUE(v.project_x == 0 && v.project_y == 0 && v.project_w == 0);
  }
  EXPECT_EQ(scene.triangles[2].v[2].project_w, 1);
  std::ostringstream out;
  write_tri(out, scene);
  EXPECT_NE(out.str().find(R"("bitspan":2)"), std::string::npos);
  EXPECT_NE(out.str().find(R"("projector":{"s_min":0.1,"s_max":7})"), std::string::npos);
  expect_same(scene, parse_tri(out.str(), "x.tri"));
  // A projector alone, and what is projected alone, ask for version 2.
  for (const std::string& text : {thrown + triangle, second + given}) {
    std::ostringstream one;
    write_tri(one, parse_tri(text, "x.tri"));
    EXPECT_EQ(one.str().find(R"({"bitspan":2)"), 0U);
    expect_same(parse_tri(text, "x.tri"), parse_tri(one.str(), "x.tri"));
  }
  EXPECT_NE(parse_error(header + line("\"project_x\": [0, 0, 1]")).find("unknown key; expected v, c, tex"),
            std::string::npos);
  EXPECT_NE(parse_error(second + line("\"project_x\": [0, 1]")).find("x.tri:2: project_x: "),
            std::string::npos);
  EXPECT_NE(parse_error(second + line("\"project_w\": [0, null, 1]")).find("x.tri:2: project_w[1]: "),
            std::string::npos);
  EXPECT_NE(parse_error(second + line("\"project_z\": [0, 0, 1]")).find("unknown key"), std::string::npos);
  Scene bad = scene;
  for (double Attributes::*const member :
       {&Attributes::project_x, &Attributes::project_y, &Attributes::project_w}) {
    for (const double value : {HUGE_VAL, -HUGE_VAL, std::numeric_limits<double>::quiet_NaN()}) {
      bad.triangles[0].v[2].*member = value;
      const std::string message = input_error([&] { check_scene(bad, "x"); });
      EXPECT_EQ(message.find("x:2: project_"), 0U) << message;
      EXPECT_NE(message.find("[2]: "), std::string::npos) << message;
    }
    bad.triangles[0].v[2].*member = 0;
  }
  EXPECT_EQ(error_of([&] { check_scene(bad, "x"); }), "");
  for (const Projector& range : {Projector{0, 1}, {1, 1}, {2, 1}, {1, HUGE_VAL}, {std::nan(""), 1}}) {
    bad.projector = range;
    EXPECT_NE(input_error([&] { check_scene(bad, "x"); }).find("projector.s_min: is not legal; expected"),
              std::string::npos);
  }
}

TEST(TriStream, RefusesBadProjectors) {
  const auto refused = [](const std::string& projector) {
    return parse_error(replaced(replaced(header, "\"bitspan\": 1", "\"bitspan\": 2"), "}",
                                ", \"projector\": " + projector + "}"));
  };
  const std::pair<const char*, const char*> cases[] = {
      {"3", "projector: 3 is not an object; expected {\"s_min\": a, \"s_max\": b}"},
      {"null", "projector: null is not an object"},
      {R"({"s_min": 1})", "projector.s_max: key is missing; expected a distance above 0"},
      {R"({"s_max": 1})", "projector.s_min: key is missing"},
      {"{}", "projector.s_min: key is missing"},
      {R"({"s_min": 0, "s_max": 1})", "projector.s_min: 0 is not positive"},
      {R"({"s_min": 1, "s_max": "2"})", "projector.s_max: \"2\" is not a number"},
      {R"({"s_min": 2, "s_max": 2})",
       "projector.s_min: 2 is not below s_max = 2; expected 0 < s_min < s_max"},
      {R"({"s_min": 1, "s_max": 2, "focal": 1})", "projector.\"focal\": unknown key"},
  };
  for (const auto& [projector, message] : cases) {
    EXPECT_EQ(refused(projector).find("dir/x.tri:1: " + std::string(message)), 0U) << refused(projector);
  }
  EXPECT_EQ(parse_error(replaced(header, "}", R"(, "projector": {"s_min": 1, "s_max": 2}})")),
            "dir/x.tri:1: projector: is not legal in version 1; expected \"bitspan\": 2");
}

struct Refusal {
  const char* from;
  const char* to;
  const char* message;
};

TEST(TriStream, RefusesBadHeaders) {
  const Refusal cases[] = {
      {"\"bitspan\": 1", "\"bitspan\": 3", "x.tri:1: bitspan: 3 is not legal; expected a whole number 1..2"},
      {"\"bitspan\": 1, ", "", "x.tri:1: bitspan: no header"},
      {"\"width\": 64, ", "", "x.tri:1: width: key is missing"},
      {"\"height\": 48, ", "", "x.tri:1: height: key is missing"},
      {"\"focal\": 50.5, ", "", "x.tri:1: focal: key is missing"},
      {", \"background\": [0, 0, 0]", "", "x.tri:1: background: key is missing"},
      {"\"width\": 64", "\"width\": 0", "x.tri:1: width: 0 is not legal; expected a whole number 1..32768"},
      {"\"width\": 64", "\"width\": -64", "x.tri:1: width: -64"},
      {"\"width\": 64", "\"width\": 32769", "x.tri:1: width: 32769"},
      {"\"width\": 64", "\"width\": 64.5", "x.tri:1: width: 64.5"},
      {"\"width\": 64", "\"width\": \"64\"", "x.tri:1: width: \"64\""},
      {"\"width\": 64", "\"width\": 18446744073709551680", "x.tri:1: width: "},
      {"\"width\": 64, \"height\": 48", "\"width\": 32768, \"height\": 32768", "x.tri:1: width: the picture"},
      {"\"s_min\": 1", "\"s_min\": 0", "x.tri:1: s_min: 0 is not positive"},
      {"\"s_min\": 1", "\"s_min\": -1", "x.tri:1: s_min: -1 is not positive"},
      {"\"s_min\": 1", "\"s_min\": 1000", "x.tri:1: s_min: 1000 is not below s_max = 1000"},
      {"\"s_min\": 1", "\"s_min\": null", "x.tri:1: s_min: null is not a number"},
      {"\"s_max\": 1000", "\"s_max\": 1e999", "x.tri:1: a number is too large"},
      {"\"s_max\": 1000", "\"s_max\": NaN", "x.tri:1: not JSON at column"},
      {"\"s_max\": 1000", "\"s_max\": Infinity", "x.tri:1: not JSON at column"},
      {"\"focal\": 50.5", "\"focal\": 0", "x.tri:1: focal: 0 is not positive"},
      {"\"focal\": 50.5", "\"focal\": true", "x.tri:1: focal: true is not a number"},
      {"\"focal\"", "\"fogal\"", "x.tri:1: \"fogal\": unknown key; expected bitspan, width"},
      {"\"width\": 64", "\"width\": 64, \"width\": 65", "x.tri:1: \"width\": the key stands twice"},
      {"[0, 0, 0]", "[0, 0]", "x.tri:1: background: has 2 elements"},
      {"[0, 0, 0]", "[0, 0, 256]", "x.tri:1: background: component 256 is out of range; expected 0..255"},
      {"[0, 0, 0]", "[0, 0, -1]", "x.tri:1: background: component -1 is out of range"},
      {"[0, 0, 0]", "7", "x.tri:1: background: 7 is not an array"},
      {"[0, 0, 0]}", "[0, 0, 0], \"color_max\": 2}", "x.tri:1: color_max: 2 is not legal; expected 1 or 255"},
      {"[0, 0, 0]}", "[0, 2, 0], \"color_max\": 1}",
       "x.tri:1: background: component 2 is out of range; expected 0..1"},
      {"[0, 0, 0]}", "[0, 0, 0], \"fog\": 3}", "x.tri:1: fog: 3 is not an object"},
      {"[0, 0, 0]}", "[0, 0, 0], \"fog\": {\"color\": [1, 1, 1]}}", "x.tri:1: fog.distance: key is missing"},
      {"[0, 0, 0]}", "[0, 0, 0], \"fog\": {\"distance\": 1}}", "x.tri:1: fog.color: key is missing"},
      {"[0, 0, 0]}", "[0, 0, 0], \"fog\": {\"color\": [1, 1, 1], \"distance\": 0}}",
       "x.tri:1: fog.distance: 0 is not"},
      {"[0, 0, 0]}", "[0, 0, 0], \"fog\": {\"color\": [1, 1, 1], \"distance\": 1, \"x\": 1}}",
       "x.tri:1: fog.\"x\": unknown key"},
      {"[0, 0, 0]}", "[0, 0, 0], \"textures\": \"a.png\"}", "x.tri:1: textures: \"a.png\" is not an array"},
      {"[0, 0, 0]}", "[0, 0, 0], \"textures\": [7]}", "x.tri:1: textures[0]: 7 is not a file name"},
      {"[0, 0, 0]}", "[0, 0, 0], \"textures\": [\"none.png\"]}",
       "x.tri:1: textures[0]: dir/none.png: cannot read"},
      {"\"focal\": 50.5", "\"focal\": 50.5.5", "x.tri:1: not JSON at column"},
      {"{\"bitspan\"", "[\"bitspan\"", "x.tri:1: not JSON at column"},
  };
  for (const Refusal& c : cases) {
    EXPECT_EQ(parse_error(replaced(header, c.from, c.to)).rfind(std::string("dir/") + c.message, 0), 0U)
        << c.to << " gave: " << parse_error(replaced(header, c.from, c.to));
  }
}

TEST(TriStream, RefusesBadTriangles) {
  const Refusal cases[] = {
      {"\"v\"", "\"w\"", "x.tri:2: \"w\": unknown key; expected v, c, tex"},
      {"[1, 2, 3, 4, 5], ", "", "x.tri:2: v: has 2 elements; expected three vertices"},
      {"[1, 2, 3, 4, 5]", "[1, 2, 3, 4]", "x.tri:2: v[0]: has 4 elements; expected [x, y, s, u, v]"},
      {"[1, 2, 3, 4, 5]", "{\"x\": 1}", "x.tri:2: v[0]: {\"x\":1} is not an array"},
      {"[10.5, 2, 4, 5, 6]", "[10.5, null, 4, 5, 6]", "x.tri:2: v[1][1]: null is not a number"},
      {"[10.5, 2, 4, 5, 6]", "[10.5, \"2\", 4, 5, 6]", "x.tri:2: v[1][1]: \"2\" is not a number"},
      {"[10.5, 2, 4, 5, 6]", "[10.5, 2, 4, 1e999, 6]", "x.tri:2: a number is too large"},
      {"[10.5, 2, 4, 5, 6]", "[10.5, 2, 0.5, 5, 6]",
       "x.tri:2: v[1][2]: s = 0.5 is out of range; expected s_min..s_max, 1..1000"},
      {"[10.5, 2, 4, 5, 6]", "[10.5, 2, 1000.0001, 5, 6]", "x.tri:2: v[1][2]: s = 1000.0001 is out of range"},
      {"[10.5, 2, 4, 5, 6]", "[32768, 2, 4, 5, 6]", "x.tri:2: v[1][0]: x = 32768 is out of range"},
      {"[10.5, 2, 4, 5, 6]", "[0, -4e9, 4, 5, 6]", "x.tri:2: v[1][1]: y = -4e+09 is out of range"},
      {"[10.5, 2, 4, 5, 6]", "[1, 11, 4, 5, 6]", "x.tri:2: v: the triangle has no area"},
      {"[10.5, 2, 4, 5, 6]", "[1, 2, 4, 5, 6]", "x.tri:2: v: the triangle has no area"},
      {"]]}", "]], \"tex\": 0}", "x.tri:2: tex: the header names no textures"},
      {"]]}", "]], \"c\": [[1, 1, 1, 1], [1, 1, 1, 1]]}", "x.tri:2: c: has 2 elements"},
      {"]]}", "]], \"c\": [[1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}",
       "x.tri:2: c[0]: has 3 elements; expected [red, green"},
      {"]]}", "]], \"c\": [[1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, -0.1]]}",
       "x.tri:2: c: component -0.1 is out of range"},
      {"]]}", "]], \"c\": [[1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 256]]}",
       "x.tri:2: c: component 256 is out of range"},
      {"]]}", "]], \"v\": 1}", "x.tri:2: \"v\": the key stands twice"},
      {"]]}", "]", "x.tri:2: the line ends inside its JSON (truncated?)"},
      {"]]}", "]]}}", "x.tri:2: not JSON at column"},
      {"{\"v\"", "7 {\"v\"", "x.tri:2: not JSON at column"},
  };
  for (const Refusal& c : cases) {
    const std::string message = parse_error(header + replaced(triangle, c.from, c.to));
    EXPECT_EQ(message.rfind(std::string("dir/") + c.message, 0), 0U) << c.to << " gave: " << message;
  }
  EXPECT_EQ(parse_error(header + "7\n").rfind("dir/x.tri:2: 7 is not an object", 0), 0U);
  EXPECT_EQ(parse_error(header + triangle + "\n{}\n").rfind("dir/x.tri:4: v: key is missing", 0), 0U);
  EXPECT_EQ(parse_error(header + header).rfind("dir/x.tri:2: \"bitspan\": unknown key", 0), 0U);
}

TEST(TriStream, RefusesEveryTruncation) {
  const std::string line = triangle.substr(0, triangle.size() - 1);
  for (std::size_t length = 1; length < line.size(); ++length) {
    EXPECT_EQ(
        parse_error(header + line.substr(0, length)).rfind("dir/x.tri:2: the line ends inside its JSON", 0),
        0U)
        << length;
  }
}

TEST(TriStream, RefusesFilesThatAreNoStream) {
  EXPECT_NE(parse_error("").find("x.tri:1: the file is empty"), std::string::npos);
  EXPECT_NE(parse_error("\n \n").find("the file is empty"), std::string::npos);
  EXPECT_NE(parse_error(triangle).find("x.tri:1: bitspan: no header"), std::string::npos);
  EXPECT_NE(parse_error(std::string(2000000, 'x')).find("x.tri:1: the line is too long"), std::string::npos);
  EXPECT_NE(parse_error(std::string(300, '\0')).find("x.tri:1: not JSON"), std::string::npos);
  EXPECT_NE(parse_error(header + std::string(64, '[')).find("x.tri:2: the line ends inside"),
            std::string::npos);
  const TemporaryFolder folder;
  EXPECT_NE(input_error([&] { read_tri(folder.path("none.tri")); }).find("cannot read: No such file"),
            std::string::npos);
  EXPECT_NE(input_error([&] { read_tri(folder.path()); }).find("is a folder"), std::string::npos);
}

// A whole value of that depth crashed where a message showed it.
TEST(TriStream, RefusesDeepJson) {
  for (const std::string open : {"[", "{\"v\":"}) {
    const std::string close = open == "[" ? "]" : "}";
    const auto nested = [&](int depth) {
      std::string text;
      for (int i = 0; i < depth; ++i) text += open;
      text += "1";
      for (int i = 0; i < depth; ++i) text += close;
      return text;
    };
    EXPECT_EQ(parse_error(header + nested(64)).find("deep"), std::string::npos);
    for (const int depth : {65, 100000}) {
      EXPECT_NE(
          parse_error(header + nested(depth)).find("x.tri:2: arrays and objects are nested more than 64"),
          std::string::npos);
      EXPECT_NE(parse_error(nested(depth)).find("x.tri:1: arrays and objects are nested more than 64"),
                std::string::npos);
    }
  }
  const std::string brackets(70, '[');
  EXPECT_NE(parse_error(header + "{\"" + brackets + "\\\"" + brackets + "\":1}").find("unknown key"),
            std::string::npos);
}

TEST(TriStream, AByteOrderMarkIsPassedOver) {
  const Scene scene = parse_tri("\xEF\xBB\xBF" + std::string(header) + triangle, "x.tri");
  EXPECT_EQ(scene.triangles.size(), 1U);
}

// However a number is spelled, it is the double that strtod gives.
TEST(TriStream, NumbersAreTheNearestDoubles) {
  std::mt19937_64 random(23);
  const auto digits = [&](int most) {
    std::string text;
    for (int n = 1 + static_cast<int>(random() % static_cast<unsigned>(most)); n > 0; --n) {
      text += static_cast<char>('0' + random() % 10);
    }
    return text;
  };
  int integers = 0, exponents = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = random() % 2 == 0 ? "-" : "";
    text += random() % 4 == 0 ? "0" : std::to_string(1 + random() % 9) + digits(random() % 8 == 0 ? 40 : 4);
    const bool has_fraction = random() % 3 != 0;
    if (has_fraction) text += "." + digits(random() % 4 == 0 ? 60 : 20);
    if (random() % 2 == 0) {
      text += std::string(random() % 2 == 0 ? "e-" : "E-") + digits(2);
      ++exponents;
    } else if (!has_fraction) {
      ++integers;
    }
    const double expected = std::strtod(text.c_str(), nullptr);
    const Scene scene = parse_tri(header + replaced(triangle, "4, 5]", "4, " + text + "]"), "x.tri");
    const double read = scene.triangles.at(0).v[0].v;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read == 0 ? 0.0 : read),
              std::bit_cast<std::uint64_t>(expected == 0 ? 0.0 : expected))
        << text;
  }
  EXPECT_GT(integers, 300);
  EXPECT_GT(exponents, 1000);
}

TEST(TriStream, TexturesAreRelativeToTheFile) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("sub"));
  write_png(folder.path("sub/t.png"), 2, 1, 4, std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8});
  const std::string head = replaced(header, "}", ", \"textures\": [\"t.png\"]}");
  const std::string path = folder.write("sub/a.tri", head + replaced(triangle, "]]}", "]], \"tex\": 0}"));
  const Scene scene = read_tri(path);
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.textures[0].name, "t.png");
  EXPECT_EQ(scene.textures[0].rgba, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(scene.triangles[0].texture, 0);

  folder.write("sub/a.tri", head + replaced(triangle, "]]}", "]], \"tex\": 1}"));
  EXPECT_NE(
      input_error([&] { read_tri(path); }).find("a.tri:2: tex: 1 is not legal; expected a whole number 0..0"),
      std::string::npos);
  folder.write("sub/a.tri", head + replaced(triangle, "]]}", "]], \"tex\": -1}"));
  EXPECT_NE(input_error([&] { read_tri(path); }).find("tex: -1 is not legal"), std::string::npos);
  folder.write("sub/t.png", "no picture");
  EXPECT_NE(input_error([&] { read_tri(path); }).find("a.tri:1: textures[0]: "), std::string::npos);
}

TEST(TriStream, ReaderHandsOutOneTriangleAtATime) {
  std::istringstream in(header + triangle + triangle + "oops\n");
  TriReader reader(in, "x.tri");
  EXPECT_EQ(reader.scene().width, 64);
  Triangle t;
  EXPECT_TRUE(reader.next(t));
  EXPECT_TRUE(reader.next(t));
  EXPECT_THROW(reader.next(t), InputError);
}

TEST(TriStream, RoundTripsEveryBit) {
  const TemporaryFolder folder;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Scene scene = random_scene(seed);
    write_tri_file(folder.path("s.tri"), scene);
    expect_same(scene, read_tri(folder.path("s.tri")));
  }
  const Scene demo = demo_scene(320, 240);
  write_tri_file(folder.path("demo.tri"), demo);
  const Scene back = read_tri(folder.path("demo.tri"));
  expect_same(demo, back);
  std::ostringstream first, second;
  write_tri(first, back);
  write_tri(second, read_tri(folder.path("demo.tri")));
  EXPECT_EQ(first.str(), second.str());
  EXPECT_NE(first.str().find("\"color_max\":1"), std::string::npos);
}

// Version 2: a texture of each format, among images.
TEST(TriStream, RoundTripsTexelFormats) {
  const TemporaryFolder folder;
  Scene scene = demo_scene(64, 48);
  const Texture image = scene.textures[0];
  for (std::size_t f = 1; f < enum_names<TexelFormat>.size(); ++f) {
    const auto format = static_cast<TexelFormat>(f);
    if (is_procedural(format)) {
      Random random(f);
      scene.textures.push_back(random_procedural(random, format, 5, static_cast<int>(f)));
      continue;
    }
    Texture t;
    t.name = "t";
    t.format = format;
    t.width = 5;
    t.height = static_cast<int>(f);
    for (std::size_t k = 0; k < raw_size(format, 5, t.height); ++k) {
      t.raw.push_back(static_cast<std::uint8_t>(k * 31 + f));
    }
    for (int k = 0; k < texel_layout(format).table_size; ++k) {
      t.table.push_back(static_cast<std::int16_t>(k < 28 ? k * 7 % 256 : k * 5 % 256));
    }
    if (texel_layout(format).table_size == yiq_table_size) t.table[20] = -256;
    scene.textures.push_back(t);
  }
  scene.textures.push_back(image);
  write_tri_file(folder.path("f.tri"), scene);
  EXPECT_TRUE(folder.read("f.tri").starts_with("{\"bitspan\":2,"));
  const Scene back = read_tri(folder.path("f.tri"));
  expect_same(scene, back);
  write_tri_file(folder.path("f.tri"), back);
  expect_same(scene, read_tri(folder.path("f.tri")));
}

std::string header2(const std::string& textures) {
  return replaced(replaced(header, "\"bitspan\": 1", "\"bitspan\": 2"), "}",
                  ", \"textures\": [" + textures + "]}");
}

TEST(TriStream, ReadsImagesInAFormatAndRawTexels) {
  const TemporaryFolder folder;
  write_png(folder.path("t.png"), 2, 1, 4, std::vector<std::uint8_t>{255, 0, 255, 0, 8, 130, 66, 255});
  folder.write("t.bin", std::string("\x01\x02\x03\x04", 4));
  std::string palette(1024, '\x07');
  folder.write("p.bin", palette);
  const auto read = [&](const std::string& textures) {
    return read_tri(folder.write("a.tri", header2(textures) + triangle)).textures.at(0);
  };
  Texture t = read(R"({"file": "t.png", "format": "rgb565"})");
  EXPECT_EQ(t.name, "t.png");
  EXPECT_EQ(t.format, TexelFormat::rgb565);
  EXPECT_EQ(t.raw, (std::vector<std::uint8_t>{0x1f, 0xf8, 0x08, 0x0c}));  // 31, 0, 31; 1, 32, 8
  t = read(R"({"raw": "t.bin", "format": "ai88", "width": 1, "height": 2})");
  EXPECT_EQ(t.name, "t.bin");
  EXPECT_EQ(t.raw, (std::vector<std::uint8_t>{1, 2, 3, 4}));
  EXPECT_EQ(t.height, 2);
  t = read(R"({"raw": "t.bin", "format": "rgba8888", "width": 1, "height": 1})");
  EXPECT_EQ(t.rgba, (std::vector<std::uint8_t>{1, 2, 3, 4}));
  EXPECT_TRUE(t.raw.empty());
  t = read(R"({"raw": "t.bin", "format": "p8", "width": 4, "height": 1, "palette": "p.bin"})");
  EXPECT_EQ(t.table, std::vector<std::int16_t>(1024, 7));
  t = read(R"({"raw": "t.bin", "format": "p8", "width": 4, "height": 1, "palette": [[1,2,3,4],[5,6,7,8]]})");
  ASSERT_EQ(t.table.size(), 1024U);
  EXPECT_EQ(t.table[6], 7);
  EXPECT_EQ(t.table[8], 0);
  EXPECT_EQ(read("\"t.png\"").rgba.size(), 8U);
}

TEST(TriStream, RefusesBadTexelFormats) {
  const TemporaryFolder folder;
  write_png(folder.path("t.png"), 1, 1, 4, std::vector<std::uint8_t>{1, 2, 3, 4});
  folder.write("t.bin", "1234");
  const auto refused = [&](const std::string& textures, const std::string& part, bool second = true) {
    const std::string head = header2(textures);
    const std::string text = second ? head : replaced(head, "\"bitspan\": 2", "\"bitspan\": 1");
    const std::string path = folder.write("a.tri", text + triangle);
    const std::string message = input_error([&] { read_tri(path); });
    EXPECT_NE(message.find("a.tri:1: " + part), std::string::npos) << message;
  };
  refused(R"({"file": "t.png", "format": "rgb565"})",
          "textures[0]: {\"file\":\"t.png\",\"format\":\"rgb565\"} is not", false);
  refused(R"({"file": "t.png", "format": "rgb556"})",
          "textures[0].format: \"rgb556\" is not legal; expected one of rgba8888,");
  refused(R"({"file": "t.png"})", "format: key is missing");
  refused(R"({"format": "i8"})", "file: key is missing");
  refused(R"({"file": "n.png", "format": "i8"})", "textures[0]: ");
  refused(R"({"file": "t.png", "format": "i8", "width": 3})", "textures[0].\"width\": unknown key");
  refused(R"({"file": "t.png", "format": "i8", "palette": "p.bin"})",
          "textures[0].palette: the format i8 has none");
  refused(R"({"file": "t.png", "format": "yiq422"})", "textures[0]: ");
  refused(R"({"raw": "t.bin", "format": "i8", "width": 3, "height": 1})", "textures[0].raw: ");
  refused(R"({"raw": "t.bin", "format": "dxt1", "width": 1, "height": 1})", "textures[0].raw: ");
  refused(R"({"raw": "t.bin", "format": "i8", "width": 16385, "height": 1})", "width: 16385 is not legal");
  refused(R"({"raw": "t.bin", "format": "p8", "width": 4, "height": 1})",
          "textures[0].palette: key is missing");
  refused(R"({"raw": "t.bin", "format": "p8", "width": 4, "height": 1, "palette": "t.bin"})",
          "textures[0].palette: ");
  refused(R"({"raw": "t.bin", "format": "p8", "width": 4, "height": 1, "palette": [[1, 2, 3, 256]]})",
          "textures[0].palette[0]: 256 is not legal");
  refused(R"({"raw": "t.bin", "format": "yiq422", "width": 4, "height": 1, "yiq": {"y": [1]}})",
          "textures[0].yiq.y[0]: has 1 elements");
}

// A checker of 8 x 4 texels whose first colour is red, with that code.
std::string checker(int red) {
  return R"({"procedural": {"kind": "checker", "width": 8, "height": 4, "cell_width": 2, "cell_height": 1, "colors": [[)" +
         std::to_string(red) + ", 0, 0, 255], [9, 8, 7, 6]]}}";
}

TEST(TriStream, ReadsProceduralTextures) {
  const Scene scene = parse_tri(
      header2(
          checker(3) +
          R"(, {"procedural": {"kind": "brick", "width": 32, "height": 16, "colors": [[1, 2, 3, 4], [5, 6, 7, 8]], "brick_width": 8, "brick_height": 4, "mortar": 1, "shift": 3, "vary": 100, "seed": 12}})"
          R"(, {"procedural": {"kind": "noise", "width": 1, "height": 2, "colors": [[1, 2, 3, 4], [5, 6, 7, 8]], "log2_cell": 5, "octaves": 6, "seed": 32767}})"),
      "a.tri");
  ASSERT_EQ(scene.textures.size(), 3U);
  using Table = std::vector<std::int16_t>;
  EXPECT_EQ(scene.textures[0].format, TexelFormat::checker);
  EXPECT_EQ(scene.textures[0].width, 8);
  EXPECT_EQ(scene.textures[0].height, 4);
  EXPECT_EQ(scene.textures[0].table, (Table{3, 0, 0, 255, 9, 8, 7, 6, 2, 1}));
  EXPECT_EQ(scene.textures[1].table, (Table{1, 2, 3, 4, 5, 6, 7, 8, 8, 4, 1, 3, 100, 12}));
  EXPECT_EQ(scene.textures[2].table, (Table{1, 2, 3, 4, 5, 6, 7, 8, 5, 6, 32767}));
}

TEST(TriStream, RefusesBadProceduralTextures) {
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& part) {
    const std::string message = parse_error(header2(replaced(checker(1), from, to)));
    EXPECT_TRUE(message.starts_with("dir/x.tri:1: textures[0].procedural" + part)) << message;
  };
  refused("\"checker\"", "\"marble\"",
          ".kind: \"marble\" is not legal; expected one of checker, brick, noise");
  refused("\"width\": 8", "\"width\": 0", ".width: 0 is not legal");
  refused("\"width\": 8, ", "", ".width: key is missing");
  refused("\"cell_width\": 2, ", "", ".cell_width: key is missing");
  refused("\"cell_width\": 2", "\"cell_width\": 0",
          ".cell_width: 0 is not legal; expected a whole number 1..16384");
  refused("\"cell_width\"", "\"mortar\": 1, \"cell_width\"", ".\"mortar\": unknown key");
  refused("[9, 8, 7, 6]", "[9, 8, 7, 256]", ".colors[1]: 256 is not legal");
  refused(", [9, 8, 7, 6]", "", ".colors: is not legal; expected two colours");
  EXPECT_NE(parse_error(header2(R"({"procedural": 3})")).find("textures[0].procedural: 3 is not an object"),
            std::string::npos);
  const std::string noise = parse_error(header2(
      R"({"procedural": {"kind": "noise", "width": 1, "height": 2, "colors": [[1, 2, 3, 4], [5, 6, 7, 8]],)"
      R"("log2_cell": 2, "octaves": 4, "seed": 1}})"));
  EXPECT_NE(noise.find(".octaves: 4 is out of range; expected 1..3"), std::string::npos) << noise;
  EXPECT_NE(parse_error(replaced(header2(checker(1)), "\"bitspan\": 2", "\"bitspan\": 1"))
                .find("is not a file name"),
            std::string::npos);
  EXPECT_NE(
      parse_error(header2(R"({"file": "a.png", "format": "noise"})")).find("format: \"noise\" is not legal"),
      std::string::npos);
}

const std::string second_triangle =
    R"({"v": [[1, 2, 3, 4, 5], [10.5, 2, 4, 5, 6], [1, 20, 1000, -7, 8e2]], "tex": 1})"
    "\n";
// Textures: one alone, one of three images.
const std::string frames =
    checker(50) + ", {\"frames\": [" + checker(60) + "," + checker(61) + "," + checker(62) + "]}";

// What a triangle's first texture code is.
int red_of(const Scene& scene, std::size_t triangle) {
  return scene.textures.at(static_cast<std::size_t>(scene.triangles.at(triangle).texture)).table.at(0);
}

TEST(TriStream, DynamicTexturesShowTheirFrame) {
  const std::string text = header2(frames) + second_triangle + "{\"frame\": 2}\n" + second_triangle +
                           replaced(second_triangle, "\"tex\": 1", "\"tex\": 0") + "{\"frame\": 0}\n" +
                           second_triangle;
  const Scene scene = parse_tri(text, "a.tri");
  EXPECT_EQ(scene.textures.size(), 4U);
  EXPECT_EQ(red_of(scene, 0), 60);
  EXPECT_EQ(red_of(scene, 1), 62);
  EXPECT_EQ(red_of(scene, 2), 50);  // not dynamic
  EXPECT_EQ(red_of(scene, 3), 60);
  EXPECT_TRUE(scene.commands.empty());
  // From the command line; a line of the stream has the last word.
  const Scene first = parse_tri(text, "a.tri", 1);
  EXPECT_EQ(red_of(first, 0), 61);
  EXPECT_EQ(red_of(first, 1), 62);
  // Written and read again it draws the same.
  const TemporaryFolder folder;
  write_tri_file(folder.path("b.tri"), first);
  const Scene back = read_tri(folder.path("b.tri"));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(red_of(back, i), red_of(first, i));
}

// texture1 names a texture of the header, and so one of the scene's images.
TEST(TriStream, TheSecondTextureIsOfTheHeader) {
  const auto state = [](int texture) {
    return "{\"state\": {\"texture1\": " + std::to_string(texture) + "}}\n";
  };
  const std::string text = header2(frames) + state(1) + second_triangle + "{\"frame\": 2}\n" + state(1) +
                           second_triangle + state(0) + second_triangle + state(-1) + second_triangle;
  const auto values = [](const Scene& scene) {
    std::vector<std::int64_t> out;
    for (const DrawCommand& command : scene.commands) {
      out.push_back(std::get<StateChange>(command.what).settings.at(0).value);
    }
    return out;
  };
  EXPECT_EQ(values(parse_tri(text, "a.tri")), (std::vector<std::int64_t>{1, 3, 0, -1}));
  const Scene scene = parse_tri(text, "a.tri", 1);
  EXPECT_EQ(values(scene), (std::vector<std::int64_t>{2, 3, 0, -1}));
  const TemporaryFolder folder;
  write_tri_file(folder.path("b.tri"), scene);
  EXPECT_TRUE(read_tri(folder.path("b.tri")).commands == scene.commands);
  EXPECT_NE(input_error([&] {
              parse_tri(header2(frames) + state(2), "a.tri");
            }).find("2: state.texture1: texture 2 does not exist, the header has 2; expected -1 to 1"),
            std::string::npos);
}

TEST(TriStream, ReaderTakesAFrameToo) {
  std::istringstream in(header2(frames) + second_triangle);
  TriReader reader(in, "a.tri", 2);
  Triangle triangle;
  ASSERT_TRUE(reader.next(triangle));
  EXPECT_EQ(triangle.texture, 3);
}

TEST(TriStream, RefusesFramesThatAreNotThere) {
  const auto refused = [](const std::string& text, const std::string& part,
                          std::optional<int> frame = std::nullopt) {
    const std::string message = input_error([&] { parse_tri(text, "dir/x.tri", frame); });
    EXPECT_TRUE(message.starts_with("dir/x.tri:" + part)) << message;
  };
  const std::string head = header2(frames);
  refused(head + "{\"frame\": 3}\n", "2: frame: 3 is not legal; expected a whole number 0..2");
  refused(head + "{\"frame\": -1}\n", "2: frame: -1 is not legal");
  refused(head + "{\"frame\": 1, \"state\": {}}\n", "2: \"state\": unknown key");
  refused(head, "1: frame: 3 is not legal", 3);
  refused(header2(checker(1)), "1: frame: the header has no dynamic texture", 0);
  refused(header2(checker(1)) + "{\"frame\": 0}\n", "2: frame: the header has no dynamic texture");
  // The shortest list counts.
  refused(header2(frames + ", {\"frames\": [" + checker(1) + "]}"), "1: frame: 1 is not legal", 1);
  refused(header + "{\"frame\": 0}\n", "2: bitspan: a stream of version 1 has no commands");
  refused(header2("{\"frames\": []}"), "1: textures[0].frames: [] is not legal; expected a list");
  refused(header2("{\"frames\": [" + checker(1) + "], \"format\": \"i8\"}"),
          "1: textures[0].\"format\": unknown key");
  refused(header2("{\"frames\": [" + checker(1) + ", \"none.png\"]}"),
          "1: textures[0].frames[1]: dir/none.png");
  refused(header2("{\"frames\": [{\"frames\": []}]}"), "1: textures[0].frames[0]");
  refused(header2("{\"frames\": [" + checker(1) + ", " +
                  replaced(checker(1), "\"width\": 8", "\"width\": 9") + "]}"),
          "1: textures[0].frames[1]: has 9 x 4 texels; expected 8 x 4, as frames[0]");
}

TEST(TriStream, RoundTripsExtremeNumbers) {
  Scene scene;
  scene.s_min = 0x1p-1022;
  scene.s_max = 1.7976931348623157e308;
  Triangle t;
  t.v[0] = {-0.0, 0.1, 5e-300, 1e22, -1e-320, {0, 1, 0.1, 1 / 3.0}};
  t.v[1] = {32767, -32767, 0x1p-1022, 123456789012345680.0, 1e300, {1, 1, 1, 1}};
  t.v[2] = {1e-310, 3, 1.7976931348623157e308, -0.0, 4.9406564584124654e-324, {1, 1, 1, 1}};
  scene.triangles.push_back(t);
  scene.fog = Fog{{1, 2, 254}, 0.1};
  scene.projector = Projector{4.9406564584124654e-324, 1.7976931348623157e308};
  scene.triangles[0].v[1].project_x = 1.7976931348623157e308;
  scene.triangles[0].v[2].project_y = 1 / 3.0;
  scene.triangles[0].v[0].project_w = -4.9406564584124654e-324;
  std::ostringstream out;
  write_tri(out, scene);
  expect_same(scene, parse_tri(out.str(), "x.tri"));
}

TEST(TriStream, WriterRefusesWhatAReaderWould) {
  const TemporaryFolder folder;
  Scene scene = random_scene(1);
  scene.triangles[3].v[1].s = scene.s_max * 2;
  const std::string message = input_error([&] { write_tri_file(folder.path("s.tri"), scene); });
  EXPECT_NE(message.find("random-1:5: v[1][2]: s = "), std::string::npos) << message;
  EXPECT_EQ(folder.files(), 0);
  EXPECT_NE(
      input_error([&] { write_tri_file(folder.path("none/s.tri"), random_scene(1)); }).find("cannot write"),
      std::string::npos);
}

}  // namespace
}  // namespace bitspan
