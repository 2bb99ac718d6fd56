// The engines by name: the one place that knows them all.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/engine.hpp"
#include "model/engine_model.hpp"

namespace bitspan {

// golden, model, systemc, rtl, ideal: in the order of trust, ideal apart, since it is not quantised.
std::span<const std::string_view> engine_names();

// "golden,model" -> names, each known and named once. Throws InputError otherwise.
std::vector<std::string> parse_engines(const std::string& list);

// Whether this engine runs this configuration; rtl does not in the modes without RTL.
bool engine_runs(std::string_view name, const Config& config);

// stall_seed seeds the random stalls of rtl's input and output; model: how the engine model computes. The
// other engines have none of either.
std::unique_ptr<Engine> make_engine(std::string_view name, const Config& config, std::uint64_t stall_seed = 1,
                                    const ModelOptions& model = {});

}  // namespace bitspan
