// SPDX-License-Identifier: Apache-2.0
// lod of docs/numeric-spec.md: a fragment in, its level of detail and the fraction out; one per clock.
//
//   zone_s    h --> h + B --> R_pixel --> s --> zone --> (s - S_z) k_z --> x --+
//   gradient  h --> h + B --> R_pixel --+                                      +--> lambda --> level, f --> skid --> out
//             u, gradients --> g - u h -+--> slopes --> rho --> x -------------+
//
// The stage shifts as one on the ready of the skid at its end, which is a register. It has the mode of the package alone;
// inputs of the other modes are ignored, and outputs of the other modes are 0.
module lod #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    // The constants B and A'; stable while fragments are in flight.
    input  logic [bitspan_pixel_pkg::SetupBW-1:0] b_i,
    input  logic [bitspan_pixel_pkg::DistanceAW-1:0] a_i,
    // Writes k of a level. Fragments in flight must not need it.
    input  logic load_i,
    input  logic [bitspan_pixel_pkg::LodLevelW-1:0] load_place_i,
    input  logic [bitspan_pixel_pkg::LodKW-1:0] load_data_i,
    // The fragment, with its triangle's gradients and its texture's last level, n - 1; what else it brings comes out
    // beside it.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_pixel_pkg::SpanHW-1:0] in_h_i,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] in_u_i,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] in_v_i,
    input  logic [bitspan_pixel_pkg::PlaneHGradW-1:0] in_h_x_i,
    input  logic [bitspan_pixel_pkg::PlaneHGradW-1:0] in_h_y_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] in_gu_x_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] in_gu_y_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] in_gv_x_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] in_gv_y_i,
    input  logic [bitspan_pixel_pkg::LodLevelW-1:0] in_last_i,
    input  logic [RestW-1:0] in_rest_i,
    // The record of docs/numeric-spec.md.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_pixel_pkg::PixelRecipOutW-1:0] out_recip_m_o,
    output logic [bitspan_pixel_pkg::ExponentW-1:0] out_recip_e_o,
    output logic [bitspan_pixel_pkg::DistanceSW-1:0] out_s_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] out_u_x_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] out_u_y_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] out_v_x_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] out_v_y_o,
    output logic [bitspan_pixel_pkg::LodLambdaW-1:0] out_lambda_o,
    output logic [bitspan_pixel_pkg::LodLevelW-1:0] out_level_o,
    output logic [bitspan_pixel_pkg::LodFracW-1:0] out_f_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int MW = bitspan_pixel_pkg::PixelRecipOutW;
  localparam int EW = bitspan_pixel_pkg::ExponentW;
  localparam int SW = bitspan_pixel_pkg::DistanceSW;
  localparam int SFrac = bitspan_pixel_pkg::DistanceSFrac;
  localparam int SSigned = bitspan_pixel_pkg::DistanceSSigned;
  localparam int KW = bitspan_pixel_pkg::LodKW;
  localparam int SlopeW = bitspan_pixel_pkg::LodSlopeW;
  localparam int SlopeSigned = bitspan_pixel_pkg::LodSlopeSigned;
  localparam int LambdaW = bitspan_pixel_pkg::LodLambdaW;
  localparam int LambdaFrac = bitspan_pixel_pkg::LodLambdaFrac;
  localparam int FracW = bitspan_pixel_pkg::LodFracW;
  localparam int LevelW = bitspan_pixel_pkg::LodLevelW;
  localparam int Levels = 1 << LevelW;
  localparam int IsZone = (bitspan_pixel_pkg::LodMode == bitspan_pixel_pkg::LodModeZone) ? 1 : 0;
  localparam int IsGradient = (bitspan_pixel_pkg::LodMode == bitspan_pixel_pkg::LodModeGradient) ? 1 : 0;

  // Clocks after acceptance at which a value is in its register.
  localparam int RecipAt = 1 + bitspan_pixel_pkg::PixelUnitClocks;
  // zone_s: s; the starts that it reaches; the zone; its start and k; s - S_z; its product with k_z; Q.
  localparam int DistanceAt = RecipAt + bitspan_pixel_pkg::LodDistanceProductClocks + 4;
  localparam int ZoneAt = DistanceAt + 2;
  localparam int IntoAt = ZoneAt + 2;
  localparam int ShareAt = IntoAt + bitspan_pixel_pkg::LodZoneProductClocks + 1;
  // gradient: g - u h; the slopes; their sizes, the larger ones of two, the largest; its logarithm.
  localparam int NumeratorAt = bitspan_pixel_pkg::LodGradientProductClocks + 1;
  localparam int FactorsAt = (NumeratorAt > RecipAt) ? NumeratorAt : RecipAt;
  localparam int SlopesAt = FactorsAt + bitspan_pixel_pkg::LodSlopeProductClocks + 4;
  localparam int RhoAt = SlopesAt + 3;
  localparam int LogAt = RhoAt + bitspan_pixel_pkg::NormaliseClocks;
  // x + bias; lambda; lambda held within the chain; level and f.
  localparam int SumAt = (IsZone != 0) ? ShareAt + 1 : (IsGradient != 0) ? LogAt + 1 : 0;
  localparam int Clocks = SumAt + 3;

  logic en;
  assign en = in_ready_o;

  // ---------------------------------------------------------------- R_pixel

  logic [MW-1:0] m;
  logic signed [EW-1:0] e;
  logic [MW+EW-1:0] recip_out;
  if (IsZone != 0 || IsGradient != 0) begin : gen_recip
    pixel_reciprocal u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .h_i(in_h_i),
        .b_i,
        .m_o(m),
        .e_o(e)
    );
    ring_line #(
        .Width(MW + EW),
        .Depth(Clocks - RecipAt)
    ) u_recip_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i({m, e}),
        .q_o(recip_out)
    );
  end else begin : gen_no_recip
    assign m = '0;
    assign e = '0;
    assign recip_out = '0;
    logic unused;
    assign unused = ^{m, e, in_h_i, b_i};
  end

  // ---------------------------------------------------------------- x + bias, by the mode

  // The bias has four fraction bits.
  localparam int LogFrac = SlopeW - 1;
  localparam int ShareFrac = FracW;
  localparam int XFrac = (IsZone != 0) ? ShareFrac : (IsGradient != 0) ? LogFrac : 0;
  localparam int SumFrac = (XFrac > 4) ? XFrac : 4;
  localparam int SumW = 11 + SumFrac;
  localparam logic signed [SumW-1:0] Bias = SumW'(bitspan_pixel_pkg::LodBias) <<< (SumFrac - 4);
  logic signed [SumW-1:0] sum;
  logic [SW-1:0] s_out;
  logic [4*SlopeW-1:0] slopes_out;
  logic unused_mode;

  if (IsZone != 0) begin : gen_zone
    logic [SW-1:0] s, s_into;
    multiply_round #(
        .AW(bitspan_pixel_pkg::DistanceAW),
        .AFrac(bitspan_pixel_pkg::DistanceAFrac),
        .ASigned(bitspan_pixel_pkg::DistanceASigned),
        .BW(MW),
        .BFrac(bitspan_pixel_pkg::PixelRecipOutFrac),
        .BSigned(bitspan_pixel_pkg::PixelRecipOutSigned),
        .EW(EW),
        .EMin(bitspan_pixel_pkg::PixelRecipEMin),
        .EMax(bitspan_pixel_pkg::PixelRecipEMax),
        .OutW(SW),
        .OutFrac(SFrac),
        .OutSigned(SSigned),
        .OutRnd(bitspan_pixel_pkg::DistanceSRnd),
        .OutOvf(bitspan_pixel_pkg::DistanceSOvf),
        .ProductClocks(bitspan_pixel_pkg::LodDistanceProductClocks)
    ) u_distance (
        .clk_i,
        .en_i(en),
        .a_i,
        .b_i(m),
        .c_i(1'sd0),
        .e_i(e),
        .q_o(s)
    );
    // s and the starts S_i = first 2^(i-16) on one grid, as signed numbers.
    localparam int Grid = (SFrac > 16) ? SFrac : 16;
    localparam int DistanceW = SW + Grid - SFrac + ((SSigned != 0) ? 0 : 1);
    localparam int StartW = 17 + Levels - 1 + Grid - 16 + 1;
    localparam int CompareW = (DistanceW > StartW) ? DistanceW : StartW;
    localparam logic signed [CompareW-1:0] First = CompareW'(bitspan_pixel_pkg::LodFirst) <<< (Grid - 16);
    logic signed [CompareW-1:0] distance, distance_into;
    assign distance = CompareW'($signed({(SSigned != 0) & s[SW-1], s})) <<< (Grid - SFrac);
    assign distance_into = CompareW'($signed({(SSigned != 0) & s_into[SW-1], s_into})) <<< (Grid - SFrac);
    delay_line #(
        .Width(SW),
        .Depth(IntoAt - 1 - DistanceAt)
    ) u_into_line (
        .clk_i,
        .en_i(en),
        .d_i(s),
        .q_o(s_into)
    );

    // The starts are in order, and so are those that s reaches: the zone is how many.
    logic [LevelW-1:0] last, last_q;
    logic [Levels-1:1] reached_q;
    logic [LevelW-1:0] zone, zone_q, zone_out;
    logic ends_q, ends_out;
    ring_line #(
        .Width(LevelW),
        .Depth(DistanceAt)
    ) u_last_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(in_last_i),
        .q_o(last)
    );
    always_comb begin
      zone = '0;
      for (int i = 1; i < Levels; i++) begin
        if (reached_q[i]) zone = LevelW'(i);
      end
    end
    always_ff @(posedge clk_i) begin
      if (en) begin
        for (int i = 1; i < Levels; i++) reached_q[i] <= LevelW'(i) <= last && distance >= (First <<< i);
        last_q <= last;
        zone_q <= zone;
        ends_q <= zone == last_q;
      end
    end

    // Its start and k, and how far s is into it.
    localparam int KFactorW = KW + ((bitspan_pixel_pkg::LodKSigned != 0) ? 0 : 1);
    localparam int IntoW = CompareW + 1;
    logic [KW-1:0] widths[Levels];
    logic [KW-1:0] width_q;
    logic signed [CompareW-1:0] start_q;
    logic signed [IntoW-1:0] into_q;
    logic signed [KFactorW-1:0] k_q;
    always_ff @(posedge clk_i) begin
      if (load_i) widths[load_place_i] <= load_data_i;
      if (en) begin
        width_q <= widths[zone_q];
        start_q <= First <<< zone_q;
        into_q <= IntoW'(distance_into) - IntoW'(start_q);
        k_q <= KFactorW'($signed({(bitspan_pixel_pkg::LodKSigned != 0) & width_q[KW-1], width_q}));
      end
    end
    logic signed [IntoW+KFactorW-1:0] product;
    mul_pipe #(
        .AW(IntoW),
        .BW(KFactorW),
        .Clocks(bitspan_pixel_pkg::LodZoneProductClocks)
    ) u_product (
        .clk_i,
        .en_i(en),
        .a_i(into_q),
        .b_i(k_q),
        .p_o(product)
    );
    logic [FracW-1:0] share, share_q;
    quantize #(
        .InW(IntoW + KFactorW),
        .InFrac(Grid + bitspan_pixel_pkg::LodKFrac),
        .OutW(FracW),
        .OutFrac(FracW),
        .OutSigned(0),
        .Rounding(bitspan_pixel_pkg::LodFracRnd),
        .Overflow(bitspan_pixel_pkg::LodFracOvf)
    ) u_share (
        .x_i(product),
        .sticky_i(1'b0),
        .q_o(share)
    );
    delay_line #(
        .Width(LevelW + 1),
        .Depth(ShareAt - ZoneAt)
    ) u_zone_line (
        .clk_i,
        .en_i(en),
        .d_i({zone_q, ends_q}),
        .q_o({zone_out, ends_out})
    );
    logic signed [SumW-1:0] sum_q;
    always_ff @(posedge clk_i) begin
      if (en) begin
        share_q <= share;
        sum_q <= (SumW'({1'b0, zone_out}) <<< SumFrac) +
                 (ends_out ? '0 : SumW'({1'b0, share_q}) <<< (SumFrac - ShareFrac)) + Bias;
      end
    end
    assign sum = sum_q;
    ring_line #(
        .Width(SW),
        .Depth(Clocks - DistanceAt)
    ) u_s_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(s),
        .q_o(s_out)
    );
  end else begin : gen_no_zone
    assign s_out = '0;
    logic unused;
    assign unused = ^{a_i, load_i, load_place_i, load_data_i};
  end

  if (IsGradient != 0) begin : gen_gradient
    localparam int UvW = bitspan_pixel_pkg::SpanUvW;
    localparam int HGradW = bitspan_pixel_pkg::PlaneHGradW;
    localparam int GGradW = bitspan_pixel_pkg::PlaneGGradW;
    // g - u h.
    localparam int ProductFrac = bitspan_pixel_pkg::SpanUvFrac + bitspan_pixel_pkg::PlaneHGradFrac;
    localparam int GFrac = bitspan_pixel_pkg::PlaneGGradFrac;
    localparam int Grid = (ProductFrac > GFrac) ? ProductFrac : GFrac;
    localparam int UvFactorW = UvW + ((bitspan_pixel_pkg::SpanUvSigned != 0) ? 0 : 1);
    localparam int HFactorW = HGradW + ((bitspan_pixel_pkg::PlaneHGradSigned != 0) ? 0 : 1);
    localparam int ProductW = UvFactorW + HFactorW;
    localparam int GSpanW = GGradW + Grid - GFrac + ((bitspan_pixel_pkg::PlaneGGradSigned != 0) ? 0 : 1);
    localparam int ProductSpanW = ProductW + Grid - ProductFrac;
    localparam int NumeratorW = ((GSpanW > ProductSpanW) ? GSpanW : ProductSpanW) + 1;
    logic [MW-1:0] m_factor;
    logic signed [EW-1:0] e_factor;
    ring_line #(
        .Width(MW + EW),
        .Depth(FactorsAt - RecipAt)
    ) u_factor_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i({m, e}),
        .q_o({m_factor, e_factor})
    );
    // u_x, u_y, v_x, v_y.
    logic [SlopeW-1:0] sizes_q[4];
    logic [4*SlopeW-1:0] slopes;
    for (genvar t = 0; t < 4; t++) begin : gen_slope
      logic [UvW-1:0] uv;
      logic [HGradW-1:0] h_grad;
      logic [GGradW-1:0] g_grad, g_late;
      assign uv = (t < 2) ? in_u_i : in_v_i;
      assign h_grad = (t % 2 == 0) ? in_h_x_i : in_h_y_i;
      assign g_grad = (t == 0) ? in_gu_x_i : (t == 1) ? in_gu_y_i : (t == 2) ? in_gv_x_i : in_gv_y_i;
      logic signed [UvFactorW-1:0] uv_factor;
      logic signed [HFactorW-1:0] h_factor;
      assign uv_factor = UvFactorW'($signed({(bitspan_pixel_pkg::SpanUvSigned != 0) & uv[UvW-1], uv}));
      assign h_factor = HFactorW'($signed({(bitspan_pixel_pkg::PlaneHGradSigned != 0) & h_grad[HGradW-1], h_grad}));
      logic signed [ProductW-1:0] product;
      mul_pipe #(
          .AW(UvFactorW),
          .BW(HFactorW),
          .Clocks(bitspan_pixel_pkg::LodGradientProductClocks)
      ) u_product (
          .clk_i,
          .en_i(en),
          .a_i(uv_factor),
          .b_i(h_factor),
          .p_o(product)
      );
      ring_line #(
          .Width(GGradW),
          .Depth(bitspan_pixel_pkg::LodGradientProductClocks)
      ) u_g_line (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .d_i(g_grad),
          .q_o(g_late)
      );
      logic signed [NumeratorW-1:0] own, numerator_q, numerator;
      assign own = NumeratorW'($signed({(bitspan_pixel_pkg::PlaneGGradSigned != 0) & g_late[GGradW-1], g_late})) <<<
                   (Grid - GFrac);
      always_ff @(posedge clk_i) begin
        if (en) numerator_q <= own - (NumeratorW'(product) <<< (Grid - ProductFrac));
      end
      logic [NumeratorW-1:0] waited;
      ring_line #(
          .Width(NumeratorW),
          .Depth(FactorsAt - NumeratorAt)
      ) u_numerator_line (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .d_i(numerator_q),
          .q_o(waited)
      );
      assign numerator = waited;
      logic [SlopeW-1:0] slope;
      multiply_round #(
          .AW(NumeratorW),
          .AFrac(Grid),
          .BW(MW),
          .BFrac(bitspan_pixel_pkg::PixelRecipOutFrac),
          .BSigned(bitspan_pixel_pkg::PixelRecipOutSigned),
          .EW(EW),
          .EMin(bitspan_pixel_pkg::PixelRecipEMin),
          .EMax(bitspan_pixel_pkg::PixelRecipEMax),
          .OutW(SlopeW),
          .OutFrac(bitspan_pixel_pkg::LodSlopeFrac),
          .OutSigned(SlopeSigned),
          .OutRnd(bitspan_pixel_pkg::LodSlopeRnd),
          .OutOvf(bitspan_pixel_pkg::LodSlopeOvf),
          .ProductClocks(bitspan_pixel_pkg::LodSlopeProductClocks)
      ) u_slope (
          .clk_i,
          .en_i(en),
          .a_i(numerator),
          .b_i(m_factor),
          .c_i(1'sd0),
          .e_i(e_factor),
          .q_o(slope)
      );
      assign slopes[(3-t)*SlopeW+:SlopeW] = slope;
      // The least value of a signed format has a size of SlopeW bits.
      always_ff @(posedge clk_i) begin
        if (en) sizes_q[t] <= ((SlopeSigned != 0) && slope[SlopeW-1]) ? -slope : slope;
      end
    end
    ring_line #(
        .Width(4 * SlopeW),
        .Depth(Clocks - SlopesAt)
    ) u_slopes_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(slopes),
        .q_o(slopes_out)
    );

    // rho, at least one ulp, and its logarithm: E, and behind the point what rho 2^-E has above 1.
    logic [SlopeW-1:0] larger_q[2];
    logic [SlopeW-1:0] rho, rho_q, normalised;
    localparam int ZerosW = $clog2(SlopeW + 1);
    logic [ZerosW-1:0] zeros;
    assign rho = (larger_q[1] > larger_q[0]) ? larger_q[1] : larger_q[0];
    always_ff @(posedge clk_i) begin
      if (en) begin
        larger_q[0] <= (sizes_q[1] > sizes_q[0]) ? sizes_q[1] : sizes_q[0];
        larger_q[1] <= (sizes_q[3] > sizes_q[2]) ? sizes_q[3] : sizes_q[2];
        rho_q <= (rho == '0) ? SlopeW'(1) : rho;
      end
    end
    lzc_norm #(
        .Width(SlopeW),
        .Clocks(bitspan_pixel_pkg::NormaliseClocks)
    ) u_norm (
        .clk_i,
        .en_i(en),
        .d_i(rho_q),
        .n_o(normalised),
        .zeros_o(zeros)
    );
    // E - 1 = SlopeW - 2 - LodSlopeFrac - zeros, and the top bit of what is normalised is the 1 that is left.
    localparam int TopExponent = SlopeW - 2 - bitspan_pixel_pkg::LodSlopeFrac;
    localparam logic signed [SumW-1:0] Top = SumW'(TopExponent);
    logic signed [SumW-1:0] sum_q;
    always_ff @(posedge clk_i) begin
      if (en) begin
        sum_q <= ((Top - SumW'({1'b0, zeros})) <<< SumFrac) + (SumW'({1'b0, normalised}) <<< (SumFrac - LogFrac)) + Bias;
      end
    end
    assign sum = sum_q;
  end else begin : gen_no_gradient
    assign slopes_out = '0;
    logic unused;
    assign unused = ^{in_u_i, in_v_i, in_h_x_i, in_h_y_i, in_gu_x_i, in_gu_y_i, in_gv_x_i, in_gv_y_i};
  end

  if (IsZone == 0 && IsGradient == 0) begin : gen_bias
    assign sum = Bias;
    assign unused_mode = rst_ni;
  end else begin : gen_mode
    assign unused_mode = 1'b0;
  end

  // ---------------------------------------------------------------- lambda, level and f

  logic [LambdaW-1:0] lambda, lambda_q;
  quantize #(
      .InW(SumW),
      .InFrac(SumFrac),
      .OutW(LambdaW),
      .OutFrac(LambdaFrac),
      .OutSigned(bitspan_pixel_pkg::LodLambdaSigned),
      .Rounding(bitspan_pixel_pkg::LodLambdaRnd),
      .Overflow(bitspan_pixel_pkg::LodLambdaOvf)
  ) u_lambda (
      .x_i(sum),
      .sticky_i(1'b0),
      .q_o(lambda)
  );
  // On a grid that has the half.
  localparam int HeldFrac = (LambdaFrac > 1) ? LambdaFrac : 1;
  localparam int HeldW = LevelW + HeldFrac;
  localparam int OwnW = LambdaW + HeldFrac - LambdaFrac + 1;
  localparam int WideW = ((OwnW > HeldW + 1) ? OwnW : HeldW + 1);
  logic [LevelW-1:0] last_lambda;
  logic signed [WideW-1:0] wide, limit;
  logic [HeldW-1:0] held_q;
  ring_line #(
      .Width(LevelW),
      .Depth(SumAt + 1)
  ) u_last_lambda_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(in_last_i),
      .q_o(last_lambda)
  );
  assign wide = WideW'($signed({(bitspan_pixel_pkg::LodLambdaSigned != 0) & lambda_q[LambdaW-1], lambda_q})) <<<
                (HeldFrac - LambdaFrac);
  assign limit = WideW'({1'b0, last_lambda}) <<< HeldFrac;
  logic [FracW-1:0] f, f_q;
  logic [LevelW-1:0] level_q;
  if (bitspan_pixel_pkg::LodMixesLevels != 0) begin : gen_linear
    quantize #(
        .InW(HeldFrac + 1),
        .InFrac(HeldFrac),
        .OutW(FracW),
        .OutFrac(FracW),
        .OutSigned(0),
        .Rounding(bitspan_pixel_pkg::LodFracRnd),
        .Overflow(bitspan_pixel_pkg::LodFracOvf)
    ) u_f (
        .x_i({1'b0, held_q[HeldFrac-1:0]}),
        .sticky_i(1'b0),
        .q_o(f)
    );
    always_ff @(posedge clk_i) begin
      if (en) level_q <= held_q[HeldFrac+:LevelW];
    end
  end else begin : gen_nearest
    assign f = '0;
    // l is at most a whole level: the sum does not overflow.
    always_ff @(posedge clk_i) begin
      if (en) level_q <= held_q[HeldFrac+:LevelW] + LevelW'(held_q[HeldFrac-1]);
    end
    logic unused;
    assign unused = ^held_q[HeldFrac-1:0];
  end
  logic [LambdaW-1:0] lambda_out;
  always_ff @(posedge clk_i) begin
    if (en) begin
      lambda_q <= lambda;
      held_q <= wide[WideW-1] ? '0 : (wide > limit) ? limit[HeldW-1:0] : wide[HeldW-1:0];
      f_q <= f;
    end
  end
  delay_line #(
      .Width(LambdaW),
      .Depth(2)
  ) u_lambda_line (
      .clk_i,
      .en_i(en),
      .d_i(lambda_q),
      .q_o(lambda_out)
  );

  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(MW + EW + SW + 4 * SlopeW + LambdaW + LevelW + FracW)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i({recip_out, s_out, slopes_out, lambda_out, level_q, f_q}),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({out_recip_m_o, out_recip_e_o, out_s_o, out_u_x_o, out_u_y_o, out_v_x_o, out_v_y_o, out_lambda_o,
                   out_level_o, out_f_o}),
      .out_rest_o
  );
  logic unused;
  assign unused = unused_mode;

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::LodClocks)
    else $fatal(1, "lod: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::LodClocks);
  end
`endif
endmodule
