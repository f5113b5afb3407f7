// Recorded datagrams of Cyclone DDS (cyclone_datagrams.txt), each in the order of the file.
#pragma once

#include <fstream>

#include "tests/bridge/dds/transport/rtps_datagrams.hpp"

namespace fieldcast::testing {

// Returns no datagram if the file of the source tree is missing.
inline std::vector<Datagram> recorded_datagrams() {
  std::vector<Datagram> all;
  std::ifstream file(FIELDCAST_RECORDED_DATAGRAMS);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    Datagram& one = all.emplace_back();
    for (std::size_t at = 0; at + 1 < line.size(); at += 2)
      one.push_back(static_cast<std::uint8_t>(std::stoi(line.substr(at, 2), nullptr, 16)));
  }
  return all;
}

}  // namespace fieldcast::testing
