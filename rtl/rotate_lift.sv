// SPDX-License-Identifier: Apache-2.0
// One of the three steps of rotate: Q[rotate.xy](base -+ Q[rotate.xy](factor other)), RotateLiftClocks later. other,
// which stays as it is, comes out beside it.
module rotate_lift #(
    parameter int FactorW    = 8,
    parameter int FactorFrac = 0,
    parameter int Minus      = 0
) (
    input  logic                                   clk_i,
    input  logic                                   rst_ni,
    input  logic                                   en_i,
    input  logic [                    FactorW-1:0] factor_i,
    input  logic [bitspan_rotate_pkg::RotateXyW-1:0] other_i,
    input  logic [bitspan_rotate_pkg::RotateXyW-1:0] base_i,
    output logic [bitspan_rotate_pkg::RotateXyW-1:0] other_o,
    output logic [bitspan_rotate_pkg::RotateXyW-1:0] base_o
);
  localparam int W = bitspan_rotate_pkg::RotateXyW;
  localparam int Frac = bitspan_rotate_pkg::RotateXyFrac;
  localparam int Clocks = bitspan_rotate_pkg::RotateLiftClocks;
  logic [W-1:0] product, base, next;
  multiply_round #(
      .AW(FactorW),
      .AFrac(FactorFrac),
      .BW(W),
      .BFrac(Frac),
      .OutW(W),
      .OutFrac(Frac),
      .OutRnd(bitspan_rotate_pkg::RotateXyRnd),
      .OutOvf(bitspan_rotate_pkg::RotateXyOvf),
      .ProductClocks(bitspan_rotate_pkg::ProductClocks)
  ) u_product (
      .clk_i,
      .en_i,
      .a_i(factor_i),
      .b_i(other_i),
      .c_i(1'sd0),
      .e_i(1'sd0),
      .q_o(product)
  );
  ring_line #(
      .Width(W),
      .Depth(Clocks - 1)
  ) u_base_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(base_i),
      .q_o(base)
  );
  ring_line #(
      .Width(W),
      .Depth(Clocks)
  ) u_other_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(other_i),
      .q_o(other_o)
  );
  logic signed [W:0] left, right, sum;
  assign left = $signed({base[W-1], base});
  assign right = $signed({product[W-1], product});
  assign sum = (Minus != 0) ? left - right : left + right;
  quantize #(
      .InW(W + 1),
      .InFrac(Frac),
      .OutW(W),
      .OutFrac(Frac),
      .Rounding(bitspan_rotate_pkg::RotateXyRnd),
      .Overflow(bitspan_rotate_pkg::RotateXyOvf)
  ) u_quantize (
      .x_i(sum),
      .sticky_i(1'b0),
      .q_o(next)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) base_o <= next;
  end
endmodule
