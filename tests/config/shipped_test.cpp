// SPDX-License-Identifier: Apache-2.0
// The files of config/: legal in every mode, commented key by key, and between them every kind of divider.
#include <gtest/gtest.h>

#include <set>

#include "config/check.hpp"
#include "config/names.hpp"
#include "config/shipped_configs.hpp"
#include "tests/config/support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

TEST(Shipped, EachIsLegalWithAnyModeChangedByItsKey) {
  int checked = 0;
  for (const std::string& name : shipped_names) {
    const Config file = shipped_config(name);
    for (const Perspective mode : all_perspectives) {
      for (const EdgeWalk walk : {EdgeWalk::exact, EdgeWalk::dda}) {
        for (const SlopeForm form : {SlopeForm::divide, SlopeForm::reciprocal}) {
          for (const DepthCode code : {DepthCode::inverse, DepthCode::linear, DepthCode::opengl}) {
            for (const FogMode fog : {FogMode::none, FogMode::linear, FogMode::table}) {
              for (const Numerator numerator : {Numerator::pixel_centre, Numerator::ideal_line}) {
                Config c = file;
                c.perspective = mode;
                c.edge_walk = walk;
                c.edge_slope = form;
                c.row_slope = form == SlopeForm::divide ? RowSlope::divide : RowSlope::reciprocal;
                c.depth_code = code;
                c.fog = fog;
                c.numerator = numerator;
                c.filter = TextureFilter::bilinear;
                const auto v = first_violation(c);
                EXPECT_FALSE(v.has_value()) << name << ": " << v->key << ": " << v->text;
                ++checked;
              }
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(checked, 3 * 4 * 2 * 2 * 3 * 3 * 2);
}

TEST(Shipped, ConstantsAreTheFiles) {
  std::set<std::string> names;
  for (const shipped::Entry& entry : shipped::all) {
    Config file = shipped_config(std::string(entry.name));
    EXPECT_EQ(entry.hash, config_hash(file));
    file.name.clear();
    EXPECT_EQ(entry.make(), file) << entry.name;
    names.emplace(entry.name);
  }
  EXPECT_EQ(names, (std::set<std::string>(shipped_names.begin(), shipped_names.end())));
}

// They serve as constant expressions, text of the transparent colour and start offsets included.
static_assert(shipped::depth16().format(FormatId::span_h).word > 0);
static_assert(shipped::depth16() != shipped::depth20() && shipped::depth20() != shipped::narrow());

TEST(Shipped, EveryKeyHasAComment) {
  for (const std::string& name : shipped_names) {
    int keys = 0;
    for (const std::string& line : lines_of(read_file(source_path("config/") + name + ".toml"))) {
      if (line.empty() || line.starts_with('#') || line.starts_with('[')) continue;
      const auto comment = line.find("  # ");
      const auto tight = line.find(" # ");
      ASSERT_NE(tight, std::string::npos) << name << ": " << line;
      EXPECT_GT(line.size(), (comment == std::string::npos ? tight : comment) + 8) << line;
      ++keys;
    }
    EXPECT_GT(keys, 100) << name;
  }
}

TEST(Shipped, DepthBitsFiltersAndDividersVary) {
  EXPECT_EQ(shipped_config("depth16").depth_bits, 16);
  EXPECT_EQ(shipped_config("depth20").depth_bits, 20);
  EXPECT_EQ(shipped_config("depth20").filter, TextureFilter::bilinear);
  std::set<ReciprocalKind> kinds;
  std::set<std::string> hashes;
  for (const std::string& name : shipped_names) {
    const Config c = shipped_config(name);
    EXPECT_EQ(c.name, name);
    EXPECT_EQ(c.transparent, (std::array<std::uint8_t, 3>{255, 0, 255}));
    EXPECT_EQ(c.fog, FogMode::table);
    EXPECT_EQ(c.perspective, Perspective::delta_f);
    kinds.insert({c.edge_reciprocal.kind, c.row_reciprocal.kind, c.pixel_reciprocal.kind});
    hashes.insert(config_hash(c));
  }
  EXPECT_EQ(kinds.size(), 3U);
  EXPECT_EQ(hashes.size(), 3U);
}

TEST(Shipped, NarrowIsNarrower) {
  const Config narrow = shipped_config("narrow");
  const Config wide = shipped_config("depth16");
  int fewer = 0;
  for (int i = 0; i < format_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    EXPECT_LE(narrow.formats[n].word, wide.formats[n].word) << key_of(static_cast<FormatId>(i));
    fewer += narrow.formats[n].word < wide.formats[n].word ? 1 : 0;
  }
  EXPECT_GT(fewer, 40);
  EXPECT_LT(narrow.pixel_reciprocal.output.word, wide.pixel_reciprocal.output.word);
}

}  // namespace
}  // namespace bitspan
