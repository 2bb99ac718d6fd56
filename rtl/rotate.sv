// SPDX-License-Identifier: Apache-2.0
// rotate of docs/numeric-spec.md: a vector turned by three products; one per clock.
//
//   quarters --> x - t y --> y + s x --> x - t y --> quarters --> skid --> out
//
// t and s are entries of the angle's tables with the sign of its rest, and the quarters stand in front of the products
// or behind them. The stage shifts as one on the ready of the skid at its end, which is a register.
module rotate #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_rotate_pkg::RotateXyW-1:0] in_x_i,
    input  logic [bitspan_rotate_pkg::RotateXyW-1:0] in_y_i,
    input  logic [bitspan_rotate_pkg::RotateTW-1:0] in_t_i,
    input  logic [bitspan_rotate_pkg::RotateSW-1:0] in_s_i,
    // Quarters of a turn, modulo 4, and whether they are behind the products.
    input  logic [1:0] in_quarter_i,
    input  logic in_behind_i,
    input  logic [RestW-1:0] in_rest_i,
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_rotate_pkg::RotateXyW-1:0] out_x_o,
    output logic [bitspan_rotate_pkg::RotateXyW-1:0] out_y_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int W = bitspan_rotate_pkg::RotateXyW;
  localparam int TW = bitspan_rotate_pkg::RotateTW;
  localparam int SW = bitspan_rotate_pkg::RotateSW;
  localparam int Lift = bitspan_rotate_pkg::RotateLiftClocks;
  localparam int Clocks = 3 * Lift + 2;

  logic en;
  assign en = in_ready_o;

  logic [W-1:0] first_x, first_y, x0_q, y0_q;
  logic [TW-1:0] t_q, t_last;
  logic [SW-1:0] s_q, s_middle;
  logic [1:0] quarter_q, quarter_last;
  rotate_quarter u_first (
      .x_i(in_x_i),
      .y_i(in_y_i),
      .quarter_i(in_behind_i ? 2'd0 : in_quarter_i),
      .x_o(first_x),
      .y_o(first_y)
  );
  always_ff @(posedge clk_i) begin
    if (en) begin
      x0_q <= first_x;
      y0_q <= first_y;
      t_q <= in_t_i;
      s_q <= in_s_i;
      quarter_q <= in_behind_i ? in_quarter_i : 2'd0;
    end
  end
  ring_line #(
      .Width(SW),
      .Depth(Lift)
  ) u_s_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(s_q),
      .q_o(s_middle)
  );
  ring_line #(
      .Width(TW),
      .Depth(2 * Lift)
  ) u_t_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(t_q),
      .q_o(t_last)
  );
  ring_line #(
      .Width(2),
      .Depth(3 * Lift)
  ) u_quarter_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(quarter_q),
      .q_o(quarter_last)
  );

  logic [W-1:0] x1, y0, x1_held, y1, x2, y1_held;
  rotate_lift #(
      .FactorW(TW),
      .FactorFrac(bitspan_rotate_pkg::RotateTFrac),
      .Minus(1)
  ) u_x1 (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .factor_i(t_q),
      .other_i(y0_q),
      .base_i(x0_q),
      .other_o(y0),
      .base_o(x1)
  );
  rotate_lift #(
      .FactorW(SW),
      .FactorFrac(bitspan_rotate_pkg::RotateSFrac)
  ) u_y1 (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .factor_i(s_middle),
      .other_i(x1),
      .base_i(y0),
      .other_o(x1_held),
      .base_o(y1)
  );
  rotate_lift #(
      .FactorW(TW),
      .FactorFrac(bitspan_rotate_pkg::RotateTFrac),
      .Minus(1)
  ) u_x2 (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .factor_i(t_last),
      .other_i(y1),
      .base_i(x1_held),
      .other_o(y1_held),
      .base_o(x2)
  );

  logic [W-1:0] last_x, last_y, x_q, y_q;
  rotate_quarter u_last (
      .x_i(x2),
      .y_i(y1_held),
      .quarter_i(quarter_last),
      .x_o(last_x),
      .y_o(last_y)
  );
  always_ff @(posedge clk_i) begin
    if (en) begin
      x_q <= last_x;
      y_q <= last_y;
    end
  end
  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(2 * W)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i({x_q, y_q}),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({out_x_o, out_y_o}),
      .out_rest_o
  );
endmodule
