// SPDX-License-Identifier: Apache-2.0
// A batch of records as columns, a field an array: how records pass between the vector form's stages. The
// names are the records' own (engine/records.hpp).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "engine/records.hpp"

namespace bitspan::model {

// Columns may be written this many values past their size: whole vectors of the widest target.
inline constexpr std::size_t column_slack = 16;

template <class R>
class Columns {
 public:
  using Field = std::int64_t R::*;
  explicit Columns(std::size_t capacity = 0) { reserve(capacity); }

  std::size_t capacity() const { return capacity_; }
  // Keeps what is there.
  void reserve(std::size_t capacity) {
    if (capacity <= capacity_ && data_ != nullptr) return;
    const std::size_t stride = (capacity + column_slack + 7) / 8 * 8;
    constexpr std::size_t fields = sizeof(R) / sizeof(std::int64_t);
    std::unique_ptr<std::int64_t[], Free> grown(
        static_cast<std::int64_t*>(::operator new[](fields* stride * sizeof(std::int64_t), alignment)));
    for (std::size_t i = 0; size != 0 && i < fields; ++i) {
      std::memcpy(grown.get() + i * stride, data_.get() + i * stride_, size * sizeof(std::int64_t));
    }
    data_ = std::move(grown);
    capacity_ = capacity;
    stride_ = stride;
  }
  std::int64_t* operator[](Field field) { return data_.get() + index(field) * stride_; }
  const std::int64_t* operator[](Field field) const { return data_.get() + index(field) * stride_; }

  // Record i; the columns that nobody wrote hold anything.
  R record(std::size_t i) const {
    constexpr std::size_t fields = sizeof(R) / sizeof(std::int64_t);
    std::array<std::int64_t, fields> raw;
    for (std::size_t f = 0; f < fields; ++f) raw[f] = data_[f * stride_ + i];
    return std::bit_cast<R>(raw);
  }

  std::size_t size = 0;  // records; set by whoever writes them

 private:
  static constexpr std::align_val_t alignment{64};
  struct Free {
    void operator()(std::int64_t* p) const { ::operator delete[](p, alignment); }
  };
  static std::size_t index(Field field) { return std::bit_cast<std::size_t>(field) / sizeof(std::int64_t); }

  std::unique_ptr<std::int64_t[], Free> data_;
  std::size_t capacity_ = 0, stride_ = 0;
};

}  // namespace bitspan::model
