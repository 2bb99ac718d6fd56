// SPDX-License-Identifier: Apache-2.0
// A pixel stage in RTL under test: its channels with random gaps and stalls, and memories with random latency
// behind its ports.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tb/rtl_channels.hpp"

namespace bitspan {

// The ports on each clock of a bench, as it drove and sampled them.
struct StageTrace {
  std::vector<std::vector<std::uint64_t>> inputs, outputs;
  std::vector<std::size_t> resets;  // clocks in front of which the module was reset
};

// Probabilities per clock: that nothing is offered on a channel in, that a channel out is not ready.
struct StageStalls {
  double gap = 0;
  double stall = 0;
};

class StageBench {
 public:
  // The same seed gives the same gaps and stalls.
  StageBench(const StageDesign& design, std::uint64_t seed);

  void set_stalls(const StageStalls& stalls) { stalls_ = stalls; }
  // Stalls of one channel alone, whatever the others have.
  void set_stalls(const std::string& channel, const StageStalls& stalls);
  void set_constant(const std::string& name, std::uint64_t value);

  // Puts values behind those that wait in front of a channel in; they are not offered for `clocks` more
  // clocks.
  void send(const std::string& channel, StageValues values, std::uint64_t clocks = 0);
  // Values that still wait in front of a channel in.
  std::size_t waiting(const std::string& channel) const;
  // Called on each transfer of a channel out or of a tap, after the clock's edge. It may send.
  void on_transfer(const std::string& channel, std::function<void(const StageValues&)> call);

  // Runs one clock. Returns whether anything was transferred on it. Throws std::logic_error where an
  // assertion in the RTL fails, and where the module changes or withdraws values that wait on a channel out.
  bool clock();
  // Runs until `done`, then for `drain` more clocks without gaps and stalls. Throws std::logic_error where
  // nothing moves for 10,000 clocks.
  void run_until(const std::function<bool()>& done, int drain = 400);
  // Values in front of channels in are forgotten.
  void reset();
  // Keeps the ports of each clock from now on.
  void keep_trace(StageTrace& trace) { trace_ = &trace; }

  // A level as the last clock found it.
  std::uint64_t level(const std::string& name) const { return outputs_.at(levels_.at(name)); }
  std::uint64_t clocks() const { return clocks_; }
  // Transfers on a channel so far.
  std::uint64_t transfers(const std::string& channel) const;

 private:
  struct Waiting {
    StageValues values;
    std::uint64_t from = 0;  // the first clock that may offer it
  };
  struct Channel {
    StageChannel shape;
    ChannelPorts ports;
    const StageStalls* stalls = nullptr;  // of its own
    std::deque<Waiting> queue;            // in front of a channel in
    bool offered = false;                 // once offered, values stay
    bool held = false;                    // values waited on a channel out on the clock before
    StageValues values;                   // these
    std::uint64_t transfers = 0;
    std::function<void(const StageValues&)> call;
  };
  bool chance(double probability);
  Channel& channel(const std::string& name);
  const Channel& channel(const std::string& name) const;

  std::map<std::string, StageStalls> own_stalls_;
  StageStalls stalls_;
  std::mt19937_64 random_;
  std::vector<Channel> channels_;
  std::map<std::string, std::size_t> constants_;  // places among the inputs
  std::map<std::string, std::size_t> levels_;     // places among the outputs
  std::vector<std::uint64_t> inputs_, outputs_;
  std::uint64_t clocks_ = 0;
  StageTrace* trace_ = nullptr;
  std::unique_ptr<RtlModule> module_;
};

// A memory behind a stage's ports: requests on a channel out whose first fields are the address, answers in
// order on a channel in, `least` to `most` clocks later at the earliest; writes on a channel out, address
// fields first.
class StageMemory {
 public:
  using Address = std::vector<std::uint64_t>;
  struct Latency {
    int least = 1, most = 1;
  };
  // `write` may be empty: a memory that is only read. `initial` gives what an address holds at first.
  StageMemory(StageBench& bench, const std::string& request, const std::string& answer,
              const std::string& write, std::size_t address_fields, Latency latency, std::uint64_t seed,
              std::function<StageValues(const Address&)> initial);
  StageMemory(const StageMemory&) = delete;
  StageMemory& operator=(const StageMemory&) = delete;

  // What an address holds behind a write, of what it held and what was written; without it, what was written.
  void merge_writes(std::function<StageValues(const StageValues& held, const StageValues& written)> merge) {
    merge_ = std::move(merge);
  }
  // Called on each write, once the memory holds it.
  void on_write(std::function<void(const StageValues&)> call) { on_write_ = std::move(call); }
  // As at first: after a reset of the bench.
  void forget() {
    written_.clear();
    in_flight_.clear();
  }
  StageValues at(const Address& address) const;
  const std::map<Address, StageValues>& written() const { return written_; }
  // The most requests that were in flight at once.
  std::size_t most_in_flight() const { return most_in_flight_; }

 private:
  std::function<StageValues(const Address&)> initial_;
  std::function<StageValues(const StageValues&, const StageValues&)> merge_;
  std::function<void(const StageValues&)> on_write_;
  std::map<Address, StageValues> written_;
  std::deque<Address> in_flight_;  // and some that were answered since
  std::mt19937_64 random_;
  std::size_t most_in_flight_ = 0;
};

}  // namespace bitspan
