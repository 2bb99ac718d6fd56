// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_data.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "config/byte_order_mark.hpp"
#include "config/config.hpp"
#include "io/json_depth.hpp"
#include "scene/mesh_text.hpp"
#include "scene/uri.hpp"

namespace bitspan::gltf {
namespace {

constexpr std::uint64_t whole_limit = std::uint64_t{1} << 48;
constexpr std::uint64_t buffer_bytes_limit = std::uint64_t{1} << 32;

static_assert(std::endian::native == std::endian::little, "glTF is little-endian, and so is what reads it");

template <class T>
T load(const std::uint8_t* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

unsigned bytes_of(Component component) {
  switch (component) {
    case Component::int8:
    case Component::uint8:
      return 1;
    case Component::int16:
    case Component::uint16:
      return 2;
    case Component::uint32:
    case Component::float32:
      return 4;
  }
  return 0;
}

double value_of(Component component, bool normalized, const std::uint8_t* bytes) {
  const auto scaled = [&](double code, double largest) {
    return normalized ? std::max(code / largest, -1.0) : code;
  };
  switch (component) {
    case Component::int8:
      return scaled(load<std::int8_t>(bytes), 127);
    case Component::uint8:
      return scaled(*bytes, 255);
    case Component::int16:
      return scaled(load<std::int16_t>(bytes), 32767);
    case Component::uint16:
      return scaled(load<std::uint16_t>(bytes), 65535);
    case Component::uint32:
      return load<std::uint32_t>(bytes);
    case Component::float32:
      return load<float>(bytes);
  }
  return 0;
}

std::uint32_t code_of(Component component, const std::uint8_t* bytes) {
  switch (bytes_of(component)) {
    case 1:
      return *bytes;
    case 2:
      return load<std::uint16_t>(bytes);
    default:
      return load<std::uint32_t>(bytes);
  }
}

Component component_of(const Value& value) {
  const std::uint64_t code = value.whole();
  for (const Component c : {Component::int8, Component::uint8, Component::int16, Component::uint16,
                            Component::uint32, Component::float32}) {
    if (code == static_cast<std::uint64_t>(c)) return c;
  }
  value.refuse("there is no component type " + std::to_string(code) + "; expected 5120..5123, 5125 or 5126");
}

bool is_unsigned(Component component) {
  return component == Component::uint8 || component == Component::uint16 || component == Component::uint32;
}

struct Chunks {
  std::span<const std::uint8_t> json, binary;
  bool has_binary = false;
};

//  offset  0       4        8       12            16          20
//          "glTF"  version  length  chunk length  chunk type  chunk ...
Chunks chunks_of_glb(const std::string& path, std::span<const std::uint8_t> file) {
  const auto refuse = [&](const std::string& what) { throw InputError(path + ": " + what); };
  constexpr std::uint32_t json_type = 0x4e4f534a, binary_type = 0x004e4942;
  if (file.size() < 12) refuse("the GLB ends in its header (truncated?); expected 12 bytes");
  const auto version = load<std::uint32_t>(&file[4]);
  if (version != 2) refuse("is GLB version " + std::to_string(version) + "; expected 2");
  const auto length = load<std::uint32_t>(&file[8]);
  if (length > file.size()) {
    refuse("the GLB has " + std::to_string(file.size()) + " bytes (truncated?); expected " +
           std::to_string(length) + " as its header says");
  }
  file = file.first(std::max<std::size_t>(length, 12));
  Chunks chunks;
  std::size_t position = 12;
  for (int number = 0; position < file.size(); ++number) {
    const std::string chunk = "chunk " + std::to_string(number) + " of the GLB";
    if (file.size() - position < 8) refuse(chunk + " ends in its header; expected 8 bytes");
    const auto size = load<std::uint32_t>(&file[position]);
    const auto type = load<std::uint32_t>(&file[position + 4]);
    position += 8;
    if (size > file.size() - position) {
      refuse(chunk + " has " + std::to_string(size) + " bytes; expected at most the " +
             std::to_string(file.size() - position) + " that are left");
    }
    const auto content = file.subspan(position, size);
    if ((number == 0) != (type == json_type))
      refuse(chunk + " is of a wrong type; expected JSON first and once");
    if (number == 0) chunks.json = content;
    if (number == 1 && type == binary_type) {
      chunks.binary = content;
      chunks.has_binary = true;
    }
    position += size;
  }
  if (chunks.json.empty()) refuse("the GLB has no JSON; expected a chunk of it");
  return chunks;
}

}  // namespace

Bytes read_bytes(const std::string& path, std::uint64_t limit) {
  std::error_code code;
  if (std::filesystem::exists(path, code) && !std::filesystem::is_regular_file(path, code)) {
    throw InputError(path + ": cannot read: is no file; expected a file of bytes");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot read: " + std::strerror(errno) + "; expected a file of bytes");
  const std::uint64_t size = std::min<std::uint64_t>(std::filesystem::file_size(path, code), limit);
  if (code) throw InputError(path + ": cannot read: " + code.message() + "; expected a file of bytes");
  Bytes bytes(size);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

void Value::refuse(const std::string& what) const { throw InputError(*path_ + ": " + place_ + ": " + what); }

void Value::refuse_length(std::size_t length, std::size_t expected) const {
  refuse("has " + std::to_string(length) + " numbers; expected " + std::to_string(expected));
}

std::optional<Value> Value::find(std::string_view key) const {
  simdjson::dom::object object;
  if (json_.get(object) != simdjson::SUCCESS) refuse("is no object; expected one");
  simdjson::dom::element found;
  if (object.at_key(key).get(found) != simdjson::SUCCESS) return std::nullopt;
  return Value(*path_, found, place_ == "the document" ? std::string(key) : place_ + "." + std::string(key));
}

Value Value::need(std::string_view key) const {
  std::optional<Value> found = find(key);
  if (!found) refuse("has no \"" + std::string(key) + "\"; expected it");
  return *found;
}

std::vector<Value> Value::items() const {
  simdjson::dom::array array;
  if (json_.get(array) != simdjson::SUCCESS) refuse("is no list; expected one");
  std::vector<Value> out;
  for (const simdjson::dom::element item : array) {
    out.emplace_back(*path_, item, place_ + "[" + std::to_string(out.size()) + "]");
  }
  return out;
}

double Value::number() const {
  double value = 0;
  if (json_.get(value) != simdjson::SUCCESS || !std::isfinite(value)) refuse("is no number; expected one");
  return value;
}

std::uint64_t Value::whole() const {
  const double value = number();  // exact up to the limit
  if (!(value >= 0 && value <= static_cast<double>(whole_limit) && value == std::floor(value))) {
    refuse("is no whole number; expected 0..2^48");
  }
  return static_cast<std::uint64_t>(value);
}

bool Value::boolean() const {
  bool value = false;
  if (json_.get(value) != simdjson::SUCCESS) refuse("is neither true nor false; expected one of them");
  return value;
}

std::string_view Value::text() const {
  std::string_view value;
  if (json_.get(value) != simdjson::SUCCESS) refuse("is no text; expected one");
  return value;
}

double Value::number(std::string_view key, double otherwise) const {
  const std::optional<Value> found = find(key);
  return found ? found->number() : otherwise;
}

std::uint64_t Value::whole(std::string_view key, std::uint64_t otherwise) const {
  const std::optional<Value> found = find(key);
  return found ? found->whole() : otherwise;
}

bool Value::boolean(std::string_view key, bool otherwise) const {
  const std::optional<Value> found = find(key);
  return found ? found->boolean() : otherwise;
}

const std::uint8_t* Accessor::at(std::uint64_t index) const {
  if (!sparse_indices.empty()) {
    const auto found = std::lower_bound(sparse_indices.begin(), sparse_indices.end(), index);
    if (found != sparse_indices.end() && *found == index) {
      const auto row = static_cast<std::uint64_t>(found - sparse_indices.begin());
      return sparse_values + row * components * bytes_of(component);
    }
  }
  return data == nullptr ? nullptr : data + index * stride;
}

std::array<double, 4> Accessor::element(std::uint64_t index) const {
  std::array<double, 4> out{};
  const std::uint8_t* bytes = at(index);
  if (bytes == nullptr) return out;
  for (unsigned i = 0; i < components; ++i) {
    out[i] = value_of(component, normalized, bytes + std::size_t{i} * bytes_of(component));
    if (!std::isfinite(out[i])) {
      throw InputError(name + ": element " + std::to_string(index) +
                       " is not finite; expected finite numbers");
    }
  }
  return out;
}

std::uint32_t Accessor::code(std::uint64_t index) const {
  const std::uint8_t* bytes = at(index);
  return bytes == nullptr ? 0 : code_of(component, bytes);
}

Document::Document(Bytes file, std::string path) : path_(std::move(path)), file_(std::move(file)) {
  std::span<const std::uint8_t> json = file_;
  if (file_.size() >= 4 && std::memcmp(file_.data(), "glTF", 4) == 0) {
    const Chunks chunks = chunks_of_glb(path_, file_);
    json = chunks.json;
    binary_ = chunks.binary;
    has_binary_ = chunks.has_binary;
  }
  const std::string_view text = without_mark({reinterpret_cast<const char*>(json.data()), json.size()});
  if (text.empty()) throw InputError(path_ + ": the JSON is broken: it is empty; expected glTF 2");
  if (parser_.allocate(text.size(), json_depth_limit) != simdjson::SUCCESS) throw std::bad_alloc();
  const simdjson::error_code error = parser_.parse(text.data(), text.size()).get(root_);
  if (error == simdjson::DEPTH_ERROR) {
    throw InputError(path_ + ": the JSON is nested too deep; expected at most " +
                     std::to_string(json_depth_limit) + " levels");
  }
  if (error == simdjson::MEMALLOC) throw std::bad_alloc();
  if (error != simdjson::SUCCESS) {
    throw InputError(path_ + ": the JSON is broken: " + simdjson::error_message(error) + "; expected glTF 2");
  }
  const Value asset = root().need("asset");
  const std::string_view version = asset.need("version").text();
  if (!version.starts_with("2.")) {
    asset.refuse("is glTF " + in_quotes(version) + "; expected 2.0");
  }
  if (const std::optional<Value> least = asset.find("minVersion"); least && least->text() != "2.0") {
    least->refuse("asks for glTF " + in_quotes(least->text()) + "; expected 2.0");
  }
}

const std::vector<Value>& Document::list(const std::string& key) {
  const auto [entry, is_new] = lists_.try_emplace(key);
  if (is_new) {
    if (const std::optional<Value> found = root().find(key)) entry->second = found->items();
  }
  return entry->second;
}

std::optional<std::size_t> Document::index(const Value& value, std::string_view key, const std::string& of) {
  const std::optional<Value> found = value.find(key);
  if (!found) return std::nullopt;
  const std::uint64_t index = found->whole();
  if (index >= list(of).size()) {
    found->refuse("is " + std::to_string(index) + "; expected an index below the " +
                  std::to_string(list(of).size()) + " " + of);
  }
  return index;
}

Bytes Document::read_buffer(const Value& buffer, std::size_t index, std::uint64_t length) {
  const std::optional<Value> uri = buffer.find("uri");
  if (!uri) {
    if (index != 0 || !has_binary_) buffer.refuse("has no \"uri\" and no chunk of a GLB; expected one");
    return {binary_.begin(), binary_.end()};
  }
  if (is_data_uri(uri->text())) {
    std::optional<Bytes> bytes = data_of_uri(uri->text());
    if (!bytes) uri->refuse("is broken; expected data:TYPE;base64,DIGITS");
    return *std::move(bytes);
  }
  const std::optional<std::string> name = path_of_uri(uri->text());
  if (!name) uri->refuse("has an illegal escape; expected % and two hexadecimal digits");
  return read_bytes((std::filesystem::path(path_).parent_path() / *name).string(), length);
}

std::span<const std::uint8_t> Document::buffer(std::size_t index) {
  const auto [entry, is_new] = buffers_.try_emplace(index);
  if (is_new) {
    const Value json = item("buffers", index);
    const std::uint64_t length = json.need("byteLength").whole();
    buffer_bytes_ += length;
    if (buffer_bytes_ > buffer_bytes_limit) json.refuse("is too large; expected at most 4 GiB of buffers");
    entry->second = read_buffer(json, index, length);
    if (entry->second.size() < length) {
      json.refuse("has " + std::to_string(entry->second.size()) + " bytes (truncated?); expected " +
                  std::to_string(length));
    }
    entry->second.resize(length);
  }
  return entry->second;
}

std::span<const std::uint8_t> Document::view(std::size_t index) {
  const Value json = item("bufferViews", index);
  json.need("buffer");
  const auto bytes = buffer(*this->index(json, "buffer", "buffers"));
  const std::uint64_t offset = json.whole("byteOffset", 0);
  const std::uint64_t length = json.need("byteLength").whole();
  if (offset > bytes.size() || length > bytes.size() - offset) {
    json.refuse("ends at byte " + std::to_string(offset + length) + "; expected at most " +
                std::to_string(bytes.size()) + ", the end of its buffer");
  }
  return bytes.subspan(offset, length);
}

void Document::read_sparse(const Value& sparse, std::uint64_t element_bytes, Accessor& accessor) {
  const std::uint64_t count = sparse.need("count").whole();
  if (count > accessor.count) {
    sparse.refuse("has " + std::to_string(count) + " elements; expected at most " +
                  std::to_string(accessor.count));
  }
  const auto bytes = [&](const Value& part, std::uint64_t size) {
    part.need("bufferView");
    const auto all = view(*index(part, "bufferView", "bufferViews"));
    const std::uint64_t offset = part.whole("byteOffset", 0);
    if (offset + count * size > all.size()) {
      part.refuse("ends at byte " + std::to_string(offset + count * size) + "; expected at most " +
                  std::to_string(all.size()) + ", the end of its buffer view");
    }
    return all.data() + offset;
  };
  const Value indices = sparse.need("indices");
  const Component component = component_of(indices.need("componentType"));
  if (!is_unsigned(component)) indices.refuse("is of a signed type; expected 5121, 5123 or 5125");
  const std::uint8_t* codes = bytes(indices, bytes_of(component));
  accessor.sparse_values = bytes(sparse.need("values"), element_bytes);
  accessor.sparse_indices.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint32_t code = code_of(component, codes + i * bytes_of(component));
    if (code >= accessor.count || (i > 0 && code <= accessor.sparse_indices.back())) {
      indices.refuse("index " + std::to_string(code) +
                     " is past the end or does not grow; expected growing " + "indices below " +
                     std::to_string(accessor.count));
    }
    accessor.sparse_indices.push_back(code);
  }
}

Accessor Document::accessor(std::size_t index) {
  const Value json = item("accessors", index);
  Accessor accessor;
  accessor.name = path_ + ": " + json.place();
  accessor.count = json.need("count").whole();
  accessor.component = component_of(json.need("componentType"));
  accessor.normalized = json.boolean("normalized", false);
  const std::string_view type = json.need("type").text();
  constexpr std::array<std::string_view, 4> types{"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto found = std::find(types.begin(), types.end(), type);
  if (found == types.end()) {
    json.refuse("is of type " + in_quotes(type) + "; expected SCALAR, VEC2, VEC3 or VEC4");
  }
  accessor.components = static_cast<unsigned>(found - types.begin()) + 1;
  const std::uint64_t element_bytes = std::uint64_t{accessor.components} * bytes_of(accessor.component);
  if (const auto view_index = this->index(json, "bufferView", "bufferViews")) {
    const auto bytes = view(*view_index);
    const Value view_json = item("bufferViews", *view_index);
    accessor.stride = view_json.whole("byteStride", element_bytes);
    if (view_json.find("byteStride") && (accessor.stride < element_bytes || accessor.stride > 252)) {
      view_json.refuse("byteStride is " + std::to_string(accessor.stride) + "; expected " +
                       std::to_string(element_bytes) + "..252");
    }
    const std::uint64_t offset = json.whole("byteOffset", 0);
    const std::uint64_t end =
        accessor.count == 0 ? offset : offset + (accessor.count - 1) * accessor.stride + element_bytes;
    if (end > bytes.size()) {
      json.refuse("ends at byte " + std::to_string(end) + "; expected at most " +
                  std::to_string(bytes.size()) + ", the end of its buffer view");
    }
    accessor.data = bytes.data() + offset;
  }
  if (const std::optional<Value> sparse = json.find("sparse")) read_sparse(*sparse, element_bytes, accessor);
  return accessor;
}

}  // namespace bitspan::gltf
