// What the frames of one bus mean by its configuration: which channels were asked for, and the
// values that came. Pure; owns the exchange under way.
//
// The exchange is played again by the protocol itself (core/protocol). Which items a request is
// about stands in the comment of a capture of Fieldcast; else it is found by making the requests
// that the bridge could have sent. Writes, and requests of several ranges without a comment, are
// not decoded. Nothing can fail: what is not understood has no values.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/capture/capture_record.hpp"
#include "core/model/spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

struct DecodedValue {
  std::string device, channel;
  Value value;
  std::string type, unit;
};

class ValueDecoder {
 public:
  // Requests that are made and compared for one that is not known yet.
  static constexpr std::size_t kMaxCandidates = 200'000;

  explicit ValueDecoder(const BusSpec& bus);

  // The frames of the bus in their order.
  [[nodiscard]] std::vector<DecodedValue> take(Direction direction, ByteView frame,
                                               std::string_view comment);
  // The protocol of the device that was asked last; of the first device before.
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
  std::vector<std::unique_ptr<Protocol>> protocols_;  // by device; null: none can be made
  std::vector<std::uint16_t> sequences_;              // the last one of each device
  std::vector<Asked> known_;                          // that were found by trial
  std::set<Bytes> unknown_;                           // requests that were not
  std::size_t asked_ = 0;
  std::unique_ptr<Exchange> exchange_;  // under way
  std::vector<Range> ranges_;           // of it
  Bytes received_;                      // since its last request
  Bytes next_;                          // its next request, when it wants to send one
};

}  // namespace fieldcast::cli
