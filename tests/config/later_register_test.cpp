// SPDX-License-Identifier: Apache-2.0
// A register that has a default in its row of BITSPAN_FORMATS: files may leave it out, and at its default it
// changes neither canonical text nor hash. This program is compiled with two such registers more than the
// table has: `like.span_h`, whose default is span.h, and `own.format`, whose default is a format.
#include <gtest/gtest.h>

#include <algorithm>

#include "config/keys.hpp"
#include "config/shipped_configs.hpp"
#include "study/keys.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr Format own{21, 9, true, Rounding::rnd, Overflow::sat, false};

Config reread(const Config& c) {
  Config out = parse_config(to_toml(c), "file.toml");
  out.name = c.name;
  return out;
}

// The canonical text of a shipped configuration with a line more at the end of [formats].
std::string text_with(const std::string& line) {
  std::string text = to_toml(shipped_config("depth16"));
  text.insert(text.find("\n[timing."), line + "\n");
  return text;
}

TEST(LaterRegister, FilesThatLeaveItOutReadAsBefore) {
  std::size_t compared = 0;
  for (const Config& c : shipped_configs()) {
    EXPECT_EQ(c.format(FormatId::like_span_h), c.format(FormatId::span_h));
    EXPECT_EQ(c.format(FormatId::own_format), own);
    EXPECT_EQ(to_toml(c).find("like.span_h"), std::string::npos);
    EXPECT_EQ(to_toml(c).find("own.format"), std::string::npos);
    EXPECT_EQ(reread(c), c);
    for (const shipped::Entry& entry : shipped::all) {  // made without the two registers
      if (entry.name != c.name) continue;
      EXPECT_EQ(config_hash(c), entry.hash);
      ++compared;
    }
  }
  EXPECT_EQ(compared, shipped_names.size());
  EXPECT_EQ(config_hash(Config{}), "50fcfbff116739e6") << "as in write_test.cpp";
}

TEST(LaterRegister, AGivenFormatReadsAndWritesBack) {
  const Config base = shipped_config("depth16");
  for (const FormatId id : {FormatId::like_span_h, FormatId::own_format}) {
    Config c = base;
    c.format(id).word += 1;
    EXPECT_NE(to_toml(c).find("\n\"" + std::string(key_of(id)) + "\" = { "), std::string::npos);
    EXPECT_NE(config_hash(c), config_hash(base));
    EXPECT_EQ(reread(c), c);
  }
  // The default is the format of span.h as the file has it, whatever that is.
  Config c = base;
  c.format(FormatId::span_h).word += 1;
  EXPECT_NE(to_toml(c).find("like.span_h"), std::string::npos);
  EXPECT_EQ(reread(c), c);
  c.format(FormatId::like_span_h).word += 1;
  EXPECT_EQ(to_toml(c).find("like.span_h"), std::string::npos);
}

TEST(LaterRegister, TheReaderIsAsStrictAsForTheOthers) {
  const auto fault = [](const std::string& line) {
    return error_of([&line] { (void)parse_config(text_with(line), "file.toml"); });
  };
  const std::string fields = "signed = true, word = 22, int = 9, round = \"SC_RND\"";
  EXPECT_EQ(fault("own.format = { " + fields + ", overflow = \"SC_SAT\" }"), "");
  EXPECT_TRUE(names(fault("own.format = { " + fields + " }"), "formats.own.format.overflow: missing"));
  EXPECT_TRUE(names(fault("own.format = 3"), "formats.own.format: is an integer; legal: a format"));
  EXPECT_TRUE(names(fault("own.other = 3"), "formats.own.other: unknown key; legal: setup.s, "));
  EXPECT_TRUE(names(
      fault("own.format = { signed = false, word = 64, int = 9, round = \"SC_RND\", overflow = \"SC_SAT\" }"),
      "formats.own.format.word: is 64; legal: 1..63"));
}

TEST(LaterRegister, OnlyRegistersWithADefaultMayBeLeftOut) {
  std::size_t later = 0;
  for (const Key& key : entries()) {
    if (!key.path.starts_with("formats.")) continue;
    const bool ours = key.name() == "like.span_h" || key.name() == "own.format";
    // The registers of levels of textures, of a projector, of light, of reliefs, of curves, of rotations and
    // of the channels fog and shade_* have defaults, too.
    const std::string_view path = key.path;
    const bool has_default = ours || path.starts_with("formats.lod.") ||
                             path.starts_with("formats.distance.") || path.starts_with("formats.project.") ||
                             path.starts_with("formats.shade.") || path.starts_with("formats.light.") ||
                             path.starts_with("formats.normal.") || path.starts_with("formats.relief.") ||
                             path.starts_with("formats.fog.vertex") || path.starts_with("formats.fog.grad") ||
                             path.starts_with("formats.curve.") || path.starts_with("formats.rotate.") ||
                             path.starts_with("formats.fog.step") || path.starts_with("formats.fog.acc");
    EXPECT_EQ(key.presence(), has_default ? Presence::later : Presence::always) << key.path;
    later += ours ? 1 : 0;
  }
  EXPECT_EQ(later, 2U);
}

// A study's settings on a base are what the same settings in the base's file are.
TEST(LaterRegister, AStudysKeysFollowTheDefault) {
  const Config base = shipped_config("depth16");
  const std::int64_t word = base.format(FormatId::span_h).word;
  const Config both = with_keys(base, {{"formats.span.h.word", word - 2}});
  EXPECT_EQ(both.format(FormatId::like_span_h), both.format(FormatId::span_h));
  EXPECT_EQ(to_toml(both).find("like.span_h"), std::string::npos);

  const Config apart =
      with_keys(base, {{"formats.span.h.word", word - 2}, {"formats.like.span_h.word", word}});
  EXPECT_EQ(apart.format(FormatId::like_span_h), base.format(FormatId::span_h)) << "the value given is kept";
  EXPECT_EQ(apart.format(FormatId::span_h), both.format(FormatId::span_h));

  Config given = base;
  given.format(FormatId::like_span_h).word = 20;
  const Config kept = with_keys(given, {{"formats.span.h.word", word - 2}});
  EXPECT_EQ(kept.format(FormatId::like_span_h), given.format(FormatId::like_span_h));
  EXPECT_TRUE(std::ranges::binary_search(all_keys(), std::string("formats.own.format.fraction")));
}

}  // namespace
}  // namespace bitspan
