// Last reports of buses, devices, alarms, sessions, bridges and read plans, with their messages for
// clients. Pure; used on the io thread.
//
// Changed objects are in a list, newest last. A message is encoded once for all clients. A removed
// object stays in the list until kMaxGone others were removed after it.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"

namespace fieldcast::web {

struct LiveAlarm {
  std::string bus, device, channel;
  LimitKind limit = LimitKind::kHigh;
  std::string priority = "medium";
  std::string state = "clear";  // "unacknowledged", "acknowledged", "returned", "clear"
  bool active = false;
  double value = 0;
  UtcTime since;
  UtcTime raised_at;              // present or last occurrence; 0: unknown
  std::uint32_t occurrences = 0;  // in the last 10 minutes
  bool chattering = false;
  std::string acknowledged_by, note;
  UtcTime acknowledged_at;  // 0: not acknowledged
  UtcTime shelved_until;    // 0: not shelved
  std::string shelved_by;
  std::string suppressed;  // "maintenance", or empty
  bool detailed = false;   // the bridge reports actions of operators
  friend bool operator==(const LiveAlarm&, const LiveAlarm&) = default;
};
// From a bridge that does not report actions of operators.
[[nodiscard]] LiveAlarm live_alarm(const StationAlarm& alarm);
[[nodiscard]] LiveAlarm live_alarm(const StationAlarmStatus& status);

// The session and its last request arrive as two reports.
struct LiveSession {
  ProgramSessionReport session;
  std::string request;   // decoded; empty: not known
  UtcTime requested_at;  // 0: not known
};
[[nodiscard]] LiveSession live_session(const ProgramRequestReport& report);

// A site whose forwarder sends to the stream. Times without a remark are of its own clock.
struct LiveSite {
  std::string site;
  bool connected = false;  // heard in the last 30 s
  UtcTime heard_at;        // of its last message, by the clock of the server; 0: never
  UtcTime reported_at;     // of its last report, by the clock of the server; 0: never
  Duration clock_ahead{};  // of the server's clock, at its last report
  std::uint64_t backlog_records = 0, backlog_bytes = 0;
  UtcTime oldest_at;                                              // of the backlog; 0: it is empty
  std::uint64_t samples = 0, late_samples = 0, lost_samples = 0;  // since the forwarder's start
  std::uint64_t refused = 0;  // messages that this station could not decode
  friend bool operator==(const LiveSite&, const LiveSite&) = default;
};

// The connection to the stream.
struct LiveStream {
  bool connected = false;
  std::string reason;     // of a missing connection, or of a stream that cannot be read
  bool commands = false;  // this station sends commands to its sites
  friend bool operator==(const LiveStream&, const LiveStream&) = default;
};

using LiveObject =
    std::variant<StationBusStatus, StationDeviceStatus, LiveAlarm, LiveSession, StationBridge,
                 StationReadPlan, LiveSite, LiveStream, StationDeviceDescription, Interest>;
// Kind and names, which are the same for each report of an object.
[[nodiscard]] std::string key_of(const LiveObject& object);

class LiveObjects {
 public:
  // Further objects are refused and counted.
  static constexpr std::size_t kMaxObjects = 20'000;
  static constexpr std::size_t kMaxGone = 1024;
  // An unchanged device is reported again after this time, measured by its reports.
  static constexpr Duration kDevicePeriod = std::chrono::seconds{2};

  // The two reports of a session are joined; the request of an earlier one is dropped.
  // A clear alarm is removed unless shelved or suppressed; an alarm without details does not change
  // a detailed one. Of a read plan, clients receive only a notice that it has changed.
  void put(LiveObject object);
  // Only the names of the object count, and whether an alarm is detailed.
  void remove(const LiveObject& object);

  [[nodiscard]] const StationReadPlan* read_plan(const std::string& bus) const;
  // Null if no bridge describes the device.
  [[nodiscard]] const StationDeviceDescription* description(const std::string& bus,
                                                            const std::string& device) const;
  // Returns whether the bus, "SITE:BUS", is of a site of the stream.
  [[nodiscard]] bool is_of_stream(const std::string& bus) const;

  template <class Kind>
  [[nodiscard]] std::vector<const Kind*> all() const {
    std::vector<const Kind*> found;
    for (const auto& [key, entry] : entries_) {
      const auto* object = std::get_if<Kind>(&entry.object);
      if (object != nullptr && !entry.gone) found.push_back(object);
    }
    return found;
  }

  using Message = std::shared_ptr<const std::string>;
  struct News {
    bool lost = false;              // removals since `version` are no longer stored
    std::uint64_t version = 0;      // version that the client has after these messages
    std::vector<Message> messages;  // oldest first
  };
  [[nodiscard]] std::uint64_t version() const { return version_; }
  // Version 0: all present objects. Returns at most `limit` messages.
  [[nodiscard]] News since(std::uint64_t version, std::size_t limit) const;

  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  struct Entry {
    LiveObject object;
    bool gone = false;
    std::uint64_t version = 0;
    UtcTime told_at;          // device: reported_at of the last report sent to clients
    mutable Message message;  // null: not encoded yet
    std::list<Entry*>::iterator changed;
  };
  [[nodiscard]] const LiveObject* present(const std::string& key) const;
  [[nodiscard]] Entry* entry_of(const std::string& key, std::size_t kind);
  void remove_entry(const std::string& key);
  void touch(Entry& entry);
  void forget_oldest();

  std::map<std::string, Entry, std::less<>> entries_;  // by kind and names
  std::map<std::size_t, std::size_t> counts_;          // by kind
  std::list<Entry*> changed_;
  std::list<std::string> gone_;  // keys of removed entries, oldest first
  std::uint64_t version_ = 0;
  std::uint64_t forgotten_ = 0;  // version of the newest forgotten entry
  std::uint64_t refused_ = 0;
};

}  // namespace fieldcast::web
