// SPDX-License-Identifier: Apache-2.0
// Q[format](acc + step): what an accumulator holds after one more step. acc and the result have the accumulator's
// format. Combinational.
module accumulate #(
    parameter int AccW       = 8,
    parameter int AccFrac    = 0,
    parameter int AccSigned  = 1,
    parameter int AccRnd     = 0,
    parameter int AccOvf     = 0,
    parameter int StepW      = 8,
    parameter int StepFrac   = 0,
    parameter int StepSigned = 1
) (
    input  logic [ AccW-1:0] acc_i,
    input  logic [StepW-1:0] step_i,
    output logic [ AccW-1:0] q_o
);
  localparam int Frac = (AccFrac > StepFrac) ? AccFrac : StepFrac;
  // Places left of the point, a sign's included.
  localparam int AccInt = AccW - AccFrac + (AccSigned != 0 ? 0 : 1);
  localparam int StepInt = StepW - StepFrac + (StepSigned != 0 ? 0 : 1);
  localparam int SumW = ((AccInt > StepInt) ? AccInt : StepInt) + 1 + Frac;
  logic signed [SumW-1:0] acc, step, sum;
  assign acc = SumW'($signed({(AccSigned != 0) & acc_i[AccW-1], acc_i})) <<< (Frac - AccFrac);
  assign step = SumW'($signed({(StepSigned != 0) & step_i[StepW-1], step_i})) <<< (Frac - StepFrac);
  assign sum = acc + step;
  quantize #(
      .InW(SumW),
      .InFrac(Frac),
      .OutW(AccW),
      .OutFrac(AccFrac),
      .OutSigned(AccSigned),
      .Rounding(AccRnd),
      .Overflow(AccOvf)
  ) u_quantize (
      .x_i(sum),
      .sticky_i(1'b0),
      .q_o
  );
endmodule
