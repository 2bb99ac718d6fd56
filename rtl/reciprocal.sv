// SPDX-License-Identifier: Apache-2.0
// The reciprocal unit R(d) of docs/numeric-spec.md, "Reciprocal": m 2^-e stands for 1 / d.
//
//   d_i  unsigned, OpW bits on OpFrac fraction bits; 0 counts as one ulp
//   m_o  raw bits on the output format
//   e_o  Normalize: floor(log2 d), else 0
//
// Latency: Clocks enabled clocks. A pipelined unit takes an operand on each of them. An iterative unit (restoring,
// Pipelined 0) takes an operand with start_i, at most once per
// Iterations + 1 clocks.
//
//   NormaliseClocks | restoring: as restoring_core                              | 1 Q
//                   | lut_linear: 2 table, ProductClocks, 1 difference           |
//                   | lut_newton: 2 table; per step 2 ProductClocks, 1 difference |
//                   | lut_quadratic: 2 table; twice ProductClocks, 1 difference  |
//
// The products of a Newton unit may be formed elsewhere (Shared: how many): product k takes its factors a_o and b_o,
// place k, at tick Ticks[k], the operand being there at tick StartTick, and the product stands at place k of product_i
// ProductClocks + 1 clocks later.
//
// A table takes two clocks, since a block RAM's output comes late in its clock.
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
    parameter int NormaliseClocks = 2,
    parameter int ProductClocks   = 3,
    parameter int Clocks       = 14,
    parameter int Shared       = 0,
    parameter int StartTick    = 0,
    parameter int AW           = 1,
    parameter int BW           = 1,
    parameter int Places       = (Shared > 0) ? Shared : 1,
    parameter logic [Places*16-1:0] Ticks = '0,
    parameter logic [TableEntries*(TableBits+1)-1:0] Table = '0
) (
    input  logic                   clk_i,
    input  logic                   rst_ni,
    input  logic                   en_i,
    input  logic                   start_i,
    input  logic        [ OpW-1:0] d_i,
    output logic    [Places*AW-1:0] a_o,
    output logic    [Places*BW-1:0] b_o,
    input  logic [Places*(AW+BW)-1:0] product_i,
    output logic        [OutW-1:0] m_o,
    output logic signed [  EW-1:0] e_o
);
  localparam int KindRestoring = 0;
  localparam int KindLutLinear = 1;
  localparam int KindLutNewton = 2;
  localparam int KindLutQuadratic = 3;
  localparam int RestoringClocks = (Pipelined != 0) ? Iterations : BitsPerCycle * (Iterations + 1);
  localparam int LastTick = 32'(Ticks[Places*16-1-:16]) - StartTick;
  localparam int CoreClocks = (Kind == KindRestoring) ? RestoringClocks :
                              (Kind == KindLutLinear) ? 3 + ProductClocks :
                              (Kind == KindLutQuadratic) ? 4 + 2 * ProductClocks :
                              (Shared != 0) ? LastTick + 1 + ProductClocks - NormaliseClocks :
                              2 + Steps * (2 * ProductClocks + 1);
  localparam int ShiftW = $clog2(OpW + 1);
  logic unused_product;
  assign unused_product = ^product_i;
  if (Kind != KindLutNewton || Shared == 0) begin : gen_none_shared
    assign a_o = '0;
    assign b_o = '0;
  end

  // Normalise: n = d 2^zeros has its top bit set; e = OpW - 1 - OpFrac - zeros.
  logic [OpW-1:0] d, n_q;
  logic [ShiftW-1:0] zeros_q;
  assign d = (d_i == '0) ? OpW'(1) : d_i;
  if (Kind == KindRestoring && Normalize == 0) begin : gen_as_it_is
    delay_line #(
        .Width(OpW),
        .Depth(NormaliseClocks)
    ) u_operand (
        .clk_i,
        .en_i,
        .d_i(d),
        .q_o(n_q)
    );
    assign zeros_q = '0;
  end else begin : gen_normalise
    lzc_norm #(
        .Width (OpW),
        .Clocks(NormaliseClocks)
    ) u_normalise (
        .clk_i,
        .en_i,
        .d_i(d),
        .n_o(n_q),
        .zeros_o(zeros_q)
    );
  end
  // start_i beside n_q, for the iterative unit.
  logic start_q;
  if (Kind == KindRestoring && Pipelined == 0) begin : gen_start
    logic [NormaliseClocks-1:0] start_line_q;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) start_line_q <= '0;
      else if (en_i) start_line_q <= NormaliseClocks'({start_line_q, start_i});
    end
    assign start_q = start_line_q[NormaliseClocks-1];
  end else begin : gen_no_start
    logic unused_start;
    assign unused_start = start_i ^ rst_ni;
    assign start_q = 1'b0;
  end

  // The shift count of the operand whose y is in front of Q.
  logic [ShiftW-1:0] zeros_y;
  if (Kind == KindRestoring && Pipelined == 0) begin : gen_zeros_held
    // Beside the units of restoring_core: each passes its operand on when it has made its bits.
    logic [ShiftW-1:0] held[BitsPerCycle+1];
    logic [BitsPerCycle*(Iterations+1)-1:0] started_q;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) started_q <= '0;
      else if (en_i) started_q <= (BitsPerCycle * (Iterations + 1))'({started_q, start_q});
    end
    assign held[0] = zeros_q;
    for (genvar i = 0; i < BitsPerCycle; i++) begin : gen_unit
      logic take;
      logic [ShiftW-1:0] held_q;
      if (i == 0) begin : gen_first
        assign take = start_q;
      end else begin : gen_next
        assign take = started_q[i*(Iterations+1)-1];
      end
      always_ff @(posedge clk_i) begin
        if (en_i && take) held_q <= held[i];
      end
      assign held[i+1] = held_q;
    end
    logic unused_started;
    assign unused_started = ^started_q;
    assign zeros_y = held[BitsPerCycle];
  end else begin : gen_zeros_line
    delay_line #(
        .Width(ShiftW),
        .Depth(CoreClocks)
    ) u_zeros (
        .clk_i,
        .en_i,
        .d_i(zeros_q),
        .q_o(zeros_y)
    );
  end

  // y, or 1/d itself where the restoring unit does not normalise, on YFrac fraction bits, YW bits and a sign.
  localparam int LutFrac = (Kind == KindLutNewton && Steps == 0) ? TableBits : InternalBits;
  localparam int ShiftMax = (Kind == KindRestoring || Normalize != 0) ? 0 : OpW - 1;
  localparam int YFrac = (Kind == KindRestoring) ? QuotientFrac :
                         (Normalize != 0) ? LutFrac : LutFrac + OpW - 1 - OpFrac;
  localparam int YW = (Kind == KindRestoring) ? Iterations * BitsPerCycle : LutFrac + 1 + ShiftMax;
  logic [YW-1:0] y;
  logic sticky;

  if (Kind == KindRestoring) begin : gen_restoring
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
        .rst_ni,
        .en_i,
        .start_i (start_q),
        .rem_i   (Rem),
        .num_i   (Num),
        .d_i     (n_q),
        .q_o     (y),
        .sticky_o(sticky)
    );
  end else begin : gen_lut
    logic unused_start_q;
    assign unused_start_q = start_q;
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
      // c(j), c(j+1), t.
      logic [EntryW-1:0] read0_q, read1_q, c0_q, fall_q, c0;
      logic [TFrac:0] read_t_q, t_q;
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          read0_q <= rom[j];
          read1_q <= rom[j+1'b1];
          read_t_q <= t;
          c0_q <= read0_q;
          fall_q <= read0_q - read1_q;
          t_q <= read_t_q;
        end
      end
      // c(j) - (c(j) - c(j+1)) t, floored to InternalBits. c falls, so nothing here is negative.
      localparam int ProductW = EntryW + TFrac + 1;
      localparam int ExactFrac = TableBits + TFrac;
      localparam int Drop = (ExactFrac > InternalBits) ? ExactFrac - InternalBits : 0;
      localparam int Append = (ExactFrac > InternalBits) ? 0 : InternalBits - ExactFrac;
      logic [ProductW-1:0] product, exact;
      mul_pipe #(
          .AW(EntryW),
          .BW(TFrac + 1),
          .ASigned(0),
          .BSigned(0),
          .Clocks(ProductClocks)
      ) u_product (
          .clk_i,
          .en_i,
          .a_i(fall_q),
          .b_i(t_q),
          .p_o(product)
      );
      delay_line #(
          .Width(EntryW),
          .Depth(ProductClocks)
      ) u_c0 (
          .clk_i,
          .en_i,
          .d_i(c0_q),
          .q_o(c0)
      );
      assign exact = (ProductW'(c0) << TFrac) - product;
      always_ff @(posedge clk_i) begin
        if (en_i) y_lut <= (LutFrac + 1)'(((ProductW + Append)'(exact) << Append) >> Drop);
      end
    end else if (Kind == KindLutQuadratic) begin : gen_quadratic
      // c0, c1, c2, t.
      localparam int GW = (InternalBits > IndexBits) ? InternalBits + 1 - IndexBits : 1;
      logic [EntryW-1:0] c0_q, c0_g, c0_y;
      logic [C1W-1:0] c1_q, c1_g;
      logic [C2W-1:0] c2_q;
      logic [RomW-1:0] read_q;
      logic [TFrac:0] read_t_q, t_q, t_g;
      logic [GW-1:0] g_q;
      logic unused_j;
      assign unused_j = j[IndexBits];
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          read_q <= rom[j[IndexBits-1:0]];
          read_t_q <= t;
          {c2_q, c1_q, c0_q} <= read_q;
          t_q <= read_t_q;
        end
      end
      // g = c1 - c2 t, floored to InternalBits. c2 is at most c1 and t below 1, so g is not negative.
      localparam int SlopeW = ((C1W > C2W) ? C1W : C2W) + TFrac + 1;
      localparam int SlopeFrac = TableBits + TFrac;
      localparam int DropG = (SlopeFrac > InternalBits) ? SlopeFrac - InternalBits : 0;
      localparam int AppendG = (SlopeFrac > InternalBits) ? 0 : InternalBits - SlopeFrac;
      logic [C2W+TFrac:0] curve;
      logic [SlopeW-1:0] slope;
      mul_pipe #(
          .AW(C2W),
          .BW(TFrac + 1),
          .ASigned(0),
          .BSigned(0),
          .Clocks(ProductClocks)
      ) u_curve (
          .clk_i,
          .en_i,
          .a_i(c2_q),
          .b_i(t_q),
          .p_o(curve)
      );
      delay_line #(
          .Width(C1W),
          .Depth(ProductClocks)
      ) u_c1 (
          .clk_i,
          .en_i,
          .d_i(c1_q),
          .q_o(c1_g)
      );
      assign slope = (SlopeW'(c1_g) << TFrac) - SlopeW'(curve);
      always_ff @(posedge clk_i) begin
        if (en_i) g_q <= GW'(((SlopeW + AppendG)'(slope) << AppendG) >> DropG);
      end
      // c0 - g t, floored to InternalBits. g is at most c1, and c1 below c0.
      delay_line #(
          .Width(EntryW + TFrac + 1),
          .Depth(ProductClocks + 1)
      ) u_beside_g (
          .clk_i,
          .en_i,
          .d_i({c0_q, t_q}),
          .q_o({c0_g, t_g})
      );
      localparam int ProductFrac = InternalBits + TFrac;
      localparam int ExactFrac = (TableBits > ProductFrac) ? TableBits : ProductFrac;
      localparam int ExactW = ((GW + TFrac > ExactFrac) ? GW + TFrac : ExactFrac) + 1;
      logic [GW+TFrac:0] fall;
      logic [ExactW-1:0] exact;
      mul_pipe #(
          .AW(GW),
          .BW(TFrac + 1),
          .ASigned(0),
          .BSigned(0),
          .Clocks(ProductClocks)
      ) u_fall (
          .clk_i,
          .en_i,
          .a_i(g_q),
          .b_i(t_g),
          .p_o(fall)
      );
      delay_line #(
          .Width(EntryW),
          .Depth(ProductClocks)
      ) u_c0 (
          .clk_i,
          .en_i,
          .d_i(c0_g),
          .q_o(c0_y)
      );
      assign exact = (ExactW'(c0_y) << (ExactFrac - TableBits)) - (ExactW'(fall) << (ExactFrac - ProductFrac));
      always_ff @(posedge clk_i) begin
        if (en_i) y_lut <= (LutFrac + 1)'(exact >> (ExactFrac - InternalBits));
      end
    end else begin : gen_newton
      // y(0) and nq. y never exceeds 1, nq is below 2, so a is below 2.
      localparam int NqW = NqFrac + 1;
      localparam int FactorW = InternalBits + 2;
      logic [EntryW-1:0] y0, read_q, y0_q;
      logic [NqW-1:0] read_nq_q, nq0_q;
      if (IndexBits > 0) begin : gen_entry
        assign y0 = rom[j[IndexBits-1:0]];
      end else begin : gen_single_entry
        assign y0 = rom[0];
      end
      logic unused_j;
      assign unused_j = j[IndexBits] ^ (^t);
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          read_q <= y0;
          read_nq_q <= {1'b1, fraction[NqFrac-1:0]};
          y0_q <= read_q;
          nq0_q <= read_nq_q;
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
        // Clocks from y and nq to the first product's factors, from 2 - a to those of the second, and from y to the
        // next step's.
        localparam int Select = (Shared > 0) ? 1 : 0;
        localparam int FirstTick = (Shared > 0) ? 32'(Ticks[32*s*Select+:16]) : 0;
        localparam int SecondTick = (Shared > 0) ? 32'(Ticks[(32*s+16)*Select+:16]) : ProductClocks + 1;
        localparam int NextTick = (Shared > 0 && s + 1 < Steps) ? 32'(Ticks[(32*s+32)*Select*((s+1<Steps)?1:0)+:16]) :
                                  SecondTick + Select + ProductClocks;
        localparam int WaitsY = SecondTick - FirstTick - Select - ProductClocks - 1;
        localparam int WaitsNext = NextTick - SecondTick - Select - ProductClocks;
        logic [NqW+InFrac:0] product_a;
        logic [NqW+InFrac+AppendA:0] placed_a;
        logic [FactorW-1:0] factor_q, factor;
        logic [InFrac:0] y_in, y_a;
        logic [InFrac+FactorW:0] product_y;
        assign y_in = y_step[s][InFrac:0];
        // a = nq y, floored; then 2 - a; then y (2 - a).
        assign placed_a = (NqW + InFrac + 1 + AppendA)'(product_a) << AppendA;
        always_ff @(posedge clk_i) begin
          if (en_i) factor_q <= {2'b10, {InternalBits{1'b0}}} - FactorW'(placed_a >> DropA);
        end
        delay_line #(
            .Width(FactorW),
            .Depth(WaitsY)
        ) u_factor (
            .clk_i,
            .en_i,
            .d_i(factor_q),
            .q_o(factor)
        );
        delay_line #(
            .Width(InFrac + 1),
            .Depth(SecondTick - FirstTick)
        ) u_beside_a (
            .clk_i,
            .en_i,
            .d_i(y_in),
            .q_o(y_a)
        );
        if (Shared > 0) begin : gen_turn
          assign a_o[2*s*AW+:2*AW] = {AW'(factor), AW'(nq_step[s])};
          assign b_o[2*s*BW+:2*BW] = {BW'(y_a), BW'(y_in)};
          assign product_a = product_i[2*s*(AW+BW)+:NqW+InFrac+1];
          assign product_y = product_i[(2*s+1)*(AW+BW)+:InFrac+FactorW+1];
        end else begin : gen_multipliers
          mul_pipe #(
              .AW(NqW),
              .BW(InFrac + 1),
              .ASigned(0),
              .BSigned(0),
              .Clocks(ProductClocks)
          ) u_a (
              .clk_i,
              .en_i,
              .a_i(nq_step[s]),
              .b_i(y_in),
              .p_o(product_a)
          );
          mul_pipe #(
              .AW(FactorW),
              .BW(InFrac + 1),
              .ASigned(0),
              .BSigned(0),
              .Clocks(ProductClocks)
          ) u_y (
              .clk_i,
              .en_i,
              .a_i(factor),
              .b_i(y_a),
              .p_o(product_y)
          );
        end
        logic [InternalBits:0] y_made, y_next;
        assign y_made = (InternalBits + 1)'(product_y >> InFrac);
        delay_line #(
            .Width(InternalBits + 1),
            .Depth(WaitsNext)
        ) u_y_next (
            .clk_i,
            .en_i,
            .d_i(y_made),
            .q_o(y_next)
        );
        assign y_step[s+1] = (MaxFrac + 1)'(y_next);
        if (s + 1 < Steps) begin : gen_nq
          delay_line #(
              .Width(NqW),
              .Depth(NextTick - FirstTick)
          ) u_nq (
              .clk_i,
              .en_i,
              .d_i(nq_step[s]),
              .q_o(nq_step[s+1])
          );
        end else begin : gen_last_nq
          assign nq_step[s+1] = '0;
        end
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
    else $fatal(1, "reciprocal: unknown kind %0d", Kind);
    assert (Clocks == NormaliseClocks + CoreClocks + 1)
    else $fatal(1, "reciprocal: has %0d clocks, told %0d", NormaliseClocks + CoreClocks + 1, Clocks);
    assert (Shared == 0 || (Kind == KindLutNewton && Shared == 2 * Steps &&
                            32'(Ticks[15:0]) - StartTick == NormaliseClocks + 2))
    else $fatal(1, "reciprocal: %0d products cannot be formed elsewhere", Shared);
    assert (Kind != KindRestoring || QuotientFrac > OutFrac)
    else $fatal(1, "reciprocal: quotient of %0d fraction bits for %0d", QuotientFrac, OutFrac);
    assert (Kind == KindRestoring || (OperandBits >= 1 && InternalBits >= 1))
    else $fatal(1, "reciprocal: a table needs operand and internal bits");
  end
`endif
endmodule
