// SPDX-License-Identifier: Apache-2.0
// RS of docs/numeric-spec.md, "Reciprocal square root": m_o 2^-e_o stands for 1 / sqrt(d_i 2^-DFrac), Clocks enabled
// clocks later. d_i is not 0. The unit takes an operand per clock.
//
//   normalise | table | Newton steps: n y, (n y) y, y (3 - n y y) / 2 | Q
//
// The operand is taken to n in [1, 4), by an even number of places, so that the root's exponent is whole.
module root #(
    parameter int DW = 16,
    parameter int DFrac = 8,
    parameter int OperandBits = 8,
    parameter int IndexBits = 4,
    parameter int TableBits = 8,
    parameter int InternalBits = 12,
    parameter int Steps = 1,
    parameter int OutW = 8,
    parameter int OutFrac = 7,
    parameter int OutSigned = 0,
    parameter int OutRnd = 0,
    parameter int OutOvf = 1,
    parameter int EW = 8,
    // Entry 0 in the low bits: n in [1, 2), then n in [2, 4).
    parameter logic [2*(1<<IndexBits)*(TableBits+1)-1:0] Table = '0,
    parameter int NormaliseClocks = 2,
    parameter int ProductClocks = 3,
    parameter int Clocks = 1
) (
    input  logic                   clk_i,
    input  logic                   rst_ni,
    input  logic                   en_i,
    input  logic        [  DW-1:0] d_i,
    output logic        [OutW-1:0] m_o,
    output logic signed [  EW-1:0] e_o
);
  localparam int StepClocks = 3 * ProductClocks + 1;
  localparam int CountW = $clog2(DW + 1);
  localparam int NW = OperandBits + 2;  // n below 4
  localparam int EntryW = TableBits + 1;
  localparam int Entries = 2 << IndexBits;

  logic [DW-1:0] normalised;
  logic [CountW-1:0] zeros;
  lzc_norm #(
      .Width (DW),
      .Clocks(NormaliseClocks)
  ) u_normalise (
      .clk_i,
      .en_i,
      .d_i,
      .n_o(normalised),
      .zeros_o(zeros)
  );
  // 2^top <= d. Its parity is the octave of n.
  logic signed [EW-1:0] top;
  logic odd;
  assign top = EW'(DW - 1 - DFrac) - EW'($signed({1'b0, zeros}));
  assign odd = top[0];
  // The leading one stands at place OperandBits + 1 in the upper octave, else one lower.
  logic [DW+OperandBits:0] cut;
  logic [NW-1:0] n_q;
  assign cut = {normalised, {(OperandBits + 1) {1'b0}}};
  logic [DW+IndexBits-1:0] behind_one;
  logic [IndexBits:0] index;
  assign behind_one = {normalised, {IndexBits{1'b0}}};
  assign index = {odd, behind_one[DW+IndexBits-2-:IndexBits]};
  logic [EntryW-1:0] rom[Entries];
  initial begin
    for (int i = 0; i < Entries; i++) rom[i] = Table[i*EntryW+:EntryW];
  end
  logic [EntryW-1:0] entry_q;
  logic signed [EW-1:0] e_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      n_q <= odd ? cut[DW-1+:NW] : {1'b0, cut[DW+:NW-1]};
      entry_q <= rom[index];
      e_q <= top >>> 1;
    end
  end
  logic unused;
  assign unused = ^{cut, behind_one};

  // y of each step; below 2, on TableBits fraction bits and then on InternalBits.
  localparam int YW = (TableBits > InternalBits) ? TableBits + 1 : InternalBits + 1;
  logic [YW-1:0] y[Steps+1];
  logic [NW-1:0] n[Steps+1];
  assign y[0] = YW'(entry_q);
  assign n[0] = n_q;
  for (genvar step = 0; step < Steps; step++) begin : gen_step
    localparam int YFrac = (step == 0) ? TableBits : InternalBits;
    localparam int YInW = YFrac + 1;
    localparam int InW = InternalBits + 3;  // n y and n y y, below 8
    logic [YInW-1:0] y_0, y_1, y_2;
    logic [NW+YInW-1:0] product_a;
    logic [InW+YInW-1:0] product_c;
    logic [YInW+InternalBits+1:0] product_y;
    logic [InW-1:0] a;
    logic [InternalBits+1:0] c, rest_q;
    assign y_0 = YInW'(y[step]);
    mul_pipe #(
        .AW(NW),
        .BW(YInW),
        .ASigned(0),
        .BSigned(0),
        .Clocks(ProductClocks)
    ) u_a (
        .clk_i,
        .en_i,
        .a_i(n[step]),
        .b_i(y_0),
        .p_o(product_a)
    );
    // On the grid of the unit, rounded down.
    localparam int AFrac = OperandBits + YFrac;
    if (AFrac >= InternalBits) begin : gen_down
      assign a = InW'(product_a >> (AFrac - InternalBits));
    end else begin : gen_up
      assign a = InW'(product_a) << (InternalBits - AFrac);
    end
    ring_line #(
        .Width(YInW),
        .Depth(ProductClocks)
    ) u_y_1 (
        .clk_i,
        .rst_ni,
        .en_i,
        .d_i(y_0),
        .q_o(y_1)
    );
    mul_pipe #(
        .AW(InW),
        .BW(YInW),
        .ASigned(0),
        .BSigned(0),
        .Clocks(ProductClocks)
    ) u_c (
        .clk_i,
        .en_i,
        .a_i(a),
        .b_i(y_1),
        .p_o(product_c)
    );
    assign c = (InternalBits + 2)'(product_c >> YFrac);
    always_ff @(posedge clk_i) begin
      if (en_i) rest_q <= ((InternalBits + 2)'(3) << InternalBits) - c;
    end
    ring_line #(
        .Width(YInW),
        .Depth(ProductClocks + 1)
    ) u_y_2 (
        .clk_i,
        .rst_ni,
        .en_i,
        .d_i(y_1),
        .q_o(y_2)
    );
    mul_pipe #(
        .AW(YInW),
        .BW(InternalBits + 2),
        .ASigned(0),
        .BSigned(0),
        .Clocks(ProductClocks)
    ) u_y (
        .clk_i,
        .en_i,
        .a_i(y_2),
        .b_i(rest_q),
        .p_o(product_y)
    );
    assign y[step+1] = YW'(product_y >> (YFrac + 1));
    ring_line #(
        .Width(NW),
        .Depth(StepClocks)
    ) u_n (
        .clk_i,
        .rst_ni,
        .en_i,
        .d_i(n[step]),
        .q_o(n[step+1])
    );
    logic unused_high;
    assign unused_high = ^{product_a, product_c, product_y};
  end
  logic unused_n;
  assign unused_n = ^n[Steps];

  logic [OutW-1:0] m;
  localparam int LastFrac = (Steps == 0) ? TableBits : InternalBits;
  quantize #(
      .InW(YW + 1),
      .InFrac(LastFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i({1'b0, y[Steps]}),
      .sticky_i(1'b0),
      .q_o(m)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) m_o <= m;
  end
  logic [EW-1:0] e_line;
  ring_line #(
      .Width(EW),
      .Depth(Steps * StepClocks + 1)
  ) u_e (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(e_q),
      .q_o(e_line)
  );
  assign e_o = e_line;

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == NormaliseClocks + 2 + Steps * StepClocks)
    else $fatal(1, "root: has %0d clocks, told %0d", NormaliseClocks + 2 + Steps * StepClocks, Clocks);
  end
`endif
endmodule
