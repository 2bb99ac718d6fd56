// SPDX-License-Identifier: Apache-2.0
// The table of stages against what the engines deliver: one record per what the table says, made from what it
// says.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>

#include "config/modes.hpp"
#include "engine/registry.hpp"
#include "report/upstream.hpp"
#include "scene/plan.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// "model in affine": each engine that delivers records, in each mode.
struct DrawnRun {
  std::string name;
  Trace trace;
  Counters counters;
  bool has_states = false;  // the draw state changes, to late tests too
};

std::vector<DrawnRun> runs() {
  RandomOptions options;
  options.triangles = 25;
  options.size_max = 60;
  options.mip_chains = true;
  const Scene scene = random_scene(11, options);
  Scene foggy = scene;
  foggy.fog = Fog{{90, 120, 200}, scene.s_max / 2};
  std::vector<DrawnRun> out;
  for (const EngineEntry& entry : engines()) {
    if (!entry.compared) continue;
    const auto draw = [&](Perspective mode, RowSlope slope, const std::string& name,
                          FogMode fog = FogMode::distance) {
      Config config = shipped_config("depth16");
      config.perspective = mode;
      config.row_slope = slope;
      if (!engine_runs(entry.name, config)) return;
      config.mip = MipMode::linear;
      config.lod = has_linear_edges(mode) ? LodMode::zone_s : LodMode::gradient;
      config.fog = fog;
      const auto engine = entry.make(config, {});
      DrawnRun& run = out.emplace_back();
      run.name = std::string(entry.name) + " in " + name;
      engine->begin(has_vertex_fog(fog) ? foggy : scene);
      engine->draw(scene.triangles, 0, &run.trace);
      run.counters = engine->counters();
    };
    for (const Perspective mode : all_perspectives) {
      draw(mode, RowSlope::reciprocal, std::string(to_string(mode)));
    }
    draw(Perspective::delta_f, RowSlope::plane, "rows by planes");
    // Golden has no channels yet.
    if (entry.name != "golden") {
      for (const Perspective mode : all_perspectives) {
        draw(mode, RowSlope::reciprocal, "a channel, " + std::string(to_string(mode)), FogMode::vertex);
      }
      draw(Perspective::delta_f, RowSlope::plane, "a channel, rows by planes", FogMode::vertex);
    }
    {
      Config config = shipped_config("depth16");
      config.project = ProjectUnit::reciprocal;
      Scene projected = scene;
      Random random(12);
      draw_projection(random, projected);
      const auto engine = entry.make(config, {});
      DrawnRun& run = out.emplace_back();
      run.name = std::string(entry.name) + " with a projector";
      run.has_states = true;
      engine->begin(projected);
      draw_scene(*engine, projected, 0, projected.triangles.size(), &run.trace);
      EXPECT_FALSE(run.trace.project.empty()) << run.name;
      run.counters = engine->counters();
    }
    for (const LightAt at : {LightAt::vertex, LightAt::pixel}) {
      Config config = shipped_config("depth16");
      config.light = at;
      config.light_source = LightSource::point;
      Scene lit = scene;
      Random random(13);
      draw_light(random, lit, {.point = true});
      const auto engine = entry.make(config, {});
      DrawnRun& run = out.emplace_back();
      run.name = std::string(entry.name) + " with a light at " + std::string(to_string(at));
      engine->begin(lit);
      engine->draw(lit.triangles, 0, &run.trace);
      EXPECT_FALSE(run.trace.light.empty()) << run.name;
      run.counters = engine->counters();
    }
    {
      Config config = shipped_config("depth16");
      config.line_walk = LineForm::dda;
      Scene wires = scene;
      Random random(14);
      draw_lines(random, wires, 1);
      const auto engine = entry.make(config, {});
      DrawnRun& run = out.emplace_back();
      run.name = std::string(entry.name) + " of lines";
      run.has_states = true;  // its rows are lines
      engine->begin(wires);
      engine->draw(wires.triangles, 0, &run.trace);
      EXPECT_FALSE(run.trace.line_walk.empty()) << run.name;
      run.counters = engine->counters();
    }
    {
      Scene layered = scene;
      for (Triangle& t : layered.triangles) t.v[0].c[3] = t.v[1].c[3] = 0.5;
      layered.commands = {
          {0, StateChange{.settings = {state_setting("translucency.pass", TranslucencyPass::candidate)}}},
          {layered.triangles.size(), Resolve{}}};
      const auto engine = entry.make(shipped_config("depth16"), {});
      DrawnRun& run = out.emplace_back();
      run.name = std::string(entry.name) + " with candidates";
      run.has_states = true;
      engine->begin(layered);
      draw_scene(*engine, layered, 0, layered.triangles.size(), &run.trace);
      EXPECT_FALSE(run.trace.candidate.empty()) << run.name;
      run.counters = engine->counters();
    }
    options.command_probability = 0.5;
    const Scene changing = random_scene(19, options);
    const auto engine = entry.make(shipped_config("depth16"), {});
    DrawnRun& run = out.emplace_back();
    run.name = std::string(entry.name) + " with changes of state";
    run.has_states = true;
    engine->begin(changing);
    draw_scene(*engine, changing, 0, changing.triangles.size(), &run.trace);
    EXPECT_FALSE(run.trace.stencil.empty() || run.trace.merge_alpha.empty()) << run.name;
  }
  return out;
}

// What tells the records of one type apart, by what there is one of them for.
std::vector<std::string_view> identity(const StageRow& row) {
  switch (row.per) {
    case Per::scene:
      return {};
    case Per::change:  // several may stand in front of one triangle
      return {};
    case Per::triangle:
      return {"triangle"};
    case Per::edge:
      return {"triangle", "edge"};
    case Per::row:
      // Rows of constant depth may run along y.
      if (row.type == RecordType::plane_row) return {"triangle", "row"};
      return row.type == RecordType::span || row.type == RecordType::span_channel
                 ? std::vector<std::string_view>{"triangle", "x", "y"}
                 : std::vector<std::string_view>{"triangle", "y"};
    case Per::pixel:
      return {"triangle", "x", "y"};
  }
  return {};
}

TEST(StageTable, EnginesOfThisProgramAreKnownInTheirOrder) {
  EXPECT_EQ(engine_names(), (std::vector<std::string_view>{"golden", "model", "systemc", "ideal"}));
  EXPECT_FALSE(find_engine("ideal").compared);
}

TEST(StageTable, ThereIsOneRecordPerWhatItSays) {
  for (const DrawnRun& run : runs()) {
    for (const StageRow& row : stage_table) {
      const RecordView view = view_of(run.trace, row.type);
      std::set<std::vector<std::int64_t>> seen;
      for (std::size_t i = 0; i < view.records; ++i) {
        std::vector<std::int64_t> key;
        std::vector<std::string_view> fields = identity(row);
        if (row.per_channel()) fields.emplace_back("channel");
        for (const std::string_view field : fields) {
          const int at = field_index(row.type, field);
          ASSERT_GE(at, 0) << row.name << " has no " << field;
          key.push_back(view.record(i)[static_cast<std::size_t>(at)]);
        }
        EXPECT_TRUE(seen.insert(key).second || row.per == Per::change)
            << run.name << ": two records of " << row.name << ", the second " << i;
      }
    }
    if (run.has_states) continue;
    const Counters& c = run.counters;
    const Trace& t = run.trace;
    EXPECT_EQ(t.constants.size(), 1U);
    EXPECT_EQ(t.setup.size(), c.triangles - c.degenerate) << run.name;
    EXPECT_EQ(t.row.size() + t.plane_row.size(), c.rows) << run.name;
    EXPECT_EQ(t.span.size(), c.rows) << run.name;
    EXPECT_EQ(t.fragment.size(), c.fragments) << run.name;
    EXPECT_EQ(t.depth.size(), c.covered) << run.name;
    EXPECT_EQ(t.texture.size(), c.depth_passed) << run.name;
    EXPECT_EQ(t.fog.size(), c.depth_passed - c.killed) << run.name;
    EXPECT_EQ(t.merge.size(), c.written) << run.name;
    EXPECT_GT(c.written, 100U) << run.name;
  }
}

// For every record upstream_of finds what the table says: one record per type that the mode has, of the same
// triangle and pixel; for edge_walk the one or two edges that the row names.
TEST(StageTable, EachRecordIsMadeFromOnesThatThereAre) {
  std::set<RecordType> fed;
  for (const DrawnRun& run : runs()) {
    for (const StageRow& row : stage_table) {
      const RecordView view = view_of(run.trace, row.type);
      const std::size_t step = std::max<std::size_t>(1, view.records / 40);
      for (std::size_t i = 0; i < view.records; i += step) {
        const auto upstream = upstream_of(run.trace, row.type, view.record(i), i);
        for (const RecordType type : row.made_from) {
          if (view_of(run.trace, type).records == 0) continue;  // another mode's
          const auto n = std::ranges::count(upstream, type, &RecordCopy::type);
          // A late depth test comes behind the texture, and not for what that kills.
          const bool of_texture = row.type == RecordType::texture || row.type == RecordType::texture_second;
          const bool late = run.has_states && of_texture && type == RecordType::depth;
          // The second texture unit is on for some of the triangles, and projected for some of these. Only
          // some fragments were candidates.
          const bool off = run.has_states && (type == RecordType::texture_second ||
                                              type == RecordType::project || type == RecordType::candidate);
          // One per channel in use.
          const bool channels = row_of(type).per_channel() && n > 0;
          EXPECT_TRUE(n == 1 || (n == 2 && type == RecordType::edge) || (n == 0 && (late || off)) || channels)
              << run.name << ": record " << i << " of " << row.name << " is made from " << n << " of "
              << row_of(type).name;
          if (n > 0) fed.insert(row.type);
        }
        for (const RecordCopy& from : upstream) {
          for (const std::string_view field : {"triangle", "x", "y"}) {
            const int at = field_index(row.type, field);
            const int there = field_index(from.type, field);
            const bool along = row_of(from.type).per == Per::row && field != "triangle";
            if (at < 0 || there < 0 || along) continue;
            EXPECT_EQ(view.record(i)[static_cast<std::size_t>(at)],
                      from.values[static_cast<std::size_t>(there)]);
          }
        }
      }
    }
  }
  EXPECT_EQ(fed.size(), static_cast<std::size_t>(record_types) - 1) << "constants alone are made from none";
}

}  // namespace
}  // namespace bitspan
