// One FINS command and its response, without the frame of a carrier (fins.hpp: Host Link,
// fins_tcp.hpp: TCP): reads of ranges and of scattered words, writes of words and single bits.
//
//     0101  area address(2) bit count(2)               ->  data
//     0102  area address(2) bit count(2) data
//     0104  (area address(2) bit) for each item        ->  (area data) for each item
//
// A message is a header, which ends with the SID, a command(2) and parameters; a response also has
// an end code(2) before its data (Omron W227 and W342).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/protocol/omron_hostlink/areas.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::omron {

// Bits of ICF, the first byte of a header.
inline constexpr std::uint8_t kResponseFlag = 0x40, kRelayedFlag = 0x80;
inline constexpr std::uint8_t kGatewayCount = 0x02;

struct FinsLimits {
  Mode mode = Mode::kFins;
  std::size_t request_bytes = 0;  // of a message with its header
  std::size_t response_bytes = 0;
  std::uint16_t items = 0;  // of command 0104
};
inline constexpr FinsLimits kHostLinkLimits{Mode::kFins, kFinsRequestBytes, kFinsResponseBytes,
                                            kFinsItems};
inline constexpr FinsLimits kEthernetLimits{Mode::kFinsEthernet, kEthernetBytes, kEthernetBytes,
                                            kEthernetItems};

struct FinsSizes {
  std::size_t request = 0;  // bytes of the messages with their headers
  std::size_t response = 0;
};
// Empty if the request exceeds a limit. `header`: bytes up to the SID, inclusive.
[[nodiscard]] std::optional<FinsSizes> fins_sizes(const FinsLimits& limits, std::size_t header,
                                                  const Request& request);

class FinsCommand {
 public:
  // REQUIRES: fins_sizes(limits, header.size(), request) holds a value.
  FinsCommand(const FinsLimits& limits, Bytes header, const Request& request);

  [[nodiscard]] const Bytes& message() const { return message_; }
  [[nodiscard]] std::size_t header_size() const { return header_size_; }
  [[nodiscard]] std::size_t response_size() const { return response_size_; }

  // Returns true if the message is the response to another command, by its SID.
  [[nodiscard]] bool is_foreign(ByteView message) const;
  // Returns need_response() for a message that is not the response; `silence` is then its cause.
  [[nodiscard]] Step judge(ByteView message, Cause& silence);
  // Only valid after done().
  [[nodiscard]] const Reply& reply() const { return reply_; }

 private:
  void append_read();
  void append_write(const WriteRequest& write);
  [[nodiscard]] Step unpack(ByteView data);
  [[nodiscard]] Step unpack_many(ByteView data);

  const Mode mode_;
  const std::size_t header_size_;
  std::size_t response_size_ = 0;
  Bytes message_;
  std::vector<Range> ranges_;  // of a read
  Reply reply_;
};

}  // namespace fieldcast::omron
