// SPDX-License-Identifier: Apache-2.0
// span_setup of docs/numeric-spec.md: takes a row's ends (delta_f) or a plane row (const_depth_rows), delivers a span
// record.
//
//   delta_f            L = x_r - x_l, differences | row unit: R_row(L), or dividers | slopes | start values
//   const_depth_rows   h + B                      | row unit: R_row(h + B)          | u, v   | -
//   clocks             1                            RowUnitClocks                     1        1
//
// With a pipelined row unit, everything shifts together on en. Otherwise one record is inside at a time, from its
// acceptance until its result is taken, and the first register holds it all the while.
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
    // The span record, valid with res_valid_o, taken with take_i.
    output logic res_valid_o,
    input  logic take_i,
    output logic [bitspan_cfg_pkg::PixelIndexW-1:0] res_x_o,
    output logic [bitspan_cfg_pkg::PixelIndexW-1:0] res_count_o,
    output logic [bitspan_cfg_pkg::RowRecipOutW-1:0] res_recip_m_o,
    output logic [bitspan_cfg_pkg::ExponentW-1:0] res_recip_e_o,
    output logic [bitspan_cfg_pkg::PhaseW-1:0] res_phase_o,
    output logic [bitspan_cfg_pkg::PlaneKW-1:0] res_k_o,
    output logic [bitspan_cfg_pkg::SpanFDiffW-1:0] res_fu_diff_o,
    output logic [bitspan_cfg_pkg::SpanFDiffW-1:0] res_fv_diff_o,
    output logic [bitspan_cfg_pkg::SpanHW-1:0] res_h_o,
    output logic [bitspan_cfg_pkg::SpanHStepW-1:0] res_h_step_o,
    output logic [bitspan_cfg_pkg::EdgeUvW-1:0] res_u1_o,
    output logic [bitspan_cfg_pkg::EdgeUvW-1:0] res_v1_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] res_fu_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] res_fv_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] res_fu_step0_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] res_fu_step1_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] res_fv_step0_o,
    output logic [bitspan_cfg_pkg::TexStepW-1:0] res_fv_step1_o
);
  localparam bit RowPipelined = bitspan_cfg_pkg::RowRecipPipelined != 0;
  localparam int Clocks = 1 + bitspan_cfg_pkg::RowUnitClocks + 2;
  // Clocks that data waits beside the row unit.
  localparam int WaitClocks = RowPipelined ? bitspan_cfg_pkg::RowUnitClocks : 0;
  localparam int IndexW = bitspan_cfg_pkg::PixelIndexW;

  // valid_q[0] goes with the first register, valid_q[Clocks-1] with the result.
  logic [Clocks-1:0] valid_q;
  logic en, accept, load_first;
  assign res_valid_o = valid_q[Clocks-1];
  assign en = !res_valid_o || take_i;
  assign in_ready_o = RowPipelined ? en : ~(|valid_q);
  assign accept = in_valid_i && in_ready_o;
  assign load_first = RowPipelined ? en : accept;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) valid_q <= '0;
    else if (en) valid_q <= {valid_q[Clocks-2:0], accept};
  end

  // The row unit's result; the mantissa with a sign.
  logic [bitspan_cfg_pkg::RowRecipOpW-1:0] operand_q;
  logic [bitspan_cfg_pkg::RowRecipOutW-1:0] recip_m;
  logic signed [bitspan_cfg_pkg::RowRecipOutW:0] recip_m_ext;
  logic signed [bitspan_cfg_pkg::ExponentW-1:0] recip_e;
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
        .Clocks(bitspan_cfg_pkg::RowUnitClocks),
        .Table(bitspan_cfg_pkg::RowRecipTable)
    ) u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i   (en),
        .start_i(valid_q[0]),
        .d_i    (operand_q),
        .m_o    (recip_m),
        .e_o    (recip_e)
    );
  end else begin : gen_no_reciprocal
    assign recip_m = '0;
    assign recip_e = '0;
  end
  assign recip_m_ext = $signed({(bitspan_cfg_pkg::RowRecipOutSigned != 0) & recip_m[bitspan_cfg_pkg::RowRecipOutW-1],
                                recip_m});

  // Q[name](n m 2^-e) and Q[name](step p + start + offset) have many parameters in common; see multiply_add.
  if (bitspan_cfg_pkg::ConstDepthRows == 0) begin : gen_delta_f
    // 1: differences. Each is exact: one bit more than its terms.
    localparam int XW = bitspan_cfg_pkg::EdgeXW;
    localparam int HW = bitspan_cfg_pkg::EdgeHW;
    localparam int UvW = bitspan_cfg_pkg::EdgeUvW;
    localparam int FDiffW = bitspan_cfg_pkg::SpanFDiffW;
    localparam int SumW = bitspan_cfg_pkg::EdgeSumW;
    localparam int SumFrac = bitspan_cfg_pkg::EdgeSumFrac;
    // p = x_first + 1/2 - x_l
    localparam int PFrac = (bitspan_cfg_pkg::EdgeXFrac > 1) ? bitspan_cfg_pkg::EdgeXFrac : 1;
    localparam int XInt = XW - bitspan_cfg_pkg::EdgeXFrac;
    localparam int PW = ((IndexW > XInt) ? IndexW : XInt) + 2 + PFrac;

    logic signed [XW:0] x_l, x_r, length;
    logic signed [HW:0] h_l, h_r, h_diff;
    logic signed [UvW:0] u_l, u_r, v_l, v_r, u_diff, v_diff;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b;
    logic signed [SumW-1:0] h_sum;
    logic [FDiffW-1:0] fu_diff, fv_diff;
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
    assign b = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign length = x_r - x_l;
    assign positive = !length[XW] && (length != '0);
    assign h_diff = h_r - h_l;
    assign u_diff = u_r - u_l;
    assign v_diff = v_r - v_l;
    assign h_sum = (SumW'(h_r) <<< (SumFrac - bitspan_cfg_pkg::EdgeHFrac)) +
                   (SumW'(b) <<< (SumFrac - bitspan_cfg_pkg::SetupBFrac));
    assign p = $signed({PW'(x_first_i) << PFrac}) + (PW'(1) << (PFrac - 1)) -
               (PW'(x_l) <<< (PFrac - bitspan_cfg_pkg::EdgeXFrac));
    multiply_add #(
        .AW(UvW + 1),
        .AFrac(bitspan_cfg_pkg::EdgeUvFrac),
        .BW(SumW),
        .BFrac(SumFrac),
        .OutW(bitspan_cfg_pkg::SpanFDiffW),
        .OutFrac(bitspan_cfg_pkg::SpanFDiffFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFDiffSigned),
        .OutRnd(bitspan_cfg_pkg::SpanFDiffRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFDiffOvf)
    ) u_fu_diff (
        .a_i(u_diff),
        .b_i(h_sum),
        .c_i(1'b0),
        .e_i(1'b0),
        .q_o(fu_diff)
    );
    multiply_add #(
        .AW(UvW + 1),
        .AFrac(bitspan_cfg_pkg::EdgeUvFrac),
        .BW(SumW),
        .BFrac(SumFrac),
        .OutW(bitspan_cfg_pkg::SpanFDiffW),
        .OutFrac(bitspan_cfg_pkg::SpanFDiffFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFDiffSigned),
        .OutRnd(bitspan_cfg_pkg::SpanFDiffRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFDiffOvf)
    ) u_fv_diff (
        .a_i(v_diff),
        .b_i(h_sum),
        .c_i(1'b0),
        .e_i(1'b0),
        .q_o(fv_diff)
    );
    localparam int FirstW = 2 * IndexW + PW + HW + 2 * UvW + (HW + 1) + 2 * FDiffW + 1;
    logic [FirstW-1:0] first_q, waited;
    always_ff @(posedge clk_i) begin
      if (load_first) begin
        first_q <= {x_first_i, count_i, p, h_l_i, u_l_i, v_l_i, h_diff, fu_diff, fv_diff, positive};
        operand_q <= positive ? length[XW-1:0] : '0;
      end
    end

    // Beside the row unit.
    delay_line #(
        .Width(FirstW),
        .Depth(WaitClocks)
    ) u_wait (
        .clk_i,
        .en_i(en),
        .d_i (first_q),
        .q_o (waited)
    );
    logic [IndexW-1:0] x_w, count_w;
    logic signed [PW-1:0] p_w;
    logic [HW-1:0] h_w;
    logic [UvW-1:0] u_w, v_w;
    logic signed [HW:0] h_diff_w;
    logic [FDiffW-1:0] fu_diff_w, fv_diff_w;
    logic positive_w;
    assign {x_w, count_w, p_w, h_w, u_w, v_w, h_diff_w, fu_diff_w, fv_diff_w, positive_w} = waited;

    // Slopes.
    localparam int FNumW = FDiffW + ((bitspan_cfg_pkg::SpanFDiffSigned != 0) ? 0 : 1);
    logic [bitspan_cfg_pkg::SpanHStepW-1:0] h_step;
    logic [bitspan_cfg_pkg::SpanFStepW-1:0] fu_step, fv_step;
    if (bitspan_cfg_pkg::RowSlopeDivide != 0) begin : gen_divide
      localparam int QuotientW = bitspan_cfg_pkg::RowDivIterations * bitspan_cfg_pkg::RowRecipBitsPerCycle + 1;
      logic signed [HW:0] h_diff_q;
      logic [FDiffW-1:0] fu_diff_q, fv_diff_q;
      logic positive_q;
      assign {h_diff_q, fu_diff_q, fv_diff_q, positive_q} = first_q[HW+2*FDiffW+1:0];
      logic unused_divide;
      assign unused_divide = (^h_diff_w) ^ positive_q ^ (^recip_m_ext);
      logic signed [QuotientW-1:0] h_quotient;
      logic h_sticky;
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
          .start_i(valid_q[0]),
          .n_i(h_diff_q),
          .d_i(operand_q),
          .q_o(h_quotient),
          .sticky_o(h_sticky)
      );
      quantize #(
          .InW(QuotientW),
          .InFrac(bitspan_cfg_pkg::RowDivHFrac),
          .OutW(bitspan_cfg_pkg::SpanHStepW),
          .OutFrac(bitspan_cfg_pkg::SpanHStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanHStepSigned),
          .Rounding(bitspan_cfg_pkg::SpanHStepRnd),
          .Overflow(bitspan_cfg_pkg::SpanHStepOvf)
      ) u_h_step (
          .x_i(h_quotient),
          .sticky_i(h_sticky),
          .q_o(h_step)
      );
      logic signed [FNumW-1:0] fu_num, fv_num;
      assign fu_num = FNumW'($signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & fu_diff_q[FDiffW-1], fu_diff_q}));
      assign fv_num = FNumW'($signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & fv_diff_q[FDiffW-1], fv_diff_q}));
      logic signed [QuotientW-1:0] fu_quotient;
      logic fu_sticky;
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
          .start_i(valid_q[0]),
          .n_i(fu_num),
          .d_i(operand_q),
          .q_o(fu_quotient),
          .sticky_o(fu_sticky)
      );
      quantize #(
          .InW(QuotientW),
          .InFrac(bitspan_cfg_pkg::RowDivFFrac),
          .OutW(bitspan_cfg_pkg::SpanFStepW),
          .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
          .Rounding(bitspan_cfg_pkg::SpanFStepRnd),
          .Overflow(bitspan_cfg_pkg::SpanFStepOvf)
      ) u_fu_step (
          .x_i(fu_quotient),
          .sticky_i(fu_sticky),
          .q_o(fu_step)
      );
      logic signed [QuotientW-1:0] fv_quotient;
      logic fv_sticky;
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
          .start_i(valid_q[0]),
          .n_i(fv_num),
          .d_i(operand_q),
          .q_o(fv_quotient),
          .sticky_o(fv_sticky)
      );
      quantize #(
          .InW(QuotientW),
          .InFrac(bitspan_cfg_pkg::RowDivFFrac),
          .OutW(bitspan_cfg_pkg::SpanFStepW),
          .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
          .Rounding(bitspan_cfg_pkg::SpanFStepRnd),
          .Overflow(bitspan_cfg_pkg::SpanFStepOvf)
      ) u_fv_step (
          .x_i(fv_quotient),
          .sticky_i(fv_sticky),
          .q_o(fv_step)
      );
    end else begin : gen_product
      multiply_add #(
          .AW(HW + 1),
          .AFrac(bitspan_cfg_pkg::EdgeHFrac),
          .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
          .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
          .EW(bitspan_cfg_pkg::ExponentW),
          .EMin(bitspan_cfg_pkg::RowRecipEMin),
          .EMax(bitspan_cfg_pkg::RowRecipEMax),
          .OutW(bitspan_cfg_pkg::SpanHStepW),
          .OutFrac(bitspan_cfg_pkg::SpanHStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanHStepSigned),
          .OutRnd(bitspan_cfg_pkg::SpanHStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanHStepOvf)
      ) u_h_step (
          .a_i(h_diff_w),
          .b_i(recip_m_ext),
          .c_i(1'b0),
          .e_i(recip_e),
          .q_o(h_step)
      );
      logic signed [FNumW-1:0] fu_num, fv_num;
      assign fu_num = FNumW'($signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & fu_diff_w[FDiffW-1], fu_diff_w}));
      assign fv_num = FNumW'($signed({(bitspan_cfg_pkg::SpanFDiffSigned != 0) & fv_diff_w[FDiffW-1], fv_diff_w}));
      multiply_add #(
          .AW(FNumW),
          .AFrac(bitspan_cfg_pkg::SpanFDiffFrac),
          .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
          .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
          .EW(bitspan_cfg_pkg::ExponentW),
          .EMin(bitspan_cfg_pkg::RowRecipEMin),
          .EMax(bitspan_cfg_pkg::RowRecipEMax),
          .OutW(bitspan_cfg_pkg::SpanFStepW),
          .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
          .OutRnd(bitspan_cfg_pkg::SpanFStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanFStepOvf)
      ) u_fu_step (
          .a_i(fu_num),
          .b_i(recip_m_ext),
          .c_i(1'b0),
          .e_i(recip_e),
          .q_o(fu_step)
      );
      multiply_add #(
          .AW(FNumW),
          .AFrac(bitspan_cfg_pkg::SpanFDiffFrac),
          .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
          .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
          .EW(bitspan_cfg_pkg::ExponentW),
          .EMin(bitspan_cfg_pkg::RowRecipEMin),
          .EMax(bitspan_cfg_pkg::RowRecipEMax),
          .OutW(bitspan_cfg_pkg::SpanFStepW),
          .OutFrac(bitspan_cfg_pkg::SpanFStepFrac),
          .OutSigned(bitspan_cfg_pkg::SpanFStepSigned),
          .OutRnd(bitspan_cfg_pkg::SpanFStepRnd),
          .OutOvf(bitspan_cfg_pkg::SpanFStepOvf)
      ) u_fv_step (
          .a_i(fv_num),
          .b_i(recip_m_ext),
          .c_i(1'b0),
          .e_i(recip_e),
          .q_o(fv_step)
      );
    end

    // Products: the slopes' registers.
    logic [IndexW-1:0] x_s_q, count_s_q;
    logic signed [PW-1:0] p_s_q;
    logic [HW-1:0] h_s_q;
    logic [UvW-1:0] u_s_q, v_s_q;
    logic [FDiffW-1:0] fu_diff_s_q, fv_diff_s_q;
    logic [bitspan_cfg_pkg::SpanHStepW-1:0] h_step_q;
    logic [bitspan_cfg_pkg::SpanFStepW-1:0] fu_step_q, fv_step_q;
    logic [bitspan_cfg_pkg::RowRecipOutW-1:0] recip_m_q;
    logic [bitspan_cfg_pkg::ExponentW-1:0] recip_e_q;
    always_ff @(posedge clk_i) begin
      if (en) begin
        x_s_q <= x_w;
        count_s_q <= count_w;
        p_s_q <= p_w;
        h_s_q <= h_w;
        u_s_q <= u_w;
        v_s_q <= v_w;
        fu_diff_s_q <= fu_diff_w;
        fv_diff_s_q <= fv_diff_w;
        // A row without length has no slopes.
        h_step_q <= positive_w ? h_step : '0;
        fu_step_q <= positive_w ? fu_step : '0;
        fv_step_q <= positive_w ? fv_step : '0;
        recip_m_q <= positive_w ? recip_m : '0;
        recip_e_q <= positive_w ? recip_e : '0;
      end
    end

    // Start values at the first pixel's centre: the result registers.
    logic [bitspan_cfg_pkg::SpanHW-1:0] h_start;
    logic [bitspan_cfg_pkg::SpanFW-1:0] fu_start, fv_start;
    multiply_add #(
        .AW(bitspan_cfg_pkg::SpanHStepW + 1),
        .AFrac(bitspan_cfg_pkg::SpanHStepFrac),
        .BW(PW),
        .BFrac(PFrac),
        .CW(HW + 1),
        .CFrac(bitspan_cfg_pkg::EdgeHFrac),
        .OffsetW(bitspan_cfg_pkg::OffsetHW),
        .OffsetRaw(bitspan_cfg_pkg::OffsetHRaw),
        .OffsetFrac(bitspan_cfg_pkg::OffsetHFrac),
        .OutW(bitspan_cfg_pkg::SpanHW),
        .OutFrac(bitspan_cfg_pkg::SpanHFrac),
        .OutSigned(bitspan_cfg_pkg::SpanHSigned),
        .OutRnd(bitspan_cfg_pkg::SpanHRnd),
        .OutOvf(bitspan_cfg_pkg::SpanHOvf)
    ) u_h_start (
        .a_i($signed({(bitspan_cfg_pkg::SpanHStepSigned != 0) & h_step_q[bitspan_cfg_pkg::SpanHStepW-1], h_step_q})),
        .b_i(p_s_q),
        .c_i($signed({(bitspan_cfg_pkg::EdgeHSigned != 0) & h_s_q[bitspan_cfg_pkg::EdgeHW-1], h_s_q})),
        .e_i(1'b0),
        .q_o(h_start)
    );
    multiply_add #(
        .AW(bitspan_cfg_pkg::SpanFStepW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFStepFrac),
        .BW(PW),
        .BFrac(PFrac),
        .OffsetW(bitspan_cfg_pkg::OffsetFW),
        .OffsetRaw(bitspan_cfg_pkg::OffsetFRaw),
        .OffsetFrac(bitspan_cfg_pkg::OffsetFFrac),
        .OutW(bitspan_cfg_pkg::SpanFW),
        .OutFrac(bitspan_cfg_pkg::SpanFFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFSigned),
        .OutRnd(bitspan_cfg_pkg::SpanFRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFOvf)
    ) u_fu_start (
        .a_i($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & fu_step_q[bitspan_cfg_pkg::SpanFStepW-1], fu_step_q})),
        .b_i(p_s_q),
        .c_i(1'b0),
        .e_i(1'b0),
        .q_o(fu_start)
    );
    multiply_add #(
        .AW(bitspan_cfg_pkg::SpanFStepW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFStepFrac),
        .BW(PW),
        .BFrac(PFrac),
        .OffsetW(bitspan_cfg_pkg::OffsetFW),
        .OffsetRaw(bitspan_cfg_pkg::OffsetFRaw),
        .OffsetFrac(bitspan_cfg_pkg::OffsetFFrac),
        .OutW(bitspan_cfg_pkg::SpanFW),
        .OutFrac(bitspan_cfg_pkg::SpanFFrac),
        .OutSigned(bitspan_cfg_pkg::SpanFSigned),
        .OutRnd(bitspan_cfg_pkg::SpanFRnd),
        .OutOvf(bitspan_cfg_pkg::SpanFOvf)
    ) u_fv_start (
        .a_i($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & fv_step_q[bitspan_cfg_pkg::SpanFStepW-1], fv_step_q})),
        .b_i(p_s_q),
        .c_i(1'b0),
        .e_i(1'b0),
        .q_o(fv_start)
    );
    always_ff @(posedge clk_i) begin
      if (en) begin
        res_x_o <= x_s_q;
        res_count_o <= count_s_q;
        res_recip_m_o <= recip_m_q;
        res_recip_e_o <= recip_e_q;
        res_fu_diff_o <= fu_diff_s_q;
        res_fv_diff_o <= fv_diff_s_q;
        res_h_o <= h_start;
        res_h_step_o <= h_step_q;
        res_u1_o <= u_s_q;
        res_v1_o <= v_s_q;
        res_fu_o <= fu_start;
        res_fv_o <= fv_start;
        res_fu_step0_o <= fu_step_q;
        res_fv_step0_o <= fv_step_q;
      end
    end
    assign res_fu_step1_o = res_fu_step0_o;
    assign res_fv_step1_o = res_fv_step0_o;
    assign res_phase_o = '0;
    assign res_k_o = '0;

    logic unused;
    assign unused = ^{phase_i, k_i, h_i, gu_i, gv_i, gu_step0_i, gu_step1_i, gv_step0_i, gv_step1_i};
  end else begin : gen_const_depth_rows
    // 1: h + B.
    localparam int HW = bitspan_cfg_pkg::SpanHW;
    localparam int FW = bitspan_cfg_pkg::SpanFW;
    localparam int StepW = bitspan_cfg_pkg::SpanFStepW;
    localparam int SumW = bitspan_cfg_pkg::SpanSumW;
    localparam int SumFrac = bitspan_cfg_pkg::SpanSumFrac;
    logic signed [HW:0] h;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b;
    logic signed [SumW-1:0] h_sum;
    assign h = $signed({(bitspan_cfg_pkg::SpanHSigned != 0) & h_i[HW-1], h_i});
    assign b = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign h_sum = (SumW'(h) <<< (SumFrac - bitspan_cfg_pkg::SpanHFrac)) +
                   (SumW'(b) <<< (SumFrac - bitspan_cfg_pkg::SetupBFrac));

    localparam int FirstW = 2 * IndexW + bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + HW + 2 * FW + 4 * StepW;
    logic [FirstW-1:0] first_q, waited;
    always_ff @(posedge clk_i) begin
      if (load_first) begin
        first_q <= {x_first_i, count_i, phase_i, k_i, h_i, gu_i, gv_i, gu_step0_i, gu_step1_i, gv_step0_i, gv_step1_i};
        operand_q <= h_sum[SumW-1] ? '0 : h_sum[SumW-2:0];
      end
    end
    delay_line #(
        .Width(FirstW),
        .Depth(WaitClocks)
    ) u_wait (
        .clk_i,
        .en_i(en),
        .d_i (first_q),
        .q_o (waited)
    );
    logic [IndexW-1:0] x_w, count_w;
    logic [bitspan_cfg_pkg::PhaseW-1:0] phase_w;
    logic [bitspan_cfg_pkg::PlaneKW-1:0] k_w;
    logic [HW-1:0] h_w;
    logic [FW-1:0] gu_w, gv_w;
    logic [StepW-1:0] gu_step0_w, gu_step1_w, gv_step0_w, gv_step1_w;
    assign {x_w, count_w, phase_w, k_w, h_w, gu_w, gv_w, gu_step0_w, gu_step1_w, gv_step0_w, gv_step1_w} = waited;

    // The row's one reciprocal makes everything linear in u, v.
    logic [bitspan_cfg_pkg::TexAccW-1:0] fu, fv;
    logic [bitspan_cfg_pkg::TexStepW-1:0] fu_step0, fu_step1, fv_step0, fv_step1;
    multiply_add #(
        .AW(FW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFFrac),
        .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::RowRecipEMin),
        .EMax(bitspan_cfg_pkg::RowRecipEMax),
        .OffsetW(bitspan_cfg_pkg::OffsetFW),
        .OffsetRaw(bitspan_cfg_pkg::OffsetFRaw),
        .OffsetFrac(bitspan_cfg_pkg::OffsetFFrac),
        .OutW(bitspan_cfg_pkg::TexAccW),
        .OutFrac(bitspan_cfg_pkg::TexAccFrac),
        .OutSigned(bitspan_cfg_pkg::TexAccSigned),
        .OutRnd(bitspan_cfg_pkg::TexAccRnd),
        .OutOvf(bitspan_cfg_pkg::TexAccOvf)
    ) u_fu (
        .a_i($signed({(bitspan_cfg_pkg::SpanFSigned != 0) & gu_w[bitspan_cfg_pkg::SpanFW-1], gu_w})),
        .b_i(recip_m_ext),
        .c_i(1'b0),
        .e_i(recip_e),
        .q_o(fu)
    );
    multiply_add #(
        .AW(FW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFFrac),
        .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::RowRecipEMin),
        .EMax(bitspan_cfg_pkg::RowRecipEMax),
        .OffsetW(bitspan_cfg_pkg::OffsetFW),
        .OffsetRaw(bitspan_cfg_pkg::OffsetFRaw),
        .OffsetFrac(bitspan_cfg_pkg::OffsetFFrac),
        .OutW(bitspan_cfg_pkg::TexAccW),
        .OutFrac(bitspan_cfg_pkg::TexAccFrac),
        .OutSigned(bitspan_cfg_pkg::TexAccSigned),
        .OutRnd(bitspan_cfg_pkg::TexAccRnd),
        .OutOvf(bitspan_cfg_pkg::TexAccOvf)
    ) u_fv (
        .a_i($signed({(bitspan_cfg_pkg::SpanFSigned != 0) & gv_w[bitspan_cfg_pkg::SpanFW-1], gv_w})),
        .b_i(recip_m_ext),
        .c_i(1'b0),
        .e_i(recip_e),
        .q_o(fv)
    );
    multiply_add #(
        .AW(StepW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFStepFrac),
        .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::RowRecipEMin),
        .EMax(bitspan_cfg_pkg::RowRecipEMax),
        .OutW(bitspan_cfg_pkg::TexStepW),
        .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned),
        .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf)
    ) u_fu_step0 (
        .a_i($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gu_step0_w[bitspan_cfg_pkg::SpanFStepW-1], gu_step0_w})),
        .b_i(recip_m_ext),
        .c_i(1'b0),
        .e_i(recip_e),
        .q_o(fu_step0)
    );
    multiply_add #(
        .AW(StepW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFStepFrac),
        .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::RowRecipEMin),
        .EMax(bitspan_cfg_pkg::RowRecipEMax),
        .OutW(bitspan_cfg_pkg::TexStepW),
        .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned),
        .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf)
    ) u_fu_step1 (
        .a_i($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gu_step1_w[bitspan_cfg_pkg::SpanFStepW-1], gu_step1_w})),
        .b_i(recip_m_ext),
        .c_i(1'b0),
        .e_i(recip_e),
        .q_o(fu_step1)
    );
    multiply_add #(
        .AW(StepW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFStepFrac),
        .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::RowRecipEMin),
        .EMax(bitspan_cfg_pkg::RowRecipEMax),
        .OutW(bitspan_cfg_pkg::TexStepW),
        .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned),
        .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf)
    ) u_fv_step0 (
        .a_i($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gv_step0_w[bitspan_cfg_pkg::SpanFStepW-1], gv_step0_w})),
        .b_i(recip_m_ext),
        .c_i(1'b0),
        .e_i(recip_e),
        .q_o(fv_step0)
    );
    multiply_add #(
        .AW(StepW + 1),
        .AFrac(bitspan_cfg_pkg::SpanFStepFrac),
        .BW(bitspan_cfg_pkg::RowRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::RowRecipOutFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::RowRecipEMin),
        .EMax(bitspan_cfg_pkg::RowRecipEMax),
        .OutW(bitspan_cfg_pkg::TexStepW),
        .OutFrac(bitspan_cfg_pkg::TexStepFrac),
        .OutSigned(bitspan_cfg_pkg::TexStepSigned),
        .OutRnd(bitspan_cfg_pkg::TexStepRnd),
        .OutOvf(bitspan_cfg_pkg::TexStepOvf)
    ) u_fv_step1 (
        .a_i($signed({(bitspan_cfg_pkg::SpanFStepSigned != 0) & gv_step1_w[bitspan_cfg_pkg::SpanFStepW-1], gv_step1_w})),
        .b_i(recip_m_ext),
        .c_i(1'b0),
        .e_i(recip_e),
        .q_o(fv_step1)
    );
    localparam int SecondW = 2 * IndexW + bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + HW +
        2 * bitspan_cfg_pkg::TexAccW + 4 * bitspan_cfg_pkg::TexStepW + bitspan_cfg_pkg::RowRecipOutW +
        bitspan_cfg_pkg::ExponentW;
    logic [SecondW-1:0] second_q, result_q;
    always_ff @(posedge clk_i) begin
      if (en) begin
        second_q <= {x_w, count_w, phase_w, k_w, h_w, fu, fv, fu_step0, fu_step1, fv_step0, fv_step1, recip_m, recip_e};
        result_q <= second_q;
      end
    end
    assign {res_x_o, res_count_o, res_phase_o, res_k_o, res_h_o, res_fu_o, res_fv_o, res_fu_step0_o, res_fu_step1_o,
            res_fv_step0_o, res_fv_step1_o, res_recip_m_o, res_recip_e_o} = result_q;
    assign res_h_step_o = '0;
    assign res_u1_o = '0;
    assign res_v1_o = '0;
    assign res_fu_diff_o = '0;
    assign res_fv_diff_o = '0;

    logic unused;
    assign unused = ^{x_l_i, x_r_i, h_l_i, h_r_i, u_l_i, u_r_i, v_l_i, v_r_i};
  end

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_cfg_pkg::SpanSetupClocks)
    else $error("span_setup: has %0d clocks, told %0d", Clocks, bitspan_cfg_pkg::SpanSetupClocks);
  end
  // An offered record has pixels, and does not change or go away before it is taken.
  logic offered_q;
  logic [2*IndexW-1:0] offer_q;
  always @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      offered_q <= 1'b0;
      offer_q <= '0;
    end else begin
      if (in_valid_i) begin
        assert (count_i != '0)
        else $error("span_setup: a record without pixels");
      end
      if (offered_q) begin
        assert (in_valid_i && offer_q == {x_first_i, count_i})
        else $error("span_setup: an offered record was changed or withdrawn");
      end
      offered_q <= in_valid_i && !in_ready_o;
      offer_q <= {x_first_i, count_i};
    end
  end
`endif
endmodule
