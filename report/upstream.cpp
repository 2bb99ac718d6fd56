// SPDX-License-Identifier: Apache-2.0
#include "report/upstream.hpp"

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace bitspan {
namespace {

// A record whose feeders are sought, with its place among those of its type where that is known.
struct Fed {
  RecordType type;
  std::span<const std::int64_t> record;
  std::optional<std::size_t> ordinal;

  // -1 where it has no field of that name.
  std::int64_t value(std::string_view field) const {
    const int i = field_index(type, field);
    return i < 0 ? -1 : record[static_cast<std::size_t>(i)];
  }
};

// The places of the records of `feeders` in which each field named has the value of the same field of `fed`.
std::vector<std::size_t> with_same(const RecordView& feeders, const Fed& fed,
                                   std::initializer_list<std::string_view> fields) {
  std::vector<std::pair<std::size_t, std::int64_t>> wanted;
  for (const std::string_view field : fields) {
    const int at = field_index(feeders.type, field);
    if (at < 0) return {};
    wanted.emplace_back(at, fed.value(field));
  }
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < feeders.records; ++i) {
    const auto record = feeders.record(i);
    if (std::ranges::all_of(wanted, [&](const auto& w) { return record[w.first] == w.second; })) {
      out.push_back(i);
    }
  }
  return out;
}

// An edge_walk record's edges: the left one, and the right one where that is another.
std::vector<std::size_t> edges_of_row(const RecordView& edges, const Fed& row) {
  std::vector<std::size_t> out;
  const std::vector<std::size_t> of_triangle = with_same(edges, row, {"triangle"});
  const int at = field_index(edges.type, "edge");
  const auto add = [&](std::int64_t edge) {
    for (const std::size_t i : of_triangle) {
      if (edges.record(i)[static_cast<std::size_t>(at)] == edge) out.push_back(i);
    }
  };
  const std::int64_t left = row.value("l_edge");
  const std::int64_t right = row.value("r_edge");
  add(left);
  if (right != left) add(right);
  return out;
}

// The span that made the fragment of this ordinal.
std::vector<std::size_t> span_of_fragment(const Trace& trace, std::size_t ordinal) {
  std::size_t end = 0;
  for (std::size_t i = 0; i < trace.span.size(); ++i) {
    end += static_cast<std::size_t>(std::max<std::int64_t>(0, trace.span[i].count));
    if (ordinal < end) return {i};
  }
  return {};
}

// The starts of the span that a record of a pixel's channel lies on. One of a row is found by its fragments.
std::vector<std::size_t> starts_of_channel(const Trace& trace, const Fed& fed) {
  const RecordView starts = view_of(trace, RecordType::span_channel);
  if (!fed.ordinal || trace.fragment.empty() || trace.span.empty()) return {};
  const std::size_t channels = trace.fragment_channel.size() / trace.fragment.size();
  if (channels == 0) return {};
  std::vector<std::size_t> out;
  for (const std::size_t span : span_of_fragment(trace, *fed.ordinal / channels)) {
    for (std::size_t c = 0; c < channels; ++c) {
      if (channels * span + c < starts.records) out.push_back(channels * span + c);
    }
  }
  return out;
}

// The places of the records of one type that feed `fed`, of all channels.
std::vector<std::size_t> feeders_in(const Trace& trace, const RecordView& feeders, const Fed& fed) {
  switch (row_of(feeders.type).per) {
    case Per::scene:
      return with_same(feeders, fed, {});
    case Per::change:  // no other record is made from it
      return {};
    case Per::triangle:
      return with_same(feeders, fed, {"triangle"});
    case Per::edge:
      return edges_of_row(feeders, fed);
    case Per::row:
      // A row of constant depth may run along y: it is found by its place, one span per row in their order.
      if (feeders.type == RecordType::plane_row) {
        const bool known = fed.ordinal && *fed.ordinal < feeders.records;
        return known ? std::vector{*fed.ordinal} : std::vector<std::size_t>{};
      }
      if (feeders.type == RecordType::span && fed.type == RecordType::fragment && fed.ordinal) {
        return span_of_fragment(trace, *fed.ordinal);
      }
      if (feeders.type == RecordType::span_channel) return starts_of_channel(trace, fed);
      if (feeders.type == RecordType::span) return with_same(feeders, fed, {"triangle", "x", "y"});
      return with_same(feeders, fed, {"triangle", "y"});
    case Per::pixel:
      return with_same(feeders, fed, {"triangle", "x", "y"});
  }
  return {};
}

// The same, of the channel of `fed` where it is of one.
std::vector<std::size_t> feeders_of(const Trace& trace, const RecordView& feeders, const Fed& fed) {
  std::vector<std::size_t> found = feeders_in(trace, feeders, fed);
  if (row_of(feeders.type).per_channel() && row_of(fed.type).per_channel()) {
    std::erase_if(found, [&](std::size_t i) {
      return channel_of(feeders.type, feeders.record(i)) != channel_of(fed.type, fed.record);
    });
  }
  return found;
}

}  // namespace

RecordCopy copy_of(const RecordView& view, std::size_t i, std::string_view engine) {
  const auto record = view.record(i);
  return {view.type, std::string(engine), {record.begin(), record.end()}};
}

std::vector<RecordCopy> upstream_of(const Trace& trace, RecordType type, std::span<const std::int64_t> record,
                                    std::optional<std::size_t> ordinal) {
  std::vector<RecordCopy> out;
  for (const RecordType feeder : row_of(type).made_from) {
    const RecordView feeders = view_of(trace, feeder);
    for (const std::size_t i : feeders_of(trace, feeders, {type, record, ordinal})) {
      out.push_back(copy_of(feeders, i, ""));
    }
  }
  return out;
}

}  // namespace bitspan
