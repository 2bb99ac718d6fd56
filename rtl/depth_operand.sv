// SPDX-License-Identifier: Apache-2.0
// h + B for a reciprocal or a divider: exact, and 0 where it is not positive, which stands for one ulp. Combinational.
module depth_operand #(
    parameter int HW      = 8,
    parameter int HFrac   = 0,
    parameter int HSigned = 0,
    parameter int BW      = 8,
    parameter int BFrac   = 0,
    parameter int BSigned = 0,
    // Of the sum, a sign included.
    parameter int SumW    = 10,
    parameter int SumFrac = 0
) (
    input  logic [  HW-1:0] h_i,
    input  logic [  BW-1:0] b_i,
    output logic [SumW-2:0] operand_o
);
  logic signed [HW:0] h;
  logic signed [BW:0] b;
  logic signed [SumW-1:0] sum;
  logic negative;
  assign h = $signed({(HSigned != 0) & h_i[HW-1], h_i});
  assign b = $signed({(BSigned != 0) & b_i[BW-1], b_i});
  assign sum = (SumW'(h) <<< (SumFrac - HFrac)) + (SumW'(b) <<< (SumFrac - BFrac));
  // No tool knows that two values without a sign have a sum without one.
  assign negative = (HSigned != 0 || BSigned != 0) && sum[SumW-1];
  assign operand_o = sum[SumW-2:0] & {(SumW - 1) {!negative}};
endmodule
