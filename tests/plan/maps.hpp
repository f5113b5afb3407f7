#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/dispatch/scheduler.hpp"
#include "tests/plan/fake_protocol.hpp"

namespace fieldcast::test {

struct MapRow {
  unsigned unit = 1;
  std::uint32_t address = 0;
  double refresh = 1;  // seconds
};
using Map = std::vector<MapRow>;

// Reads a file with the columns unit,address,refresh; throws std::runtime_error with the reason.
[[nodiscard]] Map read_map(const std::string& path);

[[nodiscard]] Map random_map(std::uint64_t seed, std::size_t channels, unsigned units = 3);

// Modbus RTU with 11 bits per character and a silence of 3.5 characters before and after a
// response. A read of n registers takes 20 + 2n characters and the device's delay.
[[nodiscard]] ScheduleInput input_of(const Map& map, const Protocol& protocol,
                                     std::uint32_t baud = 19200, Duration delay = {},
                                     double stretch = 1);

// How a protocol writes a register: "holding:" and its number, or "VW" and twice of it.
struct Notation {
  const char* protocol = "modbus-rtu";
  const char* area = "holding:";
  unsigned step = 1;
};

// Returns a configuration of the same line: 8E1, silences of 3.5 characters, one bus `line`.
[[nodiscard]] std::string configuration_of(const Map& map, double stretch = 1,
                                           std::uint32_t baud = 19200,
                                           const Notation& notation = {});

// Returns the least load that any master needs. Each group of adjacent registers of a unit (gaps
// cheaper than a request) is read once in its shortest refresh, each register once in its own.
[[nodiscard]] double least_load(const Map& map, std::uint32_t baud = 19200, Duration delay = {});

// A tighter bound that also counts the gaps between registers. Let f(S) be the least cost of
// reading the set S once: a request, its items, and for each gap the cheaper of bridging it and
// another request. f is submodular, so the reads of any master can be charged class by class. The
// registers of refresh up to R add f(R) - f(shorter) to those of shorter refresh. This is paid at
// least once in every window of R. Hence the load is at least the sum over the classes of (f(R) -
// f(shorter)) / R.
[[nodiscard]] double proven_load(const Map& map, std::uint32_t baud = 19200, Duration delay = {});

}  // namespace fieldcast::test
