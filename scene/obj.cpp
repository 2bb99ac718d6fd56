// SPDX-License-Identifier: Apache-2.0
#include "scene/obj.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <unordered_map>

#include "config/byte_order_mark.hpp"
#include "config/config.hpp"
#include "scene/lines.hpp"
#include "scene/mesh_text.hpp"
#include "scene/mtl.hpp"
#include "scene/triangulate.hpp"

namespace bitspan {
namespace {

constexpr std::uint32_t no_index = 0xFFFFFFFF;

struct CornerIndex {
  std::uint32_t position = 0, texture = no_index, normal = no_index;
};

// A face before the whole file is known: it may name vertices that come later.
struct ObjFace {
  std::size_t line = 0;
  std::size_t first = 0;  // corner
  std::uint32_t corners = 0;
  int use = -1;              // of the names of usemtl
  std::uint32_t normal = 0;  // the largest index of a normal, from 1
};

// Statements of one kind that are left out.
struct LeftOut {
  std::uint64_t count = 0;
  std::size_t first = 0;  // line

  void add(std::size_t line) {
    if (count++ == 0) first = line;
  }
  void note(const std::string& what, std::vector<std::string>& notes) const {
    if (count == 0) return;
    notes.push_back(std::to_string(count) + " " + what + " (first: line " + std::to_string(first) + ")");
  }
};

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

class ObjReader {
 public:
  explicit ObjReader(const std::string& path)
      : path_(path), folder_(std::filesystem::path(path).parent_path().string()) {}

  MeshFile read(std::string_view text) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
      throw InputError(path_ + ": is UTF-16; expected ASCII or UTF-8");
    }
    StatementLines lines(without_mark(text));
    std::string_view statement;
    while (lines.next(statement)) {
      line_ = lines.number();
      const std::string_view keyword = take_word(statement);
      read_statement(keyword, statement);
    }
    note_left_out();
    resolve_materials();
    make_triangles();
    file_.images = std::move(library_.images);
    file_.materials = std::move(library_.materials);
    return std::move(file_);
  }

 private:
  InputError error(const std::string& what) const { return error_at(line_, what); }
  InputError error_at(std::size_t line, const std::string& what) const {
    return InputError(path_ + ":" + std::to_string(line) + ": " + what);
  }

  void read_statement(std::string_view keyword, std::string_view rest) {
    if (keyword == "v") return read_position(rest);
    if (keyword == "vt") return read_texture(rest);
    if (keyword == "vn") return read_normal(rest);
    if (keyword == "f" || keyword == "fo") return read_face(rest);
    if (keyword == "usemtl") return use_material(std::string(trimmed(rest)));
    if (keyword == "mtllib") return read_libraries(rest);
    if (keyword == "p") return points_.add(line_);
    if (keyword == "l") return lines_.add(line_);
    if (is_one_of(keyword, {"curv", "curv2", "surf"})) return surfaces_.add(line_);
    // What belongs to curves and surfaces, names and groups, and what only another renderer does.
    if (is_one_of(keyword,
                  {"o",     "g",        "s",        "mg",   "vp",         "cstype",    "deg",   "bmat",
                   "step",  "parm",     "trim",     "hole", "scrv",       "sp",        "end",   "con",
                   "bevel", "c_interp", "d_interp", "lod",  "shadow_obj", "trace_obj", "ctech", "stech"})) {
      return;
    }
    // usemap, maplib, call and csh among them.
    auto [entry, is_new] = unknown_.try_emplace(std::string(keyword.substr(0, 80)), LeftOut{});
    if (is_new) unknown_order_.push_back(entry->first);
    entry->second.add(line_);
  }

  // Reads up to 7 numbers; returns how many there are.
  std::size_t read_numbers(std::string_view rest, std::array<double, 7>& out) const {
    std::size_t count = 0;
    while (true) {
      const std::string_view word = take_word(rest);
      if (word.empty() || word.starts_with('#')) return count;
      if (count == out.size()) throw error("more than 7 numbers; expected 3, 4 or 6");
      const std::optional<double> value = to_number(word);
      if (!value) throw error(in_quotes(word) + " is no number that a double holds; expected one");
      out[count++] = *value;
    }
  }

  void read_position(std::string_view rest) {
    std::array<double, 7> n{};
    const std::size_t count = read_numbers(rest, n);
    if (count != 3 && count != 4 && count != 6) {
      throw error("a vertex of " + std::to_string(count) +
                  " numbers; expected x y z, x y z w, or x y z and red green blue");
    }
    if (positions_.size() == no_index) throw error("more vertices than 2^32 - 1; expected fewer");
    positions_.push_back({n[0], n[1], n[2]});
    if (count == 4 && n[3] != 1) weights_.add(line_);
    if (count != 6) {
      if (!colors_.empty()) colors_.push_back({1, 1, 1});
      return;
    }
    if (colors_.empty()) colors_.resize(positions_.size() - 1, {1, 1, 1});
    colors_.push_back({n[3], n[4], n[5]});
    if (std::any_of(n.begin() + 3, n.begin() + 6, [](double c) { return c < 0 || c > 1; })) {
      bright_.add(line_);
    }
  }

  // A file stays readable whose normals are not: they are of length 0 then.
  void read_normal(std::string_view rest) {
    const auto next = [&rest] { return to_number(take_word(rest)); };
    const std::optional<double> x = next(), y = next(), z = next();
    normals_.push_back(x && y && z ? Vec3{*x, *y, *z} : Vec3{});
  }

  void read_texture(std::string_view rest) {
    std::array<double, 7> n{};
    const std::size_t count = read_numbers(rest, n);
    if (count < 1 || count > 3) {
      throw error("texture coordinates of " + std::to_string(count) + " numbers; expected u, u v or u v w");
    }
    if (textures_.size() == no_index) throw error("more texture coordinates than 2^32 - 1; expected fewer");
    textures_.push_back({n[0], n[1]});
  }

  // Returns the index from 0. That the file has it is known at the end only.
  std::uint32_t index(std::string_view kind, std::string_view number, std::size_t size) const {
    std::int64_t value = 0;
    const char* const end = number.data() + number.size();
    const char* const begin = number.data() + (number.starts_with('+') ? 1 : 0);
    const auto [stop, code] = std::from_chars(begin, end, value);
    if (stop != end || (code != std::errc() && code != std::errc::result_out_of_range) || begin == end) {
      throw error(in_quotes(number) + " is no index; expected v, v/vt, v//vn or v/vt/vn");
    }
    const auto known = static_cast<std::int64_t>(size);
    if (code != std::errc() || value == 0 || value < -known || value >= no_index) {
      throw error(std::string(kind) + " " + std::string(number) + " is not there; expected 1.. or -" +
                  std::to_string(known) + "..-1");
    }
    return static_cast<std::uint32_t>(value > 0 ? value - 1 : known + value);
  }

  void read_face(std::string_view rest) {
    ObjFace face{line_, corners_.size(), 0, use_, 0};
    while (true) {
      const std::string_view word = take_word(rest);
      if (word.empty() || word.starts_with('#')) break;
      const std::size_t slash = std::min(word.find('/'), word.size());
      CornerIndex corner;
      corner.position = index("v", word.substr(0, slash), positions_.size());
      if (slash != word.size()) {
        const std::string_view behind = word.substr(slash + 1);
        const std::size_t second = std::min(behind.find('/'), behind.size());
        if (second != 0) corner.texture = index("vt", behind.substr(0, second), textures_.size());
        if (second + 1 < behind.size()) {
          corner.normal = index("vn", behind.substr(second + 1), normals_.size());
          face.normal = std::max(face.normal, corner.normal + 1);
        }
      }
      if (face.corners > 0 && (corner.texture == no_index) != (corners_.back().texture == no_index)) {
        throw error("some corners have texture coordinates; expected them at all corners, or at none");
      }
      corners_.push_back(corner);
      ++face.corners;
    }
    if (face.corners < 3) {
      throw error("a face of " + std::to_string(face.corners) + " corners; expected at least 3");
    }
    if (face.corners > polygon_corners_max) {
      throw error("a face of " + std::to_string(face.corners) + " corners; expected at most " +
                  std::to_string(polygon_corners_max));
    }
    faces_.push_back(face);
  }

  void use_material(const std::string& name) {
    const auto [entry, is_new] = uses_.try_emplace(name, static_cast<int>(use_names_.size()));
    if (is_new) use_names_.push_back(name);
    use_ = entry->second;
  }

  // Names are divided by blanks, and may have blanks.
  void read_libraries(std::string_view rest) {
    constexpr std::size_t words_max = 64;
    std::vector<std::string_view> words;
    for (std::string_view left = rest; words.size() < words_max;) {
      const std::string_view word = take_word(left);
      if (word.empty()) break;
      words.push_back(word);
    }
    for (std::size_t first = 0; first < words.size();) {
      std::size_t last = words.size();  // behind the name
      while (last > first + 1 && !is_file(name_of(words, first, last))) --last;
      read_library(name_of(words, first, last));
      first = last;
    }
  }
  // With the blanks between as they are.
  static std::string name_of(const std::vector<std::string_view>& words, std::size_t first,
                             std::size_t last) {
    const char* const end = words[last - 1].data() + words[last - 1].size();
    std::string name(words[first].data(), end);
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
  }
  std::string beside(const std::string& name) const {
    return (std::filesystem::path(folder_) / name).string();
  }
  bool is_file(const std::string& name) const {
    std::error_code code;
    return std::filesystem::is_regular_file(beside(name), code);
  }

  void read_library(const std::string& name) {
    if (std::ranges::find(libraries_, name) != libraries_.end()) return;
    libraries_.push_back(name);
    if (!is_file(name)) {
      file_.notes.push_back("the material library " + in_quotes(name) + " is no file that can be read");
      return;
    }
    const std::string path = beside(name);
    parse_mtl(read_whole(path, "a material library"), path, folder_, library_, file_.notes);
  }

  void note_left_out() {
    std::vector<std::string>& notes = file_.notes;
    points_.note("statements of points (p) are left out", notes);
    lines_.note("lines (l) are left out", notes);
    surfaces_.note("curves and surfaces are left out", notes);
    weights_.note("vertices have a weight w that is not 1; it is left out", notes);
    bright_.note("vertices have colours beyond 0..1; they are clamped", notes);
    for (const std::string& keyword : unknown_order_) {
      unknown_.at(keyword).note("statements " + in_quotes(keyword) + " are left out", notes);
    }
  }

  // A material that is not defined is white, as are faces in front of the first usemtl.
  void resolve_materials() {
    for (const std::string& name : use_names_) {
      const auto known = library_.by_name.find(name);
      const bool is_known = known != library_.by_name.end();
      use_materials_.push_back(is_known ? known->second : -1);
      if (!is_known) {
        file_.notes.push_back("the material " + in_quotes(name) + " is not defined; its faces are white");
      }
    }
  }

  void check(const ObjFace& face) const {
    const auto refuse = [&](const char* kind, std::uint64_t index, std::size_t size) {
      if (index >= size) {
        throw error_at(face.line, std::string(kind) + " " + std::to_string(index + 1) +
                                      " is not there; expected at most " + std::to_string(size));
      }
    };
    for (std::uint32_t i = 0; i < face.corners; ++i) {
      const CornerIndex& corner = corners_[face.first + i];
      refuse("v", corner.position, positions_.size());
      if (corner.texture != no_index) refuse("vt", corner.texture, textures_.size());
    }
    if (face.normal > 0) refuse("vn", face.normal - 1, normals_.size());
  }

  void make_triangles() {
    std::size_t count = 0;
    for (const ObjFace& face : faces_) {
      check(face);
      count += face.corners - 2;
    }
    file_.triangles.reserve(count);
    std::vector<Vec3> polygon;
    std::vector<std::array<std::uint32_t, 3>> parts;
    for (const ObjFace& face : faces_) {
      polygon.clear();
      for (std::uint32_t i = 0; i < face.corners; ++i) {
        polygon.push_back(positions_[corners_[face.first + i].position]);
      }
      parts.clear();
      triangulate(polygon, parts);
      const int material = face.use < 0 ? -1 : use_materials_[static_cast<std::size_t>(face.use)];
      for (const auto& part : parts) {
        MeshTriangle& triangle = file_.triangles.emplace_back();
        triangle.material = material;
        triangle.has_uv = corners_[face.first].texture != no_index;
        for (std::size_t k = 0; k < 3; ++k) {
          triangle.corner[k] = corner_at(face.line, corners_[face.first + part[k]], material);
        }
      }
    }
  }

  MeshCorner corner_at(std::size_t line, const CornerIndex& at, int material) const {
    MeshCorner corner;
    corner.position = positions_[at.position];
    if (at.normal != no_index) corner.normal = normals_[at.normal];
    if (!colors_.empty()) {
      std::copy_n(colors_[at.position].begin(), 3, corner.color.begin());
    }
    if (at.texture == no_index) return corner;
    const auto [u, v] = textures_[at.texture];
    corner.u = u;
    corner.v = v;
    if (material < 0) return corner;
    const auto& place = library_.placements[static_cast<std::size_t>(material)];
    corner.u = u * place.scale[0] + place.offset[0];
    corner.v = v * place.scale[1] + place.offset[1];
    if (!std::isfinite(corner.u) || !std::isfinite(corner.v)) {
      throw error_at(line, "texture coordinates beyond the doubles; expected smaller ones, or a smaller -s");
    }
    return corner;
  }

  const std::string& path_;
  std::string folder_;
  std::size_t line_ = 0;
  MeshFile file_;
  MtlLibrary library_;
  std::vector<std::string> libraries_;

  std::vector<Vec3> positions_;
  std::vector<std::array<double, 3>> colors_;  // of all vertices, or empty
  std::vector<std::array<double, 2>> textures_;
  std::vector<Vec3> normals_;
  std::vector<CornerIndex> corners_;
  std::vector<ObjFace> faces_;

  std::unordered_map<std::string, int> uses_;
  std::vector<std::string> use_names_;
  std::vector<int> use_materials_;
  int use_ = -1;

  LeftOut points_, lines_, surfaces_, weights_, bright_;
  std::unordered_map<std::string, LeftOut> unknown_;
  std::vector<std::string> unknown_order_;
};

}  // namespace

MeshFile parse_obj(std::string_view text, const std::string& path) { return ObjReader(path).read(text); }

MeshFile read_obj(const std::string& path) { return parse_obj(read_whole(path, "an OBJ file"), path); }

}  // namespace bitspan
