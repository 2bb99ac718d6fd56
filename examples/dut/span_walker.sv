// SPDX-License-Identifier: Apache-2.0
// A design under test with ports of its own: walks a span of examples/dut/affine.toml, one pixel per clock. All widths
// are those of that configuration. docs/dut.md compares it with bitspan.
module span_walker (
    input  logic clk,
    input  logic rst_n,
    // A span: first pixel, number of pixels; start and step per pixel of depth, texture coordinates and shades.
    input  logic span_valid,
    output logic span_ready,
    input  logic [15:0] span_x,
    input  logic [15:0] span_y,
    input  logic [15:0] span_count,
    input  logic [33:0] span_h,
    input  logic signed [37:0] span_dh,
    input  logic signed [32:0] span_u,
    input  logic signed [32:0] span_v,
    input  logic signed [33:0] span_du,
    input  logic signed [33:0] span_dv,
    input  logic [4*19-1:0] span_rgba,  // red is leftmost
    input  logic signed [23:0] span_drgba[4],
    // A pixel of it.
    output logic pixel_valid,
    input  logic pixel_ready,
    output logic [15:0] pixel_x,
    output logic [15:0] pixel_y,
    output logic pixel_last,
    output logic [33:0] pixel_h,
    output logic signed [24:0] pixel_u,
    output logic signed [24:0] pixel_v,
    output logic [4*13-1:0] pixel_rgba
);
  logic [15:0] left;
  logic signed [37:0] dh;
  logic signed [32:0] u, v;
  logic signed [33:0] du, dv;
  logic [18:0] shade[4];
  logic signed [23:0] dshade[4];

  // The next value of a register, saturated.
  function automatic logic [33:0] next_h(input logic [33:0] value, input logic signed [37:0] delta);
    automatic logic signed [39:0] sum = $signed({6'd0, value}) + 40'(delta);
    return (sum < 0) ? '0 : (sum > 40'sh3_ffff_ffff) ? '1 : sum[33:0];
  endfunction
  function automatic logic signed [32:0] next_uv(input logic signed [32:0] value, input logic signed [33:0] delta);
    automatic logic signed [34:0] sum = 35'(value) + 35'(delta);
    return (sum < -35'sh1_0000_0000) ? {1'b1, 32'd0} : (sum > 35'sh0_ffff_ffff) ? {1'b0, {32{1'b1}}} : sum[32:0];
  endfunction
  function automatic logic [18:0] next_shade(input logic [18:0] value, input logic signed [23:0] delta);
    automatic logic signed [24:0] sum = $signed({6'd0, value}) + 25'(delta);
    return (sum < 0) ? '0 : (sum > 25'sd524287) ? '1 : sum[18:0];
  endfunction
  // 16 fraction bits to 8, to the nearest, halves up, saturated.
  function automatic logic signed [24:0] rounded(input logic signed [32:0] value);
    automatic logic signed [33:0] sum = 34'(value) + 34'sd128;
    return (sum > 34'sh0_ffff_ffff) ? {1'b0, {24{1'b1}}} : sum[32:8];
  endfunction

  assign span_ready = !pixel_valid || (pixel_ready && pixel_last);
  assign pixel_last = left == 16'd1;
  assign pixel_u = rounded(u);
  assign pixel_v = rounded(v);
  for (genvar i = 0; i < 4; i++) begin : gen_shade
    assign pixel_rgba[13*(3-i)+:13] = shade[i][18:6];
  end

  always_ff @(posedge clk or negedge rst_n) begin
    if (!rst_n) begin
      pixel_valid <= 1'b0;
    end else if (span_ready) begin
      pixel_valid <= span_valid;
    end
  end
  always_ff @(posedge clk) begin
    if (span_ready) begin
      pixel_x <= span_x;
      pixel_y <= span_y;
      pixel_h <= span_h;
      left <= span_count;
      dh <= span_dh;
      u <= span_u;
      v <= span_v;
      du <= span_du;
      dv <= span_dv;
      for (int i = 0; i < 4; i++) begin
        shade[i] <= span_rgba[19*(3-i)+:19];
        dshade[i] <= span_drgba[i];
      end
    end else if (pixel_ready) begin
      pixel_x <= pixel_x + 16'd1;
      pixel_h <= next_h(pixel_h, dh);
      left <= left - 16'd1;
      u <= next_uv(u, du);
      v <= next_uv(v, dv);
      for (int i = 0; i < 4; i++) shade[i] <= next_shade(shade[i], dshade[i]);
    end
  end
endmodule
