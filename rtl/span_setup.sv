// SPDX-License-Identifier: Apache-2.0
// span_setup of docs/numeric-spec.md: takes a row's ends, or in const_depth_rows a plane row, and delivers a span
// record.
//
// Time is counted in ticks: clocks on which span_setup goes on, which is all but those on which a span record is there
// and res_ready_i is 0. A row is accepted on ticks that are
// multiples of RowInterval, and tick t of a row is the t-th tick after that of its acceptance. The package says at
// which tick each product has a multiplier, so that rows RowInterval ticks apart never meet in one:
//
//   tick 0   the row's ends
//   tick 1   row ends: L = x_r - x_l, differences, h + B; const_depth_rows: h + B. The row unit starts.
//            products with h + B, then with the row's reciprocal, then with the pre-step p
//   tick SpanSetupClocks: the span record
module span_setup (
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
    // the channels stand above them.
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
    // The span record; it is delivered where res_valid_o and res_ready_i are both 1. One that waits stops all.
    output logic res_valid_o,
    input  logic res_ready_i,
    output logic [bitspan_cfg_pkg::SpanRecordW-1:0] res_o
);
  localparam int IndexW = bitspan_cfg_pkg::PixelIndexW;
  localparam int Interval = bitspan_cfg_pkg::RowInterval;
  localparam int PhaseW = bitspan_cfg_pkg::RowPhaseW;
  localparam int Latency = bitspan_cfg_pkg::SpanSetupClocks;
  localparam int ProductTicks = bitspan_cfg_pkg::RowProductTicks;
  localparam int MW = bitspan_cfg_pkg::RowRecipOutW;
  localparam int EW = bitspan_cfg_pkg::ExponentW;
  localparam int AccW = bitspan_cfg_pkg::TexAccW;
  localparam int StepW = bitspan_cfg_pkg::TexStepW;
  localparam int HStepW = bitspan_cfg_pkg::SpanHStepW;
  localparam bit Shades = bitspan_cfg_pkg::Shades != 0;

  // The tick modulo RowInterval, and which rows are valid: row_valid_q[k] is that of ticks 1 + k RowInterval on.
  logic en;
  logic [PhaseW-1:0] phase_q;
  assign en = res_ready_i || !res_valid_o;
  if (Interval > 1) begin : gen_phase
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) phase_q <= '0;
      else if (en) phase_q <= (phase_q == PhaseW'(Interval - 1)) ? '0 : phase_q + PhaseW'(1);
    end
  end else begin : gen_no_phase
    assign phase_q = '0;
  end
  localparam int Rows = (Latency - 1) / Interval + 1;
  logic [Rows-1:0] row_valid_q;
  logic accept;
  assign in_ready_o = en && phase_q == '0;
  assign accept = in_valid_i && in_ready_o;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) row_valid_q <= '0;
    else if (in_ready_o) row_valid_q <= Rows'({row_valid_q, accept});
  end
  assign res_valid_o = row_valid_q[Rows-1] && phase_q == PhaseW'(Latency % Interval);

  // Products. Each has operands, and a sum that comes of them (row_product); those of product k stand at place k.
  localparam int AW = bitspan_cfg_pkg::RowAW;
  localparam int BW = bitspan_cfg_pkg::RowBW;
  localparam int CW = bitspan_cfg_pkg::RowCW;
  localparam int ShiftMax = bitspan_cfg_pkg::RowShiftMax;
  localparam int ShiftW = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1;
  localparam int SumW = bitspan_cfg_pkg::RowSumW + 3;
  // Behind the products of span_setup stand those of the row's Newton unit.
  localparam int Places = bitspan_cfg_pkg::RowPlaces;
  localparam int Newton = bitspan_cfg_pkg::RowNewtonProducts;
  localparam int NewtonPlaces = (Newton > 0) ? Newton : 1;
  localparam int FirstNewton = (Newton > 0) ? bitspan_cfg_pkg::RowProducts : 0;
  logic [Places*AW-1:0] a;
  logic [Places*BW-1:0] b;
  logic [Places*CW-1:0] c;
  logic [Places*ShiftW-1:0] shift;
  logic [Places*(AW+BW)-1:0] product;
  logic [Places*SumW-1:0] sum;
  logic unused_products;
  assign unused_products = ^{product, sum};
  for (genvar m = 0; m < bitspan_cfg_pkg::RowMultipliers; m++) begin : gen_multiplier
    // The product that has the multiplier at the next tick, and at this one.
    logic [Places-1:0] next, now_q;
    logic [AW+BW-1:0] product_m;
    logic [SumW-1:0] sum_m;
    always_comb begin
      for (int k = 0; k < Places; k++) begin
        next[k] = bitspan_cfg_pkg::RowMultiplierOf[16*k+:16] == 16'(m) &&
            (32'(bitspan_cfg_pkg::RowTicks[16*k+:16]) + Interval - 1) % Interval == 32'(phase_q);
      end
    end
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) now_q <= '0;
      else if (en) now_q <= next;
    end
    setup_mac #(
        .Products(Places),
        .AW(AW),
        .BW(BW),
        .CW(CW),
        .SumW(bitspan_cfg_pkg::RowSumW),
        .ShiftBase(bitspan_cfg_pkg::RowShiftBase),
        .ShiftMax(ShiftMax),
        .ProductClocks(bitspan_cfg_pkg::SharedProductClocks),
        .Digits(bitspan_cfg_pkg::ProductDigits)
    ) u_mac (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .select_i(now_q),
        .a_i(a),
        .b_i(b),
        .c_i(c),
        .shift_i(shift),
        .product_o(product_m),
        .sum_o(sum_m)
    );
    for (genvar k = 0; k < Places; k++) begin : gen_product
      if (bitspan_cfg_pkg::RowMultiplierOf[16*k+:16] == 16'(m)) begin : gen_mine
        assign product[k*(AW+BW)+:AW+BW] = product_m;
        assign sum[k*SumW+:SumW] = sum_m;
      end
    end
  end
  for (genvar k = 0; k < Places; k++) begin : gen_place
    if (bitspan_cfg_pkg::RowMultiplierOf[16*k+:16] == 16'hffff) begin : gen_no_product
      assign a[k*AW+:AW] = '0;
      assign b[k*BW+:BW] = '0;
      assign c[k*CW+:CW] = '0;
      assign shift[k*ShiftW+:ShiftW] = '0;
      assign product[k*(AW+BW)+:AW+BW] = '0;
      assign sum[k*SumW+:SumW] = '0;
    end
    if (k >= bitspan_cfg_pkg::RowProducts) begin : gen_newton
      assign c[k*CW+:CW] = '0;
      assign shift[k*ShiftW+:ShiftW] = '0;
    end
  end

  // The row's reciprocal {m, e}, held from RecipTick on. A row without length has m = e = 0, and with them no slopes. A
  // mask makes it so, since a choice of 0 would become a synchronous reset beside an enable, which costs more.
  localparam int RecipW = MW + EW;
  localparam int RecipTick = bitspan_cfg_pkg::RowRecipTick;
  localparam int RecipHeld = (RecipTick > 0) ? (Latency - RecipTick) / Interval + 1 : 1;
  logic [bitspan_cfg_pkg::RowRecipOpW-1:0] operand;
  logic has_recip;
  logic [RecipHeld*RecipW-1:0] recip_q;
  logic [NewtonPlaces*AW-1:0] newton_a;
  logic [NewtonPlaces*BW-1:0] newton_b;
  if (Newton > 0) begin : gen_newton_places
    assign a[FirstNewton*AW+:Newton*AW] = newton_a;
    assign b[FirstNewton*BW+:Newton*BW] = newton_b;
  end else begin : gen_no_newton
    logic unused;
    assign unused = ^{newton_a, newton_b};
  end
  if (bitspan_cfg_pkg::RowSlopeDivide == 0) begin : gen_reciprocal
    logic start;
    logic [MW-1:0] unit_m;
    logic [EW-1:0] unit_e;
    assign start = row_valid_q[0] && phase_q == PhaseW'(1 % Interval);
    reciprocal #(
        .Kind(bitspan_cfg_pkg::RowRecipKind),
        .Normalize(bitspan_cfg_pkg::RowRecipNormalize),
        .OpW(bitspan_cfg_pkg::RowRecipOpW),
        .OpFrac(bitspan_cfg_pkg::RowRecipOpFrac),
        .OperandBits(bitspan_cfg_pkg::RowRecipOperandBits),
        .IndexBits(bitspan_cfg_pkg::RowRecipIndexBits),
        .TableBits(bitspan_cfg_pkg::RowRecipTableBits),
        .InternalBits(bitspan_cfg_pkg::RowRecipInternalBits),
        .Steps(bitspan_cfg_pkg::RowRecipSteps),
        .BitsPerCycle(bitspan_cfg_pkg::RowRecipBitsPerCycle),
        .Pipelined(bitspan_cfg_pkg::RowRecipPipelined),
        .Iterations(bitspan_cfg_pkg::RowRecipIterations),
        .QuotientFrac(bitspan_cfg_pkg::RowRecipQuotientFrac),
        .OutW(bitspan_cfg_pkg::RowRecipOutW),
        .OutFrac(bitspan_cfg_pkg::RowRecipOutFrac),
        .OutSigned(bitspan_cfg_pkg::RowRecipOutSigned),
        .OutRnd(bitspan_cfg_pkg::RowRecipOutRnd),
        .OutOvf(bitspan_cfg_pkg::RowRecipOutOvf),
        .EW(bitspan_cfg_pkg::ExponentW),
        .TableEntries(bitspan_cfg_pkg::RowRecipTableEntries),
        .NormaliseClocks(bitspan_cfg_pkg::NormaliseClocks),
        .ProductClocks((Newton > 0) ? bitspan_cfg_pkg::SharedProductClocks : bitspan_cfg_pkg::ProductClocks),
        .Clocks(bitspan_cfg_pkg::RowUnitClocks),
        .Shared(Newton),
        .StartTick(1),
        .AW(AW),
        .BW(BW),
        .Ticks(bitspan_cfg_pkg::RowTicks[16*FirstNewton+:16*NewtonPlaces]),
        .Table(bitspan_cfg_pkg::RowRecipTable)
    ) u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .start_i(start),
        .d_i(operand),
        .a_o(newton_a),
        .b_o(newton_b),
        .product_i(product[FirstNewton*(AW+BW)+:NewtonPlaces*(AW+BW)]),
        .m_o(unit_m),
        .e_o(unit_e)
    );
    row_hold #(
        .Width(RecipW),
        .Written(RecipTick),
        .Last(Latency)
    ) u_hold (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i({unit_m, unit_e} & {RecipW{has_recip}}),
        .q_o(recip_q)
    );
  end else begin : gen_no_reciprocal
    assign recip_q = '0;
    assign newton_a = '0;
    assign newton_b = '0;
    logic unused;
    assign unused = (^operand) ^ has_recip;
  end
  logic [RecipW-1:0] res_recip;
  assign res_recip = recip_q[RecipHeld*RecipW-1-:RecipW];

  if (bitspan_cfg_pkg::ConstDepthRows == 0) begin : gen_row_ends
    localparam int XW = bitspan_cfg_pkg::EdgeXW;
    localparam int HW = bitspan_cfg_pkg::EdgeHW;
    localparam int UvW = bitspan_cfg_pkg::EdgeUvW;
    localparam int FDiffW = bitspan_cfg_pkg::SpanFDiffW;
    localparam int EdgeSumW = bitspan_cfg_pkg::EdgeSumW;
    localparam int EdgeSumFrac = bitspan_cfg_pkg::EdgeSumFrac;
    localparam int PW = bitspan_cfg_pkg::PreStepW;
    localparam int PFrac = bitspan_cfg_pkg::PreStepFrac;
    localparam bit Affine = bitspan_cfg_pkg::LinearTexture != 0;
    localparam bit Hyperbolic = bitspan_cfg_pkg::PixelQuotients != 0;
    // Slopes come from the multipliers, or all at once from the dividers.
    localparam bit Divides = bitspan_cfg_pkg::RowSlopeDivide != 0;
    localparam int DivideTick = bitspan_cfg_pkg::RowDivideTick;
    localparam int SlopeDone = DivideTick + bitspan_cfg_pkg::RowUnitClocks + 1;

    // Tick 0: length, h + B, and the pre-step. Each is exact: one bit more than its terms.
    logic signed [XW:0] x_l, x_r, length;
    logic signed [HW:0] h_r;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b_ext;
    logic signed [EdgeSumW-1:0] b_sum, h_sum;
    logic signed [PW-1:0] p;
    logic positive;
    assign x_l = $signed({(bitspan_cfg_pkg::EdgeXSigned != 0) & x_l_i[XW-1], x_l_i});
    assign x_r = $signed({(bitspan_cfg_pkg::EdgeXSigned != 0) & x_r_i[XW-1], x_r_i});
    assign h_r = $signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_r_i[HW-1], h_r_i});
    assign b_ext = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign length = x_r - x_l;
    // Where it is 0, whatever is made of the length is replaced.
    assign positive = !length[XW] && (length != '0);
    assign b_sum = EdgeSumW'(b_ext) <<< (EdgeSumFrac - bitspan_cfg_pkg::SetupBFrac);
    assign h_sum = (EdgeSumW'(h_r) <<< (EdgeSumFrac - bitspan_cfg_pkg::EdgeHFrac)) + b_sum;
    assign p = $signed({PW'(x_first_i) << PFrac}) + (PW'(1) << (PFrac - 1)) -
               (PW'(x_l) <<< (PFrac - bitspan_cfg_pkg::EdgeXFrac));

    // Held as long as somebody reads them.
    localparam int FvDiff = bitspan_cfg_pkg::LineDiff[32*(bitspan_cfg_pkg::LineFu+1)+:32];
    localparam int SumRead = Affine ? 1 : 32'(bitspan_cfg_pkg::RowTicks[16*(Affine?0:FvDiff)+:16]);
    localparam int LengthRead = Divides ? DivideTick : 1;
    localparam int PositiveRead = (Divides ? SlopeDone : RecipTick) - 1;
    localparam int PRead = bitspan_cfg_pkg::RowLastStartTick;
    // A line brings the phase and the slope of its digital line.
    localparam int LineAt = 2 * IndexW + ((Affine || Hyperbolic) ? 0 : 2 * UvW);
    localparam int LineW = (bitspan_cfg_pkg::DigitalLine != 0) ? bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW : 0;
    localparam int ThroughW = LineAt + LineW;
    logic [ThroughW-1:0] through;
    assign through[LineAt-1:0] = LineAt'({v_l_i, u_l_i, count_i, x_first_i});
    if (LineW > 0) begin : gen_through_line
      assign through[ThroughW-1:LineAt] = {k_i, phase_i};
    end
    logic [((SumRead-1)/Interval+1)*EdgeSumW-1:0] h_sum_q;
    logic [((LengthRead-1)/Interval+1)*XW-1:0] length_q;
    logic [(PositiveRead-1)/Interval:0] positive_q;
    logic [((PRead-1)/Interval+1)*PW-1:0] p_q;
    logic [((Latency-1)/Interval+1)*ThroughW-1:0] through_q;
    row_hold #(
        .Width(EdgeSumW),
        .Written(1),
        .Last(SumRead)
    ) u_h_sum (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(h_sum),
        .q_o(h_sum_q)
    );
    row_hold #(
        .Width(XW),
        .Written(1),
        .Last(LengthRead)
    ) u_length (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(length[XW-1:0]),
        .q_o(length_q)
    );
    row_hold #(
        .Width(1),
        .Written(1),
        .Last(PositiveRead)
    ) u_positive (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(positive),
        .q_o(positive_q)
    );
    row_hold #(
        .Width(PW),
        .Written(1),
        .Last(PRead)
    ) u_p (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(p),
        .q_o(p_q)
    );
    row_hold #(
        .Width(ThroughW),
        .Written(1),
        .Last(Latency)
    ) u_through (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(through),
        .q_o(through_q)
    );
    assign operand = length_q[XW-1:0];
    assign has_recip = positive_q[(PositiveRead-1)/Interval];
    // Where the dividers start.
    localparam int StartRow = Divides ? (DivideTick - 1) / Interval : 0;
    logic divide_start, has_length;
    logic [XW-1:0] divisor;
    assign divide_start = row_valid_q[StartRow] && phase_q == PhaseW'(DivideTick % Interval);
    assign divisor = length_q[StartRow*XW+:XW];
    assign has_length = positive_q[Divides ? (SlopeDone - 2) / Interval : 0];

    // The lines, each with a slope and a start. The numerator of the slope is the difference of the row's ends; of u and v
    // where they are not linear, (u_r - u_l) (h_r + B) (delta_f), or the difference of the ends' u (h + B) (hyperbolic). To
    // the start comes the left end's.
    localparam int FExtW = FDiffW + ((bitspan_cfg_pkg::SpanFDiffSigned != 0) ? 0 : 1);
    logic [bitspan_cfg_pkg::LinesEndW-1:0] left_ends, right_ends;
    logic [2*FDiffW-1:0] res_f_diff;
    logic [2*UvW-1:0] res_uv1;
    logic [bitspan_cfg_pkg::LinesStepW-1:0] res_step;
    logic [bitspan_cfg_pkg::LinesAccW-1:0] res_start;
    localparam int PlainEndW = HW + 2 * UvW;
    assign left_ends[PlainEndW-1:0] = {v_l_i, u_l_i, h_l_i};
    assign right_ends[PlainEndW-1:0] = {v_r_i, u_r_i, h_r_i};
    if (bitspan_cfg_pkg::Lines > 3) begin : gen_side_ends
      localparam int SideEndW = bitspan_cfg_pkg::LinesEndW - PlainEndW;
      assign left_ends[bitspan_cfg_pkg::LinesEndW-1:PlainEndW] = shade_l_i[bitspan_cfg_pkg::SidesEndW-1-:SideEndW];
      assign right_ends[bitspan_cfg_pkg::LinesEndW-1:PlainEndW] = shade_r_i[bitspan_cfg_pkg::SidesEndW-1-:SideEndW];
    end
    if (Affine) begin : gen_affine
      assign res_f_diff = '0;
      assign res_uv1 = '0;
    end
    for (genvar i = 0; i < bitspan_cfg_pkg::Lines; i++) begin : gen_line
      localparam int Slope = bitspan_cfg_pkg::LineSlope[32*i+:32];
      localparam int Start = bitspan_cfg_pkg::LineStart[32*i+:32];
      localparam int SlopeTick = Divides ? DivideTick : 32'(bitspan_cfg_pkg::RowTicks[16*Slope+:16]);
      localparam int StartTick = 32'(bitspan_cfg_pkg::RowTicks[16*Start+:16]);
      localparam int RecipAt = Divides ? 0 : (SlopeTick - RecipTick) / Interval;
      localparam int EndW = bitspan_cfg_pkg::LineEndW[32*i+:32];
      localparam int EndAt = bitspan_cfg_pkg::LineEndAt[32*i+:32];
      localparam int SlopeW = bitspan_cfg_pkg::LineStepW[32*i+:32];
      localparam int SlopeAt = bitspan_cfg_pkg::LineStepAt[32*i+:32];
      localparam int StartW = bitspan_cfg_pkg::LineAccW[32*i+:32];
      localparam int StartAt = bitspan_cfg_pkg::LineAccAt[32*i+:32];
      // The first product of its ends with h + B; -1 where there is none.
      localparam int Diff = bitspan_cfg_pkg::LineDiff[32*i+:32];
      localparam logic signed [CW-1:0] Offset = bitspan_cfg_pkg::LineOffset[i*CW+:CW];
      localparam int NumW = (Diff < 0) ? EndW + 1 : Hyperbolic ? FDiffW + 1 : FExtW;
      logic [EndW-1:0] left, right;
      logic signed [NumW-1:0] num;
      logic signed [CW-1:0] base;
      assign left = left_ends[EndAt+:EndW];
      assign right = right_ends[EndAt+:EndW];
      if (Diff < 0) begin : gen_ends
        row_ends #(
            .Line(i)
        ) u_ends (
            .clk_i,
            .en_i(en),
            .phase_i(phase_q),
            .left_i(left),
            .right_i(right),
            .n_o(num),
            .c_o(base)
        );
      end else begin : gen_product
        localparam int T = i - bitspan_cfg_pkg::LineFu;
        // (u_r - u_l) (h_r + B), or u_r (h_r + B).
        localparam int DiffTick = 32'(bitspan_cfg_pkg::RowTicks[16*Diff+:16]);
        localparam int DiffDone = DiffTick + ProductTicks;
        localparam int FactorW = EndW + 1;
        logic signed [FactorW-1:0] factor;
        logic [((DiffTick-1)/Interval+1)*FactorW-1:0] factor_q;
        logic [((Latency-DiffDone)/Interval+1)*FDiffW-1:0] f_diff_q;
        row_hold #(
            .Width(FactorW),
            .Written(1),
            .Last(DiffTick)
        ) u_factor (
            .clk_i,
            .en_i(en),
            .phase_i(phase_q),
            .d_i(factor),
            .q_o(factor_q)
        );
        row_product #(
            .Product(Diff),
            .Last(Latency),
            .AW(EdgeSumW),
            .ASigned(1),
            .BW(FactorW),
            .BSigned(1),
            .OutW(bitspan_cfg_pkg::SpanFDiffW),
            .OutFrac(bitspan_cfg_pkg::SpanFDiffFrac),
            .OutSigned(bitspan_cfg_pkg::SpanFDiffSigned),
            .OutRnd(bitspan_cfg_pkg::SpanFDiffRnd),
            .OutOvf(bitspan_cfg_pkg::SpanFDiffOvf),
            .ShiftW(ShiftW)
        ) u_f_diff (
            .clk_i,
            .en_i(en),
            .phase_i(phase_q),
            .a_i(h_sum_q[(DiffTick-1)/Interval*EdgeSumW+:EdgeSumW]),
            .b_i(factor_q[(DiffTick-1)/Interval*FactorW+:FactorW]),
            .e_i('0),
            .c_i('0),
            .a_o(a[Diff*AW+:AW]),
            .b_o(b[Diff*BW+:BW]),
            .c_o(c[Diff*CW+:CW]),
            .shift_o(shift[Diff*ShiftW+:ShiftW]),
            .sum_i(sum[Diff*SumW+:SumW]),
            .q_o(f_diff_q)
        );
        assign res_f_diff[T*FDiffW+:FDiffW] = f_diff_q[(Latency-DiffDone)/Interval*FDiffW+:FDiffW];
        logic unused;
        assign unused = ^{factor_q, f_diff_q};
        if (Hyperbolic) begin : gen_hyperbolic
          localparam int Left = bitspan_cfg_pkg::LineLeft[32*i+:32];
          localparam int LeftTick = 32'(bitspan_cfg_pkg::RowTicks[16*Left+:16]);
          localparam int LeftDone = LeftTick + ProductTicks;
          localparam int BothDone = (LeftDone > DiffDone) ? LeftDone : DiffDone;
          logic signed [HW:0] h_l;
          logic signed [EdgeSumW-1:0] left_sum;
          logic signed [FactorW-1:0] left_factor;
          logic [((LeftTick-1)/Interval+1)*(EdgeSumW+FactorW)-1:0] operands_q;
          logic [((StartTick-LeftDone)/Interval+1)*FDiffW-1:0] f_left_q;
          logic [((SlopeTick-BothDone-1)/Interval+1)*NumW-1:0] num_q;
          logic [FDiffW-1:0] f_left, f_right, f_start;
          assign factor = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & right[EndW-1], right});
          assign left_factor = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & left[EndW-1], left});
          assign h_l = $signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_l_i[HW-1], h_l_i});
          assign left_sum = (EdgeSumW'(h_l) <<< (EdgeSumFrac - bitspan_cfg_pkg::EdgeHFrac)) + b_sum;
          row_hold #(
              .Width(EdgeSumW + FactorW),
              .Written(1),
              .Last(LeftTick)
          ) u_operands (
              .clk_i,
              .en_i(en),
              .phase_i(phase_q),
              .d_i({left_sum, left_factor}),
              .q_o(operands_q)
          );
          row_product #(
              .Product(Left),
              .Last(StartTick),
              .AW(EdgeSumW),
              .ASigned(1),
              .BW(FactorW),
              .BSigned(1),
              .OutW(bitspan_cfg_pkg::SpanFDiffW),
              .OutFrac(bitspan_cfg_pkg::SpanFDiffFrac),
              .OutSigned(bitspan_cfg_pkg::SpanFDiffSigned),
              .OutRnd(bitspan_cfg_pkg::SpanFDiffRnd),
              .OutOvf(bitspan_cfg_pkg::SpanFDiffOvf),
              .ShiftW(ShiftW)
          ) u_f_left (
              .clk_i,
              .en_i(en),
              .phase_i(phase_q),
              .a_i(operands_q[(LeftTick-1)/Interval*(EdgeSumW+FactorW)+FactorW+:EdgeSumW]),
              .b_i(operands_q[(LeftTick-1)/Interval*(EdgeSumW+FactorW)+:FactorW]),
              .e_i('0),
              .c_i('0),
              .a_o(a[Left*AW+:AW]),
              .b_o(b[Left*BW+:BW]),
              .c_o(c[Left*CW+:CW]),
              .shift_o(shift[Left*ShiftW+:ShiftW]),
              .sum_i(sum[Left*SumW+:SumW]),
              .q_o(f_left_q)
          );
          assign f_left = f_left_q[(BothDone-LeftDone)/Interval*FDiffW+:FDiffW];
          assign f_right = f_diff_q[(BothDone-DiffDone)/Interval*FDiffW+:FDiffW];
          row_hold #(
              .Width(NumW),
              .Written(BothDone + 1),
              .Last(SlopeTick)
          ) u_num (
              .clk_i,
              .en_i(en),
              .phase_i(phase_q),
              .d_i({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & f_right[FDiffW-1], f_right} -
                   {(bitspan_cfg_pkg::SpanFDiffSigned != 0) & f_left[FDiffW-1], f_left}),
              .q_o(num_q)
          );
          assign num = num_q[(SlopeTick-BothDone-1)/Interval*NumW+:NumW];
          assign f_start = f_left_q[(StartTick-LeftDone)/Interval*FDiffW+:FDiffW];
          assign base =
              (CW'($signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & f_start[FDiffW-1], f_start})) <<<
              (bitspan_cfg_pkg::TexAccFrac + bitspan_cfg_pkg::RowSumBelow - bitspan_cfg_pkg::SpanFDiffFrac)) +
              Offset;
          assign res_uv1[T*UvW+:UvW] = '0;
          logic unused_held;
          assign unused_held = ^{operands_q, f_left_q, num_q};
        end else begin : gen_delta_f
          logic [FDiffW-1:0] f_diff;
          assign factor = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & right[EndW-1], right}) -
                          $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & left[EndW-1], left});
          assign f_diff = f_diff_q[(SlopeTick-DiffDone)/Interval*FDiffW+:FDiffW];
          assign num = FExtW'($signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & f_diff[FDiffW-1], f_diff}));
          assign base = Offset;
          assign res_uv1[T*UvW+:UvW] = through_q[(Latency-1)/Interval*ThroughW+2*IndexW+T*UvW+:UvW];
        end
      end
      logic [2*AW-1:0] line_a;
      logic [2*BW-1:0] line_b;
      logic [2*CW-1:0] line_c;
      logic [2*ShiftW-1:0] line_shift;
      row_line #(
          .Line(i),
          .NW(NumW),
          .ShiftW(ShiftW)
      ) u_line (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .phase_i(phase_q),
          .n_i(num),
          .m_i(recip_q[RecipAt*RecipW+EW+:MW]),
          .e_i(recip_q[RecipAt*RecipW+:EW]),
          .start_i(divide_start),
          .d_i(divisor),
          .has_length_i(has_length),
          .p_i(p_q[(StartTick-1)/Interval*PW+:PW]),
          .c_i(base),
          .a_o(line_a),
          .b_o(line_b),
          .c_o(line_c),
          .shift_o(line_shift),
          .sum_i({sum[Start*SumW+:SumW], sum[Slope*SumW+:SumW]}),
          .step_o(res_step[SlopeAt+:SlopeW]),
          .q_o(res_start[StartAt+:StartW])
      );
      for (genvar s = Divides ? 1 : 0; s < 2; s++) begin : gen_place
        localparam int K = (s == 0) ? Slope : Start;
        assign a[K*AW+:AW] = line_a[s*AW+:AW];
        assign b[K*BW+:BW] = line_b[s*BW+:BW];
        assign c[K*CW+:CW] = line_c[s*CW+:CW];
        assign shift[K*ShiftW+:ShiftW] = line_shift[s*ShiftW+:ShiftW];
      end
      logic unused;
      assign unused = ^{line_a, line_b, line_c, line_shift};
    end
    if (!Shades) begin : gen_no_shades
      logic unused;
      assign unused = ^{shade_l_i, shade_r_i};
    end

    logic [IndexW-1:0] res_x, res_count;
    assign {res_count, res_x} = through_q[(Latency-1)/Interval*ThroughW+:2*IndexW];
    logic [bitspan_cfg_pkg::PhaseW+bitspan_cfg_pkg::PlaneKW-1:0] res_line;
    if (LineW > 0) begin : gen_res_line
      assign res_line = through_q[(Latency-1)/Interval*ThroughW+LineAt+:LineW];
    end else begin : gen_no_line
      assign res_line = '0;
    end
    assign res_o = {
      res_step[bitspan_cfg_pkg::LinesStepW-1:HStepW],
      res_step,
      res_start,
      res_uv1,
      res_f_diff,
      res_line,
      res_recip,
      res_count,
      res_x
    };

    logic unused;
    assign unused = ^{phase_i, k_i, h_i, gu_i, gv_i, gu_step0_i, gu_step1_i, gv_step0_i, gv_step1_i, shade_i,
                      shade_step0_i, shade_step1_i, h_sum_q, length_q, positive_q, p_q, through_q,
                      recip_q, divide_start, has_length, divisor};
  end else begin : gen_const_depth_rows
    localparam int HW = bitspan_cfg_pkg::SpanHW;
    localparam int FW = bitspan_cfg_pkg::SpanFW;
    localparam int GStepW = bitspan_cfg_pkg::SpanFStepW;
    localparam int SpanSumW = bitspan_cfg_pkg::SpanSumW;

    // Tick 0: h + B.
    logic [SpanSumW-2:0] h_sum;
    depth_operand #(
        .HW(HW),
        .HFrac(bitspan_cfg_pkg::SpanHFrac),
        .HSigned(bitspan_cfg_pkg::SpanHSigned),
        .BW(bitspan_cfg_pkg::SetupBW),
        .BFrac(bitspan_cfg_pkg::SetupBFrac),
        .BSigned(bitspan_cfg_pkg::SetupBSigned),
        .SumW(SpanSumW),
        .SumFrac(bitspan_cfg_pkg::SpanSumFrac)
    ) u_h_sum (
        .h_i,
        .b_i,
        .operand_o(h_sum)
    );
    // What goes through; shades and channels are ready as they come, and stand above the rest.
    localparam int PlainAccW = HW + 2 * AccW;
    localparam int PlainStepW = HStepW + 2 * StepW;
    localparam int OwnAccW = bitspan_cfg_pkg::LinesAccW - PlainAccW;
    localparam int OwnStepW = bitspan_cfg_pkg::LinesStepW - PlainStepW;
    localparam int PlainThroughW = 2 * IndexW + bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + HW;
    localparam int ThroughW = PlainThroughW + OwnAccW + 2 * OwnStepW;
    logic [ThroughW-1:0] through;
    logic [((Latency-1)/Interval+1)*ThroughW-1:0] through_q;
    row_hold #(
        .Width(bitspan_cfg_pkg::RowRecipOpW),
        .Written(1),
        .Last(1)
    ) u_operand (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(h_sum),
        .q_o(operand)
    );
    row_hold #(
        .Width(ThroughW),
        .Written(1),
        .Last(Latency)
    ) u_through (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(through),
        .q_o(through_q)
    );
    assign has_recip = 1'b1;

    // The row's one reciprocal makes everything linear in u, v: fu and fv, and the steps where the digital line stays on
    // its row (0) and where it changes (1).
    logic [2*AccW-1:0] res_f;
    for (genvar i = 0; i < 2; i++) begin : gen_uv
      localparam int Line = bitspan_cfg_pkg::LineFu + i;
      localparam int Start = bitspan_cfg_pkg::LineStart[32*Line+:32];
      localparam int Tick = 32'(bitspan_cfg_pkg::RowTicks[16*Start+:16]);
      localparam int Done = Tick + ProductTicks;
      logic [((Tick-1)/Interval+1)*FW-1:0] g_q;
      logic [((Latency-Done)/Interval+1)*AccW-1:0] f_q;
      logic [MW-1:0] m;
      logic [EW-1:0] e;
      assign {m, e} = recip_q[(Tick-RecipTick)/Interval*RecipW+:RecipW];
      logic [FW-1:0] g;
      assign g = (i == 0) ? gu_i : gv_i;
      row_hold #(
          .Width(FW),
          .Written(1),
          .Last(Tick)
      ) u_g (
          .clk_i,
          .en_i(en),
          .phase_i(phase_q),
          .d_i(g),
          .q_o(g_q)
      );
      row_product #(
          .Product(Start),
          .Last(Latency),
          .AW(FW),
          .ASigned(bitspan_cfg_pkg::SpanFSigned),
          .BW(MW),
          .BSigned(bitspan_cfg_pkg::RowRecipOutSigned),
          .OutW(bitspan_cfg_pkg::TexAccW),
          .OutFrac(bitspan_cfg_pkg::TexAccFrac),
          .OutSigned(bitspan_cfg_pkg::TexAccSigned),
          .OutRnd(bitspan_cfg_pkg::TexAccRnd),
          .OutOvf(bitspan_cfg_pkg::TexAccOvf),
          .ShiftW(ShiftW)
      ) u_f (
          .clk_i,
          .en_i(en),
          .phase_i(phase_q),
          .a_i(g_q[(Tick-1)/Interval*FW+:FW]),
          .b_i(m),
          .e_i(e),
          .c_i(bitspan_cfg_pkg::LineOffset[Line*CW+:CW]),
          .a_o(a[Start*AW+:AW]),
          .b_o(b[Start*BW+:BW]),
          .c_o(c[Start*CW+:CW]),
          .shift_o(shift[Start*ShiftW+:ShiftW]),
          .sum_i(sum[Start*SumW+:SumW]),
          .q_o(f_q)
      );
      assign res_f[i*AccW+:AccW] = f_q[(Latency-Done)/Interval*AccW+:AccW];
      logic unused;
      assign unused = ^{g_q, f_q};
    end
    logic [4*StepW-1:0] res_f_step;
    for (genvar i = 0; i < 4; i++) begin : gen_step
      localparam int Line = bitspan_cfg_pkg::LineFu + i % 2;
      localparam int Step = (i < 2) ? bitspan_cfg_pkg::LineSlope[32*Line+:32] : bitspan_cfg_pkg::LineSlope1[32*Line+:32];
      localparam int Tick = 32'(bitspan_cfg_pkg::RowTicks[16*Step+:16]);
      localparam int Done = Tick + ProductTicks;
      logic [((Tick-1)/Interval+1)*GStepW-1:0] g_q;
      logic [((Latency-Done)/Interval+1)*StepW-1:0] f_q;
      logic [MW-1:0] m;
      logic [EW-1:0] e;
      assign {m, e} = recip_q[(Tick-RecipTick)/Interval*RecipW+:RecipW];
      logic [GStepW-1:0] g;
      assign g = (i == 0) ? gu_step0_i : (i == 1) ? gv_step0_i : (i == 2) ? gu_step1_i : gv_step1_i;
      row_hold #(
          .Width(GStepW),
          .Written(1),
          .Last(Tick)
      ) u_g (
          .clk_i,
          .en_i(en),
          .phase_i(phase_q),
          .d_i(g),
          .q_o(g_q)
      );
      row_product #(
          .Product(Step),
          .Last(Latency),
          .AW(GStepW),
          .ASigned(bitspan_cfg_pkg::SpanFStepSigned),
          .BW(MW),
          .BSigned(bitspan_cfg_pkg::RowRecipOutSigned),
          .OutW(bitspan_cfg_pkg::TexStepW),
          .OutFrac(bitspan_cfg_pkg::TexStepFrac),
          .OutSigned(bitspan_cfg_pkg::TexStepSigned),
          .OutRnd(bitspan_cfg_pkg::TexStepRnd),
          .OutOvf(bitspan_cfg_pkg::TexStepOvf),
          .ShiftW(ShiftW)
      ) u_f (
          .clk_i,
          .en_i(en),
          .phase_i(phase_q),
          .a_i(g_q[(Tick-1)/Interval*GStepW+:GStepW]),
          .b_i(m),
          .e_i(e),
          .c_i('0),
          .a_o(a[Step*AW+:AW]),
          .b_o(b[Step*BW+:BW]),
          .c_o(c[Step*CW+:CW]),
          .shift_o(shift[Step*ShiftW+:ShiftW]),
          .sum_i(sum[Step*SumW+:SumW]),
          .q_o(f_q)
      );
      assign res_f_step[i*StepW+:StepW] = f_q[(Latency-Done)/Interval*StepW+:StepW];
      logic unused;
      assign unused = ^{g_q, f_q};
    end

    // The lines: h, fu and fv, and above them those that go through.
    logic [IndexW-1:0] res_x, res_count;
    logic [bitspan_cfg_pkg::PhaseW-1:0] res_phase;
    logic [bitspan_cfg_pkg::PlaneKW-1:0] res_k;
    logic [HW-1:0] res_h;
    logic [bitspan_cfg_pkg::LinesAccW-1:0] res_start;
    logic [bitspan_cfg_pkg::LinesStepW-1:0] res_step0;
    logic [bitspan_cfg_pkg::LinesStep1W-1:0] res_step1;
    assign through[PlainThroughW-1:0] = {h_i, k_i, phase_i, count_i, x_first_i};
    assign {res_h, res_k, res_phase, res_count, res_x} = through_q[(Latency-1)/Interval*ThroughW+:PlainThroughW];
    assign res_start[PlainAccW-1:0] = {res_f, res_h};
    assign res_step0[PlainStepW-1:0] = {res_f_step[0+:2*StepW], {HStepW{1'b0}}};
    assign res_step1[2*StepW-1:0] = res_f_step[2*StepW+:2*StepW];
    if (OwnAccW > 0) begin : gen_sides
      assign through[ThroughW-1:PlainThroughW] = {
        shade_step1_i[bitspan_cfg_pkg::SidesStepW-1-:OwnStepW],
        shade_step0_i[bitspan_cfg_pkg::SidesStepW-1-:OwnStepW],
        shade_i[bitspan_cfg_pkg::SidesAccW-1-:OwnAccW]
      };
      assign {res_step1[bitspan_cfg_pkg::LinesStep1W-1:2*StepW], res_step0[bitspan_cfg_pkg::LinesStepW-1:PlainStepW],
              res_start[bitspan_cfg_pkg::LinesAccW-1:PlainAccW]} =
          through_q[(Latency-1)/Interval*ThroughW+PlainThroughW+:OwnAccW+2*OwnStepW];
    end
    if (!Shades) begin : gen_no_shades
      logic unused;
      assign unused = ^{shade_i, shade_step0_i, shade_step1_i};
    end
    assign res_o = {
      res_step1,
      res_step0,
      res_start,
      {2 * bitspan_cfg_pkg::EdgeUvW{1'b0}},
      {2 * bitspan_cfg_pkg::SpanFDiffW{1'b0}},
      res_k,
      res_phase,
      res_recip,
      res_count,
      res_x
    };

    logic unused;
    assign unused = ^{x_l_i, x_r_i, h_l_i, h_r_i, u_l_i, u_r_i, v_l_i, v_r_i, shade_l_i, shade_r_i, through_q, recip_q};
  end

`ifndef SYNTHESIS
  // An offered record has pixels, and does not change or go away before it is taken. B is stable all the while.
  localparam int OfferW = 2 * IndexW + 2 * bitspan_cfg_pkg::EdgeXW + 2 * bitspan_cfg_pkg::EdgeHW +
      4 * bitspan_cfg_pkg::EdgeUvW + bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + bitspan_cfg_pkg::SpanHW +
      2 * bitspan_cfg_pkg::SpanFW + 4 * bitspan_cfg_pkg::SpanFStepW +
      ((bitspan_cfg_pkg::Lines > 3) ?
       2 * bitspan_cfg_pkg::SidesEndW + bitspan_cfg_pkg::SidesAccW + 2 * bitspan_cfg_pkg::SidesStepW : 0);
  logic offered_q;
  logic [OfferW-1:0] offer, offer_q;
  logic [bitspan_cfg_pkg::SetupBW-1:0] b_q;
  assign offer = OfferW'({shade_l_i, shade_r_i, shade_i, shade_step0_i, shade_step1_i, x_first_i, count_i, x_l_i, x_r_i,
                          h_l_i, h_r_i, u_l_i, u_r_i, v_l_i, v_r_i, phase_i, k_i, h_i, gu_i, gv_i, gu_step0_i,
                          gu_step1_i, gv_step0_i, gv_step1_i});
  always @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      offered_q <= 1'b0;
      offer_q <= '0;
      b_q <= '0;
    end else begin
      if (in_valid_i) begin
        assert (count_i != '0)
        else $fatal(1, "span_setup: a record without pixels");
      end
      if (offered_q) begin
        assert (in_valid_i && offer_q == offer)
        else $fatal(1, "span_setup: an offered record was changed or withdrawn");
      end
      if (|row_valid_q) begin
        assert (b_q == b_i)
        else $fatal(1, "span_setup: B was changed while a row was inside");
      end
      offered_q <= in_valid_i && !in_ready_o;
      offer_q <= offer;
      b_q <= b_i;
    end
  end
`endif
endmodule
