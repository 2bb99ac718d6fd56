// SPDX-License-Identifier: Apache-2.0
// span of docs/numeric-spec.md: walks a span record's pixels and issues one per PixelInterval clocks.
//
//   delta_f           issue: h, fu, fv | h + B | R_pixel(h + B) | u = u1 + fu / (h + B), v: product, shift (2), sum, Q
//   hyperbolic        issue: h, fu, fv | h + B | u = fu / (h + B), v: magnitude, quotient, Q
//   const_depth_rows, affine   issue: fu, fv   | u = fu, v = fv
//
// Shades and channels are narrowed at the issue and wait beside these.
//
// A record is taken while no span is active, or on the clock that issues the last pixel of one. Behind the issue,
// everything shifts together on en, which a buffer of two pixels at the output gives from a register. Enabled clocks are
// ticks, as in span_setup: with an interval above 1 pixels are issued on its multiples, u and v take turns in one
// multiplier, and what waits is held instead of shifted. Tick t of a pixel is the t-th after that of its issue.
module span (
    input  logic clk_i,
    input  logic rst_ni,
    // Constant B of the depth code; stable while records are in flight.
    input  logic [bitspan_cfg_pkg::SetupBW-1:0] b_i,
    // The span record, as span_setup delivers it.
    input  logic res_valid_i,
    output logic take_o,
    input  logic [bitspan_cfg_pkg::SpanRecordW-1:0] res_i,
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
    output logic [bitspan_cfg_pkg::SpanUvW-1:0] v_o,
    // Four side by side, red lowest; 0 without shades. The channels stand above them.
    output logic [bitspan_cfg_pkg::SidesW-1:0] shade_o
);
  localparam int IndexW = bitspan_cfg_pkg::PixelIndexW;
  localparam int HW = bitspan_cfg_pkg::SpanHW;
  localparam int HStepW = bitspan_cfg_pkg::SpanHStepW;
  localparam int AccW = bitspan_cfg_pkg::TexAccW;
  localparam int UvW = bitspan_cfg_pkg::EdgeUvW;
  localparam int KW = bitspan_cfg_pkg::PlaneKW;
  localparam int PhaseW = bitspan_cfg_pkg::PhaseW;
  localparam int MW = bitspan_cfg_pkg::PixelRecipOutW;
  localparam int EW = bitspan_cfg_pkg::ExponentW;
  localparam int OutUvW = bitspan_cfg_pkg::SpanUvW;
  localparam int ShadeW = bitspan_cfg_pkg::SpanShadeW;
  localparam bit Shades = bitspan_cfg_pkg::Shades != 0;
  localparam bit Linear = bitspan_cfg_pkg::LinearTexture != 0;
  localparam bit Quotients = bitspan_cfg_pkg::PixelQuotients != 0;
  localparam int PixelUnitClocks = bitspan_cfg_pkg::PixelUnitClocks;
  localparam int ProductClocks = bitspan_cfg_pkg::ProductClocks;
  localparam int Interval = bitspan_cfg_pkg::PixelInterval;
  localparam int PhaseTicksW = (Interval > 1) ? $clog2(Interval) : 1;
  // The ticks of the reciprocal, of the later slot of u and v in their multiplier, and of the pixel at the output.
  localparam int RecipTick = 1 + PixelUnitClocks;
  localparam int Digits = bitspan_cfg_pkg::ProductDigits;
  localparam int LastSlot = (Interval > 1) ? RecipTick + Digits : RecipTick;
  localparam int SharedProductClocks = bitspan_cfg_pkg::SharedProductClocks;
  localparam int Clocks = Linear ? 1 : Quotients ? RecipTick + 1 :
                          (Interval > 1) ? LastSlot + 1 + SharedProductClocks + 4 : RecipTick + ProductClocks + 4;

  logic [IndexW-1:0] res_x, res_count;
  logic [bitspan_cfg_pkg::RowRecipOutW-1:0] unused_m;
  logic [EW-1:0] unused_e;
  logic [PhaseW-1:0] res_phase;
  logic [KW-1:0] res_k;
  logic [bitspan_cfg_pkg::SpanFDiffW-1:0] unused_fu_diff, unused_fv_diff;
  logic [UvW-1:0] res_u1, res_v1;
  logic [bitspan_cfg_pkg::LinesAccW-1:0] res_start;
  logic [bitspan_cfg_pkg::LinesStepW-1:0] res_step0;
  logic [bitspan_cfg_pkg::LinesStep1W-1:0] res_step1;
  assign {res_step1, res_step0, res_start, res_v1, res_u1, unused_fv_diff, unused_fu_diff, res_k, res_phase, unused_m,
          unused_e, res_count, res_x} = res_i;
  logic unused_record;
  assign unused_record = ^{unused_m, unused_e, unused_fu_diff, unused_fv_diff};

  logic en, last_q, take, active_q;
  logic [IndexW-1:0] x_q, left_q;
  // The tick modulo Interval, and whether a pixel is issued on it where there is one.
  logic [PhaseTicksW-1:0] tick_q;
  logic slot, issues, issue;
  if (Interval > 1) begin : gen_ticks
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) tick_q <= '0;
      else if (en) tick_q <= (tick_q == PhaseTicksW'(Interval - 1)) ? '0 : tick_q + PhaseTicksW'(1);
    end
    assign slot = tick_q == '0;
  end else begin : gen_each_tick
    assign tick_q = '0;
    assign slot = 1'b1;
  end
  assign issues = en && slot;
  assign issue = active_q && issues;
  assign take = res_valid_i && (!active_q || (last_q && issues));
  assign take_o = take;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) active_q <= 1'b0;
    else if (take) active_q <= 1'b1;
    else if (issues && last_q) active_q <= 1'b0;
  end
  // last_q: one pixel is left.
  always_ff @(posedge clk_i) begin
    if (take) begin
      x_q <= res_x;
      left_q <= res_count;
      last_q <= res_count == IndexW'(1);
    end else if (issue) begin
      x_q <= x_q + IndexW'(1);
      left_q <= left_q - IndexW'(1);
      last_q <= left_q == IndexW'(2);
    end
  end

  // The digital line moves a pixel to the side where the phase leaves 0..1.
  logic step;
  if (bitspan_cfg_pkg::DigitalLine != 0) begin : gen_line
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
        phase_q <= res_phase;
        k_q <= res_k;
      end else if (issue) begin
        phase_q <= sum[PhaseW-1:0];
      end
    end
  end else begin : gen_no_line
    assign step = 1'b0;
    logic unused;
    assign unused = ^{res_phase, res_k};
  end

  // The lines' registers; h has one step.
  logic [bitspan_cfg_pkg::LinesAccW-1:0] acc_q;
  for (genvar i = 0; i < bitspan_cfg_pkg::Lines; i++) begin : gen_register
    localparam int LineAccW = bitspan_cfg_pkg::LineAccW[32*i+:32];
    localparam int AccAt = bitspan_cfg_pkg::LineAccAt[32*i+:32];
    localparam int LineStepW = bitspan_cfg_pkg::LineStepW[32*i+:32];
    localparam int StepAt = bitspan_cfg_pkg::LineStepAt[32*i+:32];
    localparam int Step1At = (i == 0) ? 0 : StepAt - HStepW;
    logic [LineStepW-1:0] step0, step1;
    assign step0 = res_step0[StepAt+:LineStepW];
    if (i == 0) begin : gen_one_step
      assign step1 = step0;
    end else begin : gen_two_steps
      assign step1 = res_step1[Step1At+:LineStepW];
    end
    span_register #(
        .AccW(LineAccW),
        .AccFrac(bitspan_cfg_pkg::LineAccFrac[32*i+:32]),
        .AccSigned(bitspan_cfg_pkg::LineAccSigned[32*i+:32]),
        .AccRnd(bitspan_cfg_pkg::LineAccRnd[32*i+:32]),
        .AccOvf(bitspan_cfg_pkg::LineAccOvf[32*i+:32]),
        .StepW(LineStepW),
        .StepFrac(bitspan_cfg_pkg::LineStepFrac[32*i+:32]),
        .StepSigned(bitspan_cfg_pkg::LineStepSigned[32*i+:32])
    ) u_register (
        .clk_i,
        .take_i(take),
        .issue_i(issue),
        .start_i(res_start[AccAt+:LineAccW]),
        .step0_i(step0),
        .step1_i(step1),
        .second_i(step),
        .q_o(acc_q[AccAt+:LineAccW])
    );
  end
  logic [HW-1:0] h_q;
  logic [2*AccW-1:0] f_q;
  assign {f_q, h_q} = acc_q[HW+2*AccW-1:0];

  // What a pixel has of the shades, and above them of the channels.
  localparam int UnusedW = Shades ? 0 : 4 * ShadeW;
  localparam int OwnSidesW = bitspan_cfg_pkg::SidesW - UnusedW;
  // sides: what waited in shade_out, and the channels that are divided.
  logic [bitspan_cfg_pkg::SidesW-1:0] shade, shade_out, sides;
  assign sides[4*ShadeW-1:0] = shade_out[4*ShadeW-1:0];
  if (Shades) begin : gen_shades
    for (genvar i = 0; i < 4; i++) begin : gen_shade
      localparam int ShadeAccW = bitspan_cfg_pkg::SpanShadeAccW;
      logic [ShadeAccW-1:0] own;
      logic signed [ShadeAccW:0] exact;
      assign own = acc_q[HW+2*AccW+i*ShadeAccW+:ShadeAccW];
      assign exact = $signed({(bitspan_cfg_pkg::SpanShadeAccSigned != 0) & own[ShadeAccW-1], own});
      quantize #(
          .InW(ShadeAccW + 1),
          .InFrac(bitspan_cfg_pkg::SpanShadeAccFrac),
          .OutW(ShadeW),
          .OutFrac(bitspan_cfg_pkg::SpanShadeFrac),
          .OutSigned(bitspan_cfg_pkg::SpanShadeSigned),
          .Rounding(bitspan_cfg_pkg::SpanShadeRnd),
          .Overflow(bitspan_cfg_pkg::SpanShadeOvf)
      ) u_shade (
          .x_i(exact),
          .sticky_i(1'b0),
          .q_o(shade[i*ShadeW+:ShadeW])
      );
    end
  end else begin : gen_no_shades
    assign shade[4*ShadeW-1:0] = '0;
    assign shade_out[4*ShadeW-1:0] = '0;
    logic unused;
    assign unused = (^shade) ^ (^sides) ^ (^tick_q);
  end
  // The channels are the last lines. Behind the lines' registers the package has the formats of their values.
  localparam int Channels = bitspan_cfg_pkg::Lines - (Shades ? 7 : 3);
  for (genvar i = 0; i < Channels; i++) begin : gen_channel
    localparam int Line = bitspan_cfg_pkg::Lines - Channels + i;
    localparam int Value = bitspan_cfg_pkg::Lines + i;
    localparam int LineAccW = bitspan_cfg_pkg::LineAccW[32*Line+:32];
    localparam int LineAccAt = bitspan_cfg_pkg::LineAccAt[32*Line+:32];
    localparam int ValueW = bitspan_cfg_pkg::LineAccW[32*Value+:32];
    localparam int ValueAt = 4 * ShadeW + bitspan_cfg_pkg::LineAccAt[32*Value+:32] - bitspan_cfg_pkg::LinesAccW;
    if (bitspan_cfg_pkg::LineDivided[32*Line+:32] == 0) begin : gen_narrowed
      logic [LineAccW-1:0] own;
      logic signed [LineAccW:0] exact;
      assign own = acc_q[LineAccAt+:LineAccW];
      assign exact = $signed({(bitspan_cfg_pkg::LineAccSigned[32*Line+:32] != 0) & own[LineAccW-1], own});
      quantize #(
          .InW(LineAccW + 1),
          .InFrac(bitspan_cfg_pkg::LineAccFrac[32*Line+:32]),
          .OutW(ValueW),
          .OutFrac(bitspan_cfg_pkg::LineAccFrac[32*Value+:32]),
          .OutSigned(bitspan_cfg_pkg::LineAccSigned[32*Value+:32]),
          .Rounding(bitspan_cfg_pkg::LineAccRnd[32*Value+:32]),
          .Overflow(bitspan_cfg_pkg::LineAccOvf[32*Value+:32])
      ) u_value (
          .x_i(exact),
          .sticky_i(1'b0),
          .q_o(shade[ValueAt+:ValueW])
      );
      assign sides[ValueAt+:ValueW] = shade_out[ValueAt+:ValueW];
    end else begin : gen_divided
      assign shade[ValueAt+:ValueW] = '0;
      logic unused;
      assign unused = ^shade_out[ValueAt+:ValueW];
    end
  end
  if (OwnSidesW > 0) begin : gen_sides
    span_delay #(
        .Width(OwnSidesW),
        .From(0),
        .To(Clocks)
    ) u_sides (
        .clk_i,
        .en_i(en),
        .phase_i(tick_q),
        .d_i(shade[bitspan_cfg_pkg::SidesW-1:UnusedW]),
        .q_o(shade_out[bitspan_cfg_pkg::SidesW-1:UnusedW])
    );
  end

  // Valid bits of the pixels behind the issue; the last one goes to the buffer at the output.
  logic [Clocks-1:0] valid_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) valid_q <= '0;
    else if (en) valid_q <= Clocks'({valid_q, active_q && slot});
  end
  // fv stands above fu, v above u, and shades and channels above all.
  localparam int PixelW = IndexW + 2 + HW + 2 * AccW + MW + EW + 2 * OutUvW;
  localparam int OutW = PixelW + OwnSidesW;
  logic [PixelW-1:0] pixel;
  logic [OutW-1:0] made, buffered;
  assign made[PixelW-1:0] = pixel;
  skid #(
      .Width(OutW)
  ) u_out (
      .clk_i,
      .rst_ni,
      .in_valid_i(valid_q[Clocks-1]),
      .in_ready_o(en),
      .in_i(made),
      .out_valid_o,
      .out_ready_i,
      .out_o(buffered)
  );
  assign {x_o, step_o, last_o, h_o, fv_o, fu_o, recip_m_o, recip_e_o, v_o, u_o} = buffered[PixelW-1:0];
  if (OwnSidesW > 0) begin : gen_shade_out
    assign made[OutW-1:PixelW] = sides[bitspan_cfg_pkg::SidesW-1:UnusedW];
    assign shade_o[bitspan_cfg_pkg::SidesW-1:UnusedW] = buffered[PixelW+:OwnSidesW];
  end
  if (!Shades) begin : gen_no_shade_out
    assign shade_o[4*ShadeW-1:0] = '0;
  end

  // h + B.
  logic [bitspan_cfg_pkg::SpanSumW-2:0] operand_q;
  if (!Linear) begin : gen_operand
    logic [bitspan_cfg_pkg::SpanSumW-2:0] operand;
    depth_operand #(
        .HW(HW),
        .HFrac(bitspan_cfg_pkg::SpanHFrac),
        .HSigned(bitspan_cfg_pkg::SpanHSigned),
        .BW(bitspan_cfg_pkg::SetupBW),
        .BFrac(bitspan_cfg_pkg::SetupBFrac),
        .BSigned(bitspan_cfg_pkg::SetupBSigned),
        .SumW(bitspan_cfg_pkg::SpanSumW),
        .SumFrac(bitspan_cfg_pkg::SpanSumFrac)
    ) u_operand (
        .h_i(h_q),
        .b_i,
        .operand_o(operand)
    );
    always_ff @(posedge clk_i) begin
      if (en) operand_q <= operand;
    end
  end else begin : gen_no_operand
    assign operand_q = '0;
    logic unused;
    assign unused = (^b_i) ^ (^operand_q);
  end
  if (Linear || Quotients) begin : gen_no_base
    logic unused;
    assign unused = ^{res_u1, res_v1};
  end

  // Where a digital line may step, that waits beside the pixel, too.
  localparam int StepBits = (bitspan_cfg_pkg::DigitalLine != 0) ? 1 : 0;
  logic step_out;
  if (!Linear && !Quotients) begin : gen_delta_f
    logic [UvW-1:0] u1_q, v1_q;
    always_ff @(posedge clk_i) begin
      if (take) begin
        u1_q <= res_u1;
        v1_q <= res_v1;
      end
    end

    logic [MW-1:0] recip_m, recip_m_out;
    logic signed [EW-1:0] recip_e;
    logic [EW-1:0] recip_e_out;
    logic unused_a, unused_b;
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
        .NormaliseClocks(bitspan_cfg_pkg::NormaliseClocks),
        .ProductClocks(ProductClocks),
        .Clocks(PixelUnitClocks),
        .Table(bitspan_cfg_pkg::PixelRecipTable)
    ) u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i   (en),
        .start_i(valid_q[0]),
        .d_i    (operand_q),
        .a_o    (unused_a),
        .b_o    (unused_b),
        .product_i(2'b0),
        .m_o    (recip_m),
        .e_o    (recip_e)
    );

    logic [2*AccW-1:0] f_out;
    logic [2*OutUvW-1:0] uv;
    span_quotients #(
        .AW(AccW),
        .AFrac(bitspan_cfg_pkg::TexAccFrac),
        .ASigned(bitspan_cfg_pkg::TexAccSigned),
        .BaseW(UvW),
        .BaseFrac(bitspan_cfg_pkg::EdgeUvFrac),
        .BaseSigned(bitspan_cfg_pkg::EdgeUvSigned),
        .OutW(OutUvW),
        .OutFrac(bitspan_cfg_pkg::SpanUvFrac),
        .OutSigned(bitspan_cfg_pkg::SpanUvSigned),
        .OutRnd(bitspan_cfg_pkg::SpanUvRnd),
        .OutOvf(bitspan_cfg_pkg::SpanUvOvf),
        .RecipTick(RecipTick),
        .LastSlot(LastSlot),
        .Clocks(Clocks)
    ) u_uv (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .phase_i(tick_q),
        .numerator_i(f_q),
        .base_i({v1_q, u1_q}),
        .recip_m_i(recip_m),
        .recip_e_i(recip_e),
        .numerator_o(f_out),
        .q_o(uv)
    );

    // Channels that are divided come in pairs of one format.
    for (genvar i = 0; i + 1 < Channels; i++) begin : gen_divided
      localparam int Line = bitspan_cfg_pkg::Lines - Channels + i;
      localparam int Kept = bitspan_cfg_pkg::Lines + i;
      if (bitspan_cfg_pkg::LineDivided[32*Line+:32] == 1) begin : gen_pair
        localparam int LineAccW = bitspan_cfg_pkg::LineAccW[32*Line+:32];
        localparam int LineAccAt = bitspan_cfg_pkg::LineAccAt[32*Line+:32];
        localparam int ValueW = bitspan_cfg_pkg::LineAccW[32*Kept+:32];
        localparam int ValueAt =
            4 * ShadeW + bitspan_cfg_pkg::LineAccAt[32*Kept+:32] - bitspan_cfg_pkg::LinesAccW;
        logic [2*LineAccW-1:0] unused_numerator;
        span_quotients #(
            .AW(LineAccW),
            .AFrac(bitspan_cfg_pkg::LineAccFrac[32*Line+:32]),
            .ASigned(bitspan_cfg_pkg::LineAccSigned[32*Line+:32]),
            .OutW(ValueW),
            .OutFrac(bitspan_cfg_pkg::LineAccFrac[32*Kept+:32]),
            .OutSigned(bitspan_cfg_pkg::LineAccSigned[32*Kept+:32]),
            .OutRnd(bitspan_cfg_pkg::LineAccRnd[32*Kept+:32]),
            .OutOvf(bitspan_cfg_pkg::LineAccOvf[32*Kept+:32]),
            .RecipTick(RecipTick),
            .LastSlot(LastSlot),
            .Clocks(Clocks)
        ) u_values (
            .clk_i,
            .rst_ni,
            .en_i(en),
            .phase_i(tick_q),
            .numerator_i(acc_q[LineAccAt+:2*LineAccW]),
            .base_i(2'b0),
            .recip_m_i(recip_m),
            .recip_e_i(recip_e),
            .numerator_o(unused_numerator),
            .q_o(sides[ValueAt+:2*ValueW])
        );
        logic unused;
        assign unused = ^unused_numerator;
      end
    end

    // What is only delivered waits until u and v are there.
    logic [IndexW-1:0] x_out;
    logic last_out;
    logic [HW-1:0] h_out;
    logic [StepBits+IndexW+HW:0] waits;
    span_delay #(
        .Width(StepBits + IndexW + 1 + HW),
        .From(0),
        .To(Clocks)
    ) u_pixel (
        .clk_i,
        .en_i(en),
        .phase_i(tick_q),
        .d_i((StepBits + IndexW + 1 + HW)'({step, x_q, last_q, h_q})),
        .q_o(waits)
    );
    assign {x_out, last_out, h_out} = waits[IndexW+HW:0];
    assign step_out = StepBits != 0 && waits[StepBits+IndexW+HW];
    span_delay #(
        .Width(MW + EW),
        .From(RecipTick),
        .To(Clocks)
    ) u_recip (
        .clk_i,
        .en_i(en),
        .phase_i(tick_q),
        .d_i({recip_m, recip_e}),
        .q_o({recip_m_out, recip_e_out})
    );
    assign pixel = {x_out, step_out, last_out, h_out, f_out, recip_m_out, recip_e_out, uv};
  end else if (Quotients) begin : gen_hyperbolic
    // Two dividers side by side, one pixel per clock.
    localparam int SumW = bitspan_cfg_pkg::SpanSumW;
    localparam int QuotientW =
        bitspan_cfg_pkg::PixelDivIterations * bitspan_cfg_pkg::PixelRecipBitsPerCycle + 1;
    localparam int NumW = AccW + ((bitspan_cfg_pkg::TexAccSigned != 0) ? 0 : 1);
    logic [SumW-2:0] divisor;
    logic [2*AccW-1:0] f_sum;
    logic [2*OutUvW-1:0] uv;
    assign divisor = operand_q | (SumW - 1)'(operand_q == '0);
    always_ff @(posedge clk_i) begin
      if (en) f_sum <= f_q;
    end
    for (genvar i = 0; i < 2; i++) begin : gen_uv
      logic [AccW-1:0] f;
      logic signed [NumW-1:0] num;
      logic signed [QuotientW-1:0] quotient;
      logic sticky;
      logic [OutUvW-1:0] q, q_q;
      assign f = f_sum[i*AccW+:AccW];
      assign num = NumW'($signed({(bitspan_cfg_pkg::TexAccSigned != 0) & f[AccW-1], f}));
      divide #(
          .NW(NumW),
          .DW(SumW - 1),
          .Iterations(bitspan_cfg_pkg::PixelDivIterations),
          .BitsPerCycle(bitspan_cfg_pkg::PixelRecipBitsPerCycle),
          .Pipelined(1)
      ) u_divide (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .start_i(valid_q[0]),
          .n_i(num),
          .d_i(divisor),
          .q_o(quotient),
          .sticky_o(sticky)
      );
      quantize #(
          .InW(QuotientW),
          .InFrac(bitspan_cfg_pkg::PixelDivFrac),
          .OutW(OutUvW),
          .OutFrac(bitspan_cfg_pkg::SpanUvFrac),
          .OutSigned(bitspan_cfg_pkg::SpanUvSigned),
          .Rounding(bitspan_cfg_pkg::SpanUvRnd),
          .Overflow(bitspan_cfg_pkg::SpanUvOvf)
      ) u_uv (
          .x_i(quotient),
          .sticky_i(sticky),
          .q_o(q)
      );
      always_ff @(posedge clk_i) begin
        if (en) q_q <= q;
      end
      assign uv[i*OutUvW+:OutUvW] = q_q;
    end
    // What is only delivered waits until u and v are there.
    localparam int WaitW = IndexW + 1 + HW + 2 * AccW;
    logic [StepBits+WaitW-1:0] waits;
    delay_line #(
        .Width(StepBits + WaitW),
        .Depth(Clocks)
    ) u_pixel (
        .clk_i,
        .en_i(en),
        .d_i ((StepBits + WaitW)'({step, x_q, last_q, h_q, f_q})),
        .q_o (waits)
    );
    assign step_out = StepBits != 0 && waits[StepBits+WaitW-1];
    assign pixel = {waits[WaitW-1-:IndexW], step_out, waits[HW+2*AccW:0], {MW{1'b0}}, {EW{1'b0}}, uv};
  end else begin : gen_linear
    logic [2*OutUvW-1:0] uv;
    for (genvar i = 0; i < 2; i++) begin : gen_uv
      logic [AccW-1:0] f;
      logic signed [AccW:0] exact;
      logic [OutUvW-1:0] q;
      assign f = f_q[i*AccW+:AccW];
      assign exact = $signed({(bitspan_cfg_pkg::TexAccSigned != 0) & f[AccW-1], f});
      quantize #(
          .InW(AccW + 1),
          .InFrac(bitspan_cfg_pkg::TexAccFrac),
          .OutW(OutUvW),
          .OutFrac(bitspan_cfg_pkg::SpanUvFrac),
          .OutSigned(bitspan_cfg_pkg::SpanUvSigned),
          .Rounding(bitspan_cfg_pkg::SpanUvRnd),
          .Overflow(bitspan_cfg_pkg::SpanUvOvf)
      ) u_uv (
          .x_i(exact),
          .sticky_i(1'b0),
          .q_o(q)
      );
      assign uv[i*OutUvW+:OutUvW] = q;
    end
    logic [PixelW-1:0] pixel_q;
    always_ff @(posedge clk_i) begin
      if (en) pixel_q <= {x_q, step, last_q, h_q, f_q, {MW{1'b0}}, {EW{1'b0}}, uv};
    end
    assign pixel = pixel_q;
    assign step_out = step;
    logic unused;
    assign unused = step_out;
  end

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_cfg_pkg::SpanClocks)
    else $fatal(1, "span: has %0d clocks, told %0d", Clocks, bitspan_cfg_pkg::SpanClocks);
  end
  // A pixel that waits at the output stays as it is; an active span has pixels left.
  logic waits_q;
  logic [OutW-1:0] buffered_q;
  always @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      waits_q <= 1'b0;
      buffered_q <= '0;
    end else begin
      if (waits_q) begin
        assert (out_valid_o && buffered_q == buffered)
        else $fatal(1, "span: a waiting pixel was changed or withdrawn");
      end
      if (active_q) begin
        assert (left_q != '0 && last_q == (left_q == IndexW'(1)))
        else $fatal(1, "span: an active span has no pixels left");
      end
      waits_q <= out_valid_o && !out_ready_i;
      buffered_q <= buffered;
    end
  end
`endif
endmodule
