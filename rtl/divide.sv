// SPDX-License-Identifier: Apache-2.0
// Signed quotient n / d, d > 0, by restoring division, for the slope form `divide`.
//
//   q_o       floor of the quotient with n extended by Iterations * BitsPerCycle - NW zero bits on the right
//   sticky_o  the quotient lies strictly above q_o
//
// Latency: one enabled clock more than restoring_core's. Pipelined and start_i are as there; the operands are read on the
// clock of start_i alone.
module divide #(
    parameter int NW           = 8,
    parameter int DW           = 8,
    parameter int Iterations   = 8,
    parameter int BitsPerCycle = 1,
    parameter int Pipelined    = 1
) (
    input  logic                                    clk_i,
    input  logic                                    rst_ni,
    input  logic                                    en_i,
    input  logic                                    start_i,
    input  logic signed [                   NW-1:0] n_i,
    input  logic        [                   DW-1:0] d_i,
    output logic signed [Iterations*BitsPerCycle:0] q_o,
    output logic                                    sticky_o
);
  localparam int Bits = Iterations * BitsPerCycle;

  // Magnitude and sign.
  logic [NW-1:0] magnitude_q;
  logic [DW-1:0] d_q;
  logic negative_q, start_q;
  always_ff @(posedge clk_i) begin
    if (en_i && (Pipelined != 0 || start_i)) begin
      magnitude_q <= n_i[NW-1] ? -n_i : n_i;
      negative_q <= n_i[NW-1];
      d_q <= d_i;
    end
  end
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) start_q <= 1'b0;
    else if (en_i) start_q <= start_i;
  end

  logic [Bits-1:0] numerator, quotient;
  logic sticky, negative;
  assign numerator = Bits'(magnitude_q) << (Bits - NW);
  restoring_core #(
      .DW(DW),
      .Iterations(Iterations),
      .BitsPerCycle(BitsPerCycle),
      .Pipelined(Pipelined)
  ) u_core (
      .clk_i,
      .rst_ni,
      .en_i,
      .start_i (start_q),
      .rem_i   ({DW{1'b0}}),
      .num_i   (numerator),
      .d_i     (d_q),
      .q_o     (quotient),
      .sticky_o(sticky)
  );
  if (Pipelined != 0) begin : gen_sign_line
    delay_line #(
        .Width(1),
        .Depth(Iterations)
    ) u_negative (
        .clk_i,
        .en_i,
        .d_i(negative_q),
        .q_o(negative)
    );
  end else begin : gen_sign_held
    // Beside the units of restoring_core: each passes its sign on when it has made its bits.
    logic [BitsPerCycle:0] held;
    logic [BitsPerCycle*(Iterations+1)-1:0] started_q;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) started_q <= '0;
      else if (en_i) started_q <= (BitsPerCycle * (Iterations + 1))'({started_q, start_q});
    end
    assign held[0] = negative_q;
    for (genvar i = 0; i < BitsPerCycle; i++) begin : gen_unit
      logic take, held_q;
      if (i == 0) begin : gen_first
        assign take = start_q;
      end else begin : gen_next
        assign take = started_q[i*(Iterations+1)-1];
      end
      always_ff @(posedge clk_i) begin
        if (en_i && take) held_q <= held[i];
      end
      assign held[i+1] = held_q;
    end
    logic unused;
    assign unused = ^started_q;
    assign negative = held[BitsPerCycle];
  end

  // floor(-(q + fraction)) = -q - 1 = ~q where there is a fraction.
  assign q_o = !negative ? {1'b0, quotient} : sticky ? ~{1'b0, quotient} : -{1'b0, quotient};
  assign sticky_o = sticky;

`ifndef SYNTHESIS
  initial begin
    assert (Bits >= NW)
    else $fatal(1, "divide: %0d quotient bits for a numerator of %0d", Bits, NW);
  end
`endif
endmodule
