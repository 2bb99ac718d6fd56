// SPDX-License-Identifier: Apache-2.0
// Holds the error of a register as a sum over quantisations. settle() applies the register's overflow.
#pragma once

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "study/bounds/format_range.hpp"
#include "study/bounds/interval.hpp"

namespace bitspan::bounds {

// A sum of errors, each with the quantisation that it comes from. The names live as long as the program.
class ErrorSum {
 public:
  void add(std::string_view source, Interval e) {
    if (e == Interval(0)) return;
    for (auto& term : terms_) {
      if (term.first == source) {
        term.second += e;
        return;
      }
    }
    terms_.emplace_back(source, e);
  }
  void add(const ErrorSum& other, Interval factor = 1) {
    for (const auto& term : other.terms_) add(term.first, term.second * factor);
  }
  void replace(std::string_view source, Interval e) { terms_.assign(1, {source, e}); }
  // Lets a value stop short of what the sum says: each term counts from 0 to all of it.
  void share() {
    for (auto& term : terms_) term.second = share_of(term.second);
  }
  Interval total() const {
    Interval sum = 0;
    for (const auto& term : terms_) sum += term.second;
    return sum;
  }
  const std::vector<std::pair<std::string_view, Interval>>& terms() const { return terms_; }

 private:
  std::vector<std::pair<std::string_view, Interval>> terms_;
};

// Applies the register's overflow to e, the error against `truth`, at the end of a quantisation. The rounding
// is in e already. `times` is the number of quantisations in a row, each towards a truth in that range.
//
// A clamp moves two values no further apart. So a saturating register keeps e where the truth is in its
// range, and elsewhere adds by how much the truth is outside. A register that wraps has an error up to its
// range. Returns false where the value may have wrapped.
inline bool settle(ErrorSum& e, const Format& f, Interval truth, int times = 1) {
  const Interval range = values(f);
  const Interval any = range - truth;
  if (!(truth + e.total()).inside(range)) {
    if (!saturates(f)) {
      e.replace("overflow", any);
      return false;
    }
    e.share();
    const Interval outside(std::min(0.0, next_down(range.hi - truth.hi)),
                           std::max(0.0, next_up(range.lo - truth.lo)));
    if (truth.hi > range.hi || truth.lo < range.lo) e.add("saturation", outside * times);
  }
  if (e.total().mag() > any.mag()) e.replace("range of the register", any);
  return true;
}

}  // namespace bitspan::bounds
