// SPDX-License-Identifier: Apache-2.0
// The functions of bitspan_pkg.sv. A text that is returned holds until the same function's next call.
#include <svdpi.h>

#include "../bitspan_bench.hpp"

namespace {

namespace dv = bitspan_dv;

dv::Bench* bench_of(void* model) { return static_cast<dv::Bench*>(model); }

int size_of(const svOpenArrayHandle array) { return svHigh(array, 1) - svLow(array, 1) + 1; }

std::int64_t& element(const svOpenArrayHandle array, int i) {
  return *static_cast<std::int64_t*>(svGetArrElemPtr1(array, svLow(array, 1) + i));
}

std::vector<std::int64_t> values_of(const svOpenArrayHandle array) {
  std::vector<std::int64_t> out(static_cast<std::size_t>(size_of(array)));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = element(array, static_cast<int>(i));
  return out;
}

}  // namespace

extern "C" {

void* bitspan_open(const char* name, const char* config, const char* settings, const char* engine) {
  return dv::open(name, config, settings, engine);
}

void* bitspan_find(const char* name) { return dv::find(name); }

int bitspan_close(void* model) { return dv::close(bench_of(model)); }

int bitspan_draw(void* model, const char* scene, int width, int height) {
  return dv::begin(bench_of(model), scene, width, height, true);
}

int bitspan_begin(void* model, const char* scene, int width, int height) {
  return dv::begin(bench_of(model), scene, width, height, false);
}

int bitspan_row(void* model, int stage, const svOpenArrayHandle record) {
  return dv::row(bench_of(model), stage, values_of(record));
}

int bitspan_column(void* model, int stage, const char* field) {
  return dv::column(bench_of(model), stage, field);
}

int bitspan_column_of(void* model, int stage, const char* fields, int i) {
  return dv::column_of(bench_of(model), stage, fields, i);
}

int bitspan_columns(void* model, int stage) { return dv::columns(bench_of(model), stage); }

long long bitspan_records(void* model, int stage) { return dv::record_count(bench_of(model), stage); }

int bitspan_fetch(void* model, int stage, long long i, const svOpenArrayHandle record) {
  std::vector<std::int64_t> values;
  const bs_status status =
      dv::fetch(bench_of(model), stage, i, static_cast<std::size_t>(size_of(record)), values);
  for (std::size_t f = 0; f < values.size(); ++f) element(record, static_cast<int>(f)) = values[f];
  return status;
}

int bitspan_check(void* model, int stage, const svOpenArrayHandle record, long long present) {
  return dv::check(bench_of(model), stage, values_of(record), static_cast<std::uint64_t>(present));
}

long long bitspan_matched(void* model, int stage) {
  return static_cast<long long>(dv::counts(bench_of(model), stage).matched);
}

long long bitspan_nontrivial(void* model, int stage) {
  return static_cast<long long>(dv::counts(bench_of(model), stage).nontrivial);
}

long long bitspan_unchecked(void* model, int stage) {
  return static_cast<long long>(dv::counts(bench_of(model), stage).unchecked);
}

long long bitspan_different(void* model, int stage) {
  return static_cast<long long>(dv::counts(bench_of(model), stage).different);
}

const char* bitspan_divergence(void* model) { return model == nullptr ? "" : bench_of(model)->first.c_str(); }

const char* bitspan_last_error() { return dv::error().c_str(); }

}  // extern "C"
