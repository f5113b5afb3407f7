// The bridge's side of HistoryRequest and HistoryBlock. Owns one reader and one writer.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/history.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class HistoryEndpoint {
 public:
  // After each block: sockets of readers on this machine hold only a few.
  static constexpr Duration kPace = std::chrono::microseconds{500};

  // `fault`: why the request breaks the rules; empty: it does not. Called on DDS threads.
  using Received = std::function<void(HistoryRequest request, std::string fault)>;
  // `most_bytes` of a block. Throws DdsError, for example if this member has no right to the topic.
  HistoryEndpoint(Domain& domain, const std::string& label, std::size_t most_bytes,
                  Received received);
  HistoryEndpoint(const HistoryEndpoint&) = delete;
  HistoryEndpoint& operator=(const HistoryEndpoint&) = delete;

  // Waits between blocks; returns early, without the rest, when close() is called. One thread at a
  // time.
  void respond(const HistoryRequest& request, const HistoryResponse& response);
  void close();  // any thread; nothing is received after it returns

 private:
  // Writes one block and waits for kPace, or until close().
  void write(idl::HistoryBlock& block);

  Domain& domain_;
  const std::size_t most_bytes_;
  Taker<idl::HistoryRequest> taker_;
  idl::HistoryBlock block_;
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;
  std::mutex mutex_;  // protects the member below
  bool is_closed_ = false;
  std::condition_variable closed_;
};

}  // namespace fieldcast
