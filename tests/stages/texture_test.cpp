// SPDX-License-Identifier: Apache-2.0
#include "model/stages/texture.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "golden/texture.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

// 4 x 2 texels: red 10 i + j, green 100, blue 255, alpha 255; texel (2, 1) is magenta.
Texture small_image() {
  Texture t;
  t.name = "small";
  t.width = 4;
  t.height = 2;
  for (int j = 0; j < t.height; ++j) {
    for (int i = 0; i < t.width; ++i) {
      const bool hole = i == 2 && j == 1;
      for (const int c : {hole ? 255 : 10 * i + j, hole ? 0 : 100, 255, 255}) {
        t.rgba.push_back(static_cast<std::uint8_t>(c));
      }
    }
  }
  return t;
}

struct Lookup {
  explicit Lookup(const Config& c = plain_config()) : config(c), stage(model::prepare_texture(c)) {}
  FragmentRecord fragment(double u, double v) const {
    FragmentRecord f;
    f.triangle = 1;
    f.x = 2;
    f.y = 3;
    f.u = encoded(u, config.format(FormatId::span_uv));
    f.v = encoded(v, config.format(FormatId::span_uv));
    f.r = encoded(shade[0], config.format(FormatId::span_shade));
    f.g = encoded(shade[1], config.format(FormatId::span_shade));
    f.b = encoded(shade[2], config.format(FormatId::span_shade));
    f.a = encoded(shade[3], config.format(FormatId::span_shade));
    return f;
  }
  TextureRecord operator()(double u, double v, const Texture* image) const {
    TextureRecord out;
    const bool lives = model::texture(stage, image, fragment(u, v), out);
    EXPECT_EQ(out.killed, lives ? 0 : 1);
    return out;
  }
  double red(const TextureRecord& r) const {
    return decoded(r.texel_r, config.format(FormatId::texture_mix));
  }
  Config config;
  model::TextureStage stage;
  std::array<double, 4> shade{1, 1, 1, 1};
};

TEST(Texture, NoneIsWhite) {
  const Lookup lookup;
  const TextureRecord r = lookup(3, 4, nullptr);
  EXPECT_EQ(lookup.red(r), 255);
  EXPECT_EQ(decoded(r.texel_a, lookup.config.format(FormatId::texture_alpha)), 1);
  EXPECT_EQ(r.i, 0);
  EXPECT_EQ(r.ex, 0);
  EXPECT_EQ(r.killed, 0);
}

TEST(Texture, NearestCyclicAndClamped) {
  const Texture image = small_image();
  const Lookup cyclic;
  EXPECT_EQ(cyclic.red(cyclic(1.99, 1.0, &image)), 11);
  EXPECT_EQ(cyclic.red(cyclic(-0.01, 0, &image)), 30);
  EXPECT_EQ(cyclic(-0.01, 0, &image).i, 3);
  EXPECT_EQ(cyclic(4.0, 0, &image).i, 0);
  EXPECT_EQ(cyclic(-7.5, -3, &image).i, 0);
  EXPECT_EQ(cyclic(-7.5, -3, &image).j, 1);
  EXPECT_EQ(cyclic(1e6 + 1, 0, &image).i, 1);
  Config c = plain_config();
  c.wrap = TextureWrap::clamp;
  const Lookup clamped(c);
  EXPECT_EQ(clamped(-0.01, 7, &image).i, 0);
  EXPECT_EQ(clamped(-0.01, 7, &image).j, 1);
  EXPECT_EQ(clamped(99, 0, &image).i, 3);
}

TEST(Texture, MirrorTurnsEverySecondCopyRound) {
  const Texture image = small_image();
  Config c = plain_config();
  c.wrap = TextureWrap::mirror;
  const Lookup mirror(c);
  // Columns -9 .. 12 by hand, of a texture that is 4 wide.
  const std::array<int, 22> columns{0, 0, 1, 2, 3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0, 0, 1, 2, 3, 3};
  for (int i = -9; i <= 12; ++i) {
    EXPECT_EQ(mirror(i + 0.5, 0.5, &image).i, columns[static_cast<std::size_t>(i + 9)]) << i;
  }
  EXPECT_EQ(mirror(0.5, -0.5, &image).j, 0);
  EXPECT_EQ(mirror(0.5, -1.5, &image).j, 1);
  EXPECT_EQ(mirror(0.5, 2.5, &image).j, 1);
  // Both neighbours of an edge are the edge's own texel.
  c.filter = TextureFilter::bilinear;
  const Lookup smooth(c);
  EXPECT_EQ(smooth.red(smooth(0.0, 0.5, &image)), 0);
  EXPECT_EQ(smooth.red(smooth(4.25, 0.5, &image)), 30);
  // In the copy that is turned round: from texel 3 towards texel 2.
  EXPECT_EQ(smooth.red(smooth(4.75, 0.5, &image)), 27.5);
  EXPECT_EQ(smooth(4.75, 0.5, &image).i, 3);
}

// Filter and wrap modes are the draw state's, those of columns and rows apart.
TEST(Texture, LooksUpAsTheDrawStateSays) {
  const Texture image = small_image();
  Config c = plain_config();
  c.border = {200, 40, 60, 51};
  Lookup lookup(c);
  lookup.stage.lookup = {TextureFilter::nearest, TextureWrap::mirror, TextureWrap::clamp};
  EXPECT_EQ(lookup(4.5, 0.5, &image).i, 3);
  EXPECT_EQ(lookup(5.5, 5.5, &image).i, 2);
  EXPECT_EQ(lookup(5.5, 5.5, &image).j, 1);
  EXPECT_EQ(lookup(0.5, -5.5, &image).j, 0);
  // Beside the texture is the border, below it is its first row.
  lookup.stage.lookup = {TextureFilter::bilinear, TextureWrap::border, TextureWrap::cyclic};
  EXPECT_EQ(lookup.red(lookup(4.5, 2.5, &image)), 200);
  EXPECT_EQ(lookup.red(lookup(3.75, 2.5, &image)), 30 * 0.75 + 200 * 0.25);
  EXPECT_EQ(lookup.red(lookup(3.5, 2.0, &image)), 30.5);  // rows 1 and 0

  const auto golden = golden::make_texture({}, c);
  DrawState state = first_state(c);
  std::size_t different = 0;
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
    for (std::size_t modes = 0; modes < 16; ++modes) {
      state.texture_filter = filter;
      state.texture_wrap_u = static_cast<TextureWrap>(modes % 4);
      state.texture_wrap_v = static_cast<TextureWrap>(modes / 4);
      lookup.stage.lookup = first_lookup(state);
      for (int place = 0; place < 24 * 16; ++place) {
        const double u = -5.75 + 0.625 * (place % 24);
        const double v = -3.75 + 0.625 * (place / 24);
        const FragmentRecord f = lookup.fragment(u, v);
        const std::array<const FragmentRecord*, 1> fragments{&f};
        std::vector<TextureRecord> out;
        golden(fragments, &image, state, out);
        const TextureRecord got = lookup(u, v, &image);
        ASSERT_EQ(out.at(0), got) << to_string(filter) << " " << modes << " at " << u << ", " << v;
        different += got.i != got.j ? 1 : 0;
      }
    }
  }
  EXPECT_GT(different, 5000U);
}

TEST(Texture, BorderIsARingOfTexels) {
  const Texture image = small_image();
  Config c = plain_config();
  c.wrap = TextureWrap::border;
  c.border = {200, 40, 60, 51};
  const Lookup nearest(c);
  const TextureRecord left = nearest(-7.5, 0.5, &image);
  EXPECT_EQ(nearest.red(left), 200);
  EXPECT_EQ(decoded(left.texel_a, c.format(FormatId::texture_alpha)), 205.0 / 1024);  // 0.2, to 1/1024
  EXPECT_EQ(left.i, -1);
  EXPECT_EQ(left.j, 0);
  EXPECT_EQ(nearest(99, 99, &image).i, 4);
  EXPECT_EQ(nearest(99, 99, &image).j, 2);
  EXPECT_EQ(nearest.red(nearest(3.5, 1.5, &image)), 31);
  EXPECT_EQ(nearest.red(nearest(3.5, 2.0, &image)), 200);
  c.filter = TextureFilter::bilinear;
  const Lookup smooth(c);
  EXPECT_EQ(smooth.red(smooth(0.25, 0.5, &image)), 200 * 0.25);
  EXPECT_EQ(smooth.red(smooth(3.75, 0.5, &image)), 30 * 0.75 + 200 * 0.25);
  EXPECT_EQ(smooth.red(smooth(3.5, 1.75, &image)), 31 * 0.75 + 200 * 0.25);
  EXPECT_EQ(smooth.red(smooth(-0.5, 0.5, &image)), 200);
  EXPECT_EQ(smooth.red(smooth(-40.25, 0.5, &image)), 200);
  // A border of the reserved colour kills where it is nearest.
  c.transparent = {200, 40, 60};
  EXPECT_EQ(Lookup(c)(-0.25, 0.5, &image).killed, 1);
  EXPECT_EQ(Lookup(c).red(Lookup(c)(0.25, 0.5, &image)), 0);
}

TEST(Texture, BilinearMeetsTexelsAtTheirCentres) {
  const Texture image = small_image();
  Config c = plain_config();
  c.filter = TextureFilter::bilinear;
  const Lookup lookup(c);
  const TextureRecord centre = lookup(1.5, 0.5, &image);
  EXPECT_EQ(lookup.red(centre), 10);
  EXPECT_EQ(centre.ex, 0);
  EXPECT_EQ(centre.i, 1);
  // A quarter to the right and half down: 10 + 10/4, and 11 + ... of the row below with texel (2, 1) = 255.
  const TextureRecord r = lookup(1.75, 1.0, &image);
  EXPECT_EQ(r.ex, 64);  // of 256
  EXPECT_EQ(r.ey, 128);
  EXPECT_EQ(r.j, 0);
  EXPECT_EQ(lookup.red(r), (12.5 + (11 * 0.75 + 255 * 0.25)) / 2);
  // Left of the first centre: the last texel of the row, or the first again.
  EXPECT_EQ(lookup.red(lookup(0.25, 0.5, &image)), 30 * 0.25);
  EXPECT_EQ(lookup(0.25, 0.5, &image).i, 3);
  c.wrap = TextureWrap::clamp;
  EXPECT_EQ(Lookup(c).red(Lookup(c)(0.25, 0.5, &image)), 0);
}

// Ex is truncated by its format: 1/3 to a quarter.
TEST(Texture, FractionIsQuantised) {
  const Texture image = small_image();
  Config c = plain_config();
  c.filter = TextureFilter::bilinear;
  c.format(FormatId::texture_frac) = {2, 0, false, Rounding::trn, Overflow::sat, false};
  const Lookup lookup(c);
  const TextureRecord r = lookup(0.5 + 1.0 / 3, 0.5, &image);
  EXPECT_EQ(r.ex, 1);
  EXPECT_EQ(lookup.red(r), 2.5);
}

TEST(Texture, TransparentCode) {
  const Texture image = small_image();
  Config c = plain_config();
  c.transparent = {255, 0, 255};
  EXPECT_EQ(Lookup(c)(2.5, 1.5, &image).killed, 1);
  EXPECT_EQ(Lookup(c)(1.5, 1.5, &image).killed, 0);
  c.filter = TextureFilter::bilinear;
  const Lookup lookup(c);
  EXPECT_EQ(lookup(2.1, 1.5, &image).killed, 1);
  // The hole's colour does not bleed into its neighbour, which takes its place.
  const TextureRecord r = lookup(1.9, 1.5, &image);
  EXPECT_EQ(r.killed, 0);
  EXPECT_EQ(lookup.red(r), 11);
  // Without the reserved colour it is one like any other.
  c.transparent.reset();
  EXPECT_GT(Lookup(c).red(Lookup(c)(1.9, 1.5, &image)), 100);
}

// Golden against the model over every range of red and a place in each texel.
TEST(Texture, ChromaRange) {
  const Texture image = small_image();
  Config c = plain_config();
  DrawState state = first_state(c);
  const auto lookup = [&] {
    Lookup out(c);
    out.stage.chroma = model::chroma_of(state);
    return out;
  };
  // Red 10..20 is the texels (1, 0), (1, 1) = 11 and (2, 0); both ends count.
  state.chroma_low_red = 10;
  state.chroma_high_red = 20;
  EXPECT_EQ(lookup()(1.5, 0.5, &image).killed, 0);
  state.chroma_test = ChromaTest::inside;
  EXPECT_EQ(lookup()(1.5, 0.5, &image).killed, 1);
  EXPECT_EQ(lookup()(2.5, 0.5, &image).killed, 1);
  EXPECT_EQ(lookup()(3.5, 0.5, &image).killed, 0);
  EXPECT_EQ(lookup()(3, 4, nullptr).killed, 0);
  // All three colours decide.
  state.chroma_low_green = 101;
  EXPECT_EQ(lookup()(1.5, 0.5, &image).killed, 0);
  state.chroma_low_green = 100;
  state.chroma_test = ChromaTest::outside;
  EXPECT_EQ(lookup()(1.5, 0.5, &image).killed, 0);
  EXPECT_EQ(lookup()(3.5, 0.5, &image).killed, 1);
  EXPECT_EQ(lookup()(3, 4, nullptr).killed, 0);
  // The reserved colour stays transparent, inside of the range, too.
  c.transparent = {20, 100, 255};
  EXPECT_EQ(lookup()(2.5, 0.5, &image).killed, 1);
  EXPECT_EQ(lookup()(1.5, 0.5, &image).killed, 0);
  c.transparent.reset();
  // Between 20 and the keyed 30 there is 20 alone.
  c.filter = TextureFilter::bilinear;
  EXPECT_EQ(lookup().red(lookup()(2.9, 0.5, &image)), 20);
  EXPECT_EQ(lookup()(2.9, 0.5, &image).killed, 0);
  EXPECT_EQ(lookup()(3.1, 0.5, &image).killed, 1);

  std::uint64_t killed = 0;
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
    c.filter = state.texture_filter = filter;
    const auto golden = golden::make_texture({}, c);
    for (const ChromaTest test : {ChromaTest::none, ChromaTest::inside, ChromaTest::outside}) {
      state.chroma_test = test;
      for (int low = 0; low < 36; low += 3) {
        for (int high = 0; high < 36; high += 3) {
          state.chroma_low_red = low;
          state.chroma_high_red = high;
          const Lookup model = lookup();
          for (int place = 0; place < 32; ++place) {
            const double u = 0.25 + 0.5 * (place % 8);
            const double v = 0.25 + 0.5 * (place / 8);
            const FragmentRecord f = model.fragment(u, v);
            const std::array<const FragmentRecord*, 1> fragments{&f};
            std::vector<TextureRecord> out;
            golden(fragments, &image, state, out);
            const TextureRecord got = model(u, v, &image);
            ASSERT_EQ(out.at(0), got) << to_string(test) << " " << low << ".." << high << " at " << place;
            killed += static_cast<std::uint64_t>(got.killed);
          }
        }
      }
    }
  }
  EXPECT_GT(killed, 5000U);
}

TEST(Texture, ColourAndAlphaAreProducts) {
  Texture image = small_image();
  image.rgba[3] = 51;  // a fifth
  Lookup lookup;
  lookup.shade = {0.5, 0.25, 0, 0.5};
  TextureRecord r = lookup(0.5, 0.5, &image);
  EXPECT_EQ(r.r, 0);
  EXPECT_EQ(decoded(r.g, lookup.config.format(FormatId::texture_color)), 25);
  EXPECT_EQ(r.b, 0);
  EXPECT_EQ(r.texel_a, 205);  // 0.2 by 1/1024
  EXPECT_EQ(r.a, 103);        // 102.5, half up
  EXPECT_EQ(r.killed, 0);
  lookup.shade[3] = 0;
  EXPECT_EQ(lookup(0.5, 0.5, &image).killed, 1);
  lookup.shade[3] = 1;
  image.rgba[3] = 0;
  EXPECT_EQ(lookup(0.5, 0.5, &image).killed, 1);
}

// The alpha n / 255 has the code n in the alpha test, as in OpenGL, where alpha is rounded to the nearest
// code.
TEST(Texture, AlphaTestComparesCodes) {
  constexpr std::array<std::string_view, 8> passing{"", "<", "=", "<=", ">", "<>", ">=", "<=>"};
  std::uint64_t killed = 0;
  for (const std::string name : {"depth16", "depth20"}) {
    const Config config = shipped_config(name);
    const golden::TextureStage definition = golden::make_texture({}, config);
    model::TextureStage stage = model::prepare_texture(config);
    DrawState state = first_state(config);
    FragmentRecord fragment;
    const std::array<const FragmentRecord*, 1> fragments{&fragment};
    for (std::size_t func = 0; func < passing.size(); ++func) {
      state.alpha_func = static_cast<CompareFunc>(func);
      for (int code = 1; code < 256; ++code) {
        fragment.a = encoded(code / 255.0, config.format(FormatId::span_shade));
        for (const int ref : {0, 1, code - 1, code, std::min(code + 1, 255), 128, 255}) {
          state.alpha_ref = ref;
          stage.alpha_test = model::alpha_test_of(state.alpha_func, ref, stage.alpha);
          const char order = code < ref ? '<' : code > ref ? '>' : '=';
          const bool lives = passing.at(func).find(order) != std::string_view::npos;
          TextureRecord out;
          ASSERT_EQ(model::texture(stage, static_cast<const Texture*>(nullptr), fragment, out), lives)
              << name << ", function " << func << ", alpha " << code << ", reference " << ref;
          std::vector<TextureRecord> expected;
          definition(fragments, nullptr, state, expected);
          ASSERT_EQ(std::vector{out}, expected);
          killed += lives ? 0U : 1U;
        }
      }
    }
  }
  EXPECT_GT(killed, 10000U);
}

// The least alpha above 0, one that the register rounds to 0, and 0 itself: ideal has the exact alpha.
TEST(Texture, AlphaZeroKillsOrKeeps) {
  const Config config = shipped_config("depth16");
  const Format& shade = config.format(FormatId::span_shade);
  const Format& alpha = config.format(FormatId::texture_alpha);
  const golden::TextureStage definition = golden::make_texture({}, config);
  const golden::TextureStage in_columns = golden::make_texture({golden::Width::f64, false}, config);
  ASSERT_GT(shade.fraction(), alpha.fraction());
  FragmentRecord fragment;
  const std::array<const FragmentRecord*, 1> fragments{&fragment};
  const std::int64_t least = std::int64_t{1} << (shade.fraction() - alpha.fraction());
  for (const AlphaZero zero : {AlphaZero::kill, AlphaZero::keep}) {
    for (const CompareFunc func : {CompareFunc::always, CompareFunc::greater}) {
      DrawState state = first_state(config);
      state.alpha_zero = zero;
      state.alpha_func = func;
      model::TextureStage stage = model::prepare_texture(config);
      stage.kills_zero = zero == AlphaZero::kill;
      stage.alpha_test = model::alpha_test_of(func, 0, stage.alpha);
      for (const std::int64_t a : {std::int64_t{0}, least / 2 - 1, least}) {
        fragment.a = a;
        TextureRecord out;
        model::texture(stage, static_cast<const Texture*>(nullptr), fragment, out);
        EXPECT_EQ(out.a, a == least ? 1 : 0);
        // The code of all three is 0, which is not greater than the reference.
        const bool lives = func == CompareFunc::always && (zero == AlphaZero::keep || a == least);
        EXPECT_EQ(out.killed, lives ? 0 : 1) << a;
        for (const auto& view : {definition, in_columns}) {
          std::vector<TextureRecord> expected;
          view(fragments, nullptr, state, expected);
          EXPECT_EQ(std::vector{out}, expected) << a;
        }
      }
    }
  }
}

// Every alpha of a format against every reference, by the definition of the alpha's code.
TEST(Texture, AlphaTestOfEveryAlpha) {
  std::uint64_t tests = 0;
  Config config = shipped_config("depth16");
  for (const int fraction : {0, 1, 4, 7, 8, 9, 12}) {
    config.format(FormatId::texture_alpha).word = fraction + 1;
    model::TextureStage stage = model::prepare_texture(config);
    const std::int64_t one = std::int64_t{1} << fraction;
    for (std::int64_t a = stage.alpha.min; a <= stage.alpha.max; ++a) {
      const std::int64_t code = (510 * std::min(a, one) + one) / (2 * one);
      for (std::int64_t ref = 0; ref < 256; ++ref) {
        const auto passes = [&](CompareFunc func) {
          stage.alpha_test = model::alpha_test_of(func, ref, stage.alpha);
          return model::passes_alpha_test(stage, a);
        };
        ASSERT_EQ(passes(CompareFunc::less), code < ref) << a << " / " << one << ", reference " << ref;
        ASSERT_EQ(passes(CompareFunc::less_equal), code <= ref) << a << " / " << one << ", reference " << ref;
        ASSERT_EQ(passes(CompareFunc::equal), code == ref) << a << " / " << one << ", reference " << ref;
        tests += 3;
      }
    }
  }
  EXPECT_GT(tests, 1000000U);
}

TEST(Texture, NarrowAndWideAgree) {
  const Texture image = small_image();
  Config c = shipped_config("depth16");
  c.filter = TextureFilter::bilinear;
  const auto stage = model::prepare_texture(c);
  ASSERT_TRUE(stage.fits_int64);
  auto wide = stage;
  wide.fits_int64 = false;
  std::mt19937_64 random(41);
  for (int i = 0; i < 20000; ++i) {
    FragmentRecord f;
    f.u = static_cast<std::int64_t>(random() % (1 << 25)) - (1 << 24);
    f.v = static_cast<std::int64_t>(random() % (1 << 12)) - (1 << 11);
    f.r = static_cast<std::int64_t>(random() % (1 << 13));
    f.g = f.b = f.r / 2;
    f.a = static_cast<std::int64_t>(random() % (1 << 13));
    TextureRecord a;
    TextureRecord b;
    ASSERT_EQ(model::texture(stage, &image, f, a), model::texture(wide, &image, f, b));
    ASSERT_EQ(a, b);
  }
}

}  // namespace
}  // namespace bitspan
