// SPDX-License-Identifier: Apache-2.0
// merge's arithmetic in every draw state of docs/numeric-spec.md: a fragment and what is stored at its pixel in, the new
// colour and alpha out; one fragment per clock.
//
// Four blend_equation side by side, and a skid. It shifts as one on the ready of the skid, which is a register.
module blend_unit #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    // The colour of fog, the alpha of texture, and the stored codes.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_pixel_pkg::FogColorW-1:0] in_r_i,
    input  logic [bitspan_pixel_pkg::FogColorW-1:0] in_g_i,
    input  logic [bitspan_pixel_pkg::FogColorW-1:0] in_b_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_a_i,
    input  logic [31:0] in_stored_i,
    input  logic [RestW-1:0] in_rest_i,
    // The draw state, taken with the fragment: factors and operations by their numbers; red in the lowest byte of the
    // constant colour; logic 0 for none.
    input  logic [3:0] in_src_i,
    input  logic [3:0] in_dst_i,
    input  logic [2:0] in_op_i,
    input  logic [3:0] in_alpha_src_i,
    input  logic [3:0] in_alpha_dst_i,
    input  logic [2:0] in_alpha_op_i,
    input  logic [31:0] in_constant_i,
    input  logic [4:0] in_logic_i,
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [7:0] out_r_o,
    output logic [7:0] out_g_o,
    output logic [7:0] out_b_o,
    output logic [7:0] out_a_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int ColorInW = bitspan_pixel_pkg::FogColorW;
  localparam int ProductClocks = bitspan_pixel_pkg::BlendProductClocks;
  localparam int Clocks = ProductClocks + 4;
  logic en;
  assign en = in_ready_o;

  // Alpha is channel 3.
  logic [4*ColorInW-1:0] src;
  logic [31:0] made;
  assign src = {{ColorInW{1'b0}}, in_b_i, in_g_i, in_r_i};
  for (genvar c = 0; c < 4; c++) begin : gen_channel
    logic [ColorInW-1:0] own;
    logic [7:0] stored, constant, q;
    logic [3:0] factor_src, factor_dst;
    logic [2:0] op;
    assign own = src[c*ColorInW+:ColorInW];
    assign stored = in_stored_i[8*c+:8];
    assign constant = in_constant_i[8*c+:8];
    assign factor_src = (c == 3) ? in_alpha_src_i : in_src_i;
    assign factor_dst = (c == 3) ? in_alpha_dst_i : in_dst_i;
    assign op = (c == 3) ? in_alpha_op_i : in_op_i;
    blend_equation #(
        .IsAlpha((c == 3) ? 1 : 0),
        .ProductClocks(ProductClocks),
        .Clocks(Clocks)
    ) u_equation (
        .clk_i,
        .en_i(en),
        .src_i(own),
        .a_i(in_a_i),
        .dst_i(stored),
        .dst_alpha_i(in_stored_i[31:24]),
        .factor_src_i(factor_src),
        .factor_dst_i(factor_dst),
        .op_i(op),
        .constant_i(constant),
        .constant_alpha_i(in_constant_i[31:24]),
        .logic_i(in_logic_i),
        .q_o(q)
    );
    assign made[8*c+:8] = q;
  end

  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(32)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i(made),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({out_a_o, out_b_o, out_g_o, out_r_o}),
      .out_rest_o
  );

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::BlendClocks)
    else $fatal(1, "blend_unit: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::BlendClocks);
  end
`endif
endmodule
