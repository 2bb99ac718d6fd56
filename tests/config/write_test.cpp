// SPDX-License-Identifier: Apache-2.0
// The canonical text reads back as the same configuration; the hash sees everything that determines results.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "config/check.hpp"
#include "tests/config/support.hpp"

namespace bitspan {
namespace {

TEST(Write, ShippedFilesRoundTrip) {
  for (const std::string& name : shipped_names) {
    const Config c = shipped_config(name);
    Config back = parse_config(to_toml(c), "canonical.toml");
    EXPECT_EQ(back.name, "canonical");
    back.name = c.name;
    EXPECT_EQ(back, c) << name;
    EXPECT_EQ(to_toml(back), to_toml(c));
  }
}

TEST(Write, RandomConfigurationsRoundTrip) {
  int legal = 0;
  for (int i = 0; i < 2000; ++i) {
    const Config c = any_config(static_cast<std::uint64_t>(i));
    if (first_violation(c)) {
      EXPECT_NE(parse_error_of(to_toml(c)), "");
      continue;
    }
    ++legal;
    const Config back = parse_config(to_toml(c), "random.toml");
    EXPECT_EQ(back, c) << to_toml(c);
    EXPECT_EQ(config_hash(back), config_hash(c));
  }
  EXPECT_GT(legal, 500);
}

TEST(Write, OffsetsRoundTripToTheLastBit) {
  Config c = shipped_config("depth16");
  c.format(FormatId::edge_x_acc) = {64, 0, true, Rounding::trn, Overflow::sat, true};
  for (const double value : {0x1.fffffffffffffp-2, -0x1.0000000000001p-12, 0x1p-65, 1.0, -0.25}) {
    c.start_offset.edge_x = {false, value};
    const Config back = parse_config(to_toml(c), "depth16");
    EXPECT_EQ(back.start_offset.edge_x.value, value);
    EXPECT_EQ(back, c);
  }
}

TEST(Write, TheHashIsTheSameOnEveryMachine) {
  // The hash of the built-in defaults, computed once; it changes with the canonical text, on purpose.
  const Config c;
  EXPECT_EQ(config_hash(c).size(), 16U);
  EXPECT_EQ(config_hash(c), "50fcfbff116739e6");
}

TEST(Write, TheHashLeavesOutTheNameAndUnusedKeys) {
  const Config c = shipped_config("depth16");
  Config d = c;
  d.name = "another";
  EXPECT_EQ(config_hash(d), config_hash(c));
  ASSERT_EQ(c.row_reciprocal.kind, ReciprocalKind::restoring);
  d.row_reciprocal.index_bits = 5;
  d.row_reciprocal.steps = 3;
  d.pixel_reciprocal.bits_per_cycle = 4;
  EXPECT_EQ(config_hash(d), config_hash(c));
  d.row_reciprocal.bits_per_cycle = 1;
  EXPECT_NE(config_hash(d), config_hash(c));
  d = c;
  d.fog_depth_bits = 7;
  d.fog_zone_bits = 3;
  EXPECT_NE(config_hash(d), config_hash(c));  // the fog is a table's
  d.fog = FogMode::linear;
  const std::string linear = config_hash(d);
  d.fog_depth_bits = 5;
  EXPECT_EQ(config_hash(d), linear);
}

TEST(Write, TheHashSeesEveryKey) {
  const Config c = shipped_config("depth20");
  const std::vector<std::string> lines = lines_of(to_toml(c));
  std::set<std::string> hashes{config_hash(c)};
  // Each integer of the text one higher, where that is legal; each boolean inverted.
  std::size_t changed = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto equals = lines[i].rfind(" = ");
    if (equals == std::string::npos || lines[i].starts_with('"')) continue;
    const std::string value = lines[i].substr(equals + 3);
    std::vector<std::string> other = lines;
    if (value == "true" || value == "false") {
      other[i] = lines[i].substr(0, equals + 3) + (value == "true" ? "false" : "true");
    } else if (value.find_first_not_of("0123456789") == std::string::npos) {
      const int step = std::stoi(value) > 1 ? std::stoi(value) : 1;  // keeps powers of two
      other[i] = lines[i].substr(0, equals + 3) + std::to_string(std::stoi(value) + step);
    } else {
      continue;
    }
    const std::string text = text_of(other);
    if (!parse_error_of(text).empty()) continue;
    const Config d = parse_config(text, "depth20");
    const bool unused = lines[i].starts_with("bits_per_cycle") && config_hash(d) == config_hash(c);
    const bool unused_lut = !unused && config_hash(d) == config_hash(c);
    if (unused) continue;
    if (unused_lut) {  // the edge unit is a restoring one
      EXPECT_EQ(d.row_reciprocal, c.row_reciprocal) << lines[i];
      EXPECT_EQ(d.pixel_reciprocal, c.pixel_reciprocal) << lines[i];
      EXPECT_NE(d.edge_reciprocal, c.edge_reciprocal) << lines[i];
      continue;
    }
    EXPECT_TRUE(hashes.insert(config_hash(d)).second) << lines[i];
    ++changed;
  }
  for (int i = 0; i < format_count; ++i) {
    Config d = c;
    Format& f = d.formats[static_cast<std::size_t>(i)];
    f.word += 1;
    EXPECT_TRUE(hashes.insert(config_hash(d)).second) << i;
    f = c.formats[static_cast<std::size_t>(i)];
    f.rounding = f.rounding == Rounding::rnd_conv ? Rounding::rnd_min_inf : Rounding::rnd_conv;
    EXPECT_TRUE(hashes.insert(config_hash(d)).second) << i;
    f = c.formats[static_cast<std::size_t>(i)];
    f.overflow = Overflow::wrap;
    EXPECT_TRUE(hashes.insert(config_hash(d)).second) << i;
  }
  EXPECT_GT(changed, 30U);
}

}  // namespace
}  // namespace bitspan
