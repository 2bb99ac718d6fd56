// SPDX-License-Identifier: Apache-2.0
// Records through the Verilated span interpolator: to port values and back, with gaps and stalls.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {

// Returns the port values of a row; b is the constants' record value, and the last argument has the channels
// in use. Throws std::logic_error where a value does not fit its port, which never happens for a legal
// record.
RtlInputs rtl_inputs(const Config& config, const RowRecord& row, std::int64_t b,
                     std::span<const RowChannelRecord> ends = {});
RtlInputs rtl_inputs(const Config& config, const LineWalkRecord& line, std::int64_t b);
RtlInputs rtl_inputs(const Config& config, const PlaneRowRecord& row, std::int64_t k, std::int64_t b,
                     std::span<const SpanChannelRecord> starts = {});

// Return what the RTL knows of a record, with signs. Every other field is 0 and is filled by its owner:
// triangle, y, covered, x and y where the major axis is y, and the shades where the RTL has none.
SpanRecord span_record(const Config& config, const RtlSpan& span);
FragmentRecord fragment_record(const Config& config, const RtlPixel& pixel);
// Replace what the RTL knows of a channel's record: its values. The record's channel says which one it is.
void take_channel(const Config& config, const RtlSpan& span, SpanChannelRecord& record);
void take_channel(const Config& config, const RtlPixel& pixel, FragmentChannelRecord& record);
// The other way: the values of a record to the ports.
void put_channel(const Config& config, const SpanChannelRecord& record, RtlSpan& span);
void put_channel(const Config& config, const FragmentChannelRecord& record, RtlPixel& pixel);

// Random gaps between the records offered, and stalls of the output. Each clock is drawn on its own, from the
// seed alone.
struct RtlStalls {
  std::uint64_t seed = 1;
  double in_gap = 0;     // probability that no record is offered on a clock
  double out_stall = 0;  // probability that out_ready is 0 on a clock
};

// The handshake of one clock.
struct RtlHandshake {
  bool in_valid = false;
  bool in_ready = false;
  bool out_valid = false;
  bool out_ready = false;
  bool operator==(const RtlHandshake&) const = default;
};

struct RtlRun {
  std::vector<RtlSpan> spans;            // in the order they were taken, surplus ones at the end
  std::vector<RtlPixel> pixels;          // in the order they were delivered, surplus ones at the end
  std::vector<RtlHandshake> handshakes;  // one per clock, where asked for
  std::uint64_t clocks = 0;              // from the first one driven to the last pixel's transfer
  std::vector<std::uint64_t>
      accepted_at;                      // clock of each record's acceptance, where handshakes were asked for
  std::vector<std::uint64_t> taken_at;  // ... of each span's take
  std::vector<std::uint64_t> delivered_at;  // ... of each pixel's transfer
};

// Feeds the records until all are accepted and all their pixels delivered, and runs on until the RTL must be
// empty. Of those last clocks only what they deliver is kept: spans and pixels that no record asked for.
// Throws std::logic_error where an assertion in the RTL fails, or where nothing moves although it should.
RtlRun run_rtl(Rtl& rtl, std::span<const RtlInputs> records, const RtlStalls& stalls, bool keep_handshakes);

// Drives the same in_valid and out_ready, clock for clock, as in `driven` and returns what the RTL answered.
// Records are offered in order; a clock with in_valid after the last record is an error. Then it runs on as
// run_rtl does.
RtlRun replay_rtl(Rtl& rtl, std::span<const RtlInputs> records, std::span<const RtlHandshake> driven);

}  // namespace bitspan
