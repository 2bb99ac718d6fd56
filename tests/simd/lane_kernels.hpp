// SPDX-License-Identifier: Apache-2.0
// The operations of model/numeric/*-inl.hpp over arrays, one table of them a target: what lanes_test.cpp
// holds against the scalar routines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "config/config.hpp"
#include "model/numeric/exact.hpp"
#include "model/numeric/observe.hpp"
#include "model/numeric/reciprocal.hpp"

namespace bitspan::model {

// Where an observed kernel notes; active: one truth value an element. Unobserved where statistics is null.
struct Watching {
  Statistics* statistics = nullptr;
  const Config* config = nullptr;
  const std::uint8_t* active = nullptr;
};

// Every array has n elements; n may be any number.
struct LaneKernels {
  std::size_t lanes;  // of 64 bits
  // raw 2^-fraction into r, one fraction for all or one each.
  void (*quantize32)(const std::int32_t* raw, std::size_t n, int fraction, const Register& r,
                     std::int32_t* out);
  void (*quantize64)(const std::int64_t* raw, std::size_t n, int fraction, const Register& r, Watching w,
                     std::int64_t* out);
  void (*quantize128)(const int128* raw, std::size_t n, int fraction, const Register& r, Watching w,
                      std::int64_t* out);
  void (*quantize64_each)(const std::int64_t* raw, const std::int64_t* fraction, std::size_t n,
                          const Register& r, Watching w, std::int64_t* out);
  void (*quantize128_each)(const int128* raw, const std::int64_t* fraction, std::size_t n, const Register& r,
                           Watching w, std::int64_t* out);
  // (n / d) 2^scale into r
  void (*ratio64)(const std::int64_t* numerator, const std::int64_t* d, std::size_t n, int scale,
                  const Register& r, Watching w, std::int64_t* out);
  void (*ratio128)(const int128* numerator, const std::int64_t* d, std::size_t n, int scale,
                   const Register& r, Watching w, std::int64_t* out);
  // How many lanes of those would not have been divided by quotient() itself.
  std::size_t (*ratio128_refused)(const int128* numerator, const std::int64_t* d, std::size_t n, int scale);
  void (*reciprocal)(const ReciprocalFormats& f, const std::int64_t* table, const std::int64_t* d,
                     std::size_t n, int fraction, Watching w, std::int64_t* m, std::int64_t* e);
  void (*product)(const std::int64_t* a, const std::int64_t* b, std::size_t n, int128* out);
  void (*add)(const int128* a, const int128* b, std::size_t n, int128* out);
  void (*subtract)(const int128* a, const int128* b, std::size_t n, int128* out);
  void (*shift_left)(const int128* a, std::size_t n, int by, int128* out);
  void (*shift_right)(const int128* a, std::size_t n, int by, int128* out);
  void (*shift_left_each)(const int128* a, const std::int64_t* by, std::size_t n, int128* out);
  void (*shift_right_each)(const int128* a, const std::int64_t* by, std::size_t n, int128* out);
  void (*top_bit)(const std::int64_t* a, std::size_t n, std::int64_t* out);
};

// Returns the kernels of the target that Highway's dispatch is set to (TargetScope).
const LaneKernels& lane_kernels();

}  // namespace bitspan::model
