// SPDX-License-Identifier: Apache-2.0
// What a record was made from: the records of the stages in front that fed it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/engine.hpp"

namespace bitspan {

// A record with its names, kept for a report.
struct RecordCopy {
  RecordType type = RecordType::count;
  std::string engine;
  std::vector<std::int64_t> values;
};
// Returns record i of a view; `engine` is the one that made it.
RecordCopy copy_of(const RecordView& view, std::size_t i, std::string_view engine);

// Returns the records of a trace that fed `record`, one level up: a fragment's span, a span's row ...
// `ordinal` is its place among the records of its type, where that is known.
std::vector<RecordCopy> upstream_of(const Trace& trace, RecordType type, std::span<const std::int64_t> record,
                                    std::optional<std::size_t> ordinal = std::nullopt);

}  // namespace bitspan
