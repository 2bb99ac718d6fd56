// SPDX-License-Identifier: Apache-2.0
// What a run of the benchmarks measured, section by section.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/measure.hpp"

namespace bitspan::bench {

struct Options {
  int rounds = 11;         // samples of everything quick enough
  double kernel_time = 0;  // seconds per sample of a kernel
  std::string mesh, texture;
  std::vector<std::string> only;  // sections; empty: all
  bool wants(std::string_view section) const;
};

struct Report {
  std::deque<Series> series;  // addresses stay
  std::vector<Goal> goals;
  std::vector<std::string> notes;
  bool sound = true;  // pictures and records agreed wherever they were compared

  Series& add(std::string name, double work, std::string unit = "Mpixel/s");
  // Returns every row of the report from the series `from` on.
  std::vector<const Series*> since(std::size_t from) const;
};

// One participant of a section: sample() does the work once and returns its seconds.
struct Turn {
  Series* series;
  std::function<double()> sample;
};
// Runs every participant once to warm up, then `rounds` rounds, each beginning with another participant.
// Participants that took longer than a second take part in few rounds. An InputError ends a participant's
// part and is kept as the reason.
void take_turns(const std::string& label, std::vector<Turn>& turns, int rounds);

// The sections, each adding its series and goals.
void bench_kernels(const Options& options, Report& report);
void bench_frames(const std::string& scene, const Options& options, Report& report);
void bench_engines(const Options& options, Report& report);
void bench_interface(const Options& options, Report& report);
void bench_state(const Options& options, Report& report);

// Time and memory against the number of pixels and of triangles, as a text and a JSON object.
struct Growth {
  std::string text, json;
};
Growth bench_growth(double pixels_limit, double triangles_limit);

}  // namespace bitspan::bench
