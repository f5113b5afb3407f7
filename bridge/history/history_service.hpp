// Responds to requests for stored samples on its own thread, at low priority, with a read-only
// connection to the store. It works at most half of the time, and never delays a bus, the
// publishing of samples or the store's writer.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "bridge/dds/topics/history_values.hpp"
#include "bridge/history/history_queue.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"
#include "core/model/store_spec.hpp"

namespace fieldcast {

class HistoryService {
 public:
  static constexpr Duration kLongest = std::chrono::seconds{5};  // of one request in the database
  static constexpr Duration kLeastPause = std::chrono::milliseconds{1};
  // Then an unused connection is closed.
  static constexpr Duration kIdle = std::chrono::seconds{30};

  struct Uses {
    std::function<bool(const std::string& bus)> serves;  // false: another bridge responds
    std::function<void(const HistoryRequest& request, const HistoryResponse& response)> respond;
  };
  // Without a store, requests are refused with this reason. Both functions are called on the
  // service's thread.
  HistoryService(std::optional<StoreSpec> store, Uses uses);
  ~HistoryService() { close(); }
  HistoryService(const HistoryService&) = delete;
  HistoryService& operator=(const HistoryService&) = delete;

  // `fault`: the request breaks the rules for this reason; empty: it does not. Any thread; never
  // waits.
  void receive(HistoryRequest request, std::string fault);
  void close();  // nothing is called after it returns; a second call has no effect

 private:
  void run();
  [[nodiscard]] HistoryResponse respond_to(const WaitingRequest& waiting);

  const std::optional<StoreSpec> store_;
  const Uses uses_;
  std::unique_ptr<SqlConnection> connection_;  // of the thread
  std::mutex mutex_;
  std::condition_variable changed_;
  HistoryQueue queue_;
  bool ending_ = false;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast
