// A station's side of HistoryRequest and HistoryBlock: one request at a time. Its endpoints exist
// only while they are used, because every reader receives the responses to all stations.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/history.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/station.hpp"

namespace fieldcast {

class HistoryClient {
 public:
  // `requester` must be unique in the domain.
  HistoryClient(Domain& domain, std::string requester);
  ~HistoryClient() { end(); }
  HistoryClient(const HistoryClient&) = delete;
  HistoryClient& operator=(const HistoryClient&) = delete;

  // Station::history(). One thread at a time.
  [[nodiscard]] tl::expected<HistoryResponse, StationFault> request(HistoryRequest request,
                                                                    Duration wait);
  // Removes the endpoints. The thread of request().
  void end();

 private:
  static constexpr Duration kLook = std::chrono::milliseconds{10};  // for a bridge

  [[nodiscard]] bool begin();
  [[nodiscard]] bool is_matched() const;
  void take(const idl::HistoryBlock& block);

  Domain& domain_;
  const std::string requester_;
  std::uint64_t next_id_ = 1;
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;

  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  std::uint64_t id_ = 0;  // of the pending request; 0: none
  std::optional<HistoryParts> parts_;
  std::optional<HistoryResponse> response_;

  Taker<idl::HistoryBlock> taker_;
};

}  // namespace fieldcast
