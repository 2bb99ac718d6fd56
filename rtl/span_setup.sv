// SPDX-License-Identifier: Apache-2.0
// span_setup of docs/numeric-spec.md: takes a row's ends (delta_f) or a plane row (const_depth_rows), delivers a span
// record.
//
// Time is counted in ticks: clocks on which res_ready_i lets span_setup go on. A row is accepted on ticks that are
// multiples of RowInterval, and tick t of a row is the t-th tick after that of its acceptance. The package says at
// which tick each product has a multiplier, so that rows RowInterval ticks apart never meet in one:
//
//   tick 0   the row's ends
//   tick 1   delta_f: L = x_r - x_l, differences, h + B; const_depth_rows: h + B. The row unit starts.
//            products with the differences, then with the row's reciprocal, then with the pre-step p
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
    // delta_f: the row's ends; ignored in const_depth_rows.
    input  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_l_i,
    input  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_r_i,
    input  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_l_i,
    input  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_r_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_l_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_r_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_l_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_r_i,
    // const_depth_rows: the plane row; ignored in delta_f.
    input  logic [bitspan_cfg_pkg::PhaseW-1:0] phase_i,
    input  logic [bitspan_cfg_pkg::PlaneKW-1:0] k_i,
    input  logic [bitspan_cfg_pkg::SpanHW-1:0] h_i,
    input  logic [bitspan_cfg_pkg::SpanFW-1:0] gu_i,
    input  logic [bitspan_cfg_pkg::SpanFW-1:0] gv_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step0_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step1_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step0_i,
    input  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step1_i,
    // The span record; it is delivered where res_valid_o and res_ready_i are both 1, and res_ready_i 0 stops all.
    output logic res_valid_o,
    input  logic res_ready_i,
    output logic [bitspan_cfg_pkg::SpanRecordW-1:0] res_o
);
  localparam int IndexW = bitspan_cfg_pkg::PixelIndexW;
  localparam int Interval = bitspan_cfg_pkg::RowInterval;
  localparam int PhaseW = (Interval > 1) ? $clog2(Interval) : 1;
  localparam int Latency = bitspan_cfg_pkg::SpanSetupClocks;
  localparam int RecipTick = bitspan_cfg_pkg::RowRecipTick;
  localparam int MW = bitspan_cfg_pkg::RowRecipOutW;
  localparam int EW = bitspan_cfg_pkg::ExponentW;
  localparam int AccW = bitspan_cfg_pkg::TexAccW;
  localparam int StepW = bitspan_cfg_pkg::TexStepW;

  // The tick modulo RowInterval, and which rows are valid: row_valid_q[k] is that of ticks 1 + k RowInterval on.
  logic en;
  logic [PhaseW-1:0] phase_q;
  assign en = res_ready_i;
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

  // Products. Each has an operand of each kind, and a register at tick Tick + RowProductTicks.
  localparam int AW = bitspan_cfg_pkg::RowAW;
  localparam int BW = bitspan_cfg_pkg::RowBW;
  localparam int CW = bitspan_cfg_pkg::RowCW;
  localparam int SumW = bitspan_cfg_pkg::RowSumW;
  localparam int Below = bitspan_cfg_pkg::RowSumBelow;
  localparam int Multipliers = bitspan_cfg_pkg::RowMultipliers;
  localparam int ProductTicks = bitspan_cfg_pkg::RowProductTicks;
  localparam int ShiftMax = bitspan_cfg_pkg::RowShiftMax;
  localparam int ShiftW = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1;
  localparam int Products = bitspan_cfg_pkg::RowProducts;
  logic [Products*AW-1:0] a;
  logic [Products*BW-1:0] b;
  logic [Products*CW-1:0] c;
  logic [Products*ShiftW-1:0] shift;
  logic [Products*SumW-1:0] sum;
  logic [Products-1:0] sticky, far, sign;
  for (genvar m = 0; m < Multipliers; m++) begin : gen_multiplier
    // The product that has the multiplier at the next tick, and at this one.
    logic [Products-1:0] next, now_q;
    logic signed [SumW-1:0] sum_m;
    logic sticky_m, far_m, sign_m;
    always_comb begin
      for (int k = 0; k < Products; k++) begin
        next[k] = bitspan_cfg_pkg::RowMultiplierOf[16*k+:16] == 16'(m) &&
            (32'(bitspan_cfg_pkg::RowTicks[16*k+:16]) + Interval - 1) % Interval == 32'(phase_q);
      end
    end
    always_ff @(posedge clk_i) begin
      if (en) now_q <= next;
    end
    for (genvar k = 0; k < Products; k++) begin : gen_product
      if (bitspan_cfg_pkg::RowMultiplierOf[16*k+:16] == 16'(m)) begin : gen_mine
        assign sum[k*SumW+:SumW] = sum_m;
        assign sticky[k] = sticky_m;
        assign far[k] = far_m;
        assign sign[k] = sign_m;
      end
    end
    setup_mac #(
        .Products(Products),
        .AW(AW),
        .BW(BW),
        .CW(CW),
        .SumW(SumW),
        .ShiftBase(bitspan_cfg_pkg::RowShiftBase),
        .ShiftMax(ShiftMax),
        .ProductClocks(bitspan_cfg_pkg::ProductClocks)
    ) u_mac (
        .clk_i,
        .en_i(en),
        .select_i(now_q),
        .a_i(a),
        .b_i(b),
        .c_i(c),
        .shift_i(shift),
        .sum_o(sum_m),
        .sticky_o(sticky_m),
        .far_o(far_m),
        .sign_o(sign_m)
    );
  end
  for (genvar k = 0; k < Products; k++) begin : gen_none
    if (bitspan_cfg_pkg::RowMultiplierOf[16*k+:16] == 16'hffff) begin : gen_no_product
      assign sum[k*SumW+:SumW] = '0;
      assign {sticky[k], far[k], sign[k]} = '0;
    end
  end

  // The row's reciprocal, held from RecipTick on; the mantissa with a sign.
  logic [bitspan_cfg_pkg::RowRecipOpW-1:0] operand;
  logic start;
  logic [MW-1:0] unit_m;
  logic [EW-1:0] unit_e;
  assign start = row_valid_q[0] && phase_q == PhaseW'(1 % Interval);
  if (bitspan_cfg_pkg::RowSlopeDivide == 0) begin : gen_reciprocal
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
        .ProductClocks(bitspan_cfg_pkg::ProductClocks),
        .Clocks(bitspan_cfg_pkg::RowUnitClocks),
        .Table(bitspan_cfg_pkg::RowRecipTable)
    ) u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .start_i(start),
        .d_i(operand),
        .m_o(unit_m),
        .e_o(unit_e)
    );
  end else begin : gen_no_reciprocal
    assign unit_m = '0;
    assign unit_e = '0;
  end

  if (bitspan_cfg_pkg::ConstDepthRows == 0) begin : gen_delta_f
    localparam int XW = bitspan_cfg_pkg::EdgeXW;
    localparam int HW = bitspan_cfg_pkg::EdgeHW;
    localparam int UvW = bitspan_cfg_pkg::EdgeUvW;
    localparam int FDiffW = bitspan_cfg_pkg::SpanFDiffW;
    localparam int HStepW = bitspan_cfg_pkg::SpanHStepW;
    localparam int StartHW = bitspan_cfg_pkg::SpanHW;
    localparam int EdgeSumW = bitspan_cfg_pkg::EdgeSumW;
    localparam int EdgeSumFrac = bitspan_cfg_pkg::EdgeSumFrac;
    localparam int PW = bitspan_cfg_pkg::PreStepW;
    localparam int PFrac = bitspan_cfg_pkg::PreStepFrac;
    localparam bit Divides = bitspan_cfg_pkg::RowSlopeDivide != 0;
    localparam int DivideTick = bitspan_cfg_pkg::RowDivideTick;
    localparam int FuDiffTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFuDiff+:16]);
    localparam int FvDiffTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFvDiff+:16]);
    localparam int HTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowH+:16]);
    localparam int FuTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFu+:16]);
    localparam int FvTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFv+:16]);
    localparam int FuDiffDone = FuDiffTick + ProductTicks;
    localparam int FvDiffDone = FvDiffTick + ProductTicks;
    localparam int HDone = HTick + ProductTicks;
    localparam int FuDone = FuTick + ProductTicks;
    localparam int FvDone = FvTick + ProductTicks;
    // Slopes come from the multipliers, or all at once from the dividers.
    localparam int HStepTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowHStep+:16]);
    localparam int FuStepTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFuStep+:16]);
    localparam int FvStepTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFvStep+:16]);
    localparam int DivideDone = DivideTick + bitspan_cfg_pkg::RowUnitClocks + 1;
    localparam int HStepDone = Divides ? DivideDone : HStepTick + ProductTicks;
    localparam int FuStepDone = Divides ? DivideDone : FuStepTick + ProductTicks;
    localparam int FvStepDone = Divides ? DivideDone : FvStepTick + ProductTicks;
    localparam int HDiffRead = Divides ? DivideTick : HStepTick;
    localparam int FuDiffRead = Divides ? DivideTick : FuStepTick;
    localparam int FvDiffRead = Divides ? DivideTick : FvStepTick;

    // Tick 0: differences, h + B, and the pre-step. Each is exact: one bit more than its terms.
    logic signed [XW:0] x_l, x_r, length;
    logic signed [HW:0] h_l, h_r, h_diff;
    logic signed [UvW:0] u_l, u_r, v_l, v_r, u_diff, v_diff;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b_ext;
    logic signed [EdgeSumW-1:0] h_sum;
    logic signed [PW-1:0] p;
    logic positive;
    assign x_l = $signed({(bitspan_cfg_pkg::EdgeXSigned != 0) & x_l_i[XW-1], x_l_i});
    assign x_r = $signed({(bitspan_cfg_pkg::EdgeXSigned != 0) & x_r_i[XW-1], x_r_i});
    assign h_l = $signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_l_i[HW-1], h_l_i});
    assign h_r = $signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_r_i[HW-1], h_r_i});
    assign u_l = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & u_l_i[UvW-1], u_l_i});
    assign u_r = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & u_r_i[UvW-1], u_r_i});
    assign v_l = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & v_l_i[UvW-1], v_l_i});
    assign v_r = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & v_r_i[UvW-1], v_r_i});
    assign b_ext = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign length = x_r - x_l;
    assign positive = !length[XW] && (length != '0);
    assign h_diff = h_r - h_l;
    assign u_diff = u_r - u_l;
    assign v_diff = v_r - v_l;
    assign h_sum = (EdgeSumW'(h_r) <<< (EdgeSumFrac - bitspan_cfg_pkg::EdgeHFrac)) +
                   (EdgeSumW'(b_ext) <<< (EdgeSumFrac - bitspan_cfg_pkg::SetupBFrac));
    assign p = $signed({PW'(x_first_i) << PFrac}) + (PW'(1) << (PFrac - 1)) -
               (PW'(x_l) <<< (PFrac - bitspan_cfg_pkg::EdgeXFrac));

    // Held as long as somebody reads them; ..._q at place (tick - 1) / Interval.
    localparam int SumRead = (FuDiffTick > FvDiffTick) ? FuDiffTick : FvDiffTick;
    localparam int StepRead = Divides ? DivideDone : RecipTick;
    localparam int ReadP1 = (HTick > FuTick) ? HTick : FuTick;
    localparam int ReadP = (ReadP1 > FvTick) ? ReadP1 : FvTick;
    localparam int DiffW = EdgeSumW + 2 * (UvW + 1);
    localparam int LengthRead = Divides ? DivideTick : 1;
    logic [((SumRead-1)/Interval+1)*DiffW-1:0] diff_q;
    logic [((HDiffRead-1)/Interval+1)*(HW+1)-1:0] h_diff_q;
    logic [((LengthRead-1)/Interval+1)*XW-1:0] length_q;
    logic [((StepRead-1)/Interval+1)-1:0] positive_q;
    logic [((ReadP-1)/Interval+1)*PW-1:0] p_q;
    logic [((HTick-1)/Interval+1)*HW-1:0] h_l_q;
    logic [((Latency-1)/Interval+1)*(2*IndexW+2*UvW)-1:0] through_q;
    row_hold #(
        .Width(DiffW), .Interval(Interval), .Written(1), .Last(SumRead), .PhaseW(PhaseW)
    ) u_diff_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i({h_sum, u_diff, v_diff}), .q_o(diff_q)
    );
    row_hold #(
        .Width(HW + 1), .Interval(Interval), .Written(1), .Last(HDiffRead), .PhaseW(PhaseW)
    ) u_h_diff_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(h_diff), .q_o(h_diff_q)
    );
    row_hold #(
        .Width(XW), .Interval(Interval), .Written(1), .Last(LengthRead), .PhaseW(PhaseW)
    ) u_length_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(length[XW-1:0] & {XW{positive}}), .q_o(length_q)
    );
    row_hold #(
        .Width(1), .Interval(Interval), .Written(1), .Last(StepRead), .PhaseW(PhaseW)
    ) u_positive_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(positive), .q_o(positive_q)
    );
    row_hold #(
        .Width(PW), .Interval(Interval), .Written(1), .Last(ReadP), .PhaseW(PhaseW)
    ) u_p_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(p), .q_o(p_q)
    );
    row_hold #(
        .Width(HW), .Interval(Interval), .Written(1), .Last(HTick), .PhaseW(PhaseW)
    ) u_h_l_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(h_l_i), .q_o(h_l_q)
    );
    row_hold #(
        .Width(2 * IndexW + 2 * UvW), .Interval(Interval), .Written(1), .Last(Latency), .PhaseW(PhaseW)
    ) u_through_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i({x_first_i, count_i, u_l_i, v_l_i}), .q_o(through_q)
    );
    assign operand = length_q[XW-1:0];

    // Products with the differences.
    logic [((Latency-FuDiffDone)/Interval+1)*FDiffW-1:0] fu_diff_q;
    logic [((Latency-FvDiffDone)/Interval+1)*FDiffW-1:0] fv_diff_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanFDiffW), .OutFrac(bitspan_cfg_pkg::SpanFDiffFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFDiffSigned), .OutRnd(bitspan_cfg_pkg::SpanFDiffRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFDiffOvf), .Interval(Interval), .Written(FuDiffDone), .Last(Latency),
        .PhaseW(PhaseW)
    ) u_fu_diff_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFuDiff*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFuDiff]), .far_i(far[bitspan_cfg_pkg::RowFuDiff]),
        .sign_i(sign[bitspan_cfg_pkg::RowFuDiff]), .q_o(fu_diff_q)
    );
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanFDiffW), .OutFrac(bitspan_cfg_pkg::SpanFDiffFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFDiffSigned), .OutRnd(bitspan_cfg_pkg::SpanFDiffRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFDiffOvf), .Interval(Interval), .Written(FvDiffDone), .Last(Latency),
        .PhaseW(PhaseW)
    ) u_fv_diff_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFvDiff*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFvDiff]), .far_i(far[bitspan_cfg_pkg::RowFvDiff]),
        .sign_i(sign[bitspan_cfg_pkg::RowFvDiff]), .q_o(fv_diff_q)
    );
    logic [DiffW-1:0] diff_fu, diff_fv;
    logic signed [EdgeSumW-1:0] sum_fu, sum_fv;
    logic signed [UvW:0] u_diff_fu, v_diff_fv, unused_u, unused_v;
    assign diff_fu = diff_q[(FuDiffTick-1)/Interval*DiffW+:DiffW];
    assign diff_fv = diff_q[(FvDiffTick-1)/Interval*DiffW+:DiffW];
    assign {sum_fu, u_diff_fu, unused_v} = diff_fu;
    assign {sum_fv, unused_u, v_diff_fv} = diff_fv;
    assign a[bitspan_cfg_pkg::RowFuDiff*AW+:AW] = AW'(sum_fu);
    assign b[bitspan_cfg_pkg::RowFuDiff*BW+:BW] = BW'(u_diff_fu);
    assign a[bitspan_cfg_pkg::RowFvDiff*AW+:AW] = AW'(sum_fv);
    assign b[bitspan_cfg_pkg::RowFvDiff*BW+:BW] = BW'(v_diff_fv);

    // Slopes. A row without length has none: its reciprocal or its quotients are made 0.
    logic signed [HW:0] h_num;
    logic signed [FDiffW:0] fu_num, fv_num;
    logic [FDiffW-1:0] fu_diff_read, fv_diff_read;
    assign h_num = $signed(h_diff_q[(HDiffRead-1)/Interval*(HW+1)+:HW+1]);
    assign fu_diff_read = fu_diff_q[(FuDiffRead-FuDiffDone)/Interval*FDiffW+:FDiffW];
    assign fv_diff_read = fv_diff_q[(FvDiffRead-FvDiffDone)/Interval*FDiffW+:FDiffW];
    assign fu_num = $signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & fu_diff_read[FDiffW-1], fu_diff_read});
    assign fv_num = $signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & fv_diff_read[FDiffW-1], fv_diff_read});
    logic [((Latency-HStepDone)/Interval+1)*HStepW-1:0] h_step_q;
    logic [((Latency-FuStepDone)/Interval+1)*StepW-1:0] fu_step_q;
    logic [((Latency-FvStepDone)/Interval+1)*StepW-1:0] fv_step_q;
    logic [MW-1:0] res_m;
    logic [EW-1:0] res_e;
    if (Divides) begin : gen_divide
      localparam int QuotientW = bitspan_cfg_pkg::RowDivIterations * bitspan_cfg_pkg::RowRecipBitsPerCycle + 1;
      localparam int FNumW = FDiffW + ((bitspan_cfg_pkg::SpanFDiffSigned != 0) ? 0 : 1);
      localparam int StartRow = (DivideTick - 1) / Interval;
      logic divide_start;
      logic [XW-1:0] divisor;
      assign divide_start = row_valid_q[StartRow] && phase_q == PhaseW'(DivideTick % Interval);
      assign divisor = length_q[StartRow*XW+:XW];
      logic signed [QuotientW-1:0] h_quotient, fu_quotient, fv_quotient;
      logic h_sticky, fu_sticky, fv_sticky;
      divide #(
          .NW(HW + 1),
          .DW(XW),
          .Iterations(bitspan_cfg_pkg::RowDivIterations),
          .BitsPerCycle(bitspan_cfg_pkg::RowRecipBitsPerCycle),
          .Pipelined(bitspan_cfg_pkg::RowRecipPipelined)
      ) u_h_divide (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .start_i(divide_start),
          .n_i(h_num),
          .d_i(divisor),
          .q_o(h_quotient),
          .sticky_o(h_sticky)
      );
      divide #(
          .NW(FNumW),
          .DW(XW),
          .Iterations(bitspan_cfg_pkg::RowDivIterations),
          .BitsPerCycle(bitspan_cfg_pkg::RowRecipBitsPerCycle),
          .Pipelined(bitspan_cfg_pkg::RowRecipPipelined)
      ) u_fu_divide (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .start_i(divide_start),
          .n_i(FNumW'(fu_num)),
          .d_i(divisor),
          .q_o(fu_quotient),
          .sticky_o(fu_sticky)
      );
      divide #(
          .NW(FNumW),
          .DW(XW),
          .Iterations(bitspan_cfg_pkg::RowDivIterations),
          .BitsPerCycle(bitspan_cfg_pkg::RowRecipBitsPerCycle),
          .Pipelined(bitspan_cfg_pkg::RowRecipPipelined)
      ) u_fv_divide (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .start_i(divide_start),
          .n_i(FNumW'(fv_num)),
          .d_i(divisor),
          .q_o(fv_quotient),
          .sticky_o(fv_sticky)
      );
      logic [HStepW-1:0] h_step;
      quantize #(
          .InW(QuotientW),
          .InFrac(bitspan_cfg_pkg::RowDivHFrac),
          .OutW(HStepW),
          .OutFrac(bitspan_cfg_pkg::SpanHStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanHStepSigned),
          .Rounding(bitspan_cfg_pkg::SpanHStepRnd),
          .Overflow(bitspan_cfg_pkg::SpanHStepOvf)
      ) u_h_step (
          .x_i(h_quotient),
          .sticky_i(h_sticky),
          .q_o(h_step)
      );
      row_hold #(
          .Width(HStepW), .Interval(Interval), .Written(HStepDone), .Last(Latency), .PhaseW(PhaseW)
      ) u_h_step_q (
          .clk_i, .en_i(en), .phase_i(phase_q), .d_i(h_step & {HStepW {positive_q[(HStepDone-2)/Interval]}}),
          .q_o(h_step_q)
      );
      logic [StepW-1:0] fu_step;
      quantize #(
          .InW(QuotientW),
          .InFrac(bitspan_cfg_pkg::RowDivFFrac),
          .OutW(StepW),
          .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
          .Rounding(bitspan_cfg_pkg::SpanFStepRnd),
          .Overflow(bitspan_cfg_pkg::SpanFStepOvf)
      ) u_fu_step (
          .x_i(fu_quotient),
          .sticky_i(fu_sticky),
          .q_o(fu_step)
      );
      row_hold #(
          .Width(StepW), .Interval(Interval), .Written(FuStepDone), .Last(Latency), .PhaseW(PhaseW)
      ) u_fu_step_q (
          .clk_i, .en_i(en), .phase_i(phase_q), .d_i(fu_step & {StepW {positive_q[(FuStepDone-2)/Interval]}}),
          .q_o(fu_step_q)
      );
      logic [StepW-1:0] fv_step;
      quantize #(
          .InW(QuotientW),
          .InFrac(bitspan_cfg_pkg::RowDivFFrac),
          .OutW(StepW),
          .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
          .Rounding(bitspan_cfg_pkg::SpanFStepRnd),
          .Overflow(bitspan_cfg_pkg::SpanFStepOvf)
      ) u_fv_step (
          .x_i(fv_quotient),
          .sticky_i(fv_sticky),
          .q_o(fv_step)
      );
      row_hold #(
          .Width(StepW), .Interval(Interval), .Written(FvStepDone), .Last(Latency), .PhaseW(PhaseW)
      ) u_fv_step_q (
          .clk_i, .en_i(en), .phase_i(phase_q), .d_i(fv_step & {StepW {positive_q[(FvStepDone-2)/Interval]}}),
          .q_o(fv_step_q)
      );
      assign a[bitspan_cfg_pkg::RowHStep*AW+:AW] = '0;
      assign b[bitspan_cfg_pkg::RowHStep*BW+:BW] = '0;
      assign a[bitspan_cfg_pkg::RowFuStep*AW+:AW] = '0;
      assign b[bitspan_cfg_pkg::RowFuStep*BW+:BW] = '0;
      assign a[bitspan_cfg_pkg::RowFvStep*AW+:AW] = '0;
      assign b[bitspan_cfg_pkg::RowFvStep*BW+:BW] = '0;
      assign shift[bitspan_cfg_pkg::RowHStep*ShiftW+:ShiftW] = '0;
      assign shift[bitspan_cfg_pkg::RowFuStep*ShiftW+:ShiftW] = '0;
      assign shift[bitspan_cfg_pkg::RowFvStep*ShiftW+:ShiftW] = '0;
      assign res_m = '0;
      assign res_e = '0;
      logic unused_divide;
      assign unused_divide = ^{unit_m, unit_e, start};
    end else begin : gen_product
      logic [((Latency-RecipTick)/Interval+1)*(MW+EW)-1:0] recip_q;
      // A row without length has m = e = 0, and with them no slopes. A mask, since a choice of 0 would become a
      // synchronous reset beside an enable, which costs more.
      row_hold #(
          .Width(MW + EW), .Interval(Interval), .Written(RecipTick), .Last(Latency), .PhaseW(PhaseW)
      ) u_recip_q (
          .clk_i, .en_i(en), .phase_i(phase_q),
          .d_i({unit_m, unit_e} & {(MW + EW) {positive_q[(RecipTick-2)/Interval]}}), .q_o(recip_q)
      );
      logic [MW-1:0] h_m;
      logic [EW-1:0] h_e;
      assign {h_m, h_e} = recip_q[(HStepTick-RecipTick)/Interval*(MW+EW)+:MW+EW];
      assign a[bitspan_cfg_pkg::RowHStep*AW+:AW] = AW'(h_num);
      assign b[bitspan_cfg_pkg::RowHStep*BW+:BW] =
          BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & h_m[MW-1], h_m}));
      assign shift[bitspan_cfg_pkg::RowHStep*ShiftW+:ShiftW] =
          ShiftW'(16'($signed(h_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowHStep+:16]);
      logic [MW-1:0] fu_m;
      logic [EW-1:0] fu_e;
      assign {fu_m, fu_e} = recip_q[(FuStepTick-RecipTick)/Interval*(MW+EW)+:MW+EW];
      assign a[bitspan_cfg_pkg::RowFuStep*AW+:AW] = AW'(fu_num);
      assign b[bitspan_cfg_pkg::RowFuStep*BW+:BW] =
          BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & fu_m[MW-1], fu_m}));
      assign shift[bitspan_cfg_pkg::RowFuStep*ShiftW+:ShiftW] =
          ShiftW'(16'($signed(fu_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFuStep+:16]);
      logic [MW-1:0] fv_m;
      logic [EW-1:0] fv_e;
      assign {fv_m, fv_e} = recip_q[(FvStepTick-RecipTick)/Interval*(MW+EW)+:MW+EW];
      assign a[bitspan_cfg_pkg::RowFvStep*AW+:AW] = AW'(fv_num);
      assign b[bitspan_cfg_pkg::RowFvStep*BW+:BW] =
          BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & fv_m[MW-1], fv_m}));
      assign shift[bitspan_cfg_pkg::RowFvStep*ShiftW+:ShiftW] =
          ShiftW'(16'($signed(fv_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFvStep+:16]);
      row_result #(
          .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanHStepW), .OutFrac(bitspan_cfg_pkg::SpanHStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanHStepSigned), .OutRnd(bitspan_cfg_pkg::SpanHStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanHStepOvf), .Interval(Interval), .Written(HStepDone), .Last(Latency),
          .PhaseW(PhaseW)
      ) u_h_step_q (
          .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowHStep*SumW+:SumW]),
          .sticky_i(sticky[bitspan_cfg_pkg::RowHStep]), .far_i(far[bitspan_cfg_pkg::RowHStep]),
          .sign_i(sign[bitspan_cfg_pkg::RowHStep]), .q_o(h_step_q)
      );
      row_result #(
          .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanFStepW), .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned), .OutRnd(bitspan_cfg_pkg::SpanFStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanFStepOvf), .Interval(Interval), .Written(FuStepDone), .Last(Latency),
          .PhaseW(PhaseW)
      ) u_fu_step_q (
          .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFuStep*SumW+:SumW]),
          .sticky_i(sticky[bitspan_cfg_pkg::RowFuStep]), .far_i(far[bitspan_cfg_pkg::RowFuStep]),
          .sign_i(sign[bitspan_cfg_pkg::RowFuStep]), .q_o(fu_step_q)
      );
      row_result #(
          .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanFStepW), .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned), .OutRnd(bitspan_cfg_pkg::SpanFStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanFStepOvf), .Interval(Interval), .Written(FvStepDone), .Last(Latency),
          .PhaseW(PhaseW)
      ) u_fv_step_q (
          .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFvStep*SumW+:SumW]),
          .sticky_i(sticky[bitspan_cfg_pkg::RowFvStep]), .far_i(far[bitspan_cfg_pkg::RowFvStep]),
          .sign_i(sign[bitspan_cfg_pkg::RowFvStep]), .q_o(fv_step_q)
      );
      logic unused_recip;
      assign unused_recip = ^recip_q;
      assign {res_m, res_e} = recip_q[(Latency-RecipTick)/Interval*(MW+EW)+:MW+EW];
    end

    // Start values at the first pixel's centre.
    localparam int HSumFrac = bitspan_cfg_pkg::SpanHFrac + Below;
    localparam int FSumFrac = bitspan_cfg_pkg::SpanFFrac + Below;
    logic [HStepW-1:0] h_step_read;
    logic [StepW-1:0] fu_step_read, fv_step_read;
    logic [HW-1:0] h_l_read;
    assign h_step_read = h_step_q[(HTick-HStepDone)/Interval*HStepW+:HStepW];
    assign fu_step_read = fu_step_q[(FuTick-FuStepDone)/Interval*StepW+:StepW];
    assign fv_step_read = fv_step_q[(FvTick-FvStepDone)/Interval*StepW+:StepW];
    assign h_l_read = h_l_q[(HTick-1)/Interval*HW+:HW];
    assign a[bitspan_cfg_pkg::RowH*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanHStepSigned != 0) & h_step_read[HStepW-1], h_step_read}));
    assign b[bitspan_cfg_pkg::RowH*BW+:BW] = BW'($signed(p_q[(HTick-1)/Interval*PW+:PW]));
    assign a[bitspan_cfg_pkg::RowFu*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & fu_step_read[StepW-1], fu_step_read}));
    assign b[bitspan_cfg_pkg::RowFu*BW+:BW] = BW'($signed(p_q[(FuTick-1)/Interval*PW+:PW]));
    assign a[bitspan_cfg_pkg::RowFv*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & fv_step_read[StepW-1], fv_step_read}));
    assign b[bitspan_cfg_pkg::RowFv*BW+:BW] = BW'($signed(p_q[(FvTick-1)/Interval*PW+:PW]));
    // Half an ulp where a format rounds half up (row_result).
    localparam logic signed [CW-1:0] Half = CW'(1) <<< (Below - 1);
    localparam logic signed [CW-1:0] HalfFDiff = (bitspan_cfg_pkg::SpanFDiffRnd == 0) ? Half : '0;
    localparam logic signed [CW-1:0] HalfHStep = (bitspan_cfg_pkg::SpanHStepRnd == 0) ? Half : '0;
    localparam logic signed [CW-1:0] HalfFStep = (bitspan_cfg_pkg::SpanFStepRnd == 0) ? Half : '0;
    localparam logic signed [CW-1:0] HalfH = (bitspan_cfg_pkg::SpanHRnd == 0) ? Half : '0;
    localparam logic signed [CW-1:0] HalfF = (bitspan_cfg_pkg::SpanFRnd == 0) ? Half : '0;
    // Grids in the package: every sum holds the bits of the offset and of h_l.
    localparam int OffsetHShift = (bitspan_cfg_pkg::OffsetHRaw == 0) ? 0 : HSumFrac - bitspan_cfg_pkg::OffsetHFrac;
    localparam int OffsetFShift = (bitspan_cfg_pkg::OffsetFRaw == 0) ? 0 : FSumFrac - bitspan_cfg_pkg::OffsetFFrac;
    logic signed [CW-1:0] offset_f;
    assign offset_f = (CW'(bitspan_cfg_pkg::OffsetFRaw) <<< OffsetFShift) + HalfF;
    assign c[bitspan_cfg_pkg::RowH*CW+:CW] =
        (CW'($signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_l_read[HW-1], h_l_read})) <<<
         (HSumFrac - bitspan_cfg_pkg::EdgeHFrac)) + (CW'(bitspan_cfg_pkg::OffsetHRaw) <<< OffsetHShift) + HalfH;
    assign c[bitspan_cfg_pkg::RowFu*CW+:CW] = offset_f;
    assign c[bitspan_cfg_pkg::RowFv*CW+:CW] = offset_f;
    assign c[bitspan_cfg_pkg::RowFuDiff*CW+:CW] = HalfFDiff;
    assign c[bitspan_cfg_pkg::RowFvDiff*CW+:CW] = HalfFDiff;
    assign c[bitspan_cfg_pkg::RowHStep*CW+:CW] = HalfHStep;
    assign c[bitspan_cfg_pkg::RowFuStep*CW+:CW] = HalfFStep;
    assign c[bitspan_cfg_pkg::RowFvStep*CW+:CW] = HalfFStep;
    assign shift[bitspan_cfg_pkg::RowFuDiff*ShiftW+:ShiftW] =
        ShiftW'(bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFuDiff+:16]);
    assign shift[bitspan_cfg_pkg::RowFvDiff*ShiftW+:ShiftW] =
        ShiftW'(bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFvDiff+:16]);
    assign shift[bitspan_cfg_pkg::RowH*ShiftW+:ShiftW] =
        ShiftW'(bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowH+:16]);
    assign shift[bitspan_cfg_pkg::RowFu*ShiftW+:ShiftW] =
        ShiftW'(bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFu+:16]);
    assign shift[bitspan_cfg_pkg::RowFv*ShiftW+:ShiftW] =
        ShiftW'(bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFv+:16]);
    logic [((Latency-HDone)/Interval+1)*StartHW-1:0] h_q;
    logic [((Latency-FuDone)/Interval+1)*AccW-1:0] fu_q;
    logic [((Latency-FvDone)/Interval+1)*AccW-1:0] fv_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanHW), .OutFrac(bitspan_cfg_pkg::SpanHFrac),
        .OutSigned(bitspan_cfg_pkg::SpanHSigned), .OutRnd(bitspan_cfg_pkg::SpanHRnd),
        .OutOvf(bitspan_cfg_pkg::SpanHOvf), .Interval(Interval), .Written(HDone), .Last(Latency), .PhaseW(PhaseW)
    ) u_h_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowH*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowH]), .far_i(far[bitspan_cfg_pkg::RowH]),
        .sign_i(sign[bitspan_cfg_pkg::RowH]), .q_o(h_q)
    );
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanFW), .OutFrac(bitspan_cfg_pkg::SpanFFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFSigned), .OutRnd(bitspan_cfg_pkg::SpanFRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFOvf), .Interval(Interval), .Written(FuDone), .Last(Latency), .PhaseW(PhaseW)
    ) u_fu_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFu*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFu]), .far_i(far[bitspan_cfg_pkg::RowFu]),
        .sign_i(sign[bitspan_cfg_pkg::RowFu]), .q_o(fu_q)
    );
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::SpanFW), .OutFrac(bitspan_cfg_pkg::SpanFFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFSigned), .OutRnd(bitspan_cfg_pkg::SpanFRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFOvf), .Interval(Interval), .Written(FvDone), .Last(Latency), .PhaseW(PhaseW)
    ) u_fv_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFv*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFv]), .far_i(far[bitspan_cfg_pkg::RowFv]),
        .sign_i(sign[bitspan_cfg_pkg::RowFv]), .q_o(fv_q)
    );

    logic [IndexW-1:0] res_x, res_count;
    logic [UvW-1:0] res_u1, res_v1;
    logic [StepW-1:0] res_fu_step, res_fv_step;
    assign {res_x, res_count, res_u1, res_v1} = through_q[(Latency-1)/Interval*(2*IndexW+2*UvW)+:2*IndexW+2*UvW];
    assign res_fu_step = fu_step_q[(Latency-FuStepDone)/Interval*StepW+:StepW];
    assign res_fv_step = fv_step_q[(Latency-FvStepDone)/Interval*StepW+:StepW];
    assign res_o = {
      res_x,
      res_count,
      res_m,
      res_e,
      {bitspan_cfg_pkg::PhaseW{1'b0}},
      {bitspan_cfg_pkg::PlaneKW{1'b0}},
      fu_diff_q[(Latency-FuDiffDone)/Interval*FDiffW+:FDiffW],
      fv_diff_q[(Latency-FvDiffDone)/Interval*FDiffW+:FDiffW],
      h_q[(Latency-HDone)/Interval*StartHW+:StartHW],
      h_step_q[(Latency-HStepDone)/Interval*HStepW+:HStepW],
      res_u1,
      res_v1,
      fu_q[(Latency-FuDone)/Interval*AccW+:AccW],
      fv_q[(Latency-FvDone)/Interval*AccW+:AccW],
      res_fu_step,
      res_fu_step,
      res_fv_step,
      res_fv_step
    };

    logic unused;
    assign unused = ^{phase_i, k_i, h_i, gu_i, gv_i, gu_step0_i, gu_step1_i, gv_step0_i, gv_step1_i, unused_u,
                      unused_v, h_diff_q, p_q, h_l_q, through_q, fu_diff_q, fv_diff_q, fu_num, fv_num, h_q, fu_q,
                      fv_q, h_step_q, fu_step_q, fv_step_q, length_q, diff_q, sum,
                      operand};
  end else begin : gen_const_depth_rows
    localparam int HW = bitspan_cfg_pkg::SpanHW;
    localparam int FW = bitspan_cfg_pkg::SpanFW;
    localparam int GStepW = bitspan_cfg_pkg::SpanFStepW;
    localparam int SpanSumW = bitspan_cfg_pkg::SpanSumW;
    localparam int SumFrac = bitspan_cfg_pkg::SpanSumFrac;
    localparam int FuTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFu+:16]);
    localparam int FvTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFv+:16]);
    localparam int FuStepTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFuStep+:16]);
    localparam int FvStepTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFvStep+:16]);
    localparam int FuStep1Tick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFuStep1+:16]);
    localparam int FvStep1Tick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowFvStep1+:16]);
    localparam int FuDone = FuTick + ProductTicks;
    localparam int FvDone = FvTick + ProductTicks;
    localparam int FuStepDone = FuStepTick + ProductTicks;
    localparam int FvStepDone = FvStepTick + ProductTicks;
    localparam int FuStep1Done = FuStep1Tick + ProductTicks;
    localparam int FvStep1Done = FvStep1Tick + ProductTicks;

    // Tick 0: h + B.
    logic signed [HW:0] h;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b_ext;
    logic signed [SpanSumW-1:0] h_sum;
    assign h = $signed({(bitspan_cfg_pkg::SpanHSigned != 0) & h_i[HW-1], h_i});
    assign b_ext = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign h_sum = (SpanSumW'(h) <<< (SumFrac - bitspan_cfg_pkg::SpanHFrac)) +
                   (SpanSumW'(b_ext) <<< (SumFrac - bitspan_cfg_pkg::SetupBFrac));
    localparam int ThroughW = 2 * IndexW + bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + HW;
    logic [((Latency-1)/Interval+1)*ThroughW-1:0] through_q;
    logic [((FuTick-1)/Interval+1)*FW-1:0] gu_q;
    logic [((FvTick-1)/Interval+1)*FW-1:0] gv_q;
    logic [((FuStepTick-1)/Interval+1)*GStepW-1:0] gu_step0_q;
    logic [((FvStepTick-1)/Interval+1)*GStepW-1:0] gv_step0_q;
    logic [((FuStep1Tick-1)/Interval+1)*GStepW-1:0] gu_step1_q;
    logic [((FvStep1Tick-1)/Interval+1)*GStepW-1:0] gv_step1_q;
    logic [bitspan_cfg_pkg::RowRecipOpW-1:0] operand_q;
    logic [((Latency-RecipTick)/Interval+1)*(MW+EW)-1:0] recip_q;
    row_hold #(
        .Width(bitspan_cfg_pkg::RowRecipOpW), .Interval(Interval), .Written(1), .Last(1), .PhaseW(PhaseW)
    ) u_operand_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(h_sum[SpanSumW-2:0] & {(SpanSumW - 1) {!h_sum[SpanSumW-1]}}),
        .q_o(operand_q)
    );
    row_hold #(
        .Width(ThroughW), .Interval(Interval), .Written(1), .Last(Latency), .PhaseW(PhaseW)
    ) u_through_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i({x_first_i, count_i, phase_i, k_i, h_i}), .q_o(through_q)
    );
    row_hold #(
        .Width(FW), .Interval(Interval), .Written(1), .Last(FuTick), .PhaseW(PhaseW)
    ) u_gu_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(gu_i), .q_o(gu_q)
    );
    row_hold #(
        .Width(FW), .Interval(Interval), .Written(1), .Last(FvTick), .PhaseW(PhaseW)
    ) u_gv_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(gv_i), .q_o(gv_q)
    );
    row_hold #(
        .Width(GStepW), .Interval(Interval), .Written(1), .Last(FuStepTick), .PhaseW(PhaseW)
    ) u_gu_step0_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(gu_step0_i), .q_o(gu_step0_q)
    );
    row_hold #(
        .Width(GStepW), .Interval(Interval), .Written(1), .Last(FvStepTick), .PhaseW(PhaseW)
    ) u_gv_step0_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(gv_step0_i), .q_o(gv_step0_q)
    );
    row_hold #(
        .Width(GStepW), .Interval(Interval), .Written(1), .Last(FuStep1Tick), .PhaseW(PhaseW)
    ) u_gu_step1_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(gu_step1_i), .q_o(gu_step1_q)
    );
    row_hold #(
        .Width(GStepW), .Interval(Interval), .Written(1), .Last(FvStep1Tick), .PhaseW(PhaseW)
    ) u_gv_step1_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i(gv_step1_i), .q_o(gv_step1_q)
    );
    row_hold #(
        .Width(MW + EW), .Interval(Interval), .Written(RecipTick), .Last(Latency), .PhaseW(PhaseW)
    ) u_recip_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .d_i({unit_m, unit_e}), .q_o(recip_q)
    );
    assign operand = operand_q;

    // The row's one reciprocal makes everything linear in u, v.
    logic [FW-1:0] gu;
    logic [MW-1:0] gu_m;
    logic [EW-1:0] gu_e;
    assign gu = gu_q[(FuTick-1)/Interval*FW+:FW];
    assign {gu_m, gu_e} = recip_q[(FuTick-RecipTick)/Interval*(MW+EW)+:MW+EW];
    assign a[bitspan_cfg_pkg::RowFu*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFSigned != 0) & gu[FW-1], gu}));
    assign b[bitspan_cfg_pkg::RowFu*BW+:BW] =
        BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & gu_m[MW-1], gu_m}));
    assign shift[bitspan_cfg_pkg::RowFu*ShiftW+:ShiftW] =
        ShiftW'(16'($signed(gu_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFu+:16]);
    logic [((Latency-FuDone)/Interval+1)*AccW-1:0] fu_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::TexAccW), .OutFrac(bitspan_cfg_pkg::TexAccFrac),
        .OutSigned(bitspan_cfg_pkg::TexAccSigned), .OutRnd(bitspan_cfg_pkg::TexAccRnd),
        .OutOvf(bitspan_cfg_pkg::TexAccOvf), .Interval(Interval), .Written(FuDone), .Last(Latency), .PhaseW(PhaseW)
    ) u_fu_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFu*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFu]), .far_i(far[bitspan_cfg_pkg::RowFu]),
        .sign_i(sign[bitspan_cfg_pkg::RowFu]), .q_o(fu_q)
    );
    logic [FW-1:0] gv;
    logic [MW-1:0] gv_m;
    logic [EW-1:0] gv_e;
    assign gv = gv_q[(FvTick-1)/Interval*FW+:FW];
    assign {gv_m, gv_e} = recip_q[(FvTick-RecipTick)/Interval*(MW+EW)+:MW+EW];
    assign a[bitspan_cfg_pkg::RowFv*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFSigned != 0) & gv[FW-1], gv}));
    assign b[bitspan_cfg_pkg::RowFv*BW+:BW] =
        BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & gv_m[MW-1], gv_m}));
    assign shift[bitspan_cfg_pkg::RowFv*ShiftW+:ShiftW] =
        ShiftW'(16'($signed(gv_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFv+:16]);
    logic [((Latency-FvDone)/Interval+1)*AccW-1:0] fv_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::TexAccW), .OutFrac(bitspan_cfg_pkg::TexAccFrac),
        .OutSigned(bitspan_cfg_pkg::TexAccSigned), .OutRnd(bitspan_cfg_pkg::TexAccRnd),
        .OutOvf(bitspan_cfg_pkg::TexAccOvf), .Interval(Interval), .Written(FvDone), .Last(Latency), .PhaseW(PhaseW)
    ) u_fv_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFv*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFv]), .far_i(far[bitspan_cfg_pkg::RowFv]),
        .sign_i(sign[bitspan_cfg_pkg::RowFv]), .q_o(fv_q)
    );
    logic [GStepW-1:0] gu_step0;
    logic [MW-1:0] gu_step0_m;
    logic [EW-1:0] gu_step0_e;
    assign gu_step0 = gu_step0_q[(FuStepTick-1)/Interval*GStepW+:GStepW];
    assign {gu_step0_m, gu_step0_e} = recip_q[(FuStepTick-RecipTick)/Interval*(MW+EW)+:MW+EW];
    assign a[bitspan_cfg_pkg::RowFuStep*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gu_step0[GStepW-1], gu_step0}));
    assign b[bitspan_cfg_pkg::RowFuStep*BW+:BW] =
        BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & gu_step0_m[MW-1], gu_step0_m}));
    assign shift[bitspan_cfg_pkg::RowFuStep*ShiftW+:ShiftW] =
        ShiftW'(16'($signed(gu_step0_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFuStep+:16]);
    logic [((Latency-FuStepDone)/Interval+1)*StepW-1:0] fu_step0_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::TexStepW), .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned), .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf), .Interval(Interval), .Written(FuStepDone), .Last(Latency),
        .PhaseW(PhaseW)
    ) u_fu_step0_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFuStep*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFuStep]), .far_i(far[bitspan_cfg_pkg::RowFuStep]),
        .sign_i(sign[bitspan_cfg_pkg::RowFuStep]), .q_o(fu_step0_q)
    );
    logic [GStepW-1:0] gv_step0;
    logic [MW-1:0] gv_step0_m;
    logic [EW-1:0] gv_step0_e;
    assign gv_step0 = gv_step0_q[(FvStepTick-1)/Interval*GStepW+:GStepW];
    assign {gv_step0_m, gv_step0_e} = recip_q[(FvStepTick-RecipTick)/Interval*(MW+EW)+:MW+EW];
    assign a[bitspan_cfg_pkg::RowFvStep*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gv_step0[GStepW-1], gv_step0}));
    assign b[bitspan_cfg_pkg::RowFvStep*BW+:BW] =
        BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & gv_step0_m[MW-1], gv_step0_m}));
    assign shift[bitspan_cfg_pkg::RowFvStep*ShiftW+:ShiftW] =
        ShiftW'(16'($signed(gv_step0_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFvStep+:16]);
    logic [((Latency-FvStepDone)/Interval+1)*StepW-1:0] fv_step0_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::TexStepW), .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned), .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf), .Interval(Interval), .Written(FvStepDone), .Last(Latency),
        .PhaseW(PhaseW)
    ) u_fv_step0_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFvStep*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFvStep]), .far_i(far[bitspan_cfg_pkg::RowFvStep]),
        .sign_i(sign[bitspan_cfg_pkg::RowFvStep]), .q_o(fv_step0_q)
    );
    logic [GStepW-1:0] gu_step1;
    logic [MW-1:0] gu_step1_m;
    logic [EW-1:0] gu_step1_e;
    assign gu_step1 = gu_step1_q[(FuStep1Tick-1)/Interval*GStepW+:GStepW];
    assign {gu_step1_m, gu_step1_e} = recip_q[(FuStep1Tick-RecipTick)/Interval*(MW+EW)+:MW+EW];
    assign a[bitspan_cfg_pkg::RowFuStep1*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gu_step1[GStepW-1], gu_step1}));
    assign b[bitspan_cfg_pkg::RowFuStep1*BW+:BW] =
        BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & gu_step1_m[MW-1], gu_step1_m}));
    assign shift[bitspan_cfg_pkg::RowFuStep1*ShiftW+:ShiftW] =
        ShiftW'(16'($signed(gu_step1_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFuStep1+:16]);
    logic [((Latency-FuStep1Done)/Interval+1)*StepW-1:0] fu_step1_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::TexStepW), .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned), .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf), .Interval(Interval), .Written(FuStep1Done), .Last(Latency),
        .PhaseW(PhaseW)
    ) u_fu_step1_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFuStep1*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFuStep1]), .far_i(far[bitspan_cfg_pkg::RowFuStep1]),
        .sign_i(sign[bitspan_cfg_pkg::RowFuStep1]), .q_o(fu_step1_q)
    );
    logic [GStepW-1:0] gv_step1;
    logic [MW-1:0] gv_step1_m;
    logic [EW-1:0] gv_step1_e;
    assign gv_step1 = gv_step1_q[(FvStep1Tick-1)/Interval*GStepW+:GStepW];
    assign {gv_step1_m, gv_step1_e} = recip_q[(FvStep1Tick-RecipTick)/Interval*(MW+EW)+:MW+EW];
    assign a[bitspan_cfg_pkg::RowFvStep1*AW+:AW] =
        AW'($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gv_step1[GStepW-1], gv_step1}));
    assign b[bitspan_cfg_pkg::RowFvStep1*BW+:BW] =
        BW'($signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & gv_step1_m[MW-1], gv_step1_m}));
    assign shift[bitspan_cfg_pkg::RowFvStep1*ShiftW+:ShiftW] =
        ShiftW'(16'($signed(gv_step1_e)) + bitspan_cfg_pkg::RowShifts[16*bitspan_cfg_pkg::RowFvStep1+:16]);
    logic [((Latency-FvStep1Done)/Interval+1)*StepW-1:0] fv_step1_q;
    row_result #(
        .SumW(SumW), .Below(Below), .OutW(bitspan_cfg_pkg::TexStepW), .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned), .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf), .Interval(Interval), .Written(FvStep1Done), .Last(Latency),
        .PhaseW(PhaseW)
    ) u_fv_step1_q (
        .clk_i, .en_i(en), .phase_i(phase_q), .sum_i(sum[bitspan_cfg_pkg::RowFvStep1*SumW+:SumW]),
        .sticky_i(sticky[bitspan_cfg_pkg::RowFvStep1]), .far_i(far[bitspan_cfg_pkg::RowFvStep1]),
        .sign_i(sign[bitspan_cfg_pkg::RowFvStep1]), .q_o(fv_step1_q)
    );
    assign a[bitspan_cfg_pkg::RowFuDiff*AW+:AW] = '0;
    assign b[bitspan_cfg_pkg::RowFuDiff*BW+:BW] = '0;
    assign c[bitspan_cfg_pkg::RowFuDiff*CW+:CW] = '0;
    assign shift[bitspan_cfg_pkg::RowFuDiff*ShiftW+:ShiftW] = '0;
    assign a[bitspan_cfg_pkg::RowFvDiff*AW+:AW] = '0;
    assign b[bitspan_cfg_pkg::RowFvDiff*BW+:BW] = '0;
    assign c[bitspan_cfg_pkg::RowFvDiff*CW+:CW] = '0;
    assign shift[bitspan_cfg_pkg::RowFvDiff*ShiftW+:ShiftW] = '0;
    assign a[bitspan_cfg_pkg::RowHStep*AW+:AW] = '0;
    assign b[bitspan_cfg_pkg::RowHStep*BW+:BW] = '0;
    assign c[bitspan_cfg_pkg::RowHStep*CW+:CW] = '0;
    assign shift[bitspan_cfg_pkg::RowHStep*ShiftW+:ShiftW] = '0;
    assign a[bitspan_cfg_pkg::RowH*AW+:AW] = '0;
    assign b[bitspan_cfg_pkg::RowH*BW+:BW] = '0;
    assign c[bitspan_cfg_pkg::RowH*CW+:CW] = '0;
    assign shift[bitspan_cfg_pkg::RowH*ShiftW+:ShiftW] = '0;
    localparam int OffsetShift = (bitspan_cfg_pkg::OffsetFRaw == 0) ? 0 :
                                 bitspan_cfg_pkg::TexAccFrac + Below - bitspan_cfg_pkg::OffsetFFrac;
    // Half an ulp where a format rounds half up (row_result).
    localparam logic signed [CW-1:0] Half = CW'(1) <<< (Below - 1);
    localparam logic signed [CW-1:0] HalfAcc = (bitspan_cfg_pkg::TexAccRnd == 0) ? Half : '0;
    localparam logic signed [CW-1:0] HalfStep = (bitspan_cfg_pkg::TexStepRnd == 0) ? Half : '0;
    logic signed [CW-1:0] offset_f;
    assign offset_f = (CW'(bitspan_cfg_pkg::OffsetFRaw) <<< OffsetShift) + HalfAcc;
    assign c[bitspan_cfg_pkg::RowFu*CW+:CW] = offset_f;
    assign c[bitspan_cfg_pkg::RowFv*CW+:CW] = offset_f;
    assign c[bitspan_cfg_pkg::RowFuStep*CW+:CW] = HalfStep;
    assign c[bitspan_cfg_pkg::RowFvStep*CW+:CW] = HalfStep;
    assign c[bitspan_cfg_pkg::RowFuStep1*CW+:CW] = HalfStep;
    assign c[bitspan_cfg_pkg::RowFvStep1*CW+:CW] = HalfStep;

    logic [IndexW-1:0] res_x, res_count;
    logic [bitspan_cfg_pkg::PhaseW-1:0] res_phase;
    logic [bitspan_cfg_pkg::PlaneKW-1:0] res_k;
    logic [HW-1:0] res_h;
    assign {res_x, res_count, res_phase, res_k, res_h} = through_q[(Latency-1)/Interval*ThroughW+:ThroughW];
    assign res_o = {
      res_x,
      res_count,
      recip_q[(Latency-RecipTick)/Interval*(MW+EW)+:MW+EW],
      res_phase,
      res_k,
      {2 * bitspan_cfg_pkg::SpanFDiffW{1'b0}},
      res_h,
      {bitspan_cfg_pkg::SpanHStepW{1'b0}},
      {2 * bitspan_cfg_pkg::EdgeUvW{1'b0}},
      fu_q[(Latency-FuDone)/Interval*AccW+:AccW],
      fv_q[(Latency-FvDone)/Interval*AccW+:AccW],
      fu_step0_q[(Latency-FuStepDone)/Interval*StepW+:StepW],
      fu_step1_q[(Latency-FuStep1Done)/Interval*StepW+:StepW],
      fv_step0_q[(Latency-FvStepDone)/Interval*StepW+:StepW],
      fv_step1_q[(Latency-FvStep1Done)/Interval*StepW+:StepW]
    };

    logic unused;
    assign unused = ^{x_l_i, x_r_i, h_l_i, h_r_i, u_l_i, u_r_i, v_l_i, v_r_i, through_q, gu_q, gv_q, gu_step0_q,
                      gu_step1_q, gv_step0_q, gv_step1_q, recip_q, fu_q, fv_q, fu_step0_q, fu_step1_q, fv_step0_q,
                      fv_step1_q, sum};
  end

`ifndef SYNTHESIS
  // An offered record has pixels, and does not change or go away before it is taken. B is stable all the while.
  localparam int OfferW = 2 * IndexW + 2 * bitspan_cfg_pkg::EdgeXW + 2 * bitspan_cfg_pkg::EdgeHW +
      4 * bitspan_cfg_pkg::EdgeUvW + bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + bitspan_cfg_pkg::SpanHW +
      2 * bitspan_cfg_pkg::SpanFW + 4 * bitspan_cfg_pkg::SpanFStepW;
  logic offered_q;
  logic [OfferW-1:0] offer, offer_q;
  logic [bitspan_cfg_pkg::SetupBW-1:0] b_q;
  assign offer = {x_first_i, count_i, x_l_i, x_r_i, h_l_i, h_r_i, u_l_i, u_r_i, v_l_i, v_r_i, phase_i, k_i, h_i, gu_i,
                  gv_i, gu_step0_i, gu_step1_i, gv_step0_i, gv_step1_i};
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
