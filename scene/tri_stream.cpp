// SPDX-License-Identifier: Apache-2.0
#include "scene/tri_stream.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <istream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "config/config.hpp"
#include "config/fnv.hpp"
#include "io/atomic_file.hpp"
#include "io/json_depth.hpp"
#include "io/png.hpp"
#include "scene/exact.hpp"
#include "scene/place.hpp"
#include "scene/procedural.hpp"
#include "scene/project.hpp"
#include "scene/quick_triangle.hpp"
#include "scene/shadow.hpp"
#include "scene/texels.hpp"
#include "scene/texture.hpp"
#include "scene/trib.hpp"

namespace bitspan {
namespace {

constexpr std::size_t line_limit_bytes = std::size_t{1} << 20;

struct DuplicateKey : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// nlohmann's parser stores each key through operator[]; a second one of the same name would silently win.
template <class Key, class T, class Less, class Allocator>
struct UniqueMap : nlohmann::ordered_map<Key, T, Less, Allocator> {
  using Base = nlohmann::ordered_map<Key, T, Less, Allocator>;
  using Base::Base;
  using key_type = Key;
  T& operator[](const key_type& key) {
    const auto [position, inserted] = Base::emplace(key, T{});
    if (!inserted) throw DuplicateKey(key);
    return position->second;
  }
};

using Json = nlohmann::basic_json<UniqueMap>;

std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

// A JSON value as a message shows it: short, on one line.
std::string shown(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > 40) text = text.substr(0, 37) + "...";
  return text;
}

// A finite number; `key` is called for its name only when there is something to say.
template <class Name>
double number(const Json& value, const Place& place, const Name& key) {
  if (!value.is_number())
    place.fail(fmt::format("{}: {} is not a number; expected a finite number", key(), shown(value)));
  const double result = value.template get<double>();
  if (!std::isfinite(result)) place.fail(fmt::format("{}: is not finite; expected a finite number", key()));
  return result;
}

template <class Name>
const Json& array(const Json& value, std::size_t size, const Place& place, const Name& key,
                  const char* expected) {
  if (!value.is_array() || value.size() != size) {
    const std::string what =
        value.is_array() ? fmt::format("has {} elements", value.size()) : shown(value) + " is not an array";
    place.fail(fmt::format("{}: {}; expected {}", key(), what, expected));
  }
  return value;
}

// Brings colour components into 0..1. `scale` is color_max, or 0 where the header has none.
template <class Name>
void normalize(std::span<double> components, int scale, const Place& place, const Name& key) {
  const double limit = scale == 1 ? 1 : 255;
  bool codes = scale == 255;
  for (const double c : components) {
    if (!(c >= 0 && c <= limit)) {
      place.fail(fmt::format("{}: component {} is out of range; expected 0..{}", key(), shortest(c), limit));
    }
    if (scale == 0 && c > 1) codes = true;
  }
  if (!codes) return;
  for (double& c : components) c /= 255;
}

std::array<std::uint8_t, 3> color_codes(const Json& value, int scale, const Place& place, const char* name) {
  const auto key = [&] { return std::string(name); };
  array(value, 3, place, key, "[red, green, blue]");
  std::array<double, 3> c{};
  for (std::size_t i = 0; i < 3; ++i) c[i] = number(value[i], place, key);
  normalize(c, scale, place, key);
  std::array<std::uint8_t, 3> codes{};
  for (std::size_t i = 0; i < 3; ++i) codes[i] = static_cast<std::uint8_t>(std::floor(c[i] * 255 + 0.5));
  return codes;
}

void check_keys(const Json& object, std::span<const std::string_view> known, const Place& place,
                const std::string& inside) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    place.fail(
        fmt::format("{}{}: unknown key; expected {}", inside, shown(Json(key)), fmt::join(known, ", ")));
  }
}
void check_keys(const Json& object, std::initializer_list<std::string_view> known, const Place& place,
                const std::string& inside) {
  check_keys(object, std::span(known.begin(), known.size()), place, inside);
}

const Json& required(const Json& object, const char* key, const Place& place, const char* expected) {
  const auto found = object.find(key);
  if (found == object.end()) place.fail(fmt::format("{}: key is missing; expected {}", key, expected));
  return *found;
}

int integer(const Json& value, int low, int high, const Place& place, const char* key) {
  const bool whole = value.is_number_integer() && value >= Json(low) && value <= Json(high);
  if (!whole)
    place.fail(
        fmt::format("{}: {} is not legal; expected a whole number {}..{}", key, shown(value), low, high));
  return value.get<int>();
}

double positive(const Json& value, const Place& place, const char* key) {
  const double result = number(value, place, [&] { return std::string(key); });
  if (!(result > 0))
    place.fail(fmt::format("{}: {} is not positive; expected a number above 0", key, shortest(result)));
  return result;
}

void check_area(int width, int height, const Place& place) {
  if (static_cast<long>(width) * height > picture_area_limit) {
    place.fail(fmt::format("width: the picture of {} x {} pixels is too large; expected at most {} pixels",
                           width, height, picture_area_limit));
  }
}

// The bytes of a file of that size beside the stream.
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path, std::size_t size, const Place& place,
                                     const std::string& key) {
  std::error_code code;
  const std::uintmax_t found = std::filesystem::file_size(path, code);
  if (code) place.fail(fmt::format("{}: {}: cannot read: {}", key, path.string(), code.message()));
  if (found != size) {
    place.fail(fmt::format("{}: {}: has {} bytes; expected {}", key, path.string(), found, size));
  }
  std::vector<std::uint8_t> bytes(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) place.fail(fmt::format("{}: {}: cannot read; expected a readable file", key, path.string()));
  return bytes;
}

// Lists of `length` integers each, one list after the other.
void append_lists(const Json& value, std::size_t length, int low, int high, const Place& place,
                  const std::string& key, std::vector<std::int16_t>& out) {
  for (std::size_t k = 0; k < value.size(); ++k) {
    std::string at = fmt::format("{}[{}]", key, k);
    array(
        value[k], length, place, [&] { return at; }, "a list of integers");
    for (const Json& number : value[k]) {
      out.push_back(static_cast<std::int16_t>(integer(number, low, high, place, at.c_str())));
    }
  }
}

// What the codes of the format stand for; empty where the entry does not say.
std::vector<std::int16_t> read_texel_table(const Json& entry, TexelFormat format, const Place& place,
                                           const std::filesystem::path& folder, const std::string& key) {
  std::vector<std::int16_t> out;
  const int size = texel_layout(format).table_size;
  const auto refuse = [&](const char* name) {
    if (entry.contains(name)) {
      place.fail(
          fmt::format("{}.{}: the format {} has none; expected no such key", key, name, to_string(format)));
    }
  };
  if (size != palette_size) refuse("palette");
  if (size != yiq_table_size) refuse("yiq");
  if (const auto palette = entry.find("palette"); palette != entry.end()) {
    const std::string name = key + ".palette";
    if (palette->is_string()) {
      const auto bytes =
          read_bytes(folder / palette->get_ref<const std::string&>(), palette_size, place, name);
      out.assign(bytes.begin(), bytes.end());
      return out;
    }
    if (!palette->is_array() || palette->empty() || palette->size() > 256) {
      place.fail(name +
                 ": is not legal; expected a file name, or 1 to 256 colours [red, green, blue, alpha]");
    }
    append_lists(*palette, 4, 0, 255, place, name, out);
    out.resize(palette_size);
  }
  if (const auto yiq = entry.find("yiq"); yiq != entry.end()) {
    const std::string name = key + ".yiq";
    if (!yiq->is_object())
      place.fail(name + R"(: is not an object; expected {"y": ..., "i": ..., "q": ...})");
    check_keys(*yiq, {"y", "i", "q"}, place, name + ".");
    Json ys = Json::array();
    ys.push_back(required(*yiq, "y", place, "16 integers"));
    append_lists(ys, 16, 0, 255, place, name + ".y", out);
    for (const char* const part : {"i", "q"}) {
      std::string at = fmt::format("{}.{}", name, part);
      const Json& lists = required(*yiq, part, place, "4 lists [red, green, blue]");
      array(
          lists, 4, place, [&] { return at; }, "4 lists [red, green, blue]");
      append_lists(lists, 3, -256, 255, place, at, out);
    }
  }
  return out;
}

// A texture that is not a mere file name: an image to be converted, or texels as they lie in memory.
Texture read_formatted(const Json& entry, const Place& place, const std::filesystem::path& folder,
                       const std::string& key) {
  const bool raw = entry.contains("raw");
  const char* const source = raw ? "raw" : "file";
  const std::string inside = key + ".";
  if (raw) {
    check_keys(entry, {"raw", "format", "width", "height", "palette", "yiq"}, place, inside);
  } else {
    check_keys(entry, {"file", "format", "palette", "yiq"}, place, inside);
  }
  const Json& name = required(entry, source, place, "a file name");
  if (!name.is_string() || name.get_ref<const std::string&>().empty()) {
    place.fail(fmt::format("{}{}: {} is not a file name; expected a string", inside, source, shown(name)));
  }
  const Json& wanted = required(entry, "format", place, "the name of a texel format");
  const auto all = std::span(enum_names<TexelFormat>);
  const auto found =
      wanted.is_string() ? std::ranges::find(all, wanted.get_ref<const std::string&>()) : all.end();
  const auto format = static_cast<TexelFormat>(found - all.begin());
  if (found == all.end() || is_procedural(format)) {
    std::vector<std::string_view> names;
    for (std::size_t f = 0; f < all.size(); ++f) {
      if (!is_procedural(static_cast<TexelFormat>(f))) names.push_back(all[f]);
    }
    place.fail(fmt::format("{}format: {} is not legal; expected one of {}", inside, shown(wanted),
                           fmt::join(names, ", ")));
  }
  std::vector<std::int16_t> table = read_texel_table(entry, format, place, folder, key);
  const std::filesystem::path path = folder / name.get_ref<const std::string&>();
  if (!raw) {
    try {
      return converted(read_texture(path.string()), format, std::move(table));
    } catch (const InputError& error) {
      place.fail(fmt::format("{}: {}", key, error.what()));
    }
  }
  if (static_cast<int>(table.size()) != texel_layout(format).table_size) {
    const char* const part = texel_layout(format).table_size == palette_size ? "palette" : "yiq";
    place.fail(
        fmt::format("{}{}: key is missing; expected the table of {}", inside, part, to_string(format)));
  }
  Texture out;
  out.format = format;
  out.width = integer(required(entry, "width", place, "texels"), 1, texture_size_limit, place, "width");
  out.height = integer(required(entry, "height", place, "texels"), 1, texture_size_limit, place, "height");
  out.table = std::move(table);
  auto& texels = format == TexelFormat::rgba8888 ? out.rgba : out.raw;
  texels = read_bytes(path, raw_size(format, out.width, out.height), place, inside + "raw");
  return out;
}

// A texture whose texels are computed [T9].
Texture read_procedural(const Json& entry, const Place& place, const std::string& key) {
  check_keys(entry, {"procedural"}, place, key + ".");
  const Json& from = entry["procedural"];
  const std::string inside = key + ".procedural.";
  if (!from.is_object()) {
    place.fail(fmt::format("{}.procedural: {} is not an object; expected {{\"kind\": \"checker\", ...}}", key,
                           shown(from)));
  }
  const auto kinds =
      std::span(enum_names<TexelFormat>).subspan(static_cast<std::size_t>(TexelFormat::checker), 3);
  const Json& wanted = required(from, "kind", place, "checker, brick or noise");
  const auto found =
      wanted.is_string() ? std::ranges::find(kinds, wanted.get_ref<const std::string&>()) : kinds.end();
  if (found == kinds.end()) {
    place.fail(fmt::format("{}kind: {} is not legal; expected one of {}", inside, shown(wanted),
                           fmt::join(kinds, ", ")));
  }
  Texture out;
  out.name = *found;
  out.format = static_cast<TexelFormat>(static_cast<int>(TexelFormat::checker) + (found - kinds.begin()));
  const auto values = procedural_values(out.format);
  std::vector<std::string_view> known{"kind", "width", "height", "colors"};
  for (const ProceduralValue& value : values) known.push_back(value.key);
  check_keys(from, known, place, inside);
  const auto whole = [&](std::string_view name, int low, int high) {
    const std::string at = inside + std::string(name);
    const auto value = from.find(std::string(name));
    if (value == from.end()) place.fail(at + ": key is missing; expected a whole number");
    return integer(*value, low, high, place, at.c_str());
  };
  out.width = whole("width", 1, texture_size_limit);
  out.height = whole("height", 1, texture_size_limit);
  const auto colors = from.find("colors");
  if (colors == from.end() || !colors->is_array() || colors->size() != 2) {
    place.fail(inside + "colors: is not legal; expected two colours [red, green, blue, alpha]");
  }
  append_lists(*colors, 4, 0, 255, place, inside + "colors", out.table);
  for (const ProceduralValue& value : values) {
    out.table.push_back(static_cast<std::int16_t>(whole(value.key, value.low, value.high)));
  }
  if (const std::string fault = procedural_fault(out); !fault.empty()) place.fail(inside + fault);
  return out;
}

// A texture of the header, whatever it is made of; not a dynamic one.
Texture read_entry(const Json& entry, int version, const Place& place, const std::filesystem::path& folder,
                   const std::string& key) {
  if (version >= 2 && entry.is_object()) {
    if (entry.contains("procedural")) return read_procedural(entry, place, key);
    Texture out = read_formatted(entry, place, folder, key);
    out.name = entry[entry.contains("raw") ? "raw" : "file"].get<std::string>();
    return out;
  }
  if (!entry.is_string() || entry.get_ref<const std::string&>().empty()) {
    place.fail(fmt::format("{}: {} is not a file name; expected a string", key, shown(entry)));
  }
  const auto& name = entry.get_ref<const std::string&>();
  try {
    Texture out = read_texture((folder / name).string());
    out.name = name;
    return out;
  } catch (const InputError& error) {
    place.fail(fmt::format("{}: {}", key, error.what()));
  }
}

// Where a texture of the header stands among the scene's. frames: how many images a dynamic one has; 0: it is
// none.
struct HeaderTexture {
  int first = 0, frames = 0;

  // The scene's texture while a dynamic one shows image `frame`.
  int shown(int frame) const { return first + (frames == 0 ? 0 : frame); }
};

HeaderTexture append_texture(const Json& entry, int version, const Place& place,
                             const std::filesystem::path& folder, const std::string& key,
                             std::vector<Texture>& textures) {
  HeaderTexture out{static_cast<int>(textures.size()), 0};
  if (version < 2 || !entry.is_object() || !entry.contains("frames")) {
    textures.push_back(read_entry(entry, version, place, folder, key));
    return out;
  }
  check_keys(entry, {"frames"}, place, key + ".");
  const Json& frames = entry["frames"];
  if (!frames.is_array() || frames.empty()) {
    place.fail(fmt::format("{}.frames: {} is not legal; expected a list of textures", key, shown(frames)));
  }
  for (const Json& frame : frames) {
    const std::string at = fmt::format("{}.frames[{}]", key, out.frames++);
    textures.push_back(read_entry(frame, version, place, folder, at));
    const Texture& first = textures[static_cast<std::size_t>(out.first)];
    const Texture& own = textures.back();
    if (own.width == first.width && own.height == first.height) continue;
    place.fail(fmt::format("{}: has {} x {} texels; expected {} x {}, as frames[0]", at, own.width,
                           own.height, first.width, first.height));
  }
  return out;
}

Fog read_fog(const Json& value, int color_max, const Place& place, const std::string& inside) {
  const std::string key = inside + "fog";
  if (!value.is_object()) {
    place.fail(key + ": " + shown(value) +
               " is not an object; expected {\"color\": [r,g,b], \"distance\": d}");
  }
  check_keys(value, {"color", "distance"}, place, key + ".");
  Fog fog;
  if (!value.contains("color")) place.fail(key + ".color: key is missing; expected [red, green, blue]");
  if (!value.contains("distance")) {
    place.fail(key + ".distance: key is missing; expected a distance above 0");
  }
  fog.color = color_codes(value["color"], color_max, place, (key + ".color").c_str());
  fog.distance = positive(value["distance"], place, (key + ".distance").c_str());
  return fog;
}

Projector read_projector(const Json& value, const Place& place, const std::string& inside) {
  const std::string key = inside + "projector";
  if (!value.is_object()) {
    place.fail(key + ": " + shown(value) + " is not an object; expected {\"s_min\": a, \"s_max\": b}");
  }
  check_keys(value, {"s_min", "s_max"}, place, key + ".");
  const auto distance = [&](const char* end) {
    const std::string name = key + "." + end;
    if (!value.contains(end)) place.fail(name + ": key is missing; expected a distance above 0");
    return positive(value[end], place, name.c_str());
  };
  const Projector projector{distance("s_min"), distance("s_max")};
  if (!(projector.s_min < projector.s_max)) {
    place.fail(fmt::format("{}.s_min: {} is not below s_max = {}; expected 0 < s_min < s_max", key,
                           shortest(projector.s_min), shortest(projector.s_max)));
  }
  return projector;
}

// s_max: of the view, or 0 where it is not known yet.
Light read_light(const Json& value, const Place& place, const std::string& inside, double s_max) {
  const std::string key = inside + "light";
  constexpr std::string_view expected = R"({"direction": [x,y,z]} or {"position": [x,y,z]})";
  if (!value.is_object())
    place.fail(fmt::format("{}: {} is not an object; expected {}", key, shown(value), expected));
  check_keys(value, {"direction", "position", "ambient", "specular", "exponent", "lunar", "reach", "offset"},
             place, key + ".");
  Light light;
  light.is_point = value.contains("position");
  if (light.is_point == value.contains("direction")) {
    place.fail(
        fmt::format("{}: has {}; expected {}", key, light.is_point ? "both keys" : "neither key", expected));
  }
  const std::string at = light.is_point ? "position" : "direction";
  const auto name = [&] { return key + "." + at; };
  const Json& parts = array(value[at], 3, place, name, "[x, y, z]");
  for (std::size_t i = 0; i < 3; ++i) light.place[i] = number(parts[i], place, name);
  const auto share = [&](const char* of, double& to) {
    if (value.contains(of)) to = number(value[of], place, [&] { return key + "." + of; });
  };
  share("ambient", light.ambient);
  share("specular", light.specular);
  share("lunar", light.lunar);
  share("reach", light.reach);
  share("offset", light.offset);
  if (value.contains("exponent")) {
    light.exponent = integer(value["exponent"], 1, light_exponent_limit, place, (key + ".exponent").c_str());
  }
  if (const std::string fault = light_fault(light, s_max); !fault.empty()) place.fail(key + fault);
  return light;
}

// codes: what the shadow has besides.
ShadowOptions read_shadow(const Json& value, const Place& place, const ShadowOptions& codes) {
  ShadowOptions shadow = codes;
  if (!value.is_object()) {
    place.fail("shadow: " + shown(value) + " is not an object; expected {\"light\": [x,y,z]}");
  }
  check_keys(value, {"light", "at", "degrees", "map", "bias", "dark", "plane", "volumes"}, place, "shadow.");
  const auto numbers = [&](std::string_view name, std::size_t count, const char* expected) {
    const auto key = [&] { return "shadow." + std::string(name); };
    const Json& list = array(value[std::string(name)], count, place, key, expected);
    std::vector<double> out;
    for (const Json& part : list) out.push_back(number(part, place, key));
    return out;
  };
  const auto one = [&](std::string_view name) {
    return number(value[std::string(name)], place, [&] { return "shadow." + std::string(name); });
  };
  if (!value.contains("light")) place.fail("shadow.light: key is missing; expected [x, y, z]");
  const std::vector<double> light = numbers("light", 3, "[x, y, z]");
  shadow.light = {light[0], light[1], light[2]};
  if (value.contains("plane")) {
    const std::vector<double> p = numbers("plane", 6, "a point and a normal [x, y, z, nx, ny, nz]");
    shadow.plane = Plane{{p[0], p[1], p[2]}, {p[3], p[4], p[5]}};
  }
  if (value.contains("volumes")) {
    if (!value["volumes"].is_boolean()) {
      place.fail("shadow.volumes: " + shown(value["volumes"]) + " is not legal; expected true or false");
    }
    shadow.volumes = value["volumes"].get<bool>();
  }
  for (const char* of_map : {"at", "degrees", "map", "bias"}) {
    if (value.contains(of_map) && (shadow.plane || shadow.volumes)) {
      place.fail(fmt::format("shadow.{}: is of a map; expected none with plane or volumes", of_map));
    }
  }
  if (value.contains("at")) {
    const std::vector<double> at = numbers("at", 3, "[x, y, z]");
    shadow.at = Vec3{at[0], at[1], at[2]};
  }
  if (value.contains("degrees")) shadow.degrees = one("degrees");
  if (value.contains("map")) shadow.size = integer(value["map"], 1, shadow_map_limit, place, "shadow.map");
  if (value.contains("bias") && value["bias"] != Json("auto")) shadow.bias = one("bias");
  if (value.contains("dark")) shadow.dark = one("dark");
  try {
    check_shadow(shadow, {.size = "shadow.map"});
  } catch (const InputError& error) {
    place.fail(error.what());
  }
  return shadow;
}

// Entry `index` of the header's quadrics.
Quadric read_quadric(const Json& value, std::size_t index, const Place& place) {
  const std::string key = fmt::format("quadrics[{}]", index);
  constexpr std::string_view expected =
      R"({"triangles": [first, last], "matrix": [...], "within": [low, high]})";
  if (!value.is_object())
    place.fail(fmt::format("{}: {} is not an object; expected {}", key, shown(value), expected));
  check_keys(value, {"triangles", "matrix", "within", "two_sided", "clip"}, place, key + ".");
  const auto numbers = [&](const Json& in, const std::string& inside, const char* name, auto& to,
                           const char* what) {
    const auto path = [&] { return inside + name; };
    if (!in.contains(name)) place.fail(fmt::format("{}: key is missing; expected {}", path(), what));
    const Json& list = array(in[name], to.size(), place, path, what);
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = number(list[i], place, path);
  };
  Quadric out;
  std::array<double, 2> range{};
  numbers(value, key + ".", "triangles", range, "[first, last]");
  const auto [first, last] = range;
  constexpr double most = 1e15;
  if (!(first >= 0 && first <= last && last < most) || first != std::floor(first) ||
      last != std::floor(last)) {
    place.fail(fmt::format("{}.triangles: {} is not legal; expected [first, last], whole numbers from 0 on",
                           key, shown(value["triangles"])));
  }
  out.first = static_cast<std::size_t>(first);
  out.count = static_cast<std::size_t>(last - first) + 1;
  numbers(value, key + ".", "matrix", out.matrix, "10 numbers, the rows of the form from the diagonal on");
  std::array<double, 2> within{};
  numbers(value, key + ".", "within", within, "[low, high]");
  out.low = within[0];
  out.high = within[1];
  const auto flag = [&](const Json& of, const std::string& path) {
    if (!of.is_boolean())
      place.fail(fmt::format("{}: {} is not legal; expected true or false", path, shown(of)));
    return of.get<bool>();
  };
  if (value.contains("two_sided")) out.two_sided = flag(value["two_sided"], key + ".two_sided");
  if (value.contains("clip")) {
    const Json& clip = value["clip"];
    const std::string inside = key + ".clip.";
    if (!clip.is_object()) {
      place.fail(fmt::format("{}.clip: {} is not an object; expected {}", key, shown(clip),
                             R"({"axis": [x, y, s, constant], "from": a, "to": b, "caps": [from, to]})"));
    }
    check_keys(clip, {"axis", "from", "to", "caps"}, place, inside);
    QuadricClip& to = out.clip.emplace();
    numbers(clip, inside, "axis", to.axis, "[x, y, s, constant]");
    for (const auto& [name, end] : {std::pair{"from", &to.from}, std::pair{"to", &to.to}}) {
      const auto path = [&, name = name] { return inside + name; };
      if (!clip.contains(name)) place.fail(path() + ": key is missing; expected a number");
      *end = number(clip[name], place, path);
    }
    if (clip.contains("caps")) {
      const auto path = [&] { return inside + "caps"; };
      const Json& caps = array(clip["caps"], 2, place, path, "[true or false, true or false]");
      to.cap_from = flag(caps[0], path());
      to.cap_to = flag(caps[1], path());
    }
  }
  if (const std::string fault = quadric_fault(out); !fault.empty()) place.fail(key + fault);
  return out;
}

Scene read_header(const Json& line, const Place& place, const std::filesystem::path& folder, int& color_max,
                  int& version, std::vector<HeaderTexture>& textures, const ShadowOptions& codes,
                  std::optional<ShadowOptions>& shadow) {
  if (!line.is_object() || !line.contains("bitspan")) {
    place.fail("bitspan: no header; expected a first line {\"bitspan\": 1, \"width\": ..., ...}");
  }
  version = integer(line["bitspan"], 1, 2, place, "bitspan");
  check_keys(line,
             {"bitspan", "width", "height", "s_min", "s_max", "focal", "background", "color_max", "fog",
              "projector", "light", "shadow", "quadrics", "textures"},
             place, "");
  Scene scene;
  scene.width = integer(required(line, "width", place, "pixels"), 1, picture_size_limit, place, "width");
  scene.height = integer(required(line, "height", place, "pixels"), 1, picture_size_limit, place, "height");
  check_area(scene.width, scene.height, place);
  scene.s_min = positive(required(line, "s_min", place, "a distance"), place, "s_min");
  scene.s_max = positive(required(line, "s_max", place, "a distance"), place, "s_max");
  if (!(scene.s_min < scene.s_max)) {
    place.fail(fmt::format("s_min: {} is not below s_max = {}; expected 0 < s_min < s_max",
                           shortest(scene.s_min), shortest(scene.s_max)));
  }
  scene.focal = positive(required(line, "focal", place, "pixels"), place, "focal");
  color_max = 0;
  if (const auto found = line.find("color_max"); found != line.end()) {
    if (*found != Json(1) && *found != Json(255)) {
      place.fail(fmt::format("color_max: {} is not legal; expected 1 or 255", shown(*found)));
    }
    color_max = found->get<int>();
  }
  scene.background =
      color_codes(required(line, "background", place, "[red, green, blue]"), color_max, place, "background");
  if (const auto found = line.find("fog"); found != line.end()) {
    scene.fog = read_fog(*found, color_max, place, "");
  }
  if (const auto found = line.find("projector"); found != line.end()) {
    if (version < 2) place.fail("projector: is not legal in version 1; expected \"bitspan\": 2");
    scene.projector = read_projector(*found, place, "");
  }
  if (const auto found = line.find("light"); found != line.end()) {
    if (version < 2) place.fail("light: is not legal in version 1; expected \"bitspan\": 2");
    scene.light = read_light(*found, place, "", scene.s_max);
  }
  if (const auto found = line.find("shadow"); found != line.end()) {
    if (version < 2) place.fail("shadow: is not legal in version 1; expected \"bitspan\": 2");
    shadow = read_shadow(*found, place, codes);
  }
  if (const auto found = line.find("quadrics"); found != line.end()) {
    if (version < 2) place.fail("quadrics: is not legal in version 1; expected \"bitspan\": 2");
    if (!found->is_array() || found->size() > quadrics_limit) {
      place.fail(fmt::format("quadrics: {} is not legal; expected a list of at most {}", shown(*found),
                             quadrics_limit));
    }
    for (std::size_t i = 0; i < found->size(); ++i) {
      scene.quadrics.push_back(read_quadric((*found)[i], i, place));
    }
  }
  if (const auto found = line.find("textures"); found != line.end()) {
    if (!found->is_array())
      place.fail("textures: " + shown(*found) + " is not an array; expected a list of image file names");
    for (std::size_t i = 0; i < found->size(); ++i) {
      textures.push_back(append_texture((*found)[i], version, place, folder, fmt::format("textures[{}]", i),
                                        scene.textures));
    }
  }
  return scene;
}

// A line of a stream gives so many vertices under that key.
std::size_t vertices_of(const Triangle& triangle) { return triangle.is_line ? 2 : 3; }
const char* key_of(const Triangle& triangle) { return triangle.is_line ? "l" : "v"; }

// Ranges of one vertex; the same for streams read and scenes written.
void check_vertex(const Triangle& triangle, std::size_t i, const View& view, const Place& place) {
  const Vertex& vertex = triangle.v[i];
  const char* const key = key_of(triangle);
  const auto check_coordinate = [&](double value, const char* axis, int index) {
    if (!(std::fabs(value) <= coordinate_limit)) {
      place.fail(fmt::format("{}[{}][{}]: {} = {} is out of range; expected {}..{} pixels", key, i, index,
                             axis, shortest(value), -coordinate_limit, coordinate_limit));
    }
  };
  check_coordinate(vertex.x, "x", 0);
  check_coordinate(vertex.y, "y", 1);
  if (!(vertex.s >= view.s_min && vertex.s <= view.s_max)) {
    place.fail(fmt::format("{}[{}][2]: s = {} is out of range; expected s_min..s_max, {}..{}", key, i,
                           shortest(vertex.s), shortest(view.s_min), shortest(view.s_max)));
  }
  if (!std::isfinite(vertex.u) || !std::isfinite(vertex.v)) {
    place.fail(fmt::format("{}[{}]: u, v are not finite; expected finite numbers", key, i));
  }
}

void check_given(const Triangle& triangle, const Place& place) {
  for (const GivenAttribute& given : given_attributes) {
    for (std::size_t i = 0; i < 3 && given.is_given(triangle.v); ++i) {
      const double value = triangle.v[i].*given.member;
      if (given.is_legal(value)) continue;
      place.fail(fmt::format("{}[{}]: {} is out of range; expected {}", given.key, i, shortest(value),
                             given.range == AttributeRange::unit ? "0..1" : "a finite number"));
    }
  }
}

void check_shape(const Triangle& triangle, const Place& place) {
  if (!triangle.is_line && orientation(triangle) == 0) {
    place.fail("v: the triangle has no area; expected three positions that are not on one line");
  }
}

void set_colors(Triangle& triangle, std::array<double, 12> components, int color_max, const Place& place) {
  normalize(components, color_max, place, [] { return "c"; });
  for (std::size_t i = 0; i < 12; ++i) triangle.v[i / 4].c[i % 4] = components[i];
}

// The scene's number of a texture that a triangle names by the header's.
int texture_shown(const Json& value, std::span<const HeaderTexture> textures, int frame, const Place& place) {
  if (textures.empty()) place.fail("tex: the header names no textures; expected no \"tex\"");
  const int index = integer(value, 0, static_cast<int>(textures.size()) - 1, place, "tex");
  return textures[static_cast<std::size_t>(index)].shown(frame);
}

bool is_line(const Json& line) { return line.is_object() && line.contains("l"); }

// Of a triangle's line or a line's.
Triangle read_triangle(const Json& line, const View& view, std::span<const HeaderTexture> textures, int frame,
                       int color_max, int version, const Place& place) {
  if (!line.is_object())
    place.fail(shown(line) + " is not an object; expected {\"v\": [...], \"c\": [...], \"tex\": 0}");
  std::vector<std::string_view> keys{"v", "c", "tex"};
  for (const GivenAttribute& given : given_attributes) {
    if (version >= 2) keys.push_back(given.key);
  }
  Triangle triangle;
  triangle.is_line = is_line(line);
  const std::string name = key_of(triangle);
  keys.front() = name;
  check_keys(line, keys, place, "");
  if (triangle.is_line && version < 2) {
    place.fail("bitspan: a stream of version 1 has no lines; expected a header {\"bitspan\": 2, ...}");
  }
  const std::size_t count = vertices_of(triangle);
  const char* const number_of = triangle.is_line ? "two" : "three";
  const std::string expected = fmt::format("{} vertices [x, y, s, u, v]", number_of);
  const Json& v = required(line, name.c_str(), place, expected.c_str());
  array(
      v, count, place, [&] { return std::string(name); }, expected.c_str());
  for (std::size_t i = 0; i < count; ++i) {
    const auto key = [&] { return fmt::format("{}[{}]", name, i); };
    array(v[i], 5, place, key, "[x, y, s, u, v]");
    std::array<double, 5> value{};
    for (std::size_t j = 0; j < 5; ++j) {
      value[j] = number(v[i][j], place, [&] { return fmt::format("{}[{}][{}]", name, i, j); });
    }
    Vertex& vertex = triangle.v[i];
    vertex.x = value[0];
    vertex.y = value[1];
    vertex.s = value[2];
    vertex.u = value[3];
    vertex.v = value[4];
    check_vertex(triangle, i, view, place);
  }
  check_shape(triangle, place);
  if (const auto c = line.find("c"); c != line.end()) {
    const std::string colours = fmt::format("{} colours [red, green, blue, alpha]", number_of);
    array(
        *c, count, place, [] { return "c"; }, colours.c_str());
    std::array<double, 12> components{};
    for (std::size_t i = 0; i < count; ++i) {
      array((*c)[i], 4, place, [&] { return fmt::format("c[{}]", i); }, "[red, green, blue, alpha]");
      for (std::size_t j = 0; j < 4; ++j) {
        components[4 * i + j] = number((*c)[i][j], place, [&] { return fmt::format("c[{}][{}]", i, j); });
      }
    }
    set_colors(triangle, components, color_max, place);
  }
  for (const GivenAttribute& given : given_attributes) {
    const auto values = line.find(given.key);
    if (values == line.end()) continue;
    array(
        *values, count, place, [&] { return given.key; }, "a number per vertex");
    for (std::size_t i = 0; i < count; ++i) {
      const auto key = [&] { return fmt::format("{}[{}]", given.key, i); };
      triangle.v[i].*given.member = number((*values)[i], place, key);
    }
  }
  if (triangle.is_line) triangle.v[2] = triangle.v[1];
  check_given(triangle, place);
  if (const auto tex = line.find("tex"); tex != line.end()) {
    triangle.texture = texture_shown(*tex, textures, frame, place);
  }
  return triangle;
}

// Checks what read_triangle does, in its order. `texture` is known to be there.
Triangle finished(const TriangleLine& line, const View& view, std::span<const HeaderTexture> textures,
                  int frame, int color_max, const Place& place) {
  Triangle triangle = line.triangle;
  for (std::size_t i = 0; i < 3; ++i) check_vertex(triangle, i, view, place);
  check_shape(triangle, place);
  if (line.colors) set_colors(triangle, *line.colors, color_max, place);
  check_given(triangle, place);
  if (line.texture) triangle.texture = textures[static_cast<std::size_t>(*line.texture)].shown(frame);
  return triangle;
}

StateSetting read_setting(const std::string& key, const Json& value, const Place& place) {
  const auto index = find_state_register(key);
  if (!index) {
    std::vector<std::string_view> keys;
    for (const StateRegister& r : state_registers()) keys.push_back(r.key);
    place.fail(fmt::format("state.{}: unknown register; expected {}", key, fmt::join(keys, ", ")));
  }
  const StateRegister& r = state_registers()[*index];
  if (r.is_truth) {
    if (!value.is_boolean())
      place.fail(fmt::format("state.{}: {} is not legal; expected true or false", key, shown(value)));
    return {*index, value.get<bool>() ? 1 : 0};
  }
  if (!r.names.empty()) {
    const auto* name = value.get_ptr<const std::string*>();
    const auto found = name == nullptr ? r.names.end() : std::ranges::find(r.names, std::string_view(*name));
    if (found == r.names.end()) {
      place.fail(
          fmt::format("state.{}: {} is not legal; expected {}", key, shown(value), fmt::join(r.names, ", ")));
    }
    return {*index, found - r.names.begin()};
  }
  if (!value.is_number_integer() || value < Json(r.low) || value > Json(r.high)) {
    place.fail(fmt::format("state.{}: {} is not legal; expected a whole number {}..{}", key, shown(value),
                           r.low, r.high));
  }
  return {*index, value.get<std::int64_t>()};
}

bool is_command(const Json& line) {
  return line.is_object() && (line.contains("state") || line.contains("clear") || line.contains("target") ||
                              line.contains("view") || line.contains("copy") || line.contains("resolve") ||
                              line.contains("frame"));
}

bool truth(const Json& value, const Place& place, const char* key) {
  if (!value.is_boolean())
    place.fail(fmt::format("{}: {} is not legal; expected true or false", key, shown(value)));
  return value.get<bool>();
}

ViewChange read_view(const Json& value, int color_max, const Place& place) {
  constexpr std::string_view expected =
      "width, height, s_min, s_max, focal, background, fog, projector or light";
  if (!value.is_object()) {
    place.fail(fmt::format("view: {} is not an object; expected {{\"width\": 256, ...}}", shown(value)));
  }
  check_keys(value, {"width", "height", "s_min", "s_max", "focal", "background", "fog", "projector", "light"},
             place, "view.");
  if (value.empty()) place.fail(fmt::format("view: no key; expected {}", expected));
  ViewChange change;
  for (const auto& [key, part] : value.items()) {
    const std::string name = "view." + key;
    const char* const at = name.c_str();
    if (key == "width") change.width = integer(part, 1, picture_size_limit, place, at);
    if (key == "height") change.height = integer(part, 1, picture_size_limit, place, at);
    if (key == "s_min") change.s_min = positive(part, place, at);
    if (key == "s_max") change.s_max = positive(part, place, at);
    if (key == "focal") change.focal = positive(part, place, at);
    if (key == "background") change.background = color_codes(part, color_max, place, at);
    if (key == "fog") {
      change.fog.emplace();
      if (!part.is_null()) *change.fog = read_fog(part, color_max, place, "view.");
    }
    if (key == "projector") {
      change.projector.emplace();
      if (!part.is_null()) *change.projector = read_projector(part, place, "view.");
    }
    if (key == "light") {
      change.light.emplace();
      if (!part.is_null()) *change.light = read_light(part, place, "view.", 0);
    }
  }
  return change;
}

Copy read_copy(const Json& value, const Place& place) {
  if (!value.is_object()) {
    place.fail("copy: " + shown(value) +
               " is not an object; expected {\"target\": K, \"plane\": \"color\", \"texture\": N}");
  }
  check_keys(value, {"target", "plane", "texture"}, place, "copy.");
  const auto of = [&](const char* key, const char* expected) -> const Json& {
    if (!value.contains(key)) place.fail(fmt::format("copy.{}: key is missing; expected {}", key, expected));
    return value[key];
  };
  Copy copy;
  copy.target = integer(of("target", "a target"), 0, target_limit - 1, place, "copy.target");
  const Json& plane = of("plane", "color or depth");
  if (plane != Json("color") && plane != Json("depth")) {
    place.fail(fmt::format("copy.plane: {} is not legal; expected color or depth", shown(plane)));
  }
  copy.plane = plane == Json("depth") ? CopyPlane::depth : CopyPlane::color;
  copy.texture = integer(of("texture", "an index"), 0, texture1_limit, place, "copy.texture");
  return copy;
}

DrawCommand read_command(const Json& line, int color_max, const Place& place) {
  if (const auto found = line.find("resolve"); found != line.end()) {
    check_keys(line, {"resolve"}, place, "");
    if (*found != Json(true)) place.fail("resolve: " + shown(*found) + " is not legal; expected true");
    return {.what = Resolve{}};
  }
  if (const auto found = line.find("copy"); found != line.end()) {
    check_keys(line, {"copy"}, place, "");
    return {.what = read_copy(*found, place)};
  }
  if (const auto found = line.find("view"); found != line.end()) {
    check_keys(line, {"view"}, place, "");
    return {.what = read_view(*found, color_max, place)};
  }
  if (const auto found = line.find("target"); found != line.end()) {
    check_keys(line, {"target"}, place, "");
    return {.what = Target{integer(*found, 0, target_limit - 1, place, "target")}};
  }
  if (const auto found = line.find("clear"); found != line.end()) {
    check_keys(line, {"clear"}, place, "");
    if (!found->is_object()) {
      place.fail(
          "clear: " + shown(*found) +
          " is not an object; expected {\"color\": [r,g,b], \"alpha\": a, \"depth\": true, \"stencil\": n}");
    }
    check_keys(*found, {"color", "alpha", "depth", "stencil", "masked"}, place, "clear.");
    if (found->size() == found->count("masked"))
      place.fail("clear: no plane; expected color, alpha, depth or stencil");
    Clear clear;
    for (const auto& [key, value] : found->items()) {
      if (key == "color") clear.color = color_codes(value, color_max, place, "clear.color");
      if (key == "alpha")
        clear.alpha = static_cast<std::uint8_t>(integer(value, 0, 255, place, "clear.alpha"));
      if (key == "depth") clear.depth = truth(value, place, "clear.depth");
      if (key == "masked") clear.masked = truth(value, place, "clear.masked");
      if (key == "stencil") {
        clear.stencil = static_cast<std::uint8_t>(integer(value, 0, 255, place, "clear.stencil"));
      }
    }
    return {.what = clear};
  }
  check_keys(line, {"state", "reset"}, place, "");
  const Json& state = line["state"];
  if (!state.is_object()) {
    place.fail("state: " + shown(state) + " is not an object; expected {\"depth.func\": \"lequal\", ...}");
  }
  StateChange change;
  if (const auto found = line.find("reset"); found != line.end()) {
    change.reset = truth(*found, place, "reset");
  }
  for (const auto& [key, value] : state.items()) {
    change.settings.push_back(read_setting(key, value, place));
  }
  return {.what = change};
}

// The lines of a stream, whose length is bounded.
class LineReader {
 public:
  explicit LineReader(std::istream& in) : in_(in), buffer_(std::size_t{1} << 16) {}

  // Returns false at the end. `place` is the line's.
  bool next(std::string& line, Place& place) {
    line.clear();
    ++place.at;
    while (true) {
      if (begin_ == end_) {
        in_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        begin_ = 0;
        end_ = static_cast<std::size_t>(in_.gcount());
        if (in_.bad()) place.fail("cannot read the file; expected a readable file");
        if (end_ == 0) return !line.empty();
      }
      const char* start = buffer_.data() + begin_;
      const auto* newline = static_cast<const char*>(std::memchr(start, '\n', end_ - begin_));
      const std::size_t count = newline ? static_cast<std::size_t>(newline - start) : end_ - begin_;
      if (line.size() + count > line_limit_bytes) {
        place.fail(fmt::format("the line is too long; expected JSON Lines of at most {} bytes per line",
                               line_limit_bytes));
      }
      line.append(start, count);
      begin_ += count + (newline ? 1 : 0);
      if (newline) return true;
    }
  }

 private:
  std::istream& in_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

Json parse_line(const std::string& line, const Place& place) {
  // Messages show values by a recursion over their depth.
  if (line_nested_too_deep(line)) {
    place.fail(fmt::format("arrays and objects are nested more than {} deep; expected at most that many",
                           json_depth_limit));
  }
  try {
    return Json::parse(line);
  } catch (const Json::parse_error& error) {
    const bool ended = error.byte > line.size();
    place.fail(ended ? "the line ends inside its JSON (truncated?); expected one whole JSON object a line"
                     : fmt::format("not JSON at column {}; expected one JSON object a line", error.byte));
  } catch (const Json::out_of_range&) {
    place.fail("a number is too large for double precision; expected finite numbers");
  } catch (const DuplicateKey& error) {
    place.fail(fmt::format("{}: the key stands twice; expected it once", shown(Json(error.what()))));
  }
}

bool blank(const std::string& line) { return line.find_first_not_of(" \t\r") == std::string::npos; }

void append_number(std::string& out, double value) {
  if (value == 0 && std::signbit(value)) {
    out += "-0.0";  // "-0" would come back as the integer 0
    return;
  }
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

template <class Range>
void append_array(std::string& out, const Range& values) {
  char separator = '[';
  for (const double value : values) {
    out += separator;
    append_number(out, value);
    separator = ',';
  }
  out += ']';
}

std::array<double, 3> fractions(const std::array<std::uint8_t, 3>& codes) {
  return {codes[0] / 255.0, codes[1] / 255.0, codes[2] / 255.0};
}

bool gives_more(const Triangle& triangle) {
  return std::ranges::any_of(given_attributes, [&](const auto& given) { return given.is_given(triangle.v); });
}

bool is_formatted(const Texture& texture) { return texture.format != TexelFormat::rgba8888; }

// Lists of `length` integers each, or one list where length is 0.
Json lists_of(std::span<const std::int16_t> values, std::size_t length) {
  Json out = Json::array();
  for (std::size_t k = 0; k < values.size(); k += length == 0 ? 1 : length) {
    length == 0 ? out.push_back(values[k]) : out.push_back(lists_of(values.subspan(k, length), 0));
  }
  return out;
}

// The entry of the header for a texture: its name where it is an image.
Json texture_entry(const Texture& texture, const std::string& name) {
  if (!is_formatted(texture)) return name;
  Json out;
  if (is_procedural(texture.format)) {
    Json& values = out["procedural"];
    values["kind"] = std::string(to_string(texture.format));
    values["width"] = texture.width;
    values["height"] = texture.height;
    values["colors"] = lists_of(std::span(texture.table).first(8), 4);
    std::size_t at = 8;
    for (const ProceduralValue& value : procedural_values(texture.format)) {
      values[std::string(value.key)] = texture.table[at++];
    }
    return out;
  }
  out["raw"] = name;
  out["format"] = std::string(to_string(texture.format));
  out["width"] = texture.width;
  out["height"] = texture.height;
  const std::span table(texture.table);
  if (table.size() == palette_size) out["palette"] = lists_of(table, 4);
  if (table.size() == yiq_table_size) {
    out["yiq"]["y"] = lists_of(table.first(16), 0);
    out["yiq"]["i"] = lists_of(table.subspan(16, 12), 3);
    out["yiq"]["q"] = lists_of(table.subspan(28, 12), 3);
  }
  return out;
}

Json light_json(const Light& light) {
  Json out = {{light.is_point ? "position" : "direction", light.place},
              {"ambient", light.ambient},
              {"specular", light.specular},
              {"exponent", light.exponent}};
  if (light.lunar > 0) out["lunar"] = light.lunar;
  if (light.reach > 0) {
    out["reach"] = light.reach;
    out["offset"] = light.offset;
  }
  return out;
}

Json quadric_json(const Quadric& q) {
  Json out = {
      {"triangles", {q.first, q.first + q.count - 1}}, {"matrix", q.matrix}, {"within", {q.low, q.high}}};
  if (q.two_sided) out["two_sided"] = true;
  if (!q.clip) return out;
  Json& clip = out["clip"];
  clip = {{"axis", q.clip->axis}, {"from", q.clip->from}, {"to", q.clip->to}};
  if (q.clip->cap_from || q.clip->cap_to) clip["caps"] = {q.clip->cap_from, q.clip->cap_to};
  return out;
}

std::string header_text(const Scene& scene, std::span<const std::string> names) {
  const bool second = !scene.commands.empty() || scene.projector || scene.light || !scene.quadrics.empty() ||
                      std::ranges::any_of(scene.textures, is_formatted) ||
                      std::ranges::any_of(scene.triangles, gives_more) ||
                      std::ranges::any_of(scene.triangles, &Triangle::is_line);
  const int version = second ? 2 : 1;
  std::string out = fmt::format("{{\"bitspan\":{},\"width\":{},\"height\":{},\"s_min\":", version,
                                scene.width, scene.height);
  append_number(out, scene.s_min);
  out += ",\"s_max\":";
  append_number(out, scene.s_max);
  out += ",\"focal\":";
  append_number(out, scene.focal);
  out += ",\"color_max\":1,\"background\":";
  append_array(out, fractions(scene.background));
  if (scene.fog) {
    out += ",\"fog\":{\"color\":";
    append_array(out, fractions(scene.fog->color));
    out += ",\"distance\":";
    append_number(out, scene.fog->distance);
    out += '}';
  }
  if (scene.projector) {
    out += ",\"projector\":{\"s_min\":";
    append_number(out, scene.projector->s_min);
    out += ",\"s_max\":";
    append_number(out, scene.projector->s_max);
    out += '}';
  }
  if (scene.light) out += ",\"light\":" + light_json(*scene.light).dump();
  if (!scene.quadrics.empty()) {
    Json quadrics = Json::array();
    for (const Quadric& q : scene.quadrics) quadrics.push_back(quadric_json(q));
    out += ",\"quadrics\":" + quadrics.dump();
  }
  if (!names.empty()) {
    out += ",\"textures\":";
    Json entries = Json::array();
    for (std::size_t i = 0; i < names.size(); ++i) {
      entries.push_back(texture_entry(scene.textures[i], names[i]));
    }
    out += entries.dump();
  }
  out += '}';
  return out;
}

void append_triangle(std::string& out, const Triangle& triangle) {
  const std::span vertices = std::span(triangle.v).first(vertices_of(triangle));
  out += triangle.is_line ? "{\"l\":" : "{\"v\":";
  char separator = '[';
  for (const Vertex& v : vertices) {
    out += separator;
    append_array(out, std::array{v.x, v.y, v.s, v.u, v.v});
    separator = ',';
  }
  out += ']';
  const std::array<double, 4> white{1, 1, 1, 1};
  if (std::ranges::any_of(vertices, [&](const Vertex& v) { return v.c != white; })) {
    out += ",\"c\":";
    separator = '[';
    for (const Vertex& v : vertices) {
      out += separator;
      append_array(out, v.c);
      separator = ',';
    }
    out += ']';
  }
  for (const GivenAttribute& given : given_attributes) {
    if (!given.is_given(triangle.v)) continue;
    out += fmt::format(",\"{}\":", given.key);
    separator = '[';
    for (const Vertex& v : vertices) {
      out += separator;
      append_number(out, v.*given.member);
      separator = ',';
    }
    out += ']';
  }
  if (triangle.texture >= 0) out += fmt::format(",\"tex\":{}", triangle.texture);
  out += '}';
}

// Writes the lines through `sink(std::string_view)` in pieces of about 64 KiB.
template <class Sink>
class LineWriter {
 public:
  LineWriter(const Sink& sink, std::string_view header) : sink_(sink) { command(header); }
  void triangle(const Triangle& triangle) {
    append_triangle(piece_, triangle);
    piece_ += '\n';
    if (piece_.size() <= (std::size_t{1} << 16)) return;
    sink_(piece_);
    piece_.clear();
  }
  void command(std::string_view line) {
    piece_ += line;
    piece_ += '\n';
  }
  void end() { sink_(piece_); }

 private:
  const Sink& sink_;
  std::string piece_;
};

// All behind the header.
template <class Writer>
void write_stream(const Scene& scene, Writer writer) {
  auto command = scene.commands.begin();
  const auto write_commands = [&](std::size_t before) {
    for (; command != scene.commands.end() && command->before == before; ++command) {
      writer.command(command_text(*command));
    }
  };
  std::size_t index = 0;
  for (const Triangle& triangle : scene.triangles) {
    write_commands(index++);
    if (triangle.is_line) {
      std::string line;
      append_triangle(line, triangle);
      writer.command(line);
    } else {
      writer.triangle(triangle);
    }
  }
  write_commands(index);
  writer.end();
}

std::vector<std::string> texture_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Texture& texture : scene.textures) names.push_back(texture.name);
  return names;
}

}  // namespace

namespace {

Json line_of(const Resolve& /*resolve*/) { return {{"resolve", true}}; }

Json line_of(const Target& target) { return {{"target", target.k}}; }

Json line_of(const Copy& copy) {
  return {{"copy", {{"target", copy.target}, {"plane", to_string(copy.plane)}, {"texture", copy.texture}}}};
}

Json line_of(const ViewChange& change) {
  Json view = Json::object();
  if (change.width) view["width"] = *change.width;
  if (change.height) view["height"] = *change.height;
  if (change.s_min) view["s_min"] = *change.s_min;
  if (change.s_max) view["s_max"] = *change.s_max;
  if (change.focal) view["focal"] = *change.focal;
  if (change.background) view["background"] = fractions(*change.background);
  if (change.fog) {
    Json& fog = view["fog"];
    if (*change.fog)
      fog = {{"color", fractions((*change.fog)->color)}, {"distance", (*change.fog)->distance}};
  }
  if (change.projector) {
    Json& projector = view["projector"];
    if (*change.projector) {
      projector = {{"s_min", (*change.projector)->s_min}, {"s_max", (*change.projector)->s_max}};
    }
  }
  if (change.light) view["light"] = *change.light ? light_json(**change.light) : Json();
  return {{"view", view}};
}

Json line_of(const Clear& clear) {
  Json planes = Json::object();
  if (clear.color) planes["color"] = fractions(*clear.color);
  if (clear.alpha) planes["alpha"] = *clear.alpha;
  if (clear.depth) planes["depth"] = true;
  if (clear.stencil) planes["stencil"] = *clear.stencil;
  if (clear.masked) planes["masked"] = true;
  return {{"clear", planes}};
}

Json line_of(const StateChange& change) {
  Json line;
  Json& state = line["state"] = Json::object();
  for (const StateSetting& setting : change.settings) {
    const StateRegister& r = state_registers()[setting.index];
    Json& value = state[std::string(r.key)];
    if (r.is_truth) {
      value = setting.value != 0;
    } else if (r.names.empty()) {
      value = setting.value;
    } else {
      value = r.names[static_cast<std::size_t>(setting.value)];
    }
  }
  if (change.reset) line["reset"] = true;
  return line;
}

}  // namespace

std::string command_text(const DrawCommand& command) {
  return std::visit([](const auto& what) { return line_of(what).dump(); }, command.what);
}

DrawCommand parse_command(std::string_view json, const std::string& origin) {
  const Place place{origin, 1};
  const Json line = parse_line(std::string(json), place);
  if (!is_command(line))
    place.fail(shown(line) + " is no command; expected state, clear, target, view, copy or resolve");
  return read_command(line, 1, place);
}

struct TriReader::State {
  std::ifstream file;
  Place place, header;
  std::optional<LineReader> lines;    // of a text
  std::optional<TribReader> records;  // of a binary stream
  std::string line;
  QuickTriangles quick;
  TriangleLine quick_line;
  Scene scene;
  std::vector<HeaderTexture> textures;  // of the header
  int frame = 0;                        // that its dynamic textures show
  int color_max = 0;
  int version = 1;
  std::vector<DrawCommand> commands;  // read, not yet taken
  std::size_t triangles = 0;
  Views views;                             // of the targets
  DrawState draw_state = first_state({});  // as far as its legality does not depend on a configuration
  // Where the header has a shadow: the passes, and how many triangles and commands of them are given.
  std::optional<Scene> passes;
  std::size_t given = 0, given_commands = 0;

  bool read_quickly(Triangle& triangle) {
    if (!quick.read(line, version, quick_line)) return false;
    const auto& texture = quick_line.texture;
    if (texture && (*texture < 0 || *texture >= static_cast<std::int64_t>(textures.size()))) return false;
    triangle = finished(quick_line, views.now(), textures, frame, color_max, place);
    return true;
  }

  bool next_record(Triangle& triangle) {
    while (true) {
      const TribRecord record = records->next(quick_line, line);
      place.at = records->offset();
      if (record == TribRecord::end) return false;
      if (record == TribRecord::triangle) {
        if (version < 2 && gives_more(quick_line.triangle)) {
          place.fail(
              "bitspan: a triangle of version 1 gives only colours; expected a header {\"bitspan\": 2, ...}");
        }
        auto& texture = quick_line.texture;
        if (*texture == -1) texture.reset();
        if (texture && (*texture < 0 || *texture >= static_cast<std::int64_t>(textures.size()))) {
          texture_shown(Json(*texture), textures, frame, place);
        }
        triangle = finished(quick_line, views.now(), textures, frame, color_max, place);
        ++triangles;
        return true;
      }
      const Json json = parse_line(line, place);
      if (is_line(json)) {
        triangle = read_triangle(json, views.now(), textures, frame, color_max, version, place);
        ++triangles;
        return true;
      }
      if (!is_command(json)) {
        place.fail(shown(json) +
                   " is no command; expected state, clear, target, view, copy, resolve, frame or a line, l");
      }
      add_command(json);
    }
  }

  // The image with that number must be there in all dynamic textures.
  void show_frame(const Json& value) {
    int frames = texture_size_limit;
    bool dynamic = false;
    for (const HeaderTexture& texture : textures) {
      if (texture.frames == 0) continue;
      dynamic = true;
      frames = std::min(frames, texture.frames);
    }
    if (!dynamic) place.fail("frame: the header has no dynamic texture; expected one with \"frames\"");
    frame = integer(value, 0, frames - 1, place, "frame");
  }

  // The header's number of texture1 becomes the scene's: of a dynamic texture that of the image shown.
  void show_texture(StateSetting& setting) const {
    if (setting.index != *find_state_register("texture1") || setting.value < 0) return;
    if (setting.value >= static_cast<std::int64_t>(textures.size())) {
      place.fail(
          fmt::format("state.texture1: texture {} does not exist, the header has {}; expected -1 to {}",
                      setting.value, textures.size(), static_cast<int>(textures.size()) - 1));
    }
    setting.value = textures[static_cast<std::size_t>(setting.value)].shown(frame);
  }

  // The header's number of the texture becomes the scene's.
  void check_copied(Copy& copy) const {
    if (copy.texture >= static_cast<int>(textures.size())) {
      place.fail(
          fmt::format("copy.texture: texture {} does not exist, the header has {}; expected an index below",
                      copy.texture, textures.size()));
    }
    const HeaderTexture& texture = textures[static_cast<std::size_t>(copy.texture)];
    if (texture.frames != 0) {
      place.fail(
          fmt::format("copy.texture: texture {} is dynamic; expected one of a single image", copy.texture));
    }
    copy.texture = texture.first;
    try {
      check_copy(scene, views, copy);
    } catch (const InputError& error) {
      place.fail(error.what());
    }
  }

  void add_command(const Json& json) {
    if (version < 2) {
      place.fail("bitspan: a stream of version 1 has no commands; expected a header {\"bitspan\": 2, ...}");
    }
    if (json.contains("frame")) {
      check_keys(json, {"frame"}, place, "");
      show_frame(json["frame"]);
      return;
    }
    DrawCommand command = read_command(json, color_max, place);
    command.before = triangles;
    if (auto* change = std::get_if<StateChange>(&command.what)) {
      for (StateSetting& setting : change->settings) show_texture(setting);
      try {
        draw_state = changed_state(draw_state, *change, {}, scene.textures.size());
      } catch (const InputError& error) {
        place.fail(std::string("state.") + error.what());
      }
    }
    try {
      views.execute(command);
    } catch (const InputError& error) {
      place.fail(std::string("view.") + error.what());
    }
    if (auto* copy = std::get_if<Copy>(&command.what)) check_copied(*copy);
    commands.push_back(std::move(command));
  }

  bool next_given(Triangle& triangle) {
    if (given == passes->triangles.size()) return false;
    triangle = passes->triangles[given++];
    return true;
  }

  bool next_line(Triangle& triangle) {
    while (lines->next(line, place)) {
      if (blank(line)) continue;
      if (read_quickly(triangle)) {
        ++triangles;
        return true;
      }
      const Json json = parse_line(line, place);
      if (is_command(json)) {
        add_command(json);
        continue;
      }
      triangle = read_triangle(json, views.now(), textures, frame, color_max, version, place);
      ++triangles;
      return true;
    }
    return false;
  }
  bool next(Triangle& triangle) {
    if (passes) return next_given(triangle);
    if (records ? next_record(triangle) : next_line(triangle)) return true;
    if (const std::string fault = ranges_fault(scene.quadrics, triangles); !fault.empty()) {
      header.fail("quadrics" + fault);
    }
    return false;
  }

  // The whole stream, drawn in that light.
  void light(const ShadowOptions& shadow) {
    Scene all = scene;
    Triangle triangle;
    while (next(triangle)) all.triangles.push_back(triangle);
    all.commands = std::exchange(commands, {});
    const std::vector<Face> casters = faces_of(all);
    try {
      passes = shadowed(std::move(all), casters, shadow);
    } catch (const InputError& error) {
      const std::string what = error.what();
      header.fail(what.starts_with("shadow") ? what : "shadow: " + what);
    }
    scene = *passes;
    scene.triangles.clear();
    scene.commands.clear();
  }

  void open(std::istream& in, const std::string& origin, std::optional<int> first_frame,
            const ShadowOptions* codes) {
    namespace fs = std::filesystem;
    place.file = origin;
    if (is_binary_stream(in, origin)) {
      records.emplace(in, origin);
      place.at = records->offset();
      place.is_byte = true;
      line = records->header();
    } else {
      lines.emplace(in);
      bool found = false;
      while (!found && lines->next(line, place)) found = !blank(line);
      if (!found) {
        place.at = 1;
        place.fail("the file is empty; expected a header {\"bitspan\": 1, ...}");
      }
    }
    std::optional<ShadowOptions> shadow;
    header = place;
    scene = read_header(parse_line(line, place), place, fs::path(origin).parent_path(), color_max, version,
                        textures, codes == nullptr ? ShadowOptions{} : *codes, shadow);
    views = Views(scene);
    if (first_frame) show_frame(*first_frame);
    scene.name = fs::path(origin).stem().string();
    if (shadow) light(*shadow);
  }
};

bool is_stream(const std::string& name) {
  return name == "-" || name.ends_with(".tri") || name.ends_with(".trib") || is_binary_stream_file(name);
}

TriReader::TriReader(const std::string& path, std::optional<int> frame, const ShadowOptions* codes)
    : state_(std::make_unique<State>()) {
  if (path == "-") {
    state_->open(std::cin, "stdin", frame, codes);
    return;
  }
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    throw InputError(path + ": cannot read: is a folder; expected a triangle stream (.tri, .trib)");
  }
  state_->file.open(path, std::ios::binary);
  if (!state_->file) {
    throw InputError(path + ": cannot read: " + std::strerror(errno) +
                     "; expected a triangle stream (.tri, .trib)");
  }
  state_->open(state_->file, path, frame, codes);
}

TriReader::TriReader(std::istream& in, const std::string& origin, std::optional<int> frame,
                     const ShadowOptions* codes)
    : state_(std::make_unique<State>()) {
  state_->open(in, origin, frame, codes);
}

TriReader::~TriReader() = default;

const Scene& TriReader::scene() const { return state_->scene; }

bool TriReader::next(Triangle& triangle) { return state_->next(triangle); }

std::vector<DrawCommand> TriReader::take_commands() {
  State& s = *state_;
  if (!s.passes) return std::exchange(s.commands, {});
  // Those in front of what is given; at the end the others, too.
  std::vector<DrawCommand> out;
  const std::vector<DrawCommand>& all = s.passes->commands;
  const bool is_end = s.given == s.passes->triangles.size();
  while (s.given_commands < all.size() && (is_end || all[s.given_commands].before < s.given)) {
    out.push_back(all[s.given_commands++]);
  }
  return out;
}

namespace {

Scene read_all(TriReader& reader) {
  Scene scene = reader.scene();
  Triangle triangle;
  while (reader.next(triangle)) scene.triangles.push_back(triangle);
  scene.commands = reader.take_commands();
  return scene;
}

}  // namespace

Scene read_tri(const std::string& path, std::optional<int> frame) {
  TriReader reader(path, frame);
  return read_all(reader);
}

Scene parse_tri(std::string_view text, const std::string& origin, std::optional<int> frame) {
  std::istringstream in{std::string(text)};
  TriReader reader(in, origin, frame);
  return read_all(reader);
}

void check_scene(const Scene& scene, const std::string& origin) {
  Place place{origin, 1};
  Views views(scene);
  if (scene.width < 1 || scene.width > picture_size_limit || scene.height < 1 ||
      scene.height > picture_size_limit) {
    place.fail(fmt::format("width: {} x {} is not legal; expected 1..{} pixels", scene.width, scene.height,
                           picture_size_limit));
  }
  check_area(scene.width, scene.height, place);
  const auto positive_finite = [](double x) { return std::isfinite(x) && x > 0; };
  if (!positive_finite(scene.s_min) || !positive_finite(scene.s_max) || scene.s_min >= scene.s_max) {
    place.fail(fmt::format("s_min: {} to s_max = {} is not legal; expected 0 < s_min < s_max",
                           shortest(scene.s_min), shortest(scene.s_max)));
  }
  if (!positive_finite(scene.focal)) place.fail("focal: is not legal; expected a number above 0");
  if (scene.fog && !positive_finite(scene.fog->distance)) {
    place.fail("fog.distance: is not legal; expected a number above 0");
  }
  if (scene.projector &&
      !(positive_finite(scene.projector->s_min) && positive_finite(scene.projector->s_max) &&
        scene.projector->s_min < scene.projector->s_max)) {
    place.fail("projector.s_min: is not legal; expected 0 < s_min < s_max");
  }
  if (scene.light) {
    if (const std::string fault = light_fault(*scene.light, scene.s_max); !fault.empty())
      place.fail("light" + fault);
  }
  for (std::size_t i = 0; i < scene.quadrics.size(); ++i) {
    if (const std::string fault = quadric_fault(scene.quadrics[i]); !fault.empty())
      place.fail(fmt::format("quadrics[{}]{}", i, fault));
  }
  if (const std::string fault = ranges_fault(scene.quadrics, scene.triangles.size()); !fault.empty()) {
    place.fail("quadrics" + fault);
  }
  std::size_t least = 0;
  for (const DrawCommand& command : scene.commands) {
    if (command.before < least || command.before > scene.triangles.size()) {
      place.fail(fmt::format("command before triangle {}: out of order; expected {}..{}", command.before,
                             least, scene.triangles.size()));
    }
    least = command.before;
    parse_command(command_text(command), origin);  // refuses what a stream cannot hold
  }
  auto command = scene.commands.begin();
  for (const Triangle& triangle : scene.triangles) {
    const auto index = static_cast<std::size_t>(place.at++ - 1);
    for (; command != scene.commands.end() && command->before <= index; ++command) views.execute(*command);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& v = triangle.v[i];
      check_vertex(triangle, i, views.now(), place);
      for (const double c : v.c) {
        if (!(c >= 0 && c <= 1))
          place.fail(fmt::format("c[{}]: component {} is out of range; expected 0..1", i, shortest(c)));
      }
    }
    check_given(triangle, place);
    check_shape(triangle, place);
    if (triangle.texture < -1 || triangle.texture >= static_cast<int>(scene.textures.size())) {
      place.fail(fmt::format("tex: {} is out of range; expected an index below {}", triangle.texture,
                             scene.textures.size()));
    }
  }
}

void write_tri(std::ostream& out, const Scene& scene) {
  const auto sink = [&](std::string_view piece) {
    out.write(piece.data(), static_cast<std::streamsize>(piece.size()));
  };
  write_stream(scene, LineWriter(sink, header_text(scene, texture_names(scene))));
}

void write_trib(std::ostream& out, const Scene& scene) {
  const auto sink = [&](std::string_view piece) {
    out.write(piece.data(), static_cast<std::streamsize>(piece.size()));
  };
  write_stream(scene, TribWriter(sink, header_text(scene, texture_names(scene)), scene.triangles));
}

namespace {

// The pictures of a stream have names longer than its own. Where a file system would not take them, a hash
// stands for the stem's end.
std::string picture_stem(std::string stem) {
  constexpr std::size_t name_limit = 255, suffix_bytes = 16;  // ".12345.png" and some
  if (stem.size() + suffix_bytes <= name_limit) return stem;
  Fnv128 hash;
  hash.text(stem);
  const std::string end = "-" + hash.hex();
  std::size_t size = name_limit - suffix_bytes - end.size();
  const auto is_inside = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  while (size > 0 && is_inside(stem[size])) --size;  // of a character in UTF-8
  stem.resize(size);
  return stem + end;
}

}  // namespace

void write_tri_file(const std::string& path, const Scene& scene) {
  check_scene(scene, scene.name);
  namespace fs = std::filesystem;
  const fs::path target(path);
  const std::string stem = picture_stem(target.stem().string());
  AtomicFile stream(path);
  std::vector<std::string> names;
  std::vector<std::unique_ptr<AtomicFile>> pictures;
  for (const Texture& texture : scene.textures) {
    const bool formatted = is_formatted(texture);
    if (is_procedural(texture.format)) {
      names.emplace_back();  // of no file
      continue;
    }
    names.push_back(fmt::format("{}.{}.{}", stem, names.size(), formatted ? "bin" : "png"));
    pictures.push_back(std::make_unique<AtomicFile>((target.parent_path() / names.back()).string()));
    pictures.back()->write(formatted ? texture.raw
                                     : encode_png(texture.width, texture.height, 4, texture.rgba));
  }
  const auto sink = [&](std::string_view piece) { stream.write(piece); };
  if (path.ends_with(".trib")) {
    write_stream(scene, TribWriter(sink, header_text(scene, names), scene.triangles));
  } else {
    write_stream(scene, LineWriter(sink, header_text(scene, names)));
  }
  for (const auto& picture : pictures) picture->commit();
  stream.commit();
}

}  // namespace bitspan
