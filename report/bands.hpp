// SPDX-License-Identifier: Apache-2.0
// A scene in bands of rows against the whole picture: engines against each other in every band, and what all
// bands delivered together against what the whole run did. [B3, H5]
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/bands.hpp"
#include "report/lockstep.hpp"

namespace bitspan {

// The records of each stage in any order: how many, and the sum of their hashes. Equal sets have equal
// digests; two sets that differ have them by chance alone, one pair in 2^64.
class RecordDigest {
 public:
  void add(const Trace& trace);
  // The first stage in the table that differs; empty where none does.
  std::string difference(const RecordDigest& other) const;
  std::uint64_t records() const;
  // Over all stages.
  std::uint64_t hash() const;
  bool operator==(const RecordDigest&) const = default;

 private:
  struct Sum {
    std::uint64_t records = 0, hash = 0;
    bool operator==(const Sum&) const = default;
  };
  std::array<Sum, record_types> of_{};
};

// What a whole run left behind, of an engine whose records `digest` has.
struct WholeRun {
  const Frame& picture;
  const Counters& counters;
  const RecordDigest& digest;
};

// One height of bands.
struct BandReport {
  int rows = 0, bands = 0;            // rows of each band but the last
  std::vector<std::string> engines;   // that drew bands
  std::vector<Comparison> pairs;      // of engine 1, 2 ... with engine 0, over all bands
  Comparison whole;                   // of engine 0's bands with its whole run: picture and counters
  std::uint64_t records = 0;          // of engine 0
  std::uint64_t hash = 0;             // of these records
  Counters counters;                  // of engine 0, over all bands
  BandWork work;                      // the same
  BufferBits bits;                    // of a pixel's planes
  std::uint64_t bytes = 0;            // of these planes, of a band
  std::vector<std::string> failures;  // one line each; empty: all held

  bool held() const { return failures.empty(); }
};

// What bands of so many rows hold and repeat; nothing is compared.
BandReport figures_of_bands(const Config& config, int rows, const BandedRun& run);

// Draws the scene in bands of so many rows by each engine, all of which have bands. The run ends behind the
// band with the first divergence. done(b): behind band b. Throws InputError as banded_plan does.
BandReport compare_bands(std::vector<std::unique_ptr<Engine>> engines, const Config& config,
                         const Scene& scene, int rows, const WholeRun& whole,
                         const std::function<void(int)>& done);

// "bands of 16 rows".
std::string bands_name(int rows);
// A table with one row per height: buffers, and what is done again; and lines under it.
std::string bands_text(std::span<const BandReport> reports);

}  // namespace bitspan
