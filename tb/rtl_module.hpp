// SPDX-License-Identifier: Apache-2.0
// Any Verilated module, by the names of its ports; each port has at most 64 bits. The library comes from the
// cache of tb/rtl_build.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tb/rtl_build.hpp"

namespace bitspan {

struct RtlModuleDesign {
  std::string name;     // of the configuration, for the line of progress
  std::string top;      // the module; it has the ports clk_i and rst_ni besides those below
  std::string package;  // text in front of the sources
  std::vector<std::filesystem::path> sources;
  std::vector<std::string> inputs, outputs;  // the ports' names
  std::vector<std::string> words{};          // of a user's design: RtlDesign
  std::vector<std::filesystem::path> files{};
};

class RtlModule {
 public:
  // Builds the library where the cache does not hold it, so that the constructor finds it. Throws as
  // build_library.
  static void build(const RtlModuleDesign& design);
  // Builds or finds the library, loads it and resets. Throws as build_library and clock.
  explicit RtlModule(const RtlModuleDesign& design);
  ~RtlModule();
  RtlModule(const RtlModule&) = delete;
  RtlModule& operator=(const RtlModule&) = delete;

  // Holds reset for two clocks with all inputs at 0; throws as clock.
  void reset();
  // Drives the inputs, samples the outputs, and gives the rising edge; ports in the order of the design,
  // their bits zero-extended. Throws std::logic_error with the text of an assertion in the RTL that failed.
  void clock(std::span<const std::uint64_t> inputs, std::span<std::uint64_t> outputs);

 private:
  struct Library;
  std::unique_ptr<Library> library_;  // outlives the handle: declared before it
  std::unique_ptr<void, void (*)(void*)> handle_;
};

}  // namespace bitspan
