// SPDX-License-Identifier: Apache-2.0
// A failure as one file: the configuration, the scene with its textures, and the engines that differed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct Replay {
  std::vector<std::string> engines;  // the first is the reference
  std::uint64_t stall_seed = 1;
  // EngineEntry::design of the engines that have one: what was under test.
  std::map<std::string, std::string> designs;
  std::string found;  // where it came from and what was seen, for people
  Config config;
  Scene scene;
};

// JSON; numbers are the shortest that read back as the same double.
std::string replay_json(const Replay& replay);
// Throws InputError, one line, where the file is missing or no replay, or holds an illegal scene or
// configuration.
Replay read_replay(const std::string& path);
Replay parse_replay(const std::string& text, const std::string& origin);

}  // namespace bitspan
