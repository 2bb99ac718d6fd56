// SPDX-License-Identifier: Apache-2.0
// A value of a pixel of span: what d_i has at tick From of the pixel, q_o has at its tick To.
module span_delay #(
    parameter int Width    = 8,
    parameter int From     = 0,
    parameter int To       = 0,
    parameter int Interval = bitspan_cfg_pkg::PixelInterval,
    parameter int PhaseW   = (Interval > 1) ? $clog2(Interval) : 1
) (
    input  logic              clk_i,
    input  logic              en_i,
    // The tick modulo Interval.
    input  logic [PhaseW-1:0] phase_i,
    input  logic [ Width-1:0] d_i,
    output logic [ Width-1:0] q_o
);
  if (Interval == 1 || To == From) begin : gen_line
    delay_line #(
        .Width(Width),
        .Depth(To - From)
    ) u_line (
        .clk_i,
        .en_i,
        .d_i,
        .q_o
    );
    logic unused;
    assign unused = ^phase_i;
  end else begin : gen_hold
    localparam int Depth = (To - From - 1) / Interval + 1;
    logic [Depth*Width-1:0] held_q;
    row_hold #(
        .Width(Width),
        .Written(From + 1),
        .Last(To),
        .Interval(Interval)
    ) u_hold (
        .clk_i,
        .en_i,
        .phase_i,
        .d_i,
        .q_o(held_q)
    );
    assign q_o = held_q[(Depth-1)*Width+:Width];
    logic unused;
    assign unused = ^held_q;
  end
endmodule
