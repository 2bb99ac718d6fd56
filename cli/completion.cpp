// SPDX-License-Identifier: Apache-2.0
// bitspan completion: the completion script of bash, made from the options as they are declared.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.hpp"
#include "config/store.hpp"
#include "engine/registry.hpp"
#include "golden/oracle.hpp"
#include "report/suites.hpp"

namespace bitspan {
namespace {

// The tables that the function begins with; a key is a command as it is typed, or a command and a flag.
struct Tables {
  std::string commands, flags, values;
};

// Stands for the names of files in the tables of values.
constexpr std::string_view files = "FILE";

// What an option takes. Returns words and `files`, in the order in which they are offered.
std::string values_of(const CLI::Option& option) {
  const std::string& name = option.get_single_name();
  if (name == "config" || name == "point") {
    std::string words;
    for (const ShippedConfig& shipped : config_texts()) words += fmt::format("{} ", shipped.name);
    return words.append(files);
  }
  if (name == "engine") {
    return fmt::format("{} oracle:{}", fmt::join(engine_names(), " "), oracle_names(" oracle:", true));
  }
  if (name == "engines") return fmt::format("{}", fmt::join(engine_names(), " "));
  if (name == "oracles") return "all " + oracle_names(" ");
  if (name == "suite") {
    std::string words;
    for (const SuiteFeature& feature : suite_features()) words += feature.name + "/* ";
    return words;
  }
  if (name == "scene" || name == "study") return fmt::format("demo floor mirror room extreme {}", files);
  // A choice: "TEXT:{cycle,span}".
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  if (open != std::string::npos) {
    std::string words = type.substr(open + 1, type.find('}') - open - 1);
    std::ranges::replace(words, ',', ' ');
    return words;
  }
  return type.starts_with("TEXT") ? std::string(files) : "";
}

std::string row(const std::string& key, const std::string& words) {
  return fmt::format("    ['{}']='{}'\n", key, words);
}

void add_rows(const CLI::App& app, const std::string& command, Tables& tables) {
  std::vector<std::string> flags;
  std::string places;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) {
      places = places.empty() ? values_of(*option) : places;
      continue;
    }
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    if (option->get_items_expected_max() == 0) continue;
    const std::string words = values_of(*option);
    for (const std::string& name : option->get_snames()) tables.values += row(command + " -" + name, words);
    for (const std::string& name : option->get_lnames()) tables.values += row(command + " --" + name, words);
  }
  tables.flags += row(command, fmt::format("{}", fmt::join(flags, " ")));
  if (!places.empty()) tables.values += row(command, places);

  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(sub->get_name());
    add_rows(*sub, command + " " + sub->get_name(), tables);
  }
  if (!names.empty()) tables.commands += row(command, fmt::format("{}", fmt::join(names, " ")));
}

constexpr std::string_view script = R"__bash__(# SPDX-License-Identifier: Apache-2.0
# Completes bitspan's commands, flags, configurations and engines in bash; `bitspan completion` prints it.
_bitspan() {{
  local -A commands=(
{}  )
  local -A flags=(
{}  )
  # What follows a flag or, without one, the command.
  local -A values=(
{}  )
  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} command=bitspan i names
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ -n ${{COMP_WORDS[i]}} && " ${{commands[$command]-}} " == *" ${{COMP_WORDS[i]}} "* ]]; then
      command+=" ${{COMP_WORDS[i]}}"
    fi
  done
  # bash takes the = of --flag=value for a word.
  if [[ $previous == = ]]; then
    previous=${{COMP_WORDS[COMP_CWORD - 2]}}
  elif [[ $word == = ]]; then
    word=
  fi
  COMPREPLY=()
  if [[ -n ${{values["$command $previous"]+named}} ]]; then
    names=${{values["$command $previous"]}}
  elif [[ $word == -* ]]; then
    names=${{flags[$command]}}
  else
    names="${{commands[$command]-}} ${{values[$command]-}}"
  fi
  if [[ $previous == --engines && $word == *,* ]]; then
    mapfile -t COMPREPLY < <(compgen -P "${{word%,*}}," -W "$names" -- "${{word##*,}}")
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "${{names%FILE}}" -- "$word")
  if [[ $names == *FILE ]]; then
    mapfile -t -O ${{#COMPREPLY[@]}} COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames 2>/dev/null
  fi
}}
complete -F _bitspan bitspan
)__bash__";

std::string bash_completion(const CLI::App& app) {
  Tables tables;
  add_rows(app, app.get_name(), tables);
  return fmt::format(script, tables.commands, tables.flags, tables.values);
}

}  // namespace

void add_completion(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("completion", "print the completion script of bash");
  sub->footer(help_footer("the script is printed", "", "bitspan completion >bitspan.bash"));
  sub->callback([&app, &action] {
    action = [&app] {
      fmt::print("{}", bash_completion(app));
      return exit_held;
    };
  });
}

}  // namespace bitspan
