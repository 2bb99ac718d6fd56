// SPDX-License-Identifier: Apache-2.0
// One channel of the bilinear filter of docs/numeric-spec.md, "texture" (T3); 2 BlendClocks enabled clocks.
//
//   v1 --+-- V5 --+          V5 = Q(V1 (1 - Ex) + V4 Ex)
//   v4 --+  (ex)  +-- V      V6 = Q(V2 (1 - Ex) + V3 Ex)
//   v2 --+-- V6 --+ (ey)     V  = Q(V5 (1 - Ey) + V6 Ey)
//   v3 --+
//
// ey_i is that of the texels that came BlendClocks enabled clocks before. With ex = ey = 0, V = Q(V1).
module texture_filter #(
    parameter int InW         = 8,
    parameter int InFrac      = 0,
    parameter int InSigned    = 0,
    parameter int FracW       = 8,
    parameter int OutW        = 8,
    parameter int OutFrac     = 0,
    parameter int OutSigned   = 0,
    parameter int OutRnd      = 0,
    parameter int OutOvf      = 1,
    parameter int ProductClocks = 1,
    parameter int BlendClocks   = 4
) (
    input  logic             clk_i,
    input  logic             en_i,
    input  logic [  InW-1:0] v1_i,
    input  logic [  InW-1:0] v4_i,
    input  logic [  InW-1:0] v2_i,
    input  logic [  InW-1:0] v3_i,
    input  logic [FracW-1:0] ex_i,
    input  logic [FracW-1:0] ey_i,
    output logic [ OutW-1:0] v_o
);
  // V5 and V6.
  logic [2*OutW-1:0] row;
  for (genvar i = 0; i < 2; i++) begin : gen_row
    logic [InW-1:0] left, right;
    logic [OutW-1:0] row_q;
    assign left = (i == 0) ? v1_i : v2_i;
    assign right = (i == 0) ? v4_i : v3_i;
    blend #(
        .AW(InW),
        .AFrac(InFrac),
        .ASigned(InSigned),
        .BW(InW),
        .BFrac(InFrac),
        .BSigned(InSigned),
        .EW(FracW),
        .EFrac(FracW),
        .OutW(OutW),
        .OutFrac(OutFrac),
        .OutSigned(OutSigned),
        .OutRnd(OutRnd),
        .OutOvf(OutOvf),
        .ProductClocks(ProductClocks),
        .Clocks(BlendClocks)
    ) u_blend (
        .clk_i,
        .en_i,
        .a_i(left),
        .b_i(right),
        .e_i(ex_i),
        .q_o(row_q)
    );
    assign row[i*OutW+:OutW] = row_q;
  end
  blend #(
      .AW(OutW),
      .AFrac(OutFrac),
      .ASigned(OutSigned),
      .BW(OutW),
      .BFrac(OutFrac),
      .BSigned(OutSigned),
      .EW(FracW),
      .EFrac(FracW),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .OutRnd(OutRnd),
      .OutOvf(OutOvf),
      .ProductClocks(ProductClocks),
      .Clocks(BlendClocks)
  ) u_v (
      .clk_i,
      .en_i,
      .a_i(row[0+:OutW]),
      .b_i(row[OutW+:OutW]),
      .e_i(ey_i),
      .q_o(v_o)
  );
endmodule
