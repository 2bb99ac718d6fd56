// SPDX-License-Identifier: Apache-2.0
// The model with functions of the caller's behind its stages: what becomes of the picture where a stage made
// something else. Record by record, and so slower than make_model.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "engine/engine.hpp"

namespace bitspan {

// Gets the record that feeds the stage, and what the stage made of it, which it may change within the
// registers' formats. The pixels of a row and the identity of a record stay what they are.
using StageHook = std::function<void(std::span<const std::int64_t> in, std::span<std::int64_t> out)>;
// By RecordType; empty where the stage is the model's own.
using StageHooks = std::array<StageHook, record_types>;

// Says whether a stage may have a hook: not the constants, and not the plane, whose rows follow from more
// than its record.
bool may_be_hooked(RecordType type);

// Throws std::logic_error where a stage has a hook that may not have one. The engine is a RowEngine, too.
std::unique_ptr<Engine> make_overridden_model(const Config& config, StageHooks hooks);

}  // namespace bitspan
