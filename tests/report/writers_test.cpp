// SPDX-License-Identifier: Apache-2.0
// Tables, JUnit and dumps.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/registry.hpp"
#include "report/dump.hpp"
#include "report/junit.hpp"
#include "report/table.hpp"
#include "scene/random.hpp"
#include "tests/support/files.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

TEST(Junit, IsWellFormedWhateverTheTextsHold) {
  std::string wild;
  for (int c = 1; c < 256; ++c) {
    wild += static_cast<char>(c);
  }
  wild += "]]> <![CDATA[ \xc3\xa4 \xe2\x82\xac \xf0\x9f\x98\x80 \xed\xa0\x80 \xc0\xaf";
  const std::string xml = junit_xml(
      wild, {{wild, wild, 1, wild, wild, ""}, {"a", "b", 2, "", "", ""}, {"s", "k", 0, "", "", wild}});
  std::istringstream in(xml);
  boost::property_tree::ptree tree;
  ASSERT_NO_THROW(boost::property_tree::read_xml(in, tree));
  const auto& suite = tree.get_child("testsuites.testsuite");
  EXPECT_EQ(suite.get<int>("<xmlattr>.tests"), 3);
  EXPECT_EQ(suite.get<int>("<xmlattr>.failures"), 1);
  EXPECT_EQ(suite.get<int>("<xmlattr>.skipped"), 1);
  EXPECT_EQ(suite.count("testcase"), 3U);
  for (const char c : xml) {
    const auto byte = static_cast<unsigned char>(c);
    EXPECT_TRUE(byte >= 0x20 || c == '\n' || c == '\t' || c == '\r');
  }
  EXPECT_NE(xml.find("\xc3\xa4 \xe2\x82\xac \xf0\x9f\x98\x80"), std::string::npos) << "UTF-8 stays as it is";
}

TEST(Table, NumbersStandRight) {
  EXPECT_EQ(text_table({{"name", "n"}, {"a", "1"}, {"bc", "100"}}),
            "name    n\n----  ---\na       1\nbc    100\n");
  EXPECT_NE(html_table({{"a<b"}, {"&"}}).find("a&lt;b"), std::string::npos);
}

Frame frame(int width, int height) {
  Frame f;
  f.width = width;
  f.height = height;
  const auto n = static_cast<std::size_t>(width * height);
  f.color.assign(4 * n, 255);
  f.depth.assign(n, 70000);
  f.u.assign(n, 1.5);
  f.v.assign(n, std::nan(""));
  f.triangle.assign(n, -1);
  return f;
}

Config config() { return shipped_config("depth16"); }

TEST(Junit, ASuiteWithoutACaseIsNone) { EXPECT_THROW(junit_xml("suite", {}), std::logic_error); }

TEST(Dump, HasTheShapesAndTypesOfTheDesign) {
  const TemporaryFolder folder;
  write_dump(folder.path("dump/"), frame(5, 3), {}, config(), {"1.2.3", "scene \"x\"", "model", 0.5});
  const auto has = [&](const char* file, const char* type, const char* shape) {
    const std::string header = folder.read(std::string("dump/") + file).substr(0, 128);
    EXPECT_NE(header.find(type), std::string::npos) << file << header;
    EXPECT_NE(header.find(shape), std::string::npos) << file << header;
  };
  has("color.npy", "'|u1'", "(3, 5, 4)");
  has("depth.npy", "'<u4'", "(3, 5)");
  has("u.npy", "'<f8'", "(3, 5)");
  has("v.npy", "'<f8'", "(3, 5)");
  has("triangle.npy", "'<i4'", "(3, 5)");
  const auto json = nlohmann::json::parse(folder.read("dump/run.json"));
  EXPECT_EQ(json.at("engine"), "model");
  EXPECT_EQ(json.at("scene"), "scene \"x\"");
  EXPECT_EQ(json.at("configuration").at("hash"), config_hash(config()));
  EXPECT_TRUE(json.at("counters").contains("divides_saved"));

  // An existing folder: the dump's files are replaced, others stay.
  folder.write("dump/mine.txt", "keep");
  write_dump(folder.path("dump"), frame(7, 2), {}, config(), {});
  has("depth.npy", "'<u4'", "(2, 7)");
  EXPECT_EQ(folder.read("dump/mine.txt"), "keep");
  EXPECT_EQ(folder.files(), 1) << "the temporary folder is gone";
}

// Alpha is the fourth channel of color.npy; both planes need no draw to be read back.
TEST(Dump, HasTheStoredAlphaAndTheStencil) {
  Scene scene = random_scene(5, {.width = 20, .height = 10, .triangles = 60, .size_min = 8, .size_max = 40});
  const auto set = [](const char* key, auto value) {
    return StateSetting{*find_state_register(key), static_cast<std::int64_t>(value)};
  };
  Clear clear;
  clear.alpha = 7;
  clear.stencil = 9;
  scene.commands = {{0, clear},
                    {0, StateChange{false,
                                    {set("blend.alpha.src", BlendFactor::zero),
                                     set("blend.alpha.dst", BlendFactor::constant_alpha),
                                     set("blend.alpha", 64), set("depth.when", DepthWhen::late),
                                     set("stencil.test", 1), set("stencil.pass", StencilOp::increment)}}}};
  for (const char* name : {"golden", "model"}) {
    SCOPED_TRACE(name);
    const auto engine = make_engine(name, config());
    engine->begin(scene);
    Trace trace;
    draw_scene(*engine, scene, 0, scene.triangles.size(), &trace);
    // What the records write, over what the clear left.
    std::vector<std::uint8_t> alpha(200, 7), stencil(200, 9);
    for (const MergeAlphaRecord& r : trace.merge_alpha)
      alpha[static_cast<std::size_t>(20 * r.y + r.x)] = static_cast<std::uint8_t>(r.a);
    for (const StencilRecord& r : trace.stencil)
      stencil[static_cast<std::size_t>(20 * r.y + r.x)] = static_cast<std::uint8_t>(r.value);
    EXPECT_GT(std::ranges::count(stencil, 11), 0);
    EXPECT_GT(std::ranges::count_if(alpha, [](int a) { return a != 7; }), 50);
    const TemporaryFolder folder;
    write_dump(folder.path("d"), engine->frame(), engine->counters(), config(), {});
    const std::string colors = folder.read("d/color.npy");
    const std::string stencils = folder.read("d/stencil.npy");
    EXPECT_NE(stencils.find("'|u1'"), std::string::npos);
    EXPECT_NE(stencils.find("(10, 20)"), std::string::npos);
    for (std::size_t i = 0; i < 200; ++i) {
      EXPECT_EQ(static_cast<std::uint8_t>(colors[colors.size() - 800 + 4 * i + 3]), alpha[i]) << i;
      EXPECT_EQ(static_cast<std::uint8_t>(stencils[stencils.size() - 200 + i]), stencil[i]) << i;
    }
    // A run without a stencil leaves none of another run.
    write_dump(folder.path("d"), frame(2, 2), {}, config(), {});
    EXPECT_FALSE(std::filesystem::exists(folder.path("d/stencil.npy")));
  }
}

TEST(Dump, RefusesAFileInItsPlaceAndAMissingParent) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_dump(folder.write("file", "x"), frame(1, 1), {}, config(), {}), InputError);
  EXPECT_THROW(write_dump(folder.path("no-such-folder/d"), frame(1, 1), {}, config(), {}), InputError);
}

}  // namespace
}  // namespace bitspan
