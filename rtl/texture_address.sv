// SPDX-License-Identifier: Apache-2.0
// Where the texels of a fragment lie in one level of its texture; docs/numeric-spec.md, "texture" and "Levels".
// TextureAddressClocks enabled clocks.
//
//   u, v --> u W_l/W --> u - 1/2 --> whole, E --> wrapped --> rows by the pitch --> plus the base
//            (2 clocks)                                      (2 clocks)
//
// Texel (i, j) has the address base + j 2^pitch + i. Where textures have levels (TextureHasLevels), their sides are powers of
// two, and level l of 2^w columns and 2^h rows begins 2^(w+h) texels behind the base: its rows have 2^w texels, and row j is
// the row 2^h + j behind the base. No two levels have as many texels, so that none overlap. Without levels level_i is
// ignored, and there are no clocks for it.
module texture_address (
    input  logic clk_i,
    input  logic rst_ni,
    input  logic en_i,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] u_i,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] v_i,
    input  logic [bitspan_pixel_pkg::LodLevelW-1:0] level_i,
    // The draw state: a texture or none, bilinear or nearest, clamp or cyclic along u (bit 0) and v; of level 0 the last
    // column and row, and the pitch; the base.
    input  logic textured_i,
    input  logic bilinear_i,
    input  logic [1:0] clamp_i,
    input  logic [bitspan_pixel_pkg::TexelIndexW-1:0] last_i_i,
    input  logic [bitspan_pixel_pkg::TexelIndexW-1:0] last_j_i,
    input  logic [bitspan_pixel_pkg::TexelPitchW-1:0] pitch_i,
    input  logic [bitspan_pixel_pkg::TexelAddressW-1:0] base_i,
    // A texture; one whose four texels are weighed.
    output logic textured_o,
    output logic quad_o,
    // Addresses of both rows, and the columns behind them.
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] first_row_o,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] second_row_o,
    output logic [bitspan_pixel_pkg::TexelIndexW-1:0] first_i_o,
    output logic [bitspan_pixel_pkg::TexelIndexW-1:0] second_i_o,
    // The first row's number in its level.
    output logic [bitspan_pixel_pkg::TexelIndexW-1:0] first_j_o,
    // Of the two texels along u (bit 0) and v, the second one is nearest.
    output logic [1:0] upper_o,
    output logic [bitspan_pixel_pkg::TextureFracW-1:0] ex_o,
    output logic [bitspan_pixel_pkg::TextureFracW-1:0] ey_o
);
  localparam int UvW = bitspan_pixel_pkg::SpanUvW;
  localparam int UvFrac = bitspan_pixel_pkg::SpanUvFrac;
  localparam int UvSigned = bitspan_pixel_pkg::SpanUvSigned;
  localparam int FracW = bitspan_pixel_pkg::TextureFracW;
  localparam int IndexW = bitspan_pixel_pkg::TexelIndexW;
  localparam int PitchW = bitspan_pixel_pkg::TexelPitchW;
  localparam int AddressW = bitspan_pixel_pkg::TexelAddressW;
  localparam int LevelW = bitspan_pixel_pkg::LodLevelW;
  localparam int HasLevels = bitspan_pixel_pkg::TextureHasLevels;
  localparam int LevelClocks = (HasLevels != 0) ? 2 : 0;
  localparam int Clocks = LevelClocks + 6;

  // u W_l / W on a grid that has the half, as a signed number that can lose it.
  localparam int Deep = (HasLevels != 0) ? (1 << LevelW) - 1 : 0;
  localparam int UvGrid = (UvFrac > 1) ? UvFrac : 1;
  localparam int Grid = UvGrid + Deep;
  localparam int OwnW = UvW + UvGrid - UvFrac + ((UvSigned != 0) ? 1 : 2);
  localparam int LowW = OwnW + Deep;
  localparam int WholeW = LowW - Grid;
  // A texel's index beside the wholes of u, which may be the narrower.
  localparam int CompareW = (WholeW > IndexW + 1) ? WholeW : IndexW + 1;

  // ---------------------------------------------------------------- the level

  // Behind the clocks of the level, or at the input. Axis 0 is u, 1 is v.
  logic textured, bilinear;
  logic [1:0] clamp;
  logic signed [LowW-1:0] low[2];
  logic [IndexW-1:0] last[2];
  logic [PitchW-1:0] pitch;
  logic signed [OwnW-1:0] own[2];
  assign own[0] = OwnW'($signed({(UvSigned != 0) & u_i[UvW-1], u_i})) <<< (UvGrid - UvFrac);
  assign own[1] = OwnW'($signed({(UvSigned != 0) & v_i[UvW-1], v_i})) <<< (UvGrid - UvFrac);
  if (HasLevels != 0) begin : gen_level
    // By the high bits of how often the side is halved, then by the low ones; u goes to the left by what that leaves of Deep.
    logic [PitchW-1:0] pitch_a, pitch_b;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        pitch_a <= (pitch_i > PitchW'(level_i)) ? pitch_i - PitchW'(level_i) : '0;
        pitch_b <= pitch_a;
      end
    end
    for (genvar axis = 0; axis < 2; axis++) begin : gen_shift
      logic signed [LowW-1:0] low_a, low_b;
      logic [IndexW-1:0] own_last, last_a, last_b;
      assign own_last = (axis == 0) ? last_i_i : last_j_i;
      // Of the lowest bits as many are 1 as the side is halved: min(l, log2 of the side). Bit b of that number is the parity of
      // those bits whose place, counted from 1, is a multiple of 2^b.
      logic [Deep-1:0] halvings;
      logic [LevelW-1:0] halved;
      logic [1:0] halved_a;
      assign halvings = Deep'(own_last) & ~({Deep{1'b1}} << level_i);
      always_comb begin
        halved = '0;
        for (int b = 0; b < LevelW; b++) begin
          for (int k = 0; k < Deep; k++) begin
            if ((k + 1) % (1 << b) == 0) halved[b] = halved[b] ^ halvings[k];
          end
        end
      end
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          halved_a <= halved[1:0];
          low_a <= LowW'(own[axis]) <<< {~halved[LevelW-1:2], 2'b00};
          low_b <= low_a <<< ~halved_a;
          last_a <= own_last >> {halved[LevelW-1:2], 2'b00};
          last_b <= last_a >> halved_a;
        end
      end
      assign low[axis] = low_b;
      assign last[axis] = last_b;
    end
    delay_line #(
        .Width(4),
        .Depth(LevelClocks)
    ) u_draw_line (
        .clk_i,
        .en_i,
        .d_i({textured_i, bilinear_i, clamp_i}),
        .q_o({textured, bilinear, clamp})
    );
    assign pitch = pitch_b;
  end else begin : gen_no_level
    assign {textured, bilinear, clamp} = {textured_i, bilinear_i, clamp_i};
    assign low[0] = own[0];
    assign low[1] = own[1];
    assign last[0] = last_i_i;
    assign last[1] = last_j_i;
    assign pitch = pitch_i;
    logic unused;
    assign unused = ^level_i;
  end

  // ---------------------------------------------------------------- indices

  logic textured_1, quad_1;
  logic [1:0] clamp_1;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      textured_1 <= textured;
      quad_1 <= textured && bilinear;
      clamp_1 <= clamp;
    end
  end
  delay_line #(
      .Width(2),
      .Depth(5)
  ) u_filter_line (
      .clk_i,
      .en_i,
      .d_i({textured_1, quad_1}),
      .q_o({textured_o, quad_o})
  );

  // No unpacked array: Yosys 0.23 would take a word at an output port for a read of memory.
  logic [2*FracW-1:0] frac_6;
  assign {ey_o, ex_o} = frac_6;
  logic [2*IndexW-1:0] first_3, second_3, last_2;
  for (genvar axis = 0; axis < 2; axis++) begin : gen_axis
    // Clock 1: u - 1/2, or u for the nearest texel.
    logic signed [LowW-1:0] low_1;
    logic [IndexW-1:0] last_1;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        low_1 <= low[axis] - ((bilinear) ? LowW'(1) <<< (Grid - 1) : '0);
        last_1 <= last[axis];
      end
    end

    // Clock 2: the texels' indices before they are wrapped, where they lie, and E.
    logic signed [CompareW-1:0] whole;
    logic [FracW-1:0] frac;
    assign whole = CompareW'($signed(low_1[LowW-1:Grid]));
    quantize #(
        .InW(Grid + 1),
        .InFrac(Grid),
        .OutW(FracW),
        .OutFrac(FracW),
        .OutSigned(0),
        .Rounding(bitspan_pixel_pkg::TextureFracRnd),
        .Overflow(bitspan_pixel_pkg::TextureFracOvf)
    ) u_frac (
        .x_i($signed({1'b0, low_1[Grid-1:0]})),
        .sticky_i(1'b0),
        .q_o(frac)
    );
    logic [IndexW-1:0] first_2, second_2;
    logic zero_2, first_past_2, second_past_2, cyclic_2, upper_2;
    logic [FracW-1:0] frac_2;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        first_2 <= whole[IndexW-1:0];
        second_2 <= whole[IndexW-1:0] + IndexW'(1);
        zero_2 <= !textured_1 || (clamp_1[axis] && whole < 0);
        first_past_2 <= clamp_1[axis] && whole > $signed(CompareW'({1'b0, last_1}));
        second_past_2 <= clamp_1[axis] && whole >= $signed(CompareW'({1'b0, last_1}));
        cyclic_2 <= !clamp_1[axis];
        last_2[axis*IndexW+:IndexW] <= last_1;
        upper_2 <= quad_1 && low_1[Grid-1];
        frac_2 <= quad_1 ? frac : '0;
      end
    end

    // Clock 3: wrapped. The last index of a cyclic texture is a mask.
    logic [IndexW-1:0] axis_last_2, mask_2;
    assign axis_last_2 = last_2[axis*IndexW+:IndexW];
    assign mask_2 = axis_last_2 | {IndexW{!cyclic_2}};
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        first_3[axis*IndexW+:IndexW] <= zero_2 ? '0 : first_past_2 ? axis_last_2 : first_2 & mask_2;
        second_3[axis*IndexW+:IndexW] <= zero_2 ? '0 : second_past_2 ? axis_last_2 : second_2 & mask_2;
      end
    end

    delay_line #(
        .Width(FracW + 1),
        .Depth(4)
    ) u_frac_line (
        .clk_i,
        .en_i,
        .d_i({upper_2, frac_2}),
        .q_o({upper_o[axis], frac_6[axis*FracW+:FracW]})
    );
  end

  // ---------------------------------------------------------------- rows

  // The rows behind the base: those of a level lie behind as many.
  logic [IndexW:0] first_j_3, second_j_3;
  if (HasLevels != 0) begin : gen_behind
    logic [IndexW:0] rows_3;
    always_ff @(posedge clk_i) begin
      if (en_i) rows_3 <= {1'b0, last_2[IndexW+:IndexW]} + 1'b1;
    end
    assign first_j_3 = rows_3 | {1'b0, first_3[IndexW+:IndexW]};
    assign second_j_3 = rows_3 | {1'b0, second_3[IndexW+:IndexW]};
  end else begin : gen_at_base
    assign first_j_3 = {1'b0, first_3[IndexW+:IndexW]};
    assign second_j_3 = {1'b0, second_3[IndexW+:IndexW]};
  end

  // Clocks 4 and 5: rows by the pitch, first by its two low bits; clock 6: plus the base.
  logic [PitchW-1:0] pitch_3;
  logic [PitchW-3:0] pitch_high_4;
  logic [AddressW-1:0] base_5;
  delay_line #(
      .Width(PitchW),
      .Depth(3)
  ) u_pitch_line (
      .clk_i,
      .en_i,
      .d_i(pitch),
      .q_o(pitch_3)
  );
  ring_line #(
      .Width(AddressW),
      .Depth(Clocks - 1)
  ) u_base_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(base_i),
      .q_o(base_5)
  );
  logic [AddressW-1:0] first_row_4, second_row_4, first_row_5, second_row_5;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      pitch_high_4 <= pitch_3[PitchW-1:2];
      first_row_4 <= AddressW'(first_j_3) << pitch_3[1:0];
      second_row_4 <= AddressW'(second_j_3) << pitch_3[1:0];
      first_row_5 <= first_row_4 << {pitch_high_4, 2'b00};
      second_row_5 <= second_row_4 << {pitch_high_4, 2'b00};
      first_row_o <= base_5 + first_row_5;
      second_row_o <= base_5 + second_row_5;
    end
  end
  delay_line #(
      .Width(3 * IndexW),
      .Depth(3)
  ) u_index_line (
      .clk_i,
      .en_i,
      .d_i({first_3[0+:IndexW], second_3[0+:IndexW], first_3[IndexW+:IndexW]}),
      .q_o({first_i_o, second_i_o, first_j_o})
  );

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::TextureAddressClocks)
    else $fatal(1, "texture_address: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::TextureAddressClocks);
  end
`endif
endmodule
