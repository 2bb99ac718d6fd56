// SPDX-License-Identifier: Apache-2.0
// q_o is d_i, Depth enabled clocks later, as delay_line's; from 4 on the values wait in a small memory, which takes
// fewer cells than registers. Reset sets the place in the memory, not the data.
module ring_line #(
    parameter int Width = 8,
    parameter int Depth = 8
) (
    input  logic             clk_i,
    input  logic             rst_ni,
    input  logic             en_i,
    input  logic [Width-1:0] d_i,
    output logic [Width-1:0] q_o
);
  if (Depth < 4) begin : gen_registers
    delay_line #(
        .Width(Width),
        .Depth(Depth)
    ) u_line (
        .clk_i,
        .en_i,
        .d_i,
        .q_o
    );
    logic unused;
    assign unused = rst_ni;
  end else begin : gen_memory
    // A place is read, and then overwritten, once per Places enabled clocks; the output register is the last clock.
    localparam int Places = Depth - 1;
    localparam int PlaceW = $clog2(Places);
    (* ram_style = "distributed" *)
    logic [Width-1:0] memory[Places];
    logic [PlaceW-1:0] place_q;
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) place_q <= '0;
      else if (en_i) place_q <= (place_q == PlaceW'(Places - 1)) ? '0 : place_q + PlaceW'(1);
    end
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        q_o <= memory[place_q];
        memory[place_q] <= d_i;
      end
    end
  end

`ifndef SYNTHESIS
  initial begin
    assert (Width >= 1 && Depth >= 0)
    else $fatal(1, "ring_line: Width must be positive, Depth not negative");
  end
`endif
endmodule
