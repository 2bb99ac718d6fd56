// SPDX-License-Identifier: Apache-2.0
#include "model/timed/memory.hpp"

#include <algorithm>
#include <bit>

namespace bitspan::timed {

Memory::Memory(const MemoryTiming& timing)
    : latency_(static_cast<std::uint64_t>(timing.latency)),
      width_(static_cast<std::uint64_t>(timing.width_bytes)) {}

std::uint64_t Memory::read(Port port, std::uint64_t bytes, std::uint64_t now) {
  at(port).requests.push(now) = {beats(bytes), true};
  ++report_.reads;
  return ++at(port).tickets;
}

void Memory::write(Port port, std::uint64_t bytes, std::uint64_t now) {
  at(port).requests.push(now) = {beats(bytes), false};
  ++report_.writes;
}

bool Memory::answered(Port port, std::uint64_t ticket, std::uint64_t now) {
  PortState& p = at(port);
  while (p.answered < ticket && !p.answer_clock.empty() && p.answer_clock.front() <= now) {
    p.answer_clock.pop();
    ++p.answered;
  }
  return p.answered >= ticket;
}

void Memory::clock(std::uint64_t now) {
  if (now < bus_free_) return;
  for (PortState& p : ports_) {
    if (!p.requests.can_pop(now)) continue;
    const Request request = p.requests.front();
    p.requests.pop(now);
    // A latency of at least 1 keeps this clock's askers from seeing an answer of this clock.
    if (request.is_read) p.answer_clock.push(now + std::max<std::uint64_t>(latency_, 1) + request.beats - 1);
    bus_free_ = now + request.beats;
    report_.beats += request.beats;
    return;
  }
}

bool Memory::idle() const {
  return std::ranges::all_of(ports_, [](const PortState& p) { return p.requests.empty(); });
}

WordRegister::WordRegister(const MemoryTiming& timing, std::uint64_t access_bytes)
    : word_shift_(std::countr_zero(std::max(static_cast<std::uint64_t>(timing.width_bytes), access_bytes))) {}

}  // namespace bitspan::timed
