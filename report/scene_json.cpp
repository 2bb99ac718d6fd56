// SPDX-License-Identifier: Apache-2.0
#include "report/scene_json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "scene/texels.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

using Json = nlohmann::ordered_json;

std::string to_hex(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  out.reserve(bytes.size() * 2);
  for (const std::uint8_t byte : bytes) {
    out += digits[byte >> 4];
    out += digits[byte & 15];
  }
  return out;
}

std::vector<std::uint8_t> from_hex(const std::string& text, const char* what) {
  std::vector<std::uint8_t> out(text.size() / 2);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const char* at = text.data() + 2 * i;
    if (std::from_chars(at, at + 2, out[i], 16).ptr != at + 2) {
      throw InputError(std::string("texture: ") + what + " is not hexadecimal");
    }
  }
  return out;
}

Texture texture_of(const Json& json) {
  Texture texture;
  json.at("name").get_to(texture.name);
  json.at("width").get_to(texture.width);
  json.at("height").get_to(texture.height);
  if (json.contains("format")) {
    const auto name = json.at("format").get<std::string>();
    const auto found = std::ranges::find(enum_names<TexelFormat>, name);
    if (found == enum_names<TexelFormat>.end()) throw InputError("texture: unknown format " + name);
    texture.format = static_cast<TexelFormat>(found - enum_names<TexelFormat>.begin());
    texture.raw = from_hex(json.at("raw").get<std::string>(), "raw");
    json.at("table").get_to(texture.table);
  } else {
    texture.rgba = from_hex(json.at("rgba").get<std::string>(), "rgba");
  }
  if (!is_whole(texture)) {
    throw InputError("texture: width, height and " + std::string(json.contains("format") ? "raw" : "rgba") +
                     " do not agree");
  }
  return texture;
}

Json triangle_json(const Triangle& triangle) {
  Json v = Json::array();
  Json c = Json::array();
  for (const Vertex& vertex : triangle.v) {
    v.push_back({vertex.x, vertex.y, vertex.s, vertex.u, vertex.v});
    c.push_back(vertex.c);
  }
  Json out;
  out["v"] = std::move(v);
  out["c"] = std::move(c);
  for (const GivenAttribute& given : given_attributes) {
    if (!given.is_given(triangle.v)) continue;
    for (const Vertex& vertex : triangle.v) out["given"][given.key].push_back(vertex.*given.member);
  }
  if (triangle.texture >= 0) {
    out["tex"] = triangle.texture;
  }
  if (triangle.is_line) out["line"] = true;
  return out;
}

Triangle triangle_of(const Json& json) {
  Triangle triangle;
  const auto v = json.at("v").get<std::array<std::array<double, 5>, 3>>();
  const auto c = json.at("c").get<std::array<std::array<double, 4>, 3>>();
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.v[i] = {{v[i][0], v[i][1], v[i][2]}, {v[i][3], v[i][4], c[i]}};
  }
  for (const GivenAttribute& given : given_attributes) {
    if (!json.contains("given") || !json["given"].contains(given.key)) continue;
    const auto values = json["given"][given.key].get<std::array<double, 3>>();
    for (std::size_t i = 0; i < 3; ++i) triangle.v[i].*given.member = values[i];
  }
  triangle.texture = json.value("tex", -1);
  triangle.is_line = json.value("line", false);
  return triangle;
}

}  // namespace

Json scene_json(const Scene& s) {
  Json scene{{"width", s.width}, {"height", s.height}, {"s_min", s.s_min},
             {"s_max", s.s_max}, {"focal", s.focal},   {"background", s.background}};
  if (s.fog) {
    scene["fog"] = {{"color", s.fog->color}, {"distance", s.fog->distance}};
  }
  if (s.projector) scene["projector"] = {{"s_min", s.projector->s_min}, {"s_max", s.projector->s_max}};
  if (s.light) {
    scene["light"] = {{"is_point", s.light->is_point},
                      {"place", s.light->place},
                      {"ambient", s.light->ambient},
                      {"specular", s.light->specular},
                      {"exponent", s.light->exponent}};
    if (s.light->lunar > 0) scene["light"]["lunar"] = s.light->lunar;
    if (s.light->reach > 0) {
      scene["light"]["reach"] = s.light->reach;
      scene["light"]["offset"] = s.light->offset;
    }
  }
  scene["textures"] = Json::array();
  for (const Texture& t : s.textures) {
    Json texture{{"name", t.name}, {"width", t.width}, {"height", t.height}};
    if (t.format == TexelFormat::rgba8888) {
      texture["rgba"] = to_hex(t.rgba);
    } else {
      texture["format"] = to_string(t.format);
      texture["raw"] = to_hex(t.raw);
      texture["table"] = t.table;
    }
    scene["textures"].push_back(std::move(texture));
  }
  scene["triangles"] = Json::array();
  for (const Triangle& triangle : s.triangles) {
    scene["triangles"].push_back(triangle_json(triangle));
  }
  for (const DrawCommand& command : s.commands) {
    Json line = Json::parse(command_text(command));
    line["before"] = command.before;
    scene["commands"].push_back(std::move(line));
  }
  return scene;
}

Scene scene_of(const Json& json) {
  Scene scene;
  json.at("width").get_to(scene.width);
  json.at("height").get_to(scene.height);
  json.at("s_min").get_to(scene.s_min);
  json.at("s_max").get_to(scene.s_max);
  json.at("focal").get_to(scene.focal);
  json.at("background").get_to(scene.background);
  if (json.contains("fog")) {
    Fog fog;
    json.at("fog").at("color").get_to(fog.color);
    json.at("fog").at("distance").get_to(fog.distance);
    scene.fog = fog;
  }
  if (json.contains("projector")) {
    Projector& projector = scene.projector.emplace();
    json.at("projector").at("s_min").get_to(projector.s_min);
    json.at("projector").at("s_max").get_to(projector.s_max);
  }
  if (json.contains("light")) {
    Light& light = scene.light.emplace();
    json.at("light").at("is_point").get_to(light.is_point);
    json.at("light").at("place").get_to(light.place);
    json.at("light").at("ambient").get_to(light.ambient);
    json.at("light").at("specular").get_to(light.specular);
    json.at("light").at("exponent").get_to(light.exponent);
    light.lunar = json.at("light").value("lunar", 0.0);
    light.reach = json.at("light").value("reach", 0.0);
    light.offset = json.at("light").value("offset", 0.0);
  }
  for (const Json& texture : json.at("textures")) {
    scene.textures.push_back(texture_of(texture));
  }
  for (const Json& triangle : json.at("triangles")) {
    scene.triangles.push_back(triangle_of(triangle));
  }
  for (Json line : json.value("commands", Json::array())) {
    const auto before = line.at("before").get<std::size_t>();
    line.erase("before");
    scene.commands.push_back(parse_command(line.dump(), "commands"));
    scene.commands.back().before = before;
  }
  return scene;
}

std::string fault_of(const nlohmann::json::exception& error) {
  const std::string_view what = error.what();
  return std::string(what.substr(0, what.find("; last read:")));
}

}  // namespace bitspan
