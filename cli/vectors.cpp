// SPDX-License-Identifier: Apache-2.0
// bitspan vectors: the records around a stage, for benches in any language. bitspan check: a design's
// answers.
#include "report/vectors.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "config/store.hpp"
#include "io/atomic_file.hpp"

namespace bitspan {
namespace {

struct VectorsArguments {
  std::string scene;
  std::string stage;
  std::string format;
  std::string config{default_config};
  std::string output;
  SceneOptions view;
};

RecordType stage_named(const std::string& name) {
  return std::ranges::find(stage_table, std::string_view(name), &StageRow::name)->type;
}

int vectors(const VectorsArguments& o) {
  const Config config = with_lines(find_config(o.config), o.view);
  const VectorFormat format = vector_format(o.format);
  const bool is_file = format == VectorFormat::json;
  const std::string output =
      !o.output.empty() ? o.output : o.stage + (is_file ? ".vectors.json" : ".vectors");
  if (is_file) check_writable(output);
  const LoadedScene loaded = load_scene(o.scene, seen_with(config, o.view));
  Progress progress(loaded.scene.name);
  const Vectors made = make_vectors(config, loaded.scene, stage_named(o.stage),
                                    [&](std::size_t done, std::size_t all) { progress.update(done, all); });
  const std::size_t records = view_of(made.trace, made.stage).records;
  if (records == 0) {
    throw NothingDrawn(fmt::format("{}: configuration {} makes no record of {} of it", loaded.scene.name,
                                   config.name, o.stage));
  }
  write_vectors(made, format, output, BITSPAN_VERSION);
  std::string inputs;
  for (const RecordView& view : inputs_of(made)) {
    inputs += fmt::format("{}{} of {}", inputs.empty() ? "" : ", ", view.records, view.stage);
  }
  fmt::print("{}: {} records of {}{}{}; {} ({})\n", output, records, o.stage,
             inputs.empty() ? "" : " made from ", inputs, config.name, config_hash(config));
  fmt::print("{}", faces_line(loaded));
  return exit_held;
}

struct CheckOptions {
  std::string path;
  VectorCheckOptions check;
};

int check(const CheckOptions& o) {
  Progress progress(o.path);
  const VectorCheck result =
      check_vectors(o.path, o.check, [&](std::size_t done, std::size_t all) { progress.update(done, all); });
  std::string command = "bitspan check " + shell_word(o.path);
  if (!o.check.answers.empty()) command += " --answers " + shell_word(o.check.answers);
  if (!o.check.fields.empty()) command += fmt::format(" --fields {}", fmt::join(o.check.fields, ","));
  fmt::print("{}", check_text(result, {result.scene, command}));
  return result.held() ? exit_held : exit_difference;
}

}  // namespace

void add_vectors(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("vectors", "the records around a stage, for a bench in any language");
  const auto o = std::make_shared<VectorsArguments>();
  sub->add_option("scene", o->scene, "stream (.tri, .trib), mesh, demo or extreme/NAME")->required();
  std::vector<std::string> stages;
  for (const StageRow& row : stage_table) stages.emplace_back(row.name);
  sub->add_option("--stage", o->stage, "whose records the design makes")
      ->required()
      ->check(CLI::IsMember(stages));
  sub->add_option("--format", o->format, "hex (one word per record, for $readmemh), json or npy")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(vector_formats.begin(), vector_formats.end())));
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option("-o,--output", o->output,
                  "file (json) or folder (hex, npy); without it STAGE.vectors.json or STAGE.vectors");
  add_scene_options(*sub, o->view);
  sub->footer(help_footer("the vectors are written",
                          "the scene makes no record of the stage, or no face of a mesh is drawn",
                          "bitspan vectors demo --stage span --format hex -o span.vectors"));
  sub->callback([o, &action] { action = [o] { return vectors(*o); }; });
}

void add_check(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("check", "compare a design's answers to vectors with the model");
  const auto o = std::make_shared<CheckOptions>();
  sub->add_option("vectors", o->path, "file or folder that bitspan vectors wrote, with the design's answers")
      ->required();
  sub->add_option("--answers", o->check.answers,
                  "the design's records, in the place of the output of hex or npy");
  sub->add_option("--fields", o->check.fields, "fields that the design has, such as x,y,u; without it all")
      ->delimiter(',');
  sub->footer(help_footer("all answers are the model's", "a difference, or nothing non-trivial matched",
                          "bitspan check span.vectors --answers answers.hex --fields x,y,u,v"));
  sub->callback([o, &action] { action = [o] { return check(*o); }; });
}

}  // namespace bitspan
