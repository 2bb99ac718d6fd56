// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/stage_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace bitspan {

StageBench::StageBench(const StageDesign& design, std::uint64_t seed) : random_(seed) {
  const RtlModuleDesign m = module_of(design);
  inputs_.resize(m.inputs.size());
  outputs_.resize(m.outputs.size());
  for (const StageChannel& c : design.channels) {
    Channel made;
    made.shape = c;
    made.ports = ports_of(m, c);
    channels_.push_back(std::move(made));
  }
  for (const std::string& name : design.constants) constants_[name] = port_place(m.inputs, name + "_i");
  for (const std::string& name : design.levels) levels_[name] = port_place(m.outputs, name + "_o");
  module_ = std::make_unique<RtlModule>(m);
}

StageBench::Channel& StageBench::channel(const std::string& name) {
  return const_cast<Channel&>(std::as_const(*this).channel(name));
}
const StageBench::Channel& StageBench::channel(const std::string& name) const {
  const auto found = std::ranges::find_if(channels_, [&](const Channel& c) { return c.shape.name == name; });
  if (found == channels_.end()) throw std::logic_error("no channel " + name);
  return *found;
}

void StageBench::set_stalls(const std::string& name, const StageStalls& stalls) {
  own_stalls_[name] = stalls;
  channel(name).stalls = &own_stalls_[name];
}

void StageBench::set_constant(const std::string& name, std::uint64_t value) {
  inputs_.at(constants_.at(name)) = value;
}

void StageBench::send(const std::string& name, StageValues values, std::uint64_t clocks) {
  Channel& c = channel(name);
  if (values.size() != c.shape.fields.size()) throw std::logic_error(name + ": other fields are sent");
  c.queue.push_back({std::move(values), clocks_ + clocks});
}

std::size_t StageBench::waiting(const std::string& name) const { return channel(name).queue.size(); }

void StageBench::on_transfer(const std::string& name, std::function<void(const StageValues&)> call) {
  channel(name).call = std::move(call);
}

bool StageBench::chance(double probability) {
  return static_cast<double>(random_() >> 11) * 0x1p-53 < probability;
}

bool StageBench::clock() {
  for (Channel& c : channels_) {
    const StageStalls& stalls = c.stalls == nullptr ? stalls_ : *c.stalls;
    if (c.shape.kind == ChannelKind::in) {
      if (!c.offered) c.offered = !c.queue.empty() && c.queue.front().from <= clocks_ && !chance(stalls.gap);
      inputs_[c.ports.valid] = c.offered ? 1 : 0;
      // What is on the ports beside an offer must not matter.
      for (std::size_t i = 0; i < c.shape.fields.size(); ++i) {
        inputs_[c.ports.first + i] = c.offered ? c.queue.front().values[i] : inputs_[c.ports.first + i];
      }
    } else if (c.shape.kind == ChannelKind::out) {
      inputs_[c.ports.ready] = chance(stalls.stall) ? 0 : 1;
    }
  }
  module_->clock(inputs_, outputs_);
  if (trace_ != nullptr) {
    trace_->inputs.push_back(inputs_);
    trace_->outputs.push_back(outputs_);
  }
  ++clocks_;

  bool moved = false;
  std::vector<std::pair<Channel*, StageValues>> calls;
  for (Channel& c : channels_) {
    if (c.shape.kind == ChannelKind::in) {
      if (!c.offered || outputs_[c.ports.ready] == 0) continue;
      c.queue.pop_front();
      c.offered = false;
    } else {
      const bool valid = outputs_[c.ports.valid] != 0;
      const auto from = outputs_.begin() + static_cast<std::ptrdiff_t>(c.ports.first);
      StageValues values(from, from + static_cast<std::ptrdiff_t>(c.shape.fields.size()));
      if (c.held && (!valid || values != c.values)) {
        throw std::logic_error(fmt::format("{}: a waiting transfer was changed or withdrawn", c.shape.name));
      }
      const bool taken = valid && (c.shape.kind == ChannelKind::tap || inputs_[c.ports.ready] != 0);
      c.held = valid && !taken;
      c.values = values;
      if (!taken) continue;
      if (c.call) calls.emplace_back(&c, std::move(values));
    }
    ++c.transfers;
    moved = true;
  }
  for (const auto& [c, values] : calls) c->call(values);
  return moved;
}

void StageBench::run_until(const std::function<bool()>& done, int drain) {
  constexpr int patience = 10000;
  int idle = 0;
  while (!done()) {
    idle = clock() ? 0 : idle + 1;
    if (idle > patience) {
      std::string state;
      for (const Channel& c : channels_) {
        state += fmt::format(" {} {}+{}", c.shape.name, c.transfers, c.queue.size());
      }
      throw std::logic_error(fmt::format("nothing moves at clock {}:{}", clocks_, state));
    }
  }
  const StageStalls before = std::exchange(stalls_, {});
  const auto own = own_stalls_;
  for (auto& [name, stalls] : own_stalls_) stalls = {};
  for (int i = 0; i < drain; ++i) clock();
  for (const auto& [name, stalls] : own) own_stalls_[name] = stalls;
  stalls_ = before;
}

void StageBench::reset() {
  for (Channel& c : channels_) {
    c.queue.clear();
    c.offered = false;
    c.held = false;
  }
  const std::vector<std::uint64_t> inputs = inputs_;
  module_->reset();
  if (trace_ != nullptr) trace_->resets.push_back(trace_->inputs.size());
  inputs_ = inputs;
}

std::uint64_t StageBench::transfers(const std::string& name) const { return channel(name).transfers; }

StageMemory::StageMemory(StageBench& bench, const std::string& request, const std::string& answer,
                         const std::string& write, std::size_t address_fields, Latency latency,
                         std::uint64_t seed, std::function<StageValues(const Address&)> initial)
    : initial_(std::move(initial)), random_(seed) {
  bench.on_transfer(request, [this, &bench, answer, address_fields, latency](const StageValues& v) {
    const Address address(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(address_fields));
    const auto spread = static_cast<std::uint64_t>(latency.most - latency.least + 1);
    in_flight_.push_back(address);
    bench.send(answer, at(address), static_cast<std::uint64_t>(latency.least) - 1 + random_() % spread);
    most_in_flight_ = std::max(most_in_flight_, bench.waiting(answer));
  });
  if (write.empty()) return;
  bench.on_transfer(write, [this, &bench, answer, address_fields](const StageValues& v) {
    const auto split = v.begin() + static_cast<std::ptrdiff_t>(address_fields);
    const Address address(v.begin(), split);
    while (in_flight_.size() > bench.waiting(answer)) in_flight_.pop_front();
    if (std::ranges::find(in_flight_, address) != in_flight_.end()) {
      throw std::logic_error(answer + ": an address is written while it is read");
    }
    StageValues written(split, v.end());
    written_[address] = merge_ ? merge_(at(address), written) : written;
    if (on_write_) on_write_(v);
  });
}

StageValues StageMemory::at(const Address& address) const {
  const auto found = written_.find(address);
  return found == written_.end() ? initial_(address) : found->second;
}

}  // namespace bitspan
