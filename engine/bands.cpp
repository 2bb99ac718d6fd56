// SPDX-License-Identifier: Apache-2.0
#include "engine/bands.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace bitspan {
namespace {

Counters difference(const Counters& from, const Counters& less) {
  Counters out;
  for_each_counter(
      [&](const CounterInfo& /*info*/, auto member) { out.*member = from.*member - less.*member; });
  return out;
}

[[noreturn]] void refuse_plan(const Scene& scene, const std::string& what) {
  throw InputError("--bands: " + scene.name + ": " + what);
}

}  // namespace

BandWork& BandWork::operator+=(const BandWork& other) {
  set_up += other.set_up;
  set_up_again += other.set_up_again;
  unsorted += other.unsorted;
  rows_above += other.rows_above;
  fragments_again += other.fragments_again;
  return *this;
}

BandedPlan banded_plan(const Scene& scene) {
  const auto line = std::ranges::find(scene.triangles, true, &Triangle::is_line);
  if (line != scene.triangles.end()) {
    refuse_plan(scene, "triangle " + std::to_string(line - scene.triangles.begin()) +
                           " is a line, which is drawn whole; expected triangles alone");
  }
  Views views(scene);
  for (const DrawCommand& command : scene.commands) {
    if (may_change_view(command)) views.execute(command);
  }
  BandedPlan out{.target = views.target(), .width = views.now().width, .height = views.now().height};
  views = Views(scene);
  std::size_t drawn = 0;  // triangles behind the command before
  const auto check_size = [&](std::size_t before) {
    const bool draws = before > drawn && views.target() == out.target;
    if (draws && (views.now().width != out.width || views.now().height != out.height)) {
      refuse_plan(scene,
                  "the picture has triangles in two sizes; expected one size from the first triangle on");
    }
    drawn = before;
  };
  for (const DrawCommand& command : scene.commands) {
    check_size(command.before);
    if (may_change_view(command)) views.execute(command);
    const auto* copy = std::get_if<Copy>(&command.what);
    if (copy != nullptr && copy->target == out.target) {
      refuse_plan(scene, "a command copies target " + std::to_string(copy->target) +
                             ", the picture itself, of which a band has some rows alone; expected copies of "
                             "other targets");
    }
  }
  check_size(scene.triangles.size());
  return out;
}

BandedEngine::BandedEngine(std::unique_ptr<Engine> inner, const Config& config)
    : inner_(std::move(inner)),
      bands_(dynamic_cast<BandEngine*>(inner_.get())),
      coordinate_(config.coordinate_format()) {
  if (bands_ == nullptr) {
    throw InputError("--bands: the engine " + std::string(inner_->name()) +
                     " draws whole pictures; legal: golden, model");
  }
}

void BandedEngine::set_band(const BandedPlan& plan, const RowRange& rows) {
  plan_ = plan;
  rows_ = rows;
}

void BandedEngine::begin(const Scene& scene) {
  work_ = {};
  repeated_ = {};
  target_ = 0;
  bands_->begin_band(scene, {plan_.target, rows_});
}

template <class Run>
void BandedEngine::repeat(Run run) {
  const Counters before = inner_->counters();
  run();
  const Counters more = difference(inner_->counters(), before);
  repeated_ += more;
  work_.fragments_again += more.fragments;
}

void BandedEngine::draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) {
  if (draws_band()) {
    draw_band(triangles, first_index, trace);
  } else if (is_first()) {
    inner_->draw(triangles, first_index, trace);
  } else {
    repeat([&] { inner_->draw(triangles, first_index, nullptr); });
  }
}

void BandedEngine::draw_band(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) {
  // The first band has the constants, also where no triangle reaches it.
  if (is_first() && trace != nullptr) inner_->draw({}, first_index, trace);
  const std::size_t constants = trace != nullptr ? trace->constants.size() : 0;
  const std::int64_t least = -(std::int64_t{1} << (coordinate_.word - 1));
  const RowReach reach(least, -least - 1, coordinate_.fraction(), plan_.height);
  enum class Part : std::uint8_t { none, first, again };
  const auto part_of = [&](const Triangle& t) {
    const RowRange rows = reach.of(t);
    if (rows.first >= rows_.end || rows.end <= rows_.first) return Part::none;
    return rows.first < rows_.first ? Part::again : Part::first;
  };
  work_.unsorted += triangles.size();
  for (std::size_t at = 0; at < triangles.size();) {
    const Part part = part_of(triangles[at]);
    std::size_t end = at + 1;
    while (end < triangles.size() && part_of(triangles[end]) == part) ++end;
    const std::span some = triangles.subspan(at, end - at);
    const std::int64_t index = first_index + static_cast<std::int64_t>(at);
    if (part == Part::first) inner_->draw(some, index, trace);
    if (part == Part::again) bands_->draw_again(some, index, trace);
    if (part != Part::none) work_.set_up += some.size();
    if (part == Part::again) work_.set_up_again += some.size();
    at = end;
  }
  if (trace != nullptr) trace->constants.resize(constants);
}

void BandedEngine::execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) {
  if (const auto* target = std::get_if<Target>(&command.what)) target_ = target->k;
  if (is_first()) return inner_->execute(command, next_index, trace);
  const bool is_band = draws_band();
  const auto run = [&] {
    const std::size_t constants = trace != nullptr ? trace->constants.size() : 0;
    const std::size_t states = trace != nullptr ? trace->state.size() : 0;
    inner_->execute(command, next_index, is_band ? trace : nullptr);
    if (trace == nullptr) return;
    trace->constants.resize(constants);
    trace->state.resize(states);
  };
  if (is_band) return run();
  repeat(run);
}

const Counters& BandedEngine::counters() const {
  counters_ = difference(inner_->counters(), repeated_);
  return counters_;
}

BandWork BandedEngine::work() const {
  BandWork out = work_;
  out.rows_above = bands_->rows_above();
  return out;
}

int number_of_bands(int height, int rows) { return (height + rows - 1) / rows; }

RowRange band_of(int height, int rows, int band) {
  const std::int64_t first = std::int64_t{rows} * band;
  return RowRange{first, first + rows}.within(height);
}

void put_band(const Frame& band, int height, Frame& picture) {
  const bool is_first = picture.height == 0;
  picture.width = band.width;
  picture.height = height;
  picture.full_alpha = band.full_alpha;
  const auto pixels = static_cast<std::size_t>(band.width) * static_cast<std::size_t>(height);
  const auto first = static_cast<std::size_t>(band.first_row) * static_cast<std::size_t>(band.width);
  const auto put = [&](const auto& rows, auto& plane, std::size_t per_pixel) {
    if (is_first) plane.assign(rows.empty() ? 0 : per_pixel * pixels, {});
    std::ranges::copy(rows, plane.begin() + static_cast<std::ptrdiff_t>(per_pixel * first));
  };
  put(band.color, picture.color, 4);
  put(band.depth, picture.depth, 1);
  put(band.u, picture.u, 1);
  put(band.v, picture.v, 1);
  put(band.triangle, picture.triangle, 1);
  put(band.stencil, picture.stencil, 1);
  put(band.candidates, picture.candidates, 1);
}

std::uint64_t BufferBits::bytes(std::uint64_t pixels) const {
  return (pixels * static_cast<std::uint64_t>(sum()) + 7) / 8;
}

BufferBits buffer_bits(const Config& config, const Frame& frame) {
  BufferBits out;
  out.depth = config.depth_bits;
  out.color = frame.full_alpha ? 24 : 32;
  if (!frame.stencil.empty()) out.stencil = 8;
  if (!frame.candidates.empty()) {
    out.candidate = config.depth_bits + 3 * config.format(FormatId::fog_color).word +
                    config.format(FormatId::texture_alpha).word;
  }
  return out;
}

void BandedRun::add(const BandedEngine& engine, int height) {
  put_band(engine.frame(), height, picture);
  counters += engine.counters();
  work += engine.work();
}

BandedRun run_in_bands(BandedEngine& engine, const Scene& scene, int rows,
                       const std::function<void(int)>& done) {
  const BandedPlan plan = banded_plan(scene);
  BandedRun out;
  for (int b = 0; b < number_of_bands(plan.height, rows); ++b) {
    engine.set_band(plan, band_of(plan.height, rows, b));
    engine.begin(scene);
    draw_scene(engine, scene, 0, scene.triangles.size(), nullptr);
    out.add(engine, plan.height);
    done(b);
  }
  return out;
}

}  // namespace bitspan
