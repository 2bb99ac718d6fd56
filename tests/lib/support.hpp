// SPDX-License-Identifier: Apache-2.0
// Handles that close themselves, and scenes as the interface takes them.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bitspan/bitspan.h"
#include "scene/scene.hpp"

namespace bitspan {

struct CloseHandle {
  void operator()(bs_config* c) const { bs_config_free(c); }
  void operator()(bs_scene* s) const { bs_scene_free(s); }
  void operator()(bs_model* m) const { bs_close(m); }
};
using ConfigHandle = std::unique_ptr<bs_config, CloseHandle>;
using ModelHandle = std::unique_ptr<bs_model, CloseHandle>;

inline ConfigHandle config_handle(const std::string& name, const std::string& mode = "") {
  bs_config* config = nullptr;
  EXPECT_EQ(bs_config_load(name.c_str(), &config), BS_OK) << bs_last_error();
  if (!mode.empty()) {
    EXPECT_EQ(bs_config_set(config, "perspective.mode", mode.c_str()), BS_OK) << bs_last_error();
  }
  return ConfigHandle(config);
}
inline ModelHandle open_model(bs_config* config, const std::string& engine) {
  bs_model* model = nullptr;
  EXPECT_EQ(bs_open(config, engine.c_str(), &model), BS_OK) << bs_last_error();
  return ModelHandle(model);
}

// A scene's description; the scene must outlive it.
struct Described {
  explicit Described(const Scene& s) {
    for (const Texture& t : s.textures) {
      bs_texture& out = textures.emplace_back(bs_texture BS_TEXTURE_INIT);
      out.width = t.width;
      out.height = t.height;
      out.rgba = t.rgba.data();
      out.name = t.name.c_str();
      if (t.format == TexelFormat::rgba8888) continue;
      out.format = static_cast<bs_texel_format>(t.format);
      out.raw = t.raw.data();
      out.raw_size = t.raw.size();
      out.table = t.table.data();
      out.table_size = t.table.size();
    }
    for (const Triangle& t : s.triangles) {
      for (const Vertex& v : t.v) {
        vertices.push_back({sizeof(bs_vertex),
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
      texture_of.push_back(t.texture);
    }
    desc.width = s.width;
    desc.height = s.height;
    desc.s_min = s.s_min;
    desc.s_max = s.s_max;
    desc.focal = s.focal;
    for (std::size_t i = 0; i < 3; ++i) desc.background[i] = s.background[i];
    if (s.fog) {
      desc.has_fog = 1;
      for (std::size_t i = 0; i < 3; ++i) desc.fog_color[i] = s.fog->color[i];
      desc.fog_distance = s.fog->distance;
    }
    if (s.projector) {
      desc.has_projector = 1;
      desc.projector_s_min = s.projector->s_min;
      desc.projector_s_max = s.projector->s_max;
    }
    if (s.light) {
      desc.light_kind = s.light->is_point ? 2 : 1;
      desc.light_exponent = s.light->exponent;
      for (std::size_t i = 0; i < 3; ++i) desc.light[i] = s.light->place[i];
      desc.light_ambient = s.light->ambient;
      desc.light_specular = s.light->specular;
      desc.light_lunar = s.light->lunar;
      desc.light_reach = s.light->reach;
      desc.light_offset = s.light->offset;
    }
    desc.textures = textures.data();
    desc.texture_count = textures.size();
    desc.name = s.name.c_str();
  }
  Described(const Described&) = delete;
  Described& operator=(const Described&) = delete;

  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  std::vector<bs_texture> textures;
  std::vector<bs_vertex> vertices;
  std::vector<std::int32_t> texture_of;
};

inline void draw(bs_model* model, const Described& scene) {
  ASSERT_EQ(bs_begin(model, &scene.desc), BS_OK) << bs_last_error();
  ASSERT_EQ(bs_draw(model, scene.vertices.data(), scene.texture_of.data(), scene.texture_of.size(), 0, 0),
            BS_OK)
      << bs_last_error();
}

inline bs_view records_view(bs_model* model, bs_stage stage) {
  bs_view view{};
  view.size = sizeof view;
  EXPECT_EQ(bs_records(model, stage, &view), BS_OK) << bs_last_error();
  return view;
}
inline std::vector<std::int64_t> records(bs_model* model, bs_stage stage) {
  const bs_view view = records_view(model, stage);
  const auto* const values = static_cast<const std::int64_t*>(view.base);
  return {values, values + view.rows * view.columns};
}
template <class T>
std::vector<T> plane(bs_model* model, bs_plane which) {
  bs_view view{};
  view.size = sizeof view;
  EXPECT_EQ(bs_frame_view(model, which, &view), BS_OK) << bs_last_error();
  const auto* const values = static_cast<const T*>(view.base);
  EXPECT_EQ(view.stride, view.columns * static_cast<std::size_t>(view.channels) * sizeof(T));
  return {values, values + view.rows * view.columns * static_cast<std::size_t>(view.channels)};
}

}  // namespace bitspan
