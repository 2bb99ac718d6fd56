// SPDX-License-Identifier: Apache-2.0
#include "config/keys.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"

namespace bitspan {
namespace {

void replace(std::string& text, std::string_view what, std::string_view by) {
  if (const auto at = text.find(what); at != std::string::npos) text.replace(at, what.size(), by);
}

constexpr std::string_view stages = "STAGE", units = "UNIT", buffers = "BUFFER", formats = "FORMAT";

std::vector<Key> make_entries() {
  std::vector<Key> out;
  for (const KeyRow& row : key_rows()) {
    const auto has = [&row](std::string_view name) { return row.path.find(name) != std::string_view::npos; };
    const std::size_t count = has(stages)    ? static_cast<std::size_t>(stage_count)
                              : has(units)   ? unit_names.size()
                              : has(buffers) ? buffer_names.size()
                              : has(formats) ? static_cast<std::size_t>(format_count)
                                             : 1;
    for (std::size_t i = 0; i < count; ++i) {
      Key key{std::string(row.path), row.path.rfind('.') + 1, &row, i, nullptr};
      if (has(stages)) replace(key.path, stages, enum_names<Stage>[i]);
      if (has(units)) replace(key.path, units, unit_names[i]);
      if (has(buffers)) replace(key.path, buffers, buffer_names[i]);
      if (has(formats)) {
        replace(key.path, formats, key_of(static_cast<FormatId>(i)));
      } else {
        key.name_at = key.path.rfind('.') + 1;
      }
      out.push_back(std::move(key));
    }
  }
  // Tables that have one part per name are written one after the other: [timing.setup], then
  // [timing.edge_walk].
  std::map<std::string, std::size_t, std::less<>> tables;
  for (const Key& key : out) tables.emplace(key.table(), tables.size());
  std::ranges::stable_sort(out, {}, [&](const Key& key) { return tables.find(key.table())->second; });
  return out;
}

std::vector<Key> make_keys() {
  std::vector<Key> out;
  Config config;
  for (const Key& entry : entries()) {
    if (!std::holds_alternative<Format*>(place(config, entry))) {
      out.push_back(entry);
      continue;
    }
    for (const FieldRow& field : field_rows()) {
      out.push_back(
          {entry.path + "." + std::string(field.name), entry.path.size() + 1, entry.row, entry.i, &field});
    }
  }
  return out;
}

constexpr std::string_view legal_offset = "a finite number, \"half_ulp\"";
constexpr std::string_view legal_color = "\"none\", an array of three integers 0..255";
constexpr std::string_view legal_rgba = "an array of four integers 0..255";

std::string listed(std::span<const std::string_view> names) {
  std::string out;
  for (const auto name : names) out.append(out.empty() ? "" : ", ").append(name);
  return out;
}

std::string is_a(const KeyValue& value) {
  constexpr std::array<std::string_view, 4> types{"a boolean", "an integer", "a float", "a string"};
  return "is " + std::string(types[value.index()]) + "; legal: ";
}

using Fault = std::optional<std::string>;

Fault set(int* to, const KeyValue& value) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  if (integer == nullptr) return is_a(value) + "an integer";
  if (*integer < std::numeric_limits<int>::min() || *integer > std::numeric_limits<int>::max()) {
    return std::to_string(*integer) + " is far out of range; legal: an integer of 32 bits";
  }
  *to = static_cast<int>(*integer);
  return std::nullopt;
}

Fault set(bool* to, const KeyValue& value) {
  const auto* truth = std::get_if<bool>(&value);
  if (truth == nullptr) return is_a(value) + "true, false";
  *to = *truth;
  return std::nullopt;
}

Fault set(const Choice& to, const KeyValue& value) {
  const auto* name = std::get_if<std::string>(&value);
  if (name == nullptr) return is_a(value) + "a string, one of " + listed(to.names);
  const auto found = std::ranges::find(to.names, *name);
  if (found == to.names.end()) return '"' + *name + "\" is no value of this key; legal: " + listed(to.names);
  *to.number = static_cast<std::uint8_t>(found - to.names.begin());
  return std::nullopt;
}

Fault set(StartOffset* to, const KeyValue& value) {
  const std::string legal = "; legal: " + std::string(legal_offset);
  if (const auto* name = std::get_if<std::string>(&value)) {
    if (*name != "half_ulp") return '"' + *name + "\" is no start offset" + legal;
    *to = {true, 0};
    return std::nullopt;
  }
  double number = 0;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    number = static_cast<double>(*integer);
    if (std::abs(number) > 0x1p53) return "an integer beyond 2^53" + legal;
  } else if (const auto* real = std::get_if<double>(&value)) {
    number = *real;
    if (!std::isfinite(number)) return "is not a finite number" + legal;
  } else {
    return is_a(value) + std::string(legal_offset);
  }
  *to = {false, number == 0 ? 0 : number};  // no negative zero
  return std::nullopt;
}

// Reads "[255, 0, 255]", or as many codes as there are in `Codes`.
template <class Codes>
std::optional<Codes> codes_in(std::string_view text) {
  if (!text.starts_with('[') || !text.ends_with(']')) return std::nullopt;
  text = text.substr(1, text.size() - 2);
  Codes out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out[i]);
    if (error != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (i + 1 == out.size()) break;
    if (!text.starts_with(',')) return std::nullopt;
    text.remove_prefix(1);
  }
  return text.empty() ? std::optional(out) : std::nullopt;
}

Fault set(Color* to, const KeyValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) return is_a(value) + std::string(legal_color);
  const Color color = codes_in<Color::value_type>(*text);
  if (!color && *text != "none") return "is no colour; legal: " + std::string(legal_color);
  *to = color;
  return std::nullopt;
}

Fault set(Rgba* to, const KeyValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) return is_a(value) + std::string(legal_rgba);
  const std::optional<Rgba> color = codes_in<Rgba>(*text);
  if (!color) return "is no colour with alpha; legal: " + std::string(legal_rgba);
  *to = *color;
  return std::nullopt;
}

Fault set(Format* /*to*/, const KeyValue& /*value*/) { return "is a format; legal: one of its fields"; }

KeyValue get(const int* v) { return std::int64_t{*v}; }
KeyValue get(const bool* v) { return *v; }
KeyValue get(const Choice& v) {
  return *v.number < v.names.size() ? std::string(v.names[*v.number]) : std::string("?");
}
KeyValue get(const StartOffset* v) {
  if (v->half_ulp) return std::string("half_ulp");
  if (v->value == 0) return std::int64_t{0};
  return v->value;
}
std::string list_of(std::span<const std::uint8_t> codes) {
  std::string list;
  for (const int code : codes) list.append(list.empty() ? "[" : ", ").append(std::to_string(code));
  return list + "]";
}
KeyValue get(const Color* v) { return *v ? list_of(**v) : std::string("none"); }
KeyValue get(const Rgba* v) { return list_of(*v); }
KeyValue get(const Format* /*v*/) { return std::string("a format"); }

template <class T>
void copy(const T* from, const Place& to) {
  *std::get<T*>(to) = *from;
}
void copy(const Choice& from, const Place& to) { *std::get<Choice>(to).number = *from.number; }
template <class T>
bool same(const T* a, const Place& b) {
  return *a == *std::get<T*>(b);
}
bool same(const Choice& a, const Place& b) { return *a.number == *std::get<Choice>(b).number; }

}  // namespace

std::span<const Key> entries() {
  static const std::vector<Key> all = make_entries();
  return all;
}
std::span<const Key> keys() {
  static const std::vector<Key> all = make_keys();
  return all;
}

const Key* find_key(std::string_view path) {
  static const auto by_path = [] {
    std::unordered_map<std::string_view, const Key*> out;
    for (const Key& key : keys()) out.emplace(key.path, &key);
    return out;
  }();
  const auto found = by_path.find(path);
  return found == by_path.end() ? nullptr : found->second;
}

Presence Key::presence() const {
  if (field != nullptr) return field->presence;
  static const Config any;
  const bool register_by_default =
      row->use.default_format != nullptr && row->use.default_format(any, i).has_value();
  return register_by_default ? Presence::later : row->use.presence;
}

Place place(Config& config, const Key& key) {
  const Place whole = key.row->place(config, key.i);
  return key.field == nullptr ? whole : key.field->place(*std::get<Format*>(whole));
}
Place place(const Config& config, const Key& key) {
  return place(const_cast<Config&>(config), key);  // whoever asks only reads
}

unsigned affected(const Key& key) {
  unsigned out = key.row->affects;
  if (key.row->use.in_rtl != nullptr && !key.row->use.in_rtl(key.i)) out &= ~(affects::clocks | affects::rtl);
  return key.field == nullptr ? out : out & key.field->affects;
}

bool is_used(const Config& config, const Key& key) {
  return key.row->use.used == nullptr || key.row->use.used(config, key.i);
}

bool same_value(const Config& a, const Config& b, const Key& key) {
  return std::visit([&](const auto& at) { return same(at, place(b, key)); }, place(a, key));
}

void set_default(Config& config, const Key& key) {
  static const Config initial;
  if (key.field == nullptr && key.row->use.default_format != nullptr) {
    *std::get<Format*>(place(config, key)) = key.row->use.default_format(config, key.i).value();
  } else {
    copy_value(initial, config, key);
  }
}

bool is_left_out(const Config& config, const Key& key) {
  if (key.presence() != Presence::later) return false;
  Config by_default = config;
  set_default(by_default, key);
  return same_value(config, by_default, key);
}

void copy_value(const Config& from, Config& to, const Key& key) {
  std::visit([&](const auto& at) { copy(at, place(to, key)); }, place(from, key));
}

std::string member_of(const Key& key) {
  std::string out(key.row->member);
  replace(out, "[i]", std::string("[").append(std::to_string(key.i)).append("]"));
  if (key.row->path.find(units) != std::string_view::npos) replace(out, units, unit_names[key.i]);
  if (key.row->path.find(buffers) != std::string_view::npos) replace(out, buffers, buffer_names[key.i]);
  return key.field == nullptr ? out : out + "." + std::string(key.field->member);
}

Config used_part(const Config& config) {
  static const Config initial;
  Config out = config;
  for (const Key& key : entries()) {
    if (key.row->use.unused == Unused::value || is_used(config, key)) continue;
    if (key.row->use.unused == Unused::initial) {
      copy_value(initial, out, key);
    } else {
      *std::get<int*>(place(out, key)) = 0;
    }
  }
  return out;
}

std::string to_string(const KeyValue& value) {
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&value)) {
    if (std::isnan(*real)) return "nan";
    if (std::isinf(*real)) return *real < 0 ? "-inf" : "inf";
    // The shortest decimal that reads back as the same double.
    std::array<char, 40> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), *real).ptr;
    std::string text(buffer.data(), end);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
  }
  return std::get<std::string>(value);
}

KeyValue value_in(std::string_view text) {
  if (text == "true" || text == "false") return text == "true";
  const char* const last = text.data() + text.size();
  std::int64_t integer = 0;
  const auto [end, error] = std::from_chars(text.data(), last, integer);
  if (error == std::errc() && end == last) return integer;
  double real = 0;
  const auto [real_end, real_error] = std::from_chars(text.data(), last, real);
  if (real_error == std::errc() && real_end == last) return real;
  return std::string(text);
}

KeyValue value_of(const Config& config, const Key& key) {
  return std::visit([](const auto& at) { return get(at); }, place(config, key));
}

std::optional<std::string> set_value(Config& config, const Key& key, const KeyValue& value) {
  return std::visit([&value](const auto& to) { return set(to, value); }, place(config, key));
}

std::string legal_values(const Key& key) {
  static const Config any;
  const Place at = place(any, key);
  if (std::holds_alternative<bool*>(at)) return "true, false";
  if (const auto* choice = std::get_if<Choice>(&at)) return listed(choice->names);
  if (std::holds_alternative<StartOffset*>(at)) return std::string(legal_offset);
  if (std::holds_alternative<Color*>(at)) return std::string(legal_color);
  if (std::holds_alternative<Rgba*>(at)) return std::string(legal_rgba);
  return "an integer";
}

}  // namespace bitspan
