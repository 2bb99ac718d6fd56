// SPDX-License-Identifier: Apache-2.0
// What the files of the module share: the handles of the C interface as objects, and its failures as
// exceptions.
//
// InputError of config/config.hpp becomes bitspan.InputError, and StateError becomes bitspan.StateError.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "bitspan/bitspan.h"
#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan::python {

namespace nb = nanobind;

// A call in the wrong order, on a closed model, or on one that is in use.
struct StateError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Throws what a status stands for, with the text of bs_last_error().
void check(bs_status status);

// Owns a handle of the C interface.
template <class Handle, void (*close)(Handle*)>
class Owned {
 public:
  Owned() = default;
  Owned(Owned&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  ~Owned() {
    if (handle_ != nullptr) close(handle_);
  }
  Handle* get() const { return handle_; }
  Handle** out() { return &handle_; }

 private:
  Handle* handle_ = nullptr;
};

// A configuration. It never changes: with() makes another one.
class ConfigHandle {
 public:
  static ConfigHandle load(const std::string& name_or_path);
  static ConfigHandle parse(const std::string& toml);
  ConfigHandle with(const std::vector<std::pair<std::string, std::string>>& settings) const;
  bs_config* get() const { return config_.get(); }
  Config full() const;

 private:
  Owned<bs_config, bs_config_free> config_;
};

// A stage's number by its name. Throws InputError that lists all names.
bs_stage stage_of(const std::string& name);

using Numbers = nb::ndarray<const double, nb::device::cpu>;
// Of a texture of another format than rgba8888: format, width, height, bytes, table.
using Formatted = std::tuple<std::int32_t, std::int32_t, std::int32_t, nb::bytes, std::vector<std::int16_t>>;
using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::int32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<const std::int64_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Row = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// Of a light: where it stands, what it looks at, degrees, size of the map, bias, dark; as in bs_shadow.
using Shadow = std::tuple<std::array<double, 3>, std::optional<std::array<double, 3>>, double, std::int32_t,
                          double, double>;

// A scene that the library has read, or one made of arrays.
class SceneHandle {
 public:
  static SceneHandle load(const std::string& name_or_path, std::int32_t width, std::int32_t height,
                          std::optional<std::int32_t> frame, const std::optional<Shadow>& shadow);
  // vertices: (n, 3, 22), the members of bs_vertex in their order.
  // texture_of: (n).
  static SceneHandle make(
      const nb::ndarray<const double, nb::ndim<3>, nb::c_contig, nb::device::cpu>& vertices,
      const Indices& texture_of, const std::vector<std::variant<Bytes, Formatted>>& textures,
      const bs_scene_desc& desc, std::string name);
  const bs_scene_desc& desc() const { return desc_; }
  const bs_vertex* vertices() const { return vertices_; }
  const std::int32_t* texture_of() const { return texture_of_; }
  std::size_t count() const { return count_; }
  // What of a mesh file is not shown, a line each.
  std::string notes() const { return scene_.get() == nullptr ? "" : bs_scene_notes(scene_.get()); }
  // Draws triangles at..at + n, with the commands of a scene that the library read.
  bs_status draw(bs_model* model, std::size_t at, std::size_t n, std::uint64_t frame,
                 std::uint64_t draw) const;
  // The scene as the engines get it, with its triangles.
  Scene full() const;

 private:
  Owned<bs_scene, bs_scene_free> scene_;
  // Of a scene made of arrays.
  std::unique_ptr<std::string> name_;
  std::vector<std::vector<std::uint8_t>> texels_;
  std::vector<std::vector<std::int16_t>> tables_;
  std::vector<bs_texture> own_textures_;
  std::vector<bs_vertex> own_vertices_;
  std::vector<std::int32_t> own_texture_of_;

  bs_scene_desc desc_ = BS_SCENE_DESC_INIT;
  const bs_vertex* vertices_ = nullptr;
  const std::int32_t* texture_of_ = nullptr;
  std::size_t count_ = 0;
};

void bind_config(nb::module_& m);
void bind_scene(nb::module_& m);
void bind_model(nb::module_& m);
void bind_errors(nb::module_& m);
void bind_costs(nb::module_& m);
void bind_search(nb::module_& m);

}  // namespace bitspan::python
