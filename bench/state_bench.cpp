// SPDX-License-Identifier: Apache-2.0
// What a change of draw state costs the model: a stream with changes between its triangles, beside the same
// one without.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/report.hpp"
#include "bench/scenes.hpp"
#include "config/store.hpp"
#include "model/engine_model.hpp"

namespace bitspan::bench {
namespace {

constexpr std::size_t triangles = 20000;
constexpr double pixels = 16;

// What the change in front of triangle i writes into the blend's constant, which the blend does not take.
// Where it is not 0, the tests are late, which is another state with the same picture.
using Change = std::int64_t (*)(std::size_t i);
constexpr std::int64_t none = -1;
std::int64_t no_change(std::size_t /*i*/) { return none; }
std::int64_t to_first_state(std::size_t /*i*/) { return 0; }
std::int64_t once_to_another(std::size_t i) { return i == 0 ? 1 : none; }
std::int64_t to_another(std::size_t i) { return static_cast<std::int64_t>(1 + i % 255); }

Scene small_stream(Change change) {
  Scene scene = empty_scene("state", 1024, 768);
  CloudStream stream(3, scene, pixels);
  const std::size_t constant = find_state_register("blend.red").value();
  const std::size_t when = find_state_register("depth.when").value();
  for (std::size_t i = 0; i < triangles; ++i) {
    scene.triangles.push_back(stream.next());
    if (change(i) == none) continue;
    scene.commands.push_back(
        {i, StateChange{false, {{constant, change(i)}, {when, change(i) != 0 ? 1 : 0}}}});
  }
  return scene;
}

struct Stream {
  std::string name;
  Scene scene;
  std::unique_ptr<Engine> engine{};
  Series* series = nullptr;
};

// Microseconds per change, of the rounds that both took part in.
Summary cost_of(const Stream& with, const Stream& without) {
  const auto changes = static_cast<double>(with.scene.commands.size() - without.scene.commands.size());
  std::vector<double> out;
  for (std::size_t i = 0; i < std::min(with.series->seconds.size(), without.series->seconds.size()); ++i) {
    const auto& a = with.series->seconds[i];
    const auto& b = without.series->seconds[i];
    if (a && b) out.push_back(1e6 * (*a - *b) / changes);
  }
  return summarise(std::move(out));
}

}  // namespace

void bench_state(const Options& options, Report& report) {
  const Config config = find_config("depth16");
  std::vector<Stream> streams;
  streams.push_back({"first state, no change", small_stream(no_change)});
  streams.push_back({"first state, a change per triangle", small_stream(to_first_state)});
  streams.push_back({"another state, one change", small_stream(once_to_another)});
  streams.push_back({"another state, a change per triangle", small_stream(to_another)});
  std::vector<Turn> turns;
  for (Stream& s : streams) {
    s.engine = make_model(config, {.winners = false});
    s.series = &report.add("state: " + s.name, static_cast<double>(triangles) / 1e6, "Mtriangle/s");
    turns.push_back({s.series, [&s] {
                       const double start = now_seconds();
                       s.engine->begin(s.scene);
                       draw_scene(*s.engine, s.scene, 0, s.scene.triangles.size(), nullptr);
                       return now_seconds() - start;
                     }});
  }
  take_turns("state", turns, options.rounds);
  const Frame& first = streams[0].engine->frame();
  for (const Stream& s : streams) {
    const Frame& frame = s.engine->frame();
    if (frame.color == first.color && frame.depth == first.depth) continue;
    report.notes.push_back(fmt::format("state: WRONG: {} draws another picture", s.name));
    report.sound = false;
  }
  for (const std::size_t with : {std::size_t{1}, std::size_t{3}}) {
    const Summary cost = cost_of(streams[with], streams[with - 1]);
    report.notes.push_back(fmt::format(
        "state: a change costs {:.2f} us ({:.2f} .. {:.2f}): {}, less {}, {} triangles of {} pixels",
        cost.median, cost.low, cost.high, streams[with].name, streams[with - 1].name, triangles, pixels));
    report.goals.push_back({"small triangles, " + streams[with].name, streams[with - 1].name,
                            streams[with].series, streams[with - 1].series, 0});
  }
  report.goals.push_back(
      {"small triangles, " + streams[2].name, streams[0].name, streams[2].series, streams[0].series, 0});
}

}  // namespace bitspan::bench
