// SPDX-License-Identifier: Apache-2.0
// A bench in plain Verilog: rows from a .hex file into the design, its pixels into another .hex file.
`include "vectors.vh"

module bench;
  reg [`INPUT_SPAN_SETUP_BITS-1:0] rows[0:`INPUT_SPAN_SETUP_RECORDS-1];
  reg [`OUTPUT_SPAN_BITS-1:0] expected[0:`OUTPUT_SPAN_RECORDS-1];
  reg [`INPUT_SPAN_SETUP_BITS-1:0] row;
  reg [`OUTPUT_SPAN_BITS-1:0] pixel, wanted;
  reg clk = 0, rst = 1;
  integer answers, next = 0, pixels = 0, wrong = 0, idle = 0;

  wire row_ready, pixel_valid, pixel_last;
  wire [31:0] pixel_triangle, pixel_x, pixel_y;
  pixel_counter dut (
      .clk(clk),
      .rst(rst),
      .row_valid(!rst && next < `INPUT_SPAN_SETUP_RECORDS),
      .row_ready(row_ready),
      .row_triangle(row[`INPUT_SPAN_SETUP_TRIANGLE]),
      .row_x(row[`INPUT_SPAN_SETUP_X]),
      .row_y(row[`INPUT_SPAN_SETUP_Y]),
      .row_count(row[`INPUT_SPAN_SETUP_COUNT]),
      .pixel_valid(pixel_valid),
      .pixel_triangle(pixel_triangle),
      .pixel_x(pixel_x),
      .pixel_y(pixel_y),
      .pixel_last(pixel_last)
  );

  initial begin
    $readmemh("span.vectors/input.span_setup.hex", rows);
    $readmemh("span.vectors/output.span.hex", expected);
    answers = $fopen("answers.hex", "w");
    row = rows[0];
    #12 rst = 0;
  end
  always #5 clk = !clk;

  always @(posedge clk) begin
    if (!rst && row_ready && next < `INPUT_SPAN_SETUP_RECORDS) begin
      next = next + 1;
      if (next < `INPUT_SPAN_SETUP_RECORDS) row <= rows[next];
    end
    if (!rst && pixel_valid) begin
      pixel = 0;  // the fields that the design does not have stay 0
      pixel[`OUTPUT_SPAN_TRIANGLE] = pixel_triangle;
      pixel[`OUTPUT_SPAN_X] = pixel_x;
      pixel[`OUTPUT_SPAN_Y] = pixel_y;
      pixel[`OUTPUT_SPAN_LAST] = {31'd0, pixel_last};
      $fdisplay(answers, "%h", pixel);
      wanted = expected[pixels];
      if (wanted[`OUTPUT_SPAN_X] !== pixel_x || wanted[`OUTPUT_SPAN_LAST] !== {31'd0, pixel_last}) begin
        wrong = wrong + 1;
      end
      pixels = pixels + 1;
    end
    idle = pixel_valid ? 0 : idle + 1;
    if (idle == 10) begin
      $display("%0d pixels, %0d wrong in x or last", pixels, wrong);
      $fclose(answers);
      $finish;
    end
  end
endmodule
