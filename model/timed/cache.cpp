// SPDX-License-Identifier: Apache-2.0
#include "model/timed/cache.hpp"

#include <algorithm>
#include <bit>
#include <span>

#include "config/modes.hpp"

namespace bitspan::timed {

Cache::Cache(const CacheShape& shape, bool keeps_writes)
    : line_bytes_(static_cast<std::uint64_t>(shape.line_bytes)),
      sets_(static_cast<std::uint64_t>(shape.sets)),
      ways_(static_cast<std::uint64_t>(shape.ways)),
      line_shift_(std::has_single_bit(line_bytes_) ? std::countr_zero(line_bytes_) : -1),
      folds_upper_bits_(folds_upper_bits(shape.hash)),
      keeps_writes_(keeps_writes),
      slots_(sets_ * ways_) {}

void Cache::measure(std::string_view name, const CacheWatch& watch) {
  measured_ = std::make_unique<Measured>(Measured{{}, watch, MissKinds(slots_.size())});
  measured_->report.name = name;
}

Cache::LookUp Cache::look_up(std::uint64_t address, std::uint64_t line, bool is_write) {
  const std::uint64_t upper = folds_upper_bits_ ? line / sets_ : 0;
  const std::span<Way> set = std::span(slots_).subspan((line ^ upper) % sets_ * ways_, ways_);
  ++time_;
  LookUp out;
  Way* victim = &set.front();
  for (Way& way : set) {
    if (way.used != 0 && way.line == line) {
      way.used = time_;
      way.dirty = way.dirty || (is_write && keeps_writes_);
      out.hit = true;
      break;
    }
    if (way.used < victim->used) victim = &way;
  }
  ++(out.hit ? hits_ : misses_);
  if (!out.hit && (!is_write || keeps_writes_)) {
    out.fetches = true;
    out.writes_back = victim->used != 0 && victim->dirty;
    *victim = {line, time_, is_write};
  }
  if (measured_ == nullptr) {
    if (out.hit || out.fetches) last_ = line;
    return out;
  }
  CacheReport& report = measured_->report;
  const CacheResult result = measured_->kinds.see(line, out.hit, !is_write || keeps_writes_);
  ++(is_write ? report.writes : report.reads);
  ++report.results[static_cast<std::size_t>(result)];
  report.written_back += out.writes_back ? 1 : 0;
  if (measured_->watch) {
    measured_->watch({.cache = report.name,
                      .kind = is_write ? CacheAccessKind::write : CacheAccessKind::read,
                      .address = address,
                      .result = result,
                      .writes_back = out.writes_back});
  }
  return out;
}

std::uint64_t Cache::dirty_lines() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(slots_, &Way::dirty));
}

void Cache::flush() {
  if (measured_ != nullptr) {
    measured_->report.flushed += dirty_lines();
    measured_->kinds = MissKinds(slots_.size());
    if (measured_->watch) {
      measured_->watch({.cache = measured_->report.name, .kind = CacheAccessKind::flush});
    }
  }
  std::ranges::fill(slots_, Way{});
  last_ = no_line;
}

std::optional<CacheReport> Cache::report() const {
  if (measured_ == nullptr) return std::nullopt;
  CacheReport out = measured_->report;
  out.flushed += dirty_lines();
  return out;
}

}  // namespace bitspan::timed
