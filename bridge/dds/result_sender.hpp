// Publishes command results, one for each command, and lets go of each instance at once, so that memory stays flat over millions.
//
// Results are volatile. A requester that has just joined may have had its command heard before its reader was discovered; its
// result is held until then, for at most a second. Any thread.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "bridge/dds/conversion.hpp"
#include "bridge/dds/domain.hpp"

namespace fieldcast {

class ResultSender : private dds::DataWriterListener {
 public:
  using GuidPrefix = eprosima::fastrtps::rtps::GuidPrefix_t;

  ResultSender(Domain& domain, const std::string& label, std::function<UtcMapping()> clock,
               std::function<void(std::string)> on_problem);

  // The participant that a requester's commands come from. At most kMaxRequesters are remembered; the results of others are not
  // held.
  void remember(const std::string& requester, const GuidPrefix& participant);

  void send(const idl::CommandResult& result);

  // Sends what was held for too long. Called once a second or so.
  void flush_overdue();

  // Waits at most `linger` until every reader has what was sent, and removes the writer.
  void close(Duration linger);

 private:
  static constexpr std::size_t kMaxRequesters = 4096;
  static constexpr std::size_t kMaxHeld = 1024;  // the oldest is sent regardless
  static constexpr Duration kHold = std::chrono::seconds{1};
  static constexpr Duration kWaitForRoom = std::chrono::milliseconds{20};  // a bus's strand waits

  struct Held {
    GuidPrefix participant;
    Instant until;
    idl::CommandResult result;
  };

  void on_publication_matched(dds::DataWriter* writer, const dds::PublicationMatchedStatus& status) override;
  void write(idl::CommandResult& result);

  Domain& domain_;
  std::function<UtcMapping()> clock_;
  std::function<void(std::string)> on_problem_;
  dds::DataWriter* writer_ = nullptr;
  std::mutex mutex_;  // never held while writing
  std::map<std::string, GuidPrefix> requesters_;
  std::multiset<GuidPrefix> matched_;  // participants with a result reader, once for each reader
  std::deque<Held> held_;
};

}  // namespace fieldcast
