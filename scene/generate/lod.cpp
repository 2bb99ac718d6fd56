// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/lod.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "scene/geometry.hpp"

namespace bitspan {
namespace {

std::size_t sample_of(const HeightField& field, const GridPoint& p) {
  return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(field.columns) +
         static_cast<std::size_t>(p.x);
}

double height_of(const HeightField& field, const GridPoint& p) { return field.at(p.x, p.y); }

// Adds up errors of samples.
struct ErrorSum {
  double largest = 0, squares = 0;
  std::size_t count = 0;

  void add(double error) {
    largest = std::max(largest, std::abs(error));
    squares += error * error;
    ++count;
  }
  SurfaceError result() const {
    return {largest, count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0};
  }
};

// The first k with numerator + k * step >= 0, for a step above 0.
std::int64_t first_at_least_0(std::int64_t numerator, std::int64_t step) {
  return numerator >= 0 ? -(numerator / step) : (-numerator + step - 1) / step;
}

// Calls call(sample, height) for each sample in a triangle and on its edges, with the height of the triangle
// there.
template <class Call>
void for_each_sample(const HeightField& field, const Delaunay& surface,
                     const std::array<std::uint32_t, 3>& corners, const Call& call) {
  std::array<GridPoint, 3> p;
  std::array<double, 3> height{};
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = surface.points()[corners[k]];
    height[k] = height_of(field, p[k]);
  }
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  // weight[k] is twice the area across from corner k; it grows by dx[k] per column.
  std::array<std::int64_t, 3> dx{}, weight{};
  for (std::size_t k = 0; k < 3; ++k) dx[k] = std::int64_t{p[(k + 1) % 3].y} - p[(k + 2) % 3].y;
  for (std::int32_t y = top; y <= bottom; ++y) {
    std::int64_t from = 0, to = std::int64_t{right} - left;
    for (std::size_t k = 0; k < 3; ++k) {
      const GridPoint &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
      weight[k] =
          (std::int64_t{b.x} - a.x) * (y - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{left} - a.x);
      if (dx[k] > 0) {
        from = std::max(from, first_at_least_0(weight[k], dx[k]));
      } else if (dx[k] < 0) {
        to = std::min(to, -first_at_least_0(weight[k], -dx[k]));
      } else if (weight[k] < 0) {
        to = -1;
      }
    }
    for (std::int64_t i = from; i <= to; ++i) {
      double sum = 0, area = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto part = static_cast<double>(weight[k] + i * dx[k]);
        sum += part * height[k];
        area += part;
      }
      call(sample_of(field, {static_cast<std::int32_t>(left + i), y}), sum / area);
    }
  }
}

// Ranking of the points: their costs, and a queue of them.
class Ranking {
 public:
  Ranking(const HeightField& field, const LodOptions& options)
      : field_(field), options_(options), surface_(chosen_points(field, [](int, int) { return true; })) {
    surface_.insert_all();
    const std::size_t n = surface_.points().size();
    cost_.assign(n, 0);
    normal_.resize(n);
    error_.assign(n, 0);
    seen_.assign(n, 0);
    for (std::uint32_t p = 0; p < n; ++p) normal_[p] = mean_normal(p);
    for (std::uint32_t p = 4; p < n; ++p) push(p);
  }

  // Takes the points of least cost out until `left` are in. Returns those that went.
  std::vector<std::uint32_t> take_out(std::size_t left) {
    std::vector<std::uint32_t> gone;
    std::vector<std::uint32_t> around;
    while (surface_.size() > left && !queue_.empty()) {
      const auto [cost, p] = queue_.top();
      queue_.pop();
      // An entry from before the cost changed.
      if (!surface_.has(p) || cost != cost_[p]) continue;
      surface_.neighbours(p, around);
      surface_.remove(p, &hole_);
      for (const auto& corners : hole_) {
        for_each_sample(field_, surface_, corners, [&](std::size_t sample, double height) {
          error_[sample] = height - field_.heights[sample];
        });
      }
      gone.push_back(p);
      for (const std::uint32_t q : around) {
        if (q >= 4) push(q);
      }
    }
    return gone;
  }

  const Delaunay& surface() const { return surface_; }

 private:
  Vec3 place(std::uint32_t p) const {
    const GridPoint& at = surface_.points()[p];
    return {static_cast<double>(at.x), height_of(field_, at) * options_.steepness, static_cast<double>(at.y)};
  }
  // The sum of the normals of the faces around it, each of length 1.
  Vec3 mean_normal(std::uint32_t p) {
    surface_.neighbours(p, around_);
    const Vec3 at = place(p);
    const std::size_t n = around_.size();
    Vec3 sum;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 a = place(around_[i]) - at, b = place(around_[(i + 1) % n]) - at;
      const Vec3 up = cross(b, a);
      // Between the two ends of an open star is no face.
      if (up.y > 0) sum = sum + of_length_1(up);
    }
    return of_length_1(sum);
  }
  double normal_cost(std::uint32_t p) {
    surface_.neighbours(p, around_);
    const Vec3 at = place(p);
    double cost = 0;
    for (const std::uint32_t q : around_) {
      const double off = dot(normal_[p], place(q) - at);
      cost += off * off;
    }
    return cost;
  }
  // By taking it out, and putting it back, which leaves no trace.
  double error_cost(std::uint32_t p) {
    surface_.remove(p, &hole_);
    ++look_;
    double cost = 0;
    for (const auto& corners : hole_) {
      for_each_sample(field_, surface_, corners, [&](std::size_t sample, double height) {
        if (seen_[sample] == look_) return;
        seen_[sample] = look_;
        const double error = height - field_.heights[sample];
        cost += error * error - error_[sample] * error_[sample];
      });
    }
    surface_.insert(p);
    return cost;
  }
  void push(std::uint32_t p) {
    cost_[p] = options_.cost == LodCost::error ? error_cost(p) : normal_cost(p);
    queue_.emplace(cost_[p], p);
  }

  const HeightField& field_;
  LodOptions options_;
  Delaunay surface_;
  std::vector<double> cost_;
  std::vector<Vec3> normal_;
  std::vector<double> error_;        // of each sample now
  std::vector<std::uint64_t> seen_;  // when a sample was last looked at
  std::uint64_t look_ = 0;
  std::vector<std::uint32_t> around_;
  std::vector<std::array<std::uint32_t, 3>> hole_;
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

SurfaceError surface_error(const HeightField& field, const Delaunay& surface) {
  ErrorSum sum;
  std::vector<bool> is_done(field.heights.size(), false);
  for (const auto& corners : surface.triangles()) {
    for_each_sample(field, surface, corners, [&](std::size_t sample, double height) {
      if (is_done[sample]) return;  // on an edge of a triangle before
      is_done[sample] = true;
      sum.add(height - field.heights[sample]);
    });
  }
  return sum.result();
}

SurfaceError grid_error(const HeightField& field, std::size_t points) {
  const double width = field.columns - 1, depth = field.rows - 1;
  const double n = static_cast<double>(points);
  const int c = std::max(2, static_cast<int>(std::lround(std::sqrt(n * field.columns / field.rows))));
  const int r = std::max(2, static_cast<int>(std::lround(n / c)));
  const auto corner = [&](int i, int j) {
    return height_at(field, i * width / (c - 1), j * depth / (r - 1));
  };
  ErrorSum sum;
  for (int y = 0; y < field.rows; ++y) {
    for (int x = 0; x < field.columns; ++x) {
      const double u = x * (c - 1) / width, v = y * (r - 1) / depth;
      const int i = std::min(static_cast<int>(u), c - 2), j = std::min(static_cast<int>(v), r - 2);
      const double a = u - i, b = v - j;
      // The diagonal goes from the lower left to the upper right corner.
      const double one = corner(i + 1, j), two = corner(i, j + 1);
      const double height = a + b <= 1 ? corner(i, j) * (1 - a - b) + one * a + two * b
                                       : corner(i + 1, j + 1) * (a + b - 1) + one * (1 - b) + two * (1 - a);
      sum.add(height - field.at(x, y));
    }
  }
  return sum.result();
}

Lod make_lod(const HeightField& field, const LodOptions& options, const WorkProgress& progress) {
  Ranking ranking(field, options);
  const std::size_t all = field.heights.size();
  Lod out;
  out.rank.assign(all, options.ranks);
  for (int r = 0; r < options.ranks; ++r) {
    const double share = std::pow(options.keep, (r + 1.0) / options.ranks);
    const auto left =
        std::max<std::size_t>(4, static_cast<std::size_t>(std::lround(static_cast<double>(all) * share)));
    for (const std::uint32_t p : ranking.take_out(left)) {
      out.rank[sample_of(field, ranking.surface().points()[p])] = r;
    }
    LodRank rank{ranking.surface().size(), ranking.surface().triangle_count(),
                 surface_error(field, ranking.surface()), 0};
    rank.bound = std::max(rank.error.largest, out.ranks.empty() ? 0 : out.ranks.back().bound);
    out.ranks.push_back(rank);
    if (progress) progress(static_cast<std::size_t>(r) + 1, static_cast<std::size_t>(options.ranks));
  }
  return out;
}

Delaunay lod_surface(const HeightField& field, const std::vector<std::int32_t>& rank, std::int32_t least) {
  Delaunay out(chosen_points(field, [&](int i, int j) { return rank[sample_of(field, {i, j})] >= least; }));
  out.insert_all();
  return out;
}

MeshCounts write_surface(const HeightField& field, const TerrainPlace& place, const Delaunay& surface,
                         ObjWriter& out) {
  const PlacedField placed(field, place);
  std::vector<std::uint32_t> number(surface.points().size());
  MeshCounts counts;
  for (std::uint32_t p = 0; p < number.size(); ++p) {
    if (!surface.has(p)) continue;
    number[p] = static_cast<std::uint32_t>(counts.vertices++);
    const GridPoint& at = surface.points()[p];
    placed.write(out, at.x, height_of(field, at), at.y);
  }
  for (const auto& corner : surface.triangles()) {
    // Seen from above, z runs downward.
    out.face(std::array{number[corner[0]], number[corner[2]], number[corner[1]]});
    ++counts.triangles;
  }
  return counts;
}

}  // namespace bitspan
