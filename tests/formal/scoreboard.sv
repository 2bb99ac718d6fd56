// SPDX-License-Identifier: Apache-2.0
// rtl/scoreboard.sv: no two fragments of one place are between memory's read and its write at once.
//
// The solver picks a place, which is watched. Its fragment leaves at any time, by either way, with the mark that it
// brought along; at other places anything may leave at any time.
module scoreboard_proof #(
    parameter int PlaceW = 1
) (
    input logic              clk_i,
    input logic              rst_ni,
    input logic              in_valid_i,
    input logic [PlaceW-1:0] in_x_i,
    input logic [PlaceW-1:0] in_y_i,
    input logic              out_ready_i,
    input logic              leave_a_i,
    input logic [PlaceW-1:0] leave_a_x_i,
    input logic [PlaceW-1:0] leave_a_y_i,
    input logic              leave_a_mark_i,
    input logic              leave_b_i,
    input logic [PlaceW-1:0] leave_b_x_i,
    input logic [PlaceW-1:0] leave_b_y_i,
    input logic              leave_b_mark_i
);
  localparam int Places = 1 << PlaceW;
  (* anyconst *)logic [PlaceW-1:0] watched;
  logic in_ready, out_valid, out, mark_a, mark_b;
  logic [PlaceW-1:0] out_x, out_y;
  scoreboard #(
      .Width(1),
      .CoordW(PlaceW),
      .PlaceW(PlaceW),
      .TwoWays(1)
  ) u_board (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o(in_ready),
      .in_x_i,
      .in_y_i,
      .in_i(1'b0),
      .out_valid_o(out_valid),
      .out_ready_i,
      .out_x_o(out_x),
      .out_y_o(out_y),
      .out_o(out),
      .mark_a_o(mark_a),
      .mark_b_o(mark_b),
      .leave_a_i,
      .leave_a_x_i,
      .leave_a_y_i,
      .leave_a_mark_i,
      .leave_b_i,
      .leave_b_x_i,
      .leave_b_y_i,
      .leave_b_mark_i
  );
  function automatic logic [PlaceW-1:0] place_of(input logic [PlaceW-1:0] x, input logic [PlaceW-1:0] y);
    for (int i = 0; i < PlaceW; i++) place_of[i] = x[i] ^ y[PlaceW-1-i];
  endfunction

  logic started_q, inside_q, mark_a_q, mark_b_q, enters, leaves_a, leaves_b;
  assign enters = out_valid && out_ready_i && place_of(out_x, out_y) == watched;
  assign leaves_a = leave_a_i && place_of(leave_a_x_i, leave_a_y_i) == watched;
  assign leaves_b = leave_b_i && place_of(leave_b_x_i, leave_b_y_i) == watched;
  initial started_q = 1'b0;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    inside_q <= rst_ni && (enters || (inside_q && !leaves_a && !leaves_b));
    if (enters) {mark_a_q, mark_b_q} <= {mark_a, mark_b};
  end
  always_comb begin
    assume (started_q || !rst_ni);
    if (rst_ni && started_q) begin
      assume (!(leaves_a && leaves_b));
      assume (!leaves_a || (inside_q && leave_a_mark_i == mark_a_q));
      assume (!leaves_b || (inside_q && leave_b_mark_i == mark_b_q));
      assert (!(enters && inside_q));
    end
  end

  // For induction: what the memories say of the watched place, up to four places, and what each fragment on its way
  // knows of it. Words that a scoreboard of two places does not have are free.
  localparam int RecordW = 3 * PlaceW + 1;
  (* hierconn *) logic \u_board.entered_bits[0] ;
  (* hierconn *) logic \u_board.entered_bits[1] ;
  (* hierconn *) logic \u_board.entered_bits[2] ;
  (* hierconn *) logic \u_board.entered_bits[3] ;
  (* hierconn *) logic \u_board.left_a_bits[0] ;
  (* hierconn *) logic \u_board.left_a_bits[1] ;
  (* hierconn *) logic \u_board.left_a_bits[2] ;
  (* hierconn *) logic \u_board.left_a_bits[3] ;
  (* hierconn *) logic \u_board.gen_b.left_b_bits[0] ;
  (* hierconn *) logic \u_board.gen_b.left_b_bits[1] ;
  (* hierconn *) logic \u_board.gen_b.left_b_bits[2] ;
  (* hierconn *) logic \u_board.gen_b.left_b_bits[3] ;
  (* hierconn *) logic \u_board.swept_q ;
  (* hierconn *) logic \u_board.looked_valid_q ;
  (* hierconn *) logic \u_board.known_valid_q ;
  (* hierconn *) logic \u_board.held_valid_q ;
  (* hierconn *) logic \u_board.free_q ;
  (* hierconn *) logic \u_board.entered_q ;
  (* hierconn *) logic \u_board.left_a_q ;
  (* hierconn *) logic \u_board.left_b_q ;
  (* hierconn *) logic \u_board.entered_since_q ;
  (* hierconn *) logic \u_board.left_a_since_q ;
  (* hierconn *) logic \u_board.left_b_since_q ;
  (* hierconn *) logic \u_board.entered_known_q ;
  (* hierconn *) logic \u_board.left_a_known_q ;
  (* hierconn *) logic \u_board.left_b_known_q ;
  (* hierconn *) logic [PlaceW-1:0] \u_board.sweep_q ;
  (* hierconn *) logic [PlaceW-1:0] \u_board.looked_place_q ;
  (* hierconn *) logic [PlaceW-1:0] \u_board.known_place_q ;
  (* hierconn *) logic [PlaceW-1:0] \u_board.place_q ;
  (* hierconn *) logic [2*PlaceW:0] \u_board.looked_q ;
  (* hierconn *) logic [2*PlaceW:0] \u_board.known_q ;
  (* hierconn *) logic \u_board.u_in.in_ready_o ;
  (* hierconn *) logic \u_board.u_in.out_valid_o ;
  (* hierconn *) logic [RecordW-1:0] \u_board.u_in.out_o ;
  (* hierconn *) logic [RecordW-1:0] \u_board.u_in.spare_q ;
  logic [3:0] entered_bits, left_a_bits, left_b_bits;
  assign entered_bits = {
    \u_board.entered_bits[3] ,
    \u_board.entered_bits[2] ,
    \u_board.entered_bits[1] ,
    \u_board.entered_bits[0] 
  };
  assign left_a_bits = {
    \u_board.left_a_bits[3] ,
    \u_board.left_a_bits[2] ,
    \u_board.left_a_bits[1] ,
    \u_board.left_a_bits[0] 
  };
  assign left_b_bits = {
    \u_board.gen_b.left_b_bits[3] ,
    \u_board.gen_b.left_b_bits[2] ,
    \u_board.gen_b.left_b_bits[1] ,
    \u_board.gen_b.left_b_bits[0] 
  };
  logic entered, left_a, left_b;
  assign entered = entered_bits[watched];
  assign left_a = left_a_bits[watched];
  assign left_b = left_b_bits[watched];
  // A record {place, x, y, 1 bit} whose place is that of x and y.
  function automatic logic placed(input logic [RecordW-1:0] record);
    placed = PlaceW'(record >> (2 * PlaceW + 1)) == place_of(PlaceW'(record >> (PlaceW + 1)), PlaceW'(record >> 1));
  endfunction
  always_comb begin
    if (rst_ni && started_q) begin
      if (!\u_board.swept_q ) begin
        assert (!inside_q);
        assert (!\u_board.looked_valid_q && !\u_board.known_valid_q && !\u_board.held_valid_q );
        if (watched < \u_board.sweep_q ) assert (!entered && !left_a && !left_b);
      end else begin
        assert (inside_q == (entered ^ left_a ^ left_b));
        if (inside_q) assert (mark_a_q == !left_a && mark_b_q == !left_b);
      end
      if (\u_board.looked_valid_q && \u_board.looked_place_q == watched) begin
        assert (entered == (\u_board.entered_q ^ \u_board.entered_since_q ));
        assert (left_a == (\u_board.left_a_q ^ \u_board.left_a_since_q ));
        assert (left_b == (\u_board.left_b_q ^ \u_board.left_b_since_q ));
      end
      if (\u_board.known_valid_q && \u_board.known_place_q == watched) begin
        assert (entered == \u_board.entered_known_q );
        assert (left_a == \u_board.left_a_known_q );
        assert (left_b == \u_board.left_b_known_q );
      end
      if (\u_board.held_valid_q && \u_board.place_q == watched) begin
        assert (mark_a == !left_a && mark_b == !left_b);
        assert (\u_board.free_q == !inside_q);
      end
      if (\u_board.u_in.out_valid_o ) assert (placed(\u_board.u_in.out_o ));
      if (!\u_board.u_in.in_ready_o ) assert (\u_board.u_in.out_valid_o && placed(\u_board.u_in.spare_q ));
      if (\u_board.looked_valid_q ) assert (placed({\u_board.looked_place_q , \u_board.looked_q }));
      if (\u_board.known_valid_q ) assert (placed({\u_board.known_place_q , \u_board.known_q }));
      if (\u_board.held_valid_q ) assert (placed({\u_board.place_q , out_x, out_y, out}));
    end
  end
endmodule
