// SPDX-License-Identifier: Apache-2.0
// What the strict readers of TOML files share: every fault is an InputError of one line, with file, line, key
// and what is legal.
#pragma once

#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_FORMATTERS 0
// toml++ asserts that a key follows the '[' of a damaged header, or lets the compiler assume it, and reports
// its absence only after that. Neither may stop a reader of files: the report is the answer in every build.
#define TOML_ASSERT(expr) static_assert(true)
#pragma push_macro("NDEBUG")
#undef NDEBUG
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"

namespace bitspan {

// `what` the file is, for messages: "study". At most 1 MiB.
std::string read_toml_file(const std::string& path, const std::string& what);
// `empty`: what is said of a text with nothing in it.
toml::table parse_toml(std::string_view text, const std::string& origin, const std::string& empty);

std::string join(std::span<const std::string_view> names);
std::string_view type_name(const toml::node& node);
int line_of(const toml::source_region& region);

// One table of a file, which must outlive it. The constructor refuses unknown keys; the readers refuse
// missing and mistyped ones.
class Section {
 public:
  Section(const toml::table& table, std::string path, int line, const std::string& origin,
          std::span<const std::string_view> legal);
  Section(const toml::table& table, std::string path, int line, const std::string& origin,
          std::initializer_list<std::string_view> legal)
      : Section(table, std::move(path), line, origin, std::span(legal.begin(), legal.size())) {}

  bool has(std::string_view key) const { return table_.contains(key); }

  Section section(std::string_view key, std::span<const std::string_view> legal) const;
  Section section(std::string_view key, std::initializer_list<std::string_view> legal) const {
    return section(key, std::span(legal.begin(), legal.size()));
  }
  // The tables of [[key]], which may be left out.
  std::vector<Section> sections(const std::string& key, std::initializer_list<std::string_view> legal) const;

  bool boolean(std::string_view key) const;
  int integer(std::string_view key) const;
  std::int64_t integer(std::string_view key, std::int64_t lowest, std::int64_t highest) const;
  double real(std::string_view key) const;                                         // finite
  std::string text(std::string_view key, const std::string& legal) const;          // not empty
  const toml::array& array(std::string_view key, const std::string& legal) const;  // not empty
  // Strings, at least one, none of them empty or twice.
  std::vector<std::string> texts(std::string_view key, const std::string& legal) const;
  std::size_t one_of(std::string_view key, std::span<const std::string_view> names) const;
  // The node of a key, missing keys refused.
  const toml::node& need(std::string_view key, const std::string& legal) const;

  int line() const { return line_; }
  int line(std::string_view key) const;
  std::string path_of(std::string_view key) const;
  [[noreturn]] void fail(int at, const std::string& key, const std::string& what) const;
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;
  [[noreturn]] void wrong_type(std::string_view key, const toml::node& node, std::string_view legal) const;
  const std::string& origin() const { return origin_; }

 private:
  std::size_t index_of(std::string_view key, const std::string& value,
                       std::span<const std::string_view> names) const;

  const toml::table& table_;
  std::string path_;
  int line_;
  const std::string& origin_;
};

}  // namespace bitspan
