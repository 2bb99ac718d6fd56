// SPDX-License-Identifier: Apache-2.0
// merge of docs/numeric-spec.md: writes a fragment's colour, or what is made of it and the stored one.
//
//   fragment in -> scoreboard -+-> request -> memory -> answer --+
//                              +-> FIFO -------------------------+-> join | blend -> write
//
// What stands at `blend` is a choice of the package. Without MergeByEquation it is a mix by the fragment's alpha, and the
// picture's alpha stays; with it, it is blend_unit, which makes every blend and logic operation, of alpha, too.
//
// Only a fragment whose result depends on the stored colour reads it: blend_i and an alpha below 1, or reads_i. It and
// every later fragment at a pixel wait in front of the scoreboard until the earlier one is written; forwarding would need
// the colour after Q, so many clocks behind the join that waiting costs little more. A read that is accepted on a later
// clock than a write must see what was written.
module merge #(
    // Whatever else a fragment brings along, to the record.
    parameter int RestW = 32
) (
    input  logic                                      clk_i,
    input  logic                                      rst_ni,
    // A fragment: the colour of fog, the alpha of texture. blend: the stored colour counts where its alpha is below 1;
    // reads (with MergeByEquation): it counts whatever the alpha is; write: its colour is written.
    input  logic                                      in_valid_i,
    output logic                                      in_ready_o,
    input  logic [     bitspan_pixel_pkg::CoordW-1:0] in_x_i,
    input  logic [     bitspan_pixel_pkg::CoordW-1:0] in_y_i,
    input  logic [  bitspan_pixel_pkg::FogColorW-1:0] in_r_i,
    input  logic [  bitspan_pixel_pkg::FogColorW-1:0] in_g_i,
    input  logic [  bitspan_pixel_pkg::FogColorW-1:0] in_b_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_a_i,
    input  logic                                      in_blend_i,
    input  logic                                      in_reads_i,
    input  logic                                      in_write_i,
    input  logic [                         RestW-1:0] in_rest_i,
    // With MergeByEquation, of the fragment that joins what is stored at its pixel: what it brought along, and what follows
    // from it, the draw state as blend_unit takes it; has_a: the picture's alpha changes.
    output logic [                         RestW-1:0] joined_rest_o,
    input  logic [                               3:0] joined_src_i,
    input  logic [                               3:0] joined_dst_i,
    input  logic [                               2:0] joined_op_i,
    input  logic [                               3:0] joined_alpha_src_i,
    input  logic [                               3:0] joined_alpha_dst_i,
    input  logic [                               2:0] joined_alpha_op_i,
    input  logic [                              31:0] joined_constant_i,
    input  logic [                               4:0] joined_logic_i,
    input  logic                                      joined_has_a_i,
    // The colour memory. Alpha is read and written only with MergeByEquation, and written where has_a is 1.
    output logic                                      request_valid_o,
    input  logic                                      request_ready_i,
    output logic [     bitspan_pixel_pkg::CoordW-1:0] request_x_o,
    output logic [     bitspan_pixel_pkg::CoordW-1:0] request_y_o,
    input  logic                                      answer_valid_i,
    output logic                                      answer_ready_o,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] answer_r_i,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] answer_g_i,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] answer_b_i,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] answer_a_i,
    output logic                                      write_valid_o,
    input  logic                                      write_ready_i,
    output logic [     bitspan_pixel_pkg::CoordW-1:0] write_x_o,
    output logic [     bitspan_pixel_pkg::CoordW-1:0] write_y_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] write_r_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] write_g_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] write_b_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] write_a_o,
    output logic                                      write_has_a_o,
    // Tap: a fragment leaves; x, y, r, g, b and a are those of the write port, whether they are written or not.
    output logic                                      record_valid_o,
    output logic [                         RestW-1:0] record_rest_o
);
  localparam int CoordW = bitspan_pixel_pkg::CoordW;
  localparam int OwnW = bitspan_pixel_pkg::FogColorW;
  localparam int AlphaW = bitspan_pixel_pkg::TextureAlphaW;
  localparam int AlphaFrac = bitspan_pixel_pkg::TextureAlphaFrac;
  localparam int ColorW = bitspan_pixel_pkg::MergeColorW;
  localparam int InFlight = bitspan_pixel_pkg::FragmentsInFlight;
  localparam int PlaceW = bitspan_pixel_pkg::ScoreboardPlaceW;

  // What tells a read: blend, and with MergeByEquation reads above it.
  localparam int ByEquation = bitspan_pixel_pkg::MergeByEquation;
  localparam int NeedsW = (ByEquation != 0) ? 2 : 1;
  logic [NeedsW-1:0] in_needs, entry_needs;
  assign in_needs = NeedsW'({in_reads_i, in_blend_i});

  // The scoreboard.
  logic entry_valid, entry_ready, entry_write, mark, unused_mark, request_ready, rest_ready;
  logic [CoordW-1:0] entry_x, entry_y;
  logic [3*OwnW-1:0] entry_own;
  logic [AlphaW-1:0] entry_a;
  logic [RestW-1:0] entry_rest;
  logic leave, leave_mark;
  assign entry_ready = rest_ready && request_ready;
  scoreboard #(
      .Width  (3 * OwnW + AlphaW + NeedsW + 1 + RestW),
      .CoordW (CoordW),
      .PlaceW (PlaceW),
      .TwoWays(0)
  ) u_scoreboard (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_x_i,
      .in_y_i,
      .in_i          ({in_r_i, in_g_i, in_b_i, in_a_i, in_needs, in_write_i, in_rest_i}),
      .out_valid_o   (entry_valid),
      .out_ready_i   (entry_ready),
      .out_x_o       (entry_x),
      .out_y_o       (entry_y),
      .out_o         ({entry_own, entry_a, entry_needs, entry_write, entry_rest}),
      .mark_a_o      (mark),
      .mark_b_o      (unused_mark),
      .leave_a_i     (leave),
      .leave_a_x_i   (PlaceW'(write_x_o)),
      .leave_a_y_i   (PlaceW'(write_y_o)),
      .leave_a_mark_i(leave_mark),
      .leave_b_i     (1'b0),
      .leave_b_x_i   ({PlaceW{1'b0}}),
      .leave_b_y_i   ({PlaceW{1'b0}}),
      .leave_b_mark_i(1'b0)
  );
  // Below 1: negative, or no bit at 1 or above.
  logic translucent, reads;
  if (AlphaW > AlphaFrac) begin : gen_translucent
    assign translucent = (bitspan_pixel_pkg::TextureAlphaSigned != 0 && entry_a[AlphaW-1]) ||
                         !(|entry_a[AlphaW-1:AlphaFrac]);
  end else begin : gen_always_translucent
    assign translucent = 1'b1;
  end
  if (ByEquation != 0) begin : gen_reads
    assign reads = entry_needs[NeedsW-1] || (entry_needs[0] && translucent);
  end else begin : gen_mixes
    assign reads = entry_needs[0] && translucent;
  end

  skid #(
      .Width(2 * CoordW)
  ) u_request (
      .clk_i,
      .rst_ni,
      .in_valid_i (entry_valid && reads && rest_ready),
      .in_ready_o (request_ready),
      .in_i       ({entry_x, entry_y}),
      .out_valid_o(request_valid_o),
      .out_ready_i(request_ready_i),
      .out_o      ({request_x_o, request_y_o})
  );

  // Fragments in flight.
  localparam int WaitW = 2 * CoordW + 3 * OwnW + AlphaW + 3 + RestW;
  logic rest_valid, answer_valid, join_valid, take, waited_mark, waited_reads, waited_write;
  logic [CoordW-1:0] waited_x, waited_y;
  logic [3*OwnW-1:0] waited_own;
  logic [AlphaW-1:0] waited_a;
  logic [RestW-1:0] waited_rest;
  // Red, green, blue; with MergeByEquation alpha above them.
  localparam int StoredW = (ByEquation != 0) ? 4 * ColorW : 3 * ColorW;
  logic [StoredW-1:0] answer, stored;
  assign answer = StoredW'({answer_a_i, answer_r_i, answer_g_i, answer_b_i});
  fifo #(
      .Width(WaitW),
      .Depth(InFlight)
  ) u_rest (
      .clk_i,
      .rst_ni,
      .in_valid_i (entry_valid && request_ready),
      .in_ready_o (rest_ready),
      .in_i       ({entry_x, entry_y, entry_own, entry_a, mark, reads, entry_write, entry_rest}),
      .out_valid_o(rest_valid),
      .out_ready_i(take),
      .out_o      ({waited_x, waited_y, waited_own, waited_a, waited_mark, waited_reads, waited_write, waited_rest})
  );
  skid #(
      .Width(StoredW)
  ) u_answer (
      .clk_i,
      .rst_ni,
      .in_valid_i (answer_valid_i),
      .in_ready_o (answer_ready_o),
      .in_i       (answer),
      .out_valid_o(answer_valid),
      .out_ready_i(take && waited_reads),
      .out_o      (stored)
  );

  // join | blend: all of it shifts on en.
  localparam int ProductClocks = bitspan_pixel_pkg::MergeProductClocks;
  localparam int BlendClocks = (ByEquation != 0) ? bitspan_pixel_pkg::BlendClocks : ProductClocks + 3;
  localparam int Clocks = 1 + BlendClocks;
  localparam int CarriedW = 2 * CoordW + 2 + RestW;
  logic en, done_valid, done_ready, done_write;
  assign join_valid = rest_valid && (answer_valid || !waited_reads);
  assign take = join_valid && en;

  if (ByEquation != 0) begin : gen_equation
    // Where nothing was read, the result does not depend on what is stored, and 0 stands for it.
    logic valid_q, has_a_q;
    logic [3*OwnW-1:0] own_q;
    logic [AlphaW-1:0] a_q;
    logic [StoredW-1:0] stored_q;
    logic [CarriedW-1:0] carried_q;
    logic [3:0] src_q, dst_q, alpha_src_q, alpha_dst_q;
    logic [2:0] op_q, alpha_op_q;
    logic [31:0] constant_q;
    logic [4:0] logic_q;
    assign joined_rest_o = waited_rest;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) valid_q <= 1'b0;
      else if (en) valid_q <= join_valid;
    end
    always_ff @(posedge clk_i) begin
      if (en) begin
        own_q <= waited_own;
        a_q <= waited_a;
        stored_q <= waited_reads ? stored : '0;
        carried_q <= {waited_x, waited_y, waited_mark, waited_write, waited_rest};
        {src_q, dst_q, op_q} <= {joined_src_i, joined_dst_i, joined_op_i};
        {alpha_src_q, alpha_dst_q, alpha_op_q} <= {joined_alpha_src_i, joined_alpha_dst_i, joined_alpha_op_i};
        {constant_q, logic_q, has_a_q} <= {joined_constant_i, joined_logic_i, joined_has_a_i};
      end
    end
    blend_unit #(
        .RestW(CarriedW + 1)
    ) u_blend (
        .clk_i,
        .rst_ni,
        .in_valid_i    (valid_q),
        .in_ready_o    (en),
        .in_r_i        (own_q[2*OwnW+:OwnW]),
        .in_g_i        (own_q[OwnW+:OwnW]),
        .in_b_i        (own_q[0+:OwnW]),
        .in_a_i        (a_q),
        .in_stored_i   ({stored_q[3*ColorW+:ColorW], stored_q[0+:ColorW], stored_q[ColorW+:ColorW],
                         stored_q[2*ColorW+:ColorW]}),
        .in_rest_i     ({carried_q, has_a_q}),
        .in_src_i      (src_q),
        .in_dst_i      (dst_q),
        .in_op_i       (op_q),
        .in_alpha_src_i(alpha_src_q),
        .in_alpha_dst_i(alpha_dst_q),
        .in_alpha_op_i (alpha_op_q),
        .in_constant_i (constant_q),
        .in_logic_i    (logic_q),
        .out_valid_o   (done_valid),
        .out_ready_i   (done_ready),
        .out_r_o       (write_r_o),
        .out_g_o       (write_g_o),
        .out_b_o       (write_b_o),
        .out_a_o       (write_a_o),
        .out_rest_o    ({write_x_o, write_y_o, leave_mark, done_write, record_rest_o, write_has_a_o})
    );
  end else begin : gen_by_alpha
    // Where nothing was read, the share is 1, which alpha's format holds, and what stands at stored_q counts nothing.
    logic [Clocks-1:0] valid_q;
    logic [3*OwnW-1:0] own_q;
    logic [3*ColorW-1:0] stored_q, color;
    logic [AlphaW-1:0] share_q;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) valid_q <= '0;
      else if (en) valid_q <= Clocks'({valid_q, join_valid});
    end
    always_ff @(posedge clk_i) begin
      if (en) begin
        own_q <= waited_own;
        stored_q <= stored;
        share_q <= waited_reads ? waited_a : AlphaW'(1) << AlphaFrac;
      end
    end
    for (genvar c = 0; c < 3; c++) begin : gen_color
      logic [ColorW-1:0] from, made;
      logic [OwnW-1:0] own;
      assign from = stored_q[c*ColorW+:ColorW];
      assign own = own_q[c*OwnW+:OwnW];
      blend #(
          .AW(ColorW),
          .AFrac(bitspan_pixel_pkg::MergeColorFrac),
          .BW(OwnW),
          .BFrac(bitspan_pixel_pkg::FogColorFrac),
          .BSigned(bitspan_pixel_pkg::FogColorSigned),
          .EW(AlphaW),
          .EFrac(AlphaFrac),
          .ESigned(bitspan_pixel_pkg::TextureAlphaSigned),
          .OutW(ColorW),
          .OutFrac(bitspan_pixel_pkg::MergeColorFrac),
          .OutSigned(bitspan_pixel_pkg::MergeColorSigned),
          .OutRnd(bitspan_pixel_pkg::MergeColorRnd),
          .OutOvf(bitspan_pixel_pkg::MergeColorOvf),
          .ProductClocks(ProductClocks),
          .Clocks(BlendClocks)
      ) u_blend (
          .clk_i,
          .en_i(en),
          .a_i (from),
          .b_i (own),
          .e_i (share_q),
          .q_o (made)
      );
      assign color[c*ColorW+:ColorW] = made;
    end

    logic [CarriedW-1:0] carried;
    delay_line #(
        .Width(CarriedW),
        .Depth(Clocks)
    ) u_carried (
        .clk_i,
        .en_i(en),
        .d_i ({waited_x, waited_y, waited_mark, waited_write, waited_rest}),
        .q_o (carried)
    );
    skid #(
        .Width(CarriedW + 3 * ColorW)
    ) u_out (
        .clk_i,
        .rst_ni,
        .in_valid_i (valid_q[Clocks-1]),
        .in_ready_o (en),
        .in_i       ({carried, color}),
        .out_valid_o(done_valid),
        .out_ready_i(done_ready),
        .out_o      ({write_x_o, write_y_o, leave_mark, done_write, record_rest_o, write_r_o, write_g_o, write_b_o})
    );
    assign write_a_o = '0;
    assign write_has_a_o = 1'b0;
    assign joined_rest_o = '0;
    logic unused;
    assign unused = ^{joined_src_i, joined_dst_i, joined_op_i, joined_alpha_src_i, joined_alpha_dst_i, joined_alpha_op_i,
                      joined_constant_i, joined_logic_i, joined_has_a_i};
  end

  assign write_valid_o = done_valid && done_write;
  assign done_ready = !done_write || write_ready_i;
  assign leave = done_valid && done_ready;
  assign record_valid_o = leave;

  logic unused;
  assign unused = unused_mark;

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::MergeClocks)
    else $fatal(1, "merge: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::MergeClocks);
  end
`endif
endmodule
