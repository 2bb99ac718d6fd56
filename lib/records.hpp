// SPDX-License-Identifier: Apache-2.0
// Records from outside: what must hold before a stage may read them. Each function throws BS_BAD_INPUT,
// naming the field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "config/config.hpp"
#include "engine/rows.hpp"
#include "scene/scene.hpp"

namespace bitspan::capi {

// Every register is within its format.
void check_registers(const Config& config, RecordType type, std::span<const std::int64_t> record,
                     std::string_view function);
// Of `before` only registers and the flags of the fragment's way changed.
void check_identity(RecordType type, std::span<const std::int64_t> before,
                    std::span<const std::int64_t> record, std::string_view function);
// The vertices are in the order of the edge walk, and the triangle has an area.
void check_setup(const SetupRecord& record, std::string_view function);
// The pixels lie in the picture.
void check_pixels(const RowRecord& row, const View& view, std::string_view function);
void check_pixels(const SpanRecord& span, const View& view, std::string_view function);
// Returns which of the plane's rows has the row's pixels.
std::size_t row_of_plane(const AnyRow& row, const PlaneOfRows& plane, std::string_view function);

}  // namespace bitspan::capi
