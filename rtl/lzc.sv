// SPDX-License-Identifier: Apache-2.0
// Zeros in front of the leading one of d_i, as a tree: each node joins the counts of two halves. Width where d_i is 0.
// Combinational.
module lzc #(
    parameter int Width = 8
) (
    input  logic [          Width-1:0] d_i,
    output logic [$clog2(Width+1)-1:0] zeros_o
);
  localparam int Levels = (Width > 1) ? $clog2(Width) : 1;
  localparam int Padded = 1 << Levels;
  // In heap order: node 1 is the root, nodes 2 n and 2 n + 1 are the upper and the lower half of node n. `none` tells
  // that all bits of a node are 0; `count` has the zeros in front of its first 1.
  logic [2*Padded-1:0] none;
  logic [Levels-1:0] count[2*Padded];
  // Icarus 11 may lose a continuous assignment from a word of an array, so the root's count is read below as well.
  logic [Levels-1:0] root;
  logic [Padded-1:0] padded;
  // Ones behind the end stop the count at Width.
  if (Padded == Width) begin : gen_as_is
    assign padded = d_i;
  end else begin : gen_padded
    assign padded = {d_i, {(Padded - Width) {1'b1}}};
  end
  always_comb begin
    none[0] = 1'b0;
    count[0] = '0;
    for (int k = 0; k < Padded; k++) begin
      none[Padded+k] = ~padded[Padded-1-k];
      count[Padded+k] = '0;
    end
    for (int level = 1; level <= Levels; level++) begin
      for (int n = Padded >> level; n < (2 * Padded) >> level; n++) begin
        none[n] = none[2*n] & none[2*n+1];
        count[n] = none[2*n] ? count[2*n+1] | Levels'(1 << (level - 1)) : count[2*n];
      end
    end
    root = count[1];
  end
  if (Padded == Width) begin : gen_full
    assign zeros_o = none[1] ? ($clog2(Width + 1))'(Width) : ($clog2(Width + 1))'(root);
  end else begin : gen_stopped
    assign zeros_o = ($clog2(Width + 1))'(root);
    logic unused;
    assign unused = none[1];
  end
  logic unused_root;
  assign unused_root = none[0];
endmodule
