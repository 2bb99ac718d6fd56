// SPDX-License-Identifier: Apache-2.0
// A register that span walks along: a span's start where it is taken, then after each issue Q[format](register + step).
// The span has two steps, of which second_i chooses one per pixel.
module span_register #(
    parameter int AccW       = 8,
    parameter int AccFrac    = 0,
    parameter int AccSigned  = 1,
    parameter int AccRnd     = 0,
    parameter int AccOvf     = 0,
    parameter int StepW      = 8,
    parameter int StepFrac   = 0,
    parameter int StepSigned = 1
) (
    input  logic             clk_i,
    // Of the two take_i goes first.
    input  logic             take_i,
    input  logic             issue_i,
    input  logic [ AccW-1:0] start_i,
    input  logic [StepW-1:0] step0_i,
    input  logic [StepW-1:0] step1_i,
    input  logic             second_i,
    output logic [ AccW-1:0] q_o
);
  logic [AccW-1:0] next;
  logic [StepW-1:0] step0_q, step1_q;
  accumulate #(
      .AccW(AccW),
      .AccFrac(AccFrac),
      .AccSigned(AccSigned),
      .AccRnd(AccRnd),
      .AccOvf(AccOvf),
      .StepW(StepW),
      .StepFrac(StepFrac),
      .StepSigned(StepSigned)
  ) u_next (
      .acc_i(q_o),
      .step_i(second_i ? step1_q : step0_q),
      .q_o(next)
  );
  always_ff @(posedge clk_i) begin
    if (take_i) begin
      q_o <= start_i;
      step0_q <= step0_i;
      step1_q <= step1_i;
    end else if (issue_i) begin
      q_o <= next;
    end
  end
endmodule
