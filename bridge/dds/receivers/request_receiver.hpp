// Receives `Command` and `AlarmAction`: authenticates the requester, checks the target bridge and
// the expiry, and forwards the request unchanged. Handlers are called on DDS threads.
#pragma once

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>
#include <optional>
#include <string>

#include "bridge/dds/receivers/request_terms.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

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
