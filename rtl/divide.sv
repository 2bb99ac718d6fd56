// SPDX-License-Identifier: Apache-2.0
// Signed quotient n / d, d > 0, by restoring division, for the slope form `divide`.
//
//   q_o       floor of the quotient with n extended by Iterations * BitsPerCycle - NW zero bits on the right
//   sticky_o  the quotient lies strictly above q_o
//
// Latency: 1 + Iterations enabled clocks. Pipelined and start_i are as in restoring_core.
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
    if (en_i) begin
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
      .en_i,
      .start_i (start_q),
      .rem_i   ({DW{1'b0}}),
      .num_i   (numerator),
      .d_i     (d_q),
      .q_o     (quotient),
      .sticky_o(sticky)
  );
  delay_line #(
      .Width(1),
      .Depth(Pipelined != 0 ? Iterations : 0)
  ) u_negative (
      .clk_i,
      .en_i,
      .d_i(negative_q),
      .q_o(negative)
  );

  // floor(-(q + fraction)) = -q - 1 = ~q where there is a fraction.
  assign q_o = !negative ? {1'b0, quotient} : sticky ? ~{1'b0, quotient} : -{1'b0, quotient};
  assign sticky_o = sticky;

`ifndef SYNTHESIS
  initial begin
    assert (Bits >= NW)
    else $error("divide: %0d quotient bits for a numerator of %0d", Bits, NW);
  end
`endif
endmodule
