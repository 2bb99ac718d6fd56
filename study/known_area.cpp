// SPDX-License-Identifier: Apache-2.0
#include "study/known_area.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cstdint>
#include <string>

namespace bitspan {
namespace {

Row row_of(const std::string& hash, const std::string& key, AreaTarget target, bool placed,
           const AreaResult& a) {
  return {hash,
          key,
          std::string(to_string(target.family)),
          std::int64_t{placed ? 1 : 0},
          std::string(to_string(a.status)),
          a.message,
          a.tools,
          a.counts.luts,
          a.counts.ffs,
          a.counts.multipliers,
          a.counts.memory_bits,
          a.fmax_mhz,
          a.seconds};
}

}  // namespace

AreaResult known_area(const Config& config, AreaTarget target, bool place, Store& store,
                      const std::stop_token& stop) {
  const std::string hash = config_hash(config);
  const std::string key = area_key(config, target.part);
  const std::string name(to_string(target.family));
  const std::string table = fmt::format("{}areas", prefix_of(target.part));  // parts have tables of their own
  const auto found = store.rows(
      "SELECT status, message, tools, luts, ffs, multipliers, memory_bits, fmax_mhz, seconds FROM " + table +
          " WHERE area_key = ? AND family = ? AND placed >= ? AND status <> 'failed' ORDER BY placed LIMIT 1",
      {key, name, std::int64_t{place ? 1 : 0}});
  AreaResult out;
  if (!found.empty()) {
    const Row& r = found[0];
    for (const AreaStatus s : {AreaStatus::ok, AreaStatus::does_not_fit}) {
      if (text_of(r[0]) == to_string(s)) out.status = s;
    }
    out.message = text_of(r[1]);
    out.tools = text_of(r[2]);
    out.counts = {integer_of(r[3]), integer_of(r[4]), integer_of(r[5]), integer_of(r[6])};
    out.fmax_mhz = number_of(r[7]);
    out.seconds = number_of(r[8]);
  } else {
    std::atomic<bool> cancelled = stop.stop_requested();
    const std::stop_callback cancel(stop, [&] { cancelled = true; });
    AreaLimits limits;
    limits.cancelled = &cancelled;
    try {
      out = measure_area(config, target, place, limits);
    } catch (const MissingPlacer& missing) {
      // The counts stand. A failure is not taken for known, so the next run tries for the clock again.
      out = known_area(config, target, false, store, stop);
      if (out.status != AreaStatus::failed) out.message = missing.what();
      out.status = AreaStatus::failed;
    }
  }
  store.run("INSERT OR REPLACE INTO " + table +
                "(config_hash, area_key, family, placed, status, message, tools, luts, ffs, multipliers, "
                "memory_bits, fmax_mhz, seconds) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            row_of(hash, key, target, place, out));
  return out;
}

}  // namespace bitspan
