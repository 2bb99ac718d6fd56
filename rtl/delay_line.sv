// SPDX-License-Identifier: Apache-2.0
// q_o is d_i, Depth enabled clocks later; Depth 0 is a wire. There is no reset: the line carries data, and valid bits
// are kept elsewhere.
module delay_line #(
    parameter int Width = 8,
    parameter int Depth = 1
) (
    input  logic             clk_i,
    input  logic             en_i,
    input  logic [Width-1:0] d_i,
    output logic [Width-1:0] q_o
);
  if (Depth == 0) begin : gen_wire
    logic unused;
    assign unused = clk_i ^ en_i;
    assign q_o = d_i;
  end else begin : gen_line
    logic [Width-1:0] line_q[Depth];
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        line_q[0] <= d_i;
        for (int i = 1; i < Depth; i++) line_q[i] <= line_q[i-1];
      end
    end
    // Icarus 11 loses a continuous assignment here at times.
    always_comb q_o = line_q[Depth-1];
  end
endmodule
