// SPDX-License-Identifier: Apache-2.0
// n_o = d_i 2^zeros, its top bit set, and zeros_o, Clocks enabled clocks later. d_i is not 0.
//
//   Clocks 1  | count and shift                      |
//   Clocks 2  | count | shift                        |
//   Clocks 3  | count | shift by eights | the rest   |
module lzc_norm #(
    parameter int Width  = 8,
    parameter int Clocks = 2,
    parameter int CountW = $clog2(Width + 1)
) (
    input  logic              clk_i,
    input  logic              en_i,
    input  logic [ Width-1:0] d_i,
    output logic [ Width-1:0] n_o,
    output logic [CountW-1:0] zeros_o
);
  logic [CountW-1:0] zeros, zeros_1;
  logic [Width-1:0] d_1;
  lzc #(
      .Width(Width)
  ) u_lzc (
      .d_i,
      .zeros_o(zeros)
  );
  delay_line #(
      .Width(Width + CountW),
      .Depth(Clocks > 1 ? 1 : 0)
  ) u_counted (
      .clk_i,
      .en_i,
      .d_i({d_i, zeros}),
      .q_o({d_1, zeros_1})
  );
  localparam int FineW = (CountW > 3) ? 3 : CountW;
  logic [CountW-1:0] coarse, zeros_2, fine;
  logic [Width-1:0] d_2;
  assign coarse = (zeros_1 >> FineW) << FineW;
  delay_line #(
      .Width(Width + CountW),
      .Depth(Clocks > 2 ? 1 : 0)
  ) u_coarse (
      .clk_i,
      .en_i,
      .d_i({d_1 << coarse, zeros_1}),
      .q_o({d_2, zeros_2})
  );
  assign fine = zeros_2 & CountW'((1 << FineW) - 1);
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      n_o <= d_2 << fine;
      zeros_o <= zeros_2;
    end
  end

`ifndef SYNTHESIS
  initial begin
    assert (Clocks >= 1 && Clocks <= 3)
    else $fatal(1, "lzc_norm: Clocks must be 1 to 3, not %0d", Clocks);
  end
`endif
endmodule
