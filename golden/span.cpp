// SPDX-License-Identifier: Apache-2.0
#include "golden/span.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "golden/lanes.hpp"
#include "golden/line_walk.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// A register that is stepped, with a step for either move of the digital line.
template <class Real>
struct Walked {
  const Quantizer<Real>* q = nullptr;
  Real value = 0;
  std::array<Real, 2> step{};

  void advance(std::size_t move) { value = q->sum(value, step[move]); }
};

template <class Real>
class SpanWalker {
 public:
  SpanWalker(const Config& config, const Constants& constants)
      : perspective_(config.perspective),
        q_h_(config.format(FormatId::span_h)),
        q_acc_(config.format(line_of(LineId::fu, perspective_).row.acc)),
        q_edge_uv_(config.format(FormatId::edge_uv)),
        q_uv_(config.format(FormatId::span_uv)),
        q_shade_acc_(config.format(FormatId::span_shade_acc)),
        q_shade_(config.format(FormatId::span_shade)),
        q_k_(config.format(FormatId::plane_k)),
        phase_ulp_(pow2<Real>(-config.format(FormatId::plane_k).fraction())),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        least_(pow2<Real>(-depth_sum_fraction(config, FormatId::span_h))),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)),
        subspan_bits_(has_subspans(config) ? config.subspan_bits : 0),
        wide_uv_(config.format(FormatId::span_uv)),
        quick_uv_(config.format(FormatId::span_uv)),
        quick_shade_(config.format(FormatId::span_shade)) {
    for (const Line& line : lines_of(config, constants.channels)) {
      walked_.push_back({line.id, Quantizer<Real>(config.format(line.row.acc)),
                         Quantizer<Real>(config.format(line.row.step)),
                         Quantizer<Real>(config.format(line.row.kept)), line.span_divides});
    }
  }

  void operator()(std::span<const SpanRecord> spans, std::span<const SpanChannelRecord> channels,
                  SpanPath path, std::vector<FragmentRecord>& out,
                  std::vector<FragmentChannelRecord>& out_channels) const {
    const std::size_t first = out.size();
    std::size_t count = 0;
    for (const SpanRecord& span : spans) count += static_cast<std::size_t>(span.count);
    out.resize(first + count);
    const std::span<FragmentRecord> fragments = std::span(out).subspan(first);
    std::span<FragmentRecord> rest = fragments;
    for (const SpanRecord& span : spans) {
      const auto n = static_cast<std::size_t>(span.count);
      walk(span, path, rest.first(n));
      const std::size_t of_span = walked_.size() - fixed_lines;
      walk_channels(span, channels.first(of_span), path, rest.first(n), out_channels);
      channels = channels.subspan(of_span);
      rest = rest.subspan(n);
      if (path.plane != nullptr) path.covered = path.covered.subspan(n);
    }
    for (std::size_t at = 0; at < count; at += lanes) {
      finish(fragments.subspan(at, std::min(lanes, count - at)));
    }
    if (subspan_bits_ == 0) return;
    rest = fragments;
    for (const SpanRecord& span : spans) {
      const auto n = static_cast<std::size_t>(span.count);
      interpolate(rest.first(n));
      rest = rest.subspan(n);
    }
  }

 private:
  struct WalkedLine {
    LineId id{};
    Quantizer<Real> q, q_step, q_kept;
    bool divides = false;  // a channel that is the quotient by h + B
  };

  // The digital line that the pixels follow; horizontal without a plane or a line.
  struct DigitalLine {
    const LineWalkRecord* line;
    bool slanted, major_is_y;
    Real k, phase;
    std::int64_t pixel = 0;  // of a line
    DigitalLine(const SpanPath& path, Real slope, Real start)
        : line(path.line),
          slanted(path.plane != nullptr),
          major_is_y(slanted && path.plane->major == 1),
          k(slope),
          phase(start) {}

    // Moves to the next pixel; 1 where the steps of the other kind are due, which a line has not, else 0.
    std::size_t advance(std::int64_t& x, std::int64_t& y) {
      if (line != nullptr) {
        ++pixel;
        (line->major == 1 ? y : x) = line->major_first + pixel;
        (line->major == 1 ? x : y) = minor_at(*line, pixel);
        return 0;
      }
      if (!slanted) {
        ++x;
        return 0;
      }
      ++(major_is_y ? y : x);
      phase += k;
      std::int64_t& minor = major_is_y ? x : y;
      if (k >= 0 && phase >= 1) {
        phase -= 1;
        ++minor;
        return 1;
      }
      if (k < 0 && phase < 0) {
        phase += 1;
        --minor;
        return 1;
      }
      return 0;
    }
  };

  // Puts linear u and v between the exact ones of a row at each subspan's ends.
  void interpolate(std::span<FragmentRecord> row) const {
    const std::size_t length = std::size_t{1} << subspan_bits_;
    for (std::size_t a = 0; a + length < row.size(); a += length) {
      for (const auto field : {&FragmentRecord::u, &FragmentRecord::v}) {
        const Quad near = wide_uv_.value(row[a].*field);
        const Quad far = wide_uv_.value(row[a + length].*field);
        for (std::size_t j = 1; j < length; ++j) {
          const Quad share = Quad(static_cast<double>(j)) / Quad(static_cast<double>(length));
          row[a + j].*field = wide_uv_.raw(wide_uv_.sum(near, (far - near) * share));
        }
      }
      for (std::size_t j = 1; j < length; ++j) row[a + j].recip_m = row[a + j].recip_e = 0;
    }
  }

  // The registers in front of each pixel. What finish() makes of them stands in their place until then: u1
  // and v1 in u and v, the shades' accumulators in r, g, b and a.
  void walk(const SpanRecord& span, const SpanPath& path, std::span<FragmentRecord> out) const {
    std::array<Walked<Real>, fixed_lines> registers;
    for (std::size_t i = 0; i < fixed_lines; ++i) {
      const WalkedLine& line = walked_[i];
      const SpanFields& field = span_fields[i];
      registers[i] = start_of(line, span.*field.start, span.*field.step0, span.*field.step1);
    }
    // Where every sum is on its register's grid and in its range, Q changes none of them.
    bool exact = true;
    for (const Walked<Real>& r : registers) exact = exact && r.q->holds_walk(r.value, r.step, span.count);

    DigitalLine line = line_along(span, path);
    std::int64_t x = span.x;
    std::int64_t y = span.y;
    for (std::size_t i = 0; i < out.size(); ++i) {
      FragmentRecord& f = out[i];
      f.triangle = span.triangle;
      f.x = x;
      f.y = y;
      f.covered = path.plane != nullptr ? path.covered[i] : 1;
      for (std::size_t k = 0; k < fixed_lines; ++k) {
        f.*fragment_fields[k] = registers[k].q->raw(registers[k].value);
      }
      f.u = span.u1;
      f.v = span.v1;
      const std::size_t move = line.advance(x, y);
      if (exact) {
        for (Walked<Real>& r : registers) r.value += r.step[move];
      } else {
        for (Walked<Real>& r : registers) r.advance(move);
      }
    }
    out.back().last = 1;
  }

  static Walked<Real> start_of(const WalkedLine& line, std::int64_t start, std::int64_t step0,
                               std::int64_t step1) {
    return {&line.q, line.q.value(start), {line.q_step.value(step0), line.q_step.value(step1)}};
  }

  // The channels of the same pixels, whose fragments have been walked.
  void walk_channels(const SpanRecord& span, std::span<const SpanChannelRecord> channels,
                     const SpanPath& path, std::span<const FragmentRecord> fragments,
                     std::vector<FragmentChannelRecord>& out) const {
    if (channels.empty()) return;
    std::array<Walked<Real>, channel_limit> registers;
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const SpanChannelRecord& from = channels[k];
      registers[k] = start_of(walked_[fixed_lines + k], from.w, from.w_step0, from.w_step1);
    }
    DigitalLine line = line_along(span, path);
    std::int64_t x = span.x;
    std::int64_t y = span.y;
    const bool divides = std::ranges::any_of(walked_, &WalkedLine::divides);
    for (const FragmentRecord& fragment : fragments) {
      const Real q = q_h_.value(fragment.h) + b_;
      const Inverse<Real> inverse =
          divides && has_pixel_reciprocal(perspective_) ? unit_(q) : Inverse<Real>{};
      for (std::size_t k = 0; k < channels.size(); ++k) {
        const WalkedLine& of = walked_[fixed_lines + k];
        out.push_back({.triangle = span.triangle,
                       .x = x,
                       .y = y,
                       .channel = channel_of(of.id),
                       .w = of.q_kept.raw(kept(of, registers[k].value, q, inverse))});
      }
      const std::size_t move = line.advance(x, y);
      for (std::size_t k = 0; k < channels.size(); ++k) registers[k].advance(move);
    }
  }
  Real kept(const WalkedLine& line, Real value, Real q, const Inverse<Real>& inverse) const {
    if (!line.divides) return line.q_kept(value);
    if (has_pixel_reciprocal(perspective_)) return line.q_kept.product(inverse.times(value));
    return line.q_kept.quotient(value, q <= 0 ? least_ : q);
  }
  DigitalLine line_along(const SpanRecord& span, const SpanPath& path) const {
    return {path, path.plane != nullptr ? q_k_.value(path.plane->k) : Real(0), Real(span.phase) * phase_ulp_};
  }

  // At most `lanes` fragments.
  void finish(std::span<FragmentRecord> fragments) const {
    if (!quick_coordinates(fragments)) {
      for (FragmentRecord& f : fragments) coordinates(f);
    }
    if (!quick_shades(fragments)) {
      for (FragmentRecord& f : fragments) {
        f.r = q_shade_.raw(q_shade_(q_shade_acc_.value(f.r)));
        f.g = q_shade_.raw(q_shade_(q_shade_acc_.value(f.g)));
        f.b = q_shade_.raw(q_shade_(q_shade_acc_.value(f.b)));
        f.a = q_shade_.raw(q_shade_(q_shade_acc_.value(f.a)));
      }
    }
  }

  void coordinates(FragmentRecord& f) const {
    const Real fu = q_acc_.value(f.fu);
    const Real fv = q_acc_.value(f.fv);
    switch (perspective_) {
      case Perspective::delta_f: {
        const Inverse<Real> inverse = unit_(q_h_.value(f.h) + b_);
        f.recip_m = unit_.raw(inverse.m);
        f.recip_e = inverse.e;
        f.u = q_uv_.raw(q_uv_.sum(inverse.times(fu), q_edge_uv_.value(f.u)));
        f.v = q_uv_.raw(q_uv_.sum(inverse.times(fv), q_edge_uv_.value(f.v)));
        return;
      }
      case Perspective::hyperbolic: {
        Real d = q_h_.value(f.h) + b_;
        if (d <= 0) d = least_;
        f.u = q_uv_.raw(q_uv_.quotient(fu, d));
        f.v = q_uv_.raw(q_uv_.quotient(fv, d));
        return;
      }
      case Perspective::affine:
      case Perspective::const_depth_rows:
        f.u = q_uv_.raw(q_uv_(fu));
        f.v = q_uv_.raw(q_uv_(fv));
        return;
    }
  }

  // The same over columns. False, with the fragments as they were, where that does not hold.
  bool quick_coordinates(std::span<FragmentRecord> fragments) const {
    if constexpr (std::same_as<Real, double>) {
      if (!quick_uv_.usable) return false;
      const std::size_t n = fragments.size();
      Column fu, fv, u, v, m, inverse_power;  // NOLINT(cppcoreguidelines-pro-type-member-init): n are set
      std::array<std::int64_t, lanes> e;      // NOLINT(cppcoreguidelines-pro-type-member-init)
      Column d{};                             // the compiler does not see that a mode that reads it sets it
      load(fragments, &FragmentRecord::fu, fu);
      load(fragments, &FragmentRecord::fv, fv);
      const double acc_ulp = q_acc_.ulp();
      const double uv_scale = 1 / q_uv_.ulp();
      switch (perspective_) {
        case Perspective::affine:
        case Perspective::const_depth_rows:
          if (lanes_narrow(fu, acc_ulp * uv_scale, quick_uv_, n, u) != 0) return false;
          if (lanes_narrow(fv, acc_ulp * uv_scale, quick_uv_, n, v) != 0) return false;
          break;
        case Perspective::hyperbolic:
          load(fragments, &FragmentRecord::h, d);
          lanes_operand(d, q_h_.ulp(), b_, least_, n, d);
          if (lanes_narrow_quotient(fu, d, acc_ulp * uv_scale, quick_uv_, n, u) != 0) return false;
          if (lanes_narrow_quotient(fv, d, acc_ulp * uv_scale, quick_uv_, n, v) != 0) return false;
          break;
        case Perspective::delta_f: {
          load(fragments, &FragmentRecord::h, d);
          lanes_operand(d, q_h_.ulp(), b_, least_, n, d);
          if (!unit_.quick(d, n, m, inverse_power, e.data())) return false;
          const double scale = acc_ulp * unit_.ulp() * uv_scale;
          const double base_scale = q_edge_uv_.ulp() * uv_scale;
          load(fragments, &FragmentRecord::u, u);
          load(fragments, &FragmentRecord::v, v);
          if (lanes_narrow_product(fu, m, inverse_power, scale, u, base_scale, quick_uv_, n, u) != 0) {
            return false;
          }
          if (lanes_narrow_product(fv, m, inverse_power, scale, v, base_scale, quick_uv_, n, v) != 0) {
            return false;
          }
          store(m, fragments, &FragmentRecord::recip_m);
          for (std::size_t i = 0; i < n; ++i) fragments[i].recip_e = e[i];
          break;
        }
      }
      store(u, fragments, &FragmentRecord::u);
      store(v, fragments, &FragmentRecord::v);
      return true;
    }
    return false;
  }

  bool quick_shades(std::span<FragmentRecord> fragments) const {
    if constexpr (std::same_as<Real, double>) {
      if (!quick_shade_.usable) return false;
      constexpr std::array shades{&FragmentRecord::r, &FragmentRecord::g, &FragmentRecord::b,
                                  &FragmentRecord::a};
      std::array<Column, channels> c;  // NOLINT(cppcoreguidelines-pro-type-member-init): n lanes are set
      const double scale = q_shade_acc_.ulp() / q_shade_.ulp();
      for (std::size_t i = 0; i < channels; ++i) {
        load(fragments, shades[i], c[i]);
        if (lanes_narrow(c[i], scale, quick_shade_, fragments.size(), c[i]) != 0) return false;
      }
      for (std::size_t i = 0; i < channels; ++i) store(c[i], fragments, shades[i]);
      return true;
    }
    return false;
  }

  static void load(std::span<const FragmentRecord> from, std::int64_t FragmentRecord::*field, Column& to) {
    for (std::size_t i = 0; i < from.size(); ++i) to.at[i] = static_cast<double>(from[i].*field);
  }
  static void store(const Column& from, std::span<FragmentRecord> to, std::int64_t FragmentRecord::*field) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i].*field = static_cast<std::int64_t>(from.at[i]);
  }

  Perspective perspective_;
  Quantizer<Real> q_h_, q_acc_, q_edge_uv_, q_uv_, q_shade_acc_, q_shade_, q_k_;
  std::vector<WalkedLine> walked_;
  Real phase_ulp_, b_, least_;
  ReciprocalUnit<Real> unit_;
  int subspan_bits_;
  Quantizer<Quad> wide_uv_;
  LaneFormat quick_uv_, quick_shade_;
};

}  // namespace

SpanStage make_span(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> SpanStage { return SpanWalker<Real>(config, constants); });
}

}  // namespace bitspan::golden
