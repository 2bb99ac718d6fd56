// SPDX-License-Identifier: Apache-2.0
// Two configurations of acme_spi in one simulation. Each takes the rows of a scene from its model, with random gaps and
// stalls; a checker at its ports compares every pixel. docs/dv.md has the commands.
//
//   +scene=FILE +width=N +height=N +settings=KEY=VALUE +flip (a bug in the design) +rows=N (no more rows)
bind acme_spi bitspan_checker #(
    .Model(Core == 0 ? "near" : "far"),
    .Fields("x last h fu fv recip_m recip_e u v r g b a"),
    .Count(13)
) u_bitspan (
    .clk_i(clk),
    .rst_ni(rst_n),
    .valid_i(pix_vld),
    .ready_i(pix_rdy),
    .values_i({pix_x, 63'd0, pix_last, pix_h, pix_fu, pix_fv, pix_m, pix_e, pix_u, pix_v, pix_rgba})
);

// Feeds one design; `done_o` where every row is in, and nothing has come out for 2000 clocks.
module acme_spi_driver #(
    parameter int Core = 0,
    parameter string Name = "near",
    parameter string Config = "depth16"
) (
    input logic clk,
    input logic rst_n,
    output logic done_o
);
  import bitspan_pkg::*;
  chandle model;
  string scene, settings;
  int width, height;
  longint limit;
  longint rows, next, row[42], constants[6];
  int quiet;
  logic req_vld, req_rdy, pix_vld, pix_rdy;
  logic [63:0] req_b, req_x, req_n, req_l[8], req_r[8];
  int left[8], right[8];

  acme_spi #(.Core(Core)) u_dut (.*, .pix_last(), .pix_x(), .pix_h(), .pix_fu(), .pix_fv(), .pix_m(),
      .pix_e(), .pix_u(), .pix_v(), .pix_rgba());

  function automatic int column(input string name);
    automatic int at = bitspan_column(model, StageEdgeWalk, name);
    if (at < 0) $fatal(1, "%s", bitspan_last_error());
    return at;
  endfunction

  initial begin
    if ($value$plusargs("scene=%s", scene) == 0) scene = "demo";
    if ($value$plusargs("settings=%s", settings) == 0) settings = "";
    if ($value$plusargs("width=%d", width) == 0) width = 96;
    if ($value$plusargs("height=%d", height) == 0) height = 72;
    model = bitspan_open(Name, Config, settings, "model");
    if (model == null) $fatal(1, "%s", bitspan_last_error());
    if (bitspan_draw(model, scene, width, height) != 0) $fatal(1, "%s", bitspan_last_error());
    if (bitspan_fetch(model, StageConstants, 0, constants) != 0) $fatal(1, "%s", bitspan_last_error());
    req_b = constants[bitspan_column(model, StageConstants, "b")];
    left = '{column("l_x"), column("l_h"), column("l_u"), column("l_v"), column("l_r"), column("l_g"), column("l_b"),
             column("l_a")};
    right = '{column("r_x"), column("r_h"), column("r_u"), column("r_v"), column("r_r"), column("r_g"), column("r_b"),
              column("r_a")};
    rows = bitspan_records(model, StageEdgeWalk);
    if ($value$plusargs("rows=%d", limit) != 0 && limit < rows) rows = limit;
  end

  always @(posedge clk) begin
    if (!rst_n) begin
      req_vld <= 1'b0;
      pix_rdy <= 1'b0;
      quiet <= 0;
    end else begin
      if (!req_vld || req_rdy) begin
        req_vld <= 1'b0;
        if (next < rows && $urandom_range(3) != 0) begin
          if (bitspan_fetch(model, StageEdgeWalk, next, row) != 0) $fatal(1, "%s", bitspan_last_error());
          req_vld <= 1'b1;
          req_x <= row[column("x_first")];
          req_n <= row[column("x_last")] - row[column("x_first")] + 1;
          for (int i = 0; i < 8; i++) begin
            req_l[i] <= row[left[i]];
            req_r[i] <= row[right[i]];
          end
          next <= next + 1;
        end
      end
      pix_rdy <= $urandom_range(3) != 0;
      quiet <= req_vld || pix_vld ? 0 : quiet + 1;
    end
  end
  assign done_o = next == rows && quiet >= 2000;
endmodule

module acme_spi_tb;
  logic clk = 1'b0;
  logic rst_n = 1'b0;
  logic near_done, far_done;
  acme_spi_driver #(.Core(0), .Name("near"), .Config("depth16")) u_near (.clk, .rst_n, .done_o(near_done));
  acme_spi_driver #(.Core(1), .Name("far"), .Config("depth20")) u_far (.clk, .rst_n, .done_o(far_done));
  always #5 clk = ~clk;
  initial begin
    repeat (4) @(posedge clk);
    @(negedge clk) rst_n = 1'b1;
    wait (near_done && far_done);
    $finish;
  end
endmodule
