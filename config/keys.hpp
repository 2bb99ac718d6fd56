// SPDX-License-Identifier: Apache-2.0
// Every key of the configuration: where its value stands, what is legal, what it has an effect on.
//
// The table in key_table.cpp has one row per key of docs/configuration.md. Reader, writer, hash, the
// compiled-in constants, the range checks, the documentation's table, the keys of studies and random
// generation follow from it. A new key is a member of Config and a row whose presence is `later`.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "config/config.hpp"

namespace bitspan {

// A value of an enumeration as its number, and the names of all.
struct Choice {
  std::uint8_t* number;
  std::span<const std::string_view> names;
};
// Where a key's value stands in a configuration.
using Place = std::variant<int*, bool*, Choice, StartOffset*, Color*, Rgba*, Format*>;

// What an integer may be.
struct Limits {
  int lowest = 0, highest = 0;
  bool power_of_two = false;
  std::string_view unit{};                     // " clocks"; "" for none
  int (*highest_of)(const Config&) = nullptr;  // where it depends on other keys; never above `highest`
};

// What a key has an effect on, beyond what a changed value does to everything behind it.
namespace affects {
inline constexpr unsigned ideal = 1;   // the truth of engine `ideal`
inline constexpr unsigned values = 2;  // records and pictures of the engines that compute by formats
inline constexpr unsigned clocks = 4;  // when the timed model and the RTL do something
inline constexpr unsigned rtl = 8;     // the package that the RTL is built from
}  // namespace affects

// Whether a file must give a key, and whether the canonical text has it.
enum class Presence : std::uint8_t {
  always,      // mandatory
  where_used,  // may be left out where it is not used
  optional,    // may be left out; the text has it
  later,       // may be left out; the text has it only where it differs from its default
};
// What the hash takes in place of a value that is not used.
enum class Unused : std::uint8_t { value, zero, initial };

// When a key is given and used; most are always.
struct KeyUse {
  Presence presence = Presence::always;
  std::string_view unused_for{};  // where_used: who does not use it, for the documentation
  bool (*used)(const Config&, std::size_t i) = nullptr;  // null: always
  Unused unused = Unused::value;
  std::string (*reason)(const Config&, std::size_t i) = nullptr;  // of the limits, for messages
  bool (*in_rtl)(std::size_t i) = nullptr;                        // those with `clocks` and `rtl`; null: all
  // Registers: the format of one that a file leaves out, which makes it `later`; none where it is mandatory.
  std::optional<Format> (*default_format)(const Config&, std::size_t i) = nullptr;
};

struct KeyRow {
  std::string_view path;    // UNIT, STAGE, BUFFER and FORMAT stand for the names of each
  std::string_view member;  // of Config, as in C++; [i], UNIT and BUFFER stand for each
  Place (*place)(Config&, std::size_t i);
  Limits limits;
  std::string_view rule;  // what check.cpp adds to the limits, for the documentation
  unsigned affects;
  std::string_view text;  // the meaning
  KeyUse use{};
};
// A field of a format; its limits hang on the sign, and stand in check.cpp.
struct FieldRow {
  std::string_view name, member;
  Place (*place)(Format&);
  std::string_view legal, text;
  unsigned affects;
  Presence presence = Presence::always;
};
// The reciprocal units that UNIT stands for, in their order.
inline constexpr std::array<std::string_view, 3> unit_names{"edge", "row", "pixel"};
// The buffers that BUFFER stands for.
inline constexpr std::array<std::string_view, 2> buffer_names{"depth", "color"};

std::span<const KeyRow> key_rows();
std::span<const FieldRow> field_rows();

// One key of one unit, stage or register.
struct Key {
  std::string path;       // "reciprocal.row.kind", "formats.span.h"
  std::size_t name_at;    // where its name begins: behind the last dot, or a format's whole key
  const KeyRow* row;      // of the table
  std::size_t i = 0;      // which UNIT, STAGE, BUFFER or FORMAT
  const FieldRow* field;  // null: the whole value

  std::string_view name() const { return std::string_view(path).substr(name_at); }
  std::string_view table() const { return std::string_view(path).substr(0, name_at - 1); }
  Presence presence() const;
};
// One per line of the canonical text, in its order; formats as a whole.
std::span<const Key> entries();
// The same with each format's fields apart: "formats.span.h.word". None of them is a Format.
std::span<const Key> keys();
const Key* find_key(std::string_view path);

Place place(Config& config, const Key& key);
// For reading only.
Place place(const Config& config, const Key& key);
// The bits of namespace affects.
unsigned affected(const Key& key);
bool is_used(const Config& config, const Key& key);
bool same_value(const Config& a, const Config& b, const Key& key);
// Sets a key that is `later` to what a file has that leaves it out.
void set_default(Config& config, const Key& key);
// Whether the canonical text leaves the key out: it is `later`, and has its default.
bool is_left_out(const Config& config, const Key& key);
void copy_value(const Config& from, Config& to, const Key& key);
// The member as C++ names it: "row_reciprocal.kind".
std::string member_of(const Key& key);

// Unused values as the hash takes them, so that configurations with equal results are equal (but for names).
Config used_part(const Config& config);

// A value as a file or a study gives it. A colour is the string "none" or "[255, 0, 255]".
using KeyValue = std::variant<bool, std::int64_t, double, std::string>;
std::string to_string(const KeyValue& value);
// What a text without quotes stands for: true, false, a number, or else itself.
KeyValue value_in(std::string_view text);
KeyValue value_of(const Config& config, const Key& key);
// What is wrong with the value, and what is legal; none where it is set.
std::optional<std::string> set_value(Config& config, const Key& key, const KeyValue& value);
// The values of a key's type, for messages.
std::string legal_values(const Key& key);

}  // namespace bitspan
