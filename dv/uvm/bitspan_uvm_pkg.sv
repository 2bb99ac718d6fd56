// SPDX-License-Identifier: Apache-2.0
// Elaborated, not simulated here: no simulator at hand has UVM. pyslang 12 reads and elaborates this file in the tests.
//
// Predictor, scoreboard and coverage for UVM 1.2, over dv/dpi/bitspan_pkg.sv. bitspan_env has them connected:
//
//   rows     analysis export: each bitspan_row_item that the design took, from a monitor at its input
//   pixels   analysis export: each bitspan_record_item that the design delivered, from a monitor at its output
//
// The model draws each row when it is written to `rows`, and so a row must be written before its pixels.
// examples/uvm has a test; docs/dv.md shows the start.
package bitspan_uvm_pkg;
  import uvm_pkg::*;
  import bitspan_pkg::*;
  `include "uvm_macros.svh"

  // The model, and what a bench agrees on with it. The test makes one, opens it, and puts it into uvm_config_db as "bitspan".
  class bitspan_model extends uvm_object;
    string model_name = "model";  // for bitspan_find
    string configuration = "depth16";
    string settings = "";  // "KEY=VALUE;KEY=VALUE"
    string engine = "model";
    string scene = "demo";  // has the size and the constants of the picture; its triangles are not drawn
    int width = 640;
    int height = 480;
    int row_stage = StageEdgeWalk;
    int pixel_stage = StageSpan;
    // Fields of pixel_stage that the design has, with spaces.
    string fields = "x u v";
    chandle handle;
    longint present;

    `uvm_object_utils(bitspan_model)

    function new(string name = "bitspan_model");
      super.new(name);
    endfunction

    function void open();
      handle = bitspan_open(model_name, configuration, settings, engine);
      if (handle == null) `uvm_fatal("BITSPAN", bitspan_last_error())
      must(bitspan_begin(handle, scene, width, height));
      present = 0;
      for (int i = 0; i < MaxColumns; i++) begin
        int column = bitspan_column_of(handle, pixel_stage, fields, i);
        if (column == -2) break;
        if (column < 0) `uvm_fatal("BITSPAN", bitspan_last_error())
        present[column] = 1'b1;
      end
    endfunction

    function void must(int status);
      if (status != 0) `uvm_fatal("BITSPAN", bitspan_last_error())
    endfunction

    // The column of a field of a stage, which must have it.
    function int column_of(int stage, string field);
      column_of = bitspan_column(handle, stage, field);
      if (column_of < 0) `uvm_fatal("BITSPAN", bitspan_last_error())
    endfunction

    // The least and the greatest raw value of a register; 0 and 0 for an index, a count or a flag.
    function void range_of(int stage, int column, output longint low, output longint high);
      int bits = bitspan_word(handle, stage, column);
      bit is_signed = bitspan_is_signed(handle, stage, column) == 1;
      low = is_signed && bits > 0 ? -(64'sd1 <<< (bits - 1)) : 0;
      high = bits > 0 ? (64'sd1 <<< (is_signed ? bits - 1 : bits)) - 1 : 0;
    endfunction
  endclass

  // A record of any stage: raw values by column, sign-extended.
  class bitspan_record_item extends uvm_sequence_item;
    longint value[MaxColumns];

    `uvm_object_utils(bitspan_record_item)

    function new(string name = "bitspan_record_item");
      super.new(name);
    endfunction

    virtual function void do_copy(uvm_object rhs);
      bitspan_record_item other;
      super.do_copy(rhs);
      if (!$cast(other, rhs)) `uvm_fatal("BITSPAN", "do_copy: no bitspan_record_item")
      value = other.value;
    endfunction

    virtual function bit do_compare(uvm_object rhs, uvm_comparer comparer);
      bitspan_record_item other;
      return $cast(other, rhs) && super.do_compare(rhs, comparer) && value == other.value;
    endfunction

    virtual function string convert2string();
      string text = "";
      foreach (value[i]) if (value[i] != 0) text = {text, $sformatf(" %0d:0x%0h", i, value[i])};
      return {"record", text};
    endfunction
  endclass

  // A row: a record of edge_walk or span_setup, as stimulus. Registers have any value of their formats, and the pixels
  // are inside the picture. Call about() before randomize().
  class bitspan_row_item extends uvm_sequence_item;
    rand longint value[MaxColumns];
    rand int unsigned first;
    rand int unsigned count;
    rand int unsigned line;
    int unsigned width = 1;
    int unsigned height = 1;
    longint low[MaxColumns], high[MaxColumns];
    // Columns; count_column is -1 where the stage has the last pixel instead.
    int first_column, last_column, count_column, line_column;

    constraint in_format {foreach (value[i]) if (low[i] != high[i]) value[i] inside {[low[i] : high[i]]};}
    constraint in_picture {
      first < width;
      count inside {[1 : width]};
      first + count <= width;
      line < height;
    }
    // Ends of the formats, where registers saturate, come as often as all the rest.
    constraint corners {foreach (value[i]) value[i] dist {low[i] := 1, high[i] := 1, 0 := 1, [low[i] : high[i]] :/ 3};}

    `uvm_object_utils(bitspan_row_item)

    function new(string name = "bitspan_row_item");
      super.new(name);
    endfunction

    function void about(bitspan_model model);
      foreach (value[i]) begin
        low[i] = 0;
        high[i] = 0;
      end
      for (int i = 0; i < bitspan_columns(model.handle, model.row_stage); i++)
        model.range_of(model.row_stage, i, low[i], high[i]);
      width = unsigned'(model.width);
      height = unsigned'(model.height);
      line_column = model.column_of(model.row_stage, "y");
      if (model.row_stage == StageEdgeWalk) begin
        first_column = model.column_of(model.row_stage, "x_first");
        last_column = model.column_of(model.row_stage, "x_last");
        count_column = -1;
      end else begin
        int phase = model.column_of(model.row_stage, "phase");  // which only const_depth_rows has
        low[phase] = 0;
        high[phase] = 0;
        first_column = model.column_of(model.row_stage, "x");
        count_column = model.column_of(model.row_stage, "count");
        last_column = -1;
      end
    endfunction

    function void post_randomize();
      foreach (value[i]) if (low[i] == high[i]) value[i] = low[i];
      value[first_column] = longint'(first);
      value[line_column] = longint'(line);
      if (count_column >= 0) value[count_column] = longint'(count);
      if (last_column >= 0) value[last_column] = longint'(first) + longint'(count) - 1;
    endfunction

    virtual function void do_copy(uvm_object rhs);
      bitspan_row_item other;
      super.do_copy(rhs);
      if (!$cast(other, rhs)) `uvm_fatal("BITSPAN", "do_copy: no bitspan_row_item")
      value = other.value;
    endfunction

    virtual function string convert2string();
      return $sformatf("row of %0d pixels at %0d %0d", count, first, line);
    endfunction
  endclass

  // Random rows.
  class bitspan_random_sequence extends uvm_sequence #(bitspan_row_item);
    bitspan_model model;
    int rows = 100;

    `uvm_object_utils(bitspan_random_sequence)

    function new(string name = "bitspan_random_sequence");
      super.new(name);
    endfunction

    virtual task body();
      repeat (rows) begin
        bitspan_row_item row = bitspan_row_item::type_id::create("row");
        row.about(model);
        start_item(row);
        if (row.randomize() == 0) `uvm_fatal("BITSPAN", "no row meets the constraints")
        finish_item(row);
      end
    endtask
  endclass

  // The rows of a scene, which a second model draws.
  class bitspan_scene_sequence extends uvm_sequence #(bitspan_row_item);
    bitspan_model model;

    `uvm_object_utils(bitspan_scene_sequence)

    function new(string name = "bitspan_scene_sequence");
      super.new(name);
    endfunction

    virtual task body();
      chandle drawn = bitspan_open({model.model_name, ".rows"}, model.configuration, model.settings, model.engine);
      if (drawn == null) `uvm_fatal("BITSPAN", bitspan_last_error())
      model.must(bitspan_draw(drawn, model.scene, model.width, model.height));
      for (longint i = 0; i < bitspan_records(drawn, model.row_stage); i++) begin
        bitspan_row_item row = bitspan_row_item::type_id::create("row");
        start_item(row);
        model.must(bitspan_fetch(drawn, model.row_stage, i, row.value));
        finish_item(row);
      end
      model.must(bitspan_close(drawn));
    endtask
  endclass

  // Has the model draw each row that the design took, and publishes the pixels that must follow.
  class bitspan_predictor extends uvm_subscriber #(bitspan_row_item);
    bitspan_model model;
    uvm_analysis_port #(bitspan_record_item) expected;
    longint published;

    `uvm_component_utils(bitspan_predictor)

    function new(string name, uvm_component parent);
      super.new(name, parent);
      expected = new("expected", this);
    endfunction

    virtual function void write(bitspan_row_item t);
      longint records;
      model.must(bitspan_row(model.handle, model.row_stage, t.value));
      records = bitspan_records(model.handle, model.pixel_stage);
      for (; published < records; published++) begin
        bitspan_record_item pixel = bitspan_record_item::type_id::create("pixel");
        model.must(bitspan_fetch(model.handle, model.pixel_stage, published, pixel.value));
        expected.write(pixel);
      end
    endfunction
  endclass

  // Checks each pixel that the design delivered, in order. It fails on a difference, on pixels that did not come, and
  // where nothing, or nothing non-trivial, has matched.
  class bitspan_scoreboard extends uvm_scoreboard;
    bitspan_model model;
    uvm_analysis_imp #(bitspan_record_item, bitspan_scoreboard) delivered;

    `uvm_component_utils(bitspan_scoreboard)

    function new(string name, uvm_component parent);
      super.new(name, parent);
      delivered = new("delivered", this);
    endfunction

    virtual function void write(bitspan_record_item t);
      int status = bitspan_check(model.handle, model.pixel_stage, t.value, model.present);
      if (status == Different) begin
        // The first one alone is told in full.
        if (bitspan_different(model.handle, model.pixel_stage) == 1)
          `uvm_error("BITSPAN", bitspan_divergence(model.handle))
      end else begin
        model.must(status);
      end
    endfunction

    virtual function void check_phase(uvm_phase phase);
      longint matched = bitspan_matched(model.handle, model.pixel_stage);
      longint nontrivial = bitspan_nontrivial(model.handle, model.pixel_stage);
      longint unchecked = bitspan_unchecked(model.handle, model.pixel_stage);
      longint different = bitspan_different(model.handle, model.pixel_stage);
      string counts = $sformatf("%0d values matched, %0d non-trivial, %0d records unchecked, %0d records differ", matched,
                                nontrivial, unchecked, different);
      super.check_phase(phase);
      if (matched == 0 || nontrivial == 0 || unchecked != 0 || different != 0)
        `uvm_error("BITSPAN", {"not verified: ", counts})
      else
        `uvm_info("BITSPAN", counts, UVM_LOW)
    endfunction
  endclass

  // Classes of a field's values, and the modes of the configuration. Sampled with what the design delivered.
  typedef enum int {DeltaF, Hyperbolic, Affine, ConstDepthRows} bitspan_perspective_e;
  typedef enum int {Inverse, Opengl, Linear} bitspan_depth_code_e;
  typedef enum int {Divide, Reciprocal} bitspan_slope_e;

  class bitspan_field_coverage;
    covergroup field_cg(string field_name, longint low, longint high) with function sample(
        longint value, longint previous, bitspan_perspective_e perspective);
      option.per_instance = 1;
      option.name = field_name;
      value_cp: coverpoint value {
        bins zero = {0};
        bins least = {low};
        bins greatest = {high};
        bins negative = {[low : -1]};
        bins positive = {[1 : high]};
      }
      change_cp: coverpoint (value == previous) {
        bins changes = {0};
        bins stays = {1};
      }
      perspective_cp: coverpoint perspective;
      value_in_mode: cross value_cp, perspective_cp;
    endgroup

    function new(string field_name, longint low, longint high);
      field_cg = new(field_name, low, high);
    endfunction
  endclass

  class bitspan_coverage extends uvm_subscriber #(bitspan_record_item);
    bitspan_model model;
    bitspan_field_coverage field[MaxColumns];  // null where the design does not have the field
    longint previous[MaxColumns];
    bitspan_perspective_e perspective;
    bitspan_depth_code_e depth_code;
    bitspan_slope_e row_slope, edge_slope;

    covergroup modes_cg;
      option.per_instance = 1;
      perspective_cp: coverpoint perspective;
      depth_code_cp: coverpoint depth_code;
      row_slope_cp: coverpoint row_slope;
      edge_slope_cp: coverpoint edge_slope;
      modes: cross perspective_cp, depth_code_cp, row_slope_cp;
    endgroup

    `uvm_component_utils(bitspan_coverage)

    function new(string name, uvm_component parent);
      super.new(name, parent);
      modes_cg = new();
    endfunction

    // Once the model is open.
    virtual function void start_of_simulation_phase(uvm_phase phase);
      super.start_of_simulation_phase(phase);
      for (int i = 0; i < bitspan_columns(model.handle, model.pixel_stage); i++) begin
        longint low, high;
        model.range_of(model.pixel_stage, i, low, high);
        if (model.present[i]) field[i] = new($sformatf("column %0d", i), low, high);
      end
      case (bitspan_setting(model.handle, "perspective.mode"))
        "delta_f": perspective = DeltaF;
        "hyperbolic": perspective = Hyperbolic;
        "affine": perspective = Affine;
        "const_depth_rows": perspective = ConstDepthRows;
        default: `uvm_error("BITSPAN", "perspective.mode: a mode that coverage does not know")
      endcase
      case (bitspan_setting(model.handle, "depth.code"))
        "inverse": depth_code = Inverse;
        "opengl": depth_code = Opengl;
        "linear": depth_code = Linear;
        default: `uvm_error("BITSPAN", "depth.code: a mode that coverage does not know")
      endcase
      row_slope = bitspan_setting(model.handle, "slope.row") == "divide" ? Divide : Reciprocal;
      edge_slope = bitspan_setting(model.handle, "slope.edge") == "divide" ? Divide : Reciprocal;
    endfunction

    virtual function void write(bitspan_record_item t);
      modes_cg.sample();
      foreach (field[i]) if (field[i] != null) field[i].field_cg.sample(t.value[i], previous[i], perspective);
      previous = t.value;
    endfunction
  endclass

  // The three of them, connected. The model comes from uvm_config_db, as "bitspan".
  class bitspan_env extends uvm_env;
    bitspan_model model;
    bitspan_predictor predictor;
    bitspan_scoreboard scoreboard;
    bitspan_coverage coverage;
    uvm_analysis_export #(bitspan_row_item) rows;
    uvm_analysis_export #(bitspan_record_item) pixels;

    `uvm_component_utils(bitspan_env)

    function new(string name, uvm_component parent);
      super.new(name, parent);
    endfunction

    virtual function void build_phase(uvm_phase phase);
      super.build_phase(phase);
      if (!uvm_config_db#(bitspan_model)::get(this, "", "bitspan", model))
        `uvm_fatal("BITSPAN", "uvm_config_db has no \"bitspan\"; expected a bitspan_model that is open")
      rows = new("rows", this);
      pixels = new("pixels", this);
      predictor = bitspan_predictor::type_id::create("predictor", this);
      scoreboard = bitspan_scoreboard::type_id::create("scoreboard", this);
      coverage = bitspan_coverage::type_id::create("coverage", this);
      predictor.model = model;
      scoreboard.model = model;
      coverage.model = model;
    endfunction

    virtual function void connect_phase(uvm_phase phase);
      super.connect_phase(phase);
      rows.connect(predictor.analysis_export);
      pixels.connect(scoreboard.delivered);
      pixels.connect(coverage.analysis_export);
    endfunction
  endclass
endpackage
