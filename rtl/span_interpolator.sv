// SPDX-License-Identifier: Apache-2.0
// span_setup followed by span: takes rows and delivers pixels. docs/rtl.md has the ports and the clocks.
module span_interpolator (
    input  logic clk_i,
    input  logic rst_ni,
    // Constant B of the depth code; stable while records are in flight.
    input  logic [bitspan_cfg_pkg::SetupBW-1:0] b_i,
    input  logic in_valid_i,
    output logic in_ready_o,
    // First pixel (major coordinate) and number of pixels, at least 1.
    input  logic [bitspan_cfg_pkg::PixelIndexW-1:0] x_first_i,
    input  logic [bitspan_cfg_pkg::PixelIndexW-1:0] count_i,
    // delta_f: the row's ends; ignored in const_depth_rows.
    input  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_l_i,
    input  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_r_i,
    input  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_l_i,
    input  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_r_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_l_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_r_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_l_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_r_i,
    // const_depth_rows: the plane row; ignored in delta_f.
    input  logic [bitspan_cfg_pkg::PhaseW-1:0] phase_i,
    input  logic [bitspan_cfg_pkg::PlaneKW-1:0] k_i,
    input  logic [bitspan_cfg_pkg::SpanHW-1:0] h_i,
    input  logic [bitspan_cfg_pkg::SpanFW-1:0] gu_i,
    input  logic [bitspan_cfg_pkg::SpanFW-1:0] gv_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step0_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step1_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step0_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step1_i,
    // One transfer per pixel. x is the major coordinate; step says that the digital line steps after this pixel.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_cfg_pkg::PixelIndexW-1:0] x_o,
    output logic step_o,
    output logic last_o,
    output logic [bitspan_cfg_pkg::SpanHW-1:0] h_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] fu_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] fv_o,
    output logic [bitspan_cfg_pkg::PixelRecipOutW-1:0] recip_m_o,
    output logic [bitspan_cfg_pkg::ExponentW-1:0] recip_e_o,
    output logic [bitspan_cfg_pkg::SpanUvW-1:0] u_o,
    output logic [bitspan_cfg_pkg::SpanUvW-1:0] v_o,
    // Tap: the span record, as span takes it.
    output logic span_take_o,
    output logic [bitspan_cfg_pkg::PixelIndexW-1:0] span_x_o,
    output logic [bitspan_cfg_pkg::PixelIndexW-1:0] span_count_o,
    output logic [bitspan_cfg_pkg::RowRecipOutW-1:0] span_recip_m_o,
    output logic [bitspan_cfg_pkg::ExponentW-1:0] span_recip_e_o,
    output logic [bitspan_cfg_pkg::PhaseW-1:0] span_phase_o,
    output logic [bitspan_cfg_pkg::SpanFDiffW-1:0] span_fu_diff_o,
    output logic [bitspan_cfg_pkg::SpanFDiffW-1:0] span_fv_diff_o,
    output logic [bitspan_cfg_pkg::SpanHW-1:0] span_h_o,
    output logic [bitspan_cfg_pkg::SpanHStepW-1:0] span_h_step_o,
    output logic [bitspan_cfg_pkg::EdgeUvW-1:0] span_u1_o,
    output logic [bitspan_cfg_pkg::EdgeUvW-1:0] span_v1_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] span_fu_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] span_fv_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] span_fu_step0_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] span_fu_step1_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] span_fv_step0_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] span_fv_step1_o
);
  logic res_valid, take;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] res_x;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] res_count;
  logic [bitspan_cfg_pkg::RowRecipOutW-1:0] res_recip_m;
  logic [bitspan_cfg_pkg::ExponentW-1:0] res_recip_e;
  logic [bitspan_cfg_pkg::PhaseW-1:0] res_phase;
  logic [bitspan_cfg_pkg::PlaneKW-1:0] res_k;
  logic [bitspan_cfg_pkg::SpanFDiffW-1:0] res_fu_diff;
  logic [bitspan_cfg_pkg::SpanFDiffW-1:0] res_fv_diff;
  logic [bitspan_cfg_pkg::SpanHW-1:0] res_h;
  logic [bitspan_cfg_pkg::SpanHStepW-1:0] res_h_step;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] res_u1;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] res_v1;
  logic [bitspan_cfg_pkg::TexAccW-1:0] res_fu;
  logic [bitspan_cfg_pkg::TexAccW-1:0] res_fv;
  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fu_step0;
  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fu_step1;
  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fv_step0;
  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fv_step1;

  span_setup u_span_setup (
      .clk_i,
      .rst_ni,
      .b_i,
      .in_valid_i,
      .in_ready_o,
      .x_first_i,
      .count_i,
      .x_l_i,
      .x_r_i,
      .h_l_i,
      .h_r_i,
      .u_l_i,
      .u_r_i,
      .v_l_i,
      .v_r_i,
      .phase_i,
      .k_i,
      .h_i,
      .gu_i,
      .gv_i,
      .gu_step0_i,
      .gu_step1_i,
      .gv_step0_i,
      .gv_step1_i,
      .res_valid_o(res_valid),
      .take_i(take),
      .res_x_o(res_x),
      .res_count_o(res_count),
      .res_recip_m_o(res_recip_m),
      .res_recip_e_o(res_recip_e),
      .res_phase_o(res_phase),
      .res_k_o(res_k),
      .res_fu_diff_o(res_fu_diff),
      .res_fv_diff_o(res_fv_diff),
      .res_h_o(res_h),
      .res_h_step_o(res_h_step),
      .res_u1_o(res_u1),
      .res_v1_o(res_v1),
      .res_fu_o(res_fu),
      .res_fv_o(res_fv),
      .res_fu_step0_o(res_fu_step0),
      .res_fu_step1_o(res_fu_step1),
      .res_fv_step0_o(res_fv_step0),
      .res_fv_step1_o(res_fv_step1)
  );

  span u_span (
      .clk_i,
      .rst_ni,
      .b_i,
      .res_valid_i(res_valid),
      .take_o(take),
      .res_x_i(res_x),
      .res_count_i(res_count),
      .res_phase_i(res_phase),
      .res_k_i(res_k),
      .res_h_i(res_h),
      .res_h_step_i(res_h_step),
      .res_u1_i(res_u1),
      .res_v1_i(res_v1),
      .res_fu_i(res_fu),
      .res_fv_i(res_fv),
      .res_fu_step0_i(res_fu_step0),
      .res_fu_step1_i(res_fu_step1),
      .res_fv_step0_i(res_fv_step0),
      .res_fv_step1_i(res_fv_step1),
      .out_valid_o,
      .out_ready_i,
      .x_o,
      .step_o,
      .last_o,
      .h_o,
      .fu_o,
      .fv_o,
      .recip_m_o,
      .recip_e_o,
      .u_o,
      .v_o
  );

  assign span_take_o = take;
  assign span_x_o = res_x;
  assign span_count_o = res_count;
  assign span_recip_m_o = res_recip_m;
  assign span_recip_e_o = res_recip_e;
  assign span_phase_o = res_phase;
  assign span_fu_diff_o = res_fu_diff;
  assign span_fv_diff_o = res_fv_diff;
  assign span_h_o = res_h;
  assign span_h_step_o = res_h_step;
  assign span_u1_o = res_u1;
  assign span_v1_o = res_v1;
  assign span_fu_o = res_fu;
  assign span_fv_o = res_fv;
  assign span_fu_step0_o = res_fu_step0;
  assign span_fu_step1_o = res_fu_step1;
  assign span_fv_step0_o = res_fv_step0;
  assign span_fv_step1_o = res_fv_step1;
endmodule
