// SPDX-License-Identifier: Apache-2.0
#include "study/plan.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

KeyValue integer(std::int64_t v) { return v; }
KeyValue text(const char* v) { return std::string(v); }

Config find(const std::string& name) {
  if (name == "depth16" || name == "depth20" || name == "narrow") return shipped_config(name);
  throw InputError(name + ": no such configuration; shipped names: depth16, depth20, narrow");
}

StudyPlan parse(const std::string& toml) { return parse_study(toml, "s.toml", find); }

const std::string head = "[study]\nname = \"s\"\nbase = \"depth16\"\n";
const std::string vary = "[[vary]]\nkeys = [\"formats.span.h.word\"]\nvalues = [30, 32]\n";

void refused(const std::string& toml, const std::string& part) {
  const std::string message = input_error([&] { parse(toml); });
  EXPECT_NE(message.find(part), std::string::npos) << toml << "\n" << message;
  EXPECT_TRUE(message.starts_with("s.toml:")) << message;
}

TEST(Plan, ReadsEveryKey) {
  const std::string toml =
      "[study]\nname = \"all-1\"\nbase = \"depth20\"\nscenes = [\"demo\", \"extreme/slivers\"]\n"
      "size = \"64x48\"\narrangement = \"one_at_a_time\"\nmetrics = [\"span.u.p999\", \"picture.psnr_db\"]\n"
      "cost = \"estimate.ecp5.luts\"\n"
      "[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 30\nto = 36\nstep = 3\n"
      "[[vary]]\nkeys = [\"depth.bits\", \"formats.setup.h.int\"]\nvalues = [[16, 18], [20, 20]]\n"
      "[[vary]]\nkeys = [\"formats.edge.uv.word\", \"formats.span.uv.word\"]\nvalues = [24, 25]\n"
      "[[vary]]\nkeys = [\"depth.code\"]\nvalues = [\"inverse\", \"linear\"]\n"
      "[[vary]]\nkeys = [\"scene.s_ratio\"]\nvalues = [10, 2.5]\n"
      "[[constraint]]\nmetric = \"span.u.p999_ulp\"\nat_most = 1\n"
      "[[constraint]]\nmetric = \"picture.psnr_db\"\nat_least = 30.5\nat_most = 99\n"
      "[area]\nfamilies = [\"ice40\", \"ecp5\"]\nparts = [\"spans\", \"pixels\"]\nplace = true\n"
      "[report]\nbudget = true\nbounds = true\n";
  const StudyPlan plan = parse(toml);
  EXPECT_EQ(plan.name, "all-1");
  EXPECT_EQ(plan.text, toml);
  EXPECT_EQ(plan.base, shipped_config("depth20"));
  EXPECT_EQ(plan.scenes, (std::vector<std::string>{"demo", "extreme/slivers"}));
  EXPECT_EQ(plan.width, 64);
  EXPECT_EQ(plan.height, 48);
  EXPECT_EQ(plan.arrangement, Arrangement::one_at_a_time);
  EXPECT_EQ(plan.metrics, (std::vector<std::string>{"span.u.p999", "picture.psnr_db"}));
  EXPECT_EQ(plan.cost, "estimate.ecp5.luts");
  ASSERT_EQ(plan.axes.size(), 5U);
  EXPECT_EQ(plan.axes[0].values,
            (std::vector<std::vector<KeyValue>>{{integer(30)}, {integer(33)}, {integer(36)}}));
  EXPECT_EQ(plan.axes[1].values,
            (std::vector<std::vector<KeyValue>>{{integer(16), integer(18)}, {integer(20), integer(20)}}));
  EXPECT_EQ(plan.axes[2].values,
            (std::vector<std::vector<KeyValue>>{{integer(24), integer(24)}, {integer(25), integer(25)}}));
  EXPECT_EQ(plan.axes[3].values, (std::vector<std::vector<KeyValue>>{{text("inverse")}, {text("linear")}}));
  EXPECT_EQ(plan.axes[4].values, (std::vector<std::vector<KeyValue>>{{integer(10)}, {KeyValue(2.5)}}));
  ASSERT_EQ(plan.constraints.size(), 2U);
  EXPECT_EQ(plan.constraints[0].at_most, 1.0);
  EXPECT_FALSE(plan.constraints[0].at_least);
  EXPECT_EQ(plan.constraints[1].at_least, 30.5);
  ASSERT_TRUE(plan.area);
  EXPECT_EQ(plan.area->families, (std::vector<Family>{Family::ice40, Family::ecp5}));
  EXPECT_EQ(plan.area->parts, (std::vector<AreaPart>{AreaPart::spans, AreaPart::pixels}));
  EXPECT_TRUE(plan.area->place);
  EXPECT_TRUE(plan.budget);
  EXPECT_TRUE(plan.bounds);
  EXPECT_FALSE(plan.search);

  const StudyPlan search =
      parse(head + vary +
            "[[constraint]]\nmetric = \"registers.wraps\"\nat_most = 0\n[search]\nalgorithm = \"max-1\"\n"
            "cost = \"cost.product_bits\"\ntie = \"2 * cost.table_bits\"\ntie_within = 0.02\nevaluations = "
            "7\nseconds = 1.5\nseed = 9\n");
  ASSERT_TRUE(search.search);
  EXPECT_EQ(search.search->algorithm, SearchAlgorithm::max_minus_1);
  EXPECT_EQ(search.search->cost, "cost.product_bits");
  EXPECT_EQ(search.search->tie, "2 * cost.table_bits");
  EXPECT_EQ(search.search->tie_within, 0.02);
  EXPECT_EQ(search.search->evaluations, 7);
  EXPECT_EQ(search.search->seconds, 1.5);
  EXPECT_EQ(search.search->seed, 9U);
  EXPECT_TRUE(search.search->pairs);
  EXPECT_FALSE(parse(head + vary +
                     "[[constraint]]\nmetric = \"registers.wraps\"\nat_most = 0\n[search]\npairs = false\n")
                   .search->pairs);
  EXPECT_EQ(search.search->measure, 10);
  EXPECT_EQ(parse(head + vary +
                  "[[constraint]]\nmetric = \"registers.wraps\"\nat_most = 0\n[search]\nmeasure = 0\n")
                .search->measure,
            0);
}

TEST(Plan, ANamedAxisIsShownByItsNameAndItsOwnValue) {
  const std::string keys = "keys = [\"depth.bits\", \"formats.span.h.word\"]\n";
  const auto axis = [&](const std::string& rest) { return parse(head + "[[vary]]\n" + keys + rest).axes[0]; };
  const Axis counted = axis("name = \"depth\"\nfrom = 12\nto = 14\noffsets = [2, 20]\n");
  EXPECT_EQ(counted.values,
            (std::vector<std::vector<KeyValue>>{
                {integer(14), integer(32)}, {integer(15), integer(33)}, {integer(16), integer(34)}}));
  EXPECT_EQ(axis_title(counted), "depth");
  EXPECT_EQ(axis_text(counted, counted.values[1]), "13");
  // Values that no value of the axis gives, such as the base's.
  EXPECT_EQ(axis_text(counted, {integer(16), integer(30)}), "16, 30");
  const std::vector<KeySetting> point{
      {"span.x", integer(1)}, {"formats.span.h.word", integer(32)}, {"depth.bits", integer(14)}};
  EXPECT_EQ(axis_text(counted, point), "12");
  EXPECT_EQ(axis_text(counted, std::vector<KeySetting>{point[2]}), "");
  const Axis listed = axis("values = [12, 15]\noffsets = [0, 18]\n");
  EXPECT_EQ(listed.values,
            (std::vector<std::vector<KeyValue>>{{integer(12), integer(30)}, {integer(15), integer(33)}}));
  EXPECT_EQ(axis_title(listed), "depth.bits, formats.span.h.word");
  EXPECT_EQ(axis_text(listed, listed.values[0]), "12, 30");
  const Axis table = axis("name = \"pair-1_a.b\"\nvalues = [[12, 30], [15, 33]]\n");
  EXPECT_EQ(axis_title(table), "pair-1_a.b");
  EXPECT_EQ(axis_text(table, table.values[0]), "12, 30");
}

TEST(Plan, DefaultsAreTheEmbeddedSetAndAGrid) {
  const StudyPlan plan = parse(head + vary);
  EXPECT_TRUE(plan.scenes.empty());
  EXPECT_EQ(plan.width, 640);
  EXPECT_EQ(plan.height, 480);
  EXPECT_EQ(plan.arrangement, Arrangement::grid);
  EXPECT_TRUE(plan.metrics.empty() && plan.constraints.empty() && !plan.area && !plan.budget && !plan.bounds);
}

TEST(Plan, PointsOfEachArrangement) {
  const std::string two = vary + "[[vary]]\nkeys = [\"depth.round\"]\nvalues = [\"SC_RND\", \"SC_TRN\"]\n";
  const KeySetting w30{"formats.span.h.word", integer(30)};
  const KeySetting w32{"formats.span.h.word", integer(32)};
  const KeySetting rnd{"depth.round", text("SC_RND")};
  const KeySetting trn{"depth.round", text("SC_TRN")};
  using Points = std::vector<std::vector<KeySetting>>;
  EXPECT_EQ(points_of(parse(head + two)), (Points{{w30, rnd}, {w30, trn}, {w32, rnd}, {w32, trn}}));
  EXPECT_EQ(points_of(parse(head + "arrangement = \"list\"\n" + two)), (Points{{w30, rnd}, {w32, trn}}));
  EXPECT_EQ(points_of(parse(head + "arrangement = \"one_at_a_time\"\n" + two)),
            (Points{{}, {w30}, {w32}, {rnd}, {trn}}));
}

TEST(Plan, AListTakesEqualValuesAndOtherArrangementsRefuseThem) {
  const std::string axes =
      "[[vary]]\nkeys = [\"formats.span.h.word\"]\nvalues = [30, 30, 32]\n"
      "[[vary]]\nkeys = [\"depth.bits\"]\nvalues = [16, 24, 16]\n";
  const auto point = [](int word, int bits) {
    return std::vector<KeySetting>{{"formats.span.h.word", integer(word)}, {"depth.bits", integer(bits)}};
  };
  EXPECT_EQ(points_of(parse(head + "arrangement = \"list\"\n" + axes)),
            (std::vector<std::vector<KeySetting>>{point(30, 16), point(30, 24), point(32, 16)}));
  for (const std::string arrangement :
       {"", "arrangement = \"grid\"\n", "arrangement = \"one_at_a_time\"\n"}) {
    refused(head + arrangement + axes, "item 2 is there twice; legal: once, or arrangement = \"list\"");
  }
}

TEST(Plan, TextThatIsNoStudyIsRefused) {
  refused("", "s.toml:1: the study is empty");
  refused("  \n\n", "is empty");
  refused("[study\n", "s.toml:1: does not parse as TOML");
  refused("[study]\nname = \"a\"\nname = \"b\"\n", "s.toml:3: does not parse");
  refused(vary, "study: missing");
  refused("study = 3\n", "study: is an integer; legal: a table");
  refused(head + vary + "[extra]\nx = 1\n", "s.toml:7: extra: unknown table; legal: study, vary");
  refused(head + "colour = 1\n" + vary, "s.toml:4: study.colour: unknown key; legal: name, base");
  EXPECT_NE(input_error([] { load_study("none.toml", find); }).find("none.toml: no such study"),
            std::string::npos);
  EXPECT_NE(input_error([] { load_study("/", find); }).find("is a directory"), std::string::npos);
}

TEST(Plan, BadStudyTablesAreRefused) {
  const std::string base = "base = \"depth16\"\n";
  refused("[study]\n" + base + vary, "s.toml:1: study.name: missing");
  refused("[study]\nname = \"\"\n" + base + vary, "study.name: is empty");
  refused("[study]\nname = \"../x\"\n" + base + vary, "study.name: is \"../x\"");
  refused("[study]\nname = 3\n" + base + vary, "study.name: is an integer");
  refused("[study]\nname = \"s\"\n" + vary, "study.base: missing");
  refused("[study]\nname = \"s\"\nbase = \"depht16\"\n" + vary, "s.toml:3: study.base: depht16: no such");
  refused("[study]\nname = \"s\"\nbase = \"none.toml\"\n" + vary, "none.toml: no such configuration file");
  refused(head + "scenes = []\n" + vary, "study.scenes: is empty");
  refused(head + "scenes = \"demo\"\n" + vary, "study.scenes: is a string");
  refused(head + "scenes = [\"demo\", 3]\n" + vary, "study.scenes: has an integer");
  refused(head + "scenes = [\"demo\", \"demo\"]\n" + vary, "\"demo\" twice");
  refused(head + "scenes = [\"-\"]\n" + vary, "standard input");
  refused(head + "scenes = [\"none.tri\"]\n" + vary, "none.tri: no such file");
  for (const char* size :
       {"640", "640x", "x480", "0x10", "640x480x2", "-1x5", "99999x1", "30000x30000", "640 x 480"}) {
    refused(head + "size = \"" + size + "\"\n" + vary, std::string("study.size: is \"") + size);
  }
  refused(head + "arrangement = \"cube\"\n" + vary, "legal: grid, one_at_a_time, list");
  refused(head + "metrics = []\n" + vary, "study.metrics: is empty");
}

TEST(Plan, BadAxesAreRefused) {
  const auto axis = [](const std::string& keys, const std::string& rest) {
    return head + "[[vary]]\nkeys = " + keys + "\n" + rest + "\n";
  };
  refused(head, "vary: missing: nothing varies");
  refused(head + "vary = 3\n", "study.vary: unknown key");
  refused("vary = []\n" + head, "vary: is an array; legal: tables headed [[vary]]");
  refused("vary = 3\n" + head, "vary: is an integer; legal: tables headed [[vary]]");
  refused("[vary]\n" + head, "vary: is a table; legal: tables headed [[vary]]");
  refused(head + "[[vary]]\nvalues = [1]\n", "vary[1].keys: missing");
  refused(axis("[]", "values = [1]"), "vary[1].keys: is empty");
  refused(axis("\"depth.bits\"", "values = [1]"), "vary[1].keys: is a string");
  refused(axis("[\"depth.bits\"]", ""), "vary[1].values: missing");
  refused(axis("[\"depth.bits\"]", "values = []"), "s.toml:6: vary[1].values: is empty");
  refused(axis("[\"depth.bits\"]", "values = 16"), "vary[1].values: is an integer");
  refused(axis("[\"depth.bits\"]", "values = [16, 16]"), "item 2 is there twice");
  refused(axis("[\"depth.bits\"]", "values = [[16]]"), "vary[1].values: has an array");
  refused(axis("[\"depth.bits\"]", "values = [1979-05-27]"), "has a date or time");
  refused(axis("[\"depth.bits\"]", "values = [16]\nfrom = 3"), "is given together with from");
  refused(axis("[\"depth.bits\"]", "from = 3"), "vary[1].to: missing");
  refused(axis("[\"depth.bits\"]", "from = 20\nto = 10"),
          "vary[1].to: is 10, and from is 20: no value at all");
  refused(axis("[\"depth.bits\"]", "from = 10\nto = 20\nstep = 0"),
          "vary[1].step: is 0; legal: an integer, 1..");
  refused(axis("[\"depth.bits\"]", "from = 1.5\nto = 20"), "vary[1].from: is a float");
  refused(axis("[\"depth.bits\"]", "from = 0\nto = 1000000000"), "more than 100000 values");
  refused(axis("[\"depht.bits\"]", "values = [16]"),
          "s.toml:5: vary[1].keys: depht.bits: no such key of a configuration; nearest: depth.bits");
  refused(axis("[\"depth.bits\", \"depth.code\"]", "values = [[16, \"linear\"], [20]]"),
          "item 2 is an array of 1; legal: an array of values, which all 2 keys take");
  refused(axis("[\"depth.bits\", \"depth.code\"]", "values = [[16, \"linear\"], 20]"),
          "item 2 is an integer");
  refused(axis("[\"depth.bits\", \"depth.bits\"]", "values = [16]"), "\"depth.bits\" twice");
  refused(axis("[\"depth.bits\"]", "values = [16]\nstap = 1"), "vary[1].stap: unknown key");
  refused(axis("[\"depth.bits\"]", "values = [16]") + "[[vary]]\nkeys = [\"depth.bits\"]\nvalues = [20]\n",
          "vary[2].keys: depth.bits varies in another axis too");
  refused(axis("[\"formats.span.h.word\"]", "values = [34]") +
              "[[vary]]\nkeys = [\"formats.span.h.fraction\"]\nvalues = [18]\n",
          "vary[2].keys: formats.span.h.fraction varies, and so does its word");
  refused(head + "arrangement = \"list\"\n" + vary + "[[vary]]\nkeys = [\"depth.bits\"]\nvalues = [16]\n",
          "vary[2].values: has 1 values, and vary[1] has 2");
  const std::string two = "[\"depth.bits\", \"formats.span.h.word\"]";
  const std::string counted = "from = 12\nto = 14\n";
  refused(axis(two, counted + "offsets = [18]"),
          "s.toml:8: vary[1].offsets: is an array of 1; legal: an array of 2 integers, one per key");
  refused(axis(two, counted + "offsets = []"), "vary[1].offsets: is empty");
  refused(axis(two, counted + "offsets = 18"), "vary[1].offsets: is an integer");
  refused(axis(two, counted + "offsets = [0, 1.5]"), "vary[1].offsets: has a float; legal: an array of 2");
  refused(axis(two, counted + "offsets = [0, 9223372036854775807]"), "legal: up to 1000000000");
  for (const char* values : {"[[12, 16], [13, 17]]", "[12, 13.5]", "[\"a\"]", "[true]", "[99999999999]"}) {
    refused(axis(two, "values = " + std::string(values) + "\noffsets = [0, 18]"),
            "s.toml:6: vary[1].values: are not all integers, and offsets are added to them");
  }
  refused(axis(two, counted + "name = \"\""), "vary[1].name: is empty");
  refused(axis(two, counted + "name = \"a b\""),
          "s.toml:8: vary[1].name: is \"a b\"; legal: a word of letters, digits, -, _ and .");
  refused(axis(two, counted + "name = \"fog.mode\""), "is \"fog.mode\", which is a key; legal: another word");
  refused(axis(two, counted + "name = \"formats.span.h.fraction\""), "which is a key");
  refused(axis(two, counted + "name = \"scene.s_ratio\""), "which is a key");
  refused(axis(two, counted + "name = \"span.u.max\""), "which is a metric");
  refused(axis("[\"depth.bits\"]", "values = [16]\nname = \"n\"") +
              "[[vary]]\nname = \"n\"\nkeys = [\"depth.code\"]\nvalues = [\"linear\"]\n",
          "s.toml:9: vary[2].name: \"n\" names another axis too");
  std::string huge = head;
  for (const char* key : {"span.h", "span.f", "edge.h", "edge.f", "edge.x"}) {
    huge += std::string("[[vary]]\nkeys = [\"formats.") + key + ".word\"]\nfrom = 1\nto = 64\n";
  }
  refused(huge, "more than 1000000 points");
}

TEST(Plan, ValuesThatNoPointCanHaveAreRefused) {
  const auto axis = [](const std::string& keys, const std::string& values) {
    return "[[vary]]\nkeys = [\"" + keys + "\"]\nvalues = " + values + "\n";
  };
  refused(head + axis("formats.span.h.word", "[30, 99]"),
          "s.toml:6: vary[1].values: no point can have this: formats.span.h.word: is 99; legal: 1..63");
  refused(head + axis("reciprocal.pixel.kind", "[\"magic\"]"), "no value of this key");
  refused(head + axis("depth.bits", "[16.0]"), "depth.bits: is a float");
  refused(head + axis("scene.s_ratio", "[1]"), "scene.s_ratio: is 1; legal: a number above 1");
  refused(head + axis("scene.s_ratio", "[nan]"), "scene.s_ratio: is nan");
  refused(head + axis("scene.s_ratio", "[\"far\"]"), "scene.s_ratio: is far");
  // Legal alone on the base, which has 22 operand bits, but in no point.
  const std::string bits = axis("reciprocal.pixel.index_bits", "[9, 11]");
  refused(head + axis("reciprocal.pixel.operand_bits", "[10]") + bits,
          "index_bits: is 11 with operand_bits = 10");
  // Illegal in one point and legal in another: kept.
  EXPECT_EQ(points_of(parse(head + axis("reciprocal.pixel.operand_bits", "[10, 22]") + bits)).size(), 4U);
  // Illegal alone, since the base has 9 index bits, and legal with the first of another axis: kept.
  EXPECT_EQ(points_of(parse(head + axis("reciprocal.pixel.operand_bits", "[9, 22]") +
                            axis("reciprocal.pixel.index_bits", "[8, 9]")))
                .size(),
            4U);
  // A search finds out where its widths end, but needs one value that is legal.
  const std::string search = "[[constraint]]\nmetric = \"registers.wraps\"\nat_most = 0\n[search]\n";
  EXPECT_EQ(parse(head + axis("formats.span.h.word", "[30, 99]") + search).axes[0].values.size(), 2U);
  refused(head + axis("formats.span.h.word", "[98, 99]") + search, "no value is legal");
}

TEST(Plan, BadMetricsAndConstraintsAreRefused) {
  const auto constraint = [](const std::string& rest) {
    return head + vary + "[[constraint]]\n" + rest + "\n";
  };
  for (const char* name : {"span", "span.u", "span.u.p99", "spam.u.max", "registers.h.wraps",
                           "register.wraps", "register.span.h.max", "cost", "picture", "picture.wrong_ordre",
                           "texture.r.sqnr_db", "cost.bits", "", "..."}) {
    refused(constraint(std::string("metric = \"") + name + "\"\nat_most = 1"), "constraint[1].metric");
  }
  for (const char* name : {"span.u.p999", "span.u.bias_ulp", "texture.colour.sqnr_db", "registers.wraps",
                           "register.span.h.headroom", "cost.product_bits", "cost.table_bits",
                           "estimate.ice40.luts", "picture.wrong_order_rate"}) {
    EXPECT_EQ(parse(constraint(std::string("metric = \"") + name + "\"\nat_most = 1")).constraints[0].metric,
              name);
  }
  refused(constraint("at_most = 1"), "constraint[1].metric: missing");
  refused(constraint("metric = \"span.u.max\""), "constraint[1].at_most: missing; legal: at_most, at_least");
  refused(constraint("metric = \"span.u.max\"\nat_most = nan"), "is not finite");
  refused(constraint("metric = \"span.u.max\"\nat_most = \"1\""), "is a string");
  refused(constraint("metric = \"span.u.max\"\nat_most = 1\nat_least = 2"), "nothing holds it");
  refused(head + "metrics = [\"span.u.p99\"]\n" + vary,
          "study.metrics: \"span.u.p99\" is no metric; legal: those of docs/study.md, nearest: span.u.p999");
}

TEST(Plan, BadSearchAreaAndReportAreRefused) {
  const std::string constraint = "[[constraint]]\nmetric = \"registers.wraps\"\nat_most = 0\n";
  const std::string good = head + vary + constraint;
  refused(head + vary + "[search]\n", "constraint: missing: nothing would keep the search");
  refused(good + "[search]\nalgorithm = \"magic\"\n", "legal: min+1, max-1, greedy, annealing");
  refused(good + "[search]\ncost = \"bits\"\n", "search.cost: \"bits\" is no metric");
  refused(good + "[search]\ncost = \"2 * cost.bits\"\n",
          "search.cost: \"2 * cost.bits\": character 5: \"cost.bits\" is no metric");
  refused(good + "[search]\ntie = \"cost.table_bits +\"\n",
          "search.tie: \"cost.table_bits +\": character 18: an expression");
  refused(good + "[search]\ntie_within = -0.1\n",
          "search.tie_within: is below 0; legal: a number, at least 0");
  refused(good + "[search]\nevaluations = 0\n", "search.evaluations: is 0");
  refused(good + "[search]\nseconds = 0\n", "search.seconds: is not above 0");
  refused(good + "[search]\nseed = -1\n", "search.seed: is -1");
  refused(good + "[search]\nmeasure = -1\n", "search.measure: is -1");
  refused(good + "[search]\npairs = 1\n", "s.toml:11: search.pairs: is an integer");
  refused(head + "cost = \"cost.table_bits\"\n" + vary + constraint + "[search]\n",
          "study.cost: is given beside a search; legal: search.cost");
  refused(head + "cost = \"bits\"\n" + vary, "study.cost: \"bits\" is no metric");
  refused(head + "arrangement = \"grid\"\n" + vary + constraint + "[search]\n",
          "study.arrangement: is given");
  const auto axis = [](const std::string& keys, const std::string& values) {
    return "[[vary]]\nkeys = [" + keys + "]\nvalues = " + values + "\n";
  };
  const std::string search = constraint + "[search]\n";
  refused(head + vary + axis("\"depth.bits\"", "[1.5]") + search, "vary[2].values: are neither all integers");
  refused(head + vary + axis("\"depth.bits\"", "[16, \"17\"]") + search, "legal in a search: integers, or");
  refused(head + vary + axis("\"depth.round\"", "[\"SC_RND\", 16]") + search, "neither all integers");
  refused(head + vary + axis("\"depth.round\", \"depth.bits\"", "[[\"SC_RND\", 16]]") + search,
          "neither all integers");
  refused(head + axis("\"depth.code\"", "[\"linear\", \"inverse\"]") + search,
          "vary: has categories only; legal in a search: an axis of integers or more");
  // Kinds that are none are refused where no combination has another.
  refused(head + vary + axis("\"depth.round\"", "[\"a\", \"b\"]") + search,
          "vary[2].values: no value is legal: depth.round: \"a\" is no value");
  const std::string kinds = axis("\"depth.round\"", "[\"SC_TRN\", \"magic\"]");
  EXPECT_EQ(parse(head + vary + kinds + search).axes[1].values.size(), 2U);
  refused(head + vary + kinds + search + "evaluations = 1\n",
          "s.toml:14: search.evaluations: is 1 for 2 combinations of categories; legal: at least one each");
  // Too many operand bits for the base's kind, and legal with a category; a kind that needs the widest width.
  const std::string wide = axis("\"reciprocal.pixel.index_bits\"", "[9, 11]");
  const std::string units = axis("\"reciprocal.pixel.kind\"", "[\"restoring\", \"lut_linear\"]");
  EXPECT_EQ(parse(head + wide + units + search).axes.size(), 2U);
  std::string many;
  for (const char* key : {"depth.round", "depth.code", "formats.span.h.round"}) {
    many += axis(std::string("\"") + key + "\"",
                 "[\"a\",\"b\",\"c\",\"d\",\"e\",\"f\",\"g\",\"h\",\"i\",\"j\",\"k\"]");
  }
  refused(head + vary + many + search, "vary: the categories make more than 1000 combinations; legal: fewer");
  refused(head + "[[vary]]\nkeys = [\"scene.s_ratio\"]\nvalues = [10]\n" + constraint + "[search]\n",
          "is no width");
  refused(head + vary + "[area]\n", "area.families: missing");
  refused(head + vary + "[area]\nfamilies = [\"xc7\"]\n", "\"xc7\" is no family; legal: ice40, ecp5");
  refused(head + vary + "[area]\nfamilies = [\"ice40\"]\nplace = 1\n", "area.place: is an integer");
  refused(head + vary + "[area]\nfamilies = [\"ice40\"]\nparts = [\"all\"]\n",
          "\"all\" is no part of the RTL; legal: spans, pixels, late_pixels");
  refused(head + vary + "[report]\nbudget = \"yes\"\n", "report.budget: is a string");
}

TEST(Plan, FilesStandBesideTheStudy) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("sub"));
  folder.write("sub/scene.tri", "");
  folder.write("sub/mine.toml", to_toml(shipped_config("narrow")));
  const std::string study = folder.write(
      "sub/s.toml",
      "[study]\nname = \"s\"\nbase = \"mine.toml\"\nscenes = [\"scene.tri\", \"demo\"]\n" + vary);
  const StudyPlan plan = load_study(study, find);
  EXPECT_EQ(plan.scenes, (std::vector<std::string>{folder.path("sub/scene.tri"), "demo"}));
  // And what flags of a scene name.
  const std::string flagged = folder.write(
      "sub/f.toml",
      "[study]\nname = \"f\"\nbase = \"mine.toml\"\nscenes = [\"scene.tri --slide=a.png --shadow 1,2,3\", "
      "\"demo --texture b.png --texture1=/c.png\"]\n" +
          vary);
  EXPECT_EQ(load_study(flagged, find).scenes,
            (std::vector<std::string>{
                folder.path("sub/scene.tri") + " --slide=" + folder.path("sub/a.png") + " --shadow 1,2,3",
                "demo --texture " + folder.path("sub/b.png") + " --texture1=/c.png"}));
  EXPECT_EQ(config_hash(plan.base), config_hash(shipped_config("narrow")));
  EXPECT_EQ(plan.base.name, "mine");
}

TEST(Plan, ShippedStudiesAreLegal) {
  int studies = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("config/studies"))) {
    if (entry.path().extension() != ".toml") continue;
    const StudyPlan plan = load_study(entry.path().string(), find);
    EXPECT_EQ(plan.name, entry.path().stem().string());
    ++studies;
    EXPECT_FALSE(plan.metrics.empty());
    // That of shadows compares its scenes, most of which are wrong.
    EXPECT_EQ(plan.constraints.empty(), plan.name == "shadow") << plan.name;
    if (plan.search) continue;
    const auto points = points_of(plan);
    EXPECT_GE(points.size() * std::max<std::size_t>(plan.scenes.size(), 1), 40U);
    for (auto settings : points) {
      std::erase_if(settings, [](const KeySetting& s) { return s.path == s_ratio_key; });
      EXPECT_NO_THROW(with_keys(plan.base, settings));
    }
  }
  EXPECT_GE(studies, 3);
}

TEST(Plan, TheStudyOfTheYardIsLegal) {
  const TemporaryFolder folder;
  folder.write("yard.tri", "");
  const std::string path = folder.write("yard.toml", read_file(source_path("examples/views/yard.toml")));
  const StudyPlan plan = load_study(path, find);
  EXPECT_EQ(plan.scenes.size(), 12U);
  EXPECT_EQ(plan.validation.size(), 100U);
}

TEST(Plan, TheExampleOfTheDocumentIsLegal) {
  const std::string page = read_file(source_path("docs/study.md"));
  const auto from = page.find("```toml\n");
  ASSERT_NE(from, std::string::npos);
  const TemporaryFolder folder;
  folder.write("mine.tri", "");
  const std::string path =
      folder.write("s.toml", page.substr(from + 8, page.find("```\n", from + 8) - from - 8));
  const StudyPlan plan = load_study(path, find);
  EXPECT_EQ(points_of(plan).size(), 3U * 5 * 2);
  EXPECT_EQ(plan.scenes.back(), folder.path("mine.tri"));
}

TEST(Plan, MetricsAreHeldAgainstAPoint) {
  const std::map<std::string, double, std::less<>> metrics{
      {"span.u.max", 0.5},
      {"span.v.max", std::numeric_limits<double>::quiet_NaN()},
      {"cost.register_bits", 3000}};
  StudyPlan plan;
  plan.name = "s";
  plan.metrics = {"span.u.max"};
  plan.constraints = {{"span.u.max", 0.5, std::nullopt}};
  check_metrics(plan, metrics);
  EXPECT_TRUE(all_hold(plan.constraints, {metrics, {}}));
  plan.constraints[0].at_most = 0.49;
  EXPECT_FALSE(all_hold(plan.constraints, {metrics, {}}));
  plan.constraints = {{"span.v.max", 0.5, std::nullopt}};
  EXPECT_FALSE(all_hold(plan.constraints, {metrics, {}})) << "a NaN holds nothing";
  plan.constraints = {{"span.h.max", 0.5, std::nullopt}};
  EXPECT_FALSE(all_hold(plan.constraints, {metrics, {}}));
  EXPECT_NE(input_error([&] {
              check_metrics(plan, metrics);
            }).find("s: span.h.max: the scenes give no such metric; nearest: span.u.max, span.v.max"),
            std::string::npos);
  EXPECT_TRUE(all_hold({}, {metrics, {}}));
  plan.constraints.clear();
  plan.cost = "area.ecp5.luts";  // of a search only
  EXPECT_NE(input_error([&] {
              check_metrics(plan, metrics);
            }).find("s: area.ecp5.luts: the scenes give no such metric"),
            std::string::npos);
}

// A point that holds over all scenes together may fail on one.
TEST(StudyPlan, AConstraintJudgesTheWorstScene) {
  const PointMetrics measured{
      {{"span.u.p999", 0.2}, {"span.u.sqnr_db", 50}, {"fog.factor.max", 0.3}, {"cost.register_bits", 9}},
      {{"near", {{"span.u.p999", 0.1}, {"span.u.sqnr_db", 60}}},
       {"far", {{"span.u.p999", 0.3}, {"span.u.sqnr_db", 40}, {"fog.factor.max", 0.25}}}}};
  const auto at = [&](const Constraint& c) { return decisive(c, measured.all, measured.scenes); };
  Constraint c{"span.u.p999", 0.25, std::nullopt};
  EXPECT_EQ(at(c)->value, 0.3);
  EXPECT_EQ(at(c)->scene, "far");
  EXPECT_FALSE(all_hold({c}, measured));
  EXPECT_EQ(margin_text(c, 0.3), "20 % beyond");
  c.over = Over::pooled;
  EXPECT_EQ(at(c)->value, 0.2);
  EXPECT_EQ(at(c)->scene, "");
  EXPECT_TRUE(all_hold({c}, measured));
  EXPECT_EQ(margin_text(c, 0.2), "margin 20 %");
  EXPECT_EQ(at({"span.u.sqnr_db", std::nullopt, 45})->scene, "far") << "the lowest, where high is better";
  EXPECT_EQ(at({"span.u.p999", 0.5, 0.05})->scene, "near") << "between two limits, the nearer one decides";
  EXPECT_EQ(at({"fog.factor.max", 1, std::nullopt})->value, 0.25) << "of the scenes that have it";
  EXPECT_EQ(at({"cost.register_bits", 10, std::nullopt})->value, 9) << "no scene has a share in it";
  EXPECT_FALSE(at({"span.w.max", 1, std::nullopt}));
  EXPECT_EQ(margin_text({"registers.overflows", 0, std::nullopt}, 12), "12 beyond");
  EXPECT_EQ(margin_text({"span.u.sqnr_db", std::nullopt, 40}, 50), "margin 25 %");
  EXPECT_EQ(margin_text({"span.u.p999", 0.5, std::nullopt}, 0.0007), "margin 100 %");
  EXPECT_EQ(margin_text({"span.u.p999", 0.5, std::nullopt}, 0.4963), "margin 0.74 %");
  EXPECT_EQ(limits_text({"span.u.p999", 0.5, 0.25}), "at least 0.25, at most 0.5");
}

// The scenes that validate are those that no point is chosen by.
TEST(StudyPlan, ViewsAreCamerasOfTheScenes) {
  const auto plan_of = [](const std::string& lines) {
    return parse_study("[study]\nname = \"s\"\nbase = \"depth16\"\n" + lines +
                           "\n[[vary]]\nkeys = [\"formats.span.uv.word\"]\nvalues = [25]\n",
                       "s.toml", find);
  };
  using Names = std::vector<std::string>;
  const StudyPlan views =
      plan_of("scenes = [\"demo\"]\nviews = 3\nvalidate_views = 2\nvalidate = [\"floor\"]");
  EXPECT_EQ(views.scenes, (Names{"demo", "demo@1", "demo@2"}));
  EXPECT_EQ(views.validation, (Names{"floor", "demo@3", "demo@4"}));
  EXPECT_EQ(plan_of("validate_views = 1").scenes, (Names{"demo", "extreme"}));
  EXPECT_TRUE(plan_of("").validation.empty());
  EXPECT_EQ(plan_of("scenes = [\"demo@7\"]").scenes, Names{"demo@7"});
  EXPECT_EQ(plan_of("scenes = [\"demo@7  --slide  /a.png --slide-from=1,2\"]").scenes,
            Names{"demo@7 --slide /a.png --slide-from=1,2"});
  const auto refuse = [&](const std::string& lines, std::string_view part) {
    expect_refusal([&] { plan_of(lines); }, part);
  };
  refuse("scenes = [\"demo@7\"]\nviews = 2", "study.views: is given, and demo@7 has its camera");
  refuse("scenes = [\"demo\"]\nvalidate = [\"demo\"]", "study.validate: demo is among the scenes");
  refuse("scenes = [\"demo --shadow=1,2,3\"]\nviews = 2",
         "study.views: is given, and demo --shadow=1,2,3 has its");
  refuse("views = 0", "study.views");
  refuse("validate = [\"none.obj@3\"]", "none.obj@3: no such file");
}

}  // namespace
}  // namespace bitspan
