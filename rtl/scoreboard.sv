// SPDX-License-Identifier: Apache-2.0
// Which pixels are between the read and the write of a frame's memory.
//
// A pixel has one of 2^PlaceW places, found by its coordinates; a pixel whose place is taken waits until the place is
// free. Several pixels share a place, which costs clocks and never a value: a block of 16 x 16 pixels, or a row of
// 2^PlaceW, has each place once.
//
//   x_i, y_i       low bits of the pixel that wants to enter; busy_o tells on the same clock that its place is taken
//   enter_i        it enters; not while busy_o
//   mark_a_o, b    what it must bring along when it leaves by way a or way b
//   leave_a_i, b   a pixel leaves; its place is free from the next clock on. Without TwoWays there is way a alone
//   swept_o        0 for 2^PlaceW clocks after reset, while the memories are cleared; nothing may enter
//
// A place is taken where an odd number of its three bits is set. Each way writes one memory only.
module scoreboard #(
    parameter int PlaceW  = 8,
    parameter int TwoWays = 1
) (
    input  logic              clk_i,
    input  logic              rst_ni,
    input  logic [PlaceW-1:0] x_i,
    input  logic [PlaceW-1:0] y_i,
    input  logic              enter_i,
    output logic              busy_o,
    output logic              mark_a_o,
    output logic              mark_b_o,
    input  logic              leave_a_i,
    input  logic [PlaceW-1:0] leave_a_x_i,
    input  logic [PlaceW-1:0] leave_a_y_i,
    input  logic              leave_a_mark_i,
    input  logic              leave_b_i,
    input  logic [PlaceW-1:0] leave_b_x_i,
    input  logic [PlaceW-1:0] leave_b_y_i,
    input  logic              leave_b_mark_i,
    output logic              swept_o
);
  // y counts from the other end, so that neighbours in x and in y differ in other bits.
  function automatic logic [PlaceW-1:0] place_of(input logic [PlaceW-1:0] x, input logic [PlaceW-1:0] y);
    for (int i = 0; i < PlaceW; i++) place_of[i] = x[i] ^ y[PlaceW-1-i];
  endfunction

  localparam int Places = 1 << PlaceW;
  logic [PlaceW-1:0] place, place_a, place_b, sweep_q;
  assign place = place_of(x_i, y_i);
  assign place_a = swept_o ? place_of(leave_a_x_i, leave_a_y_i) : sweep_q;
  assign place_b = swept_o ? place_of(leave_b_x_i, leave_b_y_i) : sweep_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      swept_o <= 1'b0;
      sweep_q <= '0;
    end else if (!swept_o) begin
      swept_o <= &sweep_q;
      sweep_q <= sweep_q + PlaceW'(1);
    end
  end

  logic entered_bits[Places];
  logic left_a_bits[Places];
  logic entered, left_a, left_b;
  assign entered = entered_bits[place];
  assign left_a = left_a_bits[place];
  always_ff @(posedge clk_i) begin
    if (enter_i || !swept_o) entered_bits[swept_o ? place : sweep_q] <= swept_o & ~entered;
  end
  always_ff @(posedge clk_i) begin
    if (leave_a_i || !swept_o) left_a_bits[place_a] <= swept_o & leave_a_mark_i;
  end
  if (TwoWays != 0) begin : gen_b
    logic left_b_bits[Places];
    assign left_b = left_b_bits[place];
    always_ff @(posedge clk_i) begin
      if (leave_b_i || !swept_o) left_b_bits[place_b] <= swept_o & leave_b_mark_i;
    end
  end else begin : gen_no_b
    assign left_b = 1'b0;
    logic unused;
    assign unused = leave_b_i ^ leave_b_mark_i ^ (^place_b);
  end
  assign busy_o = entered ^ left_a ^ left_b;
  assign mark_a_o = ~left_a;
  assign mark_b_o = ~left_b;

`ifndef SYNTHESIS
  always @(posedge clk_i) begin
    if (enter_i) begin
      assert (swept_o && !busy_o)
      else $fatal(1, "scoreboard: a pixel enters a place that is taken");
    end
  end
`endif
endmodule
