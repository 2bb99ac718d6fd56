// SPDX-License-Identifier: Apache-2.0
// The span interpolator under Icarus: records and expected values from files, random gaps and stalls.
//
//   vvp icarus_tb.vvp +inputs=FILE +spans=FILE +pixels=FILE [+seed=N]
//
// One line per record, its fields in hexadecimal in the order of tb/rtl_abi.hpp. After the last pixel it runs on until the
// interpolator must be empty. It ends with $fatal where a value differs, a span or pixel comes that no file has, a file is
// not as expected or nothing moves, and else prints how many values were compared.
module icarus_tb;
  localparam int PatienceClocks = 20000;
  // From the acceptance of a record of one pixel to that pixel's transfer: nothing is inside for longer.
  localparam int ClocksUntilEmpty = bitspan_cfg_pkg::SpanSetupClocks + 1 +
      bitspan_cfg_pkg::PixelInterval + bitspan_cfg_pkg::SpanClocks;


  logic clk, rst_n;
  logic in_valid, in_ready, out_valid, out_ready, span_take;

  // Inputs: the record offered.
  logic [bitspan_cfg_pkg::SetupBW-1:0] b;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] x_first;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] count;
  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_l;
  logic [bitspan_cfg_pkg::EdgeXW-1:0] x_r;
  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_l;
  logic [bitspan_cfg_pkg::EdgeHW-1:0] h_r;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_l;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] u_r;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_l;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] v_r;
  logic [bitspan_cfg_pkg::PhaseW-1:0] phase;
  logic [bitspan_cfg_pkg::PlaneKW-1:0] k;
  logic [bitspan_cfg_pkg::SpanHW-1:0] h;
  logic [bitspan_cfg_pkg::SpanFW-1:0] gu;
  logic [bitspan_cfg_pkg::SpanFW-1:0] gv;
  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step0;
  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gu_step1;
  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step0;
  logic [bitspan_cfg_pkg::SpanFStepW-1:0] gv_step1;
  logic [bitspan_cfg_pkg::SidesEndW-1:0] shade_l;
  logic [bitspan_cfg_pkg::SidesEndW-1:0] shade_r;
  logic [bitspan_cfg_pkg::SidesAccW-1:0] shade;
  logic [bitspan_cfg_pkg::SidesStepW-1:0] shade_step0;
  logic [bitspan_cfg_pkg::SidesStepW-1:0] shade_step1;
  // Outputs, and what the files expect.
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] pixel_x;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] want_pixel_x;
  logic pixel_step;
  logic want_pixel_step;
  logic pixel_last;
  logic want_pixel_last;
  logic [bitspan_cfg_pkg::SpanHW-1:0] pixel_h;
  logic [bitspan_cfg_pkg::SpanHW-1:0] want_pixel_h;
  logic [bitspan_cfg_pkg::TexAccW-1:0] pixel_fu;
  logic [bitspan_cfg_pkg::TexAccW-1:0] want_pixel_fu;
  logic [bitspan_cfg_pkg::TexAccW-1:0] pixel_fv;
  logic [bitspan_cfg_pkg::TexAccW-1:0] want_pixel_fv;
  logic [bitspan_cfg_pkg::PixelRecipOutW-1:0] pixel_recip_m;
  logic [bitspan_cfg_pkg::PixelRecipOutW-1:0] want_pixel_recip_m;
  logic [bitspan_cfg_pkg::ExponentW-1:0] pixel_recip_e;
  logic [bitspan_cfg_pkg::ExponentW-1:0] want_pixel_recip_e;
  logic [bitspan_cfg_pkg::SpanUvW-1:0] pixel_u;
  logic [bitspan_cfg_pkg::SpanUvW-1:0] want_pixel_u;
  logic [bitspan_cfg_pkg::SpanUvW-1:0] pixel_v;
  logic [bitspan_cfg_pkg::SpanUvW-1:0] want_pixel_v;
  logic [bitspan_cfg_pkg::SidesW-1:0] pixel_shade;
  logic [bitspan_cfg_pkg::SidesW-1:0] want_pixel_shade;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] span_x;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] want_span_x;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] span_count;
  logic [bitspan_cfg_pkg::PixelIndexW-1:0] want_span_count;
  logic [bitspan_cfg_pkg::RowRecipOutW-1:0] span_recip_m;
  logic [bitspan_cfg_pkg::RowRecipOutW-1:0] want_span_recip_m;
  logic [bitspan_cfg_pkg::ExponentW-1:0] span_recip_e;
  logic [bitspan_cfg_pkg::ExponentW-1:0] want_span_recip_e;
  logic [bitspan_cfg_pkg::PhaseW-1:0] span_phase;
  logic [bitspan_cfg_pkg::PhaseW-1:0] want_span_phase;
  logic [bitspan_cfg_pkg::SpanFDiffW-1:0] span_fu_diff;
  logic [bitspan_cfg_pkg::SpanFDiffW-1:0] want_span_fu_diff;
  logic [bitspan_cfg_pkg::SpanFDiffW-1:0] span_fv_diff;
  logic [bitspan_cfg_pkg::SpanFDiffW-1:0] want_span_fv_diff;
  logic [bitspan_cfg_pkg::SpanHW-1:0] span_h;
  logic [bitspan_cfg_pkg::SpanHW-1:0] want_span_h;
  logic [bitspan_cfg_pkg::SpanHStepW-1:0] span_h_step;
  logic [bitspan_cfg_pkg::SpanHStepW-1:0] want_span_h_step;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] span_u1;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] want_span_u1;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] span_v1;
  logic [bitspan_cfg_pkg::EdgeUvW-1:0] want_span_v1;
  logic [bitspan_cfg_pkg::TexAccW-1:0] span_fu;
  logic [bitspan_cfg_pkg::TexAccW-1:0] want_span_fu;
  logic [bitspan_cfg_pkg::TexAccW-1:0] span_fv;
  logic [bitspan_cfg_pkg::TexAccW-1:0] want_span_fv;
  logic [bitspan_cfg_pkg::TexStepW-1:0] span_fu_step0;
  logic [bitspan_cfg_pkg::TexStepW-1:0] want_span_fu_step0;
  logic [bitspan_cfg_pkg::TexStepW-1:0] span_fu_step1;
  logic [bitspan_cfg_pkg::TexStepW-1:0] want_span_fu_step1;
  logic [bitspan_cfg_pkg::TexStepW-1:0] span_fv_step0;
  logic [bitspan_cfg_pkg::TexStepW-1:0] want_span_fv_step0;
  logic [bitspan_cfg_pkg::TexStepW-1:0] span_fv_step1;
  logic [bitspan_cfg_pkg::TexStepW-1:0] want_span_fv_step1;
  logic [bitspan_cfg_pkg::SidesAccW-1:0] span_shade;
  logic [bitspan_cfg_pkg::SidesAccW-1:0] want_span_shade;
  logic [bitspan_cfg_pkg::SidesStepW-1:0] span_shade_step0;
  logic [bitspan_cfg_pkg::SidesStepW-1:0] want_span_shade_step0;
  logic [bitspan_cfg_pkg::SidesStepW-1:0] span_shade_step1;
  logic [bitspan_cfg_pkg::SidesStepW-1:0] want_span_shade_step1;

  span_interpolator u_dut (
      .clk_i(clk),
      .rst_ni(rst_n),
      .in_valid_i(in_valid),
      .in_ready_o(in_ready),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready),
      .span_take_o(span_take),
      .b_i(b),
      .x_first_i(x_first),
      .count_i(count),
      .x_l_i(x_l),
      .x_r_i(x_r),
      .h_l_i(h_l),
      .h_r_i(h_r),
      .u_l_i(u_l),
      .u_r_i(u_r),
      .v_l_i(v_l),
      .v_r_i(v_r),
      .phase_i(phase),
      .k_i(k),
      .h_i(h),
      .gu_i(gu),
      .gv_i(gv),
      .gu_step0_i(gu_step0),
      .gu_step1_i(gu_step1),
      .gv_step0_i(gv_step0),
      .gv_step1_i(gv_step1),
      .shade_l_i(shade_l),
      .shade_r_i(shade_r),
      .shade_i(shade),
      .shade_step0_i(shade_step0),
      .shade_step1_i(shade_step1),
      .x_o(pixel_x),
      .step_o(pixel_step),
      .last_o(pixel_last),
      .h_o(pixel_h),
      .fu_o(pixel_fu),
      .fv_o(pixel_fv),
      .recip_m_o(pixel_recip_m),
      .recip_e_o(pixel_recip_e),
      .u_o(pixel_u),
      .v_o(pixel_v),
      .shade_o(pixel_shade),
      .span_x_o(span_x),
      .span_count_o(span_count),
      .span_recip_m_o(span_recip_m),
      .span_recip_e_o(span_recip_e),
      .span_phase_o(span_phase),
      .span_fu_diff_o(span_fu_diff),
      .span_fv_diff_o(span_fv_diff),
      .span_h_o(span_h),
      .span_h_step_o(span_h_step),
      .span_u1_o(span_u1),
      .span_v1_o(span_v1),
      .span_fu_o(span_fu),
      .span_fv_o(span_fv),
      .span_fu_step0_o(span_fu_step0),
      .span_fu_step1_o(span_fu_step1),
      .span_fv_step0_o(span_fv_step0),
      .span_fv_step1_o(span_fv_step1),
      .span_shade_o(span_shade),
      .span_shade_step0_o(span_shade_step0),
      .span_shade_step1_o(span_shade_step1)
  );

  integer inputs_file, spans_file, pixels_file;
  integer seed, got, idle, records, spans, pixels;
  logic more;
  string name;

  function integer open(input string key);
    if (!$value$plusargs({key, "=%s"}, name)) $fatal(1, "icarus_tb: +%s=FILE is missing", key);
    open = $fopen(name, "r");
    if (open == 0) $fatal(1, "icarus_tb: %s cannot be read", name);
  endfunction

  // Whether a file has no further record.
  function logic at_end(input integer file);
    integer next;
    next = $fgetc(file);
    while (next == 10 || next == 13 || next == 32) next = $fgetc(file);
    at_end = next == -1;
    if (!at_end) next = $ungetc(next, file);
  endfunction

  initial begin
    inputs_file = open("inputs");
    spans_file = open("spans");
    pixels_file = open("pixels");
    if (!$value$plusargs("seed=%d", seed)) seed = 1;
    records = 0;
    spans = 0;
    pixels = 0;
    idle = 0;
    clk = 1'b0;
    in_valid = 1'b0;
    out_ready = 1'b0;
    rst_n = 1'b1;
    #1 rst_n = 1'b0;
    #1 clk = 1'b1;
    #1 clk = 1'b0;
    #1 rst_n = 1'b1;
    more = 1'b1;
    while (more) begin
      // Drive. A record once offered stays.
      if (!in_valid && $unsigned($random(seed)) % 4 != 0) begin
        got = $fscanf(inputs_file, "%h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h", b, x_first, count, x_l, x_r, h_l, h_r, u_l, u_r, v_l, v_r, phase, k, h, gu, gv, gu_step0, gu_step1, gv_step0, gv_step1, shade_l, shade_r, shade, shade_step0, shade_step1);
        if (got == 25) begin
          in_valid = 1'b1;
          records = records + 1;
        end else if (!$feof(inputs_file)) begin
          $fatal(1, "icarus_tb: inputs: record %0d is broken", records);
        end
      end
      out_ready = $unsigned($random(seed)) % 4 != 0;
      #1;
      // Sample.
      idle = idle + 1;
      if (span_take) begin
        idle = 0;
        got = $fscanf(spans_file, "%h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h", want_span_x, want_span_count, want_span_recip_m, want_span_recip_e, want_span_phase, want_span_fu_diff, want_span_fv_diff, want_span_h, want_span_h_step, want_span_u1, want_span_v1, want_span_fu, want_span_fv, want_span_fu_step0, want_span_fu_step1, want_span_fv_step0, want_span_fv_step1, want_span_shade, want_span_shade_step0, want_span_shade_step1);
        if (got != 20) $fatal(1, "icarus_tb: spans: no record %0d", spans);

        if (span_x !== want_span_x) $fatal(1, "span %0d: x is %h, expected %h", spans, span_x, want_span_x);
        if (span_count !== want_span_count) $fatal(1, "span %0d: count is %h, expected %h", spans, span_count, want_span_count);
        if (span_recip_m !== want_span_recip_m) $fatal(1, "span %0d: recip_m is %h, expected %h", spans, span_recip_m, want_span_recip_m);
        if (span_recip_e !== want_span_recip_e) $fatal(1, "span %0d: recip_e is %h, expected %h", spans, span_recip_e, want_span_recip_e);
        if (span_phase !== want_span_phase) $fatal(1, "span %0d: phase is %h, expected %h", spans, span_phase, want_span_phase);
        if (span_fu_diff !== want_span_fu_diff) $fatal(1, "span %0d: fu_diff is %h, expected %h", spans, span_fu_diff, want_span_fu_diff);
        if (span_fv_diff !== want_span_fv_diff) $fatal(1, "span %0d: fv_diff is %h, expected %h", spans, span_fv_diff, want_span_fv_diff);
        if (span_h !== want_span_h) $fatal(1, "span %0d: h is %h, expected %h", spans, span_h, want_span_h);
        if (span_h_step !== want_span_h_step) $fatal(1, "span %0d: h_step is %h, expected %h", spans, span_h_step, want_span_h_step);
        if (span_u1 !== want_span_u1) $fatal(1, "span %0d: u1 is %h, expected %h", spans, span_u1, want_span_u1);
        if (span_v1 !== want_span_v1) $fatal(1, "span %0d: v1 is %h, expected %h", spans, span_v1, want_span_v1);
        if (span_fu !== want_span_fu) $fatal(1, "span %0d: fu is %h, expected %h", spans, span_fu, want_span_fu);
        if (span_fv !== want_span_fv) $fatal(1, "span %0d: fv is %h, expected %h", spans, span_fv, want_span_fv);
        if (span_fu_step0 !== want_span_fu_step0) $fatal(1, "span %0d: fu_step0 is %h, expected %h", spans, span_fu_step0, want_span_fu_step0);
        if (span_fu_step1 !== want_span_fu_step1) $fatal(1, "span %0d: fu_step1 is %h, expected %h", spans, span_fu_step1, want_span_fu_step1);
        if (span_fv_step0 !== want_span_fv_step0) $fatal(1, "span %0d: fv_step0 is %h, expected %h", spans, span_fv_step0, want_span_fv_step0);
        if (span_fv_step1 !== want_span_fv_step1) $fatal(1, "span %0d: fv_step1 is %h, expected %h", spans, span_fv_step1, want_span_fv_step1);
        if (span_shade !== want_span_shade) $fatal(1, "span %0d: shade is %h, expected %h", spans, span_shade, want_span_shade);
        if (span_shade_step0 !== want_span_shade_step0) $fatal(1, "span %0d: shade_step0 is %h, expected %h", spans, span_shade_step0, want_span_shade_step0);
        if (span_shade_step1 !== want_span_shade_step1) $fatal(1, "span %0d: shade_step1 is %h, expected %h", spans, span_shade_step1, want_span_shade_step1);
        spans = spans + 1;
      end
      if (out_valid && out_ready) begin
        idle = 0;
        got = $fscanf(pixels_file, "%h %h %h %h %h %h %h %h %h %h %h", want_pixel_x, want_pixel_step, want_pixel_last, want_pixel_h, want_pixel_fu, want_pixel_fv, want_pixel_recip_m, want_pixel_recip_e, want_pixel_u, want_pixel_v, want_pixel_shade);
        if (got != 11) $fatal(1, "icarus_tb: pixels: no record %0d", pixels);

        if (pixel_x !== want_pixel_x) $fatal(1, "pixel %0d: x is %h, expected %h", pixels, pixel_x, want_pixel_x);
        if (pixel_step !== want_pixel_step) $fatal(1, "pixel %0d: step is %h, expected %h", pixels, pixel_step, want_pixel_step);
        if (pixel_last !== want_pixel_last) $fatal(1, "pixel %0d: last is %h, expected %h", pixels, pixel_last, want_pixel_last);
        if (pixel_h !== want_pixel_h) $fatal(1, "pixel %0d: h is %h, expected %h", pixels, pixel_h, want_pixel_h);
        if (pixel_fu !== want_pixel_fu) $fatal(1, "pixel %0d: fu is %h, expected %h", pixels, pixel_fu, want_pixel_fu);
        if (pixel_fv !== want_pixel_fv) $fatal(1, "pixel %0d: fv is %h, expected %h", pixels, pixel_fv, want_pixel_fv);
        if (pixel_recip_m !== want_pixel_recip_m) $fatal(1, "pixel %0d: recip_m is %h, expected %h", pixels, pixel_recip_m, want_pixel_recip_m);
        if (pixel_recip_e !== want_pixel_recip_e) $fatal(1, "pixel %0d: recip_e is %h, expected %h", pixels, pixel_recip_e, want_pixel_recip_e);
        if (pixel_u !== want_pixel_u) $fatal(1, "pixel %0d: u is %h, expected %h", pixels, pixel_u, want_pixel_u);
        if (pixel_v !== want_pixel_v) $fatal(1, "pixel %0d: v is %h, expected %h", pixels, pixel_v, want_pixel_v);
        if (pixel_shade !== want_pixel_shade) $fatal(1, "pixel %0d: shade is %h, expected %h", pixels, pixel_shade, want_pixel_shade);
        pixels = pixels + 1;
        more = !at_end(pixels_file);
      end
      if (idle > PatienceClocks) $fatal(1, "icarus_tb: stands still after %0d spans, %0d pixels", spans, pixels);
      got = in_ready;
      #1 clk = 1'b1;
      #1 clk = 1'b0;
      if (got != 0) in_valid = 1'b0;
    end
    if (records != spans) $fatal(1, "icarus_tb: %0d records, %0d spans", records, spans);
    if (!at_end(inputs_file)) $fatal(1, "icarus_tb: inputs: more than %0d records", records);
    if (!at_end(spans_file)) $fatal(1, "icarus_tb: spans: more than %0d records", spans);
    in_valid = 1'b0;
    out_ready = 1'b1;
    repeat (ClocksUntilEmpty) begin
      #1;
      if (span_take) $fatal(1, "icarus_tb: a span after the last of %0d", spans);
      if (out_valid) $fatal(1, "icarus_tb: a pixel after the last of %0d", pixels);
      #1 clk = 1'b1;
      #1 clk = 1'b0;
    end
    $display("icarus_tb: %0d spans, %0d pixels, %0d values equal", spans, pixels, 29 * spans + 14 * pixels);
    $finish;
  end
endmodule
