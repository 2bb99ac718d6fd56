// SPDX-License-Identifier: Apache-2.0
// fog of docs/numeric-spec.md: a fragment that lives in, its colour mixed with the fog's out; one per clock.
//
//   h        --> step of depth ----------------+
//   x, y     --> squares --> r^2 --> zone -----+--> table --+
//   h        --> h + B --> R_pixel --> 1 - scale m 2^-e ----+--> factor --> blend --> skid --> out
//
// The stage shifts as one on the ready of the skid at its end, which is a register. The linear part is there where the
// package says so (FogHasLinear). With FogIsGiven the factor that comes with the fragment stands in place of it.
//
// The zone is the number of thresholds k (W^2 + H^2) / 2^zone_bits, rounded up, that r^2 reaches: a search through the
// tree of thresholds, one level per clock.
module fog #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    // Writes an entry of the table, or threshold 1 .. 2^zone_bits - 1. Fragments in flight must not need them.
    input  logic load_i,
    input  logic load_threshold_i,
    input  logic [bitspan_pixel_pkg::FogIndexW-1:0] load_place_i,
    input  logic [bitspan_pixel_pkg::FogLoadW-1:0] load_data_i,
    // The fragment; what else it brings comes out beside it.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] in_x_i,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] in_y_i,
    input  logic [bitspan_pixel_pkg::SpanHW-1:0] in_h_i,
    input  logic [bitspan_pixel_pkg::TextureColorW-1:0] in_r_i,
    input  logic [bitspan_pixel_pkg::TextureColorW-1:0] in_g_i,
    input  logic [bitspan_pixel_pkg::TextureColorW-1:0] in_b_i,
    input  logic [bitspan_pixel_pkg::FogFactorW-1:0] in_factor_i,  // read with FogIsGiven
    input  logic [RestW-1:0] in_rest_i,
    // The draw state, taken with the fragment: the mode (FogModeNone and so on), the fog's colour (red in the lowest
    // byte), the picture's size, and the constants B and fog_scale.
    input  logic [1:0] in_mode_i,
    input  logic [23:0] in_color_i,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] in_width_i,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] in_height_i,
    input  logic [bitspan_pixel_pkg::SetupBW-1:0] in_constant_b_i,
    input  logic [bitspan_pixel_pkg::FogScaleW-1:0] in_scale_i,
    // The record of docs/numeric-spec.md; index is -1 without the table.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_pixel_pkg::FogIndexW:0] out_index_o,
    output logic [bitspan_pixel_pkg::PixelRecipOutW-1:0] out_recip_m_o,
    output logic [bitspan_pixel_pkg::ExponentW-1:0] out_recip_e_o,
    output logic [bitspan_pixel_pkg::FogFactorW-1:0] out_factor_o,
    output logic [bitspan_pixel_pkg::FogColorW-1:0] out_r_o,
    output logic [bitspan_pixel_pkg::FogColorW-1:0] out_g_o,
    output logic [bitspan_pixel_pkg::FogColorW-1:0] out_b_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int CoordW = bitspan_pixel_pkg::CoordW;
  localparam int HW = bitspan_pixel_pkg::SpanHW;
  localparam int HSigned = bitspan_pixel_pkg::SpanHSigned;
  localparam int ColorInW = bitspan_pixel_pkg::TextureColorW;
  localparam int IndexW = bitspan_pixel_pkg::FogIndexW;
  localparam int StepW = bitspan_pixel_pkg::FogDepthBits;
  localparam int ZoneBits = bitspan_pixel_pkg::FogZoneBits;
  localparam int FactorW = bitspan_pixel_pkg::FogFactorW;
  localparam int FactorFrac = bitspan_pixel_pkg::FogFactorFrac;
  localparam int ColorW = bitspan_pixel_pkg::FogColorW;
  localparam int MW = bitspan_pixel_pkg::PixelRecipOutW;
  localparam int EW = bitspan_pixel_pkg::ExponentW;

  // Clocks after acceptance at which a value is in its register.
  localparam int SquareClocks = $clog2(CoordW);
  localparam int RadiusAt = 2 + SquareClocks + 1;
  localparam int ZoneAt = RadiusAt + ZoneBits;
  localparam int RecipAt = 1 + bitspan_pixel_pkg::PixelUnitClocks;
  localparam int ProductClocks = bitspan_pixel_pkg::FogScaleProductClocks;
  localparam int LinearAt = RecipAt + ProductClocks + 4;
  localparam int EntryAt = (bitspan_pixel_pkg::FogHasLinear != 0 && LinearAt > ZoneAt + 1) ? LinearAt : ZoneAt + 1;
  localparam int FactorAt = EntryAt + 1;
  localparam int BlendProductClocks = bitspan_pixel_pkg::FogBlendProductClocks;
  localparam int Clocks = FactorAt + 3 + BlendProductClocks;

  logic en;
  assign en = in_ready_o;

  // ---------------------------------------------------------------- table

  // The step of depth: h's top bits, where h is neither negative nor beyond the last step.
  localparam int Up = (bitspan_pixel_pkg::FogStepShift < 0) ? -bitspan_pixel_pkg::FogStepShift : 0;
  localparam int Down = (bitspan_pixel_pkg::FogStepShift > 0) ? bitspan_pixel_pkg::FogStepShift : 0;
  localparam int PlacedW = HW + Up + StepW;
  logic [PlacedW-1:0] placed;
  logic [StepW-1:0] step_1, step;
  logic negative;
  assign negative = (HSigned != 0) && in_h_i[HW-1];
  assign placed = (PlacedW'(in_h_i) << Up) >> Down;
  always_ff @(posedge clk_i) begin
    if (en) step_1 <= negative ? '0 : (|placed[PlacedW-1:StepW]) ? '1 : placed[StepW-1:0];
  end
  ring_line #(
      .Width(StepW),
      .Depth(ZoneAt - 1)
  ) u_step_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(step_1),
      .q_o(step)
  );

  // r^2 in half pixels, from the picture's middle: 2 x + 1 - W and its size, the squares, their sum.
  localparam int RadiusW = 2 * CoordW + 1;
  logic [CoordW-1:0] place[2], size[2];
  logic [2*CoordW-1:0] squared[2];
  assign place[0] = in_x_i;
  assign place[1] = in_y_i;
  assign size[0] = in_width_i;
  assign size[1] = in_height_i;
  for (genvar axis = 0; axis < 2; axis++) begin : gen_axis
    logic signed [CoordW+1:0] distance_1;
    logic [CoordW-1:0] distance_2;
    always_ff @(posedge clk_i) begin
      if (en) begin
        distance_1 <= $signed({1'b0, place[axis], 1'b1}) - $signed({2'b00, size[axis]});
        distance_2 <= distance_1[CoordW+1] ? -distance_1[CoordW-1:0] : distance_1[CoordW-1:0];
      end
    end
    square #(
        .Width(CoordW),
        .Clocks(SquareClocks)
    ) u_square (
        .clk_i,
        .en_i(en),
        .a_i(distance_2),
        .s_o(squared[axis])
    );
    logic unused;
    assign unused = distance_1[CoordW];
  end

  // The zone, highest bit first. Level s of the tree has the odd multiples of threshold 2^(zone_bits - 1 - s).
  logic [RadiusW-1:0] radius_q[ZoneBits+1];
  logic [IndexW-1:0] zone_q[ZoneBits+1];
  always_ff @(posedge clk_i) begin
    if (en) radius_q[0] <= RadiusW'(squared[0]) + RadiusW'(squared[1]);
  end
  assign zone_q[0] = '0;
  for (genvar s = 0; s < ZoneBits; s++) begin : gen_zone
    localparam int Below = ZoneBits - s;
    logic [RadiusW-1:0] threshold[1<<s];
    logic [IndexW-1:0] reached_q;
    logic written;
    assign written = load_i && load_threshold_i && load_place_i[Below-1:0] == (Below'(1) << (Below - 1));
    if (s == 0) begin : gen_root
      always_ff @(posedge clk_i) begin
        if (written) threshold[0] <= load_data_i[RadiusW-1:0];
        if (en) reached_q <= IndexW'(radius_q[s] >= threshold[0]);
      end
    end else begin : gen_level
      always_ff @(posedge clk_i) begin
        if (written) threshold[load_place_i[Below+:s]] <= load_data_i[RadiusW-1:0];
        if (en) reached_q <= {zone_q[s][IndexW-2:0], radius_q[s] >= threshold[zone_q[s][s-1:0]]};
      end
    end
    assign zone_q[s+1] = reached_q;
    always_ff @(posedge clk_i) begin
      if (en) radius_q[s+1] <= radius_q[s];
    end
  end

  logic [IndexW-1:0] index, index_entry;
  logic [FactorW-1:0] entries[1<<IndexW];
  logic [FactorW-1:0] entry_q;
  assign index = (IndexW'(step) << ZoneBits) | zone_q[ZoneBits];
  ring_line #(
      .Width(IndexW),
      .Depth(EntryAt - 1 - ZoneAt)
  ) u_index_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(index),
      .q_o(index_entry)
  );
  always_ff @(posedge clk_i) begin
    if (load_i && !load_threshold_i) entries[load_place_i] <= load_data_i[FactorW-1:0];
    if (en) entry_q <= entries[index_entry];
  end

  // ---------------------------------------------------------------- linear, or given

  logic [FactorW-1:0] linear;
  logic [MW+EW-1:0] recip_out;
  if (bitspan_pixel_pkg::FogHasLinear != 0) begin : gen_linear
    logic [MW-1:0] m;
    logic signed [EW-1:0] e;
    pixel_reciprocal u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .h_i(in_h_i),
        .b_i(in_constant_b_i),
        .m_o(m),
        .e_o(e)
    );

    // 1 - scale m 2^-e.
    localparam int ScaleW = bitspan_pixel_pkg::FogScaleW;
    logic signed [ScaleW:0] scale, minus_scale_1, minus_scale;
    assign scale = $signed({(bitspan_pixel_pkg::FogScaleSigned != 0) & in_scale_i[ScaleW-1], in_scale_i});
    always_ff @(posedge clk_i) begin
      if (en) minus_scale_1 <= -scale;
    end
    ring_line #(
        .Width(ScaleW + 1),
        .Depth(RecipAt - 1)
    ) u_scale_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(minus_scale_1),
        .q_o(minus_scale)
    );
    logic [FactorW-1:0] factor_q;
    multiply_round #(
        .AW(ScaleW + 1),
        .AFrac(bitspan_pixel_pkg::FogScaleFrac),
        .BW(MW),
        .BFrac(bitspan_pixel_pkg::PixelRecipOutFrac),
        .BSigned(bitspan_pixel_pkg::PixelRecipOutSigned),
        .CW(2),
        .EW(EW),
        .EMin(bitspan_pixel_pkg::PixelRecipEMin),
        .EMax(bitspan_pixel_pkg::PixelRecipEMax),
        .OutW(FactorW),
        .OutFrac(FactorFrac),
        .OutSigned(bitspan_pixel_pkg::FogFactorSigned),
        .OutRnd(bitspan_pixel_pkg::FogFactorRnd),
        .OutOvf(bitspan_pixel_pkg::FogFactorOvf),
        .ProductClocks(ProductClocks)
    ) u_factor (
        .clk_i,
        .en_i(en),
        .a_i(minus_scale),
        .b_i(m),
        .c_i(2'sd1),
        .e_i(e),
        .q_o(factor_q)
    );
    ring_line #(
        .Width(FactorW),
        .Depth(EntryAt - LinearAt)
    ) u_factor_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(factor_q),
        .q_o(linear)
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
    logic unused;
    assign unused = ^in_factor_i;
  end else if (bitspan_pixel_pkg::FogIsGiven != 0) begin : gen_given
    ring_line #(
        .Width(FactorW),
        .Depth(EntryAt)
    ) u_factor_line (
        .clk_i,
        .rst_ni,
        .en_i(en),
        .d_i(in_factor_i),
        .q_o(linear)
    );
    assign recip_out = '0;
    logic unused;
    assign unused = ^{in_constant_b_i, in_scale_i};
  end else begin : gen_no_linear
    assign linear = '0;
    assign recip_out = '0;
    logic unused;
    assign unused = ^{in_constant_b_i, in_scale_i, in_factor_i};
  end

  // ---------------------------------------------------------------- factor and blend

  localparam logic [1:0] ModeLinear = 2'(bitspan_pixel_pkg::FogModeLinear);
  localparam logic [1:0] ModeTable = 2'(bitspan_pixel_pkg::FogModeTable);
  logic [1:0] mode, mode_out;
  ring_line #(
      .Width(2),
      .Depth(EntryAt)
  ) u_mode_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(in_mode_i),
      .q_o(mode)
  );
  // Without fog the factor is 1, and the blend is Q of the fragment's own colour.
  logic [FactorW-1:0] factor_q;
  always_ff @(posedge clk_i) begin
    if (en) begin
      factor_q <= (mode == ModeTable) ? entry_q : (mode == ModeLinear) ? linear : FactorW'(1) << FactorFrac;
    end
  end

  logic [3*ColorInW-1:0] own;
  logic [23:0] code;
  ring_line #(
      .Width(3 * ColorInW + 24),
      .Depth(FactorAt)
  ) u_color_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i({in_b_i, in_g_i, in_r_i, in_color_i}),
      .q_o({own, code})
  );
  logic [3*ColorW-1:0] mixed;
  for (genvar c = 0; c < 3; c++) begin : gen_blend
    blend #(
        .AW(8),
        .BW(ColorInW),
        .BFrac(bitspan_pixel_pkg::TextureColorFrac),
        .BSigned(bitspan_pixel_pkg::TextureColorSigned),
        .EW(FactorW),
        .EFrac(FactorFrac),
        .ESigned(bitspan_pixel_pkg::FogFactorSigned),
        .OutW(ColorW),
        .OutFrac(bitspan_pixel_pkg::FogColorFrac),
        .OutSigned(bitspan_pixel_pkg::FogColorSigned),
        .OutRnd(bitspan_pixel_pkg::FogColorRnd),
        .OutOvf(bitspan_pixel_pkg::FogColorOvf),
        .ProductClocks(BlendProductClocks),
        .Clocks(Clocks - FactorAt)
    ) u_blend (
        .clk_i,
        .en_i(en),
        .a_i(code[8*c+:8]),
        .b_i(own[c*ColorInW+:ColorInW]),
        .e_i(factor_q),
        .q_o(mixed[(2-c)*ColorW+:ColorW])
    );
  end

  // What waits beside the blend.
  logic [IndexW-1:0] index_out;
  logic [FactorW-1:0] factor_out;
  ring_line #(
      .Width(IndexW),
      .Depth(Clocks - EntryAt + 1)
  ) u_index_out_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(index_entry),
      .q_o(index_out)
  );
  ring_line #(
      .Width(FactorW),
      .Depth(Clocks - FactorAt)
  ) u_factor_out_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(factor_q),
      .q_o(factor_out)
  );
  ring_line #(
      .Width(2),
      .Depth(Clocks - EntryAt)
  ) u_mode_out_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(mode),
      .q_o(mode_out)
  );
  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(IndexW + 1 + MW + EW + FactorW + 3 * ColorW)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i({(mode_out == ModeTable) ? {1'b0, index_out} : '1, (mode_out == ModeLinear) ? recip_out : '0,
               factor_out, mixed}),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({out_index_o, out_recip_m_o, out_recip_e_o, out_factor_o, out_r_o, out_g_o, out_b_o}),
      .out_rest_o
  );

  logic unused_load;
  assign unused_load = ^{load_data_i, radius_q[ZoneBits]};

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::FogClocks)
    else $fatal(1, "fog: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::FogClocks);
  end
  always @(posedge clk_i) begin
    if (in_valid_i && en) begin
      assert (in_mode_i != ModeLinear || bitspan_pixel_pkg::FogHasLinear != 0 || bitspan_pixel_pkg::FogIsGiven != 0)
      else $fatal(1, "fog: linear fog in a stage without it");
      assert (in_mode_i != ModeTable || (in_x_i < in_width_i && in_y_i < in_height_i))
      else $fatal(1, "fog: pixel %0d, %0d lies outside the picture", in_x_i, in_y_i);
    end
  end
`endif
endmodule
