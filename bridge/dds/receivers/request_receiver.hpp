// Stores the DDS Security subject of each participant, and the subject that each requester name
// belongs to. Any thread. Fast DDS 2.9.1 does not expose the checked certificate, but checks that
// the GUID of a participant begins with the hash of its subject (OMG formal/18-04-01, 9.3.3). So
// the subject is read from the identity token, and ignored if its hash differs. The GUID contains
// 47 bits of the hash: enough against chance and outsiders. A member that computes 2^47 names gains
// no right: the library checks rights on the certificate itself.
#pragma once

#include <cstdint>
#include <deque>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class RequesterRegistry {
 public:
  using Participant = rtps::GuidPrefix_t;
  static constexpr std::size_t kMaxParticipants = 4096;  // further ones are unknown
  static constexpr std::size_t kMaxRequesters = 4096;    // at the limit the oldest is removed
  static constexpr std::string_view kUnknown = "unknown subject";

  // `slashed` is for example "/O=Fieldcast/OU=plant/CN=mes-1.2".
  void found(const Participant& participant, std::string_view slashed);
  void lost(const Participant& participant);

  // For example "plant mes-1", or kUnknown.
  [[nodiscard]] std::string subject_of(const Participant& participant) const;

  // Assigns the name to the subject that uses it first; false if it belongs to another subject.
  [[nodiscard]] bool bind(const std::string& requester, const std::string& subject);

 private:
  mutable std::mutex mutex_;
  std::map<Participant, std::string> subjects_;
  std::map<std::string, std::string> owners_;  // by requester
  std::deque<std::string> oldest_;             // requesters, oldest first
};

// The bus that senders are restricted to, see Domain::reader_of_bus(); empty without a partition.
using HeldTo = std::optional<std::string>;

// How a request arrived.
struct RequestOrigin {
  rtps::GUID_t writer;
  UtcTime source;     // by the sender's clock
  HeldTo bus;         // of the receiver
  Instant listening;  // when the receiver began to listen
};

// Conditions under which a bridge accepts `Command` and `AlarmAction`.
struct RequestTerms {
  std::string subject;    // of the requester, by DDS Security; "" without it
  Instant expires;        // may have passed already
  std::string late;       // reason why it has expired; empty if it has not
  std::string too_early;  // why it must be refused: it was written before the bridge listened
};

// Collects LIFESPAN of writers and subjects of participants; the reader applies its own LIFESPAN.
class RequestWriters : public DiscoveryListener {
 public:
  using Guid = rtps::GUID_t;
  // Also used for writers with an infinite lifespan: a late command never runs.
  static constexpr Duration kDefault = std::chrono::seconds{5};
  // Longer lifespans are reduced to this one: identities of commands are kept no longer.
  static constexpr Duration kLongest = std::chrono::hours{24};
  static constexpr std::size_t kMaxWriters = 4096;  // further writers get the default

  // Authenticates a request and determines its expiry. Empty if the requester's name belongs to
  // another subject; a result would go to the owner of the name.
  [[nodiscard]] std::optional<RequestTerms> terms_of(const Domain& domain,
                                                     const std::string& requester,
                                                     const RequestOrigin& origin,
                                                     const UtcMapping& now) const;
  // Subject of the writer's participant: "bridge line-7", kUnknown, or "" without DDS Security.
  [[nodiscard]] std::string subject_of(const Domain& domain, const Guid& writer) const;

 private:
  void on_writer(const FoundWriter& writer) override;
  void on_participant(const FoundParticipant& participant) override;

  mutable std::mutex mutex_;
  std::map<Guid, Duration> lifespans_;
  mutable RequesterRegistry requesters_;
};

// Expiry on the engine's clock; the age is the difference of both wall clocks, never negative.
[[nodiscard]] Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now);

// Both clock readings, for the message about a late request. Empty without a source time.
[[nodiscard]] std::string clocks_text(UtcTime source, const UtcMapping& now);

// How long before `listening` the request was written; empty if later. An older request was not for
// this bridge, although its writer may repeat it. The source time is of the sender's clock: if it
// is behind by d, requests of the first d of a bridge's life are refused; if ahead by d, requests
// younger than d may be repeated.
[[nodiscard]] std::optional<Duration> written_before(Instant listening, UtcTime source,
                                                     const UtcMapping& now);

// Passes each `Command` or `AlarmAction` to `owner.receive(message, origin)`, on DDS threads.
template <class Message, class Owner>
class RequestReceiver : private dds::DataReaderListener {
 public:
  template <class Generated>
  RequestReceiver(Owner& owner, Domain& domain, const Topic<Generated>& topic, HeldTo bus,
                  Instant now)
      : owner_(owner), domain_(domain), bus_(std::move(bus)), listening_(now) {
    const auto mask = dds::StatusMask::data_available();
    reader_ =
        bus_ ? domain.reader_of_bus(*bus_, topic, this, mask) : domain.reader(topic, this, mask);
  }
  void close() { domain_.remove(reader_); }  // nothing is received after it returns

 private:
  void on_data_available(dds::DataReader* reader) override {
    Message message;
    dds::SampleInfo info;
    // Also takes unregister messages, which frees their instances in the reader.
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data)
        owner_.receive(message, RequestOrigin{info.sample_identity.writer_guid(),
                                              {info.source_timestamp.to_ns()},
                                              bus_,
                                              listening_});
    }
  }

  Owner& owner_;
  Domain& domain_;
  const HeldTo bus_;
  const Instant listening_;
  dds::DataReader* reader_ = nullptr;
};

}  // namespace fieldcast
