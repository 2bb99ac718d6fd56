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
#include <optional>

#include "bench/scenes.hpp"
#include "model/mip_chain.hpp"
#include "model/stages/texel.hpp"
#include "report/shadow_plan.hpp"

namespace bitspan::bench {
namespace {

struct GlVertex {
  std::array<float, 3> position;  // in the eye's space: w of the clip space becomes s
  std::array<std::uint8_t, 4> color;
  std::array<float, 2> texel;    // 0..1 across the texture
  std::array<float, 4> in_lamp;  // homogeneous: the place in the shadow map, and the depth there
};
static_assert(sizeof(GlVertex) == 40);

// What a light per pixel takes besides, in the viewer's space.
struct GlLit {
  std::array<float, 3> normal, place;
};

// Consecutive triangles with one texture.
struct Batch {
  int texture = -1;
  GLint first = 0;
  GLsizei count = 0;
};

// The scene's pass over a shadow map, and the picture behind it.
ShadowPlan plan_of(const Scene& scene) {
  Config config;
  config.project = ProjectUnit::reciprocal;
  if (auto plan = shadow_plan_of(config, scene)) return *std::move(plan);
  throw InputError(scene.name + ": no shadow map is drawn");
}

// 0 at the lamp's least distance, 1 at its greatest, times w.
double depth_in_lamp(const Projector& lamp, double w) {
  return (w / lamp.s_min - 1) / (1 / lamp.s_min - 1 / lamp.s_max);
}

// The picture in the light of the lamp: what is farther than the map has it is dark. LIT: and it is lit per
// pixel.
constexpr const char* vertex_shader =
    "#ifdef LIT\n"
    "varying vec3 normal, place;\n"
    "#endif\n"
    "void main() {\n"
    "#ifdef LIT\n"
    "  normal = gl_Normal;\n"
    "  place = gl_MultiTexCoord2.xyz;\n"
    "#endif\n"
    "  gl_Position = ftransform();\n"
    "  gl_FrontColor = gl_Color;\n"
    "  gl_TexCoord[0] = gl_MultiTexCoord0;\n"
    "  gl_TexCoord[1] = gl_MultiTexCoord1;\n"
    "}\n";
constexpr const char* fragment_shader =
    "#ifdef LIT\n"
    "varying vec3 normal, place;\n"
    "uniform vec3 light, shares;\n"  // diffuse, highlight, ambient
    "uniform float exponent;\n"
    "float brightness() {\n"
    "  vec3 n = normalize(normal), l = normalize(light - place);\n"
    "  float c = dot(n, l), g = l.z - 2.0 * c * n.z;\n"
    "  float highlight = c > 0.0 && g > 0.0 ? pow(min(g, 1.0), exponent) : 0.0;\n"
    "  return dot(shares, vec3(max(c, 0.0), highlight, 1.0));\n"
    "}\n"
    "#else\n"
    "float brightness() { return 1.0; }\n"
    "#endif\n"
    "uniform sampler2D image;\n"
    "uniform sampler2DShadow map;\n"
    "uniform float dark;\n"
    "void main() {\n"
    "  vec4 color = texture2D(image, gl_TexCoord[0].st) * gl_Color;\n"
    "  vec4 p = gl_TexCoord[1];\n"
    "  vec2 at = p.st / p.q;\n"
    "  bool inside = p.q > 0.0 && all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)));\n"
    "  float lit = inside ? shadow2DProj(map, p).r : 1.0;\n"
    "  gl_FragColor = vec4(color.rgb * mix(dark, 1.0, lit) * brightness(), color.a);\n"
    "}\n";

GLuint shadow_program(const std::optional<Light>& light) {
  const GLuint program = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair{GL_VERTEX_SHADER, vertex_shader}, {GL_FRAGMENT_SHADER, fragment_shader}}) {
    const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
    const std::array parts{light ? "#version 120\n#define LIT\n" : "#version 120\n", text};
    glShaderSource(shader, parts.size(), parts.data(), nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) throw InputError("Mesa: the shadow's program does not link");
  glUseProgram(program);
  glUniform1i(glGetUniformLocation(program, "image"), 0);
  glUniform1i(glGetUniformLocation(program, "map"), 1);
  glUniform1f(glGetUniformLocation(program, "dark"), static_cast<float>(shadow_dark));
  if (light) {
    const auto set = [&](const char* name, double x, double y, double z) {
      glUniform3f(glGetUniformLocation(program, name), static_cast<float>(x), static_cast<float>(y),
                  static_cast<float>(z));
    };
    set("light", light->place[0], light->place[1], light->place[2]);
    set("shares", 1 - light->ambient - light->specular, light->specular, light->ambient);
    glUniform1f(glGetUniformLocation(program, "exponent"), static_cast<float>(light->exponent));
  }
  return program;
}

GlVertex convert(const Vertex& v, const View& scene, const Texture* texture) {
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

GlLit lit(const Vertex& v, const View& scene) {
  const double per_pixel = v.s / scene.focal;
  const auto real = [](double x) { return static_cast<float>(x); };
  return {
      {real(v.nx), real(v.ny), real(v.nz)},
      {real((v.x - scene.width / 2.0) * per_pixel), real((v.y - scene.height / 2.0) * per_pixel), real(v.s)}};
}

// A place in the bound vertex buffer, as OpenGL takes it.
const void* offset(std::size_t bytes) { return std::bit_cast<const void*>(bytes); }

// x and y are divided by s as they are; z: 1 at s_min becomes -1, s_max 1.
void set_projection(const View& scene) {
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
  GLuint buffer = 0, light_buffer = 0;
  // With a shadow map only.
  std::size_t lamp_batches = 0;  // the first ones, drawn on the map
  View lamp, view;
  GLuint map = 0, map_frame = 0, program = 0;

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

  s.view = scene;
  std::size_t lamp_triangles = 0;  // the first ones
  if (scene.projector) {
    const ShadowPlan plan = plan_of(scene);
    s.lamp = plan.light;
    lamp_triangles = plan.first;
  }
  std::vector<GlVertex> vertices;
  vertices.reserve(3 * scene.triangles.size());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& t = scene.triangles[i];
    if (scene.projector && i == lamp_triangles) s.lamp_batches = s.batches.size();
    if (s.batches.size() == s.lamp_batches || s.batches.back().texture != t.texture) {
      s.batches.push_back({t.texture, static_cast<GLint>(vertices.size()), 0});
    }
    s.batches.back().count += 3;
    const Texture* texture = t.texture < 0 ? nullptr : &scene.textures[static_cast<std::size_t>(t.texture)];
    for (const Vertex& v : t.v) {
      vertices.push_back(convert(v, i < lamp_triangles ? s.lamp : s.view, texture));
      if (!scene.projector) continue;
      vertices.back().in_lamp = {static_cast<float>(v.project_x / s.lamp.width),
                                 static_cast<float>(v.project_w - v.project_y / s.lamp.height),
                                 static_cast<float>(depth_in_lamp(*scene.projector, v.project_w)),
                                 static_cast<float>(v.project_w)};
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

  if (scene.light) {
    std::vector<GlLit> of_light;
    for (const Triangle& t : scene.triangles) {
      for (const Vertex& v : t.v) of_light.push_back(lit(v, s.view));
    }
    glGenBuffers(1, &s.light_buffer);
    glBindBuffer(GL_ARRAY_BUFFER, s.light_buffer);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(of_light.size() * sizeof(GlLit)), of_light.data(),
                 GL_STATIC_DRAW);
    glNormalPointer(GL_FLOAT, sizeof(GlLit), offset(offsetof(GlLit, normal)));
    glEnableClientState(GL_NORMAL_ARRAY);
    glClientActiveTexture(GL_TEXTURE2);
    glTexCoordPointer(3, GL_FLOAT, sizeof(GlLit), offset(offsetof(GlLit, place)));
    glEnableClientState(GL_TEXTURE_COORD_ARRAY);
    glBindBuffer(GL_ARRAY_BUFFER, s.buffer);
  }
  if (scene.projector) {
    glActiveTexture(GL_TEXTURE1);
    glClientActiveTexture(GL_TEXTURE1);
    glTexCoordPointer(4, GL_FLOAT, sizeof(GlVertex), offset(offsetof(GlVertex, in_lamp)));
    glEnableClientState(GL_TEXTURE_COORD_ARRAY);
    glGenTextures(1, &s.map);
    glBindTexture(GL_TEXTURE_2D, s.map);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, mode);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, mode);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_R_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glTexImage2D(GL_TEXTURE_2D, 0, depth_bits == 16 ? GL_DEPTH_COMPONENT16 : GL_DEPTH_COMPONENT24,
                 s.lamp.width, s.lamp.height, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
    glActiveTexture(GL_TEXTURE0);
    glGenFramebuffers(1, &s.map_frame);
    glBindFramebuffer(GL_FRAMEBUFFER, s.map_frame);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, s.map, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw InputError("Mesa: no frame of a depth texture alone");
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    s.program = shadow_program(scene.light);
  }

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
  const State& s = *state_;
  if (s.program != 0) {
    glBindFramebuffer(GL_FRAMEBUFFER, s.map_frame);
    glUseProgram(0);
    glViewport(0, 0, s.lamp.width, s.lamp.height);
    set_projection(s.lamp);
    glClear(GL_DEPTH_BUFFER_BIT);
    glDisable(GL_TEXTURE_2D);
    for (std::size_t i = 0; i < s.lamp_batches; ++i) {
      glDrawArrays(GL_TRIANGLES, s.batches[i].first, s.batches[i].count);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, s.view.width, s.view.height);
    set_projection(s.view);
    glUseProgram(s.program);
  }
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  for (std::size_t i = s.lamp_batches; i < s.batches.size(); ++i) {
    const Batch& batch = s.batches[i];
    if (batch.texture < 0) {
      glDisable(GL_TEXTURE_2D);
    } else {
      glEnable(GL_TEXTURE_2D);
      glBindTexture(GL_TEXTURE_2D, s.textures[static_cast<std::size_t>(batch.texture)]);
    }
    glDrawArrays(GL_TRIANGLES, batch.first, batch.count);
  }
  glFinish();
}

const std::vector<std::uint8_t>& Mesa::picture() const { return state_->picture; }

std::string Mesa::renderer() const { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

}  // namespace bitspan::bench
