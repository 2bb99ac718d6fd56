// SPDX-License-Identifier: Apache-2.0
// Restoring long division of unsigned integers, BitsPerCycle quotient bits per clock.
//
//   numerator: rem_i followed by the bits of num_i, rem_i < d_i; d_i > 0
//   q_o       = floor((rem_i 2^Bits + num_i) / d_i), Bits = Iterations * BitsPerCycle
//   sticky_o  = the remainder is not zero
//
// Pipelined, each of Iterations stages makes BitsPerCycle bits; operands are taken on each enabled clock, and the
// latency is Iterations. Otherwise BitsPerCycle units stand in a row, each of which makes Iterations bits, one per clock,
// after a clock in which it takes over. start_i marks the clock of the operands, at most one per Iterations + 1; the
// latency is BitsPerCycle (Iterations + 1), and the result stays as long.
module restoring_core #(
    parameter int DW           = 8,
    parameter int Iterations   = 8,
    parameter int BitsPerCycle = 1,
    parameter int Pipelined    = 1
) (
    input  logic                               clk_i,
    input  logic                               rst_ni,
    input  logic                               en_i,
    input  logic                               start_i,
    input  logic [                     DW-1:0] rem_i,
    input  logic [Iterations*BitsPerCycle-1:0] num_i,
    input  logic [                     DW-1:0] d_i,
    output logic [Iterations*BitsPerCycle-1:0] q_o,
    output logic                               sticky_o
);
  localparam int Bits = Iterations * BitsPerCycle;
  // Numerator bits leave on the left of the register that quotient bits enter on the right.
  //   state: {rem [DW-1:0], num|q [Bits-1:0]}
  localparam int StateW = DW + Bits;

  if (Pipelined != 0) begin : gen_pipelined
    logic [StateW-1:0] state[Iterations+1];
    logic [DW-1:0] d[Iterations+1];
    logic unused;
    assign unused = start_i ^ rst_ni;
    assign state[0] = {rem_i, num_i};
    assign d[0] = d_i;
    for (genvar i = 0; i < Iterations; i++) begin : gen_stage
      logic [StateW-1:0] next, state_q;
      logic [DW-1:0] d_q;
      restoring_step #(
          .DW(DW),
          .Bits(Bits),
          .Steps(BitsPerCycle)
      ) u_step (
          .state_i(state[i]),
          .d_i(d[i]),
          .state_o(next)
      );
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          state_q <= next;
          d_q <= d[i];
        end
      end
      assign state[i+1] = state_q;
      assign d[i+1] = d_q;
    end
    logic unused_d;
    assign unused_d = ^d[Iterations];
    assign q_o = state[Iterations][Bits-1:0];
    assign sticky_o = |state[Iterations][StateW-1:Bits];
  end else begin : gen_iterative
    logic [StateW-1:0] state[BitsPerCycle+1];
    logic [DW-1:0] d[BitsPerCycle+1];
    logic [BitsPerCycle:0] start;
    assign state[0] = {rem_i, num_i};
    assign d[0] = d_i;
    assign start[0] = start_i;
    for (genvar i = 0; i < BitsPerCycle; i++) begin : gen_unit
      logic [StateW-1:0] next, state_q;
      logic [DW-1:0] d_q;
      logic [Iterations:0] started_q;
      restoring_step #(
          .DW(DW),
          .Bits(Bits),
          .Steps(1)
      ) u_step (
          .state_i(state_q),
          .d_i(d_q),
          .state_o(next)
      );
      always_ff @(posedge clk_i or negedge rst_ni) begin
        if (!rst_ni) started_q <= '0;
        else if (en_i) started_q <= {started_q[Iterations-1:0], start[i]};
      end
      // The last clock of started_q is the next unit's to take over. Masks make the choice, since constant operands
      // would become a synchronous reset beside an enable, which costs more.
      always_ff @(posedge clk_i) begin
        if (en_i && (start[i] || (|started_q[Iterations-1:0]))) begin
          state_q <= (state[i] & {StateW{start[i]}}) | (next & {StateW{!start[i]}});
        end
        if (en_i && start[i]) d_q <= d[i];
      end
      assign state[i+1] = state_q;
      assign d[i+1] = d_q;
      assign start[i+1] = started_q[Iterations];
    end
    logic unused;
    assign unused = (^d[BitsPerCycle]) ^ start[BitsPerCycle];
    assign q_o = state[BitsPerCycle][Bits-1:0];
    assign sticky_o = |state[BitsPerCycle][StateW-1:Bits];
  end
endmodule
