// SPDX-License-Identifier: Apache-2.0
#include "model/scene_run.hpp"

#include <stdexcept>
#include <string>

namespace bitspan::model {

void SceneRun::begin(const Scene& s, bool winners) {
  scene.begin(s);
  counters = {};
  constants_delivered = false;
  set_state(pipeline, s, pipeline.first);
  targets = {};
  take_rows(targets.current());
  clear_frame(pipeline, s, winners, frame);
}

void SceneRun::need_begun(const char* call) const {
  if (!scene.has_begun()) throw std::logic_error(std::string("Engine::") + call + " before begin");
}

void SceneRun::deliver_constants(Trace* trace) {
  if (trace == nullptr || constants_delivered) return;
  trace->constants.push_back(pipeline.constants.record);
  constants_delivered = true;
}

void SceneRun::execute(const Config& config, const DrawCommand& command, std::int64_t next_index,
                       Trace* trace) {
  need_begun("execute");
  std::visit([&](const auto& what) { run(config, what, next_index, trace); }, command.what);
}

void SceneRun::run(const Config& config, const StateChange& change, std::int64_t next_index, Trace* trace) {
  deliver_constants(trace);
  const DrawState next = changed_state(pipeline.state, change, config, scene->textures.size());
  change_state(pipeline, *scene, frame, next, next_index, trace);
}

void SceneRun::run(const Config& /*config*/, const Clear& clear, std::int64_t /*next_index*/,
                   Trace* /*trace*/) {
  clear_planes(pipeline, frame, clear);
}

void SceneRun::run(const Config& config, const Target& target, std::int64_t /*next_index*/,
                   Trace* /*trace*/) {
  const std::uint64_t before = scene.version();
  scene.run(target);
  update(config, before);
  take_rows(target.k);
  select_target(pipeline, *scene, targets, target.k, frame);
}

void SceneRun::run(const Config& config, const ViewChange& change, std::int64_t /*next_index*/,
                   Trace* /*trace*/) {
  const std::uint64_t before = scene.version();
  const int width = scene->width;
  const int height = scene->height;
  scene.run(change);
  update(config, before);
  if (scene->width != width || scene->height != height) resize_frame(pipeline, *scene, frame);
}

void SceneRun::run(const Config& config, const Copy& copy, std::int64_t /*next_index*/, Trace* /*trace*/) {
  check_copy(*scene, scene.views(), copy);
  const std::uint64_t before = scene.version();
  scene.run(copy, targets.of(copy.target, frame), config.depth_bits);
  update(config, before);
}

void SceneRun::run(const Config& /*config*/, const Resolve& /*resolve*/, std::int64_t /*next_index*/,
                   Trace* trace) {
  deliver_constants(trace);
  if (statistics != nullptr) {
    resolve(pipeline, frame, counters, trace, Observe{statistics});
  } else {
    resolve(pipeline, frame, counters, trace);
  }
}

void SceneRun::take_rows(int k) { pipeline.rows = band && band->target == k ? band->rows : RowRange{}; }

void SceneRun::update(const Config& config, std::uint64_t since) {
  if (statistics != nullptr) {
    update_pipeline(pipeline, config, scene, since, Observe{statistics});
  } else {
    update_pipeline(pipeline, config, scene, since);
  }
  if (scene.view_version() > since) constants_delivered = false;
}

}  // namespace bitspan::model
