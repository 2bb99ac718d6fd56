// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "tb/rtl_build.hpp"

namespace bitspan {

RtlModuleDesign module_of(const StageDesign& design) {
  RtlModuleDesign m{.name = design.name,
                    .top = design.top,
                    .package = design.package,
                    .sources = design.sources,
                    .inputs = {},
                    .outputs = {}};
  for (const StageChannel& c : design.channels) {
    const bool in = c.kind == ChannelKind::in;
    auto& with = in ? m.inputs : m.outputs;
    with.push_back(c.name + (in ? "_valid_i" : "_valid_o"));
    for (const std::string& field : c.fields) with.push_back(c.name + "_" + field + (in ? "_i" : "_o"));
    if (in) m.outputs.push_back(c.name + "_ready_o");
    if (c.kind == ChannelKind::out) m.inputs.push_back(c.name + "_ready_i");
  }
  for (const std::string& name : design.constants) m.inputs.push_back(name + "_i");
  for (const std::string& name : design.levels) m.outputs.push_back(name + "_o");
  return m;
}

std::size_t port_place(const std::vector<std::string>& ports, std::string_view name) {
  const auto found = std::ranges::find(ports, name);
  if (found == ports.end()) throw std::logic_error(fmt::format("the module has no port {}", name));
  return static_cast<std::size_t>(found - ports.begin());
}

ChannelPorts ports_of(const RtlModuleDesign& module, const StageChannel& channel) {
  const bool in = channel.kind == ChannelKind::in;
  ChannelPorts p;
  p.valid = port_place(in ? module.inputs : module.outputs, channel.name + (in ? "_valid_i" : "_valid_o"));
  p.first = p.valid + 1;
  if (in) p.ready = port_place(module.outputs, channel.name + "_ready_o");
  if (channel.kind == ChannelKind::out) p.ready = port_place(module.inputs, channel.name + "_ready_i");
  return p;
}

}  // namespace bitspan
