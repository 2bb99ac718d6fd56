// SPDX-License-Identifier: Apache-2.0
// A design under test with ports of its own: takes the registers of a span, and walks depth, texture coordinates times
// depth, and shades from pixel to pixel. It has no divider, and so no u and v. The accumulators saturate. Parameters are
// the words of formats, and by how many fraction bits a step has more than its accumulator. FLIP makes a bug: a wrong bit
// of the depth at x = 20.
module acme_walk #(
    parameter int HW = 34,
    parameter int HStepW = 38,
    parameter int FW = 42,
    parameter int FStepW = 42,
    parameter int AccW = 19,
    parameter int StepW = 24,
    parameter int ShadeW = 13,
    parameter int HShift = 0,
    parameter int FShift = 0,
    parameter int Shift = 0,
    parameter int FLIP = 0
) (
    input logic clk,
    input logic rst_n,
    // A span: first pixel, number of pixels, and start and step of each accumulator.
    input logic go,
    output logic idle,
    input logic [15:0] go_x,
    input logic [15:0] go_n,
    input logic [HW-1:0] go_h,
    input logic [HStepW-1:0] go_dh,
    input logic [FW-1:0] go_f[2],
    input logic [FStepW-1:0] go_df[2],
    input logic [4*AccW-1:0] go_c,   // red is leftmost
    input logic [4*StepW-1:0] go_dc,
    // A pixel.
    output logic pix,
    input logic pix_take,
    output logic pix_end,
    output logic [15:0] pix_x,
    output logic [63:0] pix_h,
    output logic [63:0] pix_f[2],
    output logic [4*ShadeW-1:0] pix_c
);
  logic [15:0] left;
  logic [HW-1:0] h;
  logic [HStepW-1:0] dh;
  logic [FW-1:0] f[2];
  logic [FStepW-1:0] df[2];
  logic [4*AccW-1:0] c;
  logic [4*StepW-1:0] dc;
  logic [HW-1:0] h_next;
  logic [FW-1:0] f_next[2];
  logic [4*AccW-1:0] c_next;
  logic next;
  assign next = pix && pix_take;
  assign idle = !pix || (pix_end && pix_take);
  assign pix_end = left == 16'd1;
  assign pix_h = 64'(h) ^ 64'(FLIP != 0 && pix_x == 16'd20);

  acme_add #(.AccW(HW), .StepW(HStepW), .Shift(HShift), .Signed(0)) u_h (.acc(h), .step(dh), .sum(h_next));
  for (genvar i = 0; i < 2; i++) begin : gen_f
    acme_add #(.AccW(FW), .StepW(FStepW), .Shift(FShift), .Signed(1)) u_f (.acc(f[i]), .step(df[i]), .sum(f_next[i]));
    assign pix_f[i] = 64'($signed(f[i]));
    always_ff @(posedge clk) begin
      if (go && idle) begin
        f[i] <= go_f[i];
        df[i] <= go_df[i];
      end else if (next) begin
        f[i] <= f_next[i];
      end
    end
  end
  for (genvar i = 0; i < 4; i++) begin : gen_c
    acme_add #(.AccW(AccW), .StepW(StepW), .Shift(Shift), .Signed(0)) u_c (
        .acc(c[AccW*i+:AccW]), .step(dc[StepW*i+:StepW]), .sum(c_next[AccW*i+:AccW]));
    assign pix_c[ShadeW*i+:ShadeW] = c[AccW*i+AccW-ShadeW+:ShadeW];
  end

  always_ff @(posedge clk) begin
    if (!rst_n) begin
      pix <= 1'b0;
    end else if (go && idle) begin
      pix <= 1'b1;
    end else if (next && pix_end) begin
      pix <= 1'b0;
    end
    if (go && idle) begin
      pix_x <= go_x;
      left <= go_n;
      h <= go_h;
      dh <= go_dh;
      c <= go_c;
      dc <= go_dc;
    end else if (next) begin
      pix_x <= pix_x + 16'd1;
      left <= left - 16'd1;
      h <= h_next;
      c <= c_next;
    end
  end
endmodule

// acc + step, truncated and saturated to acc's format. The step is signed.
module acme_add #(
    parameter int AccW = 8,
    parameter int StepW = 8,
    parameter int Shift = 0,
    parameter int Signed = 0
) (
    input logic [AccW-1:0] acc,
    input logic [StepW-1:0] step,
    output logic [AccW-1:0] sum
);
  localparam int Up = Shift < 0 ? -Shift : 0;
  localparam int Down = Shift > 0 ? Shift : 0;
  localparam int W = (AccW > StepW + Up ? AccW : StepW + Up) + 2;
  localparam logic signed [W-1:0] High = (W'(1) << (AccW - Signed)) - W'(1);
  localparam logic signed [W-1:0] Low = Signed != 0 ? -(W'(1) << (AccW - 1)) : '0;
  logic signed [W-1:0] a, s, t, limited;
  assign a = {{(W - AccW) {Signed != 0 && acc[AccW-1]}}, acc};
  assign s = $signed({{(W - StepW) {step[StepW-1]}}, step}) <<< Up >>> Down;
  assign t = a + s;
  assign limited = t > High ? High : t < Low ? Low : t;
  assign sum = limited[AccW-1:0];
  logic unused;
  assign unused = ^limited[W-1:AccW];
endmodule
