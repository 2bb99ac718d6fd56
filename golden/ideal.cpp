// SPDX-License-Identifier: Apache-2.0
#include "golden/ideal.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "config/modes.hpp"
#include "engine/mip.hpp"
#include "golden/compare.hpp"
#include "golden/merge.hpp"
#include "golden/mip_chain.hpp"
#include "golden/quantize.hpp"
#include "golden/stencil.hpp"
#include "golden/texel.hpp"

namespace bitspan {

namespace {

using Wide = __int128;  // areas: coordinates have at most 40 bits with the half pixel
using Corner = IdealTriangle::Corner;

// Points in units of 2^-(subpixel_bits + 1) pixel, in which pixel centres and vertices are both integers.
struct Point {
  std::int64_t x = 0, y = 0;
};
Point centre_of(const IdealTriangle& t, std::int64_t x, std::int64_t y) {
  const std::int64_t pixel = std::int64_t{1} << t.subpixel_bits;
  return {(2 * x + 1) * pixel, (2 * y + 1) * pixel};
}
Point point_of(const Corner& c) { return {2 * c.x, 2 * c.y}; }

Wide area_of(Point a, Point b, Point c) {
  return Wide(b.x - a.x) * (c.y - a.y) - Wide(b.y - a.y) * (c.x - a.x);
}

// The signed areas opposite to each vertex; they sum up to the triangle's own.
struct Areas {
  std::array<Wide, 3> part{};
  Wide whole = 0;
};
Areas areas_at(const IdealTriangle& t, Point p) {
  const Point a = point_of(t.v[0]);
  const Point b = point_of(t.v[1]);
  const Point c = point_of(t.v[2]);
  return {{area_of(b, c, p), area_of(c, a, p), area_of(a, b, p)}, area_of(a, b, c)};
}

// Inside by the fill rule, seen from the edge from a to b of a triangle whose area has the sign of `whole`.
bool on_inner_side(Wide part, Wide whole, Point a, Point b, FillRule rule) {
  const bool positive = whole > 0;
  if (part != 0) return (part > 0) == positive;
  if (owns_every_edge(rule)) return true;
  // The centre lies on the edge: inside on a left edge, or on a top one. The distance to the inner side grows
  // with x by (a.y - b.y) and with y by (b.x - a.x), in a triangle of positive area.
  const std::int64_t right = positive ? a.y - b.y : b.y - a.y;
  const std::int64_t down = positive ? b.x - a.x : a.x - b.x;
  return right > 0 || (right == 0 && down > 0);
}

bool covers(const IdealTriangle& t, const Areas& areas, FillRule rule) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = point_of(t.v[(i + 1) % 3]);
    const Point b = point_of(t.v[(i + 2) % 3]);
    if (!on_inner_side(areas.part[i], areas.whole, a, b, rule)) return false;
  }
  return true;
}

long double h_max(const Config& config) { return std::ldexp(1.0L, config.depth_bits) - 1; }

// h of 1/S = q. [D1]
long double depth_code(const Config& config, const Scene& scene, long double q) {
  const long double s_min = scene.s_min;
  const long double s_max = scene.s_max;
  return h_max(config) * s_min * (s_max * q - 1) / (s_max - s_min);
}

IdealPoint blend(const Config& config, const Scene& scene, const IdealTriangle& t,
                 const std::array<long double, 3>& weight) {
  long double q = 0;
  long double u = 0;
  long double v = 0;
  std::array<long double, 4> c{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner& corner = t.v[i];
    const long double share = weight[i] / corner.s;
    q += share;
    u += share * corner.u;
    v += share * corner.v;
    for (std::size_t j = 0; j < 4; ++j) c[j] += weight[i] * corner.c[j];
  }
  IdealPoint out;
  out.h = static_cast<double>(depth_code(config, scene, q));
  out.s = static_cast<double>(1 / q);
  out.u = static_cast<double>(u / q);
  out.v = static_cast<double>(v / q);
  for (std::size_t j = 0; j < 4; ++j) out.shade[j] = static_cast<double>(c[j]);
  return out;
}

IdealPoint point_at_centre(const Config& config, const Scene& scene, const IdealTriangle& t,
                           const Areas& areas, std::int64_t x, std::int64_t y) {
  std::array<long double, 3> weight{};
  for (std::size_t i = 0; i < 3; ++i) {
    weight[i] = static_cast<long double>(areas.part[i]) / static_cast<long double>(areas.whole);
  }
  IdealPoint out = blend(config, scene, t, weight);
  out.x = static_cast<double>(x) + 0.5;
  out.y = static_cast<double>(y) + 0.5;
  return out;
}

using Texel = std::array<double, 4>;  // colour codes, and alpha 0..1

class Sampler {
 public:
  Sampler(const Config& config, const Texture& texture) : config_(config), texture_(texture) {}

  // Gives false where the transparent code kills the fragment.
  bool sample(double u, double v, Texel& out) const {
    const Codes nearest = at(std::floor(u), std::floor(v));
    switch (config_.filter) {
      case TextureFilter::nearest:
        out = texel(nearest);
        break;
      case TextureFilter::bilinear: {
        const double left = std::floor(u - 0.5);
        const double top = std::floor(v - 0.5);
        const double ex = u - 0.5 - left;
        const double ey = v - 0.5 - top;
        const auto visible = [&](double i, double j) {
          const Codes own = at(i, j);
          return texel(reserved(own) ? nearest : own);
        };
        const Texel v1 = visible(left, top);
        const Texel v2 = visible(left, top + 1);
        const Texel v3 = visible(left + 1, top + 1);
        const Texel v4 = visible(left + 1, top);
        for (std::size_t c = 0; c < out.size(); ++c) {
          const double v5 = v1[c] * (1 - ex) + v4[c] * ex;
          const double v6 = v2[c] * (1 - ex) + v3[c] * ex;
          out[c] = v5 * (1 - ey) + v6 * ey;
        }
        break;
      }
    }
    return !reserved(nearest);
  }

 private:
  using Codes = std::array<std::uint8_t, 4>;

  // A place below 0 or at `size` is outside.
  double wrapped(double i, int size) const {
    switch (config_.wrap) {
      case TextureWrap::clamp:
        return std::clamp(i, 0.0, size - 1.0);
      case TextureWrap::border:
        return std::clamp(i, -1.0, double(size));
      case TextureWrap::mirror: {
        const double from_middle = std::fabs(std::remainder(i + 0.5, 2.0 * size));
        return std::floor(from_middle);
      }
      case TextureWrap::cyclic: {
        const double rest = std::fmod(i, size);
        return rest < 0 ? rest + size : rest;
      }
    }
    unreachable();
  }
  Codes at(double i, double j) const {
    const double column = wrapped(i, texture_.width);
    const double row = wrapped(j, texture_.height);
    if (column < 0 || row < 0 || column >= texture_.width || row >= texture_.height) return config_.border;
    return golden::fetch_texel(texture_, static_cast<std::int64_t>(column), static_cast<std::int64_t>(row));
  }
  static Texel texel(const Codes& c) { return {double(c[0]), double(c[1]), double(c[2]), c[3] / 255.0}; }
  bool reserved(const Codes& c) const {
    return config_.transparent &&
           std::equal(config_.transparent->begin(), config_.transparent->end(), c.begin());
  }

  const Config& config_;
  const Texture& texture_;
};

double fog_factor(const Config& config, const Scene& scene, const IdealPoint& p) {
  if (!scene.fog) return 1;
  const double distance = scene.fog->distance;
  switch (config.fog) {
    case FogMode::none:
      return 1;
    case FogMode::linear:
      return std::clamp(1 - p.s / distance, 0.0, 1.0);
    case FogMode::table: {
      const double x = p.x - scene.width / 2.0;
      const double y = p.y - scene.height / 2.0;
      return std::exp(-p.s * std::sqrt(1 + (x * x + y * y) / (scene.focal * scene.focal)) / distance);
    }
  }
  unreachable();
}

// The code of h at distance s, before rounding.
double configured_code(const Config& config, const Scene& scene, double h, double s) {
  const auto z_max = static_cast<double>(h_max(config));
  switch (config.depth_code) {
    case DepthCode::inverse:
      return h;
    case DepthCode::opengl:
      return z_max - h;
    case DepthCode::linear:
      return z_max * (s - scene.s_min) / (scene.s_max - scene.s_min);
  }
  unreachable();
}

// The depth comparison. h falls with distance, whatever the depth code is.
bool passes(DepthFunc func, double h, double stored_h) {
  const PassingDistances passing = passing_distances(func);
  if (h == stored_h) return passing.equal;
  return h > stored_h ? passing.nearer : passing.farther;
}

// The largest derivative of u and v along x and y, texels per pixel.
double largest_derivative(const IdealTriangle& t, const IdealPoint& point) {
  const auto& v = t.v;
  const long double pixel = std::ldexp(1.0L, t.subpixel_bits);
  const std::array<long double, 2> x{static_cast<long double>(v[1].x - v[0].x) / pixel,
                                     static_cast<long double>(v[2].x - v[0].x) / pixel};
  const std::array<long double, 2> y{static_cast<long double>(v[1].y - v[0].y) / pixel,
                                     static_cast<long double>(v[2].y - v[0].y) / pixel};
  const long double area = x[0] * y[1] - x[1] * y[0];
  // What is linear on the screen: along x, and along y.
  const auto gradient = [&](long double w0, long double w1, long double w2) {
    return std::array{((w1 - w0) * y[1] - (w2 - w0) * y[0]) / area,
                      ((w2 - w0) * x[0] - (w1 - w0) * x[1]) / area};
  };
  const auto q = gradient(1 / v[0].s, 1 / v[1].s, 1 / v[2].s);
  long double most = 0;
  for (const bool down : {false, true}) {
    const auto over_s = [down](const Corner& c) { return (down ? c.v : c.u) / c.s; };
    const auto g = gradient(over_s(v[0]), over_s(v[1]), over_s(v[2]));
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const long double w = down ? point.v : point.u;
      most = std::max(most, std::abs((g[axis] - w * q[axis]) * point.s));
    }
  }
  return static_cast<double>(most);
}

double level_of_zone(const Config& config, const Scene& scene, double s, int levels) {
  int exponent = 0;
  if (std::frexp(scene.s_max, &exponent) == 0.5) --exponent;  // s_max <= 2^exponent
  const double first = std::ldexp(config.lod_first, exponent - 16);
  int zone = 0;
  while (zone < levels - 1 && s >= std::ldexp(first, zone + 1)) ++zone;
  if (zone == levels - 1) return zone;
  return zone + std::max(s / std::ldexp(first, zone) - 1, 0.0);
}

// Before it is held in the chain.
double level_of_detail(const Config& config, const Scene& scene, const IdealTriangle& t,
                       const IdealPoint& point, int levels) {
  double level = config.lod_bias / 16.0;
  switch (config.lod) {
    case LodMode::none:
      break;
    case LodMode::zone_s:
      level += level_of_zone(config, scene, point.s, levels);
      break;
    case LodMode::gradient:
      level += std::log2(std::max(largest_derivative(t, point), 0x1p-60));
      break;
  }
  return level;
}

// From the levels of a chain; gives false where the transparent code kills the fragment.
bool sample_levels(const Config& config, const std::vector<Texture>& levels, double level, double u, double v,
                   Texel& out) {
  const auto sample = [&](double whole, Texel& to) {
    const int l = static_cast<int>(whole);
    return Sampler(config, levels[static_cast<std::size_t>(l)])
        .sample(std::ldexp(u, -l), std::ldexp(v, -l), to);
  };
  if (!mixes_levels(config.mip)) return sample(std::floor(level + 0.5), out);
  const double whole = std::floor(level);
  const double f = level - whole;
  const bool lives = sample(whole, out);
  if (f == 0) return lives;
  Texel coarser{};
  sample(whole + 1, coarser);
  for (std::size_t c = 0; c < out.size(); ++c) out[c] = out[c] * (1 - f) + coarser[c] * f;
  return lives;
}

// The chain of the texture that was asked for last, for functions that have no place to keep it.
const std::vector<Texture>& remembered_levels(const Texture& texture) {
  thread_local std::vector<Texture> levels;
  if (levels.empty() || levels[0].width != texture.width || levels[0].rgba != texture.rgba) {
    levels = golden::mip_levels(texture);
  }
  return levels;
}

// levels: the chain of the triangle's texture, null where it is not at hand.
IdealFragment shade(const Config& config, const Scene& scene, const IdealTriangle& t, const IdealPoint& point,
                    const std::vector<Texture>* levels) {
  IdealFragment out;
  out.point = point;
  out.z = configured_code(config, scene, point.h, point.s);
  out.texel = {255, 255, 255, 1};
  if (t.texture >= 0) {
    const Texture& texture = scene.textures.at(static_cast<std::size_t>(t.texture));
    if (has_lod(config)) {
      const std::vector<Texture>& chain = levels == nullptr ? remembered_levels(texture) : *levels;
      out.lambda = level_of_detail(config, scene, t, point, static_cast<int>(chain.size()));
      const double last = static_cast<double>(chain.size()) - 1;
      out.killed =
          !sample_levels(config, chain, std::clamp(out.lambda, 0.0, last), point.u, point.v, out.texel);
    } else {
      out.killed = !Sampler(config, texture).sample(point.u, point.v, out.texel);
    }
  }
  out.alpha = out.texel[3] * point.shade[3];
  out.killed = out.killed || out.alpha == 0;
  out.fog_factor = fog_factor(config, scene, point);
  for (std::size_t c = 0; c < 3; ++c) {
    out.color[c] = out.texel[c] * point.shade[c];
    const double fog = scene.fog ? scene.fog->color[c] : 0;
    out.fogged[c] = fog + (out.color[c] - fog) * out.fog_factor;
    if (out.fog_factor == 1) out.fogged[c] = out.color[c];
  }
  return out;
}

std::uint8_t nearest_code(double x) {
  return static_cast<std::uint8_t>(std::clamp(std::floor(x + 0.5), 0.0, 255.0));
}

// The factor of a channel, all in 0..1: src and dst of the channel, a and dst_a of the alphas, k and ka of
// the constant colour.
struct IdealShares {
  double src = 0, dst = 0, a = 0, dst_a = 0, k = 0, ka = 0;

  double of(BlendFactor factor, bool is_alpha) const {
    switch (factor) {
      case BlendFactor::zero:
        return 0;
      case BlendFactor::one:
        return 1;
      case BlendFactor::src_color:
        return src;
      case BlendFactor::one_minus_src_color:
        return 1 - src;
      case BlendFactor::dst_color:
        return dst;
      case BlendFactor::one_minus_dst_color:
        return 1 - dst;
      case BlendFactor::src_alpha:
        return a;
      case BlendFactor::one_minus_src_alpha:
        return 1 - a;
      case BlendFactor::dst_alpha:
        return dst_a;
      case BlendFactor::one_minus_dst_alpha:
        return 1 - dst_a;
      case BlendFactor::constant_color:
        return k;
      case BlendFactor::one_minus_constant_color:
        return 1 - k;
      case BlendFactor::constant_alpha:
        return ka;
      case BlendFactor::one_minus_constant_alpha:
        return 1 - ka;
      case BlendFactor::src_alpha_saturate:
        return is_alpha ? 1 : std::min(a, 1 - dst_a);
    }
    unreachable();
  }
};

double ideal_blend(BlendOp op, double src, double dst, double by_src, double by_dst) {
  switch (op) {
    case BlendOp::add:
      return src * by_src + dst * by_dst;
    case BlendOp::subtract:
      return src * by_src - dst * by_dst;
    case BlendOp::reverse_subtract:
      return dst * by_dst - src * by_src;
    case BlendOp::min:
      return std::min(src, dst);
    case BlendOp::max:
      return std::max(src, dst);
  }
  unreachable();
}

class IdealEngine final : public Engine {
 public:
  explicit IdealEngine(const Config& config) : config_(config) {}

  std::string_view name() const override { return "ideal"; }
  const Counters& counters() const override { return counters_; }

  void begin(const Scene& scene) override {
    scene_ = &scene;
    levels_.clear();
    if (has_lod(config_)) {
      check_mip_textures(config_, scene);
      for (const Texture& texture : scene.textures) levels_.push_back(golden::mip_levels(texture));
    }
    counters_ = {};
    const auto pixels = static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height);
    clear_frame(frame_, scene.width, scene.height, scene.background, 0);
    h_.assign(pixels, 0);
    z_.assign(pixels, configured_code(config_, scene, 0, scene.s_max));
    color_.assign(pixels,
                  {double(scene.background[0]), double(scene.background[1]), double(scene.background[2])});
    alpha_.assign(pixels, 255);
    state_ = first_state(config_);
    biased_ = false;
    stale_ = true;
  }

  void set(const StateChange& change, std::int64_t /*next_index*/, Trace* /*trace*/) override {
    state_ = changed_state(state_, change, config_);
    biased_ = biased_ || state_.depth_bias != 0;
    if (state_.stencil_test) need_stencil(frame_);
  }
  void clear(const Clear& clear) override {
    clear_planes(frame_, clear, 0);
    for (std::size_t i = 0; i < color_.size(); ++i) {
      for (std::size_t c = 0; clear.color && c < 3; ++c) color_[i][c] = (*clear.color)[c];
      if (clear.alpha) alpha_[i] = *clear.alpha;
      if (clear.depth) h_[i] = 0;
      if (clear.depth) z_[i] = configured_code(config_, *scene_, 0, scene_->s_max);
    }
    stale_ = true;
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* /*trace*/) override {
    std::int64_t index = first_index;
    for (const Triangle& triangle : triangles) {
      ++counters_.triangles;
      if (const auto t = ideal_triangle(config_, triangle)) {
        back_ = state_.stencil_test && golden::runs_clockwise(config_, triangle);
        draw_one(*t, index);
      } else {
        ++counters_.degenerate;
      }
      ++index;
    }
    stale_ = true;
  }

  // The planes of 8-bit colour and of depth codes are rounded here, and nowhere else.
  const Frame& frame() const override {
    if (!stale_) return frame_;
    frame_.color.resize(4 * color_.size());
    frame_.depth.resize(z_.size());
    const auto z_max = static_cast<double>(h_max(config_));
    for (std::size_t i = 0; i < color_.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) frame_.color[4 * i + c] = nearest_code(color_[i][c]);
      frame_.color[4 * i + 3] = nearest_code(alpha_[i]);
      frame_.depth[i] = static_cast<std::uint32_t>(std::clamp(std::floor(z_[i] + 0.5), 0.0, z_max));
    }
    stale_ = false;
    return frame_;
  }

 private:
  void draw_one(const IdealTriangle& t, std::int64_t index) {
    const auto [left, right] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
    const std::int64_t x_first = std::max<std::int64_t>(0, left >> t.subpixel_bits);
    const std::int64_t x_last = std::min<std::int64_t>(frame_.width - 1, right >> t.subpixel_bits);
    const std::int64_t y_first = std::max<std::int64_t>(0, t.v[0].y >> t.subpixel_bits);
    const std::int64_t y_last = std::min<std::int64_t>(frame_.height - 1, t.v[2].y >> t.subpixel_bits);
    if (x_first > x_last || y_first > y_last) return;
    // The areas are linear in the point, so one pixel to the right adds a constant, exactly.
    const Areas here = areas_at(t, centre_of(t, 0, 0));
    const Areas next = areas_at(t, centre_of(t, 1, 0));
    for (std::int64_t y = y_first; y <= y_last; ++y) {
      Areas areas = areas_at(t, centre_of(t, x_first, y));
      bool entered = false;
      for (std::int64_t x = x_first; x <= x_last; ++x) {
        if (covers(t, areas, config_.fill_rule)) {
          entered = true;
          pixel(t, index, areas, x, y);
        } else if (entered) {
          break;  // a triangle is convex
        }
        for (std::size_t i = 0; i < 3; ++i) areas.part[i] += next.part[i] - here.part[i];
      }
    }
  }

  void pixel(const IdealTriangle& t, std::int64_t index, const Areas& areas, std::int64_t x, std::int64_t y) {
    ++counters_.fragments;
    ++counters_.covered;
    if (is_masked(x, y)) {
      ++counters_.masked;
      return;
    }
    const auto i = static_cast<std::size_t>(y * frame_.width + x);
    const IdealPoint point = point_at_centre(config_, *scene_, t, areas, x, y);
    const bool late = is_late(state_.depth_when);
    if (!late && !depth_passes(point, i, x, y)) return;
    const std::vector<Texture>* levels =
        t.texture < 0 || levels_.empty() ? nullptr : &levels_[static_cast<std::size_t>(t.texture)];
    const IdealFragment fragment = shade(config_, *scene_, t, point, levels);
    if (fragment.killed ||
        !golden::holds<double>(state_.alpha_func, 255 * fragment.alpha, state_.alpha_ref)) {
      ++counters_.killed;
      return;
    }
    if (late && !depth_passes(point, i, x, y)) return;
    ++counters_.written;
    if (state_.depth_write) {
      // No distance is beyond s_max, the cleared buffer's, but h of one at s_max may round below 0.
      h_[i] = std::max(point.h, 0.0);
      z_[i] = code_of(point);
    }
    if (!state_.color_write) return;
    blend(fragment, i);
    frame_.u[i] = point.u;
    frame_.v[i] = point.v;
    frame_.triangle[i] = static_cast<std::int32_t>(index);
  }

  bool is_masked(std::int64_t x, std::int64_t y) const {
    const bool inside = x >= state_.scissor_left && x < state_.scissor_right && y >= state_.scissor_top &&
                        y < state_.scissor_bottom;
    return !inside || (state_.stipple >> (y % 4 * 8 + x % 8)) % 2 == 0;
  }
  // The unquantised code with the bias, within the register.
  double code_of(const IdealPoint& point) const {
    const double z = configured_code(config_, *scene_, point.h, point.s);
    if (state_.depth_bias == 0) return z;
    return std::clamp(z + state_.depth_bias, 0.0, static_cast<double>(h_max(config_)));
  }
  bool depth_passes(const IdealPoint& point, std::size_t i, std::int64_t x, std::int64_t y) {
    bool pass = false;
    if (biased_) {
      const double sign = nearer_is_larger(config_.depth_code) ? 1 : -1;
      pass = passes(state_.depth_func, sign * code_of(point), sign * z_[i]);
    } else {
      pass = passes(state_.depth_func, std::max(point.h, 0.0), h_[i]);
    }
    if (state_.stencil_test) {
      const StencilRecord tested =
          golden::stencil(state_, back_, {.x = x, .y = y, .pass = pass ? 1 : 0}, frame_.stencil[i]);
      frame_.stencil[i] = static_cast<std::uint8_t>(tested.value);
      if (tested.pass == 0) ++counters_.stencil_failed;
      pass = pass && tested.pass == 1;
    }
    if (pass) ++counters_.depth_passed;
    return pass;
  }
  void blend(const IdealFragment& fragment, std::size_t i) {
    const double a = std::min(fragment.alpha, 1.0);
    const std::array<int, 3> constant{state_.blend_red, state_.blend_green, state_.blend_blue};
    const auto code = [](double x) { return static_cast<unsigned>(nearest_code(x)); };
    const double dst_a = alpha_[i] / 255;
    const double ka = state_.blend_alpha / 255.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double src = fragment.fogged[c];
      double& dst = color_[i][c];
      if (state_.logic_op != LogicOp::none) {
        dst = golden::logic(state_.logic_op, code(src), code(dst));
        continue;
      }
      const IdealShares shares{std::clamp(src / 255, 0.0, 1.0), dst / 255, a, dst_a, constant[c] / 255.0, ka};
      const double by_src = shares.of(state_.blend_src, false);
      const double by_dst = shares.of(state_.blend_dst, false);
      // As a mix where it is one, so that an opaque fragment's colour is its own.
      const bool mix = state_.blend_op == BlendOp::add && by_src + by_dst == 1;
      if (mix) {
        dst = by_src == 1 ? src : dst + (src - dst) * by_src;
      } else {
        dst = std::clamp(ideal_blend(state_.blend_op, src, dst, by_src, by_dst), 0.0, 255.0);
      }
    }
    if (state_.logic_op != LogicOp::none) {
      alpha_[i] = golden::logic(state_.logic_op, code(255 * a), code(alpha_[i]));
      return;
    }
    const IdealShares shares{a, dst_a, a, dst_a, ka, ka};
    alpha_[i] = std::clamp(
        ideal_blend(state_.blend_alpha_op, 255 * a, alpha_[i], shares.of(state_.blend_alpha_src, true),
                    shares.of(state_.blend_alpha_dst, true)),
        0.0, 255.0);
  }

  Config config_;
  const Scene* scene_ = nullptr;
  std::vector<std::vector<Texture>> levels_;  // with mip chains: of each texture
  std::vector<double> h_, z_;
  std::vector<std::array<double, 3>> color_;
  std::vector<double> alpha_;  // of the picture, 0..255
  DrawState state_;
  bool biased_ = false;  // depth.bias was not 0 once: the depth test is on codes
  bool back_ = false;    // the triangle is a back face
  mutable Frame frame_;
  mutable bool stale_ = true;
  Counters counters_;
};

}  // namespace

std::optional<IdealTriangle> ideal_triangle(const Config& config, const Triangle& triangle) {
  const golden::Quantizer<long double> snap(config.coordinate_format());
  IdealTriangle out;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& in = triangle.v[i];
    Corner& corner = out.v[i];
    corner.x = snap.raw(snap(in.x));
    corner.y = snap.raw(snap(in.y));
    corner.s = in.s;
    corner.u = in.u;
    corner.v = in.v;
    std::copy(in.c.begin(), in.c.end(), corner.c.begin());
  }
  std::stable_sort(out.v.begin(), out.v.end(),
                   [](const Corner& a, const Corner& b) { return a.y < b.y || (a.y == b.y && a.x < b.x); });
  const Wide area = area_of(point_of(out.v[0]), point_of(out.v[1]), point_of(out.v[2]));
  if (area == 0) return std::nullopt;
  out.subpixel_bits = config.subpixel_bits;
  out.mid_right = area > 0;
  out.texture = triangle.texture;
  return out;
}

bool ideal_covers(const Config& config, const IdealTriangle& triangle, std::int64_t x, std::int64_t y) {
  return covers(triangle, areas_at(triangle, centre_of(triangle, x, y)), config.fill_rule);
}

IdealPoint ideal_point(const Config& config, const Scene& scene, const IdealTriangle& triangle, double x,
                       double y) {
  using golden::Quad;
  // Exact in 113 bits for points on a grid of up to 2^-30 pixel.
  const Quad unit = golden::pow2<Quad>(-triangle.subpixel_bits);
  const auto part = [&](const Corner& a, const Corner& b) {
    return (Quad(b.x) - Quad(a.x)) * unit * (Quad(y) - Quad(a.y) * unit) -
           (Quad(b.y) - Quad(a.y)) * unit * (Quad(x) - Quad(a.x) * unit);
  };
  const auto& v = triangle.v;
  const std::array<Quad, 3> parts{part(v[1], v[2]), part(v[2], v[0]), part(v[0], v[1])};
  const Quad whole = parts[0] + parts[1] + parts[2];
  IdealPoint out =
      blend(config, scene, triangle,
            {static_cast<long double>(parts[0] / whole), static_cast<long double>(parts[1] / whole),
             static_cast<long double>(parts[2] / whole)});
  out.x = x;
  out.y = y;
  return out;
}

IdealPoint ideal_on_edge(const Config& config, const Scene& scene, const IdealTriangle& triangle, int edge,
                         std::int64_t y) {
  const std::size_t from = edge == 2 ? 1 : 0;
  const std::size_t to = edge == 1 ? 1 : 2;
  const Corner& a = triangle.v[from];
  const Corner& b = triangle.v[to];
  const long double unit = std::ldexp(1.0L, -triangle.subpixel_bits);
  const long double below = static_cast<long double>(y) + 0.5L - static_cast<long double>(a.y) * unit;
  const long double t = below / (static_cast<long double>(b.y - a.y) * unit);
  std::array<long double, 3> weight{};
  weight[from] = 1 - t;
  weight[to] = t;
  IdealPoint out = blend(config, scene, triangle, weight);
  out.x =
      static_cast<double>((static_cast<long double>(a.x) + static_cast<long double>(b.x - a.x) * t) * unit);
  out.y = static_cast<double>(y) + 0.5;
  return out;
}

IdealPoint ideal_at_vertex(const Config& config, const Scene& scene, const IdealTriangle& triangle,
                           int vertex) {
  const auto i = static_cast<std::size_t>(vertex);
  std::array<long double, 3> weight{};
  weight.at(i) = 1;
  IdealPoint out = blend(config, scene, triangle, weight);
  out.x = std::ldexp(static_cast<double>(triangle.v[i].x), -triangle.subpixel_bits);
  out.y = std::ldexp(static_cast<double>(triangle.v[i].y), -triangle.subpixel_bits);
  return out;
}

IdealFragment ideal_at(const Config& config, const Scene& scene, const IdealTriangle& triangle,
                       std::int64_t x, std::int64_t y) {
  const Areas areas = areas_at(triangle, centre_of(triangle, x, y));
  return shade(config, scene, triangle, point_at_centre(config, scene, triangle, areas, x, y), nullptr);
}

std::unique_ptr<Engine> make_ideal(const Config& config) { return std::make_unique<IdealEngine>(config); }

}  // namespace bitspan
