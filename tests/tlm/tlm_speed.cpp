// SPDX-License-Identifier: Apache-2.0
// The time of a frame of the demo: by the C library alone, and through the TLM-2.0 device.
//
//   tlm_speed [ROUNDS]
#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "bench.hpp"

namespace bitspan_tlm {
namespace {

using Clock = std::chrono::steady_clock;
double milliseconds(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}
double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

double drawn_by(bs_model* model, const LoadedScene& scene) {
  const auto since = Clock::now();
  bs_begin(model, &scene.desc);
  bs_draw(model, scene.vertices, scene.textures, scene.count, 0, 0);
  return milliseconds(since);
}
double drawn_by(Host& host, std::size_t size) {
  const auto since = Clock::now();
  host.start(size);
  if (host.finish() != BS_TLM_STATUS_DONE) std::abort();
  return milliseconds(since);
}

void measure(int rounds) {
  const auto config = configuration("depth16");
  const LoadedScene scene("demo", 640, 480);
  const auto open = [&](const char* engine) {
    bs_model* model = nullptr;
    ok(bs_open(config.get(), engine, &model));
    ok(bs_trace(model, 0));
    return Handle<bs_model>(model);
  };
  const auto model = open("model");
  const auto timed = open("timed");
  Settings approximate;
  approximate.timing = Timing::approximate;
  Bench loose_bench("loose", config.get(), {});
  Bench approximate_bench("approximate", config.get(), approximate);
  Settings without_clocks;
  without_clocks.engine = "model";
  Bench model_bench("model", config.get(), without_clocks);
  model_bench.load(scene);
  const std::size_t size = loose_bench.load(scene);
  approximate_bench.load(scene);
  std::vector<double> times[5];
  // The first host's thread drives every device; the others have ended.
  loose_bench.run([&] {
    for (int i = -1; i < rounds; ++i) {
      const double round[] = {drawn_by(model.get(), scene), drawn_by(timed.get(), scene),
                              drawn_by(loose_bench.host, size), drawn_by(approximate_bench.host, size),
                              drawn_by(model_bench.host, size)};
      if (i < 0) continue;  // the first one warms up
      for (std::size_t k = 0; k < 5; ++k) times[k].push_back(round[k]);
    }
  });
  const char* const names[] = {"bs_draw, engine model", "bs_draw, engine timed", "TLM, loosely timed",
                               "TLM, approximately timed", "TLM, engine model"};
  const double reference = median(times[1]);
  for (std::size_t k = 0; k < 5; ++k) {
    const double t = median(times[k]);
    std::printf("%-26s %7.2f ms  %5.2f times timed\n", names[k], t, t / reference);
  }
}

}  // namespace
}  // namespace bitspan_tlm

int sc_main(int argc, char** argv) {
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_DO_NOTHING);
  bitspan_tlm::measure(argc > 1 ? std::atoi(argv[1]) : 21);
  return 0;
}
