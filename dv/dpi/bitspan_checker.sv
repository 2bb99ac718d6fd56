// SPDX-License-Identifier: Apache-2.0
// Checks each record that a design delivers against a model of bitspan_pkg. Attach it with `bind`:
//
//   bind acme_spi bitspan_checker #(.Model("near"), .Fields("x u v"), .Count(3)) u_bitspan (
//       .clk_i(clk), .rst_ni(rst_n), .valid_i(pix_vld), .ready_i(pix_rdy),
//       .values_i({64'(pix_x), 64'($signed(pix_u)), 64'($signed(pix_v))}));
//
// A record is delivered on a clock where valid and ready are both 1. The first mismatch is printed, and the simulation
// goes on for ClocksAfterMismatch clocks, so that a waveform has it. Then it ends with $fatal. At its end the counts
// are printed. Nothing matched, nothing non-trivial, and records that were never checked are failures, too.
module bitspan_checker #(
    parameter string Model = "model",  // as given to bitspan_open
    parameter int Stage = bitspan_pkg::StageSpan,
    parameter string Fields = "x u v",  // names of fields, as in values_i from the left
    parameter int Count = 3,  // how many these are
    parameter int ClocksAfterMismatch = 50
) (
    input logic clk_i,
    input logic rst_ni,
    input logic valid_i,
    input logic ready_i,
    // 64 bits per field; those of a signed format must be sign-extended.
    input logic [64*Count-1:0] values_i
);
  import bitspan_pkg::*;

  chandle model;
  bit found, mismatch;
  int clocks_left;
  int columns[Count];
  longint present;
  longint record[MaxColumns];

  // The model is opened while the simulation runs, and so is looked for when the first record comes.
  function automatic void find_model();
    model = bitspan_find(Model);
    if (model == null) $fatal(1, "%m: %s", bitspan_last_error());
    for (int i = 0; i <= Count; i++) begin
      automatic int column = bitspan_column_of(model, Stage, Fields, i);
      if (i < Count && column >= 0) begin
        columns[i] = column;
        present[column[5:0]] = 1'b1;
      end else if (column == -1) begin
        $fatal(1, "%m: %s", bitspan_last_error());
      end else if (i < Count || column != -2) begin
        $fatal(1, "%m: \"%s\"; expected %0d names of fields", Fields, Count);
      end
    end
    found = 1'b1;
  endfunction

  function automatic void check_record();
    automatic int status;
    for (int i = 0; i < Count; i++) record[columns[i]] = values_i[64*(Count-1-i)+:64];
    status = bitspan_check(model, Stage, record, present);
    if (status == Different) begin
      if (!mismatch) begin
        $display("%m: mismatch at time %0t: %s", $time, bitspan_divergence(model));
        clocks_left = ClocksAfterMismatch;
      end
      mismatch = 1'b1;
    end else if (status != 0) begin
      $fatal(1, "%m: %s", bitspan_last_error());
    end
  endfunction

  always @(posedge clk_i) begin
    if (rst_ni) begin
      if (mismatch) begin
        if (clocks_left == 0) $fatal(1, "%m: %0d records differ", bitspan_different(model, Stage));
        clocks_left = clocks_left - 1;
      end
      if (valid_i && ready_i) begin
        if (!found) find_model();
        check_record();
      end
    end
  end

  final begin
    if (!found) model = bitspan_find(Model);
    $display("%m: %0d values matched, %0d non-trivial, %0d records unchecked", bitspan_matched(model, Stage),
             bitspan_nontrivial(model, Stage), bitspan_unchecked(model, Stage));
    if (mismatch || bitspan_matched(model, Stage) == 0 || bitspan_nontrivial(model, Stage) == 0 ||
        bitspan_unchecked(model, Stage) != 0)
      $fatal(1, "%m: not verified");
  end
endmodule
