// SPDX-License-Identifier: Apache-2.0
#include "scene/ply_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "config/byte_order_mark.hpp"
#include "config/config.hpp"
#include "scene/mesh_text.hpp"

namespace bitspan {
namespace {

struct TypeName {
  std::string_view name, other_name;
  PlyType type;
  std::size_t size;
};
constexpr auto types = std::to_array<TypeName>({{"char", "int8", PlyType::int8, 1},
                                                {"uchar", "uint8", PlyType::uint8, 1},
                                                {"short", "int16", PlyType::int16, 2},
                                                {"ushort", "uint16", PlyType::uint16, 2},
                                                {"int", "int32", PlyType::int32, 4},
                                                {"uint", "uint32", PlyType::uint32, 4},
                                                {"float", "float32", PlyType::float32, 4},
                                                {"double", "float64", PlyType::float64, 8}});

constexpr std::size_t lines_max = 100000;  // no header is so long; a file without end_header may be

class PlyHeaderReader {
 public:
  PlyHeaderReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  PlyHeader read() {
    const std::string_view mark_free = without_mark(bytes_);
    at_ = bytes_.size() - mark_free.size();
    const std::size_t first_end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
    if (trimmed(bytes_.substr(at_, first_end - at_)) != "ply") {
      header_.lines = 1;
      throw error("not a PLY file; expected a first line \"ply\"");
    }
    // Some programs end lines with \r alone.
    line_end_ = bytes_.substr(first_end).starts_with('\r') && !bytes_.substr(first_end).starts_with("\r\n")
                    ? '\r'
                    : '\n';
    take_line();
    while (at_ < bytes_.size() && header_.lines < lines_max) {
      const std::string_view line = take_line();
      if (!line_is_whole_) break;
      if (trimmed(line) == "end_header") {
        if (!has_format_) throw error("the header has no line format; expected one");
        header_.size = at_;
        return std::move(header_);
      }
      read_line(line);
    }
    throw error("the PLY header has no end (truncated?); expected a line end_header");
  }

 private:
  InputError error(const std::string& what) const {
    return InputError(path_ + ":" + std::to_string(header_.lines) + ": " + what);
  }

  std::string_view take_line() {
    const std::size_t end = std::min(bytes_.find(line_end_, at_), bytes_.size());
    std::string_view line = bytes_.substr(at_, end - at_);
    line_is_whole_ = end < bytes_.size();
    at_ = line_is_whole_ ? end + 1 : end;
    ++header_.lines;
    return line;
  }

  void read_line(std::string_view rest) {
    const std::string_view keyword = take_word(rest);
    if (keyword.empty() || keyword == "obj_info") return;
    if (keyword == "comment") return read_comment(rest);
    if (keyword == "format") return read_format(rest);
    if (keyword == "element") return read_element(rest);
    if (keyword == "property") return read_property(rest);
    throw error("not a PLY header line: " + in_quotes(keyword) +
                "; expected format, comment, element, property or end_header");
  }

  void read_comment(std::string_view rest) {
    if (take_word(rest) != "TextureFile") return;
    const std::string_view name = trimmed(rest);
    if (!name.empty()) header_.images.emplace_back(name);
  }

  void read_format(std::string_view rest) {
    const std::string_view name = take_word(rest), version = take_word(rest);
    if (name == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::little;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::big;
    } else {
      throw error("the format " + in_quotes(name) +
                  " is not known; expected ascii, binary_little_endian or binary_big_endian");
    }
    if (version != "1.0") throw error("version " + in_quotes(version) + " of PLY is not known; expected 1.0");
    if (has_format_) throw error("a second format; expected one");
    has_format_ = true;
  }

  void read_element(std::string_view rest) {
    PlyElement element;
    element.name = take_word(rest);
    element.line = header_.lines;
    const std::string_view count = take_word(rest);
    const char* const end = count.data() + count.size();
    const auto [stop, code] = std::from_chars(count.data(), end, element.count);
    if (code != std::errc() || stop != end || !trimmed(rest).empty()) {
      throw error("an element without a number of instances; expected element NAME COUNT");
    }
    header_.elements.push_back(std::move(element));
  }

  PlyType type(std::string_view name) const {
    for (const TypeName& t : types) {
      if (name == t.name || name == t.other_name) return t.type;
    }
    throw error(in_quotes(name) +
                " is no type; expected char, uchar, short, ushort, int, uint, float or double");
  }

  void read_property(std::string_view rest) {
    if (header_.elements.empty()) throw error("a property of no element; expected an element before it");
    PlyProperty property;
    std::string_view word = take_word(rest);
    if (word == "list") {
      property.count = type(take_word(rest));
      if (is_real(*property.count))
        throw error("a list's length is no whole number; expected a type of integers");
      word = take_word(rest);
    }
    property.type = type(word);
    property.name = take_word(rest);
    if (property.name.empty() || !trimmed(rest).empty()) {
      throw error("not a property; expected property TYPE NAME, or property list TYPE TYPE NAME");
    }
    header_.elements.back().properties.push_back(std::move(property));
  }

  std::string_view bytes_;
  const std::string& path_;
  PlyHeader header_;
  std::size_t at_ = 0;
  char line_end_ = '\n';
  bool line_is_whole_ = true;
  bool has_format_ = false;
};

}  // namespace

std::size_t size_of(PlyType type) { return types[static_cast<std::size_t>(type)].size; }
std::string_view name_of(PlyType type) { return types[static_cast<std::size_t>(type)].name; }

PlyHeader read_ply_header(std::string_view bytes, const std::string& path) {
  return PlyHeaderReader(bytes, path).read();
}

}  // namespace bitspan
