// SPDX-License-Identifier: Apache-2.0
// light of docs/numeric-spec.md, per pixel: the normal of a fragment and where it is in, its brightness and its colour
// times it out; one per clock.
//
//   x, y, s --> place --> place_0 - place --> unit_vector --> L --+
//   n ----------------------------------> unit_vector --> N' -----+--> c = N'.L --> g = L_z - 2 c N'_z --+
//                                                                                                       |
//   r, g, b ----------------------------------------------+                                              |
//   out <-- skid <-- r V <--------------------------------+-- V = kd c + ks spec + ka <-- spec <-- table +
//
// The stage shifts as one on the ready of the skid at its end, which is a register. Without LightHasPoint lights are far
// away, and there is no place. What the configuration has beside that takes clocks and cells where it has it:
//
//   LightHasRelief  a texel is the normal, and L leads through the field of its map    in front of both cosines
//   LightHasLunar   c' = c / (1 + kl max(0, -N'_z))                                     beside the highlight
//   LightHasShadow  U' = F U, F of a shadow map's texel                                 behind U = kd c' + ks spec
//   LightHasFall    V = f U' + ka, f = 1 / (R^a + K)                                    behind that; f beside all of it
module light #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    // Writes an entry of the highlight's table, 0 .. 2^index_bits. Fragments in flight must not need it.
    input  logic load_i,
    input  logic [bitspan_light_pkg::LightIndexBits:0] load_place_i,
    input  logic [bitspan_light_pkg::LightSpecularW-1:0] load_data_i,
    // The view's light; stable while fragments are in flight. A point: where it stands, the picture's size, and the
    // scale, which is divided by 2^scale_e_i. Else the direction, of length 1.
    input  logic point_i,
    input  logic [bitspan_light_pkg::LightPositionW-1:0] place_x_i,
    input  logic [bitspan_light_pkg::LightPositionW-1:0] place_y_i,
    input  logic [bitspan_light_pkg::LightPositionW-1:0] place_z_i,
    input  logic [bitspan_light_pkg::LightScaleW-1:0] scale_i,
    input  logic signed [bitspan_light_pkg::ScaleExponentW-1:0] scale_e_i,
    input  logic [bitspan_light_pkg::CoordW-1:0] width_i,
    input  logic [bitspan_light_pkg::CoordW-1:0] height_i,
    input  logic [bitspan_light_pkg::LightDirectionW-1:0] far_x_i,
    input  logic [bitspan_light_pkg::LightDirectionW-1:0] far_y_i,
    input  logic [bitspan_light_pkg::LightDirectionW-1:0] far_z_i,
    input  logic [bitspan_light_pkg::LightValueW-1:0] diffuse_i,
    input  logic [bitspan_light_pkg::LightValueW-1:0] highlight_i,
    input  logic [bitspan_light_pkg::LightValueW-1:0] ambient_i,
    // LightHasLunar: whether the light has the lunar law, and its k. LightHasFall: whether it falls, the reciprocal of its
    // reach, which is divided by 2^reach_e_i, and the offset.
    input  logic lunar_i,
    input  logic [bitspan_light_pkg::LightLunarW-1:0] lunar_k_i,
    input  logic falls_i,
    input  logic [bitspan_light_pkg::LightScaleW-1:0] reach_i,
    input  logic signed [bitspan_light_pkg::ScaleExponentW-1:0] reach_e_i,
    input  logic [bitspan_light_pkg::LightDistanceW-1:0] offset_i,
    // The fragment; what else it brings comes out beside it.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_light_pkg::CoordW-1:0] in_x_i,
    input  logic [bitspan_light_pkg::CoordW-1:0] in_y_i,
    input  logic [bitspan_light_pkg::DistanceSW-1:0] in_s_i,
    input  logic [bitspan_light_pkg::NormalValueW-1:0] in_nx_i,
    input  logic [bitspan_light_pkg::NormalValueW-1:0] in_ny_i,
    input  logic [bitspan_light_pkg::NormalValueW-1:0] in_nz_i,
    input  logic [bitspan_light_pkg::TextureColorW-1:0] in_r_i,
    input  logic [bitspan_light_pkg::TextureColorW-1:0] in_g_i,
    input  logic [bitspan_light_pkg::TextureColorW-1:0] in_b_i,
    // LightHasShadow, LightHasRelief: the second unit's texel, and whether its red is a shadow's or all of it a normal.
    input  logic in_shadow_i,
    input  logic in_relief_i,
    input  logic [bitspan_light_pkg::TextureMixW-1:0] in_vr_i,
    input  logic [bitspan_light_pkg::TextureMixW-1:0] in_vg_i,
    input  logic [bitspan_light_pkg::TextureMixW-1:0] in_vb_i,
    // LightHasRelief: where the light is in the map's field, and the fragment.
    input  logic [bitspan_light_pkg::ReliefValueW-1:0] in_px_i,
    input  logic [bitspan_light_pkg::ReliefValueW-1:0] in_py_i,
    input  logic [bitspan_light_pkg::ReliefValueW-1:0] in_pz_i,
    input  logic [bitspan_light_pkg::SpanUvW-1:0] in_u_i,
    input  logic [bitspan_light_pkg::SpanUvW-1:0] in_v_i,
    input  logic [RestW-1:0] in_rest_i,
    // The record of docs/numeric-spec.md.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_light_pkg::LightNormalW-1:0] out_nx_o,
    output logic [bitspan_light_pkg::LightNormalW-1:0] out_ny_o,
    output logic [bitspan_light_pkg::LightNormalW-1:0] out_nz_o,
    output logic [bitspan_light_pkg::LightDirectionW-1:0] out_lx_o,
    output logic [bitspan_light_pkg::LightDirectionW-1:0] out_ly_o,
    output logic [bitspan_light_pkg::LightDirectionW-1:0] out_lz_o,
    output logic [bitspan_light_pkg::LightCosineW-1:0] out_cosine_o,
    output logic [bitspan_light_pkg::LightCosineW-1:0] out_mirrored_o,
    output logic [bitspan_light_pkg::LightSpecularW-1:0] out_specular_o,
    output logic [bitspan_light_pkg::LightValueW-1:0] out_value_o,
    output logic [bitspan_light_pkg::TextureColorW-1:0] out_r_o,
    output logic [bitspan_light_pkg::TextureColorW-1:0] out_g_o,
    output logic [bitspan_light_pkg::TextureColorW-1:0] out_b_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int CoordW = bitspan_light_pkg::CoordW;
  localparam int SW = bitspan_light_pkg::DistanceSW;
  localparam int PositionW = bitspan_light_pkg::LightPositionW;
  localparam int PositionFrac = bitspan_light_pkg::LightPositionFrac;
  localparam int ValueInW = bitspan_light_pkg::NormalValueW;
  localparam int NormalW = bitspan_light_pkg::LightNormalW;
  localparam int DirectionW = bitspan_light_pkg::LightDirectionW;
  localparam int CosineW = bitspan_light_pkg::LightCosineW;
  localparam int CosineFrac = bitspan_light_pkg::LightCosineFrac;
  localparam int SpecularW = bitspan_light_pkg::LightSpecularW;
  localparam int SpecularFrac = bitspan_light_pkg::LightSpecularFrac;
  localparam int ValueW = bitspan_light_pkg::LightValueW;
  localparam int ValueFrac = bitspan_light_pkg::LightValueFrac;
  localparam int ColorW = bitspan_light_pkg::TextureColorW;
  localparam int IndexBits = bitspan_light_pkg::LightIndexBits;
  localparam int MixW = bitspan_light_pkg::TextureMixW;
  localparam int MixFrac = bitspan_light_pkg::TextureMixFrac;
  localparam int FallW = bitspan_light_pkg::LightFallW;
  localparam int ShareW = bitspan_light_pkg::TextureAlphaW;
  localparam bit HasPoint = bitspan_light_pkg::LightHasPoint != 0;
  localparam bit HasRelief = bitspan_light_pkg::LightHasRelief != 0;
  localparam bit HasLunar = bitspan_light_pkg::LightHasLunar != 0;
  localparam bit HasShadow = bitspan_light_pkg::LightHasShadow != 0;
  localparam bit HasFall = bitspan_light_pkg::LightHasFall != 0;
  localparam bit FallsBySquare = bitspan_light_pkg::LightFallsBySquare != 0;
  localparam bit FallsToViewer = bitspan_light_pkg::LightFallsToViewer != 0;

  // All multiplications take equally many clocks. The first brings the factors to the multipliers, which lie all over a
  // device.
  localparam int ProductClocks = bitspan_light_pkg::LightProductClocks;
  localparam int VectorClocks = bitspan_light_pkg::LightVectorClocks;

  localparam int RootClocks = bitspan_light_pkg::LightRootClocks;
  localparam int RoundedClocks = ProductClocks + 4;

  // Clocks after acceptance at which a value is in its register.
  localparam int PlaceAt = 1 + ProductClocks + RoundedClocks;
  localparam int DirectionAt = HasPoint ? PlaceAt + 1 + VectorClocks : 0;
  localparam int NormalAt = (HasRelief ? 1 : 0) + VectorClocks;
  localparam int JoinAt = (DirectionAt > NormalAt) ? DirectionAt : NormalAt;
  localparam int CosineAt = JoinAt + ProductClocks + 2;
  localparam int MirroredAt = CosineAt + ProductClocks + 4;
  localparam int EntryAt = MirroredAt + 4;
  localparam int SpecularAt = EntryAt + ProductClocks + 4 + 1;
  // c, 0 where it is not above 0, and divided by the lunar law; the sum's first part, and all of it.
  localparam int LitAt = CosineAt + 2;
  localparam int LunarClocks = 1 + RootClocks + 2 * RoundedClocks;
  localparam int ScatteredAt = HasLunar ? LitAt + 1 + LunarClocks : LitAt;
  localparam int BaseAt = ScatteredAt + ProductClocks + 1;
  localparam int SumAt = (SpecularAt > BaseAt) ? SpecularAt : BaseAt;
  localparam int NearAt = SumAt + RoundedClocks;
  localparam int ShadedAt = HasShadow ? NearAt + RoundedClocks : NearAt;
  // What brightness falls by: from D, its length, R, T, f.
  localparam int AwayAt = FallsToViewer ? PlaceAt : PlaceAt + 1;
  localparam int LengthAt = AwayAt + VectorClocks + ProductClocks + 2;
  localparam int DividedAt = LengthAt + RoundedClocks + (FallsBySquare ? RoundedClocks : 1);
  localparam int FallClocks = 1 + RootClocks + RoundedClocks + 1 + 4;
  localparam int FallAt = HasFall ? DividedAt + FallClocks : 0;
  localparam int FallenAt = (FallAt > ShadedAt) ? FallAt : ShadedAt;
  localparam int ValueAt = HasFall ? FallenAt + RoundedClocks : HasShadow ? ShadedAt + 1 : NearAt;
  localparam int Clocks = ValueAt + RoundedClocks;

  logic en;
  assign en = in_ready_o;

  // ---------------------------------------------------------------- the field of a map of normals

  localparam int ReliefW = bitspan_light_pkg::ReliefValueW;
  localparam int ReliefFrac = bitspan_light_pkg::ReliefValueFrac;
  localparam int UvW = bitspan_light_pkg::SpanUvW;
  localparam int UvFrac = bitspan_light_pkg::SpanUvFrac;
  localparam int FieldFrac = (ReliefFrac > UvFrac) ? ReliefFrac : UvFrac;
  localparam int ReliefUp = FieldFrac - ReliefFrac;
  localparam int UvUp = FieldFrac - UvFrac;
  localparam int FieldW = ((ReliefW + ReliefUp > UvW + UvUp) ? ReliefW + ReliefUp : UvW + UvUp) + 2;
  // Both vectors to the light have one unit, unless brightness falls along the one that a texel has no part in.
  localparam bit SharesUnit = HasRelief && HasPoint && (!HasFall || FallsToViewer);
  logic [3*FieldW-1:0] field;  // (X - u, Y - v, Z), a clock after acceptance
  logic relief_j;  // at JoinAt
  logic relief_m;  // at MirroredAt
  logic relief_s;  // at ScatteredAt
  if (HasRelief) begin : gen_field
    logic [ReliefW-1:0] place[3];
    logic [UvW-1:0] at[3];
    assign place[0] = in_px_i;
    assign place[1] = in_py_i;
    assign place[2] = in_pz_i;
    assign at[0] = in_u_i;
    assign at[1] = in_v_i;
    assign at[2] = '0;
    for (genvar axis = 0; axis < 3; axis++) begin : gen_axis
      logic signed [FieldW-1:0] to, from;
      assign to = FieldW'($signed({(bitspan_light_pkg::ReliefValueSigned != 0) & place[axis][ReliefW-1], place[axis]}));
      assign from = FieldW'($signed({(bitspan_light_pkg::SpanUvSigned != 0) & at[axis][UvW-1], at[axis]}));
      always_ff @(posedge clk_i) begin
        if (en) field[axis*FieldW+:FieldW] <= (to <<< ReliefUp) - (from <<< UvUp);
      end
    end
    ring_line #(
        .Width(1),
        .Depth(JoinAt)
    ) u_relief_j_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(in_relief_i),
        .q_o(relief_j)
    );
    ring_line #(
        .Width(1),
        .Depth(MirroredAt - JoinAt)
    ) u_relief_m_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(relief_j),
        .q_o(relief_m)
    );
    ring_line #(
        .Width(1),
        .Depth(ScatteredAt - JoinAt)
    ) u_relief_s_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(relief_j),
        .q_o(relief_s)
    );
  end else begin : gen_no_field
    assign field = '0;
    assign relief_j = 1'b0;
    assign relief_m = 1'b0;
    assign relief_s = 1'b0;
    logic unused;
    assign unused = ^{field, in_relief_i, in_vg_i, in_vb_i, in_px_i, in_py_i, in_pz_i, in_u_i, in_v_i};
  end

  // ---------------------------------------------------------------- the direction to the light

  logic [3*DirectionW-1:0] direction, in_view, in_field, far;
  assign far = {far_z_i, far_y_i, far_x_i};
  logic [FallW-1:0] fall;  // at FallAt
  if (HasPoint) begin : gen_point
    localparam int ScaleW = bitspan_light_pkg::LightScaleW;
    localparam int ScaleSigned = bitspan_light_pkg::LightScaleSigned;
    localparam int AcrossW = CoordW + 2 + ScaleW;
    localparam int PartW = PositionW + 2;
    logic [CoordW-1:0] at[2], size[2];
    logic [PositionW-1:0] here[3];
    assign at[0] = in_x_i;
    assign at[1] = in_y_i;
    assign size[0] = width_i;
    assign size[1] = height_i;
    logic [SW-1:0] s;
    ring_line #(
        .Width(SW),
        .Depth(1 + ProductClocks)
    ) u_s_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(in_s_i),
        .q_o(s)
    );
    for (genvar axis = 0; axis < 2; axis++) begin : gen_across
      // In halves of a pixel, from the picture's middle.
      logic signed [CoordW+1:0] from_middle_q;
      logic [AcrossW-1:0] across;
      logic [PositionW-1:0] place;
      always_ff @(posedge clk_i) begin
        if (en) from_middle_q <= $signed({1'b0, at[axis], 1'b1}) - $signed({2'b00, size[axis]});
      end
      mul_pipe #(
          .AW(CoordW + 2),
          .BW(ScaleW),
          .BSigned(ScaleSigned),
          .Clocks(ProductClocks)
      ) u_across (
          .clk_i,
          .en_i(en),
          .a_i(from_middle_q),
          .b_i(scale_i),
          .p_o(across)
      );
      multiply_round #(
          .AW(AcrossW),
          .AFrac(1 + bitspan_light_pkg::LightScaleFrac),
          .BW(SW),
          .BFrac(bitspan_light_pkg::DistanceSFrac),
          .BSigned(bitspan_light_pkg::DistanceSSigned),
          .EW(bitspan_light_pkg::ScaleExponentW),
          .EMin(bitspan_light_pkg::ScaleExponentMin),
          .EMax(bitspan_light_pkg::ScaleExponentMax),
          .OutW(PositionW),
          .OutFrac(PositionFrac),
          .OutSigned(bitspan_light_pkg::LightPositionSigned),
          .OutRnd(bitspan_light_pkg::LightPositionRnd),
          .OutOvf(bitspan_light_pkg::LightPositionOvf),
          .ProductClocks(ProductClocks)
      ) u_place (
          .clk_i,
          .en_i(en),
          .a_i(across),
          .b_i(s),
          .c_i(1'sd0),
          .e_i(scale_e_i),
          .q_o(place)
      );
      assign here[axis] = place;
    end
    logic [PositionW-1:0] depth, depth_q, depth_line;
    quantize #(
        .InW(SW + 1),
        .InFrac(bitspan_light_pkg::DistanceSFrac),
        .OutW(PositionW),
        .OutFrac(PositionFrac),
        .OutSigned(bitspan_light_pkg::LightPositionSigned),
        .Rounding(bitspan_light_pkg::LightPositionRnd),
        .Overflow(bitspan_light_pkg::LightPositionOvf)
    ) u_depth (
        .x_i({(bitspan_light_pkg::DistanceSSigned != 0) & in_s_i[SW-1], in_s_i}),
        .sticky_i(1'b0),
        .q_o(depth)
    );
    always_ff @(posedge clk_i) begin
      if (en) depth_q <= depth;
    end
    ring_line #(
        .Width(PositionW),
        .Depth(PlaceAt - 1)
    ) u_depth_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(depth_q),
        .q_o(depth_line)
    );
    assign here[2] = depth_line;
    // A unit vector is the same whatever power of two its vector is multiplied by, so that the grids may differ.
    localparam int TowardW = (SharesUnit && FieldW > PartW) ? FieldW : PartW;
    logic [3*TowardW-1:0] toward;
    logic [3*FieldW-1:0] field_p;
    logic relief_p;
    if (SharesUnit) begin : gen_shares
      ring_line #(
          .Width(3 * FieldW),
          .Depth(PlaceAt - 1)
      ) u_field_line (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .d_i(field),
          .q_o(field_p)
      );
      ring_line #(
          .Width(1),
          .Depth(PlaceAt)
      ) u_relief_p_line (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .d_i(in_relief_i),
          .q_o(relief_p)
      );
    end else begin : gen_own
      assign field_p = '0;
      assign relief_p = 1'b0;
    end
    logic [PositionW-1:0] light_at[3];
    assign light_at[0] = place_x_i;
    assign light_at[1] = place_y_i;
    assign light_at[2] = place_z_i;
    for (genvar axis = 0; axis < 3; axis++) begin : gen_part
      logic signed [PartW-1:0] to, from;
      logic signed [FieldW-1:0] through_field;
      assign through_field = field_p[axis*FieldW+:FieldW];
      assign to =
          PartW'($signed({(bitspan_light_pkg::LightPositionSigned != 0) & light_at[axis][PositionW-1], light_at[axis]}));
      assign from =
          PartW'($signed({(bitspan_light_pkg::LightPositionSigned != 0) & here[axis][PositionW-1], here[axis]}));
      always_ff @(posedge clk_i) begin
        if (en) toward[axis*TowardW+:TowardW] <= relief_p ? TowardW'(through_field) : TowardW'(to - from);
      end
    end
    logic [3*DirectionW-1:0] made;
    unit_vector #(
        .XW(TowardW),
        .XFrac(PositionFrac),
        .OutW(DirectionW),
        .OutFrac(bitspan_light_pkg::LightDirectionFrac),
        .OutSigned(bitspan_light_pkg::LightDirectionSigned),
        .OutRnd(bitspan_light_pkg::LightDirectionRnd),
        .OutOvf(bitspan_light_pkg::LightDirectionOvf),
        .RootClocks(RootClocks),
        .ProductClocks(ProductClocks),
        .Clocks(VectorClocks)
    ) u_direction (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .x_i(toward),
        .unit_o(made)
    );
    logic [3*DirectionW-1:0] of_point;
    ring_line #(
        .Width(3 * DirectionW),
        .Depth(JoinAt - DirectionAt)
    ) u_direction_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(made),
        .q_o(of_point)
    );
    assign in_view = point_i ? of_point : far;
    if (SharesUnit) begin : gen_field_shares
      assign in_field = of_point;
    end

    if (HasFall) begin : gen_fall
      // D, and its unit vector; both leave for the three products at the same time.
      logic [3*PartW-1:0] away, away_line;
      logic [3*DirectionW-1:0] away_unit;
      if (FallsToViewer) begin : gen_to_viewer
        for (genvar axis = 0; axis < 3; axis++) begin : gen_part
          assign away[axis*PartW+:PartW] =
              PartW'($signed({(bitspan_light_pkg::LightPositionSigned != 0) & here[axis][PositionW-1], here[axis]}));
        end
        unit_vector #(
            .XW(PartW),
            .XFrac(PositionFrac),
            .OutW(DirectionW),
            .OutFrac(bitspan_light_pkg::LightDirectionFrac),
            .OutSigned(bitspan_light_pkg::LightDirectionSigned),
            .OutRnd(bitspan_light_pkg::LightDirectionRnd),
            .OutOvf(bitspan_light_pkg::LightDirectionOvf),
            .RootClocks(RootClocks),
            .ProductClocks(ProductClocks),
            .Clocks(VectorClocks)
        ) u_away (
            .clk_i,
            .rst_ni,
            .en_i(en),
            .x_i(away),
            .unit_o(away_unit)
        );
      end else begin : gen_to_light
        assign away = toward;
        assign away_unit = made;
      end
      ring_line #(
          .Width(3 * PartW),
          .Depth(VectorClocks)
      ) u_away_line (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .d_i(away),
          .q_o(away_line)
      );
      light_fall #(
          .PartW(PartW),
          .Clocks(FallAt - AwayAt - VectorClocks)
      ) u_fall (
          .clk_i,
          .rst_ni,
          .en_i(en),
          .away_i(away_line),
          .unit_i(away_unit),
          .reach_i,
          .reach_e_i,
          .offset_i,
          .fall_o(fall)
      );
    end
  end else begin : gen_far
    assign in_view = far;
    logic unused;
    assign unused = ^{point_i, place_x_i, place_y_i, place_z_i, scale_i, scale_e_i, width_i, height_i, in_x_i, in_y_i, in_s_i};
  end
  if (!HasFall) begin : gen_no_fall
    assign fall = '0;
    logic unused;
    assign unused = ^{fall, falls_i, reach_i, reach_e_i, offset_i};
  end

  if (HasRelief && !SharesUnit) begin : gen_field_unit
    logic [3*DirectionW-1:0] made;
    unit_vector #(
        .XW(FieldW),
        .XFrac(FieldFrac),
        .OutW(DirectionW),
        .OutFrac(bitspan_light_pkg::LightDirectionFrac),
        .OutSigned(bitspan_light_pkg::LightDirectionSigned),
        .OutRnd(bitspan_light_pkg::LightDirectionRnd),
        .OutOvf(bitspan_light_pkg::LightDirectionOvf),
        .RootClocks(RootClocks),
        .ProductClocks(ProductClocks),
        .Clocks(VectorClocks)
    ) u_field (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .x_i(field),
        .unit_o(made)
    );
    ring_line #(
        .Width(3 * DirectionW),
        .Depth(JoinAt - 1 - VectorClocks)
    ) u_field_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(made),
        .q_o(in_field)
    );
  end else if (!HasRelief) begin : gen_no_field_unit
    assign in_field = in_view;
  end
  assign direction = relief_j ? in_field : in_view;

  // ---------------------------------------------------------------- the normal

  // 2 V - 255, on the grid of V, or on whole codes where that one is coarser.
  localparam bit NormalSigned = bitspan_light_pkg::NormalValueSigned != 0;
  localparam int MapUp = (MixFrac < 0) ? -MixFrac : 0;
  localparam int MapW = ((MixW + MapUp + 1 > 8 + MixFrac + MapUp) ? MixW + MapUp + 1 : 8 + MixFrac + MapUp) + 2;
  localparam int NormalXW = (HasRelief && MapW > ValueInW + 1) ? MapW : ValueInW + 1;
  logic [3*NormalXW-1:0] normal_in;
  logic [ValueInW-1:0] given[3];
  assign given[0] = in_nx_i;
  assign given[1] = in_ny_i;
  assign given[2] = in_nz_i;
  for (genvar axis = 0; axis < 3; axis++) begin : gen_normal
    logic signed [NormalXW-1:0] of_channel;
    assign of_channel = NormalXW'($signed({NormalSigned & given[axis][ValueInW-1], given[axis]}));
    if (HasRelief) begin : gen_map
      logic [MixW-1:0] texel;
      logic signed [NormalXW-1:0] of_map;
      assign texel = (axis == 0) ? in_vr_i : (axis == 1) ? in_vg_i : in_vb_i;
      assign of_map = NormalXW'($signed({(bitspan_light_pkg::TextureMixSigned != 0) & texel[MixW-1], texel})) <<< (MapUp + 1);
      always_ff @(posedge clk_i) begin
        if (en) normal_in[axis*NormalXW+:NormalXW] <= in_relief_i ? of_map - (NormalXW'(255) << (MixFrac + MapUp)) : of_channel;
      end
    end else begin : gen_channel
      assign normal_in[axis*NormalXW+:NormalXW] = of_channel;
    end
  end
  logic [3*NormalW-1:0] normal, normal_made;
  unit_vector #(
      .XW(NormalXW),
      .XFrac(bitspan_light_pkg::NormalValueFrac),
      .OutW(NormalW),
      .OutFrac(bitspan_light_pkg::LightNormalFrac),
      .OutSigned(bitspan_light_pkg::LightNormalSigned),
      .OutRnd(bitspan_light_pkg::LightNormalRnd),
      .OutOvf(bitspan_light_pkg::LightNormalOvf),
      .RootClocks(bitspan_light_pkg::LightRootClocks),
      .ProductClocks(ProductClocks),
      .Clocks(VectorClocks)
  ) u_normal (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .x_i(normal_in),
      .unit_o(normal_made)
  );
  ring_line #(
      .Width(3 * NormalW),
      .Depth(JoinAt - NormalAt)
  ) u_normal_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(normal_made),
      .q_o(normal)
  );

  // ---------------------------------------------------------------- both cosines

  localparam int DotW = NormalW + DirectionW;
  logic [DotW-1:0] part[3];
  logic signed [DotW+1:0] dot_q;
  for (genvar i = 0; i < 3; i++) begin : gen_dot
    mul_pipe #(
        .AW(NormalW),
        .BW(DirectionW),
        .ASigned(bitspan_light_pkg::LightNormalSigned),
        .BSigned(bitspan_light_pkg::LightDirectionSigned),
        .Clocks(ProductClocks)
    ) u_share (
        .clk_i,
        .en_i(en),
        .a_i(normal[i*NormalW+:NormalW]),
        .b_i(direction[i*DirectionW+:DirectionW]),
        .p_o(part[i])
    );
  end
  always_ff @(posedge clk_i) begin
    if (en) begin
      dot_q <= (DotW + 2)'($signed(part[0])) + (DotW + 2)'($signed(part[1])) + (DotW + 2)'($signed(part[2]));
    end
  end
  logic [CosineW-1:0] cosine, cosine_q;
  quantize #(
      .InW(DotW + 2),
      .InFrac(bitspan_light_pkg::LightNormalFrac + bitspan_light_pkg::LightDirectionFrac),
      .OutW(CosineW),
      .OutFrac(CosineFrac),
      .OutSigned(bitspan_light_pkg::LightCosineSigned),
      .Rounding(bitspan_light_pkg::LightCosineRnd),
      .Overflow(bitspan_light_pkg::LightCosineOvf)
  ) u_cosine (
      .x_i(dot_q),
      .sticky_i(1'b0),
      .q_o(cosine)
  );
  always_ff @(posedge clk_i) begin
    if (en) cosine_q <= cosine;
  end
  // Both vectors at the cosine.
  logic [3*NormalW-1:0] normal_c;
  logic [3*DirectionW-1:0] direction_c;
  ring_line #(
      .Width(3 * (NormalW + DirectionW)),
      .Depth(CosineAt - JoinAt)
  ) u_vectors_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i({normal, direction}),
      .q_o({normal_c, direction_c})
  );
  // - N'_z waits for the cosine, whose product is twice as much on a grid of one place less.
  logic signed [NormalW:0] wide_z, minus_z_q;
  logic [NormalW:0] minus_z;
  logic [CosineW-1:0] mirrored, mirrored_made;
  logic [DirectionW-1:0] direction_z;
  assign wide_z = (NormalW + 1)'($signed(normal[2*NormalW+:NormalW]));
  always_ff @(posedge clk_i) begin
    if (en) minus_z_q <= -wide_z;
  end
  ring_line #(
      .Width(NormalW + 1),
      .Depth(CosineAt - JoinAt - 1)
  ) u_minus_z_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(minus_z_q),
      .q_o(minus_z)
  );
  assign direction_z = direction_c[2*DirectionW+:DirectionW];
  multiply_round #(
      .AW(CosineW),
      .AFrac(CosineFrac - 1),
      .BW(NormalW + 1),
      .BFrac(bitspan_light_pkg::LightNormalFrac),
      .BSigned(bitspan_light_pkg::LightNormalSigned),
      .CW(DirectionW),
      .CFrac(bitspan_light_pkg::LightDirectionFrac),
      .OutW(CosineW),
      .OutFrac(CosineFrac),
      .OutSigned(bitspan_light_pkg::LightCosineSigned),
      .OutRnd(bitspan_light_pkg::LightCosineRnd),
      .OutOvf(bitspan_light_pkg::LightCosineOvf),
      .ProductClocks(ProductClocks)
  ) u_mirrored (
      .clk_i,
      .en_i(en),
      .a_i(cosine_q),
      .b_i(minus_z),
      .c_i(direction_z),
      .e_i(1'sd0),
      .q_o(mirrored_made)
  );
  // Where a map's field sees the viewer is not known.
  assign mirrored = relief_m ? '0 : mirrored_made;
  logic lit_q, lit_m;
  always_ff @(posedge clk_i) begin
    if (en) lit_q <= !cosine_q[CosineW-1] && cosine_q != '0;
  end
  ring_line #(
      .Width(1),
      .Depth(MirroredAt - CosineAt - 1)
  ) u_lit_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(lit_q),
      .q_o(lit_m)
  );

  // ---------------------------------------------------------------- the highlight

  // The place of a cosine in the table: an interval, and how far along it is. A cosine above 1 is as 1.
  localparam int Below = (CosineFrac > IndexBits) ? CosineFrac - IndexBits : 0;
  localparam int Above = (CosineFrac > IndexBits) ? 0 : IndexBits - CosineFrac;
  localparam int PlacedW = CosineW + Above + 1;
  logic [PlacedW-1:0] held, placed;
  logic [IndexBits-1:0] interval, interval_q;
  logic [IndexBits:0] next_q;
  logic [Below:0] along, along_q, along_m, along_r, along_e;
  logic shines, shines_q, shines_s, is_one;
  assign shines = lit_m && !mirrored[CosineW-1] && mirrored != '0;
  assign is_one = (mirrored >> CosineFrac) != '0;
  assign held = is_one ? PlacedW'(1) << CosineFrac : PlacedW'(mirrored);
  assign placed = held << Above;
  assign interval = is_one ? '1 : IndexBits'(placed >> Below);
  assign along = is_one ? (Below + 1)'(1) << Below : (Below + 1)'(placed) & ((Below + 1)'(1) << Below) - (Below + 1)'(1);
  localparam int SpecularSigned = bitspan_light_pkg::LightSpecularSigned;
  function automatic logic signed [SpecularW:0] wide(input logic [SpecularW-1:0] entry);
    wide = $signed({(SpecularSigned != 0) & entry[SpecularW-1], entry});
  endfunction
  logic signed [SpecularW+1:0] rise_e;
  logic [SpecularW-1:0] low_entries[(1<<IndexBits)+1], high_entries[(1<<IndexBits)+1];
  // A memory's output is late in its clock, so that a register of its own follows.
  logic [SpecularW-1:0] low_m, high_m, low_r, high_r, low_e;
  always_ff @(posedge clk_i) begin
    if (load_i) begin
      low_entries[load_place_i]  <= load_data_i;
      high_entries[load_place_i] <= load_data_i;
    end
    if (en) begin
      interval_q <= interval;
      next_q <= {1'b0, interval} + (IndexBits + 1)'(1);
      along_q <= along;
      shines_q <= shines;
      low_m <= low_entries[{1'b0, interval_q}];
      high_m <= high_entries[next_q];
      along_m <= along_q;
      low_r <= low_m;
      high_r <= high_m;
      along_r <= along_m;
      low_e <= low_r;
      rise_e <= (SpecularW + 2)'(wide(high_r)) - (SpecularW + 2)'(wide(low_r));
      along_e <= along_r;
    end
  end
  logic [SpecularW-1:0] power, specular;
  multiply_round #(
      .AW(SpecularW + 2),
      .AFrac(SpecularFrac),
      .BW(Below + 1),
      .BFrac(Below),
      .BSigned(0),
      .CW(SpecularW + 1),
      .CFrac(SpecularFrac),
      .OutW(SpecularW),
      .OutFrac(SpecularFrac),
      .OutSigned(SpecularSigned),
      .OutRnd(bitspan_light_pkg::LightSpecularRnd),
      .OutOvf(bitspan_light_pkg::LightSpecularOvf),
      .ProductClocks(ProductClocks)
  ) u_specular (
      .clk_i,
      .en_i(en),
      .a_i(rise_e),
      .b_i(along_e),
      .c_i(wide(low_e)),
      .e_i(1'sd0),
      .q_o(power)
  );
  ring_line #(
      .Width(1),
      .Depth(SpecularAt - MirroredAt - 2)
  ) u_shines_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(shines_q),
      .q_o(shines_s)
  );
  always_ff @(posedge clk_i) begin
    if (en) specular <= shines_s ? power : '0;
  end

  // ---------------------------------------------------------------- V = kd c' + ks spec + ka

  localparam int ValueSigned = bitspan_light_pkg::LightValueSigned;
  localparam int DiffuseW = ValueW + CosineW;
  logic [CosineW-1:0] cosine_1, cosine_lit, scattered;
  logic [DiffuseW-1:0] diffuse;
  // The ambient share may have more places than the product.
  localparam int BaseW = ValueW + ((CosineW > CosineFrac + 1) ? CosineW : CosineFrac + 1) + 2;
  logic signed [BaseW-1:0] base_q, base;
  logic [BaseW-1:0] base_line;
  logic [ValueW-1:0] value;
  always_ff @(posedge clk_i) begin
    if (en) begin
      cosine_1   <= cosine_q;
      cosine_lit <= lit_q ? cosine_1 : '0;
    end
  end
  if (HasLunar) begin : gen_lunar
    localparam int LunarW = bitspan_light_pkg::LightLunarW;
    localparam int LunarFrac = bitspan_light_pkg::LightLunarFrac;
    localparam int LunarSigned = bitspan_light_pkg::LightLunarSigned;
    // -N'_z has left its register a clock behind N'; T and c meet in front of the division.
    logic [NormalW:0] to_viewer;
    logic [LunarW-1:0] divisor;
    logic [CosineW-1:0] cosine_2, divided, whole;
    assign to_viewer = minus_z_q[NormalW] ? '0 : minus_z_q;
    multiply_round #(
        .AW(LunarW),
        .AFrac(LunarFrac),
        .ASigned(LunarSigned),
        .BW(NormalW + 1),
        .BFrac(bitspan_light_pkg::LightNormalFrac),
        .CW(2),
        .OutW(LunarW),
        .OutFrac(LunarFrac),
        .OutSigned(LunarSigned),
        .OutRnd(bitspan_light_pkg::LightLunarRnd),
        .OutOvf(bitspan_light_pkg::LightLunarOvf),
        .ProductClocks(ProductClocks)
    ) u_divisor (
        .clk_i,
        .en_i(en),
        .a_i(lunar_k_i),
        .b_i(to_viewer),
        .c_i(2'sd1),
        .e_i(1'sd0),
        .q_o(divisor)
    );
    always_ff @(posedge clk_i) begin
      if (en) cosine_2 <= cosine_lit;
    end
    light_divide #(
        .TW(LunarW),
        .TFrac(LunarFrac),
        .TSigned(LunarSigned),
        .AW(CosineW),
        .AFrac(CosineFrac),
        .AClocks(ProductClocks),
        .OutW(CosineW),
        .OutFrac(CosineFrac),
        .OutSigned(bitspan_light_pkg::LightCosineSigned),
        .OutRnd(bitspan_light_pkg::LightCosineRnd),
        .OutOvf(bitspan_light_pkg::LightCosineOvf),
        .RootClocks(RootClocks),
        .ProductClocks(ProductClocks),
        .Clocks(LunarClocks)
    ) u_divided (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .t_i(divisor),
        .a_i(cosine_2),
        .q_o(divided)
    );
    ring_line #(
        .Width(CosineW),
        .Depth(LunarClocks)
    ) u_whole_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(cosine_2),
        .q_o(whole)
    );
    assign scattered = (lunar_i && !relief_s) ? divided : whole;
  end else begin : gen_lambert
    assign scattered = cosine_lit;
    logic unused;
    assign unused = ^{lunar_i, lunar_k_i, relief_s};
  end
  mul_pipe #(
      .AW(ValueW),
      .BW(CosineW),
      .ASigned(ValueSigned),
      .BSigned(1),
      .Clocks(ProductClocks)
  ) u_diffuse (
      .clk_i,
      .en_i(en),
      .a_i(diffuse_i),
      .b_i(scattered),
      .p_o(diffuse)
  );
  // Ambient light comes later where what the others leave is rounded first.
  logic signed [ValueW:0] ambient, ambient_now, ambient_later;
  logic later_b;  // at BaseAt - 1
  assign ambient = $signed({(ValueSigned != 0) & ambient_i[ValueW-1], ambient_i});
  assign ambient_now = later_b ? '0 : ambient;
  always_ff @(posedge clk_i) begin
    if (en) base_q <= BaseW'($signed(diffuse)) + (BaseW'(ambient_now) <<< CosineFrac);
  end
  logic [SpecularW-1:0] specular_sum;
  ring_line #(
      .Width(BaseW),
      .Depth(SumAt - BaseAt)
  ) u_base_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(base_q),
      .q_o(base_line)
  );
  ring_line #(
      .Width(SpecularW),
      .Depth(SumAt - SpecularAt)
  ) u_specular_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(specular),
      .q_o(specular_sum)
  );
  assign base = $signed(base_line);
  logic [ValueW-1:0] near, shaded;
  multiply_round #(
      .AW(ValueW),
      .AFrac(ValueFrac),
      .ASigned(ValueSigned),
      .BW(SpecularW),
      .BFrac(SpecularFrac),
      .BSigned(SpecularSigned),
      .CW(BaseW),
      .CFrac(ValueFrac + CosineFrac),
      .OutW(ValueW),
      .OutFrac(ValueFrac),
      .OutSigned(ValueSigned),
      .OutRnd(bitspan_light_pkg::LightValueRnd),
      .OutOvf(bitspan_light_pkg::LightValueOvf),
      .ProductClocks(ProductClocks)
  ) u_value (
      .clk_i,
      .en_i(en),
      .a_i(highlight_i),
      .b_i(specular_sum),
      .c_i(base),
      .e_i(1'sd0),
      .q_o(near)
  );

  // ---------------------------------------------------------------- what a shadow leaves

  logic shadow_n;  // at NearAt
  if (HasShadow) begin : gen_shadow
    localparam int ShareFrac = bitspan_light_pkg::TextureAlphaFrac;
    localparam int FactorW = ((ShareW > ShareFrac + 1) ? ShareW : ShareFrac + 1) + 1;
    logic [ShareW-1:0] share, share_n;
    logic shadow_b;
    logic [FactorW-1:0] factor;
    over_255 #(
        .InW(MixW),
        .InFrac(MixFrac),
        .OutW(ShareW),
        .OutFrac(ShareFrac),
        .OutSigned(bitspan_light_pkg::TextureAlphaSigned),
        .OutRnd(bitspan_light_pkg::TextureAlphaRnd),
        .OutOvf(bitspan_light_pkg::TextureAlphaOvf)
    ) u_share (
        .clk_i,
        .en_i(en),
        .v_i(in_vr_i),
        .q_o(share)
    );
    ring_line #(
        .Width(ShareW),
        .Depth(NearAt - 4)
    ) u_share_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(share),
        .q_o(share_n)
    );
    ring_line #(
        .Width(1),
        .Depth(BaseAt - 1)
    ) u_shadow_b_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(in_shadow_i),
        .q_o(shadow_b)
    );
    ring_line #(
        .Width(1),
        .Depth(NearAt - BaseAt + 1)
    ) u_shadow_n_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(shadow_b),
        .q_o(shadow_n)
    );
    assign later_b = shadow_b || (HasFall && falls_i);
    assign factor = shadow_n ? FactorW'($signed({(bitspan_light_pkg::TextureAlphaSigned != 0) & share_n[ShareW-1], share_n}))
                             : FactorW'(1) << ShareFrac;
    multiply_round #(
        .AW(ValueW),
        .AFrac(ValueFrac),
        .ASigned(ValueSigned),
        .BW(FactorW),
        .BFrac(ShareFrac),
        .OutW(ValueW),
        .OutFrac(ValueFrac),
        .OutSigned(ValueSigned),
        .OutRnd(bitspan_light_pkg::LightValueRnd),
        .OutOvf(bitspan_light_pkg::LightValueOvf),
        .ProductClocks(ProductClocks)
    ) u_shaded (
        .clk_i,
        .en_i(en),
        .a_i(near),
        .b_i(factor),
        .c_i(1'sd0),
        .e_i(1'sd0),
        .q_o(shaded)
    );
  end else begin : gen_no_shadow
    assign later_b = HasFall && falls_i;
    assign shadow_n = 1'b0;
    assign shaded = near;
    logic unused;
    assign unused = in_shadow_i;
  end
  if (!HasShadow && !HasRelief) begin : gen_no_texel
    logic unused;
    assign unused = ^in_vr_i;
  end

  // ---------------------------------------------------------------- the fall, and the ambient light

  if (HasFall) begin : gen_fallen
    localparam int FallFrac = bitspan_light_pkg::LightFallFrac;
    localparam int FactorW = ((FallW > FallFrac + 1) ? FallW : FallFrac + 1) + 1;
    logic [FallW-1:0] fall_f;
    logic [ValueW-1:0] shaded_f;
    logic shadow_f;
    logic [FactorW-1:0] factor;
    ring_line #(
        .Width(FallW),
        .Depth(FallenAt - FallAt)
    ) u_fall_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(fall),
        .q_o(fall_f)
    );
    ring_line #(
        .Width(ValueW),
        .Depth(FallenAt - ShadedAt)
    ) u_shaded_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(shaded),
        .q_o(shaded_f)
    );
    ring_line #(
        .Width(1),
        .Depth(FallenAt - NearAt)
    ) u_shadow_f_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(shadow_n),
        .q_o(shadow_f)
    );
    assign ambient_later = (falls_i || shadow_f) ? ambient : '0;
    assign factor = falls_i ? FactorW'($signed({(bitspan_light_pkg::LightFallSigned != 0) & fall_f[FallW-1], fall_f}))
                            : FactorW'(1) << FallFrac;
    multiply_round #(
        .AW(ValueW),
        .AFrac(ValueFrac),
        .ASigned(ValueSigned),
        .BW(FactorW),
        .BFrac(FallFrac),
        .CW(ValueW + 1),
        .CFrac(ValueFrac),
        .OutW(ValueW),
        .OutFrac(ValueFrac),
        .OutSigned(ValueSigned),
        .OutRnd(bitspan_light_pkg::LightValueRnd),
        .OutOvf(bitspan_light_pkg::LightValueOvf),
        .ProductClocks(ProductClocks)
    ) u_fallen (
        .clk_i,
        .en_i(en),
        .a_i(shaded_f),
        .b_i(factor),
        .c_i(ambient_later),
        .e_i(1'sd0),
        .q_o(value)
    );
  end else if (HasShadow) begin : gen_ambient
    logic shadow_s;
    logic signed [ValueW:0] wide_shaded;
    logic [ValueW-1:0] sum, sum_q;
    ring_line #(
        .Width(1),
        .Depth(RoundedClocks)
    ) u_shadow_s_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(shadow_n),
        .q_o(shadow_s)
    );
    assign ambient_later = shadow_s ? ambient : '0;
    assign wide_shaded = $signed({(ValueSigned != 0) & shaded[ValueW-1], shaded});
    quantize #(
        .InW(ValueW + 2),
        .InFrac(ValueFrac),
        .OutW(ValueW),
        .OutFrac(ValueFrac),
        .OutSigned(ValueSigned),
        .Rounding(bitspan_light_pkg::LightValueRnd),
        .Overflow(bitspan_light_pkg::LightValueOvf)
    ) u_ambient (
        .x_i((ValueW + 2)'(wide_shaded) + (ValueW + 2)'(ambient_later)),
        .sticky_i(1'b0),
        .q_o(sum)
    );
    always_ff @(posedge clk_i) begin
      if (en) sum_q <= sum;
    end
    assign value = sum_q;
  end else begin : gen_all
    assign value = shaded;
    assign ambient_later = '0;
    logic unused;
    assign unused = ^{ambient_later, shadow_n};
  end

  // ---------------------------------------------------------------- the colour

  logic [3*ColorW-1:0] own, colored;
  ring_line #(
      .Width(3 * ColorW),
      .Depth(ValueAt)
  ) u_color_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i({in_r_i, in_g_i, in_b_i}),
      .q_o(own)
  );
  for (genvar c = 0; c < 3; c++) begin : gen_color
    multiply_round #(
        .AW(ColorW),
        .AFrac(bitspan_light_pkg::TextureColorFrac),
        .ASigned(bitspan_light_pkg::TextureColorSigned),
        .BW(ValueW),
        .BFrac(ValueFrac),
        .BSigned(ValueSigned),
        .OutW(ColorW),
        .OutFrac(bitspan_light_pkg::TextureColorFrac),
        .OutSigned(bitspan_light_pkg::TextureColorSigned),
        .OutRnd(bitspan_light_pkg::TextureColorRnd),
        .OutOvf(bitspan_light_pkg::TextureColorOvf),
        .ProductClocks(ProductClocks)
    ) u_color (
        .clk_i,
        .en_i(en),
        .a_i(own[c*ColorW+:ColorW]),
        .b_i(value),
        .c_i(1'sd0),
        .e_i(1'sd0),
        .q_o(colored[c*ColorW+:ColorW])
    );
  end

  // What waits beside the colours.
  logic [3*(NormalW+DirectionW)+CosineW-1:0] vectors_out;
  logic [CosineW-1:0] mirrored_out;
  logic [SpecularW-1:0] specular_out;
  logic [ValueW-1:0] value_out;
  ring_line #(
      .Width(3 * (NormalW + DirectionW) + CosineW),
      .Depth(Clocks - CosineAt)
  ) u_vectors_out_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i({
        normal_c[0+:NormalW],
        normal_c[NormalW+:NormalW],
        normal_c[2*NormalW+:NormalW],
        direction_c[0+:DirectionW],
        direction_c[DirectionW+:DirectionW],
        direction_z,
        cosine_q
      }),
      .q_o(vectors_out)
  );
  ring_line #(
      .Width(CosineW),
      .Depth(Clocks - MirroredAt)
  ) u_mirrored_out_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(mirrored),
      .q_o(mirrored_out)
  );
  ring_line #(
      .Width(SpecularW),
      .Depth(Clocks - SpecularAt)
  ) u_specular_out_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(specular),
      .q_o(specular_out)
  );
  ring_line #(
      .Width(ValueW),
      .Depth(Clocks - ValueAt)
  ) u_value_out_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(value),
      .q_o(value_out)
  );
  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(3 * (NormalW + DirectionW + ColorW) + 2 * CosineW + SpecularW + ValueW)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i({vectors_out, mirrored_out, specular_out, value_out, colored}),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({
        out_nx_o,
        out_ny_o,
        out_nz_o,
        out_lx_o,
        out_ly_o,
        out_lz_o,
        out_cosine_o,
        out_mirrored_o,
        out_specular_o,
        out_value_o,
        out_r_o,
        out_g_o,
        out_b_o
      }),
      .out_rest_o
  );

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_light_pkg::LightClocks)
    else $fatal(1, "light: has %0d clocks, told %0d", Clocks, bitspan_light_pkg::LightClocks);
    assert (bitspan_light_pkg::LightCosineSigned != 0 && bitspan_light_pkg::LightDirectionSigned != 0)
    else $fatal(1, "light: cosines and directions are signed");
  end
`endif
endmodule
