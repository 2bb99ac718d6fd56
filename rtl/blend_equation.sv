// SPDX-License-Identifier: Apache-2.0
// One channel of merge by any blend or logic operation of docs/numeric-spec.md: factors, operation, Q. Clocks enabled
// clocks later.
//
//   clocks  | operands | factors | two products: ProductClocks | operation | Q |
//
// With IsAlpha the channel is alpha: src_i is not read, and the fragment's alpha code takes its place. a is the
// fragment's alpha; what is above 1 counts as 1. Every operand and all of the draw state is taken with the fragment.
module blend_equation #(
    parameter int IsAlpha = 0,
    parameter int ProductClocks = 1,
    parameter int Clocks = 5
) (
    input  logic clk_i,
    input  logic en_i,
    input  logic [bitspan_pixel_pkg::FogColorW-1:0] src_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] a_i,
    // The stored codes, of the channel and of alpha.
    input  logic [7:0] dst_i,
    input  logic [7:0] dst_alpha_i,
    // The draw state.
    input  logic [3:0] factor_src_i,
    input  logic [3:0] factor_dst_i,
    input  logic [2:0] op_i,
    input  logic [7:0] constant_i,
    input  logic [7:0] constant_alpha_i,
    input  logic [4:0] logic_i,
    output logic [7:0] q_o
);
  localparam int ColorInW = bitspan_pixel_pkg::FogColorW;
  localparam int ColorInFrac = bitspan_pixel_pkg::FogColorFrac;
  localparam int ColorInSigned = bitspan_pixel_pkg::FogColorSigned;
  localparam int AlphaW = bitspan_pixel_pkg::TextureAlphaW;
  localparam int AlphaFrac = bitspan_pixel_pkg::TextureAlphaFrac;
  localparam int AlphaSigned = bitspan_pixel_pkg::TextureAlphaSigned;
  // The grid of alpha, which has 1, and that of factors, which has c of a code, too.
  localparam int AGrid = (AlphaFrac > 0) ? AlphaFrac : 0;
  localparam int FactorFrac = (AGrid > 8) ? AGrid : 8;
  localparam int AWideW = AlphaW + AGrid - AlphaFrac + 1;
  // Two places left of the point: 1 minus a negative alpha of down to -2^(AWideW - AGrid).
  localparam int FactorW = AWideW + FactorFrac - AGrid + 2;
  localparam int SrcFrac = (IsAlpha != 0 || ColorInFrac < 0) ? 0 : ColorInFrac;
  localparam int SrcW = (IsAlpha != 0) ? AWideW - AGrid + 9 : ColorInW + SrcFrac - ColorInFrac + 1;
  localparam int DstW = 9;

  // ---------------------------------------------------------------- clock 1: a, at most 1, and the codes of src and a

  logic signed [AWideW-1:0] a_wide, a_one, a_1;
  assign a_wide = AWideW'($signed({(AlphaSigned != 0) & a_i[AlphaW-1], a_i})) <<< (AGrid - AlphaFrac);
  assign a_one = AWideW'(1) <<< AGrid;
  logic [7:0] dst_1, dst_alpha_1, constant_1, constant_alpha_1;
  logic [3:0] factor_src_1, factor_dst_1;
  logic [2:0] op_1;
  logic [4:0] logic_1;
  logic signed [SrcW-1:0] src_1;
  logic [7:0] code_1;
  if (IsAlpha != 0) begin : gen_alpha
    // floor(255 a + 1/2).
    localparam int ScaledW = AWideW + 9;
    logic signed [AWideW-1:0] a_held;
    logic signed [ScaledW:0] scaled;
    logic signed [SrcW-1:0] code;
    assign a_held = (a_wide > a_one) ? a_one : a_wide;
    assign scaled = ((ScaledW + 1)'(a_held) <<< 9) - ((ScaledW + 1)'(a_held) <<< 1) + ((ScaledW + 1)'(1) <<< AGrid);
    assign code = SrcW'(scaled >>> (AGrid + 1));
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        src_1 <= code;
        code_1 <= code[7:0];
      end
    end
    logic unused;
    assign unused = ^{src_i, scaled};
  end else begin : gen_color
    // floor(src + 1/2): twice the sum, which has a bit more than src and one below the point.
    logic signed [SrcW-1:0] src;
    logic signed [SrcW+1:0] twice, whole;
    assign src = SrcW'($signed({(ColorInSigned != 0) & src_i[ColorInW-1], src_i})) <<< (SrcFrac - ColorInFrac);
    assign twice = ((SrcW + 2)'(src) <<< 1) + ((SrcW + 2)'(1) <<< SrcFrac);
    assign whole = twice >>> (SrcFrac + 1);
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        src_1 <= src;
        code_1 <= (whole < 0) ? '0 : (whole > 255) ? '1 : 8'(whole);
      end
    end
  end
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      a_1 <= (a_wide > a_one) ? a_one : a_wide;
      {dst_1, dst_alpha_1} <= {dst_i, dst_alpha_i};
      {constant_1, constant_alpha_1} <= {constant_i, constant_alpha_i};
      {factor_src_1, factor_dst_1, op_1, logic_1} <= {factor_src_i, factor_dst_i, op_i, logic_i};
    end
  end

  // ---------------------------------------------------------------- clock 2: factors

  // By the number of a factor without its lowest bit, which takes it from 1; but the last number is a half.
  function automatic logic signed [FactorW-1:0] of_code(input logic [7:0] code);
    of_code = (FactorW'({1'b0, code}) + FactorW'({1'b0, code[7]})) <<< (FactorFrac - 8);
  endfunction
  localparam logic signed [FactorW-1:0] One = FactorW'(1) <<< FactorFrac;
  logic signed [FactorW-1:0] share, room;
  assign share = FactorW'(a_1) <<< (FactorFrac - AGrid);
  assign room = One - of_code(dst_alpha_1);
  // What factors are made of. No index of a vector chooses one: its product with the width would take a multiplier. And
  // Icarus 11 takes no function in the block that chooses.
  logic signed [FactorW-1:0] own_base, dst_base, dst_alpha_base, constant_base, constant_alpha_base, least_base;
  assign own_base = (IsAlpha != 0) ? share : of_code(code_1);
  assign dst_base = of_code(dst_1);
  assign dst_alpha_base = of_code(dst_alpha_1);
  assign constant_base = of_code(constant_1);
  assign constant_alpha_base = of_code(constant_alpha_1);
  assign least_base = (IsAlpha != 0) ? One : (share < room) ? share : room;
  // Of the fragment's factor, and of the stored one's.
  logic [2*FactorW-1:0] bases;
  for (genvar i = 0; i < 2; i++) begin : gen_base
    logic [2:0] kind;
    logic signed [FactorW-1:0] base;
    assign kind = (i == 0) ? factor_src_1[3:1] : factor_dst_1[3:1];
    always_comb begin
      case (kind)
        3'd0: base = '0;
        3'd1: base = own_base;
        3'd2: base = dst_base;
        3'd3: base = share;
        3'd4: base = dst_alpha_base;
        3'd5: base = constant_base;
        3'd6: base = constant_alpha_base;
        default: base = least_base;
      endcase
    end
    assign bases[i*FactorW+:FactorW] = base;
  end
  // Of a pair of factors, which the lowest bit of the number tells apart.
  function automatic logic signed [FactorW-1:0] of_number(input logic [3:0] number, input logic signed [FactorW-1:0] base);
    if (32'(number) == bitspan_pixel_pkg::BlendFactorHalf) of_number = One >>> 1;
    else of_number = number[0] ? One - base : base;
  endfunction
  logic signed [FactorW-1:0] base_src, base_dst, factor_src_2, factor_dst_2;
  assign {base_dst, base_src} = bases;
  logic signed [SrcW-1:0] src_2;
  logic signed [DstW-1:0] dst_2;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      factor_src_2 <= of_number(factor_src_1, base_src);
      factor_dst_2 <= of_number(factor_dst_1, base_dst);
      src_2 <= src_1;
      dst_2 <= $signed({1'b0, dst_1});
    end
  end

  // ---------------------------------------------------------------- products

  logic signed [SrcW+FactorW-1:0] product_src;
  logic signed [DstW+FactorW-1:0] product_dst;
  mul_pipe #(
      .AW(SrcW),
      .BW(FactorW),
      .Clocks(ProductClocks)
  ) u_product_src (
      .clk_i,
      .en_i,
      .a_i(src_2),
      .b_i(factor_src_2),
      .p_o(product_src)
  );
  mul_pipe #(
      .AW(DstW),
      .BW(FactorW),
      .Clocks(ProductClocks)
  ) u_product_dst (
      .clk_i,
      .en_i,
      .a_i(dst_2),
      .b_i(factor_dst_2),
      .p_o(product_dst)
  );
  logic [SrcW-1:0] src_waited;
  logic [7:0] dst_late, code_late;
  logic signed [SrcW-1:0] src_late;
  logic [2:0] op_late;
  logic [4:0] logic_late;
  assign src_late = src_waited;
  delay_line #(
      .Width(SrcW),
      .Depth(ProductClocks + 1)
  ) u_src_line (
      .clk_i,
      .en_i,
      .d_i(src_1),
      .q_o(src_waited)
  );
  delay_line #(
      .Width(24),
      .Depth(ProductClocks + 1)
  ) u_state_line (
      .clk_i,
      .en_i,
      .d_i({dst_1, code_1, op_1, logic_1}),
      .q_o({dst_late, code_late, op_late, logic_late})
  );

  // ---------------------------------------------------------------- operation

  localparam int SumFrac = SrcFrac + FactorFrac;
  localparam int OwnW = SrcW + FactorW;
  localparam int StoredW = DstW + FactorW + SrcFrac;
  localparam int SumW = ((OwnW > StoredW) ? OwnW : StoredW) + 1;
  logic signed [SumW-1:0] own, stored, own_alone, stored_alone, sum_q;
  assign own = SumW'(product_src);
  assign stored = SumW'(product_dst) <<< SrcFrac;
  assign own_alone = SumW'(src_late) <<< FactorFrac;
  assign stored_alone = SumW'($signed({1'b0, dst_late})) <<< SumFrac;
  logic [7:0] replaced, replaced_q, dst_q;
  logic [4:0] logic_q;
  if (IsAlpha != 0) begin : gen_code
    assign replaced = code_late;
  end else begin : gen_replaced
    quantize #(
        .InW(SrcW),
        .InFrac(SrcFrac),
        .OutW(8),
        .OutFrac(0),
        .OutSigned(0),
        .Rounding(bitspan_pixel_pkg::MergeColorRnd),
        .Overflow(bitspan_pixel_pkg::MergeColorOvf)
    ) u_replaced (
        .x_i(src_late),
        .sticky_i(1'b0),
        .q_o(replaced)
    );
    logic unused;
    assign unused = ^code_late;
  end
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      case (32'(op_late))
        bitspan_pixel_pkg::BlendOpSubtract: sum_q <= own - stored;
        bitspan_pixel_pkg::BlendOpReverseSubtract: sum_q <= stored - own;
        bitspan_pixel_pkg::BlendOpMin: sum_q <= (stored_alone < own_alone) ? stored_alone : own_alone;
        bitspan_pixel_pkg::BlendOpMax: sum_q <= (stored_alone > own_alone) ? stored_alone : own_alone;
        default: sum_q <= own + stored;  // add
      endcase
      replaced_q <= replaced;
      dst_q <= dst_late;
      logic_q <= logic_late;
    end
  end

  // ---------------------------------------------------------------- Q, or the logic operation

  logic [7:0] mixed;
  logic [3:0] truth;
  quantize #(
      .InW(SumW),
      .InFrac(SumFrac),
      .OutW(8),
      .OutFrac(0),
      .OutSigned(0),
      .Rounding(bitspan_pixel_pkg::MergeColorRnd),
      .Overflow(bitspan_pixel_pkg::MergeColorOvf)
  ) u_mixed (
      .x_i(sum_q),
      .sticky_i(1'b0),
      .q_o(mixed)
  );
  // The number less one is a truth table: both, the fragment's alone, the stored one alone, neither.
  assign truth = 4'(logic_q - 5'd1);
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      q_o <= (logic_q == '0) ? mixed :
             ({8{truth[0]}} & replaced_q & dst_q) | ({8{truth[1]}} & replaced_q & ~dst_q) |
             ({8{truth[2]}} & ~replaced_q & dst_q) | ({8{truth[3]}} & ~replaced_q & ~dst_q);
    end
  end

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == ProductClocks + 4)
    else $fatal(1, "blend_equation: has %0d clocks, told %0d", ProductClocks + 4, Clocks);
    assert (bitspan_pixel_pkg::BlendFactorZero == 0 && bitspan_pixel_pkg::BlendFactorSrcColor == 2 &&
            bitspan_pixel_pkg::BlendFactorDstColor == 4 && bitspan_pixel_pkg::BlendFactorSrcAlpha == 6 &&
            bitspan_pixel_pkg::BlendFactorDstAlpha == 8 && bitspan_pixel_pkg::BlendFactorConstantColor == 10 &&
            bitspan_pixel_pkg::BlendFactorConstantAlpha == 12 && bitspan_pixel_pkg::BlendFactorSrcAlphaSaturate == 14)
    else $fatal(1, "blend_equation: the factors are numbered otherwise");
  end
`endif
endmodule
