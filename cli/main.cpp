// bitspan: the command line. Exit 0: all held; 1: a difference or a failed bound; 2: bad input or usage.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "cli/commands.hpp"
#include "config/config.hpp"

namespace bitspan {
namespace {

// One line on stderr, whatever the message holds.
int refuse(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  fmt::print(stderr, "bitspan: {}\n", message);
  return exit_bad_input;
}

int run(int argc, char** argv) {
  CLI::App app{"bitspan: a bit-true, configurable, fixed-point model of a raster pipeline"};
  app.name("bitspan");
  app.set_version_flag("--version", std::string("bitspan ") + BITSPAN_VERSION);
  app.require_subcommand(1);
  app.footer(
      "SCENE is a triangle stream (.tri), a mesh (OBJ, PLY, glTF ...), `demo` or `extreme`.\n"
      "Exit: 0 all held, 1 a difference or a failed bound, 2 bad input or usage.\n"
      "Example:\n  bitspan verify demo --config depth16");
  Action action;
  add_demo(app, action);
  add_verify(app, action);
  add_render(app, action);
  add_explain(app, action);
  add_sim(app, action);
  add_fuzz(app, action);
  add_replay(app, action);
  add_study(app, action);
  add_config(app, action);
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
      return refuse("cannot write to standard output");
    }
    return code;
  } catch (const InputError& error) {
    return refuse(error.what());
  } catch (const std::bad_alloc&) {
    return refuse("out of memory");
  } catch (const std::system_error& error) {
    return refuse(error.what());  // a full or closed standard output
  } catch (const std::exception& error) {
    return refuse(fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace
}  // namespace bitspan

int main(int argc, char** argv) { return bitspan::guarded(argc, argv); }
