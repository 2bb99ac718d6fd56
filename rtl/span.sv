// SPDX-License-Identifier: Apache-2.0
// span of docs/numeric-spec.md: walks a span record's pixels and issues one per clock.
//
//   delta_f            issue: h, fu, fv | h + B | R_pixel(h + B) | u = u1 + fu / (h + B), v
//   const_depth_rows   issue: fu, fv    |       |                | u = fu, v = fv
//
// A record is taken while no span is active, or on the clock that issues the last pixel of one. Behind the issue,
// everything shifts together on en, which is low while a pixel waits at the output.
module span (
    input  logic clk_i,
    input  logic rst_ni,
    // Constant B of the depth code; stable while records are in flight.
    input  logic [bitspan_cfg_pkg::SetupBW-1:0] b_i,
    input  logic res_valid_i,
    output logic take_o,
    input  logic [bitspan_cfg_pkg::PixelIndexW-1:0] res_x_i,
    input  logic [bitspan_cfg_pkg::PixelIndexW-1:0] res_count_i,
    input  logic [bitspan_cfg_pkg::PhaseW-1:0] res_phase_i,
    input  logic [bitspan_cfg_pkg::PlaneKW-1:0] res_k_i,
    input  logic [bitspan_cfg_pkg::SpanHW-1:0] res_h_i,
    input  logic [bitspan_cfg_pkg::SpanHStepW-1:0] res_h_step_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] res_u1_i,
    input  logic [bitspan_cfg_pkg::EdgeUvW-1:0] res_v1_i,
    input  logic [bitspan_cfg_pkg::TexAccW-1:0] res_fu_i,
    input  logic [bitspan_cfg_pkg::TexAccW-1:0] res_fv_i,
    input  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fu_step0_i,
    input  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fu_step1_i,
    input  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fv_step0_i,
    input  logic [bitspan_cfg_pkg::TexStepW-1:0] res_fv_step1_i,
    // One transfer per pixel. x is the major coordinate; step says that the digital line steps after this pixel.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_cfg_pkg::PixelIndexW-1:0] x_o,
    output logic step_o,
    output logic last_o,
    output logic [bitspan_cfg_pkg::SpanHW-1:0] h_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] fu_o,
    output logic [bitspan_cfg_pkg::TexAccW-1:0] fv_o,
    output logic [bitspan_cfg_pkg::PixelRecipOutW-1:0] recip_m_o,
    output logic [bitspan_cfg_pkg::ExponentW-1:0] recip_e_o,
    output logic [bitspan_cfg_pkg::SpanUvW-1:0] u_o,
    output logic [bitspan_cfg_pkg::SpanUvW-1:0] v_o
);
  localparam int IndexW = bitspan_cfg_pkg::PixelIndexW;
  localparam int HW = bitspan_cfg_pkg::SpanHW;
  localparam int AccW = bitspan_cfg_pkg::TexAccW;
  localparam int StepW = bitspan_cfg_pkg::TexStepW;
  localparam int UvW = bitspan_cfg_pkg::EdgeUvW;
  localparam int KW = bitspan_cfg_pkg::PlaneKW;
  localparam int PhaseW = bitspan_cfg_pkg::PhaseW;
  localparam int Clocks = (bitspan_cfg_pkg::ConstDepthRows != 0) ? 1 : 2 + bitspan_cfg_pkg::PixelUnitClocks;

  logic en, last, take, active_q;
  logic [IndexW-1:0] x_q, left_q;
  assign en = !(out_valid_o && !out_ready_i);
  assign last = left_q == IndexW'(1);
  assign take = res_valid_i && (!active_q || (last && en));
  assign take_o = take;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) active_q <= 1'b0;
    else if (take) active_q <= 1'b1;
    else if (en && last) active_q <= 1'b0;
  end
  always_ff @(posedge clk_i) begin
    if (take) begin
      x_q <= res_x_i;
      left_q <= res_count_i;
    end else if (active_q && en) begin
      x_q <= x_q + IndexW'(1);
      left_q <= left_q - IndexW'(1);
    end
  end

  // The digital line moves a pixel to the side where the phase leaves 0..1.
  logic step;
  if (bitspan_cfg_pkg::ConstDepthRows != 0) begin : gen_line
    // phase + k; k has KInt integer bits, and one more holds the sum.
    localparam int KInt = (KW - PhaseW > 1) ? KW - PhaseW : 1;
    localparam int SumW = KInt + PhaseW + 2;
    logic [PhaseW-1:0] phase_q;
    logic [KW-1:0] k_q;
    logic signed [KW:0] k;
    logic signed [SumW-1:0] sum;
    assign k = $signed({(bitspan_cfg_pkg::PlaneKSigned != 0) & k_q[KW-1], k_q});
    assign sum = $signed(SumW'(phase_q)) + SumW'(k);
    // Outside 0..1 on the side that k points to.
    assign step = k[KW] ? sum[SumW-1] : |sum[SumW-1:PhaseW];
    always_ff @(posedge clk_i) begin
      if (take) begin
        phase_q <= res_phase_i;
        k_q <= res_k_i;
      end else if (active_q && en) begin
        phase_q <= sum[PhaseW-1:0];
      end
    end
  end else begin : gen_no_line
    assign step = 1'b0;
    logic unused;
    assign unused = ^{res_phase_i, res_k_i};
  end

  // Accumulators.
  logic [HW-1:0] h_q, h_next;
  logic [AccW-1:0] fu_q, fv_q, fu_next, fv_next;
  logic [StepW-1:0] fu_step0_q, fu_step1_q, fv_step0_q, fv_step1_q, fu_step, fv_step;
  logic [bitspan_cfg_pkg::SpanHStepW-1:0] h_step_q;
  assign fu_step = step ? fu_step1_q : fu_step0_q;
  assign fv_step = step ? fv_step1_q : fv_step0_q;
  multiply_add #(
      .AW(bitspan_cfg_pkg::SpanHStepW + 1),
      .AFrac(bitspan_cfg_pkg::SpanHStepFrac),
      .BW(2),
      .CW(HW + 1),
      .CFrac(bitspan_cfg_pkg::SpanHFrac),
      .OutW(bitspan_cfg_pkg::SpanHW),
      .OutFrac(bitspan_cfg_pkg::SpanHFrac),
      .OutSigned(bitspan_cfg_pkg::SpanHSigned),
      .OutRnd(bitspan_cfg_pkg::SpanHRnd),
      .OutOvf(bitspan_cfg_pkg::SpanHOvf)
  ) u_h_next (
      .a_i($signed({(bitspan_cfg_pkg::SpanHStepSigned != 0) & h_step_q[bitspan_cfg_pkg::SpanHStepW-1], h_step_q})),
      .b_i(2'sd1),
      .c_i($signed({(bitspan_cfg_pkg::SpanHSigned != 0) & h_q[bitspan_cfg_pkg::SpanHW-1], h_q})),
      .e_i(1'b0),
      .q_o(h_next)
  );
  multiply_add #(
      .AW(StepW + 1),
      .AFrac(bitspan_cfg_pkg::TexStepFrac),
      .BW(2),
      .CW(AccW + 1),
      .CFrac(bitspan_cfg_pkg::TexAccFrac),
      .OutW(bitspan_cfg_pkg::TexAccW),
      .OutFrac(bitspan_cfg_pkg::TexAccFrac),
      .OutSigned(bitspan_cfg_pkg::TexAccSigned),
      .OutRnd(bitspan_cfg_pkg::TexAccRnd),
      .OutOvf(bitspan_cfg_pkg::TexAccOvf)
  ) u_fu_next (
      .a_i($signed({(bitspan_cfg_pkg::TexStepSigned != 0) & fu_step[bitspan_cfg_pkg::TexStepW-1], fu_step})),
      .b_i(2'sd1),
      .c_i($signed({(bitspan_cfg_pkg::TexAccSigned != 0) & fu_q[bitspan_cfg_pkg::TexAccW-1], fu_q})),
      .e_i(1'b0),
      .q_o(fu_next)
  );
  multiply_add #(
      .AW(StepW + 1),
      .AFrac(bitspan_cfg_pkg::TexStepFrac),
      .BW(2),
      .CW(AccW + 1),
      .CFrac(bitspan_cfg_pkg::TexAccFrac),
      .OutW(bitspan_cfg_pkg::TexAccW),
      .OutFrac(bitspan_cfg_pkg::TexAccFrac),
      .OutSigned(bitspan_cfg_pkg::TexAccSigned),
      .OutRnd(bitspan_cfg_pkg::TexAccRnd),
      .OutOvf(bitspan_cfg_pkg::TexAccOvf)
  ) u_fv_next (
      .a_i($signed({(bitspan_cfg_pkg::TexStepSigned != 0) & fv_step[bitspan_cfg_pkg::TexStepW-1], fv_step})),
      .b_i(2'sd1),
      .c_i($signed({(bitspan_cfg_pkg::TexAccSigned != 0) & fv_q[bitspan_cfg_pkg::TexAccW-1], fv_q})),
      .e_i(1'b0),
      .q_o(fv_next)
  );
  always_ff @(posedge clk_i) begin
    if (take) begin
      h_q <= res_h_i;
      fu_q <= res_fu_i;
      fv_q <= res_fv_i;
      h_step_q <= res_h_step_i;
      fu_step0_q <= res_fu_step0_i;
      fu_step1_q <= res_fu_step1_i;
      fv_step0_q <= res_fv_step0_i;
      fv_step1_q <= res_fv_step1_i;
    end else if (active_q && en) begin
      h_q <= h_next;
      fu_q <= fu_next;
      fv_q <= fv_next;
    end
  end

  // Valid bits of the pixels behind the issue; the last one stands at the output.
  logic [Clocks-1:0] valid_q;
  assign out_valid_o = valid_q[Clocks-1];
  if (Clocks > 1) begin : gen_valid_line
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) valid_q <= '0;
      else if (en) valid_q <= {valid_q[Clocks-2:0], active_q};
    end
  end else begin : gen_valid
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) valid_q <= '0;
      else if (en) valid_q <= active_q;
    end
  end

  if (bitspan_cfg_pkg::ConstDepthRows == 0) begin : gen_delta_f
    logic [UvW-1:0] u1_q, v1_q;
    always_ff @(posedge clk_i) begin
      if (take) begin
        u1_q <= res_u1_i;
        v1_q <= res_v1_i;
      end
    end

    // h + B.
    localparam int SumW = bitspan_cfg_pkg::SpanSumW;
    localparam int SumFrac = bitspan_cfg_pkg::SpanSumFrac;
    logic signed [HW:0] h;
    logic signed [bitspan_cfg_pkg::SetupBW:0] b;
    logic signed [SumW-1:0] h_sum;
    logic [SumW-2:0] operand_q;
    assign h = $signed({(bitspan_cfg_pkg::SpanHSigned != 0) & h_q[HW-1], h_q});
    assign b = $signed({(bitspan_cfg_pkg::SetupBSigned != 0) & b_i[bitspan_cfg_pkg::SetupBW-1], b_i});
    assign h_sum = (SumW'(h) <<< (SumFrac - bitspan_cfg_pkg::SpanHFrac)) +
                   (SumW'(b) <<< (SumFrac - bitspan_cfg_pkg::SetupBFrac));
    always_ff @(posedge clk_i) begin
      if (en) operand_q <= h_sum[SumW-1] ? '0 : h_sum[SumW-2:0];
    end

    logic [bitspan_cfg_pkg::PixelRecipOutW-1:0] recip_m;
    logic signed [bitspan_cfg_pkg::PixelRecipOutW:0] recip_m_ext;
    logic signed [bitspan_cfg_pkg::ExponentW-1:0] recip_e;
    reciprocal #(
        .Kind(bitspan_cfg_pkg::PixelRecipKind),
        .Normalize(bitspan_cfg_pkg::PixelRecipNormalize),
        .OpW(bitspan_cfg_pkg::PixelRecipOpW),
        .OpFrac(bitspan_cfg_pkg::PixelRecipOpFrac),
        .OperandBits(bitspan_cfg_pkg::PixelRecipOperandBits),
        .IndexBits(bitspan_cfg_pkg::PixelRecipIndexBits),
        .TableBits(bitspan_cfg_pkg::PixelRecipTableBits),
        .InternalBits(bitspan_cfg_pkg::PixelRecipInternalBits),
        .Steps(bitspan_cfg_pkg::PixelRecipSteps),
        .BitsPerCycle(bitspan_cfg_pkg::PixelRecipBitsPerCycle),
        .Pipelined(bitspan_cfg_pkg::PixelRecipPipelined),
        .Iterations(bitspan_cfg_pkg::PixelRecipIterations),
        .QuotientFrac(bitspan_cfg_pkg::PixelRecipQuotientFrac),
        .OutW(bitspan_cfg_pkg::PixelRecipOutW),
        .OutFrac(bitspan_cfg_pkg::PixelRecipOutFrac),
        .OutSigned(bitspan_cfg_pkg::PixelRecipOutSigned),
        .OutRnd(bitspan_cfg_pkg::PixelRecipOutRnd),
        .OutOvf(bitspan_cfg_pkg::PixelRecipOutOvf),
        .EW(bitspan_cfg_pkg::ExponentW),
        .TableEntries(bitspan_cfg_pkg::PixelRecipTableEntries),
        .Clocks(bitspan_cfg_pkg::PixelUnitClocks),
        .Table(bitspan_cfg_pkg::PixelRecipTable)
    ) u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i   (en),
        .start_i(valid_q[0]),
        .d_i    (operand_q),
        .m_o    (recip_m),
        .e_o    (recip_e)
    );
    assign recip_m_ext = $signed({(bitspan_cfg_pkg::PixelRecipOutSigned != 0) &
                                      recip_m[bitspan_cfg_pkg::PixelRecipOutW-1], recip_m});

    // The pixel beside the sum and the reciprocal.
    localparam int WaitW = IndexW + 1 + HW + 2 * AccW + 2 * UvW;
    logic [WaitW-1:0] waited;
    delay_line #(
        .Width(WaitW),
        .Depth(1 + bitspan_cfg_pkg::PixelUnitClocks)
    ) u_wait (
        .clk_i,
        .en_i(en),
        .d_i ({x_q, last, h_q, fu_q, fv_q, u1_q, v1_q}),
        .q_o (waited)
    );
    logic [IndexW-1:0] x_w;
    logic last_w;
    logic [HW-1:0] h_w;
    logic [AccW-1:0] fu_w, fv_w;
    logic [UvW-1:0] u1_w, v1_w;
    assign {x_w, last_w, h_w, fu_w, fv_w, u1_w, v1_w} = waited;

    logic [bitspan_cfg_pkg::SpanUvW-1:0] u, v;
    multiply_add #(
        .AW(AccW + 1),
        .AFrac(bitspan_cfg_pkg::TexAccFrac),
        .BW(bitspan_cfg_pkg::PixelRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::PixelRecipOutFrac),
        .CW(UvW + 1),
        .CFrac(bitspan_cfg_pkg::EdgeUvFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::PixelRecipEMin),
        .EMax(bitspan_cfg_pkg::PixelRecipEMax),
        .OutW(bitspan_cfg_pkg::SpanUvW),
        .OutFrac(bitspan_cfg_pkg::SpanUvFrac),
        .OutSigned(bitspan_cfg_pkg::SpanUvSigned),
        .OutRnd(bitspan_cfg_pkg::SpanUvRnd),
        .OutOvf(bitspan_cfg_pkg::SpanUvOvf)
    ) u_u (
        .a_i($signed({(bitspan_cfg_pkg::TexAccSigned != 0) & fu_w[bitspan_cfg_pkg::TexAccW-1], fu_w})),
        .b_i(recip_m_ext),
        .c_i($signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & u1_w[bitspan_cfg_pkg::EdgeUvW-1], u1_w})),
        .e_i(recip_e),
        .q_o(u)
    );
    multiply_add #(
        .AW(AccW + 1),
        .AFrac(bitspan_cfg_pkg::TexAccFrac),
        .BW(bitspan_cfg_pkg::PixelRecipOutW + 1),
        .BFrac(bitspan_cfg_pkg::PixelRecipOutFrac),
        .CW(UvW + 1),
        .CFrac(bitspan_cfg_pkg::EdgeUvFrac),
        .EW(bitspan_cfg_pkg::ExponentW),
        .EMin(bitspan_cfg_pkg::PixelRecipEMin),
        .EMax(bitspan_cfg_pkg::PixelRecipEMax),
        .OutW(bitspan_cfg_pkg::SpanUvW),
        .OutFrac(bitspan_cfg_pkg::SpanUvFrac),
        .OutSigned(bitspan_cfg_pkg::SpanUvSigned),
        .OutRnd(bitspan_cfg_pkg::SpanUvRnd),
        .OutOvf(bitspan_cfg_pkg::SpanUvOvf)
    ) u_v (
        .a_i($signed({(bitspan_cfg_pkg::TexAccSigned != 0) & fv_w[bitspan_cfg_pkg::TexAccW-1], fv_w})),
        .b_i(recip_m_ext),
        .c_i($signed({(bitspan_cfg_pkg::EdgeUvSigned != 0) & v1_w[bitspan_cfg_pkg::EdgeUvW-1], v1_w})),
        .e_i(recip_e),
        .q_o(v)
    );
    always_ff @(posedge clk_i) begin
      if (en) begin
        x_o <= x_w;
        last_o <= last_w;
        h_o <= h_w;
        fu_o <= fu_w;
        fv_o <= fv_w;
        recip_m_o <= recip_m;
        recip_e_o <= recip_e;
        u_o <= u;
        v_o <= v;
      end
    end
    assign step_o = 1'b0;
  end else begin : gen_const_depth_rows
    logic [bitspan_cfg_pkg::SpanUvW-1:0] u, v;
    quantize #(
        .InW(AccW + 1),
        .InFrac(bitspan_cfg_pkg::TexAccFrac),
        .OutW(bitspan_cfg_pkg::SpanUvW),
        .OutFrac(bitspan_cfg_pkg::SpanUvFrac),
        .OutSigned(bitspan_cfg_pkg::SpanUvSigned),
        .Rounding(bitspan_cfg_pkg::SpanUvRnd),
        .Overflow(bitspan_cfg_pkg::SpanUvOvf)
    ) u_u (
        .x_i($signed({(bitspan_cfg_pkg::TexAccSigned != 0) & fu_q[bitspan_cfg_pkg::TexAccW-1], fu_q})),
        .sticky_i(1'b0),
        .q_o(u)
    );
    quantize #(
        .InW(AccW + 1),
        .InFrac(bitspan_cfg_pkg::TexAccFrac),
        .OutW(bitspan_cfg_pkg::SpanUvW),
        .OutFrac(bitspan_cfg_pkg::SpanUvFrac),
        .OutSigned(bitspan_cfg_pkg::SpanUvSigned),
        .Rounding(bitspan_cfg_pkg::SpanUvRnd),
        .Overflow(bitspan_cfg_pkg::SpanUvOvf)
    ) u_v (
        .x_i($signed({(bitspan_cfg_pkg::TexAccSigned != 0) & fv_q[bitspan_cfg_pkg::TexAccW-1], fv_q})),
        .sticky_i(1'b0),
        .q_o(v)
    );
    always_ff @(posedge clk_i) begin
      if (en) begin
        x_o <= x_q;
        step_o <= step;
        last_o <= last;
        h_o <= h_q;
        fu_o <= fu_q;
        fv_o <= fv_q;
        u_o <= u;
        v_o <= v;
      end
    end
    assign recip_m_o = '0;
    assign recip_e_o = '0;

    logic unused;
    assign unused = ^{b_i, res_u1_i, res_v1_i};
  end

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_cfg_pkg::SpanClocks)
    else $error("span: has %0d clocks, told %0d", Clocks, bitspan_cfg_pkg::SpanClocks);
  end
  // A pixel that waits at the output stays as it is; an active span has pixels left.
  localparam int PixelW = IndexW + 2 + HW + 2 * AccW + bitspan_cfg_pkg::PixelRecipOutW + bitspan_cfg_pkg::ExponentW +
      2 * bitspan_cfg_pkg::SpanUvW;
  logic waiting_q;
  logic [PixelW-1:0] pixel, pixel_q;
  assign pixel = {x_o, step_o, last_o, h_o, fu_o, fv_o, recip_m_o, recip_e_o, u_o, v_o};
  always @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      waiting_q <= 1'b0;
      pixel_q <= '0;
    end else begin
      if (waiting_q) begin
        assert (out_valid_o && pixel == pixel_q)
        else $error("span: a waiting pixel was changed or withdrawn");
      end
      if (active_q) begin
        assert (left_q != '0)
        else $error("span: an active span without pixels");
      end
      waiting_q <= out_valid_o && !out_ready_i;
      pixel_q <= pixel;
    end
  end
`endif
endmodule
