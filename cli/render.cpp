// SPDX-License-Identifier: Apache-2.0
// bitspan render: one picture, and on request its dump and its triangle stream.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/bands.hpp"
#include "cli/commands.hpp"
#include "cli/model_options.hpp"
#include "cli/progress.hpp"
#include "cli/resolved.hpp"
#include "cli/scene_options.hpp"
#include "cli/turntable.hpp"
#include "config/store.hpp"
#include "engine/bands.hpp"
#include "engine/range.hpp"
#include "engine/registry.hpp"
#include "golden/oracle.hpp"
#include "io/atomic_file.hpp"
#include "io/png.hpp"
#include "model/engine_model.hpp"
#include "model/numeric/register.hpp"
#include "model/paths.hpp"
#include "model/stages/texel.hpp"
#include "report/bands.hpp"
#include "report/dump.hpp"
#include "report/edges.hpp"
#include "report/lockstep.hpp"
#include "report/stereo.hpp"
#include "report/table.hpp"
#include "report/visibility.hpp"
#include "scene/tri_stream.hpp"
#include "study/oracles.hpp"

namespace bitspan {
namespace {

struct RenderArguments {
  std::string scene;
  std::string output;
  std::string config{default_config};
  std::string engine = "model";
  bool statistics = false;
  std::string dump;
  bool position = false;
  std::string emit_tri;
  bool plain_textures = false;
  // Two pictures in one.
  std::string stereo;  // a layout; empty: one picture
  std::optional<std::string> stereo_by, stereo_zero;
  std::optional<double> parallax;
  std::optional<int> turntable;  // pictures of a turn
  std::string bands;             // rows of each; empty: the whole picture at once
  ModelFlags model;
  SceneOptions view;
};

// One row per register that saw a value: what it would have needed, and what its narrowing did.
std::string statistics_text(const Config& config, const model::Statistics& statistics) {
  std::vector<std::vector<std::string>> rows{{"register", "values", "minimum", "maximum", "bits used", "of",
                                              "saturated", "wrapped", "mean bias, ULP"}};
  for (int i = 0; i < model::register_count; ++i) {
    const auto id = static_cast<model::RegisterId>(i);
    const model::FieldStatistics& field = statistics.of(id);
    if (field.count == 0) continue;
    const Format format = model::format_of(id, config);
    const auto value = [&](std::int64_t raw) {
      return fmt::format("{:.8g}", std::ldexp(static_cast<double>(raw), -format.fraction()));
    };
    const double bias = std::ldexp(static_cast<double>(field.bias), -model::bias_fraction);
    rows.push_back({std::string(model::name_of(id)), fmt::format("{}", field.count), value(field.min),
                    value(field.max), fmt::format("{}", model::used_bits(field, format.is_signed)),
                    fmt::format("{}", format.word), fmt::format("{}", field.saturations),
                    fmt::format("{}", field.wraps),
                    fmt::format("{:.4f}", bias / static_cast<double>(field.count))});
  }
  return "\n" + text_table(rows);
}

// Before the work: the folder of a dump can be written, or made.
void check_dump(const std::string& folder) {
  if (folder.empty()) return;
  const std::filesystem::path path(folder);
  std::error_code no;
  const auto exists = [&] { return std::filesystem::is_directory(path, no); };
  if (!exists()) {
    try {
      check_writable((path.has_filename() ? path : path.parent_path()).string());
      return;
    } catch (const InputError&) {
      if (!exists()) throw;  // else another program has made it since
    }
  }
  check_writable((path / "run.json").string());
}

// The scene with each texture as the fetch gives it, in 8-bit RGBA.
Scene with_plain_textures(Scene scene) {
  for (Texture& t : scene.textures) {
    Texture plain;
    plain.name = t.name;
    plain.width = t.width;
    plain.height = t.height;
    for (int j = 0; j < t.height; ++j) {
      for (int i = 0; i < t.width; ++i) {
        const model::TexelCodes texel = model::texel_of(t, i, j);
        plain.rgba.insert(plain.rgba.end(), texel.begin(), texel.end());
      }
    }
    t = std::move(plain);
  }
  return scene;
}

struct Stereo {
  StereoLayout layout;
  StereoBy by;
  StereoZero zero;
};
// What the flags ask for; none: one picture.
std::optional<Stereo> stereo_of(const RenderArguments& o) {
  if (o.stereo.empty()) {
    for (const auto& [flag, is_given] : {std::pair{"--parallax", o.parallax.has_value()},
                                         {"--stereo-by", o.stereo_by.has_value()},
                                         {"--stereo-zero", o.stereo_zero.has_value()}}) {
      if (is_given) {
        throw InputError(fmt::format("{}: is of two pictures; give --stereo pair or anaglyph too", flag));
      }
    }
    return std::nullopt;
  }
  const Stereo out{choice<StereoLayout>(o.stereo, "--stereo"), choice<StereoBy>(o.stereo_by, "--stereo-by"),
                   choice<StereoZero>(o.stereo_zero, "--stereo-zero")};
  if (o.parallax && !(std::abs(*o.parallax) <= picture_size_limit)) {
    throw InputError(
        fmt::format("--parallax: {} is not legal; expected a number of pixels, at most {} either way",
                    *o.parallax, picture_size_limit));
  }
  if (is_parallel(o.view)) {
    throw InputError(
        fmt::format("--stereo: two eyes see distances, which --projection {} does not have; expected "
                    "one of them",
                    *o.view.projection));
  }
  if (o.output.empty() || !o.dump.empty() || !o.emit_tri.empty() || o.statistics || o.view.supersample > 1 ||
      !o.bands.empty()) {
    throw InputError(
        "--stereo: makes a picture alone; expected -o PICTURE.png without --dump, --emit-tri, --statistics, "
        "--supersample and --bands");
  }
  return out;
}

int render_stereo(const RenderArguments& o, const Stereo& stereo, const Config& config, SceneOptions view,
                  std::string_view engine_name, const EngineOptions& how) {
  const bool by_depth = stereo.by == StereoBy::depth;
  // What is beside the picture for the middle may be in that of an eye.
  view.clip_sides = by_depth;
  const LoadedScene loaded = load_scene(o.scene, view);
  const Scene& scene = loaded.scene;
  const StereoOptions options{o.parallax.value_or(scene.width / 20.0), stereo.zero};
  const auto drawn = [&](const Scene& what) {
    check_scene_range(config, what);
    auto engine = make_engine(engine_name, config, how);
    engine->begin(what);
    draw_scene(*engine, what, 0, what.triangles.size(), 0, nullptr);
    return engine;
  };
  std::array<EyePicture, 2> pictures;
  std::array<std::uint64_t, 2> holes{};
  const auto middle = by_depth ? drawn(scene) : nullptr;
  Views views(scene);
  for (const DrawCommand& command : scene.commands) {
    if (may_change_view(command)) views.execute(command);
  }
  for (const Eye eye : {Eye::left, Eye::right}) {
    const auto i = static_cast<std::size_t>(eye);
    if (by_depth) {
      Warped made = warped(config, with_view(views.now()), middle->frame(), options, eye);
      pictures[i] = std::move(made.picture);
      holes[i] = made.holes;
    } else {
      const auto engine = drawn(seen_by(scene, options, eye));
      const Frame& frame = engine->frame();
      pictures[i] = {frame.width, frame.height, frame.color};
    }
  }
  const EyePicture both = joined(pictures[0], pictures[1], stereo.layout);
  write_png(o.output, both.width, both.height, 4, both.rgba);
  fmt::print("{}: {}x{}, {}, parallax {} pixels each way, {} ({}), {}\n", scene.name, both.width, both.height,
             o.stereo, options.parallax, config.name, config_hash(config), engine_name);
  if (by_depth)
    fmt::print("holes: {} pixels of the left picture, {} of the right one, filled\n", holes[0], holes[1]);
  fmt::print("{}", faces_line(loaded));
  return exit_held;
}

constexpr std::string_view oracle_prefix = "oracle:";

// Of triangles that no oracle draws; empty without one.
std::string undrawn_note(std::size_t triangles) {
  if (triangles == 0) return "";
  return fmt::format("note: {} triangles are not drawn, since their fragments may be killed\n", triangles);
}

// What an oracle of edges sees: its visible parts as lines.
int render_edges(const RenderArguments& o, const Oracle& oracle, const Config& config,
                 const LoadedScene& loaded) {
  const Scene& scene = loaded.scene;
  const std::optional<Scene> own = by_distance(config, scene);
  const SeenEdges seen = seen_edges(oracle, config, own ? *own : scene);
  write_png(o.output, scene.width, scene.height, 4, edge_picture(scene, seen.edges));
  fmt::print("{}: {}x{}, {} triangles, {} ({}), {}\n", scene.name, scene.width, scene.height,
             scene.triangles.size(), config.name, config_hash(config), o.engine);
  fmt::print("{}\n{}{}", counts_text(seen.counts),
             undrawn_note(scene.triangles.size() - seen.triangles.size()), faces_line(loaded));
  return exit_held;
}

// What an oracle sees. It has no registers, so there is no colour but a flat one per triangle.
int render_oracle(const RenderArguments& o) {
  const std::string name = o.engine.substr(oracle_prefix.size());
  const Oracle* const known = find_oracle(name);
  if (known == nullptr) {
    throw InputError(fmt::format("--engine: '{}' is no oracle; legal: {}", name, oracle_names(", ", true)));
  }
  if (o.output.empty() || !o.dump.empty() || o.position || !o.emit_tri.empty() || o.plain_textures ||
      o.statistics || stereo_of(o) || o.view.supersample > 1 || !o.bands.empty()) {
    throw InputError(
        "--engine: an oracle makes a picture alone; expected -o PICTURE.png without --dump, --emit-tri, "
        "--statistics, --stereo, --supersample and --bands");
  }
  refuse_without_model(o.model, false);
  const Config config = with_lines(find_config(o.config), o.view);
  check_writable(o.output);
  const LoadedScene loaded = load_scene(o.scene, seen_with(config, o.view));
  const Scene& scene = loaded.scene;
  check_scene_range(config, scene);
  std::string why = visibility_refusal(config, scene);
  if (why.empty()) why = own_refusal(*known, config, scene);
  if (!why.empty()) throw InputError(fmt::format("--engine: oracle {} does not draw this: {}", name, why));
  if (known->edges != nullptr) return render_edges(o, *known, config, loaded);
  const Visibility visibility(config, scene, std::vector<double>(scene.triangles.size()));
  const std::vector<Visible> picture = visibility.picture(*known);
  write_png(o.output, scene.width, scene.height, 4, flat_picture(scene, picture));
  const auto seen = std::ranges::count_if(picture, [](const Visible& at) { return at.triangle >= 0; });
  fmt::print("{}: {}x{}, {} triangles, {} pixels covered, {} ({}), {}\n", scene.name, scene.width,
             scene.height, scene.triangles.size(), seen, config.name, config_hash(config), o.engine);
  fmt::print("{}{}", undrawn_note(visibility.vanishing()), faces_line(loaded));
  return exit_held;
}

// A picture, and what it is made of.
struct Drawn {
  Frame frame;
  Counters counters;
};

// The scene of a source, which is whole, in bands of so many rows; the report has no comparison.
Drawn draw_bands(std::unique_ptr<Engine> engine, SceneSource& source, const Config& config, int rows,
                 BandReport& report, std::chrono::duration<double>& seconds) {
  const Scene& scene = *pieces_in_range(source, config)();
  Progress progress(scene.name);
  BandedEngine banded(std::move(engine), config);
  const int bands = number_of_bands(banded_plan(scene).height, rows);
  const auto start = std::chrono::steady_clock::now();
  BandedRun run = run_in_bands(banded, scene, rows, [&](int b) {
    progress.update(static_cast<std::size_t>(b) + 1, static_cast<std::size_t>(bands));
  });
  seconds = std::chrono::steady_clock::now() - start;
  report = figures_of_bands(config, rows, run);
  return {std::move(run.picture), run.counters};
}

int render(const RenderArguments& o) {
  if (o.engine.starts_with(oracle_prefix)) return render_oracle(o);
  const std::optional<Stereo> stereo = stereo_of(o);
  if (o.output.empty() && o.dump.empty() && o.emit_tri.empty()) {
    throw InputError("render: nothing to write; give -o PICTURE.png, --dump DIR or --emit-tri FILE.tri");
  }
  const Config config = with_lines(find_config(o.config), o.view);
  const SceneOptions view = seen_with(config, o.view);
  const auto names = parse_engines(o.engine);
  if (names.size() != 1) {
    throw InputError("--engine: one engine draws one picture");
  }
  if (!engine_runs(names[0], config)) {
    throw InputError(fmt::format("--engine: {}", engine_needs(names[0], config)));
  }
  if (o.statistics && names[0] != "model") {
    throw InputError("--statistics: only the engine model observes its registers");
  }
  if (o.plain_textures && o.emit_tri.empty()) {
    throw InputError("--plain-textures: says how textures are emitted; give --emit-tri FILE.tri too");
  }
  if (o.position && o.dump.empty()) {
    throw InputError("--position: says what a dump has; give --dump DIR too");
  }
  if (o.statistics && o.output.empty() && o.dump.empty()) {
    throw InputError("--statistics: of a drawn picture; give -o PICTURE.png or --dump DIR too");
  }
  const std::vector<int> bands = o.bands.empty() ? std::vector<int>{} : parse_bands(o.bands);
  if (!bands.empty()) {
    if (bands.size() > 1) {
      throw InputError("--bands: one picture has bands of one height; expected one number of rows");
    }
    check_band_engine(names[0]);
    if (o.statistics || (o.output.empty() && o.dump.empty())) {
      throw InputError(
          "--bands: of a drawn picture; expected -o PICTURE.png or --dump DIR, without --statistics");
    }
  }
  const bool is_model = names[0] == "model";
  refuse_without_model(o.model, is_model);
  if (o.statistics && o.model.given()) {
    throw InputError("--statistics: observes the scalar form; leave --form, --target and --threads out");
  }
  EngineOptions how = engine_options(o.model, 0);
  how.winners = !o.dump.empty();
  const ModelOptions as_model = model::model_options(how);
  const ModelForm form = o.statistics ? ModelForm::scalar : model::chosen_form(config, as_model.form);
  check_writable(o.output);
  check_writable(o.emit_tri);
  check_dump(o.dump);
  if (stereo) return render_stereo(o, *stereo, config, view, names[0], how);
  // A scene that is emitted, or drawn once per band, is wanted whole.
  SceneSource source = o.emit_tri.empty() && bands.empty() ? open_scene(o.scene, view)
                                                           : SceneSource(load_scene(o.scene, view));
  const Scene& scene = source.scene();
  if (!bands.empty()) check_bands(bands[0], scene);
  if (!o.output.empty() || !o.dump.empty()) {
    const auto observed = o.statistics ? make_observed_model(config) : nullptr;
    auto unobserved = o.statistics ? nullptr : make_engine(names[0], config, how);
    Engine* engine = o.statistics ? observed.get() : unobserved.get();
    std::chrono::duration<double> drawing{};
    std::optional<Drawn> in_bands;
    BandReport report;
    if (!bands.empty()) {
      in_bands = draw_bands(std::move(unobserved), source, config, bands[0], report, drawing);
    } else {
      Progress progress(scene.name);
      const auto next = pieces_in_range(source, config);
      const Scene* piece = next();
      auto start = std::chrono::steady_clock::now();
      engine->begin(scene);
      // Vectors sort what they are given into bands: the more, the better.
      const std::size_t step = form == ModelForm::scalar ? 1024 : piece_triangles;
      while (piece != nullptr) {
        std::size_t done = 0;
        // A scene without triangles may have commands.
        do {
          const std::size_t n = std::min(step, piece->triangles.size() - done);
          const std::int64_t index = source.first_index() + static_cast<std::int64_t>(done);
          draw_scene(*engine, *piece, done, n, index, nullptr);
          done += n;
          progress.update(static_cast<std::size_t>(source.first_index()) + done, scene.triangles.size());
        } while (done < piece->triangles.size());
        drawing += std::chrono::steady_clock::now() - start;
        piece = next();
        start = std::chrono::steady_clock::now();
      }
    }
    const Frame& frame = in_bands ? in_bands->frame : engine->frame();
    const Counters& c = in_bands ? in_bands->counters : engine->counters();
    const int k = o.view.supersample;
    const std::vector<std::uint8_t> resolved =
        k > 1 ? resolved_picture(names[0], frame, config, k) : std::vector<std::uint8_t>{};
    if (!o.output.empty()) {
      write_png(o.output, frame.width / k, frame.height / k, 4, k > 1 ? resolved : frame.color);
    }
    if (!o.dump.empty()) {
      DumpInfo info{BITSPAN_VERSION, scene.name, names[0], drawing.count(), {}};
      info.supersample = k;
      info.resolved = resolved;
      if (o.position) {
        info.positions = positions_of(config, with_view(source.view()), frame);
      }
      if (is_model) {
        const bool vectors = form != ModelForm::scalar;
        const VectorTarget target =
            as_model.target == VectorTarget::best ? model::best_target() : as_model.target;
        info.model = DumpInfo::Model{std::string(model::to_string(form)),
                                     vectors ? std::string(model::to_string(target)) : "",
                                     o.statistics ? 1 : how.threads};
      }
      write_dump(o.dump, frame, c, config, info);
    }
    const std::string averaged =
        k > 1 ? fmt::format(" averaged to {}x{}", frame.width / k, frame.height / k) : "";
    fmt::print("{}: {}x{}{}, {} triangles, {} fragments, {} written, {} ({}), {}\n", scene.name, frame.width,
               frame.height, averaged, c.triangles, c.fragments, c.written, config.name, config_hash(config),
               names[0]);
    fmt::print("{}", faces_line(source.loaded()));
    if (in_bands) fmt::print("\n{}", bands_text({&report, 1}));
    if (o.statistics) {
      fmt::print("{}", statistics_text(config, observed->statistics()));
    }
  }
  if (!o.emit_tri.empty()) {
    write_tri_file(o.emit_tri, o.plain_textures ? with_plain_textures(scene) : scene);
  }
  return exit_held;
}

int render_turntable(const RenderArguments& o) {
  if (o.output.empty() || !o.dump.empty() || !o.emit_tri.empty()) {
    throw InputError(
        "--turntable: makes pictures alone; expected -o PICTURE.png without --dump and --emit-tri");
  }
  for (int number = 0; number < *o.turntable; ++number) {
    RenderArguments one = o;
    one.turntable.reset();
    one.view.turn = Turn{number, *o.turntable};
    one.output = numbered_output(o.output, *one.view.turn);
    if (const int code = render(one); code != exit_held) return code;
  }
  return exit_held;
}

}  // namespace

void add_render(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("render", "one picture");
  const auto o = std::make_shared<RenderArguments>();
  sub->add_option("scene", o->scene, "stream (.tri, .trib), mesh, demo or extreme/NAME")->required();
  sub->add_option("-o,--output", o->output, "the picture, a PNG");
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option(
         "--engine", o->engine,
         "golden, model, systemc, rtl, ideal or dut:NAME; or oracle:NAME, what an oracle sees: each "
         "triangle in the mean colour of its vertices times the texel in its middle, or white lines where "
         "it is an oracle of edges")
      ->capture_default_str();
  sub->add_flag("--statistics", o->statistics,
                "range, bits used, saturations, wraps and bias of each register");
  sub->add_option("--dump", o->dump, "folder for color, depth, u, v, triangle (.npy) and run.json");
  sub->add_flag(
      "--position", o->position,
      "with --dump: s.npy and position.npy too, each pixel's distance and point back from its depth");
  sub->add_option("--emit-tri", o->emit_tri,
                  "write the triangles as a stream, binary where it ends in .trib; textures beside it");
  sub->add_flag("--plain-textures", o->plain_textures,
                "with --emit-tri: every texture as a PNG, those of a texel format or computed ones decoded");
  const char* const stereo = "Stereo";
  sub->add_option("--stereo", o->stereo,
                  "a picture for each eye: pair, side by side; or anaglyph, red and cyan")
      ->group(stereo);
  sub->add_option(
         "--stereo-by", o->stereo_by,
         "cameras: the scene is drawn from two places; depth: the pixels of one picture move by their depth "
         "(default: cameras)")
      ->group(stereo);
  sub->add_option("--parallax", o->parallax,
                  "pixels that the nearest point moves each way (default: a twentieth of the width)")
      ->group(stereo);
  sub->add_option("--stereo-zero", o->stereo_zero,
                  "what lies in the screen: far, s_max; near, s_min (default: far)")
      ->group(stereo);
  sub->add_option("--turntable", o->turntable,
                  "mesh: N pictures of a full turn about the vertical, by the unit rotate: PICTURE-0.png ...")
      ->check(CLI::Range(1, turn_pictures_limit));
  sub->add_option(
         "--bands", o->bands,
         "draw the picture in bands of so many rows, down to 1, and tell what that saves and repeats")
      ->type_name("ROWS");
  add_model_options(*sub, o->model, "0");
  add_scene_options(*sub, o->view);
  add_supersample(*sub, o->view);
  sub->footer(help_footer("the picture is written, also where a stream covers no pixel",
                          "no face of a mesh is drawn (--allow-empty accepts this)",
                          "bitspan render demo -o demo.png --config narrow --dump demo.dump --position\n"
                          "  bitspan render floor -o floor.png --supersample 4\n"
                          "  bitspan render demo -o demo.png --bands 16\n"
                          "  bitspan render sea.tri -o sea.png --frame 1\n"
                          "  bitspan render spot.obj -o spot.png --engine oracle:painter\n"
                          "  bitspan render spot.obj -o spot.png --stereo anaglyph --parallax 12\n"
                          "  bitspan render teapot.bez -o pot.png --turntable 36"));
  sub->callback([o, &action] { action = [o] { return o->turntable ? render_turntable(*o) : render(*o); }; });
}

}  // namespace bitspan
