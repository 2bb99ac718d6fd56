// SPDX-License-Identifier: Apache-2.0
// The SystemC side of the timed model: a clock, one module per part, a waveform. SystemC stays in kernel.cpp.
//
// Each kernel has a simulation context of its own and makes it the current one only while it works, so
// kernels can follow one another or take turns in one process. One works at a time: those of other threads
// wait.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/timed/clocked.hpp"

namespace bitspan::timed {

// One SystemC module: one SC_METHOD on the clock's rising edge that steps `clocked`.
struct KernelPart {
  std::string name;
  Clocked* clocked = nullptr;
  // Traced under name, or name.key where the key is not empty.
  std::vector<std::pair<std::string, const StageSignals*>> signals;
};

class Kernel {
 public:
  // The parts must outlive the kernel. An empty `vcd` path: no waveform. Throws InputError where the waveform
  // cannot be written.
  Kernel(const std::vector<KernelPart>& parts, const std::filesystem::path& vcd);
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
  ~Kernel();  // completes the waveform, or removes it after a failed run

  // Runs whole clocks until done(), asked after each one, is true. What a part or done() throws comes out
  // here; the kernel cannot run on after that.
  void run(const std::function<bool()>& done);
  // Clocks run so far.
  std::uint64_t cycles() const;
  // Completes the waveform and gives it its name; no clocks are traced from then on. No file where no clock
  // has run. Throws InputError where that fails.
  void close_vcd();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace bitspan::timed
