// SPDX-License-Identifier: Apache-2.0
#include "config/toml_section.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>

#include "config/byte_order_mark.hpp"
#include "config/one_line.hpp"

namespace bitspan {
namespace {

constexpr std::size_t file_limit = std::size_t{1} << 20;

// toml++ reads the parts of a key and the values in a value by recursion, and frees them so, too: 200,000
// parts end the stack.
constexpr int key_parts_limit = 17;
constexpr int nesting_limit = 64;

// Returns the place after the string that begins at `i`. One that does not end is the parser's to refuse.
std::size_t end_of_string(std::string_view text, std::size_t i, int& line) {
  const char quote = text[i];
  const bool has_escapes = quote == '"';
  const std::string_view three = quote == '"' ? R"(""")" : "'''";
  const bool is_block = text.substr(i, 3) == three;
  for (i += is_block ? 3 : 1; i < text.size(); ++i) {
    if (text[i] == '\n') {
      if (!is_block) return i;
      ++line;
    } else if (text[i] == '\\' && has_escapes) {
      // An escaped end of line still counts as a line, and ends a string that has one.
      if (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (text[i] == quote && !is_block) {
      return i + 1;
    } else if (text.substr(i, 3) == three) {
      // Up to two quotes may stand before the three that end it.
      for (i += 3; i < text.size() && text[i] == quote;) ++i;
      return i;
    }
  }
  return i;
}

void check_depth(std::string_view text, const std::string& origin) {
  int line = 1, dots = 0, depth = 0;
  const auto fail = [&](const std::string& what) {
    throw InputError(origin + ":" + std::to_string(line) + ": " + what);
  };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = end_of_string(text, i, line);
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    ++i;
    if (c == '\n') ++line;
    if (c == '.') {
      if (++dots >= key_parts_limit) {
        fail("a key has too many parts; expected at most " + std::to_string(key_parts_limit));
      }
    } else if (c == '[' || c == '{') {
      if (++depth > nesting_limit) {
        fail("values are nested too deep; expected at most " + std::to_string(nesting_limit) +
             " in each other");
      }
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
    if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) dots = 0;
  }
}

}  // namespace

std::string read_toml_file(const std::string& path, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path + ": no such " + what);
  const std::string expected = "; expected a " + what + " in TOML";
  if (std::filesystem::is_directory(path, error)) throw InputError(path + ": is a directory" + expected);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(file_limit + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) {
    throw InputError(path + ": cannot be read: " + std::strerror(errno == 0 ? EIO : errno));
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > file_limit) throw InputError(path + ": is larger than 1 MiB" + expected);
  return text;
}

toml::table parse_toml(std::string_view text, const std::string& origin, const std::string& empty) {
  text = without_mark(text);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) throw InputError(origin + ":1: " + empty);
  check_depth(text, origin);
  try {
    return toml::parse(text, origin);
  } catch (const toml::parse_error& error) {
    throw InputError(origin + ":" + std::to_string(line_of(error.source())) +
                     ": does not parse as TOML: " + one_line(std::string(error.description())));
  }
}

std::string join(std::span<const std::string_view> names) {
  std::string out;
  for (const auto name : names) out.append(out.empty() ? "" : ", ").append(name);
  return out;
}

std::string_view type_name(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "an array";
  if (node.is_string()) return "a string";
  if (node.is_integer()) return "an integer";
  if (node.is_floating_point()) return "a float";
  if (node.is_boolean()) return "a boolean";
  return "a date or time";
}

int line_of(const toml::source_region& region) {
  return region.begin.line > 0 ? static_cast<int>(region.begin.line) : 1;
}

Section::Section(const toml::table& table, std::string path, int line, const std::string& origin,
                 std::span<const std::string_view> legal)
    : table_(table), path_(std::move(path)), line_(line), origin_(origin) {
  for (const auto& [key, node] : table_) {
    if (std::ranges::find(legal, key.str()) != legal.end()) continue;
    fail(key.str(),
         std::string(node.is_table() ? "unknown table" : "unknown key") + "; legal: " + join(legal));
  }
}

Section Section::section(std::string_view key, std::span<const std::string_view> legal) const {
  const std::string keys = "a table with the keys " + join(legal);
  const toml::node& node = need(key, keys);
  if (!node.is_table()) wrong_type(key, node, keys);
  return {*node.as_table(), path_of(key), line(key), origin_, legal};
}

std::vector<Section> Section::sections(const std::string& key,
                                       std::initializer_list<std::string_view> legal) const {
  std::vector<Section> out;
  const toml::node* node = table_.get(key);
  if (node == nullptr) return out;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty() || !array->is_homogeneous(toml::node_type::table)) {
    wrong_type(key, *node, "tables headed [[" + key + "]]");
  }
  for (const toml::node& item : *array) {
    out.emplace_back(*item.as_table(), path_of(key) + "[" + std::to_string(out.size() + 1) + "]",
                     line_of(item.source()), origin_, legal);
  }
  return out;
}

bool Section::boolean(std::string_view key) const {
  const toml::node& node = need(key, "true, false");
  if (!node.is_boolean()) wrong_type(key, node, "true, false");
  return node.as_boolean()->get();
}

int Section::integer(std::string_view key) const {
  const toml::node& node = need(key, "an integer");
  if (!node.is_integer()) wrong_type(key, node, "an integer");
  const std::int64_t value = node.as_integer()->get();
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) {
    fail(key, std::to_string(value) + " is far out of range; legal: an integer of 32 bits");
  }
  return static_cast<int>(value);
}

std::int64_t Section::integer(std::string_view key, std::int64_t lowest, std::int64_t highest) const {
  const std::string legal = "an integer, " + std::to_string(lowest) + ".." + std::to_string(highest);
  const toml::node& node = need(key, legal);
  if (!node.is_integer()) wrong_type(key, node, legal);
  const std::int64_t value = node.as_integer()->get();
  if (value < lowest || value > highest) fail(key, "is " + std::to_string(value) + "; legal: " + legal);
  return value;
}

double Section::real(std::string_view key) const {
  constexpr const char* legal = "a finite number";
  const toml::node& node = need(key, legal);
  if (node.is_integer()) return static_cast<double>(node.as_integer()->get());
  if (!node.is_floating_point()) wrong_type(key, node, legal);
  const double value = node.as_floating_point()->get();
  if (!std::isfinite(value)) fail(key, std::string("is not finite; legal: ") + legal);
  return value;
}

std::string Section::text(std::string_view key, const std::string& legal) const {
  const toml::node& node = need(key, legal);
  if (!node.is_string()) wrong_type(key, node, legal);
  if (node.as_string()->get().empty()) fail(key, "is empty; legal: " + legal);
  return node.as_string()->get();
}

const toml::array& Section::array(std::string_view key, const std::string& legal) const {
  const toml::node& node = need(key, legal);
  if (!node.is_array()) wrong_type(key, node, legal);
  if (node.as_array()->empty()) fail(key, "is empty; legal: " + legal);
  return *node.as_array();
}

std::vector<std::string> Section::texts(std::string_view key, const std::string& legal) const {
  std::vector<std::string> out;
  for (const toml::node& node : array(key, legal)) {
    if (!node.is_string() || node.as_string()->get().empty()) {
      fail(line_of(node.source()), path_of(key),
           "has " + (node.is_string() ? std::string("an empty string") : std::string(type_name(node))) +
               "; legal: " + legal);
    }
    const std::string& name = node.as_string()->get();
    if (std::ranges::find(out, name) != out.end()) {
      fail(line_of(node.source()), path_of(key), "has \"" + name + "\" twice; legal: once");
    }
    out.push_back(name);
  }
  return out;
}

std::size_t Section::one_of(std::string_view key, std::span<const std::string_view> names) const {
  return index_of(key, text(key, join(names)), names);
}

const toml::node& Section::need(std::string_view key, const std::string& legal) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) fail(line_, path_of(key), "missing; legal: " + legal);
  return *node;
}

int Section::line(std::string_view key) const {
  const auto found = table_.find(key);
  return found == table_.end() ? line_ : line_of(found->first.source());
}

std::string Section::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

void Section::fail(int at, const std::string& key, const std::string& what) const {
  throw InputError(origin_ + ":" + std::to_string(at) + ": " + one_line(key + ": " + what));
}
void Section::fail(std::string_view key, const std::string& what) const {
  fail(line(key), path_of(key), what);
}
void Section::wrong_type(std::string_view key, const toml::node& node, std::string_view legal) const {
  fail(key, "is " + std::string(type_name(node)) + "; legal: " + std::string(legal));
}

std::size_t Section::index_of(std::string_view key, const std::string& value,
                              std::span<const std::string_view> names) const {
  const auto found = std::ranges::find(names, value);
  if (found == names.end()) fail(key, '"' + value + "\" is no value of this key; legal: " + join(names));
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace bitspan
