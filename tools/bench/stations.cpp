#include "tools/bench/stations.hpp"

#include <fstream>
#include <sstream>

namespace fieldcast::bench {

StationProcess::StationProcess(const ScratchFolder& folder, unsigned domain,
                               const std::string& name, bool one_by_one, double loss)
    : log_(folder.path() + '/' + name + ".log"),
      process_(
          "bench_station",
          {std::to_string(domain), one_by_one ? "one-by-one" : "by-blocks", std::to_string(loss)},
          log_) {}

Received StationProcess::received() const {
  std::ifstream file(log_);
  Received received, line;
  std::string text;
  while (std::getline(file, text)) {
    std::istringstream numbers(text);
    if (numbers >> line.samples >> line.missing >> line.channels >> line.listed >>
        line.missing_blocks)
      received = line;
  }
  return received;
}

std::uint64_t dropped_datagrams() {
  std::ifstream file("/proc/net/snmp");
  std::string names, values;
  while (std::getline(file, names) && std::getline(file, values)) {
    if (!names.starts_with("Udp:")) continue;
    std::istringstream name(names), value(values);
    std::string one;
    std::string number;
    while (name >> one && value >> number) {
      if (one == "RcvbufErrors") return std::stoull(number);
    }
  }
  return 0;
}

}  // namespace fieldcast::bench
