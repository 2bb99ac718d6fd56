// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/pipe_case.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <deque>
#include <set>
#include <stdexcept>

#include "config/modes.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "model/stages/depth.hpp"
#include "model/stages/merge.hpp"
#include "model/stages/stencil.hpp"
#include "model/stages/texture.hpp"
#include "tests/rtl/stage_case.hpp"

namespace bitspan {
namespace {

// The ports that a record's fields have, but for `triangle`.
template <class R>
StageValues record_ports(const Config& c, const R& record) {
  StageValues values;
  const auto raw = raw_values(record);
  for (std::size_t i = 1; i < raw.size(); ++i) {
    values.push_back(Rtl::to_port(raw[i], port_format(fields<R>[i], c).word));
  }
  return values;
}

std::uint32_t clear_code(const Config& c) {
  return nearer_is_larger(c.depth_code) ? 0 : (std::uint32_t{1} << c.depth_bits) - 1;
}

// The RTL repeats textures whose sizes are powers of two: others are continued up to one.
void continue_textures(Scene& scene) {
  for (Texture& t : scene.textures) {
    const auto up = [](int size) { return static_cast<int>(std::bit_ceil(static_cast<unsigned>(size))); };
    Texture made{t.name, up(t.width), up(t.height), {}};
    for (int row = 0; row < made.height; ++row) {
      for (int column = 0; column < made.width; ++column) {
        const auto from = t.rgba.begin() + 4 * (row % t.height * t.width + column % t.width);
        made.rgba.insert(made.rgba.end(), from, from + 4);
      }
    }
    t = std::move(made);
  }
}

StateSetting setting(const char* key, auto value) {
  return {*find_state_register(key), static_cast<std::int64_t>(value)};
}

void make_chains(PipeCase& p) {
  if (!has_levels_in_rtl(p.config)) return;
  for (const Texture& t : p.scene.textures) p.chains.push_back(model::make_mip_chain(t));
}

}  // namespace

PipeCase make_pipe_case(const Config& c, const Scene& given, DepthWhen when) {
  PipeCase p;
  p.config = c;
  p.when = when;
  p.scene = given;
  if (is_late(when)) {
    const StateChange change{
        false,
        {setting("depth.when", when), setting("alpha.func", CompareFunc::greater), setting("alpha.ref", 8),
         setting("stencil.test", 1), setting("stencil.ref", 2),
         setting("stencil.func", CompareFunc::greater_equal), setting("stencil.fail", StencilOp::invert),
         setting("stencil.pass", StencilOp::increment), setting("stencil.two_sided", 1),
         setting("stencil.back.func", CompareFunc::not_equal),
         setting("stencil.back.zfail", StencilOp::increment_wrap),
         setting("stencil.back.pass", StencilOp::decrement_wrap), setting("stencil.back.ref", 3),
         setting("stencil.back.write", 0x7f)}};
    p.scene.commands.insert(p.scene.commands.begin(), DrawCommand{0, change});
  }
  if (!stops_at_edge(c.wrap)) continue_textures(p.scene);
  const Scene& scene = p.scene;
  p.places = place_textures(c, p.scene);
  make_chains(p);
  p.constants = model::make_constants(c, scene);
  p.lod = model::prepare_lod(c, p.constants);
  p.fog = model::prepare_fog(c, p.constants, scene);
  const auto model = make_model(c);
  Trace trace;
  model->begin(scene);
  draw_scene(*model, scene, 0, scene.triangles.size(), &trace);
  p.frame = model->frame();
  DrawState registers = first_state(c);
  for (const DrawCommand& command : scene.commands) {
    registers = changed_state(registers, std::get<StateChange>(command.what), c);
  }
  const model::SetupStage setup = model::make_pipeline(c, scene).setup;
  bool back = false;
  std::map<std::int64_t, GradientRecord> gradients;  // by triangle, where lod takes them
  for (const GradientRecord& g : trace.gradient) gradients[g.triangle] = g;
  std::int64_t before = -1;
  const std::size_t in_use =
      trace.fragment.empty() ? 0 : trace.fragment_channel.size() / trace.fragment.size();
  for (std::size_t i = 0; i < trace.fragment.size(); ++i) {
    const FragmentRecord& f = trace.fragment[i];
    if (f.covered == 0) continue;
    if (f.triangle != before) {
      const Triangle& triangle = scene.triangles[static_cast<std::size_t>(f.triangle)];
      const int texture = triangle.texture;
      back = model::is_back_face(setup, triangle);
      const RtlDraw state{
          .func = c.depth_func,
          .textured = texture >= 0,
          .lookup = first_lookup(registers),
          .place = texture < 0 ? TexelPlace{} : p.places[static_cast<std::size_t>(texture)],
          .transparent = c.transparent,
          .fog = p.fog.mode,
          .fog_color = p.fog.fog_color,
          .alpha_func = registers.alpha_func,
          .alpha_ref = registers.alpha_ref,
          .alpha_zero = registers.alpha_zero,
          .stencil = rtl_stencil(registers),
          .gradient = gradients.contains(f.triangle) ? gradients.at(f.triangle) : GradientRecord{}};
      const StageValues draw = draw_values(c, state);
      if (p.batches.empty() || p.batches.back().draw != draw) p.batches.push_back({draw, {}});
      before = f.triangle;
    }
    model::FragmentChannels channels{};
    for (std::size_t k = 0; k < in_use; ++k) channels[k] = trace.fragment_channel[in_use * i + k];
    const std::int64_t factor = has_vertex_fog(p.fog.mode) ? model::channel_value(channels, LineId::fog) : 0;
    const std::int64_t line = has_own_depth(c.depth_line) ? model::channel_value(channels, LineId::z) : f.h;
    p.batches.back().fragments.push_back(fragment_values(c, f, back, factor, line));
  }
  const auto add = [&](const char* tap, const auto& records) {
    for (const auto& r : records) p.records[tap].push_back(record_ports(c, r));
  };
  add("depth_record", trace.depth);
  add("stencil_record", trace.stencil);
  add("texture_record", trace.texture);
  add("fog_record", trace.fog);
  add("merge_record", trace.merge);
  add("merge_alpha_record", trace.merge_alpha);
  const model::MergeStage merge = model::prepare_merge(c);
  std::set<std::array<std::int64_t, 3>> merged;
  for (const MergeRecord& m : trace.merge) merged.insert({m.triangle, m.x, m.y});
  for (const TextureRecord& t : trace.texture) {
    p.reads += merged.contains({t.triangle, t.x, t.y}) && model::reads_stored_color(merge, t.a) ? 1 : 0;
  }
  if (has_levels_in_rtl(c)) add("lod_record", trace.lod);
  return p;
}

StageValues merged_color(const StageValues& held, const StageValues& written) {
  StageValues out = held;
  const std::uint64_t mask = written.size() > 5 ? written[5] : 15;
  for (std::size_t c = 0; c < (written[4] != 0 ? 4 : 3); ++c) {
    if ((mask >> c & 1) != 0) out[c] = written[c];
  }
  return out;
}

model::Blend random_blend(Random& random) {
  const auto any = [&]<class E>(E& name) { name = static_cast<E>(random() % enum_names<E>.size()); };
  model::Blend blend;
  const model::Blend first;
  for (model::BlendEquation* e : {&blend.color, &blend.alpha}) {
    any(e->src);
    any(e->dst);
    any(e->op);
    // Factors of the fragment alone, so that many states read nothing.
    if (random() % 4 == 0) *e = {e->src, BlendFactor::zero, BlendOp::add};
  }
  for (std::int64_t& code : blend.constant) code = static_cast<std::int64_t>(random() % 256);
  if (random() % 4 == 0) any(blend.logic);
  if (random() % 4 == 0) blend.color = first.color;
  if (random() % 2 == 0) blend.alpha = first.alpha;
  return blend;
}

namespace {

// Few values, so that comparisons and operations often meet their ends.
RtlStencil random_stencil(Random& random) {
  const auto byte = [&] {
    return static_cast<std::int32_t>(random() % 2 == 0   ? random() % 3
                                     : random() % 2 == 0 ? 255
                                                         : random() % 256);
  };
  const auto side = [&] {
    const auto op = [&] { return static_cast<StencilOp>(random() % enum_names<StencilOp>.size()); };
    const auto func = random() % 2 == 0 ? CompareFunc::always
                                        : static_cast<CompareFunc>(random() % enum_names<CompareFunc>.size());
    RtlStencilSide made{func, op(), op(), op()};
    made.ref = byte();
    if (random() % 2 == 0) made.mask = byte();
    if (random() % 2 == 0) made.write = byte();
    return made;
  };
  RtlStencil s;
  s.test = random() % 10 < 7;  // the others stand at the ports, and are not to be read
  s.front = side();
  s.back = random() % 2 == 0 ? s.front : side();
  return s;
}

model::StencilStage modelled(const RtlStencil& s) {
  model::StencilStage stage;
  stage.test = s.test;
  const auto side = [](const RtlStencilSide& of) {
    return model::StencilSide{of.func, of.fail, of.zfail, of.pass, of.ref, of.mask, of.write};
  };
  stage.side = {side(s.front), side(s.back)};
  return stage;
}

// With a texture's number, or -1.
std::pair<RtlDraw, int> random_state(Random& random, const PipeCase& p) {
  const auto chance = [&](int percent) { return static_cast<int>(random() % 100) < percent; };
  RtlDraw s;
  s.func = static_cast<DepthFunc>(random() % enum_names<DepthFunc>.size());
  const int texture = static_cast<int>(random() % (p.scene.textures.size() + 1)) - 1;
  s.textured = texture >= 0;
  if (s.textured) s.place = p.places[static_cast<std::size_t>(texture)];
  s.lookup.filter = chance(50) ? TextureFilter::nearest : TextureFilter::bilinear;
  for (TextureWrap* wrap : {&s.lookup.wrap_u, &s.lookup.wrap_v}) {
    *wrap = chance(50) ? TextureWrap::cyclic : TextureWrap::clamp;
  }
  if (chance(50)) s.transparent = std::array<std::uint8_t, 3>{255, 0, 255};
  s.fog = chance(30) ? FogMode::none : has_other_mode(p.config) && chance(50) ? p.config.fog : FogMode::table;
  for (auto& channel : s.fog_color) channel = static_cast<std::uint8_t>(random());
  s.write_z = chance(80);
  s.blend = chance(70);
  s.write_color = chance(90);
  if (chance(30)) s.color_mask = static_cast<std::int32_t>(random() % 16);
  if (chance(40)) {
    s.alpha_func = static_cast<CompareFunc>(random() % enum_names<CompareFunc>.size());
    // The ends, what half an alpha is rounded to, or any.
    s.alpha_ref = static_cast<std::int32_t>(chance(20)   ? random() % 2 * 255
                                            : chance(40) ? 127 + random() % 2
                                                         : random() % 256);
  }
  if (chance(30)) s.alpha_zero = AlphaZero::keep;
  if (is_late(p.when)) s.stencil = random_stencil(random);
  // Small, of any size that a code has, or any at all.
  const int bits = chance(50) ? 4 : chance(70) ? p.config.depth_bits : 30;
  if (chance(50)) s.bias = static_cast<std::int64_t>(random() >> (64 - bits)) * (chance(50) ? 1 : -1);
  if (has_blend_equation(p.config.rtl.blend)) s.equation = random_blend(random);
  return {s, texture};
}

}  // namespace

namespace {

// Half of the values small, so that levels of any size come.
std::int64_t random_value(Random& random, const Format& f, bool small) {
  const std::int64_t raw = random_raw(random, f);
  return !small || random() % 2 == 0 ? raw : raw >> (random() % static_cast<std::uint64_t>(f.word));
}

GradientRecord random_gradient(Random& random, const Config& c) {
  GradientRecord g;
  for (std::int64_t* w : {&g.h_x, &g.h_y}) *w = random_value(random, c.format(FormatId::plane_h_grad), true);
  for (std::int64_t* w : {&g.gu_x, &g.gu_y, &g.gv_x, &g.gv_y}) {
    *w = random_value(random, c.format(FormatId::plane_g_grad), true);
  }
  return g;
}

}  // namespace

PipeCase random_pipe_case(Random& random, const Config& c, int batches, const PipeExtent& extent,
                          DepthWhen when) {
  PipeCase p;
  p.config = c;
  p.when = when;
  p.scene.width = extent.width;
  p.scene.height = extent.height;
  p.scene.background = {10, 20, 30};
  for (const auto& [width, height] : extent.textures) {
    Texture t{"t", width, height, {}};
    for (int i = 0; i < width * height; ++i) {
      const bool hole = random() % 8 == 0;
      for (int channel = 0; channel < 4; ++channel) {
        t.rgba.push_back(hole && channel < 3 ? (channel == 1 ? 0 : 255)
                                             : static_cast<std::uint8_t>(random()));
      }
    }
    p.scene.textures.push_back(t);
  }
  p.places = place_textures(c, p.scene, extent.address);
  make_chains(p);
  ConstantsRecord& k = p.constants.record;
  k.b = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_b)));
  k.c1 = is_linear_in_distance(c.depth_code) ? random_raw(random, c.format(FormatId::depth_c1)) : 0;
  k.c0 = is_linear_in_distance(c.depth_code) ? random_raw(random, c.format(FormatId::depth_c0)) : 0;
  k.fog_scale = random_raw(random, c.format(FormatId::fog_scale));
  const bool has_levels = has_levels_in_rtl(c);
  if (has_levels) {
    k.s_max = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_s)));
    p.lod = model::prepare_lod(c, p.constants);
  }
  model::DepthStage depth = model::prepare_depth(c, p.constants);
  model::TextureStage texture = model::prepare_texture(c);
  p.fog = model::prepare_fog(c, p.constants, p.scene);
  p.fog.scale.raw = k.fog_scale;
  p.fog.table.resize(std::size_t{1} << c.fog_index_bits());
  for (std::int64_t& entry : p.fog.table) entry = random_raw(random, c.format(FormatId::fog_factor));
  model::MergeStage merge = model::prepare_merge(c);
  const bool by_equation = has_blend_equation(c.rtl.blend);
  p.records["merge_alpha_record"] = {};
  clear_frame(p.frame, p.scene.width, p.scene.height, p.scene.background, clear_code(c), false);
  need_stencil(p.frame);
  const std::int64_t one = std::int64_t{1} << c.format(FormatId::texture_alpha).fraction();
  for (int batch = 0; batch < batches; ++batch) {
    auto [s, number] = random_state(random, p);
    if (has_levels && has_lod_gradients(c)) s.gradient = random_gradient(random, c);
    p.batches.push_back({draw_values(c, s), {}});
    depth.func = s.func;
    depth.bias = s.bias;
    texture.lookup = texture.magnified = s.lookup;
    texture.transparent = s.transparent;
    texture.alpha_test = model::alpha_test_of(s.alpha_func, s.alpha_ref, texture.alpha);
    texture.kills_zero = s.alpha_zero == AlphaZero::kill;
    const model::StencilStage stencil = modelled(s.stencil);
    p.fog.mode = s.fog;
    p.fog.fog_color = s.fog_color;
    model::set_blend(merge, s.equation);
    for (std::uint64_t n = random() % 6; n > 0; --n) {
      FragmentRecord f;
      f.x = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(p.scene.width));
      f.y = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(p.scene.height));
      f.h = random_value(random, c.format(FormatId::span_h), has_levels);
      for (std::int64_t* uv : {&f.u, &f.v})
        *uv = random_value(random, c.format(FormatId::span_uv), has_levels);
      for (std::int64_t* v : {&f.r, &f.g, &f.b, &f.a}) *v = random_raw(random, c.format(shade_factor(c)));
      if (random() % 4 == 0) f.a = half_of(c.format(shade_factor(c))).value_or(f.a);
      const bool back = random() % 2 == 0;
      model::FragmentChannels channels{};
      if (has_vertex_fog(c.fog)) channels[0].w = random_raw(random, c.format(FormatId::fog_factor));
      FragmentRecord judged = f;  // by depth
      if (has_own_depth(c.depth_line)) {
        judged.h = random_value(random, c.format(FormatId::span_h), has_levels);
      }
      p.batches.back().fragments.push_back(fragment_values(c, f, back, channels[0].w, judged.h));
      const std::size_t at = pixel_of(p.frame, f);
      DepthRecord d;
      TextureRecord t;
      FogRecord mist;
      MergeRecord m;
      const Texture* image = number < 0 ? nullptr : &p.scene.textures[static_cast<std::size_t>(number)];
      const model::MipChain* chain =
          has_levels && number >= 0 ? &p.chains[static_cast<std::size_t>(number)] : nullptr;
      const auto lives = [&] {
        LodRecord level;
        if (has_levels) {
          model::lod(p.lod, f, &s.gradient, {}, chain == nullptr ? 1 : static_cast<int>(chain->size()),
                     level);
          p.records["lod_record"].push_back(record_ports(c, level));
        }
        const bool is_alive =
            has_levels ? model::texture(texture, chain, f, level, t) : model::texture(texture, image, f, t);
        p.records["texture_record"].push_back(record_ports(c, t));
        return is_alive;
      };
      const auto passes = [&] {
        bool pass = model::depth(depth, judged, nullptr, p.frame.depth[at], d);
        p.records["depth_record"].push_back(record_ports(c, d));
        if (!stencil.test) return pass;
        StencilRecord r;
        pass = model::stencil(stencil, back, d, p.frame.stencil[at], r);
        p.records["stencil_record"].push_back(record_ports(c, r));
        p.frame.stencil[at] = static_cast<std::uint8_t>(r.value);
        return pass;
      };
      if (is_late(when) ? !lives() || !passes() : !passes() || !lives()) continue;
      model::fog(p.fog, f, {}, t, mist, model::NoObserve{}, &channels);
      p.records["fog_record"].push_back(record_ports(c, mist));
      if (!by_equation && !s.blend) t.a = one;
      std::uint8_t* color = p.frame.color.data() + 4 * at;
      model::merge(merge, d, t, mist, {color[0], color[1], color[2], color[3]}, m);
      p.records["merge_record"].push_back(record_ports(c, m));
      const MergeAlphaRecord alpha = model::merged_alpha(merge, t, color[3]);
      if (merge.changes_alpha) p.records["merge_alpha_record"].push_back(record_ports(c, alpha));
      p.reads += model::reads_stored_color(merge, t.a) ? 1 : 0;
      if (s.write_z) p.frame.depth[at] = static_cast<std::uint32_t>(d.z);
      if (!s.write_color) continue;
      const std::array made{m.r, m.g, m.b, alpha.a};
      for (std::size_t c = 0; c < (merge.changes_alpha ? 4 : 3); ++c) {
        if ((s.color_mask >> c & 1) != 0) color[c] = static_cast<std::uint8_t>(made[c]);
      }
    }
  }
  return p;
}

namespace {

void load_frame_state(StageBench& bench, const PipeCase& p) {
  const StageDesign design = pixel_pipe_design(p.config, p.when);
  const StageValues values = frame_values(p.config, p.constants.record, p.scene, p.lod);
  for (std::size_t i = 0; i < values.size(); ++i) bench.set_constant(design.constants[i], values[i]);
  for (const FogLoad& load : fog_loads(p.config, p.fog)) {
    bench.set_constant("load", 1);
    bench.set_constant("load_threshold", load.threshold ? 1 : 0);
    bench.set_constant("load_place", load.place);
    bench.set_constant("load_data", load.data);
    bench.clock();
  }
  bench.set_constant("load", 0);
  const std::vector<std::uint64_t> zones = zone_loads(p.config, p.lod);
  for (std::size_t level = 0; level < zones.size(); ++level) {
    bench.set_constant("load_k", 1);
    bench.set_constant("load_k_place", level);
    bench.set_constant("load_k_data", zones[level]);
    bench.clock();
  }
  bench.set_constant("load_k", 0);
}

std::uint64_t texel_of(const PipeCase& p, std::uint64_t address) {
  const std::optional<std::uint32_t> texel = texel_at(p.scene, p.chains, p.places, address);
  if (!texel) throw std::logic_error(fmt::format("address {} holds no texel", address));
  return *texel;
}

}  // namespace

PipeRun run_pipe(const PipeCase& p, const PipeWay& way, StageTrace* trace) {
  const Config& c = p.config;
  StageBench bench(pixel_pipe_design(c, p.when), way.seed);
  if (trace != nullptr) bench.keep_trace(*trace);
  if (way.sweeps_first) await_sweep(bench, c);
  load_frame_state(bench, p);
  bench.set_stalls(way.stalls);
  bench.set_stalls("in", {way.in_gap, 0});
  if (way.write_stall > 0) bench.set_stalls("color_write", {0, way.write_stall});
  if (way.z_write_stall > 0) bench.set_stalls("z_write", {0, way.z_write_stall});
  StageMemory z(bench, "z_request", "z_answer", "z_write", 2, way.latency, way.seed,
                [&](const StageMemory::Address&) {
                  return StageValues{clear_code(c), 0};
                });
  z.merge_writes([](const StageValues& held, const StageValues& written) {
    const std::uint64_t mask = written[2];
    return StageValues{(mask & 1) != 0 ? written[0] : held[0], (mask & 2) != 0 ? written[1] : held[1]};
  });
  StageMemory color(bench, "color_request", "color_answer", "color_write", 2, way.latency, way.seed,
                    [&](const StageMemory::Address&) {
                      const auto& b = p.scene.background;
                      return StageValues{b[0], b[1], b[2], 255};
                    });
  color.merge_writes(merged_color);
  std::deque<StageMemory> texels;
  for (int port = 0; port < texel_ports; ++port) {
    texels.emplace_back(bench, fmt::format("texel{}_request", port), fmt::format("texel{}_answer", port), "",
                        1, way.latency, way.seed + static_cast<std::uint64_t>(port),
                        [&](const StageMemory::Address& at) { return StageValues{texel_of(p, at[0])}; });
  }
  if (way.reset_after > 0) {
    bench.send("draw", p.batches.front().draw);
    while (bench.waiting("draw") > 0) bench.clock();
    for (const PipeBatch& batch : p.batches) {
      for (const StageValues& fragment : batch.fragments) bench.send("in", fragment);
    }
    for (int i = 0; i < way.reset_after; ++i) bench.clock();
    bench.reset();
    for (StageMemory* memory : {&z, &color}) memory->forget();
    if (way.sweeps_first) await_sweep(bench, c);
  }
  const std::uint64_t reads_before = bench.transfers("color_request");
  PipeRun run;
  std::size_t expected = 0;
  std::size_t arrived = 0;
  std::map<std::string, std::size_t> next;
  for (const auto& [tap, records] : p.records) {
    expected += records.size();
    bench.on_transfer(tap, [&, name = tap, &wanted = records](const StageValues& v) {
      const std::size_t i = next[name]++;
      if (i >= wanted.size()) throw std::logic_error(name + ": a record after the last");
      if (v != wanted[i]) {
        throw std::logic_error(
            fmt::format("{} {} is {}, expected {}", name, i, fmt::join(v, " "), fmt::join(wanted[i], " ")));
      }
      ++arrived;
      run.compared += v.size();
    });
  }
  const std::uint64_t begin = bench.clocks();
  std::size_t batch = 0;
  bool drawn = false;  // the batch's draw state is under way or taken
  bench.run_until([&] {
    run.clocks = bench.clocks() - begin;
    if (batch < p.batches.size() && bench.waiting("in") == 0) {
      if (!drawn) {
        bench.send("draw", p.batches[batch].draw);
        drawn = true;
      } else if (bench.waiting("draw") == 0) {
        for (const StageValues& fragment : p.batches[batch].fragments) bench.send("in", fragment);
        ++batch;
        drawn = false;
      }
    }
    return batch == p.batches.size() && arrived == expected;
  });
  if (arrived != expected) throw std::logic_error("a record after the last");
  if (bench.transfers("color_request") - reads_before != p.reads) {
    throw std::logic_error(fmt::format("{} reads of colours, expected {}",
                                       bench.transfers("color_request") - reads_before, p.reads));
  }
  if (bench.level("idle") != 1) throw std::logic_error("the pipe is not idle");
  for (int y = 0; y < p.frame.height; ++y) {
    for (int x = 0; x < p.frame.width; ++x) {
      const auto at = static_cast<std::size_t>(y * p.frame.width + x);
      const StageMemory::Address address{static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)};
      const std::uint8_t* wanted = p.frame.color.data() + 4 * at;
      const std::uint64_t stencil = p.frame.stencil.empty() ? 0 : p.frame.stencil[at];
      if (z.at(address) != StageValues{p.frame.depth[at], stencil} ||
          color.at(address) != StageValues{wanted[0], wanted[1], wanted[2], wanted[3]}) {
        throw std::logic_error(fmt::format("pixel {}, {} differs", x, y));
      }
      run.compared += p.frame.stencil.empty() ? 5 : 6;
    }
  }
  return run;
}

}  // namespace bitspan
