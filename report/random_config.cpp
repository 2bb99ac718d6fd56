// SPDX-License-Identifier: Apache-2.0
#include "report/random_config.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "config/check.hpp"
#include "config/keys.hpp"
#include "config/modes.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "engine/emit_sv.hpp"
#include "scene/random.hpp"

namespace bitspan {
namespace {

constexpr int attempts = 2000;
// The probability that a key takes any legal value, however seldom a scene can be drawn with it.
constexpr double any_value = 1.0 / 16;
// The probability that a key that may be left out takes another value than its default.
constexpr double later_value = 1.0 / 4;
// The same with RandomConfigOptions::even.
constexpr double even_value = 3.0 / 4;
// The probability that a key with a wide range is at its highest: a timed run may take long then.
constexpr double highest_value = 1.0 / 256;

int between(Random& random, int low, int high) { return static_cast<int>(random.integer(low, high)); }

template <class E>
E any_name(Random& random) {
  return static_cast<E>(random.integer(0, static_cast<std::int64_t>(enum_names<E>.size()) - 1));
}

Overflow any_overflow(Random& random, bool is_signed) {
  const auto overflow = any_name<Overflow>(random);
  return !is_signed && overflow == Overflow::wrap_sm ? Overflow::wrap : overflow;
}

// Any value of the row. Wide ranges: mostly of their first 64 values, and both ends.
int any_integer(Random& random, const Config& c, const Limits& limits) {
  const int highest = limits.highest_of == nullptr ? limits.highest : limits.highest_of(c);
  if (limits.power_of_two) {
    return 1 << between(random, std::countr_zero(static_cast<unsigned>(limits.lowest)),
                        std::countr_zero(static_cast<unsigned>(highest)));
  }
  if (highest - limits.lowest < 64) return between(random, limits.lowest, highest);
  if (random.chance(highest_value)) return highest;
  return limits.lowest - 1 + static_cast<int>(random.log_uniform(1, 64));
}

// What the table alone says; formats are drawn when all else is known.
void draw_value(Random& random, const Config& c, const Key& key, const Place& to) {
  if (const auto* integer = std::get_if<int*>(&to)) {
    **integer = any_integer(random, c, key.row->limits);
  } else if (const auto* truth = std::get_if<bool*>(&to)) {
    **truth = random.chance(0.5);
  } else if (const auto* choice = std::get_if<Choice>(&to)) {
    *choice->number =
        static_cast<std::uint8_t>(random.integer(0, static_cast<std::int64_t>(choice->names.size()) - 1));
  } else if (const auto* offset = std::get_if<StartOffset*>(&to)) {
    **offset = {random.chance(0.25), 0.0};
  } else if (const auto* color = std::get_if<Color*>(&to)) {
    **color = std::nullopt;
    if (random.chance(0.5)) **color = {{255, 0, 255}};
  } else if (const auto* rgba = std::get_if<Rgba*>(&to)) {
    for (std::uint8_t& code : **rgba) code = static_cast<std::uint8_t>(random.integer(0, 255));
  }
}

// Formats whose width follows from others or which a scene must fit for it to be drawn at all.
bool keeps_range(FormatId id) {
  return id == FormatId::setup_s || id == FormatId::setup_b || id == FormatId::depth_c1 ||
         id == FormatId::depth_c0 || id == FormatId::fog_scale;
}

// Formats whose integer bits are fixed by rules between keys.
bool keeps_integer(FormatId id) {
  return id == FormatId::texture_alpha || id == FormatId::fog_factor || id == FormatId::texture_frac ||
         id == FormatId::lod_frac || id == FormatId::plane_k;
}

// How many of the bits of depth.bits a format's integer bits hold.
int depth_powers(FormatId id) {
  if (id == FormatId::depth_c1) return 2;
  return unit_of(id).find("depth code") != std::string_view::npos || id == FormatId::depth_c0 ? 1 : 0;
}

// wider: bits that depth.bits has more than the base; dropped: fraction bits that go in return, which keeps
// the precision of h + B.
void follow_depth(FormatId id, Format& f, int wider, int dropped) {
  const int powers = depth_powers(id);
  const int most = f.is_signed ? 64 : 63;
  f.integer = std::min(f.integer + powers * wider, 63);
  f.word = std::clamp(f.word + powers * (wider - dropped), std::max(1, f.integer - 62), most);
}

void change_format(Random& random, FormatId id, Format& f, const RandomConfigOptions& options) {
  const bool for_scenes = options.for_scenes;
  if (id == FormatId::merge_color) {
    f.rounding = any_name<Rounding>(random);
    return;
  }
  if (random.chance(any_value / 16)) {  // any shape
    f.is_signed = random.chance(0.5);
    f.integer = between(random, -32, 64);
    f.word = between(random, 1, f.is_signed ? 64 : 63);
    if (random.chance(0.5)) f.word = random.chance(0.5) ? 1 : f.is_signed ? 64 : 63;
    if (random.chance(0.5)) f.integer = std::clamp(random.chance(0.5) ? -32 : 64, f.word - 64, f.word + 32);
    if (!f.is_signed && f.overflow == Overflow::wrap_sm) f.overflow = Overflow::wrap;
    f.overflow_expected = true;
    return;
  }
  const bool keeps = for_scenes && keeps_range(id);
  if (random.chance(0.6)) {
    const int delta = between(random, keeps ? 0 : -4, 3);  // fraction bits
    if (f.word + delta >= 1) f.word = std::min(f.word + delta, f.is_signed ? 64 : 63);
  }
  // A build is dear: each register of one rounds and overflows as it may.
  const bool dear = options.pixel_rtl_turn.has_value();
  if (dear || random.chance(0.6)) f.rounding = any_name<Rounding>(random);
  if (keeps && options.even && random.chance(0.4)) f.overflow = any_overflow(random, f.is_signed);
  if (keeps) return;
  f.overflow_expected = true;
  if (!for_scenes && id != FormatId::setup_b && !keeps_integer(id) && random.chance(0.2)) {
    f.is_signed = !f.is_signed;
    f.overflow = any_overflow(random, f.is_signed);
  }
  if (!keeps_integer(id) && random.chance(dear ? 0.5 : for_scenes ? 0.25 : 0.7)) {
    const int delta = between(random, dear ? -5 : for_scenes ? -2 : -3, 2);
    if (f.word + delta >= 1 && f.word + delta <= 63) {
      f.word += delta;
      f.integer += delta;
    }
  }
  if (dear || random.chance(0.4)) f.overflow = any_overflow(random, f.is_signed);
}

// The kind, normalisation, steps and so on are drawn; these are the widths that go together.
void change_unit(Random& random, Reciprocal& unit) {
  if (!random.chance(any_value)) {
    unit.index_bits = between(random, 2, 9);
    unit.operand_bits = unit.index_bits + between(random, 1, 12);
    unit.table_bits = between(random, 6, 22);
    unit.internal_bits = between(random, 8, 26);
  } else {
    unit.operand_bits = between(random, 2, 60);
    if (random.chance(0.25)) unit.operand_bits = random.chance(0.5) ? 2 : 60;
    unit.index_bits = std::min(unit.index_bits, unit.operand_bits - 1);
    unit.table_bits = between(random, 2, 40);
    unit.internal_bits = between(random, 2, 60);
    if (random.chance(0.25)) unit.internal_bits = random.chance(0.5) ? 2 : 60;
  }
  if (random.chance(0.5)) unit.normalize = true;
  unit.output.is_signed = false;
  if (unit.normalize) {
    unit.output.integer = 1;
    unit.output.word = 1 + between(random, 8, 24);
  } else {
    unit.output.integer = between(random, 0, 2);
    unit.output.word = unit.output.integer + between(random, 18, 34);
  }
  if (random.chance(any_value)) unit.output.word = unit.output.integer + between(random, 1, 62);
  unit.output.rounding = any_name<Rounding>(random);
  unit.output.overflow = any_overflow(random, false);
  unit.output.overflow_expected = true;
}

// A number is a multiple of half an ulp of the accumulator it is added to.
void change_offset(Random& random, StartOffset& offset, const Format& accumulator) {
  if (offset.half_ulp || random.chance(0.6)) return;
  offset.value = std::ldexp(static_cast<double>(random.integer(-9, 9)), -accumulator.fraction() - 1);
}

// One of those that the RTL has.
template <class E>
void choose_in_rtl(Random& random, E& name) {
  while (!is_in_rtl(name)) name = any_name<E>(random);
}

// The names of a mode one after another, the last one first.
template <class E>
E by_turn(std::uint64_t turn) {
  constexpr std::size_t names = enum_names<E>.size();
  return static_cast<E>(names - 1 - turn % names);
}

void choose_pixel_rtl(Random& random, Config& c, std::uint64_t turn) {
  choose_in_rtl(random, c.depth_code);
  choose_in_rtl(random, c.filter);
  choose_in_rtl(random, c.wrap);
  choose_in_rtl(random, c.fog);
  choose_in_rtl(random, c.lod);
  c.perspective = static_cast<Perspective>(turn % enum_names<Perspective>.size());
  c.mip = by_turn<MipMode>(turn);
  c.rtl.blend = by_turn<RtlBlend>(turn);
  // What the span interpolator computes in every mode: one after another they round and overflow in each way,
  // and are too narrow for some pixels.
  constexpr std::array dealt{FormatId::span_h_step, FormatId::span_shade_step, FormatId::span_uv};
  c.rtl.shades = c.rtl.shades || random.chance(0.75);
  for (std::size_t i = 0; i < dealt.size(); ++i) {
    Format& f = c.format(dealt[i]);
    f.rounding = by_turn<Rounding>(turn * dealt.size() + i);
    if (f.is_signed) f.overflow = by_turn<Overflow>(turn * dealt.size() + i);
    const int fewer = random.chance(0.75) ? between(random, 4, 10) : 0;
    if (f.word - fewer < 4) continue;
    f.word -= fewer;
    f.integer -= fewer;
  }
  if (!has_lod(c)) return;
  // A level that is the bias, whatever the pixel, shows little.
  if (random.chance(0.1)) {
    c.lod = LodMode::none;
    return;
  }
  std::vector<LodMode> modes;
  for (std::size_t i = 0; i < enum_names<LodMode>.size(); ++i) {
    const auto mode = static_cast<LodMode>(i);
    if ((has_zones(mode) || has_gradients(mode)) && is_in_rtl(mode)) modes.push_back(mode);
  }
  c.lod = modes[modes.size() - 1 - turn % modes.size()];
}

// A key that may be left out.
void draw_later(Random& random, Config& c, const Key& key, const RandomConfigOptions& options) {
  const Place to = place(c, key);
  draw_value(random, c, key, to);
  auto* const* format = std::get_if<Format*>(&to);
  // The output of a unit is a format, too.
  if (format != nullptr && *format == &c.format(static_cast<FormatId>(key.i)))
    change_format(random, static_cast<FormatId>(key.i), **format, options);
}

Config draw(Random& random, std::span<const Config> bases, const RandomConfigOptions& options) {
  const Config& base =
      bases[static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(bases.size()) - 1))];
  Config c = base;
  const int base_depth_bits = c.depth_bits;
  const auto is_later = [](const Key& key) { return key.presence() == Presence::later; };
  for (const Key& key : entries()) {
    if (!is_later(key)) draw_value(random, c, key, place(c, key));
  }

  // What must fit something else, or seldom can be drawn.
  if (c.coordinate_bits < options.least_coordinate_bits) {
    c.coordinate_bits = between(random, options.least_coordinate_bits, 24);
  }
  if (has_setup_plane(c) && (options.rtl_only || has_plane_rows(c.perspective))) {
    c.row_slope = RowSlope::reciprocal;
  }
  if (options.rtl_only) {
    c.perspective = random.chance(0.4) ? Perspective::delta_f : any_name<Perspective>(random);
  }
  if (c.depth_overflow == Overflow::wrap_sm) c.depth_overflow = Overflow::wrap;
  if (random.chance(0.5)) {
    c.depth_bits = between(random, 8, 24);
    c.fog_depth_bits = std::min(c.fog_depth_bits, c.depth_bits);
  }
  c.memory.cache_line_bytes = std::max(c.memory.cache_line_bytes, c.memory.width_bytes);
  const int wider = c.depth_bits - base_depth_bits;
  const int dropped = wider <= 0 ? 0 : between(random, c.depth_bits > 24 ? wider / 2 : 0, wider);
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    if (default_format(c.formats, id)) continue;
    follow_depth(id, c.format(id), wider, dropped);
    change_format(random, id, c.format(id), options);
  }
  for (Reciprocal* unit : {&c.edge_reciprocal, &c.row_reciprocal, &c.pixel_reciprocal}) {
    change_unit(random, *unit);
  }
  c.pixel_reciprocal.pipelined = true;
  for (const OffsetRule& rule : offset_rules(c)) {
    change_offset(random, c.start_offset.*rule.member, c.format(rule.accumulator));
  }
  // After all others, so that a new key changes little of what a seed draws.
  for (const Key& key : entries()) {
    if (!is_later(key)) continue;
    if (is_left_out(base, key)) set_default(c, key);
    if (random.chance(options.even ? even_value : later_value)) draw_later(random, c, key, options);
  }
  if (options.pixel_rtl_turn) choose_pixel_rtl(random, c, *options.pixel_rtl_turn);
  return c;
}

bool is_legal(const Config& config, const RandomConfigOptions& options) {
  try {
    check_config(config, "random");
    if (options.check) {
      options.check(config);
    }
    if (options.rtl_only) static_cast<void>(emit_sv(config));
    if (options.pixel_rtl_turn && !has_pixel_rtl(config)) return false;
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace

Config draw_config(std::uint64_t seed, std::span<const Config> bases, const RandomConfigOptions& options) {
  Random random(seed);
  return draw(random, bases, options);
}

Config random_config(std::uint64_t seed, std::span<const Config> bases, const RandomConfigOptions& options) {
  Random random(seed);
  for (int i = 0; i < attempts; ++i) {
    Config config = draw(random, bases, options);
    if (is_legal(config, options)) {
      config.name = "random-" + std::to_string(seed);
      return config;
    }
  }
  throw std::logic_error("random_config: no legal configuration in 2000 draws");
}

namespace {

// What the RTL is built from, without the first lines, which name the configuration.
std::string rtl_packages(const Config& config) {
  std::string out;
  for (const std::string& package : {emit_sv(config), emit_pixel_sv(config)})
    out += package.substr(package.find('\n'));
  return out;
}

}  // namespace

Config vary_beside_rtl(std::uint64_t seed, const Config& config, const RandomConfigOptions& options) {
  Random random(seed);
  const std::string packages = rtl_packages(config);
  Config out = config;
  for (const Key& key : entries()) {
    if ((affected(key) & affects::rtl) != 0 || !random.chance(even_value)) continue;
    // A few times, since much of what is drawn is another design.
    for (int i = 0; i < 4; ++i) {
      Config next = out;
      draw_later(random, next, key, options);
      if (!is_legal(next, options) || rtl_packages(next) != packages) continue;
      out = next;
      break;
    }
  }
  out.name = "random-" + std::to_string(seed);
  return out;
}

}  // namespace bitspan
