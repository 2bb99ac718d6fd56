// SPDX-License-Identifier: Apache-2.0
#include "tb/dut_wrapper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string_view>

#include "config/fnv.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "tb/programs.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

// A port as it is declared.
struct DesignPort {
  std::string name, direction;  // "input", "output", "inout"
  int bits = 0;                 // 0: none that a vector could drive
  int left = 0, right = 0;      // of an unpacked array of such
  int dimensions = 0;           // unpacked
  int elements() const { return std::abs(left - right) + 1; }
};

struct Elaborated {
  std::vector<DesignPort> ports;
  std::vector<fs::path> files;
};

// An element of Verilator's XML, which has one per line.
class Element {
 public:
  explicit Element(std::string_view line) {
    const std::size_t open = line.find('<');
    if (open == std::string_view::npos) return;
    text_ = line.substr(open + 1);
    tag_ = text_.substr(0, text_.find_first_of(" />", 1));
  }
  std::string_view tag() const { return tag_; }
  std::string get(std::string_view attribute) const {
    const std::string front = fmt::format(" {}=\"", attribute);
    const std::size_t at = text_.find(front);
    if (at == std::string_view::npos) return "";
    const std::size_t from = at + front.size();
    std::string out(text_.substr(from, text_.find('"', from) - from));
    for (const auto& [code, character] :
         {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&apos;", "'"}, {"&quot;", "\""}, {"&amp;", "&"}}) {
      for (std::size_t i = 0; (i = out.find(code, i)) != std::string::npos; ++i)
        out.replace(i, std::string_view(code).size(), character);
    }
    return out;
  }
  int number(std::string_view attribute) const { return std::atoi(get(attribute).c_str()); }

 private:
  std::string_view text_, tag_;
};

// The numbers of a range are constants as "32'sh1f".
int range_value(const std::string& literal) {
  const std::size_t h = literal.find('h');
  if (h == std::string::npos) return 0;
  std::uint32_t bits = 0;
  std::from_chars(literal.data() + h + 1, literal.data() + literal.size(), bits, 16);
  return static_cast<int>(bits);
}

struct Type {
  std::string tag, sub;
  int bits = 0;
  std::vector<std::string> members;
  std::vector<int> range;
};
using Types = std::map<std::string, Type>;

int packed_bits(const Types& types, const std::string& id) {
  const auto at = types.find(id);
  if (at == types.end()) return 0;
  const Type& type = at->second;
  if (type.tag == "basicdtype") return type.bits;
  if (type.tag == "refdtype" || type.tag == "enumdtype") return packed_bits(types, type.sub);
  if (type.tag == "packarraydtype" && type.range.size() == 2) {
    return packed_bits(types, type.sub) * (std::abs(type.range[0] - type.range[1]) + 1);
  }
  if (type.tag == "structdtype" && !type.members.empty()) {
    int bits = 0;
    for (const std::string& member : type.members) bits += packed_bits(types, member);
    return bits;
  }
  return 0;
}

void set_type(DesignPort& port, const Types& types, std::string id) {
  for (auto at = types.find(id); at != types.end(); at = types.find(id)) {
    const Type& type = at->second;
    if (type.tag == "unpackarraydtype" && type.range.size() == 2) {
      port.left = type.range[0];
      port.right = type.range[1];
      ++port.dimensions;
    } else if (type.tag != "refdtype") {
      break;
    }
    id = type.sub;
  }
  port.bits = packed_bits(types, id);
}

Elaborated read_xml(const std::string& xml, const fs::path& folder) {
  Elaborated out;
  Types types;
  std::vector<std::string> type_of_port;
  bool top = false;
  Type* type = nullptr;
  std::istringstream in(xml);
  for (std::string line; std::getline(in, line);) {
    const Element e(line);
    const std::string tag(e.tag());
    if (tag == "file") {
      const std::string name = e.get("filename");
      const fs::path path = folder / name;
      const bool known = std::ranges::count(out.files, path) != 0;
      // Behind an include, Verilator also lists its own input, and a name with a space in part.
      std::error_code ignored;
      if (!known && fs::is_regular_file(path, ignored)) out.files.push_back(path);
    } else if (tag == "module") {
      top = e.get("topModule") == "1";
    } else if (tag == "/module") {
      top = false;
    } else if (tag == "var" && top && !e.get("dir").empty() && !e.get("pinIndex").empty()) {
      out.ports.push_back({.name = e.get("origName"), .direction = e.get("dir")});
      type_of_port.push_back(e.get("dtype_id"));
    } else if (tag.ends_with("dtype") && tag != "memberdtype") {
      type = &types[e.get("id")];
      type->tag = tag;
      type->sub = e.get("sub_dtype_id");
      const std::string kind = e.get("name");
      if (kind != "real" && kind != "string" && kind != "shortreal" && kind != "chandle") {
        type->bits = std::abs(e.number("left") - e.number("right")) + 1;
      }
    } else if (tag == "memberdtype" && type != nullptr) {
      type->members.push_back(e.get("sub_dtype_id"));
    } else if (tag == "const" && type != nullptr && type->range.size() < 2) {
      type->range.push_back(range_value(e.get("name")));
    }
  }
  for (std::size_t i = 0; i < out.ports.size(); ++i) set_type(out.ports[i], types, type_of_port[i]);
  std::ranges::sort(out.files);
  return out;
}

// Verilator's first error with its place, in one line.
std::string complaint(const fs::path& log) {
  std::istringstream in(read_text(log));
  std::string first;
  int errors = 0;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("%Error") || line.find("Exiting due to") != std::string::npos) continue;
    ++errors;
    if (first.empty()) first = line.substr(std::min(line.size(), line.find(": ") + 2));
  }
  if (errors > 1) first += fmt::format(" (the first of {} errors)", errors);
  return first.empty() ? "no reason is given" : first;
}

std::vector<std::string> design_words(const DutDesign& design) {
  // Delays are of no meaning between clock edges, and older designs have them on every register.
  std::vector<std::string> words = {"--no-timing", "-Wno-lint", "-Wno-style", "-Wno-fatal"};
  std::set<fs::path> folders;
  for (const fs::path& source : design.sources) folders.insert(source.parent_path());
  for (const fs::path& folder : folders) words.push_back("-I" + folder.string());
  for (const fs::path& source : design.sources) {
    if (source.extension() == ".f") words.emplace_back("-F");
    words.push_back(source.string());
  }
  return words;
}

void run_verilator(const std::vector<std::string>& words, const DutDesign& design, const fs::path& folder,
                   const fs::path& package) {
  std::vector<std::string> command = {"verilator", "--Mdir", (folder / "obj").string()};
  command.insert(command.end(), words.begin(), words.end());
  command.push_back(package.string());
  const std::vector<std::string> more = design_words(design);
  command.insert(command.end(), more.begin(), more.end());
  const fs::path log = folder / "verilator.log";
  if (run_program(command, log, "dut:" + design.name) != 0) throw InputError(complaint(log));
}

Elaborated elaborate(const DutDesign& design, const std::string& package) {
  for (const fs::path& source : design.sources) {
    std::error_code error;
    if (fs::is_regular_file(source, error)) continue;
    throw InputError(fmt::format("{}:{}: sources: {} is no file; expected a source of {}", design.map.origin,
                                 design.map.sources_line, source.string(), design.map.top));
  }
  if (design.sources.empty()) {
    throw InputError(fmt::format("{}:{}: sources: missing; expected the files of {}", design.map.origin,
                                 design.map.sources_line, design.map.top));
  }
  const ScratchFolder folder = temporary_scratch_folder("bitspan-dut");
  const fs::path package_path = folder / "package.sv";
  write_text(package_path, package);
  const fs::path xml = folder / "design.xml";
  std::vector<std::string> words = {"--xml-only", "--xml-output", xml.string(), "--top-module",
                                    design.map.top};
  for (const auto& [name, value] : design.map.parameters) words.push_back("-G" + name + "=" + value);
  try {
    run_verilator(words, design, folder.path(), package_path);
  } catch (const InputError& error) {
    const std::string_view what = error.what();
    if (what.find("--top-module") != std::string_view::npos) {
      throw InputError(fmt::format("{}:{}: top: no module {} in the sources; expected one of their modules",
                                   design.map.origin, design.map.top_line, design.map.top));
    }
    if (what.find("Parameters from the command line") != std::string_view::npos) {
      throw InputError(fmt::format("{}:{}: parameters: {}; expected parameters of {}", design.map.origin,
                                   design.map.parameters_line, what, design.map.top));
    }
    throw;
  }
  Elaborated out = read_xml(read_text(xml), fs::current_path());
  std::erase(out.files, package_path);
  return out;
}

// The values of the lanes of a port, side by side or element by element, and the wrapper's text for them.
class WrapperMaker {
 public:
  WrapperMaker(const DutDesign& design, const Config& config, const std::vector<DesignPort>& ports)
      : map_(design.map), config_(config), ports_(ports) {}

  void make(DutWrapper& wrapper) {
    const DutSide& in = map_.input;
    const DutSide& out = map_.output;
    control(map_.clock, "clock", map_.clock_line, "input", "clk_i");
    control(map_.reset, "reset", map_.reset_line, "input", map_.reset_low ? "rst_ni" : "!rst_ni");
    control(in.valid, "input.valid", in.valid_line, "input", "in_valid_i");
    if (in.ready.empty()) {
      body_ += "  assign in_ready_o = 1'b1;\n";
    } else {
      control(in.ready, "input.ready", in.ready_line, "output", "in_ready_o");
    }
    control(out.valid, "output.valid", out.valid_line, "output", "out_valid_o");
    if (!out.ready.empty()) control(out.ready, "output.ready", out.ready_line, "input", "out_ready_i");
    for (const DutPort& port : in.ports) add(port, "input", wrapper.inputs);
    for (const DutPort& port : out.ports) add(port, "output", wrapper.outputs);
    for (const DesignPort& port : ports_) {
      if (port.direction != "output" && !used_.contains(port.name)) wrapper.open_inputs.push_back(port.name);
    }
    wrapper.text = text(wrapper);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& key, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}: {}", map_.origin, line, key, what));
  }

  const DesignPort& find(const std::string& name, int line, const std::string& key,
                         std::string_view direction) {
    const auto at = std::ranges::find(ports_, name, &DesignPort::name);
    if (at == ports_.end()) {
      std::string legal;
      for (const DesignPort& port : ports_) legal += (legal.empty() ? "" : ", ") + port.name;
      fail(line, key, fmt::format("{} has no port {}; its ports: {}", map_.top, name, legal));
    }
    if (at->direction != direction) {
      fail(line, key,
           fmt::format("port {} of {} is an {}; expected an {}", name, map_.top, at->direction, direction));
    }
    if (at->bits == 0) fail(line, key, fmt::format("port {} of {} is no vector of bits", name, map_.top));
    if (!used_.insert(name).second) fail(line, key, fmt::format("port {} is in the map twice", name));
    return *at;
  }

  void connect(const std::string& port, const std::string& to) {
    connections_ += fmt::format("{}      .{}({})", connections_.empty() ? "" : ",\n", port, to);
  }

  void control(const std::string& name, const std::string& key, int line, std::string_view direction,
               const std::string& to) {
    const DesignPort& port = find(name, line, key, direction);
    if (port.bits != 1 || port.dimensions != 0) {
      fail(line, key, fmt::format("port {} of {} has {}; expected 1 bit", name, map_.top, shape(port)));
    }
    connect(name, to);
  }

  static std::string shape(const DesignPort& port) {
    const std::string bits = fmt::format("{} bit{}", port.bits, port.bits == 1 ? "" : "s");
    return port.dimensions == 0 ? bits : fmt::format("{} in an array", bits);
  }

  // Bits of each field of a port.
  std::vector<int> widths(const DutPort& port, const DesignPort& found, std::string_view direction) const {
    const bool input = direction == "input";
    const bool whole = port.array || port.fields.size() == 1;  // a field has a port, or an element, to itself
    std::vector<int> out;
    for (const DutField& field : port.fields) {
      const PortWord word = port_word(field, config_);
      int bits = port.width != 0 ? port.width : word.bits;
      if (port.width != 0 && port.width < word.bits && !word.integer) {
        fail(port.line, port.key,
             fmt::format("width {} is less than the {} bits of {} in {}", port.width, word.bits, field.name,
                         config_.name));
      }
      // A wider input is extended; what a wider output holds is the map's to say.
      if (input && whole && port.width == 0) bits = std::max(bits, found.bits);
      if (!input && bits > 64) {
        fail(port.line, port.key, fmt::format("{} bits per field; expected at most 64", bits));
      }
      out.push_back(bits);
    }
    if (port.array) {
      if (found.dimensions != 1 || found.elements() != static_cast<int>(port.fields.size())) {
        fail(
            port.line, port.key,
            fmt::format("port {} of {} is {}; expected an unpacked array of {} elements", port.name, map_.top,
                        found.dimensions == 1 ? fmt::format("an array of {}", found.elements())
                                              : "no array of one dimension",
                        port.fields.size()));
      }
    } else if (found.dimensions != 0) {
      fail(port.line, port.key,
           fmt::format("port {} of {} is an unpacked array; expected [FIELD, ...], a field per element",
                       port.name, map_.top));
    }
    const int expected =
        port.array ? *std::ranges::max_element(out) : std::accumulate(out.begin(), out.end(), 0);
    const bool same = !port.array || std::ranges::all_of(out, [&](int b) { return b == expected || input; });
    if (expected != found.bits || !same) {
      std::string fields;
      for (const DutField& field : port.fields) fields += (fields.empty() ? "" : ", ") + field.name;
      fail(port.line, port.key,
           fmt::format("port {} of {} has {}; expected {}{} for {} in {} (width = BITS per field in the map "
                       "says otherwise)",
                       port.name, map_.top, shape(found), expected,
                       input && whole && port.width == 0 ? " or more" : "", fields, config_.name));
    }
    if (port.array) std::ranges::fill(out, found.bits);
    return out;
  }

  // A value of 64 bits on `bits` of a port, or back.
  static std::string driven(const std::string& lane, int bits, bool is_signed) {
    if (bits <= 64) return fmt::format("{}[{}:0]", lane, bits - 1);
    const std::string bit = is_signed ? lane + "[63]" : "1'b0";
    return fmt::format("{{{{{}{{{}}}}}, {}}}", bits - 64, bit, lane);
  }
  static std::string sampled(const std::string& vector, int high, int low, bool is_signed) {
    const int bits = high - low + 1;
    std::string part = fmt::format("{}[{}:{}]", vector, high, low);
    if (bits == 64) return part;
    const std::string bit = is_signed ? fmt::format("{}[{}]", vector, high) : "1'b0";
    return fmt::format("{{{{{}{{{}}}}}, {}}}", 64 - bits, bit, part);
  }

  void add(const DutPort& port, std::string_view direction, std::vector<DutLane>& lanes) {
    const DesignPort& found = find(port.name, port.line, port.key, direction);
    const std::vector<int> bits = widths(port, found, direction);
    const bool input = direction == "input";
    const std::string net = "d_" + port.name;
    const std::string range = fmt::format("[{}:0]", found.bits - 1);
    body_ += port.array ? fmt::format("  logic {} {}[{}:{}];\n", range, net, found.left, found.right)
                        : fmt::format("  logic {} {};\n", range, net);
    int high = found.bits - 1;
    for (std::size_t i = 0; i < port.fields.size(); ++i) {
      const PortWord word = port_word(port.fields[i], config_);
      const std::string lane =
          input ? fmt::format("in{}_i", lanes.size()) : fmt::format("out{}_o", lanes.size());
      lanes.push_back({port.fields[i], port.name, word, bits[i]});
      std::string vector = net;
      if (port.array) {
        vector += fmt::format("[{}]", std::min(found.left, found.right) + static_cast<int>(i));
        high = bits[i] - 1;
      }
      const int low = high - bits[i] + 1;
      if (input) {
        body_ += fmt::format("  assign {}[{}:{}] = {};\n", vector, high, low,
                             driven(lane, bits[i], word.is_signed));
      } else {
        body_ += fmt::format("  assign {} = {};\n", lane, sampled(vector, high, low, word.is_signed));
      }
      high = low - 1;
    }
    connect(port.name, net);
  }

  std::string text(const DutWrapper& wrapper) const {
    std::string out = fmt::format(
        "// Generated by `bitspan dut add` from the map of {}; do not edit.\nmodule {} (\n"
        "    input  logic clk_i,\n    input  logic rst_ni,\n    input  logic in_valid_i,\n"
        "    output logic in_ready_o,\n    output logic out_valid_o,\n    input  logic out_ready_i",
        map_.top, dut_top);
    for (std::size_t i = 0; i < wrapper.inputs.size(); ++i) {
      out += fmt::format(",\n    input  logic [63:0] in{}_i  /* {} */", i, wrapper.inputs[i].field.name);
    }
    for (std::size_t i = 0; i < wrapper.outputs.size(); ++i) {
      out += fmt::format(",\n    output logic [63:0] out{}_o  /* {} */", i, wrapper.outputs[i].field.name);
    }
    out += "\n);\n" + body_ + "  " + map_.top;
    std::string values;
    for (const auto& [name, value] : map_.parameters) {
      values += fmt::format("{}.{}({})", values.empty() ? "" : ", ", name, value);
    }
    if (!values.empty()) out += " #(" + values + ")";
    return out + " u_dut (\n" + connections_ + "\n  );\nendmodule\n";
  }

  const DutMap& map_;
  const Config& config_;
  const std::vector<DesignPort>& ports_;
  std::set<std::string, std::less<>> used_;
  std::string body_, connections_;
};

}  // namespace

std::string dut_hash(const DutDesign& design, const std::vector<fs::path>& files) {
  const DutMap& map = design.map;
  Fnv128 hash;
  hash.text(map.top);
  for (const auto& [name, value] : map.parameters) hash.text(name + "=" + value);
  for (const fs::path& file : files) {
    hash.text(file.filename().string());
    hash.text(read_text(file, "a source of dut:" + design.name));
  }
  return hash.hex();
}

DutWrapper wrap_dut(const DutDesign& design, const Config& config) {
  DutWrapper wrapper;
  if (has_rtl(config)) wrapper.package = emit_sv(config);
  const Elaborated elaborated = elaborate(design, wrapper.package);
  WrapperMaker(design, config, elaborated.ports).make(wrapper);
  wrapper.files = elaborated.files;
  // The wrapper says which port is which field: another map is another design under test.
  Fnv128 hash;
  hash.text(dut_hash(design, wrapper.files));
  hash.text(wrapper.text);
  wrapper.hash = hash.hex();
  return wrapper;
}

void lint_dut(const DutDesign& design, const DutWrapper& wrapper) {
  const ScratchFolder folder = temporary_scratch_folder("bitspan-dut");
  const fs::path package = folder / "package.sv";
  write_text(package, wrapper.package + wrapper.text);
  run_verilator({"--lint-only", "--top-module", dut_top}, design, folder.path(), package);
}

RtlModuleDesign module_of(const DutDesign& design, const DutWrapper& wrapper, const std::string& config) {
  RtlModuleDesign module{.name = "dut:" + design.name + ", " + config,
                         .top = dut_top,
                         .package = wrapper.package + wrapper.text,
                         .sources = {},
                         .inputs = {"in_valid_i", "out_ready_i"},
                         .outputs = {"in_ready_o", "out_valid_o"},
                         .words = design_words(design),
                         .files = wrapper.files};
  for (std::size_t i = 0; i < wrapper.inputs.size(); ++i) module.inputs.push_back(fmt::format("in{}_i", i));
  for (std::size_t i = 0; i < wrapper.outputs.size(); ++i)
    module.outputs.push_back(fmt::format("out{}_o", i));
  return module;
}

}  // namespace bitspan
