// SPDX-License-Identifier: Apache-2.0
#include "model/paths.hpp"

#include <algorithm>
#include <array>

#include "config/exact.hpp"
#include "config/modes.hpp"
#include "config/shipped_configs.hpp"
#include "model/simd/engine_vector.hpp"
#include "model/simd/shade.hpp"
#include "model/simd/shipped.hpp"
#include "model/simd/spans.hpp"
#include "model/simd/targets.hpp"
#include "model/stages/depth.hpp"
#include "model/stages/edge_walk.hpp"
#include "model/stages/lod.hpp"
#include "model/stages/setup.hpp"
#include "model/stages/span.hpp"
#include "model/stages/span_setup.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan::model {

std::string_view to_string(ModelForm form) {
  switch (form) {
    case ModelForm::automatic:
      return "auto";
    case ModelForm::scalar:
      return "scalar";
    case ModelForm::vector:
      return "vector";
    case ModelForm::specialised:
      return "specialised";
  }
  return "";
}

std::string_view to_string(VectorTarget target) {
  switch (target) {
    case VectorTarget::best:
      return "best";
    case VectorTarget::avx512:
      return "avx512";
    case VectorTarget::avx2:
      return "avx2";
    case VectorTarget::baseline:
      return "baseline";
  }
  return "";
}

namespace {

// The value of that name, one of `legal`, each of which to_string names.
template <class T, std::size_t n>
T named(const std::string& flag, const std::string& name, const std::array<T, n>& legal) {
  const auto* const at = std::ranges::find_if(legal, [&](T value) { return to_string(value) == name; });
  if (at != legal.end()) return *at;
  std::string names;
  for (const T value : legal) names += (names.empty() ? "" : ", ") + std::string(to_string(value));
  throw InputError(flag + ": '" + name + "' is unknown; legal: " + names);
}

}  // namespace

ModelOptions model_options(const EngineOptions& options) {
  ModelOptions out;
  if (!options.form.empty()) {
    out.form =
        named("--form", options.form,
              std::array{ModelForm::automatic, ModelForm::scalar, ModelForm::vector, ModelForm::specialised});
  }
  if (!options.target.empty()) {
    out.target = named(
        "--target", options.target,
        std::array{VectorTarget::best, VectorTarget::avx512, VectorTarget::avx2, VectorTarget::baseline});
    if (!supported(out.target)) {
      throw InputError("--target " + options.target +
                       ": this processor has no such instructions; best takes " +
                       std::string(to_string(best_target())));
    }
  }
  out.threads = options.threads;
  out.winners = options.winners;
  return out;
}

VectorTarget best_target() {
  return supported(VectorTarget::avx512) ? VectorTarget::avx512
         : supported(VectorTarget::avx2) ? VectorTarget::avx2
                                         : VectorTarget::baseline;
}

ModelForm chosen_form(const Config& config, ModelForm asked) {
  const bool is_shipped = shipped_index(config).any();
  if (asked == ModelForm::specialised && !is_shipped) {
    throw InputError(
        "the specialised form is compiled for the formats of the shipped configurations, and these are none "
        "of "
        "them");
  }
  if (asked != ModelForm::automatic) return asked;
  return vector_refusal(config) != nullptr ? ModelForm::scalar
         : is_shipped                      ? ModelForm::specialised
                                           : ModelForm::vector;
}

namespace {

constexpr const char* scalar = "scalar";
constexpr const char* lanes32 = "32-bit lanes";
constexpr const char* lanes64 = "64-bit lanes";
constexpr const char* lanes128 = "128-bit lanes";
constexpr const char* lanes_mixed = "64-bit lanes, 128-bit where values are large";

// A scene's B, the only part of a scene that decides: any raw value of setup.b above 0.
Constants constants_with(std::int64_t b) {
  Constants constants;
  constants.record.b = b;
  return constants;
}

// The first half is done in lanes altogether or not at all (triangles_in_lanes).
std::string triangle_path(const Config& config, int bits) {
  const Constants constants = constants_with(make_register(config, FormatId::setup_b).max);
  if (!prepare_setup(config, constants).fits_lanes ||
      !prepare_edge_walk(config, constants, picture_size_limit, picture_size_limit).fits_lanes ||
      !prepare_span_setup(config, constants).fits_lanes) {
    return scalar;
  }
  return bits <= term_bits + 1 ? lanes64 : lanes_mixed;
}

// The larger B is, the smaller is the range of the reciprocal's exponents.
std::string span_path(const Config& config) {
  const auto narrow = [&](std::int64_t b) { return prepare_span(config, constants_with(b)).fits_int64; };
  if (narrow(1)) return lanes64;
  // Other perspectives do not look at the values.
  std::string wide = has_pixel_reciprocal(config.perspective) ? lanes_mixed : lanes128;
  const Register b = make_register(config, FormatId::setup_b);
  for (int bits = 1; bits < 63 && std::int64_t{1} << bits <= b.max; ++bits) {
    if (narrow(std::int64_t{1} << bits)) {
      const std::string bound = "B < 2^" + std::to_string(bits - b.fraction);
      return wide + (has_pixel_reciprocal(config.perspective) ? " and " : " where ") + bound;
    }
  }
  return wide;
}

std::string path_of(const Config& config, std::string_view stage, int bits) {
  if (vector_refusal(config) != nullptr) return scalar;
  const bool rows_of_depth = has_plane_rows(config.perspective);
  const bool shading = stage == "texture" || stage == "fog" || stage == "merge";
  if (shading) {
    const ShadeLanes held_in = lanes_for_shading(config, config.fog);
    // Blocks of 32 bits are for configurations whose fragments fit them all the way.
    const bool blocks32 = held_in == ShadeLanes::int32 && branch_free_shade(shade_formats(config)) &&
                          spans_fit_int32(span_formats(config));
    return blocks32 ? lanes32 : held_in != ShadeLanes::scalar ? lanes64 : scalar;
  }
  if (rows_of_depth || stage == "setup.gradient" || stage == "distance" || stage == "light") return scalar;
  if (stage == "lod") return fits_lanes(prepare_lod(config, constants_with(1))) ? lanes_mixed : scalar;
  if (stage == "span") return span_path(config);
  if (stage == "depth") return prepare_depth(config, constants_with(1)).fits_int64 ? lanes64 : lanes128;
  return triangle_path(config, bits);
}

}  // namespace

std::vector<StagePath> model_paths(const Config& config) {
  std::vector<StagePath> paths;
  for (const ExactIntermediate& x : exact_intermediates(config)) {
    if (x.stage == "constants" || x.stage.starts_with("reciprocal."))
      continue;  // once per scene; part of others
    auto path = std::ranges::find(paths, x.stage, &StagePath::stage);
    if (path == paths.end()) {
      paths.push_back({x.stage, "", x.expression, x.bits});
    } else if (x.bits > path->bits) {
      path->bits = x.bits;
      path->widest = x.expression;
    }
  }
  for (StagePath& path : paths) path.path = path_of(config, path.stage, path.bits);
  return paths;
}

}  // namespace bitspan::model
