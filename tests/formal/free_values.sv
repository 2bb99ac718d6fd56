// SPDX-License-Identifier: Apache-2.0
// What may differ at the beginning: two registers that are loaded alike, and two values that the solver chooses. Either
// assertion must be refuted, or Yosys has made one out of two.
module free_values_proof #(
    parameter int Chosen = 0
) (
    input logic clk_i,
    input logic en_i,
    input logic d_i
);
  (* anyconst *)logic a;
  (* anyconst *)logic b;
  logic c_q, d_q;
  always_ff @(posedge clk_i) begin
    if (en_i) c_q <= d_i;
    if (en_i) d_q <= d_i;
  end
  always_comb assert (Chosen != 0 ? a == b : c_q == d_q);
endmodule
