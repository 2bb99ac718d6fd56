#include "study/keys.hpp"

#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace bitspan {
namespace {

using Values = std::map<std::string, KeyValue, std::less<>>;

constexpr std::string_view formats_table = "formats.";
constexpr std::string_view fraction_field = ".fraction";
constexpr std::string_view transparent_key = "texture.transparent";

std::string list_text(const toml::array& array) {
  std::string out = "[";
  for (const toml::node& node : array) {
    out += out.size() > 1 ? ", " : "";
    out += std::to_string(node.value_or(std::int64_t{0}));
  }
  return out + "]";
}

void flatten(const toml::table& table, const std::string& prefix, Values& out) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    if (const auto* inner = node.as_table()) {
      flatten(*inner, path + ".", out);
    } else if (const auto* truth = node.as_boolean()) {
      out[path] = truth->get();
    } else if (const auto* integer = node.as_integer()) {
      out[path] = integer->get();
    } else if (const auto* real = node.as_floating_point()) {
      out[path] = real->get();
    } else if (const auto* text = node.as_string()) {
      out[path] = text->get();
    } else if (const auto* array = node.as_array()) {
      out[path] = list_text(*array);
    }
  }
}

// What the canonical text says, each key by its whole path.
Values values_of(const Config& config) {
  Values out;
  flatten(toml::parse(to_toml(config)), "", out);
  for (int i = 0; i < format_count; ++i) {  // the one key that is left out where it is false
    const auto id = static_cast<FormatId>(i);
    out[std::string(formats_table) + std::string(key_of(id)) + ".overflow_expected"] =
        config.format(id).overflow_expected;
  }
  return out;
}

// "formats.span.h" of "formats.span.h.fraction"; none for any other path.
std::optional<std::string> format_of_fraction(std::string_view path) {
  if (!path.starts_with(formats_table) || !path.ends_with(fraction_field)) return std::nullopt;
  return std::string(path.substr(0, path.size() - fraction_field.size()));
}

std::vector<std::string> names_of(const Values& values) {
  std::vector<std::string> out;
  for (const auto& [path, value] : values) {
    out.push_back(path);
    if (path.starts_with(formats_table) && path.ends_with(".int")) {
      out.push_back(path.substr(0, path.size() - 4) + std::string(fraction_field));
    }
  }
  return out;
}

[[noreturn]] void unknown(std::string_view path, const Values& values) {
  throw InputError(std::string(path) + ": no such key of a configuration; nearest: " +
                   comma_list(nearest_names(path, names_of(values))));
}

std::int64_t integer_of(const Values& values, const std::string& path) {
  const auto* value = std::get_if<std::int64_t>(&values.at(path));
  if (value == nullptr) {
    throw InputError(path + ": is " + to_string(values.at(path)) + "; legal: an integer");
  }
  return *value;
}

std::int64_t fraction_of(const Values& values, const std::string& format) {
  return integer_of(values, format + ".word") - integer_of(values, format + ".int");
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr std::string_view digits = "0123456789ABCDEF";
      out += "\\u00";
      out += digits[static_cast<unsigned char>(c) / 16];
      out += digits[static_cast<unsigned char>(c) % 16];
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

// A list of three integers, so that no other text reaches the reader unquoted.
bool is_color_list(std::string_view text) {
  return text.starts_with('[') && text.ends_with(']') &&
         text.find_first_not_of("[]0123456789-, ") == std::string_view::npos;
}

std::string toml_value(const std::string& path, const KeyValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) return to_string(value);
  return path == transparent_key && is_color_list(*text) ? *text : quoted(*text);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row[b.size()];
}

std::string settings_text(const std::vector<KeySetting>& settings) {
  std::string out;
  for (const KeySetting& s : settings) {
    out += (out.empty() ? "" : ", ") + s.path + " = " + to_string(s.value);
  }
  std::ranges::replace_if(
      out, [](unsigned char c) { return c < 0x20; }, ' ');  // a message is one line
  return out;
}

// The reader's message without the place in a text that nobody wrote.
std::string without_place(const std::string& message, const std::string& origin) {
  if (!message.starts_with(origin + ":")) return message;
  const auto end = message.find(": ", origin.size() + 1);
  return end == std::string::npos ? message : message.substr(end + 2);
}

}  // namespace

std::string comma_list(std::span<const std::string> names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> known) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& candidate : known) {
    const bool inside = !name.empty() && candidate.starts_with(name) && candidate[name.size()] == '.';
    ranked.emplace_back(inside ? 0 : edit_distance(name, candidate), candidate);
  }
  const std::size_t count = std::min<std::size_t>(3, ranked.size());
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
  std::vector<std::string> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(ranked[i].second);
  return out;
}

std::string to_string(const KeyValue& value) {
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&value)) {
    if (std::isnan(*real)) return "nan";
    if (std::isinf(*real)) return *real < 0 ? "-inf" : "inf";
    std::array<char, 40> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), *real).ptr;
    std::string text(buffer.data(), end);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
  }
  return std::get<std::string>(value);
}

std::vector<std::string> all_keys(const Config& config) { return names_of(values_of(config)); }

KeyValue value_of_key(const Config& config, std::string_view path) {
  const Values values = values_of(config);
  if (const auto found = values.find(path); found != values.end()) return found->second;
  const auto format = format_of_fraction(path);
  if (!format || !values.contains(*format + ".word")) unknown(path, values);
  return fraction_of(values, *format);
}

Config with_keys(const Config& base, const std::vector<KeySetting>& settings) {
  Values values = values_of(base);
  std::map<std::string, bool, std::less<>> given;
  for (const KeySetting& s : settings) {
    if (!given.emplace(s.path, true).second) throw InputError(s.path + ": is set twice; legal: once");
    if (const auto found = values.find(s.path); found != values.end()) {
      found->second = s.value;
    } else if (const auto format = format_of_fraction(s.path);
               !format || !values.contains(*format + ".word")) {
      unknown(s.path, values);
    }
  }
  for (const KeySetting& s : settings) {  // after every int is known
    const auto format = format_of_fraction(s.path);
    if (!format) continue;
    if (given.contains(*format + ".word")) {
      throw InputError(s.path + ": is set together with " + *format + ".word; legal: one of them");
    }
    const auto* fraction = std::get_if<std::int64_t>(&s.value);
    if (fraction == nullptr || *fraction < -1000 || *fraction > 1000) {
      throw InputError(s.path + ": is " + to_string(s.value) + "; legal: an integer, -32..64");
    }
    values[*format + ".word"] = integer_of(values, *format + ".int") + *fraction;
  }
  std::string text;
  for (const auto& [path, value] : values) text += path + " = " + toml_value(path, value) + "\n";
  const std::string origin = "settings";
  Config config;
  try {
    config = parse_config(text, origin);
  } catch (const InputError& error) {
    const std::string message = without_place(error.what(), origin);
    throw InputError(settings.empty() ? message : message + " (with " + settings_text(settings) + ")");
  }
  config.name = base.name;
  return config;
}

}  // namespace bitspan
