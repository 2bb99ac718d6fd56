// SPDX-License-Identifier: Apache-2.0
// bitspan config show | check | emit-sv | schema
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/config_schema.hpp"
#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "config/store.hpp"
#include "engine/sv_names.hpp"
#include "golden/precision.hpp"
#include "io/atomic_file.hpp"
#include "model/paths.hpp"
#include "model/simd/engine_vector.hpp"
#include "model/simd/shipped.hpp"
#include "report/table.hpp"
#include "tb/rtl_folder.hpp"

namespace bitspan {
namespace {

struct ConfigArguments {
  std::string config{default_config};
  std::string output;
  bool toml = false;
  std::string part;
  DepthWhen when = DepthWhen::early;
  std::string prefix;
  std::string folder;
};

int show(const ConfigArguments& options) {
  const Config config = find_config(options.config);
  if (options.toml) {
    fmt::print("{}", to_toml(config));
    return exit_held;
  }
  fmt::print("{} ({})\n\n", config.name, config_hash(config));
  std::vector<std::vector<std::string>> rows{
      {"format", "word", "sign", "integer", "fraction", "rounding", "overflow", "unit", "meaning"}};
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    const Format& f = config.format(id);
    rows.push_back({std::string(key_of(id)), fmt::format("{}", f.word), f.is_signed ? "signed" : "unsigned",
                    fmt::format("{}", f.integer), fmt::format("{}", f.fraction()),
                    std::string(to_string(f.rounding)), std::string(to_string(f.overflow)),
                    std::string(unit_of(id)), std::string(text_of(id))});
  }
  fmt::print("{}\n", text_table(rows));
  fmt::print("fill_rule {}, edge_walk {}, edge slopes {}, row slopes {}, perspective {}\n",
             to_string(config.fill_rule), to_string(config.edge_walk), to_string(config.edge_slope),
             to_string(config.row_slope), to_string(config.perspective));
  fmt::print("depth {} bits, {}; filter {}, wrap {}; fog {}", config.depth_bits, to_string(config.depth_code),
             to_string(config.filter), to_string(config.wrap), to_string(config.fog));
  if (has_fog_table(config.fog)) {
    fmt::print(" by {} bits of depth and {} of the zone", config.fog_depth_bits, config.fog_zone_bits);
  }
  fmt::print("\n");
  fmt::print("(`bitspan config show --toml` prints every key)\n");
  return exit_held;
}

std::string specialised_text(const Config& config) {
  const model::ShippedIndex index = model::shipped_index(config);
  if (index.spans >= 0 && index.shades >= 0) return "specialised (these formats are compiled in)";
  return index.spans >= 0
             ? "specialised (span and depth are compiled in; texture, fog and merge read formats)"
             : "specialised (texture, fog and merge are compiled in; span and depth read formats)";
}

// Which way the engine model takes, stage by stage.
std::string paths_text(const Config& config) {
  std::vector<std::vector<std::string>> rows{{"stage", "bits", "model computes in", "widest exact value"}};
  for (const model::StagePath& path : model::model_paths(config)) {
    rows.push_back({path.stage, fmt::format("{}", path.bits), path.path, path.widest});
  }
  std::string form;
  switch (model::chosen_form(config, ModelForm::automatic)) {
    case ModelForm::specialised:
      form = specialised_text(config);
      break;
    case ModelForm::vector:
      form = "vector (formats read at run time)";
      break;
    default:
      form = fmt::format("scalar ({})", model::vector_refusal(config));
  }
  return text_table(rows) +
         fmt::format("model: form {}, vectors for {}\n", form, model::to_string(model::best_target()));
}

int check(const ConfigArguments& options) {
  const Config config = find_config(options.config);
  fmt::print("{} ({}): legal\n", config.name, config_hash(config));
  const golden::Precision precision = golden::choose_precision(config);
  std::vector<std::vector<std::string>> rows{{"stage", "bits", "golden computes in", "widest exact value"}};
  for (const golden::PrecisionRow& row : precision.rows) {
    auto same = std::ranges::find_if(rows, [&](const auto& r) { return r[0] == row.stage; });
    if (same == rows.end()) {
      rows.push_back({row.stage, "0", std::string(golden::to_string(row.width)), ""});
      same = rows.end() - 1;
    }
    if (row.bits > std::stoi((*same)[1])) {
      (*same)[1] = fmt::format("{}", row.bits);
      (*same)[3] = row.expression;
    }
  }
  fmt::print("{}\n{}", text_table(rows), paths_text(config));
  if (has_setup_plane(config)) {
    fmt::print(
        "RTL: none (slope.row is plane); the timed model counts {} clocks for span_setup, a row every {}\n",
        row_schedule_by_plane(config).latency, row_schedule_by_plane(config).interval);
  }
  if (!has_rtl(config)) return exit_held;
  const RtlTiming timing = rtl_timing(config);
  fmt::print("RTL: span_setup {} clocks, a row every {}; span {} clocks, a pixel every {}\n",
             timing.row.latency, timing.row.interval, timing.span,
             timing.pixel_interval == 1 ? "clock" : std::to_string(timing.pixel_interval));
  return exit_held;
}

int print_or_write(const ConfigArguments& options, const std::string& text) {
  if (options.output.empty()) {
    fmt::print("{}", text);
  } else {
    write_file(options.output, text);
  }
  return exit_held;
}

int emit(const ConfigArguments& options) {
  const bool both = options.part == "both" || (options.part.empty() && !options.folder.empty());
  const RtlChoice choice{.interpolator = both || options.part.empty() || options.part == "interpolator",
                         .pixels = both || options.part == "pixels",
                         .project = options.part == "project",
                         .light = options.part == "light",
                         .curve = options.part == "curve",
                         .rotate = options.part == "rotate",
                         .when = options.when,
                         .prefix = options.prefix};
  const Config config = find_config(options.config);
  if (!options.folder.empty()) {
    const int files = write_rtl_folder(config, choice, options.folder);
    fmt::print("{}: {} files; {}bitspan.f lists the others in the order of reading\n", options.folder, files,
               options.prefix);
    return exit_held;
  }
  return print_or_write(options, rtl_packages(config, choice));
}

int schema(const ConfigArguments& options) { return print_or_write(options, config_schema()); }

CLI::App* add(CLI::App& parent, const std::string& name, const std::string& text,
              const std::shared_ptr<ConfigArguments>& o, Action& action, int (*run)(const ConfigArguments&)) {
  CLI::App* sub = parent.add_subcommand(name, text);
  sub->add_option("config", o->config, "shipped name (" + names_of_shipped() + ") or TOML file")
      ->capture_default_str();
  sub->footer(help_footer("the configuration is legal", "", "bitspan config " + name + " depth16"));
  sub->callback([o, &action, run] { action = [o, run] { return run(*o); }; });
  return sub;
}

}  // namespace

void add_config(CLI::App& app, Action& action) {
  CLI::App* group = app.add_subcommand("config", "show, check or emit a configuration");
  group->require_subcommand(1);
  group->footer(help_footer("the configuration is legal", "", "bitspan config show depth16"));
  const auto options = std::make_shared<ConfigArguments>();
  add(*group, "show", "the format table and the modes", options, action, show)
      ->add_flag("--toml", options->toml, "the canonical TOML text instead");
  add(*group, "check", "read a configuration strictly; exit 2 names what is wrong", options, action, check);
  CLI::App* sv =
      add(*group, "emit-sv", "the SystemVerilog package bitspan_cfg_pkg for the RTL, or all of the RTL",
          options, action, emit);
  sv->add_option(
        "--part", options->part,
        "span interpolator, pixel stages or both (default: interpolator; with --rtl both); or a module of "
        "its own: project (of project.unit), light (of light.at = pixel), curve (forward_difference) or "
        "rotate")
      ->check(CLI::IsMember({"interpolator", "pixels", "both", "project", "light", "curve", "rotate"}));
  sv->add_option_function<std::string>(
        "--depth-when",
        [options](const std::string& when) {
          options->when = when == to_string(DepthWhen::late) ? DepthWhen::late : DepthWhen::early;
        },
        "the order of tests that the pixel stages are built for: early (default), or late, with a stencil "
        "test")
      ->check(CLI::IsMember({"early", "late"}));
  sv->add_option_function<std::string>(
      "--prefix",
      [options](const std::string& prefix) {
        check_prefix(prefix);
        options->prefix = prefix;
      },
      "in front of the name of every package and module, so that two configurations live in one simulation");
  CLI::Option* output =
      sv->add_option("-o,--output", options->output, "file to write (default: standard output)");
  sv->add_option("--rtl", options->folder,
                 "new or empty folder to write: packages, RTL sources and PREFIXbitspan.f, their list")
      ->check([](const std::string& path) { return path.empty() ? "expected a folder" : ""; })
      ->excludes(output);
  sv->footer(help_footer("the configuration is legal", "",
                         "bitspan config emit-sv depth16\n"
                         "  bitspan config emit-sv narrow --prefix near_ --rtl near"));
  CLI::App* json = group->add_subcommand("schema", "the JSON schema of configuration files, for editors");
  json->add_option("-o,--output", options->output, "file to write (default: standard output)");
  json->footer(
      help_footer("the schema is written", "", "bitspan config schema -o configuration.schema.json"));
  json->callback([options, &action] { action = [options] { return schema(*options); }; });
}

}  // namespace bitspan
