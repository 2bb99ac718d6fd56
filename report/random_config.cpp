#include "report/random_config.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "scene/random.hpp"

namespace bitspan {
namespace {

constexpr int attempts = 2000;

int between(Random& random, int low, int high) { return static_cast<int>(random.integer(low, high)); }

Rounding any_rounding(Random& random) { return static_cast<Rounding>(random.integer(0, rounding_modes - 1)); }

Overflow any_overflow(Random& random, bool is_signed) {
  return static_cast<Overflow>(random.integer(0, overflow_modes - (is_signed ? 1 : 2)));
}

// Formats whose width follows from others or which a scene must fit for it to be drawn at all.
bool keeps_range(FormatId id) {
  return id == FormatId::setup_s || id == FormatId::setup_b || id == FormatId::depth_c1 ||
         id == FormatId::depth_c0 || id == FormatId::fog_scale;
}

// Formats whose integer bits are fixed by rules between keys.
bool keeps_integer(FormatId id) {
  return id == FormatId::texture_alpha || id == FormatId::fog_factor || id == FormatId::texture_frac ||
         id == FormatId::plane_k;
}

// Whether a format's unit has depth codes in it: its integer bits follow depth.bits.
bool follows_depth(FormatId id) {
  return unit_of(id).find("depth code") != std::string_view::npos || id == FormatId::depth_c1 ||
         id == FormatId::depth_c0;
}

void change_format(Random& random, FormatId id, Format& f) {
  if (id == FormatId::merge_color) {
    f.rounding = any_rounding(random);
    return;
  }
  if (random.chance(0.6)) {
    const int delta = between(random, keeps_range(id) ? 0 : -4, 3);
    if (f.word + delta >= 1) {
      f.word += delta;  // fraction bits
    }
  }
  if (random.chance(0.6)) {
    f.rounding = any_rounding(random);
  }
  if (keeps_range(id)) {
    return;
  }
  f.overflow_expected = true;
  if (!keeps_integer(id) && random.chance(0.25)) {
    const int delta = between(random, -2, 2);
    if (f.word + delta >= 1) {
      f.word += delta;
      f.integer += delta;
    }
  }
  if (random.chance(0.4)) {
    f.overflow = any_overflow(random, f.is_signed);
  }
}

void change_unit(Random& random, Reciprocal& unit, bool may_denormalise) {
  unit.kind = static_cast<ReciprocalKind>(random.integer(0, 2));
  unit.normalize = !may_denormalise || random.chance(0.75);
  const bool lut = has_table(unit.kind);
  unit.index_bits = lut ? between(random, 2, 9) : 0;
  unit.operand_bits = lut ? unit.index_bits + between(random, 1, 12) : 0;
  unit.table_bits = lut ? between(random, 6, 22) : 0;
  unit.internal_bits = lut ? between(random, 8, 26) : 0;
  unit.steps = has_newton_steps(unit.kind) ? between(random, 0, 3) : 0;
  unit.bits_per_cycle = lut ? 1 : between(random, 1, 4);
  unit.pipelined = random.chance(0.7);
  unit.output.is_signed = false;
  if (unit.normalize) {
    const int fraction = between(random, 8, 24);
    unit.output.integer = 1;
    unit.output.word = 1 + fraction;
  } else {
    unit.output.integer = between(random, 0, 2);
    unit.output.word = unit.output.integer + between(random, 18, 34);
  }
  unit.output.rounding = any_rounding(random);
  unit.output.overflow = any_overflow(random, false);
  unit.output.overflow_expected = true;
}

// A number is a multiple of half an ulp of the accumulator it is added to.
void change_offset(Random& random, StartOffset& offset, const Format& accumulator) {
  const double half_ulp = std::ldexp(0.5, -accumulator.fraction());
  switch (random.integer(0, 3)) {
    case 0:
      offset = {true, 0.0};
      break;
    case 1:
      offset = {false, half_ulp * static_cast<double>(random.integer(-9, 9))};
      break;
    default:
      offset = {};
  }
}

Config draw(Random& random, std::span<const Config> bases) {
  Config c = bases[static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(bases.size()) - 1))];
  c.subpixel_bits = between(random, 0, 8);
  c.fill_rule = random.chance(0.7) ? FillRule::top_left : FillRule::inclusive;
  c.edge_walk = random.chance(0.6) ? EdgeWalk::exact : EdgeWalk::dda;
  c.dda_update = random.chance(0.5) ? DdaUpdate::accumulate : DdaUpdate::multiply;
  c.perspective = static_cast<Perspective>(random.integer(0, 3));
  c.numerator = random.chance(0.5) ? Numerator::pixel_centre : Numerator::ideal_line;
  c.edge_slope = random.chance(0.5) ? SlopeForm::divide : SlopeForm::reciprocal;
  c.row_slope = random.chance(0.3) ? SlopeForm::divide : SlopeForm::reciprocal;
  const int depth_before = c.depth_bits;
  c.depth_bits = between(random, 8, 24);
  c.depth_code = static_cast<DepthCode>(random.integer(0, 2));
  c.depth_rounding = any_rounding(random);
  c.depth_overflow = any_overflow(random, false);
  c.filter = random.chance(0.5) ? TextureFilter::nearest : TextureFilter::bilinear;
  c.wrap = random.chance(0.5) ? TextureWrap::cyclic : TextureWrap::clamp;
  c.transparent.reset();
  if (random.chance(0.5)) {
    c.transparent = {255, 0, 255};
  }
  c.fog = static_cast<FogMode>(random.integer(0, 2));
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    Format& f = c.format(id);
    if (follows_depth(id)) {
      f.integer += c.depth_bits - depth_before;
      f.word += c.depth_bits - depth_before;
    }
    change_format(random, id, f);
  }
  change_unit(random, c.edge_reciprocal, true);
  change_unit(random, c.row_reciprocal, true);
  change_unit(random, c.pixel_reciprocal, true);
  c.pixel_reciprocal.pipelined = true;
  change_offset(random, c.start_offset.edge_x, c.format(FormatId::edge_x_acc));
  change_offset(random, c.start_offset.edge_h, c.format(FormatId::edge_h_acc));
  change_offset(random, c.start_offset.edge_f, c.format(FormatId::edge_f));
  change_offset(random, c.start_offset.edge_shade, c.format(FormatId::edge_shade_acc));
  change_offset(random, c.start_offset.span_h, c.format(FormatId::span_h));
  const bool linear = has_linear_texture(c.perspective);
  change_offset(random, c.start_offset.span_f, c.format(linear ? FormatId::span_uv_acc : FormatId::span_f));
  change_offset(random, c.start_offset.span_shade, c.format(FormatId::span_shade_acc));
  if (random.chance(0.5)) {
    c.fog_depth_bits = between(random, 1, most_fog_depth_bits(c));
    c.fog_zone_bits = between(random, 0, most_fog_zone_bits(c));
  }
  return c;
}

bool is_legal(const Config& config, const RandomConfigOptions& options) {
  try {
    check_config(config, "random");
    if (options.check) {
      options.check(config);
    }
    if (options.rtl_only) {
      if (!has_rtl(config)) {
        return false;
      }
      static_cast<void>(emit_sv(config));
    }
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace

Config random_config(std::uint64_t seed, std::span<const Config> bases, const RandomConfigOptions& options) {
  Random random(seed);
  for (int i = 0; i < attempts; ++i) {
    Config config = draw(random, bases);
    if (is_legal(config, options)) {
      config.name = "random-" + std::to_string(seed);
      return config;
    }
  }
  throw std::logic_error("random_config: no legal configuration in 2000 draws");
}

}  // namespace bitspan
