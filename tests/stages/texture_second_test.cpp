// SPDX-License-Identifier: Apache-2.0
// texture.second: the second unit's functions worked by hand, what it fetches, which fragments it kills, and
// golden = model for any values.
#include "model/stages/texture_second.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "config/modes.hpp"
#include "golden/mip_chain.hpp"
#include "golden/precision.hpp"
#include "golden/texture.hpp"
#include "golden/texture_second.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

constexpr std::array all_ops{TextureOp::replace, TextureOp::modulate, TextureOp::decal,
                             TextureOp::blend,   TextureOp::add,      TextureOp::modulate_scaled};

// Columns of the codes given, in one row.
Texture row_of(const std::vector<std::array<std::uint8_t, 4>>& texels) {
  Texture t;
  t.name = "row";
  t.width = static_cast<int>(texels.size());
  t.height = 1;
  for (const auto& texel : texels) t.rgba.insert(t.rgba.end(), texel.begin(), texel.end());
  return t;
}
Texture random_image(std::mt19937_64& random, int width, int height) {
  Texture t;
  t.name = "random";
  t.width = width;
  t.height = height;
  for (int i = 0; i < width * height * 4; ++i) {
    // Ends of the range come up often.
    const std::uint64_t draw = random();
    t.rgba.push_back(static_cast<std::uint8_t>(draw % 5 == 0 ? 0 : draw % 5 == 1 ? 255 : draw >> 8));
  }
  return t;
}

// The stage of both views, on one image, in one state. The views agree.
class Unit {
 public:
  Unit(const Config& config, const DrawState& state, const Texture& image)
      : config_(config),
        state_(state),
        image_(image),
        stage_(model::prepare_texture_second(config)),
        golden_(
            golden::make_texture_second({golden::choose_precision(config).texture_second, true}, config)) {
    model::set_texture_second(stage_, state_, &image_);
    if (has_lod(config)) {
      chain_ = model::make_mip_chain(image_);
      levels_ = golden::mip_levels(image_);
    }
  }
  TextureSecondRecord operator()(const FragmentRecord& fragment, const LodRecord& lod,
                                 const TextureRecord& first) {
    TextureSecondRecord out;
    const bool lives =
        model::texture_second(stage_, chain_.empty() ? nullptr : &chain_, fragment, lod, first, nullptr, out);
    EXPECT_EQ(out.killed, lives ? 0 : 1);
    const std::array<const FragmentRecord*, 1> fragments{&fragment};
    const std::array<const TextureRecord*, 1> firsts{&first};
    std::vector<const LodRecord*> lods;
    if (has_lod(config_)) lods.push_back(&lod);
    const std::span<const Texture> levels =
        has_lod(config_) ? std::span<const Texture>(levels_) : std::span<const Texture>(&image_, 1);
    records_.clear();
    golden_(fragments, firsts, lods, {}, levels, state_, records_);
    EXPECT_EQ(records_.at(0), out);
    return out;
  }

 private:
  Config config_;
  DrawState state_;
  Texture image_;
  model::TextureSecondStage stage_;
  golden::TextureSecondStage golden_;
  model::MipChain chain_;
  std::vector<Texture> levels_;
  std::vector<TextureSecondRecord> records_;
};

DrawState with_op(TextureOp op, int scale = 0) {
  DrawState state = first_state({});
  state.texture1 = 0;
  state.texture1_op = op;
  state.texture1_scale = scale;
  state.texture1_red = 10;
  state.texture1_green = 20;
  state.texture1_blue = 30;
  return state;
}

// What the first unit gives: colours in 1/16, alpha in 1/1024, the formats of plain_config.
TextureRecord given(int r, int g, int b, int a) {
  TextureRecord out{};
  out.triangle = 4;
  out.x = 5;
  out.y = 6;
  out.r = 16 * r;
  out.g = 16 * g;
  out.b = 16 * b;
  out.a = a;
  return out;
}
FragmentRecord at(const Config& c, double u, double v) {
  FragmentRecord out{};
  out.triangle = 4;
  out.x = 5;
  out.y = 6;
  out.u = encoded(u, c.format(FormatId::span_uv));
  out.v = encoded(v, c.format(FormatId::span_uv));
  return out;
}

using Raw = std::array<std::int64_t, 4>;  // colours in 1/16, alpha in 1/1024
Raw combine(const DrawState& state, const TextureRecord& first) {
  const Config c = plain_config();
  const TextureSecondRecord r = Unit(c, state, row_of({{102, 51, 255, 153}}))(at(c, 0.5, 0.5), {}, first);
  EXPECT_EQ((std::array{r.triangle, r.x, r.y, r.level, r.f, r.i, r.j}),
            (std::array<std::int64_t, 7>{4, 5, 6, 0, 0, 0, 0}));
  EXPECT_EQ((Raw{r.texel_r, r.texel_g, r.texel_b, r.texel_a}), (Raw{102 * 16, 51 * 16, 255 * 16, 614}));
  return {r.r, r.g, r.b, r.a};
}

// F of 102, 51, 255 is 410/1024 (0.4), 205/1024 (0.2) and 1; V_a of 153 is 614/1024 (0.6).
TEST(TextureSecond, ByHand) {
  const TextureRecord first = given(200, 100, 50, 512);
  EXPECT_EQ(combine(with_op(TextureOp::replace), first), (Raw{1632, 816, 4080, 614}));
  // 200 * 410/1024 = 80.078: 1281.25/16; 100 * 205/1024: 320.3/16; alpha 1/2 of 614.
  EXPECT_EQ(combine(with_op(TextureOp::modulate), first), (Raw{1281, 320, 800, 307}));
  // (200 * 410 + 102 * 614) / 1024: 2259.8/16; (100 * 410 + 51 * 614) / 1024: 1129.9/16;
  // (50 * 410 + 255 * 614) / 1024: 2766.7/16.
  EXPECT_EQ(combine(with_op(TextureOp::decal), first), (Raw{2260, 1130, 2767, 512}));
  // (200 * 614 + 10 * 410) / 1024: 1982.8/16; (100 * 819 + 20 * 205) / 1024: 1343.75/16; 30.
  EXPECT_EQ(combine(with_op(TextureOp::blend), first), (Raw{1983, 1344, 480, 307}));
  EXPECT_EQ(combine(with_op(TextureOp::add), first), (Raw{4080, 151 * 16, 4080, 307}));
}

TEST(TextureSecond, ModulateScaledSaturates) {
  const TextureRecord first = given(200, 100, 50, 1024);
  EXPECT_EQ(combine(with_op(TextureOp::modulate_scaled, 0), first),
            combine(with_op(TextureOp::modulate), first));
  // 2 * 80.078125 = 2562.5/16 goes up.
  EXPECT_EQ(combine(with_op(TextureOp::modulate_scaled, 1), first), (Raw{2563, 641, 1600, 614}));
  EXPECT_EQ(combine(with_op(TextureOp::modulate_scaled, 2), first), (Raw{255 * 16, 1281, 3200, 614}));
}

// 255 and white are neutral, 0 and black annul, for every colour; full alpha and none decide a decal.
TEST(TextureSecond, EndsOfTheRange) {
  const Config c = plain_config();
  const auto result = [&](TextureOp op, std::array<std::uint8_t, 4> texel, const TextureRecord& first) {
    const TextureSecondRecord r = Unit(c, with_op(op), row_of({texel}))(at(c, 0, 0), {}, first);
    return Raw{r.r, r.g, r.b, r.a};
  };
  for (int code = 0; code < 256; ++code) {
    const TextureRecord first = given(code, 255 - code, 0, 700);
    const Raw own{first.r, first.g, first.b, 700};
    EXPECT_EQ(result(TextureOp::modulate, {255, 255, 255, 255}, first), own);
    EXPECT_EQ(result(TextureOp::blend, {0, 0, 0, 255}, first), own);
    EXPECT_EQ(result(TextureOp::add, {0, 0, 0, 255}, first), own);
    EXPECT_EQ(result(TextureOp::decal, {9, 9, 9, 0}, first), own);
    EXPECT_EQ(result(TextureOp::decal, {9, 8, 7, 255}, first), (Raw{144, 128, 112, 700}));
    EXPECT_EQ(result(TextureOp::blend, {255, 255, 255, 255}, first), (Raw{160, 320, 480, 700}));
    EXPECT_EQ(result(TextureOp::modulate, {0, 0, 0, 255}, first), (Raw{0, 0, 0, 700}));
  }
}

// The unit wraps the same u and v in its own size, has a filter and wrap modes of its own, and no transparent
// texels.
TEST(TextureSecond, FetchesItsOwnTexture) {
  Config c = plain_config();
  const Texture image = row_of({{10, 0, 0, 255}, {20, 0, 0, 255}, {40, 0, 0, 255}});
  DrawState state = with_op(TextureOp::replace);
  const TextureRecord first = given(1, 2, 3, 1024);
  const auto red = [&](double u) { return Unit(c, state, image)(at(c, u, 7), {}, first).r; };
  EXPECT_EQ(red(0.5), 160);
  EXPECT_EQ(red(4.5), 320);
  EXPECT_EQ(red(-0.5), 640);
  state.texture1_wrap_u = TextureWrap::clamp;
  EXPECT_EQ(red(4.5), 640);
  state.texture1_filter = TextureFilter::bilinear;
  EXPECT_EQ(red(1.0), 240);
  EXPECT_EQ(red(1.75), 16 * 25);
  c.transparent = {20, 0, 0};
  DrawState keyed = state;
  keyed.chroma_test = ChromaTest::outside;
  EXPECT_EQ(red(1.75), 16 * 25);
  EXPECT_EQ(Unit(c, keyed, image)(at(c, 1.5, 0), {}, first).killed, 0);
}

// Levels of a chain of 8, 4, 2 and 1 texels by the fragment's lambda, whatever the first texture's chain.
TEST(TextureSecond, ChoosesALevelOfItsOwnChain) {
  Config c = plain_config();
  c.mip = MipMode::nearest;
  c.lod = LodMode::zone_s;
  std::mt19937_64 random(1);
  const Texture image = random_image(random, 8, 2);
  const auto levels = golden::mip_levels(image);
  ASSERT_EQ(levels.size(), 4U);
  Unit unit(c, with_op(TextureOp::replace), image);
  const auto of = [&](double lambda, std::int64_t level_of_first) {
    LodRecord lod{};
    lod.lambda = encoded(lambda, c.format(FormatId::lod_lambda));
    lod.level = level_of_first;
    return unit(at(c, 5.5, 0.5), lod, given(1, 2, 3, 1024));
  };
  EXPECT_EQ(of(-3, 0).level, 0);
  EXPECT_EQ(of(0.49, 0).level, 0);
  EXPECT_EQ(of(0.5, 7).level, 1);
  EXPECT_EQ(of(2.2, 0).level, 2);
  EXPECT_EQ(of(9, 1).level, 3);
  EXPECT_EQ(of(9, 1).r, 16 * levels[3].rgba[0]);
  EXPECT_EQ(of(1, 0).i, 2);  // floor(5.5 / 2)
  c.mip = MipMode::linear;
  Unit mixing(c, with_op(TextureOp::replace), image);
  LodRecord lod{};
  lod.lambda = encoded(1.25, c.format(FormatId::lod_lambda));
  const TextureSecondRecord r = mixing(at(c, 5.5, 0.5), lod, given(1, 2, 3, 1024));
  EXPECT_EQ(r.level, 1);
  EXPECT_EQ(r.f, 64);  // 1/4 in 1/256
  EXPECT_EQ(r.r, 12 * levels[1].rgba[8] + 4 * levels[2].rgba[4]);
}

// Its bias takes the place of the first unit's, which lambda has in it; its ends and filters are its own.
TEST(TextureSecond, ChoosesALevelByItsOwnRegisters) {
  Config c = plain_config();
  c.mip = MipMode::nearest;
  c.lod = LodMode::zone_s;
  Texture image = row_of({{10, 0, 0, 255}, {20, 0, 0, 255}, {40, 0, 0, 255}, {80, 0, 0, 255}});
  DrawState state = with_op(TextureOp::replace);
  const auto of = [&](double lambda) {
    LodRecord lod{};
    lod.lambda = encoded(lambda, c.format(FormatId::lod_lambda));
    return Unit(c, state, image)(at(c, 1, 0.5), lod, given(1, 2, 3, 1024));
  };
  state.texture_lod_bias = 4;
  state.texture1_lod_bias = 4;
  EXPECT_EQ(of(0.25).level, 0);
  state.texture1_lod_bias = 8;  // 1/4 more
  EXPECT_EQ(of(0.25).level, 1);
  EXPECT_EQ(of(0.2).level, 0);
  state.texture_lod_bias = -31;  // 39/16 more
  EXPECT_EQ(of(-1).level, 1);
  EXPECT_EQ(of(0).level, 2);
  state.texture1_lod_bias = -31;
  state.texture_lod_bias = 32;  // 63/16 less
  EXPECT_EQ(of(5.0).level, 1);
  EXPECT_EQ(of(4.375).level, 0);
  // lod.lambda saturates: 31.99 and 63/16 more.
  state.texture1_lod_bias = 32;
  state.texture_lod_bias = -31;
  EXPECT_EQ(of(31.99).level, 2);

  state.texture1_lod_bias = state.texture_lod_bias = 0;
  state.texture_level_least = 2;  // of the other unit
  state.texture_level_greatest = 0;
  EXPECT_EQ(of(1.25).level, 1);
  state.texture1_level_least = 1;
  EXPECT_EQ(of(-3).level, 1);
  EXPECT_EQ(of(9).level, 2);
  state.texture1_level_greatest = 1;
  EXPECT_EQ(of(9).level, 1);
  state.texture1_level_least = 2;
  EXPECT_EQ(of(0).level, 2);
  state.texture1_level_least = 0;

  // By one texel 20, by four 15; level 1 has 15.
  state.texture_magnify = MagnifyFilter::nearest;
  state.texture1_filter = TextureFilter::nearest;
  EXPECT_EQ(of(0).r, 16 * 20);
  state.texture1_magnify = MagnifyFilter::bilinear;
  EXPECT_EQ(of(0).r, 16 * 15);
  EXPECT_EQ(of(-4).r, 16 * 15);
  EXPECT_EQ(of(0.125).r, 16 * 20);
  state.texture1_lod_bias = -2;  // its own level of detail decides: 1/8 less
  EXPECT_EQ(of(0.125).r, 16 * 15);
  EXPECT_EQ(of(0.25).r, 16 * 20);
  state.texture1_level_greatest = 0;
  EXPECT_EQ(of(3).r, 16 * 15);
}

TEST(TextureSecond, TestsTheCombinedAlpha) {
  const Config c = plain_config();
  const Texture half = row_of({{255, 255, 255, 128}});
  const auto killed = [&](TextureOp op, CompareFunc func, int ref, int a) {
    DrawState state = with_op(op);
    state.alpha_func = func;
    state.alpha_ref = ref;
    return Unit(c, state, half)(at(c, 0, 0), {}, given(1, 1, 1, a)).killed;
  };
  // 514/1024 of the texel, 257/1024 of the product: 255 of these are 128.0 and 64.0.
  EXPECT_EQ(killed(TextureOp::replace, CompareFunc::greater, 127, 0), 0);
  EXPECT_EQ(killed(TextureOp::replace, CompareFunc::greater, 128, 0), 1);
  EXPECT_EQ(killed(TextureOp::modulate, CompareFunc::greater, 63, 512), 0);
  EXPECT_EQ(killed(TextureOp::modulate, CompareFunc::greater, 64, 512), 1);
  // 512/1024 are 127.5, whose code is 128.
  EXPECT_EQ(killed(TextureOp::decal, CompareFunc::less, 129, 512), 0);
  EXPECT_EQ(killed(TextureOp::decal, CompareFunc::less, 128, 512), 1);
  EXPECT_EQ(killed(TextureOp::modulate, CompareFunc::always, 0, 0), 1);
  EXPECT_EQ(killed(TextureOp::decal, CompareFunc::always, 0, 0), 1);
}

TEST(TextureSecond, KeepsAlphaZeroWhereToldTo) {
  const Config c = plain_config();
  const Texture half = row_of({{255, 255, 255, 128}});
  for (const AlphaZero zero : {AlphaZero::kill, AlphaZero::keep}) {
    DrawState state = with_op(TextureOp::modulate);
    state.alpha_zero = zero;
    const auto killed = [&](int a) {
      return Unit(c, state, half)(at(c, 0, 0), {}, given(1, 1, 1, a)).killed;
    };
    EXPECT_EQ(killed(0), zero == AlphaZero::kill ? 1 : 0);
    EXPECT_EQ(killed(2), 0);  // 514/1024 of 2 ulp are 1
    state.alpha_func = CompareFunc::not_equal;
    EXPECT_EQ(killed(0), 1);
  }
}

// While the second unit is on, the first one kills by its transparent texels alone.
TEST(TextureSecond, LeavesTheFirstUnitItsTransparentTexels) {
  Config c = plain_config();
  c.transparent = {255, 0, 255};
  const Texture image = row_of({{255, 0, 255, 255}, {1, 2, 3, 0}, {1, 2, 3, 255}});
  DrawState state = first_state(c);
  state.alpha_func = CompareFunc::never;
  for (const bool second : {false, true}) {
    state.texture1 = second ? 0 : -1;
    model::TextureStage stage = model::prepare_texture(c);
    stage.alpha_test = model::alpha_test_of(state.alpha_func, state.alpha_ref, stage.alpha);
    stage.is_last = !second;
    const auto golden = golden::make_texture({}, c);
    const auto in_columns = golden::make_texture({golden::Width::f64, false}, c);
    for (int i = 0; i < 3; ++i) {
      FragmentRecord fragment = at(c, i + 0.5, 0);
      fragment.r = fragment.g = fragment.b = fragment.a = encoded(1, c.format(FormatId::span_shade));
      const FragmentRecord* one = &fragment;
      TextureRecord out;
      model::texture(stage, &image, fragment, out);
      EXPECT_EQ(out.killed, i == 0 || !second ? 1 : 0) << i;
      for (const auto& view : {golden, in_columns}) {
        std::vector<TextureRecord> records;
        view({&one, 1}, &image, state, records);
        EXPECT_EQ(records.at(0), out) << i;
      }
    }
  }
}

// Every function, filter, wrap mode and kind of levels of the shipped formats, on random values.
TEST(TextureSecond, GoldenIsTheModel) {
  std::mt19937_64 random(7);
  std::uint64_t compared = 0, saturated = 0, killed = 0;
  std::vector<Config> configs = shipped_configs();
  configs.push_back(plain_config());
  for (Config& base : configs) {
    for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
      for (const MipMode mip : {MipMode::none, MipMode::nearest, MipMode::linear}) {
        Config c = base;
        c.mip = mip;
        c.lod = LodMode::zone_s;
        c.border = {9, 200, 77, 100};
        const auto raw = [&](FormatId id) {
          const Format& f = c.format(id);
          const std::uint64_t most = (std::uint64_t{1} << (f.word - (f.is_signed ? 1 : 0))) - 1;
          return static_cast<std::int64_t>(random() % 4 == 0 ? most : random() % (most + 1));
        };
        for (const TextureOp op : all_ops) {
          DrawState state = with_op(op, static_cast<int>(random() % 3));
          state.texture1_filter = filter;
          for (TextureWrap* wrap : {&state.texture1_wrap_u, &state.texture1_wrap_v})
            *wrap = static_cast<TextureWrap>(random() % enum_names<TextureWrap>.size());
          state.texture_lod_bias = static_cast<int>(random() % 64) - 31;
          state.texture1_lod_bias = static_cast<int>(random() % 64) - 31;
          state.texture1_level_least = static_cast<int>(random() % 3);
          state.texture1_level_greatest = static_cast<int>(random() % 6);
          state.texture1_magnify = static_cast<MagnifyFilter>(random() % enum_names<MagnifyFilter>.size());
          state.texture1_red = static_cast<int>(random() % 256);
          state.texture1_blue = 255;
          state.alpha_func = static_cast<CompareFunc>(random() % enum_names<CompareFunc>.size());
          state.alpha_ref = static_cast<int>(random() % 256);
          state.alpha_zero = random() % 2 == 0 ? AlphaZero::kill : AlphaZero::keep;
          Unit unit(c, state, random_image(random, 1 << random() % 5, 1 << random() % 5));
          for (int n = 0; n < 60; ++n, ++compared) {
            const double u = static_cast<double>(random() % 4096) / 32 - 64;
            const double v = static_cast<double>(random() % 4096) / 32 - 64;
            TextureRecord first = given(0, 0, 0, 0);
            first.r = raw(FormatId::texture_color);
            first.g = raw(FormatId::texture_color);
            first.b = raw(FormatId::texture_color);
            first.a = raw(FormatId::texture_alpha);
            LodRecord lod{};
            lod.lambda =
                encoded(static_cast<double>(random() % 128) / 16 - 1, c.format(FormatId::lod_lambda));
            const TextureSecondRecord r = unit(at(c, u, v), lod, first);
            saturated += r.r == encoded(255, c.format(FormatId::texture_color)) ? 1 : 0;
            killed += static_cast<std::uint64_t>(r.killed);
          }
          if (HasFailure()) return;
        }
      }
    }
  }
  EXPECT_EQ(compared, 4U * 2 * 3 * 6 * 60);
  EXPECT_GT(saturated, 200U);
  EXPECT_GT(killed, 500U);
}

}  // namespace
}  // namespace bitspan
