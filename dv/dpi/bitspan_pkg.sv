// SPDX-License-Identifier: Apache-2.0
// bitspan's C library in SystemVerilog, through DPI-C: bitspan_dpi.cpp has the functions. docs/dv.md shows a bench.
//
// An int that is returned is a status: 0 where the call did what it should, else bitspan_last_error() says in one line
// what was wrong. A record is an open array of longint, one element per column of its
// stage; it may be longer. Verilator 5.006 takes no dynamic array for it.
package bitspan_pkg;
  localparam int StageConstants = 0;
  localparam int StageSetup = 1;
  localparam int StageSetupEdge = 2;
  localparam int StageEdgeWalk = 3;
  localparam int StagePlaneWalk = 4;
  localparam int StagePlaneWalkRow = 5;
  localparam int StageSpanSetup = 6;
  localparam int StageSpan = 7;
  localparam int StageDepth = 8;
  localparam int StageTexture = 9;
  localparam int StageFog = 10;
  localparam int StageMerge = 11;
  localparam int StageState = 12;
  localparam int StageStencil = 13;
  localparam int StageMergeAlpha = 14;
  localparam int StageSetupGradient = 15;
  localparam int StageLod = 16;
  localparam int StageDistance = 17;
  localparam int StageSetupPlane = 18;
  localparam int StageTextureSecond = 19;
  localparam int StageSetupChannel = 20;
  localparam int StageEdgeWalkChannel = 21;
  localparam int StageSpanSetupChannel = 22;
  localparam int StageSpanChannel = 23;
  localparam int StageProject = 24;
  localparam int StageLight = 25;
  localparam int StageCandidate = 26;
  localparam int StageLineWalk = 27;
  // No stage has more columns.
  localparam int MaxColumns = 64;
  // bitspan_check: the design's record is not the model's.
  localparam int Different = 1;

  // A model under a name of your choice; null after a failure. configuration: a shipped name or a TOML file. settings:
  // "KEY=VALUE;KEY=VALUE", or "". engine: "model" or "golden".
  import "DPI-C" function chandle bitspan_open(input string name, input string configuration, input string settings,
                                               input string engine);
  // The open model of that name, or null.
  import "DPI-C" function chandle bitspan_find(input string name);
  // Frees the model. Its counts and its first divergence can still be asked for.
  import "DPI-C" function int bitspan_close(input chandle model);

  // Draws a scene: "demo", a .tri file or a mesh. A width and height of 0 are the scene's own.
  import "DPI-C" function int bitspan_draw(input chandle model, input string scene, input int width, input int height);
  // Begins that scene's picture without a triangle, and draws a row that the bench made: docs/c_api.md, "Rows".
  import "DPI-C" function int bitspan_begin(input chandle model, input string scene, input int width, input int height);
  import "DPI-C" function int bitspan_row(input chandle model, input int stage, input longint record[]);

  // Columns and number of a stage's records; -1 after a failure.
  import "DPI-C" function int bitspan_columns(input chandle model, input int stage);
  import "DPI-C" function longint bitspan_records(input chandle model, input int stage);
  // The column of a field, and of the i-th name in a list with spaces. -1: no such field; -2: behind the last name.
  import "DPI-C" function int bitspan_column(input chandle model, input int stage, input string field);
  import "DPI-C" function int bitspan_column_of(input chandle model, input int stage, input string fields, input int i);
  // Bits of a field's register, 0 for an index, a count or a flag; and whether it is signed. -1 after a failure.
  import "DPI-C" function int bitspan_word(input chandle model, input int stage, input int column);
  import "DPI-C" function int bitspan_is_signed(input chandle model, input int stage, input int column);
  // The value of a key of the configuration, such as "perspective.mode"; "" where it has none of that name.
  import "DPI-C" function string bitspan_setting(input chandle model, input string key);
  // Copies record i of the stage, as stimulus.
  import "DPI-C" function int bitspan_fetch(input chandle model, input int stage, input longint i,
                                            output longint record[]);

  // Compares the design's next record of the stage with the model's. Bit i of `present` tells that the design has
  // column i; the others are neither compared nor counted. Returns Different where a value differs.
  import "DPI-C" function int bitspan_check(input chandle model, input int stage, input longint record[],
                                            input longint present);
  // Values that were equal; those of them that are neither 0 nor the field's value in the record before; records that
  // no check has reached; records that differ. The first two must not be 0 at the end, the others must be.
  import "DPI-C" function longint bitspan_matched(input chandle model, input int stage);
  import "DPI-C" function longint bitspan_nontrivial(input chandle model, input int stage);
  import "DPI-C" function longint bitspan_unchecked(input chandle model, input int stage);
  import "DPI-C" function longint bitspan_different(input chandle model, input int stage);
  // The model's first difference in one line: record, triangle, pixel, field, and both values, raw and with their unit.
  import "DPI-C" function string bitspan_divergence(input chandle model);
  import "DPI-C" function string bitspan_last_error();
endpackage
