// SPDX-License-Identifier: Apache-2.0
// bitspan explain: one pixel, all stages, all engines side by side.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "config/store.hpp"
#include "engine/range.hpp"
#include "engine/registry.hpp"
#include "report/describe.hpp"
#include "report/edges.hpp"
#include "report/error.hpp"
#include "report/layers.hpp"
#include "report/lockstep.hpp"
#include "report/quadrics.hpp"
#include "report/table.hpp"
#include "report/upstream.hpp"
#include "study/oracles.hpp"

namespace bitspan {
namespace {

struct ExplainArguments {
  std::string scene;
  std::int64_t x = 0, y = 0;
  std::string config{default_config};
  std::string engines = "golden,model,systemc,rtl";
  bool engines_named = false;  // by the user
  bool allow_missing = false;
  std::string oracles;
  bool brief = false;
  SceneOptions view;
};

// A fragment that touched the pixel, with all that led to it, in the order of the pipeline.
struct Touch {
  std::int64_t triangle = 0;
  std::vector<RecordCopy> records;
};

struct Story {
  std::string engine;
  std::vector<Touch> touches;
  std::vector<RecordCopy> constants;
  std::optional<RecordCopy> state;  // in force behind the batches so far; none: the first one
};

// A record's place among those of its type: a span's says which row of constant depth it comes from.
std::optional<std::size_t> place_of(const Trace& trace, const RecordCopy& record) {
  const RecordView view = view_of(trace, record.type);
  for (std::size_t i = 0; i < view.records; ++i) {
    if (std::ranges::equal(view.record(i), record.values)) return i;
  }
  return std::nullopt;
}

// The records of a channel that led to its record r of the pixel, in front of that one, which stands at
// `end`.
void add_channel(const Trace& trace, const RecordView& view, std::size_t r, std::size_t end, Touch& touch) {
  const auto record = view.record(r);
  auto level = upstream_of(trace, view.type, record, r);
  while (!level.empty()) {
    std::erase_if(level, [](const RecordCopy& c) { return !row_of(c.type).per_channel(); });
    if (level.empty()) break;
    touch.records.insert(touch.records.begin() + static_cast<std::ptrdiff_t>(end), level.begin(),
                         level.end());
    const RecordCopy lowest = touch.records[end + level.size() - 1];
    if (level.size() > 1) break;  // of the row and of the triangle: all there is
    level = upstream_of(trace, lowest.type, lowest.values, place_of(trace, lowest));
  }
}

// The records of one batch that touch the pixel.
void collect(const Trace& trace, std::int64_t x, std::int64_t y, Story& story) {
  const RecordView fragments = view_of(trace, RecordType::fragment);
  std::size_t next_state = 0;
  // Draw states come into force in the order of the triangles.
  const auto enter_states = [&](std::int64_t triangle) {
    for (; next_state < trace.state.size() && trace.state[next_state].triangle <= triangle; ++next_state) {
      const auto raw = raw_values(trace.state[next_state]);
      story.state = RecordCopy{RecordType::state, "", {raw.begin(), raw.end()}};
    }
  };
  for (std::size_t i = 0; i < trace.fragment.size(); ++i) {
    const FragmentRecord& f = trace.fragment[i];
    if (f.x != x || f.y != y) {
      continue;
    }
    Touch touch;
    touch.triangle = f.triangle;
    enter_states(f.triangle);
    // Upwards from the fragment: span, row, edges or plane, setup.
    const auto raw = fragments.record(i);
    touch.records.push_back({RecordType::fragment, "", {raw.begin(), raw.end()}});
    auto level = upstream_of(trace, RecordType::fragment, raw, i);
    while (!level.empty() && row_of(level.front().type).per != Per::scene) {
      const RecordCopy lowest = level.front();
      touch.records.insert(touch.records.begin(), level.begin(), level.end());
      level = upstream_of(trace, lowest.type, lowest.values, place_of(trace, lowest));
    }
    for (const StageRow& stage : stage_table) {
      if (stage.per != Per::pixel || stage.type <= RecordType::fragment) continue;
      const RecordView view = view_of(trace, stage.type);
      const auto triangle_at = static_cast<std::size_t>(field_index(stage.type, "triangle"));
      const auto x_at = static_cast<std::size_t>(field_index(stage.type, "x"));
      const auto y_at = static_cast<std::size_t>(field_index(stage.type, "y"));
      for (std::size_t r = 0; r < view.records; ++r) {
        const auto record = view.record(r);
        if (record[triangle_at] == f.triangle && record[x_at] == x && record[y_at] == y) {
          const std::size_t end = touch.records.size();
          touch.records.push_back({stage.type, "", {record.begin(), record.end()}});
          // Of a channel, what led to it stands in front.
          if (stage.per_channel()) add_channel(trace, view, r, end, touch);
          if (!stage.per_channel()) break;
        }
      }
    }
    if (story.state) touch.records.insert(touch.records.begin(), *story.state);
    story.touches.push_back(std::move(touch));
  }
  enter_states(std::numeric_limits<std::int64_t>::max());
  for (const ConstantsRecord& c : trace.constants) {
    const auto raw = raw_values(c);
    story.constants.push_back({RecordType::constants, "", {raw.begin(), raw.end()}});
  }
}

Story run(const std::string& name, const Config& config, const Scene& scene, std::int64_t x, std::int64_t y,
          Frame* frame) {
  Story story;
  story.engine = name;
  const auto engine = make_engine(name, config);
  engine->begin(scene);
  Progress progress(fmt::format("{} {}", name, scene.name));
  Trace trace;
  LockStepOptions steps;
  for (std::size_t done = 0; done < scene.triangles.size();) {
    const std::size_t n = next_batch(scene, done, steps);
    trace.clear();
    draw_scene(*engine, scene, done, n, &trace);
    collect(trace, x, y, story);
    done += n;
    progress.update(done, scene.triangles.size());
  }
  if (frame != nullptr) {
    *frame = engine->frame();
  }
  return story;
}

// One record type of all engines: one row per field; of a draw state, those that are not as in the first one.
bool print_record(const std::vector<Story>& stories, const std::vector<const RecordCopy*>& records,
                  const Config& config, const Scene& scene, const Triangle* triangle) {
  const RecordCopy* reference = records.front();
  if (reference == nullptr) {
    fmt::print("    not delivered by {}\n", stories.front().engine);
    return std::ranges::all_of(records, [](const RecordCopy* r) { return r == nullptr; });
  }
  bool equal = true;
  std::vector<std::vector<std::string>> rows(1);
  rows[0] = {"", "field"};
  for (const Story& story : stories) {
    rows[0].push_back(story.engine);
  }
  for (const char* title : {"value", "ideal", "error", "unit"}) {
    rows[0].emplace_back(title);
  }
  const auto all = fields_of(reference->type);
  const std::int64_t channel = channel_of(reference->type, reference->values);
  const bool is_state = reference->type == RecordType::state;
  const std::vector<std::int64_t> first =
      is_state ? state_values(first_state(config)) : std::vector<std::int64_t>{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_register = is_state && i > 0;  // behind the triangle's index
    const auto as_first = [&](const RecordCopy* r) { return r != nullptr && r->values[i] == first[i - 1]; };
    if (is_register && std::ranges::all_of(records, as_first)) continue;
    std::vector<std::string> row{"", std::string(all[i].name)};
    const std::int64_t raw = reference->values[i];
    const bool integer = all[i].kind == FieldKind::integer;
    for (const RecordCopy* record : records) {
      if (record == nullptr) {
        row.emplace_back("none");
        equal = false;
        row[0] = "*";
        continue;
      }
      row.push_back(integer ? fmt::format("{}", record->values[i])
                            : hex_of(record->values[i], all[i], config, channel));
      if (record->values[i] != raw) {
        row[0] = "*";
        equal = false;
      }
    }
    const double value = decode(raw, all[i], config, channel);
    if (is_register && !state_registers()[i - 1].names.empty()) {
      row.emplace_back(state_registers()[i - 1].names[static_cast<std::size_t>(raw)]);
    } else {
      row.push_back(integer ? "" : fmt::format("{:.10g}", value));
    }
    std::optional<double> ideal;
    if (triangle != nullptr && !is_state) {
      ideal = ideal_value(reference->type, all[i].name, reference->values, config, scene, *triangle);
    }
    row.push_back(ideal ? fmt::format("{:.10g}", *ideal) : "");
    row.push_back(ideal ? fmt::format("{:.3g}", value - *ideal) : "");
    row.emplace_back(unit_of(all[i], config, channel));
    rows.push_back(std::move(row));
  }
  fmt::print("{}", text_table(rows));
  return equal;
}

// What the oracles say of the pixel.
struct OracleWords {
  std::vector<std::string> lines;  // one per oracle
  bool held = true;
  bool left_out = false;
  bool some_draws = false;
};
// Adds what each oracle sees at the pixel to the rows of the picture.
OracleWords ask_oracles(const ExplainArguments& o, std::span<const Oracle* const> oracles,
                        const Config& config, const Scene& scene, const Frame& frame,
                        const std::string& engine, std::vector<std::vector<std::string>>& rows) {
  OracleWords out;
  if (oracles.empty()) return out;
  const std::optional<ShadowPlan> plan = shadow_plan_of(config, scene);
  const Scene& shown = plan ? plan->picture : scene;
  std::optional<Frame> of_picture;
  if (plan) of_picture = frame_of_picture(*plan, frame);
  const Frame& of_shown = of_picture ? *of_picture : frame;
  std::string refusal;
  const std::optional<Visibility> visibility = visibility_of(config, shown, refusal);
  const std::optional<Scene> own = by_distance(config, shown);
  const std::optional<Scene> layered = layered_picture_of(scene);
  const auto at = static_cast<std::size_t>(o.y * shown.width + o.x);
  const auto tell = [&](const Oracle& oracle, std::string_view what, std::string_view against,
                        const PixelFinding& found) {
    out.lines.push_back(
        fmt::format("oracle {}{} against {}: {}", oracle.name, what, against, pixel_text(found)));
    if (oracle.is_truth && found.verdict == PixelVerdict::unexplained) out.held = false;
  };
  for (const Oracle* oracle : oracles) {
    const bool by_layers = layered && oracle->has_layers;
    const std::string why = by_layers                  ? layer_refusal(config, *layered)
                            : oracle->edges != nullptr ? visibility_refusal(config, shown)
                            : visibility               ? own_refusal(*oracle, config, shown)
                                                       : refusal;
    if (!why.empty()) {
      out.lines.push_back(fmt::format("oracle {} left out: {}", oracle->name, why));
      out.left_out = true;
      continue;
    }
    out.some_draws = true;
    if (by_layers) {
      golden::ABuffer lists = golden::make_abuffer(config, *layered);
      tell(*oracle, "", engine, layer_findings(config, *layered, lists, frame, engine).at(at));
      for (std::string& line : layers_text(config, lists.pixels.at(at))) out.lines.push_back(std::move(line));
      continue;
    }
    if (oracle->edges != nullptr) {
      const Scene& taken = own ? *own : shown;
      const SeenEdges seen = seen_edges(*oracle, config, taken);
      const std::vector<EdgeAt> here = edges_at(*oracle, taken, seen, o.x, o.y);
      for (const EdgeAt& edge : here) tell(*oracle, ", " + edge_text(edge), "rays", edge.found);
      if (here.empty()) out.lines.push_back(fmt::format("oracle {}: no edge passes", oracle->name));
      continue;
    }
    const std::vector<Visible> picture = visibility->picture(*oracle);
    const Visible& seen = picture[at];
    const std::int64_t triangle =
        seen.triangle < 0 || !plan ? seen.triangle : seen.triangle + static_cast<std::int64_t>(plan->first);
    rows.push_back({std::string(oracle->name), fmt::format("{}", triangle),
                    fmt::format("h {:.10g}", visibility->depth_of(seen)), "-", "-", "-", "-", "-"});
    tell(*oracle, "", engine, visibility->at(*oracle, picture, of_shown, engine, o.x, o.y));
    if (judges_quadrics(*oracle, *visibility)) {
      tell(*oracle, "_quadrics", engine,
           quadric_finding(*visibility, *oracle, picture, of_shown, engine, o.x, o.y));
    }
    if (!plan || !oracle->has_shadows) continue;
    const VisibilityReport report = visibility->compare(*oracle, picture, of_shown, engine);
    tell(*oracle, "_shadows", engine, shadows_of(config, *plan, picture, report, {})[at]);
  }
  return out;
}

int explain(const ExplainArguments& o) {
  const Config config = with_lines(find_config(o.config), o.view);
  std::vector<const Oracle*> oracles;
  if (!o.oracles.empty()) oracles = parse_oracles(o.oracles);
  const LoadedScene loaded = load_scene(o.scene, seen_with(config, o.view));
  const Scene& scene = loaded.scene;
  const View shown = view_at(scene, scene.triangles.size());
  if (o.x < 0 || o.y < 0 || o.x >= shown.width || o.y >= shown.height) {
    throw InputError(fmt::format("explain: pixel ({}, {}) is outside the picture of {}x{}", o.x, o.y,
                                 shown.width, shown.height));
  }
  check_scene_range(config, scene);
  std::vector<Story> stories;
  std::vector<Frame> frames;
  std::vector<std::string> left_out;
  for (const std::string& name : parse_engines(o.engines)) {
    if (!find_engine(name).compared) continue;  // the truth is a column of its own
    if (!engine_runs(name, config)) {
      left_out.push_back(fmt::format("{} left out: {}", name, engine_needs(name, config)));
      continue;
    }
    frames.emplace_back();
    stories.push_back(run(name, config, scene, o.x, o.y, &frames.back()));
  }
  if (stories.empty()) {
    throw InputError("--engines: name at least one of golden, model, systemc, rtl");
  }
  const std::string truth(truth_name());
  Frame ideal;
  run(truth, config, scene, o.x, o.y, &ideal);

  fmt::print("pixel ({}, {}) of {}, configuration {} ({})\n", o.x, o.y, scene.name, config.name,
             config_hash(config));
  fmt::print("{}", faces_line(loaded));
  bool equal = true;
  std::size_t touches = 0;
  for (const Story& story : stories) {
    touches = std::max(touches, story.touches.size());
  }
  fmt::print("fragments on it: {}\n", touches);
  Scene seen;  // what the closed form takes: one view
  static_cast<View&>(seen) = scene;
  seen.textures = scene.textures;
  seen.commands = scene.commands;
  const auto print_type = [&](const std::vector<const RecordCopy*>& records, RecordType type,
                              const Triangle* triangle) {
    fmt::print("\n  {}\n", stage_of(type));
    equal = print_record(stories, records, config, seen, triangle) && equal;
  };
  if (touches > 0 && !o.brief) {
    // One per view.
    for (std::size_t k = 0; k < stories.front().constants.size(); ++k) {
      std::vector<const RecordCopy*> constants;
      for (const Story& story : stories) {
        constants.push_back(k < story.constants.size() ? &story.constants[k] : nullptr);
      }
      print_type(constants, RecordType::constants, nullptr);
    }
  }
  // In front of a triangle; behind the last one, what is shown.
  const auto target_text = [&, several = targets_of(scene.commands).size() > 1](std::size_t triangle) {
    return several ? fmt::format(", target {}", target_at(scene.commands, triangle)) : "";
  };
  for (std::size_t t = 0; t < touches; ++t) {
    const Touch* first = nullptr;
    for (const Story& story : stories) {
      if (first == nullptr && t < story.touches.size()) {
        first = &story.touches[t];
      }
    }
    const auto index = static_cast<std::size_t>(first->triangle);
    const Triangle& triangle = scene.triangles[index];
    fmt::print("\nfragment {} of {}: {} {}{}\n", t + 1, touches, triangle.is_line ? "line" : "triangle",
               first->triangle, target_text(index));
    // The closed form takes the triangle's view.
    static_cast<View&>(seen) = view_at(scene, index);
    for (std::size_t r = 0; r < first->records.size(); ++r) {
      const RecordType type = first->records[r].type;
      const Per per = row_of(type).per;
      if (o.brief && per != Per::pixel && per != Per::change) {
        continue;
      }
      std::vector<const RecordCopy*> records;
      for (const Story& story : stories) {
        const bool has = t < story.touches.size() && r < story.touches[t].records.size() &&
                         story.touches[t].records[r].type == type;
        records.push_back(has ? &story.touches[t].records[r] : nullptr);
      }
      print_type(records, type, &triangle);
    }
  }
  const std::size_t at =
      static_cast<std::size_t>(o.y) * static_cast<std::size_t>(ideal.width) + static_cast<std::size_t>(o.x);
  fmt::print("\npicture at ({}, {}){}\n", o.x, o.y, target_text(scene.triangles.size()));
  std::vector<std::vector<std::string>> rows{{"engine", "triangle", "depth", "u", "v", "R", "G", "B"}};
  const auto add = [&](const std::string& engine, const Frame& f) {
    const std::uint8_t* c = &f.color[4 * at];
    rows.push_back({engine, fmt::format("{}", f.triangle[at]), fmt::format("{}", f.depth[at]),
                    std::isnan(f.u[at]) ? "-" : fmt::format("{:.10g}", f.u[at]),
                    std::isnan(f.v[at]) ? "-" : fmt::format("{:.10g}", f.v[at]), fmt::format("{}", c[0]),
                    fmt::format("{}", c[1]), fmt::format("{}", c[2])});
  };
  for (std::size_t i = 0; i < stories.size(); ++i) {
    add(stories[i].engine, frames[i]);
    equal = equal && frames[i].triangle[at] == frames[0].triangle[at] &&
            frames[i].depth[at] == frames[0].depth[at] &&
            std::equal(&frames[i].color[4 * at], &frames[i].color[4 * at] + 4, &frames[0].color[4 * at]);
  }
  add(truth, ideal);
  const OracleWords words = ask_oracles(o, oracles, config, scene, frames[0], stories[0].engine, rows);
  fmt::print("{}", text_table(rows));
  fmt::print("\n");
  for (const std::string& text : words.lines) fmt::print("{}\n", text);
  const bool missing = o.engines_named && !o.allow_missing && !left_out.empty();
  for (const std::string& text : left_out) fmt::print("{}: {}\n", missing ? "FAILED" : "note", text);
  const bool may_leave_out = o.allow_missing || (o.oracles == "all" && words.some_draws);
  const bool oracles_held = words.held && (may_leave_out || !words.left_out);
  fmt::print("{}\n", !equal                ? "the engines DIFFER on this pixel (marked *)"
                     : stories.size() == 1 ? "one engine: nothing was compared"
                                           : "all engines agree on this pixel");
  return equal && !missing && oracles_held ? exit_held : exit_difference;
}

}  // namespace

void add_explain(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("explain", "one pixel: all stages, all engines side by side");
  const auto o = std::make_shared<ExplainArguments>();
  sub->add_option("scene", o->scene, "stream (.tri, .trib), mesh, demo or extreme/NAME")->required();
  sub->add_option("x", o->x, "pixel column, 0 at the left")->required();
  sub->add_option("y", o->y, "pixel row, 0 at the top")->required();
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option("--engines", o->engines, "columns, in this order")->capture_default_str();
  sub->add_option("--oracles", o->oracles, "what these oracles see there: names, or all");
  sub->add_flag("--brief", o->brief, "from the fragment on; without setup, rows and spans");
  add_scene_options(*sub, o->view);
  sub->add_flag("--allow-missing", o->allow_missing, "an engine of --engines, or an oracle, may be left out");
  sub->footer(help_footer(
      "the engines agree on the pixel, or one is shown alone",
      "they differ there, or from an oracle, one named is left out, or no face of a mesh is drawn",
      "bitspan explain demo 320 300 --config narrow\n"
      "  bitspan explain demo 320 300 --oracles all"));
  sub->callback([o, sub, &action] {
    o->engines_named = sub->count("--engines") > 0;
    action = [o] { return explain(*o); };
  });
}

}  // namespace bitspan
