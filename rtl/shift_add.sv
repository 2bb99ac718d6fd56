// SPDX-License-Identifier: Apache-2.0
// floor(x_i 2^-(Base + shift_i)) + c_i in KeptW bits, three enabled clocks later, and what rounding it needs to know.
//
//   x_i       signed, InW bits
//   shift_i   0..ShiftMax places to the right, besides Base (Base < 0: places to the left)
//   c_i       signed, CW bits on the sum's grid, two clocks after x_i
//   sum_o     the low KeptW bits of the sum; all of it where far_o is 0
//   far_o     the shifted x_i does not fit KeptW - 3 bits: with KeptW >= CW + 4, c_i does not bring it back
//   sign_o    the sum is negative
//   sticky_o  bits other than 0 were shifted out: the exact value lies strictly between sum_o and sum_o + 1
//
//   clock  | shift by eights | the rest | add |
module shift_add #(
    parameter int InW      = 16,
    parameter int Base     = 0,
    parameter int ShiftMax = 0,
    parameter int ShiftW   = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1,
    parameter int CW       = 8,
    parameter int KeptW    = 16
) (
    input  logic                     clk_i,
    input  logic                     en_i,
    input  logic signed [   InW-1:0] x_i,
    input  logic        [ShiftW-1:0] shift_i,
    input  logic signed [    CW-1:0] c_i,
    output logic signed [ KeptW-1:0] sum_o,
    output logic                     sticky_o,
    output logic                     far_o,
    output logic                     sign_o
);
  localparam int Left = (Base < 0) ? -Base : 0;
  localparam int Right = (Base > 0) ? Base : 0;
  // x with Left zeros behind it, and at least one bit in front of what Base drops.
  localparam int WidthW = InW + Left;
  localparam int PlacedW = (WidthW > Right) ? WidthW : Right + 1;
  localparam int AlignedW = PlacedW - Right;
  localparam int FineW = (ShiftW > 3) ? 3 : ShiftW;
  localparam int FineMax = (ShiftMax > 7) ? 7 : ShiftMax;
  // After the coarse shift the fine one reaches down FineMax bits.
  localparam int BelowW = FineMax + 1;

  logic signed [PlacedW-1:0] placed;
  logic signed [AlignedW-1:0] aligned;
  logic dropped;
  assign placed = PlacedW'(x_i) <<< Left;
  assign aligned = placed[PlacedW-1:Right];
  if (Right > 0) begin : gen_dropped
    assign dropped = |placed[Right-1:0];
  end else begin : gen_none_dropped
    assign dropped = 1'b0;
  end

  // Clock 1: by multiples of 8.
  logic [ShiftW-1:0] coarse, fine_q;
  logic signed [AlignedW-1:0] coarse_q;
  logic coarse_sticky_q, lost;
  assign coarse = (shift_i >> FineW) << FineW;
  always_comb begin
    lost = 1'b0;
    for (int k = 1; k <= (ShiftMax >> FineW); k++) begin
      // Bits that the k-th step drops besides those of the steps before.
      for (int i = (k - 1) << FineW; i < (k << FineW) && i < AlignedW; i++) begin
        lost = lost | (aligned[i] & (coarse >= ShiftW'(k << FineW)));
      end
      if ((k << FineW) > AlignedW) lost = lost | (aligned[AlignedW-1] & (coarse >= ShiftW'(k << FineW)));
    end
  end
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      coarse_q <= aligned >>> coarse;
      fine_q <= shift_i & ShiftW'((1 << FineW) - 1);
      coarse_sticky_q <= dropped | lost;
    end
  end

  // Clock 2: the rest; the bits above KeptW - 3 are all signs, or the value is far.
  logic signed [AlignedW+BelowW-1:0] fine;
  logic signed [KeptW-1:0] floor_q;
  logic sticky_q, far_q, sign_q;
  assign fine = $signed({coarse_q, {BelowW{1'b0}}}) >>> fine_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      floor_q <= KeptW'($signed(fine[AlignedW+BelowW-1:BelowW]));
      sticky_q <= coarse_sticky_q | (|fine[BelowW-1:0]);
      sign_q <= coarse_q[AlignedW-1];
    end
  end
  if (AlignedW > KeptW - 3) begin : gen_far
    localparam int TopW = AlignedW - (KeptW - 4);
    logic [TopW-1:0] top;
    assign top = fine[AlignedW+BelowW-1-:TopW];
    always_ff @(posedge clk_i) begin
      if (en_i) far_q <= !(&top || !(|top));
    end
  end else begin : gen_near
    assign far_q = 1'b0;
  end

  // Clock 3: the sum.
  logic signed [KeptW-1:0] sum;
  assign sum = floor_q + KeptW'(c_i);
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      sum_o <= sum;
      sticky_o <= sticky_q;
      far_o <= far_q;
      sign_o <= far_q ? sign_q : sum[KeptW-1];
    end
  end

`ifndef SYNTHESIS
  initial begin
    assert (KeptW >= CW + 4)
    else $fatal(1, "shift_add: KeptW %0d leaves no room above CW %0d", KeptW, CW);
  end
`endif
endmodule
