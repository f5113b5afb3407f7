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

// Conditions under which a bridge accepts `Command` and `AlarmAction`: the expiry, the target
// bridge, and the requester's identity.

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

  [[nodiscard]] Duration lifespan_of(const Guid& writer) const;
  // The subject of the writer's participant, for example "bridge line-7", or
  // RequesterRegistry::kUnknown. Empty without DDS Security.
  [[nodiscard]] std::string subject_of(const Domain& domain, const Guid& writer) const;
  // The subject of a requester: "" without DDS Security, `std::nullopt` if the requester's name
  // belongs to another subject. Such a request gets no result, because the result would go to the
  // owner of the name.
  [[nodiscard]] std::optional<std::string> subject_of(const Domain& domain,
                                                      const std::string& requester,
                                                      const Guid& writer) const;

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

// Receives `Command` and `AlarmAction`: authenticates the requester, checks the target bridge and
// the expiry, and forwards the request unchanged. Handlers are called on DDS threads.

// The bus that senders are restricted to; `std::nullopt` for requests without a partition. Members
// restricted to a bus cannot write for other buses: Domain::reader_of_bus().
using HeldTo = std::optional<std::string>;

struct RequestTerms {
  std::string subject;  // of the requester, by DDS Security; "" without it
  Instant expires;      // may have passed already
  UtcMapping now;
  std::string late;  // reason why it has expired; empty if it has not
};

template <class Message>
struct RequestHandlers {
  std::function<UtcMapping()> clock;
  // Requests for other buses belong to other bridges.
  std::function<bool(const std::string& bus)> is_ours;
  std::function<void(const Message& message, RequestTerms terms)> accepted;
  // Called for a request that was written before this receiver began to listen.
  std::function<void(const Message& message, const MalformedCommand& why)> refused;
  // Called before accepted() or refused().
  std::function<void(const std::string& requester, const RequestWriters::Guid& writer)> received;
  std::function<void(std::string text)> on_problem;
};

template <class Message>
class RequestReceiver : private dds::DataReaderListener {
 public:
  template <class Generated>
  RequestReceiver(Domain& domain, const Topic<Generated>& topic, const RequestWriters& writers,
                  RequestHandlers<Message> handlers, HeldTo bus = {})
      : domain_(domain),
        writers_(writers),
        handlers_(std::move(handlers)),
        bus_(std::move(bus)),
        listening_(handlers_.clock().instant) {
    const auto mask = dds::StatusMask::data_available();
    reader_ =
        bus_ ? domain.reader_of_bus(*bus_, topic, this, mask) : domain.reader(topic, this, mask);
  }
  void close() { domain_.remove(reader_); }  // no handler is called after it returns

 private:
  void on_data_available(dds::DataReader* reader) override {
    Message message;
    dds::SampleInfo info;
    // Also takes unregister messages, which frees their instances in the reader.
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) take(message, info);
    }
  }

  void take(const Message& message, const dds::SampleInfo& info) {
    const std::string bus = message.bus().c_str(), requester = message.requester().c_str();
    if (!handlers_.is_ours(bus) || (bus_ && bus != *bus_)) return;
    const RequestWriters::Guid writer = info.sample_identity.writer_guid();
    auto subject = writers_.subject_of(domain_, requester, writer);
    if (!subject)
      return handlers_.on_problem("a request under the name of another's requester was dropped");
    handlers_.received(requester, writer);
    const UtcTime source{info.source_timestamp.to_ns()};
    const UtcMapping now = handlers_.clock();
    if (const auto before = written_before(listening_, source, now))
      return handlers_.refused(message, {Cause::kExpired, too_early(*before, source, now)});
    RequestTerms terms{
        *std::move(subject), expiry_of(source, writers_.lifespan_of(writer), now), now, {}};
    if (terms.expires <= now.instant)
      terms.late = std::string(to_text(Cause::kExpired)) + ": " + clocks_text(source, now);
    handlers_.accepted(message, std::move(terms));
  }

  static std::string too_early(Duration before, UtcTime source, const UtcMapping& now) {
    return "written " + to_text(std::chrono::ceil<std::chrono::milliseconds>(before)) +
           " before this bridge began to listen; send it again. It was " + clocks_text(source, now);
  }

  Domain& domain_;
  const RequestWriters& writers_;
  const RequestHandlers<Message> handlers_;
  const HeldTo bus_;
  const Instant listening_;  // when it began to listen
  dds::DataReader* reader_ = nullptr;
};

}  // namespace fieldcast
