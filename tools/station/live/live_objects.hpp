// Buses, devices, alarms, programming sessions, bridges and read plans as they were reported last,
// and the message that tells a client of each. Pure; one owner, on the io thread.
//
// Objects that changed stand in a list, each once, the newest at the end. A message is made when
// the first client needs it and is the same for all. An object that is gone stays in the list until
// kMaxGone others are gone after it.
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

// An alarm with what people did about it.
struct LiveAlarm {
  std::string bus, device, channel;
  LimitKind limit = LimitKind::kHigh;
  std::string priority = "medium";
  std::string state = "clear";  // "unacknowledged", "acknowledged", "returned", "clear"
  bool active = false;
  double value = 0;
  UtcTime since;
  std::uint32_t occurrences = 0;  // in the last 10 minutes
  bool chattering = false;
  std::string acknowledged_by, note;
  UtcTime acknowledged_at;  // 0: nobody did
  UtcTime shelved_until;    // 0: it is not shelved
  std::string shelved_by;
  std::string suppressed;  // "maintenance", or empty
  bool detailed = false;   // its bridge tells what people did
  friend bool operator==(const LiveAlarm&, const LiveAlarm&) = default;
};
// Of a bridge that tells no more than this.
[[nodiscard]] LiveAlarm live_alarm(const StationAlarm& alarm);
[[nodiscard]] LiveAlarm live_alarm(const StationAlarmStatus& status);

class LiveObjects {
 public:
  // Of each kind; what is beyond them is left out and counted.
  static constexpr std::size_t kMaxObjects = 20'000;
  static constexpr std::size_t kMaxGone = 1024;
  // A device whose state did not change is told anew after this time of its reports.
  static constexpr Duration kDevicePeriod = std::chrono::seconds{2};

  using Object = std::variant<StationBusStatus, StationDeviceStatus, LiveAlarm,
                              ProgramSessionReport, StationBridge, StationReadPlan>;

  void put(const StationBusStatus& bus);
  void put(const StationDeviceStatus& device);
  // One that is clear, and neither shelved nor suppressed, is gone. What is not detailed changes
  // nothing about one that is.
  void put(const LiveAlarm& alarm);
  void put(const ProgramSessionReport& session);
  void put(const StationBridge& bridge);
  // Clients are told that there is another plan, not the plan.
  void put(const StationReadPlan& plan);
  void remove(const LiveAlarm& alarm);
  void remove_bus(const std::string& bus);
  void remove_device(const std::string& bus, const std::string& device);
  void remove_bridge(const std::string& bridge);
  void remove_read_plan(const std::string& bus);

  // The plan in force on this bus. Null: none is known.
  [[nodiscard]] const StationReadPlan* read_plan(const std::string& bus) const;

  // Those of a kind that are there, by their names.
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
    bool lost = false;              // what is gone since `version` is not known any more
    std::uint64_t version = 0;      // up to which these messages tell everything
    std::vector<Message> messages;  // the oldest first
  };
  [[nodiscard]] std::uint64_t version() const { return version_; }
  // Version 0: everything that is there. At most `limit` messages.
  [[nodiscard]] News since(std::uint64_t version, std::size_t limit) const;

  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  struct Entry {
    Object object;
    bool gone = false;
    std::uint64_t version = 0;
    UtcTime told_at;          // of a device: reported_at of the report that was told last
    mutable Message message;  // null: nobody needed it yet
    std::list<Entry*>::iterator changed;
  };
  void put(const std::string& key, Object object, bool quietly = false);
  void remove(const std::string& key);
  void touch(Entry& entry);
  void forget_oldest();

  std::map<std::string, Entry, std::less<>> entries_;  // by kind and names
  std::map<std::size_t, std::size_t> counts_;          // by kind
  std::list<Entry*> changed_;
  std::list<std::string> gone_;  // keys of entries that are gone, the oldest first
  std::uint64_t version_ = 0;
  std::uint64_t forgotten_ = 0;  // version of the newest entry that was forgotten
  std::uint64_t refused_ = 0;
};

}  // namespace fieldcast::web
