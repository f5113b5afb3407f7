// Stations in processes of their own, and what they received: for benches. Main thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/bench/process.hpp"

namespace fieldcast::bench {

// What a station has received since it began.
struct Received {
  std::uint64_t samples = 0, missing = 0;  // by their sequence
  std::uint64_t channels = 0;              // with a value
  std::uint64_t listed = 0;                // of the catalogue
  std::uint64_t missing_blocks = 0;
};

class StationProcess {
 public:
  // `one_by_one`: by fieldcast/Sample instead of by blocks. `loss`: the share of datagrams that do
  // not reach it. `program`: another one that prints what bench_station does.
  StationProcess(const ScratchFolder& folder, unsigned domain, const std::string& name,
                 bool one_by_one, double loss = 0, const std::string& program = "bench_station");
  [[nodiscard]] Received received() const;  // not older than 20 ms, if it runs
  [[nodiscard]] double cpu_seconds() const { return process_.cpu_seconds(); }
  [[nodiscard]] pid_t id() const { return process_.id(); }

 private:
  std::string log_;
  Process process_;
};

// Datagrams that the kernel dropped since the machine started, since a socket's buffer was full.
[[nodiscard]] std::uint64_t dropped_datagrams();
// The same, of the sockets that a process has open now (/proc/net/udp).
[[nodiscard]] std::uint64_t dropped_datagrams(pid_t process);

}  // namespace fieldcast::bench
