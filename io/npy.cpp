// SPDX-License-Identifier: Apache-2.0
#include "io/npy.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "config/config.hpp"
#include "io/atomic_file.hpp"

namespace bitspan {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are written as they lie in memory");

// Returns the part in front of the data: magic, version, length and description, padded to a multiple of 64
// bytes.
std::string header(std::string_view dtype, std::initializer_list<std::size_t> shape) {
  std::string text = "{'descr': '" + std::string(dtype) + "', 'fortran_order': False, 'shape': (";
  for (const std::size_t extent : shape) text += std::to_string(extent) + ", ";
  if (shape.size() > 1) text.resize(text.size() - 2);
  if (shape.size() == 1) text.pop_back();  // (n,)
  text += "), }";
  constexpr std::size_t prefix_bytes = 10;
  text.append(63 - (prefix_bytes + text.size()) % 64, ' ');
  text += '\n';
  const auto length = static_cast<std::uint16_t>(text.size());
  std::string result = "\x93NUMPY";
  result += '\1';
  result += '\0';
  result += static_cast<char>(length & 255);
  result += static_cast<char>(length >> 8);
  return result + text;
}

template <class T>
void write(const std::string& path, std::string_view dtype, std::initializer_list<std::size_t> shape,
           std::span<const T> values) {
  std::size_t count = 1;
  for (const std::size_t extent : shape) count *= extent;
  if (count != values.size()) throw std::invalid_argument("write_npy: the shape does not match the values");
  AtomicFile file(path);
  file.write(header(dtype, shape));
  file.write(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  file.commit();
}

// Reads the description of an array, a dictionary of Python with three keys in any order.
class HeaderReader {
 public:
  HeaderReader(std::string_view file, const std::string& origin, std::string_view expected)
      : file_(file), origin_(origin), expected_(expected) {}

  NpyHeader read() {
    const auto byte = [&](std::size_t at) {
      return static_cast<std::size_t>(static_cast<unsigned char>(file_[at]));
    };
    if (file_.size() < 12 || !file_.starts_with("\x93NUMPY")) refuse("is no NumPy file");
    if (byte(6) < 1 || byte(6) > 3) refuse("is of an unknown version");
    // Version 1 has a length of 2 bytes, the later ones of 4.
    const bool is_first = byte(6) == 1;
    const std::size_t start = is_first ? 10 : 12;
    const std::size_t length = byte(8) | byte(9) << 8U | (is_first ? 0 : byte(10) << 16U | byte(11) << 24U);
    if (length > npy_header_limit - start)
      refuse("has a description of " + std::to_string(length) + " bytes");
    if (length > file_.size() - start) refuse("is cut short");
    text_ = file_.substr(start, length);
    out_.bytes = start + length;
    read_entries();
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(origin_ + ": " + what + "; expected " + std::string(expected_));
  }
  [[noreturn]] void damaged() const { refuse("has a damaged description"); }

  // Takes the text, with blanks in front of it, where it comes next.
  bool take(std::string_view what) {
    const std::size_t blanks = std::min(text_.find_first_not_of(" \t\r\n"), text_.size());
    text_.remove_prefix(blanks);
    if (!text_.starts_with(what)) return false;
    text_.remove_prefix(what.size());
    return true;
  }
  std::string_view word() {
    const std::string_view quote = take("'") ? "'" : "\"";
    if (quote == "\"" && !take(quote)) damaged();
    const std::size_t end = text_.find(quote);
    if (end == std::string_view::npos) damaged();
    const std::string_view out = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    return out;
  }
  void read_shape() {
    if (!take("(")) damaged();
    while (!take(")")) {
      take("");  // the blanks
      std::size_t extent = 0;
      const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), extent);
      if (error != std::errc()) damaged();
      text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
      take("L");  // of Python 2
      out_.shape.push_back(extent);
      if (!take(",") && !text_.starts_with(')')) damaged();
    }
  }
  void read_entries() {
    if (!take("{")) damaged();
    bool has_type = false, has_order = false, has_shape = false;
    while (!take("}")) {
      const std::string_view key = word();
      if (!take(":")) damaged();
      if (key == "descr" && !has_type) {
        if (take("[")) refuse("is an array of records");
        out_.type = word();
        has_type = true;
      } else if (key == "fortran_order" && !has_order) {
        out_.is_fortran = take("True");
        if (!out_.is_fortran && !take("False")) damaged();
        has_order = true;
      } else if (key == "shape" && !has_shape) {
        read_shape();
        has_shape = true;
      } else {
        damaged();
      }
      if (!take(",") && !text_.starts_with('}')) damaged();
    }
    take("");
    if (!text_.empty() || !has_type || !has_order || !has_shape) damaged();
  }

  std::string_view file_, text_;
  const std::string& origin_;
  std::string_view expected_;
  NpyHeader out_;
};

}  // namespace

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint8_t> values) {
  write(path, "|u1", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint32_t> values) {
  write(path, "<u4", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::int32_t> values) {
  write(path, "<i4", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::int64_t> values) {
  write(path, "<i8", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const double> values) {
  write(path, "<f8", shape, values);
}

NpyHeader parse_npy_header(std::string_view file, const std::string& origin, std::string_view expected) {
  return HeaderReader(file, origin, expected).read();
}

IntegerTable read_npy_table(const std::string& path) {
  constexpr std::string_view expected = "a NumPy array of int64 with two axes, in C order";
  const auto refuse = [&](const std::string& what) {
    throw InputError(path + ": " + what + "; expected " + std::string(expected));
  };
  std::ifstream in(path, std::ios::binary);
  std::error_code ignored;
  if (!in.is_open() || std::filesystem::is_directory(path, ignored)) refuse("cannot read");
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const NpyHeader header = parse_npy_header(bytes, path, expected);
  if (header.shape.size() != 2) refuse("has not two axes");
  if (header.type != "<i8") refuse("is of another type");
  if (header.is_fortran) refuse("is not in C order");
  IntegerTable out{header.shape[0], header.shape[1], {}};
  const std::size_t rest = bytes.size() - header.bytes;
  const std::size_t size = out.rows * out.columns;
  if (rest != size * sizeof(std::int64_t)) refuse("is cut short, or too long");
  out.values.resize(size);
  std::memcpy(out.values.data(), bytes.data() + header.bytes, rest);
  return out;
}

}  // namespace bitspan
