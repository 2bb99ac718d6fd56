// SPDX-License-Identifier: Apache-2.0
#include "study/keys.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>

#include "config/check.hpp"
#include "config/one_line.hpp"

namespace bitspan {
namespace {

constexpr std::string_view formats_table = "formats.";
constexpr std::string_view fraction_field = ".fraction";

// The word and the integer bits of a register.
struct FormatKeys {
  const Key* word;
  const Key* integer;
};
// Returns the keys of "formats.span.h.fraction"; none for any other path.
std::optional<FormatKeys> format_of_fraction(std::string_view path) {
  if (!path.starts_with(formats_table) || !path.ends_with(fraction_field)) return std::nullopt;
  const std::string format(path.substr(0, path.size() - fraction_field.size()));
  const FormatKeys out{find_key(format + ".word"), find_key(format + ".int")};
  return out.word == nullptr ? std::nullopt : std::optional(out);
}

[[noreturn]] void unknown(std::string_view path) {
  throw InputError(std::string(path) + ": no such key of a configuration; nearest: " +
                   comma_list(nearest_names(path, all_keys())));
}

std::int64_t integer_at(const Config& config, const Key& key) {
  return std::get<std::int64_t>(value_of(config, key));
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
  return one_line(out);
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

std::vector<std::string> all_keys() {
  std::vector<std::string> out;
  for (const Key& key : keys()) {
    out.push_back(key.path);
    if (key.path.starts_with(formats_table) && key.name() == "int") {
      out.push_back(std::string(key.table()) + std::string(fraction_field));
    }
  }
  std::ranges::sort(out);
  return out;
}

KeyValue value_of_key(const Config& config, std::string_view path) {
  if (const Key* key = find_key(path)) return value_of(config, *key);
  const auto format = format_of_fraction(path);
  if (!format) unknown(path);
  return integer_at(config, *format->word) - integer_at(config, *format->integer);
}

Config with_keys(const Config& base, const std::vector<KeySetting>& settings) {
  Config config = base;
  const auto refuse = [&settings](const std::string& what) {
    throw InputError(settings.empty() ? what : one_line(what) + " (with " + settings_text(settings) + ")");
  };
  std::set<std::string_view> given;
  for (const KeySetting& s : settings) {
    if (!given.insert(s.path).second) throw InputError(s.path + ": is set twice; legal: once");
    if (const Key* key = find_key(s.path)) {
      if (const auto fault = set_value(config, *key, s.value)) refuse(s.path + ": " + *fault);
    } else if (!format_of_fraction(s.path)) {
      unknown(s.path);
    }
  }
  for (const KeySetting& s : settings) {  // a fraction is set after every int is known
    const auto format = format_of_fraction(s.path);
    if (!format) continue;
    if (given.contains(format->word->path)) {
      throw InputError(s.path + ": is set together with " + format->word->path + "; legal: one of them");
    }
    const auto* fraction = std::get_if<std::int64_t>(&s.value);
    if (fraction == nullptr || *fraction < -1000 || *fraction > 1000) {
      throw InputError(s.path + ": is " + to_string(s.value) + "; legal: an integer, -32..64");
    }
    const std::int64_t word = integer_at(config, *format->integer) + *fraction;
    if (const auto fault = set_value(config, *format->word, word)) {
      refuse(format->word->path + ": " + *fault);
    }
  }
  // A register that the base leaves out, and that is not set, has its default beside the registers as set.
  for (const Key& key : entries()) {
    const auto sets_it = [&key](std::string_view path) {
      return path == key.path || path.starts_with(key.path + ".");
    };
    if (is_left_out(base, key) && std::ranges::none_of(given, sets_it)) set_default(config, key);
  }
  if (const auto violation = first_violation(config)) refuse(violation->key + ": " + violation->text);
  return config;
}

}  // namespace bitspan
