// SPDX-License-Identifier: Apache-2.0
#include "study/search/searcher.hpp"

namespace bitspan::searching {

SearchPoint Searcher::max_minus_1() {
  enter("remove");
  return descend(top_, Pick::error, Costs::any, 1);
}

}  // namespace bitspan::searching
