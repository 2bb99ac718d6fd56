// SPDX-License-Identifier: Apache-2.0
// GMP's integers with an owner.
#pragma once

#include <gmp.h>

namespace bitspan::model {

class BigInteger {
 public:
  BigInteger() { mpz_init(value_); }
  ~BigInteger() { mpz_clear(value_); }
  BigInteger(const BigInteger&) = delete;
  BigInteger& operator=(const BigInteger&) = delete;
  mpz_ptr get() { return value_; }
  void shift_up(mp_bitcnt_t bits) { mpz_mul_2exp(value_, value_, bits); }

 private:
  mpz_t value_;
};

}  // namespace bitspan::model
