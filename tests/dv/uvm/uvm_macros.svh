// SPDX-License-Identifier: Apache-2.0
// The macros of UVM 1.2 that bitspan_uvm_pkg.sv and its example use, as far as a parser needs them.
`define uvm_object_utils(T) \
  typedef uvm_pkg::uvm_object_registry #(T, `"T`") type_id; \
  virtual function string get_type_name(); return `"T`"; endfunction
`define uvm_component_utils(T) \
  typedef uvm_pkg::uvm_component_registry #(T, `"T`") type_id; \
  virtual function string get_type_name(); return `"T`"; endfunction
`define uvm_fatal(ID, MSG) begin uvm_pkg::uvm_report_fatal(ID, MSG); end
`define uvm_error(ID, MSG) begin uvm_pkg::uvm_report_error(ID, MSG); end
`define uvm_info(ID, MSG, LEVEL) begin uvm_pkg::uvm_report_info(ID, MSG, LEVEL); end
