// SPDX-License-Identifier: Apache-2.0
#include "study/budget.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include "config/check.hpp"
#include "model/numeric/register.hpp"
#include "report/error.hpp"
#include "study/engines.hpp"

namespace bitspan {
namespace {

using model::RegisterId;
constexpr int extra_most = 16;

RegisterId id_of_name(const std::string& name) {
  for (int i = 0; i < model::register_count; ++i) {
    const auto id = static_cast<RegisterId>(i);
    if (model::name_of(id) == name) return id;
  }
  throw InputError("no register is named '" + name + "'");
}

void widen(Config& config, const Quantisation& q) {
  const auto divide = [&](Reciprocal& unit) {
    unit.kind = ReciprocalKind::restoring;
    unit.output.word += q.extra_bits;
  };
  const RegisterId id = id_of_name(q.name);
  switch (id) {
    case RegisterId::edge_reciprocal:
      return divide(config.edge_reciprocal);
    case RegisterId::row_reciprocal:
      return divide(config.row_reciprocal);
    case RegisterId::pixel_reciprocal:
      return divide(config.pixel_reciprocal);
    default:
      config.format(static_cast<FormatId>(id)).word += q.extra_bits;
  }
}

// Returns the start offset of that name where it is half an ulp. Half an ulp of an exact register is next to
// nothing, but may be finer than the accumulator that it is added to.
StartOffset* offset_named(Config& config, std::string_view key) {
  StartOffsets& o = config.start_offset;
  const std::pair<std::string_view, StartOffset*> all[] = {
      {"edge_x", &o.edge_x},         {"edge_h", &o.edge_h}, {"edge_f", &o.edge_f},
      {"edge_shade", &o.edge_shade}, {"span_h", &o.span_h}, {"span_f", &o.span_f},
      {"span_shade", &o.span_shade}};
  for (const auto& [name, offset] : all) {
    if (key == "start_offset." + std::string(name) && offset->half_ulp) return offset;
  }
  return nullptr;
}

bool legal(const Config& config, const std::vector<Quantisation>& quantisations) {
  const auto too_wide = [](const Format& f) { return f.word > (f.is_signed ? 64 : 63); };
  const Config wide = with_exact(config, quantisations);
  return std::none_of(wide.formats.begin(), wide.formats.end(), too_wide) && !first_violation(wide);
}

// False for what is input or output.
bool is_candidate(const std::string& name) {
  const RegisterId id = id_of_name(name);
  return id != RegisterId::coordinate && id != RegisterId::depth_z &&
         id != model::id_of(FormatId::merge_color);
}

std::vector<Quantisation> all_but(const std::vector<Quantisation>& all, std::size_t one) {
  std::vector<Quantisation> out = all;
  out.erase(out.begin() + static_cast<std::ptrdiff_t>(one));
  return out;
}

Metrics chosen(const Metrics& all, const std::vector<std::string>& names) {
  Metrics out;
  for (const std::string& name : names) {
    const auto found = all.find(name);
    if (found == all.end()) throw InputError("no metric is named '" + name + "'");
    out[name] = found->second;
  }
  return out;
}

DominantMap dominant(const Scene& scene, const Frame& ideal, const Config& config,
                     const std::vector<Quantisation>& all) {
  std::vector<std::vector<double>> errors(all.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t q) {
    const Frame frame = drawn("model", with_exact(config, all_but(all, q)), scene);
    errors[q] = picture_errors(frame, ideal).texture;
  });
  DominantMap map{scene.name, scene.width, scene.height, {}};
  map.cause.assign(ideal.depth.size(), -1);
  for (std::size_t i = 0; i < map.cause.size(); ++i) {
    double largest = 0;
    for (std::size_t q = 0; q < all.size(); ++q) {
      if (errors[q][i] > largest) {  // false for a NaN
        largest = errors[q][i];
        map.cause[i] = static_cast<std::int16_t>(q);
      }
    }
  }
  return map;
}

}  // namespace

Config with_exact(const Config& config, const std::vector<Quantisation>& quantisations) {
  Config out = config;
  for (const Quantisation& q : quantisations) widen(out, q);
  while (const auto violation = first_violation(out)) {
    StartOffset* const offset = offset_named(out, violation->key);
    if (offset == nullptr) break;
    *offset = {};
  }
  return out;
}

Budget error_budget(const PointMeter& meter, const Config& config, const std::vector<std::string>& metrics,
                    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  Budget out;
  out.metrics = metrics;
  const PointResult base = meter.measure(config, false);
  out.base = chosen(base.metrics, metrics);

  // Each quantisation gets one more bit in turn, as long as the rules hold for all of them together.
  std::vector<Quantisation> all;
  for (const RegisterUse& use : base.registers) {
    if (is_candidate(use.name)) all.push_back({use.name, 0});
  }
  std::vector<bool> full(all.size());
  for (int bits = 0; bits < extra_most; ++bits) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (full[i]) continue;
      ++all[i].extra_bits;
      if (!legal(config, all)) {
        --all[i].extra_bits;
        full[i] = true;
      }
    }
  }
  std::erase_if(all, [&](const Quantisation& q) {
    if (q.extra_bits == 0) out.kept.push_back(q.name);
    return q.extra_bits == 0;
  });

  // Point 0 has all exact. Two points per quantisation follow.
  out.rows.resize(all.size());
  const std::size_t total = 1 + 2 * all.size();
  std::atomic<std::size_t> done = 0;
  std::mutex told;
  tbb::parallel_for(
      std::size_t{0}, total,
      [&](std::size_t point) {
        if (point == 0) {
          out.exact = chosen(meter.measure(with_exact(config, all), false).metrics, metrics);
        } else {
          const std::size_t q = (point - 1) / 2;
          BudgetRow& row = out.rows[q];
          row.quantisation = all[q];
          if (point % 2 == 1) {
            Quantisation one = all[q];  // alone it may be allowed fewer
            while (one.extra_bits > 0 && !legal(config, {one})) --one.extra_bits;
            row.without = chosen(meter.measure(with_exact(config, {one}), false).metrics, metrics);
          } else {
            row.alone = chosen(meter.measure(with_exact(config, all_but(all, q)), false).metrics, metrics);
          }
        }
        const std::size_t now = ++done;
        if (progress) {
          const std::lock_guard lock(told);
          progress(now, total);
        }
      },
      tbb::simple_partitioner());
  for (std::size_t s = 0; s < meter.scenes().size(); ++s) {
    out.maps.push_back(dominant(meter.scenes()[s], *meter.ideal(config, s), config, all));
  }
  return out;
}

}  // namespace bitspan
