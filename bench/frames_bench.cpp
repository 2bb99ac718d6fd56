// SPDX-License-Identifier: Apache-2.0
// Whole frames: bitspan in this process and Mesa's renderers in theirs, turn about.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "bench/likeness.hpp"
#include "bench/mesa_process.hpp"
#include "bench/report.hpp"
#include "bench/scenes.hpp"
#include "config/modes.hpp"
#include "config/store.hpp"
#include "model/engine_model.hpp"

namespace bitspan::bench {
namespace {

// How a section's pictures take their texels.
struct Sampling {
  std::string_view name;
  TextureFilter filter = TextureFilter::nearest;
  MipMode mip = MipMode::none;
};
constexpr Sampling nearest{"nearest", TextureFilter::nearest, MipMode::none};
constexpr Sampling bilinear{"bilinear", TextureFilter::bilinear, MipMode::none};
constexpr Sampling trilinear{"trilinear", TextureFilter::bilinear, MipMode::linear};

std::vector<Sampling> samplings_of(const std::string& scene) {
  if (scene.ends_with("-mip")) return {trilinear};
  if (scene.ends_with("-blend") || scene.ends_with("-shadow") || scene.ends_with("-phong")) return {bilinear};
  if (scene.starts_with("small")) return {nearest};
  return {nearest, bilinear};
}

Config with_sampling(Config config, const Sampling& sampling) {
  config.filter = sampling.filter;
  config.mip = sampling.mip;
  // As OpenGL chooses levels.
  if (has_mip_chain(config.mip)) config.lod = LodMode::gradient;
  check_config(config, config.name);
  return config;
}

// depth20 with widths that no shipped configuration has: nothing of it can have been compiled in.
Config never_seen() {
  Config c = find_config("depth20");
  c.name = "depth20, other widths";
  c.format(FormatId::span_uv).word += 1;  // one bit more below the texel
  c.format(FormatId::texture_frac).word = 7;
  c.format(FormatId::texture_mix).word += 1;
  c.format(FormatId::fog_factor).word += 1;
  c.pixel_reciprocal.index_bits -= 1;
  c.filter = TextureFilter::nearest;  // as the renderer that it is compared with
  check_config(c, c.name);
  return c;
}

// One of bitspan's participants. `same_as`: the participant whose picture it must repeat to the bit.
struct Ours {
  std::string name;
  Config config;
  ModelOptions options;
  std::string_view sampling;
  std::unique_ptr<Engine> engine{};
  Series* series = nullptr;
  int same_as = -1;
  double begin_seconds = 0;  // of the last frame: its part before the first triangle
};

struct Theirs {
  std::string name;
  MesaOptions options;
  std::string_view sampling;
  std::unique_ptr<MesaProcess> process{};
  Series* series = nullptr;
};

bool is_cloud(const std::string& scene) {
  return std::ranges::any_of(clouds(), [&](const Cloud& c) { return scene.starts_with(c.name); });
}

// A ratio of two different pictures, or of a black one, means nothing.
void check_pictures(const std::vector<Ours>& ours, std::vector<Theirs>& theirs, const Scene& scene,
                    Report& report) {
  for (const Ours& o : ours) {
    if (o.same_as < 0 || !o.series->missing.empty()) {
      continue;
    }
    const Ours& other = ours[static_cast<std::size_t>(o.same_as)];
    if (!other.series->missing.empty()) {
      continue;
    }
    const bool same = o.engine->frame().color == other.engine->frame().color &&
                      o.engine->frame().depth == other.engine->frame().depth;
    if (!same) {
      report.notes.push_back(fmt::format("{}: WRONG: {} and {} differ", scene.name, o.name, other.name));
      report.sound = false;
    }
  }
  for (Theirs& t : theirs) {
    if (t.process == nullptr || !t.series->missing.empty()) {
      continue;
    }
    const auto mine = std::ranges::find_if(
        ours, [&](const Ours& o) { return o.sampling == t.sampling && o.series->missing.empty(); });
    if (mine == ours.end()) {
      continue;
    }
    const Likeness l = compare(mine->engine->frame().color, t.process->picture(), scene);
    report.notes.push_back(fmt::format(
        "{} [{}]: picture {} bitspan's: PSNR {:.1f} dB, {:.1f} % of it drawn on, {:.2f} % by one alone",
        t.name, t.process->renderer(), alike(l) ? "is" : "IS NOT", l.psnr, 100 * l.drawn, 100 * l.outside));
    report.sound = report.sound && alike(l);
  }
}

}  // namespace

void bench_frames(const std::string& name, const Options& options, Report& report) {
  const Scene scene = frame_scene(name, options.texture);
  const std::string title = is_cloud(name) || name == "demo" ? name : "mesh";
  Config depth16 = find_config("depth16");
  if (scene.projector) depth16.project = ProjectUnit::reciprocal;
  if (scene.light) {
    depth16.light = LightAt::pixel;
    depth16.light_source = LightSource::point;
  }
  const std::vector<Sampling> samplings = samplings_of(name);
  const bool with_nearest = samplings.front().name == nearest.name;

  std::vector<Ours> ours;
  std::vector<Theirs> theirs;
  for (const Sampling& sampling : samplings) {
    const std::string prefix = fmt::format("{}, {}: ", title, sampling.name);
    const Config config = with_sampling(depth16, sampling);
    const int first = static_cast<int>(ours.size());
    const auto add = [&](const std::string& form, const ModelOptions& o, const Config& c, int same_as) {
      ours.push_back({prefix + form, c, o, sampling.name, nullptr, nullptr, same_as, 0});
    };
    const auto add_mesa = [&](const std::string& form, const std::string& driver, int threads) {
      theirs.push_back({prefix + form, {driver, threads, sampling.filter, 16, sampling.mip}, sampling.name});
    };
    const ModelOptions one{.winners = false};
    const ModelOptions two{.threads = 2, .winners = false};
    add("bitspan", one, config, -1);
    add("bitspan, run-time formats", {.form = ModelForm::vector, .winners = false}, config, first);
    add("bitspan, two threads", two, config, first);
    add_mesa("llvmpipe", "llvmpipe", 0);
    add_mesa("llvmpipe, two threads", "llvmpipe", 2);
    if (sampling.name == nearest.name) {
      add("bitspan, scalar", {.form = ModelForm::scalar, .winners = false}, config, first);
      add_mesa("softpipe", "softpipe", 0);
      if (name.starts_with("big")) {
        add("bitspan, 20-bit depth never seen", {.form = ModelForm::vector, .winners = false}, never_seen(),
            -1);
      }
    }
  }

  // The work of a frame is the number of fragments as the model counts them, whichever renderer draws it.
  std::vector<Turn> turns;
  double work = 0;
  for (Ours& o : ours) {
    o.series = &report.add(o.name, 0);
    try {
      o.engine = make_model(o.config, o.options);
    } catch (const InputError& e) {
      o.series->missing = e.what();
      continue;
    }
    turns.push_back({o.series, [&o, &scene] {
                       const double start = now_seconds();
                       o.engine->begin(scene);
                       o.begin_seconds = now_seconds() - start;
                       draw_scene(*o.engine, scene, 0, scene.triangles.size(), nullptr);
                       return now_seconds() - start;
                     }});
    if (work == 0) {
      turns.back().sample();
      const Counters& c = o.engine->counters();
      work = static_cast<double>(c.fragments) / 1e6;
      report.notes.push_back(fmt::format(
          "{}: {} triangles, {:.2f} M fragments, {:.0f} % of them pass the depth test", title, c.triangles,
          work, 100 * static_cast<double>(c.depth_passed) / static_cast<double>(c.fragments)));
    }
  }
  for (Theirs& t : theirs) {
    t.series = &report.add(t.name, 0);
    try {
      t.process = std::make_unique<MesaProcess>(name, options.texture, t.options);
      turns.push_back({t.series, [&t] { return t.process->draw(); }});
    } catch (const InputError& e) {
      t.series->missing = e.what();
    }
  }
  for (Ours& o : ours) {
    o.series->work = work;
  }
  for (Theirs& t : theirs) {
    t.series->work = work;
  }
  take_turns(title, turns, options.rounds);
  if (const Ours& first = ours.front(); first.series->missing.empty()) {
    report.notes.push_back(
        fmt::format("{}: begin() took {:.2f} ms of the last frame", first.name, 1e3 * first.begin_seconds));
  }
  check_pictures(ours, theirs, scene, report);

  const auto of = [&](std::string_view filter, std::string_view who) {
    const std::string wanted = fmt::format("{}, {}: {}", title, filter, who);
    return &*std::ranges::find(report.series, wanted, &Series::name);
  };
  const double target = scene.projector                    ? 0.5
                        : !is_cloud(name) || !with_nearest ? 0
                        : name.starts_with("small")        ? 3.0
                                                           : 2.0;
  for (const Sampling& sampling : samplings) {
    const std::string_view filter = sampling.name;
    const std::string work_name = fmt::format("frame {}, {}", title, filter);
    report.goals.push_back(
        {work_name, "llvmpipe, one thread", of(filter, "bitspan"), of(filter, "llvmpipe"), target});
    report.goals.push_back({work_name + ", run-time formats", "llvmpipe, one thread",
                            of(filter, "bitspan, run-time formats"), of(filter, "llvmpipe"), 0});
    report.goals.push_back({work_name + ", two threads", "bitspan, one thread",
                            of(filter, "bitspan, two threads"), of(filter, "bitspan"),
                            target == 2 ? 1.7 : 0.0});
    report.goals.push_back({work_name + ", two threads", "llvmpipe, two threads",
                            of(filter, "bitspan, two threads"), of(filter, "llvmpipe, two threads"), 0});
  }
  if (!with_nearest) return;
  report.goals.push_back({fmt::format("frame {}, nearest", title), "softpipe", of("nearest", "bitspan"),
                          of("nearest", "softpipe"), 0});
  report.goals.push_back({fmt::format("frame {}, nearest", title), "bitspan, scalar",
                          of("nearest", "bitspan"), of("nearest", "bitspan, scalar"), 0});
  if (name.starts_with("big")) {
    report.goals.push_back({fmt::format("frame {}, 20-bit depth, run-time formats never seen", title),
                            "llvmpipe, one thread, 16-bit depth",
                            of("nearest", "bitspan, 20-bit depth never seen"), of("nearest", "llvmpipe"),
                            1.5});
  }
}

}  // namespace bitspan::bench
