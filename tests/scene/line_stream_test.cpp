// SPDX-License-Identifier: Apache-2.0
// Lines of a stream: read, written and refused. docs/formats.md.
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "scene/tri_stream.hpp"
#include "scene/trib.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

const std::string header =
    R"({"bitspan":2,"width":64,"height":48,"s_min":1,"s_max":100,"focal":50,"color_max":1,"background":[0,0,0]})";

Scene parsed(const std::string& lines) { return parse_tri(header + "\n" + lines, "a.tri"); }
std::string refused(const std::string& lines) {
  return input_error([&] { parsed(lines); });
}

TEST(LineStream, ALineStandsAmongTriangles) {
  const Scene scene =
      parsed(R"({"v": [[1,2,3,0,0],[20,2,3,0,0],[1,30,3,0,0]]})"
             "\n"
             R"({"state": {"depth.write": false}})"
             "\n"
             R"({"l": [[1.5,2,3,4,5],[9,8,7,6,5]], "c": [[1,0,0,1],[0,1,0,0.5]], "fog": [0.25, 1]})"
             "\n");
  ASSERT_EQ(scene.triangles.size(), 2U);
  EXPECT_FALSE(scene.triangles[0].is_line);
  const Triangle& line = scene.triangles[1];
  EXPECT_TRUE(line.is_line);
  EXPECT_EQ(line.v[0].x, 1.5);
  EXPECT_EQ(line.v[0].u, 4);
  EXPECT_EQ(line.v[1].s, 7);
  EXPECT_EQ(line.v[1].c, (std::array<double, 4>{0, 1, 0, 0.5}));
  EXPECT_EQ(line.v[1].fog, 1);
  EXPECT_EQ(line.v[2].x, 9);  // repeats the end
  EXPECT_EQ(line.v[2].c, line.v[1].c);
  EXPECT_EQ(scene.commands.front().before, 1U);
}

TEST(LineStream, WrittenAndReadAgainEveryBitIsTheSame) {
  const std::string lines =
      R"({"v":[[1,2,3,0,0],[20,2,3,0,0],[1,30,3,0,0]]})"
      "\n"
      R"({"l":[[0.1,2,3,4,5],[9,8,7,6,5]],"c":[[1,0,0,1],[0.3,1,0,0.5]],"fog":[0.25,1]})"
      "\n"
      R"({"resolve":true})"
      "\n"
      R"({"l":[[5,5,3,0,0],[5,5,3,0,0]]})"
      "\n";
  const Scene scene = parsed(lines);
  std::ostringstream text;
  write_tri(text, scene);
  const std::string written = text.str();
  EXPECT_EQ(written.substr(written.find('\n') + 1), lines);
  EXPECT_TRUE(written.starts_with("{\"bitspan\":2,"));
  std::ostringstream binary;
  write_trib(binary, scene);
  const Scene again = parse_tri(binary.str(), "a.trib");
  std::ostringstream twice;
  write_tri(twice, again);
  EXPECT_EQ(twice.str(), written);
  // A stream without commands is of version 2, too.
  Scene alone = parsed(R"({"l":[[5,5,3,0,0],[6,5,3,0,0]]})");
  std::ostringstream out;
  write_tri(out, alone);
  EXPECT_TRUE(out.str().starts_with("{\"bitspan\":2,"));
}

TEST(LineStream, WhatIsNoLineIsRefused) {
  EXPECT_EQ(refused(R"({"l": [[1,2,3,4,5]]})"),
            "a.tri:2: l: has 1 elements; expected two vertices [x, y, s, u, v]");
  EXPECT_EQ(refused(R"({"l": 5})"), "a.tri:2: l: 5 is not an array; expected two vertices [x, y, s, u, v]");
  EXPECT_EQ(refused(R"({"l": [[1,2,3,4,5],[1,2,300,4,5]]})"),
            "a.tri:2: l[1][2]: s = 300 is out of range; expected s_min..s_max, 1..100");
  EXPECT_EQ(refused(R"({"l": [[1,2,3,4,5],[40000,2,3,4,5]]})"),
            "a.tri:2: l[1][0]: x = 40000 is out of range; expected -32767..32767 pixels");
  EXPECT_EQ(refused(R"({"l": [[1,2,3,4,5],[1,2,3,4,5]], "c": [[1,1,1,1]]})"),
            "a.tri:2: c: has 1 elements; expected two colours [red, green, blue, alpha]");
  EXPECT_TRUE(refused(R"({"l": [[1,2,3,4,5],[1,2,3,4,5]], "v": []})").starts_with("a.tri:2: \"v\""));
  const std::string first =
      R"({"bitspan":1,"width":64,"height":48,"s_min":1,"s_max":100,"focal":50,"background":[0,0,0]})";
  EXPECT_EQ(input_error([&] { parse_tri(first + "\n" + R"({"l": [[1,2,3,4,5],[1,2,3,4,5]]})", "a.tri"); }),
            "a.tri:2: bitspan: a stream of version 1 has no lines; expected a header {\"bitspan\": 2, ...}");
}

}  // namespace
}  // namespace bitspan
