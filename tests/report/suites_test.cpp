// SPDX-License-Identifier: Apache-2.0
// Named suites: which there are, what they depend on, and that each shows its feature and finds a difference.
#include "report/suites.hpp"

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "golden/engine_golden.hpp"
#include "model/engine_model.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/wrapped_engine.hpp"

namespace bitspan {
namespace {

// The model with the verdict of one depth test turned over.
class TurnedVerdict : public WrappedEngine {
 public:
  explicit TurnedVerdict(const Config& config) : WrappedEngine(make_model(config)) {}
  std::string_view name() const override { return "turned"; }
  void begin(const Scene& scene) override {
    WrappedEngine::begin(scene);
    done_ = false;
  }
  void draw(std::span<const Triangle> triangles, std::int64_t first, Trace* trace) override {
    WrappedEngine::draw(triangles, first, trace);
    if (trace == nullptr || trace->depth.empty() || done_) return;
    trace->depth.back().pass ^= 1;
    done_ = true;
  }

 private:
  bool done_ = false;
};

template <class Other>
SuiteEngines model_against(Other other) {
  const auto model = [](const Config& config) { return make_model(config); };
  return {[=](const Config& config) {
            std::vector<std::unique_ptr<Engine>> out;
            out.push_back(make_model(config));
            out.push_back(other(config));
            return out;
          },
          model};
}

SuiteEngines model_and_golden() {
  return model_against([](const Config& config) { return make_golden(config); });
}

TEST(Suites, NamesAreManyAndEachStandsOnce) {
  const std::vector<std::string> names = suite_names();
  EXPECT_GE(names.size(), 240U);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  EXPECT_EQ(matching_suites("*"), names);
  EXPECT_EQ(matching_suites("depth.lequal/delta_f/64x48"),
            std::vector<std::string>{"depth.lequal/delta_f/64x48"});
  EXPECT_TRUE(matching_suites("depth.lequal").empty());
}

// In parts, as all of them take half a minute.
constexpr std::size_t parts_of_suites = 7;  // each meets every way of perspective and every size
class SuitesInParts : public testing::TestWithParam<std::size_t> {};
#ifdef __SANITIZE_ADDRESS__
INSTANTIATE_TEST_SUITE_P(Suites, SuitesInParts, testing::Values(0));  // these builds are slow
#else
INSTANTIATE_TEST_SUITE_P(Suites, SuitesInParts, testing::Range(std::size_t{0}, parts_of_suites));
#endif

TEST_P(SuitesInParts, ShowTheirFeatureAndAgree) {
  const std::vector<std::string> all = suite_names();
  for (std::size_t i = GetParam(); i < all.size(); i += parts_of_suites) {
    const std::string& name = all[i];
    const SuiteRun run = run_named_suite(name, 1, model_and_golden());
    EXPECT_TRUE(run.result.agree()) << name;
    EXPECT_EQ(run.result.trivial, "") << name;
    EXPECT_GT(run.result.effect, 0U) << name;
    EXPECT_GT(run.result.non_trivial(), 0U) << name;
    EXPECT_EQ(run.result.differences(), 0U) << name;
  }
}

TEST(Suites, ANameAndASeedGiveOneDigest) {
  const std::string name = "fog.table_6_4/hyperbolic/32x24";
  const std::string digest = run_named_suite(name, 1, model_and_golden()).result.digest;
  EXPECT_EQ(digest.size(), 16U);
  EXPECT_EQ(run_named_suite(name, 1, model_and_golden()).result.digest, digest);
  EXPECT_NE(run_named_suite(name, 2, model_and_golden()).result.digest, digest);
  EXPECT_NE(run_named_suite("fog.table_8_2/hyperbolic/32x24", 1, model_and_golden()).result.digest, digest);
}

TEST(Suites, APlantedDifferenceIsFound) {
  const SuiteRun run = run_named_suite(
      "depth.lequal/delta_f/32x24", 1,
      model_against([](const Config& config) { return std::make_unique<TurnedVerdict>(config); }));
  EXPECT_FALSE(run.result.agree());
  EXPECT_GT(run.result.differences(), 0U);
  ASSERT_TRUE(run.result.run.pairs[0].first.has_value());
  EXPECT_EQ(run.result.run.pairs[0].first->stage, "depth");
  EXPECT_EQ(run.result.run.pairs[0].first->field, "pass");
}

TEST(Suites, WithoutAnEffectASuiteIsTrivial) {
  SuiteCase suite = make_suite("texture.bilinear/affine/32x24", 1, 0);
  EXPECT_EQ(run_suite(suite, model_and_golden()).trivial, "");
  suite.config_without = suite.config;
  suite.scene_without = suite.scene;
  EXPECT_EQ(run_suite(suite, model_and_golden()).trivial,
            "every record of texture is the same without the feature");
  suite.scene.triangles.clear();
  EXPECT_EQ(run_suite(suite, model_and_golden()).trivial, "the scene covers no pixel centre");
}

TEST(Suites, WhatMustHappenToFragmentsIsAsked) {
  // Every fragment passes, and the records are others than with "less".
  SuiteCase suite = make_suite("depth.less/delta_f/32x24", 1, 0);
  ASSERT_EQ(suite.needs, SuiteNeeds::passing);
  std::swap(suite.config, suite.config_without);
  ASSERT_EQ(suite.config.depth_func, DepthFunc::always);
  EXPECT_EQ(run_suite(suite, model_and_golden()).trivial, "no fragment failed the depth test");
  suite.config.depth_func = DepthFunc::never;
  EXPECT_EQ(run_suite(suite, model_and_golden()).trivial, "no fragment passed the depth test");

  suite = make_suite("texel.transparent/delta_f/32x24", 1, 0);
  ASSERT_EQ(suite.needs, SuiteNeeds::killing);
  EXPECT_EQ(run_suite(suite, model_and_golden()).trivial, "");
  for (Triangle& triangle : suite.scene.triangles) triangle.texture = -1;
  for (Triangle& triangle : suite.scene.triangles) {
    for (Vertex& v : triangle.v) v.c[3] = 1;
  }
  EXPECT_EQ(run_suite(suite, model_and_golden()).trivial, "no fragment was killed");
}

template <class E>
std::string list_of() {
  std::string out;
  for (const std::string_view name : enum_names<E>) {
    out += (out.empty() ? "`" : ", `") + std::string(name) + "`";
  }
  return out;
}

// The list without its first name.
std::string but_first(const std::string& list) { return list.substr(list.find(", ") + 2); }

std::string texel_formats_in_memory() {
  std::string out;
  for (std::size_t i = 0; i < enum_names<TexelFormat>.size(); ++i) {
    if (is_procedural(static_cast<TexelFormat>(i))) continue;
    out += (out.empty() ? "`" : ", `") + std::string(enum_names<TexelFormat>[i]) + "`";
  }
  return out;
}

// docs/suites.md: "| `group` | `feature`, ... | stage | ...".
TEST(Suites, ThePageHasEveryFeatureOnce) {
  std::string text = read_file(source_path("docs/suites.md"));
  text = text.substr(text.find("## The features"));
  // What docs/adding.md counts as files of an addition stays out of the page.
  const std::map<std::string, std::string> in_words{
      {list_of<ReciprocalKind>(), "each kind"},
      {list_of<DepthFunc>(), "each comparison"},
      {list_of<DepthCode>(), "each code"},
      {"`equal`, `lequal`, `notequal`, `gequal`", "each comparison that has a tolerance"},
      {list_of<TextureFilter>(), "each filter"},
      {list_of<TextureWrap>(), "each way"},
      {list_of<CompareFunc>(), "each comparison"},
      {list_of<StencilOp>(), "each operation"},
      {list_of<BlendFactor>(), "each factor"},
      {list_of<BlendOp>(), "each equation"},
      {list_of<TextureOp>(), "each function"},
      {but_first(list_of<LogicOp>()), "each operation"},
      {but_first(list_of<TargetFormat>()), "each but the first"},
      {but_first(list_of<Dither>()), "each but the first"},
      {but_first(texel_formats_in_memory()), "each that lies in memory, but the first"}};
  std::map<std::string, std::string> written, expected, features;
  const std::regex row(R"re(\| `(\w+)` \| (.+?) \| ([\w.]+) \| .+ \|)re");
  for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it) {
    written[(*it)[1]] = (*it)[3].str() + ": " + (*it)[2].str();
  }
  for (const SuiteFeature& feature : suite_features()) {
    const std::size_t dot = feature.name.find('.');
    const std::string group = feature.name.substr(0, dot);
    std::string& list = features[group];
    list += (list.empty() ? "`" : ", `") + feature.name.substr(dot + 1) + "`";
    const auto words = in_words.find(list);
    expected[group] =
        std::string(stage_of(feature.stage)) + ": " + (words == in_words.end() ? list : words->second);
  }
  EXPECT_EQ(written, expected);
}

TEST(Suites, AnUnknownNameIsRefused) {
  expect_refusal([] { static_cast<void>(make_suite("depth.nearest", 1, 0)); },
                 "depth.nearest: no such suite");
}

}  // namespace
}  // namespace bitspan
