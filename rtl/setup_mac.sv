// SPDX-License-Identifier: Apache-2.0
// A multiplier that products take turns in: a b 2^-shift + c of whichever product has the clock.
//
// select_i has a bit per product, of which at most one is set; a, b, c and shift of product k stand at place k of the
// inputs. {sum, sticky, far, sign} of shift_add comes 4 + ProductClocks enabled clocks later. With more digits than one
// (mul_digits) a bit is set once per Digits clocks at most, and ProductClocks is Digits + 1.
//
//   operands | product: ProductClocks | shift (2) | sum |
module setup_mac #(
    parameter int Products      = 8,
    parameter int AW            = 18,
    parameter int BW            = 18,
    parameter int CW            = 18,
    parameter int SumW          = 22,
    parameter int ShiftBase     = 0,
    parameter int ShiftMax      = 0,
    parameter int ShiftW        = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1,
    parameter int ProductClocks = 3,
    parameter int Digits        = 1
) (
    input  logic                       clk_i,
    input  logic                       rst_ni,
    input  logic                       en_i,
    input  logic [       Products-1:0] select_i,
    input  logic [    Products*AW-1:0] a_i,
    input  logic [    Products*BW-1:0] b_i,
    input  logic [    Products*CW-1:0] c_i,
    input  logic [Products*ShiftW-1:0] shift_i,
    // The product alone, 1 + ProductClocks enabled clocks later.
    output logic [          AW+BW-1:0] product_o,
    output logic [         SumW+3-1:0] sum_o
);
  logic [AW-1:0] a, a_q;
  logic [BW-1:0] b, b_q;
  logic [CW-1:0] c, c_q, c_sum;
  logic [ShiftW-1:0] shift, shift_q, shift_p;
  always_comb begin
    a = '0;
    b = '0;
    c = '0;
    shift = '0;
    for (int k = 0; k < Products; k++) begin
      a = a | (a_i[k*AW+:AW] & {AW{select_i[k]}});
      b = b | (b_i[k*BW+:BW] & {BW{select_i[k]}});
      c = c | (c_i[k*CW+:CW] & {CW{select_i[k]}});
      shift = shift | (shift_i[k*ShiftW+:ShiftW] & {ShiftW{select_i[k]}});
    end
  end
  logic [AW+BW-1:0] product;
  if (Digits == 1) begin : gen_at_once
    logic unused;
    assign unused = rst_ni;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        a_q <= a;
        b_q <= b;
        c_q <= c;
        shift_q <= shift;
      end
    end
    mul_pipe #(
        .AW(AW),
        .BW(BW),
        .Clocks(ProductClocks)
    ) u_product (
        .clk_i,
        .en_i,
        .a_i(a_q),
        .b_i(b_q),
        .p_o(product)
    );
    delay_line #(
        .Width(ShiftW),
        .Depth(ProductClocks)
    ) u_shift (
        .clk_i,
        .en_i,
        .d_i(shift_q),
        .q_o(shift_p)
    );
    delay_line #(
        .Width(CW),
        .Depth(ProductClocks + 2)
    ) u_c (
        .clk_i,
        .en_i,
        .d_i(c_q),
        .q_o(c_sum)
    );
  end else begin : gen_in_digits
    // loaded_q[k]: k + 1 clocks ago. Each register keeps its value until the next product's comes, Digits clocks later at
    // the earliest; so two registers behind one another bring c to its clock.
    logic load;
    logic [Digits+1:0] loaded_q;
    logic [CW-1:0] c_waits_q, c_sum_q;
    logic [ShiftW-1:0] shift_waits_q;
    assign load = |select_i;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        loaded_q <= (Digits + 2)'({loaded_q, load});
        if (load) begin
          a_q <= a;
          b_q <= b;
          c_q <= c;
          shift_q <= shift;
        end
        if (loaded_q[Digits-1]) begin
          c_waits_q <= c_q;
          shift_waits_q <= shift_q;
        end
        if (loaded_q[Digits+1]) c_sum_q <= c_waits_q;
      end
    end
    mul_digits #(
        .AW(AW),
        .BW(BW),
        .Digits(Digits)
    ) u_product (
        .clk_i,
        .rst_ni,
        .en_i,
        .start_i(loaded_q[0]),
        .a_i(a_q),
        .b_i(b_q),
        .p_o(product)
    );
    assign shift_p = shift_waits_q;
    assign c_sum = c_sum_q;
  end
  // Yosys 0.23 takes no $signed() of a name in a port's connection.
  logic signed [AW+BW-1:0] signed_product;
  logic signed [CW-1:0] signed_c;
  assign signed_product = product;
  assign product_o = product;
  assign signed_c = c_sum;
  logic signed [SumW-1:0] sum;
  logic sticky, far, sign;
  assign sum_o = {sum, sticky, far, sign};
  shift_add #(
      .InW(AW + BW),
      .Base(ShiftBase),
      .ShiftMax(ShiftMax),
      .CW(CW),
      .KeptW(SumW)
  ) u_sum (
      .clk_i,
      .en_i,
      .x_i(signed_product),
      .shift_i(shift_p),
      .c_i(signed_c),
      .sum_o(sum),
      .sticky_o(sticky),
      .far_o(far),
      .sign_o(sign)
  );

`ifndef SYNTHESIS
  initial begin
    assert (Digits == 1 || ProductClocks == Digits + 1)
    else $fatal(1, "setup_mac: %0d digits in %0d clocks", Digits, ProductClocks);
  end
`endif
endmodule
