// SPDX-License-Identifier: Apache-2.0
// A value of a row, held from tick Written to tick Last of its row, while rows follow one another every Interval ticks
// (of a pixel, where Interval is that of pixels). Place k of q_o (place 0 in its low bits) has the value of the row whose
// tick is from Written + k Interval to Written + (k + 1) Interval - 1: it is read at (tick - Written) / Interval.
module row_hold #(
    parameter int Width    = 8,
    parameter int Written  = 1,
    parameter int Last     = 1,
    parameter int Interval = bitspan_cfg_pkg::RowInterval,
    parameter int PhaseW   = (Interval > 1) ? $clog2(Interval) : 1,
    parameter int Depth    = (Last - Written) / Interval + 1
) (
    input  logic                   clk_i,
    input  logic                   en_i,
    // The tick modulo Interval.
    input  logic [     PhaseW-1:0] phase_i,
    // The value at tick Written - 1.
    input  logic [      Width-1:0] d_i,
    output logic [Depth*Width-1:0] q_o
);
  logic load;
  if (Interval == 1) begin : gen_each_tick
    assign load = en_i;
    logic unused;
    assign unused = ^phase_i;
  end else begin : gen_one_tick
    assign load = en_i && phase_i == PhaseW'((Written - 1) % Interval);
  end
  always_ff @(posedge clk_i) begin
    if (load) q_o <= (Depth * Width)'({q_o, d_i});
  end

`ifndef SYNTHESIS
  initial begin
    assert (Written >= 1 && Last >= Written)
    else $fatal(1, "row_hold: ticks %0d to %0d", Written, Last);
  end
`endif
endmodule
