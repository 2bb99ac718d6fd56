// SPDX-License-Identifier: Apache-2.0
// The frame of a stage that shifts as one, a fragment per clock: a valid bit for each of its Clocks registers, what a
// fragment brings along, and the skid at its end. in_ready_o is the skid's, a register, and enables the stage.
module shift_stage #(
    parameter int Clocks = 2,
    parameter int RestW = 32,
    // Of what the stage makes.
    parameter int Width = 8
) (
    input  logic             clk_i,
    input  logic             rst_ni,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [RestW-1:0] in_rest_i,
    // Of the fragment that was accepted Clocks enabled clocks before.
    input  logic [Width-1:0] made_i,
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic [Width-1:0] out_made_o,
    output logic [RestW-1:0] out_rest_o
);
  logic en;
  logic [Clocks-1:0] valid_q;
  assign in_ready_o = en;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) valid_q <= '0;
    else if (en) valid_q <= {valid_q[Clocks-2:0], in_valid_i};
  end
  logic [RestW-1:0] rest;
  ring_line #(
      .Width(RestW),
      .Depth(Clocks)
  ) u_rest_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(in_rest_i),
      .q_o(rest)
  );
  skid #(
      .Width(Width + RestW)
  ) u_out_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i(valid_q[Clocks-1]),
      .in_ready_o(en),
      .in_i({made_i, rest}),
      .out_valid_o,
      .out_ready_i,
      .out_o({out_made_o, out_rest_o})
  );

`ifndef SYNTHESIS
  initial begin
    assert (Clocks >= 2)
    else $fatal(1, "shift_stage: Clocks must be 2 or more");
  end
`endif
endmodule
