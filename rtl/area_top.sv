// SPDX-License-Identifier: Apache-2.0
// Connects span_interpolator as the next stage uses it, for docs/area.md to count; this is not part of the design. The
// tap stays open, and so do the pixel's registers that only comparisons with the model read (fu, fv, the reciprocal),
// so that what nobody reads is not counted. The inputs of the other modes are 0. Shades and channels are connected where the
// package has some.
module area_top #(
    parameter int EndsW = 2 * bitspan_cfg_pkg::EdgeXW + 2 * bitspan_cfg_pkg::EdgeHW + 4 * bitspan_cfg_pkg::EdgeUvW,
    parameter int EndShadesW = 2 * bitspan_cfg_pkg::SidesEndW,
    parameter int PlaneW = bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + bitspan_cfg_pkg::SpanHW +
        2 * bitspan_cfg_pkg::SpanFW + 4 * bitspan_cfg_pkg::SpanFStepW,
    parameter int PlaneShadesW = bitspan_cfg_pkg::SidesAccW + 2 * bitspan_cfg_pkg::SidesStepW,
    // The phase and the slope of a line.
    parameter int LineW = (bitspan_cfg_pkg::DigitalLine != bitspan_cfg_pkg::ConstDepthRows) ?
        bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW : 0,
    parameter int RowW = (bitspan_cfg_pkg::ConstDepthRows != 0) ?
        PlaneW + ((bitspan_cfg_pkg::Lines > 3) ? PlaneShadesW : 0) :
        LineW + EndsW + ((bitspan_cfg_pkg::Lines > 3) ? EndShadesW : 0),
    // x, step, last, h, u, v, and the shades.
    parameter int PixelW = bitspan_cfg_pkg::PixelIndexW + 2 + bitspan_cfg_pkg::SpanHW + 2 * bitspan_cfg_pkg::SpanUvW +
        ((bitspan_cfg_pkg::Lines > 3) ? bitspan_cfg_pkg::SidesW : 0)
) (
    input  logic clk_i,
    input  logic rst_ni,
    input  logic [bitspan_cfg_pkg::SetupBW-1:0] b_i,
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_cfg_pkg::PixelIndexW-1:0] x_first_i,
    input  logic [bitspan_cfg_pkg::PixelIndexW-1:0] count_i,
    // The row's ends, or in const_depth_rows the plane row, with the shades above; on top what a line has.
    input  logic [RowW-1:0] row_i,
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [PixelW-1:0] pixel_o
);
  logic [EndShadesW+EndsW-1:0] ends;
  logic [PlaneShadesW+PlaneW-1:0] plane;
  assign ends = (bitspan_cfg_pkg::ConstDepthRows != 0) ? '0 : (EndShadesW + EndsW)'(row_i);
  assign plane = (bitspan_cfg_pkg::ConstDepthRows != 0) ? (PlaneShadesW + PlaneW)'(row_i) : '0;

  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_l, x_r;
  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_l, h_r;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_l, u_r, v_l, v_r;
  logic [bitspan_cfg_pkg::PhaseW-1:0] phase, plane_phase;
  logic [bitspan_cfg_pkg::PlaneKW-1:0] k, plane_k;
  logic [bitspan_cfg_pkg::SpanHW-1:0] h;
  logic [bitspan_cfg_pkg::SpanFW-1:0] gu, gv;
  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step0, gu_step1, gv_step0, gv_step1;
  logic [bitspan_cfg_pkg::SidesEndW-1:0] shade_l, shade_r;
  logic [bitspan_cfg_pkg::SidesAccW-1:0] shade;
  logic [bitspan_cfg_pkg::SidesStepW-1:0] shade_step0, shade_step1;
  assign {shade_l, shade_r, x_l, x_r, h_l, h_r, u_l, u_r, v_l, v_r} = ends;
  assign {shade, shade_step0, shade_step1, plane_phase, plane_k, h, gu, gv, gu_step0, gu_step1, gv_step0, gv_step1} = plane;
  if (LineW > 0) begin : gen_line
    assign {phase, k} = row_i[RowW-1-:LineW];
    logic unused;
    assign unused = ^{plane_phase, plane_k};
  end else begin : gen_no_line
    assign {phase, k} = {plane_phase, plane_k};
  end

  logic [bitspan_cfg_pkg::PixelIndexW-1:0] x;
  logic step, last;
  logic [bitspan_cfg_pkg::SpanHW-1:0] pixel_h;
  logic [bitspan_cfg_pkg::SpanUvW-1:0] u, v;
  logic [bitspan_cfg_pkg::SidesW-1:0] pixel_shade;
  assign pixel_o = PixelW'({pixel_shade, x, step, last, pixel_h, u, v});

  span_interpolator u_span_interpolator (
      .clk_i,
      .rst_ni,
      .b_i,
      .in_valid_i,
      .in_ready_o,
      .x_first_i,
      .count_i,
      .x_l_i(x_l),
      .x_r_i(x_r),
      .h_l_i(h_l),
      .h_r_i(h_r),
      .u_l_i(u_l),
      .u_r_i(u_r),
      .v_l_i(v_l),
      .v_r_i(v_r),
      .shade_l_i(shade_l),
      .shade_r_i(shade_r),
      .phase_i(phase),
      .k_i(k),
      .h_i(h),
      .gu_i(gu),
      .gv_i(gv),
      .gu_step0_i(gu_step0),
      .gu_step1_i(gu_step1),
      .gv_step0_i(gv_step0),
      .gv_step1_i(gv_step1),
      .shade_i(shade),
      .shade_step0_i(shade_step0),
      .shade_step1_i(shade_step1),
      .out_valid_o,
      .out_ready_i,
      .x_o(x),
      .step_o(step),
      .last_o(last),
      .h_o(pixel_h),
      .fu_o(),
      .fv_o(),
      .recip_m_o(),
      .recip_e_o(),
      .u_o(u),
      .v_o(v),
      .shade_o(pixel_shade),
      .span_take_o(),
      .span_x_o(),
      .span_count_o(),
      .span_recip_m_o(),
      .span_recip_e_o(),
      .span_phase_o(),
      .span_fu_diff_o(),
      .span_fv_diff_o(),
      .span_h_o(),
      .span_h_step_o(),
      .span_u1_o(),
      .span_v1_o(),
      .span_fu_o(),
      .span_fv_o(),
      .span_fu_step0_o(),
      .span_fu_step1_o(),
      .span_fv_step0_o(),
      .span_fv_step1_o(),
      .span_shade_o(),
      .span_shade_step0_o(),
      .span_shade_step1_o()
  );
endmodule
