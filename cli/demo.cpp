// SPDX-License-Identifier: Apache-2.0
// bitspan demo: the main job on embedded input, two scenes, with a report to look at.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/scene_options.hpp"
#include "cli/verdict.hpp"
#include "config/check.hpp"
#include "config/store.hpp"
#include "engine/registry.hpp"
#include "io/atomic_file.hpp"
#include "io/png.hpp"
#include "report/error.hpp"
#include "report/heatmap.hpp"
#include "report/junit.hpp"
#include "report/table.hpp"

namespace bitspan {
namespace {

struct DemoArguments {
  std::string output = "bitspan-demo";
  std::string config{default_config};
  std::string engines = "golden,model,systemc,rtl,ideal";
  bool engines_named = false;  // by the user
  bool allow_missing = false;
  SceneOptions view;
};

struct Picture {
  std::string file;
  std::string caption;
  std::vector<std::uint8_t> png;
};

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t word = (std::uint32_t{bytes[i]} << 16) |
                               (left > 1 ? std::uint32_t{bytes[i + 1]} << 8 : 0) |
                               (left > 2 ? std::uint32_t{bytes[i + 2]} : 0);
    for (std::size_t d = 0; d < 4; ++d) {
      out += d <= left ? digits[(word >> (18 - 6 * d)) & 63] : '=';
    }
  }
  return out;
}

Picture color_picture(std::string file, std::string caption, const Frame& frame) {
  return {std::move(file), std::move(caption), encode_png(frame.width, frame.height, 4, frame.color)};
}

Picture field_picture(std::string file, std::string caption, const Frame& frame,
                      const std::vector<double>& field, const std::string& title, bool logarithmic) {
  HeatMapOptions options;
  options.title = title;
  options.logarithmic = logarithmic;
  const HeatMap map = draw_heat_map(frame.width, frame.height, field, options);
  return {std::move(file), std::move(caption), encode_png(map.width, map.height, 3, map.rgb)};
}

Picture color_error_picture(std::string file, const Frame& drawn, const Frame& ideal) {
  std::vector<double> errors(drawn.depth.size(), 0);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = std::fabs(static_cast<double>(drawn.color[4 * i + c]) -
                                 static_cast<double>(ideal.color[4 * i + c]));
      errors[i] = std::max(errors[i], d);
    }
  }
  return field_picture(std::move(file), "Error of colour against ideal, largest channel, in codes", drawn,
                       errors, "colour error, codes", false);
}

// The pictures of the scene demo: what was drawn, and where it errs.
std::vector<Picture> pictures_of(const Frame& drawn, const Frame& ideal) {
  const std::size_t n = drawn.depth.size();
  const PictureErrors errors = picture_errors(drawn, ideal);
  std::vector<double> depth(n, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < n; ++i) {
    if (drawn.triangle[i] >= 0) depth[i] = drawn.depth[i];
  }
  std::vector<Picture> out;
  out.push_back(color_picture("color.png", "Colour, as the fixed-point pipeline draws it", drawn));
  out.push_back(color_picture("ideal.png", "The same scene without quantisation", ideal));
  out.push_back(field_picture("depth.png", "Depth codes, logarithmic; larger is nearer", drawn, depth,
                              "depth code", true));
  out.push_back(field_picture("error_depth.png", "Error of depth against ideal, in codes", drawn,
                              errors.depth, "depth error, codes", false));
  out.push_back(field_picture("error_uv.png",
                              "Error of the texture coordinates against ideal, in texels, logarithmic", drawn,
                              errors.texture, "u, v error, texels", true));
  out.push_back(color_error_picture("error_color.png", drawn, ideal));
  return out;
}

// A scene of the report.
struct ShownScene {
  SceneVerdict verdict;
  std::vector<Picture> pictures;
};

// That of the first scene that did not hold, or of the first.
const SceneVerdict& decisive(const std::vector<ShownScene>& scenes) {
  const auto failed = std::ranges::find_if(scenes, [](const ShownScene& s) { return !s.verdict.held(); });
  return (failed == scenes.end() ? scenes.front() : *failed).verdict;
}

std::string markdown(const std::vector<ShownScene>& scenes) {
  std::string out = fmt::format("# bitspan demo: {}\n", decisive(scenes).outcome());
  for (const auto& [v, pictures] : scenes) {
    out += fmt::format("\n## Scene {}\n\nConfiguration {} ({}), bitspan {}.\n\n", v.scene, v.config.name,
                       config_hash(v.config), BITSPAN_VERSION);
    for (const std::string& failure : v.failures) {
      out += "- FAILED: " + failure + "\n";
    }
    out += "\n### Engines, record by record\n\n" + markdown_table(comparison_table(v));
    if (v.has_errors) out += "\n### Error against ideal\n\n" + markdown_table(error_table(v.errors));
    out += "\n";
    for (const std::string& line : verdict_lines(v)) {
      out += "- " + line + "\n";
    }
    for (const Picture& picture : pictures) {
      out += fmt::format("\n{}:\n\n![{}]({})\n", picture.caption, picture.caption, picture.file);
    }
  }
  return out;
}

std::string html(const std::vector<ShownScene>& scenes) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>bitspan "
      "demo</title>\n<style>\n"
      "body{font:15px/1.45 system-ui,sans-serif;max-width:1340px;margin:2em auto;padding:0 "
      "1em;color:#1b1f24}\n"
      "table{border-collapse:collapse;margin:1em 0}th,td{padding:.15em .7em;border-bottom:1px solid #d8dee4;"
      "text-align:left}.n{text-align:right;font-variant-numeric:tabular-nums}\n"
      ".held{color:#116329}.failed{color:#a40e26}figure{display:inline-block;margin:0 1em 1em 0;"
      "vertical-align:top}img{max-width:640px;width:100%}figcaption{color:#57606a}\n</style></head><body>\n";
  const SceneVerdict& first = decisive(scenes);
  out += fmt::format("<h1>bitspan demo: <span class=\"{}\">{}</span></h1>\n",
                     first.held() ? "held" : "failed", first.outcome());
  for (const auto& [v, pictures] : scenes) {
    out += fmt::format("<h2>Scene {}</h2>\n<p>Configuration {} ({}), bitspan {}.</p>\n", xml_escape(v.scene),
                       xml_escape(v.config.name), config_hash(v.config), BITSPAN_VERSION);
    for (const std::string& failure : v.failures) {
      out += "<p class=\"failed\">" + xml_escape(failure) + "</p>\n";
    }
    for (const Picture& picture : pictures) {
      out += fmt::format(
          "<figure><img alt=\"{0}\" "
          "src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
          xml_escape(picture.caption), base64(picture.png));
    }
    out += "<h3>Engines, record by record</h3>\n" + html_table(comparison_table(v));
    if (v.has_errors) out += "<h3>Error against ideal</h3>\n" + html_table(error_table(v.errors));
    out += "<ul>\n";
    for (const std::string& line : verdict_lines(v)) {
      out += "<li>" + xml_escape(line) + "</li>\n";
    }
    out += "</ul>\n";
  }
  return out + "</body></html>\n";
}

// For the scene room: the same configuration with a light per pixel, shadows and relief, where it can have
// them.
Config with_lamp(const Config& config) {
  Config out = config;
  out.name += "-lamp";
  out.project = ProjectUnit::reciprocal;
  out.light = LightAt::pixel;
  out.light_source = LightSource::point;
  out.light_normal = LightNormal::map;
  out.light_shadow = LightShadow::map;
  return first_violation(out) ? config : out;
}

// Compares the engines over one of the scenes, and prints the verdict. pictures: of the first engine's frame
// and that of ideal.
template <class Pictures>
ShownScene shown(const DemoArguments& o, const std::string& scene, const Config& config,
                 const std::string& config_word, const SceneOptions& view, const VerifyOptions& options,
                 const Pictures& pictures) {
  SceneSource source(load_scene(scene, seen_with(config, view)));
  const RunLabel label{source.scene().name,
                       fmt::format("{}bitspan verify {} --config {}{}{}", command_environment(), scene,
                                   shell_word(config_word), o.engines_named ? " --engines " + o.engines : "",
                                   flags_text(view))};
  make_writable_folder(o.output);  // a place that cannot be written is told before the work
  SceneRun run = verify_scene(config, source, options, label);
  fmt::print("{}", verdict_text(run.verdict));
  std::vector<Picture> made = pictures(run.engines[0]->frame(), run.ideal->frame());
  return {std::move(run.verdict), std::move(made)};
}

// A quarter of the demo's pixels, as each costs more.
SceneOptions view_of_room(SceneOptions view) {
  if (view.size.empty()) view.size = "320x240";
  return view;
}

int demo(const DemoArguments& o) {
  const Config config = find_config(o.config);
  VerifyOptions options;
  options.engines = parse_engines(o.engines);
  if (std::ranges::find(options.engines, truth_name()) == options.engines.end()) {
    options.engines.emplace_back(truth_name());  // the pictures of the errors need it
  }
  options.engines_named = o.engines_named;
  options.allow_missing = o.allow_missing;
  options.allow_empty = o.view.allow_empty;
  const std::filesystem::path folder(o.output);
  std::vector<ShownScene> scenes{shown(o, "demo", config, o.config, o.view, options, pictures_of)};
  const Config lit = with_lamp(config);
  const std::string lit_file = (folder / "room.toml").string();
  fmt::print("\n");
  try {
    scenes.push_back(shown(
        o, "room", lit, lit_file, view_of_room(o.view), options, [](const Frame& drawn, const Frame& ideal) {
          return std::vector<Picture>{
              color_picture("room.png", "A lamp, its shadows, a wall in relief and a pane of glass", drawn),
              color_error_picture("error_room.png", drawn, ideal)};
        }));
    write_file(lit_file, to_toml(lit));
  } catch (const InputError& error) {
    fmt::print("room left out: {}\n", error.what());
  }
  for (const ShownScene& scene : scenes) {
    for (const Picture& picture : scene.pictures) {
      write_file((folder / picture.file).string(), picture.png);
    }
  }
  write_file((folder / "report.md").string(), markdown(scenes));
  write_file((folder / "report.html").string(), html(scenes));
  fmt::print("report: {}\n", (folder / "report.html").string());
  return decisive(scenes).held() ? exit_held : exit_difference;
}

}  // namespace

void add_demo(CLI::App& app, Action& action) {
  CLI::App* sub =
      app.add_subcommand("demo", "render two embedded scenes, check that all engines agree, write a report");
  const auto o = std::make_shared<DemoArguments>();
  sub->add_option("-o,--output", o->output, "folder of the report")->capture_default_str();
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option("--engines", o->engines, "compared with the first")->capture_default_str();
  sub->add_option("--size", o->view.size, "WxH of the picture (default 640x480)");
  sub->add_flag("--allow-missing", o->allow_missing,
                "an engine of --engines may be left out, and no pair may be left to compare");
  add_allow_empty(*sub, o->view);
  sub->footer(help_footer("all held",
                          "a difference, nothing compared, an engine named left out, or nothing drawn",
                          "bitspan demo -o bitspan-demo"));
  sub->callback([o, sub, &action] {
    o->engines_named = sub->count("--engines") > 0;
    action = [o] { return demo(*o); };
  });
}

}  // namespace bitspan
