#include "cli/model_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <thread>

#include "config/config.hpp"
#include "model/paths.hpp"
#include "model/simd/targets.hpp"

namespace bitspan {
namespace {

// The value of that name, one of `legal`, each of which to_string names.
template <class T, std::size_t n>
T named(const std::string& flag, const std::string& name, const std::array<T, n>& legal) {
  const auto* const at =
      std::ranges::find_if(legal, [&](T value) { return model::to_string(value) == name; });
  if (at != legal.end()) return *at;
  std::string names;
  for (const T value : legal)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", model::to_string(value));
  throw InputError(fmt::format("{}: '{}' is unknown; legal: {}", flag, name, names));
}

}  // namespace

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

ModelOptions model_options(const ModelFlags& flags, int threads) {
  ModelOptions out;
  if (!flags.form.empty()) {
    out.form =
        named("--form", flags.form,
              std::array{ModelForm::automatic, ModelForm::scalar, ModelForm::vector, ModelForm::specialised});
  }
  if (!flags.target.empty()) {
    out.target = named(
        "--target", flags.target,
        std::array{VectorTarget::best, VectorTarget::avx512, VectorTarget::avx2, VectorTarget::baseline});
    if (!model::supported(out.target)) {
      throw InputError(fmt::format("--target {}: this processor has no such instructions; best takes {}",
                                   flags.target, model::to_string(model::best_target())));
    }
  }
  out.threads = flags.threads.value_or(threads);
  if (out.threads < 0 || out.threads > threads_limit) {
    throw InputError(fmt::format("--threads: {} is out of range; expected 1..{}, or 0 for one each processor",
                                 out.threads, threads_limit));
  }
  if (out.threads == 0) {
    out.threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, threads_limit);
  }
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
