// SPDX-License-Identifier: Apache-2.0
// Formal proofs of the RTL's cells, by Yosys, yosys-smtbmc and z3.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace bitspan {

struct Proof {
  std::string name;                // tests/formal/NAME.sv; its module NAME_proof asserts what is to be proven
  std::vector<std::string> cells;  // rtl/CELL.sv, and files of tests/formal that NAME needs
  std::vector<std::pair<std::string, int>> parameters;  // of NAME_proof
  int first = 0;                                        // the first clock whose assertions are checked
  int clocks = 4;                                       // clocks from reset in which no assertion may fail
  int induction = 0;  // assertions that hold for so many clocks hold on the next one; 0: not asked
};

// Returns where the proof holds. Throws std::logic_error with the failed assertion where the solver found
// clocks from the beginning that lead to it, and std::runtime_error with the log where it proves nothing: a
// tool refuses, an assumption contradicts another, or induction fails.
void prove(const Proof& proof);

}  // namespace bitspan
