// The reciprocal unit R(d) of docs/numeric-spec.md, "Reciprocal": m 2^-e stands for 1 / d.
//
//   d_i  unsigned, OpW bits on OpFrac fraction bits; 0 counts as one ulp
//   m_o  raw bits on the output format
//   e_o  Normalize: floor(log2 d), else 0
//
// Latency: Clocks enabled clocks. A pipelined unit takes an operand on each of them. An iterative unit (Pipelined 0)
// takes an operand with start_i and needs it stable until its result is used. The result stays until the next start.
//
// Clocks:  1 normalise | restoring: Iterations           | 1 Q
//                      | lut_linear: 1 table, 1 product  |
//                      | lut_newton: 1 table, 2 per step |
//                      | lut_quadratic: 1 table, 2       |
module reciprocal #(
    parameter int Kind         = 0,
    parameter int Normalize    = 1,
    parameter int OpW          = 8,
    parameter int OpFrac       = 0,
    parameter int OperandBits  = 0,
    parameter int IndexBits    = 0,
    parameter int TableBits    = 0,
    parameter int InternalBits = 0,
    parameter int Steps        = 0,
    parameter int BitsPerCycle = 1,
    parameter int Pipelined    = 1,
    parameter int Iterations   = 8,
    parameter int QuotientFrac = 7,
    parameter int OutW         = 8,
    parameter int OutFrac      = 7,
    parameter int OutSigned    = 0,
    parameter int OutRnd       = 0,
    parameter int OutOvf       = 1,
    parameter int EW           = 8,
    parameter int TableEntries = 1,
    parameter int Clocks       = 10,
    parameter logic [TableEntries*(TableBits+1)-1:0] Table = '0
) (
    input  logic                   clk_i,
    input  logic                   rst_ni,
    input  logic                   en_i,
    input  logic                   start_i,
    input  logic        [ OpW-1:0] d_i,
    output logic        [OutW-1:0] m_o,
    output logic signed [  EW-1:0] e_o
);
  localparam int KindRestoring = 0;
  localparam int KindLutLinear = 1;
  localparam int KindLutNewton = 2;
  localparam int KindLutQuadratic = 3;
  localparam int CoreClocks = (Kind == KindRestoring) ? Iterations :
                              (Kind == KindLutLinear) ? 2 :
                              (Kind == KindLutQuadratic) ? 3 : 1 + 2 * Steps;
  localparam int ShiftW = $clog2(OpW + 1);

  // Normalise: n = d 2^zeros has its top bit set; e = OpW - 1 - OpFrac - zeros.
  logic [OpW-1:0] d, n, n_q;
  logic [ShiftW-1:0] zeros, zeros_q;
  assign d = (d_i == '0) ? OpW'(1) : d_i;
  always_comb begin
    zeros = '0;
    for (int i = 0; i < OpW; i++) begin
      if (d[i]) zeros = ShiftW'(OpW - 1 - i);
    end
  end
  assign n = (Kind == KindRestoring && Normalize == 0) ? d : d << zeros;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      n_q <= n;
      zeros_q <= zeros;
    end
  end

  // The shift count of the operand whose y is in front of Q.
  logic [ShiftW-1:0] zeros_y;
  delay_line #(
      .Width(ShiftW),
      .Depth((Kind == KindRestoring && Pipelined == 0) ? 0 : CoreClocks)
  ) u_zeros (
      .clk_i,
      .en_i,
      .d_i(zeros_q),
      .q_o(zeros_y)
  );

  // y, or 1/d itself where the restoring unit does not normalise, on YFrac fraction bits, YW bits and a sign.
  localparam int LutFrac = (Kind == KindLutNewton && Steps == 0) ? TableBits : InternalBits;
  localparam int ShiftMax = (Kind == KindRestoring || Normalize != 0) ? 0 : OpW - 1;
  localparam int YFrac = (Kind == KindRestoring) ? QuotientFrac :
                         (Normalize != 0) ? LutFrac : LutFrac + OpW - 1 - OpFrac;
  localparam int YW = (Kind == KindRestoring) ? Iterations * BitsPerCycle : LutFrac + 1 + ShiftMax;
  logic [YW-1:0] y;
  logic sticky;

  if (Kind == KindRestoring) begin : gen_restoring
    logic start_q;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) start_q <= 1'b0;
      else if (en_i) start_q <= start_i;
    end
    // The numerator is a single 1: its first quotient bit weighs 2^0 of 1/n, n in [1, 2), when normalised;
    // 2^OpFrac of 1/d when not.
    localparam int HasRem = (Normalize != 0 && OpW > 1) ? 1 : 0;
    localparam logic [OpW-1:0] Rem = (HasRem != 0) ? OpW'(1) << (OpW > 1 ? OpW - 2 : 0) : '0;
    localparam logic [YW-1:0] Num = (HasRem != 0) ? '0 : YW'(1) << (YW - 1);
    restoring_core #(
        .DW(OpW),
        .Iterations(Iterations),
        .BitsPerCycle(BitsPerCycle),
        .Pipelined(Pipelined)
    ) u_core (
        .clk_i,
        .en_i,
        .start_i (start_q),
        .rem_i   (Rem),
        .num_i   (Num),
        .d_i     (n_q),
        .q_o     (y),
        .sticky_o(sticky)
    );
  end else begin : gen_lut
    logic unused_start;
    assign unused_start = start_i ^ rst_ni;
    assign sticky = 1'b0;

    localparam int EntryW = TableBits + 1;
    // lut_quadratic has c0, c1 and c2 of a segment in one word: {c2, c1, c0}, without the leading zeros of
    // c1 <= 2^-IndexBits and c2 <= 2^-(2 IndexBits).
    localparam int C1W = (TableBits > IndexBits) ? EntryW - IndexBits : 1;
    localparam int C2W = (TableBits > 2 * IndexBits) ? EntryW - 2 * IndexBits : 1;
    localparam int RomW = (Kind == KindLutQuadratic) ? C2W + C1W + EntryW : EntryW;
    localparam int RomWords = (Kind == KindLutQuadratic) ? TableEntries / 3 : TableEntries;
    logic [RomW-1:0] rom[RomWords];
    if (Kind == KindLutQuadratic) begin : gen_words
      initial begin
        for (int i = 0; i < RomWords; i++) begin
          rom[i] = {
            Table[(2*RomWords+i)*EntryW+:C2W], Table[(RomWords+i)*EntryW+:C1W], Table[i*EntryW+:EntryW]
          };
        end
      end
    end else begin : gen_entries
      initial begin
        for (int i = 0; i < RomWords; i++) rom[i] = Table[i*EntryW+:EntryW];
      end
    end

    // nq - 1 on max(OperandBits, IndexBits) fraction bits: the operand's bits below the leading one, cut to
    // OperandBits. One zero stands in front so that no width is 0.
    localparam int NqFrac = (OperandBits > IndexBits) ? OperandBits : IndexBits;
    localparam int CutW = OpW + OperandBits;
    logic [CutW-1:0] cut;
    logic [OperandBits:0] below;
    logic [NqFrac:0] fraction;
    assign cut = {n_q, {OperandBits{1'b0}}};
    // n_q has OpW - 1 fraction bits, cut therefore OpW - 1 + OperandBits.
    assign below = {1'b0, OperandBits'(cut >> (OpW - 1))};
    assign fraction = (NqFrac + 1)'(below) << (NqFrac - OperandBits);

    localparam int TFrac = NqFrac - IndexBits;
    logic [IndexBits:0] j;
    assign j = fraction[NqFrac:TFrac];

    logic [TFrac:0] t;
    if (TFrac > 0) begin : gen_t
      assign t = {1'b0, fraction[TFrac-1:0]};
    end else begin : gen_no_t
      assign t = 1'b0;
    end

    logic [LutFrac:0] y_lut;

    if (Kind == KindLutLinear) begin : gen_linear
      // Clock 2: c(j), c(j+1), t.
      logic [EntryW-1:0] c0_q, c1_q;
      logic [TFrac:0] t_q;
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          c0_q <= rom[j];
          c1_q <= rom[j+1'b1];
          t_q <= t;
        end
      end
      // Clock 3: c(j) - (c(j) - c(j+1)) t, floored to InternalBits. c falls, so nothing here is negative.
      localparam int ExactW = EntryW + TFrac;
      localparam int ExactFrac = TableBits + TFrac;
      localparam int Drop = (ExactFrac > InternalBits) ? ExactFrac - InternalBits : 0;
      localparam int Append = (ExactFrac > InternalBits) ? 0 : InternalBits - ExactFrac;
      logic [EntryW-1:0] fall;
      logic [ExactW-1:0] exact;
      assign fall = c0_q - c1_q;
      assign exact = (ExactW'(c0_q) << TFrac) - ExactW'(fall) * ExactW'(t_q);
      always_ff @(posedge clk_i) begin
        if (en_i) y_lut <= (LutFrac + 1)'(((ExactW + Append)'(exact) << Append) >> Drop);
      end
    end else if (Kind == KindLutQuadratic) begin : gen_quadratic
      // Clock 2: c0, c1, c2, t.
      localparam int GW = (InternalBits > IndexBits) ? InternalBits + 1 - IndexBits : 1;
      logic [EntryW-1:0] c0_q, c0_g_q;
      logic [C1W-1:0] c1_q;
      logic [C2W-1:0] c2_q;
      logic [TFrac:0] t_q, t_g_q;
      logic [GW-1:0] g_q;
      logic unused_j;
      assign unused_j = j[IndexBits];
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          {c2_q, c1_q, c0_q} <= rom[j[IndexBits-1:0]];
          t_q <= t;
        end
      end
      // Clock 3: g = c1 - c2 t, floored to InternalBits. c2 is at most c1 and t below 1, so g is not negative.
      localparam int SlopeW = C1W + TFrac;
      localparam int SlopeFrac = TableBits + TFrac;
      localparam int DropG = (SlopeFrac > InternalBits) ? SlopeFrac - InternalBits : 0;
      localparam int AppendG = (SlopeFrac > InternalBits) ? 0 : InternalBits - SlopeFrac;
      logic [SlopeW-1:0] slope;
      assign slope = (SlopeW'(c1_q) << TFrac) - SlopeW'(c2_q) * SlopeW'(t_q);
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          g_q <= GW'(((SlopeW + AppendG)'(slope) << AppendG) >> DropG);
          c0_g_q <= c0_q;
          t_g_q <= t_q;
        end
      end
      // Clock 4: c0 - g t, floored to InternalBits. g is at most c1, and c1 below c0.
      localparam int ProductFrac = InternalBits + TFrac;
      localparam int ExactFrac = (TableBits > ProductFrac) ? TableBits : ProductFrac;
      localparam int ExactW = ExactFrac + 1;
      logic [ExactW-1:0] exact;
      assign exact = (ExactW'(c0_g_q) << (ExactFrac - TableBits)) -
                     ((ExactW'(g_q) * ExactW'(t_g_q)) << (ExactFrac - ProductFrac));
      always_ff @(posedge clk_i) begin
        if (en_i) y_lut <= (LutFrac + 1)'(exact >> (ExactFrac - InternalBits));
      end
    end else begin : gen_newton
      // Clock 2: y(0) and nq. y never exceeds 1, nq is below 2, so a is below 2.
      localparam int NqW = NqFrac + 1;
      localparam int AW = InternalBits + 2;
      logic [EntryW-1:0] y0, y0_q;
      logic [NqW-1:0] nq0_q;
      if (IndexBits > 0) begin : gen_entry
        assign y0 = rom[j[IndexBits-1:0]];
      end else begin : gen_single_entry
        assign y0 = rom[0];
      end
      logic unused_j;
      assign unused_j = j[IndexBits] ^ (^t);
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          y0_q <= y0;
          nq0_q <= {1'b1, fraction[NqFrac-1:0]};
        end
      end
      localparam int MaxFrac = (TableBits > InternalBits) ? TableBits : InternalBits;
      logic [MaxFrac:0] y_step[Steps+1];
      logic [NqW-1:0] nq_step[Steps+1];
      assign y_step[0] = (MaxFrac + 1)'(y0_q);
      assign nq_step[0] = nq0_q;
      for (genvar s = 0; s < Steps; s++) begin : gen_step
        localparam int InFrac = (s == 0) ? TableBits : InternalBits;
        localparam int DropA = (NqFrac + InFrac > InternalBits) ? NqFrac + InFrac - InternalBits : 0;
        localparam int AppendA = (NqFrac + InFrac > InternalBits) ? 0 : InternalBits - NqFrac - InFrac;
        localparam int ProductAW = NqW + InFrac + 1 + AppendA;
        localparam int ProductYW = InFrac + 1 + AW;
        logic [AW-1:0] a_q, factor;
        logic [InFrac:0] y_in, y_a_q;
        logic [NqW-1:0] nq_a_q, nq_q;
        logic [InternalBits:0] y_q;
        logic [ProductAW-1:0] product_a;
        logic [ProductYW-1:0] product_y;
        assign y_in = y_step[s][InFrac:0];
        assign product_a = (ProductAW'(nq_step[s]) * ProductAW'(y_in)) << AppendA;
        assign factor = {2'b10, {InternalBits{1'b0}}} - a_q;
        assign product_y = ProductYW'(y_a_q) * ProductYW'(factor);
        always_ff @(posedge clk_i) begin
          if (en_i) begin
            a_q <= AW'(product_a >> DropA);
            y_a_q <= y_in;
            nq_a_q <= nq_step[s];
            y_q <= (InternalBits + 1)'(product_y >> InFrac);
            nq_q <= nq_a_q;
          end
        end
        assign y_step[s+1] = (MaxFrac + 1)'(y_q);
        assign nq_step[s+1] = nq_q;
      end
      assign y_lut = y_step[Steps][LutFrac:0];
      logic unused_nq;
      assign unused_nq = ^nq_step[Steps];
    end

    if (Normalize != 0) begin : gen_mantissa
      assign y = y_lut;
    end else begin : gen_fixed
      // y 2^-e on the grid of the largest e.
      assign y = YW'(y_lut) << zeros_y;
    end
  end

  // Q.
  logic [OutW-1:0] m;
  quantize #(
      .InW(YW + 1),
      .InFrac(YFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i($signed({1'b0, y})),
      .sticky_i(sticky),
      .q_o(m)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      m_o <= m;
      e_o <= (Normalize != 0) ? EW'(OpW - 1 - OpFrac) - EW'(zeros_y) : '0;
    end
  end

`ifndef SYNTHESIS
  initial begin
    assert (Kind >= KindRestoring && Kind <= KindLutQuadratic)
    else $error("reciprocal: unknown kind %0d", Kind);
    assert (Clocks == 2 + CoreClocks)
    else $error("reciprocal: has %0d clocks, told %0d", 2 + CoreClocks, Clocks);
    assert (Kind != KindRestoring || QuotientFrac > OutFrac)
    else $error("reciprocal: quotient of %0d fraction bits for %0d", QuotientFrac, OutFrac);
    assert (Kind == KindRestoring || (OperandBits >= 1 && InternalBits >= 1))
    else $error("reciprocal: a table needs operand and internal bits");
  end
`endif
endmodule
