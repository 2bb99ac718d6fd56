// SPDX-License-Identifier: Apache-2.0
// A part of a design: from the first pixel and the length of a row to its pixels, one per clock.
module pixel_counter (
    input             clk,
    input             rst,
    input             row_valid,
    output            row_ready,
    input      [31:0] row_triangle,
    input      [31:0] row_x,
    input      [31:0] row_y,
    input      [31:0] row_count,
    output            pixel_valid,
    output reg [31:0] pixel_triangle,
    output reg [31:0] pixel_x,
    output reg [31:0] pixel_y,
    output            pixel_last
);
  reg [31:0] left;  // pixels of the row that have not been delivered

  assign row_ready = left <= 1;
  assign pixel_valid = left != 0;
`ifdef PLANTED_BUG
  assign pixel_last = left <= 2;
`else
  assign pixel_last = left == 1;
`endif

  always @(posedge clk) begin
    if (rst) begin
      left <= 0;
    end else if (row_valid && row_ready) begin
      left <= row_count;
      pixel_triangle <= row_triangle;
      pixel_x <= row_x;
      pixel_y <= row_y;
    end else if (left != 0) begin
      left <= left - 1;
      pixel_x <= pixel_x + 1;
    end
  end
endmodule
