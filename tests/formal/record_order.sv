// SPDX-License-Identifier: Apache-2.0
// What an elastic cell of Capacity records must do, seen from its ports: nothing is lost, doubled, changed or
// overtaken. A reset at any time leaves it empty.
//
// One accepted record is watched at a time: watch_i, which the solver chooses, picks it. Since the solver may pick
// any, what holds for the one that is watched holds for all.
//
//   count_o     records inside
//   watching_o  the watched record is inside, with ahead_o records in front of it; it must deliver watched_o
module record_order #(
    parameter int Width    = 2,
    parameter int Capacity = 2,
    parameter int CountW   = $clog2(Capacity + 1)
) (
    input  logic              clk_i,
    input  logic              rst_ni,
    input  logic              watch_i,
    input  logic              in_valid_i,
    input  logic              in_ready_i,
    input  logic [ Width-1:0] in_i,
    input  logic              out_valid_i,
    input  logic              out_ready_i,
    input  logic [ Width-1:0] out_i,
    output logic [CountW-1:0] count_o,
    output logic              watching_o,
    output logic [CountW-1:0] ahead_o,
    output logic [ Width-1:0] watched_o
);
  logic in, out;
  assign in = in_valid_i && in_ready_i;
  assign out = out_valid_i && out_ready_i;
  logic started_q, waited_q;
  logic [Width-1:0] out_q;
  initial started_q = 1'b0;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    waited_q <= started_q && rst_ni && out_valid_i && !out_ready_i;
    out_q <= out_i;
    if (!rst_ni) begin
      count_o <= '0;
      watching_o <= 1'b0;
    end else begin
      count_o <= count_o + CountW'(in) - CountW'(out);
      if (watching_o) begin
        ahead_o <= ahead_o - CountW'(out);
        watching_o <= !(out && ahead_o == '0);
      end else begin
        watching_o <= in && watch_i;
        ahead_o <= count_o - CountW'(out);
        watched_o <= in_i;
      end
    end
  end

  always_comb begin
    assume (started_q || !rst_ni);
    if (started_q && rst_ni) begin
      // Nothing comes that was not accepted, and what was accepted comes.
      assert (out_valid_i == (count_o != '0));
      assert (in_ready_i == (count_o != CountW'(Capacity)));
      assert (count_o <= CountW'(Capacity));
      if (waited_q) assert (out_valid_i && out_i == out_q);
      if (watching_o) begin
        assert (ahead_o < count_o);
        if (ahead_o == '0) assert (out_i == watched_o);
      end
    end
  end
endmodule
