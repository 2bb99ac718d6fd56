// SPDX-License-Identifier: Apache-2.0
#include "model/stages/depth.hpp"

#include "config/modes.hpp"
#include "model/numeric/integers.hpp"
#include "model/stages/depth-inl.hpp"

namespace bitspan::model {

int log2_of_dz(const DepthFormats& f, const GradientRecord& gradient) {
  const auto size = [](std::int64_t raw) { return raw < 0 ? -int128{raw} : int128{raw}; };
  const int128 d = size(gradient.h_x) + size(gradient.h_y);
  if (d == 0) return 0;
  return std::clamp(bit_length(static_cast<uint128>(d - 1)) - f.gradient_fraction, 0, largest_dz);
}

DepthStage prepare_depth(const Config& config, const Constants& constants) {
  DepthStage s;
  s.formats = depth_formats(config);
  s.func = config.depth_func;
  s.clear = s.formats.nearer_is_larger ? 0 : s.formats.zmax;  // the farthest
  if (has_dz(s.formats.code)) s.clear = packed_depth({s.formats.zmax, 0}, s.formats.z.word);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.scene = {make_inverse_depth(config, constants).b, s.reciprocal.table().data(), constants.record.c1,
             constants.record.c0};
  switch (config.depth_code) {
    case DepthCode::inverse:
    case DepthCode::opengl:
    case DepthCode::float_dz: {
      const Grid difference =
          signed_grid(config.format(FormatId::span_h)) - signed_grid(config.depth_format());
      s.fits_int64 = fits_int64(aligned(difference, 1));
      break;
    }
    case DepthCode::linear:
      break;
    case DepthCode::w_float: {
      s.scene.b <<= s.formats.q_fraction - s.formats.b_fraction;
      const int128 largest = (int128{s.formats.zmax} << s.formats.q_fraction) + s.scene.b;
      s.scene.w_top = bit_length(static_cast<uint128>(largest - 1));
      // 2^p (L + 2 - q 2^(L+1-K)) = zmax in the last octave, rounded up to the grid.
      constexpr int last = (1 << w_float_exponent_bits) - 1;
      const int top = s.scene.w_top - 1;
      const int128 code = (int128{1} << top) + (int128{1} << (top - s.formats.mantissa_bits));
      s.scene.w_far = std::max<int128>((code + (1 << last) - 1) >> last, 1);
      // The code's octave and 2 take as many places above the point as z.
      const Grid q =
          signed_grid(config.format(FormatId::span_h)) + signed_grid(config.format(FormatId::setup_b));
      s.fits_int64 =
          fits_int64(Grid{s.scene.w_top + w_float_exponent_bits + 1, 0, true}) && fits_int64(aligned(q, 0));
      break;
    }
  }
  return s;
}

template <class Watch>
bool depth(const DepthStage& stage, const FragmentRecord& fragment, const GradientRecord* gradient,
           std::int64_t stored, DepthRecord& out, Watch watch) {
  const DepthFormats& f = stage.formats;
  const auto point = stage.fits_int64
                         ? HWY_NAMESPACE::depth_point<std::int64_t>(f, stage.scene, fragment.h, watch)
                         : HWY_NAMESPACE::depth_point<int128>(f, stage.scene, fragment.h, watch);
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  out.recip_m = point.recip_m;
  out.recip_e = point.recip_e;
  out.z = stage.bias == 0 ? point.z : std::clamp<std::int64_t>(point.z + stage.bias, 0, f.zmax);
  if (has_dz(f.code)) out.z = packed_depth({out.z, log2_of_dz(f, *gradient)}, f.z.word);
  out.stored = stored;
  const bool pass = HWY_NAMESPACE::depth_word_passes(f, stage.func, out.z, stored);
  out.pass = pass ? 1 : 0;
  return pass;
}

template bool depth(const DepthStage&, const FragmentRecord&, const GradientRecord*, std::int64_t,
                    DepthRecord&, NoObserve);
template bool depth(const DepthStage&, const FragmentRecord&, const GradientRecord*, std::int64_t,
                    DepthRecord&, Observe);

}  // namespace bitspan::model
