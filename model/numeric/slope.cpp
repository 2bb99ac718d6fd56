#include "model/numeric/slope.hpp"

#include "model/numeric/ratio.hpp"

namespace bitspan::model {

template <class Watch>
Length make_length(Exact d, SlopeForm form, const ReciprocalUnit& unit, Watch watch) {
  Length length{d, {}, {}, form};
  if (form == SlopeForm::reciprocal) {
    length.inverse = unit(d, watch);
    length.reciprocal = unit.value(length.inverse);
  }
  return length;
}

template <class Watch>
std::int64_t slope(Exact n, const Length& length, const Register& r, Watch watch) {
  return length.form == SlopeForm::divide ? quantize_ratio(n, length.d, r, watch)
                                          : quantize(n * length.reciprocal, r, watch);
}

template Length make_length(Exact, SlopeForm, const ReciprocalUnit&, NoObserve);
template Length make_length(Exact, SlopeForm, const ReciprocalUnit&, Observe);
template std::int64_t slope(Exact, const Length&, const Register&, NoObserve);
template std::int64_t slope(Exact, const Length&, const Register&, Observe);

}  // namespace bitspan::model
