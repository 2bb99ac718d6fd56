// SPDX-License-Identifier: Apache-2.0
// Small glTF files for tests: a quad from -1 to 1, which a test changes.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace bitspan::testing_gltf {

using Json = nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

inline std::string base64(const Bytes& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return k < bytes.size() ? unsigned{bytes[k]} : 0U; };
    const unsigned group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (unsigned k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

template <class T>
int component_type() {
  if constexpr (std::is_same_v<T, float>) return 5126;
  if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
  if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
  if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
  if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
  return 5120;
}

// The JSON, and the bytes of its only buffer.
struct Gltf {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},  {"nodes", {{{"mesh", 0}}}},
               {"accessors", Json::array()},    {"bufferViews", Json::array()}};
  Bytes buffer;

  Json& primitive() { return json["meshes"][0]["primitives"][0]; }
  Json& attributes() { return primitive()["attributes"]; }
  Json& accessor(int index) { return json["accessors"][static_cast<std::size_t>(index)]; }
  Json& view(int index) { return json["bufferViews"][static_cast<std::size_t>(index)]; }

  template <class T>
  int add_view(const std::vector<T>& values) {
    while (buffer.size() % 4 != 0) buffer.push_back(0);
    const std::size_t offset = buffer.size(), size = values.size() * sizeof(T);
    buffer.resize(offset + size);
    if (size > 0) std::memcpy(&buffer[offset], values.data(), size);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  // "SCALAR", "VEC2", ...; returns the accessor's index.
  template <class T>
  int add(const char* type, const std::vector<T>& values, bool normalized = false) {
    const std::size_t components = type[0] == 'S' ? 1 : static_cast<std::size_t>(type[3] - '0');
    Json accessor = {{"bufferView", add_view(values)},
                     {"componentType", component_type<T>()},
                     {"count", values.size() / components},
                     {"type", type}};
    if (normalized) accessor["normalized"] = true;
    json["accessors"].push_back(accessor);
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  void finish(bool in_glb) {
    json["buffers"] = {{{"byteLength", buffer.size()}}};
    if (!in_glb) json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(buffer);
  }
  std::string text() {
    finish(false);
    return json.dump(1);
  }
  std::string glb() {
    finish(true);
    std::string head = json.dump();
    while (head.size() % 4 != 0) head += ' ';
    Bytes content = buffer;
    while (content.size() % 4 != 0) content.push_back(0);
    std::string out = "glTF";
    const auto put = [&](std::size_t number) {
      for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(number >> shift & 255);
    };
    put(2);
    put(12 + 8 + head.size() + 8 + content.size());
    put(head.size());
    out += "JSON" + head;
    put(content.size());
    out += std::string("BIN\0", 4) + std::string(content.begin(), content.end());
    return out;
  }
};

inline const std::vector<float> quad_positions{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
// The top left of the picture is the texture's top left.
inline const std::vector<float> quad_coordinates{0, 1, 1, 1, 1, 0, 0, 0};
inline const std::vector<std::uint16_t> quad_indices{0, 1, 2, 0, 2, 3};

inline Gltf quad() {
  Gltf gltf;
  const int position = gltf.add("VEC3", quad_positions);
  const int indices = gltf.add("SCALAR", quad_indices);
  gltf.json["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}}};
  return gltf;
}

// The quad with a material whose texture is the file `image`.
inline Gltf textured_quad(const std::string& image) {
  Gltf gltf = quad();
  gltf.attributes()["TEXCOORD_0"] = gltf.add("VEC2", quad_coordinates);
  gltf.primitive()["material"] = 0;
  gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["images"] = {{{"uri", image}}};
  return gltf;
}

}  // namespace bitspan::testing_gltf
