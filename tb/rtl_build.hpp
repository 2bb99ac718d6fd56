// SPDX-License-Identifier: Apache-2.0
// The Verilated span interpolator of any configuration, built when it is first asked for.
//
// The package of the configuration (engine/emit_sv) and the sources in rtl/ go through Verilator and the C++
// compiler into one shared library, kept in a cache folder under a key over every text and flag that it is
// made from: $BITSPAN_CACHE, else $XDG_CACHE_HOME/bitspan, else ~/.cache/bitspan. Libraries appear there
// complete or not at all, so processes may build the same one at the same time. The sources are those in
// data_folder().
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tb/rtl_abi.hpp"
#include "tb/rtl_sources.hpp"

namespace bitspan {

std::filesystem::path rtl_cache_folder();

// Flags that every use of Verilator here must have; tests/rtl/verilator_xor_test says why.
const std::vector<std::string>& verilator_safe_flags();

// What a library is made of.
struct RtlDesign {
  std::string name;     // of the configuration, for the line of progress
  std::string top;      // the module
  std::string package;  // text in front of the sources
  std::vector<std::filesystem::path> sources;
  std::string ports;    // text in front of the harness
  std::string harness;  // its file below data_folder()
  // A design of the user's: further words of Verilator's command, and the files that it reads by them.
  std::vector<std::string> words{};
  std::vector<std::filesystem::path> files{};
};
// Builds the library where the cache does not hold it, and returns its path. Throws InputError where
// Verilator refuses sources of the user's ($BITSPAN_ROOT, RtlDesign::words) or the cache folder cannot be
// written; ToolError where a tool is missing or refuses otherwise. Writes a line of progress to a terminal.
std::filesystem::path build_library(const RtlDesign& design);
// The span interpolator's library. Throws InputError also where the configuration has none.
std::filesystem::path build_rtl(const Config& config);

// A library while it is loaded. Throws ToolError where it cannot be, or where it lacks a function.
class RtlLibrary {
 public:
  explicit RtlLibrary(const std::filesystem::path& path);
  ~RtlLibrary();
  RtlLibrary(const RtlLibrary&) = delete;
  RtlLibrary& operator=(const RtlLibrary&) = delete;

  template <class Function>
  void load(Function& function, const char* name) const {
    function = reinterpret_cast<Function>(symbol(name));
  }

 private:
  void* symbol(const char* name) const;
  void* handle_;
};

// Throws std::logic_error with the text of a failed assertion, where there is one.
void throw_on_assertion(const char* failed);

// One simulated span interpolator. Values go in and come out as raw integers with their signs, as records
// hold them.
class Rtl {
 public:
  // Builds or finds the library, loads it and resets. Before the reset all registers are 0, or random values
  // where a seed other than 0 is given. Throws as build_rtl and clock.
  explicit Rtl(const Config& config, int initial_seed = 0);
  ~Rtl();
  Rtl(Rtl&&) noexcept;
  Rtl& operator=(Rtl&&) noexcept;
  Rtl(const Rtl&) = delete;
  Rtl& operator=(const Rtl&) = delete;

  // Empty, as after construction; throws as clock.
  void reset();
  // Runs one clock. Throws std::logic_error with the text of an assertion in the RTL that failed.
  void clock(const RtlDrive& drive, RtlSample& sample);

  // With no record offered and out_ready at 1, whatever was accepted or issued has left after this many
  // clocks: the longest way is from the acceptance of a record of one pixel to that pixel's transfer.
  int clocks_until_empty() const { return clocks_until_empty_; }

  // Turn a raw value into the bits of a port, and back.
  static std::uint64_t to_port(std::int64_t raw, int width);
  static std::int64_t from_port(std::uint64_t bits, const Format& format);
  // The same for a value on a port of shades, from bit `at` on.
  static void put(RtlShades& port, std::size_t at, std::int64_t raw, int width);
  static std::int64_t get(const RtlShades& port, std::size_t at, const Format& format);
  // The same for four shades.
  using Shades = std::array<std::int64_t, 4>;
  static RtlShades to_port(const Shades& raw, int width);
  static Shades from_port(const RtlShades& bits, const Format& format);

 private:
  struct Library;
  std::shared_ptr<Library> library_;  // outlives the handle: declared before it
  std::unique_ptr<void, void (*)(void*)> handle_;
  int clocks_until_empty_ = 0;
};

}  // namespace bitspan
