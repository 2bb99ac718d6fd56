// SPDX-License-Identifier: Apache-2.0
#include "study/points_file.hpp"

#include <csv.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <variant>

#include "config/byte_order_mark.hpp"
#include "config/one_line.hpp"

namespace bitspan {
namespace {

constexpr std::size_t line_limit = 1 << 20;  // bytes

// The reader of the library, one line at a time, so that a fault's line is known.
class Reader {
 public:
  Reader() {
    if (csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI) != 0) throw std::bad_alloc();
  }
  ~Reader() { csv_free(&parser_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // Returns the cells of a line without its end, and none where its quotes are wrong.
  std::optional<std::vector<std::string>> cells(std::string_view line) {
    std::vector<std::string> out;
    const auto add = [](void* cell, std::size_t size, void* to) {
      static_cast<std::vector<std::string>*>(to)->emplace_back(static_cast<const char*>(cell), size);
    };
    const bool read = csv_parse(&parser_, line.data(), line.size(), add, nullptr, &out) == line.size() &&
                      csv_fini(&parser_, add, nullptr, &out) == 0;
    return read ? std::optional(std::move(out)) : std::nullopt;
  }

 private:
  csv_parser parser_{};
};

template <class T>
std::optional<T> number_of(const std::string& cell) {
  T value{};
  const char* const end = cell.data() + cell.size();
  const auto read = std::from_chars(cell.data(), end, value);
  return read.ec == std::errc() && read.ptr == end ? std::optional(value) : std::nullopt;
}

struct Column {
  std::string name;
  Axis* axis = nullptr;  // none: it is passed over
  KeyValue base;
};

// Returns a cell as a value of the column's key, and none where it is none.
std::optional<KeyValue> value_in(const Column& column, const std::string& cell) {
  if (column.name == s_ratio_key) {
    const auto ratio = number_of<double>(cell);
    return ratio && *ratio > 1 && *ratio <= s_ratio_limit ? std::optional(KeyValue(*ratio)) : std::nullopt;
  }
  if (cell.empty()) return column.base;
  if (std::holds_alternative<bool>(column.base)) {
    if (cell != "true" && cell != "false") return std::nullopt;
    return cell == "true";
  }
  if (std::holds_alternative<std::string>(column.base)) return cell;
  const auto integer = number_of<std::int64_t>(cell);
  return integer ? std::optional(KeyValue(*integer)) : std::nullopt;
}

std::string legal_in(const Column& column) {
  if (column.name == s_ratio_key) return fmt::format("a number above 1, up to {}", s_ratio_limit);
  if (std::holds_alternative<bool>(column.base)) return "true, false, or blank for the base's value";
  return "an integer, or blank for the base's value";
}

bool is_result(const std::string& column) { return is_csv_column(column) || find_metric(column) != nullptr; }

std::ifstream open_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(path + ": is a folder; expected a CSV file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read: " + std::strerror(errno));
  return file;
}

}  // namespace

std::vector<Axis> read_points(const std::string& path, const Config& base) {
  std::ifstream file = open_file(path);
  std::vector<Axis> axes;
  std::vector<Column> columns;
  std::size_t line_number = 0;
  std::size_t points = 0;
  const auto fail = [&](const std::string& what) {
    throw InputError(one_line(fmt::format("{}:{}: {}", path, line_number, what)));
  };
  const auto read_head = [&](const std::vector<std::string>& names) {
    axes.reserve(names.size());
    for (const std::string& name : names) {
      if (std::ranges::find(columns, name, &Column::name) != columns.end()) {
        fail(name + ": is there twice; legal: each column once");
      }
      columns.push_back({name, nullptr, {}});
      if (is_result(name)) continue;
      if (name != s_ratio_key) {
        try {
          columns.back().base = value_of_key(base, name);
        } catch (const InputError& error) {
          fail(error.what());
        }
      }
      columns.back().axis = &axes.emplace_back(Axis{{name}, {}});
    }
    if (axes.empty()) fail("names no key; legal: a line of keys, such as depth.bits,formats.span.h.word");
  };
  const auto read_point = [&](const std::vector<std::string>& cells) {
    if (cells.size() != columns.size()) {
      fail(fmt::format("has {} cells; legal: {}, as the first line", cells.size(), columns.size()));
    }
    if (++points > points_limit) fail(fmt::format("is point {}; legal: at most {}", points, points_limit));
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (columns[c].axis == nullptr) continue;
      const auto value = value_in(columns[c], cells[c]);
      if (!value)
        fail(fmt::format("{}: is \"{}\"; legal: {}", columns[c].name, cells[c], legal_in(columns[c])));
      columns[c].axis->values.push_back({*value});
    }
  };

  Reader reader;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    if (line.size() > line_limit)
      fail(fmt::format("has {} bytes; legal: at most {}", line.size(), line_limit));
    if (line.ends_with('\r')) line.pop_back();
    const auto cells = reader.cells(line_number == 1 ? without_mark(line) : std::string_view(line));
    if (!cells) fail("has a quote that does not end, or text behind one; legal: RFC 4180, a point per line");
    if (cells->empty()) continue;  // a blank line
    columns.empty() ? read_head(*cells) : read_point(*cells);
  }
  if (file.bad()) throw InputError(path + ": cannot be read: " + std::strerror(errno));
  if (points == 0) throw InputError(path + ": has no point; legal: a line of keys, and a line per point");
  return axes;
}

}  // namespace bitspan
