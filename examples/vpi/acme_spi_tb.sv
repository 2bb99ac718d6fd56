// SPDX-License-Identifier: Apache-2.0
// examples/dpi under Icarus, through VPI: two configurations of acme_spi in one simulation. Each takes the rows of a
// scene from its model, with random gaps and stalls; a checker compares every pixel. docs/dv.md has the commands.
//
// Icarus simulates some 75 clocks of both designs per second, so the picture is small.
//
//   +scene=FILE +width=N +height=N +settings=KEY=VALUE +flip (a bug in the design) +rows=N (no more rows)
module acme_spi_driver #(
    parameter int Core = 0,
    parameter Name = "near",
    parameter Config = "depth16"
) (
    input logic clk,
    input logic rst_n,
    output logic done_o
);
  // The columns of the row's ends.
  int left[8], right[8];
  int model;
  string scene, settings;
  int width, height;
  longint limit, rows, next, row[64], constants[64];
  int quiet, x_first, x_last;
  logic req_vld, req_rdy, pix_vld, pix_rdy, pix_last;
  logic [63:0] req_b, req_x, req_n, req_l[8], req_r[8];
  logic [63:0] pix_x, pix_h, pix_fu, pix_fv, pix_m, pix_e, pix_u, pix_v;
  logic [255:0] pix_rgba;

  acme_spi #(.Core(Core)) u_dut (.*);

  bitspan_checker #(
      .Model(Name),
      .Fields("x last h fu fv recip_m recip_e u v r g b a"),
      .Count(13)
  ) u_bitspan (
      .clk_i(clk),
      .rst_ni(rst_n),
      .valid_i(pix_vld),
      .ready_i(pix_rdy),
      .values_i({pix_x, 63'd0, pix_last, pix_h, pix_fu, pix_fv, pix_m, pix_e, pix_u, pix_v, pix_rgba})
  );

  task stop;
    $fatal(1, "%0s", $bs_last_error());
  endtask

  initial begin
    if ($value$plusargs("scene=%s", scene) == 0) scene = "demo";
    if ($value$plusargs("settings=%s", settings) == 0) settings = "";
    if ($value$plusargs("width=%d", width) == 0) width = 16;
    if ($value$plusargs("height=%d", height) == 0) height = 12;
    next = 0;
    model = $bs_open(Name, Config, settings, "model");
    if (model == 0) stop;
    if ($bs_draw(model, scene, width, height) != 0) stop;
    if ($bs_fetch(model, "constants", 0, constants) != 0) stop;
    req_b = constants[$bs_column(model, "constants", "b")];
    for (int i = 0; i < 8; i = i + 1) begin
      left[i] = $bs_column_of(model, "edge_walk", "l_x l_h l_u l_v l_r l_g l_b l_a", i);
      right[i] = $bs_column_of(model, "edge_walk", "r_x r_h r_u r_v r_r r_g r_b r_a", i);
    end
    x_first = $bs_column(model, "edge_walk", "x_first");
    x_last = $bs_column(model, "edge_walk", "x_last");
    rows = $bs_records(model, "edge_walk");
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
          if ($bs_fetch(model, "edge_walk", next, row) != 0) stop;
          req_vld <= 1'b1;
          req_x <= row[x_first];
          req_n <= row[x_last] - row[x_first] + 1;
          for (int i = 0; i < 8; i = i + 1) begin
            req_l[i] <= row[left[i]];
            req_r[i] <= row[right[i]];
          end
          next = next + 1;
        end
      end
      pix_rdy <= $urandom_range(3) != 0;
      quiet <= req_vld || pix_vld ? 0 : quiet + 1;
    end
  end
  assign done_o = next == rows && quiet >= 400;
endmodule

module acme_spi_tb;
  logic clk = 1'b0;
  logic rst_n = 1'b0;
  wire near_done, far_done;
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
