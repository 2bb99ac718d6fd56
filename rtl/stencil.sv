// SPDX-License-Identifier: Apache-2.0
// stencil of docs/numeric-spec.md: what the plane holds at a fragment's pixel in, its new value out; one per clock, two
// clocks and a skid later.
//
//   clocks  | compare | operation | out
//
// Which side of a triangle is seen is chosen in front of it. func: bit 0 passes where the reference is less than the
// stored value, bit 1 where it is equal, bit 2 where it is greater.
module stencil #(
    parameter int RestW = 32
) (
    input  logic             clk_i,
    input  logic             rst_ni,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [      7:0] in_stored_i,
    input  logic             in_z_pass_i,
    input  logic [RestW-1:0] in_rest_i,
    // The draw state, taken with the fragment.
    input  logic [      2:0] in_func_i,
    input  logic [      2:0] in_fail_i,
    input  logic [      2:0] in_zfail_i,
    input  logic [      2:0] in_pass_i,
    input  logic [      7:0] in_ref_i,
    input  logic [      7:0] in_mask_i,
    input  logic [      7:0] in_write_i,
    // op is the operation that was taken; go: both tests pass.
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic             out_pass_o,
    output logic [      2:0] out_op_o,
    output logic [      7:0] out_value_o,
    output logic             out_go_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int Clocks = 2;

  logic en;
  assign en = in_ready_o;

  // Clock 1.
  logic [7:0] own, other;
  logic pass;
  assign own = in_ref_i & in_mask_i;
  assign other = in_stored_i & in_mask_i;
  assign pass = (own < other && in_func_i[0]) || (own == other && in_func_i[1]) || (own > other && in_func_i[2]);
  logic pass_1, z_pass_1;
  logic [2:0] op_1;
  logic [7:0] stored_1, ref_1, write_1;
  always_ff @(posedge clk_i) begin
    if (en) begin
      pass_1 <= pass;
      z_pass_1 <= in_z_pass_i;
      op_1 <= !pass ? in_fail_i : in_z_pass_i ? in_pass_i : in_zfail_i;
      stored_1 <= in_stored_i;
      ref_1 <= in_ref_i;
      write_1 <= in_write_i;
    end
  end

  // Clock 2.
  logic [7:0] next, value_2;
  always_comb begin
    case (32'(op_1))
      bitspan_pixel_pkg::StencilOpZero: next = '0;
      bitspan_pixel_pkg::StencilOpReplace: next = ref_1;
      bitspan_pixel_pkg::StencilOpIncrement: next = (&stored_1) ? stored_1 : stored_1 + 8'd1;
      bitspan_pixel_pkg::StencilOpDecrement: next = (|stored_1) ? stored_1 - 8'd1 : stored_1;
      bitspan_pixel_pkg::StencilOpInvert: next = ~stored_1;
      bitspan_pixel_pkg::StencilOpIncrementWrap: next = stored_1 + 8'd1;
      bitspan_pixel_pkg::StencilOpDecrementWrap: next = stored_1 - 8'd1;
      default: next = stored_1;  // keep
    endcase
  end
  logic pass_2, go_2;
  logic [2:0] op_2;
  always_ff @(posedge clk_i) begin
    if (en) begin
      pass_2 <= pass_1;
      go_2 <= pass_1 && z_pass_1;
      op_2 <= op_1;
      value_2 <= (stored_1 & ~write_1) | (next & write_1);
    end
  end

  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(13)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i({pass_2, op_2, value_2, go_2}),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({out_pass_o, out_op_o, out_value_o, out_go_o}),
      .out_rest_o
  );

`ifndef SYNTHESIS
  initial begin
    assert (bitspan_pixel_pkg::StencilClocks == Clocks)
    else $fatal(1, "stencil: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::StencilClocks);
  end
`endif
endmodule
