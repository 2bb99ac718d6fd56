// SPDX-License-Identifier: Apache-2.0
// rtl/fifo.sv: record_order, for 1 to 8 entries.
module fifo_proof #(
    parameter int Width = 2,
    parameter int Depth = 2
) (
    input logic             clk_i,
    input logic             rst_ni,
    input logic             watch_i,
    input logic             in_valid_i,
    input logic [Width-1:0] in_i,
    input logic             out_ready_i
);
  localparam int CountW = $clog2(Depth + 1);
  localparam int PlaceW = (Depth > 1) ? $clog2(Depth) : 1;
  logic in_ready, out_valid;
  logic [Width-1:0] out;
  fifo #(
      .Width(Width),
      .Depth(Depth)
  ) u_fifo (
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
  logic [CountW-1:0] count, ahead;
  logic [Width-1:0] watched;
  record_order #(
      .Width(Width),
      .Capacity(Depth)
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

  // For induction: the memory's words, and where the watched record stands. Words that a FIFO of this depth does not
  // have are free.
  (* hierconn *) logic [CountW-1:0] \u_fifo.gen_memory.count_q ;
  (* hierconn *) logic [PlaceW-1:0] \u_fifo.gen_memory.write_q ;
  (* hierconn *) logic [PlaceW-1:0] \u_fifo.gen_memory.read_q ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[0] ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[1] ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[2] ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[3] ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[4] ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[5] ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[6] ;
  (* hierconn *) logic [Width-1:0] \u_fifo.gen_memory.memory[7] ;
  logic [3:0] write, place;
  // The place `distance` entries after `from`.
  function automatic logic [3:0] after(input logic [3:0] from, input logic [3:0] distance);
    after = (from + distance >= 4'(Depth)) ? from + distance - 4'(Depth) : from + distance;
  endfunction
  assign write = after(4'(\u_fifo.gen_memory.read_q ), 4'(count));
  assign place = after(4'(\u_fifo.gen_memory.read_q ), 4'(ahead));
  if (Depth > 1) begin : gen_memory
    always_comb begin
      if (rst_ni && count <= CountW'(Depth)) begin
        assert (\u_fifo.gen_memory.count_q == count);
        assert (4'(\u_fifo.gen_memory.read_q ) < 4'(Depth));
        assert (4'(\u_fifo.gen_memory.write_q ) == write);
        if (watching) assert (\u_fifo.gen_memory.memory[0]  == watched || place != 4'd0);
        if (watching) assert (\u_fifo.gen_memory.memory[1]  == watched || place != 4'd1);
        if (watching) assert (\u_fifo.gen_memory.memory[2]  == watched || place != 4'd2);
        if (watching) assert (\u_fifo.gen_memory.memory[3]  == watched || place != 4'd3);
        if (watching) assert (\u_fifo.gen_memory.memory[4]  == watched || place != 4'd4);
        if (watching) assert (\u_fifo.gen_memory.memory[5]  == watched || place != 4'd5);
        if (watching) assert (\u_fifo.gen_memory.memory[6]  == watched || place != 4'd6);
        if (watching) assert (\u_fifo.gen_memory.memory[7]  == watched || place != 4'd7);
      end
    end
  end
endmodule
