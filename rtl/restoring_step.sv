// SPDX-License-Identifier: Apache-2.0
// Forms `Steps` quotient bits of restoring_core, combinationally.
//
//   state: {remainder [DW-1:0], numerator | quotient [Bits-1:0]}, the remainder below d_i
module restoring_step #(
    parameter int DW    = 8,
    parameter int Bits  = 8,
    parameter int Steps = 1
) (
    input  logic [DW+Bits-1:0] state_i,
    input  logic [     DW-1:0] d_i,
    output logic [DW+Bits-1:0] state_o
);
  // The remainder with the next numerator bit, and what is left of it when the divisor fits. Casts cut here, not
  // part selects: Icarus 11 says "sorry" to the latter in always_comb.
  logic [DW:0] trial;
  logic [DW-1:0] left;
  logic fits;
  logic [DW+Bits-1:0] state;
  always_comb begin
    state = state_i;
    for (int i = 0; i < Steps; i++) begin
      trial = (DW + 1)'(state >> (Bits - 1));
      fits = trial >= {1'b0, d_i};
      left = DW'(fits ? trial - {1'b0, d_i} : trial);
      state = {left, Bits'({state, fits})};
    end
  end
  assign state_o = state;
endmodule
