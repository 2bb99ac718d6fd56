// SPDX-License-Identifier: Apache-2.0
// The blocks and records of a binary triangle stream, `.trib`; docs/formats.md describes them. What a record
// means, and what is legal, is the same as in a `.tri`: scene/tri_stream.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <istream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/place.hpp"
#include "scene/quick_triangle.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Whether what `in` holds is to be read as a binary stream: it begins with the first byte of one, or the name
// ends in .trib and it does not begin as a text does.
bool is_binary_stream(std::istream& in, std::string_view name);
// Whether that regular file begins as a binary stream.
bool is_binary_stream_file(const std::string& path);

enum class TribRecord { end, triangle, command };

// Hands out the records of a stream. Only their form is checked, and the checksum of each block before its
// first record. Its memory is bounded by two blocks. Every failure is an InputError "file: byte N: what;
// expected ...".
class TribReader {
 public:
  // Reads the first block. `in` must outlive the reader.
  TribReader(std::istream& in, const std::string& origin);

  // The text of the stream's header, and where it stands.
  const std::string& header() const { return header_; }
  // Where the header, or the last record, begins: a byte of the file.
  long offset() const { return place_.at; }
  // Reads a record into `triangle` or the text of a command.
  TribRecord next(TriangleLine& triangle, std::string& command);

 private:
  bool read_block();
  void read_bytes(char* to, std::size_t size);
  void read_layout();
  std::size_t size_of(std::uint32_t tag);
  // The next `size` bytes of the block, which has so many.
  const char* take(std::size_t size, const char* expected);

  std::istream& in_;
  Place place_;
  std::string header_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes_;  // of the records, by their tags
  std::vector<char> block_;
  std::size_t at_ = 0;     // in the block
  long block_begin_ = 0;   // of the block's bytes, in the file
  long behind_ = 0;        // bytes read
  std::uint32_t crc_ = 0;  // of the blocks' bytes so far
  bool has_ended_ = false;
};

// Writes a stream through `sink`, block by block.
class TribWriter {
 public:
  // `header` is the text of the stream's header, and `triangles` are those that will be written.
  TribWriter(std::function<void(std::string_view)> sink, std::string_view header,
             std::span<const Triangle> triangles);
  void triangle(const Triangle& triangle);
  // The command's line of a `.tri`, without the newline.
  void command(std::string_view line);
  // Call it once, behind the last record.
  void end();

 private:
  void add(std::string_view record);
  void flush();

  std::function<void(std::string_view)> sink_;
  std::string block_;
  std::uint32_t crc_ = 0;
};

}  // namespace bitspan
