// SPDX-License-Identifier: Apache-2.0
// Vectors: the records that feed a stage and those that it makes, as files for benches in any language; and
// the answers of a design, read back and compared with the model. docs/vectors.md defines the files.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/engine.hpp"
#include "report/compare.hpp"
#include "report/describe.hpp"
#include "scene/scene.hpp"

namespace bitspan {

enum class VectorFormat : std::uint8_t { hex, json, npy };
inline constexpr std::array<std::string_view, 3> vector_formats{"hex", "json", "npy"};  // by number
// Throws InputError where there is none of that name.
VectorFormat vector_format(std::string_view name);

struct Vectors {
  Config config;
  Scene scene;
  RecordType stage = RecordType::count;
  Trace trace;  // of the engine model: the whole scene, every stage
  // Of merge and merge.alpha, per record of merge: triangle, x, y, and the red, green, blue and alpha that
  // the picture holds there in front of it.
  std::vector<std::int64_t> stored{};
};

// The records in front of the stage that a bench needs, where there are any: the constants, the changes of
// state, those that it is made from, and "merge.stored".
std::vector<RecordView> inputs_of(const Vectors& vectors);

// Called with the triangles done and in all; may be empty.
using DrawProgress = std::function<void(std::size_t, std::size_t)>;
// Draws the scene. Throws InputError where it does not fit the configuration.
Vectors make_vectors(const Config& config, const Scene& scene, RecordType stage,
                     const DrawProgress& progress = {});

// Writes a file (json), or a folder of files (hex, npy), whole or not at all. `version` is the program's.
void write_vectors(const Vectors& vectors, VectorFormat format, const std::string& path,
                   const std::string& version);

struct VectorCheckOptions {
  std::string answers;  // the records of the design, in the place of the output file of hex or npy
  std::vector<std::string> fields;  // that the design has; empty: all that the vectors have
};

// The design's answers against the model's.
struct VectorCheck {
  Config config;
  std::string scene;
  RecordType stage = RecordType::count;
  Comparison pair;                // model against design; the counts leave out what is not answered
  std::uint64_t matched = 0;      // values that are equal
  std::uint64_t non_trivial = 0;  // values answered that are neither 0 nor those of the record before
  std::uint64_t unchecked = 0;    // records of the model that have no answer
  std::vector<std::string> unchecked_fields;  // without an answer in any record
  std::uint64_t unanswered = 0;               // values of the other fields without an answer
  std::uint64_t unknown = 0;                  // answers with x or z bits
  std::string first_unknown;                  // "record 3, field u"
  std::vector<std::string> failures;          // one line each; empty: all held

  bool held() const { return failures.empty(); }
};

// Reads vectors, draws their scene with the model again, and compares. Throws InputError, one line, where a
// file is missing, damaged or cut short, or where the input records are not those of the scene.
VectorCheck check_vectors(const std::string& path, const VectorCheckOptions& options = {},
                          const DrawProgress& progress = {});
// What the check found, with the first divergence in full.
std::string check_text(const VectorCheck& check, const RunLabel& label);

}  // namespace bitspan
