// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/simd/shade.cpp"
#include "config/modes.hpp"
#include "hwy/foreach_target.h"
// After foreach_target: each target's own.
#include "model/simd/shade-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

ShadeKernels<std::int32_t> kernels32() { return shade_table<std::int32_t, nullptr>(); }
ShadeKernels<std::int64_t> kernels64() { return shade_table<std::int64_t, nullptr>(); }

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>
#include <cmath>

#include "model/numeric/ratio.hpp"
#include "model/simd/pixel_tests.hpp"
#include "model/simd/targets.hpp"

namespace bitspan::model {
namespace {

HWY_EXPORT(kernels32);
HWY_EXPORT(kernels64);

// ---------------------------------------------------------------- what lanes hold

// Q of a value on this grid onto the format, in lanes of `bits` bits: the value, on the finer of both
// grids, with one bit kept back for rounding.
bool narrows_in(int bits, Grid value, const Format& to) {
  const int shift = value.fraction - to.fraction();
  return aligned(value, to.fraction()).bits() <= bits - 1 && std::abs(shift) <= bits - 2;
}
bool held_in(int bits, const Format& f) { return signed_grid(f).bits() <= bits; }

// What a filter that weighs texels computes besides.
bool fits_weighed(const Config& c, int bits) {
  using F = FormatId;
  const auto of = [&](F id) { return signed_grid(c.format(id)); };
  const auto narrows = [&](Grid value, F id) { return narrows_in(bits, value, c.format(id)); };
  const Grid below = of(F::span_uv) - Grid{0, 1, true};
  const Grid share = integer_grid(1) - of(F::texture_frac);
  const auto mixes = [&](Grid v, F id) { return narrows(v * share + v * share, id); };
  return below.bits() <= bits - 1 && narrows(Grid{0, below.fraction, true}, F::texture_frac) &&
         mixes(integer_grid(8), F::texture_mix) && mixes(of(F::texture_mix), F::texture_mix) &&
         mixes(of(F::texture_alpha), F::texture_alpha);
}

bool fits(const Config& c, FogMode fog, int bits) {
  using F = FormatId;
  const auto of = [&](F id) { return signed_grid(c.format(id)); };
  const auto narrows = [&](Grid value, F id) { return narrows_in(bits, value, c.format(id)); };
  for (const F id : {F::span_uv, shade_factor(c), F::texture_frac, F::texture_mix, F::texture_color,
                     F::texture_alpha, F::fog_factor, F::fog_color, F::merge_color}) {
    if (!held_in(bits, c.format(id))) return false;
  }
  const Grid code = integer_grid(8);
  const Grid uv = of(F::span_uv);
  // floor(u) and the next integer.
  if (uv.integer + 1 > bits - 2 || std::abs(uv.fraction) > bits - 2) return false;
  bool fit = narrows(code, F::texture_mix) && narrows(integer_grid(1), F::texture_alpha) &&
             narrows(of(F::texture_mix) * of(shade_factor(c)), F::texture_color) &&
             narrows(of(F::texture_alpha) * of(shade_factor(c)), F::texture_alpha);
  if (weighs_texels(c.filter)) fit = fit && fits_weighed(c, bits);
  const auto mixes_code = [&](F color, F share, F to) {
    return narrows((of(color) - code) * of(share) + code * of(share), to);
  };
  fit = fit && narrows(integer_grid(1), F::fog_factor) && narrows(of(F::texture_color), F::fog_color) &&
        narrows(of(F::fog_color), F::merge_color) &&
        mixes_code(F::fog_color, F::texture_alpha, F::merge_color);
  if (has_fog(fog)) {
    fit = fit && mixes_code(F::texture_color, F::fog_factor, F::fog_color);
  }
  if (is_linear_in_distance(fog)) {
    // In lanes of 64 bits whatever the others are.
    fit = fit && fits_int64(of(F::span_h) + of(F::setup_b)) && held_in(64, c.format(F::fog_scale));
  }
  return fit;
}

// What shade_any computes besides.
bool fits_any(const Config& c, int bits) {
  using F = FormatId;
  const auto of = [&](F id) { return signed_grid(c.format(id)); };
  const auto narrows = [&](Grid value, F id) { return narrows_in(bits, value, c.format(id)); };
  // A factor is an alpha, a code's share, or 1 without it.
  const Grid share{2, std::max(of(F::texture_alpha).fraction, 8), true};
  const Grid color = aligned(of(F::fog_color), 0);
  const Grid code = integer_grid(8);
  bool fit = fits_weighed(c, bits) && narrows(color * share + code * share, F::merge_color) &&
             narrows(code * share + code * share, F::merge_color) && color.bits() <= bits - 2 &&
             (integer_grid(10) * aligned(of(F::texture_alpha), 0)).bits() <= bits - 2;
  if (has_lod(c)) {
    const Grid u = of(F::span_uv);
    const Grid below{0, std::max(u.fraction, 1) + max_mip_level, true};
    const Grid f = of(F::lod_frac);
    const Grid rest = integer_grid(1) - f;
    const auto mixes = [&](F id) { return narrows(of(id) * rest + of(id) * f, id); };
    fit = fit && held_in(bits, c.format(F::lod_frac)) && below.bits() <= bits - 2 &&
          aligned(u, 1).bits() <= bits - 2 && narrows(below, F::texture_frac) && mixes(F::texture_mix) &&
          mixes(F::texture_alpha);
  }
  return fit;
}

// The table of shares has a raw value of texture.mix each.
constexpr int most_share_bits = 14;

// What the second texture unit computes besides.
bool fits_second(const Config& c, int bits) {
  using F = FormatId;
  const auto of = [&](F id) { return signed_grid(c.format(id)); };
  const auto narrows = [&](Grid value, F id) { return narrows_in(bits, value, c.format(id)); };
  const Grid first = of(F::texture_color), texel = of(F::texture_mix);
  const Grid share = aligned(of(F::texture_alpha), 0);
  const Grid rest = integer_grid(1) - share;
  const Grid code = integer_grid(8);
  bool fit = c.format(F::texture_mix).word <= most_share_bits &&
             narrows(first * rest + texel * share, F::texture_color) &&
             narrows(first * rest + code * share, F::texture_color) &&
             narrows(aligned(first + texel, 0), F::texture_color) &&
             narrows(of(F::texture_alpha) * of(F::texture_alpha), F::texture_alpha);
  for (int k = 0; k <= 2; ++k) {
    const Grid product = first * of(F::texture_alpha);
    fit = fit && narrows(aligned(Grid{product.integer + k, product.fraction - k, true}, 0), F::texture_color);
  }
  return fit;
}

// What light computes besides.
bool fits_light(const Config& c, int bits) {
  const Format& color = c.format(FormatId::texture_color);
  const Format& value = c.format(FormatId::light_value);
  const Grid product = grid_of(color) * grid_of(value);
  return held_in(bits, value) && narrows_in(bits, {product.integer, product.fraction, true}, color);
}

// Whether lanes of that kind hold what `fits` asks about lanes of so many bits.
bool holds(bool fits(const Config&, int bits), const Config& config, ShadeLanes lanes) {
  switch (lanes) {
    case ShadeLanes::int32:
      return fits(config, 32);
    case ShadeLanes::int64:
      return fits(config, 64);
    case ShadeLanes::scalar:
      return true;
  }
  unreachable();
}

// What light computes of a fragment's brightness, in lanes of 64 bits; the place of a point and the squares
// of lengths in 128.
bool fits_brightness(const Config& c) {
  using F = FormatId;
  const auto of = [&](F id) { return signed_grid(c.format(id)); };
  const auto narrows = [&](Grid value, F id) {
    return held_in(64, c.format(id)) && narrows_in(64, value, c.format(id));
  };
  const RootUnit& unit = c.light_root;
  const int of_y = std::max(unit.table_bits, unit.internal_bits) + 2;
  if (std::max(unit.operand_bits + 2 + of_y, unit.internal_bits + 3 + of_y) > 62) return false;
  bool fit = narrows(Grid{1, of_y - 2, true}, F::light_root);
  // The shift of a part of a vector differs from lane to lane, and rounding has a place more.
  const auto becomes_unit = [&](Grid x, F id) {
    return fits_int64(x) && (x * of(F::light_root)).bits() <= 61 && held_in(64, c.format(id));
  };
  fit = fit && becomes_unit(of(F::normal_value), F::light_normal);
  if (has_relief(c)) {
    fit = fit && becomes_unit(of(F::relief_value) - of(F::span_uv), F::light_direction) &&
          becomes_unit(scaled(of(F::texture_mix), 1) - aligned(integer_grid(8), of(F::texture_mix).fraction),
                       F::light_normal);
  }
  if (has_light_points(c)) {
    const Grid pixels{17, 1, true};
    fit = fit && fits_int64(pixels * of(F::light_scale)) && narrows(of(F::distance_s), F::light_position) &&
          fits_int64(of(F::span_h) + of(F::setup_b)) && fits_int64(of(F::distance_a)) &&
          becomes_unit(of(F::light_position) - of(F::light_position), F::light_direction);
  }
  const Grid normal = of(F::light_normal), direction = of(F::light_direction), cosine = of(F::light_cosine);
  const Grid both = normal * direction;
  const Grid specular = of(F::light_specular), value = of(F::light_value);
  const Grid within{1, std::max(cosine.fraction - c.light_index_bits, 0), true};
  // The shift of what Inv multiplies differs from lane to lane, too.
  const auto divides = [&](Grid x, Grid by, F into) {
    const Grid near = scaled(x, -(by.fraction + 1));
    return held_in(64, c.format(into)) && x.bits() <= 61 &&
           aligned(near, c.format(into).fraction()).bits() <= 61;
  };
  const Grid inverse = of(F::light_inverse), distance = of(F::light_distance);
  if (has_lunar(c) || has_light_fall(c)) {
    fit = fit && narrows(of(F::light_root) * of(F::light_root), F::light_inverse);
  }
  if (has_lunar(c)) {
    fit = fit && narrows(Grid{1, 0, true} + of(F::light_lunar) * normal, F::light_lunar) &&
          divides(cosine * inverse, of(F::light_lunar), F::light_cosine);
  }
  if (has_light_fall(c)) {
    const Grid place = of(F::light_position);
    const Grid part = (place - place) * direction;
    fit = fit && narrows(part + part + part, F::light_position) &&
          divides(place * of(F::light_scale), Grid{0, reach_octaves, false}, F::light_distance) &&
          narrows(distance * distance + distance, F::light_distance) &&
          divides(inverse, distance, F::light_fall) &&
          narrows(value * of(F::light_fall) + value, F::light_value);
  }
  if (has_light_shadow(c)) {
    fit = fit && narrows(value * of(F::texture_alpha), F::light_value) &&
          narrows(value + value, F::light_value);
  }
  return fit && held_in(64, c.format(F::light_direction)) && narrows(both + both + both, F::light_cosine) &&
         narrows(direction - scaled(cosine * normal, -1), F::light_cosine) &&
         narrows(specular + (specular - specular) * within, F::light_specular) &&
         narrows(value + value * cosine + value * specular, F::light_value);
}

// ---------------------------------------------------------------- textures and zones

// The columns or rows that an axis of a texture takes.
struct ImageAxis {
  std::int32_t before = 0, all = 0;
};
ImageAxis image_axis(std::int32_t size, TextureWrap wrap, bool pairs) {
  const bool colored = has_border_color(wrap);
  // At an edge where the texture ends, i = -1 is a pair of its own: (0, 0), or border and 0. In front of the
  // latter there is a pair of two borders.
  const std::int32_t before = colored ? (pairs ? 2 : 1) : pairs && stops_at_edge(wrap) ? 1 : 0;
  const std::int32_t after = (pairs ? 1 : 0) + (colored ? 1 : 0);
  // A copy that is turned round follows, where pairs go over its edges.
  const std::int32_t copies = pairs && mirrors(wrap) ? 2 : 1;
  return {before, copies * size + before + after};
}

// The words of an image, from top to bottom: word_at(i, j) is that of a texel, `border` of what is outside.
template <class WordAt>
void fill_words(const ImageAxis& across, const ImageAxis& down, std::uint32_t border, const WordAt& word_at,
                ShadeTexture& t) {
  const auto inside = [](std::int32_t i, std::int32_t size, TextureWrap wrap) {
    return static_cast<std::int32_t>(HWY_STATIC_DISPATCH(wrapped)(i, size, wrap));
  };
  std::vector<std::int32_t> columns(static_cast<std::size_t>(across.all));
  for (std::int32_t x = 0; x < across.all; ++x) {
    columns[static_cast<std::size_t>(x)] = inside(x - across.before, t.width, t.by.wrap_u);
  }
  auto out = t.words.begin();
  for (std::int32_t y = 0; y < down.all; ++y) {
    const std::int32_t j = inside(y - down.before, t.height, t.by.wrap_v);
    const bool is_row = j >= 0 && j < t.height;
    for (const std::int32_t i : columns) *out++ = is_row && i >= 0 && i < t.width ? word_at(i, j) : border;
  }
}

std::uint32_t colour_word(const TexelCodes& p) {
  return p[0] | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 | std::uint32_t{p[3]} << 24;
}

// stage: for its border and its reserved colour. compared: depth words of a texture that has some.
ShadeTexture prepare_image(const TextureStage& stage, const TexelLookup& by, const Texture& source,
                           bool compared) {
  ShadeTexture t;
  t.by = by;
  t.source = &source;
  t.width = source.width;
  t.height = source.height;
  const bool pairs = weighs_texels(by.filter);
  const ImageAxis across = image_axis(t.width, by.wrap_u, pairs);
  const ImageAxis down = image_axis(t.height, by.wrap_v, pairs);
  t.border_u = across.before;
  t.border_v = down.before;
  t.stride = across.all;
  t.words.assign(static_cast<std::size_t>(t.stride) * static_cast<std::size_t>(down.all) + 2, 0);
  t.opaque = t.never_killed = true;
  if (compared && source.format == TexelFormat::depth) {
    // Lookups that have a border are not compared in lanes.
    fill_words(
        across, down, 0,
        [&](std::int32_t i, std::int32_t j) { return static_cast<std::uint32_t>(depth_word(source, i, j)); },
        t);
    return t;
  }
  fill_words(
      across, down, colour_word(stage.border),
      [&](std::int32_t i, std::int32_t j) { return colour_word(texel_of(source, i, j)); }, t);
  const std::span<const std::uint32_t> words(t.words.begin(), t.words.end() - 2);
  t.opaque = std::ranges::all_of(words, [](std::uint32_t word) { return word >> 24 == 255; });
  if (stage.transparent) {
    const auto& c = *stage.transparent;
    const std::uint32_t reserved = colour_word({c[0], c[1], c[2], 0});
    t.has_reserved =
        std::ranges::any_of(words, [&](std::uint32_t word) { return (word & 0xffffffU) == reserved; });
  }
  return t;
}

// Row by row; the zone grows with the distance from the middle column.
std::vector<std::uint8_t> zones_of(const FogStage& fog) {
  const auto width = static_cast<std::size_t>(fog.zones.width);
  const auto height = static_cast<std::size_t>(fog.zones.height);
  std::vector<std::uint8_t> zones(width * height + 64);
  for (std::size_t y = 0; y < height; ++y) {
    std::uint8_t* row = zones.data() + y * width;
    if (y > height / 2) {
      // As far from the middle as the row above it.
      std::copy_n(zones.data() + (height - 1 - y) * width, width, row);
      continue;
    }
    std::size_t x = 0;
    while (x < width) {
      // To the last pixel of the zone, on this half of the row.
      const int zone = zone_of(fog.zones, std::int64_t(x), std::int64_t(y));
      const bool left = x < width / 2;
      std::size_t low = x;
      std::size_t high = left ? width / 2 : width;
      while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (zone_of(fog.zones, std::int64_t(middle), std::int64_t(y)) == zone ? low : high) = middle;
      }
      std::fill(row + x, row + high, static_cast<std::uint8_t>(zone));
      x = high;
    }
  }
  return zones;
}

bool fits_int32(const std::vector<std::int64_t>& values) {
  return std::all_of(values.begin(), values.end(), [](std::int64_t v) { return v == std::int32_t(v); });
}

}  // namespace

ShadeLanes lanes_for_shading(const Config& config, FogMode fog) {
  return fits(config, fog, 32)   ? ShadeLanes::int32
         : fits(config, fog, 64) ? ShadeLanes::int64
                                 : ShadeLanes::scalar;
}

bool holds_any_shading(const Config& config, ShadeLanes lanes) { return holds(fits_any, config, lanes); }

bool branch_free_shade(const ShadeFormats& formats) {
  const TextureStage& t = formats.texture;
  return t.mix.fraction >= 0 && t.mix.max >= std::int64_t{255} << t.mix.fraction && is_branch_free(t.frac) &&
         is_branch_free(t.mix) && is_branch_free(t.color) && is_branch_free(t.alpha) &&
         is_branch_free(formats.fog.color) && is_branch_free(formats.merge.color);
}

bool holds_light(const Config& config, ShadeLanes lanes) { return holds(fits_light, config, lanes); }

bool holds_second_texture(const Config& config, ShadeLanes lanes) {
  return holds(fits_second, config, lanes);
}

namespace {

// A texture of the scene, and its levels.
void prepare_texture(const ShadePlan& plan, const Pipeline& pipeline, const Scene& scene, std::size_t index,
                     ShadeTextures& to) {
  ShadeTexture& image = to.whole[index];
  image = prepare_image(plan.formats.texture, to.by, scene.textures[index], to.compared);
  image.is_ready = true;
  image.never_killed =
      !image.has_reserved && std::none_of(image.words.begin(), image.words.end() - 2,
                                          [&](std::uint32_t word) { return plan.alpha64[word >> 24] == 0; });
  if (to.levels.empty()) return;
  const MipChain& chain = pipeline.mip_chains.all()[index];
  to.levels[index].clear();
  for (std::size_t k = 1; k < chain.size(); ++k) {
    to.levels[index].push_back(prepare_image(plan.formats.texture, to.by, chain[k], to.compared));
  }
}

// Returns the index of the textures that are looked up so, of which none is ready at first.
std::size_t textures_by(ShadePlan& plan, const Pipeline& pipeline, const Scene& scene, const TexelLookup& by,
                        bool compared) {
  const auto known = std::ranges::find_if(
      plan.textures, [&](const ShadeTextures& t) { return t.by == by && t.compared == compared; });
  if (known == plan.textures.end()) {
    plan.textures.push_back({by, compared, std::vector<ShadeTexture>(scene.textures.size()),
                             std::vector<std::vector<ShadeTexture>>(pipeline.mip_chains.all().size())});
    return plan.textures.size() - 1;
  }
  return static_cast<std::size_t>(known - plan.textures.begin());
}

// What depends on the view.
void prepare_view(ShadePlan& plan, const Pipeline& pipeline, const Config& config, const Scene& scene) {
  const FogMode fog = pipeline.fog.mode;
  // Even with a copy that is turned round both ways.
  const bool small = std::ranges::all_of(scene.textures, [](const Texture& t) {
    return 4 * (std::int64_t{t.width} + 2) * (std::int64_t{t.height} + 2) < std::int64_t{1} << 28;
  });
  plan.held_in = small ? lanes_for_shading(config, fog) : ShadeLanes::scalar;
  plan.holds_any = holds_any_shading(config, plan.held_in);
  plan.holds_second = plan.holds_any && holds_second_texture(config, plan.held_in);
  plan.holds_lit = plan.holds_any && holds_light(config, plan.held_in);
  plan.holds_brightness = fits_brightness(config);
  const Grid normal = signed_grid(config.format(FormatId::normal_value));
  plan.normals_fit_int64 = fits_int64(normal * normal + normal * normal + normal * normal);
  if (!has_fog_table(fog)) return;
  plan.zones = zones_of(pipeline.fog);
  plan.fog_table32.clear();
  if (fits_int32(pipeline.fog.table)) {
    plan.fog_table32.assign(pipeline.fog.table.begin(), pipeline.fog.table.end());
    plan.fog_table32.resize(plan.fog_table32.size() + 16);
  }
}

}  // namespace

bool holds_state(const ShadePlan& plan, const Pipeline& pipeline) {
  if (pipeline.state.translucency_pass != TranslucencyPass::all) return false;
  if (pipeline.light.is_on && !plan.holds_lit) return false;
  if (pipeline.channels.any() && !pipeline.channels.fits_int64()) return false;
  if (!pipeline.texture_second.is_on()) return plan.holds_any;
  if (!plan.holds_second || !pipeline.project.is_on) return plan.holds_second;
  // A border's texels are colours, which a comparison takes as they are.
  const TexelLookup& by = pipeline.texture_second.fetch.lookup;
  return pipeline.project.fits_lanes() &&
         !(pipeline.texture_second.compares && (has_border_color(by.wrap_u) || has_border_color(by.wrap_v)));
}

ShadePlan prepare_shade(const Pipeline& pipeline, const Config& config, const Scene& scene) {
  ShadePlan plan;
  plan.formats = shade_formats(config);
  const TextureStage& t = plan.formats.texture;
  plan.branch_free = branch_free_shade(plan.formats);
  for (int a = 0; a < 256; ++a) {
    plan.alpha64.push_back(quantize_ratio(a, 255, 0, t.alpha, NoObserve{}));
  }
  if (fits_int32(plan.alpha64)) {
    plan.alpha32.assign(plan.alpha64.begin(), plan.alpha64.end());
  }
  prepare_view(plan, pipeline, config, scene);
  ShadePlan::ShadeChain& chain = plan.chain;
  chain.edges = !has_plane_rows(config.perspective) && !has_setup_plane(config);
  chain.edge_offset = offset_value(config.start_offset.edge_shade, config.format(FormatId::edge_shade));
  chain.span_offset = offset_value(config.start_offset.span_shade, config.format(FormatId::span_shade));
  chain.vertex = make_register(config, FormatId::setup_shade);
  chain.edge_acc = make_register(config, FormatId::edge_shade_acc);
  chain.edge = make_register(config, FormatId::edge_shade);
  chain.span_acc = make_register(config, FormatId::span_shade_acc);
  chain.span = make_register(config, FormatId::span_shade);
  return plan;
}

void update_shade(ShadePlan& plan, const Pipeline& pipeline, const Config& config, const DrawnScene& scene,
                  std::uint64_t since) {
  for (ShadeTextures& textures : plan.textures) {
    for (std::size_t i = 0; i < textures.whole.size(); ++i) {
      textures.whole[i].source = &scene->textures[i];
      if (scene.texture_version(i) > since) textures.whole[i].is_ready = false;
    }
  }
  if (scene.view_version() > since) prepare_view(plan, pipeline, config, *scene);
}

void need_texture(ShadePlan& plan, const Pipeline& pipeline, const Scene& scene, std::size_t unit,
                  int texture) {
  if (texture < 0 || texture >= std::ssize(scene.textures)) return;
  const auto index = static_cast<std::size_t>(texture);
  for (const std::size_t set : {plan.of_unit[unit], plan.magnified_of_unit[unit]}) {
    ShadeTextures& textures = plan.textures[set];
    if (!textures.whole[index].is_ready) prepare_texture(plan, pipeline, scene, index, textures);
  }
}

void select_textures(ShadePlan& plan, const Pipeline& pipeline, const Scene& scene) {
  const auto select = [&](std::size_t unit, const TextureStage& stage, bool compared) {
    plan.of_unit[unit] = textures_by(plan, pipeline, scene, stage.lookup, compared);
    plan.magnified_of_unit[unit] = textures_by(plan, pipeline, scene, stage.magnified, compared);
  };
  select(0, pipeline.texture, false);
  const TextureSecondStage& second = pipeline.texture_second;
  if (second.is_on()) {
    select(1, second.fetch, second.compares);
    need_texture(plan, pipeline, scene, 1, pipeline.state.texture1);
  }
}

void prepare_second_texture(ShadePlan& plan) {
  if (plan.held_in == ShadeLanes::scalar || !plan.shares64.empty()) return;
  const TextureStage& t = plan.formats.texture;
  for (std::int64_t v = t.mix.min; v <= t.mix.max; ++v) {
    plan.shares64.push_back(quantize_ratio(v, 255, -t.mix.fraction, t.alpha, NoObserve{}));
  }
  if (fits_int32(plan.shares64)) plan.shares32.assign(plan.shares64.begin(), plan.shares64.end());
}

// Slopes and gradients of equal values are 0, so what is left of the walks is their start and the narrowings.
std::int64_t constant_shade(const ShadePlan& plan, std::int64_t vertex) {
  const ShadePlan::ShadeChain& chain = plan.chain;
  const auto start = [](Exact x, Exact offset, const Register& acc) {
    return value_of(quantize(x + offset, acc, NoObserve{}), acc);
  };
  Exact x = value_of(vertex, chain.vertex);
  if (chain.edges) {
    x = value_of(quantize(start(x, chain.edge_offset, chain.edge_acc), chain.edge, NoObserve{}), chain.edge);
  }
  return quantize(start(x, chain.span_offset, chain.span_acc), chain.span, NoObserve{});
}

std::int64_t alpha_of(const ShadePlan& plan, std::int64_t shade) {
  const TextureStage& stage = plan.formats.texture;
  // Mixes of equal alphas are that alpha.
  const Exact one = value_of(plan.alpha64[255], stage.alpha);
  return quantize(one * value_of(shade, stage.shade), stage.alpha, NoObserve{});
}

namespace {

// Whether a texture and its levels are opaque, and no texel of theirs kills.
bool hides(const ShadeTextures& textures, int texture) {
  const auto index = static_cast<std::size_t>(texture);
  const auto image_hides = [](const ShadeTexture& image) {
    return image.opaque && image.never_killed && !image.has_reserved;
  };
  return image_hides(textures.whole[index]) &&
         (textures.levels.empty() || std::ranges::all_of(textures.levels[index], image_hides));
}

}  // namespace

bool may_show_through(const ShadePlan& plan, int texture, std::int64_t a0, std::int64_t a1, std::int64_t a2) {
  if (a0 != a1 || a1 != a2) return true;
  if (texture >= 0 && !(hides(plan.textures_of(0), texture) && hides(plan.magnified_of(0), texture))) {
    return true;
  }
  return alpha_of(plan, constant_shade(plan, a0)) < HWY_STATIC_DISPATCH(opaque_alpha)(plan.formats.merge);
}

bool kills_by_alpha_alone(const Pipeline& pipeline) {
  const TextureStage& stage = pipeline.texture;
  return stage.is_last && stage.alpha_test.func == CompareFunc::always && !pipeline.has_lod &&
         stage.chroma.test == ChromaTest::none;
}

bool replaces_pixels(const ShadePlan& plan, const Pipeline& pipeline) {
  const DrawState& state = pipeline.state;
  const TextureStage& first = pipeline.texture;
  const TextureSecondStage& second = pipeline.texture_second;
  if (is_late(state.depth_when) || !depth_decides_alone(pipeline) || !write_mask(state).depth) return false;
  if (first.alpha_test.func != CompareFunc::always || first.chroma.test != ChromaTest::none ||
      pipeline.channels.shades_at >= 0 || !pipeline.merge.is_plain) {
    return false;
  }
  // What a comparison gives is opaque, as what lies outside of a projected texture.
  const int texture = state.texture1;
  return !second.is_on() || second.compares ||
         (hides(plan.textures_of(1), texture) && hides(plan.magnified_of(1), texture));
}

template <>
ShadeKernels<std::int32_t> shade_kernels(VectorTarget target) {
  return on_target(target, [] { return HWY_DYNAMIC_DISPATCH(kernels32)(); });
}
template <>
ShadeKernels<std::int64_t> shade_kernels(VectorTarget target) {
  return on_target(target, [] { return HWY_DYNAMIC_DISPATCH(kernels64)(); });
}

}  // namespace bitspan::model
#endif
