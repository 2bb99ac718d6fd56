// SPDX-License-Identifier: Apache-2.0
// The values behind the header of a PLY file, one after another.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "config/config.hpp"
#include "scene/ply_header.hpp"

namespace bitspan {

// Where a value stands, for messages: a line of ascii data, or an offset in a binary file.
struct PlyPlace {
  std::uint64_t at = 0;
};

class PlyData {
 public:
  PlyData(std::string_view bytes, const std::string& path, const PlyHeader& header);

  // Takes over the instance that is read, for messages.
  void begin(const PlyElement& element, std::uint64_t instance) {
    element_ = &element;
    instance_ = instance;
  }

  // Each reads one value, and throws InputError where the data end before it, or it is none of its type.
  // A real value must be finite.
  std::int64_t read_integer(PlyType type);
  double read_number(PlyType type);
  // The same, and 0 for what is no finite number.
  double read_loose_number(PlyType type);
  // Skips `count` values, whatever they are.
  void skip(PlyType type, std::uint64_t count);

  // Reads a list's length: at least 0, and as many values as the data can still have.
  std::uint64_t read_length(PlyType count, PlyType value);

  // Throws InputError where the data cannot have so many instances.
  void expect(const PlyElement& element) const;
  // Throws InputError where more than blanks follow.
  void expect_end();

  PlyPlace place() const;
  // A message of the instance that is read, or of another.
  InputError error(const std::string& what) const { return error(*element_, instance_, place(), what); }
  InputError error(const PlyElement& element, std::uint64_t instance, PlyPlace place,
                   const std::string& what) const;

 private:
  bool is_ascii() const { return encoding_ == PlyEncoding::ascii; }
  std::uint64_t bytes_left() const;
  std::string_view take_value();
  std::uint64_t take_bits(std::size_t size);
  double take_real(PlyType type);  // of binary data
  InputError end() const;

  std::string_view bytes_;
  const std::string& path_;
  PlyEncoding encoding_;
  std::size_t at_;
  std::uint64_t line_;        // of the end of what is read
  std::uint64_t value_line_;  // of the last value
  const PlyElement* element_ = nullptr;
  std::uint64_t instance_ = 0;
};

}  // namespace bitspan
