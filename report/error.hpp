// How far an engine's records are from the unquantised truth (docs/numeric-spec.md, "ideal"), stage by stage.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/engine.hpp"
#include "golden/ideal.hpp"
#include "report/compare.hpp"

namespace bitspan {

struct ErrorStat {
  std::uint64_t count = 0;
  double sum = 0;      // of engine - ideal
  double squares = 0;  // of its square
  double max = 0;      // of its magnitude
  void add(double error) {
    ++count;
    sum += error;
    squares += error * error;
    max = std::max(max, std::fabs(error));
  }
  double mean() const { return count == 0 ? 0 : sum / static_cast<double>(count); }
  double rms() const { return count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count)); }
};

struct ErrorRow {
  std::string stage, quantity, unit;
  ErrorStat stat;
};

struct ErrorReport {
  std::vector<ErrorRow> rows;
  // Pixels of all triangles that the exact test of the pixel centre covers and the engine does not, or the
  // other way, or that it covers twice.
  std::uint64_t covered = 0;  // by the exact test
  std::uint64_t missed = 0, surplus = 0, doubled = 0;
  std::uint64_t coverage_differences() const { return missed + surplus + doubled; }
  // Of the finished pictures.
  bool has_picture = false;
  std::uint64_t pixels = 0;
  std::uint64_t drawn = 0;        // pixels that hold a triangle in either picture
  std::uint64_t wrong_order = 0;  // of them, those where another triangle won
  double psnr_db = 0;             // over R, G, B of all pixels; infinite where equal
  int color_max = 0;              // largest difference of a channel, codes
};

class ErrorMeter {
 public:
  // The scene must outlive the meter.
  ErrorMeter(const Config& config, const Scene& scene);
  // Records of triangles[0..] as an engine delivered them, first_index as in Engine::draw.
  void add(std::span<const Triangle> triangles, std::int64_t first_index, const Trace& trace);
  // The finished pictures of the engine and of `ideal`.
  void add_pictures(const Frame& engine, const Frame& ideal);
  const ErrorReport& report() const { return report_; }

 private:
  void coverage(const IdealTriangle& t, const Trace& trace, std::size_t begin, std::size_t end);
  ErrorStat& stat(int row) { return report_.rows[static_cast<std::size_t>(row)].stat; }

  Config config_;
  const Scene* scene_;
  ErrorReport report_;
  std::vector<std::uint8_t> hits_;  // of one triangle's box
};

// What a field of a record of `triangle` would hold without any quantisation; none for fields that the truth
// has no value for (slopes, reciprocals, accumulators, indices).
std::optional<double> ideal_value(RecordType type, std::string_view field,
                                  std::span<const std::int64_t> record, const Config& config,
                                  const Scene& scene, const Triangle& triangle);

// "41.20 dB", or that the pictures are equal.
std::string psnr_text(double psnr_db);

}  // namespace bitspan
