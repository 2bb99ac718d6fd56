// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/unit_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <stdexcept>

namespace bitspan {
namespace {

const StageChannel& channel_of(const StageDesign& design, const char* channel) {
  return *std::ranges::find(design.channels, channel, &StageChannel::name);
}
const std::vector<std::string>& fields_of(const StageDesign& design, const char* channel) {
  return channel_of(design, channel).fields;
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

std::uint64_t run_stream(const StageDesign& design, const UnitStream& stream) {
  constexpr std::uint64_t patience = 1000;  // clocks without a transfer
  const RtlModuleDesign ports = module_of(design);
  const ChannelPorts in = ports_of(ports, channel_of(design, "in"));
  const ChannelPorts out = ports_of(ports, channel_of(design, "out"));
  std::vector<std::uint64_t> inputs(ports.inputs.size()), outputs(ports.outputs.size());
  std::vector<std::uint64_t> expected(fields_of(design, "out").size());
  const std::span offered = std::span(inputs).subspan(in.first, fields_of(design, "in").size());
  const std::span answer = std::span(outputs).subspan(out.first, expected.size());
  RtlModule module(ports);
  inputs[out.ready] = 1;
  inputs[in.valid] = stream.offer(offered) ? 1 : 0;
  std::uint64_t done = 0, clock = 0, last = 0;
  while (done < stream.count || clock < last + patience) {
    module.clock(inputs, outputs);
    ++clock;
    if (inputs[in.valid] != 0 && outputs[in.ready] != 0) inputs[in.valid] = stream.offer(offered) ? 1 : 0;
    if (outputs[out.valid] == 0) {
      if (clock > last + patience) throw std::logic_error(fmt::format("no transfer behind {}", done));
      continue;
    }
    last = clock;
    if (done == stream.count) throw std::logic_error("a transfer after the last");
    stream.expect(expected);
    if (!std::ranges::equal(answer, expected)) {
      throw std::logic_error(fmt::format("transfer {}: {:#x}, expected {:#x}\n{}", done,
                                         fmt::join(answer, " "), fmt::join(expected, " "), design.package));
    }
    ++done;
  }
  return last;
}

}  // namespace bitspan
