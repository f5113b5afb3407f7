// Decides for each datagram from the network whether the DDS library may read it.
// rtps_validator.hpp has the rules for a single datagram; the guard adds rules that need memory:
// - Number of participants and endpoints, rate of new participants. At a limit, the guard removes a
//   participant silent for longer than its lease, or the oldest that has announced no endpoint.
// - Bytes of unfinished fragmented samples.
// - Sequence numbers in GAPs: the library inserts each number of a range into a set. The guard
//   replaces a long GAP by a HEARTBEAT whose first number is the end of the range: same effect.
// - First numbers of HEARTBEATs: the library counts up to them one by one (StatefulReader.cpp). The
//   guard replaces a far one by a nearer one; the following HEARTBEATs continue from there.
// - Numbers in ACKNACKs: the library sends nothing again that a reader has acknowledged, unless the
//   reader begins with an empty ACKNACK (ReaderProxy.cpp). A peer that has lost this participant
//   for a while, but was not lost here, may leave that out (WriterProxy.cpp) and would receive
//   nothing any more. An ACKNACK below an earlier one becomes an empty one.
// - Addresses of a participant: the source of its first announcement, and the addresses in it.
//   Discovery in its name from another address is refused, except from loopback addresses and with
//   relayed discovery.
// Pure: `now` is an argument. One owner; not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "bridge/dds/guard/rtps_validator.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class DatagramGuard final : private RtpsEvents {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Address = std::array<std::uint8_t, 16>;  // of the sender, as in a locator

  struct Verdict {
    std::optional<RtpsFault> fault;       // none: the library may read `bytes`
    std::span<const std::uint8_t> bytes;  // the datagram, or `scratch`
    Bytes before;                         // not empty: a message that the library reads first
  };

  explicit DatagramGuard(const RtpsLimits& limits);

  // `scratch` receives the datagram if a part of it must be changed, or memory must follow it.
  [[nodiscard]] Verdict check(std::span<const std::uint8_t> datagram, const Address& from,
                              Instant now, Bytes& scratch);

  // The name of the participant that the guard serves. Until then, all datagrams count as for it.
  void serve(const ParticipantPrefix& own) { own_ = own; }

  [[nodiscard]] std::size_t participants() const { return participants_.size(); }
  [[nodiscard]] std::size_t endpoints() const { return endpoints_; }
  // Pairs of a reader and a writer whose acknowledgements are stored.
  [[nodiscard]] std::size_t acknowledged() const { return acknowledged_; }

  // Numbers of one writer in GAPs that the library may hold at a time.
  static constexpr std::int64_t kMostGapped = 65'536;
  // Limit for the advance of a writer's HEARTBEATs, restored at 100 000 numbers a second.
  static constexpr std::int64_t kJump = 1 << 20;
  // Numbers that the library may count at a time, and per second: 0.2 to 0.5 us each (Debian 12).
  static constexpr std::int64_t kStep = 1 << 21, kCountsPerSecond = 1 << 20;
  // Highest first number of a writer's HEARTBEAT.
  static constexpr std::int64_t kFarthest = std::int64_t{1} << 36;

 private:
  using Guid = std::array<std::uint8_t, 16>;
  // A writer as one of our readers sees it, or as all do (kEveryReader): the library counts the
  // numbers of a writer for each reader, and a message can name one that does not exist.
  struct Seen {
    Guid writer{};
    EntityBytes reader{};
    friend bool operator==(const Seen&, const Seen&) = default;
  };
  struct Hash {
    std::size_t operator()(const Seen& seen) const;
  };
  struct Acknowledged {
    std::int64_t base = 0;
    std::uint32_t count = 0;
  };
  struct Participant {
    Instant seen{};
    Duration lease{};
    std::uint64_t order = 0;                  // in which it joined
    std::map<Guid, std::uint64_t> endpoints;  // with the order of their announcements
    std::vector<Address> addresses;           // source addresses
    // By its reader and our writer.
    std::map<std::pair<EntityBytes, EntityBytes>, Acknowledged> acknowledged;
  };
  struct Writer {
    std::uint64_t announced = 0;  // the order of its announcement; 0: the library does not know it
    Instant seen{};
    std::int64_t last = -1;    // highest announced number; -1: none yet
    std::int64_t counted = 0;  // number up to which the library has counted
    std::uint32_t count = 0;   // of its newest HEARTBEAT
    std::int64_t gapped = 0;   // numbers in GAPs since the library last discarded them
    std::int64_t gap_end = 0;
    double credit = kJump;  // numbers that it may still advance
  };
  struct Bucket {
    double tokens = 0;
    Instant filled{};
  };

  std::optional<RtpsFault> on_event(const RtpsEvent& event) override;
  [[nodiscard]] bool is_of_sender(const RtpsEvent& event);
  std::optional<RtpsFault> on_participant(const RtpsEvent& event);
  std::optional<RtpsFault> on_endpoint(const RtpsEvent& event);
  std::optional<RtpsFault> on_heartbeat(const RtpsEvent& event);
  std::optional<RtpsFault> on_gap(const RtpsEvent& event);
  void on_acknowledgement(const RtpsEvent& event);
  std::optional<RtpsFault> on_fragment(const RtpsEvent& event);
  static void add_addresses(Participant& of, const ParameterFacts& facts);
  [[nodiscard]] bool make_room(bool for_endpoints);
  [[nodiscard]] bool may_join();
  void forget(const ParticipantPrefix& prefix);
  [[nodiscard]] ParticipantPrefix sender() const;
  // GUID of a writer of the datagram's sender.
  [[nodiscard]] Guid guid_of(const EntityBytes& writer) const;
  [[nodiscard]] std::uint64_t announced(const Guid& writer) const;
  Writer& writer_of(const RtpsEvent& event);
  Writer& state_of(const Guid& writer, const EntityBytes& reader);
  bool may_reach(Writer& writer, std::int64_t number) const;
  void limit_count(const RtpsEvent& event, Writer& writer, std::int64_t first);
  std::span<std::uint8_t> copy();  // a copy of the datagram for changes

  const RtpsLimits limits_;
  ParticipantPrefix own_{};
  std::map<ParticipantPrefix, Participant> participants_;
  std::size_t endpoints_ = 0, acknowledged_ = 0;
  std::uint64_t joined_ = 0;
  std::map<Address, Bucket> joins_;
  std::unordered_map<Seen, Writer, Hash> writers_;
  std::deque<std::pair<Guid, std::int64_t>> fragmented_;  // writer and number, newest last
  Bucket fragment_bytes_, counts_;

  // State of the datagram that is being checked.
  std::span<const std::uint8_t> datagram_;
  Address from_{};
  Instant now_{};
  bool has_fragments_ = false;
  Bytes* scratch_ = nullptr;
  Bytes before_;
  bool is_changed_ = false;
};

// The guard of one participant, shared by the threads of its transports, and the counters of all.

// How many datagrams all guards of this process refused since its start, by cause. Any thread.
[[nodiscard]] RtpsFaultCounts refused_datagrams();

class SharedGuard {
 public:
  explicit SharedGuard(const RtpsLimits& limits) : guard_(limits) {}

  void serve(const ParticipantPrefix& own) {
    const std::lock_guard lock(mutex_);
    guard_.serve(own);
  }

  // As DatagramGuard::check(), now; `scratch` belongs to the caller's thread. Counts refused
  // datagrams, and logs the first of a cause, the tenth, the hundredth and so on.
  [[nodiscard]] DatagramGuard::Verdict check(std::span<const std::uint8_t> datagram,
                                             const DatagramGuard::Address& from,
                                             DatagramGuard::Bytes& scratch);

 private:
  std::mutex mutex_;
  DatagramGuard guard_;
};

}  // namespace fieldcast
