// SPDX-License-Identifier: Apache-2.0
// span_setup of docs/numeric-spec.md: takes a row's ends (delta_f) or a plane row (const_depth_rows), delivers a span
// record.
//
// Time is counted in ticks: clocks on which span_setup goes on, which is all but those on which a span record is there
// and res_ready_i is 0. A row is accepted on ticks that are
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
  // The start offset of fu and fv, on the grid of their sums.
  localparam int FSumFrac = bitspan_cfg_pkg::TexAccFrac + bitspan_cfg_pkg::RowSumBelow;
  localparam int OffsetFShift = (bitspan_cfg_pkg::OffsetFRaw == 0) ? 0 : FSumFrac - bitspan_cfg_pkg::OffsetFFrac;
  localparam logic signed [CW-1:0] OffsetF = CW'(bitspan_cfg_pkg::OffsetFRaw) <<< OffsetFShift;
  logic [RecipW-1:0] res_recip;
  assign res_recip = recip_q[RecipHeld*RecipW-1-:RecipW];

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
    // Slopes come from the multipliers, or all at once from the dividers.
    localparam bit Divides = bitspan_cfg_pkg::RowSlopeDivide != 0;
    localparam int DivideTick = bitspan_cfg_pkg::RowDivideTick;
    localparam int SlopeDone = DivideTick + bitspan_cfg_pkg::RowUnitClocks + 1;
    localparam int HStepTick = Divides ? DivideTick : 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowHStep+:16]);
    localparam int HStepDone = Divides ? SlopeDone : HStepTick + ProductTicks;
    localparam int HTick = 32'(bitspan_cfg_pkg::RowTicks[16*bitspan_cfg_pkg::RowH+:16]);

    // Tick 0: differences, h + B, and the pre-step. Each is exact: one bit more than its terms.
    logic signed [XW:0] x_l, x_r, length;
    logic signed [HW:0] h_l, h_r, h_diff;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b_ext;
    logic signed [EdgeSumW-1:0] h_sum;
    logic signed [PW-1:0] p;
    logic positive;
    assign x_l = $signed({(bitspan_cfg_pkg::EdgeXSigned != 0) & x_l_i[XW-1], x_l_i});
    assign x_r = $signed({(bitspan_cfg_pkg::EdgeXSigned != 0) & x_r_i[XW-1], x_r_i});
    assign h_l = $signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_l_i[HW-1], h_l_i});
    assign h_r = $signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_r_i[HW-1], h_r_i});
    assign b_ext = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign length = x_r - x_l;
    assign positive = !length[XW] && (length != '0);
    assign h_diff = h_r - h_l;
    assign h_sum = (EdgeSumW'(h_r) <<< (EdgeSumFrac - bitspan_cfg_pkg::EdgeHFrac)) +
                   (EdgeSumW'(b_ext) <<< (EdgeSumFrac - bitspan_cfg_pkg::SetupBFrac));
    assign p = $signed({PW'(x_first_i) << PFrac}) + (PW'(1) << (PFrac - 1)) -
               (PW'(x_l) <<< (PFrac - bitspan_cfg_pkg::EdgeXFrac));

    // Held as long as somebody reads them; the multipliers take u before v.
    localparam int SumRead = 32'(bitspan_cfg_pkg::RowTicks[16*(bitspan_cfg_pkg::RowFuDiff+1)+:16]);
    localparam int LengthRead = Divides ? DivideTick : 1;
    localparam int PositiveRead = (Divides ? SlopeDone : RecipTick) - 1;
    localparam int FvTick = 32'(bitspan_cfg_pkg::RowTicks[16*(bitspan_cfg_pkg::RowFu+1)+:16]);
    localparam int PRead = (HTick > FvTick) ? HTick : FvTick;
    localparam int ThroughW = 2 * IndexW + 2 * UvW;
    logic [((SumRead-1)/Interval+1)*EdgeSumW-1:0] h_sum_q;
    logic [((HStepTick-1)/Interval+1)*(HW+1)-1:0] h_diff_q;
    logic [((LengthRead-1)/Interval+1)*XW-1:0] length_q;
    logic [(PositiveRead-1)/Interval:0] positive_q;
    logic [((PRead-1)/Interval+1)*PW-1:0] p_q;
    logic [((HTick-1)/Interval+1)*HW-1:0] h_l_q;
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
        .Width(HW + 1),
        .Written(1),
        .Last(HStepTick)
    ) u_h_diff (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(h_diff),
        .q_o(h_diff_q)
    );
    row_hold #(
        .Width(XW),
        .Written(1),
        .Last(LengthRead)
    ) u_length (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(length[XW-1:0] & {XW{positive}}),
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
        .Width(HW),
        .Written(1),
        .Last(HTick)
    ) u_h_l (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(h_l_i),
        .q_o(h_l_q)
    );
    row_hold #(
        .Width(ThroughW),
        .Written(1),
        .Last(Latency)
    ) u_through (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i({x_first_i, count_i, u_l_i, v_l_i}),
        .q_o(through_q)
    );
    assign operand = length_q[XW-1:0];
    assign has_recip = positive_q[(PositiveRead-1)/Interval];
    // Where the dividers start.
    localparam int StartRow = Divides ? (DivideTick - 1) / Interval : 0;
    logic divide_start;
    logic [XW-1:0] divisor;
    assign divide_start = row_valid_q[StartRow] && phase_q == PhaseW'(DivideTick % Interval);
    assign divisor = length_q[StartRow*XW+:XW];

    // h: its slope, and its value at the first pixel's centre.
    localparam int HStep = bitspan_cfg_pkg::RowHStep;
    localparam int HStart = bitspan_cfg_pkg::RowH;
    logic signed [HW:0] h_num;
    logic [((Latency-HStepDone)/Interval+1)*HStepW-1:0] h_step_q;
    logic [((Latency-HTick-ProductTicks)/Interval+1)*StartHW-1:0] h_q;
    assign h_num = $signed(h_diff_q[(HStepTick-1)/Interval*(HW+1)+:HW+1]);
    if (Divides) begin : gen_divide
      row_divide #(
          .NW(HW + 1),
          .DW(XW),
          .QuotientFrac(bitspan_cfg_pkg::RowDivHFrac),
          .OutW(bitspan_cfg_pkg::SpanHStepW),
          .OutFrac(bitspan_cfg_pkg::SpanHStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanHStepSigned),
          .OutRnd(bitspan_cfg_pkg::SpanHStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanHStepOvf),
          .Last(Latency)
      ) u_h_step (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .phase_i(phase_q),
          .start_i(divide_start),
          .n_i(h_num),
          .d_i(divisor),
          .has_length_i(positive_q[(SlopeDone-2)/Interval]),
          .q_o(h_step_q)
      );
    end else begin : gen_product
      logic [MW-1:0] m;
      logic [EW-1:0] e;
      assign {m, e} = recip_q[(HStepTick-RecipTick)/Interval*RecipW+:RecipW];
      row_product #(
          .Product(HStep),
          .Last(Latency),
          .AW(HW + 1),
          .ASigned(1),
          .BW(MW),
          .BSigned(bitspan_cfg_pkg::RowRecipOutSigned),
          .OutW(bitspan_cfg_pkg::SpanHStepW),
          .OutFrac(bitspan_cfg_pkg::SpanHStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanHStepSigned),
          .OutRnd(bitspan_cfg_pkg::SpanHStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanHStepOvf),
          .ShiftW(ShiftW)
      ) u_h_step (
          .clk_i,
          .en_i(en),
          .phase_i(phase_q),
          .a_i(h_num),
          .b_i(m),
          .e_i(e),
          .c_i('0),
          .a_o(a[HStep*AW+:AW]),
          .b_o(b[HStep*BW+:BW]),
          .c_o(c[HStep*CW+:CW]),
          .shift_o(shift[HStep*ShiftW+:ShiftW]),
          .sum_i(sum[HStep*SumW+:SumW]),
          .q_o(h_step_q)
      );
    end
    localparam int HSumFrac = bitspan_cfg_pkg::SpanHFrac + bitspan_cfg_pkg::RowSumBelow;
    localparam int OffsetHShift = (bitspan_cfg_pkg::OffsetHRaw == 0) ? 0 : HSumFrac - bitspan_cfg_pkg::OffsetHFrac;
    logic [HW-1:0] h_l_read;
    logic signed [CW-1:0] h_base;
    assign h_l_read = h_l_q[(HTick-1)/Interval*HW+:HW];
    assign h_base = (CW'($signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_l_read[HW-1], h_l_read})) <<<
        (HSumFrac - bitspan_cfg_pkg::EdgeHFrac)) + (CW'(bitspan_cfg_pkg::OffsetHRaw) <<< OffsetHShift);
    row_product #(
        .Product(HStart),
        .Last(Latency),
        .AW(HStepW),
        .ASigned(bitspan_cfg_pkg::SpanHStepSigned),
        .BW(PW),
        .BSigned(1),
        .OutW(bitspan_cfg_pkg::SpanHW),
        .OutFrac(bitspan_cfg_pkg::SpanHFrac),
        .OutSigned(bitspan_cfg_pkg::SpanHSigned),
        .OutRnd(bitspan_cfg_pkg::SpanHRnd),
        .OutOvf(bitspan_cfg_pkg::SpanHOvf),
        .ShiftW(ShiftW)
    ) u_h (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .a_i(h_step_q[(HTick-HStepDone)/Interval*HStepW+:HStepW]),
        .b_i(p_q[(HTick-1)/Interval*PW+:PW]),
        .e_i('0),
        .c_i(h_base),
        .a_o(a[HStart*AW+:AW]),
        .b_o(b[HStart*BW+:BW]),
        .c_o(c[HStart*CW+:CW]),
        .shift_o(shift[HStart*ShiftW+:ShiftW]),
        .sum_i(sum[HStart*SumW+:SumW]),
        .q_o(h_q)
    );

    // u and v: the numerator's difference, its slope, and its value at the first pixel's centre.
    logic [2*FDiffW-1:0] res_f_diff;
    logic [2*StepW-1:0] res_f_step;
    logic [2*AccW-1:0] res_f;
    for (genvar i = 0; i < 2; i++) begin : gen_uv
      localparam int Diff = bitspan_cfg_pkg::RowFuDiff + i;
      localparam int Step = bitspan_cfg_pkg::RowFuStep + i;
      localparam int Start = bitspan_cfg_pkg::RowFu + i;
      localparam int DiffTick = 32'(bitspan_cfg_pkg::RowTicks[16*Diff+:16]);
      localparam int DiffDone = DiffTick + ProductTicks;
      localparam int StepTick = Divides ? DivideTick : 32'(bitspan_cfg_pkg::RowTicks[16*Step+:16]);
      localparam int StepDone = Divides ? SlopeDone : StepTick + ProductTicks;
      localparam int StartTick = 32'(bitspan_cfg_pkg::RowTicks[16*Start+:16]);
      logic [UvW-1:0] left, right;
      logic signed [UvW:0] diff;
      logic [((DiffTick-1)/Interval+1)*(UvW+1)-1:0] diff_q;
      logic [((Latency-DiffDone)/Interval+1)*FDiffW-1:0] f_diff_q;
      logic [((Latency-StepDone)/Interval+1)*StepW-1:0] f_step_q;
      logic [((Latency-StartTick-ProductTicks)/Interval+1)*AccW-1:0] f_q;
      assign left = (i == 0) ? u_l_i : v_l_i;
      assign right = (i == 0) ? u_r_i : v_r_i;
      assign diff = $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & right[UvW-1], right}) -
                    $signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & left[UvW-1], left});
      row_hold #(
          .Width(UvW + 1),
          .Written(1),
          .Last(DiffTick)
      ) u_diff (
          .clk_i,
          .en_i(en),
          .phase_i(phase_q),
          .d_i(diff),
          .q_o(diff_q)
      );
      row_product #(
          .Product(Diff),
          .Last(Latency),
          .AW(EdgeSumW),
          .ASigned(1),
          .BW(UvW + 1),
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
          .b_i(diff_q[(DiffTick-1)/Interval*(UvW+1)+:UvW+1]),
          .e_i('0),
          .c_i('0),
          .a_o(a[Diff*AW+:AW]),
          .b_o(b[Diff*BW+:BW]),
          .c_o(c[Diff*CW+:CW]),
          .shift_o(shift[Diff*ShiftW+:ShiftW]),
          .sum_i(sum[Diff*SumW+:SumW]),
          .q_o(f_diff_q)
      );
      logic [FDiffW-1:0] f_diff;
      assign f_diff = f_diff_q[(StepTick-DiffDone)/Interval*FDiffW+:FDiffW];
      if (Divides) begin : gen_divide
        localparam int FNumW = FDiffW + ((bitspan_cfg_pkg::SpanFDiffSigned != 0) ? 0 : 1);
        logic signed [FNumW-1:0] f_num;
        assign f_num = FNumW'($signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & f_diff[FDiffW-1], f_diff}));
        row_divide #(
            .NW(FNumW),
            .DW(XW),
            .QuotientFrac(bitspan_cfg_pkg::RowDivFFrac),
            .OutW(bitspan_cfg_pkg::SpanFStepW),
            .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
            .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
            .OutRnd(bitspan_cfg_pkg::SpanFStepRnd),
            .OutOvf(bitspan_cfg_pkg::SpanFStepOvf),
            .Last(Latency)
        ) u_f_step (
            .clk_i,
            .rst_ni,
            .en_i(en),
            .phase_i(phase_q),
            .start_i(divide_start),
            .n_i(f_num),
            .d_i(divisor),
            .has_length_i(positive_q[(SlopeDone-2)/Interval]),
            .q_o(f_step_q)
        );
      end else begin : gen_product
        logic [MW-1:0] m;
        logic [EW-1:0] e;
        assign {m, e} = recip_q[(StepTick-RecipTick)/Interval*RecipW+:RecipW];
        row_product #(
            .Product(Step),
            .Last(Latency),
            .AW(FDiffW),
            .ASigned(bitspan_cfg_pkg::SpanFDiffSigned),
            .BW(MW),
            .BSigned(bitspan_cfg_pkg::RowRecipOutSigned),
            .OutW(bitspan_cfg_pkg::SpanFStepW),
            .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
            .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
            .OutRnd(bitspan_cfg_pkg::SpanFStepRnd),
            .OutOvf(bitspan_cfg_pkg::SpanFStepOvf),
            .ShiftW(ShiftW)
        ) u_f_step (
            .clk_i,
            .en_i(en),
            .phase_i(phase_q),
            .a_i(f_diff),
            .b_i(m),
            .e_i(e),
            .c_i('0),
            .a_o(a[Step*AW+:AW]),
            .b_o(b[Step*BW+:BW]),
            .c_o(c[Step*CW+:CW]),
            .shift_o(shift[Step*ShiftW+:ShiftW]),
            .sum_i(sum[Step*SumW+:SumW]),
            .q_o(f_step_q)
        );
      end
      row_product #(
          .Product(Start),
          .Last(Latency),
          .AW(StepW),
          .ASigned(bitspan_cfg_pkg::SpanFStepSigned),
          .BW(PW),
          .BSigned(1),
          .OutW(bitspan_cfg_pkg::SpanFW),
          .OutFrac(bitspan_cfg_pkg::SpanFFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFSigned),
          .OutRnd(bitspan_cfg_pkg::SpanFRnd),
          .OutOvf(bitspan_cfg_pkg::SpanFOvf),
          .ShiftW(ShiftW)
      ) u_f (
          .clk_i,
          .en_i(en),
          .phase_i(phase_q),
          .a_i(f_step_q[(StartTick-StepDone)/Interval*StepW+:StepW]),
          .b_i(p_q[(StartTick-1)/Interval*PW+:PW]),
          .e_i('0),
          .c_i(OffsetF),
          .a_o(a[Start*AW+:AW]),
          .b_o(b[Start*BW+:BW]),
          .c_o(c[Start*CW+:CW]),
          .shift_o(shift[Start*ShiftW+:ShiftW]),
          .sum_i(sum[Start*SumW+:SumW]),
          .q_o(f_q)
      );
      assign res_f_diff[i*FDiffW+:FDiffW] = f_diff_q[(Latency-DiffDone)/Interval*FDiffW+:FDiffW];
      assign res_f_step[i*StepW+:StepW] = f_step_q[(Latency-StepDone)/Interval*StepW+:StepW];
      assign res_f[i*AccW+:AccW] = f_q[(Latency-StartTick-ProductTicks)/Interval*AccW+:AccW];
      logic unused;
      assign unused = ^{diff_q, f_diff_q, f_step_q, f_q};
    end

    logic [IndexW-1:0] res_x, res_count;
    logic [UvW-1:0] res_u1, res_v1;
    assign {res_x, res_count, res_u1, res_v1} = through_q[(Latency-1)/Interval*ThroughW+:ThroughW];
    assign res_o = {
      res_x,
      res_count,
      res_recip,
      {bitspan_cfg_pkg::PhaseW{1'b0}},
      {bitspan_cfg_pkg::PlaneKW{1'b0}},
      res_f_diff[0+:FDiffW],
      res_f_diff[FDiffW+:FDiffW],
      h_q[(Latency-HTick-ProductTicks)/Interval*StartHW+:StartHW],
      h_step_q[(Latency-HStepDone)/Interval*HStepW+:HStepW],
      res_u1,
      res_v1,
      res_f[0+:AccW],
      res_f[AccW+:AccW],
      {2{res_f_step[0+:StepW]}},
      {2{res_f_step[StepW+:StepW]}}
    };

    logic unused;
    assign unused = ^{phase_i, k_i, h_i, gu_i, gv_i, gu_step0_i, gu_step1_i, gv_step0_i, gv_step1_i, h_sum_q, h_diff_q,
                      length_q, positive_q, p_q, h_l_q, through_q, h_step_q, h_q, recip_q, divide_start, divisor};
  end else begin : gen_const_depth_rows
    localparam int HW = bitspan_cfg_pkg::SpanHW;
    localparam int FW = bitspan_cfg_pkg::SpanFW;
    localparam int GStepW = bitspan_cfg_pkg::SpanFStepW;
    localparam int SpanSumW = bitspan_cfg_pkg::SpanSumW;
    localparam int SumFrac = bitspan_cfg_pkg::SpanSumFrac;

    // Tick 0: h + B; what is not positive is 0, which the unit takes for one ulp.
    logic signed [HW:0] h;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b_ext;
    logic signed [SpanSumW-1:0] h_sum;
    assign h = $signed({(bitspan_cfg_pkg::SpanHSigned != 0) & h_i[HW-1], h_i});
    assign b_ext = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign h_sum = (SpanSumW'(h) <<< (SumFrac - bitspan_cfg_pkg::SpanHFrac)) +
                   (SpanSumW'(b_ext) <<< (SumFrac - bitspan_cfg_pkg::SetupBFrac));
    localparam int ThroughW = 2 * IndexW + bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + HW;
    logic [((Latency-1)/Interval+1)*ThroughW-1:0] through_q;
    row_hold #(
        .Width(bitspan_cfg_pkg::RowRecipOpW),
        .Written(1),
        .Last(1)
    ) u_operand (
        .clk_i,
        .en_i(en),
        .phase_i(phase_q),
        .d_i(h_sum[SpanSumW-2:0] & {(SpanSumW - 1) {!h_sum[SpanSumW-1]}}),
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
        .d_i({x_first_i, count_i, phase_i, k_i, h_i}),
        .q_o(through_q)
    );
    assign has_recip = 1'b1;

    // The row's one reciprocal makes everything linear in u, v: fu and fv, and the steps where the digital line stays on
    // its row (0) and where it changes (1).
    logic [2*AccW-1:0] res_f;
    for (genvar i = 0; i < 2; i++) begin : gen_uv
      localparam int Start = bitspan_cfg_pkg::RowFu + i;
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
          .c_i(OffsetF),
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
      localparam int Step = (i < 2) ? bitspan_cfg_pkg::RowFuStep + i : bitspan_cfg_pkg::RowFuStep1 + i - 2;
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

    logic [IndexW-1:0] res_x, res_count;
    logic [bitspan_cfg_pkg::PhaseW-1:0] res_phase;
    logic [bitspan_cfg_pkg::PlaneKW-1:0] res_k;
    logic [HW-1:0] res_h;
    assign {res_x, res_count, res_phase, res_k, res_h} = through_q[(Latency-1)/Interval*ThroughW+:ThroughW];
    assign res_o = {
      res_x,
      res_count,
      res_recip,
      res_phase,
      res_k,
      {2 * bitspan_cfg_pkg::SpanFDiffW{1'b0}},
      res_h,
      {bitspan_cfg_pkg::SpanHStepW{1'b0}},
      {2 * bitspan_cfg_pkg::EdgeUvW{1'b0}},
      res_f[0+:AccW],
      res_f[AccW+:AccW],
      res_f_step[0+:StepW],
      res_f_step[2*StepW+:StepW],
      res_f_step[StepW+:StepW],
      res_f_step[3*StepW+:StepW]
    };

    logic unused;
    assign unused = ^{x_l_i, x_r_i, h_l_i, h_r_i, u_l_i, u_r_i, v_l_i, v_r_i, through_q, recip_q};
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
