// SPDX-License-Identifier: Apache-2.0
// rtl/restoring_core.sv and restoring_step.sv: after each step the remainder is below the divisor, and numerator bits
// left, remainder and quotient so far still make the numerator. So at the end n = q d + r with r < d.
//
// Operands come on any clocks that the unit's contract allows, and en_i may fall at any time.
module restoring_core_proof #(
    parameter int DW           = 3,
    parameter int Iterations   = 3,
    parameter int BitsPerCycle = 1,
    parameter int Pipelined    = 1
) (
    input logic                               clk_i,
    input logic                               rst_ni,
    input logic                               en_i,
    input logic                               start_i,
    input logic [                     DW-1:0] rem_i,
    input logic [Iterations*BitsPerCycle-1:0] num_i,
    input logic [                     DW-1:0] d_i
);
  localparam int Bits = Iterations * BitsPerCycle;
  localparam int Latency = (Pipelined != 0) ? Iterations : BitsPerCycle * (Iterations + 1);
  localparam int NW = DW + Bits;
  logic [Bits-1:0] q;
  logic sticky;
  restoring_core #(
      .DW(DW),
      .Iterations(Iterations),
      .BitsPerCycle(BitsPerCycle),
      .Pipelined(Pipelined)
  ) u_core (
      .clk_i,
      .rst_ni,
      .en_i,
      .start_i,
      .rem_i,
      .num_i,
      .d_i,
      .q_o(q),
      .sticky_o(sticky)
  );

  // Enabled clocks since a start: bit k after k + 1 of them, with the operands of that start.
  logic started_q;
  logic [Latency-1:0] age_q;
  logic [Latency*NW-1:0] n_q;
  logic [Latency*DW-1:0] d_q;
  initial started_q = 1'b0;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    if (!rst_ni) begin
      age_q <= '0;
    end else if (en_i) begin
      age_q <= Latency'({age_q, start_i});
    end
    if (en_i) begin
      n_q <= (Latency*NW)'({n_q, rem_i, num_i});
      d_q <= (Latency*DW)'({d_q, d_i});
    end
  end
  always_comb begin
    assume (started_q || !rst_ni);
    assume (rem_i < d_i);
    // A unit that is not pipelined takes operands once per Iterations + 1 enabled clocks.
    assume (Pipelined != 0 || !start_i || (age_q & Latency'((1 << Iterations) - 1)) == '0);
  end

  // {remainder, numerator bits left, quotient} after `made` bits.
  function automatic logic holds(input logic [NW-1:0] state, input logic [DW-1:0] d, input logic [NW-1:0] n,
                                 input int made);
    logic [2*NW-1:0] rem, quotient, left;
    rem = (2 * NW)'(state >> Bits);
    left = (2 * NW)'(state & NW'((1 << Bits) - 1)) >> made;
    quotient = (2 * NW)'(state & NW'((1 << made) - 1));
    holds = rem < (2 * NW)'(d) && ((quotient * (2 * NW)'(d) + rem) << (Bits - made)) + left == (2 * NW)'(n);
  endfunction

  // At the end, from the ports alone.
  logic [NW-1:0] n_end, below;
  assign n_end = n_q[(Latency-1)*NW+:NW];
  assign below = n_end - NW'(q) * NW'(d_q[(Latency-1)*DW+:DW]);
  always_comb begin
    if (started_q && rst_ni && age_q[Latency-1]) begin
      assert (below < NW'(d_q[(Latency-1)*DW+:DW]));
      assert (sticky == (below != '0));
    end
  end

  // For induction: the state of each stage or unit, up to four of them. Those that this core does not have are free.
  (* hierconn *) logic [NW-1:0] \u_core.gen_pipelined.gen_stage[0].state_q ;
  (* hierconn *) logic [DW-1:0] \u_core.gen_pipelined.gen_stage[0].d_q ;
  (* hierconn *) logic [NW-1:0] \u_core.gen_pipelined.gen_stage[1].state_q ;
  (* hierconn *) logic [DW-1:0] \u_core.gen_pipelined.gen_stage[1].d_q ;
  (* hierconn *) logic [NW-1:0] \u_core.gen_pipelined.gen_stage[2].state_q ;
  (* hierconn *) logic [DW-1:0] \u_core.gen_pipelined.gen_stage[2].d_q ;
  (* hierconn *) logic [NW-1:0] \u_core.gen_pipelined.gen_stage[3].state_q ;
  (* hierconn *) logic [DW-1:0] \u_core.gen_pipelined.gen_stage[3].d_q ;
  (* hierconn *) logic [NW-1:0] \u_core.gen_iterative.gen_unit[0].state_q ;
  (* hierconn *) logic [DW-1:0] \u_core.gen_iterative.gen_unit[0].d_q ;
  (* hierconn *) logic [Iterations:0] \u_core.gen_iterative.gen_unit[0].started_q ;
  (* hierconn *) logic [NW-1:0] \u_core.gen_iterative.gen_unit[1].state_q ;
  (* hierconn *) logic [DW-1:0] \u_core.gen_iterative.gen_unit[1].d_q ;
  (* hierconn *) logic [Iterations:0] \u_core.gen_iterative.gen_unit[1].started_q ;
  if (Pipelined != 0) begin : gen_pipelined
    logic [4*NW-1:0] states;
    logic [4*DW-1:0] divisors;
    assign states = {
      \u_core.gen_pipelined.gen_stage[3].state_q ,
      \u_core.gen_pipelined.gen_stage[2].state_q ,
      \u_core.gen_pipelined.gen_stage[1].state_q ,
      \u_core.gen_pipelined.gen_stage[0].state_q 
    };
    assign divisors = {
      \u_core.gen_pipelined.gen_stage[3].d_q ,
      \u_core.gen_pipelined.gen_stage[2].d_q ,
      \u_core.gen_pipelined.gen_stage[1].d_q ,
      \u_core.gen_pipelined.gen_stage[0].d_q 
    };
    for (genvar k = 0; k < Iterations; k++) begin : gen_stage
      always_comb begin
        if (started_q && rst_ni && age_q[k]) begin
          assert (divisors[k*DW+:DW] == d_q[k*DW+:DW]);
          assert (holds(states[k*NW+:NW], d_q[k*DW+:DW], n_q[k*NW+:NW], (k + 1) * BitsPerCycle));
        end
      end
    end
  end else begin : gen_iterative
    logic [2*NW-1:0] states;
    logic [2*DW-1:0] divisors;
    logic [2*(Iterations+1)-1:0] started;
    assign states = {
      \u_core.gen_iterative.gen_unit[1].state_q ,
      \u_core.gen_iterative.gen_unit[0].state_q 
    };
    assign divisors = {
      \u_core.gen_iterative.gen_unit[1].d_q ,
      \u_core.gen_iterative.gen_unit[0].d_q 
    };
    assign started = {
      \u_core.gen_iterative.gen_unit[1].started_q ,
      \u_core.gen_iterative.gen_unit[0].started_q 
    };
    // A result stays until the last unit takes over the next operands.
    localparam int Last = Latency - Iterations - 1;
    logic takes, kept_q;
    logic [NW-1:0] result, result_q;
    assign result = {sticky, q};
    if (Last == 0) begin : gen_first
      assign takes = en_i && start_i;
    end else begin : gen_later
      assign takes = en_i && age_q[Last-1];
    end
    always_ff @(posedge clk_i) begin
      kept_q <= rst_ni && started_q && (kept_q || age_q[Latency-1]) && !takes;
      result_q <= result;
    end
    always_comb begin
      if (started_q && rst_ni && kept_q) begin
        assert (age_q[Last+:Iterations] == '0);
        assert (result == result_q);
      end
    end
    for (genvar k = 0; k < Latency; k++) begin : gen_clock
      localparam int Unit = k / (Iterations + 1);
      always_comb begin
        if (started_q && rst_ni) assert (started[k] == age_q[k]);
        if (started_q && rst_ni && age_q[k]) begin
          assert (((age_q >> (k + 1)) & Latency'((1 << Iterations) - 1)) == '0);
          assert (divisors[Unit*DW+:DW] == d_q[k*DW+:DW]);
          assert (holds(states[Unit*NW+:NW], d_q[k*DW+:DW], n_q[k*NW+:NW], k - Unit));
        end
      end
    end
  end
endmodule
