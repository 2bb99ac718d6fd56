// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/prove.hpp"

#include <fmt/format.h>

#include <bitset>
#include <filesystem>
#include <stdexcept>

#include "io/data_folder.hpp"
#include "tb/programs.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

// `async2sync`: a reset begins between two clocks. `hierconn` wires of the proofs see registers inside a
// cell, so memories become registers before the hierarchy goes.
// Registers are not merged: two that are loaded alike may begin with different values.
std::string yosys_script(const Proof& proof, const std::string& made) {
  std::string script = "read_verilog -sv -formal -DSYNTHESIS";
  const std::filesystem::path proofs = std::filesystem::path(source_path()) / "tests/formal";
  for (const std::string& cell : proof.cells) {
    const std::filesystem::path helper = proofs / (cell + ".sv");
    const std::filesystem::path source = data_folder() / "rtl" / (cell + ".sv");
    script += ' ' + (std::filesystem::exists(source) ? source : helper).string();
  }
  script += fmt::format(" {}; hierarchy -check -top {}_proof", (proofs / (proof.name + ".sv")).string(),
                        proof.name);
  // Yosys takes no sign here.
  for (const auto& [name, value] : proof.parameters) {
    script += fmt::format(" -chparam {} 32'b{}", name,
                          std::bitset<32>(static_cast<unsigned long long>(value)).to_string());
  }
  return script +
         "; proc; memory_collect; memory_map; async2sync; flatten; opt_clean; "
         "setundef -undriven -anyseq; dffunmap; opt_expr; opt_merge t:* t:$dff %d; opt_clean; "
         "write_smt2 -wires " +
         made;
}

}  // namespace

void prove(const Proof& proof) {
  const TemporaryFolder folder;
  const std::string model = folder.path("model.smt2");
  const std::string log = folder.path("log");
  const std::string trace = folder.path("trace.yw");
  if (run_program({"yosys", "-q", "-p", yosys_script(proof, model)}, log, "this test") != 0) {
    throw std::runtime_error(proof.name + ": Yosys refuses\n" + read_file(log));
  }
  // z3 takes minutes instead of a second for what is not unrolled or is asked incrementally.
  const auto solve = [&](const std::vector<std::string>& how) {
    std::vector<std::string> command = {"yosys-smtbmc", "--noprogress", "--unroll",  "--noincr",
                                        "-s",           "z3",           "--dump-yw", trace};
    command.insert(command.end(), how.begin(), how.end());
    command.push_back(model);
    return run_program(command, log, "this test") == 0;
  };
  if (!solve({"--presat", "-t", fmt::format("{}:{}", proof.first, proof.clocks)})) {
    const std::string text = proof.name + ": not proven\n" + read_file(log);
    // Every failure exits with 1; only a failed assertion leaves a trace.
    if (std::filesystem::exists(trace)) throw std::logic_error(text);
    throw std::runtime_error(text);
  }
  if (proof.induction > 0 && !solve({"-i", "-t", std::to_string(proof.induction)})) {
    throw std::runtime_error(proof.name + ": not proven by induction\n" + read_file(log));
  }
}

}  // namespace bitspan
