// SPDX-License-Identifier: Apache-2.0
#include "model/stages/depth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "golden/depth.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "golden/packed_depth.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "model/simd/shipped.hpp"
#include "model/simd/spans.hpp"
#include "model/simd/targets.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

struct Depth {
  explicit Depth(DepthCode code, Rounding rounding = Rounding::trn, int bits = 16) : config(plain_config()) {
    config.depth_bits = bits;
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
    const bool pass = model::depth(stage, f, &gradient, stored, out);
    EXPECT_EQ(out.pass, pass ? 1 : 0);
    EXPECT_EQ(out.stored, stored);
    EXPECT_EQ(out.triangle, 2);
    EXPECT_EQ(out.x, 3);
    EXPECT_EQ(out.y, 4);
    return out;
  }
  void set_gradient(double h_x, double h_y) {
    gradient.h_x = encoded(h_x, config.format(FormatId::plane_h_grad));
    gradient.h_y = encoded(h_y, config.format(FormatId::plane_h_grad));
  }
  Config config;
  model::DepthStage stage;
  GradientRecord gradient;
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

// B = 65535: K = 17, and q = h + B lies in the octaves below 2^17; p = 12.
TEST(Depth, FloatingPointOfW) {
  const Depth depth(DepthCode::w_float);
  EXPECT_EQ(depth.stage.clear, 65535);
  EXPECT_EQ(depth(65535, 65535).z, 0);  // 4096 (2 - 131070 / 65536) = 1/8
  EXPECT_EQ(depth(65537, 65535).z, 0);  // q = 2^17
  EXPECT_EQ(depth(70000, 65535).z, 0);
  EXPECT_EQ(depth(32769, 65535).z, 2048);            // q = 98304, the middle of the nearest octave
  EXPECT_EQ(depth(1, 65535).z, 4096);                // q = 65536, its end
  EXPECT_EQ(depth(0, 65535).z, 4096);                // 4096 (3 - 65535 / 32768) = 4096.125
  EXPECT_EQ(depth(1 - 49152.0, 65535).z, 3 * 4096);  // q = 2^14: octave 2
  EXPECT_EQ(depth(-65535, 65535).z, 65535);          // q = 0
  EXPECT_EQ(depth(-65534.75, 65535).z, 65535);       // L = 18
  EXPECT_EQ(depth(1, 4097).pass, 1);
  EXPECT_EQ(depth(1, 4096).pass, 0);
  EXPECT_EQ(Depth(DepthCode::w_float, Rounding::rnd)(65535, 65535).z, 0);
  // Each octave is as fine as its share of W.
  for (int h = 0; h <= 65535; h += 251) {
    const double q = h + 65535.0;
    const double octave = std::floor(std::log2(131072 / q));
    const double exact = 4096 * (octave + 2 - q * std::exp2(octave - 16));
    EXPECT_EQ(static_cast<double>(depth(h, 65535).z), std::floor(exact)) << h;
  }
}

// h and B in steps of more than 1: K and the octaves stay those of their values.
TEST(Depth, FloatingPointOfWInCoarseRegisters) {
  for (const int coarse : {0, 1, 5, 9, 20}) {
    Depth depth(DepthCode::w_float, Rounding::rnd_zero, 32);
    Config& c = depth.config;
    c.format(FormatId::span_h) = {34 - coarse, 34, false, Rounding::trn, Overflow::sat, true};
    c.format(FormatId::setup_b) = {
        34 - std::max(coarse - 1, 0), 34, false, Rounding::rnd, Overflow::sat, true};
    depth.stage = model::prepare_depth(c, model::make_constants(c, worked_scene()));
    const golden::Constants constants = golden::make_constants(c, worked_scene());
    const auto in_golden = golden::make_depth({golden::Width::quad, true}, c, constants);
    std::set<std::int64_t> seen;
    for (int i = 0; i <= 1000; ++i) {
      FragmentRecord fragment;
      fragment.covered = 1;
      fragment.h = (std::int64_t{1} << (34 - coarse)) / 1000 * i;
      DepthRecord own;
      model::depth(depth.stage, fragment, &depth.gradient, 0, own);
      const std::uint32_t stored = 0;
      std::vector<DepthRecord> out;
      in_golden({&fragment, 1}, depth.gradient, first_state(c), {&stored, 1}, {1}, out);
      ASSERT_EQ(out.at(0).z, own.z) << coarse << " " << i;
      seen.insert(own.z);
    }
    EXPECT_GT(seen.size(), coarse == 20 ? 100U : 200U) << coarse;
  }
}

// ---------------------------------------------------------------- float_dz

// The RDP's format of 18 bits: zmax = 262143, 11 bits of mantissa; z = zmax - h.
struct Packed18 : Depth {
  Packed18() : Depth(DepthCode::float_dz, Rounding::trn, 18) {}
  DepthRecord at(double z, std::int64_t stored = 0) const { return (*this)(262143 - z, stored); }
  std::int64_t word(double z) const { return at(z).z; }
};

TEST(PackedDepth, EveryExponentStartsWhereOneMoreOneLeads) {
  const Packed18 depth;
  EXPECT_EQ(depth.stage.clear, 262128);  // 16 (2^14 - 1)
  EXPECT_EQ(golden::clear_depth(depth.config), 262128);
  EXPECT_EQ(depth.word(0), 0);
  EXPECT_EQ(depth.word(63), 0);
  EXPECT_EQ(depth.word(64), 16);
  EXPECT_EQ(depth.word(131071), 16 * 2047);  // 01111...: steps of 64
  EXPECT_EQ(depth.word(131072), 16 * 2048);  // 10000...: steps of 32
  EXPECT_EQ(depth.word(131103), 16 * 2048);
  EXPECT_EQ(depth.word(131104), 16 * 2049);
  EXPECT_EQ(depth.word(196607), 16 * 4095);
  EXPECT_EQ(depth.word(196608), 16 * 4096);   // 110...: steps of 16
  EXPECT_EQ(depth.word(229376), 16 * 6144);   // 1110...: 8
  EXPECT_EQ(depth.word(245760), 16 * 8192);   // 11110...: 4
  EXPECT_EQ(depth.word(253952), 16 * 10240);  // 111110...: 2
  EXPECT_EQ(depth.word(258048), 16 * 12288);  // 1111110...: 1
  EXPECT_EQ(depth.word(260095), 16 * 14335);
  EXPECT_EQ(depth.word(260096), 16 * 14336);  // 1111111...: 1 as well
  EXPECT_EQ(depth.word(260097), 16 * 14337);
  EXPECT_EQ(depth.word(262143), 16 * 16383);
  EXPECT_EQ(depth.word(-7), 0);
  EXPECT_EQ(depth.word(300000), 16 * 16383);
  for (int e = 1; e <= 7; ++e) {
    const std::int64_t start = (1 << 18) - (1 << (18 - e));
    EXPECT_EQ(depth.word(static_cast<double>(start)), 16 * 2048 * e) << e;
    EXPECT_EQ(depth.word(static_cast<double>(start - 1)), 16 * (2048 * e - 1)) << e;
  }
}

TEST(PackedDepth, DzIsRoundedUpToAPowerOfTwo) {
  Packed18 depth;
  struct Case {
    double h_x, h_y;
    int log2;
  };
  constexpr double ulp = 0x1p-20;
  for (const auto& [h_x, h_y, log2] : {Case{0, 0, 0},
                                       {0.5, 0.5, 0},
                                       {-0.5, 0.5, 0},
                                       {0.5, 0.5 + ulp, 1},
                                       {0.75, -0.5, 1},
                                       {-1, -1, 1},
                                       {1, 1 + ulp, 2},
                                       {3, -5, 3},
                                       {-8, -ulp, 4},
                                       {8191, 8193, 14},
                                       {8192, 8192 + ulp, 15},
                                       {16384, 16384, 15},
                                       {40000, 0, 15},
                                       {-1e6, 1e6, 15}}) {
    depth.set_gradient(h_x, h_y);
    EXPECT_EQ(depth.word(1000), 16 * 15 + log2) << h_x << " " << h_y;
  }
}

// z of the fragment is 261000, where steps are 1, and dz 4; what is stored is d farther.
TEST(PackedDepth, DepthsWithinDzAreAsFar) {
  Packed18 depth;
  depth.set_gradient(1.5, -2.25);  // 3.75
  ASSERT_EQ(depth.word(261000), 16 * (14336 + 904) + 2);
  const auto stored = [](std::int64_t farther, int dz) { return 16 * (14336 + 904 + farther) + dz; };
  const auto passes = [&](DepthFunc func, std::int64_t farther, int dz) {
    depth.stage.func = func;
    return depth.at(261000, stored(farther, dz)).pass == 1;
  };
  using enum DepthFunc;
  for (const int dz : {0, 1, 2}) {  // the fragment's own dz is the larger one
    EXPECT_TRUE(passes(equal, 0, dz));
    EXPECT_TRUE(passes(equal, 4, dz));
    EXPECT_TRUE(passes(equal, -4, dz));
    EXPECT_FALSE(passes(equal, 5, dz));
    EXPECT_FALSE(passes(equal, -5, dz));
  }
  EXPECT_TRUE(passes(equal, -8, 3));  // the stored one is
  EXPECT_FALSE(passes(equal, -9, 3));
  EXPECT_TRUE(passes(lequal, -4, 0));  // farther by 4
  EXPECT_FALSE(passes(lequal, -5, 0));
  EXPECT_TRUE(passes(lequal, 100, 0));
  EXPECT_TRUE(passes(gequal, 4, 0));
  EXPECT_FALSE(passes(gequal, 5, 0));
  EXPECT_TRUE(passes(gequal, -100, 0));
  // Nearer or farther alone has no tolerance.
  EXPECT_TRUE(passes(less, 1, 15));
  EXPECT_FALSE(passes(less, 0, 15));
  EXPECT_TRUE(passes(greater, -1, 15));
  EXPECT_FALSE(passes(greater, 0, 15));
  for (int dz = 0; dz < 16; ++dz) {
    for (const int farther : {-600, -257, -256, -9, -8, -5, -4, -1, 0, 1, 4, 5, 8, 9, 256, 257, 600}) {
      const bool as_far = std::abs(farther) <= std::max(4, 1 << dz);
      EXPECT_EQ(passes(equal, farther, dz), as_far);
      EXPECT_EQ(passes(notequal, farther, dz), !as_far);
      EXPECT_EQ(passes(lequal, farther, dz), as_far || farther > 0);
      EXPECT_EQ(passes(gequal, farther, dz), as_far || farther < 0);
      EXPECT_TRUE(passes(always, farther, dz));
      EXPECT_FALSE(passes(never, farther, dz));
    }
  }
}

TEST(PackedDepth, TheBiasIsAddedInFrontOfThePacking) {
  Packed18 depth;
  depth.set_gradient(2, 2);
  depth.stage.bias = 28;
  EXPECT_EQ(depth.word(100), 16 * 2 + 2);
  EXPECT_EQ(depth.word(262143), 16 * 16383 + 2);
  depth.stage.bias = -200;
  EXPECT_EQ(depth.word(100), 2);
  EXPECT_EQ(depth.word(264), 16 + 2);
}

// Every word of 8 to 18 bits, and ends of wider ones: apart and together, in both views.
TEST(PackedDepth, WordsComeApart) {
  const auto check = [](std::int64_t word, int bits) {
    const model::PackedDepth a = model::unpacked_depth(word, bits);
    const golden::PackedDepth b = golden::unpacked(word, bits);
    ASSERT_EQ(a.z, b.z) << bits << " " << word;
    ASSERT_EQ(a.dz, b.dz) << bits << " " << word;
    ASSERT_EQ(model::packed_depth(a, bits), word) << bits;
    ASSERT_EQ(golden::packed(b, bits), word) << bits;
  };
  for (int bits = 8; bits <= 18; ++bits) {
    for (std::int64_t word = 0; word < 1 << bits; ++word) check(word, bits);
  }
  for (int bits = 19; bits <= 32; ++bits) {
    const std::int64_t end = std::int64_t{1} << bits;
    for (std::int64_t k = 0; k < 1000; ++k) {
      check(k, bits);
      check(end - 1 - k, bits);
      check(end / 1000 * k, bits);
    }
  }
  EXPECT_EQ(model::unpacked_depth((std::int64_t{1} << 32) - 1, 32).z, (std::int64_t{1} << 32) - 1);
}

// Every z of 18 bits, against words of any kind, in golden's two forms and in the model; golden's by the
// definition of the word.
TEST(PackedDepth, EveryZOfEighteenBits) {
  constexpr int side = 512;
  Packed18 depth;
  depth.set_gradient(40.5, -3);  // dz 64
  std::mt19937_64 random(9);
  std::vector<FragmentRecord> fragments(side * side);
  std::vector<std::uint32_t> stored(fragments.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    FragmentRecord& f = fragments[i];
    f.covered = 1;
    f.x = static_cast<std::int64_t>(i % side);
    f.y = static_cast<std::int64_t>(i / side);
    f.h = encoded(262143 - static_cast<double>(i), depth.config.format(FormatId::span_h));
    const auto near = static_cast<std::int64_t>(i) + static_cast<std::int64_t>(random() % 300) - 150;
    const int dz = static_cast<int>(random() % 16);
    stored[i] =
        i % 4 == 0
            ? static_cast<std::uint32_t>(random() % (1 << 18))
            : static_cast<std::uint32_t>(golden::packed({std::clamp<std::int64_t>(near, 0, 262143), dz}, 18));
  }
  for (const DepthFunc func : {DepthFunc::less, DepthFunc::equal, DepthFunc::lequal, DepthFunc::gequal}) {
    depth.config.depth_func = depth.stage.func = func;
    const golden::Constants constants = golden::make_constants(depth.config, worked_scene());
    for (const golden::Arithmetic arithmetic :
         {golden::Arithmetic{golden::Width::x87, true}, golden::Arithmetic{golden::Width::f64, false}}) {
      std::vector<DepthRecord> out;
      golden::make_depth(arithmetic, depth.config, constants)(fragments, depth.gradient,
                                                              first_state(depth.config), stored, {side}, out);
      ASSERT_EQ(out.size(), fragments.size());
      std::int64_t last = 0;
      std::size_t passed = 0;
      for (std::size_t i = 0; i < out.size(); ++i) {
        DepthRecord of_model;
        model::depth(depth.stage, fragments[i], &depth.gradient, stored[i], of_model);
        ASSERT_EQ(of_model, out[i]) << i;
        passed += out[i].pass == 1 ? 1 : 0;
        const golden::PackedDepth back = golden::unpacked(out[i].z, 18);
        ASSERT_EQ(back.dz, 6);
        const auto z = static_cast<std::int64_t>(i);
        const int e = std::min(7, std::countl_one(static_cast<std::uint32_t>(z) << 14));
        ASSERT_TRUE(back.z <= z && z < back.z + (1 << std::max(0, 6 - e))) << z;
        ASSERT_GE(out[i].z, last);
        last = out[i].z;
      }
      EXPECT_GT(passed, out.size() / 5) << to_string(func);
      EXPECT_LT(passed, out.size() * 9 / 10) << to_string(func);
    }
  }
}

TEST(PackedDepth, EightToThirtyTwoBits) {
  Config config = shipped_config("depth16");
  config.depth_code = DepthCode::float_dz;
  for (const int bits : {8, 12, 16}) {
    config.depth_bits = bits;
    EXPECT_FALSE(first_violation(config).has_value()) << bits;
  }
  for (const int bits : {7, 33}) {
    config.depth_bits = bits;
    try {
      check_config(config, "here");
      ADD_FAILURE() << bits;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("depth.bits"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("8..32"), std::string::npos) << error.what();
    }
  }
}

// A triangle, and one of another colour on the middle of it: every pixel of the decal shows, where comparing
// for equal codes loses some.
TEST(PackedDepth, ADecalLiesOnItsSurface) {
  const Triangle below = triangle(vertex(3, 2, 1), vertex(61, 9, 1.9), vertex(20, 46, 1.2));
  Triangle decal = below;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& a = below.v[i];
    const Vertex& b = below.v[(i + 1) % 3];
    decal.v[i] = vertex((a.x + b.x) / 2, (a.y + b.y) / 2, 2 / (1 / a.s + 1 / b.s));
  }
  Scene scene = worked_scene();
  scene.triangles = {below, decal};
  for (const std::string& name : shipped_names) {
    Config config = shipped_config(name);
    config.depth_func = DepthFunc::lequal;
    const auto shown = [&](DepthCode code, const std::unique_ptr<Engine>& engine) {
      engine->begin(scene);
      engine->draw(scene.triangles, 0, nullptr);
      return std::pair(std::ranges::count(engine->frame().triangle, 1), to_string(code));
    };
    Config alone = config;
    alone.depth_func = DepthFunc::always;
    const auto all = shown(alone.depth_code, make_model(alone)).first;
    EXPECT_GT(all, 200);
    config.depth_code = DepthCode::opengl;
    EXPECT_LT(shown(config.depth_code, make_model(config)).first, all) << name;
    config.depth_code = DepthCode::float_dz;
    EXPECT_EQ(shown(config.depth_code, make_model(config)).first, all) << name;
    EXPECT_EQ(shown(config.depth_code, make_golden(config)).first, all) << name;
    EXPECT_EQ(shown(config.depth_code, make_ideal(config)).first, all) << name;
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
// Those whose codes are compared as they are.
constexpr std::array codes{DepthCode::inverse, DepthCode::linear, DepthCode::opengl, DepthCode::w_float};
constexpr std::array all_codes{DepthCode::inverse, DepthCode::linear, DepthCode::opengl, DepthCode::w_float,
                               DepthCode::float_dz};
static_assert(all_codes.size() == enum_names<DepthCode>.size());
static_assert(std::ranges::all_of(cases, [](const Case& of) {
  const bool one_side = of.nearer != of.farther && !of.equal;
  const bool all_or_none = of.nearer == of.farther && of.nearer == of.equal;
  return takes_tolerance(of.func) == !(one_side || all_or_none);
}));

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
              {&fragment, 1}, depth.gradient, first_state(depth.config), {&buffer, 1}, {1}, out);
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
  void operator()(const model::FragmentBlock<T>& block, const model::BlockDraw& draw) override {
    for (std::size_t k = 0; k < block.size; ++k) {
      passed.emplace_back(block.triangle[k], block.pixel[k]);
      if (draw.store_depth)
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
        model::depth(pipeline.depth, fragment, nullptr, 0, out);
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
    for (const DepthCode code : all_codes) {
      for (const bool at_clear : {false, true}) {
        Config config = shipped_config("depth16");
        config.depth_code = code;
        config.depth_func = picture.func;
        Scene scene = worked_scene();
        const double s = at_clear ? 2 : 1.5;
        // Its exponents reach beyond s_max, whose code is then not the cleared buffer's.
        if (at_clear && code == DepthCode::w_float) continue;
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
  Scene scene = worked_scene();
  scene.s_max = 1.7;
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    scene.triangles.push_back(random_triangle(random, scene.width, scene.height, 40));
    for (Vertex& v : scene.triangles.back().v) v.s = scene.s_max;
  }
  for (const DepthCode code : all_codes) {
    Config config = shipped_config("depth16");
    config.depth_func = DepthFunc::greater;
    config.depth_code = code;
    const auto ideal = make_ideal(config);
    ideal->begin(scene);
    ideal->draw(scene.triangles, 0, nullptr);
    EXPECT_GT(ideal->counters().covered, 1000U);
    EXPECT_EQ(ideal->counters().depth_passed, 0U) << to_string(code);
  }
}

}  // namespace
}  // namespace bitspan
