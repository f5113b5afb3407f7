// Answers that come late: which requests may be sent meanwhile, which bytes are a late answer, and
// what it is worth. README.md has the rules.
//
// Owns the debts of the bus (OwedAnswers), the number of each device's last request, how its last
// answers began, and the bytes that came between exchanges. Owned by the bus engine, on the bus's
// thread. Nothing can fail; every table is bounded, and the oldest entry gives way.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <vector>

#include "core/bus/bus_setup.hpp"
#include "core/bus/exchange_driver.hpp"
#include "core/bus/owed_answers.hpp"

namespace fieldcast {

class LateAnswers {
 public:
  static constexpr std::size_t kMaxHeads = 1024;  // of a device
  // Pause between two answers of one device, at least; what begins sooner is the same one again.
  static constexpr double kBetweenAnswers = 2;  // characters

  // An answer that came after its exchange had been given up.
  struct Late {
    Asked asked;
    Block block;       // whose values it brings; no points: nobody waits for them
    Reply reply;       // when there is a block
    Duration taken{};  // by the device
  };
  // What a request is for. The same read may be asked again while its answer is owed; a command
  // must not take an answer from before it for its own.
  enum class Purpose : std::uint8_t { kRead, kCommand };

  explicit LateAnswers(const BusSetup& setup);  // setup outlives this

  // The context of the next request to a device.
  [[nodiscard]] ExchangeContext next_context(DeviceIndex device) {
    return {++devices_[device].sequence};
  }
  // From when on the request may be sent: no answer that is owed can then be taken for its own.
  // kLongAgo: at once.
  [[nodiscard]] Instant sendable_from(DeviceIndex device, const Request& request,
                                      Purpose purpose) const;
  // The same for reads, as a function to pass on.
  using Gate = std::function<Instant(DeviceIndex, const Request&)>;
  [[nodiscard]] Gate read_gate() const {
    return [this](DeviceIndex device, const Request& request) {
      return sendable_from(device, request, Purpose::kRead);
    };
  }
  [[nodiscard]] bool none_owed() const { return owed_.empty(); }
  // The last answer that is owed can come until then; kLongAgo: none is.
  [[nodiscard]] Instant owed_until() const { return owed_.until(); }
  [[nodiscard]] bool owes_same(const Asked& asked) const { return owed_.owes_same(asked); }

  // The exchange in `driver` was answered, `refused` by a refusal. `longest`: the longest time that
  // the device was lately seen to take.
  void answered(const Asked& asked, bool refused, Duration longest, const ExchangeDriver& driver,
                Instant now);
  // It was given up. `block`: what it would have brought.
  void unanswered(Asked asked, Block block, Duration longest, const ExchangeDriver& driver,
                  Instant now);
  // It was broken off from outside.
  void broken_off(Asked asked, Duration longest);

  // The late answers among the bytes of the exchange under way.
  [[nodiscard]] std::vector<Late> in_exchange(const Asked& under_way, const ExchangeDriver& driver,
                                              Instant now);
  // Those among bytes that came while nobody was asked.
  [[nodiscard]] std::vector<Late> in_strays(ByteView bytes, Instant now);

  // A request goes out: what comes from now on has nothing to do with what came before.
  void start_anew();
  // Forgets what can no longer come.
  void expire(Instant now) { (void)owed_.expire(now); }
  void forget_all() { owed_.forget_all(); }

 private:
  // How the last answer to each read began: marks and address.
  using Head = std::array<std::uint8_t, 4>;
  using Shape = std::array<std::uint32_t, 4>;
  struct Device {
    std::uint16_t sequence = 0;
    std::map<Shape, Head> heads;
  };
  [[nodiscard]] static Head head_of(ByteView answer);
  [[nodiscard]] static Shape shape_of(const ReadRequest& read);
  void learn_head(const Asked& read, ByteView answer);
  [[nodiscard]] bool broken_answer_came(const Asked& asked, const ExchangeDriver& driver) const;
  [[nodiscard]] Duration bound(const Asked& asked, Duration longest) const;
  [[nodiscard]] std::size_t end_of_answer(const Asked& asked, ByteView bytes) const;
  [[nodiscard]] std::size_t find(ByteView bytes, const Asked* under_way, Instant now,
                                 std::vector<Late>& found);
  [[nodiscard]] Late late_answer(OwedAnswers::Debt paid, bool refused, Instant now) const;

  const BusSetup& setup_;
  OwedAnswers owed_;
  std::vector<Device> devices_;
  Instant last_answer_{};    // the end of it
  std::size_t claimed_ = 0;  // bytes of the exchange under way that were late answers
  Bytes strays_;             // bytes since the last exchange ended that were no late answer
};

}  // namespace fieldcast
