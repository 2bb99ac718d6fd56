// SPDX-License-Identifier: Apache-2.0
// The comparator: what two engines delivered for the same triangles, record by record, field by field.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/engine.hpp"
#include "report/upstream.hpp"

namespace bitspan {

enum class DivergenceKind : std::uint8_t { value, missing, extra, frame, counter };

// Something that a stage read, beside records.
struct Read {
  std::string name, value;
};

// The first place where two engines differ: the earliest triangle, and of it the earliest stage.
struct Divergence {
  DivergenceKind kind = DivergenceKind::value;
  std::string stage;
  std::string field;
  std::string reference_engine, other_engine;
  std::optional<std::int64_t> triangle, x, y;
  RecordType type = RecordType::count;  // of value, missing, extra
  int field_number = -1;
  std::int64_t reference = 0, other = 0;  // raw, of value, frame and counter
  std::optional<RecordCopy> reference_record, other_record;
  std::vector<bool>
      has_other;  // per field of other_record: the other engine delivered it; empty: all of them
  std::vector<RecordCopy> upstream;  // the records that fed the reference's record
  std::vector<Read> read;            // what else the stage read, once add_reads was asked (report/reads.hpp)
};

struct StageCount {
  std::uint64_t records = 0;      // pairs of records compared
  std::uint64_t values = 0;       // pairs of values compared
  std::uint64_t non_trivial = 0;  // values of the reference that are neither 0 nor those of the record before
  std::uint64_t differences = 0;  // values that differ
  std::uint64_t unmatched = 0;    // records that only one side delivered

  StageCount& operator+=(const StageCount& more);
};

// What became of one pair of engines, over any number of batches.
struct Comparison {
  std::string reference, other;
  std::array<StageCount, record_types> stages{};
  StageCount frame;     // planes of the picture; a "record" is a pixel
  StageCount counters;  // of Counters, all but `cycles`
  std::optional<Divergence> first;
  std::string
      fault;  // what `other` broke off with (an assertion in the RTL, a deadlock), empty where it did not

  bool held() const { return !first && fault.empty(); }
  std::uint64_t differences() const;  // values and unmatched records together, frame and counters included
  StageCount total() const;           // of the stages
};

// Counts non-trivial values over the batches of one engine: a value is non-trivial when it is not 0 and
// differs from the same field of the record delivered before it (of that type, earlier batches included).
// So a field that never changes counts once, and a run of black pixels or empty records counts nothing.
class NonTrivial {
 public:
  // Counts of this batch, a record type each.
  std::array<std::uint64_t, record_types> count(const Trace& trace);

 private:
  std::array<std::vector<std::int64_t>, record_types> previous_;
};

// Compares one batch. Records are matched in order; where a record is missing on one side the walk finds its
// place again by the record's identity (triangle, edge, row, x, y), so that one lost record is one unmatched
// record and not a difference in each that follows. Equal vectors cost one memcmp.
void compare_traces(const Trace& reference, const Trace& other,
                    const std::array<std::uint64_t, record_types>& non_trivial, Comparison& into);
// Compares the records of one type alone; of the other types the reference's tell what fed a record that
// differs. Non-trivial values are the caller's to count.
void compare_records(const Trace& reference, const Trace& other, RecordType type, Comparison& into);
// Pictures and counters at the end of a scene. NaN equals NaN in u and v.
void compare_frames(const Frame& reference, const Frame& other, Comparison& into);
void compare_counters(const Counters& reference, const Counters& other, Comparison& into);

}  // namespace bitspan
