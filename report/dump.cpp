// SPDX-License-Identifier: Apache-2.0
#include "report/dump.hpp"

#include <nlohmann/json.hpp>

#include "io/atomic_file.hpp"
#include "io/atomic_folder.hpp"
#include "io/npy.hpp"

namespace bitspan {

std::string run_json(const Frame& frame, const Counters& counters, const Config& config,
                     const DumpInfo& info) {
  nlohmann::ordered_json json;
  json["bitspan"] = info.version;
  json["dump_format"] = 1;
  json["engine"] = info.engine;
  if (info.model) {
    json["model"] = {{"form", info.model->form}, {"threads", info.model->threads}};
    if (!info.model->target.empty()) {
      json["model"]["target"] = info.model->target;
    }
  }
  json["scene"] = info.scene;
  json["width"] = frame.width;
  json["height"] = frame.height;
  if (info.supersample > 1) json["supersample"] = info.supersample;
  json["configuration"] = {{"name", config.name}, {"hash", config_hash(config)}, {"toml", to_toml(config)}};
  for_each_counter([&](const CounterInfo& info, auto member) {
    json["counters"][std::string(info.name)] = counters.*member;
  });
  json["wall_seconds"] = info.wall_seconds;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void write_dump(const std::string& directory, const Frame& frame, const Counters& counters,
                const Config& config, const DumpInfo& info) {
  AtomicFolder folder(directory);
  const auto h = static_cast<std::size_t>(frame.height);
  const auto w = static_cast<std::size_t>(frame.width);
  write_npy(folder.path("color.npy"), {h, w, 4}, frame.color);
  write_npy(folder.path("depth.npy"), {h, w}, frame.depth);
  write_npy(folder.path("u.npy"), {h, w}, frame.u);
  write_npy(folder.path("v.npy"), {h, w}, frame.v);
  write_npy(folder.path("triangle.npy"), {h, w}, frame.triangle);
  for (const char* optional : {"stencil.npy", "resolved.npy", "s.npy", "position.npy"})
    folder.leave_out(optional);
  if (!frame.stencil.empty()) write_npy(folder.path("stencil.npy"), {h, w}, frame.stencil);
  if (info.supersample > 1) {
    const auto k = static_cast<std::size_t>(info.supersample);
    write_npy(folder.path("resolved.npy"), {h / k, w / k, 4}, info.resolved);
  }
  if (info.positions) {
    write_npy(folder.path("s.npy"), {h, w}, info.positions->s);
    write_npy(folder.path("position.npy"), {h, w, 3}, info.positions->points);
  }
  write_file(folder.path("run.json"), run_json(frame, counters, config, info));
  folder.commit("run.json");
}

}  // namespace bitspan
