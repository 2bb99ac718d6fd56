// SPDX-License-Identifier: Apache-2.0
// dv/dpi/bitspan_checker.sv for Icarus 11, over the system functions of bitspan_vpi.cpp. Icarus has no `bind`: make an
// instance in the bench, at signals of the design or of the bench.
//
//   bitspan_checker #(.Model("near"), .Fields("x u v"), .Count(3)) u_bitspan (
//       .clk_i(clk), .rst_ni(rst_n), .valid_i(pix_vld), .ready_i(pix_rdy),
//       .values_i({64'(pix_x), 64'($signed(pix_u)), 64'($signed(pix_v))}));
//
// A record is delivered on a clock where valid and ready are both 1. The first mismatch is printed, and the simulation
// goes on for ClocksAfterMismatch clocks, so that a waveform has it. Then it ends with $fatal. At its end the counts
// are printed. Nothing matched, nothing non-trivial, and records that were never checked are failures, too.
module bitspan_checker #(
    parameter Model = "model",  // as given to $bs_open
    parameter Stage = "span",
    parameter Fields = "x u v",  // names of fields, as in values_i from the left
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
  int model = 0;
  logic mismatch = 1'b0;
  int clocks_left, status;
  int columns[Count];
  longint present = 0;
  // 4 states: a bit of the design that is not known is an error.
  logic signed [63:0] record[64];

  // The model is opened while the simulation runs, and so is looked for when the first record comes.
  task find_model;
    int column;
    model = $bs_find(Model);
    if (model == 0) $fatal(1, "%0s", $bs_last_error());
    for (int i = 0; i < 64; i = i + 1) record[i] = 0;
    for (int i = 0; i <= Count; i = i + 1) begin
      column = $bs_column_of(model, Stage, Fields, i);
      if (i < Count && column >= 0) begin
        columns[i] = column;
        present = present | 64'd1 << column;
      end else if (column == -1) begin
        $fatal(1, "%0s", $bs_last_error());
      end else if (i < Count || column != -2) begin
        $fatal(1, "\"%0s\"; expected %0d names of fields", Fields, Count);
      end
    end
  endtask

  task check_record;
    for (int i = 0; i < Count; i = i + 1) record[columns[i]] = values_i[64*(Count-1-i)+:64];
    status = $bs_expect(model, Stage, record, present);
    if (status == 1) begin
      if (!mismatch) begin
        $display("%m: mismatch at time %0t: %0s", $time, $bs_divergence(model));
        clocks_left = ClocksAfterMismatch;
      end
      mismatch = 1'b1;
    end else if (status != 0) begin
      $fatal(1, "%0s", $bs_last_error());
    end
  endtask

  always @(posedge clk_i) begin
    if (rst_ni) begin
      if (mismatch) begin
        if (clocks_left == 0) $fatal(1, "%0d records differ", $bs_different(model, Stage));
        clocks_left = clocks_left - 1;
      end
      if (valid_i && ready_i) begin
        if (model == 0) find_model;
        if (model != 0) check_record;
      end
    end
  end

  final begin
    if (model == 0) model = $bs_find(Model);
    $display("%m: %0d values matched, %0d non-trivial, %0d records unchecked", $bs_matched(model, Stage),
             $bs_nontrivial(model, Stage), $bs_unchecked(model, Stage));
    if (mismatch || $bs_matched(model, Stage) == 0 || $bs_nontrivial(model, Stage) == 0 ||
        $bs_unchecked(model, Stage) != 0)
      $fatal(1, "not verified");
  end
endmodule
