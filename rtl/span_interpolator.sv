// SPDX-License-Identifier: Apache-2.0
// span_setup, a FIFO of span records, and span: takes rows and delivers pixels. docs/rtl.md has the ports and the
// clocks.
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
    // The row's ends; ignored in const_depth_rows. Shades are four side by side, red lowest, then green, blue, alpha;
    // without rtl.shades those of the inputs are ignored, and those of the outputs are 0. The channels stand above them.
    input  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_l_i,
    input  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_r_i,
    input  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_l_i,
    input  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_r_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_l_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_r_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_l_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_r_i,
    input  logic [bitspan_cfg_pkg::SidesEndW-1:0] shade_l_i,
    input  logic [bitspan_cfg_pkg::SidesEndW-1:0] shade_r_i,
    // const_depth_rows: the plane row; ignored in the other modes, but for the phase and the slope of a line, which
    // are 0 for the row of a triangle.
    input  logic [bitspan_cfg_pkg::PhaseW-1:0] phase_i,
    input  logic [bitspan_cfg_pkg::PlaneKW-1:0] k_i,
    input  logic [bitspan_cfg_pkg::SpanHW-1:0] h_i,
    input  logic [bitspan_cfg_pkg::SpanFW-1:0] gu_i,
    input  logic [bitspan_cfg_pkg::SpanFW-1:0] gv_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step0_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step1_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step0_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step1_i,
    input  logic [bitspan_cfg_pkg::SidesAccW-1:0] shade_i,
    input  logic [bitspan_cfg_pkg::SidesStepW-1:0] shade_step0_i,
    input  logic [bitspan_cfg_pkg::SidesStepW-1:0] shade_step1_i,
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
    output logic [bitspan_cfg_pkg::SidesW-1:0] shade_o,
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
    output logic [bitspan_cfg_pkg::TexStepW-1:0] span_fv_step1_o,
    output logic [bitspan_cfg_pkg::SidesAccW-1:0] span_shade_o,
    output logic [bitspan_cfg_pkg::SidesStepW-1:0] span_shade_step0_o,
    output logic [bitspan_cfg_pkg::SidesStepW-1:0] span_shade_step1_o
);
  localparam int RecordW = bitspan_cfg_pkg::SpanRecordW;
  logic setup_valid, setup_ready, res_valid, take;
  logic [RecordW-1:0] setup_record, record;
  logic [bitspan_cfg_pkg::PlaneKW-1:0] span_unused_k;

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
      .shade_l_i,
      .shade_r_i,
      .phase_i,
      .k_i,
      .h_i,
      .gu_i,
      .gv_i,
      .gu_step0_i,
      .gu_step1_i,
      .gv_step0_i,
      .gv_step1_i,
      .shade_i,
      .shade_step0_i,
      .shade_step1_i,
      .res_valid_o(setup_valid),
      .res_ready_i(setup_ready),
      .res_o(setup_record)
  );

  fifo #(
      .Width(RecordW),
      .Depth(bitspan_cfg_pkg::SpanFifo)
  ) u_records (
      .clk_i,
      .rst_ni,
      .in_valid_i(setup_valid),
      .in_ready_o(setup_ready),
      .in_i(setup_record),
      .out_valid_o(res_valid),
      .out_ready_i(take),
      .out_o(record)
  );

  span u_span (
      .clk_i,
      .rst_ni,
      .b_i,
      .res_valid_i(res_valid),
      .take_o(take),
      .res_i(record),
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
      .v_o,
      .shade_o
  );

  assign span_take_o = take;
  // The lines: h, fu and fv, and above them the shades and the channels. h has one step.
  localparam int AccW = bitspan_cfg_pkg::LinesAccW;
  localparam int StepW = bitspan_cfg_pkg::LinesStepW;
  logic [AccW-1:0] start;
  logic [StepW-1:0] step0;
  logic [bitspan_cfg_pkg::LinesStep1W-1:0] step1;
  assign {step1, step0, start, span_v1_o, span_u1_o, span_fv_diff_o, span_fu_diff_o, span_unused_k, span_phase_o,
          span_recip_m_o, span_recip_e_o, span_count_o, span_x_o} = record;
  localparam int PlainAccW = bitspan_cfg_pkg::SpanHW + 2 * bitspan_cfg_pkg::TexAccW;
  localparam int FStepW = 2 * bitspan_cfg_pkg::TexStepW;
  localparam int PlainStepW = bitspan_cfg_pkg::SpanHStepW + FStepW;
  assign {span_fv_o, span_fu_o, span_h_o} = start[PlainAccW-1:0];
  assign {span_fv_step0_o, span_fu_step0_o, span_h_step_o} = step0[PlainStepW-1:0];
  assign {span_fv_step1_o, span_fu_step1_o} = step1[FStepW-1:0];
  if (bitspan_cfg_pkg::Lines > 3) begin : gen_shades
    assign span_shade_o[bitspan_cfg_pkg::SidesAccW-1-:AccW-PlainAccW] = start[AccW-1:PlainAccW];
    assign span_shade_step0_o[bitspan_cfg_pkg::SidesStepW-1-:StepW-PlainStepW] = step0[StepW-1:PlainStepW];
    assign span_shade_step1_o[bitspan_cfg_pkg::SidesStepW-1-:StepW-PlainStepW] =
        step1[bitspan_cfg_pkg::LinesStep1W-1:FStepW];
  end
  if (bitspan_cfg_pkg::Shades == 0) begin : gen_no_shades
    assign span_shade_o[4*bitspan_cfg_pkg::SpanShadeAccW-1:0] = '0;
    assign span_shade_step0_o[4*bitspan_cfg_pkg::SpanShadeStepW-1:0] = '0;
    assign span_shade_step1_o[4*bitspan_cfg_pkg::SpanShadeStepW-1:0] = '0;
  end
  logic unused;
  assign unused = ^span_unused_k;
endmodule
