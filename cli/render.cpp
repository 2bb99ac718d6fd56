// bitspan render: one picture, and on request its dump and its triangle stream.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include "cli/commands.hpp"
#include "cli/config_store.hpp"
#include "cli/engines.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "config/range.hpp"
#include "report/dump.hpp"
#include "report/lockstep.hpp"
#include "report/png.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

struct Options {
  std::string scene;
  std::string output;
  std::string config{default_config};
  std::string engine = "model";
  std::string dump;
  std::string emit_tri;
  SceneOptions view;
};

int render(const Options& o) {
  if (o.output.empty() && o.dump.empty() && o.emit_tri.empty()) {
    throw InputError("render: nothing to write; give -o PICTURE.png, --dump DIR or --emit-tri FILE.tri");
  }
  const Config config = find_config(o.config);
  const auto names = parse_engines(o.engine);
  if (names.size() != 1) {
    throw InputError("--engine: one engine draws one picture");
  }
  if (!engine_runs(names[0], config)) {
    throw InputError(fmt::format("--engine {}: it has no {} mode", names[0], to_string(config.perspective)));
  }
  const Scene scene = load_scene(o.scene, o.view);
  if (!o.output.empty() || !o.dump.empty()) {
    check_scene_range(config, scene);
    const auto engine = make_engine(names[0], config);
    const auto start = std::chrono::steady_clock::now();
    {
      Progress progress(scene.name);
      engine->begin(scene);
      constexpr std::size_t step = 1024;
      for (std::size_t done = 0; done < scene.triangles.size(); done += step) {
        const std::size_t n = std::min(step, scene.triangles.size() - done);
        engine->draw({scene.triangles.data() + done, n}, static_cast<std::int64_t>(done), nullptr);
        progress.update(done + n, scene.triangles.size());
      }
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const Frame& frame = engine->frame();
    if (!o.output.empty()) {
      write_png(o.output, frame.width, frame.height, 4, frame.color);
    }
    if (!o.dump.empty()) {
      write_dump(o.dump, frame, engine->counters(), config, {BITSPAN_VERSION, scene.name, names[0], seconds});
    }
    const Counters& c = engine->counters();
    fmt::print("{}: {}x{}, {} triangles, {} fragments, {} written, {} ({}), {}\n", scene.name, frame.width,
               frame.height, c.triangles, c.fragments, c.written, config.name, config_hash(config), names[0]);
  }
  if (!o.emit_tri.empty()) {
    write_tri_file(o.emit_tri, scene);
  }
  return exit_held;
}

}  // namespace

void add_render(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("render", "one picture");
  const auto o = std::make_shared<Options>();
  sub->add_option("scene", o->scene, "stream (.tri), mesh, demo or extreme/NAME")->required();
  sub->add_option("-o,--output", o->output, "the picture, a PNG");
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option("--engine", o->engine, "golden, model, systemc, rtl or ideal")->capture_default_str();
  sub->add_option("--dump", o->dump, "folder for color, depth, u, v, triangle (.npy) and run.json");
  sub->add_option("--emit-tri", o->emit_tri, "write the triangles as a stream, textures beside it");
  add_scene_options(*sub, o->view);
  sub->footer("Example:\n  bitspan render demo -o demo.png --config narrow --dump demo.dump");
  sub->callback([o, &action] { action = [o] { return render(*o); }; });
}

}  // namespace bitspan
