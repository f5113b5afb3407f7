// Loopback sockets, a bridge in its own process and length-prefixed frames for program_bench.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {

// Throws std::runtime_error. Within the patience, retries until a server listens.
[[nodiscard]] FileDescriptor connect_to(std::uint16_t port, double patience = 0);

void send_all(int fd, ByteView bytes);  // throws std::runtime_error if the peer has closed
[[nodiscard]] Bytes receive_some(int fd,
                                 std::size_t most);  // blocks; empty at the end of the stream
// Includes the end; reads byte by byte.
[[nodiscard]] std::string receive_until(int fd, std::string_view end);

// Requests a device with length-prefixed framing until it is available; throws for other refusals.
[[nodiscard]] FileDescriptor paired_client(std::uint16_t port, const std::string& number);

// fieldcast-bridge with `program` on two free ports and the given buses (YAML, indented by two).
class ProgramBridge {
 public:
  explicit ProgramBridge(const std::string& buses);
  [[nodiscard]] std::uint16_t engineers() const { return engineers_; }
  [[nodiscard]] std::uint16_t modules() const { return modules_; }
  [[nodiscard]] unsigned domain() const { return own_domain(); }
  [[nodiscard]] Process& process() { return *process_; }
  [[nodiscard]] const ScratchFolder& folder() const { return folder_; }

 private:
  ScratchFolder folder_;
  std::uint16_t engineers_ = free_port(), modules_ = free_port();
  std::unique_ptr<Process> process_;
};

struct ExchangeOptions {
  double bytes = 1e6;   // requests and responses together
  double delay_ms = 0;  // added to each round trip
  bool markers = false;
};
void exchange_bench(const ExchangeOptions& options);
struct RelayOptions {
  double gigabytes = 1;   // in each direction
  bool terminal = false;  // also through fieldcast-port
};
void relay_bench(const RelayOptions& options);
struct ManyOptions {
  int devices = 100, pairings = 50;
  double seconds = 20;
};
void many_bench(const ManyOptions& options);

}  // namespace fieldcast::bench
