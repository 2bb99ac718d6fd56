// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_pixels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "engine/sv_writer.hpp"
#include "model/numeric/exact.hpp"
#include "model/stages/texel.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {
namespace {

constexpr std::uint64_t texel_indices = std::uint64_t{1} << texel_index_bits;
// In front of this address lie the textures. Behind it the address says only that the model names the texel.
constexpr std::uint64_t modelled_base = std::uint64_t{1} << (texel_address_bits - 1);
// A texture of any size that the RTL repeats.
constexpr TexelPlace modelled_place{
    texel_indices - 1, texel_indices - 1, texel_index_bits, modelled_base, 0, false};

// An exact value that a format holds, at its port.
std::uint64_t raw_port(model::Exact value, const Format& format) {
  return Rtl::to_port(static_cast<std::int64_t>(model::on_grid(value, format.fraction())), format.word);
}

// Behind a texture and its levels: the texture lies as many texels behind the base as it has.
std::uint64_t end_of(const TexelPlace& p) {
  return p.base + ((p.last_j + 1) << (p.pitch + (p.has_levels ? 1 : 0)));
}

// The texel so many places behind the base: of that level that begins there or in front.
std::optional<std::uint32_t> texel_in_chain(const model::MipChain& chain, std::uint64_t place) {
  for (const Texture& level : chain) {
    const auto width = static_cast<std::uint64_t>(level.width);
    const std::uint64_t begin = width * static_cast<std::uint64_t>(level.height);
    if (place < begin || place >= 2 * begin) continue;
    return texel_word(level, static_cast<std::int64_t>((place - begin) % width),
                      static_cast<std::int64_t>((place - begin) / width));
  }
  return std::nullopt;
}

// A tap's fields are its record's, in their order; all pixel records begin with the triangle.
template <class R>
StageChannel tap_of(const char* name) {
  static_assert(fields<R>[0].name == "triangle");
  StageChannel tap{ChannelKind::tap, name, {}};
  for (std::size_t i = 1; i < fields<R>.size(); ++i) tap.fields.emplace_back(fields<R>[i].name);
  return tap;
}

std::uint64_t packed(const std::array<std::uint8_t, 3>& color) {
  return color[0] | std::uint64_t{color[1]} << 8 | std::uint64_t{color[2]} << 16;
}

}  // namespace

StageDesign pixel_pipe_design(const Config& config, DepthWhen when) {
  const std::vector<std::string> of_fragment{"x", "y", "h", "u",      "v",    "r",
                                             "g", "b", "a", "factor", "line", "back"};
  StageDesign d{
      .name = config.name,
      .top = "pixel_pipe",
      .package = emit_pixel_sv(config, when),
      .channels = {{ChannelKind::in,
                    "draw",
                    {"func",
                     "write_z",
                     "bias",
                     "textured",
                     "bilinear",
                     "clamp",
                     "last_i",
                     "last_j",
                     "pitch",
                     "base",
                     "transparent",
                     "reserved",
                     "fog",
                     "fog_color",
                     "blend",
                     "write_color",
                     "color_mask",
                     "alpha_func",
                     "alpha_ref",
                     "alpha_zero",
                     "stencil_test",
                     "stencil_func",
                     "stencil_fail",
                     "stencil_zfail",
                     "stencil_pass",
                     "stencil_ref",
                     "stencil_mask",
                     "stencil_write",
                     "stencil_back_func",
                     "stencil_back_fail",
                     "stencil_back_zfail",
                     "stencil_back_pass",
                     "stencil_back_ref",
                     "stencil_back_mask",
                     "stencil_back_write",
                     "src",
                     "dst",
                     "op",
                     "alpha_src",
                     "alpha_dst",
                     "alpha_op",
                     "constant",
                     "logic",
                     "last_level",
                     "h_x",
                     "h_y",
                     "gu_x",
                     "gu_y",
                     "gv_x",
                     "gv_y"}},
                   {ChannelKind::in, "in", of_fragment},
                   {ChannelKind::out, "z_request", {"x", "y"}},
                   {ChannelKind::in, "z_answer", {"z", "stencil"}},
                   {ChannelKind::out, "z_write", {"x", "y", "z", "stencil", "mask"}},
                   {ChannelKind::out, "color_request", {"x", "y"}},
                   {ChannelKind::in, "color_answer", {"r", "g", "b", "a"}},
                   {ChannelKind::out, "color_write", {"x", "y", "r", "g", "b", "a", "has_a", "mask"}},
                   tap_of<DepthRecord>("depth_record"),
                   tap_of<StencilRecord>("stencil_record"),
                   tap_of<TextureRecord>("texture_record"),
                   tap_of<FogRecord>("fog_record"),
                   tap_of<MergeRecord>("merge_record"),
                   tap_of<MergeAlphaRecord>("merge_alpha_record"),
                   tap_of<LodRecord>("lod_record")},
      .constants = {"b", "c1", "c0", "scale", "width", "height", "load", "load_threshold", "load_place",
                    "load_data", "lod_a", "load_k", "load_k_place", "load_k_data"},
      .levels = {"idle"}};
  for (int port = 0; port < texel_ports; ++port) {
    d.channels.push_back({ChannelKind::out, fmt::format("texel{}_request", port), {"address"}});
    d.channels.push_back({ChannelKind::in, fmt::format("texel{}_answer", port), {"texel"}});
  }
  return d;
}

Format port_format(const Field& field, const Config& config) {
  if (const std::optional<Format> format = format_of(field, config)) return *format;
  Format f{.word = 63, .integer = 63};
  if (field.name == "recip_e") f = {.word = exponent_bits, .integer = exponent_bits, .is_signed = true};
  if (field.name == "index") {
    f.word = f.integer = config.fog_index_bits() + 1;
    f.is_signed = true;
  }
  return f;
}

std::vector<TexelPlace> place_textures(const Config& config, const Scene& scene, std::uint64_t end) {
  std::vector<TexelPlace> places;
  for (const Texture& t : scene.textures) {
    TexelPlace p;
    p.last_i = static_cast<std::uint64_t>(t.width - 1);
    p.last_j = static_cast<std::uint64_t>(t.height - 1);
    p.pitch = static_cast<std::uint64_t>(std::bit_width(p.last_i));
    p.base = ((end >> p.pitch) + 1) << p.pitch;
    p.has_levels = has_levels_in_rtl(config);
    if (p.has_levels) p.last_level = static_cast<std::uint64_t>(std::bit_width(p.last_i | p.last_j));
    end = end_of(p);
    places.push_back(p);
  }
  return places;
}

bool holds_textures(const Config& config, const Scene& scene) {
  return std::ranges::all_of(place_textures(config, scene), [](const TexelPlace& p) {
    return std::max(p.last_i, p.last_j) < texel_indices && end_of(p) <= modelled_base;
  });
}

bool addresses_texels(const TexelLookup& by, const Texture& texture) {
  const auto addresses = [](TextureWrap wrap, int size) {
    return stops_at_edge(wrap) || std::has_single_bit(static_cast<unsigned>(size));
  };
  return addresses(by.wrap_u, texture.width) && addresses(by.wrap_v, texture.height);
}

std::uint32_t texel_word(const Texture& texture, std::int64_t i, std::int64_t j) {
  const model::TexelCodes p = model::texel_of(texture, i, j);
  return p[0] | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 | std::uint32_t{p[3]} << 24;
}

std::optional<std::uint32_t> texel_at(const Scene& scene, std::span<const model::MipChain> chains,
                                      std::span<const TexelPlace> places, std::uint64_t address) {
  const auto after =
      std::ranges::upper_bound(places, address, {}, [](const TexelPlace& p) { return p.base; });
  if (after == places.begin()) return std::nullopt;
  const auto texture = static_cast<std::size_t>(after - places.begin()) - 1;
  const TexelPlace& p = places[texture];
  if (p.has_levels) return texel_in_chain(chains[texture], address - p.base);
  const std::uint64_t j = (address - p.base) >> p.pitch;
  const std::uint64_t i = (address - p.base) & ((std::uint64_t{1} << p.pitch) - 1);
  if (i > p.last_i || j > p.last_j) return std::nullopt;
  return texel_word(scene.textures[texture], static_cast<std::int64_t>(i), static_cast<std::int64_t>(j));
}

RtlStencil rtl_stencil(const DrawState& s) {
  RtlStencil out;
  out.test = s.stencil_test;
  out.front = {s.stencil_func, s.stencil_fail, s.stencil_zfail, s.stencil_pass,
               s.stencil_ref,  s.stencil_mask, s.stencil_write};
  out.back = out.front;
  if (!s.stencil_two_sided) return out;
  out.back.func = s.stencil_back_func;
  out.back.fail = s.stencil_back_fail;
  out.back.zfail = s.stencil_back_zfail;
  out.back.pass = s.stencil_back_pass;
  if (s.stencil_back_ref >= 0) out.back.ref = s.stencil_back_ref;
  if (s.stencil_back_mask >= 0) out.back.mask = s.stencil_back_mask;
  if (s.stencil_back_write >= 0) out.back.write = s.stencil_back_write;
  return out;
}

namespace {

// The bits of a comparison's port are those of its number: less, equal, greater.
constexpr std::uint64_t compare_bits(CompareFunc func) { return static_cast<std::uint64_t>(func); }
static_assert(compare_bits(CompareFunc::never) == 0 && compare_bits(CompareFunc::less) == 1 &&
              compare_bits(CompareFunc::equal) == 2 && compare_bits(CompareFunc::less_equal) == 3 &&
              compare_bits(CompareFunc::greater) == 4 && compare_bits(CompareFunc::not_equal) == 5 &&
              compare_bits(CompareFunc::greater_equal) == 6 && compare_bits(CompareFunc::always) == 7);

void add_side(StageValues& values, const RtlStencilSide& side) {
  values.push_back(compare_bits(side.func));
  for (const StencilOp op : {side.fail, side.zfail, side.pass})
    values.push_back(static_cast<std::uint64_t>(op));
  for (const std::int32_t byte : {side.ref, side.mask, side.write})
    values.push_back(static_cast<std::uint64_t>(byte));
}

}  // namespace

std::uint64_t fog_number(FogMode mode) {
  return static_cast<std::uint64_t>(has_vertex_fog(mode) ? FogMode::linear : mode);
}

StageValues draw_values(const Config& config, const RtlDraw& s) {
  const std::int64_t zmax = (std::int64_t{1} << config.depth_bits) - 1;
  const PassingDistances passes = passing_distances(s.func);
  const auto bit = [](bool b) { return std::uint64_t{b}; };
  const auto number = [](auto name) { return static_cast<std::uint64_t>(name); };
  std::uint64_t constant = 0;
  for (std::size_t c = 0; c < s.equation.constant.size(); ++c) {
    constant |= static_cast<std::uint64_t>(s.equation.constant[c]) << 8 * c;
  }
  StageValues values{bit(passes.nearer) | bit(passes.equal) << 1 | bit(passes.farther) << 2,
                     bit(s.write_z),
                     Rtl::to_port(std::clamp(s.bias, -zmax, zmax), config.depth_bits + 1),
                     bit(s.textured),
                     bit(weighs_texels(s.lookup.filter)),
                     bit(stops_at_edge(s.lookup.wrap_u)) | bit(stops_at_edge(s.lookup.wrap_v)) << 1,
                     s.place.last_i,
                     s.place.last_j,
                     s.place.pitch,
                     s.place.base,
                     bit(s.transparent.has_value()),
                     s.transparent ? packed(*s.transparent) : 0,
                     fog_number(s.fog),
                     packed(s.fog_color),
                     bit(s.blend),
                     bit(s.write_color),
                     static_cast<std::uint64_t>(s.color_mask),
                     compare_bits(s.alpha_func),
                     static_cast<std::uint64_t>(s.alpha_ref),
                     bit(s.alpha_zero == AlphaZero::keep),
                     bit(s.stencil.test)};
  add_side(values, s.stencil.front);
  add_side(values, s.stencil.back);
  values.insert(values.end(),
                {number(s.equation.color.src), number(s.equation.color.dst), number(s.equation.color.op),
                 number(s.equation.alpha.src), number(s.equation.alpha.dst), number(s.equation.alpha.op),
                 constant, number(s.equation.logic)});
  const auto port = [&config](std::int64_t raw, FormatId id) {
    return Rtl::to_port(raw, config.format(id).word);
  };
  values.push_back(s.place.last_level);
  for (const std::int64_t h : {s.gradient.h_x, s.gradient.h_y})
    values.push_back(port(h, FormatId::plane_h_grad));
  for (const std::int64_t g : {s.gradient.gu_x, s.gradient.gu_y, s.gradient.gv_x, s.gradient.gv_y}) {
    values.push_back(port(g, FormatId::plane_g_grad));
  }
  return values;
}

StageValues fragment_values(const Config& config, const FragmentRecord& f, bool back, std::int64_t factor,
                            std::optional<std::int64_t> line) {
  const auto port = [&config](std::int64_t raw, FormatId id) {
    return Rtl::to_port(raw, config.format(id).word);
  };
  return {static_cast<std::uint64_t>(f.x),
          static_cast<std::uint64_t>(f.y),
          port(f.h, FormatId::span_h),
          port(f.u, FormatId::span_uv),
          port(f.v, FormatId::span_uv),
          port(f.r, shade_factor(config)),
          port(f.g, shade_factor(config)),
          port(f.b, shade_factor(config)),
          port(f.a, shade_factor(config)),
          port(factor, FormatId::fog_factor),
          port(line.value_or(f.h), FormatId::span_h),
          std::uint64_t{back}};
}

StageValues frame_values(const Config& config, const ConstantsRecord& k, const Scene& scene,
                         const model::LodStage& lod) {
  const auto port = [&config](std::int64_t raw, FormatId id) {
    return Rtl::to_port(raw, config.format(id).word);
  };
  return {port(k.b, FormatId::setup_b),
          port(k.c1, FormatId::depth_c1),
          port(k.c0, FormatId::depth_c0),
          port(k.fog_scale, FormatId::fog_scale),
          static_cast<std::uint64_t>(scene.width),
          static_cast<std::uint64_t>(scene.height),
          0,
          0,
          0,
          0,
          has_lod_zones(config) ? raw_port(lod.a, config.format(FormatId::distance_a)) : 0,
          0,
          0,
          0};
}

std::vector<std::uint64_t> zone_loads(const Config& config, const model::LodStage& lod) {
  std::vector<std::uint64_t> loads;
  if (!has_lod_zones(config)) return loads;
  for (const model::LodStage::Zone& zone : lod.zones) {
    loads.push_back(raw_port(zone.k, config.format(FormatId::lod_k)));
  }
  return loads;
}

std::vector<FogLoad> fog_loads(const Config& config, const model::FogStage& fog) {
  std::vector<FogLoad> loads;
  const std::int64_t zones = std::int64_t{1} << config.fog_zone_bits;
  for (std::int64_t z = 1; z < zones; ++z) {
    loads.push_back(
        {true, static_cast<std::uint64_t>(z), static_cast<std::uint64_t>(zone_start(fog.zones, z))});
  }
  const int word = config.format(FormatId::fog_factor).word;
  for (std::size_t i = 0; i < fog.table.size(); ++i) {
    loads.push_back({false, i, Rtl::to_port(fog.table[i], word)});
  }
  return loads;
}

namespace {

// Answers of a memory, in the order of the requests.
struct Answers {
  ChannelPorts request, answer;
  std::vector<std::array<std::uint64_t, 4>> values;
  std::size_t fields = 1, next = 0;

  void clear() {
    values.clear();
    next = 0;
  }
  void take() {
    ++next;
    if (2 * next < values.size() + 4096) {
      if (next == values.size()) clear();
      return;
    }
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(next));
    next = 0;
  }
};

// Numbers of fragments on their way from one stage to the next.
struct Underway {
  std::vector<std::size_t> fragments;
  std::size_t next = 0;

  // Returns the fragment of the record that comes out now; the last one where none is on its way.
  std::size_t take(std::size_t last) { return next < fragments.size() ? fragments[next++] : last; }
};

}  // namespace

struct RtlPixels::Pipe {
  Pipe(const Config& c, DepthWhen when) : Pipe(c, when, pixel_pipe_design(c, when)) {}
  Pipe(const Config& c, DepthWhen when, const StageDesign& d) : Pipe(c, when, d, module_of(d)) {}
  Pipe(const Config& c, DepthWhen when, const StageDesign& d, const RtlModuleDesign& m)
      : config(c),
        is_late(bitspan::is_late(when)),
        module(m),
        inputs(m.inputs.size()),
        outputs(m.outputs.size()),
        constants(port_place(m.inputs, d.constants.front() + "_i")),
        load(port_place(m.inputs, "load_i")),
        load_k(port_place(m.inputs, "load_k_i")),
        idle(port_place(m.outputs, "idle_o")) {
    const auto find = [&](const std::string& name) {
      return ports_of(m, *std::ranges::find(d.channels, name, &StageChannel::name));
    };
    draw = find("draw");
    in = find("in");
    z_write = find("z_write");
    color_write = find("color_write");
    depth = tap<DepthRecord>(find("depth_record"));
    stencil = tap<StencilRecord>(find("stencil_record"));
    texture = tap<TextureRecord>(find("texture_record"));
    fog = tap<FogRecord>(find("fog_record"));
    merge = tap<MergeRecord>(find("merge_record"));
    merge_alpha = tap<MergeAlphaRecord>(find("merge_alpha_record"));
    lod = tap<LodRecord>(find("lod_record"));
    z = {find("z_request"), find("z_answer"), {}, 2};
    color = {find("color_request"), find("color_answer"), {}, 4};
    for (std::size_t port = 0; port < texels.size(); ++port) {
      texels[port] = {
          find(fmt::format("texel{}_request", port)), find(fmt::format("texel{}_answer", port)), {}};
    }
    const PixelTiming t = pixel_timing(config);
    clocks_until_empty = t.depth.total + t.stencil.total + t.texture.total + t.fog.total +
                         t.merge.total_blending + t.in_flight;
    if (t.has_lod) clocks_until_empty += t.lod.total;
    draws_each_triangle = has_lod_gradients(config);
    merged_color = config.format(FormatId::merge_color);
  }

  template <class R>
  struct Tap {
    std::size_t valid = 0, first = 0;
    std::vector<Format> formats;  // of the fields behind the triangle
  };
  template <class R>
  Tap<R> tap(const ChannelPorts& ports) const {
    Tap<R> t{ports.valid, ports.first, {}};
    for (std::size_t i = 1; i < fields<R>.size(); ++i) {
      t.formats.push_back(port_format(fields<R>[i], config));
    }
    return t;
  }
  template <class R>
  R record(const Tap<R>& tap, std::int64_t triangle) const {
    std::array<std::int64_t, fields<R>.size()> raw{triangle};
    for (std::size_t i = 1; i < raw.size(); ++i) {
      raw[i] = Rtl::from_port(outputs[tap.first + i - 1], tap.formats[i - 1]);
    }
    return std::bit_cast<R>(raw);
  }

  bool taken(const ChannelPorts& in_channel) const {
    return inputs[in_channel.valid] != 0 && outputs[in_channel.ready] != 0;
  }
  bool asked(const ChannelPorts& out_channel) const {
    return outputs[out_channel.valid] != 0 && inputs[out_channel.ready] != 0;
  }
  void put(const ChannelPorts& channel, std::span<const std::uint64_t> values) {
    std::ranges::copy(values, inputs.begin() + static_cast<std::ptrdiff_t>(channel.first));
  }

  // The pixel that two ports name; none outside the frame, where only faulty RTL reads or writes.
  std::optional<std::size_t> pixel_at(std::size_t first) const {
    const std::uint64_t x = outputs[first];
    const std::uint64_t y = outputs[first + 1];
    if (x >= static_cast<std::uint64_t>(frame->width) || y >= static_cast<std::uint64_t>(frame->height)) {
      return std::nullopt;
    }
    return y * static_cast<std::uint64_t>(frame->width) + x;
  }

  void begin(const model::Pipeline& p, const Scene& s, Frame& f) {
    pipeline = &p;
    scene = &s;
    frame = &f;
    uv_ulp = std::ldexp(1.0, -p.texture.uv.fraction);
    module.reset();
    std::ranges::fill(inputs, 0);
    const StageValues values = frame_values(config, p.constants.record, s, p.lod);
    std::ranges::copy(values, inputs.begin() + static_cast<std::ptrdiff_t>(constants));
    for (const ChannelPorts* out : {&z.request, &z_write, &color.request, &color_write}) {
      inputs[out->ready] = 1;
    }
    for (const Answers& t : texels) inputs[t.request.ready] = 1;
    for (Answers* a : answers()) a->clear();
    for (const FogLoad& l : fog_loads(config, p.fog)) {
      inputs[load] = 1;
      inputs[load + 1] = l.threshold ? 1 : 0;
      inputs[load + 2] = l.place;
      inputs[load + 3] = l.data;
      module.clock(inputs, outputs);
    }
    inputs[load] = 0;
    const std::vector<std::uint64_t> zones = zone_loads(config, p.lod);
    for (std::size_t level = 0; level < zones.size(); ++level) {
      inputs[load_k] = 1;
      inputs[load_k + 1] = level;
      inputs[load_k + 2] = zones[level];
      module.clock(inputs, outputs);
    }
    inputs[load_k] = 0;
    clocks = 0;

    places = place_textures(config, s);
    set(p.state);
  }

  void set(const DrawState& s) {
    writes_color = s.color_write;
    tests_stencil = s.stencil_test;
    texture_stage = pipeline->texture;
    texture_stage.lookup = first_lookup(s);
    modelled.clear();
    for (const Texture& t : scene->textures) modelled.push_back(!addresses_texels(texture_stage.lookup, t));
    RtlDraw state{.func = s.depth_func,
                  .lookup = texture_stage.lookup,
                  .transparent = pipeline->texture.transparent,
                  .fog = pipeline->fog.mode,
                  .fog_color = pipeline->fog.fog_color,
                  .write_z = s.depth_write,
                  .blend = mixes_by_alpha(s),
                  .write_color = s.color_write,
                  .color_mask = s.color_mask,
                  .bias = s.depth_bias,
                  .equation = model::blend_of(s),
                  .alpha_func = s.alpha_func,
                  .alpha_ref = s.alpha_ref,
                  .alpha_zero = s.alpha_zero,
                  .stencil = rtl_stencil(s)};
    untextured_draw = draw_values(config, state);
    textured_draws.clear();
    state.textured = true;
    for (std::size_t i = 0; i < places.size(); ++i) {
      state.place = modelled[i] ? modelled_place : places[i];
      textured_draws.push_back(draw_values(config, state));
    }
    drawn = {};
  }

  StageValues values_of(const Fragment& f) const {
    return fragment_values(config, f.record, f.back, f.factor, f.line);
  }

  // The draw state of a fragment, at the port.
  void put_draw(const Fragment& f) {
    put(draw, f.texture < 0 ? untextured_draw : textured_draws[static_cast<std::size_t>(f.texture)]);
    if (f.gradient == nullptr) return;
    const auto values = draw_values(config, {.gradient = *f.gradient});
    const auto gradient = std::span(values).last(gradient_ports);
    std::ranges::copy(
        gradient, inputs.begin() + static_cast<std::ptrdiff_t>(draw.first + values.size() - gradient_ports));
  }

  std::array<Answers*, read_ports> answers() {
    std::array<Answers*, read_ports> all{&z, &color};
    for (std::size_t port = 0; port < texels.size(); ++port) all[first_texel_port + port] = &texels[port];
    return all;
  }

  // What a fragment's draw state is of: a texture, and a triangle where it has the triangle's gradients.
  struct Drawn {
    int texture = -2;  // none
    std::int64_t triangle = -1;
    bool operator==(const Drawn&) const = default;
  };
  Drawn drawn_for(const Fragment& f) const {
    return {f.texture, draws_each_triangle ? f.record.triangle : -1};
  }

  // Runs one clock; returns whether anything but the fragments' own handshake moved.
  bool clock() {
    for (Answers* a : answers()) {
      const bool waits = a->next < a->values.size();
      inputs[a->answer.valid] = waits ? 1 : 0;
      if (waits) put(a->answer, std::span(a->values[a->next]).first(a->fields));
    }
    return clock_as_driven();
  }
  // The same with the inputs of the handshakes as they stand.
  bool clock_as_driven() {
    module.clock(inputs, outputs);
    ++clocks;
    bool moved = false;
    for (Answers* a : answers()) {
      if (!taken(a->answer)) continue;
      moved = true;
      a->take();
    }
    moved = records() || moved;
    moved = reads() || moved;
    return writes() || moved;
  }

  // A read finds what earlier clocks wrote.
  bool reads() {
    bool moved = false;
    if (asked(z.request)) {
      const auto at = pixel_at(z.request.first);
      z.values.push_back({at ? frame->depth[*at] : 0,
                          at && !frame->stencil.empty() ? frame->stencil[*at] : std::uint64_t{0}});
      moved = true;
    }
    if (asked(color.request)) {
      const auto at = pixel_at(color.request.first);
      const std::uint8_t* c = frame->color.data() + (at ? 4 * *at : 0);
      color.values.push_back({c[0], c[1], c[2], c[3]});
      moved = true;
    }
    for (std::size_t port = 0; port < texels.size(); ++port) {
      Answers& t = texels[port];
      if (!asked(t.request)) continue;
      const std::uint64_t address = outputs[t.request.first];
      t.values.push_back({address < modelled_base ? texel_at(*scene, chains(), places, address).value_or(0)
                                                  : next_modelled_texel(port)});
      moved = true;
    }
    return moved;
  }
  std::span<const model::MipChain> chains() const { return pipeline->mip_chains.all(); }
  // Textures with levels are not among those that are modelled, so that the ports of the next level never
  // ask.
  std::uint32_t next_modelled_texel(std::size_t port) {
    if (port >= texels_asked.size()) return 0;
    const std::size_t i = texels_asked[port]++;
    return i < modelled_texels.size() ? modelled_texels[i].words[port] : 0;
  }

  bool writes() {
    bool moved = false;
    if (asked(z_write)) {
      if (const auto at = pixel_at(z_write.first)) {
        const std::uint64_t mask = outputs[z_write.first + 4];
        if ((mask & 1) != 0) frame->depth[*at] = static_cast<std::uint32_t>(outputs[z_write.first + 2]);
        if ((mask & 2) != 0 && !frame->stencil.empty()) {
          frame->stencil[*at] = static_cast<std::uint8_t>(outputs[z_write.first + 3]);
        }
      }
      moved = true;
    }
    if (asked(color_write)) {
      if (const auto at = pixel_at(color_write.first)) {
        const std::size_t written = outputs[color_write.first + 6] != 0 ? 4 : 3;
        for (std::size_t c = 0; c < written; ++c) {
          if ((outputs[color_write.first + 7] >> c & 1) == 0) continue;
          frame->color[4 * *at + c] =
              static_cast<std::uint8_t>(Rtl::from_port(outputs[color_write.first + 2 + c], merged_color));
        }
      }
      moved = true;
    }
    return moved;
  }

  // What the taps show of the fragments.
  bool records() {
    const bool moved = (outputs[depth.valid] | outputs[stencil.valid] | outputs[lod.valid] |
                        outputs[texture.valid] | outputs[fog.valid] | outputs[merge.valid]) != 0;
    if (sent.empty()) return moved;  // only faulty RTL shows anything then
    const std::size_t last = sent.size() - 1;
    if (outputs[depth.valid] != 0) {
      const std::size_t f = is_late ? alive.take(last) : std::min(tested, last);
      ++tested;
      const DepthRecord r = record(depth, sent[f].record.triangle);
      deliver(trace, r);
      if (tests_stencil) {
        depth_tested.fragments.push_back(f);
        depth_passes.push_back(r.pass);
      } else if (r.pass != 0) {
        pass(f);
      }
    }
    if (outputs[stencil.valid] != 0) {
      const std::size_t at = depth_tested.next;
      const std::size_t f = depth_tested.take(last);
      const StencilRecord r = record(stencil, sent[f].record.triangle);
      deliver(trace, r);
      if (r.pass == 0) {
        ++counters->stencil_failed;
      } else if (at < depth_passes.size() && depth_passes[at] != 0) {
        pass(f);
      }
    }
    if (outputs[lod.valid] != 0) {
      const std::size_t f = before_lod.take(last);
      if (trace != nullptr) deliver(trace, record(lod, sent[f].record.triangle));
    }
    if (outputs[texture.valid] != 0) {
      const std::size_t f = is_late ? std::min(textured++, last) : passed.take(last);
      TextureRecord r = record(texture, sent[f].record.triangle);
      if (is_modelled(sent[f]) && texels_shown < modelled_texels.size()) {
        const ModelledTexel& t = modelled_texels[texels_shown++];
        r.i = t.i;
        r.j = t.j;
      }
      deliver(trace, r);
      if (r.killed != 0) {
        ++counters->killed;
      } else {
        alive.fragments.push_back(f);
      }
    }
    if (outputs[fog.valid] != 0) {
      const std::size_t f = is_late ? passed.take(last) : alive.take(last);
      if (trace != nullptr) deliver(trace, record(fog, sent[f].record.triangle));
      fogged.fragments.push_back(f);
    }
    if (outputs[merge.valid] != 0) {
      const FragmentRecord& f = sent[fogged.take(last)].record;
      if (trace != nullptr) deliver(trace, record(merge, f.triangle));
      if (outputs[merge_alpha.valid] != 0) deliver(trace, record(merge_alpha, f.triangle));
      ++counters->written;
      const auto at = pixel_at(merge.first);
      if (at && writes_color) write_winner(*frame, *at, f.u, f.v, f.triangle, uv_ulp);
    }
    return moved;
  }

  // A fragment that passes the tests.
  void pass(std::size_t f) {
    ++counters->depth_passed;
    passed.fragments.push_back(f);
    if (!is_late) goes_to_texture(f);
  }
  // By way of lod, where there is one.
  void goes_to_texture(std::size_t f) {
    if (has_levels_in_rtl(config)) before_lod.fragments.push_back(f);
    if (is_modelled(sent[f])) find_texels(sent[f]);
  }
  bool is_modelled(const Fragment& f) const {
    return f.texture >= 0 && modelled[static_cast<std::size_t>(f.texture)];
  }
  // The texels of a fragment on its way to texture, by the model's indices.
  void find_texels(const Fragment& f) {
    const Texture& image = scene->textures[static_cast<std::size_t>(f.texture)];
    const TexelLookup& by = texture_stage.lookup;
    TextureRecord r;
    model::texture(texture_stage, &image, f.record, r);
    const auto [i, j] = std::pair(r.i, r.j);
    const auto next = [&](std::int64_t at, std::int64_t raw, int size, TextureWrap wrap) {
      if (!stops_at_edge(wrap)) return (at + 1) % size;
      const int fraction = texture_stage.uv.fraction;
      const auto left = model::floor_of(model::Exact{raw, fraction} - model::Exact{1, 1});
      return static_cast<std::int64_t>(std::clamp<model::int128>(left + 1, 0, size - 1));
    };
    const std::int64_t next_i = next(i, f.record.u, image.width, by.wrap_u);
    const std::int64_t next_j = next(j, f.record.v, image.height, by.wrap_v);
    modelled_texels.push_back({i,
                               j,
                               {texel_word(image, i, j), texel_word(image, next_i, j),
                                texel_word(image, i, next_j), texel_word(image, next_i, next_j)}});
  }

  // Nothing is on its way.
  void forget_fragments() {
    stepped.clear();
    tested = 0;
    textured = 0;
    for (Underway* u : {&passed, &before_lod, &alive, &fogged, &depth_tested}) *u = {};
    depth_passes.clear();
    modelled_texels.clear();
    texels_asked = {};
    texels_shown = 0;
  }

  PixelChainPorts step(const PixelChainDrive& drive, const Fragment* offered, Counters& to_counters) {
    counters = &to_counters;
    trace = nullptr;
    // idle is a clock late.
    if (outputs[idle] != 0 && !taken(in)) forget_fragments();
    const auto has = [](PortSet set, std::size_t p) { return std::uint64_t{unsigned{set} >> p & 1U}; };
    inputs[draw.valid] = drive.draw_valid ? 1 : 0;
    inputs[in.valid] = drive.in_valid ? 1 : 0;
    if (offered != nullptr) {
      put_draw(*offered);
      put(in, values_of(*offered));
    }
    const auto all = answers();
    for (std::size_t p = 0; p < all.size(); ++p) {
      Answers& a = *all[p];
      inputs[a.request.ready] = has(drive.request_ready, p);
      inputs[a.answer.valid] = has(drive.answer_valid, p);
      if (inputs[a.answer.valid] == 0) continue;
      if (a.next == a.values.size()) {
        throw std::logic_error(fmt::format("port {} is answered where the RTL has not asked", p));
      }
      put(a.answer, std::span(a.values[a.next]).first(a.fields));
    }
    inputs[z_write.ready] = has(drive.write_ready, z_port);
    inputs[color_write.ready] = has(drive.write_ready, color_port);
    if (drive.in_valid && offered != nullptr) stepped.push_back(*offered);
    sent = stepped;
    clock_as_driven();
    if (drive.in_valid && offered != nullptr) {
      if (!taken(in)) stepped.pop_back();
      if (taken(in) && is_late) goes_to_texture(stepped.size() - 1);
    }

    PixelChainPorts out;
    out.draw_ready = outputs[draw.ready] != 0;
    out.in_ready = outputs[in.ready] != 0;
    out.idle = outputs[idle] != 0;
    const auto bit = [&](std::size_t port, std::size_t at) {
      return static_cast<PortSet>(outputs[port] != 0 ? 1U << at : 0U);
    };
    for (std::size_t p = 0; p < all.size(); ++p) {
      out.request_valid |= bit(all[p]->request.valid, p);
      out.answer_ready |= bit(all[p]->answer.ready, p);
    }
    out.write_valid = bit(z_write.valid, z_port) | bit(color_write.valid, color_port);
    out.records = static_cast<std::uint8_t>(bit(depth.valid, 0) | bit(texture.valid, 1) | bit(fog.valid, 2) |
                                            bit(merge.valid, 3) | bit(stencil.valid, 4) | bit(lod.valid, 5));
    return out;
  }

  void run(std::span<const Fragment> fragments, Counters& to_counters, Trace* to_trace) {
    forget_fragments();
    sent = fragments;
    counters = &to_counters;
    trace = to_trace;
    constexpr int patience_clocks = 10000;
    int still = 0;
    std::size_t next = 0;
    std::size_t shown = sent.size();  // the fragment whose values stand at the port
    while (true) {
      const bool sends = next < sent.size();
      const bool draws_first = sends && drawn_for(sent[next]) != drawn;
      inputs[draw.valid] = draws_first ? 1 : 0;
      inputs[in.valid] = sends && !draws_first ? 1 : 0;
      if (draws_first) {
        put_draw(sent[next]);
      } else if (sends && shown != next) {
        put(in, values_of(sent[next]));
        shown = next;
      }
      bool moved = clock();
      if (taken(draw)) {
        drawn = drawn_for(sent[next]);
        moved = true;
      }
      if (taken(in)) {
        if (is_late) goes_to_texture(next);
        ++next;
        moved = true;
      }
      if (!sends && outputs[idle] != 0) break;
      still = moved ? 0 : still + 1;
      if (still > patience_clocks) {
        throw std::logic_error(fmt::format(
            "the RTL's pixel stages stand still at clock {}: {} of {} fragments accepted, {} depth-tested",
            clocks, next, sent.size(), tested));
      }
    }
    for (int i = 0; i < clocks_until_empty; ++i) clock();
  }

  Config config;
  bool is_late;  // the tests are behind texture
  RtlModule module;
  std::vector<std::uint64_t> inputs, outputs;
  // Places of ports.
  std::size_t constants, load, load_k, idle;
  ChannelPorts draw, in, z_write, color_write;
  Tap<DepthRecord> depth;
  Tap<StencilRecord> stencil;
  Tap<TextureRecord> texture;
  Tap<FogRecord> fog;
  Tap<MergeRecord> merge;
  Tap<MergeAlphaRecord> merge_alpha;
  Tap<LodRecord> lod;
  Answers z, color;
  std::array<Answers, texel_ports> texels;
  int clocks_until_empty = 0;
  Format merged_color;

  // Set by begin().
  const model::Pipeline* pipeline = nullptr;  // of the scene; the draw state in force may be another one
  model::TextureStage texture_stage;          // of that state
  const Scene* scene = nullptr;
  Frame* frame = nullptr;
  double uv_ulp = 1;
  std::vector<TexelPlace> places;  // of the textures
  std::vector<bool> modelled;      // the model says which texels of a texture are meant
  StageValues untextured_draw;
  std::vector<StageValues> textured_draws;  // by texture
  bool writes_color = true, tests_stencil = false;
  static constexpr std::size_t gradient_ports = 6;  // the last ones of the draw state
  bool draws_each_triangle = false;
  Drawn drawn;               // of the draw state that was transferred last
  std::uint64_t clocks = 0;  // behind the loading

  // Set by run() and step().
  std::span<const Fragment> sent;
  std::vector<Fragment> stepped;  // by step(): accepted since nothing was inside
  Counters* counters = nullptr;
  Trace* trace = nullptr;
  std::size_t tested = 0, textured = 0;
  // On the way to texture, or fog, where the tests are late; the other way round; to merge; to stencil; to
  // lod.
  Underway passed, alive, fogged, depth_tested, before_lod;
  std::vector<std::int64_t> depth_passes;  // of all that came to stencil
  struct ModelledTexel {
    std::int64_t i, j;
    std::array<std::uint32_t, level_texel_ports> words;
  };
  std::vector<ModelledTexel> modelled_texels;  // of those that came to texture
  std::array<std::size_t, level_texel_ports> texels_asked{};
  std::size_t texels_shown = 0;
};

RtlPixels::RtlPixels(const Config& config, DepthWhen when) : pipe_(std::make_unique<Pipe>(config, when)) {}
RtlPixels::~RtlPixels() = default;

void RtlPixels::begin(const model::Pipeline& pipeline, const Scene& scene, Frame& frame) {
  pipe_->begin(pipeline, scene, frame);
}

void RtlPixels::set(const DrawState& state) { pipe_->set(state); }

void RtlPixels::run(std::span<const Fragment> fragments, Counters& counters, Trace* trace) {
  if (!fragments.empty()) pipe_->run(fragments, counters, trace);
}

PixelChainPorts RtlPixels::clock(const PixelChainDrive& drive, const Fragment* offered, Counters& counters) {
  return pipe_->step(drive, offered, counters);
}

}  // namespace bitspan
