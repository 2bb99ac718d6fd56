// SPDX-License-Identifier: Apache-2.0
// Proofs of the cells, tests/formal, and bugs planted in each cell, which the solver must refute. Proofs that
// take more than a minute wait for $BITSPAN_LONG.
#include <gtest/gtest.h>

#include "tests/rtl/prove.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

// Induction proves what holds after few clocks; to show a bug takes more of them.
Proof refutable(Proof proof, int clocks) {
  proof.clocks = clocks;
  return proof;
}

Proof skid(int width) {
  return {
      .name = "skid", .cells = {"skid", "record_order"}, .parameters = {{"Width", width}}, .induction = 1};
}

Proof fifo(int depth, int width) {
  return {.name = "fifo",
          .cells = {"fifo", "record_order"},
          .parameters = {{"Width", width}, {"Depth", depth}},
          .induction = 1};
}

TEST(Formal, FreeValuesDiffer) {
  for (const int chosen : {0, 1}) {
    EXPECT_THROW(prove({.name = "free_values", .cells = {}, .parameters = {{"Chosen", chosen}}}),
                 std::logic_error)
        << chosen;
  }
}

TEST(Formal, Skid) {
  EXPECT_NO_THROW(prove(skid(1)));
  EXPECT_NO_THROW(prove(skid(8)));
}

TEST(Formal, SkidBugs) {
  constexpr PlantedBug bugs[] = {
      // A record is lost, doubled, overtaken, changed while it waits, or survives a reset.
      {"rtl/skid.sv", "out_valid_o <= in || !in_ready_o;", "out_valid_o <= in;"},
      {"rtl/skid.sv", "out_valid_o <= in || !in_ready_o;", "out_valid_o <= in || out_valid_o;"},
      {"rtl/skid.sv", "out_o <= in_ready_o ? in_i : spare_q;", "out_o <= in_valid_i ? in_i : spare_q;"},
      {"rtl/skid.sv", "if (out) out_o <=", "if (out || in) out_o <="},
      {"rtl/skid.sv", "out_valid_o <= 1'b0;", "out_valid_o <= 1'b1;"},
      {"rtl/skid.sv", "if (in) spare_q", "if (in_valid_i) spare_q"},
      {"rtl/skid.sv", "out_ready_i || !out_valid_o;", "out_ready_i;"},
  };
  expect_seen(bugs, [] { prove(refutable(skid(1), 8)); });
}

TEST(Formal, Fifo) {
  for (const int depth : {1, 2, 3, 8}) EXPECT_NO_THROW(prove(fifo(depth, 1))) << depth;
  EXPECT_NO_THROW(prove(fifo(3, 8)));
}

TEST(Formal, FifoBugs) {
  constexpr PlantedBug bugs[] = {
      {"rtl/fifo.sv", "count_q != CountW'(Depth - 1)", "count_q != CountW'(Depth)"},
      {"rtl/fifo.sv", "out_valid_o <= count_q != CountW'(1)", "out_valid_o <= count_q > CountW'(2)"},
      {"rtl/fifo.sv", "else if (out && !in)", "else if (out)"},
      {"rtl/fifo.sv", "(write_q == PlaceW'(Depth - 1))", "(write_q == PlaceW'(Depth))"},
      {"rtl/fifo.sv", "if (out) read_q <=", "if (out_ready_i) read_q <="},
      {"rtl/fifo.sv", "if (in) memory[write_q]", "if (in_valid_i) memory[write_q]"},
      {"rtl/fifo.sv", "count_q <= '0;\n        write_q <= '0;", "count_q <= '0;"},
  };
  expect_seen(bugs, [] { prove(refutable(fifo(3, 1), 9)); });
}

// A shape of multiply_round: all roundings and overflow modes at once.
using Parameters = std::vector<std::pair<std::string, int>>;
// The product's five clocks, and `stalled` more in which the enable may fall.
Proof multiply_round(Parameters parameters, int stalled = 0) {
  return {.name = "multiply_round",
          .cells = {"delay_line", "mul_pipe", "shift_add", "quantize_far", "quantize", "multiply_round"},
          .parameters = std::move(parameters),
          .first = 5,
          .clocks = 6 + stalled};
}
// The addend and the output are narrow, so that the shifted product may lie far outside of them.
const Parameters narrow_sum = {{"AW", 8},    {"AFrac", 0}, {"BW", 1},     {"CW", 2},
                               {"CFrac", 1}, {"OutW", 2},  {"OutFrac", 0}};
Parameters with(Parameters some, const Parameters& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

TEST(Formal, RoundingWithStalls) {
  EXPECT_NO_THROW(prove(multiply_round(
      {{"AW", 5}, {"AFrac", 0}, {"BW", 1}, {"CW", 2}, {"CFrac", 1}, {"EMax", 4}, {"OutW", 2}, {"OutFrac", 0}},
      2)));
}
TEST(Formal, RoundingOfSmallProducts) {
  EXPECT_NO_THROW(prove(multiply_round({{"AW", 5}, {"AFrac", 3}, {"BW", 2}, {"CW", 4}, {"EMax", 5}})));
}
TEST(Formal, RoundingOfFarValues) {
  EXPECT_NO_THROW(prove(multiply_round(with(narrow_sum, {{"EMin", -3}, {"EMax", 4}}))));
}
TEST(Formal, RoundingAfterShiftsByEights) {
  EXPECT_NO_THROW(prove(multiply_round({{"AW", 6}, {"AFrac", 0}, {"BW", 1}, {"CW", 4}, {"EMax", 12}})));
}
TEST(Formal, RoundingToUnsigned) {
  EXPECT_NO_THROW(prove(multiply_round(with(narrow_sum, {{"ASigned", 0}, {"OutSigned", 0}, {"EMax", 6}}))));
}
TEST(Formal, RoundingToOneBit) {
  EXPECT_NO_THROW(prove(multiply_round({{"AW", 8},
                                        {"AFrac", 0},
                                        {"BW", 1},
                                        {"CW", 2},
                                        {"CFrac", 1},
                                        {"OutW", 1},
                                        {"OutFrac", 0},
                                        {"EMax", 10}})));
}
TEST(Formal, RoundingOfWiderProducts) {
  if (!is_long_run()) GTEST_SKIP() << "minutes: BITSPAN_LONG asks for it";
  EXPECT_NO_THROW(prove(multiply_round({{"AW", 6}, {"AFrac", 3}, {"BW", 2}, {"CW", 4}, {"EMax", 6}})));
  EXPECT_NO_THROW(
      prove(multiply_round({{"AW", 6}, {"AFrac", 3}, {"BW", 1}, {"CW", 4}, {"EMin", -3}, {"EMax", 4}}, 1)));
}

TEST(Formal, RoundingBugsOfTheSum) {
  constexpr PlantedBug bugs[] = {
      {"rtl/shift_add.sv", "sticky_q <= coarse_sticky_q | (|fine[BelowW-1:0])",
       "sticky_q <= coarse_sticky_q"},
      {"rtl/shift_add.sv", "far_q <= above_q | (|top)", "far_q <= above_q"},
      {"rtl/shift_add.sv", "far_q ? sign_q : sum[KeptW-1]", "sum[KeptW-1]"},
      {"rtl/shift_add.sv", "coarse_sticky_q <= dropped | lost;", "coarse_sticky_q <= dropped;"},
  };
  expect_seen(bugs, [] { prove(multiply_round(with(narrow_sum, {{"EMax", 10}}))); });
}

TEST(Formal, RoundingBugs) {
  // quantize.sv stands on quantize_far.sv: its bugs without far_i are for quantize_test.
  constexpr PlantedBug bugs[] = {
      {"rtl/quantize_far.sv", "& ~lowest & ~far_i)", "& ~lowest)"},
      {"rtl/quantize_far.sv", "assign negative = far_i ? sign_i : rounded[RoundedW-1]",
       "assign negative = rounded[RoundedW-1]"},
      {"rtl/multiply_round.sv", ".sticky_i(sticky)", ".sticky_i(1'b0)"},
      {"rtl/multiply_round.sv", "RoomW + 4", "RoomW + 1"},
      {"rtl/multiply_round.sv", "(OutRnd == 0) ? 1 : 0", "(OutRnd == 5) ? 1 : 0"},
      {"rtl/multiply_round.sv", ".Depth(ProductClocks + 2)", ".Depth(ProductClocks + 1)"},
  };
  expect_seen(bugs, [] { prove(multiply_round(with(narrow_sum, {{"EMax", 10}}))); });
}

Proof restoring_core(int divisor_bits, int iterations, int bits_per_cycle, bool pipelined) {
  return {.name = "restoring_core",
          .cells = {"restoring_step", "restoring_core"},
          .parameters = {{"DW", divisor_bits},
                         {"Iterations", iterations},
                         {"BitsPerCycle", bits_per_cycle},
                         {"Pipelined", pipelined ? 1 : 0}},
          .induction = 1};
}

TEST(Formal, PipelinedDivision) {
  EXPECT_NO_THROW(prove(restoring_core(3, 3, 1, true)));
  EXPECT_NO_THROW(prove(restoring_core(3, 2, 2, true)));
}
TEST(Formal, IterativeDivision) {
  EXPECT_NO_THROW(prove(restoring_core(3, 3, 1, false)));
  EXPECT_NO_THROW(prove(restoring_core(3, 2, 2, false)));
}
TEST(Formal, WiderDivision) {
  EXPECT_NO_THROW(prove(restoring_core(5, 4, 1, true)));
  EXPECT_NO_THROW(prove(restoring_core(5, 4, 1, false)));
}

TEST(Formal, DivisionBugs) {
  constexpr PlantedBug step[] = {
      {"rtl/restoring_step.sv", "trial >= {1'b0, d_i}", "trial > {1'b0, d_i}"},
      {"rtl/restoring_step.sv", "logic [DW:0] trial;", "logic [DW-1:0] trial;"},
      {"rtl/restoring_step.sv", "Bits'({state, fits})", "Bits'({state, !fits})"},
  };
  expect_seen(step, [] { prove(refutable(restoring_core(3, 2, 2, true), 6)); });
  constexpr PlantedBug iterative[] = {
      {"rtl/restoring_core.sv", "start[i] || (|started_q[Iterations-1:0])",
       "start[i] || (|started_q[Iterations:0])"},
      {"rtl/restoring_core.sv", "if (en_i && start[i]) d_q <= d[i];", "if (start[i]) d_q <= d[i];"},
      {"rtl/restoring_core.sv", "start[i+1] = started_q[Iterations];",
       "start[i+1] = started_q[Iterations-1];"},
  };
  expect_seen(iterative, [] { prove(refutable(restoring_core(3, 2, 2, false), 10)); });
}

Proof lzc_norm(int width, int clocks) {
  return {.name = "lzc_norm",
          .cells = {"delay_line", "lzc", "lzc_norm"},
          .parameters = {{"Width", width}, {"Clocks", clocks}},
          .clocks = clocks + 3};
}

TEST(Formal, Normalisation) {
  EXPECT_NO_THROW(prove(lzc_norm(1, 1)));
  EXPECT_NO_THROW(prove(lzc_norm(7, 1)));
  EXPECT_NO_THROW(prove(lzc_norm(8, 2)));
  EXPECT_NO_THROW(prove(lzc_norm(19, 3)));
}

TEST(Formal, NormalisationBugs) {
  constexpr PlantedBug bugs[] = {
      {"rtl/lzc.sv", "count[2*n+1] | Levels'(1 << (level - 1))", "count[2*n+1]"},
      {"rtl/lzc.sv", "{(Padded - Width) {1'b1}}", "{(Padded - Width) {1'b0}}"},
      {"rtl/lzc_norm.sv", "zeros_2 & CountW'((1 << FineW) - 1)", "zeros_2 & CountW'((1 << FineW) - 2)"},
      {"rtl/lzc_norm.sv", "zeros_o <= zeros_2;", "zeros_o <= zeros_1;"},
  };
  expect_seen(bugs, [] { prove(lzc_norm(11, 3)); });
}

Proof scoreboard(int place_bits) {
  return {.name = "scoreboard",
          .cells = {"skid", "scoreboard"},
          .parameters = {{"PlaceW", place_bits}},
          .induction = 1};
}

TEST(Formal, Scoreboard) {
  EXPECT_NO_THROW(prove(scoreboard(1)));
  EXPECT_NO_THROW(prove(scoreboard(2)));
}

TEST(Formal, ScoreboardBugs) {
  expect_seen(scoreboard_bugs, [] { prove(refutable(scoreboard(1), 16)); });
}

}  // namespace
}  // namespace bitspan
