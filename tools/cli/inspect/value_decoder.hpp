// Decodes frames of one bus with its configuration by replaying the exchange (core/protocol). Pure;
// owns the current exchange.
//
// The requested items are in the comment of a Fieldcast capture; otherwise the decoder compares
// requests that the bridge could have sent. Writes, and lists of ranges without a comment, are not
// decoded. Nothing can fail: an unknown frame has no values.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/capture/capture_record.hpp"
#include "core/model/bus_spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

struct DecodedValue {
  std::string device, channel;
  Value value;
  std::string type, unit;
};

class ValueDecoder {
 public:
  // Limit of generated requests for one unknown request.
  static constexpr std::size_t kMaxCandidates = 200'000;

  explicit ValueDecoder(const BusSpec& bus);

  [[nodiscard]] std::vector<DecodedValue> take(Direction direction, ByteView frame,
                                               std::string_view comment);
  // The device of the last request; before it, the first device.
  [[nodiscard]] const DeviceSpec& asked_device() const { return bus_.devices[asked_]; }

 private:
  struct Asked {
    std::size_t device = 0;
    std::vector<Range> ranges;
  };
  [[nodiscard]] std::optional<Asked> from_comment(std::string_view comment) const;
  [[nodiscard]] std::optional<Asked> by_trial(ByteView frame);
  [[nodiscard]] std::optional<Asked> by_trial(std::size_t device, ByteView frame,
                                              std::size_t& left);
  [[nodiscard]] bool begin(const Asked& asked, ByteView frame);
  [[nodiscard]] bool goes_on(ByteView frame);
  [[nodiscard]] std::vector<DecodedValue> values() const;

  const BusSpec bus_;
  std::vector<std::unique_ptr<Protocol>> protocols_;  // by device; null: cannot be created
  std::vector<std::uint16_t> sequences_;              // last sequence number of each device
  std::vector<Asked> known_;                          // requests found by comparison
  std::set<Bytes> unknown_;                           // requests not found
  std::size_t asked_ = 0;
  std::unique_ptr<Exchange> exchange_;  // the current exchange
  std::vector<Range> ranges_;           // of the exchange
  Bytes received_;                      // since its last request
  Bytes next_;                          // its next request, if any
};

}  // namespace fieldcast::cli
