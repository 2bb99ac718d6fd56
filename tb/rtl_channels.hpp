// SPDX-License-Identifier: Apache-2.0
// A Verilated pixel stage, or the chain of them, as channels: groups of ports with one handshake.
//
// A channel NAME with fields F has, seen from the module: the ports NAME_valid_i, NAME_ready_o and NAME_F_i
// where it leads into the module, NAME_valid_o, NAME_ready_i and NAME_F_o where it leads out. A tap is a
// channel out without NAME_ready_i. A constant has the port NAME_i alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tb/rtl_module.hpp"
#include "tb/rtl_sources.hpp"

namespace bitspan {

// One value per field of a channel: a port's bits, zero-extended (Rtl::to_port, Rtl::from_port).
using StageValues = std::vector<std::uint64_t>;

enum class ChannelKind : std::uint8_t { in, out, tap };

struct StageChannel {
  ChannelKind kind = ChannelKind::in;
  std::string name;
  std::vector<std::string> fields;
};

struct StageDesign {
  std::string name;     // of the configuration
  std::string top;      // the module
  std::string package;  // text in front of the sources
  std::vector<StageChannel> channels;
  std::vector<std::string> constants;  // ports that stay as they are
  std::vector<std::string> levels;     // ports NAME_o besides those of the channels
  std::vector<std::filesystem::path> sources = pixel_sources();
};

// The design's ports in order, by names: what RtlModule drives and samples.
RtlModuleDesign module_of(const StageDesign& design);

// Where a channel's ports stand: valid and the fields, the first of them at `first`, among the inputs where
// it leads in, else among the outputs; ready among the others.
struct ChannelPorts {
  std::size_t valid = 0, ready = 0, first = 0;
};
ChannelPorts ports_of(const RtlModuleDesign& module, const StageChannel& channel);
// The place of a port. Throws std::logic_error where there is none of that name.
std::size_t port_place(const std::vector<std::string>& ports, std::string_view name);

}  // namespace bitspan
