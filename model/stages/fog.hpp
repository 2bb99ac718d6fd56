// SPDX-License-Identifier: Apache-2.0
// fog: the share of the fragment's own colour, linear (F3), from a table (F1, F2) or by the vertices (F4),
// and the mix with the fog's colour. docs/numeric-spec.md, "fog".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/integers.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/channel.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/distance.hpp"
#include "model/stages/span.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

// What fog computes by, known from the configuration alone.
struct FogFormats {
  bool fits_int64 = false;  // the mix with the fog's colour fits int64
  int scale_fraction = 0;
  Register color_in, factor, color;
  ReciprocalFormats reciprocal;  // R_pixel
  bool operator==(const FogFormats&) const = default;
};
constexpr FogFormats fog_formats(const Config& config) {
  FogFormats f;
  f.scale_fraction = config.format(FormatId::fog_scale).fraction();
  f.color_in = make_register(config, FormatId::texture_color);
  f.factor = make_register(config, FormatId::fog_factor);
  f.color = make_register(config, FormatId::fog_color);
  f.reciprocal = reciprocal_formats(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  const Grid code = integer_grid(8);
  const Grid color = signed_grid(config.format(FormatId::texture_color)) - code;
  const Grid share = signed_grid(config.format(FormatId::fog_factor));
  f.fits_int64 = fits_int64(color * share + code * share);
  return f;
}

struct FogStage : FogFormats {
  FogMode mode = FogMode::none;  // none also where the scene has no fog
  std::array<std::uint8_t, 3> fog_color{};
  ScreenZones zones;
  int index_bits = 6;           // fog.depth_bits
  std::int64_t last_step = 63;  // of depth, or of a distance
  int step_shift = 10;          // bits of h below a step; negative where a step is finer than h
  InverseDepth q;
  ReciprocalUnit reciprocal;        // R_pixel
  Exact scale;                      // fog_scale
  Register s, d;                    // formats of the distances
  int range = 0;                    // mode distance: the table reaches to 2^range
  std::vector<std::int64_t> table;  // raw, fog.factor; modes table, distance, log
};
// Octaves below 2^E that the table of mode log has entries for, as a power of two.
inline constexpr int log_octave_bits = 4;
// Throws InputError where a table is wanted and the scene's fog distance or focal length is not positive.
template <class Watch = NoObserve>
FogStage prepare_fog(const Config& config, const Constants& constants, const Scene& scene, Watch watch = {});

// The factor of a fragment, with how it was found; distance: read in modes distance and log. channels: of
// the fragment, read in mode vertex.
struct FogFactor {
  std::int64_t index = -1;  // of a table
  std::int64_t recip_m = 0, recip_e = 0;
  std::int64_t factor = 0;
};
template <class Watch = NoObserve>
FogFactor fog_factor(const FogStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
                     Watch watch = {}, const FragmentChannels* channels = nullptr);

// A fragment that the texture stage let live; distance and channels as above.
template <class Watch = NoObserve>
void fog(const FogStage& stage, const FragmentRecord& fragment, const DistanceRecord& distance,
         const TextureRecord& texture, FogRecord& out, Watch watch = {},
         const FragmentChannels* channels = nullptr);

// Q[r](exp(-s / distance)), correctly rounded: the factor at a vertex where the stream gives none.
template <class Watch = NoObserve>
std::int64_t fog_at(double s, double distance, const Register& r, Watch watch = {});

// The step of depth of h (raw, span.h): its top bits.
std::int64_t fog_step(const FogStage& stage, std::int64_t h);

// Entry of mode table for a step of depth and a zone: Q[fog.factor](exp(-D/DT)), correctly rounded.
template <class Watch = NoObserve>
std::int64_t fog_entry(const Config& config, const Constants& constants, const Scene& scene, int hi, int zone,
                       Watch watch = {});

}  // namespace bitspan::model
