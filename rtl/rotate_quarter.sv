// SPDX-License-Identifier: Apache-2.0
// A vector turned by quarters of a turn, 0 to 3 of them. Combinational.
module rotate_quarter (
    input  logic [bitspan_rotate_pkg::RotateXyW-1:0] x_i,
    input  logic [bitspan_rotate_pkg::RotateXyW-1:0] y_i,
    input  logic [                              1:0] quarter_i,
    output logic [bitspan_rotate_pkg::RotateXyW-1:0] x_o,
    output logic [bitspan_rotate_pkg::RotateXyW-1:0] y_o
);
  localparam int W = bitspan_rotate_pkg::RotateXyW;
  localparam int Frac = bitspan_rotate_pkg::RotateXyFrac;
  logic signed [W:0] x, y;
  logic [W-1:0] minus_x, minus_y;
  assign x = -$signed({x_i[W-1], x_i});
  assign y = -$signed({y_i[W-1], y_i});
  quantize #(
      .InW(W + 1),
      .InFrac(Frac),
      .OutW(W),
      .OutFrac(Frac),
      .Rounding(bitspan_rotate_pkg::RotateXyRnd),
      .Overflow(bitspan_rotate_pkg::RotateXyOvf)
  ) u_x (
      .x_i(x),
      .sticky_i(1'b0),
      .q_o(minus_x)
  );
  quantize #(
      .InW(W + 1),
      .InFrac(Frac),
      .OutW(W),
      .OutFrac(Frac),
      .Rounding(bitspan_rotate_pkg::RotateXyRnd),
      .Overflow(bitspan_rotate_pkg::RotateXyOvf)
  ) u_y (
      .x_i(y),
      .sticky_i(1'b0),
      .q_o(minus_y)
  );
  always_comb begin
    unique case (quarter_i)
      2'd0: {x_o, y_o} = {x_i, y_i};
      2'd1: {x_o, y_o} = {minus_y, x_i};
      2'd2: {x_o, y_o} = {minus_x, minus_y};
      default: {x_o, y_o} = {y_i, minus_x};
    endcase
  end
endmodule
