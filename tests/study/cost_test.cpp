// SPDX-License-Identifier: Apache-2.0
// The two analytic costs against hand counts, the model's own registers and docs/search.md.
#include "study/cost.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <span>

#include "config/check.hpp"
#include "model/engine_model.hpp"
#include "scene/demo.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// Every combination of the modes that decide which registers exist.
std::vector<Config> all_modes(const Config& base) {
  std::vector<Config> list;
  for (const Perspective perspective : all_perspectives) {
    for (const auto walk : {EdgeWalk::exact, EdgeWalk::dda}) {
      for (const auto edge : {SlopeForm::divide, SlopeForm::reciprocal}) {
        for (const auto row : {RowSlope::divide, RowSlope::reciprocal, RowSlope::plane}) {
          for (const auto code : {DepthCode::inverse, DepthCode::linear, DepthCode::opengl}) {
            for (const auto filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
              for (const auto fog : {FogMode::none, FogMode::linear, FogMode::table}) {
                Config c = base;
                c.perspective = perspective;
                c.edge_walk = walk;
                c.edge_slope = edge;
                c.row_slope = row;
                c.depth_code = code;
                c.filter = filter;
                c.fog = fog;
                if (!first_violation(c)) list.push_back(c);
              }
            }
          }
        }
      }
    }
  }
  return list;
}

double bits_of(const std::vector<RegisterPlace>& places, std::string_view stage) {
  double bits = 0;
  for (const RegisterPlace& p : places) bits += p.stage == stage ? p.word * p.times : 0;
  return bits;
}

double bits_of(const std::vector<Multiplier>& products, std::string_view stage) {
  double bits = 0;
  for (const Multiplier& m : products) bits += m.stage == stage ? m.a * m.b * m.times : 0;
  return bits;
}

// Counted by hand from config/depth16.toml and docs/numeric-spec.md.
TEST(Cost, Depth16ByHand) {
  const Config c = shipped_config("depth16");
  const std::vector<RegisterPlace> places = register_places(c);
  EXPECT_EQ(bits_of(places, "constants"), 2 * 36 + 38);
  EXPECT_EQ(bits_of(places, "setup"), 6 * 20 + 36 + 3 * 34 + 6 * 25 + 12 * 13);
  EXPECT_EQ(bits_of(places, "setup.edge"), 3 * 41 + 2 * 42 + 6 * 48 + 12 * 24);
  const int newton = 23 + 13 + 26 + 25;  // nq, y(0), a, y
  EXPECT_EQ(bits_of(places, "edge_walk"),
            2 * 28 + 2 * 36 + 2 * 34 + 4 * 44 + 19 + 4 * 25 + 8 * 19 + 8 * 13 + newton);
  EXPECT_EQ(bits_of(places, "span_setup"), 21 + 38 + 2 * 40 + 2 * 42 + 4 * 24);
  EXPECT_EQ(bits_of(places, "span"), 34 + 2 * 42 + 4 * 19 + 19 + 2 * 25 + 4 * 13 + newton);
  EXPECT_EQ(bits_of(places, "depth"), 16);
  EXPECT_EQ(bits_of(places, "texture"), 3 * 12 + 3 * 12 + 2 * 11);
  EXPECT_EQ(bits_of(places, "fog"), 10 + 3 * 12);
  EXPECT_EQ(bits_of(places, "merge"), 3 * 8);
  EXPECT_EQ(register_bits(c), 3192);

  const std::vector<Multiplier> products = multipliers(c);
  const int unit = 23 * 13 + 13 * 26;
  EXPECT_EQ(bits_of(products, "setup"), 2 * 21 * 21 + 38 * 36);
  EXPECT_EQ(bits_of(products, "setup.edge"), 2 * 26 * 39);
  EXPECT_EQ(bits_of(products, "edge_walk"),
            21 * 20 + 41 * 20 + 2 * 48 * 20 + 4 * 24 * 20 + unit + 2 * 44 * 19);
  EXPECT_EQ(bits_of(products, "span_setup"),
            2 * 26 * 39 + 35 * 21 + 2 * 40 * 21 + 4 * 14 * 21 + 38 * 29 + 2 * 42 * 29 + 4 * 24 * 29);
  EXPECT_EQ(bits_of(products, "span"), unit + 2 * 42 * 19);
  EXPECT_EQ(bits_of(products, "depth"), 0);
  EXPECT_EQ(bits_of(products, "texture"), 3 * 12 * 13 + 11 * 13);
  EXPECT_EQ(bits_of(products, "fog"), 3 * 13 * 10);
  EXPECT_EQ(bits_of(products, "merge"), 3 * 13 * 11);
  EXPECT_EQ(product_bits(c), 27271);

  // Factors of 13 bits: those of alpha, which has 10 fraction bits, as signed numbers up to 2.
  Config equation = c;
  equation.rtl.blend = RtlBlend::equation;
  EXPECT_EQ(bits_of(register_places(equation), "merge"), 4 * 8);
  EXPECT_EQ(bits_of(multipliers(equation), "merge"), 3 * 12 * 13 + 5 * 8 * 13);

  EXPECT_EQ(table_bits(c), 2 * 512 * 13 + 1024 * 10);

  std::map<std::string, double, std::less<>> metrics{{"other", 1.0}};
  add_costs(c, metrics);
  EXPECT_EQ(metrics, (std::map<std::string, double, std::less<>>{{"other", 1.0},
                                                                 {"cost.register_bits", 3192.0},
                                                                 {"cost.product_bits", 27271.0},
                                                                 {"cost.table_bits", 23552.0}}));
}

// The stages that other modes have, by hand from the same widths.
TEST(Cost, OtherModesByHand) {
  Config c = shipped_config("depth16");
  c.perspective = Perspective::const_depth_rows;
  c.depth_code = DepthCode::linear;
  c.filter = TextureFilter::bilinear;
  c.fog = FogMode::linear;
  const int newton = 23 + 13 + 26 + 25;
  EXPECT_EQ(bits_of(register_places(c), "constants"), 2 * 36 + 38 + 50 + 30 + 40);
  EXPECT_EQ(bits_of(register_places(c), "setup.edge"), 0);
  EXPECT_EQ(bits_of(register_places(c), "edge_walk"), 0);
  EXPECT_EQ(bits_of(register_places(c), "plane_walk"),
            6 * 42 + 2 * 41 + 4 * 50 + 8 * 26 + 22 + 2 * 42 + 4 * 42);
  EXPECT_EQ(bits_of(register_places(c), "span_setup"), 21 + 4 * 34 + 8 * 24);
  EXPECT_EQ(bits_of(register_places(c), "span"), 34 + 2 * 33 + 4 * 19 + 20 + 19 + 2 * 25 + 4 * 13 + newton);
  EXPECT_EQ(bits_of(register_places(c), "texture"), 2 * 8 + 9 * 12 + 3 * 12 + 8 * 11);

  const int unit = 23 * 13 + 13 * 26;
  const int d = 21, centre = 21, line = 17 + 20 + 1;
  EXPECT_EQ(bits_of(multipliers(c), "plane_walk"), 2 * 25 * 39 + 4 * 35 * d + 8 * 43 * d + 16 * 14 * d +
                                                       22 * 16 + 41 * centre + 41 * line + 4 * 50 * centre +
                                                       8 * 26 * centre);
  EXPECT_EQ(bits_of(multipliers(c), "span_setup"), 2 * 42 * 21 + 4 * 42 * 21);
  EXPECT_EQ(bits_of(multipliers(c), "span"), unit);
  EXPECT_EQ(bits_of(multipliers(c), "depth"), 50 * 19);
  EXPECT_EQ(bits_of(multipliers(c), "texture"), 6 * 9 * 8 + 3 * 13 * 8 + 3 * 12 * 8 + 3 * 12 * 13 + 11 * 13);
  EXPECT_EQ(bits_of(multipliers(c), "fog"), 40 * 19 + 3 * 13 * 10);
  EXPECT_EQ(table_bits(c), 512 * 13);

  // ideal_line: gu along the ideal line too, and k gu_N.
  const double before = bits_of(multipliers(c), "plane_walk");
  c.numerator = Numerator::ideal_line;
  EXPECT_EQ(bits_of(multipliers(c), "plane_walk") - before, 2 * 50 * (line - centre) + 2 * 22 * 50);

  // Edges by a dda and a table reciprocal.
  Config e = shipped_config("depth16");
  e.edge_walk = EdgeWalk::dda;
  e.edge_slope = SlopeForm::reciprocal;
  e.edge_reciprocal.kind = ReciprocalKind::lut_linear;
  e.edge_reciprocal.operand_bits = 20;
  e.edge_reciprocal.index_bits = 8;
  e.edge_reciprocal.table_bits = 22;
  e.edge_reciprocal.internal_bits = 24;
  const Config plain = shipped_config("depth16");
  EXPECT_EQ(register_bits(e) - register_bits(plain), 23 + 3 * 36 + 2 * 34 + 21 + 2 * 23 + 25);
  EXPECT_EQ(product_bits(e) - product_bits(plain),
            23 * 12 + 21 * 23 + 35 * 23 + 2 * 42 * 23 + 4 * 14 * 23 + 36 * 20 - 21 * 20);
  EXPECT_EQ(table_bits(e) - table_bits(plain), 257 * 23);

  // gl and gr; no reciprocal at a pixel; a row's dividers have no multiplier.
  Config h = plain;
  h.perspective = Perspective::hyperbolic;
  EXPECT_EQ(bits_of(multipliers(h), "span"), 0);
  EXPECT_EQ(bits_of(multipliers(h), "span_setup") - bits_of(multipliers(plain), "span_setup"),
            4 * 25 * 39 - 2 * 26 * 39 + 2 * 21);
  EXPECT_EQ(register_bits(h) - register_bits(plain), 2 * 40 - 19 - newton);
  h.row_slope = RowSlope::divide;
  EXPECT_EQ(bits_of(multipliers(h), "span_setup"), 4 * 25 * 39 + 38 * 29 + 2 * 42 * 29 + 4 * 24 * 29);

  Config a = plain;
  a.perspective = Perspective::affine;
  EXPECT_EQ(bits_of(multipliers(a), "setup.edge"), 0);
  EXPECT_EQ(bits_of(multipliers(a), "span_setup"),
            35 * 21 + 2 * 26 * 21 + 4 * 14 * 21 + 38 * 29 + 2 * 34 * 29 + 4 * 24 * 29);
}

// What the model writes to in a run is what is counted, in every mode.
TEST(Cost, TheRegistersCountedAreThoseThatTheModelUses) {
  const Scene scene = demo_scene(64, 48);
  std::size_t modes = 0;
  for (const Config& c : all_modes(shipped_config("depth16"))) {
    const auto engine = make_observed_model(c);
    engine->begin(scene);
    engine->draw(std::span(scene.triangles), 0, nullptr);
    std::set<std::string> observed, counted;
    for (int i = 0; i < model::register_count; ++i) {
      const auto id = static_cast<model::RegisterId>(i);
      if (engine->statistics().of(id).count > 0) observed.emplace(model::name_of(id));
    }
    for (const RegisterRule& r : register_rules()) {
      // The phase is exact: no quantisation, nothing observed.
      if (r.used(c) && r.name != "phase") counted.emplace(r.name);
    }
    // Without fog the factor is the constant 1, which the model quantises for its record all the same.
    if (c.fog == FogMode::none) observed.erase("fog.factor");
    EXPECT_EQ(observed, counted) << to_toml(c);
    ++modes;
    if (HasFailure()) break;
  }
  EXPECT_GT(modes, 400U);
}

// A bit more in a register that is used costs its places; in one that is not, nothing.
TEST(Cost, ABitCostsWhatItsPlacesSay) {
  for (const Config& c : all_modes(shipped_config("depth16"))) {
    for (int i = 0; i < format_count; ++i) {
      const auto id = static_cast<FormatId>(i);
      int times = 0;
      for (const RegisterRule& r : register_rules()) {
        if (r.used(c) && r.name == key_of(id)) times += r.times;
      }
      Config wider = c;
      ++wider.format(id).word;  // one fraction bit
      if (id == FormatId::plane_k && c.perspective == Perspective::const_depth_rows) ++times;  // phase
      EXPECT_EQ(register_bits(wider) - register_bits(c), times) << key_of(id);
      if (times == 0) {
        EXPECT_EQ(product_bits(wider), product_bits(c)) << key_of(id);
      } else {
        EXPECT_GE(product_bits(wider), product_bits(c)) << key_of(id);
      }
    }
    if (HasFailure()) break;
  }
}

// Modes beside those of all_modes: together they use every key.
std::vector<Config> further_modes() {
  std::vector<Config> list;
  const auto add = [&list](const Config& c) {
    if (!first_violation(c)) list.push_back(c);
  };
  const Config base = shipped_config("depth16");
  for (const auto fog : {FogMode::distance, FogMode::log, FogMode::vertex}) {
    Config c = base;
    c.fog = fog;
    add(c);
    c.row_slope = RowSlope::plane;
    add(c);
  }
  for (const auto mip : {MipMode::nearest, MipMode::linear}) {
    for (const auto lod : {LodMode::zone_s, LodMode::zone_d, LodMode::gradient, LodMode::finite}) {
      Config c = base;
      c.mip = mip;
      c.lod = lod;
      add(c);
    }
  }
  for (const auto kind : {ReciprocalKind::lut_linear, ReciprocalKind::lut_quadratic}) {
    Config c = base;
    c.edge_walk = EdgeWalk::dda;
    c.edge_slope = SlopeForm::reciprocal;
    for (Reciprocal* r : {&c.edge_reciprocal, &c.row_reciprocal, &c.pixel_reciprocal}) {
      r->kind = kind;
      r->operand_bits = 20;
      r->index_bits = 8;
      r->table_bits = 22;
      r->internal_bits = 24;
    }
    add(c);
    for (Reciprocal* r : {&c.edge_reciprocal, &c.row_reciprocal, &c.pixel_reciprocal}) {
      r->kind = ReciprocalKind::lut_newton;
      r->steps = 1;
    }
    add(c);
  }
  Config projects = base;
  projects.project = ProjectUnit::reciprocal;
  add(projects);
  projects.row_slope = RowSlope::plane;
  add(projects);
  for (const LightAt at : {LightAt::pixel, LightAt::vertex}) {
    Config lit = base;
    lit.light = at;
    if (lights_pixels(at)) {
      lit.light_normal = LightNormal::map;
      lit.light_shadow = LightShadow::map;
    }
    add(lit);
    lit.light_source = LightSource::point;
    lit.light_law = LightLaw::lunar;
    lit.light_fall = LightFall::second;
    add(lit);
    lit.row_slope = RowSlope::plane;
    add(lit);
  }
  Config own_lines = base;
  own_lines.shade_lines = ShadeLines::perspective;
  own_lines.depth_line = DepthLine::z;
  own_lines.second_coordinates = SecondCoordinates::own;
  add(own_lines);
  own_lines.row_slope = RowSlope::plane;
  add(own_lines);
  Config subspans = base;
  subspans.subspan_bits = 4;
  add(subspans);
  Config cached = base;
  cached.memory.depth_cache.mode = cached.memory.color_cache.mode = BufferCacheMode::write_back;
  add(cached);
  return list;
}

// Keys of widths whose value rightly costs nothing.
const std::map<std::string, std::string, std::less<>> free_keys{
    {"formats.merge.color.word", "a stored colour has 8 bits: no other word is legal"},
    {"formats.curve.d0.word", "a unit beside the pipeline"},
    {"formats.curve.d1.word", "a unit beside the pipeline"},
    {"formats.curve.d2.word", "a unit beside the pipeline"},
    {"formats.curve.d3.word", "a unit beside the pipeline"},
    {"formats.rotate.t.word", "a unit beside the pipeline"},
    {"formats.rotate.s.word", "a unit beside the pipeline"},
    {"formats.rotate.xy.word", "a unit beside the pipeline"},
};

// Whether the key is a width, or the size of a cache.
bool is_width(const Key& key) {
  const std::string_view name = key.name();
  const bool of_cache = name.ends_with("_line_bytes") || name.ends_with("_sets") || name.ends_with("_ways");
  return name == "word" || name == "bits" || name.ends_with("_bits") || of_cache;
}

TEST(Cost, AProjectorByHand) {
  const Config without = shipped_config("depth16");
  Config c = without;
  c.project = ProjectUnit::reciprocal;
  const std::vector<RegisterPlace> places = register_places(c);
  const int newton = 23 + 13 + 26 + 25;
  EXPECT_EQ(bits_of(places, "constants"), 2 * 36 + 38 + 38 + 44);
  EXPECT_EQ(bits_of(places, "setup.channel"), 3 * (3 * 36 + 3 * 48 + 3 * 52));
  EXPECT_EQ(bits_of(places, "project"), 3 * 48 + 19 + 2 * 25 + 38 + 40 + 16 + newton);
  const int unit = 23 * 13 + 13 * 26;
  EXPECT_EQ(bits_of(multipliers(c), "setup.channel"), 3 * 36 * 39);
  EXPECT_EQ(bits_of(multipliers(c), "project"), unit + 2 * 48 * 19 + 39 * 19 + 44 * 38);
  EXPECT_EQ(table_bits(c) - table_bits(without), 512 * 13);
}

// N and L of length 1 with a root each: two Newton steps of three products.
TEST(Cost, ALightByHand) {
  const Config without = shipped_config("depth16");
  Config c = without;
  c.light = LightAt::vertex;
  const std::vector<RegisterPlace> places = register_places(c);
  EXPECT_EQ(bits_of(places, "light"),
            22 + 3 * 20 + 2 * 20 + 18 + 16 + 3 * c.format(FormatId::texture_color).word);
  const int root = 22 * 11 + 26 * 11 + 11 * 26 + 22 * 25 + 26 * 25 + 25 * 26;
  const int color = c.format(FormatId::texture_color).word;
  const int by_light = 3 * 20 * 20 + 20 * 20 + 19 * 9 + 16 * 20 + 16 * 18 + 3 * color * 16;
  EXPECT_EQ(bits_of(multipliers(c), "light"), 3 * 20 * 20 + root + 3 * 20 * 22 + by_light);
  EXPECT_EQ(table_bits(c) - table_bits(without), 128 * 10 + 513 * 18);
  c.light_source = LightSource::point;
  const int s = c.format(FormatId::setup_s).word;
  EXPECT_EQ(bits_of(multipliers(c), "light"), 3 * 20 * 20 + root + 3 * 20 * 22 + by_light + s * 24 +
                                                  2 * (c.coordinate_bits + 5) * (s + 24) + 3 * 33 * 33 +
                                                  root + 3 * 33 * 22);
  EXPECT_EQ(table_bits(c) - table_bits(without), 2 * 128 * 10 + 513 * 18);
  const auto more = [before = c](const Config& now) {
    return bits_of(multipliers(now), "light") - bits_of(multipliers(before), "light");
  };
  Config lunar = c;
  lunar.light_law = LightLaw::lunar;
  EXPECT_EQ(more(lunar), 20 * 20 + root + 22 * 22 + 20 * 24);
  Config falls = c;
  falls.light_fall = LightFall::second;
  EXPECT_EQ(more(falls), 3 * 33 * 20 + 32 * 24 + 28 * 28 + root + 22 * 22 + 18 * 16);
  falls.light_fall_to = LightFallTo::viewer;
  EXPECT_EQ(more(falls),
            3 * 32 * 32 + root + 3 * 32 * 22 + 3 * 32 * 20 + 32 * 24 + 28 * 28 + root + 22 * 22 + 18 * 16);
  EXPECT_EQ(table_bits(lunar) - table_bits(c), 128 * 10);
  // One root divides; another one leads to the viewer, or through a map's field while L in the view is in
  // use.
  EXPECT_EQ(table_bits(falls) - table_bits(c), 2 * 128 * 10);
  const auto light_bits = [](const Config& now) { return bits_of(register_places(now), "light"); };
  Config to_light = falls;
  to_light.light_fall_to = LightFallTo::light;
  EXPECT_EQ(light_bits(falls) - light_bits(to_light), 22 + 3 * 20);
  to_light.light = LightAt::pixel;
  Config relief = to_light;
  relief.light_normal = LightNormal::map;
  EXPECT_EQ(light_bits(relief) - light_bits(to_light), 22 + 3 * 20);
  EXPECT_EQ(table_bits(relief) - table_bits(to_light), 128 * 10);
  const int across = 1 + std::max(c.format(FormatId::relief_value).word, c.format(FormatId::span_uv).word);
  EXPECT_GE(bits_of(multipliers(relief), "light") - bits_of(multipliers(to_light), "light"),
            3 * across * across + root + 3 * across * 22);
}

TEST(Cost, EveryWidthMovesACost) {
  std::vector<Config> modes = all_modes(shipped_config("depth16"));
  std::ranges::copy(further_modes(), std::back_inserter(modes));
  const std::vector<Scene> scenes{demo_scene(64, 48)};
  const auto costs_of = [&scenes](const Config& c) {
    std::map<std::string, double, std::less<>> out;
    add_costs(c, out);
    add_memory(c, scenes, out);
    return out;
  };
  std::size_t widths = 0;
  for (const Key& key : keys()) {
    if (!is_width(key)) continue;
    ++widths;
    const bool moves = std::ranges::any_of(modes, [&](const Config& c) {
      if (!is_used(c, key)) return false;
      const auto value = std::get<std::int64_t>(value_of(c, key));
      return std::ranges::any_of(std::array{value - 1, value + 1, 2 * value}, [&](std::int64_t moved) {
        Config other = c;
        return !set_value(other, key, moved) && !first_violation(other) && costs_of(other) != costs_of(c);
      });
    });
    EXPECT_EQ(moves, !free_keys.contains(key.path)) << key.path;
  }
  EXPECT_GT(widths, 60U);
}

TEST(Cost, ProductsHaveOperands) {
  for (const std::string& name : shipped_names) {
    for (const Config& c : all_modes(shipped_config(name))) {
      for (const Multiplier& m : multipliers(c)) {
        EXPECT_GT(m.a, 0) << m.product;
        EXPECT_GT(m.b, 0) << m.product;
        EXPECT_GT(m.times, 0) << m.product;
      }
      for (const RegisterPlace& p : register_places(c)) EXPECT_GT(p.word * p.times, 0) << p.name;
    }
  }
}

TEST(Cost, TheTableOfRegistersIsTheOneOfTheCode) {
  std::vector<std::string> expected, found;
  for (const RegisterRule& r : register_rules()) {
    expected.push_back("| " + std::string(r.stage) + " | `" + std::string(r.name) + "` | " +
                       std::to_string(r.times) + " | " + std::string(r.condition) + " |");
  }
  if (std::getenv("BITSPAN_UPDATE_DOCS") != nullptr) {
    std::string text = read_file(source_path("docs/search.md"));
    const std::size_t head = text.find("|---|---|---|---|\n", text.find("<!-- registers -->"));
    const std::size_t begin = text.find('\n', head) + 1, end = text.find("<!-- end of registers -->");
    std::string rows;
    for (const std::string& row : expected) rows += row + "\n";
    std::ofstream(source_path("docs/search.md")) << text.replace(begin, end - begin, rows);
  }
  std::ifstream page(source_path("docs/search.md"));
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "<!-- registers -->") inside = true;
    if (line == "<!-- end of registers -->") inside = false;
    if (inside && line.starts_with("| ") && line.find('`') != std::string::npos) found.push_back(line);
  }
  EXPECT_EQ(found, expected);
}

TEST(Cost, MemoryByHand) {
  const Config c = shipped_config("depth16");
  Scene small = demo_scene(64, 48), large = demo_scene(100, 60);
  const auto memory_of = [](const Config& config, const std::vector<Scene>& scenes) {
    std::map<std::string, double, std::less<>> out;
    add_memory(config, scenes, out);
    return out;
  };
  auto expected = std::map<std::string, double, std::less<>>{{"memory.depth_bits", 100 * 60 * 16},
                                                             {"memory.stencil_bits", 0},
                                                             {"memory.color_bits", 100 * 60 * 32},
                                                             {"memory.cache_bits", 64 * 64 * 2 * 8},
                                                             {"memory.texels_per_pixel", 1}};
  EXPECT_EQ(memory_of(c, {small, large}), expected);

  // The small scene has a stencil plane, and the large one a narrow target from its first triangle on.
  small.commands = {
      {1, StateChange{false,
                      {{*find_state_register("depth.when"), 1}, {*find_state_register("stencil.test"), 1}}}}};
  large.commands = {{0, StateChange{false, {{*find_state_register("target.format"), 1}}}}};
  Config wide = c;
  wide.depth_bits = 20;
  wide.filter = TextureFilter::bilinear;
  wide.mip = MipMode::linear;
  wide.memory.depth_cache = {BufferCacheMode::write_back, 32, 16, 4, SetHash::none};
  expected = {{"memory.depth_bits", 100 * 60 * 20},
              {"memory.stencil_bits", 64 * 48 * 8},
              {"memory.color_bits", 64 * 48 * 32},
              {"memory.cache_bits", 64 * 64 * 2 * 8 + 32 * 16 * 4 * 8},
              {"memory.texels_per_pixel", 8}};
  EXPECT_EQ(memory_of(wide, {small, large}), expected);
  // Every triangle with 16 bits of colour; the last of them with two texture units.
  large.commands.push_back({2, StateChange{false, {{*find_state_register("texture1"), 0}}}});
  EXPECT_EQ(memory_of(c, {large}).at("memory.color_bits"), 100 * 60 * 16);
  EXPECT_EQ(memory_of(c, {large}).at("memory.texels_per_pixel"), 2);
}

}  // namespace
}  // namespace bitspan
