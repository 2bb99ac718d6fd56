// SPDX-License-Identifier: Apache-2.0
// Rows that the bench draws by itself, through bitspan_pkg; the checker compares what it fetches back.
//
//   +trivial     shades of 0: all matches, and nothing of it is non-trivial
//   +records=N   fetches and checks N records more, for calls.py
module rows_tb;
  import bitspan_pkg::*;
  chandle model;
  longint row[MaxColumns], pixel[MaxColumns], calls;
  logic clk = 1'b0;
  logic valid = 1'b0;
  logic [127:0] values;
  string name;

  bitspan_checker #(.Model("rows"), .Fields("triangle r"), .Count(2)) u_bitspan (
      .clk_i(clk), .rst_ni(1'b1), .valid_i(valid), .ready_i(1'b1), .values_i(values));

  function automatic void must(input int status);
    if (status != 0) $fatal(1, "%s", bitspan_last_error());
  endfunction

  // A call that must fail, and what it says.
  function automatic void refused(input string call, input int status);
    if (status == 0) $fatal(1, "%s: not refused", call);
    $display("refused: %s: %s", call, bitspan_last_error());
  endfunction

  initial begin
    refused("open", int'(bitspan_open("bad", "nowhere", "", "model") == null));
    refused("open", int'(bitspan_open("bad", "depth16", "", "nothing") == null));
    refused("close", bitspan_close(null));
    refused("draw", bitspan_draw(null, "demo", 0, 0));
    refused("begin", bitspan_begin(null, "demo", 0, 0));
    refused("row", bitspan_row(null, StageEdgeWalk, row));
    refused("columns", bitspan_columns(null, StageSpan));
    refused("records", int'(bitspan_records(null, StageSpan)));
    refused("column", bitspan_column(null, StageSpan, "u"));
    refused("fetch", bitspan_fetch(null, StageSpan, 0, row));
    refused("check", bitspan_check(null, StageSpan, row, 1));
    if (bitspan_matched(null, StageSpan) != 0 || bitspan_divergence(null) != "") $fatal(1, "counts of no model");

    model = bitspan_open("rows", "depth16", "", "model");
    if (model == null) $fatal(1, "%s", bitspan_last_error());
    refused("open", int'(bitspan_open("rows", "depth16", "", "model") == null));
    must(bitspan_draw(model, "demo", 96, 72));
    must(bitspan_fetch(model, StageEdgeWalk, 3, row));
    refused("stage", bitspan_row(model, 99, row));
    refused("stage of no rows", bitspan_row(model, StageMerge, row));
    refused("fetch", bitspan_fetch(model, StageSpan, -1, pixel));
    refused("column", bitspan_column(model, StageSpan, "nothing"));
    refused("present", bitspan_check(model, StageSpan, pixel, 0));
    refused("begin", bitspan_begin(model, "nowhere.tri", 0, 0));

    must(bitspan_begin(model, "demo", 96, 72));
    if (bitspan_records(model, StageSpan) != 0) $fatal(1, "begin has drawn");
    row[bitspan_column(model, StageEdgeWalk, "triangle")] = 0;
    if ($test$plusargs("trivial") != 0) begin
      row[bitspan_column(model, StageEdgeWalk, "l_r")] = 0;
      row[bitspan_column(model, StageEdgeWalk, "r_r")] = 0;
    end
    must(bitspan_row(model, StageEdgeWalk, row));
    $display("%0d pixels", bitspan_records(model, StageSpan));
    for (longint i = 0; i < bitspan_records(model, StageSpan); i++) begin
      must(bitspan_fetch(model, StageSpan, i, pixel));
      values = {pixel[bitspan_column(model, StageSpan, "triangle")], pixel[bitspan_column(model, StageSpan, "r")]};
      valid = 1'b1;
      #5 clk = 1'b1;
      #5 clk = 1'b0;
    end
    must(bitspan_close(model));
    refused("close", bitspan_close(model));
    refused("row", bitspan_row(model, StageEdgeWalk, row));
    if (bitspan_find("rows") != null) $fatal(1, "found a closed model");
    // The checker asks for its counts after this.
    $display("closed: %0d matched", bitspan_matched(model, StageSpan));
    if ($value$plusargs("records=%d", calls) != 0) begin
      model = bitspan_open("calls", "depth16", "", "model");
      must(bitspan_draw(model, "demo", 640, 480));
      for (longint i = 0; i < calls; i++) begin
        must(bitspan_fetch(model, StageSpan, i, pixel));
        must(bitspan_check(model, StageSpan, pixel, -1));
      end
    end
    $finish;
  end
endmodule
