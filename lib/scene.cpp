// SPDX-License-Identifier: Apache-2.0
// Scenes of the interface: those that the library reads, and those that a caller describes.
#include "lib/scene.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "lib/handles.hpp"
#include "lib/structs.hpp"
#include "model/pipeline.hpp"
#include "model/stages/texel.hpp"
#include "scene/camera_views.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "scene/picture_size.hpp"
#include "scene/procedural.hpp"
#include "scene/project.hpp"
#include "scene/shadow.hpp"
#include "scene/texture.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan::capi {
namespace {

// A scene that was read, and the description of it that the caller gets.
struct SceneState {
  Scene scene;
  std::vector<std::vector<std::uint8_t>> decoded;  // of textures of another format than rgba8888
  std::vector<bs_texture> textures;
  std::vector<bs_vertex> vertices;
  std::vector<std::int32_t> texture_of;
  std::string notes;  // a line each
};

// Never destroyed: functions may be called while the program ends.
Handles<bs_scene, SceneState>& scenes() {
  static auto* const all = new Handles<bs_scene, SceneState>("bs_scene");
  return *all;
}

// What of a scene the caller may choose.
struct LoadOptions {
  std::int32_t width = 0, height = 0;
  std::optional<int> frame{};
  std::optional<ShadowOptions> shadow{};
};

Scene mesh(const std::string& path, int camera, const Size& size, const std::optional<ShadowOptions>& shadow,
           std::string& notes) {
  MeshOptions options;
  options.shadow = shadow;
  if (camera != 0) set_camera(options.camera, camera);
  options.width = size.width;
  options.height = size.height;
  ProjectReport faces;
  Mesh mesh = read_mesh(path);
  for (const std::string& note : mesh.notes) notes += note + "\n";
  Scene scene = mesh_scene(std::move(mesh), options, faces);
  check_scene(scene, path);
  if (faces.drawn == 0) {
    throw InputError(path + ": none of " + std::to_string(faces.faces) +
                     " faces is drawn; expected one that the camera sees from its front");
  }
  if (camera != 0) scene.name = view_name(scene.name, camera);
  return scene;
}

Scene load(const std::string& name, const LoadOptions& options, const std::string& function,
           std::string& notes) {
  const auto& [width, height, frame, shadow] = options;
  const bool sized = width != 0 || height != 0;
  const Size size = sized ? Size{width, height} : Size{};
  if (!is_legal(size)) {
    fail(BS_BAD_INPUT, function + ": width, height: " + std::to_string(width) + "x" + std::to_string(height) +
                           " is out of range; expected 1.." + std::to_string(picture_size_limit) +
                           " each way and at most " + std::to_string(picture_area_limit) + " pixels");
  }
  const auto [seen, camera] = split_view(name);
  const bool stream = seen != "-" && is_stream(seen);
  if (frame && !stream) {
    fail(BS_BAD_INPUT,
         function + ": name_or_path: " + name +
             " has no dynamic textures; expected a stream (.tri, .trib) with some, or bs_scene_load");
  }
  if (!stream && seen != "demo") return mesh(seen, camera, size, shadow, notes);
  // What another camera sees is not of the demo's world any more.
  const bool in_world = !stream && camera == 0;
  Scene scene =
      stream ? read_tri(seen, frame) : demo_scene(size.width, size.height, in_world ? shadow : std::nullopt);
  if (sized && (scene.width != width || scene.height != height)) {
    fail(BS_BAD_INPUT, function + ": width, height: " + name + " is a stream of " +
                           std::to_string(scene.width) + "x" + std::to_string(scene.height) +
                           " pixels; expected these, or 0");
  }
  if (camera != 0) scene = seen_from(scene, camera);
  if (!shadow || in_world) return scene;
  const std::vector<Face> casters = faces_of(scene);
  return shadowed(std::move(scene), casters, *shadow);
}

ShadowOptions shadow_from(const bs_shadow* from, const std::string& what) {
  const auto s =
      read_struct(from, bs_shadow BS_SHADOW_INIT, BITSPAN_THROUGH(bs_shadow, light), [&] { return what; });
  if (s.has_at < 0 || s.has_at > 1) {
    fail(BS_BAD_INPUT, what + ".has_at: " + std::to_string(s.has_at) + "; expected 0 or 1");
  }
  ShadowOptions out;
  out.light = {s.light[0], s.light[1], s.light[2]};
  if (s.has_at == 1) out.at = Vec3{s.at[0], s.at[1], s.at[2]};
  out.degrees = s.degrees;
  out.size = s.map_size;
  if (s.bias != -1) out.bias = s.bias;
  out.dark = s.dark;
  check_shadow(out, {what + ".light", what + ".at", what + ".degrees", what + ".map_size", what + ".bias",
                     what + ".dark"});
  return out;
}

LoadOptions options_from(const bs_scene_options* from, const std::string& function) {
  if (from == nullptr) return {};
  const std::string what = function + ": options";
  const auto o = read_struct(from, bs_scene_options BS_SCENE_OPTIONS_INIT,
                             BITSPAN_THROUGH(bs_scene_options, height), [&] { return std::string(what); });
  if (o.reserved != 0) {
    fail(BS_BAD_INPUT, what + ".reserved: " + std::to_string(o.reserved) + "; expected 0");
  }
  LoadOptions out{.width = o.width, .height = o.height};
  if (o.frame != -1) out.frame = o.frame;
  if (o.shadow != nullptr) out.shadow = shadow_from(o.shadow, what + ".shadow");
  return out;
}

static_assert(BS_TEXEL_DEPTH + 1 == enum_names<TexelFormat>.size() &&
              BS_TEXEL_DXT1 == static_cast<int>(TexelFormat::dxt1));

std::vector<std::uint8_t> decoded(const Texture& t) {
  std::vector<std::uint8_t> out;
  for (std::int64_t j = 0; j < t.height; ++j) {
    for (std::int64_t i = 0; i < t.width; ++i) {
      const model::TexelCodes texel = model::texel_of(t, i, j);
      out.insert(out.end(), texel.begin(), texel.end());
    }
  }
  return out;
}

std::shared_ptr<SceneState> described(Scene scene) {
  auto state = std::make_shared<SceneState>();
  state->scene = std::move(scene);
  for (const Texture& t : state->scene.textures) {
    bs_texture out = BS_TEXTURE_INIT;
    out.width = t.width;
    out.height = t.height;
    out.rgba = t.rgba.data();
    out.name = t.name.c_str();
    if (t.format != TexelFormat::rgba8888) {
      out.rgba = state->decoded.emplace_back(decoded(t)).data();
      out.format = static_cast<bs_texel_format>(t.format);
      out.raw = t.raw.data();
      out.raw_size = t.raw.size();
      out.table = t.table.empty() ? nullptr : t.table.data();
      out.table_size = t.table.size();
    }
    state->textures.push_back(out);
  }
  for (const Triangle& triangle : state->scene.triangles) {
    for (const Vertex& v : triangle.v) {
      state->vertices.push_back({sizeof(bs_vertex),
                                 v.x,
                                 v.y,
                                 v.s,
                                 v.u,
                                 v.v,
                                 v.c[0],
                                 v.c[1],
                                 v.c[2],
                                 v.c[3],
                                 v.fog,
                                 v.project_x,
                                 v.project_y,
                                 v.project_w,
                                 v.z,
                                 v.u2,
                                 v.v2,
                                 v.nx,
                                 v.ny,
                                 v.nz,
                                 v.lx,
                                 v.ly,
                                 v.lz});
    }
    state->texture_of.push_back(triangle.texture);
  }
  return state;
}

bs_scene_desc describe(const SceneState& state) {
  const Scene& scene = state.scene;
  bs_scene_desc out = BS_SCENE_DESC_INIT;
  out.width = scene.width;
  out.height = scene.height;
  out.s_min = scene.s_min;
  out.s_max = scene.s_max;
  out.focal = scene.focal;
  std::copy(scene.background.begin(), scene.background.end(), out.background);
  if (scene.fog) {
    out.has_fog = 1;
    std::copy(scene.fog->color.begin(), scene.fog->color.end(), out.fog_color);
    out.fog_distance = scene.fog->distance;
  }
  if (scene.projector) {
    out.has_projector = 1;
    out.projector_s_min = scene.projector->s_min;
    out.projector_s_max = scene.projector->s_max;
  }
  if (scene.light) {
    out.light_kind = scene.light->is_point ? 2 : 1;
    out.light_exponent = scene.light->exponent;
    std::ranges::copy(scene.light->place, out.light);
    out.light_ambient = scene.light->ambient;
    out.light_specular = scene.light->specular;
    out.light_lunar = scene.light->lunar;
    out.light_reach = scene.light->reach;
    out.light_offset = scene.light->offset;
  }
  out.textures = state.textures.data();
  out.texture_count = state.textures.size();
  out.name = scene.name.c_str();
  return out;
}

// Of another format than rgba8888.
Texture formatted_from(const bs_texture& t, const std::string& what) {
  const auto formats = static_cast<std::int32_t>(enum_names<TexelFormat>.size());
  if (t.format < 0 || t.format >= formats || t.reserved != 0) {
    fail(BS_BAD_INPUT, what + ".format, .reserved: " + std::to_string(t.format) + ", " +
                           std::to_string(t.reserved) + "; expected 0.." + std::to_string(formats - 1) +
                           ", and 0");
  }
  Texture out;
  out.name = t.name == nullptr ? what : t.name;
  out.width = t.width;
  out.height = t.height;
  out.format = static_cast<TexelFormat>(t.format);
  const std::size_t size = raw_size(out.format, out.width, out.height);
  const auto table_size = static_cast<std::size_t>(texel_layout(out.format).table_size);
  if (t.raw_size != size || t.table_size != table_size) {
    fail(BS_BAD_INPUT, what + ".raw_size, .table_size: " + std::to_string(t.raw_size) + ", " +
                           std::to_string(t.table_size) + "; expected " + std::to_string(size) + ", " +
                           std::to_string(table_size) + " for " + std::string(to_string(out.format)));
  }
  if (size != 0) {
    need(t.raw, (what + ".raw").c_str());
    out.raw.assign(t.raw, t.raw + size);
  }
  if (table_size != 0) {
    need(t.table, (what + ".table").c_str());
    out.table.assign(t.table, t.table + table_size);
    if (is_procedural(out.format)) {
      if (const std::string wrong = procedural_fault(out); !wrong.empty()) {
        fail(BS_BAD_INPUT, what + ".table: " + wrong);
      }
      return out;
    }
    const bool is_palette = table_size == palette_size;
    for (std::size_t k = 0; k < table_size; ++k) {
      const int low = is_palette || k < 16 ? 0 : -256;
      if (out.table[k] < low || out.table[k] > 255) {
        fail(BS_BAD_INPUT, what + ".table: value " + std::to_string(k) + " is " +
                               std::to_string(out.table[k]) + "; expected " + std::to_string(low) + "..255");
      }
    }
  }
  return out;
}

Texture texture_from(const bs_texture& t, const std::string& what) {
  if (t.width < 1 || t.height < 1 || t.width > texture_size_limit || t.height > texture_size_limit) {
    fail(BS_BAD_INPUT, what + ": " + std::to_string(t.width) + "x" + std::to_string(t.height) +
                           " is out of range; expected 1.." + std::to_string(texture_size_limit) + " texels");
  }
  if (t.format != BS_TEXEL_RGBA8888) return formatted_from(t, what);
  need(t.rgba, (what + ".rgba").c_str());
  const std::size_t row = 4 * static_cast<std::size_t>(t.width);
  const std::size_t stride = t.stride == 0 ? row : t.stride;
  if (stride < row) {
    fail(BS_BAD_INPUT,
         what + ".stride: " + std::to_string(stride) + "; expected at least " + std::to_string(row));
  }
  Texture out;
  out.name = t.name == nullptr ? what : t.name;
  out.width = t.width;
  out.height = t.height;
  out.rgba.reserve(row * static_cast<std::size_t>(t.height));
  for (std::size_t y = 0; y < static_cast<std::size_t>(t.height); ++y) {
    out.rgba.insert(out.rgba.end(), t.rgba + y * stride, t.rgba + y * stride + row);
  }
  return out;
}

}  // namespace

Scene scene_from(const bs_scene_desc* from) {
  const std::string what = "bs_begin: scene";
  need(from, what.c_str());
  const auto d = read_struct(from, bs_scene_desc BS_SCENE_DESC_INIT, BITSPAN_THROUGH(bs_scene_desc, height),
                             [&] { return std::string(what); });
  if (d.has_fog > 1 || d.reserved != 0) {
    fail(BS_BAD_INPUT, what + ".has_fog, .reserved: " + std::to_string(d.has_fog) + ", " +
                           std::to_string(d.reserved) + "; expected 0 or 1, and 0");
  }
  if (d.has_projector < 0 || d.has_projector > 1 || d.reserved_2 != 0) {
    fail(BS_BAD_INPUT, what + ".has_projector, .reserved_2: " + std::to_string(d.has_projector) + ", " +
                           std::to_string(d.reserved_2) + "; expected 0 or 1, and 0");
  }
  Scene scene;
  scene.name = d.name == nullptr ? "scene" : d.name;
  scene.width = d.width;
  scene.height = d.height;
  scene.s_min = d.s_min;
  scene.s_max = d.s_max;
  scene.focal = d.focal;
  std::copy(std::begin(d.background), std::end(d.background), scene.background.begin());
  if (d.has_fog == 1) {
    scene.fog.emplace();
    std::copy(std::begin(d.fog_color), std::end(d.fog_color), scene.fog->color.begin());
    scene.fog->distance = d.fog_distance;
  }
  if (d.has_projector == 1) scene.projector = {d.projector_s_min, d.projector_s_max};
  if (d.light_kind < 0 || d.light_kind > 2) {
    fail(BS_BAD_INPUT, what + ".light_kind: " + std::to_string(d.light_kind) + "; expected 0, 1 or 2");
  }
  if (d.light_kind != 0) {
    scene.light = Light{.is_point = d.light_kind == 2,
                        .place = {d.light[0], d.light[1], d.light[2]},
                        .ambient = d.light_ambient,
                        .specular = d.light_specular,
                        .exponent = d.light_exponent,
                        .lunar = d.light_lunar,
                        .reach = d.light_reach,
                        .offset = d.light_offset};
  }
  check_scene(scene, what);
  if (d.texture_count != 0) need(d.textures, (what + ".textures").c_str());
  if (d.texture_count > texture_count_limit) {
    fail(BS_BAD_INPUT, what + ".texture_count: " + std::to_string(d.texture_count) + "; expected at most " +
                           std::to_string(texture_count_limit));
  }
  for (std::size_t i = 0; i < d.texture_count; ++i) {
    const auto t =
        read_element(d.textures, i, bs_texture{}, BITSPAN_THROUGH(bs_texture, rgba), what + ".textures");
    scene.textures.push_back(texture_from(t, what + ".textures[" + std::to_string(i) + "]"));
  }
  model::check_scene(scene);
  return scene;
}

Triangle triangle_from(const bs_vertex* vertices, std::size_t i, std::int32_t texture, const Scene& scene,
                       const View& view, std::int64_t index, const char* function) {
  const std::string what = std::string(function) + ": v";
  Triangle out;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto v =
        read_element(vertices, 3 * i + corner, bs_vertex BS_VERTEX_INIT, BITSPAN_THROUGH(bs_vertex, s), what);
    for (const double at : {v.x, v.y}) {
      if (!(std::fabs(at) <= coordinate_limit)) {
        fail(BS_BAD_INPUT, what + "[" + std::to_string(3 * i + corner) + "]: x or y is " +
                               std::to_string(at) + "; expected " +
                               std::to_string(static_cast<int>(-coordinate_limit)) + " to " +
                               std::to_string(static_cast<int>(coordinate_limit)));
      }
    }
    out.v[corner] = {{v.x, v.y, v.s},
                     {v.u,
                      v.v,
                      {v.r, v.g, v.b, v.a},
                      v.fog,
                      v.project_x,
                      v.project_y,
                      v.project_w,
                      v.z,
                      v.u2,
                      v.v2,
                      v.nx,
                      v.ny,
                      v.nz,
                      v.lx,
                      v.ly,
                      v.lz}};
  }
  check_texture(scene, texture, function);
  out.texture = texture;
  model::check_triangle(view, scene.textures.size(), out, index);
  return out;
}

void check_texture(const Scene& scene, std::int32_t texture, const char* function) {
  if (texture >= -1 && texture < static_cast<std::int64_t>(scene.textures.size())) return;
  fail(BS_BAD_INPUT, std::string(function) + ": texture: " + std::to_string(texture) +
                         " is none of the scene's; expected -1 to " +
                         std::to_string(static_cast<std::int64_t>(scene.textures.size()) - 1));
}

std::shared_ptr<const Scene> scene_of(const bs_scene* scene, const char* function) {
  const std::shared_ptr<SceneState> state = scenes().find(scene, function);
  return {state, &state->scene};
}

}  // namespace bitspan::capi

using namespace bitspan;
using namespace bitspan::capi;

namespace {
// options() gives the options, and may throw.
template <class Options>
bs_status load_as(const std::string& function, const char* name_or_path, const Options& options,
                  bs_scene** out) {
  return call([&] {
    need(name_or_path, (function + ": name_or_path").c_str());
    need(out, (function + ": out").c_str());
    std::string notes;
    const auto state = described(load(name_or_path, options(), function, notes));
    state->notes = std::move(notes);
    *out = scenes().add(state);
  });
}
}  // namespace

bs_status bs_scene_load(const char* name_or_path, int32_t width, int32_t height, bs_scene** out) {
  return load_as(
      "bs_scene_load", name_or_path,
      [&] {
        return LoadOptions{width, height};
      },
      out);
}

bs_status bs_scene_load_frame(const char* name_or_path, int32_t width, int32_t height, int32_t frame,
                              bs_scene** out) {
  return load_as(
      "bs_scene_load_frame", name_or_path,
      [&] {
        return LoadOptions{width, height, frame};
      },
      out);
}

bs_status bs_scene_load_with(const char* name_or_path, const bs_scene_options* options, bs_scene** out) {
  const char* const function = "bs_scene_load_with";
  return load_as(
      function, name_or_path, [&] { return options_from(options, function); }, out);
}

bs_status bs_scene_get(bs_scene* scene, bs_scene_desc* out) {
  return call([&] {
    const auto state = scenes().find(scene, "bs_scene_get");
    write_struct(out, describe(*state), BITSPAN_THROUGH(bs_scene_desc, height), "bs_scene_get: out");
  });
}

bs_status bs_scene_triangles(bs_scene* scene, const bs_vertex** vertices, const int32_t** textures,
                             size_t* count) {
  return call([&] {
    const auto state = scenes().find(scene, "bs_scene_triangles");
    need(vertices, "bs_scene_triangles: vertices");
    need(textures, "bs_scene_triangles: textures");
    need(count, "bs_scene_triangles: count");
    if (std::ranges::any_of(state->scene.triangles, &Triangle::is_line)) {
      fail(BS_BAD_INPUT,
           "bs_scene_triangles: the scene has lines; expected triangles alone, or bs_draw_scene");
    }
    *vertices = state->vertices.data();
    *textures = state->texture_of.data();
    *count = state->texture_of.size();
  });
}

const char* bs_scene_notes(bs_scene* scene) {
  return call_or<const char*>(nullptr, [&] { return scenes().find(scene, "bs_scene_notes")->notes.c_str(); });
}

void bs_scene_free(bs_scene* scene) { scenes().remove(scene); }
