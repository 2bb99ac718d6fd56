// SPDX-License-Identifier: Apache-2.0
#include "tb/dut_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "config/toml_section.hpp"
#include "engine/sv_writer.hpp"

namespace bitspan {
namespace {

constexpr std::array input_stages{RecordType::row, RecordType::plane_row, RecordType::span};
constexpr std::array output_stages{RecordType::span, RecordType::fragment};

template <std::size_t N>
RecordType stage_at(const Section& section, const std::array<RecordType, N>& stages) {
  std::array<std::string_view, N> names;
  std::ranges::transform(stages, names.begin(), stage_of);
  return stages[section.one_of("stage", names)];
}

bool is_identifier(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '$'; });
}

std::string identifier(const Section& section, std::string_view key, const std::string& what) {
  std::string name = section.text(key, what);
  if (!is_identifier(name)) section.fail(key, fmt::format("\"{}\" is no name in SystemVerilog", name));
  return name;
}

// The fields of other records that go with a record: those of the scene, and in const_depth_rows what the
// row's triangle says of all its rows.
constexpr std::array<std::string_view, 2> plane_fields{"k", "major"};

std::string legal_fields(RecordType stage, bool input) {
  std::string out;
  for (const Field& field : fields_of(stage)) out += fmt::format("{}{}", out.empty() ? "" : ", ", field.name);
  if (!input) return out;
  if (stage == RecordType::row) out += ", count";
  for (const Field& field : fields_of(RecordType::constants))
    out += fmt::format(", constants.{}", field.name);
  if (stage != RecordType::row) {
    for (const std::string_view name : plane_fields) out += fmt::format(", plane_walk.{}", name);
  }
  return out;
}

std::optional<DutField> find_field(RecordType stage, bool input, const std::string& name) {
  if (const int at = field_index(stage, name); at >= 0) return DutField{stage, at, name};
  if (!input) return std::nullopt;
  if (stage == RecordType::row && name == "count") return DutField{stage, -1, name};
  for (const RecordType other : {RecordType::constants, RecordType::plane}) {
    const std::string front = std::string(stage_of(other)) + ".";
    if (!name.starts_with(front)) continue;
    const std::string field = name.substr(front.size());
    const bool of_plane = other == RecordType::plane;
    if (of_plane && (stage == RecordType::row || std::ranges::count(plane_fields, field) == 0)) continue;
    if (const int at = field_index(other, field); at >= 0) return DutField{other, at, name};
  }
  return std::nullopt;
}

class PortsReader {
 public:
  PortsReader(const Section& side, RecordType stage, bool input)
      : side_(side), stage_(stage), input_(input), path_(side.path_of("ports")) {}

  std::vector<DutPort> read() {
    const std::string legal = "a table, PORT = FIELD";
    const toml::node& node = side_.need("ports", legal);
    if (!node.is_table()) side_.wrong_type("ports", node, legal);
    for (const auto& [key, value] : *node.as_table()) {
      DutPort port;
      port.name = std::string(key.str());
      port.line = line_of(key.source());
      port.key = path_ + "." + port.name;
      if (!is_identifier(port.name)) fail(port, "is no name in SystemVerilog; expected a port of the design");
      read(port, value);
      ports_.push_back(std::move(port));
    }
    if (ports_.empty()) side_.fail("ports", "is empty; legal: " + legal);
    // In the order of the file, as messages and tables have them.
    std::ranges::stable_sort(ports_, {}, &DutPort::line);
    check_repeated();
    return std::move(ports_);
  }

 private:
  [[noreturn]] void fail(const DutPort& port, const std::string& what) const {
    side_.fail(port.line, port.key, what);
  }

  void read(DutPort& port, const toml::node& node) {
    if (node.is_string()) {
      add(port, node);
    } else if (node.is_array()) {
      port.array = true;
      add_all(port, *node.as_array());
    } else if (node.is_table()) {
      const toml::table& table = *node.as_table();
      const Section section(table, port.key, port.line, side_.origin(), {"field", "fields", "width"});
      if (section.has("field") == section.has("fields")) {
        fail(port, "expected either field or fields");
      }
      if (section.has("field")) {
        section.text("field", "a field");
        add(port, *table.get("field"));
      } else {
        add_all(port, section.array("fields", "fields, the first one leftmost"));
      }
      if (section.has("width")) port.width = static_cast<int>(section.integer("width", 1, 4096));
    } else {
      fail(port, fmt::format("is {}; legal: FIELD, [FIELD, ...], {{ field = FIELD, width = BITS }}, "
                             "{{ fields = [FIELD, ...], width = BITS }}",
                             type_name(node)));
    }
  }

  void add_all(DutPort& port, const toml::array& names) {
    if (names.empty()) fail(port, "has no field; expected at least one");
    for (const toml::node& name : names) add(port, name);
  }

  void add(DutPort& port, const toml::node& node) {
    if (!node.is_string()) fail(port, fmt::format("has {}; expected the name of a field", type_name(node)));
    const std::string& name = node.as_string()->get();
    const auto field = find_field(stage_, input_, name);
    if (!field) {
      fail(port, fmt::format("\"{}\" is no field of {}; legal: {}", name, stage_of(stage_),
                             legal_fields(stage_, input_)));
    }
    port.fields.push_back(*field);
  }

  // What two ports deliver could not be compared with one value.
  void check_repeated() const {
    if (input_) return;
    std::vector<std::pair<std::string, std::string>> seen;
    for (const DutPort& port : ports_) {
      for (const DutField& field : port.fields) {
        const auto at = std::ranges::find(seen, field.name, &std::pair<std::string, std::string>::first);
        if (at != seen.end()) {
          fail(port, fmt::format("field \"{}\" is also at port {}; expected once", field.name, at->second));
        }
        seen.emplace_back(field.name, port.name);
      }
    }
  }

  const Section& side_;
  RecordType stage_;
  bool input_;
  std::string path_;
  std::vector<DutPort> ports_;
};

template <std::size_t N>
DutSide read_side(const Section& root, std::string_view key, const std::array<RecordType, N>& stages) {
  const Section section = root.section(key, {"stage", "valid", "ready", "ports"});
  DutSide side;
  side.stage = stage_at(section, stages);
  side.valid = identifier(section, "valid", "a port of 1 bit");
  side.valid_line = section.line("valid");
  if (section.has("ready")) {
    side.ready = identifier(section, "ready", "a port of 1 bit");
    side.ready_line = section.line("ready");
  }
  side.ports = PortsReader(section, side.stage, key == "input").read();
  return side;
}

std::string parameter_text(const Section& section, std::string_view key, const toml::node& node) {
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* boolean = node.as_boolean()) return boolean->get() ? "1" : "0";
  if (const auto* text = node.as_string()) {
    if (text->get().find_first_of("\"\\\n") == std::string::npos) return '"' + text->get() + '"';
  }
  section.fail(key, "legal: an integer, true, false, or a string without quotes and backslashes");
}

std::vector<std::pair<std::string, std::string>> parameters(const Section& root) {
  std::vector<std::pair<std::string, std::string>> out;
  if (!root.has("parameters")) return out;
  const std::string legal = "a table, PARAMETER = VALUE";
  const toml::node& node = root.need("parameters", legal);
  if (!node.is_table()) root.wrong_type("parameters", node, legal);
  for (const auto& [key, value] : *node.as_table()) {
    const std::string name(key.str());
    if (!is_identifier(name)) root.fail("parameters", '"' + name + "\" is no name in SystemVerilog");
    out.emplace_back(name, parameter_text(root, "parameters", value));
  }
  return out;
}

}  // namespace

DutMap parse_dut_map(std::string_view text, const std::string& origin) {
  const toml::table table = parse_toml(text, origin, "is empty; expected a map of a design's ports");
  const Section root(
      table, "", 1, origin,
      {"top", "config", "sources", "parameters", "clock", "reset", "reset_active", "input", "output"});
  DutMap map;
  map.origin = origin;
  map.top = identifier(root, "top", "the name of a module");
  map.top_line = root.line("top");
  if (root.has("config")) map.config = root.text("config", "a shipped configuration or a TOML file");
  map.config_line = root.line("config");
  if (root.has("sources")) map.sources = root.texts("sources", "names of files");
  map.sources_line = root.line("sources");
  map.parameters = parameters(root);
  map.parameters_line = root.line("parameters");
  map.clock = identifier(root, "clock", "a port of 1 bit");
  map.clock_line = root.line("clock");
  map.reset = identifier(root, "reset", "a port of 1 bit");
  map.reset_line = root.line("reset");
  if (root.has("reset_active")) {
    constexpr std::array<std::string_view, 2> levels{"low", "high"};
    map.reset_low = root.one_of("reset_active", levels) == 0;
  }
  map.input = read_side(root, "input", input_stages);
  map.output = read_side(root, "output", output_stages);
  if (map.input.stage == map.output.stage) {
    root.section("output", {"stage", "valid", "ready", "ports"})
        .fail("stage", fmt::format("is \"{0}\", as input.stage; legal: a stage behind {0}",
                                   stage_of(map.output.stage)));
  }
  return map;
}

PortWord port_word(const DutField& field, const Config& config) {
  const int index = pixel_index_bits(config);
  if (field.index < 0) return {index, false, true};
  const Field& f = fields_of(field.type)[static_cast<std::size_t>(field.index)];
  if (const auto format = format_of(f, config)) return {std::max(1, format->word), format->is_signed, false};
  if (f.name.ends_with("recip_e")) return {exponent_bits, true, true};
  if (f.name == "covered" || f.name == "last" || f.name == "major") return {1, false, true};
  if (f.name.ends_with("edge")) return {2, false, true};
  if (f.name == "triangle") return {32, false, true};
  // The row of const_depth_rows may lie on either side of the picture's edge.
  if (f.name == "row") return {index + 2, true, true};
  return {index, false, true};
}

std::string refusal(const DutMap& map, const Config& config) {
  const bool planes = has_plane_rows(config.perspective);
  const RecordType rows = planes ? RecordType::plane_row : RecordType::row;
  const RecordType stage = map.input.stage;
  if (stage != RecordType::span && stage != rows) {
    return fmt::format("{} has no records of {}", to_string(config.perspective), stage_of(stage));
  }
  const auto of_plane = [](const DutPort& port) {
    return std::ranges::any_of(port.fields, [](const DutField& f) { return f.type == RecordType::plane; });
  };
  if (!planes && std::ranges::any_of(map.input.ports, of_plane)) {
    return fmt::format("{} has no records of plane_walk", to_string(config.perspective));
  }
  if (has_setup_plane(config) && stage != RecordType::span) {
    return "slope.row = plane starts rows from setup.plane, which a design has no port for";
  }
  return "";
}

}  // namespace bitspan
