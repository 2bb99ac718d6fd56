// SPDX-License-Identifier: Apache-2.0
// Elaborated, not simulated here. `acme_agent` is yours: it drives bitspan_row items into the design, and its monitors
// write what the design took to `taken`, and what it delivered to `delivered`.
class acme_test extends uvm_test;
  `uvm_component_utils(acme_test)
  bitspan_model model = new("model");
  bitspan_env env;
  acme_agent agent;
  function new(string name, uvm_component parent);
    super.new(name, parent);
  endfunction
  function void build_phase(uvm_phase phase);
    model.fields = "x last h u v";
    model.open();
    uvm_config_db#(bitspan_model)::set(this, "*", "bitspan", model);
    env = bitspan_env::type_id::create("env", this);
    agent = acme_agent::type_id::create("agent", this);
  endfunction
  function void connect_phase(uvm_phase phase);
    agent.taken.connect(env.rows);
    agent.delivered.connect(env.pixels);
  endfunction
  task run_phase(uvm_phase phase);
    bitspan_random_sequence rows = bitspan_random_sequence::type_id::create("rows");
    phase.raise_objection(this);
    rows.model = model;
    rows.start(agent.sequencer);
    phase.drop_objection(this);
  endtask
endclass
