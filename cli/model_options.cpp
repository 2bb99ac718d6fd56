// SPDX-License-Identifier: Apache-2.0
#include "cli/model_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "config/config.hpp"

namespace bitspan {
void add_model_options(CLI::App& command, ModelFlags& flags, const std::string& default_threads) {
  const char* group = "Engine model";
  command
      .add_option(
          "--form", flags.form,
          "auto (default), scalar, vector, or specialised: for a shipped configuration, with its formats "
          "compiled in; the same bits from each")
      ->group(group);
  command.add_option("--target", flags.target, "vectors for best (default), avx512, avx2 or baseline")
      ->group(group);
  command
      .add_option("--threads", flags.threads,
                  fmt::format("threads that share the picture, 0: one for each processor (default: {})",
                              default_threads))
      ->group(group);
}

EngineOptions engine_options(const ModelFlags& flags, int threads) {
  EngineOptions out;
  out.form = flags.form;
  out.target = flags.target;
  out.threads = flags.threads.value_or(threads);
  if (out.threads < 0 || out.threads > threads_limit) {
    throw InputError(fmt::format("--threads: {} is out of range; expected 1..{}, or 0 for one each processor",
                                 out.threads, threads_limit));
  }
  if (out.threads == 0) {
    out.threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, threads_limit);
  }
  find_engine("model").check(out);
  return out;
}

void refuse_without_model(const ModelFlags& flags, bool model_takes_part) {
  if (model_takes_part || !flags.given()) return;
  const char* flag = !flags.form.empty() ? "--form" : !flags.target.empty() ? "--target" : "--threads";
  throw InputError(fmt::format("{}: only the engine model has it, and it takes no part here", flag));
}

std::string flags_text(const ModelFlags& flags) {
  std::string out;
  if (!flags.form.empty()) out += " --form " + flags.form;
  if (!flags.target.empty()) out += " --target " + flags.target;
  if (flags.threads) out += fmt::format(" --threads {}", *flags.threads);
  return out;
}

}  // namespace bitspan
