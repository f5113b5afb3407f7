// Tracks late responses: which requests may be sent meanwhile, which bytes are a late response, and
// what it is used for. README.md has the rules. Owns the debts of the bus (PendingResponses). Owned
// by the bus engine, on the bus's thread. Every table is bounded and drops its oldest entry.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <vector>

#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/wire/exchange_driver.hpp"
#include "core/bus/wire/pending_responses.hpp"
#include "core/bus/wire/repetition_filter.hpp"
#include "core/bus/wire/wire.hpp"

namespace fieldcast {

class LateResponseFilter {
 public:
  static constexpr std::size_t kMaxHeads = 1024;  // of a device
  // Minimum pause between responses of a device, in characters; earlier bytes repeat the last one.
  static constexpr double kBetweenResponses = 2;

  struct Late {
    Asked asked;
    Block block;  // the values it contains; no points if they are not needed
    Reply reply;  // if there is a block
    bool refused = false;
    Duration taken{};  // response time of the device
  };
  // A command must not use a response that is older than itself.
  enum class Purpose : std::uint8_t { kRead, kCommand };

  explicit LateResponseFilter(const BusSetup& setup);  // `setup` must outlive this object

  // The numbers of requests begin above this one; by default, with 1.
  void number_from(std::uint16_t sequence) {
    for (Device& device : devices_) device.sequence = sequence;
  }
  [[nodiscard]] ExchangeContext next_context(DeviceIndex device) {
    return {++devices_[device].sequence};
  }
  // Earliest time at which no pending response can be matched to it; kLongAgo: immediately.
  [[nodiscard]] Instant sendable_from(DeviceIndex device, const Request& request,
                                      Purpose purpose) const;
  using Gate = std::function<Instant(DeviceIndex, const Request&)>;
  [[nodiscard]] Gate read_gate() const {
    return [this](DeviceIndex device, const Request& request) {
      return sendable_from(device, request, Purpose::kRead);
    };
  }
  [[nodiscard]] bool none_owed() const { return owed_.empty(); }
  [[nodiscard]] bool owes(DeviceIndex device) const { return owed_.owes(device); }
  // Another device has the index now. REQUIRES: !owes(device).
  void replaced(DeviceIndex device) {
    devices_[device].heads.clear();
    repetitions_.replaced(device);
  }
  // kLongAgo if no responses are pending.
  [[nodiscard]] Instant owed_until() const { return owed_.until(); }
  [[nodiscard]] bool owes_same(const Asked& asked) const { return owed_.owes_same(asked); }

  // `refused`: by a refusal. `longest`: longest recent response time.
  void responded(const Asked& asked, bool refused, Duration longest, const ExchangeDriver& driver,
                 Instant now);
  // The exchange timed out. `block`: the values of its response.
  void timed_out(Asked asked, Block block, Duration longest, const ExchangeDriver& driver,
                 Instant now);
  void broken_off(Asked asked, Duration longest);

  // Bytes for the exchange of the wire, which skips a repetition of the last response. REQUIRES:
  // wire.exchanging().
  ExchangeDriver::Outcome skip_repetition(Wire& wire, ByteView bytes, Instant now, Bytes& out);
  // Whether the received response equals the last one and began within `early`, so that it may be
  // its repetition.
  [[nodiscard]] bool may_repeat(const ExchangeDriver& driver, Duration early) const {
    return !setup_.timeless() && driver.response_began() <= early &&
           repetitions_.find(driver.received(), driver.sent_from()) > 0;
  }

  [[nodiscard]] std::vector<Late> in_exchange(const Asked& under_way, const ExchangeDriver& driver,
                                              Instant now);
  // Number of bytes up to the end of the first response in them; all of them if there is none.
  [[nodiscard]] std::size_t end_of_response(const Asked& asked, ByteView bytes) const;
  // The exchange waits on without the late responses. REQUIRES: in_exchange() has found some.
  ExchangeDriver::Outcome skip_late(Wire& wire, Instant now, Bytes& out);
  [[nodiscard]] std::vector<Late> in_strays(ByteView bytes, Instant now);

  [[nodiscard]] RepetitionFilter& repetitions() { return repetitions_; }
  [[nodiscard]] const RepetitionFilter& repetitions() const { return repetitions_; }

  // Received bytes are not continued by later ones.
  void start_anew();
  void expire(Instant now) { (void)owed_.expire(now); }
  void forget_all() { owed_.forget_all(); }

 private:
  // Beginning of the last response to each read: marks and address.
  using Head = std::array<std::uint8_t, 4>;
  using Shape = std::array<std::uint32_t, 4>;
  struct Device {
    std::uint16_t sequence = 0;
    std::map<Shape, Head> heads;
  };
  [[nodiscard]] static Head head_of(ByteView response);
  [[nodiscard]] static Shape shape_of(const ReadRequest& read);
  void learn_head(const Asked& read, ByteView response);
  [[nodiscard]] bool broken_response_came(const Asked& asked, const ExchangeDriver& driver) const;
  [[nodiscard]] Duration bound(const Asked& asked, Duration longest) const;
  [[nodiscard]] std::size_t find(ByteView bytes, const Asked* under_way, Instant now,
                                 std::vector<Late>& found);
  [[nodiscard]] Late late_response(PendingResponses::Debt paid, bool refused, Instant now) const;

  const BusSetup& setup_;
  PendingResponses owed_;
  std::vector<Device> devices_;
  RepetitionFilter repetitions_;
  Instant last_response_{};  // end of the last response
  std::size_t claimed_ = 0;  // bytes of the exchange in flight that were late responses
  Bytes strays_;             // bytes since the last exchange that were not late responses
};

}  // namespace fieldcast
