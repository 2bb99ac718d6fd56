// SPDX-License-Identifier: Apache-2.0
// Sweeps over a meter that costs nothing.
#pragma once

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "study/sweep.hpp"
#include "tests/support/files.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {

inline constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

inline Scene small_scene() {
  Scene scene;
  scene.name = "small";
  scene.width = 8;
  scene.height = 8;
  scene.s_min = 2;
  scene.s_max = 200;
  scene.fog = Fog{{1, 2, 3}, 20};
  scene.triangles.push_back({{{{0, 0, 2, 0, 0}, {8, 0, 20, 5, 0}, {0, 8, 200, 0, 5}}}, -1});
  return scene;
}

// A meter that costs nothing: the error is the last place of span.h, and a span.h of fewer than 20 bits is
// refused.
struct Fake {
  std::atomic<int> calls{0};
  std::atomic<int> meters{0};
  std::mutex mutex;
  std::vector<double> ratios;               // of the scenes that meters were made for
  std::function<void(const Config&)> hook;  // called first

  MakeMeter maker() {
    return [this](std::vector<Scene> scenes) -> Measure {
      ++meters;
      ratios.push_back(scenes.at(0).s_max / scenes.at(0).s_min);
      return [this, ratio = ratios.back()](const Config& config) {
        ++calls;
        if (hook) hook(config);
        const Format& f = config.format(FormatId::span_h);
        if (f.word < 20) throw InputError("fake: formats.span.h.word: too narrow");
        PointResult r;
        r.metrics["span.u.max"] = std::ldexp(ratio, -f.fraction());
        r.metrics["cost.register_bits"] = f.word;
        r.metrics["span.v.max"] = no_number;
        r.fields.push_back({"span", "u", "texel", 0.5, 3, 0.1});
        r.scenes = {{"small", {{"span.u.max", r.metrics["span.u.max"]}, {"span.v.max", no_number}}}};
        return r;
      };
    };
  }
};

inline Config find_shipped(const std::string& name) { return shipped_config(name); }

inline StudyPlan sweep_plan(const std::string& rest, const std::string& study = "") {
  return parse_study("[study]\nname = \"s\"\nbase = \"depth16\"\n" + study + rest, "s.toml", find_shipped);
}

inline const std::string words = "[[vary]]\nkeys = [\"formats.span.h.word\"]\nvalues = [18, 24, 30, 34]\n";
inline const std::string below = "[[constraint]]\nmetric = \"span.u.max\"\nat_most = 0.01\n";

struct Bench {
  TemporaryFolder folder;
  Fake fake;
  std::unique_ptr<Store> store = std::make_unique<Store>(folder.path("a.db"), "1");
  RunOptions options;

  PointRunner runner(const std::string& version = "1", const Asked& asked = {}) {
    return {shipped_config("depth16"), {small_scene()}, fake.maker(), *store, version, asked};
  }
  SweepResult sweep(const StudyPlan& plan) {
    PointRunner r = runner("1", asked_of(plan));
    return run_sweep(plan, r, *store, options);
  }
  std::int64_t count(const std::string& sql) {
    return integer_of(store->rows("SELECT count(*) FROM " + sql)[0][0]);
  }
};

}  // namespace bitspan
