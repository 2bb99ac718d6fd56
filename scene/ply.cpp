// SPDX-License-Identifier: Apache-2.0
#include "scene/ply.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "scene/mesh_text.hpp"
#include "scene/ply_data.hpp"
#include "scene/ply_header.hpp"
#include "scene/triangulate.hpp"

namespace bitspan {
namespace {

// What a property of an element is read as.
enum class Use : std::uint8_t {
  none,
  x,
  y,
  z,
  nx,
  ny,
  nz,
  u,
  v,
  red,
  green,
  blue,
  alpha,
  indices,
  texcoord,
  texnumber
};

struct UseName {
  Use use;
  std::string_view name;
};
constexpr auto vertex_names = std::to_array<UseName>({{Use::x, "x"},
                                                      {Use::y, "y"},
                                                      {Use::z, "z"},
                                                      {Use::nx, "nx"},
                                                      {Use::ny, "ny"},
                                                      {Use::nz, "nz"},
                                                      {Use::u, "u"},
                                                      {Use::v, "v"},
                                                      {Use::u, "s"},
                                                      {Use::v, "t"},
                                                      {Use::u, "texture_u"},
                                                      {Use::v, "texture_v"},
                                                      {Use::u, "texture_s"},
                                                      {Use::v, "texture_t"}});
constexpr auto color_names = std::to_array<UseName>({{Use::red, "red"},
                                                     {Use::green, "green"},
                                                     {Use::blue, "blue"},
                                                     {Use::alpha, "alpha"},
                                                     {Use::red, "diffuse_red"},
                                                     {Use::green, "diffuse_green"},
                                                     {Use::blue, "diffuse_blue"},
                                                     {Use::alpha, "diffuse_alpha"}});
constexpr auto face_names = std::to_array<UseName>({{Use::indices, "vertex_indices"},
                                                    {Use::indices, "vertex_index"},
                                                    {Use::texcoord, "texcoord"},
                                                    {Use::texnumber, "texnumber"}});

bool is_list(Use use) { return use == Use::indices || use == Use::texcoord; }
bool is_normal(Use use) { return use == Use::nx || use == Use::ny || use == Use::nz; }
bool is_color(Use use) { return use >= Use::red && use <= Use::alpha; }

// What a value of a colour is divided by.
double color_max(PlyType type) {
  return type == PlyType::uint8    ? 255
         : type == PlyType::uint16 ? 65535
         : type == PlyType::uint32 ? 4294967295
                                   : 1;
}

struct PlyVertex {
  Vec3 position, normal;
  double u = 0, v = 0;
  std::array<double, 4> color{1, 1, 1, 1};
};

// A face before the whole file is known: vertices may come later.
struct PlyFace {
  std::uint64_t instance = 0;
  PlyPlace place;
  std::size_t first = 0;  // of the indices
  std::uint32_t corners = 0;
  std::int64_t texture = 0;
  std::optional<std::size_t> coordinates;  // the first of u v u v ...
  std::array<double, 4> color{1, 1, 1, 1};
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& path)
      : path_(path), header_(read_ply_header(bytes, path)), data_(bytes, path, header_) {}

  MeshFile read() {
    check_elements();
    for (const PlyElement& element : header_.elements) {
      data_.expect(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else if (element.name == "tristrips") {
        read_strips(element);
      } else {
        skip_element(element);
      }
    }
    data_.expect_end();
    make_materials();
    make_faces();
    make_strips();
    note_left_out();
    return std::move(file_);
  }

 private:
  void check_elements() const {
    for (const std::string_view name : {"vertex", "face", "tristrips"}) {
      const PlyElement* first = nullptr;
      for (const PlyElement& element : header_.elements) {
        if (element.name != name) continue;
        if (first != nullptr) {
          throw header_error(element, "a second element " + in_quotes(name) + "; expected one");
        }
        first = &element;
      }
    }
  }

  InputError header_error(const PlyElement& element, const std::string& what) const {
    return InputError(path_ + ":" + std::to_string(element.line) + ": " + what);
  }

  // Returns the use of each property.
  std::vector<Use> uses_of(const PlyElement& element, std::span<const UseName> names) const {
    std::vector<Use> uses;
    for (const PlyProperty& property : element.properties) {
      Use use = Use::none;
      for (const std::span<const UseName> list : {names, std::span<const UseName>(color_names)}) {
        const auto known = std::ranges::find(list, property.name, &UseName::name);
        if (known != list.end()) use = known->use;
      }
      if (is_normal(use) && property.count) use = Use::none;  // a file stays readable whose normals are not
      // The first of two ways to say it counts: red in front of diffuse_red.
      const auto before = std::ranges::find(uses, use);
      if (use != Use::none && before != uses.end()) {
        const auto index = static_cast<std::size_t>(before - uses.begin());
        if (element.properties[index].name == property.name || use == Use::indices) {
          throw header_error(element, "two properties " + in_quotes(property.name) + "; expected one");
        }
        use = Use::none;
      }
      if (use != Use::none && is_list(use) != property.count.has_value()) {
        throw header_error(element, "property " + in_quotes(property.name) +
                                        (is_list(use) ? " is one value; expected a list"
                                                      : " is a list; expected one value"));
      }
      if ((use == Use::indices || use == Use::texnumber) && is_real(property.type)) {
        throw header_error(element, "property " + in_quotes(property.name) + " has type " +
                                        std::string(name_of(property.type)) + "; expected integers");
      }
      if (is_color(use) && !is_real(property.type) && is_signed(property.type)) {
        throw header_error(element, "colour " + in_quotes(property.name) + " has type " +
                                        std::string(name_of(property.type)) +
                                        "; expected uchar, ushort, uint, float or double");
      }
      uses.push_back(use);
    }
    return uses;
  }

  static bool has(const std::vector<Use>& uses, std::initializer_list<Use> all) {
    return std::ranges::all_of(all, [&](Use use) { return std::ranges::find(uses, use) != uses.end(); });
  }

  void skip_property(const PlyProperty& property) {
    data_.skip(property.type, property.count ? data_.read_length(*property.count, property.type) : 1);
  }

  void skip_element(const PlyElement& element) {
    for (std::uint64_t i = 0; !element.properties.empty() && i < element.count; ++i) {
      data_.begin(element, i);
      for (const PlyProperty& property : element.properties) skip_property(property);
    }
    if (element.count != 0) {
      file_.notes.push_back(std::to_string(element.count) + " instances of element " +
                            in_quotes(element.name) + " are left out");
    }
  }

  // Whether the element has a whole colour.
  bool check_color(const PlyElement& element, const std::vector<Use>& uses) {
    const bool is_whole = has(uses, {Use::red, Use::green, Use::blue});
    if (!is_whole && std::ranges::any_of(uses, is_color)) {
      file_.notes.push_back("the colour of element " + in_quotes(element.name) +
                            " is left out: it has not all of red, green and blue");
    }
    return is_whole;
  }

  double read_color(PlyType type) {
    const double value = data_.read_number(type) / color_max(type);
    if (value < 0 || value > 1) ++bright_;
    return value;
  }

  void read_vertices(const PlyElement& element) {
    const std::vector<Use> uses = uses_of(element, vertex_names);
    if (!has(uses, {Use::x, Use::y, Use::z})) {
      throw header_error(element, "element vertex has not all of x, y and z; expected them");
    }
    has_uv_ = has(uses, {Use::u, Use::v});
    has_color_ = check_color(element, uses);
    vertices_.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      data_.begin(element, i);
      PlyVertex vertex;
      std::array<double, 4> color{1, 1, 1, 1};
      for (std::size_t p = 0; p < uses.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        switch (uses[p]) {
          case Use::x:
            vertex.position.x = data_.read_number(property.type);
            break;
          case Use::y:
            vertex.position.y = data_.read_number(property.type);
            break;
          case Use::z:
            vertex.position.z = data_.read_number(property.type);
            break;
          case Use::nx:
            vertex.normal.x = data_.read_loose_number(property.type);
            break;
          case Use::ny:
            vertex.normal.y = data_.read_loose_number(property.type);
            break;
          case Use::nz:
            vertex.normal.z = data_.read_loose_number(property.type);
            break;
          case Use::u:
            vertex.u = data_.read_number(property.type);
            break;
          case Use::v:
            vertex.v = data_.read_number(property.type);
            break;
          case Use::red:
          case Use::green:
          case Use::blue:
          case Use::alpha:
            color[static_cast<std::size_t>(uses[p]) - static_cast<std::size_t>(Use::red)] =
                read_color(property.type);
            break;
          case Use::none:
          case Use::indices:
          case Use::texcoord:
          case Use::texnumber:
            skip_property(property);
            break;
        }
      }
      if (has_color_) vertex.color = color;
      vertices_.push_back(vertex);
    }
  }

  void read_faces(const PlyElement& element) {
    const std::vector<Use> uses = uses_of(element, face_names);
    if (!has(uses, {Use::indices})) {
      if (element.count == 0) return;  // of a cloud of points
      throw header_error(element, "element face has no list vertex_indices; expected it");
    }
    face_element_ = &element;
    has_face_color_ = check_color(element, uses);
    has_texnumber_ = has(uses, {Use::texnumber});
    for (std::uint64_t i = 0; i < element.count; ++i) {
      data_.begin(element, i);
      PlyFace face;
      face.instance = i;
      face.place = data_.place();
      for (std::size_t p = 0; p < uses.size(); ++p) read_face_property(element.properties[p], uses[p], face);
      check_coordinates(face);
      faces_.push_back(face);
    }
  }

  void read_face_property(const PlyProperty& property, Use use, PlyFace& face) {
    switch (use) {
      case Use::indices: {
        const std::uint64_t corners = data_.read_length(*property.count, property.type);
        face.place = data_.place();
        if (corners < 3 || corners > polygon_corners_max) {
          throw data_.error("a face of " + std::to_string(corners) + " corners; expected 3.." +
                            std::to_string(polygon_corners_max));
        }
        face.first = indices_.size();
        face.corners = static_cast<std::uint32_t>(corners);
        for (std::uint64_t c = 0; c < corners; ++c) indices_.push_back(data_.read_integer(property.type));
        break;
      }
      case Use::texcoord: {
        const std::uint64_t count = data_.read_length(*property.count, property.type);
        if (count != 0) face.coordinates = coordinates_.size();
        for (std::uint64_t c = 0; c < count; ++c) coordinates_.push_back(data_.read_number(property.type));
        break;
      }
      case Use::texnumber:
        face.texture = data_.read_integer(property.type);
        break;
      case Use::red:
      case Use::green:
      case Use::blue:
      case Use::alpha:
        face.color[static_cast<std::size_t>(use) - static_cast<std::size_t>(Use::red)] =
            read_color(property.type);
        break;
      case Use::none:
      case Use::x:
      case Use::y:
      case Use::z:
      case Use::nx:
      case Use::ny:
      case Use::nz:
      case Use::u:
      case Use::v:
        skip_property(property);
        break;
    }
  }

  void check_coordinates(const PlyFace& face) const {
    if (!face.coordinates) return;
    const std::size_t count = coordinates_.size() - *face.coordinates;
    if (count != std::size_t{2} * face.corners) {
      throw data_.error("texcoord has " + std::to_string(count) + " values; expected " +
                        std::to_string(2 * face.corners) + ", u and v per corner, or none");
    }
  }

  // Lists of indices; a negative one ends a strip.
  void read_strips(const PlyElement& element) {
    const std::vector<Use> uses = uses_of(element, face_names);
    if (!has(uses, {Use::indices})) {
      throw header_error(element, "element tristrips has no list vertex_indices; expected it");
    }
    strip_element_ = &element;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      data_.begin(element, i);
      for (std::size_t p = 0; p < uses.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (uses[p] != Use::indices) {
          skip_property(property);
          continue;
        }
        PlyFace list;
        list.instance = i;
        const std::uint64_t count = data_.read_length(*property.count, property.type);
        list.place = data_.place();
        if (count > 0xFFFFFFFF) throw data_.error("a strip of 2^32 indices or more; expected fewer");
        list.first = strip_indices_.size();
        list.corners = static_cast<std::uint32_t>(count);
        for (std::uint64_t c = 0; c < count; ++c) {
          const std::int64_t index = data_.read_integer(property.type);
          // -1, where the type has no sign.
          strip_indices_.push_back(property.type == PlyType::uint32 && index == 0xFFFFFFFF ? -1 : index);
        }
        strips_.push_back(list);
      }
    }
  }

  void make_materials() {
    const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
    for (std::string name : header_.images) {
      std::replace(name.begin(), name.end(), '\\', '/');
      const std::string path = (folder / name).string();
      add_material(static_cast<int>(file_.images.size()));
      file_.images.push_back({path, path, {}});
    }
    // Of faces without a texture.
    white_ = static_cast<int>(file_.materials.size());
    add_material(-1);
  }

  void add_material(int image) {
    MeshMaterial& material = file_.materials.emplace_back();
    material.image = image;
    material.two_sided = true;
  }

  int material_of(const PlyFace& face) const {
    const auto count = static_cast<std::int64_t>(header_.images.size());
    if (count == 0 || (has_texnumber_ && face.texture == -1)) return white_;
    if (face.texture < 0 || face.texture >= count) {
      throw data_.error(*face_element_, face.instance, face.place,
                        "texnumber " + std::to_string(face.texture) + " is not there; expected -1.." +
                            std::to_string(count - 1));
    }
    return static_cast<int>(face.texture);
  }

  const PlyVertex& vertex(const PlyElement& element, const PlyFace& face, std::int64_t index) const {
    if (index < 0 || static_cast<std::uint64_t>(index) >= vertices_.size()) {
      throw data_.error(
          element, face.instance, face.place,
          "vertex " + std::to_string(index) + " is not there; expected 0.." +
              (vertices_.empty() ? "none: the file has no vertices" : std::to_string(vertices_.size() - 1)));
    }
    return vertices_[static_cast<std::size_t>(index)];
  }

  static MeshCorner corner_of(const PlyVertex& v) {
    return {.position = v.position, .u = v.u, .v = v.v, .color = v.color, .normal = v.normal};
  }

  void make_faces() {
    if (indices_.size() < 2 * faces_.size()) return;  // none
    file_.triangles.reserve(indices_.size() - 2 * faces_.size());
    std::vector<Vec3> polygon;
    std::vector<std::array<std::uint32_t, 3>> parts;
    for (const PlyFace& face : faces_) {
      const int material = material_of(face);
      polygon.clear();
      for (std::uint32_t c = 0; c < face.corners; ++c) {
        polygon.push_back(vertex(*face_element_, face, indices_[face.first + c]).position);
      }
      parts.clear();
      triangulate(polygon, parts);
      for (const auto& part : parts) {
        MeshTriangle& triangle = file_.triangles.emplace_back();
        triangle.material = material;
        triangle.has_uv = has_uv_ || face.coordinates;
        for (std::size_t k = 0; k < 3; ++k) {
          MeshCorner& corner = triangle.corner[k];
          corner = corner_of(vertices_[static_cast<std::size_t>(indices_[face.first + part[k]])]);
          if (face.coordinates) {
            const std::size_t at = *face.coordinates + std::size_t{2} * part[k];
            corner.u = coordinates_[at];
            corner.v = coordinates_[at + 1];
          }
          if (has_face_color_ && !has_color_) corner.color = face.color;
        }
      }
    }
  }

  void make_strips() {
    const int material = header_.images.empty() ? white_ : 0;
    for (const PlyFace& list : strips_) {
      std::size_t length = 0;  // of the strip so far
      for (std::uint32_t c = 0; c < list.corners; ++c) {
        const std::size_t at = list.first + c;
        if (strip_indices_[at] == -1) {
          if (length == 1 || length == 2) ++short_strips_;
          length = 0;
          continue;
        }
        vertex(*strip_element_, list, strip_indices_[at]);
        if (++length < 3) continue;
        // Every second triangle runs the other way.
        const bool is_odd = length % 2 == 0;
        const std::array<std::int64_t, 3> corners{strip_indices_[at - (is_odd ? 1 : 2)],
                                                  strip_indices_[at - (is_odd ? 2 : 1)], strip_indices_[at]};
        // Strips are joined by triangles that have no area.
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2]) continue;
        MeshTriangle& triangle = file_.triangles.emplace_back();
        triangle.material = material;
        triangle.has_uv = has_uv_;
        for (std::size_t k = 0; k < 3; ++k) {
          triangle.corner[k] = corner_of(vertices_[static_cast<std::size_t>(corners[k])]);
        }
      }
      if (length == 1 || length == 2) ++short_strips_;
    }
  }

  void note_left_out() {
    if (bright_ != 0) {
      file_.notes.push_back(std::to_string(bright_) + " values of colours are beyond 0..1; they are clamped");
    }
    if (short_strips_ != 0) {
      file_.notes.push_back(std::to_string(short_strips_) + " strips of 1 or 2 vertices are left out");
    }
    if (has_color_ && has_face_color_) {
      file_.notes.emplace_back("the colours of faces are left out: vertices have colours");
    }
  }

  const std::string& path_;
  PlyHeader header_;
  PlyData data_;
  MeshFile file_;

  std::vector<PlyVertex> vertices_;
  bool has_uv_ = false, has_color_ = false;
  const PlyElement* face_element_ = nullptr;
  std::vector<PlyFace> faces_;
  std::vector<std::int64_t> indices_;
  std::vector<double> coordinates_;
  bool has_face_color_ = false, has_texnumber_ = false;
  const PlyElement* strip_element_ = nullptr;
  std::vector<PlyFace> strips_;
  std::vector<std::int64_t> strip_indices_;
  int white_ = 0;
  std::uint64_t bright_ = 0, short_strips_ = 0;
};

}  // namespace

MeshFile parse_ply(std::string_view bytes, const std::string& path) { return PlyReader(bytes, path).read(); }

MeshFile read_ply(const std::string& path) { return parse_ply(read_whole(path, "a PLY file"), path); }

}  // namespace bitspan
