#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {

inline constexpr std::uint32_t kMaxRawValues = 1000;
// Of a client of the gateway: the coils of one Modbus read.
inline constexpr std::uint32_t kMaxGatewayValues = 2000;

enum class Operation : std::uint8_t { kWrite, kAcquire };

struct DeviceSpec;

struct ChannelTarget {
  std::string name;  // empty with kAcquire: every channel of the device
};
// Only for devices with allow: raw-read or raw-write.
struct AddressTarget {
  std::string at;          // in the PLC's own notation
  Encoding encoding;       // big-endian orders mean the family's own
  std::uint32_t skip = 0;  // values from `at` to the first one
};
using Target = std::variant<ChannelTarget, AddressTarget>;

struct Command {
  std::string requester;  // key with request_id: one result for each pair
  std::uint64_t request_id = 0;
  std::string device;
  Target target;
  Operation operation = Operation::kWrite;
  std::vector<Value> values;  // kWrite: one, or for an address one for each of `count`
  // kAcquire of an address: number of consecutive values; for a bit, of consecutive bits.
  std::uint32_t count = 1;
  bool verify = false;  // read back after the write
  // kWrite of one value: only these bits change, in one request (Modbus function 22).
  std::optional<std::uint16_t> mask = std::nullopt;
  Instant expires = kNever;  // latest start
  std::string subject;       // requester by its certificate; empty without DDS Security
  bool gateway = false;      // of a Modbus TCP client, see GatewaySpec
  // A stored response of the device that is at most this old also completes a gateway's read.
  Duration max_age{};
  // kAcquire of one channel of a device that is not configured; `device` is not used. Null for a
  // configured device.
  std::shared_ptr<const DeviceSpec> ad_hoc = nullptr;

  // Needs no `allow: raw-read`.
  [[nodiscard]] bool is_gateway_read() const { return gateway && operation == Operation::kAcquire; }
  // Uses the wire only between the reads of the plan.
  [[nodiscard]] bool in_spare_time() const { return is_gateway_read() || ad_hoc != nullptr; }
};

enum class CommandState : std::uint8_t { kDone, kVerified, kRejected, kFailed, kExpired };
[[nodiscard]] std::string_view to_text(CommandState state);  // "done", "verified", ...

struct CommandResult {
  std::string requester;
  std::uint64_t request_id = 0;
  CommandState state = CommandState::kFailed;
  Cause cause = Cause::kNone;
  std::uint16_t device_code = 0;
  std::string reason;         // one human-readable line; empty on success
  std::vector<Value> values;  // acquired or read back
  // All equal if no request was sent.
  Instant received{}, started{}, completed{};
  bool gateway = false;       // of a command of the gateway
  bool gateway_read = false;  // of Command::is_gateway_read()
  bool ad_hoc = false;        // of a command with Command::ad_hoc
};

// `state`: kRejected, or kExpired for a late command. `reason`: one human-readable line.
[[nodiscard]] CommandResult refusal(const Command& command, CommandState state, Cause cause,
                                    std::string reason, Instant received, Instant now);

[[nodiscard]] CommandResult rejection(const Command& command, Cause cause, std::string reason,
                                      Instant now);

}  // namespace fieldcast
