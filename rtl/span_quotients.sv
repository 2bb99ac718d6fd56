// SPDX-License-Identifier: Apache-2.0
// Two values of a pixel of span, each Q[format](numerator m 2^-e + base) with m and e of R_pixel(h + B): u and v, or
// two channels. What goes in at the issue comes out at tick Clocks. With an interval above 1 they take turns in one
// multiplier, the second one Digits ticks behind the first.
module span_quotients #(
    parameter int AW         = 8,
    parameter int AFrac      = 0,
    parameter int ASigned    = 1,
    parameter int BaseW      = 1,
    parameter int BaseFrac   = 0,
    parameter int BaseSigned = 0,
    parameter int OutW       = 8,
    parameter int OutFrac    = 0,
    parameter int OutSigned  = 1,
    parameter int OutRnd     = 0,
    parameter int OutOvf     = 0,
    // The ticks of the reciprocal, of the later slot in the multiplier, and of the pixel at the output.
    parameter int RecipTick  = 1,
    parameter int LastSlot   = 1,
    parameter int Clocks     = 1,
    parameter int Interval   = bitspan_cfg_pkg::PixelInterval,
    parameter int PhaseW     = (Interval > 1) ? $clog2(Interval) : 1,
    parameter int MW         = bitspan_cfg_pkg::PixelRecipOutW,
    parameter int EW         = bitspan_cfg_pkg::ExponentW
) (
    input  logic                clk_i,
    input  logic                rst_ni,
    input  logic                en_i,
    // The tick modulo Interval.
    input  logic [  PhaseW-1:0] phase_i,
    // At the issue; the second one stands above the first.
    input  logic [    2*AW-1:0] numerator_i,
    input  logic [ 2*BaseW-1:0] base_i,
    // At RecipTick.
    input  logic [      MW-1:0] recip_m_i,
    input  logic [      EW-1:0] recip_e_i,
    output logic [    2*AW-1:0] numerator_o,
    output logic [  2*OutW-1:0] q_o
);
  localparam int Digits = bitspan_cfg_pkg::ProductDigits;
  // A normalised mantissa is at most 1.
  localparam int MantissaTopAlone = (bitspan_cfg_pkg::PixelRecipNormalize != 0 &&
      bitspan_cfg_pkg::PixelRecipOutSigned == 0 && MW == bitspan_cfg_pkg::PixelRecipOutFrac + 1) ? 1 : 0;
  // The numerator, the reciprocal, and what their product is added to: at each one's slot.
  logic [2*AW-1:0] numerator;
  logic [2*MW-1:0] mantissa;
  logic [2*EW-1:0] exponent;
  logic [2*(BaseW+1)-1:0] addend;
  for (genvar i = 0; i < 2; i++) begin : gen_factors
    localparam int Slot = (i == 0) ? RecipTick : LastSlot;
    logic [BaseW-1:0] base;
    span_delay #(
        .Width(AW + BaseW),
        .From(0),
        .To(Slot)
    ) u_numerator (
        .clk_i,
        .en_i,
        .phase_i,
        .d_i({numerator_i[i*AW+:AW], base_i[i*BaseW+:BaseW]}),
        .q_o({numerator[i*AW+:AW], base})
    );
    span_delay #(
        .Width(MW + EW),
        .From(RecipTick),
        .To(Slot)
    ) u_recip (
        .clk_i,
        .en_i,
        .phase_i,
        .d_i({recip_m_i, recip_e_i}),
        .q_o({mantissa[i*MW+:MW], exponent[i*EW+:EW]})
    );
    span_delay #(
        .Width(AW),
        .From(Slot),
        .To(Clocks)
    ) u_f (
        .clk_i,
        .en_i,
        .phase_i,
        .d_i(numerator[i*AW+:AW]),
        .q_o(numerator_o[i*AW+:AW])
    );
    assign addend[i*(BaseW+1)+:BaseW+1] = {(BaseSigned != 0) & base[BaseW-1], base};
  end

  if (Interval == 1) begin : gen_side_by_side
    for (genvar i = 0; i < 2; i++) begin : gen_value
      logic signed [BaseW:0] c;
      logic signed [EW-1:0] e;
      assign c = addend[i*(BaseW+1)+:BaseW+1];
      assign e = exponent[i*EW+:EW];
      multiply_round #(
          .AW(AW),
          .AFrac(AFrac),
          .ASigned(ASigned),
          .BW(MW),
          .BFrac(bitspan_cfg_pkg::PixelRecipOutFrac),
          .BSigned(bitspan_cfg_pkg::PixelRecipOutSigned),
          .BTopAlone(MantissaTopAlone),
          .CW(BaseW + 1),
          .CFrac(BaseFrac),
          .EW(EW),
          .EMin(bitspan_cfg_pkg::PixelRecipEMin),
          .EMax(bitspan_cfg_pkg::PixelRecipEMax),
          .OutW(OutW),
          .OutFrac(OutFrac),
          .OutSigned(OutSigned),
          .OutRnd(OutRnd),
          .OutOvf(OutOvf),
          .ProductClocks(bitspan_cfg_pkg::ProductClocks)
      ) u_value (
          .clk_i,
          .en_i,
          .a_i(numerator[i*AW+:AW]),
          .b_i(mantissa[i*MW+:MW]),
          .c_i(c),
          .e_i(e),
          .q_o(q_o[i*OutW+:OutW])
      );
    end
    logic unused;
    assign unused = rst_ni;
  end else begin : gen_in_turns
    logic [1:0] select_q;
    logic [OutW-1:0] q;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) begin
        select_q <= '0;
      end else if (en_i) begin
        select_q <= {phase_i == PhaseW'((LastSlot - 1) % Interval), phase_i == PhaseW'((RecipTick - 1) % Interval)};
      end
    end
    multiply_round_turns #(
        .Turns(2),
        .AW(AW),
        .AFrac(AFrac),
        .ASigned(ASigned),
        .BW(MW),
        .BFrac(bitspan_cfg_pkg::PixelRecipOutFrac),
        .BSigned(bitspan_cfg_pkg::PixelRecipOutSigned),
        .CW(BaseW + 1),
        .CFrac(BaseFrac),
        .EW(EW),
        .EMin(bitspan_cfg_pkg::PixelRecipEMin),
        .EMax(bitspan_cfg_pkg::PixelRecipEMax),
        .OutW(OutW),
        .OutFrac(OutFrac),
        .OutSigned(OutSigned),
        .OutRnd(OutRnd),
        .OutOvf(OutOvf),
        .ProductClocks(bitspan_cfg_pkg::SharedProductClocks),
        .Digits(Digits)
    ) u_value (
        .clk_i,
        .rst_ni,
        .en_i,
        .select_i(select_q),
        .a_i(numerator),
        .b_i(mantissa),
        .c_i(addend),
        .e_i(exponent),
        .q_o(q)
    );
    // The second value comes Digits ticks behind the first, and goes out with it.
    for (genvar i = 0; i < 2; i++) begin : gen_value
      span_delay #(
          .Width(OutW),
          .From((i == 0) ? Clocks - 1 - Digits : Clocks - 1),
          .To(Clocks)
      ) u_q (
          .clk_i,
          .en_i,
          .phase_i,
          .d_i(q),
          .q_o(q_o[i*OutW+:OutW])
      );
    end
  end
endmodule
