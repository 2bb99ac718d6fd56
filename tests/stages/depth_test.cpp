// SPDX-License-Identifier: Apache-2.0
#include "model/stages/depth.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "golden/depth.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "model/simd/shipped.hpp"
#include "model/simd/spans.hpp"
#include "model/simd/targets.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

struct Depth {
  explicit Depth(DepthCode code, Rounding rounding = Rounding::trn) : config(plain_config()) {
    config.depth_code = code;
    config.depth_rounding = rounding;
    stage = model::prepare_depth(config, model::make_constants(config, worked_scene()));
  }
  DepthRecord operator()(double h, std::int64_t stored) const {
    FragmentRecord f;
    f.triangle = 2;
    f.x = 3;
    f.y = 4;
    f.h = encoded(h, config.format(FormatId::span_h));
    DepthRecord out;
    const bool pass = model::depth(stage, f, stored, out);
    EXPECT_EQ(out.pass, pass ? 1 : 0);
    EXPECT_EQ(out.stored, stored);
    EXPECT_EQ(out.triangle, 2);
    EXPECT_EQ(out.x, 3);
    EXPECT_EQ(out.y, 4);
    return out;
  }
  Config config;
  model::DepthStage stage;
};

TEST(Depth, InverseLargerIsNearer) {
  const Depth depth(DepthCode::inverse);
  EXPECT_EQ(depth.stage.clear, 0);
  EXPECT_EQ(depth(100.75, 0).z, 100);
  EXPECT_EQ(depth(100.75, 99).pass, 1);
  EXPECT_EQ(depth(100.75, 100).pass, 0);  // equal does not pass
  EXPECT_EQ(depth(100.75, 101).pass, 0);
  EXPECT_EQ(depth(-5, 0).z, 0);
  EXPECT_EQ(depth(70000, 0).z, 65535);
  EXPECT_EQ(Depth(DepthCode::inverse, Rounding::rnd)(100.75, 0).z, 101);
}

TEST(Depth, OpenGlSmallerIsNearer) {
  const Depth depth(DepthCode::opengl);
  EXPECT_EQ(depth.stage.clear, 65535);
  EXPECT_EQ(depth(100.75, 65535).z, 65535 - 101);  // floor of 65434.25
  EXPECT_EQ(depth(100.75, 65435).pass, 1);
  EXPECT_EQ(depth(100.75, 65434).pass, 0);
  EXPECT_EQ(depth(0, 65535).pass, 0);
}

// Linear in s: h(2) = 0 gives zmax, h(1.5) = 21845 its half, h(1) = 65535 zero.
TEST(Depth, LinearInDistance) {
  const Depth depth(DepthCode::linear, Rounding::rnd);
  EXPECT_EQ(depth.stage.clear, 65535);
  EXPECT_EQ(depth(0, 65535).z, 65535);
  EXPECT_EQ(depth(65535, 65535).z, 0);
  EXPECT_NEAR(static_cast<double>(depth(21845, 65535).z), 32767.5, 1);
  EXPECT_NE(depth(0, 65535).recip_m, 0);
  EXPECT_EQ(Depth(DepthCode::inverse)(0, 0).recip_m, 0);
  std::int64_t last = 65536;
  for (int h = 0; h <= 65535; h += 257) {
    const std::int64_t z = depth(h, 65535).z;
    const double s = 2 * 65535.0 / (h + 65535.0);
    EXPECT_NEAR(static_cast<double>(z), 65535 * (s - 1), 1);
    EXPECT_LT(z, last);
    last = z;
  }
}

// ---------------------------------------------------------------- comparisons

// What each comparison passes of what is nearer than the stored depth, as far, and farther.
struct Case {
  DepthFunc func;
  bool nearer, equal, farther;
};
constexpr std::array cases{
    Case{DepthFunc::never, false, false, false},  Case{DepthFunc::less, true, false, false},
    Case{DepthFunc::equal, false, true, false},   Case{DepthFunc::lequal, true, true, false},
    Case{DepthFunc::greater, false, false, true}, Case{DepthFunc::notequal, true, false, true},
    Case{DepthFunc::gequal, false, true, true},   Case{DepthFunc::always, true, true, true}};
static_assert(cases.size() == enum_names<DepthFunc>.size());
constexpr std::array codes{DepthCode::inverse, DepthCode::linear, DepthCode::opengl};

std::string name_of(const Config& c) {
  return c.name + ", " + std::string(to_string(c.depth_code)) + ", " + std::string(to_string(c.depth_func));
}

// Whether z passes against `stored`; only the inverse code grows towards the eye.
bool expected_pass(const Case& of, DepthCode code, std::int64_t z, std::int64_t stored) {
  if (z == stored) return of.equal;
  return (code == DepthCode::inverse ? z > stored : z < stored) ? of.nearer : of.farther;
}

// Every comparison, code and order, in the model's stage and in golden's.
TEST(DepthFunc, EveryOrderOfEveryCode) {
  int compared = 0;
  for (const Case& of : cases) {
    for (const DepthCode code : codes) {
      Depth depth(code);
      depth.config.depth_func = of.func;
      depth.stage = model::prepare_depth(depth.config, model::make_constants(depth.config, worked_scene()));
      const golden::Constants constants = golden::make_constants(depth.config, worked_scene());
      for (const double h : {0.0, 1.0, 300.25, 21845.0, 65534.0, 65535.0}) {
        const std::int64_t z = depth(h, 0).z;
        for (const std::int64_t stored : {std::int64_t{0}, z - 1, z, z + 1, std::int64_t{65535}}) {
          if (stored < 0 || stored > 65535) continue;
          const std::int64_t expected = expected_pass(of, code, z, stored) ? 1 : 0;
          EXPECT_EQ(depth(h, stored).pass, expected) << name_of(depth.config) << ": " << z << " " << stored;
          FragmentRecord fragment;
          fragment.covered = 1;
          fragment.h = encoded(h, depth.config.format(FormatId::span_h));
          const auto buffer = static_cast<std::uint32_t>(stored);
          std::vector<DepthRecord> out;
          golden::make_depth({golden::Width::x87, true}, depth.config, constants)(
              {&fragment, 1}, first_state(depth.config), {&buffer, 1}, 1, out);
          EXPECT_EQ(out.at(0).z, z);
          EXPECT_EQ(out.at(0).pass, expected)
              << "golden, " << name_of(depth.config) << ": " << z << " " << stored;
          ++compared;
        }
      }
    }
  }
  EXPECT_GT(compared, 500);
}

// What passed, in order; stores the depth that is left to whoever shades.
template <class T>
struct Kept final : model::BlockSink<T> {
  explicit Kept(Frame& to) : frame(to) {}
  void operator()(const model::FragmentBlock<T>& block, int /*texture*/, bool store_depth) override {
    for (std::size_t k = 0; k < block.size; ++k) {
      passed.emplace_back(block.triangle[k], block.pixel[k]);
      if (store_depth)
        frame.depth[static_cast<std::size_t>(block.pixel[k])] = static_cast<std::uint32_t>(block.z[k]);
    }
  }
  Frame& frame;
  std::vector<std::pair<std::int32_t, std::int32_t>> passed;
};

// Three spans of different triangles over the same pixels of each row, of which the last two are as far, over
// a buffer that holds nearer, equal and farther codes.
struct Rows {
  Rows(const Config& config, double h_step) : scene(worked_scene()) {
    constexpr std::array<std::int64_t, 9> lengths{1, 5, 16, 33, 64, 65, 100, 300, 600};
    scene.width = 610;
    scene.height = static_cast<int>(lengths.size());
    pipeline = model::make_pipeline(config, scene);
    for (std::int64_t y = 0; y < scene.height; ++y) {
      for (const double h : {20000.0, 20001.0, 20001.0}) {
        SpanRecord span;
        span.triangle = static_cast<std::int64_t>(spans.size());
        span.x = y;
        span.y = y;
        span.count = lengths[static_cast<std::size_t>(y)];
        span.h = encoded(h, config.format(FormatId::span_h));
        span.h_step = encoded(h_step, config.format(FormatId::span_h_step));
        spans.push_back(span);
      }
    }
    frame = model::cleared_frame(pipeline, scene);
    for (const SpanRecord& span : spans) {
      std::vector<FragmentRecord> fragments;
      model::span_to_fragments(pipeline, span, nullptr, fragments, counters);
      for (const FragmentRecord& fragment : fragments) {
        const std::size_t pixel = pixel_of(fragment);
        DepthRecord out;
        model::depth(pipeline.depth, fragment, 0, out);
        if (span.triangle % 3 == 0)
          frame.depth[pixel] = static_cast<std::uint32_t>(out.z + fragment.x * 5 % 7 % 3 - 1);
        all.emplace_back(fragment, out.z);
      }
    }
  }
  std::size_t pixel_of(const FragmentRecord& f) const {
    return static_cast<std::size_t>(f.y * scene.width + f.x);
  }
  Scene scene;
  model::Pipeline pipeline;
  Counters counters;
  std::vector<SpanRecord> spans;
  std::vector<std::pair<FragmentRecord, std::int64_t>> all;  // every fragment in order, and its code
  Frame frame;                                               // before the spans
};

template <class T>
void expect_spans(const Rows& rows, const Config& config, const Case& of,
                  const model::SpanKernels<T>& kernels, bool shared) {
  Frame expected = rows.frame;
  std::vector<std::pair<std::int32_t, std::int32_t>> passed;
  for (const auto& [fragment, z] : rows.all) {
    const std::size_t pixel = rows.pixel_of(fragment);
    if (!expected_pass(of, config.depth_code, z, expected.depth[pixel])) continue;
    expected.depth[pixel] = static_cast<std::uint32_t>(z);
    passed.emplace_back(fragment.triangle, pixel);
  }
  model::Columns<SpanRecord> spans(rows.spans.size());
  spans.size = rows.spans.size();
  for (std::size_t i = 0; i < spans.capacity(); ++i) {
    const SpanRecord record = i < spans.size ? rows.spans[i] : SpanRecord{};
#define BITSPAN_PUT_F(name, id) spans[&SpanRecord::name][i] = record.name;
#define BITSPAN_PUT_I(name) spans[&SpanRecord::name][i] = record.name;
#define BITSPAN_PUT_K(name, kind) spans[&SpanRecord::name][i] = record.name;
    BITSPAN_SPAN_RECORD(BITSPAN_PUT_F, BITSPAN_PUT_I, BITSPAN_PUT_K)
#undef BITSPAN_PUT_F
#undef BITSPAN_PUT_I
#undef BITSPAN_PUT_K
  }
  const std::vector<model::SpanDraw> draws(rows.spans.size(), {.texture = -1, .shared = shared});
  const auto work = std::make_unique<model::SpanWork<T>>();
  Frame frame = rows.frame;
  Kept<T> kept(frame);
  Counters counters;
  kernels.draw(rows.pipeline, spans, draws, 0, *work, frame, counters, kept);
  EXPECT_EQ(kept.passed, passed) << name_of(config);
  EXPECT_EQ(frame.depth, expected.depth) << name_of(config);
  EXPECT_EQ(counters.depth_passed, passed.size()) << name_of(config);
}

// The early test of whole spans in lanes, on every target, with formats read at run time and compiled in.
TEST(DepthFunc, SpansInLanes) {
  int specialised = 0;
  for (Config config : shipped_configs()) {
    for (const DepthCode code : codes) {
      config.depth_code = code;
      for (const Case& of : cases) {
        config.depth_func = of.func;
        for (const double h_step : {0.0, 0.5}) {
          const Rows rows(config, h_step);
          for (const VectorTarget target :
               {VectorTarget::avx512, VectorTarget::avx2, VectorTarget::baseline}) {
            if (!model::supported(target)) continue;
            for (const bool shared : {true, false}) {
              expect_spans(rows, config, of, model::span_kernels<std::int64_t>(target), shared);
              if (!model::spans_fit_int32(rows.pipeline.span.formats)) continue;
              expect_spans(rows, config, of, model::span_kernels<std::int32_t>(target), shared);
              const int shipped = model::shipped_index(config).spans;
              if (!model::specialises || shipped < 0) continue;
              expect_spans(rows, config, of, model::shipped_span_kernels(target, shipped), shared);
              ++specialised;
            }
          }
        }
      }
    }
  }
  EXPECT_TRUE(!model::specialises || specialised > 50);
}

// Two triangles of one shape: which of them is seen, -1 for none, at a distance between, and at s_max with
// the cleared buffer's code.
TEST(DepthFunc, TwoTrianglesOfEqualDepth) {
  struct Picture {
    DepthFunc func;
    int between, at_clear;
  };
  for (const Picture& picture : {Picture{DepthFunc::never, -1, -1}, Picture{DepthFunc::less, 0, -1},
                                 Picture{DepthFunc::equal, -1, 1}, Picture{DepthFunc::lequal, 1, 1},
                                 Picture{DepthFunc::greater, -1, -1}, Picture{DepthFunc::notequal, 0, -1},
                                 Picture{DepthFunc::gequal, -1, 1}, Picture{DepthFunc::always, 1, 1}}) {
    for (const DepthCode code : codes) {
      for (const bool at_clear : {false, true}) {
        Config config = shipped_config("depth16");
        config.depth_code = code;
        config.depth_func = picture.func;
        Scene scene = worked_scene();
        const double s = at_clear ? 2 : 1.5;
        scene.triangles.assign(2, triangle(vertex(2, 2, s), vertex(60, 2, s), vertex(2, 44, s)));
        scene.triangles[1].v[0].c = {1, 0, 0, 1};
        std::vector<std::pair<std::string, std::unique_ptr<Engine>>> engines;
        for (const ModelForm form : {ModelForm::scalar, ModelForm::vector, ModelForm::automatic}) {
          engines.emplace_back("model", make_model(config, {.form = form}));
        }
        engines.emplace_back("golden", make_golden(config));
        if (!at_clear)
          engines.emplace_back("ideal", make_ideal(config));  // unquantised: seldom as far as s_max
        for (const auto& [name, engine] : engines) {
          engine->begin(scene);
          engine->draw(scene.triangles, 0, nullptr);
          EXPECT_EQ(engine->frame().triangle[10 * 64 + 10], at_clear ? picture.at_clear : picture.between)
              << name << ", " << name_of(config);
        }
      }
    }
  }
}

// No fragment is farther than the cleared buffer, however h at s_max rounds.
TEST(DepthFunc, IdealDrawsNothingBehindTheClearedBuffer) {
  Config config = shipped_config("depth16");
  config.depth_func = DepthFunc::greater;
  Scene scene = worked_scene();
  scene.s_max = 1.7;
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    scene.triangles.push_back(random_triangle(random, scene.width, scene.height, 40));
    for (Vertex& v : scene.triangles.back().v) v.s = scene.s_max;
  }
  const auto ideal = make_ideal(config);
  ideal->begin(scene);
  ideal->draw(scene.triangles, 0, nullptr);
  EXPECT_GT(ideal->counters().covered, 1000U);
  EXPECT_EQ(ideal->counters().depth_passed, 0U);
}

}  // namespace
}  // namespace bitspan
