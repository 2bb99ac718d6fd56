// SPDX-License-Identifier: Apache-2.0
// Memories behind the ports of the pixel stages, one per port: when a port is ready, when an answer is there.
// Nothing is stored. Each port answers in the order of its requests.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "model/timed/pixel_chain_timing.hpp"
#include "model/timed/ring.hpp"

namespace bitspan {

struct PortTiming {
  // Clocks from a request to its answer, drawn per request; 1 is the clock after.
  int least = 1, most = 1;
  double stall = 0;  // probability per port and clock that it takes no request or no write; below 1
  std::uint64_t seed = 1;

  bool is_ideal() const { return most == 1 && stall == 0; }
};
// Throws InputError where the latencies are not in 1..10000 in their order, or the stall is not in 0..0.99.
void check_ports(const PortTiming& ports);

struct PortReport {
  std::uint64_t requests = 0, writes = 0;  // transferred
  std::uint64_t stalled = 0;               // clocks on which one of them waited for the port
};

namespace timed {

class MemoryPorts {
 public:
  // The first `ports` of all ports are there.
  explicit MemoryPorts(const PortTiming& timing, int ports = read_ports);

  // What the memories drive on clock `now`; once per clock.
  void drive(std::uint64_t now, PixelChainDrive& drive);
  // What became of it.
  void see(std::uint64_t now, const PixelChainDrive& drive, const PixelChainPorts& ports);
  std::span<const PortReport> reports() const { return std::span(reports_).first(due_.size()); }

 private:
  PortSet ready(int ports);

  PortTiming timing_;
  std::uint64_t stall_;  // of 2^32
  std::mt19937_64 random_;
  std::vector<Ring<std::uint64_t>> due_;  // by port: of the requests that wait for their answer
  std::array<PortReport, read_ports> reports_{};
};

}  // namespace timed
}  // namespace bitspan
