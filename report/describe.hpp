// SPDX-License-Identifier: Apache-2.0
// The text of a divergence: values decoded, the records of both sides, and what fed them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "report/compare.hpp"

namespace bitspan {

// Return the value of a raw value, its bits as hexadecimal digits of the format's word, and the field's unit,
// a literal.
double decode(std::int64_t raw, const Field& field, const Config& config, std::int64_t channel = 0);
std::string hex_of(std::int64_t raw, const Field& field, const Config& config, std::int64_t channel = 0);
std::string_view unit_of(const Field& field, const Config& config, std::int64_t channel = 0);

// Where a divergence was seen, for its report.
struct RunLabel {
  std::string scene;    // file, "demo", or "fuzz seed S case I"
  std::string command;  // that reproduces it
};
// Returns many lines: where, what, both values in hexadecimal and decoded, distance in ULP, operands,
// command.
std::string describe(const Divergence& divergence, const Config& config, const RunLabel& label);
// Returns one line of it.
std::string summary(const Divergence& divergence, const Config& config);
// Returns one line "field 0x1f = 31.5 texel" per field, indented.
std::string describe_record(const RecordCopy& record, const Config& config, int indent);

}  // namespace bitspan
