// SPDX-License-Identifier: Apache-2.0
#include "study/keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using Settings = std::vector<KeySetting>;

KeyValue integer(std::int64_t v) { return v; }
KeyValue text(const char* v) { return std::string(v); }

TEST(Keys, EveryKeyReadsAndWritesBack) {
  for (const std::string& name : shipped_names) {
    const Config base = shipped_config(name);
    Settings all;
    for (const std::string& key : all_keys()) {
      if (!key.ends_with(".fraction")) all.push_back({key, value_of_key(base, key)});
    }
    EXPECT_GT(all.size(), 300U);
    EXPECT_EQ(with_keys(base, all), base) << name;
    EXPECT_EQ(with_keys(base, {}), base) << name;
  }
}

TEST(Keys, SetsEachTypeAndKeepsTheRest) {
  const Config base = shipped_config("depth16");
  Config expected = base;
  expected.format(FormatId::span_h).word = 30;
  expected.depth_bits = 15;
  expected.depth_code = DepthCode::opengl;
  expected.row_reciprocal.normalize = false;
  expected.start_offset.span_h = {false, 0.5};
  expected.start_offset.span_f = {false, 0};
  expected.transparent = {{1, 2, 3}};
  expected.format(FormatId::span_uv).overflow_expected = true;
  const Config got = with_keys(base, {{"formats.span.h.word", integer(30)},
                                      {"depth.bits", integer(15)},
                                      {"depth.code", text("opengl")},
                                      {"reciprocal.row.normalize", false},
                                      {"start_offset.span_h", 0.5},
                                      {"start_offset.span_f", integer(0)},
                                      {"texture.transparent", text("[1, 2, 3]")},
                                      {"formats.span.uv.overflow_expected", true}});
  EXPECT_EQ(got, expected);
  EXPECT_EQ(got.name, base.name);
  EXPECT_NE(config_hash(got), config_hash(base));
  EXPECT_EQ(value_of_key(got, "texture.transparent"), text("[1, 2, 3]"));
  EXPECT_FALSE(with_keys(base, {{"texture.transparent", text("none")}}).transparent);
  EXPECT_EQ(value_of_key(got, "start_offset.span_h"), KeyValue(0.5));
  EXPECT_EQ(value_of_key(got, "start_offset.edge_h"), text("half_ulp"));
}

TEST(Keys, FractionSetsTheWordAfterTheInt) {
  const Config base = shipped_config("depth16");
  EXPECT_EQ(value_of_key(base, "formats.span.h.fraction"), integer(18));
  // Whatever the order, the word is int + fraction.
  for (const Settings& settings :
       {Settings{{"formats.span.h.fraction", integer(6)}, {"formats.span.h.int", integer(20)}},
        Settings{{"formats.span.h.int", integer(20)}, {"formats.span.h.fraction", integer(6)}}}) {
    const Format f = with_keys(base, settings).format(FormatId::span_h);
    EXPECT_EQ(f.word, 26);
    EXPECT_EQ(f.integer, 20);
  }
  EXPECT_TRUE(names(
      input_error([&] {
        with_keys(base, {{"formats.span.h.fraction", integer(6)}, {"formats.span.h.word", integer(20)}});
      }),
      "formats.span.h.fraction: is set together with formats.span.h.word"));
  EXPECT_TRUE(names(input_error([&] {
                      with_keys(base, {{"formats.span.h.fraction", 6.5}});
                    }),
                    "formats.span.h.fraction: is 6.5; legal: an integer"));
  EXPECT_TRUE(names(input_error([&] {
                      with_keys(base, {{"formats.span.h.fraction", integer(-20)}});
                    }),
                    "formats.span.h.word: is -4"));
}

TEST(Keys, UnknownKeysAreNamedWithTheNearest) {
  const Config base = shipped_config("depth16");
  EXPECT_TRUE(names(input_error([&] {
                      with_keys(base, {{"formats.span.h.wrod", integer(3)}});
                    }),
                    "formats.span.h.wrod: no such key of a configuration; nearest: formats.span.h.word"));
  EXPECT_TRUE(names(input_error([&] { with_keys(base, {{"depht.bits", integer(3)}}); }), "depth.bits"));
  EXPECT_TRUE(names(input_error([&] {
                      with_keys(base, {{"reciprocal.pixel", text("x")}});
                    }),
                    "reciprocal.pixel.bits_per_cycle"));
  EXPECT_TRUE(names(input_error([&] {
                      with_keys(base, {{"formats.span.q.fraction", integer(1)}});
                    }),
                    "no such key"));
  EXPECT_TRUE(names(input_error([&] { value_of_key(base, ""); }), "no such key"));
  EXPECT_TRUE(names(input_error([&] { value_of_key(base, "formats.span.h"); }), "formats.span.h."));
}

TEST(Keys, IllegalValuesNameTheKeyAndWhatIsLegal) {
  const Config base = shipped_config("depth16");
  const auto refused = [&](const Settings& settings) {
    return input_error([&] { with_keys(base, settings); });
  };
  EXPECT_TRUE(names(refused({{"depth.bits", integer(99)}}), "depth.bits: is 99; legal: 8..32"));
  EXPECT_TRUE(names(refused({{"depth.bits", 16.0}}), "depth.bits: is a float; legal: an integer"));
  EXPECT_TRUE(names(refused({{"depth.bits", true}}), "depth.bits: is a boolean"));
  EXPECT_TRUE(names(refused({{"depth.bits", text("16")}}), "depth.bits: is a string"));
  EXPECT_TRUE(names(refused({{"reciprocal.pixel.kind", text("magic")}}),
                    "reciprocal.pixel.kind: \"magic\" is no value of this key; legal: restoring"));
  EXPECT_TRUE(names(refused({{"depth.bits", integer(16)}, {"depth.bits", integer(16)}}), "set twice"));
  EXPECT_TRUE(
      names(refused({{"start_offset.span_h", std::nan("")}}), "start_offset.span_h: is not a finite"));
  // A rule between keys names what was set.
  EXPECT_TRUE(
      names(refused({{"reciprocal.pixel.operand_bits", integer(9)}}),
            "reciprocal.pixel.index_bits: is 9 with operand_bits = 9; legal: index_bits < operand_bits "
            "(with reciprocal.pixel.operand_bits = 9)"));
  // No text of a value is read as TOML.
  EXPECT_TRUE(names(refused({{"depth.code", text("linear\"\nbits = 9 # \\")}}), "is no value of this key"));
  EXPECT_TRUE(names(refused({{"texture.transparent", text("[1, 2]")}}), "texture.transparent: is no colour"));
  EXPECT_TRUE(names(refused({{"texture.transparent", text("[1, 2, 3]\n[x]")}}), "is no colour"));
}

TEST(Keys, TextOfValues) {
  EXPECT_EQ(to_string(KeyValue(true)), "true");
  EXPECT_EQ(to_string(integer(-3)), "-3");
  EXPECT_EQ(to_string(KeyValue(0.5)), "0.5");
  EXPECT_EQ(to_string(KeyValue(2.0)), "2.0");
  EXPECT_EQ(to_string(KeyValue(1e300)), "1e+300");
  EXPECT_EQ(to_string(text("half_ulp")), "half_ulp");
}

}  // namespace
}  // namespace bitspan
