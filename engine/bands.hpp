// SPDX-License-Identifier: Apache-2.0
// A picture in bands of rows: the commands are run once per band, into planes of a few rows. [B3, H5]
//
// A band has the records, the bits and the counters that the whole picture has in its rows. What there is
// once per triangle is made again in each band that the triangle reaches; it is delivered and counted in the
// first.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "config/config.hpp"
#include "engine/engine.hpp"

namespace bitspan {

// Rows first .. end - 1 of a picture; by default all.
struct RowRange {
  std::int64_t first = 0;
  std::int64_t end = std::numeric_limits<std::int64_t>::max();

  bool has(std::int64_t y) const { return y >= first && y < end; }
  // Those of a picture of so many rows.
  RowRange within(std::int64_t height) const { return {std::min(first, height), std::min(end, height)}; }
  bool operator==(const RowRange&) const = default;
};

struct Band {
  int target = 0;  // that has rows of its picture alone; the others are whole
  RowRange rows;
};

// What golden and the model take beside Engine::draw.
class BandEngine {
 public:
  virtual ~BandEngine() = default;
  // As Engine::begin, for one band: holds until either is called again. While the band's target is drawn
  // on, frame() has the rows of the band, and draw() makes, delivers and counts these rows alone.
  virtual void begin_band(const Scene& scene, const Band& band) = 0;
  // As draw(), of triangles that another band delivers and counts: without what there is per triangle and
  // edge, and in const_depth_rows per row.
  virtual void draw_again(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) = 0;
  // Rows above the band that edges were walked over since begin_band(), of triangles that have rows in it.
  virtual std::uint64_t rows_above() const = 0;
};

// The rows that a triangle may have pixels in, by its vertices: some more, and never fewer. A triangle beside
// the picture has the row next to it.
class RowReach {
 public:
  // least, most: raw values of a coordinate with so many fraction bits; height: of the picture, at least 1.
  RowReach(std::int64_t least, std::int64_t most, int fraction, std::int64_t height)
      : height_(height),
        margin_(2 + std::ldexp(1.0, -fraction)),
        low_(std::ldexp(static_cast<double>(least), -fraction)),
        high_(std::ldexp(static_cast<double>(most), -fraction)) {}

  RowRange of(const Triangle& t) const {
    const double low = std::min({t.v[0].y, t.v[1].y, t.v[2].y});
    const double high = std::max({t.v[0].y, t.v[1].y, t.v[2].y});
    // A coordinate beyond its format may end anywhere.
    if (!(low >= low_ && high <= high_)) return {0, height_};
    return {row_of(low - margin_), row_of(high + margin_) + 1};
  }

 private:
  std::int64_t row_of(double y) const {
    return static_cast<std::int64_t>(std::clamp(y, 0.0, static_cast<double>(height_ - 1)));
  }
  std::int64_t height_;
  double margin_, low_, high_;
};

// What bands repeat.
struct BandWork {
  std::uint64_t set_up = 0;           // setups of triangles, those made again included
  std::uint64_t set_up_again = 0;     // in a band that is not the triangle's first
  std::uint64_t unsorted = 0;         // setups where each band takes every triangle
  std::uint64_t rows_above = 0;       // as BandEngine::rows_above
  std::uint64_t fragments_again = 0;  // on other targets, which each band draws whole

  BandWork& operator+=(const BandWork& other);
  bool operator==(const BandWork&) const = default;
};

// The target whose picture a scene shows, and that picture's size.
struct BandedPlan {
  int target = 0;
  int width = 0, height = 0;
};
// Throws InputError where a band does not suffice: a command copies the picture's own planes, or the picture
// has triangles in two sizes.
BandedPlan banded_plan(const Scene& scene);

// One band of a scene at a time, as an engine: over all bands it delivers and counts what `inner` does of the
// whole picture, in another order.
class BandedEngine final : public Engine {
 public:
  // Throws InputError where the engine has no bands.
  BandedEngine(std::unique_ptr<Engine> inner, const Config& config);

  // From the next begin() on; the plan is the scene's.
  void set_band(const BandedPlan& plan, const RowRange& rows);
  std::string_view name() const override { return inner_->name(); }
  void begin(const Scene& scene) override;
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override;
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override;
  // Of the band, where its target is drawn on.
  const Frame& frame() const override { return inner_->frame(); }
  const Counters& counters() const override;
  // Since begin().
  BandWork work() const;

 private:
  bool is_first() const { return rows_.first == 0; }
  bool draws_band() const { return target_ == plan_.target; }
  void draw_band(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace);
  // Runs what an earlier band has done whole.
  template <class Run>
  void repeat(Run run);

  std::unique_ptr<Engine> inner_;
  BandEngine* bands_;  // the same engine
  Format coordinate_;
  BandedPlan plan_;
  RowRange rows_;
  int target_ = 0;
  BandWork work_;
  Counters repeated_;          // what an earlier band has counted
  mutable Counters counters_;  // those of `inner_` without these
};

// The bands of a picture from top to bottom. rows: of each but the last, which may have fewer; 1 at least.
int number_of_bands(int height, int rows);
RowRange band_of(int height, int rows, int band);

// Puts the rows of a band into the picture of that height, whose planes it makes with the first band.
void put_band(const Frame& band, int height, Frame& picture);

// Bits per pixel of the planes that a configuration and a run hold: those of a design, not those of Frame.
struct BufferBits {
  int depth = 0, color = 0, stencil = 0, candidate = 0;

  int sum() const { return depth + color + stencil + candidate; }
  // Of so many pixels, rounded up.
  std::uint64_t bytes(std::uint64_t pixels) const;
};
// frame: at the end of a run.
BufferBits buffer_bits(const Config& config, const Frame& frame);

struct BandedRun {
  Frame picture;
  Counters counters;
  BandWork work;

  // What the engine has done of its band, of a picture of that height.
  void add(const BandedEngine& engine, int height);
};
// Draws a scene in bands of so many rows; done(b) is called behind band b. Throws InputError as banded_plan
// and the engine do.
BandedRun run_in_bands(BandedEngine& engine, const Scene& scene, int rows,
                       const std::function<void(int)>& done);

}  // namespace bitspan
