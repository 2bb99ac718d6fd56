// SPDX-License-Identifier: Apache-2.0
#include "model/timed/memory_ports.hpp"

#include <cmath>
#include <string>

namespace bitspan {

void check_ports(const PortTiming& ports) {
  if (ports.least < 1 || ports.least > ports.most || ports.most > 10000) {
    throw InputError("port latency " + std::to_string(ports.least) + ":" + std::to_string(ports.most) +
                     ": expected MIN or MIN:MAX with 1 <= MIN <= MAX <= 10000 clocks");
  }
  if (!(ports.stall >= 0 && ports.stall <= 0.99)) {
    throw InputError("port stall: expected a probability from 0 to 0.99");
  }
}

namespace timed {

MemoryPorts::MemoryPorts(const PortTiming& timing, int ports)
    : timing_(timing),
      stall_(static_cast<std::uint64_t>(std::ldexp(timing.stall, 32))),
      random_(timing.seed),
      due_(static_cast<std::size_t>(ports)) {
  check_ports(timing);
}

PortSet MemoryPorts::ready(int ports) {
  const PortSet all = static_cast<PortSet>((1U << ports) - 1);
  if (stall_ == 0) return all;
  PortSet set = 0;
  for (int p = 0; p < ports; ++p) {
    set = static_cast<PortSet>(set | ((random_() >> 32) >= stall_ ? 1U << p : 0U));
  }
  return set;
}

void MemoryPorts::drive(std::uint64_t now, PixelChainDrive& drive) {
  drive.request_ready = ready(static_cast<int>(due_.size()));
  drive.write_ready = ready(write_ports);
  drive.answer_valid = 0;
  for (std::size_t p = 0; p < due_.size(); ++p) {
    if (!due_[p].empty() && due_[p].front() <= now) {
      drive.answer_valid = static_cast<PortSet>(drive.answer_valid | 1U << p);
    }
  }
}

void MemoryPorts::see(std::uint64_t now, const PixelChainDrive& drive, const PixelChainPorts& ports) {
  const auto least = static_cast<std::uint64_t>(timing_.least);
  const auto spread = static_cast<std::uint64_t>(timing_.most) - least + 1;
  const unsigned waits =
      (ports.request_valid & ~drive.request_ready) | (ports.write_valid & ~drive.write_ready);
  for (std::size_t p = 0; p < due_.size(); ++p) {
    const unsigned bit = 1U << p;
    if ((drive.answer_valid & ports.answer_ready & bit) != 0) due_[p].pop();
    if ((drive.request_ready & ports.request_valid & bit) != 0) {
      const std::uint64_t more = spread == 1 ? 0 : random_() % spread;
      due_[p].push(now + least + more);
      ++reports_[p].requests;
    }
    if ((drive.write_ready & ports.write_valid & bit) != 0) ++reports_[p].writes;
    if ((waits & bit) != 0) ++reports_[p].stalled;
  }
}

}  // namespace timed
}  // namespace bitspan
