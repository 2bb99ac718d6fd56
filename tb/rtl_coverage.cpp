// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "engine/sv_names.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

// The ports of a module, by name: the last word of each declaration in its header.
std::set<std::string> ports_of(const std::string& text) {
  const auto in_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const std::string header = text.substr(0, text.find("\n);"));
  std::set<std::string> ports;
  for (const std::string direction : {"input ", "output "}) {
    for (std::size_t at = header.find(direction); at != std::string::npos;
         at = header.find(direction, at + 1)) {
      const std::size_t line = std::min(header.find('\n', at), header.size());
      std::size_t end = at;
      for (int brackets = 0; end < line && (header[end] != ',' || brackets > 0); ++end)
        brackets += header[end] == '[' ? 1 : header[end] == ']' ? -1 : 0;
      while (end > at && !in_name(header[end - 1])) --end;
      std::size_t begin = end;
      while (begin > at && in_name(header[begin - 1])) --begin;
      ports.insert(header.substr(begin, end - begin));
    }
  }
  return ports;
}

}  // namespace

bool coverage_wanted() { return !environment(coverage_variable).empty(); }

const std::vector<std::string>& coverage_flags() {
  // Modules stay apart: inlined, the checks of toggles make a program several times as long.
  static const std::vector<std::string> flags = {"--coverage-line", "--coverage-toggle",    "--coverage-user",
                                                 "-fno-inline",     "--coverage-max-width", "4096"};
  return flags;
}

std::string handshake_covers(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) {
    const std::set<std::string> ports = ports_of(text);
    std::string inputs;
    std::string points;
    std::string connections;
    for (const std::string& valid : ports) {
      const std::size_t at = valid.find("_valid_");
      if (at == std::string::npos) continue;
      const std::string channel = valid.substr(0, at);
      const std::string ready = channel + "_ready_" + (valid.ends_with("_i") ? "o" : "i");
      if (!ports.contains(ready)) continue;
      inputs += fmt::format(",\n  input logic {0}_valid,\n  input logic {0}_ready", channel);
      connections += fmt::format(", .{0}_valid({1}), .{0}_ready({2})", channel, valid, ready);
      const std::string moved = fmt::format("{0}_valid && {0}_ready", channel);
      points += fmt::format("  logic {0}_moved_q;\n  always @(posedge clk_i) {0}_moved_q <= rst_ni && {1};\n",
                            channel, moved);
      for (const auto& [name, condition] :
           {std::pair("transfer", moved),
            {"stall", fmt::format("{0}_valid && !{0}_ready", channel)},
            {"idle", fmt::format("!{0}_valid", channel)},
            {"back_to_back", fmt::format("{0} && {1}_moved_q", moved, channel)}}) {
        points += fmt::format("  {0}_{1}: cover property (@(posedge clk_i) rst_ni && {2});\n", channel, name,
                              condition);
      }
    }
    if (points.empty()) continue;
    const std::string module = *declared_names(text).modules.begin();
    out += fmt::format(
        "/* verilator coverage_off */\nmodule {0}_handshakes (\n  input logic clk_i,\n  input logic "
        "rst_ni{1}\n);\n"
        "/* verilator coverage_on */\n{2}endmodule\n"
        "bind {0} {0}_handshakes u_handshakes (.clk_i(clk_i), .rst_ni(rst_ni){3});\n",
        module, inputs, points, connections);
  }
  return out;
}

}  // namespace bitspan
