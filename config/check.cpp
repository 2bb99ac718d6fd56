// SPDX-License-Identifier: Apache-2.0
#include "config/check.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>

#include "config/exact.hpp"
#include "config/keys.hpp"
#include "config/lines.hpp"
#include "config/modes.hpp"
#include "config/names.hpp"

namespace bitspan {
namespace {

constexpr int kMinPlaces = -32;  // of integer and fraction places of any format
constexpr int kMaxPlaces = 64;

using Result = std::optional<Violation>;

std::string describe(const Format& f) {
  return std::string(f.is_signed ? "signed" : "unsigned") + ", word " + std::to_string(f.word) + ", int " +
         std::to_string(f.integer);
}

Result in_range(const std::string& key, int value, int lowest, int highest, const std::string& why = "") {
  if (value >= lowest && value <= highest) return std::nullopt;
  return Violation{key, "is " + std::to_string(value) + "; legal: " + std::to_string(lowest) + ".." +
                            std::to_string(highest) + why};
}

// What the table of keys says of each value alone. The limits of a format's fields hang on its sign.
Result check_value(const Config& c, const Key& key) {
  const Place at = place(c, key);
  if (const auto* choice = std::get_if<Choice>(&at); choice != nullptr) {
    if (*choice->number < choice->names.size()) return std::nullopt;
    return Violation{key.path, "is no value of this key; legal: " + legal_values(key)};
  }
  if (!std::holds_alternative<int*>(at) || key.field != nullptr) return std::nullopt;
  const Limits& limits = key.row->limits;
  const int value = *std::get<int*>(at);
  const int highest = limits.highest_of == nullptr ? limits.highest : limits.highest_of(c);
  const bool zero = key.row->use.unused == Unused::zero && !is_used(c, key);
  const int lowest = zero ? 0 : limits.lowest;
  if (value >= lowest && value <= highest &&
      (!limits.power_of_two || std::has_single_bit(static_cast<unsigned>(value)))) {
    return std::nullopt;
  }
  return Violation{key.path, "is " + std::to_string(value) + "; legal: " +
                                 (limits.power_of_two ? "a power of two, " : "") + std::to_string(lowest) +
                                 ".." + std::to_string(highest) + std::string(limits.unit) +
                                 (zero                             ? " (0 where the kind does not use it)"
                                  : key.row->use.reason == nullptr ? ""
                                                                   : key.row->use.reason(c, key.i))};
}

Result check_format(const std::string& key, const Format& f) {
  if (auto v = f.is_signed ? in_range(key + ".word", f.word, 1, 64, " for a signed format")
                           : in_range(key + ".word", f.word, 1, 63, " for an unsigned format")) {
    return v;
  }
  if (auto v = in_range(key + ".int", f.integer, kMinPlaces, kMaxPlaces)) return v;
  if (auto v = in_range(key + ".int", f.integer, f.word - kMaxPlaces, f.word - kMinPlaces,
                        ", so that word - int, the fraction, is " + std::to_string(kMinPlaces) + ".." +
                            std::to_string(kMaxPlaces))) {
    return v;
  }
  if (f.overflow == Overflow::wrap_sm && !f.is_signed) {
    return Violation{
        key + ".overflow",
        "is SC_WRAP_SM in an unsigned format; legal: SC_WRAP, SC_SAT, SC_SAT_ZERO, SC_SAT_SYM, or "
        "signed = true"};
  }
  return std::nullopt;
}

bool holds_one(const Format& f) { return f.integer >= (f.is_signed ? 2 : 1) && f.fraction() >= 0; }

Result check_reciprocal(const std::string& key, const Reciprocal& r) {
  const bool lut = has_table(r.kind);
  if (lut && r.index_bits >= r.operand_bits) {
    return Violation{key + ".index_bits", "is " + std::to_string(r.index_bits) +
                                              " with operand_bits = " + std::to_string(r.operand_bits) +
                                              "; legal: index_bits < operand_bits"};
  }
  if (auto v = check_format(key + ".output", r.output)) return v;
  if (r.output.is_signed) {
    return Violation{key + ".output.signed", "is true, and a reciprocal is never negative; legal: false"};
  }
  if (r.output.fraction() < 1) {
    return Violation{key + ".output", "is " + describe(r.output) + ", with no fraction; legal: int < word"};
  }
  const bool saturates = r.output.overflow == Overflow::sat || r.output.overflow == Overflow::sat_sym;
  if (r.normalize && (r.output.integer < 0 || (r.output.integer == 0 && !saturates))) {
    return Violation{key + ".output.int",
                     "is " + std::to_string(r.output.integer) +
                         ", and a normalised reciprocal is 1/2 to 1; legal: int >= 1, or int = 0 "
                         "with overflow SC_SAT, SC_SAT_SYM"};
  }
  return std::nullopt;
}

// Half an ulp of `kept`, or a number, added in front of the narrowing to `accumulator`.
Result check_offset(const std::string& key, const StartOffset& offset, const std::string& accumulator_key,
                    const Format& accumulator, const std::string& kept_key, const Format& kept) {
  if (offset.half_ulp) {
    if (offset.value != 0) return Violation{key, "is half an ulp and a number at once; legal: one of them"};
    if (kept.fraction() <= accumulator.fraction()) return std::nullopt;
    return Violation{key, "is half an ulp of " + kept_key + " (fraction " + std::to_string(kept.fraction()) +
                              "), finer than half an ulp of the accumulator " + accumulator_key +
                              " (fraction " + std::to_string(accumulator.fraction()) +
                              "); legal: 0, or an accumulator as fine"};
  }
  const std::string half_ulp = "2^" + std::to_string(-accumulator.fraction() - 1);
  if (!std::isfinite(offset.value)) return Violation{key, "is not finite; legal: a multiple of " + half_ulp};
  const double halves = std::ldexp(offset.value, accumulator.fraction() + 1);
  if (halves != std::floor(halves)) {
    return Violation{key, "is no multiple of half an ulp of the accumulator " + accumulator_key +
                              "; legal: multiples of " + half_ulp + ", \"half_ulp\""};
  }
  if (std::abs(offset.value) > std::ldexp(1.0, accumulator.integer)) {
    return Violation{key, "is beyond the accumulator " + accumulator_key + "; legal: at most 2^" +
                              std::to_string(accumulator.integer) + " in size"};
  }
  return std::nullopt;
}

Result check_offsets(const Config& c) {
  for (const OffsetRule& rule : offset_rules(c)) {
    const std::string kept = rule.kept ? "formats." + std::string(key_of(*rule.kept)) : "depth.z";
    if (auto v = check_offset(std::string("start_offset.") + rule.key, c.start_offset.*rule.member,
                              "formats." + std::string(key_of(rule.accumulator)), c.format(rule.accumulator),
                              kept, rule.kept ? c.format(*rule.kept) : c.depth_format())) {
      return v;
    }
  }
  return std::nullopt;
}

Result check_formats(const Config& c) {
  using F = FormatId;
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<F>(i);
    if (auto v = check_format("formats." + std::string(key_of(id)), c.format(id))) return v;
  }
  const Format& color = c.format(F::merge_color);
  if (color.is_signed || color.word != 8 || color.integer != 8) {
    return Violation{"formats.merge.color", "is " + describe(color) + "; legal: unsigned, word 8, int 8"};
  }
  const Format& frac = c.format(F::texture_frac);
  if (frac.is_signed || frac.integer != 0) {
    return Violation{"formats.texture.frac", "is " + describe(frac) + "; legal: unsigned, int 0"};
  }
  const Format& share = c.format(F::lod_frac);
  if (share.is_signed || share.integer != 0) {
    return Violation{"formats.lod.frac", "is " + describe(share) + "; legal: unsigned, int 0"};
  }
  // Squares of its values times that of a focal length are compared exactly.
  const Format& g = c.format(F::distance_g);
  if (g.is_signed || g.integer < 1 || g.fraction() < 0 || g.word > 32) {
    return Violation{"formats.distance.g",
                     "is " + describe(g) + "; legal: unsigned, int 1..word, word 1..32"};
  }
  for (const F id : {F::texture_alpha, F::fog_factor}) {
    if (!holds_one(c.format(id))) {
      return Violation{"formats." + std::string(key_of(id)),
                       "is " + describe(c.format(id)) +
                           ", which cannot hold 1; legal: int >= 1 (signed: 2) and word >= int"};
    }
  }
  const Format& k = c.format(F::plane_k);
  if (!k.is_signed || k.integer < 2) {
    return Violation{"formats.plane.k",
                     "is " + describe(k) + ", which cannot hold -1..1; legal: signed, int >= 2"};
  }
  if (k.fraction() < 1 || k.fraction() > 62) {
    return Violation{"formats.plane.k",
                     "has " + std::to_string(k.fraction()) +
                         " fraction bits, and the phase on the digital line has as many; legal: "
                         "1..62"};
  }
  if (c.format(F::edge_x).fraction() < 1) {
    return Violation{"formats.edge.x",
                     "is " + describe(c.format(F::edge_x)) +
                         ", and pixel centres lie at .5; legal: a fraction of 1 bit or more, int < "
                         "word"};
  }
  return std::nullopt;
}

Result check_memory(const Config& c) {
  const MemoryTiming& m = c.memory;
  const auto too_short = [&](bool is_used, const std::string& key, int line_bytes) -> Result {
    if (!is_used || line_bytes >= m.width_bytes) return std::nullopt;
    return Violation{key, "is " + std::to_string(line_bytes) +
                              ", less than one beat of the memory; legal: at least width_bytes, " +
                              std::to_string(m.width_bytes)};
  };
  if (auto v = too_short(true, "memory.cache_line_bytes", m.cache_line_bytes)) return v;
  if (auto v = too_short(has_cache(m.depth_cache.mode), "memory.depth_cache_line_bytes",
                         m.depth_cache.line_bytes)) {
    return v;
  }
  return too_short(has_cache(m.color_cache.mode), "memory.color_cache_line_bytes", m.color_cache.line_bytes);
}

// The modes that channels stand in for lines of the fragment.
Result check_lines(const Config& c) {
  const auto undivided = [&](std::string_view key, std::string_view value) {
    return Violation{std::string(key), "is " + std::string(value) +
                                           ", and needs a quotient per pixel; legal: another value, or "
                                           "perspective.mode = delta_f, hyperbolic without subspan_bits"};
  };
  const bool divides = divides_each_pixel(c);
  if (has_perspective_shades(c.shade_lines) && !divides) {
    return undivided("perspective.shades", to_string(c.shade_lines));
  }
  if (has_second_coordinates(c.second_coordinates) && !divides) {
    return undivided("texture.second", to_string(c.second_coordinates));
  }
  if (has_own_depth(c.depth_line) && !is_linear_in_h(c.depth_code)) {
    return Violation{"depth.line",
                     "is " + std::string(to_string(c.depth_line)) +
                         ", and the code takes h + B; legal: h, or depth.code = inverse, opengl"};
  }
  return std::nullopt;
}

// What a line has not: a plane, and with it gradients and channels.
Result check_line_walk(const Config& c) {
  if (!has_lines(c.line_walk)) return std::nullopt;
  const auto refuse = [&](std::string_view text) {
    return Violation{"line.walk", "is " + std::string(to_string(c.line_walk)) + ", and " + std::string(text)};
  };
  if (has_plane_rows(c.perspective)) {
    return refuse(
        "a line has no rows of constant depth; legal: none, or perspective.mode = delta_f, hyperbolic, "
        "affine");
  }
  if (has_setup_plane(c)) {
    return refuse("a line has no plane; legal: none, or slope.row = divide, reciprocal");
  }
  if (has_setup_gradients(c)) {
    return refuse(
        "a line has no gradients; legal: none, or a depth.code other than float_dz and lod.mode none, "
        "zone_s, "
        "zone_d");
  }
  if (ChannelList(c).size() > 0) {
    return refuse("a line has no channels; legal: none, or a configuration without channels");
  }
  return std::nullopt;
}

Result check_exact(const Config& c) {
  for (const ExactIntermediate& x : exact_intermediates(c)) {
    if (x.bits <= exact_bits_limit) continue;
    return Violation{x.key, "stage " + x.stage + ": the exact value of `" + x.expression + "` takes " +
                                std::to_string(x.bits) + " bits" +
                                (x.formats.empty() ? "" : " with " + x.formats) + "; legal: at most " +
                                std::to_string(exact_bits_limit) +
                                (x.formats.empty() ? " (fewer subpixel_bits or coordinate_bits)" : "")};
  }
  return std::nullopt;
}

}  // namespace

std::array<OffsetRule, 7> offset_rules(const Config& c) {
  using F = FormatId;
  using O = StartOffsets;
  const bool linear_uv = has_linear_texture(c.perspective);
  return {{{"edge_x", &O::edge_x, F::edge_x_acc, F::edge_x},
           {"edge_h", &O::edge_h, F::edge_h_acc, F::edge_h},
           {"edge_f", &O::edge_f, F::edge_f, F::edge_f},
           {"edge_shade", &O::edge_shade, F::edge_shade_acc, F::edge_shade},
           {"span_h", &O::span_h, F::span_h, std::nullopt},
           {"span_f", &O::span_f, linear_uv ? F::span_uv_acc : F::span_f, linear_uv ? F::span_uv : F::span_f},
           {"span_shade", &O::span_shade, F::span_shade_acc, F::span_shade}}};
}

int most_fog_depth_bits(const Config& c) { return std::min(c.depth_bits, max_fog_index_bits); }
int most_fog_zone_bits(const Config& c) { return std::min(8, max_fog_index_bits - c.fog_depth_bits); }

Result first_violation(const Config& c) {
  for (const Key& key : keys()) {
    if (auto v = check_value(c, key)) return v;
  }
  if (auto v = check_reciprocal("reciprocal.edge", c.edge_reciprocal)) return v;
  if (auto v = check_reciprocal("reciprocal.row", c.row_reciprocal)) return v;
  if (auto v = check_reciprocal("reciprocal.pixel", c.pixel_reciprocal)) return v;
  if (!c.pixel_reciprocal.pipelined) {
    return Violation{"reciprocal.pixel.pipelined",
                     "is false, and the span takes one pixel per clock; legal: true"};
  }
  if (c.rtl.pixel_clocks > 1 && c.rtl.pixel_clocks < 2 * c.rtl.product_digits) {
    return Violation{"rtl.pixel_clocks",
                     "is " + std::to_string(c.rtl.pixel_clocks) + ", and u and v have one multiplier for " +
                         std::to_string(c.rtl.product_digits) + " clocks each; legal: 1, or at least " +
                         std::to_string(2 * c.rtl.product_digits)};
  }
  if (has_lod_gradients(c) && has_linear_edges(c.perspective)) {
    return Violation{"lod.mode", "is " + std::string(to_string(c.lod)) +
                                     ", and an affine texture has no gradients in perspective; legal: none, "
                                     "zone_s, zone_d, or another perspective.mode"};
  }
  if (has_setup_plane(c) && has_plane_rows(c.perspective)) {
    return Violation{
        "slope.row",
        "is plane, and const_depth_rows has no row slopes; legal: divide, reciprocal, or another "
        "perspective.mode"};
  }
  if (has_project(c.project) && !is_linear_in_h(c.depth_code)) {
    return Violation{"project.unit",
                     "is " + std::string(to_string(c.project)) +
                         ", and forms depth codes of h alone; legal: none, or depth.code = inverse, opengl"};
  }
  if (has_light(c.light) && takes_map(c.light_normal) && !lights_pixels(c.light)) {
    return Violation{"light.normal", "is map with light.at = " + std::string(to_string(c.light)) +
                                         ", which has no texels; legal: channel, or light.at = pixel"};
  }
  if (has_light(c.light) && takes_shadow(c.light_shadow) && !lights_pixels(c.light)) {
    return Violation{"light.shadow", "is map with light.at = " + std::string(to_string(c.light)) +
                                         ", which has no texels; legal: none, or light.at = pixel"};
  }
  if (has_light(c.light) && falls(c.light_fall) && !has_points(c.light_source)) {
    return Violation{"light.fall", "is " + std::string(to_string(c.light_fall)) +
                                       " with light.source = parallel, which forms no place; legal: none, or "
                                       "light.source = point"};
  }
  if (has_light(c.light) && c.light_root.index_bits >= c.light_root.operand_bits) {
    return Violation{"light.root.index_bits",
                     "is " + std::to_string(c.light_root.index_bits) + " with operand_bits = " +
                         std::to_string(c.light_root.operand_bits) + "; legal: index_bits < operand_bits"};
  }
  if (auto v = check_lines(c)) return v;
  if (auto v = check_line_walk(c)) return v;
  if (c.depth_overflow == Overflow::wrap_sm) {
    return Violation{
        "depth.overflow",
        "is SC_WRAP_SM, and the code is unsigned; legal: SC_WRAP, SC_SAT, SC_SAT_ZERO, SC_SAT_SYM"};
  }
  if (auto v = check_formats(c)) return v;
  if (auto v = check_offsets(c)) return v;
  if (auto v = check_memory(c)) return v;
  return check_exact(c);
}

void check_config(const Config& config, const std::string& origin) {
  if (const auto v = first_violation(config)) throw InputError(origin + ": " + v->key + ": " + v->text);
}

}  // namespace bitspan
