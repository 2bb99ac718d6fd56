// SPDX-License-Identifier: Apache-2.0
// rtl/skid.sv: record_order.
module skid_proof #(
    parameter int Width = 2
) (
    input logic             clk_i,
    input logic             rst_ni,
    input logic             watch_i,
    input logic             in_valid_i,
    input logic [Width-1:0] in_i,
    input logic             out_ready_i
);
  logic in_ready, out_valid;
  logic [Width-1:0] out;
  skid #(
      .Width(Width)
  ) u_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o(in_ready),
      .in_i,
      .out_valid_o(out_valid),
      .out_ready_i,
      .out_o(out)
  );
  logic watching;
  logic [1:0] count, ahead;
  logic [Width-1:0] watched;
  record_order #(
      .Width(Width),
      .Capacity(2)
  ) u_order (
      .clk_i,
      .rst_ni,
      .watch_i,
      .in_valid_i,
      .in_ready_i(in_ready),
      .in_i,
      .out_valid_i(out_valid),
      .out_ready_i,
      .out_i(out),
      .count_o(count),
      .watching_o(watching),
      .ahead_o(ahead),
      .watched_o(watched)
  );
  // For induction: where a second record stands.
  (* hierconn *) logic [Width-1:0] \u_skid.spare_q ;
  always_comb begin
    if (rst_ni && watching && ahead == 2'd1) assert (\u_skid.spare_q == watched);
  end
endmodule
