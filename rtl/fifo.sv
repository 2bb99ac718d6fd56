// SPDX-License-Identifier: Apache-2.0
// A first-in first-out memory of Depth >= 1 entries. out_valid_o and in_ready_o depend on registers alone: a full FIFO
// takes nothing on the clock that empties it, and an empty one delivers a record on the clock after it came.
module fifo #(
    parameter int Width = 8,
    parameter int Depth = 2
) (
    input  logic             clk_i,
    input  logic             rst_ni,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [Width-1:0] in_i,
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic [Width-1:0] out_o
);
  if (Depth == 1) begin : gen_register
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) out_valid_o <= 1'b0;
      else out_valid_o <= out_valid_o ? !out_ready_i : in_valid_i;
    end
    assign in_ready_o = !out_valid_o;
    always_ff @(posedge clk_i) begin
      if (in_valid_i && !out_valid_o) out_o <= in_i;
    end
  end else begin : gen_memory
    localparam int PlaceW = (Depth > 1) ? $clog2(Depth) : 1;
    localparam int CountW = $clog2(Depth + 1);
    logic [Width-1:0] memory[Depth];
    logic [PlaceW-1:0] write_q, read_q;
    logic [CountW-1:0] count_q;
    logic in, out;
    assign in = in_valid_i && in_ready_o;
    assign out = out_valid_o && out_ready_i;
    assign out_o = memory[read_q];
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) begin
        count_q <= '0;
        write_q <= '0;
        read_q <= '0;
        in_ready_o <= 1'b1;
        out_valid_o <= 1'b0;
      end else begin
        // The flags are formed beside the count, not behind it.
        if (in && !out) begin
          count_q <= count_q + CountW'(1);
          in_ready_o <= count_q != CountW'(Depth - 1);
          out_valid_o <= 1'b1;
        end else if (out && !in) begin
          count_q <= count_q - CountW'(1);
          in_ready_o <= 1'b1;
          out_valid_o <= count_q != CountW'(1);
        end
        if (in) write_q <= (write_q == PlaceW'(Depth - 1)) ? '0 : write_q + PlaceW'(1);
        if (out) read_q <= (read_q == PlaceW'(Depth - 1)) ? '0 : read_q + PlaceW'(1);
      end
    end
    always_ff @(posedge clk_i) begin
      if (in) memory[write_q] <= in_i;
    end
  end

`ifndef SYNTHESIS
  initial begin
    assert (Width >= 1 && Depth >= 1)
    else $fatal(1, "fifo: Width and Depth must be positive");
  end
`endif
endmodule
