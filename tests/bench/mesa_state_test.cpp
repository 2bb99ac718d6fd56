// SPDX-License-Identifier: Apache-2.0
// Draw state against OpenGL: random pictures by the model and by Mesa, in the same state.
//
// Compared are the interior pixels: those whose nine neighbours, themselves included, lie in the picture and
// have their centres inside the same triangles of the scene, of which there is at least one. So no rule of
// the edges counts, and every other pixel does. All vertices lie on the grid of 1/16 pixel, and depths are
// constant per triangle and equal, or so far apart that no rounding changes their order. bitspan draws no
// fragment of alpha 0, which OpenGL does; so there is none but with alpha.zero = keep.
//
// BITSPAN_SEED is another seed. BITSPAN_SHOW prints pixels that differ.
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <initializer_list>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "engine/registry.hpp"
#include "model/mip_chain.hpp"
#include "scene/random.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// A power of two, so that OpenGL's way from pixels to the screen and back is exact in floats.
constexpr int side = 64;
constexpr int grid = 16;
constexpr std::size_t stencil_bytes = std::size_t{side} * side;
constexpr std::size_t color_bytes = 4 * stencil_bytes;
// Distances s of the scene run from 2 to 18.
constexpr int levels = 8;
constexpr double level_width = 2;

// ---- OpenGL in a draw state of bitspan's ----

constexpr std::array<GLenum, 8> gl_compare{GL_NEVER,   GL_LESS,     GL_EQUAL,  GL_LEQUAL,
                                           GL_GREATER, GL_NOTEQUAL, GL_GEQUAL, GL_ALWAYS};
constexpr std::array<GLenum, 8> gl_stencil_op{GL_KEEP, GL_ZERO,   GL_REPLACE,   GL_INCR,
                                              GL_DECR, GL_INVERT, GL_INCR_WRAP, GL_DECR_WRAP};
constexpr std::array<GLenum, 15> gl_factor{GL_ZERO,
                                           GL_ONE,
                                           GL_SRC_COLOR,
                                           GL_ONE_MINUS_SRC_COLOR,
                                           GL_DST_COLOR,
                                           GL_ONE_MINUS_DST_COLOR,
                                           GL_SRC_ALPHA,
                                           GL_ONE_MINUS_SRC_ALPHA,
                                           GL_DST_ALPHA,
                                           GL_ONE_MINUS_DST_ALPHA,
                                           GL_CONSTANT_COLOR,
                                           GL_ONE_MINUS_CONSTANT_COLOR,
                                           GL_CONSTANT_ALPHA,
                                           GL_ONE_MINUS_CONSTANT_ALPHA,
                                           GL_SRC_ALPHA_SATURATE};
constexpr std::array<GLenum, 5> gl_equation{GL_FUNC_ADD, GL_FUNC_SUBTRACT, GL_FUNC_REVERSE_SUBTRACT, GL_MIN,
                                            GL_MAX};
// From `clear` on.
constexpr std::array<GLenum, 16> gl_logic{
    GL_CLEAR, GL_AND,   GL_AND_REVERSE, GL_COPY,       GL_AND_INVERTED,  GL_NOOP,        GL_XOR,  GL_OR,
    GL_NOR,   GL_EQUIV, GL_INVERT,      GL_OR_REVERSE, GL_COPY_INVERTED, GL_OR_INVERTED, GL_NAND, GL_SET};

constexpr std::uint64_t blend_triples = gl_factor.size() * gl_factor.size() * gl_equation.size();

template <class Table, class Enum>
GLenum gl(const Table& table, Enum value) {
  return table.at(static_cast<std::size_t>(value));
}
float share(int code) { return static_cast<float>(code) / 255; }
void enable(GLenum what, bool on) {
  if (on) {
    glEnable(what);
  } else {
    glDisable(what);
  }
}

// OpenGL's pattern has 32 x 32 pixels, its rows from the bottom, and the high bit of a byte to the left.
void set_stipple(std::int64_t stipple) {
  std::array<GLubyte, 128> pattern{};
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      if ((stipple >> (8 * (y % 4) + x % 8) & 1) == 0) continue;
      pattern.at(static_cast<std::size_t>(4 * (31 - y) + x / 8)) |= static_cast<GLubyte>(0x80 >> x % 8);
    }
  }
  glPolygonStipple(pattern.data());
  enable(GL_POLYGON_STIPPLE, stipple != 0xffffffff);
}

void apply(const DrawState& s) {
  glDepthFunc(gl(gl_compare, s.depth_func));
  glDepthMask(s.depth_write ? GL_TRUE : GL_FALSE);
  const int left = std::min(s.scissor_left, side), right = std::min(s.scissor_right, side);
  const int top = std::min(s.scissor_top, side), bottom = std::min(s.scissor_bottom, side);
  glScissor(left, side - bottom, std::max(0, right - left), std::max(0, bottom - top));
  set_stipple(s.stipple);
  glAlphaFunc(gl(gl_compare, s.alpha_func), share(s.alpha_ref));
  enable(GL_STENCIL_TEST, s.stencil_test);
  const bool two = s.stencil_two_sided;
  const auto of_back = [&](int back, int front) { return two && back >= 0 ? back : front; };
  glStencilMaskSeparate(GL_FRONT, static_cast<GLuint>(s.stencil_write));
  glStencilMaskSeparate(GL_BACK, static_cast<GLuint>(of_back(s.stencil_back_write, s.stencil_write)));
  glStencilFuncSeparate(GL_FRONT, gl(gl_compare, s.stencil_func), s.stencil_ref,
                        static_cast<GLuint>(s.stencil_mask));
  glStencilFuncSeparate(GL_BACK, gl(gl_compare, two ? s.stencil_back_func : s.stencil_func),
                        of_back(s.stencil_back_ref, s.stencil_ref),
                        static_cast<GLuint>(of_back(s.stencil_back_mask, s.stencil_mask)));
  glStencilOpSeparate(GL_FRONT, gl(gl_stencil_op, s.stencil_fail), gl(gl_stencil_op, s.stencil_zfail),
                      gl(gl_stencil_op, s.stencil_pass));
  glStencilOpSeparate(GL_BACK, gl(gl_stencil_op, two ? s.stencil_back_fail : s.stencil_fail),
                      gl(gl_stencil_op, two ? s.stencil_back_zfail : s.stencil_zfail),
                      gl(gl_stencil_op, two ? s.stencil_back_pass : s.stencil_pass));
  const auto writes = [&](int channel) {
    return static_cast<GLboolean>(s.color_write && (s.color_mask >> channel & 1) != 0 ? GL_TRUE : GL_FALSE);
  };
  glColorMask(writes(0), writes(1), writes(2), writes(3));
  glBlendFuncSeparate(gl(gl_factor, s.blend_src), gl(gl_factor, s.blend_dst),
                      gl(gl_factor, s.blend_alpha_src), gl(gl_factor, s.blend_alpha_dst));
  glBlendEquationSeparate(gl(gl_equation, s.blend_op), gl(gl_equation, s.blend_alpha_op));
  glBlendColor(share(s.blend_red), share(s.blend_green), share(s.blend_blue), share(s.blend_alpha));
  enable(GL_COLOR_LOGIC_OP, s.logic_op != LogicOp::none);
  if (s.logic_op != LogicOp::none) glLogicOp(gl_logic.at(static_cast<std::size_t>(s.logic_op) - 1));
}

// Rows from the top.
struct Picture {
  std::vector<std::uint8_t> color = std::vector<std::uint8_t>(color_bytes);
  std::vector<std::uint8_t> stencil = std::vector<std::uint8_t>(stencil_bytes);
};

template <class T>
void flip(std::vector<T>& rows, std::size_t row) {
  for (std::size_t y = 0; y < side / 2; ++y) {
    const auto at = [&](std::size_t i) { return rows.begin() + static_cast<std::ptrdiff_t>(i * row); };
    std::swap_ranges(at(y), at(y + 1), at(side - 1 - y));
  }
}

GLint minification(TextureFilter filter, MipMode mip) {
  const bool weighs = weighs_texels(filter);
  switch (mip) {
    case MipMode::none:
      return weighs ? GL_LINEAR : GL_NEAREST;
    case MipMode::nearest:
      return weighs ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_NEAREST;
    case MipMode::linear:
      return weighs ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_LINEAR;
  }
  unreachable();
}

// A scene's textures, with bitspan's own levels; each unit has its own copies, as OpenGL keeps a texture's
// registers with the texture. All wrap modes are cyclic, and the second unit replaces.
class Textures {
 public:
  Textures(const Config& config, const Scene& scene) : config_(config), scene_(scene) {
    for (std::vector<GLuint>& names : names_) {
      names.resize(scene.textures.size());
      glGenTextures(static_cast<GLsizei>(names.size()), names.data());
      for (std::size_t i = 0; i < names.size(); ++i) {
        glBindTexture(GL_TEXTURE_2D, names[i]);
        const model::MipChain chain = model::make_mip_chain(scene.textures[i]);
        for (std::size_t level = 0; level < chain.size(); ++level) {
          glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA8, chain[level].width,
                       chain[level].height, 0, GL_RGBA, GL_UNSIGNED_BYTE, chain[level].rgba.data());
        }
      }
    }
  }
  ~Textures() {
    for (const std::vector<GLuint>& names : names_)
      glDeleteTextures(static_cast<GLsizei>(names.size()), names.data());
  }
  Textures(const Textures&) = delete;
  Textures& operator=(const Textures&) = delete;

  // For the triangles that follow.
  void bind(int texture, const DrawState& s) {
    of_unit_ = {texture, s.texture1};
    set(0, first_lookup(s), first_magnified(s), first_levels(s), s.texture_lod_bias);
    set(1, second_lookup(s), second_magnified(s), second_levels(s), s.texture1_lod_bias);
    glActiveTexture(GL_TEXTURE0);
  }
  void look_up(const Vertex& v) const {
    for (std::size_t unit = 0; unit < 2; ++unit) {
      if (of_unit_.at(unit) < 0) continue;
      const Texture& t = scene_.textures[static_cast<std::size_t>(of_unit_.at(unit))];
      glMultiTexCoord2d(static_cast<GLenum>(GL_TEXTURE0 + unit), v.u / t.width, v.v / t.height);
    }
  }

 private:
  void set(std::size_t unit, const TexelLookup& by, const TexelLookup& magnified, const LevelRange& range,
           int bias) const {
    glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
    const int texture = of_unit_.at(unit);
    enable(GL_TEXTURE_2D, texture >= 0);
    if (texture < 0) return;
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, unit == 0 ? GL_MODULATE : GL_REPLACE);
    glBindTexture(GL_TEXTURE_2D, names_.at(unit)[static_cast<std::size_t>(texture)]);
    const auto parameter = [](GLenum what, float value) { glTexParameterf(GL_TEXTURE_2D, what, value); };
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, minification(by.filter, config_.mip));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, minification(magnified.filter, MipMode::none));
    parameter(GL_TEXTURE_LOD_BIAS, static_cast<float>(bias) / 16);
    parameter(GL_TEXTURE_MIN_LOD, static_cast<float>(range.least));
    parameter(GL_TEXTURE_MAX_LOD, static_cast<float>(range.greatest));
  }

  const Config& config_;
  const Scene& scene_;
  std::array<std::vector<GLuint>, 2> names_;
  std::array<int, 2> of_unit_{-1, -1};
};

// Draws with Mesa in this process, which can have one driver.
class Mesa {
 public:
  explicit Mesa(const std::string& driver) {
    setenv("GALLIUM_DRIVER", driver.c_str(), 1);
    setenv("LP_NUM_THREADS", "0", 1);
    context_.reset(OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, nullptr));
    if (context_ == nullptr ||
        OSMesaMakeCurrent(context_.get(), buffer_.data(), GL_UNSIGNED_BYTE, side, side) == GL_FALSE) {
      throw InputError("Mesa: no off-screen context with 24 bits of depth and 8 of stencil");
    }
    glViewport(0, 0, side, side);
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    glOrtho(0, side, 0, side, 0, 1);
    glMatrixMode(GL_MODELVIEW);
    glLoadIdentity();
    glDisable(GL_DITHER);
    for (const GLenum what : {GL_DEPTH_TEST, GL_ALPHA_TEST, GL_BLEND, GL_SCISSOR_TEST}) glEnable(what);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
  }

  Picture draw(const Config& config, const Scene& scene) const {
    DrawState state = first_state(config);
    apply(state);
    glClearColor(share(scene.background[0]), share(scene.background[1]), share(scene.background[2]), 1);
    glClearStencil(0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    auto command = scene.commands.begin();
    Textures textures(config, scene);
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      for (; command != scene.commands.end() && command->before <= i; ++command) {
        state = changed_state(state, std::get<StateChange>(command->what), config);
        apply(state);
      }
      textures.bind(scene.triangles[i].texture, state);
      glBegin(GL_TRIANGLES);
      for (const Vertex& v : scene.triangles[i].v) {
        glColor4d(v.c[0], v.c[1], v.c[2], v.c[3]);
        textures.look_up(v);
        if (v.z < 0) {
          glVertex3d(v.x, side - v.y, -v.s / scene.s_max);
          continue;
        }
        // In front of glOrtho's matrix: its z runs from 0 to -1 where the depth runs from 0 to 1.
        glVertex4d(v.x * v.s, (side - v.y) * v.s, -v.z * v.s, v.s);
      }
      glEnd();
    }
    Picture out;
    glReadPixels(0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE, out.color.data());
    glReadPixels(0, 0, side, side, GL_STENCIL_INDEX, GL_UNSIGNED_BYTE, out.stencil.data());
    flip(out.color, std::size_t{4} * side);
    flip(out.stencil, side);
    if (glGetError() != GL_NO_ERROR) throw InputError("Mesa: an OpenGL error");
    return out;
  }

 private:
  struct Destroy {
    void operator()(OSMesaContext context) const { OSMesaDestroyContext(context); }
  };
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(color_bytes);
  std::unique_ptr<std::remove_pointer_t<OSMesaContext>, Destroy> context_;
};

// Mesa's pictures of scenes 0, 1, ... from a process of its own, so that this one can have several drivers.
class MesaChild {
 public:
  MesaChild(const std::string& driver, const Config& config, std::uint64_t scenes,
            const std::function<Scene(std::uint64_t)>& make) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    pid_ = fork();
    if (pid_ == 0) {
      int code = 1;
      try {
        const Mesa mesa(driver);
        std::FILE* const to = fdopen(ends[1], "wb");
        for (std::uint64_t i = 0; i < scenes; ++i) {
          const Picture picture = mesa.draw(config, make(i));
          std::fwrite(picture.color.data(), 1, color_bytes, to);
          std::fwrite(picture.stencil.data(), 1, stencil_bytes, to);
        }
        code = std::fclose(to) == 0 ? 0 : 1;
      } catch (const std::exception& e) {
        fmt::print(stderr, "{}: {}\n", driver, e.what());
      }
      _exit(code);
    }
    close(ends[1]);
    from_ = fdopen(ends[0], "rb");
  }
  ~MesaChild() {
    std::fclose(from_);
    waitpid(pid_, nullptr, 0);
  }
  MesaChild(const MesaChild&) = delete;
  MesaChild& operator=(const MesaChild&) = delete;

  // False where the child has ended.
  bool next(Picture& out) {
    return std::fread(out.color.data(), 1, color_bytes, from_) == color_bytes &&
           std::fread(out.stencil.data(), 1, stencil_bytes, from_) == stencil_bytes;
  }

 private:
  pid_t pid_ = -1;
  std::FILE* from_ = nullptr;
};

// ---- pictures ----

Picture draw(Engine& engine, const Scene& scene) {
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), nullptr);
  Picture out{engine.frame().color, engine.frame().stencil};
  out.stencil.resize(stencil_bytes);  // none without a test
  return out;
}

// Per pixel a bit for each triangle that has its centre inside; 0 for those that are not compared.
std::vector<std::uint64_t> interior(const Scene& scene) {
  std::vector<std::uint64_t> inside(stencil_bytes);
  const auto fixed = [](double x) { return static_cast<std::int64_t>(x * grid); };
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const auto& v = scene.triangles[t].v;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const std::int64_t px = x * grid + grid / 2, py = y * grid + grid / 2;
        int left = 0, right = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          const Vertex &a = v[i], &b = v[(i + 1) % 3];
          const std::int64_t turn =
              (fixed(b.x) - fixed(a.x)) * (py - fixed(a.y)) - (px - fixed(a.x)) * (fixed(b.y) - fixed(a.y));
          left += turn < 0 ? 1 : 0;
          right += turn > 0 ? 1 : 0;
        }
        if (left == 3 || right == 3) inside[static_cast<std::size_t>(y * side + x)] |= std::uint64_t{1} << t;
      }
    }
  }
  std::vector<std::uint64_t> out(inside.size());
  for (int y = 1; y < side - 1; ++y) {
    for (int x = 1; x < side - 1; ++x) {
      const auto at = [&](int dx, int dy) {
        return inside[static_cast<std::size_t>((y + dy) * side + x + dx)];
      };
      bool same = true;
      for (int n = 0; n < 9; ++n) same = same && at(n % 3 - 1, n / 3 - 1) == at(0, 0);
      if (same) out[static_cast<std::size_t>(y * side + x)] = at(0, 0);
    }
  }
  return out;
}

// ---- random scenes ----

double random_code(Random& random, std::int64_t low) {
  return static_cast<double>(random.integer(low, 255)) / 255;
}

// is_flat: one colour, of exact codes. Alpha is never 0: at first bitspan draws no such fragment.
void color(Random& random, Triangle& t, bool is_flat) {
  constexpr std::int64_t least_alpha = 4;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t c = 0; c < 4; ++c) {
      t.v[i].c[c] = is_flat && i > 0 ? t.v[0].c[c] : random_code(random, c == 3 ? least_alpha : 0);
    }
  }
}

// A large triangle of either winding. None is clipped, for softpipe's clipped triangles have gaps between
// their parts.
Triangle random_triangle(Random& random, bool is_flat) {
  constexpr std::int64_t least_area = 30 * 30 * grid * grid;
  Triangle t;
  std::int64_t area = 0;
  while (std::abs(area) < least_area) {
    std::array<std::int64_t, 3> x{}, y{};
    for (std::size_t i = 0; i < 3; ++i) {
      x.at(i) = random.integer(0, side * grid);
      y.at(i) = random.integer(0, side * grid);
      t.v[i].x = static_cast<double>(x.at(i)) / grid;
      t.v[i].y = static_cast<double>(y.at(i)) / grid;
    }
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  }
  color(random, t, is_flat);
  return t;
}

// Triangles of even levels have a constant depth, which those of one level share. An odd level is a sloped
// triangle's own, or its copies'.
void place(Random& random, std::vector<Triangle>& triangles, bool is_flat) {
  std::set<std::int64_t> taken;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    Triangle& t = triangles[i];
    if (i > 0 && random.chance(0.25)) {  // as far as the one before, at each pixel
      t = triangles[i - 1];
      color(random, t, is_flat);
      // The other face of a sloped triangle is another one to OpenGL, which may round its depths otherwise.
      if (t.v[0].s == t.v[1].s && random.chance(0.5)) std::swap(t.v[1], t.v[2]);
      continue;
    }
    std::int64_t level = random.integer(0, levels - 1);
    if (level % 2 == 1 && !taken.insert(level).second) --level;
    const double s = 2 + level_width * (static_cast<double>(level) + 0.5);
    for (Vertex& v : t.v) v.s = level % 2 == 0 ? s : s + random.uniform(-0.4, 0.4) * level_width;
  }
}

StateChange change_to(const DrawState& state) {
  StateChange change;
  const std::vector<std::int64_t> values = state_values(state);
  for (std::size_t i = 0; i < values.size(); ++i) change.settings.push_back({i, values[i]});
  return change;
}

template <class Enum>
void draw_enum(Random& random, Enum& out) {
  out = static_cast<Enum>(random.integer(0, static_cast<std::int64_t>(enum_names<Enum>.size()) - 1));
}
std::int32_t draw_code(Random& random) { return static_cast<std::int32_t>(random.integer(0, 255)); }

void draw_depth(Random& random, DrawState& s) {
  draw_enum(random, s.depth_func);
  // Most comparisons pass nothing over the cleared buffer.
  if (random.chance(0.3)) s.depth_func = random.chance(0.5) ? DepthFunc::less : DepthFunc::always;
  s.depth_write = random.chance(0.7);
  draw_enum(random, s.depth_when);
}
void draw_stencil(Random& random, DrawState& s) {
  s.depth_when = DepthWhen::late;
  s.stencil_test = random.chance(0.9);
  s.stencil_two_sided = random.chance(0.5);
  // Few values, so that comparisons for equality hold.
  s.stencil_ref = random.chance(0.5) ? draw_code(random) : static_cast<std::int32_t>(random.integer(0, 3));
  s.stencil_mask = random.chance(0.5) ? 255 : draw_code(random);
  s.stencil_write = random.chance(0.6) ? 255 : draw_code(random);
  for (CompareFunc* f : {&s.stencil_func, &s.stencil_back_func}) draw_enum(random, *f);
  for (StencilOp* op : {&s.stencil_fail, &s.stencil_zfail, &s.stencil_pass, &s.stencil_back_fail,
                        &s.stencil_back_zfail, &s.stencil_back_pass}) {
    draw_enum(random, *op);
  }
  // Of a generator of their own, so that the other registers are those of before.
  Random own(static_cast<std::uint64_t>((s.stencil_ref * 256 + s.stencil_mask) * 256 + s.stencil_write));
  for (std::int32_t* of_back : {&s.stencil_back_ref, &s.stencil_back_mask, &s.stencil_back_write}) {
    if (own.chance(0.5))
      *of_back = own.chance(0.5) ? draw_code(own) : static_cast<std::int32_t>(own.integer(0, 3));
  }
}
void draw_blend(Random& random, DrawState& s) {
  // OpenGL has no half.
  for (BlendFactor* f : {&s.blend_src, &s.blend_dst, &s.blend_alpha_src, &s.blend_alpha_dst})
    *f = static_cast<BlendFactor>(random.integer(0, gl_factor.size() - 1));
  for (BlendOp* op : {&s.blend_op, &s.blend_alpha_op}) draw_enum(random, *op);
  for (std::int32_t* code : {&s.blend_red, &s.blend_green, &s.blend_blue, &s.blend_alpha})
    *code = draw_code(random);
}
void draw_scissor(Random& random, DrawState& s) {
  for (std::int32_t* at : {&s.scissor_left, &s.scissor_top})
    *at = static_cast<std::int32_t>(random.integer(0, side / 2));
  for (std::int32_t* at : {&s.scissor_right, &s.scissor_bottom})
    *at = static_cast<std::int32_t>(random.integer(side / 4, side + 8));
}
void draw_masks(Random& random, DrawState& s) {
  if (random.chance(0.6)) draw_scissor(random, s);
  if (random.chance(0.6)) s.stipple = static_cast<std::int64_t>(random.bits() & 0xffffffffU);
  s.color_write = random.chance(0.7);
  if (random.chance(0.5)) s.color_mask = static_cast<std::int32_t>(random.integer(0, 15));
}
void draw_alpha(Random& random, DrawState& s) {
  draw_enum(random, s.alpha_func);
  s.alpha_ref = draw_code(random);
  draw_enum(random, s.depth_when);
}
void draw_logic(Random& random, DrawState& s) {
  s.logic_op = static_cast<LogicOp>(random.integer(1, gl_logic.size()));
}

// What is drawn: a scene, the same one with the first states alone, and which values its registers took.
struct Case {
  Scene scene, without;
  std::vector<DrawState> states;
};

// Registers that a kind of case draws, from those of a fragment that replaces what is stored.
struct Kind {
  std::string_view name;
  bool is_flat;
  std::function<void(Random&, DrawState&)> registers;
  // Only one triangle of a pixel has these registers, over others whose colours are exact codes.
  bool is_single = false;
  bool has_levels = false;      // of textures, for which make_levels() draws all registers
  bool has_zero_alpha = false;  // every other triangle has alpha 0, and alpha.zero is keep
  bool has_lines = false;       // vertices give w and z: the depth and perspective of make_lines()
};

Scene empty_picture() {
  Scene scene;
  scene.width = scene.height = side;
  scene.s_min = 1;
  scene.s_max = 20;
  return scene;
}
// The first state, in which a fragment that passes replaces what is stored.
DrawState replacing(const Config& config, DepthFunc func) {
  DrawState state = first_state(config);
  state.depth_func = func;
  state.blend_src = state.blend_alpha_src = BlendFactor::one;
  state.blend_dst = state.blend_alpha_dst = BlendFactor::zero;
  return state;
}

Case make_case(const Kind& kind, Random& random, std::uint64_t number, const Config& config) {
  constexpr int below = 6, above = 10;
  Case out;
  Scene& scene = out.scene;
  scene = empty_picture();
  for (std::uint8_t& code : scene.background) code = static_cast<std::uint8_t>(random.integer(0, 255));

  DrawState first = replacing(config, kind.is_single ? DepthFunc::always : DepthFunc::less);
  if (kind.has_zero_alpha) first.alpha_zero = AlphaZero::keep;
  scene.commands.push_back({0, change_to(first)});
  const int triangles = kind.is_single ? below + 1 : above;
  for (int i = 0; i < triangles; ++i) {
    scene.triangles.push_back(random_triangle(random, kind.is_flat || (kind.is_single && i < below)));
  }
  for (std::size_t i = 0; kind.has_zero_alpha && i < scene.triangles.size(); i += 2) {
    for (Vertex& v : scene.triangles[i].v) v.c[3] = 0;
  }
  if (kind.is_single) {
    // The first two cover the picture.
    for (std::size_t half = 0; half < 2; ++half) {
      for (std::size_t i = 0; i < 3; ++i) {
        Vertex& v = scene.triangles[half].v[i];
        v.x = i == 1 || (i == 2 && half == 0) ? side : 0;
        v.y = i == 2 || (i == 1 && half == 1) ? side : 0;
      }
    }
    for (Triangle& t : scene.triangles) {
      for (Vertex& v : t.v) v.s = 2;
    }
  } else {
    place(random, scene.triangles, kind.is_flat);
  }
  out.without = scene;
  for (std::size_t i = kind.is_single ? below : 0; i < scene.triangles.size(); ++i) {
    DrawState state = first;
    kind.registers(random, state);
    if (kind.is_single) {  // each triple in turn
      state.blend_src = static_cast<BlendFactor>(number % gl_factor.size());
      state.blend_dst = static_cast<BlendFactor>(number / gl_factor.size() % gl_factor.size());
      state.blend_op = static_cast<BlendOp>(number * gl_equation.size() / blend_triples % gl_equation.size());
    }
    scene.commands.push_back({i, change_to(state)});
    out.states.push_back(state);
  }
  return out;
}

// ---- a vertex with z and w ----

// As a driver has its triangles: w per vertex, a depth z that has nothing to do with it, and colours that are
// linear in space. Without: colours of the first vertex, depths by w.
Case make_lines(Random& random, const Config& config) {
  Case out;
  Scene& scene = out.scene;
  scene = empty_picture();
  const DrawState first = replacing(config, DepthFunc::less);
  scene.commands.push_back({0, change_to(first)});
  for (int i = 0; i < 6; ++i) {
    Triangle t = random_triangle(random, false);
    for (Vertex& v : t.v) {
      v.s = random.log_uniform(1, 20);
      v.z = random.uniform(0, 1);
    }
    scene.triangles.push_back(t);
  }
  out.without = scene;
  for (Triangle& t : out.without.triangles) {
    for (Vertex& v : t.v) {
      v.c = t.v[0].c;
      v.z = -1;
    }
  }
  out.states = {first};
  return out;
}
// Leaves out pixels at which the two least depths are so close that rounding decides.
void keep_apart(const Scene& scene, std::vector<std::uint64_t>& compared) {
  constexpr double apart = 1e-4;
  for (std::size_t i = 0; i < compared.size(); ++i) {
    const double x = static_cast<double>(i % side) + 0.5, y = static_cast<double>(i / side) + 0.5;
    double least = 2, next = 2;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
      if ((compared[i] >> t & 1) == 0) continue;
      const auto& [a, b, c] = scene.triangles[t].v;
      const auto area = [](double ax, double ay, double bx, double by) { return ax * by - ay * bx; };
      const double whole = area(b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y);
      const double of_b = area(x - a.x, y - a.y, c.x - a.x, c.y - a.y) / whole;
      const double of_c = area(b.x - a.x, b.y - a.y, x - a.x, y - a.y) / whole;
      const double z = a.z + of_b * (b.z - a.z) + of_c * (c.z - a.z);
      next = std::min(next, std::max(least, z));
      least = std::min(least, z);
    }
    if (next - least < apart) compared[i] = 0;
  }
}

// ---- levels of textures ----

// Two triangles that cover the picture, parallel to it. A step of a pixel is a step of a power of two texels,
// so that the level of detail is that whole number and the bias. Centres lie well inside of texels. OpenGL
// leaves open what a least level above the greatest one does.
Case make_levels(Random& random, const Config& config) {
  Case out;
  Scene& scene = out.scene;
  scene = empty_picture();
  for (const auto& [width, height] : {std::pair{32, 32}, {16, 64}}) {
    Texture t{"random", width, height, {}};
    for (int i = 0; i < width * height; ++i) {
      for (int c = 0; c < 3; ++c) t.rgba.push_back(static_cast<std::uint8_t>(random.integer(64, 191)));
      t.rgba.push_back(255);
    }
    scene.textures.push_back(t);
  }
  const auto log2_step = static_cast<int>(random.integer(-2, 3));
  const double step = std::ldexp(1.0, log2_step);
  for (int half = 0; half < 2; ++half) {
    Triangle t;
    for (std::size_t i = 0; i < 3; ++i) {
      Vertex& v = t.v.at(i);
      v.x = i == 1 || (i == 2 && half == 0) ? side : 0;
      v.y = i == 2 || (i == 1 && half == 1) ? side : 0;
      v.s = 2;
      v.u = step * v.x + 0.28125;
      v.v = step * v.y + 0.28125;
      v.c = {1, 1, 1, 1};
    }
    t.texture = 0;
    scene.triangles.push_back(t);
  }
  DrawState state = first_state(config);
  state.depth_func = DepthFunc::always;
  scene.commands = {{0, change_to(state)}};
  if (random.chance(0.5)) {
    state.texture1 = 1;
    state.texture1_op = TextureOp::replace;
    scene.commands = {{0, change_to(state)}};
  }
  out.without = scene;
  const auto draw = [&](TextureFilter& filter, MagnifyFilter& magnify, std::int32_t& bias,
                        std::int32_t& least, std::int32_t& greatest) {
    draw_enum(random, filter);
    draw_enum(random, magnify);
    // Neither between two nearest levels nor where a texture begins to be magnified.
    do {
      bias = static_cast<std::int32_t>(random.integer(-31, 32));
    } while ((bias + 16 * log2_step) % 8 == 0);
    if (random.chance(0.5)) greatest = static_cast<std::int32_t>(random.integer(0, 4));
    if (random.chance(0.4)) least = static_cast<std::int32_t>(random.integer(0, std::min(greatest, 3)));
  };
  draw(state.texture_filter, state.texture_magnify, state.texture_lod_bias, state.texture_level_least,
       state.texture_level_greatest);
  draw(state.texture1_filter, state.texture1_magnify, state.texture1_lod_bias, state.texture1_level_least,
       state.texture1_level_greatest);
  scene.commands = {{0, change_to(state)}};
  out.states.push_back(state);
  return out;
}

// ---- the comparison ----

// What was compared, over all pictures of a kind.
struct Tally {
  std::uint64_t pixels = 0, within = 0, equal = 0, stencil_differs = 0, changed = 0, stencil_written = 0;
  int largest = 0;
  std::vector<std::set<std::int64_t>> seen =
      std::vector<std::set<std::int64_t>>(state_registers().size());  // values per register
  std::set<std::array<std::int64_t, 3>> blends;
};

std::uint64_t seed() {
  const char* text = std::getenv("BITSPAN_SEED");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : 1;
}

std::string pixel_text(const Picture& p, std::size_t i) {
  return fmt::format("{}, {}, {}, {}, stencil {}", p.color[4 * i], p.color[4 * i + 1], p.color[4 * i + 2],
                     p.color[4 * i + 3], p.stencil[i]);
}

int distance(const Picture& a, const Picture& b, std::size_t pixel) {
  int out = 0;
  for (std::size_t c = 4 * pixel; c < 4 * pixel + 4; ++c)
    out = std::max(out, std::abs(a.color[c] - b.color[c]));
  return out;
}

void add(Tally& tally, const std::vector<DrawState>& states) {
  for (const DrawState& state : states) {
    const std::vector<std::int64_t> values = state_values(state);
    for (std::size_t r = 0; r < values.size(); ++r) tally.seen.at(r).insert(values[r]);
    tally.blends.insert({static_cast<std::int64_t>(state.blend_src),
                         static_cast<std::int64_t>(state.blend_dst),
                         static_cast<std::int64_t>(state.blend_op)});
  }
}

Tally compare(const Kind& kind, const std::string& driver, std::uint64_t cases, const Config& config) {
  if (is_long_run()) cases *= 20;
  const auto make = [&](std::uint64_t number) {
    Random random(seed() * 1'000'003 + number);
    if (kind.has_lines) return make_lines(random, config);
    return kind.has_levels ? make_levels(random, config) : make_case(kind, random, number, config);
  };
  MesaChild mesa(driver, config, cases, [&](std::uint64_t number) { return make(number).scene; });
  const std::unique_ptr<Engine> engine = make_engine("model", config);
  const bool show = std::getenv("BITSPAN_SHOW") != nullptr;
  Tally tally;
  for (std::uint64_t number = 0; number < cases; ++number) {
    const Case drawn = make(number);
    std::vector<std::uint64_t> compared = interior(drawn.scene);
    if (kind.has_lines) keep_apart(drawn.scene, compared);
    const Picture ours = draw(*engine, drawn.scene);
    const Picture without = draw(*engine, drawn.without);
    Picture theirs;
    if (!mesa.next(theirs)) {
      ADD_FAILURE() << driver << " gave no picture " << number;
      return tally;
    }
    for (std::size_t i = 0; i < compared.size(); ++i) {
      const bool is_drawn = !kind.is_single || compared[i] >> (drawn.scene.triangles.size() - 1) != 0;
      if (compared[i] == 0 || !is_drawn) continue;
      const int d = distance(ours, theirs, i);
      const bool stencil_differs = ours.stencil[i] != theirs.stencil[i];
      ++tally.pixels;
      tally.within += d <= 1 ? 1U : 0U;
      tally.equal += d == 0 ? 1U : 0U;
      tally.largest = std::max(tally.largest, d);
      tally.stencil_differs += stencil_differs ? 1U : 0U;
      tally.stencil_written += ours.stencil[i] != 0 ? 1U : 0U;
      tally.changed += distance(ours, without, i) > 1 || ours.stencil[i] != without.stencil[i] ? 1U : 0U;
      if (show && (d > 1 || stencil_differs)) {
        fmt::print("picture {} at {}, {}: {}; Mesa {}; without the registers {}\n", number, i % side,
                   i / side, pixel_text(ours, i), pixel_text(theirs, i), pixel_text(without, i));
      }
    }
    add(tally, drawn.states);
  }
  const auto percent = [&](std::uint64_t n) {
    return 100 * static_cast<double>(n) / static_cast<double>(tally.pixels);
  };
  fmt::print(
      "{}, {}, seed {}: {} pictures, {} interior pixels, {:.4f} % within 1 code, {:.2f} % equal, at most {} "
      "codes off; the stencil differs on {} and is not 0 on {:.1f} %; the registers changed {:.1f} %\n",
      kind.name, driver, seed(), cases, tally.pixels, percent(tally.within), percent(tally.equal),
      tally.largest, tally.stencil_differs, percent(tally.stencil_written), percent(tally.changed));
  EXPECT_GE(percent(tally.within), 99.9);
  EXPECT_EQ(tally.stencil_differs, 0U);
  EXPECT_GE(tally.pixels, (kind.is_single ? 200 : 600) * cases);
  EXPECT_GE(percent(tally.changed), 30);
  return tally;
}

Tally compare(const Kind& kind, const std::string& driver, std::uint64_t cases) {
  return compare(kind, driver, cases, shipped_config("depth20"));
}

// Each value of these registers was drawn.
void expect_all(const Tally& tally, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    const std::size_t at = find_state_register(key).value();
    // A logic operation is drawn, and OpenGL has no half.
    const auto& names = state_registers()[at].names;
    const std::size_t values = names.size() - (key == "logic.op" || names.back() == "half" ? 1 : 0);
    EXPECT_EQ(tally.seen.at(at).size(), values) << key;
  }
}

constexpr std::array<const char*, 2> drivers{"softpipe", "llvmpipe"};

TEST(MesaState, Depth) {
  for (const char* driver : drivers)
    expect_all(compare({"depth", false, draw_depth}, driver, 60),
               {"depth.func", "depth.write", "depth.when"});
}

TEST(MesaState, Stencil) {
  const Kind kind{"stencil", false, [](Random& random, DrawState& s) {
                    draw_depth(random, s);
                    draw_stencil(random, s);
                  }};
  for (const char* driver : drivers) {
    // llvmpipe compiles a shader per state.
    const Tally tally = compare(kind, driver, driver == drivers[0] ? 300 : 20);
    expect_all(tally, {"stencil.test", "stencil.func", "stencil.fail", "stencil.zfail", "stencil.pass",
                       "stencil.two_sided", "stencil.back.func", "stencil.back.fail", "stencil.back.zfail",
                       "stencil.back.pass"});
    for (const char* key : {"stencil.back.ref", "stencil.back.mask", "stencil.back.write"}) {
      EXPECT_GT(tally.seen.at(*find_state_register(key)).size(), 10U) << key;
    }
    EXPECT_GT(tally.stencil_written, tally.pixels / 3);
  }
}

TEST(MesaState, AlphaTest) {
  for (const char* driver : drivers)
    expect_all(compare({"alpha test of flat alpha", true, draw_alpha}, driver, 100), {"alpha.func"});
}
TEST(MesaState, AlphaZero) {
  for (const char* driver : drivers) {
    expect_all(compare({.name = "alpha 0", .is_flat = true, .registers = draw_alpha, .has_zero_alpha = true},
                       driver, 60),
               {"alpha.func"});
  }
}
// softpipe compares alpha itself. OpenGL rounds it to a code first (4.1.4 of version 2.1), as llvmpipe does.
TEST(MesaState, AlphaTestOfSlopes) {
  expect_all(compare({"alpha test", false, draw_alpha}, "llvmpipe", 100), {"alpha.func"});
}

// llvmpipe blends in 8 bits, which is less exact than what is compared; docs/verify.md has its figures.
TEST(MesaState, Blend) {
  const Tally tally = compare({"blend", false, draw_blend, true}, "softpipe", blend_triples);
  EXPECT_EQ(tally.blends.size(), blend_triples);
  expect_all(tally, {"blend.alpha.src", "blend.alpha.dst", "blend.alpha.op"});
}

TEST(MesaState, LogicOperation) {
  for (const char* driver : drivers)
    expect_all(compare({"logic operation", true, draw_logic}, driver, 60), {"logic.op"});
}

TEST(MesaState, Masks) {
  for (const char* driver : drivers)
    expect_all(compare({"scissor, stipple and colour mask", false, draw_masks}, driver, 60), {"color.write"});
}

TEST(MesaState, LevelsOfTextures) {
  for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
    Config config = shipped_config("depth20");
    config.mip = mip;
    config.lod = LodMode::gradient;
    for (const char* driver : drivers) {
      const Kind kind{.name = mip == MipMode::nearest ? "nearest level" : "two levels",
                      .is_flat = true,
                      .registers = {},
                      .has_levels = true};
      expect_all(compare(kind, driver, 100, config),
                 {"texture.filter", "texture.magnify", "texture1.filter", "texture1.magnify"});
    }
  }
}

// A vertex's z apart from its w, and colours that are linear in space.
TEST(MesaState, LinesOfADriver) {
  Config config = shipped_config("depth20");
  config.depth_code = DepthCode::opengl;
  config.depth_line = DepthLine::z;
  for (const Perspective perspective : {Perspective::delta_f, Perspective::hyperbolic}) {
    config.perspective = perspective;
    config.shade_lines = ShadeLines::perspective;
    for (const char* driver : drivers) {
      compare({.name = "z and w", .is_flat = false, .registers = {}, .has_lines = true}, driver, 80, config);
    }
  }
}

TEST(MesaState, AllTogether) {
  const Kind kind{"all together", true, [](Random& random, DrawState& s) {
                    if (random.chance(0.5)) draw_masks(random, s);
                    draw_depth(random, s);
                    draw_alpha(random, s);
                    draw_stencil(random, s);
                    if (random.chance(0.5)) draw_logic(random, s);
                  }};
  for (const char* driver : drivers)
    expect_all(compare(kind, driver, driver == drivers[0] ? 200 : 20),
               {"stencil.func", "alpha.func", "depth.func"});
}

}  // namespace
}  // namespace bitspan
