// SPDX-License-Identifier: Apache-2.0
// The timed model in span mode: the cycle mode's numbers by arithmetic on the clocks at which something
// moves.
//
// Why the numbers are equal. In cycle mode each part's clock is a function of two things only, both as they
// were when the clock began: levels (of FIFOs, of what is inside a part, of requests) and comparisons of the
// clock with times (a record is due, an interval ends, an answer has come, a pixel is free, the bus is free).
// Levels change only where something moves. So on a clock that no movement went before, and that none of
// these times falls on, a part does what it did on the clock before: nothing, in the same state. Therefore
//   - after each clock that it is looked at, a part names the earliest of its times to come: the next clock
//     where it moved something itself;
//   - who changes what another part waits for has it looked at on the next clock, which is when a register
//     shows it: a push where the FIFO was empty, a pop where it was full, the release of a pixel;
//   - the clocks in between are added to the state that the part was in, and are not looked at.
// A time named too early costs a look for nothing. One named too late would be a fault; the tests hold every
// number against cycle mode's.
//
// Within a clock the parts are looked at from the memory and merge upstream to the source, so that a reader
// does not see its writer's push of the same clock; the writer leaves out its reader's pop (Level::room).
//
// What the records are and what they ask of the memory does not depend on the clock: Workload makes both
// ahead of it, a span at a time.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/timed/machine.hpp"
#include "model/timed/span_parts.hpp"
#include "model/timed/workload.hpp"

namespace bitspan::timed {
namespace {

using namespace span_mode;

// The stages behind span, each a pipe of fragments. Depth stands in front of texture or, with late tests,
// behind it.
constexpr Stage first_fragment_stage = Stage::depth;
constexpr Stage last_stage = Stage::merge;
constexpr std::size_t fragment_stages =
    static_cast<std::size_t>(Stage::count) - static_cast<std::size_t>(first_fragment_stage);
constexpr Stage fragment_stage(std::size_t i) {
  return static_cast<Stage>(static_cast<std::size_t>(first_fragment_stage) + i);
}
constexpr bool has_memory(Stage stage) {
  return stage == Stage::depth || stage == Stage::texture || stage == Stage::merge;
}

class SpanMachine final : public Machine {
 public:
  SpanMachine(const Config& config, const Scene& scene, const SystemcOptions& options)
      : Machine(config, scene, options),
        workload_(run_),
        in_flight_(run_.frame.depth.size()),
        interpolator_(interpolator_latency(config)) {
    prepare(setup_, Stage::setup);
    for (std::size_t i = 0; i < fragment_stages; ++i) prepare(fragment_pipes_[i], fragment_stage(i));
    const auto width = static_cast<std::uint64_t>(config.memory.width_bytes);
    for (const Stage stage : {Stage::depth, Stage::texture, Stage::merge}) {
      std::ranges::transform(workload_.accesses(stage), fragment_pipe(stage).requests.begin(),
                             [&](const Access& access) {
                               return Request{(access.bytes + width - 1) / width, access.is_read};
                             });
    }
    state_changed();
    // A latency of at least 1 keeps a clock's askers from seeing an answer of that clock.
    bus_.latency = std::max<Clock>(static_cast<Clock>(config.memory.latency), 1);

    const StageTiming& walk = run_.timing(Stage::edge_walk);
    walk_.meter.name = run_.walk_name();
    set_timing(walk_, walk, 0);
    interpolator_.in.capacity = static_cast<std::uint64_t>(run_.timing(Stage::span_setup).fifo);
    interpolator_.setup.name = to_string(Stage::span_setup);
    interpolator_.span.name = to_string(Stage::span);
  }

 private:
  template <class P>
  static void set_timing(P& p, const StageTiming& timing, int extra) {
    p.in.capacity = static_cast<std::uint64_t>(timing.fifo);
    p.latency = static_cast<Clock>(timing.latency);
    p.interval = static_cast<Clock>(timing.interval);
    p.capacity = (p.latency + p.interval - 1) / p.interval + static_cast<std::uint64_t>(extra);
  }
  void prepare(Pipe& p, Stage stage) {
    p.meter.name = to_string(stage);
    set_timing(p, run_.timing(stage), has_memory(stage) ? run_.config.memory.latency : 0);
    p.entries.resize(std::bit_ceil(p.capacity));
    p.mask = p.entries.size() - 1;
  }

  void state_changed() override;
  void cleared(const Clear& clear) override { workload_.cleared(clear); }
  void target_changed() override { workload_.target_changed(); }
  void scene_changed(std::uint64_t since) override {
    in_flight_.resize(std::max(in_flight_.size(), run_.frame.depth.size()));
    workload_.scene_changed(since);
  }
  void clock_until_drained(std::span<const Triangle> triangles, std::int64_t first_index) override;
  std::uint64_t cycles() const override { return cycles_; }
  void fill(TimedReport& report) const override;

  void clock_bus(Clock now);
  void clock_source(Clock now);
  void clock_walk(Clock now);
  void clock_interpolator(Clock now);
  template <Stage stage>
  void clock_pipe(Pipe& p, Clock now);
  template <Stage stage>
  const FragmentWork& work_of(std::uint64_t number);
  template <Stage stage>
  Port& port();
  template <Stage stage>
  Pipe& pipe() {
    if constexpr (stage == Stage::setup) {
      return setup_;
    } else {
      return fragment_pipe(stage);
    }
  }
  Pipe& fragment_pipe(Stage stage) {
    return fragment_pipes_[static_cast<std::size_t>(stage) - static_cast<std::size_t>(first_fragment_stage)];
  }
  template <Stage stage>
  void clock_where_due(Clock now) {
    Pipe& p = pipe<stage>();
    if (p.wake <= now) clock_pipe<stage>(p, now);
  }
  // From merge upstream.
  void clock_fragment_pipes(Clock now) {
    clock_where_due<Stage::merge>(now);
    clock_where_due<Stage::fog>(now);
    if (tests_late_) clock_where_due<Stage::depth>(now);
    clock_where_due<Stage::texture>(now);
    if (!tests_late_) clock_where_due<Stage::depth>(now);
  }
  Clock next_wake() const;
  bool drained() const;
  // Throws where nothing has moved for too long.
  void watch(Clock cycle) const {
    if (cycle - last_move_ >= watchdog_clocks_) give_up();
  }
  [[noreturn]] void give_up() const;

  Workload workload_;
  std::vector<std::uint8_t> in_flight_;                    // per pixel: whether depth has to wait for it
  std::array<std::uint32_t, fragment_stages> released_{};  // by the stages from depth on, on the clock before
  std::size_t releases_ = 0;                               // how many
  std::uint32_t awaited_pixel_ = 0;                        // the one depth has waited for last
  Bus bus_;
  Source source_;
  Pipe setup_;
  Walk walk_;
  Interpolator interpolator_;
  std::array<Pipe, fragment_stages> fragment_pipes_;
  Pipe* first_pipe_ = nullptr;  // behind span
  bool tests_late_ = false;
  Clock cycles_ = 0;
};

void SpanMachine::state_changed() {
  tests_late_ = run_.tests_late();
  std::array<Stage, fragment_stages> order{Stage::depth, Stage::texture, Stage::fog, Stage::merge};
  if (tests_late_) std::swap(order[0], order[1]);
  first_pipe_ = &fragment_pipe(order[0]);
  Part* from = &interpolator_;
  for (std::size_t i = 0; i < order.size(); ++i) {
    Pipe& p = fragment_pipe(order[i]);
    p.from = std::exchange(from, &p);
    p.to = i + 1 < order.size() ? &fragment_pipe(order[i + 1]) : nullptr;
  }
}

void SpanMachine::clock_bus(Clock now) {
  const std::array<Part*, 3> askers{&pipe<Stage::merge>(), &pipe<Stage::depth>(), &pipe<Stage::texture>()};
  for (std::size_t i = 0; i < askers.size() && now >= bus_.free; ++i) {
    Port& port = bus_.ports[i];
    if (port.level.size() == 0) continue;
    const Port::Slot& slot = port.slots[port.level.popped & 1];
    const Request& request = *slot.request;
    if (request.is_read) {
      Entry& reader = *slot.entry;
      reader.answer = now + bus_.latency + request.beats - 1;
      reader.open &= ~slot.ask;
      if (reader.open == 0) {
        reader.ready = std::max(reader.due, reader.answer);
        askers[i]->look(reader.ready);
      }
    }
    if (port.level.full()) askers[i]->poke(now);
    port.level.pop(now);
    bus_.free = now + request.beats;
    bus_.report.beats += request.beats;
  }
  bus_.wake = bus_.waited_for() ? bus_.free : never;
}

void SpanMachine::clock_source(Clock now) {
  if (source_.to_offer == 0 || !setup_.in.room(now)) {
    source_.sleep(now, never);
    return;
  }
  if (setup_.in.push()) setup_.poke(now);
  --source_.to_offer;
  ++source_.offered;
  source_.sleep(now, now + 1);
}

// As WalkStage::clock.
void SpanMachine::clock_walk(Clock now) {
  Walk& w = walk_;
  const bool in_valid = w.in.size() > 0;
  const bool out_valid = !w.due.empty() && w.due.front() <= now;
  const bool out_ready = interpolator_.in.room(now);
  bool moved = false;
  Clock next = never;

  if (out_valid && out_ready) {
    w.due.pop();
    if (interpolator_.in.push()) interpolator_.poke(now);
    ++w.meter.out;
    moved = true;
  }
  if (!out_valid && !w.due.empty()) next = w.due.front();

  const bool in_interval = now < w.next_entry;
  const bool can_walk = w.due.size() < w.capacity && !in_interval;
  if (in_interval) next = std::min(next, w.next_entry);
  if (!w.has_triangle && can_walk && in_valid) {
    w.has_triangle = true;
    if (w.in.full()) setup_.poke(now);
    w.in.pop(now);
    ++w.meter.in;
  }
  const bool walked = w.has_triangle && can_walk;
  if (walked) {
    w.next_entry = now + w.interval;
    if (!workload_.has_step(w.steps)) {
      Workload::Read read{.triangles = setup_.in.popped, .steps = w.steps, .fragments = {}};
      for (std::size_t i = 0; i < fragment_stages; ++i) {
        read.fragments[static_cast<std::size_t>(fragment_stage(i))] = fragment_pipes_[i].in.popped;
      }
      workload_.forget(read);
    }
    const WalkStep step = workload_.step(w.steps++);
    if (step.pixels > 0) {
      w.due.push(now + w.latency);
      interpolator_.pixels.push(step.pixels);
    }
    if (step.last) w.has_triangle = false;
  }

  if (moved || walked) last_move_ = now + 1;
  w.meter.set(walked || in_interval        ? StageState::busy
              : out_valid && !out_ready    ? StageState::blocked
              : w.has_triangle || in_valid ? StageState::busy
                                           : StageState::starved,
              now);
  w.sleep(now, moved || walked ? now + 1 : next);
}

// As SpanInterpolator::clock.
void SpanMachine::clock_interpolator(Clock now) {
  Interpolator& s = interpolator_;
  const bool in_valid = s.in.size() > 0;
  Pipe& next_pipe = *first_pipe_;
  const bool out_ready = next_pipe.in.room(now);
  if (now > s.seen) s.timing.skip(now - s.seen);
  s.seen = now + 1;
  const InterpolatorClock c = s.timing.clock(in_valid, in_valid ? s.pixels.front() : 0, out_ready);

  if (c.deliver) {
    if (next_pipe.in.push()) next_pipe.poke(now);
    ++s.span.out;
  }
  if (c.take) {
    ++s.setup.out;
    ++s.span.in;
  }
  if (c.accept) {
    s.pixels.pop();
    if (s.in.full()) walk_.poke(now);
    s.in.pop(now);
    ++s.setup.in;
  }

  if (c.accept || c.take || c.issue || c.deliver) last_move_ = now + 1;
  s.setup.set(c.accept ? StageState::busy : s.setup_state(c.setup_held, in_valid, c.setup_busy), now);
  s.span.set(
      c.issue ? StageState::busy : Interpolator::held(c.span_held || (c.out_valid && !out_ready), c.active),
      now);

  // The next clock, as far as this part alone can tell.
  const bool next_valid = s.in.size() > 0;
  s.out_ready = next_pipe.in.room(now + 1);
  const std::uint64_t rest = s.timing.rest(next_valid, s.out_ready);
  if (rest == 0) {
    s.wake = now + 1;
    return;
  }
  s.setup.set(s.setup_state(s.timing.setup_held(), next_valid, s.timing.setup_busy()), now + 1);
  s.span.set(
      Interpolator::held(s.timing.span_held() || (s.timing.out_valid() && !s.out_ready), s.timing.active()),
      now + 1);
  s.sleep(now, rest == SpanInterpolatorTiming::never ? never : now + 1 + rest);
}

template <Stage stage>
const FragmentWork& SpanMachine::work_of(std::uint64_t number) {
  static constexpr FragmentWork goes_on{.kept = true}, ends{.kept = false};
  if constexpr (stage == Stage::setup) {
    return workload_.triangle_kept(number) ? goes_on : ends;
  } else if constexpr (stage == Stage::fog) {
    return goes_on;
  } else {
    return workload_.fragment(stage, number);
  }
}

template <Stage stage>
Port& SpanMachine::port() {
  constexpr auto number = stage == Stage::merge   ? Memory::Port::merge
                          : stage == Stage::depth ? Memory::Port::depth
                                                  : Memory::Port::texture;
  return bus_.ports[static_cast<std::size_t>(number)];
}

// As PipeStage::clock, with what DepthStage, TextureStage and MergeStage add.
template <Stage stage>
void SpanMachine::clock_pipe(Pipe& p, Clock now) {
  constexpr bool asks_memory = has_memory(stage);
  // The part that takes this one's records, its FIFO in `in`.
  const auto reader = [&]() -> auto& {
    if constexpr (stage == Stage::setup) {
      return walk_;
    } else {
      return *p.to;
    }
  };
  const auto writer = [&]() -> Part& {
    if constexpr (stage == Stage::setup) {
      return source_;
    } else {
      return *p.from;
    }
  };

  bool moved = false;
  bool blocked = false;
  Entry& head = p.entries[p.left & p.mask];
  bool waits = asks_memory && head.waits(now);
  Clock next = never;

  if (head.ready > now) {
    next = head.next(now);
  } else {
    bool has_room = true;
    if constexpr (stage != last_stage) has_room = !head.kept || reader().in.room(now);
    if (!has_room) {
      blocked = true;
    } else {
      if constexpr (asks_memory) {
        if (head.holds_pixel && (stage == last_stage || !head.kept)) released_[releases_++] = head.pixel;
      }
      if (head.kept) {
        ++p.meter.out;
        if constexpr (stage != last_stage) {
          if (reader().in.push()) reader().poke(now);
        }
      }
      head.due = head.ready = never;
      ++p.left;
      moved = true;
    }
  }

  const bool in_valid = p.in.size() > 0;
  const bool in_interval = now < p.next_entry;
  if (in_interval) next = std::min(next, p.next_entry);
  if (asks_memory && p.asks != 0) waits = true;
  bool accepted = false;
  if (in_valid && p.asks == 0 && p.inside() < p.capacity && !in_interval) {
    const FragmentWork& work = work_of<stage>(p.in.popped);
    if (stage == Stage::depth && work.covered && in_flight_[work.pixel] != 0) {
      waits = true;
      awaited_pixel_ = work.pixel;
    } else {
      if (p.in.full()) writer().poke(now);
      p.in.pop(now);
      ++p.meter.in;
      p.next_entry = now + p.interval;
      Entry& entry = p.entries[p.entered++ & p.mask];
      entry.due = now + p.latency;
      entry.ready = work.asks == 0 ? entry.due : never;
      entry.open = p.asks = work.asks;
      entry.pixel = work.pixel;
      entry.kept = work.kept;
      entry.holds_pixel = work.holds_pixel;
      if (stage == Stage::depth && work.holds_pixel) in_flight_[work.pixel] = 1;
      accepted = true;
    }
  }
  if constexpr (asks_memory) {
    Port& to = port<stage>();
    if (p.asks != 0 && to.level.room(now)) {
      const Request& request = p.requests[static_cast<std::size_t>(std::countr_zero(p.asks))];
      const std::uint32_t ask = p.asks & (~p.asks + 1);  // the lowest
      p.asks &= ~ask;
      Entry& newest = p.entries[(p.entered - 1) & p.mask];
      Port::Slot& slot = to.slots[to.level.pushed++ & 1];
      slot.request = &request;
      slot.ask = ask;
      slot.entry = &newest;
      bus_.look(std::max(now + 1, bus_.free));
      if (request.is_read) {
        ++bus_.report.reads;
      } else {
        ++bus_.report.writes;
        newest.open &= ~ask;
        if (newest.open == 0) newest.ready = std::max({newest.due, newest.answer, now + 1});
      }
      moved = true;
    }
  }

  p.meter.set(accepted || in_interval ? StageState::busy
              : blocked               ? StageState::blocked
              : waits                 ? StageState::memory
              : in_valid              ? StageState::busy
                                      : StageState::starved,
              now);
  if (!moved && !accepted) {
    p.sleep(now, next);
    return;
  }
  last_move_ = now + 1;
  // Where nothing can enter or be put on the next clock either, what becomes of that shows already, and a
  // look for nothing is saved.
  const Entry& then = p.head();
  const bool entry_rests = p.asks == 0 ? p.in.size() == 0 : !port<stage>().level.room(now + 1);
  if (!entry_rests || then.ready <= now + 1) {
    p.sleep(now, now + 1);
  } else if (now + 1 < p.next_entry) {
    p.meter.set(StageState::busy, now + 1);
    p.sleep(now, std::min(then.next(now + 1), p.next_entry));
  } else {
    p.meter.set(then.waits(now + 1) || p.asks != 0 ? StageState::memory : StageState::starved, now + 1);
    p.sleep(now, then.next(now + 1));
  }
}

Clock SpanMachine::next_wake() const {
  Clock next = std::min({bus_.wake, source_.wake, setup_.wake, walk_.wake, interpolator_.wake});
  for (const Pipe& p : fragment_pipes_) next = std::min(next, p.wake);
  return next;
}

bool SpanMachine::drained() const {
  return source_.to_offer == 0 && interpolator_.idle() && walk_.idle() && setup_.idle() &&
         std::ranges::all_of(fragment_pipes_, &Pipe::idle) && !bus_.waited_for();
}

void SpanMachine::give_up() const {
  std::string states;
  const auto tell = [&](const Meter& meter, std::uint64_t occupancy, std::uint64_t capacity) {
    states += state_text(meter.name, meter.state, occupancy, capacity, "");
  };
  tell(setup_.meter, setup_.in.size(), setup_.in.capacity);
  tell(walk_.meter, walk_.in.size(), walk_.in.capacity);
  tell(interpolator_.setup, interpolator_.in.size(), interpolator_.in.capacity);
  tell(interpolator_.span, 0, 0);
  for (const Pipe& p : fragment_pipes_) tell(p.meter, p.in.size(), p.in.capacity);
  nothing_moved(last_move_ + watchdog_clocks_, std::move(states));
}

void SpanMachine::clock_until_drained(std::span<const Triangle> triangles, std::int64_t first_index) {
  workload_.start(triangles, first_index);
  source_.to_offer = triangles.size();
  Clock now = cycles_;
  source_.wake = now;
  Clock tell_at = (now / progress_clocks + 1) * progress_clocks;
  while (true) {
    while (releases_ > 0) {
      const std::uint32_t pixel = released_[--releases_];
      in_flight_[pixel] = 0;
      if (pixel == awaited_pixel_) pipe<Stage::depth>().look(now);
    }
    if (bus_.wake <= now) clock_bus(now);
    clock_fragment_pipes(now);
    if (interpolator_.wake <= now) clock_interpolator(now);
    if (walk_.wake <= now) clock_walk(now);
    if (setup_.wake <= now) clock_pipe<Stage::setup>(setup_, now);
    if (source_.wake <= now) clock_source(now);

    cycles_ = now + 1;
    watch(cycles_);
    const bool done = drained();
    now = done || last_move_ == cycles_ ? cycles_ : next_wake();
    for (; tell_at <= now; tell_at += progress_clocks) {
      if (tell_at - last_move_ >= watchdog_clocks_) break;
      if (progress_) progress_(source_.offered);
    }
    if (done) break;
    watch(now);
  }
  workload_.finish();
  // Up to here the clocks have run; each stage's state stands until the next draw call.
  for (Meter* meter : {&setup_.meter, &walk_.meter, &interpolator_.setup, &interpolator_.span}) {
    meter->settle(cycles_);
  }
  for (Pipe& p : fragment_pipes_) p.meter.settle(cycles_);
}

void SpanMachine::fill(TimedReport& report) const {
  const auto add = [&](const Meter& m, const Level* fifo) {
    const auto clocks = [&](StageState state) { return m.clocks[static_cast<std::size_t>(state)]; };
    report.stages.push_back({.name = m.name,
                             .busy = clocks(StageState::busy),
                             .starved = clocks(StageState::starved),
                             .blocked = clocks(StageState::blocked),
                             .memory = clocks(StageState::memory),
                             .records_in = m.in,
                             .records_out = m.out,
                             .fifo_capacity = fifo == nullptr ? 0 : fifo->capacity,
                             .fifo_high_water = fifo == nullptr ? 0 : fifo->high_water});
  };
  add(setup_.meter, &setup_.in);
  add(walk_.meter, &walk_.in);
  add(interpolator_.setup, &interpolator_.in);
  add(interpolator_.span, nullptr);
  for (const Pipe& p : fragment_pipes_) add(p.meter, &p.in);
  report.cache_hits = workload_.texture_cache().hits();
  report.cache_misses = workload_.texture_cache().misses();
  workload_.add_reports(report);
  report.memory = bus_.report;
}

}  // namespace

std::unique_ptr<Machine> make_span_machine(const Config& config, const Scene& scene,
                                           const SystemcOptions& options) {
  return std::make_unique<SpanMachine>(config, scene, options);
}

}  // namespace bitspan::timed
