// SPDX-License-Identifier: Apache-2.0
// rows_dpi_tb.sv through VPI, with arguments that only VPI lets through.
module rows_tb;
  int model;
  longint row[64], pixel[64], i, n, calls;
  reg signed [63:0] unknown[0:63];
  reg [63:0] no_array;
  real half;
  event happened;
  string text;
  logic clk = 1'b0;
  logic valid = 1'b0;
  logic [127:0] values;

  bitspan_checker #(.Model("rows"), .Fields("triangle r"), .Count(2)) u_bitspan (
      .clk_i(clk), .rst_ni(1'b1), .valid_i(valid), .ready_i(1'b1), .values_i(values));

  task must(input int status);
    if (status != 0) $fatal(1, "%0s", $bs_last_error());
  endtask

  task refused(input int good);
    if (good) $fatal(1, "not refused");
    $display("refused: %0s", $bs_last_error());
  endtask

  initial begin
    half = 0.5;
    no_array = 0;
    refused($bs_open("bad", "nowhere", "", "model") != 0);
    refused($bs_open("bad", "depth16", "", "nothing") != 0);
    refused($bs_open("bad") != 0);
    refused($bs_open(half, "depth16", "", "model") != 0);
    refused($bs_open(row, "depth16", "", "model") != 0);
    refused($bs_open(happened, "depth16", "", "model") != 0);
    refused($bs_open(rows_tb, "depth16", "", "model") != 0);
    refused($bs_find() != 0);
    refused($bs_close() == 0);
    refused($bs_close(0) == 0);
    refused($bs_close(1) == 0);
    refused($bs_close(-1) == 0);
    refused($bs_close("model") == 0);
    refused($bs_close(64'bx) == 0);
    refused($bs_draw(0, "demo", 0, 0) == 0);
    refused($bs_begin(0, "demo", 0, 0) == 0);
    refused($bs_row(0, "edge_walk", row) == 0);
    refused($bs_columns(0, "span") >= 0);
    refused($bs_records(0, "span") >= 0);
    refused($bs_column(0, "span", "u") >= 0);
    refused($bs_column_of(0, "span", "u v", 1) >= 0);
    refused($bs_fetch(0, "span", 0, row) == 0);
    refused($bs_expect(0, "span", row, 1) == 0);
    refused($bs_matched(0) != 0);
    refused($bs_nontrivial(0, half) != 0);
    refused($bs_unchecked(0, "nothing") != 0);
    refused($bs_different() != 0);
    if ($bs_divergence(0) != 0) $fatal(1, "a divergence of no model");

    model = $bs_open("rows", "depth16", "", "model");
    if (model == 0) $fatal(1, "%0s", $bs_last_error());
    refused($bs_open("rows", "depth16", "", "model") != 0);
    text = "demo";
    must($bs_draw(model, text, 96, 72));
    must($bs_fetch(model, "edge_walk", 3, row));
    must($bs_fetch(model, 3, 3, unknown));
    unknown[5] = 64'bx;
    refused($bs_row(model, 99, row) == 0);
    refused($bs_row(model, "merge", row) == 0);
    refused($bs_row(model, "edge_walk", unknown) == 0);
    refused($bs_row(model, "edge_walk", no_array) == 0);
    refused($bs_row(model, "edge_walk", row, 1) == 0);
    refused($bs_draw(model, 1.5, 0, 0) == 0);
    refused($bs_draw(model, "demo", "wide", half) == 0);
    refused($bs_fetch(model, "span", -1, pixel) == 0);
    refused($bs_fetch(model, "span", 0, no_array) == 0);
    refused($bs_fetch(model, "span", 0, text) == 0);
    refused($bs_column(model, "span", "nothing") >= 0);
    refused($bs_expect(model, "span", pixel, 0) == 0);
    refused($bs_expect(model, "spam", pixel, 1) == 0);
    refused($bs_begin(model, "nowhere.tri", 0, 0) == 0);

    must($bs_begin(model, "demo", 96, 72));
    if ($bs_records(model, "span") != 0) $fatal(1, "begin has drawn");
    row[$bs_column(model, "edge_walk", "triangle")] = 0;
    if ($test$plusargs("trivial") != 0) begin
      row[$bs_column(model, "edge_walk", "l_r")] = 0;
      row[$bs_column(model, "edge_walk", "r_r")] = 0;
    end
    must($bs_row(model, "edge_walk", row));
    n = $bs_records(model, "span");
    $display("%0d pixels", n);
    for (i = 0; i < n; i = i + 1) begin
      must($bs_fetch(model, "span", i, pixel));
      values = {pixel[$bs_column(model, "span", "triangle")], pixel[$bs_column(model, "span", "r")]};
      if ($test$plusargs("unknown") != 0) values[3] = 1'bx;
      valid = 1'b1;
      #5 clk = 1'b1;
      #5 clk = 1'b0;
    end
    must($bs_close(model));
    refused($bs_close(model) == 0);
    refused($bs_row(model, "edge_walk", row) == 0);
    refused($bs_find("rows") != 0);
    // The checker asks for its counts after this.
    $display("closed: %0d matched", $bs_matched(model, "span"));
    if ($value$plusargs("records=%d", calls) != 0) begin
      model = $bs_open("calls", "depth16", "", "model");
      must($bs_draw(model, "demo", 640, 480));
      for (i = 0; i < calls; i = i + 1) begin
        must($bs_fetch(model, "span", i, pixel));
        must($bs_expect(model, "span", pixel, -1));
      end
    end
    $finish;
  end
endmodule
