// SPDX-License-Identifier: Apache-2.0
// The engine around a machine of the timed model. Which machines there are is the caller's matter, so that a
// program with span mode alone needs no SystemC.
#pragma once

#include <memory>
#include <string_view>

#include "model/timed/machine.hpp"

namespace bitspan::timed {

using MakeMachine = std::unique_ptr<Machine> (*)(const Config&, const Scene&, const SystemcOptions&);

// `name` is the engine's and outlives it. Throws InputError where the configuration has no timing.
std::unique_ptr<TimedEngine> make_timed_engine(std::string_view name, const Config& config,
                                               const SystemcOptions& options, MakeMachine make);

}  // namespace bitspan::timed
