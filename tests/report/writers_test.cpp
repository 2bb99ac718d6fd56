// SPDX-License-Identifier: Apache-2.0
// Tables, JUnit and dumps.
#include <gtest/gtest.h>

#include <boost/property_tree/xml_parser.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "report/dump.hpp"
#include "report/junit.hpp"
#include "report/table.hpp"
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

TEST(Dump, RefusesAFileInItsPlaceAndAMissingParent) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_dump(folder.write("file", "x"), frame(1, 1), {}, config(), {}), InputError);
  EXPECT_THROW(write_dump(folder.path("no-such-folder/d"), frame(1, 1), {}, config(), {}), InputError);
}

}  // namespace
}  // namespace bitspan
