// SPDX-License-Identifier: Apache-2.0
// A tree of boxes in the plane, each with a number. Boost's headers take seconds to compile: to be included
// by sources alone.
#pragma once

#define BOOST_ALLOW_DEPRECATED_HEADERS  // else the compiler notes that Boost's tree includes one

#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

namespace bitspan::golden {

class BoxTree {
 public:
  using Place = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
  using Box = boost::geometry::model::box<Place>;
  using Entry = std::pair<Box, std::uint32_t>;

  explicit BoxTree(const std::vector<Entry>& entries) : boxes_(entries) {}
  // Those that a place or a box touches, in no order.
  template <class Geometry>
  std::vector<Entry> touching(const Geometry& geometry) const {
    std::vector<Entry> out;
    boxes_.query(boost::geometry::index::intersects(geometry), std::back_inserter(out));
    return out;
  }

 private:
  boost::geometry::index::rtree<Entry, boost::geometry::index::quadratic<8>> boxes_;
};

}  // namespace bitspan::golden
