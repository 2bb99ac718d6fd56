// SPDX-License-Identifier: Apache-2.0
#include "report/lockstep.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
#include <set>
#include <string>
#include <utility>

namespace bitspan {
namespace {

// Pixels of a triangle's bounding box inside the viewport: an upper bound of its fragments.
double box_pixels(const Triangle& triangle, const Scene& scene) {
  double x0 = scene.width;
  double x1 = 0;
  double y0 = scene.height;
  double y1 = 0;
  for (const Vertex& v : triangle.v) {
    x0 = std::min(x0, v.x);
    x1 = std::max(x1, v.x);
    y0 = std::min(y0, v.y);
    y1 = std::max(y1, v.y);
  }
  const double w = std::min<double>(x1 + 1, scene.width) - std::max(0.0, x0 - 1);
  const double h = std::min<double>(y1 + 1, scene.height) - std::max(0.0, y0 - 1);
  return std::max(0.0, w) * std::max(0.0, h);
}

// The text of what the engine threw; empty where it did not.
std::string draw_guarded(Engine& engine, const Batch& batch, Trace& trace) {
  try {
    draw_batch(engine, batch, &trace);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return *error.what() == '\0' ? "an exception without a text" : error.what();
  }
  return "";
}

}  // namespace

std::size_t next_batch(const Scene& scene, std::size_t from, const LockStepOptions& options) {
  double pixels = 0;
  std::size_t n = 0;
  while (from + n < scene.triangles.size() && n < options.batch_triangles) {
    pixels += box_pixels(scene.triangles[from + n], scene);
    if (n > 0 && pixels > static_cast<double>(options.batch_pixels)) {
      break;
    }
    ++n;
  }
  return n;
}

LockStepResult run_lock_step(std::span<const std::unique_ptr<Engine>> engines, const Scene& scene,
                             const LockStepOptions& options) {
  const Scene* whole = &scene;
  return run_lock_step(
      engines, scene, [&] { return std::exchange(whole, nullptr); }, options);
}

LockStepResult run_lock_step(std::span<const std::unique_ptr<Engine>> engines, const Scene& scene,
                             const NextPiece& next, const LockStepOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  LockStepResult result;
  const Scene* piece = next();  // first, as it may refuse what an engine would
  for (const auto& engine : engines) {
    engine->begin(scene);
  }
  for (std::size_t e = 1; e < engines.size(); ++e) {
    Comparison pair;
    pair.reference = engines[0]->name();
    pair.other = engines[e]->name();
    result.pairs.push_back(std::move(pair));
  }
  NonTrivial non_trivial;
  Trace reference;
  Trace other;
  std::size_t done = 0;
  std::set<int> targets{0};  // drawn on
  int shown = 0;
  const auto run_batch = [&](const Batch& batch) {
    double pixels = 0;
    for (const Triangle& triangle : batch.triangles()) pixels += box_pixels(triangle, scene);
    // The largest kinds of record would otherwise be moved each time they grow; a page that is not written
    // costs nothing.
    reference.reserve_pixels(static_cast<std::size_t>(pixels));
    other.reserve_pixels(static_cast<std::size_t>(pixels));
    reference.clear();
    draw_batch(*engines[0], batch, &reference);
    for (int t = 0; t < record_types; ++t) {
      result.records += view_of(reference, static_cast<RecordType>(t)).records;
    }
    const auto counts = non_trivial.count(reference);
    for (std::size_t e = 1; e < engines.size(); ++e) {
      Comparison& pair = result.pairs[e - 1];
      other.clear();
      pair.fault = draw_guarded(*engines[e], batch, other);
      if (pair.fault.empty()) {
        compare_traces(reference, other, counts, pair);
      }
      result.stopped = result.stopped || !pair.held();
    }
    if (options.observe) {
      options.observe(batch, reference);
    }
    done += batch.count;
    if (options.progress) {
      options.progress(done);
    }
  };
  while (piece != nullptr) {
    for (const DrawCommand& command : piece->commands) {
      if (const auto* target = std::get_if<Target>(&command.what)) targets.insert(shown = target->k);
    }
    std::size_t at = 0;
    // A scene without a triangle still gives its constants.
    do {
      const std::size_t n = next_batch(*piece, at, options);
      run_batch({*piece, at, n, static_cast<std::int64_t>(done)});
      at += n;
    } while (at < piece->triangles.size() && !result.stopped);
    piece = result.stopped ? nullptr : next();
  }
  targets.erase(shown);
  std::vector<int> order(targets.begin(), targets.end());
  order.push_back(shown);  // last, so that it is what the engines show
  for (const int k : order) {
    for (const auto& engine : engines)
      engine->execute({.what = Target{k}}, static_cast<std::int64_t>(done), nullptr);
    for (std::size_t e = 1; e < engines.size(); ++e) {
      compare_frames(engines[0]->frame(), engines[e]->frame(), result.pairs[e - 1]);
    }
  }
  for (std::size_t e = 1; e < engines.size(); ++e) {
    compare_counters(engines[0]->counters(), engines[e]->counters(), result.pairs[e - 1]);
  }
  result.triangles_done = done;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace bitspan
