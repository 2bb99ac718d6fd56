// SPDX-License-Identifier: Apache-2.0
// Measures how far an engine's records are from the unquantised truth (docs/numeric-spec.md, "ideal"), stage
// by stage.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/engine.hpp"
#include "golden/ideal.hpp"
#include "golden/mip_chain.hpp"
#include "report/truth.hpp"

namespace bitspan {

struct ErrorStat {
  // The error's magnitude is counted in eight bins per octave, from 2^-80 to 2^48. The first bin takes
  // smaller errors too, and the last one takes larger ones.
  static constexpr int bins_per_octave_log2 = 3;
  static constexpr int lowest_octave = -80;
  static constexpr std::size_t bin_count = std::size_t{128} << bins_per_octave_log2;

  std::uint64_t count = 0;
  double sum = 0;        // sum of engine - ideal
  double magnitude = 0;  // sum of its magnitude
  double squares = 0;    // sum of its square
  double power = 0;      // sum of the ideal values' squares
  double max = 0;        // largest magnitude
  std::vector<std::uint64_t> bins = std::vector<std::uint64_t>(bin_count);
  void add(double measured, double ideal);
  void add(const ErrorStat& other);
  double mean() const { return count == 0 ? 0 : sum / static_cast<double>(count); }
  double mean_magnitude() const { return count == 0 ? 0 : magnitude / static_cast<double>(count); }
  double rms() const { return count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count)); }
  // Returns a magnitude that at least `share` of the errors do not exceed. It is the upper edge of a bin, and
  // at most max. It is 0 where that bin is the first.
  double quantile(double share) const;
  // Returns the signal to quantisation noise ratio, infinite without error.
  double sqnr_db() const;
};

struct ErrorRow {
  std::string stage, quantity, unit;
  double ulp = 0;  // of the format that holds the quantity, in the unit
  ErrorStat stat;
};

// What a metric of the picture counted (`counted`), among how many (`base`).
struct PictureTally {
  double counted = 0, base = 0;
};

struct ErrorReport {
  std::vector<ErrorRow> rows;
  // Counts pixels of all triangles. The exact test of the pixel centre covers the missed ones, and the engine
  // does not. The surplus ones are covered by the engine alone. The engine covers the doubled ones twice.
  std::uint64_t covered = 0;  // by the exact test
  std::uint64_t missed = 0, surplus = 0, doubled = 0;
  std::uint64_t coverage_differences() const { return missed + surplus + doubled; }
  // Has one tally per row of picture_metrics() (report/metrics.hpp). It is empty without pictures.
  std::vector<PictureTally> picture;
  bool has_picture() const { return !picture.empty(); }
  // Adds the errors of another scene, drawn under the same configuration.
  void add(const ErrorReport& other);
};

// The quantities whose errors are measured, in the order of ErrorReport::rows.
struct FieldQuantity {
  std::string_view stage, quantity, unit;  // "span", "u", "texel"
};
std::span<const FieldQuantity> field_quantities();

class ErrorMeter {
 public:
  // The scene must outlive the meter.
  ErrorMeter(const Config& config, const Scene& scene);
  // Adds the records of triangles[0..] as an engine delivered them. `first_index` is that of Engine::draw.
  void add(std::span<const Triangle> triangles, std::int64_t first_index, const Trace& trace);
  // Does the same against a truth that is known already, of these triangles and of a configuration with an
  // equal truth_config.
  void add(const Truth& truth, std::int64_t first_index, const Trace& trace);
  // Adds the finished pictures of the engine and of `ideal`.
  void add_pictures(const Frame& engine, const Frame& ideal);
  const ErrorReport& report() const { return report_; }

 private:
  void coverage(const Truth& truth, std::size_t triangle, std::span<const FragmentRecord> fragments);
  ErrorStat& stat(int row) { return report_.rows[static_cast<std::size_t>(row)].stat; }

  Config config_;
  const Scene* scene_;
  std::shared_ptr<const golden::SceneLevels> levels_;  // of the truths that it makes itself
  std::int64_t depth_bias_ = 0;                        // of the draw state in force
  bool combines_ = false;                              // the same: it has a second texture unit
  bool looks_up_otherwise_ = false;  // the same: its filter or wrap mode is not the configuration's
  ErrorReport report_;
  std::vector<std::uint8_t> hits_;  // per pixel of one triangle's box
};

// The size of the error of each pixel on which the same triangle won. It is NaN elsewhere.
struct PictureErrors {
  std::vector<double> depth;    // codes
  std::vector<double> texture;  // of u and v together, texels
};
PictureErrors picture_errors(const Frame& engine, const Frame& ideal);

// Returns what a field of a record of `triangle` would hold without any quantisation. There is none for
// fields that the truth has no value for: slopes, reciprocals, accumulators, indices.
std::optional<double> ideal_value(RecordType type, std::string_view field,
                                  std::span<const std::int64_t> record, const Config& config,
                                  const Scene& scene, const Triangle& triangle);

// Returns "41.20 dB", or that the pictures are equal.
std::string psnr_text(double psnr_db);

}  // namespace bitspan
