// SPDX-License-Identifier: Apache-2.0
// A map: which ports of somebody's design carry which fields of which records. docs/dut.md has the format.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "engine/records.hpp"

namespace bitspan {

// A value on its way to a port of the design: a field of the record that is transferred, or of one above it.
struct DutField {
  RecordType type = RecordType::count;
  int index = -1;    // among fields_of(type); -1: `count` of edge_walk, which its record has not
  std::string name;  // for messages, as the map has it
};

struct DutPort {
  std::string name;
  // One field; or several, in the order of the map: of a packed port the first one stands leftmost, of an
  // unpacked array field i is the element with the i-th lowest index.
  std::vector<DutField> fields;
  bool array = false;
  int width = 0;  // bits per field; 0: not in the map
  int line = 1;
  std::string key;  // "output.ports.pix_u"
};

struct DutSide {
  RecordType stage = RecordType::count;
  std::string valid, ready;  // ready: empty where the map has none
  int valid_line = 1, ready_line = 1;
  std::vector<DutPort> ports;
};

struct DutMap {
  std::string origin;  // the file, for messages
  std::string top;
  std::string config;                // as the map has it; empty: any configuration
  std::vector<std::string> sources;  // as the map has them
  int sources_line = 1, config_line = 1, top_line = 1, parameters_line = 1;
  std::vector<std::pair<std::string, std::string>> parameters;  // value as in SystemVerilog
  std::string clock, reset;
  int clock_line = 1, reset_line = 1;
  bool reset_low = true;
  DutSide input, output;
};

// Throws InputError "file:line: key: what; legal: ..." for what is unknown, missing, twice there or of a
// wrong type.
DutMap parse_dut_map(std::string_view text, const std::string& origin);

// The bits of a field at a port: its register's, or what an index, a count or a flag of the RTL has.
struct PortWord {
  int bits = 0;
  bool is_signed = false;
  bool integer = false;
};
PortWord port_word(const DutField& field, const Config& config);

// Why the stages of the map do not exist in a configuration; empty where they do.
std::string refusal(const DutMap& map, const Config& config);

}  // namespace bitspan
