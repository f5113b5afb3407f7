// Decides when the last values of a bus are sent again: for readers that are new, and for those
// that lost blocks and ask (SnapshotRequest). One snapshot serves everybody who asked meanwhile.
//
// request() comes on any thread, DDS threads too, and never waits. Snapshots are sent on a thread
// of its own.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "bridge/dds/domain.hpp"

namespace fieldcast {

class SnapshotSender : private dds::DataReaderListener {
 public:
  static constexpr Duration kGather = std::chrono::milliseconds{20};  // after the first request
  static constexpr Duration kRest = std::chrono::milliseconds{100};   // between two rounds
  // After each block, so that readers on this machine take it before the next one: their sockets
  // hold a few.
  static constexpr Duration kPace = std::chrono::microseconds{500};

  // `send` writes the snapshot of a bus, if there is such a bus, and returns its blocks.
  SnapshotSender(Domain& domain, std::function<std::size_t(const std::string& bus)> send);
  ~SnapshotSender() override;  // close()

  void request(const std::string& bus);
  void close();  // nothing is sent after it returns; a second call has no effect

 private:
  void on_data_available(dds::DataReader* reader) override;
  void run();

  Domain& domain_;
  const std::function<std::size_t(const std::string&)> send_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> requested_;
  bool ending_ = false;
  dds::DataReader* requests_ = nullptr;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast
