// SPDX-License-Identifier: Apache-2.0
// Each rule between keys: the value just inside is accepted, the one just outside refused by the key's name.
#include "config/check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/config/support.hpp"

namespace bitspan {
namespace {

using F = FormatId;
using Change = std::function<void(Config&)>;

std::string violation_of(const Change& change, const std::string& base = "depth16") {
  static const Config depth16 = shipped_config("depth16");
  static const Config depth20 = shipped_config("depth20");
  Config c = base == "depth16" ? depth16 : depth20;
  change(c);
  const auto v = first_violation(c);
  const std::string error = error_of([&c] { check_config(c, "origin"); });
  EXPECT_EQ(error, v ? "origin: " + v->key + ": " + v->text : "");
  if (v) {
    EXPECT_NE(v->text.find("legal: "), std::string::npos) << v->text;
  }
  return v ? v->key : "";
}

void expect_range(const std::string& key, int lowest, int highest,
                  const std::function<void(Config&, int)>& set, const std::string& base = "depth20") {
  for (const int value : {lowest, highest}) {
    EXPECT_EQ(violation_of([&](Config& c) { set(c, value); }, base), "") << key << " = " << value;
  }
  for (const int value : {lowest - 1, highest + 1}) {
    EXPECT_EQ(violation_of([&](Config& c) { set(c, value); }, base), key) << value;
  }
}

TEST(Check, RangesOfPlainKeys) {
  expect_range("raster.subpixel_bits", 0, 12, [](Config& c, int v) { c.subpixel_bits = v; });
  expect_range("raster.coordinate_bits", 2, 24, [](Config& c, int v) { c.coordinate_bits = v; });
  expect_range("depth.bits", 8, 32, [](Config& c, int v) { c.depth_bits = v; });
  expect_range("fog.depth_bits", 1, 8, [](Config& c, int v) {
    c.depth_bits = 8;
    c.fog_depth_bits = v;
  });
  expect_range("fog.depth_bits", 1, 12, [](Config& c, int v) {
    c.fog_depth_bits = v;
    c.fog_zone_bits = 0;
  });
  expect_range("fog.zone_bits", 0, 6, [](Config& c, int v) { c.fog_zone_bits = v; });
  expect_range("fog.zone_bits", 0, 8, [](Config& c, int v) {
    c.fog_depth_bits = 2;
    c.fog_zone_bits = v;
  });
  expect_range("reciprocal.pixel.operand_bits", 7, 60, [](Config& c, int v) {
    c.pixel_reciprocal.operand_bits = v;
    if (v < 7) c.pixel_reciprocal.operand_bits = 1;
  });
  expect_range("reciprocal.pixel.index_bits", 1, 12,
               [](Config& c, int v) { c.pixel_reciprocal.index_bits = v; });
  expect_range("reciprocal.pixel.table_bits", 2, 40,
               [](Config& c, int v) { c.pixel_reciprocal.table_bits = v; });
  expect_range("reciprocal.pixel.internal_bits", 2, 60,
               [](Config& c, int v) { c.pixel_reciprocal.internal_bits = v; });
  expect_range("reciprocal.row.steps", 0, 4, [](Config& c, int v) { c.row_reciprocal.steps = v; });
  expect_range("reciprocal.edge.bits_per_cycle", 1, 8,
               [](Config& c, int v) { c.edge_reciprocal.bits_per_cycle = v; });
  expect_range("memory.latency", 1, 10000, [](Config& c, int v) { c.memory.latency = v; });
  expect_range("memory.cache_ways", 1, 64, [](Config& c, int v) { c.memory.cache_ways = v; });
  expect_range("memory.width_bytes", 1, 64,
               [](Config& c, int v) { c.memory.width_bytes = v > 64 ? 2048 : v; });
  expect_range("memory.cache_line_bytes", 8, 4096, [](Config& c, int v) { c.memory.cache_line_bytes = v; });
  expect_range("memory.cache_sets", 1, 65536, [](Config& c, int v) { c.memory.cache_sets = v; });
  for (int i = 0; i < stage_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const std::string key = "timing." + std::string(to_string(static_cast<Stage>(i)));
    expect_range(key + ".latency", 1, 1000, [n](Config& c, int v) { c.timing[n].latency = v; });
    expect_range(key + ".interval", 1, 1000, [n](Config& c, int v) { c.timing[n].interval = v; });
    expect_range(key + ".fifo", 1, 65536, [n](Config& c, int v) { c.timing[n].fifo = v; });
  }
}

TEST(Check, PowersOfTwo) {
  EXPECT_EQ(violation_of([](Config& c) { c.memory.cache_sets = 48; }), "memory.cache_sets");
  EXPECT_EQ(violation_of([](Config& c) { c.memory.width_bytes = 6; }), "memory.width_bytes");
  EXPECT_EQ(violation_of([](Config& c) { c.memory.cache_line_bytes = 4; }), "memory.cache_line_bytes")
      << "less than the 8 bytes of a beat";
}

TEST(Check, FormatsOfEveryRegister) {
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<F>(i);
    const std::string key = "formats." + std::string(key_of(id));
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id).word = 0; }), key + ".word");
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id) = {64, 16, false}; }), key + ".word");
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id) = {65, 16, true}; }), key + ".word");
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id).integer = 65; }), key + ".int");
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id).integer = -33; }), key + ".int");
    EXPECT_EQ(violation_of([id](Config& c) {
                c.format(id).is_signed = false;
                c.format(id).overflow = Overflow::wrap_sm;
              }),
              key + ".overflow");
  }
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::span_f).overflow = Overflow::wrap_sm; }), "");
}

TEST(Check, FormatsWithAMeaning) {
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::merge_color).word = 9; }), "formats.merge.color");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::merge_color).is_signed = true; }),
            "formats.merge.color");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::texture_frac).integer = 1; }), "formats.texture.frac");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::texture_frac).is_signed = true; }),
            "formats.texture.frac");
  for (const F id : {F::texture_alpha, F::fog_factor}) {
    const std::string key = "formats." + std::string(key_of(id));
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id) = {8, 0, false}; }), key);
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id) = {8, 1, true}; }), key);
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id) = {1, 2, false}; }), key);
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id) = {8, 2, true}; }), "");
    EXPECT_EQ(violation_of([id](Config& c) { c.format(id) = {1, 1, false}; }), "");
  }
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::plane_k) = {20, 1, true}; }), "formats.plane.k");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::plane_k) = {20, 2, false}; }), "formats.plane.k");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::plane_k) = {2, 2, true}; }), "formats.plane.k");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::plane_k) = {3, 2, true}; }), "");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::edge_x) = {16, 16, true}; }), "formats.edge.x");
  EXPECT_EQ(violation_of([](Config& c) { c.format(F::edge_x) = {17, 16, true}; }), "");
  EXPECT_EQ(violation_of([](Config& c) { c.depth_overflow = Overflow::wrap_sm; }), "depth.overflow");
}

TEST(Check, ReciprocalUnits) {
  EXPECT_EQ(violation_of([](Config& c) { c.pixel_reciprocal.pipelined = false; }),
            "reciprocal.pixel.pipelined");
  EXPECT_EQ(violation_of([](Config& c) { c.row_reciprocal.pipelined = true; }), "");
  EXPECT_EQ(violation_of([](Config& c) { c.pixel_reciprocal.operand_bits = c.pixel_reciprocal.index_bits; }),
            "reciprocal.pixel.index_bits");
  EXPECT_EQ(
      violation_of([](Config& c) { c.pixel_reciprocal.operand_bits = c.pixel_reciprocal.index_bits + 1; }),
      "");
  EXPECT_EQ(violation_of([](Config& c) {
              c.row_reciprocal.output = {20, 1, true};
            }),
            "reciprocal.row.output.signed");
  EXPECT_EQ(violation_of([](Config& c) {
              c.row_reciprocal.output = {2, 2, false};
            }),
            "reciprocal.row.output");
  EXPECT_EQ(violation_of([](Config& c) {
              c.row_reciprocal.output = {64, 1, false};
            }),
            "reciprocal.row.output.word");
  // 1 must fit a normalised mantissa, or saturate to just below it.
  EXPECT_EQ(violation_of([](Config& c) {
              c.row_reciprocal.output = {16, 0, false, Rounding::rnd, Overflow::wrap, false};
            }),
            "reciprocal.row.output.int");
  EXPECT_EQ(violation_of([](Config& c) {
              c.row_reciprocal.output = {16, 0, false, Rounding::rnd, Overflow::sat, false};
            }),
            "");
  EXPECT_EQ(violation_of([](Config& c) {
              c.row_reciprocal.output = {16, -1, false, Rounding::rnd, Overflow::sat, false};
            }),
            "reciprocal.row.output.int");
  EXPECT_EQ(violation_of([](Config& c) {
              c.row_reciprocal.normalize = false;
              c.row_reciprocal.output = {16, -1, false, Rounding::rnd, Overflow::wrap, false};
            }),
            "");
  // Keys that the kind does not use may be 0, in the range of the others or not.
  EXPECT_EQ(violation_of([](Config& c) { c.row_reciprocal.operand_bits = 0; }), "");
  EXPECT_EQ(violation_of([](Config& c) { c.row_reciprocal.table_bits = 99; }), "reciprocal.row.table_bits");
}

TEST(Check, StartOffsetsAreMultiplesOfHalfAnUlp) {
  const struct {
    const char* key;
    StartOffset StartOffsets::*member;
    F accumulator;
    F kept;
    Perspective mode;
  } offsets[] = {
      {"edge_x", &StartOffsets::edge_x, F::edge_x_acc, F::edge_x, Perspective::delta_f},
      {"edge_h", &StartOffsets::edge_h, F::edge_h_acc, F::edge_h, Perspective::delta_f},
      {"edge_f", &StartOffsets::edge_f, F::edge_f, F::edge_f, Perspective::delta_f},
      {"edge_shade", &StartOffsets::edge_shade, F::edge_shade_acc, F::edge_shade, Perspective::delta_f},
      {"span_f", &StartOffsets::span_f, F::span_f, F::span_f, Perspective::delta_f},
      {"span_f", &StartOffsets::span_f, F::span_f, F::span_f, Perspective::hyperbolic},
      {"span_f", &StartOffsets::span_f, F::span_uv_acc, F::span_uv, Perspective::affine},
      {"span_f", &StartOffsets::span_f, F::span_uv_acc, F::span_uv, Perspective::const_depth_rows},
      {"span_shade", &StartOffsets::span_shade, F::span_shade_acc, F::span_shade, Perspective::delta_f},
  };
  for (const auto& o : offsets) {
    const std::string key = std::string("start_offset.") + o.key;
    const auto with = [&](double halves) {
      return violation_of([&](Config& c) {
        c.perspective = o.mode;
        c.start_offset.*o.member = {false, std::ldexp(halves, -c.format(o.accumulator).fraction() - 1)};
      });
    };
    EXPECT_EQ(with(1), "") << key;
    EXPECT_EQ(with(-3), "") << key;
    EXPECT_EQ(with(0.5), key);
    EXPECT_EQ(with(1e30), key) << "beyond the accumulator";
    EXPECT_EQ(with(std::numeric_limits<double>::quiet_NaN()), key);
    EXPECT_EQ(violation_of([&](Config& c) { c.start_offset.*o.member = {true, 1.0}; }), key);
    if (o.kept == o.accumulator) continue;
    EXPECT_EQ(violation_of([&](Config& c) {
                c.perspective = o.mode;
                c.start_offset.*o.member = {true, 0};
                c.format(o.kept).word += 40 - c.format(o.kept).fraction();
              }),
              key)
        << "half an ulp of a format finer than the accumulator";
  }
  EXPECT_EQ(violation_of([](Config& c) { c.start_offset.span_h = {true, 0}; }), "");
  EXPECT_EQ(violation_of([](Config& c) { c.start_offset.span_h = {false, 0x1p-20}; }), "start_offset.span_h");
}

TEST(Check, RandomConfigurationsGetAVerdict) {
  int legal = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto v = first_violation(any_config(static_cast<std::uint64_t>(i)));
    legal += v ? 0 : 1;
    if (v) {
      EXPECT_NE(v->text.find("legal: "), std::string::npos) << v->key << v->text;
    }
  }
  EXPECT_GT(legal, 1000);
  EXPECT_LT(legal, 3000);
}

}  // namespace
}  // namespace bitspan
