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
  end else if (Depth == 1) begin : gen_register
    always_ff @(posedge clk_i) begin
      if (en_i) q_o <= d_i;
    end
  end else begin : gen_line
    // The last register is q_o itself: Icarus 11 may lose a continuous assignment from a word of an array.
    logic [Width-1:0] line_q[Depth-1];
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        line_q[0] <= d_i;
        for (int i = 1; i < Depth - 1; i++) line_q[i] <= line_q[i-1];
        q_o <= line_q[Depth-2];
      end
    end
  end
endmodule
