// SPDX-License-Identifier: Apache-2.0
// The strict reader: every key is known, given once, of its type, and, unless it is said to be optional,
// given.
#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "config/check.hpp"
#include "config/keys.hpp"
#include "config/toml_section.hpp"

namespace bitspan {
namespace {

// The tables of a file, as the keys have them. A format's name has a dot in it and is one part of a path.
struct Table {
  std::string path, name;
  std::vector<Table> parts;   // in the order of the canonical text
  const Key* key = nullptr;   // of a value; null for a table
  bool may_be_absent = true;  // all keys in it may be left out

  std::vector<std::string_view> names() const {
    std::vector<std::string_view> out;
    for (const Table& part : parts) out.emplace_back(part.name);
    return out;
  }
};

Table& part_of(Table& table, const std::string& path, std::string_view name) {
  const auto found = std::ranges::find(table.parts, name, &Table::name);
  if (found != table.parts.end()) return *found;
  return table.parts.emplace_back(Table{path, std::string(name), {}, nullptr, true});
}

constexpr std::string_view formats_table = "formats.";

Table make_tables() {
  Table root;
  for (const Key& key : keys()) {
    Table* table = &root;
    std::size_t begin = 0;
    const bool mandatory = key.presence() == Presence::always || key.presence() == Presence::where_used;
    for (std::size_t end = 0; end < key.path.size(); begin = end + 1) {
      const bool format = begin == formats_table.size() && key.path.starts_with(formats_table);
      end = std::min(key.path.find('.', format ? key.path.find('.', begin) + 1 : begin), key.path.size());
      table->may_be_absent = table->may_be_absent && !mandatory;
      table =
          &part_of(*table, key.path.substr(0, end), std::string_view(key.path).substr(begin, end - begin));
    }
    table->key = &key;
  }
  return root;
}

void read_key(const Section& s, const Key& key, Config& config) {
  const std::string_view name = key.name();
  const bool needed =
      key.presence() == Presence::always || (key.presence() == Presence::where_used && is_used(config, key));
  if (!needed && !s.has(name)) return;
  const toml::node& node = s.need(name, s.has(name) ? "" : legal_values(key));
  const Place at = place(config, key);
  const bool color = std::holds_alternative<Color*>(at) || std::holds_alternative<Rgba*>(at);
  KeyValue value;
  if (const auto* truth = node.as_boolean()) {
    value = truth->get();
  } else if (const auto* integer = node.as_integer()) {
    value = integer->get();
  } else if (const auto* real = node.as_floating_point()) {
    value = real->get();
  } else if (const auto* text = node.as_string()) {
    // A colour's list is an array here, and no text.
    value = color && text->get().starts_with('[') ? "" : text->get();
  } else if (const auto* array = node.as_array(); array != nullptr && color) {
    std::string list;
    for (const toml::node& code : *array) {
      list.append(list.empty() ? "[" : ", ");
      list.append(code.is_integer() ? std::to_string(code.as_integer()->get()) : "?");
    }
    value = list + "]";
  } else {
    s.wrong_type(
        name, node,
        std::holds_alternative<Choice>(at) ? "a string, one of " + legal_values(key) : legal_values(key));
  }
  if (const auto fault = set_value(config, key, value)) s.fail(name, *fault);
}

void read_table(const Section& s, const Table& table, Config& config);

// [formats]: quoted keys ("setup.s" = {...}) or dotted ones (setup.s = {...}), both in one file at will.
void read_formats(const Section& root, const Table& formats, Config& config) {
  const std::vector<std::string_view> names = formats.names();
  std::vector<std::string_view> groups;
  for (const std::string_view name : names) {
    const std::string_view group = name.substr(0, name.find('.'));
    if (std::ranges::find(groups, group) == groups.end()) groups.push_back(group);
  }
  const std::string legal = "a table with a format for each of " + join(names);
  const toml::node& node = root.need(formats.name, legal);
  if (!node.is_table()) root.wrong_type(formats.name, node, legal);
  const int line = root.line(formats.name);

  // One flat table, in the order of the file's lines for messages, key -> (node, line).
  std::map<std::string, std::pair<const toml::node*, int>, std::less<>> flat;
  const auto add = [&](const std::string& key, const toml::node& value, int at) {
    if (std::ranges::find(names, key) == names.end()) {
      root.fail(at, "formats." + key, "unknown key; legal: " + join(names));
    }
    if (!flat.emplace(key, std::pair(&value, at)).second) {
      root.fail(at, "formats." + key, "is given twice, quoted and dotted; legal: once");
    }
  };
  for (const auto& [key, value] : *node.as_table()) {
    const int at = line_of(key.source());
    const bool group = std::ranges::find(groups, key.str()) != groups.end();
    if (!group || !value.is_table()) {
      add(std::string(key.str()), value, at);
      continue;
    }
    for (const auto& [inner, inner_value] : *value.as_table()) {
      add(std::string(key.str()) + "." + std::string(inner.str()), inner_value, line_of(inner.source()));
    }
  }

  for (const Table& format : formats.parts) {
    const std::vector<std::string_view> fields = format.names();
    const auto found = flat.find(format.name);
    if (found == flat.end()) {
      const auto id = static_cast<FormatId>(format.parts[0].key->i);
      if (const auto by_default = default_format(config.formats, id)) {
        config.format(id) = *by_default;  // of those before it, which are read
        continue;
      }
      root.fail(line, format.path,
                "missing; legal: a format of " + std::string(text_of(id)) + " [" + std::string(unit_of(id)) +
                    "], with " + join(fields));
    }
    const auto& [value, at] = found->second;
    if (!value->is_table()) {
      root.fail(at, format.path,
                "is " + std::string(type_name(*value)) + "; legal: a format, a table with " + join(fields));
    }
    read_table(Section(*value->as_table(), format.path, at, root.origin(), fields), format, config);
  }
}

void read_table(const Section& s, const Table& table, Config& config) {
  for (const Table& part : table.parts) {
    if (part.key != nullptr) {
      read_key(s, *part.key, config);
    } else if (part.path == "formats") {
      read_formats(s, part, config);
    } else if (!part.may_be_absent || s.has(part.name)) {
      read_table(s.section(part.name, part.names()), part, config);
    }
  }
}

// The line of a key, or of the nearest table around it, which stands at `line`. A format's name has a dot in
// it and may be one key or two.
int line_near(const toml::table& table, std::string_view key, int line) {
  for (std::string_view head = key;; head = head.substr(0, head.rfind('.'))) {
    if (const auto found = table.find(head); found != table.end()) {
      const int at = line_of(found->first.source());
      const toml::table* inner = found->second.as_table();
      return inner == nullptr || head == key ? at : line_near(*inner, key.substr(head.size() + 1), at);
    }
    if (head.find('.') == std::string_view::npos) return line;
  }
}

}  // namespace

Config parse_config(std::string_view text, const std::string& origin) {
  const toml::table table =
      parse_toml(text, origin, "the configuration is empty; legal: a TOML file, such as config/depth16.toml");
  static const Table tables = make_tables();
  Config config;
  read_table(Section(table, "", 1, origin, tables.names()), tables, config);
  config.name = std::filesystem::path(origin).stem().string();
  if (const auto violation = first_violation(config)) {
    throw InputError(origin + ":" + std::to_string(line_near(table, violation->key, 1)) + ": " +
                     violation->key + ": " + violation->text);
  }
  return config;
}

Config load_config(const std::string& path) {
  return parse_config(read_toml_file(path, "configuration file"), path);
}

}  // namespace bitspan
