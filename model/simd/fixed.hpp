// SPDX-License-Identifier: Apache-2.0
// Formats as a kernel reads them: compiled in, or read at run time.
#pragma once

#include <type_traits>

namespace bitspan::model {

// fixed not null: the constants it points to, for the compiler to see. Null: a copy of the kernel's own,
// which no store through a column can change.
template <class Formats, const Formats* fixed>
class FormatsOf {
  struct Nothing {
    explicit Nothing(const Formats& /*same*/) {}
  };
  std::conditional_t<fixed == nullptr, const Formats, const Nothing> copy_;

 public:
  explicit FormatsOf(const Formats& formats) : copy_(formats) {}
  const Formats& operator*() const {
    if constexpr (fixed == nullptr) {
      return copy_;
    } else {
      return *fixed;
    }
  }
};

}  // namespace bitspan::model
