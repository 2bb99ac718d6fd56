// The narrowing routine against SystemC's sc_fix on the same work: products of two registers into a third.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <systemc>

#include "model/numeric/quantize.hpp"
#include "scene/random.hpp"

namespace {

using namespace bitspan;

constexpr int pairs = 4096;
constexpr Format operand{18, 10, true, Rounding::trn, Overflow::sat, false};
constexpr Format result{20, 14, true, Rounding::rnd_conv, Overflow::sat, false};

std::array<std::array<std::int64_t, 2>, pairs> operands() {
  std::array<std::array<std::int64_t, 2>, pairs> out{};
  Random random(1);
  for (auto& pair : out) {
    for (auto& x : pair) x = random.integer(-(1 << 17), (1 << 17) - 1);
  }
  return out;
}

void multiply_model(benchmark::State& state) {
  const auto in = operands();
  const model::Register target = model::make_register(result);
  for (auto iteration : state) {
    for (const auto& [a, b] : in) {
      benchmark::DoNotOptimize(model::quantize(a * b, 2 * operand.fraction(), target, model::NoObserve{}));
    }
  }
  state.SetItemsProcessed(state.iterations() * pairs);
}
BENCHMARK(multiply_model);

void multiply_sc_fix(benchmark::State& state) {
  const auto in = operands();
  sc_dt::sc_fix a(operand.word, operand.integer);
  sc_dt::sc_fix b(operand.word, operand.integer);
  sc_dt::sc_fix c(result.word, result.integer, sc_dt::SC_RND_CONV, sc_dt::SC_SAT);
  for (auto iteration : state) {
    for (const auto& pair : in) {
      a = static_cast<double>(pair[0]) / (1 << operand.fraction());
      b = static_cast<double>(pair[1]) / (1 << operand.fraction());
      c = a * b;
      benchmark::DoNotOptimize(c);
    }
  }
  state.SetItemsProcessed(state.iterations() * pairs);
}
BENCHMARK(multiply_sc_fix);

}  // namespace
