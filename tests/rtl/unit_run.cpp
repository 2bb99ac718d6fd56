// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/unit_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <stdexcept>

namespace bitspan {
namespace {

const std::vector<std::string>& fields_of(const StageDesign& design, const char* channel) {
  return std::ranges::find(design.channels, channel, &StageChannel::name)->fields;
}

}  // namespace

UnitRun run_unit(StageBench& bench, const StageDesign& design, std::size_t count,
                 const std::function<Exchange(std::uint64_t)>& make, const std::string& about) {
  const std::vector<std::string>& inputs = fields_of(design, "in");
  const std::vector<std::string>& outputs = fields_of(design, "out");
  UnitRun r;
  std::deque<Exchange> given;  // on their way
  std::size_t next = 0;
  r.offered = bench.clocks();
  bench.on_transfer("out", [&](const StageValues& v) {
    if (given.empty()) throw std::logic_error("a fragment after the last");
    const Exchange g = given.front();
    given.pop_front();
    for (std::size_t k = 0; k < v.size(); ++k) {
      if (v[k] == g.out[k]) continue;
      std::string text;
      for (std::size_t m = 0; m < inputs.size(); ++m) text += fmt::format(" {} {:#x}", inputs[m], g.in[m]);
      throw std::logic_error(fmt::format("fragment {}: {} is {:#x}, expected {:#x};{}\n{}", r.fragments,
                                         outputs[k], v[k], g.out[k], text, about));
    }
    if (r.fragments == 0) r.first_out = bench.clocks() - 1;
    r.last_out = bench.clocks() - 1;
    ++r.fragments;
  });
  bench.run_until([&] {
    while (next < count && bench.waiting("in") < 4) {
      given.push_back(make(next++));
      bench.send("in", given.back().in);
    }
    return r.fragments == count;
  });
  return r;
}

}  // namespace bitspan
