// SPDX-License-Identifier: Apache-2.0
// The sub-commands. Each adds itself with its options and leaves what is to be run in `action`.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace bitspan {

inline constexpr int exit_held = 0;        // all held
inline constexpr int exit_difference = 1;  // a difference, or a bound that failed
inline constexpr int exit_bad_input = 2;   // bad input or usage
inline constexpr int exit_broken = 3;      // a tool that is missing or broke, or an internal error

// What a command's --help ends with: its exit codes, and examples, one per line. `held` and `difference` say
// what 0 and 1 mean; the command has no 1 where `difference` is empty.
inline std::string help_footer(std::string_view held, std::string_view difference,
                               std::string_view examples) {
  return fmt::format(
      "Exit: 0 {}{}{}; 2 bad input or usage; 3 a missing or broken tool, or an internal error.\n"
      "Example:\n  {}",
      held, difference.empty() ? "" : "; 1 ", difference, examples);
}

using Action = std::function<int()>;

void add_demo(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_render(CLI::App& app, Action& action);
void add_explain(CLI::App& app, Action& action);
void add_sim(CLI::App& app, Action& action);
void add_fuzz(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_vectors(CLI::App& app, Action& action);
void add_check(CLI::App& app, Action& action);
void add_study(CLI::App& app, Action& action);
void add_make(CLI::App& app, Action& action);
void add_dut(CLI::App& app, Action& action);
void add_config(CLI::App& app, Action& action);
void add_completion(CLI::App& app, Action& action);

}  // namespace bitspan
