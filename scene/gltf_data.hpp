// SPDX-License-Identifier: Apache-2.0
// The container of a glTF file: its JSON, buffers and accessors. Everything is checked before it is used.
#pragma once

#include <simdjson.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bitspan::gltf {

using Bytes = std::vector<std::uint8_t>;

// Reads a file, or its first bytes. Throws InputError where there is none.
Bytes read_bytes(const std::string& path, std::uint64_t limit = std::uint64_t{1} << 48);

// A value of the JSON, and where it stands, for messages. Each function throws InputError where the value is
// not what the function is named after.
class Value {
 public:
  Value(const std::string& path, simdjson::dom::element json, std::string place)
      : path_(&path), json_(json), place_(std::move(place)) {}

  const std::string& place() const { return place_; }
  // "FILE: PLACE: WHAT".
  [[noreturn]] void refuse(const std::string& what) const;

  std::optional<Value> find(std::string_view key) const;
  Value need(std::string_view key) const;
  std::vector<Value> items() const;

  double number() const;        // finite
  std::uint64_t whole() const;  // 0..2^48: sums and products of two bytes stay in range
  bool boolean() const;
  std::string_view text() const;

  // Of a key, or `otherwise` where there is none.
  double number(std::string_view key, double otherwise) const;
  std::uint64_t whole(std::string_view key, std::uint64_t otherwise) const;
  bool boolean(std::string_view key, bool otherwise) const;
  template <std::size_t N>
  std::array<double, N> numbers(std::string_view key, const std::array<double, N>& otherwise) const {
    const std::optional<Value> list = find(key);
    if (!list) return otherwise;
    const std::vector<Value> values = list->items();
    if (values.size() != N) list->refuse_length(values.size(), N);
    std::array<double, N> out{};
    for (std::size_t i = 0; i < N; ++i) out[i] = values[i].number();
    return out;
  }

 private:
  [[noreturn]] void refuse_length(std::size_t length, std::size_t expected) const;

  const std::string* path_;
  simdjson::dom::element json_;
  std::string place_;
};

enum class Component : std::uint16_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126
};

// Elements of one to four components. The bytes are the document's.
struct Accessor {
  std::string name;  // "FILE: accessors[2]"
  std::uint64_t count = 0;
  unsigned components = 1;
  Component component = Component::float32;
  bool normalized = false;

  // Components behind the last are 0. Codes of a normalised accessor become 0..1 or -1..1. Throws InputError
  // where one is not finite. `index` is below count.
  std::array<double, 4> element(std::uint64_t index) const;
  // The first component of unsigned integers.
  std::uint32_t code(std::uint64_t index) const;

  const std::uint8_t* data = nullptr;  // none: zeros
  std::uint64_t stride = 0;
  std::vector<std::uint32_t> sparse_indices;  // growing
  const std::uint8_t* sparse_values = nullptr;

 private:
  const std::uint8_t* at(std::uint64_t index) const;
};

class Document {
 public:
  // Reads the JSON of a file's contents, of a GLB that in its first chunk. Throws InputError where it is no
  // glTF 2.
  Document(Bytes file, std::string path);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  const std::string& path() const { return path_; }
  Value root() const { return {path_, root_, "the document"}; }
  // The values of a list of the document, empty where it has none: "nodes", "meshes", ...
  const std::vector<Value>& list(const std::string& key);
  // The index that `key` of `value` holds; throws InputError where it is past the end of the list.
  std::optional<std::size_t> index(const Value& value, std::string_view key, const std::string& list);
  Value item(const std::string& key, std::size_t index) { return list(key).at(index); }

  std::span<const std::uint8_t> view(std::size_t index);
  Accessor accessor(std::size_t index);

 private:
  std::span<const std::uint8_t> buffer(std::size_t index);
  Bytes read_buffer(const Value& buffer, std::size_t index, std::uint64_t length);
  void read_sparse(const Value& sparse, std::uint64_t element_bytes, Accessor& accessor);

  std::string path_;
  Bytes file_;
  std::span<const std::uint8_t> binary_;  // the second chunk of a GLB
  bool has_binary_ = false;
  simdjson::dom::parser parser_;
  simdjson::dom::element root_;
  std::map<std::string, std::vector<Value>> lists_;
  std::map<std::size_t, Bytes> buffers_;
  std::uint64_t buffer_bytes_ = 0;
};

}  // namespace bitspan::gltf
