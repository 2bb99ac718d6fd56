// SPDX-License-Identifier: Apache-2.0
// Lets one fragment per pixel through: a later one at the same pixel waits, and all behind it, until the earlier one
// has left. For what reads and then writes a frame's memory.
//
// A pixel has one of 2^PlaceW places, found by its coordinates. Several pixels share a place, which costs clocks and
// never a value: a block of 2^(PlaceW/2) x 2^(PlaceW/2) pixels, or a row of 2^PlaceW, has each place once. Rows of half
// as many pixels, less those in flight, follow one another without a place in common.
//
//   mark_a_o, b    what the fragment must bring along when it leaves by way a or way b
//   leave_a_i, b   a fragment leaves; its place is free on the next clock. Without TwoWays there is way a alone
//
//   in -> its place -> skid (`entry`) -> read its bits (`looked`) -> bits (`known`) -> taken or free (`held`) -> out
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

  logic looked_valid_q, known_valid_q, held_valid_q, free_q, swept_q, enter, look, know, hold;
  logic [PlaceW-1:0] sweep_q, looked_place_q, known_place_q, place_q, place_a, place_b;
  logic [2*CoordW+Width-1:0] looked_q, known_q;
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

  assign out_valid_o = held_valid_q && free_q;
  assign enter = out_valid_o && out_ready_i;
  assign hold = enter || !held_valid_q;
  assign know = hold || !known_valid_q;
  assign look = know || !looked_valid_q;
  assign entry_ready = look && swept_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      looked_valid_q <= 1'b0;
      known_valid_q <= 1'b0;
      held_valid_q <= 1'b0;
    end else begin
      if (look) looked_valid_q <= entry_valid && swept_q;
      if (know) known_valid_q <= looked_valid_q;
      if (hold) held_valid_q <= known_valid_q;
    end
  end

  // The memories. An entering fragment makes the number of set bits odd: mark_a_o and mark_b_o are the inverse of the
  // two others.
  localparam int Places = 1 << PlaceW;
  logic entered_bits[Places];
  logic left_a_bits[Places];
  logic entered_q, left_a_q, left_b_q;
  logic [PlaceW-1:0] place_entered, place_left_a, place_left_b;
  assign place_entered = swept_q ? place_q : sweep_q;
  assign place_left_a = swept_q ? place_a : sweep_q;
  assign place_left_b = swept_q ? place_b : sweep_q;
  always_ff @(posedge clk_i) begin
    if (enter || !swept_q) entered_bits[place_entered] <= swept_q & ~(mark_a_o ^ mark_b_o);
    if (look) entered_q <= entered_bits[place];
  end
  always_ff @(posedge clk_i) begin
    if (leave_a_i || !swept_q) left_a_bits[place_left_a] <= swept_q & leave_a_mark_i;
    if (look) left_a_q <= left_a_bits[place];
  end
  if (TwoWays != 0) begin : gen_b
    logic left_b_bits[Places];
    always_ff @(posedge clk_i) begin
      if (leave_b_i || !swept_q) left_b_bits[place_left_b] <= swept_q & leave_b_mark_i;
      if (look) left_b_q <= left_b_bits[place];
    end
  end else begin : gen_no_b
    assign left_b_q = 1'b0;
    logic unused;
    assign unused = leave_b_mark_i ^ (^place_left_b);
  end

  // Whatever enters or leaves a place turns one of its bits. On its way a fragment follows what has turned since it was
  // looked up; `looked` has this in *_since_q beside what was read, since a block RAM is slow. While a fragment is held,
  // its place becomes free by nothing but a leave.
  logic leaves_b;
  logic enters_entry, leaves_a_entry, leaves_b_entry;
  logic enters_looked, leaves_a_looked, leaves_b_looked;
  logic enters_known, leaves_a_known, leaves_b_known;
  logic leaves_a_held, leaves_b_held;
  logic entered_since_q, left_a_since_q, left_b_since_q;
  logic entered_known_q, left_a_known_q, left_b_known_q;
  logic entered, left_a, left_b;
  assign leaves_b = (TwoWays != 0) && leave_b_i;
  assign enters_entry = enter && place_q == place;
  assign leaves_a_entry = leave_a_i && place_a == place;
  assign leaves_b_entry = leaves_b && place_b == place;
  assign enters_looked = enter && place_q == looked_place_q;
  assign leaves_a_looked = leave_a_i && place_a == looked_place_q;
  assign leaves_b_looked = leaves_b && place_b == looked_place_q;
  assign enters_known = enter && place_q == known_place_q;
  assign leaves_a_known = leave_a_i && place_a == known_place_q;
  assign leaves_b_known = leaves_b && place_b == known_place_q;
  assign leaves_a_held = leave_a_i && place_a == place_q;
  assign leaves_b_held = leaves_b && place_b == place_q;
  assign entered = entered_known_q ^ enters_known;
  assign left_a = left_a_known_q ^ leaves_a_known;
  assign left_b = left_b_known_q ^ leaves_b_known;
  always_ff @(posedge clk_i) begin
    if (look) begin
      looked_q <= {entry_x, entry_y, entry};
      looked_place_q <= place;
      entered_since_q <= enters_entry;
      left_a_since_q <= leaves_a_entry;
      left_b_since_q <= leaves_b_entry;
    end else begin
      entered_since_q <= entered_since_q ^ enters_looked;
      left_a_since_q <= left_a_since_q ^ leaves_a_looked;
      left_b_since_q <= left_b_since_q ^ leaves_b_looked;
    end
    if (know) begin
      known_q <= looked_q;
      known_place_q <= looked_place_q;
      entered_known_q <= entered_q ^ entered_since_q ^ enters_looked;
      left_a_known_q <= left_a_q ^ left_a_since_q ^ leaves_a_looked;
      left_b_known_q <= left_b_q ^ left_b_since_q ^ leaves_b_looked;
    end else begin
      entered_known_q <= entered;
      left_a_known_q <= left_a;
      left_b_known_q <= left_b;
    end
    if (hold) begin
      {out_x_o, out_y_o, out_o} <= known_q;
      place_q <= known_place_q;
      free_q <= !(entered ^ left_a ^ left_b);
      mark_a_o <= ~left_a;
      mark_b_o <= ~left_b;
    end else begin
      free_q <= free_q || leaves_a_held || leaves_b_held;
      mark_a_o <= mark_a_o ^ leaves_a_held;
      mark_b_o <= mark_b_o ^ leaves_b_held;
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
