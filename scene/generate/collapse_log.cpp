// SPDX-License-Identifier: Apache-2.0
// The log of simplify as a file.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "config/config.hpp"
#include "io/atomic_file.hpp"
#include "io/json_depth.hpp"
#include "scene/generate/simplify.hpp"
#include "scene/mesh_text.hpp"

namespace bitspan {
namespace {

using Json = nlohmann::json;

std::string text_of(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }
std::string text_of(const MeshFace& f) { return fmt::format("[{}, {}, {}]", f[0], f[1], f[2]); }

// One line of the file, and how it is refused.
class LogLine {
 public:
  LogLine(std::string_view text, const std::string& path, std::size_t number) : path_(path), number_(number) {
    check_json_depth(text);
    json_ = Json::parse(text, nullptr, false);
    if (!json_.is_object()) refuse("is no JSON object");
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}; expected a log of bitspan make simplify", path_, number_, what));
  }
  bool has(const char* key) const { return json_.contains(key); }
  std::uint32_t number(const char* key, std::size_t limit) const { return whole(value(key), key, limit); }
  double real(const char* key) const {
    if (!value(key).is_number()) refuse(fmt::format("{} is no number", key));
    return value(key).get<double>();
  }
  Vec3 place(const char* key) const {
    const Json& v = list(value(key), key, 3);
    if (!std::ranges::all_of(v, [](const Json& x) { return x.is_number(); }))
      refuse(fmt::format("{} is no place", key));
    return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
  }
  std::vector<std::uint32_t> numbers(const char* key, std::size_t limit) const {
    if (!value(key).is_array()) refuse(fmt::format("{} is no list", key));
    std::vector<std::uint32_t> out;
    for (const Json& x : value(key)) out.push_back(whole(x, key, limit));
    return out;
  }
  MeshFace corners(const Json& from, const char* key, std::size_t first, std::size_t limit) const {
    MeshFace out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = whole(from[first + k], key, limit);
    if (out[0] == out[1] || out[1] == out[2] || out[2] == out[0])
      refuse(fmt::format("{} has two equal corners", key));
    return out;
  }
  const Json& list(const Json& from, const char* key, std::size_t size) const {
    if (!from.is_array() || from.size() != size) refuse(fmt::format("{} is no list of {}", key, size));
    return from;
  }
  const Json& value(const char* key) const {
    if (!json_.contains(key)) refuse(fmt::format("has no {}", key));
    return json_[key];
  }
  std::uint32_t whole(const Json& x, const char* key, std::size_t limit) const {
    if (!x.is_number_unsigned() || x.get<std::uint64_t>() >= limit) {
      refuse(fmt::format("{} is no whole number below {}", key, limit));
    }
    return x.get<std::uint32_t>();
  }

 private:
  const std::string& path_;
  std::size_t number_;
  Json json_;
};

// Sets the bit, which must not be set.
void set_once(std::vector<bool>& bits, std::uint32_t at, const LogLine& line, std::string_view what) {
  if (bits[at]) line.refuse(fmt::format("{} {} stands twice", what, at));
  bits[at] = true;
}

}  // namespace

void write_collapse_log(const SimplifiedMesh& mesh, const std::string& path) {
  AtomicFile file(path);
  file.write(fmt::format("{{\"simplify\": 1, \"vertices\": {}, \"faces\": {}}}\n", mesh.mesh.vertices.size(),
                         mesh.mesh.faces.size()));
  for (std::size_t v = 0; v < mesh.mesh.vertices.size(); ++v) {
    if (!mesh.has_vertex[v]) continue;
    file.write(fmt::format("{{\"vertex\": {}, \"at\": {}}}\n", v, text_of(mesh.mesh.vertices[v])));
  }
  for (std::size_t f = 0; f < mesh.mesh.faces.size(); ++f) {
    if (!mesh.has_face[f]) continue;
    file.write(fmt::format("{{\"face\": {}, \"corners\": {}}}\n", f, text_of(mesh.mesh.faces[f])));
  }
  for (const Collapse& c : mesh.log) {
    std::string gone;
    for (const Collapse::GoneFace& g : c.gone_faces) {
      gone += fmt::format("{}[{}, {}, {}, {}]", gone.empty() ? "" : ", ", g.face, g.corners[0], g.corners[1],
                          g.corners[2]);
    }
    file.write(fmt::format(
        "{{\"kept\": {}, \"gone\": {}, \"cost\": {}, \"kept_before\": {}, \"gone_before\": {}, \"to\": {}, "
        "\"gone_faces\": [{}], \"moved_faces\": [{}]}}\n",
        c.kept, c.gone, c.cost, text_of(c.kept_before), text_of(c.gone_before), text_of(c.to), gone,
        fmt::join(c.moved_faces, ", ")));
  }
  file.commit();
}

SimplifiedMesh read_collapse_log(const std::string& path) {
  const std::string text = read_whole(path, "a log of bitspan make simplify");
  SimplifiedMesh out;
  std::vector<bool> is_gone_vertex, is_gone_face;
  std::size_t vertices = 0, faces = 0, number = 0;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const LogLine line(rest.substr(0, end), path, ++number);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (number == 1) {
      if (!line.has("simplify") || line.number("simplify", 2) != 1) line.refuse("is no log of version 1");
      // Each vertex and each face has at least a byte of the file, so that no count is believed without it.
      vertices = line.number("vertices", text.size());
      faces = line.number("faces", text.size());
      out.mesh.vertices.resize(vertices);
      out.mesh.faces.resize(faces);
      out.has_vertex.assign(vertices, false);
      out.has_face.assign(faces, false);
      is_gone_vertex.assign(vertices, false);
      is_gone_face.assign(faces, false);
    } else if (line.has("vertex")) {
      const std::uint32_t v = line.number("vertex", vertices);
      set_once(out.has_vertex, v, line, "vertex");
      out.mesh.vertices[v] = line.place("at");
    } else if (line.has("face")) {
      const std::uint32_t f = line.number("face", faces);
      set_once(out.has_face, f, line, "face");
      out.mesh.faces[f] =
          line.corners(line.list(line.value("corners"), "corners", 3), "corners", 0, vertices);
      ++out.face_count;
    } else {
      Collapse c;
      c.kept = line.number("kept", vertices);
      c.gone = line.number("gone", vertices);
      c.cost = line.real("cost");
      c.kept_before = line.place("kept_before");
      c.gone_before = line.place("gone_before");
      c.to = line.place("to");
      set_once(is_gone_vertex, c.gone, line, "gone vertex");
      // Those that undo brings back.
      out.mesh.vertices[c.gone] = c.gone_before;
      if (!line.value("gone_faces").is_array()) line.refuse("gone_faces is no list");
      for (const Json& g : line.value("gone_faces")) {
        line.list(g, "gone_faces", 4);
        const std::uint32_t f = line.whole(g[0], "gone_faces", faces);
        set_once(is_gone_face, f, line, "gone face");
        c.gone_faces.push_back({f, line.corners(g, "gone_faces", 1, vertices)});
        out.mesh.faces[f] = c.gone_faces.back().corners;
      }
      c.moved_faces = line.numbers("moved_faces", faces);
      out.log.push_back(std::move(c));
    }
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (out.has_vertex[v] == is_gone_vertex[v]) {
      throw InputError(fmt::format("{}: vertex {} is {}; expected one or the other", path, v,
                                   out.has_vertex[v] ? "there and gone" : "neither there nor gone"));
    }
  }
  for (std::size_t f = 0; f < faces; ++f) {
    if (out.has_face[f] == is_gone_face[f]) {
      throw InputError(fmt::format("{}: face {} is {}; expected one or the other", path, f,
                                   out.has_face[f] ? "there and gone" : "neither there nor gone"));
    }
  }
  if (number == 0) throw InputError(path + ": is empty; expected a log of bitspan make simplify");
  return out;
}

}  // namespace bitspan
