#include "model/numeric/reciprocal.hpp"

#include <algorithm>

#include "config/reciprocal_table.hpp"
#include "model/numeric/ratio.hpp"
#include "model/numeric/reciprocal-inl.hpp"

namespace bitspan::model {
ReciprocalUnit::ReciprocalUnit(const Reciprocal& config, RegisterId id)
    : formats_(reciprocal_formats(config, id)),
      table_(std::make_shared<const std::vector<std::int64_t>>(reciprocal_table(config))) {}

template <class Watch>
Inverse reciprocal(const ReciprocalFormats& formats, const std::int64_t* table, int128 d, int fraction,
                   Watch watch) {
  const Reciprocal& config = formats.config;
  d = std::max<int128>(d, 1);
  const int top = bit_length(static_cast<uint128>(d)) - 1;
  const int exponent = top - fraction;
  if (config.kind == ReciprocalKind::restoring) {
    return config.normalize ? Inverse{quantize_ratio(int128{1} << top, d, 0, formats.output, watch), exponent}
                            : Inverse{quantize_ratio(1, d, fraction, formats.output, watch), 0};
  }
  int y_fraction = 0;
  const auto leading = [&](auto wide) {
    return HWY_NAMESPACE::shifted_down(wide, top - config.operand_bits);
  };
  const int128 y = formats.narrow && top < 62
                       ? int128{HWY_NAMESPACE::approximate(formats, table,
                                                           leading(static_cast<std::int64_t>(d)), y_fraction)}
                       : HWY_NAMESPACE::approximate(formats, table, leading(d), y_fraction);
  return config.normalize ? Inverse{quantize(y, y_fraction, formats.output, watch), exponent}
                          : Inverse{quantize(y, y_fraction + exponent, formats.output, watch), 0};
}

template Inverse reciprocal(const ReciprocalFormats&, const std::int64_t*, int128, int, NoObserve);
template Inverse reciprocal(const ReciprocalFormats&, const std::int64_t*, int128, int, Observe);

}  // namespace bitspan::model
