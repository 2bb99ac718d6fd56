// SPDX-License-Identifier: Apache-2.0
// Restoring long division of unsigned integers, BitsPerCycle quotient bits per clock.
//
//   numerator: rem_i followed by the bits of num_i, rem_i < d_i; d_i > 0
//   q_o       = floor((rem_i 2^Bits + num_i) / d_i), Bits = Iterations * BitsPerCycle
//   sticky_o  = the remainder is not zero
//
// Latency: Iterations enabled clocks. With Pipelined, operands are taken on each of them. Otherwise start_i marks the
// clock of the operands, and the result stays until the next start.
module restoring_core #(
    parameter int DW           = 8,
    parameter int Iterations   = 8,
    parameter int BitsPerCycle = 1,
    parameter int Pipelined    = 1
) (
    input  logic                               clk_i,
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
    assign unused = start_i;
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
    localparam int CountW = $clog2(Iterations + 1);
    logic [StateW-1:0] state, next, state_q;
    logic [DW-1:0] d, d_q;
    logic [CountW-1:0] left_q;
    assign state = start_i ? {rem_i, num_i} : state_q;
    assign d = start_i ? d_i : d_q;
    restoring_step #(
        .DW(DW),
        .Bits(Bits),
        .Steps(BitsPerCycle)
    ) u_step (
        .state_i(state),
        .d_i(d),
        .state_o(next)
    );
    always_ff @(posedge clk_i) begin
      if (en_i && (start_i || left_q != '0)) begin
        state_q <= next;
        d_q <= d;
        left_q <= start_i ? CountW'(Iterations - 1) : left_q - CountW'(1);
      end
    end
    assign q_o = state_q[Bits-1:0];
    assign sticky_o = |state_q[StateW-1:Bits];
  end
endmodule
