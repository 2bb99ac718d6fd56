// SPDX-License-Identifier: Apache-2.0
// The classes of UVM 1.2 that bitspan_uvm_pkg.sv and its example use: their names, parameters and signatures are those of
// UVM, and their bodies do nothing.
package uvm_pkg;
  typedef enum int {UVM_NONE = 0, UVM_LOW = 100, UVM_MEDIUM = 200, UVM_HIGH = 300} uvm_verbosity;

  function void uvm_report_fatal(string id, string message);
  endfunction
  function void uvm_report_error(string id, string message);
  endfunction
  function void uvm_report_info(string id, string message, int verbosity);
  endfunction

  virtual class uvm_void;
  endclass

  class uvm_comparer;
  endclass

  virtual class uvm_object extends uvm_void;
    function new(string name = "");
    endfunction
    virtual function string get_type_name();
      return "";
    endfunction
    virtual function string convert2string();
      return "";
    endfunction
    virtual function void do_copy(uvm_object rhs);
    endfunction
    virtual function bit do_compare(uvm_object rhs, uvm_comparer comparer);
      return 1'b1;
    endfunction
  endclass

  class uvm_phase extends uvm_object;
    virtual function void raise_objection(uvm_object obj, string description = "", int count = 1);
    endfunction
    virtual function void drop_objection(uvm_object obj, string description = "", int count = 1);
    endfunction
  endclass

  virtual class uvm_component extends uvm_object;
    function new(string name, uvm_component parent);
      super.new(name);
    endfunction
    virtual function void build_phase(uvm_phase phase);
    endfunction
    virtual function void connect_phase(uvm_phase phase);
    endfunction
    virtual function void start_of_simulation_phase(uvm_phase phase);
    endfunction
    virtual task run_phase(uvm_phase phase);
    endtask
    virtual function void check_phase(uvm_phase phase);
    endfunction
  endclass

  class uvm_object_registry #(type T = uvm_object, string Tname = "");
    static function T create(string name = "", uvm_component parent = null, string contxt = "");
      T made = new(name);
      return made;
    endfunction
  endclass

  class uvm_component_registry #(type T = uvm_component, string Tname = "");
    static function T create(string name, uvm_component parent, string contxt = "");
      T made = new(name, parent);
      return made;
    endfunction
  endclass

  class uvm_config_db #(type T = int);
    static function bit get(uvm_component cntxt, string inst_name, string field_name, inout T value);
      return 1'b1;
    endfunction
    static function void set(uvm_component cntxt, string inst_name, string field_name, T value);
    endfunction
  endclass

  virtual class uvm_port_base #(type T = int) extends uvm_void;
    virtual function void connect(uvm_port_base #(T) provider);
    endfunction
  endclass

  class uvm_analysis_port #(type T = int) extends uvm_port_base #(T);
    function new(string name, uvm_component parent);
    endfunction
    function void write(T t);
    endfunction
  endclass

  class uvm_analysis_export #(type T = int) extends uvm_port_base #(T);
    function new(string name, uvm_component parent = null);
    endfunction
  endclass

  class uvm_analysis_imp #(type T = int, type IMP = int) extends uvm_port_base #(T);
    local IMP m_imp;
    function new(string name, IMP imp);
      m_imp = imp;
    endfunction
    function void write(T t);
      m_imp.write(t);
    endfunction
  endclass

  virtual class uvm_subscriber #(type T = int) extends uvm_component;
    typedef uvm_subscriber #(T) this_type;
    uvm_analysis_imp #(T, this_type) analysis_export;
    function new(string name, uvm_component parent);
      super.new(name, parent);
      analysis_export = new("analysis_imp", this);
    endfunction
    pure virtual function void write(T t);
  endclass

  virtual class uvm_scoreboard extends uvm_component;
    function new(string name, uvm_component parent);
      super.new(name, parent);
    endfunction
  endclass

  virtual class uvm_env extends uvm_component;
    function new(string name = "env", uvm_component parent = null);
      super.new(name, parent);
    endfunction
  endclass

  virtual class uvm_test extends uvm_component;
    function new(string name, uvm_component parent);
      super.new(name, parent);
    endfunction
  endclass

  class uvm_sequence_item extends uvm_object;
    function new(string name = "uvm_sequence_item");
      super.new(name);
    endfunction
  endclass

  class uvm_sequencer #(type REQ = uvm_sequence_item, type RSP = REQ) extends uvm_component;
    function new(string name, uvm_component parent = null);
      super.new(name, parent);
    endfunction
  endclass

  virtual class uvm_sequence #(type REQ = uvm_sequence_item, type RSP = REQ) extends uvm_sequence_item;
    function new(string name = "uvm_sequence");
      super.new(name);
    endfunction
    virtual task start(uvm_component sequencer, uvm_sequence_item parent_sequence = null);
    endtask
    virtual task start_item(uvm_sequence_item item);
    endtask
    virtual task finish_item(uvm_sequence_item item);
    endtask
    virtual task body();
    endtask
  endclass
endpackage
