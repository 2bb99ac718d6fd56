// SPDX-License-Identifier: Apache-2.0
#include "engine/sv_names.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "config/config.hpp"

namespace bitspan {
namespace {

// IEEE 1800-2017, annex B.
constexpr std::string_view keywords =
    " accept_on alias always always_comb always_ff always_latch and assert assign assume automatic before "
    "begin bind bins binsof bit break buf bufif0 bufif1 byte case casex casez cell chandle checker class "
    "clocking cmos config const constraint context continue cover covergroup coverpoint cross deassign "
    "default defparam design disable dist do edge else end endcase endchecker endclass endclocking "
    "endconfig endfunction endgenerate endgroup endinterface endmodule endpackage endprimitive "
    "endprogram endproperty endspecify endsequence endtable endtask enum event eventually expect export "
    "extends extern final first_match for force foreach forever fork forkjoin function generate genvar "
    "global highz0 highz1 if iff ifnone ignore_bins illegal_bins implements implies import incdir "
    "include initial inout input inside instance int integer interconnect interface intersect join "
    "join_any join_none large let liblist library local localparam logic longint macromodule matches "
    "medium modport module nand negedge nettype new nexttime nmos nor noshowcancelled not notif0 notif1 "
    "null or output package packed parameter pmos posedge primitive priority program property protected "
    "pull0 pull1 pulldown pullup pulsestyle_ondetect pulsestyle_onevent pure rand randc randcase "
    "randsequence rcmos real realtime ref reg reject_on release repeat restrict return rnmos rpmos rtran "
    "rtranif0 rtranif1 s_always s_eventually s_nexttime s_until s_until_with scalared sequence shortint "
    "shortreal showcancelled signed small soft solve specify specparam static string strong strong0 "
    "strong1 struct super supply0 supply1 sync_accept_on sync_reject_on table tagged task this "
    "throughout time timeprecision timeunit tran tranif0 tranif1 tri tri0 tri1 triand trior trireg type "
    "typedef union unique unique0 unsigned until until_with untyped use uwire var vectored virtual void "
    "wait wait_order wand weak weak0 weak1 while wildcard wire with within wor xnor xor ";

bool is_keyword(std::string_view word) {
  return keywords.find(' ' + std::string(word) + ' ') != std::string_view::npos;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_name(std::string_view token) { return !token.empty() && is_letter(token.front()); }

// The end of the token that begins at `at`. Names of the system ($clog2), of macros and of bases ('b1) are
// tokens of their own, so that no name begins inside them.
std::size_t token_end(std::string_view text, std::size_t at) {
  const auto behind = [&](std::size_t found, std::size_t length) {
    return found == std::string_view::npos ? text.size() : found + length;
  };
  const auto word_end = [&](std::size_t from) {
    while (from < text.size() && (is_letter(text[from]) || is_digit(text[from]) || text[from] == '$')) ++from;
    return from;
  };
  const char c = text[at];
  const std::string_view two = text.substr(at, 2);
  if (two == "//") return behind(text.find('\n', at), 0);
  if (two == "/*") return behind(text.find("*/", at + 2), 2);
  if (c == '"') {
    std::size_t end = at + 1;
    while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
    return std::min(end + 1, text.size());
  }
  if (c == '\\') return behind(text.find_first_of(" \t\n", at), 0);
  if (is_letter(c) || is_digit(c) || c == '$' || c == '`' || c == '\'') return word_end(at + 1);
  return at + 1;
}

// Without comments and white space.
std::vector<std::string_view> tokens_of(std::string_view text) {
  std::vector<std::string_view> tokens;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = token_end(text, at);
    const std::string_view token = text.substr(at, end - at);
    const bool comment = token.starts_with("//") || token.starts_with("/*");
    if (!comment && token.find_first_not_of(" \t\r\n") != std::string_view::npos) tokens.push_back(token);
    at = end;
  }
  return tokens;
}

}  // namespace

SvNames declared_names(std::string_view text) {
  SvNames names;
  const std::vector<std::string_view> tokens = tokens_of(text);
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    if (tokens[i] == "module") names.modules.emplace(tokens[i + 1]);
    if (tokens[i] == "package") names.packages.emplace(tokens[i + 1]);
  }
  return names;
}

std::string with_prefix(std::string_view text, std::string_view prefix, const SvNames& names) {
  const std::vector<std::string_view> tokens = tokens_of(text);
  const auto token = [&](std::size_t i) { return i < tokens.size() ? tokens[i] : std::string_view(); };
  // A module's name stands behind `module`, and in front of an instance's parameters or name.
  const auto is_module = [&](std::size_t i) {
    if (!names.modules.contains(tokens[i])) return false;
    if (i > 0 && tokens[i - 1] == "module") return true;
    if (i > 1 && tokens[i - 1] == ":" && tokens[i - 2] == "endmodule") return true;
    if (token(i + 1) == "#") return token(i + 2) == "(";
    return is_name(token(i + 1)) && !is_keyword(token(i + 1)) && (token(i + 2) == "(" || token(i + 2) == "[");
  };
  std::string out;
  const char* written = text.data();
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (!names.packages.contains(tokens[i]) && !is_module(i)) continue;
    out.append(written, tokens[i].data()).append(prefix);
    written = tokens[i].data();
  }
  return out.append(written, text.data() + text.size());
}

void check_prefix(std::string_view prefix) {
  const bool legal =
      is_name(prefix) && std::ranges::all_of(prefix, [](char c) { return is_letter(c) || is_digit(c); });
  if (!legal) {
    throw InputError("--prefix: '" + std::string(prefix) +
                     "' begins no name; expected a letter or an underscore, then letters, digits and "
                     "underscores");
  }
  if (is_keyword(prefix)) {
    throw InputError("--prefix: '" + std::string(prefix) + "' is a keyword of SystemVerilog");
  }
}

void check_prefix(std::string_view prefix, const SvNames& names) {
  for (const std::string& module : names.modules) {
    const std::string made = std::string(prefix) + module;
    if (names.modules.contains(made)) {
      throw InputError("--prefix: '" + std::string(prefix) + "' turns module " + module + " into " + made +
                       ", which is another module's name");
    }
  }
}

}  // namespace bitspan
