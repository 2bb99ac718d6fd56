// SPDX-License-Identifier: Apache-2.0
// rtl/lzc_norm.sv and lzc.sv: n = d 2^zeros, and its top bit is set where d is not 0; lzc counts Width zeros where it
// is. The registers begin with any values, and en_i may fall at any time.
module lzc_norm_proof #(
    parameter int Width  = 12,
    parameter int Clocks = 2
) (
    input logic             clk_i,
    input logic             en_i,
    input logic [Width-1:0] d_i
);
  localparam int CountW = $clog2(Width + 1);
  logic [Width-1:0] n, d;
  logic [CountW-1:0] zeros;
  lzc_norm #(
      .Width(Width),
      .Clocks(Clocks)
  ) u_norm (
      .clk_i,
      .en_i,
      .d_i,
      .n_o(n),
      .zeros_o(zeros)
  );
  delay_line #(
      .Width(Width),
      .Depth(Clocks)
  ) u_operand (
      .clk_i,
      .en_i,
      .d_i,
      .q_o(d)
  );
  logic [1:0] filled_q;
  initial filled_q = '0;
  always_ff @(posedge clk_i) begin
    if (en_i && filled_q != 2'(Clocks)) filled_q <= filled_q + 2'd1;
  end
  always_comb begin
    if (filled_q == 2'(Clocks)) begin
      assert (n[Width-1] || (d == '0 && zeros == CountW'(Width)));
      assert ({{Width{1'b0}}, n} == ({{Width{1'b0}}, d} << zeros));
    end
  end
endmodule
