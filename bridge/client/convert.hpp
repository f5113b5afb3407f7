// The newest message of each key, and the subscribers of one kind of message. A subscriber first
// receives what is known, then each further message, never an older one after a newer one. Any
// thread may add and end subscribers; publish() and remove() have one caller at a time.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <tl/expected.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/model/command.hpp"
#include "fieldcast/alarms.hpp"
#include "fieldcast/commands.hpp"
#include "fieldcast/settings.hpp"
#include "fieldcast/status.hpp"
#include "fieldcast/values.hpp"

namespace fieldcast::api {

template <class Message>
class Feed {
 public:
  using Handler = std::function<void(const Message&)>;
  struct Handlers {
    std::function<bool(const Message&)> wants;  // the subscriber's pattern; empty: all
    Handler on_message;
    Handler on_removed;  // the last message of a key that is removed; may be empty
    [[nodiscard]] bool want(const Message& message) const { return !wants || wants(message); }
  };

  // Returns the function that ends it and waits for a running handler, unless that one calls it.
  [[nodiscard]] std::function<void()> add(Handlers handlers) {
    auto added = std::make_shared<Subscriber>();
    added->handlers = std::move(handlers);
    const std::unique_lock turn(added->turn);
    std::vector<Message> known;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& [key, message] : newest_) {
        if (added->handlers.want(message)) known.push_back(message);
      }
      subscribers_.push_back(added);
    }
    for (const Message& message : known) {
      if (!added->ended) added->handlers.on_message(message);
    }
    return [this, added] { end(added); };
  }

  void publish(const std::string& key, const Message& message) {
    for (const auto& subscriber : stored(key, message))
      deliver(*subscriber, message, subscriber->handlers.on_message);
  }

  // Only if a message of the key is known. `change` adapts the last message.
  template <class Change>
  void remove(const std::string& key, Change change) {
    Message last;
    std::vector<std::shared_ptr<Subscriber>> subscribers;
    {
      const std::lock_guard lock(mutex_);
      const auto found = newest_.find(key);
      if (found == newest_.end()) return;
      last = std::move(found->second);
      newest_.erase(found);
      subscribers = subscribers_;
    }
    change(last);
    for (const auto& subscriber : subscribers)
      deliver(*subscriber, last, subscriber->handlers.on_removed);
  }

 private:
  struct Subscriber {
    Handlers handlers;
    std::recursive_mutex turn;  // held while a handler runs
    bool ended = false;         // under `turn`
  };

  std::vector<std::shared_ptr<Subscriber>> stored(const std::string& key, const Message& message) {
    const std::lock_guard lock(mutex_);
    newest_.insert_or_assign(key, message);
    return subscribers_;
  }

  static void deliver(Subscriber& subscriber, const Message& message, const Handler& handler) {
    const std::lock_guard turn(subscriber.turn);
    if (!subscriber.ended && handler && subscriber.handlers.want(message)) handler(message);
  }

  void end(const std::shared_ptr<Subscriber>& subscriber) {
    {
      const std::lock_guard lock(mutex_);
      std::erase(subscribers_, subscriber);
    }
    const std::lock_guard turn(subscriber->turn);
    subscriber->ended = true;
  }

  std::mutex mutex_;
  std::unordered_map<std::string, Message> newest_;
  std::vector<std::shared_ptr<Subscriber>> subscribers_;
};

// Conversion between the values of the library's public headers and those of the tree. Pure.
[[nodiscard]] Time to_public(UtcTime time);
[[nodiscard]] UtcTime to_inner(Time time);
[[nodiscard]] DdsSite to_inner(const Domain& domain);
[[nodiscard]] Sample to_public(const StationSample& sample);
[[nodiscard]] Channel to_public(const StationChannel& channel);
[[nodiscard]] Alarm to_public(const StationAlarmStatus& status);
[[nodiscard]] BusStatus to_public(const StationBusStatus& status);
[[nodiscard]] DeviceStatus to_public(const StationDeviceStatus& status);
[[nodiscard]] Bridge to_public(const StationBridge& bridge);
[[nodiscard]] ReadPlan to_public(const StationReadPlan& plan);
[[nodiscard]] ProgrammingSession to_public(const ProgramSessionReport& session);
[[nodiscard]] Result to_public(const StationOutcome& outcome);
[[nodiscard]] AlarmKey key_of(const Alarm& alarm);
// Fails with one line about the type.
[[nodiscard]] tl::expected<AddressTarget, std::string> to_inner(const Address& address);

}  // namespace fieldcast::api
