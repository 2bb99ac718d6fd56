// SPDX-License-Identifier: Apache-2.0
// s_o = a_i^2, Clocks enabled clocks later, by adders alone: a square is half of a product, and multipliers are few.
//
// Row k is a_k 2^(2k) (1 + 4 (a's bits above k)). The sum of the rows is a^2, where every pair of bits comes twice.
// Each clock adds neighbours. Node k of a level is the sum of 2^level rows, without the 2 k 2^level zeros at its end.
module square #(
    parameter int Width  = 16,
    parameter int Clocks = (Width > 1) ? $clog2(Width) : 1
) (
    input  logic               clk_i,
    input  logic               en_i,
    input  logic [  Width-1:0] a_i,
    output logic [2*Width-1:0] s_o
);
  localparam int Levels = (Width > 1) ? $clog2(Width) : 1;
  logic [2*Width-1:0] row[2*Width];
  logic [2*Width-1:0] sum_q[Levels*Width];
  for (genvar k = 0; k < 2 * Width; k++) begin : gen_row
    if (k < Width - 1) begin : gen_pairs
      assign row[k] = a_i[k] ? (2 * Width)'({a_i[Width-1:k+1], 2'b01}) : '0;
    end else if (k == Width - 1) begin : gen_top
      assign row[k] = (2 * Width)'(a_i[k]);
    end else begin : gen_none
      assign row[k] = '0;
    end
  end
  for (genvar level = 1; level <= Levels; level++) begin : gen_level
    localparam int Rows = 1 << level;
    for (genvar k = 0; k * Rows < Width; k++) begin : gen_node
      // The rows of this node see Left bits of a.
      localparam int Left = Width - k * Rows;
      localparam int SumW = (Left < Rows + 1) ? 2 * Left : Left + Rows + 1;
      localparam int LowW = Rows;
      localparam int Pair = (k * Rows + Rows / 2 < Width) ? 1 : 0;
      logic [2*Width-1:0] low, high;
      logic unused;
      assign unused = ^{low, high};
      if (level == 1) begin : gen_rows
        assign low = row[2*k];
        assign high = row[2*k+1];
      end else begin : gen_sums
        assign low = sum_q[(level-2)*Width+2*k];
        if (Pair != 0) begin : gen_high
          assign high = sum_q[(level-2)*Width+2*k+1];
        end else begin : gen_no_high
          assign high = '0;
        end
      end
      if (Pair != 0) begin : gen_add
        logic [SumW-LowW-1:0] upper;
        assign upper = (SumW - LowW)'(low >> LowW) + (SumW - LowW)'(high);
        always_ff @(posedge clk_i) begin
          if (en_i) sum_q[(level-1)*Width+k] <= (2 * Width)'({upper, low[LowW-1:0]});
        end
      end else begin : gen_pass
        always_ff @(posedge clk_i) begin
          if (en_i) sum_q[(level-1)*Width+k] <= low;
        end
      end
    end
  end
  // Icarus 11 loses a continuous assignment here.
  logic [2*Width-1:0] last;
  always_comb last = sum_q[(Levels-1)*Width];
  assign s_o = last;

`ifndef SYNTHESIS
  initial begin
    assert (Width >= 1 && Clocks == Levels)
    else $fatal(1, "square: has %0d clocks, told %0d", Levels, Clocks);
  end
`endif
endmodule
