// SPDX-License-Identifier: Apache-2.0
#include "scene/ply_check.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <istream>
#include <sstream>
#include <string_view>
#include <vector>

#include "config/config.hpp"

namespace bitspan {
namespace {

struct Property {
  int count_bytes = 0;  // bytes of a list's length; 0: one value
  int value_bytes = 0;
};

struct Element {
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding : std::uint8_t { ascii, little, big };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
};

// Returns 0 for a name that is no type.
int bytes_of(std::string_view type) {
  struct Type {
    std::string_view name;
    int bytes;
  };
  constexpr std::array<Type, 16> types{{{"char", 1},
                                        {"uchar", 1},
                                        {"int8", 1},
                                        {"uint8", 1},
                                        {"short", 2},
                                        {"ushort", 2},
                                        {"int16", 2},
                                        {"uint16", 2},
                                        {"int", 4},
                                        {"uint", 4},
                                        {"int32", 4},
                                        {"uint32", 4},
                                        {"float", 4},
                                        {"float32", 4},
                                        {"double", 8},
                                        {"float64", 8}}};
  for (const Type& t : types) {
    if (t.name == type) return t.bytes;
  }
  return 0;
}

// Reads one header line; returns false where it is not a legal one.
bool read_line(const std::string& line, Header& header) {
  std::istringstream words(line);
  std::string word;
  if (!(words >> word) || word == "comment" || word == "obj_info") return true;
  if (word == "format") {
    words >> word;
    header.encoding = word == "ascii"               ? Encoding::ascii
                      : word == "binary_big_endian" ? Encoding::big
                                                    : Encoding::little;
    return word == "ascii" || word == "binary_big_endian" || word == "binary_little_endian";
  }
  if (word == "element") {
    Element element;
    words >> word >> element.count;
    header.elements.push_back(std::move(element));
    return !words.fail();
  }
  if (word != "property" || header.elements.empty()) return false;
  Property property;
  words >> word;
  if (word == "list") {
    words >> word;
    property.count_bytes = bytes_of(word);
    if (property.count_bytes == 0) return false;
    words >> word;
  }
  property.value_bytes = bytes_of(word);
  header.elements.back().properties.push_back(property);
  return property.value_bytes != 0 && static_cast<bool>(words >> word);
}

Header read_header(std::istream& file, const std::string& path) {
  constexpr std::size_t line_bytes_max = 4096, lines_max = 10000;
  Header header;
  std::string line;
  for (std::size_t number = 1; number <= lines_max; ++number) {
    line.clear();
    char letter = 0;
    while (line.size() < line_bytes_max && file.get(letter) && letter != '\n') line += letter;
    if (!file || line.size() == line_bytes_max) break;
    if (line.ends_with('\r')) line.pop_back();
    if (line == "end_header") return header;
    if (number > 1 && !read_line(line, header)) {
      throw InputError(path + ":" + std::to_string(number) +
                       ": not a PLY header line; expected format, comment, element, property or end_header");
    }
  }
  throw InputError(path + ": the PLY header has no end (truncated?); expected a line end_header");
}

// Walks over the data value by value.
class Data {
 public:
  Data(std::istream& file, Encoding encoding) : file_(file), encoding_(encoding) {}

  // Returns false where the file ends here.
  bool skip(int bytes, std::uint64_t times) {
    if (encoding_ != Encoding::ascii) {
      const std::uint64_t size = static_cast<std::uint64_t>(bytes) * times;
      file_.ignore(static_cast<std::streamsize>(size));
      return static_cast<std::uint64_t>(file_.gcount()) == size;
    }
    for (std::uint64_t i = 0; i < times; ++i) {
      if (!next_word()) return false;
    }
    return true;
  }

  bool read_count(int bytes, std::uint64_t& count) {
    count = 0;
    if (encoding_ == Encoding::ascii) {
      return next_word() &&
             std::from_chars(word_.data(), word_.data() + word_.size(), count).ec == std::errc();
    }
    std::array<char, 8> raw{};
    file_.read(raw.data(), bytes);
    for (int i = 0; i < bytes; ++i) {
      const int at = encoding_ == Encoding::big ? i : bytes - 1 - i;
      count = count << 8 | static_cast<std::uint8_t>(raw[static_cast<std::size_t>(at)]);
    }
    return file_.gcount() == bytes;
  }

 private:
  bool next_word() {
    constexpr std::size_t word_bytes_max = 256;
    std::streambuf& bytes = *file_.rdbuf();
    int letter = bytes.sbumpc();
    while (letter != EOF && std::isspace(letter) != 0) letter = bytes.sbumpc();
    word_.clear();
    while (letter != EOF && std::isspace(letter) == 0 && word_.size() < word_bytes_max) {
      word_ += static_cast<char>(letter);
      letter = bytes.sbumpc();
    }
    return !word_.empty();
  }

  std::istream& file_;
  Encoding encoding_;
  std::string word_;
};

bool skip_instance(Data& data, const Element& element) {
  for (const Property& property : element.properties) {
    std::uint64_t count = 1;
    if (property.count_bytes != 0 && !data.read_count(property.count_bytes, count)) return false;
    // No file goes beyond this, and the product with the size of a value stays in range.
    if (count > std::uint64_t{1} << 40 || !data.skip(property.value_bytes, count)) return false;
  }
  return true;
}

}  // namespace

void check_ply(std::istream& file, const std::string& path) {
  const Header header = read_header(file, path);
  Data data(file, header.encoding);
  for (std::size_t e = 0; e < header.elements.size(); ++e) {
    const Element& element = header.elements[e];
    if (element.properties.empty()) continue;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (skip_instance(data, element)) continue;
      throw InputError(path + ": the data ends inside instance " + std::to_string(i) + " of element " +
                       std::to_string(e) + " (truncated?); expected " + std::to_string(element.count) +
                       " instances");
    }
  }
}

}  // namespace bitspan
