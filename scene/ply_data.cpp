// SPDX-License-Identifier: Apache-2.0
#include "scene/ply_data.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "scene/mesh_text.hpp"

namespace bitspan {
namespace {

template <class T>
bool holds(std::int64_t value) {
  return value >= std::numeric_limits<T>::min() && value <= std::numeric_limits<T>::max();
}

bool is_in_range(PlyType type, std::int64_t value) {
  switch (type) {
    case PlyType::int8:
      return holds<std::int8_t>(value);
    case PlyType::uint8:
      return holds<std::uint8_t>(value);
    case PlyType::int16:
      return holds<std::int16_t>(value);
    case PlyType::uint16:
      return holds<std::uint16_t>(value);
    case PlyType::int32:
      return holds<std::int32_t>(value);
    case PlyType::uint32:
      return holds<std::uint32_t>(value);
    case PlyType::float32:
    case PlyType::float64:
      break;
  }
  return false;
}

// The least bytes of a value, with its blank.
std::size_t least_bytes(bool is_ascii, PlyType type) { return is_ascii ? 2 : size_of(type); }

}  // namespace

PlyData::PlyData(std::string_view bytes, const std::string& path, const PlyHeader& header)
    : bytes_(bytes),
      path_(path),
      encoding_(header.encoding),
      at_(header.size),
      line_(header.lines + 1),
      value_line_(line_) {}

// The last value of ascii data needs no blank.
std::uint64_t PlyData::bytes_left() const { return bytes_.size() - at_ + (is_ascii() ? 1 : 0); }

PlyPlace PlyData::place() const { return {is_ascii() ? value_line_ : at_}; }

InputError PlyData::error(const PlyElement& element, std::uint64_t instance, PlyPlace place,
                          const std::string& what) const {
  const std::string of = element.name.substr(0, 80) + " " + std::to_string(instance);
  if (is_ascii()) return InputError(path_ + ":" + std::to_string(place.at) + ": " + of + ": " + what);
  return InputError(path_ + ": offset " + std::to_string(place.at) + ", " + of + ": " + what);
}

InputError PlyData::end() const {
  return error("the data end here (truncated?); expected " + std::to_string(element_->count) +
               " instances of this element");
}

std::string_view PlyData::take_value() {
  while (at_ < bytes_.size() && is_blank(bytes_[at_])) {
    if (bytes_[at_] == '\n' || (bytes_[at_] == '\r' && !bytes_.substr(at_).starts_with("\r\n"))) ++line_;
    ++at_;
  }
  value_line_ = line_;
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
  if (begin == at_) throw end();
  return bytes_.substr(begin, at_ - begin);
}

std::uint64_t PlyData::take_bits(std::size_t size) {
  if (bytes_.size() - at_ < size) throw end();
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from = encoding_ == PlyEncoding::big ? i : size - 1 - i;
    bits = bits << 8 | static_cast<std::uint8_t>(bytes_[at_ + from]);
  }
  at_ += size;
  return bits;
}

std::int64_t PlyData::read_integer(PlyType type) {
  if (is_ascii()) {
    const std::string_view text = take_value();
    const char* const end = text.data() + text.size();
    std::int64_t value = 0;
    const auto [stop, code] = std::from_chars(text.data() + (text[0] == '+' ? 1 : 0), end, value);
    if (code != std::errc() || stop != end || !is_in_range(type, value)) {
      throw error(in_quotes(text) + " is no number of type " + std::string(name_of(type)) + "; expected one");
    }
    return value;
  }
  const std::size_t size = size_of(type);
  const std::uint64_t bits = take_bits(size);
  if (!is_signed(type)) return static_cast<std::int64_t>(bits);
  const auto unused = static_cast<int>(64 - 8 * size);
  return static_cast<std::int64_t>(bits << unused) >> unused;
}

double PlyData::take_real(PlyType type) {
  return type == PlyType::float32 ? double{std::bit_cast<float>(static_cast<std::uint32_t>(take_bits(4)))}
                                  : std::bit_cast<double>(take_bits(8));
}

double PlyData::read_number(PlyType type) {
  if (!is_real(type)) return static_cast<double>(read_integer(type));
  if (is_ascii()) {
    const std::string_view text = take_value();
    const std::optional<double> value = to_number(text);
    if (!value) throw error(in_quotes(text) + " is no number that a double holds; expected one");
    return *value;
  }
  const PlyPlace before = place();
  const double value = take_real(type);
  if (!std::isfinite(value)) {
    throw error(*element_, instance_, before, "a value is not finite; expected a finite number");
  }
  return value;
}

double PlyData::read_loose_number(PlyType type) {
  if (is_ascii()) return to_number(take_value()).value_or(0);
  if (!is_real(type)) return static_cast<double>(read_integer(type));
  const double value = take_real(type);
  return std::isfinite(value) ? value : 0;
}

void PlyData::skip(PlyType type, std::uint64_t count) {
  if (is_ascii()) {
    for (std::uint64_t i = 0; i < count; ++i) take_value();
    return;
  }
  if (count > (bytes_.size() - at_) / size_of(type)) throw end();
  at_ += size_of(type) * count;
}

std::uint64_t PlyData::read_length(PlyType count, PlyType value) {
  const PlyPlace before = place();
  const std::int64_t length = read_integer(count);
  const std::uint64_t left = bytes_left() / least_bytes(is_ascii(), value);
  if (length < 0 || static_cast<std::uint64_t>(length) > left) {
    throw error(*element_, instance_, is_ascii() ? place() : before,
                "a list of " + std::to_string(length) + " values; expected at most the " +
                    std::to_string(left) + " that the file has");
  }
  return static_cast<std::uint64_t>(length);
}

void PlyData::expect(const PlyElement& element) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    bytes += least_bytes(is_ascii(), property.count ? *property.count : property.type);
  }
  if (bytes != 0 && element.count > bytes_left() / bytes) {
    throw InputError(path_ + ":" + std::to_string(element.line) + ": element " + in_quotes(element.name) +
                     " has " + std::to_string(element.count) +
                     " instances, and the file ends before (truncated?); expected as many in the file");
  }
}

void PlyData::expect_end() {
  const std::size_t before = at_;
  while (at_ < bytes_.size() && is_blank(bytes_[at_])) {
    if (bytes_[at_] == '\n' || (bytes_[at_] == '\r' && !bytes_.substr(at_).starts_with("\r\n"))) ++line_;
    ++at_;
  }
  // Two bytes: the end of a line that some programs write behind binary data.
  if (at_ == bytes_.size() && (is_ascii() || at_ - before <= 2)) return;
  const std::string where =
      is_ascii() ? path_ + ":" + std::to_string(line_) : path_ + ": offset " + std::to_string(before);
  throw InputError(where + ": data behind the last element; expected the end of the file");
}

}  // namespace bitspan
