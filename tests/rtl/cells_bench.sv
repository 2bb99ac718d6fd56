// SPDX-License-Identifier: Apache-2.0
// mul_pipe, lzc_norm and shift_add against the language's own operators, on random and extreme operands. A seed comes as
// +seed=N, the number of operands as +operands=N (4000); the last line is `checked N, errors M`.
module mul_pipe_check #(
    parameter int AW        = 8,
    parameter int BW        = 8,
    parameter int ASigned   = 1,
    parameter int BSigned   = 1,
    parameter int BTopAlone = 0,
    parameter int Clocks    = 3
) (
    input logic clk_i,
    input logic [127:0] random_i,
    output int errors_o,
    output int checked_o
);
  logic [AW-1:0] a;
  logic [BW-1:0] b;
  logic [AW+BW-1:0] p;
  logic signed [AW+BW+1:0] wide_a, wide_b, product;
  logic [AW+BW-1:0] expected[Clocks+1];
  int clocks = 0;
  assign a = AW'(random_i);
  // Where b's top bit stands alone, one operand of four has it.
  assign b = (BTopAlone == 0) ? BW'(random_i >> 64) :
             (random_i[127:126] == 2'd0) ? BW'(1) << (BW - 1) : BW'(random_i >> 64) & ~(BW'(1) << (BW - 1));
  assign wide_a = $signed({(ASigned != 0) & a[AW-1], a});
  assign wide_b = $signed({(BSigned != 0) & b[BW-1], b});
  assign product = wide_a * wide_b;
  mul_pipe #(
      .AW(AW), .BW(BW), .ASigned(ASigned), .BSigned(BSigned), .BTopAlone(BTopAlone), .Clocks(Clocks)
  ) u_dut (
      .clk_i, .en_i(1'b1), .a_i(a), .b_i(b), .p_o(p)
  );
  initial begin
    errors_o = 0;
    checked_o = 0;
  end
  always @(posedge clk_i) begin
    expected[0] <= product[AW+BW-1:0];
    for (int i = 1; i <= Clocks; i++) expected[i] <= expected[i-1];
    clocks <= clocks + 1;
    if (clocks > Clocks) begin
      checked_o <= checked_o + 1;
      if (p !== expected[Clocks-1]) errors_o <= errors_o + 1;
    end
  end
endmodule

module lzc_norm_check #(
    parameter int Width  = 8,
    parameter int Clocks = 2
) (
    input logic clk_i,
    input logic [127:0] random_i,
    output int errors_o,
    output int checked_o
);
  localparam int CountW = $clog2(Width + 1);
  logic [Width-1:0] d, n;
  logic [CountW-1:0] zeros;
  logic [Width-1:0] given[Clocks+1];
  int clocks = 0;
  // Any number of leading zeros; never 0.
  assign d = (Width'(random_i) >> (random_i[120:64] % Width)) | Width'(1);
  lzc_norm #(
      .Width(Width), .Clocks(Clocks)
  ) u_dut (
      .clk_i, .en_i(1'b1), .d_i(d), .n_o(n), .zeros_o(zeros)
  );
  initial begin
    errors_o = 0;
    checked_o = 0;
  end
  always @(posedge clk_i) begin
    given[0] <= d;
    for (int i = 1; i <= Clocks; i++) given[i] <= given[i-1];
    clocks <= clocks + 1;
    if (clocks > Clocks) begin
      checked_o <= checked_o + 1;
      if (!n[Width-1] || n !== given[Clocks-1] << zeros) errors_o <= errors_o + 1;
    end
  end
endmodule

module shift_add_check #(
    parameter int InW      = 16,
    parameter int Base     = 0,
    parameter int ShiftMax = 0,
    parameter int CW       = 8,
    parameter int KeptW    = 16
) (
    input logic clk_i,
    input logic [127:0] random_i,
    output int errors_o,
    output int checked_o
);
  localparam int ShiftW = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1;
  localparam int WideW = InW + ShiftMax + KeptW + CW + 32;
  logic signed [InW-1:0] x;
  logic [ShiftW-1:0] shift;
  logic signed [CW-1:0] c, c_1, c_2;
  logic signed [KeptW-1:0] sum;
  logic sticky, far, sign;
  // The exact value with 32 bits right of the point; Base and ShiftMax are at most 32 together.
  logic signed [WideW-1:0] exact, floor, total;
  logic e_sticky, e_far;
  logic [WideW+1:0] line[4];
  int clocks = 0;
  assign x = InW'(random_i);
  assign shift = (random_i[127:64] % (ShiftMax + 1));
  assign c = CW'(random_i >> 32);
  assign exact = (Base < 0) ? (WideW'(x) <<< (32 - Base)) >>> shift : (WideW'(x) <<< 32) >>> (Base + shift);
  assign floor = exact >>> 32;
  assign total = floor + WideW'(c);
  assign e_sticky = exact[31:0] != 0;
  assign e_far = floor != WideW'($signed(floor[KeptW-4:0]));
  shift_add #(
      .InW(InW), .Base(Base), .ShiftMax(ShiftMax), .CW(CW), .KeptW(KeptW)
  ) u_dut (
      .clk_i, .en_i(1'b1), .x_i(x), .shift_i(shift), .c_i(c_2),
      .sum_o(sum), .sticky_o(sticky), .far_o(far), .sign_o(sign)
  );
  initial begin
    errors_o = 0;
    checked_o = 0;
  end
  always @(posedge clk_i) begin
    c_1 <= c;
    c_2 <= c_1;
    line[0] <= {e_sticky, e_far, total};
    for (int i = 1; i < 4; i++) line[i] <= line[i-1];
    clocks <= clocks + 1;
    if (clocks > 4) begin
      checked_o <= checked_o + 1;
      if (sum !== line[2][KeptW-1:0] || sticky !== line[2][WideW+1] || far !== line[2][WideW] ||
          sign !== line[2][WideW-1]) begin
        errors_o <= errors_o + 1;
      end
    end
  end
endmodule

module cells_bench;
  logic clk = 1'b0;
  logic [127:0] random;
  int seed, operands;
  localparam int Muls = 19;
  // {AW, BW, ASigned, BSigned (2: unsigned, top bit alone), Clocks}: around the borders of limbs, spare bits of either factor.
  localparam logic [40*Muls-1:0] Mul = {
    8'd1, 8'd1, 8'd0, 8'd0, 8'd2, 8'd5, 8'd7, 8'd1, 8'd0, 8'd3, 8'd17, 8'd17, 8'd0, 8'd0, 8'd3, 8'd18, 8'd18, 8'd1, 8'd1, 8'd2,
    8'd19, 8'd19, 8'd0, 8'd1, 8'd3, 8'd20, 8'd20, 8'd1, 8'd1, 8'd6, 8'd21, 8'd19, 8'd1, 8'd0, 8'd4, 8'd34, 8'd18, 8'd0, 8'd1, 8'd3,
    8'd35, 8'd30, 8'd1, 8'd1, 8'd3, 8'd36, 8'd21, 8'd1, 8'd0, 8'd3, 8'd37, 8'd38, 8'd1, 8'd1, 8'd5, 8'd42, 8'd30, 8'd1, 8'd1, 8'd3,
    8'd44, 8'd21, 8'd1, 8'd2, 8'd4, 8'd43, 8'd20, 8'd1, 8'd2, 8'd3, 8'd20, 8'd19, 8'd0, 8'd2, 8'd2,
    8'd43, 8'd20, 8'd1, 8'd0, 8'd3, 8'd52, 8'd35, 8'd1, 8'd1, 8'd1, 8'd53, 8'd53, 8'd0, 8'd0, 8'd3, 8'd16, 8'd36, 8'd1, 8'd1, 8'd3
  };
  int mul_errors[Muls], mul_checked[Muls];
  for (genvar i = 0; i < Muls; i++) begin : gen_mul
    localparam logic [39:0] P = Mul[40*i+:40];
    mul_pipe_check #(
        .AW(32'(P[39:32])), .BW(32'(P[31:24])), .ASigned(32'(P[23:16])), .BSigned((P[15:8] == 8'd1) ? 1 : 0),
        .BTopAlone((P[15:8] == 8'd2) ? 1 : 0), .Clocks(32'(P[7:0]))
    ) u_check (
        .clk_i(clk), .random_i(random), .errors_o(mul_errors[i]), .checked_o(mul_checked[i])
    );
  end
  localparam int Norms = 12;
  int norm_errors[Norms], norm_checked[Norms];
  for (genvar i = 0; i < Norms; i++) begin : gen_norm
    localparam int Width = (i / 3 == 0) ? 1 : (i / 3 == 1) ? 8 : (i / 3 == 2) ? 27 : 39;
    lzc_norm_check #(
        .Width(Width), .Clocks(1 + i % 3)
    ) u_check (
        .clk_i(clk), .random_i(random), .errors_o(norm_errors[i]), .checked_o(norm_checked[i])
    );
  end
  localparam int Shifts = 6;
  int shift_errors[Shifts], shift_checked[Shifts];
  shift_add_check #(.InW(12), .Base(0), .ShiftMax(0), .CW(6), .KeptW(10)) u_shift0 (
      .clk_i(clk), .random_i(random), .errors_o(shift_errors[0]), .checked_o(shift_checked[0]));
  shift_add_check #(.InW(12), .Base(3), .ShiftMax(9), .CW(6), .KeptW(10)) u_shift1 (
      .clk_i(clk), .random_i(random), .errors_o(shift_errors[1]), .checked_o(shift_checked[1]));
  shift_add_check #(.InW(10), .Base(-5), .ShiftMax(20), .CW(8), .KeptW(14)) u_shift2 (
      .clk_i(clk), .random_i(random), .errors_o(shift_errors[2]), .checked_o(shift_checked[2]));
  shift_add_check #(.InW(50), .Base(4), .ShiftMax(27), .CW(20), .KeptW(24)) u_shift3 (
      .clk_i(clk), .random_i(random), .errors_o(shift_errors[3]), .checked_o(shift_checked[3]));
  shift_add_check #(.InW(9), .Base(12), .ShiftMax(4), .CW(5), .KeptW(20)) u_shift4 (
      .clk_i(clk), .random_i(random), .errors_o(shift_errors[4]), .checked_o(shift_checked[4]));
  shift_add_check #(.InW(60), .Base(0), .ShiftMax(31), .CW(30), .KeptW(40)) u_shift5 (
      .clk_i(clk), .random_i(random), .errors_o(shift_errors[5]), .checked_o(shift_checked[5]));

  int checked, errors;
  initial begin
    if (!$value$plusargs("seed=%d", seed)) seed = 1;
    if (!$value$plusargs("operands=%d", operands)) operands = 4000;
    random = '0;
    for (int t = 0; t < operands; t++) begin
      for (int i = 0; i < 4; i++) random[32*i+:32] = $random(seed);
      // Now and then all ones, a single one, and few bits.
      if (t % 7 == 0) random[63:0] = '1;
      if (t % 11 == 0) random[127:64] = '1;
      if (t % 13 == 0) random[63:0] = 64'd1 << (t % 64);
      if (t % 17 == 0) random[63:0] = {{32{random[31]}}, random[31:0]} >>> (t % 32);
      #1 clk = 1'b1;
      #1 clk = 1'b0;
    end
    checked = 0;
    errors = 0;
    for (int i = 0; i < Muls; i++) begin
      checked = checked + mul_checked[i];
      errors = errors + mul_errors[i];
      if (mul_errors[i] != 0) $display("mul_pipe %0d: %0d errors", i, mul_errors[i]);
    end
    for (int i = 0; i < Norms; i++) begin
      checked = checked + norm_checked[i];
      errors = errors + norm_errors[i];
      if (norm_errors[i] != 0) $display("lzc_norm %0d: %0d errors", i, norm_errors[i]);
    end
    for (int i = 0; i < Shifts; i++) begin
      checked = checked + shift_checked[i];
      errors = errors + shift_errors[i];
      if (shift_errors[i] != 0) $display("shift_add %0d: %0d errors", i, shift_errors[i]);
    end
    $display("checked %0d, errors %0d", checked, errors);
    $finish;
  end
endmodule
