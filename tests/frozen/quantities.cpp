// SPDX-License-Identifier: Apache-2.0
#include "tests/frozen/quantities.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "config/fnv.hpp"
#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "engine/engine.hpp"
#include "engine/records.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/random.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::frozen {
namespace {

// Traces are compared and dropped after this many triangles: those of a whole picture take half a gigabyte.
constexpr std::size_t batch = 256;

void append(Quantities& to, const Quantities& from) { to.insert(to.end(), from.begin(), from.end()); }

// 64 bits suffice for contents that nobody made to collide.
std::string digits(const Fnv128& digest) { return digest.hex().substr(0, 16); }

std::string digest_of_text(std::string_view text) {
  Fnv128 digest;
  digest.text(text);
  return digits(digest);
}

// A plane holds numbers of 8, 32 or 64 bits.
template <class T>
std::string digest_of_plane(const std::vector<T>& plane) {
  Fnv128 digest;
  for (const T value : plane) {
    if constexpr (std::is_same_v<T, double>) {
      digest.number(value);
    } else if constexpr (sizeof(T) == 1) {
      digest.byte(value);
    } else {
      digest.number(static_cast<std::uint64_t>(value));
    }
  }
  return digits(digest);
}

// Collects where an engine differs from `model`.
class Equality {
 public:
  explicit Equality(Computed& to) : to_(to) {}
  void expect(bool equal, const std::string& who, const std::string& what) {
    const std::string line = who + ": " + what + " differs from that of model";
    if (!equal && std::ranges::find(to_.disagreements, line) == to_.disagreements.end())
      to_.disagreements.push_back(line);
  }

 private:
  Computed& to_;
};

// Calls visit(stage, member) for each record type; `member` is a pointer to a member of Trace.
template <class Visit>
void for_each_record(const Visit& visit) {
#define BITSPAN_VISIT(Record, LIST, stage, member) visit(stage, &Trace::member);
  BITSPAN_RECORDS(BITSPAN_VISIT)
#undef BITSPAN_VISIT
}

// A change of state holds registers that are younger than the digests: those from target.format on enter one
// where they do not hold their first value, with their place. So do those that came between, behind all
// others, with their keys, which later ones do not move.
std::vector<std::int64_t> digested_values(const StateRecord& record, const Config& config) {
  const std::span<const std::int64_t> all = raw_values(record);
  const std::vector<std::int64_t> first = state_values(first_state(config));
  std::vector<std::int64_t> out{all[0]};  // the triangle
  std::vector<std::int64_t> between;
  std::int64_t place = 0;
  bool is_young = false;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const std::string_view key = state_registers()[i - 1].key;
    const bool is_first = all[i] == first[i - 1];
    if (is_later_register(key)) {
      if (!is_first) between.insert(between.end(), {static_cast<std::int64_t>(fnv64(key)), all[i]});
      continue;
    }
    ++place;
    is_young = is_young || key == "target.format";
    if (!is_young) out.push_back(all[i]);
    if (is_young && !is_first) out.insert(out.end(), {place, all[i]});
  }
  out.insert(out.end(), between.begin(), between.end());
  return out;
}
template <class Record>
std::span<const std::int64_t> digested_values(const Record& record, const Config& /*config*/) {
  return raw_values(record);
}

// Counts the records of each type, and digests their values.
class RecordDigests {
 public:
  void add(const Trace& trace, const Config& config) {
    for_each_record([&](const char* stage, auto member) {
      Entry& entry = entries_[stage];
      for (const auto& record : trace.*member) {
        for (const std::int64_t value : digested_values(record, config))
          entry.digest.number(static_cast<std::uint64_t>(value));
      }
      entry.count += (trace.*member).size();
    });
  }
  // Types that the mode does not have are left out.
  Quantities quantities() const {
    Quantities out;
    for_each_record([&](const char* stage, auto) {
      const Entry& entry = entries_.at(stage);
      if (entry.count > 0) {
        out.emplace_back(std::string("record ") + stage,
                         std::to_string(entry.count) + " of " + digits(entry.digest));
      }
    });
    return out;
  }

 private:
  struct Entry {
    std::size_t count = 0;
    Fnv128 digest;
  };
  std::map<std::string, Entry> entries_;
};

void expect_equal_traces(Equality& equality, const char* who, const Trace& got, const Trace& expected) {
  for_each_record([&](const char* stage, auto member) {
    equality.expect(got.*member == expected.*member, who, std::string("record ") + stage);
  });
}

Quantities plane_quantities(const Frame& frame, const std::string& prefix) {
  return {{prefix + " color", digest_of_plane(frame.color)},
          {prefix + " depth", digest_of_plane(frame.depth)},
          {prefix + " u", digest_of_plane(frame.u)},
          {prefix + " v", digest_of_plane(frame.v)},
          {prefix + " triangle", digest_of_plane(frame.triangle)}};
}

void expect_equal_frames(Equality& equality, const char* who, const Frame& got, const Frame& expected) {
  equality.expect(got.width == expected.width && got.height == expected.height, who, "the frame's size");
  equality.expect(got.color == expected.color, who, "plane color");
  equality.expect(got.depth == expected.depth, who, "plane depth");
  equality.expect(same_bits(got.u, expected.u), who, "plane u");
  equality.expect(same_bits(got.v, expected.v), who, "plane v");
  equality.expect(got.triangle == expected.triangle, who, "plane triangle");
}

void expect_equal_counters(Equality& equality, const char* who, const Counters& got,
                           const Counters& expected) {
  const Quantities of_got = counter_quantities(got);
  const Quantities of_expected = counter_quantities(expected);
  for (std::size_t i = 0; i < of_got.size(); ++i)
    equality.expect(of_got[i] == of_expected[i], who, of_got[i].first);
}

// Both engines have drawn the same.
void expect_equal_results(Equality& equality, const char* who, const Engine& got, const Engine& expected) {
  expect_equal_frames(equality, who, got.frame(), expected.frame());
  expect_equal_counters(equality, who, got.counters(), expected.counters());
}

// Takes the registers in the order of their names: all that every file gives, and the others where they saw a
// value.
std::string digest_of_statistics(const model::Statistics& statistics) {
  std::map<std::string, const model::FieldStatistics*> by_name;
  for (int i = 0; i < model::register_count; ++i) {
    const auto id = static_cast<model::RegisterId>(i);
    const bool by_default = i < format_count && !std::holds_alternative<std::monostate>(
                                                    format_defaults[static_cast<std::size_t>(i)]);
    if (by_default && statistics.of(id).count == 0) continue;
    by_name.emplace(model::name_of(id), &statistics.of(id));
  }
  Fnv128 digest;
  for (const auto& [name, s] : by_name) {
    digest.text(name);
    digest.number(s->count);
    digest.number(s->wraps);
    digest.number(s->saturations);
    digest.number(static_cast<std::uint64_t>(s->min));
    digest.number(static_cast<std::uint64_t>(s->max));
    digest.number(static_cast<std::uint64_t>(s->bias));
  }
  return digits(digest);
}

void draw_whole(Engine& engine, const Scene& scene) {
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), nullptr);
}

// Draws with `model` and `golden` side by side.
RecordDigests records_of(Equality& equality, Engine& model, Engine& golden, const Config& config,
                         const Scene& scene) {
  RecordDigests out;
  model.begin(scene);
  golden.begin(scene);
  const std::span<const Triangle> all = scene.triangles;
  Trace of_model;
  Trace of_golden;
  for (std::size_t i = 0; i < all.size(); i += batch) {
    const std::size_t part = std::min(batch, all.size() - i);
    of_model.clear();
    of_golden.clear();
    draw_scene(model, scene, i, part, &of_model);
    draw_scene(golden, scene, i, part, &of_golden);
    expect_equal_traces(equality, "golden", of_golden, of_model);
    out.add(of_model, config);
  }
  return out;
}

std::string numbers(std::initializer_list<std::pair<const char*, std::uint64_t>> list) {
  std::string out;
  for (const auto& [name, value] : list)
    out.append((out.empty() ? "" : " ") + std::string(name) + " " + std::to_string(value));
  return out;
}

Quantities report_quantities(const TimedReport& report) {
  Quantities out{{"clocks", std::to_string(report.cycles)}};
  for (const StageReport& s : report.stages) {
    out.emplace_back("clocks of " + s.name, numbers({{"busy", s.busy},
                                                     {"starved", s.starved},
                                                     {"blocked", s.blocked},
                                                     {"memory", s.memory},
                                                     {"in", s.records_in},
                                                     {"out", s.records_out},
                                                     {"fifo", s.fifo_capacity},
                                                     {"high", s.fifo_high_water}}));
  }
  out.emplace_back("cache", numbers({{"hits", report.cache_hits}, {"misses", report.cache_misses}}));
  for (const CacheReport& c : report.caches) {
    std::string counters = numbers({{"reads", c.reads}, {"writes", c.writes}});
    for (std::size_t i = 0; i < c.results.size(); ++i) {
      counters += " " + std::string(enum_names<CacheResult>[i]) + " " + std::to_string(c.results[i]);
    }
    out.emplace_back("cache " + std::string(c.name),
                     counters + " " + numbers({{"written_back", c.written_back}, {"flushed", c.flushed}}));
  }
  out.emplace_back("memory", numbers({{"reads", report.memory.reads},
                                      {"writes", report.memory.writes},
                                      {"beats", report.memory.beats}}));
  out.emplace_back("interpolator",
                   numbers({{"exact", report.interpolator_exact ? 1U : 0U},
                            {"span_setup", static_cast<std::uint64_t>(report.span_setup_latency)},
                            {"span", static_cast<std::uint64_t>(report.span_latency)}}));
  return out;
}

std::string digest_of_handshake(const std::vector<HandshakeClock>& handshake) {
  Fnv128 digest;
  for (const HandshakeClock& h : handshake) {
    digest.byte(static_cast<std::uint8_t>((h.in_valid ? 1 : 0) | (h.out_ready ? 2 : 0) |
                                          (h.in_ready ? 4 : 0) | (h.out_valid ? 8 : 0)));
  }
  return digits(digest);
}

// The lines of the package that the RTL is built from, without those that are comments: they number the
// enumerators that there are.
std::vector<std::string> package_lines(const Config& config) {
  std::istringstream package(emit_sv(config));
  std::vector<std::string> lines;
  for (std::string line; std::getline(package, line);) {
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos || line.compare(start, 2, "//") != 0) lines.push_back(line);
  }
  return lines;
}

// Of depth16 the whole package, and of others what differs from it: a new parameter that is the same in all
// changes the lines of depth16 alone.
std::string package_text(const Config& config) {
  static const std::vector<std::string> known = package_lines(shipped_config("depth16"));
  std::string text;
  for (const std::string& line : package_lines(config)) {
    if (config.name == "depth16" || std::ranges::find(known, line) == known.end()) text += line + "\n";
  }
  return text;
}

}  // namespace

Quantities counter_quantities(const Counters& counters) {
  Quantities out;
  for_each_counter([&](const CounterInfo& info, auto member) {
    if (info.compared)
      out.emplace_back("counter " + std::string(info.name), std::to_string(counters.*member));
  });
  return out;
}

Computed config_quantities(const Config& config) {
  Quantities out{{"hash", config_hash(config)}, {"text", digest_of_text(to_toml(config))}};
  if (has_rtl(config)) out.emplace_back("package", digest_of_text(package_text(config)));
  return {{{"configuration", out}}, {}};
}

Computed scene_quantities(const Scene& scene) {
  Fnv128 triangles;
  for (const Triangle& t : scene.triangles) {
    for (const Vertex& v : t.v) {
      for (const double value : {v.x, v.y, v.s, v.u, v.v}) triangles.number(value);
      for (const double value : v.c) triangles.number(value);
    }
    triangles.number(t.texture);
  }
  Fnv128 textures;
  for (const Texture& t : scene.textures) {
    textures.number(t.width);
    textures.number(t.height);
    for (const std::uint8_t value : t.rgba) textures.byte(value);
  }
  Fnv128 frame;
  for (const int value : {scene.width, scene.height}) frame.number(value);
  for (const double value : {scene.s_min, scene.s_max, scene.focal}) frame.number(value);
  for (const std::uint8_t value : scene.background) frame.byte(value);
  if (scene.fog) {
    for (const std::uint8_t value : scene.fog->color) frame.byte(value);
    frame.number(scene.fog->distance);
  }
  return {{{"scene",
            {{"triangles", std::to_string(scene.triangles.size()) + " of " + digits(triangles)},
             {"textures", digits(textures)},
             {"frame", digits(frame)}}}},
          {}};
}

Computed value_quantities(const Config& config, const Scene& scene) {
  Computed out;
  Equality equality(out);
  const auto model = make_model(config);
  const auto golden = make_golden(config);
  const Quantities records = records_of(equality, *model, *golden, config, scene).quantities();
  Quantities pictures = plane_quantities(model->frame(), "plane");
  Quantities counters = counter_quantities(model->counters());
  expect_equal_results(equality, "golden", *golden, *model);

  const auto bare = make_model(config);
  draw_whole(*bare, scene);
  expect_equal_results(equality, "model without a trace", *bare, *model);

  const auto observed = make_observed_model(config);
  draw_whole(*observed, scene);
  expect_equal_results(equality, "model with observers", *observed, *model);
  counters.emplace_back("statistics", digest_of_statistics(observed->statistics()));

  const auto ideal = make_ideal(config);
  draw_whole(*ideal, scene);
  append(pictures, plane_quantities(ideal->frame(), "ideal"));
  out.groups = {{"records", records}, {"pictures", pictures}, {"counters", counters}};
  return out;
}

Computed clock_quantities(const Config& config, const Scene& scene, ClockedBy by) {
  Computed out;
  Equality equality(out);
  const auto model = make_model(config);
  draw_whole(*model, scene);
  const bool has_caches =
      has_cache(config.memory.depth_cache.mode) || has_cache(config.memory.color_cache.mode);
  const auto span = make_systemc(config, {.mode = TimedMode::span, .measure_texture_cache = has_caches});
  draw_whole(*span, scene);
  Quantities clocks = report_quantities(span->report());
  expect_equal_results(equality, "systemc in mode span", *span, *model);
  if (by == ClockedBy::both) {
    const auto cycle = make_systemc(
        config, {.mode = TimedMode::cycle, .measure_texture_cache = has_caches, .record_handshake = true});
    draw_whole(*cycle, scene);
    expect_equal_results(equality, "systemc in mode cycle", *cycle, *model);
    const Quantities of_cycle = report_quantities(cycle->report());
    for (std::size_t i = 0; i < of_cycle.size(); ++i) {
      if (of_cycle[i] == clocks[i]) continue;
      out.disagreements.push_back("systemc: " + of_cycle[i].first + ": mode cycle has " + of_cycle[i].second +
                                  ", mode span " + clocks[i].second);
    }
    clocks.emplace_back("handshake", digest_of_handshake(cycle->handshake()));
  }
  out.groups = {{"clocks", clocks}};
  return out;
}

}  // namespace bitspan::frozen
