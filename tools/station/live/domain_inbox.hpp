// Passes messages from DDS threads to the io thread. Keeps only the newest of each channel and
// object, so memory is bounded. on_..() is thread-safe; deliver() runs on the io thread. Wake is
// called once for the first waiting message, and again after deliver().
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

class DomainInbox {
 public:
  // Further objects are dropped and counted.
  static constexpr std::size_t kMaxObjects = 100'000;
  // Called on the DDS thread without a lock; must only post.
  using Wake = std::function<void()>;

  explicit DomainInbox(Wake wake) : wake_(std::move(wake)) {}

  void on_channel(const StationChannel& channel, Origin origin = Origin::kDds);
  void on_sample(const StationSample& sample);
  void on_value(const PathView& path, LiveValue value);
  void on_gone(const std::string& bus, const std::string& device, const std::string& channel);
  void on_silent(const std::string& site);  // of the stream
  void put(LiveObject object) { put_news({std::move(object), false}); }
  void remove(LiveObject last) { put_news({std::move(last), true}); }

  void deliver(LiveModel& model, Instant now);

  struct Counters {
    std::uint64_t samples = 0;    // received
    std::uint64_t overtaken = 0;  // replaced by a newer sample of the channel while waiting
    std::uint64_t dropped = 0;    // objects and channels beyond the limit
    std::uint64_t deliveries = 0;
  };
  [[nodiscard]] Counters counters() const;  // thread-safe

 private:
  // News of one channel, applied in this order: removed, announced, value.
  struct PathNews {
    ChannelPath path;
    bool gone = false;
    std::unique_ptr<StationChannel> channel;
    Origin origin = Origin::kDds;
    bool has_value = false;
    LiveValue value;
  };
  struct ObjectNews {
    LiveObject object;
    bool gone = false;
  };
  struct Batch {
    std::deque<PathNews> paths;
    std::unordered_map<PathView, PathNews*, PathHash, PathEqual> by_path;
    std::map<std::string, ObjectNews> objects;
    std::set<std::string> silent;  // sites; the stream has a bounded number
  };
  // Returns null if the inbox is full. REQUIRES: mutex_ is held.
  PathNews* news_of(const PathView& path);
  void put_news(ObjectNews news);
  // Calls `change` under the lock, and wake_ after it if a change waits that it was not called for.
  // `change` returns whether it has changed the batch.
  template <typename Change>
  void apply(Change change);

  const Wake wake_;
  mutable std::mutex mutex_;
  Batch batch_;
  bool woken_ = false;
  Counters counters_;
};

}  // namespace fieldcast::web
