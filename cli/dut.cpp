// SPDX-License-Identifier: Apache-2.0
// bitspan dut add | list | show | remove: designs of the user's as engines dut:NAME.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "config/store.hpp"
#include "report/table.hpp"
#include "tb/dut_store.hpp"
#include "tb/engine_dut.hpp"

namespace bitspan {
namespace {

struct DutArguments {
  DutRequest request;
  bool replace = false;
  std::string name;
  bool wrapper = false;
};

std::string config_text(const StoredDut& dut) {
  return dut.config ? fmt::format("configuration {} ({})", dut.config->name, config_hash(*dut.config))
                    : "any configuration with RTL";
}

// A design for any configuration is checked with the first shipped one that has its stages.
Config config_of(const StoredDut& dut) {
  if (dut.config) return *dut.config;
  for (const ShippedConfig& shipped : config_texts()) {
    Config config = find_config(std::string(shipped.name));
    if (refusal(dut.design.map, config).empty()) return config;
  }
  throw InputError(fmt::format("{}: no shipped configuration has records of {}; expected --config",
                               dut.design.map.origin, stage_of(dut.design.map.input.stage)));
}

// The fields of the output stage: which are the design's own.
std::string fields_text(const StoredDut& dut, const DutWrapper& wrapper) {
  std::vector<std::vector<std::string>> rows{{"field", "port", "bits"}};
  const RecordType stage = dut.design.map.output.stage;
  std::string models;
  for (const Field& field : fields_of(stage)) {
    const auto at = std::ranges::find_if(wrapper.outputs,
                                         [&](const DutLane& lane) { return lane.field.name == field.name; });
    if (at == wrapper.outputs.end()) {
      models += (models.empty() ? "" : ", ") + std::string(field.name);
    } else {
      rows.push_back({at->field.name, at->port, fmt::format("{}", at->bits)});
    }
  }
  std::string out = text_table(rows);
  out += fmt::format("{}: {} of {} fields are the design's own", stage_of(stage), wrapper.outputs.size(),
                     fields_of(stage).size());
  if (!models.empty()) out += "; the model's, and not checked: " + models;
  out += '\n';
  if (!wrapper.open_inputs.empty()) {
    out +=
        fmt::format("note: inputs in no part of the map are 0: {}\n", fmt::join(wrapper.open_inputs, ", "));
  }
  return out;
}

int add(const DutArguments& o) {
  const StoredDut dut = read_dut(o.request);
  const DutWrapper wrapper = wrap_dut(dut.design, config_of(dut));
  lint_dut(dut.design, wrapper);
  store_dut(dut, o.request, wrapper.text, o.replace);
  fmt::print("{}{}: module {}, {}, {} files\n{}", dut_prefix, dut.design.name, dut.design.map.top,
             config_text(dut), wrapper.files.size(), fields_text(dut, wrapper));
  return exit_held;
}

int list(const DutArguments& /*o*/) {
  std::vector<std::vector<std::string>> rows{{"engine", "module", "input", "output", "configuration", "map"}};
  for (const std::string& name : dut_names()) {
    const std::string engine = std::string(dut_prefix) + name;
    try {
      const StoredDut dut = load_dut(name);
      const DutMap& map = dut.design.map;
      rows.push_back({engine, map.top, std::string(stage_of(map.input.stage)),
                      std::string(stage_of(map.output.stage)), dut.config ? dut.config->name : "any",
                      map.origin});
    } catch (const InputError& error) {
      rows.push_back({engine, "damaged", "", "", "", error.what()});
    }
  }
  if (rows.size() == 1) {
    fmt::print("no designs in {}; `bitspan dut add MAP.toml` makes one\n", duts_folder().string());
  } else {
    fmt::print("{}", text_table(rows));
  }
  return exit_held;
}

int show(const DutArguments& o) {
  if (o.wrapper) {
    fmt::print("{}", stored_wrapper(o.name));
    return exit_held;
  }
  const StoredDut dut = load_dut(o.name);
  const DutWrapper wrapper = wrap_dut(dut.design, config_of(dut));
  fmt::print("{}{}: module {}, {}, design {}\nmap {}\n", dut_prefix, o.name, dut.design.map.top,
             config_text(dut), wrapper.hash, dut.design.map.origin);
  for (const auto& file : wrapper.files) fmt::print("source {}\n", file.string());
  std::vector<std::vector<std::string>> rows{{"fed with", "port", "bits"}};
  for (const DutLane& lane : wrapper.inputs) {
    rows.push_back({lane.field.name, lane.port, fmt::format("{}", lane.bits)});
  }
  fmt::print("\n{}\n{}", text_table(rows), fields_text(dut, wrapper));
  return exit_held;
}

int remove(const DutArguments& o) {
  remove_dut(o.name);
  fmt::print("{}{}: removed; its sources stay\n", dut_prefix, o.name);
  return exit_held;
}

CLI::App* command(CLI::App& group, const std::string& name, const std::string& text,
                  const std::shared_ptr<DutArguments>& o, Action& action, int (*run)(const DutArguments&)) {
  CLI::App* sub = group.add_subcommand(name, text);
  sub->callback([o, &action, run] { action = [o, run] { return run(*o); }; });
  return sub;
}

}  // namespace

void add_dut(CLI::App& app, Action& action) {
  CLI::App* group = app.add_subcommand("dut", "make a design of one's own the engine dut:NAME");
  group->require_subcommand(1);
  group->footer(help_footer("it is done", "",
                            "bitspan dut add span_walker.toml\n"
                            "  bitspan verify demo --config affine.toml --engines golden,dut:span_walker"));
  const auto o = std::make_shared<DutArguments>();
  CLI::App* sub = command(*group, "add", "check a map and its design, and make the engine", o, action, add);
  sub->add_option("map", o->request.map, "TOML file: ports of the design and fields of records")->required();
  sub->add_option("--top", o->request.top, "module (default: the map's)");
  sub->add_option("--name", o->request.name, "of the engine, behind dut: (default: the map's file name)");
  sub->add_option("--config", o->request.config,
                  "the configuration that it is for, shipped name or TOML file (default: the map's, or any)");
  sub->add_option("--source", o->request.sources,
                  "a source, or a list of them as FILE.f (default: the map's)");
  sub->add_flag("--replace", o->replace, "also where the name is taken");
  sub->footer(help_footer("the engine is made", "",
                          "bitspan dut add span_walker.toml --name walker\n"
                          "  bitspan dut add acme.toml --config depth20 --source acme.f"));
  command(*group, "list", "the designs that there are", o, action, list)
      ->footer(help_footer("they are listed", "", "bitspan dut list"));
  sub = command(*group, "show", "which fields are the design's own", o, action, show);
  sub->add_option("name", o->name, "without dut:")->required();
  sub->add_flag("--wrapper", o->wrapper, "the SystemVerilog written around the design instead");
  sub->footer(help_footer("it is shown", "", "bitspan dut show span_walker"));
  sub = command(*group, "remove", "forget a design; its sources stay", o, action, remove);
  sub->add_option("name", o->name, "without dut:")->required();
  sub->footer(help_footer("it is removed", "", "bitspan dut remove span_walker"));
}

}  // namespace bitspan
