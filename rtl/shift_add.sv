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

  // Clock 1: by multiples of 8. Above what the rest of the shift brings into KeptW bits, it is enough to know whether
  // all bits are signs.
  localparam int CoarseW = (AlignedW < KeptW + FineMax) ? AlignedW : KeptW + FineMax;
  localparam int Steps = ShiftMax >> FineW;
  logic [ShiftW-1:0] fine_q;
  logic signed [CoarseW-1:0] coarse_q;
  logic coarse_sticky_q, lost, above, above_q, negative_q;
  logic [AlignedW-1:0] differs;
  assign differs = aligned ^ {AlignedW{aligned[AlignedW-1]}};
  always_comb begin
    lost = 1'b0;
    above = 1'b0;
    for (int k = 0; k <= Steps; k++) begin
      for (int i = 0; i < AlignedW; i++) begin
        // Bits that the k-th step drops besides those of the steps before, and bits that stay above coarse_q.
        if (k > 0 && i >= ((k - 1) << FineW) && i < (k << FineW)) begin
          lost = lost | (aligned[i] & ((shift_i >> FineW) >= ShiftW'(k)));
        end
        if (i >= CoarseW + (k << FineW)) above = above | (differs[i] & ((shift_i >> FineW) == ShiftW'(k)));
      end
      if ((k << FineW) > AlignedW) lost = lost | (aligned[AlignedW-1] & ((shift_i >> FineW) >= ShiftW'(k)));
    end
  end
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      coarse_q <= CoarseW'(aligned >>> ((shift_i >> FineW) << FineW));
      fine_q <= shift_i & ShiftW'((1 << FineW) - 1);
      coarse_sticky_q <= dropped | lost;
      above_q <= above;
      negative_q <= aligned[AlignedW-1];
    end
  end

  // Clock 2: the rest; the bits above KeptW - 3 are all signs, or the value is far.
  logic signed [CoarseW+BelowW-1:0] fine;
  logic signed [KeptW-1:0] floor_q;
  logic sticky_q, far_q, sign_q;
  assign fine = $signed({coarse_q, {BelowW{1'b0}}}) >>> fine_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      floor_q <= KeptW'($signed(fine[CoarseW+BelowW-1:BelowW]));
      sticky_q <= coarse_sticky_q | (|fine[BelowW-1:0]);
      sign_q <= negative_q;
    end
  end
  if (CoarseW > KeptW - 4) begin : gen_far
    localparam int TopW = CoarseW - (KeptW - 4);
    logic [TopW-1:0] top;
    // Bit i of `top` counts where the rest of the shift leaves it at KeptW - 4 or above.
    always_comb begin
      top = coarse_q[CoarseW-1-:TopW] ^ {TopW{negative_q}};
      for (int i = 0; i < TopW; i++) begin
        if (ShiftW'(i) < fine_q && i < FineMax) top[i] = 1'b0;
      end
    end
    always_ff @(posedge clk_i) begin
      if (en_i) far_q <= above_q | (|top);
    end
  end else begin : gen_near
    logic unused;
    assign unused = above_q;
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
