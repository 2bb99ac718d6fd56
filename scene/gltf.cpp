// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "config/config.hpp"
#include "scene/affine.hpp"
#include "scene/gltf_data.hpp"
#include "scene/mesh_text.hpp"
#include "scene/uri.hpp"

namespace bitspan {
namespace {

using gltf::Accessor;
using gltf::Component;
using gltf::Document;
using gltf::Value;

constexpr std::uint64_t triangle_limit = std::uint64_t{1} << 25;

// What a file may require. Of these materials the picture shows the base colour alone, without light.
constexpr std::array<std::string_view, 4> honoured_extensions{"KHR_texture_transform",
                                                              "KHR_mesh_quantization", "KHR_materials_unlit",
                                                              "KHR_materials_pbrSpecularGlossiness"};
// What changes light alone; a file may use these, and nothing is missing.
constexpr std::array<std::string_view, 14> extensions_of_light{"KHR_lights_punctual",
                                                               "KHR_materials_anisotropy",
                                                               "KHR_materials_clearcoat",
                                                               "KHR_materials_dispersion",
                                                               "KHR_materials_emissive_strength",
                                                               "KHR_materials_ior",
                                                               "KHR_materials_iridescence",
                                                               "KHR_materials_sheen",
                                                               "KHR_materials_specular",
                                                               "KHR_materials_transmission",
                                                               "KHR_materials_variants",
                                                               "KHR_materials_volume",
                                                               "KHR_xmp",
                                                               "KHR_xmp_json_ld"};

std::string counted(std::uint64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

Affine transform_of(const Value& node) {
  const bool has_parts = node.find("translation") || node.find("rotation") || node.find("scale");
  if (node.find("matrix")) {
    if (has_parts) node.refuse("has a matrix beside its parts; expected one of them");
    const auto m = node.numbers<16>("matrix", {});
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) {
      node.refuse("has a matrix with another last row; expected 0, 0, 0, 1");
    }
    return {{Vec3{m[0], m[1], m[2]}, Vec3{m[4], m[5], m[6]}, Vec3{m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
  }
  if (!has_parts) return {};
  const auto t = node.numbers<3>("translation", {0, 0, 0});
  const auto s = node.numbers<3>("scale", {1, 1, 1});
  auto [x, y, z, w] = node.numbers<4>("rotation", {0, 0, 0, 1});
  const double norm = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(std::fabs(norm - 1) < 0.01)) node.refuse("has a rotation that is no unit quaternion; expected one");
  x /= norm, y /= norm, z /= norm, w /= norm;
  return {{Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)} * s[0],
           Vec3{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)} * s[1],
           Vec3{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)} * s[2]},
          {t[0], t[1], t[2]}};
}

// Of texture coordinates with the origin at the top left: u' = offset + R scale u, where R turns
// counterclockwise as one sees the picture.
struct TextureTransform {
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double cosine = 1, sine = 0;

  std::array<double, 2> operator()(double u, double v) const {
    const double x = u * scale[0], y = v * scale[1];
    return {offset[0] + cosine * x + sine * y, offset[1] - sine * x + cosine * y};
  }
};

// What MeshMaterial does not say: it is done to the coordinates.
struct Coordinates {
  std::uint64_t set = 0;
  TextureTransform transform;
};

// Those of the base colour, and the second ones: of the occlusion's texture, or the set behind the first.
struct MaterialCoordinates {
  Coordinates base;
  Coordinates second{.set = 1, .transform = {}};
};
// info: of a texture.
Coordinates coordinates_of(const Value& info) {
  Coordinates out;
  out.set = info.whole("texCoord", 0);
  const auto extensions = info.find("extensions");
  if (const auto change = extensions ? extensions->find("KHR_texture_transform") : std::nullopt) {
    const double rotation = change->number("rotation", 0);
    out.transform = {change->numbers<2>("offset", {0, 0}), change->numbers<2>("scale", {1, 1}),
                     std::cos(rotation), std::sin(rotation)};
    out.set = change->whole("texCoord", out.set);
  }
  return out;
}

struct Node {
  std::size_t index = 0;
  Affine world;
};

struct Primitive {
  Accessor position;
  std::optional<Accessor> indices, coordinates, second_coordinates, color, normal;
  MaterialCoordinates mapping;
  int material = -1;
  std::uint64_t count = 0;  // of vertices in a row
};

class GltfReader {
 public:
  GltfReader(gltf::Bytes bytes, const std::string& path, bool wants_second)
      : file_(std::move(bytes), path), wants_second_(wants_second) {}

  MeshFile read() {
    check_extensions();
    read_materials();
    for (const Node& node : placed_nodes()) read_node(node);
    note_what_is_missing();
    return std::move(out_);
  }

 private:
  void check_extensions();
  void read_materials();
  int read_image(const Value& info);
  std::vector<std::size_t> scene_roots();
  std::vector<Node> placed_nodes();
  void read_node(const Node& node);
  void read_primitive(const Value& primitive, const Affine& world);
  Accessor attribute(const Value& attributes, const std::string& name, unsigned least, unsigned most);
  void append(const Primitive& primitive, std::uint64_t mode, const Affine& world);
  MeshCorner corner(const Primitive& primitive, std::uint64_t position, const Affine& world) const;
  void note_what_is_missing();

  Document file_;
  bool wants_second_;  // second coordinates
  MeshFile out_;
  std::vector<MaterialCoordinates> coordinates_;  // per material
  std::map<std::size_t, int> images_;             // from the file's to ours
  std::uint64_t points_ = 0, lines_ = 0, without_position_ = 0, without_coordinates_ = 0, skins_ = 0,
                morphs_ = 0;
  std::uint64_t bad_normals_ = 0;
};

void GltfReader::check_extensions() {
  const Value root = file_.root();
  const auto is_in = [](const auto& list, std::string_view name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  if (const auto required = root.find("extensionsRequired")) {
    for (const Value& name : required->items()) {
      if (is_in(honoured_extensions, name.text())) continue;
      std::string known;
      for (const std::string_view e : honoured_extensions)
        known += (known.empty() ? "" : ", ") + std::string(e);
      name.refuse("the file requires the extension " + in_quotes(name.text()) + "; expected at most " +
                  known);
    }
  }
  if (const auto used = root.find("extensionsUsed")) {
    std::string left_out;
    for (const Value& name : used->items()) {
      if (is_in(honoured_extensions, name.text()) || is_in(extensions_of_light, name.text())) continue;
      left_out += (left_out.empty() ? "" : ", ") + in_quotes(name.text());
    }
    if (!left_out.empty()) out_.notes.push_back("extensions that are not known are left out: " + left_out);
  }
}

int GltfReader::read_image(const Value& info) {
  info.need("index");
  const Value texture = file_.item("textures", *file_.index(info, "index", "textures"));
  const std::optional<std::size_t> source = file_.index(texture, "source", "images");
  if (!source) {
    out_.notes.push_back(texture.place() + " has no image that can be read; its faces have none");
    return -1;
  }
  const auto [entry, is_new] = images_.try_emplace(*source, static_cast<int>(out_.images.size()));
  if (!is_new) return entry->second;
  const Value image = file_.item("images", *source);
  MeshImage& read = out_.images.emplace_back();
  read.name = file_.path() + ": " + image.place();
  if (const auto uri = image.find("uri")) {
    if (is_data_uri(uri->text())) {
      auto bytes = data_of_uri(uri->text());
      if (!bytes) uri->refuse("is broken; expected data:TYPE;base64,DIGITS");
      read.bytes = *std::move(bytes);
      return entry->second;
    }
    const auto name = path_of_uri(uri->text());
    if (!name) uri->refuse("has an illegal escape; expected % and two hexadecimal digits");
    read.path = (std::filesystem::path(file_.path()).parent_path() / *name).string();
    read.name = read.path;
    return entry->second;
  }
  image.need("bufferView");
  const auto bytes = file_.view(*file_.index(image, "bufferView", "bufferViews"));
  read.bytes.assign(bytes.begin(), bytes.end());
  return entry->second;
}

void GltfReader::read_materials() {
  for (const Value& json : file_.list("materials")) {
    MeshMaterial material;
    MaterialCoordinates coordinates;
    if (const auto name = json.find("name")) material.name = name->text();
    material.alpha = AlphaMode::opaque;
    if (const auto mode = json.find("alphaMode")) {
      if (mode->text() == "MASK") {
        material.alpha = AlphaMode::mask;
      } else if (mode->text() == "BLEND") {
        material.alpha = AlphaMode::blend;
      } else if (mode->text() != "OPAQUE") {
        mode->refuse("is " + in_quotes(mode->text()) + "; expected OPAQUE, MASK or BLEND");
      }
    }
    material.alpha_cutoff = json.number("alphaCutoff", 0.5);
    material.two_sided = json.boolean("doubleSided", false);
    std::optional<Value> surface = json.find("pbrMetallicRoughness");
    std::string factor = "baseColorFactor", texture = "baseColorTexture";
    if (const auto extensions = json.find("extensions")) {
      if (const auto glossy = extensions->find("KHR_materials_pbrSpecularGlossiness")) {
        surface = glossy;
        factor = "diffuseFactor";
        texture = "diffuseTexture";
      }
    }
    if (surface) material.color = surface->numbers<4>(factor, {1, 1, 1, 1});
    if (const auto info = surface ? surface->find(texture) : std::nullopt) {
      material.image = read_image(*info);
      coordinates.base = coordinates_of(*info);
    }
    if (const auto info = json.find("occlusionTexture")) coordinates.second = coordinates_of(*info);
    out_.materials.push_back(std::move(material));
    coordinates_.push_back(coordinates);
  }
}

// The nodes that the picture begins with: those of the scene that the file says, or of its first one; where
// it has none, all that are nobody's children.
std::vector<std::size_t> GltfReader::scene_roots() {
  const std::size_t count = file_.list("nodes").size();
  std::vector<std::size_t> roots;
  if (!file_.list("scenes").empty()) {
    const std::size_t shown = file_.index(file_.root(), "scene", "scenes").value_or(0);
    const Value scene = file_.item("scenes", shown);
    if (file_.list("scenes").size() > 1) {
      out_.notes.push_back("scene " + std::to_string(shown) + " of " +
                           std::to_string(file_.list("scenes").size()) + " is shown");
    }
    if (const auto nodes = scene.find("nodes")) {
      for (const Value& node : nodes->items()) {
        if (node.whole() >= count) {
          node.refuse("is " + std::to_string(node.whole()) + "; expected an index below the " +
                      std::to_string(count) + " nodes");
        }
        roots.push_back(node.whole());
      }
    }
    return roots;
  }
  std::vector<bool> is_child(count);
  for (const Value& node : file_.list("nodes")) {
    if (const auto children = node.find("children")) {
      for (const Value& child : children->items()) {
        if (child.whole() < count)
          is_child[child.whole()] = true;  // others are refused where they are reached
      }
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_child[i]) roots.push_back(i);
  }
  if (roots.empty() && count > 0) file_.list("nodes")[0].refuse("is below itself; expected a tree of nodes");
  return roots;
}

// The nodes of the scene in the order of the file, each behind its parent. A list takes the place of
// recursion.
std::vector<Node> GltfReader::placed_nodes() {
  const std::vector<Value>& nodes = file_.list("nodes");
  std::vector<Node> open, out;
  std::vector<bool> reached(nodes.size());
  const auto enter = [&](std::size_t index, const Affine& parent) {
    if (reached[index]) nodes[index].refuse("is reached twice; expected a tree of nodes");
    reached[index] = true;
    open.push_back({index, parent * transform_of(nodes[index])});
  };
  const std::vector<std::size_t> roots = scene_roots();
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) enter(*root, {});
  while (!open.empty()) {
    const Node node = open.back();
    open.pop_back();
    out.push_back(node);
    const auto list = nodes[node.index].find("children");
    if (!list) continue;
    const std::vector<Value> children = list->items();
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      if (child->whole() >= nodes.size()) {
        child->refuse("is " + std::to_string(child->whole()) + "; expected an index below the " +
                      std::to_string(nodes.size()) + " nodes");
      }
      enter(child->whole(), node.world);
    }
  }
  return out;
}

void GltfReader::read_node(const Node& node) {
  const Value json = file_.item("nodes", node.index);
  const auto index = file_.index(json, "mesh", "meshes");
  if (!index) return;
  if (json.find("skin")) ++skins_;
  const Value mesh = file_.item("meshes", *index);
  std::optional<Value> weights = json.find("weights");
  if (!weights) weights = mesh.find("weights");
  if (weights) {
    for (const Value& weight : weights->items()) {
      if (weight.number() == 0) continue;
      ++morphs_;
      break;
    }
  }
  for (const Value& primitive : mesh.need("primitives").items()) read_primitive(primitive, node.world);
}

Accessor GltfReader::attribute(const Value& attributes, const std::string& name, unsigned least,
                               unsigned most) {
  Accessor accessor = file_.accessor(*file_.index(attributes, name, "accessors"));
  if (accessor.components < least || accessor.components > most) {
    attributes.refuse(name + " has " + counted(accessor.components, "component") + "; expected " +
                      std::to_string(least) + (most > least ? " or " + std::to_string(most) : ""));
  }
  if (accessor.component == Component::uint32) {
    attributes.refuse(name + " has integers of 32 bits; expected floating-point numbers or 8 or 16 bits");
  }
  return accessor;
}

void GltfReader::read_primitive(const Value& json, const Affine& world) {
  const Value attributes = json.need("attributes");
  const std::uint64_t mode = json.whole("mode", 4);
  if (mode > 6) json.refuse("has mode " + std::to_string(mode) + "; expected 0..6");
  if (!attributes.find("POSITION")) {
    ++without_position_;
    return;
  }
  Primitive primitive;
  primitive.position = attribute(attributes, "POSITION", 3, 3);
  primitive.count = primitive.position.count;
  if (const auto indices = file_.index(json, "indices", "accessors")) {
    primitive.indices = file_.accessor(*indices);
    primitive.count = primitive.indices->count;
    const Component c = primitive.indices->component;
    if (primitive.indices->components != 1 ||
        (c != Component::uint8 && c != Component::uint16 && c != Component::uint32)) {
      json.refuse("has indices of a wrong type; expected unsigned integers, one per vertex");
    }
  }
  const std::uint64_t count = primitive.count;
  if (mode == 0) points_ += count;
  if (mode == 1) lines_ += count / 2;
  if (mode == 2) lines_ += count;
  if (mode == 3) lines_ += count == 0 ? 0 : count - 1;
  if (mode < 4) return;
  if (count < 3 || (mode == 4 && count % 3 != 0)) {
    json.refuse("has " + std::to_string(count) + " vertices in a row; expected " +
                (mode == 4 ? "three per triangle" : "at least three"));
  }
  const std::uint64_t triangles = mode == 4 ? count / 3 : count - 2;
  if (triangles > triangle_limit - out_.triangles.size()) {
    json.refuse("makes more triangles than are read; expected at most " + std::to_string(triangle_limit));
  }
  if (const auto material = file_.index(json, "material", "materials")) {
    primitive.material = static_cast<int>(*material);
    primitive.mapping = coordinates_[*material];
  }
  const auto read_set = [&](std::uint64_t set) -> std::optional<Accessor> {
    const std::string name = "TEXCOORD_" + std::to_string(set);
    if (!attributes.find(name)) return std::nullopt;
    return attribute(attributes, name, 2, 2);
  };
  primitive.coordinates = read_set(primitive.mapping.base.set);
  if (wants_second_) primitive.second_coordinates = read_set(primitive.mapping.second.set);
  if (!primitive.coordinates && primitive.material >= 0 &&
      out_.materials[static_cast<std::size_t>(primitive.material)].image >= 0) {
    without_coordinates_ += triangles;
  }
  if (attributes.find("COLOR_0")) {
    primitive.color = attribute(attributes, "COLOR_0", 3, 4);
    if (primitive.color->component != Component::float32 && !primitive.color->normalized) {
      attributes.refuse("COLOR_0 has integers; expected normalized ones");
    }
  }
  // A file stays readable whose normals are not.
  try {
    if (attributes.find("NORMAL")) primitive.normal = attribute(attributes, "NORMAL", 3, 3);
  } catch (const InputError&) {
    ++bad_normals_;
  }
  if (primitive.normal && primitive.normal->count != primitive.position.count) {
    primitive.normal.reset();
    ++bad_normals_;
  }
  for (const std::optional<Accessor>* other :
       {&primitive.coordinates, &primitive.second_coordinates, &primitive.color}) {
    if (*other && (*other)->count != primitive.position.count) {
      throw InputError((*other)->name + ": has " + std::to_string((*other)->count) + " elements; expected " +
                       std::to_string(primitive.position.count) + " as POSITION");
    }
  }
  append(primitive, mode, world);
}

MeshCorner GltfReader::corner(const Primitive& primitive, std::uint64_t position, const Affine& world) const {
  std::uint64_t vertex = position;
  if (primitive.indices) {
    vertex = primitive.indices->code(position);
    if (vertex >= primitive.position.count) {
      throw InputError(primitive.indices->name + ": element " + std::to_string(position) + " is the index " +
                       std::to_string(vertex) + "; expected one below the " +
                       std::to_string(primitive.position.count) + " vertices");
    }
  }
  const auto p = primitive.position.element(vertex);
  MeshCorner corner;
  corner.position = world.point({p[0], p[1], p[2]});
  const auto place = [&](const std::optional<Accessor>& of, const Coordinates& mapping, double& u,
                         double& v) {
    if (!of) return;
    const auto t = of->element(vertex);
    const auto uv = mapping.transform(t[0], t[1]);
    u = uv[0];
    v = 1 - uv[1];
  };
  place(primitive.coordinates, primitive.mapping.base, corner.u, corner.v);
  place(primitive.second_coordinates, primitive.mapping.second, corner.u2, corner.v2);
  if (primitive.normal) {
    const auto n = primitive.normal->element(vertex);
    corner.normal = world.normal({n[0], n[1], n[2]});
  }
  if (primitive.color) {
    corner.color = primitive.color->element(vertex);
    if (primitive.color->components == 3) corner.color[3] = 1;
  }
  return corner;
}

void GltfReader::append(const Primitive& primitive, std::uint64_t mode, const Affine& world) {
  const bool mirrors = world.mirrors();
  const auto triangle = [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    if (mirrors) std::swap(b, c);  // the front stays in front
    out_.triangles.push_back(
        {{corner(primitive, a, world), corner(primitive, b, world), corner(primitive, c, world)},
         primitive.material,
         primitive.coordinates.has_value(),
         primitive.second_coordinates.has_value()});
  };
  const std::uint64_t count = primitive.count;
  if (mode == 4) {
    for (std::uint64_t i = 0; i + 2 < count; i += 3) triangle(i, i + 1, i + 2);
  } else if (mode == 5) {  // a strip: each second one runs the other way
    for (std::uint64_t i = 0; i + 2 < count; ++i) triangle(i, i + 1 + i % 2, i + 2 - i % 2);
  } else {  // a fan
    for (std::uint64_t i = 0; i + 2 < count; ++i) triangle(i + 1, i + 2, 0);
  }
}

void GltfReader::note_what_is_missing() {
  std::vector<std::string>& notes = out_.notes;
  if (points_ > 0 || lines_ > 0) {
    notes.push_back(counted(points_, "point") + " and " + counted(lines_, "line") + " are left out");
  }
  if (without_position_ > 0) {
    notes.push_back(counted(without_position_, "primitive") + " without POSITION left out");
  }
  if (without_coordinates_ > 0) {
    notes.push_back(counted(without_coordinates_, "face") +
                    " without the texture coordinates that the material names; drawn without its image");
  }
  if (bad_normals_ > 0) {
    notes.push_back("the NORMAL of " + counted(bad_normals_, "primitive") +
                    " is left out: it cannot be read; normals are formed");
  }
  if (skins_ > 0) notes.push_back(counted(skins_, "skin") + " left out: meshes stand where their nodes are");
  if (morphs_ > 0)
    notes.push_back("the weights of morph targets are left out, of " + counted(morphs_, "node"));
  const auto note_list = [&](const std::string& key, const std::string& what, const std::string& instead) {
    const std::size_t count = file_.list(key).size();
    if (count > 0) notes.push_back(counted(count, what) + " left out: " + instead);
  };
  note_list("animations", "animation", "nodes stand where the file places them");
  note_list("cameras", "camera", "the picture has the viewer of the command");
}

}  // namespace

MeshFile read_gltf(const std::string& path, bool second_coordinates) {
  return GltfReader(gltf::read_bytes(path), path, second_coordinates).read();
}

MeshFile parse_gltf(std::string_view bytes, const std::string& path, bool second_coordinates) {
  return GltfReader({bytes.begin(), bytes.end()}, path, second_coordinates).read();
}

}  // namespace bitspan
