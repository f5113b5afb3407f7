// Records what a participant discovers and matches, with times, for the message of a test whose
// wait fails. The record distinguishes missed announcements, missed endpoints and foreign
// participants. Must outlive the domain and its endpoints. Any thread.
#pragma once

#include <chrono>
#include <mutex>
#include <sstream>
#include <string>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast::test {

class DiscoveryRecord : public DiscoveryListener {
 public:
  [[nodiscard]] dds::DataWriterListener* matches() { return &matches_; }
  [[nodiscard]] std::string text() const {
    const std::lock_guard lock(mutex_);
    return "discovered since the start:\n" + text_;
  }

 private:
  static constexpr int kMostEvents = 300;

  struct Matches : dds::DataWriterListener {
    explicit Matches(DiscoveryRecord& to) : record(to) {}
    void on_publication_matched(dds::DataWriter*,
                                const dds::PublicationMatchedStatus& status) override {
      rtps::GUID_t reader;
      rtps::iHandle2GUID(reader, status.last_subscription_handle);
      record.note(
          reader.guidPrefix,
          std::string(status.current_count_change > 0 ? "reader matched, " : "reader unmatched, ") +
              std::to_string(status.current_count) + " now");
    }
    DiscoveryRecord& record;
  };

  void on_participant(const FoundParticipant& found) override {
    note(found.prefix, "participant '" + found.name + (found.gone ? "' removed" : "' announced"));
  }
  void on_writer(const FoundWriter& found) override {
    note(found.guid.guidPrefix, "writer of " + found.topic + (found.gone ? " removed" : " found"));
  }
  void note(const rtps::GuidPrefix_t& participant, const std::string& event) {
    const std::lock_guard lock(mutex_);
    if (++events_ > kMostEvents) return;
    std::ostringstream line;
    line.precision(3);
    line << std::fixed
         << std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count()
         << " s: " << participant << ' ' << event << '\n';
    text_ += line.str();
  }

  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  mutable std::mutex mutex_;
  std::string text_;
  int events_ = 0;
  Matches matches_{*this};
};

}  // namespace fieldcast::test
