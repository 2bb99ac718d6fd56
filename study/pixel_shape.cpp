// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "study/shape_cells.hpp"

namespace bitspan {
namespace {

// Bits at the end of a value on so many fraction bits that the rounding does not read: rtl/quantize_far.sv.
int unread_bits(int fraction, const Format& to) {
  const int dropped = std::max(0, fraction - to.fraction());
  if (to.rounding == Rounding::trn) return dropped;
  return to.rounding == Rounding::rnd ? std::max(0, dropped - 1) : 0;
}

// rtl/pixel_pipe.sv. What only the taps read is left out, as the synthesis does.
class PixelCounter : private ShapeCells {
 public:
  PixelCounter(const Config& config, AreaTarget target)
      : ShapeCells(config),
        timing_(pixel_timing(config)),
        late_(target.part == AreaPart::late_pixels),
        has_lut_memory_(target.family == Family::ecp5),
        coordinates_(2 * pixel_index_bits(config)),
        shades_(2 * word(F::span_uv) + 4 * word(shade_factor(config))),
        color_(3 * word(F::texture_color)),
        alpha_(word(F::texture_alpha)),
        has_line_(has_own_depth(config.depth_line)),
        tag_(timing_.slot_bits + (has_line_ ? word(F::span_h) : 0) +
             (has_vertex_fog(config.fog) ? word(F::fog_factor) : 0)),
        mixes_(timing_.has_lod && mixes_levels(config.mip)) {}
  AreaShape count() {
    draw_state();
    depth();
    if (late_) stencil();
    if (timing_.has_lod) lod();
    texture();
    fog();
    merge();
    return shape_;
  }

 private:
  using F = FormatId;

  // What a fragment brings along to depth, and to texture.
  int depth_rest() const { return tag_ + (late_ ? 1 + color_ + alpha_ : shades_); }
  int texture_rest() const {
    return tag_ + coordinates_ + (late_ ? h_of_depth() + 1 : h_of_fog() + c_.depth_bits + 1);
  }

  // Bits of h that fog reads, and the stages behind depth, and those from depth on. Where depth has a line of
  // its own, h is in the tag, and the line goes this way.
  int h_of_fog() const {
    if (has_line_) return 0;
    const Format& h = format(F::span_h);
    const int unread = h.fraction() + c_.depth_bits - c_.fog_depth_bits;
    return is_linear_in_distance(c_.fog) ? h.word
                                         : some_of_h(unread, late_ ? depth_rest() + 6 : c_.depth_bits + 1);
  }
  int h_of_depth() const {
    const Format& h = format(F::span_h);
    if (is_linear_in_distance(c_.depth_code)) return h.word;
    return std::max(h_of_fog(),
                    some_of_h(unread_bits(h.fraction(), c_.depth_format()), late_ ? 1 : c_.depth_bits + 1));
  }
  int h_behind_depth() const {
    const bool is_of_lod = !late_ && timing_.has_lod && takes_pixel_reciprocal(c_.lod);
    return is_of_lod && !has_line_ ? word(F::span_h) : h_of_fog();
  }
  // The lowest bits are not read. A memory holds some bits together, and keeps those beside bits that are
  // read. `at` is the place of h in the memory.
  int some_of_h(int unread, int at) const {
    const int h = word(F::span_h);
    const int together = has_lut_memory_ ? 4 : 16;
    const int dead = std::clamp(unread, 0, h);
    const int low = std::min(dead, (together - at % together) % together);
    return h - dead + low + std::min(dead - low, (at + dead) % together);
  }

  // ---------------------------------------------------------------- cells

  // rtl/skid.sv.
  void skid(int width) {
    add_registers(2 * width + 2);
    shape_.selects += width;
  }
  // rtl/fifo.sv.
  void fifo(int width, Memory::Kind kind = Memory::Kind::unclocked) {
    const int depth = timing_.in_flight;
    const int place = bits_of(depth - 1);
    memory(depth, width, kind);
    add_registers(2 * place + bits_of(depth) + 2);
    shape_.sums += 2 * place + bits_of(depth);
  }
  // rtl/ring_line.sv.
  void ring_line(int width, int depth) {
    if (width == 0) return;
    if (depth < 4) {
      add_registers(width, depth);
      return;
    }
    memory(depth - 1, width, Memory::Kind::line);
    add_registers(width + bits_of(depth - 2));
    shape_.sums += bits_of(depth - 2);
  }
  // rtl/shift_stage.sv.
  void shift_stage(int clocks, int rest, int made) {
    add_registers(clocks);
    ring_line(rest, clocks);
    skid(rest + made);
  }
  // A constant of the frame, or a field, against another: an LUT takes two bits of each.
  void compare(int width, int times = 1) { shape_.selects += double(width) * times; }

  // rtl/scoreboard.sv.
  void scoreboard(int width, int ways) {
    const int place = timing_.place_bits;
    const int carried = coordinates_ + width;
    skid(place + carried);
    add_registers(carried + place, 3);
    add_registers(place + 5);
    for (int i = 0; i <= ways; ++i) memory(1 << place, 1, Memory::Kind::clocked);
    add_registers(3 * (1 + ways) + ways);  // what was read, what turned since, what is known; the marks
    shape_.sums += place;
    compare(place, 3 + 4 * ways);
  }

  // rtl/pixel_reciprocal.sv.
  void pixel_reciprocal() {
    const Grid operand = pixel_operand(c_);
    shape_.sums += operand.bits();
    add_registers(operand.bits());
    reciprocal(c_.pixel_reciprocal, operand);
  }

  // rtl/multiply_round.sv with R_pixel: a word on so many fraction bits, and so many bits of c that are no
  // constants.
  void times_reciprocal(int a, bool a_signed, int a_fraction, int c, int c_fraction, int clocks,
                        const Format& to, bool own_shift = true) {
    const Format& m = c_.pixel_reciprocal.output;
    const Exponents e = exponents_of(c_.pixel_reciprocal, pixel_operand(c_));
    const int fraction = std::max(c_fraction, to.fraction() + 1);
    const int placed = c + fraction - c_fraction + (to.rounding == Rounding::rnd ? 1 : 0);
    const int kept = std::max(to.word + fraction - to.fraction() + 1, placed) + 4;
    const int shift_max = e.high - e.low;
    const int base = a_fraction + m.fraction() + e.low - fraction;
    const bool floors = to.rounding == Rounding::trn || to.rounding == Rounding::rnd;
    if (own_shift) add_registers(bits_of(shift_max), clocks);
    if (c > 2) add_registers(placed, clocks + 2);
    multiply(a, a_signed, m.word, m.is_signed, {.low = floors ? std::max(0, base) : 0, .clocks = clocks});
    shift_add(a + m.word, base, shift_max, kept);
    if (!floors) shape_.sums += to.word;
    quantize(to);
    add_registers(to.word);
  }

  // rtl/blend.sv; the register of e serves all blends beside it.
  void blend(Grid a, Grid b, const Format& e, const Format& to, int clocks) {
    const int fraction = std::max(a.fraction, b.fraction);
    const Grid difference = b - a;
    const int from = as_signed(aligned(a, fraction)).bits();
    const int product = difference.bits() + signed_bits(e);
    const int sum = std::max(from + e.fraction(), product) + 1;
    const int unread = unread_bits(fraction + e.fraction(), to);
    const int own = a.integer + a.fraction + (a.is_signed ? 1 : 0);
    add_registers(difference.bits());
    add_registers(own, 1 + clocks);
    multiply(difference.bits(), true, signed_bits(e), true,
             {.low = std::min(unread, e.fraction()), .clocks = clocks});
    add_registers(sum - unread + to.word);
    shape_.sums += difference.bits() + sum - std::min(unread, e.fraction());
    round(to);
  }

  // ---------------------------------------------------------------- rtl/pixel_pipe.sv

  // A register of the draw state, by slot. Its address comes from a register, which Yosys takes into the
  // memory.
  void state(int width, int reads = 1) {
    memory(1 << timing_.slot_bits, width, Memory::Kind::clocked, reads);
  }

  void draw_state() {
    const int slots = 1 << timing_.slot_bits;
    const int ways = late_ ? 4 : 3;
    const int count = bits_of(4 * timing_.in_flight + 512 - 1);
    const int pitch = bits_of(texel_index_bits);
    state(1);   // whether depth is written
    state(12);  // the alpha test
    state(c_.depth_bits + 1);
    state(5 + 2 * texel_index_bits + pitch + texel_address_bits + 24);
    state(26);  // fog
    state(1);   // whether the colour is written
    state(4);
    if (late_) {
      state(3);
      state(1, 2);
      state(72);  // both sides of the stencil test
      shape_.selects += 36 + 3 + 8;
    } else {
      add_registers(3);
    }
    add_registers(timing_.slot_bits * (2 + ways) + 4 + ways);
    add_registers(count, slots);
    shape_.sums += 2.0 * slots * count;
    compare(timing_.slot_bits, slots * (1 + ways));
    compare(count, slots);
  }

  // ---------------------------------------------------------------- depth

  void depth() {
    const int z = c_.depth_bits;
    const int func = late_ ? 4 : 3;
    const int stored = z + (late_ ? 8 : 0);
    const int waits = coordinates_ + h_behind_depth() + func + 2 + depth_rest();
    scoreboard(std::max(h_of_depth(), h_behind_depth()) + func + depth_rest(), 2);
    skid(coordinates_);
    add_registers(timing_.depth.code);
    depth_code();
    fifo(waits);
    fifo(z);
    skid(stored);
    shape_.sums += 2 * (z + 2);  // the bias, and its saturation
    shape_.selects += z;
    // Joined and compared; the stored code itself goes no further.
    add_registers(waits + z + stored);
    add_registers(waits + stored);
    add_registers(4);
    shape_.sums += 2 * z;
    skid(coordinates_ + h_behind_depth() + z + 1 + depth_rest() + (late_ ? 9 : 0));
    skid(coordinates_ + z + 2 + (late_ ? 9 : 0));
  }

  // rtl/depth_code.sv.
  void depth_code() {
    const Format to = c_.depth_format();
    const Format& h = format(F::span_h);
    if (is_linear_in_distance(c_.depth_code)) {
      const Format& c1 = format(F::depth_c1);
      const Format& c0 = format(F::depth_c0);
      pixel_reciprocal();
      times_reciprocal(c1.word, c1.is_signed, c1.fraction(), c0.word + 2, c0.fraction(),
                       timing_.depth.product, to);
      shape_.sums += c0.word;
      return;
    }
    if (is_complement_of_h(c_.depth_code)) {
      const int fraction = std::max(0, h.fraction());
      const int difference = std::max(c_.depth_bits + fraction, h.word + fraction - h.fraction()) + 3;
      add_registers(difference - unread_bits(fraction, to));
      shape_.sums += difference;
    }
    round(to);
    add_registers(to.word);
  }

  // rtl/stencil.sv.
  void stencil() {
    add_registers(29 + 9);
    shape_.sums += 4 * 8;
    shape_.selects += 8 * 8 + 2 * 8 + 2 * 8;
    // A tap has what else was known of the test.
    const int brought = 8 + coordinates_ + h_behind_depth() + c_.depth_bits + 1 + depth_rest() - 1;
    shift_stage(timing_.stencil.clocks, brought, 9);
  }

  // ---------------------------------------------------------------- lod

  void lod() {
    const LodTiming& t = timing_.lod;
    const Format& lambda = format(F::lod_lambda);
    const int level = bits_of(max_mip_level);
    const bool gradient = has_gradients(c_.lod);
    const bool zone = has_zones(c_.lod);
    state(level + (gradient ? 2 * word(F::plane_h_grad) + 4 * word(F::plane_g_grad) : 0));
    if (zone || gradient) pixel_reciprocal();
    if (zone) lod_zone();
    if (gradient) lod_gradient();
    ring_line(level, t.clocks - 2);  // the last level
    const int held = std::max(1, lambda.fraction());
    if (zone || gradient) {
      add_registers(lambda.word);
      round(lambda);
    }
    // Held within the chain; level and f.
    const int f = mixes_ ? word(F::lod_frac) : 0;
    add_registers(level + (mixes_ ? held : 1) + level + f);
    shape_.sums += lambda.word + level;
    shape_.selects += 2 * (level + held);
    if (mixes_) round(format(F::lod_frac));
    shift_stage(t.clocks, texture_rest() + shades_, level + f);
  }

  void lod_zone() {
    const LodTiming& t = timing_.lod;
    const Format& a = format(F::distance_a);
    const Format& s = format(F::distance_s);
    const Format& k = format(F::lod_k);
    const Grid into = signed_grid(s) - zone_starts();
    const int level = bits_of(max_mip_level);
    times_reciprocal(a.word, a.is_signed, a.fraction(), 1, 0, t.distance_product, s);
    const int reached = 1 + timing_.pixel_unit + t.distance_product + 4;
    add_registers(s.word, 3);
    ring_line(level, reached);
    // Which starts are reached, the zone, its start and k, how far s is into it.
    add_registers(max_mip_level + level + level + 1);
    compare(into.bits() / 2, max_mip_level);
    memory(1 << level, k.word, Memory::Kind::clocked);
    add_registers(max_mip_level + 1 + into.bits() + 2 * k.word);
    shape_.sums += into.bits();
    multiply(
        into.bits(), true, signed_bits(k), true,
        {.low = unread_bits(into.fraction + k.fraction(), format(F::lod_frac)), .clocks = t.zone_product});
    round(format(F::lod_frac));
    add_registers(level + 1, 3 + t.zone_product);
    const int fraction = std::max(4, word(F::lod_frac));
    add_registers(word(F::lod_frac) + level + 2 + fraction);
    shape_.sums += level + 2 + fraction;
  }

  void lod_gradient() {
    const LodTiming& t = timing_.lod;
    const Format& g = format(F::plane_g_grad);
    const Format& h = format(F::plane_h_grad);
    const Format& uv = format(F::span_uv);
    const Format& slope = format(F::lod_slope);
    const Format& m = c_.pixel_reciprocal.output;
    const int numerator_at = t.gradient_product + 1;
    const int recip_at = 1 + timing_.pixel_unit;
    const int factors_at = std::max(numerator_at, recip_at);
    const Grid numerator = as_signed(grid_of(g)) - signed_grid(uv) * signed_grid(h);
    ring_line(m.word + bits_of(pixel_operand(c_).bits()), factors_at - recip_at);
    for (int i = 0; i < 4; ++i) {
      multiply(signed_bits(uv), true, signed_bits(h), true, {.clocks = t.gradient_product});
      ring_line(g.word, t.gradient_product);
      shape_.sums += numerator.bits();
      add_registers(numerator.bits());
      ring_line(numerator.bits(), factors_at - numerator_at);
      times_reciprocal(numerator.bits(), true, numerator.fraction, 1, 0, t.slope_product, slope, i == 0);
      add_registers(slope.word);
      shape_.sums += slope.word;
    }
    // rho and its logarithm, of which lambda reads some places behind the point.
    const int zeros = bits_of(slope.word);
    const int log = std::min(slope.word, std::max(4, format(F::lod_lambda).fraction() + 2));
    add_registers(3 * slope.word);
    shape_.sums += 3 * slope.word;
    shape_.selects += 3 * slope.word;
    const int normalise = c_.rtl.normalise_clocks;
    if (normalise > 1) add_registers(slope.word + zeros);
    if (normalise > 2) add_registers(log + 7 + zeros);
    add_registers(log + zeros);
    shape_.sums += slope.word;
    shape_.selects += double(zeros) * slope.word;
    add_registers(zeros + 4 + log);
    shape_.sums += zeros + 4 + log;
  }

  // ---------------------------------------------------------------- texture

  int levels() const { return mixes_ ? 2 : 1; }

  void texture() {
    const TextureTiming& t = timing_.texture;
    const int frac = word(F::texture_frac);
    const int share = mixes_ ? word(F::lod_frac) : 0;
    const int shades = 4 * word(shade_factor(c_));
    const int rest = texture_rest();
    add_registers(t.address);
    for (int i = 0; i < levels(); ++i) addresses(i == 0);
    if (mixes_) add_registers(1, t.address);
    // What waits for the texels: how they are weighed, and what else the fragment brings.
    const int asked = 2 + levels() * (2 + 2 * frac) + (mixes_ ? 1 : 0);
    const int ports = 4 * levels();
    skid(asked + levels() * (2 * texel_index_bits + 2 * texel_address_bits));
    add_registers(ports);
    shape_.selects += 4 * ports + double(ports) * texel_index_bits;
    fifo(asked);
    skid(asked);
    // Where levels are mixed, registers stand behind all of it, which Yosys takes into the memory, all of h
    // with it.
    const int waits = shades + 25 + share;
    if (mixes_) {
      fifo(waits + rest + word(F::span_h) - (late_ ? h_of_depth() : h_of_fog()), Memory::Kind::clocked);
    } else {
      fifo(waits + rest);
    }
    for (int i = 0; i < ports; ++i) skid(32);
    for (int i = 0; i < levels(); ++i) words(i == 0);
    const int filter_at = 3;
    const int filtered = 2 * (3 + t.filter_product);
    const int shade_clocks = 1 + t.shade_product + 1;
    add_registers(frac, filter_at);
    for (int i = 0; i < levels(); ++i) filter();
    if (mixes_) {
      add_registers(3 * frac + share + shades + rest, filter_at);
      add_registers(filter_at);
      ring_line(2 * frac, filtered / 2);
      ring_line(share, filtered);
      add_registers(share);
      const Format& mix = format(F::texture_mix);
      const Format& alpha = format(F::texture_alpha);
      for (int i = 0; i < 3; ++i)
        blend(grid_of(mix), grid_of(mix), format(F::lod_frac), mix, t.level_product);
      blend(grid_of(alpha), grid_of(alpha), format(F::lod_frac), alpha, t.level_product);
      shift_stage(t.levels, 1 + shades + rest, 3 * mix.word + alpha.word);
      add_registers(1, shade_clocks);
      ring_line(rest, shade_clocks - 3);
      add_registers(shades);
    } else {
      add_registers(filter_at + filtered);
      ring_line(frac, filter_at + filtered / 2);
      ring_line(shades, filter_at + filtered + 1);
      ring_line(rest, t.color - 3);
      add_registers(1, t.color - filter_at);
    }
    colours(shade_clocks);
    ring_line(rest, 3);
    alpha_test();
    skid(color_ + alpha_ + 1 + rest);
  }

  // rtl/texture_address.sv. Two of them share what does not depend on the level.
  void addresses(bool first) {
    const Format& uv = format(F::span_uv);
    const Format& e = format(F::texture_frac);
    const bool has_levels = timing_.has_lod;
    const int whole = uv.word - uv.fraction();
    const int grid = std::max(1, uv.fraction()) + (has_levels ? max_mip_level : 0);
    const int low = whole + grid - unread_bits(grid, e);  // E takes no more places behind the point
    const int index = texel_index_bits;
    const int pitch = bits_of(index);
    const int frac = e.word;
    const int row = index + (has_levels ? 1 : 0);
    if (has_levels) {
      add_registers(2 * pitch + 2 * (2 + 2 * low + 2 * index) + (first ? 2 * 4 : 0));
      shape_.selects += 2 * (4.0 * low + 4.0 * index) + pitch;
      shape_.sums += pitch + row;
      add_registers(row);
    }
    if (first) add_registers(4 + 2 * 5);
    // Along u and v: u - 1/2; the indices before they are wrapped; wrapped.
    add_registers(2 * (low + 1 + index));
    add_registers(2 * (2 * index + 5 + index + frac));
    add_registers(2 * (2 * index));
    add_registers(2 * (frac + 1), 4);
    shape_.sums += 2 * (index + 2 * std::max(index + 1, whole));
    shape_.selects += 2 * (2 * 2 * index + frac);
    if (e.rounding != Rounding::trn) shape_.sums += 2 * frac;
    // Rows by the pitch, plus the base.
    add_registers(pitch, 3);
    add_registers(pitch - 2);
    ring_line(texel_address_bits, timing_.texture.address - 1);
    add_registers(2 * (row + 3));
    add_registers(2 * std::min(texel_address_bits, row + 3 + 12));
    add_registers(2 * texel_address_bits);
    shape_.selects += 2 * (2.0 * row + 2.0 * (row + 3));
    shape_.sums += 2 * texel_address_bits;
    add_registers(2 * index, 3);
  }

  // rtl/texture_words.sv.
  void words(bool first) {
    add_registers(128 + 2 + (first ? 25 : 0));
    shape_.selects += 2 * 128 + 3 * 32;
    add_registers(5 * (24 + alpha_) + 4 + 2);
    shape_.sums += 5 * (8 + alpha_);
    compare(24, 4);
    add_registers(4 * (24 + alpha_) + 1);
    shape_.selects += 4 * (24 + alpha_);
  }

  // rtl/texture_filter.sv of three colours and alpha: Ex and Ey are in a register each.
  void filter() {
    const int clocks = timing_.texture.filter_product;
    const Format& frac = format(F::texture_frac);
    const Format& mix = format(F::texture_mix);
    const Format& alpha = format(F::texture_alpha);
    constexpr Grid code{8, 0, false};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 2; ++k) blend(code, code, frac, mix, clocks);
      blend(grid_of(mix), grid_of(mix), frac, mix, clocks);
    }
    for (int k = 0; k < 3; ++k) blend(grid_of(alpha), grid_of(alpha), frac, alpha, clocks);
    add_registers(2 * frac.word);
  }

  // Times the shades.
  void colours(int clocks) {
    const Format& shade = format(shade_factor(c_));
    add_registers(clocks);
    const auto product = [&](const Format& of, const Format& to) {
      add_registers(of.word);
      multiply(signed_bits(of), true, signed_bits(shade), true,
               {.low = unread_bits(of.fraction() + shade.fraction(), to),
                .clocks = timing_.texture.shade_product});
      round(to);
      add_registers(to.word);
    };
    for (int i = 0; i < 3; ++i) product(format(F::texture_mix), format(F::texture_color));
    product(format(F::texture_alpha), format(F::texture_alpha));
  }

  void alpha_test() {
    const Format& alpha = format(F::texture_alpha);
    const int wide = std::max(alpha.word, alpha.fraction() + 1) + 1;
    add_registers(9 + 8 + 3 + 3 + 18 + 2 * wide);
    shape_.sums += 4 * wide;
    shape_.selects += 2 * 8;
  }

  // ---------------------------------------------------------------- fog

  void fog() {
    const FogTiming& t = timing_.fog;
    const int coordinate = pixel_index_bits(c_);
    const int index = c_.fog_index_bits();
    const int radius = 2 * coordinate + 1;
    const int zones = c_.fog_zone_bits;
    const int factor = word(F::fog_factor);
    const Format& color = format(F::fog_color);
    const int square_clocks = bits_of(coordinate - 1);
    const int zone_at = 2 + square_clocks + 1 + zones;
    const int entry_at = t.clocks - 4 - t.blend_product;
    add_registers(c_.fog_depth_bits);
    shape_.selects += 2 * c_.fog_depth_bits;
    ring_line(c_.fog_depth_bits, zone_at - 1);
    for (int axis = 0; axis < 2; ++axis) {
      add_registers(2 * coordinate + 1);
      shape_.sums += 2 * coordinate;
      square(coordinate);
    }
    // r^2, and the zone by a tree of thresholds, one level per clock.
    add_registers(radius, zones);
    shape_.sums += radius;
    for (int s = 0; s < zones; ++s) {
      if (s == 0) {
        add_registers(radius);
      } else {
        memory(1 << s, radius, Memory::Kind::clocked);
      }
      add_registers(s + 1);
      shape_.sums += radius;
    }
    ring_line(index, entry_at - 1 - zone_at);
    memory(1 << index, factor, Memory::Kind::clocked);
    add_registers(factor);
    if (is_linear_in_distance(c_.fog)) {
      const Format& scale = format(F::fog_scale);
      const int recip_at = 1 + timing_.pixel_unit;
      pixel_reciprocal();
      add_registers(scale.word + 1);
      shape_.sums += scale.word + 1;
      ring_line(scale.word + 1, recip_at - 1);
      times_reciprocal(scale.word + 1, true, scale.fraction(), 2, 0, t.scale_product, format(F::fog_factor));
      ring_line(factor, entry_at - (recip_at + t.scale_product + 4));
    } else if (has_vertex_fog(c_.fog)) {
      ring_line(factor, entry_at);
    }
    ring_line(2, entry_at);
    add_registers(factor);
    shape_.selects += 2 * factor;
    ring_line(color_ + 24, entry_at + 1);
    const Format& own = format(F::texture_color);
    for (int i = 0; i < 3; ++i)
      blend({8, 0, false}, grid_of(own), format(F::fog_factor), color, t.blend_product);
    add_registers(factor);
    shift_stage(t.clocks, timing_.slot_bits + coordinates_ + alpha_, 3 * color.word);
  }

  // rtl/square.sv.
  void square(int width) {
    const int levels = bits_of(width - 1);
    for (int level = 1; level <= levels; ++level) {
      const int rows = 1 << level;
      for (int k = 0; k * rows < width; ++k) {
        const int left = width - k * rows;
        const int sum = left < rows + 1 ? 2 * left : left + rows + 1;
        const bool adds = k * rows + rows / 2 < width;
        add_registers(sum);
        if (adds) shape_.sums += sum - rows;
      }
    }
  }

  // ---------------------------------------------------------------- merge

  void merge() {
    const MergeTiming& t = timing_.merge;
    const Format& own = format(F::fog_color);
    const Format& color = format(F::merge_color);
    const bool equation = has_blend_equation(c_.rtl.blend);
    const int slot = timing_.slot_bits;
    const int needs = equation ? 2 : 1;
    const int carried = coordinates_ + 2 + slot;
    const int stored = (equation ? 4 : 3) * color.word;
    scoreboard(3 * own.word + alpha_ + needs + 1 + slot, 1);
    skid(coordinates_);
    fifo(coordinates_ + 3 * own.word + alpha_ + 3 + slot);
    skid(stored);
    add_registers(3 * own.word + alpha_ + stored);
    shape_.selects += equation ? stored : alpha_;
    if (equation) {
      state(2);
      state(60);
      add_registers(1 + carried + 60);
      shift_stage(t.any_blend, carried + 1, 32);
      equations();
    } else {
      state(1);
      add_registers(1 + t.product + 3);
      const Grid from{color.integer - (color.is_signed ? 1 : 0), color.fraction(), false};
      for (int i = 0; i < 3; ++i) blend(from, grid_of(own), format(F::texture_alpha), color, t.product);
      add_registers(alpha_);
      add_registers(carried, 1 + t.product + 3);
      skid(carried + 3 * color.word);
    }
  }

  // rtl/blend_unit.sv: what channels have in common is in one register.
  void equations() {
    const int clocks = timing_.merge.any_product;
    const Format& own = format(F::fog_color);
    const Format& alpha = format(F::texture_alpha);
    const int grid = std::max(0, alpha.fraction());
    const int wide = alpha.word + grid - alpha.fraction() + 1;
    const int fraction = std::max(grid, 8);
    const int factor = wide + fraction - grid + 2;
    add_registers(wide + 2 * 11 + 5);
    add_registers(3 + 3 + 5 + 5, clocks + 1);
    add_registers(5);
    for (int i = 0; i < 4; ++i) {
      const bool is_alpha = i == 3;
      const int src_fraction = is_alpha ? 0 : std::max(0, own.fraction());
      const int src = is_alpha ? wide - grid + 9 : own.word + src_fraction - own.fraction() + 1;
      const int dst = 9;
      const int sum = std::max(src + factor, dst + factor + src_fraction) + 1;
      const int unread = unread_bits(src_fraction + fraction, format(F::merge_color));
      add_registers(src + 8 + 8 + 8);
      add_registers(2 * factor + src + 8);
      shape_.sums += src + 6 * factor;
      shape_.selects += 2 * 8 * factor;
      multiply(src, true, factor, true, {.clocks = clocks});
      multiply(dst, true, factor, true, {.clocks = clocks});
      add_registers(src + 8 + (is_alpha ? 8 : 0), clocks);
      add_registers(sum - unread + 8 + 8 + 8);
      shape_.sums += 3 * sum;
      shape_.selects += 4 * sum + 8 * 8;
      round(format(F::merge_color));
    }
  }

  PixelTiming timing_;
  bool late_;
  bool has_lut_memory_;
  int coordinates_;  // x and y
  int shades_;       // u, v and the shades
  int color_;        // three of texture.color
  int alpha_;
  bool has_line_;  // depth takes a line of its own for h
  int tag_;        // the slot of the draw state, that h, and the factor of the fog at a vertex
  bool mixes_;     // two levels of a texture
};

}  // namespace

AreaShape pixel_shape(const Config& config, AreaTarget target) {
  if (!has_pixel_rtl(config)) throw InputError(config.name + ": its pixel stages are not in RTL");
  return PixelCounter(config, target).count();
}

}  // namespace bitspan
