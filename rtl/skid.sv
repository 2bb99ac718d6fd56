// SPDX-License-Identifier: Apache-2.0
// An elastic stage of two entries: out_valid_o, out_o and in_ready_o come from registers, so that no path leads from
// out_ready_i to what stands in front of it. It takes and delivers one record per clock.
//
// in_ready_o falls on the clock after the second entry was filled: a pipe in front of it may use it as its enable.
module skid #(
    parameter int Width = 8
) (
    input  logic             clk_i,
    input  logic             rst_ni,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [Width-1:0] in_i,
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic [Width-1:0] out_o
);
  // in_i waits in spare_q while out_o is not taken; then spare_q moves to out_o before anything else.
  logic [Width-1:0] spare_q;
  logic in, out;
  assign in = in_valid_i && in_ready_o;
  assign out = out_ready_i || !out_valid_o;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      in_ready_o <= 1'b1;
      out_valid_o <= 1'b0;
    end else if (out) begin
      in_ready_o <= 1'b1;
      out_valid_o <= in || !in_ready_o;
    end else if (in) begin
      in_ready_o <= 1'b0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (in) spare_q <= in_i;
    if (out) out_o <= in_ready_o ? in_i : spare_q;
  end
endmodule
