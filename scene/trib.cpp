// SPDX-License-Identifier: Apache-2.0
#include "scene/trib.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>

namespace bitspan {
namespace {

static_assert(std::endian::native == std::endian::little, "the records are written as they lie in memory");

// The last but two is the version. A file that went through a conversion of line ends does not have these.
constexpr std::string_view signature = "\x89TRIB1\r\n";
constexpr std::size_t version_at = 5;
constexpr std::size_t block_limit = std::size_t{1} << 20;
constexpr std::size_t written_block = std::size_t{1} << 16;
constexpr std::size_t command_limit = std::size_t{1} << 20;  // of its text, as of a line of a .tri

// A tag is four bytes: a letter and one that says more of it.
constexpr std::uint32_t make_tag(char letter, unsigned more) {
  return static_cast<unsigned char>(letter) | more << 8U;
}
constexpr std::uint32_t command_tag = make_tag('C', 0), part_tag = make_tag('C', '+');
constexpr std::size_t command_size = 128, text_size = command_size - sizeof(std::uint32_t);

// What a triangle gives besides positions and texture coordinates: bit 0 colours, bit 1 + i attribute i.
constexpr unsigned has_colors = 1;
constexpr unsigned attribute_bit(std::size_t i) { return 2U << i; }
constexpr unsigned channel_sets = attribute_bit(given_attributes.size() - 1) * 2;
static_assert(channel_sets <= 65536);
constexpr unsigned first_sets = attribute_bit(1);  // of colours and fog, which every reader knows

// Tag, texture; three vertices x, y, s, u, v; three colours; and three numbers per attribute.
constexpr std::size_t triangle_size(unsigned channels) {
  const std::size_t doubles = 15 + ((channels & has_colors) != 0 ? 12U : 0U) +
                              3 * static_cast<std::size_t>(std::popcount(channels & ~has_colors));
  return 2 * sizeof(std::uint32_t) + doubles * sizeof(double);
}

// 0 where this version has no such records.
constexpr std::size_t known_size(std::uint32_t tag) {
  if (tag == command_tag || tag == part_tag) return command_size;
  const std::uint32_t channels = tag >> 8U;
  return tag == make_tag('T', channels) && channels < channel_sets ? triangle_size(channels) : 0;
}

std::string shown(std::uint32_t tag) {
  const auto bytes = std::bit_cast<std::array<std::uint8_t, 4>>(tag);
  return fmt::format("{:02x}", fmt::join(bytes, " "));
}

template <class T>
T value_at(const char* bytes) {
  T out;
  std::memcpy(&out, bytes, sizeof out);
  return out;
}

template <class T>
void append(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::uint32_t checksum(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

void read_triangle(const char* from, unsigned channels, TriangleLine& out) {
  out = {};
  out.texture = value_at<std::int32_t>(from);
  from += sizeof(std::int32_t);
  const auto take = [&from](double& to) {
    std::memcpy(&to, from, sizeof to);
    from += sizeof to;
  };
  for (Vertex& v : out.triangle.v) {
    for (double* const to : {&v.x, &v.y, &v.s, &v.u, &v.v}) take(*to);
  }
  if ((channels & has_colors) != 0) {
    for (double& c : out.colors.emplace()) take(c);
  }
  for (std::size_t i = 0; i < given_attributes.size(); ++i) {
    if ((channels & attribute_bit(i)) == 0) continue;
    for (Vertex& v : out.triangle.v) take(v.*given_attributes[i].member);
  }
}

unsigned channels_of(const Triangle& triangle) {
  constexpr std::array<double, 4> white{1, 1, 1, 1};
  unsigned channels = 0;
  for (const Vertex& v : triangle.v) {
    if (v.c != white) channels |= has_colors;
  }
  for (std::size_t i = 0; i < given_attributes.size(); ++i) {
    if (given_attributes[i].is_given(triangle.v)) channels |= attribute_bit(i);
  }
  return channels;
}

}  // namespace

bool is_binary_stream(std::istream& in, std::string_view name) {
  const int first = in.peek();
  if (first == static_cast<unsigned char>(signature.front())) return true;
  // Space, a brace, and a byte order mark begin texts.
  constexpr std::string_view text = " \r\n{\xEF";
  return name.ends_with(".trib") && !(first >= 0 && text.find(static_cast<char>(first)) != text.npos);
}

bool is_binary_stream_file(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) return false;
  std::array<char, version_at> bytes{};
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), bytes.size());
  return file && std::string_view(bytes.data(), bytes.size()) == signature.substr(0, version_at);
}

TribReader::TribReader(std::istream& in, const std::string& origin) : in_(in), place_{origin, 0, true} {
  std::array<char, signature.size()> start{};
  in_.read(start.data(), start.size());
  behind_ = in_.gcount();
  const std::string_view found(start.data(), static_cast<std::size_t>(behind_));
  if (found != signature) {
    const std::size_t same =
        static_cast<std::size_t>(std::ranges::mismatch(found, signature).in1 - found.begin());
    place_.at = static_cast<long>(same);
    if (same == version_at && found.size() > same && found[same] > '1' && found[same] <= '9') {
      place_.fail(fmt::format("the binary stream is of version {}; expected version 1", found[same]));
    }
    place_.fail(same == found.size()
                    ? "the file ends in its first bytes (truncated?); expected those of a binary stream "
                      "(.trib), 89 54 52 49 42 31 0d 0a"
                    : "is no binary stream; expected the first bytes of a .trib, 89 54 52 49 42 31 0d 0a");
  }
  place_.at = behind_;
  if (!read_block()) place_.fail("the stream ends in front of its header; expected a block that holds it");
  read_layout();
}

void TribReader::read_bytes(char* to, std::size_t size) {
  in_.read(to, static_cast<std::streamsize>(size));
  const auto count = static_cast<std::size_t>(in_.gcount());
  behind_ += static_cast<long>(count);
  if (count == size) return;
  place_.at = behind_;
  place_.fail(in_.bad() ? "cannot read the file; expected a readable file"
                        : fmt::format("the file ends inside a block (truncated?); expected {} bytes more",
                                      size - count));
}

// The next block's bytes, checked. Returns false for the last block, which has none.
bool TribReader::read_block() {
  const long begin = behind_;
  std::array<char, 8> head{};
  read_bytes(head.data(), head.size());
  const auto size = value_at<std::uint32_t>(head.data());
  const auto wanted = value_at<std::uint32_t>(head.data() + 4);
  const auto fail = [&](const std::string& what) {
    place_.at = begin;
    place_.fail(what);
  };
  if (size > block_limit) {
    fail(fmt::format("the block has {} bytes; expected at most {}", size, block_limit));
  }
  block_.resize(size);
  read_bytes(block_.data(), size);
  crc_ = checksum(crc_, {block_.data(), block_.size()});
  if (crc_ != wanted) {
    fail(
        fmt::format("the checksum behind this block's {} bytes is {:08x}, the file says {:08x}; expected the "
                    "same, as of a file that is whole",
                    size, crc_, wanted));
  }
  block_begin_ = begin + static_cast<long>(head.size());
  at_ = 0;
  if (size != 0) return true;
  place_.at = behind_;
  if (in_.peek() != std::istream::traits_type::eof()) {
    place_.fail("the file goes on behind its last block; expected its end");
  }
  return false;
}

const char* TribReader::take(std::size_t size, const char* expected) {
  if (block_.size() - at_ < size) {
    const long left = block_begin_ + static_cast<long>(block_.size()) - place_.at;
    place_.fail(fmt::format("the block ends {} bytes behind this; expected {}", left, expected));
  }
  at_ += size;
  return block_.data() + (at_ - size);
}

void TribReader::read_layout() {
  place_.at = block_begin_;
  const auto kinds = value_at<std::uint32_t>(take(4, "the number of kinds of records"));
  for (std::uint32_t k = 0; k < kinds; ++k) {
    place_.at = block_begin_ + static_cast<long>(at_);
    const char* const entry = take(8, "a kind of records: its tag and its size");
    const auto tag = value_at<std::uint32_t>(entry), size = value_at<std::uint32_t>(entry + 4);
    const std::size_t known = known_size(tag);
    if (known == 0) {
      place_.fail(fmt::format("records of the tag {} are not known; expected {}, {}, or {} to {}", shown(tag),
                              shown(command_tag), shown(part_tag), shown(make_tag('T', 0)),
                              shown(make_tag('T', channel_sets - 1))));
    }
    if (size != known) {
      place_.fail(fmt::format("records of the tag {} have {} bytes; expected {}", shown(tag), size, known));
    }
    if (std::ranges::find(sizes_, std::pair(tag, size)) != sizes_.end()) {
      place_.fail(fmt::format("records of the tag {} are listed twice; expected once", shown(tag)));
    }
    sizes_.emplace_back(tag, size);
  }
  place_.at = block_begin_ + static_cast<long>(at_);
  header_.assign(block_.data() + at_, block_.size() - at_);
  at_ = block_.size();
}

std::size_t TribReader::size_of(std::uint32_t tag) {
  for (const auto& [listed, size] : sizes_) {
    if (listed == tag) return size;
  }
  place_.fail(fmt::format("a record of the tag {}; expected one of those that the header lists", shown(tag)));
}

TribRecord TribReader::next(TriangleLine& triangle, std::string& command) {
  command.clear();
  bool is_part = false;
  long begin = 0;  // of the command
  while (!has_ended_) {
    if (at_ == block_.size()) {
      has_ended_ = !read_block();
      continue;
    }
    place_.at = block_begin_ + static_cast<long>(at_);
    const auto tag = value_at<std::uint32_t>(take(4, "a record, whose tag has 4 bytes"));
    const char* const bytes = take(size_of(tag) - 4, "the whole record");
    const std::uint32_t channels = tag >> 8U;
    if (tag == make_tag('T', channels)) {
      if (is_part) place_.fail("a triangle inside a command; expected the rest of the command");
      read_triangle(bytes, channels, triangle);
      return TribRecord::triangle;
    }
    if (!is_part) begin = place_.at;
    std::string_view text(bytes, text_size);
    text = text.substr(0, std::min(text.find('\0'), text.size()));
    if (command.size() + text.size() > command_limit) {
      place_.fail(fmt::format("the command is too long; expected at most {} bytes", command_limit));
    }
    command += text;
    is_part = tag == part_tag;
    if (is_part) continue;
    place_.at = begin;
    return TribRecord::command;
  }
  if (is_part) place_.fail("the stream ends inside a command; expected the rest of it");
  return TribRecord::end;
}

TribWriter::TribWriter(std::function<void(std::string_view)> sink, std::string_view header,
                       std::span<const Triangle> triangles)
    : sink_(std::move(sink)) {
  // A reader refuses kinds that it does not know, so those of a later attribute are listed where they occur.
  std::array<bool, channel_sets> occurs{};
  std::fill_n(occurs.begin(), first_sets, true);
  for (const Triangle& triangle : triangles) occurs[channels_of(triangle)] = true;
  std::string kinds;
  std::uint32_t count = 0;
  const auto list = [&](std::uint32_t tag) {
    append(kinds, tag);
    append(kinds, static_cast<std::uint32_t>(known_size(tag)));
    ++count;
  };
  for (unsigned channels = 0; channels < channel_sets; ++channels) {
    if (occurs[channels]) list(make_tag('T', channels));
  }
  list(command_tag);
  list(part_tag);
  append(block_, count);
  block_ += kinds;
  block_ += header;
  if (block_.size() > block_limit) {
    throw InputError(
        fmt::format("textures: the header of the binary stream has {} bytes; expected at most {}",
                    block_.size(), block_limit));
  }
  sink_(signature);
  flush();
}

void TribWriter::flush() {
  crc_ = checksum(crc_, block_);
  std::string head;
  append(head, static_cast<std::uint32_t>(block_.size()));
  append(head, crc_);
  sink_(head);
  sink_(block_);
  block_.clear();
}

void TribWriter::add(std::string_view record) {
  if (block_.size() + record.size() > written_block) flush();
  block_ += record;
}

void TribWriter::triangle(const Triangle& triangle) {
  const unsigned channels = channels_of(triangle);
  std::array<char, triangle_size(channel_sets - 1)> record;
  char* to = record.data();
  const auto put = [&to](const auto& value) {
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
  };
  put(make_tag('T', channels));
  put(std::int32_t{triangle.texture});
  for (const Vertex& v : triangle.v) {
    for (const double value : {v.x, v.y, v.s, v.u, v.v}) put(value);
  }
  if ((channels & has_colors) != 0) {
    for (const Vertex& v : triangle.v) put(v.c);
  }
  for (std::size_t i = 0; i < given_attributes.size(); ++i) {
    if ((channels & attribute_bit(i)) == 0) continue;
    for (const Vertex& v : triangle.v) put(v.*given_attributes[i].member);
  }
  add({record.data(), static_cast<std::size_t>(to - record.data())});
}

void TribWriter::command(std::string_view line) {
  do {
    const std::string_view text = line.substr(0, text_size);
    line.remove_prefix(text.size());
    std::string record;
    append(record, line.empty() ? command_tag : part_tag);
    record += text;
    record.resize(command_size);
    add(record);
  } while (!line.empty());
}

void TribWriter::end() {
  if (!block_.empty()) flush();
  flush();
}

}  // namespace bitspan
