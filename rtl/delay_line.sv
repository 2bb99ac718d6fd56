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
    // One vector: Verilator takes no loop over a long array here.
    logic [(Depth-1)*Width-1:0] line_q;
    always_ff @(posedge clk_i) begin
      if (en_i) {q_o, line_q} <= {line_q, d_i};
    end
  end
endmodule
