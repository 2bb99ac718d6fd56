// SPDX-License-Identifier: Apache-2.0
// Q[format](x) of docs/numeric-spec.md: rounds x_i to OutFrac fraction bits, then brings it into OutW bits.
// Combinational.
//
//   x_i        signed, InW bits, InFrac of them right of the point (may be negative or above InW)
//   sticky_i   1: the exact value lies strictly between x_i and x_i + 1 ulp; needs InFrac > OutFrac
//   far_i      1: x_i has only the low InW bits of a value that lies outside the format's range; they are enough with
//              InW >= OutW + InFrac - OutFrac + 2
//   sign_i     the value is negative; read where far_i is 1
//   q_o        raw bits of the format, two's complement when OutSigned
//
//                 |<------- floor ------->|guard|<-- rest -->| sticky
//   x_i  sign ... |           ...     q0  |  g  |   ...      |
//                                        ^ 2^-OutFrac
module quantize_far #(
    parameter int InW       = 8,
    parameter int InFrac    = 4,
    parameter int OutW      = 4,
    parameter int OutFrac   = 2,
    parameter int OutSigned = 1,
    parameter int Rounding  = 0,
    parameter int Overflow  = 0
) (
    input  logic signed [ InW-1:0] x_i,
    input  logic                   sticky_i,
    input  logic                   far_i,
    input  logic                   sign_i,
    output logic        [OutW-1:0] q_o
);
  localparam int RndHalfUp = 0;
  localparam int RndZero = 1;
  localparam int RndMinInf = 2;
  localparam int RndInf = 3;
  localparam int RndConv = 4;
  localparam int Trn = 5;
  localparam int TrnZero = 6;

  localparam int OvfWrap = 0;
  localparam int OvfSat = 1;
  localparam int OvfSatZero = 2;
  localparam int OvfSatSym = 3;
  localparam int OvfWrapSm = 4;

  // Bits dropped on the right, or appended.
  localparam int Drop = (InFrac > OutFrac) ? InFrac - OutFrac : 0;
  localparam int Append = (InFrac > OutFrac) ? 0 : OutFrac - InFrac;
  // x with at least one bit left of the dropped ones.
  localparam int ExtW = ((InW > Drop) ? InW : Drop + 1) + 1;
  // The rounded value, one bit above the kept ones included: wrap_sm looks at it.
  localparam int NeededW = ExtW - Drop + Append + 1;
  localparam int RoundedW = (NeededW > OutW + 1) ? NeededW : OutW + 1;

  logic signed [ExtW-1:0] x;
  logic signed [RoundedW-1:0] rounded;
  logic negative, x_negative;
  assign x = ExtW'(x_i);
  assign x_negative = far_i ? sign_i : x[ExtW-1];

  if (Drop > 0) begin : gen_drop
    logic guard, rest, up;
    logic signed [ExtW-Drop-1:0] floor;
    assign floor = x[ExtW-1:Drop];
    assign guard = x[Drop-1];
    if (Drop > 1) begin : gen_rest
      assign rest = (|x[Drop-2:0]) | sticky_i;
    end else begin : gen_no_rest
      assign rest = sticky_i;
    end
    if (Rounding == RndHalfUp) begin : gen_rnd
      assign up = guard;
    end else if (Rounding == RndZero) begin : gen_rnd_zero
      assign up = guard & (rest | x_negative);
    end else if (Rounding == RndMinInf) begin : gen_rnd_min_inf
      assign up = guard & rest;
    end else if (Rounding == RndInf) begin : gen_rnd_inf
      assign up = guard & (rest | ~x_negative);
    end else if (Rounding == RndConv) begin : gen_rnd_conv
      assign up = guard & (rest | floor[0]);
    end else if (Rounding == TrnZero) begin : gen_trn_zero
      assign up = x_negative & (guard | rest);
    end else begin : gen_trn
      assign up = 1'b0;
    end
    logic unused;
    assign unused = guard | rest;
    assign rounded = RoundedW'(floor) + RoundedW'($signed({1'b0, up}));
  end else begin : gen_append
    assign rounded = RoundedW'(x) <<< Append;
    logic unused;
    assign unused = sticky_i;
  end

  assign negative = far_i ? sign_i : rounded[RoundedW-1];

  logic fits;
  if (OutSigned != 0) begin : gen_fits_signed
    assign fits = (&rounded[RoundedW-1:OutW-1]) | ~(|rounded[RoundedW-1:OutW-1]);
  end else begin : gen_fits_unsigned
    assign fits = ~(|rounded[RoundedW-1:OutW]);
  end

  // What an out of range value becomes.
  logic [OutW-1:0] beyond;
  if (Overflow == OvfWrap) begin : gen_wrap
    assign beyond = rounded[OutW-1:0];
  end else if (Overflow == OvfSatZero) begin : gen_sat_zero
    assign beyond = '0;
  end else if (Overflow == OvfWrapSm && OutW > 1) begin : gen_wrap_sm
    logic above;
    assign above = rounded[OutW];
    assign beyond = {above, rounded[OutW-2:0] ^ {(OutW-1){above ^ rounded[OutW-1]}}};
  end else if (Overflow == OvfWrapSm) begin : gen_wrap_sm_1
    assign beyond = rounded[OutW];
  end else if (OutSigned == 0) begin : gen_sat_unsigned
    assign beyond = {OutW{~negative}};
  end else if (OutW == 1) begin : gen_sat_1
    assign beyond = (Overflow == OvfSatSym) ? 1'b0 : negative;
  end else if (Overflow == OvfSatSym) begin : gen_sat_sym
    // -max is 100..01; it is also what 100..00, which fits, becomes.
    assign beyond = {negative, {(OutW-1){~negative}}} | {{(OutW-1){1'b0}}, negative};
  end else begin : gen_sat
    assign beyond = {negative, {(OutW-1){~negative}}};
  end

  logic lowest;
  if (Overflow == OvfSatSym && OutSigned != 0) begin : gen_lowest
    if (OutW > 1) begin : gen_wide
      assign lowest = rounded[OutW-1] & ~(|rounded[OutW-2:0]);
    end else begin : gen_narrow
      assign lowest = rounded[0];
    end
  end else begin : gen_no_lowest
    assign lowest = 1'b0;
  end

  logic unused_sign;
  assign unused_sign = negative ^ x_negative;
  assign q_o = (fits & ~lowest & ~far_i) ? rounded[OutW-1:0] : beyond;

`ifndef SYNTHESIS
  initial begin
    assert (InW >= 1 && OutW >= 1)
    else $fatal(1, "quantize: widths must be positive");
    assert (Rounding >= RndHalfUp && Rounding <= TrnZero && Trn == 5)
    else $fatal(1, "quantize: unknown rounding %0d", Rounding);
    assert (Overflow >= OvfWrap && Overflow <= OvfWrapSm && OvfSat == 1)
    else $fatal(1, "quantize: unknown overflow %0d", Overflow);
    assert (Overflow != OvfWrapSm || OutSigned != 0)
    else $fatal(1, "quantize: wrap_sm is for signed formats");
  end
`endif
endmodule
