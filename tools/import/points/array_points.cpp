#include "tools/import/points/array_points.hpp"

#include <fmt/format.h>

#include "tools/import/points/types.hpp"

namespace fieldcast::importing {

void append_array(std::vector<Point>& points, const Point& first, ModbusArea area,
                  std::uint32_t address, unsigned count) {
  const unsigned step = holds_bits(area) ? 1 : registers_of(first.type, first.string_bytes);
  for (unsigned i = 0; i < count && points.size() <= kMaxPoints; ++i) {
    Point point = first;
    point.name = fmt::format("{}-{}", first.name, i);
    point.at = address_text(area, address + std::uint64_t{i} * step);
    point.changes.push_back(fmt::format("element {} of an array of {}", i, count));
    points.push_back(std::move(point));
  }
}

}  // namespace fieldcast::importing
