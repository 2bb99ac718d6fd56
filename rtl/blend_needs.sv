// SPDX-License-Identifier: Apache-2.0
// What the blend of a draw state needs of the picture, by docs/numeric-spec.md, merge; without a clock. pixel_pipe asks it
// once per draw state, by the registers of that state.
module blend_needs (
    // Factors and operations by their numbers; logic 0 for none.
    input  logic [3:0] src_i,
    input  logic [3:0] dst_i,
    input  logic [2:0] op_i,
    input  logic [3:0] alpha_src_i,
    input  logic [3:0] alpha_dst_i,
    input  logic [2:0] alpha_op_i,
    input  logic [4:0] logic_i,
    // What is made of a fragment depends on what is stored at its pixel: where its alpha is below 1, or wherever it is.
    output logic by_alpha_o,
    output logic reads_o,
    // The picture's alpha changes.
    output logic changes_alpha_o
);
  // min and max take the stored code without a factor. Without its lowest bit a factor and one minus it are the same.
  function automatic logic equation_reads(input logic [3:0] src, input logic [3:0] dst, input logic [2:0] op);
    equation_reads = 32'(op) == bitspan_pixel_pkg::BlendOpMin || 32'(op) == bitspan_pixel_pkg::BlendOpMax ||
                     32'(dst) != bitspan_pixel_pkg::BlendFactorZero ||
                     32'({src[3:1], 1'b0}) == bitspan_pixel_pkg::BlendFactorDstColor ||
                     32'({src[3:1], 1'b0}) == bitspan_pixel_pkg::BlendFactorDstAlpha ||
                     32'(src) == bitspan_pixel_pkg::BlendFactorSrcAlphaSaturate;
  endfunction

  logic keeps_alpha, mixes;
  logic [3:0] truth;
  assign keeps_alpha = logic_i == '0 && 32'(alpha_src_i) == bitspan_pixel_pkg::BlendFactorZero &&
                       32'(alpha_dst_i) == bitspan_pixel_pkg::BlendFactorOne &&
                       32'(alpha_op_i) == bitspan_pixel_pkg::BlendOpAdd;
  assign mixes = 32'(src_i) == bitspan_pixel_pkg::BlendFactorSrcAlpha &&
                 32'(dst_i) == bitspan_pixel_pkg::BlendFactorOneMinusSrcAlpha &&
                 32'(op_i) == bitspan_pixel_pkg::BlendOpAdd;
  // The truth table of blend_equation: the stored bit counts where the result differs for a fragment's 1, or for its 0.
  assign truth = 4'(logic_i - 5'd1);
  assign changes_alpha_o = !keeps_alpha;
  assign by_alpha_o = keeps_alpha && mixes;
  assign reads_o = (logic_i != '0) ? truth[0] != truth[1] || truth[2] != truth[3] :
                   (!mixes || !keeps_alpha) && equation_reads(src_i, dst_i, op_i) ||
                   !keeps_alpha && equation_reads(alpha_src_i, alpha_dst_i, alpha_op_i);
endmodule
