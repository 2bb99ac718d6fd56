// SPDX-License-Identifier: Apache-2.0
#include "report/compare.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace bitspan {
namespace {

// A lost record is looked for among this many of its successors.
constexpr std::size_t resync_window = 4096;

bool is_identity(std::string_view name) {
  return name == "triangle" || name == "edge" || name == "row" || name == "x" || name == "y" ||
         name == "channel";
}

std::vector<int> identity_of(RecordType type) {
  std::vector<int> out;
  const auto fields = fields_of(type);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].kind == FieldKind::integer && is_identity(fields[i].name)) {
      out.push_back(static_cast<int>(i));
    }
  }
  return out;
}

bool same_identity(std::span<const std::int64_t> a, std::span<const std::int64_t> b,
                   const std::vector<int>& identity) {
  return std::ranges::all_of(
      identity, [&](int i) { return a[static_cast<std::size_t>(i)] == b[static_cast<std::size_t>(i)]; });
}

// Distance to the first record of `in` at or after `from` with the identity of `record`.
std::optional<std::size_t> find_ahead(const RecordView& in, std::size_t from,
                                      std::span<const std::int64_t> record,
                                      const std::vector<int>& identity) {
  const std::size_t end = std::min(in.records, from + resync_window);
  for (std::size_t i = from; i < end; ++i) {
    if (same_identity(in.record(i), record, identity)) {
      return i - from;
    }
  }
  return std::nullopt;
}

std::optional<std::int64_t> named(const RecordCopy& record, std::string_view field) {
  const int i = field_index(record.type, field);
  if (i < 0) {
    return std::nullopt;
  }
  return record.values[static_cast<std::size_t>(i)];
}

// The first difference of one type, with the place in both traces.
struct Found {
  DivergenceKind kind = DivergenceKind::value;
  RecordType type = RecordType::count;
  std::size_t reference = 0, other = 0;
  int field = -1;
  std::int64_t triangle = -1;  // -1: the constants
};

std::int64_t triangle_of(const RecordView& view, std::size_t i) {
  const int at = field_index(view.type, "triangle");
  return at < 0 ? -1 : view.record(i)[static_cast<std::size_t>(at)];
}

// Field by field; used only where the vectors are not equal as bytes.
std::optional<Found> walk(const RecordView& a, const RecordView& b, StageCount& count) {
  const std::vector<int> identity = identity_of(a.type);
  std::optional<Found> first;
  const auto note = [&](DivergenceKind kind, std::size_t i, std::size_t j, int field) {
    if (!first) {
      const std::int64_t triangle = kind == DivergenceKind::extra ? triangle_of(b, j) : triangle_of(a, i);
      first = Found{kind, a.type, i, j, field, triangle};
    }
  };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.records && j < b.records) {
    const auto ra = a.record(i);
    const auto rb = b.record(j);
    if (!same_identity(ra, rb, identity)) {
      const auto extra = find_ahead(b, j, ra, identity);
      const auto missing = find_ahead(a, i, rb, identity);
      if (extra && (!missing || *extra <= *missing)) {
        note(DivergenceKind::extra, i, j, -1);
        count.unmatched += *extra;
        j += *extra;
        continue;
      }
      if (missing) {
        note(DivergenceKind::missing, i, j, -1);
        count.unmatched += *missing;
        i += *missing;
        continue;
      }
    }
    ++count.records;
    count.values += ra.size();
    for (std::size_t f = 0; f < ra.size(); ++f) {
      if (ra[f] != rb[f]) {
        ++count.differences;
        note(DivergenceKind::value, i, j, static_cast<int>(f));
      }
    }
    ++i;
    ++j;
  }
  if (i < a.records) {
    note(DivergenceKind::missing, i, j, -1);
    count.unmatched += a.records - i;
  }
  if (j < b.records) {
    note(DivergenceKind::extra, i, j, -1);
    count.unmatched += b.records - j;
  }
  return first;
}

std::optional<Found> compare_type(const Trace& reference, const Trace& other, RecordType type,
                                  StageCount& count) {
  const RecordView a = view_of(reference, type);
  const RecordView b = view_of(other, type);
  const std::size_t values = a.records * a.fields.size();
  if (a.records == b.records &&
      (values == 0 || std::memcmp(a.values, b.values, values * sizeof(std::int64_t)) == 0)) {
    count.records += a.records;
    count.values += values;
    return std::nullopt;
  }
  return walk(a, b, count);
}

Divergence make_divergence(const Found& found, const Trace& a, const Trace& b, const Comparison& pair) {
  Divergence d;
  d.kind = found.kind;
  d.type = found.type;
  d.stage = stage_of(found.type);
  d.reference_engine = pair.reference;
  d.other_engine = pair.other;
  const RecordView va = view_of(a, found.type);
  const RecordView vb = view_of(b, found.type);
  if (found.kind != DivergenceKind::extra) {
    d.reference_record = copy_of(va, found.reference, pair.reference);
  }
  if (found.kind != DivergenceKind::missing) {
    d.other_record = copy_of(vb, found.other, pair.other);
  }
  const RecordCopy& where = d.reference_record ? *d.reference_record : *d.other_record;
  d.triangle = named(where, "triangle");
  d.x = named(where, "x");
  d.y = named(where, "y");
  if (!d.x) {
    d.x = named(where, "x_first");
  }
  if (found.kind == DivergenceKind::value) {
    const auto f = static_cast<std::size_t>(found.field);
    d.field = fields_of(found.type)[f].name;
    d.field_number = found.field;
    d.reference = d.reference_record->values[f];
    d.other = d.other_record->values[f];
  }
  const bool in_reference = d.reference_record.has_value();
  const Trace& source = in_reference ? a : b;
  d.upstream = upstream_of(source, found.type, where.values, in_reference ? found.reference : found.other);
  for (RecordCopy& record : d.upstream) {
    record.engine = in_reference ? pair.reference : pair.other;
  }
  return d;
}

template <class T>
bool same_value(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    return a == b || (std::isnan(a) && std::isnan(b));
  } else {
    return a == b;
  }
}

Divergence divergence_without_record(DivergenceKind kind, std::string_view field, const Comparison& pair) {
  Divergence d;
  d.kind = kind;
  d.stage = kind == DivergenceKind::frame ? "frame" : "counters";
  d.field = field;
  d.reference_engine = pair.reference;
  d.other_engine = pair.other;
  return d;
}

template <class T>
std::int64_t as_raw(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::bit_cast<std::int64_t>(value);
  } else {
    return static_cast<std::int64_t>(value);
  }
}

// Values that are neither 0 nor the one before them; before the first stands a 0. Without a branch, so that
// the compiler makes vectors of it.
template <class T>
std::uint64_t count_non_trivial(const T* values, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  auto n = static_cast<std::uint64_t>(!same_value(values[0], T{}));
  for (std::size_t i = 1; i < size; ++i) {
    const T now = values[i];
    const T before = values[i - 1];
    int same = now == before;
    if constexpr (std::is_floating_point_v<T>) {
      same |= static_cast<int>(now != now) & static_cast<int>(before != before);
    }
    n += static_cast<std::uint64_t>(static_cast<int>(now != T{}) & (1 - same));
  }
  return n;
}

template <class T>
void compare_plane(const std::vector<T>& a, const std::vector<T>& b, std::size_t per_pixel, PixelGrid grid,
                   std::string_view name, Comparison& into) {
  const std::size_t size = std::min(a.size(), b.size());
  into.frame.values += size;
  if (a.size() != b.size()) {
    into.frame.unmatched += std::max(a.size(), b.size()) - size;
  }
  into.frame.non_trivial += count_non_trivial(a.data(), size);
  if (size == 0 || std::memcmp(a.data(), b.data(), size * sizeof(T)) == 0) {
    return;
  }
  for (std::size_t i = 0; i < size; ++i) {
    if (same_value(a[i], b[i])) {
      continue;
    }
    ++into.frame.differences;
    if (!into.first) {
      const auto pixel = static_cast<std::int64_t>(i / per_pixel);
      into.first = divergence_without_record(DivergenceKind::frame, name, into);
      into.first->x = grid.x_of(pixel);
      into.first->y = grid.y_of(pixel);
      into.first->reference = as_raw(a[i]);
      into.first->other = as_raw(b[i]);
    }
  }
}

}  // namespace

StageCount& StageCount::operator+=(const StageCount& more) {
  records += more.records;
  values += more.values;
  non_trivial += more.non_trivial;
  differences += more.differences;
  unmatched += more.unmatched;
  return *this;
}

std::uint64_t Comparison::differences() const {
  const StageCount all = total();
  return all.differences + all.unmatched + frame.differences + frame.unmatched + counters.differences +
         static_cast<std::uint64_t>(!fault.empty());
}

StageCount Comparison::total() const {
  StageCount sum;
  for (const StageCount& stage : stages) sum += stage;
  return sum;
}

namespace {

// The loop is compiled for each kind of vector and picked when the program is loaded, which happens before
// the sanitizers are ready for it. 64-bit comparisons are slow in the baseline.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
__attribute__((target_clones("avx512f", "avx2", "default")))
#endif
std::uint64_t
count_changed(const std::int64_t* before, const std::int64_t* now, std::size_t size) {
  std::uint64_t n = 0;
  for (std::size_t i = 0; i < size; ++i) {
    n += static_cast<std::uint64_t>((now[i] != 0) & (now[i] != before[i]));
  }
  return n;
}

}  // namespace

std::array<std::uint64_t, record_types> NonTrivial::count(const Trace& trace) {
  std::array<std::uint64_t, record_types> out{};
  for (int t = 0; t < record_types; ++t) {
    const RecordView view = view_of(trace, static_cast<RecordType>(t));
    if (view.records == 0) {
      continue;
    }
    const std::size_t stride = view.fields.size();
    auto& previous = previous_[static_cast<std::size_t>(t)];
    previous.resize(stride, 0);
    std::uint64_t n = 0;
    for (std::size_t f = 0; f < stride; ++f) {
      n += static_cast<std::uint64_t>(view.values[f] != 0 && view.values[f] != previous[f]);
    }
    // One flat pass: the value before is one record's width back.
    n += count_changed(view.values, view.values + stride, (view.records - 1) * stride);
    const auto last = view.record(view.records - 1);
    previous.assign(last.begin(), last.end());
    out[static_cast<std::size_t>(t)] = n;
  }
  return out;
}

void compare_traces(const Trace& reference, const Trace& other,
                    const std::array<std::uint64_t, record_types>& non_trivial, Comparison& into) {
  std::optional<Found> first;
  for (int t = 0; t < record_types; ++t) {
    StageCount& count = into.stages[static_cast<std::size_t>(t)];
    count.non_trivial += non_trivial[static_cast<std::size_t>(t)];
    const auto found = compare_type(reference, other, static_cast<RecordType>(t), count);
    if (found && (!first || found->triangle < first->triangle)) {
      first = found;
    }
  }
  if (first && !into.first) {
    into.first = make_divergence(*first, reference, other, into);
  }
}

void compare_records(const Trace& reference, const Trace& other, RecordType type, Comparison& into) {
  const auto found = compare_type(reference, other, type, into.stages[static_cast<std::size_t>(type)]);
  if (found && !into.first) into.first = make_divergence(*found, reference, other, into);
}

void compare_frames(const Frame& reference, const Frame& other, Comparison& into) {
  const auto pixels = [](const Frame& f) {
    return static_cast<std::uint64_t>(f.width) * static_cast<std::uint64_t>(f.height);
  };
  into.frame.records += std::min(pixels(reference), pixels(other));
  const PixelGrid grid{std::max(1, reference.width), reference.first_row};
  compare_plane(reference.depth, other.depth, 1, grid, "depth", into);
  compare_plane(reference.triangle, other.triangle, 1, grid, "triangle", into);
  compare_plane(reference.u, other.u, 1, grid, "u", into);
  compare_plane(reference.v, other.v, 1, grid, "v", into);
  compare_plane(reference.color, other.color, 4, grid, "color", into);
  compare_plane(reference.stencil, other.stencil, 1, grid, "stencil", into);
}

void compare_counters(const Counters& reference, const Counters& other, Comparison& into) {
  const auto one = [&](std::string_view name, auto a, auto b) {
    ++into.counters.values;
    into.counters.non_trivial += static_cast<std::uint64_t>(a != 0);
    if (a == b) {
      return;
    }
    ++into.counters.differences;
    if (!into.first) {
      into.first = divergence_without_record(DivergenceKind::counter, name, into);
      into.first->reference = static_cast<std::int64_t>(a);
      into.first->other = static_cast<std::int64_t>(b);
    }
  };
  ++into.counters.records;
  for_each_counter([&](const CounterInfo& info, auto member) {
    if (info.compared) one(info.name, reference.*member, other.*member);
  });
}

}  // namespace bitspan
