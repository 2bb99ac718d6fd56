// SPDX-License-Identifier: Apache-2.0
#include "report/replay.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "config/one_line.hpp"
#include "io/json_depth.hpp"
#include "report/scene_json.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string replay_json(const Replay& replay) {
  Json json;
  json["bitspan_replay"] = 1;
  json["found"] = replay.found;
  json["engines"] = replay.engines;
  json["stall_seed"] = replay.stall_seed;
  // The key of the first design that could be under test.
  for (const auto& [engine, hash] : replay.designs)
    (engine == "rtl" ? json["rtl"] : json["designs"][engine]) = hash;
  json["scene"] = scene_json(replay.scene);
  json["config_name"] = replay.config.name;
  json["config"] = to_toml(replay.config);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Replay parse_replay(const std::string& text, const std::string& origin) {
  Replay replay;
  std::string toml;
  try {
    check_json_depth(text);
    const Json json = Json::parse(text);
    if (json.at("bitspan_replay").get<int>() != 1) {
      throw InputError("bitspan_replay: expected 1");
    }
    replay.found = json.value("found", std::string());
    json.at("engines").get_to(replay.engines);
    json.at("stall_seed").get_to(replay.stall_seed);
    if (json.contains("designs")) json.at("designs").get_to(replay.designs);
    if (json.contains("rtl")) json.at("rtl").get_to(replay.designs["rtl"]);
    replay.scene = scene_of(json.at("scene"));
    json.at("config").get_to(toml);
    replay.config.name = json.value("config_name", std::string("replay"));
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: no replay file: {}", origin, fault_of(error)));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", origin, one_line(error.what())));
  }
  const std::string name = replay.config.name;
  replay.config = parse_config(toml, origin + ": config");
  replay.config.name = name;
  replay.scene.name = origin;
  check_scene(replay.scene, origin);
  return replay;
}

Replay read_replay(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) {
    throw InputError(fmt::format("{}: cannot read", path));
  }
  return parse_replay(text.str(), path);
}

}  // namespace bitspan
