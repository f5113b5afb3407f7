// Stores the DDS Security subject of each participant, and the subject that each requester name
// belongs to. Any thread.
//
// Fast DDS 2.9.1 does not expose the certificate that it has checked. It does check that the GUID
// of a participant begins with the hash of the certificate's subject (OMG formal/18-04-01, 9.3.3).
// So the subject is read from the participant's identity token, and ignored if its hash differs
// from the GUID. The GUID contains 47 bits of the hash: enough against chance and outsiders. A
// member that computes some 2^47 names could show a false name here, but gains no right by it: the
// library checks rights on the certificate itself.
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

  // Assigns the requester name to the subject that uses it first. Returns false if it belongs to
  // another subject.
  [[nodiscard]] bool bind(const std::string& requester, const std::string& subject);

 private:
  mutable std::mutex mutex_;
  std::map<Participant, std::string> subjects_;
  std::map<std::string, std::string> owners_;  // by requester
  std::deque<std::string> oldest_;             // requesters, oldest first
};

// The bus that senders are restricted to; `std::nullopt` for requests without a partition. Members
// restricted to a bus cannot write for other buses: Domain::reader_of_bus().
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

// Collects the lifespans of writers from discovery, because LIFESPAN is a QoS of the writer, but
// the library's reader applies its own. Also collects the DDS Security subjects of participants.
class RequestWriters : public DiscoveryListener {
 public:
  using Guid = rtps::GUID_t;
  // Also used for writers with an infinite lifespan: a late command never runs.
  static constexpr Duration kDefault = std::chrono::seconds{5};
  // Longer lifespans are reduced to this one: identities of commands are kept no longer.
  static constexpr Duration kLongest = std::chrono::hours{24};
  static constexpr std::size_t kMaxWriters = 4096;  // further writers get the default

  // Authenticates a request and determines its expiry. `std::nullopt`: the requester's name belongs
  // to another subject. Such a request gets no result, because the result would go to the owner of
  // the name.
  [[nodiscard]] std::optional<RequestTerms> terms_of(const Domain& domain,
                                                     const std::string& requester,
                                                     const RequestOrigin& origin,
                                                     const UtcMapping& now) const;
  // The subject of the writer's participant, for example "bridge line-7", or
  // RequesterRegistry::kUnknown. Empty without DDS Security.
  [[nodiscard]] std::string subject_of(const Domain& domain, const Guid& writer) const;

 private:
  void on_writer(const FoundWriter& writer) override;
  void on_participant(const FoundParticipant& participant) override;

  mutable std::mutex mutex_;
  std::map<Guid, Duration> lifespans_;
  mutable RequesterRegistry requesters_;
};

// Expiry of a request on the engine's clock. Its age is the difference of the wall clocks of both
// machines, never negative.
[[nodiscard]] Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now);

// Both clock readings, for the message about a late request: "written at .., received at .. by this
// bridge's clock: ..". Empty if the request has no source time.
[[nodiscard]] std::string clocks_text(UtcTime source, const UtcMapping& now);

// How long before `listening` the request was written; `std::nullopt` if it was written later. An
// older request was not for the bridge that listens now, although its writer may keep and repeat
// it. The source time is of the sender's clock. If that clock is behind by d, requests are refused
// for the first d of a bridge's life. If it is ahead by d, requests younger than d may be repeated.
[[nodiscard]] std::optional<Duration> written_before(Instant listening, UtcTime source,
                                                     const UtcMapping& now);

// Receives `Command` or `AlarmAction` and passes each message to `owner.receive(message, origin)`,
// on DDS threads.
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
