// SPDX-License-Identifier: Apache-2.0
// p_o = a_i b_i, Clocks >= 1 enabled clocks later. Either factor may be signed; the product is exact in AW + BW bits.
//
// A factor is cut into limbs of 17 bits, of which a signed 18 x 18 multiplier takes two. What is left above the last
// limb, at most 3 bits and a top bit that stands alone, adds the other factor where its bits are set instead of taking
// multipliers.
//
//   Clocks 1  | product                              |
//   Clocks 2  | partial products | their sum         |
//   Clocks 3  | partial products | rows | their sum  |    a row: one limb of b times all of a
//   Clocks 4  | the factors, so that they may come from afar | as 3
//   Clocks 5  | the factors, a register per multiplier | partial products | the same, so that they may go afar | rows | sum
//   Clocks 6+ | as 5, and the product waits for the clocks that are left
module mul_pipe #(
    parameter int AW      = 18,
    parameter int BW      = 18,
    parameter int ASigned = 1,
    parameter int BSigned = 1,
    // b's top bit is set in one value alone, in which no other bit is.
    parameter int BTopAlone = 0,
    // b_i is a_i: of two partial products that are the same, one is formed.
    parameter int Same = 0,
    parameter int Clocks  = 3
) (
    input  logic             clk_i,
    input  logic             en_i,
    input  logic [   AW-1:0] a_i,
    input  logic [   BW-1:0] b_i,
    output logic [AW+BW-1:0] p_o
);
  localparam int Limb = 17;
  localparam int PW = AW + BW;
  if (Clocks == 1) begin : gen_one_clock
    logic signed [AW:0] a;
    logic signed [BW:0] b;
    assign a = $signed({(ASigned != 0) & a_i[AW-1], a_i});
    assign b = $signed({(BSigned != 0) & b_i[BW-1], b_i});
    always_ff @(posedge clk_i) begin
      if (en_i) p_o <= PW'(a) * PW'(b);
    end
  end else begin : gen_limbs
    // Bits in front of the sign, limbs that take multipliers, and the bits above them.
    localparam int AMagnitude = (ASigned != 0) ? AW - 1 : AW;
    localparam int BMagnitude = (BSigned != 0) ? BW - 1 : BW;
    localparam int ASpare = (AMagnitude > Limb && AMagnitude % Limb > 0 && AMagnitude % Limb + ASigned <= 3) ?
                            AMagnitude % Limb : 0;
    localparam int BSpare = (BMagnitude > Limb && BMagnitude % Limb > 0 && BMagnitude % Limb + BSigned - BTopAlone <= 3) ?
                            BMagnitude % Limb : 0;
    localparam int ALimbs = (AMagnitude - ASpare <= Limb) ? 1 : (AMagnitude - ASpare + Limb - 1) / Limb;
    localparam int BLimbs = (BMagnitude - BSpare <= Limb) ? 1 : (BMagnitude - BSpare + Limb - 1) / Limb;
    // The lower part of a factor is unsigned where bits stand above it.
    localparam int ALowW = (ASpare > 0) ? ALimbs * Limb : AW;
    localparam int BLowW = (BSpare > 0) ? BLimbs * Limb : BW;
    localparam int ALowSigned = (ASpare > 0) ? 0 : ASigned;
    localparam int BLowSigned = (BSpare > 0) ? 0 : BSigned;
    localparam int PartW = 2 * Limb + 2;
    logic [AW-1:0] a_in;
    logic [BW-1:0] b_in;
    delay_line #(
        .Width(AW + BW),
        .Depth(Clocks > 3 ? 1 : 0)
    ) u_factors (
        .clk_i,
        .en_i,
        .d_i({a_i, b_i}),
        .q_o({a_in, b_in})
    );
    // From 5 clocks on, what is above the limbs has these registers, and only that.
    logic unused_factors;
    assign unused_factors = ^{a_in, b_in};

    // Partial products.
    logic signed [PartW-1:0] part_q[ALimbs*BLimbs];
    for (genvar i = 0; i < ALimbs; i++) begin : gen_a
      localparam int LimbAW = (i == ALimbs - 1) ? ALowW - i * Limb : Limb;
      for (genvar j = 0; j < BLimbs; j++) begin : gen_b
        localparam int LimbBW = (j == BLimbs - 1) ? BLowW - j * Limb : Limb;
        logic [LimbAW-1:0] limb_a;
        logic [LimbBW-1:0] limb_b;
        logic signed [Limb:0] a, b;
        if (Same != 0 && i < j) begin : gen_same
          assign limb_a = '0;
          assign limb_b = '0;
        end else if (Clocks > 4) begin : gen_own
          // Registers of its own, which synthesis must not join with its neighbours': a multiplier may lie far from those.
          (* keep *)
          always_ff @(posedge clk_i) begin
            if (en_i) begin
              limb_a <= a_i[i*Limb+:LimbAW];
              limb_b <= b_i[j*Limb+:LimbBW];
            end
          end
        end else begin : gen_shared
          assign limb_a = a_in[i*Limb+:LimbAW];
          assign limb_b = b_in[j*Limb+:LimbBW];
        end
        assign a = (Limb + 1)'($signed({(i == ALimbs - 1 && ALowSigned != 0) & limb_a[LimbAW-1], limb_a}));
        assign b = (Limb + 1)'($signed({(j == BLimbs - 1 && BLowSigned != 0) & limb_b[LimbBW-1], limb_b}));
        always_ff @(posedge clk_i) begin
          if (en_i) part_q[i*BLimbs+j] <= a * b;
        end
      end
    end
    // The same, a clock later from 5 clocks on.
    localparam int PartWait = Clocks > 4 ? 1 : 0;
    logic signed [PartW-1:0] part[ALimbs*BLimbs];
    for (genvar k = 0; k < ALimbs * BLimbs; k++) begin : gen_part
      logic [PartW-1:0] late;
      delay_line #(
          .Width(PartW),
          .Depth(PartWait)
      ) u_part (
          .clk_i,
          .en_i,
          .d_i(part_q[k]),
          .q_o(late)
      );
      assign part[k] = $signed(late);
    end
    // The bits above a's limbs times all of b, and those above b's limbs times the lower part of a. The first two bits
    // of each have a register of their own, so that no clock adds twice.
    logic signed [PW-1:0] first_a_q, rest_a_q, first_b_q, rest_b_q;
    if (ASpare > 0) begin : gen_above_a
      localparam int TopW = AW - ALowW;
      logic signed [PW-1:0] b, first, rest;
      assign b = PW'($signed({(BSigned != 0) & b_in[BW-1], b_in}));
      always_comb begin
        first = '0;
        rest = '0;
        for (int k = 0; k < TopW; k++) begin
          if (a_in[ALowW+k]) begin
            if (ASigned != 0 && k == TopW - 1 && k < 2) first = first - (b <<< k);
            else if (ASigned != 0 && k == TopW - 1) rest = rest - (b <<< k);
            else if (k < 2) first = first + (b <<< k);
            else rest = rest + (b <<< k);
          end
        end
      end
      always_ff @(posedge clk_i) begin
        if (en_i) first_a_q <= first <<< ALowW;
      end
      if (TopW > 2) begin : gen_rest
        always_ff @(posedge clk_i) begin
          if (en_i) rest_a_q <= rest <<< ALowW;
        end
      end else begin : gen_no_rest
        assign rest_a_q = '0;
        logic unused;
        assign unused = ^rest;
      end
    end else begin : gen_no_above_a
      assign first_a_q = '0;
      assign rest_a_q = '0;
    end
    if (BSpare > 0) begin : gen_above_b
      localparam int TopW = BW - BLowW;
      // Without the top bit where it stands alone: it is in `first` then.
      localparam int Rest = (BTopAlone != 0 && TopW == 3) ? 0 : TopW - 2;
      logic signed [PW-1:0] a, first, rest;
      assign a = PW'($signed({(ALowSigned != 0) & a_in[ALowW-1], a_in[ALowW-1:0]}));
      always_comb begin
        first = '0;
        rest = '0;
        for (int k = 0; k < TopW; k++) begin
          // Where it stands alone, all else is 0.
          if (BTopAlone != 0 && k == TopW - 1) begin
            if (Rest > 0) rest = rest | ((a <<< k) & {PW{b_in[BLowW+k]}});
            else first = first | ((a <<< k) & {PW{b_in[BLowW+k]}});
          end else if (b_in[BLowW+k]) begin
            if (BSigned != 0 && k == TopW - 1 && k < 2) first = first - (a <<< k);
            else if (BSigned != 0 && k == TopW - 1) rest = rest - (a <<< k);
            else if (k < 2) first = first + (a <<< k);
            else rest = rest + (a <<< k);
          end
        end
      end
      always_ff @(posedge clk_i) begin
        if (en_i) first_b_q <= first <<< BLowW;
      end
      if (Rest > 0) begin : gen_rest
        always_ff @(posedge clk_i) begin
          if (en_i) rest_b_q <= rest <<< BLowW;
        end
      end else begin : gen_no_rest
        assign rest_b_q = '0;
        logic unused;
        assign unused = ^rest;
      end
    end else begin : gen_no_above_b
      assign first_b_q = '0;
      assign rest_b_q = '0;
    end

    // Rows, one per limb of b; the bits above the limbs are a row, too.
    logic signed [PW-1:0] row[BLimbs+1];
    for (genvar j = 0; j < BLimbs; j++) begin : gen_row
      // Icarus 11 takes no procedural assignment to one element of an array that has another driver.
      logic signed [PW-1:0] sum;
      always_comb begin
        sum = '0;
        for (int i = 0; i < ALimbs; i++) begin
          sum = sum + (PW'(part[(Same != 0 && i < j) ? j*BLimbs+i : i*BLimbs+j]) <<< (Limb * (i + j)));
        end
      end
      assign row[j] = sum;
    end
    logic signed [PW-1:0] above;
    delay_line #(
        .Width(PW),
        .Depth(PartWait)
    ) u_above (
        .clk_i,
        .en_i,
        .d_i(first_a_q + rest_a_q + first_b_q + rest_b_q),
        .q_o(above)
    );
    assign row[BLimbs] = above;
    logic signed [PW-1:0] term[BLimbs+1];
    if (Clocks >= 3) begin : gen_row_registers
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          for (int j = 0; j <= BLimbs; j++) term[j] <= row[j];
        end
      end
    end else begin : gen_row_wires
      for (genvar j = 0; j <= BLimbs; j++) begin : gen_term
        assign term[j] = row[j];
      end
    end

    logic signed [PW-1:0] total, total_q;
    always_comb begin
      total = '0;
      for (int j = 0; j <= BLimbs; j++) total = total + term[j];
    end
    always_ff @(posedge clk_i) begin
      if (en_i) total_q <= total;
    end
    delay_line #(
        .Width(PW),
        .Depth(Clocks > 5 ? Clocks - 5 : 0)
    ) u_wait (
        .clk_i,
        .en_i,
        .d_i(total_q),
        .q_o(p_o)
    );
  end

`ifndef SYNTHESIS
  initial begin
    assert (AW >= 1 && BW >= 1 && Clocks >= 1)
    else $fatal(1, "mul_pipe: widths and Clocks must be positive");
  end
`endif
endmodule
