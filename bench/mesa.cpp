// SPDX-License-Identifier: Apache-2.0
#include "bench/mesa.hpp"

// OpenGL's prototypes beyond 1.1 are exported by libOSMesa itself.
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "model/mip_chain.hpp"
#include "model/stages/texel.hpp"

namespace bitspan::bench {
namespace {

struct GlVertex {
  std::array<float, 3> position;  // in the eye's space: w of the clip space becomes s
  std::array<std::uint8_t, 4> color;
  std::array<float, 2> texel;  // 0..1 across the texture
};
static_assert(sizeof(GlVertex) == 24);

// Consecutive triangles with one texture.
struct Batch {
  int texture = -1;
  GLint first = 0;
  GLsizei count = 0;
};

GlVertex convert(const Vertex& v, const Scene& scene, const Texture* texture) {
  GlVertex out{};
  out.position = {static_cast<float>((2 * v.x / scene.width - 1) * v.s),
                  static_cast<float>((1 - 2 * v.y / scene.height) * v.s), static_cast<float>(-v.s)};
  for (std::size_t c = 0; c < 4; ++c) {
    out.color[c] = static_cast<std::uint8_t>(std::lround(255 * v.c[c]));
  }
  if (texture != nullptr) {
    out.texel = {static_cast<float>(v.u / texture->width), static_cast<float>(v.v / texture->height)};
  }
  return out;
}

// A place in the bound vertex buffer, as OpenGL takes it.
const void* offset(std::size_t bytes) { return std::bit_cast<const void*>(bytes); }

// x and y are divided by s as they are; z: 1 at s_min becomes -1, s_max 1.
void set_projection(const Scene& scene) {
  const double range = scene.s_max - scene.s_min;
  std::array<GLdouble, 16> m{};  // by columns
  m[0] = 1;
  m[5] = 1;
  m[10] = -(scene.s_max + scene.s_min) / range;
  m[11] = -1;
  m[14] = -2 * scene.s_max * scene.s_min / range;
  glMatrixMode(GL_PROJECTION);
  glLoadMatrixd(m.data());
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
}

void set_fog(const Fog& fog) {
  std::array<GLfloat, 4> color{0, 0, 0, 1};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] = static_cast<float>(fog.color[c]) / 255;
  }
  glFogi(GL_FOG_MODE, GL_EXP);
  glFogf(GL_FOG_DENSITY, static_cast<float>(1 / fog.distance));
  glFogfv(GL_FOG_COLOR, color.data());
  glEnable(GL_FOG);
}

// The texels, those of the reserved colour with alpha 0.
std::vector<std::uint8_t> with_holes(const Texture& t, bool& holes) {
  std::vector<std::uint8_t> rgba;
  for (std::int64_t j = 0; j < t.height; ++j) {
    for (std::int64_t i = 0; i < t.width; ++i) {
      const model::TexelCodes texel = model::texel_of(t, i, j);
      rgba.insert(rgba.end(), texel.begin(), texel.end());
    }
  }
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    if (rgba[i] == 255 && rgba[i + 1] == 0 && rgba[i + 2] == 255) {
      rgba[i + 3] = 0;
      holes = true;
    }
  }
  return rgba;
}

GLint minification(TextureFilter filter, MipMode mip) {
  const bool nearest = filter == TextureFilter::nearest;
  switch (mip) {
    case MipMode::none:
      return nearest ? GL_NEAREST : GL_LINEAR;
    case MipMode::nearest:
      return nearest ? GL_NEAREST_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_NEAREST;
    case MipMode::linear:
      return nearest ? GL_NEAREST_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_LINEAR;
  }
  return GL_NEAREST;
}

bool translucent(const Scene& scene) {
  const auto vertex = [](const Vertex& v) { return v.c[3] < 1; };
  return std::ranges::any_of(scene.triangles,
                             [&](const Triangle& t) { return std::ranges::any_of(t.v, vertex); });
}

}  // namespace

struct Mesa::State {
  OSMesaContext context = nullptr;
  std::vector<std::uint8_t> picture;
  std::vector<GLuint> textures;
  std::vector<Batch> batches;
  GLuint buffer = 0;

  ~State() {
    if (context != nullptr) {
      OSMesaDestroyContext(context);
    }
  }
};

Mesa::Mesa(const Scene& scene, TextureFilter filter, int depth_bits, MipMode mip)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.context = OSMesaCreateContextExt(OSMESA_RGBA, depth_bits, 0, 0, nullptr);
  s.picture.resize(4 * static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height));
  if (s.context == nullptr || OSMesaMakeCurrent(s.context, s.picture.data(), GL_UNSIGNED_BYTE, scene.width,
                                                scene.height) == GL_FALSE) {
    throw InputError("Mesa: no off-screen context of " + std::to_string(scene.width) + "x" +
                     std::to_string(scene.height) + " with " + std::to_string(depth_bits) + " bits of depth");
  }
  OSMesaPixelStore(OSMESA_Y_UP, 0);
  glViewport(0, 0, scene.width, scene.height);
  set_projection(scene);

  bool holes = false;
  const GLint mode = filter == TextureFilter::nearest ? GL_NEAREST : GL_LINEAR;
  s.textures.resize(scene.textures.size());
  glGenTextures(static_cast<GLsizei>(s.textures.size()), s.textures.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (std::size_t i = 0; i < s.textures.size(); ++i) {
    const Texture& t = scene.textures[i];
    glBindTexture(GL_TEXTURE_2D, s.textures[i]);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, minification(filter, mip));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, mode);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    const model::MipChain levels = mip == MipMode::none ? model::MipChain{t} : model::make_mip_chain(t);
    for (std::size_t level = 0; level < levels.size(); ++level) {
      const Texture& image = levels[level];
      glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA8, image.width, image.height, 0, GL_RGBA,
                   GL_UNSIGNED_BYTE, with_holes(image, holes).data());
    }
  }
  glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);

  std::vector<GlVertex> vertices;
  vertices.reserve(3 * scene.triangles.size());
  for (const Triangle& t : scene.triangles) {
    if (s.batches.empty() || s.batches.back().texture != t.texture) {
      s.batches.push_back({t.texture, static_cast<GLint>(vertices.size()), 0});
    }
    s.batches.back().count += 3;
    const Texture* texture = t.texture < 0 ? nullptr : &scene.textures[static_cast<std::size_t>(t.texture)];
    for (const Vertex& v : t.v) {
      vertices.push_back(convert(v, scene, texture));
    }
  }
  glGenBuffers(1, &s.buffer);
  glBindBuffer(GL_ARRAY_BUFFER, s.buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(GlVertex)), vertices.data(),
               GL_STATIC_DRAW);
  glVertexPointer(3, GL_FLOAT, sizeof(GlVertex), offset(offsetof(GlVertex, position)));
  glColorPointer(4, GL_UNSIGNED_BYTE, sizeof(GlVertex), offset(offsetof(GlVertex, color)));
  glTexCoordPointer(2, GL_FLOAT, sizeof(GlVertex), offset(offsetof(GlVertex, texel)));
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
  glEnableClientState(GL_TEXTURE_COORD_ARRAY);

  glDisable(GL_CULL_FACE);
  glDisable(GL_DITHER);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  if (holes) {
    glAlphaFunc(GL_GREATER, 0);
    glEnable(GL_ALPHA_TEST);
  }
  if (translucent(scene)) {
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_BLEND);
  }
  if (scene.fog) {
    set_fog(*scene.fog);
  }
  glClearColor(static_cast<float>(scene.background[0]) / 255, static_cast<float>(scene.background[1]) / 255,
               static_cast<float>(scene.background[2]) / 255, 1);
  glFinish();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    throw InputError("Mesa: OpenGL error " + std::to_string(error) + " while the scene was set up");
  }
}

Mesa::~Mesa() = default;

void Mesa::draw() {
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  for (const Batch& batch : state_->batches) {
    if (batch.texture < 0) {
      glDisable(GL_TEXTURE_2D);
    } else {
      glEnable(GL_TEXTURE_2D);
      glBindTexture(GL_TEXTURE_2D, state_->textures[static_cast<std::size_t>(batch.texture)]);
    }
    glDrawArrays(GL_TRIANGLES, batch.first, batch.count);
  }
  glFinish();
}

const std::vector<std::uint8_t>& Mesa::picture() const { return state_->picture; }

std::string Mesa::renderer() const { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

}  // namespace bitspan::bench
