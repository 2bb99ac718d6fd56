// SPDX-License-Identifier: Apache-2.0
// The agent that examples/uvm leaves to its reader, and a module that makes the test.
package acme_pkg;
  import uvm_pkg::*;
  import bitspan_uvm_pkg::*;
  `include "uvm_macros.svh"
  class acme_agent extends uvm_component;
    uvm_analysis_port #(bitspan_row_item) taken;
    uvm_analysis_port #(bitspan_record_item) delivered;
    uvm_sequencer #(bitspan_row_item) sequencer;
    `uvm_component_utils(acme_agent)
    function new(string name, uvm_component parent);
      super.new(name, parent);
      taken = new("taken", this);
      delivered = new("delivered", this);
      sequencer = new("sequencer", this);
    endfunction
  endclass
  `include "acme_test.sv"
endpackage

module top;
  import acme_pkg::*;
  import bitspan_uvm_pkg::*;
  initial begin
    automatic acme_test test = new("test", null);
    automatic bitspan_scene_sequence scene = new("scene");
  end
endmodule
