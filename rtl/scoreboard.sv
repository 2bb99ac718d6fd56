// SPDX-License-Identifier: Apache-2.0
// Lets one fragment per pixel through: a later one at the same pixel waits, and all behind it, until the earlier one
// has left. For what reads and then writes a frame's memory.
//
// A pixel has one of 2^PlaceW places, found by its coordinates. Several pixels share a place, which costs clocks and
// never a value: a block of 2^(PlaceW/2) x 2^(PlaceW/2) pixels, or a row of 2^PlaceW, has each place once.
//
//   mark_a_o, b    what the fragment must bring along when it leaves by way a or way b
//   leave_a_i, b   a fragment leaves; its place is free on the next clock. Without TwoWays there is way a alone
//
//   in -> its place -> skid (`entry`) -> look the place up -> register (`held`) -> out
//
// A place is taken where an odd number of its three bits is set; each way writes one memory only, and an entering
// fragment another. For 2^PlaceW clocks after reset the memories are cleared, and nothing comes out.
module scoreboard #(
    parameter int Width   = 8,
    parameter int CoordW  = 16,
    parameter int PlaceW  = 8,
    parameter int TwoWays = 1
) (
    input  logic              clk_i,
    input  logic              rst_ni,
    input  logic              in_valid_i,
    output logic              in_ready_o,
    input  logic [CoordW-1:0] in_x_i,
    input  logic [CoordW-1:0] in_y_i,
    input  logic [ Width-1:0] in_i,
    output logic              out_valid_o,
    input  logic              out_ready_i,
    output logic [CoordW-1:0] out_x_o,
    output logic [CoordW-1:0] out_y_o,
    output logic [ Width-1:0] out_o,
    output logic              mark_a_o,
    output logic              mark_b_o,
    input  logic              leave_a_i,
    input  logic [PlaceW-1:0] leave_a_x_i,
    input  logic [PlaceW-1:0] leave_a_y_i,
    input  logic              leave_a_mark_i,
    input  logic              leave_b_i,
    input  logic [PlaceW-1:0] leave_b_x_i,
    input  logic [PlaceW-1:0] leave_b_y_i,
    input  logic              leave_b_mark_i
);
  // y counts from the other end, so that neighbours in x and in y differ in other bits.
  function automatic logic [PlaceW-1:0] place_of(input logic [PlaceW-1:0] x, input logic [PlaceW-1:0] y);
    for (int i = 0; i < PlaceW; i++) place_of[i] = x[i] ^ y[PlaceW-1-i];
  endfunction

  logic entry_valid, entry_ready;
  logic [PlaceW-1:0] place;
  logic [CoordW-1:0] entry_x, entry_y;
  logic [Width-1:0] entry;
  skid #(
      .Width(PlaceW + 2 * CoordW + Width)
  ) u_in (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_i({place_of(PlaceW'(in_x_i), PlaceW'(in_y_i)), in_x_i, in_y_i, in_i}),
      .out_valid_o(entry_valid),
      .out_ready_i(entry_ready),
      .out_o({place, entry_x, entry_y, entry})
  );

  logic held_valid_q, free_q, swept_q, enter;
  logic [PlaceW-1:0] sweep_q, place_q, place_a, place_b;
  assign place_a = place_of(leave_a_x_i, leave_a_y_i);
  assign place_b = place_of(leave_b_x_i, leave_b_y_i);
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      swept_q <= 1'b0;
      sweep_q <= '0;
    end else if (!swept_q) begin
      swept_q <= &sweep_q;
      sweep_q <= sweep_q + PlaceW'(1);
    end
  end

  // The memories. An entering fragment makes the number of set bits odd: mark_a_o and mark_b_o are the inverse of the
  // two others.
  localparam int Places = 1 << PlaceW;
  logic entered_bits[Places];
  logic left_a_bits[Places];
  logic left_a, left_b, taken;
  assign left_a = left_a_bits[place];
  assign taken = entered_bits[place] ^ left_a ^ left_b;
  always_ff @(posedge clk_i) begin
    if (enter || !swept_q) entered_bits[swept_q ? place_q : sweep_q] <= swept_q & ~(mark_a_o ^ mark_b_o);
  end
  always_ff @(posedge clk_i) begin
    if (leave_a_i || !swept_q) left_a_bits[swept_q ? place_a : sweep_q] <= swept_q & leave_a_mark_i;
  end
  if (TwoWays != 0) begin : gen_b
    logic left_b_bits[Places];
    assign left_b = left_b_bits[place];
    always_ff @(posedge clk_i) begin
      if (leave_b_i || !swept_q) left_b_bits[swept_q ? place_b : sweep_q] <= swept_q & leave_b_mark_i;
    end
  end else begin : gen_no_b
    assign left_b = 1'b0;
    logic unused;
    assign unused = leave_b_mark_i;
  end

  // A fragment is looked up on the clock before it is held. What enters or leaves on that clock is not in the memories
  // yet; while it is held, its place becomes free by nothing but a leave.
  logic a_leaves_place, b_leaves_place, a_leaves_held, b_leaves_held;
  assign a_leaves_place = leave_a_i && place_a == place;
  assign b_leaves_place = (TwoWays != 0) && leave_b_i && place_b == place;
  assign a_leaves_held = leave_a_i && place_a == place_q;
  assign b_leaves_held = (TwoWays != 0) && leave_b_i && place_b == place_q;
  assign out_valid_o = held_valid_q && free_q;
  assign enter = out_valid_o && out_ready_i;
  assign entry_ready = swept_q && (enter || !held_valid_q);
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) held_valid_q <= 1'b0;
    else if (swept_q && (enter || !held_valid_q)) held_valid_q <= entry_valid;
  end
  always_ff @(posedge clk_i) begin
    if (entry_ready) begin
      out_x_o <= entry_x;
      out_y_o <= entry_y;
      out_o <= entry;
      place_q <= place;
      free_q <= (!taken || a_leaves_place || b_leaves_place) && !(enter && place == place_q);
      mark_a_o <= ~left_a ^ a_leaves_place;
      mark_b_o <= ~left_b ^ b_leaves_place;
    end else begin
      free_q <= free_q || a_leaves_held || b_leaves_held;
      mark_a_o <= mark_a_o ^ a_leaves_held;
      mark_b_o <= mark_b_o ^ b_leaves_held;
    end
  end

`ifndef SYNTHESIS
  // By counting, per place.
  logic is_inside[Places];
  always @(posedge clk_i) begin
    if (!swept_q) begin
      is_inside[sweep_q] <= 1'b0;
    end else begin
      if (enter) begin
        is_inside[place_q] <= 1'b1;
        assert (!is_inside[place_q])
        else $fatal(1, "scoreboard: a fragment enters a place that is taken");
      end
      if (leave_a_i) begin
        is_inside[place_a] <= 1'b0;
        assert (is_inside[place_a])
        else $fatal(1, "scoreboard: a fragment leaves a place that is free");
      end
      if ((TwoWays != 0) && leave_b_i) begin
        is_inside[place_b] <= 1'b0;
        assert (is_inside[place_b])
        else $fatal(1, "scoreboard: a fragment leaves a place that is free");
      end
    end
  end
`endif
endmodule
