// SPDX-License-Identifier: Apache-2.0
// forward_difference of docs/numeric-spec.md: the points of a cubic by three adders, one point per clock.
//
//   start --> skid --> d0 d1 d2 d3 --> out
//                       ^ +  + +
//
// A curve of n steps gives n + 1 points, the first on the clock after the skid has the curve. The next curve follows
// without a gap. in_ready_o and the point come from registers.
module forward_difference #(
    parameter int StepsW = 16,
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    // The registers at a curve's first point, and how many steps follow; what it brings comes out beside each point.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_curve_pkg::CurveD0W-1:0] in_d0_i,
    input  logic [bitspan_curve_pkg::CurveD1W-1:0] in_d1_i,
    input  logic [bitspan_curve_pkg::CurveD2W-1:0] in_d2_i,
    input  logic [bitspan_curve_pkg::CurveD3W-1:0] in_d3_i,
    input  logic [StepsW-1:0] in_steps_i,
    input  logic [RestW-1:0] in_rest_i,
    // The registers at a point; the point itself is d0.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_curve_pkg::CurveD0W-1:0] out_d0_o,
    output logic [bitspan_curve_pkg::CurveD1W-1:0] out_d1_o,
    output logic [bitspan_curve_pkg::CurveD2W-1:0] out_d2_o,
    output logic [bitspan_curve_pkg::CurveD3W-1:0] out_d3_o,
    output logic out_last_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int D0W = bitspan_curve_pkg::CurveD0W;
  localparam int D1W = bitspan_curve_pkg::CurveD1W;
  localparam int D2W = bitspan_curve_pkg::CurveD2W;
  localparam int D3W = bitspan_curve_pkg::CurveD3W;

  logic next_valid, take;
  logic [D0W-1:0] next_d0, sum_d0;
  logic [D1W-1:0] next_d1, sum_d1;
  logic [D2W-1:0] next_d2, sum_d2;
  logic [D3W-1:0] next_d3;
  logic [StepsW-1:0] next_steps;
  logic [RestW-1:0] next_rest;
  skid #(
      .Width(D0W + D1W + D2W + D3W + StepsW + RestW)
  ) u_in_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_i({in_d0_i, in_d1_i, in_d2_i, in_d3_i, in_steps_i, in_rest_i}),
      .out_valid_o(next_valid),
      .out_ready_i(take),
      .out_o({next_d0, next_d1, next_d2, next_d3, next_steps, next_rest})
  );

  accumulate #(
      .AccW(D0W),
      .AccFrac(bitspan_curve_pkg::CurveD0Frac),
      .AccSigned(bitspan_curve_pkg::CurveD0Signed),
      .AccRnd(bitspan_curve_pkg::CurveD0Rnd),
      .AccOvf(bitspan_curve_pkg::CurveD0Ovf),
      .StepW(D1W),
      .StepFrac(bitspan_curve_pkg::CurveD1Frac),
      .StepSigned(bitspan_curve_pkg::CurveD1Signed)
  ) u_d0 (
      .acc_i (out_d0_o),
      .step_i(out_d1_o),
      .q_o   (sum_d0)
  );
  accumulate #(
      .AccW(D1W),
      .AccFrac(bitspan_curve_pkg::CurveD1Frac),
      .AccSigned(bitspan_curve_pkg::CurveD1Signed),
      .AccRnd(bitspan_curve_pkg::CurveD1Rnd),
      .AccOvf(bitspan_curve_pkg::CurveD1Ovf),
      .StepW(D2W),
      .StepFrac(bitspan_curve_pkg::CurveD2Frac),
      .StepSigned(bitspan_curve_pkg::CurveD2Signed)
  ) u_d1 (
      .acc_i (out_d1_o),
      .step_i(out_d2_o),
      .q_o   (sum_d1)
  );
  accumulate #(
      .AccW(D2W),
      .AccFrac(bitspan_curve_pkg::CurveD2Frac),
      .AccSigned(bitspan_curve_pkg::CurveD2Signed),
      .AccRnd(bitspan_curve_pkg::CurveD2Rnd),
      .AccOvf(bitspan_curve_pkg::CurveD2Ovf),
      .StepW(D3W),
      .StepFrac(bitspan_curve_pkg::CurveD3Frac),
      .StepSigned(bitspan_curve_pkg::CurveD3Signed)
  ) u_d2 (
      .acc_i (out_d2_o),
      .step_i(out_d3_o),
      .q_o   (sum_d2)
  );

  // Steps that follow the point.
  logic [StepsW-1:0] left_q;
  assign out_last_o = left_q == '0;
  assign take = !out_valid_o || (out_ready_i && out_last_o);
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) out_valid_o <= 1'b0;
    else if (take) out_valid_o <= next_valid;
  end
  always_ff @(posedge clk_i) begin
    if (take) begin
      out_d0_o <= next_d0;
      out_d1_o <= next_d1;
      out_d2_o <= next_d2;
      out_d3_o <= next_d3;
      left_q <= next_steps;
      out_rest_o <= next_rest;
    end else if (out_ready_i) begin
      out_d0_o <= sum_d0;
      out_d1_o <= sum_d1;
      out_d2_o <= sum_d2;
      left_q <= left_q - StepsW'(1);
    end
  end
endmodule
