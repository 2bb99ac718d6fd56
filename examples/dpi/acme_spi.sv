// SPDX-License-Identifier: Apache-2.0
// A design under test with ports of its own: lanes of 64 bits, sign-extended. Core 0 is the span interpolator of one
// configuration, and core 1 that of another. +flip makes a bug: a wrong bit of u at x = 20.
`define ACME_CORE(P) \
    logic signed [P``bitspan_cfg_pkg::TexAccW-1:0] fu, fv; \
    logic signed [P``bitspan_cfg_pkg::SpanUvW-1:0] u, v; \
    logic signed [P``bitspan_cfg_pkg::ExponentW-1:0] e; \
    logic [P``bitspan_cfg_pkg::PixelRecipOutW-1:0] m; \
    logic [P``bitspan_cfg_pkg::SpanHW-1:0] h; \
    logic [P``bitspan_cfg_pkg::PixelIndexW-1:0] x; \
    logic [4*P``bitspan_cfg_pkg::SpanShadeW-1:0] shade; \
    P``span_interpolator u_core ( \
        .clk_i(clk), .rst_ni(rst_n), .b_i(req_b[P``bitspan_cfg_pkg::SetupBW-1:0]), \
        .in_valid_i(req_vld), .in_ready_o(req_rdy), \
        .x_first_i(req_x[P``bitspan_cfg_pkg::PixelIndexW-1:0]), \
        .count_i(req_n[P``bitspan_cfg_pkg::PixelIndexW-1:0]), \
        .x_l_i(req_l[0][P``bitspan_cfg_pkg::EdgeXW-1:0]), .x_r_i(req_r[0][P``bitspan_cfg_pkg::EdgeXW-1:0]), \
        .h_l_i(req_l[1][P``bitspan_cfg_pkg::EdgeHW-1:0]), .h_r_i(req_r[1][P``bitspan_cfg_pkg::EdgeHW-1:0]), \
        .u_l_i(req_l[2][P``bitspan_cfg_pkg::EdgeUvW-1:0]), .u_r_i(req_r[2][P``bitspan_cfg_pkg::EdgeUvW-1:0]), \
        .v_l_i(req_l[3][P``bitspan_cfg_pkg::EdgeUvW-1:0]), .v_r_i(req_r[3][P``bitspan_cfg_pkg::EdgeUvW-1:0]), \
        .shade_l_i({req_l[7][P``bitspan_cfg_pkg::EdgeShadeW-1:0], req_l[6][P``bitspan_cfg_pkg::EdgeShadeW-1:0], \
                    req_l[5][P``bitspan_cfg_pkg::EdgeShadeW-1:0], req_l[4][P``bitspan_cfg_pkg::EdgeShadeW-1:0]}), \
        .shade_r_i({req_r[7][P``bitspan_cfg_pkg::EdgeShadeW-1:0], req_r[6][P``bitspan_cfg_pkg::EdgeShadeW-1:0], \
                    req_r[5][P``bitspan_cfg_pkg::EdgeShadeW-1:0], req_r[4][P``bitspan_cfg_pkg::EdgeShadeW-1:0]}), \
        .phase_i('0), .k_i('0), .h_i('0), .gu_i('0), .gv_i('0), .gu_step0_i('0), .gu_step1_i('0), \
        .gv_step0_i('0), .gv_step1_i('0), .shade_i('0), .shade_step0_i('0), .shade_step1_i('0), \
        .out_valid_o(pix_vld), .out_ready_i(pix_rdy), .x_o(x), .last_o(pix_last), .h_o(h), .fu_o(fu), .fv_o(fv), \
        .recip_m_o(m), .recip_e_o(e), .u_o(u), .v_o(v), .shade_o(shade), \
        .step_o(), .span_take_o(), .span_x_o(), .span_count_o(), .span_recip_m_o(), .span_recip_e_o(), \
        .span_phase_o(), .span_fu_diff_o(), .span_fv_diff_o(), .span_h_o(), .span_h_step_o(), .span_u1_o(), \
        .span_v1_o(), .span_fu_o(), .span_fv_o(), .span_fu_step0_o(), .span_fu_step1_o(), .span_fv_step0_o(), \
        .span_fv_step1_o(), .span_shade_o(), .span_shade_step0_o(), .span_shade_step1_o()); \
    assign pix_x = 64'(x); \
    assign pix_h = 64'(h); \
    assign pix_fu = 64'(fu); \
    assign pix_fv = 64'(fv); \
    assign pix_m = 64'(m); \
    assign pix_e = 64'(e); \
    assign pix_u = 64'(u) ^ 64'(flip && x == 20); \
    assign pix_v = 64'(v); \
    for (genvar i = 0; i < 4; i++) begin : gen_shade \
      assign pix_rgba[64*(3-i)+:64] = 64'(shade[P``bitspan_cfg_pkg::SpanShadeW*i+:P``bitspan_cfg_pkg::SpanShadeW]); \
    end

module acme_spi #(
    parameter int Core = 0
) (
    input logic clk,
    input logic rst_n,
    // A row: first pixel, number of pixels, and x, h, u, v, r, g, b, a of both ends.
    input logic req_vld,
    output logic req_rdy,
    input logic [63:0] req_b,
    input logic [63:0] req_x,
    input logic [63:0] req_n,
    input logic [63:0] req_l[8],
    input logic [63:0] req_r[8],
    // A pixel; red is the leftmost lane of pix_rgba.
    output logic pix_vld,
    input logic pix_rdy,
    output logic pix_last,
    output logic [63:0] pix_x,
    output logic [63:0] pix_h,
    output logic [63:0] pix_fu,
    output logic [63:0] pix_fv,
    output logic [63:0] pix_m,
    output logic [63:0] pix_e,
    output logic [63:0] pix_u,
    output logic [63:0] pix_v,
    output logic [255:0] pix_rgba
);
  logic flip;
  initial flip = $test$plusargs("flip") != 0;
  if (Core == 0) begin : gen_near
    `ACME_CORE(near_)
  end else begin : gen_far
    `ACME_CORE(far_)
  end
endmodule
