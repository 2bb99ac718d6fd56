// The sub-commands. Each adds itself with its options and leaves what is to be run in `action`.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace bitspan {

inline constexpr int exit_held = 0;        // all held
inline constexpr int exit_difference = 1;  // a difference, or a bound that failed
inline constexpr int exit_bad_input = 2;   // bad input or usage

using Action = std::function<int()>;

void add_demo(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_render(CLI::App& app, Action& action);
void add_explain(CLI::App& app, Action& action);
void add_sim(CLI::App& app, Action& action);
void add_fuzz(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_study(CLI::App& app, Action& action);
void add_config(CLI::App& app, Action& action);

}  // namespace bitspan
