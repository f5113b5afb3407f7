// Decides when the last values of a bus are sent again: for new readers, and for readers that lost
// blocks and request them (SnapshotRequest). One snapshot serves all requests that arrive
// meanwhile.
//
// request() may be called on any thread, also DDS threads, and never waits. A thread of this object
// sends the snapshots.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class SnapshotSender : private dds::DataReaderListener {
 public:
  static constexpr Duration kGather = std::chrono::milliseconds{20};  // after the first request
  static constexpr Duration kRest = std::chrono::milliseconds{100};   // between two rounds
  // After each block, so that readers on this machine take it before the next one: their sockets
  // hold only a few.
  static constexpr Duration kPace = std::chrono::microseconds{500};

  struct Sent {
    std::size_t blocks = 0;
    bool all = true;  // false: the next part must follow
  };
  enum class Part : std::uint8_t { kFirst, kNext };
  // Writes a part of the snapshot of a bus, or nothing if there is no such bus.
  using Send = std::function<Sent(const std::string& bus, Part part)>;
  // `asked` is called on a DDS thread for each SnapshotRequest; may be null.
  SnapshotSender(Domain& domain, Send send, std::function<void()> asked);
  ~SnapshotSender() override;

  void request(const std::string& bus);
  void close();  // nothing is sent after it returns; a second call has no effect

 private:
  void on_data_available(dds::DataReader* reader) override;
  void run();
  bool rest(Duration time, std::unique_lock<std::mutex>& lock);
  bool send_all(const std::string& bus, std::unique_lock<std::mutex>& lock);

  Domain& domain_;
  const Send send_;
  const std::function<void()> asked_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> requested_;
  bool ending_ = false;
  dds::DataReader* requests_ = nullptr;
  std::thread thread_;  // last member: it uses the members above
};

}  // namespace fieldcast
