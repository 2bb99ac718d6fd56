// SPDX-License-Identifier: Apache-2.0
// p_o = a_i b_i of signed factors, exact, Digits + 1 enabled clocks after start_i; the multiplier takes b in so many
// digits, one per clock. Factors stay from start_i on for Digits clocks, which is also how often one may start.
//
//   digit times a | sum of digits: Digits |
module mul_digits #(
    parameter int AW     = 18,
    parameter int BW     = 18,
    parameter int Digits = 2
) (
    input  logic             clk_i,
    input  logic             rst_ni,
    input  logic             en_i,
    input  logic             start_i,
    input  logic [   AW-1:0] a_i,
    input  logic [   BW-1:0] b_i,
    output logic [AW+BW-1:0] p_o
);
  localparam int W = (BW + Digits - 1) / Digits;
  localparam int LowW = (Digits - 1) * W;
  // at[j]: the j-th digit's clock. A product that a reset cut off must not meet the first one behind it. Digits but the
  // last are unsigned.
  logic [Digits-1:0] at;
  logic [Digits-2:0] at_q;
  assign at = {at_q, start_i};
  logic signed [Digits*W-1:0] b;
  logic [W-1:0] magnitude;
  logic signed [W:0] digit;
  assign b = (Digits * W)'($signed(b_i));
  always_comb begin
    magnitude = '0;
    for (int j = 0; j < Digits; j++) magnitude = magnitude | (b[j*W+:W] & {W{at[j]}});
  end
  assign digit = {at[Digits-1] & b[Digits*W-1], magnitude};

  // The digits so far times a, whose low bits are final: a digit fewer than those go to the places below.
  logic signed [AW+W-1:0] part_q, high_q, above, sum;
  logic [LowW-1:0] low_q, low;
  assign above = high_q >>> W;
  if (Digits > 2) begin : gen_lower
    assign low = {high_q[W-1:0], low_q[LowW-1:W]};
  end else begin : gen_low
    assign low = high_q[W-1:0];
  end
  assign sum = part_q + (above & {(AW + W) {!at_q[0]}});
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) at_q <= '0;
    else if (en_i) at_q <= (Digits - 1)'(at);
  end
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      part_q <= (AW + W)'($signed(a_i)) * (AW + W)'(digit);
      high_q <= sum;
      low_q <= low;
    end
  end
  assign p_o = (AW + BW)'({high_q, low_q});

`ifndef SYNTHESIS
  initial begin
    assert (Digits >= 2)
    else $fatal(1, "mul_digits: %0d digits", Digits);
  end
`endif
endmodule
