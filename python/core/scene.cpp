// SPDX-License-Identifier: Apache-2.0
#include "lib/scene.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <string>

#include "lib/status.hpp"
#include "python/core/core.hpp"

namespace bitspan::python {
namespace {

constexpr std::size_t columns = 22;  // those of VERTEX in _scene.py
static_assert(sizeof(bs_vertex) == sizeof(std::size_t) + columns * sizeof(double));

using Rgb = std::array<std::uint8_t, 3>;

SceneHandle make(
    const nb::ndarray<const double, nb::ndim<3>, nb::c_contig, nb::device::cpu>& vertices,
    const Indices& texture_of, const std::vector<std::variant<Bytes, Formatted>>& textures,
    std::int32_t width, std::int32_t height, const std::pair<double, double>& s_range, double focal,
    const Rgb& background, const std::optional<std::pair<Rgb, double>>& fog,
    const std::optional<std::pair<double, double>>& projector,
    const std::optional<std::tuple<int, std::array<double, 3>, std::array<double, 5>, int>>& light,
    std::string name) {
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  desc.width = width;
  desc.height = height;
  desc.s_min = s_range.first;
  desc.s_max = s_range.second;
  desc.focal = focal;
  std::ranges::copy(background, desc.background);
  if (fog) {
    desc.has_fog = 1;
    std::ranges::copy(fog->first, desc.fog_color);
    desc.fog_distance = fog->second;
  }
  if (projector) {
    desc.has_projector = 1;
    desc.projector_s_min = projector->first;
    desc.projector_s_max = projector->second;
  }
  if (light) {
    const auto& [kind, place, numbers, exponent] = *light;
    desc.light_kind = kind;
    desc.light_exponent = exponent;
    std::ranges::copy(place, desc.light);
    desc.light_ambient = numbers[0];
    desc.light_specular = numbers[1];
    desc.light_lunar = numbers[2];
    desc.light_reach = numbers[3];
    desc.light_offset = numbers[4];
  }
  return SceneHandle::make(vertices, texture_of, textures, desc, std::move(name));
}

// The vertices where the library has them: behind the size that each struct begins with.
nb::object vertices_of(nb::handle self) {
  const auto& scene = nb::cast<const SceneHandle&>(self);
  static const double none = 0;
  const bool empty = scene.count() == 0;
  constexpr auto vertex = static_cast<std::int64_t>(sizeof(bs_vertex) / sizeof(double));
  return nb::cast(nb::ndarray<nb::numpy, nb::ro, const double, nb::ndim<3>>(
      empty ? &none : &scene.vertices()->x, {scene.count(), 3, columns}, self, {3 * vertex, vertex, 1}));
}

nb::object texture_of(nb::handle self) {
  const auto& scene = nb::cast<const SceneHandle&>(self);
  static const std::int32_t none = 0;
  return nb::cast(nb::ndarray<nb::numpy, nb::ro, const std::int32_t, nb::ndim<1>>(
      scene.count() == 0 ? &none : scene.texture_of(), {scene.count()}, self));
}

}  // namespace

SceneHandle SceneHandle::load(const std::string& name_or_path, std::int32_t width, std::int32_t height,
                              std::optional<std::int32_t> frame, const std::optional<Shadow>& shadow) {
  bs_scene_options options = BS_SCENE_OPTIONS_INIT;
  options.width = width;
  options.height = height;
  if (frame) {
    if (*frame < 0) throw InputError("frame: " + std::to_string(*frame) + "; expected an image from 0");
    options.frame = *frame;
  }
  bs_shadow cast = BS_SHADOW_INIT;
  if (shadow) {
    const auto& [light, at, degrees, map_size, bias, dark] = *shadow;
    std::ranges::copy(light, cast.light);
    if (at) {
      cast.has_at = 1;
      std::ranges::copy(*at, cast.at);
    }
    cast.degrees = degrees;
    cast.map_size = map_size;
    cast.bias = bias;
    cast.dark = dark;
    options.shadow = &cast;
  }
  SceneHandle out;
  check(bs_scene_load_with(name_or_path.c_str(), &options, out.scene_.out()));
  check(bs_scene_get(out.scene_.get(), &out.desc_));
  check(bs_scene_triangles(out.scene_.get(), &out.vertices_, &out.texture_of_, &out.count_));
  return out;
}

SceneHandle SceneHandle::make(
    const nb::ndarray<const double, nb::ndim<3>, nb::c_contig, nb::device::cpu>& vertices,
    const Indices& texture_of, const std::vector<std::variant<Bytes, Formatted>>& textures,
    const bs_scene_desc& desc, std::string name) {
  if (vertices.shape(1) != 3 || vertices.shape(2) != columns || texture_of.shape(0) != vertices.shape(0)) {
    throw InputError("vertices, texture_of: are not of one length; expected (n, 3, 16) and (n)");
  }
  SceneHandle out;
  out.desc_ = desc;
  out.name_ = std::make_unique<std::string>(std::move(name));
  out.desc_.name = out.name_->c_str();
  const double* from = vertices.data();
  for (std::size_t i = 0; i < 3 * vertices.shape(0); ++i, from += columns) {
    bs_vertex vertex = BS_VERTEX_INIT;
    std::memcpy(reinterpret_cast<char*>(&vertex) + offsetof(bs_vertex, x), from, columns * sizeof(double));
    out.own_vertices_.push_back(vertex);
  }
  out.own_texture_of_.assign(texture_of.data(), texture_of.data() + texture_of.shape(0));
  for (const auto& given : textures) {
    bs_texture& texture = out.own_textures_.emplace_back(bs_texture BS_TEXTURE_INIT);
    if (const auto* formatted = std::get_if<Formatted>(&given)) {
      const auto& [format, width, height, raw, table] = *formatted;
      const auto* const bytes = static_cast<const std::uint8_t*>(raw.data());
      texture.format = format;
      texture.width = width;
      texture.height = height;
      texture.raw = out.texels_.emplace_back(bytes, bytes + raw.size()).data();
      texture.raw_size = raw.size();
      texture.table = out.tables_.emplace_back(table).data();
      texture.table_size = table.size();
      continue;
    }
    const auto& t = std::get<Bytes>(given);
    if (t.shape(2) != 4) throw InputError("textures: has no four channels; expected (height, width, 4)");
    texture.width = static_cast<std::int32_t>(t.shape(1));
    texture.height = static_cast<std::int32_t>(t.shape(0));
    texture.rgba = out.texels_.emplace_back(t.data(), t.data() + t.size()).data();
  }
  out.desc_.textures = out.own_textures_.data();
  out.desc_.texture_count = out.own_textures_.size();
  out.vertices_ = out.own_vertices_.data();
  out.texture_of_ = out.own_texture_of_.data();
  out.count_ = out.own_texture_of_.size();
  static_cast<void>(out.full());  // throws where something is not legal
  return out;
}

bs_status SceneHandle::draw(bs_model* model, std::size_t at, std::size_t n, std::uint64_t frame,
                            std::uint64_t draw) const {
  return scene_.get() != nullptr ? bs_draw_scene(model, scene_.get(), at, n, frame, draw)
                                 : bs_draw(model, vertices_ + 3 * at, texture_of_ + at, n, frame, draw);
}

Scene SceneHandle::full() const {
  try {
    if (scene_.get() != nullptr) return *capi::scene_of(scene_.get(), "bitspan.Scene");
    Scene out = capi::scene_from(&desc_);
    out.triangles.reserve(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      out.triangles.push_back(capi::triangle_from(vertices_, i, texture_of_[i], out, out,
                                                  static_cast<std::int64_t>(i), "bitspan.Scene"));
    }
    return out;
  } catch (const capi::Failure& failure) {
    throw InputError(failure.text);
  }
}

void bind_scene(nb::module_& m) {
  nb::list formats;
  for (const std::string_view name : enum_names<TexelFormat>)
    formats.append(nb::str(name.data(), name.size()));
  m.attr("texel_formats") = nb::tuple(formats);
  nb::class_<SceneHandle>(m, "SceneHandle")
      .def_static("load", &SceneHandle::load, nb::arg("name_or_path"), nb::arg("width"), nb::arg("height"),
                  nb::arg("frame").none(), nb::arg("shadow").none(), nb::call_guard<nb::gil_scoped_release>())
      .def_static("make", &make, nb::arg("vertices"), nb::arg("texture_of"), nb::arg("textures"),
                  nb::arg("width"), nb::arg("height"), nb::arg("s_range"), nb::arg("focal"),
                  nb::arg("background"), nb::arg("fog").none(), nb::arg("projector").none(),
                  nb::arg("light").none(), nb::arg("name"))
      .def_prop_ro("name", [](const SceneHandle& s) { return std::string(s.desc().name); })
      .def_prop_ro("width", [](const SceneHandle& s) { return s.desc().width; })
      .def_prop_ro("height", [](const SceneHandle& s) { return s.desc().height; })
      .def_prop_ro("s_range", [](const SceneHandle& s) { return std::pair(s.desc().s_min, s.desc().s_max); })
      .def_prop_ro("notes", &SceneHandle::notes)
      .def_prop_ro("texture_count", [](const SceneHandle& s) { return s.desc().texture_count; })
      .def_prop_ro("vertices", &vertices_of,
                   nb::sig("def vertices(self) -> numpy.typing.NDArray[numpy.float64]"))
      .def_prop_ro("texture_of", &texture_of,
                   nb::sig("def texture_of(self) -> numpy.typing.NDArray[numpy.int32]"));
}

}  // namespace bitspan::python
