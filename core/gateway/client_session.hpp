// One client of a gateway: its received bytes, its requests in flight and their responses. Pure;
// owned by the gateway, on its thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/gateway/server_codec.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::gateway {

// Device by unit of a request.
using Units = std::map<std::uint8_t, std::string>;

// As configured, or each device of the bus at its address. REQUIRES: the bus has a gateway.
[[nodiscard]] Units units_of(const BusSpec& bus);

struct Counters {
  std::uint64_t clients = 0;           // connected now
  std::uint64_t refused_clients = 0;   // not permitted, too many, or not Modbus TCP
  std::uint64_t requests = 0;          // complete frames
  std::uint64_t refused_requests = 0;  // responses that are exceptions
};

class ClientSession {
 public:
  // Requests of one client in flight; a further one is refused as busy.
  static constexpr std::size_t kMaxPending = 16;

  // `requester` and ids from `first_id` on identify the commands. `spec`, `units` and `counters`
  // must outlive the session.
  ClientSession(const GatewaySpec& spec, const Units& units, std::string requester,
                std::uint64_t first_id, Counters& counters)
      : spec_(spec),
        units_(units),
        requester_(std::move(requester)),
        next_id_(first_id),
        counters_(counters) {}

  // Appends responses to `out` and commands to `commands`. Fails if the bytes are not Modbus TCP:
  // the connection must be closed.
  [[nodiscard]] tl::expected<void, FrameFault> on_bytes(ByteView bytes, Instant now, Bytes& out,
                                                        std::vector<Command>& commands);
  // Appends the response, or the second command of function 23. Ignores a result that is not of a
  // pending request.
  void on_result(const CommandResult& result, Bytes& out, std::vector<Command>& commands);

  [[nodiscard]] const std::string& requester() const { return requester_; }
  [[nodiscard]] std::size_t pending() const { return pending_.size(); }

 private:
  struct Pending {
    std::uint16_t transaction = 0;
    std::uint8_t unit = 0;
    ClientRequest request;
    bool written = false;  // the read of function 23, after its write
  };
  // The exception that refuses the request, if its unit does not permit it. Sets its row.
  [[nodiscard]] tl::expected<void, Exception> find_row(ClientRequest& request,
                                                       const std::string& device) const;
  // Fails if the written registers are no value of the row.
  [[nodiscard]] tl::expected<void, Exception> start(Pending pending, const std::string& device,
                                                    Instant now, std::vector<Command>& commands);
  // The exception that refuses the request, or the command is appended.
  [[nodiscard]] tl::expected<void, Exception> accept(const RequestFrame& frame, Instant now,
                                                     std::vector<Command>& commands);

  const GatewaySpec& spec_;
  const Units& units_;
  const std::string requester_;
  std::uint64_t next_id_;
  Counters& counters_;
  Bytes received_;  // less than a frame
  std::map<std::uint64_t, Pending> pending_;
};

}  // namespace fieldcast::gateway
