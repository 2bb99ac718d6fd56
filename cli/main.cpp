// SPDX-License-Identifier: Apache-2.0
// bitspan: the command line. Exit 0: all held; 1: a difference, a failed bound or an empty verdict; 2: bad
// input or usage; 3: a missing or broken tool, or an internal error.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "cli/commands.hpp"
#include "cli/scene_options.hpp"
#include "config/config.hpp"
#include "engine/registry.hpp"
#include "io/leftovers.hpp"
#include "io/message.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

// One line on stderr, whatever the message holds; returns the code.
int refuse(std::string message, int code = exit_bad_input) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  say("bitspan: " + message + "\n");
  return code;
}

std::string stdout_fault(const std::error_code& error) {
  return "standard output: cannot write: " + error.message() + "; expected an output that can be written";
}

int run(int argc, char** argv) {
  CLI::App app{"bitspan: a bit-true, configurable, fixed-point model of a raster pipeline"};
  app.name("bitspan");
  app.set_version_flag("--version", std::string("bitspan ") + BITSPAN_VERSION);
  app.require_subcommand(1);
  app.footer(
      "SCENE is a triangle stream (.tri, .trib), a mesh (OBJ, PLY, glTF ...), `demo` or `extreme`.\n"
      "Each command has --help.\n" +
      help_footer("all held", "a difference, a failed bound, or nothing compared or drawn",
                  "bitspan verify demo --config depth16"));
  Action action;
  add_demo(app, action);
  add_verify(app, action);
  add_render(app, action);
  add_explain(app, action);
  add_sim(app, action);
  add_fuzz(app, action);
  add_replay(app, action);
  add_vectors(app, action);
  add_check(app, action);
  add_study(app, action);
  add_make(app, action);
  add_dut(app, action);
  add_config(app, action);
  add_completion(app, action);
  const auto commands = app.get_subcommands([](CLI::App*) { return true; });
  const auto named = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  if (argc > 1 && *argv[1] != '-' && std::ranges::none_of(commands, named)) {
    return refuse(fmt::format("'{}' is no command (see bitspan --help)", argv[1]));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      return app.exit(error);  // --help, --version
    }
    return refuse(fmt::format("{} (see bitspan --help)", error.what()));
  }
  return action();
}

int guarded(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    // A report that did not arrive is no success.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      return refuse(stdout_fault({errno, std::generic_category()}));
    }
    return code;
  } catch (const InputError& error) {
    return refuse(error.what());
  } catch (const NothingDrawn& empty) {
    return refuse(empty.what(), exit_difference);
  } catch (const DesignFault& fault) {
    return refuse(fmt::format("{} broke off: {}", fault.engine, fault.what()), exit_difference);
  } catch (const ToolError& error) {
    return refuse(error.what(), exit_broken);
  } catch (const std::bad_alloc&) {
    return refuse("out of memory", exit_broken);
  } catch (const std::system_error& error) {
    return refuse(std::ferror(stdout) != 0 ? stdout_fault(error.code()) : error.what());
  } catch (const std::exception& error) {
    return refuse(fmt::format("internal error: {}", error.what()), exit_broken);
  }
}

}  // namespace
}  // namespace bitspan

int main(int argc, char** argv) {
  bitspan::open_standard_streams();
  bitspan::remove_leftovers_on_signals();
  return bitspan::guarded(argc, argv);
}
