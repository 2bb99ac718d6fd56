// SPDX-License-Identifier: Apache-2.0
// depth of docs/numeric-spec.md: a fragment's code z, and its comparison with the code stored at its pixel.
//
//   fragment in -> scoreboard -+-> request -> memory -> answer -+
//                              +-> z (DepthCodeClocks) -> FIFO -+-> compare | pass -> fragment out, where it passes
//                              +-> all the rest -------> FIFO --+
//   fate in ------------------------------> write -> memory
//
// A fragment that comes out must come back as its fate: whether it is written, which what stands behind may prevent:
// the transparent code, an alpha of 0, the alpha test, or the stencil test. A later fragment at its pixel waits in front
// of the scoreboard until the fate is known and the write, if any, is accepted. It cannot be forwarded to: a code that
// may be killed is not yet the pixel's. Fates may come back in any order. Fragments that fail leave the scoreboard by
// themselves.
//
// HasStencil: a memory's word holds the pixel's stencil value beside its code, so that one read and one write serve both
// tests. The value comes out beside the fragment, and the fate brings the new one and says which parts of the word are
// written. A fragment with in_keep_i comes out where the comparison fails, too; out_pass_o says what it said.
//
// Nothing behind the scoreboard waits for the clocks of z: the FIFOs hold as many fragments as may be in flight.
// A read that is accepted on a later clock than a write must see what was written.
module depth #(
    // Whatever else a fragment brings along.
    parameter int RestW = 32,
    parameter int HasStencil = 0
) (
    input  logic                                  clk_i,
    input  logic                                  rst_ni,
    // Constants of the depth code; stable while fragments are in flight.
    input  logic [bitspan_pixel_pkg::SetupBW-1:0] b_i,
    input  logic [bitspan_pixel_pkg::DepthC1W-1:0] c1_i,
    input  logic [bitspan_pixel_pkg::DepthC0W-1:0] c0_i,
    // A covered fragment. func: bit 0 passes the nearer, bit 1 the equal, bit 2 the farther ones.
    input  logic                                  in_valid_i,
    output logic                                  in_ready_o,
    input  logic [ bitspan_pixel_pkg::CoordW-1:0] in_x_i,
    input  logic [ bitspan_pixel_pkg::CoordW-1:0] in_y_i,
    input  logic [ bitspan_pixel_pkg::SpanHW-1:0] in_h_i,
    input  logic [                           2:0] in_func_i,
    input  logic                                  in_keep_i,
    input  logic [                     RestW-1:0] in_rest_i,
    // The depth memory.
    output logic                                  request_valid_o,
    input  logic                                  request_ready_i,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] request_x_o,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] request_y_o,
    input  logic                                  answer_valid_i,
    output logic                                  answer_ready_o,
    input  logic [ bitspan_pixel_pkg::DepthZW-1:0] answer_z_i,
    input  logic [                           7:0] answer_stencil_i,
    output logic                                  write_valid_o,
    input  logic                                  write_ready_i,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] write_x_o,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] write_y_o,
    output logic [ bitspan_pixel_pkg::DepthZW-1:0] write_z_o,
    output logic [                           7:0] write_stencil_o,
    // What of the word is written: bit 0 the code, bit 1 the stencil value.
    output logic [                           1:0] write_mask_o,
    // Added to the code, which then saturates; the fragment of bias_rest_o has it on the same clock.
    input  logic [ bitspan_pixel_pkg::DepthBiasW-1:0] bias_i,
    output logic [                     RestW-1:0] bias_rest_o,
    // A fragment that passed; its fate brings x, y, z and mark back.
    output logic                                  out_valid_o,
    input  logic                                  out_ready_i,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] out_x_o,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] out_y_o,
    output logic [ bitspan_pixel_pkg::SpanHW-1:0] out_h_o,
    output logic [ bitspan_pixel_pkg::DepthZW-1:0] out_z_o,
    output logic                                  out_mark_o,
    output logic                                  out_pass_o,
    output logic [                           7:0] out_stencil_o,
    output logic [                     RestW-1:0] out_rest_o,
    input  logic                                  fate_valid_i,
    output logic                                  fate_ready_o,
    input  logic [ bitspan_pixel_pkg::CoordW-1:0] fate_x_i,
    input  logic [ bitspan_pixel_pkg::CoordW-1:0] fate_y_i,
    input  logic [ bitspan_pixel_pkg::DepthZW-1:0] fate_z_i,
    input  logic                                  fate_mark_i,
    input  logic [                           1:0] fate_write_i,
    input  logic [                           7:0] fate_stencil_i,
    // A fate waits for its write.
    output logic                                  fate_waits_o,
    // Tap: the depth record, as a fragment leaves the comparison.
    output logic                                  record_valid_o,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] record_x_o,
    output logic [ bitspan_pixel_pkg::CoordW-1:0] record_y_o,
    output logic [bitspan_pixel_pkg::PixelRecipOutW-1:0] record_recip_m_o,
    output logic [bitspan_pixel_pkg::ExponentW-1:0] record_recip_e_o,
    output logic [ bitspan_pixel_pkg::DepthZW-1:0] record_z_o,
    output logic [ bitspan_pixel_pkg::DepthZW-1:0] record_stored_o,
    output logic                                  record_pass_o,
    output logic                                  record_keep_o,
    output logic [                     RestW-1:0] record_rest_o
);
  localparam int CoordW = bitspan_pixel_pkg::CoordW;
  localparam int HW = bitspan_pixel_pkg::SpanHW;
  localparam int ZW = bitspan_pixel_pkg::DepthZW;
  localparam int InFlight = bitspan_pixel_pkg::FragmentsInFlight;
  localparam int CodeClocks = bitspan_pixel_pkg::DepthCodeClocks;
  localparam int RecipW = bitspan_pixel_pkg::PixelRecipOutW + bitspan_pixel_pkg::ExponentW;
  // What a fragment's func and a memory's word have: with a stencil its keep bit, and a value.
  localparam int FuncW = (HasStencil != 0) ? 4 : 3;
  localparam int WordW = (HasStencil != 0) ? ZW + 8 : ZW;

  logic [FuncW-1:0] in_func;
  logic [WordW-1:0] answer;

  // The scoreboard.
  localparam int PlaceW = bitspan_pixel_pkg::ScoreboardPlaceW;
  logic entry_valid, entry_ready, mark_failed, mark_fate, request_ready, rest_ready, enter;
  logic [CoordW-1:0] entry_x, entry_y;
  logic [HW-1:0] entry_h;
  logic [FuncW-1:0] entry_func;
  logic [RestW-1:0] entry_rest;
  logic failed, tested_mark_failed, fate_done, fate_mark;
  logic [CoordW-1:0] tested_x, tested_y;
  assign entry_ready = request_ready && rest_ready;
  assign enter = entry_valid && entry_ready;
  scoreboard #(
      .Width (HW + FuncW + RestW),
      .CoordW(CoordW),
      .PlaceW(PlaceW)
  ) u_scoreboard (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_x_i,
      .in_y_i,
      .in_i          ({in_h_i, in_func, in_rest_i}),
      .out_valid_o   (entry_valid),
      .out_ready_i   (entry_ready),
      .out_x_o       (entry_x),
      .out_y_o       (entry_y),
      .out_o         ({entry_h, entry_func, entry_rest}),
      .mark_a_o      (mark_failed),
      .mark_b_o      (mark_fate),
      .leave_a_i     (failed),
      .leave_a_x_i   (PlaceW'(tested_x)),
      .leave_a_y_i   (PlaceW'(tested_y)),
      .leave_a_mark_i(tested_mark_failed),
      .leave_b_i     (fate_done),
      .leave_b_x_i   (PlaceW'(write_x_o)),
      .leave_b_y_i   (PlaceW'(write_y_o)),
      .leave_b_mark_i(fate_mark)
  );

  skid #(
      .Width(2 * CoordW)
  ) u_request (
      .clk_i,
      .rst_ni,
      .in_valid_i (entry_valid && rest_ready),
      .in_ready_o (request_ready),
      .in_i       ({entry_x, entry_y}),
      .out_valid_o(request_valid_o),
      .out_ready_i(request_ready_i),
      .out_o      ({request_x_o, request_y_o})
  );

  // z, its clocks always running.
  logic [ZW-1:0] z;
  logic [RecipW-1:0] recip;
  logic [CodeClocks-1:0] coded_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) coded_q <= '0;
    else coded_q <= CodeClocks'({coded_q, enter});
  end
  depth_code u_code (
      .clk_i,
      .rst_ni,
      .b_i,
      .c1_i,
      .c0_i,
      .h_i(entry_h),
      .z_o(z),
      .recip_o(recip)
  );

  // Fragments in flight.
  localparam int WaitW = 2 * CoordW + HW + FuncW + 2 + RestW;
  logic rest_valid, z_valid, z_ready, answer_valid, join_valid, take;
  logic [WaitW-1:0] waited;
  logic [ZW-1:0] waited_z;
  logic [WordW-1:0] stored;
  logic [RecipW-1:0] waited_recip;
  fifo #(
      .Width(WaitW),
      .Depth(InFlight)
  ) u_rest (
      .clk_i,
      .rst_ni,
      .in_valid_i (entry_valid && request_ready),
      .in_ready_o (rest_ready),
      .in_i       ({entry_x, entry_y, entry_h, entry_func, mark_failed, mark_fate, entry_rest}),
      .out_valid_o(rest_valid),
      .out_ready_i(take),
      .out_o      (waited)
  );
  fifo #(
      .Width(ZW),
      .Depth(InFlight)
  ) u_z (
      .clk_i,
      .rst_ni,
      .in_valid_i (coded_q[CodeClocks-1]),
      .in_ready_o (z_ready),
      .in_i       (z),
      .out_valid_o(z_valid),
      .out_ready_i(take),
      .out_o      (waited_z)
  );
  skid #(
      .Width(WordW)
  ) u_answer (
      .clk_i,
      .rst_ni,
      .in_valid_i (answer_valid_i),
      .in_ready_o (answer_ready_o),
      .in_i       (answer),
      .out_valid_o(answer_valid),
      .out_ready_i(take),
      .out_o      (stored)
  );
  if (bitspan_pixel_pkg::DepthCode == bitspan_pixel_pkg::DepthLinear) begin : gen_recip
    logic recip_ready, recip_valid;
    fifo #(
        .Width(RecipW),
        .Depth(InFlight)
    ) u_recip (
        .clk_i,
        .rst_ni,
        .in_valid_i (coded_q[CodeClocks-1]),
        .in_ready_o (recip_ready),
        .in_i       (recip),
        .out_valid_o(recip_valid),
        .out_ready_i(take),
        .out_o      (waited_recip)
    );
    logic unused;
    assign unused = recip_ready ^ recip_valid;
  end else begin : gen_no_recip
    assign waited_recip = recip;
  end

  // The code with its bias, held within its range.
  logic [ZW-1:0] biased_z;
  logic signed [ZW+1:0] biased;
  assign bias_rest_o = waited[RestW-1:0];
  assign biased = (ZW + 2)'($signed({1'b0, waited_z})) + (ZW + 2)'($signed(bias_i));
  assign biased_z = biased[ZW+1] ? '0 : biased[ZW] ? '1 : biased[ZW-1:0];

  // join | compare | pass: all of it shifts on en.
  localparam int TestW = WaitW + ZW + WordW + RecipW;
  logic en, joined_q, compared_q, less_q, equal_q, pass;
  logic [TestW-1:0] joined;
  logic [ZW-1:0] joined_z, joined_stored;
  logic [TestW-1:0] compared;
  assign join_valid = rest_valid && z_valid && answer_valid;
  assign take = join_valid && en;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      joined_q <= 1'b0;
      compared_q <= 1'b0;
    end else if (en) begin
      joined_q <= join_valid;
      compared_q <= joined_q;
    end
  end
  always_ff @(posedge clk_i) begin
    if (en) begin
      joined <= {waited_recip, biased_z, stored, waited};
      compared <= joined;
      less_q <= joined_z < joined_stored;
      equal_q <= joined_z == joined_stored;
    end
  end
  assign joined_z = joined[WaitW+WordW+:ZW];
  assign joined_stored = joined[WaitW+:ZW];

  logic [RecipW-1:0] tested_recip;
  logic [ZW-1:0] tested_z, tested_stored;
  logic [WordW-1:0] tested_word;
  logic [HW-1:0] tested_h;
  logic [FuncW-1:0] tested_func;
  logic [RestW-1:0] tested_rest;
  logic tested_mark_fate, nearer, farther, comes_out;
  assign {tested_recip, tested_z, tested_word, tested_x, tested_y, tested_h, tested_func, tested_mark_failed,
          tested_mark_fate, tested_rest} = compared;
  assign nearer = (bitspan_pixel_pkg::DepthNearerIsLarger != 0) ? !less_q && !equal_q : less_q;
  assign farther = (bitspan_pixel_pkg::DepthNearerIsLarger != 0) ? less_q : !less_q && !equal_q;
  assign pass = (nearer && tested_func[0]) || (equal_q && tested_func[1]) || (farther && tested_func[2]);
  assign tested_stored = tested_word[ZW-1:0];
  assign comes_out = pass || record_keep_o;
  assign failed = compared_q && en && !comes_out;
  // With a stencil, its stored value and what the comparison said.
  localparam int PassedW = 2 * CoordW + HW + ZW + 1 + RestW;
  localparam int OutW = (HasStencil != 0) ? PassedW + 9 : PassedW;
  logic [PassedW-1:0] passed_early;
  logic [OutW-1:0] passed, out;
  assign passed_early = {tested_x, tested_y, tested_h, tested_z, tested_mark_fate, tested_rest};
  skid #(
      .Width(OutW)
  ) u_out (
      .clk_i,
      .rst_ni,
      .in_valid_i (compared_q && comes_out),
      .in_ready_o (en),
      .in_i       (passed),
      .out_valid_o,
      .out_ready_i,
      .out_o      (out)
  );
  assign {out_x_o, out_y_o, out_h_o, out_z_o, out_mark_o, out_rest_o} = out[PassedW-1:0];
  assign record_valid_o = compared_q && en;
  assign record_x_o = tested_x;
  assign record_y_o = tested_y;
  assign {record_recip_m_o, record_recip_e_o} = tested_recip;
  assign record_z_o = tested_z;
  assign record_stored_o = tested_stored;
  assign record_pass_o = pass;
  assign record_rest_o = tested_rest;

  // Fates.
  localparam int KnownW = 2 * CoordW + ZW + 2;
  localparam int FateW = (HasStencil != 0) ? KnownW + 9 : KnownW;
  logic fate_valid, fate_write;
  logic [KnownW-1:0] fate_known;
  logic [FateW-1:0] fate_in, fate;
  assign fate_known = {fate_x_i, fate_y_i, fate_z_i, fate_mark_i, fate_write_i[0]};
  skid #(
      .Width(FateW)
  ) u_fate (
      .clk_i,
      .rst_ni,
      .in_valid_i (fate_valid_i),
      .in_ready_o (fate_ready_o),
      .in_i       (fate_in),
      .out_valid_o(fate_valid),
      .out_ready_i(!fate_write || write_ready_i),
      .out_o      (fate)
  );
  assign {write_x_o, write_y_o, write_z_o, fate_mark, write_mask_o[0]} = fate[KnownW-1:0];
  assign fate_write = |write_mask_o;
  assign fate_waits_o = fate_valid;

  // What there is with a stencil alone.
  if (HasStencil != 0) begin : gen_stencil
    assign in_func = {in_keep_i, in_func_i};
    assign answer = {answer_stencil_i, answer_z_i};
    assign record_keep_o = tested_func[FuncW-1];
    assign passed = {pass, tested_word[WordW-1-:8], passed_early};
    assign {out_pass_o, out_stencil_o} = out[OutW-1-:9];
    assign fate_in = {fate_write_i[1], fate_stencil_i, fate_known};
    assign {write_mask_o[1], write_stencil_o} = fate[FateW-1-:9];
  end else begin : gen_no_stencil
    assign in_func = in_func_i;
    assign answer = answer_z_i;
    assign record_keep_o = 1'b0;
    assign passed = passed_early;
    assign {out_pass_o, out_stencil_o} = {1'b1, 8'd0};
    assign fate_in = fate_known;
    assign {write_mask_o[1], write_stencil_o} = 9'd0;
    logic unused;
    assign unused = ^{in_keep_i, answer_stencil_i, fate_write_i[1], fate_stencil_i};
  end
  assign write_valid_o = fate_valid && fate_write;
  assign fate_done = fate_valid && (!fate_write || write_ready_i);

`ifndef SYNTHESIS
  always @(posedge clk_i) begin
    if (coded_q[CodeClocks-1]) begin
      assert (z_ready)
      else $fatal(1, "depth: no room for a code");
    end
  end
`else
  logic unused;
  assign unused = z_ready;
`endif
endmodule
